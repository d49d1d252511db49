"""Where the ridges of a pad lie: its epidermis bulges into the dermis, its skin outwards, in
register.

Every material point is named by (s, d): arc length s along the smooth outline from its apex and
depth d below it. Ridges move points in depth only, and the mean depth over a pitch is kept, so
ridges of no height are the smooth pad. They stand in full within `half_width` of the apex and fade
out over one pitch beyond.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fingerpad.specimen.outline import OutlineLike, curve_of

# of cos(pi u): a sharp tip has half a smooth one's radius of curvature
_POWER = {"smooth": 2, "sharp": 4}
_MEAN = {"smooth": 1 / 2, "sharp": 3 / 8}
# pitches by which the mesh still follows the ridges above their valleys and below their tips
_REACH = 0.25


def ridge_shape(u: np.ndarray, shape: str, limiting: float = 0.0) -> np.ndarray:
    """Height of a ridge over its valleys, 0 to 1, at positions ``u`` in pitches from a tip.

    With limiting ridges, ``limiting`` times as high, halfway between the primary ones, every ridge
    is half as wide.
    """
    if not limiting:
        return np.cos(np.pi * u) ** _POWER[shape]
    tips = 0.5 * (1.0 + limiting) + 0.5 * (1.0 - limiting) * np.cos(2.0 * np.pi * u)
    return tips * np.cos(2.0 * np.pi * u) ** _POWER[shape]


def mean_shape(shape: str, limiting: float = 0.0) -> float:
    """Mean of :func:`ridge_shape` over a pitch."""
    return _MEAN[shape] * (0.5 * (1.0 + limiting) if limiting else 1.0)


def wave_of(inner: Any) -> float:
    """Distance (m) from one inner ridge to the next, limiting ones counted."""
    return inner.pitch / 2 if inner.limiting else inner.pitch


class RidgedPad:
    """Depths of a ridged pad below its smooth outline.

    Parameters
    ----------
    outline : OutlineLike
        The scene's outline, lengths in m.
    ridges : fingerpad.scenes.specimen.Ridges
        `inner` has pitch, height, shape, phase and limiting; `outer` (or None) has period, height
        and shape.
    corneum : float
        Thickness in m of a stratum corneum that keeps it (it follows outer ridges and ignores inner
        ones); 0 for none.

    Attributes
    ----------
    extent : arc length (m) from the apex beyond which there are no ridges.
    tip : arc length (m) of the ridge tip nearest to the apex.
    wave : distance (m) from one inner ridge to the next, limiting ones counted.
    symmetric : whether the ridges are their own mirror image in x = 0.
    above, below : depths (m) between which the mesh follows inner ridges.
    """

    def __init__(self, outline: OutlineLike, ridges: Any, corneum: float = 0.0):
        self.curve, self.corneum = curve_of(outline), corneum
        self.inner, self.outer, self.half_width = ridges.inner, ridges.outer, ridges.half_width
        inner = self.inner
        self.pitch, self.wave = inner.pitch, wave_of(inner)
        self.extent = self.half_width + self.pitch
        if inner.phase in ("tip", "valley"):
            self.tip = 0.0 if inner.phase == "tip" else 0.5 * inner.pitch
        else:
            self.tip = float(self.curve.arc_length(self.curve.theta_at_x(inner.phase))[0])
        self.period = (self.outer and self.outer.period) or self.pitch
        lengths = [self.pitch, self.period] if self.outer else [self.pitch]
        halves = 2.0 * self.tip / np.array(lengths)
        self.symmetric = bool((np.abs(halves - np.round(halves)) < 1e-12).all())
        self.mean = mean_shape(inner.shape, inner.limiting)
        self.interface = self.curve.layer_depths[0]
        reach = _REACH * self.pitch
        room = 0.75 * (self.interface - corneum)
        self.above = self.interface - min(self.mean * inner.height + reach, room)
        lowest = self.interface + (1.0 - self.mean) * inner.height + reach
        self.below = min(lowest, self.curve.layer_depths[1])

    def _window(self, s: np.ndarray) -> np.ndarray:
        faded = np.clip((np.abs(s) - self.half_width) / self.pitch, 0.0, 1.0)
        return 0.5 * (1.0 + np.cos(np.pi * faded))

    def _place(self, s: np.ndarray) -> np.ndarray:
        s = np.asarray(s, dtype=float)
        return np.abs(s) if self.symmetric else s  # the same numbers, to the bit, on both sides

    def interface_shift(self, s: np.ndarray) -> np.ndarray:
        """How much deeper (m) than without ridges the epidermis ends, at arc lengths ``s`` (m) from
        the apex.
        """
        s, inner = self._place(s), self.inner
        shape = ridge_shape((s - self.tip) / self.pitch, inner.shape, inner.limiting)
        return inner.height * (shape - self.mean) * self._window(s)

    def skin_shift(self, s: np.ndarray) -> np.ndarray:
        """How much deeper (m) than without ridges the skin lies, at arc lengths ``s`` (m) from the
        apex.
        """
        s = self._place(s)
        if self.outer is None:
            return np.zeros_like(s)
        shape = ridge_shape((s - self.tip) / self.period, self.outer.shape)
        return -self.outer.height * (shape - mean_shape(self.outer.shape)) * self._window(s)

    def depth(self, s: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Depths (m) below the smooth outline of the points (s, d) of the ridged pad."""
        d = np.asarray(d, dtype=float)
        with_skin = np.clip((self.above - d) / (self.above - self.corneum), 0.0, 1.0)
        above, below = self.interface - self.above, self.below - self.interface
        with_interface = np.minimum((d - self.above) / above, (self.below - d) / below)
        with_interface = np.clip(with_interface, 0.0, 1.0)
        return d + self.skin_shift(s) * with_skin + self.interface_shift(s) * with_interface
