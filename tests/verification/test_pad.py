"""Identities of the pad that need no published number: separability, symmetry, energy, scaling,
limit.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pads import LOAD, SHAPES, THESIS, pad_body, pad_mesh, press_pad, ramp_and_hold
from pressing import TIGHT, over_skin, skin_of, walk
from problems import close, two_numbers

from fingerpad.mechanics.stepping import NewtonSettings, QuasiStatic, Step
from fingerpad.reference_solutions import ting
from fingerpad.stimuli.shapes import Cylinder

BOTH_SHAPES = pytest.mark.parametrize("shape", SHAPES)
COUNT = 16


@cache
def half_mesh():
    """Right half of the small pad."""
    return pad_mesh().right_half()


@pytest.fixture(scope="module")
def half():
    return half_mesh()


@cache
def pressed_half(shape, strain="small", poisson=0.48, **goal):
    """End of an elastic press of the half, once for all tests and mutants."""
    return press_pad(pad_body(half_mesh(), strain, poisson), half_mesh(), shape, **goal)


@cache
def pressed_whole(shape, strain):
    """End of an elastic press of the whole pad."""
    return press_pad(pad_body(pad_mesh(), strain), pad_mesh(), shape, force=LOAD)


# -- separability ----------------------------------------------------------------------------------


def pressed_history(mesh, shape, key, goal, poisson, prony, count=COUNT):
    """Times (2 count,) and the state over the skin after each step of a ramp and hold, small
    strain.
    """
    steps = ramp_and_hold(key, goal, count)
    body = pad_body(mesh, "small", poisson, prony)
    records = walk(body, mesh, steps, SHAPES[shape], curve="skin").records
    skin = skin_of(mesh, "skin")
    return np.array([step.time for step in steps]), [
        over_skin(body, skin, records, r) for r in records
    ]


def force_deviation(mesh, shape, poisson=0.4999, prony=THESIS):
    """Depth control: largest deviation of the force from the hereditary integral of the elastic
    forces.
    """
    times, ends = pressed_history(mesh, shape, "depth", 0.4e-3, poisson, prony)
    ramp = [pressed_half(shape, poisson=poisson, depth=end.depth).force for end in ends[:COUNT]]
    elastic = np.concatenate([[0.0], ramp, np.full(COUNT, ramp[-1])]) / THESIS.g_infinity
    truth = ting.force_under_depth_control(np.append(0.0, times), elastic, THESIS.g, THESIS.tau)[1:]
    return np.abs(np.array([end.force for end in ends]) / truth - 1)[COUNT // 4 :].max()


def depth_deviation(mesh, shape, poisson=0.4999, prony=THESIS):
    """Force control: largest deviations of depth and width from the elastic ones at the creep
    integral.
    """
    times, ends = pressed_history(mesh, shape, "force", LOAD / 2, poisson, prony)
    applied = LOAD * np.minimum(np.append(0.0, times) / 0.5, 1.0)
    elastic = THESIS.g_infinity * ting.elastic_force_under_force_control(
        np.append(0.0, times), applied, THESIS.g, THESIS.tau
    )
    worst = np.zeros(2)
    for k in (COUNT // 2, COUNT - 1, 3 * COUNT // 2, 2 * COUNT - 1):
        truth = pressed_half(shape, poisson=poisson, force=elastic[k + 1])
        found = ends[k]
        worst = np.maximum(
            worst, np.abs([found.depth / truth.depth - 1, found.half_width / truth.half_width - 1])
        )
    return worst


def check_separability(mesh, shape, **mutant):
    force = force_deviation(mesh, shape, **mutant)
    assert force < 0.005, f"truth: the force deviates by {force:.4f} from the hereditary integral"
    depth, width = depth_deviation(mesh, shape, **mutant)
    assert depth < 0.005, f"truth: the depth deviates by {depth:.4f} from the elastic one"
    assert width < 0.04, f"truth: the width deviates by {width:.4f} from the elastic one"


@BOTH_SHAPES
def test_layered_pad_separates(half, shape, must_fail):
    """With nu near 0.5 and one Prony series a ramp and hold follows from one elastic curve (Ting
    1966).
    """
    check_separability(half, shape)
    must_fail(check_separability, half, shape, prony=None)


SEPARATION_AT_048 = {"flat": (0.0399809, 0.0351407), "cylinder": (0.0384488, 0.0345554)}


@BOTH_SHAPES
def test_separability_at_the_poisson_ratio_of_the_thesis(half, shape):
    """At nu = 0.48, where the bulk does not relax, force and depth still separate to a few per
    cent.
    """
    force, depth = force_deviation(half, shape, 0.48), depth_deviation(half, shape, 0.48)[0]
    assert max(force, depth) < 0.05
    assert (force, depth) == pytest.approx(SEPARATION_AT_048[shape], rel=1e-3)


# -- symmetry --------------------------------------------------------------------------------------


def check_half_is_full(shape, strain, layers=None):
    """Depth, width, pressures and displacements of the half model unfold to those of the whole
    pad.
    """
    whole, extra = pressed_whole(shape, strain), {} if layers is None else {"layers": layers}
    half = press_pad(pad_body(half_mesh(), strain, **extra), half_mesh(), shape, force=LOAD)
    close(half.depth, whole.depth, "depth", rtol=1e-8)
    close(2 * half.force, whole.force, "force", rtol=1e-8)
    close(2 * half.half_width, np.ptp(whole.edges), "width", rtol=1e-7)
    right = len(whole.pressure) // 2
    top = whole.pressure.max()
    close(half.pressure, whole.pressure[right:], "pressure", atol=1e-7 * top)
    close(whole.pressure, whole.pressure[::-1], "mirror", atol=1e-7 * top)
    assert abs(whole.records[-1].tangential_force) < 1e-8 * LOAD, "truth: no tangential force"


@pytest.mark.parametrize("strain", ["small", "finite"])
@BOTH_SHAPES
def test_half_model_is_the_full_model(shape, strain, must_fail):
    """The half model gives the whole pad's answer to solver tolerance, and symmetric pressure."""
    check_half_is_full(shape, strain)
    must_fail(check_half_is_full, shape, strain, layers=(0.15e6, 0.015e6, 0.0151e6))


