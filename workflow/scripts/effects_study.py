"""Run a part of the study of effects: effects_study.py {changes|choices} OUT.csv"""

import sys
from pathlib import Path

from fingerpad.figures.io import write_frame
from fingerpad.studies.effects import study, verdicts

part, out = sys.argv[1:]
write_frame({"changes": study, "choices": verdicts}[part](), Path(out))
