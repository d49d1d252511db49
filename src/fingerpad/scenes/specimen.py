"""The specimen of a scene: outline or mesh, layers, relaxation, named in config/specimens or
given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    field_serializer,
    model_serializer,
    model_validator,
)
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import HIDE, Problem, Strict, explain, read_yaml
from fingerpad.fields import (
    SI,
    Length,
    OneOf,
    SignedLength,
    Time,
    filled,
    listed,
    number,
    quantity,
)
from fingerpad.files import BUILT_IN, expanded, is_file
from fingerpad.laws import LAWS, Law
from fingerpad.units import QuantityError, format_quantity, parse_number

DEFAULT_SPECIMEN = "thesis"


def _mm(value: float) -> str:
    return format_quantity(value, "length")


class Outline(Strict):
    """Parameters of the pad's symmetric section; apex at (0, apex_height), bottom at (0,
    -depth_below).
    """

    apex_height: Length
    """Height of the skin's apex above the origin."""
    apex_radius: Length
    """Radius of curvature of the skin at the apex."""
    half_width: Length
    """Half the largest width of the section."""
    depth_below: Length
    """Depth of the section's bottom below the origin."""
    epidermis_thickness: Length
    """Epidermis, stratum corneum included."""
    dermis_thickness: Length
    """Dermis."""
    stratum_corneum_thickness: Length
    """Outermost part of the epidermis; a layer of its own if `layers` has one."""
    bone_centre_height: SignedLength
    """Height of the centre of the bone's ellipse."""
    bone_half_width: Length
    """Half-width of the bone's ellipse."""
    bone_half_height: Length
    """Half-height of the bone's ellipse."""
    nail_half_width: Length
    """The lower boundary within this distance of the axis is held by the nail."""

    @property
    def bone_top(self) -> float:
        """Height of the bone's top, m."""
        return self.bone_centre_height + self.bone_half_height

    @property
    def soft_thickness(self) -> float:
        """Thickness of soft tissue from the skin's apex to the bone, m."""
        return self.apex_height - self.bone_top

    @model_validator(mode="after")
    def _check_fit(self) -> Outline:
        mm, height, widest = _mm, self.apex_height, self.half_width
        thickest = max(
            "epidermis_thickness", "dermis_thickness", key=lambda key: getattr(self, key)
        )
        layers, soft = self.epidermis_thickness + self.dermis_thickness, self.soft_thickness
        for wrong, key, problem, allowed in (
            (
                soft <= 0,
                "bone_centre_height",
                "puts the top of the bone outside the skin",
                f"below {mm(height)} less the layers",
            ),
            (
                layers >= soft,
                thickest,
                "makes the layers thicker than the pad: "
                f"epidermis and dermis together are {mm(layers)}",
                f"less than the {mm(soft)} from the skin to the bone",
            ),
            (
                self.bone_half_width >= widest - layers,
                "bone_half_width",
                "leaves no fat beside the bone",
                f"less than {mm(widest - layers)}",
            ),
            (
                self.bone_half_height - self.bone_centre_height >= self.depth_below,
                "bone_half_height",
                "puts the bottom of the bone outside the section",
                f"less than {mm(self.depth_below + self.bone_centre_height)}",
            ),
            (
                self.nail_half_width > widest,
                "nail_half_width",
                "is wider than the section",
                f"up to {mm(widest)}",
            ),
        ):
            if wrong:
                raise Problem(problem, allowed, (key,))
        return self


class ChosenLaw(Strict):
    """A law of fingerpad.laws by its name, with its constants."""

    name: str
    constants: tuple[float, ...] = ()

    @property
    def law(self) -> Law:
        """The law itself."""
        return LAWS[self.name]

    @model_serializer
    def _as_read(self) -> Any:
        return (
            {"name": self.name, **dict(zip(self.law.constants, self.constants, strict=True))}
            if self.constants
            else self.name
        )


