"""Energies inside the epidermis: what 1999 could have done to read them so low, each tried on the
most probable pad.

The thesis's Fig 4-24 shows under its sharpest surface up to 800 Pa at 560 um and to 3000 Pa at 845
um (ticks before: 600, 2000). A reading that were the cause would bring all six depths in the
epidermis inside, and leave the dermis where it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence
from cysyk1999.studies.reconstruction.unknowns import EPIDERMIS, LOAD, SCALED, SOFT, STIFFNESS
from fingerpad.measures import features
from fingerpad.scenes.scene import Scene
from fingerpad.simulation import simulate

SHARPEST = "1260"
WITHIN = (560, 600, 640, 765, 800, 845)
"""um; depths of Fig 4-24 in the epidermis: those of two rows of elements."""
DERMIS = 915
DEPTHS = (*WITHIN, DERMIS)
COLUMN = 134.4e-6
"""m; width of the thesis's elements along the skin (two node spacings)."""
GAUSS = np.sqrt(0.6) / 2
"""Place of the outer ones of three Gauss points, in lengths of an element from its centre."""
ROW = 40e-6 / GAUSS
"""m; height of an element whose Gauss points are 40 um apart."""
BESIDE = COLUMN / 2 + GAUSS * COLUMN * np.array([-1, 0, 1])
"""m; offsets of the Gauss points of the element beside the centre."""
Energies = dict[int, float]
"""Pa, by depth in um."""


def best_pad(posterior: pd.DataFrame) -> dict[str, float]:
    """The best pad of the freest reading of a table of posteriors, on the axes of the design, with
    its factors.
    """
    rows = posterior[posterior["reading"] == "both_free"]
    pad = dict(zip(rows["quantity"], rows["best pad"], strict=True))
    return pad | {LOAD: pad[SCALED] / pad[SOFT], STIFFNESS: pad[EPIDERMIS] / pad[SOFT]}


def _scene(pad: Mapping[str, float], **changes) -> Scene:
    """The sharpest surface on a pad, with receptors under the centre and beside it."""
    depths = {z * 1e-6 for z in DEPTHS} | {z * 1e-6 - 100e-6 for z in WITHIN}
    outputs = {
        "outputs.receptors.offsets": [0.0, 46e-6, *BESIDE, COLUMN],
        "outputs.receptors.depths": sorted(depths),
        "accuracy": "thesis",
    }
    return pads.scene(pad, SHARPEST).varied(outputs | changes)


def _variants(pad: Mapping[str, float]) -> Iterator[tuple[str, Scene]]:
    """What the pad or the program could have been, as scenes."""
    stiff = pads.changes(pad)["specimen.layers.epidermis.youngs_modulus"]
    yield "geometrically linear", _scene(pad, effects={"finite_strain": "off"})
    for thickness in (0.75, 1.0):
        yield f"epidermis of {thickness} mm", _scene(pad | {"epidermis_thickness": thickness})
    for factor in (0.5, 2.0):
        stiffer = pad | {STIFFNESS: factor * pad[STIFFNESS]}
        yield f"epidermis {factor:g} times as stiff", _scene(stiffer)
    for factor in (0.25, 4.0, 10.0):
        nu = pads.poisson_for(pad["bulk_modulus"])
        layer = {"youngs_modulus": factor * stiff, "poisson_ratio": nu}
        scene = _scene(pad, **{"specimen.layers.stratum_corneum": layer})
        yield f"stratum corneum a layer, {factor:g} times as stiff", scene
    yield "bone 2 mm nearer", _scene(pad | {"fat_thickness": pad["fat_thickness"] - 2})
    yield "friction 0.5", _scene(pad, friction=0.5)
    for load in (0.8, 0.6):
        yield f"{load:g} of the load", _scene(pad | {LOAD: load * pad[LOAD]})
    for nu in (0.45, 0.499):
        layers = ("epidermis", "dermis", "fat")
        changes = {f"specimen.layers.{layer}.poisson_ratio": nu for layer in layers}
        yield f"Poisson's ratio {nu}", _scene(pad, **changes)


