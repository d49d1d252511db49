"""The study from the design to its tables: emulator, posterior of each reading, recovery, and what
chosen pads really show.

What a posterior says of held-out rows is never taken from the emulator: pads of it are simulated
under all nine surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.design import simulated
from cysyk1999.studies.reconstruction.emulator import Emulator
from cysyk1999.studies.reconstruction.evidence import CHAPTERS, HALVES, Evidence, read_evidence
from cysyk1999.studies.reconstruction.inference import (
    TAILS,
    Posterior,
    Problem,
    infer,
    probabilities,
    recovery,
)
from cysyk1999.studies.reconstruction.specimen import most_probable, specimen_text
from cysyk1999.studies.reconstruction.unknowns import (
    BULK,
    ENERGY,
    EPIDERMIS,
    SCALED,
    SOFT,
    STROKE_ENERGY,
    Unknowns,
    read_unknowns,
)
from fingerpad.files import write_text

BEFORE, HERE = "pad of scenes, elastic energy, 20 gf", "pad of scenes, as shown here"
ENERGIES = {
    "instantaneous elastic": "",
    "total stress on long-term moduli": "_long-term_moduli",
    "network": "_network",
    "recoverable": "_recoverable",
}
"""Definitions of the strain energy, by what their measures end with; the headline's first."""
DRAWN, TRIALS, SEED = 6, 3, 1999
"""Pads of the posterior that are simulated; known pads that are to be found again."""
FREEST = "free_bulk_free_moduli"
"""The reading on which definitions of the energy and recovery are tried."""
BANDS = ("width_top", "width_end", "peak")
"""Measures of presses whose spread over pads is shown beside the thesis's figures."""
SHOWN = (SCALED, "apex_radius", "fat_thickness", "bone_half_width", BULK, SOFT, EPIDERMIS)
"""What the picture of the posterior shows."""

Pads = Mapping[str, Mapping[str, Any]]
"""By a pad's name: its unknowns, or what was read of it."""


@dataclass(frozen=True)
class Study:
    """Results of the study.

    Attributes
    ----------
    posteriors : by reading, of all rows.
    halves : by half and reading, of that half alone.
    readings, energies, emulator, recovered : tables.
    samples : of all readings, each with its share.
    """

    posteriors: Mapping[str, Posterior]
    halves: Mapping[str, Mapping[str, Posterior]]
    readings: pd.DataFrame
    energies: pd.DataFrame
    emulator: pd.DataFrame
    recovered: pd.DataFrame
    samples: pd.DataFrame


def emulated(known: Unknowns, evidence: Evidence, design: pd.DataFrame) -> Emulator:
    """An emulator of everything that the evidence needs by any definition of the energy, from the
    pads that did not fail.
    """
    whole = design[design["diagnosis"].isna() | (design["diagnosis"] == "")]
    keys = [
        key
        for ending in (*ENERGIES.values(), pads.PLANE_STRESS)
        for key in evidence.defined(dict.fromkeys(CHAPTERS, ending)).keys
    ]
    return Emulator.fit(known.to_unit(whole), whole[list(dict.fromkeys(keys))])


def room_of(known: Unknowns, count: int = 256) -> Emulator:
    """An emulator of the fat where it is thinnest, from the first pads of the design."""
    drawn = pd.DataFrame(known.draw()).head(count)
    room = [pads.clearance(pad) for pad in drawn.to_dict("records")]
    return Emulator.fit(known.to_unit(drawn), pd.DataFrame({"pad: clearance": room}))


def study(known: Unknowns, evidence: Evidence, design: pd.DataFrame, trials: int = TRIALS) -> Study:
    """Everything that needs no further simulation."""
    emulator, room = emulated(known, evidence, design), room_of(known)

    def problem(reading: str, rows: Evidence) -> Problem:
        rows = rows.defined(dict.fromkeys(CHAPTERS, known.readings[reading].energy))
        return Problem(known, reading, emulator.only(rows.keys), rows, room)

    def found(part: str) -> dict[str, Posterior]:
        return {name: infer(problem(name, evidence.of(part))) for name in known.readings}

    posteriors, halves = found("all"), {half: found(half) for half in HALVES}
    return Study(
        posteriors,
        halves,
        readings_table(posteriors, halves),
        energies_table(
            lambda rows: infer(Problem(known, FREEST, emulator.only(rows.keys), rows, room)),
            evidence,
        ),
        pd.concat([emulator.summary(), room.summary()], ignore_index=True),
        recovery(problem(FREEST, evidence), trials),
        samples_of(posteriors),
    )


