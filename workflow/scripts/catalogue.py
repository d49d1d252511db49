"""List the thesis's figures: catalogue.py FIGURES.csv README.md NUMBER ..., the numbers being those that are drawn."""

import sys

from fingerpad.figures.catalogue import read_catalogue, readme
from fingerpad.files import write_text

catalogue, path, *made = sys.argv[1:]
write_text(path, readme(read_catalogue(catalogue), made))
