"""Predictions of the measurements: by this model, and by a half-space with the same transduction.

Each dataset is simulated as it was measured, in plane strain or round an axis, on the default pad.
Free constants are fitted to rows with the role ``fit`` alone.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.benchmark import half_space
from fingerpad.benchmark.rows import Row, datasets
from fingerpad.benchmark.score import Prediction, Predictions
from fingerpad.benchmark.transduction import Transduction, fitted
from fingerpad.healing import simulate
from fingerpad.results import leg_ends
from fingerpad.units import parse_quantity

DEPTHS = (0.3e-3, 0.6e-3, 0.8e-3, 0.915e-3)
"""m, of an SA-I receptor: TouchSim's, the thesis specimen's two, and one between."""
FELT = ("strain_energy_density", "compressive_strain")
CANDIDATES = tuple((felt, depth) for felt in FELT for depth in DEPTHS)
"""What a receptor may feel, and where; rows with the role ``fit`` choose one."""
ACCURACY, COARSER = "thesis", "draft"
"""Of the runs that count, and of those that tell what their mesh may be worth."""
BARS = (3.0, *[0.5] * 7, 3.0)
GAPS = (0.52, 0.49, 0.71, 0.98, 1.49, 1.96, 2.94, 4.97)
"""mm, of the grating, in their order."""
REGISTERED = 0.3e-3
"""m, within which the places of the grating are known."""
_RECEPTOR = "what is felt, its depth, a gain and a threshold, from "
CONSTANTS = {
    "force": "a factor of the force for each subject, from the plate at 2 mm",
    "profile": "none",
    "sa1_spheres": _RECEPTOR + "the spheres at 15 gf",
    "sa1_sphere_profiles": _RECEPTOR + "the spheres at 15 gf",
    "sa1_bar_held": _RECEPTOR + "one side of the bar",
    "sa1_grating": _RECEPTOR + "the two ends of the grating",
}
"""Datasets that are predicted, by the start of their name -> the constants that are fitted."""
NOT_PREDICTED = {
    "sa1_bar_onset": "the dynamic part of a receptor has no law here that was fitted to skin",
    "sa1_fields": "a probe among pressed probes is no body of two dimensions",
    "fa1_fields": "a probe among pressed probes is no body of two dimensions",
    "fa1_spheres": "no law of rapidly adapting units here was fitted to skin",
    "friction": "a coefficient of friction goes into a scene, it does not come out",
    "sliding_strain": "the two sources differ in force and method and state no section",
    "relaxation": "the default pad's times are the thesis's, which were read, not predicted",
    "volume": "the highest value seen, with no stimulus stated",
    "anatomy": "what models are built from",
}
"""Datasets that are not predicted -> why."""
Raw = tuple[np.ndarray, ...]
"""Numbers before constants are fitted, one for each of `CANDIDATES` of a rate and else one; and the
same on a coarser mesh, if there is one.
"""


def this_model(measured: Mapping[str, Iterable[Row]]) -> Predictions:
    """Predictions of this model for datasets, by simulation.

    Parameters
    ----------
    measured : mapping of str to list of Row
        As of :func:`fingerpad.benchmark.rows.datasets`.

    Returns
    -------
    dict
        Dataset and row -> `Prediction`; datasets of `NOT_PREDICTED` are left out.

    Raises
    ------
    NonConvergence
        A press could not be completed.
    """
    return _predicted(measured, _simulated)


def half_space_model(measured: Mapping[str, Iterable[Row]]) -> Predictions:
    """The same of an elastic half-space, :mod:`fingerpad.benchmark.half_space`."""
    return _predicted(measured, _closed_form)


_Model = Callable[[str, list[Row]], Iterable[Raw]]


def _predicted(measured: Mapping[str, Iterable[Row]], raw: _Model) -> Predictions:
    """Numbers of rows, with the constants that their kind has."""
    chosen = [name for name in measured if name.startswith(tuple(CONSTANTS))]
    kinds = {name: _calibrated_on(name) for name in chosen}
    needed = datasets(dict.fromkeys([*kinds.values(), *chosen])) if chosen else {}
    numbers = {name: list(raw(name, rows)) for name, rows in needed.items()}
    found: Predictions = {}
    for name in chosen:
        law = _constants(needed[kinds[name]], [value for value, *_ in numbers[kinds[name]]])
        pairs = list(zip(needed[name], numbers[name], strict=True))
        known = [(row, pair) for row, pair in pairs if np.isfinite(pair[0]).all()]
        both = {row.row: [float(law(row, each)) for each in pair] for row, pair in known}
        largest = max((abs(value) for value, *_ in both.values()), default=0.0) or 1.0
        for number, (value, *other) in both.items():
            found[name, number] = Prediction(value, *(abs(b - value) / largest for b in other))
    return found


def _calibrated_on(name: str) -> str:
    """The dataset whose rows a dataset's constants are fitted to."""
    if name.startswith("force"):
        return "force_plate"
    return "sa1_spheres" if name == "sa1_sphere_profiles" else name


