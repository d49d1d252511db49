"""What a program of 1998 could have done so that its energies are as if Poisson's ratio were lower
than the 0.48 that the thesis prints: each way run, alone and with every way to read an energy.

The pad is that of the thesis's scenes, with Poisson's ratio as printed; each way changes one
thing of it. Energies are compared with the thesis's (Figs 4-20, 4-22 to 4-24) times one factor for
all, which is free: a way is judged by how they depend on surface and depth. A hypoelastic law has
no run here: its energy is that of stress and logarithmic strain, one of the readings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.studies.common.meshes import pad_of
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence
from fingerpad.healing import simulate
from fingerpad.measures import features
from fingerpad.planning.plan import plan
from fingerpad.results import scene_of
from fingerpad.scenes.scene import Scene, load_scene

PAD, LENGTH = "thesis", 11.4e-3
SHOWN = ("flat", "158", "1260")
SURFACES = (*SHOWN, *(f"{name}{pads.FAST}" for name in SHOWN))
SOFT = ("dermis", "fat")
LAYERS = ("epidermis", *SOFT)
ROWS = pads.DEPTHS[:3], pads.DEPTHS[3:6], pads.DEPTHS[6:]
"""um; the thesis's depths are those of the Gauss points of three rows of elements."""
COLUMN = 134.4e-6
"""m; width of the thesis's elements along the skin (two node spacings)."""
GAUSS = np.sqrt(0.6) / 2
"""Place of the outer ones of three Gauss points, in lengths of an element from its centre."""
BESIDE = COLUMN / 2 + GAUSS * COLUMN * np.array([-1, 0, 1])
"""m; offsets of the Gauss points of the element beside the centre."""
LONG_TERM = 1 - 0.055 - 0.3691
"""Share of the shear moduli that Eq 3-1 leaves."""
FACTORS = np.geomspace(0.2, 5, 401)
"""On all energies; the one with which a way comes closest is taken."""
FREE = (0.46, 0.45, 0.44, 0.43, 0.42, 0.41, 0.40, 0.38)
"""Poisson's ratios of all layers where it is not as printed."""
PRINTED, ALL_FREE = "as printed", "Poisson's ratio {:g}"
LINEAR = "linear elements, pressure constant in each (selective integration)"
AS_HERE = "as elsewhere here"
FORMULA = "stress across the section left out (formula of plane stress)"
Energies = Mapping[int, float]
"""Pa, by depth in um."""


def bulk(factor: float, layers: Iterable[str] = LAYERS) -> dict[str, float]:
    """Changes that multiply the bulk modulus of layers and keep their shear modulus."""
    nu, changes = pads.poisson_for(factor), {}
    for layer in layers:
        young = pads.YOUNG_EPIDERMIS if layer == "epidermis" else pads.YOUNG_SOFT
        changes[f"specimen.layers.{layer}.poisson_ratio"] = nu
        changes[f"specimen.layers.{layer}.youngs_modulus"] = young * (1 + nu) / (1 + pads.POISSON)
    return changes


def factor_for(nu: float) -> float:
    """The factor of `bulk` that makes a Poisson's ratio."""
    return (1 + nu) / (1 - 2 * nu) * (1 - 2 * pads.POISSON) / (1 + pads.POISSON)


