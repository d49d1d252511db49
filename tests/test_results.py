"""Histories: labelled, with units and provenance, whole on disk, and of the whole pad whatever was
solved.
"""

import json
import time
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import meshio
import numpy as np
import pytest
from scipy.spatial import cKDTree

import fingerpad
from fingerpad import load_scene, plan, simulate
from fingerpad.compiled import Stopwatch, compiling
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.receptors.material_points import MaterialPoints
from fingerpad.results import (
    COORDINATES,
    FRICTION_VARIABLES,
    VARIABLES,
    read_history,
    summary,
    write_history,
    write_vtu,
)
from fingerpad.scenes.scene import Discretisation
from fingerpad.simulation import Simulation
from fingerpad.specimen import mesh_for

pytestmark = pytest.mark.unit

SCENES = Path(__file__).parents[1] / "config" / "scenes"

FIELDS = ("snapshot_", "node_", "element_")


@pytest.fixture(scope="module")
def run():
    scene = load_scene(SCENES / "ramp40_k420.yaml").with_accuracy("draft")
    receptors = scene.outputs.receptors.model_copy(
        update={"depths": (6e-4, 9.15e-4), "offsets": (-5e-4, 0.0, 5e-4)}
    )
    outputs = scene.outputs.model_copy(update={"receptors": receptors, "snapshots": (0.5, 2.5)})
    scene = scene.model_copy(update={"outputs": outputs})
    chosen = plan(scene)
    mesh = mesh_for(scene, chosen)
    calls = []
    return scene, chosen, mesh, simulate(scene, chosen, mesh, calls.append, fields=True), calls


def test_every_variable_has_its_unit_and_name(run):
    """Nothing in a history is a bare number."""
    history = run[3]
    assert set(history.data_vars) == set(VARIABLES) - set(FRICTION_VARIABLES) | {
        n for n in history if n.startswith(FIELDS)
    }
    for name in set(VARIABLES) - set(FRICTION_VARIABLES):
        dims, units, long_name = VARIABLES[name]
        assert history[name].dims == dims and history[name].attrs == {
            "units": units,
            "long_name": long_name,
        }
    for name, (dim, units, _) in COORDINATES.items():
        assert history[name].dims == (dim,) and history[name].attrs["units"] == units


def test_provenance_and_cost_are_in_the_file(run):
    """A history says what made it and what it took."""
    attrs = run[3].attrs
    made, cost = json.loads(attrs["provenance"]), json.loads(attrs["cost"])
    assert len(made["code_sha256"]) == 16 and made["packages"]["numpy"] == np.__version__
    assert {"cpu_s", "wall_s", "peak_rss_MB", "nodes", "unknowns", "factorisations"} <= set(
        cost
    ) and cost["cpu_s"] > 0
    assert json.loads(attrs["scene"])["stimulus"]["curvature"] == pytest.approx(419.95)
    assert json.loads(attrs["plan"])["effects"]["symmetry"]["on"]


def test_compiling_is_no_cost_of_a_simulation():
    """It is stated beside it; mutant: left in."""
    watch = Stopwatch(cpu=time.process_time() - 100.0, compiled=compiling() - 70.0)
    cost = watch.read()
    assert cost["compiling_s"] == 70.0 and cost["cpu_s"] == pytest.approx(30.0, abs=1.0)


def test_half_model_is_unfolded(run):
    """Skin and pressure are those of the whole pad, symmetric to the last bit; receptors are read
    in other elements.
    """
    end = run[3].isel(time=-1)
    np.testing.assert_array_equal(end.skin_x, -end.skin_x[::-1])
    np.testing.assert_array_equal(end.contact_pressure, end.contact_pressure[::-1])
    np.testing.assert_array_equal(end.skin_displacement_x, -end.skin_displacement_x[::-1])
    energy = end.strain_energy_density.values.reshape(2, 3)
    np.testing.assert_allclose(energy[:, 0], energy[:, 2], rtol=1e-12)


def test_pressure_carries_the_force(run):
    """Pressure over the deformed contact sums to the force of the whole pad."""
    end = run[3].isel(time=-1)
    x = end.skin_x + end.skin_displacement_x
    assert np.trapezoid(end.contact_pressure, x) == pytest.approx(float(end.force), rel=0.02)
    assert float(end.force) == pytest.approx(20 * 9.80665e-3 / 0.0114, rel=1e-6)


