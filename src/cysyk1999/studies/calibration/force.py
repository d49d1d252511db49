"""Calibration of the pad to measured steady forces of a flat plate: one constant times the moduli,
their ratio kept.

The finite elements are run once for the elastic curve f(d), force per contact length over depth in
the steady state. With displacements prescribed, every stress of the model is proportional to a
factor s common to all moduli, at any strain, so the force on a contact of length l is ``F = s l(d)
f(d)`` exactly, and fits evaluate f alone.
"""

from __future__ import annotations

import json
import math
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.reference_data import read_force_depth
from cysyk1999.studies.calibration.least_squares import Fit, fit, group_interval
from fingerpad.files import write_text
from fingerpad.stimuli.motion import NO_TIME

PLATE = "flat plate"
MEAN = "mean"
DEPTH, FORCE = "depth (mm)", "force (N)"

ESTIMATE_COLUMNS = (
    "study",
    "subject",
    "quantity",
    "estimate",
    "low_95",
    "high_95",
    "units",
    "data",
    "rss (N2)",
    "aicc",
    "note",
)


@dataclass(frozen=True)
class ElasticCurve:
    """Steady-state response to a flat plate: depth m (0 first, increasing), force N/m, contact
    width m.
    """

    depth: np.ndarray
    force: np.ndarray
    width: np.ndarray

    @classmethod
    def from_history(cls, history: xr.Dataset) -> ElasticCurve:
        """The curve of a scene of steady presses to growing depths."""
        return cls(
            history.indentation_depth.values, history.force.values, history.contact_width.values
        )

    def _at(self, curve: PchipInterpolator, depth):
        depth = np.asarray(depth, float)
        if depth.size and not (depth.min() >= 0 and depth.max() <= self.depth[-1] * (1 + 1e-9)):
            raise ValueError(
                f"a depth of {depth.max() * 1e3:g} mm is beyond the elastic curve, 0 to "
                f"{self.depth[-1] * 1e3:g} mm"
            )
        return curve(np.minimum(depth, self.depth[-1]))

    @cached_property
    def _curves(self):
        return PchipInterpolator(self.depth, self.force), PchipInterpolator(self.depth, self.width)

    def force_at(self, depth) -> np.ndarray:
        """Force per contact length, N/m, at depths (m)."""
        return self._at(self._curves[0], depth)

    def width_at(self, depth) -> np.ndarray:
        """Contact width, m, at depths (m)."""
        return self._at(self._curves[1], depth)


# -- the contact's extent out of the plane ---------------------------------------------------------------------------


def constant_length(curve: ElasticCurve, depth, length: float) -> np.ndarray:
    """Effective length, m: the same at every depth."""
    return np.full(np.shape(depth), length)


def elliptical_patch(curve: ElasticCurve, depth, aspect: float) -> np.ndarray:
    """Effective length, m, of an elliptical contact under the plane's mean pressure: pi/4 * aspect
    * width.
    """
    return math.pi / 4 * aspect * curve.width_at(depth)


def plane_sections(curve: ElasticCurve, depth, radius: float) -> np.ndarray:
    """Effective length, m, of a pad curved along the finger, each section for itself: int f(d -
    z^2/2R) dz / f(d).
    """
    depth = np.asarray(depth, float)
    node, weight = np.polynomial.legendre.leggauss(24)
    angle = math.pi / 4 * (node + 1)  # z = sqrt(2 R d) sin(angle), so that f's foot is smooth
    local = depth[..., None] * np.cos(angle) ** 2
    strip = curve.force_at(local) * np.sqrt(2 * radius * depth)[..., None] * np.cos(angle)
    return 2 * (strip @ (math.pi / 4 * weight)) / np.maximum(curve.force_at(depth), 1e-300)


LENGTHS: dict[str, tuple[Callable, str, str, float]] = {
    "constant length": (constant_length, "contact length", "mm", 1e3),
    "elliptical patch": (elliptical_patch, "aspect ratio", "1", 1.0),
    "plane sections": (plane_sections, "radius along the finger", "mm", 1e3),
}
"""Model of the effective length -> its function, its parameter, the unit it is shown in and SI ->
that unit.
"""
_TOLD = {
    "constant length": "constant x length",
    "elliptical patch": "constant x aspect ratio",
    "plane sections": "constant x square root of the radius",
}


# -- fits ------------------------------------------------------------------------------------------------------------


