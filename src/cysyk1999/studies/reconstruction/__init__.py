"""The pad of 1999, reconstructed: which model made the thesis's figures, and how sure that is."""
