"""Snakemake asked for targets, in a tree where nothing has run: what test_products finds of the
package, and how it is said.
"""

from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).resolve().parents[2]
SMOKE = ("--configfile", "config/smoke.yaml")


def test_default_is_at_most_ninety_jobs_by_the_profile_of_the_tree(fresh):
    text = fresh.run("--dry-run")
    jobs = fresh.jobs_in(text)
    assert "profiles/default" in text
    assert 50 < len(jobs) <= 91  # and `all` has no outputs
    assert "figures/thesis/fig_4-10.png" in jobs["figures_4_3"]
    assert "results/thesis/coarse/ramp40_k79/history.nc" in jobs["simulate_ramp40"]
    assert not any(path.startswith(str(fresh.root)) for paths in jobs.values() for path in paths)


def test_committed_figures_of_a_fresh_clone_are_made_anew(clone):
    """The figures are there and newer than every source, the results they were drawn from are
    not.
    """
    figure = clone.root / "figures" / "thesis" / "fig_4-12.png"
    figure.parent.mkdir(parents=True)
    figure.touch()
    figure.with_suffix(".csv").touch()
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv" / "installed.lock").write_bytes(
        (clone.root / "requirements.lock").read_bytes()
    )
    jobs = clone.planned("figures/thesis/fig_4-12.png")
    assert "figures/thesis/fig_4-12.png" in jobs["figures_4_12"] and set(jobs) > {
        "simulate_homogeneous_flat"
    }


def test_a_file_that_no_job_makes_is_left_alone_or_refused(clone):
    path = clone.root / "figures" / "tables" / "speed.md"
    path.parent.mkdir(parents=True)
    path.write_text("measured by hand")
    clone.snakemake("figures/tables/speed.md")
    assert path.read_text() == "measured by hand"
    done = clone.snakemake("figures/thesis/fig_9-99.png")
    assert (
        done.returncode != 0
        and "figures/thesis/fig_9-99.png" in done.stderr
        and "KeyError" not in done.stderr
    )


def test_a_wrong_configuration_is_one_line(clone):
    (clone.root / "wrong.yaml").write_text(
        (clone.root / "config" / "smoke.yaml").read_text() + "acuracy: draft\n"
    )
    done = clone.snakemake("--dry-run", "--configfile", "wrong.yaml")
    profile, said = done.stderr.splitlines()
    assert done.returncode == 2 and "profile" in profile
    assert "/wrong.yaml: acuracy: is not a known key, the nearest is 'accuracy'; allowed:" in said


def test_peers_are_skipped_with_one_clear_line_where_they_are_absent(fresh):
    done = fresh.snakemake("--dry-run", "peers")
    assert done.returncode == 0
    said = [line for line in done.stderr.splitlines() if line.startswith("peers:")]
    if find_spec("felupe"):
        assert not said and "peers_table" in done.stdout + done.stderr
    else:
        assert len(said) == 1 and "not installed" in said[0] and "pip install" in said[0]


def test_from_another_folder_and_as_a_module(fresh, tmp_path_factory):
    """Code and built-in files come from beside the Snakefile, results go where Snakemake is
    started.
    """
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    (elsewhere / "scenes").mkdir()
    (elsewhere / "scenes" / "own.yaml").write_text(
        "stimulus: {shape: flat}\nmotion: [{press_to_force: 5 gf}]\n"
    )
    (elsewhere / "mine.yaml").write_text(
        "{name: mine, scenes: [own, ramp40_flat], scenes_folder: scenes}"
    )
    there = ("--snakefile", str(fresh.root / "Snakefile"), "--configfile", "mine.yaml")
    jobs = fresh.planned(*there, folder=elsewhere)
    outputs = {path for paths in jobs.values() for path in paths}
    assert {"simulate_own", "simulate_ramp40", "summary"} <= set(jobs)
    assert all(path.startswith("results/mine/") for path in outputs)
    (elsewhere / "Snakefile").write_text(
        "configfile: 'mine.yaml'\nmodule touch:\n    snakefile: "
        f"{str(fresh.root / 'Snakefile')!r}\n    config: config\n"
        "use rule * from touch as touch_*\n"
    )
    jobs = fresh.planned("results/mine/tables/summary.csv", folder=elsewhere)
    assert set(jobs) == {"touch_simulate_own", "touch_simulate_ramp40", "touch_summary"}


def test_as_the_catalogue_of_workflows_finds_and_tries_it(clone):
    """By workflow/Snakefile, its profile found by itself, in the folder .test with the
    configuration that is there.
    """
    there = (
        "--snakefile",
        "workflow/Snakefile",
        "--directory",
        ".test",
        "--configfile",
        ".test/config/config.yaml",
    )
    text = clone.run("--dry-run", *there)
    jobs = clone.jobs_in(text)
    assert "profiles/default" in text
    files = {f"results/test/figures/fig_4-12.{kind}" for kind in ("csv", "png")} | {
        "results/test/pdf/fig_4-12.pdf"
    }
    assert jobs["figures_4_12"] == files
    assert {"simulate_homogeneous_flat", "simulate_ramp40", "summary"} < set(jobs)
    listed = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())["usage"]
    assert listed["report"] is True and listed["mandatory-flags"]["flags"] == ""
    assert {"conda", "apptainer"} <= set(listed["software-stack-deployment"]) and (
        ROOT / "config/README.md"
    ).exists()


def test_a_sweep_is_a_target_that_a_configuration_names(fresh, tmp_path):
    sweep, words = (
        tmp_path / "mine.yaml",
        ("--snakefile", str(fresh.root / "Snakefile"), "sweep", "--config", "sweep=mine.yaml"),
    )
    scene = "{stimulus: {shape: flat}, motion: [{press_to_force: 5 gf}], accuracy: draft}"
    sweep.write_text(f"scene: {scene}\nover: {{friction: [0, 0.5]}}\n")
    jobs = fresh.planned(*words, folder=tmp_path)
    (records,) = jobs["sweep_batch"]
    assert records.startswith("results/sweeps/mine/batches/")
    assert jobs["sweep_collect"] == {
        "results/sweeps/mine/sweep.nc",
        "results/sweeps/mine/sweep.csv",
    }
    sweep.write_text(sweep.read_text() + "designs: grid\n")
    done = fresh.snakemake("--dry-run", *words, folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith(
        "mine.yaml: designs: is not a known key, the nearest is 'design'; allowed:"
    )
