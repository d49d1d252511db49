"""Data of the study of ridges, read from short strokes over pads with other ridges and the scenes'
strokes over outer ones.

The figures are :mod:`cysyk1999.studies.ridges.picture`'s.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.direction import BESIDE, DEPTH, KEY, both_ways, directional_index, islands
from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.measures.quantities import DISTANCE, SED, P, X
from cysyk1999.publishing.write import without_round_off, write_frame
from cysyk1999.studies.common.ridges import boundary
from cysyk1999.studies.ridges.picture import (
    BAND,
    DRAWN,
    EDGE,
    FRICTION,
    HEIGHT,
    INDEX,
    LEFT,
    MESHES,
    NODES,
    OFFSET,
    RECEPTOR,
    RECEPTORS_SWEPT,
    RIGHT,
)
from cysyk1999.studies.ridges.run import AWAY, FLANK, GRID, Case, tip_at_depth
from fingerpad.measures.features import PRESSURE, SIMULATED, Histories, energy, profile
from fingerpad.measures.strokes import loaded
from fingerpad.results import scene_of

OUTER = ("ridged_outer_stroke_right", "ridged_outer_stroke_left")


def places(history: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Receptors of the sweeps: (depth, offset from a tip) m."""
    flank = boundary_of(history, FLANK)
    beside = (round(flank - AWAY, 9), -FLANK), (round(flank + AWAY, 9), -FLANK)
    return dict(zip(RECEPTORS_SWEPT, ((DEPTH, -BESIDE), *beside), strict=True))


def tip_of(history: xr.Dataset) -> float:
    """Lateral position (m) of the ridge's tip nearest to x = 0, at the thesis's depth."""
    specimen = scene_of(history).specimen
    if specimen.ridges is None or isinstance(specimen.ridges.inner.phase, str):
        return 0.0
    return tip_at_depth(specimen.outline, specimen.ridges.inner.phase)


def boundary_of(history: xr.Dataset, x: float) -> float:
    """Depth (m) at which the epidermis of a history's pad ends at an offset (m) from the tip."""
    specimen = scene_of(history).specimen
    return boundary(specimen.outline, specimen.ridges, tip_of(history) + x)


def frames(cases: Histories, strokes: Histories, coarse: Histories) -> dict[str, pd.DataFrame]:
    """Data of every figure, by its name.

    Parameters
    ----------
    cases : short strokes, by the case's name.
    strokes, coarse : scenes :data:`OUTER` and the companions they have.
    """
    return {
        "offset": offset_frame(cases),
        "height": sweep_frame(cases, HEIGHT),
        "friction": sweep_frame(cases, FRICTION),
        "mesh": mesh_frame(cases),
        "outer": outer_frame(strokes, coarse),
    }


def index_and_error(
    fine: xr.Dataset, coarse: xr.Dataset | None, *place: float
) -> tuple[float, float]:
    """Directional index at a place, and its difference to a companion's (NaN without)."""
    value = directional_index(fine, *place)
    other = float("nan") if coarse is None else directional_index(coarse, *place)
    return value, abs(value - other)


def _of(cases: Histories, height: float, mesh: str) -> xr.Dataset:
    return cases[str(Case(height, KEY[1], mesh))]


def offset_frame(cases: Histories) -> pd.DataFrame:
    """Index over depth and offset round a ridge on the fine mesh, the boundary, and the profile at
    the thesis's depth.
    """
    fine = _of(cases, KEY[0], "fine")
    rows = [
        ("map", "inner ridges", x, z, directional_index(fine, z, x))
        for z in GRID[0]
        for x in GRID[1]
    ]
    parts = [pd.DataFrame(rows, columns=["panel", "series", OFFSET, RECEPTOR, INDEX])]
    x = np.linspace(GRID[1][0], GRID[1][-1], 121)
    specimen = scene_of(fine).specimen
    depths = [boundary(specimen.outline, specimen.ridges, at) for at in x]
    parts.append(pd.DataFrame({"panel": "boundary", OFFSET: x, RECEPTOR: depths}))
    pairs = {
        "no ridges": (_of(cases, 0, "thesis"), _of(cases, 0, "coarse")),
        "inner ridges": (fine, _of(cases, KEY[0], "thesis")),
    }
    for series, (history, companion) in pairs.items():
        rows = []
        for at in sorted({*GRID[1], -BESIDE, BESIDE}):
            right, left = both_ways(history, DEPTH, at)
            rows.append(
                (at, *index_and_error(history, companion, DEPTH, at), right.mean(), left.mean())
            )
        profile_rows = pd.DataFrame(rows, columns=[OFFSET, INDEX, BAND, RIGHT, LEFT])
        parts.append(profile_rows.assign(panel="profile", series=series, **{RECEPTOR: DEPTH}))
    frame = pd.concat(parts, ignore_index=True)
    frame[[OFFSET, RECEPTOR]] = (frame[[OFFSET, RECEPTOR]] * 1e6).round(3)
    frame.insert(0, "source", SIMULATED)
    return frame


