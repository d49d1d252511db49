"""Ridges and the stratum corneum: where they lie, how they are meshed, and that none at all costs
and changes nothing.
"""

import hashlib
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad import simulate
from fingerpad.planning.plan import PlanError, plan
from fingerpad.scenes.scene import Scene
from fingerpad.scenes.specimen import InnerRidges, Layers, OuterRidges, Ridges, Specimen
from fingerpad.specimen import (
    MeshError,
    MeshSize,
    OutlineCurve,
    RidgedPad,
    build_pad_mesh,
    count_nodes,
    mesh_for,
    quality_of,
    ridge_resolution,
    skin_chain,
    write_pad,
)
from fingerpad.specimen.build import size_of
from fingerpad.specimen.measures import below_outline, below_skin
from fingerpad.specimen.pad import element_edges
from fingerpad.specimen.ridges import mean_shape, ridge_shape
from own_meshes import areas, places, read_back

pytestmark = pytest.mark.unit

GF = 9.80665e-3
OUTLINE = Specimen(outline="long_term").outline
CURVE = OutlineCurve(OUTLINE)
SIZE = MeshSize(skin_edge=134.4e-6, fine_half_width=3.4e-3, layer_edge=121.5e-6)
DRAFT = MeshSize(skin_edge=268.8e-6, fine_half_width=3.4e-3, layer_edge=243e-6, growth=1.35)


def ridges(height=0.15e-3, outer=None, half_width=3.4e-3, **inner) -> Ridges:
    given = {"pitch": 0.48e-3, "shape": "smooth", "phase": "tip", "limiting": 0.0} | inner
    return Ridges(
        inner=InnerRidges(height=height, **given),
        outer=outer and OuterRidges(height=outer, shape="smooth"),
        half_width=half_width,
    )


RIDGES = ridges()
CASES = {
    "plain": (None, False),
    "inner": (RIDGES, False),
    "sharp": (ridges(shape="sharp"), False),
    "low": (ridges(0.02e-3), False),
    "high": (ridges(0.3e-3), False),
    "high and sharp": (ridges(0.3e-3, shape="sharp"), False),
    "valley": (ridges(phase="valley"), False),
    "aside": (ridges(phase=0.1e-3), False),
    "limiting": (ridges(limiting=0.5), False),
    "outer": (ridges(outer=60e-6), False),
    "corneum": (RIDGES, True),
    "outer and corneum": (ridges(outer=60e-6), True),
    "corneum alone": (None, True),
}


@pytest.fixture(scope="module")
def meshes():
    return {name: build_pad_mesh(OUTLINE, SIZE, *case) for name, case in CASES.items()}


@pytest.fixture(params=CASES)
def case(request, meshes):
    """Ridges, whether with stratum corneum, and the mesh."""
    return *CASES[request.param], meshes[request.param]


def named(points) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths from the apex and depths below the smooth outline (m) of points (n, 2) of the
    upper half, by Newton steps.
    """
    theta = CURVE.theta_at_x(np.clip(points[:, 0], -OUTLINE.half_width, OUTLINE.half_width))
    for _ in range(30):
        arm, normal = points - CURVE.point(theta), CURVE.normal(theta)
        depth = -(arm * normal).sum(axis=1)
        speed = np.hypot(*CURVE._tangent(theta)) * (1.0 - depth * CURVE.curvature(theta))
        theta = theta + (arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]) / speed
    return CURVE.arc_length(theta), ((CURVE.point(theta) - points) * CURVE.normal(theta)).sum(1)


def stated(ridges, corneum, s, depth):
    """Depths (m) below the smooth outline of what would be `depth` below it in the plain pad."""
    plain = np.full_like(s, depth)
    thick = OUTLINE.stratum_corneum_thickness if corneum else 0.0
    return RidgedPad(OUTLINE, ridges, thick).depth(s, plain) if ridges else plain


def borders(corneum):
    """Depths (m) of the layers' lower borders in the plain pad, but for the bone."""
    return [*([OUTLINE.stratum_corneum_thickness] if corneum else []), *CURVE.layer_depths]


