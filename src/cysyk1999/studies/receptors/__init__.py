"""What receptors respond to, and how well a sensor can know it."""
