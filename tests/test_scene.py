"""Scenes: what is accepted, what is refused and in which words, and what comes out."""

import json
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

import fingerpad
from fingerpad.scenes.families import read_family
from fingerpad.scenes.scene import (
    Cylinder,
    Discretisation,
    Flat,
    Hold,
    Outline,
    PressToDepth,
    PressToForce,
    Sampled,
    Scene,
    SceneError,
    Slide,
    StepAndRepeat,
    Wavy,
    load_scene,
    recorded_scene,
    scene_json_schema,
    specimen_json_schema,
)
from fingerpad.units import parse_quantity
from random_scenes import JUNK, at, places, usual
from wrong_scenes import BAD, FORCE, OUTLINE, RAMP_AND_HOLD, changed, pad_folder, wavy, write

pytestmark = pytest.mark.unit

CONFIG = Path(__file__).parents[1] / "config"
FILES = sorted(CONFIG.glob("scenes/**/*.yaml"))
SCENES = [path.with_name(f"{name}.yaml") for path in FILES for name in read_family(path)]


@pytest.fixture
def folder(tmp_path):
    """A directory for scenes, with specimens of its own."""
    return pad_folder(tmp_path)


@pytest.fixture
def read(folder):
    """Reads a ramp and hold with some keys changed, from a file in the folder."""
    return lambda **changes: load_scene(write(folder, changed(**changes)))


def test_a_scene_a_file_and_a_dictionary_are_taken_alike(folder):
    path = write(folder, RAMP_AND_HOLD)
    scene = load_scene(path)
    assert load_scene(scene) is scene
    plans = [fingerpad.plan(given).to_dict() for given in (scene, path, str(path))]
    assert plans[0] == plans[1] == plans[2]
    for wrong, words in (
        (folder / "none.yaml", "there is no such file"),
        ({"stimulus": {"shape": "flat"}}, "motion"),
    ):
        with pytest.raises(SceneError, match=words):
            fingerpad.simulate(wrong)
    with pytest.raises(TypeError, match="a scene is a Scene, a file or a dictionary, not int"):
        fingerpad.simulate(3)


@pytest.mark.parametrize(("document", "key", "words"), BAD.values(), ids=BAD)
def test_bad_input_is_one_line_naming_file_key_and_what_is_allowed(folder, document, key, words):
    path = write(folder, document)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    line = str(caught.value)
    assert len(line.splitlines()) == 1
    assert line.startswith(f"{path}: {key}: " if key else f"{path}: ")
    assert words in line
    assert len(line) < len(str(path)) + 400


PROFILE = {"shape": "sampled", "csv": "profile.csv"}


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (b"x (mm),y (mm)\n0,0\n1,0\n1,1\n", "not single-valued: x does not increase in row 4"),
        (b"x (mm),y (mm)\n0,0\n2,0\n1,1\n", "not single-valued: x does not increase in row 4"),
        (b"x (mm),y (mm)\n0,0\none,1\n", "has 'one' in row 3"),
        (b"x (mm),y (mm)\n0,0\n1,nan\n", "has 'nan' in row 3"),
        (b"x (mm),y (mm)\n0,0\n1\n", "has 1 cells in row 3, 2 in its header"),
        (b"x,y\n0,0\n1,1\n", "no column 'x (mm)'"),
        (b"x (mm),y (mm)\n0,0\n", "fewer than two points"),
        (b"", "holds no rows"),
        (b"x (mm),y (mm)\n\x00,\xc3\xbf\n1,1\n", "is binary"),
        (b"x (mm),y (mm)\n\x81,1\n", "not UTF-8"),
        (None, "cannot be read"),
    ],
)
def test_a_profile_is_points_with_x_increasing(folder, read, rows, words):
    if rows is None:
        (folder / "profile.csv").mkdir()
    else:
        (folder / "profile.csv").write_bytes(rows)
    with pytest.raises(SceneError, match="stimulus.csv: 'profile.csv' ") as caught:
        read(stimulus=PROFILE)
    assert words in str(caught.value)


