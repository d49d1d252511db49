"""The likeliest reasons of known differences, by their word in the column `reason` of `thesis_numbers.csv`."""

from __future__ import annotations

from collections.abc import Callable

from fingerpad.claims.rows import Number
from fingerpad.measures.runs import NINE
from fingerpad.measures.steady import PLATE
from fingerpad.measures.table import Measures

_RAMP = "likeliest: the stiff transient of the ramp; state of the moduli and load per length are not stated"
_LENGTH = "likeliest: contact length; a constant one of 10 mm is too long for a shallow press, see table calibration"
_RADIUS = "chosen for the contact widths of Fig 4-9"
SMALL_RADIUS = "sensitivity_radius_flat"
"""The flat plate on a pad of the smaller radius that the thesis's node positions hint at."""


def _settled(m: Measures, number: Number) -> str:
    """With the pressure that the hold settles to."""
    return f"{m(number.measure, number.scenes[0], 'end'):.0f} Pa at the end of the hold; {_RAMP}"


def _at_2_mm(m: Measures, number: Number) -> str:
    """With the force at the depth of the last measured point."""
    return f"{m('steady', PLATE, '2 mm'):.3g} N at 2 mm; {_LENGTH}"


def _radius(m: Measures, number: Number) -> str:
    """With the contact width that the smaller radius gives."""
    try:
        radius, inverse = m("apex_radius", SMALL_RADIUS), m("inverse_width", SMALL_RADIUS, "end")
    except KeyError:
        return _RADIUS
    return f"{_RADIUS}: {radius:.1f} mm gives {inverse:.3f} 1/mm under the flat plate (T106)"


REASONS: dict[str, str | Callable[[Measures, Number], str]] = {
    "bending": "likeliest: the bending of the stiff epidermis over the section",
    "bulk": "mostly the bulk modulus, which does not relax with the shear modulus as the estimate lets the whole force do",
    "burst": "likeliest: the energy hardly passes the threshold, which is that of one receptor; "
    "a recorded burst has no threshold",
    "elements": "quadratic elements carry four nodes each; linear ones would number as the nodes do",
    "fibre": "the axis is that of another receptor's recording; the constants are those of Figs 5-20 and 5-21",
    "length": _LENGTH,
    "length_at_2_mm": _at_2_mm,
    "line_load": "likeliest: the load per contact length, which is not stated",
    "moduli": "likeliest: state of the moduli and thickness of the fat, neither is stated",
    "profiles": "edges and peaks of the pressure lie where the surface has its arcs; "
    "what lags by a millimetre is the skin (T232a)",
    "radius": _radius,
    "ramp": _RAMP,
    "receptor": "likeliest: these recordings are of another receptor than the constants of Eq 5-1, "
    "which are printed for one only",
    "recording": "the axis is that of a recording; the thesis too finds the dynamic peak off",
    "settled": _settled,
    "subjects": "one of the five subjects; the data of four are at hand (Dandekar, Raju and Srinivasan 2003)",
    "tick": "5000 Pa is the last legible tick: Fig 4-11 shows the same curves up to 8000 Pa",
}


def reason(word: str, measures: Measures, number: Number) -> str:
    """What a reason says of a number; empty without one."""
    found = REASONS.get(word, "")
    return found(measures, number) if callable(found) else found


def when_the_hold_starts(measures: Measures, number: Number) -> float | None:
    """The inverse contact width that the hold starts with, of the rows that give the one it ends with."""
    ends = number.measure == "inverse_width" and number.scenes[0] in NINE.scenes.values()
    return measures(number.measure, number.scenes[0], "top") if ends else None
