"""Contact with a surface that has valleys: a point of the skin in one leans on both of its sides.

The distance to such a surface is the smaller of two, and its gradient jumps where they are equal,
which is just where a point comes to rest: with one constraint Newton's method pushes it from side
to side for ever. Here each such point has two, one for each side as if it went on beyond the corner
(the feasible set of a point under a valley is the intersection of both). The contact problem is the
same; only its rows are more than its points. A profile without valleys never comes here.

Friction holds a point in a shallow valley on one of its sides: whatever push both of them could
give it lies within the cone of that side's friction, as long as the valley turns by less than
friction's angle. There one constraint is enough, and two, of which either may stick or slip, would
have the states cycle.
"""

import numpy as np

from fingerpad.mechanics.contact import Rows, Zone

SHARE = 0.5
"""Of friction's angle, by which a valley may turn and still hold a point on one side."""


class Valleys:
    """Which points of the skin are in which valley, remembered from one look to the next.

    Parameters
    ----------
    profile
        The rigid shape.
    count
        Number of points of the skin.
    reach
        m, from the corner of a valley within which a point has two constraints.
    friction
        Coulomb's coefficient, 0 without.
    """

    def __init__(self, profile, count: int, reach: float, friction: float = 0.0):
        self.profile, self.count, self.reach = profile, count, reach
        self.flat = SHARE * np.arctan(friction)
        self._corner = np.full(count, -1)

    def rows(
        self, zone: Zone, part: slice, points: np.ndarray, single: tuple, kept: list[np.ndarray]
    ) -> Rows:
        """The constraints of a zone whose points are at ``points`` (nz, 2) m in the profile's
        frame.

        Parameters
        ----------
        part
            The zone among the skin's points.
        single
            Gap, gradient and curvature with one constraint a point.
        kept
            Arrays (2 ns,) of what belongs to the rows (forces, states): where a point has come into
            a valley, or left one, they are moved to the side that it is nearest to.
        """
        walls = self.profile.walls(points, self.reach, self.flat)
        free = zone.movable[walls.which]  # on the mirror both sides are one
        which, corner, distance, normal, bend = (values[free] for values in walls)
        self._move(part, which, corner, distance, kept)
        if not len(which):
            return Rows(zone, part, np.full(len(zone), -1), *single)
        gap, gradient, curvature = (values.copy() for values in single)
        gap[which], gradient[which], curvature[which] = distance[:, 0], normal[:, 0], bend[:, 0]
        count, first = len(gap), np.arange(part.start, part.stop)
        partner = np.full(count + len(which), -1)
        partner[which], partner[count:] = count + np.arange(len(which)), which
        return Rows(
            zone.doubled(which),
            np.concatenate([first, self.count + first[which]]),
            partner,
            np.concatenate([gap, distance[:, 1]]),
            np.concatenate([gradient, normal[:, 1]]),
            np.concatenate([curvature, bend[:, 1]]),
        )

    def _move(self, part, which, corner, distance, kept):
        now, after = np.full(part.stop - part.start, -1), np.zeros(part.stop - part.start, bool)
        now[which], after[which] = corner, distance[:, 1] < distance[:, 0]
        changed = np.flatnonzero(now != self._corner[part])
        point = part.start + changed
        for values in kept:
            one, other = values[point], values[self.count + point]
            both = (
                one + other if values.dtype == float else np.where(one, one, other)
            )  # forces add up, states do not
            values[point] = np.where(after[changed], 0, both)
            values[self.count + point] = np.where(after[changed], both, 0)
        self._corner[part] = now
