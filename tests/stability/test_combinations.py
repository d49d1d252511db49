"""Every two levels of hard factors meet in the catalogue; and what judges a run sees what it is
there for.
"""

from itertools import combinations, product

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cysyk1999.studies.common.documents import FLAT, force, slide
from cysyk1999.studies.stability.cases import (
    CATALOGUE,
    COMBINED,
    PICKED,
    Case,
    unseen,
)
from cysyk1999.studies.stability.combining import APART, DOCUMENT, FACTORS, pairs
from cysyk1999.studies.stability.invariants import Reactions, difference, mirrored
from cysyk1999.studies.stability.run import other_order, run, second_solver, simulation
from fingerpad.planning.hardness import hard_in
from fingerpad.results import leg_ends

pytestmark = pytest.mark.stability


# -- combinations ---


def test_every_two_hard_levels_that_may_meet_do():
    wanted = {
        frozenset([(one, level), (other, beside)])
        for one, other in combinations(FACTORS, 2)
        for level, beside in product([*FACTORS[one]][1:], [*FACTORS[other]][1:])
    }
    assert all(entry["why"] for entry in DOCUMENT["apart"])
    assert all(level in FACTORS[factor] for pair in APART for factor, level in pair)
    met = set().union(*(pairs(case.levels) for case in COMBINED.values()))
    missing = wanted - APART - met
    assert not missing and not met & APART, sorted(map(sorted, missing))
    assert len(APART) < 0.03 * len(wanted)
    assert max(len(case.levels) for case in COMBINED.values()) <= 5


def test_combinations_are_numbered_and_named_by_their_levels():
    for number, (name, case) in enumerate(COMBINED.items(), start=len(PICKED) + 1):
        every = {factor: next(iter(levels)) for factor, levels in FACTORS.items()} | case.levels
        assert name == f"{number}: {every['stimulus']}, {every['pad']}"
        assert case.group == every["stimulus"] and set(every) == set(FACTORS)
        assert not {
            (f, level) for f, level in case.levels.items() if level == next(iter(FACTORS[f]))
        }


def test_scenes_do_what_their_levels_say(tmp_path):
    """A scene of each level is read; only scenes of a level have its keys."""
    seen = {}
    for case in COMBINED.values():
        scene, levels = case.document, case.levels
        effects = scene["effects"]
        assert (scene["friction"] != 0) == ("friction" in levels)
        assert (effects["finite_strain"] == "off") == ("strain" in levels)
        assert (effects.get("symmetry") == "off") == ("model" in levels)
        timed = levels.get("time", "steady") not in ("steady", "one step")
        assert (effects.get("viscoelasticity") == "on") == timed
        assert len(scene["motion"]) == 1 or "then" in levels
        assert f"law {levels.get('law')}" in case.hard or "yeoh" not in str(scene)
        for level in levels.items():
            seen.setdefault(level, case)
    assert set(seen) == {(f, level) for f, levels in FACTORS.items() for level in [*levels][1:]}
    for case in {case.name: case for case in seen.values()}.values():
        assert case.read(tmp_path).name == case.name


def test_drawn_cases_are_new_and_come_again_by_their_seed(tmp_path):
    one, again, other = unseen(3, 40), unseen(3, 40), unseen(4, 40)
    levels = [case.levels for case in one.values()]
    assert [case.levels for case in again.values()] == levels
    known = [case.levels for case in (*COMBINED.values(), *other.values())]
    assert not [each for each in levels if each in known]
    assert not [each for each in levels if pairs(each) & APART]
    assert {case.group for case in one.values()} == set(list(FACTORS["stimulus"])[1:])
    for case in list(one.values())[::8]:
        assert case.read(tmp_path).name == case.name


# -- what judges ---

PRESS = Case(
    "press",
    "test",
    "not hard",
    {"stimulus": FLAT, "motion": [force(20)], "effects": {"symmetry": "off"}},
)


def test_forces_balance_and_a_missing_one_is_seen(tmp_path):
    made = simulation(PRESS, "default", tmp_path)
    reactions = Reactions(made)
    history = made.run(reactions)
    assert reactions.balance(history) < 1e-4
    history["force"] = 1.01 * history["force"]
    assert reactions.balance(history) == pytest.approx(0.01, rel=0.05)


def test_a_mirror_image_is_told_from_what_is_none():
    x = np.linspace(-1, 1, 21)
    history = xr.Dataset(
        {"skin_displacement_x": (("t", "s"), [-x]), "skin_displacement_y": (("t", "s"), [x**2])}
    )
    assert mirrored(history) < 1e-15
    history["skin_displacement_y"] += 0.01 * x
    assert mirrored(history) == pytest.approx(0.02 / np.sqrt(2), rel=0.05)


@pytest.mark.parametrize(("side", "apart"), [(0.0, 1e-4), (0.5, 0.01)])
def test_side_forces_are_told_apart_by_the_force_they_belong_to(side, apart):
    """A frictionless press has one of rounding, which may change as it will; a drag half as large
    as the force may not.
    """
    values = {"leg": [0, 0], "force": [0, 1.0]}
    one, other = (
        pd.DataFrame(values | {"tangential_force": [0, side + more]})
        .rename_axis("time")
        .to_xarray()
        for more in (1e-6, 1e-6 + (0.01 * side or 1e-5))
    )
    assert difference(one, other, ("force", "tangential_force")) == pytest.approx(apart, rel=1e-3)


def test_the_other_solver_is_another_and_agrees(tmp_path):
    first = simulation(PRESS, "default", tmp_path).run(None)
    with second_solver():
        other = simulation(PRESS, "default", tmp_path).run(None)
    assert '"superlu"' in other.attrs["cost"] and '"superlu"' not in first.attrs["cost"]
    assert difference(first, other) < 1e-5 and leg_ends(other).sizes["time"] == 1


@pytest.mark.parametrize("number", [56, 80, 97])
def test_the_order_of_nodes_changes_no_verdict(number):
    """Mutant: nodes of the skin that keep their numbers."""
    case = [*CATALOGUE.values()][number - 1]
    first = run(case)
    with other_order():
        other = run(case)
    assert other.outcome == first.outcome and difference(first.history, other.history) < 1e-3
    assert other.measured != first.measured  # it was another order


HARD_LAYERS = {
    "epidermis": {"youngs_modulus": "15 kPa", "law": "yeoh"},
    "fat": {"youngs_modulus": "150 MPa", "poisson_ratio": 0.4999},
}
HARD_CASE = {
    "specimen": {"layers": HARD_LAYERS},
    "stimulus": {"shape": "bar", "width": "1 mm"},
    "friction": 0.7,
    "motion": [force(200), slide(1)],
    "effects": {"finite_strain": "off"},
}


def test_what_is_hard_is_said(tmp_path):
    hard = hard_in(Case("c", "test", "hard", HARD_CASE).read(tmp_path))
    words = "1e4 times as stiff|0.4999|200 gf|true edge|0.7|yeoh|a stroke|small strain".split("|")
    assert sorted(word for word in words for text in hard if word in text) == sorted(words)
    assert len(hard) == len(words)
    easy = Case("c", "test", "easy", {"stimulus": FLAT, "motion": [force(20)]})
    assert not hard_in(easy.read(tmp_path))
