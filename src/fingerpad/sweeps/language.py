"""The sweep language: a base scene, the keys that vary, the design, and what is kept.

    scene: ../scenes/press10.yaml
    over:
      stimulus.curvature: ["79 1/m", "210 1/m", "630 1/m"]
      motion[0].press_to_force: {range: ["2 gf", "200 gf"], count: 9, spacing: logarithmic}
      specimen.layers.fat.youngs_modulus:
        {lognormal: {median: "15 kPa", factor: 1.5}, within: ["5 kPa", "40 kPa"]}

An axis is a list of values, a range, a distribution, words with a value each, or a folder of files.
Distributions, and ranges without a count, are drawn together in a design of points; all else is
crossed with every other axis. ``table: samples.csv`` under ``over`` is a design of one's own: its
columns are keys with their units, such as ``stimulus.curvature (1/m)``, its rows scenes.
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, ValidationInfo

from fingerpad.documents import HIDE, Problem, SceneError, Strict, explain, nearest, read_yaml
from fingerpad.fields import filled, listed, number, published_schema, whole
from fingerpad.files import expanded
from fingerpad.measures.known import OF_ANY, known
from fingerpad.scenes.scene import LEVELS, Scene, load_scene
from fingerpad.tables import TableError, read_table
from fingerpad.units import QuantityError, dimension_of, number_of, parse_quantity, unit_of

MOST = 1_000_000
"""Scenes of a sweep."""
STANDARD = ("indentation_depth", "contact_width", "normal_force", "peak_pressure", "strain_energy")
"""Measures kept unless a sweep says which."""
RESERVED = (
    "scene draw doubts relaxed failed diagnosis estimated_error cpu_s nodes steps iterations"
).split()
"""Names in the results that no axis can have."""
_FILES = ("csv", "mesh", "table")
"""Keys whose values are paths."""


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


@dataclass(frozen=True)
class Unit:
    """The unit of an axis.

    Attributes
    ----------
    text : str
        As written; "1" for numbers without a unit.
    dimension : str
        A key of `fingerpad.units.DIMENSIONS`.
    """

    text: str
    dimension: str

    @classmethod
    def of(cls, value: Any) -> Unit:
        """The unit of a quantity as it is written. Raises `Problem`."""
        if _is_number(value):
            return cls("1", "dimensionless")
        if not isinstance(value, str):
            allowed = "text such as '15 kPa', or a number where none is needed"
            raise Problem("is not a number with its unit", allowed)
        try:
            text = unit_of(value) or "1"
        except QuantityError as error:
            raise Problem(error.problem, error.allowed) from None
        if (dimension := dimension_of(text)) is None:
            raise Problem("has an unknown unit", "a number with its unit such as '15 kPa'")
        return cls(text, dimension)

    def read(self, value: Any, *key: str) -> float:
        """A quantity in this unit. Raises `Problem`, at `key`, if it has another dimension."""
        if self.dimension == "dimensionless" and _is_number(value):
            return float(value)
        try:
            si = parse_quantity(value, self.dimension)
            if unit_of(value) == self.text:  # as written, not by way of SI
                return number_of(value)
            return float(f"{si / parse_quantity(f'1 {self.text}', self.dimension):.12g}")
        except QuantityError as error:
            raise Problem(error.problem, error.allowed, key) from None

    def rising(self, pair: tuple[Any, Any], key: str) -> tuple[float, float]:
        """Two rising quantities in this unit. Raises `Problem` at `key`."""
        low, high = (self.read(value, key) for value in pair)
        if not low < high:
            raise Problem("is not rising", "two values, the lower one first", (key,))
        return low, high

    def written(self, value: float) -> str | float:
        """A number in this unit as a scene takes it."""
        return value if self.text == "1" else f"{value!r} {self.text}"


def _quantity(value: Any) -> Any:
    Unit.of(value)
    return value


def _pair(value: Any) -> Any:
    if len(listed(value)) != 2:
        raise Problem("is not a pair", "two values, the lower one first")
    return tuple(value)


def _pattern(value: Any) -> Any:
    path = not isinstance(value, str) or {"/", "\0"} & set(value) or "**" in value
    if path or value in ("", ".", ".."):
        raise Problem("is not the pattern of a file's name", "one such as *.csv, without folders")
    return value


_QUANTITY = {"anyOf": [{"type": "number"}, {"type": "string"}], "examples": ["15 kPa"]}
Quantity = Annotated[Any, BeforeValidator(_quantity), Field(json_schema_extra=_QUANTITY)]
"""A number with its unit, of any dimension: the scene says which fits."""
_TWO = {"minItems": 2, "maxItems": 2}
Pair = Annotated[tuple[Quantity, Quantity], BeforeValidator(_pair), Field(json_schema_extra=_TWO)]


# --- kinds of axis --------------------------------------------------------------------------------


class Axis(Strict):
    """What all axes have: a name in the results."""

    name: str | None = None
    """What it is called in the results; left out, the last words of its key."""

    drawn: ClassVar[bool] = False
    """Whether its values are drawn, not listed."""

    @property
    def unit(self) -> Unit | None:
        """The unit of its values; None where they are words."""
        return None

    def written(self) -> list[Any]:
        """Values as a scene takes them, of an axis that is not drawn."""
        raise NotImplementedError

    def labels(self) -> list[Any]:
        """Its values in the results: numbers in `unit`, or words."""
        raise NotImplementedError


class Values(Axis):
    """Values one by one."""

    values: Annotated[tuple[Any, ...], BeforeValidator(filled)]
    """The values, as a scene takes them."""

    @cached_property
    def unit(self):
        try:
            unit = Unit.of(self.values[0])
            for value in self.values:
                unit.read(value)
        except Problem:
            return None
        return unit

    def written(self):
        return list(self.values)

    def labels(self):
        return [self.unit.read(v) if self.unit else _word(v) for v in self.values]


class Column(Values):
    """A column of a table of samples; a scene takes one row of all columns."""


class Words(Axis):
    """Values by a word each."""

    words: Annotated[dict[str, Any], Field(min_length=1)]
    """Word -> value, which may be a whole part of a scene."""

    def written(self):
        return list(self.words.values())

    def labels(self):
        return list(self.words)


class Folder(Axis):
    """Every file of a folder: profiles, for example."""

    folder: Path
    """The folder, relative to the sweep's file."""
    pattern: Annotated[str, BeforeValidator(_pattern)] = "*.csv"
    """Which of its files."""

    @cached_property
    def files(self) -> list[Path]:
        hidden = self.pattern.startswith(".")
        found = self.folder.glob(self.pattern)
        return sorted(path for path in found if hidden or not path.name.startswith("."))

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
        low, high = (self.unit.read(value, "range") for value in self.range)
        if low == high:
            raise Problem("is no range", "two values that differ", ("range",))
        if self.spacing == "logarithmic" and not (low > 0 and high > 0):
            raise Problem("cannot be logarithmic", "values above zero", ("range",))
        return low, high

    def labels(self):
        steps = np.geomspace if self.spacing == "logarithmic" else np.linspace
        return [float(f"{value:.12g}") for value in steps(*self.ends, self.count)]

    def written(self):
        return [self.unit.written(value) for value in self.labels()]

    def distribution(self) -> Any:
        """The distribution of what is drawn, of `scipy.stats`, in `unit`. Raises `Problem`."""
        from scipy import stats  # a second to import

        low, high = sorted(self.ends)
        if self.spacing == "logarithmic":
            return stats.loguniform(low, high)
        return stats.uniform(low, high - low)


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

    drawn: ClassVar[bool] = True
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
    def unit(self):
        if self.uniform:
            return Unit.of(self.uniform[0])
        return Unit.of(self.normal.mean if self.normal else self.lognormal.median)

    def distribution(self) -> Any:
        """The distribution of `scipy.stats`, in `unit`, not truncated. Raises `Problem`."""
        from scipy import stats  # a second to import

        if self.uniform:
            low, high = self.unit.rising(self.uniform, "uniform")
            return stats.uniform(low, high - low)
        if self.normal:
            sd = self.unit.read(self.normal.sd, "normal", "sd")
            if not sd > 0:
                allowed = "a standard deviation above zero"
                raise Problem("is not above zero", allowed, ("normal", "sd"))
            return stats.norm(self.unit.read(self.normal.mean), sd)
        median = self.unit.read(self.lognormal.median)
        if not median > 0:
            raise Problem("is not above zero", "a median above zero", ("lognormal", "median"))
        return stats.lognorm(math.log(self.lognormal.factor), scale=median)


