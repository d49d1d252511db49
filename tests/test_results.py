"""Histories: labelled, with units and provenance, whole on disk, and of the whole pad whatever was solved."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.files import write_atomically
from fingerpad.results import COORDINATES, FRICTION_VARIABLES, VARIABLES, read_history, summary, write_history, write_vtu
from fingerpad.specimen import mesh_for

pytestmark = pytest.mark.unit

SCENES = Path(__file__).parents[1] / "config" / "scenes"

FIELDS = ("snapshot_", "node_", "element_")


@pytest.fixture(scope="module")
def run():
    scene = load_scene(SCENES / "ramp40_k420.yaml").with_accuracy("draft")
    receptors = scene.outputs.receptors.model_copy(update={"depths": (6e-4, 9.15e-4), "offsets": (-5e-4, 0.0, 5e-4)})
    outputs = scene.outputs.model_copy(update={"receptors": receptors, "snapshots": (0.5, 2.5)})
    scene = scene.model_copy(update={"outputs": outputs})
    chosen = plan(scene)
    mesh = mesh_for(scene, chosen)
    calls = []
    return scene, chosen, mesh, simulate(scene, chosen, mesh, calls.append), calls


def test_every_variable_has_its_unit_and_name(run):
    """Nothing in a history is a bare number."""
    history = run[3]
    assert set(history.data_vars) == set(VARIABLES) - set(FRICTION_VARIABLES) | {n for n in history if n.startswith(FIELDS)}
    for name in set(VARIABLES) - set(FRICTION_VARIABLES):
        dims, units, long_name = VARIABLES[name]
        assert history[name].dims == dims and history[name].attrs == {"units": units, "long_name": long_name}
    for name, (dim, units, _) in COORDINATES.items():
        assert history[name].dims == (dim,) and history[name].attrs["units"] == units


def test_provenance_and_cost_are_in_the_file(run):
    """A history says what made it and what it took."""
    attrs = run[3].attrs
    made, cost = json.loads(attrs["provenance"]), json.loads(attrs["cost"])
    assert len(made["code_sha256"]) == 16 and made["packages"]["numpy"] == np.__version__
    assert {"cpu_s", "wall_s", "peak_rss_MB", "nodes", "unknowns", "factorisations"} <= set(cost) and cost["cpu_s"] > 0
    assert json.loads(attrs["scene"])["stimulus"]["curvature"] == pytest.approx(419.95)
    assert json.loads(attrs["plan"])["effects"]["symmetry"]["on"]


def test_half_model_is_unfolded(run):
    """Skin, pressure and receptors are those of the whole pad, symmetric to the last bit."""
    end = run[3].isel(time=-1)
    np.testing.assert_array_equal(end.skin_x, -end.skin_x[::-1])
    np.testing.assert_array_equal(end.contact_pressure, end.contact_pressure[::-1])
    np.testing.assert_array_equal(end.skin_displacement_x, -end.skin_displacement_x[::-1])
    energy = end.strain_energy_density.values.reshape(2, 3)
    np.testing.assert_array_equal(energy[:, 0], energy[:, 2])


def test_pressure_carries_the_force(run):
    """Pressure over the deformed contact sums to the force of the whole pad."""
    end = run[3].isel(time=-1)
    x = end.skin_x + end.skin_displacement_x
    assert np.trapezoid(end.contact_pressure, x) == pytest.approx(float(end.force), rel=0.02)
    assert float(end.force) == pytest.approx(19.6133, rel=1e-6)


def test_starts_from_rest(run):
    """The first entry is the unloaded pad."""
    start = run[3].isel(time=0)
    for name in ("force", "indentation_depth", "contact_width", "external_work", "stored_energy"):
        assert float(start[name]) == 0
    assert not start.strain_energy_density.values.any()


def test_work_is_stored_or_dissipated(run):
    """Energy put in is found again, and dissipation only grows."""
    history = run[3]
    balance = history.external_work - history.stored_energy - history.dissipated_energy
    assert abs(float(balance[-1])) < 0.01 * float(history.external_work[-1])
    assert np.all(np.diff(history.dissipated_energy) > -1e-9 * float(history.external_work[-1]))


def test_summary_is_the_history_at_the_legs_ends(run):
    """summary.json repeats the history, in the units people use."""
    history, totals = run[3], summary(run[3])
    assert [leg["time_s"] for leg in totals["legs"]] == pytest.approx([0.5, 2.5])
    assert totals["legs"][1]["depth_mm"] == float(history.indentation_depth[-1]) * 1e3
    assert totals["legs"][1]["strain_energy_Pa"] == history.strain_energy_density[-1].values.tolist()
    assert totals["run"]["newton_iterations"] == int(history.newton_iterations.sum())
    assert totals["run"]["steps"] == history.sizes["time"] - 1
    json.dumps(totals)


def test_progress_reaches_the_end(run):
    """Progress is reported once a step with the whole pad's contact width."""
    history, calls = run[3], run[4]
    assert len(calls) == history.sizes["time"] - 1
    assert calls[-1]["time_s"] == pytest.approx(calls[-1]["end_time_s"])
    assert calls[-1]["contact_width_mm"] == pytest.approx(float(history.contact_width[-1]) * 1e3)
    assert calls[-1]["iterations"] == int(history.newton_iterations.sum())