def readings_table(
    posteriors: Mapping[str, Posterior], halves: Mapping[str, Mapping[str, Posterior]]
) -> pd.DataFrame:
    """A row a reading: the logarithm of its evidence from all rows, from each half, and from each
    half when the other is known.
    """
    rows = []
    for name, posterior in posteriors.items():
        odd, even = (halves[half][name].log_evidence for half in HALVES)
        row = {"reading": name, "says": posterior.problem.known.readings[name].says}
        row |= {"log evidence (1)": posterior.log_evidence, "its error (1)": posterior.error}
        row |= {"odd figures (1)": odd, "even figures (1)": even}
        row |= {"odd, even known (1)": posterior.log_evidence - even}
        row |= {"even, odd known (1)": posterior.log_evidence - odd}
        rows.append(row | {"least distance (1)": posterior.least_distance})
    table = pd.DataFrame(rows)
    table.insert(4, "probability (1)", probabilities(table["log evidence (1)"]))
    return table


def energies_table(inferred: Callable[[Evidence], Posterior], evidence: Evidence) -> pd.DataFrame:
    """A row a choice of definitions of the strain energy, by chapter: chapter 4 and sections 5.1 to
    5.4 in all pairs, section 5.5 with the headline's in both others.
    """
    first = next(iter(ENERGIES))
    choices = [(four, five, first) for four in ENERGIES for five in ENERGIES]
    choices += [(first, first, ridges) for ridges in list(ENERGIES)[1:]]
    rows = []
    for choice in choices:
        ends = {c: ENERGIES[name] for c, name in zip(CHAPTERS, choice, strict=True)}
        found = inferred(evidence.defined(ends))
        row = dict(zip(CHAPTERS, choice, strict=True))
        row |= {"log evidence (1)": found.log_evidence, "its error (1)": found.error}
        rows.append(row | {"least distance (1)": found.least_distance})
    return pd.DataFrame(rows)


def samples_of(posteriors: Mapping[str, Posterior], count: int = 1500) -> pd.DataFrame:
    """Samples of all readings together, as many of each as its evidence makes it likely: what is
    believed of each unknown.
    """
    share = probabilities(pd.Series({k: p.log_evidence for k, p in posteriors.items()}))
    rng, frames = np.random.default_rng(SEED), []
    for name, posterior in posteriors.items():
        pick = rng.integers(len(posterior.samples), size=round(count * share[name]))
        pad = posterior.problem.pad(posterior.samples[pick])
        if len(pick):
            frames.append(pd.DataFrame({"reading": name, **pad}))
    return pd.concat(frames, ignore_index=True)


def posterior_table(posteriors: Mapping[str, Posterior], samples: pd.DataFrame) -> pd.DataFrame:
    """Intervals of every reading, and of all together by their probabilities."""
    tables = [p.table() for p in posteriors.values()]
    together = tables[0][["quantity", "unit"]].assign(reading="all readings by their probability")
    quantiles = samples[list(together["quantity"])].quantile([0.5, *TAILS]).T.to_numpy()
    together[["median", "low 5 %", "high 95 %"]] = quantiles
    return pd.concat([together, *tables], ignore_index=True)[list(tables[0].columns)]


def recovery_table(recovered: pd.DataFrame) -> pd.DataFrame:
    """How often each quantity was covered, and all together."""
    rows = pd.concat([recovered, recovered.assign(quantity="all")])
    by = rows.groupby("quantity", sort=False)["covered"].agg(["sum", "count"]).reset_index()
    return by.rename(columns={"sum": "covered", "count": "trials"})


def chosen_pads(found: Study, drawn: int = DRAWN) -> dict[str, dict[str, Any]]:
    """Pads that are simulated under all surfaces: the one before, the best of each reading and of
    the halves for the likeliest, some drawn. "energy" is the definition.
    """
    readings = next(iter(found.posteriors.values())).problem.known.readings
    best = {f"best of {name}": p for name, p in found.posteriors.items()}
    likely = most_probable(found.readings)
    best |= {f"best of {likely}, {half} figures": found.halves[half][likely] for half in HALVES}
    chosen = {BEFORE: dict(pads.BEFORE), HERE: dict(pads.HERE)}
    for name, posterior in best.items():
        pad = posterior.problem.pad(posterior.best)
        energy = readings[posterior.problem.reading].energy
        chosen[name] = {k: float(v) for k, v in pad.items()} | {"energy": energy}
    rng, count = np.random.default_rng(SEED), min(drawn, len(found.samples))
    rows = found.samples.iloc[rng.choice(len(found.samples), count, replace=False)]
    for k, row in enumerate(rows.to_dict("records"), start=1):
        chosen[f"drawn {k}"] = row | {"energy": readings[row["reading"]].energy}
    return chosen


