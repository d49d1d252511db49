"""Emulators: against histories of known formulas, against the solver; their files, refusals and
page.
"""

import json
from itertools import product

import numpy as np
import pytest
import xarray as xr
from sklearn.gaussian_process.kernels import Matern

import fingerpad
from fingerpad.cli import main
from fingerpad.emulator.basis import basis, cubic_weights, exponents, kernel, local_size, nearby
from fingerpad.emulator.explorer import page
from fingerpad.emulator.model import load_emulator
from fingerpad.sweeps.design import Design
from fingerpad.sweeps.engine import lay_out
from fingerpad.sweeps.language import load_sweep

pytestmark = pytest.mark.unit

SCENE = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}],
    "outputs": {"receptors": {"depths": ["600 um", "915 um"], "offsets": ["0 mm", "1 mm"]}},
    "accuracy": "draft",
}
OVER = {
    "stimulus.curvature": {"range": ["50 1/m", "1300 1/m"]},
    "motion[0].press_to_force": {
        "range": ["5 gf", "60 gf"],
        "spacing": "logarithmic",
        "name": "force",
    },
    "motion[0].rate": {"range": ["20 gf/s", "80 gf/s"], "spacing": "logarithmic"},
}
GF, LENGTH = 9.80665e-3, 11.4e-3
RIGHT = np.linspace(0, 6e-3, 301)


def truth(curvature, force, rate, time):
    """Depth (m), half width (m) and middle pressure (Pa) of a made-up pad at a time (s)."""
    top = force / rate
    now = force * min(time / top, 1.0)
    creep = 1 + 0.1 * (1 - np.exp(-max(time - top, 0) / 0.4)) + 0.02 * np.log(rate)
    depth = 1e-3 * (now / 0.2) ** 0.6 * (1 + curvature / 2000) * creep
    half = 2e-3 * (now / 0.2) ** 0.4 / (1 + curvature / 500) * creep
    return depth, half, 1.5 * now / LENGTH / (2 * half) if half else 0.0


def history(scene):
    """A history of the made-up pad, in the form of the solver's; of a body of revolution the right
    half, with the force in N.
    """
    press, hold = scene.motion
    force, rate, curvature = press.press_to_force, press.rate, scene.stimulus.curvature
    top = force / rate
    after = np.expm1(np.linspace(0, np.log1p(hold.hold / 0.05), 16))[1:] * 0.05
    time = np.concatenate([[0], top * np.arange(1, 13) / 12, top + after])
    depth, half, middle = np.array([truth(curvature, force, rate, t) for t in time]).T
    turned = scene.axisymmetric
    load = np.minimum(time / top, 1) * force / (1 if turned else LENGTH)
    x = RIGHT if turned else np.concatenate([-RIGHT[:0:-1], RIGHT])
    with np.errstate(all="ignore"):
        share = np.nan_to_num(np.abs(x) / half[:, None], nan=9, posinf=9)
    receptors = [(d, o) for d in (600e-6, 915e-6) for o in (0.0, 1e-3)]
    skin_ends = scene.specimen.outline.epidermis_thickness
    energy = np.array([0.05 * middle * np.exp(-o / 2e-3) * 600e-6 / d for d, o in receptors]).T
    energy *= [1.0 if d < skin_ends else 10.0 for d, _ in receptors]
    outputs, skin = ("time",), ("time", "skin_node")
    data = {
        "force": (outputs, load),
        "leg": (outputs, (time > top * (1 + 1e-9)).astype(int)),
        "indentation_depth": (outputs, depth),
        "contact_width": (outputs, 2 * half),
        "peak_pressure": (outputs, middle),
        "centre_pressure": (outputs, middle),
        "contact_pressure": (skin, middle[:, None] * np.clip(1 - share**2, 0, None)),
        "skin_displacement_x": (skin, np.zeros((len(time), len(x)))),
        "skin_displacement_y": (skin, -depth[:, None] * np.exp(-np.abs(x) / 2e-3)),
        "strain_energy_density": (("time", "receptor"), energy),
    }
    if turned:
        data["contact_radius"] = outputs, half
    places = {
        "time": time,
        "skin_x": ("skin_node", x),
        "skin_y": ("skin_node", np.full(len(x), 6e-3)),
        "skin_arc": ("skin_node", x),
        "receptor_depth": ("receptor", [d for d, _ in receptors]),
        "receptor_offset": ("receptor", [o for _, o in receptors]),
    }
    return xr.Dataset(data, places, {"estimated_error": 0.02 + 1e-5 * curvature})


