"""The pad's mesh: symmetric to the bit, on the outline, as fine as asked, unchanged by a file
trip.
"""

import re
from dataclasses import replace

import gmsh
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from fingerpad.scenes.scene import Outline
from fingerpad.specimen import (
    MeshError,
    MeshSize,
    OutlineCurve,
    OutlineError,
    PadMesh,
    build_pad_mesh,
    count_nodes,
    files,
    mesh_for,
    quality_of,
    read_pad_mesh,
    skin_chain,
    write_pad,
)
from fingerpad.specimen.element_kinds import KINDS as KIND_TABLE
from fingerpad.specimen.pad import CURVES, REGIONS, element_edges
from fingerpad.specimen.quality import check_orientation, jacobians, scaled_jacobian
from synthetic import OUTLINE as THESIS

pytestmark = pytest.mark.unit

OUTLINE = Outline(**THESIS)
CURVE = OutlineCurve(OUTLINE)
SIZE = MeshSize(skin_edge=0.1344e-3, fine_half_width=3.4e-3, layer_edge=0.1214e-3)
DRAFT = MeshSize(skin_edge=0.27e-3, fine_half_width=3.4e-3, layer_edge=0.25e-3)


@pytest.fixture(scope="module")
def mesh() -> PadMesh:
    return build_pad_mesh(OUTLINE, SIZE)


@pytest.fixture(scope="module")
def draft() -> PadMesh:
    return build_pad_mesh(OUTLINE, DRAFT)


def places(points) -> set:
    return set(map(tuple, points.tolist()))


def areas(mesh: PadMesh) -> np.ndarray:
    """Area of each layer by the Gauss rule of its elements."""
    points, weights = KIND_TABLE[mesh.element].rule(5)
    area = np.linalg.det(jacobians(mesh, points)) @ weights
    return np.bincount(mesh.region, area, minlength=3)


def skin_edges(mesh: PadMesh) -> np.ndarray:
    """Arc lengths of the skin's element edges from the apex to the right."""
    x, y = mesh.points[skin_chain(mesh)[::2]].T
    right = x >= 0.0
    x, y = x[right], y[right]
    theta = np.where(y > 0.0, CURVE.theta_at_x(np.minimum(x, 8.5e-3)), 0.0)
    theta = np.where(y > 0.0, theta, CURVE.theta_at_x(np.minimum(x, 8.5e-3), lower=True))
    return np.diff(CURVE.arc_length(theta))


# -- the built mesh --------------------------------------------------------------------------------


def test_thesis_mesh_has_about_ten_thousand_good_elements(mesh):
    assert 8500 <= len(mesh.points) <= 11500
    assert mesh.element == "quad9" and mesh.symmetric and not mesh.half
    assert quality_of(mesh)["worst_scaled_jacobian"] > 0.3
    assert (
        mesh.points.dtype == np.float64
        and mesh.cells.dtype == np.int32
        and mesh.region.dtype == np.int8
    )
    check_orientation(mesh, "thesis")
    np.testing.assert_array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))


def test_mesh_is_symmetric_to_the_last_bit(mesh):
    x = mesh.points[:, 0]
    assert len(places(mesh.points)) == len(mesh.points)
    assert places(mesh.points[x > 0.0]) == places(mesh.points[x < 0.0] * (-1.0, 1.0))
    apex = mesh.points[np.argmax(mesh.points[:, 1])]
    np.testing.assert_array_equal(apex, [0.0, 6e-3])
    assert (x == 0.0).sum() == (np.abs(x) < 1e-9).sum()


def test_fine_zone_has_the_edge_asked_for_and_edges_grow_slowly(mesh):
    edges = skin_edges(mesh)
    fine = np.cumsum(edges) < SIZE.fine_half_width
    np.testing.assert_allclose(edges[fine], SIZE.skin_edge, rtol=1e-6)
    growing = np.cumsum(edges) < CURVE.arc_length(0.5 * np.pi)[0]
    assert (edges[1:] / edges[:-1])[growing[1:]].max() < SIZE.growth * 1.01
    chain = mesh.points[skin_chain(mesh)]
    spacing = np.hypot(*np.diff(chain[np.abs(chain[:, 0]) < 3e-3], axis=0).T)
    np.testing.assert_allclose(spacing, 0.5 * SIZE.skin_edge, rtol=1e-4)


