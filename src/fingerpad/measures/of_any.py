"""Measures that any scene has, whatever presses and how: what sweeps keep. "end" is the last
output, "highest" the largest ever.

Those of receptors have a condition for each of them, such as "915 um, end", or "915 um at 0.5 mm,
end" beside the middle.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from fingerpad.measures import features
from fingerpad.measures.measure import Measure, measure, strokes
from fingerpad.receptors.laws import THESIS_RATE, rate_by_leg
from fingerpad.scenes.scene import Scene


def _two(values: np.ndarray) -> dict[str, float]:
    return {"end": values[-1], "highest": values[np.argmax(np.abs(values))]}


def _of_receptors(
    history: xr.Dataset, each: np.ndarray, conditions: tuple[str, ...] = ("end", "highest")
) -> dict[str, float]:
    """Values (time, receptor) at the end and at their highest, by place."""
    places = zip(
        history["receptor_depth"].values * 1e6, history["receptor_offset"].values * 1e3, strict=True
    )
    out = {}
    for k, (depth, offset) in enumerate(places):
        place = f"{depth:.6g} um" + (f" at {offset:.6g} mm" if offset else "")
        out |= {f"{place}, {c}": value for c, value in _two(each[:, k]).items() if c in conditions}
    return out


def timed(scene: Scene) -> bool:
    """Something in the motion takes time."""
    return scene.end_time is None or scene.end_time > 0


ends = partial(Measure, of="history")

CONTACT = (
    ends("indentation_depth", "mm", lambda h: _two(1e3 * features.depth(h))),
    ends("contact_width", "mm", lambda h: _two(1e3 * features.width(h))),
    ends("normal_force", "gf", lambda h: _two(features.force_gf(h))),
    ends("peak_pressure", "Pa", lambda h: _two(features.peak_pressure(h))),
    ends("pressure_at_centre", "Pa", lambda h: _two(features.centre_pressure(h))),
    ends("tangential_force", "N/m", lambda h: _two(h["tangential_force"].values), strokes),
)

RECEPTORS = (
    ends("strain_energy", "Pa", lambda h: _of_receptors(h, h["strain_energy_density"].values)),
    ends("compressive_strain", "1", lambda h: _of_receptors(h, h["compressive_strain"].values)),
    ends("tensile_strain", "1", lambda h: _of_receptors(h, h["tensile_strain"].values)),
    ends("von_mises_stress", "Pa", lambda h: _of_receptors(h, h["von_mises_stress"].values)),
)


@measure("impulses/s", timed)
def predicted_rate(history):
    """Impulse rate of slowly adapting receptors by Eq 5-1 with the thesis's constants."""
    at, energy, change = rate_by_leg(
        history["time"].values, history["strain_energy_density"].values, history["leg"].values
    )
    return _of_receptors(history, THESIS_RATE(energy, change))


@measure("impulses/s")
def steady_rate(history):
    """The same law for the energy at the end, if it were held for ever."""
    energy = history["strain_energy_density"].values
    return _of_receptors(history, THESIS_RATE(energy, np.zeros_like(energy)), ("end",))


NUMERICS = (
    ends("smallest_volume_ratio", "1", lambda h: float(h["min_detF"].min())),
    ends("energy_balance_error", "1", lambda h: float(h["energy_balance_error"][-1])),
)
