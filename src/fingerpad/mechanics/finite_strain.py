"""The finite-strain body: nearly incompressible, hyperelastic, total Lagrangian, with or without
Prony branches.

To the isochoric energy of its laws (:mod:`fingerpad.laws`) comes that of a dilatation ``d`` of its
own, in the element's pressure modes, which the projection ``v`` of J - 1 is to equal (Simo, Taylor
and Pister 1985): kappa (d v - d^2/2), the pressure being kappa d. Newton's method, with the tangent
of a state ``0`` that need not be the present one, is

    (K + kappa B0^T B0) du = -f(u, d) - kappa B0^T (v(u) - d),    d <- v(u) + B0 du,    B = dv/du,

so that pressure is found by equilibrium, and never as kappa times a small difference of
displacements: what ``v`` and ``d`` still differ by after a step is a change of volume too small to
matter long before it is a force too small to matter. The geometric part of a tangent uses the
pressure that the last linear step found (Magisano, Leonetti and Garcea 2017), which lets a whole
load go on in one step.
"""

import numpy as np

from fingerpad.laws import NEO_HOOKE, Assigned
from fingerpad.mechanics import kernels
from fingerpad.mechanics.kinematics import Kinematics
from fingerpad.mechanics.space import TOGETHER, Space
from fingerpad.mechanics.viscoelasticity import Branches
from fingerpad.specimen.materials import Prony


