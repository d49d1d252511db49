"""Every case of the catalogue is stable by the default method, or fails cleanly; and the measures
tell when it is not.
"""

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
import xarray as xr
import yaml
from test_hard_cases import fails_cleanly
from test_hard_strokes import LOAD, kept_force, lost_and_found, sound_stroke, turned_round

from cysyk1999.studies.stability.cases import CATALOGUE, COMBINED, PICKED, TURNED, Limits
from cysyk1999.studies.stability.run import (
    ADMITS,
    CLEAN,
    HEALED,
    LABOURS,
    SILENT,
    STABLE,
    compared,
    healed,
    judged,
    run,
)
from fingerpad import simulation
from fingerpad.mechanics import stepping
from fingerpad.mechanics.pressure import checkerboard
from fingerpad.results import leg_ends, read_history

pytestmark = pytest.mark.stability


QUICK = (56, 59, 63, 66, 70, 73, 80, 83, 89, 97, 177, 192)
"""Numbers of combinations that take no time."""
FAST = [name for name in COMBINED if int(name.partition(":")[0]) in QUICK]


@cache
def done(name):
    """A case by the default method, once for all tests."""
    return run(CATALOGUE[name])


def end(name, leg=-1):
    """The state at the end of a leg of a case."""
    return leg_ends(done(name).history).isel(time=leg)


def check(found):
    assert found.outcome == STABLE, f"{found.outcome}: {found.message}"


MAY_FAIL = [name for name, case in PICKED.items() if case.may_fail]
HARDER = [
    f"turned, {name}"
    for name in (
        "sphere, radius 0.2 mm",
        "sphere, radius 0.1 mm",
        "sphere, radius 0.2 mm, held",
        "needle, 30 deg, tip 0.1 mm, 2 gf",
        "needle, 20 deg, tip 0.05 mm, 1 gf",
        "needle, 15 deg, tip 0.02 mm, 0.5 mm",
        "punch 1 mm, fillet 0.02 mm, 10 gf",
        "disc of 0.5 mm, nu 0.4999, sphere",
        "friction 1, punch",
        "heavy plate",
        "film of 10 um, 1000 times as stiff, sphere",
    )
]
"""Cases of revolution that labour, or stop: tips several radii deep, and a plate on the bone. The
film takes 8 or 22 matrices a state, as the machine rounds.
"""
STABLE_CASES = [name for name in PICKED if name not in MAY_FAIL]


@pytest.mark.parametrize("name", [*STABLE_CASES, *FAST])
def test_hard_case_is_stable(name):
    found = done(name)
    assert "balance" in found.measured
    check(found)


