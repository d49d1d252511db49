"""Which source files a piece of code rests on, found by following its imports.

The workflow names these files as inputs of its rules, so that an edit reruns what it touches and nothing
else; because they are derived, the lists cannot go out of date.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import json
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from fingerpad.files import cache_folder, write_text

PACKAGE = Path(__file__).resolve().parent


def imported_sources(*entries: str | Path) -> list[Path]:
    """Return the files of this package that `entries` import, directly or not, and the entries themselves.

    Imports inside functions count; imports under ``if TYPE_CHECKING`` do not. Of a package that is only
    passed through (``fingerpad`` on the way to ``fingerpad.scenes.scene``) no more counts than what its ``__init__``
    executes. Lazy attributes of a package are followed where a dictionary literal gives name -> module.

    Args:
        entries: dotted module names (``"fingerpad.mechanics"``) or paths of scripts.

    Returns:
        Absolute paths, sorted, each once.

    They are kept in the user's cache for as long as no file of the package changes: to follow them takes a third of a second.

    Raises:
        ModuleNotFoundError: a module of this package is imported that does not exist.
        ImportError: a lazy attribute is imported whose module is not written down like that.
    """
    folder = cache_folder("imports")
    if folder is None:
        return _followed(entries)
    scripts = [Path(entry) for entry in entries if str(entry).endswith(".py")]
    state = [(str(path), *_stamp(path)) for path in sorted([*PACKAGE.rglob("*.py"), *scripts])]
    name, state = (hashlib.sha256(repr(part).encode()).hexdigest()[:16] for part in ((str(PACKAGE), entries), state))
    kept = folder / f"{name}.json"
    with contextlib.suppress(OSError, ValueError, LookupError, TypeError):
        before = json.loads(kept.read_text(encoding="utf-8"))
        if before["state"] == state:
            return [Path(path) for path in before["files"]]
    found = _followed(entries)
    with contextlib.suppress(OSError):
        write_text(kept, json.dumps({"state": state, "files": [str(path) for path in found]}))
    return found


def _stamp(path: Path) -> tuple[int, int]:
    """When a file was changed, and its length; zeros where there is none."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size


def _followed(entries: Iterable[str | Path]) -> list[Path]:
    """`imported_sources`, found out."""
    found: set[Path] = set()
    todo: list[tuple[Path, str | None, bool]] = []
    for entry in entries:
        if isinstance(entry, Path) or str(entry).endswith(".py"):
            todo.append((Path(entry).resolve(), None, True))
        else:
            todo.extend(_with_parents(str(entry)))
    seen: set[tuple[Path, bool]] = set()
    while todo:
        path, module, entered = todo.pop()
        found.add(path)
        if (path, entered) in seen:
            continue
        seen.add((path, entered))
        todo.extend(_imported(path, module, entered))
    return sorted(found)


def digest(paths: Iterable[Path]) -> str:
    """Return the SHA-256 of the files' names and contents, whatever their order and where the tree lies."""
    whole = hashlib.sha256()
    for path in sorted(Path(path).resolve() for path in paths):
        name = path.relative_to(PACKAGE) if path.is_relative_to(PACKAGE) else Path(path.name)
        whole.update(f"{name.as_posix()}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()


def _file(module: str) -> Path | None:
    base = PACKAGE.joinpath(*module.split(".")[1:])
    for candidate in (base / "__init__.py", base.with_suffix(".py")):
        if candidate.is_file():
            return candidate
    return None


def _with_parents(module: str) -> Iterator[tuple[Path, str, bool]]:
    parts = module.split(".")
    for n in range(1, len(parts) + 1):
        name = ".".join(parts[:n])
        path = _file(name)
        if path is not None:
            yield path, name, n == len(parts)
        elif n == len(parts) or not PACKAGE.joinpath(*parts[1:n]).is_dir():
            raise ModuleNotFoundError(f"no module named {name!r}", name=name)


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def _statements(body: Iterable[ast.stmt], inside_functions: bool) -> Iterator[ast.stmt]:
    """Statements at any depth, but for what only a type checker runs and, if asked, bodies of functions."""
    for node in body:
        yield node
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and not inside_functions:
            continue
        for block in ("body", "orelse", "finalbody", "handlers", "cases"):
            for_checker = block == "body" and isinstance(node, ast.If) and _type_checking(node.test)
            if not for_checker:
                yield from _statements(getattr(node, block, ()), inside_functions)


def _type_checking(test: ast.expr) -> bool:
    return "TYPE_CHECKING" in (getattr(test, "id", None), getattr(test, "attr", None))


@cache
def _imported(path: Path, module: str | None, entered: bool) -> tuple[tuple[Path, str, bool], ...]:
    return tuple(parent for name in _imports(path, module, entered) for parent in _with_parents(name))


def _imports(path: Path, module: str | None, entered: bool) -> Iterator[str]:
    root = PACKAGE.name
    package = module if path.name == "__init__.py" else (module or "").rpartition(".")[0]
    for node in _statements(_tree(path).body, inside_functions=entered):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == root)
        elif isinstance(node, ast.ImportFrom):
            parts = (package or "").split(".")
            base = parts[: len(parts) - node.level + 1] if node.level else []
            source = ".".join([*base, *([node.module] if node.module else [])])
            if source.split(".")[0] != root:
                continue
            for alias in node.names:
                if _file(f"{source}.{alias.name}") is not None:
                    yield f"{source}.{alias.name}"
                    continue
                yield _home(source, alias.name, path)


def _home(source: str, name: str, importer: Path) -> str:
    """The module to follow for ``from source import name``: `source`, or what its lazy attributes name."""
    path = _file(source)
    body = _tree(path).body if path is not None else []
    if not any(isinstance(node, ast.FunctionDef) and node.name == "__getattr__" for node in body):
        return source
    for node in body:
        if getattr(node, "name", None) == name:
            return source
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Dict):
            for key, value in zip(node.value.keys, node.value.values, strict=True):
                if isinstance(key, ast.Constant) and key.value == name and isinstance(value, ast.Constant):
                    return value.value
    raise ImportError(f"{importer}: cannot follow the lazy attribute {name!r} of {source!r}", name=source)
