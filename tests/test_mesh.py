"""The pad's mesh: on the outline, as fine as asked, unchanged by a file trip; what is no mesh is
refused. Layers, areas, symmetry and boundary are checked with and without ridges in test_ridges.
"""

import re
from dataclasses import replace

import gmsh
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

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
    quality_of,
    read_pad_mesh,
    skin_chain,
    write_pad,
)
from fingerpad.specimen.element_kinds import KINDS as KIND_TABLE
from fingerpad.specimen.pad import REGIONS, element_edges
from fingerpad.specimen.quality import check_orientation, scaled_jacobian
from own_meshes import areas, places, read_back, turned
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


def skin_edges(mesh: PadMesh) -> np.ndarray:
    """Arc lengths of the skin's element edges from the apex to the right."""
    x, y = mesh.points[skin_chain(mesh)[::2]].T
    x, y = np.minimum(x[x >= 0.0], 8.5e-3), y[x >= 0.0]
    theta = np.where(y > 0.0, CURVE.theta_at_x(x), CURVE.theta_at_x(x, lower=True))
    return np.diff(CURVE.arc_length(theta))


# -- the built mesh --------------------------------------------------------------------------------


def test_thesis_mesh_has_about_ten_thousand_good_elements(mesh):
    assert 8500 <= len(mesh.points) <= 11500
    assert mesh.element == "quad9" and not mesh.half
    types = [part.dtype for part in (mesh.points, mesh.cells, mesh.region)]
    assert types == [np.float64, np.int32, np.int8]
    check_orientation(mesh, "thesis")
    apex = mesh.points[np.argmax(mesh.points[:, 1])]
    np.testing.assert_array_equal(apex, [0.0, 6e-3])


def test_fine_zone_has_the_edge_asked_for_and_edges_grow_slowly(mesh):
    edges = skin_edges(mesh)
    fine = np.cumsum(edges) < SIZE.fine_half_width
    np.testing.assert_allclose(edges[fine], SIZE.skin_edge, rtol=1e-6)
    growing = np.cumsum(edges) < CURVE.arc_length(0.5 * np.pi)[0]
    assert (edges[1:] / edges[:-1])[growing[1:]].max() < SIZE.growth * 1.01
    chain = mesh.points[skin_chain(mesh)]
    spacing = np.hypot(*np.diff(chain[np.abs(chain[:, 0]) < 3e-3], axis=0).T)
    np.testing.assert_allclose(spacing, 0.5 * SIZE.skin_edge, rtol=1e-4)


def test_the_rim_of_the_bone_is_its_ellipse_and_the_nail_ends_where_the_outline_says(mesh, draft):
    for each in (mesh, draft):
        x, y = each.points[np.unique(each.curves["bone"])].T
        level = (x / OUTLINE.bone_half_width) ** 2
        level += ((y - OUTLINE.bone_centre_height) / OUTLINE.bone_half_height) ** 2
        np.testing.assert_allclose(level, 1.0, rtol=1e-12)
        nail = each.points[np.unique(each.curves["nail"])]
        assert (nail[:, 1] < 0.0).all()
        assert nail[:, 0].max() == pytest.approx(OUTLINE.nail_half_width, rel=1e-12)
        x, y = each.points[np.unique(each.curves["skin"])].T
        assert (np.abs(x[y < 0.0]) >= OUTLINE.nail_half_width * (1.0 - 1e-12)).all()


def test_right_half(mesh):
    half = mesh.right_half()
    assert half.half and half.right_half() is half
    assert half.points[:, 0].min() == 0.0
    assert places(half.points) == places(mesh.points[mesh.points[:, 0] >= 0.0])
    np.testing.assert_allclose(areas(half), 0.5 * areas(mesh), rtol=1e-12)
    axis = half.points[np.unique(half.curves["symmetry"])]
    assert (axis[:, 0] == 0.0).all() and len(axis) == (half.points[:, 0] == 0.0).sum()
    assert half.points[skin_chain(half)[0], 0] == 0.0
    for name, facets in mesh.curves.items():
        assert 2 * len(half.curves[name]) == len(facets)
    everything = places(element_edges(half.cells, half.element))
    for facets in half.curves.values():
        assert places(facets[:, [1, 0, 2]]) <= everything


