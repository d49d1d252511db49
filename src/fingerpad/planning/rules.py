"""The planner's thresholds and measured constants, and the presets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from fingerpad.planning.effect import rule
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


PRESETS = {
    "draft": Preset(268.8e-6, 243e-6, 10, 1.35, 0.06, 0.5e-3, 6.0, 6.0),
    "thesis": Preset(134.4e-6, 121.5e-6, 20, 1.2, 0.02, 0.25e-3, 20.0),
    "fine": Preset(67.2e-6, 60.7e-6, 40, 1.15, 0.007, 0.125e-3, 33.0),
}
"""Discretisations by name."""


@dataclass(frozen=True)
class Rules(*(effect.rules for effect in EFFECTS.values() if effect.rules)):
    """Thresholds and measured constants of the planner; those of an effect are in its file.

    Each field says what it decides and where the evidence is: see :func:`described`.
    """

    presets: Mapping[str, Preset] = rule(
        PRESETS,
        "discretisations by name",
        "studies of accuracy",
    )
    errors: MeasuredErrors = rule(
        MeasuredErrors(),
        "mesh and steps for a tolerance, and what a run believes of its error: as measured",
        "figures/tables/accuracy_planner.csv, accuracy_strokes.csv",
    )
    own: OwnErrors = rule(
        OwnErrors(),
        "what meshes of one's own are believed to be wrong by, by element and quantity: as "
        "measured",
        "figures/tables/accuracy_own.csv",
    )
    mesh_order: float = rule(
        1.0,
        "errors of meshes beyond those measured: order in the edge",
        "figures/tables/accuracy_orders.csv",
    )
    time_order: float = rule(
        1.0,
        "errors of steps beyond those measured: order in the step",
        "figures/tables/accuracy_orders.csv",
    )
    # little more than a quarter of the node spacing
    edge_share: float = rule(
        0.14,
        "error, at least: an edge of the contact is misplaced by this share of an element's edge",
        "figures/tables/accuracy_belief.csv",
    )
    # errors swing with where nodes happen to lie: the least factor that covers presses drawn at
    # random
    safety: float = rule(
        1.56,
        "factor on measured errors of presses and on that",
        "figures/tables/accuracy_belief.csv",
    )
    stroked: float = rule(
        1.25,
        "factor on measured errors of strokes",
        "chosen: a quarter more than the strokes measured",
    )
    fillet_error: float = rule(
        0.4,
        "error of the peak pressure on a rounded edge, over edge / length of the contact there, "
        "to a power",
        "figures/tables/accuracy_drawn.csv",
    )
    fillet_order: float = rule(
        1.5,
        "that power",
        "figures/tables/accuracy_drawn.csv",
    )
    edge_error: float = rule(
        0.8,
        "error under a true edge, over edge / half width of the face",
        "figures/tables/accuracy_drawn.csv",
    )
    # the skin's node at the edge is held by it or is not: at most 11.3 % in 24 bars drawn at
    # random, with a third more
    edge_floor: float = rule(
        0.15,
        "error under a true edge, at least",
        "figures/tables/accuracy_drawn.csv",
    )
    edge_finest: float = rule(
        0.11,
        "error that a mesh is at most made for there",
        "figures/tables/accuracy_drawn.csv",
    )
    # which make contacts within the contact
    bumps: float = rule(
        2.5,
        "factor on the error of measured profiles",
        "figures/tables/accuracy_drawn.csv",
    )
    profile_share: float = rule(
        0.25,
        "share of a tolerance that the smoothing of a measured profile may use up before a "
        "longer one is tried",
        "tests/test_measured_profiles.py",
    )
    linear_triangle: float = rule(
        1.6,
        "by how much coarser quadratic triangles of external meshes count than their edges, on a"
        " stroke",
        "figures/tables/accuracy.csv",
    )
    linear_quad: float = rule(
        2.0,
        "by how much coarser linear quads of external meshes count than their edges, on a stroke",
        "figures/tables/accuracy.csv",
    )
    least_edge: float = rule(
        1e-7,
        "shortest element edge that is made (m)",
        "chosen: a tenth of a micrometre, below which skin is no continuum",
    )
    least_half_width: float = rule(
        2e-7,
        "contacts narrower to either side are refused (m)",
        "chosen: two of the shortest edges",
    )
    most_nodes: float = rule(
        2e6,
        "meshes of more nodes are refused",
        "chosen: some 20 GB",
    )
    most_memory: float = rule(
        0.8,
        "plans that need more than this share of the machine's memory are refused",
        "chosen",
    )
    bytes_node: float = rule(
        1e4,
        "memory of a node",
        "figures/tables/accuracy.csv, on 1e5 nodes and in 176 steps",
    )
    bytes_step: float = rule(
        20.0,
        "memory of a node and step",
        "figures/tables/accuracy.csv, on 1e5 nodes and in 176 steps",
    )
    most_runs: int = rule(
        3,
        "runs of a scene that misses its tolerance, at most",
        "chosen: the second run knows the contact",
    )
    most_nodes_again: float = rule(
        3e5,
        "nodes on which a scene that missed its tolerance is run again, at most",
        "chosen: some minutes of one core",
    )
    least_steps: int = rule(
        10,
        "steps of a leg for a tolerance, at least",
        "chosen: fewer would do for the end of a leg, but a curve of fewer is none",
    )
    # friction remembers the way of each step, and events lie between outputs
    least_steps_stroked: int = rule(
        20,
        "the same where there is a stroke",
        "figures/tables/accuracy_strokes.csv",
    )
    fine_half_width: float = rule(
        3.4e-3,
        "fine skin mesh to either side of the apex, at least (m)",
        "contact of a plate at 20 gf reaches 2.4 mm (figures/thesis/fig_4-10.csv)",
    )
    skin_stretch: float = rule(
        1.0e-3,
        "fine skin mesh, further in frictional strokes (m)",
        "skin trails by about 1 mm (figures/tables/calibration.md)",
    )
    inertia_limit: float = rule(
        0.1,
        "scenes with rho v^2 / mu above this are refused",
        "chosen: 1e-4 at 40 mm/s, a tenth of the elastic forces at the limit",
    )
    edges_per_half_width: float = rule(
        2.0,
        "local refinement: edges in the contact's half-width at least; presets have more (6, 20,"
        " 33)",
    )
    # of the presets `thesis` and `fine` more make no curve better, fewer no worse where the layers
    # have as many
    rows_per_half_width: float = rule(
        3.0,
        "local refinement: rows of elements in as much of the depth below the contact at least; "
        "`draft` has 6",
        "figures/tables/accuracy_edges.csv",
    )
    # its curves are those of the mesh along its way
    stroked_growth: float = rule(
        1.44,
        "growth of edges away from a contact that moves: the preset's squared, up to this",
        "figures/tables/accuracy_shown.csv: strokes are as near to finer ones as with the "
        "preset's own",
    )
    # where its curves are read
    stroked_share: float = rule(
        0.6,
        "edges under the middle of a pad that is stroked, over the preset's",
        "figures/tables/accuracy_shown.csv, of strokes",
    )
    stroked_middle: float = rule(
        1.4e-3,
        "the middle: to either side at least (m)",
        "figures/tables/accuracy_shown.csv, of strokes",
    )
    seconds_start: float = rule(
        0.8,
        "predicted cost: start of a process (s)",
        "figures/tables/speed.md",
    )
    seconds_finite: float = rule(
        0.9e-6,
        "predicted cost: a node and Newton iteration, finite strain (s)",
        "figures/tables/speed.md",
    )
    seconds_small: float = rule(
        0.45e-6,
        "predicted cost: a node and Newton iteration, small strain (s)",
        "figures/tables/speed.md",
    )
    iterations_finite: float = rule(
        2.6,
        "predicted cost: iterations a step, finite strain",
        "figures/tables/speed.md",
    )
    iterations_small: float = rule(
        2.0,
        "predicted cost: iterations a step, small strain",
        "figures/tables/speed.md",
    )


RULES = Rules()


def described(rules: Rules = RULES) -> list[tuple[str, Any, str, str]]:
    """Every rule of the planner.

    Returns
    -------
    list of (name, value, what it decides, evidence)
        The evidence is a file or a sentence; "" stands for the scenes of the study of effects, and
        :data:`fingerpad.planning.effect.OWN_PAIR` for the scenes that show the effect.
    """
    return [
        (each.name, getattr(rules, each.name), *each.metadata.values()) for each in fields(rules)
    ]
