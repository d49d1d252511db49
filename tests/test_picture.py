"""The picture of a history: its numbers and curves are the history's, in mm, kPa and s."""

import matplotlib as mpl
import numpy as np
import pytest

import fingerpad

mpl.use("Agg")
SCENE = {
    "stimulus": {"shape": "cylinder", "curvature": "400 1/m"},
    "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "0.2 s"}],
    "accuracy": "draft",
}


@pytest.fixture(scope="module")
def history():
    return fingerpad.simulate(SCENE)


def test_picture_shows_the_history_in_millimetres_and_kilopascals(history):
    """Mutants: pressure in Pa, the state before the last, the receptor below."""
    figure = history.fingerpad.plot()
    section, pressure, energy, impulses = figure.axes
    last = history.isel(time=-1)
    depth, width = (1e3 * float(last[k]) for k in ("indentation_depth", "contact_width"))
    said = figure.get_suptitle()
    assert f"depth {depth:.3g} mm" in said and f"contact {width:.3g} mm wide" in said
    drawn = pressure.lines[-1].get_ydata()
    assert drawn.max() == pytest.approx(1e-3 * last.contact_pressure.values.max())
    touched = pressure.lines[-1].get_xdata()[drawn > 0]
    assert np.ptp(touched) == pytest.approx(width, rel=0.15)
    shown = energy.lines[1].get_ydata()
    assert shown == pytest.approx(1e-3 * history.fingerpad.sel(915e-6).strain_energy_density.values)
    counts = [len(rows.get_positions()) for rows in impulses.collections]
    assert counts == fingerpad.respond(history).impulses.values[0].tolist()
    # the indenter's lowest point is where it has pressed the skin's middle to
    lowest = section.collections[-1].get_paths()[0].vertices[:, 1].min()
    assert lowest == pytest.approx(6.0 - depth, abs=0.02)


def test_a_press_that_takes_no_time_has_no_impulses_and_says_so():
    history = fingerpad.simulate(SCENE | {"motion": [{"press_to_depth": "0.5 mm"}]})
    (words,) = history.fingerpad.plot().axes[3].texts
    assert "time" in words.get_text()


def test_without_matplotlib_the_error_names_what_to_install(history, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="pip install matplotlib"):
        history.fingerpad.plot()
