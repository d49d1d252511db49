"""Measured profiles: how their points are read, what is smoothed away, where they end, and that
they solve.
"""

from pathlib import Path

import numpy as np
import pytest
import yaml

from fingerpad import load_scene, plan, simulate
from fingerpad.cli import main
from fingerpad.documents import SceneError
from fingerpad.mechanics import stepping
from fingerpad.mechanics.stepping import NonConvergence, first_touch
from fingerpad.planning.plan import PlanError, read_plan
from fingerpad.results import summary
from fingerpad.stimuli.shapes import Cylinder
from fingerpad.stimuli.shapes.sampled import Points
from fingerpad.stimuli.smoothing import SIGMA, smoothed, turning
from measured_profiles import INSTRUMENTS, measured
from test_scene import changed, write

pytestmark = pytest.mark.unit

NAMES = ("indentation_depth", "contact_width", "centre_pressure", "strain_energy_density")


# -- the filter ----------------------------------------------------------------------------------


@pytest.mark.parametrize("spacing", [1e-6, 7e-6, 24e-6])
def test_the_filter_leaves_half_of_a_wave_at_its_cut_off(spacing):
    """ISO 16610-21: exp(-ln 2 (cut-off / wavelength)^2) of a wave is left."""
    x, cutoff = np.arange(-2e-3, 2e-3, spacing), 200e-6
    for wavelength, left in ((200e-6, 0.5), (400e-6, 2**-0.25), (100e-6, 2**-4.0)):
        wave = np.cos(2 * np.pi * x / wavelength)
        even, y = smoothed(x, wave, cutoff)
        sampled = np.sinc(spacing / wavelength) ** 2  # of the wave, joined by straight lines
        assert y[abs(even) < 1e-3].max() == pytest.approx(left * sampled, rel=0.01, abs=1e-3)


def test_the_filter_keeps_lines_to_their_ends_and_lifts_parabolas():
    x = np.sort(np.random.default_rng(0).uniform(-1e-3, 1e-3, 300))
    even, y = smoothed(x, 0.3 * x + 1e-4, 100e-6)
    np.testing.assert_allclose(y, 0.3 * even + 1e-4, atol=1e-15)
    assert (even[0], even[-1]) == (x[0], x[-1])
    fine = np.linspace(-1e-3, 1e-3, 4001)
    even, y = smoothed(fine, fine**2 / 2 * 400, 100e-6)
    inside = abs(even) < 0.8e-3
    np.testing.assert_allclose(
        (y - even**2 / 2 * 400)[inside], (SIGMA * 100e-6) ** 2 / 2 * 400, rtol=2e-3
    )


def test_turning_to_and_fro_is_noise_and_turning_one_way_is_shape():
    x = np.linspace(-2e-3, 2e-3, 801)
    assert turning(x, Cylinder(curvature=400.0).outline(x), 100e-6).max() < 1e-8
    wedge = np.array([[-1.0, 0.0, 1e-6, 2e-6, 1.0], [1.0, 0.0, 0.0, 0.0, 1.0]])
    assert turning(*wedge, 1.0).max() == 0
    zigzag = np.where(np.arange(801) % 2, 1e-6, 0.0)
    angle = np.arctan(1e-6 / (x[1] - x[0]))
    # of 20 kinks of twice that angle, half go one way and half the other
    assert turning(x, zigzag, 99.9e-6).max() == pytest.approx(20 * 2 * angle, rel=1e-6)


@pytest.mark.parametrize("edge", [269e-6, 67e-6, 20e-6])
def test_profiles_without_noise_are_left_alone(edge):
    """Arcs of enough points, a wedge of five, a grating of sharp teeth: not one bit of their points
    changes.
    """
    arc = np.linspace(-2.4e-3, 2.4e-3, 201)
    round_arc = arc, Cylinder(curvature=400.0).outline(arc)
    teeth = np.cumsum(np.tile([1.0, 0.2, 0.6, 0.2], 6)) * 1e-3
    for x, y in (
        round_arc,
        np.round(round_arc, 9),
        1e-3 * np.array([[-2, -1, 0, 1, 2], [1, 0.25, 0, 0.25, 1]]),
        (teeth, np.tile([0, 0, 3e-4, 3e-4], 6)),
    ):
        raw = Points(x, y)
        felt = raw.felt(edge)
        assert felt.smoothing == 0 and felt.moved(-1, 1) == 0
        np.testing.assert_array_equal(felt.samples, raw.samples)