def _read_law(value: Any) -> Any:
    """A law by its name, or by a mapping with the name and any of its constants."""
    if isinstance(value, ChosenLaw):
        return value
    given = dict(value) if isinstance(value, Mapping) else {"name": value}
    name = given.pop("name", None)
    if not isinstance(name, str) or name not in LAWS:
        problem = "is missing" if name is None else "is not the name of a law"
        raise Problem(problem, ", ".join(LAWS), ("name",) if isinstance(value, Mapping) else ())
    known, constants = LAWS[name].constants, []
    for key in given:
        if key not in known:
            allowed = ", ".join(known) or "none"
            raise Problem(f"is no constant of {name}", allowed, (str(key)[:60],), HIDE)
    for key, constant in known.items():
        try:
            value = parse_number(given.get(key, constant.default))
        except QuantityError as error:
            raise Problem(error.problem, error.allowed, (key,)) from None
        if not constant.low <= value <= constant.high:
            raise Problem(
                "is outside the range",
                f"a number from {constant.low:g} to {constant.high:g}",
                (key,),
            )
        constants.append(value)
    return ChosenLaw(name=name, constants=tuple(constants))


_LAW_SURFACE = (
    Literal[tuple(LAWS)]
    | Annotated[
        dict[str, float | str],
        Field(
            description="name of a law and its constants, "
            "such as {name: yeoh, second: 0.5, third: 0.1}"
        ),
    ]
)


_NEO_HOOKE = ChosenLaw(name="neo_hooke")


class Layer(Strict):
    """Isotropic elasticity of one layer."""

    hints: ClassVar = {
        "thickness": "is not a key of a layer, "
        "the outline has epidermis_thickness and dermis_thickness"
    }

    youngs_modulus: quantity("pressure")
    """Young's modulus, in the state named by `moduli`."""
    poisson_ratio: number("a number above -1 and below 0.5", -1.0, 0.5)
    """Poisson's ratio, in the state named by `moduli`."""
    law: Annotated[ChosenLaw, BeforeValidator(_read_law, json_schema_input_type=_LAW_SURFACE)] = (
        Field(_NEO_HOOKE, exclude_if=lambda law: law == _NEO_HOOKE)
    )
    """How it stiffens when strained: the name of a law, or keys name and its constants; neo_hooke
    unless given.
    """


class Layers(Strict):
    """The layers between skin and bone."""

    stratum_corneum: Layer | None = Field(None, exclude_if=lambda layer: layer is None)
    """Outermost part of the epidermis, if it is to be a layer of its own; keys left out are the
    epidermis's.
    """
    epidermis: Layer
    """Outermost layer."""
    dermis: Layer
    """Middle layer."""
    fat: Layer
    """From the dermis to the bone."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Keys that the stratum corneum leaves out are the epidermis's."""
        if isinstance(data.get("stratum_corneum"), Mapping):
            below = data.get("epidermis")
            below = _si(below) if isinstance(below, Layer) else below
            below = below if isinstance(below, Mapping) else {}
            data["stratum_corneum"] = {**below, **data["stratum_corneum"]}
        return data


class Material(Layer):
    """Isotropic elasticity of a layer that has a name of its own."""

    hints: ClassVar = {"thickness": "is not a key of a layer of a mesh, which has its own"}

    poisson_ratio: number("a number above -1 and below 0.5", -1.0, 0.5) = 0.48
    """Poisson's ratio, in the state named by `moduli`; 0.48 unless given, and the plan says so."""


def _name(value: Any) -> Any:
    word = isinstance(value, str) and value.isprintable() and value == value.strip()
    if not word or not 0 < len(value) <= 40:
        raise Problem("is not a name", "a word such as cover")
    return value


Name = Annotated[str, BeforeValidator(_name)]


class StackLayer(Material):
    """One layer of a slab or a half-round."""

    hints: ClassVar = {}

    name: Name
    """Name of the layer."""
    thickness: Length | None = None
    """Thickness; that of the innermost layer of a half-round may be left out, it then fills it."""


