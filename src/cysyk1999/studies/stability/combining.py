"""Hard cases in which levels of several factors meet: as the catalogue lists them, and drawn anew.

``config/stability/combinations.yaml`` says what a level is in a scene, which pairs of levels are
kept apart and why, and which levels meet in each case of the catalogue.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, product
from typing import Any

import numpy as np
import yaml

from cysyk1999.studies.common.documents import CONFIG

DOCUMENT = yaml.safe_load((CONFIG / "stability" / "combinations.yaml").read_text(encoding="utf-8"))
FACTORS: dict[str, dict[str, Any]] = DOCUMENT["factors"]
"""Factor -> its levels, the easy one first, each with what it is in a scene."""
EASY = {factor: next(iter(levels)) for factor, levels in FACTORS.items()}
PARTS_OF_A_SLAB = ("cover", "middle", "core")
LAYERS = ("epidermis", "dermis", "fat")
TAU = 3.25
"""s, the longest time constant of the pad; its share is the length of a step."""
STEPS = 6
"""Of a leg that takes time."""
FASTEST = {"gf/s": 4000.0, "mm/s": 200.0, "slide": 400.0}
SMOOTH = ("210 1/m", "flat", "1260 1/m", "hollow", "two waves")
"""Surfaces without a corner, whose pressure is bounded and as smooth as the mesh."""
FINE = ("needle", "noisy profile", "rounded profile")
"""Surfaces whose pressure is bounded, but as narrow as a few nodes."""
MOST = 5
"""Hard levels that meet in a case, at most."""
CANDIDATES = 30
"""Drawn for each case; the one that has most pairs that have not met yet is taken."""


def pairs(levels: Mapping[str, str]) -> set[frozenset[tuple[str, str]]]:
    """Every two of some levels of factors."""
    return {frozenset(pair) for pair in combinations(levels.items(), 2)}


def _apart() -> set[frozenset[tuple[str, str]]]:
    found = set()
    for entry in DOCUMENT["apart"]:
        (one, first), (other, second) = (item for item in entry.items() if item[0] != "why")
        found |= {frozenset([(one, a), (other, b)]) for a, b in product(first, second)}
    return found


APART = _apart()
"""Pairs of levels that cannot meet."""


def combined(number: int, levels: Mapping[str, str], compare: tuple[str, ...] = ()) -> dict:
    """The entry of the catalogue in which these hard levels meet, others being easy.

    Parameters
    ----------
    number : int
        Begins its name.
    levels : dict of str
        Factor -> hard level.
    compare : tuple of str
        Dear comparisons: "halving", "solver", "reference".
    """
    every = {**EASY, **levels}
    here = {factor: FACTORS[factor][level] for factor, level in every.items()}
    share = here["time"]
    pad = dict(here["pad"] or {})
    mesh = pad.pop("mesh", None)
    effects = {"finite_strain": here["strain"]}
    effects |= {"viscoelasticity": "on"} if isinstance(share, float) else {}
    effects |= {"symmetry": "off"} if every["model"] == "whole" else {}
    scene = {
        "specimen": _specimen(pad, here),
        "stimulus": here["stimulus"],
        "friction": here["friction"],
        "motion": _motion(every["load"], every["then"], share),
        "effects": effects,
    }
    steps = {"one step": 1, "steady": None}.get(every["time"], STEPS)
    entry = {"group": every["stimulus"], "scene": scene, "limits": _limits(every), "steps": steps}
    entry |= {"name": f"{number}: {every['stimulus']}, {every['pad']}", "mesh": mesh}
    return entry | {"compare": tuple(compare), "levels": dict(levels)}


def _specimen(pad: dict[str, Any], here: Mapping[str, Any]) -> dict[str, Any]:
    """The specimen with the moduli, Poisson's ratio and law of some levels in every layer."""
    same = {"poisson_ratio": here["nu"], "law": here["law"]}
    moduli = [{"youngs_modulus": modulus} | same for modulus in here["skin : fat"]]
    for shape in {"slab", "half_round"} & pad.keys():
        thick = ("0.85 mm", "0.85 mm", "4.3 mm")
        each = zip(PARTS_OF_A_SLAB, thick, moduli, strict=True)
        layers = [{"name": name, "thickness": size} | layer for name, size, layer in each]
        return pad | {shape: pad[shape] | {"layers": layers}}
    layers = dict(zip(LAYERS, moduli, strict=True))
    layers |= {name: layer | same for name, layer in pad.get("layers", {}).items()}
    return pad | {"layers": layers}


