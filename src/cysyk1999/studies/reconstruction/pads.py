"""A pad of the study: its scenes, and what is read of them.

A pad is simulated with the stated long-term moduli of dermis and fat. Where these are other by a
factor, and with them the bulk modulus and the epidermis's, the same deformation goes with a load,
pressures and energies that are other by the same factor: all laws here are linear in the moduli. So
that factor is no axis of the design (:meth:`Evidence.shown`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.studies.reconstruction.unknowns import EPIDERMIS, LOAD, SCALED, SOFT, STIFFNESS
from fingerpad.measures import features
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.simulation import simulate
from fingerpad.specimen.outline import OutlineCurve

CURVATURES = (None, 78.74, 104.99, 157.48, 209.97, 314.96, 419.95, 629.92, 1259.84)
SURFACES = dict(zip("flat 79 105 158 210 315 420 630 1260".split(), CURVATURES, strict=True))
"""Curvatures (1/m) of the nine surfaces."""
PLATE, FAST = "plate", " at 150 gf/s"
"""The flat plate at 2 mm/s to 2 mm; what a surface is called at the faster ramp."""
DEPTHS = (560, 600, 640, 765, 800, 845, 870, 915, 960)
"""um; of the thesis's receptors."""
FORCE = 20 * 9.80665e-3
"""N; 20 gram-weight."""
YOUNG_EPIDERMIS, YOUNG_SOFT, POISSON = 0.15e6, 0.015e6, 0.48
"""Pa, Pa, 1; printed in section 3.4."""
BONE_BOTTOM, APEX, BELOW, EPIDERMIS_THICKNESS = 4.0e-3, 6.0e-3, 0.85e-3, 0.85e-3
"""m; bottom of the bone below the origin, height of the apex, thickness of the dermis and the
epidermis's: as in `START`.
"""
START = "long_term"
"""The specimen that pads are variations of, config/specimens/long_term.yaml."""
CHOSEN_LENGTH = 10e-3
"""m; its contact length."""
ACCURACY = {"tolerance": 0.05, "once": True}
SCALE_FREE = ("mm", "1")
"""Units of what does not change with a factor on all moduli and the load."""
MEASURES: dict[str, str] = {
    **dict.fromkeys(("depth_top", "depth_end", "width_top", "width_end"), "mm"),
    **dict.fromkeys(("peak", "centre_peak", "centre_end"), "Pa"),
    **dict.fromkeys(("first_over_dip", "top_over_dip", "late_change"), "1"),
    **{f"energy_{z}": "Pa" for z in DEPTHS},
    **{f"energy_end_{z}": "Pa" for z in DEPTHS},
    **{f"energy_915_{k.replace(' ', '_')}": "Pa" for k in ENERGIES},
    "energy_rate_915": "Pa/s",
}
"""What is read of a ramp and hold, with its unit. top: the ramp's end; end: the hold's; energies
are the highest unless "end".
"""
PLATE_DEPTHS = (0.5, 1.0, 1.5, 2.0)
FORCES: dict[str, str] = dict.fromkeys(
    (*(f"force_{round(10 * d):02d}" for d in PLATE_DEPTHS), "force_held"), "N/m"
)
"""What is read of the plate: line loads on the way at 0.5 to 2 mm, and after the hold."""


def base(surface: str) -> Scene:
    """The scene of a surface on the pad of `START`."""
    name, fast, _ = surface.partition(FAST)
    specimen = dict.fromkeys(("outline", "layers", "prony"), START)
    specimen["contact_length"] = f"{1e3 * CHOSEN_LENGTH:g} mm"
    document = {"specimen": specimen, "accuracy": ACCURACY, "stimulus": {"shape": "flat"}}
    if name == PLATE:
        document["motion"] = [{"press_to_depth": "2 mm", "speed": "2 mm/s"}, {"hold": "6 s"}]
    else:
        rate = "150 gf/s" if fast else "40 gf/s"
        document["motion"] = [{"press_to_force": "20 gf", "rate": rate}, {"hold": "2 s"}]
        document["outputs"] = {"receptors": {"depths": [f"{z} um" for z in DEPTHS]}}
        if curvature := SURFACES[name]:
            document["stimulus"] = {"shape": "cylinder", "curvature": f"{curvature} 1/m"}
    return load_scene(document, f"reconstruction_{surface}")


def poisson_for(bulk: float) -> float:
    """Poisson's ratio whose bulk modulus, at the same shear modulus, is that of nu = 0.48 times a
    factor.

    ``kappa/G = 2 (1 + nu) / 3 (1 - 2 nu)``.
    """
    ratio = bulk * 2 * (1 + POISSON) / (3 * (1 - 2 * POISSON))
    return (3 * ratio - 2) / (2 * (3 * ratio + 1))


