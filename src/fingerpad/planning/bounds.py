"""Limits: plans that need more than the machine has are refused here, before anything is
allocated.
"""

from __future__ import annotations

import os
import resource
from typing import Any

from fingerpad.scenes.scene import Scene
from fingerpad.specimen.pad import MeshSize

_RECEPTOR_BYTES = 400  # of a receptor and step: what is sampled, kept twice
_PROGRAM_BYTES = 0.9e9  # of addresses that the libraries take before anything is solved


class PlanError(ValueError):
    """The scene asks for a combination that cannot be planned; the message is one line."""


def check_size(scene: Scene, size: MeshSize, rules: Any) -> None:
    """Refuses meshes of more nodes than are allowed, from above and before anything is
    allocated.
    """
    outline = scene.specimen.outline
    fine = (
        scene.specimen.soft_thickness
        if outline is None
        else outline.epidermis_thickness + outline.dermis_thickness
    )
    rows = fine / size.layer_edge + 4
    nodes = 8 * rows * (size.fine_half_width / size.skin_edge + len(size.focus))
    if nodes > rules.most_nodes:
        key = "accuracy.skin_edge" if scene.by_hand.skin_edge else "accuracy"
        least = size.skin_edge * (nodes / rules.most_nodes) ** 0.5
        raise PlanError(
            f"{key}: edges of {micrometres(size.skin_edge)} um make {nodes:.2g} nodes; "
            f"allowed: {rules.most_nodes:g} nodes, edges of about {micrometres(least)} um"
        )


def check_memory(scene: Scene, nodes: int, steps: int, rules: Any) -> None:
    """Refuses what would need more memory than the machine has, or more nodes than are allowed."""
    if nodes > rules.most_nodes:
        raise PlanError(f"accuracy: {nodes} nodes; allowed: {rules.most_nodes:g}")
    (memory, limited), receptors = _memory(), receptors_of(scene)
    needed = {
        "accuracy": nodes * rules.bytes_node,
        "accuracy.steps" if scene.by_hand.steps else "motion": nodes * steps * rules.bytes_step,
        "outputs.receptors": receptors * (steps + 1) * _RECEPTOR_BYTES,
    }
    total, most = sum(needed.values()), rules.most_memory * memory
    if total > most:
        raise PlanError(
            f"{max(needed, key=needed.get)}: {nodes} nodes, {steps} steps and {receptors} "
            f"receptors need about {total / 1e9:.2g} GB of memory; "
            f"allowed: {most / 1e9:.2g} GB on this machine{limited}"
        )


def _memory() -> tuple[float, str]:
    """Bytes of memory that a run can have: the machine's, or what is left of a limit on addresses,
    and words for such a limit.
    """
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    if limit == resource.RLIM_INFINITY or limit - _PROGRAM_BYTES >= machine:
        return machine, ""
    said = f", where a limit leaves {limit / 1e9:.2g} GB to all of the program (ulimit -v)"
    return max(limit - _PROGRAM_BYTES, 0.0), said


def receptors_of(scene: Scene) -> int:
    """How many receptor points a scene asks for."""
    return len(scene.outputs.receptors.depths) * len(scene.outputs.receptors.offsets)


def micrometres(length: float) -> str:
    return f"{length * 1e6:.3g}"


def percent(error: float) -> str:
    return f"{100 * error:.2g} %" if error < 0.995 else "more than 100 %"