def between(mesh, upper: str, lower: str, reach: float = 5e-3) -> np.ndarray:
    """Nodes shared by two layers, within `reach` of the axis on the touched side."""
    of = [np.unique(mesh.cells[mesh.region == mesh.regions.index(name)]) for name in (upper, lower)]
    nodes = np.intersect1d(*of)
    return nodes[(np.abs(mesh.points[nodes, 0]) < reach) & (mesh.points[nodes, 1] > 2e-3)]


# -- nothing asked, nothing changed ----------------------------------------------------------------


def test_plain_mesh_is_what_it_was_before_ridges_existed():
    """Byte for byte when written; kept to a picometre, for sines differ in the last bit between
    processors.
    """
    mesh = build_pad_mesh(OUTLINE, SIZE)
    content = (mesh.points.round(12) + 0.0).tobytes() + mesh.cells.tobytes() + mesh.region.tobytes()
    assert (
        hashlib.sha256(content).hexdigest()
        == "8cc84893d75d5f18b2dd936fc7fe745540053613d010f4f2afc995a5d0e9a0f1"
    )
    assert len(mesh.points) == 10812


# -- where ridges lie ------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", ["smooth", "sharp"])
@pytest.mark.parametrize("limiting", [0.0, 0.3, 0.9])
def test_shapes_reach_from_valley_to_tip_and_have_the_mean_stated(shape, limiting):
    u = np.arange(4096) / 4096
    values = ridge_shape(u, shape, limiting)
    assert values.max() == values[0] == 1.0 and values.min() == pytest.approx(0.0, abs=1e-15)
    assert values.mean() == pytest.approx(mean_shape(shape, limiting), rel=1e-12)
    assert ridge_shape(0.5, shape, limiting) == pytest.approx(limiting, abs=1e-15)


def test_a_sharp_tip_has_half_the_radius_of_a_smooth_one():
    u = np.array([-1e-4, 0.0, 1e-4])
    bend = {shape: np.diff(ridge_shape(u, shape), n=2)[0] for shape in ("smooth", "sharp")}
    assert bend["sharp"] == pytest.approx(2.0 * bend["smooth"], rel=1e-5)


def test_tips_are_deep_and_the_mean_depth_is_kept():
    pad = RidgedPad(OUTLINE, RIDGES)
    assert pad.interface_shift(np.array([0.0, 0.24e-3])) == pytest.approx([75e-6, -75e-6])
    s = np.linspace(-0.96e-3, 0.96e-3, 4001)[:-1]
    for each in (pad, RidgedPad(OUTLINE, ridges(shape="sharp", limiting=0.4, phase=0.1e-3))):
        assert each.interface_shift(s).mean() == pytest.approx(0.0, abs=1e-12)
    assert pad.interface_shift(np.array([3.88e-3, -4.5e-3])) == pytest.approx(0.0, abs=1e-18)


def test_outer_crests_lie_over_inner_tips():
    pad = RidgedPad(OUTLINE, ridges(outer=60e-6, phase=0.1e-3))
    s = np.linspace(-0.24e-3, 0.24e-3, 2001)
    assert s[np.argmin(pad.skin_shift(s))] == pytest.approx(
        s[np.argmax(pad.interface_shift(s))], abs=3e-7
    )
    assert np.ptp(pad.skin_shift(s)) == pytest.approx(60e-6, rel=1e-4)


def test_corneum_follows_outer_ridges_and_ignores_inner_ones():
    pad = RidgedPad(OUTLINE, ridges(outer=60e-6), OUTLINE.stratum_corneum_thickness)
    s = np.linspace(-1e-3, 1e-3, 101)
    thickness = pad.depth(s, np.full_like(s, OUTLINE.stratum_corneum_thickness)) - pad.depth(
        s, np.zeros_like(s)
    )
    assert thickness == pytest.approx(OUTLINE.stratum_corneum_thickness, rel=1e-12)


# -- the mesh --------------------------------------------------------------------------------------


