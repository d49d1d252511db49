"""The most probable pad as a specimen file, every size marked stated, inferred (with its interval) or assumed."""

from __future__ import annotations

import pandas as pd

from fingerpad.studies.reconstruction import pads
from fingerpad.studies.reconstruction.inference import EPIDERMIS, SOFT
from fingerpad.studies.reconstruction.unknowns import SCALED


def most_probable(readings: pd.DataFrame) -> str:
    """The reading of the moduli with the largest evidence, of those of the headline's energy.

    Of readings whose evidence differs by less than a factor of e, which is hardly any, the one that the table has first: what the
    thesis may have meant comes before factors that it does not mention.
    """
    rows = readings[readings["strain energy"] == readings["strain energy"].iloc[0]]
    near = rows[rows["log evidence (1)"] > rows["log evidence (1)"].max() - 1]
    return str(near["reading"].iloc[0])


def specimen_text(posterior: pd.DataFrame, readings: pd.DataFrame) -> str:
    """The file's text, of the tables of the study: the best pad of the most probable reading.

    Moduli are written as printed where the reading is a state of all of them, and else as long-term ones, times its factors.
    """
    reading = most_probable(readings)
    rows = posterior[posterior["reading"] == reading].set_index("quantity")
    says = readings.set_index("reading")["says"].get(reading)
    says = says if isinstance(says, str) else says.iloc[0]
    share = readings.groupby("reading")["probability (1)"].sum()[reading]

    def value(name: str, digits: int = 4) -> float:
        return float(f"{rows.loc[name, 'best pad']:.{digits}g}")

    def interval(name: str, scale: float = 1.0) -> str:
        low, high = scale * rows.loc[name, ["low 5 %", "high 95 %"]]
        return f"inferred: {low:.3g} to {high:.3g}" if high > 1.0001 * low else "as the reading says"

    nu = pads.poisson_for(value("bulk_modulus", 6))
    moduli = [1e-6 * e * value(k) * (1 + nu) / (1 + pads.POISSON) for e, k in ((pads.EPIDERMIS, EPIDERMIS), (pads.SOFT, SOFT))]
    state, told = "long_term", (interval(EPIDERMIS, 0.15), interval(SOFT, 0.015))
    if reading == state or reading == "instantaneous":  # as printed
        state, nu, moduli, told = reading, pads.POISSON, [1e-6 * pads.EPIDERMIS, 1e-6 * pads.SOFT], ("stated", "stated")
    skin, fat = value("epidermis_thickness"), value("fat_thickness")
    top = 1e3 * (pads.APEX - pads.BELOW) - skin - fat
    bottom = -1e3 * pads.BONE_BOTTOM
    length = 1e3 * pads.FORCE / value(SCALED)
    low, high = 1e3 * pads.FORCE / rows.loc[SCALED, ["high 95 %", "low 5 %"]]
    layers = {"epidermis": (moduli[0], told[0]), "dermis": (moduli[1], told[1]), "fat": (moduli[1], told[1])}
    lines = [
        "# yaml-language-server: $schema=../../workflow/schemas/specimen.schema.json",
        f"# The pad that the thesis's figures are most likely of: {says}",
        f"# (probability {share:.2f} among those of figures/tables/reconstruction_readings.md). Inferred from chapter 3 and",
        "# half of chapter 4 (`snakemake reconstruction`): intervals are 90 % ones, figures/tables/reconstruction_posterior.md.",
        "outline:",
        '  apex_height: "6 mm"                  # stated: axis of Fig 3-5',
        f'  apex_radius: "{value("apex_radius"):.4g} mm"  # {interval("apex_radius")}',
        '  half_width: "9.5 mm"                 # assumed: within the axes of Fig 3-5',
        '  depth_below: "6.2 mm"                # assumed: within the axes of Fig 3-5',
        f'  epidermis_thickness: "{skin:.4g} mm"  # {interval("epidermis_thickness")}; stated: 0.85',
        '  dermis_thickness: "0.85 mm"          # stated: section 3.3',
        '  stratum_corneum_thickness: "0.35 mm" # stated: section 3.3; no layer of its own',
        f'  bone_centre_height: "{(top + bottom) / 2:.5g} mm"  # leaves {fat:.3g} mm of fat; {interval("fat_thickness")}',
        f'  bone_half_width: "{value("bone_half_width"):.4g} mm"  # {interval("bone_half_width")}',
        f'  bone_half_height: "{(top - bottom) / 2:.5g} mm"  # assumed: its bottom stays',
        f'  nail_half_width: "{value("nail_half_width"):.4g} mm"  # {interval("nail_half_width")}: its figures hardly tell',
        "layers:                                # stated as 0.15, 0.015 and 0.015 MPa, in a state that is not",
        *(
            f'  {name}: {{youngs_modulus: "{e:.6g} MPa", poisson_ratio: {nu:.6g}}}  # {told}'
            for name, (e, told) in layers.items()
        ),
        f"moduli: {state:<30} # inferred: odds against long-term ones in figures/tables/reconstruction_readings.md",
        "prony:                                 # stated: Eq 3-1",
        '  - {g: 0.055, tau: "3.25 s"}',
        '  - {g: 0.3691, tau: "0.3414 s"}',
        f'contact_length: "{length:.4g} mm"  # inferred: {low:.3g} to {high:.3g}',
        'receptor_depths: ["600 um", "915 um"]  # stated: Figs 4-23 and 4-27',
    ]
    return "\n".join(lines) + "\n"
