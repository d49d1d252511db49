"""Records of the study of accuracy -> reference values, errors and costs: its tables and the data
of its figures, and the errors that the planner uses.
"""

from __future__ import annotations

import json
import statistics
import timeit
from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.accuracy.compare import DEPTHS
from cysyk1999.studies.accuracy.convergence import Limit, fitted_order, limits
from cysyk1999.studies.accuracy.run import (
    DEFAULT_ROWS,
    DEFAULT_STEPS,
    ELEMENTS,
    FAMILY,
    PRESSED,
    ROWS,
    STEPS,
    Point,
    seconds,
)
from fingerpad import load_scene
from fingerpad.reference_solutions import hertz, phillips_johnson, waterbed
from fingerpad.scenes.scene import Scene

Records = Mapping[str, dict[str, Any]]

HEADLINE = ("depth", "width", "centre pressure", "peak pressure", "energy 600 um", "energy 915 um")
"""The quantities whose largest error is the error of a discretisation; the rate is shown beside
them.
"""
QUANTITIES = (*HEADLINE, "peak energy rate")
HALF_PLANE, WATER_BED = "elastic half-plane", "water bed"
FINITE_ELEMENTS, UNCERTAINTY = "finite elements", "uncertainty of the reference"
COUNTS = {"rows": ROWS, "steps": STEPS}
"""Field of a point -> its values where it alone is refined."""
FINE_ROWS = ROWS[-2]
"""Rows of the mesh that is like that of the preset fine, which has twice the default's steps."""


def series(records: Records, points: Iterable[Point], quantity: str) -> np.ndarray:
    """(points, moments) values of a quantity; nan for a run that failed or was not made."""
    found = [records.get(point.name, {}).get("values", {}).get(quantity) for point in points]
    moments = max(len(values) for values in found if values)
    return np.array([values or [np.nan] * moments for values in found])


def refined(
    records: Records, family: str, by: str, element: str = "Q2P1"
) -> tuple[np.ndarray, list[Point]]:
    """Falling sizes and the points that were solved with them: the default point with other "rows"
    or "steps".
    """
    points = [Point(family, element, **{by: count}) for count in COUNTS[by]]
    points = [point for point in points if records.get(point.name, {}).get("values")]
    return 1 / np.array([getattr(point, by) for point in points]), points


def limits_in(
    records: Records, family: str, by: str, quantity: str, element: str = "Q2P1"
) -> Limit:
    """Limit (moments,) in the mesh ("rows"), or in the time steps ("steps")."""
    sizes, points = refined(records, family, by, element)
    return limits(sizes, series(records, points, quantity))


def interplay(records: Records, family: str, quantity: str) -> np.ndarray:
    """How far the preset fine is from the sum of what its mesh and its steps change by themselves,
    (moments,).

    Where friction keeps what steps have left behind, they do not simply add.
    """
    points = (
        Point(family, preset="fine"),
        Point(family, rows=FINE_ROWS),
        Point(family, steps=2 * DEFAULT_STEPS),
        Point(family),
    )
    fine, mesh, steps, default = series(records, points, quantity)
    return np.abs(fine - mesh - steps + default)


