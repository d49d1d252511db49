"""From nodal contact forces to contact pressure, contact edges and contact width."""

import numpy as np

from fingerpad.mechanics.space import edge_load_vectors


def contact_pressure(position, edges, nodes, nodal_force, gradient) -> np.ndarray:
    """Nodal pressure (ns,) Pa: force over the consistent nodal load of a unit pressure on the deformed skin.

    Args:
        position: (n, 2) deformed nodes, m. edges: skin edges (m, 2 or 3). nodes: (ns,) skin nodes in order.
        nodal_force: (ns,) N/m along the gap's gradient. gradient: (ns, 2), pointing into the skin.
    """
    return nodal_force / tributary_length(position, edges, nodes, gradient)


def tributary_length(position, edges, nodes, gradient) -> np.ndarray:
    """(ns,) m: component along ``-gradient`` of the load of a unit pressure; its own length where there is no contact."""
    load = edge_load_vectors(position, edges)[nodes]
    along = -np.einsum("ni,ni->n", load, gradient)
    own = np.hypot(load[:, 0], load[:, 1])
    return np.where((along > 0.2 * own) & (gradient != 0).any(1), along, own)


def smoothed_pressure(nodal_force, length, mirrored: bool) -> np.ndarray:
    """5-point (1, 2, 3, 2, 1) average of force over the same average of length, (ns,) Pa.

    ``mirrored``: the first node lies on a symmetry axis, beyond which the pattern continues; its force and length are halves.
    """
    kernel = np.array([1.0, 2.0, 3.0, 2.0, 1.0])

    def average(values):
        if mirrored:
            whole = np.concatenate([values[2:0:-1], [2 * values[0]], values[1:]])
            return np.convolve(np.pad(whole, (0, 2)), kernel, mode="valid")
        return np.convolve(np.pad(values, 2), kernel, mode="valid")

    smooth = average(nodal_force) / average(length)
    return np.where(nodal_force > 0, smooth, 0.0)


def contact_edges(x, pressure, gap) -> tuple[float, float]:
    """Left and right contact edge (m), located between nodes; (nan, nan) without contact.

    Args:
        x: (ns,) lateral position of the deformed skin nodes in order. pressure: (ns,) Pa. gap: (ns,) m, nan where unknown.

    Inside the edge of a smooth contact the pressure grows like the square root of the distance, outside it the gap grows like
    its power 3/2 (Johnson 1985, section 5.1). The edge is the mean of the two extrapolations, each from two nodes and each kept
    between the last touching node and the next one.
    """
    on = np.flatnonzero(pressure > 0)
    if not len(on):
        return np.nan, np.nan
    return _edge(x, pressure, gap, on[0], -1), _edge(x, pressure, gap, on[-1], +1)


def _edge(x, pressure, gap, last, side):
    outer = last + side
    if not 0 <= outer < len(x) or side * (x[outer] - x[last]) <= 0:
        return float(x[last])
    found = [
        _root(x[last - side], x[last], pressure[last - side] ** 2, pressure[last] ** 2) if 0 <= last - side < len(x) else None,
        _root(x[outer + side], x[outer], *np.cbrt(gap[[outer + side, outer]]) ** 2) if 0 <= outer + side < len(x) else None,
    ]
    low, high = sorted((x[last], x[outer]))
    found = [min(max(value, low), high) for value in found if value is not None]
    return float(np.mean(found)) if found else float((x[last] + x[outer]) / 2)


def _root(far, near, at_far, at_near):
    """Where the line through (far, at_far) and (near, at_near) vanishes, if it falls from far to near; else None."""
    if not at_far > at_near >= 0:
        return None
    return near + (near - far) * at_near / (at_far - at_near)
