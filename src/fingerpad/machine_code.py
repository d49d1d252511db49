"""Compiled loops, for whoever calls them: their machine code is kept in files and runs without its
compiler.

Importing numba and setting it up costs a short simulation a third of its time, and a loop that was
compiled before needs nothing of it but three small libraries. So a loop that is called looks for
the object code that numba made of it, for arguments of the same types, the same sources and the
same processor, and lets LLVM link it; only where there is none numba is imported, and what it
compiles is kept. A file holds one loop for one set of types and is named after all that it depends
on: an edited source or another numba finds none, and processes that compile at once write the same
or different files, each whole.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import importlib.util
import pickle
import platform
import sys
import time
from collections.abc import Callable
from functools import cache
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from fingerpad.files import cache_folder, write_atomically
from fingerpad.processes import waiting

_FLAGS = 0x1 | 0x2 | 0x100 | 0x400
"""C and Fortran order, aligned, writeable: the bits of an array's flags that :func:`_kind` asks
for.
"""
_LIBRARIES = ("numba._helperlib", "numba._dynfunc", "numba.core.runtime._nrt_python")
"""Of numba, by file: what the code of a loop calls to take its arguments over, and what makes a
Python function of it.
"""


class Loop:
    """A compiled function of arrays, numbers, None and tuples of them.

    Args:
        name: what it is called in files. compiler: gives numba's dispatcher of it. sources: digest
        of what it is made of; None:
            what is compiled of it is not kept.
    """

    def __init__(self, name: str, compiler: Callable[[], Any], sources: str | None):
        self._name, self._compiler, self._sources = name, compiler, sources
        self._ready: dict[tuple, Callable] = {}  # by kinds
        self._known: dict[
            tuple, Callable
        ] = {}  # and by what is quick to ask, of which several may be of the same kinds

    def __call__(self, *arguments):
        marks = tuple(map(_mark, arguments))
        known = self._known.get(marks)
        if known is None:
            kinds = tuple(map(_kind, arguments))
            known = self._ready.get(kinds) or self._found(kinds) or self._compiled(kinds, arguments)
            self._ready[kinds] = self._known[marks] = known
        return known(*arguments)

    def _found(self, kinds: tuple) -> Callable | None:
        if self._sources is None or (linker := _linker()) is None:
            return None
        kept = next(
            filter(None, (_read(folder / self._file(kinds)) for folder in _folders())), None
        )
        return linker.link(*kept) if kept else None

    def _compiled(self, kinds: tuple, arguments: tuple) -> Callable:
        global _spent
        start = time.process_time()
        try:
            with waiting(
                "fingerpad: compiling loops for this machine, once; about a minute in all"
            ):
                return self._compiled_by_numba(kinds, arguments)
        finally:
            _spent += time.process_time() - start

    def _compiled_by_numba(self, kinds: tuple, arguments: tuple) -> Callable:
        from numba import typeof

        dispatcher = self._compiler()
        dispatcher.compile(types := tuple(map(typeof, arguments)))
        made = dispatcher.overloads[types]
        if self._sources is not None:
            (_, _, (code, _)), function, environment, *_ = (
                made._reduce()
            )  # what numba itself would keep
            self._keep(
                kinds,
                pickle.dumps((function.llvm_cpython_wrapper_name, environment.env_name, code)),
            )
        return made.entry_point

    def _keep(self, kinds: tuple, content: bytes) -> None:
        for folder in _folders():
            with contextlib.suppress(
                OSError
            ):  # somebody else's folder, a full disk: compiled anew the next time
                write_atomically(
                    folder / self._file(kinds), lambda path: path.write_bytes(_signed(content))
                )
                for path in folder.glob(f"{self._name}.*.loop"):
                    if (
                        path.name.split(".")[1] != self._made_of()
                    ):  # of sources that were edited since
                        path.unlink(missing_ok=True)
                return

    def _made_of(self) -> str:
        return _digest(self._sources, _maker())[:16]

    def _file(self, kinds: tuple) -> str:
        return f"{self._name}.{self._made_of()}.{_digest(repr(kinds), _processor())[:16]}.loop"


_spent = 0.0


def compiling() -> float:
    """Process time (s) that has gone into compiling loops since the process started."""
    return _spent


def sources(*files: str | Path) -> str:
    """Digest of the files a loop is made of."""
    return _digest(*(hashlib.sha256(Path(path).read_bytes()).hexdigest() for path in files))


def _kind(value) -> Any:
    """What numba would compile anew for."""
    if isinstance(value, np.ndarray):
        flags = value.flags
        order = "C" if flags.c_contiguous else "F" if flags.f_contiguous else "A"
        return value.dtype.str, value.ndim, order, flags.writeable, flags.aligned
    if isinstance(value, tuple):
        return tuple(map(_kind, value))
    return type(value).__name__


def _mark(value) -> Any:
    """As much as :func:`_kind` or more, in less time: it is asked at every call."""
    if type(value) is np.ndarray:
        return value.dtype.num, value.ndim, value.flags.num & _FLAGS
    return tuple(map(_mark, value)) if type(value) is tuple else type(value)


def _digest(*parts: str) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _signed(content: bytes) -> bytes:
    return hashlib.sha256(content).digest() + content


def _read(path: Path) -> tuple[str, str, bytes] | None:
    """Names of a loop's function and of its environment, and its object code; None if the file is
    not whole.
    """
    try:
        kept = path.read_bytes()
    except OSError:
        return None
    return pickle.loads(kept[32:]) if _signed(kept[32:]) == kept else None


@cache
def _folders() -> tuple[Path, ...]:
    """Where loops are kept: beside what Python has compiled of this module, else in the user's
    cache.
    """
    beside = Path(__file__).with_name("__pycache__")
    with contextlib.suppress(OSError):
        beside.mkdir(exist_ok=True)
    return tuple(folder for folder in (beside, cache_folder("loops")) if folder is not None)


@cache
def _numba() -> Path:
    """Numba's folder, without importing it."""
    return Path(importlib.util.find_spec("numba").origin).parent


