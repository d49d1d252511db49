"""The sweep language: a base scene, the keys that vary, the design, what is kept; read from YAML
and checked.

    scene: ../scenes/press10.yaml
    over:
      stimulus.curvature: ["79 1/m", "210 1/m", "630 1/m"] motion[0].press_to_force: {range: ["2
      gf", "200 gf"], count: 9, spacing: logarithmic} specimen.layers.fat.youngs_modulus:
      {lognormal: {median: "15 kPa", factor: 1.5}, within: ["5 kPa", "40 kPa"]}

An axis is a list of values, a range, a distribution, words with a value each, or a folder of files.
Distributions, and ranges without a count, are drawn together in a design of points; all else is
crossed with every other axis. ``table: samples.csv`` under ``over`` is a design of one's own: its
columns are keys with their units, such as ``stimulus.curvature (1/m)``, its rows scenes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError, ValidationInfo

from fingerpad.documents import HIDE, Problem, SceneError, Strict, explain, nearest, read_yaml
from fingerpad.fields import filled, listed, number, published_schema, whole
from fingerpad.files import expanded
from fingerpad.scenes.scene import LEVELS, Scene, load_scene
from fingerpad.tables import TableError, read_table
from fingerpad.units import DIMENSIONS, QuantityError, number_of, parse_quantity, unit_of

MOST = 1_000_000
"""Scenes of a sweep."""
_FILES = ("csv", "mesh", "table")
"""Keys whose values are paths."""


# --- numbers with one unit ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Unit:
    """The unit that an axis is stated in: its text ("1": none), the dimension, and its size in
    SI.
    """

    text: str
    dimension: str
    si: float

    @classmethod
    def of(cls, value: Any) -> Unit:
        """The unit of a quantity as it is written. Raises `Problem`."""
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return cls("1", "dimensionless", 1.0)
        if not isinstance(value, str):
            raise Problem(
                "is not a number with its unit",
                "text such as '15 kPa', or a number where none is needed",
            )
        try:
            text = unit_of(value) or "1"
        except QuantityError as error:
            raise Problem(error.problem, error.allowed) from None
        for dimension in DIMENSIONS:
            try:
                return cls(text, dimension, parse_quantity(f"1 {text}", dimension))
            except QuantityError:
                continue
        raise Problem("has an unknown unit", "a number with its unit such as '15 kPa'")

    def read(self, value: Any) -> float:
        """A quantity in this unit. Raises `Problem` if it is none, or of another dimension."""
        if (
            self.dimension == "dimensionless"
            and isinstance(value, (int, float))
            and not isinstance(value, bool)
        ):
            return float(value)
        try:
            found = parse_quantity(value, self.dimension)
            # a number in this unit as it is written, without a way through SI and back
            return (
                number_of(value)
                if unit_of(value) == self.text
                else float(f"{found / self.si:.12g}")
            )
        except QuantityError as error:
            raise Problem(error.problem, error.allowed) from None

    def written(self, value: float) -> str | float:
        """A number in this unit as a scene takes it."""
        return value if self.text == "1" else f"{value!r} {self.text}"


def _quantity(value: Any) -> Any:
    Unit.of(value)
    return value


_QUANTITY = {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["15 kPa"]}
Quantity = Annotated[Any, BeforeValidator(_quantity), Field(json_schema_extra=_QUANTITY)]
"""A number with its unit, of any dimension: the scene says which fits."""


def _pair(value: Any) -> Any:
    if len(listed(value)) != 2:
        raise Problem("is not a pair", "two values, the lower one first")
    return tuple(value)


Pair = Annotated[
    tuple[Quantity, Quantity],
    BeforeValidator(_pair),
    Field(json_schema_extra={"minItems": 2, "maxItems": 2}),
]


# --- what an axis can be ------------------------------------------------------------------------------------------------


class Axis(Strict):
    """What all axes have: how the axis is called in the results."""

    name: str | None = None
    """What it is called in the results; left out, the last words of its key."""

    @property
    def drawn(self) -> bool:
        """Whether its values are drawn, not listed."""
        return False

    @property
    def unit(self) -> Unit | None:
        """The unit of its values; None where they are words."""
        return None

    def written(self) -> list[Any]:
        """Values as a scene takes them, of an axis that is not drawn."""
        raise NotImplementedError

    def labels(self) -> list[Any]:
        """What its values are in the results: numbers in `unit`, or words."""
        raise NotImplementedError


class Values(Axis):
    """Values one by one."""

    values: Annotated[tuple[Any, ...], BeforeValidator(filled)]
    """The values, as a scene takes them."""

    @cached_property
    def _unit(self) -> Unit | None:
        try:
            unit = Unit.of(self.values[0])
            for value in self.values:
                unit.read(value)
        except Problem:
            return None
        return unit

    @property
    def unit(self):
        return self._unit

    def written(self):
        return list(self.values)

    def labels(self):
        return (
            [self._unit.read(value) for value in self.values]
            if self._unit
            else [_word(value) for value in self.values]
        )


class Words(Axis):
    """Values by a word each."""

    words: Annotated[dict[str, Any], Field(min_length=1)]
    """Word -> value, which may be a whole part of a scene."""

    def written(self):
        return list(self.words.values())

    def labels(self):
        return list(self.words)


def _pattern(value: Any) -> Any:
    if (
        not isinstance(value, str)
        or value in ("", ".", "..")
        or {"/", "\0"} & set(value)
        or "**" in value
    ):
        raise Problem("is not the pattern of a file's name", "one such as *.csv, without folders")
    return value


class Column(Values):
    """A column of a table of samples: its values belong to those of the table's other columns, row
    by row.
    """


class Folder(Axis):
    """Every file of a folder: profiles, for example."""

    folder: Path
    """The folder, relative to the sweep's file."""
    pattern: Annotated[str, BeforeValidator(_pattern)] = "*.csv"
    """Which of its files."""

    @cached_property
    def files(self) -> list[Path]:
        return sorted(self.folder.glob(self.pattern))

    def written(self):
        return [str(path) for path in self.files]

    def labels(self):
        return [path.stem for path in self.files]