def test_nodes_lie_on_the_outline_and_its_offset_curves(mesh):
    skin = mesh.points[np.unique(np.concatenate((mesh.curves["skin"], mesh.curves["nail"])))]
    x, upper = np.minimum(np.abs(skin[:, 0]), OUTLINE.half_width), skin[:, 1] > 0.0
    theta = np.where(upper, CURVE.theta_at_x(x), CURVE.theta_at_x(x, lower=True))
    steep = np.abs(skin[:, 0]) > 8.4e-3  # where x hardly fixes the angle
    drawn = CURVE.point(theta) * np.column_stack(
        (np.where(skin[:, 0] < 0.0, -1.0, 1.0), np.ones(len(x)))
    )
    np.testing.assert_allclose(skin[~steep], drawn[~steep], atol=1e-12)
    for upper_layer, depth in enumerate(CURVE.layer_depths):
        above = np.unique(mesh.cells[mesh.region == upper_layer])
        interface = np.intersect1d(above, np.unique(mesh.cells[mesh.region == upper_layer + 1]))
        assert len(interface) == len(skin)
        distance, nearest = cKDTree(skin).query(mesh.points[interface])
        np.testing.assert_allclose(distance, depth, atol=1e-12)
        assert len(np.unique(nearest)) == len(skin)
    bone = mesh.points[np.unique(mesh.curves["bone"])]
    level = (bone[:, 0] / OUTLINE.bone_half_width) ** 2
    level += ((bone[:, 1] - OUTLINE.bone_centre_height) / OUTLINE.bone_half_height) ** 2
    np.testing.assert_allclose(level, 1.0, rtol=1e-12)


def test_layer_areas_are_those_of_offset_curves(mesh):
    perimeter = 2.0 * CURVE.length

    def outside(depth):  # the area between a convex curve and its inward offset (Steiner)
        return depth * perimeter - np.pi * depth**2

    theta = np.linspace(0.0, np.pi, 100001)
    x, y = CURVE.point(theta).T
    section = 2.0 * np.trapezoid(x, -y)
    bone = np.pi * OUTLINE.bone_half_width * OUTLINE.bone_half_height
    middle, inner = map(outside, CURVE.layer_depths)
    np.testing.assert_allclose(
        areas(mesh), [middle, inner - middle, section - inner - bone], rtol=1e-4
    )


def test_curves_are_the_whole_boundary(mesh):
    edges = element_edges(mesh.cells, mesh.element)
    pairs, counts = np.unique(np.sort(edges[:, :2], axis=1), axis=0, return_counts=True)
    facets = np.concatenate([mesh.curves[name] for name in CURVES])
    assert places(np.sort(facets[:, :2], axis=1)) == places(pairs[counts == 1])
    assert counts.max() == 2
    backwards = facets[:, [1, 0, 2]]  # elements have the material on the left of their edges
    assert places(backwards) <= places(edges)


def test_nail_ends_where_the_outline_says(mesh, draft):
    for each in (mesh, draft):
        nail = each.points[np.unique(each.curves["nail"])]
        assert (nail[:, 1] < 0.0).all()
        assert nail[:, 0].max() == pytest.approx(OUTLINE.nail_half_width, rel=1e-12)
        outer = each.points[np.unique(each.curves["skin"])]
        assert (
            np.abs(outer[outer[:, 1] < 0.0, 0]) >= OUTLINE.nail_half_width * (1.0 - 1e-12)
        ).all()