def made_up(folder, samples, seed=3, over=OVER, base=SCENE, show=history):
    """The folder of a sweep whose histories are the made-up pad's."""
    keys = {"design": "sobol", "samples": samples, "seed": seed, "histories": True}
    read = load_sweep({"over": over, **keys}, "made_up", fingerpad.load_scene(base))
    lay_out(read, folder, 1)
    (folder / "histories").mkdir()
    found = json.loads((folder / "design.json").read_text())
    for key, scene in zip(found["keys"], Design(read), strict=True):
        show(scene).to_netcdf(folder / "histories" / f"{key}.nc")
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return made_up(tmp_path_factory.mktemp("sweep") / "made_up", 128)


@pytest.fixture(scope="module")
def pad(folder):
    return fingerpad.emulate(folder)


def scene(curvature=210.0, force=20.0, rate=40.0, hold=1.0, **more):
    """A scene inside the box; curvature 1/m, force gf, rate gf/s, hold s."""
    motion = [{"press_to_force": f"{force!r} gf", "rate": f"{rate!r} gf/s"}]
    motion += [{"hold": f"{hold!r} s"}] * (hold > 0)
    stimulus = {"shape": "cylinder", "curvature": f"{curvature!r} 1/m"}
    return SCENE | {"stimulus": stimulus, "motion": motion} | more


def inside(count, seed=0):
    """Random scenes inside the box, as (curvature, force, rate, hold)."""
    u = np.random.default_rng(seed).random((count, 4))
    low, high = np.array([[50, 5, 20, 0.0], [1300, 60, 80, 2.0]])
    return (low + u * (high - low)).round(4).tolist()


# --- the mathematics ------------------------------------------------------------------------------


def test_a_basis_of_degree_three_holds_every_cubic():
    rng, powers = np.random.default_rng(1), exponents(3, 3)
    x = rng.uniform(-1, 1, (60, 3))
    y = 1 + x[:, 0] ** 3 - 2 * x[:, 0] * x[:, 1] * x[:, 2] + x[:, 2] ** 2
    found = np.linalg.lstsq(basis(x, powers), y, rcond=None)[0]
    at = rng.uniform(-1, 1, (9, 3))
    exact = 1 + at[:, 0] ** 3 - 2 * at[:, 0] * at[:, 1] * at[:, 2] + at[:, 2] ** 2
    assert len(powers) == 20
    assert basis(at, powers) @ found == pytest.approx(exact, abs=1e-12)


def test_cubics_in_time_are_of_fourth_order():
    """Halving the steps divides the error by 16."""
    at, errors = np.linspace(0, 2, 301), []
    for count in (11, 21, 41):
        grid = np.linspace(0, 2, count)
        errors.append(np.abs(cubic_weights(grid, at) @ np.exp(grid) - np.exp(at)).max())
    assert errors[-1] < 3e-6
    assert np.log2(errors[0] / errors[1]) > 3.6 and np.log2(errors[1] / errors[2]) > 3.6


def test_the_covariance_is_that_of_scikit_learn():
    rng, scales = np.random.default_rng(2), np.array([0.1, 1.0, 9.0])
    x, y = rng.uniform(-1, 1, (2, 30, 3))
    assert kernel(x, y, scales) == pytest.approx(Matern(scales, nu=2.5)(x, y), abs=1e-13)


