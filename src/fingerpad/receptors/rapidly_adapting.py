"""Rapidly adapting receptors: impulses while a stimulus changes, whichever way, and none while it
is held.

The thesis models slowly adapting receptors only; of rapidly adapting ones it reports that they fire
at the beginning of the ramp or not at all, whatever the curvature, and supposes that they respond
to the rate at which the skin's curvature changes (Cysyk 1999, section 4.2, after Srinivasan and
LaMotte 1991). Threshold and saturation are not stated anywhere at hand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad.receptors.laws import rectified


@dataclass(frozen=True)
class RapidlyAdapting:
    """Impulse rate from the rate of a stimulus: ``highest * (1 - exp(-[|rate| - threshold]+ /
    scale))``.

    Attributes
    ----------
    threshold
        In the unit of the stimulus by second; slower changes are not felt.
    scale
        Likewise, of the approach to saturation.
    highest
        Impulses/s.
    """

    threshold: float
    scale: float
    highest: float

    def __call__(self, rate) -> np.ndarray:
        """Impulse rate, impulses/s, of a stimulus's rate of change."""
        return self.highest * -np.expm1(
            -rectified(np.abs(np.asarray(rate, float)) - self.threshold) / self.scale
        )


ASSUMED_RATE = RapidlyAdapting(threshold=100.0, scale=500.0, highest=100.0)
"""Of the rate of strain energy density, Pa/s: constants assumed, for nobody states any."""
