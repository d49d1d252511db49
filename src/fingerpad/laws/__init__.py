"""Hyperelastic laws: what a layer's tissue answers to a change of shape.

One file a law, with its energy, stress, tangent and declared constants; :data:`LAWS` is the
register that scene language, planner and mechanics read. The first simulation with a law other than
neo-Hooke compiles its element loops, once.
"""

from fingerpad.laws import neo_hooke, yeoh
from fingerpad.laws.law import Assigned, Constant, Law, assign, departure

NEO_HOOKE = neo_hooke.LAW

#: Laws by their name in the scene language.
LAWS: dict[str, Law] = {law.name: law for law in (NEO_HOOKE, yeoh.LAW)}

__all__ = ["LAWS", "NEO_HOOKE", "Assigned", "Constant", "Law", "assign", "departure"]
