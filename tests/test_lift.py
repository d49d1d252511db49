"""A finger that is let go: an elastic pad comes back to rest, a viscous one recovers with its Prony
series.
"""

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.planning.plan import schedule

pytestmark = pytest.mark.verification

COARSE = {"skin_edge": "0.6 mm", "steps": 24}
PLATE, ROUND = {"shape": "flat"}, {"shape": "cylinder", "curvature": "210 1/m"}


def history(*motion, stimulus=ROUND, accuracy=COARSE, **keys):
    return simulate(
        load_scene({"stimulus": stimulus, "motion": list(motion), "accuracy": accuracy, **keys})
    )


@pytest.mark.parametrize("press", [{"press_to_force": "20 gf"}, {"press_to_depth": "0.5 mm"}])
def test_an_elastic_pad_comes_back_to_rest_the_way_it_went(press):
    """Under either control: nothing is left after the lift, the way down and the way up are one,
    and all the work comes back.
    """
    down_and_up = history(press, {"lift": "steady"}, press)
    end = down_and_up.isel(time=np.flatnonzero(down_and_up.leg == 1)[-1])
    top = down_and_up.isel(time=np.flatnonzero(down_and_up.leg == 0)[-1])
    assert float(end.indentation_depth) == 0.0
    assert abs(float(end.force)) < 1e-6 * float(top.force)
    assert float(abs(end.skin_displacement_y).max()) < 1e-6 * float(top.indentation_depth)
    assert float(abs(end.strain_energy_density).max()) < 1e-9 * float(
        top.strain_energy_density.max()
    )
    assert abs(float(end.stored_energy)) < 1e-9 * float(top.stored_energy)
    force, depth, leg = (down_and_up[name].values for name in ("force", "indentation_depth", "leg"))
    np.testing.assert_allclose(
        np.interp(depth[leg == 1][::-1], depth[leg == 0], force[leg == 0]),
        force[leg == 1][::-1],
        rtol=0.05,
        atol=0.02 * force.max(),
    )
    assert force[-1] == pytest.approx(float(top.force), rel=1e-6)
    assert depth[-1] == pytest.approx(float(top.indentation_depth), rel=1e-6)
    assert float(abs(end.external_work)) < 0.02 * float(top.external_work), (
        "what was put in is given back"
    )
    assert float(down_and_up.attrs["estimated_error"]) < 0.6, (
        "a finger let go has no contact to be unsure of"
    )


def test_a_viscous_pad_recovers_with_its_prony_series():
    """Let go at once, a nearly incompressible pad creeps back: one branch g, tau recovers as
    exp(-(1 - g) t / tau).

    Without load ``u + beta v = 0`` and ``v' = u' - v / tau`` with beta = g / (1 - g), for the shape
    is that of the whole field (Findley, Lai and Onaran 1976, section 5.3: the retardation time of a
    standard solid is tau (1 + beta)).
    """
    g, tau = 0.4, 1.0
    layers = {name: {"poisson_ratio": 0.4999} for name in ("epidermis", "dermis", "fat")}
    made = history(
        {"press_to_depth": "20 um", "speed": "0.02 mm/s"},
        {"lift": "20 mm/s"},
        {"hold": "4 s"},
        stimulus=PLATE,
        specimen={"layers": layers, "prony": [{"g": g, "tau": f"{tau:g} s"}]},
        accuracy={"skin_edge": "0.8 mm", "steps": 120},
        effects={"finite_strain": False, "viscoelasticity": True},
    )
    held = made.isel(time=made.leg.values == 2)
    assert (
        not held.force.any()
        and not held.contact_width.any()
        and float(abs(held.indentation_depth).max()) == 0.0
    )
    dent = -held.skin_displacement_y.sel(skin_arc=0, method="nearest").values
    start, way = held.time.values[0], held.time.values - held.time.values[0]
    assert start > 1.0 and dent[0] > 1e-6
    np.testing.assert_allclose(dent / dent[0], np.exp(-(1 - g) * way / tau), atol=0.01)
    rest = made.external_work - made.stored_energy - made.dissipated_energy
    assert abs(float(rest[-1])) < 0.05 * float(made.external_work.max())


def test_loops_dissipate_what_they_enclose():
    """Load, unload in part, load again and let go under force control: work less stored energy is
    dissipated, and grows.
    """
    made = history(
        {"press_to_force": "20 gf", "rate": "40 gf/s"},
        {"press_to_force": "5 gf", "rate": "40 gf/s"},
        {"press_to_force": "20 gf", "rate": "40 gf/s"},
        {"lift": "2 mm/s"},
        {"hold": "10 s"},
        accuracy={"skin_edge": "0.6 mm", "steps": 60},
    )
    most = float(made.external_work.max())
    rest = made.external_work - made.stored_energy - made.dissipated_energy
    assert float(abs(rest).max()) < 0.05 * most and float(made.energy_balance_error[-1]) < 0.2
    assert np.all(np.diff(made.dissipated_energy) > -1e-3 * most)
    assert float(made.force[-1]) == float(made.contact_width[-1]) == 0.0
    assert float(abs(made.skin_displacement_y[-1]).max()) < 0.01 * float(
        made.indentation_depth.max()
    )


def test_a_stroke_ends_where_the_surface_no_more_touches():
    """After a way over a wavy surface, zero depth is not where the skin is let go: the lift goes to
    where it is.
    """
    scene = load_scene(
        {
            "stimulus": {"shape": "wavy", "curvatures": ["100 1/m", "200 1/m"], "lead_in": "4 mm"},
            "friction": 0.3,
            "motion": [{"press_to_force": "10 gf"}, {"slide": "5 mm"}, {"lift": "steady"}],
            "accuracy": {"skin_edge": "0.8 mm", "steps": 24},
        }
    )
    made = simulate(scene, plan(scene))
    assert float(made.force[-1]) < 1e-6 * float(made.force.max()) and float(
        made.stroke_distance[-1]
    ) == pytest.approx(5e-3)
    assert abs(float(made.indentation_depth[-1])) > 20e-6
    assert float(abs(made.skin_displacement_y[-1]).max()) < 1e-6


def test_steps_of_a_lift():
    """From the depth that was reached to touch, at the speed; a steady one takes no time; a hold
    stays there.
    """
    scene = load_scene(
        {
            "stimulus": ROUND,
            "motion": [
                {"press_to_force": "20 gf", "rate": "40 gf/s"},
                {"lift": "1 mm/s"},
                {"hold": "1 s"},
            ],
        }
    )
    steps = list(schedule(scene, 4, True, present=lambda: (19.6, 0.8e-3, 0.1e-3)))
    lift, hold = ([step for step in steps if step.leg == leg] for leg in (1, 2))
    assert [step.depth for step in lift] == pytest.approx(
        [0.625e-3, 0.45e-3, 0.275e-3, 0.1e-3]
    ) and lift[0].force is None
    assert lift[-1].time - lift[0].time == pytest.approx(0.525) and {
        step.depth for step in hold
    } == {0.1e-3}
    assert scene.end_time is None
    deep = load_scene(
        {
            "stimulus": ROUND,
            "motion": [
                {"press_to_depth": "1 mm", "speed": "1 mm/s"},
                {"lift": "2 mm/s"},
                {"hold": "1 s"},
            ],
        }
    )
    assert deep.end_time == pytest.approx(2.5)
