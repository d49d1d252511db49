"""From evidence to pads: posterior and evidence of each reading of the moduli, by nested sampling
(Skilling 2006, Bayesian Anal. 1:833; dynesty, Speagle 2020, MNRAS 493:3132).

A reading has its own unknowns: those of the file, and the factors on the moduli that it leaves
free. The likelihood of a pad is ``exp(-d/2)``, d the sum of squared departures from the evidence
(:mod:`evidence`), the emulator's own error among the tolerances. All readings are judged by the
same rows, so that their evidences compare.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import dynesty
import numpy as np
import pandas as pd

from cysyk1999.studies.reconstruction.emulator import Emulator
from cysyk1999.studies.reconstruction.evidence import Evidence
from cysyk1999.studies.reconstruction.unknowns import (
    BULK,
    ENERGY,
    EPIDERMIS,
    EPIDERMIS_BULK,
    LOAD,
    SCALED,
    SOFT,
    STIFFNESS,
    STROKE_ENERGY,
    Unknown,
    Unknowns,
)

LIVE, LEFT = 100, 0.2
"""Live points; the share of the evidence, in its logarithm, that may be left in them at the end."""
IMPOSSIBLE = -1e10
"""Logarithm of the likelihood of a pad without room for its bone."""
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
        given = {EPIDERMIS_BULK, *reading.fixed}
        unknowns = {k: u for k, u in self.known.unknowns.items() if k not in given}
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
        pad.setdefault(EPIDERMIS_BULK, pad[BULK])
        for factor in (ENERGY, STROKE_ENERGY):
            pad.setdefault(factor, np.ones_like(pad[SCALED]))
        return pad | {LOAD: pad[SCALED] / pad[SOFT], STIFFNESS: pad[EPIDERMIS] / pad[SOFT]}

    def shown(self, values: np.ndarray) -> np.ndarray:
        """What the thesis would show (n, rows) of pads (n, names)."""
        return self._shown(self.pad(np.atleast_2d(values)))[0]

    def _shown(self, pad: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """What the thesis would show (n, rows) of pads, and their shares of the design's ranges."""
        shares = self.known.to_unit(pad)
        factors = pad["plate_length"], pad[ENERGY], pad[STROKE_ENERGY]
        shown = self.evidence.shown(self.emulator(shares), pad[SOFT], *factors)
        return shown, shares

    def log_likelihood(self, values: np.ndarray) -> np.ndarray:
        """(n,) of pads (n, names)."""
        shown, shares = self._shown(self.pad(values))
        departure = self.evidence.departure(shown, self.emulator.deviation(shown))
        return np.where(self._fits(shares), -0.5 * (departure**2).sum(axis=-1), IMPOSSIBLE)

    def possible(self, values: np.ndarray) -> np.ndarray:
        """(n,) which of pads (n, names) have room for their bone."""
        return self._fits(self.known.to_unit(self.pad(values)))

    def _fits(self, shares: np.ndarray) -> np.ndarray:
        if self.room is None:
            return np.ones(len(shares), bool)
        return self.room(shares)[:, 0] > LEAST_ROOM


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
        units = {name: unknown.unit for name, unknown in unknowns.items()}
        units |= dict.fromkeys((SOFT, EPIDERMIS, EPIDERMIS_BULK, ENERGY, STROKE_ENERGY), "1")
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


def infer(problem: Problem, live: int = LIVE, seed: int = 1999) -> Posterior:
    """Nested sampling of a problem with so many live points."""
    rng = np.random.default_rng(seed)
    sampler = dynesty.NestedSampler(
        lambda values: float(problem.log_likelihood(values[None])[0]),
        problem.at,
        len(problem.free),
        nlive=live,
        sample="rwalk",
        rstate=rng,
    )
    sampler.run_nested(dlogz=LEFT, print_progress=False)
    found = sampler.results
    best = found.samples[np.argmax(found.logl)]
    distance = float(problem.evidence.distance(problem.shown(best))[0])
    drawn = found.samples_equal(rstate=rng)
    samples = drawn[rng.permutation(len(drawn))[:SAMPLES]]
    return Posterior(
        problem, samples, float(found.logz[-1]), float(found.logzerr[-1]), best, distance
    )


def probabilities(log_evidence: pd.Series) -> pd.Series:
    """Probabilities of readings that were equally likely before."""
    weight = np.exp(log_evidence - log_evidence.max())
    return weight / weight.sum()


def recovery(problem: Problem, trials: int, seed: int = 7, live: int = LIVE) -> pd.DataFrame:
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
        low, high = np.quantile(infer(left, live, seed + trial).samples, TAILS, axis=0)
        table = {"trial": trial, "quantity": list(problem.free), "truth": truth}
        table |= {"low 5 %": low, "high 95 %": high, "covered": (low <= truth) & (truth <= high)}
        tables.append(pd.DataFrame(table))
    return pd.concat(tables, ignore_index=True)