def test_starts_from_rest(run):
    """The first entry is the unloaded pad."""
    start = run[3].isel(time=0)
    for name in ("force", "indentation_depth", "contact_width", "external_work", "stored_energy"):
        assert float(start[name]) == 0
    assert float(abs(start.strain_energy_density).max()) < 1e-20, "nothing but round-off"


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
    assert (
        totals["legs"][1]["strain_energy_Pa"] == history.strain_energy_density[-1].values.tolist()
    )
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
    paths = write_vtu(history, tmp_path)
    assert [path.name for path in paths] == ["snapshot_0.vtu", "snapshot_1.vtu"]
    series = json.loads((tmp_path / "snapshots.vtu.series").read_text())["files"]
    assert [(frame["name"], frame["time"]) for frame in series] == [
        (path.name, time) for path, time in zip(paths, history.snapshot_time.values, strict=True)
    ]
    field = meshio.read(paths[1])
    assert len(field.points) == len(mesh.points) and set(
        np.unique(field.cell_data["layer"][0])
    ) == {0, 1, 2}
    apex = np.argmin(np.hypot(mesh.points[:, 0], mesh.points[:, 1] - mesh.points[:, 1].max()))
    assert field.point_data["displacement (mm)"][apex, 1] == pytest.approx(
        -float(history.indentation_depth[-1]) * 1e3, rel=1e-3
    )
    pressure = field.point_data["contact pressure (kPa)"]
    assert pressure[apex] == pytest.approx(float(history.centre_pressure[-1]) * 1e-3)
    assert np.count_nonzero(pressure) == np.count_nonzero(history.contact_pressure[-1])
    assert "layer (0 epidermis, 1 dermis, 2 fat)" in field.cell_data
    outline = meshio.read(tmp_path / "indenter_1.vtu")
    assert outline.points[:, 1].min() == pytest.approx(
        6 - float(history.indentation_depth[-1]) * 1e3, abs=1e-4
    )
    film = ElementTree.parse(tmp_path / "snapshots.pvd").getroot().findall("Collection/DataSet")
    assert [part.get("file") for part in film] == [
        f"{kind}_{k}.vtu" for k in (0, 1) for kind in ("snapshot", "indenter")
    ]


def test_fields_are_consistent(run, tmp_path):
    """Stress, its invariants and the energy of the total stress belong together; a mirror turns the
    shear stress round.
    """
    _, _, mesh, history, _ = run
    write_vtu(history, tmp_path)
    cells = {
        name: values[0]
        for name, values in meshio.read(tmp_path / "snapshot_1.vtu").cell_data.items()
    }
    stress = cells["cauchy stress (kPa)"].reshape(-1, 3, 3)
    mean = np.trace(stress, axis1=1, axis2=2) / 3
    deviator = stress - mean[:, None, None] * np.eye(3)
    square = np.einsum("nij,nij->n", deviator, deviator)
    np.testing.assert_allclose(
        cells["von mises stress (kPa)"], np.sqrt(1.5 * square), rtol=1e-4, atol=1e-6
    )
    large = np.abs(mean) > 0.1 * np.abs(mean).max()
    np.testing.assert_allclose(mean[large], cells["mean stress (kPa)"][large], rtol=0.02)
    youngs = np.array([0.15e3, 0.015e3, 0.015e3])[cells["layer"]]
    shear, bulk = youngs / 2.96, youngs / (3 * 0.04)  # instantaneous
    energy = 1e3 * (
        square / (4 * shear) + mean**2 / (2 * bulk)
    )  # but for det F, which is one within some per cent
    np.testing.assert_allclose(
        cells["strain energy density (Pa)"], energy, rtol=0.12, atol=1e-3 * energy.max()
    )
    assert (cells["smallest principal strain (1)"] <= cells["largest principal strain (1)"]).all()
    centre = mesh.points[mesh.cells].mean(1)
    twin = cKDTree(centre).query(centre * [-1, 1])[1]
    np.testing.assert_allclose(
        stress[twin], stress * [[1, -1, 1], [-1, 1, 1], [1, 1, 1]], rtol=1e-12, atol=1e-15
    )
    assert np.abs(stress[:, 0, 1]).max() > 1


