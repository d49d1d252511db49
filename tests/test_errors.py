"""Errors of curves in three parts: each is found alone where it is known, and companions have the
steps they say.
"""

import json
from dataclasses import replace
from functools import partial
from itertools import pairwise
from operator import attrgetter
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import synthetic
from cysyk1999.figures import axes as axs
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.errors import (
    PARTS,
    Companion,
    Curve,
    Errors,
    curve_errors,
    family_errors,
    norm,
    number_errors,
    over_stroke,
    over_time,
    sampling,
    thinned,
)
from drawn import results
from fingerpad import plan, simulate
from fingerpad.measures.features import centre_pressure, energy_rate, width
from fingerpad.planning.errors import COARSER, ORDER, REMAINS, STEPS_REMAIN
from fingerpad.planning.plan import companion
from fingerpad.planning.schedule import schedule
from fingerpad.receptors.laws import rate_by_leg
from fingerpad.scenes.scene import load_scene

pytestmark = pytest.mark.unit
SCENES = Path(__file__).parents[1] / "config/scenes"
SHAPES = {
    "smooth": lambda t, at: np.sin(7 * (t - at)),
    "kink": lambda t, at: np.maximum(t - at, 0.0),
    "jump": lambda t, at: np.where(t > at, 1.0, 0.0),
}


def outputs(values, time, leg=None) -> xr.Dataset:
    """A history with one variable."""
    leg = np.zeros(len(time), int) if leg is None else leg
    return xr.Dataset({"value": ("time", values), "leg": ("time", leg)}, {"time": time})


def two_columns(history):
    return history["time"].values, history["value"].values


def left_out(curve, at):
    """What straight lines between its values at some places leave out of a curve."""
    fine = np.linspace(at[0], at[-1], 40001)
    return norm(fine, curve(fine) - np.interp(fine, at, curve(at)))


def root_mean_square(values):
    return np.sqrt(np.mean(np.square(values)))


VALUE = over_time(lambda history: history["value"].values)


# --- sampling -------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("even", [True, False])
def test_sampling_error_is_what_straight_lines_leave_out(shape, even):
    """On average over places where a curve bends or jumps about as large; of a smooth curve
    always.
    """
    time, found, true = np.linspace(0, 1, 41) ** (1 if even else 1.5), [], []
    for at in np.random.default_rng(4).uniform(0.3, 0.7, 60):
        curve = partial(SHAPES[shape], at=at)
        found.append(sampling(outputs(curve(time), time), VALUE))
        true.append(left_out(curve, time))
    assert 0.8 < root_mean_square(found) / root_mean_square(true) < 1.6
    if shape == "smooth":
        assert found == pytest.approx(true, rel=0.15)


@pytest.mark.parametrize("nodes", [9, 10, 14, 31])
def test_profile_of_a_contact_of_a_few_nodes_is_drawn_with_the_error_it_has(nodes):
    """A half ellipse, wherever its nodes lie: about as large on average, and never a multiple."""
    found, true, profile = [], [], Curve(two_columns, outputs=False)

    def pressure(x):
        return np.sqrt(np.clip(1 - x**2, 0, None))

    for shift in np.linspace(0, 1, 12, endpoint=False):
        x = (np.arange(-2 * nodes, 2 * nodes) + shift) / (nodes / 2)
        x = x[abs(x) <= 2]
        found.append(sampling(outputs(pressure(x), x), profile))
        true.append(left_out(pressure, x))
    assert 0.7 < root_mean_square(found) / root_mean_square(true) < 1.6
    assert (np.array(found) / np.array(true)).max() < 3


def test_sampling_error_falls_by_the_order_of_the_curve():
    times = [np.linspace(0, 1, n) for n in (41, 81, 161)]
    smooth = [sampling(outputs(SHAPES["smooth"](t, 0.43), t), VALUE) for t in times]
    assert [rough / fine for rough, fine in pairwise(smooth)] == pytest.approx([4, 4], rel=0.05)
    for straight in (3 * times[0], np.ones(41)):
        assert sampling(outputs(straight, times[0]), VALUE) == 0


def test_a_kink_between_legs_is_no_sampling_error():
    """An output is there: a ramp and hold of straight lines is drawn as it is."""
    time = np.append(np.linspace(0, 0.5, 12), np.linspace(0.5, 2.5, 13)[1:])
    leg = np.repeat([0, 1], 12)
    ramp = np.minimum(time, 0.5)
    assert sampling(outputs(ramp, time, leg), VALUE) < 1e-12
    assert sampling(outputs(ramp, time), VALUE) > 1e-3  # mutant: legs are not known


