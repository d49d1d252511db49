"""A run in trouble relaxes what the plan chose, within what the scene insists on and its budget;
a run without trouble is left as it is.
"""

import json
import pickle
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from cysyk1999.studies.common.meshes import corners_only, split
from fingerpad import NonConvergence, healing, load_scene, plan, simulate, simulation, summary
from fingerpad.cli import main
from fingerpad.healing import Try, remedies
from fingerpad.mechanics import stepping
from fingerpad.simulation import solve
from fingerpad.specimen import halved, mesh_for
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.quality import check_orientation

PRESS = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf"}],
    "accuracy": "draft",
}
EDGE = PRESS | {"stimulus": {"shape": "bar", "width": "2 mm"}}


def starve(monkeypatch, iterations, halvings=0):
    """Let Newton's method have few iterations, and steps be cut so often."""
    few = partial(stepping.NewtonSettings, max_iterations=iterations)
    monkeypatch.setattr(simulation, "NewtonSettings", few)
    monkeypatch.setattr(stepping, "SNAP_ITERATIONS", 0)
    monkeypatch.setattr(stepping, "MAX_HALVINGS", halvings)


def in_trouble(document, why="an element would turn inside out", advice=stepping.FOLDED):
    """A run that broke off, without running it."""
    scene = load_scene(document)
    return Try(scene, plan(scene), None, NonConvergence(0.0, why, advice))


def kinds(document, **problem):
    """What would be relaxed of a scene, by the first word of it."""
    first = in_trouble(document, **problem)
    found = remedies(first, first.scene.relaxing)
    return [remedy.said.partition(":")[0] for remedy in found]


MORE = {"advice": "more steps, a finer mesh, or depth instead of force control"}


# -- a run without trouble ---


def test_a_run_without_trouble_is_left_as_it_is():
    healed, planned = simulate(PRESS), solve(PRESS)
    assert "relaxed" not in healed.attrs and "doubts" not in healed.attrs
    assert healed.drop_attrs(deep=False).identical(planned.drop_attrs(deep=False))
    assert "relaxed" not in summary(healed)["run"]


def test_the_key_changes_nothing_of_scenes_that_lack_it():
    """Not their content, by which records and results are known."""
    plain = load_scene(PRESS).canonical()
    assert "on_trouble" not in plain
    assert load_scene(PRESS | {"on_trouble": "relax"}).canonical() == plain
    assert load_scene(PRESS | {"on_trouble": "stop"}).canonical() != plain


# -- a run that breaks off ---


def test_a_step_that_failed_is_gone_on_with_from_its_last_good_state(monkeypatch):
    """And ends where a run with iterations enough ends."""
    expected = solve(PRESS)
    starve(monkeypatch, iterations=2)
    with pytest.raises(NonConvergence):
        simulate(PRESS | {"on_trouble": "stop"})
    monkeypatch.setattr(simulation, "PATIENCE", 0)
    monkeypatch.setattr(stepping, "RESUMED_SHARE", 1.0)
    with pytest.raises(NonConvergence, match="relaxed in vain: steps"):
        simulate(PRESS | {"on_trouble": {"budget": 3}, "accuracy": {"skin_edge": "0.25 mm"}})
    starve(monkeypatch, iterations=3, halvings=0)
    monkeypatch.setattr(simulation, "PATIENCE", 9)
    monkeypatch.setattr(stepping, "RESUMED_SHARE", 0.125)
    found = simulate(PRESS | {"on_trouble": "relax"})
    for name in ("indentation_depth", "contact_width", "stored_energy"):
        np.testing.assert_allclose(found[name][-1], expected[name][-1], rtol=2e-3)


def test_a_timed_step_goes_on_for_what_is_left_of_its_time(monkeypatch):
    """Mutant: the whole of its time again would relax the pad further than it is pressed."""
    ramp = PRESS | {
        "motion": [{"press_to_depth": "1.5 mm", "speed": "1 mm/s"}],
        "effects": {"finite_strain": "on"},
    }
    expected = solve(ramp)
    original, calls = stepping.QuasiStatic._advance, {"n": 0}

    def fails_now_and_then(self, dt, *args, **kwargs):
        """Without the predictor, in single precision, at once, and after the first half."""
        calls["n"] += 1
        if calls["n"] in (3, 4, 5, 7):
            raise stepping._StepFailure("made up")
        return original(self, dt, *args, **kwargs)

    monkeypatch.setattr(stepping.QuasiStatic, "_advance", fails_now_and_then)
    monkeypatch.setattr(stepping, "MAX_HALVINGS", 1)
    found = solve(ramp)
    assert "went on from there" in found.attrs["notes"]
    np.testing.assert_array_equal(found.time, expected.time)
    np.testing.assert_allclose(found.force[1:], expected.force[1:], rtol=2e-3)


