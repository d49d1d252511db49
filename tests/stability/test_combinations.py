"""Every two levels of hard factors meet in the catalogue; and what judges a run sees what it is
there for.
"""

from itertools import combinations, product

import numpy as np
import pytest
import xarray as xr

from cysyk1999.studies.stability.catalogue import APART, CATALOGUE, COMBINED, FACTORS, allowed
from cysyk1999.studies.stability.catalogue import combinations as rows_of_catalogue
from cysyk1999.studies.stability.covering import covering
from cysyk1999.studies.stability.hard_cases import FLAT, PICKED, Case, depth, force, slide
from cysyk1999.studies.stability.invariants import Held, difference, mirrored
from cysyk1999.studies.stability.relaxing import relaxed
from cysyk1999.studies.stability.run import second_solver, simulation
from fingerpad.mechanics.stepping import NonConvergence, hard_here
from fingerpad.planning.hardness import hard_in
from fingerpad.results import leg_ends

pytestmark = pytest.mark.stability


def missing(factors, rows, may=lambda pair: True):
    """Pairs of hard levels that may meet and do not; written out, not taken from the code under
    test.
    """
    met = {frozenset(pair) for row in rows for pair in combinations(row.items(), 2)}
    wanted = [
        ((one, level), (other, beside))
        for one, other in combinations(factors, 2)
        for level, beside in product(list(factors[one])[1:], list(factors[other])[1:])
        if may({one: level, other: beside})
    ]
    return [pair for pair in wanted if frozenset(pair) not in met]


# -- the covering array -------------------------------------------------------------------------------------------------------


def test_every_two_hard_levels_that_may_meet_do():
    rows = rows_of_catalogue()
    assert len(rows) == len(COMBINED) and not missing(FACTORS, rows, allowed)
    assert all(set(row) == set(FACTORS) for row in rows)
    together = {frozenset(pair) for row in rows for pair in combinations(row.items(), 2)}
    assert not together & {frozenset(pair) for pair in APART}


def test_pairs_that_are_kept_apart_are_few_and_say_why():
    known = {(factor, level) for factor, levels in FACTORS.items() for level in levels}
    assert all(set(pair) <= known and why for pair, why in APART.items())
    pairs = sum(
        (len(FACTORS[one]) - 1) * (len(FACTORS[other]) - 1)
        for one, other in combinations(FACTORS, 2)
    )
    assert len(APART) < 0.03 * pairs


THREE = {"a": "e0123", "b": "exyz", "c": "epq"}


def test_array_is_small_and_the_same_for_the_same_seed():
    rows = covering(THREE, lambda pair: True, 1, 3)
    assert not missing(THREE, rows) and 12 <= len(rows) <= 15
    assert covering(THREE, lambda pair: True, 1, 3) == rows
    assert missing(THREE, rows[:11]), "eleven rows cannot hold twelve pairs: the check itself"


def test_rows_have_no_more_hard_levels_than_asked():
    rows = covering(THREE, lambda pair: True, 1, 2)
    assert len(rows) == 4 * 3 + 4 * 2 + 3 * 2 and not missing(THREE, rows)
    assert all(sum(level != "e" for level in row.values()) == 2 for row in rows)


def test_array_keeps_apart_what_cannot_meet():
    def may(pair):
        return not (pair.get("a") == "0" and pair.get("b") in ("y", "z"))

    rows = covering(THREE, may, 1, 3)
    assert not missing(THREE, rows, may) and all(
        row["b"] in "ex" for row in rows if row["a"] == "0"
    )


# -- the cases ----------------------------------------------------------------------------------------------------------------


def test_first_levels_are_easy_and_others_are_named():
    """What makes a combination hard is said by its levels; names and numbers are the table's."""
    for number, (case, row) in enumerate(
        zip(COMBINED, rows_of_catalogue(), strict=True), start=len(PICKED) + 1
    ):
        assert (
            case.name == f"{number}: {row['stimulus']}, {row['pad']}"
            and list(CATALOGUE)[number - 1] == case.name
        )
        hard = {
            factor: level
            for factor, level in row.items()
            if level != next(iter(FACTORS[factor])) and factor != "stimulus"
        }
        assert all(f"{factor} {level}" in case.hard for factor, level in hard.items())


