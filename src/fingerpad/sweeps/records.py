"""Records of scenes that were run: a line of JSON each, written at once.

Whatever kills the writer, whole lines stay.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from fingerpad.measures.known import plugins
from fingerpad.provenance import code_digest
from fingerpad.results import provenance
from fingerpad.scenes.scene import Scene

UNFINISHED = ".part"
"""Ending of the records of a batch that is under way, in place of .jsonl."""


@cache
def code() -> str:
    """Digest of what makes the numbers of a scene: this package, those with measures, libraries."""
    files = [code_digest(), *(code_digest(folder) for folder in plugins())]
    packages = provenance()["packages"]
    libraries = {name: version for name, version in packages.items() if name != "fingerpad"}
    return hashlib.sha256(json.dumps([files, libraries], sort_keys=True).encode()).hexdigest()[:16]


def key_of(scene: Scene, keep: tuple[str, ...], histories: bool) -> str:
    """Digest of a scene's content, of what is kept of it, and of the code: its record's key."""
    content = {k: part for k, part in scene.canonical().items() if k not in ("name", "tags")}
    text = json.dumps([content, list(keep), histories, code()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:20]


def read_records(path: Path) -> Iterator[dict[str, Any]]:
    """The records of a file up to the first line that was not written to its end."""
    with path.open("rb") as lines:
        for line in lines:
            try:
                record = json.loads(line)
            except ValueError:
                return
            if not line.endswith(b"\n"):
                return
            yield record


class Writer:
    """Appends records to a file, each on the disk before the next scene starts.

    Attributes
    ----------
    known : set of str
        Keys of the records in the file.
    """

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("a+b")
        self._file.seek(0)
        self.known, whole = set(), 0
        for record, line in zip(read_records(path), self._file, strict=False):
            self.known.add(record["key"])
            whole += len(line)
        self._file.truncate(whole)

    def __call__(self, record: dict[str, Any]) -> None:
        """Raises OSError, on a full disk for example; what was written before is whole."""
        self._file.write(json.dumps(record).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        self._file.close()
