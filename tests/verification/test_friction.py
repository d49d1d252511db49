"""Coulomb friction: partial slip, lift-off with slip and stick, an incline, a sticking punch, and
the identities of a stroke.

Every check is run with the coefficient set to zero, too, and has to fail then.
"""

from dataclasses import replace

import numpy as np
import pytest
from meshes import mapped, nodes_of, rectangle
from pads import LOAD, THESIS, pad_body, pad_mesh
from pressing import TIGHT, press, skin_of
from problems import boundary, close, lame_constants, make_body, two_numbers
from sliding import block, drag_to, dragged, slide, stroke

from fingerpad.mechanics.space import edge_load_vectors
from fingerpad.mechanics.stepping import QuasiStatic, Step
from fingerpad.reference_solutions import cattaneo_mindlin, friction_plate, hertz, incline, punch
from fingerpad.stimuli.motion import STEADY
from fingerpad.stimuli.shapes import Bar, Cylinder, Flat, Sampled

# -- a cylinder on a half-plane (lengths in half widths of the contact) ----------------------------

DEPTH, RADIUS, SHEAR, POISSON, MU = 100.0, 2000.0, 1.0, 0.4999, 0.3
HERTZ_LOAD = hertz.force(1.0, RADIUS, 2 * SHEAR / (1 - POISSON))
PEAK = hertz.peak_pressure(HERTZ_LOAD, 1.0)


def dragged_cylinder(shares, friction=MU, poisson=POISSON, back=()):
    """States of a pressed cylinder dragged until Q/(mu P) is each of ``shares`` and then each of
    ``back``.

    It is pressed with friction, too: on an incompressible half-plane a pressure moves no point of
    the surface sideways.
    """
    mesh, body = block(DEPTH, DEPTH, poisson, SHEAR)
    skin = skin_of(mesh)
    stepper = QuasiStatic(
        body, skin, Cylinder(curvature=1 / RADIUS), TIGHT, friction=friction or None
    )
    record = stepper.run([Step(0, 1.0, 1.0, force=HERTZ_LOAD)])[-1]
    limit = MU * HERTZ_LOAD
    records = drag_to(stepper, record, [share * limit for share in shares], 5e-6)
    records += drag_to(stepper, records[-1], [share * limit for share in back], -5e-6)
    return [dragged(body, skin, record) for record in records]


def pressed_block(steps, friction=MU):
    """States of the same half-plane under the same cylinder after each step of a schedule."""
    mesh, body = block(DEPTH, DEPTH, POISSON, SHEAR)
    return stroke(body, mesh, steps, Cylinder(curvature=1 / RADIUS), friction or None)


def check_traction(state, truth, most, mean):
    """Off by at most ``most`` of mu p0 (next to a kink), and by ``mean`` in the mean."""
    error = (state.traction - truth)[np.abs(state.x) < 0.9] / (MU * PEAK)
    worst, typical = np.abs(error).max(), np.std(error)
    assert worst < most and typical < mean, (
        f"truth: the traction is off by {worst:.4f} of mu p0, by {typical:.4f} in the mean"
    )


def stick_half_width(state, friction=MU):
    """Half width of the stick zone, where (mu p - q)^2 is proportional to c^2 - x^2; zero if
    nothing sticks.
    """
    if state.stick.sum() < 3:
        return 0.0
    x = state.x[state.stick]
    inner = np.abs(x - x.mean()) < 0.8 * np.ptp(x) / 2
    slack = (friction * state.pressure - state.traction)[state.stick]
    slope, top = np.polyfit((x - x.mean())[inner] ** 2, slack[inner] ** 2, 1)
    return np.sqrt(-top / slope)


