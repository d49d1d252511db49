"""Which code made a result."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent


@cache
def code_digest(folder: Path = PACKAGE) -> str:
    """SHA-256 of the names and contents of all Python files in a folder, wherever the folder lies.

    Examples
    --------
    >>> len(code_digest())
    64
    """
    whole = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        whole.update(f"{path.relative_to(folder).as_posix()}\0{content}\n".encode())
    return whole.hexdigest()