def _motion(load: str, then: str, share: float | str | None) -> list[dict[str, Any]]:
    """Legs of a motion; ``share`` of the longest time constant is a step's length."""
    size, unit = load.split()
    target = "press_to_force" if unit == "gf" else "press_to_depth"
    keep = "force" if unit == "gf" else "depth"
    press, slide, off, hold = {target: load}, {"keep": keep}, {"lift": "steady"}, "2 s"
    if isinstance(share, float):
        lasts = STEPS * share * TAU
        most = min(FASTEST["mm/s" if unit == "mm" else "gf/s"], 200.0 * float(size))
        pace = f"{min(float(size) / lasts, most):g} {unit}/s"
        sideways = f"{min(2.0 / lasts, FASTEST['slide']):g} mm/s"
        press |= {"rate" if unit == "gf" else "speed": pace}
        slide |= {"speed": sideways}
        off, hold = {"lift": sideways}, f"{lasts:g} s"
    after = {
        "nothing": [],
        "a hold": [{"hold": hold}],
        "a stroke": [{"slide": "2 mm"} | slide],
        "there and back": [{"slide": "1 mm"} | slide, {"slide": "-1 mm"} | slide],
        "off and on": [off, press],
        "step and repeat": [{"step": "2 mm", "every": "1 mm"}],
    }
    return [press, *after[then]]


def _limits(every: Mapping[str, str]) -> dict[str, float]:
    """What a stable run of some levels may measure: more where its steps are long or its surface
    has corners, of whose pressure a mesh shows what it can.
    """
    stimulus, limits = every["stimulus"], {}
    if every["time"] == "one step" or every["then"] == "step and repeat":
        limits = {"energy": np.inf}
    elif every["time"] == "steady":
        limits = {"energy": 0.35}
    even = 0.15 if stimulus in SMOOTH else 0.3 if stimulus in FINE else np.inf
    return limits | {"checkerboard": np.inf if every["pad"] == "outer ridges" else even}


def listed() -> Iterator[dict]:
    """Entries of the catalogue."""
    for number, case in DOCUMENT["cases"].items():
        levels = dict(case)
        yield combined(number, levels, tuple(levels.pop("compare", ())))


def drawn(seed: int, count: int) -> Iterator[dict]:
    """Entries that the catalogue does not have: of each some candidates are drawn, and that is
    taken in which most pairs of levels meet that have not met before.

    Every surface comes as often as any other. A third are compared with half the step, a fifth
    with the other solver.

    Examples
    --------
    >>> [entry["name"] for entry in drawn(seed=1, count=2)]
    ['1001: flat, graded 1:100', '1002: 1260 1/m, distorted triangles']
    """
    rng = np.random.default_rng(seed)
    met, known = set(), [entry["levels"] for entry in listed()]
    stimuli = list(FACTORS["stimulus"])[1:]
    for k in range(count):
        candidates = [_candidate(rng, stimuli[k % len(stimuli)]) for _ in range(CANDIDATES)]
        fresh = [levels for levels in candidates if levels not in known]
        levels = max(fresh, key=lambda levels: len(pairs(levels) - met))
        met |= pairs(levels)
        known.append(levels)
        compare = (("halving",) if k % 3 == 0 else ()) + (("solver",) if k % 5 == 1 else ())
        yield combined(1000 * seed + k + 1, levels, compare)


def _candidate(rng: np.random.Generator, stimulus: str) -> dict[str, str]:
    """Two hard levels or more, up to :data:`MOST`, none of which are kept apart."""
    others = [factor for factor in FACTORS if factor != "stimulus"]
    while True:
        many = int(rng.integers(1, MOST))
        chosen = {others[k] for k in rng.choice(len(others), many, replace=False)}
        levels = {"stimulus": stimulus}
        for factor in (factor for factor in others if factor in chosen):
            levels[factor] = str(rng.choice(list(FACTORS[factor])[1:]))
        if not pairs(levels) & APART:
            return levels
