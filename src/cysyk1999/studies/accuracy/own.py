"""Errors on meshes of one's own, by element and quantity; and how such meshes are made.

The table is measured on the inferred pad, its mesh split into the elements that users bring. The
unseen meshes are slabs and half-rings of two layers, in triangles and quads as gmsh makes them,
fine at the skin and coarser inside.
"""

from __future__ import annotations

import tempfile
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import gmsh
import pandas as pd
import xarray as xr

from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.studies.accuracy.belief import finest
from cysyk1999.studies.accuracy.compare import difference, looked_at
from cysyk1999.studies.common.documents import FLAT, cylinder, force
from cysyk1999.studies.common.meshes import pad_of
from fingerpad import load_scene
from fingerpad.healing import simulate
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.files import write_pad

QUANTITIES = {
    "depth": ("indentation_depth",),
    "width": ("contact_width",),
    "pressure": ("centre_pressure", "peak_pressure"),
    "strain energy": ("strain_energy_density",),
}
"""What the errors are of, and the variables of a history that they are read from."""
SURFACES = {"plate": FLAT, **{f"{k} 1/m": cylinder(k) for k in (20, 79, 210, 630)}}
GRAMS = (3.5, 10, 20)
EDGES = (60e-6, 100e-6, 170e-6, 300e-6, 450e-6)
"""m, along the skin of the mesh that is split: linear quads have half of it."""
DEPTHS = (0.56e-3, 0.7e-3, 0.915e-3)
SOLVED = {kind: KINDS[kind].solved for kind in ("quad4", "tri6", "quad9")}
"""Kind of element of a mesh -> the element that it is solved with."""
ERROR_OF = "error of the {} (%)"
SHARES = (0.0, 0.03, 0.06, 0.12, 0.25, 0.5, 1.1)
"""Edge over half width of the contact: ends of the classes that errors are gathered in."""


def measured(base: Scene, folder: Path) -> pd.DataFrame:
    """Errors of presses on meshes of every kind of element: a row a surface, force, edge and
    element.
    """
    rows = []
    for (surface, stimulus), grams in product(SURFACES.items(), GRAMS):
        scene = looked_at(base, DEPTHS).varied(
            {
                "stimulus": stimulus,
                "motion": [force(grams)],
                "effects": {"finite_strain": True},
                "accuracy": "fine",
            }
        )
        truth = simulate(scene, finest(scene))
        half_width = float(truth.contact_width[-1]) / 2
        for edge, kind in product(EDGES, SOLVED):
            run = _on_split(scene, edge, kind, folder)
            own = edge / 2 if kind == "quad4" else edge
            row = {"surface": surface, "force (gf)": grams, "element": SOLVED[kind]}
            row |= {"edge (um)": own * 1e6, "edge / half width": own / half_width}
            for name, variables in QUANTITIES.items():
                row[ERROR_OF.format(name)] = 100 * difference(run, truth, variables)[0]
            rows.append(row)
    return pd.DataFrame(rows)


def _on_split(scene: Scene, edge: float, kind: str, folder: Path) -> xr.Dataset:
    """History of a press on the pad's mesh split into elements of a kind, as a user's own mesh."""
    path = folder / f"{kind}.msh"
    edges = {"skin_edge": edge, "layer_edge": 0.9 * edge, "focus": (), "skin_radial_edge": None}
    write_pad(pad_of(scene, kind, **edges), path)
    accuracy = {"element": SOLVED[kind], "tolerance": 0.5, "once": True}
    own = {"specimen.outline": None, "specimen.mesh": path, "accuracy": accuracy}
    return simulate(scene.varied(own))


def table(rows: pd.DataFrame) -> pd.DataFrame:
    """The largest errors by element and quantity in classes of edge over half width."""
    over = "edge / half width"
    classes = pd.cut(rows[over], SHARES, right=False)
    columns = [ERROR_OF.format(name) for name in QUANTITIES]
    found = rows.groupby([rows["element"], classes], observed=True)[columns].max().reset_index()
    found[over] = [f"{ends.left:g} to {ends.right:g}" for ends in found[over]]
    return found


# --- made by gmsh ---


def finer_own(own: dict[str, Any]) -> dict[str, Any]:
    """How the mesh of the truth is made: quadratic triangles a quarter as large at the skin."""
    return own | {"kind": "tri", "order": 2, "edge": min(own["edge"] / 4, 0.06), "coarser": 3.0}


def write_own(own: dict[str, Any], path: Path) -> None:
    """Make a mesh with gmsh as a user would (lengths in mm), and write it."""
    gmsh.initialize(["fingerpad", "-v", "0"], readConfigFiles=False, interruptible=False)
    try:
        surfaces, skin, base = (_slab if own["shape"] == "slab" else _ring)(own)
        gmsh.model.geo.synchronize()
        for dimension, tags, name in (
            (1, skin, "skin"),
            (1, base, "base"),
            (2, surfaces[:1], "cover"),
            (2, surfaces[1:], "foam"),
        ):
            gmsh.model.addPhysicalGroup(dimension, tags, name=name)
        if own["kind"] == "quad":  # recombined simply, with what is left of triangles smoothed
            gmsh.option.setNumber("Mesh.RecombineAll", 1)
            gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 2)
            gmsh.option.setNumber("Mesh.Algorithm", 8)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(own["order"])
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def _edges(own: dict[str, Any]) -> tuple[float, float, float]:
    """Edges at the skin, between the layers, and at the base."""
    return own["edge"], own["edge"] * own["coarser"] ** 0.5, own["edge"] * own["coarser"]


def _slab(own):
    geo, (top, middle, bottom) = gmsh.model.geo, _edges(own)
    (cover, foam), half = own["thicknesses"], 8.0
    places = (
        (-half, 0, bottom),
        (half, 0, bottom),
        (half, foam, middle),
        (half, cover + foam, top),
        (0, cover + foam, top),
        (-half, cover + foam, top),
        (-half, foam, middle),
    )
    points = [geo.addPoint(x, y, 0, size) for x, y, size in places]
    lines = [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    between = geo.addLine(points[2], points[6])
    low = geo.addPlaneSurface([geo.addCurveLoop([*lines[:2], between, lines[6]])])
    up = geo.addPlaneSurface([geo.addCurveLoop([-between, *lines[2:6]])])
    return [up, low], lines[3:5], lines[:1]


def _ring(own):
    geo, (cover, foam), radius = gmsh.model.geo, own["thicknesses"], own["radius"]
    centre, ends, arcs, surfaces = geo.addPoint(0, 0, 0, 1.0), [], [], []
    for r, size in zip((radius, radius - cover, radius - cover - foam), _edges(own), strict=True):
        a, b, c = (geo.addPoint(x, y, 0, size) for x, y in ((-r, 0), (0, r), (r, 0)))
        ends.append((a, c))
        arcs.append([geo.addCircleArc(a, centre, b), geo.addCircleArc(b, centre, c)])
    for k in (0, 1):
        left, right = (geo.addLine(ends[k][side], ends[k + 1][side]) for side in (0, 1))
        back = [-arc for arc in reversed(arcs[k + 1])]
        surfaces.append(geo.addPlaneSurface([geo.addCurveLoop([*arcs[k], right, *back, -left])]))
    return surfaces, arcs[0], arcs[2]


def accuracy_own(job: SimpleNamespace) -> None:
    """Job: `scene`, one of the family -> `rows` and `table`."""
    with tempfile.TemporaryDirectory() as folder:
        rows = measured(load_scene(job.scene[0]), Path(folder))
    write_frame(rows, Path(job.rows[0]))
    publish_table(table(rows), job.table[0])
