"""What a sweep will cost: every scene planned, nothing solved; and batches of about equal cost."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import pandas as pd

from fingerpad.planning.bounds import PlanError
from fingerpad.planning.plan import plan
from fingerpad.planning.rules import RULES
from fingerpad.specimen.outline import OutlineError
from fingerpad.specimen.pad import MeshError
from fingerpad.sweeps.design import Design

SECONDS_PROCESS = 6.0
"""Before the first scene of a process: imports and kernels (see benchmarks)."""
SECONDS_SCENE = 0.22
"""Of each scene beside its solution: mesh, history, measures, record (see benchmarks)."""
MEMORY_MB = 400.0
"""Of a process before its first scene."""
RECORD_BYTES = 3000.0
"""Of each scene on the disk: in todo, records, dataset and table."""
BATCH_S = 60.0
"""Least cost of a batch, where every core has one."""
LEAST_S = 8.0
"""Least cost of a batch, where there are fewer batches than cores."""
MOST_BATCHES = 1000
"""Of a sweep: schedulers and Snakemake are slow with more."""


@dataclass
class Forecast:
    """What scenes will cost.

    Attributes
    ----------
    scenes : DataFrame
        A row a scene: ``cost_s`` of one core, ``memory_MB``, ``result_bytes``, ``nodes`` of its
        mesh, and its expected ``error``.
    effects : Counter
        Name -> number of scenes with the effect on.
    """

    scenes: pd.DataFrame
    effects: Counter[str]

    def wall_s(self, cores: int) -> float:
        """Time (s) of all scenes on some cores."""
        cost_s = self.scenes.cost_s.tolist()
        batches = divided(list(range(len(cost_s))), cost_s, cores)
        costs = [SECONDS_PROCESS + sum(cost_s[n] for n in batch) for batch in batches]
        return max(sum(costs) / cores, max(costs))


def forecast(design: Design, progress: Callable[..., object] | None = None) -> Forecast:
    """Plan every scene.

    Parameters
    ----------
    design : Design
        The scenes.
    progress : callable, optional
        Called with ``completed``, the number of scenes that are planned.

    Raises
    ------
    SceneError
        A scene cannot be planned; one line.
    """
    scenes, effects = [], Counter[str]()
    for number, scene in enumerate(design):
        try:
            chosen = plan(scene)
        except (PlanError, OutlineError, MeshError) as error:
            raise design.error(number, error) from None
        history = chosen.result_bytes(scene) if design.read.sweep.histories else 0.0
        solved = chosen.nodes * (RULES.bytes_node + RULES.bytes_step * chosen.steps)
        scenes.append(
            {
                "cost_s": SECONDS_SCENE + chosen.predicted_cost_s - RULES.seconds_start,
                "memory_MB": MEMORY_MB + 1e-6 * solved,
                "result_bytes": RECORD_BYTES + history,
                "nodes": chosen.nodes,
                "error": chosen.estimated_error,
            }
        )
        effects.update(name for name, effect in chosen.effects.items() if effect.on)
        if progress:
            progress(completed=number + 1)
    return Forecast(pd.DataFrame(scenes), effects)


def divided(numbers: list[int], cost_s: list[float], cores: int = 1) -> list[list[int]]:
    """Scenes in batches of about equal cost.

    A batch costs `BATCH_S` or more; where that makes fewer batches than cores, `LEAST_S` or more.

    Parameters
    ----------
    numbers : list of int
        The scenes to be run, rising.
    cost_s : list of float
        Of every scene of the sweep.
    cores : int
        Processes at a time.
    """
    if not numbers:
        return []
    total = sum(cost_s[n] for n in numbers)
    count = min(max(total / BATCH_S, 1.0), MOST_BATCHES)
    count = min(math.ceil(count / cores) * cores, max(int(total / LEAST_S), 1), len(numbers))
    batches: list[list[int]] = [[]]
    spent = 0.0
    for n in numbers:
        if spent >= total / count * (1 - 1e-9):
            batches.append([])
            spent = 0.0
        batches[-1].append(n)
        spent += cost_s[n]
    return batches
