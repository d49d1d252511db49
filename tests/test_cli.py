"""The command line: exit codes, what is written and what is not, mostly with a stand-in for the
solver.
"""

import json
import subprocess
import sys
import tempfile
import types
import warnings
from pathlib import Path

import pytest
import xarray as xr
import yaml

from fingerpad.cli import main
from fingerpad.files import write_text
from wrong_scenes import BAD, RAMP_AND_HOLD, changed, pad_folder, specimen, write

pytestmark = pytest.mark.unit

CONFIG = Path(__file__).parents[1] / "config"
SUMMARY = {
    "legs": [
        {
            "depth_mm": 0.5,
            "force_N_per_m": 19.6133,
            "force_N": 0.196133,
            "contact_width_mm": 4.7,
            "estimated_error": 0.043,
        }
    ],
    "run": {
        "steps": 2,
        "newton_iterations": 5,
        "wall_s": 1.5,
        "estimated_error": 0.043,
        "largest_error": 0.043,
        "peak_pressure_singular": False,
    },
}


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "my_scene.yaml"
    path.write_text(yaml.safe_dump(changed(accuracy="draft")))
    return path


@pytest.fixture
def solver(monkeypatch):
    """Stand-ins for mesh, simulation and results; `solver.fails` is what the simulation raises."""
    import fingerpad.specimen

    solver = types.SimpleNamespace(fails=None, progress=None, plan=None)
    dataset = xr.Dataset({"force": ("time", [0.0, 19.6])})

    def simulate(scene, plan=None, mesh=None, progress=None, fields=False):
        solver.progress, solver.plan = progress, plan
        if solver.fails is not None:
            raise solver.fails
        if progress:
            keys = ("time_s", "end_time_s", "contact_width_mm", "iterations", "cutbacks")
            progress(dict(zip(keys, (0.5, 2.5, 4.7, 3, 0), strict=True)))
        return dataset

    simulation, results = (
        types.ModuleType("fingerpad.simulation"),
        types.ModuleType("fingerpad.results"),
    )
    simulation.simulate = simulate
    results.summary = lambda dataset: SUMMARY
    results.write_history = lambda dataset, path: dataset.to_netcdf(path, engine="netcdf4")
    results.write_vtu = lambda dataset, directory: write_text(
        directory / "snapshot_0.vtu", "<VTKFile/>"
    )
    monkeypatch.setitem(sys.modules, "fingerpad.simulation", simulation)
    monkeypatch.setitem(sys.modules, "fingerpad.results", results)
    monkeypatch.setattr(fingerpad.specimen, "mesh_for", lambda scene, plan: object())
    return solver


def names(directory):
    return sorted(path.name for path in Path(directory).iterdir())