def ways() -> dict[str, tuple[str, dict[str, object]]]:
    """What could have been otherwise -> its kind and the changes of the scene."""
    young, long_term = "specimen.layers.{}.youngs_modulus", {"specimen.moduli": "long_term"}
    relaxed = {
        young.format(k): LONG_TERM * v
        for k, v in zip(LAYERS, (pads.YOUNG_EPIDERMIS, *2 * [pads.YOUNG_SOFT]), strict=True)
    }
    without_1_2nu = 1 - 2 * pads.POISSON
    material = {
        PRINTED: {},
        "all moduli long-term": long_term,
        "bulk modulus of the long-term E": bulk(LONG_TERM),
        "shear long-term, bulk modulus of the instantaneous E": long_term | bulk(1 / LONG_TERM),
        "shear long-term, bulk modulus of E relaxed once more": long_term | bulk(LONG_TERM),
        "bulk relaxes like shear: at once": {"specimen.prony": ()},
        "bulk relaxes like shear: in the end": {"specimen.prony": ()} | relaxed,
        "bulk modulus halved": bulk(0.5),
        "bulk modulus doubled": bulk(2.0),
        "bulk modulus E / 3": bulk(without_1_2nu),
        "epidermis: bulk modulus of the dermis": bulk(0.1, ("epidermis",)),
        "dermis and fat: bulk modulus of the epidermis": bulk(10.0, SOFT),
        "Poisson's ratio 0.499, as elements that lock": bulk(factor_for(0.499)),
    }
    edges = {"skin_edge": COLUMN, "steps": 24}
    program = {
        "geometrically linear": {"effects": {"finite_strain": "off"}},
        "elements as wide as the thesis's": {"accuracy": edges},
        LINEAR: {"accuracy": edges},
    }
    outline = "specimen.outline."
    pad = {
        "epidermis 1 mm thick": {f"{outline}epidermis_thickness": 1e-3},
        "epidermis half as stiff": {young.format("epidermis"): pads.YOUNG_EPIDERMIS / 2},
        "epidermis twice as stiff": {young.format("epidermis"): pads.YOUNG_EPIDERMIS * 2},
        "stratum corneum four times as stiff": {
            "specimen.layers.stratum_corneum": {
                "youngs_modulus": 4 * pads.YOUNG_EPIDERMIS,
                "poisson_ratio": pads.POISSON,
            }
        },
        "friction 0.5": {"friction": 0.5},
        "0.6 of the load": {"specimen.contact_length": LENGTH / 0.6},
    }
    free = {ALL_FREE.format(nu): bulk(factor_for(nu)) for nu in FREE}
    low = factor_for(0.4)
    free["Poisson's ratio 0.4, epidermis alone"] = bulk(low, ("epidermis",))
    free["Poisson's ratio 0.4, dermis and fat alone"] = bulk(low, SOFT)
    kinds = {"material": material, "program": program, "pad": pad, "Poisson's ratio free": free}
    return {name: (kind, c) for kind, those in kinds.items() for name, c in those.items()}


def scene(surface: str, changes: Mapping[str, object]) -> Scene:
    """A surface on the pad, changed; receptors under the centre and around it."""
    name, fast, _ = surface.partition(pads.FAST)
    curvature, rate = pads.SURFACES[name], "150 gf/s" if fast else "40 gf/s"
    shape = {"shape": "cylinder", "curvature": f"{curvature} 1/m"}
    document = {
        "specimen": dict.fromkeys(("outline", "layers", "prony"), PAD)
        | {"contact_length": f"{LENGTH} m"},
        "stimulus": shape if curvature else {"shape": "flat"},
        "motion": [{"press_to_force": "20 gf", "rate": rate}, {"hold": "2 s"}],
        "accuracy": pads.ACCURACY,
    }
    depths = sorted({1e-6 * (z - less) for z in pads.DEPTHS for less in (0, 100)})
    outputs = {
        "outputs.receptors.offsets": [0.0, 46e-6, *BESIDE],
        "outputs.receptors.depths": depths,
    }
    return load_scene(document, f"ways_{surface}").varied(outputs | changes)


# --- readings of one simulation -------------------------------------------------------------------


def _at(history: xr.Dataset, z: float, name="strain_energy_density", x=0.0) -> np.ndarray:
    return features.energy(history, z * 1e-6, x, name)


def volume_part(history: xr.Dataset, z: float) -> np.ndarray:
    """The part (time) Pa of every strain energy that is of volume, kappa/2 (J - 1)^2, at a depth
    (um).
    """
    return -0.5 * _at(history, z, "hydrostatic_pressure") * _at(history, z, "dilatation")


def plane_energies(pressure, mises, young, poisson) -> tuple[np.ndarray, np.ndarray]:
    """Strain energies (Pa) that formulas of another state give stresses of plane strain: of plane
    stress, and without Poisson's ratio.

    Of small strain: with ``s`` the mean and ``R`` the half difference of the principal stresses in
    the plane, the hydrostatic pressure is ``-2 s (1 + nu) / 3`` and von Mises's stress squared ``3
    R^2 + (1 - 2 nu)^2 s^2``. Both formulas are ``(sigma_1^2 + sigma_2^2 - 2 nu sigma_1 sigma_2) /
    2 E``, the second without the last term. Right is ``(1 + nu) (R^2 + (1 - 2 nu) s^2) / E``: plane
    stress counts ``s`` by ``(1 - nu) / (1 + nu)`` instead, 8.8 times as much with nu = 0.48.
    """
    s = -1.5 * np.asarray(pressure) / (1 + poisson)
    square = np.maximum((np.asarray(mises) ** 2 - ((1 - 2 * poisson) * s) ** 2) / 3, 0.0)
    return (s**2 * (1 - poisson) + square * (1 + poisson)) / young, (s**2 + square) / young


