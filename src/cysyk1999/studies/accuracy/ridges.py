"""Errors on pads with inner ridges, by the number of elements from one ridge to the next.

Strain energies beside ridges depend on the columns of elements among them and hardly on anything
else of the mesh. So these are varied, for ridges of several heights and pitches, and the truth has
more of them than any other. The errors are those of strain energy at the top of a ramp, everywhere
about the boundary of epidermis and dermis. Next to the boundary itself strain energy jumps, and
a receptor can lie in one layer or the other: there errors are larger and not counted.
"""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import xarray as xr

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.accuracy.compare import by_surface, resized
from cysyk1999.studies.common.ridges import boundary
from fingerpad.healing import simulate
from fingerpad.planning.effects.ridges import error_beside
from fingerpad.planning.plan import plan
from fingerpad.planning.rules import RULES
from fingerpad.scenes.scene import PressToForce, Scene
from fingerpad.specimen.pad import all_over
from fingerpad.specimen.ridges import wave_of

SIZES = ((0.15, 0.48), (0.02, 0.48), (0.05, 0.48), (0.3, 0.48), (0.15, 0.3), (0.15, 0.8))
"""Heights and pitches of ridges in mm, the specimen's own first."""
ELEMENTS = (8, 12, 18, 26)
"""Numbers of elements from one ridge to the next."""
TRUTH = 48
"""Elements of the truth."""
SURFACES = ("flat", "210")
"""Of the study's scenes, that the pad is pressed by."""
STEPS = 10
OFF = 15e-6
"""How far (m) from the boundary of epidermis and dermis a place is that counts."""
PLACES = (-0.5, -0.35, -0.25, -0.1, 0.0, 0.1, 0.25, 0.35)
"""Places of receptors, in pitches from a ridge's tip."""
DEPTH_STEP = 10e-6


def ridged(base: Scene, height: float, pitch: float) -> Scene:
    """A scene pressed to its force on a pad with ridges (mm), and the thesis's edges but for what
    is varied.
    """
    height, pitch, border = 1e-3 * height, 1e-3 * pitch, base.specimen.outline.epidermis_thickness
    reach = np.floor(RULES.ridge_near * height / DEPTH_STEP)
    depths = border + np.arange(-reach, reach + 1) * DEPTH_STEP
    press = next(leg for leg in base.motion if isinstance(leg, PressToForce))
    inner = "specimen.ridges.inner"
    return base.varied({"specimen.ridges": "inner"}).varied(
        {
            f"{inner}.height": height,
            f"{inner}.pitch": pitch,
            f"{inner}.phase": "tip",
            "motion": (press,),
            "outputs.receptors.depths": tuple(np.round(depths, 9)),
            "outputs.receptors.offsets": tuple(np.round(np.array(PLACES) * pitch, 9)),
            "outputs.per_leg": None,
            "accuracy": {"skin_edge": RULES.presets["thesis"].skin_edge, "steps": STEPS},
        }
    )


def pressed(scene: Scene, elements: int) -> xr.Dataset:
    """The history of a scene with so many elements from one ridge to the next, under the receptors
    and a pitch beyond.
    """
    inner = scene.specimen.ridges.inner
    focus = all_over(1.5 * inner.pitch, 3 * wave_of(inner) / elements)
    return simulate(scene, resized(plan(scene), focus=focus))


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
        runs = {elements: pressed(scene, elements) for elements in (*ELEMENTS, TRUTH)}
        truth = runs.pop(TRUTH)["strain_energy_density"].values[-1][counted]
        for elements, found in runs.items():
            off = 100 * np.abs(found["strain_energy_density"].values[-1][counted] / truth - 1)
            row = {"surface": surface, "height (mm)": height, "pitch (mm)": pitch}
            row |= {"elements from ridge to ridge": elements}
            row |= {"nodes": json.loads(found.attrs["cost"])["nodes"]}
            row |= {"expected error (%)": 100 * error_beside(inner, elements, RULES)}
            row |= {"error of 19 places in 20 (%)": np.percentile(off, 95)}
            out.append(row | {"largest error (%)": off.max()})
    return out


def accuracy_ridges(job: SimpleNamespace) -> None:
    """Job: `scenes` in the order of SURFACES -> `table`."""
    publish_table(by_surface(rows, SURFACES, job.scenes), job.table[0])
