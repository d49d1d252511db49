"""The source files that a job rests on, found by following its imports.

The workflow names them as inputs of its rules: an edit reruns what it can change and nothing else.
"""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

import grimp

import fingerpad

PACKAGES = ("fingerpad", "cysyk1999")
REGISTERS = ("fingerpad.laws", "fingerpad.planning.effects")
"""Packages that import the files in them without naming one."""
ONLY_LOOKED_AT = ("fingerpad.results", "fingerpad.picture")
"""An import that no job comes to: ``plot()`` of a history is for people."""


@cache
def _imports() -> grimp.ImportGraph:
    graph = grimp.build_graph(
        *PACKAGES, exclude_type_checking_imports=True, cache_dir=".snakemake/grimp"
    )
    importer, imported = ONLY_LOOKED_AT
    graph.remove_import(importer=importer, imported=imported)
    return graph


@cache
def _upstream(module: str) -> frozenset[str]:
    return frozenset(_imports().find_upstream_modules(module) | {module})


def imported_sources(*modules: str) -> list[Path]:
    """Files of the two packages that some modules import, directly or not, and their own.

    Parameters
    ----------
    modules : str
        Dotted names, such as ``"fingerpad.mechanics.stepping"``.

    Returns
    -------
    list of Path
        Sorted, each once.

    Raises
    ------
    grimp.exceptions.ModuleNotPresent
        There is no such module.

    Notes
    -----
    Imports inside functions count, but not `ONLY_LOOKED_AT`; those under ``TYPE_CHECKING`` do not.
    A module rests on what its package imports, and on the YAML file of its name beside it. Who
    imports a verb from ``fingerpad`` rests on the modules of all verbs; who imports one of
    `REGISTERS`, on its files.
    """
    found: set[str] = set()
    todo = set(modules)
    while todo:
        found |= todo.union(*map(_upstream, todo))
        unnamed = set(fingerpad.HOMES.values()) if "fingerpad" in found else set()
        unnamed = unnamed.union(*map(_imports().find_children, found.intersection(REGISTERS)))
        todo = ({name.rpartition(".")[0] for name in found} | unnamed) - found - {"", "fingerpad"}
    files = [_file(name) for name in found | {name.partition(".")[0] for name in found}]
    data = (file.with_suffix(".yaml") for file in files)
    return sorted([*files, *(file for file in data if file.exists())])


@cache
def _file(module: str) -> Path:
    package, _, rest = module.partition(".")
    base = Path(find_spec(package).origin).parent.joinpath(*rest.split(".") if rest else ())
    return base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
