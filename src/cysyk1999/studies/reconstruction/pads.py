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

from cysyk1999.measures.energy_of_1999 import ELASTIC, FACTOR
from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.studies.reconstruction.unknowns import EPIDERMIS, LOAD, SCALED, SOFT, STIFFNESS
from fingerpad.healing import simulate
from fingerpad.measures import features, strokes
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen.outline import OutlineCurve

CURVATURES = (None, 78.74, 104.99, 157.48, 209.97, 314.96, 419.95, 629.92, 1259.84)
SURFACES = dict(zip("flat 79 105 158 210 315 420 630 1260".split(), CURVATURES, strict=True))
"""Curvatures (1/m) of the nine surfaces."""
PLATE, FAST = "plate", " at 150 gf/s"
"""The flat plate at 2 mm/s to 2 mm; what a surface is called at the faster ramp."""
WAVY, STROKED_PLATE = "wavy", "stroked plate"
"""Strokes at 10 mm/s: the six sharper convexities, where bursts and energies differ, and the flat
plate of section 5.5.
"""
CONVEXITIES = dict(zip("52 79 105 157 210 315".split(), (52.4934, *CURVATURES[1:6]), strict=True))
"""Curvatures (1/m) of the convexities of `WAVY`."""
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
ACCURACY: dict[str, object] = {"tolerance": 0.05, "once": True}
SCALE_FREE = ("mm", "1")
"""Units of what does not change with a factor on all moduli and the load."""
RECORDED = {name: variable for name, variable in ENERGIES.items() if variable != ELASTIC}
"""Other definitions of the energy that a history has."""
DEFINITIONS = ("", *(f"_{name.replace(' ', '_')}" for name in RECORDED))
"""What the name of an energy ends with, by its definition; nothing: the headline's."""
VARIABLES = dict(zip(DEFINITIONS, ("strain_energy_density", *RECORDED.values()), strict=True))


PLANE_STRESS = "_plane_stress"
"""What an energy ends with that a formula of plane stress gives the stresses in the plane."""
LEFT = 0.5759
"""What the Prony series leaves of an instantaneous shear modulus."""


def _defined(measure: str, unit: str) -> dict[str, str]:
    return {f"{measure}{definition}": unit for definition in DEFINITIONS}


MEASURES: dict[str, str] = {
    **dict.fromkeys(("depth_top", "depth_end", "width_top", "width_end"), "mm"),
    **dict.fromkeys(("peak", "centre_peak", "centre_end"), "Pa"),
    **dict.fromkeys(("first_over_dip", "top_over_dip", "late_change"), "1"),
    **{name: unit for z in DEPTHS for name, unit in _defined(f"energy_{z}", "Pa").items()},
    **_defined("energy_rate_915", "Pa/s"),
}
"""What is read of a ramp and hold, with its unit. top: the ramp's end; end: the hold's; energies
are the highest.
"""
STROKED: dict[str, str] = {
    "drag": "mm",
    **{f"pressure_{k}": "Pa" for k in CONVEXITIES},
    **{name: u for k in CONVEXITIES for name, u in _defined(f"energy_{k}", "Pa").items()},
    **_defined("energy_915", "Pa"),
    **_defined("energy_rate_915", "Pa/s"),
    **_defined("falls_to_210", "1"),
    **_defined("falls_to_315", "1"),
}
"""What is read of `WAVY`: at 915 um highest in all and over each convexity, centre pressures,
lateral displacement of the centre, and energies over that of the convexity before.
"""
STROKED_FLAT: dict[str, str] = {"drag": "mm", **_defined("energy_915", "Pa")}
"""What is read of the stroked plate, when it has slid."""
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
    rate = "150 gf/s" if fast else "40 gf/s"
    press: dict[str, object] = {"press_to_force": "20 gf", "rate": rate}
    document = {"specimen": specimen, "accuracy": ACCURACY, "stimulus": {"shape": "flat"}}
    depths = DEPTHS
    if name == PLATE:
        document["motion"] = [{"press_to_depth": "2 mm", "speed": "2 mm/s"}, {"hold": "6 s"}]
        depths = ()
    elif name in (WAVY, STROKED_PLATE):
        depths = DEPTHS[-2:-1]
        far, document["accuracy"] = ("46 mm", "draft") if name == WAVY else ("-5 mm", ACCURACY)
        document["motion"] = [press, {"slide": far, "speed": "10 mm/s", "keep": "force"}]
        if name == WAVY:
            curvatures = [f"{k} 1/m" for k in CONVEXITIES.values()]
            document["stimulus"] = {"shape": "wavy", "curvatures": curvatures}
    else:
        document["motion"] = [press, {"hold": "2 s"}]
        if curvature := SURFACES[name]:
            document["stimulus"] = {"shape": "cylinder", "curvature": f"{curvature} 1/m"}
    if depths:
        document["outputs"] = {"receptors": {"depths": [f"{z} um" for z in depths]}}
    return load_scene(document, f"reconstruction_{surface.replace(' ', '_').replace('/', '_')}")