def check_partial_slip(share, **mutant):
    state = dragged_cylinder([share], **mutant)[0]
    q = state.record.tangential_force
    assert abs(q - share * MU * HERTZ_LOAD) < 1e-4 * q, (
        f"truth: {share} of mu P cannot be reached: {q!r}"
    )
    ratio = cattaneo_mindlin.stick_ratio(share, 1.0, 1.0)
    truth = cattaneo_mindlin.traction(state.x, 1.0, PEAK, MU, ratio)
    check_traction(state, truth, 0.08, 0.012)
    ends = np.abs(state.x[state.stick])[[0, -1]]
    assert np.all(np.abs(ends - ratio) < 0.04), f"truth: {ends} stick, not {ratio:.4f}"
    centre = np.argmin(np.abs(state.x))
    frozen = PARTIAL_SLIP[share]
    two_numbers(stick_half_width(state), truth=ratio, within=0.01, frozen=frozen[0], tight=2e-5)
    two_numbers(
        state.traction[centre] / (MU * PEAK),
        truth=1 - ratio,
        within=0.02,
        frozen=frozen[1],
        tight=2e-5,
    )
    two_numbers(state.record.distance, truth=frozen[2], within=0.1, frozen=frozen[2], tight=2e-5)


#: half width of stick, traction at the centre over mu p0, distance
PARTIAL_SLIP = {
    0.25: (0.86590878, 0.13393918, 9.900006e-05),
    0.5: (0.70696939, 0.29287449, 0.00020119344),
    0.75: (0.50014951, 0.49981618, 3.0827986e-04),
    0.9: (0.31458391, 0.68336534, 0.00037690303),
}


@pytest.mark.parametrize("share", PARTIAL_SLIP)
def test_partial_slip_of_a_cylinder(share, must_fail):
    """Under Q < mu P the middle sticks and the edges slip (Cattaneo 1938, Mindlin 1949)."""
    check_partial_slip(share)
    must_fail(check_partial_slip, share, friction=0.0)
    must_fail(check_partial_slip, share, friction=0.9 * MU)


def check_return(turn=0.75, back=(0.4, 0.0, -0.4), **mutant):
    states = dragged_cylinder([turn], back=back, **mutant)
    limit = MU * HERTZ_LOAD
    for share, state in zip(back, states[1:], strict=True):
        q = state.record.tangential_force
        assert abs(q - share * limit) < 1e-4 * limit, (
            f"truth: the way back ends at {q / limit:.4f} of mu P"
        )
        truth = cattaneo_mindlin.returned_traction(
            state.x, 1.0, PEAK, MU, turn * limit, share * limit, HERTZ_LOAD
        )
        check_traction(state, truth, 0.1, 0.02)
        centre = np.argmin(np.abs(state.x))
        expected, found = truth[centre] / (MU * PEAK), state.traction[centre] / (MU * PEAK)
        two_numbers(found, truth=float(expected), within=0.02, frozen=RETURN[share], tight=2e-5)


RETURN = {0.4: 0.31635699, 0.0: 0.080950873, -0.4: -0.19631497}


def test_partial_slip_on_the_way_back(must_fail):
    """When Q falls again the edges slip backwards and leave locked-in tractions (Mindlin and
    Deresiewicz 1953).
    """
    check_return()
    must_fail(check_return, friction=0.0)
    must_fail(check_return, friction=0.9 * MU)


def check_sliding_cylinder(friction=MU, distance=0.1):
    """Pressed, then slid far enough for everything to slip."""
    *_, state = pressed_block(slide(HERTZ_LOAD, distance, 2), friction)
    assert abs(state.ratio - MU) < 1e-4 * MU, f"truth: F_t/F_n = {state.ratio!r} is not mu"
    assert not state.stick.any(), "truth: all of it slips"
    inside = np.abs(state.x + distance) < 0.85
    error = np.abs(state.traction - MU * hertz.pressure(state.x + distance, 1.0, PEAK))[
        inside
    ].max() / (MU * PEAK)
    assert error < 0.03, f"truth: the traction is off by {error:.4f} of mu p0"
    two_numbers(state.pressed.half_width, truth=1.0, within=0.01, frozen=SLIDING[0])
    two_numbers(state.traction.max() / (MU * PEAK), truth=1.0, within=0.02, frozen=SLIDING[1])


SLIDING = (0.99840387, 0.99994432)