def references(records: Records, family: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Quantity -> converged value and its uncertainty (moments,): the limit in the mesh, corrected
    by that in the steps.

    The uncertainty is that of both limits, and of adding them.
    """
    found = {}
    for quantity in QUANTITIES:
        mesh, steps = (limits_in(records, family, by, quantity) for by in COUNTS)
        value = mesh.value + steps.value - series(records, [Point(family)], quantity)[0]
        unsure = mesh.uncertainty + steps.uncertainty + interplay(records, family, quantity)
        found[quantity] = value, unsure
    return found


def errors(values: Mapping[str, list[float]], reference) -> dict[str, float]:
    """Columns of a table: the largest relative error (%) of each quantity at its moments, and of
    the headline; nan where there is no value.
    """
    found = {}
    for quantity in QUANTITIES:
        value = np.array(values.get(quantity) or [np.nan])
        converged = reference[quantity][0][-len(value) :]
        off = np.abs(value - converged) / np.abs(converged)
        found[quantity] = 100 * float(np.nanmax(off)) if np.isfinite(off).any() else np.nan
    largest = np.fmax.reduce([found[quantity] for quantity in HEADLINE])
    return {"error (%)": largest} | {f"{q} (%)": error for q, error in found.items()}


def accuracy_table(records: Records, scenes: Mapping[str, Scene]) -> pd.DataFrame:
    """Every point, the historical models and the references: errors (%), cost (s, MB, unknowns,
    iterations).

    Parameters
    ----------
    records : mapping
        Records by name.
    scenes : mapping
        Family -> its scene, of which the historical models take their measures.
    """
    yardstick = statistics.median(
        s for record in records.values() for s in record["cost"]["yardstick_s"]
    )
    rows = []
    for family in FAMILY:
        known = [each for each in records.values() if each["point"]["family"] == family]
        if not known:
            continue
        reference = references(records, family)
        default = seconds(records[Point(family).name], yardstick)
        rows += [_row(record, reference, seconds(record, yardstick), default) for record in known]
        if family in PRESSED:
            width = float(references(records, "flat")["width"][0][-1])
            rows += _historical(scenes, family, width, reference, default)
        uncertain = {f"{q} (%)": 100 * _worst(u, v) for q, (v, u) in reference.items()}
        rows.append({"scene": family, "model": UNCERTAINTY} | uncertain)
    machines = {_machine(record["made_by"]) for record in records.values()}
    return pd.DataFrame(rows).assign(machine="; ".join(sorted(machines)))


def _worst(off: np.ndarray, value: np.ndarray) -> float:
    return float(np.max(np.abs(off / value)))


def _machine(made_by: Mapping[str, Any]) -> str:
    packages = [f"{name} {made_by['packages'][name]}" for name in ("numpy", "numba", "mkl", "gmsh")]
    return ", ".join([made_by["processor"], f"python {made_by['python']}", *packages])


def _row(record, reference, cpu: float, default: float) -> dict[str, Any]:
    point, cost = record["point"], record["cost"]
    standard = record["name"] == Point(point["family"]).name
    return {
        "scene": point["family"],
        "model": FINITE_ELEMENTS,
        "preset": point["preset"] or ("thesis" if standard else ""),
        "element": point["element"],
        "rows": "" if point["preset"] else point["rows"],
        "strain": "finite" if point["finite"] else "small",
        "tolerance": point["tolerance"],
        "steps": cost.get("steps"),
        "steps per leg": "" if point["preset"] else point["steps"],
        **{key: cost.get(key) for key in ("nodes", "unknowns", "iterations", "cutbacks")},
        "memory (MB)": cost["memory_MB"],
        "process time (s)": cpu,
        "cost (1 = default)": cpu / default,
        "repeats": len(cost["cpu_s"]),
        "load": record["load"],
        **errors(record["values"], reference),
        "failure": record["failure"],
    }


# -- the historical models ---


def _force(scene: Scene) -> float:
    """Force (N/m) of a scene's press."""
    return scene.motion[0].press_to_force / scene.specimen.contact_length


def half_plane(scene: Scene, modulus: float) -> dict[str, float]:
    """What the elastic half-plane of ``modulus`` (Pa) answers at the end of the hold."""
    specimen = scene.specimen
    outline, poisson = specimen.outline, specimen.layers.dermis.poisson_ratio
    radius = 1 / (1 / outline.apex_radius + _curvature(scene))
    depth, half_width, peak = phillips_johnson.press(
        _force(scene), radius, modulus, poisson, outline.soft_thickness
    )
    edges = half_width * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 201))
    pressures = hertz.pressure((edges[1:] + edges[:-1]) / 2, half_width, peak)
    stress = phillips_johnson.strip_stresses(0.0, np.array(DEPTHS), edges, pressures)
    shear, bulk = modulus / 2 / (1 + poisson), modulus / 3 / (1 - 2 * poisson)
    # as the headline's: the relaxed stress on instantaneous moduli
    instantaneous = shear / (1 - sum(term.g for term in specimen.prony))
    energies = phillips_johnson.strain_energy_density(*stress, instantaneous, bulk, poisson)
    found = {"depth": depth, "width": 2 * half_width}
    found |= dict.fromkeys(("centre pressure", "peak pressure"), peak)
    return found | {f"energy {1e6 * z:.0f} um": e for z, e in zip(DEPTHS, energies, strict=True)}


def water_bed(scene: Scene, tension: float) -> dict[str, float]:
    """What the water bed of ``tension`` (N/m) answers at the end of the hold."""
    outline = scene.specimen.outline
    radius = outline.apex_radius
    # a pad wider than the circle at its apex is half of it
    half_width = min(outline.half_width, 0.999 * radius)
    state = waterbed.press(_force(scene), tension, radius, half_width, _curvature(scene))
    found = {"depth": state.depth, "width": 2 * state.half_width}
    return found | dict.fromkeys(("centre pressure", "peak pressure"), state.pressure)