class Range(Axis):
    """From one value to another."""

    range: Pair
    """First and last value."""
    count: whole(2, 100_000) | None = None
    """How many, both ends included; left out, values between them are drawn."""
    spacing: Literal["linear", "logarithmic"] = "linear"
    """Equal steps, or equal ratios."""
    source: str | None = None
    """Where the range is from."""

    @property
    def drawn(self):
        return self.count is None

    @property
    def unit(self):
        return Unit.of(self.range[0])

    @property
    def ends(self) -> tuple[float, float]:
        """Both ends in `unit`. Raises `Problem`."""
        low, high = (_at("range", self.unit.read, value) for value in self.range)
        if low == high:
            raise Problem("is no range", "two values that differ", ("range",))
        if self.spacing == "logarithmic" and not (low > 0 and high > 0):
            raise Problem("cannot be logarithmic", "values above zero", ("range",))
        return low, high

    def labels(self):
        import numpy as np

        low, high = self.ends
        steps = (
            np.geomspace(low, high, self.count)
            if self.spacing == "logarithmic"
            else np.linspace(low, high, self.count)
        )
        return [float(f"{value:.12g}") for value in steps]

    def written(self):
        return [self.unit.written(value) for value in self.labels()]

    def distribution(self) -> Any:
        """The same as a distribution of scipy's, uniform or log-uniform."""
        from scipy import stats

        low, high = sorted(self.ends)
        return (
            stats.loguniform(low, high)
            if self.spacing == "logarithmic"
            else stats.uniform(low, high - low)
        )


class Normal(Strict):
    """A normal distribution."""

    mean: Quantity
    """Mean."""
    sd: Quantity
    """Standard deviation."""


class LogNormal(Strict):
    """A lognormal distribution."""

    median: Quantity
    """Median."""
    factor: number("a factor above 1", 1.0, math.inf)
    """Geometric standard deviation: two thirds of the values are within this factor of the
    median.
    """


class Distribution(Axis):
    """A distribution from which values are drawn; exactly one of uniform, normal, lognormal."""

    uniform: Pair | None = None
    """Lower and upper end."""
    normal: Normal | None = None
    """Mean and standard deviation."""
    lognormal: LogNormal | None = None
    """Median and factor."""
    within: Pair | None = None
    """Ends at which the distribution is truncated."""
    source: str | None = None
    """Where the distribution is from."""

    @property
    def drawn(self):
        return True

    @property
    def unit(self):
        return Unit.of(
            self.uniform[0]
            if self.uniform
            else self.normal.mean
            if self.normal
            else self.lognormal.median
        )

    def distribution(self) -> Any:
        """The distribution of scipy's, in `unit`, not truncated. Raises `Problem`."""
        from scipy import stats

        unit = self.unit
        if self.uniform:
            low, high = _rising("uniform", self.uniform, unit)
            return stats.uniform(low, high - low)
        if self.normal:
            sd = _at("normal", lambda value: _at("sd", unit.read, value), self.normal.sd)
            if not sd > 0:
                raise Problem(
                    "is not above zero", "a standard deviation above zero", ("normal", "sd")
                )
            return stats.norm(unit.read(self.normal.mean), sd)
        median = unit.read(self.lognormal.median)
        if not median > 0:
            raise Problem("is not above zero", "a median above zero", ("lognormal", "median"))
        return stats.lognorm(math.log(self.lognormal.factor), scale=median)