def plate_forces(data: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Steady forces under the plate by subject, by depth; the mean over subjects where all have the
    depth comes last.

    Raises:
        ValueError: there are none, or a subject has fewer than two depths.
    """
    chosen = data[(data["indenter"] == PLATE) & (data["speed_mm_per_s"] == 0)]
    if chosen.empty:
        raise ValueError(
            f"no steady force (speed_mm_per_s 0) under a {PLATE} among the reference data"
        )
    out = {
        subject: group.sort_values("depth_mm")
        for subject, group in chosen.groupby("subject", sort=True)
    }
    for subject, group in out.items():
        if len(group) < 2:
            raise ValueError(
                f"subject '{subject}' has one steady force under a {PLATE}; a fit needs at least "
                "two depths"
            )
    shared = (
        chosen.groupby("depth_mm")
        .agg(force_N=("force_N", "mean"), count=("subject", "size"))
        .reset_index()
    )
    shared = shared[shared["count"] == len(out)]
    if len(out) > 1 and len(shared) >= 2:
        out[MEAN] = shared
    return out


def fit_constant(
    curve: ElasticCurve,
    depth,
    force,
    length: float,
    *,
    start: float = 1.0,
    relative: bool = False,
    sigma: float | None = None,
) -> Fit:
    """The factor s on the moduli behind `curve`, contact length (m) given.

    Args:
        depth: m. force: N. relative: weigh each force by its inverse instead of equally. sigma:
        standard deviation of a force, N (relative: of its relative error), None from the scatter.
    """
    shape = length * curve.force_at(depth)
    weight = 1 / np.asarray(force, float) if relative else 1.0
    return fit(
        lambda p: (p[0] * shape, shape[:, None]), force, {"s": start}, weight=weight, sigma=sigma
    )


def fit_constant_and_length(
    curve: ElasticCurve, depth, force, start: dict[str, float], sigma: float | None = None
) -> Fit:
    """The factor s and the contact length (m) together, ``start = {"s": .., "length": ..}``: force
    tells their product only.
    """
    shape = curve.force_at(depth)
    return fit(
        lambda p: (p[0] * p[1] * shape, np.column_stack([p[1] * shape, p[0] * shape])),
        force,
        start,
        sigma=sigma,
    )


def fit_length(curve: ElasticCurve, depth, force, model: str) -> Fit:
    """The one parameter of a model of :data:`LENGTHS`, moduli as behind `curve`."""
    length, parameter, _, _ = LENGTHS[model]
    shape = curve.force_at(depth)

    def values(p):
        def at(x):
            return length(curve, depth, x) * shape

        return at(p[0]), ((at(p[0] * (1 + 1e-6)) - at(p[0] * (1 - 1e-6))) / (2e-6 * p[0]))[:, None]

    return fit(values, force, {parameter: 1.0 if model == "elliptical patch" else 1e-2})


def ridge_correlation(found: Fit, factor: float = 10.0) -> float:
    """Correlation of the log parameters of a fit when each is known beforehand to within `factor`
    (one standard deviation).
    """
    information = (
        found.jacobian.T @ found.jacobian / found.sigma**2
        + np.eye(len(found.values)) / math.log(factor) ** 2
    )
    covariance = np.linalg.inv(information)
    return float(covariance[0, 1] / math.sqrt(covariance[0, 0] * covariance[1, 1]))


# -- data frames -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Calibration:
    """What the calibration makes: four data frames, and the constant of each subject and of the
    mean.
    """

    fit: pd.DataFrame
    identifiability: pd.DataFrame
    residuals: pd.DataFrame
    estimates: pd.DataFrame
    constants: dict[str, Fit]


def calibrate(
    histories: Mapping[str, xr.Dataset], coarse: Mapping[str, xr.Dataset], data: pd.DataFrame
) -> Calibration:
    """Calibrate every subject and the mean.

    Args:
        histories: ``calibration_plate``, and where they are there ``calibration_less_fat``,
        ``calibration_more_fat`` and ``calibration_long_term``. coarse: the companion of
        ``calibration_plate``, or nothing. data: of
        :func:`cysyk1999.reference_data.read_force_depth`.
    """
    plate = histories["calibration_plate"]
    specimen = json.loads(plate.attrs["scene"])["specimen"]
    length = specimen["contact_length"]
    curves = {
        name.removeprefix("calibration_"): ElasticCurve.from_history(h)
        for name, h in histories.items()
        if _steady(h)
    }
    curve = curves["plate"]
    forces = plate_forces(data)
    constants = {who: fit_constant(curve, *_si(group), length) for who, group in forces.items()}
    lengths = {
        (who, model): fit_length(curve, *_si(group), model)
        for who, group in forces.items()
        for model in LENGTHS
    }
    return Calibration(
        _fit_frame(curves, forces, constants, length),
        _identifiability_frame(curve, forces, length),
        _residuals_frame(curve, forces, lengths),
        _estimates(
            curves,
            forces,
            constants,
            lengths,
            length,
            specimen,
            plate,
            coarse.get("calibration_plate"),
        ),
        constants,
    )


def _steady(history) -> bool:
    return float(history.time[-1]) < NO_TIME


def _si(group):
    return group["depth_mm"].to_numpy() * 1e-3, group["force_N"].to_numpy()


def _last(forces) -> str:
    """The mean, or the only subject."""
    return MEAN if MEAN in forces else next(iter(forces))


def _fit_frame(curves, forces, constants, length) -> pd.DataFrame:
    rows = []
    for who, group in forces.items():
        source = f"measured ({_cited(group)})" if who != MEAN else "measured, mean of the subjects"
        points = {
            "panel": "subjects",
            "series": who,
            "source": source,
            DEPTH: group["depth_mm"],
            FORCE: group["force_N"],
        }
        rows.append(pd.DataFrame(points))
    depth = curves["plate"].depth
    base = length * curves["plate"].force
    for who, found in constants.items():
        low, high = found.intervals()[0]
        rows.append(
            _line(
                "subjects",
                who,
                "simulated, fitted constant",
                depth,
                found.values[0] * base,
                low * base,
                high * base,
            )
        )
    rows.append(_line("subjects", "thesis", "simulated, moduli stated in the thesis", depth, base))
    for name, title in (
        ("less_fat", "0.75 mm less fat"),
        ("plate", "default specimen"),
        ("more_fat", "0.75 mm more fat"),
    ):
        if name in curves:
            line = constants[_last(forces)].values[0] * length * curves[name].force
            rows.append(
                _line(
                    "bone",
                    title,
                    "simulated, constant of the default specimen",
                    curves[name].depth,
                    line,
                )
            )
    return pd.concat(rows, ignore_index=True)


def _cited(group) -> str:
    """Author and year of the sources of a subject's rows: what stands before the first comma or the
    year.
    """
    return "; ".join(
        dict.fromkeys(group["source"].str.replace(r"^(.*?\b\d{4}\b).*$", r"\1", regex=True))
    )


def _line(panel, series, source, depth, force, low=np.nan, high=np.nan):
    columns = {"panel": panel, "series": series, "source": source, DEPTH: depth * 1e3, FORCE: force}
    return pd.DataFrame(columns | {"force_low (N)": low, "force_high (N)": high})


def _identifiability_frame(curve, forces, length) -> pd.DataFrame:
    """Rise of the misfit in units of its scatter over s and length, and its profiles over each and
    over their product.
    """
    depth, force = _si(forces[_last(forces)])
    best = fit_constant(curve, depth, force, length)
    s, shape = best.values[0], curve.force_at(depth)

    def rise(product):
        return float(((force - product * shape) ** 2).sum() - best.rss) / best.sigma**2

    grid = np.geomspace(0.25, 4.0, 33)
    rows = [
        {
            "panel": "ridge",
            "modulus_constant (1)": s * a,
            "contact_length (mm)": length * b * 1e3,
            "rise (1)": rise(s * length * a * b),
        }
        for a in grid
        for b in grid
    ]
    for a in np.linspace(0.5, 1.5, 101):
        rows.append(
            {
                "panel": "profile",
                "series": "modulus constant x contact length",
                "relative (1)": a,
                "rise (1)": rise(s * length * a),
            }
        )
        for name in (
            "contact length",
            "modulus constant",
        ):  # the other is refitted: their product stays
            refitted = (s / a) * (length * a)
            rows.append(
                {
                    "panel": "profile",
                    "series": name,
                    "relative (1)": a,
                    "rise (1)": abs(rise(refitted)),
                }
            )
    rows.append(
        {
            "panel": "level",
            "series": f"95 % (t, {best.count - 1} degrees of freedom)",
            "rise (1)": best.quantile() ** 2,
        }
    )
    frame = pd.DataFrame(rows)
    frame.insert(
        1,
        "source",
        "simulated, misfit to the measured mean"
        if MEAN in forces
        else "simulated, misfit to the subject",
    )
    frame.loc[frame["rise (1)"] < 1e-6, "rise (1)"] = 0.0
    return frame


def _residuals_frame(curve, forces, lengths) -> pd.DataFrame:
    rows = []
    for who, group in forces.items():
        depth, force = _si(group)
        needed = force / curve.force_at(depth) * 1e3
        rows.append(
            _length_rows(who, "measured force over simulated force per length", depth, needed)
        )
        for model in LENGTHS:
            found = lengths[who, model]
            columns = {
                "panel": "residuals",
                "series": model,
                "subject": who,
                "source": "measured less simulated",
            }
            rows.append(
                pd.DataFrame(
                    columns
                    | {
                        DEPTH: depth * 1e3,
                        "residual (N)": found.residual,
                        "residual (%)": 100 * found.residual / force,
                    }
                )
            )
    depth = curve.depth[1:]
    for model, (length, *_) in LENGTHS.items():
        fitted = length(curve, depth, lengths[_last(forces), model].values[0]) * 1e3
        rows.append(
            _length_rows(_last(forces), "simulated, fitted", depth, fitted).assign(series=model)
        )
    return pd.concat(rows, ignore_index=True)


def _length_rows(who, source, depth, length):
    columns = {
        "panel": "length",
        "series": "needed",
        "subject": who,
        "source": source,
        DEPTH: depth * 1e3,
    }
    return pd.DataFrame(columns | {"effective_length (mm)": length})


def _estimates(curves, forces, constants, lengths, length, specimen, plate, coarse) -> pd.DataFrame:
    rows = []
    young = specimen["layers"]["epidermis"]["youngs_modulus"]
    ratio = " : ".join(
        f"{specimen['layers'][k]['youngs_modulus'] / specimen['layers']['fat']['youngs_modulus']:g}"
        for k in ("epidermis", "dermis", "fat")
    )
    last = _last(forces)

    def add(study, who, quantity, values, units, found=None, note=""):
        value, low, high = values if isinstance(values, tuple) else (values, np.nan, np.nan)
        row = {
            "study": study,
            "subject": who,
            "quantity": quantity,
            "estimate": value,
            "low_95": low,
            "high_95": high,
        }
        row |= {"units": units, "note": note}
        if found is not None:
            row |= {"data": found.count, "rss (N2)": found.rss, "aicc": found.aicc}
        rows.append(row)

    add(
        "stated in the thesis",
        "mean",
        "modulus constant",
        1.0,
        "1",
        note=f"moduli {ratio}, epidermis {young / 1e6:g} MPa; {length * 1e3:g} mm contact length",
    )
    for who, found in constants.items():
        note = (
            f"equal weights in N, {length * 1e3:g} mm contact length, moduli {ratio}; interval "
            "from the misfit, not from noise"
        )
        add("constant", who, "modulus constant", _of(found), "1", found, note)
        add(
            "constant",
            who,
            "Young's modulus of the epidermis",
            tuple(young / 1e6 * v for v in _of(found)),
            "MPa",
        )
    subjects = [who for who in forces if who != MEAN]
    if len(subjects) > 1:
        add(
            "constant",
            "all",
            "modulus constant, geometric mean",
            group_interval([constants[w].values[0] for w in subjects]),
            "1",
            note="interval from the scatter between subjects",
        )
    weighted = fit_constant(curves["plate"], *_si(forces[last]), length, relative=True)
    add(
        "weights",
        last,
        "modulus constant",
        _of(weighted),
        "1",
        None,
        "equal relative weights: what the choice of weights changes",
    )
    both = fit_constant_and_length(
        curves["plate"],
        *_si(forces[last]),
        {"s": 1.0, "length": length},
        sigma=constants[last].sigma,
    )
    add(
        "identifiability",
        last,
        "modulus constant x contact length",
        tuple(length * 1e3 * v for v in _of(constants[last])),
        "mm",
        note="the only thing that force tells",
    )
    add(
        "identifiability",
        last,
        "correlation of log constant and log length",
        ridge_correlation(both),
        "1",
        note="each known beforehand within a factor 10; a pressure or a width under known force would part them",
    )
    add(
        "identifiability",
        last,
        "rank of the sensitivities",
        float(np.linalg.matrix_rank(both.jacobian, tol=1e-9 * abs(both.jacobian).max())),
        "1",
        both,
    )
    depth, force = _si(forces[last])
    for d, needed in zip(depth, force / curves["plate"].force_at(depth), strict=True):
        add(
            "effective length",
            last,
            f"length needed at {d * 1e3:g} mm",
            needed * 1e3,
            "mm",
            note="with the thesis's moduli",
        )
    for (who, model), found in lengths.items():
        _, parameter, units, scale = LENGTHS[model]
        add(
            model,
            who,
            parameter,
            tuple(scale * v for v in _of(found)),
            units,
            found,
            f"with the thesis's moduli; force tells {_TOLD[model]} only",
        )
    if "long_term" in curves:
        found = fit_constant(curves["long_term"], *_si(forces[last]), length)
        add(
            "moduli read as long-term",
            last,
            "modulus constant",
            _of(found),
            "1",
            found,
            "all of the moduli is then left when the force is read",
        )
        add(
            "moduli read as long-term",
            last,
            "constant over that of the instantaneous reading",
            found.values[0] / constants[last].values[0],
            "1",
            note="g_inf but for the bulk modulus, which does not relax",
        )
    for name, title in (("less_fat", "0.75 mm less fat"), ("more_fat", "0.75 mm more fat")):
        if name in curves:
            found = fit_constant(curves[name], *_si(forces[last]), length)
            add(f"bone: {title}", last, "modulus constant", _of(found), "1", found)
    if coarse is not None:
        rough = ElasticCurve.from_history(coarse).force_at(depth)
        error = np.abs(rough / curves["plate"].force_at(depth) - 1).max()
        add(
            "cost",
            "",
            "discretisation error of the elastic curve",
            100 * error,
            "%",
            note="largest difference to twice the edge, at the measured depths",
        )
    add(
        "cost",
        "",
        "finite element simulations for all fits of the constant",
        1.0,
        "1",
        note="readings of the moduli and bone positions take one more each",
    )
    add(
        "cost",
        "",
        "Newton iterations of the elastic curve",
        float(plate.newton_iterations.sum()),
        "1",
        note=f"{plate.sizes['time'] - 1} load increments",
    )
    return pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)


def _of(found: Fit) -> tuple[float, float, float]:
    return (float(found.values[0]), *map(float, found.intervals()[0]))


# -- calibrated specimens --------------------------------------------------------------------------------------------


def specimen_text(who: str, found: Fit, specimen: Mapping, data: pd.DataFrame) -> str:
    """A specimen file with the moduli of `specimen` (SI, as in a history's scene) times the fitted
    constant.

    It has layers and their reading only; the rest of the specimen, its contact length above all, is
    the default's.
    """
    (s, low, high), length = _of(found), specimen["contact_length"] * 1e3
    chosen = data[(data["indenter"] == PLATE) & (data["speed_mm_per_s"] == 0)]
    chosen = chosen if who == MEAN else chosen[chosen["subject"] == who]
    title = "mean of the subjects" if who == MEAN else f"subject {who}"
    lines = [
        "# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json",
        f"# Calibrated by `snakemake calibration` to steady forces under a flat plate, {title}: "
        f"{found.count} depths,",
        f"# {_cited(chosen)}.",
        f"# The thesis's moduli times {s:.4g} (95 % interval {low:.3g} to {high:.3g}, from the "
        "misfit), at a",
        f"# contact length of {length:g} mm: force alone tells only their product, "
        f"{s * length:.4g} mm.",
        "layers:",
    ]
    for name in ("epidermis", "dermis", "fat"):
        layer = specimen["layers"][name]
        modulus = f'"{s * layer["youngs_modulus"] / 1e6:.6g} MPa"'
        lines.append(
            f"  {name}: {{youngs_modulus: {modulus}, poisson_ratio: {layer['poisson_ratio']:g}}}"
        )
    return "\n".join([*lines, f"moduli: {specimen['moduli']}"]) + "\n"


def specimen_names(subjects: Iterable[str]) -> dict[str, str]:
    """Names of calibrated specimens, each once: ``calibrated_subject_1``,
    ``calibrated_subject_Anna_Müller``.
    """
    names: dict[str, str] = {}
    for who in subjects:
        kept = re.sub(r"[^\w-]+", "_", unicodedata.normalize("NFC", who)).strip("_") or "_"
        stem = name = "calibrated_mean" if who == MEAN else f"calibrated_subject_{kept}"
        taken, count = {other.casefold() for other in names.values()}, 1
        while name.casefold() in taken:
            name = f"{stem}_{(count := count + 1)}"
        names[who] = name
    return names


def write_specimens(
    directory: str | Path, result: Calibration, specimen: Mapping, data: pd.DataFrame
) -> list[Path]:
    """Write the calibrated specimen of every subject and of the mean; returns the paths."""
    paths = [Path(directory) / f"{name}.yaml" for name in specimen_names(result.constants).values()]
    for path, (who, found) in zip(paths, result.constants.items(), strict=True):
        write_text(path, specimen_text(who, found, specimen, data))
    return paths


def calibrate_forces(job: SimpleNamespace) -> None:
    """Job: `forces`, `histories`, `coarse` -> `data` (CSV, named as the calibration's frames), the
    folder `specimens`.
    """
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    forces = read_force_depth(job.forces)
    result = calibrate(histories, coarse, forces)
    for path in map(Path, job.data):
        write_frame(getattr(result, path.stem), path)
    scene = json.loads(histories["calibration_plate"].attrs["scene"])
    write_specimens(job.specimens[0], result, scene["specimen"], forces)
