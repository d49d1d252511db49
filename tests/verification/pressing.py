"""Press a rigid profile on the skin of a small mesh, with the package's own stepping."""

from dataclasses import dataclass

import numpy as np

from fingerpad.mechanics.stepping import NewtonSettings, QuasiStatic, Record, Skin, Step
from fingerpad.stimuli.shapes import Flat

#: Frozen numbers do not see these; the forces of nearly incompressible bodies carry 5e-9 of
#: round-off.
TIGHT = NewtonSettings(force_tolerance=1e-7, gap_tolerance=1e-8, max_iterations=30)


@dataclass(frozen=True)
class Pressed:
    """End of a run: x and pressure of the (deformed) skin nodes, force N/m, depth and edges m,
    records.
    """

    x: np.ndarray
    pressure: np.ndarray
    force: float
    depth: float
    edges: tuple[float, float]
    records: list[Record]

    @property
    def half_width(self):
        """Half the distance of the contact's edges, m (the right edge where the body is a right
        half).
        """
        return self.edges[1] if self.x[0] > -1e-12 else (self.edges[1] - self.edges[0]) / 2


def skin_of(mesh, curve="top"):
    """The whole curve as candidate skin, ordered from left to right."""
    edges = mesh.curves[curve]
    nodes = np.append(
        (edges[:, [0, 2]] if edges.shape[1] == 3 else edges[:, :1]).ravel(), edges[-1, 1]
    )
    spacing = np.hypot(*np.diff(mesh.points[nodes], axis=0).T).min()
    return Skin(nodes, edges, spacing, (0, len(nodes)))


def walk(body, mesh, steps, profile=None, settings=TIGHT, curve="top", **more):
    """Run a schedule of steps; returns the end of the run. ``more`` goes to the stepper (friction,
    external).
    """
    skin = skin_of(mesh, curve)
    solver = QuasiStatic(body, skin, profile or Flat(), settings, **more)
    records = solver.run(steps)
    return over_skin(body, skin, records, records[-1])


def over_skin(body, skin, records, record):
    """:class:`Pressed` of one record."""
    if body.geometrically_linear:  # the linear theory knows no deformed lengths
        position = body.space.points
    else:
        position = body.space.points + record.displacement
    pressure = record.nodal_force / record.length
    return Pressed(
        position[skin.nodes, 0], pressure, record.force, record.depth, record.edges, records
    )


def press(body, mesh, profile=None, *, force=None, depth=None, steps=1):
    """Press to a force or a depth in equal elastic steps."""
    goals = np.linspace(0, 1, steps + 1)[1:]
    key, goal = ("force", force) if force is not None else ("depth", depth)
    return walk(body, mesh, [Step(0, s, 1.0, **{key: s * goal}) for s in goals], profile)
