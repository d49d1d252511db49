"""Goodwin's spheres: Eq 5-1 with constants fitted at one force asked for two others, for receptive
fields over distance, and the rapidly adapting law asked for the flatness that was recorded.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr
from scipy.optimize import least_squares

from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import CURVATURE, GIVEN_RATE, IMPULSE_RATE, SED, TIME, P, X, Y
from cysyk1999.measures.responses import (
    RECEPTOR_DEPTH,
    curvature_of,
    predicted_rate,
    windowed,
)
from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.receptors.fits import r_squared, rms
from fingerpad.benchmark.rows import Row, read_dataset
from fingerpad.healing import simulate
from fingerpad.measures.features import energy, force_gf, profile
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate, rate_by_leg
from fingerpad.receptors.rapidly_adapting import ASSUMED_RATE
from fingerpad.scenes.scene import load_scene

FITTED_AT = 15
"""Gram-weight, of the rates that the constants are fitted to."""
LIMIT = 10.0
"""Impulses/s: the error at other forces that was asked for."""
IMPULSES = "impulses of the ramp over those under a plate (1)"
DISTANCE = "distance (mm)"
MEASURED = "measured (Goodwin, Browning and Wheat 1995)"
WAYS = {"Eq 5-1": False, "Eq 5-1 without the rate of energy": True}
"""Laws that are tried, and whether they leave out A2."""
Spheres = Mapping[tuple[int, float], xr.Dataset]
"""Histories by force (gf) and curvature (1/m)."""


def spheres_of(histories: Iterable[xr.Dataset]) -> dict[tuple[int, float], xr.Dataset]:
    """Histories by the force and the curvature they have."""
    return {(round(float(force_gf(h)[-1])), round(curvature_of(h), 1)): h for h in histories}


# -- rates -----------------------------------------------------------------------------------------


def rate_of(history: xr.Dataset, law: ImpulseRate, offset: float = 0.0) -> float:
    """Mean rate (impulses/s) of the first second of a receptor at 915 um and an offset (m)."""
    frame = predicted_rate(history, RECEPTOR_DEPTH, law, offset)
    return windowed(history, frame[TIME], frame[IMPULSE_RATE], "first second")


def fitted_law(spheres: Spheres, rates: pd.DataFrame, static: bool) -> ImpulseRate:
    """A1 and the threshold of Eq 5-1 closest to rates; the constants of the rate of energy are the
    thesis's.
    """
    start = THESIS_RATE.without_rate() if static else THESIS_RATE

    def law(unknown: Sequence[float]) -> ImpulseRate:
        return replace(start, per_energy=float(np.exp(unknown[0])), threshold=1e3 * unknown[1])

    def left(unknown: Sequence[float]) -> np.ndarray:
        return asked(spheres, rates, law(unknown)) - rates[GIVEN_RATE].to_numpy()

    return law(least_squares(left, [np.log(start.per_energy), 0.15], diff_step=1e-3).x)


def asked(spheres: Spheres, rates: pd.DataFrame, law: ImpulseRate) -> np.ndarray:
    """Rates (n,) that a law predicts at the forces, curvatures and distances of some rows."""
    return np.array(
        [
            rate_of(spheres[force, curvature], law, 1e-3 * abs(distance))
            for force, curvature, distance in rates[["force (gf)", CURVATURE, DISTANCE]].to_numpy()
        ]
    )


def read_rates(path: str | Path) -> pd.DataFrame:
    """Measured rates: force, curvature, distance from the centre of the field, rate."""
    return pd.DataFrame([_columns(row) for row in read_dataset(path)])


def _columns(row: Row) -> dict[str, float]:
    return {
        "force (gf)": round(row.place("force", "force") / 9.80665e-3),
        CURVATURE: round(row.place("curvature", "curvature"), 1),
        DISTANCE: 1e3 * row.place("x", "length"),
        GIVEN_RATE: row.value,
    }


def judged(spheres: Spheres, held: pd.DataFrame, fields: pd.DataFrame) -> Iterator[dict]:
    """A row a law and set of rates: constants, rms and R2, and whether the constants saw them."""
    sets = {f"{force} gf": part for force, part in held.groupby("force (gf)")}
    sets |= {"fields over distance, 15 gf": fields}
    for way, static in WAYS.items():
        law = fitted_law(spheres, sets[f"{FITTED_AT} gf"], static)
        for name, rows in sets.items():
            data, predicted = rows[GIVEN_RATE].to_numpy(), asked(spheres, rows, law)
            error, fitted = rms(predicted - data), name == f"{FITTED_AT} gf"
            yield {
                "law": way,
                "rates": name,
                "role": "fitted" if fitted else "predicted",
                "rms error (impulses/s)": error,
                "bias (impulses/s)": float(np.mean(predicted - data)),
                "R2": r_squared(data, predicted),
                "asked for (impulses/s)": np.nan if fitted or "gf" not in name[:5] else LIMIT,
                "A1 ((impulses/s)/Pa)": law.per_energy,
                "threshold (Pa)": law.threshold,
                "A2 (impulses/Pa)": law.per_rate,
            }


# -- rapidly adapting ------------------------------------------------------------------------------


def ramp_impulses(history: xr.Dataset) -> float:
    """Impulses of a rapidly adapting receptor at 915 um by the law with assumed constants."""
    change = rate_by_leg(history.time.values, energy(history, RECEPTOR_DEPTH), history.leg.values)
    return float(np.trapezoid(ASSUMED_RATE(change[2]), change[0]))


def rapid(spheres: Spheres, paths: str | Path) -> pd.DataFrame:
    """Impulses over those under a plate of the same force, measured and predicted."""
    rows = read_rates(paths).rename(columns={GIVEN_RATE: IMPULSES})
    keys = rows[["force (gf)", CURVATURE]].to_numpy()
    ours = rows.assign(**{IMPULSES: [ramp_impulses(spheres[tuple(key)]) for key in keys]})
    parts = []
    for frame, source in ((rows, MEASURED), (ours, "simulated")):
        plate = frame[frame[CURVATURE] == 0].set_index("force (gf)")[IMPULSES]
        share = frame[IMPULSES] / frame["force (gf)"].map(plate).to_numpy()
        parts.append(frame.assign(**{IMPULSES: share}, source=source, panel="rapidly adapting"))
    return pd.concat(parts, ignore_index=True).drop(columns=DISTANCE)


# -- what is drawn ---------------------------------------------------------------------------------


def curves(spheres: Spheres, held: pd.DataFrame, fields: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Rows of rates over curvature and of fields over distance, measured and predicted."""
    fit = held[held["force (gf)"] == FITTED_AT]
    law = fitted_law(spheres, fit, static=False)
    for panel, rows in (("rates", held), ("fields", fields)):
        yield rows.assign(panel=panel, source=MEASURED)
        ours = rows.assign(**{GIVEN_RATE: asked(spheres, rows, law)})
        yield ours.assign(panel=panel, source="simulated")