def quantiles(axis: Range | Distribution, shares: Any) -> Any:
    """Values (n,) of a drawn axis, in its unit, at shares (n,) from 0 to 1 of its (truncated)
    distribution. Raises `Problem`.
    """
    found = axis.distribution()
    low, high = 0.0, 1.0
    if getattr(axis, "within", None):
        low, high = found.cdf(_rising("within", axis.within, axis.unit))
        if not high > low:
            raise Problem(
                "leaves nothing of the distribution", "a range that has some of it", ("within",)
            )
    return found.ppf(low + shares * (high - low))


def _rising(key: str, pair: tuple[Any, Any], unit: Unit) -> tuple[float, float]:
    low, high = (_at(key, unit.read, value) for value in pair)
    if not low < high:
        raise Problem("is not rising", "two values, the lower one first", (key,))
    return low, high


def _at(key: str, do: Callable, value: Any) -> Any:
    try:
        return do(value)
    except Problem as problem:
        raise problem.below(key) from None


_KINDS: dict[str, type[Axis]] = {
    "values": Values,
    "words": Words,
    "folder": Folder,
    "range": Range,
    "uniform": Distribution,
    "normal": Distribution,
    "lognormal": Distribution,
}
"""Key that an axis is known by -> what it is."""


def _axis(value: Any, info: ValidationInfo) -> Axis:
    if isinstance(value, Axis):
        return value
    if not isinstance(value, Mapping):
        value = {"values": filled(value)}
    kinds = [kind for kind in _KINDS if kind in value]
    if len(kinds) != 1:
        known = [*_KINDS, "name", "within", "source", "count", "spacing", "pattern"]
        wrong = next((key for key in value if key not in known), None)
        what = f"is not a known key{nearest(wrong, known)}" if wrong else "says not one thing"
        allowed = "a list of values, or one of range, uniform, normal, lognormal, words, folder"
        raise Problem(what, allowed, (str(wrong)[:60],) if wrong else (), HIDE if wrong else value)
    if kinds == ["folder"] and isinstance(value["folder"], str) and info.context is not None:
        value = {**value, "folder": info.context.parent / expanded(value["folder"])}
    return _checked(_KINDS[kinds[0]], value, info.context)


def _checked(kind: type[Axis], value: Mapping[str, Any], context: Any) -> Axis:
    try:
        axis = kind.model_validate(value, context=context)
    except ValidationError as error:
        first = error.errors()[0]
        cause = first.get("ctx", {}).get("error")
        problem = getattr(cause, "problem", None) or f"is not valid: {first['msg']}"
        key = tuple(
            part
            for part in first["loc"]
            if part in value or isinstance(part, int) or part in ("mean", "sd", "median")
        )
        raise Problem(
            problem, getattr(cause, "allowed", ""), key + getattr(cause, "key", ())
        ) from None
    if axis.drawn:
        quantiles(axis, 0.5)
    elif not axis.labels():
        raise Problem(f"holds no file {axis.pattern}", "a folder of one or more", ("folder",))
    return axis


def _over(value: Any, info: ValidationInfo) -> dict[str, Axis]:
    if not isinstance(value, Mapping) or not value:
        raise Problem(
            "is not a mapping of keys",
            "keys of the scene such as stimulus.curvature, each with its values",
        )
    axes = {}
    for key, given in value.items():
        if key == "table":
            axes |= _at("table", lambda each: _columns(each, info), given)
        else:
            axes[str(key)] = _at(str(key), lambda each: _axis(each, info), given)
    return axes