def quantiles(axis: Range | Distribution, shares: Any) -> Any:
    """Quantiles of a drawn axis.

    Parameters
    ----------
    axis : Range or Distribution
        The axis; its distribution may be truncated.
    shares : array, shape (n,)
        Probabilities from 0 to 1.

    Returns
    -------
    array, shape (n,)
        Values in the unit of the axis.

    Raises
    ------
    Problem
        The axis has no distribution.
    """
    whole_axis = axis.distribution()
    low, high = 0.0, 1.0
    if getattr(axis, "within", None):
        low, high = whole_axis.cdf(axis.unit.rising(axis.within, "within"))
        if not high > low:
            allowed = "a range that has some of it"
            raise Problem("leaves nothing of the distribution", allowed, ("within",))
    return whole_axis.ppf(low + shares * (high - low))


KINDS: dict[str, type[Axis]] = {
    "values": Values,
    "words": Words,
    "folder": Folder,
    "range": Range,
    "uniform": Distribution,
    "normal": Distribution,
    "lognormal": Distribution,
}
"""Key that an axis is known by -> its kind."""


def _axis(value: Any, info: ValidationInfo) -> Axis:
    """An axis of the kind that its keys say."""
    if isinstance(value, Axis):
        return value
    if not isinstance(value, Mapping):
        value = {"values": filled(value)}
    kinds = [kind for kind in KINDS if kind in value]
    if len(kinds) != 1:
        fields = [*KINDS, "name", "within", "source", "count", "spacing", "pattern"]
        allowed = "a list of values, or one of range, uniform, normal, lognormal, words, folder"
        for key in value:
            if key not in fields:
                what = f"is not a known key{nearest(key, fields)}"
                raise Problem(what, allowed, (str(key)[:60],), HIDE)
        raise Problem("is not exactly one kind of axis", allowed, value=value)
    if kinds == ["folder"] and isinstance(value["folder"], str) and info.context is not None:
        value = {**value, "folder": info.context.parent / expanded(value["folder"])}
    axis = KINDS[kinds[0]].model_validate(value, context=info.context)
    if axis.drawn:
        quantiles(axis, 0.5)
    elif not axis.labels():
        raise Problem(f"holds no file {axis.pattern}", "a folder of one or more", ("folder",))
    return axis


