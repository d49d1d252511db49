"""The sources a rule rests on are found from the imports, and only those."""

import pytest

from fingerpad import provenance
from fingerpad.provenance import digest, imported_sources

pytestmark = pytest.mark.unit


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """A function that writes a package `toy` of {path: text} and gives the closure of a script as
    names.
    """
    package = tmp_path / "toy"
    monkeypatch.setattr(provenance, "PACKAGE", package)

    def closure(script: str, **files: str) -> set[str]:
        for name, text in {"__init__": "", **files}.items():
            path = package.joinpath(*name.split("__SLASH__")).with_suffix(".py")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        entry = tmp_path / "script.py"
        entry.write_text(script)
        return {path.relative_to(tmp_path).as_posix() for path in imported_sources(entry)} - {
            "script.py"
        }

    return closure


def test_follows_imports_direct_indirect_relative_and_inside_functions(toy):
    found = toy(
        "import numpy\nfrom toy.a import f",
        a="from . import b\n\ndef f():\n    import toy.c",
        b="from .d import x",
        c="",
        d="x = 1",
        unused="",
    )
    assert found == {f"toy/{name}.py" for name in ("__init__", "a", "b", "c", "d")}


def test_leaves_out_imports_for_type_checking(toy):
    found = toy(
        "import toy.a",
        a="from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import toy.b",
        b="",
    )
    assert found == {"toy/__init__.py", "toy/a.py"}


def test_a_package_passed_through_counts_for_what_importing_it_executes(toy):
    init = "import toy.early\n\ndef verb():\n    import toy.late"
    found = toy("import toy.a", __init__=init, a="", early="", late="")
    assert found == {"toy/__init__.py", "toy/a.py", "toy/early.py"}


def test_follows_lazy_attributes_that_are_written_down(toy):
    init = '_HOME = {"verb": "toy.a", "other": "toy.b"}\n\ndef __getattr__(name): ...'
    assert toy("from toy import verb", __init__=init, a="", b="") == {"toy/__init__.py", "toy/a.py"}


def test_refuses_lazy_attributes_it_cannot_follow(toy):
    with pytest.raises(ImportError, match="cannot follow the lazy attribute 'verb'"):
        toy("from toy import verb", __init__="def __getattr__(name): ...")


def test_names_a_module_that_does_not_exist(toy):
    with pytest.raises(ModuleNotFoundError, match=r"toy\.gone"):
        toy("import toy.gone")


def test_figures_do_not_rest_on_the_mechanics():
    names = {
        path.relative_to(provenance.PACKAGE).as_posix()
        for path in imported_sources("cysyk1999.figures.registry")
    }
    assert "figures/registry.py" in names and "receptors/laws.py" in names
    assert not [
        name
        for name in names
        if name.startswith(("mechanics/", "planning/plan.py", "receptors/material_points.py"))
    ]


def test_digest_follows_content_not_time_or_order(tmp_path):
    first, second = tmp_path / "a.py", tmp_path / "b.py"
    first.write_text("1")
    second.write_text("2")
    before = digest([first, second])
    first.touch()
    assert digest([second, first]) == before
    second.write_text("3")
    assert digest([first, second]) != before


def test_what_was_followed_is_kept_until_a_file_changes(toy, tmp_path, monkeypatch):
    """From the user's cache nothing is followed; an edited, a new and a removed file are
    noticed.
    """
    monkeypatch.setattr(provenance, "cache_folder", lambda name: tmp_path)
    files = {"a": "from . import b", "b": "", "c": ""}
    first = toy("import toy.a", **files)
    entry = tmp_path / "script.py"
    monkeypatch.setattr(provenance, "_followed", lambda entries: 1 / 0)
    assert {path.name for path in imported_sources(entry)} == {
        "script.py",
        *(name.rpartition("/")[2] for name in first),
    }
    (tmp_path / "toy" / "b.py").write_text("import toy.c")
    with pytest.raises(ZeroDivisionError):
        imported_sources(entry)
