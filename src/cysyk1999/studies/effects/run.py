"""What each effect changes in the answers and what it costs; and whether the planner's choices bear
it out.

An effect is simulated with and without it on the same mesh, so what differs is its own.
:func:`study` does so on scenes where it matters and where it does not, :func:`verdicts` on scenes
drawn at random, for every choice that the planner made.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.stability.hard_cases import (
    FLAT,
    RAMP,
    TWO_WAVES,
    cylinder,
    depth,
    force,
    hold,
    scene_of,
    slide,
)
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.effect import OWN_PAIR
from fingerpad.planning.effects import EFFECTS
from fingerpad.planning.plan import RULES, Plan, PlanError, Rules, plan
from fingerpad.scenes.scene import Scene
from fingerpad.simulation import simulate

ANSWERS = {
    "indentation_depth": "depth",
    "force": "force",
    "contact_width": "width",
    "centre_pressure": "centre pressure",
    "strain_energy_density": "strain energy",
    "tangential_force": "tangential force",
    "centre_lateral_displacement": "lateral displacement",
}
"""The headline quantities by which a change is told, as the history and as people call them."""
SLIDES_ONLY = ("tangential_force", "centre_lateral_displacement")
KNOWN_SAFE = 0.1
"""An effect worth less than this share of the accuracy need not be carried where leaving it out is
known to be safe.
"""
SEEDS, SCENES = (31, 404, 505), 40
"""Scenes drawn of each seed. Seeds 1999, 20261121, 7, 2026 and 31 have set the planner's rules: the
others are unseen.
"""
RIDGED = 6
"""One press in so many has ridges."""
FLATTENED = 1e-8
"""m, height of ridges that change nothing."""
MOST_NODES = 6000
"""On larger meshes local refinement is not tried."""


# -- what an effect changes ---------------------------------------------------------------------------------------------------


def changes(one: xr.Dataset, other: xr.Dataset) -> dict[str, float]:
    """Largest change of each headline quantity, over its largest value in ``one``.

    Legs of as many steps in both are compared step by step, others at their ends.
    """
    at, other_at = [], []
    for leg in np.unique(one.leg.values[1:]):
        here, there = (
            1 + np.flatnonzero(history.leg.values[1:] == leg) for history in (one, other)
        )
        if len(here) != len(there):
            here, there = here[-1:], there[-1:]
        at.append(here)
        other_at.append(there)
    at, other_at = np.concatenate(at), np.concatenate(other_at)
    out = {}
    for name, text in ANSWERS.items():
        if name in SLIDES_ONLY and not np.ptp(one.stroke_distance.values):
            continue
        a, b = one[name].values[at], other[name].values[other_at]
        scale = np.abs(one.force.values).max() if name == "tangential_force" else np.abs(a).max()
        if name == "centre_lateral_displacement":
            scale = max(scale, np.abs(one.indentation_depth.values).max())
        out[text] = float(np.abs(a - b).max() / max(scale, 1e-300))
    return out


def with_effects(chosen: Plan, state: str | None = None, **switched: bool) -> Plan:
    """A plan with effects switched, and the ``state`` of the moduli where viscosity is left out."""
    effects = {
        name: replace(effect, on=switched.get(name, effect.on))
        for name, effect in chosen.effects.items()
    }
    timed = effects["viscoelasticity"].on
    return replace(
        chosen, effects=effects, timed=timed, state="long_term" if timed else state or chosen.state
    )


# -- on scenes where it matters and where it does not -------------------------------------------------------------------------


@dataclass(frozen=True)
class Pair:
    """An effect on a scene: the plans with and without it, and what is said of them."""

    effect: str
    label: str
    matters: bool
    document: Mapping[str, Any]
    switch: Callable[[Scene, bool], tuple[Scene, Plan]]


def _switched(effect: str, state: str = "long_term"):
    def switch(scene: Scene, on: bool) -> tuple[Scene, Plan]:
        return scene, with_effects(plan(scene), state, **{effect: on})

    return switch


def flattened(scene: Scene) -> Scene:
    """A scene whose inner ridges are next to nothing, on a mesh that could resolve them."""
    return scene.varied({"specimen.ridges.inner.height": FLATTENED})


def _focused(scene: Scene, on: bool) -> tuple[Scene, Plan]:
    chosen = replace(plan(scene), once=True)
    size = chosen.mesh_size
    if not on:
        size = replace(size, focus=(), skin_radial_edge=None)
    elif not size.focus:
        size = replace(size, focus=((0.0, chosen.contact.half_width / RULES.edges_per_half_width),))
    return scene, replace(chosen, mesh_size=size)


def _fields(scene: Scene, on: bool) -> tuple[Scene, Plan]:
    if not on:
        scene = scene.varied({"outputs.snapshots": ()})
    return scene, plan(scene)


MIDDLE = cylinder(209.97)
BESIDE = (
    Pair(
        "local refinement",
        "needle, 10,000 1/m",
        True,
        {"stimulus": cylinder(1e4), "motion": RAMP},
        _focused,
    ),
    Pair("local refinement", "210 1/m", False, {"stimulus": MIDDLE, "motion": RAMP}, _focused),
    Pair(
        "full-field output",
        "at 2 times",
        False,
        {"stimulus": MIDDLE, "motion": RAMP, "outputs": {"snapshots": ["0.5 s", "2.5 s"]}},
        _fields,
    ),
    Pair(
        "full-field output",
        "every 0.05 s",
        False,
        {"stimulus": MIDDLE, "motion": RAMP, "outputs": {"snapshots": {"every": "0.05 s"}}},
        _fields,
    ),
)
"""What is not an effect of the planner, but costs like one."""


def pairs() -> tuple[Pair, ...]:
    """What shows the effects that are registered when this is asked, and what is :data:`BESIDE`
    them.
    """
    own = (
        Pair(name, shown.label, shown.matters, shown.document, _switched(name, shown.state))
        for name, effect in EFFECTS.items()
        for shown in effect.shown
    )
    return (*own, *BESIDE)


def study(shown: Iterable[Pair] | None = None, repeats: int = 11) -> pd.DataFrame:
    """Changes and cost ratios of every pair, or of some: a row each; costs: process times, medians
    of ``repeats`` in turn after one that is not counted, the ratio that of the ratios of each turn.

    What ridges change is told on a mesh that has them, where they are flattened; what they cost,
    beside the smooth pad's mesh.
    """
    rows = []
    for pair in pairs() if shown is None else shown:
        scene = scene_of({"accuracy": "draft", **pair.document}, pair.label)
        ways = [pair.switch(scene, on) for on in (True, False)]
        seconds = [[], []]
        for _ in range(1 + repeats):
            histories = [simulate(*way) for way in ways]
            for history, taken in zip(histories, seconds, strict=True):
                taken.append(cost_of(history)["cpu_s"])
        found = changes(
            histories[0],
            simulate(flattened(scene), ways[0][1]) if pair.effect == "ridges" else histories[1],
        )
        seconds = [taken[1:] for taken in seconds]
        with_it, without = map(statistics.median, seconds)
        ratio = statistics.median(one / other for one, other in zip(*seconds, strict=True))
        worst = max(found, key=found.get)
        unknowns = [cost_of(history)["unknowns"] for history in histories]
        rows.append(
            {
                "effect": pair.effect,
                "scene": pair.label,
                "expected to matter": pair.matters,
                "planned": planned(pair.effect, scene),
                "change": found[worst],
                "of": worst,
                "cost ratio": ratio,
                "with (s)": with_it,
                "without (s)": without,
                "unknowns with": unknowns[0],
                "unknowns without": unknowns[1],
                "repeats": repeats,
            }
            | {f"change of {name}": value for name, value in found.items()}
        )
        print(pair.effect, pair.label, f"{found[worst]:.2g} ({worst})", f"{ratio:.2f}", flush=True)
    return pd.DataFrame(rows)


def cost_of(history: xr.Dataset) -> dict[str, Any]:
    """What the run of a history took."""
    return json.loads(history.attrs["cost"])


def planned(effect: str, scene: Scene) -> bool:
    """Does the planner switch the effect on for this scene?"""
    chosen = plan(scene)
    special = {
        "local refinement": lambda: bool(chosen.mesh_size.focus),
        "full-field output": lambda: bool(scene.outputs.snapshots),
    }
    return special.get(effect, lambda: chosen.effects[effect].on)()


# -- on scenes drawn at random ------------------------------------------------------------------------------------------------


def generated(count: int = SCENES, seed: int = SEEDS[0]) -> Iterator[Scene]:
    """Scenes across the planner's thresholds: presses and strokes, forces over three decades, times
    over six, six accuracies.

    Some presses are of pads with inner ridges, of heights over two decades.
    """
    draw = np.random.default_rng(seed)

    def between(low, high):
        return float(np.exp(draw.uniform(np.log(low), np.log(high))))

    def pick(*values):
        return values[draw.integers(len(values))]

    made = 0
    while made < count:
        kind = pick("force", "force", "force", "depth", "stroke")
        stimulus, friction = (
            pick(FLAT, cylinder(between(20, 4000)), cylinder(between(20, 4000))),
            0.0,
        )
        load, seconds = between(0.01, 30), pick(None, *(between(3e-3, 1e4) for _ in range(5)))
        if kind == "depth":
            target = between(5e-3, 1.0)
            motion = [depth(target, None if seconds is None else target / seconds)]
        elif kind == "stroke":
            load, friction = between(2, 25), pick(0.0, between(0.02, 1.0), between(0.02, 1.0))
            stimulus = pick(FLAT, TWO_WAVES, cylinder(between(20, 200)))
            way = (
                {"slide": "3 mm", "keep": "force"}
                if seconds is None
                else slide(3, between(1e-3, 100))
            )
            motion = [force(load, None if seconds is None else load / seconds), way]
        else:
            motion = [force(load, None if seconds is None else load / seconds)]
        if kind != "stroke":
            friction = pick(0.0, 0.0, 0.0, between(0.003, 1.0))
            if seconds is not None and pick(True, False):
                motion.append(hold(between(1e-2, 1e3)))
        share = pick(1.0, 1.0, 0.1, 0.01, 0.0)
        prony = (
            [{"g": share * g, "tau": f"{tau} s"} for g, tau in ((0.055, 3.25), (0.3691, 0.3414))]
            if share
            else "none"
        )
        document = {
            "stimulus": stimulus,
            "motion": motion,
            "friction": friction,
            "accuracy": pick(0.1, 0.05, 0.03, 0.02, 0.01, 0.005),
            "specimen": {"prony": prony},
        }
        if kind != "stroke" and made % RIDGED == 0:
            document["specimen"]["ridges"] = {
                "inner": {"height": f"{between(0.5, 100):.3g} um", "phase": pick("tip", "valley")}
            }
        scene = scene_of(document, f"{kind} {made}")
        try:
            plan(scene)
        except PlanError:
            continue  # so fast that inertia would matter
        made += 1
        yield scene


def verdicts(count: int = SCENES, seeds: Iterable[int] = SEEDS) -> pd.DataFrame:
    """What each effect that the planner chose or left out would have been worth: one row a scene
    and effect.

    The plan is made at the accuracy that the scene asks for; what is simulated is its draft without
    ridges, with the plan's effects and with one of them the other way. Ridges are flattened on a
    mesh that has them, and local refinement is taken away or added on the planned mesh itself.
    "worth" is the largest change of a headline quantity, "share" that over the accuracy.
    """
    rows = []
    for seed, scene in ((number, scene) for number in seeds for scene in generated(count, number)):
        chosen = plan(scene)
        for effect, base, ways in trials(scene, chosen):
            worth, of = _worth(scene, base, ways)
            on = planned(effect, scene)
            dropped = on if effect == "symmetry" else not on
            edge = (
                f"edge {chosen.contact_edge * 1e6:.3g} um, contact "
                f"{chosen.contact.half_width * 1e6:.3g} um to either side"
            )
            rows.append(
                {
                    "seed": seed,
                    "scene": scene.name,
                    "stimulus": scene.stimulus.shape,
                    "accuracy": scene.accuracy,
                    "effect": effect,
                    "planned": "on" if on else "off",
                    "worth": worth,
                    "of": of,
                    "share": worth / scene.accuracy,
                    "verdict": verdict(dropped, worth / scene.accuracy),
                    "why": chosen.effects[effect].why if effect in chosen.effects else edge,
                }
            )
            print(*list(rows[-1].values())[:-1], flush=True)
    return pd.DataFrame(rows)


def trials(
    scene: Scene, chosen: Plan
) -> Iterator[tuple[str, xr.Dataset, list[tuple[Scene, Plan]]]]:
    """Each effect of a plan that can be had either way: its name, what is compared with, and the
    other ways.
    """
    draft = plan(scene.varied({"accuracy": "draft"}))
    draft = replace(draft, effects=chosen.effects, state=chosen.state, timed=chosen.timed)
    smooth, ridged = (with_effects(draft, ridges=on) for on in (False, True))
    base = simulate(scene, smooth)
    for effect, ways in alternatives(scene, smooth).items():
        yield effect, base, [(scene, way) for way in ways]
    if scene.specimen.ridges:
        yield "ridges", simulate(scene, ridged), [(flattened(scene), ridged)]
    coarse = chosen.mesh_size.skin_edge > chosen.contact.half_width / RULES.edges_per_half_width
    if coarse and chosen.nodes < MOST_NODES and not any(leg.strokes for leg in scene.motion):
        on, off = (_focused(scene, on) for on in (True, False))
        yield "local refinement", simulate(*on), [off]


def _worth(scene: Scene, base: xr.Dataset, ways: list[tuple[Scene, Plan]]) -> tuple[float, str]:
    """The change by the best of some ways, and of what; nan where none of them can be solved."""
    found = []
    for way in ways:
        try:
            found.append(_largest(changes(base, simulate(*way))))
        except NonConvergence as failure:
            print(f"{scene.name}: {failure}", flush=True)
    return min(found, default=(np.nan, ""))


def _largest(found: Mapping[str, float]) -> tuple[float, str]:
    return max((value, name) for name, value in found.items())


def alternatives(scene: Scene, draft: Plan) -> dict[str, list[Plan]]:
    """For each effect that can be had either way, the plans with the other choice; the best of them
    counts.

    Symmetry is only taken away: where the planner refuses it, it is not there.
    """
    on = {name: effect.on for name, effect in draft.effects.items()}
    out = {"finite_strain": [with_effects(draft, finite_strain=not on["finite_strain"])]}
    if scene.specimen.prony:
        states = ["long_term", "instantaneous"] if on["viscoelasticity"] else [None]
        out["viscoelasticity"] = [
            with_effects(draft, state, viscoelasticity=not on["viscoelasticity"])
            for state in states
        ]
    if scene.friction:
        out["friction"] = [with_effects(draft, friction=not on["friction"])]
    if on["symmetry"]:
        out["symmetry"] = [with_effects(draft, symmetry=False)]
    return out


def verdict(dropped: bool, share: float) -> str:
    """Of a choice whose effect is worth ``share`` of the accuracy; nan: the other choice could not
    be solved.
    """
    if np.isnan(share):
        return "no other way to compare"
    if dropped:
        return "rightly left out" if share <= 1 else "wrongly left out"
    return "rightly carried" if share >= KNOWN_SAFE else "carried for nothing"


# -- rules and their evidence -------------------------------------------------------------------------------------------------


def evidence(pairs: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Changes and costs on chosen scenes (of :func:`study`), and the planner's choices in drawn
    ones (of :func:`verdicts`).

    One row a chosen scene, then one an effect and choice with the number of drawn scenes and the
    extremes of worth over accuracy.
    """
    chosen = pairs[["effect", "scene", "planned", "change", "of", "cost ratio"]].replace(
        {"planned": {True: "on", False: "off"}}
    )
    rows = []
    for (effect, choice), part in found.dropna(subset="share").groupby(["effect", "planned"]):
        worst = part.loc[part["share"].idxmax()]
        rows.append(
            {
                "effect": effect,
                "scene": f"{len(part)} drawn at random",
                "planned": choice,
                "change": worst["worth"],
                "of": worst["of"],
                "least worth / accuracy": part["share"].min(),
                "largest worth / accuracy": worst["share"],
                "wrongly left out": int((part["verdict"] == "wrongly left out").sum()),
                "carried for nothing": int((part["verdict"] == "carried for nothing").sum()),
            }
        )
    return pd.concat([chosen, pd.DataFrame(rows)], ignore_index=True)


