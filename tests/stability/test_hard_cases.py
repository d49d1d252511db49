"""Hard cases converge with sound states, or fail cleanly with the last good state and a diagnosis.

Every case runs the default method through the same door a user has. "Sound" is the same for all: no
step cut unless said, a force that pushes, complementarity, det F well above zero and an energy
balance within the trapezoidal rule's reach.
"""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

from fingerpad import load_scene, simulate, simulation
from fingerpad.cli import main
from fingerpad.mechanics import stepping
from fingerpad.results import read_history, summary
from fingerpad.scenes.scene import (
    Cylinder,
    Discretisation,
    Hold,
    Layer,
    Layers,
    PressToDepth,
    PressToForce,
)

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
    return PressToDepth(
        press_to_depth=millimetres * MM, speed=None if speed is None else speed * MM
    )


def scene(
    base, stimulus=MIDDLE, motion=None, nu=0.48, epidermis=0.15e6, accuracy="draft", **effects
):
    motion = motion or (force(20, 40), Hold(hold=2.0))
    moduli = {"epidermis": epidermis, "dermis": 0.015e6, "fat": 0.015e6}
    layers = Layers(
        **{name: Layer(youngs_modulus=e, poisson_ratio=nu) for name, e in moduli.items()}
    )
    specimen = base.specimen.model_copy(update={"layers": layers})
    changes = {
        "specimen": specimen,
        "stimulus": stimulus,
        "motion": motion,
        "accuracy": accuracy,
        "effects": effects,
    }
    return base.model_copy(update=changes)


def sound(history, cuts=0, energy=0.02):
    """Assert that every state of a history is sound; returns its summary."""
    run = summary(history)["run"]
    assert run["cutbacks"] <= cuts, f"{run['cutbacks']} cuts"
    assert run["complementarity_error"] < 1e-3, "a gap under a force, or a pull"
    assert run["min_detF"] > 0.1, f"det F falls to {run['min_detF']:.2f}"
    assert run["energy_balance_error"] < energy, (
        f"energy is off by {run['energy_balance_error']:.1%}"
    )
    assert history.contact_pressure.min() >= 0 and (history.force >= 0).all()
    assert np.isfinite(history.to_array().values).all()
    return summary(history)


@pytest.mark.parametrize("nu", [0.48, 0.49999])
def test_pressure_does_not_oscillate(base, nu):
    """Nodal pressures under a cylinder stay within 2 % of their own 5-point average away from the
    edge.
    """
    end = simulate(scene(base, motion=(force(20, 40),), nu=nu, accuracy="thesis")).isel(time=-1)
    inside = np.abs(end.skin_x) < 0.7 * float(end.contact_width) / 2
    ripple = np.abs(end.contact_pressure - end.contact_pressure_smoothed)[inside] / float(
        end.centre_pressure
    )
    assert ripple.max() < 0.02


def test_whole_load_in_one_step(base):
    """20 gram-weight at once end where 40 increments end."""
    single, many = (
        simulate(
            scene(
                base,
                motion=(force(20),),
                accuracy=Discretisation(element=None, skin_edge=COARSE, steps=steps),
            )
        )
        for steps in (1, 8)
    )
    assert int(single.newton_iterations.sum()) <= 6 and int(single.cutbacks.sum()) == 0
    assert float(single.indentation_depth[-1]) == pytest.approx(
        float(many.indentation_depth[-1]), rel=1e-4
    )


def test_change_of_control(base):
    """From force to depth control and on from the depth that was reached."""
    legs = sound(simulate(scene(base, motion=(force(20, 40), depth(1.0, 1.0), Hold(hold=0.5)))))[
        "legs"
    ]
    assert (
        legs[1]["depth_mm"] == pytest.approx(1.0)
        and legs[1]["force_N_per_m"] > legs[0]["force_N_per_m"]
    )


# -- what cannot be done fails cleanly ---


PRESS = """
stimulus: {shape: flat}
motion:
  - {press_to_force: "0.001 gf", rate: "0.1 gf/s"}
  - {press_to_force: "100 gf", rate: "400 gf/s"}
accuracy: draft
"""


@pytest.fixture
def starved(monkeypatch):
    """A solver that may iterate once and halve a step twice: enough for a light touch, not for 100
    gram-weight.
    """
    few = partial(simulation.NewtonSettings, max_iterations=1)
    monkeypatch.setattr(simulation, "NewtonSettings", few)
    monkeypatch.setattr(stepping, "SNAP_ITERATIONS", 0)
    monkeypatch.setattr(stepping, "MAX_HALVINGS", 2)


def test_failure_saves_the_last_state_and_names_the_cause(starved, tmp_path, capsys):
    """Exit 3: when, what failed and what to try in one line, and a readable last converged
    state.
    """
    (tmp_path / "press.yaml").write_text(PRESS)
    assert (
        main(["run", str(tmp_path / "press.yaml"), "--out", str(tmp_path / "out"), "--quiet"]) == 3
    )
    message = capsys.readouterr().err
    assert (
        message.count("\n") == 1
        and "no convergence after t =" in message
        and "try" in message
        and "last_converged.nc" in message
    )
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "last_converged.nc",
        "plan.json",
    ]
    saved = read_history(tmp_path / "out" / "last_converged.nc")
    assert not saved.attrs["complete"] and 0 < float(saved.force[-1]) < 98
    assert (
        np.isfinite(saved.to_array().values).all()
        and float(saved.complementarity_error.max()) < 1e-3
    )