@cache
def _maker() -> str:
    """Who makes object code, and for which Python."""
    import llvmlite.binding as llvm

    return f"{(_numba() / '_version.py').read_text()} {llvm.llvm_version_info} {sys.implementation.cache_tag} {np.__version__}"


@cache
def _processor() -> str:
    import llvmlite.binding as llvm

    return f"{llvm.get_process_triple()} {llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"


class _Linker:
    """LLVM's linker in this process, with what the code of loops calls; as numba sets it up."""

    def __init__(self):
        import builtins

        import llvmlite.binding as llvm

        helpers, self._functions, runtime = map(_library, _LIBRARIES)
        symbols = {
            f"numba_{name}": at
            for part in (helpers, self._functions)
            for name, at in part.c_helpers.items()
        }
        symbols |= {
            name if name.startswith("_") else f"NRT_{name}": at
            for name, at in runtime.c_helpers.items()
        }
        symbols |= {
            f"PyExc_{e.__name__}": id(e)
            for e in vars(builtins).values()
            if isinstance(e, type) and issubclass(e, BaseException)
        }
        symbols |= {
            name: at
            for name, at in helpers.c_helpers.items()
            if llvm.address_of_symbol(name) is None
        }
        for name, at in (symbols | {"_Py_NoneStruct": id(None)}).items():
            llvm.add_symbol(name, at)
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        relocation = (
            "static" if platform.machine().lower() in ("x86_64", "amd64", "i686") else "default"
        )
        target = llvm.Target.from_default_triple()
        self._machine = target.create_target_machine(
            reloc=relocation, codemodel="jitdefault", jit=True
        )
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), self._machine)
        self._llvm = llvm

    def link(self, function: str, environment: str, code: bytes) -> Callable:
        """The Python function of an object code."""
        self._engine.add_object_file(self._llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        around = self._functions.Environment({"__name__": __name__})
        place = self._engine.get_global_value_address(environment)
        ctypes.c_void_p.from_address(place).value = id(around)
        start = self._engine.get_function_address(function)
        return self._functions.make_function(
            sys.modules[__name__], "loop", "", start, around, (self, around)
        )


def _library(name: str) -> ModuleType:
    """One of numba's own libraries; numba, should it be imported later, goes on with the same."""
    if name not in sys.modules:
        stem = _numba().joinpath(*name.split(".")[1:])
        path = next(
            filter(
                Path.exists, (stem.with_name(stem.name + suffix) for suffix in EXTENSION_SUFFIXES)
            )
        )
        spec = importlib.util.spec_from_file_location(
            name, path, loader=ExtensionFileLoader(name, str(path))
        )
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        sys.modules[name] = module
    return sys.modules[name]


@cache
def _linker() -> _Linker | None:
    """None where this numba is built otherwise: then it compiles."""
    try:
        return _Linker()
    except (AttributeError, ImportError, OSError, RuntimeError, StopIteration):
        return None
