"""Scenes that share a file: a family says what its members have in common, and in what they differ.

    # ramp40.yaml: the scenes ramp40_flat and ramp40_k210
    motion: [{press_to_force: "20 gf", rate: "40 gf/s"}, {hold: "2 s"}]
    over:
      surface:
        flat: {stimulus: {shape: flat}}
        k210: {stimulus: {shape: cylinder, curvature: "210 1/m"}}

A member is asked for as if it were a file beside the family's, ``ramp40_k210.yaml``. With several
keys under ``over`` there is a member for every combination. ``extends: other.yaml`` starts from
another file, whose ``over`` comes along: a list of words takes some of them, further keys change
them. Mappings are merged, everything else is replaced. Names follow the order of the keys, those of
the file itself before those of the file it extends.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingerpad.documents import HIDE, Problem, SceneError, error_line, read_yaml
from fingerpad.files import is_file
from fingerpad.scenes.specimen import DEFAULT_SPECIMEN, Source

MOST = 1000
"""Members of a family."""
MOST_EXTENDED = 20
"""Files one after the other that extend each other."""


@dataclass(frozen=True)
class Written:
    """A scene as it is written: its document, its tags (family, and the word under each key of
    ``over``), and the files it is in, its own first.
    """

    document: Any
    tags: Mapping[str, str]
    files: tuple[Path, ...]


def read_scene(path: str | Path) -> Written:
    """What is written of a scene, in a file of its own or as a member of a family in the same
    folder.

    Raises
    ------
    SceneError
        There is neither, a file cannot be read, or it is a family itself.
    """
    path = Path(path)
    home = path if is_file(path) else next(_homes(path), path)
    members = read_family(home)
    if path.stem in members:
        return members[path.stem]
    example = path.with_name(f"{next(iter(members))}.yaml")
    what = (
        f"is a family of {len(members)} scenes"
        if home == path
        else f"is not a scene of {home.name}"
    )
    raise SceneError(f"{path}: {what}; allowed: one of {', '.join(members)}, as in {example}")


def read_family(path: str | Path) -> dict[str, Written]:
    """The scenes that a file describes, by name: one unless it has ``over``; SceneError if it
    cannot be read or is wrong.
    """
    path = Path(path)
    document, files = _extended(path, ())
    if not isinstance(document, Mapping) or "over" not in document:
        return {path.stem: Written(document, {}, files)}
    axes = _axes(path, document["over"])
    common = _without(document, "over")
    members = {}
    for words in itertools.product(*axes.values()):
        tags = dict(zip(axes, words, strict=True))
        member = common
        for axis, word in tags.items():
            member = merged(member, axes[axis][word])
        members["_".join((path.stem, *words))] = Written(
            member, {"family": path.stem, **tags}, files
        )
    return members


def rests_on(path: str | Path) -> list[Path]:
    """The files that a scene is made of: its own, those it extends, and the specimens, profile and
    mesh that it names.

    Of what is not there nothing is said: reading the scene does.
    """
    written, source = read_scene(path), Source(Path(path))
    specimens, files = source.specimen_files(), []
    named, todo = {DEFAULT_SPECIMEN}, [written.document]
    while todo:
        part = todo.pop()
        for key, value in part.items() if isinstance(part, Mapping) else ():
            if not isinstance(value, str):
                todo.append(value)
            elif key in ("mesh", "csv", "table"):
                files.append(source.resolve(value))
            else:
                named.add(value)
    return [*written.files, *(specimens[name] for name in sorted(named & specimens.keys())), *files]


def moves_along(path: str | Path) -> bool:
    """Is the scene a stroke, or stepped along, and so takes much longer than a press?"""
    document = read_scene(path).document
    legs = document.get("motion") if isinstance(document, Mapping) else None
    return any(isinstance(leg, Mapping) and ("slide" in leg or "step" in leg) for leg in legs or ())


def merged(base: Any, changes: Any) -> Any:
    """`changes` over `base`: mappings key by key, everything else replaced."""
    if not isinstance(base, Mapping) or not isinstance(changes, Mapping):
        return changes
    return {**base, **{key: merged(base.get(key), value) for key, value in changes.items()}}


def _homes(path: Path) -> Iterator[Path]:
    """Files in the folder of `path` whose members may be called so, the longest name first."""
    parts = path.stem.split("_")
    for n in range(len(parts) - 1, 0, -1):
        home = path.with_name("_".join(parts[:n]) + path.suffix)
        if is_file(home) and "over" in (_extended(home, ())[0] or {}):
            yield home


def _extended(path: Path, seen: tuple[Path, ...]) -> tuple[Any, tuple[Path, ...]]:
    """The document of a file over that of the file it extends, and the files, its own first."""
    document = read_yaml(path)
    if not isinstance(document, Mapping) or "extends" not in document:
        return document, (path,)
    named = document["extends"]
    base = path.parent / named if isinstance(named, str) else None
    problem, allowed = None, "the path of a scene or family, relative to this file"
    if base is None:
        problem = "is not a path"
    elif not is_file(base):
        problem = "is not an existing file"
    elif base.resolve() in (file.resolve() for file in (path, *seen)):
        problem = "extends itself"
    elif len(seen) >= MOST_EXTENDED:
        problem, allowed = "is one file too many", f"up to {MOST_EXTENDED} that extend each other"
    if problem:
        raise _wrong(path, ("extends",), named, problem, allowed)
    below, files = _extended(base, (*seen, path))
    own, given = _over(path, document), _over(base, below)
    taken = {axis: _taken(path, axis, given.get(axis), words) for axis, words in own.items()}
    over = taken | {axis: words for axis, words in given.items() if axis not in taken}
    whole = merged(_without(below, "over"), _without(document, "over", "extends"))
    return whole | ({"over": over} if over else {}), (path, *files)


def _over(path: Path, document: Any) -> dict[str, Any]:
    """What is under ``over`` of a document, if anything, by axes as text."""
    over, key = HIDE, ()
    if isinstance(document, Mapping):
        over, key = document.get("over") or {}, ("over",)
    if not isinstance(over, Mapping):
        raise _wrong(path, key, over, "is not a mapping of keys", "keys, with a value for each")
    return {str(axis): _by_word(words) for axis, words in over.items()}


def _without(document: Mapping[str, Any], *keys: str) -> dict[str, Any]:
    return {key: value for key, value in document.items() if key not in keys}


def _by_word(words: Any) -> Any:
    """The words of an axis as text, each with its changes; what is no mapping is left as it is."""
    if not isinstance(words, Mapping):
        return words
    return {str(word): change for word, change in words.items()}


def _taken(path: Path, axis: str, below: Any, words: Any) -> Any:
    """The words of an axis: some of those below, or those below with changes."""
    if not isinstance(below, Mapping):
        return words
    if not isinstance(words, list):
        return merged(below, words)
    for word in words:
        if str(word) not in below:
            problem = "is not in the file that is extended"
            raise _wrong(path, ("over", axis), word, problem, ", ".join(below))
    return {str(word): below[str(word)] for word in words}


def _axes(path: Path, over: Any) -> dict[str, dict[str, Any]]:
    """``over`` checked: key -> word -> changes."""
    allowed = "a key such as surface, with a word for each scene and what is special to it"
    if not isinstance(over, Mapping) or not over:
        raise _wrong(path, ("over",), over, "is not a mapping of keys", allowed)
    axes: dict[str, dict[str, Any]] = {}
    for axis, words in over.items():
        key = ("over", str(axis))
        if not isinstance(words, Mapping) or not words or str(axis) == "family":
            raise _wrong(path, key, words, "is not a mapping of words", allowed)
        axes[str(axis)] = changes = {}
        for word, change in _by_word(words).items():
            if "/" in word or not word.isprintable():
                problem = "cannot be part of the name of a file"
                raise _wrong(path, (*key, word), HIDE, problem, "a word such as flat")
            changes[word] = {} if change is None else change
            if not isinstance(changes[word], Mapping):
                raise _wrong(path, (*key, word), change, "is not a mapping", "keys of a scene")
    count = math.prod(map(len, axes.values()))
    if count > MOST:
        raise _wrong(path, ("over",), HIDE, f"makes {count} scenes", f"up to {MOST}")
    return axes


def _wrong(path: Path, key: tuple, value: Any, problem: str, allowed: str) -> SceneError:
    shown = "" if value is HIDE else f"{value!r:.60} "
    return SceneError(error_line(path, key, Problem(f"{shown}{problem}", allowed, (), HIDE)))
