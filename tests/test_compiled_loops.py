"""Compiled loops: kept once for each law and element, told of while they compile."""

import os
import subprocess
import sys
from contextlib import nullcontext
from dataclasses import replace

import pytest
from numba import njit

from fingerpad import compiled
from fingerpad.laws import LAWS, NEO_HOOKE
from fingerpad.mechanics import kernels

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


def test_a_second_process_takes_what_the_first_compiled(tmp_path):
    code = """if True:
        import fingerpad
        from fingerpad.compiled import compiling
        motion = [{"press_to_depth": "0.2 mm", "speed": "1 mm/s"}]
        fingerpad.simulate(
            {"stimulus": {"shape": "flat"}, "motion": motion, "accuracy": {"skin_edge": "0.8 mm"}}
        )
        print(compiling() > 0.0)
    """
    for compiles in ("True", "False"):
        done = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
        )
        assert done.stdout.strip() == compiles, done.stderr


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
        kernels.loops(law, *sizes).commit.py_func.__qualname__
        for law in (NEO_HOOKE, LAWS["yeoh"])
        for sizes in ((9, 9, 3), (4, 4, 1), (7, 7, 3))
    }
    assert len(names) == 6 and any(NEO_HOOKE.source[:16] in name for name in names)


def test_loops_of_a_law_from_elsewhere_are_not_kept():
    foreign = replace(NEO_HOOKE, name="mine", stress=lambda i1, jac, mu, constants: (mu, 1.0))
    assert kernels.loops(foreign, 9, 9, 3).commit.stats.cache_path is None
    assert kernels.loops(NEO_HOOKE, 9, 9, 3).commit.stats.cache_path is not None
