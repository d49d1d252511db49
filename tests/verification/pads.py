"""A small fingerpad (its own outline, not the configured one) with the mechanics put together by
hand.
"""

from functools import lru_cache

import numpy as np
from pressing import TIGHT, walk
from problems import BODIES

from fingerpad.mechanics.space import Space
from fingerpad.mechanics.stepping import Step
from fingerpad.scenes.specimen import Outline
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.materials import Prony, moduli
from fingerpad.specimen.pad import MeshSize
from fingerpad.stimuli.shapes import Cylinder, Flat

THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))
SHAPES = {"flat": Flat(), "cylinder": Cylinder(curvature=210.0)}
LAYERS = (0.15e6, 0.015e6, 0.015e6)  # Young's moduli, Pa
LOAD = 19.6  # N/m, 20 gram-weight over 10 mm


@lru_cache
def pad_mesh(skin_edge=300e-6):
    """Coarse whole pad, symmetric quads of nine nodes."""
    lengths = {
        "apex_height": 6,
        "apex_radius": 7.9,
        "half_width": 8.5,
        "depth_below": 6.2,
        "epidermis_thickness": 0.85,
        "dermis_thickness": 0.85,
        "stratum_corneum_thickness": 0.35,
        "bone_centre_height": -1.5,
        "bone_half_width": 4,
        "bone_half_height": 2.5,
        "nail_half_width": 5,
    }
    outline = Outline(**{key: f"{value} mm" for key, value in lengths.items()})
    return build_pad_mesh(outline, MeshSize(skin_edge, 3e-3, 0.95 * skin_edge, growth=1.4))


def pad_body(mesh, strain="small", poisson=0.48, prony=None, layers=LAYERS, scale=1.0):
    """Body of a whole or half pad with long-term moduli, all multiplied by ``scale``."""
    fixed = np.zeros(mesh.points.shape, bool)
    for name in ("bone", "nail"):
        fixed[np.unique(mesh.curves[name])] = True
    if mesh.half:
        fixed[np.unique(mesh.curves["symmetry"]), 0] = True
    known = moduli(scale * np.array(layers), np.full(3, poisson), prony or Prony())
    space = Space(mesh.points, mesh.cells, mesh.element, fixed)
    return BODIES[strain](space, known.shear_long_term[mesh.region], known.bulk[mesh.region], prony)


def press_pad(body, mesh, shape="flat", settings=TIGHT, **goal):
    """Press the right half of a pad to force=(whole pad, N/m) or depth= (m) in one elastic step."""
    if "force" in goal:
        goal["force"] *= 0.5 if mesh.half else 1.0
    return walk(body, mesh, [Step(0, 1.0, 1.0, **goal)], SHAPES[shape], settings, "skin")


def ramp_and_hold(key, goal, count, seconds=0.5, held=2.0):
    """Steps of a ramp at constant speed in ``count`` steps and a hold in as many growing ones."""
    ramp = [
        Step(0, seconds * k / count, seconds / count, **{key: goal * k / count})
        for k in range(1, count + 1)
    ]
    ends = seconds + held * (np.arange(1, count + 1) / count) ** 1.5
    sizes = np.diff(ends, prepend=seconds)
    return ramp + [Step(1, t, dt, **{key: goal}) for t, dt in zip(ends, sizes, strict=True)]
