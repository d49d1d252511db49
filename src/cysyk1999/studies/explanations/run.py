"""The thesis's presses and strokes, read otherwise in one thing at a time, and the verdicts on its
statements of each reading.

The pad was inferred from what the thesis shows of presses (study reconstruction). Of the statements
that it was held out from, some do not hold. Here everything else that the thesis does not say is
read otherwise, one thing at a time, and the comparison is made again with those runs: at draft
accuracy, but of the published runs of all scenes where only what is read of them is another. A
statement that holds with one of them, and not without at the same accuracy, is explained by it: it
tells what the model of 1999 may have been, not that it was. What the same reading spoils is counted
beside.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import xarray as xr
import yaml

from cysyk1999.claims.comparison import AGREES, KINDS, judged_rows, thesis_comparison
from cysyk1999.measures.energy_of_1999 import ELASTIC, as_of_1999
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.runs import FAST, NINE
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.common.documents import CONFIG
from fingerpad.healing import simulate
from fingerpad.measures.strokes import FULL, STEPPED, SUB
from fingerpad.results import ENERGIES
from fingerpad.scenes.scene import Scene, Slide, load_scene

PRESSED = (*NINE.scenes.values(), *FAST.scenes.values())
STROKED = (*FULL.values(), *SUB.values(), STEPPED)
ACCURACY = "draft"


@dataclass(frozen=True)
class Reading:
    """One thing read otherwise.

    Attributes
    ----------
    words : what it is.
    everywhere, stroked : changes of every scene, and of those with the wavy surface.
    share : of the force that presses the wavy surface, in the same time.
    keeps : what is kept while it slides, force or depth.
    deeper : m, how much deeper than it is called a receptor lies.
    energy : which of a history's strain energies is read.
    given : rows that it takes from the thesis, so that it explains nothing by them.
    """

    words: str
    everywhere: Mapping[str, Any] = field(default_factory=dict)
    stroked: Mapping[str, Any] = field(default_factory=dict)
    share: float = 1.0
    keeps: str = "force"
    deeper: float = 0.0
    energy: str = ENERGIES[0]
    given: tuple[str, ...] = ()

    def of(self, scene: Scene, stroked: bool) -> Scene:
        """A scene read so."""
        changes = {"accuracy": ACCURACY, **self.everywhere, **(self.stroked if stroked else {})}
        if stroked and self.share != 1:
            press = scene.motion[0]
            changes |= {"motion[0].press_to_force": self.share * press.force}
            if press.rate:
                changes["motion[0].rate"] = self.share * press.rate
        if stroked and isinstance(scene.motion[1], Slide):
            changes["motion[1].keep"] = self.keeps
        if self.deeper:
            depths = scene.outputs.receptors.depths
            changes["outputs.receptors.depths"] = [
                f"{round(1e6 * (depth + self.deeper), 3):g} um" for depth in depths
            ]
        return scene.varied(changes)

    def called(self, history: xr.Dataset) -> xr.Dataset:
        """A history of it with receptors and energy by the names that the measures ask for."""
        history = history if ELASTIC in history else as_of_1999(history)
        return history.assign(
            {
                "receptor_depth": history["receptor_depth"] - self.deeper,
                ENERGIES[0]: history[self.energy],
            }
        )


CONTROL, PUBLISHED = "as it is", "as published"
FILE = "config/explanations/readings.yaml"
_written = yaml.safe_load((CONFIG.parent / FILE).read_text("utf-8"))
READINGS = {name: Reading(**fields) for name, fields in _written.items()}
"""What the thesis leaves open, by name; and the controls."""
READ_ONLY = tuple(
    name
    for name, reading in READINGS.items()
    if name != CONTROL and replace(reading, words="", energy=ENERGIES[0]) == Reading("")
)
"""Readings of the published runs, their control among them; all others are simulated."""


def control_of(name: str) -> str:
    """What a reading is held against: the same scenes at the same accuracy."""
    return PUBLISHED if name in READ_ONLY else CONTROL


def simulated(scenes: Path, reading: Reading) -> dict[str, xr.Dataset]:
    """Histories of the presses and strokes, by scene, of a folder of scenes. Raises
    NonConvergence.
    """
    return {
        name: simulate(reading.of(load_scene(scenes / f"{name}.yaml"), name in STROKED))
        for name in (*PRESSED, *STROKED)
    }


def verdicts(
    histories: Mapping[str, xr.Dataset], reading: Reading, reference_csv: str | PathLike
) -> pd.DataFrame:
    """The comparison of a reading's histories: columns id, simulated, verdict; without what they do
    not tell.
    """
    nothing = Measures.of({})
    called = {name: reading.called(history) for name, history in histories.items()}
    table = thesis_comparison(
        Measures.of(called), Instead(nothing, nothing, nothing, nothing), reference_csv
    )
    return table.loc[table["verdict"] != "not_comparable", ["id", "simulated", "verdict"]]


def changes(found: Mapping[str, pd.DataFrame]) -> tuple[pd.DataFrame, ...]:
    """Statements (rows) by readings (columns), the controls left out: whether each holds, whether
    the reading brings that about, and whether it makes it fail.

    The first is NA where a reading does not tell. A reading does nothing to rows that it was given.
    """
    right = {name: table.set_index("id")["verdict"].isin(AGREES) for name, table in found.items()}
    right = pd.DataFrame(right).astype("boolean")
    names = [name for name in found if name not in (CONTROL, PUBLISHED)]
    holds = right[names]
    without = right[[control_of(name) for name in names]].set_axis(names, axis=1)
    gained, lost = (holds & ~without).fillna(False), (~holds & without).fillna(False)
    for name in names:
        given = right.index.isin(READINGS[name].given)
        gained.loc[given, name] = lost.loc[given, name] = False
    return holds, gained, lost


def explanations(
    published: pd.DataFrame, found: Mapping[str, pd.DataFrame], reference_csv: str | PathLike
) -> pd.DataFrame:
    """What was held out and does not hold in the published comparison, and the readings with which
    it holds.

    Parameters
    ----------
    published : the comparison.
    found : :func:`verdicts` by reading, the controls among them.

    Returns
    -------
    A row each: the readings that explain it, the number found with the first of them, and the
    readings that do not. ``attrs["summary"]`` says how many of those held out are right, and how
    many more are explained, by kind.
    """
    reference = read_reference(reference_csv)
    scored = _held_out(published, reference)
    wrong = scored[~scored["verdict"].isin(AGREES)]
    table = wrong[["id", "figure", "quantity", "condition", "simulated"]].reset_index(drop=True)
    holds, gained, _ = (kind.reindex(table["id"]) for kind in changes(found))
    told = holds.notna()
    by = [list(gained.columns[row]) for row in (gained & told).to_numpy(bool)]
    table["explained_by"] = [", ".join(names) for names in by]
    table["with_it"] = [
        found[names[0]].set_index("id").at[id_, "simulated"] if names else float("nan")
        for id_, names in zip(table["id"], by, strict=True)
    ]
    rest = (told & ~(gained & told)).to_numpy(bool)
    table["not_by"] = [", ".join(holds.columns[row]) for row in rest]
    table.attrs["summary"] = _summary(scored, table)
    return table


def _summary(scored: pd.DataFrame, table: pd.DataFrame) -> str:
    explained = scored["id"].isin(table.loc[table["explained_by"] != "", "id"])
    counts = [
        f"{kinds}: {scored['agrees'][of].sum()} of {of.sum()} right, "
        f"{explained[of].sum()} more explained by a run"
        for kinds, of in ((kinds, scored["kind"].eq(kind)) for kind, kinds in KINDS.items())
    ]
    share = (scored["agrees"] | explained)[scored["kind"] != "axis"].mean()
    return (
        f"**Held out, {'; '.join(counts)}.** Numbers, ranges and trends right or explained: "
        f"{share:.0%}."
    )


def _held_out(published: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """The rows of a comparison that the pad was held out from, and that are judged."""
    rows = judged_rows(published, reference)
    return rows[rows["score"].eq("held out")]


def turned(
    published: pd.DataFrame, found: Mapping[str, pd.DataFrame], reference_csv: str | PathLike
) -> pd.DataFrame:
    """How many of the statements held out each reading makes hold that do not without it, and the
    other way round.

    Arguments as of :func:`explanations`. A row a reading, those first that make most hold for what
    they make fail.
    """
    held_out = _held_out(published, read_reference(reference_csv))["id"]
    _, gained, lost = (kind[kind.index.isin(held_out)].sum() for kind in changes(found))
    table = pd.DataFrame({"makes_hold": gained, "makes_fail": lost}).astype(int)
    table.insert(0, "words", [READINGS[name].words for name in table.index])
    order = (table["makes_fail"] - table["makes_hold"]).argsort(kind="stable")
    return table.iloc[order].rename_axis("reading").reset_index()


def explanation(job: SimpleNamespace) -> None:
    """Job: The reading `name` of the scenes in the folder `scenes`, the table `reference` ->
    `data`.
    """
    reading = READINGS[job.name[0]]
    write_frame(
        verdicts(simulated(Path(job.scenes[0]), reading), reading, job.reference[0]),
        Path(job.data[0]),
    )


def explanations_read(job: SimpleNamespace) -> None:
    """Job: The readings `names` of all `histories`, the table `reference` -> `data`."""
    histories, _, _ = read_results(job.histories, True)
    for name, data in zip(job.names, job.data, strict=True):
        write_frame(verdicts(histories, READINGS[name], job.reference[0]), Path(data))


def explanations_table(job: SimpleNamespace) -> None:
    """Job: `readings` by their `names`, the `comparison`, the table `reference` -> `tables`."""
    known = (
        pd.read_csv(job.comparison[0]),
        dict(zip(job.names, map(pd.read_csv, job.readings), strict=True)),
        job.reference[0],
    )
    for table, path in zip((explanations(*known), turned(*known)), job.tables, strict=True):
        publish_table(table, path)