def test_skin_chain_runs_from_left_to_right(mesh):
    chain = skin_chain(mesh)
    assert len(chain) == 2 * len(mesh.curves["skin"]) + 1 == len(np.unique(chain))
    points = mesh.points[chain]
    np.testing.assert_array_equal(points, points[::-1] * (-1.0, 1.0))
    upper = points[points[:, 1] > 0.0]
    assert (np.diff(upper[:, 0]) > 0.0).all()
    assert points[len(chain) // 2, 0] == 0.0 and points[0, 0] < 0.0


def test_right_half(mesh):
    half = mesh.right_half()
    assert half.half and half.right_half() is half
    assert len(half.cells) == len(mesh.cells) // 2
    assert half.points[:, 0].min() == 0.0
    assert places(half.points) == places(mesh.points[mesh.points[:, 0] >= 0.0])
    np.testing.assert_allclose(areas(half), 0.5 * areas(mesh), rtol=1e-12)
    axis = half.points[np.unique(half.curves["symmetry"])]
    assert (axis[:, 0] == 0.0).all() and len(axis) == (half.points[:, 0] == 0.0).sum()
    assert half.points[skin_chain(half)[0], 0] == 0.0
    for name in CURVES:
        assert 2 * len(half.curves[name]) == len(mesh.curves[name])
    everything = places(element_edges(half.cells, half.element))
    for facets in half.curves.values():
        assert places(facets[:, [1, 0, 2]]) <= everything


def test_focus_refines_there_and_nowhere_far(mesh):
    x = 1.5875e-3
    fine = build_pad_mesh(OUTLINE, replace(SIZE, focus=((x, 20e-6),)))
    edges = skin_edges(fine)
    ends = np.cumsum(edges)
    place = CURVE.arc_length(CURVE.theta_at_x(x))[0]
    there = edges[np.searchsorted(ends, place)]
    assert 10e-6 < there < 30e-6
    assert edges[0] == pytest.approx(SIZE.skin_edge, rel=0.1)
    ratio = edges[1:] / edges[:-1]
    zone = ends[1:] < 6e-3
    assert ratio[zone].max() < SIZE.growth * 1.05 and ratio[zone].min() > 1.0 / SIZE.growth / 1.05
    assert len(fine.points) < 2 * len(mesh.points)
    assert count_nodes(OUTLINE, replace(SIZE, focus=((-x, 20e-6),))) == len(fine.points)


def test_first_rows_can_be_finer():
    fine = build_pad_mesh(OUTLINE, replace(DRAFT, skin_radial_edge=50e-6))
    column = fine.points[fine.points[:, 0] == 0.0, 1]
    edges = np.diff(6e-3 - np.sort(column[column > 0.0])[::-2])
    assert 35e-6 < edges[0] < 65e-6
    assert (edges[1:] / edges[:-1]).max() < DRAFT.growth * 1.1


@pytest.mark.parametrize("edge", [540e-6, 270e-6, 134.4e-6, 67.2e-6, 35e-6])
def test_any_size_from_draft_to_a_hundred_thousand_nodes(edge):
    size = MeshSize(skin_edge=edge, fine_half_width=3.4e-3, layer_edge=edge * 0.9)
    built = build_pad_mesh(OUTLINE, size)
    assert len(built.points) == count_nodes(OUTLINE, size)
    assert quality_of(built)["worst_scaled_jacobian"] > 0.3


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    outline=st.fixed_dictionaries(
        {
            "apex_height": st.floats(5e-3, 8e-3),
            "apex_radius": st.floats(5e-3, 12e-3),
            "half_width": st.floats(7e-3, 10e-3),
            "depth_below": st.floats(5e-3, 8e-3),
            "epidermis_thickness": st.floats(0.3e-3, 0.9e-3),
            "dermis_thickness": st.floats(0.3e-3, 0.9e-3),
            "bone_centre_height": st.floats(-1.5e-3, 0.5e-3),
            "bone_half_width": st.floats(1.5e-3, 4e-3),
            "bone_half_height": st.floats(1.5e-3, 2.5e-3),
            "nail_half_width": st.floats(1e-3, 6e-3),
        }
    ),
    edge=st.floats(0.1e-3, 0.5e-3),
    fine=st.floats(0.0, 8e-3),
    growth=st.floats(1.1, 1.4),
)
def test_every_drawable_outline_can_be_meshed(outline, edge, fine, growth):
    try:
        drawn = Outline(**{**THESIS, **outline})
        OutlineCurve(drawn)
    except (OutlineError, ValueError):
        assume(False)
    size = MeshSize(skin_edge=edge, fine_half_width=fine, layer_edge=edge, growth=growth)
    built = build_pad_mesh(drawn, size)
    assert len(built.points) == count_nodes(drawn, size)
    assert quality_of(built)["worst_scaled_jacobian"] > 0.1
    x = built.points[:, 0]
    assert places(built.points[x > 0.0]) == places(built.points[x < 0.0] * (-1.0, 1.0))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"skin_edge": 0.0}, "skin_edge"),
        ({"layer_edge": -1e-4}, "layer_edge"),
        ({"fine_half_width": -1.0}, "fine_half_width"),
        ({"growth": 1.0}, "growth"),
        ({"skin_radial_edge": float("nan")}, "skin_radial_edge"),
        ({"focus": ((1e-3, 0.0),)}, "x = 1 mm"),
    ],
)
def test_impossible_sizes_are_refused(changed, words):
    with pytest.raises(MeshError, match=re.escape(words)):
        replace(SIZE, **changed)


