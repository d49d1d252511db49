"""Calibration of the pad to measured steady forces of a flat plate: one constant times the moduli,
their ratio kept.

The finite elements are run once for the elastic curve f(d), force per contact length over depth in
the steady state. With displacements prescribed, every stress of the model is proportional to a
factor s common to all moduli, at any strain, so the force on a contact of length l is ``F = s l(d)
f(d)`` exactly, and every fit is a straight line through the origin.
"""

from __future__ import annotations

import json
import math
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr
from scipy import stats
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.reference_data import read_force_depth
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
LAYERS = ("epidermis", "dermis", "fat")
BONES = {"less_fat": "0.75 mm less fat", "more_fat": "0.75 mm more fat"}


@dataclass(frozen=True)
class ElasticCurve:
    """Steady-state response to a flat plate.

    Attributes
    ----------
    depth : (n,) m, from 0, increasing.
    force : (n,) N/m, per contact length.
    width : (n,) m, of the contact.
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

    def force_at(self, depth) -> np.ndarray:
        """Force per contact length, N/m, at depths (m); ValueError beyond the curve."""
        return self._at(depth, self.force)

    def width_at(self, depth) -> np.ndarray:
        """Contact width, m, at depths (m); ValueError beyond the curve."""
        return self._at(depth, self.width)

    def _at(self, depth, values: np.ndarray) -> np.ndarray:
        depth, end = np.asarray(depth, float), self.depth[-1]
        if not ((depth >= 0) & (depth <= end * (1 + 1e-9))).all():
            raise ValueError(
                f"a depth of {depth.max() * 1e3:g} mm is beyond the elastic curve, "
                f"0 to {end * 1e3:g} mm"
            )
        return PchipInterpolator(self.depth, values)(np.minimum(depth, end))


# -- the contact's extent out of the plane --------------------------------------------------------


def constant_length(curve: ElasticCurve, depth, length: float) -> np.ndarray:
    """Effective length, m: the same at every depth."""
    return np.full(np.shape(depth), length)


def elliptical_patch(curve: ElasticCurve, depth, aspect: float) -> np.ndarray:
    """Effective length, m, of an elliptical contact: pi/4 * aspect * width."""
    return math.pi / 4 * aspect * curve.width_at(depth)


def plane_sections(curve: ElasticCurve, depth, radius: float) -> np.ndarray:
    """Effective length, m, of a pad curved along the finger, each section pressed by itself:
    int f(d - z^2/2R) dz / f(d).
    """
    depth = np.asarray(depth, float)
    node, weight = np.polynomial.legendre.leggauss(24)
    angle = math.pi / 4 * (node + 1)  # z = sqrt(2 R d) sin(angle), so that f's foot is smooth
    local = depth[..., None] * np.cos(angle) ** 2
    strip = curve.force_at(local) * np.sqrt(2 * radius * depth)[..., None] * np.cos(angle)
    return 2 * (strip @ (math.pi / 4 * weight)) / np.maximum(curve.force_at(depth), 1e-300)


@dataclass(frozen=True)
class LengthModel:
    """A model of the effective length with one parameter.

    Attributes
    ----------
    length : function of curve, depth (m) and parameter, gives m.
    parameter, units : its name, and the unit it is shown in.
    scale : shown over SI.
    power : the length is proportional to this power of the parameter.
    known : the product that force tells.
    """

    length: object
    parameter: str
    units: str
    scale: float
    power: float
    known: str


LENGTHS = {
    "constant length": LengthModel(
        constant_length, "contact length", "mm", 1e3, 1.0, "constant x length"
    ),
    "elliptical patch": LengthModel(
        elliptical_patch, "aspect ratio", "1", 1.0, 1.0, "constant x aspect ratio"
    ),
    "plane sections": LengthModel(
        plane_sections,
        "radius along the finger",
        "mm",
        1e3,
        0.5,
        "constant x square root of the radius",
    ),
}


# -- fits -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Fit:
    """A positive parameter fitted to forces.

    Attributes
    ----------
    value, low, high : best value and its 95 % interval (Student, symmetric in the logarithm).
    residual : (n,) N, data less model.
    rss : weighted sum of squares.
    sigma : standard deviation of the weighted residual.
    certainty : sum of squares of the weighted model over sigma^2.
    """

    value: float
    low: float
    high: float
    residual: np.ndarray
    rss: float
    sigma: float
    certainty: float

    def times(self, factor: float) -> tuple[float, float, float]:
        """Value and interval times a factor."""
        return factor * self.value, factor * self.low, factor * self.high

    def aicc(self, parameters: int = 1) -> float:
        """Akaike's criterion for small samples, the scatter counted as a parameter (Hurvich and
        Tsai 1989); NaN for too few data.
        """
        n, k = len(self.residual), parameters + 1
        if n <= k + 1:
            return float("nan")
        return n * math.log(max(self.rss, 1e-300) / n) + 2 * k + 2 * k * (k + 1) / (n - k - 1)


def fit_factor(shape, force, *, power: float = 1.0, relative: bool = False) -> Fit:
    """Fit p in ``force = p**power * shape`` by least squares.

    Parameters
    ----------
    shape, force : (n,) N, positive.
    power : of the parameter.
    relative : weigh each force by its inverse instead of equally.

    Raises
    ------
    ValueError
        Fewer than two forces.
    """
    force, shape = np.asarray(force, float), np.asarray(shape, float)
    degrees = len(force) - 1
    if degrees < 1:
        raise ValueError(f"{len(force)} data cannot give 1 parameters and their intervals")
    weight = 1 / force if relative else np.ones_like(force)
    model, data = weight * shape, weight * force
    factor = float(model @ data / (model @ model))
    rss = float(((data - factor * model) ** 2).sum())
    # data without scatter would claim exactness; no force is known to a millionth
    sigma = max(math.sqrt(rss / degrees), 1e-6 * float(data.max()))
    certainty = factor**2 * float(model @ model) / sigma**2
    half = math.exp(stats.t.ppf(0.975, degrees) / math.sqrt(certainty) / power)
    value = factor ** (1 / power)
    return Fit(value, value / half, value * half, force - factor * shape, rss, sigma, certainty)


def fit_constant(curve: ElasticCurve, depth, force, length: float, relative: bool = False) -> Fit:
    """The factor on the moduli behind `curve`, for forces (N) at depths (m) and a contact length
    (m).
    """
    return fit_factor(length * curve.force_at(depth), force, relative=relative)


def fit_length(curve: ElasticCurve, depth, force, model: str) -> Fit:
    """The parameter of a model of :data:`LENGTHS`, moduli as behind `curve`."""
    chosen = LENGTHS[model]
    shape = chosen.length(curve, depth, 1.0) * curve.force_at(depth)
    return fit_factor(shape, force, power=chosen.power)


def length_correlation(found: Fit, factor: float = 10.0) -> float:
    """Correlation of the logarithms of constant and contact length when both are fitted and each
    is known beforehand to within `factor` (one standard deviation): force tells their product only.
    """
    return -found.certainty / (found.certainty + 1 / math.log(factor) ** 2)


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
    out = {who: group.sort_values("depth_mm") for who, group in chosen.groupby("subject")}
    for who, group in out.items():
        if len(group) < 2:
            raise ValueError(
                f"subject '{who}' has one steady force under a {PLATE}; "
                "a fit needs at least two depths"
            )
    by_depth = chosen.groupby("depth_mm")["force_N"].agg(["mean", "size"]).reset_index()
    shared = by_depth[by_depth["size"] == len(out)].rename(columns={"mean": "force_N"})
    return out | ({MEAN: shared} if len(out) > 1 and len(shared) >= 2 else {})


# -- data frames ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Calibration:
    """Results of the calibration: four data frames, and the constant of each subject and of the
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
    """Fit the constant of every subject and of the mean, and judge what forces tell.

    Parameters
    ----------
    histories : by scene
        ``calibration_plate``, and ``calibration_long_term``, ``_less_fat``, ``_more_fat`` if there.
    coarse : by scene
        Companions on a coarser mesh.
    data : DataFrame
        Of :func:`cysyk1999.reference_data.read_force_depth`.
    """
    plate = histories["calibration_plate"]
    specimen = json.loads(plate.attrs["scene"])["specimen"]
    length, forces = specimen["contact_length"], plate_forces(data)
    curves = {
        name.removeprefix("calibration_"): ElasticCurve.from_history(history)
        for name, history in histories.items()
        if float(history.time[-1]) < NO_TIME
    }
    curve = curves["plate"]
    constants = {who: fit_constant(curve, *_si(group), length) for who, group in forces.items()}
    lengths = {
        (who, model): fit_length(curve, *_si(group), model)
        for who, group in forces.items()
        for model in LENGTHS
    }
    rough = coarse.get("calibration_plate")
    estimates = [
        *_constant_rows(curves, forces, constants, specimen),
        *_length_rows(curve, forces, lengths),
        *_other_rows(curves, forces, constants, length),
        *_cost_rows(curve, forces, plate, rough),
    ]
    return Calibration(
        _fit_frame(curves, forces, constants, length),
        _identifiability_frame(curve, forces, length),
        _residuals_frame(curve, forces, lengths),
        pd.DataFrame(estimates, columns=ESTIMATE_COLUMNS),
        constants,
    )