def pressures(spheres: Spheres) -> Iterator[pd.DataFrame]:
    """Pressure over radius at the end of the hold, under every surface at 15 gf."""
    for (force, curvature), history in spheres.items():
        if force == FITTED_AT:
            radius, pressure = profile(history, -1)
            touched = slice(None, int(np.count_nonzero(pressure)) + 1)
            of = {"panel": "pressure", "source": "simulated", CURVATURE: curvature}
            yield pd.DataFrame({X: radius[touched] * 1e3, P: pressure[touched]}).assign(**of)


def field(history: xr.Dataset) -> Iterator[pd.DataFrame]:
    """Strain energy density at the middles of elements, deformed, and the sphere's outline."""
    moved = history.node_position.values + history.snapshot_displacement.values[-1]
    middles = 1e3 * moved[history.element_nodes.values[:, :4]].mean(axis=1)
    near = (middles[:, 0] < 6.5) & (middles[:, 1] > -1)
    of = {"panel": "field", "source": "simulated"}
    values = history.snapshot_strain_energy_density.values[-1, near]
    yield pd.DataFrame({X: middles[near, 0], Y: middles[near, 1], SED: values}).assign(**of)
    outline = 1e3 * history.snapshot_indenter.values[-1]
    outline = outline[np.isfinite(outline).all(axis=1)]
    yield pd.DataFrame({X: outline[:, 0], Y: outline[:, 1]}).assign(**of | {"panel": "sphere"})


def spheres_rates(job: SimpleNamespace) -> None:
    """Job: `histories`, `held`, `fields`, `rapid` (CSV), `scene` -> `data`, `table`."""
    spheres = spheres_of(read_results(job.histories, True)[0].values())
    held, fields = read_rates(job.held[0]), read_rates(job.fields[0])
    publish_table(pd.DataFrame(judged(spheres, held, fields)), job.table[0])
    shown = simulate(load_scene(job.scene[0]), fields=True)
    parts = [
        *field(shown),
        *pressures(spheres),
        *curves(spheres, held, fields),
        rapid(spheres, job.rapid[0]),
    ]
    write_frame(pd.concat(parts, ignore_index=True), Path(job.data[0]))
