"""The design run: every pad under every surface that is fitted, one process, a record each as soon
as it is done.

    python -m cysyk1999.studies.reconstruction.design RECORDS [SECONDS]

continues where it was stopped and ends after so many seconds of the process, at the end of a pad.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import pandas as pd

from cysyk1999.publishing.tables import write_frame
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.unknowns import Unknowns, read_unknowns
from fingerpad.sweeps.records import Writer, read_records

FITTED = (
    pads.PLATE,
    *pads.SURFACES,
    *(f"{k}{pads.FAST}" for k in ("flat", "158", "1260")),
    pads.STROKED_PLATE,
    pads.WAVY,
)
"""Surfaces that the evidence is read of."""
UNKNOWNS = Path("config/reconstruction/unknowns.yaml")


def run_design(known: Unknowns, records: Path, seconds: float = float("inf")) -> None:
    """Simulate the pads that `records` does not have yet, until so much time of the process has
    gone.
    """
    started, drawn = time.process_time(), pd.DataFrame(known.draw())
    with closing(Writer(records)) as write:
        for number, row in drawn.iterrows():
            if time.process_time() - started > seconds:
                break
            pad = {k: float(f"{v:.6g}") for k, v in row.items()}
            key = f"{number} {json.dumps(pad)}"
            if key not in write.known:
                write({"key": key, "number": number, "pad": pad} | simulated(pad, FITTED))
                print(number, f"{time.process_time() - started:.0f} s", flush=True)


def simulated(pad: Mapping[str, float], surfaces: Sequence[str]) -> dict[str, object]:
    """Of a pad: values by "surface: measure", what went wrong, and the process time."""
    started, values, diagnosis = time.process_time(), {}, ""
    for surface in surfaces:
        try:
            values |= {f"{surface}: {k}": v for k, v in pads.read(pad, surface).items()}
        except Exception as error:  # noqa: BLE001 - one bad pad never stops the design
            diagnosis = " ".join(f"{surface}: {type(error).__name__}: {error}".split())[:300]
            break
    cost = round(time.process_time() - started, 3)
    return {"values": values, "diagnosis": diagnosis, "cpu_s": cost}


def table(records: Path) -> pd.DataFrame:
    """A row a pad: values of the axes, of what was read (NaN where it failed), diagnosis, process
    time.
    """
    rows = [
        {"pad": r["number"], **r["pad"], **pads.with_plane_stress(r["pad"], r["values"])}
        | {k: r[k] for k in ("diagnosis", "cpu_s")}
        for r in read_records(records)
    ]
    return pd.DataFrame(rows).sort_values("pad", ignore_index=True)


if __name__ == "__main__":
    run_design(read_unknowns(UNKNOWNS), Path(sys.argv[1]), *map(float, sys.argv[2:3]))


def reconstruction_design(job: SimpleNamespace) -> None:
    """Job: `unknowns`, `records` -> `design`."""
    records = Path(job.records[0])
    run_design(read_unknowns(job.unknowns[0]), records)
    write_frame(table(records), Path(job.design[0]))
