"""What a run may do of its own accord when it is in trouble."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal, get_args

from fingerpad.documents import Problem, Strict
from fingerpad.fields import OneOf, number

Answer = Literal["relax", "stop"]
BUDGET = 4.0
_ALLOWED = "relax, stop, or a mapping of relax and budget"
_Budget: Any = number("a number above 0", 0.0, math.inf)


class Relaxing(Strict):
    """How far a run that is in trouble may go."""

    relax: Literal["unwritten", "everything"] = "unwritten"
    """What may be relaxed: what the scene leaves to the plan (`unwritten`), or also its own steps,
    edges, element and the radius of its tip (`everything`); never its loads or its pad.
    """
    budget: _Budget = BUDGET
    """What all further runs may cost together, over what the first took."""


def _kind_of(value: Any) -> Any:
    if isinstance(value, (Mapping, Relaxing)):
        return Relaxing
    if value not in get_args(Answer):
        raise Problem("is no answer to trouble", _ALLOWED)
    return Answer


OnTrouble = Annotated[Answer | Relaxing, OneOf(_kind_of, {"answer": Answer, "relaxing": Relaxing})]