class FiniteStrainBody:
    """Displacement state of a body, and what the stepping asks of it.

    Parameters
    ----------
    space : Space
        The discretised mesh.
    shear, bulk : (ne,) Pa
        Long-term shear and bulk moduli.
    prony : Prony, optional
        Viscoelasticity; none without.
    pointwise : float, optional
        Volumetric modulus, in units of ``shear``, that is not projected on the pressure modes. A
        few of them keep elements under an edge from folding, where det F varies much within one.
    laws : sequence, optional
        What the elements answer to a change of shape (default: neo-Hooke).
    lagged : bool
        False: pressures follow displacement at once. This is plain Newton's method, to check the
        other.

    Attributes
    ----------
    u : (n, 2) m
        Displacement.
    factor : float
        Share of the long-term isochoric stress that answers at once in the step begun last.
    smallest_jacobian : float
        Smallest det F of the last evaluation.
    """

    geometrically_linear = False

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
        require_of_one_invariant(self.laws, space.kinematics)
        self._loops = [
            (
                kernels.loops(part.law, space.kinematics, *space.sizes),
                np.ascontiguousarray(part.constants.T),
                space.blocks(part.elements),
            )
            for part in self.laws
        ]
        self._volume = np.zeros((len(space.cells), space.psi.shape[2]))
        self._dilatation = self._volume.copy()
        undeformed = np.zeros((len(space.mesh[3]), 4, *space.weight.shape[1:], TOGETHER))
        undeformed[:, [0, 1, 3]] = 1.0
        self._history = np.zeros(undeformed.shape)
        self._stretch = undeformed
        self.branches = Branches(prony, undeformed.shape) if prony else None
        self.factor, self.branch_work, self.smallest_jacobian = 1.0, 0.0, 1.0
        self._pointwise = (pointwise or 0.0) * self.shear
        self._data = space.pattern.new_data()
        #: Derivative of the volume at the tangent made last, (ne nm, 2 n).
        self.rates = space.volume_rates()

    def begin_step(self, dt: float) -> None:
        """Prepare a step of ``dt`` seconds (None: no time passes)."""
        if self.branches is not None:
            self.factor, self._history = self.branches.begin(dt)

    def displace(self, u: np.ndarray, dilatation: np.ndarray | None = None) -> np.ndarray:
        """Put the body at ``u`` (a predictor); the dilatation (ne, nm) becomes that of ``u`` unless
        given.

        Returns the internal force there (n, 2) N/m, in the step begun last.
        """
        self.u = np.array(u)
        self._dilatation = self._volume if dilatation is None else np.array(dilatation)
        force = self.internal_force()
        if dilatation is None:
            self._dilatation = self._volume.copy()
        return force

    def _run(self, loop: str, *out) -> None:
        """Run a loop over the elements of every law, into ``out``."""
        dilatation = self._dilatation if self.lagged else self._volume
        pressures = dilatation, self._volume, self._history, self.factor, self._pointwise
        self.smallest_jacobian = min(
            getattr(loops, loop)(
                self.u, self.space.mesh, self.shear, self.bulk, *part, *pressures, *out
            )
            for loops, *part in self._loops
        )

    def internal_force(self) -> np.ndarray:
        """(n, 2) N/m (N of a body of revolution) at the current displacement and dilatation."""
        force = np.zeros_like(self.u)
        self._run("internal_force", force)
        if not self.lagged:
            self._dilatation = self._volume.copy()
        return force

    def tangent(self) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients of the pattern (nonzeros + 1,) at the current displacement, and the force
        (n, 2) that goes with them: the internal one and kappa B^T (v - d), which together are that
        of a dilatation that is the displacement's.
        """
        self._data[:] = 0
        force = np.zeros_like(self.u)
        rates = self.rates.data.reshape(*self._volume.shape, 2, -1)
        scatter = self.space.pattern.scatter
        self._run("assemble_tangent", force, scatter, self._data, rates)
        return self._data, force

    def linearise(self, solver) -> tuple[np.ndarray, np.ndarray]:
        """Factor the tangent; returns the Schur complement (nc, nc) and the force (n, 2) that goes
        with it.
        """
        data, force = self.tangent()
        return solver.factor(data), force

    def against(self, internal: np.ndarray) -> np.ndarray:
        """The force (n, 2) that goes with the tangent that was factored last, wherever that was, of
        the ``internal`` one here.
        """
        pressures = self.bulk[:, None] * (self._volume - self._dilatation)
        return internal + (self.rates.T @ pressures.ravel()).reshape(internal.shape)

    def advance(self, du: np.ndarray, share: float = 1.0) -> None:
        """Accept ``share`` of the linear step ``du`` (n, 2), and the dilatation that it leads
        to.
        """
        step = share * du
        self._dilatation = self._volume + (self.rates @ step.ravel()).reshape(self._volume.shape)
        self.u = self.u + step

    def volume_amiss(self) -> tuple[float, float]:
        """What the displacement's dilatation and its own differ by, and its own, as norms of
        pressures (N).
        """
        bulk = self.bulk[:, None]
        return float(np.linalg.norm(bulk * (self._volume - self._dilatation))), float(
            np.linalg.norm(bulk * self._dilatation)
        )

    def commit(self) -> None:
        """The step has converged: let the branches move on, and add up the work that was done on
        them.
        """
        if self.branches is not None:
            branches = self.branches
            before = branches.q, branches.last, self._stretch
            # the last block may have room for more elements than there are, which stays empty
            after = [np.zeros(values.shape) for values in before]
            self.branch_work += sum(
                loops.commit(
                    self.u,
                    self.space.mesh,
                    self.shear,
                    *part,
                    *branches.coefficients,
                    *before,
                    *after,
                )
                for loops, *part in self._loops
            )
            branches.restore(after[:2])
            self._stretch = after[2]

    def dilatation(self) -> np.ndarray:
        """(ne, nm) modes of the dilatation; the pressure is kappa times them."""
        return self._dilatation

    @property
    def pressed(self) -> np.ndarray:
        """What a state is of beside its displacement: :meth:`dilatation`."""
        return self._dilatation

    def save(self):
        """Everything needed to come back to this state."""
        history = self.branches and (self.branches.state(), self.branch_work, self._stretch)
        return self.u.copy(), self._dilatation.copy(), self._volume.copy(), history

    def restore(self, state) -> None:
        """Come back to a saved state."""
        self.u, self._dilatation, self._volume = (np.array(part) for part in state[:3])
        if self.branches is not None:
            branches, self.branch_work, self._stretch = state[3]
            self.branches.restore(branches)

    def energies(self) -> tuple[float, float, float]:
        """Network energy, Maxwell-spring energy and the work done on the branches so far, J/m.

        Branch work less spring energy is what the dashpots have dissipated. The work is the
        integral of the branches' second Piola-Kirchhoff stress over the Green strain, by the
        trapezoidal rule, so a hold of any length adds none.
        """
        beta, stress = np.empty(0), self._history[None][:0]
        if self.branches is not None:
            beta, stress = self.branches.prony.beta, self.branches.q
        network, spring = np.sum(
            [
                loops.energies(
                    self.u, self.space.mesh, self.shear, *part, self._pointwise, beta, stress
                )
                for loops, *part in self._loops
            ],
            axis=0,
        )
        volumetric = self.bulk @ np.sum(
            self._dilatation * (self._volume - 0.5 * self._dilatation), axis=1
        )
        return float(network + volumetric), float(spring), self.branch_work


def everywhere_neo_hooke(count: int) -> tuple[Assigned, ...]:
    """The law of ``count`` elements of which nothing else is said."""
    return (Assigned(NEO_HOOKE, np.zeros((count, 0)), np.ones(count, bool)),)


def require_of_one_invariant(laws: tuple[Assigned, ...], kinematics: Kinematics) -> None:
    """ValueError for a law that is more than a function of J^(-2/3) I1, whose formulas are those of
    plane strain alone, in a body of revolution.
    """
    for law in {part.law for part in laws if kinematics.round}:
        constants = np.array([each.default for each in law.constants.values()])
        if abs(law.stress(3.3, 1.1, 1.0, constants)[1] - 3.3) > 1e-9:
            raise ValueError(f"law {law.name}: is one of plane strain, not of a body of revolution")


def isochoric_stress(laws: tuple[Assigned, ...], f, hoop, shear) -> np.ndarray:
    """Isochoric second Piola-Kirchhoff stress (np, 4) at points: 11, 22, 12, 33, Pa.

    Parameters
    ----------
    laws
        At the points.
    f, hoop
        (np, 2, 2) and (np,) deformation gradient in the section and across it.
    shear
        (np,) long-term moduli, Pa.
    """
    c = f.swapaxes(-1, -2) @ f
    i1, jac = _invariants(f, hoop)
    out = np.empty((len(f), 4))
    for part in laws:
        here, flat = part.elements, jac[part.elements] / hoop[part.elements]
        mod, t = part.law.stress(i1[here], jac[here], shear[here], part.constants[here].T)
        cofactor = np.stack(
            [c[here, 1, 1], c[here, 0, 0], -c[here, 0, 1], (flat / hoop[here]) ** 2], axis=1
        )
        share = t / (3 * flat**2)
        out[here] = mod[:, None] * ([1, 1, 0, 1] - share[:, None] * cofactor)
    return out


def isochoric_energy(laws: tuple[Assigned, ...], f, hoop, shear: np.ndarray) -> np.ndarray:
    """Energy density (np,), Pa, at deformation gradients (np, 2, 2) in the section and (np,) across
    it; shear: (np,) Pa.
    """
    i1, jac = _invariants(f, hoop)
    out = np.zeros(i1.shape)
    for part in laws:
        here = part.elements
        constants = part.constants[here].T
        out[here] = part.law.energy(i1[here], jac[here], shear[here], constants)
    return out


def _invariants(f, hoop):
    """I1 and J (...) of deformation gradients (..., 2, 2) in the section and (...) across it."""
    flat = f[..., 0, 0] * f[..., 1, 1] - f[..., 0, 1] * f[..., 1, 0]
    return np.sum(f * f, axis=(-2, -1)) + hoop**2, flat * hoop


def push_forward(f: np.ndarray, hoop, s: np.ndarray) -> np.ndarray:
    """Kirchhoff stress F S F^T (..., 4) of a second Piola-Kirchhoff stress (..., 4: 11, 22, 12,
    33).
    """
    f11, f12, f21, f22 = f[..., 0, 0], f[..., 0, 1], f[..., 1, 0], f[..., 1, 1]
    s11, s22, s12, s33 = np.moveaxis(s, -1, 0)
    a11, a12, a21, a22 = (
        f11 * s11 + f12 * s12,
        f11 * s12 + f12 * s22,
        f21 * s11 + f22 * s12,
        f21 * s12 + f22 * s22,
    )
    across = s33 * hoop**2
    return np.stack(
        [a11 * f11 + a12 * f12, a21 * f21 + a22 * f22, a11 * f21 + a12 * f22, across], axis=-1
    )


def deviator_square(t: np.ndarray) -> np.ndarray:
    """dev t : dev t of symmetric tensors (..., 4: 11, 22, 12, 33)."""
    t11, t22, t12, t33 = np.moveaxis(t, -1, 0)
    mean = (t11 + t22 + t33) / 3
    return (t11 - mean) ** 2 + (t22 - mean) ** 2 + (t33 - mean) ** 2 + 2 * t12**2
