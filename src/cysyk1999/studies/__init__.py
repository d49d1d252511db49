"""Studies that run the model to learn about the model."""
