"""Configuration files, their typed models and their JSON schemas say the same."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
import yaml
from pydantic import ValidationError

from fingerpad.config import WorkflowConfig, schemas, write_schemas

pytestmark = pytest.mark.unit

ROOT = Path(__file__).resolve().parents[1]
SCHEMAS = ROOT / "workflow" / "schemas"
YAML_FILES = sorted((ROOT / "config").rglob("*.yaml"))


def test_committed_schemas_are_those_of_the_models(tmp_path):
    for fresh in write_schemas(tmp_path):
        assert (SCHEMAS / fresh.name).read_text() == fresh.read_text(), "run `make schemas` and commit the result"
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


@pytest.mark.parametrize("name", ["thesis", "smoke"])
def test_workflow_configurations_fulfil_the_model(name):
    config = WorkflowConfig.model_validate(yaml.safe_load((ROOT / "config" / f"{name}.yaml").read_text()))
    assert config.name == name
    for scene in (*config.scenes, *config.variants):
        assert (ROOT / "config" / "scenes" / f"{scene}.yaml").is_file()


def test_everything_of_smoke_is_under_its_results():
    config = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
    assert config["results"] == "results/smoke"
    assert config["figures"].startswith("results/smoke/")
    assert config["tables"].startswith("results/smoke/")


@pytest.mark.parametrize(
    "change",
    [{"scenes": []}, {"accuracy": "rough"}, {"accuracy": 1.5}, {"results": "/abs"}, {"figure": "4-10"}],
    ids=str,
)
def test_wrong_configurations_are_refused_by_model_and_schema(change):
    config = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text()) | change
    with pytest.raises(ValidationError):
        WorkflowConfig.model_validate(config)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(config, schemas()["workflow"])
