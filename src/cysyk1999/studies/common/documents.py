"""Parts of scene documents that studies write: stimuli, legs of a motion, and the scene of one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fingerpad.scenes.scene import Scene
from fingerpad.scenes.specimen import Source

CONFIG = Path(__file__).resolve().parents[4] / "config"
SCENES = CONFIG / "scenes"

FLAT = {"shape": "flat"}
TWO_WAVES = {
    "shape": "wavy",
    "curvatures": ["104.99 1/m", "209.97 1/m"],
    "lead_in": "4 mm",
    "run_out": "5 mm",
}


def scene_of(document: dict[str, Any], name: str, folder: Path = SCENES) -> Scene:
    """Check a scene document; files that it names are relative to ``folder``."""
    scene = Scene.model_validate(document, context=Source(folder / "case.yaml"))
    return scene.varied({"name": name})


def cylinder(curvature: float) -> dict[str, str]:
    """A cylinder of a curvature in 1/m."""
    return {"shape": "cylinder", "curvature": f"{curvature:g} 1/m"}


def force(gram_weight: float, rate: float | None = None) -> dict[str, str]:
    """A press to a force in gf, with a rate in gf/s unless it is steady."""
    return _leg("press_to_force", f"{gram_weight:g} gf", "rate", rate, "gf/s")


def depth(millimetres: float, speed: float | None = None) -> dict[str, str]:
    """A press to a depth in mm, with a speed in mm/s unless it is steady."""
    return _leg("press_to_depth", f"{millimetres:g} mm", "speed", speed, "mm/s")


def slide(millimetres: float, speed: float | None = 10, keep: str = "force") -> dict[str, str]:
    """A stroke over a distance in mm that keeps force or depth."""
    return _leg("slide", f"{millimetres:g} mm", "speed", speed, "mm/s") | {"keep": keep}


def hold(seconds: float) -> dict[str, str]:
    """A hold of a duration in s."""
    return {"hold": f"{seconds:g} s"}


def _leg(kind: str, target: str, rate: str, value: float | None, unit: str) -> dict[str, str]:
    return {kind: target} | ({} if value is None else {rate: f"{value:g} {unit}"})


RAMP = [force(20, 40), hold(2)]