def _constants(rows: list[Row], numbers: list[np.ndarray]) -> Callable[[Row, np.ndarray], float]:
    """What makes predictions of numbers: a factor a subject, a receptor, or nothing."""
    pairs = [(row, number) for row, number in zip(rows, numbers, strict=True) if row.role == "fit"]
    if not pairs:
        return lambda row, number: number[0]
    if rows[0].quantity == "impulse_rate":
        which, law = chosen_receptor(
            np.array([number for _, number in pairs]), np.array([row.value for row, _ in pairs])
        )
        return lambda row, number: float(law(number[which]))
    factors = {row.subject: row.value / number[0] for row, number in pairs}
    return lambda row, number: factors[row.subject] * number[0]


def chosen_receptor(stimuli: np.ndarray, rates: np.ndarray) -> tuple[int, Transduction]:
    """Which of stimuli (n, k) comes nearest to rates (n,), and its gain and threshold."""
    laws = [fitted(each, rates) for each in stimuli.T]
    misfits = [
        float(((law(each) - rates) ** 2).sum()) for law, each in zip(laws, stimuli.T, strict=True)
    ]
    best = int(np.argmin(misfits))
    return best, laws[best]


def others() -> dict[str, Predictions]:
    """Published numbers of other models, by name; each file states how they were made."""
    from fingerpad.benchmark.score import read_predictions

    folder = Path(__file__).parent / "others"
    return {path.stem: read_predictions(path) for path in sorted(folder.glob("*.csv"))}


# --- this model -----------------------------------------------------------------------------------


def _simulated(name: str, rows: list[Row]) -> list[Raw]:
    if name == "sa1_grating":
        return _over_grating(rows)
    found: dict[int, Raw] = {}
    for fragment in dict.fromkeys(json.dumps(row.scene, sort_keys=True) for row in rows):
        same = [row for row in rows if json.dumps(row.scene, sort_keys=True) == fragment]
        found |= _of_one_scene(json.loads(fragment), same)
    return [found[row.row] for row in rows]


def _of_one_scene(fragment: dict[str, Any], rows: list[Row]) -> dict[int, Raw]:
    """Numbers of rows that differ in load and place only: one run."""
    key, dimension = ("depth", "length") if "depth " in rows[0].at else ("force", "force")
    loads = sorted({row.place(key, dimension) for row in rows})
    unit = {"depth": "m", "force": "N"}[key]
    rates = rows[0].quantity == "impulse_rate"
    places = sorted({abs(row.place("x", "length")) for row in rows}) if rates else [0.0]
    scene = fragment | {
        "motion": [{f"press_to_{key}": f"{load!r} {unit}"} for load in loads],
        "outputs": _receptors(places),
    }
    two = _on_two_meshes(scene)
    return {
        row.row: tuple(
            _read(each.isel(time=loads.index(row.place(key, dimension))), row) for each in two
        )
        for row in rows
    }


def _on_two_meshes(scene: dict[str, Any]) -> tuple[xr.Dataset, ...]:
    """States at the ends of legs, on the mesh that counts and on a coarser one."""
    levels = ({"accuracy": each} for each in (ACCURACY, COARSER))
    return tuple(leg_ends(simulate(scene | level)) for level in levels)


def _receptors(places: Iterable[float]) -> dict[str, Any]:
    """Outputs of a scene: a receptor at every depth of `DEPTHS` and place (m)."""
    depths, offsets = ([f"{float(each)!r} m" for each in values] for values in (DEPTHS, places))
    return {"receptors": {"depths": depths, "offsets": offsets}}


def _read(state: xr.Dataset, row: Row) -> np.ndarray:
    """A row's number in one state of the skin, in the row's unit; of rates every candidate."""
    if row.quantity == "force":
        return np.array([float(state["force"])])
    if row.quantity == "deflection":
        return np.array([_beside(state, row.place("x", "length"))])
    return _felt(state, abs(row.place("x", "length")))[:, 0]


def _felt(state: xr.Dataset, *places: float) -> np.ndarray:
    """Every candidate's number (k, n) at places (m)."""
    depth, offset = state["receptor_depth"].values, state["receptor_offset"].values

    def at(felt: str, d: float, x: float) -> float:
        where = np.argmin(np.abs(depth - d) + np.abs(offset - x))
        return abs(float(state[felt][where]))

    return np.array([[at(*candidate, x) for x in places] for candidate in CANDIDATES])


