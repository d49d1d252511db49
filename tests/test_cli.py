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

from faults import files
from fingerpad import cli
from fingerpad.cli import main
from fingerpad.files import write_text
from fingerpad.mechanics.stepping import NonConvergence
from wrong_scenes import BAD, RAMP_AND_HOLD, changed, pad_folder, specimen, write

pytestmark = pytest.mark.unit

THREE = ["history.nc", "plan.json", "summary.json"]
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
    return write(tmp_path, changed(accuracy="draft"))


@pytest.fixture
def solver(monkeypatch):
    """Stand-ins for mesh, simulation and results; `solver.fails` is what the simulation raises."""
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

    def write_vtu(dataset, directory, slices=0):
        write_text(directory / "snapshot_0.vtu", "<VTKFile/>")

    monkeypatch.setattr(cli, "simulate", simulate)
    monkeypatch.setattr(cli, "summary", lambda dataset: SUMMARY)
    monkeypatch.setattr(cli, "write_history", lambda dataset, path: dataset.to_netcdf(path))
    monkeypatch.setattr(cli, "write_vtu", write_vtu)
    return solver


@pytest.fixture
def run(tmp_path, scene, solver):
    """`run(*options)` runs the scene into `run.out` with the stand-ins; the exit code."""

    def run(*options, scene=scene):
        return main(["run", str(scene), "--out", str(run.out), *options])

    run.out = tmp_path / "out"
    return run


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


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "sweep.yaml"], "is a sweep, not a scene; allowed: fingerpad sweep"),
        (["mesh", "sweep.yaml", "--out", "m.msh"], "is a sweep, not a scene; allowed: fingerpad"),
        (["sweep", "my_scene.yaml"], "is a scene, not a sweep; allowed: fingerpad run"),
    ],
)
def test_the_other_command_is_named(tmp_path, scene, capsys, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    write(tmp_path, {"scene": scene.name, "over": {"friction": [0, 0.5]}}, "sweep.yaml")
    assert refused(capsys, words).startswith(f"{words[1]}: {said}")


@pytest.mark.parametrize("command", ["plan", "run", "mesh"])
@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00", b"a: [", b""])
def test_files_that_are_no_scene(tmp_path, capsys, command, content):
    path = tmp_path / "none.yaml"
    if content is not None:
        path.write_bytes(content)
    out = [] if command == "plan" else ["--out", tmp_path / "out.msh"]
    assert str(path) in refused(capsys, [command, path, *out])
    assert names(tmp_path) == ([] if content is None else ["none.yaml"])


@pytest.mark.parametrize("accuracy", ["best", "0", "-1", "nan", "1"])
def test_wrong_accuracy_on_the_command_line(tmp_path, scene, capsys, accuracy):
    line = refused(capsys, ["run", scene, "--out", tmp_path / "out", f"--accuracy={accuracy}"])
    assert line.startswith(f"--accuracy: '{accuracy}' ") and "allowed: " in line
    assert names(tmp_path) == ["my_scene.yaml"]


def test_an_output_that_is_a_file(tmp_path, scene, capsys):
    (tmp_path / "file").write_text("kept")
    for out in ("file", "file/below", "a" * 300):
        assert "--out" in refused(capsys, ["run", scene, "--out", tmp_path / out])
    assert "--out" in refused(capsys, ["mesh", scene, "--out", tmp_path / "file" / "a.msh"])
    assert "ending in .msh" in refused(capsys, ["mesh", scene, "--out", tmp_path / "mesh.txt"])
    assert (tmp_path / "file").read_text() == "kept"
    assert names(tmp_path) == ["file", "my_scene.yaml"]


def test_a_directory_that_cannot_be_written(tmp_path, scene, capsys, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    assert "cannot be written" in refused(capsys, ["run", scene, "--out", tmp_path / "out"])
    assert names(tmp_path) == ["my_scene.yaml"]


def test_an_external_mesh_that_is_no_mesh_is_named_with_its_key(tmp_path, capsys):
    (tmp_path / "my.msh").write_text("not a mesh")
    path = write(tmp_path, specimen(mesh="my.msh"))
    line = refused(capsys, ["run", path, "--out", tmp_path / "out"])
    assert line.startswith(f"{path}: specimen.mesh: ") and "my.msh" in line
    assert names(tmp_path) == ["my.msh", "my_scene.yaml"]


def test_a_plan_that_cannot_be_made_names_the_key(tmp_path, capsys):
    path = write(tmp_path, changed(effects={"ridges": True}))
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


def test_plan_as_json_and_as_a_table(scene, capsys):
    assert main(["plan", str(scene), "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert all(set(effect) == {"on", "why"} for effect in plan["effects"].values())
    assert {"element", "nodes", "steps"} <= set(plan["discretisation"])

    assert main(["plan", str(scene)]) == 0
    table = capsys.readouterr().out
    for words in ("Plan of my_scene", "finite strain", "nodes", "expected error", "predicted cost"):
        assert words in table


def test_accuracy_replaces_the_scene_s(scene, capsys):
    def nodes(*options):
        assert main(["plan", str(scene), "--json", *options]) == 0
        return json.loads(capsys.readouterr().out)["discretisation"]["nodes"]

    assert nodes() == nodes("--accuracy", "draft") < nodes("--accuracy", "thesis")


def test_run_writes_three_files(run, solver, capsys):
    run.out = run.out / "new"
    assert run() == 0
    assert names(run.out) == THREE
    assert json.loads((run.out / "summary.json").read_text()) == SUMMARY
    plan = json.loads((run.out / "plan.json").read_text())
    assert (plan.pop("scene"), plan.pop("files")) == ("my_scene", THREE)
    assert plan == json.loads(json.dumps(solver.plan.to_dict()))
    with xr.open_dataset(run.out / "history.nc", engine="netcdf4") as history:
        assert history.force[-1] == 19.6
    stdout, stderr = capsys.readouterr()
    assert stderr == "" and stdout.count("\n") == 1
    for words in (str(run.out), "error about 4.3 %", "force 20.0 gf (19.6 N/m)"):
        assert words in stdout


def test_force_is_said_in_the_unit_it_came_in(tmp_path, run, capsys):
    assert run(scene=write(tmp_path, changed(motion=[{"press_to_force": "196.133 mN"}]))) == 0
    assert "force 196. mN (19.6 N/m)" in capsys.readouterr().out


def test_results_without_out_go_to_a_folder_of_the_scene_s_name(run, scene, monkeypatch, capsys):
    monkeypatch.chdir(scene.parent)
    assert main(["run", scene.name]) == 0
    assert names("results/my_scene") == THREE
    assert capsys.readouterr().out.endswith("results in results/my_scene\n")


def test_quiet_says_nothing_and_vtu_adds_fields_which_the_next_run_removes(run, solver, capsys):
    assert run("--quiet", "--vtu") == 0
    assert names(run.out) == [*THREE, "vtu"] and names(run.out / "vtu") == ["snapshot_0.vtu"]
    assert capsys.readouterr() == ("", "") and solver.progress is None
    own = [run.out / "notes.txt", run.out / "vtu" / "view.pvsm"]
    for file in own:
        file.write_text("a user's own")
    assert run() == 0
    assert names(run.out) == sorted([*THREE, "notes.txt", "vtu"])
    assert names(run.out / "vtu") == ["view.pvsm"]
    own[1].unlink()
    assert run("--vtu") == run() == 0
    assert names(run.out) == sorted([*THREE, "notes.txt"])


def test_files_of_a_user_s_under_the_names_of_results_are_replaced_by_force_only(
    run, scene, capsys
):
    run.out.mkdir()
    (run.out / "summary.json").write_text("a user's own")
    (run.out / "plan.json").write_text('{"files": ["../../my_scene.yaml", "summary.json.bak", 5]}')
    line = refused(capsys, ["run", scene, "--out", run.out])
    assert str(run.out / "plan.json") in line and "--force" in line
    assert (run.out / "summary.json").read_text() == "a user's own"
    assert run("--force") == 0
    assert json.loads((run.out / "summary.json").read_text()) == SUMMARY and scene.exists()


def test_results_of_another_scene_are_replaced_by_force_only(tmp_path, run, capsys):
    other = write(tmp_path, changed(), "other.yaml")
    assert run("--quiet") == 0
    before = files(run.out)
    assert "the scene 'my_scene'" in refused(capsys, ["run", other, "--out", run.out])
    assert files(run.out) == before
    assert run("--force", scene=other) == 0
    assert json.loads((run.out / "plan.json").read_text())["scene"] == "other"


def test_a_second_run_into_one_folder_is_refused_while_the_first_lives(run, scene, capsys):
    """The lock is a process's: it goes when that is killed, and leaves nothing."""
    run.out.mkdir()
    code = (
        "import time; from fingerpad.files import locked\n"
        f"with locked({str(run.out)!r}): print(flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    try:
        other.stdout.readline()
        assert "another run" in refused(capsys, ["run", scene, "--out", run.out])
        assert names(run.out) == []
    finally:
        other.kill()
        other.wait()
    (run.out / ".fingerpad-leftover").mkdir()
    assert run() == 0 and names(run.out) == THREE


def test_progress_on_a_terminal(run, solver, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert run() == 0 and solver.progress is not None


# --- what goes wrong later ------------------------------------------------------------------------


def failing(error, forces, times=(0.0, 0.25)):
    """The error with a history of what had converged."""
    error.dataset = xr.Dataset({"force": ("time", forces)}, {"time": list(times)})
    return error


def test_non_convergence_exits_3_and_saves_the_last_converged_state(run, solver, capsys):
    assert run("--quiet") == 0
    solver.fails = failing(NonConvergence(0.25, "the residual stalls", "smaller steps"), [0, 9.8])
    assert run("--quiet") == 3
    assert names(run.out) == ["last_converged.nc", "plan.json"]
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    saved = str(run.out / "last_converged.nc")
    for words in ("0.25 s", "the residual stalls", "smaller steps", saved):
        assert words in err
    solver.fails.dataset = None
    assert run() == 3 and names(run.out) == ["plan.json"]
    assert "no step had converged" in capsys.readouterr().err


def test_interrupt_before_anything_has_converged_leaves_nothing(tmp_path, run, solver, capsys):
    solver.fails = KeyboardInterrupt()
    run.out = run.out / "new"
    assert run() == 130
    assert names(tmp_path) == ["my_scene.yaml"]
    assert capsys.readouterr().err == "fingerpad: interrupted\n"


def test_interrupt_keeps_what_had_converged_beside_the_results_there_are(run, solver, capsys):
    assert run("--quiet") == 0
    before = (run.out / "history.nc").read_bytes()
    solver.fails = failing(KeyboardInterrupt(), [0.0, 9.8])
    assert run() == 130
    err = capsys.readouterr().err
    assert "interrupted after t = 0.25 s" in err and err.count("\n") == 1
    assert str(run.out / "last_converged.nc") in err
    assert names(run.out) == sorted([*THREE, "last_converged.nc"])
    assert (run.out / "history.nc").read_bytes() == before
    solver.fails = None
    assert run() == 0 and names(run.out) == THREE


def test_an_unforeseen_error_is_one_line_and_a_file(tmp_path, run, monkeypatch, capsys):
    """No traceback reaches the user, nor a warning of a library; both are in the file that the line
    names.
    """

    def broken(*_, **__):
        warnings.warn("a library's warning", RuntimeWarning, stacklevel=1)
        raise ZeroDivisionError("nobody has thought\nof this")

    monkeypatch.setattr(cli, "simulate", broken)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    assert run() == 1
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1
    assert "internal error, ZeroDivisionError: nobody has thought of this" in err
    (report,) = tmp_path.glob("fingerpad-error-*.txt")
    assert str(report) in err and not run.out.exists()
    for words in ("Traceback", "in broken", "a library's warning", "Python 3"):
        assert words in report.read_text()


def test_no_memory_is_one_line(run, solver, capsys):
    solver.fails = MemoryError("Unable to allocate 30.7 GiB")
    assert run() == 3
    line = "fingerpad: not enough memory: Unable to allocate 30.7 GiB; try "
    assert capsys.readouterr().err.startswith(line)


# --- for real -------------------------------------------------------------------------------------


def test_mesh_writes_a_mesh_that_can_be_read_again(tmp_path, scene, capsys):
    out = tmp_path / "new" / "pad.msh"
    assert main(["mesh", str(scene), "--out", str(out)]) == 0
    assert names(out.parent) == ["pad.msh"]
    assert "nodes: " in capsys.readouterr().out

    path = write(tmp_path, RAMP_AND_HOLD | {"specimen": {"mesh": "new/pad.msh"}}, "on_mesh.yaml")
    assert main(["plan", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["effects"]["symmetry"]["on"]


def test_as_a_process(tmp_path):
    def fingerpad(*words):
        command = [sys.executable, "-m", "fingerpad", *words]
        return subprocess.run(command, capture_output=True, text=True)

    assert fingerpad("--version").stdout.startswith("fingerpad 0.")
    wrong = fingerpad("run", "no.yaml", "--out", str(tmp_path / "out"))
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr == "fingerpad: no.yaml: there is no such file\n"
    assert names(tmp_path) == []