def _columns(value: Any, info: ValidationInfo) -> dict[str, Column]:
    """The axes of a table of samples: its columns are keys of the scene, with the unit of their
    values in brackets.
    """
    if not isinstance(value, (str, Path)):
        raise Problem("is not a path", "the path of a CSV file whose columns are keys of the scene")
    path = expanded(value) if info.context is None else info.context.parent / expanded(value)
    try:
        table = read_table(path)
        found = {}
        for k, name in enumerate(table.header):
            key, _, unit = name.removesuffix(")").partition(" (")
            if unit or all(cell and _is_number(cell) for cell in (row[k] for row in table.rows)):
                values = [f"{number!r} {unit}" if unit else number for number in table.numbers(k)]
            else:
                values = [row[k] for row in table.rows]
            if key in found:
                raise TableError(f"has two columns of the key '{key[:60]}'", "each key once")
            found[key] = _checked(Column, {"values": values}, info.context) if values else None
    except FileNotFoundError:
        raise Problem(
            "is not an existing file", "the path of a CSV file, relative to the sweep"
        ) from None
    except TableError as error:
        raise Problem(error.problem, error.allowed) from None
    except OSError as error:
        raise Problem(f"cannot be read ({error.strerror})", "a CSV file") from None
    if not table.rows:
        raise Problem("has no rows", "a row for each scene")
    return found


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell.replace(",", ".", 1)))
    except ValueError:
        return False


# --- the sweep ----------------------------------------------------------------------------------------------------------


def _keep(value: Any) -> Any:
    from fingerpad.measures.known import OF_ANY, known

    measures = known(filled(value))
    for i, name in enumerate(filled(value)):
        if name not in measures:
            allowed = f"{', '.join(OF_ANY)}, and those of measures.csv"
            raise Problem(f"is not a measure{nearest(name, measures)}", allowed, (i,))
        if measures[name].beside or measures[name].of == "mesh":
            raise Problem(
                "is not a measure of one history", "measures of one history or of a scene", (i,)
            )
    return tuple(dict.fromkeys(value))


STANDARD = ("indentation_depth", "contact_width", "normal_force", "peak_pressure", "strain_energy")
"""Measures kept unless a sweep says which."""

_AXES = [Values, Words, Folder, Range, Distribution]


class Sweep(Strict):
    """A base scene and the keys of it that vary."""

    scene: Any = Field(json_schema_extra={"anyOf": [{"type": "string"}, {"type": "object"}]})
    """The base scene: the path of a scene, relative to this file, or a scene."""
    over: Annotated[dict[str, Any], BeforeValidator(_over)]
    """Key of the scene, such as motion[0].rate -> its values: a list, a range, a distribution,
    words, or a folder of files.

    Or table: a CSV file with a column for each key, its unit in brackets, and a row for each
    scene.
    """
    design: Literal["grid", "latin_hypercube", "sobol"] = "grid"
    """How what is drawn is drawn; a grid draws nothing."""
    samples: whole(1, MOST) | None = None
    """How many points are drawn; of sobol best a power of two."""
    seed: whole(0, 2**32 - 1) = 0
    """Of what is drawn."""
    keep: Annotated[tuple[str, ...], BeforeValidator(_keep)] = STANDARD
    """Measures to keep, by name."""
    histories: bool = False
    """Whether the history of every scene is kept, as a file."""
    accuracy: Any = Field(
        default=None,
        json_schema_extra={
            "anyOf": [{"enum": list(LEVELS)}, {"type": "number"}, {"type": "object"}]
        },
    )
    """Accuracy in place of what the scene says."""


@dataclass(frozen=True)
class Read:
    """A sweep as it was read: its name, the file (None in Python), what it says, and the base scene
    at its accuracy.
    """

    name: str
    file: Path
    sweep: Sweep
    base: Scene

    @cached_property
    def names(self) -> dict[str, str]:
        """Key -> what the axis is called: the fewest last words of the key that no other has."""
        keys = {key: key.replace("[", ".").replace("]", "").split(".") for key in self.sweep.over}
        found = {}
        for key, parts in keys.items():
            most = max(map(len, keys.values()))
            # a bare number says nothing
            least = next(
                (n for n in range(1, len(parts) + 1) if not parts[-n].isdigit()), len(parts)
            )
            others = [words for other, words in keys.items() if other != key]
            enough = (
                n
                for n in range(least, most + 1)
                if not any(words[-n:] == parts[-n:] for words in others)
            )
            found[key] = self.sweep.over[key].name or "_".join(parts[-next(enough, most) :])
        return found


