"""The study from the design to its tables: emulator, posterior of each reading, recovery, and what
chosen pads really show.

What a posterior says of held-out rows is never taken from the emulator: pads of it are simulated
under all nine surfaces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd

from cysyk1999.publishing.write import publish_table, write_frame
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.design import simulated
from cysyk1999.studies.reconstruction.emulator import Emulator
from cysyk1999.studies.reconstruction.evidence import ROLES, Evidence, read_evidence
from cysyk1999.studies.reconstruction.inference import (
    TAILS,
    Posterior,
    Problem,
    evidences,
    infer,
    probabilities,
    recovery,
)
from cysyk1999.studies.reconstruction.specimen import specimen_text
from cysyk1999.studies.reconstruction.unknowns import (
    EPIDERMIS,
    SCALED,
    SOFT,
    Unknowns,
    read_unknowns,
)
from fingerpad.files import write_text

CHOSEN = "chosen one at a time"
ENERGIES = {
    "instantaneous elastic": "energy_915",
    "total stress on long-term moduli": "energy_915_long-term_moduli",
}
"""Definitions of the energy whose curves peak at the ramp's end, as those of the thesis do (trends
TR20, TR21), by measure. The first is the headline's.
"""
DRAWN, TRIALS, SEED = 12, 10, 1999
"""Pads of the posterior that are simulated; known pads that are to be found again."""
FREEST = "both_free"
"""The reading that has all others but for the bulk modulus in it, on which recovery is tried."""
BANDS = ("width_top", "width_end", "peak", *(f"energy_{z}" for z in pads.DEPTHS))
"""Measures of presses whose spread over pads is shown beside the thesis's figures."""
SHOWN = (SCALED, "plate_length", "apex_radius", "fat_thickness", "bone_half_width", SOFT, EPIDERMIS)
"""What the picture of the posterior shows."""

Pads = Mapping[str, Mapping[str, float]]
"""By a pad's name: its unknowns, or what was read of it."""


@dataclass(frozen=True)
class Study:
    """Results of the study.

    Attributes
    ----------
    posteriors : by reading.
    readings, emulator, recovered : tables.
    samples : of all readings, each with its share.
    """

    posteriors: Mapping[str, Posterior]
    readings: pd.DataFrame
    emulator: pd.DataFrame
    recovered: pd.DataFrame
    samples: pd.DataFrame


def emulated(known: Unknowns, evidence: Evidence, design: pd.DataFrame) -> Emulator:
    """An emulator of everything that the fitted rows need, and of the energies by other
    definitions, from the pads that did not fail.
    """
    whole = design[design["diagnosis"].isna() | (design["diagnosis"] == "")]
    needed = [key for key in evidence.keys if key in whole]
    ends = tuple(f": {measure}" for measure in ENERGIES.values())
    keys = list(dict.fromkeys([*needed, *(name for name in whole if name.endswith(ends))]))
    return Emulator.fit(known.to_unit(whole), whole[keys])


def room_of(known: Unknowns, count: int = 256) -> Emulator:
    """An emulator of the fat where it is thinnest, from the first pads of the design."""
    drawn = pd.DataFrame(known.draw()).head(count)
    room = [pads.clearance(pad) for pad in drawn.to_dict("records")]
    return Emulator.fit(known.to_unit(drawn), pd.DataFrame({"pad: clearance": room}))


def study(known: Unknowns, evidence: Evidence, design: pd.DataFrame, trials: int = TRIALS) -> Study:
    """Everything that needs no further simulation."""
    fitted = evidence.of_role("fitted")
    emulator, room = emulated(known, fitted, design), room_of(known)

    def problem(reading: str, measure: str = "energy_915") -> Problem:
        renamed = fitted.rows["measure"].replace("energy_915", measure)
        rows = Evidence(fitted.rows.assign(measure=renamed))
        return Problem(known, reading, emulator.only(rows.keys), rows, room)

    found = {
        definition: {name: infer(problem(name, measure)) for name in known.readings}
        for definition, measure in ENERGIES.items()
    }
    tables = [
        evidences(posteriors.values()).assign(**{"strain energy": definition})
        for definition, posteriors in found.items()
    ]
    readings = pd.concat(tables, ignore_index=True)
    readings["probability (1)"] = probabilities(readings["log evidence (1)"])
    posteriors = next(iter(found.values()))
    return Study(
        posteriors,
        readings,
        pd.concat([emulator.summary(), room.summary()], ignore_index=True),
        recovery(problem(FREEST), trials),
        samples_of(posteriors),
    )


