"""Does the edge of the contact move continuously? Kinks in the curves of a ramp and hold.

Contact that begins node by node leaves a kink in every curve when a node joins. Contact at points
inside elements (:mod:`fingerpad.mechanics.contact_points`) leaves none that can be seen, if its
pressures are smoothed: too little, and they alternate; too much, and the contact widens. The study
varies the smoothing and the mesh. How wrong the pressures across the contact are depends on the
nodes along the skin alone.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import xarray as xr

from cysyk1999.measures.errors import norm
from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.accuracy.compare import DEPTHS, by_surface, looked_at
from cysyk1999.studies.accuracy.run import EDGED
from fingerpad.healing import simulate
from fingerpad.mechanics import contact_points
from fingerpad.planning.plan import plan
from fingerpad.receptors.laws import rate_by_leg
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.pad import MeshSize

OUTPUTS = 40
"""Of the ramp, and as many of the hold."""
ONSET = 5
"""Outputs of the ramp that are left out: the contact begins with a root of time, which no parabola
follows.
"""
SHARES = (1.0, 0.1, 0.001, 10.0)
"""Of the smoothing that is the method's own. The third is next to none: what points alone do, whose
pressures alternate.
"""


def kink(time: np.ndarray, values: np.ndarray) -> float:
    """Largest distance of one of ``values`` (n,) at ``time`` (n,) from the parabola fitted to two
    neighbours on either side.
    """
    worst = 0.0
    for k in range(2, len(time) - 2):
        near = np.array([k - 2, k - 1, k + 1, k + 2])
        way = (time[near] - time[k]) / (time[k + 2] - time[k - 2])
        worst = max(worst, abs(values[k] - np.polyfit(way, values[near], 2)[-1]))
    return worst


def kinks(history: xr.Dataset) -> dict[str, float]:
    """Largest kink (share of the range) of each curve of a ramp and hold, its onset and the corner
    between its legs left out.
    """
    time, leg = history["time"].values, history["leg"].values
    curves = {
        name: (time, history[name].values)
        for name in ("contact_width", "peak_pressure", "centre_pressure")
    }
    for depth in DEPTHS:
        which = int(np.abs(history["receptor_depth"].values - depth).argmin())
        when, _, rate = rate_by_leg(time, history["strain_energy_density"].values[:, which], leg)
        curves[f"energy rate at {1e6 * depth:.0f} um"] = when, rate
    top = float(time[leg == leg[1]].max())
    found = {}
    for name, (when, values) in curves.items():
        corner = int(np.argmin(np.abs(when - top)))
        twice = np.isclose(when[min(corner + 1, len(when) - 1)], top)  # a rate has two values there
        legs = slice(ONSET, corner + 1), slice(corner + int(twice), None)
        found[name] = max(kink(when[part], values[part]) for part in legs) / float(np.ptp(values))
    return found


def alternation(history: xr.Dataset) -> float:
    """Largest distance (share of the peak) of a node's final pressure from its neighbours' cubic,
    of all but the last four.
    """
    pressure = history["contact_pressure"].values[-1]
    on = np.flatnonzero(pressure > 0)[6:-6]
    near = (-pressure[on - 2] + 4 * pressure[on - 1] + 4 * pressure[on + 1] - pressure[on + 2]) / 6
    return float(np.abs(pressure[on] - near).max(initial=0.0) / pressure.max())


def pressed(
    scene: Scene, share: float = 1.0, sized: Callable[[MeshSize], MeshSize] = lambda size: size
) -> xr.Dataset:
    """The history of a ramp and hold with so many times the method's own smoothing of pressures,
    and outputs that are close enough to see kinks, a state at
    each, for splines between states would hide some; on its own mesh or one of another size.
    """
    asked = looked_at(scene).with_accuracy("thesis").varied({"outputs.per_leg": OUTPUTS})
    chosen = plan(asked)
    size = sized(chosen.mesh_size)
    with patch.object(contact_points, "SMOOTHING", share * contact_points.SMOOTHING):
        return simulate(asked, replace(chosen, mesh_size=size, once=True, every=1))


def _as_fine_into_the_skin(size: MeshSize) -> MeshSize:
    edge = min((edge for _, edge in size.focus), default=size.skin_edge)
    return replace(size, skin_radial_edge=edge)


MESHES = {
    "own": lambda size: size,
    "not refined": lambda size: replace(size, focus=(), skin_radial_edge=None),
    "refined into the skin too": _as_fine_into_the_skin,
}
"""Meshes of a surface; of one that is not refined the first two are one."""
FINER = 1 / 3
"""Edges of the mesh whose pressures are compared with, over those of the own."""


def pressure_off(history: xr.Dataset, truth: xr.Dataset) -> float:
    """Largest error of the pressure profile at an output, its onset left out, as a norm over that
    of the truth.
    """

    def profile(of: xr.Dataset, k: int) -> tuple[np.ndarray, np.ndarray]:
        place = np.flatnonzero(of["skin_y"].values > 0)
        place = place[np.argsort(of["skin_x"].values[place])]
        return of["skin_x"].values[place], of["contact_pressure"].values[k, place]

    def off(k: int) -> float:
        (x, found), (at, true) = profile(history, k), profile(truth, k)
        return norm(x, found - np.interp(x, at, true)) / norm(at, true)

    return max(off(k) for k in range(ONSET, history.sizes["time"]))


def rows(surface: str, scene: Scene) -> list[dict[str, object]]:
    """Kinks, alternation and answers (per cent off the method's own) of a surface with each
    smoothing and on each mesh.
    """
    out, own = [], None
    truth = pressed(scene, sized=lambda size: size.coarser(FINER))
    ways = [("own", share) for share in SHARES] + [(mesh, 1.0) for mesh in list(MESHES)[1:]]
    for mesh, share in ways:
        history = pressed(scene, share, MESHES[mesh])
        own = history if own is None else own
        row = {"surface": surface, "mesh": mesh, "smoothing (of the method's)": share}
        row |= {"nodes": json.loads(history.attrs["cost"])["nodes"]}
        row |= {f"kink of {name} (%)": 100 * value for name, value in kinks(history).items()}
        row["alternation (%)"] = 100 * alternation(history)
        row["pressure profile off (%)"] = 100 * pressure_off(history, truth)
        for name in ("indentation_depth", "contact_width", "centre_pressure"):
            row[f"{name} off (%)"] = 100 * (float(history[name][-1]) / float(own[name][-1]) - 1)
        out.append(row)
    return out


def accuracy_edges(job: SimpleNamespace) -> None:
    """Job: `scenes` in the order of EDGED -> `table`."""
    publish_table(by_surface(rows, EDGED, job.scenes), job.table[0])