def test_rates_made_of_differences_of_outputs_are_wrong_at_the_outputs_too():
    """A curve of central differences: the truth is within what is found, which lines alone (mutant)
    would leave out.
    """

    def rates(history):
        t, _, rate = rate_by_leg(*two_columns(history), history["leg"].values)
        return t, rate

    time, fine = np.linspace(0, 1, 41), np.linspace(0, 1, 4001)
    history = outputs(np.sin(7 * time), time)
    found = sampling(history, Curve(rates))
    true = norm(fine, 7 * np.cos(7 * fine) - np.interp(fine, *rates(history)))
    lines = sampling(outputs(rates(history)[1], time), VALUE)
    assert 0.8 * true < found < 1.5 * true and lines < 0.7 * true


# --- mesh and steps -------------------------------------------------------------------------------


def solved(h, dt, mesh=0.3, steps=0.2, curved=1.0):
    """A curve that errs by `mesh` h^2 and by `steps` dt, each in a shape of its own, at outputs
    every dt.
    """
    time = np.arange(0, 1 + dt / 2, dt)
    return outputs(np.sin(7 * curved * time) + mesh * h**2 * np.cos(time) + steps * dt * time, time)


@pytest.mark.parametrize("alone", ["mesh", "steps", "neither"])
def test_each_part_is_found_alone(alone):
    size = {"mesh": 0.3 * (alone == "mesh"), "steps": 0.2 * (alone == "steps")}
    rough = 0.1 * COARSER
    run, coarse, both = (
        solved(h, dt, **size) for h, dt in ((0.1, 0.02), (rough, 0.02), (rough, 0.04))
    )
    found = curve_errors(run, Companion(coarse, both), VALUE)
    x, values = two_columns(run)
    mesh, steps = (
        100 * norm(x, part) / norm(x, values)
        for part in (size["mesh"] * 0.1**2 * np.cos(x), size["steps"] * 0.02 * x)
    )
    # of order 2, where 3/2 is taken: half as much again as is left; order 1: half
    assert found.mesh == pytest.approx(REMAINS * (COARSER**2 - 1) * mesh, abs=1e-9)
    assert found.steps == pytest.approx(STEPS_REMAIN * steps, rel=0.02, abs=1e-9)
    assert 0 < found.sampling < 1
    assert found.total == pytest.approx(found.mesh + found.steps + found.sampling)
    first = curve_errors(run, Companion(coarse, both), replace(VALUE, order=1.0)).mesh
    assert first == pytest.approx(found.mesh * 2 / REMAINS), (
        "of first order as much is left as half as long edges change"
    )
    rate = Curve(lambda h: (h["time"].values, np.gradient(h["value"].values, h["time"].values)))
    fewer = curve_errors(run, Companion(coarse, thinned(coarse)), rate)
    assert fewer.steps < 1e-9, "fewer outputs are not fewer steps"
    if alone != "neither":  # mutant: one companion for both parts tells them apart no longer
        mixed = curve_errors(run, Companion(both, both), VALUE)
        assert mixed.mesh > 0.1 and mixed.steps == 0


def test_of_several_curves_the_one_furthest_off_counts_and_numbers_are_compared_as_they_are():
    def last(history):
        return float(history["value"][-1])

    run, coarse, both = solved(0.1, 0.02), solved(0.2, 0.02), solved(0.2, 0.04)
    found = number_errors(run, Companion(coarse, both), last, lambda history: 1.0)
    end, of_mesh, of_steps = map(last, (run, coarse, both))
    assert found.mesh == pytest.approx(REMAINS * 100 * abs((end - of_mesh) / end))
    assert found.steps == pytest.approx(STEPS_REMAIN * 100 * abs((of_steps - of_mesh) / end))
    assert found.sampling == 0
    assert number_errors(run, None, lambda h: float(h["value"].max())).sampling >= 0
    assert curve_errors(run, Companion(run, run), VALUE, VALUE).mesh == 0


@pytest.mark.parametrize(
    "name, over, trace",
    [("ramp40_k210", over_time, width), ("stroke_10", over_stroke, centre_pressure)],
)
def test_a_companion_one_per_cent_away_is_that_far(name, over, trace):
    make = synthetic.stroke if name.startswith("stroke") else synthetic.history
    found = curve_errors(
        make(name), Companion(make(name, 1.01), thinned(make(name, 1.02))), over(trace)
    )
    assert found.mesh == pytest.approx(REMAINS, rel=1e-6) and found.steps == pytest.approx(
        STEPS_REMAIN, rel=0.01
    )
    if over is over_stroke:  # the other way too
        run, other = (
            h.assign(stroke_distance=-h["stroke_distance"]) for h in (make(name), make(name, 1.01))
        )
        assert curve_errors(run, Companion(other, other), over(trace)).mesh == pytest.approx(
            REMAINS, rel=1e-6
        )