# -- energy ----------------------------------------------------------------------------------------


@cache
def ramp_and_hold_records(strain, prony, count):
    body = pad_body(half_mesh(), strain, 0.48, prony)
    return walk(
        body, half_mesh(), ramp_and_hold("force", LOAD / 2, count), SHAPES["flat"], curve="skin"
    ).records


def energy_errors(strain, prony, count, dissipated_share=1.0):
    """Imbalance of work, stored and dissipated energy over the work, after each step of a ramp and
    hold.
    """
    records = ramp_and_hold_records(strain, prony, count)
    return np.array(
        [
            abs(r.work - sum(r.energies[:2]) - dissipated_share * r.dissipated) / r.work
            for r in records
        ]
    )


def check_energy(strain, prony=THESIS, **mutant):
    coarse, fine = (energy_errors(strain, prony, count, **mutant)[-1] for count in (8, 16))
    assert fine < 5e-5, f"truth: {fine:.2e} of the work is lost"
    assert fine < max(0.4 * coarse, 5e-5), (
        f"truth: the imbalance does not vanish: {coarse:.2e} -> {fine:.2e}"
    )


@pytest.mark.parametrize("prony", [None, THESIS], ids=["elastic", "viscoelastic"])
@pytest.mark.parametrize("strain", ["small", "finite"])
def test_energy_balance(strain, prony, must_fail):
    """Work of the indenter = stored + dissipated energy, up to the error in the step of a rule that
    knows the ends.
    """
    check_energy(strain, prony)
    if prony:
        must_fail(check_energy, strain, prony, dissipated_share=0.9)


# -- scaling ---------------------------------------------------------------------------------------


