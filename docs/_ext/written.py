"""Pages written at each build, into docs/generated: gallery, tables, reference of the language,
command line and results.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout, suppress
from pathlib import Path

from PIL import Image
from published import ROOT, verdict

from cysyk1999.figures.registry import FIGURES
from cysyk1999.workflow.schemas import schemas
from fingerpad import cli
from fingerpad.results import COORDINATES, FIELDS, VARIABLES

DOCS = ROOT / "docs"
GENERATED = DOCS / "generated"
WIDE = 640
"""Width (px) of the pictures of the gallery."""


def setup(app):
    app.connect("builder-inited", lambda app: write_all())
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def write_all() -> None:
    """Write all of them anew, leaving alone what is as it was."""
    pages = dict(_pages())
    for path in GENERATED.rglob("*.md"):
        if path.relative_to(GENERATED).as_posix() not in pages:
            path.unlink()
    for name, text in pages.items():
        path = GENERATED / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _pages() -> Iterator[tuple[str, str]]:
    yield from gallery()
    yield from tables()
    yield from language()
    yield "reference/command_line.md", command_line()
    yield "reference/results.md", results()


def _page(*parts: str) -> str:
    return "\n\n".join(part for part in parts if part) + "\n"


# --- gallery and tables ---------------------------------------------------------------------------

GRID = "::::{grid} 1 1 2 2\n:gutter: 3"
CHAPTERS = {
    "chapter3": ("Chapter 3: the model and what it was checked by", "3-"),
    "chapter4": ("Chapter 4: nine surfaces pressed and held", "4-"),
    "chapter5": ("Chapter 5: surfaces stroked and stepped", "5-"),
}


def shown() -> dict[str, dict[str, str]]:
    """docs/gallery.csv: published file without its ending -> what it answers, and the command if it
    is no target.
    """
    with open(DOCS / "gallery.csv", encoding="utf-8", newline="") as file:
        return {row.pop("file"): row for row in csv.DictReader(file)}


def gallery() -> Iterator[tuple[str, str]]:
    """A page a chapter and one of the studies: each picture with its question, verdict, command and
    data.
    """
    known = shown()
    for name, (title, prefix) in CHAPTERS.items():
        numbers = [
            n
            for n in sorted(FIGURES, key=_order)
            if n.startswith(prefix) and _picture(f"thesis/fig_{n}")
        ]
        cards = [
            _card(f"thesis/fig_{n}", f"{n}: {FIGURES[n].title}", known, verdict(n)) for n in numbers
        ]
        yield f"gallery/{name}.md", _page(f"# {title}", GRID, *cards, "::::")
    studies = sorted(
        path.stem
        for path in (ROOT / "figures/studies").iterdir()
        if path.suffix in (".png", ".gif")
    )
    cards = [
        _card(f"studies/{n}", n.replace("_", " ").capitalize(), known, "")
        for n in dict.fromkeys(studies)
    ]
    yield "gallery/studies.md", _page("# Studies", GRID, *cards, "::::")


def _order(number: str) -> list[int]:
    return [int(part) for part in number.split("-")]


def _picture(name: str) -> Path | None:
    return next(
        (
            path
            for path in (ROOT / f"figures/{name}{end}" for end in (".png", ".gif"))
            if path.exists()
        ),
        None,
    )


def _card(name: str, title: str, known: Mapping[str, Mapping[str, str]], judged: str) -> str:
    picture, row = _picture(name), known.get(name, {})
    file, up = picture.relative_to(ROOT).as_posix(), "../../.."
    links = [f"[picture]({up}/{file})"]
    if picture.with_suffix(".csv").exists():
        links.append(f"[its data as CSV]({up}/{file.removesuffix(picture.suffix)}.csv)")
    if judged:
        chapter = name.removeprefix("thesis/fig_")[0]
        links.append(f"[{judged}](../tables/thesis_comparison_chapter{chapter}.md)")
    command = row.get("command") or f".venv/bin/snakemake {file}"
    return "\n".join(
        [
            f":::{{grid-item-card}} {title}",
            f":img-top: {_thumbnail(picture)}",
            f":img-alt: {title}",
            "",
            row.get("question", ""),
            "",
            f"```sh\n{command}\n```",
            "",
            " · ".join(links),
            ":::",
        ]
    )


def _thumbnail(picture: Path) -> str:
    """A small copy of a picture, by its path from a page of the gallery; of a moving one its
    middle.
    """
    small = GENERATED / "gallery" / f"{picture.stem}.png"
    if not small.exists() or small.stat().st_mtime < picture.stat().st_mtime:
        small.parent.mkdir(parents=True, exist_ok=True)
        with Image.open(picture) as whole:
            whole.seek(getattr(whole, "n_frames", 1) // 2)
            image = whole.convert("RGB")
            image.thumbnail((WIDE, 4 * WIDE))
            image.save(small)
    return small.name


def tables() -> Iterator[tuple[str, str]]:
    """A page a published table, and the list of them."""
    known, names, listed = shown(), [], []
    for path in sorted((ROOT / "figures/tables").glob("*.md")):
        name = path.stem
        data = path.with_suffix(".csv").exists()
        chapter = re.fullmatch(r"(.+)_chapter(\d)", name)
        whole = chapter[1] if chapter else name
        title = name.replace("_", " ").capitalize()
        link = (
            f"[The whole of it as CSV](../../../figures/tables/{whole}.csv)"
            if data or chapter
            else ""
        )
        about = known.get(f"tables/{name}", {}).get("question", "")
        text = path.read_text(encoding="utf-8")
        if text.startswith("# "):
            title, text = text[2:].split("\n", 1)
        text = re.sub(r"\]\((\w+\.csv)\)", r"](../../../figures/tables/\1)", text)
        yield f"tables/{name}.md", _page(f"# {title}", about, link, text.strip())
        names.append(name)
        listed.append(f"- [{name.replace('_', ' ')}]({name}.md): {about}".rstrip(": "))
    tree = ["```{toctree}", ":hidden:", "", *names, "```"]
    said = "Each is committed as CSV, units in its columns' names, beside its Markdown."
    yield "tables/index.md", _page("# Tables", said, "\n".join(listed), "\n".join(tree))


# --- the language, from the typed models ----------------------------------------------------------

DOCUMENTS = {
    "scene": (
        "Scene",
        "What is touched, what touches it, how it moves, what is recorded and how well.",
    ),
    "specimen": (
        "Specimen",
        "A pad, in a file that scenes name: `{outline: thesis}` is that of "
        "`config/specimens/thesis.yaml`.",
    ),
    "sweep": ("Sweep", "One scene to thousands."),
    "reconstruction": (
        "Unknowns",
        "What the thesis does not say of its pad, with priors: for `snakemake reconstruction`.",
    ),
    "spheres": (
        "Sizes of a dome",
        "What `snakemake spheres` fits: lowest, first and highest value of each, in mm.",
    ),
    "workflow": (
        "Configuration",
        "What the workflow simulates, draws and tabulates, and where it puts it.",
    ),
}


def language() -> Iterator[tuple[str, str]]:
    """A page a kind of YAML file, from the schemas that are made of the typed models."""
    made, said = schemas(), set()
    for kind in sorted(
        made, key=lambda kind: kind != "scene"
    ):  # what several kinds have is said where it is of a scene
        schema, (title, about) = made[kind], DOCUMENTS[kind]
        example = {
            "scene": "scenes/examples/every_key",
            "specimen": "specimens/thesis",
            "sweep": "sweeps/example",
        }
        example |= {"reconstruction": "reconstruction/unknowns", "spheres": "spheres/dome"}
        whole = f"../../../config/{example.get(kind, 'thesis')}.yaml"
        parts = [f"# {title}", about, _section(schema)]
        for name, part in schema.get("$defs", {}).items():
            if "properties" in part and name not in said:
                said.add(name)
                parts += [
                    f"(keys-{_slug(name)})=\n## {_words(name)}",
                    _prose(part.get("description", "")),
                ]
                parts += [_section(part)]
        parts += ["## A whole file", f"```{{literalinclude}} {whole}\n:language: yaml\n```"]
        yield f"reference/{kind}.md", _page(*parts)


def _slug(name: str) -> str:
    return re.sub(r"\W+", "-", name).strip("-").lower()


def _words(name: str) -> str:
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).capitalize()


def _prose(text: str) -> str:
    return text.replace("\n", " ").replace("|", "\\|").replace("{", "&#123;").replace("}", "&#125;")


def _section(schema: Mapping) -> str:
    lines = ["| key | takes | left out | meaning |", "|---|---|---|---|"]
    required = set(schema.get("required", ()))
    for key, part in schema["properties"].items():
        left_out = "must be there" if key in required else _default(part)
        takes = _takes(part) or "a mapping"
        lines.append(f"| `{key}` | {takes} | {left_out} | {_prose(part.get('description', ''))} |")
    return "\n".join(lines)


def _default(part: Mapping) -> str:
    if part.get("default") in (None, {}, []):
        return ""
    return f"`{json.dumps(part['default'], ensure_ascii=False)}`".replace("|", "\\|")


def _takes(part: Mapping) -> str:
    """What a key takes, in words; a part of its own by its name, linked."""
    if "$ref" in part:
        name = part["$ref"].rsplit("/", 1)[1]
        return f"[{_words(name).lower()}](#keys-{_slug(name)})"
    for many in ("anyOf", "oneOf"):
        if many in part:
            said = dict.fromkeys(word for each in part[many] for word in _takes(each).split(" or "))
            return " or ".join(filter(None, said))
    if "const" in part:
        return f"`{part['const']}`"
    if "enum" in part:
        return " or ".join(f"`{value}`" for value in part["enum"])
    kind = part.get("type")
    if kind == "array":
        inner = _takes(part.get("items", {}))
        return f"a list of {inner}" if inner else "a list"
    if kind == "string":
        if examples := part.get("examples"):
            return f"text such as `{examples[0]}`"
        return (
            "" if part.get("pattern", "").startswith("^\\s*[+-]?[0-9.]") else "text"
        )  # numbers may be written as text
    if kind in ("number", "integer"):
        return ("a whole number" if kind == "integer" else "a number") + _bounds(part)
    if kind == "boolean":
        return "`true` or `false`"
    return {"null": "", "object": "a mapping"}.get(kind, "")


def _bounds(part: Mapping) -> str:
    words = {
        "minimum": "from",
        "exclusiveMinimum": "above",
        "maximum": "to",
        "exclusiveMaximum": "below",
    }
    said = " and".join(f" {word} {part[key]:,g}" for key, word in words.items() if key in part)
    return (
        said.replace(" and to", " to") if "maximum" in part else said.replace("from", "of at least")
    )


# --- command line and results ---------------------------------------------------------------------


def command_line() -> str:
    """What `fingerpad` and its commands say of themselves."""
    parts = ["# Command line", cli.__doc__.split("\n\n")[1].replace("\n", " ")]
    for name in re.findall(r"^    (\w+)  ", _help(), re.M):
        parts += [f"## fingerpad {name}", f"```text\n{_help(name)}\n```"]
    return _page(*parts)


def _help(*words: str) -> str:
    """What a command prints when asked for help."""
    text = io.StringIO()
    with redirect_stdout(text), suppress(SystemExit):
        cli.main([*words, "--help"])
    return text.getvalue().strip()


def results() -> str:
    """What a history holds, from the table by which it is written."""

    def rows(entries) -> str:
        return "\n".join(
            [
                "| name | unit | |",
                "|---|---|---|",
                *(f"| `{n}` | {u} | {said} |" for n, u, said in entries),
            ]
        )

    described = rows(
        (name, unit, f"{said} ({', '.join(dims)})")
        for name, (dims, unit, said) in VARIABLES.items()
    )
    placed = rows((name, unit, said) for name, (_, unit, said) in COORDINATES.items())
    fields = rows((name, unit, said) for name, (_, unit, _, said) in FIELDS.items())
    return _page(
        "# Results",
        "A run leaves `history.nc` (everything over time, with plan, scene, cost and provenance in "
        "its attributes), `summary.json` (how each leg ended) and `plan.json`. SI inside; units "
        "stand in every attribute and column name.",
        "## Variables of a history",
        described,
        "## Coordinates",
        placed,
        "## Fields, at snapshots",
        "Displacement and mean stress, and:",
        fields,
    )
