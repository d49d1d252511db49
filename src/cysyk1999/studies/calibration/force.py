"""Calibration of the pad to measured steady forces of a flat plate: one constant times the moduli,
their ratio kept.

The finite elements are run once for the elastic curve f(d), force per contact length over depth in
the steady state. With displacements prescribed, every stress of the model is proportional to a
factor s common to all moduli, at any strain, so the force on a contact of length l is ``F = s l
f(d)`` exactly, and every fit is a straight line through the origin.
"""

from __future__ import annotations

import json
import math
import re
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy import stats
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.tables import write_frame
from cysyk1999.reference_data import read_force_depth
from fingerpad.files import write_text

PLATE, MEAN = "flat plate", "mean"
DEPTH, FORCE = "depth (mm)", "force (N)"
ESTIMATE_COLUMNS = ["study", "subject", "quantity", "estimate", "low_95", "high_95", "units"]
ESTIMATE_COLUMNS += ["data", "rss (N2)", "aicc", "note"]
LAYERS = ("epidermis", "dermis", "fat")
MODULUS = "modulus constant"
PRODUCT = f"{MODULUS} x contact length"
OTHERS = {
    "long_term": "moduli read as long-term",
    "less_fat": "bone: 0.75 mm less fat",
    "more_fat": "bone: 0.75 mm more fat",
}
"""Scenes ``calibration_*`` that read the pad otherwise -> what they change."""


class ElasticCurve:
    """Steady-state response to a flat plate.

    Parameters
    ----------
    depth : (n,) m, from 0, increasing.
    force : (n,) N/m, per contact length.
    """

    def __init__(self, depth: np.ndarray, force: np.ndarray) -> None:
        self.depth, self.force = depth, force

    @classmethod
    def from_history(cls, history: xr.Dataset) -> ElasticCurve:
        """The curve of a scene of steady presses to growing depths."""
        return cls(history.indentation_depth.values, history.force.values)

    def force_at(self, depth) -> np.ndarray:
        """Force per contact length, N/m, at depths (m); ValueError beyond the curve."""
        depth, end = np.asarray(depth, float), self.depth[-1]
        if not ((depth >= 0) & (depth <= end * (1 + 1e-9))).all():
            raise ValueError(
                f"a depth of {depth.max() * 1e3:g} mm is beyond the elastic curve, "
                f"0 to {end * 1e3:g} mm"
            )
        return PchipInterpolator(self.depth, self.force)(np.minimum(depth, end))


# -- fits -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Fit:
    """A positive factor fitted to forces.

    Attributes
    ----------
    value, low, high : best value and its 95 % interval (Student, symmetric in the logarithm).
    count : of forces.
    rss : weighted sum of squares.
    certainty : sum of squares of the weighted model over the variance of its residual.
    """

    value: float
    low: float
    high: float
    count: int
    rss: float
    certainty: float

    def times(self, factor: float) -> tuple[float, float, float]:
        """Value and interval times a factor."""
        return factor * self.value, factor * self.low, factor * self.high

    @property
    def aicc(self) -> float:
        """Akaike's criterion for small samples, the scatter counted as a parameter (Hurvich and
        Tsai 1989); NaN for too few data.
        """
        n, k = self.count, 2
        if n <= k + 1:
            return float("nan")
        return n * math.log(max(self.rss, 1e-300) / n) + 2 * k + 2 * k * (k + 1) / (n - k - 1)

    def rise(self, share) -> np.ndarray:
        """Rise of the misfit over its variance with shares of the best factor."""
        rise = self.certainty * (np.asarray(share) - 1) ** 2
        return np.where(rise < 1e-6, 0.0, rise)


def fit_constant(curve: ElasticCurve, depth, force, length: float, relative: bool = False) -> Fit:
    """The factor on the moduli behind `curve`, for forces (N) at depths (m), by least squares.

    Parameters
    ----------
    length : of the contact, m.
    relative : weigh each force by its inverse instead of equally.

    Raises
    ------
    ValueError
        Fewer than two forces.
    """
    force, model = np.asarray(force, float), length * curve.force_at(depth)
    degrees = len(force) - 1
    if degrees < 1:
        raise ValueError(f"{len(force)} data cannot give 1 parameters and their intervals")
    if relative:
        force, model = np.ones_like(force), model / force
    value = float(model @ force / (model @ model))
    rss = float(((force - value * model) ** 2).sum())
    # data without scatter would claim exactness; no force is known to a millionth
    sigma = max(math.sqrt(rss / degrees), 1e-6 * float(force.max()))
    certainty = value**2 * float(model @ model) / sigma**2
    half = math.exp(stats.t.ppf(0.975, degrees) / math.sqrt(certainty))
    return Fit(value, value / half, value * half, len(force), rss, certainty)


