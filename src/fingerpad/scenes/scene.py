"""A scene: specimen, stimulus, motion, outputs and accuracy, read from YAML and checked.

Quantities are strings with units in a document and SI floats in the models. In Python the models
are made with SI floats directly (``Cylinder(curvature=210.0)``).
"""

from __future__ import annotations

import hashlib
import html
import json
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_args

import yaml
from pydantic import BeforeValidator, Field, ValidationError, model_validator
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import HIDE, Problem, SceneError, Strict, explain, nearest
from fingerpad.fields import (
    SI,
    Length,
    OneOf,
    SignedLength,
    Time,
    listed,
    number,
    published_schema,
    quantity,
    whole,
)
from fingerpad.scenes.effects import EFFECTS
from fingerpad.scenes.families import Written, read_scene
from fingerpad.scenes.specimen import (
    DEFAULT_SPECIMEN,
    HalfRound,
    InnerRidges,
    Layer,
    Layers,
    OuterRidges,
    Outline,
    PronyTerm,
    Ridges,
    Slab,
    Source,
    Specimen,
    SpecimenFile,
    source_of,
    turned,
)
from fingerpad.scenes.trouble import OnTrouble, Relaxing
from fingerpad.stimuli.motion import (
    MAXIMUM_STEPS,
    Hold,
    Lift,
    Motion,
    PressToDepth,
    PressToForce,
    Slide,
    StepAndRepeat,
    check_programme,
    end_time,
)
from fingerpad.stimuli.shapes import (
    SHAPES,
    Bar,
    Cone,
    Cylinder,
    Flat,
    Line,
    Punch,
    Sampled,
    Sphere,
    Stimulus,
    Wavy,
)
from fingerpad.units import QuantityError, format_quantity, parse_number

__all__ = [
    "Bar",
    "Cone",
    "Cylinder",
    "Discretisation",
    "Flat",
    "HalfRound",
    "Hold",
    "Layer",
    "Layers",
    "Lift",
    "Line",
    "Outline",
    "Outputs",
    "PressToDepth",
    "PressToForce",
    "PronyTerm",
    "Punch",
    "Receptors",
    "Relaxing",
    "Sampled",
    "Scene",
    "SceneError",
    "Slab",
    "Slide",
    "Specimen",
    "SpecimenFile",
    "Sphere",
    "StepAndRepeat",
    "Wavy",
    "load_scene",
    "recorded_scene",
    "scene_json_schema",
    "specimen_json_schema",
]

MAXIMUM_SNAPSHOTS = 1000


# --- outputs, accuracy, effects -------------------------------------------------------------------


class Receptors(Strict):
    """Material points at which strain energy is recorded: every depth at every offset."""

    depths: Annotated[tuple[Length, ...], BeforeValidator(listed)]
    """Depths below the skin; left out, those of the thesis's specimen."""
    offsets: Annotated[tuple[SignedLength, ...], BeforeValidator(listed)] = (0.0,)
    """Lateral positions."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Depths left out are those of the default specimen."""
        if "depths" not in data:
            depths = source_of(context).part(DEFAULT_SPECIMEN, "receptor_depths")
            data["depths"] = [SI(depth) for depth in depths]
        return data


class Every(Strict):
    """Times at regular intervals, from one interval after the start to the end of the motion."""

    every: Time
    """Interval."""


_Time: Any = quantity("time", "non-negative")
_Times = Annotated[tuple[_Time, ...], BeforeValidator(listed)]
_PerLeg: Any = whole(1, MAXIMUM_SNAPSHOTS)
Afferent = Literal["slowly_adapting", "rapidly_adapting"]
_ResponsesSurface = bool | list[Afferent]


def _read_responses(value: Any) -> Any:
    known = get_args(Afferent)
    if isinstance(value, bool):
        return known[:1] if value else ()
    for i, name in enumerate(listed(value)):
        if name not in known:
            raise Problem(
                f"is not a kind of receptor{nearest(name, known)}", ", ".join(known), (i,)
            )
    return tuple(dict.fromkeys(value))


