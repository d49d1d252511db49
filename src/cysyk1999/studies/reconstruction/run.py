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
from cysyk1999.studies.reconstruction.evidence import ROLES, Evidence, read_evidence, values_of
from cysyk1999.studies.reconstruction.inference import (
    EPIDERMIS,
    SOFT,
    Posterior,
    Problem,
    infer,
    recovery,
    shares_of,
)
from cysyk1999.studies.reconstruction.specimen import specimen_text
from cysyk1999.studies.reconstruction.unknowns import SCALED, Unknowns, read_unknowns
from fingerpad.files import write_text

CHOSEN = "chosen one at a time"
ENERGIES = {
    "instantaneous elastic": "energy_915",
    "total stress on long-term moduli": "energy_915_long-term_moduli",
}
"""Definitions of the energy whose curves peak at the ramp's end, as those of the thesis do (trends
TR20, TR21), by measure.
"""
DRAWN, TRIALS, SEED = 12, 10, 1999
"""Pads of the posterior that are simulated; known pads that are to be found again."""
FREEST = "both_free"
"""The reading that has all others but for the bulk modulus in it, on which recovery is tried."""
BANDS = ("width_top", "width_end", "peak", *(f"energy_{z}" for z in pads.DEPTHS))
"""Measures of presses whose spread over pads is shown beside the thesis's figures."""
SHOWN = (SCALED, "plate_length", "apex_radius", "fat_thickness", "bone_half_width", SOFT, EPIDERMIS)
"""What the picture of the posterior shows."""


@dataclass(frozen=True)
class Study:
    """What was found.

    Attributes:
        posteriors: by reading. readings, emulator, recovered: tables. samples: of all readings,
        each with its share.
    """

    posteriors: Mapping[str, Posterior]
    readings: pd.DataFrame
    emulator: pd.DataFrame
    recovered: pd.DataFrame
    samples: pd.DataFrame


def emulated(known: Unknowns, evidence: Evidence, design: pd.DataFrame) -> Emulator:
    """An emulator of all that the fitted rows need, and of the energies by other definitions, from
    the pads that did not fail.
    """
    whole = design[design["diagnosis"].isna() | (design["diagnosis"] == "")]
    keys = [key for key in dict.fromkeys(evidence.keys) if key in whole]
    keys += [
        c for c in whole if any(c.endswith(f": {m}") for m in ENERGIES.values()) and c not in keys
    ]
    return Emulator.fit(
        known.to_unit({name: whole[name].to_numpy() for name in known.axes}), whole[keys]
    )


def roomy(known: Unknowns, count: int = 256) -> Emulator:
    """An emulator of the fat where it is thinnest, of the first pads of the design whatever became
    of them.
    """
    drawn = pd.DataFrame(known.draw()).head(count)
    room = pd.DataFrame(
        {"pad: clearance": [pads.clearance(pad) for pad in drawn.to_dict("records")]}
    )
    return Emulator.fit(known.to_unit({name: drawn[name].to_numpy() for name in known.axes}), room)


def defined_by(evidence: Evidence, measure: str) -> Evidence:
    """The evidence with the strain energy at 915 um taken for another definition."""
    rows = evidence.rows.assign(measure=evidence.rows["measure"].replace("energy_915", measure))
    return Evidence(rows)


def study(known: Unknowns, evidence: Evidence, design: pd.DataFrame, trials: int = TRIALS) -> Study:
    """Everything that needs no further simulation."""
    fitted = evidence.of_role("fitted")
    emulator = emulated(known, fitted, design)
    room, posteriors, tables = roomy(known), {}, []
    for definition, measure in ENERGIES.items():
        rows = defined_by(fitted, measure)
        found = {
            name: infer(Problem(known, name, emulator.only(rows.keys), rows, room))
            for name in known.readings
        }
        print(definition, {name: round(p.log_evidence, 2) for name, p in found.items()}, flush=True)
        tables.append(shares_of(found.values()).assign(**{"strain energy": definition}))
        posteriors = posteriors or found  # of the headline's definition
    readings = pd.concat(tables, ignore_index=True)
    weight = np.exp(readings["log evidence (1)"] - readings["log evidence (1)"].max())
    readings["probability (1)"] = weight / weight.sum()
    recovered = recovery(Problem(known, FREEST, emulator.only(fitted.keys), fitted, room), trials)
    return Study(
        posteriors,
        readings,
        pd.concat([emulator.summary(), room.summary()], ignore_index=True),
        recovered,
        samples_of(posteriors),
    )


def samples_of(posteriors: Mapping[str, Posterior], count: int = 1500) -> pd.DataFrame:
    """Samples of all readings together, as many of each as its evidence makes it likely: what is
    believed of each unknown.
    """
    share = shares_of(posteriors.values()).set_index("reading")["probability (1)"]
    rng, frames = np.random.default_rng(SEED), []
    for name, posterior in posteriors.items():
        pick = rng.integers(len(posterior.samples), size=max(round(count * share[name]), 0))
        pad = posterior.problem.pad(posterior.samples[pick])
        frames.append(pd.DataFrame({"reading": name, **pad}) if len(pick) else pd.DataFrame())
    return pd.concat([f for f in frames if len(f)], ignore_index=True)


