"""Does the edge of the contact move continuously? Kinks of the curves of a ramp and hold, with more and less smoothing.

Contact that begins node by node leaves a kink in every curve whenever one joins. Contact at points inside elements
(:mod:`fingerpad.mechanics.contact_points`) leaves less than can be seen, if its pressures are smoothed enough to be those of one
edge and not so much that the contact widens.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from fingerpad.mechanics import contact_points
from fingerpad.receptors.laws import rate_by_leg
from fingerpad.simulation import simulate
from fingerpad.studies.accuracy.run import DEPTHS

if TYPE_CHECKING:
    import xarray as xr

    from fingerpad.scenes.scene import Scene

OUTPUTS = 40
"""Of the ramp, and as many of the hold."""
ONSET = 5
"""Outputs of the ramp that are left out: the contact begins with a root of time, which no parabola follows."""
SHARES = (1.0, 0.1, 0.001, 10.0)
"""Of the smoothing that is the method's own. The third is next to none: what points alone do, whose pressures alternate."""


@contextmanager
def smoothed(share: float) -> Iterator[None]:
    """Contact with another smoothing of its pressures, this many times the method's own."""
    own = contact_points.SMOOTHING
    contact_points.SMOOTHING = share * own
    try:
        yield
    finally:
        contact_points.SMOOTHING = own


def kink(time: np.ndarray, values: np.ndarray) -> float:
    """Largest distance of one of ``values`` (n,) at ``time`` (n,) from the parabola fitted to two neighbours on either side."""
    worst = 0.0
    for k in range(2, len(time) - 2):
        near = np.array([k - 2, k - 1, k + 1, k + 2])
        way = (time[near] - time[k]) / (time[k + 2] - time[k - 2])
        worst = max(worst, abs(values[k] - np.polyfit(way, values[near], 2)[-1]))
    return worst


def kinks(history: xr.Dataset) -> dict[str, float]:
    """Largest kink (share of the range) of each curve of a ramp and hold, its onset and the corner between its legs left out."""
    time, leg = history["time"].values, history["leg"].values
    curves = {name: (time, history[name].values) for name in ("contact_width", "peak_pressure", "centre_pressure")}
    for depth in DEPTHS:
        which = int(np.argmin(np.abs(history["receptor_depth"].values - depth)))
        when, _, rate = rate_by_leg(time, history["strain_energy_density"].values[:, which], leg)
        curves[f"energy rate at {1e6 * depth:.0f} um"] = when, rate
    top = float(time[leg == leg[1]].max())
    found = {}
    for name, (when, values) in curves.items():
        corner = int(np.argmin(np.abs(when - top)))
        again = corner + 1 if np.isclose(when[min(corner + 1, len(when) - 1)], top) else corner  # a rate has two values there
        legs = (slice(ONSET, corner + 1), slice(again, None))
        found[name] = max(kink(when[part], values[part]) for part in legs) / float(np.ptp(values))
    return found


def alternation(history: xr.Dataset) -> float:
    """Largest distance (share of the peak) of a node's final pressure from its neighbours' cubic, four nodes from the edges."""
    pressure = history["contact_pressure"].values[-1]
    on = np.flatnonzero(pressure > 0)[4:-4]
    near = (-pressure[on - 2] + 4 * pressure[on - 1] + 4 * pressure[on + 1] - pressure[on + 2]) / 6
    return float(np.abs(pressure[on] - near).max(initial=0.0) / pressure.max())


def pressed(scene: Scene, share: float = 1.0) -> xr.Dataset:
    """The history of a ramp and hold with outputs that are close enough to see kinks."""
    from fingerpad.scenes.scene import Receptors

    receptors = Receptors(depths=DEPTHS, offsets=(0.0,))
    with smoothed(share):
        return simulate(scene.with_accuracy("thesis").varied({"outputs.receptors": receptors, "outputs.per_leg": OUTPUTS}))


def rows(surface: str, scene: Scene) -> list[dict[str, object]]:
    """Kinks, alternation and answers (per cent off the method's own) of a surface with each smoothing."""
    out, own = [], None
    for share in SHARES:
        history = pressed(scene, share)
        own = history if own is None else own
        row = {"surface": surface, "smoothing (of the method's)": share, "nodes": json.loads(history.attrs["cost"])["nodes"]}
        row |= {f"kink of {name} (%)": 100 * value for name, value in kinks(history).items()}
        row["alternation (%)"] = 100 * alternation(history)
        for name in ("indentation_depth", "contact_width", "centre_pressure"):
            row[f"{name} off (%)"] = 100 * (float(history[name][-1]) / float(own[name][-1]) - 1)
        out.append(row)
    return out


def table(scenes: dict[str, Scene]) -> pd.DataFrame:
    """All surfaces."""
    return pd.DataFrame([row for surface, scene in scenes.items() for row in rows(surface, scene)])
