"""The planner's thresholds, measured constants and presets: those of ``rules.yaml``, and those of
the effects.
"""

from __future__ import annotations

from dataclasses import dataclass, make_dataclass
from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter

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


_TABLES = {
    "presets": dict[str, Preset],
    "errors": MeasuredErrors,
    "errors_turned": MeasuredErrors,
    "own": OwnErrors,
}
"""Types of the rules that are no numbers."""


def _general() -> dict[str, Any]:
    """The rules of ``rules.yaml``."""
    text = Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")
    rows = yaml.safe_load(text)
    for name, kind in _TABLES.items():
        rows[name]["value"] = TypeAdapter(kind).validate_python(rows[name]["value"])
    return {name: rule(**row) for name, row in rows.items()}


_RULES = {
    name: known for effect in reversed(EFFECTS.values()) for name, known in effect.rules.items()
} | _general()
_FIELDS = [(name, Any, known) for name, known in _RULES.items()]


class Rules(make_dataclass("Rules", _FIELDS, frozen=True)):
    """Thresholds and measured constants of the planner; those of an effect are in its file.

    The metadata of each field says what it decides and where its evidence is.
    """


RULES = Rules()