def length_correlation(fit: Fit) -> float:
    """Correlation of the logarithms of constant and contact length when both are fitted and each
    is known beforehand to within a factor of ten (one standard deviation): force tells their
    product only.
    """
    return -fit.certainty / (fit.certainty + 1 / math.log(10) ** 2)


def group_interval(values: Iterable[float]) -> tuple[float, float, float]:
    """Geometric mean of several subjects' positive values and its 95 % Student interval."""
    log = np.log(list(values))
    half = stats.t.ppf(0.975, len(log) - 1) * stats.sem(log)
    return tuple(float(v) for v in np.exp(log.mean() + np.array([0, -half, half])))


def plate_forces(data: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Steady forces under the plate by subject, by depth; the mean over subjects where all have the
    depth comes last.

    Raises
    ------
    ValueError
        There are none, or a subject has fewer than two depths.
    """
    chosen = data[(data["indenter"] == PLATE) & (data["speed_mm_per_s"] == 0)]
    if chosen.empty:
        raise ValueError(
            f"no steady force (speed_mm_per_s 0) under a {PLATE} among the reference data"
        )
    forces = {who: group.sort_values("depth_mm") for who, group in chosen.groupby("subject")}
    for who, group in forces.items():
        if len(group) < 2:
            raise ValueError(
                f"subject '{who}' has one steady force under a {PLATE}; "
                "a fit needs at least two depths"
            )
    by_depth = chosen.groupby("depth_mm")["force_N"].agg(force_N="mean", size="size").reset_index()
    shared = by_depth[by_depth["size"] == len(forces)]
    return forces | ({MEAN: shared} if len(forces) > 1 and len(shared) >= 2 else {})


def in_si(group: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    """Depths (m) and forces (N) of one of `plate_forces`."""
    return group["depth_mm"].to_numpy() * 1e-3, group["force_N"].to_numpy()


def cited(group: pd.DataFrame) -> str:
    """Author and year of the sources of a subject's rows."""
    sources = group["source"].dropna().str.replace(r"^(.*?\b\d{4}\b).*$", r"\1", regex=True)
    return "; ".join(sources.unique())


# -- the study ------------------------------------------------------------------------------------


def estimate(
    study: str, subject: str, quantity: str, values, units="1", note="", fit: Fit | None = None
) -> dict[str, Any]:
    """A row of the estimates: values is a number, or one with its interval."""
    value, low, high = values if isinstance(values, tuple) else (values, np.nan, np.nan)
    said = (study, subject, quantity, value, low, high, units)
    if fit is not None:
        said += (fit.count, fit.rss, fit.aicc)
    return dict(zip(ESTIMATE_COLUMNS, said, strict=False)) | {"note": note}


class Calibration:
    """The constant of every subject and of the mean, and what forces tell of it.

    Parameters
    ----------
    histories : by scene
        ``calibration_plate``, and those of :data:`OTHERS` that are there.
    coarse : by scene
        Companions on a coarser mesh.
    data : DataFrame
        Of :func:`cysyk1999.reference_data.read_force_depth`.

    Attributes
    ----------
    forces, constants : by subject, the mean last
        Measured forces, and the constant fitted to them.
    main : str
        The mean, or the only subject.
    """

    def __init__(
        self,
        histories: Mapping[str, xr.Dataset],
        coarse: Mapping[str, xr.Dataset],
        data: pd.DataFrame,
    ) -> None:
        self.plate, self.coarse = histories["calibration_plate"], coarse.get("calibration_plate")
        self.specimen = json.loads(self.plate.attrs["scene"])["specimen"]
        self.length, self.forces = self.specimen["contact_length"], plate_forces(data)
        self.main = MEAN if MEAN in self.forces else next(iter(self.forces))
        self.curve = ElasticCurve.from_history(self.plate)
        self.others = {
            name: ElasticCurve.from_history(histories[f"calibration_{name}"])
            for name in OTHERS
            if f"calibration_{name}" in histories
        }
        self.constants = {
            who: fit_constant(self.curve, *in_si(group), self.length)
            for who, group in self.forces.items()
        }

    def fit(self) -> pd.DataFrame:
        """Measured forces and fitted curves of every subject, and curves with the bone moved."""
        depth, force = 1e3 * self.curve.depth, self.length * self.curve.force
        parts = []

        def add(panel, series, source, depth, force, **more) -> None:
            columns = {"panel": panel, "series": series, "source": source}
            parts.append(pd.DataFrame(columns | {DEPTH: depth, FORCE: force} | more))

        for who, group in self.forces.items():
            whose = (
                "measured, mean of the subjects" if who == MEAN else f"measured ({cited(group)})"
            )
            add("subjects", who, whose, group["depth_mm"], group["force_N"])
        for who, fit in self.constants.items():
            ends = {"force_low (N)": fit.low * force, "force_high (N)": fit.high * force}
            add("subjects", who, "simulated, fitted constant", depth, fit.value * force, **ends)
        add("subjects", "thesis", "simulated, moduli stated in the thesis", depth, force)
        curves = self.others | {"plate": self.curve}
        for name in ("less_fat", "plate", "more_fat"):
            if name in curves:
                title = OTHERS.get(name, "default specimen").removeprefix("bone: ")
                source, best = (
                    "simulated, constant of the default specimen",
                    self.constants[self.main],
                )
                force = best.value * self.length * curves[name].force
                add("bone", title, source, 1e3 * curves[name].depth, force)
        return pd.concat(parts, ignore_index=True)

    def identifiability(self) -> pd.DataFrame:
        """Rise of the misfit over constant and length, and its profiles over each, the other
        refitted, and over their product.
        """
        best = self.constants[self.main]
        grid, relative = np.geomspace(0.25, 4.0, 33), np.linspace(0.5, 1.5, 101)
        constant, length = (axis.ravel() for axis in np.meshgrid(grid, grid, indexing="ij"))
        ridge = {
            "panel": "ridge",
            "modulus_constant (1)": best.value * constant,
            "contact_length (mm)": self.length * length * 1e3,
            "rise (1)": best.rise(constant * length),
        }
        series = {PRODUCT: best.rise(relative), "contact length": 0.0, MODULUS: 0.0}
        profiles = pd.concat(
            pd.DataFrame({"series": name, "relative (1)": relative, "rise (1)": rise})
            for name, rise in series.items()
        )
        level = {
            "panel": "level",
            "series": f"95 % (t, {best.count - 1} degrees of freedom)",
            "rise (1)": stats.t.ppf(0.975, best.count - 1) ** 2,
        }
        profiles = profiles.sort_values("relative (1)", kind="stable").assign(panel="profile")
        parts = [pd.DataFrame(ridge), profiles, pd.DataFrame([level])]
        frame = pd.concat(parts, ignore_index=True)
        whose = "measured mean" if self.main == MEAN else "subject"
        frame.insert(1, "source", f"simulated, misfit to the {whose}")
        return frame

    def estimates(self) -> pd.DataFrame:
        """The table: every number with its interval, unit and note."""
        rows = [*self._constant_rows(), *self._other_rows(), *self._cost_rows()]
        return pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)

    def _constant_rows(self) -> Iterator[dict]:
        young = [self.specimen["layers"][name]["youngs_modulus"] for name in LAYERS]
        ratio = " : ".join(f"{modulus / young[-1]:g}" for modulus in young)
        stiff, long = young[0] / 1e6, f"{self.length * 1e3:g} mm contact length"
        note = f"moduli {ratio}, epidermis {stiff:g} MPa; {long}"
        yield estimate("stated in the thesis", "mean", MODULUS, 1.0, note=note)
        note = (
            f"equal weights in N, {long}, moduli {ratio}; interval from the misfit, not from noise"
        )
        name = "Young's modulus of the epidermis"
        for who, fit in self.constants.items():
            yield estimate("constant", who, MODULUS, fit.times(1), "1", note, fit)
            yield estimate("constant", who, name, fit.times(stiff), "MPa")
        subjects = [fit.value for who, fit in self.constants.items() if who != MEAN]
        if len(subjects) > 1:
            name, note = f"{MODULUS}, geometric mean", "interval from the scatter between subjects"
            yield estimate("constant", "all", name, group_interval(subjects), note=note)
        main, best = self.main, self.constants[self.main]
        depth, force = in_si(self.forces[main])
        weighted = fit_constant(self.curve, depth, force, self.length, relative=True)
        note = "equal relative weights: what the choice of weights changes"
        yield estimate("weights", main, MODULUS, weighted.times(1), note=note)
        study, note = "identifiability", "the only thing that force tells"
        yield estimate(study, main, PRODUCT, best.times(self.length * 1e3), "mm", note)
        note = (
            "each known beforehand within a factor 10; "
            "a pressure or a width under known force would part them"
        )
        name = "correlation of log constant and log length"
        yield estimate(study, main, name, length_correlation(best), note=note)
        rank = estimate(study, main, "rank of the sensitivities", 1.0, fit=best)
        yield rank | {"aicc": np.nan}
        note = "with the thesis's moduli"
        for at, needed in zip(depth, force / self.curve.force_at(depth), strict=True):
            name = f"length needed at {at * 1e3:g} mm"
            yield estimate("effective length", main, name, 1e3 * needed, "mm", note)

    def _other_rows(self) -> Iterator[dict]:
        for name, curve in self.others.items():
            fit = fit_constant(curve, *in_si(self.forces[self.main]), self.length)
            note = "all of the moduli is then left when the force is read" * (name == "long_term")
            yield estimate(OTHERS[name], self.main, MODULUS, fit.times(1), "1", note, fit)
            if name == "long_term":
                ratio = fit.value / self.constants[self.main].value
                note = "g_inf but for the bulk modulus, which does not relax"
                quantity = "constant over that of the instantaneous reading"
                yield estimate(OTHERS[name], self.main, quantity, ratio, note=note)

    def _cost_rows(self) -> Iterator[dict]:
        if self.coarse is not None:
            depth, _ = in_si(self.forces[self.main])
            rough = ElasticCurve.from_history(self.coarse).force_at(depth)
            error = 100 * np.abs(rough / self.curve.force_at(depth) - 1).max()
            name = "discretisation error of the elastic curve"
            note = "largest difference to twice the edge, at the measured depths"
            yield estimate("cost", "", name, error, "%", note)
        name = "finite element simulations for all fits of the constant"
        note = "readings of the moduli and bone positions take one more each"
        yield estimate("cost", "", name, 1.0, note=note)
        name = "Newton iterations of the elastic curve"
        count, note = float(self.plate.newton_iterations.sum()), len(self.plate.time) - 1
        yield estimate("cost", "", name, count, note=f"{note} load increments")


