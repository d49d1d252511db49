"""Numbers in the pages that the published tables have: where they stand, and what they must be.

``numbers`` of docs/numbers.yaml says how to read a number from a table; a function below makes what
is more than a number. ``pages`` says where they stand: words of a page, with ``{name}`` in place of
the number, or of a whole Markdown table. ``python docs/_ext/published.py`` writes the present
numbers into the pages, and so does each build of the documentation. The pages hold no marks.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import yaml

from cysyk1999.claims.comparison import judged_rows
from cysyk1999.claims.said import figure_verdicts
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.reconstruction.pads import poisson_for
from cysyk1999.studies.reconstruction.specimen import most_probable
from fingerpad import load_scene
from fingerpad.benchmark.score import within_factor_2

ROOT = Path(__file__).parents[2]
_NUMBERS: dict[str, Callable[[], object]] = {}


@cache
def table(name: str) -> pd.DataFrame:
    """A published CSV file of figures/tables, or one by its path in figures/ without the ending."""
    path = name if "/" in name else f"tables/{name}"
    return pd.read_csv(ROOT / f"figures/{path}.csv")


@cache
def reference() -> pd.DataFrame:
    """The thesis's numbers and trends."""
    return read_reference(ROOT / "config/reference/thesis_numbers.csv")


@cache
def compared() -> pd.DataFrame:
    """Rows of the comparison that have been judged: their `kind` in the thesis (value, range, axis
    or trend), their `score`, whether each `agrees`.
    """
    return judged_rows(table("thesis_comparison"), reference())


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


@cache
def readings() -> pd.DataFrame:
    """Three rows, kinds of reading of the thesis's energies: how many powers of ten the evidence
    for the likeliest of each is behind that of all (`behind`), also of the even figures when the
    odd ones are known (`held_out`) and of the odd ones when the even ones are (`other_half`).
    """
    rows = table("reconstruction_readings")
    name = rows["reading"]
    formula, free = name.str.contains("plane_stress"), name.str.startswith("free_bulk")
    kind = np.select([formula, free], ["formula", "compressible"], "elastic")
    columns = {
        "behind": "log evidence (1)",
        "held_out": "even, odd known (1)",
        "other_half": "odd, even known (1)",
    }
    best = rows.groupby(kind)[list(columns.values())].max()
    behind = (best.max() - best) / np.log(10)
    return behind.set_axis(list(columns), axis=1).rename_axis("kind").reset_index()


@cache
def posterior() -> pd.DataFrame:
    """What the reading nearest to the printed words implies of every unknown."""
    rows = table("reconstruction_posterior")
    return rows[rows["reading"] == most_probable(table("reconstruction_readings"))]


@cache
def pads() -> pd.DataFrame:
    """Two rows: the pad of scenes with elastic energies, and as shown here, with their `distance`
    from the evidence and how much of it they meet (`inside`).
    """
    rows = table("reconstruction_families").head(2)
    return rows.assign(distance=rows["distance, all (1)"], inside=rows["inside, all"])


PREPARED = {
    "readings": readings,
    "posterior": posterior,
    "pads": pads,
    "pad": pad,
    "compared": compared,
    "outcomes": outcomes,
}
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


def _entries(part: str) -> dict:
    return yaml.safe_load((ROOT / "docs/numbers.yaml").read_text(encoding="utf-8"))[part]


def numbers() -> dict[str, str]:
    """All of them, as text."""
    texts = {name: read(address) for name, address in _entries("numbers").items()}
    return texts | {name: str(made()) for name, made in _NUMBERS.items()}


def pages() -> dict[Path, list[str]]:
    """Page -> the words around its numbers."""
    return {ROOT / page: words for page, words in _entries("pages").items()}


