"""The finite-strain body: nearly incompressible, hyperelastic, total Lagrangian, with or without Prony branches.

To the isochoric energy of its laws (:mod:`fingerpad.laws`) comes kappa/2 (J - 1)^2, whose dilatation is projected on the
element's pressure modes and condensed (Simo, Taylor and Pister 1985). The tangent's geometric part uses the pressure that the
last linear step predicted (Magisano, Leonetti and Garcea 2017), which lets a whole load go on in one step.
"""

import numpy as np

from fingerpad.laws import NEO_HOOKE, Assigned
from fingerpad.mechanics import compiled
from fingerpad.mechanics.space import Space, blocked
from fingerpad.mechanics.viscoelasticity import Branches
from fingerpad.specimen.materials import Prony


class FiniteStrainBody:
    """Displacement state of a body and the verbs the stepping needs.

    Args:
        space: the discretised mesh. shear, bulk: (ne,) long-term shear and bulk moduli, Pa.
        prony: None leaves viscoelasticity out altogether.
        pointwise: volumetric modulus in units of ``shear`` that is not projected on the pressure modes; a few of them keep
            elements under an edge from folding, where det F varies wildly within one element. None leaves it out.
        laws: what the elements answer to a change of shape; None: neo-Hooke.

    Attributes:
        u: (n, 2) displacement, m; smallest_jacobian: min det F of the last evaluation.
    """

    geometrically_linear = False

    @property
    def factor(self) -> float:
        """Share of the long-term isochoric stress that answers at once in the step begun last."""
        return self._factor

    def __init__(
        self,
        space: Space,
        shear: np.ndarray,
        bulk: np.ndarray,
        prony: Prony | None = None,
        lagged=True,
        pointwise: float | None = None,
        laws: tuple[Assigned, ...] | None = None,
    ):
        self.space, self.shear, self.bulk = space, np.asarray(shear, float), np.asarray(bulk, float)
        self.u = np.zeros(space.points.shape)
        self.lagged = lagged
        self.laws = laws or everywhere_neo_hooke(len(space.cells))
        self._loops = [
            (compiled.loops(part.law, *space.sizes), np.ascontiguousarray(part.constants.T), space.blocks(part.elements))
            for part in self.laws
        ]
        self._dilatation = np.zeros((len(space.cells), space.psi.shape[2]))
        self._lag, self._predicted = self._dilatation.copy(), None
        undeformed = blocked(np.tile([[1.0], [1.0], [0.0], [0.0]], (*space.weight.shape[:1], 1, space.weight.shape[1])))
        self.branches = Branches(prony, undeformed.shape) if prony else None
        self._factor, self._history = 1.0, None
        self.branch_work = 0.0
        self._stretch = np.ascontiguousarray(undeformed[:, :3]) if prony else None
        self._pointwise = None if pointwise is None else pointwise * self.shear
        self.smallest_jacobian = 1.0
        self._data = None

    def begin_step(self, dt: float) -> None:
        """Prepare a step of ``dt`` seconds (None: no time passes)."""
        if self.branches is not None:
            self._factor, self._history = self.branches.begin(dt)

    def displace(self, u: np.ndarray, lag: np.ndarray | None = None) -> np.ndarray:
        """Put the body at ``u`` (a predictor); the lagged dilatation becomes that of ``u`` unless given.

        Returns the internal force there (n, 2) N/m, in the step begun last.
        """
        self.u = np.array(u)
        force = self.internal_force()
        self._lag, self._predicted = self._dilatation.copy() if lag is None else lag, None
        return force

    def internal_force(self) -> np.ndarray:
        """(n, 2) N/m at the current displacement."""
        force = np.zeros_like(self.u)
        self.smallest_jacobian = min(
            loops.internal_force(
                self.u, self.space.mesh, self.shear, self.bulk, *part, self._history, self._factor, self._pointwise, force,
                self._dilatation,
            )
            for loops, *part in self._loops
        )  # fmt: skip
        return force

    def tangent(self) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients of the pattern (nonzeros + 1,) and internal force (n, 2) at the current displacement."""
        if self._data is None:
            self._data = self.space.pattern.new_data()
        self._data[:] = 0
        force = np.zeros_like(self.u)
        if self._predicted is not None:
            compiled.dilatation_loop(*self.space.sizes)(*self._predicted, self.space.mesh, self._lag)
            self._predicted = None
        lag = self._lag if self.lagged else self._dilatation
        self.smallest_jacobian = min(
            loops.assemble_tangent(
                self.u, self.space.mesh, self.shear, self.bulk, *part, lag, self._history, self._factor, self._pointwise,
                self.space.pattern.scatter, self._data, force,
            )
            for loops, *part in self._loops
        )  # fmt: skip
        return self._data, force

    def linearise(self, solver) -> tuple[np.ndarray, np.ndarray]:
        """Factor the tangent; returns the Schur complement (nc, nc) and the internal force (n, 2)."""
        data, force = self.tangent()
        return solver.factor(data), force

    def advance(self, du: np.ndarray, share: float = 1.0) -> None:
        """Accept ``share`` of the linear step ``du`` (n, 2); the predicted dilatation becomes the next lag."""
        self._predicted = self.u, share * du  # worked out only when a tangent is asked for
        self.u = self.u + share * du

    def commit(self) -> None:
        """The step has converged: let the branches move on, and add up the work that was done on them."""
        if self.branches is not None:
            branches = self.branches
            before = branches.q, branches.last, self._stretch
            after = [np.empty_like(each) for each in before]
            for each in after:
                each[..., -1, :, :, :] = 0.0  # the last block may have room for more elements than there are
            self.branch_work += sum(
                loops.commit(self.u, self.space.mesh, self.shear, *part, *branches.coefficients, *before, *after)
                for loops, *part in self._loops
            )
            branches.restore(after[:2])
            self._stretch = after[2]

    def dilatation(self) -> np.ndarray:
        """(ne, nm) modes of J - 1; the pressure is kappa times them."""
        return self._dilatation

    def save(self):
        """Everything needed to come back to this state."""
        history = self.branches and (self.branches.state(), self.branch_work, self._stretch)
        return self.u.copy(), self._dilatation.copy(), history

    def restore(self, state) -> None:
        """Come back to a saved state."""
        self.u, self._dilatation = (np.array(part) for part in state[:2])
        self._lag, self._predicted = self._dilatation.copy(), None
        if self.branches is not None:
            branches, self.branch_work, self._stretch = state[2]
            self.branches.restore(branches)

    def energies(self) -> tuple[float, float, float]:
        """Network energy, Maxwell-spring energy and the work done on the branches so far, J/m.

        Branch work less spring energy is what the dashpots have dissipated. The work is the integral of the branches' second
        Piola-Kirchhoff stress over the Green strain, by the trapezoidal rule, so a hold of any length adds none.
        """
        springs = (None, None) if self.branches is None else (self.branches.prony.beta, self.branches.q)
        network, spring = np.sum(
            [
                loops.energies(self.u, self.space.mesh, self.shear, self.bulk, *part, self._pointwise, self._dilatation, *springs)
                for loops, *part in self._loops
            ],
            axis=0,
        )
        return float(network), float(spring), self.branch_work


def everywhere_neo_hooke(count: int) -> tuple[Assigned, ...]:
    """The law of ``count`` elements of which nothing else is said."""
    return (Assigned(NEO_HOOKE, np.zeros((count, 0)), np.ones(count, bool)),)


def isochoric_stress(laws: tuple[Assigned, ...], u, cells, grad, shear) -> np.ndarray:
    """Isochoric second Piola-Kirchhoff stress (np, 4) at points: 11, 22, 12, 33, Pa.

    Args:
        laws: at the points. u: (n, 2) m. cells: (np, nen). grad: (np, nen, 2) 1/m. shear: (np,) long-term moduli, Pa.
    """
    out = np.empty((len(cells), 4))
    for part in laws:
        compiled.stress_loop(part.law)(u, cells, grad, shear, part.constants, part.elements, out)
    return out


def isochoric_energy(laws: tuple[Assigned, ...], f: np.ndarray, shear: np.ndarray) -> np.ndarray:
    """Energy density of shape (ne, ...), Pa, at deformation gradients (ne, ..., 2, 2); shear: (ne,) or (ne, 1), Pa."""
    i1, jac = np.sum(f * f, axis=(-2, -1)) + 1, f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]
    out = np.zeros(i1.shape)
    for part in laws:
        here = part.elements
        constants = part.constants[here].T.reshape(len(part.law.constants), *shear[here].shape)
        out[here] = part.law.energy(i1[here], jac[here], shear[here], constants)
    return out


def push_forward(f: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Kirchhoff stress F S F^T (..., 4) of a second Piola-Kirchhoff stress (..., 4: 11, 22, 12, 33) in plane strain."""
    f11, f12, f21, f22 = f[..., 0, 0], f[..., 0, 1], f[..., 1, 0], f[..., 1, 1]
    s11, s22, s12, s33 = np.moveaxis(s, -1, 0)
    a11, a12, a21, a22 = f11 * s11 + f12 * s12, f11 * s12 + f12 * s22, f21 * s11 + f22 * s12, f21 * s12 + f22 * s22
    return np.stack([a11 * f11 + a12 * f12, a21 * f21 + a22 * f22, a11 * f21 + a12 * f22, s33], axis=-1)


def deviator_square(t: np.ndarray) -> np.ndarray:
    """dev t : dev t of symmetric tensors (..., 4: 11, 22, 12, 33)."""
    t11, t22, t12, t33 = np.moveaxis(t, -1, 0)
    mean = (t11 + t22 + t33) / 3
    return (t11 - mean) ** 2 + (t22 - mean) ** 2 + (t33 - mean) ** 2 + 2 * t12**2