def _axes(value: Any, info: ValidationInfo) -> dict[str, Any]:
    """The mapping of keys to axes, with the columns of a table in place of its path."""
    if not isinstance(value, Mapping) or not value:
        raise Problem(
            "is not a mapping of keys",
            "keys of the scene such as stimulus.curvature, each with its values",
        )
    axes = {str(key): axis for key, axis in value.items()}
    if "table" in axes:
        try:
            columns = _columns(axes["table"], info)
        except TableError as error:
            raise Problem(error.problem, error.allowed, ("table",)) from None
        before = list(axes).index("table")
        items = list(axes.items())
        axes = dict(items[:before]) | columns | dict(items[before + 1 :])
    return axes


def _columns(value: Any, info: ValidationInfo) -> dict[str, Column]:
    """The axes of a table of samples, whose header is keys with units. Raises `TableError`."""
    if not isinstance(value, (str, Path)):
        what = "the path of a CSV file whose columns are keys of the scene"
        raise TableError("is not a path", what)
    path = expanded(value) if info.context is None else info.context.parent / expanded(value)
    try:
        table = read_table(path)
    except FileNotFoundError:
        what = "the path of a CSV file, relative to the sweep"
        raise TableError("is not an existing file", what) from None
    except OSError as error:
        raise TableError(f"cannot be read ({error.strerror})", "a CSV file") from None
    if not table.rows:
        raise TableError("has no rows", "a row for each scene")
    columns = {}
    for k, name in enumerate(table.header):
        key, unit = match.groups() if (match := _WITH_UNIT.fullmatch(name)) else (name, "")
        if not key:
            what = f"has no name for column {k + 1}"
            raise TableError(what, "a key in each; no index: in pandas to_csv(index=False)")
        cells = [row[k] for row in table.rows]
        if unit or all(map(_like_a_number, cells)):
            cells = [f"{value!r} {unit}" if unit else value for value in table.numbers(k)]
        if key in columns:
            raise TableError(f"has two columns of the key '{key[:60]}'", "each key once")
        columns[key] = Column(values=cells)
    return columns


