"""Scenes of chapter 3's checks, and what figures and tables read from them: legs, depths, forces in
newton.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from fingerpad.results import scene_of

LINE = "steady_line"
BAR = "steady_bar_1_16_inch"
PLATE = "calibration_plate"
RAMP_HOLD = "calibration_ramp_hold"
PROFILES = {
    "line load": LINE,
    "cylinder 3.17 mm": "steady_cylinder_1_8_inch",
    "cylinder 9.52 mm": "steady_cylinder_3_8_inch",
}
DEPTH_SCENES = {
    "0.5": "ramp_hold_0_5_mm",
    "1.0": RAMP_HOLD,
    "1.5": "ramp_hold_1_5_mm",
    "2.0": "ramp_hold_2_0_mm",
}
"""Scenes of Fig 3-8, by final depth in mm."""
SPEED_SCENES = {"2": RAMP_HOLD, "8": "ramp_hold_8_mm_per_s", "32": "ramp_hold_32_mm_per_s"}
"""Scenes of Fig 3-9, by speed in mm/s."""


def leg_end(history: xr.Dataset, depth: float) -> int:
    """Index of the output at which a press to `depth` (m) ends. Raises KeyError if no leg ends
    there.
    """
    return int(np.flatnonzero(history["leg"].values == leg_of(history, depth))[-1])


def leg_of(history: xr.Dataset, depth: float) -> int:
    """Number of the leg that presses to `depth` (m). Raises KeyError if there is none."""
    for number, leg in enumerate(scene_of(history).motion):
        if leg.depth is not None and abs(leg.depth - depth) < 1e-9:
            return number
    raise KeyError(f"no press to {depth * 1e3:g} mm")


def pressed_depths(history: xr.Dataset) -> list[float]:
    """Depths (m) that the scene's legs press to, in their order."""
    return [leg.depth for leg in scene_of(history).motion if leg.depth is not None]


def force_N(history: xr.Dataset) -> np.ndarray:
    """Normal force (time) in N: line load times the scene's contact length."""
    return history["force"].values * contact_length(history)


def contact_length(history: xr.Dataset) -> float:
    """Length (m) of the contact along the finger, that of the history's specimen."""
    return scene_of(history).specimen.contact_length


def steady_force(plate: xr.Dataset, depth: float) -> float:
    """Force (N) of the relaxed pad at a depth (m) that a leg of the steady press ends at."""
    return float(force_N(plate)[leg_end(plate, depth)])