def test_a_sampled_profile_is_read_in_metres(folder, read):
    text = "\ufeffx (mm),y (mm)\n-1,0.5\n0,0\n1,0.5\n"
    (folder / "profile.csv").write_text(text, encoding="utf-8")
    stimulus = read(stimulus=PROFILE).stimulus
    assert stimulus.x == pytest.approx((-1e-3, 0.0, 1e-3))
    assert stimulus.y == pytest.approx((5e-4, 0.0, 5e-4))


@pytest.mark.parametrize(
    "size", [{"radius": "2.5 mm"}, {"diameter": "5 mm"}, {"curvature": "400 1/m"}]
)
def test_a_cylinder_is_known_by_its_curvature_radius_or_diameter(read, size):
    scene = read(stimulus={"shape": "cylinder", **size})
    alike = [Cylinder(curvature=400.0), Cylinder(radius=2.5e-3), Cylinder(diameter=5e-3)]
    assert [scene.stimulus] * 3 == alike
    assert scene.canonical()["stimulus"] == {"shape": "cylinder", "curvature": 400.0}


@pytest.mark.parametrize("path", ["no.yaml", ".", "no/scene.yaml", "\0.yaml"])
def test_a_scene_that_cannot_be_read(folder, path):
    with pytest.raises(SceneError):
        load_scene(folder / path)


def test_an_error_in_a_specimen_file_names_that_file(folder, read):
    document = {"outline": {**OUTLINE, "dermis_thickness": "-1 mm"}}
    file = write(folder / "config/specimens", document, "thin.yaml")
    with pytest.raises(SceneError) as caught:
        read(specimen={"outline": "thin"})
    assert str(caught.value).startswith(f"{file}: outline.dermis_thickness: '-1 mm' is negative")


def test_a_specimen_near_the_scene_comes_before_the_repository_s(folder, read):
    layers = yaml.safe_load((CONFIG / "specimens/thesis.yaml").read_text())["layers"]
    layers["fat"]["youngs_modulus"] = "20 kPa"
    own = {"layers": layers, "moduli": "instantaneous"}
    write(folder / "config/specimens", own, "homogeneous.yaml")
    specimen = read(specimen={"layers": "homogeneous"}).specimen
    assert (specimen.layers.fat.youngs_modulus, specimen.moduli) == (20e3, "instantaneous")
    assert specimen.outline.apex_height == 6e-3


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_scenes_that_come_with_the_project_load(path):
    scene = load_scene(path)
    assert scene.name == path.stem
    json.dumps(scene.canonical())


@pytest.mark.parametrize(
    ("schema", "files"),
    [
        (scene_json_schema, FILES),
        (specimen_json_schema, sorted(CONFIG.glob("specimens/*.yaml"))),
    ],
)
def test_files_fit_their_schema(schema, files):
    validator = Draft202012Validator(schema())
    for path in files:
        validator.validate(yaml.safe_load(path.read_text()))


def test_scenes_of_one_family_are_in_one_file():
    assert len(SCENES) == 119 and len(FILES) <= 30


def test_what_is_left_out_is_the_thesis_s(read):
    scene = read()
    specimen, outputs = scene.specimen, scene.outputs
    lengths = {key: parse_quantity(text, "length") for key, text in OUTLINE.items()}
    assert specimen.outline == Outline(**lengths)
    layers = [(layer.youngs_modulus, layer.poisson_ratio) for layer in specimen.materials.values()]
    assert layers == [(15e4, 0.48), (15e3, 0.48), (15e3, 0.48)]
    assert [tuple(dict(term).values()) for term in specimen.prony] == [
        (0.055, 3.25),
        (0.3691, 0.3414),
    ]
    assert (specimen.moduli, specimen.contact_length) == ("instantaneous", 0.0114)
    assert (scene.friction, scene.accuracy, scene.effects) == (0.0, "thesis", {})
    assert outputs.receptors.depths and outputs.receptors.offsets == (0.0,)


