"""The effects that a scene may switch.

Planning, which decides on them, stands above scenes and is not imported here: their names are
those of its files.
"""

import pkgutil
from pathlib import Path

_FILES = Path(__file__).parents[1] / "planning" / "effects"

EFFECTS: list[str] = [file.name for file in pkgutil.iter_modules([str(_FILES)])]
"""Names of effects, as scenes switch them; one that is registered at run time is appended."""