def _si(group: pd.DataFrame) -> tuple[np.ndarray, np.ndarray]:
    return group["depth_mm"].to_numpy() * 1e-3, group["force_N"].to_numpy()


def _last(forces) -> str:
    """The mean, or the only subject."""
    return MEAN if MEAN in forces else next(iter(forces))


def _cited(group: pd.DataFrame) -> str:
    """Author and year of the sources of a subject's rows."""
    return "; ".join(group["source"].str.replace(r"^(.*?\b\d{4}\b).*$", r"\1", regex=True).unique())


def _fit_frame(curves, forces, constants, length) -> pd.DataFrame:
    parts = []

    def add(panel, series, source, depth, force, **more) -> None:
        columns = {"panel": panel, "series": series, "source": source, DEPTH: depth, FORCE: force}
        parts.append(pd.DataFrame(columns | more))

    for who, group in forces.items():
        source = f"measured ({_cited(group)})" if who != MEAN else "measured, mean of the subjects"
        add("subjects", who, source, group["depth_mm"], group["force_N"])
    depth, base = 1e3 * curves["plate"].depth, length * curves["plate"].force
    for who, found in constants.items():
        ends = {"force_low (N)": found.low * base, "force_high (N)": found.high * base}
        add("subjects", who, "simulated, fitted constant", depth, found.value * base, **ends)
    add("subjects", "thesis", "simulated, moduli stated in the thesis", depth, base)
    source, best = "simulated, constant of the default specimen", constants[_last(forces)].value
    for name in ("less_fat", "plate", "more_fat"):
        if name in curves:
            title = BONES.get(name, "default specimen")
            curve = curves[name]
            add("bone", title, source, 1e3 * curve.depth, best * length * curve.force)
    return pd.concat(parts, ignore_index=True)


