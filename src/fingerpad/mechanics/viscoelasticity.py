"""The Prony recurrence (Simo 1987; Holzapfel 2000, section 6.10; Taylor, Pister and Goudreau 1970).

Each branch obeys ``Q' + Q/tau = beta S_iso'``. Over a step in which ``S_iso`` changes linearly the
solution is exact:

    Q(t + dt) = exp(-dt/tau) Q(t) + beta gamma (S_iso(t + dt) - S_iso(t)),
    gamma = (1 - exp(-dt/tau)) / (dt/tau)

so the stress answers ``factor = 1 + sum beta gamma`` of the new isochoric stress at once, plus a
history that is known when the step begins. A body without a Prony series never comes here.
"""

import numpy as np

from fingerpad.specimen.materials import Prony


def step_coefficients(prony: Prony, dt: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Decay exp(-dt/tau) (nb,), gamma (nb,) and the instantaneous factor 1 + sum beta gamma of a
    step of ``dt`` seconds.
    """
    ratio = dt / np.asarray(prony.tau)
    gamma = np.where(ratio > 1e-8, -np.expm1(-ratio) / np.maximum(ratio, 1e-300), 1 - ratio / 2)
    return np.exp(-ratio), gamma, float(1 + np.sum(prony.beta * gamma))


class Branches:
    """History of the Prony branches at a set of points: stress ``q`` (nb, ...) and the last
    ``S_iso`` (...).

    ``shape``: of a stress there, whichever of its axes are the components 11, 22, 12, 33. Committed
    only after a step has converged.
    """

    def __init__(self, prony: Prony, shape: tuple[int, ...]):
        self.prony = prony
        self.q = np.zeros((len(prony.tau), *shape))
        self.last = np.zeros(shape)

    def begin(self, dt: float) -> tuple[float, np.ndarray]:
        """Factor of the new isochoric stress and the history stress (...) for a step of ``dt``."""
        self._decay, self._gamma, factor = step_coefficients(self.prony, dt)
        weight = self.prony.beta * self._gamma
        history = np.tensordot(self._decay, self.q, axes=1) - weight.sum() * self.last
        return factor, history

    @property
    def coefficients(self) -> tuple[np.ndarray, np.ndarray]:
        """Decay (nb,) of the branches and their gain (nb,) a change of the isochoric stress, of the
        step begun last.
        """
        return self._decay, self.prony.beta * self._gamma

    def commit(self, stress: np.ndarray) -> None:
        """Accept the new isochoric stress (...) of the step begun last."""
        gain = (self.prony.beta * self._gamma).reshape(-1, *(1,) * stress.ndim)
        decay = self._decay.reshape(-1, *(1,) * stress.ndim)
        self.q = decay * self.q + gain * (stress - self.last)[None]
        self.last = np.array(stress)

    def state(self):
        return self.q, self.last

    def restore(self, state) -> None:
        self.q, self.last = state