def _by_formula(history: xr.Dataset, which: int) -> Energies:
    layers, found = scene_of(history).specimen.materials, {}
    for z in pads.DEPTHS:
        layer = layers["epidermis" if z < 1e6 * pads.EPIDERMIS_THICKNESS else "dermis"]
        stresses = (_at(history, z, name) for name in ("hydrostatic_pressure", "von_mises_stress"))
        found[z] = plane_energies(*stresses, layer.youngs_modulus, layer.poisson_ratio)[which].max()
    return found


def _averaged(history: xr.Dataset) -> Energies:
    """Mean over an element beside the centre: Gauss points over its width, and over the three
    depths of its row.
    """
    weights = np.array([5, 8, 5]) / 18
    wide = {z: (weights @ [_at(history, z, x=x) for x in BESIDE]).max() for z in pads.DEPTHS}
    return {z: weights @ [wide[d] for d in row] for row in ROWS for z in row}


def _extrapolated(highest: Energies) -> Energies:
    """Linear through the two reduced Gauss points of each row of elements, to the depth that is
    told.
    """
    found = {}
    for row in ROWS:
        half = (row[2] - row[0]) / (4 * GAUSS)
        points = (row[0] + row[2]) / 2 + half * np.array([-1, 1]) / np.sqrt(3)
        curve = np.polyfit(row, [highest[z] for z in row], 2)
        line = np.polyfit(points, np.polyval(curve, points), 1)
        found |= dict(zip(row, np.polyval(line, row), strict=True))
    return found


