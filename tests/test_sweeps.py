"""Sweeps: the language, the design, records that survive whatever kills their writer, and the
collected dataset.
"""

import errno
import itertools
import json
import math
import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from jsonschema import Draft202012Validator
from scipy import stats

from faults import ERRORS, Faults, files, in_child
from fingerpad import simulate
from fingerpad.cli import main
from fingerpad.documents import SceneError, read_yaml
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.results import summary
from fingerpad.scenes.scene import load_scene
from fingerpad.sweeps import batch, command, engine
from fingerpad.sweeps.collect import collect_layout
from fingerpad.sweeps.design import Design
from fingerpad.sweeps.forecast import divided, forecast
from fingerpad.sweeps.language import load_sweep, sweep_json_schema
from fingerpad.sweeps.records import Writer, key_of, read_records

pytestmark = pytest.mark.unit
PRESS = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf"}],
    "accuracy": "draft",
}
CURVATURE, FORCE, FAT = (
    "stimulus.curvature",
    "motion[0].press_to_force",
    "specimen.layers.fat.youngs_modulus",
)
COARSE = PRESS | {"accuracy": {"skin_edge": "0.8 mm", "steps": 2}}
DRAWN = {"uniform": ["10 kPa", "20 kPa"]}
NORMAL = {"normal": {"mean": "15 kPa", "sd": "1 kPa"}}
LONG = {"range": [0, 1], "count": 1000}


def sweep_of(over, name="sweep", scene=PRESS, **more):
    return load_sweep({"scene": scene, "over": over, **more}, name)


def design_of(over, **more):
    design = Design(sweep_of(over, **more))
    design.check()
    return design


# --- the language ---------------------------------------------------------------------------------


WRONG = [
    ({"stimulus.curvatur": ["1 1/m"]}, {}, "curvatur: is not a known key, the nearest is"),
    ({"friction": {"unifrom": [0, 1]}}, {}, "over.friction.unifrom: is not a known key"),
    ({"friction": {"uniform": [1, 0]}}, {}, "over.friction.uniform: [1, 0] is not rising"),
    ({"friction": {"name": "mu"}}, {}, "over.friction: {'name': 'mu'} is not exactly one kind"),
    ({"friction": {"uniform": [0, 1], "count": 3}}, {}, "over.friction.count: is not a known key"),
    ({FORCE: ["1 gf", "2 mm"]}, {}, "'2 mm' has the wrong dimension"),
    ({FORCE: {"range": ["1 mm", "2 mm"], "count": 2}}, {}, "'1.0 mm' has the wrong dimension"),
    ({FORCE: {"range": ["1 gf", "2 mm"], "count": 2}}, {}, "has the wrong dimension"),
    ({FORCE: {"range": ["1 foo", "2 foo"], "count": 2}}, {}, "range[0]: '1 foo' has an unknown"),
    ({"friction": {"range": [0, 2], "spacing": "logarithmic"}}, {}, "cannot be logarithmic"),
    ({FAT: {"normal": {"mean": "15 kPa", "sd": "0 kPa"}}}, {}, "normal.sd: '0 kPa' is not above"),
    ({FAT: {"normal": {"mean": "15 kPa"}}}, {}, "normal.sd: is missing"),
    ({FAT: NORMAL | {"within": ["90 kPa", "99 kPa"]}}, {}, "leaves nothing"),
    ({FAT: DRAWN}, {}, "is drawn, but the design is a grid"),
    ({FORCE: {"range": ["1 gf", "2 gf"]}}, {}, "but the design is a grid; allowed: a count"),
    ({"friction": [0]}, {"design": "sobol", "samples": 4}, "sobol draws, but no key is"),
    ({FAT: DRAWN}, {"design": "latin_hypercube"}, "samples: is missing"),
    ({"friction": []}, {}, "over.friction: [] is empty"),
    ({}, {}, "over: {} is not a mapping of keys"),
    ({"friction": [0]}, {"keep": ["contact_widht"]}, "'contact_widht' is not a measure, the near"),
    ({"friction": [0]}, {"keep": ["tangential_force"]}, "keep[0]: 'tangential_force' is not a"),
    (
        {"friction": [0]},
        {"designs": "grid"},
        "designs: is not a known key, the nearest is 'design'",
    ),
    ({"friction": [0]}, {"accuracy": "rough"}, "accuracy: 'rough' is not a known accuracy"),
    ({"stimulus.csv": {"folder": "nowhere"}}, {}, "folder: 'nowhere' holds no file *.csv"),
    ({"friction": LONG, FORCE: [f"{n + 1} gf" for n in range(1001)]}, {}, "makes 1001000 scenes"),
]


