"""A dome for each of four subjects: one geometry for all and one factor on a subject's moduli,
fitted to a plate and a probe together; the point probe is predicted.

With displacements prescribed every stress is proportional to a factor common to all moduli, at any
strain. A geometry gives one curve a probe, and a subject's factor is a straight line through the
origin. What is fitted are the sizes of the dome. No four subjects are alike but for a factor:
`shared_shape` says how well any model of one shape could do.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import yaml
from scipy.interpolate import PchipInterpolator
from scipy.optimize import least_squares

from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.receptors.fits import jackknife, r_squared
from fingerpad import simulate
from fingerpad.benchmark.rows import read_dataset
from fingerpad.files import write_text
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.units import parse_quantity

DEPTH, FORCE, LOW, HIGH = "depth (mm)", "force (N)", "force_low (N)", "force_high (N)"
AREA = "contact area (mm2)"
PROBES = {"force_plate": "plate", "force_probe": "6.35 mm probe", "force_point": "point probe"}
"""Dataset -> the name of its probe."""
FITTED = ("plate", "6.35 mm probe")
DEEPEST = {"plate": 2.0, "6.35 mm probe": 3.0, "point probe": 3.0}
"""mm, of the measurements."""
STEP = 0.25
"""mm, between the presses of a curve."""
WORST = 3.0
"""Residual, in standard deviations of a subject's forces, of a dome that cannot be pressed."""


@dataclass(frozen=True)
class Unknowns:
    """What is fitted: `name` -> lowest, first and highest value.

    Attributes
    ----------
    ranges : mapping of str to (low, start, high)
        mm for sizes, 1 for `stiffening`.
    specimen : dict
        Document of the specimen that the others are kept of.
    """

    ranges: Mapping[str, tuple[float, float, float]]
    specimen: Mapping[str, Any]

    def column(self, k: int) -> np.ndarray:
        """Logarithms of the lowest (0), first (1) or highest (2) values."""
        return np.log([values[k] for values in self.ranges.values()])

    def dome(self, logarithms: np.ndarray, factor: float = 1.0) -> dict[str, Any]:
        """Specimen document with some sizes, and all moduli times a factor."""
        size = dict(zip(self.ranges, np.exp(logarithms).tolist(), strict=True))
        outline = dict(self.specimen["outline"])
        stiffening = size.pop("stiffening", 0.0)
        _move_bone(outline, size.pop("fat"))
        outline |= {name: f"{value:.4g} mm" for name, value in size.items()}
        layers = {}
        for name, layer in self.specimen["layers"].items():
            young = 1e-3 * factor * parse_quantity(layer["youngs_modulus"], "pressure")
            layers[name] = {
                "youngs_modulus": f"{young:.5g} kPa",
                "poisson_ratio": layer["poisson_ratio"],
            }
            if stiffening:
                layers[name]["law"] = {"name": "yeoh", "second": float(f"{stiffening:.4g}")}
        return {"outline": outline, "layers": layers, "moduli": self.specimen["moduli"]}


def _move_bone(outline: dict[str, Any], fat: float) -> None:
    """Leave so much fat (mm) over the bone, whose lower end stays where it is."""

    def mm(name: str) -> float:
        return 1e3 * parse_quantity(outline[name], "length")

    lower = mm("bone_centre_height") - mm("bone_half_height")
    upper = mm("apex_height") - mm("epidermis_thickness") - mm("dermis_thickness") - fat
    outline["bone_centre_height"] = f"{(upper + lower) / 2:.5g} mm"
    outline["bone_half_height"] = f"{(upper - lower) / 2:.5g} mm"


MEANINGS = {
    "apex_radius": "of the skin over the axis, mm",
    "half_width": "of the dome, mm",
    "fat": "over the bone, mm",
    "bone_half_width": "of the bone, mm",
    "stiffening": "of all layers, the second constant of Yeoh's law; without it: neo-Hookean",
}
"""What is fitted of a dome."""


def sizes_json_schema() -> dict:
    """The JSON schema of what is fitted: name -> its lowest, first and highest value."""
    value = {"type": "number", "exclusiveMinimum": 0}
    three = {"type": "array", "items": value, "minItems": 3, "maxItems": 3}
    named = {name: three | {"description": meaning} for name, meaning in MEANINGS.items()}
    return {"type": "object", "properties": named, "additionalProperties": False}