def _readings(history: xr.Dataset) -> Iterator[tuple[str, Energies]]:
    """What could have been read of one simulation."""

    def at(output: int, **options) -> Energies:
        return {z: features.energy(history, z * 1e-6, **options)[output] for z in DEPTHS}

    highest = _highest(history)
    yield "as elsewhere here: highest, instantaneous elastic energy, at the point", highest
    top = features.ramp_end(history)
    for what, output in (
        ("half way up the ramp", (top + 1) // 2),
        ("end of the ramp", top),
        ("end of the hold", -1),
    ):
        yield what, at(output)
    for name, variable in ENERGIES.items():
        yield f"energy: {name}", _highest(history, name=variable)
    yield "46 um beside the centre", _highest(history, offset=46e-6)
    yield "element average", _averaged(history)
    yield "extrapolated to the corner from reduced points", _extrapolated(highest)
    shallow = {z: features.energy(history, (z - 100) * 1e-6).max() for z in WITHIN}
    yield "0.1 mm less deep than told", shallow | {DERMIS: highest[DERMIS]}


def _highest(history: xr.Dataset, **options) -> Energies:
    """Highest energies at the depths."""
    return {z: features.energy(history, z * 1e-6, **options).max() for z in DEPTHS}


def _averaged(history: xr.Dataset) -> Energies:
    """Mean over an element beside the centre: Gauss points over its width, and over the three
    depths of a row.
    """
    weights = np.array([5, 8, 5]) / 18
    wide = {
        z: (weights @ [features.energy(history, z * 1e-6, x) for x in BESIDE]).max() for z in DEPTHS
    }
    rows = (WITHIN[:3], WITHIN[3:])
    return wide | {z: weights @ [wide[d] for d in row] for row in rows for z in row}


def _extrapolated(highest: Energies) -> Energies:
    """Linear through the two reduced Gauss points of each row of elements, to the depth that is
    told.
    """
    out = dict(highest)
    for row in (WITHIN[:3], WITHIN[3:]):
        points = row[1] + np.array([-1, 1]) * 1e6 * ROW / (2 * np.sqrt(3))
        curve = np.polyfit(row, [highest[z] for z in row], 2)
        line = np.polyfit(points, np.polyval(curve, points), 1)
        out |= dict(zip(row, np.polyval(line, row), strict=True))
    return out


def study(pad: Mapping[str, float], evidence: Evidence) -> pd.DataFrame:
    """A row a reading: energies of the sharpest surface by depth, peak pressure, distance from the
    axes, and what it means.
    """
    soft, rows = pad[SOFT], []

    def add(what: str, energies: Energies, history: xr.Dataset) -> None:
        peak = soft * float(features.peak_pressure(history).max())
        shown = {f"{z} um (Pa)": soft * float(energies[z]) for z in DEPTHS}
        rows.append({"tried": what, **shown, "peak pressure (Pa)": peak})

    history = simulate(_scene(pad))
    for what, energies in _readings(history):
        add(what, energies, history)
    for what, scene in _variants(pad):
        try:
            other = simulate(scene)
        except Exception as error:  # noqa: BLE001 - a pad that cannot be is a row of the table
            rows.append({"tried": f"{what}: {type(error).__name__}"})
            continue
        add(what, _highest(other), other)
    return judged(pd.DataFrame(rows), evidence)


def judged(table: pd.DataFrame, evidence: Evidence) -> pd.DataFrame:
    """With the distance of the six depths from their axes, how many are inside, and the dermis's
    energy over the first row's.
    """
    rows = evidence.of_role("apart").rows.query("surface == @SHARPEST")
    columns = [f"{m.removeprefix('energy_')} um (Pa)" for m in rows["measure"]]
    departure = Evidence(rows).departure(table[columns].to_numpy(float))
    inside, deep = (departure == 0).sum(axis=1), table[f"{DERMIS} um (Pa)"]
    return table.assign(
        **{
            "depths inside": [f"{count} of {len(columns)}" for count in inside],
            "distance (1)": (departure**2).sum(axis=1),
            "dermis over the first row's (1)": deep / deep.iloc[0],
        }
    )


def reconstruction_epidermis(job: SimpleNamespace) -> None:
    """Job: `evidence`, `posterior` -> `table`."""
    evidence = Evidence(read_evidence(job.evidence[0]))
    publish_table(study(best_pad(pd.read_csv(job.posterior[0])), evidence), job.table[0])
