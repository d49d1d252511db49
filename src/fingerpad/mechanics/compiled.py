"""The loops of :mod:`kernels` as kept machine code (:mod:`fingerpad.machine_code`): only new ones
need numba.
"""

from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

from fingerpad.laws import Law
from fingerpad.machine_code import Loop, sources

_KERNELS = sources(Path(__file__).with_name("kernels.py"))


@cache
def loops(law: Law, nodes: int, points: int, modes: int) -> SimpleNamespace:
    """:func:`kernels.loops`."""
    made = ("assemble_tangent", "internal_force", "commit", "energies")
    return SimpleNamespace(
        **{name: _loop("loops", (law, nodes, points, modes), name) for name in made}
    )


@cache
def dilatation_loop(nodes: int, points: int, modes: int) -> Loop:
    """:func:`kernels.dilatation_loop`."""
    return _loop("dilatation_loop", (nodes, points, modes))


@cache
def volume_loop(nodes: int, points: int, modes: int) -> Loop:
    """:func:`kernels.volume_loop`."""
    return _loop("volume_loop", (nodes, points, modes))


@cache
def stress_loop(law: Law) -> Loop:
    """:func:`kernels.stress_loop`."""
    return _loop("stress_loop", (law,))


def _loop(maker: str, arguments: tuple = (), loop: str | None = None) -> Loop:
    law = next((a for a in arguments if isinstance(a, Law)), None)
    sizes = "x".join(str(a) for a in arguments if not isinstance(a, Law))
    name = "-".join(filter(None, (loop or maker, law and law.name, sizes)))
    return Loop(name, partial(_from_kernels, maker, arguments, loop), _made_of(law))


def _made_of(law: Law | None) -> str | None:
    """None for a law of somebody else, whose helpers are not known."""
    if law is not None and not law.stress.__module__.startswith("fingerpad."):
        return None
    return f"{_KERNELS} {law and law.source}"


def _from_kernels(maker: str, arguments: tuple, loop: str | None):
    from fingerpad.mechanics import kernels

    made = getattr(kernels, maker)
    if arguments:
        made = made(*arguments)
    return made if loop is None else getattr(made, loop)


bend, mirror, at_points, exchanged = map(_loop, ("bend", "mirror", "at_points", "exchanged"))
