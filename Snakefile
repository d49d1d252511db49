"""fingerpad: specimen -> stimulus -> mechanics -> receptors -> figures and tables.

Inputs:  config/thesis.yaml (or the file given with --configfile), config/scenes, config/specimens.
Outputs: the figures, tables and results that the configuration names.

    make figures                                       everything of config/thesis.yaml
    .venv/bin/snakemake chapter4
    .venv/bin/snakemake figures/thesis/fig_4-10.png

The profile is found by itself, through the link `profiles` beside this file.
"""

import sys

from snakemake.utils import min_version, validate

from fingerpad.workflow.lock import take_over

min_version("9.3")

if workflow.is_main_process and (stale := take_over()):
    print(f"took over {stale} locks of a run that has died", file=sys.stderr)

# Not an unconditional default: Snakemake would merge its keys into those of a file given on the command line.
if not workflow.overwrite_configfiles:

    configfile: "config/thesis.yaml"


validate(config, "workflow/schemas/workflow.schema.json")


include: "workflow/rules/common.smk"
include: "workflow/rules/simulations.smk"
include: "workflow/rules/calibration.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/receptors.smk"
include: "workflow/rules/accuracy.smk"
include: "workflow/rules/ridges.smk"
include: "workflow/rules/stability.smk"
include: "workflow/rules/effects.smk"
include: "workflow/rules/peers.smk"


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


rule all:
    """Every figure and table of the configuration, and the simulations they rest on."""
    default_target: True
    input:
        figures(),
        catalogue(),
        animations(),
        tables(),
        calibration(),
        ridges(),
        meanings(),
        histories(config["scenes"]),


rule chapter3:
    """The figures of the thesis's chapter 3: the specimen and its mesh, forces, surface profiles and layer boundaries."""
    input:
        figures("3-"),


rule chapter4:
    """The figures of the thesis's chapter 4: ramp-and-hold indentation with nine surfaces."""
    input:
        figures("4-"),


rule chapter5:
    """The figures of the thesis's chapter 5: a wavy surface stepped and stroked over the pad, and a stroke as a moving picture."""
    input:
        figures("5-"),
        animations(),


rule calibration:
    """The pad calibrated to measured forces: figures, table and specimens."""
    input:
        calibration(),


rule ridges:
    """Pads with ridges: the figures of the thesis's section 5.5 and the study of the direction of strokes."""
    input:
        figures("5-25"),
        figures("5-26"),
        figures("5-28"),
        figures("5-29"),
        ridges(),


rule accuracy:
    """What accuracy costs in time, and whether runs know their error: figures and tables; about an hour and a half of one core."""
    input:
        expand(f"{config['tables']}/{{name}}.csv", name=[*ACCURACY_TABLES, "accuracy_belief"]),
        expand(f"{config['studies']}/accuracy_{{name}}.png", name=["error", "error_stroke", "growth", "belief"]),


rule stability:
    """How stable the method is in hard cases, beside simpler methods: a heat map and a table."""
    input:
        f"{config['studies']}/stability.png",


rule effects:
    """What each effect changes and costs, and the planner's choices and rules against that: a figure and tables."""
    input:
        f"{config['studies']}/effects.png",


rule peers:
    """The same press through a public finite element package, if it is installed: a table."""
    input:
        peers,
