"""The cache of compiled loops: processes that compile different ones at once do not take each other's."""

import multiprocessing

import pytest
from numba.core.caching import IndexDataCacheFile

import fingerpad.mechanics.kernels  # noqa: F401 - makes the cache wait
from fingerpad.mechanics.kernels import locked

pytestmark = pytest.mark.unit
PROCESSES, KEYS = 6, 25


def _keep(folder, number, barrier, alone):
    save = IndexDataCacheFile.save if alone else IndexDataCacheFile.save.__wrapped__
    barrier.wait()
    for key in range(KEYS):
        save(IndexDataCacheFile(folder, "loop", 0), (number, key), f"code of {number}, {key}")


def _kept(folder, alone):
    """What is found under every key after all processes have saved theirs at once."""
    context = multiprocessing.get_context("fork")
    barrier = context.Barrier(PROCESSES)
    workers = [context.Process(target=_keep, args=(str(folder), n, barrier, alone)) for n in range(PROCESSES)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
        assert worker.exitcode == 0
    cache = IndexDataCacheFile(str(folder), "loop", 0)
    return {(n, key): cache.load((n, key)) for n in range(PROCESSES) for key in range(KEYS)}


def test_compiled_loops_are_kept_one_at_a_time(tmp_path):
    """Linear quads once ran the machine code of triangles, compiled in another process in the same moment, and crashed."""
    assert _kept(tmp_path, alone=True) == {(n, k): f"code of {n}, {k}" for n in range(PROCESSES) for k in range(KEYS)}


def test_mutant_without_the_lock_loses_or_confuses_them(tmp_path):
    found = _kept(tmp_path, alone=False)
    assert any(code != f"code of {n}, {k}" for (n, k), code in found.items())


def test_whoever_waits_gets_the_folder_in_the_end(tmp_path):
    with locked(tmp_path), pytest.raises(BlockingIOError), locked(tmp_path):
        pass
    with locked(tmp_path, wait=True):
        pass
