"""The specimen of a scene: outline or mesh, layers, relaxation, named in config/specimens or given."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
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

from fingerpad.documents import HIDE, Problem, Strict, explain, read_yaml
from fingerpad.fields import SI, Length, SignedLength, Time, listed, number, quantity
from fingerpad.files import BUILT_IN
from fingerpad.units import format_quantity

DEFAULT_SPECIMEN = "thesis"


class Outline(Strict):
    """Parameters of the pad's symmetric section; apex at (0, apex_height), bottom at (0, -depth_below)."""

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
            key = "epidermis_thickness" if self.epidermis_thickness >= self.dermis_thickness else "dermis_thickness"
            raise Problem(
                f"makes the layers thicker than the pad: epidermis and dermis together are {mm(layers)}",
                f"less than the {mm(self.soft_thickness)} from the skin to the bone",
                (key,),
            )
        if self.stratum_corneum_thickness > self.epidermis_thickness:
            raise Problem(
                "is more than the epidermis it belongs to",
                f"up to {mm(self.epidermis_thickness)}",
                ("stratum_corneum_thickness",),
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
            raise Problem("is wider than the section", f"up to {mm(self.half_width)}", ("nail_half_width",))
        return self


class Layer(Strict):
    """Isotropic elasticity of one layer."""

    hints: ClassVar = {"thickness": "is not a key of a layer, the outline has epidermis_thickness and dermis_thickness"}

    youngs_modulus: quantity("pressure")
    """Young's modulus, in the state named by `moduli`."""
    poisson_ratio: number("a number above -1 and below 0.5", -1.0, 0.5)
    """Poisson's ratio, in the state named by `moduli`."""


class Layers(Strict):
    """The layers between skin and bone."""

    stratum_corneum: Layer | None = None
    """Outermost part of the epidermis, if it is to be a layer of its own; keys left out are the epidermis's."""
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
            below = _si(below) if isinstance(below, Layer) else below if isinstance(below, Mapping) else {}
            data["stratum_corneum"] = {**below, **data["stratum_corneum"]}
        return data

    @model_serializer(mode="wrap")
    def _without_nothing(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data = handler(self)
        if self.stratum_corneum is None:
            del data["stratum_corneum"]
        return data


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
    """What is at x = 0 (valley: halfway between two primary ridges), or the lateral position of the nearest primary tip."""
    limiting: number("a number from 0 to below 1", 0.0, 1.0, low_included=True)
    """Height over theirs of limiting ridges halfway between the primary ones, which makes all half as wide; 0 for none."""

    @model_validator(mode="after")
    def _check(self) -> InnerRidges:
        if not isinstance(self.phase, str) and abs(self.phase) > self.pitch / 2:
            half = format_quantity(self.pitch / 2, "length")
            raise Problem("is farther off than the nearest ridge tip can be", f"up to half a pitch, {half}", ("phase",))
        return self


class OuterRidges(Strict):
    """The papillary ridges of the skin, whose crests lie over the tips of the inner ones; the skin's mean height is kept."""

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
    """Distance from the apex, along the skin, within which ridges stand in full; they fade out over one pitch beyond."""


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
    """Relaxation of the shear modulus, normalised by the instantaneous one; an empty list for none."""
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


class Source:
    """Where a document comes from: finds the files it names and the specimens it refers to."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._files: dict[str, SpecimenFile] = {}

    def resolve(self, name: str) -> Path:
        """Path of a file named in the document, relative to it."""
        return self.path.parent / Path(name).expanduser()

    def _folders(self) -> Iterator[Path]:
        folder = self.path.absolute().parent
        for parent in (folder, *folder.parents):
            yield parent / "config" / "specimens"
        yield BUILT_IN / "specimens"

    def specimen(self, name: str, key: tuple = ()) -> SpecimenFile:
        """The specimen file called `name`; raises `Problem` at `key` when there is none."""
        if name not in self._files:
            found = {
                file.stem: file
                for folder in reversed(list(self._folders()))
                if folder.is_dir()
                for file in sorted(folder.glob("*.yaml"))
            }
            if name not in found:
                names = ", ".join(sorted(found)) or "none found"
                raise Problem("is not the name of a specimen", f"names of files in config/specimens ({names})", key)
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
    return {name: SI(value) if isinstance(value, float) else value for name, value in values if value is not None}


def _named(part: str, surface: Any) -> BeforeValidator:
    """Field that may name a specimen file; keys left out of a mapping are the default specimen's."""

    def read(value: Any, info: ValidationInfo) -> Any:
        source = source_of(info.context)
        if isinstance(value, str):
            return () if (part, value) == ("prony", "none") else source.part(value, part)
        if part == "prony":
            return listed(value)
        if isinstance(value, Mapping):
            default = _si(source.part(DEFAULT_SPECIMEN, part))
            return {**default, **{key: _merge(default.get(key), item) for key, item in value.items()}}
        return value

    name = Annotated[str, Field(pattern=r"^[^\s/.][^\s/]*$", description="name in config/specimens")]
    return BeforeValidator(read, json_schema_input_type=name | surface)


def _merge(default: Any, given: Any) -> Any:
    return {**_si(default), **given} if isinstance(default, Strict) and isinstance(given, Mapping) else given


_RIDGES = Literal["none", "inner", "inner_and_outer"]


def _read_ridges(value: Any, info: ValidationInfo) -> Any:
    """Ridges by a word or by keys; keys left out are the default specimen's, and there are outer ridges only if asked for."""
    if value is None or isinstance(value, Ridges):
        return value
    if value == "none":
        return None
    if value in ("inner", "inner_and_outer"):
        value = {} if value == "inner" else {"outer": {}}
    if not isinstance(value, Mapping):
        raise Problem("is not the kind of ridges", "none, inner, inner_and_outer, or keys inner, outer, half_width")
    default = _si(source_of(info.context).part(DEFAULT_SPECIMEN, "ridges"))
    filled = {**default, **{key: _merge(default.get(key), item) for key, item in value.items()}}
    if "outer" not in value:
        filled.pop("outer", None)
    return filled


class Specimen(Strict):
    """What is touched: a parametric outline or an external mesh, and the material of its layers."""

    outline: Annotated[Outline, _named("outline", Outline)] | None = None
    """Section of the pad, by name or by keys; keys left out are the thesis's."""
    mesh: Path | None = None
    """External mesh in mm with surfaces epidermis, dermis, fat and curves skin, bone, nail; or an outline."""
    layers: Annotated[Layers, _named("layers", Layers)]
    """Elasticity of the layers, by name or by keys; keys left out are the thesis's."""
    moduli: Moduli
    """State that the moduli of `layers` describe."""
    prony: Annotated[tuple[PronyTerm, ...], _named("prony", tuple[PronyTerm, ...])]
    """Relaxation of shear, normalised by the instantaneous modulus: a name, a list of terms, or none."""
    ridges: Annotated[Ridges | None, BeforeValidator(_read_ridges, json_schema_input_type=Ridges | _RIDGES)] = None
    """Ridges of epidermis and skin: none, inner, inner_and_outer, or keys; keys left out are the thesis file's."""
    contact_length: Length
    """Out-of-plane length that turns newtons into newtons per metre."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Parts left out are the default specimen's; `moduli` comes with the file that names `layers`."""
        source = source_of(context)
        if data.get("mesh") is not None:
            if data.get("outline") is not None:
                raise Problem("is given beside an outline", "one of mesh and outline", ("mesh",))
            if not isinstance(data["mesh"], (str, Path)):
                raise Problem("is not a path", "the path of a .msh file", ("mesh",))
            # in Python a path may be one that a result remembers: whether it is there turns out when it is read
            in_document = context is not None or isinstance(data["mesh"], str)
            data["mesh"] = source.resolve(data["mesh"])
            if in_document and not data["mesh"].is_file():
                raise Problem("is not an existing file", "the path of a .msh file, relative to the scene", ("mesh",))
        else:
            data.setdefault("outline", DEFAULT_SPECIMEN)
        data.setdefault("layers", DEFAULT_SPECIMEN)
        data.setdefault("prony", DEFAULT_SPECIMEN)
        if "moduli" not in data:
            named = data["layers"] if isinstance(data["layers"], str) else DEFAULT_SPECIMEN
            data["moduli"] = source.specimen(named, ("layers",)).moduli or source.part(DEFAULT_SPECIMEN, "moduli")
        if "contact_length" not in data:
            data["contact_length"] = SI(source.part(DEFAULT_SPECIMEN, "contact_length"))
        return data

    @model_validator(mode="after")
    def _check(self) -> Specimen:
        if (self.outline is None) == (self.mesh is None):
            raise Problem("is missing", "one of outline and mesh", ("outline",), HIDE)
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
        room = outline.epidermis_thickness - (outline.stratum_corneum_thickness if self.layers.stratum_corneum else 0.0)
        room = min(room, outline.dermis_thickness)
        if inner.height >= 0.7 * room:
            allowed = f"less than {format_quantity(0.7 * room, 'length')}, 0.7 of epidermis and dermis"
            raise Problem("is too high for the layers", allowed, ("ridges", "inner", "height"))
        if self.ridges.half_width + inner.pitch >= outline.half_width:
            allowed = f"less than {format_quantity(outline.half_width - inner.pitch, 'length')}"
            raise Problem("and a pitch are wider than the section", allowed, ("ridges", "half_width"))
