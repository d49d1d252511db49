"""What the studies and figures of the package offer, read without importing them when nothing they
rest on has changed.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from fingerpad.files import write_text
from fingerpad.provenance import code_digest

_MODULES = (
    "cysyk1999.figures.registry",
    "cysyk1999.studies.accuracy.belief",
    "cysyk1999.studies.accuracy.run",
    "cysyk1999.studies.accuracy.shown",
    "cysyk1999.studies.explanations.run",
    "cysyk1999.studies.stability.picture",
    "cysyk1999.studies.views.frames",
)


@dataclass(frozen=True)
class Figure:
    """A figure as the workflow sees it: the module that draws it, the scenes whose histories and
    meshes it needs, those whose companions it compares with, and patterns of the files of measured
    data, in the folder of reference data.
    """

    number: str
    title: str
    module: str
    needs: tuple[str, ...]
    companions: tuple[str, ...]
    measured: tuple[str, ...]


@cache
def offered(folder: str | Path = ".snakemake") -> dict[str, Any]:
    """What is on offer: `figures` by number, and the studies' `FAMILY`, `EDGED`, `RIDGED`,
    `SWEEPS`, `MADE_FINER`, `OUTSIDE`, `CLASSES` (accuracy), `METHODS` (stability), `READINGS` of
    the scenes `READ` and those `READ_ONLY` of results (explanations), `VIEWS` with scenes.

    Kept in `folder` beside the digest of the modules that say it: importing them takes longer than
    all else a dry run does.
    """
    key = code_digest() + code_digest(Path(__file__).parents[1])
    path = Path(folder, "offered.json")
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        kept = {}
    if kept.get("key") != key:
        kept = {"key": key, **_read()}
        write_text(path, json.dumps(kept, indent=1, ensure_ascii=False) + "\n")
    figures = {
        number: Figure(
            number, **{k: tuple(v) if isinstance(v, list) else v for k, v in entry.items()}
        )
        for number, entry in kept["figures"].items()
    }
    return kept | {"figures": figures}


def _read() -> dict[str, Any]:
    from cysyk1999.figures.grammar import MEASURED
    from cysyk1999.figures.registry import CHAPTERS
    from cysyk1999.studies.accuracy.belief import OUTSIDE
    from cysyk1999.studies.accuracy.drawn import CLASSES
    from cysyk1999.studies.accuracy.ridges import SURFACES
    from cysyk1999.studies.accuracy.run import EDGED, FAMILY, sweeps
    from cysyk1999.studies.accuracy.shown import MADE_FINER
    from cysyk1999.studies.accuracy.strokes import STROKED_OVER
    from cysyk1999.studies.explanations.run import PRESSED, READ_ONLY, READINGS, STROKED
    from cysyk1999.studies.stability.picture import PARTS
    from cysyk1999.studies.views.frames import FRAMES

    found = [(spec, module) for module, specs in CHAPTERS.items() for spec in specs]
    figures = {
        spec.number: {
            "title": spec.title,
            "module": module,
            "needs": list(spec.needs),
            "companions": list(spec.read_companions),
            "measured": MEASURED[spec.measured][0].split() if spec.measured else [],
        }
        for spec, module in sorted(
            found, key=lambda pair: [int(n) for n in pair[0].number.split("-")]
        )
    }
    offers = {"OUTSIDE": list(OUTSIDE), "CLASSES": list(CLASSES), "METHODS": dict(PARTS)}
    simulated = [name for name in READINGS if name not in READ_ONLY]
    offers |= {"READINGS": simulated, "READ_ONLY": list(READ_ONLY), "READ": [*PRESSED, *STROKED]}
    offers["STROKED_OVER"] = list(STROKED_OVER)
    offers["VIEWS"] = {name: list(scenes) for name, (_, scenes) in FRAMES.items()}
    return {
        "figures": figures,
        "FAMILY": FAMILY,
        "EDGED": EDGED,
        "RIDGED": list(SURFACES),
        "SWEEPS": list(sweeps()),
        "MADE_FINER": list(MADE_FINER),
    } | offers
