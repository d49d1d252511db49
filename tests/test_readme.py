"""What README, citation and tutorials show works as shown: every block is run."""

import json
import re
import shlex
import sys
from pathlib import Path

import matplotlib
import pytest
import yaml

from fingerpad.cli import _parser, main

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```(\w+)\n(.*?)```", README, re.S)
FROZEN_DEPTH_MM = 1.124395


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """The README from top to bottom, in one folder: what was run, and the command line's last
    words.
    """
    matplotlib.use("Agg")
    folder, patch = tmp_path_factory.mktemp("readme"), pytest.MonkeyPatch()
    said, names, makes, cited = [], {}, [], []

    def command(line):
        words = shlex.split(line, comments=True)
        if words[0] == "make":
            makes.append(words[1])
        elif words[1] == "sweep":  # two hundred scenes are planned and no more
            options = _parser().parse_args(words[1:])
            assert main(["plan", str(options.sweep)]) == 0
        else:
            assert main(words[1:]) == 0
            said.append(words[1:])

    run = {
        "yaml": lambda text: Path(re.match(r"# (\S+)", text)[1]).write_text(text, encoding="utf-8"),
        "sh": lambda text: [command(line) for line in text.splitlines()],
        "python": lambda text: exec(text, names),
        "text": lambda text: said.append(text),
        "bibtex": cited.append,
    }
    with patch.context() as here, pytest.MonkeyPatch.context() as quiet:
        here.chdir(folder)
        quiet.setattr(sys, "argv", ["fingerpad"])
        for language, text in BLOCKS:
            run[language](text)  # KeyError: a block of another language is run by nobody
    return {"folder": folder, "names": names, "makes": makes, "cited": cited, "said": said}


def test_the_scene_gives_its_frozen_depth_and_its_picture(ran):
    history = ran["names"]["history"]
    assert float(history.indentation_depth[-1]) * 1e3 == pytest.approx(FROZEN_DEPTH_MM, rel=1e-4)
    assert (ran["folder"] / "first_scene.png").stat().st_size > 20_000 and (
        ROOT / "docs/_static/first_scene.png"
    ).exists()
    legs = json.loads((ran["folder"] / "result/summary.json").read_text())["legs"]
    assert legs[-1]["depth_mm"] == pytest.approx(FROZEN_DEPTH_MM, rel=1e-4)


def test_the_line_shown_is_the_line_printed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (scene,) = (text for language, text in BLOCKS if language == "yaml" and "# my_scene" in text)
    (shown,) = (text for language, text in BLOCKS if language == "text")
    Path("my_scene.yaml").write_text(scene, encoding="utf-8")
    assert main(["run", "my_scene.yaml", "--out", "result"]) == 0
    printed = capsys.readouterr().out
    numbers = [
        re.findall(r"(?:depth|force|contact|about) ([\d.]+)", text) for text in (shown, printed)
    ]
    assert len(numbers[0]) == 4
    assert [float(n) for n in numbers[0]] == pytest.approx(
        [float(n) for n in numbers[1]], rel=0.02
    ), printed


def test_there_are_two_hundred(tmp_path, capsys):
    for language, text in BLOCKS:
        if language == "yaml":
            (tmp_path / re.match(r"# (\S+)", text)[1]).write_text(text, encoding="utf-8")
    assert main(["plan", str(tmp_path / "my_sweep.yaml")]) == 0
    assert "200 scenes" in capsys.readouterr().out


def test_it_is_at_most_ninety_lines():
    assert len(README.splitlines()) <= 90


def test_files_that_are_named_exist():
    """Every path of the repository that the README names is there."""
    named = set(re.findall(r"(?:config|docs|figures|tests|workflow)/[\w./-]+\w", README))
    missing = [name for name in named if not list(ROOT.glob(name + "*"))]
    assert named and not missing, missing


def test_commands_that_are_named_exist(ran):
    """Every make target of the README is in the Makefile."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in {*ran["makes"], *re.findall(r"`make ([a-z][\w-]+)", README)}:
        assert re.search(rf"^{target}:", makefile, re.M), target


def test_its_verdicts_are_read_from_the_tables():
    """What they say is compared by tests/test_docs.py, as of every page."""
    held = yaml.safe_load((ROOT / "docs/numbers.yaml").read_text(encoding="utf-8"))["pages"]
    for name in (
        "hard_cases_well",
        "unseen_well",
        "hard_cases",
        "ranges_held_out",
        "axes_held_out",
        "trends_held_out",
        "beliefs_covered",
    ):
        assert f"{{{name}}}" in " ".join(held["README.md"]), name


def test_the_citation_is_the_same_for_people_machines_and_zenodo(ran):
    cff = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    for key in ("title", "version", "license", "keywords"):
        assert zenodo[key] == cff[key], key
    assert [each["name"] for each in zenodo["creators"]] == [
        each["name"] for each in cff["authors"]
    ]
    assert zenodo["description"] == cff["abstract"].strip()
    (thesis,) = cff["references"]
    (cited,), (listed,) = ran["cited"], zenodo["references"]
    for word in (thesis["title"], str(thesis["year"]), thesis["authors"][0]["family-names"]):
        assert word in cited and word in listed
    assert cff["title"] in cited and cff["version"] in cited and cff["authors"][0]["name"] in cited
    assert f'version = "{cff["version"]}"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")