def refused(capsys, arguments):
    """The one line of a refusal."""
    assert main([str(argument) for argument in arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("fingerpad: ") and err.endswith("\n") and len(err.splitlines()) == 1
    return err.removeprefix("fingerpad: ").rstrip()


# --- wrong input ----------------------------------------------------------------------------------


# all of them are refused in test_scene; these show that each kind of refusal reaches the command
# line
REFUSED = (
    "unknown key in a leg",
    "a list",
    "layers thicker than the pad",
    "profile missing",
    "slide after a lift",
)


@pytest.mark.parametrize("name", REFUSED)
def test_wrong_scenes_exit_2_with_one_line_and_write_nothing(tmp_path, capsys, name):
    document, key, _ = BAD[name]
    path = write(pad_folder(tmp_path), document)
    line = refused(capsys, ["run", path, "--out", tmp_path / "new" / "out"])
    assert line.startswith(f"{path}: {key}: " if key else f"{path}: ")
    assert names(tmp_path) == ["config", "my_scene.yaml"]


@pytest.mark.parametrize("command", ["plan", "run", "mesh"])
@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00", b"a: [", b""])
def test_files_that_are_no_scene(tmp_path, capsys, command, content):
    path = tmp_path / "none.yaml"
    if content is not None:
        path.write_bytes(content)
    out = {"plan": [], "run": ["--out", tmp_path / "out"], "mesh": ["--out", tmp_path / "out.msh"]}[
        command
    ]
    assert str(path) in refused(capsys, [command, path, *out])
    assert names(tmp_path) == ([] if content is None else ["none.yaml"])


@pytest.mark.parametrize("accuracy", ["best", "0", "-1", "nan", "1"])
def test_wrong_accuracy_on_the_command_line(tmp_path, scene, capsys, accuracy):
    line = refused(capsys, ["run", scene, "--out", tmp_path / "out", f"--accuracy={accuracy}"])
    assert line.startswith(f"--accuracy: '{accuracy}' ") and "allowed: " in line
    assert names(tmp_path) == ["my_scene.yaml"]


def test_an_output_that_is_a_file(tmp_path, scene, capsys):
    (tmp_path / "file").write_text("kept")
    for out in ("file", "file/below"):
        assert "--out" in refused(capsys, ["run", scene, "--out", tmp_path / out])
    assert "--out" in refused(capsys, ["mesh", scene, "--out", tmp_path / "file" / "a.msh"])
    assert "ending in .msh" in refused(capsys, ["mesh", scene, "--out", tmp_path / "mesh.txt"])
    assert (tmp_path / "file").read_text() == "kept" and names(tmp_path) == [
        "file",
        "my_scene.yaml",
    ]


def test_a_directory_that_cannot_be_written(tmp_path, scene, capsys, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    assert "cannot be written" in refused(capsys, ["run", scene, "--out", tmp_path / "out"])
    assert names(tmp_path) == ["my_scene.yaml"]


def test_an_external_mesh_that_is_no_mesh_is_named_with_its_key(tmp_path, capsys):
    (tmp_path / "my.msh").write_text("not a mesh")
    path = tmp_path / "my_scene.yaml"
    path.write_text(yaml.safe_dump(specimen(mesh="my.msh")))
    line = refused(capsys, ["run", path, "--out", tmp_path / "out"])
    assert line.startswith(f"{path}: specimen.mesh: ") and "my.msh" in line
    assert names(tmp_path) == ["my.msh", "my_scene.yaml"]


def test_a_plan_that_cannot_be_made_names_the_key(tmp_path, capsys):
    path = tmp_path / "my_scene.yaml"
    path.write_text(yaml.safe_dump(changed(effects={"ridges": True})))
    assert refused(capsys, ["plan", path]).startswith(f"{path}: effects.ridges: ")


@pytest.mark.parametrize(
    "arguments", [[], ["fly"], ["mesh", "a.yaml"], ["plan"], ["plan", "a.yaml", "--fast"]]
)
def test_usage_errors_exit_2(arguments, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    assert "usage: fingerpad" in capsys.readouterr().err


# --- what is done ---------------------------------------------------------------------------------


def test_version(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert caught.value.code == 0
    assert capsys.readouterr().out.startswith("fingerpad 0.")


def test_plan_as_json_and_as_a_table(scene, capsys):
    assert main(["plan", str(scene), "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert set(plan["effects"]) == {
        "friction",
        "viscoelasticity",
        "finite_strain",
        "symmetry",
        "ridges",
    }
    assert all(set(effect) == {"on", "why"} for effect in plan["effects"].values())
    assert {"element", "nodes", "steps"} <= set(plan["discretisation"])

    assert main(["plan", str(scene)]) == 0
    table = capsys.readouterr().out
    for words in (
        "Plan of my_scene",
        "finite strain",
        "friction",
        "nodes",
        "expected error",
        "predicted cost",
    ):
        assert words in table


def test_accuracy_replaces_the_scene_s(scene, capsys):
    def nodes(*options):
        assert main(["plan", str(scene), "--json", *options]) == 0
        return json.loads(capsys.readouterr().out)["discretisation"]["nodes"]

    assert nodes() == nodes("--accuracy", "draft") < nodes("--accuracy", "thesis")


def test_run_writes_three_files(tmp_path, scene, solver, capsys):
    out = tmp_path / "new" / "out"
    assert main(["run", str(scene), "--out", str(out)]) == 0
    assert names(out) == ["history.nc", "plan.json", "summary.json"]
    assert json.loads((out / "summary.json").read_text()) == SUMMARY
    plan = json.loads((out / "plan.json").read_text())
    assert (plan.pop("scene"), plan.pop("files")) == ("my_scene", names(out))
    assert plan == json.loads(json.dumps(solver.plan.to_dict()))
    with xr.open_dataset(out / "history.nc", engine="netcdf4") as history:
        assert history.force[-1] == 19.6
    stdout, stderr = capsys.readouterr()
    assert (
        stderr == ""
        and stdout.count("\n") == 1
        and str(out) in stdout
        and "error about 4.3 %" in stdout
    )
    assert "force 20.0 gf (19.6 N/m)" in stdout


def test_force_is_said_in_the_unit_it_came_in(tmp_path, solver, capsys):
    scene = write(tmp_path, changed(motion=[{"press_to_force": "196.133 mN"}]))
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 0
    assert "force 196. mN (19.6 N/m)" in capsys.readouterr().out


def test_results_without_out_go_to_a_folder_of_the_scene_s_name(
    tmp_path, scene, solver, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(["run", scene.name]) == 0
    assert names("results/my_scene") == ["history.nc", "plan.json", "summary.json"]
    assert capsys.readouterr().out.endswith("results in results/my_scene\n")


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(None, "1.5 s; "), (0.2, "1.5 s; "), (1.2, "1.5 s, 1.2 of them to compile, once;")],
)
def test_a_run_says_what_it_took_to_compile(seconds, said):
    from fingerpad.cli import _closing_line

    once = {} if seconds is None else {"compiling_s": seconds}
    assert f"5 iterations, {said}" in _closing_line(
        SUMMARY | {"run": SUMMARY["run"] | once}, Path("results"), "gf"
    )


def test_quiet_says_nothing_and_vtu_adds_fields(tmp_path, solver, capsys):
    scene = write(tmp_path, changed(outputs={"snapshots": ["1 s"]}))
    assert main(["run", str(scene), "--out", str(tmp_path / "out"), "--quiet", "--vtu"]) == 0
    assert names(tmp_path / "out") == ["history.nc", "plan.json", "summary.json", "vtu"]
    assert names(tmp_path / "out" / "vtu") == ["snapshot_0.vtu"]
    assert capsys.readouterr() == ("", "") and solver.progress is None


def test_results_of_two_runs_do_not_mix(tmp_path, solver):
    scene = write(tmp_path, changed(outputs={"snapshots": ["1 s"]}))
    out = tmp_path / "out"
    arguments = ["run", str(scene), "--out", str(out), "--quiet"]
    assert main([*arguments, "--vtu"]) == 0
    (out / "notes.txt").write_text("a user's own")
    (out / "vtu" / "view.pvsm").write_text("a user's own")
    assert main(arguments) == 0
    assert names(out) == ["history.nc", "notes.txt", "plan.json", "summary.json", "vtu"]
    assert names(out / "vtu") == ["view.pvsm"]
    (out / "vtu" / "view.pvsm").unlink()
    assert main([*arguments, "--vtu"]) == main(arguments) == 0
    assert names(out) == ["history.nc", "notes.txt", "plan.json", "summary.json"]


def test_files_of_a_user_s_under_the_names_of_results_are_replaced_by_force_only(
    tmp_path, scene, solver, capsys
):
    out = tmp_path / "out"
    out.mkdir()
    (out / "summary.json").write_text("a user's own")
    (out / "plan.json").write_text('{"files": ["../../my_scene.yaml", "summary.json.bak", 5]}')
    line = refused(capsys, ["run", scene, "--out", out])
    assert (
        str(out / "plan.json") in line
        and "--force" in line
        and (out / "summary.json").read_text() == "a user's own"
    )
    assert main(["run", str(scene), "--out", str(out), "--force", "--quiet"]) == 0
    assert json.loads((out / "summary.json").read_text()) == SUMMARY and scene.exists()


def test_results_of_another_scene_are_replaced_by_force_only(tmp_path, scene, solver, capsys):
    other, out = write(tmp_path, changed(), "other.yaml"), tmp_path / "out"
    assert main(["run", str(scene), "--out", str(out), "--quiet"]) == 0
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert "the scene 'my_scene'" in refused(capsys, ["run", other, "--out", out])
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    assert main(["run", str(other), "--out", str(out), "--quiet", "--force"]) == 0
    assert json.loads((out / "plan.json").read_text())["scene"] == "other"


def test_a_second_run_into_one_folder_is_refused_while_the_first_lives(
    tmp_path, scene, solver, capsys
):
    """The lock is a process's: it goes when that is killed, and leaves nothing."""
    out = tmp_path / "out"
    out.mkdir()
    code = f"import pathlib, time; from fingerpad.files import locked\nwith locked(pathlib.Path({str(out)!r})):"
    code += " print(flush=True); time.sleep(60)"
    other = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    try:
        other.stdout.readline()
        assert "another run" in refused(capsys, ["run", scene, "--out", out])
        assert names(out) == []
    finally:
        other.kill()
        other.wait()
    (out / ".fingerpad-leftover").mkdir()
    assert main(["run", str(scene), "--out", str(out), "--quiet"]) == 0
    assert names(out) == ["history.nc", "plan.json", "summary.json"]


def test_progress_on_a_terminal(tmp_path, scene, solver, monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 0
    assert solver.progress is not None


# --- what goes wrong later ------------------------------------------------------------------------


def _non_convergence(dataset):
    from fingerpad.mechanics.stepping import NonConvergence

    error = NonConvergence(0.25, "the residual stalls", "smaller steps")
    error.dataset = dataset
    return error


def test_non_convergence_exits_3_and_saves_the_last_converged_state(
    tmp_path, scene, solver, capsys
):
    out = tmp_path / "out"
    assert main(["run", str(scene), "--out", str(out), "--quiet"]) == 0
    solver.fails = _non_convergence(xr.Dataset({"force": ("time", [0.0, 9.8])}))
    assert main(["run", str(scene), "--out", str(out), "--quiet"]) == 3
    assert names(out) == ["last_converged.nc", "plan.json"]
    err = capsys.readouterr().err
    assert len(err.splitlines()) == 1
    for words in ("0.25 s", "the residual stalls", "smaller steps", str(out / "last_converged.nc")):
        assert words in err


def test_non_convergence_before_the_first_step(tmp_path, scene, solver, capsys):
    solver.fails = _non_convergence(None)
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 3
    assert names(tmp_path / "out") == ["plan.json"]
    assert "no step had converged" in capsys.readouterr().err


def test_interrupt_before_anything_has_converged_leaves_nothing(tmp_path, scene, solver, capsys):
    solver.fails = KeyboardInterrupt()
    assert main(["run", str(scene), "--out", str(tmp_path / "new" / "out")]) == 130
    assert names(tmp_path) == ["my_scene.yaml"]
    assert capsys.readouterr().err == "fingerpad: interrupted\n"


def test_interrupt_keeps_what_had_converged_beside_the_results_there_are(
    tmp_path, scene, solver, capsys
):
    out, stop = tmp_path / "out", KeyboardInterrupt()
    stop.dataset = xr.Dataset({"force": ("time", [0.0, 9.8])}, {"time": [0.0, 0.25]})
    arguments = ["run", str(scene), "--out", str(out), "--quiet"]
    assert main(arguments) == 0
    before = (out / "history.nc").read_bytes()
    solver.fails = stop
    assert main(arguments) == 130
    err = capsys.readouterr().err
    assert (
        "interrupted after t = 0.25 s" in err
        and str(out / "last_converged.nc") in err
        and err.count("\n") == 1
    )
    assert names(out) == ["history.nc", "last_converged.nc", "plan.json", "summary.json"]
    assert (out / "history.nc").read_bytes() == before
    solver.fails = None
    assert main(arguments) == 0
    assert names(out) == ["history.nc", "plan.json", "summary.json"]


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (KeyboardInterrupt(), 130),
        (OSError(28, "No space left on device"), 3),
        (RuntimeError("NetCDF"), 1),
    ],
)
@pytest.mark.parametrize("writer", ["write_history", "write_vtu"])
def test_a_run_stopped_while_writing_leaves_the_old_results(
    tmp_path, scene, solver, monkeypatch, capsys, error, code, writer
):
    out = tmp_path / "out"
    arguments = ["run", str(scene), "--out", str(out), "--quiet", "--vtu"]
    assert main(arguments) == 0
    before = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}

    def fail(dataset, path):
        write_text(Path(path) / "half" if writer == "write_vtu" else path, "half")
        raise error

    monkeypatch.setattr(sys.modules["fingerpad.results"], writer, fail)
    assert main(arguments) == code
    assert {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()} == before
    line = capsys.readouterr().err
    assert line.count("\n") == 1 and "Traceback" not in line
    assert code != 3 or (str(out) in line and "No space left" in line)


def test_an_unforeseen_error_is_one_line_and_a_file(tmp_path, scene, solver, monkeypatch, capsys):
    """No traceback reaches the user, nor a warning of a library; both are in the file that the line
    names.
    """

    def broken(*_, **__):
        warnings.warn("a library's warning", RuntimeWarning, stacklevel=1)
        raise ZeroDivisionError("nobody has thought\nof this")

    monkeypatch.setattr(sys.modules["fingerpad.simulation"], "simulate", broken)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 1
    out, err = capsys.readouterr()
    assert (
        out == ""
        and err.count("\n") == 1
        and "internal error, ZeroDivisionError: nobody has thought of this" in err
    )
    (report,) = tmp_path.glob("fingerpad-error-*.txt")
    assert str(report) in err and not (tmp_path / "out").exists()
    for words in ("Traceback", "in broken", "a library's warning", "Python 3"):
        assert words in report.read_text()


def test_no_memory_is_one_line(tmp_path, scene, solver, capsys):
    solver.fails = MemoryError("Unable to allocate 30.7 GiB")
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) == 3
    assert capsys.readouterr().err.startswith(
        "fingerpad: not enough memory: Unable to allocate 30.7 GiB; try "
    )


def test_an_output_that_is_no_path(tmp_path, scene, capsys):
    assert "File name too long" in refused(capsys, ["run", scene, "--out", "a" * 300])
    assert "File name too long" in refused(capsys, ["mesh", scene, "--out", "a" * 300 + ".msh"])


# --- for real -------------------------------------------------------------------------------------


def test_mesh_writes_a_mesh_that_can_be_read_again(tmp_path, scene, capsys):
    out = tmp_path / "new" / "pad.msh"
    assert main(["mesh", str(scene), "--out", str(out)]) == 0
    assert names(out.parent) == ["pad.msh"]
    assert "nodes: " in capsys.readouterr().out

    path = tmp_path / "on_mesh.yaml"
    path.write_text(yaml.safe_dump({**RAMP_AND_HOLD, "specimen": {"mesh": "new/pad.msh"}}))
    assert main(["plan", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["effects"]["symmetry"]["on"]


def test_run_for_real(tmp_path, capsys):
    path = write(tmp_path, changed(accuracy="draft", outputs={"snapshots": ["0.5 s"]}))
    out = tmp_path / "out"
    assert main(["run", str(path), "--out", str(out), "--vtu", "--quiet"]) == 0
    assert names(out) == ["history.nc", "plan.json", "summary.json", "vtu"]
    assert names(out / "vtu") == [
        "indenter_0.vtu",
        "snapshot_0.vtu",
        "snapshots.pvd",
        "snapshots.vtu.series",
    ]
    ramp, hold = json.loads((out / "summary.json").read_text())["legs"]
    for leg in (ramp, hold):
        assert leg["force_N_per_m"] == pytest.approx(20 * 9.80665e-3 / 0.0114, rel=1e-6)
    assert hold["depth_mm"] > ramp["depth_mm"] > 0
    assert (ramp["time_s"], hold["time_s"]) == pytest.approx((0.5, 2.5))
    assert capsys.readouterr().err == ""


def test_as_a_process(tmp_path):
    def fingerpad(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "fingerpad", *arguments], capture_output=True, text=True
        )

    assert fingerpad("--version").returncode == 0
    wrong = fingerpad("run", "no.yaml", "--out", str(tmp_path / "out"))
    assert (wrong.returncode, wrong.stdout, wrong.stderr) == (
        2,
        "",
        "fingerpad: no.yaml: there is no such file\n",
    )
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    "main", ["from fingerpad.cli import main; main(['plan', 'none.yaml'])", ""]
)
def test_what_is_unreachable_at_the_end_is_not_looked_for(main):
    """Of a command: without it, the interpreter's last search finds what points at itself."""
    said = (
        "import gc\n"
        "class Round:\n"
        "    def __init__(self): self.itself = self\n"
        "    def __del__(self): print('found')\n"
        f"{main}\n"
        "seldom = gc.get_threshold()[0] > 10_000\n"
        "Round()\n"
        "print('seldom' if seldom else 'often')\n"
    )
    done = subprocess.run([sys.executable, "-c", said], capture_output=True, text=True, check=True)
    assert done.stdout.split() == (["seldom"] if main else ["often", "found"])