# -- a run that doubts itself ---


@pytest.fixture
def doubtful(monkeypatch):
    """A press whose pressure is doubted on its own mesh, and not on a finer one."""

    def uneven(pressure, smooth):
        return 0.3 if np.count_nonzero(pressure) < 28 else 0.0

    monkeypatch.setattr(simulation, "checkerboard", uneven)
    return PRESS


def test_a_doubt_is_healed_and_what_that_changed_is_said(doubtful, tmp_path, capsys):
    scene = tmp_path / "scene.yaml"
    scene.write_text(json.dumps(doubtful))
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    assert "as planned the run doubted itself" in said and "relaxed mesh" in said
    run = json.loads((tmp_path / "out" / "summary.json").read_text())["run"]
    assert run["relaxed"]["kept"].startswith("mesh: edges")
    assert run["relaxed"]["ended"] == "ran well"
    written = json.loads((tmp_path / "out" / "plan.json").read_text())
    assert written["relaxed"]["said"] == [run["relaxed"]["kept"]]
    assert written["discretisation"]["nodes"] > 1.5 * plan(doubtful).nodes


def test_stop_leaves_a_doubt_as_it_is(doubtful):
    found = simulate(doubtful | {"on_trouble": "stop"})
    assert "from node to node" in found.attrs["notes"] and "relaxed" not in found.attrs


def test_a_mesh_that_is_given_is_not_refined(doubtful):
    scene = load_scene(doubtful)
    found = simulate(scene, mesh=mesh_for(scene, plan(scene)))
    assert "relaxed" not in found.attrs and "from node to node" in found.attrs["notes"]


def test_nothing_is_tried_beyond_the_budget(doubtful):
    found = simulate(doubtful | {"on_trouble": {"budget": 0.5}})
    tried = json.loads(found.attrs["relaxed"])
    assert tried["kept"] == "" and all("too much" in each for each in tried["tried"])
    assert "relaxed in vain" in found.attrs["notes"]


def test_all_further_runs_together_take_no_more_than_the_budget(monkeypatch):
    """And each no more than half of what is left, so that those after it have their turn."""
    taken = []

    def labours(scene, how, *_):
        most = how.relaxed.most_factorisations
        taken.append(min(most or 40, 60) * how.nodes**1.5)
        cost = json.dumps({"factorisations": min(most or 40, 60)})
        return solved.assign_attrs(cost=cost)

    solved = solve(PRESS)
    monkeypatch.setattr(healing, "solve", labours)
    found = simulate(PRESS | {"on_trouble": {"budget": 3}})
    tried = json.loads(found.attrs["relaxed"])["tried"]
    first, *further = taken
    assert len(further) >= 2 and any("too much" in each for each in tried)
    left = 3 * first
    for work in further:
        assert work <= left / 2
        left -= work


# -- a run that meets a corner ---


STEEP_FLANKS = Path("config/stability/steep_flanks.csv").absolute()
CORNERS = PRESS | {"stimulus": {"shape": "sampled", "csv": str(STEEP_FLANKS)}}


@pytest.fixture
def by_steps(monkeypatch):
    """Runs of CORNERS whose depth (mm) depends on into how many pieces a step is cut; None: such a
    run breaks off. The pieces of the runs that are made.
    """
    solved = solve(CORNERS)

    def chosen(depths):
        made = []

        def known(scene, how, *_):
            made.append(how.relaxed.pieces)
            depth = depths[how.relaxed.pieces]
            if depth is None:
                raise NonConvergence(0.0, "made up", "a smaller force")
            return solved.assign(indentation_depth=solved.indentation_depth * 0 + 1e-3 * depth)

        monkeypatch.setattr(healing, "solve", known)
        return made

    return chosen


def test_steps_half_as_long_confirm_a_run_that_meets_a_corner(by_steps):
    made = by_steps({1: 1.0, 2: 1.02})
    found = simulate(CORNERS)
    assert made == [1, 2] and found.indentation_depth[-1] == 1e-3
    assert "changes by at most 2 % (depth)" in found.attrs["notes"]
    assert "doubts" not in found.attrs and "relaxed" not in found.attrs


