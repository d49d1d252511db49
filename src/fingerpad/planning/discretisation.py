"""The mesh and the steps: a named preset, the cheapest that meets a tolerance, or by hand; and what
edges of the profile need.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from fingerpad.planning.bounds import PlanError, micrometres, percent
from fingerpad.planning.contact import contact_reach, earliest_half_width, moves_along
from fingerpad.planning.errors import THESIS_ROWS, Stroke, estimated_error
from fingerpad.planning.estimates import ContactEstimate, PadEstimate
from fingerpad.planning.rules import Preset, Rules
from fingerpad.planning.schedule import leg_durations
from fingerpad.scenes.scene import Discretisation, Scene
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.measures import apex_edge, touched_side
from fingerpad.specimen.pad import MeshSize, PadMesh, all_over
from fingerpad.stimuli.profile import Profile

_THIN = 1e-3  # m, of layers altogether, below which presets are in their size
_FINEST_FOCUS = 14  # halvings of the edge in the contact that are tried
# of the least error there is, by which a tolerance that cannot be met is missed further for less
# work
_NEAR = 0.15
_MOST_COLUMNS = 2000  # of refined elements to either side
_WIDER = 1.2  # than a contact is estimated to be, the mesh is as fine as it is there
_STAGE = 2.0**0.25  # by how much finer a mesh is in a contact, if at all


def preset_for(
    scene: Scene,
    rules: Rules,
    contact: ContactEstimate,
    tolerance: float | None,
    stroke: Stroke | None,
) -> tuple[Preset, Discretisation | None]:
    """The discretisation asked for: a named one, the cheapest that meets a tolerance, or one by
    hand.
    """
    accuracy = scene.accuracy
    by_hand = accuracy if isinstance(accuracy, Discretisation) else None
    if isinstance(accuracy, str):
        return _in_size(rules.presets[accuracy], scene), None
    if scene.tolerance is not None:
        return _cheapest(
            scene, min(scene.tolerance, tolerance or 1.0), contact, rules, stroke
        ), by_hand
    thesis = rules.presets["thesis"]
    if edges_chosen(scene):
        return thesis, by_hand
    edge = accuracy.skin_edge
    error = estimated_error(edge, max(contact.half_width, 1e-5), rules=rules)
    scale = edge / thesis.skin_edge
    return replace(
        thesis, skin_edge=edge, layer_edge=thesis.layer_edge * scale, tolerance=error
    ), by_hand


def _in_size(preset: Preset, scene: Scene) -> Preset:
    """A preset in the size of its specimen: on layers far thinner than a finger's, edges and steps
    are as much shorter.
    """
    stack = scene.specimen.stack
    share = 1.0 if stack is None else min(1.0, sum(stack.thicknesses) / _THIN)
    step = preset.slide_step and share * preset.slide_step
    return replace(
        preset,
        skin_edge=share * preset.skin_edge,
        layer_edge=share * preset.layer_edge,
        slide_step=step,
    )


def _cheapest(
    scene: Scene, tolerance: float, contact: ContactEstimate, rules: Rules, stroke: Stroke | None
) -> Preset:
    """Of the measured meshes and steps those of least nodes times steps that meet it or, if none
    does, come near the least error.

    A mesh that suffices for the widest contact measured is refined under a narrower one that stays
    where it is.
    """
    thesis, known = rules.presets["thesis"], rules.errors
    timed = bool(scene.specimen.prony) and any(
        duration is not None for duration in leg_durations(scene)
    )
    moves, half_width = moves_along(scene), earliest_half_width(scene, contact, timed)
    still = not moves and scene.specimen.mesh is None and _only_inner(scene)
    bumpy = scene.stimulus.irregular
    outer = 1 if _only_inner(scene) else 3  # columns of outer ridges
    found = []
    least_steps = rules.least_steps_stroked if moves else rules.least_steps
    for rows, steps in product(known.mesh, (n for n in known.time if n >= least_steps)):
        edge, growth = (
            known.edge * THESIS_ROWS / rows,
            min(thesis.growth ** (THESIS_ROWS / rows), 3.0),
        )
        time = steps if timed or moves else None
        for finer in 2 ** np.arange(0, _FINEST_FOCUS, 0.5) if still else (1,):
            # the right half has about 7 columns and 4 rows an element across the epidermis
            more = np.log(finer) / np.log(growth)
            wide = 1.2 * contact_reach(scene, contact) / edge * (finer - 1)
            if finer > 1 and (edge / finer < rules.least_edge or wide > _MOST_COLUMNS):
                break
            error = estimated_error(
                edge / finer / outer, half_width, time, stroke, edge, rules=rules, bumpy=bumpy
            )
            work = (7 * rows + more + wide) * (4 * rows + more) * steps
            found.append((error, work, edge / finer, edge, growth, steps))
    least = min(found)[0]
    enough = tolerance if least <= tolerance else (1 + _NEAR) * least
    _, focus, edge, growth, steps = min(rest for error, *rest in found if error <= enough)
    outline, slide_step = scene.specimen.outline, thesis.slide_step * thesis.steps / steps
    # so many elements across the epidermis, however thick it is
    layer_edge = thesis.layer_edge * edge / thesis.skin_edge
    if outline is not None:
        layer_edge = min(layer_edge, outline.epidermis_thickness * edge / known.edge / THESIS_ROWS)
    return Preset(
        edge,
        layer_edge,
        steps,
        growth,
        tolerance,
        slide_step,
        focus=focus if focus < edge else None,
    )


def usual_edge(scene: Scene, external: PadMesh | None, rules: Rules) -> float:
    """Edge (m) of the skin before the contact is known: of the mesh given, the preset, or the one
    by hand; else of the thesis.
    """
    if external is not None:
        return apex_edge(external)
    by_hand = getattr(scene.accuracy, "skin_edge", None)
    return (
        by_hand
        or rules.presets[scene.accuracy if isinstance(scene.accuracy, str) else "thesis"].skin_edge
    )


def element_for(by_hand: Discretisation | None, external: PadMesh | None) -> str:
    """The element to solve with: the one asked for, if the mesh has it or can be raised to it, else
    the mesh's own.

    Raises:
        PlanError: it does not fit the mesh.
    """
    kind = external.element if external else "quad9"
    natural = KINDS[kind].solved
    fitting = (natural, "Q2P1") if kind == "quad4" else (natural,)
    if by_hand is None or by_hand.element is None:
        return natural
    if by_hand.element in fitting:
        return by_hand.element
    raise PlanError(
        f"accuracy.element: {by_hand.element} does not fit the mesh of {kind}; allowed: "
        f"{' or '.join(dict.fromkeys(fitting))}"
    )


def raised_for(
    by_hand: Discretisation | None,
    external: PadMesh,
    tolerance: float,
    error: Callable[[PadMesh], float],
) -> tuple[PadMesh, str]:
    """An external mesh, its linear quads raised to quadratic ones where the accuracy needs it, and
    why it was ("": it was not).

    Args:
        tolerance: relative, what is asked. error: expected of a contact on a mesh.
    """
    if external.element != "quad4":
        return external, ""
    asked = by_hand.element if by_hand else None
    if asked == "Q2P1":
        return (
            external.raised(),
            "linear quads raised to quadratic ones of the same corners: asked for in the scene",
        )
    if asked or (by_hand and by_hand.tolerance is None) or error(external) <= tolerance:
        return external, ""
    raised = external.raised()
    return raised, (
        "linear quads raised to quadratic ones of the same corners: they would be wrong by "
        f"{percent(error(external))}, "
        f"{percent(tolerance)} is asked, these by {percent(error(raised))}"
    )


def wander_of(
    scene: Scene, pad: PadEstimate, profile: Profile, friction: float | None, rules: Rules
) -> float:
    """How far (m) a stroke takes the contact from the middle of the pad: to where the pad is as
    steep as the surface.
    """
    way = np.cumsum([leg.along for leg in scene.motion])
    steep = min(profile.steepness * pad.apex_radius, np.abs(way).max())
    return steep + (0.0 if friction is None else rules.skin_stretch)


def mesh_size_for(
    scene: Scene,
    preset: Preset,
    profile: Profile,
    contact: ContactEstimate,
    half_width: float,
    wander: float,
    rounding: float,
    rules: Rules,
) -> MeshSize:
    offsets = max((abs(x) for x in scene.outputs.receptors.offsets), default=0.0)
    fine = max(rules.fine_half_width, 1.3 * half_width, half_width + wander, offsets)
    focus, radial = (), None
    edges = max(preset.edges if _only_inner(scene) else 0.0, rules.edges_per_half_width)
    if preset.focus is not None:
        focus, radial = (
            all_over(_WIDER * min(half_width, contact_reach(scene, contact)), preset.focus),
            preset.focus,
        )
    if profile.edges:
        edge = _edge_size(
            profile, preset, None if scene.tolerance is None else preset.tolerance, rounding, rules
        )
        places = {abs(x) for x in profile.edges}
        if scene.tolerance is not None:
            # where the face ends pressure is largest
            places |= {x - profile.edge_radius for x in places}
        focus += tuple((x, edge) for x in sorted(places))
        if scene.tolerance is not None:
            radial = min(edge, radial or edge)
    elif (
        preset.focus is None
        and _refined_at_apex(scene)
        and (edge := _staged(max(contact.half_width / edges, rules.least_edge), np.floor))
        <= preset.skin_edge / _STAGE
    ):
        # its edge passes from node to node, and the curves of a narrow contact show how far these
        # are apart: along the skin alone
        focus = all_over(_WIDER * _staged(contact_reach(scene, contact), np.ceil), edge)
        rows = max(preset.rows, rules.rows_per_half_width)
        radial = max(edge, _staged(contact.half_width / rows, np.floor))
    elif _stroked(scene) and scene.specimen.ridges is None:
        # what is read of a stroke is read there: centre pressure and what it does to receptors
        focus = all_over(
            _WIDER * max(rules.stroked_middle, offsets), rules.stroked_share * preset.skin_edge
        )
    return MeshSize(
        skin_edge=preset.skin_edge,
        fine_half_width=min(fine, 0.9 * scene.specimen.half_width),
        layer_edge=preset.layer_edge,
        growth=_growth(scene, preset, rules),
        focus=focus,
        skin_radial_edge=radial,
    )


def _growth(scene: Scene, preset: Preset, rules: Rules) -> float:
    """From one edge to the next: of a preset larger where the contact moves, whose mesh is mostly
    away from it.
    """
    return (
        max(preset.growth, min(preset.growth**2, rules.stroked_growth))
        if _stroked(scene)
        else preset.growth
    )


def _stroked(scene: Scene) -> bool:
    """Whether a contact that moves has the edges of a preset."""
    return edges_chosen(scene) and scene.tolerance is None and moves_along(scene)


def _staged(length: float, rounded: Callable[[float], float]) -> float:
    """A length (m) rounded to one of four in every octave: contacts of about a size share a mesh,
    of which a sweep has few.
    """
    return float(2.0 ** (rounded(4 * np.log2(length)) / 4))


def _refined_at_apex(scene: Scene) -> bool:
    """Whether a contact narrower than an edge is refined for: not where edges are given by hand or
    the contact moves.
    """
    return edges_chosen(scene) and not moves_along(scene)


def edges_chosen(scene: Scene) -> bool:
    """Whether edges are not given by hand."""
    return getattr(scene.accuracy, "skin_edge", None) is None


def _only_inner(scene: Scene) -> bool:
    """Whether edges along the skin are those that are asked for: outer ridges have a third of
    them.
    """
    return scene.specimen.ridges is None or scene.specimen.ridges.outer is None


def _edge_size(
    profile: Profile, preset: Preset, asked: float | None, rounding: float, rules: Rules
) -> float:
    """Element edge (m) at the profile's own edges: as presets have it, and finer where a tolerance
    asks for that.
    """
    edge = (
        min(preset.skin_edge / 4, profile.edge_radius / 2)
        if profile.edge_radius
        else preset.skin_edge / 4
    )
    if asked is None:
        return edge
    if profile.unbounded:
        wanted = max(asked, rules.edge_finest) / rules.edge_error * profile.reach[1]
    else:
        wanted = (asked / rules.fillet_error) ** (1 / rules.fillet_order) * rounding
    return max(min(edge, wanted), rules.least_edge)


def edges_error(profile: Profile, edge: float, rounding: float, rules: Rules) -> tuple[float, str]:
    """Error because of the profile's own edges, meshed with ``edge`` m: of a rounded one the peak
    pressure's; and what it is.
    """
    if not profile.edges:
        return 0.0, ""
    if peak_is_unbounded(profile, edge, rounding, rules):
        error = max(rules.edge_error * edge / profile.reach[1], rules.edge_floor)
        return (
            error,
            "at a true edge the skin is held or is not, by a node; a fillet that is resolved "
            "converges",
        )
    said = f"edges of {micrometres(edge)} um on {micrometres(rounding)} um of a rounded edge"
    return rules.fillet_error * (edge / rounding) ** rules.fillet_order, said


def peak_is_unbounded(profile: Profile, edge: float, rounding: float, rules: Rules) -> bool:
    """Whether the pressure at the profile's edges is the mesh's: they are true ones, or roundings
    that ``edge`` m cannot tell.
    """
    return bool(
        profile.unbounded
        or (profile.edges and rules.fillet_error * (edge / rounding) ** rules.fillet_order > 1)
    )


def height_at_receptors(scene: Scene, external: PadMesh) -> float | None:
    """Largest height of the elements of a mesh that receptors are in, over their depth; None where
    there are no receptors.
    """
    receptors = scene.outputs.receptors
    if not receptors.depths or not receptors.offsets:
        return None
    skin = external.points[np.unique(external.curves["skin"])]
    upper = skin[touched_side(skin[:, 1])]
    upper = upper[np.argsort(upper[:, 0])]
    corners = external.points[external.cells]
    low, high = corners.min(axis=1), corners.max(axis=1)
    height, worst = high[:, 1] - low[:, 1], 0.0
    for x in receptors.offsets:
        over = np.flatnonzero((low[:, 0] <= x) & (x <= high[:, 0]))
        for depth in receptors.depths:
            y = np.interp(x, *upper.T) - depth
            here = over[(low[over, 1] <= y) & (y <= high[over, 1])]
            worst = max(worst, float(height[here].max(initial=0.0)) / depth)
    return worst
