"""Bodies of revolution: patch tests, pressurised tube and sphere, and Hertz's sphere, up to nu =
0.4999.
"""

from dataclasses import replace

import numpy as np
import pytest
from meshes import KIND, graded, mapped, nodes_of, quarter_annulus, rectangle
from pressing import press, walk
from problems import BODIES, close, lame_constants, solve

from fingerpad.laws import NEO_HOOKE, Assigned
from fingerpad.mechanics.contact_points import ContactPoints
from fingerpad.mechanics.finite_strain import FiniteStrainBody
from fingerpad.mechanics.kinematics import AXISYMMETRIC, PLANE_STRAIN
from fingerpad.mechanics.space import Space, edge_load_vectors
from fingerpad.mechanics.stepping import Step
from fingerpad.receptors.material_points import MaterialPoints
from fingerpad.reference_solutions import lame, layered_round, revolution
from fingerpad.reference_solutions.layered import Layer
from fingerpad.specimen.materials import Prony
from fingerpad.stimuli.shapes import Cone, Cylinder, Punch

YOUNG = 1000.0
POISSON = (0.3, 0.4999)
SOLVED = pytest.mark.parametrize("element", ["Q2P1", "Q1P0"])


def turned(mesh, poisson, rollers, element, strain="small", kinematics=AXISYMMETRIC, prony=None):
    """Body of one material; ``rollers``: curves and which of their components are held."""
    fixed = np.zeros(mesh.points.shape, bool)
    for curve, components in rollers.items():
        fixed[nodes_of(mesh, curve)[:, None], components] = True
    space = Space(mesh.points, mesh.cells, mesh.element, fixed, element, kinematics)
    shear, bulk = (np.full(len(mesh.cells), each) for each in lame_constants(YOUNG, poisson))
    return BODIES[strain](space, shear, bulk, prony)


def pressed(mesh, body, pressures):
    """Solve under pressures (Pa) on curves that run clockwise round the mesh."""
    load = np.zeros_like(body.u)
    for curve, pressure in pressures.items():
        edges = mesh.curves[curve]
        load -= pressure * edge_load_vectors(body.space.points, edges, body.space.kinematics)
    solve(body, load, tolerance=1e-9 if body.geometrically_linear else 1e-6)


# -- patches ---------------------------------------------------------------------------------------


def check_patch(element, strain, kinematics=AXISYMMETRIC, poisson=0.3):
    """A distorted disc, its axis at x = 0, under a pressure all round and another on top."""
    mesh = rectangle(3, 3, 2.0, 1.0, KIND[element], distortion=0.3)
    body = turned(mesh, poisson, {"left": 0, "bottom": 1}, element, strain, kinematics)
    around, above = (0.3, 0.1) if strain == "small" else (3e-5, 1e-5)
    pressed(mesh, body, {"right": around, "top": above})
    radial = (-around + 0.3 * (around + above)) / YOUNG
    axial = (-above + 0.6 * around) / YOUNG
    truth = mesh.points * [radial, axial]
    u = body.u[: len(mesh.points)]
    within = 1e-9 if strain == "small" else 1e-6
    close(u, truth, "uniform", atol=within * np.abs(truth).max(), rtol=0)
    where = np.array([[0.0, 0.5], [0.7, 0.2]])
    found = MaterialPoints(body, where, None).sample(body)
    close(found["dilatation"], 2 * radial + axial, "dilatation", rtol=1e-6)
    close(found["compressive_strain"], -radial, "on the axis and beside it", rtol=1e-6)


@pytest.mark.parametrize("strain", ["small", "finite"])
@SOLVED
def test_patch(element, strain, must_fail):
    """Uniform stress is met to round-off on distorted quads that touch the axis; a receptor there
    has its strain.
    """
    check_patch(element, strain)
    must_fail(check_patch, element, strain, kinematics=PLANE_STRAIN)
    must_fail(check_patch, element, strain, poisson=0.29)