def check_scaling(mesh, strain, length, stress, load_share=1.0):
    """Lengths times ``length`` and stresses times ``stress`` leave every ratio unchanged."""
    scaled = replace(mesh, points=mesh.points * length)
    reference = pressed_half("flat", strain, force=LOAD)
    result = press_pad(
        pad_body(scaled, strain, scale=stress),
        scaled,
        "flat",
        force=load_share * LOAD * stress * length,
    )
    for name, unit in {"depth": length, "half_width": length, "force": stress * length}.items():
        expected = getattr(reference, name) * unit
        close(getattr(result, name), expected, f"{name}", rtol=1e-8)
    np.testing.assert_allclose(
        result.pressure, stress * reference.pressure, atol=1e-7 * result.pressure.max()
    )
    assert result.records[-1].iterations == reference.records[-1].iterations


@pytest.mark.parametrize(
    "length, stress", [(1.0, 37.0), (1e3, 1e-6), (1e6, 1e-3)], ids=["stiffer", "mm N", "um"]
)
@pytest.mark.parametrize("strain", ["small", "finite"])
def test_units_do_not_matter(half, strain, length, stress, must_fail):
    """Moduli and forces times c leave every length; millimetres give what metres give."""
    check_scaling(half, strain, length, stress)
    must_fail(check_scaling, half, strain, length, stress, load_share=1.001)


# -- small strain is the limit of finite strain ----------------------------------------------------


def check_small_is_the_limit(mesh, shape, poisson=0.48):
    """Relative difference of the depths at 1/16, 1/32 and 1/64 of the load."""
    found = []
    for share in (16, 32, 64):
        depths = [
            pressed_half(shape, strain, nu, force=LOAD / share).depth
            for strain, nu in (("small", 0.48), ("finite", poisson))
        ]
        found.append(abs(depths[1] / depths[0] - 1))
    rates = np.log2(np.array(found[:-1]) / found[1:])
    assert found[-1] < 2.5e-3, f"truth: still {found[-1]:.2e} apart"
    assert rates.mean() > 0.9, (
        f"truth: the difference falls with the rates {rates}, not in proportion to the load"
    )
    two_numbers(found[0], truth=LIMIT[shape], within=0.1, frozen=LIMIT[shape], tight=1e-4)


LIMIT = {"flat": 0.0072995662, "cylinder": 0.0063759796}


@BOTH_SHAPES
def test_finite_strain_becomes_small_strain(half, shape, must_fail):
    """As the load goes to zero finite-strain depth joins small-strain depth at first order in the
    load.
    """
    check_small_is_the_limit(half, shape)
    must_fail(check_small_is_the_limit, half, shape, poisson=0.47)


# -- effort ----------------------------------------------------------------------------------------

#: Newton iterations and factorisations of a ramp and hold of 16 steps
EFFORT = {
    ("flat", "small"): (20, 3),
    ("flat", "finite"): (35, 6),
    ("cylinder", "small"): (23, 3),
    ("cylinder", "finite"): (38, 6),
}


@pytest.mark.parametrize("strain", ["small", "finite"])
@BOTH_SHAPES
def test_solver_effort(half, shape, strain):
    """A viscoelastic ramp and hold takes at most 3 iterations a step and no cut, few with factors
    of their own; frozen counts.
    """
    steps = ramp_and_hold("force", LOAD / 2, 8)
    body = pad_body(half, strain, prony=THESIS)
    solver = QuasiStatic(body, skin_of(half, "skin"), SHAPES[shape], NewtonSettings())
    records = solver.run(steps)
    assert len(records) == 16
    assert not any(record.halvings for record in records)
    iterations = sum(record.iterations for record in records)
    assert iterations <= 3 * len(records) and solver.factorisations <= len(records) / 2
    np.testing.assert_allclose((iterations, solver.factorisations), EFFORT[shape, strain], atol=2)


def pressures(shape, settings, of_displacement=False):
    """(ne, nm) moduli times dilatations at the end of a ramp and hold, of the body or as its
    displacement has them.
    """
    body = pad_body(half_mesh(), "finite", 0.4999, THESIS)
    solver = QuasiStatic(body, skin_of(half_mesh(), "skin"), SHAPES[shape], settings)
    solver.run(ramp_and_hold("force", LOAD / 2, 8))
    if of_displacement:
        body.displace(body.u)
    return body.bulk[:, None] * body.dilatation()


