"""Families of scenes: members are scenes like any other, and what is wrong with them is one
line.
"""

import pytest

from fingerpad import load_scene
from fingerpad.documents import SceneError
from fingerpad.scenes.families import merged, moves_along, read_family, rests_on
from fingerpad.scenes.scene import recorded_scene

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
    (tmp_path / "press.yaml").write_text(FAMILY)
    return tmp_path


def test_members_are_scenes_of_their_own_with_tags(folder):
    flat, sharp = load_scene(folder / "press_flat.yaml"), load_scene(folder / "press_3.yaml")
    assert (flat.name, flat.stimulus.shape, flat.friction) == ("press_flat", "flat", 0.3)
    assert (sharp.name, sharp.stimulus.curvature) == ("press_3", 3.0)
    assert sharp.outputs.snapshots == (0.0,)
    assert flat.tags == {"family": "press", "surface": "flat"} and sharp.tags["surface"] == "3"
    assert recorded_scene(flat.canonical()).tags == flat.tags
    assert load_scene(folder / "press_flat.yaml").varied({"friction": 0.1}).tags == flat.tags


def test_a_member_means_what_it_would_in_a_file_of_its_own(folder):
    (folder / "alone.yaml").write_text(
        "friction: 0.3\nmotion: [{press_to_force: 20 gf}]\nstimulus: {shape: flat}\n"
    )
    alone, member = (
        load_scene(folder / f"{name}.yaml").model_dump() for name in ("alone", "press_flat")
    )
    own = {"name": "", "tags": {}}
    assert alone | own == member | own


def test_a_file_of_the_members_name_comes_first(folder):
    (folder / "press_flat.yaml").write_text(
        "stimulus: {shape: line}\nmotion: [{press_to_force: 1 gf}]\n"
    )
    assert load_scene(folder / "press_flat.yaml").stimulus.shape == "line"


def test_an_extending_family_takes_changes_and_adds(folder):
    (folder / "more.yaml").write_text("""
extends: press.yaml
friction: 0.5
over:
  pad: {soft: {specimen: {layers: calibrated_mean}}, ridged: {specimen: {ridges: inner}}}
  surface: [3]
""")
    members = read_family(folder / "more.yaml")
    assert list(members) == ["more_soft_3", "more_ridged_3"]
    scene = load_scene(folder / "more_ridged_3.yaml")
    assert scene.friction == 0.5 and scene.stimulus.curvature == 3.0 and scene.specimen.ridges
    assert scene.tags == {"family": "more", "pad": "ridged", "surface": "3"}
    files = [path.name for path in rests_on(folder / "more_soft_3.yaml")]
    assert files == ["more.yaml", "press.yaml", "calibrated_mean.yaml", "thesis.yaml"]
    (folder / "changed.yaml").write_text(
        "extends: press.yaml\n"
        "over: {surface: {3: {friction: 0.9}, line: {stimulus: {shape: line}}}}"
    )
    changed = read_family(folder / "changed.yaml")
    assert list(changed) == ["changed_flat", "changed_3", "changed_line"]
    assert changed["changed_3"].document["friction"] == 0.9
    assert changed["changed_3"].document["stimulus"]["shape"] == "cylinder"


def test_a_scene_extends_a_scene(folder):
    (folder / "base.yaml").write_text(
        "stimulus: {shape: flat}\nmotion: [{press_to_force: 20 gf}]\nspecimen: {ridges: inner}\n"
    )
    (folder / "own.yaml").write_text(
        "extends: base.yaml\nmotion: [{press_to_force: 5 gf}, {slide: 1 mm}]\nfriction: 0.2\n"
    )
    scene = load_scene(folder / "own.yaml")
    assert scene.motion[0].press_to_force == pytest.approx(5 * 9.80665e-3)
    assert scene.specimen.ridges and scene.tags == {}
    assert moves_along(folder / "own.yaml") and not moves_along(folder / "base.yaml")


def test_lists_and_values_are_replaced_and_mappings_merged():
    assert merged({"a": {"b": 1, "c": [1, 2]}, "d": 1}, {"a": {"c": [3]}, "d": {"e": 2}}) == {
        "a": {"b": 1, "c": [3]},
        "d": {"e": 2},
    }


WRONG = """
press |  | press.yaml: is a family of 2 scenes; allowed: one of press_flat, press_3, as in
press_round |  | press_round.yaml: is not a scene of press.yaml; allowed: one of press_flat, press_3
none_such |  | none_such.yaml: there is no such file
x | extends: 3 | x.yaml: extends: 3 is not a path; allowed:
x | extends: nowhere.yaml | x.yaml: extends: 'nowhere.yaml' is not an existing file; allowed:
x | extends: x.yaml | x.yaml: extends: 'x.yaml' extends itself; allowed:
x | {extends: press.yaml, over: {surface: [round]}} | x.yaml: over.surface: 'round' is not in the
x | over: 3 | x.yaml: over: 3 is not a mapping of keys; allowed:
x | over: {} | x.yaml: over: {} is not a mapping of keys; allowed:
x | over: {a: [1]} | x.yaml: over.a: [1] is not a mapping of words; allowed:
x | over: {a: {b: 1}} | x.yaml: over.a.b: 1 is not a mapping; allowed: keys of a scene
x | {extends: press.yaml, fricton: 1, over: {surface: [flat]}} | is a family of 1 scenes
"""
"""Name of the scene, text of its file, and what is said of it."""


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [line.split(" | ") for line in WRONG.strip().splitlines()],
)
def test_what_is_wrong_is_one_line(folder, name, text, message):
    if text:
        (folder / f"{name}.yaml").write_text(text)
    with pytest.raises(SceneError) as caught:
        load_scene(folder / f"{name}.yaml")
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_a_wrong_key_of_a_member_names_the_family_and_the_member(folder):
    (folder / "x.yaml").write_text(FAMILY + "fricton: 1\n")
    with pytest.raises(SceneError, match=r"x.yaml \(x_flat\): fricton: is not a known key"):
        load_scene(folder / "x_flat.yaml")


def test_families_do_not_explode(folder):
    axis = "{" + ", ".join(f"w{k}: {{}}" for k in range(40)) + "}"
    (folder / "x.yaml").write_text(f"over: {{a: {axis}, b: {axis}}}")
    with pytest.raises(SceneError, match="makes 1600 scenes; allowed: up to 1000"):
        load_scene(folder / "x_w0_w0.yaml")
