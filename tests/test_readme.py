"""What the README shows works as shown."""

import re
from pathlib import Path

import matplotlib
import pytest

from fingerpad.cli import main

pytestmark = pytest.mark.unit

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def block(language, first=""):
    (text,) = re.findall(rf"```{language}\n({re.escape(first)}.*?)```", README, re.S)
    return text


def test_the_scene_and_the_three_verbs(tmp_path, monkeypatch, capsys):
    """The README's scene, run by the README's Python lines, gives its frozen depth and width."""
    matplotlib.use("Agg")
    (tmp_path / "my_scene.yaml").write_text(block("yaml", "# my_scene.yaml"), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(block("python"), names)
    printed = capsys.readouterr().out
    assert "small strain would be wrong by" in printed
    assert re.search(r"depth 0\.7\d mm, width 1\.[34]\d mm", printed), printed
    assert names["history"].sizes["snapshot"] == 1
    assert float(names["history"].indentation_depth[-1]) * 1e3 == pytest.approx(FROZEN_DEPTH_MM, rel=1e-4)


FROZEN_DEPTH_MM = 0.747176


def test_the_sweep_is_one_of_the_scene(tmp_path, capsys):
    """The README's sweep of the README's scene is planned: eight curvatures, four forces."""
    for name in ("my_scene.yaml", "my_sweep.yaml"):
        (tmp_path / name).write_text(block("yaml", f"# {name}"), encoding="utf-8")
    assert main(["plan", str(tmp_path / "my_sweep.yaml")]) == 0
    assert "32 scenes" in capsys.readouterr().out


def test_files_that_are_named_exist():
    """Every path of the repository that the README names is there."""
    root = Path(__file__).parents[1]
    named = set(re.findall(r"(?:config|figures|tests|workflow)/[\w./-]+\w", README))
    missing = [name for name in named if not list(root.glob(name + "*"))]
    assert not missing, missing


def test_commands_that_are_named_exist():
    """Every make target of the README is in the Makefile."""
    makefile = (Path(__file__).parents[1] / "Makefile").read_text(encoding="utf-8")
    for target in set(re.findall(r"\bmake ([a-z][\w-]+)", README)):
        assert re.search(rf"^{target}:", makefile, re.M), target