def test_fields_are_what_receptors_see_in_one_element(run, monkeypatch):
    """A receptor in the middle of an element has the element's values, to the last bits, if nothing
    is fitted round it.
    """
    monkeypatch.setattr("fingerpad.receptors.recovery.FITTED", {})
    simulation = Simulation(*run[:3], fields=True)
    body, space = simulation.body, simulation.body.space
    body.displace(np.where(space.fixed, 0, 1e-6 * np.sin(4000 * space.points[:, ::-1])))
    some = np.arange(0, len(space.cells), 37)
    middle = np.einsum(
        "a,nai->ni",
        space.element.shape(np.array([[0.5, 0.5]]))[0][0],
        space.points[space.cells[some]],
    )
    receptors = MaterialPoints(body, middle, simulation.fields.shear_instantaneous)
    there, here = receptors.sample(body), simulation.fields.sample(body)
    for name in there:
        np.testing.assert_allclose(here[name][some], there[name], rtol=1e-8, err_msg=name)


def test_the_last_state_is_the_field_when_no_snapshot_is_named():
    """Whatever has no snapshots has one of its end when fields are asked for, and none when they
    are not.
    """
    scene = load_scene(SCENES / "ramp40_flat.yaml").with_accuracy("draft")
    scene = scene.model_copy(
        update={"motion": (scene.motion[0].model_copy(update={"rate": None}),)}
    )
    assert "snapshot_time" not in simulate(scene)
    history = simulate(scene, fields=True)
    assert history.snapshot_time.values == [float(history.time[-1])]
    apex = int(np.argmin(np.hypot(*(history.node_position.values - [0, 6e-3]).T)))
    assert history.snapshot_displacement[0, apex, 1] == pytest.approx(
        -float(history.indentation_depth[-1]), rel=1e-4
    )


def test_skin_is_indexed_by_the_way_along_it(run, tmp_path):
    """Pressure over place and time plots; the middle is found by its place; a file that was read
    again has it too.
    """
    write_history(run[3], tmp_path / "history.nc")
    for history in (run[3], read_history(tmp_path / "history.nc")):
        assert history.contact_pressure.dims == ("time", "skin_node") and np.all(
            np.diff(history.skin_arc) > 0
        )
        middle = history.contact_pressure.sel(skin_arc=0, method="nearest")
        np.testing.assert_array_equal(middle, history.centre_pressure)
        drawn = history.contact_pressure.plot(x="skin_arc", y="time")
        assert drawn.get_array().size == history.contact_pressure.size
        plt.close("all")
        history.contact_pressure.isel(time=-1).plot(x="skin_x")
        plt.close("all")


def test_a_summary_names_its_receptors(run):
    """Every energy of a summary stands beside depth and offset; of very many receptors only the
    history speaks.
    """
    history = run[3]
    leg = summary(history)["legs"][-1]
    assert [(r["depth_mm"], r["offset_mm"]) for r in leg["receptors"]] == [
        (d, x) for d in (0.6, 0.915) for x in (-0.5, 0, 0.5)
    ]
    for name in ("strain_energy_Pa", "strain_energy_network_Pa"):
        assert leg[name] == [r[name] for r in leg["receptors"]]
    assert leg["force_gf"] == pytest.approx(20, rel=1e-6) and leg["force_N"] == pytest.approx(
        0.196133, rel=1e-6
    )
    many = summary(history.isel(receptor=np.zeros(2000, int)))["legs"][-1]
    assert "2000 receptor points" in many["receptors"] and len(json.dumps(many)) < 1000


def test_an_interrupted_simulation_keeps_what_had_converged(run):
    """Ctrl-C in the middle of a run: the history up to there rides on the exception."""
    scene, chosen, mesh, whole, _ = run
    calls = []

    def press_the_key(state):
        calls.append(state)
        if len(calls) == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        simulate(scene, chosen, mesh, press_the_key)
    history = caught.value.dataset
    assert history.sizes["time"] == 6 and not history.attrs["complete"]
    np.testing.assert_array_equal(history.force, whole.force[:6])


