"""The typed model of a workflow configuration, and the JSON schemas of everything a user writes in YAML.

``python -m fingerpad.config schemas`` writes ``workflow/schemas/*.schema.json``; the first line of each YAML
file under ``config/`` points an editor at its schema.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9_]+$")]
FigureNumber = Annotated[str, StringConstraints(pattern=r"^[0-9]+-[0-9]+$")]
Directory = Annotated[str, StringConstraints(pattern=r"^[^/](.*[^/])?$")]
Accuracy = Literal["draft", "thesis", "fine"] | Annotated[float, Field(gt=0, lt=1)]


class WorkflowConfig(BaseModel):
    """What the workflow simulates, draws and tabulates, and where it puts it (paths from the root)."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", use_attribute_docstrings=True, title="A fingerpad workflow configuration"
    )

    name: Name
    """Name of the run."""
    results: Directory
    """Directory of plans, meshes and simulation histories (not committed)."""
    figures: Directory
    """Directory of the thesis figures, fig_<number>.png beside fig_<number>.csv."""
    tables: Directory
    """Directory of the tables, <name>.csv beside <name>.md."""
    studies: Directory
    """Directory of the figures of studies, <name>.png beside <name>.csv."""
    scenes: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Scenes to simulate, files of config/scenes."""
    variants: tuple[Name, ...] = ()
    """Scenes simulated without a companion: those of tables of sensitivity, and coarse ones of figures."""
    calibration_scenes: tuple[Name, ...] = ()
    """Scenes of the calibration, calibration_plate among them; left out, no calibration."""
    friction_scenes: tuple[Name, ...] = ()
    """Strokes of the calibration of friction, stroke_sub_10 among them, and variations of it."""
    friction_coefficients: tuple[Annotated[float, Field(gt=0)], ...] = ()
    """Coefficients with which stroke_sub_10 is stroked, as accurately as companions; left out, friction is not calibrated."""
    ridge_heights: tuple[Annotated[float, Field(ge=0)], ...] = ()
    """Heights (um) of the ridges over which ridged_stroke_right is varied, 0 and 150 among them; left out, no study of ridges."""
    ridge_frictions: tuple[Annotated[float, Field(ge=0)], ...] = ()
    """Coefficients of friction over which ridged_stroke_right is varied."""
    accuracy: Accuracy | None = None
    """Accuracy, a level or a tolerance, that replaces what every scene states; left out, as each states."""
    companion_accuracy: Accuracy | None = None
    """Accuracy of each scene's coarser companion, from which discretisation errors follow; left out, none."""
    figure_numbers: tuple[FigureNumber, ...]
    """Figures to draw, by their number in the thesis."""
    animations: tuple[Name, ...] = ()
    """Scenes to make a moving picture of, animation_<scene>.gif among the studies; they need snapshots."""
    table_names: tuple[Name, ...] = ()
    """Tables to write."""


def schemas() -> dict[str, dict]:
    """Return the JSON schema of each kind of YAML file, by the stem of its schema file."""
    from fingerpad.scenes.scene import scene_json_schema, specimen_json_schema

    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {
        "workflow": dialect | WorkflowConfig.model_json_schema(),
        "scene": scene_json_schema(),
        "specimen": specimen_json_schema(),
    }


def write_schemas(directory: Path) -> list[Path]:
    """Write the schema files into `directory` and return their paths."""
    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for stem, schema in schemas().items():
        path = directory / f"{stem}.schema.json"
        path.write_text(json.dumps(schema, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        paths.append(path)
    return paths


if __name__ == "__main__":
    if sys.argv[1:2] != ["schemas"]:
        sys.exit("usage: python -m fingerpad.config schemas [DIRECTORY]")
    for written in write_schemas(Path(*sys.argv[2:3] or ("workflow/schemas",))):
        print(written)
