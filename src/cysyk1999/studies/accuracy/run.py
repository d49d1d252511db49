"""What accuracy costs in time: the runs of the study, one point each, and their measurements.

A point is a scene of the family with one discretisation. The plane of elements and mesh sizes is
complete; time steps, Newton tolerance, small strain and presets are varied one at a time from the
default preset. Meshes of other elements are the default's quadratic quads split, with the same
nodes, so the boundary is the same.
"""

from __future__ import annotations

import json
import os
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial
from multiprocessing import get_context
from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import threadpool_limits

from cysyk1999.studies.accuracy.compare import DEPTHS, looked_at
from cysyk1999.studies.common.documents import FLAT
from cysyk1999.studies.common.meshes import split
from fingerpad import load_scene
from fingerpad.files import write_text
from fingerpad.mechanics.stepping import NewtonSettings, NonConvergence
from fingerpad.planning.plan import Plan, plan
from fingerpad.planning.rules import RULES
from fingerpad.results import peak_memory_MB, provenance, states_found
from fingerpad.scenes.scene import Scene
from fingerpad.simulation import Simulation
from fingerpad.specimen.build import build_pad_mesh, count_nodes

FAMILY = {
    "flat": "ramp40_flat",
    "210": "ramp40_k210",
    "1260": "ramp40_k1260",
    "stroke": "accuracy_stroke",
}
"""Name in the study -> scene."""
PRESSED = ("flat", "210", "1260")
EDGED = {"flat": "ramp40_flat", "105": "ramp40_k105", "210": "ramp40_k210", "1260": "ramp40_k1260"}
"""Surface -> scene whose contact's edges are looked at."""
ELEMENTS = ("Q2P1", "Q1P0", "P2B", "Q1", "Q2", "Q2R")
"""Keys of the elements; the last three are for teaching."""
ROWS = (1, 2, 4, 7, 10, 14, 22)
"""Mesh sizes: rows of elements in the epidermis. Other edges are in proportion; 7 are the
default's.
"""
DEFAULT_ROWS, DEFAULT_STEPS, DEFAULT_TOLERANCE = 7, 20, 1e-4
STEPS, TOLERANCES = (5, 10, 20, 40, 80), (1e-2, 1e-3, 1e-4, 1e-6)
LONG = 5.0
"""s of process time: what takes longer is measured once, for its spread is small beside it."""
VARIABLES = {
    "depth": "indentation_depth",
    "width": "contact_width",
    "centre pressure": "centre_pressure",
    "peak pressure": "peak_pressure",
}
"""Name of a quantity in the study -> variable of a history."""
MESHES = {"Q2P1": "quad9", "Q2": "quad9", "Q2R": "quad9", "P2B": "tri6"}
"""Element -> the mesh that it needs; others need quad4."""
WAY = np.array([0.25, 0.5, 0.75, 1.0])
"""Parts of the way of a stroke at which it is looked at."""


@dataclass(frozen=True)
class Point:
    """One discretisation of one scene.

    Attributes
    ----------
    family : str
        Key of :data:`FAMILY`.
    element : str
        Key of the elements.
    rows : int
        Mesh size, see :data:`ROWS`.
    steps : int
        Steps of each leg; a slide's have the length that belongs to them.
    tolerance : float
        Of Newton's method, on the force.
    finite : bool
        Finite strain.
    preset : str
        Name of a preset, in place of all.
    """

    family: str
    element: str = "Q2P1"
    rows: int = DEFAULT_ROWS
    steps: int = DEFAULT_STEPS
    tolerance: float = DEFAULT_TOLERANCE
    finite: bool = True
    preset: str = ""

    @property
    def name(self) -> str:
        """Name of the point's record."""
        if self.preset:
            return f"{self.family}_{self.preset}"
        exponent, strain = round(-np.log10(self.tolerance)), "finite" if self.finite else "small"
        parts = self.family, self.element, f"m{self.rows}", f"s{self.steps}", f"t{exponent}", strain
        return "_".join(parts)


def points() -> dict[str, Point]:
    """Every point of the study by its name."""
    found = []
    for family in FAMILY:
        found += [Point(family, element, rows) for element in ELEMENTS for rows in ROWS]
        found += [Point(family, steps=steps) for steps in STEPS]
        found += [Point(family, tolerance=tolerance) for tolerance in TOLERANCES]
        found += [Point(family, finite=False)]
        found += [Point(family, preset=preset) for preset in ("draft", "fine")]
    return {point.name: point for point in found}


def sweeps() -> dict[str, list[Point]]:
    """The points by scene and element, as they are run together."""
    found: dict[str, list[Point]] = {}
    for point in points().values():
        found.setdefault(f"{point.family}_{point.element}", []).append(point)
    return found


def discretised(point: Point, scene: Scene) -> tuple[Scene, Plan]:
    """The scene with the receptors that are looked at, and the plan of the point."""
    effects = scene.effects | {"finite_strain": point.finite}
    scene = looked_at(scene).varied({"effects": effects}).with_accuracy(point.preset or "thesis")
    chosen = plan(scene)
    if point.preset:
        return scene, chosen
    scale = DEFAULT_ROWS / point.rows
    size = replace(
        chosen.mesh_size,
        skin_edge=chosen.mesh_size.skin_edge * scale,
        layer_edge=scene.specimen.outline.epidermis_thickness / point.rows,
        growth=min(RULES.presets["thesis"].growth ** scale, 3.0),
        focus=(),
        skin_radial_edge=None,
    )
    return scene, replace(
        chosen,
        element=point.element,
        mesh_size=size,
        contact_edge=size.skin_edge,
        steps_per_leg=point.steps,
        slide_step=chosen.slide_step * DEFAULT_STEPS / point.steps,
    )


