"""Families of scenes: members are scenes like any other, and what is wrong with them is one
line.
"""

import pytest
import yaml

from fingerpad import load_scene
from fingerpad.documents import SceneError
from fingerpad.scenes.families import merged, moves_along, read_family, rests_on
from fingerpad.scenes.scene import recorded_scene
from wrong_scenes import write

pytestmark = pytest.mark.unit

FAMILY = """
friction: 0.3
motion: [{press_to_force: 20 gf}]
over:
  surface:
    flat: {stimulus: {shape: flat}}
    3: {stimulus: {shape: cylinder, curvature: 3 1/m}, outputs: {snapshots: [0 s]}}
"""


@pytest.fixture
def folder(tmp_path):
    write(tmp_path, FAMILY, "press.yaml")
    return tmp_path


def test_members_are_scenes_of_their_own_with_tags(folder):
    flat, sharp = load_scene(folder / "press_flat.yaml"), load_scene(folder / "press_3.yaml")
    assert (flat.name, flat.stimulus.shape, flat.friction) == ("press_flat", "flat", 0.3)
    assert (sharp.name, sharp.stimulus.curvature) == ("press_3", 3.0)
    assert sharp.outputs.snapshots == (0.0,)
    assert flat.tags == {"family": "press", "surface": "flat"} and sharp.tags["surface"] == "3"
    assert recorded_scene(flat.canonical()).tags == flat.varied({"friction": 0.1}).tags == flat.tags


def test_a_member_means_what_it_would_in_a_file_of_its_own(folder):
    alone = "friction: 0.3\nmotion: [{press_to_force: 20 gf}]\nstimulus: {shape: flat}\n"
    files = write(folder, alone, "alone.yaml"), folder / "press_flat.yaml"
    own, member = (load_scene(file).model_dump(exclude={"name", "tags"}) for file in files)
    assert own == member


def test_a_file_of_the_members_name_comes_first(folder):
    own = "stimulus: {shape: line}\nmotion: [{press_to_force: 1 gf}]\n"
    assert load_scene(write(folder, own, "press_flat.yaml")).stimulus.shape == "line"


MORE = """
extends: press.yaml
friction: 0.5
over:
  pad: {soft: {specimen: {layers: calibrated_mean}}, ridged: {specimen: {ridges: inner}}}
  surface: [3]
"""
CHANGED = """
extends: press.yaml
over: {surface: {3: {friction: 0.9}, line: {stimulus: {shape: line}}}}
"""


def test_an_extending_family_takes_changes_and_adds(folder):
    assert list(read_family(write(folder, MORE, "more.yaml"))) == ["more_soft_3", "more_ridged_3"]
    scene = load_scene(folder / "more_ridged_3.yaml")
    assert scene.friction == 0.5 and scene.stimulus.curvature == 3.0 and scene.specimen.ridges
    assert scene.tags == {"family": "more", "pad": "ridged", "surface": "3"}
    files = [path.stem for path in rests_on(folder / "more_soft_3.yaml")]
    assert files == ["more", "press", "calibrated_mean", "thesis"]
    changed = read_family(write(folder, CHANGED, "changed.yaml"))
    assert list(changed) == ["changed_flat", "changed_3", "changed_line"]
    document = changed["changed_3"].document
    assert document["friction"] == 0.9 and document["stimulus"]["shape"] == "cylinder"


BASE = "stimulus: {shape: flat}\nmotion: [{press_to_force: 20 gf}]\nspecimen: {ridges: inner}\n"
OWN = "extends: base.yaml\nmotion: [{press_to_force: 5 gf}, {slide: 1 mm}]\nfriction: 0.2\n"


def test_a_scene_extends_a_scene(folder):
    base, own = write(folder, BASE, "base.yaml"), write(folder, OWN, "own.yaml")
    scene = load_scene(own)
    assert scene.motion[0].press_to_force == pytest.approx(5 * 9.80665e-3)
    assert scene.specimen.ridges and scene.tags == {}
    assert moves_along(own) and not moves_along(base)


def test_lists_and_values_are_replaced_and_mappings_merged():
    assert merged({"a": {"b": 1, "c": [1, 2]}, "d": 1}, {"a": {"c": [3]}, "d": {"e": 2}}) == {
        "a": {"b": 1, "c": [3]},
        "d": {"e": 2},
    }


WRONG = """
press: [null, "press.yaml: is a family of 2 scenes; allowed: one of press_flat, press_3, as in"]
press_round:
  - null
  - "press_round.yaml: is not a scene of press.yaml; allowed: one of press_flat, press_3"
none_such: [null, "none_such.yaml: there is no such file"]
a: ["extends: 3", "a.yaml: extends: 3 is not a path; allowed:"]
b:
  - "extends: nowhere.yaml"
  - "b.yaml: extends: 'nowhere.yaml' is not an existing file; allowed:"
c: ["extends: c.yaml", "c.yaml: extends: 'c.yaml' extends itself; allowed:"]
d:
  - {extends: press.yaml, over: {surface: [round]}}
  - "d.yaml: over.surface: 'round' is not in the file that is extended"
e: ["over: 3", "e.yaml: over: 3 is not a mapping of keys; allowed:"]
f: ["over: {}", "f.yaml: over: {} is not a mapping of keys; allowed:"]
g: ["over: {a: [1]}", "g.yaml: over.a: [1] is not a mapping of words; allowed:"]
h: ["over: {a: {b: 1}}", "h.yaml: over.a.b: 1 is not a mapping; allowed: keys of a scene"]
i: [{extends: press.yaml, fricton: 1, over: {surface: [flat]}}, is a family of 1 scenes]
"""


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [(name, *case) for name, case in yaml.safe_load(WRONG).items()],
)
def test_what_is_wrong_is_one_line(folder, name, text, message):
    file = write(folder, text, f"{name}.yaml") if text else folder / f"{name}.yaml"
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_a_wrong_key_of_a_member_names_the_family_and_the_member(folder):
    write(folder, FAMILY + "fricton: 1\n", "x.yaml")
    with pytest.raises(SceneError, match=r"x.yaml \(x_flat\): fricton: is not a known key"):
        load_scene(folder / "x_flat.yaml")


def test_families_do_not_explode(folder):
    axis = {f"w{k}": {} for k in range(40)}
    write(folder, {"over": {"a": axis, "b": axis}}, "x.yaml")
    with pytest.raises(SceneError, match="makes 1600 scenes; allowed: up to 1000"):
        load_scene(folder / "x_w0_w0.yaml")