def _identifiability_frame(curve, forces, length) -> pd.DataFrame:
    """Rise of the misfit in units of its scatter over constant and length, and its profiles over
    each, the other refitted, and over their product.
    """
    depth, force = _si(forces[_last(forces)])
    best, shape = fit_constant(curve, depth, force, length), curve.force_at(depth)

    def rise(product: np.ndarray) -> np.ndarray:
        misfit = ((force - np.multiply.outer(best.value * length * product, shape)) ** 2).sum(-1)
        rise = (misfit - best.rss) / best.sigma**2
        return np.where(rise < 1e-6, 0.0, rise)

    grid, relative = np.geomspace(0.25, 4.0, 33), np.linspace(0.5, 1.5, 101)
    constant, lengths = (axis.ravel() for axis in np.meshgrid(grid, grid, indexing="ij"))
    ridge = {
        "panel": "ridge",
        "modulus_constant (1)": best.value * constant,
        "contact_length (mm)": length * lengths * 1e3,
        "rise (1)": rise(constant * lengths),
    }
    series = {
        "modulus constant x contact length": rise(relative),
        "contact length": 0.0,
        "modulus constant": 0.0,
    }
    profiles = [
        pd.DataFrame(
            {"panel": "profile", "series": name, "relative (1)": relative, "rise (1)": values}
        )
        for name, values in series.items()
    ]
    degrees = len(force) - 1
    level = {
        "panel": "level",
        "series": f"95 % (t, {degrees} degrees of freedom)",
        "rise (1)": stats.t.ppf(0.975, degrees) ** 2,
    }
    profile = pd.concat(profiles).sort_values("relative (1)", kind="stable")
    frame = pd.concat(
        [pd.DataFrame(ridge), profile, pd.DataFrame([level])],
        ignore_index=True,
    )
    fitted = "measured mean" if MEAN in forces else "subject"
    frame.insert(1, "source", f"simulated, misfit to the {fitted}")
    return frame


