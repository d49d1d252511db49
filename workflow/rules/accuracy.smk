"""What accuracy costs in time: scenes and discretisations -> errors and process times -> tables and figures.

Inputs:  config/scenes of the study's family.
Outputs: <results>/accuracy/<sweep>.json, runs of a scene and an element, and <results>/accuracy/belief/<scene>.csv; from them
         <tables>/accuracy.csv, accuracy_{orders,planner,belief}.csv and presets.csv with .md beside them, <studies>/accuracy_*.png
         beside their data.

Times are process times beside those of a yardstick, but `snakemake accuracy --cores 1` on an idle machine is what to publish.
"""

from fingerpad.studies.accuracy.run import FAMILY, sweeps
from fingerpad.studies.accuracy.belief import OUTSIDE

SWEEPS = list(sweeps())
ACCURACY_TABLES = ["accuracy", "accuracy_orders", "accuracy_planner", "presets"]


ruleorder: accuracy_tables > accuracy_beliefs


rule accuracy_sweep:
    """A scene and an element, in many discretisations -> what they answer, and what that costs."""
    input:
        sources("accuracy_sweep"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        scene=lambda wildcards: f"config/scenes/{FAMILY[wildcards.sweep.split('_')[0]]}.yaml",
    output:
        f"{RESULTS}/accuracy/{{sweep}}.json",
    wildcard_constraints:
        sweep="|".join(SWEEPS),
    log:
        f"{RESULTS}/logs/accuracy/{{sweep}}.log",
    threads: 1
    resources:
        mem_mb=3000,
        runtime=20,
    shell:
        "python workflow/scripts/accuracy_sweep.py {wildcards.sweep} {input.scene} {output} > {log} 2>&1"


rule accuracy_tables:
    """The records of all runs -> errors and costs, observed orders, the planner's error table, the presets."""
    input:
        sources("accuracy_tables"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        scenes=[f"config/scenes/{scene}.yaml" for scene in FAMILY.values()],
        records=expand(f"{RESULTS}/accuracy/{{sweep}}.json", sweep=SWEEPS),
    output:
        report(
            expand(f"{config['tables']}/{{name}}.csv", name=ACCURACY_TABLES),
            caption="../report/accuracy.rst",
            category="Accuracy",
        ),
        expand(f"{config['tables']}/{{name}}.md", name=ACCURACY_TABLES),
    log:
        f"{RESULTS}/logs/accuracy/tables.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/accuracy_tables.py {output[0]} {input.records} > {log} 2>&1"


rule accuracy_belief:
    """A scene outside the study at several accuracies -> what its runs believe of their error, and the truth."""
    input:
        sources("accuracy_belief"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        base=f"config/scenes/{FAMILY['210']}.yaml",
    output:
        f"{RESULTS}/accuracy/belief/{{outside}}.csv",
    wildcard_constraints:
        outside="[a-z0-9_]+",
    log:
        f"{RESULTS}/logs/accuracy/belief_{{outside}}.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/accuracy_belief.py {wildcards.outside} {input.base} {output} > {log} 2>&1"


rule accuracy_beliefs:
    """The beliefs of all scenes outside the study -> one table."""
    input:
        sources("accuracy_beliefs"),
        ENVIRONMENT,
        rows=expand(f"{RESULTS}/accuracy/belief/{{outside}}.csv", outside=OUTSIDE),
    output:
        csv=f"{config['tables']}/accuracy_belief.csv",
        md=f"{config['tables']}/accuracy_belief.md",
    log:
        f"{RESULTS}/logs/accuracy/beliefs.log",
    threads: 1
    resources:
        mem_mb=500,
        runtime=5,
    shell:
        "python workflow/scripts/accuracy_beliefs.py {output.csv} {input.rows} > {log} 2>&1"


rule accuracy_figure:
    """A table of the study -> a picture, and the plotted data beside it."""
    input:
        sources("accuracy_figure"),
        ENVIRONMENT,
        table=lambda w: f"{config['tables']}/{'accuracy_belief' if w.name == 'belief' else 'accuracy'}.csv",
    output:
        png=report(
            f"{config['studies']}/accuracy_{{name}}.png",
            caption="../report/accuracy.rst",
            category="Accuracy",
            labels={"study": "{name}"},
        ),
        csv=f"{config['studies']}/accuracy_{{name}}.csv",
    wildcard_constraints:
        name="[a-z_]+",
    log:
        f"{RESULTS}/logs/accuracy/figure_{{name}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/accuracy_figure.py accuracy_{wildcards.name} {input.table} {output.png} > {log} 2>&1"
