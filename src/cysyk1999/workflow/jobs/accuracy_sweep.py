"""A scene and an element, in many discretisations -> what they answer, and what that costs."""

import json

from cysyk1999.studies.accuracy.run import measure_all, sweeps
from fingerpad import load_scene
from fingerpad.files import write_text


def run(job):
    """`sweep`, `scene` -> `records` (JSON)."""
    records = []
    for record in measure_all(sweeps()[job.sweep[0]], load_scene(job.scene[0])):
        print(record["name"], f"{record['cost']['cpu_s'][0]:.1f} s", record["failure"], flush=True)
        records.append(record)
    write_text(job.records[0], json.dumps(records, indent=1) + "\n")
