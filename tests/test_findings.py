"""Titles: the finding of a figure with its numbers, against the data that it is about."""

import numpy as np
import pytest

from cysyk1999.figures.findings import FINDINGS, n
from cysyk1999.figures.registry import FIGURES
from drawn import picture, results, saved
from fingerpad.measures.features import PRESSURE, centre_node, is_simulated, receptors_at, width

pytestmark = pytest.mark.unit
COUNTED = ("5-1", "5-22", "5-27")
"""Figures whose findings count rows."""


@pytest.mark.parametrize("number", FIGURES)
def test_picture_is_headed_by_its_finding(number):
    said = FINDINGS[number](saved(number))
    assert picture(number).texts[0].get_text().replace("\n", " ") == said
    assert len(said) < 170 and "nan" not in said


@pytest.mark.parametrize("number", [k for k in FINDINGS if k not in COUNTED])
def test_numbers_of_a_finding_are_no_typed_ones(number):
    """They change with every simulated number."""
    frame = saved(number).copy()
    draw, rows = np.random.default_rng(1), is_simulated(frame)
    for column in frame.select_dtypes("float"):
        frame.loc[rows, column] *= draw.uniform(0.4, 1.7, rows.sum())
    assert FINDINGS[number](frame) != FINDINGS[number](saved(number))


def centre_pressure(history):
    return 1e-3 * history[PRESSURE].values[:, centre_node(history)].max()


def energy(history):
    row = receptors_at(history, 915e-6)
    middle = row[np.abs(history["receptor_offset"].values[row]).argmin()]
    return history["strain_energy_density"].values[:, middle].max()


OF_SURFACES = {
    "4-7": ("mm", lambda h: 1e3 * h["indentation_depth"].values[-1]),
    "4-8": ("mm", lambda h: 1e3 * width(h)[-1]),
    "4-10": ("kPa", centre_pressure),
    "4-23": ("Pa", energy),
}


@pytest.mark.parametrize("number", OF_SURFACES)
def test_finding_says_what_is_read_from_the_histories_of_plate_and_sharpest_cylinder(number):
    unit, read = OF_SURFACES[number]
    plate, sharp = (n(read(results()[0][f"ramp40_{name}"])) for name in ("flat", "k1260"))
    said = FINDINGS[number](saved(number))
    assert f"from {plate} (plate) to {sharp} {unit} (1260 1/m)" in said


def test_words_of_a_change_follow_the_numbers():
    frame = saved("4-23").copy()
    energies = frame["strain_energy_density (Pa)"]
    late, ramp = frame["time (s)"] > 0.5, frame["time (s)"] <= 0.5
    top = energies.where(ramp).groupby(frame["surface"]).transform("max")
    for factor, words in ((0.8, "falls by 20 %"), (1.3, "rises by 30 %")):
        frame.loc[late, energies.name] = factor * top[late]
        assert FINDINGS["4-23"](frame).endswith(f"{words} in the hold")
