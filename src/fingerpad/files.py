"""Files appear whole under their final name or not at all; one process at a time writes a folder.

Also the reading of users' files, and the place of the package's own files.
"""

from __future__ import annotations

import contextlib
import errno
import fcntl
import glob
import os
import platform
import select
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
BUILT_IN = (
    _PACKAGE / "built_in" if (_PACKAGE / "built_in").is_dir() else _PACKAGE.parents[1] / "config"
)
"""Folder of the built-in `specimens`: config/ of the clone, of which an installed package carries a
copy (setup.py).
"""

SCRATCH = ".fingerpad-"


class WrongInput(ValueError):
    """Something that a person wrote is wrong.

    Attributes
    ----------
    problem : str
        What is wrong, written to follow what it is about.
    allowed : str
        What would be right.
    """

    def __init__(self, problem: str, allowed: str) -> None:
        super().__init__(f"{problem}; allowed: {allowed}")
        self.problem, self.allowed = problem, allowed


MOST_BYTES = {"text": 1 << 20, "table": 1 << 25, "mesh": 1 << 28}
"""Of a file that somebody brings: a scene or a sweep, a profile or a table of measured data, a
mesh.
"""
PATIENCE = 4.0
"""s that a pipe may be silent."""


def read_input(path: str | Path, kind: str) -> bytes:
    """The content of a user's file, without waiting for it and up to a size.

    Parameters
    ----------
    path : path
        The file; a pipe may be silent for `PATIENCE` seconds.
    kind : str
        A key of `MOST_BYTES`.

    Raises
    ------
    OSError
        There is no such file, it cannot be read, is a device or too large, or is a pipe that nobody
        writes to; its ``strerror`` says so.
    ValueError
        The path cannot be one.
    """
    most = MOST_BYTES[kind]
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))
    try:
        state = os.fstat(handle)
        if stat.S_ISDIR(state.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        piped = stat.S_ISFIFO(state.st_mode)
        if not piped and not stat.S_ISREG(state.st_mode):
            raise OSError(errno.ENODEV, "a device, not a file")
        content, size = bytearray(), state.st_size
        while size <= most:
            if piped and not select.select([handle], [], [], PATIENCE)[0]:
                raise TimeoutError(errno.ETIMEDOUT, "a pipe that nobody writes to")
            part = os.read(handle, 1 << 20)
            if not part:
                return bytes(content)
            content += part
            size = len(content)
        raise OSError(errno.EFBIG, f"more than {most / 1e6:.3g} MB")
    finally:
        os.close(handle)


def expanded(path: str | Path) -> Path:
    """A path with ``~`` replaced by the home it stands for, where there is one."""
    return Path(os.path.expanduser(path))


def is_file(path: str | Path) -> bool:
    """Whether there is such a file; unlike `Path.is_file` also for what can be no path, of too many
    letters for example.
    """
    return os.path.isfile(path)


def write_atomically(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a temporary file beside ``path`` and then rename it; parents are
    created.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    _remove_leftovers(path)
    handle, name = tempfile.mkstemp(
        dir=path.parent, prefix=f".{path.name}.{_HOST}-{os.getpid()}.", suffix=path.suffix
    )
    os.close(handle)
    try:
        write(Path(name))
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


_HOST = "".join(filter(str.isalnum, platform.node()))[:20]


def _remove_leftovers(path: Path) -> None:
    """Temporary files for ``path`` of processes of this machine that were killed."""
    for leftover in path.parent.glob(f".{glob.escape(path.name)}.{_HOST}-*.*{path.suffix}"):
        process = leftover.name.removeprefix(f".{path.name}.{_HOST}-").partition(".")[0]
        if process.isdigit() and not _lives(int(process)):
            leftover.unlink(missing_ok=True)


def _lives(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it is another user's
        return True
    return True


def unusable(path: Path) -> str:
    """What in a path's name the NetCDF library cannot take, in words; "" where there is nothing."""
    if "\\" in str(path):
        return "a backslash"
    return (
        "a space at the end of a part" if any(part != part.strip() for part in path.parts) else ""
    )


def write_text(path: str | Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    write_atomically(path, lambda partial: partial.write_text(text, encoding="utf-8"))


class InUse(BlockingIOError):
    """Another process writes into a directory."""


@contextlib.contextmanager
def locked(directory: str | Path) -> Iterator[tuple[int, ...]]:
    """Lock a directory for this process; the lock ends with the process and leaves no file.

    Yields
    ------
    tuple of int
        Descriptors of the lock: a process to which they are passed holds it too.

    Raises
    ------
    BlockingIOError
        Another process holds it (`InUse`).
    """
    handle = os.open(directory, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InUse(f"'{directory}' is being written by another process") from None
        except OSError:
            pass  # of a file system without locks
        yield (handle,)
    finally:
        os.close(handle)


def files_below(folder: Path) -> set[str]:
    """Relative names (with "/") of all files below a folder."""
    return {file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()}


@contextlib.contextmanager
def staged(directory: Path, first: str = "", removing: Iterable[str] = ()) -> Iterator[Path]:
    """A scratch folder whose files appear in ``directory`` only when all of them were written.

    Parameters
    ----------
    directory : Path
        An existing folder.
    first : str
        Name of the file that appears before the others.
    removing : iterable of str
        Relative names (with "/") of files that are removed then, unless they were written anew;
        their folders are removed when they are empty.

    Yields
    ------
    Path
        The scratch folder.

    Raises
    ------
    OSError
        Something cannot be written; ``directory`` is as it was.
    """
    for leftover in directory.glob(f"{SCRATCH}*"):  # of a process that was killed
        shutil.rmtree(leftover, ignore_errors=True)
    stage = Path(tempfile.mkdtemp(prefix=SCRATCH, dir=directory))
    try:
        (stage / "new").mkdir()
        yield stage / "new"
        written = files_below(stage / "new")
        names = sorted(written, key=lambda name: (name != first, name))
        names += sorted(set(removing) - written)
        for parent in {(directory / name).parent for name in names} - {directory}:
            if parent.is_symlink():  # what it leads to is not ours
                raise OSError(errno.ELOOP, f"'{parent.name}' is a link to another folder")
        _exchange(names, stage / "new", directory, stage / "old")
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _exchange(names: list[str], new: Path, directory: Path, old: Path) -> None:
    """Replace files of a directory by those in ``new``, remove those it lacks; all or none."""
    folders = list(dict.fromkeys((directory / name).parent for name in names if "/" in name))
    made = [folder for folder in folders if not folder.exists()]
    done: list[str] = []
    try:
        for name in names:
            target = directory / name
            target.parent.mkdir(exist_ok=True)
            _keep(target, old / name)
            done.append(name)
            if (new / name).exists():
                os.replace(new / name, target)
            else:
                target.unlink(missing_ok=True)
    except BaseException:
        for name in done:
            with contextlib.suppress(OSError):
                if (old / name).exists():
                    os.replace(old / name, directory / name)
                else:
                    (directory / name).unlink(missing_ok=True)
        for folder in made:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise
    for folder in folders:
        with contextlib.suppress(OSError):  # something is in it
            folder.rmdir()


def _keep(file: Path, copy: Path) -> None:
    """Link a file, if it exists, under a second name; without links in a file system, move it."""
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))
    copy.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(FileNotFoundError):
        try:
            os.link(file, copy)
        except FileNotFoundError:
            raise
        except OSError:
            os.replace(file, copy)


def disk_is_full(directory: Path, least: float = 1 << 16) -> OSError | None:
    """The error of a disk with less than ``least`` bytes left; None when there is room."""
    if shutil.disk_usage(directory).free < least:
        return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return None