def places(text: str, words: str, known: dict[str, str]) -> list[tuple[slice, str]]:
    """Where the numbers of some words of a page stand, and their names, the last one first.

    Raises LookupError where the words are not in the page exactly once.
    """
    first, *rest = re.split(r"\{(\w+)\}", words)
    if "\n" in known[rest[0]]:  # a table: its head, and the lines below
        pattern = "(" + re.escape(known[rest[0]].split("\n")[0]) + r"(?:\n\|[^\n]*)*)"
    else:
        literal = [r"\s+".join(map(re.escape, re.split(r"\s+", w))) for w in (first, *rest[1::2])]
        pattern = re.sub(r"\\\.(?!\d)", r"\\.(?!\\d)", r"([^\n|]+?)".join(literal))  # a full stop
    found = list(re.finditer(pattern, text))
    if len(found) != 1:
        raise LookupError(f"{words!r} is {len(found)} times in the page")
    spans = [slice(*found[0].span(k + 1)) for k in range(len(rest[::2]))]
    return list(zip(spans, rest[::2], strict=True))[::-1]


def filled(text: str, page: list[str], known: dict[str, str]) -> str:
    """A page with the present numbers. Raises KeyError for a name that is not known."""
    for words in page:
        for span, name in places(text, words, known):
            text = text[: span.start] + known[name] + text[span.stop :]
    return text


def fill_pages() -> None:
    """Write the present numbers into the pages that say others."""
    known = numbers()
    for page, words in pages().items():
        text = page.read_text(encoding="utf-8")
        if (new := filled(text, words, known)) != text:
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


SHOWN = {
    each.__name__: each
    for each in (digits, share, within, duration, mm, poisson_for, within_factor_2)
}
"""Functions by which docs/numbers.yaml shows numbers."""


# --- sentences and tables -------------------------------------------------------------------------


def verdict(figure: str) -> str:
    """What the thesis says of a figure and whether it is so here; empty where nothing can be
    judged.
    """
    found = figure_verdicts(table("thesis_comparison"), reference()).get(figure)
    return found.texts[0] if found else ""


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


ENDS = {
    "stable": "stable",
    "healed": "stable after what the run relaxed by itself",
    "labours": "right, with more than ten matrices a state or more than two halved steps",
    "admits its error": "wrong, and the run says so",
    "fails cleanly": "stops with its last state saved, the cause, and what to relax",
    "not done": "not done in two minutes",
    "unsound": "outside its limits without a warning",
    "breaks off": "breaks off",
}
"""How hard cases end, in words."""


@number
def hard_cases_ends():
    """How the cases of the catalogue ended, as planned and with remedies, as Markdown."""
    rows = table("stability")
    planned, ended = rows["outcome"].value_counts(), rows["with remedies"].value_counts()
    counts = [[text, str(planned.get(k, 0)), str(ended.get(k, 0))] for k, text in ENDS.items()]
    return markdown_table("outcome | as planned | in the end", counts)


@number
def hard_cases_unseen():
    """How cases ended that were drawn anew, by seed, as Markdown."""
    counts = table("stability_unseen").groupby("seed")["outcome"].value_counts().unstack(0)
    counts = counts.reindex(list(ENDS), fill_value=0).fillna(0).astype(int)
    rows = [[text, *map(str, counts.loc[outcome])] for outcome, text in ENDS.items()]
    return markdown_table(" | ".join(["outcome", *(f"seed {seed}" for seed in counts)]), rows)


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


EMULATED = {
    "indentation_depth": "depth",
    "contact_width": "contact width",
    "peak_pressure": "peak pressure",
    "centre_pressure": "pressure in the middle",
}
"""What quantities of an emulator are called; others have their own name."""


@number
def emulator_errors():
    """How far the emulator of the pad is off, as Markdown."""
    rows = table("emulator").query("quantity != 'estimated_error'").drop(columns="unseen scenes")
    shown = []
    for name, median, most, covered in rows.itertuples(index=False):
        energy = re.sub(
            r"strain_energy_(\d+)_um", lambda m: f"strain energy density at {m[1]} um", name
        )
        errors = [f"{digits(median)} %", f"{digits(most)} %", f"{covered:.0f} %"]
        shown.append([EMULATED.get(name, energy), *errors])
    return markdown_table("quantity | median error | 95 % within | in the band", shown)


if __name__ == "__main__":
    fill_pages()
