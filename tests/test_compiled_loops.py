"""Compiled loops are kept as machine code and run without numba: the same answers, each for its
types, sources and processor.
"""

import multiprocessing
import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from numba import njit

from fingerpad import machine_code
from fingerpad.laws import LAWS, NEO_HOOKE
from fingerpad.machine_code import Loop
from fingerpad.mechanics import compiled, kernels

pytestmark = pytest.mark.unit
PROCESSES = 6


@cache
def weighted():
    """A loop of all that loops take: arrays of several types, tuples, numbers and None; what it
    allocates is freed.
    """

    @njit
    def loop(values, pair, factor, extra, out):
        room = np.empty(len(values))
        for k in range(len(values)):
            room[k] = values[k] ** 1.5 * pair[0][k] + pair[1]
            if extra is not None:
                room[k] += extra[k]
            out[k] = factor * room[k]
        return out[0], room.sum()

    return loop


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(machine_code, "_folders", lambda: (tmp_path,))
    return tmp_path


def never():
    raise AssertionError("compiled anew")


@pytest.mark.parametrize("extra", [None, np.array([1.0, 2.0, 4.0])])
@pytest.mark.parametrize(
    "weights", [np.array([1, 2, 3], dtype=np.int32), np.array([1, 2, 3]), np.arange(6.0)[::2]]
)
def test_a_kept_loop_gives_what_the_compiled_one_gives(folder, extra, weights):
    values = np.array([0.3, 0.7, 1.9])
    answers = []
    for loop in (Loop("weighted", weighted, "sources"), Loop("weighted", never, "sources")):
        out = np.zeros(3)
        answers.append((*loop(values, (weights, 0.25), 2.0, extra, out), *out))
    truth = 2 * (values**1.5 * weights + 0.25 + (0 if extra is None else extra))
    np.testing.assert_allclose(answers[0], [truth[0], truth.sum() / 2, *truth], rtol=1e-14)
    assert answers[0] == answers[1] and len(list(folder.iterdir())) == 1


def test_what_is_compiled_is_counted_as_such_and_what_is_kept_is_not(folder):
    values, out = np.array([0.3, 0.7, 1.9]), np.zeros(3)
    spent = []
    for loop in (Loop("weighted", weighted, "counted"), Loop("weighted", never, "counted")):
        before = machine_code.compiling()
        loop(values, (values, 0.25), 2.0, None, out)
        spent.append(machine_code.compiling() - before)
    assert spent[0] > 0.01 and spent[1] == 0


def test_other_types_sources_or_makers_are_compiled_anew(folder, monkeypatch):
    """Strides, sizes of integers and whatever else is compiled in are no matter of the arrays'
    contents.
    """
    values, out = np.array([0.3, 0.7, 1.9]), np.zeros(3)
    loop = Loop("weighted", weighted, "sources")
    loop(values, (values, 0.25), 2.0, None, out)
    never_again = Loop("weighted", never, "sources")
    read_only = values.copy()
    read_only.flags.writeable = False
    for weights in (
        values.astype(np.float32),
        values.astype(np.int64),
        np.arange(6.0)[::2],
        read_only,
    ):
        with pytest.raises(AssertionError, match="compiled anew"):
            never_again(values, (weights, 0.25), 2.0, None, out)
    with pytest.raises(AssertionError, match="compiled anew"):
        never_again(values, (values, 0.25), 2, None, out)
    with pytest.raises(AssertionError, match="compiled anew"):
        Loop("weighted", never, "edited")(values, (values, 0.25), 2.0, None, out)
    for what in ("_processor", "_maker"):
        with monkeypatch.context() as other:
            other.setattr(machine_code, what, lambda: "another")
            with pytest.raises(AssertionError, match="compiled anew"):
                Loop("weighted", never, "sources")(values, (values, 0.25), 2.0, None, out)


def test_rows_of_fortran_are_not_taken_for_rows_of_c(folder):
    """At a mutant that knows arrays by their numbers alone it would read the transposed matrix."""
    matrix = np.arange(9.0).reshape(3, 3)
    for given in (matrix.copy(), np.asfortranarray(matrix), np.repeat(matrix, 2, axis=1)[:, ::2]):
        Loop("mirror", lambda: kernels.mirror, "sources")(given)
        np.testing.assert_array_equal(given, np.tril(matrix) + np.tril(matrix, -1).T)
    assert len(list(folder.iterdir())) == 3


@pytest.mark.parametrize(
    "spoil", [lambda c: c[:40], lambda c: b"", lambda c: c[:-100] + bytes(100)]
)
def test_code_that_is_cut_off_or_damaged_is_not_run(folder, spoil):
    values, out = np.array([0.3, 0.7, 1.9]), np.zeros(3)
    first = Loop("weighted", weighted, "sources")(values, (values, 0.25), 2.0, None, out)
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    file.write_bytes(spoil(whole))
    assert Loop("weighted", weighted, "sources")(values, (values, 0.25), 2.0, None, out) == first
    assert file.read_bytes()[:32] == whole[:32], "not made anew"


