"""One call from a history to impulses."""

import numpy as np
import pytest
import xarray as xr

import fingerpad
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate
from fingerpad.receptors.spikes import integrated
from fingerpad.results import read_history, summary, write_history

pytestmark = pytest.mark.unit


def made_up(steady_start: bool = False) -> xr.Dataset:
    """A ramp to 1000 Pa (and to half of it at a second receptor) in 0.5 s, and a hold of 1 s."""
    time = np.concatenate([np.linspace(0, 0.5, 21), np.linspace(0.55, 1.5, 20)])
    energy, leg = np.minimum(time / 0.5, 1) * 1000, (time > 0.5).astype(int)
    if steady_start:
        time, energy, leg = (
            np.insert(time, 1, [0.0, 0.0]),
            np.insert(energy, 0, [0.0, 200.0]),
            np.insert(leg + 1, 0, [0, 0]),
        )
        leg[2] = 0
    places = {
        "receptor_depth": ("receptor", [6e-4, 9e-4]),
        "receptor_offset": ("receptor", [0.0, 1e-4]),
    }
    data = {
        "leg": ("time", leg),
        "strain_energy_density": (("time", "receptor"), energy[:, None] * [1.0, 0.5]),
    }
    return xr.Dataset(data, {"time": time, **places})


def test_rates_are_those_of_eq_5_1_and_impulses_their_integral():
    """On the ramp A1 (E - threshold) and A2 times the slope above its threshold; on the hold the
    first alone.
    """
    sent = fingerpad.respond(made_up())
    rate = sent.impulse_rate.sel(afferent="slowly_adapting")
    assert rate.dims == ("response_time", "receptor") and rate.attrs["units"] == "1/s"
    law = THESIS_RATE
    held, moving = (
        law.per_energy * (1000 - law.threshold),
        law.per_rate * (2000 - law.rate_threshold),
    )
    np.testing.assert_allclose(
        rate.sel(response_time=slice(0.5 - 1e-9, 0.5 + 1e-9))[:, 0], [held + moving, held]
    )
    assert float(rate[-1, 1]) == pytest.approx(law.per_energy * (500 - law.threshold))
    for receptor in (0, 1):
        one = sent.isel(afferent=0, receptor=receptor)
        total = integrated(one.response_time, one.impulse_rate)[-1]
        assert int(one.impulses) == int(total) == np.isfinite(one.impulse_time).sum()
    assert sent.receptor_depth.values.tolist() == [6e-4, 9e-4]
    assert "per_energy=0.081" in sent.attrs["laws"]


def test_kinds_of_receptor_and_laws_of_one_s_own():
    """Rapidly adapting receptors are silent on the hold; a law of one's own has one's own name."""
    laws = {"double": ImpulseRate(2 * THESIS_RATE.per_energy, 0.0, THESIS_RATE.threshold, 0.0)}
    both = fingerpad.respond(made_up(), ["slowly_adapting", "rapidly_adapting"])
    assert (both.impulse_rate.sel(afferent="rapidly_adapting")[-10:] == 0).all()
    assert int(both.impulses.sel(afferent="rapidly_adapting")[0]) > 10
    assert (both.impulse_time.sel(afferent="rapidly_adapting").max() <= 0.5).all()
    rapid = fingerpad.respond(made_up(), "rapidly_adapting")
    for name in ("RA", ["RA"], "FA-I"):
        assert fingerpad.respond(made_up(), name).equals(rapid)
    assert fingerpad.respond(made_up(), "SA-I").equals(fingerpad.respond(made_up()))
    own = fingerpad.respond(made_up(), laws)
    assert own.afferent.values.tolist() == ["double"] and float(
        own.impulse_rate[0, -1, 0]
    ) == pytest.approx(2 * 0.081 * 850)


def test_variability_needs_a_seed_and_receptors_vary_apart():
    """The same seed gives the same impulses; two receptors under the same energy do not fire
    together.
    """
    alike = made_up()
    alike["strain_energy_density"][:, 1] = alike.strain_energy_density[:, 0]
    one, again = (fingerpad.respond(alike, variation=0.25, seed=3) for _ in range(2))
    xr.testing.assert_identical(one, again)
    assert not np.array_equal(one.impulse_time[0, 0], one.impulse_time[0, 1])
    with pytest.raises(ValueError, match="seed"):
        fingerpad.respond(alike, variation=0.25)


def test_what_takes_no_time_has_no_rate():
    """A steady leg before the ramp moves the start of the energy and adds no rate; a history
    without time is refused.
    """
    sent = fingerpad.respond(made_up(steady_start=True))
    np.testing.assert_array_equal(np.isfinite(sent.impulse_rate), True)
    assert float(sent.impulse_rate.max()) == float(fingerpad.respond(made_up()).impulse_rate.max())
    with pytest.raises(ValueError, match="takes time"):
        fingerpad.respond(made_up().isel(time=slice(0, 1)))
    with pytest.raises(ValueError, match="no afferent called 'PC'; known: slowly_adapting"):
        fingerpad.respond(made_up(), "PC")
    with pytest.raises(TypeError, match="what simulate or read_history returns, not str 'my.yaml'"):
        fingerpad.respond("my.yaml")


def test_one_key_of_a_scene_writes_responses_into_history_and_summary(tmp_path):
    """outputs.responses: impulses in the history, a row a receptor in the summary; a dictionary is
    a scene too.
    """
    scene = fingerpad.load_scene(
        {
            "stimulus": {"shape": "cylinder", "curvature": "400 1/m"},
            "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "1 s"}],
            "outputs": {"responses": True, "receptors": {"depths": ["600 um", "915 um"]}},
            "accuracy": {"skin_edge": "0.6 mm", "steps": 12},
        },
        name="from_a_dictionary",
    )
    assert isinstance(scene, fingerpad.Scene) and scene.name == "from_a_dictionary"
    write_history(fingerpad.simulate(scene), tmp_path / "history.nc")
    history = read_history(tmp_path / "history.nc")
    again = fingerpad.respond(history)
    for name in again.data_vars:
        np.testing.assert_array_equal(history[name], again[name])
    upper, lower = summary(history)["responses"]
    assert (upper["afferent"], upper["depth_mm"], lower["depth_mm"]) == (
        "slowly_adapting",
        0.6,
        0.915,
    )
    assert upper["impulses"] == int(history.impulses[0, 0]) > lower["impulses"]
    assert 0 < upper["first_impulse_s"] < 0.5 and upper["peak_rate_per_s"] > 50
