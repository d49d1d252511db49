"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row starts from a row of the reference table (what the thesis prints, id by id) and a function below
that reads the same quantity from the simulated histories. Numbers are judged by the rules in `verdicts`; a
trend holds or fails. `layout` rows only set axes of figures and have no row here.

Every row has a role. Only a `result` and a `trend` speak for the model: an `input` is what the thesis states and the scenes
repeat, a `count` is of the model itself, and what is `calibrated` was used to choose a parameter.

A row that is outside says by how much, the likeliest reason, and what the sensitivity runs make of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike

import numpy as np
import pandas as pd

from fingerpad.claims.numbers import INVERSE_WIDTHS, NUMBERS, Results, end_of, top_of
from fingerpad.claims.sensitivity import evidence, variant_scene
from fingerpad.claims.trends import TRENDS
from fingerpad.claims.verdicts import is_inside, judge, significant
from fingerpad.measures.features import SURFACES, Histories, Meshes, peak_pressure, scene_of
from fingerpad.measures.steady import PLATE, steady_force
from fingerpad.reference_data import read_reference

GIVEN = ("input", "count")
"""Roles of what goes into the simulations: printed in full, without a discretisation error."""

COLUMNS = (
    "id", "figure", "quantity", "condition", "role", "thesis_low", "thesis_high", "thesis_kind", "simulated",
    "discretisation_error", "units", "verdict", "note",
)  # fmt: skip

_RAMP = "likeliest: the stiff transient of the ramp; state of the moduli and load per length are not stated"
_BENDING = "likeliest: the bending of the stiff epidermis over the section"


def _settled(label: str, programme: str = "ramp40") -> Callable[[Results], str]:
    """Reason of a ramp pressure above the axis, with the pressure that the hold settles to."""
    return lambda r: f"{float(peak_pressure(r(label, programme))[-1]):.0f} Pa at the end of the hold; {_RAMP}"


def _radius(results: Results) -> str:
    """Reason of the chosen apex radius, with the contact width that the smaller one gives."""
    reason = "chosen for the contact widths of Fig 4-9"
    scene = results.histories.get(variant_scene("radius", "flat"))
    if scene is None:
        return reason
    radius = scene_of(scene)["specimen"]["outline"]["apex_radius"] * 1e3
    inverse = 1e-3 / end_of(scene, "contact_width")
    return f"{reason}: {radius:.1f} mm gives {inverse:.3f} 1/mm under the flat plate (T106)"


_RECEPTOR = "likeliest: these recordings are of another receptor than the constants of Eq 5-1, which are printed for one only"
_LINE_LOAD = "likeliest: the load per contact length, which is not stated"
_LENGTH = "likeliest: contact length; a constant one of 10 mm is too long for a shallow press, see table calibration"
_BULK = "mostly the bulk modulus, which does not relax with the shear modulus as the estimate lets the whole force do"


_BURST = "likeliest: the energy hardly passes the threshold, which is that of one receptor; a recorded burst has no threshold"
_FIBRE = "the axis is that of another receptor's recording; the constants are those of Figs 5-20 and 5-21"
_PEAK = "the axis is that of a recording; the thesis too finds the dynamic peak off"


def _at_2_mm(results: Results) -> str:
    """Reason of the steady force above its axis, with the force at the depth of the last measured point."""
    return f"{steady_force(results.histories[PLATE], 2e-3):.3g} N at 2 mm; {_LENGTH}"


REASONS: dict[str, str | Callable[[Results], str]] = {
    "T037a": "quadratic elements carry four nodes each; linear ones would number as the nodes do",
    "T102a": "likeliest: state of the moduli and thickness of the fat, neither is stated",
    "T323": _radius,
    "T062": _at_2_mm,
    **{f"T{i}": _LENGTH for i in ("066", "070")},
    **{f"T{125 + i}": _settled(label) for i, label in enumerate(SURFACES)},
    **{f"T{i}": _settled("210") for i in (145, 148, 150, 154)},
    **{f"T165{tag}": _settled(label, "ramp150") for tag, label in zip("abc", ("flat", "158", "1260"), strict=True)},
    **{f"T{i}": _settled("flat") for i in (136, 138)},
    "T139": "5000 Pa is the last legible tick: Fig 4-11 shows the same curves up to 8000 Pa",
    **{f"T{i}": _RAMP for i in (123, 135, 140, 141, 142, 159, 170, 173, 174, 175, 176, 178, 179)},
    **{f"T177{tag}": _RAMP for tag in "ab"},
    **{f"T{i}": _BENDING for i in (166, 167, 168, *range(192, 198), 307)},
    "T232": "edges and peaks of the pressure lie where the surface has its arcs; what lags by a millimetre is the skin (T232a)",
    **{f"T{i:03d}": _RECEPTOR for i in (90, 94, 95, 96, 107, 109, 111, 113, 117, 119, 121, 160, 161, 203, 204, 207)},
    "T207a": _RECEPTOR,
    **{f"T{i}": _LINE_LOAD for i in (240, 241, 245, 247, 250)},
    **{f"T{i}": _BURST for i in (220, 221, "221a", 223, 224, 269, 270, 271, 272)},
    "T280": _PEAK,
    **{f"T{i}": _FIBRE for i in (304, "304a")},
}
"""Likeliest reason of a known difference, by id; used when the row is outside."""


