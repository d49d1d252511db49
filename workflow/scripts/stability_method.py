"""Solve every hard case by a method: stability_method.py METHOD OUT.csv"""

import sys
from pathlib import Path

from fingerpad.publishing.write import write_frame
from fingerpad.studies.stability.run import study

method, out = sys.argv[1:]
write_frame(study(method.replace("_", " ")), Path(out))
