"""Partial slip of the Hertz line contact under a tangential force Q < mu P applied after the normal
force P.

Exact when normal and tangential problems are uncoupled: similar materials, or an incompressible
body on a rigid one. Sources: C. Cattaneo (1938); R. D. Mindlin (1949); R. D. Mindlin & H.
Deresiewicz (1953) for the return; K. L. Johnson, *Contact Mechanics* (1985), sections 7.2(a), 7.3
and 7.4.
"""

import numpy as np


def stick_ratio(tangential_force, normal_force, friction):
    """Half width of the stick zone over that of the contact, c/a = sqrt(1 - Q/(mu P)).

    Raises ``ValueError`` unless 0 <= Q <= mu P.
    """
    share = np.asarray(tangential_force, dtype=float) / (friction * normal_force)
    if np.any((share < 0) | (share > 1)):
        raise ValueError(
            "the tangential force must lie between 0 and friction times the normal force"
        )
    return np.sqrt(1 - share)


def traction(x, half_width, peak_pressure, friction, stick_ratio):
    """Shear traction q(x) = mu p0 [sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)], Pa, of the shape
    of ``x``.

    The second term only inside the stick zone |x| < c. Raises ``ValueError`` for a stick ratio
    outside [0, 1].
    """
    if not 0 <= stick_ratio <= 1:
        raise ValueError("stick_ratio must lie in [0, 1]")
    s = np.asarray(x, dtype=float) / half_width
    return (
        friction
        * peak_pressure
        * (np.sqrt(np.maximum(0, 1 - s**2)) - np.sqrt(np.maximum(0, stick_ratio**2 - s**2)))
    )


def returned_traction(x, half_width, peak_pressure, friction, turn, tangential_force, normal_force):
    """Shear traction after Q rose to ``turn`` and came back to ``tangential_force``, Pa, of the
    shape of ``x``.

    On the way back the edges slip the other way: from the traction at the turn twice that of the
    difference is taken, with a stick zone of c/a = sqrt(1 - (Q1 - Q)/(2 mu P)). Raises
    ``ValueError`` unless -Q1 <= Q <= Q1 <= mu P.
    """
    inner = stick_ratio((turn - tangential_force) / 2, normal_force, friction)
    first, back = (
        traction(x, half_width, peak_pressure, friction, ratio)
        for ratio in (stick_ratio(turn, normal_force, friction), inner)
    )
    if tangential_force < -turn:
        raise ValueError("the tangential force must not go beyond the opposite of the turn")
    return first - 2 * back
