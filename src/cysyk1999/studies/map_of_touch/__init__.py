"""A map of touch: how curved, how hard, how fast."""