@pytest.mark.parametrize("name", [name for name in TURNED if name not in HARDER])
def test_hard_case_of_revolution_is_stable(name):
    check(done(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", HARDER)
def test_harder_case_of_revolution_is_right_or_fails_cleanly(name):
    assert done(name).outcome in (STABLE, LABOURS, CLEAN)


@pytest.mark.slow
@pytest.mark.parametrize("name", STABLE_CASES[::3])
def test_half_the_step_and_the_other_solver_change_little(name):
    """A third of them: the study tries all."""
    found = compared(CATALOGUE[name], done(name))
    assert {"halving", "effort"} <= set(found.measured)
    check(found)


# -- what the answers are besides stable ---


@pytest.mark.parametrize("nu", [0.48, 0.499, 0.49999])
@pytest.mark.parametrize("shape", ["flat", "1260 1/m"])
def test_depth_hardly_depends_on_poissons_ratio(shape, nu):
    reference = float(end(f"nu 0.4999, {shape}").indentation_depth)
    assert float(end(f"nu {nu:g}, {shape}").indentation_depth) == pytest.approx(reference, rel=0.1)


@pytest.mark.parametrize("curvature", [2.5e3, 5e3, 1e4])
def test_needles_end_where_their_radius_no_longer_matters(curvature):
    assert 1e3 * float(end(f"needle {curvature:g} 1/m").indentation_depth) == pytest.approx(
        1.38, abs=0.06
    )


@pytest.mark.parametrize("name", ["sharp bar", "bar, fillet 0.03 mm", "line load"])
def test_edges_reach_their_depth(name):
    assert 1e3 * float(end(f"{name}, 2 mm").indentation_depth) == pytest.approx(2)


@pytest.mark.parametrize("share", [1e-4, 1, 1e3])
def test_holds_stay_between_the_two_elastic_limits(share):
    """In steps of 1e-4 to 1e3 times the longest time constant."""
    depths = done(f"steps of {share:g} tau").history.indentation_depth.values[10:]
    # forces balance within a ten-thousandth, and so the depth stands still
    assert (
        np.all(np.diff(depths) > -1e-4 * depths.max())
        and 0.8e-3 < depths.min() < depths.max() < 1.13e-3
    )


@pytest.mark.parametrize("shape", ["flat", "210 1/m"])
def test_almost_separated_pads_are_loaded_again(shape):
    name = f"almost to separation, {shape}"
    assert float(end(name, 1).contact_width) < 0.2 * float(end(name, 0).contact_width)
    assert float(end(name).force) == pytest.approx(LOAD)


@pytest.mark.parametrize("speed", [40, 400])
def test_separation_and_return(speed):
    """An indenter drawn back faster than the skin can follow leaves it, and finds it again."""
    name = f"unloaded to separation at {speed} mm/s"
    assert float(end(name, 2).force) == 0 and float(end(name, 2).contact_width) == 0
    assert float(end(name).force) > 10


STROKES = [name for name, case in PICKED.items() if "friction" in case.scene and case.strokes]


@pytest.mark.parametrize("name", STROKES)
def test_strokes_keep_the_law_of_friction(name):
    history, friction = done(name).history, CATALOGUE[name].scene["friction"]
    sound_stroke(history, friction, energy=CATALOGUE[name].limits.energy)
    if "on a plate" in name:
        turned_round(history, friction)
    elif name.endswith("two waves"):
        kept_force(history, friction)
    elif "loses contact" in name:
        lost_and_found(history)
    elif name.startswith("ridges"):
        there = history.isel(time=np.flatnonzero(history.leg == 1))
        assert float(there.tangential_force[-1]) == pytest.approx(friction * LOAD, rel=1e-3)
        assert (
            history.min_detF.min() > 0.7
        )  # at sharp tips, of which 28 elements from ridge to ridge show more than eight
    elif "frictionless cylinder" in name:
        assert float(history.tangential_force.min()) < -0.04 * LOAD  # down the slope of the pad


def test_featherweight():
    """A ten-thousandth of a gram-weight is carried by a node or a few."""
    last = end("one node in contact")
    assert np.count_nonzero(last.contact_pressure) <= 3 and float(last.force) == pytest.approx(
        1e-4 * 9.80665e-3 / 11.4e-3
    )


# -- failures ---


@pytest.mark.parametrize("name", MAY_FAIL)
def test_what_is_beyond_the_method_leaves_the_last_state_and_a_cause(name, tmp_path, capsys):
    """As a user runs it: exit 3, one line with cause and advice, the last sound state; or a result
    that admits its error.
    """
    document = CATALOGUE[name].document | {"on_trouble": "stop"}
    saved = fails_cleanly(yaml.safe_dump(document), tmp_path, capsys)
    if saved is None:
        assert read_history(tmp_path / "out" / "history.nc").attrs["estimated_error"] >= 0.5
        return
    assert saved.sizes["time"] > 1 and float(saved.min_detF.min()) > 0
    assert float(saved.energy_balance_error[-1]) < 0.05


def test_a_case_heals_and_is_then_judged_like_any_other():
    """A healed run that is beyond a limit is none; nor is one of a scene that forbids remedies."""
    (name,) = (name for name in CATALOGUE if name.startswith("54:"))
    case, found = CATALOGUE[name], compared(CATALOGUE[name], done(name))
    better = healed(case, found)
    assert found.outcome == ADMITS and better.outcome == HEALED
    assert "divided into four" in better.message and 0 < better.measured["halving"] < 0.05
    strict = replace(case, limits=replace(case.limits, det_f=2.0))
    assert healed(strict, found).outcome == SILENT
    forbidden = replace(case, scene=case.scene | {"on_trouble": "stop"})
    assert healed(forbidden, found) is found


# -- what the method buys ---


@pytest.mark.parametrize(
    ("name", "method", "measure"),
    [
        ("nu 0.4999, flat", "plain P2", "checkerboard"),
        ("one load step, flat, nu 0.4999", "plain Newton", "factorisations"),
    ],
)
def test_what_the_method_buys(name, method, measure):
    """Mutants: without pressure modes pressure oscillates, without the lagged pressure Newton's
    method needs more.
    """
    found = run(CATALOGUE[name], method)
    assert found.outcome != STABLE
    assert not found.completed or measure in found.message


def test_full_quads_lock():
    """Mutant: they complete, with nothing to see in their own measures, at half the depth."""
    locked = run(CATALOGUE["nu 0.4999, flat"], "full Q1")
    assert locked.completed
    assert (
        float(locked.history.indentation_depth[-1] / end("nu 0.4999, flat").indentation_depth) < 0.7
    )


FOUND = '["the energy found is off"]'
STEPS = '["with steps half as long the result changes by at most 20 % (depth)"]'
NEAR = '["states near to one another"]'
UNEVEN = '["pressure goes up and down from node to node"]'


@pytest.mark.parametrize(
    ("beyond", "doubts", "error", "outcome"),
    [
        ({}, "[]", 0.1, STABLE),
        ({"factorisations": 11}, "[]", 0.1, LABOURS),
        ({"cuts": 3, "effort": 9}, "[]", 0.1, LABOURS),
        ({"halving": np.inf}, "[]", 0.1, LABOURS),
        ({"halving": 0.2}, "[]", 0.1, SILENT),
        ({"det_f": 0.01}, "[]", 0.1, SILENT),
        ({"complementarity": 0.1}, "[]", 0.1, SILENT),
        ({"energy": 0.2}, "[]", 0.1, SILENT),
        ({"energy": 0.2, "cuts": 3}, FOUND, 0.1, ADMITS),
        ({"energy": 0.2, "halving": 0.2}, FOUND, 0.1, SILENT),
        ({"halving": 0.2}, "[]", 0.6, ADMITS),
        ({"solver": 0.01}, "[]", 0.1, SILENT),
        ({"solver": 0.01}, NEAR, 0.1, ADMITS),
        ({"solver": 0.01, "halving": 0.2}, STEPS, 0.1, ADMITS),
        ({"checkerboard": 0.2, "factorisations": 99}, UNEVEN, 0.1, ADMITS),
        ({"checkerboard": 0.2}, "[]", 0.1, SILENT),
    ],
)
def test_what_was_found_is_told_from_what_it_took(beyond, doubts, error, outcome):
    """Each measure on the wrong side of its limit is named."""
    fine = {"cuts": 0, "factorisations": 3, "energy": 0.01, "complementarity": 1e-9, "det_f": 0.9}
    history = xr.Dataset(attrs={"doubts": doubts, "estimated_error": error})
    found = judged(
        next(iter(CATALOGUE.values())), history, fine | {"checkerboard": np.nan} | beyond
    )
    assert found.outcome == outcome
    assert {text.split()[0] for text in found.message.split("; ") if text} == beyond.keys()


def starve(monkeypatch, max_iterations):
    """Let Newton's method have few iterations, and none more where nodes snap."""
    few = partial(stepping.NewtonSettings, max_iterations=max_iterations)
    monkeypatch.setattr(simulation, "NewtonSettings", few)
    monkeypatch.setattr(stepping, "SNAP_ITERATIONS", 0)


def test_a_run_notes_energy_that_is_missing_and_an_element_that_is_squeezed():
    """A press in one step knows its work too roughly to note anything of it."""

    def notes(name):
        return run(CATALOGUE[name]).history.attrs["notes"]

    assert "energy" not in notes("nu 0.48, flat") and "volume" not in notes("nu 0.48, flat")
    with pytest.MonkeyPatch.context() as mutant:
        mutant.setattr(simulation, "MAX_ENERGY_WARNING", 1e-6)
        mutant.setattr(simulation, "MIN_DET_F_WARNING", 1.0)
        assert "the energy found is off" in notes("nu 0.48, flat") and "of its volume" in notes(
            "nu 0.48, flat"
        )
        assert "energy" not in notes("sharp bar, 1 mm")
        assert "what is hard here" not in notes(
            "nu 0.48, flat"
        ) and "a Poisson's ratio of 0.4999" in notes("nu 0.4999, flat")
    assert "what is hard here" not in notes("nu 0.4999, flat")  # where nothing is doubted


def test_a_run_notes_pressure_that_alternates_but_not_that_of_an_edge(monkeypatch):
    """Of a few nodes of a user's mesh; at a sharp edge pressure has no bound, and is as uneven on
    any mesh.
    """

    def noted(name):
        return "from node to node" in run(CATALOGUE[name]).history.attrs["notes"]

    (graded,) = (name for name in CATALOGUE if name.startswith("54:"))
    assert noted(graded) and not noted("nu 0.48, flat")
    monkeypatch.setattr(simulation, "MAX_UNEVEN_WARNING", 1e-9)
    assert noted("nu 0.48, flat") and not noted("sharp bar, 1 mm")


def test_a_run_notes_that_it_went_to_and_fro_between_states(monkeypatch):
    """Starved of iterations where nodes pop round a fillet it does; round an edge, starved as much,
    steps are only cut.
    """
    starve(monkeypatch, max_iterations=3)
    names = "bar, fillet 0.03 mm, 2 mm", "sharp bar, 2 mm"
    notes = [run(CATALOGUE[name]).history.attrs["notes"] for name in names]
    assert ["states near to one another" in each for each in notes] == [True, False]


def test_a_step_is_not_tried_for_ever(monkeypatch):
    case = CATALOGUE["needle through the pad"]
    monkeypatch.setattr(stepping, "MOST_ITERATIONS", 30)
    found = run(case)
    assert (
        found.outcome == CLEAN
        and "Newton iterations did not suffice for a step cut" in found.message
    )


def test_a_run_that_stops_keeps_its_last_state_and_says_why(monkeypatch):
    """A solver starved of iterations fails cleanly, with the steps before; one that says nothing
    would not count as clean.
    """
    starve(monkeypatch, max_iterations=2)
    monkeypatch.setattr(stepping, "MAX_HALVINGS", 0)
    found = run(CATALOGUE["nu 0.49999, flat"])
    assert not found.completed and found.outcome == CLEAN and "try" in found.message
    monkeypatch.setattr(stepping.QuasiStatic, "_advice", lambda self, reason: "")
    assert run(CATALOGUE["nu 0.49999, flat"]).outcome not in (STABLE, CLEAN, SILENT)


def test_checkerboard_sees_what_alternates_and_nodes_that_lift_off():
    x = np.linspace(-1, 1, 41)
    smooth = np.sqrt(np.maximum(1 - (x / 0.8) ** 2, 0))
    kernel = np.array([1, 2, 3, 2, 1]) / 9

    def index(pressure):
        return checkerboard(
            pressure, np.where(pressure > 0, np.convolve(pressure, kernel, "same"), 0)
        )

    wave = (-1.0) ** np.arange(41)
    assert index(smooth) < 0.03
    assert index(smooth * (1 + 0.2 * wave)) > 0.1
    assert index(smooth * (1 + wave)) > 0.25
    assert np.isnan(index(np.where(np.abs(x) < 0.12, smooth, 0)))


def test_catalogue_says_what_is_hard_and_what_is_stable(tmp_path):
    assert len(CATALOGUE) >= 200
    assert all(case.hard and case.stable and case.group for case in CATALOGUE.values())
    for name in [*PICKED, *FAST]:
        assert CATALOGUE[name].read(tmp_path).name == name
    assert Limits(cuts=3).described() == "at most 3 cuts" and Limits().described() == "as all"
