"""The same press by this package and by a public one, if it is installed -> answers and cost side by side.

Inputs:  config/specimens/{thesis,homogeneous}.yaml.
Outputs: <tables>/peers.csv and .md.
"""

from importlib.util import find_spec


def peers(wildcards):
    """The table, or nothing but a line that says why."""
    if find_spec("felupe"):
        return [f"{config['tables']}/peers.csv"]
    print("peers: FElupe is not installed, so there is nothing to compare with; pip install -e .[peers]", file=sys.stderr)
    return []


rule peers_table:
    """A press -> both answers and what they cost, in one process."""
    input:
        sources("peers"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        "config/specimens/homogeneous.yaml",
    output:
        csv=report(
            f"{config['tables']}/peers.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "peers"},
        ),
        md=f"{config['tables']}/peers.md",
    log:
        f"{RESULTS}/logs/peers.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/peers.py {output.csv} > {log} 2>&1"
