"""Solve every hard case by a method: stability_method.py METHOD OUT.csv"""

import sys
from pathlib import Path

from fingerpad.figures.io import write_frame
from fingerpad.studies.stability import study

method, out = sys.argv[1:]
write_frame(study(method.replace("_", " ")), Path(out))
