"""Scenes, sweeps and the files they name, drawn at random from the JSON schemas of the typed
models, and broken at random.

What a quantity is likely to be is read from the scene with every key and from the thesis's
specimen: it is drawn around that.
"""

import copy
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import yaml
from hypothesis import strategies as st

from cysyk1999.studies.common.meshes import split
from fingerpad.planning.plan import plan
from fingerpad.scenes.scene import load_scene, scene_json_schema
from fingerpad.specimen import build_pad_mesh, read_pad_mesh, write_pad
from fingerpad.stimuli.shapes import SHAPES
from fingerpad.sweeps.language import sweep_json_schema
from fingerpad.units import QuantityError, unit_of

CONFIG = Path(__file__).parents[1] / "config"


@dataclass(frozen=True)
class Drawn:
    """A document, what it is (the shape of its stimulus, `sweep`, or `broken`)."""

    kind: str
    document: object

    @property
    def text(self) -> str:
        """As it stands in a file."""
        return yaml.safe_dump(self.document, sort_keys=False, allow_unicode=True)


# --- files that scenes name -----------------------------------------------------------------------

PROFILES = {
    "round.csv": lambda x: 200 * x**2,
    "waves.csv": lambda x: 40 * x**2 + 5e-5 * np.cos(4000 * x),
    "noise.csv": lambda x: 100 * x**2 + np.random.default_rng(1).normal(0, 2e-6, x.size),
    "steps.csv": lambda x: np.round(150 * x**2, 5),
    "ramp.csv": lambda x: np.abs(x) * 0.4,
    "beside.csv": lambda x: 200 * (x - 3e-3) ** 2,
}
"""Heights (m) over places (m)."""
WRONG_PROFILES = {
    "nan.csv": "x (mm),y (mm)\n0,0\n1,nan\n",
    "short.csv": "x (mm),y (mm)\n0,0\n",
    "back.csv": "x (mm),y (mm)\n1,0\n0,0\n",
}
MOTIONS = {"depths.csv": ("time (s),depth (mm)", 0.3), "forces.csv": ("time (ms);force (gf)", 10.0)}
"""Header and largest value of motions that tables say."""
MESHES = ("quad9.msh", "quad4.msh", "tri6.msh", "aside.msh")
WRONG_MESHES = ("cut.msh", "text.msh", "nan.msh", "missing.msh")
FILES = {
    "mesh": (MESHES, WRONG_MESHES),
    "csv": (tuple(PROFILES), tuple(WRONG_PROFILES)),
    "table": (tuple(MOTIONS), ("short.csv", "none.csv")),
}
"""Key of a scene that names a file -> good ones and bad ones."""


