"""The weak form that is solved, and its tangent, as one writes them down: in scikit-fem's form
language.

Find the displacement u of the reference body, with F = I + grad u, I1 = tr C, J = det F in three
dimensions (F33 = 1, or 1 + u_r / R in a body of revolution, whose volume is 2 pi R times that of
its section), such that

    int P : grad v = external(v) for every v,      P = a P_iso(F) + p cof F + F H
    P_iso = d psi / dF,  psi = W(J^(-2/3) I1, J^(-4/3) I2)
    p = kappa theta,  theta = projection of J - 1 on the modes q

The projection (Simo, Taylor and Pister 1985) is element by element, ``sum_b G_ab theta_b = int q_a
(J - 1)`` with ``G_ab`` = ``int q_a q_b``; a share k (J - 1) of the pressure may be left
unprojected. Prony branches of a step enter through the factor a and the history H, a second
Piola-Kirchhoff stress (Simo 1987). The tangent is the derivative of P, with the pressure that the
linear step before predicted in its geometric part (Magisano, Leonetti and Garcea 2017):

    int (d(a P_iso + F H) + p_lag d(cof F)) : grad v + sum_ab kappa G^-1_ab (int q_a cof F : grad
    du) (int q_b cof F : grad v)

For small strain P = 2 mu a dev eps(u) + p I + H and theta is the projection of div u. Nothing here
is compiled, condensed or shared with the solver, whose element loops the tests hold to it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace

import numpy as np
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad0,
    ElementQuad1,
    ElementQuad2,
    ElementTriP0,
    ElementTriP2,
    ElementTriP2B,
    ElementVector,
    LinearForm,
    MeshQuad1,
    MeshQuad2,
    MeshTri1,
    MeshTri2,
)
from skfem.helpers import ddot, grad, trace

_STEP = 1e-30  # of the complex-step derivatives, exact to round-off


class NodalBubble(ElementTriP2B):
    """Quadratic triangle whose bubble is the shape function of a node at the centroid (Crouzeix and
    Raviart 1973).
    """

    def lbasis(self, X, i):
        value, slope = super().lbasis(X, i)
        bubble, steep = super().lbasis(X, 6)
        at_centroid = 0.0 if i == 6 else -1 / 9 if i < 3 else 4 / 9
        return value - at_centroid * bubble, slope - at_centroid * steep


#: Displacement element, degree of the quadrature and number of pressure modes (None: one a
#: quadrature point), by name.
ELEMENTS = {
    "Q2P1": (ElementQuad2, 5, 3),
    "Q2": (ElementQuad2, 5, None),
    "Q2R": (ElementQuad2, 3, None),
    "Q1P0": (ElementQuad1, 3, 1),
    "Q1": (ElementQuad1, 3, None),
    "P2B": (NodalBubble, 5, 3),
    "P2": (ElementTriP2, 4, None),
}


def gradient(v, w):
    """Of a field in the section, in three dimensions."""
    plane = grad(v)
    out = np.zeros((3, 3, *plane.shape[2:]), plane.dtype)
    out[:2, :2], out[2, 2] = plane, w.round * v[0] / w.x[0]
    return out


def measure(w):
    """Of what lies across the section."""
    return 1 + w.round * (2 * np.pi * w.x[0] - 1)


def identity(f):
    return np.eye(3).reshape(3, 3, 1, 1) + 0 * f


def cofactor(f):
    """By the rule of Sarrus, which takes complex steps."""
    rows = [np.cross(f[(i + 1) % 3], f[(i + 2) % 3], axis=0) for i in range(3)]
    return np.array(rows)


def determinant(f):
    return np.einsum("j...,j...->...", f[0], cofactor(f)[0])


def product(a, b):
    return np.einsum("ij...,jk...->ik...", a, b)


def isochoric_stress(f, slopes):
    """dW/dF (3, 3, ...) of W(J^(-2/3) I1, J^(-4/3) I2); ``slopes`` gives W's two derivatives at its
    two arguments, Pa.
    """
    c, j = product(np.swapaxes(f, 0, 1), f), determinant(f)
    i1 = trace(c)
    i2 = (i1**2 - trace(product(c, c))) / 2
    first, second = slopes(j ** (-2 / 3) * i1, j ** (-4 / 3) * i2)
    transposed_inverse = cofactor(f) / j
    change_1 = 2 * j ** (-2 / 3) * (f - i1 / 3 * transposed_inverse)
    change_2 = 2 * j ** (-4 / 3) * (i1 * f - product(f, c) - 2 * i2 / 3 * transposed_inverse)
    return first * change_1 + second * change_2


def strain(v, w):
    slope = gradient(v, w)
    return (slope + np.swapaxes(slope, 0, 1)) / 2


def deviator(e):
    return e - trace(e) / 3 * identity(e)


def deformation_gradient(w):
    return identity(gradient(w.u, w)) + gradient(w.u, w)


def stress(f, w, slopes):
    return (
        w.a * isochoric_stress(f, slopes)
        + (w.p + w.k * (determinant(f) - 1)) * cofactor(f)
        + product(f, w.h)
    )


def internal_force(slopes):
    def form(v, w):
        return measure(w) * ddot(stress(deformation_gradient(w), w, slopes), gradient(v, w))

    return LinearForm(form)


def tangent(slopes):
    def form(du, v, w):
        f = deformation_gradient(w) + 1j * _STEP * gradient(du, w)
        return measure(w) * ddot(np.imag(stress(f, w, slopes)) / _STEP, gradient(v, w))

    return BilinearForm(form)


@BilinearForm
def dilatation_change(du, q, w):
    return measure(w) * q * w.mode * ddot(cofactor(deformation_gradient(w)), gradient(du, w))


@LinearForm
def dilatation(q, w):
    return measure(w) * q * w.mode * (determinant(deformation_gradient(w)) - 1)


@BilinearForm
def linear_shape(u, v, w):
    return measure(w) * 2 * w.mu * ddot(deviator(strain(u, w)), strain(v, w))


@BilinearForm
def linear_dilatation(u, q, w):
    return measure(w) * q * w.mode * trace(gradient(u, w))


@LinearForm
def gram(q, w):
    return measure(w) * q * w.mode * w.other


@dataclass(frozen=True)
class WeakForm:
    """The forms on one mesh.

    Parameters
    ----------
    points
        (n, 2) m.
    cells
        (ne, nodes) in the order of gmsh.
    element
        Key of :data:`ELEMENTS`.
    kappa, pointwise
        (ne,) Pa.
    axisymmetric
        Whether the mesh is turned about x = 0.
    """

    points: np.ndarray
    cells: np.ndarray
    element: str
    kappa: np.ndarray
    pointwise: np.ndarray | float = 0.0
    axisymmetric: bool = False

    @cached_property
    def basis(self) -> Basis:
        """Of the displacement."""
        shape, degree, _ = ELEMENTS[self.element]
        quad, linear = "Q" in self.element, shape is ElementQuad1
        corners = self.cells[:, : 4 if quad else 3]
        used, numbered = np.unique(corners, return_inverse=True)
        mesh = (MeshQuad1 if quad else MeshTri1)(
            self.points[used].T, numbered.reshape(corners.shape).T, sort_t=False
        )
        if not linear:
            mesh = (MeshQuad2 if quad else MeshTri2).from_mesh(mesh)
            numbers = mesh.dofs.element_dofs
            mesh.doflocs[:, numbers] = self.points[self.cells[:, : len(numbers)]].transpose(2, 1, 0)
        return Basis(mesh, ElementVector(shape()), intorder=degree)

    @cached_property
    def numbers(self) -> np.ndarray:
        """(n, 2) scikit-fem's number of each nodal displacement."""
        out = np.zeros(self.points.shape, int)
        out[self.cells] = self.basis.element_dofs.T.reshape(*self.cells.shape, 2)
        return out

    @cached_property
    def modes(self) -> list[np.ndarray]:
        """Pressure modes at the quadrature points, (ne, nq) each: 1, x and y about the element's
        middle, or one a point.
        """
        count, x = ELEMENTS[self.element][2], self.basis.global_coordinates()
        if count is None:
            return [
                np.broadcast_to(point, self.basis.dx.shape)
                for point in np.eye(self.basis.dx.shape[1])
            ]
        local = np.asarray(x) - np.asarray(x).mean(2, keepdims=True)
        return [np.ones(self.basis.dx.shape), *(local / np.abs(local).max())][:count]

    @cached_property
    def _pressure(self):
        element = ElementQuad0() if "Q" in self.element else ElementTriP0()
        pressure = Basis(self.basis.mesh, element, quadrature=self.basis.quadrature)
        modes, turned = self.modes, float(self.axisymmetric)
        table = [
            [gram.assemble(pressure, mode=a, other=b, round=turned) for b in modes] for a in modes
        ]
        return pressure, np.linalg.inv(np.moveaxis(np.array(table), -1, 0))

    def deformation(self, u: np.ndarray) -> np.ndarray:
        """Deformation gradient (3, 3, ne, nq) of the displacement (n, 2)."""
        field = self.field(u)
        where = SimpleNamespace(
            u=field, x=np.asarray(self.basis.global_coordinates()), round=float(self.axisymmetric)
        )
        return deformation_gradient(where)

    def field(self, u: np.ndarray):
        """The displacement (n, 2) as scikit-fem interpolates it."""
        vector = np.zeros(self.basis.N)
        vector[self.numbers] = u
        return self.basis.interpolate(vector)

    def theta(self, u: np.ndarray) -> np.ndarray:
        """Projected dilatation at the quadrature points (ne, nq) of finite strain."""
        pressure, inverse = self._pressure
        fields = {"u": self.field(u), "round": float(self.axisymmetric)}
        moments = np.array(
            [dilatation.assemble(pressure, **fields, mode=mode) for mode in self.modes]
        )
        return np.einsum("aeq,eab,be->eq", np.array(self.modes), inverse, moments)

    def _fields(self, u, theta, history):
        field, pointwise = (
            self.field(u),
            np.broadcast_to(self.pointwise, len(self.cells))[:, None] + 0 * theta,
        )
        return {
            "u": field,
            "p": self.kappa[:, None] * theta,
            "k": pointwise,
            "h": history + np.zeros((3, 3, *field.grad.shape[2:])),
            "round": float(self.axisymmetric),
        }

    def _projected(self, form, **fields):
        """sum_ab kappa G^-1_ab B_a B_b of the form B that gives the moments of a dilatation."""
        pressure, inverse = self._pressure
        fields["round"] = float(self.axisymmetric)
        moments = [form.assemble(self.basis, pressure, mode=mode, **fields) for mode in self.modes]
        weights = self.kappa[:, None, None] * inverse
        return sum(
            left.T @ right.multiply(weights[:, a, b][:, None])
            for a, left in enumerate(moments)
            for b, right in enumerate(moments)
        )

    def force(
        self,
        u: np.ndarray,
        slopes: Callable,
        factor: float = 1.0,
        history: np.ndarray | float = 0.0,
    ) -> np.ndarray:
        """Internal force (n, 2) of finite strain; history: (3, 3, ne, nq) Pa."""
        fields = self._fields(u, self.theta(u), history)
        return internal_force(slopes).assemble(self.basis, **fields, a=factor)[self.numbers]

    def stiffness(
        self, u, slopes, lag: np.ndarray, factor: float = 1.0, history: np.ndarray | float = 0.0
    ) -> np.ndarray:
        """Tangent (2n, 2n: x and y of each node) of finite strain; lag: (ne, nq), the dilatation
        that was predicted.
        """
        fields = self._fields(u, lag, history)
        shape = tangent(slopes).assemble(self.basis, **fields, a=factor)
        return self._numbered(shape + self._projected(dilatation_change, u=fields["u"]))

    def linear_stiffness(self, mu: np.ndarray, factor: float = 1.0) -> np.ndarray:
        """Tangent (2n, 2n) of small strain; mu: (ne,) Pa."""
        return self._numbered(
            linear_shape.assemble(
                self.basis,
                mu=factor * mu[:, None] + 0 * self.basis.dx,
                round=float(self.axisymmetric),
            )
            + self._projected(linear_dilatation)
        )

    def _numbered(self, matrix):
        order = self.numbers.ravel()
        return matrix.toarray()[np.ix_(order, order)]