@pytest.mark.parametrize("number, low, high", [("5-1", 0, 70), ("5-22", 40, 80), ("5-23", 40, 80)])
def test_errors_of_impulses_are_those_of_the_part_of_the_stroke_that_is_shown(number, low, high):
    """A companion that is off before or after it does not change them; one that is off within
    does.
    """
    histories, meshes, coarse, reference = results()

    def off(first, last):
        def changed(history):
            x, energy = 1e3 * history["stroke_distance"], history["strain_energy_density"]
            return history.assign(
                strain_energy_density=energy.where((x < first) | (x > last), 1.2 * energy)
            )

        names = ("stroke_1", "stroke_5", "stroke_10", "stroke_20", "stroke_40")
        others = {name: changed(histories[name]) for name in names}
        frame = FIGURES[number].frame(
            histories, meshes, coarse | {n: Companion(h, h) for n, h in others.items()}, reference
        )
        return frame[PARTS[0]].max()

    outside = off(0.5, low - 1) if low else off(high + 1, 79.5)
    assert outside < 1e-6 and off(low + 2, high - 2) > 1


def test_rate_curve_with_a_jump_is_compared_on_either_side_of_it():
    history, other = synthetic.history("ramp40_k210"), synthetic.history("ramp40_k210", 1.01)
    rate = Curve(lambda h: energy_rate(h, 915e-6).to_numpy().T)
    assert curve_errors(history, Companion(other, other), rate).mesh == pytest.approx(
        REMAINS, rel=1e-4
    )


@pytest.mark.parametrize("nodes, order", [(10000, 1.5), (7000, 1.0), (6900, 1.5)])
def test_less_coarse_a_companion_more_is_left_of_what_a_curve_changes_by(nodes, order):
    """Where geometry keeps edges short, as ridges do: by the root of the nodes, of curves and of
    numbers.
    """

    def made(h, nodes):
        planned = {"nodes": nodes, "element": "Q2P1"}
        text = json.dumps({"discretisation": planned, "mesh_size_SI": {"skin_edge": h}})
        return solved(h, 0.02, 0.3, 0.0).assign_attrs(plan=text)

    def first(history):
        return float(history["value"][0])

    run, other = made(0.1, 10000), made(0.11, nodes)
    pair = Companion(other, thinned(other))
    found = curve_errors(run, pair, replace(VALUE, order=order)).mesh
    if nodes == 10000:
        assert np.isnan(found), "as fine: it tells nothing"
        return
    x, values = two_columns(run)
    ratio = (10000 / nodes) ** 0.5
    change = 100 * norm(x, values - other["value"].values) / norm(x, values)
    assert found == pytest.approx(change / (ratio**order - 1))
    change = 100 * abs(1 - first(other) / first(run))
    assert number_errors(run, pair, first).mesh == pytest.approx(change / (ratio**ORDER - 1))
    finer = Companion(made(0.1, 100 * nodes), other)
    assert finer.remains(run, order) == pytest.approx(1 / (1 - (ratio / 10) ** order))


# --- companions -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["ramp40_k210", "stroke_sub_10", "step_sub", "steady_line", "ramp_hold_1_5_mm"]
)
def test_companions_have_the_steps_of_the_run_all_or_every_second(name):
    """And outputs of the one are every second of the other's, as `thinned` takes them."""
    scene = load_scene(SCENES / f"{name}.yaml")
    own = plan(scene)
    mesh, both = companion(scene, own), companion(scene, own, 2)
    assert mesh.mesh_size == both.mesh_size and mesh.effects == both.effects == own.effects
    assert mesh.mesh_size.skin_edge == COARSER * own.mesh_size.skin_edge
    (_, coarse), (_, fine) = (np.array(p.mesh_size.focus).reshape(-1, 2).T for p in (mesh, own))
    np.testing.assert_array_equal(coarse, COARSER * fine)
    every, second = (list(schedule(scene, *each.stepping)) for each in (mesh, both))
    assert every == list(schedule(scene, *own.stepping))
    assert (mesh.outputs, both.outputs) == (len(every), len(second))
    if any(leg.fresh for leg in scene.motion):  # pressed anew
        expected = [step for step in every if step.fresh or step.leg == 0]
    else:
        legs = [0, *(step.leg for step in every)]
        told = xr.Dataset({"leg": ("time", legs)}, {"time": np.arange(len(legs))})
        expected = [every[k - 1] for k in thinned(told)["time"].values[1:]]
    what = attrgetter("leg", "distance", "force", "depth")
    assert list(map(what, second)) == list(map(what, expected))
    assert [s.time for s in second] == pytest.approx([s.time for s in expected])
    lasting = [sum(s.dt for s in steps if s.dt < 1e8) for steps in (second, every)]
    assert lasting[0] == pytest.approx(lasting[1])


