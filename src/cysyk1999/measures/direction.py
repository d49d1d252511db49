"""What a receptor feels of the direction of a stroke over a ridged pad, read from the strokes of a
plate.

Strain energy W at a receptor while the plate moves to the right, and to the left, in full slip. The
directional index is their contrast, (W right - W left) / (W right + W left), averaged over the
outputs after the first :data:`STEADY` of the stroke: 0 for a receptor that does not feel direction,
1/3 for twice the energy, 1/2 for three times. Ridges and pad are their own mirror image, so the
stroke to the left at x is the one to the right at -x, and one stroke gives the index everywhere.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from fingerpad.measures.features import PRESSURE, energy

STEADY = 2e-3
"""Where the mean of the index begins, m of stroke."""
DEPTH, BESIDE = 915e-6, 46e-6
"""The thesis's receptor depth and offset, m."""
OFFSETS = {"x = −46 µm": -BESIDE, "centre": 0.0, "x = 46 µm": BESIDE}
"""Offsets (m) of the thesis's three receptors, by the name of their curves."""
UNDER_TIP = 935e-6
"""Depth (m) of the receptor in the dermis just under the ridge's tip."""
KEY = (150, 0.35)
"""Height (um) and coefficient of the scenes."""


def both_ways(
    history: xr.Dataset, depth: float, offset: float, steady: float = STEADY, tip: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Energies (time) Pa at a receptor while a plate moves to the right and, by the mirror image,
    to the left.

    Parameters
    ----------
    history
        A stroke to the right.
    depth, offset
        Of the receptor, m, the offset from a ridge's tip.
    steady
        m of stroke to leave out.
    tip
        Lateral position of that tip, m.

    Raises
    ------
    KeyError
        The history has no receptor there.
    """
    slid = history.stroke_distance.values
    where = np.flatnonzero(np.abs(slid) >= steady * (1 - 1e-9))
    right, left = (energy(history, depth, tip + x)[where] for x in (offset, -offset))
    return right, left


def directional_index(
    history: xr.Dataset, depth: float, offset: float, steady: float = STEADY, tip: float = 0.0
) -> float:
    """Mean over the steady part of a stroke to the right of (W right - W left) / (W right + W
    left).
    """
    right, left = both_ways(history, depth, offset, steady, tip)
    return float(np.mean((right - left) / (right + left)))


def islands(history: xr.Dataset) -> np.ndarray:
    """Stretches of touching skin nodes (time), parted by at least one node that does not touch."""
    touches = np.pad(history[PRESSURE].values > 0, ((0, 0), (1, 1)))
    return np.count_nonzero(touches[:, 1:] & ~touches[:, :-1], axis=1)
