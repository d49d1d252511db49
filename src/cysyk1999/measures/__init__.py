"""What is read of a history."""
