"""Yeoh (1993): ``psi = mu/2 (x + second x^2 + third x^3)``, ``x = J^(-2/3) I1 - 3``: tissue that
stiffens as it is strained.
"""

from fingerpad.laws.law import Constant, Law, isochoric


def energy(i1, jac, mu, constants):
    x = isochoric(jac) * i1 - 3.0
    return 0.5 * mu * x * (1.0 + x * (constants[0] + x * constants[1]))


def stress(i1, jac, mu, constants):
    j = isochoric(jac)
    x = j * i1 - 3.0
    return mu * j * (1.0 + x * (2.0 * constants[0] + 3.0 * x * constants[1])), i1


def tangent(i1, jac, mu, constants):
    j = isochoric(jac)
    x = j * i1 - 3.0
    m = mu * j * (1.0 + x * (2.0 * constants[0] + 3.0 * x * constants[1]))
    # d2 psi / dx2, of which x's derivatives are j along I1 and -2 j I1 / (3 J) along J
    bend = mu * (constants[0] + 3.0 * x * constants[1])
    turn = -2.0 * j / (3.0 * jac)
    return (
        m,
        i1,
        4.0 * bend * j * j,
        -2.0 * m / (3.0 * jac) + 2.0 * bend * j * turn * i1,
        5.0 * m * i1 / (9.0 * jac * jac) + bend * (turn * i1) * (turn * i1),
    )


LAW = Law(
    "yeoh",
    energy,
    stress,
    tangent,
    {"second": Constant("Factor of the square of I1 - 3"), "third": Constant("Factor of its cube")},
)