@pytest.mark.parametrize("over, more, said", WRONG)
def test_what_is_wrong_with_a_sweep_is_one_line(over, more, said):
    with pytest.raises(SceneError) as error:
        design_of(over, **more)
    line = str(error.value)
    assert said in line and "allowed:" in line and "\n" not in line


def test_an_impossible_corner_of_a_grid_is_named_before_anything_runs():
    over = {"specimen.prony[0].g": [0.05, 0.7], "specimen.prony[1].g": [0.2, 0.4]}
    with pytest.raises(
        SceneError,
        match=r"scene 3 \(.*g = 0.7, .*g = 0.4\): specimen.prony: the terms g sum to 1.1",
    ):
        design_of(over)


def test_a_scene_that_cannot_be_planned_is_named(tmp_path):
    fast = {
        "stimulus": {"shape": "flat"},
        "motion": [{"press_to_depth": "1 mm", "speed": "2 mm/s"}],
    }
    design = Design(
        load_sweep({"scene": fast, "over": {"motion[0].speed": ["2 mm/s", "9000 mm/s"]}})
    )
    with pytest.raises(
        SceneError,
        match=r"scene 1 \(motion\[0\].speed = 9000 mm/s\): motion\[0\]: so fast that inertia",
    ):
        forecast(design)


def test_the_published_sweeps_and_the_example_are_valid_and_fit_their_schema():
    files = sorted((Path(__file__).parents[1] / "config" / "sweeps").glob("*.yaml"))
    assert files
    check = Draft202012Validator(sweep_json_schema())
    for file in files:
        assert not list(check.iter_errors(read_yaml(file))), file
        Design(load_sweep(file)).scene(0)


def test_a_folder_of_profiles_with_a_broken_one_names_it(tmp_path):
    sweep, profile = tmp_path / "sweep.yaml", "x (mm),y (mm)\n0,0\n{}\n2,0.1\n"
    for name, second in (("a", "1,0"), ("b", "0,0"), (".a", "1,0"), ("._b", "1,0")):
        (tmp_path / f"{name}.csv").write_text(profile.format(second))
    scene = PRESS | {"stimulus": {"shape": "sampled", "csv": "a.csv"}}
    sweep.write_text(json.dumps({"scene": scene, "over": {"stimulus.csv": {"folder": "."}}}))
    read = load_sweep(sweep)
    assert read.sweep.over["stimulus.csv"].labels() == ["a", "b"]
    with pytest.raises(SceneError, match=r"scene 1 .*b.csv.*x does not increase in row 3"):
        Design(read).check()
    (tmp_path / "b.csv").write_text(profile.format("1,0.5"))
    assert [scene.stimulus.y[1] for scene in Design(load_sweep(sweep))] == [0.0, 0.5e-3]


# --- the design -----------------------------------------------------------------------------------


def test_a_grid_crosses_its_values_the_last_fastest():
    design = design_of(
        {
            CURVATURE: ["79 1/m", "210 1/m"],
            FORCE: {"range": ["2 gf", "200 gf"], "count": 3, "spacing": "logarithmic"},
        }
    )
    assert design.dimensions == {"curvature": 2, "press_to_force": 3} and len(design) == 6
    assert design.changes(4) == {CURVATURE: "210 1/m", FORCE: "20.0 gf"}
    assert design.scene(5).motion[0].press_to_force == pytest.approx(200 * 9.80665e-3, rel=1e-12)
    assert design.scene(5) == load_scene(PRESS, "sweep").varied({FORCE: "200 gf"})
    units = [("curvature", "1/m"), ("press_to_force", "gf")]
    assert [(p.name, p.unit) for p in design.parameters] == units