def test_hundreds_of_kinds_of_scene_are_read(tmp_path):
    """A level of each factor in turn, beside easy ones: the scene says what the level does."""
    seen = {}
    for case, row in zip(COMBINED, rows_of_catalogue(), strict=True):
        for place in row.items():
            seen.setdefault(place, case)
    assert set(seen) == {(factor, level) for factor, levels in FACTORS.items() for level in levels}
    for case in {case.name: case for case in seen.values()}.values():
        assert case.read(tmp_path).name == case.name


# -- what judges --------------------------------------------------------------------------------------------------------------

PRESS = Case(
    "press",
    "test",
    "not hard",
    {"stimulus": FLAT, "motion": [force(20)], "effects": {"symmetry": "off"}},
)


def test_forces_balance_and_a_missing_one_is_seen(tmp_path):
    made = simulation(PRESS, "default", tmp_path)
    held = Held(made)
    history = made.run(held)
    assert held.balance(history) < 1e-4
    history["force"] = 1.01 * history["force"]
    assert held.balance(history) == pytest.approx(0.01, rel=0.05)


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
    one, other = (
        xr.Dataset(
            {
                "leg": ("time", [0, 0]),
                "force": ("time", [0, 1.0]),
                "tangential_force": ("time", [0, side + more]),
            }
        )
        for more in (1e-6, 1e-6 + (0.01 * side or 1e-5))
    )
    assert difference(one, other, ("force", "tangential_force")) == pytest.approx(apart, rel=1e-3)


def test_the_other_solver_is_another_and_agrees(tmp_path):
    first = simulation(PRESS, "default", tmp_path).run(None)
    with second_solver():
        other = simulation(PRESS, "default", tmp_path).run(None)
    assert '"superlu"' in other.attrs["cost"] and '"superlu"' not in first.attrs["cost"]
    assert difference(first, other) < 1e-5 and leg_ends(other).sizes["time"] == 1


def test_advice_is_tried_as_it_is_given():
    case = Case(
        "c", "test", "hard", {"stimulus": {"shape": "line"}, "motion": [depth(2), slide(1)]}
    )
    found = dict(
        relaxed(
            case,
            "no convergence; try a finer skin mesh, a fillet on sharp edges, or a smaller depth or force",
        )
    )
    assert [words.split(":")[0] for words in found] == ["load", "load", "load", "stimulus", "mesh"]
    half = found["load: 0.5 of it"]
    assert half.scene["motion"] == [depth(1), slide(1)] and half.scene["stimulus"] == {
        "shape": "line"
    }
    assert found["stimulus: rounded"].scene["stimulus"]["shape"] == "cylinder"
    assert not dict(relaxed(case, "no convergence; try another method"))
    assert list(dict(relaxed(case, "estimated error 7"))) == ["mesh: planned for accuracy: thesis"]


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


def test_what_is_hard_is_said_and_can_be_asked_less_of(tmp_path):
    """Each thing that is hard in a scene is named, and the case with less of it names it no
    more.
    """
    case = Case("c", "test", "hard", HARD_CASE)
    hard = hard_in(case.read(tmp_path))
    said = [
        "1e4 times as stiff",
        "0.4999",
        "200 gf",
        "true edge",
        "0.7",
        "yeoh",
        "a stroke",
        "small strain",
    ]
    assert sorted(word for word in said for text in hard if word in text) == sorted(said) and len(
        hard
    ) == len(said)
    easier = dict(relaxed(case, f"off by a lot; {hard_here(hard)}"))
    assert not hard_in(easier.pop("all that is hard").read(tmp_path))
    assert len(easier) == 1 + len(hard)  # and a finer mesh
    for said, case_with_less in easier.items():
        left = set(hard_in(case_with_less.read(tmp_path)))
        assert len(set(hard) - left) == (said.startswith("mesh") is False), said
    assert not hard_in(
        Case("c", "test", "easy", {"stimulus": {"shape": "flat"}, "motion": [force(20)]}).read(
            tmp_path
        )
    )


def test_a_failure_names_what_is_hard():
    failure = NonConvergence(0.0, "it failed", "a finer mesh")
    assert str(failure) == "no convergence after t = 0 s: it failed; try a finer mesh"
    failure.hard = ("a true edge", "a stroke")
    assert str(failure).endswith(
        "; try a finer mesh; or less of what is hard here: a true edge, a stroke"
    )
