"""The dense contact problem, the condensation it works on and what is read off its forces."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad.mechanics.contact import (
    ContactError,
    Flexibility,
    Rows,
    Zone,
    respond,
    solve_contact,
    stable,
    tangents,
    until_stable,
)
from fingerpad.mechanics.contact_points import ContactPoints
from fingerpad.mechanics.linear_solver import (
    FactorisationError,
    Narrowed,
    PardisoCondensation,
    SuperLUCondensation,
    SymmetricPattern,
    pardiso_available,
)
from fingerpad.mechanics.pressure import contact_edges

pytestmark = pytest.mark.unit


def zone_of(count, equation=None):
    """Nodes that are the points themselves, all free or of these ``equation`` numbers."""
    equation = np.arange(2 * count).reshape(count, 2) if equation is None else equation
    rigid = np.zeros((count, count))
    return Zone(np.arange(count), equation, np.eye(count), rigid, rigid)


def problem(seed, count=12):
    """A random well-posed contact problem: nodes above and below a plate that comes from above."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2 * count, 2 * count))
    schur = root @ root.T + 2 * count * np.eye(2 * count)
    gap = rng.uniform(0, 1e-2, count)
    gap[0] = 0.0
    gradient = np.tile([0.0, -1.0], (count, 1))
    return zone_of(count), schur, np.zeros(2 * count), gap, gradient


def rows_of(zone, gap, gradient, curvature=0.0, partner=-1):
    """Constraints of all points of a zone, one each unless there is a ``partner``."""
    fill = np.zeros(len(gap))
    return Rows(
        zone, slice(0, len(gap)), (fill + partner).astype(int), gap, gradient, fill + curvature
    )


def solve(parts, active=None, curvature=0.0, previous=0.0, **control):
    zone, schur, right, gap, gradient = parts
    rows, zero = rows_of(zone, gap, gradient, curvature), np.zeros(len(gap))
    active = zero.astype(bool) if active is None else active
    return solve_contact(rows, schur, right, zero + previous, active, **control)


def check_laws(parts, step, total, coefficient=0.0, motion=0.0):
    """Every condition of equilibrium, contact and friction at every point; returns normal forces,
    friction and slip.
    """
    zone, schur, right, gap, gradient = parts
    tangent, du, f = tangents(gradient), step.condensed_displacement, step.force
    tau = np.zeros(len(gap)) if step.tangential is None else step.tangential
    normal, along = (
        zone.gather(way) @ du + way[:, 1] * step.depth_change for way in (gradient, tangent)
    )
    opening, slip = gap + normal, np.sum(motion * tangent, axis=1) + along
    forces = zone.gather(gradient).T @ f + zone.gather(tangent).T @ tau
    scale = f.sum()
    np.testing.assert_allclose(schur @ du - right, forces, atol=1e-9 * scale)
    assert -np.sum(f * gradient[:, 1] + tau * tangent[:, 1]) == pytest.approx(total, rel=1e-8)
    assert f.min() >= 0 and opening.min() > -1e-10 and np.abs(opening[step.active]).max() < 1e-10
    assert np.all(f[~step.active] == 0) and np.all(tau[~step.active] == 0)
    assert np.all(np.abs(tau) <= coefficient * f * (1 + 1e-8) + 1e-10 * scale)
    if step.state is not None:
        slides = step.active & (step.state != 0)
        limit = coefficient * f[slides] * step.state[slides]
        np.testing.assert_allclose(tau[slides], limit, atol=1e-10 * scale)
        assert np.all(tau * slip <= 1e-10 * scale), "friction drives"
        assert np.abs(slip[step.active & (step.state == 0)]).max(initial=0.0) < 1e-10
    return f, tau, slip


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-3, 1e3))
def test_force_control_satisfies_every_condition(seed, force):
    """Forces push, closed gaps are closed, open gaps are open, the sum is the load, and equilibrium
    holds.
    """
    parts = problem(seed)
    check_laws(parts, solve(parts, force=force), force)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 2**12 - 1))