@pytest.mark.parametrize("kind", ["sobol", "latin_hypercube"])
def test_draws_follow_their_distributions_and_their_seed(kind):
    over = {
        FAT: {"lognormal": {"median": "15 kPa", "factor": 1.5}, "within": ["10 kPa", "0.04 MPa"]},
        "specimen.layers.dermis.youngs_modulus": {"normal": {"mean": "15 kPa", "sd": "2 kPa"}},
        FORCE: {"range": ["2 gf", "200 gf"], "spacing": "logarithmic"},
    }
    (fat, dermis, force), other = (
        [
            np.array(p.values)
            for p in Design(sweep_of(over, design=kind, samples=256, seed=seed)).parameters
        ]
        for seed in (1, 2)
    )
    assert fat.min() > 10 and fat.max() < 40
    whole = stats.lognorm(math.log(1.5), scale=15)
    low, high = whole.cdf([10, 40])
    truncated = (whole.cdf(fat) - low) / (high - low)
    for shares in (truncated, stats.norm(15, 2).cdf(dermis), np.log(force / 2) / np.log(100)):
        assert (
            stats.kstest(shares, "uniform").statistic < 0.02
        )  # as even as 256 points can be; at random it would be 0.05
    assert not np.allclose(fat, other[0])
    again = Design(sweep_of(over, design=kind, samples=256, seed=1)).parameters[0].values
    assert again == fat.tolist()


def test_draws_are_crossed_with_values_and_alone_are_scenes():
    drawn = {FAT: DRAWN}
    alone = Design(sweep_of(drawn, design="sobol", samples=4))
    crossed = Design(
        sweep_of(drawn | {CURVATURE: ["79 1/m", "210 1/m"]}, design="sobol", samples=4)
    )
    assert alone.dimensions == {"scene": 4} and crossed.dimensions == {"draw": 4, "curvature": 2}
    assert (
        crossed.changes(5)[FAT] == alone.changes(2)[FAT]
        and crossed.changes(5)[CURVATURE] == "210 1/m"
    )


def test_names_are_the_fewest_last_words_that_tell_keys_apart():
    layers = ("epidermis", "dermis", "fat")
    over = {f"specimen.layers.{layer}.youngs_modulus": ["15 kPa"] for layer in layers}
    over |= {"specimen.prony[0].g": [0.1], "friction": [0]}
    named = [f"{layer}_youngs_modulus" for layer in layers]
    assert list(sweep_of(over).names.values()) == [*named, "g", "friction"]
    steps = sweep_of({"accuracy.steps": [4, 8]}, scene=COARSE)
    assert list(steps.names.values()) == ["accuracy_steps"]
    terms = sweep_of({f"specimen.prony[{k}].g": [0.1] for k in (0, 1)})
    assert list(terms.names.values()) == ["0_g", "1_g"]
    assert sweep_of({FAT: {"words": {"soft": "10 kPa"}, "name": "fat"}}).names == {FAT: "fat"}


@pytest.mark.parametrize(
    ("costs", "cores", "count"),
    [
        ([0.3] * 1000, 2, 6),
        ([0.4] * 100, 2, 2),  # 40 s are divided, so that both cores work
        ([0.3] * 10, 2, 1),  # 3 s are not worth a process
        ([10.0] * 100_000, 2, 1000),
        ([100.0] * 10 + [1.0] * 10, 2, 11),
    ],
)
def test_batches_are_a_minute_or_more_and_use_all_cores(costs, cores, count):
    batches = divided(list(range(len(costs))), costs, cores)
    assert [n for batch in batches for n in batch] == list(range(len(costs)))
    assert len(batches) == pytest.approx(count, abs=1)


# --- records --------------------------------------------------------------------------------------


def test_a_key_is_the_content_of_a_scene_and_what_is_kept():
    press = load_scene(PRESS, "a")
    key = key_of(press, ("contact_width",), False)
    assert key == key_of(load_scene(PRESS, "b"), ("contact_width",), False)
    assert key != key_of(press.varied({FORCE: "20.001 gf"}), ("contact_width",), False)
    assert (
        key
        != key_of(press, ("contact_width", "normal_force"), False)
        != key_of(press, ("contact_width", "normal_force"), True)
    )