def write_files(folder: Path) -> None:
    """Profiles and meshes, good ones and bad ones, into a folder."""
    x = np.linspace(-5e-3, 5e-3, 801)
    for name, height in PROFILES.items():
        _write_table(folder / name, "x (mm),y (mm)", 1e3 * np.column_stack([x, height(x)]))
    for name, (header, most) in MOTIONS.items():
        time = np.linspace(0, 1, 60) * (1e3 if "ms" in header else 1.0)
        values = most * np.minimum(np.linspace(0, 2, 60), 1)
        _write_table(folder / name, header, np.column_stack([time, values]))
    for name, text in WRONG_PROFILES.items():
        (folder / name).write_text(text)
    press = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "5 gf"}]}
    scene = load_scene(press | {"accuracy": "draft"})
    size = replace(plan(scene).mesh_size, skin_edge=4e-4, layer_edge=4e-4)
    mesh = build_pad_mesh(scene.specimen.outline, size)
    write_pad(mesh, folder / "quad9.msh")
    for kind in ("quad4", "tri6"):
        write_pad(split(mesh, kind), folder / f"{kind}.msh")
    aside = replace(mesh, points=mesh.points + [3e-4, 0.0], symmetric=False)
    write_pad(aside, folder / "aside.msh")
    whole = (folder / "quad9.msh").read_text()
    head, nodes = whole.split("$Nodes", 1)
    (folder / "cut.msh").write_text(whole[: len(whole) // 2])
    (folder / "text.msh").write_text("not a mesh\n")
    (folder / "nan.msh").write_text(head + "$Nodes" + nodes.replace("0 0\n", "nan 0\n", 40))
    assert read_pad_mesh(folder / "aside.msh").symmetric is False


def _write_table(path: Path, header: str, rows: np.ndarray) -> None:
    delimiter = ";" if ";" in header else ","
    np.savetxt(path, rows, delimiter=delimiter, header=header, comments="", fmt="%.6g")


# --- values of the types of a schema --------------------------------------------------------------


def _leaves(document):
    for key, value in document.items() if isinstance(document, dict) else enumerate(document):
        if isinstance(value, (dict, list)):
            yield from _leaves(value)
        yield key, value


@cache
def usual():
    """Key -> a value it is likely to have."""
    found = yaml.safe_load("""
        thickness: 1.5 mm
        width: 2 mm
        radius: 8 mm
        diameter: 8 mm
        skin_edge: 0.3 mm
        every: 0.2 s
    """)
    for file in ("specimens/thesis.yaml", "scenes/examples/every_key.yaml"):
        leaves = _leaves(yaml.safe_load((CONFIG / file).read_text()))
        found = {key: value for key, value in leaves if isinstance(value, str)} | found
    return found


SPECIMENS = ("thesis", "homogeneous", "calibrated_subject_1")
LAYERS = ("cover", "foam", "base", "skin", "epidermis", "none")
ONE_IN_FOUR = st.integers(0, 3).map(lambda n: n == 3)
FACTORS = st.one_of(*4 * [st.floats(-0.4, 0.4)], st.floats(-3, 3))


@st.composite
def quantities(draw, like):
    """A quantity of the unit of another, mostly of its size."""
    unit = unit_of(like)
    size = float(like.removesuffix(unit).strip().split("/")[0])
    return f"{size * 10 ** draw(FACTORS):.3g} {unit}"


def _quantity(key, example):
    like, unit = usual().get(key, example), _unit(example)
    known = _unit(like)
    return quantities(like if known and known[-1:] == unit[-1:] else example)


def values(schema, defs, key=""):
    """What a schema allows, roughly; `key` is where."""
    if "$ref" in schema:
        return values(defs[schema["$ref"].rpartition("/")[2]], defs, key)
    for choice in ("anyOf", "oneOf"):
        if choice in schema and "properties" not in schema:
            return st.one_of(*(values(one, defs, key) for one in schema[choice]))
    if "const" in schema:
        return st.just(schema["const"])
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    if key in FILES:
        good, bad = FILES[key]
        return st.sampled_from(3 * good + bad)
    kind = schema.get("type")
    if kind == "object":
        return _objects(schema, defs)
    if kind == "array":
        return st.lists(values(schema.get("items", {}), defs, key), min_size=1, max_size=3)
    if kind == "boolean":
        return st.booleans()
    if kind == "integer":
        return st.integers(schema.get("minimum", 0), min(schema.get("maximum", 40), 40))
    if kind == "number":
        low = schema.get("exclusiveMinimum", schema.get("minimum", -10))
        high = schema.get("exclusiveMaximum", schema.get("maximum", 10))
        return st.floats(low, high).map(lambda value: float(f"{value:.3g}"))
    if "examples" in schema and isinstance(schema["examples"][0], str):
        return _quantity(key, schema["examples"][0])
    if kind == "string" and "%" in schema.get("pattern", ""):
        return st.floats(0, 1).map(lambda value: f"{value:.3g}")
    if kind == "string":
        named = "name in config/specimens" in schema.get("description", "")
        return st.sampled_from(SPECIMENS if named else LAYERS)
    return st.none() | st.integers() | st.text(max_size=5)


@st.composite
def _objects(draw, schema, defs):
    choices = [key for each in schema.get("oneOf", ()) for key in each.get("required", ())]
    wanted = {*schema.get("required", ()), *([draw(st.sampled_from(choices))] if choices else ())}
    found = {}
    for key, inner in schema.get("properties", {}).items():
        if key in wanted or (key not in choices and draw(ONE_IN_FOUR)):
            found[key] = draw(values(inner, defs, key))
    more = schema.get("additionalProperties")
    if isinstance(more, dict) and not found:
        found[draw(st.sampled_from(["cover", "epidermis", "name"]))] = draw(values(more, defs))
    return found


# --- documents ------------------------------------------------------------------------------------

SCHEMA = scene_json_schema()
PARTS = ("specimen", "friction", "outputs", "accuracy", "effects")


@st.composite
def scenes(draw):
    """A scene that is likely to be right: a shape, a press and legs after it, and now and then any
    other part.
    """
    schema = SCHEMA
    defs, parts = schema["$defs"], schema["properties"]
    shapes = [name for name, model in defs.items() if "shape" in model.get("required", ())]
    scene = {"stimulus": draw(values(defs[draw(st.sampled_from(sorted(shapes)))], defs))}
    if "plane_strain" not in SHAPES[scene["stimulus"]["shape"]].kinematics:
        scene["kinematics"] = "axisymmetric"
    first = draw(values(defs[draw(st.sampled_from(["PressToForce", "PressToDepth"]))], defs))
    listed = next(each for each in parts["motion"]["anyOf"] if each.get("type") == "array")
    later = values(listed["items"], defs, "motion")
    scene["motion"] = [first, *draw(st.lists(later, max_size=3))]
    for part in PARTS:
        if draw(ONE_IN_FOUR):
            scene[part] = draw(values(parts[part], defs, part))
    return Drawn(scene["stimulus"]["shape"], scene)


TEXTS = ["1 mm", "-20 gf", "0 s", "1e400 mm", "nan mm", "5 parsecs", "thesis"]
TEXTS += ["../../x", "/dev/zero", "a\nb", "\0"]
JUNK = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.builds(list)
    | st.builds(dict)
    | st.just(10**400)
    | st.sampled_from(TEXTS)
)


def places(document, path=()):
    """The paths to everything in a document."""
    if isinstance(document, dict):
        items = document.items()
    else:
        items = enumerate(document) if isinstance(document, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


@st.composite
def broken(draw):
    """A scene or a sweep of which one or two places are something else, gone, called otherwise, or
    once more.
    """
    document = copy.deepcopy(draw(scenes() | sweeps()).document)
    for _ in range(draw(st.integers(1, 2))):
        known = list(places(document))
        if not known:
            break
        path = draw(st.sampled_from(known))
        above, key = at(document, path[:-1]), path[-1]
        how = draw(st.sampled_from(["junk", "gone", "renamed", "elsewhere"]))
        if how == "junk":
            above[key] = draw(JUNK)
        elif how == "elsewhere":
            above[key] = copy.deepcopy(at(document, draw(st.sampled_from(known))))
        else:
            value = above.pop(key)
            if how == "renamed" and isinstance(above, dict):
                above[draw(st.text(max_size=5) | st.just(f"{key}s"))] = value
    return Drawn("broken", document)


@st.composite
def sweeps(draw):
    """A sweep over one or two quantities of a scene, in few values."""
    scene = draw(scenes()).document
    known = [path for path in places(scene) if _unit(at(scene, path))]
    some = st.lists(st.sampled_from(known), min_size=1, max_size=2, unique=True)
    distribution = sweep_json_schema()["$defs"]["Distribution"]
    document = {"scene": scene, "over": {}}
    for path in draw(some) if known else ():
        like = at(scene, path)
        key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)[1:]
        kind = draw(st.sampled_from(["values", "range", "Distribution"]))
        if kind == "values":
            axis = draw(st.lists(quantities(like), min_size=1, max_size=3))
        elif kind == "range":
            ends = draw(st.lists(quantities(like), min_size=2, max_size=2))
            axis = {"range": ends, "count": draw(st.integers(2, 3))}
        else:
            axis = _in_units(draw(values(distribution, sweep_json_schema()["$defs"])), like)
            document |= {"design": "sobol", "samples": 2}
        document["over"][key] = axis
    return Drawn("sweep", document)


def _in_units(part, like):
    """A drawn distribution with means and medians of another quantity's size."""
    if not isinstance(part, dict):
        return part
    return {
        key: like if key in ("mean", "median", "sd") else _in_units(inner, like)
        for key, inner in part.items()
    }


def _unit(text):
    """The unit of a quantity; none of anything else."""
    try:
        return unit_of(text) if isinstance(text, str) else ""
    except QuantityError:
        return ""


def anything():
    """A scene in four of six, a sweep, or something broken."""
    return st.integers(0, 5).flatmap(
        lambda n: scenes() if n < 4 else sweeps() if n == 4 else broken()
    )
