"""The most probable pad as ``config/specimens/thesis.yaml``, every size marked stated, inferred
(with its interval) or assumed.

Sizes are rounded to two digits, the contact length to three: far finer than what the figures tell
of them.
"""

from __future__ import annotations

import pandas as pd

from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.unknowns import EPIDERMIS, SCALED, SOFT


def most_probable(readings: pd.DataFrame) -> str:
    """The reading of the moduli with the largest evidence, of those of the headline's energy.

    Of readings whose evidence differs by less than a factor of e, which is hardly any, the one that
    the table has first: what the thesis may have meant comes before factors that it does not
    mention.
    """
    rows = readings[readings["strain energy"] == readings["strain energy"].iloc[0]]
    near = rows[rows["log evidence (1)"] > rows["log evidence (1)"].max() - 1]
    return str(near["reading"].iloc[0])


def specimen_text(posterior: pd.DataFrame, readings: pd.DataFrame) -> str:
    """The file's text, of the tables of the study: the best pad of the most probable reading.

    Moduli are written as printed where the reading is a state of all of them, and else as long-term
    ones, times its factors.
    """
    reading = most_probable(readings)
    rows = posterior[posterior["reading"] == reading].set_index("quantity")
    here = readings[readings["reading"] == reading]
    says, share = here["says"].iloc[0], here["probability (1)"].sum()

    def value(name: str, digits: int = 4) -> float:
        return float(f"{rows.loc[name, 'best pad']:.{digits}g}")

    def interval(name: str, scale: float = 1.0) -> str:
        low, high = scale * rows.loc[name, ["low 5 %", "high 95 %"]]
        told = high > 1.0001 * low
        return f"inferred: {low:.3g} to {high:.3g}" if told else "as the reading says"

    if reading in ("long_term", "instantaneous"):  # as printed
        state, nu, factors, told = reading, pads.POISSON, (1.0, 1.0), ("stated", "stated")
    else:
        state, nu = "long_term", pads.poisson_for(value("bulk_modulus", 6))
        factors = [value(name) * (1 + nu) / (1 + pads.POISSON) for name in (EPIDERMIS, SOFT)]
        told = interval(EPIDERMIS, 0.15), interval(SOFT, 0.015)
    printed = pads.YOUNG_EPIDERMIS, pads.YOUNG_SOFT
    stiff, soft = (
        f'{{youngs_modulus: "{1e-6 * e * k:.6g} MPa", poisson_ratio: {nu:.6g}}} # {why}'
        for e, k, why in zip(printed, factors, told, strict=True)
    )
    skin, fat = 1e3 * pads.EPIDERMIS_THICKNESS, value("fat_thickness", 2)
    top, bottom = 1e3 * (pads.APEX - pads.BELOW) - skin - fat, -1e3 * pads.BONE_BOTTOM
    low, high = 1e3 * pads.FORCE / rows.loc[SCALED, ["high 95 %", "low 5 %"]]
    text = f"""\
# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json
# The pad that the thesis's figures are most likely of: {says}
# (probability {share:.2f} among those of figures/tables/reconstruction_readings.md). \
Stated: printed in the thesis.
# Inferred: from chapter 3 and half of chapter 4 (`snakemake reconstruction`): \
with intervals of 90 %, in mm, of
# figures/tables/reconstruction_posterior.md. Assumed: of neither.
outline:
  apex_height: "6 mm" # stated: axis of Fig 3-5
  apex_radius: "{value("apex_radius", 2):.4g} mm" # {interval("apex_radius")}; \
the fan of printed node positions: 7.8 to 8.0
  half_width: "9.5 mm" # assumed: within the axes of Fig 3-5; \
a published section: 9.75 (Wang and Gerling 2014)
  depth_below: "6.2 mm" # assumed: within the axes of Fig 3-5
  epidermis_thickness: "{skin:.4g} mm" # stated: section 3.3, stratum corneum included; \
{interval("epidermis_thickness")}
  dermis_thickness: "{1e3 * pads.BELOW:.4g} mm" # stated: section 3.3
  stratum_corneum_thickness: "0.35 mm" # stated: section 3.3, drawn in Fig 3-4c; \
no layer of its own
  bone_centre_height: "{(top + bottom) / 2:.4g} mm" # leaves {fat:.3g} mm of fat; \
{interval("fat_thickness")}; published: 3.5 to 5.2
  bone_half_width: "{value("bone_half_width", 2):.4g} mm" # {interval("bone_half_width")}
  bone_half_height: "{(top - bottom) / 2:.4g} mm" # its bottom assumed 4 mm below \
the middle of the axes
  nail_half_width: "{value("nail_half_width", 2):.4g} mm" # {interval("nail_half_width")}: \
the figures hardly tell
layers: # stated: section 3.4, in a state that is not
  epidermis: {stiff}
  dermis: {soft}
  fat: {soft}
moduli: {state} # inferred: odds against long-term ones in \
figures/tables/reconstruction_readings.md
prony: # stated: Eq 3-1; shear, normalised by the instantaneous modulus
  - {{g: 0.055, tau: "3.25 s"}}
  - {{g: 0.3691, tau: "0.3414 s"}}
ridges: # for scenes that ask for them; the thesis draws inner ridges (Fig 5-25) without sizes,
 # facts behind these in config/reference/ridges.csv
  half_width: "3.4 mm" # assumed: the contact under 20 gf and the way that friction drags it
  inner:
    pitch: "0.48 mm" # one below each papillary ridge: Stuecker and others 2001, 485 (71) um
    height: "0.15 mm" # assumed: the middle of 0.1 to 0.2 mm
    shape: smooth # assumed
    phase: tip # assumed
    limiting: 0 # assumed: none
  outer: # period: the inner pitch
    height: "60 um" # Stuecker and others 2001, 59 (19) um
    shape: smooth # assumed
contact_length: "{1e3 * pads.FORCE / value(SCALED):.3g} mm" # inferred: {low:.3g} to {high:.3g}
receptor_depths: ["600 um", "915 um"] # stated: Figs 4-23 and 4-27
"""
    return "".join(map(_aligned, text.splitlines(keepends=True)))


def _aligned(line: str) -> str:
    """The line with what it says in a column of its own."""
    text, mark, why = line.partition(" # ")
    return f"{text:<38} # {why}" if mark else line
