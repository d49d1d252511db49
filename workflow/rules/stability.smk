"""Hard cases -> how stable the default method is in them, beside simpler methods.

Inputs:  none but the catalogue, fingerpad.studies.stability.hard_cases, and the thesis's specimen.
Outputs: <results>/stability/<method>.csv, and from them <studies>/stability.png beside its data, <tables>/stability.csv and .md.
"""

from fingerpad.studies.stability.picture import METHODS

STABILITY = [method.replace(" ", "_") for method in METHODS]


rule stability_method:
    """A method -> every hard case solved with it, and what was measured."""
    input:
        sources("stability_method"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
    output:
        f"{RESULTS}/stability/{{method}}.csv",
    wildcard_constraints:
        method="|".join(STABILITY),
    log:
        f"{RESULTS}/logs/stability/{{method}}.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=20,
    shell:
        "python workflow/scripts/stability_method.py {wildcards.method} {output} > {log} 2>&1"


rule stability_figure:
    """What the methods did -> the picture, the plotted data beside it, and the table."""
    input:
        sources("stability_figure"),
        ENVIRONMENT,
        methods=expand(f"{RESULTS}/stability/{{method}}.csv", method=STABILITY),
    output:
        png=report(
            f"{config['studies']}/stability.png",
            caption="../report/study.rst",
            category="Studies",
            labels={"study": "stability"},
        ),
        data=f"{config['studies']}/stability.csv",
        csv=f"{config['tables']}/stability.csv",
        md=f"{config['tables']}/stability.md",
    log:
        f"{RESULTS}/logs/stability_figure.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/stability_figure.py {output.png} {output.csv} {input.methods} > {log} 2>&1"
