"""Where pressure has no bound, so that its peak is the mesh's and has no error: corners, edges, and
ends of surface or skin.

Under a rigid corner that turns by an angle t the pressure of an elastic half-plane of plane modulus
E* grows as E* t / (2 pi) ln(room / distance) (Johnson 1985, section 5.2, a wedge). Nodes of the
skin see the corner down to their own distance. A smooth profile that is sampled densely has corners
too, but they turn so little, and lie so close, that nodes see nothing of them: only where the
corner brings more than a share of the pressure, it is one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad.stimuli.profile import Profile

OF_STROKES = "; of strokes root mean square, relative to the largest"
"""What is said of errors besides, where the pad moves along the surface."""
SEEN = 0.1
"""Share of the largest pressure that a corner brings to its node, above which the mesh sees it as a
corner.
"""


@dataclass(frozen=True)
class Unbounded:
    """Places in contact where pressure is unbounded.

    Attributes
    ----------
    places : in words, as "the edge at x = 0.79 mm".
    centre : whether one is under the middle of the pad.
    """

    places: tuple[str, ...] = ()
    centre: bool = False

    def __bool__(self) -> bool:
        return bool(self.places)

    @property
    def text(self) -> str:
        """The places, as part of a sentence."""
        return " and ".join(self.places)

    @property
    def covers(self) -> str:
        """The quantities that a stated error is of."""
        if not self:
            return "depth, width, pressure, strain energy"
        centre = "" if self.centre else "centre pressure, "
        return f"depth, width, {centre}strain energy; pressure is unbounded at {self.text}"


def seen_corners(
    corners: np.ndarray, modulus: float, pressure: float, node: float, half_width: float
) -> np.ndarray:
    """Places x (k,) m of corners that nodes see as corners.

    Parameters
    ----------
    corners : (n, 3), of :meth:`fingerpad.stimuli.profile.Profile.corners`.
    modulus : Pa, plane modulus E / (1 - nu^2) of the outermost layer.
    pressure : Pa, largest in the contact.
    node : m, between nodes of the skin.
    half_width : m, of the contact.
    """
    share, growth = _shares(corners, modulus, pressure, node, half_width)
    return corners[share * growth > SEEN, 0]


def unseen_error(
    corners: np.ndarray, modulus: float, pressure: float, node: float, half_width: float
) -> float:
    """What corners that nodes do not see as such leave in the peak pressure, as a share of it: as
    much as they bring, and no more than nodes e times as near would find besides. Parameters as of
    :func:`seen_corners`.
    """
    share, growth = _shares(corners, modulus, pressure, node, half_width)
    unseen = share * growth <= SEEN
    return float((share * np.clip(growth, 0.0, 1.0))[unseen].max(initial=0.0))


def _shares(corners, modulus, pressure, node, half_width):
    """What corners bring to the pressure (k,), over it and over the logarithm that it grows by, and
    this at their nodes (k,).
    """
    _, turn, room = corners.T
    # mean over the node's own length, linearly weighed, above the mean over the room
    growth = np.log(np.minimum(room, max(half_width, 2 * node)) / node) + 0.5 - np.log(2)
    return modulus * turn / (2 * np.pi) / pressure, growth


def ends_unbounded(angle: float, friction: bool) -> bool:
    """Whether pressure is unbounded where a contact reaches the end of the skin.

    Without friction the corner and its mirror image in the rigid surface are a free wedge of twice
    the ``angle`` (rad), whose stresses are unbounded above 180 degrees (Williams 1952). With
    friction a corner that sticks has that from about 60 degrees.
    """
    return angle > np.radians(60.0 if friction else 91.0)


def in_words(profile: Profile, x: np.ndarray) -> tuple[str, ...]:
    """Corners at x (k,) m in words, one phrase a kind."""
    if not len(x):
        return ()
    at_end = np.isin(x, profile.known)
    corner, what = "corner", ""
    if profile.edges:
        corner, what = "edge", "" if profile.unbounded else " finer than the mesh"
    out = []
    for noun, of, places in (
        ("end", " of the profile's points", x[at_end]),
        (corner, what, x[~at_end]),
    ):
        name, names = f"{noun}{of}", f"{noun}s{of}"
        mm = np.unique(np.round(places * 1e3, 4)) + 0.0
        if len(mm) == 1:
            out.append(f"the {name} at x = {mm[0]:.4g} mm")
        elif len(mm) == 2 and mm[0] == -mm[1]:
            out.append(f"the {names} at x = -{mm[1]:.4g} and {mm[1]:.4g} mm")
        elif len(mm):
            out.append(f"{len(mm)} {names} from x = {mm[0]:.4g} to {mm[-1]:.4g} mm")
    return tuple(out)
