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
from cysyk1999.studies.reconstruction.unknowns import LOAD, STIFFNESS
from fingerpad.measures import features
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.simulation import simulate
from fingerpad.specimen.outline import OutlineCurve

SURFACES = {
    "flat": None,
    "79": 78.74,
    "105": 104.99,
    "158": 157.48,
    "210": 209.97,
    "315": 314.96,
    "420": 419.95,
    "630": 629.92,
    "1260": 1259.84,
}
"""Curvatures (1/m) of the nine surfaces."""
PLATE, FAST = "plate", " at 150 gf/s"
"""The flat plate at 2 mm/s to 2 mm; what a surface is called at the faster ramp."""
DEPTHS = (560, 600, 640, 765, 800, 845, 870, 915, 960)
"""um; of the thesis's receptors."""
FORCE = 20 * 9.80665e-3
"""N; 20 gram-weight."""
EPIDERMIS, SOFT, POISSON = 0.15e6, 0.015e6, 0.48
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
    "depth_top": "mm",
    "depth_end": "mm",
    "width_top": "mm",
    "width_end": "mm",
    "peak": "Pa",
    "centre_peak": "Pa",
    "centre_end": "Pa",
    "first_over_dip": "1",
    "top_over_dip": "1",
    "late_change": "1",
    **{f"energy_{z}": "Pa" for z in DEPTHS},
    **{f"energy_end_{z}": "Pa" for z in DEPTHS},
    **{f"energy_915_{k.replace(' ', '_')}": "Pa" for k in ENERGIES},
    "energy_rate_915": "Pa/s",
}
"""What is read of a ramp and hold, with its unit. top: the ramp's end; end: the hold's; energies
are the highest unless "end".
"""
FORCES: dict[str, str] = {
    "force_05": "N/m",
    "force_10": "N/m",
    "force_15": "N/m",
    "force_20": "N/m",
    "force_held": "N/m",
}
"""What is read of the plate: line loads on the way at 0.5 to 2 mm, and after the hold."""


def base(surface: str) -> Scene:
    """The scene of a surface on the pad of `START`."""
    name, fast, _ = surface.partition(FAST)
    if name == PLATE:
        motion = [{"press_to_depth": "2 mm", "speed": "2 mm/s"}, {"hold": "6 s"}]
        document = {"stimulus": {"shape": "flat"}, "motion": motion}
    else:
        curvature = SURFACES[name]
        stimulus = (
            {"shape": "flat"}
            if curvature is None
            else {"shape": "cylinder", "curvature": f"{curvature} 1/m"}
        )
        motion = [
            {"press_to_force": "20 gf", "rate": "150 gf/s" if fast else "40 gf/s"},
            {"hold": "2 s"},
        ]
        receptors = {"receptors": {"depths": [f"{z} um" for z in DEPTHS]}}
        document = {"stimulus": stimulus, "motion": motion, "outputs": receptors}
    specimen = {
        "outline": START,
        "layers": START,
        "prony": START,
        "contact_length": f"{1e3 * CHOSEN_LENGTH:g} mm",
    }
    return load_scene(
        document | {"specimen": specimen, "accuracy": ACCURACY}, f"reconstruction_{surface}"
    )


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
    soft = SOFT * (1 + nu) / (1 + POISSON)  # the shear modulus stays
    bone_top = APEX - 1e-3 * (pad["epidermis_thickness"] + pad["fat_thickness"]) - BELOW
    found: dict[str, object] = {
        "specimen.outline.apex_radius": 1e-3 * pad["apex_radius"],
        "specimen.outline.epidermis_thickness": 1e-3 * pad["epidermis_thickness"],
        "specimen.outline.bone_half_height": (bone_top + BONE_BOTTOM) / 2,
        "specimen.outline.bone_centre_height": (bone_top - BONE_BOTTOM) / 2,
        "specimen.outline.bone_half_width": 1e-3 * pad["bone_half_width"],
        "specimen.outline.nail_half_width": 1e-3 * pad["nail_half_width"],
        "specimen.contact_length": FORCE / pad[LOAD],
        **{
            f"specimen.layers.{layer}.poisson_ratio": nu for layer in ("epidermis", "dermis", "fat")
        },
        "specimen.layers.epidermis.youngs_modulus": pad[STIFFNESS] * soft * EPIDERMIS / SOFT,
        "specimen.layers.dermis.youngs_modulus": soft,
        "specimen.layers.fat.youngs_modulus": soft,
    }
    if pad["friction"] > 0:
        found["friction"] = float(pad["friction"])
    return found


def scene(pad: Mapping[str, float], surface: str) -> Scene:
    """A pad's scene. Raises SceneError for a pad that cannot be, one line."""
    return base(surface).varied(changes(pad))


def clearance(pad: Mapping[str, float]) -> float:
    """Least thickness of fat anywhere round the bone, mm; a pad that cannot be has none, or
    less.
    """
    outline = scene(pad, PLATE).specimen.outline
    layers = outline.epidermis_thickness + outline.dermis_thickness
    bare = OutlineCurve(
        outline.model_copy(update={"epidermis_thickness": 1e-5, "dermis_thickness": 1e-5})
    )
    skin = bare.point(np.linspace(0.0, np.pi, 121))
    return 1e3 * float(np.hypot(*(skin - bare.bone_point(bare.bone_foot(skin))).T).min() - layers)


def of_plate(history: xr.Dataset) -> dict[str, float]:
    """`FORCES` of a history."""
    depth, force = 1e3 * features.depth(history), history["force"].values
    top = features.ramp_end(history)
    found = {
        f"force_{round(10 * d):02d}": float(np.interp(d, depth[: top + 1], force[: top + 1]))
        for d in (0.5, 1.0, 1.5, 2.0)
    }
    return found | {"force_held": float(force[-1])}


def of_press(history: xr.Dataset) -> dict[str, float]:
    """`MEASURES` of a history."""
    top, time = features.ramp_end(history), history["time"].values
    depth, width = 1e3 * features.depth(history), 1e3 * features.width(history)
    centre = features.centre_pressure(history)

    def at(share: np.ndarray | float) -> np.ndarray:
        return np.interp(share, time[: top + 1] / time[top], centre[: top + 1])

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
        out[f"energy_915_{name.replace(' ', '_')}"] = features.energy(
            history, 915e-6, name=variable
        ).max()
    out["energy_rate_915"] = features.energy_rate(history, 915e-6)[
        "strain_energy_rate (Pa/s)"
    ].max()
    return {k: float(v) for k, v in out.items()}


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
