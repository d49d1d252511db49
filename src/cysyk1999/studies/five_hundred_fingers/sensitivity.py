"""Global sensitivity of what is felt to what is not known of a finger: Sobol indices of an emulator
of the sweep.

The sweep has too few scenes for Sobol indices by themselves (Saltelli's design takes N (D + 2)),
and more than enough for a polynomial in all unknowns: total degree 2, in curvature 4 and 3 times
any other. The emulator is judged by leaving scenes out (Q2, the share of the variance that it
explains of scenes it has not seen); SALib's indices are its own.

Sudret 2008, Reliab. Eng. Syst. Saf. 93:964 (polynomial emulators); Saltelli and others 2010,
Comput. Phys. Commun. 181:259.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

CURVATURE = "curvature (1/m)"
MEASURES = {
    "indentation_depth_end (mm)": "depth",
    "contact_width_end (mm)": "contact width",
    "peak_pressure_end (Pa)": "peak pressure",
    "strain_energy_915_um_end (Pa)": "strain energy",
    "predicted_rate_915_um_highest (impulses/s)": "highest rate",
    "steady_rate_915_um_end (impulses/s)": "steady rate",
}
"""Measures by their column, and as they are called in the picture."""
UNKNOWNS = {
    "apex_radius (mm)": "pad radius",
    "epidermis_thickness (mm)": "epidermis, thickness",
    "dermis_thickness (mm)": "dermis, thickness",
    "epidermis_youngs_modulus (kPa)": "epidermis, modulus",
    "dermis_youngs_modulus (kPa)": "dermis, modulus",
    "fat_youngs_modulus (kPa)": "fat, modulus",
    "g (1)": "relaxation, share",
    "tau (s)": "relaxation, time",
    "contact_length (mm)": "contact length",
}
"""What is not known of a finger, by column."""
AT = (79.0, 210.0, 630.0)
"""Curvatures (1/m) at which indices are given."""
FOLDS, BASE, SEED = 16, 1024, 1999


def shares(table: pd.DataFrame) -> np.ndarray:
    """Shares (n, 1 + unknowns) from 0 to 1 of curvature's and every unknown's distribution: ranks,
    as the points are even.
    """
    columns = table[[CURVATURE, *UNKNOWNS]]
    return ((columns.rank() - 0.5) / len(columns)).to_numpy()


def features(share: np.ndarray) -> np.ndarray:
    """Terms (n, k) of the polynomial at shares (n, d), in Legendre polynomials; the first share is
    curvature's.
    """
    x = 2 * np.asarray(share, float) - 1
    p = [
        np.ones_like(x),
        x,
        (3 * x**2 - 1) / 2,
        (5 * x**3 - 3 * x) / 2,
        (35 * x**4 - 30 * x**2 + 3) / 8,
    ]
    d = x.shape[1]
    terms = [p[0][:, 0], *p[1].T, *p[2].T, p[3][:, 0], p[4][:, 0]]
    terms += [p[1][:, i] * p[1][:, j] for i in range(d) for j in range(i + 1, d)]
    terms += [p[n][:, 0] * p[1][:, j] for n in (2, 3) for j in range(1, d)]
    return np.column_stack(terms)


@dataclass(frozen=True)
class Emulator:
    """A measure as a polynomial of shares; `q2`: the share of the variance that it explains of
    scenes left out.
    """

    weights: np.ndarray
    logarithmic: bool
    q2: float

    def __call__(self, share: np.ndarray) -> np.ndarray:
        found = features(share) @ self.weights
        return np.exp(found) if self.logarithmic else np.maximum(found, 0.0)


def emulator(share: np.ndarray, values: np.ndarray) -> Emulator:
    """Fit a measure (n,): its logarithm where all values are above zero. Scenes without a value are
    left out.
    """
    known = np.isfinite(values)
    terms, values = features(share[known]), values[known]
    logarithmic = bool((values > 0).all())
    target = np.log(values) if logarithmic else values
    fold = np.arange(len(target)) % FOLDS
    left_out = np.empty_like(target)
    for k in range(FOLDS):
        left_out[fold == k] = (
            terms[fold == k] @ np.linalg.lstsq(terms[fold != k], target[fold != k], rcond=None)[0]
        )
    predicted = np.exp(left_out) if logarithmic else np.maximum(left_out, 0.0)
    q2 = 1 - ((values - predicted) ** 2).sum() / ((values - values.mean()) ** 2).sum()
    return Emulator(np.linalg.lstsq(terms, target, rcond=None)[0], logarithmic, float(q2))


def curvature_share(table: pd.DataFrame, curvature: float) -> float:
    """Share of the sweep's curvatures below one (1/m)."""
    return float(
        np.clip(
            np.interp(
                curvature, np.sort(table[CURVATURE]), (np.arange(len(table)) + 0.5) / len(table)
            ),
            0,
            1,
        )
    )


def indices(table: pd.DataFrame, curvatures: tuple[float, ...] = AT) -> pd.DataFrame:
    """Sobol indices: a row for each measure, curvature and unknown, first and total with their 95 %
    intervals.
    """
    from SALib.analyze import sobol
    from SALib.sample import sobol as sample

    share, rows = shares(table), []
    problem = {
        "num_vars": len(UNKNOWNS),
        "names": list(UNKNOWNS),
        "bounds": [[0.0, 1.0]] * len(UNKNOWNS),
    }
    points = sample.sample(problem, BASE, calc_second_order=False, seed=SEED)
    for column, measure in MEASURES.items():
        emulated = emulator(share, table[column].to_numpy(float))
        for curvature in curvatures:
            at = np.column_stack([np.full(len(points), curvature_share(table, curvature)), points])
            found = sobol.analyze(problem, emulated(at), calc_second_order=False, seed=SEED)
            for k, unknown in enumerate(UNKNOWNS.values()):
                rows.append(
                    {
                        "measure": measure,
                        CURVATURE: curvature,
                        "unknown": unknown,
                        "first_order (1)": found["S1"][k],
                        "first_order_95 (1)": found["S1_conf"][k],
                        "total (1)": found["ST"][k],
                        "total_95 (1)": found["ST_conf"][k],
                        "q2 (1)": emulated.q2,
                    }
                )
    return pd.DataFrame(rows)


def bands(
    table: pd.DataFrame, column: str, quantiles: tuple[float, ...] = (0.05, 0.25, 0.5, 0.75, 0.95)
) -> pd.DataFrame:
    """Quantiles of a measure over fingers against curvature, of the emulator."""
    share = shares(table)
    emulated, fingers = (
        emulator(share, table[column].to_numpy(float)),
        np.random.default_rng(SEED).random((4000, len(UNKNOWNS))),
    )
    curvatures = np.geomspace(table[CURVATURE].min(), table[CURVATURE].max(), 40)
    rows = []
    for curvature in curvatures:
        at = np.column_stack([np.full(len(fingers), curvature_share(table, curvature)), fingers])
        rows.append([curvature, *np.quantile(emulated(at), quantiles)])
    return pd.DataFrame(rows, columns=[CURVATURE, *quantiles])