def check_pressure_patch(element, kinematics=AXISYMMETRIC):
    """Forces at the points of skin under a uniform pressure are its load on every node."""
    mesh = mapped(
        5, 2, lambda s: np.stack([s[:, 0], 0.5 * s[:, 1] - 0.1 * s[:, 0]], 1), KIND[element]
    )
    edges = mesh.curves["top"]
    chain = np.unique(edges)
    chain = chain[np.argsort(mesh.points[chain, 0])]
    shear = np.ones(len(edges))
    places = ContactPoints.on(mesh.points, chain, edges, shear, True, kinematics=kinematics)
    area = places.lengths(mesh.points)
    slope = np.einsum("qa,qai->qi", places.slopes, mesh.points[places.nodes])
    down = np.stack([slope[:, 1], -slope[:, 0]], 1) / np.hypot(*slope.T)[:, None]
    found = np.zeros(mesh.points.shape)
    np.add.at(found, places.nodes, places.values[:, :, None] * (down * area[:, None])[:, None])
    load = -edge_load_vectors(mesh.points, edges, AXISYMMETRIC)
    close(found, load, "load", atol=1e-12 * np.abs(load).max())
    close(area.sum(), np.pi * np.hypot(1.0, 0.1), "the cone's area", rtol=1e-12)


@SOLVED
def test_pressure_patch(element, must_fail):
    check_pressure_patch(element)
    must_fail(check_pressure_patch, element, kinematics=PLANE_STRAIN)


# -- under pressure --------------------------------------------------------------------------------


def tube_error(element, poisson, count, solved=None):
    """Relative error of the bore's displacement of a tube that cannot lengthen."""
    mesh = rectangle(count, 1, 6.0, 1.0, KIND[element], origin=(3.0, 0.0))
    body = turned(mesh, solved or poisson, {"bottom": 1, "top": 1}, element)
    pressed(mesh, body, {"left": 1.0})
    truth = lame.radial_displacement(3.0, 3.0, 9.0, YOUNG, poisson, internal=1.0)
    return abs(body.u[nodes_of(mesh, "left"), 0].mean() / truth - 1)


def sphere_error(element, poisson, count, solved=None):
    """The same of a hollow sphere, whose mesh touches the axis."""
    mesh = quarter_annulus(count, count, 3.0, 9.0, KIND[element])
    body = turned(mesh, solved or poisson, {"bottom": 1, "top": 0}, element)
    pressed(mesh, body, {"left": 1.0})
    bore = nodes_of(mesh, "left")
    found = np.hypot(*(mesh.points + body.u[: len(mesh.points)])[bore].T).mean() - 3.0
    return abs(found / revolution.thick_sphere(3.0, 3.0, 9.0, YOUNG, poisson, 1.0) - 1)


def check_under_pressure(error_of, element, poisson, solved=None):
    coarse, fine = (error_of(element, poisson, count, solved) for count in (6, 12))
    within, rate = (6e-3, 1.8) if element == "Q1P0" else (3e-5, 3.5)
    assert fine < within, f"truth: off by {fine:.1e}"
    assert np.log2(coarse / fine) > rate, f"truth: of order {np.log2(coarse / fine):.2f}"


@pytest.mark.parametrize("poisson", POISSON)
@SOLVED
@pytest.mark.parametrize("error_of", [tube_error, sphere_error])
def test_thick_walls(error_of, element, poisson, must_fail):
    """Tube and sphere under inner pressure widen as Lame says, with the element's order, also where
    they are nearly incompressible.
    """
    check_under_pressure(error_of, element, poisson)
    must_fail(check_under_pressure, error_of, element, poisson, solved=0.28)


# -- Hertz -----------------------------------------------------------------------------------------

MAXWELL = Prony((0.5,), (1.0,))
WIDE = 300.0  # of the block, in radii of the contact


def block(
    element, poisson, strain="small", fine=16, kinematics=AXISYMMETRIC, wide=WIDE, prony=None
):
    """A cylinder so wide and deep that it is a half-space, fine within two units of its axis."""
    columns = graded(2.0 / wide, fine, 2 * fine)
    mesh = rectangle(columns, 1 - columns[::-1], wide, wide, KIND[element])
    rollers = {"left": 0, "right": 0, "bottom": 1}
    return mesh, turned(mesh, poisson, rollers, element, strain, kinematics, prony)


