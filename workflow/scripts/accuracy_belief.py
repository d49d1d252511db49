"""What runs of a scene believe of their error, and the truth: accuracy_belief.py SCENE BASE.yaml ROWS.csv"""

import sys
from pathlib import Path

import pandas as pd

from fingerpad import load_scene
from fingerpad.publishing.write import write_frame
from fingerpad.studies.accuracy.belief import beliefs, prepared

name, base, out = sys.argv[1:]
write_frame(pd.DataFrame(beliefs(prepared(name, load_scene(base)), name)), Path(out))