def test_steps_that_change_a_run_which_meets_a_corner_are_halved_once_more(by_steps):
    made = by_steps({1: 1.0, 2: 1.2, 4: 1.2})
    found = simulate(CORNERS)
    assert made == [1, 2, 4] and found.indentation_depth[-1] == pytest.approx(1.2e-3)
    assert "doubts" not in found.attrs
    assert summary(found)["run"]["relaxed"]["kept"] == "steps: half as long"


@pytest.mark.parametrize("depths", [{1: 1.0, 2: 1.2, 4: 2.4}, {1: 1.0, 2: None}])
def test_a_run_that_its_steps_change_doubts_itself(by_steps, depths):
    by_steps(depths)
    found = simulate(CORNERS | {"on_trouble": {"budget": 6}, "accuracy": {"skin_edge": "0.2 mm"}})
    assert "steps half as long" in found.attrs["doubts"]
    changed = 1.0 if depths[2] else 0.0
    run = summary(found)
    assert (
        run["run"]["estimated_error"] >= changed and run["legs"][-1]["estimated_error"] >= changed
    )


def test_a_tolerance_that_shorter_steps_refute_is_missed(by_steps):
    by_steps({1: 1.0, 2: 1.5, 4: 2.55, 8: 4.0, 16: 6.5})
    found = simulate(CORNERS | {"accuracy": 0.3})
    assert found.attrs["tolerance"].startswith("asked 30 %, got 70 %: its steps")


def test_a_run_in_doubt_is_compared_too(by_steps, monkeypatch):
    """Whether shorter steps doubt themselves or not: what they change is said."""
    made = by_steps({1: 1.0, 2: 1.2, 4: 1.21})
    known = healing.solve

    def in_doubt(scene, how, *more):
        doubts = {"doubts": json.dumps(["made up: repeat to check"])}
        return known(scene, how, *more).assign_attrs(doubts if how.relaxed.pieces == 2 else {})

    monkeypatch.setattr(healing, "solve", in_doubt)
    found = simulate(CORNERS)
    assert made[:3] == [1, 2, 4] and found.indentation_depth[-1] == pytest.approx(1.21e-3)
    assert "at most 20 % (depth), then" in found.attrs["notes"] and "doubts" not in found.attrs


def test_times_are_those_of_all_runs(by_steps, monkeypatch):
    """Mutant: of the run that is kept."""
    made, known = by_steps({1: 1.0, 2: 1.2, 4: 1.2}), healing.solve

    def slow(*args):
        time.sleep(0.05)
        found = known(*args)
        cost = json.loads(found.attrs["cost"]) | {"wall_s": 0.05}
        return found.assign_attrs(cost=json.dumps(cost))

    monkeypatch.setattr(healing, "solve", slow)
    cost = json.loads(simulate(CORNERS).attrs["cost"])
    assert made == [1, 2, 4] and cost["wall_s"] > 0.15


def test_steps_by_hand_are_kept_beside_the_doubt(by_steps):
    made = by_steps({1: 1.0, 2: 1.2})
    found = simulate(CORNERS | {"accuracy": {"steps": 4, "skin_edge": "0.2 mm"}})
    assert made == [1, 2] and found.indentation_depth[-1] == 1e-3
    assert "changes by at most 20 % (depth)" in found.attrs["doubts"]


def test_a_run_is_made_once_without_a_corner_and_where_the_scene_says_stop(by_steps):
    made = by_steps({1: 1.0})
    simulate(CORNERS | {"on_trouble": "stop"})
    assert made == [1]
    assert plan(CORNERS).checked and not plan(PRESS).checked and not plan(EDGE).checked
    assert plan(EDGE | {"motion": [{"press_to_force": "20 gf"}, {"slide": "1 mm"}]}).checked


# -- what may be relaxed ---


def test_what_the_message_says_is_relaxed_the_cheapest_first():
    assert kinds(PRESS, **MORE) == ["steps", "mesh", "steps", "mesh"]
    assert kinds(EDGE) == ["mesh", "mesh", "stimulus"]
    assert "linear solver" in kinds(PRESS, why="the matrix is singular", advice="")