def changes(pad: Mapping[str, float]) -> dict[str, object]:
    """What is special to a pad's scenes: values of the design's axes as keys of a scene (SI)."""
    nu = poisson_for(pad["bulk_modulus"])
    soft = YOUNG_SOFT * (1 + nu) / (1 + POISSON)  # the shear modulus stays
    stiff = pad[STIFFNESS] * soft * YOUNG_EPIDERMIS / YOUNG_SOFT
    bone_top = APEX - 1e-3 * (pad["epidermis_thickness"] + pad["fat_thickness"]) - BELOW
    outline = {
        name: 1e-3 * pad[name]
        for name in ("apex_radius", "epidermis_thickness", "bone_half_width", "nail_half_width")
    }
    outline["bone_half_height"] = (bone_top + BONE_BOTTOM) / 2
    outline["bone_centre_height"] = (bone_top - BONE_BOTTOM) / 2
    values: dict[str, object] = {f"specimen.outline.{k}": v for k, v in outline.items()}
    for layer, young in {"epidermis": stiff, "dermis": soft, "fat": soft}.items():
        values[f"specimen.layers.{layer}.youngs_modulus"] = young
        values[f"specimen.layers.{layer}.poisson_ratio"] = nu
    values["specimen.contact_length"] = FORCE / pad[LOAD]
    if pad["friction"] > 0:
        values["friction"] = float(pad["friction"])
    return values


def scene(pad: Mapping[str, float], surface: str) -> Scene:
    """A pad's scene. Raises SceneError for a pad that cannot be, one line."""
    return base(surface).varied(changes(pad))


def clearance(pad: Mapping[str, float]) -> float:
    """Least thickness of fat anywhere round the bone, mm; a pad that cannot be has none, or
    less.
    """
    outline = scene(pad, PLATE).specimen.outline
    layers = outline.epidermis_thickness + outline.dermis_thickness
    thin = {"epidermis_thickness": 1e-5, "dermis_thickness": 1e-5}
    bare = OutlineCurve(outline.model_copy(update=thin))
    skin = bare.point(np.linspace(0.0, np.pi, 121))
    gap = np.linalg.norm(skin - bare.bone_point(bare.bone_foot(skin)), axis=1)
    return 1e3 * float(gap.min() - layers)


def of_plate(history: xr.Dataset) -> dict[str, float]:
    """`FORCES` of a history."""
    ramp, force = slice(features.ramp_end(history) + 1), history["force"].values
    at = np.interp(PLATE_DEPTHS, 1e3 * features.depth(history)[ramp], force[ramp])
    return dict(zip(FORCES, [*at.tolist(), float(force[-1])], strict=True))


def of_press(history: xr.Dataset) -> dict[str, float]:
    """`MEASURES` of a history."""
    top, time = features.ramp_end(history), history["time"].values
    depth, width = 1e3 * features.depth(history), 1e3 * features.width(history)
    centre, ramp = features.centre_pressure(history), slice(top + 1)

    def at(share: np.ndarray | float) -> np.ndarray:
        return np.interp(share, time[ramp] / time[top], centre[ramp])

    dip = at(np.linspace(0.4, 0.8, 41)).min()
    out = {
        "depth_top": depth[top],
        "depth_end": depth[-1],
        "width_top": width[top],
        "width_end": width[-1],
        "peak": features.peak_pressure(history).max(),
        "centre_peak": centre.max(),
        "centre_end": centre[-1],
        "first_over_dip": at(np.linspace(0.05, 0.4, 36)).max() / dip,
        "top_over_dip": centre[top] / dip,
        "late_change": centre[top] / at(0.9) - 1,
    }
    for z in DEPTHS:
        energy = features.energy(history, z * 1e-6)
        out |= {f"energy_{z}": energy.max(), f"energy_end_{z}": energy[-1]}
    for name, variable in ENERGIES.items():
        energy = features.energy(history, 915e-6, name=variable)
        out[f"energy_915_{name.replace(' ', '_')}"] = energy.max()
    rate = features.energy_rate(history, 915e-6)["strain_energy_rate (Pa/s)"]
    return {k: float(v) for k, v in (out | {"energy_rate_915": rate.max()}).items()}


def read(pad: Mapping[str, float], surface: str) -> dict[str, float]:
    """Simulate a pad's surface: `FORCES` of the plate, `MEASURES` of any other."""
    history = simulate(scene(pad, surface))
    return of_plate(history) if surface == PLATE else of_press(history)


def units(surface: str) -> dict[str, str]:
    """What is read of a surface, with its unit."""
    return FORCES if surface == PLATE else MEASURES


CHOSEN = {
    LOAD: FORCE / CHOSEN_LENGTH,
    STIFFNESS: 1.0,
    "apex_radius": 11.0,
    "fat_thickness": 3.8,
    "bone_half_width": 5.0,
    "epidermis_thickness": 0.85,
    "bulk_modulus": 1.0,
    "nail_half_width": 5.0,
    "friction": 0.0,
}
"""The pad of `START`, chosen one size at a time, on the axes of the design."""
CHOSEN_BEFORE = CHOSEN | {SCALED: CHOSEN[LOAD], SOFT: 1.0, EPIDERMIS: 1.0, "plate_length": 10.0}
"""The same pad with all that an inferred one has."""
