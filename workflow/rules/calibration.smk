"""Simulations and measured forces -> the moduli's constant, the Prony series, the friction coefficient, calibrated specimens.

Inputs:  config/reference/{force_depth/*.csv,relaxation.csv,friction.csv,thesis_numbers.csv}, the histories of the scenes named by
         `calibration_scenes` and `friction_scenes`.
Outputs: <results>/calibration/*.csv, <results>/specimens/calibrated_*.yaml, and from the CSV files
         <studies>/calibration_*.png beside their data, <tables>/calibration.csv and calibration.md.

Specimens are committed as config/specimens/calibrated_*.yaml; `make specimens` takes over those of the default run.
"""

from glob import glob

FORCES = "config/reference/force_depth"
RAMP = "calibration_ramp_hold"
CALIBRATION = config.get("calibration_scenes", [])
STROKE = "stroke_sub_10"
COEFFICIENTS = config.get("friction_coefficients", [])
ESTIMATES = ["estimates"] + ["prony_estimates"] * (RAMP in CALIBRATION) + ["friction_estimates"] * bool(COEFFICIENTS)


rule calibrate:
    """Steady forces of subjects and the elastic curve -> the constant of each, how certain, and a specimen of each."""
    input:
        sources("calibrate"),
        ENVIRONMENT,
        data=sorted(glob(f"{FORCES}/*.csv")),
        histories=histories(scene for scene in CALIBRATION if scene != RAMP),
        coarse=companions(["calibration_plate"] if RAMP in CALIBRATION else []),
    output:
        csv=expand(f"{RESULTS}/calibration/{{name}}.csv", name=["fit", "identifiability", "residuals", "estimates"]),
        specimens=directory(f"{RESULTS}/specimens"),
    log:
        f"{RESULTS}/logs/calibrate.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/calibrate.py {FORCES} {output.csv[0]} {output.specimens}"
        " {input.histories} {input.coarse} > {log} 2>&1"


rule calibrate_prony:
    """The force of a ramp and hold, the elastic curves and measured time constants -> the Prony series, how certain."""
    input:
        sources("calibrate_prony"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        relaxation="config/reference/relaxation.csv",
        scene=f"config/scenes/{RAMP}.yaml",
        mesh=f"{RESULTS}/simulations/{RAMP}/mesh.msh",
        histories=histories(["calibration_plate", "calibration_instantaneous", RAMP]),
    output:
        f"{RESULTS}/calibration/prony.csv",
        f"{RESULTS}/calibration/prony_estimates.csv",
    params:
        accuracy=config.get("accuracy") or "as_stated",
    log:
        f"{RESULTS}/logs/calibrate_prony.log",
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/calibrate_prony.py {input.relaxation} {input.scene} {params.accuracy} {input.mesh}"
        " {output[0]} {input.histories} > {log} 2>&1"


rule stroke_with_friction:
    """A stroke, its coarse mesh and a coefficient of friction -> its history with that coefficient in place of the scene's."""
    input:
        sources("stroke_with_friction"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        scene=f"config/scenes/{STROKE}.yaml",
        mesh=f"{RESULTS}/coarse/{STROKE}/mesh.msh",
    output:
        ensure(f"{RESULTS}/friction/{{coefficient}}/history.nc", non_empty=True),
    params:
        accuracy=config.get("companion_accuracy"),
        coefficient=lambda wildcards: wildcards.coefficient,
    wildcard_constraints:
        coefficient=r"[0-9.]+",
    log:
        f"{RESULTS}/logs/stroke_with_friction/{{coefficient}}.log",
    cache: "omit-software"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/stroke_with_friction.py {input.scene} {params.accuracy} {params.coefficient} {input.mesh} {output}"
        " > {log} 2>&1"


rule calibrate_friction:
    """Strokes with several coefficients and the thesis's stretch of the skin -> the coefficient, how certain."""
    input:
        sources("calibrate_friction"),
        ENVIRONMENT,
        thesis="config/reference/thesis_numbers.csv",
        published="config/reference/friction.csv",
        sweep=expand(f"{RESULTS}/friction/{{coefficient}}/history.nc", coefficient=COEFFICIENTS),
        histories=histories(config.get("friction_scenes", [])),
        coarse=companions([STROKE]),
    output:
        f"{RESULTS}/calibration/friction.csv",
        f"{RESULTS}/calibration/friction_estimates.csv",
    log:
        f"{RESULTS}/logs/calibrate_friction.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/calibrate_friction.py {input.thesis} {input.published} {output[0]}"
        " {input.sweep} {input.histories} {input.coarse} > {log} 2>&1"


rule calibration_figure:
    """Data of the calibration -> a picture, and the plotted data beside it."""
    input:
        sources("calibration_figure"),
        ENVIRONMENT,
        data=f"{RESULTS}/calibration/{{name}}.csv",
    output:
        png=report(
            f"{config['studies']}/calibration_{{name}}.png",
            caption="../report/calibration.rst",
            category="Calibration",
            labels={"study": "{name}"},
        ),
        csv=f"{config['studies']}/calibration_{{name}}.csv",
    wildcard_constraints:
        name="[a-z]+",
    log:
        f"{RESULTS}/logs/calibration_figure/{{name}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/calibration_figure.py calibration_{wildcards.name} {input.data} {output.png} > {log} 2>&1"


rule calibration_table:
    """Estimates of the calibration -> one table, for programs (CSV) and for people (Markdown)."""
    input:
        sources("calibration_table"),
        ENVIRONMENT,
        estimates=expand(f"{RESULTS}/calibration/{{name}}.csv", name=ESTIMATES),
    output:
        csv=report(
            f"{config['tables']}/calibration.csv",
            caption="../report/calibration.rst",
            category="Tables",
            labels={"table": "calibration"},
        ),
        md=f"{config['tables']}/calibration.md",
    log:
        f"{RESULTS}/logs/calibration_table.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/calibration_table.py {output.csv} {input.estimates} > {log} 2>&1"
