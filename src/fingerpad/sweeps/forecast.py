"""What a sweep will cost: every scene planned, nothing solved; and its scenes in batches of about
equal cost.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from fingerpad.documents import SceneError
from fingerpad.planning.rules import RULES
from fingerpad.sweeps.design import Design

SECONDS_PROCESS = 6.0
"""Of one reference core, before the first scene of a process: imports and kernels (see
benchmarks).
"""
SECONDS_SCENE = 0.22
"""Of each scene beside its solution: mesh, history, measures, record (see benchmarks)."""
MEMORY_MB = 400.0
"""Of a process before its first scene."""
RECORD_BYTES = 3000.0
"""Of each scene on the disk: in todo, records, dataset and table."""
BATCH_S = 60.0
"""What a batch should cost at least; a sweep that has fewer of these than cores is divided further,
down to LEAST_S.
"""
LEAST_S = 8.0
MOST_BATCHES = 1000
"""Of a sweep: schedulers and Snakemake are slow with more."""


@dataclass
class Forecast:
    """What scenes will cost.

    Attributes:
        cost_s: of each scene, s of one core. memory_MB, result_bytes: of each. effects: name -> in
        how many scenes it is on. worst_error: the largest that is expected.
    """

    cost_s: list[float] = field(default_factory=list)
    memory_MB: list[float] = field(default_factory=list)
    result_bytes: list[float] = field(default_factory=list)
    effects: Counter[str] = field(default_factory=Counter)
    nodes: tuple[int, int] = (0, 0)
    worst_error: float = 0.0

    def wall_s(self, cores: int, numbers: Iterable[int] | None = None) -> float:
        """Time (s) on some cores, of these scenes or of all."""
        costs = self.cost_s if numbers is None else [self.cost_s[n] for n in numbers]
        if not costs:
            return 0.0
        batches = divided(list(range(len(costs))), costs, cores)
        each = [SECONDS_PROCESS + sum(costs[n] for n in batch) for batch in batches]
        return max(sum(each) / cores, max(each))


def forecast(design: Design, progress: Callable[[int], object] | None = None) -> Forecast:
    """Plan every scene. Raises SceneError, one line, for a scene that cannot be planned."""
    from fingerpad.planning.bounds import PlanError
    from fingerpad.planning.plan import plan
    from fingerpad.specimen.outline import OutlineError
    from fingerpad.specimen.pad import MeshError

    found = Forecast()
    nodes = []
    for number, scene in enumerate(design):
        try:
            how = plan(scene)
        except (PlanError, OutlineError, MeshError) as error:
            raise SceneError(
                f"{design.shown}: scene {number} ({design.said(number)}): {design.without_name(error)}"
            ) from None
        found.cost_s.append(SECONDS_SCENE + how.predicted_cost_s - RULES.seconds_start)
        found.memory_MB.append(
            MEMORY_MB + 1e-6 * how.nodes * (RULES.bytes_node + RULES.bytes_step * how.steps)
        )
        found.result_bytes.append(
            RECORD_BYTES + (how.result_bytes(scene) if design.read.sweep.histories else 0.0)
        )
        found.effects.update(name for name, effect in how.effects.items() if effect.on)
        found.worst_error = max(found.worst_error, how.estimated_error)
        nodes.append(how.nodes)
        if progress:
            progress(number + 1)
    found.nodes = min(nodes), max(nodes)
    return found


def divided(numbers: list[int], cost_s: list[float], cores: int = 1) -> list[list[int]]:
    """Scenes in batches of about equal cost: a minute or more each, on all cores where that leaves
    LEAST_S a batch.

    Args:
        numbers: of the scenes to be run, rising. cost_s: of every scene of the sweep.
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