def test_fat_too_thin_for_its_edges_is_refused():
    shape = {"bone_half_height": 2.99999e-3, "bone_half_width": 1.5e-3, "apex_radius": 3e-3}
    thin = Outline(**{**THESIS, **shape})
    with pytest.raises(MeshError, match=r"^outline: element \d+ .* thicker fat"):
        build_pad_mesh(thin, MeshSize(skin_edge=0.5e-3, fine_half_width=1e-3, layer_edge=0.5e-3))


# -- quality ---------------------------------------------------------------------------------------


def single(element: str, points) -> PadMesh:
    points = np.array(points, dtype=float)
    cells = np.arange(len(points), dtype=np.int32)[None]
    return PadMesh(points, cells, element, np.zeros(1, dtype=np.int8), {}, False)


def test_scaled_jacobian_of_known_elements():
    rectangle = [(0, 0), (3, 0), (3, 1), (0, 1)]
    assert scaled_jacobian(single("quad4", rectangle))[0] == pytest.approx(1.0)
    angle = np.radians(30.0)
    slanted = [(0, 0), (1, 0), (1 + np.cos(angle), np.sin(angle)), (np.cos(angle), np.sin(angle))]
    assert scaled_jacobian(single("quad4", slanted))[0] == pytest.approx(0.5)
    even = [(0, 0), (1, 0), (0.5, np.sqrt(0.75))]
    assert scaled_jacobian(single("tri3", even))[0] == pytest.approx(1.0)
    right = [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)]
    assert scaled_jacobian(single("tri6", right))[0] == pytest.approx(np.sqrt(2.0 / 3.0))


# -- files -----------------------------------------------------------------------------------------