def test_nodes_lie_on_the_stated_curves(case):
    """Mid-side nodes too: every node of an interface, and of the skin, is where the ridges say."""
    ridges, corneum, mesh = case
    for depth, *layers in zip(borders(corneum), mesh.regions, mesh.regions[1:], strict=False):
        s, found = named(mesh.points[between(mesh, *layers)])
        np.testing.assert_allclose(found, stated(ridges, corneum, s, depth), atol=1e-12)
        assert len(s) > 70 * (3 if ridges and layers[0] == "epidermis" else 1)
    skin = mesh.points[skin_chain(mesh)]
    s, found = named(skin[np.abs(skin[:, 0]) < 5e-3])
    np.testing.assert_allclose(found, stated(ridges, corneum, s, 0.0), atol=1e-12)


def test_elements_are_no_worse_than_the_slope_of_the_ridges(case):
    ridges, _, mesh = case
    steep = ridges is not None and ridges.inner.height > 0.2e-3
    assert quality_of(mesh)["worst_scaled_jacobian"] > (0.25 if steep else 0.35)
    np.testing.assert_array_equal(np.unique(mesh.cells), np.arange(len(mesh.points)))
    assert len(places(mesh.points)) == len(mesh.points)


def test_mesh_is_conforming_and_its_boundary_is_named(case):
    """Two elements meet along whole edges, mid-side node included; what is left over is the
    boundary.
    """
    mesh = case[2]
    edges = element_edges(mesh.cells, mesh.element)
    _, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    assert counts.max() == 2
    assert np.count_nonzero(counts == 1) == sum(map(len, mesh.curves.values()))
    facets = np.concatenate(list(mesh.curves.values()))
    assert places(facets[:, [1, 0, 2]]) <= places(edges)
    chain = skin_chain(mesh)
    assert len(chain) == 2 * len(mesh.curves["skin"]) + 1 == len(np.unique(chain))
    assert (np.diff(mesh.points[chain[mesh.points[chain, 1] > 0], 0]) > 0).all()


def test_mesh_is_symmetric_to_the_last_bit_where_the_ridges_are(case):
    ridges, _, mesh = case
    x = mesh.points[:, 0]
    mirrored = places(mesh.points[x < 0] * (-1.0, 1.0))
    assert mesh.symmetric == (places(mesh.points[x > 0]) == mirrored)
    if ridges is not None and ridges.inner.phase == 0.1e-3:
        with pytest.raises(MeshError, match="mirror image"):
            mesh.right_half()
        return
    half = mesh.right_half()
    assert 2 * len(half.cells) == len(mesh.cells) and half.regions == mesh.regions
    assert (x == 0).sum() == (np.abs(x) < 1e-9).sum()


def test_areas_are_those_under_the_stated_curves(case):
    """Area between depths a(s) and b(s) of a curve of curvature k is the integral of (b - a) - k
    (b^2 - a^2) / 2.
    """
    ridges, corneum, mesh = case
    theta = np.linspace(-np.pi, np.pi, 400001)
    s, k = CURVE.arc_length(theta), CURVE.curvature(theta)
    curves = [stated(ridges, corneum, s, depth) for depth in (0.0, *borders(corneum))]
    layers = [np.trapezoid((b - a) - 0.5 * k * (b**2 - a**2), s) for a, b in pairwise(curves)]
    np.testing.assert_allclose(areas(mesh)[:-1], layers, rtol=3e-4)
    x, y = CURVE.point(theta).T
    bone = np.pi * OUTLINE.bone_half_width * OUTLINE.bone_half_height
    rel = 1e-3 if ridges else 1e-4
    assert areas(mesh).sum() == pytest.approx(np.trapezoid(y, x) - bone, rel=rel)


def test_ridges_are_resolved(meshes):
    """At least 8 elements a pitch and 4 rows a height, counted on the mesh itself round the tip and
    the valley at the apex.
    """
    for name in ("inner", "sharp", "high", "high and sharp", "outer", "corneum"):
        mesh, pad = meshes[name], RidgedPad(OUTLINE, CASES[name][0])
        s, depth = named(mesh.points[mesh.cells[:, :4]].reshape(-1, 2))
        shared = between(mesh, "epidermis", "dermis")
        corners = np.intersect1d(shared, np.unique(mesh.cells[:, :4]))
        along = np.sort(named(mesh.points[corners])[0])
        assert np.diff(along[np.abs(along) < pad.extent]).max() <= pad.pitch / 8
        for place in (0.0, pad.pitch / 2):
            near = along[np.argmin(np.abs(along - place))]
            column = np.unique(np.round(depth[np.abs(s - near) < 1e-9], 12))
            away = column - pad.interface - float(pad.interface_shift(near))
            for side in (away[away > 1e-9], -away[away < -1e-9]):
                assert np.count_nonzero(side <= pad.inner.height * 1.01) >= 4, name
        per_pitch, per_height = ridge_resolution(OUTLINE, SIZE, *CASES[name])
        assert per_pitch >= 8.0 and per_height >= 4