def test_smooth_is_auto_none_or_a_length():
    x, y, _ = measured(1)
    assert Points(x, y).felt(200e-6).smoothing == pytest.approx(400e-6)
    assert Points(x, y, smooth="none").felt(100e-6).smoothing == 0
    felt = Points(x, y, smooth=50e-6).felt(100e-6)
    assert felt.smoothing == 50e-6 and 1e-7 < felt.moved(-1e-3, 1e-3) < 3e-6


def test_finer_meshes_come_to_longer_cutoffs():
    """Two edges, where it is rough to them, or octaves of them, up to two edges of the thesis's
    skin: noise is no shape.
    """
    x, y, shape = measured(2)
    assert Points(x, shape).cutoffs(30e-6) == [0.0]
    # 24 um between points: nodes 33.6 um apart see one kink at a time, and no roughness
    for number, edge, expected in (
        (2, 268.8e-6, [537.6e-6]),
        (2, 134.4e-6, [268.8e-6]),
        (2, 33.6e-6, [0.0, 67.2e-6, 134.4e-6, 268.8e-6]),
        (1, 40e-6, [80e-6, 160e-6, 268.8e-6]),
    ):
        assert Points(*measured(number)[:2]).cutoffs(edge) == pytest.approx(expected)


def test_noise_is_smoothed_away_and_shape_is_kept(folder):
    """At 2 %: a cylinder's noise over 269 um, which leaves a cylinder; fine textures as short as
    the mesh feels them.
    """
    x, y, _ = measured(2)
    assert surface_at(folder, x, y, 0.02).smoothing == pytest.approx(268.8e-6)
    x = np.linspace(-3e-3, 3e-3, 1201)
    waves = x**2 / 2 / 2.5e-3 + 10e-6 * np.cos(2 * np.pi * x / 300e-6)
    surface = surface_at(folder, x, waves, "fine")
    assert surface.smoothing <= 134.5e-6 and surface.moved < 2e-6


# -- where the points end ------------------------------------------------------------------------


def test_ends():
    """Beyond the points: nothing but a rounded way up, a level surface, or the last slope for
    ever.
    """
    x, y = [-1e-3, 0.0, 1e-3], [1e-4, 0.0, 1e-4]
    for ends, distance, outside, rel in (
        ("slope", 2e-4 * np.cos(np.arctan(0.1)), 2e-4, 1e-9),
        ("level", 1e-4, 1e-4, 1e-9),
        ("open", np.hypot(1e-3, 1e-4), np.nan, 0.06),
    ):
        profile = Points(x, y, ends).at(0.0, 50e-6)
        found = profile.evaluate(np.array([[2e-3, 0.0], [-2e-3, 0.0]]))[0]
        assert found == pytest.approx([distance] * 2, rel=rel), ends
        assert profile.outline(np.array([2e-3])) == pytest.approx([outside], nan_ok=True)
    assert profile.symmetric and profile.steepness == pytest.approx(0.1)
    assert profile.convexity == pytest.approx(Points(x, y, "slope").convexity)


@pytest.mark.parametrize("ends", ["open", "level", "slope"])
def test_distance_beside_the_ends_is_the_closest_of_all(ends):
    """Against every piece one by one, around and beyond the ends, the gradient its derivative."""
    rng = np.random.default_rng(3)
    x = np.cumsum(rng.uniform(1e-4, 3e-4, 12))
    profile = Points(x, 1e-4 * rng.normal(size=12), ends).at(0.0, 1e-4)
    at = np.column_stack([rng.uniform(x[0] - 2e-3, x[-1] + 2e-3, 60), rng.uniform(-1e-3, 1e-3, 60)])
    fine = np.linspace(x[0] - 4e-3, x[-1] + 4e-3, 100001)
    height = profile._height(fine)
    nearest = [np.hypot(fine - a, height - b).min() for a, b in at]
    np.testing.assert_allclose(np.abs(profile.evaluate(at)[0]), nearest, atol=1e-6)


PRESS = [{"press_to_force": "20 gf"}]


def scene(folder, points, motion=PRESS, accuracy="draft", **keys):
    """A scene with a profile of points, in mm or as text."""
    if not isinstance(points, str):
        points = "".join(f"{x:.9f},{y:.9f}\n" for x, y in np.transpose(points))
    (folder / "p.csv").write_text("x (mm),y (mm)\n" + points)
    stimulus = {"shape": "sampled", "csv": "p.csv"} | keys
    document = {"stimulus": stimulus, "motion": motion, "accuracy": accuracy}
    (folder / "scene.yaml").write_text(yaml.safe_dump(document))
    return folder / "scene.yaml"


WEDGE = "-2,1\n-1,.25\n0,0\n1,.25\n2,1\n"