def test_sliding_cylinder(must_fail):
    """In full slip F_t = mu F_n, q = mu p, and p stays Hertz's (McEwen 1949; Johnson 1985, section
    7.1).
    """
    check_sliding_cylinder()
    must_fail(check_sliding_cylinder, friction=0.0)
    must_fail(check_sliding_cylinder, friction=1.01 * MU)


def check_full_stick(friction=100.0):
    """A cylinder that cannot slip, dragged in equal small steps."""
    pressed, *states = pressed_block(slide(HERTZ_LOAD, 4e-5, 4), friction)
    forces = np.array([state.record.tangential_force for state in (pressed, *states)])
    assert forces[-1] > 0.1 * MU * HERTZ_LOAD, (
        f"truth: the skin is dragged along, F_t = {forces[-1]!r}"
    )
    assert not any(state.slip.any() for state in states), "truth: nothing slips"
    close(np.diff(forces), forces[-1] / 4, "F_t grows with the distance", rtol=5e-3)
    for before, after in zip((pressed, *states), states, strict=False):
        moved = (after.moved - before.moved)[
            after.stick & before.stick & (np.abs(after.x) < 0.8)
        ] + 1e-5
        assert np.abs(moved).max() < 1e-9, "truth: the skin goes with the profile"
    x = states[-1].x
    inside = np.abs(x) < 0.8
    truth = punch.pressure(x, 1.0, forces[-1])[inside]
    change = states[-1].traction - pressed.traction
    error = np.abs(change[inside] / truth - 1).max()
    assert error < 0.03, f"truth: the traction is off by {error:.4f}"
    centre = change[np.argmin(np.abs(x))]
    two_numbers(centre, truth=forces[-1] / np.pi, within=0.02, frozen=FULL_STICK[0])
    two_numbers(forces[-1], truth=FULL_STICK[1], within=0.1, frozen=FULL_STICK[1])


FULL_STICK = (1.5217032e-05, 4.8310109e-05)


def test_full_stick(must_fail):
    """With a large coefficient nothing slips and q = Q/(pi sqrt(a^2 - x^2)) (Johnson 1985, section
    7.2).
    """
    check_full_stick()
    must_fail(check_full_stick, friction=0.0)
    must_fail(check_full_stick, friction=0.3)


# -- flat punch ------------------------------------------------------------------------------------

PUNCH_LOAD = 0.01


def check_punch(nominal, poisson=None, friction=100.0, shift=2e-3):
    """A punch with sharp edges that sticks while it is pressed and while it is shifted."""
    poisson = nominal if poisson is None else poisson
    bar, steps = (
        Bar(width=2 * 1.015625),
        slide(PUNCH_LOAD, shift, 1),
    )  # its edges lie between nodes, the last touching ones at 1
    mesh, body = block(DEPTH, DEPTH, poisson, SHEAR)
    free = press(body, mesh, bar, force=PUNCH_LOAD)
    mesh, body = block(DEPTH, DEPTH, poisson, SHEAR)
    pressed, shifted = stroke(body, mesh, steps, bar, friction or None)
    inside, touching = np.abs(pressed.x) < 0.8, np.abs(pressed.x) < 1.01
    change = shifted.record.tangential_force - pressed.record.tangential_force
    assert change > 0.1 * PUNCH_LOAD, f"truth: the punch drags the skin along, F_t = {change!r}"
    assert np.all(pressed.stick == touching) and np.all(shifted.stick == touching), (
        "truth: all of it sticks"
    )
    for state, sideways in ((pressed, 0.0), (shifted, change)):
        p, q = punch.sticking_tractions(state.x[inside], 1.0, PUNCH_LOAD, -sideways, nominal)
        for name, error in (
            ("pressure", state.pressure[inside] - p),
            ("traction", -state.traction[inside] - q),
        ):
            worst = np.abs(error / p).max()
            assert worst < 0.035, f"truth: the {name} is off by {worst:.4f} of the pressure"
    if nominal > 0.49:
        error = np.abs(pressed.pressure[inside] / free.pressure[inside] - 1).max()
        assert error < 0.01, f"truth: stick and slip differ by {error:.4f}"
    centre = np.argmin(np.abs(pressed.x))
    truth = punch.sticking_tractions(0.0, 1.0, PUNCH_LOAD, 0.0, nominal)[0]
    two_numbers(
        pressed.pressure[centre], truth=float(truth), within=0.015, frozen=PUNCH[nominal][0]
    )
    two_numbers(change, truth=PUNCH[nominal][1], within=0.1, frozen=PUNCH[nominal][1])


