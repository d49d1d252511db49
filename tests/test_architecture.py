"""One way, enforced: the import contracts of pyproject.toml, and scripts that stay thin."""

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import pytest
from importlinter.cli import EXIT_STATUS_SUCCESS, lint_imports

pytestmark = pytest.mark.unit

ROOT = Path(__file__).resolve().parents[1]


def test_import_contracts_are_kept(monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    status = lint_imports(config_filename="pyproject.toml", no_cache=True)
    assert status == EXIT_STATUS_SUCCESS, capsys.readouterr().out


def test_no_modules_import_each_other_in_a_circle():
    """Imports within functions and for types count too."""
    both = ("fingerpad", "cysyk1999")
    graph = grimp.build_graph(*both, exclude_type_checking_imports=False, cache_dir=None)
    TopologicalSorter(
        {m: graph.find_modules_directly_imported_by(m) for m in graph.modules}
    ).prepare()  # CycleError names them


def test_types_of_public_modules_are_right(tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr


SOURCES = sorted((ROOT / "src").rglob("*.py"))


def imported(path: Path) -> set[str]:
    """Dotted names that a file imports, `from` names included."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def test_no_private_name_of_a_library_is_imported():
    private = {
        f"{path.name}: {name}"
        for path in SOURCES
        for name in imported(path)
        if not name.startswith(("__future__", "fingerpad", "cysyk1999"))
        and any(part.startswith("_") for part in name.split("."))
    }
    assert not private


def test_one_binding_through_ctypes_and_nothing_pickled_but_between_processes():
    found = {name: set() for name in ("ctypes", "pickle", "marshal")}
    for path in SOURCES:
        for name in found.keys() & {name.split(".")[0] for name in imported(path)}:
            found[name].add(path.name)
    assert found == {"ctypes": {"linear_solver.py"}, "pickle": {"gmsh_worker.py"}, "marshal": set()}


@pytest.mark.parametrize(
    "script", sorted((ROOT / "workflow" / "scripts").glob("*.py")), ids=lambda path: path.name
)
def test_scripts_are_thin(script):
    assert len(script.read_text().splitlines()) < 50