def test_a_line_that_was_cut_off_is_left_out_and_written_over(tmp_path):
    file = tmp_path / "records.part"
    file.write_bytes(b'{"key": "a"}\n{"key": "b"}\n{"key": "c", "meas')
    write = Writer(file)
    assert write.known == {"a", "b"}
    write({"key": "c"})
    write.close()
    assert [record["key"] for record in read_records(file)] == ["a", "b", "c"]


# --- batches --------------------------------------------------------------------------------------


def batch_in(folder, count=4):
    design = Design(sweep_of({CURVATURE: [f"{100 * (n + 1)} 1/m" for n in range(count)]}))
    spec = {
        "base": design.read.base.model_dump(mode="json"),
        "keep": ["contact_width"],
        "histories": False,
        "scenes": [[n, f"key{n}", design.changes(n)] for n in range(count)],
    }
    (folder / "one.json").write_text(json.dumps(spec))
    return folder / "one.json", folder / "batches" / "one.jsonl"


def pretend(monkeypatch, spoil=None):
    """Scenes cost nothing; `spoil` (curvature -> error) says which fail. What was run is
    returned.
    """
    ran = []

    def measured(scene, keep, file=None):
        ran.append(round(scene.stimulus.curvature))
        if spoil and ran[-1] in spoil:
            raise spoil[ran[-1]]
        return {
            "diagnosis": "",
            "measures": [["contact_width", "end", "mm", 1.0 / scene.stimulus.curvature]],
        }

    monkeypatch.setattr(batch, "measured", measured)
    return ran


def test_a_record_says_what_was_relaxed():
    document = {
        "stimulus": {"shape": "cylinder", "curvature": "1260 1/m"},
        "motion": [{"press_to_depth": "2 mm", "speed": "20 mm/s"}, {"hold": "1 s"}],
        "accuracy": {"steps": 2},
    }
    found = [
        batch.measured(load_scene(document | {"on_trouble": how}), [])["relaxed"]
        for how in ({"relax": "everything"}, "stop")
    ]
    assert found[0].startswith("steps: ") and not found[1]


def test_one_bad_scene_is_a_record_with_its_diagnosis(tmp_path, monkeypatch):
    bad = NonConvergence(1.0, "step 3 did not\nsettle", "more")
    ran = pretend(monkeypatch, {200: bad, 300: ZeroDivisionError("by zero")})
    batch.run_batch(*batch_in(tmp_path))
    found = list(read_records(tmp_path / "batches" / "one.jsonl"))
    assert ran == [100, 200, 300, 400]
    assert [r["diagnosis"] for r in found] == [
        "",
        "no convergence after t = 1 s: step 3 did not settle; try more",
        "ZeroDivisionError: by zero",
        "",
    ]
    assert not list((tmp_path / "batches").glob("*.part")) and not list(
        (tmp_path / "batches").glob("*.at")
    )


def test_an_interrupted_batch_goes_on_where_it_was(tmp_path, monkeypatch):
    spoil = {300: KeyboardInterrupt()}
    ran = pretend(monkeypatch, spoil)
    todo, records = batch_in(tmp_path)
    with pytest.raises(KeyboardInterrupt):
        batch.run_batch(todo, records)
    assert not records.exists() and len(list(read_records(records.with_suffix(".part")))) == 2
    spoil.clear()
    batch.run_batch(todo, records)
    assert ran == [100, 200, 300, 300, 400] and len(list(read_records(records))) == 4


def test_a_full_disk_ends_a_batch_and_loses_no_record(tmp_path, monkeypatch):
    ran, sync, synced = pretend(monkeypatch), os.fsync, []

    def full(handle):
        synced.append(handle)
        if len(synced) == 3:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        sync(handle)

    monkeypatch.setattr(os, "fsync", full)
    todo, records = batch_in(tmp_path)
    with pytest.raises(OSError, match="No space left"):
        batch.run_batch(todo, records)
    batch.run_batch(todo, records)
    assert ran[:3] == [100, 200, 300] and ran[-1] == 400
    assert [r["key"] for r in read_records(records)] == ["key0", "key1", "key2", "key3"]


