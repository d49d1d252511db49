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
    waves,
)
from fingerpad import load_scene
from fingerpad.scenes.families import read_family

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
REFERENCE, SCENES = ROOT / "config" / "reference", ROOT / "config" / "scenes"
PUBLISHED = REFERENCE / "friction.csv"
SWEEP = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0)
NUMBERS = pd.DataFrame({"id": [STRETCH, AXIS], "low": [1.0, -1.25], "high": [np.nan, -0.5]})


@cache
def surface():
    return load_scene(SCENES / f"{STROKE}.yaml")


def linear(coefficient):
    return 1.5e-3 * coefficient


def history(coefficient, law=linear, way=50e-3, name=STROKE):
    """A stroke that drags the centre by law(coefficient) in the mean over the waves; one whole
    period of a ripple about it.
    """
    start, end = waves(xr.Dataset(attrs={"scene": json.dumps(surface().canonical())}))
    x = np.sort([0.0, *np.linspace(0, way, 400), start, *([end] if end < way else [])])
    drag = law(coefficient) * (1 + 0.1 * np.sin(2 * np.pi * (x - start) / (end - start)))
    drag = np.where((x < start) | (x > end), 0.2 * drag, drag)  # the flats must not count
    scene = surface().canonical() | {"friction": coefficient, "name": name}
    return xr.Dataset(
        {
            "stroke_distance": ("time", x),
            "centre_lateral_displacement": ("time", -drag),
            "leg": ("time", np.r_[0, 0, np.ones(len(x) - 2, int)]),
        },
        attrs={"scene": json.dumps(scene)},
    )


def study(law=linear, histories=None, numbers=NUMBERS):
    """The estimates, by study and quantity."""
    sweep, published = [history(mu, law) for mu in SWEEP], read_friction(PUBLISHED)
    _, estimates = calibrate_friction(sweep, histories or {}, numbers, published)
    return estimates.set_index(["study", "quantity"])["estimate"].sort_index()


def test_stretch_is_the_mean_and_range_over_the_waves_alone():
    point = stretch(history(0.6))
    assert point == pytest.approx((0.6, -0.9e-3, -0.99e-3, -0.81e-3), rel=5e-3)


def test_mean_is_over_the_way_not_over_the_outputs():
    even = history(0.6)
    first_half = (even.stroke_distance.values < 22e-3) | (np.arange(even.sizes["time"]) % 4 == 0)
    uneven = even.isel(time=np.flatnonzero(first_half))
    over_waves = uneven.centre_lateral_displacement[uneven.stroke_distance.values > 8e-3]
    assert float(over_waves.mean()) != pytest.approx(-0.9e-3, rel=0.02)
    assert stretch(uneven).mean == pytest.approx(stretch(even).mean, rel=5e-3)


@pytest.mark.parametrize(
    "slope, exponent", [(1.5e-3, 1.0), (2.2e-3, 1.0), (1.4e-3, 0.7), (1.4e-3, 1.3)]
)
def test_a_known_law_is_given_back(slope, exponent):
    found = study(lambda mu: slope * mu**exponent)["friction"]

    def exact(lateral):
        return (lateral / slope) ** (1 / exponent)

    best = exact(1e-3)
    for quantity, expected in {
        "coefficient": best,
        "least coefficient for about 1 mm": exact(0.85e-3),
        "most coefficient for about 1 mm": exact(1.15e-3),
        "lowest displacement over the waves": -1.1,
    }.items():
        assert found[quantity] == pytest.approx(expected, rel=5e-3), quantity
    assert found["coefficient, rounded"] == pytest.approx(0.05 * round(best / 0.05))
    axis = "{} coefficient within the axis of Fig 5-15"
    assert found[axis.format("least")] == pytest.approx(exact(0.5e-3 / 0.9), rel=8e-3)
    assert found[axis.format("most")] == pytest.approx(exact(1.25e-3 / 1.1), rel=8e-3)
    slope_here = 1e3 * slope * exponent * best ** (exponent - 1)
    assert found["stretch per coefficient"] == pytest.approx(slope_here, rel=0.02)


def test_target_is_the_thesis_s_number():
    other = NUMBERS.assign(low=[0.8, -1.25])
    assert study(numbers=other)["friction", "coefficient"] == pytest.approx(0.8 / 1.5, rel=5e-3)
    committed = pd.read_csv(REFERENCE / "thesis_numbers.csv").set_index("id")
    columns = ["low", "high", "units"]
    assert committed.loc[STRETCH, columns].tolist() == [1, pytest.approx(np.nan, nan_ok=True), "mm"]
    low, high, unit = committed.loc[AXIS, columns]
    assert (float(low), float(high), unit) == (-1.25, -0.5, "mm")


def test_variations_scale_the_coefficient():
    soft = history(0.64, lambda mu: 2 * linear(mu))
    found = study(histories={"calibration_stroke_softer": soft})
    softer = found[f"friction: {VARIATIONS['calibration_stroke_softer']}"]
    assert softer["mean stretch"] == pytest.approx(2 * 1.5 * 0.64, rel=5e-3)
    assert softer["coefficient for 1 mm"] == pytest.approx(1 / 3, rel=5e-3)
    name = "change of the stretch by mesh and steps of the thesis's size"
    assert name not in found["friction"]
    fine = history(0.64, lambda mu: 1.01 * linear(mu))
    assert study(histories={STROKE: fine})["friction", name] == pytest.approx(1.0, rel=1e-6)


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
        study(lambda mu: linear(abs(mu - 0.4)))
    with pytest.raises(ValueError, match=r"-1 mm is beyond the strokes, -0.1\d* to -0.5\d* mm"):
        study(lambda mu: 0.5e-3 * mu)


def test_every_stroke_has_the_calibrated_coefficient():
    table = pd.read_csv(ROOT / "figures" / "tables" / "calibration.csv")
    rows = table[table["study"] == "friction"].set_index("quantity")["estimate"]
    chosen = rows["coefficient, rounded"]
    assert chosen == pytest.approx(rounded(rows["coefficient"]), abs=1e-9)
    # the stroke of the study of accuracy has the coefficient that its tables were measured with
    families = set(SCENES.glob("*stroke*.yaml")) - {SCENES / "accuracy_stroke.yaml"}
    names = [name for path in sorted(families) for name in read_family(path)]
    strokes = {f"stroke_{speed}" for speed in (1, 5, 10, 20, 40)}
    assert strokes | {f"stroke_sub_{speed}" for speed in (1, 10, 40)} < set(names)
    for name in names:
        assert load_scene(SCENES / f"{name}.yaml").friction == pytest.approx(chosen, abs=1e-9), name
    for family in ("stroke", "stroke_sub"):
        text = (SCENES / f"{family}.yaml").read_text()
        assert "figures/tables/calibration.md; the thesis states none" in text


def test_a_range_upside_down_is_refused(tmp_path):
    text = PUBLISHED.read_text().replace("0.87,1.05", "1.05,0.87")
    (tmp_path / "friction.csv").write_text(text)
    with pytest.raises(
        ReferenceDataError,
        match="row 4, column high: '0.87'; allowed: a number from 1.05 or nothing",
    ):
        read_friction(tmp_path / "friction.csv")
