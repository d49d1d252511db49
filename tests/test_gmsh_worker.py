"""gmsh works for whoever asks, whatever session, thread, configuration or process that is, and
leaves everything as it was.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import gmsh
import numpy as np
import pytest

from fingerpad.cli import main
from fingerpad.scenes.scene import Outline
from fingerpad.specimen import MeshSize, build_pad_mesh, read_pad_mesh, write_pad
from fingerpad.specimen.build import _rectangle
from fingerpad.specimen.gmsh_worker import GmshError, _Worker, ask
from synthetic import OUTLINE as THESIS

pytestmark = pytest.mark.unit

COARSE = MeshSize(skin_edge=1e-3, fine_half_width=2e-3, layer_edge=0.5e-3, growth=1.5)


@pytest.fixture
def no_cache():
    """No mesh is remembered, so that gmsh has to work."""
    _rectangle.cache_clear()


def pad():
    return build_pad_mesh(Outline(**THESIS), COARSE)


def test_an_open_session_of_the_caller_stays_as_it_is(no_cache, tmp_path):
    gmsh.initialize(["", "-v", "0"], interruptible=False)
    try:
        gmsh.model.add("mine")
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", 1)  # which would cut every quad in four
        point = gmsh.model.geo.addPoint(1, 2, 3)
        mesh = pad()
        write_pad(mesh, tmp_path / "pad.msh")
        again = read_pad_mesh(tmp_path / "pad.msh")
        assert gmsh.isInitialized() and gmsh.model.getCurrent() == "mine"
        assert gmsh.option.getNumber("Mesh.SubdivisionAlgorithm") == 1
        gmsh.model.geo.synchronize()
        assert gmsh.model.getEntities(0) == [(0, point)]
        assert len(again.points) == len(mesh.points)
    finally:
        gmsh.finalize()
    assert len(pad().points) == len(mesh.points)


def test_signals_and_output_are_left_alone(no_cache, capfd):
    before = signal.getsignal(signal.SIGINT)
    pad()
    assert signal.getsignal(signal.SIGINT) is before
    assert capfd.readouterr() == ("", "")
    assert not gmsh.isInitialized()


def test_worker_threads_may_be_first(no_cache):
    """Neither the first use nor many at once need the main thread."""
    with ThreadPoolExecutor(4) as pool:
        meshes = list(pool.map(lambda _: pad(), range(4)))
    for mesh in meshes[1:]:
        np.testing.assert_array_equal(mesh.points, meshes[0].points)
        np.testing.assert_array_equal(mesh.cells, meshes[0].cells)


def test_two_own_meshes_are_read_at_once(tmp_path):
    mesh, paths = pad(), [tmp_path / f"{k}.msh" for k in range(6)]
    for path in paths:
        write_pad(mesh, path)
    with ThreadPoolExecutor(6) as pool:
        assert {len(each.points) for each in pool.map(read_pad_mesh, paths)} == {len(mesh.points)}


@pytest.mark.parametrize("file", [".gmshrc", ".gmsh-options"])
def test_a_users_configuration_is_not_read(file, tmp_path):
    (tmp_path / file).write_text("Mesh.SubdivisionAlgorithm = 1;\nMesh.ElementOrder = 1;\n")
    script = (
        "import sys, numpy as np\n"
        "from fingerpad.specimen.gmsh_worker import ask\n"
        "assert ask('rectangle', 3, (2, 1, 1)).shape == (12, 9, 2)\n"
    )
    environment = os.environ | {"HOME": str(tmp_path), "GMSH_HOME": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, cwd=tmp_path, capture_output=True
    )
    assert done.returncode == 0, done.stderr


def test_a_forked_child_has_a_gmsh_of_its_own():
    first = ask("rectangle", 2, (1, 1, 1))
    child = os.fork()
    if not child:
        os._exit(not np.array_equal(ask("rectangle", 2, (1, 1, 1)), first))
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    np.testing.assert_array_equal(ask("rectangle", 2, (1, 1, 1)), first)


def test_a_gmsh_that_crashes_is_said_and_started_anew():
    worker = _Worker()
    worker.ask("rectangle", 1, (1, 1, 1))
    threading.Timer(0.3, worker._process.kill).start()
    with pytest.raises(GmshError, match="ended with code -9"):
        worker.ask("rectangle", 900, (200, 200, 200))
    assert worker.ask("rectangle", 1, (1, 1, 1)).shape == (3, 9, 2)
    worker.close()


def test_a_gmsh_that_does_not_end_is_stopped(monkeypatch):
    monkeypatch.setattr("fingerpad.specimen.gmsh_worker.PATIENCE", 0.2)
    worker = _Worker()
    with pytest.raises(GmshError, match="not come to an end in 0.2 s"):
        worker.ask("rectangle", 900, (200, 200, 200))
    assert worker._process.returncode is not None


def test_gmsh_ends_with_the_process_that_started_it(tmp_path):
    """Killed in the middle of a task."""
    script = (
        "import fingerpad.specimen.gmsh_worker as w, threading, time, os\n"
        "task = 'rectangle', 3000, (900, 900, 900)\n"
        "threading.Thread(target=w.ask, args=task, daemon=True).start()\n"
        "time.sleep(1.5)\n"
        "print(w._WORKER._process.pid, flush=True)\n"
        "os.kill(os.getpid(), 9)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    pid = int(done.stdout)
    for _ in range(50):
        if not os.path.exists(f"/proc/{pid}"):
            return
        time.sleep(0.1)
    os.kill(pid, 9)
    pytest.fail("gmsh goes on")


def test_gmsh_that_cannot_be_loaded_is_said_in_one_line(no_cache, tmp_path, monkeypatch, capsys):
    """As where the system libraries of its wheel are missing."""
    (tmp_path / "gmsh.py").write_text(
        "raise OSError('libGLU.so.1: cannot open shared object file')\n"
    )
    (tmp_path / "scene.yaml").write_text(
        'stimulus: {shape: flat}\nmotion: [{press_to_force: "1 gf"}]\naccuracy: draft\n'
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("fingerpad.specimen.build.ask", _Worker().ask)
    assert main(["mesh", str(tmp_path / "scene.yaml"), "--out", str(tmp_path / "m.msh")]) == 3
    said = capsys.readouterr().err
    assert "gmsh cannot be loaded: libGLU.so.1" in said and "apt-get install" in said
    assert said.count("\n") == 1
