"""fingerpad: specimen -> stimulus -> mechanics -> receptors -> figures and tables.

Inputs:  config/thesis.yaml or the configuration given with --configfile, the scenes, specimens and measured data that it names.
Outputs: the figures, tables and results that the configuration names, in the folder where Snakemake is started.

    make figures                                       everything of config/thesis.yaml
    .venv/bin/snakemake chapter4
    .venv/bin/snakemake figures/thesis/fig_4-10.png
    .venv/bin/snakemake --configfile mine.yaml         a study of your own: name and scenes suffice
    .venv/bin/snakemake map_of_touch                   a sweep, not part of all; about five minutes of one core
    .venv/bin/snakemake sweep --config sweep=mine.yaml [sweep_out=DIR]    a sweep of your own: config/sweeps/example.yaml
    .venv/bin/snakemake -s /path/to/fingerpad/Snakefile --configfile mine.yaml     from another folder

What a target makes follows from the configuration and the jobs that the package declares (`cysyk1999.job`), each of which is a
rule (workflow/rules/jobs.smk). The profile is found by itself, through the link `profiles` beside this file.
"""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

os.environ["MPLBACKEND"] = "agg"  # a notebook from which the workflow is started has another one

from snakemake.utils import min_version

from cysyk1999.config import read_config
from fingerpad.documents import SceneError
from cysyk1999.workflow.lock import take_over
from cysyk1999.project import Project

min_version("9.3")

ROOT = Path(str(workflow.current_basedir))
DEFAULT = ROOT / "config" / "thesis.yaml"

if workflow.is_main_process and (stale := take_over()):
    print(f"took over {stale} locks of a run that has died", file=sys.stderr)

# Not an unconditional default: Snakemake would merge its keys into those of a file given on the command line.
if not workflow.overwrite_configfiles:

    configfile: DEFAULT


try:
    file = next(reversed(workflow.overwrite_configfiles), DEFAULT)
    written = {key: value for key, value in config.items() if key not in ("sweep", "sweep_out")}
    PROJECT = Project(read_config(written, file), file, ROOT)
except SceneError as error:  # one line, without Snakemake's words round it
    print(error, file=sys.stderr)
    sys.exit(2)


report: "workflow/report/workflow.rst"


include: "workflow/rules/jobs.smk"


if "sweep" in config:  # snakemake sweep --config sweep=config/sweeps/example.yaml

    include: "workflow/rules/sweeps.smk"


# Snakemake keeps to a rate of starts by looking for jobs again a second after each look, of which every job that ends adds one: of
# ninety jobs that took an eighth of the time of all. On one machine its cores are limit enough.
onstart:
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None


localrules:
    all,
    chapter3,
    chapter4,
    chapter5,


rule all:
    """Every figure and table of the configuration, and the simulations they rest on."""
    default_target: True
    input:
        PROJECT.default(),


rule chapter3:
    """The figures of the thesis's chapter 3: the specimen and its mesh, forces, surface profiles and layer boundaries."""
    input:
        PROJECT.targets(figures="3-"),


rule chapter4:
    """The figures of the thesis's chapter 4: ramp-and-hold indentation with nine surfaces."""
    input:
        PROJECT.targets(figures="4-"),


rule chapter5:
    """The figures of the thesis's chapter 5: a wavy surface stepped and stroked over the pad, and a stroke as a moving picture."""
    input:
        PROJECT.targets("animations", figures="5-"),


def wanted(target):
    """The files of a part; none, and a line, without the package that only it needs."""

    def files(wildcards):
        if target.extra and not find_spec(target.extra):
            line = f"{target.name}: {target.extra} is not installed; pip install -e .[{target.name}]"
            print(line, file=sys.stderr)
            return []
        return PROJECT.targets(target.name)

    return files


for target in PROJECT.part_targets():  # the studies and other parts

    rule:
        name:
            target.name
        localrule: True
        input:
            wanted(target),

    if workflow.is_rule(target.name):  # in a workflow that takes this one as a module it has another name
        workflow.get_rule(target.name).docstring = target.title
