"""What accuracy costs in time, and whether runs know their error."""