def poisson_for(bulk: float) -> float:
    """Poisson's ratio whose bulk modulus, at the same shear modulus, is that of nu = 0.48 times a
    factor.

    ``kappa/G = 2 (1 + nu) / 3 (1 - 2 nu)``.
    """
    ratio = bulk * 2 * (1 + POISSON) / (3 * (1 - 2 * POISSON))
    return (3 * ratio - 2) / (2 * (3 * ratio + 1))


def changes(pad: Mapping[str, float], surface: str = PLATE) -> dict[str, object]:
    """What is special to a pad's scene: values of the design's axes as keys of a scene (SI)."""
    bone_top = APEX - 1e-3 * (pad["epidermis_thickness"] + pad["fat_thickness"]) - BELOW
    outline = {
        name: 1e-3 * pad[name]
        for name in ("apex_radius", "epidermis_thickness", "bone_half_width", "nail_half_width")
    }
    outline["bone_half_height"] = (bone_top + BONE_BOTTOM) / 2
    outline["bone_centre_height"] = (bone_top - BONE_BOTTOM) / 2
    values: dict[str, object] = {f"specimen.outline.{k}": v for k, v in outline.items()}
    stiff = YOUNG_EPIDERMIS * pad[STIFFNESS]
    for layer, young in {"epidermis": stiff, "dermis": YOUNG_SOFT, "fat": YOUNG_SOFT}.items():
        nu = poisson_for(pad["epidermis_bulk" if layer == "epidermis" else "bulk_modulus"])
        # the shear modulus stays
        values[f"specimen.layers.{layer}.youngs_modulus"] = young * (1 + nu) / (1 + POISSON)
        values[f"specimen.layers.{layer}.poisson_ratio"] = nu
    values["specimen.contact_length"] = FORCE / pad[LOAD]
    friction = pad["stroke_friction" if surface in (WAVY, STROKED_PLATE) else "friction"]
    if friction > 0:
        values["friction"] = float(friction)
    if surface == WAVY:
        values["motion[0].press_to_force"] = FORCE * float(pad["stroke_force"]) / 20
    return values


def scene(pad: Mapping[str, float], surface: str) -> Scene:
    """A pad's scene. Raises SceneError for a pad that cannot be, one line."""
    return base(surface).varied(changes(pad, surface))


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
    for definition, variable in VARIABLES.items():
        for z in DEPTHS:
            energy = features.energy(history, z * 1e-6, name=variable)
            out[f"energy_{z}{definition}"] = energy.max()
        out[f"energy_rate_915{definition}"] = _rate(
            history["time"].values, energy_915(history, variable)
        )
    return {k: float(v) for k, v in out.items()}


def energy_915(history: xr.Dataset, variable: str) -> np.ndarray:
    """Strain energy density (time) Pa at 915 um under the centre."""
    return features.energy(history, 915e-6, name=variable)


def _rate(time: np.ndarray, energy: np.ndarray) -> float:
    """Fastest rise of an energy, Pa/s."""
    return float(np.max(np.diff(energy) / np.diff(time)))


def of_wavy(history: xr.Dataset) -> dict[str, float]:
    """`STROKED` of a history."""
    stroke = strokes.loaded(history)
    ends, under = list(strokes.convexities(stroke).values()), strokes.place(stroke)
    over = (under >= ends[0].start) & (under <= ends[-1].end)
    time = strokes.time_of(stroke)
    out = {"drag": 1e3 * strokes.lateral(stroke)[over].mean()}
    for k, value in strokes.peaks(stroke, features.centre_pressure).items():
        out[f"pressure_{k}"] = value
    for definition, variable in VARIABLES.items():
        energy = energy_915(stroke, variable)
        found = strokes.peaks(stroke, lambda h, name=variable: energy_915(h, name))
        out |= {f"energy_{k}{definition}": value for k, value in found.items()}
        out[f"energy_915{definition}"] = energy[over].max()
        out[f"energy_rate_915{definition}"] = _rate(time[over], energy[over])
        for before, at in (("157", "210"), ("210", "315")):
            out[f"falls_to_{at}{definition}"] = found[at] / found[before]
    return {k: float(v) for k, v in out.items()}


