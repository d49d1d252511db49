"""Calibration of friction to the stretch of the skin: a known law given back, what is refused, what
is committed.
"""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from cysyk1999.reference_data import ReferenceDataError, read_friction
from cysyk1999.studies.calibration.friction import (
    AXIS,
    STRETCH,
    STROKE,
    VARIATIONS,
    StretchCurve,
    calibrate_friction,
    rounded,
    stretch,
)
from fingerpad import load_scene
from fingerpad.scenes.families import read_family

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "config" / "reference"
SWEEP = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
NUMBERS = pd.DataFrame({"id": [STRETCH, AXIS], "low": [1.0, -1.25], "high": [np.nan, -0.5]})


@cache
def surface():
    return load_scene(ROOT / "config" / "scenes" / f"{STROKE}.yaml")


def history(coefficient, law=lambda mu: 1.5e-3 * mu, ripple=0.1, way=50e-3, start=0.0, name=STROKE):
    """A stroke that drags the centre by law(mu) in the mean over the waves; one whole period of a
    ripple about it.
    """
    ends = surface().stimulus.lead_in, surface().stimulus.length - surface().stimulus.run_out
    x = np.concatenate(
        [
            [start],
            np.sort(
                np.concatenate([np.linspace(start, way, 400), [end for end in ends if end < way]])
            ),
        ]
    )
    drag = law(coefficient) * (1 + ripple * np.sin(2 * np.pi * (x - ends[0]) / (ends[1] - ends[0])))
    drag = np.where((x < ends[0]) | (x > ends[1]), 0.2 * drag, drag)  # the flats must not count
    scene = surface().canonical() | {"friction": coefficient, "name": name}
    return xr.Dataset(
        {
            "stroke_distance": ("time", x),
            "centre_lateral_displacement": ("time", -drag),
            "leg": ("time", np.r_[0, 0, np.ones(len(x) - 2, int)]),
        },
        attrs={"scene": json.dumps(scene)},
    )


def study(law=lambda mu: 1.5e-3 * mu, histories=None, sweep=SWEEP, numbers=NUMBERS):
    return calibrate_friction(
        [history(mu, law) for mu in sweep],
        histories or {},
        numbers,
        read_friction(REFERENCE / "friction.csv"),
    )


def estimate(found, quantity, study="friction"):
    table = found[1]
    rows = table[(table["study"] == study) & (table["quantity"] == quantity)]
    assert len(rows) == 1
    return float(rows["estimate"].iloc[0])


def test_stretch_is_the_mean_and_range_over_the_waves_alone():
    point = stretch(history(0.6))
    assert point.coefficient == 0.6
    assert point.mean == pytest.approx(-0.9e-3, rel=5e-3)
    assert (point.lowest, point.highest) == (
        pytest.approx(-0.99e-3, rel=5e-3),
        pytest.approx(-0.81e-3, rel=5e-3),
    )


def test_mean_is_over_the_way_not_over_the_outputs():
    even = history(0.6)
    first_half = (even.stroke_distance.values < 22e-3) | (np.arange(even.sizes["time"]) % 4 == 0)
    uneven = even.isel(time=np.flatnonzero(first_half))
    assert uneven.centre_lateral_displacement.values[
        uneven.stroke_distance.values > 8e-3
    ].mean() != pytest.approx(-0.9e-3, rel=0.02)
    assert stretch(uneven).mean == pytest.approx(stretch(even).mean, rel=5e-3)


@pytest.mark.parametrize(
    "slope, exponent", [(1.5e-3, 1.0), (2.2e-3, 1.0), (1.4e-3, 0.7), (1.4e-3, 1.3)]
)
def test_a_known_law_is_given_back(slope, exponent):
    found = study(lambda mu: slope * mu**exponent)

    def exact(lateral):
        return (lateral / slope) ** (1 / exponent)

    best = exact(1e-3)
    assert estimate(found, "coefficient") == pytest.approx(best, rel=5e-3)
    assert estimate(found, "coefficient, rounded") == pytest.approx(0.05 * round(best / 0.05))
    assert estimate(found, "least coefficient for about 1 mm") == pytest.approx(
        exact(0.85e-3), rel=5e-3
    )
    assert estimate(found, "most coefficient for about 1 mm") == pytest.approx(
        exact(1.15e-3), rel=5e-3
    )
    assert estimate(found, "least coefficient within the axis of Fig 5-15") == pytest.approx(
        exact(0.5e-3 / 0.9), rel=8e-3
    )
    assert estimate(found, "most coefficient within the axis of Fig 5-15") == pytest.approx(
        exact(1.25e-3 / 1.1), rel=8e-3
    )
    slope_here = 1e3 * slope * exponent * best ** (exponent - 1)
    assert estimate(found, "stretch per coefficient") == pytest.approx(slope_here, rel=0.02)
    assert estimate(found, "lowest displacement over the waves") == pytest.approx(-1.1, rel=5e-3)