def test_code_of_edited_sources_goes(folder):
    values, out = np.array([0.3, 0.7, 1.9]), np.zeros(3)
    for extra in (None, values):
        Loop("weighted", weighted, "sources")(values, (values, 0.25), 2.0, extra, out)
    (folder / "weighted-other.0.0.loop").write_bytes(b"of another loop")
    assert len(list(folder.iterdir())) == 3
    Loop("weighted", weighted, "edited")(values, (values, 0.25), 2.0, None, out)
    assert len(list(folder.iterdir())) == 2


def test_where_nothing_can_be_kept_loops_are_compiled(monkeypatch, tmp_path):
    values, out = np.array([0.3, 0.7, 1.9]), np.zeros(3)
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setattr(machine_code, "_folders", lambda: (tmp_path / "file",))
    answer = Loop("weighted", weighted, "sources")(values, (values, 0.25), 2.0, None, out)
    monkeypatch.setattr(
        machine_code, "_linker", lambda: None
    )  # another numba, whose libraries are not where they were
    monkeypatch.setattr(machine_code, "_folders", lambda: (tmp_path,))
    assert Loop("weighted", weighted, "sources")(values, (values, 0.25), 2.0, None, out) == answer


def _at_once(folder, number, barrier, answers):
    machine_code._folders = lambda: (folder,)
    values, out = np.arange(4.0) + number % 3, np.zeros(4)
    weights = values.astype([np.float64, np.float32, np.int32][number % 3])
    barrier.wait()
    answers.put(
        (number, Loop("weighted", weighted, "sources")(values, (weights, 0.25), 2.0, None, out))
    )


def test_processes_that_compile_at_once_do_not_take_each_others(tmp_path):
    """Linear quads once ran the machine code of triangles, compiled in another process in the same
    moment, and crashed.
    """
    context = multiprocessing.get_context("fork")
    barrier, answers = context.Barrier(PROCESSES), context.Queue()
    workers = [
        context.Process(target=_at_once, args=(tmp_path, n, barrier, answers))
        for n in range(PROCESSES)
    ]
    for worker in workers:
        worker.start()
    got = dict(answers.get(timeout=120) for _ in workers)
    for worker in workers:
        worker.join()
        assert worker.exitcode == 0
    assert len(list(tmp_path.iterdir())) == 3
    for number in range(3):
        values = np.arange(4.0) + number
        assert got[number] == got[number + 3]
        np.testing.assert_allclose(got[number][1], (values**2.5 + 0.25).sum(), rtol=1e-12)


def test_an_edited_law_is_compiled_anew():
    """All loops of a law know its file, and those of a law from elsewhere are kept by nobody."""
    for law in (NEO_HOOKE, LAWS["yeoh"]):
        for loop in (*vars(compiled.loops(law, 9, 9, 3)).values(), compiled.stress_loop(law)):
            assert (
                law.source in loop._sources
                and machine_code.sources(kernels.__file__) in loop._sources
            )
    foreign = type(NEO_HOOKE)(
        "mine", NEO_HOOKE.energy, lambda i1, jac, mu, constants: (mu, 1.0), NEO_HOOKE.tangent
    )
    assert compiled.loops(foreign, 9, 9, 3).commit._sources is None


def test_numba_may_be_imported_after_its_libraries():
    """A law of one's own is compiled in a process whose other loops were linked."""
    code = """if True:
        import sys
        import numpy as np
        from fingerpad.mechanics import compiled
        matrix = np.arange(4.0).reshape(2, 2)
        compiled.mirror(matrix)
        assert "numba" not in sys.modules and matrix[0, 1] == matrix[1, 0] == 2
        from numba import njit
        assert njit(lambda x: np.empty(3).size * x)(2.0) == 6.0
        compiled.mirror(matrix.T)
        assert matrix[0, 1] == 2
        try:
            njit(lambda x: x[[]])(1)
        except Exception as error:
            print(type(error).__name__)
    """
    compiled.mirror(np.eye(2))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout == "TypingError\n", done.stderr


def test_what_a_loop_cannot_take_is_an_error_and_no_crash():
    """Errors are raised through addresses that the linker has been given."""
    code = """if True:
        import sys
        import numpy as np
        from fingerpad.mechanics import compiled
        compiled.mirror(np.eye(2))
        (linked,) = compiled.mirror._ready.values()
        for wrong in (np.zeros(2, np.float32), "words"):
            try:
                linked(wrong)
            except TypeError as error:
                print("refused")
        print("numba" in sys.modules)
    """
    compiled.mirror(np.eye(2))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.split() == ["refused"] * 2 + ["False"], done.stderr