@pytest.mark.parametrize("size", [DRAFT, SIZE], ids=["draft", "thesis"])
def test_resolution_holds_for_coarse_meshes_and_narrow_ridges(size):
    for case in (RIDGES, ridges(pitch=0.3e-3), ridges(limiting=0.5)):
        per_wave, per_height = ridge_resolution(OUTLINE, size, case)
        assert per_wave >= 8.0 - 1e-9 and per_height >= 4


def test_counting_is_building(case):
    ridges, corneum, mesh = case
    quality = quality_of(mesh)
    assert size_of(OUTLINE, SIZE, ridges, corneum) == (
        quality["nodes"],
        quality["smallest_edge_m"],
    )


def test_ridges_of_no_height_are_the_plain_pad():
    """Areas, interfaces and receptors' places are the plain pad's to the ridges' height."""
    low, plain = (build_pad_mesh(OUTLINE, SIZE, each) for each in (ridges(1e-9, outer=1e-9), None))
    np.testing.assert_allclose(areas(low), areas(plain), rtol=2e-5)
    for depth, *layers in zip(CURVE.layer_depths, low.regions, low.regions[1:], strict=False):
        np.testing.assert_allclose(named(low.points[between(low, *layers)])[1], depth, atol=1.01e-9)
    depths, offsets = np.array([600e-6, 915e-6, 915e-6]), np.array([0.0, 46e-6, -1e-3])
    for points in (below_skin(low, depths, offsets), below_outline(OUTLINE, depths, offsets)):
        np.testing.assert_allclose(points, below_skin(plain, depths, offsets), atol=3e-8)


def test_receptor_depth_is_measured_from_the_smooth_skin():
    """Under a crest of outer ridges as under a furrow: the wavy skin itself is no measure."""
    x, y = below_outline(OUTLINE, 915e-6, [0.0, 0.24e-3]).T
    np.testing.assert_allclose(x, [0.0, 0.24e-3], atol=1e-15)
    assert y[0] == pytest.approx(6e-3 - 915e-6)
    assert named(np.column_stack((x, y)))[1] == pytest.approx(915e-6)
    with pytest.raises(MeshError, match="no point"):
        below_outline(OUTLINE, 915e-6, 9.4e-3)


