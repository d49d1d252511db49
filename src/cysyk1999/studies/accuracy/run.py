"""What accuracy costs in time: the runs of the study, one point each, and what is measured of them.

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
from dataclasses import asdict, dataclass, replace
from functools import partial
from multiprocessing import get_context
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad import load_scene
from fingerpad.files import write_text
from fingerpad.planning.plan import RULES, Plan, plan
from fingerpad.specimen.build import build_pad_mesh, count_nodes
from fingerpad.specimen.pad import PadMesh

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

    from fingerpad.scenes.scene import Scene

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
DEPTHS = (600e-6, 915e-6)
LONG = 5.0
"""s of process time: what takes longer is measured once, for its spread is small beside it."""
WAY = np.array([0.25, 0.5, 0.75, 1.0])
"""Parts of the way of a stroke at which it is looked at."""


@dataclass(frozen=True)
class Point:
    """One discretisation of one scene.

    Attributes:
        family: key of FAMILY. element: key of the elements. rows: mesh size, see ROWS. steps: of
        each leg (a slide's have the length that belongs to them). tolerance: of Newton's method, on
        the force. finite: strain. preset: name, in place of all.
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
        """Name of the point's file: family and whatever is not the default's."""
        if self.preset:
            return f"{self.family}_{self.preset}"
        exponent = round(-np.log10(self.tolerance))
        return f"{self.family}_{self.element}_m{self.rows}_s{self.steps}_t{exponent}_{'finite' if self.finite else 'small'}"


def points() -> dict[str, Point]:
    """Every point of the study by its name."""
    found = []
    for family in FAMILY:
        found += [Point(family, element, rows) for element in ELEMENTS for rows in ROWS]
        found += [Point(family, steps=steps) for steps in STEPS]
        found += [Point(family, tolerance=tolerance) for tolerance in TOLERANCES]
        found += [Point(family, finite=False)] + [
            Point(family, preset=preset) for preset in ("draft", "fine")
        ]
    return {point.name: point for point in found}


def sweeps() -> dict[str, list[Point]]:
    """The points by scene and element, as they are run together."""
    found: dict[str, list[Point]] = {}
    for point in points().values():
        found.setdefault(f"{point.family}_{point.element}", []).append(point)
    return found


def split(mesh: PadMesh, kind: str) -> PadMesh:
    """A mesh of quad9 split into "quad4" (four each) or "tri6" (two each) with the same nodes;
    mirror images stay so.
    """
    cells, curves = mesh.cells, mesh.curves
    if kind == "quad4":
        parts = [(0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)]
        cells = np.concatenate([cells[:, part] for part in parts])
        curves = {
            name: np.column_stack([facets[:, 0], facets[:, 2], facets[:, 2], facets[:, 1]]).reshape(
                -1, 2
            )
            for name, facets in curves.items()
        }
        region = np.tile(mesh.region, 4)
    elif kind == "tri6":
        left = mesh.points[cells[:, 8], 0] < 0
        one = [(0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7)]
        other = [(0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 6, 8)]
        cells = np.concatenate(
            [
                np.where(left[:, None], cells[:, b], cells[:, a])
                for a, b in zip(one, other, strict=True)
            ]
        )
        region = np.tile(mesh.region, 2)
    else:
        raise ValueError(f"quad9 cannot be split into {kind}; allowed: quad4, tri6")
    return replace(mesh, cells=cells, element=kind, region=region, curves=curves)


def discretised(point: Point, scene: Scene) -> tuple[Scene, Plan]:
    """The scene with the receptors that are looked at, and the plan of the point."""
    from fingerpad.scenes.scene import Receptors

    receptors = Receptors(depths=DEPTHS, offsets=(0.0,))
    effects = scene.effects | {"finite_strain": point.finite}
    scene = scene.varied({"outputs.receptors": receptors, "effects": effects}).with_accuracy(
        point.preset or "thesis"
    )
    chosen = plan(scene)
    if point.preset:
        return scene, chosen
    size, scale = chosen.mesh_size, DEFAULT_ROWS / point.rows
    # growth from edge to edge in proportion, so that meshes are refined alike everywhere
    growth = min(RULES.presets["thesis"].growth ** scale, 3.0)
    thickness = scene.specimen.outline.epidermis_thickness
    size = replace(
        size, skin_edge=size.skin_edge * scale, layer_edge=thickness / point.rows, growth=growth
    )
    size = replace(
        size, focus=(), skin_radial_edge=None
    )  # uniform ones: what elements are worth, wherever they are
    slide_step = chosen.slide_step * DEFAULT_STEPS / point.steps
    update = {"element": point.element, "mesh_size": size, "contact_edge": size.skin_edge}
    return scene, replace(chosen, **update, steps_per_leg=point.steps, slide_step=slide_step)


def meshed(scene: Scene, chosen: Plan) -> PadMesh:
    """The whole pad's mesh for the plan's element."""
    mesh = build_pad_mesh(scene.specimen.outline, chosen.mesh_size)
    kind = {"Q2P1": "quad9", "Q2": "quad9", "Q2R": "quad9", "P2B": "tri6"}.get(
        chosen.element, "quad4"
    )
    return mesh if kind == "quad9" else split(mesh, kind)


def simulation(point: Point, scene: Scene, chosen: Plan, mesh: PadMesh):
    """The simulation of a point, ready to run; teaching elements too."""
    from fingerpad.mechanics.stepping import NewtonSettings
    from fingerpad.simulation import Simulation

    class Teaching(Simulation):
        def _receptors(self, instantaneous):
            space = self.body.space
            if space.element.pressure_modes not in (1, 3):
                space.pressure_modes = partial(_nearest_mode, space)
            return super()._receptors(instantaneous)

    run = Teaching(scene, chosen, mesh)
    share = point.tolerance / DEFAULT_TOLERANCE
    default = NewtonSettings()
    run.stepper.settings = replace(
        default,
        force_tolerance=default.force_tolerance * share,
        gap_tolerance=default.gap_tolerance * share,
    )
    return run


def _nearest_mode(space, elements, points):
    """Pointwise pressure modes (n, nq) at ``points`` (n, 2): those of the nearest quadrature
    point.
    """
    position = np.einsum("qa,nai->nqi", space.element.values, space.points[space.cells[elements]])
    nearest = np.sum((position - points[:, None]) ** 2, axis=2).argmin(1)
    return np.where(
        np.arange(space.psi.shape[1]) == nearest[:, None], space.psi[elements, nearest], 0.0
    )


def values(history: xr.Dataset) -> dict[str, list[float]]:
    """Quantity -> its values (SI) at the moments looked at: top of the ramp and end, or the top and
    along the stroke.

    The peak rate of strain energy is one of the ramp, at each depth.
    """
    top, way = (
        int(np.flatnonzero(history.leg == history.leg[0])[-1]),
        history.stroke_distance.values,
    )
    energies = history.strain_energy_density.values.T
    traces = {
        "depth": history.indentation_depth.values,
        "width": history.contact_width.values,
        "centre pressure": history.centre_pressure.values,
        "peak pressure": history.peak_pressure.values,
    } | {
        f"energy {depth * 1e6:.0f} um": energy
        for depth, energy in zip(DEPTHS, energies, strict=True)
    }

    def looked_at(trace):
        if way[-1] == 0:
            return [trace[top], trace[-1]]
        return [trace[top], *np.interp(WAY * way[-1], way[top:], trace[top:])]

    found = {name: [float(value) for value in looked_at(trace)] for name, trace in traces.items()}
    rates = np.gradient(energies[:, : top + 1], history.time.values[: top + 1], axis=1)
    return found | {"peak energy rate": np.abs(rates).max(1).tolist()}


RULER = Point("flat", rows=2)
"""The yardstick: a small run before and after each, beside whose process time others stand."""


def measure_all(sweep: list[Point], scene: Scene) -> Iterator[dict[str, Any]]:
    """What :func:`measure` says of each point; each in a process of its own, with the kernels
    loaded before.
    """
    processes = get_context("fork")
    with processes.Pool(1) as pool:  # what compiling takes of memory is nobody's
        pool.apply(_load_kernels, (sweep, scene))
    _load_kernels(sweep, scene)
    with processes.Pool(1, maxtasksperchild=1) as pool:
        yield from pool.imap(partial(measure, scene=scene), sweep)


def _load_kernels(sweep: list[Point], scene: Scene) -> None:
    """Those of a sweep and of the yardstick, compiled if they are not kept."""
    for finite in {point.finite for point in sweep}:
        first = replace(sweep[0], rows=2, steps=5, finite=finite)
        _run(first, *discretised(first, scene)), _run(RULER, *discretised(RULER, _plate(scene)))


def _plate(scene: Scene) -> Scene:
    """The yardstick's scene: pressed by a plate as far as the first leg goes."""
    from fingerpad.scenes.scene import Flat

    return scene.varied({"stimulus": Flat(), "friction": 0.0, "motion": scene.motion[:1]})


def measure(point: Point, scene: Scene, repeats: int = 3) -> dict[str, Any]:
    """Run a point and say what it answers and costs.

    Args:
        repeats: of the whole run, of which costs are medians; one that takes longer than
        :data:`LONG` is run once.

    Returns:
        JSON-able: the point; values or the reason of failure; cost: process time of each repeat,
        meshing included, with that of the yardstick around it; memory of the process, unknowns,
        iterations; machine and versions.
    """
    from threadpoolctl import threadpool_limits

    from fingerpad.mechanics.stepping import NonConvergence
    from fingerpad.results import peak_memory_MB, provenance, states_found

    ruler = discretised(RULER, _plate(scene))
    seconds, yardstick, history, failure = [], [], None, ""
    with threadpool_limits(1):
        before = _timed(lambda: _run(RULER, *ruler))
        for _ in range(repeats):
            start = time.process_time()
            chosen_scene, chosen = discretised(point, scene)
            try:
                history = _run(point, chosen_scene, chosen)
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
        known = json.loads(history.attrs["cost"])
        cost |= {
            "nodes": count_nodes(chosen_scene.specimen.outline, chosen.mesh_size),
            "unknowns": known["unknowns"],
            "steps": states_found(history),
            "iterations": int(history.newton_iterations.sum()),
            "cutbacks": int(history.cutbacks.sum()),
            "energy_balance_error": float(history.energy_balance_error[-1]),
        }
        found["values"] = {} if failure else values(history)
        found["believed_error"] = float(history.attrs["estimated_error"])
    return found | {"cost": cost, "load": os.getloadavg()[0], "made_by": provenance()}


def _run(point, scene, chosen):
    return simulation(point, scene, chosen, meshed(scene, chosen)).run(None)


def _timed(call):
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
