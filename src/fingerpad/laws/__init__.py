"""Hyperelastic laws: what a layer's tissue answers to a change of shape.

One file a law, with its energy, stress, tangent and declared constants; no list names it.
:data:`LAWS` is the register that scene language, planner and mechanics read. The first simulation
with a law other than neo-Hooke compiles its element loops, once.
"""

import pkgutil
from importlib import import_module

from fingerpad.laws import neo_hooke
from fingerpad.laws.law import Assigned, Constant, Law, assign, departure

NEO_HOOKE = neo_hooke.LAW

_FILES = [import_module(f"{__name__}.{module.name}") for module in pkgutil.iter_modules(__path__)]

#: Laws by their name in the scene language: that of each file here which has a ``LAW``.
LAWS: dict[str, Law] = {file.LAW.name: file.LAW for file in _FILES if hasattr(file, "LAW")}

__all__ = ["LAWS", "NEO_HOOKE", "Assigned", "Constant", "Law", "assign", "departure"]