# --- answers --------------------------------------------------------------------------------------


def test_unseen_scenes_of_a_known_pad_are_found(pad):
    worst = 0.0
    for curvature, force, rate, hold in inside(40):
        found = pad.predict(scene(curvature, force, rate, hold))
        depth, half, middle = truth(curvature, force * GF, rate * GF, found.time.values[-1])
        last = found.isel(time=-1)
        ratios = last.indentation_depth / depth, last.contact_width / half / 2
        ratios += (last.peak_pressure / middle,)
        worst = max(worst, *(abs(float(r) - 1) for r in ratios))
        assert found.time.values[-1] == pytest.approx(force / rate + hold)
        assert last.estimated_error == pytest.approx(0.02 + 1e-5 * curvature, rel=5e-3)
    assert worst < 5e-3


def test_more_scenes_make_it_better(tmp_path, pad):
    few = fingerpad.emulate(made_up(tmp_path / "few", 20))
    points = np.array(inside(50, seed=5))[:, :3] * [1, GF, GF]
    exact = np.array([truth(*p, p[1] / p[2] + 2.0)[1] for p in points])
    errors = [
        np.abs(of.values(points, ("contact_width",))["contact_width"][:, -1] / 2 / exact - 1).max()
        for of in (few, pad)
    ]
    assert errors[1] < 1.5e-3 and errors[1] < 0.2 * errors[0]


def test_the_band_holds_what_it_says_of_unseen_scenes(tmp_path):
    """Of few scenes, so that the band is wide; 95 % are asked for, 85 % are a mutant's limit."""
    few, held = fingerpad.emulate(made_up(tmp_path / "few", 48)), []
    for curvature, force, rate, hold in inside(60, seed=7):
        found = few.predict(scene(curvature, force, rate, hold)).isel(time=-1)
        depth, half, _ = truth(curvature, force * GF, rate * GF, force / rate + hold)
        held.append(abs(found.indentation_depth - depth) <= found.indentation_depth_error)
        held.append(abs(found.contact_width - 2 * half) <= found.contact_width_error)
    assert np.mean(held) > 0.85
    assert float(found.contact_width_error) < 0.2 * float(found.contact_width)


def test_the_band_is_wider_in_the_corners_of_the_box(tmp_path):
    """Where few scenes are near; one band for the whole box is too narrow there."""
    few, held, widths = fingerpad.emulate(made_up(tmp_path / "few", 48)), [], []
    for curvature, force, rate in product((50.0, 1300.0), (5.0, 60.0), (20.0, 80.0)):
        found = few.predict(scene(curvature, force, rate, 1.0)).isel(time=-1)
        depth, half, _ = truth(curvature, force * GF, rate * GF, force / rate + 1.0)
        held.append(abs(found.indentation_depth - depth) <= found.indentation_depth_error)
        held.append(abs(found.contact_width - 2 * half) <= found.contact_width_error)
        widths.append(float(found.contact_width_error / found.contact_width))
    middle = few.predict(scene(400.0, 17.0, 40.0, 1.0)).isel(time=-1)
    assert np.mean(held) > 0.6
    assert max(widths) > 4 * float(middle.contact_width_error / middle.contact_width)


def test_what_is_said_of_a_place_comes_from_scenes_nearby():
    centres, sizes = np.array([[-1.0], [-0.9], [0.9], [1.0]]), np.array([1.0, 2.0, 8.0, np.nan])
    low, high = local_size(nearby(np.array([[-0.95], [0.95]]), centres), sizes)
    every = np.mean(sizes[:3] ** 2)
    assert low**2 == pytest.approx(0.9 * 2.5 + 0.1 * every, rel=1e-3)
    assert high**2 == pytest.approx(0.9 * 64 + 0.1 * every, rel=1e-3)