def read_unknowns(path: str | Path, specimen: str | Path) -> Unknowns:
    """The file of ranges, and the specimen whose other sizes are kept."""
    ranges, document = (
        yaml.safe_load(Path(each).read_text(encoding="utf-8")) for each in (path, specimen)
    )
    return Unknowns({name: tuple(values) for name, values in ranges.items()}, document)


# -- what was measured -----------------------------------------------------------------------------


def measured_forces(paths: Iterable[str]) -> pd.DataFrame:
    """Forces (N) at depths (mm): a row a subject, probe and depth; `scene` is the probe's."""
    rows = [
        {
            "probe": PROBES[Path(path).stem],
            "subject": row.subject,
            DEPTH: 1e3 * row.place("depth", "length"),
            FORCE: row.value,
            "scene": row.scene,
        }
        for path in paths
        for row in read_dataset(path)
    ]
    return pd.DataFrame(rows)


def shared_shape(forces: np.ndarray) -> float:
    """Most that the mean R2 of subjects (rows) can be when each is one shape times a factor: all
    but the first singular value of the forces over each subject's spread are lost.
    """
    spread = forces.std(axis=1, keepdims=True)
    singular = np.linalg.svd(forces / spread, compute_uv=False)
    return 1 - float((singular[1:] ** 2).sum()) / forces.size


# -- what a dome gives -----------------------------------------------------------------------------


def pressed(specimen: Mapping[str, Any], scene: Mapping[str, Any], deepest: float) -> pd.DataFrame:
    """Force and contact area over depth of a probe pressed slowly to `deepest` (mm)."""
    depths = np.arange(STEP, deepest + STEP / 2, STEP)
    history = simulate(
        dict(scene)
        | {
            "specimen": dict(specimen),
            "motion": [{"press_to_depth": f"{depth:g} mm"} for depth in depths],
            "accuracy": "draft",
        }
    )
    return pd.DataFrame(
        {
            DEPTH: 1e3 * history.indentation_depth.values,
            FORCE: history.force.values,
            AREA: 1e6 * history.contact_area.values,
        }
    )


def at_depths(curve: pd.DataFrame, depths: Iterable[float]) -> np.ndarray:
    """Forces (N) of a curve at depths (mm), between its states by a monotone cubic."""
    return PchipInterpolator(curve[DEPTH], curve[FORCE])(list(depths))


def factor_of(shape: np.ndarray, forces: np.ndarray) -> float:
    """The factor with which a shape is closest to forces."""
    return float(shape @ forces / (shape @ shape))


def fit_domes(unknowns: Unknowns, forces: pd.DataFrame) -> np.ndarray:
    """Logarithms of the sizes with which plate and probe are closest to all subjects, each force in
    standard deviations of its subject's, a factor for each subject.
    """
    groups = list(forces[forces["probe"].isin(FITTED)].groupby("subject"))

    def residual(logarithms: np.ndarray) -> np.ndarray:
        try:
            curves = of_dome(unknowns.dome(logarithms), forces, FITTED)
        except NonConvergence:
            return np.full(sum(len(rows) for _, rows in groups), WORST)
        return np.concatenate([_left(curves, rows) for _, rows in groups])

    low, first, high = (unknowns.column(k) for k in range(3))
    found = least_squares(
        residual, first, bounds=(low, high), diff_step=0.03, xtol=1e-2, ftol=1e-2, max_nfev=20
    )
    return found.x


def _left(curves: Mapping[str, pd.DataFrame], rows: pd.DataFrame) -> np.ndarray:
    """What one subject's factor leaves over, in standard deviations of its forces."""
    data, shape = rows[FORCE].to_numpy(), shape_of(curves, rows)
    return (data - factor_of(shape, data) * shape) / data.std()


def of_dome(
    specimen: Mapping[str, Any], forces: pd.DataFrame, probes: Iterable[str]
) -> dict[str, pd.DataFrame]:
    """Curves of a dome by probe."""
    scenes = forces.drop_duplicates("probe").set_index("probe")["scene"]
    return {probe: pressed(specimen, scenes[probe], DEEPEST[probe]) for probe in probes}