PUNCH = {0.4999: (0.0031583427, 0.0024155055), 0.3: (0.003285659, 0.0017356935)}


@pytest.mark.parametrize("poisson", PUNCH)
def test_sticking_punch(poisson, must_fail):
    """At nu = 0.5 a flat punch that sticks presses as one that slips; at 0.3 as Muskhelishvili's
    (Johnson 1985, Eq. 2.69).
    """
    check_punch(poisson)
    must_fail(check_punch, poisson, friction=0.0)
    must_fail(check_punch, poisson, poisson=0.0 if poisson == 0.3 else 0.3)


# -- the plate of SSNV128 --------------------------------------------------------------------------


def friction_plate_contact(elements, friction=friction_plate.FRICTION):
    """The plate upside down, under a fixed plane, on a cushion a million times softer that only
    keeps it from floating.
    """
    side, cushion = friction_plate.SIDE, friction_plate.SIDE / 4
    rows = np.append(np.linspace(0, 0.2, 2)[:-1], np.linspace(0.2, 1, elements + 1))
    mesh = rectangle(
        elements,
        rows,
        side,
        side + cushion,
        origin=(0.0, -side - cushion),
        region=lambda c: c[:, 1] < 0.2,
    )
    fixed = boundary(mesh, "bottom")
    fixed[nodes_of(mesh, "right"), 0] = True
    shear, bulk = lame_constants(friction_plate.YOUNGS_MODULUS, friction_plate.POISSON_RATIO)
    stiffness = np.array([1, 1e-6, 1])
    body = make_body(mesh, fixed, shear * stiffness, bulk * stiffness)
    x, y = mesh.points.T
    loaded = np.flatnonzero(np.abs(y + side) < 1e-9 * side)
    loaded = loaded[np.argsort(x[loaded])]
    pushed = np.stack([loaded[:-2:2], loaded[2::2], loaded[1::2]], 1)
    left = mesh.curves["left"]
    left = left[y[left].min(1) > -side * (1 + 1e-9)]
    external = friction_plate.TOP_PRESSURE * edge_load_vectors(mesh.points, pushed)
    external -= friction_plate.SIDE_PRESSURE * edge_load_vectors(mesh.points, left)
    return mesh, stroke(
        body,
        mesh,
        [Step(0, 1.0, 1.0, depth=0.0)],
        Flat(),
        friction or None,
        TIGHT,
        external=external,
    )[-1]


def check_friction_plate(elements=32, **mutant):
    mesh, state = friction_plate_contact(elements, **mutant)
    skin = skin_of(mesh)
    moved = state.record.displacement[skin.nodes, 0]
    place = mesh.points[skin.nodes, 0]
    found = np.interp(friction_plate.POSITIONS, place, moved)
    codes = np.abs(found / friction_plate.MEAN_OF_CODES - 1).max()
    assert codes < 0.05, f"truth: {codes:.3f} away from the mean of the codes"
    for value, converged, frozen in zip(found, friction_plate.CONVERGED, PLATE, strict=True):
        two_numbers(value, truth=converged, within=1e-3, frozen=frozen)
    spacing = friction_plate.SIDE / elements
    touching = place[state.nodal_force > 0]
    assert abs(touching[0] - friction_plate.LIFTED) < spacing, (
        f"truth: lifted off up to {touching[0]}"
    )
    slipping = place[state.slip].max()
    assert abs(slipping - friction_plate.SLIPPING) < spacing, f"truth: slips up to {slipping}"
    load = friction_plate.TOP_PRESSURE * friction_plate.SIDE
    two_numbers(state.record.force, truth=load, within=1e-4, frozen=load, tight=1e-4)