def test_the_low_end_of_an_even_range_is_emulated_as_well(tmp_path):
    """On a logarithm of curvatures no scene would be near the flattest."""
    wide = OVER | {"stimulus.curvature": {"range": ["0.01 1/m", "1300 1/m"]}}
    pad = fingerpad.emulate(made_up(tmp_path / "wide", 64, over=wide))
    for curvature in (0.01, 1300.0):
        found = pad.predict(scene(curvature)).isel(time=-1)
        depth, half, _ = truth(curvature, 20 * GF, 40 * GF, 1.5)
        assert float(found.indentation_depth) == pytest.approx(depth, rel=0.01)
        assert float(found.contact_width) == pytest.approx(2 * half, rel=0.02)


def test_another_sweep_judges_it(pad, tmp_path):
    """By the made-up pad twice as deep, all depths are off by half."""
    unseen = made_up(tmp_path / "unseen", 20, seed=4)
    few = made_up(tmp_path / "few", 48)
    rows = {row["quantity"]: row for row in fingerpad.emulate(few, unseen).about["held_out"]}
    assert rows["contact_width"]["scenes"] == 20 and rows["contact_width"]["within_95"] < 0.05
    for file in (unseen / "histories").iterdir():
        with xr.load_dataset(file) as found:
            found["indentation_depth"] *= 2
        found.to_netcdf(file)
    rows = {row["quantity"]: row for row in fingerpad.emulate(few, unseen).about["held_out"]}
    assert rows["indentation_depth"]["median"] == pytest.approx(0.5, abs=0.01)
    assert rows["indentation_depth"]["covered"] == 0
    other = made_up(tmp_path / "other", 8, over={k: OVER[k] for k in list(OVER)[:2]})
    with pytest.raises(fingerpad.SceneError, match="other: is over .*; allowed: .*rate"):
        fingerpad.emulate(few, other)
    with pytest.raises(fingerpad.SceneError, match="of the sweep itself; allowed: another seed"):
        fingerpad.emulate(few, few)


def test_it_grows_where_it_knows_least_until_it_is_good_or_the_budget_is_spent(
    tmp_path, monkeypatch, capsys
):
    """The made-up pad is simulated in place of the solver's."""

    def simulated(base, over, out, **more):
        read = load_sweep({"over": over, "histories": True}, "grown", base)
        lay_out(read, out, 1)
        (out / "histories").mkdir()
        found = json.loads((out / "design.json").read_text())
        for key, scene in zip(found["keys"], Design(read), strict=True):
            history(scene).to_netcdf(out / "histories" / f"{key}.nc")

    monkeypatch.setattr("fingerpad.emulator.growing.run_sweep", simulated)
    few, file = made_up(tmp_path / "few", 24), tmp_path / "pad.emulator"
    start = fingerpad.emulate(few)
    words = ["emulate", str(few), "--out", str(file), "--grow"]
    assert main([*words, "1e-9", "--scenes", "40"]) == 0
    assert "40 scenes added: the budget is spent before 1e-07 %" in capsys.readouterr().out
    spent = load_emulator(file)
    assert spent.about["scenes"] == 64 and not spent.about["grown"]["met"]
    points = np.array(inside(200, seed=5))[:, :3] * [1, GF, GF]
    exact = np.array([truth(*p, p[1] / p[2] + 2.0)[1] for p in points])
    drawn = fingerpad.emulate(made_up(tmp_path / "drawn", 64))
    worst = [
        np.abs(of.values(points, ("contact_width",))["contact_width"][:, -1] / 2 / exact - 1).max()
        for of in (start, spent, drawn)
    ]
    assert worst[1] < 0.3 * worst[0] and worst[1] < worst[2]
    assert main([*words, "0.5"]) == 0
    assert "0 scenes added: 50 % is reached" in capsys.readouterr().out
    assert load_emulator(file).about["scenes"] == 64  # those that were added stay
    assert main([*words, "-1"]) == 2
    assert "tolerance: -1 is no limit; allowed: above zero" in capsys.readouterr().err


