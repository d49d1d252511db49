"""The most probable pad as ``config/specimens/thesis.yaml``, every size marked stated, inferred
(with its interval) or assumed.

Sizes are rounded to two digits, the contact length to three: far finer than what the figures tell
of them.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.unknowns import (
    BULK,
    EPIDERMIS,
    EPIDERMIS_BULK,
    SCALED,
    SOFT,
)

PREFERRED = 100
"""Odds by which a reading must be preferred to one that is nearer to the printed words."""


def most_probable(readings: pd.DataFrame) -> str:
    """The first of the readings, which are in the order of how near they are to the printed words,
    that no other is preferred to by more than `PREFERRED` to 1.
    """
    near = readings["log evidence (1)"] > readings["log evidence (1)"].max() - np.log(PREFERRED)
    return str(readings.loc[near, "reading"].iloc[0])


def specimen_text(posterior: pd.DataFrame, readings: pd.DataFrame) -> str:
    """The file's text, of the tables of the study: the best pad of the most probable reading.

    Moduli are written as long-term ones, those printed times the reading's factors.
    """
    reading = most_probable(readings)
    rows = posterior[posterior["reading"] == reading].set_index("quantity")
    here = readings[readings["reading"] == reading].iloc[0]
    says, share = here["says"], here["probability (1)"]

    def value(name: str, digits: int = 4) -> float:
        return float(f"{rows.loc[name, 'best pad']:.{digits}g}")

    def interval(name: str, scale: float = 1.0) -> str:
        low, high = scale * rows.loc[name, ["low 5 %", "high 95 %"]]
        told = high > 1.0001 * low
        return f"inferred: {low:.3g} to {high:.3g}" if told else "as the reading says"

    def layer(name: str, bulk: str, printed: float) -> str:
        nu = round(pads.poisson_for(value(bulk, 6)), 3)
        young = printed * value(name, 2) * (1 + nu) / (1 + pads.POISSON)
        told = interval(name, 1e-6 * printed * (1 + nu) / (1 + pads.POISSON))
        low, high = (pads.poisson_for(rows.loc[bulk, k]) for k in ("low 5 %", "high 95 %"))
        nus = f"; Poisson's ratio: {low:.3g} to {high:.3g}" if high > 1.0001 * low else ""
        return (
            f'{{youngs_modulus: "{1e-6 * young:.4g} MPa", poisson_ratio: {nu:.6g}}} # {told}{nus}'
        )

    stiff = layer(EPIDERMIS, EPIDERMIS_BULK, pads.YOUNG_EPIDERMIS)
    soft = layer(SOFT, BULK, pads.YOUNG_SOFT)
    skin, fat = 1e3 * pads.EPIDERMIS_THICKNESS, value("fat_thickness", 2)
    top, bottom = 1e3 * (pads.APEX - pads.BELOW) - skin - fat, -1e3 * pads.BONE_BOTTOM
    low, high = 1e3 * pads.FORCE / rows.loc[SCALED, ["high 95 %", "low 5 %"]]
    text = f"""\
# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json
# The pad that the thesis's figures are most likely of: {says}
# (probability {share:.2f} among those of figures/tables/reconstruction_readings.md). \
Stated: printed in the thesis.
# Inferred: from the figures of chapters 3 to 5 (`snakemake reconstruction`): \
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
layers: # printed in section 3.4: 0.15, 0.015 and 0.015 MPa, nu = 0.48, in a state that is not
  epidermis: {stiff}
  dermis: {soft}
  fat: {soft}
moduli: long_term # the factors on the printed moduli are inferred, so that the state says nothing
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