# -- calibrated specimens -------------------------------------------------------------------------


def specimen_names(subjects: Iterable[str]) -> dict[str, str]:
    """Names of calibrated specimens, each once: ``calibrated_subject_1``,
    ``calibrated_subject_Anna_Müller``.
    """
    names: dict[str, str] = {}
    for who in subjects:
        word = re.sub(r"[^\w-]+", "_", unicodedata.normalize("NFC", who)).strip("_") or "_"
        stem = name = "calibrated_mean" if who == MEAN else f"calibrated_subject_{word}"
        taken, count = {other.casefold() for other in names.values()}, 1
        while name.casefold() in taken:
            count += 1
            name = f"{stem}_{count}"
        names[who] = name
    return names


def specimen_text(result: Calibration, who: str) -> str:
    """A specimen file with the moduli of the plate's specimen times a subject's constant.

    It has layers and their reading only; the rest of the specimen, its contact length above all, is
    the default's.
    """
    fit, length = result.constants[who], result.length * 1e3
    title, group = f"subject {who}", result.forces[who]
    if who == MEAN:
        title, group = "mean of the subjects", pd.concat(result.forces.values())
    lines = [
        "# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json",
        "# Calibrated by `snakemake calibration` to steady forces under a flat plate, "
        f"{title}: {fit.count} depths,",
        f"# {cited(group)}.",
        f"# The thesis's moduli times {fit.value:.4g} (95 % interval {fit.low:.3g} to "
        f"{fit.high:.3g}, from the misfit), at a",
        f"# contact length of {length:g} mm: force alone tells only their product, "
        f"{fit.value * length:.4g} mm.",
        "layers:",
    ]
    for name in LAYERS:
        layer = result.specimen["layers"][name]
        modulus = f'"{fit.value * layer["youngs_modulus"] / 1e6:.6g} MPa"'
        ratio = f"poisson_ratio: {layer['poisson_ratio']:g}"
        lines.append(f"  {name}: {{youngs_modulus: {modulus}, {ratio}}}")
    return "\n".join([*lines, f"moduli: {result.specimen['moduli']}"]) + "\n"


def write_specimens(directory: str | Path, result: Calibration) -> list[Path]:
    """Write the calibrated specimen of every subject and of the mean; returns the paths."""
    names = specimen_names(result.constants)
    paths = {who: Path(directory) / f"{name}.yaml" for who, name in names.items()}
    for who, path in paths.items():
        write_text(path, specimen_text(result, who))
    return list(paths.values())


def calibrate_forces(job: SimpleNamespace) -> None:
    """Job: `forces`, `histories`, `coarse` -> `data` (CSV, named as the calibration's frames), the
    folder `specimens`.
    """
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    result = Calibration(histories, coarse, read_force_depth(job.forces))
    for path in map(Path, job.data):
        write_frame(getattr(result, path.stem)(), path)
    write_specimens(job.specimens[0], result)