class Outputs(Strict):
    """What a simulation records beside its history."""

    receptors: Receptors
    """Where strain energy is recorded."""
    snapshots: Annotated[
        tuple[float, ...],
        OneOf(
            lambda value: Every if isinstance(value, (Mapping, Every)) else _Times,
            {"times": _Times, "every": Every},
        ),
    ] = ()
    """Times of full fields: a list, or {every: "0.1 s"}; in a scene always the times."""
    per_leg: _PerLeg | None = None
    """Least number of outputs in each press and hold that takes time; left out, as many as the
    accuracy takes steps.
    """
    responses: Annotated[
        tuple[Afferent, ...],
        BeforeValidator(_read_responses, json_schema_input_type=_ResponsesSurface),
    ] = ()
    """Impulses predicted for the receptors: true (slowly adapting), or a list of slowly_adapting
    and rapidly_adapting.
    """

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Receptors left out are those of the default specimen."""
        data.setdefault("receptors", {})
        return data


_Tolerance: Any = number("a tolerance above 0 and below 1", 0.0, 1.0)
_Steps: Any = whole(1, MAXIMUM_STEPS)
_SWITCH = {True: True, False: False, "on": True, "off": False, "true": True, "false": False}
_Switch = bool | Literal["on", "off", "true", "false"]


def _switch(value: Any) -> bool:
    if not isinstance(value, (bool, str)) or value not in _SWITCH:
        raise Problem("is not a switch", "on or off")
    return _SWITCH[value]


class Discretisation(Strict):
    """Accuracy by hand; what is left out is chosen by the plan, as for the tolerance or else as for
    `thesis`.
    """

    tolerance: _Tolerance | None = None
    """Relative error allowed: a run that turns out to be worse is refined and run again."""
    once: Annotated[bool, BeforeValidator(_switch, json_schema_input_type=_Switch)] = False
    """Whether a tolerance is tried for once only."""
    element: Literal["Q1P0", "Q2P1", "P2B"] | None = None
    """Element: displacement and pressure interpolation."""
    skin_edge: Length | None = None
    """Length of the element edges along the skin where contact is expected."""
    steps: _Steps | None = None
    """Number of time steps of the whole motion."""

    @model_validator(mode="after")
    def _check(self) -> Discretisation:
        for key in ("skin_edge", "steps"):
            if self.tolerance is not None and getattr(self, key) is not None:
                problem = "is given beside a tolerance, which chooses it"
                raise Problem(problem, "one of both", (key,))
        return self


Level = Literal["draft", "thesis", "fine"]
LEVELS = get_args(Level)
_ACCURACY = (
    f"{', '.join(LEVELS)}, a tolerance above 0 and below 1, "
    "or a mapping of tolerance and once, or element, skin_edge, steps"
)


def _accuracy_of(value: Any) -> Any:
    if isinstance(value, (Mapping, Discretisation)):
        return Discretisation
    if isinstance(value, str) and value in LEVELS:
        return Level
    try:
        number = parse_number(value) if isinstance(value, str) else value
    except QuantityError:
        number = None
    if isinstance(number, bool) or not isinstance(number, (int, float)):
        raise Problem("is not a known accuracy", _ACCURACY)
    return _Tolerance


_KINDS = {"level": Level, "tolerance": _Tolerance, "discretisation": Discretisation}
Accuracy = Annotated[Level | float | Discretisation, OneOf(_accuracy_of, _KINDS)]


def _read_effects(value: Any) -> dict[str, bool]:
    if value == "auto":
        return {}
    choices = ", ".join(EFFECTS)
    if not isinstance(value, Mapping):
        raise Problem("is not a set of effects", f"auto, or on or off for {choices}")
    effects = {}
    for key, switch in value.items():
        if key not in EFFECTS:
            raise Problem(
                f"is not a known effect{nearest(key, EFFECTS)}", choices, (str(key)[:60],), HIDE
            )
        try:
            effects[key] = _switch(switch)
        except Problem:
            raise Problem("is not a switch", "on or off", (key,)) from None
    return effects


_EffectsSurface: Any = (
    Literal["auto"] | dict[Literal[tuple(EFFECTS)], _Switch]  # type: ignore[misc]
)
Effects = Annotated[
    dict[str, bool], BeforeValidator(_read_effects, json_schema_input_type=_EffectsSurface)
]


# --- scene ----------------------------------------------------------------------------------------


_Friction: Any = number("a coefficient of zero or more", 0.0, math.inf, low_included=True)


Kinematics = Literal["plane_strain", "axisymmetric"]


class Scene(Strict):
    """One simulation: something pressed on a fingerpad, what to record and how well.

    Examples
    --------
    >>> scene = load_scene({"stimulus": {"shape": "flat"}, "motion": [{"press_to_depth": "1 mm"}]})
    >>> scene
    Scene('scene', flat, press_to_depth, accuracy thesis)
    >>> scene.varied({"friction": 0.3}).friction
    0.3
    """

    internal: ClassVar = frozenset({"name", "tags"})

    name: SkipJsonSchema[str]
    tags: SkipJsonSchema[dict[str, str]] = Field(default_factory=dict)
    """Family and place in it, of a scene that has one: {"family": "ramp40", "surface": "k210"}."""
    kinematics: Kinematics = Field("plane_strain", exclude_if=lambda given: given == "plane_strain")
    """What a section stands for: a body that goes on for ever across it, or one of revolution about
    x = 0, whose forces are in newtons.
    """
    specimen: Specimen
    """What is touched; parts left out are the thesis's."""
    stimulus: Stimulus
    """What touches it: flat, cylinder, bar, line, sampled, wavy, sphere, punch or cone."""
    friction: _Friction = 0.0
    """Coulomb coefficient of friction."""
    motion: Motion
    """Programme of legs, one after the other."""
    outputs: Outputs
    """What is recorded."""
    accuracy: Accuracy = "thesis"
    """draft, thesis, fine, a tolerance such as 0.02, or a mapping."""
    effects: Effects = Field(default_factory=dict)
    """auto, or switches for effects that the plan shall not decide."""
    on_trouble: OnTrouble = Field("relax", exclude_if=lambda given: given == "relax")
    """What a run in trouble does: relax, stop, or a mapping of relax and budget.

    It is in trouble if it breaks off, labours or doubts itself.
    """

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """The name is the file's, the tags are the family's; specimen and outputs left out are the
        default specimen's.
        """
        if context is not None:
            data["name"], data["tags"] = context.path.stem, context.tags
        data.setdefault("specimen", {})
        data.setdefault("outputs", {})
        if data.get("kinematics") == "axisymmetric":
            data["specimen"] = turned(data["specimen"])
        depths, outputs = _middles(data["specimen"], context), data["outputs"]
        receptors = outputs.get("receptors", {}) if isinstance(outputs, Mapping) else None
        if depths and isinstance(receptors, Mapping):
            receptors = {"depths": [SI(depth) for depth in depths], **receptors}
            data["outputs"] = {**outputs, "receptors": receptors}
        return data

    def __repr__(self) -> str:
        legs = ", ".join(leg.key for leg in self.motion)
        return f"Scene({self.name!r}, {self.stimulus.shape}, {legs}, accuracy {self.accuracy})"

    def _repr_html_(self) -> str:
        """The scene as YAML, for notebooks."""
        text = yaml.safe_dump(self.canonical(), sort_keys=False, allow_unicode=True)
        return f"<pre>{html.escape(text)}</pre>"

    @model_validator(mode="after")
    def _check(self) -> Scene:
        if self.axisymmetric:
            self._check_turned()
        elif self.kinematics not in self.stimulus.kinematics:
            problem = "is a body of revolution"
            raise Problem(problem, "kinematics: axisymmetric beside it", ("stimulus", "shape"))
        try:
            check_programme(self.motion, self.stimulus.length)
        except Problem as problem:
            raise problem.below("motion") from None
        self._check_inside()
        outputs, end = self.outputs, self.end_time
        if outputs.responses and end == 0:
            allowed = "a rate, a speed or a hold in it"
            raise Problem("needs a motion that takes time", allowed, ("outputs", "responses"))
        if isinstance(outputs.snapshots, Every):
            # the model is frozen, and only here is the motion known
            times = {"snapshots": self._times(outputs.snapshots.every)}
            object.__setattr__(self, "outputs", outputs.model_copy(update=times))
        for i, time in enumerate(self.outputs.snapshots):
            if end is not None and time > end * (1 + 1e-9):
                key = ("outputs", "snapshots", i)
                allowed = f"up to {format_quantity(end, 'time')}"
                raise Problem("is after the end of the motion", allowed, key)
        return self

    @property
    def axisymmetric(self) -> bool:
        """Whether it is a body of revolution."""
        return self.kinematics == "axisymmetric"

    def _check_turned(self) -> None:
        """Refuses what no body of revolution is pressed by or does; mirrors a profile."""
        if self.kinematics not in self.stimulus.kinematics:
            known = [name for name, shape in SHAPES.items() if self.kinematics in shape.kinematics]
            problem = f"is a {self.stimulus.shape}, which is no body of revolution"
            raise Problem(problem, ", ".join(known), ("stimulus", "shape"))
        for i, leg in enumerate(self.motion):
            if leg.along or leg.fresh:
                problem = "leaves the axis, and a body of revolution has no other place"
                raise Problem(problem, "a press, a hold or a lift", ("motion", i, leg.key))
        try:
            object.__setattr__(self, "stimulus", self.stimulus.turned())
        except Problem as problem:
            raise problem.below("stimulus") from None

    def _times(self, every: float) -> tuple[float, ...]:
        """Multiples of an interval up to the end of the motion, s."""
        key, end = ("outputs", "snapshots", "every"), self.end_time
        if end is None:
            raise Problem("needs a motion whose end is known", "a list of times", key)
        if not every <= end * (1 + 1e-9):
            raise Problem("is longer than the motion", f"up to {format_quantity(end, 'time')}", key)
        if end > MAXIMUM_SNAPSHOTS * every:
            least = format_quantity(end / MAXIMUM_SNAPSHOTS, "time")
            raise Problem(f"makes more than {MAXIMUM_SNAPSHOTS} snapshots", f"{least} or more", key)
        return tuple(round(k * every, 12) for k in range(1, int(end / every * (1 + 1e-9)) + 1))

    def _check_inside(self) -> None:
        thickness, half_width = self.specimen.soft_thickness, self.specimen.half_width
        if thickness is None or half_width is None:  # a mesh
            return
        ground = "bone" if self.specimen.stack is None else "base"
        deep, widest = (format_quantity(length, "length") for length in (thickness, half_width))
        below = f"above 0 mm and below the {deep} from the skin to the {ground}"
        receptors, key = self.outputs.receptors, ("outputs", "receptors")
        for i, leg in enumerate(self.motion):
            if leg.depth is not None and leg.depth >= thickness:
                raise Problem(f"presses to the {ground}", below, ("motion", i, "press_to_depth"))
        for i, depth in enumerate(receptors.depths):
            if depth >= thickness:
                raise Problem("is outside the skin", below, (*key, "depths", i))
        for i, offset in enumerate(receptors.offsets):
            if abs(offset) >= half_width:
                side = f"within {widest} of the middle"
                raise Problem("is beside the pad", side, (*key, "offsets", i))
        edge = self.by_hand.skin_edge
        if edge is not None and edge >= half_width:
            raise Problem("is larger than the pad", f"below {widest}", ("accuracy", "skin_edge"))

    @property
    def end_time(self) -> float | None:
        """Duration of the motion, s, steady legs taking none; None if a change of control leaves it
        open.
        """
        return end_time(self.motion)

    @property
    def by_hand(self) -> Discretisation:
        """The discretisation by hand; an empty one where the accuracy is a name or a tolerance."""
        return self.accuracy if isinstance(self.accuracy, Discretisation) else Discretisation()

    @property
    def tolerance(self) -> float | None:
        """Relative error asked for; None for a preset or a discretisation by hand."""
        return self.accuracy if isinstance(self.accuracy, float) else self.by_hand.tolerance

    @property
    def once(self) -> bool:
        """Whether the scene is to be run once, whatever the run's own estimate of its error."""
        return self.by_hand.once

    @property
    def relaxing(self) -> Relaxing | None:
        """How far a run in trouble may relax what the plan chose; None: it stops."""
        if isinstance(self.on_trouble, Relaxing):
            return self.on_trouble
        return Relaxing() if self.on_trouble == "relax" else None

    def varied(self, changes: Mapping[str, Any]) -> Scene:
        """Copy of the scene with some of its keys changed, checked like a scene that was read.

        Parameters
        ----------
        changes
            Dotted key -> value, such as ``{"specimen.layers.fat.youngs_modulus": "20 kPa",
            "motion[0].rate": 0.4}``: text with a unit, an SI number, or a whole part (a model, or a
            mapping of its keys).

        Raises
        ------
        SceneError
            There is no such key, or the scene would be wrong; one line.
        """
        data: Any = self
        for key, value in changes.items():
            path = tuple(
                int(part) if part.isdigit() else part for part in re.findall(r"[^.\[\]]+", key)
            )
            data = _changed(data, path, value, f"{self.name}: {key}")
        if data is self:
            return self
        try:
            return type(self).model_validate(data)
        except ValidationError as error:
            raise explain(error, self.name, data) from None

    def with_accuracy(self, accuracy: Any) -> Scene:
        """Copy of the scene at another accuracy: draft, thesis, fine, a tolerance as number or
        text, or a `Discretisation`.

        It has the outputs of that accuracy, not those asked for in each leg (``outputs.per_leg``).

        Raises
        ------
        SceneError
            It is none of these.
        """
        return self.varied({"accuracy": accuracy, "outputs.per_leg": None})

    def canonical(self) -> dict[str, Any]:
        """The scene as plain data for provenance: SI numbers, names and content hashes in place of
        paths.

        Equal scenes give equal dictionaries, in the same order of keys; `json.dumps` takes them as
        they are.
        """
        data = self.model_dump(mode="json")
        mesh = self.specimen.mesh
        if mesh is not None:
            digest = hashlib.sha256(mesh.read_bytes()).hexdigest()
            data["specimen"]["mesh"] = {"name": mesh.name, "sha256": digest}
        data["stimulus"] |= self.stimulus.recorded()
        return json.loads(json.dumps(data, sort_keys=True))


