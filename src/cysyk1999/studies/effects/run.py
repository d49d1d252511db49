"""What each effect changes in the answers and costs; and whether the planner's choices bear it out.

An effect is simulated with and without it on the same mesh, so what differs is its own.
:func:`study` does so on scenes where it matters and where it does not, :func:`verdicts` on scenes
drawn at random, for every choice that the planner made.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
import yaml

from cysyk1999.publishing.tables import write_frame
from cysyk1999.studies.common.documents import CONFIG, RAMP, cylinder, scene_of
from cysyk1999.studies.common.plans import with_effects
from fingerpad.healing import simulate
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.effect import OWN_PAIR
from fingerpad.planning.effects import EFFECTS
from fingerpad.planning.plan import Plan, plan
from fingerpad.planning.rules import RULES, Rules
from fingerpad.scenes.scene import Scene

ANSWERS = {
    "indentation_depth": "depth",
    "force": "force",
    "contact_width": "width",
    "centre_pressure": "centre pressure",
    "strain_energy_density": "strain energy",
    "tangential_force": "tangential force",
    "centre_lateral_displacement": "lateral displacement",
}
"""Headline quantities: variable of a history -> its name in tables."""
SLIDES_ONLY = ("tangential_force", "centre_lateral_displacement")
KNOWN_SAFE = 0.1
"""Least share of the accuracy that an effect is worth carrying for."""
FILE = CONFIG / "effects" / "drawn.yaml"
"""Scenes drawn at random across the planner's thresholds."""
FLATTENED = 1e-8
"""m, height of ridges that change nothing."""
MOST_NODES = 6000
"""On larger meshes local refinement is not tried."""
REFINED, FIELDS = "local refinement", "full-field output"
"""What is not an effect of the planner, but costs like one."""
WRONG = ("wrongly left out", "carried for nothing")
"""Verdicts against the planner."""


def changes(one: xr.Dataset, other: xr.Dataset) -> dict[str, float]:
    """Largest change of each headline quantity, over its largest value in ``one``.

    Legs of as many steps in both are compared step by step, others at their ends.
    """
    at, other_at = [], []
    for leg in np.unique(one.leg.values[1:]):
        here, there = (1 + np.flatnonzero(h.leg.values[1:] == leg) for h in (one, other))
        same = len(here) == len(there)
        at.append(here if same else here[-1:])
        other_at.append(there if same else there[-1:])
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


# -- on scenes where it matters and where it does not ---


@dataclass(frozen=True)
class Pair:
    """An effect on a scene; ``switch`` gives the scene and the plan with it (True) or without."""

    effect: str
    label: str
    matters: bool
    document: Mapping[str, Any]
    switch: Callable[[Scene, bool], tuple[Scene, Plan]]


def _switched(scene: Scene, on: bool, effect: str, state: str) -> tuple[Scene, Plan]:
    return scene, with_effects(plan(scene), state, **{effect: on})


def _refined(scene: Scene, on: bool) -> tuple[Scene, Plan]:
    chosen = replace(plan(scene), once=True)
    size = chosen.mesh_size
    if not on:
        size = replace(size, focus=(), skin_radial_edge=None)
    elif not size.focus:
        size = replace(size, focus=((0.0, chosen.contact.half_width / RULES.edges_per_half_width),))
    return scene, replace(chosen, mesh_size=size)


def _with_fields(scene: Scene, on: bool) -> tuple[Scene, Plan]:
    scene = scene if on else scene.varied({"outputs.snapshots": ()})
    return scene, plan(scene)


def flattened(scene: Scene) -> Scene:
    """A scene whose inner ridges are next to nothing, on a mesh that could resolve them."""
    return scene.varied({"specimen.ridges.inner.height": FLATTENED})


NEEDLE, MIDDLE = ({"stimulus": cylinder(k), "motion": RAMP} for k in (1e4, 209.97))
AT_TWO, OFTEN = (
    MIDDLE | {"outputs": {"snapshots": times}}
    for times in (["0.5 s", "2.5 s"], {"every": "0.05 s"})
)
BESIDE = (
    Pair(REFINED, "needle, 10,000 1/m", True, NEEDLE, _refined),
    Pair(REFINED, "210 1/m", False, MIDDLE, _refined),
    Pair(FIELDS, "at 2 times", False, AT_TWO, _with_fields),
    Pair(FIELDS, "every 0.05 s", False, OFTEN, _with_fields),
)


def pairs() -> tuple[Pair, ...]:
    """Scenes that show the effects that are registered now, and :data:`BESIDE`."""
    own = (
        Pair(
            name,
            shown.label,
            shown.matters,
            shown.document,
            partial(_switched, effect=name, state=shown.state),
        )
        for name, effect in EFFECTS.items()
        for shown in effect.shown
    )
    return (*own, *BESIDE)


