"""What an effect of the planner is: a question, a decision with its reason, rules with their
evidence, scenes that show it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

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
    """

    scene: Scene
    profile: Profile
    pad: PadEstimate
    contact: ContactEstimate
    external: PadMesh | None
    moves: bool
    tolerance: float
    rules: Any
    decided: Mapping[str, Effect]


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


def _unchanged(parts: Parts) -> Parts:
    return parts


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
        Class of its rules, each a :func:`rule`; None for an effect without.
    dearer
        Cost with it over cost without.
    shown
        The scenes that show it.
    always
        What is done whatever the rules say.
    title, marker
        In the picture of the study.
    """

    name: str
    question: str
    decide: Callable[[Case], Effect]
    turn_on: Callable[[Parts], Parts] = _unchanged
    possible: Callable[[Case], bool] = lambda case: True
    after: tuple[str, ...] = ()
    left_out: Callable[[Case], LeftOut] = lambda case: LeftOut()
    instead: str = ""
    mesh: Callable[[Case, MeshSize, float], Meshed] | None = None
    rules: type | None = None
    dearer: Callable[[Any], float] = lambda rules: 1.0
    shown: tuple[Shown, ...] = ()
    always: str = ""
    title: str = ""
    marker: str = "o"


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
