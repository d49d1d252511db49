"""Which files each target asks for, in a tree where nothing has run."""

from pathlib import Path

import pytest
import yaml

from fingerpad.figures.registry import FIGURES

pytestmark = pytest.mark.workflow

SMOKE = ("--configfile", "config/smoke.yaml")
CALIBRATION = {
    *(
        f"figures/studies/calibration_{n}.{k}"
        for n in ("fit", "identifiability", "residuals", "prony", "friction")
        for k in ("png", "csv")
    ),
    *(f"figures/tables/calibration.{kind}" for kind in ("csv", "md")),
}
RIDGES = ("offset", "height", "friction", "mesh", "outer")


def config(project, name):
    return yaml.safe_load((project.root / "config" / f"{name}.yaml").read_text())


def test_default_makes_every_figure_and_table_and_simulates_every_scene_twice_and_variants_as_often_as_they_are_drawn(clone):
    thesis, jobs = config(clone, "thesis"), clone.planned()
    figures = {f"figures/thesis/fig_{n}.{kind}" for n in thesis["figure_numbers"] for kind in ("png", "csv")}
    assert jobs.pop("figure") == figures
    assert jobs.pop("catalogue") == {"figures/README.md"}
    assert jobs.pop("animation") == {f"figures/studies/animation_{scene}.gif" for scene in thesis["animations"]}
    tables = {f"figures/tables/{name}.{kind}" for name in thesis["table_names"] for kind in ("csv", "md")}
    assert jobs.pop("table") | jobs.pop("mesh_quality") | jobs.pop("receptor_table") == tables
    assert jobs.pop("measures") == {"results/thesis/measures.csv"}
    every = (*thesis["scenes"], *thesis["variants"], *thesis["calibration_scenes"], *thesis["friction_scenes"])
    places = {f"simulations/{scene}" for scene in every}
    drawn = {scene for number in thesis["figure_numbers"] for scene in FIGURES[number].read_companions}
    companions = {*thesis["scenes"], *drawn, "calibration_plate", "calibration_ramp_hold", "stroke_sub_10"}
    assert {"ramp150_flat", "press10_flat"} <= companions < {*every}
    places |= {f"coarse/{scene}" for scene in companions}
    assert jobs.pop("mesh") == {f"results/thesis/{place}/{name}" for place in places for name in ("plan.json", "mesh.msh")}
    assert jobs.pop("simulate") == {f"results/thesis/{place}/history.nc" for place in places}
    assert jobs.pop("calibration_figure") | jobs.pop("calibration_table") == CALIBRATION
    sweep = {f"results/thesis/friction/{coefficient}/history.nc" for coefficient in thesis["friction_coefficients"]}
    assert jobs.pop("stroke_with_friction") == sweep
    outputs = jobs.pop("calibrate") | jobs.pop("calibrate_prony") | jobs.pop("calibrate_friction")
    assert {path for path in outputs if not path.endswith(".csv")} == {"results/thesis/specimens"}
    assert jobs.pop("strain_energy_meanings") == {f"figures/studies/strain_energy_meanings.{k}" for k in ("png", "csv")}
    assert jobs.pop("ridge_figures") == {f"figures/studies/ridges_{n}.{k}" for n in RIDGES for k in ("png", "csv")}
    assert jobs.pop("ridge_data") == {f"results/thesis/ridges/{n}.csv" for n in RIDGES}
    cases = {f"{h:g}_0.65" for h in thesis["ridge_heights"]} | {f"150_{mu:g}" for mu in thesis["ridge_frictions"]}
    cases = {f"{case}_{mesh}" for case in cases for mesh in ("thesis", "coarse")}
    cases |= {f"150_0.65_{mesh}" for mesh in ("fine", "curved", "straight", "shifted")}
    ridged = jobs.pop("ridge_case") | jobs.pop("ridge_case_fine") | jobs.pop("ridge_case_drawn")
    assert ridged == {f"results/thesis/ridges/{case}/history.nc" for case in cases}
    assert not jobs