def test_a_moving_edge_does_not_smear(pad):
    """The pressure is the parabola of the made-up pad, which ends at its own edge."""
    found = pad.predict(scene(curvature=700.0)).isel(time=-1)
    x = (found.skin_x + found.skin_displacement_x).values
    _, half, middle = truth(700.0, 20 * GF, 40 * GF, 1.5)
    exact = middle * np.clip(1 - (x / half) ** 2, 0, None)
    assert np.abs(found.contact_pressure.values - exact).max() < 0.02 * middle
    assert (found.contact_pressure.values[np.abs(x) > 1.02 * half] == 0).all()


def test_the_answer_is_a_history_that_receptors_respond_to(pad):
    found = pad.predict(scene())
    sent = fingerpad.respond(found)
    assert found.force.values[-1] == pytest.approx(20 * GF / LENGTH)
    assert found.indentation_depth.attrs["units"] == "m"
    assert sent.impulse_rate.shape[-1] == 4 and float(sent.impulses[0, 0]) > 0


def test_a_factor_of_all_moduli_is_exact(pad):
    """By the solver: twice the moduli, force and rate give the same depth and twice the energy; and
    the emulator knows it.
    """
    stiff = {
        name: {"youngs_modulus": f"{2 * e} MPa", "poisson_ratio": 0.48}
        for name, e in {"epidermis": 0.15, "dermis": 0.015, "fat": 0.015}.items()
    }
    more = {"specimen": {"layers": stiff, "moduli": "instantaneous"}}
    both = scene(hold=0.0), scene(force=40.0, rate=80.0, hold=0.0, **more)
    for of in (fingerpad.simulate, pad.predict):
        soft, hard = (of(s).isel(time=-1) for s in both)
        assert float(hard.indentation_depth) == pytest.approx(float(soft.indentation_depth))
        energy = soft.strain_energy_density.values
        assert hard.strain_energy_density.values == pytest.approx(2 * energy, rel=1e-5)


def test_a_sphere_on_a_body_of_revolution_is_emulated(tmp_path):
    """Its force is in N, and its skin begins on the axis."""
    sphere = {"kinematics": "axisymmetric", "stimulus": {"shape": "sphere", "curvature": "210 1/m"}}
    pad = fingerpad.emulate(made_up(tmp_path / "turned", 128, base=SCENE | sphere))
    found = pad.predict(scene() | sphere).isel(time=-1)
    depth, half, middle = truth(210.0, 20 * GF, 40 * GF, 1.5)
    assert float(found.indentation_depth) == pytest.approx(depth, rel=5e-3)
    assert float(found.force) == pytest.approx(20 * GF) and found.force.units == "N"
    assert found.skin_x.values[0] == 0 and (np.diff(found.skin_x) >= 0).all()
    exact = middle * np.clip(1 - (found.skin_x.values / half) ** 2, 0, None)
    assert np.abs(found.contact_pressure.values - exact).max() < 0.02 * middle
    shape = pad.groups["pressure_shape"]  # over the force over the area: less than 2 on the axis
    assert np.abs(shape.mean).max() < 3
    with pytest.raises(fingerpad.SceneError, match="shape"):
        pad.predict(scene())


STROKE = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf"}, {"slide": "-4 mm", "speed": "8 mm/s"}],
    "outputs": {"receptors": {"depths": ["600 um"], "offsets": ["-1 mm", "1 mm"]}},
    "friction": 0.3,
}
ACROSS = {k: v for k, v in OVER.items() if "rate" not in k} | {"friction": {"range": [0.0, 0.8]}}