def test_keys_left_out_of_a_part_are_the_thesis_s(read):
    specimen = read(
        specimen={
            "layers": {"fat": {"youngs_modulus": "20 kPa"}},
            "outline": {"apex_height": "6.5 mm"},
        }
    ).specimen
    fat, outline = specimen.layers.fat, specimen.outline
    assert (fat.youngs_modulus, fat.poisson_ratio) == (20e3, 0.48)
    assert (outline.apex_height, outline.half_width) == (6.5e-3, 8.5e-3)
    assert outline.soft_thickness == pytest.approx(5.5e-3)


@pytest.mark.parametrize("prony", ["none", []])
def test_no_relaxation(read, prony):
    assert read(specimen={"prony": prony}).specimen.prony == ()


def test_legs(read):
    legs = """
        - {press_to_force: 20 gf}
        - {press_to_depth: 1 mm, speed: 2 mm/s}
        - {hold: 3 s}
        - {slide: -80 mm, speed: 10 mm/s, keep: depth}
        - {slide: 2 cm}
        - {step: -50 mm, every: 1 mm}
    """
    assert read(motion=yaml.safe_load(legs)).motion == (
        PressToForce(press_to_force=20 * 9.80665e-3),
        PressToDepth(press_to_depth=1e-3, speed=2e-3),
        Hold(hold=3.0),
        Slide(slide=-80e-3, speed=10e-3, keep="depth"),
        Slide(slide=20e-3, speed=None, keep="force"),
        StepAndRepeat(step=-50e-3, every=1e-3),
    )


ENDS = """
- [[{press_to_force: 20 gf, rate: 40 gf/s}, {hold: 2 s}], 2.5]
- [[{press_to_depth: 1 mm, speed: 2 mm/s}, {hold: 1 s}, {press_to_depth: 0.5 mm, speed: 1 mm/s}], 2]
- [[{press_to_force: 20 gf, rate: 40 gf/s}, {press_to_depth: 1 mm, speed: 2 mm/s}], null]
- [[{press_to_force: 20 gf}, {hold: 2 s}], 2.0]
- [[{press_to_force: 20 gf, rate: 40 gf/s}, {press_to_depth: 1 mm}, {hold: 2 s}], 2.5]
- [[{press_to_force: 20 gf}], 0.0]
- [[{press_to_force: 20 gf, rate: 40 gf/s}, {slide: -80 mm, speed: 10 mm/s}, {hold: 1 s}], 9.5]
- [[{press_to_force: 20 gf, rate: 40 gf/s}, {slide: 80 mm}, {step: 8 mm, every: 1 mm}], 0.5]
- - [{press_to_force: 20 gf, rate: 40 gf/s}, {slide: 8 mm}, {press_to_force: 40 gf, rate: 40 gf/s}]
  - 1.0
- - - {press_to_force: 20 gf, rate: 40 gf/s}
    - {slide: 8 mm, keep: depth}
    - {press_to_force: 40 gf, rate: 40 gf/s}
  - null
- - - {press_to_depth: 1 mm, speed: 2 mm/s}
    - {slide: 8 mm, keep: depth}
    - {press_to_depth: 2 mm, speed: 1 mm/s}
  - 1.5
"""


@pytest.mark.parametrize(("legs", "end"), yaml.safe_load(ENDS))
def test_the_end_is_known_when_the_programme_alone_tells(read, legs, end):
    assert read(motion=legs).end_time == (end and pytest.approx(end))


@pytest.mark.parametrize(
    ("text", "effects"),
    [
        ("auto", {}),
        ("{finite_strain: on, symmetry: off}", {"finite_strain": True, "symmetry": False}),
        ('{friction: "on", viscoelasticity: "off"}', {"friction": True, "viscoelasticity": False}),
        ("{ridges: false}", {"ridges": False}),
    ],
)
def test_effects_are_switches_in_any_yaml(read, text, effects):
    assert read(effects=yaml.safe_load(text)).effects == effects


