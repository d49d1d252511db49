"""From the records of a sweep to one labelled dataset and one table.

Records are read one by one; what is held is one column of numbers for each measure.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.files import disk_is_full, write_atomically
from fingerpad.sweeps.engine import read_layout
from fingerpad.sweeps.records import read_records

FAILED = {"long_name": "whether the scene could not be simulated", "units": "1"}
DIAGNOSIS = {"long_name": "why the scene could not be simulated"}
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
    data = xr.Dataset(
        {name: (tuple(sizes), c.reshape(shape), about) for name, (c, about) in columns.items()},
        {p["name"]: _coordinate(p) for p in design["parameters"]},
        design["about"]
        | {"scenes": len(design["keys"]), "failed": int(columns["failed"][0].sum())},
    )
    numeric = [name for name in columns if name not in ("failed", "diagnosis")]
    encoding = {name: {"zlib": True, "complevel": 1} for name in numeric}

    def write(partial: Path) -> None:
        try:
            data.to_netcdf(partial, engine="netcdf4", encoding=encoding)
        except RuntimeError as error:  # netCDF4's error for a full disk
            raise disk_is_full(partial.parent) or OSError(str(error)) from error

    write_atomically(dataset, write)
    write_atomically(table, lambda partial: _tabulate(design, columns, partial))


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
    keys, numbers = design["keys"], {}
    others = {p["name"] for p in design["parameters"]} | set(design["dimensions"])
    for number, key in enumerate(keys):
        numbers.setdefault(key, []).append(number)
    failed, diagnosis = np.full(len(keys), -1, "i1"), np.full(len(keys), "", object)
    columns = {"failed": (failed, FAILED), "diagnosis": (diagnosis, DIAGNOSIS)}
    for name, (unit, text) in RUN.items():
        columns[name] = np.full(len(keys), np.nan), {"units": unit, "long_name": text}
    names: dict[tuple[str, str], str] = {}
    for record in (record for file in records for record in read_records(file)):
        wrong = record["diagnosis"]
        at = [n for n in numbers.get(record["key"], ()) if failed[n] < 0 or failed[n] > bool(wrong)]
        failed[at], diagnosis[at] = bool(wrong), wrong
        for name in RUN:
            columns[name][0][at] = record.get(name, np.nan)
        for quantity, condition, unit, value in record["measures"] if at else ():
            if (quantity, condition) not in names:
                name = names[quantity, condition] = _name(
                    quantity, condition, others | set(columns)
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


def _tabulate(design: Mapping[str, Any], columns: Mapping[str, Any], path: Path) -> None:
    """A row a scene: number, parameters, measures with their units, errors, diagnosis."""
    last = [*RUN, "failed", "diagnosis"]
    number = np.arange(len(design["keys"]))
    places = np.unravel_index(number, tuple(design["dimensions"].values()))
    place = dict(zip(design["dimensions"], places, strict=True))
    table = {"scene": number}
    for p in design["parameters"]:
        values = np.array(p["values"], object)
        table[_header(p["name"], p["unit"])] = values[place[p["dimension"]]]
    for name in [*(name for name in columns if name not in last), *last]:
        values, about = columns[name]
        unit = about.get("units", "") if name != "failed" else ""
        counts = name in ("nodes", "steps", "iterations")
        table[_header(name, unit)] = pd.array(values, "Int64") if counts else values
    pd.DataFrame(table).to_csv(path, index=False, lineterminator="\n")


def _header(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name
