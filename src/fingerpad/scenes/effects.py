"""The effects that a scene may switch.

Planning, which decides on them, stands above scenes and is not imported here; its register
(:mod:`fingerpad.planning.effects`) has the same names.
"""

EFFECTS: list[str] = ["finite_strain", "friction", "ridges", "symmetry", "viscoelasticity"]
"""Names of effects, as scenes switch them; one that is registered at run time is appended."""
