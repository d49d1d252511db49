"""How a simulated number is judged against a row of the reference table.

The rule follows from the row's `form`:

value
    inside if within the row's relative tolerance (0: equal to six digits) or the error.
range
    inside if between low and high, give or take the error. The row's relative tolerance, where
    there is one, lets a number be lower by what the thesis's own reading adds: it counts nodes
    0.0672 mm apart, and a width is up to two spacings more.
value without low
    the thesis does not state it: not judged.
estimate
    not a number of the thesis, nor a truth: never judged, the remark says by how much the number
    differs.
unlike
    a recording, another receptor's or an illegible axis, which says nothing of the model: never
    judged.
axis
    the thesis shows only an axis. Plausible, and no more, if the largest plotted value stays below
    its end and above the last tick but one (`tick`), where an axis that the curves alone set would
    have ended; where that is not known it has to fill at least `FILL` of it.

The error, of mesh, time steps and sampling together, helps by no more than `HELP` of the bound: a
number that is inside only by a large error is outside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

FILL = 0.5
"""Least share of a thesis axis that its largest curve should fill, where no tick is known."""
HELP = 0.02
"""Largest share of a bound by which the error may bring a number inside: the accuracy that is asked
for.
"""


def judge(value: float, error: float, entry: Mapping) -> tuple[str, str]:
    """Verdict on a number and how far outside it is.

    Parameters
    ----------
    value, error : the number and its error, both in the row's units.
    entry : low, high, form and tolerance of the reference row, and its tick if it has one.

    Returns
    -------
    ``inside``, ``plausible``, ``outside`` or ``not_comparable`` (a number that is not finite), and
    a remark.
    """
    low, high, form = float(entry["low"]), float(entry["high"]), entry["form"]
    if not np.isfinite(value):
        return "not_comparable", "the simulation does not show it"
    if form == "estimate":
        return "not_comparable", f"an estimate to compare with, not a truth; {value / low - 1:+.0%}"
    if form == "unlike":
        return "not_comparable", ""
    if form == "value" and np.isnan(low):
        return "not_comparable", "not stated in the thesis"

    def helped(bound: float) -> float:
        return min(error, HELP * abs(bound))

    if form == "axis":
        tick = float(entry.get("tick", np.nan))
        if value > high + helped(high):
            return "outside", f"{value / high - 1:.0%} above the axis's end"
        if value < tick - helped(tick):
            return (
                "outside",
                f"{1 - value / tick:.0%} below the last tick but one, {tick:g}: the axis would "
                "have ended there",
            )
        if np.isnan(tick) and value < FILL * high - helped(FILL * high):
            return "outside", f"fills only {value / high:.0%} of the axis"
        return "plausible", f"fills {value / high:.0%} of the axis"
    tolerance = np.nan_to_num(float(entry.get("tolerance", np.nan))) * abs(low)
    below, above = max(tolerance, helped(low)), helped(high)
    if form == "value":
        high, below = low, max(below, 1e-6 * abs(low))
        above = below
    if -below <= value - low and value - high <= above:
        return "inside", ""
    near = low if value < low else high
    return "outside", f"by {value - near:+.3g} ({value / near - 1:+.0%})"


def hardest(
    values: Sequence[float], errors: Sequence[float], entry: Mapping
) -> tuple[int, str, str]:
    """Which of a row's possible numbers is judged, its verdict and its remark: one that is outside
    by a possible end of its range or axis; else one that is not comparable, else the first.

    Parameters
    ----------
    values, errors : the numbers that may be meant, each with its error, in the row's units.
    entry : as of `judge`; the other end that its range or axis may have is its ``or_high``.
    """
    other = float(entry.get("or_high", np.nan))
    entries = [entry] + [{**entry, "high": other}] * (other == other)
    found = [
        (k, *judge(value, error, each))
        for k, (value, error) in enumerate(zip(values, errors, strict=True))
        for each in entries
    ]
    order = ("outside", "not_comparable")
    return min(found, key=lambda one: order.index(one[1]) if one[1] in order else len(order))


def is_inside(value: float, error: float, entry: Mapping) -> bool:
    """Whether a number is inside its reference row, or plausible on its axis."""
    return hardest([value], [error], entry)[1] in ("inside", "plausible")


def significant(value: float, digits: int) -> float:
    """A number rounded to significant digits."""
    return float(f"{value:.{digits}g}")


def digits(value: float, count: int = 3) -> str:
    """A number to so many significant digits in text; a large one to its last whole digit, not as a
    power of ten.
    """
    text = f"{value:.{count}g}"
    return f"{value:.0f}" if "e+" in text else text


def joined(*parts: str) -> str:
    """The parts of a note that say something."""
    return "; ".join(filter(None, parts))
