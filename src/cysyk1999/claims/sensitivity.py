"""How the numbers that the thesis shows hang on what it does not state:
``figures/tables/sensitivity``.

Three variants of the pad, and the pad itself as coarsely (``base``), are pressed by three of the
nine surfaces, scenes ``sensitivity_<variant>_<surface>``:

fat
    a flatter bone, with more fat under the apex.
long_term
    the thesis's moduli read as long-term instead of instantaneous ones.
radius
    the larger radius at the apex of a published section.
"""

from __future__ import annotations

from os import PathLike

import numpy as np
import pandas as pd

from cysyk1999.claims.rows import Number
from cysyk1999.claims.verdicts import is_inside, significant
from cysyk1999.measures.runs import FAST, NINE, PADS, RIDGED_NINE
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.reference_data import read_reference
from fingerpad.measures.features import SURFACES, scene_name

VARIANTS = ("fat", "long_term", "radius")
BASE = "base"
"""The pad itself, on the mesh of the variants."""
SHAPES = ("flat", "210", "1260")
"""Surfaces the variants are pressed by."""

COLUMNS = (
    "quantity",
    "surface",
    "thesis_ids",
    "thesis_low",
    "thesis_high",
    "thesis_kind",
    "units",
    "base",
    "base_draft",
    *VARIANTS,
    "inside",
)

_WIDTHS = {"flat": "T106", "210": "T114", "1260": "T120"}
_PRESSURES = {"flat": "T125", "210": "T129", "1260": "T133"}

QUANTITIES: tuple[tuple[str, str, str, str, dict[str, str]], ...] = (
    (
        "indentation depth at the end of the hold",
        "mm",
        "depth",
        "end",
        {"flat": "T143", "1260": "T102a"},
    ),
    ("contact width at the end of the ramp", "mm", "width", "top", _WIDTHS),
    ("contact width at the end of the hold", "mm", "width", "end", _WIDTHS),
    ("highest pressure", "Pa", "highest_pressure", "highest", _PRESSURES),
    ("highest pressure at the end of the hold", "Pa", "highest_pressure", "end", _PRESSURES),
    (
        "strain energy density at 600 um at the end of the ramp",
        "Pa",
        "energy_at_top",
        "600 um",
        {"1260": "T193"},
    ),
    (
        "strain energy density at 800 um at the end of the ramp",
        "Pa",
        "energy_at_top",
        "800 um",
        {"1260": "T196"},
    ),
    (
        "strain energy density at 915 um at the end of the ramp",
        "Pa",
        "energy_at_top",
        "915 um",
        {"flat": "T181", "210": "T185", "1260": "T187c"},
    ),
)
"""Quantity, its unit, measure and condition, and the ids of its thesis range by surface."""


def variant_scene(variant: str, label: str) -> str:
    """Scene of a variant: ``("fat", "210") -> "sensitivity_fat_k210"``."""
    return scene_name(f"sensitivity_{variant}", label)


def thesis_range(id_: str, units: str, reference: pd.DataFrame) -> dict:
    """Row of the reference table in `units`; the inverse widths of Fig 4-9 become widths in mm."""
    entry = reference.loc[id_].to_dict()
    if entry["units"] == "1/mm" and units == "mm":
        entry |= {"low": 1 / entry["high"], "high": 1 / entry["low"]}
    return entry


