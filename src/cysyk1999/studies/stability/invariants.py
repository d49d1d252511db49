"""Measures of a run that need no reference, and differences between two runs of a case."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from cysyk1999.studies.stability.cases import Limits
from fingerpad.healing import changes
from fingerpad.mechanics.pressure import checkerboard
from fingerpad.results import leg_ends, states_found
from fingerpad.simulation import Simulation

ENDS = ("force", "indentation_depth", "stored_energy", "contact_width", "tangential_force")
"""What two runs of a case are compared by, at the ends of the legs."""


class Reactions:
    """Forces (steps, 2) N/m that hold the body, summed over its held nodes after each step."""

    def __init__(self, simulation: Simulation):
        self.simulation, self.forces = simulation, []

    def __call__(self, progress: Mapping[str, float]) -> None:
        body, share = self.simulation.body, self.simulation.share
        held = np.where(body.space.fixed, body.internal_force(), 0.0)
        self.forces.append(held.sum(0) / share)

    def balance(self, history: xr.Dataset) -> float:
        """Largest difference between reaction and load, over the largest load.

        The middle of half a pad is held sideways too: there only upward forces are compared.
        """
        solved = history.isel(time=np.flatnonzero(history.interpolated.values == 0)[1:])
        load = np.column_stack([solved.tangential_force, solved.force])
        apart = np.abs(np.array(self.forces)[: len(load)] - load)
        most = np.abs(load).max(initial=0.0)
        first = 1 if self.simulation.mesh.half else 0
        return float(apart[:, first:].max() / most) if most else np.nan


def mirrored(history: xr.Dataset) -> float:
    """Largest difference of the skin's displacement to its mirror image, over the largest one."""
    x, y = history.skin_displacement_x.values, history.skin_displacement_y.values
    apart = max(np.abs(x + x[:, ::-1]).max(), np.abs(y - y[:, ::-1]).max())
    return float(apart / max(np.hypot(x, y).max(), 1e-300))


def iterations(history: xr.Dataset) -> float:
    """Newton iterations, mean of the steps."""
    return float(history.newton_iterations.sum()) / max(states_found(history), 1)


def measures(history: xr.Dataset) -> dict[str, float]:
    """Measures of a history, explained in :data:`cysyk1999.studies.stability.picture.MEASURES`."""
    ends = leg_ends(history)
    work = history.external_work
    stored = history.stored_energy + history.dissipated_energy + history.frictional_dissipation
    pressures = ends.contact_pressure.values, ends.contact_pressure_smoothed.values
    boards = [checkerboard(*pair) for pair in zip(*pressures, strict=True)]
    factorisations = json.loads(history.attrs["cost"])["factorisations"]
    return {
        "cuts": float(history.cutbacks.sum()),
        "factorisations": factorisations / max(states_found(history), 1),
        "energy": float(np.abs(work - stored).max() / max(np.abs(work).max(), 1e-300)),
        "complementarity": float(history.complementarity_error.max()),
        "det_f": float(history.min_detF.min()),
        "checkerboard": max((b for b in boards if np.isfinite(b)), default=np.nan),
    }


def difference(one: xr.Dataset, other: xr.Dataset, names: Iterable[str] = ENDS) -> float:
    """Largest of the changes from one run of a case to another."""
    return max(changes(one, other, names).values())


def excess(measured: Mapping[str, float], limits: Limits) -> dict[str, str]:
    """Measures that lie outside the limits, and each as text."""
    out = {}
    for name, value in measured.items():
        most = getattr(limits, name)
        if value < most if name == "det_f" else value > most:
            out[name] = f"{name} {value:.3g}"
    return out