def readings(history: xr.Dataset) -> Iterator[tuple[str, Energies]]:
    """What could have been read of one simulation: a name, and energies by depth."""

    def highest(read: Callable[[float], np.ndarray]) -> Energies:
        return {z: read(z).max() for z in pads.DEPTHS}

    def output(index: int) -> Energies:
        return {z: _at(history, z)[index] for z in pads.DEPTHS}

    usual = highest(lambda z: _at(history, z))
    yield AS_HERE, usual
    for name, variable in ENERGIES.items():
        if variable in history:
            yield f"energy: {name}", highest(lambda z, v=variable: _at(history, z, v))
    yield "volume left out", highest(lambda z: _at(history, z) - volume_part(history, z))
    yield "volume twice", highest(lambda z: _at(history, z) + volume_part(history, z))
    yield FORMULA, _by_formula(history, 0)
    yield "Poisson's ratio left out of the formula too", _by_formula(history, 1)
    top = features.ramp_end(history)
    yield "half way up the ramp", output((top + 1) // 2)
    yield "end of the ramp", output(top)
    yield "end of the hold", output(-1)
    yield "46 um beside the centre", highest(lambda z: _at(history, z, x=46e-6))
    yield "element average", _averaged(history)
    yield "corner of the element, from reduced points", _extrapolated(usual)
    yield "0.1 mm less deep than told", highest(lambda z: _at(history, z - 100))


# --- the table ------------------------------------------------------------------------------------


class Judge:
    """Compares what a way shows with the thesis's energies, and with what else is known."""

    def __init__(self, evidence: Evidence):
        rows = evidence.rows[evidence.rows["surface"].isin(SURFACES)]
        energy = rows["measure"].str.fullmatch(r"energy_\d+")
        self.energy = Evidence(rows[energy].reset_index(drop=True))
        self.other = Evidence(rows[~rows["measure"].str.contains("energy")].reset_index(drop=True))
        self.deep = self.energy.rows["family"].eq("dermal energy").to_numpy()

    def __call__(self, measured: Mapping[str, float], energies: Mapping[str, float]) -> dict:
        """A row of the table without its names; both by "surface: measure"."""
        told = self.energy.values(energies) * self.energy.rows["factor"].to_numpy()
        squares = self.energy.departure(FACTORS[:, None] * told) ** 2
        best = int(squares.sum(axis=1).argmin())
        least, other = squares[best], self.other.departure(self.other.values(measured))
        return {
            "distance (1)": least.sum(),
            "of it epidermis (1)": least[~self.deep].sum(),
            "factor on energies (1)": FACTORS[best],
            "energies met": f"{(least == 0).sum()} of {len(least)}",
            "other rows met": f"{(other == 0).sum()} of {len(other)}",
            "peak pressure, 1260 (kPa)": 1e-3 * measured["1260: peak"],
            "depth, flat (mm)": measured["flat: depth_end"],
            "depth, 1260 (mm)": measured["1260: depth_end"],
        }


def run(name: str) -> dict[str, xr.Dataset]:
    """Histories of the surfaces in one of the `ways`, by surface."""
    scenes = {surface: scene(surface, ways()[name][1]) for surface in SURFACES}
    if name != LINEAR:
        return {surface: simulate(each) for surface, each in scenes.items()}
    mesh = pad_of(scenes["flat"], "quad4", skin_edge=COLUMN)
    planned = {surface: replace(plan(each), element="Q1P0") for surface, each in scenes.items()}
    return {surface: simulate(each, planned[surface], mesh) for surface, each in scenes.items()}


def judged(histories: Mapping[str, xr.Dataset], judge: Judge) -> dict[str, dict]:
    """A row of the table for each reading of one way's histories."""
    measured, read = {}, {}
    for surface, history in histories.items():
        measured |= {f"{surface}: {k}": v for k, v in pads.of_press(history).items()}
        for reading, energies in readings(history):
            keys = {f"{surface}: energy_{z}": v for z, v in energies.items()}
            read.setdefault(reading, {}).update(keys)
    return {reading: judge(measured, energies) for reading, energies in read.items()}


def table(found: Mapping[str, Mapping[str, dict]]) -> pd.DataFrame:
    """A row a way, read as elsewhere, with the reading that brings it closest; then a row a reading
    of the pad as printed.
    """
    kinds, rows = {name: kind for name, (kind, _) in ways().items()}, []
    for name, by_reading in found.items():
        closest = min(by_reading, key=lambda reading: by_reading[reading]["distance (1)"])
        least = by_reading[closest]["distance (1)"]
        beside = {"closest reading": closest, "its distance (1)": least}
        rows.append({"tried": name, "kind": kinds[name]} | by_reading[AS_HERE] | beside)
    for reading, row in found[PRINTED].items():
        if reading != AS_HERE:
            rows.append({"tried": reading, "kind": "reading"} | row)
    return pd.DataFrame(rows)


# --- shares of volume and shape -------------------------------------------------------------------


def shares(histories: Mapping[str, xr.Dataset], pad: str) -> pd.DataFrame:
    """A row a surface and depth: energy of shape and of volume (Pa) when the energy is highest."""
    rows = []
    for surface in SHOWN:
        for z in pads.DEPTHS:
            whole = _at(histories[surface], z)
            top = whole.argmax()
            volume = float(np.clip(volume_part(histories[surface], z)[top], 0, whole[top]))
            parts = {"shape (Pa)": whole[top] - volume, "volume (Pa)": volume}
            rows.append({"pad": pad, "surface": surface, "depth (um)": z} | parts)
    return pd.DataFrame(rows)


def reconstruction_ways(job: SimpleNamespace) -> None:
    """Job: `evidence`, `files` (the pad) -> `table`, `data` (CSV: of shape and volume)."""
    judge, found, kept = Judge(Evidence(read_evidence(job.evidence[0]))), {}, {}
    alike = [ALL_FREE.format(nu) for nu in FREE]
    for name in ways():
        histories = run(name)
        found[name] = judged(histories, judge)
        pad = ALL_FREE.format(pads.POISSON) if name == PRINTED else name
        if name in (PRINTED, *alike):
            kept[name] = shares(histories, pad)
    publish_table(table(found), job.table[0])
    closest = min(alike, key=lambda name: found[name][AS_HERE]["distance (1)"])
    frame = pd.concat([kept[PRINTED], kept[closest]], ignore_index=True)
    write_frame(frame, Path(job.data[0]))
