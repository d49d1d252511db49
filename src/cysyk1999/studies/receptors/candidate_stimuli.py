"""Candidate stimuli of slowly adapting receptors compared as predictors of impulse rates, with two
constants each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.responses import (
    CANDIDATES,
    RECEPTOR_DEPTH,
    curvature_of,
    stimulus,
    windowed,
)
from cysyk1999.measures.runs import NINE
from cysyk1999.receptors.fits import gain_and_threshold, leave_one_out, r_squared, rms
from cysyk1999.studies.receptors.impulse_rates import (
    across,
    assignments,
    kind,
    matched_histories,
    rate_sets,
)
from fingerpad.measures.features import Histories, ramp_end
from fingerpad.measures.kept import kept

BEST_DEPTH = "best of those simulated"


def candidate_stimuli(histories: Histories, rates: pd.DataFrame) -> pd.DataFrame:
    """Candidate stimuli as predictors of the rates at hand, each with a gain and a threshold, best
    first within a set of rates.

    Every candidate is averaged over the window the rates are of. Those under the skin are taken at
    915 um, where the thesis predicts from, and then at the best of the simulated depths, which is a
    third constant. "curvature" and "inverse contact width" need no receptor and show what little a
    good R2 takes.

    Returns:
        One row a set of rates, candidate and depth: gain, threshold, R2, root-mean-square error of
        the curvatures left out one by one, and the rank by that error among candidates at 915 um.
        Where a surface is uncertain R2 has the range of all readings. The last columns need no
        rates: what is left at the end of the hold of what was there at its beginning, least and
        most of the nine surfaces at 40 gf/s. The recorded rates fall.
    """
    rows, surfaces = [], NINE.histories(histories)
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            continue
        choices = assignments(group)
        of_set = [
            {"rates": title, "kind": kind(group), "candidate": name}
            | row
            | _held(surfaces, name, row["receptor_depth (um)"])
            for name, unit, depths, number in _candidates()
            for row in _judged(
                matched, group, choices, unit, depths and _common_depths(matched), number
            )
        ]
        frame = pd.DataFrame(of_set)
        error, third = frame["left_out_rms (impulses/s)"], frame["depth"] == BEST_DEPTH
        frame["rank"] = error[~third].rank(method="min")
        rows.append(frame.iloc[np.lexsort((error, third))])
    return pd.concat(rows, ignore_index=True) if rows else pd.DataFrame()


def _held(surfaces: Mapping[str, xr.Dataset], name: str, depth: float) -> dict[str, float]:
    """Least and largest share of a candidate, over surfaces, that is left at the end of the hold;
    depth: um.
    """
    if name not in CANDIDATES or not surfaces:
        return {}
    left = [
        values[-1] / values[ramp_end(h)]
        for h in surfaces.values()
        for values in [stimulus(h, name, depth * 1e-6)]
    ]
    return {
        "end of hold over its beginning, least": min(left),
        "end of hold over its beginning, most": max(left),
    }


def _candidates():
    """Name, unit, whether it is taken at a depth, and number of every candidate."""
    for name, (_, unit, deep) in CANDIDATES.items():
        yield name, unit, deep, partial(_average, name=name)
    yield "curvature", "1/m", False, lambda history, window, depth: curvature_of(history)
    yield "inverse contact width", "1/m", False, _inverse_width


@kept
def _average(history, window, depth, name):
    """Of a candidate over a window, as every reading of every set of rates asks for it."""
    return windowed(
        history, history.variables["time"].values, stimulus(history, name, depth), window
    )


def _common_depths(matched: Mapping[float, Sequence[xr.Dataset]]) -> list[float]:
    """Receptor depths (m) under the centre that all histories have."""

    def depths(history):
        return {
            round(float(z), 7)
            for z, x in zip(
                history["receptor_depth"].values, history["receptor_offset"].values, strict=True
            )
            if abs(x) < 1e-7
        }

    return sorted(
        set.intersection(
            *(depths(history) for histories in matched.values() for history in histories)
        )
    )


def _inverse_width(history, window, depth):
    """Inverse contact width, 1/m: over the hold, as in thesis Fig 4-9, since it has no bound at
    first touch; or the largest.
    """
    width = history["contact_width"].values
    touching = width > 0
    return windowed(
        history,
        history["time"].values[touching],
        1 / width[touching],
        "hold" if window != "peak" else window,
    )


def _judged(matched, group, choices, unit, depths, number) -> list[dict]:
    """Rows of one candidate; depths (m) to try, none if it is on the skin."""
    data = group["rate_per_s"].to_numpy(float)

    def judge(depth):
        out = []
        for curvature in choices:
            value = across(matched, group, curvature, _at(number, depth))
            law = gain_and_threshold(value, data)
            left_out = rms(data - leave_one_out(value, data, np.round(curvature)))
            out.append((left_out, r_squared(data, law(value)), law))
        return out

    tried = {depth: judge(depth) for depth in depths or [None]}
    chosen = (
        [("at 915 um", min(depths, key=lambda z: abs(z - RECEPTOR_DEPTH)))]
        if depths
        else [("on the skin", None)]
    )
    if len(tried) > 1:
        chosen.append((BEST_DEPTH, min(tried, key=lambda z: tried[z][0][0])))
    rows = []
    for how, depth in chosen:
        left_out, share, law = tried[depth][0]
        shares = [s for _, s, _ in tried[depth]]
        rows.append(
            {
                "depth": how,
                "receptor_depth (um)": np.nan if depth is None else depth * 1e6,
                "gain (impulses/s per unit)": law.gain,
                "threshold": law.threshold,
                "unit": unit,
                "r_squared": share,
                "r_squared_low": min(shares),
                "r_squared_high": max(shares),
                "left_out_rms (impulses/s)": left_out,
                "left_out_rms (% of the mean)": 100 * left_out / data.mean(),
                "rates used": len(data),
            }
        )
    return rows


def _at(number, depth):
    return lambda history, window: number(history, window, depth)
