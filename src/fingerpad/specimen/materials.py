"""Elastic constants of the layers and the Prony series, in the form the mechanics wants them."""

from dataclasses import dataclass
from math import isfinite

import numpy as np


@dataclass(frozen=True)
class Prony:
    """Relaxation of the shear modulus, ``G(t)/G_0 = 1 - sum_i g_i (1 - exp(-t/tau_i))`` (thesis Eq
    3-1).

    Attributes
    ----------
    g
        Shares of the instantaneous modulus that relax, each >= 0, sum < 1.
    tau
        Their time constants, s, each > 0.

    Raises
    ------
    ValueError
        Lengths differ, or a value is out of range.
    """

    g: tuple[float, ...] = ()
    tau: tuple[float, ...] = ()

    def __post_init__(self):
        if len(self.g) != len(self.tau):
            raise ValueError("a Prony series needs one tau for every g")
        if any(not g >= 0 for g in self.g) or not sum(self.g) < 1:
            raise ValueError("Prony shares must be >= 0 and sum to less than 1")
        if any(not (tau > 0 and isfinite(tau)) for tau in self.tau):
            raise ValueError("Prony time constants must be positive")

    def __bool__(self) -> bool:
        return any(g > 0 for g in self.g)

    @property
    def g_infinity(self) -> float:
        """Long-term over instantaneous shear modulus."""
        return 1.0 - sum(self.g)

    @property
    def beta(self) -> np.ndarray:
        """(nb,) branch moduli over the long-term modulus."""
        return np.asarray(self.g) / self.g_infinity

    def relaxation(self, time):
        """G(t)/G_0 at ``time`` (s, any shape)."""
        time = np.asarray(time, dtype=float)
        return 1.0 - sum(
            g * -np.expm1(-time / tau) for g, tau in zip(self.g, self.tau, strict=True)
        )


@dataclass(frozen=True)
class Moduli:
    """Per region: long-term shear modulus, instantaneous shear modulus and the (time-independent)
    bulk modulus, Pa.

    ``mu = E / 2(1 + nu)``, ``kappa = E / 3(1 - 2 nu)``; with a Prony series only the shear modulus
    relaxes.
    """

    shear_long_term: np.ndarray
    shear_instantaneous: np.ndarray
    bulk: np.ndarray


def moduli(
    youngs_modulus, poisson_ratio, prony: Prony, described_state: str = "long_term"
) -> Moduli:
    """Long-term and instantaneous moduli of regions whose E (Pa) and nu describe one of the two
    states.

    Raises
    ------
    ValueError
        E <= 0, nu outside (-1, 1/2), or an unknown state.
    """
    e, nu = np.asarray(youngs_modulus, dtype=float), np.asarray(poisson_ratio, dtype=float)
    if not (np.all(e > 0) and np.all(nu > -1) and np.all(nu < 0.5)):
        raise ValueError("E must be positive and -1 < nu < 0.5")
    shear, bulk = e / (2 * (1 + nu)), e / (3 * (1 - 2 * nu))
    if described_state == "long_term":
        return Moduli(shear, shear / prony.g_infinity, bulk)
    if described_state == "instantaneous":
        return Moduli(shear * prony.g_infinity, shear, bulk)
    raise ValueError(f"moduli describe long_term or instantaneous, not {described_state!r}")
