"""The JSON schemas of everything a user writes in YAML.

``python -m cysyk1999.workflow.schemas [DIRECTORY]`` writes ``workflow/schemas/*.schema.json``. The
first line of each YAML file under ``config/`` points an editor at its schema.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from cysyk1999.config import workflow_json_schema
from cysyk1999.studies.reconstruction.unknowns import unknowns_json_schema
from cysyk1999.studies.spheres.domes import sizes_json_schema
from fingerpad.scenes.scene import scene_json_schema, specimen_json_schema
from fingerpad.sweeps.language import sweep_json_schema


def schemas() -> dict[str, dict]:
    """Return the JSON schema of each kind of YAML file, by the stem of its schema file."""
    dialect = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {
        "workflow": dialect | workflow_json_schema(),
        "scene": scene_json_schema(),
        "specimen": specimen_json_schema(),
        "sweep": sweep_json_schema(),
        "reconstruction": dialect | unknowns_json_schema(),
        "spheres": dialect | sizes_json_schema(),
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
    for written in write_schemas(Path(*sys.argv[1:2] or ("workflow/schemas",))):
        print(written)