class Stack(Strict):
    """Bonded layers on a fixed base."""

    layers: Annotated[tuple[StackLayer, ...], BeforeValidator(filled)]
    """Layers from the outside to the inside."""

    @property
    def names(self) -> tuple[str, ...]:
        """Of the layers, outside to inside."""
        return tuple(layer.name for layer in self.layers)

    @property
    def thicknesses(self) -> tuple[float, ...]:
        """Of the layers, m."""
        return tuple(layer.thickness for layer in self.layers)

    @property
    def soft_thickness(self) -> float:
        """From the middle of the surface to the base, m."""
        return math.fsum(self.thicknesses)

    @property
    def receptor_depths(self) -> tuple[float, ...]:
        """Depths (m) of the middles of the layers."""
        ends = list(accumulate(self.thicknesses, initial=0.0))
        return tuple((above + below) / 2 for above, below in pairwise(ends))

    def _check_layers(self, optional: int) -> None:
        """Names differ, and thicknesses are given but for the last ``optional`` layers."""
        for i, layer in enumerate(self.layers):
            if layer.name in self.names[:i]:
                raise Problem(
                    "is the name of two layers", "a name of its own for each", ("layers", i, "name")
                )
            if layer.thickness is None and i < len(self.layers) - optional:
                raise Problem(
                    "is missing", "a length such as '1 mm'", ("layers", i, "thickness"), HIDE
                )


class Slab(Stack):
    """A flat slab of bonded layers on a fixed base, free at its sides: a robot's skin, a
    phantom.
    """

    radius: ClassVar = None

    width: Length
    """Width; the middle of the surface is at x = 0."""

    @property
    def half_width(self) -> float:
        """m."""
        return self.width / 2

    @model_validator(mode="after")
    def _check(self) -> Slab:
        self._check_layers(0)
        return self


class HalfRound(Stack):
    """Half of a cylinder of bonded layers on a fixed base, its top at x = 0; what the layers leave
    of it is a rigid core.
    """

    radius: Length
    """Radius of the surface."""

    @property
    def half_width(self) -> float:
        """m."""
        return self.radius

    @property
    def thicknesses(self) -> tuple[float, ...]:
        """Of the layers, m."""
        *outer, last = (layer.thickness for layer in self.layers)
        return (*outer, self.radius - math.fsum(outer) if last is None else last)

    @property
    def solid(self) -> bool:
        """Whether the layers fill it."""
        return self.soft_thickness > self.radius * (1 - 1e-9)

    @model_validator(mode="after")
    def _check(self) -> HalfRound:
        self._check_layers(1)
        given = math.fsum(layer.thickness or 0.0 for layer in self.layers)
        left_out = self.layers[-1].thickness is None
        if given > self.radius * (1 + 1e-9) or (left_out and given >= self.radius):
            allowed = f"up to the radius, {_mm(self.radius)}"
            raise Problem(f"are {_mm(given)} thick together", allowed, ("layers",), HIDE)
        return self


Height = quantity("length", note=", which would turn ridges into valleys")


class InnerRidges(Strict):
    """The epidermis bulging into the dermis; its mean thickness is kept."""

    pitch: Length
    """From one primary ridge to the next, along the skin."""
    height: Height
    """From valley (thinnest epidermis) to tip (thickest)."""
    shape: Literal["smooth", "sharp"]
    """A cosine, or its square: tips of half the radius, wider valleys."""
    phase: quantity("length", "any", words=("tip", "valley"))
    """What is at x = 0 (valley: halfway between two primary ridges), or the lateral position of the
    nearest primary tip.
    """
    limiting: number("a number from 0 to below 1", 0.0, 1.0, low_included=True)
    """Height over theirs of limiting ridges halfway between the primary ones, which makes all half
    as wide; 0 for none.
    """

    @model_validator(mode="after")
    def _check(self) -> InnerRidges:
        if not isinstance(self.phase, str) and abs(self.phase) > self.pitch / 2:
            half = _mm(self.pitch / 2)
            raise Problem(
                "is farther off than the nearest ridge tip can be",
                f"up to half a pitch, {half}",
                ("phase",),
            )
        return self


class OuterRidges(Strict):
    """The papillary ridges of the skin, whose crests lie over the tips of the inner ones; the
    skin's mean height is kept.
    """

    period: Length | None = None
    """From one ridge to the next, along the skin; the inner ridges' pitch unless given."""
    height: Height
    """From furrow to crest."""
    shape: Literal["smooth", "sharp"]
    """A cosine, or its square: crests of half the radius, wider furrows."""


class Ridges(Strict):
    """Ridges of the pad round its apex."""

    inner: InnerRidges
    """Of the epidermis into the dermis; keys left out are the thesis file's."""
    outer: OuterRidges | None = None
    """Of the skin; none unless given, keys left out are the thesis file's."""
    half_width: Length
    """Distance from the apex, along the skin, within which ridges stand in full; they fade out over
    one pitch beyond.
    """