def study(shown: Iterable[Pair] | None = None, repeats: int = 11) -> pd.DataFrame:
    """Changes and cost ratios of pairs (all by default), a row each.

    Costs are process times, medians of ``repeats`` in turn after one that is not counted; the ratio
    is the median of the ratios of each turn. What ridges change is told on a mesh that has them,
    where they are flattened; what they cost, beside the smooth pad's mesh.
    """
    rows = []
    for pair in pairs() if shown is None else shown:
        scene = scene_of({"accuracy": "draft", **pair.document}, pair.label)
        ways = [pair.switch(scene, on) for on in (True, False)]
        turns = []
        for _ in range(1 + repeats):
            histories = [simulate(*way) for way in ways]
            turns.append([_cost(history)["cpu_s"] for history in histories])
        one, other = histories
        if pair.effect == "ridges":
            other = simulate(flattened(scene), ways[0][1])
        found = changes(one, other)
        worst = max(found, key=found.get)
        seconds = np.array(turns[1:])
        unknowns = [_cost(history)["unknowns"] for history in histories]
        rows.append(
            {
                "effect": pair.effect,
                "scene": pair.label,
                "expected to matter": pair.matters,
                "planned": planned(pair.effect, scene),
                "change": found[worst],
                "of": worst,
                "cost ratio": np.median(seconds[:, 0] / seconds[:, 1]),
                "with (s)": np.median(seconds[:, 0]),
                "without (s)": np.median(seconds[:, 1]),
                "unknowns with": unknowns[0],
                "unknowns without": unknowns[1],
                "repeats": repeats,
            }
            | {f"change of {name}": value for name, value in found.items()}
        )
        print(pair.effect, pair.label, f"{found[worst]:.2g} ({worst})", flush=True)
    return pd.DataFrame(rows)


def _cost(history: xr.Dataset) -> dict[str, Any]:
    return json.loads(history.attrs["cost"])


def planned(effect: str, scene: Scene) -> bool:
    """Whether the planner switches the effect on for this scene."""
    if effect == FIELDS:
        return bool(scene.outputs.snapshots)
    chosen = plan(scene)
    return bool(chosen.mesh_size.focus) if effect == REFINED else chosen.effects[effect].on


# -- on scenes drawn at random ---


def drawn() -> Iterator[tuple[int, Scene]]:
    """The scenes drawn at random, and the seed of the draw that each is of."""
    for seed, documents in yaml.safe_load(FILE.read_text(encoding="utf-8")).items():
        for name, document in documents.items():
            yield seed, scene_of(document, name)


def verdicts() -> pd.DataFrame:
    """What each effect that the planner chose or left out would have been worth: one row a scene
    and effect.

    The plan is made at the accuracy that the scene asks for; what is simulated is its draft without
    ridges, with the plan's effects and with one of them the other way. Ridges are flattened on a
    mesh that has them, and local refinement is taken away or added on the planned mesh itself.
    "worth" is the largest change of a headline quantity, "share" that over the accuracy.
    """
    rows = []
    for seed, scene in drawn():
        chosen = plan(scene)
        for effect, base, ways in _trials(scene, chosen):
            worth, of = _worth(scene, base, ways)
            on = planned(effect, scene)
            if effect in chosen.effects:
                why = chosen.effects[effect].why
            else:
                edge, half_width = 1e6 * chosen.contact_edge, 1e6 * chosen.contact.half_width
                why = f"edge {edge:.3g} um, contact {half_width:.3g} um to either side"
            share = worth / scene.accuracy
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
                    "share": share,
                    "verdict": verdict(on if effect == "symmetry" else not on, share),
                    "why": why,
                }
            )
            print(*list(rows[-1].values())[:-1], flush=True)
    return pd.DataFrame(rows)


Ways = list[tuple[Scene, Plan]]


def _trials(scene: Scene, chosen: Plan) -> Iterator[tuple[str, xr.Dataset, Ways]]:
    """Each effect of a plan that can be had either way: its name, what is compared with, and the
    other ways.
    """
    draft = plan(scene.varied({"accuracy": "draft"}))
    draft = replace(draft, effects=chosen.effects, state=chosen.state, timed=chosen.timed)
    smooth, ridged = (with_effects(draft, ridges=on) for on in (False, True))
    base = simulate(scene, smooth)
    for effect, plans in alternatives(scene, smooth).items():
        yield effect, base, [(scene, other) for other in plans]
    if scene.specimen.ridges:
        yield "ridges", simulate(scene, ridged), [(flattened(scene), ridged)]
    coarse = chosen.mesh_size.skin_edge > chosen.contact.half_width / RULES.edges_per_half_width
    if coarse and chosen.nodes < MOST_NODES and not any(leg.strokes for leg in scene.motion):
        yield REFINED, simulate(*_refined(scene, True)), [_refined(scene, False)]


