"""Structure of a sampled profile that is finer than a mesh can feel: found, and smoothed away by
the metrologist's filter.
"""

import numpy as np

#: Turning to and fro (rad) within half an edge, above which a profile is rougher than the mesh can
#: feel.
ROUGH = np.radians(3.0)
#: Cut-off wavelength over the edge: between nodes an edge apart no shorter wave can be told from a
#: longer one.
WAVE = 2.0
#: m, edge of the skin of the thesis's mesh: noise of fewer points than a finer mesh has nodes is
#: found by it all the same.
SKIN_EDGE = 134.4e-6
#: Standard deviation of the Gaussian over the cut-off wavelength, at which it leaves half of a wave
#: (ISO 16610-21, eq. 1 to 3).
SIGMA = np.sqrt(np.log(2) / 2) / np.pi
_PER_SIGMA = 8  # samples
_MOST = 2_000_000  # samples


def turning(x: np.ndarray, y: np.ndarray, window: float) -> np.ndarray:
    """(n - 2,) rad by which the lines through points turn to and fro within ``window`` m from each
    inner point on.

    Zero where they turn to one side only, as around an arc or an edge however sharp.
    """
    kink = np.diff(np.arctan2(np.diff(y), np.diff(x)))
    last = np.searchsorted(x[1:-1], x[1:-1] + window, side="left")
    net, gross = (np.concatenate([[0.0], np.cumsum(part)]) for part in (kink, np.abs(kink)))
    first = np.arange(len(kink))
    return gross[last] - gross[first] - np.abs(net[last] - net[first])


def is_rough(x: np.ndarray, y: np.ndarray, edge: float) -> bool:
    """Does a profile turn to and fro more than nodes ``edge`` m apart can feel?"""
    return bool(turning(x, y, edge / 2).max(initial=0.0) > ROUGH)


def cutoffs(x: np.ndarray, y: np.ndarray, edge: float) -> list[float]:
    """Cut-off wavelengths (m) that come into question on a skin with nodes ``edge`` m apart: none
    (0), and octaves.

    None where it is not rough. From two edges on where the mesh cannot feel what is finer, up to
    two edges of the thesis's skin: finer meshes feel finer shapes, but also noise, and which of the
    two it is only the planner can judge.
    """
    if not is_rough(x, y, max(edge, SKIN_EDGE)):
        return [0.0]
    octaves = max(int(np.ceil(np.log2(SKIN_EDGE / edge) - 1e-6)), 0)
    longer = [WAVE * edge * 2**k for k in range(octaves)] + [WAVE * max(edge, SKIN_EDGE)]
    return longer if is_rough(x, y, edge) else [0.0, *longer]


def smoothed(x: np.ndarray, y: np.ndarray, cutoff: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (m,), (m,) m of the profile after a Gaussian filter of ``cutoff`` m, evenly spaced
    between its ends.

    The filter of ISO 16610-21, which leaves half the height of waves as long as ``cutoff``, in its
    regression form (after ISO 16610-31): a line is fitted under the Gaussian's weight at each
    place, so that slopes are kept up to the ends.
    """
    sigma = SIGMA * cutoff
    count = int(np.clip(np.ceil(np.ptp(x) / sigma * _PER_SIGMA), 32, _MOST)) + 1
    even = np.linspace(x[0], x[-1], count)
    at = (even - (x[0] + x[-1]) / 2) / sigma
    spacing = at[1] - at[0]
    heights = _averages(x, y, even)

    def weighed(values):
        from scipy.ndimage import gaussian_filter1d  # most scenes need none

        return gaussian_filter1d(values, 1 / spacing, mode="constant", truncate=5.0)

    zeroth, first, second = weighed(np.ones(count)), weighed(at), weighed(at**2)
    # moments about each place itself
    lever, spread = first - at * zeroth, second - 2 * at * first + at**2 * zeroth
    height, moment = weighed(heights), weighed(at * heights)
    moment -= at * height
    return even, (spread * height - lever * moment) / (spread * zeroth - lever**2)


SHARP = 4
"""Times that what is long is taken away, so that waves three times as long leave less than a
hundredth.
"""


def finer_than(x: np.ndarray, y: np.ndarray, cutoff: float) -> np.ndarray:
    """Heights (n,) m at evenly spaced x (n,) m of the waves of a profile that are shorter than
    ``cutoff`` m.
    """
    for _ in range(SHARP):
        y = y - np.interp(x, *smoothed(x, y, cutoff))
    return y


def _averages(x, y, even):
    """Mean heights of the line through points within half a spacing of each place, so that no point
    is passed over.
    """
    half = (even[1] - even[0]) / 2
    edges = np.append(even - half, even[-1] + half)
    area = np.concatenate([[0.0], np.cumsum(np.diff(x) * (y[1:] + y[:-1]) / 2)])
    piece = np.clip(np.searchsorted(x, edges, side="right") - 1, 0, len(x) - 2)
    along = edges - x[piece]
    slope = (y[piece + 1] - y[piece]) / (x[piece + 1] - x[piece])
    return np.diff(area[piece] + along * (y[piece] + slope * along / 2)) / np.diff(edges)
