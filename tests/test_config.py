"""Configuration files, their typed models and their JSON schemas say the same."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
import yaml
from pydantic import ValidationError

from cysyk1999.config import WorkflowConfig, read_config
from cysyk1999.workflow.schemas import schemas, write_schemas
from fingerpad.documents import SceneError
from fingerpad.scenes.families import read_scene

pytestmark = pytest.mark.unit

ROOT = Path(__file__).resolve().parents[1]
SCHEMAS = ROOT / "workflow" / "schemas"
CASES = ("accuracy", "effects", "explanations", "stability")
"""Folders of studies' cases, whose scenes are checked when they are read."""
YAML_FILES = sorted(
    path for path in (ROOT / "config").rglob("*.yaml") if path.parent.name not in CASES
)


def test_committed_schemas_are_those_of_the_models(tmp_path):
    for fresh in write_schemas(tmp_path):
        assert (SCHEMAS / fresh.name).read_text() == fresh.read_text(), (
            "run `make schemas` and commit the result"
        )
    assert {path.name for path in SCHEMAS.iterdir()} == {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("stem", ["workflow", "scene", "specimen"])
def test_schemas_are_valid_schemas(stem):
    jsonschema.Draft202012Validator.check_schema(schemas()[stem])


@pytest.mark.parametrize("path", YAML_FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_yaml_names_its_schema_and_fulfils_it(path):
    first, _, _ = path.read_text().partition("\n")
    named = re.fullmatch(r"# yaml-language-server: \$schema=(\S+)", first)
    assert named, f"the first line of {path.name} must name its schema"
    schema = (path.parent / named[1]).resolve()
    assert schema.parent == SCHEMAS
    validator = jsonschema.Draft202012Validator(json.loads(schema.read_text()))
    validator.validate(yaml.safe_load(path.read_text()))


def configured(name):
    return read_config(
        yaml.safe_load((ROOT / "config" / f"{name}.yaml").read_text()), f"config/{name}.yaml"
    )


@pytest.mark.parametrize("name", ["thesis", "smoke"])
def test_workflow_configurations_fulfil_the_model(name):
    config = configured(name)
    assert config.name == name
    for scene in config.every_scene:
        assert read_scene(ROOT / "config" / "scenes" / f"{scene}.yaml").document


def test_everything_of_smoke_is_under_its_results():
    config = configured("smoke")
    assert config.results == "results/smoke"
    assert all(
        getattr(config, folder).startswith("results/smoke/")
        for folder in ("figures", "tables", "studies")
    )


def test_name_and_scenes_suffice():
    config = read_config({"name": "mine", "scenes": ["press"]}, "mine.yaml")
    assert (config.results, config.figures) == ("results/mine", "results/mine/figures")
    assert (config.table_names, config.calibration_scenes, config.companions) == (
        ("summary",),
        (),
        False,
    )
    moved = read_config(
        {"name": "mine", "scenes": ["press"], "results": "elsewhere", "subjects": "forces"},
        "mine.yaml",
    )
    assert moved.studies == "elsewhere/studies" and "calibration_plate" in moved.calibration_scenes


WRONG = {
    "name: is missing": {"scenes": ["a"]},
    "scenes: [] is empty; allowed: a list of one or more": {"scenes": []},
    "scenes: 'a' is not a list": {"scenes": "a"},
    "scenes[1]: 'b/c' is not allowed here; allowed: letters, digits": {"scenes": ["a", "b/c"]},
    "accuracy: 'rough' is not a known accuracy; allowed: draft, thesis, fine, or a tolerance": {
        "accuracy": "rough"
    },
    "accuracy: 1.5 is not a known accuracy": {"accuracy": 1.5},
    "results: '/abs' is not allowed here; allowed: a folder, relative": {"results": "/abs"},
    "figure: is not a known key, the nearest is 'figures'": {"figure": "4-10"},
    "figure_numbers[0]: -6 is not allowed here; allowed: a figure of the thesis in quotes": {
        "figure_numbers": [-6]
    },
    "ridge_heights[1]: -1 is outside the range; allowed: a number from 0": {
        "ridge_heights": [0, -1]
    },
}


@pytest.mark.parametrize("message", WRONG, ids=str)
def test_wrong_configurations_are_refused_in_one_line_and_by_the_schema(message):
    config = (
        WRONG[message]
        if "name" in message.split(":")[0]
        else {"name": "mine"} | {"scenes": ["a"]} | WRONG[message]
    )
    with pytest.raises(SceneError) as caught:
        read_config(config, "mine.yaml")
    assert str(caught.value).startswith(f"mine.yaml: {message}") and "\n" not in str(caught.value)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(config, schemas()["workflow"])
    with pytest.raises(ValidationError):
        WorkflowConfig.model_validate(config)