def shape_of(curves: Mapping[str, pd.DataFrame], rows: pd.DataFrame) -> np.ndarray:
    """Forces of curves at the probes and depths of some rows; NaN beyond a curve."""
    values = pd.Series(index=rows.index, dtype=float)
    for probe, part in rows.groupby("probe"):
        values[part.index] = at_depths(curves[probe], part[DEPTH])
    return values.to_numpy()


# -- what is said of it ----------------------------------------------------------------------------


def judged(curves: Mapping[str, pd.DataFrame], forces: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """Of every subject: the factor with its interval (jackknife over forces), R2 of what was
    fitted, and of the point probe, which was not.
    """
    for who, rows in forces.groupby("subject"):
        fitted, point = rows[rows["probe"].isin(FITTED)], rows[~rows["probe"].isin(FITTED)]
        data, shape = fitted[FORCE].to_numpy(), shape_of(curves, fitted)
        pairs = list(zip(shape, data, strict=True))
        ((factor, low, high),) = jackknife(lambda some: [factor_of(*np.array(some).T)], pairs)
        by_probe = {
            f"R2, {probe}": r_squared(part[FORCE].to_numpy(), factor * shape_of(curves, part))
            for probe, part in rows.groupby("probe", sort=False)
        }
        yield {
            "subject": who,
            "modulus factor": factor,
            "low_95": low,
            "high_95": high,
            "R2, plate and probe": r_squared(data, factor * shape),
            "forces fitted": len(data),
            **by_probe,
            "largest force fitted (N)": data.max(),
            "forces predicted": len(point),
        }


def drawn(
    curves: Mapping[str, pd.DataFrame], forces: pd.DataFrame, table: pd.DataFrame
) -> Iterator[pd.DataFrame]:
    """Rows of the picture: measured, and each subject's curves with the band of its factor."""
    for row in table.itertuples():
        who, factor = row.subject, row._2
        for probe, curve in curves.items():
            ends = {LOW: row.low_95 * curve[FORCE], HIGH: row.high_95 * curve[FORCE]}
            told = "fitted" if probe in FITTED else "predicted"
            yield curve.assign(panel=probe, series=who, source=f"simulated, {told}", **ends).assign(
                **{FORCE: factor * curve[FORCE]}
            )
    measured = forces.rename(columns={"probe": "panel", "subject": "series"}).drop(columns="scene")
    yield measured.assign(source="measured (Dandekar, Raju and Srinivasan 2003)")


def specimen_text(document: Mapping[str, Any], said: str) -> str:
    """A specimen file of a dome."""
    schema = "# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json"
    body = yaml.safe_dump(dict(document), sort_keys=False, default_flow_style=None, width=120)
    return f"{schema}\n{said}\n{body}"


def spheres_domes(job: SimpleNamespace) -> None:
    """Job: `unknowns`, `specimen`, `forces` (CSV) -> `data`, `tables`, the folder
    `specimens`.
    """
    unknowns = read_unknowns(job.unknowns[0], job.specimen[0])
    forces = measured_forces(job.forces)
    best = fit_domes(unknowns, forces)
    curves = of_dome(unknowns.dome(best), forces, DEEPEST)
    table = pd.DataFrame(judged(curves, forces))
    fitted = forces[forces["probe"].isin(FITTED)]
    by_subject = fitted.pivot(index="subject", columns=["probe", DEPTH], values=FORCE)
    table["R2 of the best shared shape, mean"] = shared_shape(by_subject.to_numpy())
    publish_table(table, job.tables[0])
    sizes = {"size": [*unknowns.ranges], "value": np.exp(best)}
    low, _, high = (np.exp(unknowns.column(k)) for k in range(3))
    publish_table(pd.DataFrame(sizes | {"lowest": low, "highest": high}), job.tables[1])
    write_frame(pd.concat(drawn(curves, forces, table), ignore_index=True), Path(job.data[0]))
    for row in table.itertuples():
        said = (
            "# A dome, fitted by `snakemake spheres` to forces under a plate and a 6.35 mm probe "
            f"(Dandekar, Raju and\n# Srinivasan 2003), subject {row.subject}: the sizes are of all "
            f"four, the moduli are its own ({row._2:.3g} times the thesis's)."
        )
        text = specimen_text(unknowns.dome(best, row._2), said)
        write_text(Path(job.specimens[0]) / f"dome_subject_{row.subject}.yaml", text)