_WITH_UNIT = re.compile(r"(.+?)\s+[(\[](.*)[)\]]")
"""A column's name: `stimulus.curvature (1/m)` or `stimulus.curvature [1/m]`."""


def _like_a_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell.replace(",", ".", 1)))
    except ValueError:
        return False


def _keep(value: Any) -> Any:
    measures = known(filled(value))
    for i, name in enumerate(value):
        if name not in measures:
            allowed = f"{', '.join(OF_ANY)}, and those of measures.csv"
            raise Problem(f"is not a measure{nearest(name, measures)}", allowed, (i,))
        if measures[name].beside or measures[name].of == "mesh":
            allowed = "measures of one history or of a scene"
            raise Problem("is not a measure of one history", allowed, (i,))
    return tuple(dict.fromkeys(value))


# --- the sweep ------------------------------------------------------------------------------------


AnyAxis = Annotated[
    Any,
    BeforeValidator(
        _axis,
        json_schema_input_type=Annotated[list[Any], Field(min_length=1)]
        | Values
        | Words
        | Folder
        | Range
        | Distribution,
    ),
]
_TABLE = {
    "type": "string",
    "description": "CSV file: a column for each key, its unit in brackets, "
    "and a row for each scene.",
}
_OVER = {"properties": {"table": _TABLE}, "minProperties": 1}
_ACCURACY = {"anyOf": [{"enum": list(LEVELS)}, {"type": "number"}, {"type": "object"}]}


class Sweep(Strict):
    """A base scene and the keys of it that vary."""

    scene: Any = Field(json_schema_extra={"anyOf": [{"type": "string"}, {"type": "object"}]})
    """The base scene: the path of a scene, relative to this file, or a scene."""
    over: Annotated[dict[str, AnyAxis], BeforeValidator(_axes), Field(json_schema_extra=_OVER)]
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
    accuracy: Any = Field(default=None, json_schema_extra=_ACCURACY)
    """Accuracy in place of what the scene says."""

    def __repr__(self) -> str:
        drawn = "" if self.samples is None else f" of {self.samples} points, seed {self.seed}"
        over, kept = ", ".join(self.over), len(self.keep)
        return f"Sweep({self.design}{drawn} over {over}; keeps {kept} measures)"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(key)}</td><td>{html.escape(str(axis))}</td></tr>"
            for key, axis in self.over.items()
        )
        return f"<table>{rows}</table><p>{html.escape(repr(self))}</p>"


@dataclass(frozen=True)
class Read:
    """A sweep as it was read.

    Attributes
    ----------
    name : str
        Its name.
    file : Path
        Its file, which need not exist.
    sweep : Sweep
        What it says.
    base : Scene
        The base scene at its accuracy.
    """

    name: str
    file: Path
    sweep: Sweep
    base: Scene

    @cached_property
    def names(self) -> dict[str, str]:
        """Key -> name of the axis: its own, or the fewest last words of the key that tell it
        apart.
        """
        words = {k: k.replace("[", ".").replace("]", "").split(".") for k in self.sweep.over}
        taken = [*words.values(), *([name] for name in RESERVED)]
        axes = self.sweep.over.items()
        return {key: axis.name or "_".join(_last(words[key], taken)) for key, axis in axes}