def test_solution_does_not_depend_on_the_first_guess(seed, guess):
    """The convex problem has one solution, whatever active set the pivoting starts from."""
    parts = problem(seed)
    active = np.array([guess >> i & 1 for i in range(12)], bool)
    reference, other = solve(parts, force=1.0), solve(parts, force=1.0, active=active)
    np.testing.assert_allclose(other.force, reference.force, atol=1e-9)


def test_depth_control_agrees_with_force_control():
    """Pressing by the depth that a force produced needs that force."""
    parts = problem(3)
    by_force = solve(parts, force=2.0)
    by_depth = solve(parts, depth_change=by_force.depth_change)
    np.testing.assert_allclose(by_depth.force, by_force.force, atol=1e-9)


def test_no_contact_below_first_touch():
    """An indenter that stays above every node carries nothing."""
    parts = problem(5)
    parts[3][:] += 1.0
    step = solve(parts, depth_change=0.5)
    assert not step.active.any() and step.force.sum() == 0


def test_a_node_that_yields_to_nothing_carries_the_force():
    """Alone in contact it stops the plate: the force is found, and there is no stiffness to tell (a
    single node that is held).
    """
    zone, schur, right, gap, gradient = problem(5)
    equation = np.vstack([[-1, -1], np.arange(2 * len(gap) - 2).reshape(-1, 2)])
    zone = zone_of(len(gap), equation)
    gap[1:] += 1.0
    step = solve((zone, schur[2:, 2:], right[2:], gap, gradient), force=3.0)
    assert (
        step.force[0] == pytest.approx(3.0) and not step.force[1:].any() and step.stiffness is None
    )


def test_nothing_can_carry_a_force_sideways():
    """A profile that only meets nodes edge-on cannot take a vertical force, and says so."""
    zone, schur, right, gap, gradient = problem(7)
    gradient = np.tile([1.0, 0.0], (len(gap), 1))
    with pytest.raises(ContactError):
        solve((zone, schur, right, gap, gradient), force=1.0)