def _remark(id_: str, entry: Mapping, results: Results) -> str:
    """What else to say of a number, inside or not: the inverse contact width that the hold starts with."""
    if entry["form"] == "estimate":
        return _BULK
    label = next((k for k, i in INVERSE_WIDTHS.items() if i == id_), None)
    if label is None:
        return ""
    start = 1e-3 / top_of(results(label), "contact_width")
    return f"{start:.3g} when the hold starts" + ("" if is_inside(start, 0.0, entry) else ", outside")


def _reason(id_: str, results: Results) -> str:
    reason = REASONS.get(id_, "")
    return reason(results) if callable(reason) else reason


# --- the table -----------------------------------------------------------------------------------------


def thesis_comparison(histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | PathLike) -> pd.DataFrame:
    """Compare the thesis's numbers and trends of chapters 3 to 5 with the simulated ones.

    Parameters
    ----------
    histories, coarse : scene name -> history, and its companion on a coarser mesh (may be empty).
    meshes : scene name -> mesh.
    reference_csv : the table of printed numbers (see `read_reference`).

    Returns
    -------
    One row an id, columns `COLUMNS`; numbers in the row's `units`. The discretisation error is the difference
    of the row's number between mesh and companion, in the same units, empty for what is `GIVEN`. Scenes that
    were not simulated give ``not_comparable``. `summary` of the rows is in ``attrs["summary"]``.
    """
    reference = read_reference(reference_csv)
    fine, rough = Results(histories, meshes), Results(coarse, meshes)
    rows = [_row(id_, entry, fine, rough, reference) for id_, entry in reference.iterrows() if entry["form"] != "layout"]
    table = pd.DataFrame(rows, columns=COLUMNS)
    table.attrs["summary"] = summary(table, reference)
    return table


def summary(table: pd.DataFrame, reference: pd.DataFrame) -> str:
    """How many rows agree with the thesis, results and trends first, and apart from them what was put in or chosen by."""

    def of(rows: pd.Series, *verdicts: str) -> str:
        judged = table[rows & (table["verdict"] != "not_comparable")]["verdict"]
        return f"{judged.isin(verdicts).sum()} of {len(judged)}"

    role, axis = table["role"], table["id"].map(reference["form"]).eq("axis")
    return (
        f"**{of(role.eq('result') & ~axis, 'inside')} results are inside a value or range of the thesis, "
        f"{of(role.eq('result') & axis, 'plausible')} are plausible on an axis of its figures "
        f"(below its end and filling half of it), {of(role.eq('trend'), 'trend_holds')} trends hold.** "
        f"Not counted: {of(role.isin(GIVEN), 'inside', 'plausible')} inputs and counts of the model are as in the thesis, "
        f"{of(role.eq('calibrated'), 'inside', 'plausible')} numbers that a parameter was chosen by are inside."
    )


def _row(id_: str, entry: Mapping, fine: Results, rough: Results, reference: pd.DataFrame) -> dict:
    row = {
        "id": id_,
        "figure": entry["figure"],
        "quantity": entry["quantity"],
        "condition": entry["condition"],
        "role": entry["role"],
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
            return row | {"simulated": significant(trend.shown, 4), "verdict": verdict, "note": trend.note}
        value = float(NUMBERS[id_](fine))
    except KeyError as missing:
        return row | {"verdict": "not_comparable", "note": f"not simulated: {missing.args[0]}"}
    try:
        error = float("nan") if entry["role"] in GIVEN else abs(value - float(NUMBERS[id_](rough)))
    except KeyError:
        error = float("nan")
    allowed = float(np.nan_to_num(error))
    verdict, note = judge(value, allowed, entry)
    if verdict == "outside":
        runs = "" if entry["role"] in GIVEN else evidence(id_, value, allowed, fine, rough, reference)
        note = "; ".join(filter(None, (note, _reason(id_, fine), runs)))
    doubt = "thesis reading uncertain" if entry["kind"] == "garbled" else ""
    note = "; ".join(filter(None, (note, _remark(id_, entry, fine), doubt)))
    if entry["role"] not in GIVEN:
        row |= {"discretisation_error": significant(error, 2)}
        value = significant(value, 4)
    return row | {"simulated": value, "verdict": verdict, "note": note}
