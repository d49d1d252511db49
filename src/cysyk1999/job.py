"""A job of the workflow: a function, the files it reads and those it writes.

A study, or any other part of the reproduction, declares its jobs in a module ``jobs``: a function
decorated with `part` takes the `Project` and yields `Job` objects. Its rules follow; nothing else
has to be registered.
"""

from __future__ import annotations

import hashlib
import os
import pkgutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cysyk1999
from cysyk1999.sources import imported_sources

Files = Mapping[str, list[str]]
Jobs = Callable[[Any], "Iterator[Job]"]
"""The jobs of a part, from a project (`cysyk1999.project.Project`)."""
ALL_CORES = 1000
"""Threads of a job that fills the machine; Snakemake gives it as many as there are."""
SILENT = ("files", "scene_files", "measured", "written")
"""Keys that are no words of a job's command: files that it finds by itself, and what only triggers
a rerun.
"""


@dataclass(frozen=True)
class Job:
    """One process of the workflow.

    Parameters
    ----------
    do : callable
        Function of a module that takes a namespace with a list of words for each key of `inputs`,
        `outputs`, `values`.
    inputs, outputs, values : mapping of str to list of str
        Files that are read and written, and parameters, by key. Outputs named ``picture(s)`` and
        ``table(s)`` bring their data and Markdown along.
    name : str
        Name of the rule (default: that of `do`).
    modules : tuple of str
        Further modules that `do` imports by name.
    also : list of str
        Further files that are written.
    labels : mapping
        Labels of the report by output, for outputs named ``pages``; `category` is their heading.
    pdf : str
        Folder of the pictures as PDF; empty for none.
    priority : int
        The higher, the earlier: for jobs that take long or are waited for.
    """

    do: Callable[[SimpleNamespace], None]
    inputs: Files
    outputs: Files
    values: Files = field(default_factory=dict)
    name: str = ""
    modules: tuple[str, ...] = ()
    also: list[str] = field(default_factory=list)
    category: str = ""
    labels: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    pdf: str = ""
    mem_mb: int = 1000
    runtime: int = 10
    priority: int = 0
    threads: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", self.name or self.kind)

    @property
    def kind(self) -> str:
        """Name of the function, without underscore at its end."""
        return self.do.__name__

    @property
    def beside(self) -> list[str]:
        """Files beside the outputs: Markdown of tables, data and PDF of pictures, and `also`."""
        pictures = [Path(p) for key in ("picture", "pictures") for p in self.outputs.get(key, [])]
        tables = [Path(p) for key in ("table", "tables") for p in self.outputs.get(key, [])]
        data = [str(p.with_suffix(".csv")) for p in pictures]
        data += [str(p.with_suffix(".md")) for p in tables]
        return [*data, *(f"{self.pdf}/{p.stem}.pdf" for p in pictures if self.pdf), *self.also]

    @property
    def made(self) -> list[str]:
        """All files that are written."""
        return [*(path for paths in self.outputs.values() for path in paths), *self.beside]

    @property
    def read(self) -> list[str]:
        """All files that are read, the sources apart."""
        return [path for paths in self.inputs.values() for path in paths]

    @property
    def words(self) -> list[tuple[str, str]]:
        """Where in the rule each key of the command stands (input, output, params), and the key."""
        places = (("input", self.inputs), ("output", self.outputs), ("params", self.values))
        return [(place, key) for place, keys in places for key in keys if key not in SILENT]

    @property
    def sources(self) -> list[str]:
        """Source files that the job imports, directly or not."""
        modules = ("cysyk1999.workflow.__main__", self.do.__module__, *self.modules)
        return [os.path.relpath(path) for path in imported_sources(*modules)]

    @property
    def code(self) -> str:
        """`sources` with their digests, a line a file."""
        return "".join(f"{digest(os.path.abspath(path))}  {path}\n" for path in self.sources)


@cache
def digest(path: str) -> str:
    """First half of a file's SHA-256."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:32]


@dataclass(frozen=True)
class Part:
    """Jobs that belong together; its name is a target of the workflow."""

    name: str
    jobs: Jobs
    in_default: bool
    extra: str

    @property
    def title(self) -> str:
        """The docstring: what ``snakemake --list`` shows."""
        return " ".join((self.jobs.__doc__ or "").split())


_PARTS: dict[str, Part] = {}


def part(name: str, in_default: bool = False, extra: str = "") -> Callable:
    """Decorate a function that yields the jobs of a part.

    Parameters
    ----------
    name : str
        Name of the part, a target of the workflow.
    in_default : bool
        Whether ``snakemake`` alone makes it.
    extra : str
        Package that only this part needs and an extra of its name's brings; without it the target
        makes nothing, and says so.
    """

    def register(jobs: Jobs) -> Callable:
        _PARTS[name] = Part(name, jobs, in_default, extra)
        return jobs

    return register


@cache
def parts() -> Mapping[str, Part]:
    """All parts by name: those of every module ``jobs`` in this package."""
    for module in pkgutil.walk_packages(cysyk1999.__path__, "cysyk1999."):
        if module.name.endswith(".jobs"):
            import_module(module.name)
    return _PARTS