def posterior_table(posteriors: Mapping[str, Posterior], samples: pd.DataFrame) -> pd.DataFrame:
    """Intervals of every reading, and of all together by their probabilities."""
    tables = [p.table() for p in posteriors.values()]
    together = tables[0][["quantity", "unit"]].assign(reading="all readings by their probability")
    quantiles = samples[list(together["quantity"])].quantile([0.5, 0.05, 0.95]).T.to_numpy()
    together[["median", "low 5 %", "high 95 %"]] = quantiles
    return pd.concat([together, *tables], ignore_index=True)[list(tables[0].columns)]


def recovery_table(recovered: pd.DataFrame) -> pd.DataFrame:
    """How often each quantity was covered, and all together."""
    by = recovered.groupby("quantity", sort=False)["covered"].agg(["sum", "count"]).reset_index()
    whole = pd.DataFrame(
        [{"quantity": "all", "sum": recovered["covered"].sum(), "count": len(recovered)}]
    )
    return pd.concat([by, whole], ignore_index=True).rename(
        columns={"sum": "covered", "count": "trials"}
    )


def chosen_pads(
    posteriors: Mapping[str, Posterior], samples: pd.DataFrame, drawn: int = DRAWN
) -> dict[str, dict[str, float]]:
    """Pads that are simulated under all surfaces: the one chosen before, the best of each reading,
    some drawn.
    """
    chosen = dict(pads.CHOSEN) | {
        SCALED: pads.CHOSEN["load_over_state"],
        SOFT: 1.0,
        EPIDERMIS: 1.0,
        "plate_length": 10.0,
    }
    found = {CHOSEN: chosen}
    for name, posterior in posteriors.items():
        pad = posterior.problem.pad(posterior.best[None])
        found[f"best of {name}"] = {k: float(v[0]) for k, v in pad.items()}
    pick = np.random.default_rng(SEED).choice(
        len(samples), size=min(drawn, len(samples)), replace=False
    )
    for k, row in enumerate(samples.iloc[pick].to_dict("records"), start=1):
        found[f"drawn {k}"] = {name: float(v) for name, v in row.items() if name != "reading"}
    return found


def simulate_pads(
    evidence: Evidence, chosen: Mapping[str, Mapping[str, float]]
) -> dict[str, dict[str, float]]:
    """What is read of pads under all surfaces of the evidence; stated moduli of dermis and fat
    taken for long-term ones.
    """
    surfaces, out = list(dict.fromkeys(evidence.rows["surface"])), {}
    for name, pad in chosen.items():
        made = simulated({k: pad[k] for k in pads.CHOSEN}, surfaces)
        out[name] = made["values"]
        print(name, made["diagnosis"] or "done", made["cpu_s"], flush=True)
    return out


def predicted(
    evidence: Evidence,
    chosen: Mapping[str, Mapping[str, float]],
    found: Mapping[str, Mapping[str, float]],
) -> pd.DataFrame:
    """What pads show, row by row of the evidence; simulated, not emulated.

    Columns pad, id, shown, departure (in standard deviations of the row).
    """
    frames = []
    for name, pad in chosen.items():
        shown = evidence.shown(
            values_of(found[name], evidence), np.array(pad[SOFT]), np.array(pad["plate_length"])
        )
        frames.append(
            pd.DataFrame(
                {
                    "pad": name,
                    "id": evidence.rows["id"],
                    "shown": shown,
                    "departure": evidence.departure(shown),
                }
            )
        )
    return pd.concat(frames, ignore_index=True)


def bands(
    chosen: Mapping[str, Mapping[str, float]], found: Mapping[str, Mapping[str, float]]
) -> pd.DataFrame:
    """How far the pads drawn from what is believed differ: a row a surface and measure of `BANDS`,
    lowest and highest of them.
    """
    rows = []
    drawn = {name: found[name] for name in chosen if name.startswith("drawn")}
    for key in next(iter(drawn.values())):
        surface, measure = key.split(": ")
        if measure in BANDS and surface in pads.SURFACES:
            unit = pads.MEASURES[measure]
            shown = [
                values[key] * (1.0 if unit in pads.SCALE_FREE else chosen[name][SOFT])
                for name, values in drawn.items()
                if key in values
            ]
            row = {
                "surface": surface,
                "measure": measure,
                "unit": unit,
                "low": min(shown),
                "high": max(shown),
            }
            rows.append(
                row
                | {
                    "pads": len(shown),
                    "source": "pads drawn from the posterior of snakemake reconstruction, simulated",
                }
            )
    return pd.DataFrame(rows)


def families(
    evidence: Evidence, found: pd.DataFrame, chosen: Mapping[str, Mapping[str, float]]
) -> pd.DataFrame:
    """Distance of each pad by family and role, rows inside, and the pad itself: a row a pad."""
    rows = found.merge(evidence.rows[["id", "role", "family"]], on="id")
    rows = rows.assign(squared=rows["departure"] ** 2, inside=rows["departure"] == 0)
    out = []
    for name, each in rows.groupby("pad", sort=False):
        row = {"pad": name, **{k: chosen[name][k] for k in SHOWN}}
        for role in ROLES:
            of = each[each["role"] == role]
            row[f"distance, {role.replace('_', ' ')} (1)"] = of["squared"].sum(min_count=1)
            row[f"inside, {role.replace('_', ' ')}"] = f"{int(of['inside'].sum())} of {len(of)}"
        row |= {
            f"{family} (1)": value
            for family, value in each[each["role"] == "fitted"]
            .groupby("family", sort=False)["squared"]
            .sum()
            .items()
        }
        out.append(row)
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
