"""What pads with inner ridges are wrong by, by the number of elements from one ridge to the next.

Strain energies beside ridges depend on the columns of elements among them and hardly on anything
else of the mesh, so these are what is varied, about ridges of several heights and pitches, and the
truth has more of them than any other. The errors are those of strain energy at the top of a ramp,
everywhere about the boundary of epidermis and dermis; next to the boundary itself, where strain
energy jumps and a receptor lies in one layer or the other by a hair, they are larger and not
counted.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.studies.ridges.run import boundary
from fingerpad.planning.effects.ridges import error_beside
from fingerpad.planning.plan import plan
from fingerpad.planning.rules import RULES
from fingerpad.scenes.scene import Discretisation, PressToForce, Receptors, Scene
from fingerpad.simulation import simulate
from fingerpad.specimen.pad import all_over
from fingerpad.specimen.ridges import wave_of

SIZES = ((0.15, 0.48), (0.02, 0.48), (0.05, 0.48), (0.3, 0.48), (0.15, 0.3), (0.15, 0.8))
"""Heights and pitches of ridges in mm, the specimen's own first."""
ELEMENTS = (8, 12, 18, 26)
"""From one ridge to the next."""
TRUTH = 48
"""And of the truth."""
SURFACES = ("flat", "210")
"""Of the study's scenes, that the pad is pressed by."""
STEPS = 10
OFF = 15e-6
"""How far (m) from the boundary of epidermis and dermis a place is that counts."""
PLACES = (-0.5, -0.35, -0.25, -0.1, 0.0, 0.1, 0.25, 0.35)
"""In pitches from a ridge's tip."""
DEPTH_STEP = 10e-6


def ridged(base: Scene, height: float, pitch: float) -> Scene:
    """A scene pressed to its force on a pad with ridges (mm), and the thesis's edges but for what
    is varied.
    """
    height, pitch, border = 1e-3 * height, 1e-3 * pitch, base.specimen.outline.epidermis_thickness
    most = RULES.ridge_near * height
    depths = (
        border
        + np.arange(-np.floor(most / DEPTH_STEP), np.floor(most / DEPTH_STEP) + 1) * DEPTH_STEP
    )
    press = next(leg for leg in base.motion if isinstance(leg, PressToForce))
    inner = {
        f"specimen.ridges.inner.{key}": value
        for key, value in {"height": height, "pitch": pitch, "phase": "tip"}.items()
    }
    receptors = Receptors(
        depths=tuple(np.round(depths, 9)), offsets=tuple(np.round(np.array(PLACES) * pitch, 9))
    )
    accuracy = Discretisation(skin_edge=RULES.presets["thesis"].skin_edge, steps=STEPS)
    made = base.varied({"specimen.ridges": "inner"}).varied(inner)
    return made.varied(
        {
            "motion": (press,),
            "outputs.receptors": receptors,
            "outputs.per_leg": None,
            "accuracy": accuracy,
        }
    )


def pressed(scene: Scene, elements: int) -> xr.Dataset:
    """The history of a scene with so many elements from one ridge to the next, under the receptors
    and a pitch beyond.
    """
    chosen, inner = plan(scene), scene.specimen.ridges.inner
    focus = all_over(1.5 * inner.pitch, 3 * wave_of(inner) / elements)
    return simulate(scene, replace(chosen, mesh_size=replace(chosen.mesh_size, focus=focus)))


def beside(scene: Scene) -> np.ndarray:
    """(receptors,) bool: which are far enough from the boundary to count."""
    receptors, specimen = scene.outputs.receptors, scene.specimen
    border = np.array([boundary(specimen.outline, specimen.ridges, x) for x in receptors.offsets])
    return (np.abs(np.array(receptors.depths)[:, None] - border) >= OFF).ravel()


def rows(surface: str, base: Scene) -> list[dict[str, object]]:
    """Errors (%) of strain energies by ridges and elements, under one surface."""
    out = []
    for height, pitch in SIZES:
        scene = ridged(base, height, pitch)
        inner, counted = scene.specimen.ridges.inner, beside(scene)
        truth = pressed(scene, TRUTH)["strain_energy_density"].values[-1][counted]
        for elements in ELEMENTS:
            found = pressed(scene, elements)
            off = 100 * np.abs(found["strain_energy_density"].values[-1][counted] / truth - 1)
            row = {
                "surface": surface,
                "height (mm)": height,
                "pitch (mm)": pitch,
                "elements from ridge to ridge": elements,
            }
            row |= {
                "nodes": json.loads(found.attrs["cost"])["nodes"],
                "expected error (%)": 100 * error_beside(inner, elements, RULES),
            }
            row |= {
                "error of 19 places in 20 (%)": np.percentile(off, 95),
                "largest error (%)": off.max(),
            }
            out.append(row)
    return out


def table(scenes: dict[str, Scene]) -> pd.DataFrame:
    """All surfaces."""
    return pd.DataFrame([row for surface, scene in scenes.items() for row in rows(surface, scene)])
