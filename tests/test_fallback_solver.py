"""Without PARDISO: SuperLU gives the same answers, pressed, stroked with friction, and by the
linear theory.
"""

import os
import subprocess
import sys

import numpy as np
import pytest

from fingerpad import load_scene, simulate
from fingerpad.mechanics import linear_solver
from wrong_scenes import write

pytestmark = pytest.mark.unit

PRESS = {"press_to_force": "20 gf", "rate": "40 gf/s"}
CASES = {
    "pressed": {"motion": [PRESS, {"hold": "0.5 s"}]},
    "small strain": {"motion": [PRESS], "effects": {"finite_strain": "off"}},
    "stroked": {
        "motion": [PRESS, {"slide": "0.5 mm", "speed": "10 mm/s", "keep": "force"}],
        "friction": 0.5,
    },
}


@pytest.mark.parametrize("jump", [1.0, 1e3])
def test_factors_stay_sparse_where_stiffness_jumps(jump, monkeypatch):
    """Of a square of springs, some of them stiffer; mutant: pivots off the diagonal."""
    side, fill, known = 30, [], linear_solver.splu
    corner = np.arange(side**2).reshape(side, side)[:-1, :-1].ravel()
    cells = corner[:, None] + [0, 1, side + 1, side]
    pattern = linear_solver.SymmetricPattern(cells, np.arange(side**2)[:, None])
    stiff = jump ** np.random.default_rng(3).random(side**2)
    spring = 2.1 * np.eye(4) - 0.5
    entries = [(spring * np.sqrt(np.outer(stiff[c], stiff[c])))[np.triu_indices(4)] for c in cells]
    data = pattern.new_data()
    for where, values in zip(pattern.scatter, entries, strict=True):
        np.add.at(data, where, values)

    def counted(*args, **options):
        fill.append(known(*args, **options))
        return fill[-1]

    monkeypatch.setattr(linear_solver, "splu", counted)
    linear_solver.SuperLUCondensation(pattern, np.array([0, 1])).factor(data)
    assert fill[0].nnz < 50 * side**2


def by(name, scene, monkeypatch):
    monkeypatch.setenv("FINGERPAD_LINEAR_SOLVER", name)
    history = simulate(scene)
    assert f'"linear_solver": "{name}"' in history.attrs["cost"]
    return history


@pytest.mark.skipif(not linear_solver.pardiso_available(), reason="PARDISO is not installed here")
@pytest.mark.parametrize("case", CASES)
def test_fallback_gives_the_same_answers(case, tmp_path, monkeypatch):
    stimulus = {"shape": "cylinder", "curvature": "210 1/m"}
    accuracy = {"skin_edge": "0.5 mm", "steps": 8}
    scene = load_scene(write(tmp_path, {"stimulus": stimulus, "accuracy": accuracy, **CASES[case]}))
    found, truth = by("superlu", scene, monkeypatch), by("pardiso", scene, monkeypatch)
    for name in (
        "indentation_depth",
        "force",
        "tangential_force",
        "stored_energy",
        "contact_pressure",
        "strain_energy_density",
    ):
        scale = max(np.abs(truth[name].values).max(), 1e-12)
        # factored in single precision, they end where less than their tolerance is left out of
        # balance, of strokes the larger
        within = 1e-5 if case != "stroked" else 1e-4
        np.testing.assert_allclose(
            found[name].values, truth[name].values, atol=within * scale, rtol=0, err_msg=name
        )
    assert int(found.newton_iterations.sum()) == int(truth.newton_iterations.sum())


def test_fallback_is_taken_where_there_is_no_pardiso(monkeypatch):
    monkeypatch.setattr(linear_solver, "_mkl", lambda: None)
    pattern = linear_solver.SymmetricPattern(np.array([[0, 1, 2]]), np.arange(3)[:, None])
    assert linear_solver.condensation(pattern, np.array([1])).name == "superlu"


_THREADS_OF_MKL = """
import numpy as np
from fingerpad.mechanics.linear_solver import PardisoCondensation, SymmetricPattern
pattern = SymmetricPattern(np.array([[0, 1]]), np.arange(2)[:, None])
solver = PardisoCondensation(pattern, np.array([0]))
print(solver._library.MKL_Get_Max_Threads())
"""


@pytest.mark.skipif(not linear_solver.pardiso_available(), reason="PARDISO is not installed here")
@pytest.mark.parametrize(
    ("given", "taken"), [(None, 1), ("", 1), ("2", 2), ("1,4", 1), ("many", 1)]
)
def test_mkl_takes_the_threads_that_the_process_was_given(given, taken):
    """One unless told otherwise, whatever is set: two threads on one matrix take twice the time."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in ("OMP_NUM_THREADS", "MKL_NUM_THREADS")
    }
    told = kept if given is None else kept | {"OMP_NUM_THREADS": given}
    done = subprocess.run(
        [sys.executable, "-c", _THREADS_OF_MKL], env=told, capture_output=True, text=True
    )
    assert done.stdout.strip() == str(taken), done.stderr
