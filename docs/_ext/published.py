"""What the pages say of the published tables and of the pad: every such number is read here, and
none is typed into a page.

``<!-- name -->text<!-- / -->`` in a page holds ``numbers()["name"]``, and reads as the text alone
wherever Markdown is shown. What a name stands for is a line of docs/numbers.yaml; tables and
sentences are functions below. ``python docs/_ext/published.py`` writes the present
numbers into the pages; so does each build of the documentation.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from cysyk1999.claims.comparison import AGREES, holding
from fingerpad import load_scene

ROOT = Path(__file__).parents[2]
MARKED = re.compile(r"<!-- (\w+) -->(.*?)<!-- / -->", re.S)
_NUMBERS: dict[str, Callable[[], object]] = {}


@cache
def table(name: str) -> pd.DataFrame:
    """A published CSV file of figures/tables, or one by its path in figures/ without the ending."""
    path = name if "/" in name else f"tables/{name}"
    return pd.read_csv(ROOT / f"figures/{path}.csv")


@cache
def compared() -> pd.DataFrame:
    """Rows of the comparison that have been judged: their `kind` in the thesis, whether it
    `agrees`.
    """
    forms = pd.read_csv(ROOT / "config/reference/thesis_numbers.csv").set_index("id")["form"]
    rows = table("thesis_comparison").join(forms, on="id")
    kind = rows["form"].map({"axis": "axis", "trend": "trend"}).fillna("range")
    rows = rows.assign(kind=kind, agrees=rows["verdict"].isin(AGREES))
    return rows[rows["verdict"] != "not_comparable"]


@cache
def outcomes() -> pd.DataFrame:
    """How every hard case ended, by the method."""
    rows = table("studies/stability").drop_duplicates(["case", "method"])
    return rows.assign(outcome=rows["outcome"].str.split(":").str[0])


@cache
def pad() -> pd.DataFrame:
    """One row: the sizes (m), moduli (Pa) and ridges of the pad that scenes have by default."""
    scene = {
        "specimen": {"ridges": "inner"},
        "stimulus": {"shape": "flat"},
        "motion": [{"press_to_force": "20 gf"}],
    }
    specimen = load_scene(scene).specimen
    parts = {part: dict(getattr(specimen.layers, part)) for part in ("epidermis", "dermis", "fat")}
    layers = {f"{part}_{key}": value for part, of in parts.items() for key, value in of.items()}
    whole = {"contact_length": specimen.contact_length, "moduli": specimen.moduli}
    return pd.DataFrame([dict(specimen.outline) | dict(specimen.ridges.inner) | layers | whole])


PREPARED = {"pad": pad, "compared": compared, "outcomes": outcomes}
"""Tables that are made of the published ones."""


def read(address: str) -> str:
    """A number as text by its address, ``table | rows | what is shown`` (docs/numbers.yaml)."""
    name, query, shown = (part.strip() for part in address.split("|", 2))
    rows = PREPARED[name]() if name in PREPARED else table(name)
    if query:
        rows = rows.query(query, engine="python")
    # a column that has the name of a function gets a line under it
    columns = {f"{c}_" if c in SHOWN else c: rows[c] for c in rows}
    return str(eval(shown, {**columns, **SHOWN, "rows": rows}))


def numbers() -> dict[str, str]:
    """All of them, as text."""
    addresses = yaml.safe_load((ROOT / "docs/numbers.yaml").read_text(encoding="utf-8"))
    texts = {name: read(address) for name, address in addresses.items()}
    return texts | {name: str(made()) for name, made in _NUMBERS.items()}


def pages() -> list[Path]:
    """The pages that are written by hand."""
    ours = (
        path
        for path in (ROOT / "docs").rglob("*.md")
        if not {"_build", "generated"} & set(path.parts)
    )
    return [ROOT / "README.md", ROOT / "workflow/profiles/slurm/README.md", *sorted(ours)]


def filled(text: str, known: dict[str, str]) -> str:
    """A page with the present numbers. Raises KeyError for a name that is not known."""

    def fill(mark: re.Match) -> str:
        name = mark[1]
        lines = "\n" * ("\n" in known[name])  # a table has lines of its own
        return f"<!-- {name} -->{lines}{known[name]}{lines}<!-- / -->"

    return MARKED.sub(fill, text)


def fill_pages() -> None:
    """Write the present numbers into the pages that say others."""
    known = numbers()
    for page in pages():
        text = page.read_text(encoding="utf-8")
        if (new := filled(text, known)) != text:
            page.write_text(new, encoding="utf-8")


def number(read: Callable[[], object]) -> Callable[[], object]:
    """Enter a number under the name of the function that reads it."""
    _NUMBERS[read.__name__] = read
    return read


# --- how numbers are shown ------------------------------------------------------------------------


def digits(values: object, count: int = 2) -> str:
    """A number to so many significant digits, without an exponent where that reads better; of
    several the least and the most, or one of them if they read the same.
    """
    texts = []
    for value in (np.min(values), np.max(values)):
        text = f"{value:.{count}g}"
        plain = f"{float(text):,.0f}" if "e+" in text else re.sub(r"e-0?(\d+)", r" x 10^-\1", text)
        texts.append(plain)
    return " to ".join(dict.fromkeys(texts))


def share(holds: pd.Series) -> str:
    """How many of some hold, and of how many."""
    return f"{holds.sum()} of {len(holds)}"


def within(rows: pd.DataFrame, form: str, value: str, low: str, high: str, unit: str = "") -> str:
    """A value of the first row with its unit and the ends of its range, by the names of their
    columns.
    """
    middle, least, most = (format(rows[column].iloc[0], form) for column in (value, low, high))
    return f"{' '.join(filter(None, (middle, unit)))} ({least} to {most})"


def duration(seconds: float) -> str:
    """To two digits, in the unit that suits."""
    unit, size = next(
        (u, s) for u, s in (("h", 3600.0), ("min", 60.0), ("s", 0.0)) if seconds >= 1.5 * s
    )
    return f"{digits(seconds / (size or 1.0))} {unit}"


def mm(length: pd.Series) -> str:
    return f"{1e3 * length.item():.3g} mm"


SHOWN = {each.__name__: each for each in (digits, share, within, duration, mm)}
"""Functions by which docs/numbers.yaml shows numbers."""


# --- sentences and tables -------------------------------------------------------------------------


def verdict(figure: str) -> str:
    """How many of the thesis's statements on a figure hold here, in a sentence; empty where none
    can be answered.
    """
    good, count = holding(table("thesis_comparison")).get(figure, (0, 0))
    if not count:
        return ""
    what = "statement of the thesis holds" if count == 1 else "statements of the thesis hold"
    return f"{good} of {count} {what} here"


@number
def explained_share():
    """Share of the differences that are explained."""
    text = (ROOT / "figures/tables/explanations.md").read_text(encoding="utf-8")
    return re.search(r"right or explained: (\d+) ?%", text)[1] + " %"


def markdown_table(head: str, rows: list[list[str]]) -> str:
    """Rows of cells as a Markdown table."""
    lines = [f"| {head} |", "|" + "---|" * len(rows[0])]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in rows])


@number
def presets():
    """The table of presets, as Markdown."""
    rows = []
    for name in ("draft", "thesis", "fine"):
        of = table("presets").query("preset == @name").set_index("scene")
        scenes = ("flat", "210", "1260", "stroke")
        errors = [f"{digits(of.loc[scene, 'error (%)'])} %" for scene in scenes]
        times = of["process time (s)"]
        took = [f"{digits(times.drop('stroke').mean())} s", f"{digits(times['stroke'])} s"]
        rows.append([name, f"{of['nodes'].max():,}", *errors, *took])
    return markdown_table(
        "preset | nodes | flat | 210 1/m | 1260 1/m | stroke | a press takes | the stroke", rows
    )


@number
def beliefs_missed():
    """The runs that are wronger than they believe, in words."""
    rows = table("accuracy_belief")
    rows = rows[rows["believed error (%)"] < rows["true error (%)"]]
    texts = [
        f"{row['scene']} ({row['accuracy']}) believes {row['believed error (%)']:.1f} "
        f"and is off by {row['true error (%)']:.1f} %"
        for _, row in rows.iterrows()
    ]
    return "; ".join(texts).replace("_", " ") or "none"


@number
def hard_cases_rest():
    """The others in words, by how they ended."""
    words = {
        "labours": "are right but took more cuts, factorisations or iterations than stable ones "
        "may",
        "admits its error": "say that they are wrong",
        "fails cleanly": "stop (exit code 3) with the last state saved, the cause named and what "
        "to relax",
        "not done": "not done in two minutes",
        "unsound": "end outside their limits and do not say so",
        "breaks off": "break off",
    }
    counts = table("stability")["outcome"].value_counts()
    ends = [f"{counts[outcome]} {text}" for outcome, text in words.items() if outcome in counts]
    return f"Of the others {'; '.join(ends)}" if ends else "There are no others"


def swept(what: str, scenes: int, quantity: str) -> float:
    """A number of the table of sweeps."""
    query = "what == @what and scenes == @scenes and quantity == @quantity"
    return table("sweeps").query(query)["value"].iloc[0]


@number
def sweep_costs():
    """The table of what sweeps take, as Markdown."""
    press = swept("steady press, finite strain", 200, "process time a scene, all included")
    rows = []
    for scenes in (100, 1000, 10_000):
        time, memory = (
            swept("collecting 30 measures", scenes, what)
            for what in ("process time", "largest memory")
        )
        laying_out = scenes * swept("laying out", scenes, "process time a scene")
        batches = f"{swept('laying out', scenes, 'batches'):.0f}"
        collected = f"{duration(time)}, {digits(memory)} MB"
        costs = [duration(laying_out), duration(scenes * press)]
        rows.append([f"{scenes:,}", batches, *costs, collected])
    return markdown_table(
        "scenes | batches | laying out | steady presses | dataset and table of 30 measures", rows
    )


if __name__ == "__main__":
    fill_pages()