class PronyTerm(Strict):
    """One term of the relaxation of the shear modulus, g(t) = 1 - sum g_i (1 - exp(-t/tau_i))."""

    g: number("a number above 0 and below 1", 0.0, 1.0)
    """Share of the instantaneous shear modulus that relaxes."""
    tau: Time
    """Relaxation time."""


def _check_prony(terms: tuple[PronyTerm, ...]) -> None:
    total = math.fsum(term.g for term in terms)
    if total >= 1:
        raise Problem(f"the terms g sum to {total:.6g}", "a sum of g below 1", ("prony",), HIDE)


PronySeries = Annotated[tuple[PronyTerm, ...], BeforeValidator(listed)]
Moduli = Literal["long_term", "instantaneous"]


class SpecimenFile(Strict):
    """config/specimens/<name>.yaml: parts of a specimen that scenes refer to by the file's name."""

    outline: Outline | None = None
    """Section of the pad."""
    layers: Layers | None = None
    """Elasticity of the layers."""
    moduli: Moduli | None = None
    """State that the moduli of `layers` describe."""
    prony: PronySeries | None = None
    """Relaxation of the shear modulus, normalised by the instantaneous one; an empty list for
    none.
    """
    contact_length: Length | None = None
    """Out-of-plane length that turns newtons into newtons per metre."""
    ridges: Ridges | None = None
    """What scenes that ask for ridges get unless they say otherwise."""
    receptor_depths: Annotated[tuple[Length, ...], BeforeValidator(listed)] | None = None
    """Depths below the skin at which strain energy is recorded when a scene names none."""

    @model_validator(mode="after")
    def _check(self) -> SpecimenFile:
        _check_prony(self.prony or ())
        return self


def _article(shape: str) -> str:
    return "an outline" if shape == "outline" else f"a {shape}"


class Source:
    """Where a document comes from, and the tags of the family it belongs to: finds the files it
    names and the specimens.
    """

    def __init__(self, path: Path, tags: Mapping[str, str] | None = None) -> None:
        self.path, self.tags = path, dict(tags or {})
        self._files: dict[str, SpecimenFile] = {}

    def resolve(self, name: str) -> Path:
        """Absolute path of a file that the document names relative to itself."""
        return (self.path.parent / expanded(name)).absolute()

    def specimen_files(self) -> dict[str, Path]:
        """The specimen files by name; one in a nearer folder hides one of the same name farther
        away.
        """
        folders = [parent / "config" / "specimens" for parent in self.path.absolute().parents]
        folders = [BUILT_IN / "specimens", *reversed(folders)]
        return {file.stem: file for folder in folders for file in sorted(folder.glob("*.yaml"))}

    def specimen(self, name: str, key: tuple = ()) -> SpecimenFile:
        """The specimen file called `name`; raises `Problem` at `key` when there is none."""
        if name not in self._files:
            found = self.specimen_files()
            if name not in found:
                names = ", ".join(sorted(found)) or "none found"
                raise Problem(
                    "is not the name of a specimen",
                    f"names of files in config/specimens ({names})",
                    key,
                )
            document = read_yaml(found[name])
            try:
                self._files[name] = SpecimenFile.model_validate(document, context=self)
            except ValidationError as error:
                raise explain(error, found[name], document) from None
        return self._files[name]

    def part(self, name: str, part: str) -> Any:
        """Part `part` of the specimen file called `name`."""
        value = getattr(self.specimen(name), part)
        if value is None:
            raise Problem(f"names a specimen file without {part}", "a specimen file that has it")
        return value


def source_of(context: Any) -> Source:
    """The validation context, or in Python, where there is none, the working directory."""
    return context or Source(Path("scene"))


def _si(model: Strict) -> dict[str, Any]:
    """Fields of a model of SI floats, marked so that a document may hold them beside text."""
    return {
        name: SI(value) if isinstance(value, float) else value
        for name, value in model
        if value is not None
    }


SpecimenName = Annotated[
    str, Field(pattern=r"^[^\s/.][^\s/]*$", description="name in config/specimens")
]


