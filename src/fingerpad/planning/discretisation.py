"""The mesh and the steps: a named preset, the cheapest that meets a tolerance, or by hand; and what
edges of the profile need.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from fingerpad.planning.bounds import PlanError, micrometres, percent
from fingerpad.planning.contact import earliest_half_width
from fingerpad.planning.effect import Case
from fingerpad.planning.errors import THESIS_ROWS, ContactErrors
from fingerpad.planning.rules import Preset
from fingerpad.planning.schedule import leg_durations
from fingerpad.scenes.scene import Discretisation, Scene
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.measures import touched_side
from fingerpad.specimen.pad import MeshSize, PadMesh, all_over, skin_chain
from fingerpad.stimuli.profile import Profile

_THIN = 1e-3  # m, of layers altogether, below which presets are in their size
_FINEST_FOCUS = 14  # halvings of the edge in the contact that are tried
# of the least error there is, by which a tolerance that cannot be met is missed further for less
# work
_NEAR = 0.15
_MOST_COLUMNS = 2000  # of refined elements to either side
_WIDER = 1.2  # than a contact is estimated to be, the mesh is as fine as it is there
_TIP = (0.1, 0.5, 1.0)  # of the radius of a tip on the axis, where the mesh is made for it
_STAGE = 2.0**0.25  # by how much finer a mesh is in a contact, if at all


def preset_for(case: Case, aim: float | None) -> Preset:
    """The discretisation asked for: a named one, the cheapest that meets a tolerance (or ``aim``,
    if that is less), or one by hand.
    """
    scene, rules = case.scene, case.rules
    if isinstance(scene.accuracy, str):
        return _in_size(rules.presets[scene.accuracy], scene)
    if scene.tolerance is not None:
        return _cheapest(case, min(scene.tolerance, aim or 1.0))
    thesis, edge = rules.presets["thesis"], scene.by_hand.skin_edge
    if edge is None:
        return thesis
    half_width = max(case.contact.half_width, 1e-5)
    error = ContactErrors(rules, half_width, turned=scene.axisymmetric).on_built_mesh(edge)
    layer_edge = thesis.layer_edge * (edge / thesis.skin_edge)
    return replace(thesis, skin_edge=edge, layer_edge=layer_edge, tolerance=error)


def _in_size(preset: Preset, scene: Scene) -> Preset:
    """A preset in the size of its specimen: on layers far thinner than a finger's, edges and steps
    are as much shorter.
    """
    stack = scene.specimen.stack
    share = 1.0 if stack is None else min(1.0, sum(stack.thicknesses) / _THIN)
    lengths = ("skin_edge", "layer_edge", "slide_step")
    return replace(preset, **{name: share * getattr(preset, name) for name in lengths})


def _cheapest(case: Case, tolerance: float) -> Preset:
    """Of the measured meshes and steps those of least nodes times steps that meet it or, if none
    does, come near the least error.

    A mesh that suffices for the widest contact measured is refined under a narrower one that stays
    where it is.
    """
    scene, rules, moves = case.scene, case.rules, case.moves
    thesis = rules.presets["thesis"]
    timed = bool(scene.specimen.prony) and any(
        duration is not None for duration in leg_durations(scene)
    )
    half_width = earliest_half_width(case, timed)
    asked = ContactErrors(
        rules, half_width, None, case.stroke, scene.stimulus.irregular, scene.axisymmetric
    )
    known = asked.known
    still = not moves and scene.specimen.mesh is None and _only_inner(scene)
    outer = 1 if _only_inner(scene) else 3  # columns of outer ridges
    found = []
    least_steps = rules.least_steps_stroked if moves else rules.least_steps
    for rows, steps in product(known.mesh, (n for n in known.time if n >= least_steps)):
        edge = known.edge * THESIS_ROWS / rows
        growth = min(thesis.growth ** (THESIS_ROWS / rows), 3.0)
        errors = replace(asked, steps=steps if timed or moves else None)
        for finer in 2 ** np.arange(0, _FINEST_FOCUS, 0.5) if still else (1,):
            # the right half has about 7 columns and 4 rows an element across the epidermis
            more = np.log(finer) / np.log(growth)
            wide = 1.2 * case.reach / edge * (finer - 1)
            if finer > 1 and (edge / finer < rules.least_edge or wide > _MOST_COLUMNS):
                break
            error = errors.on_built_mesh(edge / finer / outer, edge)
            work = (7 * rows + more + wide) * (4 * rows + more) * steps
            found.append((error, work, edge / finer, edge, growth, steps))
    least = min(found)[0]
    enough = tolerance if least <= tolerance else (1 + _NEAR) * least
    _, focus, edge, growth, steps = min(rest for error, *rest in found if error <= enough)
    # so many elements across the epidermis, however thick it is
    outline, layer_edge = scene.specimen.outline, thesis.layer_edge * edge / thesis.skin_edge
    if outline is not None:
        layer_edge = min(layer_edge, outline.epidermis_thickness * edge / known.edge / THESIS_ROWS)
    return Preset(
        edge,
        layer_edge,
        steps,
        growth,
        tolerance,
        slide_step=thesis.slide_step * thesis.steps / steps,
        focus=focus if focus < edge else None,
    )


def element_for(asked: str | None, external: PadMesh | None) -> str:
    """The element to solve with: the one asked for, if the mesh has it or can be raised to it, else
    the mesh's own.

    Raises
    ------
    PlanError
        It does not fit the mesh.
    """
    kind = external.element if external else "quad9"
    fitting = ["Q1P0", "Q2P1"] if kind == "quad4" else [KINDS[kind].solved]
    if asked is None or asked in fitting:
        return asked or fitting[0]
    raise PlanError(
        f"accuracy.element: {asked} does not fit the mesh of {kind}; allowed: "
        f"{' or '.join(fitting)}"
    )


def raised_for(case: Case, error: Callable[[PadMesh], float]) -> tuple[PadMesh, str]:
    """The external mesh, its linear quads raised to quadratic ones where the accuracy needs it, and
    why it was ("": it was not).

    Parameters
    ----------
    error
        Expected of a contact on a mesh.
    """
    external, accuracy, tolerance = case.external, case.scene.accuracy, case.tolerance
    asked = case.scene.by_hand.element
    if external.element != "quad4" or asked not in (None, "Q2P1"):
        return external, ""
    raised, said = external.raised(), "linear quads raised to quadratic ones of the same corners: "
    if asked:
        return raised, said + "asked for in the scene"
    by_hand = isinstance(accuracy, Discretisation) and accuracy.tolerance is None
    if by_hand or error(external) <= tolerance:
        return external, ""
    return raised, (
        f"{said}they would be wrong by {percent(error(external))}, "
        f"{percent(tolerance)} is asked, these by {percent(error(raised))}"
    )


def mesh_size_for(case: Case, preset: Preset, widest: float, friction: float | None) -> MeshSize:
    """The mesh of a preset, refined where the contact or an edge of the profile needs it.

    Parameters
    ----------
    widest
        m, half-width of the widest contact on the way.
    friction
        Coefficient; None where friction is left out.
    """
    scene, profile, contact, rules = case.scene, case.profile, case.contact, case.rules
    offsets = max((abs(x) for x in scene.outputs.receptors.offsets), default=0.0)
    wander = _wander(case, friction) if case.moves else 0.0
    fine = max(rules.fine_half_width, 1.3 * widest, widest + wander, offsets)
    # a contact that moves has the edges of a preset
    chosen, asked = scene.by_hand.skin_edge is None, scene.tolerance is not None
    stroked = chosen and case.moves and not asked
    focus, radial, growth = (), None, preset.growth
    if stroked:
        # the mesh is mostly away from the contact
        growth = max(growth, min(growth**2, rules.stroked_growth))
    if preset.focus is not None:
        radial = preset.focus
        focus = all_over(_WIDER * min(widest, case.reach), radial)
    edges = max(preset.edges if _only_inner(scene) else 0.0, rules.edges_per_half_width)
    narrow = _staged(max(contact.half_width / edges, rules.least_edge), np.floor)
    if profile.edges:
        edge = _edge_size(case, preset)
        places = {abs(x) for x in profile.edges}
        if asked:
            # where the face ends pressure is largest
            places |= {x - profile.edge_radius for x in places}
            radial = min(edge, radial or edge)
        focus += tuple((x, edge) for x in sorted(places))
    elif preset.focus is None and chosen and not case.moves and narrow <= preset.skin_edge / _STAGE:
        # its edge passes from node to node, and the curves of a narrow contact show how far these
        # are apart: along the skin alone
        focus = all_over(_WIDER * _staged(case.reach, np.ceil), narrow)
        rows = max(preset.rows, rules.rows_per_half_width)
        radial = max(narrow, _staged(contact.half_width / rows, np.floor))
    elif stroked and scene.specimen.ridges is None:
        # what is read of a stroke is read there: centre pressure and what it does to receptors
        middle = _WIDER * max(rules.stroked_middle, offsets)
        focus = all_over(middle, rules.stroked_share * preset.skin_edge)
    finest = min([preset.skin_edge, *(edge for _, edge in focus)])
    felt = scene.stimulus.felt(finest)
    tip = tip_edge(case, felt, preset.tolerance) if chosen else np.inf
    if tip < finest:
        focus += at_tip(felt.tip, tip)
        radial = min(tip, radial or preset.layer_edge)
    return MeshSize(
        skin_edge=preset.skin_edge,
        fine_half_width=min(fine, 0.9 * scene.specimen.half_width),
        layer_edge=preset.layer_edge,
        growth=growth,
        focus=focus,
        skin_radial_edge=radial,
    )


def at_tip(tip: float, edge: float) -> tuple[tuple[float, float], ...]:
    """A mesh size's ``focus`` with that ``edge`` (m) over a tip (m) on the axis: beside the axis
    itself, where the edge is that of the contact.
    """
    return tuple((share * tip, edge) for share in _TIP)


def _wander(case: Case, friction: float | None) -> float:
    """How far (m) a stroke takes the contact from the middle of the pad: to where the pad is as
    steep as the surface.
    """
    way = np.abs(np.cumsum([leg.along for leg in case.scene.motion])).max()
    steep = min(case.profile.steepness * case.pad.apex_radius, way)
    return steep + (0.0 if friction is None else case.rules.skin_stretch)


def _staged(length: float, rounded: Callable[[float], float]) -> float:
    """A length (m) rounded to one of four in every octave: contacts of about a size share a mesh,
    of which a sweep has few.
    """
    return float(2.0 ** (rounded(4 * np.log2(length)) / 4))


def _only_inner(scene: Scene) -> bool:
    """Whether edges along the skin are those that are asked for: outer ridges have a third of
    them.
    """
    return scene.specimen.ridges is None or scene.specimen.ridges.outer is None


def _edge_size(case: Case, preset: Preset) -> float:
    """Element edge (m) at the profile's own edges: as presets have it, and finer where a tolerance
    asks for that.
    """
    profile, rules, edge = case.profile, case.rules, preset.skin_edge / 4
    if profile.edge_radius:
        edge = min(edge, profile.edge_radius / 2)
    if case.scene.tolerance is None:
        return edge
    if profile.unbounded:
        wanted = max(preset.tolerance, rules.edge_finest) / rules.edge_error * profile.reach[1]
    else:
        share = (preset.tolerance / rules.fillet_error) ** (1 / rules.fillet_order)
        wanted = share * case.rounding
    return max(min(edge, wanted), rules.least_edge)


def edges_error(case: Case, edge: float) -> tuple[float, str]:
    """Error because of the profile's own edges, meshed with ``edge`` m: of a rounded one the peak
    pressure's; and what it is.
    """
    profile, rules = case.profile, case.rules
    if not profile.edges:
        return 0.0, ""
    if profile.unbounded or unresolved_edge(case, edge):
        error = max(rules.edge_error * edge / profile.reach[1], rules.edge_floor)
        return (
            error,
            "at a true edge the skin is held or is not, by a node; a fillet that is resolved "
            "converges",
        )
    said = f"edges of {micrometres(edge)} um on {micrometres(case.rounding)} um of a rounded edge"
    return _fillet_error(case, edge), said


def _on_tip(case: Case, profile: Profile) -> float:
    """Share of the pressure that the tip of a profile on the axis brings to where it is round; 0:
    there is none, or the contact is no wider.

    Under a cone of slope s pressure grows towards its tip as E* s / 2 arcosh(half width / radius)
    (Sneddon 1948).
    """
    half_width = case.contact.half_width
    if not case.scene.axisymmetric or not 0 < profile.tip < half_width:
        return 0.0
    cone = case.pad.stiff * profile.flank / 2
    hertz = 1.5 / np.pi * case.force / half_width**2
    return float(cone / max(hertz, cone / 2 * np.log(2 * half_width / profile.tip)))


def tip_edge(case: Case, profile: Profile, tolerance: float) -> float:
    """Element edge (m) at a tip on the axis that is wrong by a tolerance; without bound where there
    is none.
    """
    rules, share = case.rules, _on_tip(case, profile)
    if not share:
        return np.inf
    error = tolerance / share
    if error < rules.tip_error:
        edges = (error / rules.tip_error) ** (1 / rules.tip_order)
    else:
        edges = np.exp(min(error - rules.tip_error, 99.0))
    return float(max(edges * profile.tip, rules.least_edge))


def tip_error(case: Case, profile: Profile, edge: float) -> tuple[float, str]:
    """Error of the centre pressure because of a profile's tip on the axis, meshed with ``edge`` m;
    and what it is.
    """
    rules, share, tip = case.rules, _on_tip(case, profile), profile.tip
    if not share:
        return 0.0, ""
    said = f"edges of {micrometres(edge)} um on a tip of {micrometres(tip)} um on the axis"
    edges = edge / tip
    # a tip that is finer than the mesh misses what a cone's pressure grows by
    error = rules.tip_error * min(edges, 1.0) ** rules.tip_order + np.log(max(edges, 1.0))
    return float(share * error), said


def unresolved_edge(case: Case, edge: float) -> bool:
    """Whether the profile's edges are rounded, but finer than ``edge`` m can tell: the pressure
    there is the mesh's.
    """
    rounded = bool(case.profile.edges) and not case.profile.unbounded
    return rounded and bool(_fillet_error(case, edge) > 1)


def _fillet_error(case: Case, edge: float) -> float:
    return case.rules.fillet_error * (edge / case.rounding) ** case.rules.fillet_order


def height_at_receptors(scene: Scene, external: PadMesh) -> float | None:
    """Largest height of the elements of a mesh that receptors are in, over their depth; None where
    there are no receptors.
    """
    receptors = scene.outputs.receptors
    if not receptors.depths or not receptors.offsets:
        return None
    skin = external.points[skin_chain(external)]
    upper = skin[touched_side(skin)]
    upper = upper[np.argsort(upper[:, 0])]
    corners = external.points[external.cells]
    (left, low), (right, high) = corners.min(axis=1).T, corners.max(axis=1).T
    worst = 0.0
    for x, depth in product(receptors.offsets, receptors.depths):
        y = np.interp(x, *upper.T) - depth
        here = (left <= x) & (x <= right) & (low <= y) & (y <= high)
        worst = max(worst, float((high - low)[here].max(initial=0.0)) / depth)
    return worst