def test_a_scene_that_has_killed_two_processes_is_not_tried_again(tmp_path, monkeypatch):
    todo, records = batch_in(tmp_path)
    ran = pretend(monkeypatch)
    alive = batch.measured

    def kills(scene, *_):
        return os._exit(9) if round(scene.stimulus.curvature) == 200 else alive(scene, *_)

    monkeypatch.setattr(batch, "measured", kills)
    for _ in range(2):
        assert in_child(lambda: batch.run_batch(todo, records)) == 9
    batch.run_batch(todo, records)
    assert ran == [300, 400]  # 100 ran in the first child
    assert [r["diagnosis"][:28] for r in read_records(records)] == [
        "",
        "its process was killed 2 tim",
        "",
        "",
    ]
    assert {file.name for file in records.parent.iterdir()} == {"one.jsonl"}


def test_any_call_of_a_batch_may_fail_or_be_its_last(tmp_path, monkeypatch):
    """With a failing scene, and a clock that jumps: the same records come of the next run."""
    pretend(monkeypatch, {200: NonConvergence(1.0, "step 3 did not settle", "more")})
    jumps = itertools.cycle([0.0, 1e9, -1e9, 5.0])
    monkeypatch.setattr(batch.time, "perf_counter", lambda: next(jumps))

    def without_time(records):
        return [{**record, "wall_s": 0} for record in read_records(records)]

    def ended(folder, at=None, how=None):
        folder.mkdir()
        todo, records = batch_in(folder)
        fault = Faults(records.parent, at, how)

        def run():
            with fault:
                batch.run_batch(todo, records)
            return fault.calls

        calls = in_child(run)
        batch.run_batch(todo, records)
        return calls, without_time(records), {file.name for file in records.parent.iterdir()}

    calls, expected, there = ended(tmp_path / "whole")
    assert calls > 10 and len(expected) == 4 and there == {"one.jsonl"}
    for at in range(calls):
        for how in (ERRORS[at % len(ERRORS)], "interrupt", "kill"):
            _, *found = ended(tmp_path / f"{at} {how}", at, how)
            assert found == [expected, there], (at, how)


def test_the_numbers_of_a_record_are_those_of_the_scene():
    scene, keep = load_scene(PRESS), ["contact_width", "strain_energy", "held_force"]
    record, history = batch.measured(scene, keep), simulate(scene)
    values = {tuple(about): (unit, value) for *about, unit, value in record["measures"]}
    energy = float(history.strain_energy_density[-1, 1])
    assert values["contact_width", "end"] == ("mm", 1e3 * float(history.contact_width[-1]))
    assert values["strain_energy", "915 um, end"] == ("Pa", energy)
    assert values["held_force", ""] == ("gf", pytest.approx(20))
    assert record["estimated_error"] == history.estimated_error


# --- the folder -----------------------------------------------------------------------------------


@pytest.fixture
def laid(tmp_path):
    """Lay a sweep out in the folder; with ``run`` its batches run in this process."""

    def laid(over, name="sweep", design=None, **how):
        read = sweep_of(over, name, **(design or {}))
        return engine.lay_out(read, tmp_path, cores=1, **how)

    return laid


def run_all(layout):
    """The batches of a layout and their collection, in this process: dataset and table."""
    folder = layout.folder
    for name in layout.batches:
        batch.run_batch(folder / "todo" / f"{name}.json", folder / "batches" / f"{name}.jsonl")
    collect_layout(folder, folder / "sweep.nc", folder / "sweep.csv")
    return xr.load_dataset(folder / "sweep.nc"), pd.read_csv(folder / "sweep.csv")


GRID = {CURVATURE: ["100 1/m", "200 1/m", "400 1/m"], FORCE: ["10 gf", "20 gf"]}


def test_forces_of_a_body_of_revolution_are_those_of_its_summary(laid):
    """In newtons, whatever length of contact a pad has in plane strain."""
    spheres = {
        "kinematics": "axisymmetric",
        "stimulus": {"shape": "sphere", "radius": "5 mm"},
        "motion": [{"press_to_depth": "0.5 mm"}],
        "accuracy": {"skin_edge": "0.8 mm", "steps": 2},
    }
    depths = ["0.3 mm", "0.6 mm"]
    _, table = run_all(laid({"motion[0].press_to_depth": depths}, design={"scene": spheres}))
    for depth, gram_weight in zip(depths, table["normal_force_end (gf)"], strict=True):
        leg = summary(simulate(spheres | {"motion": [{"press_to_depth": depth}]}))["legs"][-1]
        assert gram_weight * 9.80665e-3 == pytest.approx(leg["force_N"], rel=1e-6)


