"""Reading YAML documents that people write, and saying in one line what is wrong with them."""

from __future__ import annotations

import difflib
import reprlib
from collections.abc import Hashable, Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import yaml
from pydantic import (
    BaseModel,
    ConfigDict,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from fingerpad.files import read_input

LOOK_UP, HIDE = object(), object()
MOST_VALUES = 200_000
"""Of a document with its aliases written out."""


class SceneError(ValueError):
    """The input is wrong; the text is one line: file, key, value, what is wrong, what is
    allowed.
    """


class Problem(ValueError):
    """One thing wrong with one key, raised inside a model; `explain` turns it into a `SceneError`.

    Parameters
    ----------
    problem : str
        What is wrong, written to follow the offending value.
    allowed : str
        What would be right; empty when the problem says it.
    key : tuple
        Path below the place where the problem is raised.
    value : any
        The offending value; `LOOK_UP` takes it from the document, `HIDE` shows none.
    """

    def __init__(
        self, problem: str, allowed: str = "", key: tuple = (), value: Any = LOOK_UP
    ) -> None:
        super().__init__(": ".join(filter(None, [dotted(key), problem])) + _or_allowed(allowed))
        self.problem, self.allowed, self.key, self.value = problem, allowed, tuple(key), value

    def below(self, *key: str | int) -> Problem:
        """The same problem met at a place further up, `key`, whose part it was raised about."""
        return Problem(self.problem, self.allowed, key + self.key, self.value)


class _Short(reprlib.Repr):
    """Short representation of anything a document can hold, however nested or long."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel, self.maxlist, self.maxtuple, self.maxdict, self.maxset = 2, 3, 3, 3, 3
        self.maxstring, self.maxother = 60, 60

    def repr_int(self, value: int, level: int) -> str:
        """As in the base class, but for integers that Python refuses to print."""
        return (
            super().repr_int(value, level) if value.bit_length() < 1000 else "a very long integer"
        )


_SHORT = _Short()


def one_line(text: str) -> str:
    """`text` with every character that would break the line or cannot be printed escaped."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text).strip()


def dotted(location: Iterable[str | int]) -> str:
    """``("motion", 0, "rate")`` as ``motion[0].rate``."""
    path = ""
    for part in location:
        path += f"[{part}]" if isinstance(part, int) else f".{part}" if path else part
    return path


def _or_allowed(allowed: str) -> str:
    return f"; allowed: {allowed}" if allowed else ""


def nearest(name: Any, known: Iterable[str]) -> str:
    """Words for an unknown name: the known one most like it; none where nothing is much like it."""
    found = difflib.get_close_matches(str(name)[:60], list(known), n=1, cutoff=0.5)
    return f", the nearest is '{found[0]}'" if found else ""


def error_line(file: Any, location: tuple, problem: Problem, document: Any = None) -> str:
    """The one line for `problem` met at `location` of `document`, which was read from `file`."""
    location = location + problem.key
    value = problem.value
    if value is LOOK_UP:
        value = document
        for part in location:
            try:
                value = value[part]
            except (LookupError, TypeError):
                value = HIDE
                break
    shown = "" if value is HIDE or not location else f"{_SHORT.repr(value)} "
    where = ": ".join(filter(None, [str(file), dotted(location)]))
    return one_line(f"{where}: {shown}{problem.problem}{_or_allowed(problem.allowed)}")


def explain(error: ValidationError, file: Any, document: Any) -> SceneError:
    """The first error of a validation as a `SceneError`."""
    first = error.errors(include_url=False, include_input=False)[0]
    location = first["loc"]
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, SceneError):
        return cause
    if hasattr(cause, "problem"):
        problem = cause if isinstance(cause, Problem) else Problem(cause.problem, cause.allowed)
    elif first["type"] == "literal_error":
        problem = Problem("is not one of the choices", first["ctx"]["expected"])
    else:
        problem = Problem(f"is not valid: {first['msg']}")
    return SceneError(error_line(file, location, problem, document))


def _parts(schema: Any) -> list[dict[str, Any]]:
    """A field's JSON schema and those it is made of, at any depth."""
    inner = (
        schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ()
    )
    return ([schema] if isinstance(schema, dict) else []) + [
        part for each in inner for part in _parts(each)
    ]


