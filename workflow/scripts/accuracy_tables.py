"""Put the records of the study of accuracy into tables: accuracy_tables.py ACCURACY.csv RECORD.json ..."""

import json
import sys
from pathlib import Path

from fingerpad import load_scene
from fingerpad.publishing.write import publish_table
from fingerpad.studies.accuracy.errors import accuracy_table, orders_table, planner_table, presets_table
from fingerpad.studies.accuracy.run import FAMILY

table, *paths = map(Path, sys.argv[1:])
records = {record["name"]: record for path in paths for record in json.loads(path.read_text(encoding="utf-8"))}
scenes = {family: load_scene(f"config/scenes/{name}.yaml") for family, name in FAMILY.items()}
accuracy = accuracy_table(records, scenes)
publish_table(accuracy, table)
publish_table(orders_table(records), table.with_name("accuracy_orders.csv"))
publish_table(planner_table(records), table.with_name("accuracy_planner.csv"))
publish_table(presets_table(accuracy), table.with_name("presets.csv"))
