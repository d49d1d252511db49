"""A part of the study (changes: of chosen scenes, choices: of the planner in scenes drawn at
random) -> its rows.
"""

from pathlib import Path

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.effects.run import study, verdicts


def run(job):
    """`part` -> `data`."""
    write_frame({"changes": study, "choices": verdicts}[job.part[0]](), Path(job.data[0]))
