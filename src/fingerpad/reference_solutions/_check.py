"""Argument checks shared by the reference solutions."""

import numpy as np


def positive(**values):
    """Raise ``ValueError`` naming the first of ``values`` that is not finite and > 0 throughout."""
    for name, value in values.items():
        value = np.asarray(value, dtype=float)
        if not (np.all(np.isfinite(value)) and np.all(value > 0)):
            raise ValueError(f"{name} must be positive and finite, got {value}")


def poisson_ratio(**values):
    """Raise ``ValueError`` naming the first of ``values`` outside ``-1 < nu <= 0.5``."""
    for name, value in values.items():
        if not -1 < value <= 0.5:
            raise ValueError(f"{name} must lie in (-1, 0.5], got {value}")
