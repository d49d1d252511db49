"""The same scene gives the same bytes but for dates and costs, and the same numbers whatever solves
it, on any threads.
"""

import json

import netCDF4
import numpy as np
import pytest

from fingerpad import load_scene, simulate
from fingerpad.cli import main
from fingerpad.mechanics import linear_solver
from fingerpad.results import write_history
from wrong_scenes import changed, write

pytestmark = pytest.mark.unit

SCENE = changed(
    motion=[{"press_to_force": "10 gf", "rate": "40 gf/s"}],
    accuracy={"skin_edge": "0.5 mm", "steps": 4},
)
COSTS = ("cpu_s", "compiling_s", "wall_s", "peak_rss_MB")
"""Of a summary and of the attribute `cost`: what differs between two runs of one scene."""


def told(folder):
    """What a run has written: plan.json, summary.json without costs, arrays and attributes of the
    history without costs.
    """
    summary = json.loads((folder / "summary.json").read_text())
    with netCDF4.Dataset(folder / "history.nc") as file:
        arrays = {
            name: (np.asarray(file[name][:]).tobytes(), file[name].__dict__)
            for name in file.variables
        }
        about = {name: file.getncattr(name) for name in file.ncattrs()}
    cost = json.loads(about.pop("cost"))
    for part in (summary["run"], cost):
        for name in COSTS:
            part.pop(name, None)
    return (folder / "plan.json").read_bytes(), json.dumps(summary), repr(arrays), repr(about), cost


def test_two_runs_of_a_scene_differ_in_costs_only(tmp_path):
    scene = write(tmp_path, SCENE)
    for name in ("one", "two"):
        assert main(["run", str(scene), "--out", str(tmp_path / name), "--quiet"]) == 0
    assert told(tmp_path / "one") == told(tmp_path / "two")


def test_a_history_is_written_as_the_same_bytes(tmp_path):
    """No date of its own, and no order that changes."""
    history = simulate(load_scene(SCENE))
    for name in ("one.nc", "two.nc"):
        write_history(history, tmp_path / name)
    assert (tmp_path / "one.nc").read_bytes() == (tmp_path / "two.nc").read_bytes()


@pytest.mark.skipif(not linear_solver.pardiso_available(), reason="PARDISO is not installed here")
def test_one_and_two_threads_agree(monkeypatch):
    def with_threads(number):
        monkeypatch.setattr(linear_solver, "threads", lambda: number)
        linear_solver._mkl.cache_clear()
        return simulate(load_scene(SCENE))

    two, one = with_threads(2), with_threads(1)
    for name in ("indentation_depth", "force", "stored_energy", "strain_energy_density"):
        scale = np.abs(one[name].values).max()
        np.testing.assert_allclose(
            two[name].values, one[name].values, rtol=0, atol=1e-9 * scale, err_msg=name
        )
