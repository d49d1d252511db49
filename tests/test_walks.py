"""Three newcomers' first days, outside the source tree: a researcher's scenes, an engineer's
variations, a student's mesh.
"""

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import meshio
import numpy as np
import pytest
import yaml

import fingerpad
from cysyk1999.reference_data import read_force_depth
from cysyk1999.studies.calibration.force import ElasticCurve, fit_constant
from fingerpad.cli import main
from fingerpad.results import read_history

pytestmark = pytest.mark.workflow

COARSE = {"skin_edge": "0.5 mm", "steps": 24}
PRESS, STEADY = {"press_to_force": "20 gf", "rate": "40 gf/s"}, {"press_to_force": "20 gf"}
ROUND, PLATE = {"shape": "cylinder", "curvature": "400 1/m"}, {"shape": "flat"}
WAVES = {
    "shape": "wavy",
    "curvatures": ["100 1/m", "200 1/m"],
    "lead_in": "6 mm",
    "run_out": "6 mm",
}
SOFT = {"layers": {"fat": {"youngs_modulus": "8 kPa"}}}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def told(name, capsys, *options, stimulus=ROUND, motion=(STEADY,), accuracy=COARSE, **keys):
    """Run a scene as a command; its summary and its line."""
    document = {"stimulus": stimulus, "motion": list(motion), "accuracy": accuracy, **keys}
    Path(f"{name}.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    assert main(["run", f"{name}.yaml", *options]) == 0
    out, err = capsys.readouterr()
    assert err == "" and out.count("\n") == 1 + out.count("\nnote: ")
    assert f"results in results/{name}" in out
    left = {path.name for path in Path("results", name).iterdir()}
    assert {"history.nc", "plan.json", "summary.json"} <= left
    return json.loads(Path("results", name, "summary.json").read_text()), out


def pressed(name, capsys, *options, **keys):
    """What the summary says of the last leg of such a run."""
    return told(name, capsys, *options, **keys)[0]["legs"][-1]


# --- the researcher -------------------------------------------------------------------------------


def test_a_researcher_presses(capsys):
    """Ramps, plates, needles, edges and steady states: the force comes back as it went in, and
    shapes come in their order.
    """
    ramp, line = told("ramp", capsys, motion=[PRESS])
    assert "force 20.0 gf (17.2 N/m)" in line
    assert ramp["legs"][-1]["force_gf"] == pytest.approx(20, rel=1e-4)
    held = [PRESS, {"hold": "60 s"}]
    creep, _ = told("creep", capsys, motion=held, outputs={"responses": True})
    steady = pressed("steady", capsys)["depth_mm"]
    assert ramp["legs"][-1]["depth_mm"] < creep["legs"][-1]["depth_mm"]
    assert creep["legs"][-1]["depth_mm"] == pytest.approx(steady, rel=0.01)
    sent = list({row["depth_mm"]: row["impulses"] for row in creep["responses"]}.values())
    assert sent == sorted(sent, reverse=True) and max(sent) > 100
    bar = {"shape": "bar", "width": "3 mm", "fillet": "0.3 mm"}
    light = [{"press_to_force": "10 gf"}]
    knife = pressed("line", capsys, stimulus={"shape": "line"}, motion=light)["depth_mm"]
    plate = pressed("plate", capsys, stimulus=PLATE)["depth_mm"]
    assert plate <= pressed("bar", capsys, stimulus=bar)["depth_mm"] <= steady < 2 * knife
    assert pressed("soft", capsys, specimen=SOFT)["depth_mm"] > steady


def test_a_researcher_moves(capsys):
    """Strokes there and back, steps over a surface, cycles, and a release with its recovery."""
    ways = [{"slide": way, "speed": "10 mm/s"} for way in ("1 mm", "-1 mm")]
    rubbed = {"stimulus": PLATE, "friction": 0.4, "accuracy": "draft"}
    stroke, _ = told("stroke", capsys, motion=[STEADY, *ways], **rubbed)
    there, back = stroke["legs"][1:]
    lateral = there["tangential_force_N_per_m"]
    assert lateral * back["tangential_force_N_per_m"] < 0 and back["stroke_distance_mm"] == 0
    assert abs(lateral) <= 0.4 * there["force_N_per_m"] * (1 + 1e-6)
    stepping = [STEADY, {"step": "4 mm", "every": "2 mm"}]
    steps = pressed("steps", capsys, stimulus=WAVES, motion=stepping)
    assert steps["stroke_distance_mm"] == pytest.approx(4)
    cycle = [{"press_to_depth": depth, "speed": "2 mm/s"} for depth in ("0.4 mm", "0.2 mm")]
    forces = [leg["force_N"] for leg in told("cycles", capsys, motion=2 * cycle)[0]["legs"]]
    assert len(forces) == 4 and forces[2] < forces[0], "it relaxes under cycles"
    release = [PRESS, {"lift": "2 mm/s"}, {"hold": "5 s"}]
    free, _ = told("release", capsys, "--vtu", motion=release)
    assert free["legs"][-1]["force_N"] == free["legs"][-1]["contact_width_mm"] == 0
    assert free["run"]["estimated_error"] < 0.6
    field = meshio.read("results/release/vtu/snapshot_0.vtu")
    assert np.abs(field.point_data["displacement (mm)"]).max() < 0.1 * free["legs"][0]["depth_mm"]


def test_a_researcher_plots(capsys):
    """Pressure over place and time, and the middle of it, from the file of a run."""
    told("ramp", capsys, motion=[PRESS])
    history = read_history("results/ramp/history.nc")
    figure, (above, below) = plt.subplots(2)
    history.contact_pressure.plot(x="skin_arc", y="time", ax=above)
    history.contact_pressure.sel(skin_arc=0, method="nearest").plot(ax=below)
    figure.savefig("pressure.png")
    assert "way along the undeformed skin" in above.get_xlabel()
    assert plt.imread("pressure.png").std() > 0.05
    plt.close(figure)


# --- the engineer ---------------------------------------------------------------------------------


def test_an_engineer_varies_a_bar_thirty_times():
    """Widths by moduli in one process: wider and stiffer go in less deep, every variation of
    them.
    """
    base = fingerpad.load_scene(
        {
            "stimulus": {"shape": "bar", "width": "1 mm", "fillet": "0.2 mm"},
            "motion": [{"press_to_force": "10 gf"}],
            "accuracy": {"skin_edge": "0.7 mm", "steps": 2},
        }
    )
    widths, moduli = np.linspace(0.8, 2.3, 6), (75, 120, 200, 350, 600)
    depth = np.empty((len(widths), len(moduli)))
    for i, width in enumerate(widths):
        for j, modulus in enumerate(moduli):
            changes = {
                "stimulus.width": f"{width} mm",
                "specimen.layers.epidermis.youngs_modulus": f"{modulus} kPa",
            }
            depth[i, j] = fingerpad.simulate(base.varied(changes)).indentation_depth[-1]
    assert (np.diff(depth, axis=0) < 1e-6).all() and (depth[0] > depth[-1] + 5e-6).all()
    assert (np.diff(depth, axis=1) < -20e-6).all()


def test_an_engineer_measures_a_profile(capsys):
    """A cylinder sampled every 0.1 mm is the cylinder; so is a scan of it every 5 um, rounded to
    whole micrometres.
    """
    exact = pressed("exact", capsys)
    for name, spacing, digits, motion in (
        ("scan", 0.1, 5, [STEADY]),
        ("fine", 0.005, 3, [STEADY, {"lift": "steady"}]),
    ):
        x = spacing * np.arange(-round(2.4 / spacing), round(2.4 / spacing) + 1)
        rows = [f"{a:.4f},{2.5 - np.sqrt(2.5**2 - a**2):.{digits}f}" for a in x]
        Path(f"{name}.csv").write_text("\n".join(["x (mm),y (mm)", *rows]), encoding="utf-8")
        sampled = {"shape": "sampled", "csv": f"{name}.csv"}
        found = told(name, capsys, stimulus=sampled, motion=motion)[0]["legs"][0]
        for key in ("depth_mm", "contact_width_mm", "centre_pressure_Pa"):
            assert found[key] == pytest.approx(exact[key], rel=0.05), key


def test_an_engineer_presses_robot_skin(capsys):
    """A slab of two layers with names of one's own under a plate and a bar: force over width is the
    pressure in the middle.
    """
    foam = [
        {"name": "cover", "thickness": "1 mm", "youngs_modulus": "0.5 MPa", "poisson_ratio": 0.45},
        {"name": "foam", "thickness": "4 mm", "youngs_modulus": "50 kPa", "poisson_ratio": 0.3},
    ]
    skin = {"slab": {"width": "30 mm", "layers": foam}, "prony": "none"}
    bar = {"shape": "bar", "width": "6 mm", "fillet": "0.5 mm"}
    receptors = {"receptors": {"depths": ["1.5 mm"]}}
    scene = {"specimen": skin, "stimulus": bar, "outputs": receptors}
    shallow, deep = (
        pressed(name, capsys, motion=[{"press_to_depth": depth}], **scene)
        for name, depth in (("shallow", "0.1 mm"), ("deep", "0.2 mm"))
    )
    assert 1.8 < deep["force_N"] / shallow["force_N"] < 2.6
    energies = [leg["receptors"][0]["strain_energy_Pa"] for leg in (shallow, deep)]
    assert 4 < energies[1] / energies[0] * 1.2 < 7


# --- the student ----------------------------------------------------------------------------------


def test_a_student_brings_a_mesh_and_forces(capsys):
    """A mesh of one's own gives the force of every depth; measured forces at a factor on the moduli
    give the factor back.
    """
    plates = [{"press_to_depth": f"{depth} mm"} for depth in (0.5, 1.0, 1.5)]
    Path("pad.yaml").write_text(
        yaml.safe_dump({"stimulus": PLATE, "motion": plates, "accuracy": COARSE}), encoding="utf-8"
    )
    assert main(["mesh", "pad.yaml", "--out", "meshes/mine.msh"]) == 0
    capsys.readouterr()
    own = {"mesh": "meshes/mine.msh"}
    found, _ = told("mine", capsys, specimen=own, stimulus=PLATE, motion=plates, accuracy="thesis")
    Path("forces").mkdir()
    rows = [
        f"1,flat plate,{leg['depth_mm']:.6g},0,{2.5 * leg['force_N']:.6g},measured by me,a scale"
        for leg in found["legs"]
    ]
    header = "subject,indenter,depth_mm,speed_mm_per_s,force_N,source,how_obtained"
    Path("forces/anna.csv").write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    measured = read_force_depth("forces")
    history = read_history("results/mine/history.nc")
    curve = ElasticCurve.from_history(history)
    forces = measured.force_N.to_numpy()
    fit = fit_constant(curve, measured.depth_mm.to_numpy() * 1e-3, forces, 0.0114)
    assert fit.value == pytest.approx(2.5, rel=1e-3)
    figure, axes = plt.subplots()
    loaded = history.assign_coords(
        depth_mm=history.indentation_depth * 1e3, force_N=history.force * 0.0114
    )
    (line,) = loaded.force_N.plot(x="depth_mm", ax=axes, label="simulated on my mesh")
    axes.plot(measured.depth_mm, forces / fit.value, "o", label="measured, over the factor")
    axes.legend()
    figure.savefig("mine.png")
    at = np.interp(measured.depth_mm, line.get_xdata(), line.get_ydata())
    assert at == pytest.approx(forces / 2.5, rel=1e-3)
    assert np.ptp(plt.imread("mine.png")) > 0.5
