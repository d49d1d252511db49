"""From a scene to what an emulator is asked: a point of its box, a modulus factor and a hold.

All moduli m times as large under m times the force, which rises m times as fast, deform the pad in
the same way: stresses are m times as large. So a factor of all moduli is exact and no knob. A hold
or a slide that ends sooner is the beginning of a longer one.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import WARPS
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.stimuli.motion import LEGS

FLAT = 0.05
"""1/m; a cylinder of less curvature departs from a flat plate by less than a micrometre at 6 mm."""
SAME = 1e-9
"""Relative; numbers that differ by less are the same."""
_FORCE = ("motion", 0, "press_to_force")
_RATE = ("motion", 0, "rate")
_NOT_ASKED = ("name", "tags", "accuracy", "outputs")
_MATERIALS = ("specimen", "layers")


@dataclass(frozen=True)
class Knob:
    """A key of the scene that may vary.

    Attributes
    ----------
    key, name : str
        The dotted key, and its name in the sweep.
    unit : str
        In which a person reads it.
    per_unit : float
        SI value of one such unit.
    low, high : float
        Ends of the box, SI.
    warp : str
        A key of `WARPS`.
    """

    key: str
    name: str
    unit: str
    per_unit: float
    low: float
    high: float
    warp: str = "linear"

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """Values as shares of the box, from -1 to 1."""
        ends = np.array([self.low, self.high])
        low, high = WARPS[self.warp](ends, *ends)
        return 2 * (WARPS[self.warp](values, *ends) - low) / (high - low) - 1

    def unscaled(self, shares: np.ndarray) -> np.ndarray:
        """Values of shares from -1 to 1."""
        even = np.geomspace if self.warp == "logarithm" else np.linspace
        values = even(self.low, self.high, 4001)
        return np.interp(shares, self.scaled(values), values)

    def shown(self, value: float, digits: int = 4) -> str:
        """A value with its unit."""
        return f"{value / self.per_unit:.{digits}g} {self.unit if self.unit != '1' else ''}".strip()

    def record(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def scaled(knobs: list[Knob], points: np.ndarray) -> np.ndarray:
    """Points (n, knobs), SI, of the box from -1 to 1."""
    columns = zip(knobs, np.asarray(points, float).T, strict=True)
    return np.stack([knob.scaled(column) for knob, column in columns], axis=1)


@dataclass(frozen=True)
class Question:
    """What a scene asks of an emulator.

    Attributes
    ----------
    point : numpy.ndarray
        (knobs,), SI, of the pad at modulus factor 1.
    modulus : float
        Moduli over those of the sweep's pad.
    later : float or None
        Length of the second leg, a hold (s) or a slide (m); None in a scene without.
    receptors : tuple of tuple
        (depth, offset), m.
    scene : Scene
        What was asked.
    outside : tuple of str
        A line for each knob outside the box.
    """

    point: np.ndarray
    modulus: float
    later: float | None
    receptors: tuple[tuple[float, float], ...]
    scene: Scene
    outside: tuple[str, ...] = ()


def path_of(key: str) -> tuple[str | int, ...]:
    """A dotted key as a path: ``motion[0].rate`` is ("motion", 0, "rate")."""
    words = key.replace("[", ".").replace("]", "").split(".")
    return tuple(int(word) if word.isdigit() else word for word in words)


def borders(base: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Keys whose sum is the depth of each border between two layers of a scene's specimen.

    Strain energy jumps there.

    Examples
    --------
    >>> borders({"specimen": {"outline": {}, "layers": {"epidermis": {}, "dermis": {}}}})[0]
    ('specimen.outline.epidermis_thickness',)
    """
    specimen = base["specimen"]
    for shape in ("slab", "half_round"):
        if specimen.get(shape):
            layers = range(len(specimen[shape]["layers"]))
            keys = [f"specimen.{shape}.layers[{k}].thickness" for k in layers]
            return [tuple(keys[: k + 1]) for k in layers[:-1]]
    if specimen.get("mesh"):
        return []
    horny, skin, below = (
        f"specimen.outline.{layer}_thickness"
        for layer in ("stratum_corneum", "epidermis", "dermis")
    )
    first = [(horny,)] if "stratum_corneum" in specimen["layers"] else []
    return [*first, (skin,), (skin, below)]


def looked_up(document: Any, key: str) -> Any:
    """The value of a dotted key."""
    for word in path_of(key):
        document = document[word]
    return document


def flattened(part: Any, path: tuple = ()) -> dict[tuple, Any]:
    """Path -> plain value of all that a scene says."""
    if isinstance(part, Mapping) and part:
        items: Any = part.items()
    elif isinstance(part, list) and part:
        items = enumerate(part)
    else:
        return {path: part}
    return {k: v for key, value in items for k, v in flattened(value, (*path, key)).items()}


