"""Neo-Hooke: ``psi = mu/2 (J^(-2/3) I1 - 3)`` (Rivlin 1948, made isochoric as by Simo, Taylor and
Pister 1985).
"""

from fingerpad.laws.law import Law, isochoric


def energy(i1, jac, mu, constants):
    return 0.5 * mu * (isochoric(jac) * i1 - 3)


def stress(i1, jac, mu, constants):
    return mu * isochoric(jac), i1


def tangent(i1, jac, mu, constants):
    m = mu * isochoric(jac)
    return m, i1, 0.0, -2.0 * m / (3.0 * jac), 5.0 * m * i1 / (9.0 * jac * jac)


LAW = Law("neo_hooke", energy, stress, tangent, bilinear=True)