def recorded_scene(data: Mapping[str, Any]) -> Scene:
    """The scene that `Scene.canonical` described; files it named need not be there any more.

    Raises
    ------
    SceneError
        The description is not of a scene this version knows.
    """
    specimen, mesh = data["specimen"], data["specimen"]["mesh"]
    if mesh is not None:
        specimen = specimen | {"mesh": Path(mesh["name"])}
    stimulus = {key: value for key, value in data["stimulus"].items() if key != "sha256"}
    return scene_of_record({**data, "specimen": specimen, "stimulus": stimulus})


def scene_of_record(data: Mapping[str, Any]) -> Scene:
    """The scene whose `model_dump` is `data`: SI numbers, absolute paths. Raises SceneError."""
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise explain(error, data.get("name", "scene"), data) from None


def _changed(part: Any, path: tuple[str | int, ...], value: Any, where: str) -> Any:
    """`part`, a model, mapping or list of them, as plain data with the value at `path` below it
    replaced.
    """
    if not path:
        return value
    key, *rest = path
    if isinstance(part, Strict):
        follows = type(part).follows.get(str(key), ())
        part = {
            name: getattr(part, name) for name in type(part).model_fields if name not in follows
        }
    if isinstance(part, (list, tuple)):
        if not isinstance(key, int) or key >= len(part):
            raise SceneError(f"{where}: there is no such entry; allowed: 0 to {len(part) - 1}")
        return tuple(
            _changed(item, tuple(rest), value, where) if i == key else item
            for i, item in enumerate(part)
        )
    if not isinstance(part, Mapping):
        raise SceneError(f"{where}: there is no such key")
    if rest and key not in part:
        raise SceneError(f"{where}: {key} is not a known key; allowed: {', '.join(part)}")
    return {**part, key: _changed(part.get(key), tuple(rest), value, where)}


