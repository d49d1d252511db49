"""What newcomers try first, and what they are told."""

from dataclasses import replace

import numpy as np
import pytest

import fingerpad
from fingerpad.cli import main
from fingerpad.planning.unbounded import seen_corners
from fingerpad.results import read_history, summary, write_history
from fingerpad.specimen.files import write_pad
from fingerpad.stimuli.shapes.sampled import Points
from fingerpad.sweeps.design import Design
from fingerpad.sweeps.language import load_sweep
from fingerpad.tables import TableError, read_table
from own_meshes import SLAB, slab_mesh

pytestmark = pytest.mark.unit

SCENE = """stimulus: {shape: cylinder, curvature: "400 1/m"}
motion: [{press_to_force: "20 gf", rate: "40 gf/s"}, {hold: "0.2 s"}]
accuracy: {skin_edge: "0.8 mm", steps: 4}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


def test_a_history_is_read_by_its_folder_and_has_one_number_for_the_error(folder, capsys):
    assert main(["run", "scene.yaml", "--out", "out"]) == 0
    history = read_history("out")
    error = history.attrs["estimated_error"]
    assert history.equals(read_history("out/history.nc"))
    assert f"error about {100 * error:.2g} %" in capsys.readouterr().out
    assert summary(history)["run"]["estimated_error"] == error
    (folder / "empty").mkdir()
    with pytest.raises(FileNotFoundError):
        read_history("empty")


def test_width_of_the_contact_and_of_what_touches(tmp_path):
    """Over a texture the contact has gaps: its width is from outermost to outermost, what touches
    is a share of it.
    """
    x = np.arange(-12, 12.001, 0.01)
    profile = np.column_stack([x, 0.075 * (1 - np.cos(2 * np.pi * x / 1.6))])
    np.savetxt(tmp_path / "p.csv", profile, delimiter=",", header="x (mm),y (mm)", comments="")
    scene = {
        "stimulus": {"shape": "sampled", "csv": str(tmp_path / "p.csv")},
        "motion": [{"press_to_force": "10 gf"}],
    }
    for symmetry in ("on", "off"):
        history = fingerpad.simulate(scene | {"effects": {"symmetry": symmetry}})
        end = summary(history)["legs"][-1]
        assert end["contact_width_mm"] == pytest.approx(3.41, abs=0.05)
        assert end["touching_width_mm"] == pytest.approx(1.12, abs=0.05)
    smooth = fingerpad.simulate(
        {"stimulus": {"shape": "cylinder", "curvature": "100 1/m"}, "motion": scene["motion"]}
    )
    np.testing.assert_allclose(smooth.touching_width, smooth.contact_width)
    write_history(history, tmp_path / "h.nc")
    assert "touching_width" in read_history(tmp_path / "h.nc")


TOPS = {
    "hollow": lambda x: 5e-3 + 0.2 * x**2,
    "deeply hollow": lambda x: 4e-3 + 10 * x**2,
    "tilted": lambda x: 5e-3 + 0.01 * x,
    "with a step": lambda x: np.where(x < 1e-3, 4e-3, 5e-3),
}


@pytest.mark.parametrize("top", TOPS)
def test_the_middle_of_a_skin_is_over_zero_however_high_it_is_there(tmp_path, top):
    """And receptors are found below all of it; no node is at x = 0 exactly."""
    flat = slab_mesh(0.5e-3, left=-10.2e-3, right=9.8e-3, low=-10.2e-3, high=9.8e-3)
    x, y = flat.points.T
    bent = replace(flat, points=np.column_stack([x, y * TOPS[top](x) / 5e-3]))
    write_pad(bent.raised(), tmp_path / "m.msh")
    scene = SLAB(tmp_path / "m.msh") | {
        "outputs": {"receptors": {"depths": ["0.5 mm"], "offsets": ["-4 mm", "0 mm", "4 mm"]}}
    }
    history = fingerpad.simulate(scene)
    middle = np.argmin(np.abs(history.skin_x.values))
    assert (
        history.skin_arc.values[middle] == 0
        and np.argmin(np.abs(history.skin_arc.values)) == middle
    )
    np.testing.assert_array_equal(
        history.centre_lateral_displacement, history.skin_displacement_x[:, middle]
    )
    np.testing.assert_array_equal(history.centre_pressure, history.contact_pressure[:, middle])


@pytest.mark.parametrize(
    "over",
    [
        "table: t.csv",
        "specimen.contact_length: [10, 11]",
        "specimen.contact_length: {range: [10, 11], count: 2}",
    ],
)
def test_a_sweep_takes_no_number_without_its_unit(folder, capsys, over):
    (folder / "t.csv").write_text("specimen.contact_length,friction\n10,0.1\n11,0.2\n")
    (folder / "sweep.yaml").write_text(f"scene: scene.yaml\nover:\n  {over}\n")
    assert main(["sweep", "sweep.yaml"]) == 2
    said = capsys.readouterr().err
    assert (
        "contact_length: 10" in said
        and " has no unit; allowed: a length with its unit such as" in said
    )


def test_a_sweep_takes_bare_numbers_where_none_has_a_unit(folder):
    over = {
        "friction": [0, 0.1],
        "accuracy.steps": [4, 5],
        "specimen.layers.fat.poisson_ratio": {"range": [0.3, 0.4], "count": 2},
    }
    design = Design(load_sweep({"scene": "scene.yaml", "over": over}))
    design.check()
    assert (
        len(design) == 8
        and type(design.scene(0).accuracy.steps) is int
        and type(design.scene(7).friction) is float
    )


def corners_seen(x, y, **keys):
    """x (mm) of the corners of a profile (mm) that nodes 60 um apart see under 10 kPa."""
    corners = Points(1e-3 * np.asarray(x), 1e-3 * np.asarray(y), **keys).corners()
    inner = corners[np.abs(corners[:, 0]) < 0.99e-3 * np.max(x)]
    return 1e3 * seen_corners(inner, 0.2e6, 10e3, 60e-6, 2e-3)


@pytest.mark.parametrize("samples", [121, 301, 1201, 2401, 6001])
@pytest.mark.parametrize("slope", [0.2, 1.0, 10.0])
def test_a_sharp_corner_is_one_at_every_sampling(samples, slope):
    """Between two samples it is cut off by the line that joins them."""
    x = np.linspace(-6, 6, samples)
    np.testing.assert_allclose(
        np.abs(corners_seen(x, slope * np.maximum(0, np.abs(x) - 1.5))), 1.5, atol=0.021
    )
    assert len(corners_seen(x, slope * np.abs(x))) == 1


def test_a_smooth_profile_has_no_corner_however_it_is_sampled():
    x = np.linspace(-4, 4, 1601)
    rise = np.clip(np.abs(x) - 1.5, 0, 0.04 * np.sin(np.pi / 4))
    rough = np.random.default_rng(0).standard_normal(x.size)
    smooth = {
        "circle": 5 - np.sqrt(25 - x**2),
        "parabola": 0.1 * x**2,
        "sine": 0.1 * np.cos(2 * np.pi * x / 3),
        "fillet of eight samples": 0.04
        - np.sqrt(0.04**2 - rise**2)
        + np.maximum(0, np.abs(x) - 1.5 - rise),
        "rough": 0.1 * x**2 + 1e-4 * rough,
        "rounded": np.round(0.1 * x**2, 4),
    }
    assert {name: len(corners_seen(x, y)) for name, y in smooth.items()} == dict.fromkeys(smooth, 0)


def test_a_fillet_that_the_mesh_cannot_tell_is_marked_where_it_begins():
    history = fingerpad.simulate(
        {
            "stimulus": {"shape": "bar", "width": "3 mm", "fillet": "0.5 mm"},
            "motion": [{"press_to_force": "10 gf"}],
            "accuracy": "draft",
        }
    )
    at = history.attrs["unbounded_at"]
    assert (
        at == "the edges finer than the mesh at x = -1 and 1 mm"
        and history.contact_width[-1] > 2e-3
    )


COLUMNS_TWICE = {
    "motion: [{table: t.csv}]": "time (s),force (N),force (gf)\n0,0,0\n1,0.1,20\n",
    "motion: {table: t.csv}": "time (s),time (ms),force (gf)\n0,0,0\n1,10,20\n",
    "stimulus: {shape: sampled, csv: t.csv}": "x (mm),y (mm),y (um)\n-1,0,1\n1,0,1\n",
}


@pytest.mark.parametrize("line", COLUMNS_TWICE)
def test_a_quantity_in_two_columns_is_refused(folder, capsys, line):
    (folder / "t.csv").write_text(COLUMNS_TWICE[line])
    kept = [each for each in SCENE.splitlines() if not each.startswith(line.partition(":")[0])]
    (folder / "scene.yaml").write_text("\n".join([*kept, line]))
    assert main(["plan", "scene.yaml"]) == 2
    said = capsys.readouterr().err
    assert (
        said.count("\n") == 1
        and " has two columns of " in said
        and "; allowed: one column of " in said
    )


@pytest.mark.parametrize(
    "cell", ["#REF!", "#N/A", "#DIV/0!", "#VALUE!", "#NAME?", "#NULL!", '"#NUM!"']
)
@pytest.mark.parametrize("sign", ",;\t ")
def test_what_spreadsheets_write_for_no_value_is_no_comment(folder, cell, sign):
    lines = ["a,b", "1,2", "# N/A is a comment", "#NONE,3", f"{cell},3"]
    (folder / "t.csv").write_text("\n".join(lines).replace(",", sign) + "\n")
    with pytest.raises(
        TableError, match=r"has '.?#[A-Z/0?!]*.?' in row 5, column 'a', which is no finite number"
    ):
        read_table("t.csv").numbers(0)


def test_points_between_thousands_are_refused_where_semicolons_tell_the_language(folder):
    (folder / "t.csv").write_text("x;y\n-6;3.600\n-5;2.500\n-3;900\n")
    with pytest.raises(
        TableError, match="has '3.600' in row 2 beside whole numbers, which may be thousands"
    ):
        read_table("t.csv")
    (folder / "t.csv").write_text("x;y\n-6;3.600\n-5;2.5\n-3;900\n")
    assert read_table("t.csv").numbers(1) == [3.6, 2.5, 900]


def test_a_receptor_below_the_pad_is_told_how_deep_it_may_be(tmp_path):
    write_pad(slab_mesh(0.5e-3).raised(), tmp_path / "m.msh")
    scene = SLAB(tmp_path / "m.msh") | {
        "outputs": {"receptors": {"depths": ["6 mm"], "offsets": ["-10 mm", "0 mm", "10 mm"]}}
    }
    with pytest.raises(ValueError, match="outside the soft tissue; allowed: depths below 5 mm"):
        fingerpad.simulate(scene)


def test_a_stimulus_that_passes_through_the_pad_is_no_result(folder, capsys):
    (folder / "needle.csv").write_text(
        "x (um),y (mm)\n-30,0.9\n-20,0.4\n-10,0.1\n0,0\n10,0.1\n20,0.4\n30,0.9\n"
    )
    (folder / "scene.yaml").write_text(
        "stimulus: {shape: sampled, csv: needle.csv}\nmotion: [{press_to_force: 10 "
        "gf}]\naccuracy: draft\non_trouble: stop\n"
    )
    assert main(["run", "scene.yaml", "--out", "out", "--quiet"]) == 3
    assert "mm deep in a pad that is" in capsys.readouterr().err
