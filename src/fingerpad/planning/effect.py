"""What an effect of the planner is: a question, a decision with its reason, rules with their
evidence, scenes that show it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingerpad.planning.estimates import ContactEstimate, PadEstimate
    from fingerpad.scenes.scene import Scene
    from fingerpad.specimen.pad import PadMesh
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
class PlannedEffect:
    """An effect that a plan decides on.

    Attributes:
        name: in the scene language. question: that decides. decide: of a case. always: what is done
        whatever the rules say. possible: whether it can be asked for at all where ``decide`` has
        left it out. after: effects whose decisions it asks about. rules: class of its rules, each a
        :func:`rule`; None for an effect without. dearer: cost with it over without. compose: what
        it changes in a composed :class:`fingerpad.simulation.Simulation`, before that runs. shown:
        the scenes that show it. title, marker: in the picture of the study.
    """

    name: str
    question: str
    decide: Callable[[Case], Effect]
    possible: Callable[[Case], bool] = lambda case: True
    after: tuple[str, ...] = ()
    rules: type | None = None
    dearer: Callable[[Any], float] = lambda rules: 1.0
    compose: Callable[[Any], None] | None = None
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
    return field(default=value, metadata={"decides": decides, "evidence": evidence})
