"""Hard cases converge with sound states, or fail cleanly with the last good state and a diagnosis.

Every case runs the default method through the same door a user has. "Sound" is the same for all: no step cut unless said, a
force that pushes, complementarity, det F well above zero and an energy balance within the trapezoidal rule's reach.
"""

from pathlib import Path

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.cli import main
from fingerpad.mechanics import finite_strain, stepping
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.results import read_history, summary
from fingerpad.scene import Bar, Cylinder, Discretisation, Flat, Hold, Layer, Layers, Line, PressToDepth, PressToForce

pytestmark = pytest.mark.stability

SCENES = Path(__file__).parents[2] / "config" / "scenes"
GF = 9.80665e-3
MM = 1e-3
MIDDLE = Cylinder(curvature=209.97)
COARSE = 268.8e-6


@pytest.fixture(scope="module")
def base():
    return load_scene(SCENES / "ramp40_k210.yaml").with_accuracy("draft")


def force(gram_weight, rate=None):
    return PressToForce(press_to_force=gram_weight * GF, rate=None if rate is None else rate * GF)


def depth(millimetres, speed=None):
    return PressToDepth(press_to_depth=millimetres * MM, speed=None if speed is None else speed * MM)


def scene(base, stimulus=MIDDLE, motion=None, nu=0.48, epidermis=0.15e6, accuracy="draft", **effects):
    motion = motion or (force(20, 40), Hold(hold=2.0))
    moduli = {"epidermis": epidermis, "dermis": 0.015e6, "fat": 0.015e6}
    layers = Layers(**{name: Layer(youngs_modulus=e, poisson_ratio=nu) for name, e in moduli.items()})
    specimen = base.specimen.model_copy(update={"layers": layers})
    changes = {"specimen": specimen, "stimulus": stimulus, "motion": motion, "accuracy": accuracy, "effects": effects}
    return base.model_copy(update=changes)


def sound(history, cuts=0, energy=0.02):
    """Assert that every state of a history is sound; returns its summary."""
    run = summary(history)["run"]
    assert run["cutbacks"] <= cuts, f"{run['cutbacks']} cuts"
    assert run["complementarity_error"] < 1e-3, "a gap under a force, or a pull"
    assert run["min_detF"] > 0.1, f"det F falls to {run['min_detF']:.2f}"
    assert run["energy_balance_error"] < energy, f"energy is off by {run['energy_balance_error']:.1%}"
    assert history.contact_pressure.min() >= 0 and (history.force >= 0).all()
    assert np.isfinite(history.to_array().values).all()
    return summary(history)


@pytest.mark.parametrize("nu", [0.48, 0.499, 0.4999, 0.49999])
@pytest.mark.parametrize("stimulus", [Flat(), Cylinder(curvature=1259.84)], ids=["flat", "1260"])
def test_near_incompressibility(base, stimulus, nu):
    """No Poisson's ratio up to 0.49999 costs cuts, and the depth hardly depends on it."""
    legs = sound(simulate(scene(base, stimulus, nu=nu)))["legs"]
    reference = sound(simulate(scene(base, stimulus, nu=0.4999)))["legs"]
    assert legs[-1]["depth_mm"] == pytest.approx(reference[-1]["depth_mm"], rel=0.1)


@pytest.mark.parametrize("nu", [0.48, 0.49999])
def test_pressure_does_not_oscillate(base, nu):
    """Nodal pressures under a cylinder stay within 2 % of their own 5-point average away from the edge."""
    end = simulate(scene(base, nu=nu, accuracy="thesis")).isel(time=-1)
    inside = np.abs(end.skin_x) < 0.7 * float(end.contact_width) / 2
    ripple = np.abs(end.contact_pressure - end.contact_pressure_smoothed)[inside] / float(end.centre_pressure)
    assert ripple.max() < 0.02


@pytest.mark.parametrize("curvature", [2.5e3, 5e3, 1e4])
def test_needles(base, curvature):
    """Sharper than any thesis shape, down to a radius below the node spacing: the plan refines and the solver follows."""
    history = simulate(scene(base, Cylinder(curvature=curvature)))
    assert sound(history)["legs"][-1]["depth_mm"] == pytest.approx(0.93, abs=0.1)


