"""What the workflow's jobs do, a module each: `run(job)` reads the files that `job` names and
writes those it names.
"""
