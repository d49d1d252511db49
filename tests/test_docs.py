"""The documentation without building it: tutorials run, numbers are there, links lead somewhere,
figures have questions.
"""

import importlib
import pkgutil
import re
import shlex
import subprocess
import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest

from cysyk1999.figures.registry import FIGURES
from fingerpad.cli import main

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if not {"_build", "generated"} & set(path.parts))
TUTORIALS = [path for path in PAGES if "{code-cell}" in path.read_text(encoding="utf-8")]
LONG = {"data"}


@pytest.fixture
def extension(monkeypatch):
    """A module of docs/_ext."""
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    return importlib.import_module


def cells(path):
    return re.findall(r"```\{code-cell\}\n(.*?)```", path.read_text(encoding="utf-8"), re.S)


def run(cell, names):
    """Do what the notebook's kernel would do with a cell."""
    first, _, rest = cell.partition("\n")
    if first.startswith("%%writefile "):
        Path(first.split()[1]).write_text(rest, encoding="utf-8")
    elif first == "%%bash":
        for line in rest.splitlines():
            words = shlex.split(line)
            if words[0] == "fingerpad" and not {"|", "||", ">"} & set(words):
                assert main(words[1:]) == 0, line
            else:
                subprocess.run(["bash", "-eo", "pipefail", "-c", line], check=True)
    else:
        exec(compile(cell, "cell", "exec"), names)


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] * (p.stem in LONG)) for p in TUTORIALS],
)
def test_tutorials_run(page, tmp_path, monkeypatch):
    """Every cell of a page, in order, in an empty folder."""
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("FINGERPAD", str(ROOT))
    monkeypatch.setenv("PATH", str(Path(sys.executable).parent), prepend=":")
    names = {}
    for cell in cells(page):
        run(cell, names)
    assert cells(page)
    plt.close("all")


def test_the_numbers_of_the_pages_are_those_of_the_tables(extension):
    published = extension("published")
    known, pages = published.numbers(), published.pages()
    assert all(re.search(r"\w", text) and "nan" not in text for text in known.values())
    for page, words in pages.items():
        text = page.read_text(encoding="utf-8")
        assert text == published.filled(text, words, known), (
            f"{page.relative_to(ROOT)}: run .venv/bin/python docs/_ext/published.py"
        )
    used = re.findall(r"\{(\w+)\}", " ".join(sum(pages.values(), [])))
    assert set(known) == set(used), set(known) ^ set(used)


def test_a_number_that_is_raised_by_one_is_found_on_every_page(extension):
    """Each published number in turn, wherever a page says it: the mutant is not the page."""
    published = extension("published")
    known, tried = published.numbers(), 0
    for page, every in published.pages().items():
        text = page.read_text(encoding="utf-8")
        for words in every:
            for span, _ in published.places(text, words, known):
                raised = re.sub(r"\d+(?=\D*$)", lambda n: str(int(n[0]) + 1), text[span])
                if raised != text[span]:
                    mutant = text[: span.start] + raised + text[span.stop :]
                    assert published.filled(mutant, [words], known) == text, words
                    tried += 1
    assert tried > 50


def test_a_page_is_filled_in_lines_and_in_tables(extension):
    filled, known = extension("published").filled, {"one": "1.5", "rows": "| a |\n|---|\n| 3 |"}
    text = "of 2\nmm\n\n| a |\n|---|\n| 2 |\n| 1 |\n\nend\n"
    new = "of 1.5\nmm\n\n| a |\n|---|\n| 3 |\n\nend\n"
    words = ["of {one} mm", "{rows}"]
    assert filled(text, words, known) == new == filled(new, words, known)
    with pytest.raises(KeyError):
        filled(text, ["of {two} mm"], known)
    with pytest.raises(LookupError, match="0 times"):
        filled(text, ["of {one} kPa"], known)


def test_pages_hold_no_marks():
    for page in [ROOT / "README.md", ROOT / "workflow/profiles/slurm/README.md", *PAGES]:
        text = page.read_text(encoding="utf-8")
        assert "<!--" not in text and not re.search(r"\{\{\w+\}\}", text), page


