"""Whatever goes wrong with files: one line, a code of the interface, nothing half-written, and a
rerun that completes.
"""

import ctypes
import errno
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import types
from pathlib import Path

import pytest

import fingerpad
from faults import ERRORS, Faults, files, in_child, results
from fingerpad import cli
from fingerpad.cli import main
from fingerpad.files import read_input, staged, write_atomically, write_text
from wrong_scenes import changed, write

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
COARSE = {"skin_edge": "0.8 mm", "steps": 2}


@pytest.fixture(scope="module")
def histories():
    """Two results of one scene that differ: what was there, and what comes."""
    scenes = [
        changed(motion=[{"press_to_force": force, "rate": "40 gf/s"}], accuracy=COARSE)
        for force in ("5 gf", "10 gf")
    ]
    return [fingerpad.simulate(scene, fields=True) for scene in scenes]


@pytest.fixture
def run(tmp_path, histories, monkeypatch):
    """`run()` runs the command with the solver replaced by the result that comes; what was there is
    there already.
    """
    scene, out = write(tmp_path, changed(accuracy=COARSE)), tmp_path / "out"
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "elsewhere"))
    (tmp_path / "elsewhere").mkdir()
    result = types.SimpleNamespace(comes=histories[0])
    monkeypatch.setattr(cli, "simulate", lambda *_, **__: result.comes)

    def run(*options):
        return main(["run", str(scene), "--out", str(out), "--quiet", "--vtu", *options])

    assert run() == 0
    before = files(out)
    result.comes = histories[1]
    shutil.copytree(out, tmp_path / "kept")
    assert run() == 0
    run.out, run.before, run.after, run.result = out, before, files(out), result

    def restore():
        shutil.rmtree(out)
        shutil.copytree(tmp_path / "kept", out)

    run.restore = restore
    assert run.before.keys() == run.after.keys() and all(
        run.before[name] != run.after[name] for name in ("history.nc", "summary.json")
    )
    return run


def _faults(run, hows, step=1):
    """Calls that touch the folder, each with the next way in which it may go wrong."""
    run.restore()
    with Faults(run.out) as counted:
        assert run() == 0
    assert counted.calls > 20
    for at in range(0, counted.calls, step):
        run.restore()
        yield Faults(run.out, at, hows[at % len(hows)])


def test_any_call_may_fail(run, capsys, tmp_path):
    """One line, 2 or 3; what was there is as it was, and what was computed is where the line
    says.
    """
    elsewhere = 0
    for fault in _faults(run, ERRORS):
        with fault:
            code = run()
        err = capsys.readouterr().err
        if code == 0:  # of what is only tidied up
            assert err == "" and results(run.out) == run.after, fault.met
            continue
        assert code in (2, 3) and err.count("\n") == 1 and "internal" not in err, (fault.met, err)
        assert results(run.out) == run.before, (fault.met, err)
        if place := re.search(r"these results are in '(.*)'", err):
            assert files(place[1]) == run.after, fault.met
            elsewhere += 1
        else:
            assert code == 2 or "fails" in err, (fault.met, err)  # before anything was solved
    assert elsewhere > 10
    assert run() == 0 and files(run.out) == run.after


def test_any_call_may_be_interrupted(run, capsys):
    for fault in _faults(run, ["interrupt"], 2):
        with fault:
            code = run()
        assert code == 130 and capsys.readouterr().err.count("\n") == 1, fault.met
        assert results(run.out) in (run.before, run.after), fault.met
    assert run() == 0 and files(run.out) == run.after


def test_any_call_may_be_the_last(run):
    """Killed there: every file is whole, of the run before or of this one; the next run completes
    and tidies up.
    """
    for fault in _faults(run, ["kill"], 4):

        def killed(fault=fault):
            with fault:
                return run()

        assert in_child(killed) == 9, fault.at
        there = results(run.out)
        assert all(
            content in (run.before[name], run.after[name]) for name, content in there.items()
        ), fault.at
        assert there.keys() == run.before.keys(), fault.at
        assert run() == 0 and files(run.out) == run.after, fault.at


def test_results_that_fit_nowhere_are_lost_in_one_line(run, capsys, tmp_path):
    shutil.rmtree(tmp_path / "elsewhere")
    run.restore()
    with Faults(run.out, 12, errno.ENOSPC):
        assert run() == 3
    err = capsys.readouterr().err
    assert (
        err.count("\n") == 1
        and "nor can a temporary place" in err
        and "lost" in err
        and files(run.out) == run.before
    )


def test_a_file_that_appears_while_a_run_goes_on_stays(run, capsys, monkeypatch):
    shutil.rmtree(run.out)

    def solve(*_, **__):
        (run.out / "history.nc").write_text("somebody else's")
        return run.result.comes

    monkeypatch.setattr(cli, "simulate", solve)
    assert run() == 3
    err = capsys.readouterr().err
    assert "'history.nc' has come into it meanwhile" in err and err.count("\n") == 1
    assert files(run.out) == {"history.nc": b"somebody else's"}
    assert files(re.search(r"these results are in '(.*)'", err)[1]) == run.after