def _middles(specimen: Any, context: Any) -> tuple[float, ...]:
    """Where receptors of a slab or a half-round are unless the scene says: in the middles of its
    layers, m.
    """
    for key, model in (("slab", Slab), ("half_round", HalfRound)):
        stack = specimen.get(key) if isinstance(specimen, Mapping) else getattr(specimen, key, None)
        if stack is not None:
            try:
                return model.model_validate(stack, context=context).receptor_depths
            except ValidationError:
                break  # said where the specimen is read
    return ()


def load_scene(source: Scene | str | Path | Mapping[str, Any], name: str = "scene") -> Scene:
    """Read and check a scene.

    Parameters
    ----------
    source : Scene, path or dict
        A YAML file (or a member of a family, as if it were a file) or a dictionary. Paths in it are
        relative to the file, or to the working directory. Names of specimens are looked up in
        ``config/specimens`` of that folder, of the folders above, and of the package. A `Scene` is
        returned as it is.
    name : str
        Name of a scene from a dictionary; a file's scene has the file's name.

    Returns
    -------
    Scene
        Every quantity is a float in SI.

    Raises
    ------
    SceneError
        The file cannot be read, or something in it is wrong; one line.
    TypeError
        `source` is none of these.

    Examples
    --------
    >>> press = {
    ...     "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...     "motion": [{"press_to_force": "20 gf"}],
    ...     "accuracy": "draft",
    ... }
    >>> scene = load_scene(press)
    >>> scene.stimulus.curvature, round(scene.motion[0].force, 3)
    (210.0, 0.196)
    """
    if isinstance(source, Scene):
        return source
    if not isinstance(source, (str, Path, Mapping)):
        raise TypeError(f"a scene is a Scene, a file or a dictionary, not {type(source).__name__}")
    given = isinstance(source, Mapping)
    path = Path(f"{name}.yaml" if isinstance(source, Mapping) else source)
    written = Written(source, {}, (path,)) if given else read_scene(path)
    home = written.files[0]
    shown = name if given else path if home == path else f"{home} ({path.stem})"
    try:
        return Scene.model_validate(written.document, context=Source(path, written.tags))
    except ValidationError as error:
        raise explain(error, shown, written.document) from None