def test_target_is_the_thesis_s_number():
    other = NUMBERS.assign(low=[0.8, -1.25])
    assert estimate(study(numbers=other), "coefficient") == pytest.approx(0.8 / 1.5, rel=5e-3)
    committed = pd.read_csv(REFERENCE / "thesis_numbers.csv").set_index("id")
    assert committed.loc[STRETCH, "low"] == 1 and committed.loc[STRETCH, "units"] == "mm"
    assert (
        committed.loc[AXIS, ["low", "high"]].tolist() == [-1.25, -0.5]
        and committed.loc[AXIS, "units"] == "mm"
    )


def test_variations_scale_the_coefficient():
    soft = history(0.64, lambda mu: 2 * 1.5e-3 * mu)
    found = study(histories={"calibration_stroke_softer": soft})
    title = f"friction: {VARIATIONS['calibration_stroke_softer']}"
    assert estimate(found, "mean stretch", title) == pytest.approx(2 * 1.5 * 0.64, rel=5e-3)
    assert estimate(found, "coefficient for 1 mm", title) == pytest.approx(1 / 3, rel=5e-3)
    assert "change of the stretch by mesh and steps of the thesis's size" not in set(
        found[1]["quantity"]
    )
    both = study(histories={STROKE: history(0.64, lambda mu: 1.5e-3 * mu * 1.01)})
    assert estimate(
        both, "change of the stretch by mesh and steps of the thesis's size"
    ) == pytest.approx(1.0, rel=1e-6)


def test_what_cannot_be_answered_is_refused():
    with pytest.raises(ValueError, match="the waves end at 35.81 mm"):
        stretch(history(0.6, way=30e-3))
    plate = history(0.6)
    plate.attrs["scene"] = json.dumps(
        surface().varied({"name": "plate", "stimulus": {"shape": "flat"}}).canonical()
    )
    with pytest.raises(ValueError, match="plate does not stroke a wavy surface"):
        stretch(plate)
    with pytest.raises(ValueError, match="at least two different"):
        StretchCurve([stretch(history(0.6)), stretch(history(0.6))])
    with pytest.raises(ValueError, match="does not fall"):
        study(lambda mu: 1.5e-3 * abs(mu - 0.4))
    with pytest.raises(ValueError, match=r"-1 mm is beyond the strokes, -0.1\d* to -0.5\d* mm"):
        study(lambda mu: 0.5e-3 * mu)


def test_every_stroke_has_the_calibrated_coefficient():
    table = pd.read_csv(ROOT / "figures" / "tables" / "calibration.csv")
    rows = table[table["study"] == "friction"].set_index("quantity")["estimate"]
    assert rows["coefficient, rounded"] == pytest.approx(rounded(rows["coefficient"]), abs=1e-9)
    files = sorted((ROOT / "config" / "scenes").glob("*stroke*.yaml"))
    names = [name for path in files for name in read_family(path)]
    assert {
        "stroke_1",
        "stroke_5",
        "stroke_10",
        "stroke_20",
        "stroke_40",
        "stroke_sub_1",
        "stroke_sub_10",
        "stroke_sub_40",
    } < set(names)
    for name in names:
        path = ROOT / "config" / "scenes" / f"{name}.yaml"
        assert load_scene(path).friction == pytest.approx(rows["coefficient, rounded"], abs=1e-9), (
            name
        )
    for family in ("stroke", "stroke_sub"):
        text = (ROOT / "config" / "scenes" / f"{family}.yaml").read_text()
        assert "figures/tables/calibration.md; the thesis states none" in text


def test_a_range_upside_down_is_refused(tmp_path):
    text = (REFERENCE / "friction.csv").read_text().replace("0.87,1.05", "1.05,0.87")
    (tmp_path / "friction.csv").write_text(text)
    with pytest.raises(
        ReferenceDataError,
        match="row 4, column high: '0.87'; allowed: a number from 1.05 or nothing",
    ):
        read_friction(tmp_path / "friction.csv")
