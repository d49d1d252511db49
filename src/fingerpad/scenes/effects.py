"""Which effects a scene may switch: one for each file in ``planning/effects``, where they are
decided on.

Planning stands above scenes and is not imported here: the names of its files are the words of the
language.
"""

from pathlib import Path

_FILES = Path(__file__).parents[1] / "planning" / "effects"

EFFECTS: list[str] = sorted(path.stem for path in _FILES.glob("*.py") if path.stem != "__init__")
"""Names of effects, as scenes switch them; one that is registered at run time comes to them."""
