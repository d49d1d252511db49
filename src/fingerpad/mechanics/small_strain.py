"""The small-strain body: the linearisation of the finite one, its own and cheaper path.

The tangent is constant and factored once for each step size. A Prony branch of a linear body needs
no tensors at quadrature points: it is a *branch displacement* v with ``v(t + dt) = exp(-dt/tau)
v(t) + gamma (u(t + dt) - u(t))`` whose stress is beta times the deviatoric stress of v.
"""

import numpy as np
from scipy.sparse import eye

from fingerpad.laws import Assigned
from fingerpad.mechanics.finite_strain import FiniteStrainBody, everywhere_neo_hooke
from fingerpad.mechanics.space import Space
from fingerpad.mechanics.viscoelasticity import step_coefficients
from fingerpad.specimen.materials import Prony


class SmallStrainBody:
    """Linear body with the verbs of :class:`~fingerpad.mechanics.finite_strain.FiniteStrainBody`
    (same arguments).
    """

    geometrically_linear = True
    smallest_jacobian = 1.0
    pressed = 0.0  # a state is of its displacement alone

    def __init__(
        self,
        space: Space,
        shear: np.ndarray,
        bulk: np.ndarray,
        prony: Prony | None = None,
        laws: tuple[Assigned, ...] | None = None,
    ):
        self.space, self.prony = space, prony
        self.shear, self.bulk = np.asarray(shear, float), np.asarray(bulk, float)
        self.laws = laws or everywhere_neo_hooke(len(space.cells))
        self.u = np.zeros(space.points.shape)
        self.v = np.zeros((len(prony.tau) if prony else 0, *self.u.shape))
        self._last = self.u.copy()
        self.factor, self.branch_work = 1.0, 0.0
        # with nothing prescribed but nodes that belong to no element
        alone = np.ones_like(space.fixed)
        alone[space.cells] = False
        mesh, kind = (space.points, space.cells), space.element
        everywhere = Space(*mesh, kind.kind, alone, kind.name, space.kinematics)
        pick = eye(alone.size, format="csr")[~alone.ravel()]
        self._free, self._rates = self._tangents(space)
        self._deviatoric, self._volumetric = (
            pick.T @ everywhere.pattern.matrix(data) @ pick
            for data in self._tangents(everywhere)[0]
        )
        self._factored: tuple | None = None
        self._history = np.zeros_like(self.u)

    def _tangents(self, space):
        """Tangents of the finite body at rest, of the change of shape and of volume alone; and the
        derivative of its volume.
        """
        bodies = [
            FiniteStrainBody(space, shape * self.shear, volume * self.bulk, laws=self.laws)
            for shape, volume in np.eye(2)
        ]
        return [body.tangent()[0] for body in bodies], bodies[0].rates

    def begin_step(self, dt: float) -> None:
        """Prepare a step of ``dt`` seconds."""
        if self.prony:
            self._decay, self._gamma, self.factor = step_coefficients(self.prony, dt)
            beta = self.prony.beta
            self._history = (
                np.tensordot(beta * self._decay, self.v, axes=1)
                - np.sum(beta * self._gamma) * self._last
            )

    def displace(self, u: np.ndarray, dilatation=None) -> np.ndarray:
        self.u = np.array(u)
        return self.internal_force()

    def internal_force(self) -> np.ndarray:
        """(n, 2) N/m at the current displacement."""
        answering = (self.factor * self.u + self._history).ravel()
        return (self._deviatoric @ answering + self._volumetric @ self.u.ravel()).reshape(
            self.u.shape
        )

    def stiffness(self) -> np.ndarray:
        """Coefficients of the pattern (nonzeros + 1,) of the step begun last."""
        return self.factor * self._free[0] + self._free[1]

    def linearise(self, solver) -> tuple[np.ndarray, np.ndarray]:
        """Schur complement (nc, nc), factored anew only for a new step size or contact zone, and
        internal force (n, 2).
        """
        key = (id(solver), self.factor)
        if self._factored is None or self._factored[0] != key:
            self._data = self.stiffness()
            self._factored = (key, solver.factor(self._data), solver)
        return self._factored[1].copy(), self.internal_force()

    def against(self, internal: np.ndarray) -> np.ndarray:
        """The force that goes with the tangent: the ``internal`` one."""
        return internal

    def volume_amiss(self) -> tuple[float, float]:
        """Nothing: pressures are those of the displacement."""
        return 0.0, 0.0

    def advance(self, du: np.ndarray, share: float = 1.0) -> None:
        self.u = self.u + share * du

    def commit(self) -> None:
        """The step has converged: let the branch displacements move on, and add up the work that
        was done on them.
        """
        if self.prony:
            decay, gamma = self._decay[:, None, None], self._gamma[:, None, None]
            step = self.u - self._last
            before, self.v = self.v, decay * self.v + gamma * step
            mean = np.tensordot(self.prony.beta, 0.5 * (before + self.v), axes=1)
            self.branch_work += float(mean.ravel() @ (self._deviatoric @ step.ravel()))
        self._last = self.u.copy()

    def dilatation(self) -> np.ndarray:
        """(ne, nm) modes of div u."""
        return (self._rates @ self.u.ravel()).reshape(len(self.space.cells), -1)

    def save(self):
        """Everything needed to come back to this state."""
        return self.u.copy(), self.v.copy(), self._last.copy(), self.branch_work

    def restore(self, state) -> None:
        """Come back to a saved state."""
        self.u, self.v, self._last = (part.copy() for part in state[:3])
        self.branch_work = state[3]

    def energies(self) -> tuple[float, float, float]:
        """Network energy, Maxwell-spring energy and the work done on the branches so far
        (trapezoidal rule), J/m.
        """
        u = self.u.ravel()
        network = 0.5 * u @ (self._deviatoric @ u + self._volumetric @ u)
        spring = 0.0
        if self.prony:
            for beta, v in zip(self.prony.beta, self.v, strict=True):
                spring += 0.5 * beta * float(v.ravel() @ (self._deviatoric @ v.ravel()))
        return float(network), spring, self.branch_work