def load_sweep(
    source: str | Path | Mapping[str, Any], name: str = "sweep", scene: Scene | None = None
) -> Read:
    """Read and check a sweep.

    Args:
        source: YAML file, or a dictionary, whose paths are relative to the working directory. name:
        of a dictionary's sweep. scene: the base scene, in place of the one that the sweep says.

    Raises:
        SceneError: the file cannot be read or anything in it is wrong; its text is one line.
    """
    given = isinstance(source, Mapping)
    path = Path(f"{name}.yaml") if given else Path(source)
    document = dict(source) if given else read_yaml(path)
    if scene is not None:
        document = document | {"scene": HIDE}
    shown = name if given else path
    try:
        sweep = Sweep.model_validate(document, context=path)
    except ValidationError as error:
        raise explain(error, shown, document) from None
    base = scene if scene is not None else _base(sweep.scene, path)
    if sweep.accuracy is not None:
        base = base.with_accuracy(sweep.accuracy)
    read = Read(path.stem, path, sweep, base)
    _check(read, shown)
    return read


def _base(scene: Any, path: Path) -> Scene:
    if isinstance(scene, Mapping):
        return load_scene(scene, str(path.with_suffix("")))
    if not isinstance(scene, str):
        raise SceneError(
            f"{path}: scene: is not a scene; allowed: the path of a scene relative to this file, or a scene"
        )
    return load_scene(path.parent / expanded(scene))


def _check(read: Read, shown: Any) -> None:
    """What concerns several keys."""
    sweep, axes = read.sweep, read.sweep.over
    drawn = [key for key, axis in axes.items() if axis.drawn]

    def wrong(key: str, problem: str, allowed: str) -> SceneError:
        return SceneError(f"{shown}: {key}: {problem}; allowed: {allowed}")

    if drawn and sweep.design == "grid":
        more = "a count, or " if isinstance(axes[drawn[0]], Range) else ""
        raise wrong(
            f"over.{drawn[0]}",
            "is drawn, but the design is a grid",
            f"{more}design: latin_hypercube or sobol",
        )
    if not drawn and sweep.design != "grid":
        raise wrong(
            "design",
            f"{sweep.design} draws, but no key is a distribution",
            "a distribution, or design: grid",
        )
    if drawn and sweep.samples is None:
        raise wrong("samples", "is missing", "how many points are drawn")
    if not drawn and sweep.samples is not None:
        raise wrong("samples", "is given, but nothing is drawn", "a distribution, or no samples")
    names = list(read.names.values())
    for name in names:
        if names.count(name) > 1 or not name.replace("_", "").isalnum():
            raise wrong(
                "over",
                f"the name {name!r} is {'given twice' if names.count(name) > 1 else 'not one word'}",
                "a name each",
            )
    tabled = [len(axis.values) for axis in axes.values() if isinstance(axis, Column)]
    if tabled and drawn:
        raise wrong(
            f"over.{drawn[0]}",
            "is drawn beside a table of samples",
            "a list, or a column of the table",
        )
    listed = math.prod(
        len(axis.labels())
        for axis in axes.values()
        if not axis.drawn and not isinstance(axis, Column)
    )
    count = (sweep.samples or 1) * listed * (tabled[0] if tabled else 1)
    if count > MOST:
        raise wrong("over", f"makes {count} scenes", f"up to {MOST}")


def resolved(key: str, value: Any, folder: Path) -> Any:
    """A value of a key with the paths in it absolute: those relative to `folder`."""
    if isinstance(value, Mapping):
        return {name: resolved(name, each, folder) for name, each in value.items()}
    if key.rpartition(".")[2] in _FILES and isinstance(value, str):
        return str((folder / expanded(value)).absolute())
    return value


def _word(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_word(each)}" for key, each in value.items())
    return (
        Path(value).stem
        if isinstance(value, str) and value.endswith((".csv", ".msh"))
        else str(value)
    )


def sweep_json_schema() -> dict[str, Any]:
    """JSON schema of a sweep as people write it."""
    schema = Sweep.model_json_schema()
    kinds = {kind.__name__: kind.model_json_schema() for kind in _AXES}
    defs = schema.setdefault("$defs", {})
    for kind in kinds.values():
        defs |= kind.pop("$defs", {})
    defs |= kinds
    anyof = [{"type": "array", "minItems": 1}, *({"$ref": f"#/$defs/{name}"} for name in kinds)]
    table = {
        "type": "string",
        "description": "CSV file: a column for each key, its unit in brackets, and a row for each scene.",
    }
    schema["properties"]["over"] |= {
        "properties": {"table": table},
        "additionalProperties": {"anyOf": anyof},
        "minProperties": 1,
    }
    return published_schema(schema, "A fingerpad sweep")
