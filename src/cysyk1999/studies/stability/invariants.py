"""What must hold of a run whatever its answer is: measures that need no reference, and differences
between two runs.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from cysyk1999.studies.stability.hard_cases import Limits
from fingerpad.mechanics.pressure import checkerboard
from fingerpad.results import leg_ends, states_found
from fingerpad.simulation import Simulation

ENDS = ("force", "indentation_depth", "stored_energy", "contact_width", "tangential_force")
"""What two runs of a case are compared by, at the ends of the legs."""


class Held:
    """What holds the body (steps, 2) N/m, asked after each step of a simulation: the forces at its
    held nodes, summed.
    """

    def __init__(self, made: Simulation):
        self._made, self._found = made, []

    def __call__(self, progress: Mapping[str, float]) -> None:
        body = self._made.body
        self._found.append(
            np.where(body.space.fixed, body.internal_force(), 0.0).sum(0) / self._made.share
        )

    def balance(self, history: xr.Dataset) -> float:
        """Largest difference to what pushes it over the largest push; of half a pad, whose middle
        is held too, upwards only.
        """
        pushed = np.column_stack([history.tangential_force, history.force])[
            history.interpolated.values == 0
        ][1:]
        apart = np.abs(np.array(self._found)[: len(pushed)] - pushed)[
            :, 1 if self._made.mesh.half else 0 :
        ]
        most = np.abs(pushed).max(initial=0.0)
        return float(apart.max() / most) if most else np.nan


def mirrored(history: xr.Dataset) -> float:
    """Largest difference of the skin's displacement to its mirror image over the largest
    displacement, at any time.
    """
    x, y = history.skin_displacement_x.values, history.skin_displacement_y.values
    apart = max(np.abs(x + x[:, ::-1]).max(), np.abs(y - y[:, ::-1]).max())
    return float(apart / max(np.hypot(x, y).max(), 1e-300))


def iterations(history: xr.Dataset) -> float:
    """Newton iterations, mean of the steps."""
    return float(history.newton_iterations.sum()) / max(states_found(history), 1)


def measures(history: xr.Dataset) -> dict[str, float]:
    """What a history tells of the run that made it (their meaning:
    :data:`cysyk1999.studies.stability.picture.MEASURES`).
    """
    ends = leg_ends(history)
    work = np.abs(history.external_work.values)
    kept = history.stored_energy + history.dissipated_energy + history.frictional_dissipation
    pressures = zip(
        ends.contact_pressure.values, ends.contact_pressure_smoothed.values, strict=True
    )
    boards = [checkerboard(pressure, smoothed) for pressure, smoothed in pressures]
    return {
        "cuts": float(history.cutbacks.sum()),
        "factorisations": json.loads(history.attrs["cost"])["factorisations"]
        / max(states_found(history), 1),
        "energy": float(np.abs(history.external_work - kept).max() / max(work.max(), 1e-300)),
        "complementarity": float(history.complementarity_error.max()),
        "det_f": float(history.min_detF.min()),
        "checkerboard": max((b for b in boards if np.isfinite(b)), default=np.nan),
    }


def difference(one: xr.Dataset, other: xr.Dataset, names: Iterable[str] = ENDS) -> float:
    """Largest difference at the ends of the legs, each quantity over its largest value there; a
    side force over no less than a tenth of the force: a thousandth of that is a tenth of what
    forces must balance within.
    """
    ends = leg_ends(one), leg_ends(other)
    found = {name: [end[name].values for end in ends] for name in names}
    scale = {name: max(np.abs(a).max(), 1e-12) for name, (a, _) in found.items()}
    if scale.keys() >= {"force", "tangential_force"}:
        scale["tangential_force"] = max(scale["tangential_force"], 0.1 * scale["force"])
    return max(float(np.abs(a - b).max() / scale[name]) for name, (a, b) in found.items())


def excess(measured: Mapping[str, float], limits: Limits) -> dict[str, str]:
    """Measures that lie outside the limits, and each as text."""
    out = {}
    for name, value in measured.items():
        most = getattr(limits, name)
        if value < most if name == "det_f" else value > most:
            out[name] = f"{name} {value:.3g}"
    return out
