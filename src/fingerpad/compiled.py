"""How loops are compiled by numba: with which options, where they are kept, and what a user sees.

Numba keeps compiled loops in the ``__pycache__`` folder beside their source, or in the user's cache
where that folder cannot be written. :data:`JIT` are the options of every loop of this package.
"""

import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any

from numba import njit
from numba.core import event

from fingerpad.processes import waiting


def _can_be_kept() -> bool:
    """Whether numba has a folder for compiled loops; without a home it may have none."""
    try:
        njit(cache=True)(_can_be_kept)
    except RuntimeError:
        return False
    return True


#: Options of ``numba.njit``.
JIT: Any = {"error_model": "numpy", "boundscheck": False, "cache": _can_be_kept()}


class _Notice(event.Listener):
    """Shows a line while loops of this package compile, and adds up the time that takes."""

    def __init__(self):
        self.spent, self._begun, self._shown = 0.0, [], ExitStack()

    def on_start(self, event):
        if not self._begun:
            text = "fingerpad: compiling loops for this machine, once; about a quarter of a minute"
            self._shown.enter_context(waiting(text))
        self._begun.append(time.process_time())

    def on_end(self, event):
        begun = self._begun.pop()
        if not self._begun:
            self._shown.close()
            self.spent += time.process_time() - begun


_notice = _Notice()
event.register("numba:compile", _notice)


def compiling() -> float:
    """Process time (s) that has gone into compiling loops since the process started."""
    return _notice.spent


@dataclass(frozen=True)
class Stopwatch:
    """Times since it was made; what it began at, in s."""

    cpu: float = field(default_factory=time.process_time)
    wall: float = field(default_factory=time.perf_counter)
    compiled: float = field(default_factory=compiling)

    def read(self) -> dict[str, float]:
        """Process time without that of compiling, which is for the first of all simulations on
        these elements; that of compiling; and what passed meanwhile; s.
        """
        once = compiling() - self.compiled
        return {
            "cpu_s": round(time.process_time() - self.cpu - once, 4),
            "compiling_s": round(once, 4),
            "wall_s": round(time.perf_counter() - self.wall, 4),
        }
