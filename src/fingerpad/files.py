"""Files appear whole under their final name or not at all; a folder is written by one process at a time.

And where the package's own files are.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
BUILT_IN = _PACKAGE / "built_in" if (_PACKAGE / "built_in").is_dir() else _PACKAGE.parents[1] / "config"
"""Folder of the built-in `specimens`: config/ of the clone, of which an installed package carries a copy (setup.py)."""

SCRATCH = ".fingerpad-"


def write_atomically(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a temporary file beside ``path`` and then rename it; parents are created."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix)
    os.close(handle)
    try:
        write(Path(name))
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    write_atomically(path, lambda partial: partial.write_text(text, encoding="utf-8"))


@cache
def cache_folder(name: str) -> Path | None:
    """A folder of the user's cache for what is slow to find out again; None where it cannot be written."""
    from platformdirs import user_cache_path

    try:
        folder = user_cache_path("fingerpad", ensure_exists=True) / name
        folder.mkdir(exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


@contextlib.contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Hold a directory for this process; the lock ends with the process, however that ends, and leaves no file.

    Raises:
        BlockingIOError: another process holds it.
    """
    try:
        import fcntl
    except ImportError:  # a system without it has no such lock
        yield
        return
    handle = os.open(directory, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise
        except OSError:  # a file system without locks
            pass
        yield
    finally:
        os.close(handle)


@contextlib.contextmanager
def staged(directory: Path, first: str = "", removing: Iterable[str] = ()) -> Iterator[Path]:
    """A scratch folder whose files appear in ``directory`` only when all of them were written.

    Args:
        directory: an existing folder. first: name of the file that appears before the others. removing: names (relative, with
            "/") of files that go then, unless they were written anew; their folders go when nothing else is in them.

    Raises:
        OSError: something cannot be written; ``directory`` is as it was.
    """
    for leftover in directory.glob(f"{SCRATCH}*"):  # of a process that was killed
        shutil.rmtree(leftover, ignore_errors=True)
    stage = Path(tempfile.mkdtemp(prefix=SCRATCH, dir=directory))
    try:
        yield stage
        written = [item.relative_to(stage).as_posix() for item in stage.rglob("*") if item.is_file()]
        for name in written:
            (directory / name).parent.mkdir(exist_ok=True)
        for name in sorted(written, key=lambda name: (name != first, name)):
            os.replace(stage / name, directory / name)
        for name in set(removing) - set(written):
            (directory / name).unlink(missing_ok=True)
            with contextlib.suppress(OSError):
                if "/" in name:
                    (directory / name).parent.rmdir()
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def disk_is_full(directory: Path, least: int = 1 << 16) -> OSError | None:
    """The error of a full disk, for libraries that do not say why they failed; None when there is room."""
    if shutil.disk_usage(directory).free < least:
        return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return None