def _curvature(scene: Scene) -> float:
    return getattr(scene.stimulus, "curvature", 0.0)


MODELS = {HALF_PLANE: (half_plane, (1e4, 1e6)), WATER_BED: (water_bed, (6.0, 2000.0))}
"""Name -> the model, and bounds of its constant: Young's modulus (Pa), and tension (N/m)."""


def fitted(name: str, scene: Scene, width: float) -> float:
    """Constant with which a model has the contact ``width`` (m) under the plate at the end of the
    hold.
    """
    model, bounds = MODELS[name]
    log = brentq(lambda log: model(scene, np.exp(log))["width"] - width, *np.log(bounds))
    return float(np.exp(log))


def _historical(scenes, family, width: float, reference, default: float) -> list[dict[str, Any]]:
    rows, scene = [], scenes[family]
    for name, (model, _) in MODELS.items():
        constant = fitted(name, scenes["flat"], width)
        found = {quantity: [value] for quantity, value in model(scene, constant).items()}
        cpu = min(timeit.repeat(lambda: model(scene, constant), number=1, repeat=5))  # noqa: B023
        row = {"scene": family, "model": name, "process time (s)": cpu}
        rows.append(row | {"cost (1 = default)": cpu / default} | errors(found, reference))
    return rows


# -- what follows from the errors ---


def orders_table(records: Records) -> pd.DataFrame:
    """Observed orders and grid convergence index of every element and of the steps, a quantity each
    (its last moment).
    """
    rows = []
    families = [family for family in FAMILY if Point(family).name in records]
    sweeps = [("mesh", "rows", element) for element in ELEMENTS] + [("steps", "steps", "Q2P1")]
    for family, (what, by, element) in product(families, sweeps):
        sizes, points = refined(records, family, by, element)
        if len(points) < 3:
            continue
        for quantity in QUANTITIES:
            last = series(records, points, quantity)[:, -1]
            own = limits_in(records, family, by, quantity, element)
            truth = limits_in(records, family, by, quantity).value[-1]
            row = {"scene": family, "refined": what, "element": element, "quantity": quantity}
            row["order, three finest"] = own.order[-1]
            row["order, fitted to all but the finest"] = fitted_order(sizes[:-1], last[:-1] - truth)
            index = _worst(own.uncertainty, series(records, points, quantity)[-1])
            rows.append(row | {"grid convergence index (%)": 100 * index})
    return pd.DataFrame(rows)


def planner_table(records: Records) -> pd.DataFrame:
    """What the planner goes by of presses: relative errors by mesh size, also of strain energies
    alone, and by steps of a leg.

    Errors of a mesh are those to the limit in the mesh at the default's steps, errors of steps
    those to the limit in the steps on the default's mesh; never below the limit's own uncertainty
    (and, of meshes, that of adding both, which is a product of theirs and falls with the edge
    beyond the default's mesh) nor below those of what is finer. The largest at the moments looked
    at, relative to what it is of.
    """
    families = [family for family in PRESSED if Point(family).name in records]
    energies = [quantity for quantity in HEADLINE if quantity.startswith("energy")]
    tables = {
        kind: pd.DataFrame({of: _largest(records, of, by, quantities) for of in families})
        for kind, by, quantities in (
            ("mesh", "rows", HEADLINE),
            ("energy", "rows", energies),
            ("steps", "steps", HEADLINE),
        )
    }
    table = pd.concat(tables, names=["kind", "count"])
    return table.map(lambda error: float(f"{error:.2g}")).reset_index()


def _largest(records: Records, family: str, by: str, quantities: Iterable[str]) -> pd.Series:
    """Largest relative error of some quantities by rows or steps, none below a finer one's."""
    sizes, points = refined(records, family, by)
    worst = np.zeros(len(sizes))
    for quantity in quantities:
        known = limits_in(records, family, by, quantity)
        off = np.abs(series(records, points, quantity) / known.value - 1).max(axis=1)
        unsure = known.uncertainty
        if by == "rows":
            share = np.minimum(1.0, DEFAULT_ROWS * sizes)[:, None]
            unsure = unsure + interplay(records, family, quantity) * share
        floor = np.abs(unsure / known.value).max(axis=-1)
        worst = np.maximum(worst, np.maximum(off, floor))
    counts = [getattr(point, by) for point in points]
    return pd.Series(np.fmax.accumulate(worst[::-1])[::-1], counts)


