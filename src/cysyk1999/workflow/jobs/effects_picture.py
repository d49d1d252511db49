"""Both parts of the study -> the picture, and the tables: evidence, choices and rules of the
planner.
"""

import pandas as pd

from cysyk1999.publishing.write import publish, publish_table
from cysyk1999.studies.effects.picture import assemble, effects
from cysyk1999.studies.effects.run import evidence, rules_table


def run(job):
    """`parts`: changes, choices -> `picture`, `tables`: effects, planner_choices, planner_rules."""
    changes, choices = map(pd.read_csv, job.parts)
    frame = assemble(changes, choices)
    publish(effects(frame), frame, job.picture[0])
    for table, path in zip(
        (evidence(changes, choices), choices, rules_table(changes, choices)),
        job.tables,
        strict=True,
    ):
        publish_table(table, path)
