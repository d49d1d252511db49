"""What a receptor feels of the direction of a stroke over a ridged pad, read from the strokes of a plate.

Strain energy W at a receptor while the plate moves to the right, and to the left, in full slip. The directional index is their
contrast, (W right - W left) / (W right + W left), averaged over the outputs after the first :data:`STEADY` of the stroke: 0 for
a receptor that does not feel direction, 1/3 for twice the energy, 1/2 for three times. Ridges and pad are their own mirror image,
so the stroke to the left at x is the one to the right at -x, and one stroke gives the index everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from fingerpad.figures.features import PRESSURE, ridges_of, scene_of
from fingerpad.scene_specimen import Outline, Ridges
from fingerpad.specimen import RidgedPad

STEADY = 2e-3
"""Where the mean of the index begins, m of stroke."""
DEPTH, BESIDE = 915e-6, 46e-6
"""The thesis's receptor depth and offset, m."""
FLANK, AWAY = 120e-6, 25e-6
"""Offset of a flank of the ridges, and how far from the boundary the receptors are that follow it, m."""
GRID = tuple(np.round(np.arange(700, 1101, 20) * 1e-6, 9)), tuple(np.round(np.arange(-240, 241, 20) * 1e-6, 9))
"""Depths and offsets of a map round a ridge, m."""
KEY = (150, 0.65)
"""Height (um) and coefficient of the scenes."""


@dataclass(frozen=True)
class Case:
    """A short stroke: ridge height in um (0: the plain pad), coefficient of friction, name of the mesh."""

    height: float
    friction: float
    mesh: str

    @classmethod
    def named(cls, name: str) -> Case:
        """The case that `str` names."""
        height, friction, mesh = name.split("_")
        return cls(float(height), float(friction), mesh)

    def __str__(self) -> str:
        return f"{self.height:g}_{self.friction:g}_{self.mesh}"


def boundary(outline: Outline, ridges: Ridges | None, x: float) -> float:
    """Depth (m) at which the epidermis ends at the lateral position `x` (m, near the apex, of the boundary itself)."""
    depth = outline.epidermis_thickness
    if ridges is None:
        return depth
    pad = RidgedPad(outline, ridges)
    for _ in range(8):
        depth = pad.interface + float(pad.interface_shift(x / (1 - depth / outline.apex_radius)))
    return depth


def both_ways(history: xr.Dataset, depth: float, offset: float, steady: float = STEADY) -> tuple[np.ndarray, np.ndarray]:
    """Energies (time) Pa at a receptor while a plate moves to the right and, by the mirror image, to the left.

    Args:
        history: a stroke to the right. depth, offset: of the receptor, m, the offset from a ridge's tip. steady: m of stroke to
        leave out.

    Raises:
        KeyError: the history has no receptor there.
    """
    tip = _tip(history)
    slid = history.stroke_distance.values
    where = np.flatnonzero(np.abs(slid) >= steady * (1 - 1e-9))
    found = []
    for x in (offset, -offset):
        miss = np.hypot(history.receptor_depth.values - depth, history.receptor_offset.values - (tip + x))
        if miss.min() > 0.6e-6:
            raise KeyError(f"no receptor {depth * 1e6:g} um deep at {x * 1e6:g} um")
        found.append(history.strain_energy_density.values[where, int(miss.argmin())])
    return found[0], found[1]


def _tip(history: xr.Dataset) -> float:
    outline, ridges = specimen_of(history)
    return 0.0 if ridges is None or isinstance(ridges.inner.phase, str) else tip_at_depth(outline, ridges.inner.phase)


def tip_at_depth(outline: Outline, phase: float) -> float:
    """Lateral position (m) at the thesis's depth of a ridge tip that the skin has at `phase` (m)."""
    return phase * (1 - DEPTH / outline.apex_radius)


def directional_index(history: xr.Dataset, depth: float, offset: float, steady: float = STEADY) -> float:
    """Mean over the steady part of a stroke to the right of (W right - W left) / (W right + W left)."""
    right, left = both_ways(history, depth, offset, steady)
    return float(np.mean((right - left) / (right + left)))


def boundary_of(history: xr.Dataset, x: float) -> float:
    """Depth (m) at which the epidermis of a history's pad ends at an offset (m) from the tip."""
    return boundary(*specimen_of(history), _tip(history) + x)


def specimen_of(history: xr.Dataset) -> tuple[Outline, Ridges | None]:
    """Outline and ridges (None without) of a history's scene."""
    specimen = scene_of(history)["specimen"]
    ridges = ridges_of(history)
    return Outline(**specimen["outline"]), ridges and Ridges(**ridges)


def islands(history: xr.Dataset) -> np.ndarray:
    """Stretches of touching skin nodes (time), parted by at least one node that does not touch."""
    touches = np.pad(history[PRESSURE].values > 0, ((0, 0), (1, 1)))
    return np.count_nonzero(touches[:, 1:] & ~touches[:, :-1], axis=1)
