"""Every measure that a sweep can keep, by name: those of any scene, and those that other packages
add.

A package adds measures by an entry point of the group ``fingerpad.measures``: a module with a
dictionary ``MEASURES``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path

from fingerpad.measures import of_any
from fingerpad.measures.measure import Measure, measures_of

GROUP = "fingerpad.measures"
OF_ANY: dict[str, Measure] = measures_of(of_any)
"""Measures of any scene."""


def known(names: Iterable[str]) -> Mapping[str, Measure]:
    """Measures by name: those of any scene, and all others if `names` has one that is not among
    them.
    """
    if OF_ANY.keys() >= set(names):
        return OF_ANY
    added = {}
    for plugin in entry_points(group=GROUP):
        added |= plugin.load().MEASURES
    return OF_ANY | added


def plugins() -> list[Path]:
    """Folders of the packages that add measures."""
    return [
        Path(find_spec(plugin.module.split(".")[0]).origin).parent
        for plugin in entry_points(group=GROUP)
    ]
