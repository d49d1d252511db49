"""What an effect of the planner is: a question, a decision with its reason, rules with their
evidence, scenes that show it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from fingerpad.planning.errors import Stroke, stroke_of
from fingerpad.planning.estimates import ContactEstimate, PadEstimate
from fingerpad.scenes.scene import Scene
from fingerpad.scenes.specimen import Ridges
from fingerpad.specimen.pad import MeshSize, PadMesh
from fingerpad.stimuli.profile import Profile


@dataclass(frozen=True)
class Effect:
    """Whether an effect is simulated, and why."""

    on: bool
    why: str


@dataclass(frozen=True)
class Case:
    """What a decision may ask about: the scene, its contact, what may be left out, and the effects
    decided before.

    Attributes
    ----------
    external
        The scene's own mesh, if it names one.
    profile
        What the usual mesh feels of the stimulus.
    pad, contact
        Estimated.
    tolerance
        Relative, what an effect left out may change.
    """

    scene: Scene
    rules: Any
    external: PadMesh | None
    profile: Profile
    pad: PadEstimate
    contact: ContactEstimate = ContactEstimate()
    tolerance: float = 0.0
    decided: Mapping[str, Effect] = field(default_factory=dict)

    @property
    def moves(self) -> bool:
        """Whether the pad moves along the surface."""
        return any(leg.along for leg in self.scene.motion)

    @property
    def way(self) -> tuple[float, float]:
        """Least and largest x (m) of the stimulus that comes over the middle of the pad."""
        way = np.cumsum([0.0, *(leg.along for leg in self.scene.motion)])
        return float(way.min()), float(way.max())

    @property
    def stroke(self) -> Stroke | None:
        """The stroke along the surface, if there is one."""
        return stroke_of(self.scene, self.profile.uneven)

    @property
    def reach(self) -> float:
        """How far (m) the contact reaches to either side."""
        return min(self.contact.half_width, self.scene.stimulus.face)

    @property
    def force(self) -> float:
        """Largest force (N/m) of the motion: that of its legs, or what presses to the estimated
        depth.
        """
        forces = [leg.force for leg in self.scene.motion if leg.force is not None]
        if forces:
            return max(forces) / self.scene.specimen.contact_length
        return self.pad.force_of(self.contact.depth)

    @cached_property
    def rounding(self) -> float:
        """Length (m) of the contact on the rounded edges of a face; 0 where there are none."""
        profile = self.profile
        if not profile.edges or profile.unbounded:
            return 0.0
        face = profile.reach[1] - profile.edge_radius
        return self.pad.on_rounding(self.force, face, profile.edge_radius)


@dataclass(frozen=True)
class Shown:
    """A scene that shows what an effect changes: its name, document, does it matter, and the moduli
    where time is left out.
    """

    label: str
    matters: bool
    document: Mapping[str, Any]
    state: str = "long_term"


@dataclass(frozen=True)
class Parts:
    """What the effects that are on make of a simulation.

    Attributes
    ----------
    scene
        As it is solved; the history keeps the scene that was asked for.
    half
        Whether half the pad is solved.
    friction
        Coefficient between skin and stimulus; None: no friction.
    relaxes
        Whether stress relaxes in time.
    large_strain
        Whether strains and rotations are large.
    ridges
        Of the mesh; None: no ridges.
    """

    scene: Scene
    half: bool = False
    friction: float | None = None
    relaxes: bool = False
    large_strain: bool = False
    ridges: Ridges | None = None


@dataclass(frozen=True)
class LeftOut:
    """What it means to leave an effect out.

    Attributes
    ----------
    error
        Relative, in the headline quantities.
    moduli
        With which the scene is solved, "long_term" or "instantaneous".
    """

    error: float = 0.0
    moduli: str = "long_term"


@dataclass(frozen=True)
class Meshed:
    """What an effect makes of a mesh that is planned.

    Attributes
    ----------
    size
        The mesh with the edges that the effect needs.
    edge
        m, of the skin under the apex.
    error
        Relative, left in the elements that the effect asked for.
    said
        How fine the mesh is, for the reason of the effect.
    """

    size: MeshSize
    edge: float
    error: float
    said: str


@dataclass(frozen=True)
class PlannedEffect:
    """An effect that a plan decides on: all that the package knows of it.

    Attributes
    ----------
    name
        In the scene language.
    question
        What the decision answers.
    decide
        The decision on a case.
    turn_on
        What it changes in the parts of a simulation: the one way by which it acts.
    possible
        Whether a scene can ask for it where ``decide`` has left it out.
    after
        Effects whose decisions it asks about.
    left_out
        What leaving it out means for a case.
    instead
        What is done where it is left out, for sentences about its error.
    mesh
        What it makes of the planned mesh (a case, its size, its edge at the apex in m); None:
        nothing.
    rules
        Name -> :func:`rule`.
    dearer
        Cost with it over cost without.
    shown
        The scenes that show it.
    always
        What is done whatever the rules say.
    title, marker
        In the picture of the study.
    place
        Its place in plans and tables.
    """

    name: str
    question: str
    decide: Callable[[Case], Effect]
    turn_on: Callable[[Parts], Parts] = lambda parts: parts
    possible: Callable[[Case], bool] = lambda case: True
    after: tuple[str, ...] = ()
    left_out: Callable[[Case], LeftOut] = lambda case: LeftOut()
    instead: str = ""
    mesh: Callable[[Case, MeshSize, float], Meshed] | None = None
    rules: Mapping[str, Any] = field(default_factory=dict)
    dearer: Callable[[Any], float] = lambda rules: 1.0
    shown: tuple[Shown, ...] = ()
    always: str = ""
    title: str = ""
    marker: str = "o"
    place: int = 99


OWN_PAIR = "own pair"
"""Evidence of a rule: the scenes that show the effect; "" stands for the drawn ones."""


def rule(value: Any, decides: str, evidence: str = "") -> Any:
    """A rule of the planner: its value, what it decides and where the evidence is (see
    :data:`OWN_PAIR`).
    """
    metadata = {"decides": decides, "evidence": evidence}
    if isinstance(value, dict):
        return field(default_factory=value.copy, metadata=metadata)
    return field(default=value, metadata=metadata)


# of scenes that show effects
PLATE = {"stimulus": {"shape": "flat"}}
CYLINDER = {"stimulus": {"shape": "cylinder", "curvature": "209.97 1/m"}}
HOLD = {"hold": "2 s"}
PRESS = {"press_to_force": "20 gf", "rate": "40 gf/s"}
RAMP = {"motion": [PRESS, HOLD]}
