"""Every case of the catalogue is stable by the default method, or fails cleanly; and the measures tell when it is not."""

import numpy as np
import pytest

from fingerpad.figures import stability as figure
from fingerpad.mechanics import stepping
from fingerpad.studies.hard_cases import CATALOGUE, Limits
from fingerpad.studies.stability import CLEAN, METHODS, SILENT, STABLE, checkerboard, excess, run

pytestmark = pytest.mark.stability

FAST = (
    "nu 0.49999, flat",
    "needle 10000 1/m",
    "needle on a mesh too coarse",
    "sharp bar, 2 mm",
    "line load, 2 mm",
    "3 mm, flat, nu 0.48",
    "stiff skin, 1e4:1",
    "frictionless plate pulled sideways",
    "almost to separation, flat",
    "one node in contact",
    "one load step, 1260 1/m, nu 0.4999",
    "10000 gf/s",
    "coarse",
    "distorted",
)


def check(name, halve):
    case, done = CATALOGUE[name], run(CATALOGUE[name], halve=halve)
    allowed = (STABLE, CLEAN) if case.may_fail else (STABLE,)
    assert done.outcome in allowed, f"{done.outcome}: {done.message}"
    if done.outcome == CLEAN:
        assert "try" in done.message and done.history.sizes["time"] > 1


@pytest.mark.parametrize("name", FAST)
def test_hard_case_is_stable(name):
    check(name, halve=False)


@pytest.mark.slow
@pytest.mark.parametrize("name", CATALOGUE)
def test_hard_case_is_stable_and_half_the_step_changes_little(name):
    check(name, halve=True)


@pytest.mark.parametrize(
    ("name", "method", "measure"),
    [("nu 0.4999, flat", "plain P2", "checkerboard"), ("nu 0.49999, flat", "plain Newton", "iterations")],
)
def test_what_the_method_buys(name, method, measure):
    """Mutants: without pressure modes pressure oscillates, without the lagged pressure Newton's method needs more."""
    done = run(CATALOGUE[name], method, halve=False)
    assert done.outcome != STABLE
    assert not done.completed or measure in done.message


def test_full_quads_lock(tmp_path):
    """Mutant: they complete, with nothing to see in their own measures, at half the depth."""
    case = CATALOGUE["nu 0.4999, flat"]
    sound, locked = (run(case, method, halve=False) for method in ("default", "full Q1"))
    assert locked.completed
    ratio = float(locked.history.indentation_depth[-1] / sound.history.indentation_depth[-1])
    assert ratio < 0.7


def test_a_run_outside_its_limits_is_told():
    """No failure is silent: each measure on the wrong side of its limit is named."""
    fine = {"cuts": 0, "iterations": 3, "energy": 0.01, "complementarity": 1e-9, "det_f": 0.9, "checkerboard": np.nan}
    assert excess(fine, Limits()) == []
    for name, value in {
        "cuts": 1,
        "iterations": 5,
        "energy": 0.5,
        "complementarity": 0.1,
        "det_f": 0.01,
        "halving": np.inf,
    }.items():
        assert [text.split()[0] for text in excess(fine | {name: value}, Limits())] == [name]


def test_a_run_that_stops_keeps_its_last_state_and_says_why(monkeypatch):
    """A solver starved of iterations fails cleanly, with the steps before; one that says nothing would not count as clean."""
    settings = stepping.NewtonSettings(max_iterations=2, snap_iterations=0, max_halvings=0)
    monkeypatch.setattr(stepping, "NewtonSettings", lambda: settings)
    done = run(CATALOGUE["nu 0.49999, flat"], halve=False)
    assert not done.completed and done.outcome == CLEAN and "try" in done.message
    monkeypatch.setattr(stepping.QuasiStatic, "_advice", lambda self, reason: "")
    assert run(CATALOGUE["nu 0.49999, flat"], halve=False).outcome not in (STABLE, CLEAN, SILENT)


def test_checkerboard_sees_what_alternates_and_nodes_that_lift_off():
    x = np.linspace(-1, 1, 41)
    smooth = np.sqrt(np.maximum(1 - (x / 0.8) ** 2, 0))
    kernel = np.array([1, 2, 3, 2, 1]) / 9

    def index(pressure):
        return checkerboard(pressure, np.where(pressure > 0, np.convolve(pressure, kernel, "same"), 0))

    wave = (-1.0) ** np.arange(41)
    assert index(smooth) < 0.03
    assert index(smooth * (1 + 0.2 * wave)) > 0.1
    assert index(smooth * (1 + wave)) > 0.25
    assert np.isnan(index(np.where(np.abs(x) < 0.12, smooth, 0)))


def test_catalogue_says_what_is_hard_and_what_is_stable(tmp_path):
    assert len(CATALOGUE) > 40
    for case in CATALOGUE.values():
        assert case.hard and case.stable and case.group
        assert case.read(tmp_path).name == case.name
    assert Limits(cuts=2).described() == "at most 2 cuts" and Limits().described() == "as all"


def test_methods_of_study_and_figure_are_the_same():
    assert tuple(figure.METHODS) == METHODS