def test_a_grid_becomes_a_labelled_dataset_and_a_table(laid, monkeypatch):
    pretend(monkeypatch, {200: ValueError("wrong")})
    data, table = run_all(laid(GRID))
    width = data.contact_width_end
    assert width.dims == ("curvature", "press_to_force")
    assert width.units == "mm" and data.curvature.units == "1/m"
    assert width.sel(curvature=400).values.tolist() == [1 / 400, 1 / 400]
    assert data.press_to_force.values.tolist() == [10, 20]
    bad = data.sel(curvature=200)
    assert np.isnan(bad.contact_width_end).all() and bad.failed.values.tolist() == [1, 1]
    assert bad.diagnosis.values.tolist() == ["ValueError: wrong"] * 2
    assert data.attrs["failed"] == 2 and data.attrs["scenes"] == 6 and "provenance" in data.attrs
    assert table.scene.tolist() == list(range(6))
    assert table["curvature (1/m)"].tolist() == [100, 100, 200, 200, 400, 400]
    assert table["press_to_force (gf)"].tolist() == [10, 20] * 3
    measured = np.repeat([1 / 100, np.nan, 1 / 400], 2)
    np.testing.assert_array_equal(table["contact_width_end (mm)"], measured)
    assert table.failed.tolist() == [0, 0, 1, 1, 0, 0]
    assert table.diagnosis[2] == "ValueError: wrong"
    assert list(table)[-3:] == ["relaxed", "failed", "diagnosis"]


def test_draws_become_scenes_with_their_parameters_as_coordinates(laid, monkeypatch):
    pretend(monkeypatch)
    over = {CURVATURE: {"range": ["100 1/m", "400 1/m"]}}
    data, table = run_all(laid(over, design={"design": "sobol", "samples": 8}))
    assert data.contact_width_end.dims == ("scene",) and "curvature" in data.coords
    assert data.contact_width_end.values == pytest.approx(1 / data.curvature.values)
    assert table["curvature (1/m)"].tolist() == data.curvature.values.tolist() and len(table) == 8


def test_only_what_is_missing_or_changed_runs_again(laid, monkeypatch):
    ran = pretend(monkeypatch, {200: ValueError("wrong")})
    first = laid(GRID)
    before, _ = run_all(first)
    assert laid(GRID) == first and len(ran) == 6
    wider = GRID | {CURVATURE: [*GRID[CURVATURE], "500 1/m"]}
    layout = laid(wider)
    assert layout.missing == 2 and layout.scenes == 8
    data, _ = run_all(layout)
    assert ran[6:] == [500, 500]
    kept = data.contact_width_end.isel(curvature=slice(3))
    xr.testing.assert_equal(kept, before.contact_width_end)
    ran.clear()
    again = laid(wider, again=True)
    assert again.missing == 2 and run_all(again) and ran == [200, 200]


def test_records_of_an_unfinished_batch_are_found_by_another_layout(laid, monkeypatch):
    spoil = {400: KeyboardInterrupt()}
    ran = pretend(monkeypatch, spoil)
    with pytest.raises(KeyboardInterrupt):
        run_all(laid(GRID))
    spoil.clear()
    layout = laid(GRID | {FORCE: ["10 gf", "20 gf", "30 gf"]})
    assert layout.missing == 5
    data, _ = run_all(layout)
    assert ran.count(100) == 3 and ran.count(200) == 3 and int(data.attrs["failed"]) == 0


def test_another_sweeps_folder_and_one_in_use_are_refused(laid, tmp_path):
    laid({"friction": [0]})
    words = "holds the sweep 'sweep'; allowed: another --out, or --force"
    with pytest.raises(engine.SweepError, match=words):
        laid({"friction": [0]}, "other")
    assert laid({"friction": [0]}, "other", force=True).name == "other"
    words = "is being written by another sweep"
    with engine.held(tmp_path), pytest.raises(engine.SweepError, match=words):
        with engine.held(tmp_path):
            pass


