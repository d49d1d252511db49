"""The thesis's figures and the titles of those drawn -> figures/README.md: which are here, and what stands in for others."""

import json

from fingerpad.figures.catalogue import read_catalogue, readme
from fingerpad.files import write_text


def run(job):
    """`catalogue` (CSV) and `titles` (JSON, number -> title) -> `readme`."""
    write_text(job.readme[0], readme(read_catalogue(job.catalogue[0]), json.loads(job.titles[0])))
