"""What a plan holds, how it is shown, and how it is written and read."""

from __future__ import annotations

import html
import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter
from rich.console import Console, Group
from rich.table import Table
from rich.text import Text

from fingerpad.files import write_text
from fingerpad.planning.bounds import percent, receptors_of
from fingerpad.planning.effect import Effect, Parts
from fingerpad.planning.effects import parts_of
from fingerpad.planning.estimates import ContactEstimate
from fingerpad.planning.relaxed import Relaxed
from fingerpad.planning.schedule import BETWEEN, NEWTON
from fingerpad.planning.surface import Surface
from fingerpad.planning.unbounded import OF_STROKES, Unbounded
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.pad import MeshSize

_OUT_OF_BALANCE = 2e-3  # relative, at most, whatever the mesh
_SKIN_NODES = 6.0  # at most, over the square root of all nodes of the pad
_CHECKED = (
    "which way the skin passes {} may depend on the steps; the run is repeated with steps half as "
    "long, which takes {:.2g} s more"
)
_KEYS = {
    "state": "moduli_state",
    "contact": "contact_estimate_SI",
    "mesh_size": "mesh_size_SI",
    "smallest_edge": "smallest_edge_SI",
    "contact_edge": "contact_edge_SI",
    "slide_step": "slide_step_SI",
    "surface": "surface_SI",
    "errors": "errors_by_quantity",
}
"""Fields whose key in plan.json is another one."""
_DISCRETISATION = ("element", "nodes", "steps", "outputs")
"""Fields that plan.json has under ``discretisation``."""


