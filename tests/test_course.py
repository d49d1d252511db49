"""A motion that a table says: as many samples as an instrument writes, planned like legs."""

import numpy as np
import pytest

import fingerpad
from fingerpad import load_scene
from fingerpad.documents import SceneError
from fingerpad.results import scene_of
from fingerpad.stimuli.course import corners_of, read_course

pytestmark = pytest.mark.unit

CYLINDER = {"shape": "cylinder", "curvature": "210 1/m"}
TIME = np.arange(0, 2.5, 1e-3)
RAMP_AND_HOLD = np.interp(TIME, [0, 0.5, 2.5], [0, 20, 20])


def written(folder, *columns, header="time (s),force (gf)", name="motion.csv", delimiter=","):
    rows = np.column_stack(columns)
    np.savetxt(folder / name, rows, delimiter=delimiter, header=header, comments="")
    return {"table": str(folder / name)}


def scene(motion, **keys):
    return load_scene({"stimulus": CYLINDER, "motion": motion, "accuracy": "draft"} | keys)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_a_recorded_ramp_and_hold_is_the_ramp_and_hold(tmp_path, noise):
    """2,500 samples with noise of a quarter of a per cent: three corners, and the depths of the two
    legs.
    """
    values = RAMP_AND_HOLD + noise * np.random.default_rng(0).normal(size=len(TIME)) * (TIME > 0)
    recorded = scene(written(tmp_path, TIME, values))
    assert len(recorded.motion[0].course.times) == 3
    history = fingerpad.simulate(recorded)
    legs = fingerpad.simulate(
        scene([{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}])
    )
    at = np.linspace(0.1, 2.4, 24)
    depth, expected = (each.indentation_depth.interp(time=at).values for each in (history, legs))
    np.testing.assert_allclose(depth, expected, rtol=5e-3)
    assert history.sizes["time"] <= 2 * legs.sizes["time"]


def test_depth_in_other_units_and_back(tmp_path):
    depth = np.interp(TIME, [0, 0.3, 1.0, 1.2, 2.5], [0, 1, 1, 0, 0])
    motion = written(
        tmp_path, TIME * 1e3, depth * 1e3, header="time (ms);depth (um)", delimiter=";"
    )
    history = fingerpad.simulate(scene(motion))
    assert float(history.indentation_depth.max()) == pytest.approx(1e-3, rel=5e-3)
    assert float(history.force[-1]) == pytest.approx(0, abs=1e-9) and history.attrs["complete"]
    assert float(history.time[-1]) == pytest.approx(2.499)


def test_cycles_are_followed(tmp_path):
    """Four cycles a second: depths between the states are those of the table, and viscosity is
    in.
    """
    depth = 0.5 * (1 - np.cos(2 * np.pi * 4 * TIME))
    made = scene(written(tmp_path, TIME, depth, header="time (s),depth (mm)"), accuracy="thesis")
    history = fingerpad.simulate(made)
    found = history.indentation_depth.interp(time=TIME[10:-10]).values
    assert np.abs(found - 1e-3 * depth[10:-10]).max() < 0.02e-3
    assert fingerpad.plan(made).effects["viscoelasticity"].on


def test_a_table_is_a_leg_among_others(tmp_path):
    first = written(tmp_path, [0, 0.5], [0, 10])
    later = written(tmp_path, [5.0, 5.5, 6.0], [10, 20, 20], name="later.csv")
    history = fingerpad.simulate(scene([first, {"hold": "0.2 s"}, later]))
    assert float(history.time[-1]) == pytest.approx(0.5 + 0.2 + 1.0)
    assert set(history.leg.values[1:]) == {0, 1, 2}


def test_a_history_needs_no_table_any_more(tmp_path):
    history = fingerpad.simulate(scene(written(tmp_path, [0, 0.5], [0, 10])))
    (tmp_path / "motion.csv").unlink()
    assert scene_of(history).motion[0].course.values == (0.0, pytest.approx(10 * 9.80665e-3))


WRONG = {
    "no time": ("depth (mm)\n0\n1\n", "has no column 'time (s)'"),
    "nothing kept": ("time (s),way (mm)\n0,0\n1,1\n", "neither depth nor force"),
    "both kept": ("time (s),depth (mm),force (N)\n0,0,0\n1,1,1\n", "both depth and force"),
    "time that falls": ("time (s),depth (mm)\n0,0\n1,1\n0.5,2\n", "in row 4 that is not later"),
    "time twice": ("time (s),depth (mm)\n0,0\n1,1\n1,2\n", "in row 4 that is not later"),
    "one row": ("time (s),depth (mm)\n0,0\n", "fewer than two rows"),
    "nothing pressed": ("time (s),depth (mm)\n0,0\n1,0\n", "no depth above zero"),
    "upside down": ("time (s),force (N)\n0,0\n1,-1\n2,0.5\n", "far below zero in row 3"),
    "another dimension": (
        "time (s),depth (N)\n0,0\n1,1\n",
        "'depth (N)', which has the wrong dimension",
    ),
    "no number": ("time (s),depth (mm)\n0,0\n1,x\n", "has 'x' in row 3"),
    "a start of its own": (
        "time (s),depth (mm)\n0,0.5\n1,1\n",
        "starts at 0.5 mm, where the finger is at 0 mm",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_motion_is_refused_in_one_line(tmp_path, name):
    content, words = WRONG[name]
    (tmp_path / "motion.csv").write_text(content)
    with pytest.raises(SceneError) as caught:
        scene({"table": str(tmp_path / "motion.csv")})
    said = str(caught.value)
    assert words in said and "motion[0].table" in said and "\n" not in said


def test_files_that_are_not_there(tmp_path):
    with pytest.raises(SceneError, match=r"motion\[0\].table: is not an existing file"):
        scene({"table": str(tmp_path / "none.csv")})
    with pytest.raises(SceneError, match="is not a path"):
        scene({"table": 3})


def test_corners_are_where_a_line_bends():
    x = np.linspace(0, 1, 101)
    y = np.abs(x - 0.3)
    assert corners_of(x, y, 1e-6).tolist() == [0, 30, 100]
    assert corners_of(x, 0 * x, 1e-6).tolist() == [0, 100]


def test_half_a_million_samples_are_read_quickly(tmp_path):
    time = np.arange(450_000) * 1e-5
    written(tmp_path, time, np.minimum(time * 10, 20))
    assert len(read_course(tmp_path / "motion.csv").times) == 3
