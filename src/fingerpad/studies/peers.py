"""The same elastic press through FElupe, a public finite element package, and through this one: answers and cost side by side.

Same mesh, same linear quads with one pressure an element, same law (neo-Hooke with U = kappa/2 (J - 1)^2, three-field) in one
homogeneous pad, plane strain, a flat rigid press without friction. Contact is found by this package; FElupe is given the nodes
that touch and puts them on the plate, free to move along it, so both solve the same discrete problem, and the nodes' pushes tell
whether contact is the same.
FElupe is an optional dependency: ``pip install -e .[peers]``.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from fingerpad.planning.plan import plan
from fingerpad.simulation import Simulation
from fingerpad.specimen import mesh_for
from fingerpad.specimen.materials import Prony, moduli
from fingerpad.studies.accuracy.meshes import quarters
from fingerpad.studies.stability.hard_cases import FLAT, depth, scene_of

INCREMENTS = (1, 2, 4, 8, 16, 32)
"""Load increments tried with the peer until its Newton iterations converge."""


@dataclass(frozen=True)
class Answer:
    """Force N/m (positive: compression), largest displacement m, strain energy J/m, process time s, iterations, increments."""

    force: float
    displacement: float
    energy: float
    seconds: float
    iterations: int
    increments: int


def press(millimetres: float, accuracy: str = "draft"):
    """Scene, plan and mesh of linear quads of a pad pressed by a plate, long-term moduli, finite strain, the whole pad."""
    effects = {"finite_strain": "on", "symmetry": "off"}
    scene = scene_of(
        {
            "accuracy": accuracy,
            "stimulus": FLAT,
            "motion": [depth(millimetres)],
            "effects": effects,
            "specimen": {"layers": "homogeneous"},
        },
        "press",
    )
    chosen = plan(scene)
    mesh = quarters(mesh_for(scene, chosen))
    return scene, replace(chosen, element="Q1P0", steps_per_leg=1), mesh


def ours(scene, chosen, mesh) -> tuple[Answer, Simulation]:
    """The press by this package, in one step."""
    with threadpool_limits(1):
        simulation = Simulation(scene, chosen, mesh)
        stepper, body = simulation.stepper, simulation.body
        start = time.process_time()
        (record,) = stepper.run(simulation.steps())
        seconds = time.process_time() - start
    largest = float(np.linalg.norm(body.u, axis=1).max())
    return Answer(record.force, largest, record.energies[0], seconds, record.iterations, 1), simulation


def theirs(scene, mesh, simulation: Simulation, increments: int) -> tuple[Answer, np.ndarray]:
    """The same press by FElupe with its default solver; also the pushes of the touching nodes, N/m.

    Raises:
        ValueError: its iterations do not converge.
    """
    import felupe

    with threadpool_limits(1):
        start = time.process_time()
        layer = scene.specimen.layers.fat
        known = moduli(layer.youngs_modulus, layer.poisson_ratio, Prony(), "long_term")
        body_mesh = felupe.Mesh(mesh.points, mesh.cells, "quad")
        field = felupe.FieldsMixed(felupe.RegionQuad(body_mesh), n=3, planestrain=True)
        material = felupe.NeoHooke(mu=float(known.shear_long_term), bulk=float(known.bulk))
        solid = felupe.SolidBody(felupe.ThreeFieldVariation(material), field)
        held = np.unique(np.concatenate([mesh.curves[name].ravel() for name in ("bone", "nail")]))
        nodes = simulation.skin.nodes[simulation.stepper.active]
        down = simulation.body.u[nodes, 1]  # they lie on the plate; along it they are free
        fixed = felupe.Boundary(field[0], mask=np.isin(np.arange(len(mesh.points)), held))
        plate = felupe.Boundary(field[0], mask=np.isin(np.arange(len(mesh.points)), nodes), skip=(1, 0))
        order = np.argsort(nodes)
        iterations = 0
        for k in range(1, increments + 1):
            plate.value = down[order] * k / increments
            bounds = {"fixed": fixed, "plate": plate}
            dof0, dof1 = felupe.dof.partition(field, bounds)
            ext0 = felupe.dof.apply(field, bounds, dof0)
            done = felupe.newtonrhapson(items=[solid], dof0=dof0, dof1=dof1, ext0=ext0, verbose=0)
            iterations += done.iterations
        seconds = time.process_time() - start
    pushes = -np.asarray(done.fun.todense() if hasattr(done.fun, "todense") else done.fun).ravel()[: 2 * len(mesh.points)]
    pushes = pushes.reshape(-1, 2)[nodes, 1]
    displacement = field[0].values
    gradient, _, dilatation = field.extract()
    volumetric = (dilatation / np.linalg.det(gradient.T).T) ** (1 / 3)
    energy = float((material.function([volumetric * gradient, None])[0] * field.region.dV).sum())
    return Answer(
        float(pushes.sum()), float(np.linalg.norm(displacement[:, :2], axis=1).max()), energy, seconds, iterations, increments
    ), pushes


def study(depths: tuple[float, ...] = (0.3, 1.0), repeats: int = 5) -> pd.DataFrame:
    """Presses of some depths (mm) by both packages: one row a press and package.

    Costs are process times of the solution alone, medians of ``repeats``; differences and cost ratios are to this package.
    """
    import felupe

    rows = []
    for millimetres in depths:
        scene, chosen, mesh = press(millimetres)
        runs = [ours(scene, chosen, mesh) for _ in range(repeats)]
        answer, simulation = _median(runs)
        nodes = {"press (mm)": millimetres, "nodes": len(mesh.points)}
        rows.append(nodes | {"package": "fingerpad"} | _row(answer, answer, repeats) | {"least push (N/m)": np.nan})
        found = [converged(scene, mesh, simulation) for _ in range(repeats)]
        other, pushes = _median(found)
        package = f"FElupe {felupe.__version__}"
        rows.append(nodes | {"package": package} | _row(other, answer, repeats) | {"least push (N/m)": float(pushes.min())})
    return pd.DataFrame(rows)


def converged(scene, mesh, simulation) -> tuple[Answer, np.ndarray]:
    """The peer's press in as few load increments as its iterations need.

    Raises:
        ValueError: none of :data:`INCREMENTS` is enough.
    """
    for increments in INCREMENTS:
        try:
            return theirs(scene, mesh, simulation, increments)
        except ValueError:
            if increments == INCREMENTS[-1]:
                raise


def _median(runs: list[tuple[Answer, Any]]) -> tuple[Answer, Any]:
    """The run of median cost; they answer alike."""
    return sorted(runs, key=lambda run: run[0].seconds)[len(runs) // 2]


def _row(answer: Answer, reference: Answer, repeats: int) -> dict[str, float]:
    return {
        "force (N/m)": answer.force,
        "largest displacement (mm)": 1e3 * answer.displacement,
        "strain energy (mJ/m)": 1e3 * answer.energy,
        "force off (1)": abs(answer.force / reference.force - 1),
        "displacement off (1)": abs(answer.displacement / reference.displacement - 1),
        "energy off (1)": abs(answer.energy / reference.energy - 1),
        "cost (s)": answer.seconds,
        "cost ratio (1)": answer.seconds / reference.seconds,
        "iterations": answer.iterations,
        "increments": answer.increments,
        "repeats": repeats,
    }
