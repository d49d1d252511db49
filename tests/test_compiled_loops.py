"""Compiled loops: kept once for each law and element, told of while they compile."""

import os
import shutil
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest
from numba import njit

from fingerpad import compiled
from fingerpad.laws import LAWS, NEO_HOOKE
from fingerpad.mechanics import kernels
from fingerpad.mechanics.kinematics import KINEMATICS, PLANE_STRAIN
from fingerpad.specimen import write_pad
from own_meshes import slab_mesh, split

pytestmark = pytest.mark.unit


def test_compiling_is_shown_and_counted_once(monkeypatch):
    shown = []
    monkeypatch.setattr(compiled, "waiting", lambda text: shown.append(text) or nullcontext())
    inner = njit(lambda x: x + 1.0)
    loop = njit(lambda x: inner(x) * 2.0)
    spent = []
    for _ in range(2):
        before = compiled.compiling()
        assert loop(1.0) == 4.0
        spent.append(compiled.compiling() - before)
    assert spent[0] > 0.01 and spent[1] == 0.0
    assert len(shown) == 1 and "compiling loops" in shown[0]


@pytest.fixture
def slabs(tmp_path):
    """One slab of linear quads, and of linear triangles."""
    mesh = slab_mesh(0.5e-3)
    write_pad(mesh, tmp_path / "quads.msh")
    write_pad(split(mesh, "tri3", [0, 1, 2], [0, 2, 3]), tmp_path / "triangles.msh")
    return tmp_path


def simulated(folder, *slabs):
    """Contact widths (m) of a press on each slab, and whether loops were compiled: in a process of
    its own, which keeps loops in ``folder``.
    """
    code = f"""if True:
        import fingerpad
        from fingerpad.compiled import compiling
        from own_meshes import SLAB
        for name in {slabs}:
            print(float(fingerpad.simulate(SLAB(name)).contact_width[-1]))
        print(compiling() > 0.0)
    """
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=folder,
        # names of helpers depend on the order of a set: here it is the same in all processes
        env=os.environ
        | {
            "NUMBA_CACHE_DIR": str(folder / "loops"),
            "PYTHONPATH": os.pathsep.join(map(str, (Path(__file__).parent, *sys.path))),
            "PYTHONHASHSEED": "0",
        },
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_process_takes_what_others_compiled_and_mixes_nothing_up(slabs):
    """Helpers of two elements, compiled by two processes, once had one name: a third process, which
    took both, ran those of the first for both and crashed.
    """
    quads, triangles = "quads.msh", "triangles.msh"
    (of_quads, first), (of_triangles, second) = (
        simulated(slabs, name) for name in (quads, triangles)
    )
    assert (first, second) == ("True", "True")
    assert simulated(slabs, quads, triangles) == [of_quads, of_triangles, "False"]
    assert simulated(slabs, triangles, quads) == [of_triangles, of_quads, "False"]


def test_where_nothing_can_be_kept_loops_are_still_compiled(monkeypatch):
    def refuses(**options):
        raise RuntimeError("no locator available")

    assert compiled.JIT["cache"]
    monkeypatch.setattr(compiled, "njit", refuses)
    assert not compiled._can_be_kept()


def test_laws_and_elements_have_files_of_their_own():
    """Linear quads once ran the machine code of triangles, compiled in another process in the same
    moment, and crashed. An edited law must not run what was compiled of it before.
    """
    names = {
        kernels.loops(law, kinematics, *sizes).commit.py_func.__qualname__
        for law in (NEO_HOOKE, LAWS["yeoh"])
        for kinematics in KINEMATICS.values()
        for sizes in ((9, 9, 3), (4, 4, 1), (7, 7, 3))
    }
    assert len(names) == 12 and any(NEO_HOOKE.source[:16] in name for name in names)


def test_loops_of_a_law_from_elsewhere_are_not_kept():
    foreign = replace(NEO_HOOKE, name="mine", stress=lambda i1, jac, mu, constants: (mu, 1.0))
    assert kernels.loops(foreign, PLANE_STRAIN, 9, 9, 3).commit.stats.cache_path is None
    assert kernels.loops(NEO_HOOKE, PLANE_STRAIN, 9, 9, 3).commit.stats.cache_path is not None


@pytest.mark.slow
def test_a_first_scene_needs_no_more_than_set_up_compiles(tmp_path):
    """The last step of set-up, in a tree as cloned: without .pyc."""
    root = Path(__file__).parents[1]
    for folder in ("src", "workflow/scripts", "config/scenes", "config/specimens"):
        ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
        shutil.copytree(root / folder, tmp_path / folder, ignore=ignored)
    _, _, step = (root / "workflow/scripts/setup.sh").read_text().partition("say 5 ")
    env = os.environ | {"PYTHONPATH": str(tmp_path / "src"), "run": sys.executable}
    for unwanted in ("NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE"):
        env.pop(unwanted, None)
    scene = """if True:
        import fingerpad
        from fingerpad.compiled import compiling
        fingerpad.simulate("config/scenes/ramp40_k210.yaml")
        print(compiling())
    """
    here = {"cwd": tmp_path, "env": env, "check": True, "capture_output": True, "text": True}
    subprocess.run(["sh", "-ec", f"say() {{ :; }}; venv=.; say 5 {step}"], **here)
    done = subprocess.run([sys.executable, "-c", scene], **here)
    assert float(done.stdout) == 0.0