@pytest.mark.parametrize(
    ("written", "kept"),
    [
        ({"accuracy": {"steps": 8}}, "steps"),
        ({"accuracy": {"skin_edge": "0.25 mm"}}, "mesh"),
        ({"accuracy": {"element": "Q2P1"}}, "mesh"),
        ({"stimulus": {"shape": "bar", "width": "2 mm", "fillet": "0.03 mm"}}, "stimulus"),
        (
            {
                "stimulus": {"shape": "cylinder", "curvature": "20000 1/m"},
                "accuracy": {"skin_edge": "0.25 mm"},
            },
            "stimulus",
        ),
    ],
)
def test_what_the_user_wrote_is_relaxed_only_with_everything(written, kept):
    scene = EDGE | written
    assert kept not in kinds(scene, **MORE)
    assert kept in kinds(scene | {"on_trouble": {"relax": "everything"}}, **MORE)


def test_a_true_edge_gets_a_fillet_that_the_mesh_can_resolve():
    first = in_trouble(EDGE)
    *_, last = remedies(first, first.scene.relaxing)
    assert last.scene.stimulus.fillet == pytest.approx(2 * first.plan.contact_edge)
    assert "fillet" in last.said and not last.plan.unbounded


@pytest.mark.parametrize(("profile", "smoothed"), [("noisy_profile", True), ("hole", False)])
def test_a_profile_is_smoothed_where_that_leaves_its_shape(profile, smoothed):
    """Not a hole, which it would fill."""
    stimulus = {"shape": "sampled", "csv": str(STEEP_FLANKS.with_stem(profile))}
    assert ("stimulus" in kinds(PRESS | {"stimulus": stimulus})) == smoothed


def test_what_a_remedy_changes_is_said_where_the_run_broke_off(monkeypatch):
    motion = [{"press_to_depth": "0.5 mm", "speed": "1 mm/s"}]
    solved = solve(EDGE | {"motion": motion})

    def breaks(scene, how, *_):
        if how.relaxed.said:
            return solved.assign(force=1.2 * solved.force)
        problem = NonConvergence(0.2, "made up", stepping.FOLDED)
        problem.dataset = solved.isel(time=slice(0, 5))
        raise problem

    monkeypatch.setattr(healing, "solve", breaks)
    found = simulate(EDGE | {"motion": motion})
    assert "t = 0.2 s; there that changed the force by 20 %" in found.attrs["notes"]


# -- a mesh of one's own, divided ---


@pytest.mark.parametrize("element", ["quad9", "tri6", "quad4", "tri3"])
def test_a_divided_mesh_has_the_same_outline_and_layers(element):
    scene = load_scene(PRESS)
    mesh = mesh_for(scene, plan(scene))
    if element != "quad9":
        mesh = split(mesh, "quad4" if element == "quad4" else "tri6")
    mesh = corners_only(mesh) if element == "tri3" else mesh
    finer = halved(mesh)
    check_orientation(finer, "mesh")
    assert finer.element == element and len(finer.cells) == 4 * len(mesh.cells)
    np.testing.assert_array_equal(np.bincount(finer.region), 4 * np.bincount(mesh.region))
    np.testing.assert_allclose(_areas(finer), _areas(mesh), rtol=1e-12)
    nodes = {tuple(point) for point in np.round(finer.points, 12)}
    assert {tuple(point) for point in np.round(mesh.points, 12)} <= nodes
    assert finer.right_half().half


def _areas(mesh):
    """Of each layer, m^2, of the elements as they are bent."""
    kind = KINDS[mesh.element]
    at, weights = kind.rule(4)
    _, slopes = kind.shapes(at)
    frame = np.einsum("qna,enx->eqax", slopes, mesh.points[mesh.cells])
    areas = np.linalg.det(frame) @ weights
    return np.bincount(mesh.region, weights=areas)


def test_a_run_without_convergence_is_passed_on_between_processes():
    """Who simulates in a pool of their own gets the error with its state, not a broken pool."""
    error = NonConvergence(0.25, "the residual stalls", "smaller steps", " in the hold")
    error.hard, error.tried = ("a needle",), ("steps",)
    again = pickle.loads(pickle.dumps(error))
    assert (again.time, again.reason, again.hard) == (0.25, "the residual stalls", ("a needle",))
    assert str(again) == str(error)
    assert "t = 0.25 s in the hold: the residual stalls; try smaller steps; or less" in str(again)