def _residuals_frame(curve, forces, lengths) -> pd.DataFrame:
    parts = []

    def add(panel, series, who, source, depth, **columns) -> None:
        head = {"panel": panel, "series": series, "subject": who, "source": source}
        parts.append(pd.DataFrame(head | {DEPTH: depth * 1e3} | columns))

    for who, group in forces.items():
        depth, force = _si(group)
        needed = {"effective_length (mm)": force / curve.force_at(depth) * 1e3}
        source = "measured force over simulated force per length"
        add("length", "needed", who, source, depth, **needed)
        for model in LENGTHS:
            left = lengths[who, model].residual
            left = {"residual (N)": left, "residual (%)": 100 * left / force}
            add("residuals", model, who, "measured less simulated", depth, **left)
    last, depth = _last(forces), curve.depth[1:]
    for name, model in LENGTHS.items():
        fitted = 1e3 * model.length(curve, depth, lengths[last, name].value)
        columns = {"effective_length (mm)": fitted}
        add("length", name, last, "simulated, fitted", depth, **columns)
    return pd.concat(parts, ignore_index=True)


def _row(study, who, quantity, values, units="1", found=None, note="", parameters=1) -> dict:
    """A row of the estimates: values is a number, or one with its interval."""
    value, low, high = values if isinstance(values, tuple) else (values, np.nan, np.nan)
    row = dict(zip(ESTIMATE_COLUMNS, (study, who, quantity, value, low, high, units), strict=False))
    if found is not None:
        aicc = found.aicc(parameters)
        row |= {"data": len(found.residual), "rss (N2)": found.rss, "aicc": aicc}
    return row | {"note": note}


def _constant_rows(curves, forces, constants, specimen) -> Iterable[dict]:
    young = {name: specimen["layers"][name]["youngs_modulus"] for name in LAYERS}
    ratio = " : ".join(f"{young[name] / young['fat']:g}" for name in LAYERS)
    length, stiff = specimen["contact_length"], young["epidermis"] / 1e6
    modulus, long = "modulus constant", f"{length * 1e3:g} mm contact length"
    note = f"moduli {ratio}, epidermis {stiff:g} MPa; {long}"
    yield _row("stated in the thesis", "mean", modulus, 1.0, note=note)
    note = f"equal weights in N, {long}, moduli {ratio}; interval from the misfit, not from noise"
    for who, found in constants.items():
        yield _row("constant", who, modulus, found.times(1), "1", found, note)
        name = "Young's modulus of the epidermis"
        yield _row("constant", who, name, found.times(stiff), "MPa")
    subjects = [found.value for who, found in constants.items() if who != MEAN]
    if len(subjects) > 1:
        note, name = "interval from the scatter between subjects", f"{modulus}, geometric mean"
        yield _row("constant", "all", name, group_interval(subjects), note=note)
    last = _last(forces)
    best, group = constants[last], _si(forces[last])
    weighted = fit_constant(curves["plate"], *group, length, relative=True).times(1)
    note = "equal relative weights: what the choice of weights changes"
    yield _row("weights", last, modulus, weighted, note=note)
    study, name = "identifiability", "modulus constant x contact length"
    note = "the only thing that force tells"
    yield _row(study, last, name, best.times(length * 1e3), "mm", note=note)
    note = (
        "each known beforehand within a factor 10; "
        "a pressure or a width under known force would part them"
    )
    name = "correlation of log constant and log length"
    yield _row(study, last, name, length_correlation(best), note=note)
    yield _row(study, last, "rank of the sensitivities", 1.0, found=best, parameters=2)


