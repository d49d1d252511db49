"""Compare with a public package: peers.py TABLE.csv"""

import sys

from fingerpad.publishing.write import publish_table
from fingerpad.studies.peers import study

publish_table(study(), sys.argv[1])