@pytest.mark.parametrize(
    ("accuracy", "value"),
    [
        ("fine", "fine"),
        (0.02, 0.02),
        ("0.02", 0.02),
        ("2 %", 0.02),
        (
            {"element": "Q1P0", "skin_edge": "67 um", "steps": 8},
            Discretisation(element="Q1P0", skin_edge=67e-6, steps=8),
        ),
    ],
)
def test_accuracy(read, accuracy, value):
    assert read(accuracy=accuracy).accuracy == value


def test_the_surface_may_be_used_to_its_ends(folder):
    """Back and forth over all of it, but not beyond."""
    there = {"slide": f"{Wavy().length!r} m"}
    back = {"step": f"{-Wavy().length!r} m", "every": f"{Wavy().length!r} m"}
    assert len(load_scene(write(folder, wavy([FORCE, there, back, there]))).motion) == 4


def test_a_leg_that_takes_time_has_as_many_outputs_as_are_asked_for(read):
    """Fewer than the accuracy's steps change nothing, nor do any where nothing takes time or who
    gives the steps by hand.
    """

    def steps(per_leg=None, **changes):
        outputs = {"per_leg": per_leg} if per_leg else {}
        chosen = fingerpad.plan(read(outputs=outputs, **{"accuracy": "draft", **changes}))
        return chosen.steps_per_leg, chosen.outputs

    assert steps() == steps(2) and steps()[0] < 64 and steps(64) == (64, 128)
    for changes in ({"motion": [{"press_to_force": "20 gf"}]}, {"accuracy": {"steps": 10}}):
        assert steps(64, **changes) == steps(**changes)
    asked = read(outputs={"per_leg": 64})
    assert asked.with_accuracy("draft").outputs.per_leg is None and asked.outputs.per_leg == 64


def test_snapshots_at_intervals_are_times(read):
    """Multiples of the interval up to the end, the end itself too; the canonical form is that of
    the times.
    """
    every = read(outputs={"snapshots": {"every": "0.5 s"}})
    listed = read(outputs={"snapshots": ["0.5 s", "1 s", "1.5 s", "2 s", "2.5 s"]})
    assert every.outputs.snapshots == (0.5, 1.0, 1.5, 2.0, 2.5)
    assert every.canonical() == listed.canonical()
    assert every.with_accuracy("draft").outputs == every.outputs
    stroke = wavy([FORCE, {"slide": "80 mm", "speed": "10 mm/s"}])
    times = read(**stroke, outputs={"snapshots": {"every": "0.1 s"}}).outputs.snapshots
    assert len(times) == 85 and times[2] == 0.3 and times[-1] == 8.5


def test_pressing_again_after_a_slide_at_the_other_control(read):
    """Once the depth was kept, the force of before is a new target."""
    assert read(motion=[FORCE, {"slide": "8 mm", "keep": "depth"}, FORCE])
    with pytest.raises(SceneError, match="where the leg before ended"):
        read(motion=[FORCE, {"slide": "8 mm"}, FORCE])


def test_another_accuracy_is_a_copy(read):
    scene = read()
    accuracies = [scene.with_accuracy(asked).accuracy for asked in ("draft", "0.1")]
    assert [scene.accuracy, *accuracies] == ["thesis", "draft", 0.1]
    assert scene.with_accuracy("draft").specimen is scene.specimen
    with pytest.raises(SceneError, match="accuracy: 'x' is not a known accuracy"):
        scene.with_accuracy("x")


def test_in_python_models_take_si_numbers():
    assert Cylinder(curvature=210.0).curvature == 210.0
    with pytest.raises(ValueError, match="is zero"):
        Cylinder(curvature=0.0)
    with pytest.raises(ValueError, match="frozen"):
        Cylinder(curvature=1.0).curvature = 2.0


