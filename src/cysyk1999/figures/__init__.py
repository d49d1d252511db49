"""The figures of the thesis, redrawn from simulated histories."""
