"""From forces on the skin to smoothed pressure and the edges of the contact."""

import numpy as np

from fingerpad.contact_edge import edge_of

_ON_EDGE = 4
"""Of the contact's points on an edge of a quadratic element."""


def smoothed_pressure(nodal_force, length, mirrored: bool) -> np.ndarray:
    """5-point (1, 2, 3, 2, 1) average of force over the same average of length, (ns,) Pa.

    ``mirrored``: the first node lies on a symmetry axis, beyond which the pattern continues; its
    force and length are halves.
    """
    kernel = np.array([1.0, 2.0, 3.0, 2.0, 1.0])

    def average(values):
        if mirrored:
            whole = np.concatenate([values[2:0:-1], [2 * values[0]], values[1:]])
            return np.convolve(np.pad(whole, (0, 2)), kernel, mode="valid")
        return np.convolve(np.pad(values, 2), kernel, mode="valid")

    smooth = average(nodal_force) / average(length)
    return np.where(nodal_force > 0, smooth, 0.0)


def checkerboard(pressure: np.ndarray, smoothed: np.ndarray) -> float:
    """R.m.s. of nodal pressure less its 5-point average over the peak pressure, inside the contact.

    Inside: from the third to the third last touching node (ns,), nodes that have been lifted off
    between them included. nan where there are fewer than three.
    """
    on = np.flatnonzero(pressure > 0)
    if len(on) < 7:
        return np.nan
    inside = slice(on[2], on[-3] + 1)
    return float(np.sqrt(np.mean((pressure - smoothed)[inside] ** 2)) / pressure.max())


def contact_edges(x, pressure, spacing, mirrored: bool = False) -> tuple[float, float]:
    """Left and right edge of the contact (m), from outermost to outermost; (nan, nan) without
    contact.

    Parameters
    ----------
    x
        (n,) m, lateral position of points of the skin in order.
    pressure
        (n,) Pa.
    spacing
        (n,) m between them.
    mirrored
        The first one lies beside a symmetry axis at x = 0, beyond which the pattern continues.
    """
    if mirrored:
        x, pressure, spacing = (
            np.concatenate([sign * each[::-1], each])
            for sign, each in ((-1, x), (1, pressure), (1, spacing))
        )
    on = np.flatnonzero(pressure > 0)
    if not len(on):
        return np.nan, np.nan
    run = np.split(on, np.flatnonzero(np.diff(on) > 1) + 1)
    left, right = run[0][::-1], run[-1]
    ends = (
        (-x[left], pressure[left], spacing[left[-1]]),
        (x[right], pressure[right], spacing[right[-1]]),
    )
    begin, end = (edge_of(*beside, _ON_EDGE) for beside in ends)
    return -begin, end
