"""A tactile sensor that speaks like skin: contact pressure in, impulse rates out.

An array of pressure sensors on a robot's finger measures what the pad's surface feels. Eq 4-4 says
what receptors under a skin would make of it, Eq 5-1 what they would send::

    # places of the pressure sensors (m), a SpatialSum fitted at the receptor's depth
    sensor = TactileSensor(x, law)
    rate = sensor.step(time, pressure)      # once a frame: s, Pa -> impulses/s

The sum over the sensors is exact for pressures linear between them, so the constants fitted to the
pad's nodes hold for any spacing that resolves the pressure.
"""

from __future__ import annotations

import numpy as np

from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate, SpatialSum, kernel_weights


class TactileSensor:
    """Impulse rates of receptors under an array of pressure sensors.

    Parameters
    ----------
    x : (n,) m, places of the pressure sensors, increasing.
    law : Eq 4-4 at the receptors' depth.
    rate : Eq 5-1.
    receptors : (m,) m or a number, lateral places of the receptors.

    Raises
    ------
    ValueError
        Fewer than two sensors, or places that do not increase.
    """

    def __init__(self, x, law: SpatialSum, rate: ImpulseRate = THESIS_RATE, receptors=0.0):
        x = np.asarray(x, float)
        if x.ndim != 1 or len(x) < 2 or not (np.diff(x) > 0).all():
            raise ValueError("places of pressure sensors must be two at least, and increase")
        self.law, self.rate = law, rate
        self.weights = kernel_weights(x, np.asarray(receptors, float), law.r)
        self.reset()

    def reset(self) -> None:
        """Forget the frames so far: the next one is the first again."""
        self._time, self._energy = None, 0.0

    def step(self, time: float, pressure, indentation: float = 0.0):
        """Impulse rates (m,), or one, impulses/s, from the frame at a time.

        The rate of the strain energy is the difference to the frame before over the time between
        them; the first frame has none.

        Parameters
        ----------
        time : s, later than in the call before.
        pressure : (n,) Pa.
        indentation : m, for a law that asks for it.
        """
        energy = self.law.of_sum(self.weights @ pressure, indentation)
        change = 0.0 if self._time is None else (energy - self._energy) / (time - self._time)
        self._time, self._energy = time, energy
        return self.rate(energy, change)

    def rates(self, time, pressure, indentation=0.0) -> np.ndarray:
        """The same for a whole recording at once: (frames,) or (frames, m) impulses/s.

        Parameters
        ----------
        time : (frames,) s, increasing.
        pressure : (frames, n) Pa.
        indentation : (frames,) m.
        """
        pressure = np.asarray(pressure, float)
        energy = self.law.of_sum(self.weights @ pressure.T, np.asarray(indentation, float)).T
        change = np.zeros_like(energy)
        change[1:] = (np.diff(energy, axis=0).T / np.diff(np.asarray(time, float))).T
        return self.rate(energy, change)


def taxel_pressure(x, pressure, edges) -> np.ndarray:
    """Mean pressure (..., n - 1) Pa over the faces of sensors between edges (n,) m.

    Parameters
    ----------
    x : (..., k) m, increasing: places of the pressures, linear in between, none outside.
    pressure : (..., k) Pa.
    """
    x, pressure = np.asarray(x, float), np.asarray(pressure, float)
    spacing, inside = np.diff(x), np.clip(edges, x[..., :1], x[..., -1:])
    carried = np.insert(
        np.cumsum(spacing * (pressure[..., 1:] + pressure[..., :-1]) / 2, axis=-1), 0, 0.0, axis=-1
    )
    before = np.stack(
        [(x[..., 1:-1] <= edge[..., None]).sum(axis=-1) for edge in np.moveaxis(inside, -1, 0)],
        axis=-1,
    )
    left, there, slope, up_to = (
        np.take_along_axis(values, before, axis=-1)
        for values in (x, pressure, np.diff(pressure) / spacing, carried)
    )
    past = inside - left
    return np.diff(up_to + past * (there + slope * past / 2), axis=-1) / np.diff(edges)