PLATE = (2.8604039e-05, 2.7226725e-05, 2.2867958e-05, 1.9807489e-05, 1.5413947e-05)


def test_friction_plate(must_fail):
    """Lift-off to 3.3 mm, slip to 29 mm, stick beyond, and five sliding displacements (code_aster
    SSNV128).
    """
    check_friction_plate()
    must_fail(check_friction_plate, friction=0.0)
    must_fail(check_friction_plate, friction=0.9)


# -- incline ---------------------------------------------------------------------------------------


def check_incline(nominal, friction=None, slope=0.1):
    """A slope drawn under a stiff block whose face lies flat on it, until all of it slides."""
    friction = nominal if friction is None else friction
    mesh = mapped(
        8, 4, lambda s: np.stack([2 * s[:, 0] - 1, s[:, 1] * (1 - slope * (2 * s[:, 0] - 1))], 1)
    )
    fixed = boundary(mesh, "bottom")
    body = make_body(mesh, fixed, *lame_constants(1e6, 0.3))
    line = Sampled(x=[-5.0, 5.0], y=[5 * slope, -5 * slope])
    start, *_, state = stroke(body, mesh, slide(1.0, 0.1, 3), line, friction or None)
    assert not state.stick.any(), "truth: all of it slides"
    limit = incline.limit_ratio(0.1, nominal)
    two_numbers(state.ratio, truth=float(limit), within=1e-6, frozen=CGS4[nominal], tight=5e-6)
    two_numbers(
        state.record.depth - start.record.depth,
        truth=-0.1 * slope,
        within=1e-3,
        frozen=-0.01,
        tight=1e-3,
    )


CGS4 = {0.0: 0.1, 0.1: 0.20202, 0.2: 0.306122, 0.3: 0.412371}


@pytest.mark.parametrize("friction", CGS4)
def test_incline(friction, must_fail):
    """Sliding uphill needs F/G = (tan a + mu)/(1 - mu tan a): 0.412371 at mu = 0.3 (NAFEMS
    CGS-4).
    """
    check_incline(friction)
    must_fail(check_incline, friction, slope=0.05)
    if friction:
        must_fail(check_incline, friction, friction=0.0)


# -- strokes of a pad ------------------------------------------------------------------------------

FLAT, ROUND = Flat(), Cylinder(curvature=105.0)
PAD_MU = 0.5


def pad_stroke(steps, profile=FLAT, friction=PAD_MU, strain="finite", mesh=None, **body):
    """A stroke of the small pad; returns every step's state."""
    mesh = mesh or pad_mesh()
    return stroke(
        pad_body(mesh, strain, **body), mesh, steps, profile, friction or None, curve="skin"
    )


def check_full_slip(profile, strain, friction=PAD_MU):
    state = pad_stroke(slide(LOAD / 2, 3e-3, 6), profile, friction, strain)[-1]
    touching = state.nodal_force > 0
    assert touching.sum() > 5 and not state.stick.any(), "truth: all of it slips"
    close(state.drag[touching], PAD_MU * state.nodal_force[touching], "q = mu p", rtol=1e-9)
    if profile is FLAT:
        two_numbers(state.ratio, truth=PAD_MU, within=1e-6, frozen=PAD_MU, tight=1e-6)


@pytest.mark.parametrize("profile", [FLAT, ROUND], ids=["flat", "cylinder"])
@pytest.mark.parametrize("strain", ["small", "finite"])
def test_full_slip_of_a_pad(strain, profile, must_fail):
    """After a few millimetres every node's friction is mu times its normal force, and on a plate
    F_t = mu F_n.
    """
    check_full_slip(profile, strain)
    must_fail(check_full_slip, profile, strain, friction=0.0)


