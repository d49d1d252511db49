"""From records to one labelled dataset and one table, written in a stream: what is held does not
grow with their number.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.files import disk_is_full, write_atomically
from fingerpad.sweeps.engine import read_layout
from fingerpad.sweeps.records import read_records

BLOCK = 500
"""Scenes that are held at once."""
ABOUT = {
    "estimated_error": (
        "1",
        "relative error that the run estimates of depth, width, pressure and strain energy",
    ),
    "cpu_s": ("s", "process time of the simulation"),
    "nodes": ("1", "nodes of the mesh that was solved on"),
    "steps": ("1", "time steps or load increments"),
    "iterations": ("1", "Newton iterations"),
}
"""What a scene's record says beside its measures: name -> unit, long name."""


def collect(design: Mapping[str, Any], records: Iterable[Path], dataset: Path, table: Path) -> None:
    """Write the NetCDF dataset and the CSV table of a sweep.

    Args:
        design: the sweep as it was laid out (`fingerpad.sweeps.engine`): dimensions, parameters,
        keys. records: their files.

    Raises:
        ValueError: a scene has no record. OSError: a file cannot be written.
    """

    def write(partial: Path) -> None:
        try:
            _write(design, records, partial)
        except RuntimeError as error:  # what netCDF makes of an error of the disk
            raise disk_is_full(partial.parent) or OSError(str(error)) from error

    write_atomically(dataset, write)
    write_atomically(table, lambda partial: _tabulate(design, dataset, partial))


def collect_layout(folder: Path, dataset: Path, table: Path) -> None:
    """Collect the sweep that is laid out in a folder."""
    layout = read_layout(folder)
    design = json.loads((folder / "design.json").read_text(encoding="utf-8"))
    files = [*layout.known, *(f"batches/{name}.jsonl" for name in layout.batches)]
    collect(design, [folder / name for name in files], dataset, table)


def _write(design: Mapping[str, Any], records: Iterable[Path], path: Path) -> None:
    import netCDF4

    dimensions: dict[str, int] = design["dimensions"]
    numbers: dict[str, list[int]] = {}
    for number, key in enumerate(design["keys"]):
        numbers.setdefault(key, []).append(number)
    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        for name, size in dimensions.items():
            file.createDimension(name, size)
        _coordinates(file, design["parameters"])
        file.setncatts(design["about"])
        out = _Out(file, dimensions)
        done = np.zeros(len(design["keys"]), bool)
        failed = np.zeros(len(design["keys"]), bool)
        for block in _blocks(record for each in records for record in read_records(each)):
            columns: dict[str, dict[int, Any]] = {}
            for record in block:
                for number in numbers.get(record["key"], ()):
                    if done[number] or (failed[number] and record["diagnosis"]):
                        continue  # once is enough, and a success counts more than a failure
                    done[number], failed[number] = (
                        not record["diagnosis"],
                        bool(record["diagnosis"]),
                    )
                    for name, value in _values(record, out):
                        columns.setdefault(name, {})[number] = value
            for name, values in columns.items():
                out.write(name, values)
        if not (done | failed).all():
            raise ValueError(
                f"{int((~(done | failed)).sum())} scenes have no record: run the sweep again"
            )
        file.setncatts({"scenes": len(done), "failed": int(failed.sum())})


def _blocks(records: Iterator[dict]) -> Iterator[list[dict]]:
    while block := list(islice(records, BLOCK)):
        yield block


def _values(record: Mapping[str, Any], out: _Out) -> Iterator[tuple[str, Any]]:
    """What a record says, by the name of its variable."""
    yield "failed", int(bool(record["diagnosis"]))
    yield "diagnosis", record["diagnosis"]
    for quantity, condition, unit, value in record["measures"]:
        yield out.measure(quantity, condition, unit), value
    for name in ABOUT:
        if name in record:
            yield name, record[name]


