"""fingerpad: specimen -> stimulus -> mechanics -> receptors -> figures and tables.

Inputs:  config/thesis.yaml or the configuration given with --configfile, the scenes, specimens and measured data that it names.
Outputs: the figures, tables and results that the configuration names, in the folder where Snakemake is started.

    make figures                                       everything of config/thesis.yaml
    .venv/bin/snakemake chapter4
    .venv/bin/snakemake figures/thesis/fig_4-10.png
    .venv/bin/snakemake --configfile mine.yaml         a study of your own: name and scenes suffice
    .venv/bin/snakemake map_of_touch    a sweep, not part of all; about ten minutes of one core
    .venv/bin/snakemake sweep --config sweep=mine.yaml [sweep_out=DIR]    a sweep of your own: config/sweeps/example.yaml
    .venv/bin/snakemake -s /path/to/fingerpad/Snakefile --configfile mine.yaml     from another folder

What a target makes follows from the configuration in cysyk1999.workflow.products, a rule a job (workflow/rules/jobs.smk), and
what a job does is in cysyk1999.workflow.jobs. The profile is found by itself, through the link `profiles` beside this file.
"""

import os
import sys
from pathlib import Path

os.environ["MPLBACKEND"] = "agg"  # a notebook from which the workflow is started has another one

from snakemake.utils import min_version

from cysyk1999.config import read_config
from fingerpad.documents import SceneError
from cysyk1999.workflow.lock import take_over
from cysyk1999.workflow.products import Products

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
    PRODUCTS = Products(read_config(written, file), file, ROOT)
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
    calibration,
    ridges,
    accuracy,
    stability,
    effects,
    peers,
    report_pages,
    explanations,
    reconstruction,


rule all:
    """Every figure and table of the configuration, and the simulations they rest on."""
    default_target: True
    input:
        PRODUCTS.targets("catalogue", "animations", "views", "all_tables", "calibration", "ridges", "meanings", figures=""),
        PRODUCTS.histories(PRODUCTS.config.scenes),


rule chapter3:
    """The figures of the thesis's chapter 3: the specimen and its mesh, forces, surface profiles and layer boundaries."""
    input:
        PRODUCTS.targets(figures="3-"),


rule chapter4:
    """The figures of the thesis's chapter 4: ramp-and-hold indentation with nine surfaces."""
    input:
        PRODUCTS.targets(figures="4-"),


rule chapter5:
    """The figures of the thesis's chapter 5: a wavy surface stepped and stroked over the pad, and a stroke as a moving picture."""
    input:
        PRODUCTS.targets("animations", figures="5-"),


rule calibration:
    """The pad calibrated to measured forces: figures, table and specimens."""
    input:
        PRODUCTS.targets("calibration"),


rule ridges:
    """Pads with ridges: the figures of the thesis's section 5.5 and the study of the direction of strokes."""
    input:
        [PRODUCTS.picture_of(f.number) for f in PRODUCTS.drawn if f.number in ("5-25", "5-26", "5-28", "5-29")],
        PRODUCTS.targets("ridges"),


rule report_pages:
    """A page a figure, study and table: what `make report` packs."""
    input:
        PRODUCTS.targets("report"),


rule accuracy:
    """What accuracy costs in time, and whether runs know their error: figures and tables; about an hour and a half of one core."""
    input:
        PRODUCTS.targets("accuracy"),


rule stability:
    """How stable the method is in hard cases, beside simpler methods: a heat map and a table."""
    input:
        PRODUCTS.targets("stability"),


rule effects:
    """What each effect changes and costs, and the planner's choices and rules against that: a figure and tables."""
    input:
        PRODUCTS.targets("effects"),


rule peers:
    """The same press through a public finite element package, if it is installed: a table."""
    input:
        peers_if_installed,


rule explanations:
    """Which reading of what the thesis leaves open brings about what does not hold here: a table; 25 minutes of one core."""
    input:
        PRODUCTS.targets("explanations"),


rule reconstruction:
    """The pad of 1999, inferred from the thesis's figures: tables and pictures; about an hour of one core, not part of all."""
    input:
        PRODUCTS.targets("reconstruction"),
