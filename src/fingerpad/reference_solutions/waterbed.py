"""The fingertip as a water bed: the membrane model of Srinivasan (1989).

An incompressible fluid under a membrane of constant tension T that is held along two lines; both
weightless and without friction. At rest the membrane is an arc of radius R over a rigid chord of
half width w. Where nothing touches it is an arc again, of the radius r = T/p at the pressure p;
where a rigid cylinder of radius rho touches it follows the cylinder and carries p + T/rho. The area
under it stays. That is the finite-deflection form of the model; for shallow membranes and line
loads it becomes
:func:`line_load_profile`. There is no strain in a fluid, hence no strain energy at a receptor.
Source: M. A. Srinivasan, J. Biomech. 22, 343 (1989).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class Pressed:
    """A pressed membrane: depth m, contact half width m, contact pressure Pa (uniform), force N/m,
    length of the membrane m.
    """

    depth: float
    half_width: float
    pressure: float
    force: float
    length: float


def line_load_profile(x, depth, half_length):
    """Downward deflection at ``x`` of a flat membrane of half length L under a line load at its
    middle, m, of the shape of ``x``.

    depth (1 - 4 s + 3 s^2), s = |x|/L: parabolas that leave the fluid's area as it is. The force is
    8 T depth / L.
    """
    s = np.abs(np.asarray(x, float)) / half_length
    return np.where(s <= 1, depth * (1 - 4 * s + 3 * s**2), 0.0)


def rest_height(radius, half_width):
    """Height (m) of the unloaded membrane's apex over its chord."""
    if not half_width < radius:
        raise ValueError("half_width must be smaller than the radius")
    return radius - np.sqrt(radius**2 - half_width**2)


def press(force, tension, radius, half_width, curvature=0.0):
    """Press a rigid cylinder of ``curvature`` (1/m; 0: a plate) by ``force`` (N/m) into a membrane
    of ``tension`` (N/m).

    Parameters
    ----------
    radius, half_width
        m, of the membrane at rest.

    Raises
    ------
    ValueError
        There is no equilibrium with this force.
    """
    # how far the contact reaches: an angle of the cylinder, or a length of the plate
    low, high = 0.0, np.arcsin(min(half_width * curvature, 1.0)) if curvature else half_width
    for _ in range(60):
        contact = (low + high) / 2
        state = _state(contact, tension, radius, half_width, curvature)
        low, high = (contact, high) if state is not None and state.force < force else (low, contact)
    if state is None or not np.isclose(state.force, force, rtol=1e-6):
        raise ValueError(f"no equilibrium under {force:g} N/m with a tension of {tension:g} N/m")
    return state


def _arc(centre, radius, start, end):
    """Twice the area swept about the origin and the length of an arc between two angles."""
    (x0, y0), (x1, y1) = (centre + radius * np.array([np.cos(t), np.sin(t)]) for t in (start, end))
    return radius**2 * (end - start) + centre[0] * (y1 - y0) - centre[1] * (x1 - x0), radius * abs(
        end - start
    )


def _shape(contact, height, half_width, curvature):
    """(area of the right half, length of it, radius of the free arc) at an indenter's ``height``
    above the chord.
    """
    theta = contact if curvature else 0.0
    reach = np.sin(theta) / curvature if curvature else contact
    touch = np.array([reach, height + (1 - np.cos(theta)) / curvature if curvature else height])
    toward = np.array(
        [np.sin(theta), -np.cos(theta)]
    )  # from the contact's end to the centre of the free arc
    chord = touch - [half_width, 0.0]
    radius = chord @ chord / (-2 * chord @ toward)
    centre = touch + radius * toward
    start = np.arctan2(*(touch - centre)[::-1])
    end = np.arctan2(*([half_width, 0.0] - centre)[::-1])
    free, length = _arc(centre, radius, start, end - 2 * np.pi * (end > start))
    if curvature:
        under, more = _arc(
            np.array([0.0, height + 1 / curvature]), 1 / curvature, -np.pi / 2, theta - np.pi / 2
        )
    else:
        under, more = -height * reach, reach
    return -(free + under) / 2, length + more, radius


def _state(contact, tension, radius, half_width, curvature) -> Pressed | None:
    """The membrane with a contact that reaches so far; None if the fluid does not have room."""
    rest = rest_height(radius, half_width)
    angle = np.arcsin(half_width / radius)
    area = radius**2 * (angle - np.sin(angle) * np.cos(angle)) / 2

    def excess(height):
        return _shape(contact, height, half_width, curvature)[0] - area

    if not excess(1e-6 * rest) < 0 < excess((1 + 1e-6) * rest):
        return None
    height = brentq(excess, 1e-6 * rest, (1 + 1e-6) * rest, xtol=1e-15 * rest)
    _, length, free = _shape(contact, height, half_width, curvature)
    pressure = tension * (1 / free + curvature)
    reach = np.sin(contact) / curvature if curvature else contact
    return Pressed(
        float(rest - height),
        float(reach),
        float(pressure),
        float(2 * reach * pressure),
        float(2 * length),
    )