@pytest.mark.parametrize("name", ["plain", "aside", "outer and corneum", "corneum alone"])
def test_files_keep_the_mesh_and_its_layers(name, meshes, tmp_path):
    mesh, again = meshes[name], read_back(meshes[name], tmp_path)
    assert (tmp_path / "own.msh").read_text().startswith("$MeshFormat\n4.1 0 8")
    np.testing.assert_allclose(again.points, mesh.points, rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(again.cells, mesh.cells)
    np.testing.assert_array_equal(again.region, mesh.region)
    assert again.regions == mesh.regions and again.symmetric == mesh.symmetric
    np.testing.assert_array_equal(skin_chain(again), skin_chain(mesh))
    for curve, facets in mesh.curves.items():
        assert places(again.curves[curve]) == places(facets)


def test_what_has_no_room_is_refused():
    thin = OUTLINE.model_copy(update={"dermis_thickness": 0.2e-3})
    thick = OUTLINE.epidermis_thickness
    all_horn = OUTLINE.model_copy(update={"stratum_corneum_thickness": thick})
    for words, *wrong in (
        ("^ridges: half_width", OUTLINE, DRAFT, ridges(half_width=12e-3)),
        ("^ridges: the dermis is too thin", thin, SIZE, ridges(0.14e-3)),
        ("no epidermis", all_horn, DRAFT, None, True),
    ):
        with pytest.raises(MeshError, match=words):
            build_pad_mesh(*wrong)


@settings(max_examples=25, deadline=None)
@given(
    inner=st.fixed_dictionaries(
        {
            "height": st.floats(0.02e-3, 0.3e-3),
            "pitch": st.floats(0.35e-3, 0.7e-3),
            "shape": st.sampled_from(["smooth", "sharp"]),
            "phase": st.sampled_from(["tip", "valley"]) | st.floats(-0.15e-3, 0.15e-3),
            "limiting": st.just(0.0) | st.floats(0.1, 0.9),
            "outer": st.none() | st.floats(0.01e-3, 0.1e-3),
        }
    ),
    corneum=st.booleans(),
    edge=st.floats(0.12e-3, 0.3e-3),
    growth=st.floats(1.15, 1.4),
)
def test_any_ridges_of_the_literature_can_be_meshed(inner, corneum, edge, growth):
    asked = ridges(**inner)
    size = replace(SIZE, skin_edge=edge, layer_edge=0.9 * edge, growth=growth)
    mesh = build_pad_mesh(OUTLINE, size, asked, corneum)
    assert len(mesh.points) == count_nodes(OUTLINE, size, asked, corneum)
    assert quality_of(mesh)["worst_scaled_jacobian"] > 0.08
    pad = RidgedPad(OUTLINE, asked, OUTLINE.stratum_corneum_thickness if corneum else 0.0)
    assert mesh.symmetric == pad.symmetric
    s, depth = named(mesh.points[between(mesh, "epidermis", "dermis", 3e-3)])
    np.testing.assert_allclose(depth, pad.interface + pad.interface_shift(s), atol=1e-11)
    per_wave, per_height = ridge_resolution(OUTLINE, size, asked, corneum)
    assert per_wave >= 8.0 - 1e-9 and (per_height >= 4 or inner["height"] < pad.wave / 4)


# -- scenes ----------------------------------------------------------------------------------------


def test_words_for_ridges():
    """The names stand for the thesis file's ridges; outer ones have the inner ones' pitch."""
    assert Specimen().ridges is None and Specimen(ridges="none").ridges is None
    inner, both = Specimen(ridges="inner").ridges, Specimen(ridges="inner_and_outer").ridges
    assert inner.inner.model_dump() == pytest.approx(RIDGES.inner.model_dump())
    assert inner.outer is None and inner.half_width == pytest.approx(3.4e-3)
    assert both.inner == inner.inner
    assert both.outer.model_dump() == pytest.approx(
        {"period": None, "height": 60e-6, "shape": "smooth"}
    )
    assert RidgedPad(OUTLINE, both).period == inner.inner.pitch
    assert Specimen().model_dump()["ridges"] == "none"


def test_stratum_corneum_is_a_layer_only_if_asked_for():
    layers = Specimen().layers
    assert layers.stratum_corneum is None and set(layers.model_dump()) == {
        "epidermis",
        "dermis",
        "fat",
    }
    own = Specimen(layers={"stratum_corneum": {"youngs_modulus": 1e6}}).layers
    assert (own.stratum_corneum.youngs_modulus, own.stratum_corneum.poisson_ratio) == (1e6, 0.48)
    assert Specimen(layers={"stratum_corneum": {}}).layers.stratum_corneum == layers.epidermis
    assert Layers.model_validate(own.model_dump()) == own


def test_ridges_beside_a_mesh_are_refused(meshes, tmp_path):
    write_pad(meshes["corneum"], tmp_path / "pad.msh")
    with pytest.raises(ValueError, match="beside a mesh"):
        Specimen(mesh=tmp_path / "pad.msh", ridges="inner")


# -- plans -----------------------------------------------------------------------------------------


def scene(specimen, stimulus=None, effects=None, hold=2.0, offsets=(0.0,)) -> Scene:
    return Scene(
        name="ridged",
        specimen=specimen,
        stimulus=stimulus or {"shape": "flat"},
        motion=[{"press_to_force": 20 * GF, "rate": 40 * GF}, *([{"hold": hold}] if hold else [])],
        accuracy="draft",
        effects=effects or {},
        outputs={"receptors": {"depths": [600e-6, 915e-6], "offsets": list(offsets)}},
    )


def test_ridges_can_be_overridden_off_but_not_on():
    asked = scene({"ridges": {"inner": {"phase": 0.1e-3}}}, effects={"ridges": False})
    chosen = plan(asked)
    assert not chosen.effects["ridges"].on and "asked for" in chosen.effects["ridges"].why
    assert chosen.effects["symmetry"].on
    np.testing.assert_array_equal(
        mesh_for(asked, chosen).points, build_pad_mesh(Specimen().outline, chosen.mesh_size).points
    )
    with pytest.raises(
        PlanError, match="effects.ridges: on, but the specimen has none; allowed: off or auto"
    ):
        plan(scene({"ridges": "none"}, effects={"ridges": True}))
    assert plan(scene({"ridges": "inner"}, effects={"ridges": True})).effects["ridges"].on


def test_ridges_that_are_not_symmetric_need_the_whole_pad():
    aside = scene({"ridges": {"inner": {"phase": 0.1e-3}}})
    assert "ridges are not their own mirror image" in plan(aside).effects["symmetry"].why
    assert plan(scene({"ridges": {"inner": {"phase": "valley"}}})).effects["symmetry"].on
    with pytest.raises(PlanError, match="effects.symmetry"):
        plan(aside.model_copy(update={"effects": {"symmetry": True}}))


# -- simulations -----------------------------------------------------------------------------------


FELT = ["force", "indentation_depth", "contact_width", "centre_pressure", "strain_energy_density"]


def ends(history) -> dict[str, np.ndarray]:
    return {name: history[name].values[-1] for name in FELT}


@pytest.mark.parametrize(
    "stimulus",
    [{"shape": "flat"}, {"shape": "cylinder", "curvature": 209.97}],
    ids=["flat", "210 1/m"],
)
def test_ridges_of_no_height_answer_as_the_plain_pad(stimulus):
    """To discretisation error: a draft's, planned to be 6 %, is 1 % here."""
    low = {"inner": {"height": 1e-9}}
    plain, ridged = (
        ends(simulate(scene({"ridges": each}, stimulus, offsets=(0.0, 46e-6))))
        for each in ("none", low)
    )
    for name, value in plain.items():
        np.testing.assert_allclose(ridged[name], value, rtol=0.01, err_msg=name)


def test_inner_ridges_press_without_cuts_and_are_felt():
    """The energy at 600 um, in the epidermis, is larger over a tip than over a valley; the pad as a
    whole hardly knows.
    """
    pad = RidgedPad(OUTLINE, RIDGES)
    at = [0.0, float(pad.curve.point(pad.curve.theta_at(pad.wave / 2), pad.interface)[0, 0])]
    plain, ridged = (
        simulate(scene({"ridges": each}, hold=0, offsets=at)) for each in ("none", "inner")
    )
    assert ridged.cutbacks.sum() == 0 and ridged.min_detF.min() > 0.9
    assert abs(ridged.energy_balance_error[-1]) < 0.02
    assert float(ridged.indentation_depth[-1]) == pytest.approx(
        float(plain.indentation_depth[-1]), rel=0.02
    )
    tip, valley = ridged.strain_energy_density[-1].values[:2]
    assert tip > 1.3 * valley
    np.testing.assert_allclose(*plain.strain_energy_density[-1].values[:2], rtol=0.01)


def test_outer_ridges_break_the_contact_into_islands():
    history = simulate(scene({"ridges": "inner_and_outer"}, hold=0))
    assert history.cutbacks.sum() == 0
    pressure = history.contact_pressure[-1].values
    islands = np.count_nonzero(np.diff((pressure > 0).astype(int)) == 1)
    assert islands >= 5 and float(history.force[-1]) == pytest.approx(20 * GF / 0.0114, rel=1e-6)


def test_own_corneum_of_the_epidermis_s_modulus_changes_nothing(meshes):
    """And the layer's stiffness does."""
    specimens = (
        {},
        {"layers": {"stratum_corneum": {}}},
        {"layers": {"stratum_corneum": {"youngs_modulus": 1e6}}},
    )
    plain, same, stiff = (ends(simulate(scene(each, hold=0))) for each in specimens)
    for name, value in plain.items():
        np.testing.assert_allclose(same[name], value, rtol=0.01, err_msg=name)
    assert stiff["indentation_depth"] < 0.97 * plain["indentation_depth"]
