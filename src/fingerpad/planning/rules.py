"""The planner's thresholds and measured constants, and the presets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fingerpad.planning.effects import EFFECTS
from fingerpad.planning.errors import MeasuredErrors, OwnErrors


@dataclass(frozen=True)
class Preset:
    """A discretisation: edges m, steps per leg, longest step of a slide m.

    ``tolerance`` is what an effect left out may change. ``edges`` are at least in half of a contact
    that stays where it is, ``rows`` in as much of the depth below it: of meshes that soon grow
    coarse more, or strain energies fall short. ``focus`` is the edge m to which the mesh is refined
    in the contact, along the skin and into it (None: not refined unless the contact is narrower
    than an edge).
    """

    skin_edge: float
    layer_edge: float
    steps: int
    growth: float
    tolerance: float
    slide_step: float | None
    edges: float = 0.0
    rows: float = 0.0
    focus: float | None = None


@dataclass(frozen=True)
class Rules(*(effect.rules for effect in EFFECTS.values() if effect.rules)):
    """Thresholds and measured constants of the planner; those of an effect are in its file.

    Attributes:
        presets: by name. errors: what a tolerance is met with, and what a run believes of itself.
        mesh_order, time_order: with which errors are taken to go on beyond the meshes and steps
        that were measured. edge_share: of an element's edge, by which an edge of the contact may be
        misplaced: little more than a quarter of the
            node spacing.
        safety: factor on both, for errors swing with where nodes happen to lie: the least that
        covers presses drawn at random. stroked: factor on those of strokes, for others than those
        measured. fillet_error, fillet_order: of the peak pressure, over that power of element edge
        / length of the contact on the rounded
            edge that presses. edge_error: of the centre pressure and the strain energies, over
            element edge / half width of the face, under a true edge; edge_floor: what it does not
            fall below, for the skin's node at the edge is held by it or is not (at most 11.3 % in
            24 bars drawn at random, with a third more); edge_finest: the error that a mesh is at
            most made for there.
        bumps: factor on the error of measured profiles, whose bumps make contacts within the
        contact. profile_share: of a tolerance, that the smoothing of a measured profile may use up
        before a longer one is tried. own: what a mesh of one's own is believed to be wrong by.
        linear_triangle, linear_quad: by how much coarser P2B and Q1P0 elements of external meshes
        count than their edges on a
            stroke.
        least_edge: m, of an element; shorter ones are not made. least_half_width: m, of a contact;
        narrower ones are refused. most_nodes: of a mesh, and most_memory: share of the machine's,
        that a plan may ask for; bytes_node, bytes_step: needed
            for each node, and for each node and step.
        most_runs: of a scene whose run missed its tolerance; most_nodes_again: of a mesh on which
        it is run again. least_steps: of a leg; fewer would do for its end, but a curve of fewer is
        none. least_steps_stroked: where there is a
            stroke, for friction remembers the way that each step took, and events lie between
            outputs.
        fine_half_width: m, least extent of the fine skin mesh to either side of the apex.
        edges_per_half_width: least edges in a contact to either side; presets have more.
        rows_per_half_width: least rows of
            elements in as much of the depth below it, where it is refined for them: of the presets
            `thesis` and `fine` more make no curve better, fewer no worse where the layers have as
            many.
        stroked_growth: most to which a preset's growth is squared where the contact moves: its
        curves are those of the mesh along
            its way.
        stroked_share: of a preset's skin edge, under the middle of a pad that is stroked, where its
        curves are read, and
            stroked_middle: m to either side.
        inertia_limit: largest rho v^2 / mu at which a quasi-static solution is offered.
        skin_stretch: m, by which friction carries the contact along, added to the fine skin mesh.
        seconds_*: measured process time of one reference core (see benchmarks): start-up, per node
        and Newton iteration with
            finite and with small strain, and per node and step for output.
    """

    presets: Mapping[str, Preset] = field(
        default_factory=lambda: {
            "draft": Preset(268.8e-6, 243e-6, 10, 1.35, 0.06, 0.5e-3, 6.0, 6.0),
            "thesis": Preset(134.4e-6, 121.5e-6, 20, 1.2, 0.02, 0.25e-3, 20.0),
            "fine": Preset(67.2e-6, 60.7e-6, 40, 1.15, 0.007, 0.125e-3, 33.0),
        }
    )
    errors: MeasuredErrors = field(default_factory=MeasuredErrors)
    own: OwnErrors = field(default_factory=OwnErrors)
    mesh_order: float = 1.0
    time_order: float = 1.0
    edge_share: float = 0.14
    safety: float = 1.56
    stroked: float = 1.25
    fillet_error: float = 0.4
    fillet_order: float = 1.5
    edge_error: float = 0.8
    edge_floor: float = 0.15
    edge_finest: float = 0.11
    bumps: float = 2.5
    profile_share: float = 0.25
    linear_triangle: float = 1.6
    linear_quad: float = 2.0
    least_edge: float = 1e-7
    least_half_width: float = 2e-7
    most_nodes: float = 2e6
    most_memory: float = 0.8
    bytes_node: float = 1e4
    bytes_step: float = 20.0
    most_runs: int = 3
    most_nodes_again: float = 3e5
    least_steps: int = 10
    least_steps_stroked: int = 20
    fine_half_width: float = 3.4e-3
    skin_stretch: float = 1.0e-3
    inertia_limit: float = 0.1
    edges_per_half_width: float = 2.0
    rows_per_half_width: float = 3.0
    stroked_growth: float = 1.44
    stroked_share: float = 0.6
    stroked_middle: float = 1.4e-3
    seconds_start: float = 0.8
    seconds_finite: float = 0.9e-6
    seconds_small: float = 0.45e-6
    iterations_finite: float = 2.6
    iterations_small: float = 2.0


RULES = Rules()