def of_stroked_plate(history: xr.Dataset) -> dict[str, float]:
    """`STROKED_FLAT` of a history."""
    stroke = strokes.loaded(history)
    energies = {f"energy_915{k}": energy_915(stroke, v)[-1] for k, v in VARIABLES.items()}
    return {"drag": 1e3 * float(strokes.lateral(stroke)[-1])} | {
        k: float(v) for k, v in energies.items()
    }


KINDS = {
    PLATE: (of_plate, FORCES),
    WAVY: (of_wavy, STROKED),
    STROKED_PLATE: (of_stroked_plate, STROKED_FLAT),
}
"""How other surfaces than those of a ramp and hold are read, and what is read of them."""


def read(pad: Mapping[str, float], surface: str) -> dict[str, float]:
    """Simulate a pad's surface: `FORCES` of the plate, `STROKED` and `STROKED_FLAT` of strokes,
    `MEASURES` of any other.
    """
    return KINDS.get(surface, (of_press, MEASURES))[0](simulate(scene(pad, surface)))


def with_plane_stress(pad: Mapping[str, float], values: Mapping[str, float]) -> dict[str, float]:
    """What was read of a pad's surfaces, by "surface: measure", and the energies that a formula of
    plane stress gives its stresses: ``(sigma_1^2 + sigma_2^2 - 2 nu sigma_1 sigma_2) / 2 E``.

    The stresses follow from two energies of them, on instantaneous and on long-term moduli, whose
    parts of volume are the same. Exact for small strains and where both are highest at once; within
    3 % of the formula in the pad of nu = 0.48. nu is the printed one, E the instantaneous one.
    """
    found = dict(values)
    for key, total in values.items():
        surface, measure = key.split(": ")
        relaxed = values.get(f"{key}_long-term_moduli")
        if relaxed is None or not measure.startswith("energy"):
            continue
        upper = surface not in KINDS and measure in {f"energy_{z}" for z in DEPTHS[:6]}
        bulk = pad["epidermis_bulk" if upper else "bulk_modulus"]
        shear = (YOUNG_EPIDERMIS * pad[STIFFNESS] if upper else YOUNG_SOFT) / (2 * (1 + POISSON))
        kappa, shear = bulk * shear * 2 * (1 + POISSON) / (3 * (1 - 2 * POISSON)), shear / LEFT
        nu = (3 * kappa - 2 * shear) / (2 * (3 * kappa + shear))
        shape = (relaxed - total) / (1 / LEFT - 1)
        mean = 4.5 * kappa * (total - shape) / (1 + nu) ** 2
        half = 2 * shear * shape - (1 - 2 * nu) ** 2 * mean / 3
        young = 2 * shear * (1 + nu)
        found[key + PLANE_STRESS] = (mean * (1 - POISSON) + half * (1 + POISSON)) / young
    for at, before in (("210", "157"), ("315", "210")):
        energies = [found.get(f"{WAVY}: energy_{k}{PLANE_STRESS}") for k in (at, before)]
        if None not in energies:
            found[f"{WAVY}: falls_to_{at}{PLANE_STRESS}"] = energies[0] / energies[1]
    return found


def units(surface: str) -> dict[str, str]:
    """What is read of a surface, with its unit."""
    return KINDS.get(surface, (of_press, MEASURES))[1]


CHOSEN = {
    LOAD: FORCE / CHOSEN_LENGTH,
    STIFFNESS: 1.0,
    "apex_radius": 11.0,
    "fat_thickness": 3.8,
    "bone_half_width": 5.0,
    "epidermis_thickness": 0.85,
    "bulk_modulus": 1.0,
    "epidermis_bulk": 1.0,
    "nail_half_width": 5.0,
    "friction": 0.0,
    "stroke_friction": 0.45,
    "stroke_force": 20.0,
}
"""The pad of `START`, chosen one size at a time, on the axes of the design."""
BEFORE = CHOSEN | {
    SCALED: FORCE / 11.4e-3,
    SOFT: LEFT,
    EPIDERMIS: LEFT,
    LOAD: FORCE / 11.4e-3 / LEFT,
    "apex_radius": 8.1,
    "fat_thickness": 4.0,
    "bone_half_width": 3.0,
    "bulk_modulus": 1 / LEFT,
    "epidermis_bulk": 1 / LEFT,
    "nail_half_width": 6.0,
    "stroke_friction": 0.35,
    "plate_length": 9.4,
    "energy_factor": 1.0,
    "stroke_energy_factor": 1.0,
    "energy": "",
}
"""The pad of scenes, config/specimens/thesis.yaml, stroked with 20 gf and read as it is."""
HERE = BEFORE | {
    "energy": PLANE_STRESS,
    "energy_factor": FACTOR,
    "stroke_force": 27.0,
    "stroke_friction": 0.25,
}
"""The same pad, stroked with the force and read by the formula of plane stress as here."""
