"""Does a run know its error? Scenes that the study of accuracy has not seen, each against the same
scene on the finest preset.

The truth is the largest relative difference of depth, width, centre and peak pressure and strain
energies to the "fine" run, made finer in narrow contacts, which has an error of its own: at the
legs' ends, and of legs that stroke as root mean square over their way. The belief is what the run
itself states as its error; it covers the truth when it is not smaller.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.run import DEPTHS
from fingerpad import load_scene
from fingerpad.planning.plan import Plan, plan
from fingerpad.results import states_found
from fingerpad.scenes.scene import Cylinder, Flat, Hold, PressToDepth, PressToForce, Scene, Slide

GF = 9.80665e-3
LEVELS = ("draft", 0.05, 0.02)
"""Accuracies that are asked for."""
FINEST = "finest"
"""Name of the run the others are held to."""


def covered(rows: pd.DataFrame) -> float:
    """Share of the runs, of those held to a finer one, that are no wronger than they believe."""
    asked = rows[rows["accuracy"] != FINEST]
    return float((asked["believed error (%)"] >= asked["true error (%)"]).mean())


def _press(grams: float, rate: float | None = 40.0, hold: float | None = 2.0) -> tuple:
    first = PressToForce(press_to_force=grams * GF, rate=rate and rate * GF)
    return (first, Hold(hold=hold)) if hold else (first,)


def _under(curvature: float, **changes: Any) -> dict[str, Any]:
    return {"stimulus": Cylinder(curvature=curvature)} | changes


LAYER = "specimen.layers.{}.{}".format
OUTSIDE: dict[str, dict[str, Any]] = {
    "curvature_79": _under(78.74),
    "curvature_420": _under(419.95),
    "curvature_2500": _under(2500.0),
    "plate_5_gf": {"stimulus": Flat(), "motion": _press(5.0)},
    "curvature_315_at_50_gf": _under(314.96, motion=_press(50.0)),
    "curvature_630_at_5_gf_in_33_ms": _under(629.92, motion=_press(5.0, rate=150.0)),
    "curvature_157_stiff_epidermis": _under(157.48)
    | {LAYER("epidermis", "youngs_modulus"): 0.45e6},
    "curvature_210_thin_epidermis": _under(209.97)
    | {"specimen.outline.epidermis_thickness": 0.5e-3},
    "plate_soft_fat": {"stimulus": Flat(), LAYER("fat", "youngs_modulus"): 5e3},
    "curvature_105_to_1_mm_at_8_mm_per_s": _under(
        104.99, motion=(PressToDepth(press_to_depth=1e-3, speed=8e-3), Hold(hold=1.0))
    ),
    "curvature_840_steady_10_gf": _under(840.0, motion=_press(10.0, rate=None, hold=None)),
    "curvature_210_nearly_incompressible": _under(209.97)
    | {LAYER(k, "poisson_ratio"): 0.4995 for k in ("epidermis", "dermis", "fat")},
    "plate_10_gf_stroked_back": {
        "stimulus": Flat(),
        "friction": 0.4,
        "motion": (*_press(10.0, hold=None), Slide(slide=-4e-3, speed=20e-3)),
    },
    "plate_30_gf_stroked_slowly": {
        "stimulus": Flat(),
        "friction": 0.5,
        "motion": (*_press(30.0, hold=None), Slide(slide=3e-3, speed=5e-3)),
    },
}
"""Scenes outside the study by what is different in them. The last but one showed that errors of
strokes add to those of presses; the last was added to check what the planner has made of that.
"""


def outside(base: Scene) -> dict[str, Scene]:
    """The scenes of :data:`OUTSIDE`, to be run finely."""
    return {name: base.varied(changes).with_accuracy("fine") for name, changes in OUTSIDE.items()}


STILL_FINER = 1.4
"""By how much the edges of a stroke's truth are shorter than the preset's, which is what a tight
tolerance comes to itself.
"""
QUANTITIES = (
    "indentation_depth",
    "contact_width",
    "centre_pressure",
    "peak_pressure",
    "strain_energy_density",
)


def difference(
    found: xr.Dataset, truth: xr.Dataset, quantities: Iterable[str] = QUANTITIES
) -> tuple[float, str]:
    """Largest relative difference of two histories, and the quantity that has it.

    At the end of every leg; the pressure in the middle relative to the largest, for it may be next
    to nothing. Of a leg that strokes the root mean square over its way, relative to the largest
    value on it: what a surface with hollows leaves at one moment may be next to nothing.
    """
    off = dict.fromkeys(quantities, 0.0)
    for leg in np.unique(truth.leg.values[1:]):
        one, other = (
            history.isel(time=1 + np.flatnonzero(history.leg.values[1:] == leg))
            for history in (found, truth)
        )
        way, places = np.abs(one.stroke_distance.values), np.abs(other.stroke_distance.values)
        for name in quantities:
            values, exact = (np.atleast_2d(history[name].values.T) for history in (one, other))
            if np.ptp(places) > 0:
                order = np.argsort(places)
                there = np.stack([np.interp(way, places[order], curve[order]) for curve in exact])
                error = np.sqrt(np.mean((values - there) ** 2, axis=1)) / np.abs(exact).max(axis=1)
            else:
                largest = (
                    other.peak_pressure.values[-1] if name == "centre_pressure" else exact[:, -1]
                )
                error = np.abs(values[:, -1] - exact[:, -1]) / np.abs(largest)
            off[name] = max(off[name], float(error.max()))
    worst = max(off, key=off.get)
    return off[worst], worst


def record(history, error: float, worst: str, **more: Any) -> dict[str, Any]:
    """What a run believes, how wrong it is and in what, and what it took."""
    cost = json.loads(history.attrs["cost"])
    believed = {
        "believed error (%)": 100 * float(history.attrs["estimated_error"]),
        "true error (%)": 100 * error,
    }
    took = {
        "nodes": cost["nodes"],
        "steps": states_found(history),
        "process time (s)": cost["cpu_s"],
    }
    return believed | {"worst quantity": worst} | more | took


def prepared(name: str, base: Scene) -> Scene:
    """One scene of :func:`outside` with the receptors that are looked at."""
    looked = {
        "outputs.receptors.depths": DEPTHS,
        "outputs.receptors.offsets": (0.0,),
        "outputs.snapshots": (),
    }
    return outside(base)[name].varied(looked)


def finer(chosen: Plan, share: float) -> Plan:
    """A plan with edges and steps ``share`` times as short."""
    size = chosen.mesh_size
    size = replace(
        size,
        skin_edge=size.skin_edge / share,
        layer_edge=size.layer_edge / share,
        growth=max(size.growth ** (1 / share), 1.03),
        focus=tuple((x, edge / share) for x, edge in size.focus),
        skin_radial_edge=size.skin_radial_edge and size.skin_radial_edge / share,
    )
    steps = round(chosen.steps_per_leg * (2 if chosen.timed else 1))
    return replace(
        chosen,
        mesh_size=size,
        steps_per_leg=steps,
        slide_step=chosen.slide_step / 1.5,
        asked_error=None,
    )


def finest(scene: Scene) -> Plan:
    """The plan of the truth: the preset, in the contact at least 20 elements to its half width; of
    a stroke still finer.
    """
    chosen = plan(scene)
    if chosen.strokes:
        return finer(chosen, STILL_FINER)
    edge, reach = (
        min(chosen.mesh_size.skin_edge, chosen.contact.half_width / 20),
        1.2 * chosen.contact.half_width,
    )
    if edge == chosen.mesh_size.skin_edge:
        return chosen
    focus = tuple((float(x), edge) for x in np.linspace(0.0, reach, 13))
    return replace(
        chosen,
        mesh_size=replace(chosen.mesh_size, focus=focus, skin_radial_edge=edge),
        contact_edge=edge,
    )


def beliefs(scene: Scene, name: str, levels: tuple = LEVELS) -> list[dict[str, Any]]:
    """Run a scene at every level and as :func:`finest`: what each believes and how wrong it is (of
    the finest: unknown).
    """
    from fingerpad.simulation import simulate

    truth = simulate(scene, finest(scene))
    rows = []
    for level in (*levels, FINEST):
        run = truth if level == FINEST else simulate(scene.with_accuracy(level))
        error, worst = difference(run, truth) if run is not truth else (np.nan, "")
        rows.append({"scene": name, "accuracy": str(level)} | record(run, error, worst))
    return rows


def accuracy_belief(job: SimpleNamespace) -> None:
    """Job: `names` of the scenes, `scene` that they vary -> `rows` (CSV), one for each scene."""
    for name, path in zip(job.names, job.rows, strict=True):
        write_frame(
            pd.DataFrame(beliefs(prepared(name, load_scene(job.scene[0])), name)), Path(path)
        )