@given(seed=st.integers(0, 10_000), size=st.integers(2, 30), share=st.floats(0.0, 1.0))
def test_stable_is_positive_definite_where_gaps_stay_closed(seed, size, share):
    """Against the smallest eigenvalue of the matrix on the null space of the active gradients."""
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((size, size))
    matrix = matrix @ matrix.T - share * size * np.diag(rng.random(size))
    gradient = rng.standard_normal((size // 2, size))
    active = rng.random(size // 2) < 0.7
    compliance = gradient @ np.linalg.solve(matrix, gradient.T)
    free = np.linalg.svd(gradient[active])[2][active.sum() :].T
    lowest = np.linalg.eigvalsh(free.T @ matrix @ free)[0]
    assert stable(matrix, compliance, active) == (lowest > 0)


@pytest.mark.parametrize("definite", [True, False])
def test_response_is_that_of_the_bent_matrix(definite):
    """Against dense algebra: points between nodes, one of which is held, along two directions and
    with softness.
    """
    rng = np.random.default_rng(4)
    equation = np.arange(12).reshape(6, 2)
    equation[2] = -1
    equation[3:] -= 2
    soft = rng.normal(size=(9, 9))
    zone = Zone(
        np.arange(6),
        equation,
        rng.normal(size=(9, 6)) * (rng.random((9, 6)) < 0.5),
        soft + soft.T,
        soft @ soft.T,
    )
    angle, bent, right = (
        rng.uniform(-1, 1, 9),
        rng.uniform(0, 0.5, 9) * (rng.random(9) < 0.5),
        rng.normal(size=10),
    )
    normal, tangent = (
        np.column_stack([np.sin(angle), -np.cos(angle)]),
        np.column_stack([np.cos(angle), np.sin(angle)]),
    )
    free = np.delete(np.arange(12), [4, 5])
    turned = [
        (zone.shape[:, :, None] * direction[:, None]).reshape(9, 12)[:, free]
        for direction in (normal, tangent)
    ]
    root = rng.normal(size=(10, 10))
    schur = root @ root.T + (20.0 if definite else -2.0) * np.eye(10)
    flexible = Flexibility.of(rows_of(zone, bent, normal, bent), schur, np.ones(9))
    answer = respond(zone, flexible, right, [normal, tangent])
    matrix = schur - turned[1].T @ (bent[:, None] * turned[1])
    border, stacked = -turned[1].T @ (bent * tangent[:, 1]), np.concatenate(turned)
    inverse = np.linalg.inv(matrix)
    compliance = stacked @ inverse @ stacked.T
    compliance[:9, :9] += zone.softness
    compliance[9:, 9:] += zone.softness_along
    assert flexible.definite == definite == (np.linalg.eigvalsh(matrix)[0] > 0)
    np.testing.assert_allclose(flexible.matrix, matrix, atol=1e-12)
    np.testing.assert_allclose(answer.compliance, compliance, atol=1e-9)
    np.testing.assert_allclose(answer.free, stacked @ inverse @ right, atol=1e-9)
    forces = rng.normal(size=18)
    expected = inverse @ (right + stacked.T @ forces - border * 0.7)
    np.testing.assert_allclose(answer.displacement(forces, 0.7), expected, atol=1e-9)


def test_a_flexibility_of_before_is_used_as_long_as_it_leads_to_a_solution():
    """What it cannot solve is tried with the flexibility of now, and only what that cannot solve is
    softened.
    """
    zone, schur, _, gap, gradient = problem(9)
    flat, carried = problem(9), np.full(12, 0.01)
    gentle, now = (rows_of(zone, gap, gradient, bend) for bend in (10.0, 50.0))
    before, tried = Flexibility.of(gentle, schur, carried), []

    def found(fails):
        def attempt(flexible):
            tried.append(flexible)
            if len(tried) <= fails:
                raise ContactError("as asked")
            return solve(flat, force=1.0)

        tried.clear()
        return until_stable(attempt, now, schur, carried, before)

    assert not found(0).softened and tried == [before]
    assert (
        not found(1).softened
        and tried[0] is before
        and np.array_equal(tried[1].matrix, Flexibility.of(now, schur, carried).matrix)
    )
    assert found(2).softened and not np.array_equal(tried[1].matrix, tried[2].matrix)


def test_curvature_enters_the_tangent():
    """With a curved profile the solution is that of the Lagrangian's second derivative, and differs
    without it.
    """
    parts = problem(9)
    zone, schur, _, gap, gradient = parts
    previous = np.zeros(12)
    previous[0] = 0.3
    tilt = np.array([0.6, -0.8])
    gradient = np.tile(tilt, (12, 1))
    parts = (zone, schur, np.zeros(24), gap, gradient)
    step = solve(parts, force=1.0, previous=previous, curvature=50.0)
    tangent = np.array([0.8, 0.6])
    matrix = schur.copy()
    matrix[:2, :2] -= 15.0 * np.outer(tangent, tangent)
    border = np.zeros(24)
    border[:2] = -15.0 * tangent * tangent[1]
    right = zone.gather(gradient).T @ step.force - border * step.depth_change
    np.testing.assert_allclose(matrix @ step.condensed_displacement, right, atol=1e-8)
    plain = solve(parts, force=1.0)
    assert np.abs(plain.condensed_displacement - step.condensed_displacement).max() > 1e-4


# -- condensation ----------------------------------------------------------------------------------


def system(seed, definite):
    rng = np.random.default_rng(seed)
    elements, nd, size = 60, 8, 150
    dofs = np.array([rng.choice(size, nd, replace=False) for _ in range(elements)])
    dofs.reshape(-1)[:size] = np.arange(size)
    pattern, dense = SymmetricPattern(dofs, np.arange(size)[:, None]), np.zeros((size, size))
    data = pattern.new_data()
    rows, cols = np.triu_indices(nd)
    for e in range(elements):
        root = rng.normal(size=(nd, nd))
        k = root @ root.T + np.eye(nd) if definite else root + root.T
        np.add.at(data, pattern.scatter[e], k[rows, cols])
        dense[np.ix_(dofs[e], dofs[e])] += k
    return pattern, data, dense, rng


@pytest.mark.parametrize("definite", [True, False], ids=["definite", "indefinite"])
@pytest.mark.parametrize("kind", [PardisoCondensation, SuperLUCondensation])
@pytest.mark.parametrize("condensed", [0, 1, 20])
def test_condensation_equals_dense_algebra(kind, definite, condensed):
    """Schur complement, reduced right-hand side and back-substitution are those of the full system,
    for both solvers.
    """
    if kind is PardisoCondensation and not pardiso_available():
        pytest.skip("PARDISO is not installed here")
    pattern, data, dense, rng = system(11, definite)
    c = np.sort(rng.choice(pattern.size, condensed, replace=False))
    solver = kind(pattern, c)
    check_condensed(solver, solver.factor(data), c, dense, rng.normal(size=pattern.size))


def check_condensed(solver, schur, condensed, dense, right):
    """Schur complement, reduced right-hand side and back-substitution."""
    rest = np.setdiff1d(np.arange(len(dense)), condensed)
    inner = np.linalg.solve(dense[np.ix_(rest, rest)], dense[np.ix_(rest, condensed)])
    expected = dense[np.ix_(condensed, condensed)] - dense[np.ix_(condensed, rest)] @ inner
    np.testing.assert_allclose(schur, expected, atol=1e-8 * (1 + np.abs(expected).max(initial=0)))
    reduced = solver.forward(right)
    values = np.linalg.solve(schur, reduced) if len(condensed) else np.zeros(0)
    truth = np.linalg.solve(dense, right)
    np.testing.assert_allclose(solver.backward(values), truth, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("kept", [1, 7, 20])
def test_a_condensation_taken_further_equals_dense_algebra(kept):
    """Some of what is condensed onto is eliminated again, chosen after the factorisation."""
    pattern, data, dense, rng = system(11, True)
    c = np.sort(rng.choice(pattern.size, 20, replace=False))
    some = np.sort(rng.choice(c, kept, replace=False))
    solver = SuperLUCondensation(pattern, c)
    narrowed = Narrowed(solver, some)
    assert narrowed.take(solver.factor(data))
    check_condensed(narrowed, narrowed.schur, some, dense, rng.normal(size=pattern.size))


def test_what_is_not_stable_by_itself_is_not_eliminated():
    """Whoever solves for contact would take a body for stable that is not."""
    pattern, *_ = system(1, True)
    narrowed = Narrowed(SuperLUCondensation(pattern, np.arange(4)), np.array([0, 1]))
    schur = np.diag([1.0, 1.0, 1.0, -1.0])
    assert not narrowed.take(schur) and narrowed.take(abs(schur))
    assert np.array_equal(narrowed.schur, np.eye(2))


def test_part_of_a_zone_is_the_zone_of_its_points():
    """Points of three edges of which the middle one is kept: its nodes, their equations, what they
    are worth at its points.
    """
    values = np.array([[0.75, 0.25], [0.25, 0.75]])
    shape = np.zeros((6, 4))
    for edge in range(3):
        shape[2 * edge : 2 * edge + 2, edge : edge + 2] = values
    equation = np.array([[0, 1], [-1, 2], [3, 4], [5, 6]])
    soft = np.arange(36.0).reshape(6, 6)
    whole = Zone(np.array([0, 1, 2, 3]), equation, shape, soft, 2 * soft)
    part, alone = (
        whole.part(slice(2, 4)),
        Zone(np.array([1, 2]), equation, values, soft[2:4, 2:4], 2 * soft[2:4, 2:4]),
    )
    assert (
        len(part) == 2
        and part.nodes.tolist() == [1, 2]
        and part.condensed.tolist() == alone.condensed.tolist() == [2, 3, 4]
    )
    np.testing.assert_array_equal(part.shape, alone.shape)
    np.testing.assert_array_equal(part.softness_along, alone.softness_along)
    directions = np.array([[0.6, -0.8], [0.0, -1.0]])
    np.testing.assert_allclose(part.gather(directions), alone.gather(directions))
    np.testing.assert_allclose(part.spread(directions), alone.spread(directions))
    assert whole.part(slice(0, 6)) is whole


def test_entries_of_elements_go_where_their_equations_meet():
    """Of nodes with both components free, one, or none, in elements of any order; mutant: ranks
    left out of rows.
    """
    rng = np.random.default_rng(5)
    nodes, nen = 30, 4
    cells = np.array([rng.choice(nodes, nen, replace=False) for _ in range(25)])
    cells.reshape(-1)[:nodes] = rng.permutation(nodes)
    equation = np.full((nodes, 2), -1)
    free = rng.random(equation.shape) < 0.7
    equation[free] = np.arange(free.sum())
    pattern, dense = SymmetricPattern(cells, equation), np.zeros((free.sum(), free.sum()))
    data = pattern.new_data()
    for e, cell in enumerate(cells):
        k = rng.normal(size=(2 * nen, 2 * nen))
        np.add.at(data, pattern.scatter[e], (k + k.T)[np.triu_indices(2 * nen)])
        at = np.concatenate([equation[cell, 0], equation[cell, 1]])
        known = at >= 0
        dense[np.ix_(at[known], at[known])] += (k + k.T)[np.ix_(known, known)]
    np.testing.assert_allclose(pattern.matrix(data).toarray(), dense, atol=1e-12)
    rows = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
    assert (np.diff(rows * pattern.size + pattern.indices) > 0).all() and (
        pattern.indices >= rows
    ).all()
    assert (
        pattern.scatter.flags.c_contiguous and pattern.scatter.dtype == np.int32
    )  # what the loops are compiled for


def test_node_without_element_is_named():
    """An equation that no element touches is an error, not a singular matrix later."""
    with pytest.raises(FactorisationError, match="no element"):
        SymmetricPattern(np.array([[0, 1, 2, 3]]), np.arange(5)[:, None])


def test_condensed_equations_must_ascend():
    if not pardiso_available():
        pytest.skip("PARDISO is not installed here")
    pattern, *_ = system(1, True)
    with pytest.raises(ValueError, match="ascending"):
        PardisoCondensation(pattern, np.array([5, 2]))


# -- pressure --------------------------------------------------------------------------------------


def arc(order, count=6, radius=2.0):
    """Nodes and edges of a convex arc from left to right, the body below."""
    angle = np.linspace(2.2, 0.9, order * count + 1)
    points = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    starts = np.arange(0, order * count, order)
    edges = np.column_stack([starts, starts + order, *([starts + 1] if order == 2 else [])])
    return points, edges


# -- points of the skin ----------------------------------------------------------------------------


def points_on_arc(order, shear=1.0):
    points, edges = arc(order)
    return points, ContactPoints.on(
        points, np.arange(len(points)), edges, np.full(len(edges), shear)
    )


def test_softness_minds_differences_of_pressure_only():
    """An even pressure is not softened; energy is not negative; softness is edge cubed over the
    shear modulus.
    """
    _, places = points_on_arc(2, shear=2.0)
    soft, length = places.soft(slice(None)), places.weight * 2 * places.spacing

    def check(law):
        np.testing.assert_allclose(law @ (5.0 * length), 0, atol=1e-12 * np.abs(law).max())

    check(soft)
    with pytest.raises(AssertionError):
        check(soft + np.diag(np.diag(soft)))
    assert (
        np.allclose(soft, soft.T) and np.linalg.eigvalsh(soft).min() > -1e-12 * np.abs(soft).max()
    )
    np.testing.assert_allclose(2 * places.softness, points_on_arc(2)[1].softness)
    np.testing.assert_allclose(places.softness, 0.01 * (4 * places.spacing) ** 3 / 6)


def test_pressure_of_a_wave_is_softened_as_said():
    """gap - d/ds (softness dp/ds): for p = cos(k s) on even skin the softness makes k^2 softness p
    of it, in the middle.
    """
    x = np.linspace(0, 1, 201)
    edges = np.stack([np.arange(0, 200, 2), np.arange(2, 201, 2), np.arange(1, 200, 2)], 1)
    places = ContactPoints.on(np.stack([x, 0 * x], 1), np.arange(201), edges, np.ones(100))
    s, k = places.at(np.stack([x, 0 * x], 1))[:, 0], 4 * np.pi
    length = places.weight * 2 * places.spacing
    found = places.soft(slice(None)) @ (np.cos(k * s) * length)
    mean = found.reshape(-1, 4)[1:-1] @ places.weight[:4] / 2
    expected = (
        k**2 * places.softness[0] * np.cos(k * s).reshape(-1, 4)[1:-1] @ places.weight[:4] / 2
    )
    np.testing.assert_allclose(mean, expected, atol=0.01 * np.abs(expected).max())


def test_zones_are_whole_edges():
    """Any range of points is that of whole edges, and their shape functions add up to one."""
    points, places = points_on_arc(2)
    assert places.whole(5, 9) == slice(4, 12) and places.whole(-3, 10**6) == slice(0, len(places))
    nodes, shape = places.shape(slice(4, 12))
    np.testing.assert_allclose(shape.sum(axis=1), 1.0)
    np.testing.assert_allclose(shape @ points[nodes], places.at(points, slice(4, 12)))


def hertz(half_width, spacing=0.025):
    x = np.arange(-40, 41) * spacing
    return x, np.sqrt(np.maximum(half_width**2 - x**2, 0)), np.full(len(x), spacing)


@pytest.mark.parametrize("half_width", [0.31, 0.33, 0.349, 0.37])
def test_contact_edge_lies_between_points(half_width):
    """The edge of a Hertz contact is found: the squares of its pressure are a parabola."""
    left, right = contact_edges(*hertz(half_width))
    assert right == pytest.approx(half_width, abs=1e-9) and left == pytest.approx(
        -half_width, abs=1e-9
    )


def test_contact_edge_moves_evenly():
    """Of a pressure that is no such parabola the edge moves on without stairs while points join one
    by one.
    """
    widths = np.linspace(0.5, 0.6, 81)

    def check(edge):
        found = []
        for half_width in widths:
            x, pressure, spacing = hertz(half_width)
            found.append(edge(x, pressure * (1 + 0.3 * (x / half_width) ** 2), spacing))
        even = np.polyval(np.polyfit(widths, found, 1), widths)
        assert np.abs(found - even).max() < 0.05 * 0.025

    check(lambda *known: contact_edges(*known)[1])
    with pytest.raises(AssertionError):
        check(lambda x, pressure, _: x[pressure > 0][-1])


def test_contact_under_an_edge_ends_beyond_the_last_point():
    """Pressure that rises to the edge, and contacts of a point or two: half a spacing beyond the
    last of them.
    """
    x = np.arange(-40, 41) * 0.025
    inside = np.abs(x) < 0.51
    pressure = np.where(inside, 1 / np.sqrt(np.where(inside, 0.52**2 - x**2, 1)), 0)
    assert contact_edges(x, pressure, np.full(81, 0.025))[1] == pytest.approx(0.5125)
    assert contact_edges(
        x, np.where(np.abs(x) < 0.03, 1.0, 0.0), np.full(81, 0.025)
    ) == pytest.approx((-0.0375, 0.0375))


def test_edges_of_two_contacts_are_the_outermost():
    """A contact of two patches is as wide as from one's left to the other's right edge, each found
    from its own patch.
    """
    x, one, spacing = hertz(0.2)
    two = np.roll(one, -20) + np.roll(one, 20)
    assert contact_edges(x, two, spacing) == pytest.approx((-0.7, 0.7), abs=1e-9)
    right = x > -1e-9
    assert (
        contact_edges(x[right] + 0.0125, hertz(0.4)[1][right], spacing[right], mirrored=True)[0]
        < -0.35
    )


def test_no_contact_has_no_edges():
    assert np.isnan(contact_edges(np.arange(5.0), np.zeros(5), np.ones(5))).all()