def test_needle_on_a_mesh_too_coarse_for_it_says_so(base):
    """Where the user insists on a mesh coarser than the needle, the run fails or admits that it cannot be trusted."""
    by_hand = Discretisation(element=None, skin_edge=COARSE, steps=8)
    try:
        history = simulate(scene(base, Cylinder(curvature=1e4), (force(20),), accuracy=by_hand))
    except NonConvergence as failure:
        assert failure.dataset is not None and "finer mesh" in failure.advice
    else:
        assert history.attrs["estimated_error"] >= 0.5


@pytest.mark.parametrize(
    "stimulus",
    [Bar(width=1.5875e-3, fillet=0.1e-3), Bar(width=1.5875e-3, fillet=0.03e-3), Bar(width=1.5875e-3), Line()],
    ids=["fillet 0.1 mm", "fillet 0.03 mm", "sharp bar", "line"],
)
@pytest.mark.parametrize("target", [1.0, 2.0])
def test_edges(base, stimulus, target):
    """The 1/16 inch bar, rounded or sharp, and the line load reach 2 mm; their peak pressure is marked singular."""
    totals = sound(simulate(scene(base, stimulus, (depth(target),), accuracy="thesis")))
    assert totals["legs"][-1]["depth_mm"] == pytest.approx(target) and totals["run"]["peak_pressure_singular"]


@pytest.mark.parametrize("nu", [0.48, 0.4999])
@pytest.mark.parametrize("stimulus", [Flat(), MIDDLE], ids=["flat", "210"])
def test_deep_press(base, stimulus, nu):
    """3 mm into 5.5 mm of soft tissue."""
    sound(simulate(scene(base, stimulus, (depth(3.0),), nu=nu)))


@pytest.mark.parametrize("epidermis", [1.5e3, 150e6], ids=["soft skin", "10^4 contrast"])
def test_layer_contrast(base, epidermis):
    """An epidermis ten times softer than, or 10^4 times as stiff as, what is below."""
    sound(simulate(scene(base, Flat(), (force(2, 40), Hold(hold=2.0)), epidermis=epidermis)))


def test_whole_load_in_one_step(base):
    """20 gram-weight at once end where 40 increments end."""
    single, many = (
        simulate(scene(base, motion=(force(20),), accuracy=Discretisation(element=None, skin_edge=COARSE, steps=steps)))
        for steps in (1, 8)
    )
    assert int(single.newton_iterations.sum()) <= 6 and int(single.cutbacks.sum()) == 0
    assert float(single.indentation_depth[-1]) == pytest.approx(float(many.indentation_depth[-1]), rel=1e-4)


@pytest.mark.parametrize("share", [1e-4, 1.0, 1e3])
def test_step_sizes_against_the_time_constants(base, share):
    """Holds in steps of 1e-4 to 1e3 times the longest time constant stay between the two elastic limits."""
    motion = (force(20, 40), Hold(hold=10 * share * 3.25))
    history = simulate(scene(base, motion=motion))
    sound(history, energy=0.05)
    depths = history.indentation_depth.values[10:]
    assert np.all(np.diff(depths) > -1e-9) and 0.5e-3 < depths.min() < depths.max() < 0.76e-3


@pytest.mark.parametrize("rate", [1e-3, 40.0, 1e4])
def test_force_rates(base, rate):
    """Ramps from five hours to two milliseconds."""
    sound(simulate(scene(base, motion=(force(20, rate), Hold(hold=1.0)), viscoelasticity=True)))


@pytest.mark.parametrize("stimulus", [Flat(), MIDDLE], ids=["flat", "210"])
def test_unloading_almost_to_separation(base, stimulus):
    """Back from 20 to 0.01 gram-weight, and down again."""
    motion = (force(20, 40), force(0.01, 400), Hold(hold=0.5), force(20, 40))
    legs = sound(simulate(scene(base, stimulus, motion)))["legs"]
    assert legs[1]["contact_width_mm"] < 0.2 * legs[0]["contact_width_mm"]
    assert legs[3]["force_N_per_m"] == pytest.approx(19.6133)


