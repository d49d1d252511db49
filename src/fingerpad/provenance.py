"""Which code made a result."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent


BESIDE_A_RUN = (
    "__main__.py",
    "benchmark",
    "cli.py",
    "emulator",
    "measures",
    "picture.py",
    "reference_solutions",
    "sweeps",
)
"""What a simulation does not use, or only its plan, which is kept with its result."""


@cache
def code_digest(folder: Path = PACKAGE, without: tuple[str, ...] = ()) -> str:
    """SHA-256 of the names and contents of all Python files in a folder, and of the
    YAML files of their names, wherever the folder lies.

    Parameters
    ----------
    folder : Path
        The folder (default: this package).
    without : tuple of str
        Files and folders, by the first part of their path, that are left out.

    Returns
    -------
    str
        64 hexadecimal digits.

    Examples
    --------
    >>> len(code_digest())
    64
    """
    whole = hashlib.sha256()
    modules = (p for p in folder.rglob("*.py") if p.relative_to(folder).parts[0] not in without)
    files = (p for module in modules for p in (module, module.with_suffix(".yaml")) if p.is_file())
    for path in sorted(files):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        whole.update(f"{path.relative_to(folder).as_posix()}\0{content}\n".encode())
    return whole.hexdigest()
