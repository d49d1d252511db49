"""What is known of scenes that were run: a line of JSON each, written at once; whatever kills the
writer, whole lines stay.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from fingerpad.scenes.scene import Scene

UNFINISHED = ".part"
"""Ending of the records of a batch that is under way, after its name; .jsonl when it is done."""


@cache
def code() -> str:
    """Digest of all that makes the numbers of a scene: the files of this package and of those with
    measures, and the libraries' versions.
    """
    from fingerpad.measures.known import plugins
    from fingerpad.provenance import code_digest
    from fingerpad.results import provenance

    files = [code_digest(), *(code_digest(folder) for folder in plugins())]
    libraries = {
        name: version for name, version in provenance()["packages"].items() if name != "fingerpad"
    }
    return hashlib.sha256(json.dumps([files, libraries], sort_keys=True).encode()).hexdigest()[:16]


def key_of(scene: Scene, keep: tuple[str, ...], histories: bool) -> str:
    """What a scene's record is known by: a digest of its content, of what is kept of it, and of the
    code.
    """
    content = {
        name: part for name, part in scene.canonical().items() if name not in ("name", "tags")
    }
    said = json.dumps([content, list(keep), histories, code()], sort_keys=True)
    return hashlib.sha256(said.encode()).hexdigest()[:20]


def read_records(path: Path) -> Iterator[dict[str, Any]]:
    """The records of a file; a line that was not written to its end, and what follows, is left
    out.
    """
    with path.open("rb") as lines:
        for line in lines:
            if not line.endswith(b"\n"):
                return
            try:
                yield json.loads(line)
            except ValueError:
                return


class Writer:
    """Appends records to a file, each on the disk before the next scene starts."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.known = {record["key"] for record in read_records(path)} if path.exists() else set()
        whole = sum(len(line) for line in _whole(path)) if path.exists() else 0
        self._file = path.open("ab")
        self._file.truncate(whole)

    def __call__(self, record: dict[str, Any]) -> None:
        """Raises OSError, on a full disk for example; what was written before is whole."""
        self._file.write(json.dumps(record).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        self._file.close()


def _whole(path: Path) -> Iterator[bytes]:
    with path.open("rb") as lines:
        for line in lines:
            try:
                json.loads(line)
            except ValueError:
                return
            if not line.endswith(b"\n"):
                return
            yield line