def test_canonical_has_no_paths_and_follows_the_contents(folder, read):
    def recorded(rows):
        (folder / "profile.csv").write_text("x (mm),y (mm)\n" + rows)
        return json.dumps(read(stimulus=PROFILE).canonical())

    first, same, other = map(recorded, ("0,0\n1,0\n", "0.0,0\n1,0\n", "0,0\n2,0\n"))
    assert first == same != other and str(folder) not in first
    (folder / "my.msh").write_text("nodes")
    meshed = read(specimen={"mesh": "my.msh"}).canonical()
    mesh = meshed["specimen"]["mesh"]
    assert mesh["name"] == "my.msh" and len(mesh["sha256"]) == 64
    assert str(folder) not in json.dumps(meshed)


@pytest.mark.parametrize(
    "name", ["ramp40_k210", "ridged_stroke_left", "step_sub", "steady_line", "calibration_less_fat"]
)
def test_a_scene_is_found_again_in_what_it_recorded(name):
    scene = load_scene(CONFIG / "scenes" / f"{name}.yaml")
    assert recorded_scene(json.loads(json.dumps(scene.canonical()))) == scene


def test_a_recorded_scene_needs_none_of_its_files(folder, read):
    files = folder / "profile.csv", folder / "my.msh"
    for file, text in zip(files, ("x (mm),y (mm)\n-1,1\n0,0\n1,1\n", "nodes"), strict=True):
        file.write_text(text)
    scene = read(specimen={"mesh": "my.msh"}, stimulus=PROFILE)
    data = scene.canonical()
    for file in files:
        file.unlink()
    again = recorded_scene(data)
    assert (again.stimulus.x, again.stimulus.y) == (scene.stimulus.x, scene.stimulus.y)
    assert again.specimen.mesh == Path("my.msh") and again.motion == scene.motion


def test_a_varied_scene_is_checked_like_one_that_was_read():
    scene = load_scene(CONFIG / "scenes" / "ridged_40_k210.yaml")
    assert scene.varied({}) is scene and scene.varied({"name": scene.name}) == scene
    softer = scene.varied(
        {
            "specimen.layers.fat.youngs_modulus": "10 kPa",
            "motion[0].rate": 0.5,
            "specimen.ridges": "none",
        }
    )
    layers = softer.specimen.layers
    assert layers.fat.youngs_modulus == 10e3 and softer.motion[0].rate == 0.5
    assert softer.specimen.ridges is None and layers.dermis == scene.specimen.layers.dermis
    for stimulus in (Flat(), {"shape": "flat"}):
        assert scene.varied({"stimulus": stimulus}).stimulus == Flat()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"specimen.layers.fat.youngs_modulus": -1.0},
            "specimen.layers.fat.youngs_modulus: -1.0 is negative",
        ),
        ({"specimen.layers.fat.youngs_modulus": "0.1 N"}, "has the wrong dimension"),
        (
            {"specimen.layer.fat": 1.0},
            "specimen.layer.fat: layer is not a known key; allowed: outline, mesh, slab",
        ),
        ({"motion[7].rate": 1.0}, "motion[7].rate: there is no such entry; allowed: 0 to 1"),
        ({"motion[0].rate.x": 1.0}, "there is no such key"),
        ({"stimulus.slope": 1.0}, "stimulus.slope: is not a known key"),
        ({"motion": ()}, "motion"),
    ],
)
def test_a_scene_cannot_be_varied_into_a_wrong_one(changes, said):
    with pytest.raises(SceneError) as caught:
        load_scene(CONFIG / "scenes" / "ridged_40_k210.yaml").varied(changes)
    assert said in str(caught.value) and "\n" not in str(caught.value)