def viscoelastic_stroke(count, distance=3e-3, speed=10e-3, profile=FLAT, steady=(), **more):
    """Pressed in 0.5 s, then slid at 10 mm/s; ``count`` steps each. Then slid to distances (m) of
    ``steady``, very slowly.
    """
    down = slide(LOAD, 0.0, 0, press=count, dt=0.5 / count)
    sizes = distance / speed / count
    along = [
        Step(1, 0.5 + sizes * k, sizes, force=LOAD, distance=distance * k / count)
        for k in range(1, count + 1)
    ]
    slow = [Step(2, along[-1].time, STEADY, force=LOAD, distance=place) for place in steady]
    return pad_stroke(down + along + slow, profile, prony=THESIS, **more)


def check_energy(strain, friction=PAD_MU, frictional_share=1.0):
    errors = []
    for count in (10, 20):
        states = viscoelastic_stroke(count, steady=(3.5e-3, 4e-3), strain=strain, friction=friction)
        *_, end, before, last = (state.record for state in states)
        way = last.distance - before.distance
        truth = PAD_MU * LOAD * way
        close(last.tangential_force * way, truth, "F_t is mu F_n", rtol=1e-6)
        close(last.work - before.work, truth, "work in steady slip", rtol=1e-5)
        close(last.frictional - before.frictional, truth, "what friction takes", rtol=1e-5)
        found = [
            abs(r.work - sum(r.energies[:2]) - r.dissipated - frictional_share * r.frictional)
            / r.work
            for r in (state.record for state in states)
        ]
        errors.append(found[2 * count - 1])
        assert max(found[count:]) < 0.03, (
            f"truth: {max(found[count:]):.2e} of the work is lost on the way"
        )
    coarse, fine = errors
    assert fine < 3e-5, f"truth: {fine:.2e} of the work is lost"
    assert fine < max(0.65 * coarse, 2e-5), (
        f"truth: the imbalance does not vanish: {coarse:.2e} -> {fine:.2e}"
    )
    two_numbers(
        end.frictional, truth=FRICTIONAL[strain], within=0.02, frozen=FRICTIONAL[strain], tight=1e-5
    )


FRICTIONAL = {"small": 0.023967038, "finite": 0.023787169}


@pytest.mark.parametrize("strain", ["small", "finite"])
def test_energy_of_a_stroke(strain, must_fail):
    """Work of both forces = stored + viscous + frictional dissipation; in steady slip friction
    takes F_t times the way.
    """
    check_energy(strain)
    must_fail(check_energy, strain, friction=0.0)
    must_fail(check_energy, strain, frictional_share=0.95)


def check_mirror(profile, friction=PAD_MU, share=-1.0, count=6):
    """A stroke to one side and its mirror image."""
    one = viscoelastic_stroke(count, 1.5e-3, profile=profile)
    other = viscoelastic_stroke(
        count, share * 1.5e-3, speed=share * 10e-3, profile=profile, friction=friction
    )
    assert one[-1].ratio > 0.2, "truth: it is dragged"
    for a, b in zip(one, other, strict=True):
        top = a.pressure.max()
        close(b.record.depth, a.record.depth, "depth", rtol=1e-6)
        close(b.record.tangential_force, -a.record.tangential_force, "force", atol=1e-6 * LOAD)
        close(b.pressure[::-1], a.pressure, "pressure", atol=1e-5 * top)
        close(b.traction[::-1], -a.traction, "traction", atol=1e-5 * top)
        close(b.x[::-1], -a.x, "the skin's place", atol=1e-9)


@pytest.mark.parametrize("profile", [FLAT, ROUND], ids=["flat", "cylinder"])
def test_strokes_left_and_right_mirror(profile, must_fail):
    """A stroke to the left is the mirror image of one to the right, at every step and node."""
    check_mirror(profile)
    must_fail(check_mirror, profile, friction=0.0)
    must_fail(check_mirror, profile, share=-0.98)