@dataclass(frozen=True)
class Plan:
    """Everything decided about a scene before it is solved.

    Attributes
    ----------
    effects
        Name -> whether it is on, and why.
    state
        Moduli used where time is left out: "long_term" or "instantaneous".
    element
        Key of the element.
    mesh_size
        Of a built mesh; None for an external one.
    contact
        The estimate behind the choices.
    steps_per_leg
        Time steps or load increments of each leg.
    slide_step
        m, longest step of a slide; None where steps are given by hand.
    steps
        All steps; of strokes, whose error chooses them, as many as are expected.
    timed
        Whether time matters.
    nodes, smallest_edge
        Of the mesh that is solved on; the edge in m.
    inertia_ratio
        rho v^2 / mu, which is neglected.
    contact_edge
        m, edge of the skin under the apex.
    estimated_error
        Relative, of the quantities that ``covers`` names.
    predicted_cost_s
        s of one core.
    small_strain_error
        The part of the error that effects left out are to blame for.
    least_error
        The error is at least this because of the profile's edges, its tip or the elements at
        receptors.
    error_from
        What most of the error comes from.
    asked_error
        The tolerance; None where none is asked for.
    once
        Whether the tolerance is tried for once only.
    unbounded
        Where contact is expected at which pressure has no bound, so that a peak is the mesh's.
    specimen
        Sentences on what is touched, and what of it the scene left out.
    surface
        What the mesh makes of a measured profile.
    stride
        So many steps are made one.
    strokes
        Whether the pad moves along the surface, so that errors are of a way.
    outputs
        How many the history has.
    every
        Of so many outputs of presses and holds a state is solved at one.
    unresolved_edge
        Whether edges are rounded, but finer than the mesh can tell.
    errors
        On an external mesh, by quantity.
    receptor_height
        On an external mesh the largest height of elements that receptors are in, over their depth.
    relaxed
        What a run in trouble has relaxed of it.
    checked
        Whether a run in which the skin meets a corner is compared with one whose steps are
        half as long.
    """

    effects: dict[str, Effect]
    state: str
    element: str
    mesh_size: MeshSize | None
    contact: ContactEstimate
    steps_per_leg: int
    slide_step: float | None
    steps: int
    timed: bool
    nodes: int
    smallest_edge: float
    inertia_ratio: float
    contact_edge: float
    estimated_error: float
    predicted_cost_s: float
    small_strain_error: float = 0.0
    least_error: float = 0.0
    error_from: str = ""
    asked_error: float | None = None
    once: bool = False
    unbounded: Unbounded = Unbounded()
    specimen: tuple[str, ...] = ()
    surface: Surface = Surface()
    stride: int = 1
    strokes: bool = False
    outputs: int = 0
    every: int = 1
    unresolved_edge: bool = False
    errors: dict[str, float] = field(default_factory=dict)
    receptor_height: float | None = None
    relaxed: Relaxed = Relaxed()
    checked: bool = False

    def parts(self, scene: Scene) -> Parts:
        """What the effects that are on make of the parts of a simulation of ``scene``."""
        return parts_of(scene, self.effects)

    @property
    def covers(self) -> str:
        """The quantities that the error is of."""
        return self.unbounded.covers + self.strokes * OF_STROKES

    def missed(self, error: float | None = None) -> str | None:
        """What to say where ``error`` (default: the expected one) exceeds the tolerance; None where
        it does not.
        """
        planned = error is None
        error = self.estimated_error if planned else error
        if self.asked_error is None or error <= self.asked_error * (1 + 1e-9):
            return None
        had = "cannot be reached: expected" if planned else "got"
        return f"asked {percent(self.asked_error)}, {had} {percent(error)}: {self.error_from}"

    def result_bytes(self, scene: Scene, fields: bool = False) -> float:
        """Bytes that the files of a run of ``scene`` will take at most, roughly; ``fields``: with
        those for ParaView.
        """
        nodes = self.nodes * (2 if self.parts(scene).half else 1)
        each_time = 8 * (20 + 7 * _SKIN_NODES * nodes**0.5 + 13 * receptors_of(scene))
        snapshots = len(scene.outputs.snapshots) or int(fields)
        return (
            3e5 + (self.outputs + 1) * each_time + (snapshots + 1) * nodes * (200 if fields else 40)
        )

    @property
    def stepping(self) -> tuple[int, bool, float | None, int, int, int]:
        """What :func:`schedule` needs to know: steps of a leg, does time matter, longest step of a
        slide (m), stride, every, pieces of an increment.
        """
        steps = self.steps_per_leg, self.timed, self.slide_step, self.stride, self.every
        return (*steps, self.relaxed.pieces)

    @property
    def states_per_leg(self) -> float:
        """As many steps of a leg as its time error is of."""
        return self.steps_per_leg / (self.stride * self.every)

    @property
    def between(self) -> tuple[float, float] | None:
        """Of a stroke: the longest way (m) between two states, and by how much of the pressure what
        lies between may be off.

        The latter is the mesh's, whatever the stride: twice as much hides bumps that bear little of
        the load.
        """
        return (
            (self.slide_step * self.stride, BETWEEN * self.contact_edge)
            if self.strokes and self.slide_step
            else None
        )

    @property
    def newton_tolerance(self) -> float | None:
        """Force out of balance, over that of the contact, that a stroke leaves: as good as its mesh
        is; None: the usual one.
        """
        return min(NEWTON * self.contact_edge, _OUT_OF_BALANCE) if self.between else None

    @property
    def discretisation(self) -> dict[str, Any]:
        """Element, nodes, smallest edge and steps, as printed and as written to plan.json."""
        out = {
            "element": self.element,
            "nodes": self.nodes,
            "smallest_edge_um": round(self.smallest_edge * 1e6, 3),
            "steps": self.steps,
            "outputs": self.outputs,
        }
        if self.mesh_size is not None:
            out |= {
                "contact_edge_um": round(self.contact_edge * 1e6, 3),
                "skin_edge_um": round(self.mesh_size.skin_edge * 1e6, 3),
                "fine_half_width_mm": round(self.mesh_size.fine_half_width * 1e3, 3),
            }
        if self.surface.smoothing:
            out["profile_smoothed_um"] = round(self.surface.smoothing * 1e6, 3)
            out["profile_moved_um"] = round(self.surface.moved * 1e6, 3)
        return out

    def to_dict(self) -> dict[str, Any]:
        """JSON-able description (plan.json); :func:`read_plan` reads it back."""
        plain = {
            _KEYS.get(name, name): value
            for name, value in asdict(self).items()
            if name not in ("effects", "unbounded", *_DISCRETISATION)
        }
        return {
            "effects": {name: asdict(effect) for name, effect in self.effects.items()},
            "discretisation": self.discretisation,
            **plain,
            "predicted_cost_s": round(self.predicted_cost_s, 2),
            "error_covers": self.covers,
            "tolerance_met": None if self.asked_error is None else self.missed() is None,
            "unbounded_peak": bool(self.unbounded),
            "unbounded_at": self.unbounded.places,
            "unbounded_at_centre": self.unbounded.centre,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Plan:
        """The plan of which :meth:`to_dict` is the description."""
        unbounded = {"places": data["unbounded_at"], "centre": data["unbounded_at_centre"]}
        known = {**data, **data["discretisation"], "unbounded": unbounded}
        keys = {each.name: _KEYS.get(each.name, each.name) for each in fields(cls)}
        return _PLAN.validate_python(
            {name: known[key] for name, key in keys.items() if key in known}
        )

    def write(self, path: str | Path) -> None:
        """Write plan.json, whole or not at all."""
        write_text(path, json.dumps(self.to_dict(), indent=2) + "\n")

    def shown(self, title: str | None = None) -> Group:
        """The plan as tables and lines, for a console of rich."""
        effects = Table("effect", "", "why", title=title, title_justify="left")
        for name, effect in self.effects.items():
            state = Text("on", style="bold green") if effect.on else Text("off", style="dim")
            effects.add_row(Text(name.replace("_", " ")), state, Text(effect.why))
        details = Table("discretisation", "")
        for name, value in self.discretisation.items():
            said = f"{value:.4g}" if isinstance(value, float) else str(value)
            details.add_row(Text(name.replace("_", " ")), Text(said))
        whole = [
            Text(f"specimen: {line}", no_wrap=True, overflow="ignore") for line in self.specimen
        ]
        lines = [f"expected error: {percent(self.estimated_error)} ({self.covers})"]
        if self.errors:
            errors = (f"{name} {percent(error)}" for name, error in self.errors.items())
            lines.append(f"by quantity: {', '.join(errors)}")
        if self.missed():
            lines.append(self.missed())
        lines += [f"note: {note}" for note in self.surface.notes]
        lines += [f"relaxed: {said}" for said in self.relaxed.said]
        if self.checked and self.unbounded:
            lines.append(
                f"checked: {_CHECKED.format(self.unbounded.text, 2 * self.predicted_cost_s)}"
            )
        lines.append(f"predicted cost: {self.predicted_cost_s:.2g} s of one core")
        return Group(effects, details, *whole, *map(Text, lines))

    def __repr__(self) -> str:
        on = [name for name, effect in self.effects.items() if effect.on]
        return (
            f"Plan(effects on: {', '.join(on) or 'none'}; {self.element}, {self.nodes} nodes, "
            f"{self.steps} steps; expected error {percent(self.estimated_error)}, "
            f"{self.predicted_cost_s:.2g} s of one core)"
        )

    def __str__(self) -> str:
        page = io.StringIO()
        Console(file=page, width=100, color_system=None).print(self.shown(), crop=False)
        return page.getvalue()

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{name}</td><td>{'on' if effect.on else 'off'}</td>"
            f"<td>{html.escape(effect.why)}</td></tr>"
            for name, effect in self.effects.items()
        )
        return (
            f"<table>{rows}</table><p>{self.element}, {self.nodes} nodes, {self.steps} steps; "
            f"expected error {percent(self.estimated_error)}; "
            f"{self.predicted_cost_s:.2g} s of one core</p>"
        )


_PLAN = TypeAdapter(Plan)


def read_plan(path: str | Path) -> Plan:
    """Read a plan.

    Parameters
    ----------
    path
        A plan.json, as :meth:`Plan.write` or ``fingerpad run`` writes it, or the folder of a run.
    """
    file = Path(path) / "plan.json" if Path(path).is_dir() else Path(path)
    return Plan.from_dict(json.loads(file.read_text(encoding="utf-8")))
