"""In a notebook a run shows a bar that moves with it."""

import sys
from types import SimpleNamespace

import pytest

from fingerpad import simulate
from fingerpad.processes import told_in_a_notebook

pytestmark = pytest.mark.unit

SCENE = {
    "stimulus": {"shape": "flat"},
    "motion": [{"press_to_force": "5 gf"}],
    "accuracy": {"skin_edge": "0.6 mm", "steps": 4},
}


class Bar:
    """IPython's bar, which redraws itself when its progress is set."""

    def __init__(self, total):
        self.total, self.progress, self.shown = total, 0, False
        BARS.append(self)

    def display(self):
        self.shown = True


BARS: list[Bar] = []


@pytest.fixture
def notebook(monkeypatch):
    BARS.clear()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(ProgressBar=Bar))
    monkeypatch.setattr("fingerpad.processes.Console", lambda: SimpleNamespace(is_jupyter=True))


def test_a_run_in_a_notebook_ends_with_a_full_bar(notebook):
    simulate(SCENE)
    (bar,) = BARS
    assert bar.shown and bar.progress == bar.total == 100


def test_a_bar_stands_where_the_run_is(notebook):
    with told_in_a_notebook(None) as told:
        told({"time_s": 0.5, "end_time_s": 2.0})
        assert BARS[0].progress == 25


def test_who_is_told_of_steps_sees_no_bar_and_neither_does_a_script(notebook, monkeypatch):
    steps = []
    simulate(SCENE, progress=steps.append)
    monkeypatch.setattr("fingerpad.processes.Console", lambda: SimpleNamespace(is_jupyter=False))
    simulate(SCENE)
    assert steps and not BARS
