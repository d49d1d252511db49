"""The specimen of a scene: outline or mesh, layers, relaxation, named in config/specimens or
given.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    SerializerFunctionWrapHandler,
    Tag,
    ValidationError,
    ValidationInfo,
    field_serializer,
    model_serializer,
    model_validator,
)
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import HIDE, Problem, Strict, explain, read_yaml
from fingerpad.fields import SI, Length, SignedLength, Time, filled, listed, number, quantity
from fingerpad.files import BUILT_IN, expanded, is_file
from fingerpad.laws import LAWS, Law
from fingerpad.units import QuantityError, format_quantity, parse_number

DEFAULT_SPECIMEN = "thesis"


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
        def mm(value: float) -> str:
            return format_quantity(value, "length")

        layers = self.epidermis_thickness + self.dermis_thickness
        if self.soft_thickness <= 0:
            raise Problem(
                "puts the top of the bone outside the skin",
                f"below {mm(self.apex_height)} less the layers",
                ("bone_centre_height",),
            )
        if layers >= self.soft_thickness:
            key = (
                "epidermis_thickness"
                if self.epidermis_thickness >= self.dermis_thickness
                else "dermis_thickness"
            )
            raise Problem(
                f"makes the layers thicker than the pad: epidermis and dermis together are {mm(layers)}",
                f"less than the {mm(self.soft_thickness)} from the skin to the bone",
                (key,),
            )
        if self.bone_half_width >= self.half_width - layers:
            raise Problem(
                "leaves no fat beside the bone",
                f"less than {mm(self.half_width - layers)}",
                ("bone_half_width",),
            )
        if self.bone_half_height - self.bone_centre_height >= self.depth_below:
            raise Problem(
                "puts the bottom of the bone outside the section",
                f"less than {mm(self.depth_below + self.bone_centre_height)}",
                ("bone_half_height",),
            )
        if self.nail_half_width > self.half_width:
            raise Problem(
                "is wider than the section", f"up to {mm(self.half_width)}", ("nail_half_width",)
            )
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
    name, key = given.pop("name", None), ("name",) if isinstance(value, Mapping) else ()
    if not isinstance(name, str) or name not in LAWS:
        raise Problem(
            "is not the name of a law" if name is not None else "is missing", ", ".join(LAWS), key
        )
    known, constants = LAWS[name].constants, []
    for key in given:
        if key not in known:
            raise Problem(
                f"is no constant of {name}", ", ".join(known) or "none", (str(key)[:60],), HIDE
            )
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
            description="name of a law and its constants, such as {name: yeoh, second: 0.5, third: 0.1}"
        ),
    ]
)


class Layer(Strict):
    """Isotropic elasticity of one layer."""

    hints: ClassVar = {
        "thickness": "is not a key of a layer, the outline has epidermis_thickness and dermis_thickness"
    }

    youngs_modulus: quantity("pressure")
    """Young's modulus, in the state named by `moduli`."""
    poisson_ratio: number("a number above -1 and below 0.5", -1.0, 0.5)
    """Poisson's ratio, in the state named by `moduli`."""
    law: Annotated[ChosenLaw, BeforeValidator(_read_law, json_schema_input_type=_LAW_SURFACE)] = (
        ChosenLaw(name="neo_hooke")
    )
    """How it stiffens when strained: the name of a law, or keys name and its constants; neo_hooke
    unless given.
    """

    @model_serializer(mode="wrap")
    def _without_default(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data = handler(self)
        if self.law == type(self).model_fields["law"].default:
            del data["law"]
        return data


class Layers(Strict):
    """The layers between skin and bone."""

    stratum_corneum: Layer | None = None
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
            below = (
                _si(below)
                if isinstance(below, Layer)
                else below
                if isinstance(below, Mapping)
                else {}
            )
            data["stratum_corneum"] = {**below, **data["stratum_corneum"]}
        return data

    @model_serializer(mode="wrap")
    def _without_nothing(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data = handler(self)
        if self.stratum_corneum is None:
            del data["stratum_corneum"]
        return data


class Material(Layer):
    """Isotropic elasticity of a layer that has a name of its own."""

    hints: ClassVar = {"thickness": "is not a key of a layer of a mesh, which has its own"}

    poisson_ratio: number("a number above -1 and below 0.5", -1.0, 0.5) = 0.48
    """Poisson's ratio, in the state named by `moduli`; 0.48 unless given, and the plan says so."""


def _name(value: Any) -> Any:
    if (
        not isinstance(value, str)
        or not 0 < len(value) <= 40
        or not value.isprintable()
        or value != value.strip()
    ):
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
        given = [layer.thickness for layer in self.layers]
        return (
            tuple(given)
            if given[-1] is not None
            else (*given[:-1], self.radius - math.fsum(given[:-1]))
        )

    @property
    def solid(self) -> bool:
        """Whether the layers fill it."""
        return self.soft_thickness > self.radius * (1 - 1e-9)

    @model_validator(mode="after")
    def _check(self) -> HalfRound:
        self._check_layers(1)
        given = math.fsum(layer.thickness or 0.0 for layer in self.layers)
        if given > self.radius * (1 + 1e-9) or (
            self.layers[-1].thickness is None and given >= self.radius
        ):
            thick = format_quantity(given, "length")
            raise Problem(
                f"are {thick} thick together",
                f"up to the radius, {format_quantity(self.radius, 'length')}",
                ("layers",),
                HIDE,
            )
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
            half = format_quantity(self.pitch / 2, "length")
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


def _lacks(layer: Any, key: str) -> bool:
    return isinstance(layer, Mapping) and key not in layer


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

    def _folders(self) -> Iterator[Path]:
        folder = self.path.absolute().parent
        for parent in (folder, *folder.parents):
            yield parent / "config" / "specimens"
        yield BUILT_IN / "specimens"

    def specimen_files(self) -> dict[str, Path]:
        """The specimen files by name; one in a nearer folder hides one of the same name farther
        away.
        """
        folders = [folder for folder in self._folders() if folder.is_dir()]
        return {
            file.stem: file
            for folder in reversed(folders)
            for file in sorted(folder.glob("*.yaml"))
        }

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
            self._files[name] = _read_specimen(found[name], self)
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


def _read_specimen(path: Path, source: Source) -> SpecimenFile:
    document = read_yaml(path)
    try:
        return SpecimenFile.model_validate(document, context=source)
    except ValidationError as error:
        raise explain(error, path, document) from None


def _si(model: Strict) -> dict[str, Any]:
    """Fields of a model of SI floats, marked so that a document may hold them beside text."""
    values = ((name, getattr(model, name)) for name in type(model).model_fields)
    return {
        name: SI(value) if isinstance(value, float) else value
        for name, value in values
        if value is not None
    }


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
        if isinstance(value, Mapping) and not isinstance(value, _Own):
            default = _si(source.part(DEFAULT_SPECIMEN, part))
            return {
                **default,
                **{key: _merge(default.get(key), item) for key, item in value.items()},
            }
        return value

    name = Annotated[
        str, Field(pattern=r"^[^\s/.][^\s/]*$", description="name in config/specimens")
    ]
    return BeforeValidator(read, json_schema_input_type=name | surface)


def _merge(default: Any, given: Any) -> Any:
    return (
        {**_si(default), **given}
        if isinstance(default, Strict) and isinstance(given, Mapping)
        else given
    )


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
    default = _si(source_of(info.context).part(DEFAULT_SPECIMEN, "ridges"))
    filled = {**default, **{key: _merge(default.get(key), item) for key, item in value.items()}}
    if "outer" not in value:
        filled.pop("outer", None)
    return filled


class _Own(dict):
    """Layers under names of their own."""


def _layers_tag(value: Any) -> str:
    read = (
        isinstance(value, dict)
        and value
        and all(isinstance(layer, Material) for layer in value.values())
    )
    return "<own>" if isinstance(value, _Own) or read else "<finger>"


_FINGER = tuple(Layers.model_fields)
_SHAPES = ("outline", "mesh", "slab", "half_round")
Names = Annotated[tuple[Name, ...], BeforeValidator(listed)]


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
    slab: Slab | None = None
    """A flat slab instead of an outline."""
    half_round: HalfRound | None = None
    """A half-round instead of an outline."""
    fixed: Names = ()
    """Further curves of the mesh that are held."""
    free: Names = ()
    """Curves of the mesh that are free; so are boundary edges in no curve."""
    layers: (
        Annotated[
            Annotated[Layers, Tag("<finger>")] | Annotated[dict[Name, Material], Tag("<own>")],
            Discriminator(_layers_tag),
            _named("layers", Layers | dict[str, Material]),
        ]
        | None
    ) = None
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
            raise Problem(
                f"is given beside {_article(shapes[0])}",
                f"one of {' and '.join(shapes)}",
                (shapes[-1],),
            )
        if shapes != ["mesh"]:
            for key in ("fixed", "free"):
                if data.get(key):
                    raise Problem("names curves of no mesh", "a mesh beside it", (key,))
        if shapes in (["slab"], ["half_round"]):
            return cls._fill_stack(data, shapes[0], source)
        if shapes == ["mesh"]:
            if not isinstance(data["mesh"], (str, Path)):
                raise Problem("is not a path", "the path of a .msh file", ("mesh",))
            # in Python a path may be one that a result remembers: whether it is there turns out
            # when it is read
            in_document = context is not None or isinstance(data["mesh"], str)
            data["mesh"] = source.resolve(data["mesh"]) if in_document else Path(data["mesh"])
            if in_document and not is_file(data["mesh"]):
                raise Problem(
                    "is not an existing file",
                    "the path of a .msh file, relative to the scene",
                    ("mesh",),
                )
            layers = data.get("layers")
            if isinstance(layers, Mapping) and not set(layers) <= set(_FINGER):
                data["layers"] = _Own(layers)
                left_out = [
                    f"poisson_ratio of {name}: 0.48"
                    for name, layer in layers.items()
                    if _lacks(layer, "poisson_ratio")
                ]
                return cls._fill_plain(data, left_out, source)
        else:
            data.setdefault("outline", DEFAULT_SPECIMEN)
        taken = [
            key for key in ("layers", "outline", "prony", "contact_length") if key not in given
        ]
        if shapes == ["mesh"]:
            taken.remove("outline")
        if isinstance(data.get("layers"), Mapping):
            data.setdefault("stated", tuple(data["layers"]))
            taken = [name for name in _FINGER[1:] if name not in data["layers"]] + taken
        data.setdefault("assumed", (f"{', '.join(taken)}: {DEFAULT_SPECIMEN}",) if taken else ())
        data.setdefault("layers", DEFAULT_SPECIMEN)
        data.setdefault("prony", DEFAULT_SPECIMEN)
        if "moduli" not in data:
            named = data["layers"] if isinstance(data["layers"], str) else DEFAULT_SPECIMEN
            data["moduli"] = source.specimen(named, ("layers",)).moduli or source.part(
                DEFAULT_SPECIMEN, "moduli"
            )
        if "contact_length" not in data:
            data["contact_length"] = SI(source.part(DEFAULT_SPECIMEN, "contact_length"))
        return data

    @classmethod
    def _fill_stack(cls, data: dict[str, Any], shape: str, source: Source) -> dict[str, Any]:
        """What a slab or a half-round leaves out; nothing but the contact length is the
        thesis's.
        """
        for key in ("layers", "ridges"):
            if data.get(key) not in (None, "none"):
                raise Problem(
                    f"is given beside {_article(shape)}, which has its own layers",
                    f"{shape}.layers",
                    (key,),
                    HIDE,
                )
        stack = data[shape]
        layers = (stack.get("layers") if isinstance(stack, Mapping) else None) or ()
        named = (
            [layer for layer in layers if isinstance(layer, Mapping)]
            if isinstance(layers, (list, tuple))
            else []
        )
        left_out = [
            f"poisson_ratio of {layer.get('name')}: 0.48"
            for layer in named
            if _lacks(layer, "poisson_ratio")
        ]
        return cls._fill_plain(data, left_out, source)

    @classmethod
    def _fill_plain(
        cls, data: dict[str, Any], left_out: list[str], source: Source
    ) -> dict[str, Any]:
        """Layers under names of their own do not relax unless told, and their moduli are then those
        of the long term.
        """
        if data.get("prony") is None:
            data["prony"] = ()
            left_out.append("prony: none, elastic")
        elif "moduli" not in data:
            left_out.append("moduli: long_term")
        data.setdefault("moduli", "long_term")
        if data.get("contact_length") is None:
            data["contact_length"] = SI(source.part(DEFAULT_SPECIMEN, "contact_length"))
            left_out.append(
                f"contact_length: {format_quantity(data['contact_length'], 'length')}, {DEFAULT_SPECIMEN}"
            )
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
        if isinstance(self.layers, Layers):
            return {
                name: layer for name in _FINGER if (layer := getattr(self.layers, name)) is not None
            }
        return self.layers

    def material(self, name: str) -> Layer:
        """Material of a layer; an external mesh may part the stratum corneum where the scene does
        not.
        """
        known = self.materials
        return (
            known["epidermis"] if name == "stratum_corneum" and name not in known else known[name]
        )

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
        if sum(getattr(self, shape) is not None for shape in _SHAPES) != 1 or (
            self.layers is None
        ) != (self.stack is not None):
            raise Problem(
                "is missing", "one of outline, mesh, slab and half_round", ("outline",), HIDE
            )
        if self.outline is not None and self.layers.stratum_corneum is not None:
            outline = self.outline
            if outline.stratum_corneum_thickness > outline.epidermis_thickness:
                allowed = f"up to {format_quantity(outline.epidermis_thickness, 'length')}"
                raise Problem(
                    "is more than the epidermis it belongs to",
                    allowed,
                    ("outline", "stratum_corneum_thickness"),
                )
        _check_prony(self.prony)
        if self.ridges is not None:
            self._check_ridges()
        return self

    @model_serializer(mode="wrap")
    def _without_nothing(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data = handler(self)
        return {
            key: value
            for key, value in data.items()
            if value or key not in ("slab", "half_round", "fixed", "free", "layers")
        }

    @field_serializer("ridges", mode="wrap")
    def _named_ridges(self, ridges: Ridges | None, handler: SerializerFunctionWrapHandler) -> Any:
        return "none" if ridges is None else handler(ridges)

    def _check_ridges(self) -> None:
        if self.outline is None:
            raise Problem("are given beside a mesh, which has its own", "none", ("ridges",), HIDE)
        inner, outline = self.ridges.inner, self.outline
        room = outline.epidermis_thickness - (
            outline.stratum_corneum_thickness if self.layers.stratum_corneum else 0.0
        )
        room = min(room, outline.dermis_thickness)
        if inner.height >= 0.7 * room:
            allowed = (
                f"less than {format_quantity(0.7 * room, 'length')}, 0.7 of epidermis and dermis"
            )
            raise Problem("is too high for the layers", allowed, ("ridges", "inner", "height"))
        if self.ridges.half_width + inner.pitch >= outline.half_width:
            allowed = f"less than {format_quantity(outline.half_width - inner.pitch, 'length')}"
            raise Problem(
                "and a pitch are wider than the section", allowed, ("ridges", "half_width")
            )