def test_focus_refines_there_and_nowhere_far(mesh):
    x = 1.5875e-3
    fine = build_pad_mesh(OUTLINE, replace(SIZE, focus=((x, 20e-6),)))
    edges = skin_edges(fine)
    ends = np.cumsum(edges)
    place = CURVE.arc_length(CURVE.theta_at_x(x))[0]
    assert 10e-6 < edges[np.searchsorted(ends, place)] < 30e-6
    assert edges[0] == pytest.approx(SIZE.skin_edge, rel=0.1)
    ratio = (edges[1:] / edges[:-1])[ends[1:] < 6e-3]
    assert ratio.max() < SIZE.growth * 1.05 and ratio.min() > 1.0 / SIZE.growth / 1.05
    assert len(fine.points) < 2 * len(mesh.points)
    assert count_nodes(OUTLINE, replace(SIZE, focus=((-x, 20e-6),))) == len(fine.points)


def test_first_rows_can_be_finer():
    fine = build_pad_mesh(OUTLINE, replace(DRAFT, skin_radial_edge=50e-6))
    column = fine.points[fine.points[:, 0] == 0.0, 1]
    edges = np.diff(6e-3 - np.sort(column[column > 0.0])[::-2])
    assert 35e-6 < edges[0] < 65e-6
    assert (edges[1:] / edges[:-1]).max() < DRAFT.growth * 1.1


@pytest.mark.parametrize("edge", [540e-6, 270e-6, 67.2e-6, 35e-6])
def test_any_size_from_draft_to_a_hundred_thousand_nodes(edge):
    size = MeshSize(skin_edge=edge, fine_half_width=3.4e-3, layer_edge=edge * 0.9)
    built = build_pad_mesh(OUTLINE, size)
    assert len(built.points) == count_nodes(OUTLINE, size)
    assert quality_of(built)["worst_scaled_jacobian"] > 0.3


RANGES = {  # mm
    "apex_height": (5, 8),
    "apex_radius": (5, 12),
    "half_width": (7, 10),
    "depth_below": (5, 8),
    "epidermis_thickness": (0.3, 0.9),
    "dermis_thickness": (0.3, 0.9),
    "bone_centre_height": (-1.5, 0.5),
    "bone_half_width": (1.5, 4),
    "bone_half_height": (1.5, 2.5),
    "nail_half_width": (1, 6),
}


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    outline=st.fixed_dictionaries(
        {name: st.floats(low * 1e-3, high * 1e-3) for name, (low, high) in RANGES.items()}
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
    ("key", "value", "words"),
    [
        ("skin_edge", 0.0, "skin_edge"),
        ("layer_edge", -1e-4, "layer_edge"),
        ("fine_half_width", -1.0, "fine_half_width"),
        ("growth", 1.0, "growth"),
        ("skin_radial_edge", float("nan"), "skin_radial_edge"),
        ("focus", ((1e-3, 0.0),), "x = 1 mm"),
    ],
)
def test_impossible_sizes_are_refused(key, value, words):
    with pytest.raises(MeshError, match=words):
        replace(SIZE, **{key: value})


def test_fat_too_thin_for_its_edges_is_refused():
    shape = {"bone_half_height": 2.99999e-3, "bone_half_width": 1.5e-3, "apex_radius": 3e-3}
    thin = Outline(**{**THESIS, **shape})
    with pytest.raises(MeshError, match=r"^outline: element \d+ .* thicker fat"):
        build_pad_mesh(thin, MeshSize(skin_edge=0.5e-3, fine_half_width=1e-3, layer_edge=0.5e-3))


SLOPE = np.cos(np.radians(30.0)), 0.5


@pytest.mark.parametrize(
    ("element", "points", "quality"),
    [
        ("quad4", [(0, 0), (3, 0), (3, 1), (0, 1)], 1.0),
        ("quad4", [(0, 0), (1, 0), (1 + SLOPE[0], SLOPE[1]), SLOPE], 0.5),
        ("tri3", [(0, 0), (1, 0), (0.5, np.sqrt(0.75))], 1.0),
        ("tri6", [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)], np.sqrt(2.0 / 3.0)),
    ],
)
def test_scaled_jacobian_of_known_elements(element, points, quality):
    cells = np.arange(len(points), dtype=np.int32)[None]
    single = PadMesh(np.array(points, float), cells, element, np.zeros(1, np.int8), {}, False)
    assert scaled_jacobian(single)[0] == pytest.approx(quality)


# -- files -----------------------------------------------------------------------------------------


