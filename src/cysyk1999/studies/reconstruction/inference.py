"""From evidence to pads: posterior and evidence of each reading of the moduli, by importance
sampling from the prior.

The emulator costs microseconds a pad, and the evidence is made of intervals: of a hundred thousand
pads of the prior, drawn evenly (scrambled Sobol points), hundreds to thousands are left. That needs
no chain that could fail to mix: the evidence of a reading is the mean likelihood (its error from
the scatter), the posterior the pads resampled by it.

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
from cysyk1999.studies.reconstruction.unknowns import LOAD, STIFFNESS, Unknowns

SOFT, EPIDERMIS = "soft_factor", "epidermis_factor"
DRAWS, BLOCK = 2**17, 2**14
"""Pads drawn from the prior of each reading; how many the emulator predicts at once."""
SAMPLES = 1000
"""Pads of a posterior."""
LEAST_ROOM = 0.05
"""mm of fat that a pad has at least, wherever it is thinnest: more than the emulator is off."""
INTERVAL = 0.9
"""Of the intervals that are given: between the quantiles that leave half of the rest on either
side.
"""


@dataclass(frozen=True)
class Problem:
    """A reading of the moduli with the evidence.

    Attributes:
        known: the unknowns. reading: its name. emulator: of exactly the evidence's keys, in their
        order. evidence: the rows. room: an emulator of `pads.clearance`: pads without any cannot
        be. None: all can.
    """

    known: Unknowns
    reading: str
    emulator: Emulator
    evidence: Evidence
    room: Emulator | None = None

    @cached_property
    def names(self) -> list[str]:
        """What is free, in the order of a sample."""
        reading = self.known.readings[self.reading]
        fixed = {"bulk_modulus"} if reading.bulk_modulus is not None else set()
        free = [name for name in self.known.unknowns if name not in fixed]
        free += [SOFT] * (len(reading.soft) == 2)
        return free + [EPIDERMIS] * (reading.epidermis is not None and len(reading.epidermis) == 2)

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values (..., names) at shares from 0 to 1 of the priors."""
        reading, out = self.known.readings[self.reading], []
        for k, name in enumerate(self.names):
            s = share[..., k]
            if name in self.known.unknowns:
                out.append(self.known.unknowns[name].at(s))
            else:
                low, high = reading.soft if name == SOFT else reading.epidermis
                out.append(low * (high / low) ** s)
        return np.stack(out, axis=-1)

    def pad(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """All that a pad is, by name: unknowns, factors, and the axes of the design."""
        reading = self.known.readings[self.reading]
        found = dict(zip(self.names, np.moveaxis(np.asarray(values, float), -1, 0), strict=True))
        found.setdefault(SOFT, np.full(np.shape(values)[:-1], reading.soft[0]))
        if EPIDERMIS not in found:
            found[EPIDERMIS] = (
                found[SOFT]
                if reading.epidermis is None
                else np.full_like(found[SOFT], reading.epidermis[0])
            )
        if reading.bulk_modulus is not None:
            found["bulk_modulus"] = np.full_like(found[SOFT], reading.bulk_modulus)
        return found | {
            LOAD: found["line_load"] / found[SOFT],
            STIFFNESS: found[EPIDERMIS] / found[SOFT],
        }

    def shown(self, values: np.ndarray) -> np.ndarray:
        """What the thesis would show (n, rows) of pads (n, names)."""
        pad = self.pad(np.atleast_2d(values))
        found = self.emulator(self.known.to_unit({name: pad[name] for name in self.known.axes}))
        return self.evidence.shown(found, pad[SOFT], pad["plate_length"])

    def log_likelihood(self, values: np.ndarray) -> np.ndarray:
        """(n,) of pads (n, names)."""
        shown = self.shown(values)
        own = np.where(
            self.emulator.logarithmic, np.abs(shown) * self.emulator.error, self.emulator.error
        )
        found = -0.5 * (self.evidence.departure(shown, own) ** 2).sum(axis=-1)
        return np.where(self.can_be(values), found, -np.inf)

    def can_be(self, values: np.ndarray) -> np.ndarray:
        """(n,) which of pads (n, names) have room for their bone."""
        if self.room is None:
            return np.ones(len(values), bool)
        pad = self.pad(values)
        return (
            self.room(self.known.to_unit({name: pad[name] for name in self.known.axes}))[:, 0]
            > LEAST_ROOM
        )


@dataclass(frozen=True)
class Posterior:
    """What is known of a reading after the evidence.

    Attributes:
        problem: it. samples: (n, names), equally weighted. log_evidence, error: natural logarithm
        of the evidence and its error. left: effective number of draws. best: (names,) the most
        likely of them, and least_distance there.
    """

    problem: Problem
    samples: np.ndarray
    log_evidence: float
    error: float
    left: float
    best: np.ndarray
    least_distance: float

    def table(self) -> pd.DataFrame:
        """A row a quantity: median, interval, and the value of the best pad."""
        pad, best = self.problem.pad(self.samples), self.problem.pad(self.best[None])
        tail, rows = (1 - INTERVAL) / 2, []
        for name in (*self.problem.known.unknowns, SOFT, EPIDERMIS):
            low, middle, high = np.quantile(pad[name], [tail, 0.5, 1 - tail])
            unit = (
                self.problem.known.unknowns[name].unit
                if name in self.problem.known.unknowns
                else "1"
            )
            rows.append((self.problem.reading, name, unit, middle, low, high, float(best[name][0])))
        return pd.DataFrame(
            rows,
            columns=["reading", "quantity", "unit", "median", "low 5 %", "high 95 %", "best pad"],
        )


def infer(problem: Problem, draws: int = DRAWS, seed: int = 1999) -> Posterior:
    """Importance sampling of a problem; `draws` is a power of two."""
    rng = np.random.default_rng(seed)
    points = qmc.Sobol(len(problem.names), rng=rng).random(draws)
    values = problem.at(points)
    log = np.concatenate(
        [problem.log_likelihood(values[k : k + BLOCK]) for k in range(0, draws, BLOCK)]
    )
    weight = np.exp(log - log.max())
    mean = weight.mean()
    pick = rng.choice(draws, size=SAMPLES, p=weight / weight.sum())
    best = values[int(np.argmax(log))]
    distance = float(problem.evidence.distance(problem.shown(best[None]))[0])
    error = float(
        weight.std() / mean / np.sqrt(draws)
    )  # of independent draws: Sobol points do better
    left = float(weight.sum() ** 2 / (weight**2).sum())
    return Posterior(
        problem, values[pick], float(log.max() + np.log(mean)), error, left, best, distance
    )


def shares_of(posteriors: Iterable[Posterior]) -> pd.DataFrame:
    """A row a reading: its evidence, and its probability where all readings were as likely
    before.
    """
    found = list(posteriors)
    logs = np.array([p.log_evidence for p in found])
    weight = np.exp(logs - logs.max())
    return pd.DataFrame(
        {
            "reading": [p.problem.reading for p in found],
            "says": [p.problem.known.readings[p.problem.reading].says for p in found],
            "log evidence (1)": logs,
            "its error (1)": [p.error for p in found],
            "probability (1)": weight / weight.sum(),
            "least distance (1)": [p.least_distance for p in found],
        }
    )


def recovery(problem: Problem, trials: int, seed: int = 7, draws: int = DRAWS) -> pd.DataFrame:
    """Whether known pads are found again from the evidence that they would have left.

    Pads are drawn from the prior; what they show is read as the thesis is, between ticks. A row a
    trial and quantity: the truth, its interval, whether it is inside.
    """
    rng, rows = np.random.default_rng(seed), []
    for trial in range(trials):
        drawn = problem.at(rng.random((100, len(problem.names))))
        truth = drawn[problem.can_be(drawn)][0]
        shown = problem.shown(truth[None])[0]
        own = np.where(
            problem.emulator.logarithmic,
            np.abs(shown) * problem.emulator.error,
            problem.emulator.error,
        )
        left = problem.evidence.as_thesis(shown + own * rng.normal(size=len(own)))
        made = replace(problem, evidence=left)
        found = infer(made, draws, seed + trial)
        tail = (1 - INTERVAL) / 2
        low, high = np.quantile(found.samples, [tail, 1 - tail], axis=0)
        for k, name in enumerate(problem.names):
            rows.append(
                (trial, name, truth[k], low[k], high[k], bool(low[k] <= truth[k] <= high[k]))
            )
    return pd.DataFrame(
        rows, columns=["trial", "quantity", "truth", "low 5 %", "high 95 %", "covered"]
    )
