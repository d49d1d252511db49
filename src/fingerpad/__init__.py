"""The human fingerpad in touch: skin, contact and the strain energy that receptors see.

Five verbs are the whole shallow interface; each is imported at its first use.

- ``load_scene(path)``: read and check a scene, a file or a dictionary; it gives a ``Scene``
  (`fingerpad.scenes.scene`).
  ``plan``, ``simulate`` and ``sweep`` take the file or the dictionary too.
- ``plan(scene)``: choose effects and discretisation, with reasons (`fingerpad.planning.plan`).
- ``simulate(scene)``: run it; returns an `xarray.Dataset` (`fingerpad.simulation`).
- ``sweep(scene, over)``: many variations of it, as one `xarray.Dataset`
  (`fingerpad.sweeps.engine`).
- ``respond(history)``: impulse rates and impulses of its receptors (`fingerpad.receptors.respond`).
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fingerpad.planning.plan import plan
    from fingerpad.receptors.respond import respond
    from fingerpad.scenes.scene import Scene, load_scene
    from fingerpad.simulation import simulate
    from fingerpad.sweeps.engine import sweep

__all__ = ["Scene", "load_scene", "plan", "respond", "simulate", "sweep"]

HOMES = {
    "Scene": "fingerpad.scenes.scene",
    "load_scene": "fingerpad.scenes.scene",
    "plan": "fingerpad.planning.plan",
    "respond": "fingerpad.receptors.respond",
    "simulate": "fingerpad.simulation",
    "sweep": "fingerpad.sweeps.engine",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("fingerpad")
    if name not in HOMES:
        raise AttributeError(f"module 'fingerpad' has no attribute '{name}'")
    return getattr(importlib.import_module(HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