def test_failed_writing_leaves_the_old_file(draft, tmp_path, monkeypatch):
    """Gmsh's errors, and a full disk: gmsh does not say that its file was cut."""
    path = tmp_path / "pad.msh"
    path.write_text("old")
    with pytest.raises(Exception):  # noqa: B017 - whatever gmsh says
        write_pad(replace(draft, cells=draft.cells[:, :7]), path)
    ask = files.ask

    def cut(task, name, *arguments):
        ask(task, name, *arguments)
        with open(name, "r+b") as file:
            file.truncate(65536)

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
        centre, rings, corners, surfaces = geo.addPoint(0, 0, 0, 1.0), [], [], []
        for radius in (8.0, 7.0, 6.0, 3.0):
            around = ((radius, 0), (0, radius), (-radius, 0), (0, -radius))
            points = [geo.addPoint(x, y, 0, 1.0) for x, y in around]
            corners.append(points)
            rings.append([geo.addCircleArc(points[i - 4], centre, points[i - 3]) for i in range(4)])
        for ring in range(3):
            outer, inner = rings[ring : ring + 2]
            spokes = [geo.addLine(*ends) for ends in zip(*corners[ring : ring + 2], strict=True)]
            for line in spokes:
                geo.mesh.setTransfiniteCurve(line, 3)
            for i in range(4):
                loop = geo.addCurveLoop([outer[i], spokes[i - 3], -inner[i], -spokes[i]])
                surfaces.append(geo.addPlaneSurface([loop]))
                if structured:
                    for arc in (outer[i], inner[i]):
                        geo.mesh.setTransfiniteCurve(arc, 7)
                    geo.mesh.setTransfiniteSurface(surfaces[-1], "AlternateLeft")
                if kind.startswith("quad"):
                    geo.mesh.setRecombine(2, surfaces[-1])
        geo.synchronize()
        groups = [(2, surfaces[4 * i : 4 * i + 4], name) for i, name in enumerate(REGIONS)]
        groups += [(1, rings[0][:2], "skin"), (1, rings[0][2:], "nail"), (1, rings[3], "bone")]
        for dimension, tags, name in edit(groups) if edit else groups:
            gmsh.model.addPhysicalGroup(dimension, tags, name=name)
        gmsh.option.setNumber("Mesh.SecondOrderIncomplete", kind == "quad8")
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order or (1 if kind in ("tri3", "quad4") else 2))
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


def renamed(**names):
    """Groups of `write_rings` under other names; None for one that is left out."""
    return lambda groups: [
        (*group, names.get(name, name)) for *group, name in groups if names.get(name, name)
    ]


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("kind", KINDS)
def test_external_meshes_of_every_kind(kind, version, tmp_path):
    """They are read, halved, written and read again."""
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", kind, version=version))
    quadratic = kind not in ("tri3", "quad4")
    assert mesh.element == kind.replace("quad8", "quad9")
    assert np.abs(mesh.points).max() == pytest.approx(8e-3)
    np.testing.assert_array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    assert np.bincount(mesh.region).tolist() == [48 * (2 if kind.startswith("tri") else 1)] * 3
    shapes = {name: facets.shape for name, facets in mesh.curves.items()}
    assert shapes == {
        name: (n, 2 + quadratic) for name, n in (("skin", 12), ("bone", 24), ("nail", 12))
    }
    chain = mesh.points[skin_chain(mesh)]
    assert (np.diff(chain[:, 0]) > 0.0).all() and chain[0, 0] == pytest.approx(-8e-3)
    if quadratic:
        assert areas(mesh).sum() == pytest.approx(np.pi * (64e-6 - 9e-6), rel=1e-3)
    assert mesh.symmetric
    half = mesh.right_half()
    assert 2 * len(half.cells) == len(mesh.cells)
    assert half.points[:, 0].min() == 0.0 and len(half.curves["symmetry"]) == 12
    again = read_back(mesh, tmp_path)
    np.testing.assert_allclose(again.points, mesh.points, atol=1e-12)
    np.testing.assert_array_equal(again.cells, mesh.cells)


def test_centre_of_an_eight_node_quad_is_that_of_its_own_map(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "quad8"))
    nodes = mesh.points[mesh.cells]
    shape = np.array([-0.25] * 4 + [0.5] * 4)  # the serendipity functions at the centre
    np.testing.assert_allclose(nodes[:, 8], np.einsum("n,enx->ex", shape, nodes[:, :8]), atol=1e-15)
    # curved elements, or nothing is shown
    assert np.abs(nodes[:, 8] - nodes[:, :4].mean(axis=1)).max() > 1e-5


