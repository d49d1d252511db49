"""Simulations -> figures and tables. Nothing here runs mechanics.

Inputs:  <results>/{simulations,coarse}/<scene>/history.nc and mesh.msh, config/reference.
Outputs: <figures>/fig_<number>.png beside fig_<number>.csv (the plotted data), <tables>/<name>.csv and <name>.md.
"""

from fingerpad.figures import FIGURES

REFERENCE = "config/reference/thesis_numbers.csv"


rule figure:
    """The histories and meshes a figure needs -> the picture, and the plotted data beside it."""
    input:
        sources("figure"),
        ENVIRONMENT,
        reference=REFERENCE,
        histories=lambda w: histories(FIGURES[w.number].needs),
        meshes=lambda w: meshes(FIGURES[w.number].needs),
        coarse=lambda w: companions(FIGURES[w.number].needs),
    output:
        png=report(
            f"{config['figures']}/fig_{{number}}.png",
            caption="../report/figure.rst",
            category=lambda w: f"Chapter {w.number.split('-')[0]}",
            labels=lambda w: {"figure": w.number, "shows": FIGURES[w.number].title},
        ),
        csv=f"{config['figures']}/fig_{{number}}.csv",
    params:
        title=lambda w: FIGURES[w.number].title,
    log:
        f"{RESULTS}/logs/figure/{{number}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/figure.py {wildcards.number} {input.reference} {output.png}"
        " {input.histories} {input.meshes} {input.coarse} > {log} 2>&1"


rule thesis_comparison:
    """Every history -> each number and trend of the thesis beside its simulated value, with a verdict."""
    input:
        sources("thesis_comparison"),
        ENVIRONMENT,
        reference=REFERENCE,
        histories=histories(config["scenes"]),
        meshes=meshes(config["scenes"]),
        coarse=companions(config["scenes"]),
    output:
        csv=report(
            f"{config['tables']}/thesis_comparison.csv",
            caption="../report/thesis_comparison.rst",
            category="Tables",
            labels={"table": "thesis comparison"},
        ),
        md=f"{config['tables']}/thesis_comparison.md",
    log:
        f"{RESULTS}/logs/table/thesis_comparison.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/thesis_comparison.py {input.reference} {output.csv}"
        " {input.histories} {input.meshes} {input.coarse} > {log} 2>&1"
