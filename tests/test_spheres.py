"""The study of what is round: domes fitted to forces, and rates under spheres."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from cysyk1999.measures.quantities import CURVATURE, GIVEN_RATE
from cysyk1999.studies.receptors.impulse_rates import matched_histories
from cysyk1999.studies.spheres import domes, rates
from cysyk1999.studies.spheres.domes import DEPTH, FORCE, Unknowns, judged, shared_shape
from fingerpad import simulate
from fingerpad.receptors.laws import ImpulseRate

pytestmark = pytest.mark.unit

SHAPE = np.array([0.02, 0.1, 0.3, 0.7])
SPECIMEN = {
    "outline": {
        "apex_height": "6 mm",
        "epidermis_thickness": "0.8 mm",
        "dermis_thickness": "0.7 mm",
        "bone_centre_height": "-2 mm",
        "bone_half_height": "2 mm",
    },
    "layers": {"fat": {"youngs_modulus": "20 kPa", "poisson_ratio": 0.48}},
    "moduli": "instantaneous",
}


def _made_up(factors):
    """Curves of two probes and a point, and forces of subjects that are those times a factor."""
    depth = np.linspace(0, 3, 61)
    curves = {
        probe: pd.DataFrame({DEPTH: depth, FORCE: scale * depth**2})
        for probe, scale in (("plate", 1.0), ("6.35 mm probe", 0.4), ("point probe", 0.1))
    }
    rows = [
        {"probe": probe, "subject": who, DEPTH: d, FORCE: factor * scale * d**2}
        for who, factor in factors.items()
        for probe, scale in (("plate", 1.0), ("6.35 mm probe", 0.4), ("point probe", 0.2))
        for d in (0.5, 1.0, 1.5, 2.0)
    ]
    return curves, pd.DataFrame(rows)


def test_subjects_of_one_shape_are_told_by_a_factor_alone():
    assert shared_shape(np.outer([1, 2, 5], SHAPE)) == pytest.approx(1, abs=1e-12)


def test_no_shape_times_a_factor_beats_the_bound():
    rng = np.random.default_rng(3)
    forces = np.outer([1, 2, 5], SHAPE) * rng.uniform(0.8, 1.25, (3, 4))
    bound = shared_shape(forces)

    def mean_r2(shape):
        left = [f - (f @ shape) / (shape @ shape) * shape for f in forces]
        return 1 - np.mean([(e @ e) / (f.var() * 4) for e, f in zip(left, forces, strict=True)])

    tried = [mean_r2(SHAPE * rng.uniform(0.7, 1.4, 4)) for _ in range(2000)]
    assert bound - 0.02 < max(tried) <= bound < 1


def test_factors_come_back_and_the_point_is_no_part_of_the_fit():
    curves, forces = _made_up({"1": 0.5, "2": 2.0})
    table = pd.DataFrame(judged(curves, forces)).set_index("subject")
    np.testing.assert_allclose(table["modulus factor"], [0.5, 2.0], rtol=2e-3)
    assert (table["R2, plate and probe"] > 0.9999).all()
    assert (table["R2, point probe"] < 0.6).all()  # made up twice as stiff as the dome's
    assert set(table["forces fitted"]) == {8} and set(table["forces predicted"]) == {4}


def test_a_dome_has_the_fat_and_the_moduli_that_are_asked_for():
    unknowns = Unknowns({"apex_radius": (5, 10, 20), "fat": (1, 3, 4)}, SPECIMEN)
    dome = unknowns.dome(np.log([12, 2.5]), 3.0)
    outline = {name: float(size.split()[0]) for name, size in dome["outline"].items()}
    top = outline["bone_centre_height"] + outline["bone_half_height"]
    assert outline["apex_radius"] == 12
    assert top == pytest.approx(6 - 0.8 - 0.7 - 2.5)
    assert outline["bone_centre_height"] - outline["bone_half_height"] == pytest.approx(-4)
    assert dome["layers"]["fat"]["youngs_modulus"] == "60 kPa"


@pytest.fixture(scope="module")
def spheres():
    """A plate and spheres at 10 and 15 gf on a soft disc, with receptors at three distances."""
    layer = {"name": "gel", "thickness": "4 mm", "youngs_modulus": "60 kPa"}
    made = []
    for force in (10, 15):
        for curvature in (80.6, 340, 694):
            scene = {
                "kinematics": "axisymmetric",
                "specimen": {"slab": {"width": "24 mm", "layers": [layer]}},
                "stimulus": {"shape": "sphere", "curvature": f"{curvature} 1/m"},
                "motion": [
                    {"press_to_force": f"{force} gf", "rate": "40 gf/s"},
                    {"hold": f"{1 - force / 40} s"},
                ],
                "outputs": {"receptors": {"depths": ["915 um"], "offsets": ["0 mm", "1 mm"]}},
                "accuracy": "draft",
            }
            made.append(simulate(scene))
    return rates.spheres_of(made)


def _rows(spheres, law, distance=0.0):
    rows = pd.DataFrame(list(spheres), columns=["force (gf)", CURVATURE])
    rows[rates.DISTANCE] = distance
    return rows.assign(**{GIVEN_RATE: rates.asked(spheres, rows, law)})


def test_constants_fitted_at_one_force_give_rates_of_the_law_at_another_and_beside(spheres):
    law = ImpulseRate(0.05, 0.0182, 120.0, 100.0)
    held, beside = _rows(spheres, law), _rows(spheres, law, -1.0)
    assert beside[GIVEN_RATE].max() < held[GIVEN_RATE].max()
    table = pd.DataFrame(rates.judged(spheres, held, beside))
    own = table[table["law"] == "Eq 5-1"]
    assert own["rms error (impulses/s)"].max() < 1e-2
    np.testing.assert_allclose(own["A1 ((impulses/s)/Pa)"], 0.05, rtol=1e-3)
    assert own.set_index("rates")["role"]["15 gf"] == "fitted"
    other = table[table["law"] != "Eq 5-1"]  # the wrong law leaves something over
    assert other["rms error (impulses/s)"].max() > 0.5


def test_spheres_stand_for_spheres_and_cylinders_where_there_are_none(monkeypatch):
    def found(stimulus, names):
        rows = pd.DataFrame({"force_gf": [15.0], "ramp_gf_per_s": [np.nan], "stimulus": [stimulus]})
        histories = {name: SimpleNamespace(name=name) for name in names}
        module = "cysyk1999.studies.receptors.impulse_rates"
        monkeypatch.setattr(f"{module}.force_gf", lambda history: [15.0])
        monkeypatch.setattr(f"{module}.curvature_of", lambda history: history.name)
        matched = matched_histories(histories, rows)
        return {history.name.split("_")[0] for history in matched[15.0]}

    both = [f"spheres_15_k{k}" for k in (81, 172, 256, 340)] + [
        f"press15_k{k}" for k in (79, 158, 315, 630)
    ]
    assert found("sphere", both) == {"spheres"}
    assert found("cylinder", both) == {"press15"}
    assert found("sphere", both[4:]) == {"press15"}


def test_a_dome_that_cannot_be_pressed_is_a_bad_one_not_an_end(monkeypatch):
    curves, forces = _made_up({"1": 0.5})
    forces["scene"] = [{}] * len(forces)
    unknowns = Unknowns({"apex_radius": (5, 10, 20), "fat": (1, 3, 4)}, SPECIMEN)
    calls = []

    def of_dome(specimen, forces, probes):
        calls.append(specimen)
        if len(calls) == 2:
            raise domes.NonConvergence(0.0, "made up", "another")
        return curves

    monkeypatch.setattr(domes, "of_dome", of_dome)
    assert np.isfinite(domes.fit_domes(unknowns, forces)).all() and len(calls) > 2