def test_round_trip_is_exact(mesh, tmp_path):
    path = tmp_path / "pad.msh"
    write_pad(mesh, path)
    assert [each.name for each in tmp_path.iterdir()] == ["pad.msh"]
    assert path.read_text().startswith("$MeshFormat\n4.1 0 8")
    again = read_pad_mesh(path)
    np.testing.assert_allclose(again.points, mesh.points, rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(again.cells, mesh.cells)
    np.testing.assert_array_equal(again.region, mesh.region)
    np.testing.assert_array_equal(skin_chain(again), skin_chain(mesh))
    for name in CURVES:
        assert places(again.curves[name]) == places(mesh.curves[name])
    assert again.symmetric and again.element == "quad9"
    assert len(again.right_half().points) == len(mesh.right_half().points)


def test_failed_writing_leaves_the_old_file(draft, tmp_path):
    path = tmp_path / "pad.msh"
    path.write_text("old")
    broken = replace(draft, cells=draft.cells[:, :7])
    with pytest.raises(Exception):  # noqa: B017 - whatever gmsh says
        write_pad(broken, path)
    assert path.read_text() == "old"
    assert [each.name for each in tmp_path.iterdir()] == ["pad.msh"]


def test_a_full_disk_is_said(draft, tmp_path, monkeypatch):
    """gmsh does not say that its file was cut; nothing is left of it then, and what was there
    before stays.
    """
    path = tmp_path / "pad.msh"
    path.write_text("old")

    def cut(task, name, *arguments):
        files_ask(task, name, *arguments)
        with open(name, "r+b") as file:
            file.truncate(65536)

    files_ask = files.ask
    monkeypatch.setattr(files, "ask", cut)
    with pytest.raises(OSError, match="No space left on device"):
        write_pad(draft, path)
    assert path.read_text() == "old" and [each.name for each in tmp_path.iterdir()] == ["pad.msh"]


KINDS = ["tri3", "tri6", "quad4", "quad8", "quad9"]


def write_rings(path, kind="quad9", structured=True, order=None, version=4.1, edit=None):
    """A round pad of three rings, radii 8, 7, 6 and 3 mm, made with gmsh as a user would."""
    gmsh.initialize(["", "-v", "0"], interruptible=False)
    try:
        geo = gmsh.model.geo
        centre = geo.addPoint(0, 0, 0, 1.0)
        rings = []
        for radius in (8.0, 7.0, 6.0, 3.0):
            points = [
                geo.addPoint(radius * x, radius * y, 0, 1.0)
                for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))
            ]
            rings.append(
                [geo.addCircleArc(points[i], centre, points[(i + 1) % 4]) for i in range(4)]
            )
            rings[-1].append(points)
        surfaces = []
        for outer, inner in zip(rings, rings[1:], strict=False):
            spokes = [geo.addLine(outer[4][i], inner[4][i]) for i in range(4)]
            for line in spokes:
                geo.mesh.setTransfiniteCurve(line, 3)
            for i in range(4):
                loop = geo.addCurveLoop([outer[i], spokes[(i + 1) % 4], -inner[i], -spokes[i]])
                surfaces.append(geo.addPlaneSurface([loop]))
                if structured:
                    for arc in (outer[i], inner[i]):
                        geo.mesh.setTransfiniteCurve(arc, 7)
                    geo.mesh.setTransfiniteSurface(surfaces[-1], "AlternateLeft")
                if kind.startswith("quad"):
                    geo.mesh.setRecombine(2, surfaces[-1])
        geo.synchronize()
        groups = [(2, surfaces[4 * i : 4 * i + 4], name) for i, name in enumerate(REGIONS)]
        groups += [
            (1, rings[0][0:2], "skin"),
            (1, rings[0][2:4], "nail"),
            (1, rings[3][0:4], "bone"),
        ]
        for dimension, tags, name in edit(groups) if edit else groups:
            gmsh.model.setPhysicalName(
                dimension, gmsh.model.addPhysicalGroup(dimension, tags), name
            )
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", kind == "quad8")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order or (2 if kind in ("tri6", "quad8", "quad9") else 1))
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("kind", KINDS)
def test_external_meshes_of_every_kind(kind, version, tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", kind, version=version))
    assert mesh.element == kind.replace("quad8", "quad9")
    assert np.abs(mesh.points).max() == pytest.approx(8e-3)
    np.testing.assert_array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    assert np.bincount(mesh.region).tolist() == [48 * (2 if kind.startswith("tri") else 1)] * 3
    assert {name: len(facets) for name, facets in mesh.curves.items()} == {
        "skin": 12,
        "bone": 24,
        "nail": 12,
    }
    for facets in mesh.curves.values():
        assert facets.shape[1] == (2 if kind in ("tri3", "quad4") else 3)
    chain = mesh.points[skin_chain(mesh)]
    assert (np.diff(chain[:, 0]) > 0.0).all() and chain[0, 0] == pytest.approx(-8e-3)
    if mesh.element in ("tri6", "quad9"):
        assert areas(mesh).sum() == pytest.approx(np.pi * (64e-6 - 9e-6), rel=1e-3)


def test_centre_of_an_eight_node_quad_is_that_of_its_own_map(tmp_path):
    path = write_rings(tmp_path / "rings.msh", "quad8")
    mesh = read_pad_mesh(path)
    nodes = mesh.points[mesh.cells]
    shape = np.array([-0.25] * 4 + [0.5] * 4)  # the serendipity functions at the centre
    np.testing.assert_allclose(nodes[:, 8], np.einsum("n,enx->ex", shape, nodes[:, :8]), atol=1e-15)
    assert (
        np.abs(nodes[:, 8] - nodes[:, :4].mean(axis=1)).max() > 1e-5
    )  # curved elements, or nothing is shown


@pytest.mark.parametrize("kind", KINDS)
def test_external_symmetric_mesh_has_a_right_half(kind, tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", kind))
    assert mesh.symmetric
    half = mesh.right_half()
    assert 2 * len(half.cells) == len(mesh.cells)
    assert half.points[:, 0].min() == 0.0
    assert len(half.curves["symmetry"]) == 12


def test_external_unsymmetric_mesh_has_none(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri6"))
    bent = replace(mesh, points=mesh.points + np.where(mesh.points[:, :1] > 7e-3, 1e-5, 0.0))
    write_pad(bent, tmp_path / "bent.msh")
    again = read_pad_mesh(tmp_path / "bent.msh")
    assert not again.symmetric
    with pytest.raises(MeshError, match="mirror image"):
        again.right_half()


def test_elements_astride_the_axis_are_not_symmetric(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "quad4"))
    angle = np.pi / 24.0  # half an element
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = replace(mesh, points=mesh.points @ turn.T)
    write_pad(turned, tmp_path / "turned.msh")
    assert not read_pad_mesh(tmp_path / "turned.msh").symmetric


def test_unstructured_triangles(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri6", structured=False))
    assert quality_of(mesh)["worst_scaled_jacobian"] > 0.3


def test_linear_triangles_can_be_elevated(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri3"))
    raised = mesh.elevated()
    assert raised.element == "tri6" and raised.elevated() is raised
    assert len(raised.points) == len(places(raised.points))
    middle = raised.points[raised.cells[:, 3:]]
    corners = raised.points[raised.cells[:, :3]]
    bent = np.isin(
        raised.cells[:, 3:], raised.curves["skin"][:, 2]
    )  # the skin's sides bend as it does
    np.testing.assert_allclose(
        middle[~bent], (0.5 * (corners + corners[:, [1, 2, 0]]))[~bent], atol=1e-18
    )
    ends = raised.points[raised.curves["skin"][:, :2]]
    np.testing.assert_allclose(
        np.hypot(*middle[bent].T), np.hypot(*ends[0, 0]), rtol=1e-3
    )  # their chords: 8.6e-3
    for name, facets in raised.curves.items():
        np.testing.assert_array_equal(facets[:, :2], mesh.curves[name])
        if name != "skin":
            np.testing.assert_allclose(
                raised.points[facets[:, 2]], raised.points[facets[:, :2]].mean(axis=1), atol=1e-18
            )
    assert len(skin_chain(raised)) == 25
    raised.right_half()


def test_written_external_mesh_reads_the_same(tmp_path):
    for kind in KINDS:
        mesh = read_pad_mesh(write_rings(tmp_path / f"{kind}.msh", kind))
        write_pad(mesh, tmp_path / "again.msh")
        again = read_pad_mesh(tmp_path / "again.msh")
        np.testing.assert_allclose(again.points, mesh.points, atol=1e-12)
        np.testing.assert_array_equal(again.cells, mesh.cells)


def test_unused_nodes_are_dropped(draft, tmp_path):
    extra = replace(draft, points=np.concatenate((draft.points, [[0.5, 0.5]])))
    write_pad(extra, tmp_path / "extra.msh")
    assert len(read_pad_mesh(tmp_path / "extra.msh").points) == len(draft.points)


# -- files that are refused ------------------------------------------------------------------------


def refused(path, *words):
    with pytest.raises(MeshError) as caught:
        read_pad_mesh(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and "\n" not in message
    for word in words:
        assert word in message, message


def test_missing_file(tmp_path):
    refused(tmp_path / "none.msh", "no such mesh file")
    refused(tmp_path, "no such mesh file")


def test_file_that_is_no_mesh(tmp_path):
    for content in (b"", b"SystemCall 'echo';", b"\x00\xff" * 100):
        (tmp_path / "no.msh").write_bytes(content)
        refused(tmp_path / "no.msh", "not a gmsh mesh", "allowed")
    (tmp_path / "cut.msh").write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n6 99")
    refused(tmp_path / "cut.msh")


def test_skin_must_be_there(tmp_path):
    def edit(groups):
        return [(d, tags, "other" if label == "skin" else label) for d, tags, label in groups]

    refused(
        write_rings(tmp_path / "pad.msh", edit=edit),
        "curve skin is missing",
        "among other, nail, bone",
    )


def test_something_must_be_held(tmp_path):
    def edit(groups):
        return [
            (d, tags, {"bone": "hole", "nail": "rest"}.get(label, label))
            for d, tags, label in groups
        ]

    path = write_rings(tmp_path / "pad.msh", edit=edit)
    refused(path, "no curve is held", "bone, nail, base", "specimen.fixed", "among rest, hole")
    mesh = read_pad_mesh(path, fixed=("hole",))
    assert mesh.fixed == ("hole",) and {
        name: len(facets) for name, facets in mesh.curves.items()
    } == {
        "skin": 12,
        "hole": 24,
        "unnamed": 12,
    }
    with pytest.raises(
        MeshError,
        match="fixed: core is no curve of the mesh; its physical curves are skin, rest, hole",
    ):
        read_pad_mesh(path, fixed=("core",))


@pytest.mark.parametrize("name", ["bone", "nail"])
def test_one_of_bone_and_nail_is_enough(name, tmp_path):
    path = write_rings(
        tmp_path / "pad.msh", edit=lambda groups: [group for group in groups if group[2] != name]
    )
    mesh = read_pad_mesh(path)
    assert mesh.fixed == tuple({"bone", "nail"} - {name}) and len(mesh.curves["unnamed"]) in (
        12,
        24,
    )
    assert read_pad_mesh(write_rings(tmp_path / "both.msh"), free=("nail",)).fixed == ("bone",)


def test_surfaces_have_names_of_their_own(tmp_path):
    def edit(groups):
        return [
            (d, tags, {"epidermis": "cover", "dermis": "foam", "fat": "core"}.get(label, label))
            for d, tags, label in groups
        ]

    path = write_rings(tmp_path / "pad.msh", edit=edit)
    assert read_pad_mesh(path).regions == ("cover", "foam", "core")
    assert read_pad_mesh(path, layers=("core", "foam", "cover")).regions == (
        "core",
        "foam",
        "cover",
    )
    with pytest.raises(
        MeshError,
        match="layer gel is no surface of the mesh; its physical surfaces are cover, foam, core",
    ):
        read_pad_mesh(path, layers=("cover", "gel"))
    with pytest.raises(
        MeshError,
        match=r"48 surface elements are in none of cover, foam; "
        r"each must be in one .*also has core",
    ):
        read_pad_mesh(path, layers=("cover", "foam"))


def test_no_groups_at_all(tmp_path):
    refused(write_rings(tmp_path / "pad.msh", edit=lambda groups: []), "no surface is named")


@pytest.mark.parametrize(
    ("factor", "words"),
    [(1e-3, "0.016 mm wide: coordinates must be mm; metres?"), (1e3, "micrometres?")],
)
def test_units_are_guessed(factor, words, tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "mm.msh", "tri3"))
    write_pad(replace(mesh, points=mesh.points * factor), tmp_path / "pad.msh")
    refused(tmp_path / "pad.msh", words)


def test_cubic_elements(tmp_path):
    refused(write_rings(tmp_path / "pad.msh", "tri6", order=3), "surface epidermis", "3 or 6 nodes")


def test_mixed_elements(tmp_path):
    triangles = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri3"))
    path = tmp_path / "mixed.msh"
    write_pad(triangles, path)
    text = path.read_text()
    block = re.search(r"^2 3 2 96\n((?:\d+ \d+ \d+ \d+ *\n){96})", text, re.MULTILINE)
    lines = [" ".join([*line.split(), line.split()[-1]]) for line in block[1].splitlines()]
    path.write_text(text.replace(block[0], "2 3 3 96\n" + "\n".join(lines) + "\n"))
    refused(path, "mixes quad4 and tri3", "one kind")


def test_element_in_two_layers(tmp_path):
    refused(
        write_rings(
            tmp_path / "pad.msh",
            edit=lambda groups: [*groups[1:], (2, [1, 5], "epidermis"), (2, [1], "fat")],
        ),
        "in two of",
    )


def test_element_in_no_layer(tmp_path):
    def edit(groups):
        return [(2, groups[0][1][:3], "epidermis"), (2, groups[0][1][3:], "rest"), *groups[1:]]

    refused(write_rings(tmp_path / "pad.msh", edit=edit), "12 surface elements are in none of")


def moved(mesh, node, place):
    points = mesh.points.copy()
    points[node] = place
    return replace(mesh, points=points)


def turned(mesh, element):
    cells = mesh.cells.copy()
    cells[element] = cells[element][[1, 0, 3, 2, 4, 7, 6, 5, 8]]
    return replace(mesh, cells=cells)


def apart(mesh):
    cells = mesh.cells + (mesh.region == 1)[:, None].astype(np.int32) * len(mesh.points)
    return replace(mesh, points=np.tile(mesh.points, (2, 1)), cells=cells)


def with_curves(mesh, **more):
    """The mesh with edges added to some of its curves."""
    return replace(
        mesh,
        curves=mesh.curves
        | {name: np.concatenate((mesh.curves[name], edges)) for name, edges in more.items()},
    )


def in_pieces(mesh):
    middle = len(mesh.curves["skin"]) // 2
    changed = with_curves(mesh, nail=mesh.curves["skin"][middle : middle + 1])
    return replace(
        changed, curves=changed.curves | {"skin": np.delete(mesh.curves["skin"], middle, axis=0)}
    )


WRONG = {
    "folded element": (
        lambda m: moved(m, m.cells[11, 8], m.points[m.cells[11, 0]] * 1.05),
        "element 11",
        "is folded",
    ),
    "not a number": (lambda m: moved(m, 3, np.nan),),
    "layers not joined": (apart, "are the layers joined?"),
    "curve inside the pad": (
        lambda m: with_curves(m, bone=element_edges(m.cells[:1], "quad9")[:, :3]),
        "curve bone",
        "not on the boundary",
    ),
    "edge in two curves": (
        lambda m: with_curves(m, nail=m.curves["skin"][:1]),
        "curve nail",
        "two curves",
    ),
    "skin in pieces": (in_pieces, "curve skin must be one line"),
}


@pytest.mark.parametrize("which", [[7], slice(None)])
def test_elements_that_run_clockwise_are_turned(draft, which, tmp_path):
    cells = draft.cells.copy()
    cells[which] = cells[which][:, [1, 0, 3, 2, 4, 7, 6, 5, 8]]
    write_pad(replace(draft, cells=cells), tmp_path / "pad.msh")
    again = read_pad_mesh(tmp_path / "pad.msh")
    check_orientation(again, "turned")
    np.testing.assert_array_equal(np.sort(again.cells), np.sort(draft.cells))


@pytest.mark.parametrize("name", WRONG)
def test_wrong_meshes_are_named(draft, name, tmp_path):
    change, *words = WRONG[name]
    write_pad(change(draft), tmp_path / "pad.msh")
    refused(tmp_path / "pad.msh", *(word.format(all=len(draft.cells)) for word in words))


def test_mesh_out_of_plane(draft, tmp_path):
    path = tmp_path / "pad.msh"
    write_pad(draft, path)
    text = path.read_text()
    place = re.search(r"^(\S+ \S+) 0$", text[text.index("$Nodes") :], re.MULTILINE)
    path.write_text(text.replace(place[0], f"{place[1]} 0.5"))
    refused(path, "one plane")


def test_boundary_without_a_name_is_free(draft, tmp_path):
    curves = {**draft.curves, "nail": draft.curves["nail"][1:]}
    write_pad(replace(draft, curves=curves), tmp_path / "pad.msh")
    mesh = read_pad_mesh(tmp_path / "pad.msh")
    assert mesh.fixed == ("bone", "nail")
    np.testing.assert_allclose(
        mesh.points[mesh.curves["unnamed"]], draft.points[draft.curves["nail"][:1]], atol=1e-12
    )


# -- the mesh of a scene ---------------------------------------------------------------------------


def test_mesh_for_a_scene(draft, tmp_path):
    class Named:
        def __init__(self, **attributes):
            self.__dict__.update(attributes)

    plan = Named(mesh_size=DRAFT, parts=lambda scene: Named(ridges=None))
    layers = Named(stratum_corneum=None)
    built = mesh_for(
        Named(specimen=Named(outline=OUTLINE, mesh=None, stack=None, layers=layers)), plan
    )
    np.testing.assert_array_equal(built.points, draft.points)
    path = write_rings(tmp_path / "rings.msh", "quad4")
    materials = {name: None for name in REGIONS}
    read = mesh_for(
        Named(
            specimen=Named(
                outline=None, mesh=path, materials=materials, stated=(), fixed=(), free=()
            )
        ),
        plan,
    )
    assert read.element == "quad4"
