"""Machines, folders and habits of other people: what surrounds a run does not change its answer."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import fingerpad
from fingerpad.cli import main
from fingerpad.results import ResultError, read_history, write_history
from own_meshes import SLAB, slab

pytestmark = pytest.mark.unit

SCENE = """\
stimulus: {shape: flat}
motion: [{press_to_force: 5 gf}]
accuracy: {skin_edge: 0.8 mm, steps: 2}
"""
BAR = SCENE.replace("shape: flat", "shape: bar, width: 3 mm, fillet: 50 um")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE)
    return tmp_path


def run_as_a_process(*words, **environment):
    """A command in a process whose environment lacks what is None."""
    given = {k: v for k, v in (os.environ | environment).items() if v is not None}
    command = [sys.executable, "-m", "fingerpad", *words]
    return subprocess.run(command, env=given, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("home", [None, "/proc"], ids=["no home", "a home that cannot be written"])
def test_nobody_needs_a_home(folder, home):
    places = {"HOME": home, "XDG_CACHE_HOME": None, "XDG_CONFIG_HOME": None, "XDG_DATA_HOME": None}
    done = run_as_a_process("run", "scene.yaml", "--out", "out", "--quiet", **places)
    assert done.returncode == 0 and "rror" not in done.stderr, done.stderr
    Path("sweep.yaml").write_text("scene: scene.yaml\nover: {friction: [0, 0.2]}\n")
    done = run_as_a_process("sweep", "sweep.yaml", "--out", "many", "--quiet", **places)
    assert done.returncode == 0, done.stderr
    assert np.isfinite(xr.load_dataset("many/sweep.nc").indentation_depth_end).all()


def test_paths_of_a_scene_are_its_own_wherever_a_sweep_runs(folder):
    """A mesh named relative to the scene, in a folder of its own, swept from elsewhere."""
    home = folder / "pads"
    home.mkdir()
    slab(home / "block.msh", 1e-3)
    scene = SLAB("block.msh") | {"accuracy": "draft"}
    (home / "press.yaml").write_text(json.dumps(scene))
    found = fingerpad.sweep("pads/press.yaml", {"friction": [0, 0.1]})
    assert np.isfinite(found.indentation_depth_end).all()


def test_listed_values_are_found_as_they_were_written(folder):
    Path("scene.yaml").write_text(BAR)
    found = fingerpad.sweep("scene.yaml", {"stimulus.fillet": ["50 um", "100 um"]})
    assert found.sel(fillet=50).indentation_depth_end > 0


@pytest.mark.parametrize("name", ["{1}", "a\\b", "end "])
def test_names_that_libraries_cannot_take_are_refused_before_anything_is_laid_out(
    folder, capsys, name
):
    Path("sweep.yaml").write_text("scene: scene.yaml\nover: {friction: [0, 0.2]}\n")
    assert main(["sweep", "sweep.yaml", "--out", name, "--quiet"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "--out" in said and "in its name" in said
    assert {path.name for path in folder.iterdir()} == {"scene.yaml", "sweep.yaml"}


def test_a_cut_or_foreign_result_is_named(folder):
    path = folder / "history.nc"
    write_history(fingerpad.simulate("scene.yaml"), path)
    whole = path.read_bytes()
    assert json.loads(read_history(path).attrs["cost"])["nodes"] > 0
    half = len(whole) // 2
    for content in (b"", b"CDF", whole[:100], whole[:half], whole[:-4096], b"time,force\n0,0\n"):
        path.write_bytes(content)
        with pytest.raises(ResultError, match=r"history\.nc: cut off, or no NetCDF file"):
            read_history(path)
    xr.Dataset({"temperature": ("time", [1.0])}).to_netcdf(path)
    with pytest.raises(ResultError, match=r"history\.nc: holds no"):
        read_history(path)
