"""Figure regression: plotted data compared tightly, pictures loosely, with the committed ones.

Baselines, all committed:

- ``tests/baselines/fig_<number>.csv``: every figure from simulations on coarse meshes, which the
  tests run afresh. They catch a
  change of the mechanics or of a figure's data.
- ``tests/baselines/thesis.csv``: a summary of every curve in ``figures/thesis/*.csv``. It catches a
  change of the published data
  even where the thesis-resolution results are not at hand, or were overwritten.
- ``figures/thesis/*.png`` themselves: they catch a change of a figure's drawing.

A deliberate change is accepted by ``make regression-update``, then committed.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pandas as pd

from cysyk1999.measures.errors import PARTS
from cysyk1999.measures.quantities import QUANTITIES
from cysyk1999.publishing.tables import TEXT_COLUMNS

TOLERANCES = {name: q.tolerance for name, q in QUANTITIES.items() if q.tolerance} | {
    "element": 1e-5,
    "value": 1e-3,
}
"""Largest difference allowed in a column, relative to the largest value of the curve."""

ERROR_TOLERANCE = 0.2
"""The same for the columns of errors, small differences of large numbers."""

ROUND_OFF = 1e-3
"""% that an error may differ by all the same: less is round-off, other on each machine."""

SIMILARITY = 0.98
"""Least structural similarity of two pictures, averaged where either has ink (1: the same)."""

BASELINE_DPI = 60
"""Resolution of pictures that are compared with each other only."""


def tolerance(column: str) -> float:
    """Relative tolerance of a column. Raises KeyError for a column without one."""
    return ERROR_TOLERANCE if column in PARTS else TOLERANCES[column]


def floor(column: str) -> float:
    """Difference allowed in a column whatever its size, in its unit."""
    return ROUND_OFF if column in PARTS else 1e-12


def split_curves(frame: pd.DataFrame) -> Iterable[tuple[str, pd.DataFrame]]:
    """Curves of a frame: rows equal in every text column, with a name made of them; what the thesis
    says in words is none.
    """
    frame = frame[~frame["source"].astype(str).str.startswith("thesis statement")]
    keys = [c for c in TEXT_COLUMNS if c in frame]
    keys += [c for c in ("receptor_depth (um)", "node_x (mm)") if c in frame]
    for names, rows in frame.groupby(keys, dropna=False, sort=False):
        yield (
            ", ".join(f"{n:g}" if isinstance(n, float) else str(n) for n in names if n == n),
            rows.drop(columns=keys),
        )


def differences(frame: pd.DataFrame, baseline: pd.DataFrame) -> list[str]:
    """What differs between two frames of a figure by more than the tolerances; empty if nothing
    does.

    Columns, curves and the number of points must be the same; numbers are compared point by point,
    relative to the largest magnitude in the curve.
    """
    if list(frame.columns) != list(baseline.columns):
        return [f"columns {list(frame.columns)}, baseline {list(baseline.columns)}"]
    ours, theirs = (dict(split_curves(f)) for f in (frame, baseline))
    found = [f"{name}: only in the new data" for name in ours.keys() - theirs.keys()]
    found += [f"{name}: only in the baseline" for name in theirs.keys() - ours.keys()]
    for name in theirs.keys() & ours.keys():
        new, old = ours[name], theirs[name]
        if len(new) != len(old):
            found.append(f"{name}: {len(new)} points, baseline {len(old)}")
            continue
        for column in old.columns:
            a, b = new[column].to_numpy(float), old[column].to_numpy(float)
            if (np.isnan(a) != np.isnan(b)).any():
                found.append(f"{name}: {column} is missing in one and not in the other")
                continue
            scale = np.nanmax(abs(b), initial=0.0)
            worst = np.nanmax(abs(a - b), initial=0.0)
            if worst > tolerance(column) * scale + floor(column):
                share = worst / scale if scale else np.inf
                found.append(f"{name}: {column} differs by {share:.2%} of its largest")
    return sorted(found)


def summary(frames: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """Every curve of several figures in five numbers a column: count, least, largest, mean, rms."""
    rows = []
    for number, frame in frames.items():
        for name, curve in split_curves(frame):
            for column in curve.columns:
                values = curve[column].dropna().to_numpy(float)
                if values.size:
                    rows.append(
                        {
                            "figure": number,
                            "curve": name,
                            "column": column,
                            "count": values.size,
                            "least": values.min(),
                            "largest": values.max(),
                            "mean": values.mean(),
                            "rms": np.sqrt(np.mean(values**2)),
                        }
                    )
    return pd.DataFrame(rows)


def summary_differences(new: pd.DataFrame, baseline: pd.DataFrame) -> list[str]:
    """What differs between two summaries by more than the tolerances; empty if nothing does."""
    keys = ["figure", "curve", "column"]
    both = new.merge(baseline, on=keys, how="outer", suffixes=("", "_old"), indicator=True)
    found = []
    for row in both.to_dict("records"):
        name = f"Fig. {row['figure']}, {row['curve']}, {row['column']}"
        if row["_merge"] != "both":
            found.append(
                f"{name}: only in the {'new data' if row['_merge'] == 'left_only' else 'baseline'}"
            )
        elif row["count"] != row["count_old"]:
            found.append(f"{name}: {row['count']:.0f} points, baseline {row['count_old']:.0f}")
        else:
            # the summary has six digits
            allowed = (tolerance(row["column"]) + 5e-6) * max(
                abs(row["least_old"]), abs(row["largest_old"])
            ) + floor(row["column"])
            for what in ("least", "largest", "mean", "rms"):
                if abs(row[what] - row[f"{what}_old"]) > allowed:
                    found.append(
                        f"{name}: {what} {row[what]:.6g}, baseline {row[f'{what}_old']:.6g}"
                    )
    return found


def similarity(first: Path, second: Path, shrink: int = 1) -> float:
    """Structural similarity (Wang et al. 2004) of two grey pictures over the inked part; 0 if sizes
    differ.

    `shrink` averages blocks of that many pixels first. White paper is left out of the mean: in a
    line drawing it would hide a missing curve.
    """
    from scipy.ndimage import maximum_filter
    from skimage.metrics import structural_similarity

    one, two = (_grey(p, shrink) for p in (first, second))
    if one.shape != two.shape:
        return 0.0
    _, local = structural_similarity(one, two, data_range=1.0, full=True)
    ink = maximum_filter(np.maximum(1 - one, 1 - two) > 0.1, size=3)
    return float(local[ink].mean()) if ink.any() else 1.0


def _grey(path: Path, shrink: int) -> np.ndarray:
    from PIL import Image

    with Image.open(path) as picture:
        grey = np.asarray(picture.convert("L"), float) / 255
    high, wide = (n // shrink * shrink for n in grey.shape)
    return (
        grey[:high, :wide].reshape(high // shrink, shrink, wide // shrink, shrink).mean(axis=(1, 3))
    )
