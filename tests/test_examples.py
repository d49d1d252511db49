"""Every example scene runs from the command line, coarsely."""

import doctest
import json
import re
from importlib import import_module

import pytest

import fingerpad
from fingerpad import HOMES
from fingerpad.cli import main
from test_scene import CONFIG

REFERENCE = CONFIG.parent / "docs/reference/python.rst"
EXAMPLES = sorted((CONFIG / "scenes" / "examples").glob("*.yaml"))


PUBLIC = sorted({*HOMES.values(), "fingerpad.provenance"})
"""Modules of what ``fingerpad`` offers."""


@pytest.mark.unit
@pytest.mark.parametrize("name", PUBLIC)
def test_examples_of_docstrings_are_true(name):
    assert doctest.testmod(import_module(name)).failed == 0


@pytest.mark.unit
def test_examples_of_the_reference_are_true():
    flags = doctest.ELLIPSIS
    assert doctest.testfile(str(REFERENCE), module_relative=False, optionflags=flags).failed == 0


@pytest.mark.unit
def test_every_public_name_has_an_example():
    """In its docstring, or on the page of the reference."""
    lines = re.findall(r"^(?:>>>|\.\.\.) (.*)$", REFERENCE.read_text(encoding="utf-8"), re.M)
    for name in fingerpad.__all__:
        own = ">>> " in (getattr(fingerpad, name).__doc__ or "")
        assert own or re.search(rf"fingerpad\.{name}\b", "\n".join(lines)), name


@pytest.mark.unit
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path, tmp_path, capsys):
    """Exit code 0, a depth for every leg, and a closing line."""
    assert main(["run", str(path), "--accuracy", "draft", "--out", str(tmp_path / "out")]) == 0, (
        capsys.readouterr().err
    )
    legs = json.loads((tmp_path / "out" / "summary.json").read_text())["legs"]
    depths = [leg["depth_mm"] for leg in legs]
    assert depths[0] > 0.1 and all(0 <= depth < 3 for depth in depths)  # the last may let go
    assert capsys.readouterr().out.startswith("depth ")