def samples_of(posteriors: Mapping[str, Posterior], count: int = 1500) -> pd.DataFrame:
    """Samples of all readings together, as many of each as its evidence makes it likely: what is
    believed of each unknown.
    """
    share = evidences(posteriors.values()).set_index("reading")["probability (1)"]
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


def chosen_pads(
    posteriors: Mapping[str, Posterior], samples: pd.DataFrame, drawn: int = DRAWN
) -> dict[str, dict[str, float]]:
    """Pads that are simulated under all surfaces: the one chosen before, the best of each reading,
    some drawn.
    """
    chosen = {CHOSEN: dict(pads.CHOSEN_BEFORE)}
    for name, posterior in posteriors.items():
        pad = posterior.problem.pad(posterior.best)
        chosen[f"best of {name}"] = {k: float(v) for k, v in pad.items()}
    rng, count = np.random.default_rng(SEED), min(drawn, len(samples))
    rows = samples.drop(columns="reading").iloc[rng.choice(len(samples), count, replace=False)]
    return chosen | {f"drawn {k}": row for k, row in enumerate(rows.to_dict("records"), start=1)}


def simulate_pads(evidence: Evidence, chosen: Pads) -> dict[str, dict[str, float]]:
    """What is read of pads under all surfaces of the evidence; stated moduli of dermis and fat
    taken for long-term ones.
    """
    surfaces, out = list(evidence.rows["surface"].unique()), {}
    for name, pad in chosen.items():
        result = simulated({k: pad[k] for k in pads.CHOSEN}, surfaces)
        out[name] = result["values"]
        print(name, result["diagnosis"] or "done", result["cpu_s"], flush=True)
    return out


def predicted(evidence: Evidence, chosen: Pads, found: Pads) -> pd.DataFrame:
    """What pads show, row by row of the evidence; simulated, not emulated.

    Columns pad, id, shown, departure (in standard deviations of the row).
    """
    frames = []
    for name, pad in chosen.items():
        shown = evidence.shown(evidence.values(found[name]), pad[SOFT], pad["plate_length"])
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
    """Distance of each pad by family and role, rows inside, and the pad itself: a row a pad."""
    rows = found.merge(evidence.rows[["id", "role", "family"]], on="id")
    rows = rows.assign(squared=rows["departure"] ** 2, inside=rows["departure"] == 0)
    out = []
    for name, of_pad in rows.groupby("pad", sort=False):
        row = {"pad": name} | {k: chosen[name][k] for k in SHOWN}
        for role in ROLES:
            of, title = of_pad[of_pad["role"] == role], role.replace("_", " ")
            row[f"distance, {title} (1)"] = of["squared"].sum(min_count=1)
            row[f"inside, {title}"] = f"{of['inside'].sum()} of {len(of)}"
        fitted = of_pad[of_pad["role"] == "fitted"].groupby("family", sort=False)["squared"].sum()
        out.append(row | fitted.add_suffix(" (1)").to_dict())
    return pd.DataFrame(out)


def reconstruction_inference(job: SimpleNamespace) -> None:
    """Job: `unknowns`, `evidence`, `design` -> `tables` (posterior, readings, emulator, recovery,
    families), `parts` (samples, predicted, bands), `specimen`.
    """
    evidence = Evidence(read_evidence(job.evidence[0]))
    found = study(read_unknowns(job.unknowns[0]), evidence, pd.read_csv(job.design[0]))
    chosen = chosen_pads(found.posteriors, found.samples)
    simulated = simulate_pads(evidence, chosen)
    shown, posterior = (
        predicted(evidence, chosen, simulated),
        posterior_table(found.posteriors, found.samples),
    )
    tables = (
        posterior,
        found.readings,
        found.emulator,
        recovery_table(found.recovered),
        families(evidence, shown, chosen),
    )
    for table, path in zip(tables, job.tables, strict=True):
        publish_table(table, path)
    for part, path in zip((found.samples, shown, bands(chosen, simulated)), job.parts, strict=True):
        write_frame(part, Path(path))
    write_text(job.specimen[0], specimen_text(posterior, found.readings))
