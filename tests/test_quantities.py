"""Quantities: a quantity is its column's header, knows its unit, and is said once for figures, axes
and baselines.
"""

import pickle

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.measures import quantities as q
from cysyk1999.measures.runs import NINE, RIDGED, SPEEDS
from fingerpad.measures.features import energy
from fingerpad.units import parse_quantity
from regression import tolerance

pytestmark = pytest.mark.unit


def test_a_quantity_is_the_header_of_its_column():
    frame = pd.DataFrame({q.TIME: [0.0, 1.0], q.P_CENTRE: [1.0, 2.0]})
    assert (
        list(frame) == ["time (s)", "centre_pressure (Pa)"]
        and frame["centre_pressure (Pa)"].sum() == 3.0
    )
    assert type(pickle.loads(pickle.dumps(q.TIME))) is str


def test_values_are_in_the_unit_of_the_header():
    history = synthetic.history("ramp40_k210")
    assert q.DEPTH.read(history) == pytest.approx(
        history["indentation_depth"].values / parse_quantity("1 mm", "length")
    )
    with np.errstate(divide="ignore"):  # not touching yet
        assert q.WIDTH.read(history)[-1] * q.INVERSE_WIDTH.read(history)[-1] == pytest.approx(1.0)
    assert q.FORCE.read(history)[-1] == pytest.approx(20, rel=1e-4)
    assert q.NEWTON.read(history)[-1] == pytest.approx(parse_quantity("20 gf", "force"), rel=1e-4)
    assert q.P_SCALED.read(history) == pytest.approx(0.04 * q.P_CENTRE.read(history))


def test_a_quantity_read_at_a_depth_is_the_same_column():
    history = synthetic.history("ramp40_k210")
    deep = q.sed(915e-6)
    assert (
        deep == q.SED
        and hash(deep) == hash(q.SED)
        and (deep.label, deep.tolerance) == (q.SED.label, q.SED.tolerance)
    )
    assert np.array_equal(deep.read(history), energy(history, 915e-6)) and q.SED.read is None


def test_every_quantity_has_one_header_and_its_baseline_a_tolerance():
    assert len(q.QUANTITIES) == len({(each.name, each.unit) for each in q.QUANTITIES.values()})
    assert tolerance(q.P_CENTRE) == q.P_CENTRE.tolerance == 3e-3
    with pytest.raises(KeyError):
        tolerance(q.DYNAMIC)


def test_runs_name_their_scenes_and_whose_companions_are_read():
    assert NINE.only(("flat", "210")).scenes == {"flat": "ramp40_flat", "210": "ramp40_k210"}
    assert SPEEDS["10 mm/s"] == "stroke_10" and SPEEDS.companion_scenes == tuple(
        SPEEDS.scenes.values()
    )
    assert (
        RIDGED.companion_scenes == ("ridged_stroke_right",)
        and NINE.without_companions().companion_scenes == ()
    )
    with pytest.raises(KeyError):
        NINE.only(("80",))
