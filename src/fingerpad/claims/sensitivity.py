"""How the numbers that the thesis shows hang on what it does not state: ``figures/tables/sensitivity``.

Three variants of the pad are pressed by three of the nine surfaces (scenes ``sensitivity_<variant>_<surface>``,
at the accuracy of the companions, so that variant and companion differ by the variant alone):

fat
    a flatter bone, with more fat under the apex.
instantaneous
    the thesis's moduli read as instantaneous instead of long-term ones.
radius
    the smaller radius at the apex that the thesis's node positions hint at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from os import PathLike

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.claims.numbers import INVERSE_WIDTHS, NUMBERS, Results, end_of, highest_pressure, top_of
from fingerpad.claims.verdicts import is_inside, significant
from fingerpad.measures.features import (
    SURFACES,
    Histories,
    Meshes,
    energy,
    peak_pressure,
    ramp_end,
    scene_name,
)
from fingerpad.reference_data import read_reference

VARIANTS = ("fat", "instantaneous", "radius")
SHAPES = ("flat", "210", "1260")
"""Surfaces the variants are pressed by."""

COLUMNS = (
    "quantity", "surface", "thesis_ids", "thesis_low", "thesis_high", "thesis_kind", "units", "base", "base_draft",
    *VARIANTS, "inside",
)  # fmt: skip

_WIDTHS = {label: INVERSE_WIDTHS[label] for label in SHAPES}
_PRESSURES = dict(zip(SHAPES, ("T125", "T129", "T133"), strict=True))

QUANTITIES: tuple[tuple[str, str, dict[str, str], Callable[[xr.Dataset], float]], ...] = (
    ("indentation depth at the end of the hold", "mm", {"flat": "T143", "1260": "T102a"},
     lambda d: end_of(d, "indentation_depth") * 1e3),
    ("contact width at the end of the ramp", "mm", _WIDTHS, lambda d: top_of(d, "contact_width") * 1e3),
    ("contact width at the end of the hold", "mm", _WIDTHS, lambda d: end_of(d, "contact_width") * 1e3),
    ("highest pressure", "Pa", _PRESSURES, highest_pressure),
    ("highest pressure at the end of the hold", "Pa", _PRESSURES, lambda d: float(peak_pressure(d)[-1])),
    *(
        (f"strain energy density at {z} um at the end of the ramp", "Pa", ids,
         lambda d, z=z: float(energy(d, z * 1e-6)[ramp_end(d)]))
        for z, ids in (
            (600, {"1260": "T193"}),
            (800, {"1260": "T196"}),
            (915, {"flat": "T181", "210": "T185", "1260": "T187c"}),
        )
    ),
)  # fmt: skip
"""Quantity, its unit, the ids of its thesis range by surface, and how it is read from a history."""


def variant_scene(variant: str, label: str) -> str:
    """Scene of a variant: ``("fat", "210") -> "sensitivity_fat_k210"``."""
    return scene_name(f"sensitivity_{variant}", label)


def thesis_range(id_: str, units: str, reference: pd.DataFrame) -> dict:
    """Row of the reference table in `units`; the inverse widths of Fig 4-9 become widths in mm."""
    entry = reference.loc[id_].to_dict()
    if entry["units"] == "1/mm" and units == "mm":
        entry |= {"low": 1 / entry["high"], "high": 1 / entry["low"]}
    return entry


def sensitivity(histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | PathLike) -> pd.DataFrame:
    """Each quantity under each surface: thesis range, this model (as published and as coarse), the variants.

    Parameters are those of `thesis_comparison`. The column `inside` names what lies within the thesis's range,
    judged as there, with the difference of base and base_draft as discretisation error; it is empty where the
    thesis gives no range. Scenes that were not simulated leave their cells empty.
    """
    reference = read_reference(reference_csv)
    rows = []
    for quantity, units, ids, read in QUANTITIES:
        for label in SHAPES:
            base = scene_name("ramp40", label)
            values = {"base": _read(read, histories, base), "base_draft": _read(read, coarse, base)}
            values |= {v: _read(read, histories, variant_scene(v, label)) for v in VARIANTS}
            row = {"quantity": quantity, "surface": label, "thesis_ids": ids.get(label, ""), "units": units}
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


def _read(read: Callable[[xr.Dataset], float], histories: Histories, scene: str) -> float:
    return read(histories[scene]) if scene in histories else float("nan")


def widths_fit(runs: Histories, reference: pd.DataFrame) -> bool:
    """Whether the contact widths at the end of the hold, by surface, are within the thesis's ranges."""
    widths = {k: end_of(runs[k], "contact_width") * 1e3 for k in _WIDTHS}
    return all(is_inside(widths[k], 0.0, thesis_range(id_, "mm", reference)) for k, id_ in _WIDTHS.items())


# --- evidence for the notes of the comparison ----------------------------------------------------------


class _Nearest(Mapping):
    """Histories of the three surfaces, standing in for those of the nearest of the nine."""

    def __init__(self, histories: Mapping[str, xr.Dataset]) -> None:
        self._histories = histories
        self.used: set[str] = set()

    def __getitem__(self, scene: str) -> xr.Dataset:
        label = scene.rsplit("_", 1)[1].removeprefix("k")
        if label not in SURFACES:
            raise KeyError(scene)
        place = SURFACES.index(label)
        nearest = min(SHAPES, key=lambda k: (abs(SURFACES.index(k) - place), k != "210"))
        self.used.add(nearest)
        return self._histories[nearest]

    def __iter__(self) -> Iterator[str]:
        return iter(self._histories)

    def __len__(self) -> int:
        return len(self._histories)


def evidence(id_: str, value: float, error: float, fine: Results, rough: Results, reference: pd.DataFrame) -> str:
    """What the variants make of a number of the comparison that is outside, and which of them bring it inside.

    A number of surfaces that the variants were not pressed by is given as the change in per cent that the
    variant makes on the nearest ones. A variant that brings the number inside but moves a contact width at
    the end of the hold outside is marked. Empty if the variants or the companions were not simulated.
    """
    number, entry = NUMBERS[id_], reference.loc[id_]
    try:
        base = _Nearest({k: rough(k) for k in SHAPES})
        before, whole = number(Results(base, rough.meshes)), number(rough)
        if not before and whole:
            return "variants: 0 under the nearest surface of theirs"
        shown, fits = [], []
        for variant in VARIANTS:
            runs = {k: fine.histories[variant_scene(variant, k)] for k in SHAPES}
            after = number(Results(_Nearest(runs), fine.meshes))
            exact = before == whole
            fits.append(is_inside(after if exact else value * after / before, error, entry))
            text = f"{significant(after, 3):g}" if exact else f"{after / before - 1:+.0%}"
            if fits[-1]:
                text += " (inside)" if widths_fit(runs, reference) else " (inside, widths outside)"
            shown.append(f"{variant} {text}")
    except KeyError:
        return ""
    surfaces = " and ".join(k if k == "flat" else f"K = {k}" for k in SHAPES if k in base.used)
    where = "" if exact else f" ({surfaces}, 40 gf/s)"
    return f"variants{where}: {', '.join(shown)}{'' if any(fits) else '; none inside'}"
