"""What the Snakefile asks the package: its typed configuration, the jobs that follow from it, and
the doing of one job.
"""
