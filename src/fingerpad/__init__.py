"""The human fingerpad in touch: skin, contact and the strain energy that receptors see.

Five functions do the work:

- ``load_scene(path)``: read and check a scene, a file or a dictionary; it gives a ``Scene``.
  ``plan``, ``simulate`` and ``sweep`` take the file or the dictionary too.
- ``plan(scene)``: choose effects and discretisation, with reasons; it gives a ``Plan``.
- ``simulate(scene)``: run it; it gives the history, an `xarray.Dataset`.
- ``sweep(scene, over)``: many variations of it, as one `xarray.Dataset`.
- ``respond(history)``: impulse rates and impulses of its receptors.

``emulate(folder)`` fits an emulator to a sweep, which answers a scene in milliseconds; ``grow``
adds scenes to the sweep until it is good enough, and ``load_emulator(file)`` reads one.
``read_history`` and ``read_plan`` read what was written; ``write_history`` writes a history and
``summary`` sums it up. ``history.fingerpad`` is the accessor of a history. The errors to catch are
here too. Each name is imported at its first use.
"""

from __future__ import annotations

import importlib

HOMES = {
    "Emulator": "fingerpad.emulator.model",
    "MeshError": "fingerpad.specimen.pad",
    "NonConvergence": "fingerpad.mechanics.stepping",
    "NotFinished": "fingerpad.sweeps.engine",
    "OutlineError": "fingerpad.specimen.outline",
    "Plan": "fingerpad.planning.plan",
    "PlanError": "fingerpad.planning.plan",
    "ReceptorError": "fingerpad.receptors.recovery",
    "ResultError": "fingerpad.results",
    "Scene": "fingerpad.scenes.scene",
    "SceneError": "fingerpad.documents",
    "SweepError": "fingerpad.sweeps.engine",
    "emulate": "fingerpad.emulator.fitting",
    "grow": "fingerpad.emulator.growing",
    "load_emulator": "fingerpad.emulator.model",
    "load_scene": "fingerpad.scenes.scene",
    "plan": "fingerpad.planning.plan",
    "read_history": "fingerpad.results",
    "read_plan": "fingerpad.planning.plan",
    "respond": "fingerpad.receptors.respond",
    "simulate": "fingerpad.healing",
    "summary": "fingerpad.results",
    "sweep": "fingerpad.sweeps.engine",
    "write_history": "fingerpad.results",
}
"""Public name -> module it is in; type checkers read the same in ``__init__.pyi``."""

__all__ = list(HOMES)


def __getattr__(name: str) -> object:
    if name == "__version__":
        return importlib.import_module("importlib.metadata").version("fingerpad")
    if name not in HOMES:
        raise AttributeError(f"module 'fingerpad' has no attribute '{name}'")
    return getattr(importlib.import_module(HOMES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