def _length_rows(curve, forces, lengths) -> Iterable[dict]:
    last = _last(forces)
    depth, force = _si(forces[last])
    note = "with the thesis's moduli"
    for d, needed in zip(depth, 1e3 * force / curve.force_at(depth), strict=True):
        name = f"length needed at {d * 1e3:g} mm"
        yield _row("effective length", last, name, needed, "mm", note=note)
    for (who, name), found in lengths.items():
        model = LENGTHS[name]
        known = f"{note}; force tells {model.known} only"
        yield _row(name, who, model.parameter, found.times(model.scale), model.units, found, known)


def _other_rows(curves, forces, constants, length) -> Iterable[dict]:
    last, modulus = _last(forces), "modulus constant"
    for name, study in {
        "long_term": "moduli read as long-term",
        **{name: f"bone: {title}" for name, title in BONES.items()},
    }.items():
        if name not in curves:
            continue
        found = fit_constant(curves[name], *_si(forces[last]), length)
        note = "all of the moduli is then left when the force is read" * (name == "long_term")
        yield _row(study, last, modulus, found.times(1), "1", found, note)
        if name == "long_term":
            ratio = found.value / constants[last].value
            note = "g_inf but for the bulk modulus, which does not relax"
            quantity = "constant over that of the instantaneous reading"
            yield _row(study, last, quantity, ratio, note=note)


def _cost_rows(curve, forces, plate, coarse) -> Iterable[dict]:
    if coarse is not None:
        depth = _si(forces[_last(forces)])[0]
        rough = ElasticCurve.from_history(coarse).force_at(depth)
        error = 100 * np.abs(rough / curve.force_at(depth) - 1).max()
        note = "largest difference to twice the edge, at the measured depths"
        name = "discretisation error of the elastic curve"
        yield _row("cost", "", name, error, "%", note=note)
    name = "finite element simulations for all fits of the constant"
    note = "readings of the moduli and bone positions take one more each"
    yield _row("cost", "", name, 1.0, note=note)
    name, count = "Newton iterations of the elastic curve", float(plate.newton_iterations.sum())
    note = f"{plate.sizes['time'] - 1} load increments"
    yield _row("cost", "", name, count, note=note)


# -- calibrated specimens -------------------------------------------------------------------------


def specimen_text(who: str, found: Fit, specimen: Mapping, data: pd.DataFrame) -> str:
    """A specimen file with the moduli of `specimen` (SI, as in a history's scene) times the fitted
    constant.

    It has layers and their reading only; the rest of the specimen, its contact length above all, is
    the default's.
    """
    length = specimen["contact_length"] * 1e3
    chosen = data[(data["indenter"] == PLATE) & (data["speed_mm_per_s"] == 0)]
    chosen = chosen if who == MEAN else chosen[chosen["subject"] == who]
    title = "mean of the subjects" if who == MEAN else f"subject {who}"
    lines = [
        "# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json",
        "# Calibrated by `snakemake calibration` to steady forces under a flat plate, "
        f"{title}: {len(found.residual)} depths,",
        f"# {_cited(chosen)}.",
        f"# The thesis's moduli times {found.value:.4g} (95 % interval {found.low:.3g} to "
        f"{found.high:.3g}, from the misfit), at a",
        f"# contact length of {length:g} mm: force alone tells only their product, "
        f"{found.value * length:.4g} mm.",
        "layers:",
    ]
    for name in LAYERS:
        layer = specimen["layers"][name]
        modulus = f'"{found.value * layer["youngs_modulus"] / 1e6:.6g} MPa"'
        ratio = f"poisson_ratio: {layer['poisson_ratio']:g}"
        lines.append(f"  {name}: {{youngs_modulus: {modulus}, {ratio}}}")
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
            count += 1
            name = f"{stem}_{count}"
        names[who] = name
    return names


def write_specimens(
    directory: str | Path, result: Calibration, specimen: Mapping, data: pd.DataFrame
) -> list[Path]:
    """Write the calibrated specimen of every subject and of the mean; returns the paths."""
    paths = []
    for who, name in specimen_names(result.constants).items():
        paths.append(Path(directory) / f"{name}.yaml")
        write_text(paths[-1], specimen_text(who, result.constants[who], specimen, data))
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