def check_hertz(element, poisson, *, solved=None, radius=200.0, kinematics=AXISYMMETRIC):
    """A sphere of 200 radii of the contact, 1/200 deep."""
    modulus = YOUNG / (1 - poisson**2)
    force = float(revolution.sphere_force(1 / 200, 200.0, modulus))
    within = 0.02 if element == "Q1P0" else 0.005
    mesh, body = block(element, solved or poisson, kinematics=kinematics)
    found = press(body, mesh, Cylinder(curvature=1 / radius), force=force)
    inside = found.x < 0.85
    truth = revolution.sphere_pressure(found.x, force, 1.0)
    off = np.abs(found.pressure - truth)[inside].max() / truth[0]
    assert off < 3 * within, f"truth: the pressure is off by {off:.4f} of its peak"
    assert abs(found.half_width - 1) < 2 * within, f"truth: contact radius {found.half_width:.4f}"
    assert abs(200 * found.depth - 1) < within, f"truth: depth {200 * found.depth:.5f}"
    assert found.records[-1].energy_error < 0.02, "truth: energy"  # of one step
    return found


@pytest.mark.parametrize("poisson", POISSON)
@SOLVED
def test_hertz(element, poisson, must_fail):
    """A rigid sphere makes Hertz's pressure inside 0.85 a, his radius of the contact, and his
    depth.
    """
    check_hertz(element, poisson)
    must_fail(check_hertz, element, poisson, solved=0.42)
    must_fail(check_hertz, element, poisson, radius=150.0)
    must_fail(check_hertz, element, poisson, kinematics=PLANE_STRAIN)


# -- Sneddon, Lee and Radok, layers ----------------------------------------------------------------


def check_punch(fine, within, poisson=0.4999, solved=None, kinematics=AXISYMMETRIC):
    """A sharp punch on a half-space; its pressure has no bound at its edge, only its force is
    asked.
    """
    mesh, body = block("Q2P1", solved or poisson, fine=fine, kinematics=kinematics)
    found = press(body, mesh, Punch(diameter=2.0), depth=1e-3)
    truth = revolution.punch_force(1e-3, 1.0, YOUNG / (1 - poisson**2))
    error = abs(found.force / truth - 1)
    assert error < within, f"truth: force off by {error:.4f}"
    return error


def test_a_punch(must_fail):
    """Sneddon's force, the nearer the finer the mesh."""
    coarse, fine = check_punch(8, 0.03), check_punch(16, 0.015)
    assert np.log2(coarse / fine) > 0.7
    must_fail(check_punch, 16, 0.015, solved=0.45)
    must_fail(check_punch, 16, 0.015, kinematics=PLANE_STRAIN)


def check_cone(poisson=0.4999, solved=None, half_angle=None):
    """A flat cone (Sneddon's theory is of small slopes), its tip a thousandth of the contact."""
    angle = np.radians(89.0) - 1e-3
    depth = 0.5 * np.pi / np.tan(angle)
    mesh, body = block("Q2P1", solved or poisson, fine=24)
    found = press(body, mesh, Cone(half_angle=half_angle or angle, radius=0.05), depth=depth)
    truth = revolution.cone_force(depth, angle, YOUNG / (1 - poisson**2))
    assert abs(found.half_width - 1) < 0.02, f"truth: contact radius {found.half_width:.4f}"
    assert abs(found.force / truth - 1) < 0.01, f"truth: force {found.force / truth:.4f}"


def test_a_cone(must_fail):
    check_cone()
    must_fail(check_cone, solved=0.45)
    must_fail(check_cone, half_angle=np.radians(88.5))


def check_creep(prony=MAXWELL, share=0.5):
    """A ramp of half a second and a hold: radius of the contact while it grows."""
    shear, force, radius = YOUNG / 3, 7.0, 200.0
    mesh, body = block("Q2P1", 0.4999, fine=24, prony=prony)
    steps = [*np.linspace(0, 0.5, 11)[1:], *(0.5 + 4 * np.linspace(0, 1, 13)[1:] ** 2)]
    loads = np.minimum(np.array(steps) / 0.5, 1.0) * force
    goals = [
        Step(0, time, time - before, force=load)
        for time, before, load in zip(steps, [0.0, *steps], loads, strict=False)
    ]
    records = walk(body, mesh, goals, Cylinder(curvature=1 / radius)).records
    found = np.array([record.edges[1] for record in records])
    truth = revolution.sphere_creep(steps, force, radius, shear / 0.5, share, 1.0, 0.5)
    error = np.abs(found / truth - 1)[4:].max()
    assert error < 0.012, f"truth: contact radius off by {error:.4f}"