def _named(part: str, surface: Any) -> BeforeValidator:
    """Field that may name a specimen file; keys left out of a mapping are the default
    specimen's.
    """

    def read(value: Any, info: ValidationInfo) -> Any:
        source = source_of(info.context)
        if isinstance(value, str):
            return () if (part, value) == ("prony", "none") else source.part(value, part)
        if part == "prony":
            return listed(value)
        if isinstance(value, Mapping) and not isinstance(value, _OwnLayers):
            return _over_default(source, part, value)
        return value

    return BeforeValidator(read, json_schema_input_type=SpecimenName | surface)


def _over_default(source: Source, part: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """What is given of a part of a specimen, over the default specimen's, key by key."""
    filled = _si(source.part(DEFAULT_SPECIMEN, part))
    for key, item in given.items():
        below = filled.get(key)
        merged = isinstance(below, Strict) and isinstance(item, Mapping)
        filled[key] = {**_si(below), **item} if merged else item
    return filled


_RIDGES = Literal["none", "inner", "inner_and_outer"]


def _read_ridges(value: Any, info: ValidationInfo) -> Any:
    """Ridges by a word or by keys; keys left out are the default specimen's, and there are outer
    ridges only if asked for.
    """
    if value is None or isinstance(value, Ridges):
        return value
    if value == "none":
        return None
    if value in ("inner", "inner_and_outer"):
        value = {} if value == "inner" else {"outer": {}}
    if not isinstance(value, Mapping):
        raise Problem(
            "is not the kind of ridges",
            "none, inner, inner_and_outer, or keys inner, outer, half_width",
        )
    filled = _over_default(source_of(info.context), "ridges", value)
    if "outer" not in value:
        del filled["outer"]
    return filled


class _OwnLayers(dict):
    """Layers under names of their own."""


def _layers_of(value: Any) -> Any:
    """The type of layers: a finger's, or some under names of their own."""
    read = isinstance(value, dict) and all(isinstance(each, Material) for each in value.values())
    own = isinstance(value, _OwnLayers) or (read and value)
    return dict[Name, Material] if own else Layers


_FINGER = tuple(Layers.model_fields)
_SHAPES = ("outline", "mesh", "slab", "half_round")
Names = Annotated[tuple[Name, ...], BeforeValidator(listed)]


def _nothing(value: Any) -> bool:
    return not value


class Specimen(Strict):
    """What is touched: a finger's outline, an external mesh, a slab or a half-round, and the
    material of its layers.
    """

    internal: ClassVar = frozenset({"assumed", "stated"})

    outline: Annotated[Outline, _named("outline", Outline)] | None = None
    """Section of the pad, by name or by keys; keys left out are the thesis's."""
    mesh: Path | None = None
    """External mesh in mm instead of an outline: surfaces are layers, a curve skin is touched;
    bone, nail and base are held.
    """
    slab: Slab | None = Field(None, exclude_if=_nothing)
    """A flat slab instead of an outline."""
    half_round: HalfRound | None = Field(None, exclude_if=_nothing)
    """A half-round instead of an outline."""
    fixed: Names = Field((), exclude_if=_nothing)
    """Further curves of the mesh that are held."""
    free: Names = Field((), exclude_if=_nothing)
    """Curves of the mesh that are free; so are boundary edges in no curve."""
    layers: (
        Annotated[
            Layers | dict[str, Material],
            OneOf(_layers_of, {"name": SpecimenName, "finger": Layers, "own": dict[str, Material]}),
            _named("layers", Any),
        ]
        | None
    ) = Field(None, exclude_if=_nothing)
    """Elasticity of the layers, by name or by keys; keys left out are the thesis's. Of a mesh: a
    material for each surface.
    """
    moduli: Moduli
    """State that the moduli of `layers` describe."""
    prony: Annotated[tuple[PronyTerm, ...], _named("prony", tuple[PronyTerm, ...])]
    """Relaxation of shear, normalised by the instantaneous modulus: a name, a list of terms, or
    none.
    """
    ridges: Annotated[
        Ridges | None, BeforeValidator(_read_ridges, json_schema_input_type=Ridges | _RIDGES)
    ] = None
    """Ridges of epidermis and skin: none, inner, inner_and_outer, or keys; keys left out are the
    thesis file's.
    """
    contact_length: Length
    """Out-of-plane length that turns newtons into newtons per metre."""
    assumed: SkipJsonSchema[tuple[str, ...]] = Field((), exclude=True, repr=False)
    """What the scene left out and where it was taken from, in words."""
    stated: SkipJsonSchema[tuple[str, ...]] = Field((), exclude=True, repr=False)
    """Layers that the scene gives by their names."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Parts left out are the default specimen's; `moduli` comes with the file that names
        `layers`.
        """
        source = source_of(context)
        given = {key for key, value in data.items() if value is not None}
        shapes = [key for key in _SHAPES if key in given]
        if len(shapes) > 1:
            allowed = f"one of {' and '.join(shapes)}"
            raise Problem(f"is given beside {_article(shapes[0])}", allowed, (shapes[-1],))
        shape = shapes[0] if shapes else "outline"
        if shape != "mesh":
            for key in ("fixed", "free"):
                if data.get(key):
                    raise Problem("names curves of no mesh", "a mesh beside it", (key,))
        if shape in ("slab", "half_round"):
            for key in ("layers", "ridges"):
                if data.get(key) not in (None, "none"):
                    beside = f"is given beside {_article(shape)}, which has its own layers"
                    raise Problem(beside, f"{shape}.layers", (key,), HIDE)
            layers = data[shape].get("layers") if isinstance(data[shape], Mapping) else ()
            layers = [
                layer
                for layer in (layers if isinstance(layers, (list, tuple)) else ())
                if isinstance(layer, Mapping)
            ]
            return cls._fill_plain(data, [(layer.get("name"), layer) for layer in layers], source)
        if shape == "mesh":
            data["mesh"] = cls._mesh(data["mesh"], context)
            layers = data.get("layers")
            if isinstance(layers, Mapping) and not set(layers) <= set(_FINGER):
                data["layers"] = _OwnLayers(layers)
                return cls._fill_plain(data, layers.items(), source)
        else:
            data.setdefault("outline", DEFAULT_SPECIMEN)
        taken = [
            key
            for key in ("layers", "outline", "prony", "contact_length")
            if key not in given and not (key == "outline" and shape == "mesh")
        ]
        if isinstance(data.get("layers"), Mapping):
            data.setdefault("stated", tuple(data["layers"]))
            taken = [name for name in _FINGER[1:] if name not in data["layers"]] + taken
        data.setdefault("assumed", (f"{', '.join(taken)}: {DEFAULT_SPECIMEN}",) if taken else ())
        data.setdefault("layers", DEFAULT_SPECIMEN)
        data.setdefault("prony", DEFAULT_SPECIMEN)
        if "moduli" not in data:
            named = data["layers"] if isinstance(data["layers"], str) else DEFAULT_SPECIMEN
            moduli = source.specimen(named, ("layers",)).moduli
            data["moduli"] = moduli or source.part(DEFAULT_SPECIMEN, "moduli")
        if "contact_length" not in data:
            data["contact_length"] = SI(source.part(DEFAULT_SPECIMEN, "contact_length"))
        return data

    @staticmethod
    def _mesh(name: Any, context: Any) -> Path:
        """The absolute path of the mesh that a document names.

        In Python a path may be one that a result remembers: whether it is there turns out when it
        is read.
        """
        key = ("mesh",)
        if not isinstance(name, (str, Path)):
            raise Problem("is not a path", "the path of a .msh file", key)
        if context is None and isinstance(name, Path):
            return name
        path = source_of(context).resolve(name)
        if not is_file(path):
            allowed = "the path of a .msh file, relative to the scene"
            raise Problem("is not an existing file", allowed, key)
        return path

    @classmethod
    def _fill_plain(cls, data: dict[str, Any], layers: Any, source: Source) -> dict[str, Any]:
        """Layers under names of their own do not relax unless told, their moduli are then those of
        the long term, and nothing but the contact length is the thesis's.
        """
        left_out = [
            f"poisson_ratio of {name}: 0.48"
            for name, layer in layers
            if isinstance(layer, Mapping) and "poisson_ratio" not in layer
        ]
        if data.get("prony") is None:
            data["prony"] = ()
            left_out.append("prony: none, elastic")
        elif "moduli" not in data:
            left_out.append("moduli: long_term")
        data.setdefault("moduli", "long_term")
        if data.get("contact_length") is None:
            data["contact_length"] = SI(source.part(DEFAULT_SPECIMEN, "contact_length"))
            left_out.append(f"contact_length: {_mm(data['contact_length'])}, {DEFAULT_SPECIMEN}")
        data.setdefault("assumed", tuple(left_out))
        return data

    def __eq__(self, other: object) -> bool:
        """Equal specimens may have been said in other words: what was left out is no part of it."""
        return type(self) is type(other) and self.model_dump() == other.model_dump()

    @property
    def stack(self) -> Stack | None:
        """The slab or the half-round, if it is one."""
        return self.slab or self.half_round

    @property
    def materials(self) -> dict[str, Layer]:
        """Material of each layer by its name, outside to inside."""
        if self.stack is not None:
            return {layer.name: layer for layer in self.stack.layers}
        if not isinstance(self.layers, Layers):
            return self.layers
        return {name: layer for name, layer in self.layers if layer is not None}

    def material(self, name: str) -> Layer:
        """Material of a layer; an external mesh may part the stratum corneum where the scene does
        not.
        """
        known = self.materials
        return known["epidermis" if name == "stratum_corneum" and name not in known else name]

    @property
    def soft_thickness(self) -> float | None:
        """From the middle of the skin to the bone or the base, m; None for a mesh."""
        shape = self.outline or self.stack
        return None if shape is None else shape.soft_thickness

    @property
    def half_width(self) -> float | None:
        """m; None for a mesh."""
        shape = self.outline or self.stack
        return None if shape is None else shape.half_width

    @model_validator(mode="after")
    def _check(self) -> Specimen:
        shapes = sum(getattr(self, shape) is not None for shape in _SHAPES)
        if shapes != 1 or (self.layers is None) == (self.stack is None):
            allowed = "one of outline, mesh, slab and half_round"
            raise Problem("is missing", allowed, ("outline",), HIDE)
        outline = self.outline
        if outline is not None and self.layers.stratum_corneum is not None:
            if outline.stratum_corneum_thickness > outline.epidermis_thickness:
                raise Problem(
                    "is more than the epidermis it belongs to",
                    f"up to {_mm(outline.epidermis_thickness)}",
                    ("outline", "stratum_corneum_thickness"),
                )
        _check_prony(self.prony)
        if self.ridges is not None:
            self._check_ridges()
        return self

    @field_serializer("ridges", mode="wrap")
    def _named_ridges(self, ridges: Ridges | None, handler: SerializerFunctionWrapHandler) -> Any:
        return "none" if ridges is None else handler(ridges)

    def _check_ridges(self) -> None:
        if self.outline is None:
            raise Problem("are given beside a mesh, which has its own", "none", ("ridges",), HIDE)
        inner, outline = self.ridges.inner, self.outline
        corneum = outline.stratum_corneum_thickness if self.layers.stratum_corneum else 0.0
        room = 0.7 * min(outline.epidermis_thickness - corneum, outline.dermis_thickness)
        if inner.height >= room:
            allowed = f"less than {_mm(room)}, 0.7 of epidermis and dermis"
            raise Problem("is too high for the layers", allowed, ("ridges", "inner", "height"))
        if self.ridges.half_width + inner.pitch >= outline.half_width:
            problem = "plus one pitch is more than half of the section's width"
            allowed = f"less than {_mm(outline.half_width - inner.pitch)}"
            raise Problem(problem, allowed, ("ridges", "half_width"))


def turned(specimen: Any) -> Any:
    """The specimen, or what a document says of it, as a body of revolution: its forces are N, so of
    a length of one metre.
    """
    key = "contact_length"
    if isinstance(specimen, Specimen):
        return specimen.model_copy(update={key: 1.0})
    if not isinstance(specimen, Mapping):
        return specimen  # which is said where it is read
    if specimen.get(key) not in (None, 1.0):
        problem = "is of plane strain: forces on a body of revolution are in newtons"
        raise Problem(problem, f"no {key}", ("specimen", key), HIDE)
    return {**specimen, key: SI(1.0)}
