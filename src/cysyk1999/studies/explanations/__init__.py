"""Which reading of what the thesis leaves open brings a statement of it about, that does not hold
here.
"""
