"""What figures and tables read from a history: phases, profiles, receptor traces.

A history is the dataset of one simulation (SI units, time[0] unloaded). Nothing here computes
mechanics. Values are read of its variables: to label them first, a hundred thousand times for one
table, takes longer than what is done with them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.receptors.laws import rate_by_leg
from fingerpad.results import receptor_index, scene_of
from fingerpad.units import parse_quantity

if TYPE_CHECKING:
    from fingerpad.specimen.pad import PadMesh

SURFACES = ("flat", "79", "105", "158", "210", "315", "420", "630", "1260")
"""Labels of the nine surfaces, broad to sharp: curvature in 1/m as the thesis rounds it."""

TOP, STEADY = "top of ramp", "steady state"
PHASES = ("during ramp", TOP, STEADY)
SIMULATED = "simulated"
RAMP_FRACTIONS = (0.2, 0.4, 0.6, 0.8)

Histories = Mapping[str, xr.Dataset]
Meshes = Mapping[str, "PadMesh"]
Trace = Callable[[xr.Dataset], np.ndarray]
Feature = Callable[[xr.Dataset], float | np.ndarray]

PRESSURE_SCALE = 0.04
"""Factor of the pressure traces of Fig 4-21, of the thesis's choosing."""

PRESSURE = "contact_pressure"
"""The pressure of every figure and table: of every node the mean at the points beside it, not
averaged over neighbours. An average lowers the peak under sharp surfaces and blurs the contact
edge.
"""


def scene_name(programme: str, label: str) -> str:
    """Scene of a surface in a programme: ``("ramp40", "79") -> "ramp40_k79"``."""
    return f"{programme}_flat" if label == "flat" else f"{programme}_k{label}"


def scenes(programme: str, labels: Iterable[str] = SURFACES) -> tuple[str, ...]:
    """Scenes of several surfaces in one force programme."""
    return tuple(scene_name(programme, label) for label in labels)


def is_simulated(frame: pd.DataFrame) -> pd.Series:
    """Rows of a figure's frame that hold simulated data (the others mark thesis ranges)."""
    return frame["source"].astype(str).str.startswith(SIMULATED)


def ramp_end(history: xr.Dataset) -> int:
    """Index of the last output of the first leg: the top of the ramp."""
    leg = history.variables["leg"].values
    return int(np.flatnonzero(leg == leg[0])[-1])


def phase_indices(history: xr.Dataset) -> list[tuple[int, str]]:
    """Outputs shown in profile figures: a few during the ramp, its top, and the last one."""
    time = history.variables["time"].values
    top = ramp_end(history)
    during = {int(np.argmin(abs(time[: top + 1] - f * time[top]))) for f in RAMP_FRACTIONS} - {
        0,
        top,
    }
    return [(i, PHASES[0]) for i in sorted(during)] + [(top, TOP), (len(time) - 1, STEADY)]


def force_gf(history: xr.Dataset) -> np.ndarray:
    """Normal force in gram-force (time): line load times the scene's contact length."""
    length = scene_of(history).specimen.contact_length
    return history.variables["force"].values * length / parse_quantity("1 gf", "force")


def receptors_at(history: xr.Dataset, depth: float) -> np.ndarray:
    """Indices of the receptors at `depth` (m), from left to right."""
    row = np.flatnonzero(abs(history.variables["receptor_depth"].values - depth) < 1e-6)
    return row[np.argsort(history.variables["receptor_offset"].values[row])]


def energy(
    history: xr.Dataset, depth: float, offset: float = 0.0, name: str = "strain_energy_density"
) -> np.ndarray:
    """Strain energy density (time) in Pa at one receptor."""
    return history.variables[name].values[:, receptor_index(history, depth, offset)]


def energy_rate(history: xr.Dataset, depth: float) -> pd.DataFrame:
    """Time derivative of the strain energy density at the centre, with the times it is taken at.

    Taken leg by leg (see `rate_by_leg`), so that the jump at the top of the ramp stays a jump: that
    time appears twice, once with the rate of each leg.
    """
    time, _, rate = rate_by_leg(
        history.variables["time"].values, energy(history, depth), history.variables["leg"].values
    )
    return pd.DataFrame({"time (s)": time, "strain_energy_rate (Pa/s)": rate})


def skin_at(history: xr.Dataset, index: int | slice = slice(None)) -> tuple[np.ndarray, np.ndarray]:
    """Deformed positions x, y (m) of the skin nodes at one output (skin_node), or at all of them
    (time, skin_node).
    """
    x, y = (
        history.variables[f"skin_{k}"].values
        + history.variables[f"skin_displacement_{k}"].values[index]
        for k in "xy"
    )
    return x, y


def profile(history: xr.Dataset, index: int, name: str = PRESSURE) -> tuple[np.ndarray, np.ndarray]:
    """Deformed lateral position (m) and pressure (Pa) of the skin nodes at one output."""
    return skin_at(history, index)[0], history.variables[name].values[index]


def pressure_at(history: xr.Dataset, place: float) -> np.ndarray:
    """Pressure (time) in Pa at a place (m) along the upper side of the skin at rest, straight
    between nodes.
    """
    upper = history.variables["skin_y"].values > 0
    x = history.variables["skin_x"].values[upper]
    return np.array(
        [np.interp(place, x, row) for row in history.variables[PRESSURE].values[:, upper]]
    )


def in_contact(history: xr.Dataset, index: int, margin: int = 1) -> np.ndarray:
    """Mask of the skin nodes in contact at one output, with `margin` free nodes on either side."""
    touching = np.flatnonzero(history.variables["contact_pressure"].values[index] > 0)
    mask = np.zeros(history.sizes["skin_node"], bool)
    if touching.size:
        mask[max(touching[0] - margin, 0) : touching[-1] + margin + 1] = True
    return mask


def centre_node(history: xr.Dataset) -> int:
    """Index of the skin node at the apex (x = 0, on the upper side)."""
    x, y = history.variables["skin_x"].values, history.variables["skin_y"].values
    return int(np.argmin(np.where(y > 0, abs(x), np.inf)))


def surface_nodes(history: xr.Dataset) -> np.ndarray:
    """Indices of skin nodes from the centre to the right as far as anything ever touches (half
    contact).
    """
    centre = centre_node(history)
    ever = np.flatnonzero((history.variables["contact_pressure"].values > 0).any(axis=0))
    return np.arange(centre, max(ever.max(initial=centre), centre) + 1)


def depth(history: xr.Dataset) -> np.ndarray:
    """Indentation depth (time) in m."""
    return history.variables["indentation_depth"].values


def width(history: xr.Dataset) -> np.ndarray:
    """Contact width (time) in m."""
    return history.variables["contact_width"].values


def centre_pressure(history: xr.Dataset) -> np.ndarray:
    """Pressure (time) in Pa at the skin node at the apex."""
    return history.variables["centre_pressure"].values


def peak_pressure(history: xr.Dataset) -> np.ndarray:
    """Largest pressure (time) in Pa of any skin node."""
    return history.variables["peak_pressure"].values