def _beside(state: xr.Dataset, x: float) -> float:
    """How far the skin is down at a place, mm, mean of both sides."""
    rest = np.array([state["skin_x"].values, state["skin_y"].values])
    now = rest + np.array(
        [state["skin_displacement_x"].values, state["skin_displacement_y"].values]
    )
    down = [
        np.interp(side, *points[:, np.argsort(points[0])])
        for points in (rest, now)
        for side in (-x, x)
    ]
    return 1e3 * float(np.mean(down[:2]) - np.mean(down[2:]))


def grating() -> list[tuple[float, float]]:
    """Bars (from, to) m of the grating, the first from x = 0."""
    starts = np.concatenate([[0], np.cumsum(np.add(BARS[:-1], GAPS))])
    return [(1e-3 * a, 1e-3 * (a + w)) for a, w in zip(starts, BARS, strict=True)]


def _aims(row: Row) -> float:
    """Where on the grating a row's receptor is, m: the middle of a gap or of a narrow bar, the
    inner edge of a wide one.
    """
    kind, number = row.at.split(";")[1].split()
    bars, k = grating(), int(number) - 1
    if kind == "gap":
        return (bars[k][1] + bars[k + 1][0]) / 2
    if k in (0, len(bars) - 1):
        return bars[k][1] if k == 0 else bars[k][0]
    return sum(bars[k]) / 2


def _extreme(row: Row, felt: np.ndarray) -> np.ndarray:
    """Most (k,) over a bar, least in a gap, of numbers (k, n)."""
    return felt.max(axis=1) if "; bar" in row.at else felt.min(axis=1)


def _over_grating(rows: list[Row]) -> list[Raw]:
    """One press for each row, the grating moved so that the row's place is over the apex."""
    found, near = [], np.linspace(-REGISTERED, REGISTERED, 5)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "grating.csv"
        for row in rows:
            _write_grating(path, _aims(row))
            scene = {
                "stimulus": {"shape": "sampled", "csv": str(path), "smooth": "none"},
                "motion": [{"press_to_depth": f"{row.place('depth', 'length')!r} m"}],
                "outputs": _receptors(near),
            }
            states = (each.isel(time=-1) for each in _on_two_meshes(scene))
            found.append(tuple(_extreme(row, _felt(state, *near)) for state in states))
    return found


def _write_grating(path: Path, over: float, height: float = 2e-3, slope: float = 0.1e-3) -> None:
    """The grating's lower surface with the place `over` (m) at x = 0: bars `height` deep, whose
    sides lean by `slope`, for a surface has one height at each place.
    """
    points = []
    for a, b in grating():
        points += [(a - slope, height), (a, 0.0), (b, 0.0), (b + slope, height)]
    lines = [f"{1e3 * (x - over):.6f},{1e3 * y:.6f}" for x, y in points]
    path.write_text("\n".join(["x (mm),y (mm)", *lines]) + "\n", encoding="utf-8")


# --- the half-space -------------------------------------------------------------------------------


def _closed_form(name: str, rows: list[Row]) -> list[Raw]:
    return [(_alone(row),) for row in rows]


def _alone(row: Row) -> np.ndarray:
    """A row's number by a half-space, as of `_read`."""
    stimulus = {
        key: text
        if key in ("shape", "csv")
        else parse_quantity(text, _DIMENSIONS.get(key, "length"))
        for key, text in row.scene["stimulus"].items()
    }
    if row.quantity == "force":
        return half_space.force(stimulus, np.array([row.place("depth", "length")]))
    if row.quantity == "deflection":
        depth, x = row.place("depth", "length"), np.array([row.place("x", "length")])
        return 1e3 * half_space.deflection(stimulus["diameter"], depth, x)
    if stimulus["shape"] == "sampled":
        x = _aims(row) + np.linspace(-REGISTERED, REGISTERED, 5)
        return _extreme(row, _candidates(half_space.under_bars, grating(), x))
    x = np.array([row.place("x", "length")])
    if stimulus["shape"] == "bar":
        half = stimulus["width"] / 2
        return _candidates(half_space.under_bars, [(-half, half)], x)[:, 0]
    load, curvature = row.place("force", "force"), stimulus.get("curvature", 0.0)
    return _candidates(half_space.under_sphere, load, curvature, x)[:, 0]


def _candidates(under: Callable, *arguments: Any) -> np.ndarray:
    """Every candidate's number (k, n)."""
    states = [under(*arguments, depth) for depth in DEPTHS]  # in the order of FELT
    return np.concatenate([[state[k] for state in states] for k in range(len(FELT))])


_DIMENSIONS = {"curvature": "curvature", "half_angle": "angle"}