def test_a_folder_without_room_is_refused_before_anything_is_solved(run, capsys, monkeypatch):
    monkeypatch.setattr(cli, "simulate", lambda *_, **__: pytest.fail("solved"))
    monkeypatch.setattr(shutil, "disk_usage", lambda _: types.SimpleNamespace(free=1e5))
    run.restore()
    assert run() == 2
    assert "has no room for about" in capsys.readouterr().err and files(run.out) == run.before


def test_the_room_that_is_asked_for_is_enough_and_not_much_too_much(run, histories):
    scene = fingerpad.load_scene(changed(accuracy=COARSE))
    needed, taken = (
        fingerpad.plan(scene).result_bytes(scene, True),
        sum(map(len, run.after.values())),
    )
    assert taken < needed < 10 * taken


def test_links_in_the_folder_lead_nothing_out_of_it(run, capsys, tmp_path):
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "snapshot_0.vtu").write_text("theirs")
    shutil.rmtree(run.out / "vtu")
    (run.out / "vtu").symlink_to(tmp_path / "theirs")
    for options in ((), ("--force",)):
        before = files(run.out)
        assert run(*options) == 3
        assert "vtu" in capsys.readouterr().err and files(run.out) == before
        assert files(tmp_path / "theirs") == {"snapshot_0.vtu": b"theirs"}
    os.unlink(run.out / "vtu")
    (tmp_path / "theirs" / "mine.nc").write_text("theirs")
    os.unlink(run.out / "history.nc")
    (run.out / "history.nc").symlink_to(tmp_path / "theirs" / "mine.nc")
    assert run() == 0
    assert (tmp_path / "theirs" / "mine.nc").read_text() == "theirs" and not (
        run.out / "history.nc"
    ).is_symlink()


def test_a_plan_in_the_folder_may_be_anything(run, capsys):
    for content in ("[" * 100_000, '{"files": 5}', "[]", '{"files": [null], "scene": {}}', "\xff"):
        (run.out / "plan.json").write_text(content)
        assert run() == 2 and capsys.readouterr().err.count("\n") == 1
    os.unlink(run.out / "plan.json")
    os.mkfifo(run.out / "plan.json")
    assert run("--force") == 0 and files(run.out) == run.after


# --- files by themselves --------------------------------------------------------------------------


def test_what_a_killed_writer_left_goes_with_the_next(tmp_path):
    """Of this machine's dead processes only."""

    def half():
        write_atomically(
            tmp_path / "a.csv", lambda partial: (partial.write_text("half"), os._exit(9))
        )

    assert in_child(half) == 9
    (left,) = tmp_path.iterdir()
    living = left.with_name(re.sub(r"-\d+\.", f"-{os.getppid()}.", left.name))
    living.write_text("another process's")
    (tmp_path / ".a.csv.elsewhere-1.x.csv").write_text("another machine's")
    write_text(tmp_path / "a.csv", "whole")
    assert {path.name for path in tmp_path.iterdir()} == {
        "a.csv",
        living.name,
        ".a.csv.elsewhere-1.x.csv",
    }


@pytest.mark.parametrize("how", [errno.EIO, "interrupt"])
def test_files_come_together_or_not_at_all(tmp_path, how):
    """A folder of two files, of which one is there before and a third goes: after any fault all is
    as before.
    """
    folder = tmp_path / "folder"

    def fill():
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "sub").mkdir(parents=True)
        for name in ("a", "sub/gone"):
            (folder / name).write_text("old")
        return files(folder)

    def change():
        with staged(folder, "b", ["sub/gone"]) as stage:
            for name in ("a", "b"):
                (stage / name).write_text("new")

    before = fill()
    with Faults(folder) as counted:
        change()
    after = files(folder)
    assert after == {"a": b"new", "b": b"new"} and counted.calls > 8
    outcomes = set()
    for at in range(counted.calls):
        assert fill() == before
        try:
            with Faults(folder, at, how):
                change()
            outcomes.add("done")
        except (OSError, KeyboardInterrupt):
            outcomes.add("failed")
        assert results(folder) in (before, after), at
    assert "failed" in outcomes


def test_a_directory_under_the_name_of_a_result_stays(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "mine").write_text("mine")
    with pytest.raises(OSError), staged(tmp_path) as stage:
        (stage / "a").write_text("new")
    assert files(tmp_path) == {"a/mine": b"mine"}