def test_meshes_that_are_not_their_mirror_image(tmp_path):
    """Bent on one side, or turned by half an element, which then lie astride the axis."""
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri6"))
    bent = replace(mesh, points=mesh.points + np.where(mesh.points[:, :1] > 7e-3, 1e-5, 0.0))
    again = read_back(bent, tmp_path)
    assert not again.symmetric
    with pytest.raises(MeshError, match="mirror image"):
        again.right_half()
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "quad4"))
    assert not read_back(turned(mesh, 7.5), tmp_path).symmetric


def test_unstructured_triangles(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri6", structured=False))
    assert quality_of(mesh)["worst_scaled_jacobian"] > 0.3


def test_linear_triangles_can_be_elevated(tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "rings.msh", "tri3"))
    raised = mesh.elevated()
    assert raised.element == "tri6" and raised.elevated() is raised
    assert len(raised.points) == len(places(raised.points))
    middle, corners = raised.points[raised.cells[:, 3:]], raised.points[raised.cells[:, :3]]
    # the skin's sides bend as it does, to the ends' radius; their chords: 8.6e-3
    bent = np.isin(raised.cells[:, 3:], raised.curves["skin"][:, 2])
    straight = 0.5 * (corners + corners[:, [1, 2, 0]])
    np.testing.assert_allclose(middle[~bent], straight[~bent], atol=1e-18)
    radius = np.hypot(*raised.points[raised.curves["skin"][0, 0]])
    np.testing.assert_allclose(np.hypot(*middle[bent].T), radius, rtol=1e-3)
    for name, facets in raised.curves.items():
        np.testing.assert_array_equal(facets[:, :2], mesh.curves[name])
        if name != "skin":
            chords = raised.points[facets[:, :2]].mean(axis=1)
            np.testing.assert_allclose(raised.points[facets[:, 2]], chords, atol=1e-18)
    assert len(skin_chain(raised)) == 25
    raised.right_half()


def test_unused_nodes_are_dropped(draft, tmp_path):
    extra = replace(draft, points=np.concatenate((draft.points, [[0.5, 0.5]])))
    assert len(read_back(extra, tmp_path).points) == len(draft.points)


@pytest.mark.parametrize("which", [[7], slice(None)])
def test_elements_that_run_clockwise_are_turned(draft, which, tmp_path):
    cells = draft.cells.copy()
    cells[which] = cells[which][:, KIND_TABLE["quad9"].mirrored]
    again = read_back(replace(draft, cells=cells), tmp_path)
    check_orientation(again, "turned")
    np.testing.assert_array_equal(np.sort(again.cells), np.sort(draft.cells))


def test_boundary_without_a_name_is_free(draft, tmp_path):
    curves = {**draft.curves, "nail": draft.curves["nail"][1:]}
    mesh = read_back(replace(draft, curves=curves), tmp_path)
    assert mesh.fixed == ("bone", "nail")
    left_out = draft.points[draft.curves["nail"][:1]]
    np.testing.assert_allclose(mesh.points[mesh.curves["unnamed"]], left_out, atol=1e-12)


@pytest.mark.parametrize(
    ("edit", "names", "fixed", "unnamed"),
    [
        (None, {"free": ("nail",)}, ("bone",), 0),
        (renamed(nail=None), {}, ("bone",), 12),
        (renamed(bone=None), {}, ("nail",), 24),
        (renamed(bone="hole", nail="rest"), {"fixed": ("hole",)}, ("hole",), 12),
    ],
)
def test_what_is_held(edit, names, fixed, unnamed, tmp_path):
    mesh = read_pad_mesh(write_rings(tmp_path / "pad.msh", edit=edit), **names)
    assert mesh.fixed == fixed and len(mesh.curves["skin"]) == 12
    assert len(mesh.curves.get("unnamed", ())) == unnamed


OWN_NAMES = renamed(epidermis="cover", dermis="foam", fat="core")


def test_surfaces_have_names_of_their_own(tmp_path):
    path = write_rings(tmp_path / "pad.msh", edit=OWN_NAMES)
    assert read_pad_mesh(path).regions == ("cover", "foam", "core")
    order = "core", "foam", "cover"
    assert read_pad_mesh(path, layers=order).regions == order


# -- files that are refused ------------------------------------------------------------------------


