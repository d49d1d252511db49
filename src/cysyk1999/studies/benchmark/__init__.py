"""Measured touch: every independent measurement against its prediction."""