class Strict(BaseModel):
    """Frozen model that says itself which key is unknown, missing or not a mapping."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", defer_build=True, use_attribute_docstrings=True
    )
    internal: ClassVar[frozenset[str]] = frozenset()
    """Fields that a document may not set."""
    hints: ClassVar[Mapping[str, str]] = {}
    """What to say of keys that people are likely to try here."""

    follows: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    """Key -> the fields that are read of it, which go when it is changed."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Values for keys left out; `context` is None when the model is made in Python."""
        return data

    @classmethod
    def _allowed(cls, key: str) -> str:
        """What a field is, and an example of it where its type has one."""
        what = (cls.model_fields[key].description or "a value").split("\n")[0]
        parts = _parts(cls.model_json_schema()["properties"].get(key))
        examples = [example for part in parts for example in part.get("examples", ())]
        return f"{what.rstrip('.')}, such as '{examples[0]}'" if examples else what

    @model_validator(mode="wrap")
    @classmethod
    def _check_keys(
        cls, data: Any, handler: ModelWrapValidatorHandler, info: ValidationInfo
    ) -> Any:
        if isinstance(data, cls):
            return data
        keys = [key for key in cls.model_fields if info.context is None or key not in cls.internal]
        choices = "the keys " + ", ".join(keys) if len(keys) > 1 else "the key " + "".join(keys)
        if not isinstance(data, Mapping):
            raise Problem("is not a mapping", choices)
        for key in data:
            if not isinstance(key, str) or key not in keys:
                name = key[:60] if isinstance(key, str) else _SHORT.repr(key)
                hint = cls.hints.get(name) or f"is not a known key{nearest(name, keys)}"
                raise Problem(hint, choices, (name,), HIDE)
            if data[key] is None and info.context is not None:
                raise Problem("is empty", cls._allowed(key), (key,), HIDE)
        data = cls.fill(dict(data), info.context)
        for key, field in cls.model_fields.items():
            if field.is_required() and key not in data:
                raise Problem("is missing", cls._allowed(key), (key,), HIDE)
        return handler(data)


class _Loader(yaml.SafeLoader):
    """YAML without object construction and without duplicate keys."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict:
        seen = set()
        for key_node, _ in node.value if isinstance(node, yaml.MappingNode) else ():
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, Hashable) and key_node.tag != "tag:yaml.org,2002:merge":
                if key in seen:
                    problem = f"the key '{key}' is given twice"
                    raise yaml.constructor.ConstructorError(
                        None, None, problem, key_node.start_mark
                    )
                seen.add(key)
        return super().construct_mapping(node, deep)


def read_yaml(path: Path) -> Any:
    """The document in a YAML file as plain Python objects, parsed once while the file is unchanged.

    Raises
    ------
    SceneError
        The file is missing or unreadable, is not YAML, or gives a key twice.
    """
    try:
        state = path.stat()
    except (OSError, ValueError):
        return _parsed(path)
    return _unchanged(path, state.st_mtime_ns, state.st_size, state.st_ino)


@lru_cache(maxsize=256)
def _unchanged(path: Path, *state: int) -> Any:
    return _parsed(path)


def _parsed(path: Path) -> Any:
    try:
        text = read_input(path, "text")
    except FileNotFoundError:
        raise SceneError(one_line(f"{path}: there is no such file")) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise SceneError(one_line(f"{path}: cannot be read: {reason}")) from None
    try:
        return _constructed(text)
    except yaml.MarkedYAMLError as error:
        mark = f" at line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise SceneError(one_line(f"{path}: is not valid YAML{mark}: {error.problem}")) from None
    except (
        yaml.YAMLError,
        ValueError,
        LookupError,
        TypeError,
        AttributeError,
        OverflowError,
    ) as error:
        reason = " ".join(str(error).split())
        raise SceneError(one_line(f"{path}: is not valid YAML: {reason}")) from None
    except RecursionError:
        raise SceneError(one_line(f"{path}: is not valid YAML: nested too deeply")) from None


def _constructed(text: bytes) -> Any:
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        if _written_out(node, {}) > MOST_VALUES:
            raise ValueError(f"its aliases make more than {MOST_VALUES} values")
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _written_out(node: yaml.Node, known: dict[int, float]) -> float:
    """How many values a node is with its aliases written out, whatever of them is shared; infinite
    if it is within itself.
    """
    if id(node) not in known:
        known[id(node)] = float("inf")
        inner = node.value if isinstance(node, yaml.CollectionNode) else ()
        parts = (part for each in inner for part in (each if isinstance(each, tuple) else (each,)))
        known[id(node)] = 1 + sum(_written_out(part, known) for part in parts)
    return known[id(node)]
