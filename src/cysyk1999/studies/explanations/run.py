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

from cysyk1999.claims.comparison import AGREES, score_of, thesis_comparison
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.runs import FAST, NINE
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.publishing.write import publish_table, write_frame
from cysyk1999.reference_data import read_reference
from fingerpad.measures.strokes import FULL, STEPPED, SUB
from fingerpad.results import ENERGIES
from fingerpad.scenes.scene import Scene, Slide, load_scene
from fingerpad.simulation import simulate

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

    def runs(self) -> Reading:
        """What of it is simulated."""
        return replace(self, words="", energy=ENERGIES[0])

    def called(self, history: xr.Dataset) -> xr.Dataset:
        """A history of it with receptors and energy by the names that the measures ask for."""
        return history.assign(
            {
                "receptor_depth": history["receptor_depth"] - self.deeper,
                ENERGIES[0]: history[self.energy],
            }
        )


CONTROL, PUBLISHED = "as it is", "as published"
OUTLINE = "specimen.outline"
STIFFNESS = "specimen.layers.epidermis.youngs_modulus"
READINGS: dict[str, Reading] = {
    CONTROL: Reading("the comparison's own scenes"),
    PUBLISHED: Reading("the comparison's own runs"),
    "long-term moduli": Reading(
        "the printed moduli are long-term ones", {"specimen.moduli": "long_term"}
    ),
    "larger radius": Reading(
        "apex radius 10.5 mm, of a published section", {f"{OUTLINE}.apex_radius": "10.5 mm"}
    ),
    "smaller radius": Reading(
        "apex radius 7.9 mm, of the printed fan of nodes",
        {f"{OUTLINE}.apex_radius": "7.9 mm"},
        given=("T323",),
    ),
    "more fat": Reading(
        "5.65 mm of fat, the end of its interval",
        {
            f"{OUTLINE}.bone_centre_height": "-2.675 mm",
            f"{OUTLINE}.bone_half_height": "1.325 mm",
        },
    ),
    "wider bone": Reading(
        "bone half-width 4.87 mm, the end of its interval",
        {f"{OUTLINE}.bone_half_width": "4.87 mm"},
    ),
    "softer epidermis": Reading("half the printed modulus of the epidermis", {STIFFNESS: "75 kPa"}),
    "stiffer epidermis": Reading(
        "twice the printed modulus of the epidermis", {STIFFNESS: "300 kPa"}
    ),
    "longer contact": Reading(
        "force spread over 20 mm, not 11.4 mm, of pad", {"specimen.contact_length": "20 mm"}
    ),
    "more friction": Reading(
        "the wavy surface has twice the friction, 0.7, where it is stepped too",
        stroked={"friction": 0.7},
    ),
    "no friction": Reading("the wavy surface slides without friction", stroked={"friction": 0.0}),
    "half the force": Reading("the wavy surface is pressed with 10 gram-weight", share=0.5),
    "twice the force": Reading("the wavy surface is pressed with 40 gram-weight", share=2.0),
    **{
        f"energy: {name}": Reading(
            f"strain energy is that of {words}", energy=f"strain_energy_{variable}"
        )
        for name, words, variable in (
            ("long-term", "the total stress on long-term moduli", "long_term_moduli"),
            ("stress x strain", "half of total stress times strain", "half_stress_strain"),
            ("recoverable", "the springs of network and branches", "recoverable"),
            ("network", "the long-term network", "network"),
        )
    },
    "receptors higher": Reading(
        "receptors lie 80 um nearer the skin than they are called", deeper=-80e-6
    ),
    "receptors deeper": Reading("receptors lie 80 um deeper than they are called", deeper=80e-6),
    "depth kept": Reading(
        "the depth that 20 gram-weight press to is kept while the wavy surface slides",
        keeps="depth",
    ),
}
"""What the thesis leaves open, by name; and the controls."""
READ_ONLY = tuple(
    name
    for name, each in READINGS.items()
    if name != CONTROL and each.runs() == READINGS[CONTROL].runs()
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


COLUMNS = (
    "id",
    "figure",
    "quantity",
    "condition",
    "simulated",
    "explained_by",
    "with_it",
    "not_by",
)


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
    A row each, columns `COLUMNS`: the readings that explain it, the number found with the first of
    them, and the readings that do not. ``attrs["summary"]`` says how many of those held out are
    right, and how many more are explained, by kind.
    """
    reference = read_reference(reference_csv)
    scored = _held_out(published, reference)
    right = {name: table.set_index("id")["verdict"].isin(AGREES) for name, table in found.items()}
    values = {name: table.set_index("id")["simulated"] for name, table in found.items()}
    rows = []
    for _, row in scored[~scored["verdict"].isin(AGREES)].iterrows():
        id_ = row["id"]
        tried = {
            name: bool(held[id_])
            for name, held in right.items()
            if name not in (CONTROL, PUBLISHED) and id_ in held
        }
        without = {name: right[control_of(name)].get(id_, True) for name in tried}
        by = [
            name
            for name, holds in tried.items()
            if holds and not without[name] and id_ not in READINGS[name].given
        ]
        rows.append(
            {k: row[k] for k in ("id", "figure", "quantity", "condition", "simulated")}
            | {"explained_by": ", ".join(by), "with_it": values[by[0]][id_] if by else float("nan")}
            | {"not_by": ", ".join(name for name in tried if name not in by)}
        )
    table = pd.DataFrame(rows, columns=COLUMNS)
    table.attrs["summary"] = _summary(scored, table, reference)
    return table


def _summary(scored: pd.DataFrame, table: pd.DataFrame, reference: pd.DataFrame) -> str:
    names = {"axis": "axes", "trend": "trends"}
    kinds = scored["id"].map(
        reference["form"].map(lambda form: names.get(form, "values and ranges"))
    )
    explained = scored["id"].isin(table.loc[table["explained_by"] != "", "id"])
    agrees = scored["verdict"].isin(AGREES)
    counts = []
    for kind in ("values and ranges", "trends", "axes"):
        of = kinds == kind
        counts.append(
            f"{kind}: {(agrees & of).sum()} of {of.sum()} right, "
            f"{(explained & of).sum()} more explained by a run"
        )
    counted = ~kinds.eq("axes")
    share = ((agrees | explained) & counted).sum() / counted.sum()
    return (
        f"**Held out, {'; '.join(counts)}.** Values, ranges and trends right or explained: "
        f"{share:.0%}."
    )


def _held_out(published: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """The rows of a comparison that the pad was held out from, and that are judged."""
    held_out = published["id"].map(reference.apply(score_of, axis=1)).eq("held out")
    return published[held_out & published["verdict"].ne("not_comparable")]


def turned(
    published: pd.DataFrame, found: Mapping[str, pd.DataFrame], reference_csv: str | PathLike
) -> pd.DataFrame:
    """How many of the statements held out each reading makes hold that do not without it, and the
    other way round.

    Arguments as of :func:`explanations`. A row a reading, those first that make most hold for what
    they make fail.
    """
    held_out = _held_out(published, read_reference(reference_csv))["id"]
    right = {name: table.set_index("id")["verdict"].isin(AGREES) for name, table in found.items()}
    rows = []
    for name, held in right.items():
        if name in (CONTROL, PUBLISHED):
            continue
        control = right[control_of(name)]
        both = (
            held.index.intersection(control.index)
            .intersection(held_out)
            .difference(READINGS[name].given)
        )
        gained, lost = (held[both] & ~control[both]).sum(), (~held[both] & control[both]).sum()
        rows.append(
            {
                "reading": name,
                "words": READINGS[name].words,
                "makes_hold": gained,
                "makes_fail": lost,
            }
        )
    table = pd.DataFrame(rows)
    return table.iloc[
        (table["makes_fail"] - table["makes_hold"]).argsort(kind="stable")
    ].reset_index(drop=True)


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
    histories, _, _ = read_results(job.histories)
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
