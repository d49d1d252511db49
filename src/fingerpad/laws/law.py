"""What a hyperelastic law is: an isochoric energy of plane strain with its derivatives, and its
constants.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import inf
from pathlib import Path

import numpy as np


def isochoric(jac):
    """J^(-2/3), which takes the change of volume out of I1; where a formula is compiled, so is
    this.
    """
    return jac ** (-2.0 / 3.0)


@dataclass(frozen=True)
class Constant:
    """A dimensionless constant of a law: what it means, its default, and its bounds (included)."""

    meaning: str
    default: float = 0.0
    low: float = 0.0
    high: float = inf


@dataclass(frozen=True)
class Law:
    """An isotropic, isochoric hyperelastic law, as three formulas of plane strain.

    There ``I2 = I1 - 1 + J^2``, so that every such energy is a function psi of ``I1 = tr F^T F +
    1`` and ``J = det F`` alone. Its stress and the change of it, with ``c = cof F``, are

        P  = m (F - t/(3 J) c)
        dP = m dF + psi_J C0:dF + f F (F:dF) + g (F (c:dF) + c (F:dF)) + h c (c:dF)

    with m = 2 psi_1, t = -3 J psi_J / m, f = 4 psi_11, g = 2 psi_1J and h = psi_JJ.

    The formulas take ``(i1, jac, mu, constants)``, and J^(-2/3) from :func:`isochoric`; they work
    on numbers, where they are compiled into the element loops, and on arrays alike;
    ``constants[k]`` is the k-th constant. The shear modulus ``mu`` (Pa) multiplies everything:
    undeformed, every law is the linear solid of that modulus, and Prony branches relax it; without
    it (zero) t is still a number.

    Attributes
    ----------
    name
        In the scene language.
    energy
        Psi, Pa.
    stress
        ``(m, t)``.
    tangent
        ``(m, t, f, g, h)``.
    constants
        Name -> :class:`Constant`, in the order in which the formulas take them.
    bilinear
        Psi is linear in I1, f is zero and is left out of the element loops.
    """

    name: str
    energy: Callable
    stress: Callable
    tangent: Callable
    constants: Mapping[str, Constant] = field(default_factory=dict, hash=False)
    bilinear: bool = False

    @cached_property
    def source(self) -> str:
        """Digest of the file with the formulas: compiled loops are kept for as long as it stays."""
        return hashlib.sha256(Path(self.stress.__code__.co_filename).read_bytes()).hexdigest()


def departure(law: Law, constants: Sequence[float], strain: float) -> float:
    """By how much a law is stiffer or softer than neo-Hooke, relative, pulled by ``strain`` in the
    plane at constant volume.
    """
    stretch = 1 + strain
    return abs(float(law.stress(stretch**2 + stretch**-2 + 1, 1.0, 1.0, constants)[0]) - 1)


@dataclass(frozen=True)
class Assigned:
    """A law, its constants (ne, number of constants), and which elements (ne,) bool follow it."""

    law: Law
    constants: np.ndarray
    elements: np.ndarray

    def at(self, index: np.ndarray) -> Assigned:
        """The same for chosen elements (n,), in their order."""
        return Assigned(self.law, self.constants[index], self.elements[index])


def assign(
    choices: Sequence[tuple[Law, Sequence[float]]], region: np.ndarray
) -> tuple[Assigned, ...]:
    """Each law once, with the elements of the regions that chose it.

    Parameters
    ----------
    choices
        Law and its constants of each region.
    region
        (ne,) index into them.
    """
    out = []
    for law in dict.fromkeys(law for law, _ in choices):
        table = np.array(
            [given if own is law else [0.0] * len(law.constants) for own, given in choices], float
        )
        here = np.array([own is law for own, _ in choices])[region]
        if here.any():
            out.append(Assigned(law, table.reshape(len(choices), len(law.constants))[region], here))
    return tuple(out)
