"""Hard cases converge with sound states, or fail cleanly with the last good state and a diagnosis.

Every case runs the default method through the same door a user has. "Sound" is the same for all: no
step cut unless said, a force that pushes, complementarity, det F well above zero and an energy
balance within the trapezoidal rule's reach.
"""

from functools import partial

import numpy as np
import pytest

from cysyk1999.studies.common.documents import RAMP, cylinder, depth, force, hold, scene_of
from fingerpad import simulate, simulation
from fingerpad.cli import main
from fingerpad.mechanics import stepping
from fingerpad.results import read_history, summary

pytestmark = pytest.mark.stability

MM = 1e-3


def scene(stimulus=None, motion=RAMP, **more):
    """A scene on a draft mesh, by default a cylinder of 210 1/m pressed and held."""
    document = {"stimulus": stimulus or cylinder(209.97), "motion": list(motion)}
    return scene_of(document | {"accuracy": "draft"} | more, "hard")


def sound(history, cuts=0, energy=0.02):
    """Assert that every state of a history is sound; returns its summary."""
    run = summary(history)["run"]
    assert run["cutbacks"] <= cuts, f"{run['cutbacks']} cuts"
    assert run["complementarity_error"] < 1e-3, "a gap under a force, or a pull"
    assert run["min_detF"] > 0.1, f"det F falls to {run['min_detF']:.2f}"
    lost = run["energy_balance_error"]
    assert lost < energy, f"energy is off by {lost:.1%}"
    assert history.contact_pressure.min() >= 0 and (history.force >= 0).all()
    assert np.isfinite(history.to_array().values).all()
    return summary(history)


@pytest.mark.parametrize("nu", [0.48, 0.49999])
def test_pressure_does_not_oscillate(nu):
    """Nodal pressures under a cylinder stay within 2 % of their own 5-point average away from the
    edge.
    """
    layers = {name: {"poisson_ratio": nu} for name in ("epidermis", "dermis", "fat")}
    history = simulate(scene(motion=RAMP[:1], specimen={"layers": layers}, accuracy="thesis"))
    end = history.isel(time=-1)
    inside = np.abs(end.skin_x) < 0.7 * float(end.contact_width) / 2
    ripple = np.abs(end.contact_pressure - end.contact_pressure_smoothed)[inside]
    assert ripple.max() < 0.02 * float(end.centre_pressure)


def test_whole_load_in_one_step():
    """20 gram-weight at once end where 40 increments end."""
    single, many = (
        simulate(scene(motion=[force(20)], accuracy={"skin_edge": "268.8 um", "steps": steps}))
        for steps in (1, 8)
    )
    assert int(single.newton_iterations.sum()) <= 6 and int(single.cutbacks.sum()) == 0
    depths = (float(history.indentation_depth[-1]) for history in (single, many))
    assert next(depths) == pytest.approx(next(depths), rel=1e-4)


def test_change_of_control():
    """From force to depth control and on from the depth that was reached."""
    motion = force(20, 40), depth(1.0, 1.0), hold(0.5)
    first, second, _ = sound(simulate(scene(motion=motion)))["legs"]
    assert second["depth_mm"] == pytest.approx(1.0)
    assert second["force_N_per_m"] > first["force_N_per_m"]


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


def fails_cleanly(document, folder, capsys):
    """Run a scene from its file, as a user does; the last state that it saved, or None where it
    completes. Exit 3: when, what failed and what to try in one line, and a readable last converged
    state.
    """
    (folder / "case.yaml").write_text(document)
    out = folder / "out"
    code = main(["run", str(folder / "case.yaml"), "--out", str(out), "--quiet"])
    if code == 0:
        return None
    said = capsys.readouterr().err
    assert code == 3 and said.count("\n") == 1
    assert all(word in said for word in ("no convergence after t =", "try", "last_converged.nc"))
    assert sorted(path.name for path in out.iterdir()) == ["last_converged.nc", "plan.json"]
    saved = read_history(out / "last_converged.nc")
    assert not saved.attrs["complete"] and np.isfinite(saved.to_array().values).all()
    assert float(saved.complementarity_error.max()) < 1e-3
    return saved


def test_failure_saves_the_last_state_and_names_the_cause(starved, tmp_path, capsys):
    assert 0 < float(fails_cleanly(PRESS, tmp_path, capsys).force[-1]) < 98