def check_units(length, stress, friction=PAD_MU, load_share=1.0):
    """Lengths times ``length`` and stresses times ``stress`` leave every ratio of a stroke
    unchanged.
    """
    mesh = pad_mesh()
    reference = pad_stroke(slide(LOAD, 1e-3, 3, press=2), FLAT)
    scaled = replace(mesh, points=mesh.points * length)
    steps = slide(load_share * LOAD * stress * length, 1e-3 * length, 3, press=2)
    result = pad_stroke(steps, FLAT, friction, mesh=scaled, scale=stress)
    for a, b in zip(reference, result, strict=True):
        expected = a.record.tangential_force * stress * length
        close(b.record.tangential_force, expected, "force", atol=1e-7 * b.record.force)
        close(b.record.depth, a.record.depth * length, "depth", rtol=1e-7)
        close(
            b.record.frictional,
            a.record.frictional * stress * length**2,
            "dissipation",
            rtol=1e-6,
            atol=0,
        )
        close(b.x, a.x * length, "the skin's place", atol=1e-9 * length)
        np.testing.assert_array_equal(b.stick, a.stick, err_msg="truth: stick")


@pytest.mark.parametrize("length, stress", [(1.0, 37.0), (1e3, 1e-6)], ids=["stiffer", "mm N"])
def test_units_of_a_stroke_do_not_matter(length, stress, must_fail):
    """Moduli and forces times c leave every length of a stroke; millimetres give what metres
    give.
    """
    check_units(length, stress)
    must_fail(check_units, length, stress, friction=0.0)
    must_fail(check_units, length, stress, load_share=1.001)


def check_step_size(friction=PAD_MU, distance=3e-3):
    """A cylinder drawn from under the pad, in steps of 0.5, 0.25 and 0.125 mm, compared where all
    of them stand.
    """
    runs = [
        viscoelastic_stroke(count, distance, profile=ROUND, friction=mu)[
            count + stride - 1 :: stride
        ]
        for count, stride, mu in ((6, 1, friction), (12, 2, friction), (24, 4, PAD_MU))
    ]
    assert [len(states) for states in runs] == [6, 6, 6]

    def of(states):
        return np.array(
            [
                [
                    s.record.tangential_force / LOAD,
                    s.record.depth / 0.6e-3,
                    s.pressure.max() / 1e4,
                    np.mean(s.pressed.edges) / 3e-3,
                ]
                for s in states
            ]
        )

    coarse, middle, fine = map(of, runs)
    errors = [np.abs(values - fine).max() for values in (coarse, middle)]
    assert errors[1] < 5e-3, f"truth: steps of 0.25 mm are off by {errors[1]:.4f}"
    assert errors[1] < 0.7 * errors[0], f"truth: the error does not fall: {errors}"
    two_numbers(errors[1], truth=STEP_SIZE, within=0.2, frozen=STEP_SIZE, tight=1e-2)


STEP_SIZE = 7.2059588e-4


def test_step_size_does_not_matter(must_fail):
    """Steps of 0.25 mm give force, depth, pressure and place of contact within 0.5 % of those of
    0.125 mm.
    """
    check_step_size()
    must_fail(check_step_size, friction=0.0)


def check_frictionless_slide(friction=0.0):
    """A plate drawn sideways over a pad at rest."""
    pressed, *states = pad_stroke(slide(LOAD, -2e-3, 3), FLAT, friction)
    for state in states:
        record = state.record
        assert abs(record.tangential_force) < 1e-9 * LOAD, (
            f"truth: F_t = {record.tangential_force!r}"
        )
        error = np.abs(record.displacement - pressed.record.displacement).max()
        assert error < 1e-10, f"truth: the pad moves by {error:.2e} m"
        close(record.nodal_force, pressed.record.nodal_force, "force", atol=1e-6 * LOAD)
        assert record.work == pytest.approx(pressed.record.work, rel=1e-7), "truth: no work"
        assert record.tangential is record.slip is record.state is None, (
            "truth: nothing of friction is recorded"
        )


def test_a_plate_without_friction_slides_unnoticed(must_fail):
    """Without friction the sideways motion of a flat plate changes nothing at all."""
    check_frictionless_slide()
    must_fail(check_frictionless_slide, friction=0.01)