def stroke(scene):
    """A stroke of the made-up pad, which drags the contact along and then lets it slip."""
    force, friction, load = scene.motion[0].press_to_force, scene.friction, 1.0
    way = np.concatenate([[0, 0, 0], -4e-3 * np.arange(1, 33) / 32])
    now = force * np.concatenate([[0, 0.5, 1], np.ones(32)])
    depth, half, middle = np.array(
        [truth(scene.stimulus.curvature, force, force, f / force) for f in now]
    ).T
    share, load = friction * np.tanh(way / 2e-3), now / LENGTH
    centre, x = 1e-3 * share, np.concatenate([-RIGHT[:0:-1], RIGHT])
    with np.errstate(all="ignore"):
        place = np.nan_to_num((x - centre[:, None]) / half[:, None], nan=9, posinf=9, neginf=-9)
    energy = [middle * np.exp(-((np.array(o) - centre) ** 2) / 4e-6) for o in (-1e-3, 1e-3)]
    outputs, skin = ("time",), ("time", "skin_node")
    data = {
        "force": (outputs, load),
        "leg": (outputs, (way < 0).astype(int)),
        "stroke_distance": (outputs, way),
        "tangential_force": (outputs, load * share),
        "indentation_depth": (outputs, depth),
        "contact_width": (outputs, 2 * half),
        "peak_pressure": (outputs, middle),
        "contact_pressure": (skin, middle[:, None] * np.clip(1 - place**2, 0, None)),
        "skin_displacement_x": (skin, np.zeros(place.shape)),
        "skin_displacement_y": (skin, -depth[:, None] * np.exp(-np.abs(x) / 2e-3)),
        "strain_energy_density": (("time", "receptor"), np.array(energy).T),
    }
    places = {
        "time": np.abs(way) / 8e-3 + 1e-12 * np.arange(len(way)),
        "skin_x": ("skin_node", x),
        "skin_y": ("skin_node", np.full(len(x), 6e-3)),
        "skin_arc": ("skin_node", x),
        "receptor_depth": ("receptor", [600e-6, 600e-6]),
        "receptor_offset": ("receptor", [-1e-3, 1e-3]),
    }
    return xr.Dataset(data, places, {"estimated_error": 0.02})


def test_a_stroke_is_emulated_along_its_way(tmp_path):
    """Both sides differ, the edge of contact moves, and a shorter way is the beginning."""
    folder = made_up(tmp_path / "strokes", 64, over=ACROSS, base=STROKE, show=stroke)
    fingerpad.emulate(folder).save(tmp_path / "stroke.emulator")
    pad = load_emulator(tmp_path / "stroke.emulator")
    found = pad.predict(STROKE)
    true = stroke(fingerpad.load_scene(STROKE)).isel(time=slice(2, None))
    found = found.isel(time=slice(1, None))
    for name in ("stroke_distance", "tangential_force", "indentation_depth", "contact_width"):
        size = np.abs(true[name].values).max()
        assert found[name].values == pytest.approx(true[name].values, abs=6e-3 * size), name
    assert found.time.values == pytest.approx(true.time.values, abs=1e-9)
    energy = true.strain_energy_density.values
    assert found.strain_energy_density.values == pytest.approx(energy, abs=0.02 * energy.max())
    left, right = found.strain_energy_density.values[-1]
    assert left > 1.2 * right
    x = (found.skin_x + found.skin_displacement_x[-1]).values
    pressure = np.interp(x, true.skin_x, true.contact_pressure[-1])
    assert np.abs(found.contact_pressure[-1] - pressure).max() < 0.03 * pressure.max()
    rows = {row["quantity"]: row for row in pad.about["held_out"]}
    assert rows["tangential_force"]["within_95"] < 0.01 and "centre_pressure" not in rows

    def slid(**leg):
        return STROKE | {"motion": [STROKE["motion"][0], STROKE["motion"][1] | leg]}

    short = pad.predict(slid(slide="-1.3 mm")).isel(time=-1)
    expected = np.interp(1.3e-3, -true.stroke_distance, true.tangential_force)
    assert float(short.tangential_force) == pytest.approx(expected, rel=0.01)
    for other, key in (({"slide": "4 mm"}, "slide"), ({"slide": "-5 mm"}, "slide: -0.005 m")):
        with pytest.raises(fingerpad.SceneError, match=key):
            pad.predict(slid(**other))
    with pytest.raises(fingerpad.SceneError, match="keep"):
        pad.predict(slid(keep="depth"))
    assert len(pad.predict(STROKE | {"motion": STROKE["motion"][:1]}).time) == 2
    with pytest.raises(fingerpad.SceneError, match="that is pressed at a rate and held"):
        page(pad)