def _last(words: list[str], taken: list[list[str]]) -> list[str]:
    """The fewest last words that no other of ``taken`` has; a bare number says nothing."""
    for count in range(1, len(words)):
        last = words[-count:]
        others = [other for other in taken if other is not words]
        if not "".join(last).isdigit() and all(other[-count:] != last for other in others):
            return last
    return words


def load_sweep(
    source: str | Path | Mapping[str, Any], name: str = "sweep", scene: Scene | None = None
) -> Read:
    """Read and check a sweep.

    Parameters
    ----------
    source : path or dict
        YAML file, or a dictionary, whose paths are relative to the working directory.
    name : str
        Name of a dictionary's sweep.
    scene : Scene, optional
        The base scene, in place of the sweep's own.

    Raises
    ------
    SceneError
        The file cannot be read or anything in it is wrong; its text is one line.
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
    try:
        _check(read)
    except Problem as problem:
        raise SceneError(f"{shown}: {problem}") from None
    return read


def _base(scene: Any, path: Path) -> Scene:
    if isinstance(scene, Mapping):
        return load_scene(scene, str(path.with_suffix("")))
    if not isinstance(scene, str):
        raise SceneError(
            f"{path}: scene: is not a scene; "
            "allowed: the path of a scene relative to this file, or a scene"
        )
    return load_scene(path.parent / expanded(scene))


def _check(read: Read) -> None:
    """Raise `Problem` for what concerns several keys."""
    sweep, axes = read.sweep, read.sweep.over
    drawn = [key for key, axis in axes.items() if axis.drawn]
    tabled = [len(axis.values) for axis in axes.values() if isinstance(axis, Column)]
    if drawn and sweep.design == "grid":
        count = "a count, or " if isinstance(axes[drawn[0]], Range) else ""
        allowed = f"{count}design: latin_hypercube or sobol"
        raise Problem("is drawn, but the design is a grid", allowed, ("over", drawn[0]))
    if not drawn and sweep.design != "grid":
        what = f"{sweep.design} draws, but no key is a distribution"
        raise Problem(what, "a distribution, or design: grid", ("design",))
    if drawn and sweep.samples is None:
        raise Problem("is missing", "how many points are drawn", ("samples",))
    if not drawn and sweep.samples is not None:
        allowed = "a distribution, or no samples"
        raise Problem("is given, but nothing is drawn", allowed, ("samples",))
    if tabled and drawn:
        allowed = "a list, or a column of the table"
        raise Problem("is drawn beside a table of samples", allowed, ("over", drawn[0]))
    names = list(read.names.values())
    for name in names:
        twice = names.count(name) > 1
        if twice or not name.replace("_", "").isalnum():
            what = f"the name {name!r} is {'given twice' if twice else 'not one word'}"
            raise Problem(what, "a name each", ("over",))
    counts = [
        len(axis.labels())
        for axis in axes.values()
        if not axis.drawn and not isinstance(axis, Column)
    ]
    count = (sweep.samples or 1) * math.prod(counts + tabled[:1])
    if count > MOST:
        raise Problem(f"makes {count} scenes", f"up to {MOST}", ("over",))


def resolved(key: str, value: Any, folder: Path) -> Any:
    """A value of a key with the paths in it absolute: those relative to `folder`."""
    if isinstance(value, Mapping):
        return {name: resolved(name, part, folder) for name, part in value.items()}
    if key.rpartition(".")[2] in _FILES and isinstance(value, str):
        return str((folder / expanded(value)).absolute())
    return value


def _word(value: Any) -> str:
    """A value as one word or a few, for the results."""
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {_word(part)}" for key, part in value.items())
    if isinstance(value, str) and value.endswith((".csv", ".msh")):
        return Path(value).stem
    return str(value)


def sweep_json_schema() -> dict[str, Any]:
    """JSON schema of a sweep as people write it."""
    return published_schema(Sweep.model_json_schema(), "A fingerpad sweep")
