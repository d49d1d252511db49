"""From evidence to pads: posterior and evidence of each reading of the moduli, by importance
sampling from the prior.

The emulator costs microseconds a pad, and the evidence is made of intervals: of a hundred thousand
pads of the prior, drawn evenly (scrambled Sobol points), hundreds to thousands are left. No chain
can then fail to mix: the evidence of a reading is the mean likelihood (its error from the scatter),
the posterior the pads resampled by it.

A reading has its own unknowns: those of the file, and the factors on the moduli that it leaves
free. The likelihood of a pad is ``exp(-d/2)``, d the sum of squared departures from the evidence
(:mod:`evidence`), the emulator's own error among the tolerances. All readings are judged by the
same rows, so that their evidences compare.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.stats import qmc

from cysyk1999.studies.reconstruction.emulator import Emulator
from cysyk1999.studies.reconstruction.evidence import Evidence
from cysyk1999.studies.reconstruction.unknowns import (
    EPIDERMIS,
    LOAD,
    SCALED,
    SOFT,
    STIFFNESS,
    Unknown,
    Unknowns,
)

DRAWS, BLOCK = 2**17, 2**14
"""Pads drawn from the prior of each reading; how many the emulator predicts at once."""
SAMPLES = 1000
"""Pads of a posterior."""
LEAST_ROOM = 0.05
"""mm of fat that a pad has at least, wherever it is thinnest: more than the emulator is off."""
TAILS = (0.05, 0.95)
"""Quantiles at the ends of the intervals."""


@dataclass(frozen=True)
class Problem:
    """A reading of the moduli with the evidence.

    Attributes
    ----------
    known : the unknowns.
    reading : its name.
    emulator : of exactly the evidence's keys, in their order.
    evidence : the rows.
    room : an emulator of `pads.clearance`, which excludes pads without any; None excludes none.
    """

    known: Unknowns
    reading: str
    emulator: Emulator
    evidence: Evidence
    room: Emulator | None = None

    @cached_property
    def free(self) -> dict[str, Unknown]:
        """Priors of what the reading leaves free, in the order of a sample."""
        reading = self.known.readings[self.reading]
        unknowns = {k: u for k, u in self.known.unknowns.items() if k not in reading.fixed}
        return unknowns | reading.free

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values (..., names) at shares from 0 to 1 of the priors."""
        return np.stack([u.at(share[..., k]) for k, u in enumerate(self.free.values())], axis=-1)

    def pad(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Everything a pad is, by name: unknowns, factors, and the axes of the design."""
        pad = dict(zip(self.free, np.moveaxis(np.asarray(values, float), -1, 0), strict=True))
        for name, value in self.known.readings[self.reading].fixed.items():
            pad[name] = np.full_like(pad[SCALED], value)
        pad.setdefault(EPIDERMIS, pad[SOFT])
        return pad | {LOAD: pad[SCALED] / pad[SOFT], STIFFNESS: pad[EPIDERMIS] / pad[SOFT]}

    def shown(self, values: np.ndarray) -> np.ndarray:
        """What the thesis would show (n, rows) of pads (n, names)."""
        pad = self.pad(np.atleast_2d(values))
        simulated = self.emulator(self.known.to_unit(pad))
        return self.evidence.shown(simulated, pad[SOFT], pad["plate_length"])

    def log_likelihood(self, values: np.ndarray) -> np.ndarray:
        """(n,) of pads (n, names)."""
        shown = self.shown(values)
        departure = self.evidence.departure(shown, self.emulator.deviation(shown))
        return np.where(self.possible(values), -0.5 * (departure**2).sum(axis=-1), -np.inf)

    def possible(self, values: np.ndarray) -> np.ndarray:
        """(n,) which of pads (n, names) have room for their bone."""
        if self.room is None:
            return np.ones(len(values), bool)
        return self.room(self.known.to_unit(self.pad(values)))[:, 0] > LEAST_ROOM


@dataclass(frozen=True)
class Posterior:
    """A reading after the evidence.

    Attributes
    ----------
    problem : the reading.
    samples : (n, names), equally weighted.
    log_evidence, error : natural logarithm of the evidence and its error.
    best, least_distance : (names,) the most likely draw, and its distance from the evidence.
    """

    problem: Problem
    samples: np.ndarray
    log_evidence: float
    error: float
    best: np.ndarray
    least_distance: float

    def table(self) -> pd.DataFrame:
        """A row a quantity: median, interval, and the value of the best pad."""
        pad, best = self.problem.pad(self.samples), self.problem.pad(self.best[None])
        unknowns = self.problem.known.unknowns
        units = {name: unknown.unit for name, unknown in unknowns.items()} | {
            SOFT: "1",
            EPIDERMIS: "1",
        }
        low, median, high = np.quantile([pad[k] for k in units], [TAILS[0], 0.5, TAILS[1]], axis=1)
        return pd.DataFrame(
            {
                "reading": self.problem.reading,
                "quantity": units.keys(),
                "unit": units.values(),
                "median": median,
                "low 5 %": low,
                "high 95 %": high,
                "best pad": [float(best[name][0]) for name in units],
            }
        )


def infer(problem: Problem, draws: int = DRAWS, seed: int = 1999) -> Posterior:
    """Importance sampling of a problem; `draws` is a power of two."""
    rng = np.random.default_rng(seed)
    values = problem.at(qmc.Sobol(len(problem.free), rng=rng).random(draws))
    blocks = np.split(values, range(BLOCK, draws, BLOCK))
    log = np.concatenate([problem.log_likelihood(block) for block in blocks])
    weight = np.exp(log - log.max())
    mean = weight.mean()
    samples = values[rng.choice(draws, size=SAMPLES, p=weight / weight.sum())]
    best = values[np.argmax(log)]
    distance = float(problem.evidence.distance(problem.shown(best))[0])
    # the error is that of independent draws: Sobol points do better
    error = float(weight.std() / mean / np.sqrt(draws))
    return Posterior(problem, samples, float(log.max() + np.log(mean)), error, best, distance)


def probabilities(log_evidence: pd.Series) -> pd.Series:
    """Probabilities of readings that were equally likely before."""
    weight = np.exp(log_evidence - log_evidence.max())
    return weight / weight.sum()


def evidences(posteriors: Iterable[Posterior]) -> pd.DataFrame:
    """A row a reading: its evidence, and its probability among these."""
    rows = [
        {
            "reading": p.problem.reading,
            "says": p.problem.known.readings[p.problem.reading].says,
            "log evidence (1)": p.log_evidence,
            "its error (1)": p.error,
            "least distance (1)": p.least_distance,
        }
        for p in posteriors
    ]
    table = pd.DataFrame(rows)
    table.insert(4, "probability (1)", probabilities(table["log evidence (1)"]))
    return table


def recovery(problem: Problem, trials: int, seed: int = 7, draws: int = DRAWS) -> pd.DataFrame:
    """Whether known pads are found again from the evidence that they would have left.

    Pads are drawn from the prior; what they show is read as the thesis is, between ticks. A row a
    trial and quantity: the truth, its interval, whether it is inside.
    """
    rng, tables = np.random.default_rng(seed), []
    for trial in range(trials):
        drawn = problem.at(rng.random((100, len(problem.free))))
        truth = drawn[problem.possible(drawn)][0]
        shown = problem.shown(truth)[0]
        error = problem.emulator.deviation(shown) * rng.normal(size=len(shown))
        left = replace(problem, evidence=problem.evidence.as_thesis(shown + error))
        low, high = np.quantile(infer(left, draws, seed + trial).samples, TAILS, axis=0)
        table = {"trial": trial, "quantity": list(problem.free), "truth": truth}
        table |= {"low 5 %": low, "high 95 %": high, "covered": (low <= truth) & (truth <= high)}
        tables.append(pd.DataFrame(table))
    return pd.concat(tables, ignore_index=True)
