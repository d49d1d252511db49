"""What is made again after a change: by content, no more and no less, with and without the cache."""

import json
import os

import pytest

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SMOKE = ("--configfile", "config/smoke.yaml")

HISTORY = "results/smoke/simulations/homogeneous_flat/history.nc"
COMPANION = "results/smoke/coarse/homogeneous_flat/history.nc"
CALIBRATION = {"calibrate", "calibration_figure", "calibration_table"}
FIGURES = {"figure", "measures", "table", "receptor_table", *CALIBRATION}


def test_nothing_is_left_to_do(finished):
    assert finished.planned(*SMOKE) == {}


def test_touched_files_rerun_nothing(finished):
    for path in (
        "src/fingerpad/mechanics/stepping.py",
        "src/fingerpad/publishing/style.py",
        "workflow/scripts/simulate.py",
        "config/scenes/ramp40_flat.yaml",
        "config/specimens/thesis.yaml",
        "config/reference/thesis_numbers.csv",
        "requirements.lock",
        HISTORY,
    ):
        os.utime(finished.root / path)
    assert finished.planned(*SMOKE) == {}


def test_change_in_the_mechanics_reruns_simulations_and_what_reads_them(finished):
    with finished.edited("src/fingerpad/mechanics/stepping.py"):
        jobs = finished.planned(*SMOKE)
    assert set(jobs) == {"simulate", *FIGURES}
    assert HISTORY in jobs["simulate"]
    assert finished.planned(*SMOKE) == {}


@pytest.mark.parametrize("module", ["publishing/style", "figures/chapter4", "publishing/write"])
def test_change_in_a_figure_module_reruns_only_figures(finished, module):
    with finished.edited(f"src/fingerpad/{module}.py"):
        jobs = finished.planned(*SMOKE)
    assert "figure" in jobs
    assert set(jobs) <= FIGURES | {"mesh_quality"}
    assert finished.planned(*SMOKE) == {}


@pytest.mark.parametrize(
    ("path", "jobs"),
    [
        ("src/fingerpad/claims/comparison.py", {"table"}),
        ("src/fingerpad/claims/trends_pressing.py", {"table"}),
        ("src/fingerpad/measures/of_presses.py", {"measures", "table"}),
    ],
)
def test_change_of_a_claim_or_a_measure_reruns_only_the_tables(finished, path, jobs):
    with finished.edited(path):
        assert set(finished.planned(*SMOKE)) == jobs


def test_change_of_a_scene_reruns_that_scene(finished):
    with finished.edited("config/scenes/homogeneous_flat.yaml"):
        jobs = finished.planned(*SMOKE)
    assert jobs["simulate"] == {HISTORY, COMPANION}


def test_change_of_a_specimen_reruns_the_scenes_that_name_it(finished):
    with finished.edited("config/specimens/homogeneous.yaml"):
        jobs = finished.planned(*SMOKE)
    assert jobs["simulate"] == {HISTORY, COMPANION}


def test_change_of_a_measured_force_reruns_the_calibration_and_no_simulation(finished):
    with finished.edited("config/reference/force_depth/dandekar_2003.csv", "\n"):
        assert set(finished.planned(*SMOKE)) == CALIBRATION


def test_a_further_file_of_measured_forces_reruns_the_calibration(finished):
    path = finished.root / "config/reference/force_depth/mine.csv"
    path.write_text((path.parent / "dandekar_2003.csv").read_text().replace("\n1,", "\nme,"))
    try:
        assert set(finished.planned(*SMOKE)) == CALIBRATION
    finally:
        path.unlink()
    assert finished.planned(*SMOKE) == {}


def test_changed_environment_reruns_meshes_simulations_and_figures(finished):
    with finished.edited("requirements.lock"):
        assert set(finished.planned(*SMOKE)) >= {"mesh", "simulate", *FIGURES}


def test_cache_restores_a_reverted_edit_and_never_a_stale_result(finished):
    history = finished.root / HISTORY
    original = history.resolve()
    assert original.parent == finished.cache, "the result was not cached"
    with finished.edited("src/fingerpad/mechanics/stepping.py"):
        text = finished.run(*SMOKE, "--cache", "--", HISTORY)
        assert "Moving output file" in text, "an edited source was answered from the cache"
        assert history.resolve() != original
    text = finished.run(*SMOKE, "--cache", "--", HISTORY)
    assert "Moving output file" not in text
    assert "Symlinking output file" in text
    assert history.resolve() == original


def test_running_without_the_cache_leaves_what_is_cached_alone(finished):
    cached = {path: path.read_bytes() for path in finished.cache.iterdir()}
    with finished.edited("src/fingerpad/mechanics/stepping.py"):
        finished.run(*SMOKE, "--", HISTORY)
        assert not (finished.root / HISTORY).is_symlink()
    assert {path: path.read_bytes() for path in finished.cache.iterdir()} == cached
    finished.run(*SMOKE, "--cache", "--", HISTORY)


def test_every_file_a_job_opens_is_an_input_of_its_rule(finished):
    """What is not declared cannot trigger a rerun: the rules' inputs against what processes really opened."""
    summary = finished.snakemake(*SMOKE, "--detailed-summary", "--forceall").stdout.splitlines()
    header = next(line for line in summary if line.startswith("output_file")).split("\t")
    rows = [dict(zip(header, line.split("\t"), strict=False)) for line in summary if line.startswith("results/")]
    declared = {(row["rule"], row["output_file"]): set(row["input-file(s)"].split(",")) for row in rows}
    jobs = [json.loads(path.read_text()) for path in finished.traces.iterdir()]
    jobs = [job for job in jobs if job["argv"][0].startswith("workflow/scripts/")]
    rules = set()
    for job in jobs:
        rule = job["argv"][0].removeprefix("workflow/scripts/").removesuffix(".py")
        outputs = [argument for argument in job["argv"] if (rule, argument) in declared]
        assert outputs, f"no output of {rule} in {job['argv']}"
        inputs = declared[rule, outputs[0]]
        results = {path for _, path in declared}
        read = {path for path in job["files"] if path in results or not path.startswith("results/")}
        undeclared = {path for path in read - inputs - set(outputs) if "__pycache__" not in path}
        assert not undeclared, f"{rule} opens what it does not declare"
        rules.add(rule)
    assert rules >= {"mesh", "simulate", *FIGURES}
