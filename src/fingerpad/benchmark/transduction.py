"""From what a receptor feels to impulses: a gain and a threshold, the same for every model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Transduction:
    """Rate ``gain * [stimulus - threshold]+``; 1/s of the stimulus's unit, and that unit."""

    gain: float
    threshold: float

    def __call__(self, stimulus: np.ndarray) -> np.ndarray:
        """Rates, 1/s."""
        return self.gain * np.maximum(np.asarray(stimulus, float) - self.threshold, 0.0)


def fitted(stimulus: np.ndarray, rate: np.ndarray) -> Transduction:
    """The gain and threshold nearest to rates by least squares.

    With the weakest k stimuli silent the others lie on a line, so every k is tried.

    Parameters
    ----------
    stimulus, rate : (n,) array
        n of 3 or more.

    Examples
    --------
    >>> from fingerpad.benchmark.transduction import fitted
    >>> fitted([1, 2, 3, 4], [0, 0, 5, 10])
    Transduction(gain=5.0, threshold=2.0)
    """
    stimulus, rate = np.asarray(stimulus, float), np.asarray(rate, float)
    order, scale = np.argsort(stimulus), float(np.abs(stimulus).max())
    best, least = Transduction(0.0, 0.0), np.inf
    for k in range(len(stimulus) - 1):
        used = order[k:]
        if np.ptp(stimulus[used]) < 1e-9 * scale:
            break
        gain, offset = np.polyfit(stimulus[used] / scale, rate[used], 1)
        if gain <= 0:
            continue
        law = Transduction(float(gain / scale), float(-offset * scale / gain))
        misfit = float(((law(stimulus) - rate) ** 2).sum())
        if misfit < least * (1 - 1e-9):
            best, least = law, misfit
    return Transduction(*(float(f"{each:.12g}") for each in (best.gain, best.threshold)))