_DECLARED = {
    each.name: each.metadata
    for effect in EFFECTS.values()
    if effect.rules
    for each in fields(effect.rules)
}
DECIDES = {
    **{name: declared["decides"] for name, declared in _DECLARED.items()},
    "presets": "discretisations by name",
    "errors": "mesh and steps for a tolerance, and what a run believes of its error: as measured",
    "mesh_order": "errors of meshes beyond those measured: order in the edge",
    "time_order": "errors of steps beyond those measured: order in the step",
    "edge_share": "error, at least: an edge of the contact is misplaced by this share of an element's edge",
    "stroked": "factor on measured errors of strokes",
    "safety": "factor on measured errors of presses and on that",
    "fillet_error": "error of the peak pressure on a rounded edge, over edge / length of the contact there, to a power",
    "fillet_order": "that power",
    "edge_error": "error under a true edge, over edge / half width of the face",
    "edge_floor": "error under a true edge, at least",
    "edge_finest": "error that a mesh is at most made for there",
    "bumps": "factor on the error of measured profiles",
    "profile_share": "share of a tolerance that the smoothing of a measured profile may use up before a longer one is tried",
    "own": "what meshes of one's own are believed to be wrong by, by element and quantity: as measured",
    "linear_triangle": "by how much coarser quadratic triangles of external meshes count than their edges, on a stroke",
    "linear_quad": "by how much coarser linear quads of external meshes count than their edges, on a stroke",
    "least_edge": "shortest element edge that is made (m)",
    "least_half_width": "contacts narrower to either side are refused (m)",
    "most_nodes": "meshes of more nodes are refused",
    "most_memory": "plans that need more than this share of the machine's memory are refused",
    "bytes_node": "memory of a node",
    "bytes_step": "memory of a node and step",
    "most_runs": "runs of a scene that misses its tolerance, at most",
    "most_nodes_again": "nodes on which a scene that missed its tolerance is run again, at most",
    "least_steps": "steps of a leg for a tolerance, at least",
    "least_steps_stroked": "the same where there is a stroke",
    "fine_half_width": "fine skin mesh to either side of the apex, at least (m)",
    "skin_stretch": "fine skin mesh, further in frictional strokes (m)",
    "edges_per_half_width": "local refinement: edges in the contact's half-width at least; presets have more (6, 20, 33)",
    "rows_per_half_width": "local refinement: rows of elements in as much of the depth below the contact at least; `draft` has 6",
    "stroked_growth": "growth of edges away from a contact that moves: the preset's squared, up to this",
    "stroked_share": "edges under the middle of a pad that is stroked, over the preset's",
    "stroked_middle": "the middle: to either side at least (m)",
    "inertia_limit": "scenes with rho v^2 / mu above this are refused",
    "seconds_start": "predicted cost: start of a process (s)",
    "seconds_finite": "predicted cost: a node and Newton iteration, finite strain (s)",
    "seconds_small": "predicted cost: a node and Newton iteration, small strain (s)",
    "iterations_finite": "predicted cost: iterations a step, finite strain",
    "iterations_small": "predicted cost: iterations a step, small strain",
}
"""What each of the planner's rules decides."""
WHERE = {
    **{name: declared["evidence"] for name, declared in _DECLARED.items()},
    "presets": "studies of accuracy",
    "errors": "figures/tables/accuracy_planner.csv, accuracy_strokes.csv",
    "mesh_order": "figures/tables/accuracy_orders.csv",
    "time_order": "figures/tables/accuracy_orders.csv",
    "edge_share": "figures/tables/accuracy_belief.csv",
    "stroked": "chosen: a quarter more than the strokes measured",
    "safety": "figures/tables/accuracy_belief.csv",
    **dict.fromkeys(
        ("fillet_error", "fillet_order", "edge_error", "edge_floor", "edge_finest", "bumps"),
        "figures/tables/accuracy_drawn.csv",
    ),
    "profile_share": "tests/test_measured_profiles.py",
    **dict.fromkeys(("linear_triangle", "linear_quad"), "figures/tables/accuracy.csv"),
    "own": "figures/tables/accuracy_own.csv",
    "least_edge": "chosen: a tenth of a micrometre, below which skin is no continuum",
    "least_half_width": "chosen: two of the shortest edges",
    "most_nodes": "chosen: some 20 GB",
    "most_memory": "chosen",
    **dict.fromkeys(
        ("bytes_node", "bytes_step"), "figures/tables/accuracy.csv, on 1e5 nodes and in 176 steps"
    ),
    "most_runs": "chosen: the second run knows the contact",
    "most_nodes_again": "chosen: some minutes of one core",
    "least_steps": "chosen: fewer would do for the end of a leg, but a curve of fewer is none",
    "least_steps_stroked": "figures/tables/accuracy_strokes.csv",
    "fine_half_width": "contact of a plate at 20 gf reaches 2.4 mm (figures/thesis/fig_4-10.csv)",
    "skin_stretch": "skin trails by about 1 mm (figures/tables/calibration.md)",
    "rows_per_half_width": "figures/tables/accuracy_edges.csv",
    "stroked_growth": "figures/tables/accuracy_shown.csv: strokes are as near to finer ones as with the preset's own",
    **dict.fromkeys(
        ("stroked_share", "stroked_middle"), "figures/tables/accuracy_shown.csv, of strokes"
    ),
    "inertia_limit": "chosen: 1e-4 at 40 mm/s, a tenth of the elastic forces at the limit",
}
"""Where the evidence is that is not of this study; costs are those of figures/tables/speed.md."""