def refused(path, *words, **names):
    with pytest.raises(MeshError) as caught:
        read_pad_mesh(path, **names)
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and "\n" not in message
    for word in words:
        assert word in message, message


def test_files_that_are_no_mesh(tmp_path):
    refused(tmp_path / "none.msh", "no such mesh file")
    refused(tmp_path, "no such mesh file")
    for content in (b"", b"SystemCall 'echo';", b"\x00\xff" * 100):
        (tmp_path / "no.msh").write_bytes(content)
        refused(tmp_path / "no.msh", "not a gmsh mesh", "allowed")
    (tmp_path / "cut.msh").write_text("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n6 99")
    refused(tmp_path / "cut.msh")


def some_in(name):
    """A quarter of the epidermis in a group of another name."""
    return lambda groups: [
        (2, groups[0][1][:3], "epidermis"),
        (2, groups[0][1][3:], name),
        *groups[1:],
    ]


WRONG_GROUPS = {
    "no skin": (renamed(skin="other"), {}, "curve skin is missing", "among other, nail, bone"),
    "nothing held": (
        renamed(bone="hole", nail="rest"),
        {},
        "no curve is held",
        "bone, nail, base",
        "specimen.fixed",
        "among rest, hole",
    ),
    "no such curve": (
        renamed(bone="hole", nail="rest"),
        {"fixed": ("core",)},
        "fixed: core is no curve of the mesh; its physical curves are skin, rest, hole",
    ),
    "no such layer": (
        OWN_NAMES,
        {"layers": ("cover", "gel")},
        "layer gel is no surface of the mesh; its physical surfaces are cover, foam, core",
    ),
    "a layer left out": (
        OWN_NAMES,
        {"layers": ("cover", "foam")},
        "48 surface elements are in none of cover, foam; each must be in one",
        "also has core",
    ),
    "no groups": (lambda groups: [], {}, "no surface is named"),
    "in two layers": (
        lambda groups: [*groups[1:], (2, [1, 5], "epidermis"), (2, [1], "fat")],
        {},
        "in two of",
    ),
    "in no layer": (some_in("rest"), {}, "12 surface elements are in none of"),
}


@pytest.mark.parametrize("name", WRONG_GROUPS)
def test_wrong_groups_are_named(name, tmp_path):
    edit, names, *words = WRONG_GROUPS[name]
    refused(write_rings(tmp_path / "pad.msh", edit=edit), *words, **names)


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


def test_mesh_out_of_plane(draft, tmp_path):
    path = tmp_path / "pad.msh"
    write_pad(draft, path)
    text = path.read_text()
    place = re.search(r"^(\S+ \S+) 0$", text[text.index("$Nodes") :], re.MULTILINE)
    path.write_text(text.replace(place[0], f"{place[1]} 0.5"))
    refused(path, "one plane")


def moved(mesh, node, place):
    points = mesh.points.copy()
    points[node] = place
    return replace(mesh, points=points)


def apart(mesh):
    cells = mesh.cells + (mesh.region == 1)[:, None].astype(np.int32) * len(mesh.points)
    return replace(mesh, points=np.tile(mesh.points, (2, 1)), cells=cells)


def with_curve(mesh, name, edges, **others):
    """The mesh with edges added to one of its curves."""
    longer = np.concatenate((mesh.curves[name], edges))
    return replace(mesh, curves=mesh.curves | others | {name: longer})


def in_pieces(mesh):
    skin = mesh.curves["skin"]
    middle = len(skin) // 2
    return with_curve(mesh, "nail", skin[middle : middle + 1], skin=np.delete(skin, middle, axis=0))


WRONG = {
    "folded element": (
        lambda m: moved(m, m.cells[11, 8], m.points[m.cells[11, 0]] * 1.05),
        "element 11",
        "is folded",
    ),
    "not a number": (lambda m: moved(m, 3, np.nan),),
    "layers not joined": (apart, "are the layers joined?"),
    "curve inside the pad": (
        lambda m: with_curve(m, "bone", element_edges(m.cells[:1], "quad9")),
        "curve bone",
        "not on the boundary",
    ),
    "edge in two curves": (
        lambda m: with_curve(m, "nail", m.curves["skin"][:1]),
        "curve nail",
        "two curves",
    ),
    "skin in pieces": (in_pieces, "curve skin must be one line"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_meshes_are_named(draft, name, tmp_path):
    change, *words = WRONG[name]
    write_pad(change(draft), tmp_path / "pad.msh")
    refused(tmp_path / "pad.msh", *words)