def test_a_slide_that_keeps_the_depth_or_differs_in_length_is_refused(tmp_path):
    kept = STROKE | {"motion": [STROKE["motion"][0], {"slide": "4 mm", "keep": "depth"}]}
    long = ACROSS | {"motion[1].slide": {"range": ["-4 mm", "-1 mm"]}}
    for name, more, said in (
        ("kept", {"base": kept}, "slide under that force"),
        ("long", {"base": STROKE, "over": long}, r"slide: is no knob; allowed: the longest"),
    ):
        folder = made_up(tmp_path / name, 2, **({"over": ACROSS, "show": stroke} | more))
        with pytest.raises(fingerpad.SceneError, match=said):
            fingerpad.emulate(folder)


# --- refusals and files ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changed", "key"),
    [
        (scene(force=90.0), "motion[0].press_to_force"),
        (scene(hold=2.5), "motion[1].hold"),
        (scene(friction=0.3), "friction"),
        (scene() | {"stimulus": {"shape": "line"}}, "stimulus"),
        (scene() | {"motion": [{"press_to_depth": "1 mm", "speed": "2 mm/s"}]}, "motion"),
        (scene(specimen={"outline": {"apex_radius": "9 mm"}}), "specimen.outline.apex_radius"),
        (scene(specimen={"layers": {"fat": {"youngs_modulus": "9 kPa"}}}), "specimen.layers.fat"),
        (scene(outputs={"receptors": {"depths": ["700 um"]}}), "outputs.receptors"),
        (scene() | {"stimulus": {"shape": "bar", "width": "2 mm"}}, 'stimulus.shape: "bar"'),
        (scene() | {"motion": [{"press_to_force": "20 gf"}, {"hold": "1 s"}]}, "rate: left out"),
        (
            scene() | {"motion": [{"press_to_force": "20 gf"}, {"slide": "1 mm"}]},
            "press_to_force, then slide with keep is outside",
        ),
        (
            scene(specimen={"layers": {"stratum_corneum": {"youngs_modulus": "1 MPa"}}}),
            "allowed: left out, as in the sweep",
        ),
    ],
)
def test_what_was_not_simulated_is_refused(pad, changed, key):
    with pytest.raises(fingerpad.SceneError) as caught:
        pad.predict(changed)
    text = str(caught.value)
    assert key in text and "; allowed: " in text and "\n" not in text and "null" not in text


def test_an_answer_knows_its_scene_and_says_what_only_a_run_knows(pad):
    found = pad.predict(scene())
    assert found.fingerpad.scene.stimulus.curvature == 210
    assert float(found.fingerpad.force_N[-1]) == pytest.approx(20 * GF)
    assert (found.peak_pressure >= found.centre_pressure).all()
    for ask in (fingerpad.summary, lambda of: of.fingerpad.plan, lambda of: of.fingerpad.errors):
        with pytest.raises(AttributeError, match=r"emulator: has no .*; allowed: a history of"):
            ask(found)


@pytest.mark.parametrize(
    ("points", "names"),
    [([210.0, 0.2, 0.4], None), ([[210.0, 0.2]], None), ([[210.0, 0.2, 0.4]], "contact_width")],
)
def test_points_and_names_of_another_form_are_refused(pad, points, names):
    with pytest.raises(ValueError, match="; allowed: "):
        pad.values(points, names)
    assert len(repr(pad)) < 200 and "press" in repr(pad) or "force" in repr(pad)