def ask(
    scene: Scene | str | Path | Mapping[str, Any], base: Mapping[str, Any], knobs: list[Knob]
) -> Question:
    """Read a scene as a question.

    Parameters
    ----------
    scene
        The scene.
    base
        The sweep's scene, as `Scene.canonical` gives it.
    knobs
        What may differ from it.

    Raises
    ------
    SceneError
        The scene differs from the sweep's in anything else; one line.
    """
    scene = load_scene(scene)
    said, known = (flattened(s) for s in (_plain(scene.canonical()), _plain(base)))
    if said.get(("stimulus", "shape")) == "flat" and ("stimulus", "curvature") in known:
        said |= {("stimulus", "shape"): "cylinder", ("stimulus", "curvature"): 0.0}
    _same_legs(scene.name, said, known)
    modulus = _modulus(scene.name, said, known)
    leg, unit = ("slide", "m") if ("motion", 1, "slide") in known else ("hold", "s")
    later = said.pop(("motion", 1, leg), None)
    longest = known.pop(("motion", 1, leg), None)
    if later is None:
        known = {path: value for path, value in known.items() if path[:2] != ("motion", 1)}
    elif not 0 < later / longest <= 1 + SAME:
        allowed = f"up to {longest:g} {unit}"
        raise _refusal(scene.name, f"motion[1].{leg}", f"{later:g} {unit}", allowed)
    point, outside = [], []
    _same(scene.name, ("stimulus", "shape"), said, known)  # first, for its other keys depend on it
    for knob in knobs:
        path = path_of(knob.key)
        allowed = f"{knob.shown(knob.low)} to {knob.shown(knob.high)}"
        value = said.pop(path, None)
        known.pop(path, None)
        if not isinstance(value, (int, float)):
            raise _refusal(scene.name, knob.key, _word(value), allowed)
        if path == ("stimulus", "curvature") and value < FLAT and knob.low < FLAT:
            value = max(value, knob.low)
        if path in (_FORCE, _RATE):
            value /= modulus
        if not knob.low * (1 - SAME) <= value <= knob.high * (1 + SAME):
            what = knob.shown(value, 7) + (f" at a modulus factor of {modulus:.3g}") * (
                modulus != 1
            )
            outside.append(str(_refusal(scene.name, knob.key, what, allowed)))
        point.append(value)
    if modulus != 1:  # what is left of the force and its rate is the sweep's own, times the factor
        known |= {p: known[p] * modulus for p in (_FORCE, _RATE) if isinstance(known.get(p), float)}
    for path in sorted(said.keys() | known.keys(), key=str):
        _same(scene.name, path, said, known, modulus)
    receptors = scene.outputs.receptors
    places = tuple((d, o) for d in receptors.depths for o in receptors.offsets)
    return Question(np.array(point), modulus, later, places, scene, tuple(outside))


def _plain(canonical: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in canonical.items() if key not in _NOT_ASKED}


def _dotted(path: tuple) -> str:
    return "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in path).lstrip(".")


def _same_legs(name: str, said: Mapping[tuple, Any], known: Mapping[tuple, Any]) -> None:
    """Refuse other legs than the sweep's; a second one may be left out."""
    legs = [{p[1:3] for p in of if p[0] == "motion"} for of in (said, known)]
    if legs[0] not in (legs[1], {leg for leg in legs[1] if leg[0] == 0}):
        words = [
            _programme({p[1:3] for p in of if p[0] == "motion" and of[p] is not None})
            for of in (said, known)
        ]
        raise _refusal(name, "motion", words[0], f"{words[1]}, as in the sweep")


def _programme(legs: set[tuple[int, str]]) -> str:
    """The keys of each leg in words, the leg's own before the others."""
    found = []
    for number in sorted({leg for leg, _ in legs}):
        keys = sorted((k for leg, k in legs if leg == number), key=lambda k: (k not in LEGS, k))
        found.append(keys[0] + " with " * (len(keys) > 1) + " and ".join(keys[1:]))
    return ", then ".join(found)


def _modulus(name: str, said: dict[tuple, Any], known: dict[tuple, Any]) -> float:
    """The factor of all moduli, which are taken out; 1 where they have no common one."""
    moduli = [p for p in known if p[:2] == _MATERIALS and p[-1] == "youngs_modulus"]
    if not moduli or any(not isinstance(said.get(p), float) for p in moduli):
        return 1.0
    ratios = [said[p] / known[p] for p in moduli]
    if max(ratios) > min(ratios) * (1 + 1e-6):
        return 1.0
    for path in moduli:
        del said[path], known[path]
    return 1.0 if abs(ratios[0] - 1) < SAME else ratios[0]


def _same(
    name: str,
    path: tuple,
    said: Mapping[tuple, Any],
    known: Mapping[tuple, Any],
    modulus: float = 1.0,
) -> None:
    """Refuse another value than the sweep's."""
    value, allowed = said.get(path), known.get(path)
    if not _equal(value, allowed):
        times = ", times the factor of the moduli" * (modulus != 1 and path in (_FORCE, _RATE))
        allowed = f"{_word(allowed)}, as in the sweep{times}"
        raise _refusal(name, _dotted(path), _word(value), allowed)


def _word(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.7g} (SI)"
    return "left out" if value is None else json.dumps(value)


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return math.isclose(a, b, rel_tol=SAME)
    return a == b


def _refusal(name: str, key: str, value: str, allowed: str) -> SceneError:
    return SceneError(f"{name}: {key}: {value} is outside the emulator; allowed: {allowed}")
