"""What is unbounded is a property of the contact found: corners that the mesh sees, edges and ends
that are touched.
"""

import numpy as np
import pytest

import fingerpad
from fingerpad.cli import _error_line
from fingerpad.planning.plan import plan
from fingerpad.results import summary
from fingerpad.scenes.scene import load_scene
from own_meshes import SLAB, slab

pytestmark = pytest.mark.verification

PRESS = [{"press_to_force": "20 gf"}]
PRESETS = ("draft", "thesis", "fine")


def sampled(folder, x, y, motion=PRESS, accuracy="draft"):
    path, points = folder / "profile.csv", 1e3 * np.column_stack([x, y])
    rows = (f"{a:.9g},{b:.9g}" for a, b in points)
    path.write_text("\n".join(["x (mm),y (mm)", *rows]))
    stimulus = {"shape": "sampled", "csv": str(path)}
    return load_scene({"stimulus": stimulus, "motion": motion, "accuracy": accuracy})


def parabola(folder, spacing, **keys):
    x = np.arange(-6e-3, 6e-3 + spacing / 2, spacing)
    return sampled(folder, x, 100 * x**2, **keys)


def marks(history):
    """What line, summary and variables say, which must agree."""
    totals = summary(history)
    run = totals["run"]
    at, comment = run["peak_pressure_unbounded_at"], history.peak_pressure.attrs.get("comment", "")
    assert run["peak_pressure_singular"] == bool(at)
    for text in (comment, _error_line(totals), history.attrs["error_covers"]):
        assert ("unbounded" in text) == bool(at)
    return at


def peak(history):
    return float(history.peak_pressure[-1])


@pytest.mark.parametrize("accuracy", ["draft", "thesis", 0.03])
@pytest.mark.parametrize(
    ("force", "spacing"), [("2 gf", 5e-6), ("2 gf", 20e-6), ("40 gf", 10e-6), ("40 gf", 80e-6)]
)
def test_a_smooth_profile_sampled_densely_is_never_marked(tmp_path, spacing, accuracy, force):
    """Twenty points in the contact are dense enough."""
    scene = parabola(tmp_path, spacing, accuracy=accuracy, motion=[{"press_to_force": force}])
    history = fingerpad.simulate(scene)
    assert marks(history) == ""
    assert not plan(scene).unbounded


def test_nineteen_points_of_a_curve_have_corners_that_grow(tmp_path):
    """The same surface sampled coarsely: its peak does not settle, and is marked; sampled densely
    it does, and is not.
    """
    coarse, dense = (
        [fingerpad.simulate(parabola(tmp_path, spacing, accuracy=a)) for a in PRESETS]
        for spacing in (12e-3 / 18, 20e-6)
    )
    for history in coarse:
        assert "corners from x = -1" in marks(history)
        assert "pressure, " not in history.attrs["error_covers"].split(";")[0]
    peaks, settled = (list(map(peak, histories)) for histories in (coarse, dense))
    assert (np.diff(peaks) > 0.1 * peaks[0]).all() and np.ptp(settled) < 0.005 * settled[0]
    depths = [float(history.indentation_depth[-1]) for history in coarse]
    assert np.ptp(depths) < 0.01 * depths[0]  # which keeps its error


def test_a_wedge_is_unbounded_at_the_centre_too(tmp_path):
    scene = sampled(tmp_path, np.array([-4e-3, 0, 4e-3]), np.array([2e-3, 0, 2e-3]))
    assert plan(scene).unbounded.centre and "centre" not in plan(scene).covers
    history = fingerpad.simulate(scene)
    assert marks(history) == "the corner at x = 0 mm"
    assert (
        "unbounded" in history.centre_pressure.attrs["comment"]
        and "centre" not in history.attrs["error_covers"]
    )


@pytest.mark.parametrize(
    ("width", "fillet", "marked"),
    [("2 mm", None, True), ("12 mm", None, False), ("2 mm", "0.5 mm", False)],
)
def test_a_bar_is_marked_where_its_edges_touch(width, fillet, marked):
    """A bar wider than the contact is a plate."""
    stimulus = {"shape": "bar", "width": width} | ({"fillet": fillet} if fillet else {})
    history = fingerpad.simulate({"stimulus": stimulus, "motion": PRESS, "accuracy": "draft"})
    assert (marks(history) == "the edges at x = -1 and 1 mm") == marked == bool(marks(history))


def test_open_ends_are_marked_where_they_touch(tmp_path):
    x = np.linspace(-6e-3, 1e-3, 701)
    history = fingerpad.simulate(sampled(tmp_path, x, 20 * x**2))
    assert marks(history) == "the end of the profile's points at x = 1 mm"
    short = fingerpad.simulate(
        sampled(tmp_path, x, 20 * x**2, motion=[{"press_to_force": "0.5 gf"}])
    )
    assert marks(short) == ""


def test_marks_are_of_each_leg(tmp_path):
    """Pressed on the plain part of a surface, then slid over a ridge with a sharp top."""
    x = np.array([-8e-3, 5e-3, 6e-3, 7e-3, 12e-3])
    y = np.array([0.0, 0.0, -0.15e-3, 0.0, 0.0])
    motion = [{"press_to_force": "5 gf"}, {"slide": "6 mm", "speed": "20 mm/s"}]
    totals = summary(fingerpad.simulate(sampled(tmp_path, x, y, motion)))
    first, second = (leg["peak_pressure_unbounded_at"] for leg in totals["legs"])
    assert (
        first == ""
        and second == "the corner at x = 6 mm" == totals["run"]["peak_pressure_unbounded_at"]
    )


# --- the end of the skin ------------------------------------------------------------------------

ENDS = {
    # skin from, to (mm) of a slab from -10 to 10 mm; friction; is the end unbounded?
    "the whole top": (-10, 10, 0.0, False),
    "the whole top, with friction": (-10, 10, 0.5, True),
    "part of the top": (-5, 5, 0.0, True),
}


@pytest.mark.parametrize("name", ENDS)
def test_the_end_of_the_skin_is_unbounded_where_the_peak_there_grows(tmp_path, name):
    """A plate over all of a skin: Williams's wedge says where the corner's pressure has a bound,
    and finer meshes confirm it.
    """
    low, high, friction, unbounded = ENDS[name]
    found = []
    for edge in (0.5e-3, 0.25e-3):
        slab(tmp_path / "slab.msh", edge, low * 1e-3, high * 1e-3)
        scene = SLAB(tmp_path / "slab.msh") | {"stimulus": {"shape": "flat"}, "friction": friction}
        assert bool(plan(scene).unbounded) == unbounded
        found.append(fingerpad.simulate(scene))
        assert ("the end of the skin" in marks(found[-1])) == unbounded
    ends = [float(history.contact_pressure[-1, 0]) for history in found]
    assert (ends[1] > 1.2 * ends[0]) == unbounded


def test_the_plan_says_where_the_indenter_meets_the_skin(tmp_path):
    slab(tmp_path / "slab.msh", 0.5e-3, 0.0, 10e-3, left=0.0)
    said = " ".join(plan(SLAB(tmp_path / "slab.msh")).specimen)
    assert "meets the skin at x = 0, y = 5 mm" in said and "the end of the skin" in said
    slab(tmp_path / "slab.msh", 0.5e-3)
    assert "the end of the skin" not in " ".join(plan(SLAB(tmp_path / "slab.msh")).specimen)
