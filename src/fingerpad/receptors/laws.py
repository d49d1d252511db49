"""The thesis's equations from skin to impulses: contact pressure, strain energy from pressure,
impulse rate (Cysyk 1999).

=========  =========================================================================================
Eqs 4-1    pressure of a node under one surface, once it is past its peak
Eq 4-2     pressure of a node under any surface, while the force rises
Eq 4-3     pressure of a node under any surface, while the force is held
Eq 4-4     strain energy under the skin as a weighted sum of the pressure on it
Eqs 4-5    impulse rate from strain energy and its rate; Eq 5-1 is the same without a constant term
=========  =========================================================================================

Pure functions of arrays in SI units. The first three are linear in their constants and are given as
the terms the constants multiply: ``pressure = terms @ constants``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fingerpad.stimuli.motion import NO_TIME

NODE_TERMS = {
    "4-1": ("inverse edge distance", "displacement", "constant"),
    "4-1 read without an exponent": ("edge distance", "displacement", "constant"),
    "4-2": ("displacement", "speed", "curvature", "constant"),
    "4-3": ("inverse edge distance", "displacement", "curvature", "constant"),
}
"""Terms of the laws of nodal pressure, in the order of the thesis's constants.

The exponent -1 of the distance in Eqs 4-1 and 4-3 is hardly legible in the copy at hand; the text
calls the pressure proportional to an inverse width. Eq 4-1 is kept in its other reading too.
"""

TERM_UNITS = {
    "inverse edge distance": "Pa m",
    "edge distance": "Pa/m",
    "displacement": "Pa/m",
    "speed": "Pa s/m",
    "curvature": "Pa m",
    "constant": "Pa",
}
"""Units of the constants."""


def pressure_terms(law: str, **quantities: np.ndarray) -> np.ndarray:
    """Terms (..., n) of the nodal pressure of Eq 4-1, 4-2 or 4-3.

    Parameters
    ----------
    law
        A key of :data:`NODE_TERMS`.
    quantities
        Broadcast together: ``edge_distance``, m, from the
        node to the nearer edge of the contact; ``displacement``, m, of the node into the pad less
        that of the skin at the contact's edge; ``speed``, m/s, of that displacement at the node;
        ``curvature``, 1/m, of the surface. Only those that the law names are looked at.
    """

    def term(name: str) -> np.ndarray:
        if name == "constant":
            return np.ones(())
        if name == "inverse edge distance":
            return 1 / np.asarray(quantities["edge_distance"])
        return np.asarray(quantities[name.replace(" ", "_")])

    return np.stack(np.broadcast_arrays(*map(term, NODE_TERMS[law])), axis=-1)


def kernel_weights(x: np.ndarray, reference: np.ndarray | float, r: float) -> np.ndarray:
    """Weights (..., n) m of pressures at places x in the integral of ``p(x) exp(-|x - reference| /
    r)`` over the surface.

    Exact for a pressure that is linear between the places, whatever their spacing (the weights are
    integrals of the hat functions with the kernel), so that a skin of nodes 67 um apart and an
    array of sensors 1 mm apart mean the same sum. No pressure is assumed beyond the ends.

    Parameters
    ----------
    x
        (..., n) m, increasing.
    reference
        (...) m.
    r
        Spatial constant, m.
    """
    s = np.asarray(x, float) - np.asarray(reference, float)[..., None]
    far = np.abs(s)
    fallen = r * np.expm1(-far / r)
    # integral of the kernel at the ends, and the integral of that
    once = -np.sign(s[..., [0, -1]]) * fallen[..., [0, -1]]
    twice = r * (far + fallen)
    slope = np.diff(twice, axis=-1) / np.diff(s, axis=-1)
    return np.diff(slope, axis=-1, prepend=once[..., :1], append=once[..., 1:])


@dataclass(frozen=True)
class SpatialSum:
    """Strain energy density at a depth from a weighted sum W of the contact pressure over it.

    ``W(t) = integral of p(x, t) exp(-|x - x_ref| / r) dx`` and ``SE(t) = W (per_depth DOI(t) +
    constant + square W)``. Eq 4-4 has the first two constants. The thesis sums over its nodes; an
    integral does not depend on their spacing (its constants are these times that spacing). The
    third alone says what elasticity says: stress is linear in pressure, energy in the square of
    stress.

    Attributes
    ----------
    r
        Spatial constant, m.
    per_depth
        A1, 1/m^2.
    constant
        A2, 1/m.
    square
        1/(Pa m^2).
    """

    r: float
    per_depth: float = 0.0
    constant: float = 0.0
    square: float = 0.0

    def weighted_pressure(self, x, pressure, reference=0.0) -> np.ndarray:
        """The integral (...), Pa m. x, pressure: (..., n) m, Pa. reference: (...) m, where the
        receptor is, shift included.
        """
        x, pressure = np.asarray(x, float), np.asarray(pressure, float)
        on = np.flatnonzero(np.any(pressure != 0, axis=tuple(range(pressure.ndim - 1))))
        # weights beyond it meet no pressure
        touched = slice(max(on[0] - 1, 0), on[-1] + 2) if len(on) else slice(0, 2)
        return np.einsum(
            "...n,...n->...",
            kernel_weights(x[..., touched], reference, self.r),
            pressure[..., touched],
        )

    def of_sum(self, weighted, indentation=0.0) -> np.ndarray:
        """Strain energy density (...), Pa. weighted: (...) Pa m, the integral. indentation: (...)
        m.
        """
        scale = self.per_depth * np.asarray(indentation) + self.constant
        return weighted * (scale + self.square * weighted)

    def strain_energy(self, x, pressure, indentation=0.0, reference=0.0) -> np.ndarray:
        """Strain energy density (...), Pa.

        Parameters
        ----------
        x
            (..., n) m, places of the pressures, deformed.
        pressure
            (..., n) Pa.
        indentation
            (...) m, of the skin over the receptor.
        reference
            (...) m, lateral place of the receptor: where it is at rest plus what it has shifted by.
        """
        return self.of_sum(self.weighted_pressure(x, pressure, reference), indentation)


def rectified(values) -> np.ndarray:
    """The positive part."""
    return np.maximum(values, 0.0)


@dataclass(frozen=True)
class ImpulseRate:
    """Eqs 4-5 and 5-1: impulse rate of a slowly adapting receptor from strain energy density and
    its rate.

    ``rate = A1 [SE - threshold]+ + A2 [dSE/dt - rate_threshold]+ + spontaneous``. The thesis writes
    the brackets plainly; that each is rectified follows from its Fig 5-19, which shows the energy
    cut at its threshold and the positive rate only.

    Attributes
    ----------
    per_energy
        A1, (impulses/s)/Pa.
    per_rate
        A2, impulses/Pa.
    threshold
        Pa.
    rate_threshold
        Pa/s.
    spontaneous
        A3 of Eq 4-5, impulses/s; Eq 5-1 has none.
    """

    per_energy: float
    per_rate: float
    threshold: float
    rate_threshold: float
    spontaneous: float = 0.0

    def terms(self, energy, energy_rate) -> tuple[np.ndarray, np.ndarray]:
        """What the energy and its rate contribute, impulses/s each."""
        static = self.per_energy * rectified(np.asarray(energy, float) - self.threshold)
        return static, self.per_rate * rectified(
            np.asarray(energy_rate, float) - self.rate_threshold
        )

    def __call__(self, energy, energy_rate) -> np.ndarray:
        """Impulse rate, impulses/s. energy: Pa. energy_rate: Pa/s."""
        return sum(self.terms(energy, energy_rate)) + self.spontaneous

    def without_rate(self) -> ImpulseRate:
        """The response to held energy alone."""
        return replace(self, per_rate=0.0)


THESIS_RATE = ImpulseRate(per_energy=0.081, per_rate=0.0182, threshold=150.0, rate_threshold=100.0)
"""Constants of thesis Figs 5-20 and 5-21: one receptor, pressed and stroked."""


def rate_by_leg(time, values, leg) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A trace and its rate, differentiated leg by leg: times (m,), values and rates (m, ...).

    Second-order differences within a leg (numpy.gradient). A kink between two legs, such as the top
    of a ramp, stays a jump of the rate: that time is there twice, with the rate of either leg, so
    an integral over time sees the jump where it is. A leg that takes no time has no rate and is
    left out.

    Parameters
    ----------
    time
        (n,) s, not falling.
    values
        (n, ...).
    leg
        (n,) whole numbers that do not fall; the first sample of a leg belongs to the leg before it
        as well.
    """
    time, values, leg = np.asarray(time, float), np.asarray(values, float), np.asarray(leg)
    ends = np.flatnonzero(np.diff(leg) > 0)
    pieces = [
        slice(a, b + 1)
        for a, b in zip([0, *ends], [*ends, len(time) - 1], strict=True)
        if time[b] - time[a] > NO_TIME
    ]
    rates = [np.gradient(values[piece], time[piece], axis=0) for piece in pieces]
    return (
        np.concatenate([time[piece] for piece in pieces]),
        np.concatenate([values[piece] for piece in pieces]),
        np.concatenate(rates),
    )


def time_above(time, trace, threshold: float = 0.0) -> float:
    """How long (s) a trace is above a threshold; it is linear between samples, and crossings are
    found between them.

    Parameters
    ----------
    time
        (n,) s, not falling; a repeated time is a jump.
    trace
        (n,).
    """
    over = np.asarray(trace, float) - threshold
    low, high = np.minimum(over[:-1], over[1:]), np.maximum(over[:-1], over[1:])
    crosses = (low < 0) & (high > 0)
    share = np.where(crosses, high / np.where(crosses, high - low, 1.0), high > 0)
    return float((share * np.diff(np.asarray(time, float))).sum())