def rules_table(pairs: pd.DataFrame, found: pd.DataFrame, rules: Rules = RULES) -> pd.DataFrame:
    """Every rule of the planner: value, what it decides and its evidence. ``pairs``: of
    :func:`study`.
    """

    def planner(effect: str) -> str:
        part = found[found["effect"] == effect]
        off, on = (part.loc[part["planned"] == choice, "share"] for choice in ("off", "on"))
        said = (
            [f"left out in {len(off)} scenes, worth up to {off.max():.2g} of the accuracy"]
            if len(off)
            else []
        )
        return "; ".join(
            [*said, f"carried in {len(on)}, worth {on.min():.2g} of it or more"]
            if len(on)
            else said
        )

    def pair(effect: str) -> str:
        part = pairs[pairs["effect"] == effect]
        return "; ".join(
            f"{row['scene']}: changes {row['change']:.1g}, costs {row['cost ratio']:.2g} times"
            for row in part.to_dict("records")
        )

    own = {"edges_per_half_width": planner("local refinement")}
    for name, effect in EFFECTS.items():
        for each in fields(effect.rules) if effect.rules else ():
            said = each.metadata["evidence"]
            own[each.name] = (
                planner(name) if said == "" else pair(name) if said == OWN_PAIR else said
            )
    rows = []
    for name in (f.name for f in fields(Rules)):
        value = getattr(rules, name)
        if isinstance(value, Mapping):
            value = ", ".join(
                f"{key}: {getattr(preset, 'skin_edge', np.nan) * 1e6:g} um"
                for key, preset in value.items()
            )
        elif not isinstance(value, (float, int)):
            value = "table"
        evidence = own.get(name) or WHERE.get(name, "figures/tables/speed.md")
        rows.append(
            {
                "rule": name,
                "value": str(value),
                "decides": DECIDES.get(name, ""),
                "evidence": evidence,
            }
        )
    fixed = {
        **{name: effect.always for name, effect in EFFECTS.items() if effect.always},
        "local refinement": "fine edges under the contact: presses whose tolerance they meet with less work",
        "full-field output": "full fields: at the times the scene names, no others",
    }
    rows += [
        {"rule": name, "value": "", "decides": text, "evidence": pair(name)}
        for name, text in fixed.items()
    ]
    return pd.DataFrame(rows)


def effects_study(job: SimpleNamespace) -> None:
    """Job: `part` -> `data`."""
    write_frame({"changes": study, "choices": verdicts}[job.part[0]](), Path(job.data[0]))