def test_ridges_simulate_their_own_scenes_only(clone):
    jobs = clone.planned("ridges")
    assert {Path(path).stem for path in jobs["figure"]} == {f"fig_5-{n}" for n in (25, 26, 28, 29)}
    assert jobs["ridge_figures"] == {f"figures/studies/ridges_{n}.{k}" for n in RIDGES for k in ("png", "csv")}
    scenes = {Path(path).parent.name for path in jobs["simulate"]}
    assert all(name.startswith(("ridged_", "plate_stroke_")) for name in scenes) and len(scenes) == 15
    assert "table" not in jobs


def test_calibration_simulates_its_own_scenes_only(clone):
    thesis, jobs = config(clone, "thesis"), clone.planned("calibration")
    assert jobs["calibration_figure"] | jobs["calibration_table"] == CALIBRATION
    scenes = {*thesis["calibration_scenes"], *thesis["friction_scenes"]}
    assert {Path(path).parent.name for path in jobs["simulate"]} == scenes
    assert not {"figure", "table"} & set(jobs)


def test_a_configuration_given_replaces_the_default_and_writes_under_its_results_only(clone):
    smoke, jobs = config(clone, "smoke"), clone.planned(*SMOKE)
    outputs = {Path(path) for paths in jobs.values() for path in paths}
    assert all(path.is_relative_to("results/smoke") for path in outputs)
    assert {path.parent.name for path in outputs if path.name == "history.nc"} == {*smoke["scenes"], *smoke["calibration_scenes"]}
    pictures = {f"fig_{n}" for n in smoke["figure_numbers"]} | {
        f"calibration_{n}" for n in ("fit", "identifiability", "residuals")
    }
    assert {path.stem for path in outputs if path.suffix == ".png"} == pictures
    assert not {"calibrate_friction", "stroke_with_friction", "ridge_case", "ridge_data"} & set(jobs)


@pytest.mark.parametrize("chapter", ["3", "4", "5"])
def test_chapter_makes_its_figures_only(clone, chapter):
    numbers = [n for n in config(clone, "thesis")["figure_numbers"] if n.startswith(f"{chapter}-")]
    jobs = clone.planned(f"chapter{chapter}")
    assert {Path(path).stem for path in jobs["figure"]} == {f"fig_{n}" for n in numbers}
    assert ("animation" in jobs) == (chapter == "5")
    assert "table" not in jobs


def test_single_figure_simulates_only_the_scenes_it_needs(clone):
    jobs = clone.planned("figures/thesis/fig_4-15.png")
    assert jobs["figure"] == {"figures/thesis/fig_4-15.png", "figures/thesis/fig_4-15.csv"}
    assert {Path(path).parent.name for path in jobs["simulate"]} == {"ramp40_k210"}


def test_committed_figures_of_a_fresh_clone_are_made_anew(clone):
    """The figures are there and newer than every source, the results they were drawn from are not."""
    figure = clone.root / "figures" / "thesis" / "fig_4-15.png"
    figure.parent.mkdir(parents=True)
    figure.touch()
    figure.with_suffix(".csv").touch()
    assert "figures/thesis/fig_4-15.png" in clone.planned()["figure"]
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv" / "installed.lock").write_bytes((clone.root / "requirements.lock").read_bytes())
    assert "simulate" in clone.planned("figures/thesis/fig_4-15.png")


def test_wrong_configuration_is_refused_before_anything_runs(clone):
    wrong = clone.root / "wrong.yaml"
    wrong.write_text((clone.root / "config" / "smoke.yaml").read_text() + "acuracy: draft\n")
    done = clone.snakemake("--dry-run", "--configfile", "wrong.yaml")
    assert done.returncode != 0
    assert "acuracy" in done.stdout + done.stderr
