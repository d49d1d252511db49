"""The catalogue of the study: the hand-picked cases, and combinations in which every pair of hard
factors' levels meets.

:data:`FACTORS` says what can be hard, the first level of each being the easy one; :data:`APART`
says which levels cannot meet, and why. The combinations are the rows of a pairwise covering array
(:mod:`cysyk1999.studies.stability.covering`).
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cysyk1999.studies.accuracy.meshes import corners_only, distorted, triangles
from cysyk1999.studies.stability.covering import Row, covering
from cysyk1999.studies.stability.hard_cases import (
    FLAT,
    LINE,
    PICKED,
    ROUNDED_BAR,
    SHARP_BAR,
    TWO_WAVES,
    Case,
    Limits,
    Points,
    cylinder,
    depth,
    force,
    hold,
    of_built,
    slide,
)
from fingerpad.planning.plan import Plan
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.pad import MeshError, PadMesh
from fingerpad.specimen.quality import check_orientation

SEED = 19
MOST = 5
"""Hard levels in a combination."""
STEPS = 6
"""Of a leg that takes time."""
TAU = 3.25
"""s, about the longest time constant."""


@dataclass(frozen=True)
class Level:
    """A level of a factor: what it sets, and which limits it widens for all cases that have it."""

    sets: Any = None
    limits: Mapping[str, float] = field(default_factory=dict)


def _noisy() -> Points:
    x = np.arange(-8, 8.001, 0.02)
    return x, 0.1 * x**2 / 2 + np.random.default_rng(SEED).normal(0, 0.002, len(x))


def _rounded() -> Points:
    x = np.arange(-8, 8.001, 0.05)
    return x, np.round(0.21 * x**2 / 2, 2)


def _hollow() -> Points:
    x = np.arange(-8, 8.001, 0.1)
    return x, 3.2 - 0.1 * x**2 / 2


def _grating() -> Points:
    x = np.concatenate([[s - 0.5, s + 0.5, s + 0.7, s + 1.3] for s in np.arange(-8, 9, 2)])
    return x, np.tile([0, 0, 0.3, 0.3], len(x) // 4)


def _graded(scene: Scene, plan: Plan) -> PadMesh:
    """Edges of 15 um under the apex that grow to about a hundred times as much."""
    size = replace(
        plan.mesh_size,
        focus=((0.0, 15e-6),),
        skin_radial_edge=15e-6,
        growth=2.0,
        coarse_edge=1.8e-3,
    )
    return build_pad_mesh(scene.specimen.outline, size)


def _distorted(mesh: PadMesh) -> PadMesh:
    """Inner nodes moved by 0.3 of an edge, or by less where long elements would fold."""
    for share in (0.3, 0.15, 0.08, 0.04):
        with suppress(MeshError):
            moved = distorted(mesh, share)
            check_orientation(moved, "mesh")
            return moved
    return mesh


def _aside(mesh: PadMesh) -> PadMesh:
    return replace(mesh, points=mesh.points + [0.7e-3, 0.0], symmetric=False)


_RIDGES = {
    "inner": {"pitch": "0.8 mm"},
    "half_width": "1.2 mm",
}  # three or four of them, for few nodes
_EDGE, _PEAKS = (
    {"checkerboard": np.inf, "factorisations": 8.0},
    {"checkerboard": 0.3, "factorisations": 8.0},
)
_STEADY = {"energy": 0.35, "factorisations": 8.0}
_AT_ONCE = {"energy": np.inf, "factorisations": 16.0, "cuts": 6.0}

FACTORS: dict[str, dict[str, Level]] = {
    "stimulus": {
        "210 1/m": Level(cylinder(209.97)),
        "flat": Level(FLAT),
        "1260 1/m": Level(cylinder(1259.84)),
        "needle": Level(cylinder(1e4), _PEAKS),
        "sharp bar": Level(SHARP_BAR, _EDGE),
        "filleted bar": Level(ROUNDED_BAR, _EDGE),
        "line": Level(LINE, _EDGE),
        "noisy profile": Level(_noisy(), _PEAKS),
        "rounded profile": Level(_rounded(), _PEAKS),
        "steep flanks": Level(([-8, -1.2, -1, 1, 1.2, 8], [1, 1, 0, 0, 1, 1]), _EDGE),
        "grating": Level(_grating(), _EDGE),
        "hollow": Level(_hollow()),
        "hole": Level(([-9, -1.5, -1, 1, 1.5, 9], [0, 0, 2, 2, 0, 0]), _EDGE),
        "two waves": Level(TWO_WAVES | {"lead_in": "1 mm"}),
    },
    "pad": {
        "built": Level(),
        "thin horny layer": Level("stratum_corneum"),
        "inner ridges": Level({"ridges": _RIDGES}),
        "outer ridges": Level({"ridges": _RIDGES | {"outer": {}}}, {"checkerboard": np.inf}),
        "slab": Level("slab"),
        "half-round": Level("half_round"),
        "off-centre mesh": Level(of_built(_aside)),
        "graded 1:100": Level(_graded),
        "distorted quads": Level(of_built(_distorted)),
        "linear quads": Level(of_built(corners_only)),
        "distorted triangles": Level(of_built(lambda mesh: triangles(_distorted(mesh)))),
        "linear triangles": Level(of_built(lambda mesh: corners_only(triangles(mesh)))),
    },
    "nu": {
        "0.48": Level(0.48),
        "0.3": Level(0.3),
        "0.4999": Level(0.4999),
        "0.49999": Level(0.49999),
    },
    "skin : fat": {
        "10 : 1": Level(("0.15 MPa", "15 kPa", "15 kPa")),
        "1 : 1": Level(("15 kPa", "15 kPa", "15 kPa")),
        "1e4 : 1": Level(("150 MPa", "15 kPa", "15 kPa")),
        "1 : 1e4": Level(("15 kPa", "15 kPa", "150 MPa")),
    },
    "law": {
        "neo-Hooke": Level("neo_hooke"),
        "Yeoh": Level({"name": "yeoh", "second": 0.5, "third": 0.1}),
        "steep Yeoh": Level({"name": "yeoh", "second": 3, "third": 1}),
    },
    "friction": {"none": Level(0.0), "0.3": Level(0.3), "0.7": Level(0.7), "1.5": Level(1.5)},
    "load": {
        "20 gf": Level(("force", 20.0)),
        "0.01 gf": Level(("force", 0.01)),
        "500 gf": Level(("force", 500.0)),
        "1 mm": Level(("depth", 1.0)),
        "3 mm": Level(("depth", 3.0)),
    },
    "then": {
        "nothing": Level(),
        "a hold": Level(),
        "a stroke": Level(),
        "there and back": Level(),
        "off and on": Level(),
        "step and repeat": Level(limits=_AT_ONCE),
    },
    "time": {
        "steady": Level(limits=_STEADY),
        "one step": Level(limits=_AT_ONCE),
        "1e-4 tau": Level(1e-4),
        "1 tau": Level(1.0),
        "1e3 tau": Level(1e3),
    },
    "strain": {"finite": Level("on"), "small": Level("off")},
    "model": {"half": Level(), "whole": Level("off")},
}
"""Factor -> its levels, the easy one first. Half: where scene and mesh are mirror images; there a
whole pad shows whether its state is one.
"""

_SHARP = (
    "1260 1/m",
    "needle",
    "sharp bar",
    "filleted bar",
    "line",
    "steep flanks",
    "grating",
    "hole",
)
APART: dict[tuple[tuple[str, str], tuple[str, str]], str] = {
    **{(("stimulus", name), ("load", "500 gf")): "goes through to the bone" for name in _SHARP},
    **{
        (("stimulus", name), ("load", "3 mm")): "cuts the skin: depths of many times the radius"
        for name in ("needle", "line")
    },
    **{
        (("skin : fat", "1 : 1e4"), ("load", name)): "the soft layers are 1.7 mm thick"
        for name in ("3 mm", "1 mm", "500 gf")
    },
    (("skin : fat", "1e4 : 1"), ("load", "0.01 gf")): "dents of nanometres",
    **{
        (
            narrow,
            ("then", moving),
        ): "narrower than the nodes of a mesh for a contact that moves, as the plan says"
        for narrow in (("stimulus", "needle"), ("stimulus", "line"), ("load", "0.01 gf"))
        for moving in ("a stroke", "there and back", "step and repeat")
    },
}
"""Pairs of levels that cannot meet -> why."""


def allowed(row: Row) -> bool:
    """Whether no two of these levels are kept apart."""
    return not any(row.get(f) == one and row.get(g) == other for (f, one), (g, other) in APART)


def _legs(row: Row) -> list[dict[str, str]]:
    (kind, target), how, steps = (
        FACTORS["load"][row["load"]].sets,
        row["time"],
        FACTORS["time"][row["time"]].sets,
    )
    lasts = None if steps is None else STEPS * steps * TAU
    if how == "1e-4 tau":  # inertia would matter beyond it
        press = force(target, min(4e3, target / 5e-3)) if kind == "force" else depth(target, 200)
        speed, wait = 400.0, lasts
    elif lasts is None:
        press, speed, wait = (force if kind == "force" else depth)(target), None, 2.0
    else:
        press = (force if kind == "force" else depth)(target, target / lasts)
        speed, wait = 2 / lasts, lasts
    lift = {"lift": "steady" if speed is None else f"{speed:g} mm/s"}
    then = {
        "nothing": [],
        "a hold": [hold(wait)],
        "a stroke": [slide(2, speed, kind)],
        "there and back": [slide(1, speed, kind), slide(-1, speed, kind)],
        "off and on": [lift, press],
        "step and repeat": [{"step": "2 mm", "every": "1 mm"}],
    }
    return [press, *then[row["then"]]]


def _specimen(row: Row) -> dict[str, Any]:
    nu, law, made = (FACTORS[factor][row[factor]].sets for factor in ("nu", "law", "pad"))
    moduli = FACTORS["skin : fat"][row["skin : fat"]].sets
    layers = [{"youngs_modulus": modulus, "poisson_ratio": nu, "law": law} for modulus in moduli]
    if made in ("slab", "half_round"):
        names, thick = ("cover", "middle", "core"), ("0.85 mm", "0.85 mm", "4.3 mm")
        stack = [
            {"name": n, "thickness": t} | layer
            for n, t, layer in zip(names, thick, layers, strict=True)
        ]
        return {
            made: {"width": "20 mm"} | {"layers": stack}
            if made == "slab"
            else {"radius": "6 mm", "layers": stack},
            "prony": "thesis",
        }
    named = dict(zip(("epidermis", "dermis", "fat"), layers, strict=True))
    if made == "stratum_corneum":
        named[made] = layers[0] | {"youngs_modulus": "10 MPa"}
    return {"layers": named} | (made if isinstance(made, dict) else {})


def _case(number: int, row: Row) -> Case:
    stimulus, made = FACTORS["stimulus"][row["stimulus"]].sets, FACTORS["pad"][row["pad"]].sets
    scene = {
        "specimen": _specimen(row),
        "stimulus": stimulus if isinstance(stimulus, dict) else {"shape": "sampled"},
        "friction": FACTORS["friction"][row["friction"]].sets,
        "motion": _legs(row),
        "effects": {"finite_strain": FACTORS["strain"][row["strain"]].sets},
    }
    if FACTORS["time"][row["time"]].sets is not None:
        scene["effects"]["viscoelasticity"] = "on"
    if row["model"] == "whole":
        scene["effects"]["symmetry"] = "off"
    wide = [FACTORS[factor][level].limits for factor, level in row.items()]
    limits = {
        name: max(limit[name] for limit in wide if name in limit)
        for name in {name for limit in wide for name in limit}
    }
    return Case(
        f"{number}: {row['stimulus']}, {row['pad']}",
        row["stimulus"],
        "; ".join(
            f"{factor} {level}"
            for factor, level in row.items()
            if factor != "stimulus" and level != easy(factor)
        ),
        scene,
        Limits(**{"checkerboard": 0.15} | limits),
        1
        if row["time"] == "one step"
        else STEPS
        if scene["effects"].get("viscoelasticity")
        else None,
        made if callable(made) else None,
        points=None if isinstance(stimulus, dict) else stimulus,
    )


def easy(factor: str) -> str:
    """The easy level of a factor."""
    return next(iter(FACTORS[factor]))


def combinations() -> list[Row]:
    """The rows of the covering array, by stimulus."""
    rows = covering(
        {factor: list(levels) for factor, levels in FACTORS.items()}, allowed, SEED, MOST
    )
    return sorted(rows, key=lambda row: list(FACTORS["stimulus"]).index(row["stimulus"]))


COMBINED = [_case(number, row) for number, row in enumerate(combinations(), start=len(PICKED) + 1)]
CATALOGUE: dict[str, Case] = PICKED | {case.name: case for case in COMBINED}
_MOVING = {"slide", "step"}


def _has_reference(case: Case) -> bool:
    """Whether a mesh of half the edges is cheap: a built one of a pad without ridges, pressed by a
    plate or a cylinder.
    """
    still = not any(_MOVING & set(leg) for leg in case.scene["motion"])
    smooth = (
        case.scene["stimulus"]["shape"] in ("flat", "cylinder") and "accuracy" not in case.scene
    )
    return (
        still
        and smooth
        and case.mesh is None
        and not case.may_fail
        and "ridges" not in case.scene.get("specimen", {})
    )


HALVED = frozenset([*PICKED, *(case.name for case in COMBINED[::3])])
"""Cases that are run with half the step as well, and by the methods for comparison."""
SECOND_SOLVER = frozenset([*list(PICKED)[::6], *(case.name for case in COMBINED[1::6])])
"""Cases that the other linear solver is tried in as well."""
REFERENCE = frozenset([name for name, case in CATALOGUE.items() if _has_reference(case)][-30:])
"""Cases that are held against a converged reference."""
FAST = tuple(
    case.name
    for case in COMBINED
    if case.name.startswith(
        ("56:", "59:", "63:", "66:", "70:", "73:", "80:", "83:", "89:", "97:", "177:", "192:")
    )
)
"""Of the combinations, some that take no time: those that the tests run."""
