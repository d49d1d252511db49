"""Every state of a history has a time of its own, so that `sel` and `interp` work on whatever a
motion makes.
"""

import numpy as np
import pytest

import fingerpad
from fingerpad.results import read_history, summary, write_history
from fingerpad.stimuli.motion import apart

pytestmark = pytest.mark.unit

BY_HAND = {"skin_edge": "0.8 mm", "steps": 6}
MOTIONS = {
    "steady press": [{"press_to_force": "5 gf"}],
    "steady press by many steps": [{"press_to_force": "5 gf"}, {"press_to_force": "10 gf"}],
    "press in time": [{"press_to_force": "5 gf", "rate": "40 gf/s"}, {"hold": "0.5 s"}],
    "steady press, slide in time": [
        {"press_to_force": "5 gf"},
        {"slide": "1 mm", "speed": "10 mm/s"},
    ],
    "all steady": [{"press_to_force": "5 gf"}, {"slide": "1 mm"}, {"slide": "-1 mm"}],
    "press, hold, lift, hold": [
        {"press_to_force": "5 gf"},
        {"hold": "0.1 s"},
        {"lift": "steady"},
        {"hold": "0.1 s"},
    ],
    "in time, then steady": [
        {"press_to_force": "5 gf", "rate": "40 gf/s"},
        {"press_to_force": "8 gf"},
    ],
    "step and repeat": [{"press_to_force": "5 gf"}, {"step": "2 mm", "every": "0.5 mm"}],
}


@pytest.fixture(scope="module", params=MOTIONS)
def history(request):
    scene = {
        "stimulus": {"shape": "cylinder", "radius": "5 mm"},
        "friction": 0.3,
        "motion": MOTIONS[request.param],
    }
    return fingerpad.simulate(scene | {"accuracy": BY_HAND})


def test_sel_and_interp_work_by_time(history):
    time = history.time.values
    assert (np.diff(time) > 0).all()
    for at in (0.0, 0.05, float(time[-1])):
        chosen = history.sel(time=at, method="nearest")
        assert abs(float(chosen.time) - at) == np.abs(time - at).min()
    wanted = np.linspace(0, max(float(time[-1]), 1e-12), 7)
    between = history[["force", "indentation_depth", "contact_pressure"]].interp(time=wanted)
    assert np.isfinite(between.force).all() and float(between.force[-1]) == pytest.approx(
        float(history.force[-1]), rel=1e-6
    )
    assert history.sel(time=slice(0, 1)).sizes["time"] == (time <= 1).sum()
    assert (history.force + history.force).sizes["time"] == len(time)


def test_a_time_is_as_it_was_to_a_nanosecond_and_stays_in_files(history, tmp_path):
    write_history(history, tmp_path / "history.nc")
    again = read_history(tmp_path / "history.nc")
    np.testing.assert_array_equal(again.time, history.time)
    again.sel(time=0.05, method="nearest")
    assert all(leg["time_s"] == round(leg["time_s"], 6) for leg in summary(history)["legs"])


@pytest.mark.parametrize("start", [0.0, 1.0, 1e4, 1e9])
def test_times_are_apart_however_late(start):
    times = apart(np.array([start, start, start, start + 1.0, start + 1.0]))
    assert (np.diff(times) > 0).all() and np.abs(
        times - start - [0, 0, 0, 1, 1]
    ).max() <= 1e-11 + 1e-15 * start * 20