def simulate_pads(evidence: Evidence, chosen: Pads) -> dict[str, dict[str, float]]:
    """What is read of pads under all surfaces of the evidence; stated moduli of dermis and fat
    taken for long-term ones.
    """
    surfaces, out = list(evidence.rows["surface"].unique()), {}
    for name, pad in chosen.items():
        result = simulated({k: pad[k] for k in pads.CHOSEN}, surfaces)
        out[name] = pads.with_plane_stress(pad, result["values"])
        print(name, result["diagnosis"] or "done", result["cpu_s"], flush=True)
    return out


def predicted(evidence: Evidence, chosen: Pads, found: Pads) -> pd.DataFrame:
    """What pads show, row by row of the evidence; simulated, not emulated.

    Columns pad, id, shown, departure (in standard deviations of the row).
    """
    frames = []
    for name, pad in chosen.items():
        rows = evidence.defined(dict.fromkeys(CHAPTERS, pad["energy"]))
        factors = pad["plate_length"], pad[ENERGY], pad[STROKE_ENERGY]
        shown = rows.shown(rows.values(found[name]), pad[SOFT], *factors)
        row = {"pad": name, "id": evidence.rows["id"], "shown": shown}
        frames.append(pd.DataFrame(row | {"departure": evidence.departure(shown)}))
    return pd.concat(frames, ignore_index=True)


def bands(chosen: Pads, found: Pads) -> pd.DataFrame:
    """How far the pads drawn from what is believed differ: a row a surface and measure of `BANDS`,
    lowest and highest of them.
    """
    rows = []
    drawn = {name: found[name] for name in chosen if name.startswith("drawn")}
    for key in next(iter(drawn.values())):
        surface, measure = key.split(": ")
        if measure not in BANDS or surface not in pads.SURFACES:
            continue
        unit = pads.MEASURES[measure]
        shown = [
            values[key] * (1.0 if unit in pads.SCALE_FREE else chosen[name][SOFT])
            for name, values in drawn.items()
            if key in values
        ]
        row = {"surface": surface, "measure": measure, "unit": unit}
        rows.append(row | {"low": min(shown), "high": max(shown), "pads": len(shown)})
    source = "pads drawn from the posterior of snakemake reconstruction, simulated"
    return pd.DataFrame(rows).assign(source=source)


def families(evidence: Evidence, found: pd.DataFrame, chosen: Pads) -> pd.DataFrame:
    """Distance of each pad by half and family, rows inside, and the pad itself: a row a pad."""
    of_row = evidence.rows[["id", "family"]].assign(half=evidence.halves)
    rows = found.merge(of_row, on="id")
    rows = rows.assign(squared=rows["departure"] ** 2, inside=rows["departure"] == 0)
    out = []
    for name, of_pad in rows.groupby("pad", sort=False):
        row = {"pad": name} | {k: chosen[name][k] for k in SHOWN}
        for title, of in [("all", of_pad), *((h, of_pad[of_pad["half"] == h]) for h in HALVES)]:
            row[f"distance, {title} (1)"] = of["squared"].sum(min_count=1)
            row[f"inside, {title}"] = f"{of['inside'].sum()} of {len(of)}"
        by_family = of_pad.groupby("family", sort=False)["squared"].sum()
        out.append(row | by_family.add_suffix(" (1)").to_dict())
    return pd.DataFrame(out)


def reconstruction_inference(job: SimpleNamespace) -> None:
    """Job: `unknowns`, `evidence`, `design` -> `tables` (posterior, readings, energies, emulator,
    recovery, families), `parts` (samples, predicted, bands), `specimen`.
    """
    evidence = Evidence(read_evidence(job.evidence[0]))
    found = study(read_unknowns(job.unknowns[0]), evidence, pd.read_csv(job.design[0]))
    chosen = chosen_pads(found)
    simulated = simulate_pads(evidence, chosen)
    shown = predicted(evidence, chosen, simulated)
    posterior = posterior_table(found.posteriors, found.samples)
    tables = (
        posterior,
        found.readings,
        found.energies,
        found.emulator,
        recovery_table(found.recovered),
        families(evidence, shown, chosen),
    )
    for table, path in zip(tables, job.tables, strict=True):
        publish_table(table, path)
    for part, path in zip((found.samples, shown, bands(chosen, simulated)), job.parts, strict=True):
        write_frame(part, Path(path))
    write_text(job.specimen[0], specimen_text(posterior, found.readings))
