"""The typed model of a workflow configuration, and the JSON schemas of everything a user writes in
YAML.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationError

from fingerpad.documents import Problem, Strict, explain
from fingerpad.fields import filled, listed, number
from fingerpad.scenes.scene import LEVELS

ELASTIC_CURVES = (
    "calibration_plate",
    "calibration_less_fat",
    "calibration_more_fat",
    "calibration_long_term",
)


def _text(pattern: str, allowed: str) -> Any:
    """Field type: text of a pattern, else one line that says what is allowed."""

    def check(value: Any) -> Any:
        if not isinstance(value, str) or not re.search(pattern, value):
            raise Problem("is not allowed here", allowed)
        return value

    return Annotated[str, BeforeValidator(check), Field(json_schema_extra={"pattern": pattern})]


def _accuracy(value: Any) -> Any:
    if value in LEVELS or (isinstance(value, float) and 0 < value < 1):
        return value
    raise Problem(
        "is not a known accuracy", f"{', '.join(LEVELS)}, or a tolerance above 0 and below 1"
    )


def _list(item: Any) -> Any:
    return Annotated[tuple[item, ...], BeforeValidator(listed)]


Name = _text(r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$", "letters, digits, _, - and .")
FigureNumber = _text(r"^[0-9]+-[0-9]+$", 'a figure of the thesis in quotes, such as "4-10"')
Directory = _text(
    r"^[^/](.*[^/])?$", "a folder, relative to where the workflow runs, such as results/mine"
)
Folder = _text(r"\S", "a folder, relative to where the workflow runs or absolute")
Coefficient = number("a number above 0", 0, math.inf)
Height = number("a number from 0", 0, math.inf, low_included=True)
Seed = Annotated[int, Field(ge=1, le=9999)]
_ACCURACY = {
    "anyOf": [
        {"enum": list(LEVELS)},
        {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1},
    ]
}
Accuracy = Annotated[Any, BeforeValidator(_accuracy), Field(json_schema_extra=_ACCURACY)]


class WorkflowConfig(Strict):
    """What the workflow simulates, draws and tabulates, and where it puts it. `name` and `scenes`
    suffice.
    """

    name: Name
    """Name of the run."""
    scenes: Annotated[
        tuple[Name, ...], BeforeValidator(filled), Field(json_schema_extra={"minItems": 1})
    ]
    """Scenes to simulate: names of files in `scenes_folder` or, where it has none of that name, in
    config/scenes.
    """
    results: Directory
    """Folder of plans, meshes and simulation histories; results/<name> if left out."""
    figures: Directory
    """Folder of the thesis's figures, fig_<number>.png beside fig_<number>.csv; figures in
    `results` if left out.
    """
    tables: Directory
    """Folder of the tables, <name>.csv beside <name>.md; tables in `results` if left out."""
    studies: Directory
    """Folder of the figures of studies, <name>.png beside <name>.csv; studies in `results` if left
    out.
    """
    scenes_folder: Folder = "config/scenes"
    """Folder of the scenes."""
    subjects: Folder = "config/reference/force_depth"
    """Folder of measured forces, a CSV file or more; if it is given, the pad is calibrated to
    them.
    """
    variants: _list(Name) = ()
    """Scenes simulated without a companion: those of tables of sensitivity, and coarse ones of
    figures.
    """
    calibration_scenes: _list(Name) = ()
    """Scenes of the calibration, calibration_plate among them; left out, no calibration but to
    `subjects` of one's own.
    """
    friction_scenes: _list(Name) = ()
    """Strokes of the calibration of friction, stroke_sub_10 among them, and variations of it."""
    friction_coefficients: _list(Coefficient) = ()
    """Coefficients with which stroke_sub_10 is stroked, as a draft; left out, friction is not
    calibrated.
    """
    ridge_heights: _list(Height) = ()
    """Heights (um) of the ridges over which ridged_stroke_right is varied, 0 and 150 among them;
    left out, no study of ridges.
    """
    ridge_frictions: _list(Height) = ()
    """No longer used: the study of ridges varies height and mesh only."""
    accuracy: Accuracy = None
    """Accuracy, a level or a tolerance, that replaces what every scene states; left out, as each
    states.
    """
    companions: bool = False
    """Whether each scene has two companions on a mesh with edges half as long again, one with its
    own steps and one with half of them, from which errors follow.
    """
    figure_numbers: _list(FigureNumber) | None = None
    """Figures to draw, by their number in the thesis; left out, all whose scenes the configuration
    has.
    """
    animations: _list(Name) = ()
    """Scenes to make a moving picture of, animation_<scene>.gif among the studies; they
    need snapshots.
    """
    field_scenes: _list(Name) = ()
    """Scenes simulated with whole fields of strain energy at their snapshots, for pictures of what
    happens inside.
    """
    seed: Seed | None = None
    """Seed of hard cases that are drawn anew, by `snakemake stability_unseen --config seed=N`; left
    out, the three that are published.
    """
    table_names: _list(Name) = ("summary",)
    """Tables to write; summary, what every scene ended at, if left out."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Folders left out follow from the name; subjects of one's own are calibrated to."""
        if "name" in data:
            data.setdefault("results", f"results/{data['name']}")
        if isinstance(data.get("results"), str):
            for folder in ("figures", "tables", "studies"):
                data.setdefault(folder, f"{data['results']}/{folder}")
        if "subjects" in data:
            data.setdefault("calibration_scenes", list(ELASTIC_CURVES))
        return data

    @property
    def every_scene(self) -> tuple[str, ...]:
        """Names of all the scenes, each once."""
        return tuple(
            dict.fromkeys(
                (*self.scenes, *self.variants, *self.calibration_scenes, *self.friction_scenes)
            )
        )


def read_config(document: Mapping[str, Any], file: str | Path) -> WorkflowConfig:
    """The configuration that a document states, read from `file`; SceneError, one line, if anything
    in it is wrong.
    """
    try:
        return WorkflowConfig.model_validate(dict(document), context=Path(file))
    except ValidationError as error:
        raise explain(error, file, document) from None


def workflow_json_schema() -> dict[str, Any]:
    """JSON schema of a workflow configuration as people write it."""
    schema = WorkflowConfig.model_json_schema()
    schema["required"] = ["name", "scenes"]
    return schema | {"title": "A fingerpad workflow configuration"}