def test_one_more_point_is_no_endless_wedge(tmp_path):
    """A falling last segment changes nothing where contact does not come; extended for ever it goes
    0.3 mm deeper.
    """
    plain, more, extended = (
        simulate(load_scene(scene(tmp_path, WEDGE + one_more, **keys)))
        for one_more, keys in (("", {}), ("2.1,0.9\n", {}), ("2.1,0.9\n", {"ends": "slope"}))
    )
    depth = [float(history.indentation_depth[-1]) * 1e3 for history in (plain, more, extended)]
    assert depth[0] == pytest.approx(1.261, abs=2e-3)
    assert depth[1:] == [pytest.approx(depth[0], rel=1e-4), pytest.approx(1.559, abs=0.01)]
    assert "contact_reached_profile_end" not in summary(plain)["run"]
    assert summary(extended)["run"]["contact_reached_profile_end"]


def test_a_rim_that_falls_touches_where_it_is_lowest():
    """It is rounded, and lower than its last point, where the profile is moved down until it
    touches: nothing is inside the skin before.
    """
    x = np.linspace(-8e-3, 8e-3, 81)
    hollow = Points(x, 3.2e-3 * (1 - (x / 8e-3) ** 2)).at(0.0, 0.2e-3)
    skin = np.column_stack([np.linspace(-10e-3, 10e-3, 801), np.zeros(801)])
    height = first_touch(skin, hollow)
    gap = hollow.evaluate(skin - [0.0, height])[0]
    assert gap.min() == pytest.approx(0.0, abs=1e-7)
    slope = np.arctan(2 * 3.2 / 8 * (1 - 0.1 / 8))  # of the last two points
    assert height == pytest.approx(0.2e-3 * (1 - np.cos(slope)), rel=0.02)


def test_contact_at_the_end_of_the_points_is_said(tmp_path, capsys):
    """On the command line of plan and run, and in the summary."""
    path, said = (
        str(scene(tmp_path, "-0.5,0\n0.5,0\n")),
        "reach the end of the profile's points at x =",
    )
    assert main(["plan", path]) == 0
    assert f"contact is expected to {said}" in capsys.readouterr().out
    assert main(["run", path, "--out", str(tmp_path / "out")]) == 0
    assert f"note: contact {said.replace('reach', 'reached')}" in capsys.readouterr().out


def test_points_beside_the_finger_are_refused(tmp_path, capsys):
    path = scene(tmp_path, "10,0\n20,0\n")
    with pytest.raises(PlanError, match="none of them over the finger"):
        plan(load_scene(path))
    assert main(["plan", str(path)]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert "stimulus.csv: 'p.csv' has points from x = 10 mm to 20 mm" in line


# -- reading -------------------------------------------------------------------------------------


def read(folder, content):
    (folder / "profile.csv").write_text(content)
    stimulus = {"shape": "sampled", "csv": "profile.csv"}
    return load_scene(write(folder, changed(stimulus=stimulus)))


@pytest.mark.parametrize(
    "content",
    [
        "x (um), y (um)\n-1000,500\n0,0\n1000,500\n",
        "# scanned on Monday\nx (m),y (m)\n-1e-3,5e-4\n# the middle\n0,0\n\n1e-3,5e-4\n",
        "y (um),note,x (mm)\n500,left,-1\n0,middle,0\n500,right,1\n",
    ],
)
def test_columns_in_any_unit_of_length(content, tmp_path):
    found = read(tmp_path, content).stimulus
    assert found.x == pytest.approx((-1e-3, 0, 1e-3)) and found.y == pytest.approx((5e-4, 0, 5e-4))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (
            "x (km),y (km)\n-1,0\n1,1\n",
            "is 2e+03 m wide by its column 'x (km)'; allowed: 10 um to 10 m",
        ),
        ("x (m),y (m)\n-1,0\n10,1\n", "is 11 m wide"),
        ("x (nm),y (nm)\n-1,0\n1,1\n", "is 0.002 um wide by its column 'x (nm)'"),
        ("x (s),y (mm)\n-1,0\n1,1\n", "has the column 'x (s)', which has the wrong dimension"),
        (
            "x (mmm),y (mm)\n-1,0\n1,1\n",
            "has the column 'x (mmm)', which has the unknown unit 'mmm'",
        ),
        ("x (mm),h (mm)\n-1,0\n1,1\n", "has no column 'y (mm)'"),
        ("# nothing\n", "holds no rows"),
        ("# one\n\nx (mm),y (mm)\n-1,0\n#\n1,nan\n", "has 'nan' in row 6"),
    ],
)
def test_units_that_cannot_be_meant(content, words, tmp_path):
    with pytest.raises(SceneError) as caught:
        read(tmp_path, content)
    assert words in str(caught.value) and len(str(caught.value).splitlines()) == 1