SCHEMA_SEES = [
    "unknown key",
    "missing unit",
    "bare number",
    "no stimulus",
    "unknown shape",
    "slide without a unit",
    "step without every",
    "one curvature for many",
    "unknown accuracy",
    "Poisson's ratio of a half",
    "unknown effect",
    "no curvature",
    "leg of two kinds",
    "ridges",
    "name is the file's",
]


@pytest.mark.parametrize("name", SCHEMA_SEES)
def test_the_schema_sees_what_an_editor_can(name):
    validator = Draft202012Validator(scene_json_schema())
    assert validator.is_valid(RAMP_AND_HOLD)
    assert not validator.is_valid(BAD[name][0])


# --- properties -----------------------------------------------------------------------------------

keys = st.sampled_from(list(usual())) | st.text(max_size=5) | st.integers() | st.booleans()
junk = st.recursive(
    JUNK | st.sampled_from(list(usual().values())),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4),
    max_leaves=12,
)
many = settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def _loads_or_says_why(path):
    try:
        assert isinstance(load_scene(path), Scene)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1
        assert str(error).startswith(str(path.parent))


@many
@given(data=st.data())
def test_a_scene_with_anything_in_one_place_is_a_scene_or_a_scene_error(folder, data):
    document = yaml.safe_load((CONFIG / "scenes/examples/every_key.yaml").read_text())
    *above, key = data.draw(st.sampled_from(list(places(document))))
    at(document, above)[key] = data.draw(junk)
    _loads_or_says_why(write(folder, document))


@many
@given(
    content=st.binary(max_size=60)
    | st.text(alphabet="a:{}[]&*!|>-? \n\t'\"#%@,1", max_size=40).map(str.encode)
)
def test_any_bytes_are_a_scene_or_a_scene_error(folder, content):
    path = folder / "bytes.yaml"
    path.write_bytes(content)
    _loads_or_says_why(path)


@many
@given(
    depth_um=st.integers(1, 4999),
    force_mgf=st.integers(1, 10**6),
    rate_mgf=st.integers(1, 10**6),
    curvature=st.integers(1, 5000),
)
def test_a_scene_is_the_same_in_any_units(read, depth_um, force_mgf, rate_mgf, curvature):
    gf = 9.80665e-6

    def numbers(length, force, rate, bend):
        scene = read(
            stimulus={"shape": "cylinder", "curvature": bend},
            motion=[{"press_to_force": force, "rate": rate}, {"hold": "2 s"}],
            outputs={"receptors": {"depths": [length]}},
        )
        press = scene.motion[0]
        depth = scene.outputs.receptors.depths[0]
        return depth, press.press_to_force, press.rate, scene.stimulus.curvature

    ours = numbers(
        f"{depth_um} um",
        f"{force_mgf / 1000!r} gf",
        f"{rate_mgf / 1000!r} gf/s",
        f"{curvature} 1/m",
    )
    theirs = numbers(
        f"{depth_um / 1e6!r} m",
        f"{force_mgf * gf!r} N",
        f"{rate_mgf * gf * 60!r} N/min",
        f"{curvature / 1000!r} 1/mm",
    )
    assert ours == pytest.approx(theirs, rel=1e-14)


def test_a_profile_made_in_python_needs_no_file():
    """Points in metres are a profile; without points and without a file it says so, and records
    keep it.
    """
    flat = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "20 gf"}]}
    made = load_scene(flat).varied({"stimulus": Sampled(x=(-1e-3, 0.0, 1e-3), y=(1e-4, 0.0, 1e-4))})
    assert made.stimulus.csv is None and recorded_scene(made.canonical()) == made
    for changes, words in (
        ({"stimulus": {"shape": "sampled"}}, "stimulus.csv: is missing"),
        (
            {"motion": [{"press_to_force": "20 g"}]},
            r"scene: motion\[0\].press_to_force: '20 g' has",
        ),
    ):
        with pytest.raises(SceneError, match=words):
            load_scene(flat | changes)
