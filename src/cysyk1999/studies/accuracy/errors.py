"""Runs of the study of accuracy -> reference, errors, costs: what its tables and figures show and
what the planner goes by.
"""

from __future__ import annotations

import json
import statistics
import timeit
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.accuracy.convergence import Limit, fitted_order, limit
from cysyk1999.studies.accuracy.run import (
    DEFAULT_ROWS,
    DEFAULT_STEPS,
    DEPTHS,
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

Records = Mapping[str, dict[str, Any]]

HEADLINE = ("depth", "width", "centre pressure", "peak pressure", "energy 600 um", "energy 915 um")
"""The quantities whose largest error is the error of a discretisation; the rate is shown beside
them.
"""
QUANTITIES = (*HEADLINE, "peak energy rate")
HALF_PLANE, WATER_BED = "elastic half-plane", "water bed"
FINITE_ELEMENTS = "finite elements"
FINE_ROWS = ROWS[-2]
"""Rows of the mesh that is like that of the preset fine, which has twice the default's steps."""


def _series(records: Records, points: Iterable[Point], quantity: str) -> np.ndarray:
    """(points, moments) values of a quantity; nan for a run that failed."""
    found = [records[point.name]["values"].get(quantity) for point in points]
    moments = max(len(values) for values in found if values)
    return np.array([values or [np.nan] * moments for values in found])


def _limits(sizes, series) -> list[Limit]:
    return [limit(sizes, column) for column in series.T]


def mesh_limits(records: Records, family: str, quantity: str) -> list[Limit]:
    """Limit in the mesh size of the default element, at the default's time steps, a moment each."""
    rows = [rows for rows in ROWS if Point(family, rows=rows).name in records]
    return _limits(
        1 / np.array(rows), _series(records, [Point(family, rows=n) for n in rows], quantity)
    )


def step_limits(records: Records, family: str, quantity: str) -> list[Limit]:
    """Limit in the step size on the default's mesh, a moment each."""
    return _limits(
        1 / np.array(STEPS), _series(records, [Point(family, steps=n) for n in STEPS], quantity)
    )


def interplay(records: Records, family: str, quantity: str) -> np.ndarray:
    """How far the preset fine is from the sum of what its mesh and its steps change by themselves,
    (moments,).

    Where friction keeps what steps have left behind, they do not simply add.
    """

    def at(**changes):
        return np.array(records[Point(family, **changes).name]["values"][quantity])

    return np.abs(at(preset="fine") - at(rows=FINE_ROWS) - at(steps=2 * DEFAULT_STEPS) + at())


def references(records: Records, family: str) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Quantity -> converged value and its uncertainty (moments,): the limit in the mesh, corrected
    by that in the steps.

    The uncertainty is that of both limits, and of adding them.
    """
    found = {}
    for quantity in QUANTITIES:
        default = np.array(records[Point(family).name]["values"][quantity])
        mesh, steps = mesh_limits(records, family, quantity), step_limits(records, family, quantity)
        value = np.array([m.value + s.value for m, s in zip(mesh, steps, strict=True)]) - default
        uncertainty = np.array(
            [m.uncertainty + s.uncertainty for m, s in zip(mesh, steps, strict=True)]
        )
        found[quantity] = value, uncertainty + interplay(records, family, quantity)
    return found


def errors(values: Mapping[str, list[float]], reference) -> dict[str, float]:
    """Quantity -> largest relative error of its moments; nan where there is no value."""
    found = {}
    for quantity in QUANTITIES:
        value, (converged, _) = np.array(values.get(quantity) or [np.nan]), reference[quantity]
        off = np.abs(value - converged[-len(value) :]) / np.abs(converged[-len(value) :])
        found[quantity] = float(np.nanmax(off)) if np.isfinite(off).any() else np.nan
    return found


def accuracy_table(records: Records, scenes: Mapping[str, Any]) -> pd.DataFrame:
    """Every point, the historical models and the references: errors (%), cost (s, MB, unknowns,
    iterations).

    Args:
        records: by name. scenes: family -> its scene, whose specimen the historical models take
        their measures from.
    """
    yardstick = statistics.median(
        s for record in records.values() for s in record["cost"]["yardstick_s"]
    )
    rows = []
    for family in FAMILY:
        known = {
            name: record for name, record in records.items() if record["point"]["family"] == family
        }
        if not known:
            continue
        reference, default = (
            references(records, family),
            seconds(records[Point(family).name], yardstick),
        )
        for record in known.values():
            rows.append(_row(record, reference, seconds(record, yardstick), default))
        if family in PRESSED:
            width = float(references(records, "flat")["width"][0][-1])
            for name, (_, fit) in MODELS.items():
                rows.append(
                    _historical(
                        name, fit(scenes["flat"], width), family, scenes[family], reference, default
                    )
                )
        uncertain = {
            f"{q} (%)": 100 * float(np.max(u / np.abs(v))) for q, (v, u) in reference.items()
        }
        rows.append({"scene": family, "model": "uncertainty of the reference"} | uncertain)
    table = pd.DataFrame(rows)
    table["machine"] = "; ".join(
        sorted({_machine(record["made_by"]) for record in records.values()})
    )
    return table


def _machine(made_by: Mapping[str, Any]) -> str:
    versions = {"python": made_by["python"]} | {
        name: made_by["packages"][name] for name in ("numpy", "numba", "mkl", "gmsh")
    }
    return ", ".join(
        [made_by["processor"], *(f"{name} {version}" for name, version in versions.items())]
    )


def _row(record, reference, cpu, default) -> dict[str, Any]:
    point, cost = record["point"], record["cost"]
    off = errors(record["values"], reference)
    return {
        "scene": point["family"],
        "model": FINITE_ELEMENTS,
        "preset": point["preset"]
        or ("thesis" if record["name"] == Point(point["family"]).name else ""),
        "element": point["element"],
        "rows": "" if point["preset"] else point["rows"],
        "strain": "finite" if point["finite"] else "small",
        "tolerance": point["tolerance"],
        "steps": cost.get("steps"),
        "steps per leg": "" if point["preset"] else point["steps"],
        "nodes": cost.get("nodes"),
        "unknowns": cost.get("unknowns"),
        "iterations": cost.get("iterations"),
        "cutbacks": cost.get("cutbacks"),
        "memory (MB)": cost["memory_MB"],
        "process time (s)": cpu,
        "cost (1 = default)": cpu / default,
        "repeats": len(cost["cpu_s"]),
        "load": record["load"],
        "error (%)": 100 * max(off[q] for q in HEADLINE),
        **{f"{q} (%)": 100 * off[q] for q in QUANTITIES},
        "failure": record["failure"],
    }


# -- the historical models ---


def half_plane_modulus(scene, width: float) -> float:
    """Young's modulus (Pa) with which a half-plane has the contact ``width`` (m) under the plate at
    the end of the hold.
    """
    specimen = scene.specimen
    force = scene.motion[0].press_to_force / specimen.contact_length
    poisson = specimen.layers.dermis.poisson_ratio
    return 4 * force * specimen.outline.apex_radius / (np.pi * (width / 2) ** 2) * (1 - poisson**2)


def half_plane(scene, curvature: float, modulus: float) -> dict[str, float]:
    """What the elastic half-plane of ``modulus`` (Pa) answers at the end of the hold."""
    specimen = scene.specimen
    outline, poisson = specimen.outline, specimen.layers.dermis.poisson_ratio
    force = scene.motion[0].press_to_force / specimen.contact_length
    radius = 1 / (1 / outline.apex_radius + curvature)
    depth, half_width, peak = phillips_johnson.press(
        force, radius, modulus, poisson, outline.soft_thickness
    )
    edges = half_width * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 201))
    pressures = hertz.pressure((edges[1:] + edges[:-1]) / 2, half_width, peak)
    stress = phillips_johnson.strip_stresses(0.0, np.array(DEPTHS), edges, pressures)
    shear, bulk = modulus / 2 / (1 + poisson), modulus / 3 / (1 - 2 * poisson)
    # as the headline's: the relaxed stress on instantaneous moduli
    instantaneous = shear / (1 - sum(term.g for term in specimen.prony))
    energies = phillips_johnson.strain_energy_density(*stress, instantaneous, bulk, poisson)
    found = {
        "depth": depth,
        "width": 2 * half_width,
        "centre pressure": peak,
        "peak pressure": peak,
    }
    return found | {
        f"energy {z * 1e6:.0f} um": float(e) for z, e in zip(DEPTHS, energies, strict=True)
    }


def water_bed_tension(scene, width: float) -> float:
    """Tension (N/m) with which a water bed has the contact ``width`` (m) under the plate at the end
    of the hold.
    """
    force = scene.motion[0].press_to_force / scene.specimen.contact_length

    def excess(log):
        return water_bed(scene, 0.0, np.exp(log))["width"] - width

    return float(np.exp(brentq(excess, np.log(0.3 * force), np.log(100 * force), xtol=1e-6)))


def water_bed(scene, curvature: float, tension: float) -> dict[str, float]:
    """What the water bed of ``tension`` (N/m) answers at the end of the hold."""
    outline = scene.specimen.outline
    force = scene.motion[0].press_to_force / scene.specimen.contact_length
    half_width = min(
        outline.half_width, 0.999 * outline.apex_radius
    )  # a pad wider than the circle at its apex is half of it
    state = waterbed.press(force, tension, outline.apex_radius, half_width, curvature)
    pressures = dict.fromkeys(("centre pressure", "peak pressure"), state.pressure)
    return {"depth": state.depth, "width": 2 * state.half_width} | pressures


MODELS = {HALF_PLANE: (half_plane, half_plane_modulus), WATER_BED: (water_bed, water_bed_tension)}
"""Name -> the model, and its constant from the width of the contact with the plate."""


def _historical(name, constant, family, scene, reference, default) -> dict[str, Any]:
    model = MODELS[name][0]
    args = scene, getattr(scene.stimulus, "curvature", 0.0), constant
    off = errors({quantity: [value] for quantity, value in model(*args).items()}, reference)
    cpu = min(timeit.repeat(lambda: model(*args), number=1, repeat=5))
    return {
        "scene": family,
        "model": name,
        "process time (s)": cpu,
        "cost (1 = default)": cpu / default,
        "error (%)": 100 * np.nanmax([off[q] for q in HEADLINE]),
        **{f"{q} (%)": 100 * off[q] for q in QUANTITIES},
    }


# -- what follows from the errors ---


def orders_table(records: Records) -> pd.DataFrame:
    """Observed orders and grid convergence index of every element and of the steps, a quantity each
    (its last moment).
    """
    rows = []
    for family in FAMILY:
        if Point(family).name not in records:
            continue
        sweeps = {element: [Point(family, element, rows) for rows in ROWS] for element in ELEMENTS}
        sweeps["time steps"] = [Point(family, steps=n) for n in STEPS]
        for name, sweep in sweeps.items():
            sweep = [p for p in sweep if records.get(p.name, {}).get("values")]
            if len(sweep) < 3:
                continue
            sizes = np.array([1 / p.steps if name == "time steps" else 1 / p.rows for p in sweep])
            for quantity in QUANTITIES:
                series = _series(records, sweep, quantity)
                known = (step_limits if name == "time steps" else mesh_limits)(
                    records, family, quantity
                )
                own = _limits(sizes, series)
                worst = max(
                    each.uncertainty / abs(column[-1])
                    for each, column in zip(own, series.T, strict=True)
                )
                rows.append(
                    {
                        "scene": family,
                        "refined": "steps" if name == "time steps" else "mesh",
                        "element": "Q2P1" if name == "time steps" else name,
                        "quantity": quantity,
                        "order, three finest": own[-1].order,
                        "order, fitted to all but the finest": fitted_order(
                            sizes[:-1], series[:-1, -1] - known[-1].value
                        ),
                        "grid convergence index (%)": 100 * worst,
                    }
                )
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
    rows = []
    energies = tuple(quantity for quantity in HEADLINE if quantity.startswith("energy"))
    for kind, counts, limits, quantities in (
        ("mesh", ROWS, mesh_limits, HEADLINE),
        ("energy", ROWS, mesh_limits, energies),
        ("steps", STEPS, step_limits, HEADLINE),
    ):
        columns = {}
        for family in PRESSED:
            if Point(family).name not in records:
                continue
            worst = np.zeros(len(counts))
            for quantity in quantities:
                known = limits(records, family, quantity)
                value = np.array([each.value for each in known])
                extra = interplay(records, family, quantity) if kind != "steps" else 0.0
                unsure = np.array([each.uncertainty for each in known])
                for k, n in enumerate(counts):
                    floor = _at_most(unsure + extra * min(1.0, DEFAULT_ROWS / n), value)
                    record = records.get(
                        (Point(family, steps=n) if kind == "steps" else Point(family, rows=n)).name
                    )
                    if record is None or not record["values"]:
                        worst[k] = np.nan
                        continue
                    off = _at_most(np.array(record["values"][quantity]) - value, value)
                    worst[k] = max(worst[k], off, floor)
            columns[family] = np.fmax.accumulate(worst[::-1])[::-1]
        for k, n in enumerate(counts):
            rows.append(
                {"kind": kind, "count": n}
                | {family: float(f"{column[k]:.2g}") for family, column in columns.items()}
            )
    return pd.DataFrame(rows)


def _at_most(off: np.ndarray, value: np.ndarray) -> float:
    return float(np.max(np.abs(off / value)))


def presets_table(table: pd.DataFrame) -> pd.DataFrame:
    """The named presets: discretisation, cost and errors, of :func:`accuracy_table`."""
    found = table[table["preset"].isin(["draft", "thesis", "fine"])].copy()
    found["preset"] = pd.Categorical(found["preset"], ["draft", "thesis", "fine"])
    keep = [
        "preset",
        "scene",
        "nodes",
        "unknowns",
        "steps",
        "iterations",
        "memory (MB)",
        "process time (s)",
    ]
    keep += ["cost (1 = default)", "error (%)", *(f"{q} (%)" for q in QUANTITIES), "machine"]
    return (
        found.sort_values(["preset", "scene"])[keep].astype({"preset": str}).reset_index(drop=True)
    )


def pareto(cost: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Mask of the points that no other beats in both; nan is on no front."""
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    on = np.zeros(len(cost), bool)
    best = np.inf
    for k in np.lexsort((error, cost)):
        if np.isfinite(cost[k]) and error[k] < best:
            best, on[k] = error[k], True
    return on


def growth(nodes: np.ndarray, cost: np.ndarray, least: float = 3000) -> tuple[float, float]:
    """Factor and exponent of cost = factor nodes^exponent, least squares over meshes of ``least``
    nodes and more.
    """
    large = np.asarray(nodes) >= least
    exponent, intercept = np.polyfit(
        np.log(np.asarray(nodes)[large]), np.log(np.asarray(cost)[large]), 1
    )
    return float(np.exp(intercept)), float(exponent)


def error_frame(table: pd.DataFrame, scenes: Iterable[str]) -> pd.DataFrame:
    """Error against cost: one row a discretisation and quantity, the worst of ``scenes`` and their
    mean cost; front marked.
    """
    chosen = table[table["scene"].isin(list(scenes)) & table["error (%)"].notna()]
    keys = ["model", "preset", "element", "rows", "strain", "tolerance", "steps per leg"]
    chosen = chosen.assign(**{key: [_text(value) for value in chosen[key]] for key in keys})
    whole = (
        chosen.groupby(keys, sort=False)["scene"].transform("nunique") == chosen["scene"].nunique()
    )
    grouped = chosen[whole].groupby(keys, sort=False)
    rows = []
    for quantity in QUANTITIES:
        frame = grouped.agg(
            **{
                "cost (1 = default)": ("cost (1 = default)", "mean"),
                "error (%)": (f"{quantity} (%)", "max"),
                "nodes": ("nodes", "max"),
            }
        ).reset_index()
        frame.insert(0, "quantity", quantity)
        frame["pareto"] = pareto(frame["cost (1 = default)"], frame["error (%)"])
        rows.append(frame)
    found = pd.concat(rows, ignore_index=True).assign(source="simulated")
    uncertain = table[
        (table["model"] == "uncertainty of the reference") & table["scene"].isin(list(scenes))
    ]
    found["uncertainty (%)"] = found["quantity"].map(lambda q: uncertain[f"{q} (%)"].max())
    return found


def _text(value: object) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:g}"
    return str(value)