def test_a_scene_without_a_record_is_an_error_not_a_hole(laid, tmp_path, monkeypatch):
    pretend(monkeypatch)
    run_all(laid(GRID))
    file = next((tmp_path / "batches").glob("*.jsonl"))
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:-1]))
    with pytest.raises(ValueError, match="1 scenes have no record"):
        collect_layout(tmp_path, tmp_path / "sweep.nc", tmp_path / "sweep.csv")


# --- processes ------------------------------------------------------------------------------------


def test_a_sweep_is_readable():
    told = sweep_of({CURVATURE: ["100 1/m", "200 1/m"]}).sweep
    assert CURVATURE in repr(told) and len(repr(told)) < 200
    assert CURVATURE in told._repr_html_() and told._repr_html_().startswith("<table>")


def test_a_sweep_runs_in_processes_and_gives_the_numbers_of_its_scenes(tmp_path):
    over = {CURVATURE: ["100 1/m", "200 1/m"]}
    data = engine.sweep(COARSE, over, out=tmp_path / "out", cores=2)
    scenes = [load_scene(COARSE).varied({CURVATURE: value}) for value in over[CURVATURE]]
    depths = [1e3 * float(simulate(scene).indentation_depth[-1]) for scene in scenes]
    assert data.indentation_depth_end.values.tolist() == depths and data.attrs["failed"] == 0
    records = files(tmp_path / "out" / "batches")
    xr.testing.assert_identical(engine.sweep(COARSE, over, out=tmp_path / "out"), data)
    assert files(tmp_path / "out" / "batches") == records


def test_a_batch_that_cannot_run_is_tried_three_times_and_named(laid, tmp_path):
    layout = laid({"friction": [0]})
    for name in layout.batches:
        (tmp_path / "todo" / f"{name}.json").write_text("cut off")
    with pytest.raises(engine.NotFinished, match=r"0 of 1 scenes .*: json\..*\.log\)"):
        engine.run_layout(layout, 1)
    assert not (tmp_path / "sweep.nc").exists()


def test_an_interrupt_ends_the_processes(laid, tmp_path):
    def interrupt(**_):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        engine.run_layout(laid({"friction": [0]}), 1, watch=interrupt)
    assert not (tmp_path / "sweep.nc").exists()


def test_a_profile_without_snakemake_is_refused(laid, monkeypatch):
    monkeypatch.setattr(engine, "find_spec", lambda _: None)
    with pytest.raises(SceneError, match=r"--profile: Snakemake is not installed; allowed: pip"):
        engine.run_layout(laid({"friction": [0]}), 1, profile="mine")


# --- the command ----------------------------------------------------------------------------------


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.yaml"
    over = "  stimulus.curvature: [100 1/m, 200 1/m]\n  motion[0].press_to_force: [10 gf, 20 gf]\n"
    path.write_text(f"scene: {json.dumps(PRESS)}\nover:\n{over}")
    return path


