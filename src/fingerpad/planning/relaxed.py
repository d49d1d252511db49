"""What a run in trouble has relaxed of its plan."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Relaxed:
    """What a plan owes to trouble; all as planned by default.

    Attributes
    ----------
    pieces
        Into so many pieces each increment of a steady press is cut.
    halvings
        How often the edges of an external mesh were halved, inside its geometry.
    precise
        Whether matrices are factorised in double precision from the start.
    most_factorisations
        Matrices factorised after which the run is given up; 0: never.
    said
        What was relaxed, in words.
    """

    pieces: int = 1
    halvings: int = 0
    precise: bool = False
    most_factorisations: int = 0
    said: tuple[str, ...] = ()
