"""From the records of a sweep to one labelled dataset and one table.

Records are read one by one; what is held is one column of numbers for each measure.
"""

from __future__ import annotations

import json
import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.files import write_atomically
from fingerpad.results import write_dataset
from fingerpad.sweeps.engine import read_layout
from fingerpad.sweeps.records import read_records

FAILED = {"long_name": "whether the scene could not be simulated", "units": "1"}
TEXTS = {
    "diagnosis": {"long_name": "why the scene could not be simulated"},
    "doubts": {"long_name": "why the run doubts itself"},
    "relaxed": {"long_name": "what was relaxed, as the run was in trouble"},
}
RUN = {
    "estimated_error": (
        "1",
        "relative error that the run estimates of depth, width, pressure and strain energy",
    ),
    "cpu_s": ("s", "process time of the simulation"),
    "nodes": ("1", "nodes of the mesh that was solved on"),
    "steps": ("1", "time steps or load increments"),
    "iterations": ("1", "Newton iterations"),
}
"""Entries of a record beside its measures: name -> unit, long name."""


def collect(design: Mapping[str, Any], records: Iterable[Path], dataset: Path, table: Path) -> None:
    """Write the NetCDF dataset and the CSV table of a sweep.

    Parameters
    ----------
    design : dict
        The content of design.json (`fingerpad.sweeps.engine`): dimensions, parameters, keys.
    records : iterable of Path
        Files of records; of a scene with several records, a success replaces a failure.
    dataset, table : Path
        Files to write.

    Raises
    ------
    ValueError
        A scene has no record.
    OSError
        A file cannot be written.
    """
    columns = _columns(design, records)
    sizes = design["dimensions"]
    shape = tuple(sizes.values())
    counts = {"scenes": len(design["keys"]), "failed": int(columns["failed"][0].sum())}
    counts["doubted"] = int(np.count_nonzero(columns["doubts"][0] != ""))
    data = xr.Dataset(
        {name: (tuple(sizes), c.reshape(shape), about) for name, (c, about) in columns.items()},
        {p["name"]: _coordinate(p) for p in design["parameters"]},
        design["about"] | counts,
    )
    packed = {"zlib": True, "complevel": 1}
    encoding = dict.fromkeys(columns.keys() - {"failed", *TEXTS}, packed)

    write_atomically(dataset, partial(write_dataset, data, encoding))
    frame = _table(data, list(columns))
    write_atomically(table, partial(frame.to_csv, index=False, lineterminator="\n"))


def collect_layout(folder: Path, dataset: Path, table: Path) -> None:
    """Collect the sweep that is laid out in a folder."""
    layout = read_layout(folder)
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    files = [*layout.known, *(f"batches/{name}.jsonl" for name in layout.batches)]
    collect(design, [folder / name for name in files], dataset, table)


def _columns(
    design: Mapping[str, Any], records: Iterable[Path]
) -> dict[str, tuple[np.ndarray, dict[str, str]]]:
    """Name of each variable -> its values, one a scene, and its attributes."""
    keys, numbers = design["keys"], defaultdict(list)
    for number, key in enumerate(keys):
        numbers[key].append(number)
    failed = np.full(len(keys), -1, "i1")
    columns = {"failed": (failed, FAILED)}
    columns |= {name: (np.full(len(keys), "", object), about) for name, about in TEXTS.items()}
    for name, (unit, text) in RUN.items():
        columns[name] = np.full(len(keys), np.nan), {"units": unit, "long_name": text}
    taken = {p["name"] for p in design["parameters"]} | set(design["dimensions"])
    names: dict[tuple[str, str], str] = {}
    for record in (record for file in records for record in read_records(file)):
        wrong = record["diagnosis"]
        at = [n for n in numbers.get(record["key"], ()) if failed[n] < 0 or failed[n] > bool(wrong)]
        if not at:
            continue
        failed[at] = bool(wrong)
        for name in TEXTS:
            columns[name][0][at] = record.get(name, "")
        for name in RUN:
            columns[name][0][at] = record.get(name, np.nan)
        for quantity, condition, unit, value in record["measures"]:
            if (quantity, condition) not in names:
                name = names[quantity, condition] = _name(
                    quantity, condition, taken | columns.keys()
                )
                about = {"units": unit, "long_name": _long_name(quantity, condition)}
                about |= {"quantity": quantity, "condition": condition}
                columns[name] = np.full(len(keys), np.nan), about
            columns[names[quantity, condition]][0][at] = value
    if missing := int((failed < 0).sum()):
        raise ValueError(f"{missing} scenes have no record: run the sweep again")
    return columns


def _name(quantity: str, condition: str, taken: Iterable[str]) -> str:
    """A variable's name for a measure, which no other variable has."""
    signed = re.sub(r"-(?=[\d.])", "minus ", f"{quantity} {condition}".strip())
    name = re.sub(r"\W+", "_", signed)
    while name in taken:
        name += "_"
    return name


def _long_name(quantity: str, condition: str) -> str:
    return ", ".join(filter(None, [quantity.replace("_", " "), condition]))


def _coordinate(parameter: Mapping[str, Any]) -> tuple[str, np.ndarray, dict[str, str]]:
    """Dimension, values and attributes of a parameter."""
    if parameter["unit"]:
        values = np.array(parameter["values"], float)
    else:
        values = np.array([str(value) for value in parameter["values"]], object)
    about = {"long_name": "key", "units": "unit", "source": "source"}
    attributes = {name: parameter[key] for name, key in about.items() if parameter[key]}
    return parameter["dimension"], values, attributes


def _table(data: xr.Dataset, variables: list[str]) -> pd.DataFrame:
    """A row a scene: number, parameters, measures with their units, errors, diagnosis."""
    last = [*RUN, "doubts", "relaxed", "failed", "diagnosis"]
    names = [*data.coords, *(name for name in variables if name not in last), *last]
    frame = data.to_dataframe().reset_index()[names]
    frame = frame.astype(dict.fromkeys(("nodes", "steps", "iterations"), "Int64"))
    units = {name: data[name].attrs.get("units") for name in names if name != "failed"}
    headers = {name: f"{name} ({unit})" for name, unit in units.items() if unit}
    frame.insert(0, "scene", range(len(frame)))
    return frame.rename(columns=headers)
