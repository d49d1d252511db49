"""Faults of a file system: the n-th call that touches a folder fails, is interrupted, or is the
process's last.
"""

import builtins
import contextlib
import errno
import io
import os
from pathlib import Path

ERRORS = (errno.ENOSPC, errno.EIO, errno.EACCES, errno.EDQUOT, errno.EROFS)
"""No space, input/output error, no permission, quota, read-only."""


class Faults:
    """While this is entered, calls of the system that name something in `folder` are counted; the
    `at`-th goes wrong by `how`.

    `how`: a number of errno, "interrupt" or "kill". A file that is to be written is then left
    half-written.
    """

    def __init__(self, folder, at=None, how=errno.EIO):
        self.folder, self.at, self.how, self.calls, self.met = (
            str(Path(folder).absolute()),
            at,
            how,
            0,
            None,
        )
        self._kept = contextlib.ExitStack()

    def __enter__(self):
        for name in ("open", "replace", "link", "mkdir", "unlink", "chmod", "rmdir"):
            self._wrap(os, name, getattr(os, name))
        for module in (io, builtins):
            self._wrap(module, "open", io.open, self._half)
        return self

    def __exit__(self, *_):
        self._kept.close()

    def _wrap(self, module, name, real, before=lambda *_: None):
        def call(path, *args, **kwargs):
            if self._counts(path):
                self.calls += 1
                if self.calls - 1 == self.at:
                    self.met = f"{name} {os.fspath(path)}"
                    before(real, path, *args, *kwargs.values())
                    self._fail(path)
            return real(path, *args, **kwargs)

        setattr(module, name, call)
        self._kept.callback(setattr, module, name, real)

    def _counts(self, path):
        with contextlib.suppress(TypeError, ValueError):
            return os.path.abspath(os.fspath(path)).startswith(self.folder)
        return False

    @staticmethod
    def _half(real, path, mode="r", *_):
        if set(str(mode)) & set("wax+"):
            with real(path, "wb") as file:
                file.write(b"half of it")

    def _fail(self, path):
        if self.how == "kill":
            os._exit(9)
        if self.how == "interrupt":
            raise KeyboardInterrupt
        raise OSError(self.how, os.strerror(self.how), os.fspath(path))


def files(folder):
    """Relative name -> bytes of every file below a folder, temporary ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file()
    }


def results(folder):
    """The same without scratch folders, which may stay until the next run where tidying up is what
    goes wrong.
    """
    return {
        name: content
        for name, content in files(folder).items()
        if not name.startswith(".fingerpad-")
    }


def in_child(do, *args):
    """Call a function in a process of its own; its exit code, -1 for whatever it raises."""
    child = os.fork()
    if not child:
        try:
            os._exit(do(*args) or 0)
        except BaseException:  # noqa: BLE001 - only pytest's own process may go on
            os._exit(255)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
