"""What meshes and steps of bodies of revolution are wrong by: the table that the planner reads.

The inferred pad as a dome under spheres, a cone and plates, and one of a stiff skin on soft tissue,
at forces that make contacts of the half widths of :data:`PRESSES`. Errors of meshes are those to a
mesh that has at least 32 edges in half of the contact; of steps, in a ramp and hold, those to twice
the most steps. That of the force is of a press to the truth's depth.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import xarray as xr

from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.studies.accuracy.compare import QUANTITIES, difference, looked_at, resized
from cysyk1999.studies.accuracy.run import DEFAULT_ROWS, ROWS, STEPS
from cysyk1999.studies.common.documents import FLAT, force, scene_of
from fingerpad.healing import simulate
from fingerpad.planning.discretisation import at_tip
from fingerpad.planning.plan import Plan, plan
from fingerpad.planning.rules import RULES
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.pad import all_over

CONE = {"shape": "cone", "half_angle": "60 deg", "radius": "0.5 mm"}


def sphere(radius: float) -> dict[str, str]:
    """A sphere of a radius in mm."""
    return {"shape": "sphere", "radius": f"{radius:g} mm"}


YOUNG = {"epidermis": "400 kPa", "dermis": "20 kPa", "fat": "20 kPa"}
STIFF = {"layers": {k: {"youngs_modulus": e, "poisson_ratio": 0.49} for k, e in YOUNG.items()}}
"""A specimen of a stiff skin on soft tissue."""
PRESSES: dict[float, list[tuple[Any, ...]]] = {
    0.12e-3: [(sphere(1), 0.03), (FLAT, 0.0033)],
    0.37e-3: [(sphere(1), 0.8), (sphere(20), 0.13), (sphere(1), 2, STIFF)],
    1.1e-3: [(CONE, 5.5), (FLAT, 1.15), (sphere(20), 4, STIFF)],
    2.3e-3: [(sphere(4.8), 16), (FLAT, 5), (sphere(20), 15, STIFF)],
    4e-3: [(FLAT, 20)],
}
"""Half width m of the contact -> what makes it: a stimulus and gram-weights, and on what."""
TRUE_ROWS, TRUE_EDGES = 12, 32
"""Rows across the epidermis and edges in half of the contact, at least, of the truth's mesh."""
TIP_EDGES = 4
"""In the radius of a tip on the axis, of which the planner knows the error by a rule of its own."""
ENERGY = "strain_energy_density"
MEASURED = ("force", *QUANTITIES)


def turned_scene(stimulus: dict[str, Any], motion: list[dict[str, Any]], **more: Any) -> Scene:
    """A scene of revolution with the receptors that are looked at, in finite strain."""
    document = {"kinematics": "axisymmetric", "stimulus": stimulus, "motion": motion}
    effects = {"effects": {"finite_strain": True}, "accuracy": "thesis"}
    return looked_at(scene_of(document | effects | more, "turned"))


def sized(scene: Scene, rows: int, focus: tuple[float, float] | None = None) -> Plan:
    """The plan on a mesh of so many rows across the epidermis, finer to either side (m) in edges
    (m) of ``focus``, and at a tip on the axis.
    """
    chosen, scale = plan(scene), DEFAULT_ROWS / rows
    edge = scale * RULES.presets["thesis"].skin_edge
    layer_edge, tip = scene.specimen.outline.epidermis_thickness / rows, scene.stimulus.tip
    finer = focus is not None and focus[1] < edge
    over, radial = all_over(*focus) if finer else (), focus[1] if finer else None
    if tip:
        over += at_tip(tip, tip / TIP_EDGES)
        radial = min(tip / TIP_EDGES, radial or layer_edge)
    size = resized(
        chosen,
        skin_edge=edge,
        layer_edge=layer_edge,
        growth=min(RULES.presets["thesis"].growth ** scale, 3.0),
        focus=over,
        skin_radial_edge=radial,
    )
    return replace(size, contact_edge=edge)


def of_meshes(
    half_width: float, stimulus: dict[str, Any], grams: float, specimen: dict[str, Any]
) -> Iterator[dict]:
    """Rows of the errors of all meshes in one press."""
    scene = turned_scene(stimulus, [force(grams)], specimen=specimen)
    focus = 1.3 * half_width, half_width / TRUE_EDGES
    truth = simulate(scene, sized(scene, TRUE_ROWS, focus))
    sunk = scene.varied({"motion": [{"press_to_depth": float(truth.indentation_depth[-1])}]})
    for rows in ROWS:
        found = simulate(scene, sized(scene, rows))
        force_at_depth = simulate(sunk, sized(sunk, rows)).force[-1]
        off = {"force": abs(float(force_at_depth / truth.force[-1]) - 1)}
        yield {"count": rows} | off | _off(found, truth)


def of_steps(
    half_width: float, stimulus: dict[str, Any], grams: float, specimen: dict[str, Any]
) -> Iterator[dict]:
    """Rows of the errors of all numbers of steps of a ramp of half a second and a hold."""
    motion = [force(grams, 2 * grams), {"hold": "2 s"}]
    scene = turned_scene(stimulus, motion, specimen=specimen)
    chosen = sized(scene, ROWS[1])

    def stepped(steps: int) -> xr.Dataset:
        return simulate(scene, replace(chosen, steps_per_leg=steps, every=1, once=True))

    truth = stepped(2 * STEPS[-1])
    for steps in STEPS:
        yield {"count": steps} | _off(stepped(steps), truth)


def _off(found: xr.Dataset, truth: xr.Dataset) -> dict[str, float]:
    return {name: difference(found, truth, (name,))[0] for name in QUANTITIES}


def measured() -> pd.DataFrame:
    """Errors by quantity: a row a press, and mesh or number of steps."""
    rows = []
    for half_width, presses in PRESSES.items():
        for stimulus, grams, *on in presses:
            press = half_width, stimulus, grams, on[0] if on else {}
            of = {
                "half width (mm)": 1e3 * half_width,
                "shape": stimulus["shape"],
                "force (gf)": grams,
                "skin": "stiff" if on else "usual",
            }
            rows += [{"kind": "mesh"} | of | row for row in of_meshes(*press)]
            rows += [{"kind": "steps"} | of | row for row in of_steps(*press)]
    return pd.DataFrame(rows)


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """What the planner goes by: the largest error by mesh size, of strain energies alone and by
    steps, for every half width; none below that of what is finer.
    """
    parts = {}
    for kind, of, quantities in (
        ("mesh", "mesh", list(MEASURED)),
        ("energy", "mesh", [ENERGY]),
        ("steps", "steps", list(QUANTITIES)),
    ):
        here = rows[rows["kind"] == of]
        worst = here.assign(worst=here[quantities].max(axis=1)).pivot_table(
            index="count", columns="half width (mm)", values="worst", aggfunc="max"
        )
        parts[kind] = worst[::-1].cummax()[::-1]
    found = pd.concat(parts, names=["kind", "count"])
    found.columns = [f"{half_width:g} mm" for half_width in found]
    return found.map(lambda error: float(f"{error:.2g}")).reset_index()


def accuracy_turned(job: SimpleNamespace) -> None:
    """Job: -> `rows` and `table`."""
    rows = measured()
    write_frame(rows, Path(job.rows[0]))
    publish_table(table(rows), job.table[0])