def check_pressures(shape, **more):
    truth = pressures(shape, TIGHT)
    error = np.linalg.norm(
        pressures(shape, NewtonSettings(force_tolerance=2e-3), **more) - truth
    ) / np.linalg.norm(truth)
    assert error < 1e-5, f"truth: pressures are off by {error:.2e}"


@BOTH_SHAPES
def test_pressures_are_found_by_equilibrium(shape, must_fail):
    """Loosely converged at nu = 0.4999, on factors of states long past, pressures are right; kappa
    times volume is not.
    """
    check_pressures(shape)
    must_fail(check_pressures, shape, of_displacement=True)


def check_one_step(mesh, shape, poisson, lagged=True):
    body = pad_body(mesh, "finite", poisson)
    body.lagged = lagged
    step = Step(0, 1.0, 1.0, force=LOAD / 2)
    record = walk(body, mesh, [step], SHAPES[shape], NewtonSettings(), "skin").records[-1]
    cost = f"{record.iterations} iterations and {record.halvings} halvings"
    assert record.iterations <= 6 and record.halvings == 0, f"truth: {cost} instead of one step"
    assert record.smallest_jacobian > 0.5
    assert record.complementarity < 1e-3


@pytest.mark.parametrize("poisson", [0.48, 0.4999])
@BOTH_SHAPES
def test_whole_load_in_one_step(half, shape, poisson, must_fail):
    """The full load goes on in one finite-strain step of at most six iterations, at nu = 0.48 and
    0.4999.
    """
    check_one_step(half, shape, poisson)
    if poisson == 0.4999:  # plain Newton needs the load cut to pieces
        must_fail(check_one_step, half, shape, poisson, lagged=False)


class Misjudged(Cylinder):
    """A cylinder that hides its curvature from the tangent."""

    def evaluate(self, points):
        distance, gradient, curvature = super().evaluate(points)
        return distance, gradient, 0 * curvature


def check_quadratic_convergence(mesh, shape=Cylinder):
    settings = replace(TIGHT, force_tolerance=1e-10)
    body, step = pad_body(mesh, "finite"), Step(0, 1.0, 1.0, force=LOAD / 2)
    record = walk(body, mesh, [step], shape(curvature=1260.0), settings, "skin").records[-1]
    assert record.iterations <= 6, (
        f"truth: {record.iterations} iterations are not quadratic convergence"
    )


def test_newton_converges_quadratically_on_a_sharp_cylinder(half, must_fail):
    """With gap curvature in the tangent a force residual of 1e-10 is reached in at most six
    iterations.
    """
    check_quadratic_convergence(half)
    must_fail(check_quadratic_convergence, half, shape=Misjudged)


# -- limits of the Prony series --------------------------------------------------------------------


def check_prony_limit(mesh, strain, held, modulus, prony=THESIS):
    """Force of a pad pressed 0.4 mm at once and held for ``held`` seconds over that of an elastic
    pad.
    """
    poisson = 0.4999
    steps = [Step(0, 0.0, 0.0, depth=0.4e-3), Step(1, held, held, depth=0.4e-3)]
    viscoelastic = walk(pad_body(mesh, strain, poisson, prony), mesh, steps, curve="skin")
    elastic = press_pad(pad_body(mesh, strain, poisson), mesh, "flat", depth=0.4e-3)
    ratio = viscoelastic.force / elastic.force
    assert abs(ratio - modulus) < 2e-3 * modulus, f"truth: {ratio!r} is not {modulus!r}"
    if modulus == 1.0:
        close(viscoelastic.depth, elastic.depth, "depth", rtol=1e-8)
        close(ratio, 1, "exactly the long-term answer", rtol=1e-6)


@pytest.mark.parametrize("strain", ["small", "finite"])
def test_prony_limits(half, strain, must_fail):
    """Held long after 3.25 s the pad is the long-term one, long before 0.34 s the instantaneous
    one.
    """
    check_prony_limit(half, strain, 1e6, 1.0)
    check_prony_limit(half, strain, 1e-4, 1 / 0.5759)
    must_fail(check_prony_limit, half, strain, 3.0, 1.0)
    must_fail(check_prony_limit, half, strain, 1e-4, 1 / 0.5759, prony=None)