def test_round_trip(run, tmp_path):
    """What is read is what was written."""
    write_history(run[3], tmp_path / "deep" / "history.nc")
    again = read_history(tmp_path / "deep" / "history.nc")
    assert again.identical(run[3]) or (again.equals(run[3]) and again.attrs == run[3].attrs)
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["history.nc"]


def test_snapshots_become_vtu(run, tmp_path):
    """Full fields open in ParaView: whole pad, moved nodes, layers, mean stress."""
    _, _, mesh, history, _ = run
    paths = write_vtu(history, mesh, tmp_path)
    assert [path.name for path in paths] == ["snapshot_0.vtu", "snapshot_1.vtu"]
    series = json.loads((tmp_path / "snapshots.vtu.series").read_text())["files"]
    assert [(frame["name"], frame["time"]) for frame in series] == [
        (path.name, time) for path, time in zip(paths, history.snapshot_time.values, strict=True)
    ]
    field = meshio.read(paths[1])
    assert len(field.points) == len(mesh.points) and set(np.unique(field.cell_data["layer"][0])) == {0, 1, 2}
    apex = np.argmin(np.hypot(mesh.points[:, 0], mesh.points[:, 1] - mesh.points[:, 1].max()))
    assert field.point_data["displacement (mm)"][apex, 1] == pytest.approx(-float(history.indentation_depth[-1]) * 1e3, rel=1e-3)


def test_nothing_half_written(tmp_path):
    """A writer that fails leaves no file, and what stood there stays."""
    target = tmp_path / "out.txt"
    target.write_text("before")

    def broken(path):
        path.write_text("half")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        write_atomically(target, broken)
    assert target.read_text() == "before" and list(tmp_path.iterdir()) == [target]


def test_no_code_of_an_absent_effect_runs(monkeypatch):
    """A steady, light scene never enters viscoelasticity or the finite-strain body."""
    from fingerpad.mechanics import finite_strain, small_strain, viscoelasticity

    def never(*_, **__):
        raise AssertionError("an effect that the plan left out was executed")

    monkeypatch.setattr(viscoelasticity.Branches, "__init__", never)
    monkeypatch.setattr(small_strain, "step_coefficients", never)
    monkeypatch.setattr(finite_strain.FiniteStrainBody, "__init__", never)
    scene = load_scene(SCENES / "ramp40_flat.yaml").with_accuracy("draft")
    leg = scene.motion[0].model_copy(update={"press_to_force": 1e-3 * scene.motion[0].press_to_force, "rate": None})
    history = simulate(scene.model_copy(update={"motion": (leg,)}))
    assert float(history.force[-1]) > 0


def test_without_viscosity_there_is_one_strain_energy():
    """A pad without a Prony series has one strain energy, whatever it is called; with one, the five differ."""
    scene = load_scene(SCENES / "ramp40_k1260.yaml").with_accuracy("draft")
    elastic = scene.model_copy(update={"specimen": scene.specimen.model_copy(update={"prony": ()})})
    end = simulate(elastic).isel(time=-1)
    others = ["density", "long_term_moduli", "half_stress_strain", "recoverable"]
    viscous = simulate(scene).isel(time=-1)
    for name in (f"strain_energy_{other}" for other in others):
        np.testing.assert_allclose(end[name], end.strain_energy_network, rtol=1e-12, err_msg=name)
        assert float(abs(viscous[name] / viscous.strain_energy_network - 1).min()) > 0.005, name
