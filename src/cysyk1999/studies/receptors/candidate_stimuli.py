"""Candidate stimuli of slowly adapting receptors compared as predictors of impulse rates, with two
constants each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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

    Returns
    -------
    DataFrame
        One row a set of rates, candidate and depth: gain, threshold, R2, root-mean-square error of
        the curvatures left out one by one, and the rank by that error among candidates at 915 um.
        Where a surface is uncertain R2 has the range of all readings. The last columns need no
        rates: what is left at the end of the hold of what was there at its beginning, least and
        most of the nine surfaces at 40 gf/s. The recorded rates fall.
    """
    tables, surfaces = [], NINE.histories(histories)
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            continue
        common = _common_depths(matched)
        table = pd.DataFrame(
            {"rates": title, "kind": kind(group, matched), "candidate": name}
            | row
            | _held(surfaces, name, row["receptor_depth (um)"])
            for name, unit, deep, number in _candidates()
            for row in _judged(matched, group, unit, common if deep else [], number)
        )
        error, third = table["left_out_rms (impulses/s)"], table["depth"] == BEST_DEPTH
        table["rank"] = error[~third].rank(method="min")
        tables.append(table.iloc[np.lexsort((error, third))])
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()


def _held(surfaces: Mapping[str, xr.Dataset], name: str, depth: float) -> dict[str, float]:
    """Least and largest share of a candidate, over surfaces, that is left at the end of the hold;
    depth: um.
    """
    if name not in CANDIDATES or not surfaces:
        return {}
    traces = [(stimulus(h, name, depth * 1e-6), ramp_end(h)) for h in surfaces.values()]
    left = [values[-1] / values[top] for values, top in traces]
    title = "end of hold over its beginning"
    return {f"{title}, least": min(left), f"{title}, most": max(left)}


def _candidates() -> Iterator[tuple[str, str, bool, Callable]]:
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


def _inverse_width(history, window, depth):
    """Inverse contact width, 1/m: over the hold, as in thesis Fig 4-9, since it has no bound at
    first touch; or the largest.
    """
    width = history["contact_width"].values
    touching = width > 0
    time = history["time"].values[touching]
    return windowed(history, time, 1 / width[touching], window if window == "peak" else "hold")


def _common_depths(matched: Mapping[float, Sequence[xr.Dataset]]) -> list[float]:
    """Receptor depths (m) under the centre that all histories have."""
    depths = [
        history["receptor_depth"].values[np.abs(history["receptor_offset"].values) < 1e-7]
        for histories in matched.values()
        for history in histories
    ]
    return sorted(set.intersection(*(set(np.round(part, 7).tolist()) for part in depths)))


def _judged(matched, group, unit, depths, number) -> Iterator[dict]:
    """Rows of one candidate; depths (m) to try, none if it is on the skin."""
    data = group["rate_per_s"].to_numpy(float)

    def judge(depth):
        """For every way to read the surfaces: error of those left out, R2, law."""
        for curvature in assignments(group):
            value = across(
                matched, group, curvature, lambda history, window: number(history, window, depth)
            )
            law = gain_and_threshold(value, data)
            left_out = rms(data - leave_one_out(value, data, np.round(curvature)))
            yield left_out, r_squared(data, law(value)), law

    tried = {depth: list(judge(depth)) for depth in depths or [None]}
    chosen = {"on the skin": None}
    if depths:
        chosen = {"at 915 um": min(depths, key=lambda z: abs(z - RECEPTOR_DEPTH))}
    if len(tried) > 1:
        chosen[BEST_DEPTH] = min(tried, key=lambda z: tried[z][0][0])
    for how, depth in chosen.items():
        left_out, share, law = tried[depth][0]
        shares = [s for _, s, _ in tried[depth]]
        yield {
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