def scene_json_schema() -> dict[str, Any]:
    """JSON schema of a scene document as people write it (text with units, names of specimens)."""
    schema = Scene.model_json_schema(mode="validation")
    ridges = (Ridges, InnerRidges, OuterRidges)
    for model in (Outline, Layers, Layer, *ridges, Receptors, Outputs, Specimen):
        schema["$defs"][model.__name__].pop("required", None)
    one = {"type": "object", "minProperties": 1}
    schema["properties"] |= {
        "extends": {
            "type": "string",
            "description": "Scene or family to start from; what stands here is merged over it.",
        },
        "over": one
        | {
            "description": "A family: for each key its words, "
            "and for each word what is special to the scenes so called.",
            "additionalProperties": {
                "anyOf": [
                    one | {"additionalProperties": {"type": ["object", "null"]}},
                    {"type": "array"},
                ]
            },
        },
    }
    schema["anyOf"] = [
        {"required": keys} for keys in (["stimulus", "motion"], ["extends"], ["over"])
    ]
    schema.pop("required", None)
    return published_schema(schema, "A fingerpad scene")


def specimen_json_schema() -> dict[str, Any]:
    """JSON schema of a specimen file as people write it."""
    return published_schema(
        SpecimenFile.model_json_schema(mode="validation"), "A fingerpad specimen"
    )