def test_outside_the_box_must_be_asked_for_and_has_no_band(pad):
    found = pad.predict(scene(force=70.0), extrapolate=True)
    assert "press_to_force" in found.attrs["outside"]
    assert np.isfinite(found.indentation_depth.values).all()
    assert np.isnan(found.indentation_depth_error.values[1:]).all()


def test_energies_jump_where_layers_meet(tmp_path):
    """The made-up pad's energies are ten times as large below the epidermis, whose thickness is a
    knob: each side has polynomials of its own.
    """
    thickness = "specimen.outline.epidermis_thickness"
    axes = {k: OVER[k] for k in list(OVER)[:2]} | {thickness: {"range": ["0.5 mm", "1.2 mm"]}}
    pad = fingerpad.emulate(made_up(tmp_path / "thick", 128, over=axes))
    assert pad.pieces.keys() == {f"energy_root_{d}_{layer}" for d in (0, 1) for layer in (0, 1)}

    def energies(thick):
        asked = scene(specimen={"outline": {"epidermis_thickness": f"{thick} mm"}})
        answer, true = pad.predict(asked), history(fingerpad.load_scene(asked))
        wrong = answer.strain_energy_density[-1] / np.interp(
            answer.time[-1], true.time, true.strain_energy_density[:, 0]
        )
        return answer.strain_energy_density[-1].values, float(wrong[0])

    thin, wrong = energies(0.59)
    thick, still = energies(0.61)
    assert energies(0.6)[0][0] == pytest.approx(thin[0], rel=0.03)  # on the border: the layer below
    assert thin[0] / thick[0] == pytest.approx(10, rel=0.03)
    assert wrong == pytest.approx(1, abs=0.02) and still == pytest.approx(1, abs=0.02)
    rows = {row["quantity"]: row for row in pad.about["held_out"]}
    assert rows["strain_energy_600_um"]["median"] < 0.01


def test_a_file_gives_the_same_answers(pad, tmp_path):
    pad.save(tmp_path / "pad.emulator")
    again = load_emulator(tmp_path / "pad.emulator")
    xr.testing.assert_identical(again.predict(scene()), pad.predict(scene()))
    assert "code_sha256" in again.about["provenance"]
    with np.load(tmp_path / "pad.emulator", allow_pickle=False) as found:
        assert json.loads(str(found["about"]))["format"] == 5


def test_the_commands_write_and_refuse(folder, tmp_path, capsys):
    file, page = tmp_path / "pad.emulator", tmp_path / "explorer.html"
    assert main(["emulate", str(folder), "--out", str(file)]) == 0
    assert "contact width" in capsys.readouterr().out
    assert main(["explore", str(file), "--out", str(page)]) == 0
    assert page.stat().st_size < 3e6
    capsys.readouterr()
    (tmp_path / "bad").write_bytes(b"PK\x03\x04 nothing")
    for words in (
        ["emulate", str(tmp_path), "--out", str(tmp_path / "x")],
        ["explore", str(tmp_path / "bad"), "--out", str(tmp_path / "x")],
        ["explore", str(tmp_path / "none"), "--out", str(tmp_path / "x")],
    ):
        assert main(words) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and "; allowed: " in said and words[1] in said
    assert not (tmp_path / "x").exists()


def test_words_need_an_emulator_each(tmp_path):
    softness = {"words": {"soft": "10 kPa", "hard": "20 kPa"}}
    over = OVER | {"specimen.layers.fat.youngs_modulus": softness}
    folder = made_up(tmp_path / "words", 4, over=over)
    with pytest.raises(fingerpad.SceneError, match="modulus: .*an emulator for each of its values"):
        fingerpad.emulate(folder)


def test_a_sweep_without_histories_is_refused(tmp_path):
    read = load_sweep(
        {"over": OVER, "design": "sobol", "samples": 4}, "bare", fingerpad.load_scene(SCENE)
    )
    lay_out(read, tmp_path / "bare", 1)
    with pytest.raises(fingerpad.SceneError, match="histories: true"):
        fingerpad.emulate(tmp_path / "bare")