def test_inputs_are_read_without_waiting_and_up_to_a_size(tmp_path):
    os.mkfifo(tmp_path / "silent")
    started = time.monotonic()
    for path, words in {
        "/dev/zero": "a device",
        tmp_path: "directory",
        tmp_path / "silent": "nobody writes",
    }.items():
        with pytest.raises(OSError, match=words):
            read_input(path, "text")
    assert time.monotonic() - started < 10
    with (tmp_path / "large").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(OSError, match="more than 1.05 MB"):
        read_input(tmp_path / "large", "text")
    end, start = os.pipe()
    os.write(start, b"a: 1")
    os.close(start)
    assert read_input(f"/dev/fd/{end}", "text") == b"a: 1"
    os.close(end)


# --- for real -------------------------------------------------------------------------------------


LIMITS = {
    "files may not grow": (resource.RLIMIT_FSIZE, 20_000, "lost"),
    "little memory": (resource.RLIMIT_AS, 200_000_000, "memory"),
    "not enough memory": (resource.RLIMIT_AS, 700_000_000, "memory"),
}


@pytest.mark.parametrize("name", LIMITS)
def test_limits_of_the_system_are_one_line(tmp_path, name):
    """Real limits, met by netCDF and by imports; the loops of the scene are compiled before."""
    limit, most, said = LIMITS[name]
    scene = write(tmp_path, changed(accuracy=COARSE))
    fingerpad.simulate(scene)
    done = subprocess.run(
        [sys.executable, "-m", "fingerpad", "run", scene, "--out", tmp_path / "out", "--quiet"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=os.environ | {"TMPDIR": str(tmp_path), "OMP_NUM_THREADS": "1"},
        preexec_fn=lambda: resource.setrlimit(limit, (most, most)),
    )
    assert done.returncode == 3 and done.stderr.count("\n") == 1 and said in done.stderr
    assert files(tmp_path).keys() == {"my_scene.yaml"}


@pytest.fixture
def disk(tmp_path):
    """A small disk of its own, where a test may mount one."""
    libc, place = ctypes.CDLL(None, use_errno=True), tmp_path / "disk"
    place.mkdir()
    if os.geteuid() or libc.mount(b"none", str(place).encode(), b"tmpfs", 0, b"size=2m"):
        pytest.skip("only root can mount a disk")
    yield place
    libc.umount2(str(place).encode(), 2)


def test_a_full_and_a_read_only_disk(disk, run, tmp_path, capsys, monkeypatch):
    scene = tmp_path / "my_scene.yaml"
    words = ["run", str(scene), "--out", str(disk / "out"), "--quiet", "--vtu"]

    def solve(*_, **__):  # the disk fills while it is solved
        (disk / "filler").write_bytes(bytes(shutil.disk_usage(disk).free - 40_000))
        return run.result.comes

    monkeypatch.setattr(cli, "simulate", solve)
    assert main(words) == 3
    err = capsys.readouterr().err
    assert "No space left" in err and err.count("\n") == 1 and files(disk).keys() == {"filler"}
    assert files(re.search(r"these results are in '(.*)'", err)[1]) == run.after
    (disk / "filler").unlink()
    monkeypatch.setattr(cli, "simulate", lambda *_, **__: run.result.comes)
    assert main(words) == 0 and files(disk / "out") == run.after
    libc = ctypes.CDLL(None)
    libc.umount2(str(disk).encode(), 2)
    assert not libc.mount(
        b"none", str(disk).encode(), b"tmpfs", 1, b"size=2m"
    )  # a new one, read-only
    assert main(words) == 2
    assert "cannot be written" in capsys.readouterr().err and not files(disk)


# --- the workflow's job ---------------------------------------------------------------------------


def test_a_job_of_the_workflow_writes_whole_files_whatever_fails(tmp_path, histories, monkeypatch):
    """After every fault there are whole files or none, and the next run makes the same bytes."""
    from cysyk1999.workflow import simulate

    scene, folder = write(tmp_path, changed(accuracy=COARSE)), tmp_path / "results"
    monkeypatch.setattr(simulate.healing, "simulate", lambda *_, **__: histories[0])
    monkeypatch.setattr(simulate, "read_pad_mesh", lambda *_: None)
    given = {"scenes": [scene], "accuracies": ["as_stated"], "meshes": ["own"], "strides": ["1"]}
    job = types.SimpleNamespace(**given, histories=[str(folder / "history.nc")])
    with Faults(folder) as counted:
        simulate.simulate(job)
    whole = files(folder)
    assert (
        set(whole) == {"history.nc", "mesh.msh", "plan.json", "summary.json"} and counted.calls > 10
    )
    assert json.loads(whole["plan.json"])
    for at in range(0, counted.calls, 2):
        shutil.rmtree(folder)
        with Faults(folder, at, ERRORS[at % len(ERRORS)]) as fault:
            try:
                simulate.simulate(job)
            except OSError:
                assert all(content == whole[name] for name, content in files(folder).items()), (
                    fault.met
                )
        simulate.simulate(job)
        assert files(folder) == whole, fault.met