def test_a_companion_passes_twice_the_way_and_no_coarser_events():
    """What lies between its states is judged as its mesh is: with twice the tolerance its steps
    jump over small bumps.
    """
    scene = load_scene(SCENES / "stroke_10.yaml")
    own = plan(scene)
    mesh, both = companion(scene, own), companion(scene, own, 2)
    (longest, tolerance), *others = own.between, mesh.between, both.between
    np.testing.assert_allclose(
        others, [(longest, COARSER * tolerance), (2 * longest, COARSER * tolerance)]
    )


def test_companions_of_a_press_find_its_errors():
    """Simulated: a press on an intermediate mesh, with its companions and with the truth on a finer
    one.
    """
    scene = load_scene(
        {
            "stimulus": {"shape": "cylinder", "curvature": "400 1/m"},
            "motion": [{"press_to_force": "10 gf", "rate": "40 gf/s"}, {"hold": "1 s"}],
            "accuracy": {"skin_edge": "0.25 mm", "steps": 16},
        },
        "press",
    )
    own = plan(scene)
    plans = own, companion(scene, own), companion(scene, own, 2)
    run, mesh, both = (simulate(scene, each) for each in plans)
    truth = simulate(scene, companion(scene, own, coarser=0.4))
    found, time = curve_errors(run, Companion(mesh, both), over_time(width)), run["time"].values
    true = 100 * norm(time, width(run) - width(truth)) / norm(time, width(run))
    assert 0.7 * true < found.mesh < 2.5 * true and found.mesh > found.steps
    assert both.sizes["time"] == 1 + 8 and set(both["time"].values) <= set(time)


# --- pictures -------------------------------------------------------------------------------------


def _rows(mesh=1.0, steps=0.5, sampled=0.1):
    rows = pd.DataFrame(
        {"source": "simulated", "x (mm)": np.linspace(0, 1, 11), "y (Pa)": np.full(11, 200.0)}
    )
    return rows.assign(**Errors(mesh, steps, sampled).columns)


def test_errors_above_two_per_cent_are_drawn_as_a_band_as_high_as_they_are():
    ax = Figure().add_subplot()
    line = axs.curve(ax, _rows(), "x (mm)", "y (Pa)", color="C3")
    assert not ax.collections  # 1.6 %
    axs.curve(ax, _rows(mesh=3.4), "x (mm)", "y (Pa)", color="C3")
    (band,) = ax.collections
    high, (*colour, opacity) = band.get_paths()[0].vertices[:, 1], band.get_facecolor()[0]
    assert (high.min(), high.max()) == pytest.approx((192, 208)) and opacity < 0.3
    assert line.get_color() == "C3" and colour == pytest.approx(to_rgb("C3"), abs=0.01)


def test_lines_of_one_family_share_one_error_and_one_that_hardly_rises_does_not_decide_it():
    """Mutant: the furthest line of all says that next to nothing is wrong by as much as it is."""
    size = 1000.0

    def two(h, dt):
        return solved(h, dt, 0.3, 0.0).assign(beside=solved(h, dt, size * 0.3, 0.0)["value"] / size)

    run, other = two(0.1, 0.02), Companion(two(0.1 * COARSER, 0.02), two(0.1 * COARSER, 0.04))
    strong, weak, flat = (
        over_time(lambda history, name=name, share=share: share * history[name].values)
        for name, share in (("value", 1.0), ("beside", 1.0), ("beside", 1e-9))
    )
    alone, beside = (curve_errors(run, other, line).mesh for line in (strong, weak))
    sizes = [norm(*line(run)) for line in (strong, weak)]
    truth = np.linalg.norm(np.array([alone, beside]) * sizes) / np.linalg.norm(sizes)
    assert family_errors(run, other, [strong, weak]).mesh == pytest.approx(truth)
    assert family_errors(run, other, [strong]).mesh == pytest.approx(alone)
    assert family_errors(run, other, [strong, flat]).mesh == pytest.approx(alone, rel=1e-6)
    assert np.isnan(family_errors(run, None, [strong]).mesh)


def test_the_error_stated_of_points_that_are_joined_is_that_of_their_line():
    """Relative to a point that is next to nothing an error tells nothing of the line through it."""
    rows = pd.DataFrame(
        {
            "line": ["a", "a", "b"],
            "shown": [0.01, 1.0, 2.0],
            PARTS[0]: [50.0, 1.0, 2.0],
            PARTS[1]: 0.0,
            PARTS[2]: 0.0,
        }
    )
    frame = pd.concat(
        [rows, pd.DataFrame({"line": ["a"], "shown": [7.0]})], ignore_index=True
    )  # not simulated
    found = axs.of_lines(frame, [("line", "shown")])
    assert found[PARTS[0]].tolist() == pytest.approx(
        [np.hypot(0.5, 1.0) / np.hypot(0.01, 1.0), 2.0]
    )
