"""Data of the study of ridges, read from short strokes over pads with other ridges.

The figures are :mod:`cysyk1999.studies.ridges.picture`'s.
"""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.direction import BESIDE, DEPTH, KEY, both_ways, directional_index
from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.tables import without_round_off, write_frame
from cysyk1999.studies.common.ridges import boundary
from cysyk1999.studies.ridges.picture import (
    BAND,
    DRAWN,
    EDGE,
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
from fingerpad.measures.features import SIMULATED, Histories
from fingerpad.results import scene_of


def places(history: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Receptors of the sweep: (depth, offset from a tip) m."""
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


def index_and_error(
    fine: xr.Dataset, coarse: xr.Dataset | None, depth: float, offset: float
) -> tuple[float, float]:
    """Directional index at a place, and its difference to a companion's (NaN without)."""
    index = directional_index(fine, depth, offset)
    if coarse is None:
        return index, np.nan
    return index, abs(index - directional_index(coarse, depth, offset))


def _of(cases: Histories, height: float, mesh: str) -> xr.Dataset | None:
    return cases.get(str(Case(height, KEY[1], mesh)))


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
    around = pd.DataFrame(rows, columns=["panel", "series", OFFSET, RECEPTOR, INDEX])
    x = np.linspace(GRID[1][0], GRID[1][-1], 121)
    depths = [boundary_of(fine, at) for at in x]
    edge = pd.DataFrame({"panel": "boundary", OFFSET: x, RECEPTOR: depths})
    pairs = {
        "no ridges": (_of(cases, 0, "thesis"), _of(cases, 0, "coarse")),
        "inner ridges": (fine, _of(cases, KEY[0], "thesis")),
    }
    rows = [
        (
            *("profile", series, at, DEPTH),
            *index_and_error(history, companion, DEPTH, at),
            *(energy.mean() for energy in both_ways(history, DEPTH, at)),
        )
        for series, (history, companion) in pairs.items()
        for at in sorted({*GRID[1], -BESIDE, BESIDE})
    ]
    columns = ["panel", "series", OFFSET, RECEPTOR, INDEX, BAND, RIGHT, LEFT]
    profile = pd.DataFrame(rows, columns=columns)
    frame = pd.concat([around, edge, profile], ignore_index=True)
    frame[[OFFSET, RECEPTOR]] = (frame[[OFFSET, RECEPTOR]] * 1e6).round(3)
    frame.insert(0, "source", SIMULATED)
    return frame


def height_frame(cases: Histories) -> pd.DataFrame:
    """Index of three receptors against the height of the ridges, with the layer each lies in."""
    rows = []
    for name, history in cases.items():
        case = Case.named(name)
        if case.mesh != "thesis":
            continue
        coarse = _of(cases, case.height, "coarse")
        for series, (depth, offset) in places(history).items():
            layer = "epidermis" if depth < boundary_of(history, offset) else "dermis"
            index = index_and_error(history, coarse, depth, offset)
            rows.append((SIMULATED, series, layer, case.height, *index))
    frame = pd.DataFrame(rows, columns=["source", "series", "layer", HEIGHT, INDEX, BAND])
    return frame.sort_values(["series", HEIGHT], ignore_index=True)


def mesh_frame(cases: Histories) -> pd.DataFrame:
    """Energies both ways and the index at the thesis's place: on meshes that resolve the ridges,
    and drawn on its elements.
    """
    rows = []
    for mesh in (*MESHES, *DRAWN):
        history = _of(cases, KEY[0], mesh)
        if history is None:
            continue
        place = {"depth": DEPTH, "offset": -BESIDE, "tip": tip_of(history)}
        panel, edge = ("resolved", MESHES[mesh]) if mesh in MESHES else ("drawn", MESHES["thesis"])
        nodes = json.loads(history.attrs["cost"])["nodes"]
        ways = (energy.mean() for energy in both_ways(history, **place))
        index = directional_index(history, **place)
        rows.append((SIMULATED, panel, mesh, edge, nodes, *ways, index))
    columns = ["source", "panel", "series", EDGE, NODES, RIGHT, LEFT, INDEX]
    return pd.DataFrame(rows, columns=columns)


FRAMES = {"offset": offset_frame, "height": height_frame, "mesh": mesh_frame}
"""Figure -> its data, of the short strokes by the case's name."""


def ridge_data(job: SimpleNamespace) -> None:
    """Job: `cases` -> `data` (CSV, named as FRAMES)."""
    cases = read_results(job.cases)[0]
    for path in map(Path, job.data):
        write_frame(without_round_off(FRAMES[path.stem](cases)), path)