def presets_table(table: pd.DataFrame) -> pd.DataFrame:
    """The named presets: discretisation, cost and errors, of :func:`accuracy_table`."""
    columns = ["preset", "scene", "nodes", "unknowns", "steps", "iterations", "memory (MB)"]
    columns += ["process time (s)", "cost (1 = default)", "error (%)"]
    columns += [*(f"{q} (%)" for q in QUANTITIES), "machine"]
    parts = [table[table["preset"] == preset] for preset in ("draft", "thesis", "fine")]
    return pd.concat([part.sort_values("scene") for part in parts], ignore_index=True)[columns]


def pareto(cost: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Mask of the points that no other beats in both; nan is on no front."""
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    order = np.lexsort((error, cost))
    least_before = np.fmin.accumulate([np.inf, *error[order]])[:-1]
    on = np.zeros(len(cost), bool)
    on[order] = np.isfinite(cost[order]) & (error[order] < least_before)
    return on


def error_frame(table: pd.DataFrame, scenes: Iterable[str]) -> pd.DataFrame:
    """Error against cost: one row a discretisation and quantity, the worst of ``scenes`` and their
    mean cost; front marked.
    """
    here = table[table["scene"].isin(list(scenes))]
    chosen = here[here["error (%)"].notna()]
    keys = ["model", "preset", "element", "rows", "strain", "tolerance", "steps per leg"]
    chosen = chosen.assign(**{key: chosen[key].map(_text) for key in keys})
    complete = chosen.groupby(keys)["scene"].transform("nunique") == chosen["scene"].nunique()
    grouped = chosen[complete].groupby(keys, sort=False)
    known = grouped[["cost (1 = default)"]].mean()
    uncertain = here[here["model"] == UNCERTAINTY]
    frames = []
    for quantity in QUANTITIES:
        column = f"{quantity} (%)"
        frame = known.assign(
            **{"error (%)": grouped[column].max(), "nodes": grouped["nodes"].max()}
        )
        frame = frame.reset_index()
        frame.insert(0, "quantity", quantity)
        frame["pareto"] = pareto(frame["cost (1 = default)"], frame["error (%)"])
        frame["source"] = "simulated"
        frames.append(frame.assign(**{"uncertainty (%)": uncertain[column].max()}))
    return pd.concat(frames, ignore_index=True)


def _text(value: object) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:g}"
    return str(value)


def growth_frame(table: pd.DataFrame, least: float = 3000) -> pd.DataFrame:
    """Process time and memory against nodes, a row each element and mesh (mean of pressed scenes).

    Exponents of time are fitted over meshes of ``least`` nodes and more.
    """
    standard = (
        table["scene"].isin(PRESSED)
        & (pd.to_numeric(table["steps per leg"], errors="coerce") == DEFAULT_STEPS)
        & (table["strain"] == "finite")
        & (table["tolerance"] == 1e-4)
    )
    columns = ["process time (s)", "cost (1 = default)", "memory (MB)", "iterations"]
    mean = table[standard].groupby(["element", "nodes"])[columns].mean().reset_index()
    exponents = {
        element: fitted_order(part["nodes"], part["process time (s)"])
        for element, part in mean[mean["nodes"] >= least].groupby("element")
    }
    return mean.assign(exponent=mean["element"].map(exponents), source="simulated")


FRAMES = {
    "accuracy_error": lambda table: error_frame(table, PRESSED),
    "accuracy_error_stroke": lambda table: error_frame(table, ("stroke",)),
    "accuracy_growth": growth_frame,
    "accuracy_shown": lambda table: table.drop_duplicates(
        list(table.columns[2:]), ignore_index=True
    ),
}
"""Figure name -> its data frame, where that is not its table: of errors shown each curve is drawn
once.
"""


def accuracy_tables(job: SimpleNamespace) -> None:
    """Job: `records` (JSON), `scenes` in the order of FAMILY -> `tables`: accuracy,
    accuracy_orders, accuracy_planner, presets.
    """
    records = {
        record["name"]: record
        for path in job.records
        for record in json.loads(Path(path).read_text(encoding="utf-8"))
    }
    accuracy = accuracy_table(records, dict(zip(FAMILY, map(load_scene, job.scenes), strict=True)))
    made = (accuracy, orders_table(records), planner_table(records), presets_table(accuracy))
    for table, path in zip(made, job.tables, strict=True):
        publish_table(table, path)
