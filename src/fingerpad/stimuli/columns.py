"""What files of profiles and of courses have in common: columns named with their unit, and how a
scene names a file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from fingerpad.documents import Problem
from fingerpad.files import expanded
from fingerpad.tables import Table, TableError
from fingerpad.units import QuantityError, parse_quantity


def read_file(
    data: Mapping[str, Any],
    key: str,
    context: Any,
    read: Callable[[Path], Any],
    allowed: str = "the path of a CSV file",
) -> tuple[Path, Any]:
    """The absolute path of the file that a document names at a key, and what is read from it.

    Raises
    ------
    Problem
        At the key: it is no path, or the file cannot be read.
    """
    name = data.get(key)
    if not isinstance(name, (str, Path)):
        raise Problem("is not a path", "the path of a CSV file", (key,))
    path = expanded(name).absolute() if context is None else context.resolve(name)
    try:
        return path, read(path)
    except FileNotFoundError:
        problem = "is not an existing file"
    except TableError as error:
        problem, allowed = error.problem, error.allowed
    except (OSError, ValueError) as error:
        problem = f"cannot be read ({getattr(error, 'strerror', None) or type(error).__name__})"
    raise Problem(problem, allowed, (key,))


def columns_with_units(
    table: Table, dimensions: Mapping[str, str], allowed: str
) -> dict[str, tuple[int, float]]:
    """Name -> number of the column called so, and its unit in SI.

    A header is the name with its unit: `x (mm)`, `x [mm]`, `x / mm` or `x_mm`. Other columns are
    passed over.

    Parameters
    ----------
    table : Table
    dimensions : mapping of str to str
        Name -> dimension, such as "length".
    allowed : str
        What would be right, for the error's line.

    Raises
    ------
    TableError
        A unit is not of its dimension, or two columns are of the same name.
    """
    names = "|".join(dimensions)
    column = re.compile(rf"\s*({names})(?:\s*[(\[](.*)[)\]]|\s*/\s*(.*)|_(.*))\s*", re.IGNORECASE)
    found = {}
    for k, header in enumerate(table.header):
        if match := column.fullmatch(header):
            name = match[1].lower()
            unit = next(part for part in match.groups()[1:] if part is not None)
            if name in found:
                both = f"'{table.header[found[name][0]][:30]}' and '{header[:30]}'"
                raise TableError(f"has two columns of {name}: {both}", f"one column of {name}")
            try:
                found[name] = k, parse_quantity(f"1 {unit}", dimensions[name])
            except QuantityError as error:
                problem = f"has the column '{header[:40]}', which {error.problem}"
                raise TableError(problem, allowed) from None
    return found