def _worth(scene: Scene, base: xr.Dataset, ways: Ways) -> tuple[float, str]:
    """The change by the best of some ways, and of what; nan where none of them can be solved."""
    found = []
    for way in ways:
        try:
            changed = changes(base, simulate(*way))
        except NonConvergence as failure:
            print(f"{scene.name}: {failure}", flush=True)
        else:
            found.append(max((value, name) for name, value in changed.items()))
    return min(found, default=(np.nan, ""))


def alternatives(scene: Scene, draft: Plan) -> dict[str, list[Plan]]:
    """For each effect that can be had either way, the plans with the other choice; the best of them
    counts.

    Symmetry is only taken away: where the planner refuses it, it is not there.
    """
    on = {name: effect.on for name, effect in draft.effects.items()}
    other = {name: [with_effects(draft, **{name: not on[name]})] for name in on}
    if on["viscoelasticity"]:
        other["viscoelasticity"] = [
            with_effects(draft, state, viscoelasticity=False)
            for state in ("long_term", "instantaneous")
        ]
    possible = {
        "finite_strain": True,
        "viscoelasticity": scene.specimen.prony,
        "friction": scene.friction,
        "symmetry": on["symmetry"],
    }
    return {name: other[name] for name, can in possible.items() if can}


def verdict(dropped: bool, share: float) -> str:
    """Of a choice whose effect is worth ``share`` of the accuracy; nan: the other choice could not
    be solved.
    """
    if np.isnan(share):
        return "no other way to compare"
    if dropped:
        return "rightly left out" if share <= 1 else "wrongly left out"
    return "rightly carried" if share >= KNOWN_SAFE else "carried for nothing"


# -- rules and their evidence ---


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
        row = {"effect": effect, "scene": f"{len(part)} drawn at random", "planned": choice}
        row |= {"change": worst["worth"], "of": worst["of"]}
        row |= {"least worth / accuracy": part["share"].min()}
        row |= {"largest worth / accuracy": worst["share"]}
        rows.append(row | {text: int((part["verdict"] == text).sum()) for text in WRONG})
    return pd.concat([chosen, pd.DataFrame(rows)], ignore_index=True)


def rules_table(pairs: pd.DataFrame, found: pd.DataFrame, rules: Rules = RULES) -> pd.DataFrame:
    """Every rule of the planner: value, what it decides and its evidence. ``pairs``: of
    :func:`study`.
    """
    owner = {rule: name for name, effect in EFFECTS.items() for rule in effect.rules}
    rows = []
    for known in fields(Rules):
        about = known.metadata["evidence"]
        if not about:
            about = _of_choices(found, owner.get(known.name, REFINED))
        elif about == OWN_PAIR:
            about = _of_pairs(pairs, owner[known.name])
        value = _text(getattr(rules, known.name))
        row = {"rule": known.name, "value": value, "decides": known.metadata["decides"]}
        rows.append(row | {"evidence": about})
    fixed = {
        **{name: effect.always for name, effect in EFFECTS.items() if effect.always},
        REFINED: "fine edges under the contact: presses whose tolerance they meet with less work",
        FIELDS: "full fields: at the times the scene names, no others",
    }
    rows += [
        {"rule": name, "value": "", "decides": text, "evidence": _of_pairs(pairs, name)}
        for name, text in fixed.items()
    ]
    return pd.DataFrame(rows)


def _of_choices(found: pd.DataFrame, effect: str) -> str:
    """What the drawn scenes say of an effect."""
    part = found[found["effect"] == effect]
    off, on = (part.loc[part["planned"] == choice, "share"] for choice in ("off", "on"))
    texts = []
    if len(off):
        texts.append(f"left out in {len(off)} scenes, worth up to {off.max():.2g} of the accuracy")
    if len(on):
        texts.append(f"carried in {len(on)}, worth {on.min():.2g} of it or more")
    return "; ".join(texts)


def _of_pairs(pairs: pd.DataFrame, effect: str) -> str:
    """What the chosen scenes say of an effect."""
    part = pairs[pairs["effect"] == effect]
    return "; ".join(
        f"{row['scene']}: changes {row['change']:.1g}, costs {row['cost ratio']:.2g} times"
        for row in part.to_dict("records")
    )


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name}: {1e6 * preset.skin_edge:g} um" for name, preset in value.items())
    return str(value) if isinstance(value, float | int) else "table"


def effects_study(job: SimpleNamespace) -> None:
    """Job: `part` -> `data`."""
    write_frame({"changes": study, "choices": verdicts}[job.part[0]](), Path(job.data[0]))