def _run(point: Point, scene: Scene, chosen: Plan) -> xr.Dataset:
    """History of a point, discretised before."""
    mesh = build_pad_mesh(scene.specimen.outline, chosen.mesh_size)
    run = Simulation(scene, chosen, split(mesh, MESHES.get(chosen.element, "quad4")))
    share, default = point.tolerance / DEFAULT_TOLERANCE, NewtonSettings()
    run.stepper.settings = replace(
        default,
        force_tolerance=default.force_tolerance * share,
        gap_tolerance=default.gap_tolerance * share,
    )
    return run.run(None)


def values(history: xr.Dataset) -> dict[str, list[float]]:
    """Quantity -> its values (SI) at the moments looked at: top of the ramp and end, or the top and
    along the stroke.

    The peak rate of strain energy is one of the ramp, at each depth.
    """
    top = int(np.flatnonzero(history.leg == history.leg[0])[-1])
    way = history.stroke_distance.values
    energies = history.strain_energy_density.values.T
    traces = {name: history[variable].values for name, variable in VARIABLES.items()}
    traces |= {f"energy {1e6 * z:.0f} um": e for z, e in zip(DEPTHS, energies, strict=True)}
    found = {}
    for name, trace in traces.items():
        after = np.interp(WAY * way[-1], way[top:], trace[top:]) if way[-1] else trace[-1:]
        found[name] = [float(trace[top]), *after.tolist()]
    rates = np.gradient(energies[:, : top + 1], history.time.values[: top + 1], axis=1)
    return found | {"peak energy rate": np.abs(rates).max(1).tolist()}


RULER = Point("flat", rows=2)
"""The yardstick: a small run before and after each, beside whose process time others stand."""


def measure_all(sweep: list[Point], scene: Scene) -> Iterator[dict[str, Any]]:
    """Records of :func:`measure`, each from a process of its own with the kernels loaded."""
    processes = get_context("fork")
    with processes.Pool(1) as pool:  # compiles, so that its memory counts for no point
        pool.apply(_load_kernels, (sweep, scene))
    _load_kernels(sweep, scene)
    with processes.Pool(1, maxtasksperchild=1) as pool:
        yield from pool.imap(partial(measure, scene=scene), sweep)


def _load_kernels(sweep: list[Point], scene: Scene) -> None:
    """Load the kernels of a sweep and of the yardstick, or compile them."""
    for finite in {point.finite for point in sweep}:
        first = replace(sweep[0], rows=2, steps=5, finite=finite)
        _run(first, *discretised(first, scene))
        _run(RULER, *_ruler(scene))


def _ruler(scene: Scene) -> tuple[Scene, Plan]:
    """The yardstick's scene, pressed by a plate as far as the first leg goes, and its plan."""
    first = {"stimulus": FLAT, "friction": 0.0, "motion": scene.motion[:1]}
    return discretised(RULER, scene.varied(first))


def measure(point: Point, scene: Scene, repeats: int = 3) -> dict[str, Any]:
    """Run a point and record its answers and costs.

    Parameters
    ----------
    point : Point
    scene : Scene
    repeats : int
        Of the whole run, of which costs are medians; one that takes longer than :data:`LONG` is
        run once.

    Returns
    -------
    dict
        JSON-able: the point; values or the reason of failure; cost: process time of each repeat,
        meshing included, with that of the yardstick around it; memory of the process, unknowns,
        iterations; machine and versions.
    """
    ruler = _ruler(scene)
    seconds, yardstick, history, failure = [], [], None, ""
    with threadpool_limits(1):
        before = _timed(lambda: _run(RULER, *ruler))
        for _ in range(repeats):
            start = time.process_time()
            asked, chosen = discretised(point, scene)
            try:
                history = _run(point, asked, chosen)
            except NonConvergence as error:
                failure, history = str(error), error.dataset
            seconds.append(time.process_time() - start)
            after = _timed(lambda: _run(RULER, *ruler))
            yardstick.append((before + after) / 2)
            before = after
            if seconds[0] > LONG:
                break
    found: dict[str, Any] = {"point": asdict(point), "name": point.name, "failure": failure}
    cost = {"cpu_s": seconds, "yardstick_s": yardstick, "memory_MB": peak_memory_MB()}
    if history is not None:
        cost |= {
            "nodes": count_nodes(asked.specimen.outline, chosen.mesh_size),
            "unknowns": json.loads(history.attrs["cost"])["unknowns"],
            "steps": states_found(history),
            "iterations": int(history.newton_iterations.sum()),
            "cutbacks": int(history.cutbacks.sum()),
            "energy_balance_error": float(history.energy_balance_error[-1]),
        }
        found["values"] = {} if failure else values(history)
        found["believed_error"] = float(history.attrs["estimated_error"])
    return found | {"cost": cost, "load": os.getloadavg()[0], "made_by": provenance()}


def _timed(call: Callable[[], Any]) -> float:
    start = time.process_time()
    call()
    return time.process_time() - start


def seconds(record: dict[str, Any], yardstick: float) -> float:
    """Median process time (s) of a record, each repeat scaled to a machine on which the yardstick
    takes ``yardstick`` s.
    """
    cost = record["cost"]
    return yardstick * statistics.median(
        a / b for a, b in zip(cost["cpu_s"], cost["yardstick_s"], strict=True)
    )


def accuracy_sweep(job: SimpleNamespace) -> None:
    """Job: `sweep`, `scene` -> `records` (JSON)."""
    records = []
    for record in measure_all(sweeps()[job.sweep[0]], load_scene(job.scene[0])):
        print(record["name"], f"{record['cost']['cpu_s'][0]:.1f} s", record["failure"], flush=True)
        records.append(record)
    write_text(job.records[0], json.dumps(records, indent=1) + "\n")
