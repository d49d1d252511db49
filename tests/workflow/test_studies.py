"""Targets of the studies of accuracy, stability, effects and peers: what they make, and that the default does not."""

from importlib.util import find_spec

import pytest

pytestmark = pytest.mark.workflow


def test_accuracy_sweeps_elements_of_scenes_and_asks_for_beliefs(clone):
    jobs = clone.planned("accuracy")
    sweeps = {
        f"{family}_{element}"
        for family in ("flat", "210", "1260", "stroke")
        for element in ("Q2P1", "Q1P0", "P2B", "Q1", "Q2", "Q2R")
    }
    assert jobs.pop("accuracy_sweep") == {f"results/thesis/accuracy/{sweep}.json" for sweep in sweeps}
    assert len(jobs.pop("accuracy_belief")) == 14
    tables = ("accuracy", "accuracy_orders", "accuracy_planner", "presets")
    assert jobs.pop("accuracy_tables") == {f"figures/tables/{name}.{kind}" for name in tables for kind in ("csv", "md")}
    assert jobs.pop("accuracy_beliefs") == {f"figures/tables/accuracy_belief.{kind}" for kind in ("csv", "md")}
    names = ("error", "error_stroke", "growth", "belief")
    assert jobs.pop("accuracy_figure") == {f"figures/studies/accuracy_{name}.{kind}" for name in names for kind in ("csv", "png")}
    assert not jobs


def test_stability_solves_the_catalogue_by_four_methods(clone):
    jobs = clone.planned("stability")
    methods = {"default", "full_Q1", "plain_P2", "plain_Newton"}
    assert jobs.pop("stability_method") == {f"results/thesis/stability/{method}.csv" for method in methods}
    outputs = {f"figures/{path}" for path in ("studies/stability.png", "studies/stability.csv")}
    assert jobs.pop("stability_figure") == outputs | {f"figures/tables/stability.{kind}" for kind in ("csv", "md")}
    assert not jobs


def test_effects_make_a_figure_and_three_tables(clone):
    jobs = clone.planned("effects")
    assert jobs.pop("effects_study") == {f"results/thesis/effects/{part}.csv" for part in ("changes", "choices")}
    tables = {
        f"figures/tables/{name}.{kind}" for name in ("effects", "planner_choices", "planner_rules") for kind in ("csv", "md")
    }
    assert jobs.pop("effects_figure") == tables | {"figures/studies/effects.png", "figures/studies/effects.csv"}
    assert not jobs


def test_peers_are_skipped_with_one_clear_line_where_they_are_absent(clone):
    done = clone.snakemake("--dry-run", "peers")
    assert done.returncode == 0
    said = [line for line in done.stderr.splitlines() if line.startswith("peers:")]
    if find_spec("felupe"):
        assert not said and clone.planned("peers")["peers_table"] == {"figures/tables/peers.csv", "figures/tables/peers.md"}
    else:
        assert len(said) == 1 and "not installed" in said[0] and "pip install" in said[0]
        assert not clone.planned("peers")


def test_studies_are_not_part_of_the_default(clone):
    assert not {"accuracy_sweep", "accuracy_belief", "stability_method", "effects_study", "peers_table"} & set(clone.planned())
