"""Draw and tabulate the study of effects: effects_figure.py CHANGES.csv CHOICES.csv FIGURE.png TABLE.csv ..."""

import sys

import pandas as pd

from fingerpad.publishing.write import publish, publish_table
from fingerpad.studies.effects.picture import assemble, effects
from fingerpad.studies.effects.run import evidence, rules_table

changes, choices, png, *tables = sys.argv[1:]
changes, choices = pd.read_csv(changes), pd.read_csv(choices)
frame = assemble(changes, choices)
publish(effects(frame), frame, png)
for table, path in zip((evidence(changes, choices), choices, rules_table(changes, choices)), tables, strict=True):
    publish_table(table, path)