def growth_frame(table: pd.DataFrame) -> pd.DataFrame:
    """Process time and memory against nodes, a row each element and mesh (mean of pressed scenes),
    with fitted exponents.
    """
    plane = table[
        table["scene"].isin(PRESSED)
        & (pd.to_numeric(table["steps per leg"], errors="coerce") == DEFAULT_STEPS)
        & (table["strain"] == "finite")
        & (table["tolerance"] == 1e-4)
    ]
    mean = (
        plane.groupby(["element", "nodes"])[
            ["process time (s)", "cost (1 = default)", "memory (MB)", "iterations"]
        ]
        .mean()
        .reset_index()
    )
    rows = []
    for _, part in mean.groupby("element"):
        if (part["nodes"] >= 3000).sum() >= 2:
            _, exponent = growth(part["nodes"].to_numpy(), part["process time (s)"].to_numpy())
            part = part.assign(exponent=exponent)
        rows.append(part)
    return pd.concat(rows, ignore_index=True).assign(source="simulated")


FRAMES = {
    "accuracy_error": lambda table: error_frame(table, PRESSED),
    "accuracy_error_stroke": lambda table: error_frame(table, ("stroke",)),
    "accuracy_growth": growth_frame,
    "accuracy_belief": lambda table: table,
    "accuracy_drawn": lambda table: table,
    "accuracy_ridges": lambda table: table,
    "accuracy_shown": lambda table: table.drop_duplicates(list(table.columns[2:])).reset_index(
        drop=True
    ),
}
"""Figure name -> its data frame, of the table of accuracy, of beliefs, or of errors shown, of which
each curve is drawn once.
"""


def accuracy_tables(job: SimpleNamespace) -> None:
    """Job: `records` (JSON), `scenes` in the order of FAMILY -> `tables`: accuracy, accuracy_orders,
    accuracy_planner, presets.
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