def test_a_viscoelastic_sphere(must_fail):
    """Lee and Radok's contact, on the ramp and after."""
    check_creep()
    must_fail(check_creep, prony=None)
    must_fail(check_creep, share=0.45)


def check_layer(poisson, shape, *, solved=None, thickness=1.0, within=0.006):
    """A bonded layer as thick as the contact's radius, thirty times as wide."""
    layer = [Layer(1.0, YOUNG / (2 * (1 + poisson)), poisson)]
    columns = graded(2.0 / 15.0, 32 if shape == "sphere" else 64, 16)
    mesh = rectangle(columns, 12, 15.0, thickness, "quad9", origin=(0.0, 0.0))
    held = {"left": 0, "bottom": (0, 1)}
    body = turned(mesh, solved or poisson, held, "Q2P1")
    if shape == "sphere":
        truth = layered_round.press(layer, 1.0, lambda r: r**2 / 400)
        found = press(body, mesh, Cylinder(curvature=1 / 200), force=truth.force)
        assert abs(found.half_width - 1) < 2 * within, f"truth: radius {found.half_width:.4f}"
    else:
        truth = layered_round.press(layer, 1.0, lambda r: 0 * r, 1e-3)
        found = press(body, mesh, Punch(diameter=2.0), depth=1e-3)
        within = 2 * within
    assert abs(found.depth / truth.depth - 1) < within, f"truth: {found.depth / truth.depth:.4f}"
    assert abs(found.force / truth.force - 1) < within, f"truth: {found.force / truth.force:.4f}"


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("shape", ["sphere", "punch"])
def test_a_bonded_layer(shape, poisson, must_fail):
    """Under a sphere and under a punch, at nu 0.3 and 0.4999."""
    check_layer(poisson, shape)
    must_fail(check_layer, poisson, shape, solved=0.28)
    must_fail(check_layer, poisson, shape, thickness=1.1)


def check_reference(radius=1.0):
    half_space = [Layer(np.inf, YOUNG / 2.6, 0.3)]
    modulus = YOUNG / (1 - 0.3**2)
    sphere = layered_round.press(half_space, radius, lambda r: r**2 / 400)
    close(sphere.force, revolution.sphere_force(1 / 200, 200.0, modulus), "Hertz", rtol=1e-9)
    r = np.linspace(0, 0.9, 10)
    close(sphere.pressure(r), revolution.sphere_pressure(r, sphere.force, 1.0), rtol=1e-9)
    punch = layered_round.press(half_space, radius, lambda r: 0 * r, 1e-3)
    close(punch.force, revolution.punch_force(1e-3, 1.0, modulus), "Sneddon", rtol=1e-9)
    close(punch.pressure(r), revolution.punch_pressure(r, punch.force, 1.0), rtol=1e-9)
    thin = layered_round.press([Layer(0.05, YOUNG / 3, 0.5)], radius, lambda r: r**2 / 400)
    close(thin.depth, 1 / 800, "a thin layer keeps its volume", rtol=0.15)


def test_the_layers_have_the_closed_forms_as_limits(must_fail):
    check_reference()
    must_fail(check_reference, radius=1.01)


def test_a_mesh_beyond_the_axis_is_refused():
    mesh = rectangle(4, 2, 2.0, 1.0, origin=(-1.0, 0.0))
    with pytest.raises(ValueError, match="axis"):
        turned(mesh, 0.3, {"bottom": 1}, "Q2P1")


def test_a_law_of_plane_strain_alone_is_refused():
    """One with I2 = I1 - 1 + J^2 in its formulas, as Mooney and Rivlin's in plane strain."""
    plane = replace(NEO_HOOKE, name="plane", stress=lambda i1, j, mu, c: (mu, 0.5 * i1))
    mesh = rectangle(2, 2)
    space = Space(
        mesh.points, mesh.cells, mesh.element, np.zeros((25, 2), bool), None, AXISYMMETRIC
    )
    laws = (Assigned(plane, np.zeros((4, 0)), np.ones(4, bool)),)
    with pytest.raises(ValueError, match="law plane"):
        FiniteStrainBody(space, np.ones(4), np.ones(4), laws=laws)
