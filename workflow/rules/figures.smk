"""Simulations -> figures and tables. Nothing here runs mechanics.

Inputs:  <results>/{simulations,coarse}/<scene>/history.nc and mesh.msh, config/reference.
Outputs: <figures>/fig_<number>.png beside fig_<number>.csv (the plotted data), <tables>/<name>.csv and <name>.md,
         <studies>/animation_<scene>.gif, figures/README.md.
"""

from fingerpad.figures.registry import FIGURES

REFERENCE = "config/reference/thesis_numbers.csv"


rule figure:
    """The histories and meshes a figure needs -> the picture, and the plotted data beside it."""
    input:
        sources("figure"),
        ENVIRONMENT,
        reference=REFERENCE,
        histories=lambda w: histories(FIGURES[w.number].needs),
        meshes=lambda w: meshes(FIGURES[w.number].needs),
        coarse=lambda w: companions(FIGURES[w.number].read_companions),
        measured=lambda w: FIGURES[w.number].measured_files("config/reference"),
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


rule catalogue:
    """The thesis's figures and the numbers of those drawn -> figures/README.md: which are here, and what stands in for others."""
    input:
        sources("catalogue"),
        ENVIRONMENT,
        catalogue="config/reference/figures.csv",
    output:
        "figures/README.md",
    params:
        made=" ".join(config["figure_numbers"]),
    log:
        f"{RESULTS}/logs/catalogue.log",
    threads: 1
    resources:
        mem_mb=500,
        runtime=2,
    shell:
        "python workflow/scripts/catalogue.py {input.catalogue} {output} {params.made} > {log} 2>&1"


rule animation:
    """The full fields of a history -> a moving picture."""
    input:
        sources("animation"),
        ENVIRONMENT,
        history=f"{RESULTS}/simulations/{{scene}}/history.nc",
    output:
        f"{config['studies']}/animation_{{scene}}.gif",
    log:
        f"{RESULTS}/logs/animation/{{scene}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/animation.py {input.history} {output} > {log} 2>&1"


rule measures:
    """Every number that is read of a scene, its mesh, its history and its companion -> one long table."""
    input:
        sources("measures"),
        ENVIRONMENT,
        histories=histories([*config["scenes"], *config.get("variants", []), *CALIBRATION]),
        meshes=meshes(config["scenes"]),
        coarse=companions([*config["scenes"], *(["calibration_plate", RAMP] if RAMP in CALIBRATION else [])]),
    output:
        f"{RESULTS}/measures.csv",
    log:
        f"{RESULTS}/logs/measures.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/measures.py {output} {input.histories} {input.meshes} {input.coarse} > {log} 2>&1"


rule table:
    """The measures of all scenes and the thesis's numbers -> a table, for programs (CSV) and for people (Markdown)."""
    input:
        sources("table"),
        ENVIRONMENT,
        reference=REFERENCE,
        measures=f"{RESULTS}/measures.csv",
    output:
        csv=report(
            f"{config['tables']}/{{table}}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "{table}"},
        ),
        md=f"{config['tables']}/{{table}}.md",
    wildcard_constraints:
        table="thesis_comparison|sensitivity",
    log:
        f"{RESULTS}/logs/table/{{table}}.log",
    threads: 1
    resources:
        mem_mb=500,
        runtime=2,
    shell:
        "python workflow/scripts/table.py {wildcards.table} {input.reference} {input.measures} {output.csv} > {log} 2>&1"


rule mesh_quality:
    """The meshes of the scenes -> a table of their quality."""
    input:
        sources("mesh_quality"),
        ENVIRONMENT,
        meshes=meshes(config["scenes"]),
    output:
        csv=report(
            f"{config['tables']}/mesh_quality.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "mesh_quality"},
        ),
        md=f"{config['tables']}/mesh_quality.md",
    log:
        f"{RESULTS}/logs/table/mesh_quality.log",
    threads: 1
    resources:
        mem_mb=500,
        runtime=2,
    shell:
        "python workflow/scripts/mesh_quality.py {output.csv} {input.meshes} > {log} 2>&1"
