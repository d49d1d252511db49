"""Reasons of known differences, and of rows not being judged, by their word in the column `reason`
of `thesis_numbers.csv`.

A reason says what a run has shown or what the thesis's text says; what no run has tested is called
open.
"""

from __future__ import annotations

from collections.abc import Callable

from cysyk1999.claims.rows import Number
from cysyk1999.measures.table import Measures

_PAD = (
    "of pads that the thesis's figures do not tell apart some are inside and some are not, or "
    "none is (study reconstruction)"
)
_RADIUS = "inferred from chapters 3 and 4; the fan of printed node positions gives 7.8 to 8.0 mm"
LARGE_RADIUS = "sensitivity_radius_flat"
"""The flat plate on a pad with the apex radius of a published section."""


def _settled(m: Measures, number: Number) -> str:
    """With the pressure that the hold settles to."""
    return f"{m(number.measure, number.scenes[0], 'end'):.0f} Pa at the end of the hold; {_PAD}"


def _radius(m: Measures, number: Number) -> str:
    """With the contact width that a published section's radius gives."""
    try:
        radius, inverse = m("apex_radius", LARGE_RADIUS), m("inverse_width", LARGE_RADIUS, "end")
    except KeyError:
        return _RADIUS
    return (
        f"{_RADIUS}; {radius:.1f} mm, of a published section, gives {inverse:.3f} 1/mm under "
        "the flat plate (T106)"
    )


REASONS: dict[str, str | Callable[[Measures, Number], str]] = {
    "arranged": (
        "the thesis sets the same depth and width up; here the depth alone is made the same"
    ),
    "bending": "open: every pad tried bends its epidermis more than that (study reconstruction)",
    "bulk": (
        "mostly the bulk modulus, which does not relax with the shear modulus as the estimate "
        "lets the whole force do"
    ),
    "by_construction": (
        "holds by construction: of the half that is solved, of rigid contact, or of Eq 5-1"
    ),
    "definition": "not of the energy that is shown; says what another definition would do",
    "elements": (
        "'10,000 nodes and elements' is one number for two: quadratic elements carry three or "
        "four nodes each"
    ),
    "fibre": (
        "the axis is that of another receptor's recording; the constants are those of Figs 5-20 "
        "and 5-21"
    ),
    "future": "asked for in chapter 6 as future work; no result of the thesis",
    "illegible": (
        "the scanned labels leave open where the axis ends, or of which surface the number is"
    ),
    "pad": _PAD,
    "pad_settled": _settled,
    "panels": (
        "panels taken as exchanged: as captioned, the layered pad would pass the axis that Fig "
        "4-11 ends at"
    ),
    "profiles": "edges and peaks of the pressure lie where the surface has its arcs; "
    "what lags by a millimetre is the skin (T232a)",
    "radius": _radius,
    "recorded": (
        "recordings are shown there, alone or with a line that was fitted to them, and set the axis"
    ),
    "ridge_sizes": (
        "hangs on the sizes of ridges, which are not stated; the thesis calls their resolution "
        "insufficient"
    ),
    "subjects": (
        "one of the five subjects; the data of four are at hand (Dandekar, Raju and Srinivasan "
        "2003)"
    ),
}


def reason(word: str, measures: Measures, number: Number) -> str:
    """What a reason says of a number; empty without one."""
    found = REASONS.get(word, "")
    return found(measures, number) if callable(found) else found
