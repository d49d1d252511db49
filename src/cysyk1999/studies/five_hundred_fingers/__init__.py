"""Five hundred fingers: what of a finger matters, and for what."""
