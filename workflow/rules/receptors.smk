"""Simulations and impulse rates -> the laws from skin to impulses: constants, candidate stimuli, a tactile sensor.

Inputs:  the histories of pressed surfaces and of strokes over the wavy one, config/reference/impulse_rates/*.csv (published) and
         config/reference/recordings/*.csv (the user's).
Outputs: <tables>/{receptor_fits,candidate_stimuli,sensor_accuracy,rapidly_adapting}.csv and .md, those that `table_names` has;
         <studies>/strain_energy_meanings.png beside its data, if all nine surfaces are there.
"""

from glob import glob

NINE = [s for s in config["scenes"] if s.startswith("ramp40_")]
FELT = [s for s in [*config["scenes"], *config.get("variants", [])] if s.startswith(("ramp40_", "ramp150_", "press", "stroke_"))]


rule receptor_table:
    """Histories, companions, published and recorded rates -> a table of what receptors make of them."""
    input:
        sources("receptor_table"),
        ENVIRONMENT,
        rates=sorted(glob("config/reference/impulse_rates/*.csv") + glob("config/reference/recordings/*.csv")),
        histories=histories(FELT),
        coarse=companions([scene for scene in config["scenes"] if scene.startswith(("ramp40_", "stroke_10"))]),
    output:
        csv=report(
            f"{config['tables']}/{{table}}.csv",
            caption="../report/table.rst",
            category="Tables",
            labels={"table": "{table}"},
        ),
        md=f"{config['tables']}/{{table}}.md",
    wildcard_constraints:
        table="receptor_fits|candidate_stimuli|sensor_accuracy|rapidly_adapting",
    log:
        f"{RESULTS}/logs/receptors/{{table}}.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/receptor_table.py {wildcards.table} {output.csv} {input.rates} {input.histories} {input.coarse}"
        " > {log} 2>&1"


rule strain_energy_meanings:
    """Histories of the nine surfaces -> the definitions of strain energy over the ramp and hold, and which fall in the hold."""
    input:
        sources("strain_energy_meanings"),
        ENVIRONMENT,
        histories=histories(NINE),
        coarse=companions(NINE),
    output:
        png=report(
            f"{config['studies']}/strain_energy_meanings.png",
            caption="../report/strain_energy_meanings.rst",
            category="Receptors",
            labels={"study": "strain energy meanings"},
        ),
        csv=f"{config['studies']}/strain_energy_meanings.csv",
    log:
        f"{RESULTS}/logs/strain_energy_meanings.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/strain_energy_meanings.py {output.png} {input.histories} {input.coarse} > {log} 2>&1"