def test_a_plan_of_a_sweep_says_how_many_which_effects_and_what_it_costs(file, capsys):
    assert main(["plan", str(file), "--json", "--cores", "2"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["scenes"], said["cores"]) == (4, 2)
    assert said["effects"] == {"finite_strain": 4, "symmetry": 4}
    assert 0 < said["predicted_cost_s"] < 10
    assert said["predicted_wall_s"] >= said["predicted_cost_s"] / 2
    assert main(["plan", str(file)]) == 0
    table = capsys.readouterr().out
    for words in ("Sweep mine: 4 scenes", "finite strain in 4", "on 1 core"):
        assert words in table


def test_the_command_says_what_was_run_and_what_was_known(file, tmp_path, monkeypatch, capsys):
    pretend(monkeypatch, {200: ValueError("wrong")})
    monkeypatch.setattr(command, "run_layout", lambda layout, *_: run_all(layout))
    words = ["sweep", str(file), "--out", str(tmp_path / "out")]
    assert main(words) == 0
    said = "4 scenes (all run); 2 could not be simulated, see the column diagnosis; results in"
    assert said in capsys.readouterr().out
    file.write_text(file.read_text().replace("20 gf]", "20 gf, 30 gf]"))
    assert main(words) == 0 and "6 scenes (2 run, 4 known from before)" in capsys.readouterr().out
    file.write_text(file.read_text() + "keep: [contact_widht]\n")
    assert main(words) == 2
    assert f"{file}: keep[0]: 'contact_widht' is not a measure" in capsys.readouterr().err


def test_a_sweep_that_cannot_go_on_exits_3_with_one_line(file, tmp_path, monkeypatch, capsys):
    def full(layout, *_):
        raise engine.NotFinished("2 of 4 scenes are done and kept; No space left on device")

    monkeypatch.setattr(command, "run_layout", full)
    assert main(["sweep", str(file), "--out", str(tmp_path / "out")]) == 3
    assert capsys.readouterr().err.count("\n") == 1


# --- a table of samples ---------------------------------------------------------------------------


@pytest.fixture
def tabled(tmp_path):
    """A design of a table of samples and further axes."""

    def tabled(content, over=None, **more):
        (tmp_path / "samples.csv").write_text(content)
        return Design(sweep_of({"table": str(tmp_path / "samples.csv")} | (over or {}), **more))

    return tabled


SAMPLES = "stimulus.curvature [1/m],motion[0].press_to_force (gf)\n100,5\n210.5,10\n420,20\n"


def test_a_table_of_samples_is_a_design(tabled):
    design = tabled(SAMPLES)
    assert design.dimensions == {"scene": 3}
    assert design.changes(1) == {CURVATURE: "210.5 1/m", FORCE: "10.0 gf"}
    assert [scene.stimulus.curvature for scene in design] == [100.0, 210.5, 420.0]
    forces = [scene.motion[0].press_to_force for scene in design]
    assert forces == pytest.approx([force * 9.80665e-3 for force in (5, 10, 20)])
    units = [("curvature", "1/m"), ("press_to_force", "gf")]
    assert [(p.name, p.unit) for p in design.parameters] == units
    crossed = tabled(SAMPLES, {FAT: ["10 kPa", "20 kPa"]})
    assert crossed.dimensions == {"draw": 3, "youngs_modulus": 2} and len(crossed) == 6
    words = tabled("friction;accuracy\n0,1;draft\n0,25;thesis\n")
    assert [scene.friction for scene in words] == [0.1, 0.25]
    assert [scene.accuracy for scene in words] == ["draft", "thesis"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("curvature (1/m)\n1\n", "curvature"),
        ("stimulus.curvature (mm)\n1\n", "stimulus.curvature"),
        ("stimulus.curvature (1/m)\nx\n", "has 'x' in row 2"),
        ("stimulus.curvature (1/m),friction\n1,0,2\n", "has 3 cells in row 2"),
        ("stimulus.curvature (1/m)\n", "has no rows"),
        ("friction (1),friction\n1,2\n", "two columns of the key 'friction'"),
        (",friction\n0,0.1\n", "has no name for column 1; allowed: a key in each; no index: in"),
    ],
)
def test_a_wrong_table_is_one_line(tabled, content, words):
    with pytest.raises(SceneError) as caught:
        tabled(content).check()
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_table_that_is_not_there_or_beside_draws(tabled):
    with pytest.raises(SceneError, match="over.table: .* is not an existing file"):
        sweep_of({"table": "none.csv"})
    with pytest.raises(SceneError, match="drawn beside a table"):
        tabled(SAMPLES, {FAT: DRAWN}, design="sobol", samples=4)


def test_salibs_samples_go_in(tabled):
    sample = pytest.importorskip("SALib.sample.sobol")
    keys = ["stimulus.curvature (1/m)", "specimen.layers.fat.youngs_modulus (kPa)"]
    points = sample.sample({"num_vars": 2, "names": keys, "bounds": [[50, 800], [10, 20]]}, 4)
    design = tabled(pd.DataFrame(points, columns=keys).to_csv(index=False))
    assert len(design) == len(points)
    assert design.scene(1).stimulus.curvature == pytest.approx(points[1, 0], rel=1e-12)
