"""One way, enforced: the import contracts of pyproject.toml, and scripts that stay thin."""

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
    graph = grimp.build_graph("fingerpad", exclude_type_checking_imports=False, cache_dir=None)
    TopologicalSorter(
        {m: graph.find_modules_directly_imported_by(m) for m in graph.modules}
    ).prepare()  # CycleError names them


@pytest.mark.parametrize(
    "script", sorted((ROOT / "workflow" / "scripts").iterdir()), ids=lambda path: path.name
)
def test_scripts_are_thin(script):
    assert len(script.read_text().splitlines()) < 40
