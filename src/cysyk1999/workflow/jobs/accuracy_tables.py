"""The records of all runs -> errors and costs, observed orders, the planner's error table, the
presets.
"""

import json
from pathlib import Path

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.accuracy.errors import (
    accuracy_table,
    orders_table,
    planner_table,
    presets_table,
)
from cysyk1999.studies.accuracy.run import FAMILY
from fingerpad import load_scene


def run(job):
    """`records` (JSON), `scenes` in the order of FAMILY -> `tables`: accuracy, accuracy_orders,
    accuracy_planner, presets.
    """
    records = {
        record["name"]: record
        for path in job.records
        for record in json.loads(Path(path).read_text(encoding="utf-8"))
    }
    accuracy = accuracy_table(records, dict(zip(FAMILY, map(load_scene, job.scenes), strict=True)))
    made = (accuracy, orders_table(records), planner_table(records), presets_table(accuracy))
    for table, path in zip(made, job.tables, strict=True):
        publish_table(table, path)