# -- noise ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("measured")


def pressed(folder, x, y, smooth, motion=PRESS):
    points = 1e3 * np.array([x, y])
    loaded = load_scene(scene(folder, points, motion, smooth=smooth))
    return plan(loaded), simulate(loaded)


def surface_at(folder, x, y, accuracy):
    motion = [{"press_to_depth": "0.8 mm"}]
    return plan(load_scene(scene(folder, 1e3 * np.array([x, y]), motion, accuracy))).surface


def end_depth(*how):
    return pressed(*how)[1].indentation_depth.values[-1]


def check_one(folder, number, exact):
    """The answer with noise is the one without within the error that it states, and says how it
    came about.
    """
    x, y, shape = measured(number)
    name = INSTRUMENTS[number][0]
    if name not in exact:
        exact[name] = pressed(folder, x, shape, "none")[1].isel(time=-1)
    chosen, history = pressed(folder, x, y, "auto")
    assert chosen.surface.smoothing > 0 and "smoothed at" in summary(history)["run"]["notes"][0]
    end, error = history.isel(time=-1), history.attrs["estimated_error"]
    for quantity in NAMES:
        truth, said = exact[name][quantity].values, f"{name}: {quantity}"
        np.testing.assert_allclose(end[quantity], truth, rtol=error, atol=1e-9, err_msg=said)


@pytest.mark.parametrize("number", [2, 3, 15])
def test_noise_changes_no_more_than_is_said(number, folder):
    check_one(folder, number, {})


@pytest.mark.slow
@pytest.mark.stability
def test_thirty_measured_profiles(folder):
    """White and coloured noise, rounding, textures, dots and edges, each within its stated error of
    the noise-free answer.
    """
    exact = {}
    for number in range(len(INSTRUMENTS)):
        check_one(folder, number, exact)


def test_noise_can_be_kept(folder):
    """A thousand valleys, each narrower than the nodes are apart: the skin lies on what stands out,
    nearly as on the shape.
    """
    x, y, shape = measured(1)
    noisy, smooth = shape + 8 * (y - shape), end_depth(folder, x, shape, "none")
    assert end_depth(folder, x, noisy, "none") == pytest.approx(smooth, rel=1e-2)


def test_the_advice_works(folder, monkeypatch):
    """Noise of micrometres every micrometre takes long as it is; the message names it and a
    smoothing with which it does not.
    """
    x, y, shape = measured(7)
    y = shape + 20 * (y - shape)
    monkeypatch.setattr(stepping, "MOST_ITERATIONS", 20)
    said = 'corners are 1 um apart, the nodes 134 um: stimulus.smooth: "269 um"'
    path = Path(scene(folder, 1e3 * np.array([x, y]), PRESS, smooth="none"))
    path.write_text(path.read_text() + "\non_trouble: stop\n")
    with pytest.raises(NonConvergence, match=said) as caught:
        simulate(path)
    advised = str(caught.value).split('stimulus.smooth: "')[1].split('"')[0]
    smooth = end_depth(folder, x, shape, "none")
    assert end_depth(folder, x, y, advised) == pytest.approx(smooth, rel=1e-2)


@pytest.mark.parametrize(
    "motion",
    [
        [
            {"press_to_depth": "0.6 mm", "speed": "2 mm/s"},
            {"slide": "1 mm", "speed": "10 mm/s", "keep": "depth"},
        ],
        [
            {"press_to_force": "20 gf", "rate": "40 gf/s"},
            {"slide": "1 mm", "speed": "10 mm/s"},
        ],
        [*PRESS, {"step": "1 mm", "every": "0.5 mm"}],
    ],
    ids=["stroked at a depth", "stroked", "stepped"],
)
def test_noisy_profiles_are_stroked_and_stepped(motion, folder):
    """As those without noise."""
    x, y, shape = measured(5)
    (_, noisy), (_, exact) = (pressed(folder, x, heights, "auto", motion) for heights in (y, shape))
    for name in ("indentation_depth", "force"):
        error = noisy.attrs["estimated_error"]
        np.testing.assert_allclose(noisy[name][-1], exact[name][-1], rtol=error)


def test_the_smoothing_of_a_plan_is_kept(folder, tmp_path):
    x, y, _ = measured(1)
    chosen, _ = pressed(folder, x, y, "0.1 mm")
    assert chosen.surface.smoothing == pytest.approx(1e-4)
    assert chosen.discretisation["profile_smoothed_um"] == 100
    chosen.write(tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json").surface == chosen.surface
