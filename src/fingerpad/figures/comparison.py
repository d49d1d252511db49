"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row starts from a row of the reference table (what the thesis prints, id by id) and a function below
that reads the same quantity from the simulated histories. How they are judged follows from the row's `form`:

value
    inside if within the row's relative tolerance (0: equal to six digits) or the discretisation error.
range
    inside if between low and high, give or take the discretisation error.
axis
    the thesis shows only an axis. Inside if the largest plotted value stays below its end and fills at least
    `FILL` of it, since a plot is drawn to be filled.
trend
    trend_holds or trend_fails.

`layout` rows only set axes of figures and have no row here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike

import numpy as np
import pandas as pd

from fingerpad.figures.features import (
    SURFACES,
    Histories,
    peak_pressure,
    scene_of,
)
from fingerpad.figures.numbers import NUMBERS, Results, end_of
from fingerpad.figures.spec import Meshes, read_reference
from fingerpad.figures.trends import TRENDS

FILL = 0.5
"""Least share of a thesis axis that its largest curve should fill."""

COLUMNS = (
    "id", "figure", "quantity", "condition", "thesis_low", "thesis_high", "thesis_kind", "simulated",
    "discretisation_error", "units", "verdict", "note",
)  # fmt: skip

CHOSEN = ("T153",)
"""Rows of a mesh's own measures, which differ between mesh and companion by intent."""

_TRANSIENT = "likeliest: the ramp's transient; time scale of the moduli and load a length are not stated"


def _settled(label: str, programme: str = "ramp40") -> Callable[[Results], str]:
    """Reason of a ramp pressure above the axis, with the pressure that the hold settles to."""
    return lambda r: (
        f"{float(peak_pressure(r(label, programme))[-1]):.0f} Pa at the end of the hold; {_TRANSIENT}"
    )


REASONS: dict[str, str | Callable[[Results], str]] = {
    "T037a": "quadratic elements carry four nodes each; linear ones would number as the nodes do",
    "T102a": "likeliest: three-dimensional contact and a bone whose place is not stated; thicker fat: deeper",
    "T323": "chosen for the contact widths of Fig 4-9, which a radius of 7.9 mm would not give",
    **{f"T{125 + i}": _settled(label) for i, label in enumerate(SURFACES)},
    **{f"T{i}": _settled("210") for i in (145, 148, 150, 154)},
    **{
        f"T165{tag}": _settled(label, "ramp150")
        for tag, label in zip("abc", ("flat", "158", "1260"), strict=True)
    },
    "T136": _settled("flat"),
    "T138": _settled("flat"),
    "T139": "5000 Pa is the last legible tick, not the end: Fig 4-11 shows the same curves up to 8000 Pa",
    **{f"T{i}": _TRANSIENT for i in (135, 140, 141, 142, *range(173, 180))},
    **{f"T177{tag}": _TRANSIENT for tag in "ab"},
    **{
        f"T{i}": "likeliest: the stiff epidermis stores bending, which hangs on details of the section"
        for i in (166, 167, 168, *range(192, 198))
    },
    "T170": "likeliest: the faster ramp's transient, as for the pressures",
}
"""Likeliest reason of a known difference, by id; used when the row is outside."""


def _reason(id_: str, results: Results) -> str:
    reason = REASONS.get(id_, "")
    return reason(results) if callable(reason) else reason


def _sensitivity(id_: str, results: Results) -> str:
    """What a sensitivity run, if simulated, says about a difference."""
    scene = results.histories.get("sensitivity_fat_k1260")
    if id_ != "T102a" or scene is None:
        return ""
    outline = scene_of(scene)["specimen"]["outline"]
    fat = outline["apex_height"] - outline["bone_centre_height"] - outline["bone_half_height"]
    fat -= outline["epidermis_thickness"] + outline["dermis_thickness"]
    return f"with {fat * 1e3:.1f} mm of fat the depth is {end_of(scene, 'indentation_depth') * 1e3:.2f} mm"


# --- the table -----------------------------------------------------------------------------------------


def thesis_comparison(
    histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | PathLike
) -> pd.DataFrame:
    """Compare the thesis's numbers and trends of chapters 3 and 4 with the simulated ones.

    Parameters
    ----------
    histories, coarse : scene name -> history, and its companion on a mesh of twice the edge (may be empty).
    meshes : scene name -> mesh.
    reference_csv : the table of printed numbers (see `read_reference`).

    Returns
    -------
    One row an id, columns `COLUMNS`; numbers in the row's `units`. The discretisation error is the difference
    of the row's number between mesh and companion, in the same units. Scenes that were not simulated give
    ``not_comparable``.
    """
    reference = read_reference(reference_csv)
    fine, rough = Results(histories, meshes), Results(coarse, meshes)
    rows = [_row(id_, entry, fine, rough) for id_, entry in reference.iterrows() if entry["form"] != "layout"]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(id_: str, entry: Mapping, fine: Results, rough: Results) -> dict:
    row = {
        "id": id_,
        "figure": entry["figure"],
        "quantity": entry["quantity"],
        "condition": entry["condition"],
        "thesis_low": entry["low"],
        "thesis_high": entry["high"],
        "thesis_kind": entry["kind"],
        "simulated": float("nan"),
        "discretisation_error": float("nan"),
        "units": entry["units"],
    }
    try:
        if entry["form"] == "trend":
            trend = TRENDS[id_](fine)
            verdict = "trend_holds" if trend.holds else "trend_fails"
            return row | {"simulated": trend.shown, "verdict": verdict, "note": trend.note}
        value = float(NUMBERS[id_](fine))
    except KeyError as missing:
        return row | {"verdict": "not_comparable", "note": f"not simulated: {missing.args[0]}"}
    try:
        error = 0.0 if id_ in CHOSEN else abs(value - float(NUMBERS[id_](rough)))
    except KeyError:
        error = float("nan")
    verdict, note = judge(value, np.nan_to_num(error), entry)
    if verdict == "outside":
        note = "; ".join(filter(None, (note, _reason(id_, fine), _sensitivity(id_, fine))))
    if entry["kind"] == "garbled":
        note = "; ".join(filter(None, (note, "thesis reading uncertain")))
    return row | {"simulated": value, "discretisation_error": error, "verdict": verdict, "note": note}


def judge(value: float, error: float, entry: Mapping) -> tuple[str, str]:
    """Verdict and how far outside, of a number against a reference row (rules in the module's text)."""
    low, high = float(entry["low"]), float(entry["high"])
    if not np.isfinite(value):
        return "not_comparable", "the simulation does not show it"
    if entry["form"] == "value":
        allowed = max(float(entry["tolerance"]) * abs(low), error, 1e-6 * abs(low))
        if abs(value - low) <= allowed:
            return "inside", ""
        return "outside", f"by {value - low:+.3g} ({value / low - 1:+.0%})"
    if entry["form"] == "axis":
        if value > high + error:
            return "outside", f"{value / high - 1:.0%} above the axis's end"
        if value < FILL * high - error:
            return "outside", f"fills only {value / high:.0%} of the axis"
        return "inside", f"fills {value / high:.0%} of the axis"
    if low - error <= value <= high + error:
        return "inside", ""
    near = low if value < low else high
    return "outside", f"by {value - near:+.3g} ({value / near - 1:+.0%})"