def test_separation_and_return(base):
    """An indenter drawn back faster than the skin can follow leaves it, and finds it again."""
    motion = (depth(1.0, 2.0), Hold(hold=3.0), depth(0.05, 100.0), Hold(hold=0.2), depth(1.0, 2.0))
    history = simulate(scene(base, motion=motion))
    legs = sound(history, energy=0.05)["legs"]
    assert legs[2]["force_N_per_m"] == 0 and legs[2]["contact_width_mm"] == 0
    assert legs[4]["force_N_per_m"] > 10


def test_change_of_control(base):
    """From force to depth control and on from the depth that was reached."""
    legs = sound(simulate(scene(base, motion=(force(20, 40), depth(1.0, 1.0), Hold(hold=0.5)))))["legs"]
    assert legs[1]["depth_mm"] == pytest.approx(1.0) and legs[1]["force_N_per_m"] > 19.6


def test_featherweight(base):
    """A ten-thousandth of a gram-weight, carried by a single node."""
    history = simulate(scene(base, motion=(force(1e-4),)))
    assert np.count_nonzero(history.contact_pressure[-1]) <= 3
    assert float(history.force[-1]) == pytest.approx(1e-4 * GF / 10e-3)


def test_the_lagged_pressure_is_what_makes_one_step_enough(base, monkeypatch):
    """Mutant: with plain Newton the same load at nu = 0.4999 in one step needs cuts or more than six iterations."""
    plain = finite_strain.FiniteStrainBody.__init__
    monkeypatch.setattr(
        finite_strain.FiniteStrainBody, "__init__", lambda self, *a, **k: plain(self, *a, **{**k, "lagged": False})
    )
    by_hand = Discretisation(element=None, skin_edge=COARSE, steps=1)
    try:
        history = simulate(scene(base, Flat(), (force(20),), nu=0.4999, accuracy=by_hand))
    except NonConvergence:
        return
    assert int(history.newton_iterations.sum()) > 6 or int(history.cutbacks.sum()) > 0


# -- what cannot be done fails cleanly ----------------------------------------------------------------------------------------


PRESS = """
stimulus: {shape: flat}
motion:
  - {press_to_force: "0.001 gf", rate: "0.1 gf/s"}
  - {press_to_force: "100 gf", rate: "400 gf/s"}
accuracy: draft
"""


@pytest.fixture
def starved(monkeypatch):
    """A solver that may iterate once and halve a step twice: enough for a light touch, not for 100 gram-weight."""
    settings = stepping.NewtonSettings(max_iterations=1, snap_iterations=0, max_halvings=2)
    monkeypatch.setattr(stepping, "NewtonSettings", lambda: settings)


def test_failure_saves_the_last_state_and_names_the_cause(starved, tmp_path, capsys):
    """Exit 3: when, what failed and what to try in one line, and a readable last converged state."""
    (tmp_path / "press.yaml").write_text(PRESS)
    assert main(["run", str(tmp_path / "press.yaml"), "--out", str(tmp_path / "out"), "--quiet"]) == 3
    message = capsys.readouterr().err
    assert (
        message.count("\n") == 1 and "no convergence after t =" in message and "try" in message and "last_converged.nc" in message
    )
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["last_converged.nc", "plan.json"]
    saved = read_history(tmp_path / "out" / "last_converged.nc")
    assert not saved.attrs["complete"] and 0 < float(saved.force[-1]) < 98
    assert np.isfinite(saved.to_array().values).all() and float(saved.complementarity_error.max()) < 1e-3


def test_needle_through_the_pad_fails_cleanly(base):
    """A needle driven 4 mm deep: nodes pop round it and elements fold; the history ends with the last sound state."""
    hopeless = scene(base, Cylinder(curvature=6e4), (depth(0.2, 1.0), depth(4.0, 1.0)), nu=0.4999)
    with pytest.raises(NonConvergence) as caught:
        simulate(hopeless, plan(hopeless))
    assert caught.value.reason and "finer" in caught.value.advice
    kept = caught.value.dataset
    assert kept.sizes["time"] > 5 and float(kept.energy_balance_error[-1]) < 0.05
    assert float(kept.min_detF.min()) > 0 and np.isfinite(kept.force).all()
    assert kept.attrs["estimated_error"] >= 0.5
