"""Run a part of the study of effects: effects_study.py {changes|choices} OUT.csv"""

import sys
from pathlib import Path

from fingerpad.publishing.write import write_frame
from fingerpad.studies.effects.run import study, verdicts

part, out = sys.argv[1:]
write_frame({"changes": study, "choices": verdicts}[part](), Path(out))
