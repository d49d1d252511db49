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
LONG = {"own_force"}


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
    assert cells(page) and any(tmp_path.iterdir())
    plt.close("all")


def test_the_numbers_of_the_pages_are_those_of_the_tables(extension):
    published = extension("published")
    known = published.numbers()
    assert all(re.search(r"\w", text) and "nan" not in text for text in known.values())
    for page in published.pages():
        text = page.read_text(encoding="utf-8")
        assert text == published.filled(text, known), (
            f"{page.relative_to(ROOT)}: run .venv/bin/python docs/_ext/published.py"
        )
        assert "{{ " not in text and text.count("<!-- / -->") == len(published.MARKED.findall(text))
        assert not re.search(r"^<!-- \w+ -->[^\n]", text, re.M), (
            "a line that begins with a comment is no Markdown"
        )


def test_a_page_is_filled_in_lines_and_in_blocks(extension):
    filled, known = extension("published").filled, {"one": "1.5", "rows": "| a |\n|---|"}
    text = "of <!-- one -->2<!-- / --> mm\n\n<!-- rows -->\nold\n<!-- / -->\n"
    new = "of <!-- one -->1.5<!-- / --> mm\n\n<!-- rows -->\n| a |\n|---|\n<!-- / -->\n"
    assert filled(text, known) == new == filled(new, known)
    with pytest.raises(KeyError):
        filled("<!-- two --><!-- / -->", known)


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
