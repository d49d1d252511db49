"""Scenes with and without each effect -> what it changes and costs, and whether the planner chooses well.

Inputs:  none but the scenes of fingerpad.studies.effects.run and the thesis's specimen.
Outputs: <results>/effects/{changes,choices}.csv, and from them <studies>/effects.png beside its data, and
         <tables>/{effects,planner_choices,planner_rules}.csv and .md.
"""

EFFECT_TABLES = ["effects", "planner_choices", "planner_rules"]


rule effects_study:
    """A part of the study (changes: of chosen scenes, choices: of the planner in scenes drawn at random) -> its rows."""
    input:
        sources("effects_study"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
    output:
        f"{RESULTS}/effects/{{part}}.csv",
    wildcard_constraints:
        part="changes|choices",
    log:
        f"{RESULTS}/logs/effects/{{part}}.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=20,
    shell:
        "python workflow/scripts/effects_study.py {wildcards.part} {output} > {log} 2>&1"


rule effects_figure:
    """Both parts -> the picture, the plotted data beside it, and the tables: evidence, choices and rules of the planner."""
    input:
        sources("effects_figure"),
        ENVIRONMENT,
        changes=f"{RESULTS}/effects/changes.csv",
        choices=f"{RESULTS}/effects/choices.csv",
    output:
        png=report(
            f"{config['studies']}/effects.png",
            caption="../report/study.rst",
            category="Studies",
            labels={"study": "effects"},
        ),
        data=f"{config['studies']}/effects.csv",
        csv=expand(f"{config['tables']}/{{name}}.csv", name=EFFECT_TABLES),
        md=expand(f"{config['tables']}/{{name}}.md", name=EFFECT_TABLES),
    log:
        f"{RESULTS}/logs/effects_figure.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/effects_figure.py {input.changes} {input.choices} {output.png} {output.csv} > {log} 2>&1"