def sweep_frame(cases: Histories, column: str) -> pd.DataFrame:
    """Index of three receptors against the height of the ridges or friction, with the
    layer each lies in.
    """
    rows = []
    for name, history in cases.items():
        case = Case.named(name)
        at, held = (case.height, case.friction), KEY[1]
        if column == FRICTION:
            at, held = at[::-1], KEY[0]
        if case.mesh != "thesis" or at[1] != held:
            continue
        coarse = cases.get(str(replace(case, mesh="coarse")))
        for series, (depth, offset) in places(history).items():
            layer = "epidermis" if depth < boundary_of(history, offset) else "dermis"
            index = index_and_error(history, coarse, depth, offset)
            rows.append((SIMULATED, series, layer, at[0], *index))
    frame = pd.DataFrame(rows, columns=["source", "series", "layer", column, INDEX, BAND])
    return frame.sort_values(["series", column], ignore_index=True)


def mesh_frame(cases: Histories) -> pd.DataFrame:
    """Energies both ways and the index at the thesis's place: on meshes that resolve the ridges,
    and drawn on its elements.
    """
    rows = []
    for mesh in (*MESHES, *DRAWN):
        history = cases.get(str(Case(*KEY, mesh)))
        if history is None:
            continue
        tip = tip_of(history)
        right, left = (values.mean() for values in both_ways(history, DEPTH, -BESIDE, tip=tip))
        panel, edge = ("resolved", MESHES[mesh]) if mesh in MESHES else ("drawn", MESHES["thesis"])
        nodes = json.loads(history.attrs["cost"])["nodes"]
        index = directional_index(history, DEPTH, -BESIDE, tip=tip)
        rows.append((SIMULATED, panel, mesh, edge, nodes, right, left, index))
    return pd.DataFrame(
        rows, columns=["source", "panel", "series", EDGE, NODES, RIGHT, LEFT, INDEX]
    )


def outer_frame(strokes: Histories, coarse: Histories) -> pd.DataFrame:
    """Pressure of the islands at the end of the press and of the stroke, their number on the way,
    and the receptors' energy.
    """
    parts = []
    for name, way in zip(OUTER, ("right", "left"), strict=True):
        stroke = loaded(strokes[name])
        way_mm = 1e3 * abs(stroke.stroke_distance.values)
        for x in (-BESIDE, 0.0, BESIDE):
            rows = {
                "panel": way,
                "series": f"{x * 1e6:.0f} µm",
                DISTANCE: way_mm,
                SED: energy(stroke, DEPTH, x),
            }
            parts.append(pd.DataFrame(rows))
    stroke = loaded(strokes[OUTER[0]])
    way_mm = 1e3 * abs(stroke.stroke_distance.values)
    for series, index in {"pressed": 0, "stroked by 50 mm": -1}.items():
        x, p = profile(stroke, index, PRESSURE)
        shown = (abs(x) < 4.5e-3) & (stroke.skin_y.values > 0)
        parts.append(
            pd.DataFrame({"panel": "pressure", "series": series, X: 1e3 * x[shown], P: p[shown]})
        )
    for series, history in {"simulated mesh": stroke, "companion": coarse.get(OUTER[0])}.items():
        if history is not None:
            one = loaded(history)
            rows = {DISTANCE: 1e3 * abs(one.stroke_distance.values), "islands (1)": islands(one)}
            parts.append(pd.DataFrame({"panel": "islands", "series": series, **rows}))
    frame = pd.concat(parts, ignore_index=True)
    frame.insert(0, "source", SIMULATED)
    return frame


def ridge_data(job: SimpleNamespace) -> None:
    """Job: `cases`, `histories`, `coarse` -> `data` (CSV, named as the study's frames)."""
    strokes, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    made = frames(read_results(job.cases)[0], strokes, coarse)
    for path in map(Path, job.data):
        write_frame(without_round_off(made[path.stem]), path)