def test_without_viscosity_there_is_one_strain_energy():
    """A pad without a Prony series has one strain energy, whatever it is called; with one, the five
    differ.
    """
    scene = load_scene(SCENES / "ramp40_k1260.yaml").with_accuracy("draft")
    elastic = scene.model_copy(update={"specimen": scene.specimen.model_copy(update={"prony": ()})})
    end = simulate(elastic).isel(time=-1)
    others = ["density", "long_term_moduli", "half_stress_strain", "recoverable"]
    viscous = simulate(scene).isel(time=-1)
    for name in (f"strain_energy_{other}" for other in others):
        np.testing.assert_allclose(end[name], end.strain_energy_network, rtol=1e-12, err_msg=name)
        assert float(abs(viscous[name] / viscous.strain_energy_network - 1).min()) > 0.005, name


def test_an_element_that_folds_at_a_receptor_ends_the_run(monkeypatch):
    """Between quadrature points det F may fall below zero first: no NaN leaves a run as its
    result.
    """
    sample, calls = MaterialPoints.sample, iter(range(100))

    def folded(points, body):
        found = sample(points, body)
        return found | {
            "strain_energy_density": found["strain_energy_density"]
            * (np.nan if next(calls) == 3 else 1.0)
        }

    monkeypatch.setattr(MaterialPoints, "sample", folded)
    scene = load_scene(SCENES / "ramp40_flat.yaml").with_accuracy(
        Discretisation(skin_edge=0.8e-3, steps=8)
    )
    with pytest.raises(
        NonConvergence, match="turns inside out at the receptor 560 um deep.*try a finer skin mesh"
    ) as stop:
        simulate(scene)
    kept = stop.value.dataset
    assert (
        kept.sizes["time"] == 3
        and not kept.attrs["complete"]
        and np.isfinite(kept.strain_energy_density).all()
    )
    assert stop.value.time == float(kept.time[-1])


# --- the accessor and the names at the top --------------------------------------------------------


def test_a_history_knows_its_plan_scene_force_and_errors(run):
    scene, chosen, _, history, _ = run
    known = history.fingerpad
    assert known.scene == scene
    assert known.plan == replace(chosen, predicted_cost_s=round(chosen.predicted_cost_s, 2))
    assert float(known.force_N[-1]) == pytest.approx(20 * 9.80665e-3)
    assert known.force_N.attrs["units"] == "N"
    ends = [leg["estimated_error"] for leg in summary(history)["legs"]]
    assert known.errors["legs"] == ends and known.errors["asked"] is None
    assert known.errors["largest"] >= max(ends)


def test_receptors_are_found_by_their_depth(run):
    history = run[3]
    for number, (depth, offset) in enumerate((d, x) for d in (6e-4, 9.15e-4) for x in (-5e-4, 0)):
        at = history.fingerpad.sel(depth=depth, offset=offset)
        assert (float(at.receptor_depth), float(at.receptor_offset)) == (depth, offset), number
    middle = history.fingerpad.sel(depth=9.15e-4).strain_energy_density
    np.testing.assert_array_equal(middle, history.strain_energy_density[:, 4])
    with pytest.raises(KeyError, match="no receptor at depth 700 um, offset 0 mm; there are"):
        history.fingerpad.sel(depth=7e-4)
    for wrong in ([6e-4, 9.15e-4], "915 um", np.array([6e-4])):
        with pytest.raises(TypeError, match="depth: .* is not a number; allowed: one number, in m"):
            history.fingerpad.sel(depth=wrong)
    with pytest.warns(DeprecationWarning, match="receptor is now sel"):
        assert history.fingerpad.receptor(9.15e-4).identical(history.fingerpad.sel(9.15e-4))


def test_public_names_are_at_the_top():
    assert set(dir(fingerpad)) == {*fingerpad.HOMES, "__version__"}
    stub = Path(fingerpad.__file__).with_name("__init__.pyi").read_text()
    for name, home in fingerpad.HOMES.items():
        assert getattr(fingerpad, name).__module__.startswith("fingerpad.")
        assert f"from {home} import {name} as {name}" in stub


def test_a_plan_is_readable(run):
    said = str(run[1])
    assert len(repr(run[1])) < 300 and run[1].element in repr(run[1])
    for part in (run[3], run[3].fingerpad.sel(9.15e-4), run[3].drop_attrs()):
        assert len(repr(part.fingerpad)) < 400
    for name, effect in run[1].effects.items():
        assert name.replace("_", " ") in said and effect.why.split()[0] in said
    assert run[1]._repr_html_().startswith("<table>")