def sensitivity(fine: Measures, instead: Instead, reference_csv: str | PathLike) -> pd.DataFrame:
    """What the variants make of widths, depths, pressures and strain energies.

    Parameters
    ----------
    fine, instead : measures of the histories, and what tells their errors.
    reference_csv : the table of printed numbers.

    Returns
    -------
    One row a quantity and surface, columns `COLUMNS`: the thesis's range, the base, the base as a
    draft, the variants, and which of base and variants are inside the range, give or take the
    difference of base and draft. Cells of scenes that were not simulated are empty.
    """
    reference = read_reference(reference_csv)
    rows = []
    for quantity, units, measure, at, ids in QUANTITIES:
        for label in SHAPES:
            scenes = {v: variant_scene(v, label) for v in VARIANTS}
            scenes |= {"base": NINE[label], "base_draft": variant_scene(BASE, label)}
            values = {k: _read(fine, measure, scene, at) for k, scene in scenes.items()}
            row = {
                "quantity": quantity,
                "surface": label,
                "thesis_ids": ids.get(label, ""),
                "units": units,
            }
            if label in ids:
                entry = thesis_range(ids[label], units, reference)
                if "end of the hold" in quantity and entry["form"] == "axis":
                    entry["form"] = "range"  # need not fill an axis that an earlier peak sets
                error = np.nan_to_num(abs(values["base"] - values["base_draft"]))
                inside = [k for k in ("base", *VARIANTS) if is_inside(values[k], error, entry)]
                row |= {f"thesis_{k}": significant(entry[k], 4) for k in ("low", "high")}
                row |= {"thesis_kind": entry["kind"], "inside": ", ".join(inside) or "none"}
            rows.append(row | {k: significant(v, 4) for k, v in values.items()})
    return pd.DataFrame(rows, columns=COLUMNS)


def _read(measures: Measures, quantity: str, scene: str, at: str) -> float:
    try:
        return measures(quantity, scene, at)
    except KeyError:
        return float("nan")


def _widths_fit(fine: Measures, variant: str, reference: pd.DataFrame) -> bool:
    """Whether the contact widths at the end of the hold, by surface, are within the thesis's
    ranges.
    """
    widths = {k: fine("width", variant_scene(variant, k), "end") for k in SHAPES}
    return all(
        is_inside(widths[k], 0.0, thesis_range(id_, "mm", reference)) for k, id_ in _WIDTHS.items()
    )


# --- evidence for the notes of the comparison -----------------------------------------------------


def _nearest(label: str) -> str:
    """Of the surfaces that the variants are pressed by the nearest to one of the nine."""
    place = SURFACES.index(label)
    return min(SHAPES, key=lambda k: (abs(SURFACES.index(k) - place), k != "210"))


NEAREST = {
    scene: _nearest(label) for runs in (NINE, FAST, RIDGED_NINE) for label, scene in runs.items()
}
NEAREST[PADS["homogeneous"]] = "flat"
"""Scene of one of the nine surfaces -> the surface of the variants that stands in for it."""


def evidence(
    id_: str, number: Number, value: float, error: float, fine: Measures, reference: pd.DataFrame
) -> str:
    """What the variants make of a number of the comparison that is outside, and which of them bring
    it inside.

    A number of surfaces that the variants were not pressed by is given as the change in per cent
    that the variant makes on the nearest ones. A variant that brings the number inside but moves a
    contact width at the end of the hold outside is marked. Empty if the variants were not
    simulated.
    """
    entry = reference.loc[id_]

    def of_variant(variant: str) -> float:
        scenes = {scene: variant_scene(variant, k) for scene, k in NEAREST.items()}
        return number(fine.standing_in(scenes))

    try:
        before = of_variant(BASE)
        if not before and value:
            return "variants: 0 under the nearest surface of theirs"
        shown, fits = [], []
        exact = all(NINE[NEAREST[scene]] == scene for scene in number.scenes)
        for variant in VARIANTS:
            after = of_variant(variant)
            fits.append(is_inside(after if exact else value * after / before, error, entry))
            text = f"{significant(after, 3):g}" if exact else f"{after / before - 1:+.0%}"
            if fits[-1]:
                fit = _widths_fit(fine, variant, reference)
                text += " (inside)" if fit else " (inside, widths outside)"
            shown.append(f"{variant} {text}")
    except KeyError:
        return ""
    used = {NEAREST[scene] for scene in number.scenes}
    surfaces = " and ".join(k if k == "flat" else f"K = {k}" for k in SHAPES if k in used)
    where = "" if exact else f" ({surfaces}, 40 gf/s)"
    return f"variants{where}: {', '.join(shown)}{'' if any(fits) else '; none inside'}"