def test_numbers_read_well(extension):
    digits = extension("published").digits
    assert [digits(v) for v in (0.4982, 8.789, 136.2, 11572, 3.6e-6)] == [
        "0.5",
        "8.8",
        "140",
        "12,000",
        "3.6 x 10^-6",
    ]
    assert digits([1.467, 1.77]) == "1.5 to 1.8" and digits([1.0, 1.01]) == "1"


def test_links_lead_to_files():
    """Relative links of pages that are written by hand; those to generated pages are checked when
    they are built.
    """
    for page in PAGES:
        for target in re.findall(
            r"(?:\]\(|```\{(?:image|literalinclude|include)\} )([^)#\s]+)",
            page.read_text(encoding="utf-8"),
        ):
            if "generated/" not in target and "://" not in target:
                assert (page.parent / target).exists(), f"{page.relative_to(ROOT)}: {target}"


def test_the_code_that_pages_refer_to_is_there_and_in_the_reference():
    documented = "".join(
        path.read_text(encoding="utf-8") for path in (DOCS / "reference").glob("*.rst")
    )
    for page in PAGES:
        for role, name in re.findall(r"\{py:(\w+)\}`([\w.]+)`", page.read_text(encoding="utf-8")):
            assert pkgutil.resolve_name(name) is not None
            module = name if role == "mod" else name.rpartition(".")[0]
            assert re.search(rf"(automodule:: {module}|auto\w+:: {name})$", documented, re.M), (
                f"{page.name}: {name}"
            )


def test_every_figure_has_a_question_and_every_question_a_file(extension):
    known = set(extension("written").shown())
    assert {f"thesis/fig_{number}" for number in FIGURES} <= known
    there = {
        path.relative_to(ROOT / "figures").with_suffix("").as_posix()
        for path in (ROOT / "figures").rglob("*.*")
    }
    assert known <= there, known - there


def test_the_gallery_shows_every_published_picture(extension):
    pages = "".join(text for _, text in extension("written").gallery())
    for picture in (
        path for path in (ROOT / "figures").rglob("*") if path.suffix in (".png", ".gif")
    ):
        assert f"[picture](../../../{picture.relative_to(ROOT).as_posix()})" in pages, picture


def test_the_reference_has_every_key_of_a_scene(extension):
    """Keys of the commented example are keys of the page that is made of the typed models."""
    page = dict(extension("written").language())["reference/scene.md"]
    for key in (
        "curvature",
        "press_to_force",
        "keep",
        "offsets",
        "skin_edge",
        "contact_length",
        "prony",
        "pitch",
        "extends",
    ):
        assert f"| `{key}` |" in page, key
    assert "| `shape` | `cylinder` |" in page and "a length" not in page


def test_parts_of_the_language_are_described_once_and_every_written_page_is_in_a_menu(extension):
    written = extension("written")
    pages = dict(written._pages())
    text = "".join(pages.values())
    labels = re.findall(r"^\((keys-[\w-]+)\)=", text, re.M)
    assert len(labels) == len(set(labels)) > 30
    assert set(re.findall(r"\(#(keys-[\w-]+)\)", text)) <= set(labels)
    menu = (DOCS / "index.md").read_text(encoding="utf-8").split() + pages[
        "tables/index.md"
    ].split()
    for name in pages:
        assert f"generated/{name[:-3]}" in menu or name.removeprefix("tables/")[:-3] in menu, name


def test_the_documentation_is_locked_to_what_the_workflow_is_locked_to():
    """Into the same environment: it may add packages, and move none."""

    def pins(path):
        return {
            match[0]
            for match in re.finditer(r"^[\w.-]+==[^ ;\\]+", path.read_text(encoding="utf-8"), re.M)
        }

    workflow = pins(ROOT / "requirements.lock")
    names = {pin.split("==")[0] for pin in workflow}
    assert (
        not {pin for pin in pins(DOCS / "requirements.lock") if pin.split("==")[0] in names}
        - workflow
    )


def test_docstrings_are_mended(extension):
    lines = [
        "Sum |x|, ``|y|``.",
        "",
        "Args:",
        "    a: first of",
        "    the two. b: the other.",
        "    c: third.",
        "",
        "Code::",
        "",
        "    |z|",
    ]
    extension("docstrings").tidy(lines)
    assert (
        lines[0] == r"Sum \|x\|, ``|y|``."
        and lines[4] == "        the two. b: the other."
        and lines[-1] == "    |z|"
    )