class _Out:
    """The variables of a dataset, made when they are first met."""

    def __init__(self, file: Any, dimensions: Mapping[str, int]) -> None:
        self._file, self._shape = file, tuple(dimensions.values())
        self._names: dict[tuple[str, str], str] = {}
        self._variables: dict[str, Any] = {}
        self._make(
            "failed",
            "i1",
            {"long_name": "whether the scene could not be simulated", "units": "1"},
            0,
        )
        self._make("diagnosis", str, {"long_name": "why the scene could not be simulated"})
        for name, (unit, said) in ABOUT.items():
            self._make(name, "f8", {"units": unit, "long_name": said})

    def _make(
        self, name: str, kind: Any, attributes: Mapping[str, str], fill: Any = np.nan
    ) -> None:
        how = {} if kind is str else {"fill_value": fill, "zlib": True, "complevel": 1}
        if kind == "i1":
            how.pop("fill_value")
        variable = self._file.createVariable(name, kind, self._file.dimensions.keys(), **how)
        variable.setncatts(attributes)
        self._variables[name] = variable

    def measure(self, quantity: str, condition: str, unit: str) -> str:
        """The variable of a measure."""
        if (quantity, condition) not in self._names:
            signed = re.sub(r"-(?=[\d.])", "minus ", f"{quantity} {condition}".strip())
            name = re.sub(r"\W+", "_", signed)
            while (
                name in self._file.variables
            ):  # of a parameter, or of another measure: no table is lost for a name
                name += "_"
            said = f"{quantity.replace('_', ' ')}{', ' if condition else ''}{condition}"
            self._make(
                name,
                "f8",
                {"units": unit, "long_name": said, "quantity": quantity, "condition": condition},
            )
            self._names[quantity, condition] = name
        return self._names[quantity, condition]

    def write(self, name: str, values: Mapping[int, Any]) -> None:
        """Values by the number of the scene, in runs along the last dimension."""
        variable, last = self._variables[name], self._shape[-1]
        run: list[int] = []
        for number in [*sorted(values), None]:
            if run and (number is None or number != run[-1] + 1 or number % last == 0):
                *place, first = (int(k) for k in np.unravel_index(run[0], self._shape))
                whole = np.array([values[n] for n in run], object if name == "diagnosis" else float)
                variable[(*place, slice(first, first + len(run)))] = whole
                run = []
            run.append(number)


def _coordinates(file: Any, parameters: list[Mapping[str, Any]]) -> None:
    beside = []
    for p in parameters:
        text = not p["unit"]
        variable = file.createVariable(p["name"], str if text else "f8", (p["dimension"],))
        variable[:] = (
            np.array([str(v) for v in p["values"]], object)
            if text
            else np.array(p["values"], float)
        )
        attributes = {"long_name": p["key"], "units": p["unit"], "source": p["source"]}
        variable.setncatts({name: value for name, value in attributes.items() if value})
        if p["name"] != p["dimension"]:
            beside.append(p["name"])
    if beside:
        file.setncattr("coordinates", " ".join(beside))


def _tabulate(design: Mapping[str, Any], dataset: Path, path: Path) -> None:
    """A row a scene: its number, its parameters, the measures with their units, errors,
    diagnosis.
    """
    import netCDF4

    shape, total = tuple(design["dimensions"].values()), len(design["keys"])
    with netCDF4.Dataset(dataset) as file, path.open("w", newline="", encoding="utf-8") as lines:
        table = csv.writer(lines, lineterminator="\n")
        own = {p["name"] for p in design["parameters"]}
        last = ["estimated_error", "cpu_s", "nodes", "steps", "iterations", "failed", "diagnosis"]
        names = [*(name for name in file.variables if name not in own and name not in last), *last]
        headers = [
            f"{p['name']} ({p['unit']})" if p["unit"] else p["name"] for p in design["parameters"]
        ]
        units = [getattr(file[name], "units", "") for name in names]
        heads = [
            f"{name} ({unit})" if unit and name not in ("failed", "diagnosis") else name
            for name, unit in zip(names, units, strict=True)
        ]
        table.writerow(["scene", *headers, *heads])
        axes = list(design["dimensions"])
        # a slab of the first dimension is whole scenes one after the other
        inner = max(int(np.prod(shape[1:])), 1)
        slab = max(BLOCK // inner, 1)
        for start in range(0, shape[0], slab):
            columns = [
                np.ma.filled(
                    file[name][start : start + slab], np.nan if name != "diagnosis" else ""
                )
                for name in names
            ]
            columns = [np.asarray(column).reshape(-1) for column in columns]
            for k in range(len(columns[0])):
                number = start * inner + k
                place = dict(zip(axes, np.unravel_index(number, shape), strict=True))
                given = [p["values"][int(place[p["dimension"]])] for p in design["parameters"]]
                table.writerow([number, *given, *(_cell(column[k]) for column in columns)])
        assert number + 1 == total


def _cell(value: Any) -> Any:
    if isinstance(value, str):
        return value
    value = float(value)
    return (
        ""
        if np.isnan(value)
        else int(value)
        if value.is_integer() and abs(value) < 1e15
        else repr(value)
    )


def open_sweep(folder: str | Path) -> Any:
    """The dataset of a sweep, opened, not read: an `xarray.Dataset`."""
    import xarray as xr

    return xr.open_dataset(Path(folder) / "sweep.nc", engine="netcdf4")
