"""Elastic constants of the layers and the Prony series, in the form the mechanics wants them."""

from dataclasses import dataclass
from typing import NamedTuple

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
    """

    g: tuple[float, ...] = ()
    tau: tuple[float, ...] = ()

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


class Moduli(NamedTuple):
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
    """
    e, nu = np.asarray(youngs_modulus, dtype=float), np.asarray(poisson_ratio, dtype=float)
    shear, bulk = e / (2 * (1 + nu)), e / (3 * (1 - 2 * nu))
    if described_state == "long_term":
        return Moduli(shear, shear / prony.g_infinity, bulk)
    return Moduli(shear * prony.g_infinity, shear, bulk)
