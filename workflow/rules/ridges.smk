"""Strokes of a plate over ridged pads -> what ridges make of the direction of a stroke, against place, height, friction, mesh.

Inputs:  config/scenes/ridged_stroke_right.yaml with the heights of `ridge_heights` and the coefficients of `ridge_frictions`, and
         the strokes of whole scenes.
Outputs: <results>/ridges/<height>_<friction>_<mesh>/history.nc, <results>/ridges/*.csv, and from these
         <studies>/ridges_*.png beside their data.
"""

RIDGE_STROKE = "ridged_stroke_right"
OUTER_STROKES = ["ridged_outer_stroke_right", "ridged_outer_stroke_left"]


def ridge_cases():
    """Histories of the study's cases: heights (um) at the scene's friction, frictions at its height, meshes at both."""
    height, friction = 150, 0.65
    cases = {(h, friction): ["thesis", "coarse"] for h in config.get("ridge_heights", [])}
    cases |= {(height, mu): ["thesis", "coarse"] for mu in config.get("ridge_frictions", [])}
    if (height, friction) in cases:
        cases[height, friction] += ["fine", "curved", "straight", "shifted"]
    return [f"{RESULTS}/ridges/{h:g}_{mu:g}_{mesh}/history.nc" for (h, mu), meshes in cases.items() for mesh in meshes]


rule ridge_case:
    """A stroke with another height of the ridges or coefficient of friction -> its histories on two meshes, one after the other."""
    input:
        sources("ridge_case"),
        ENVIRONMENT,
        "config/specimens/thesis.yaml",
        scene=f"config/scenes/{RIDGE_STROKE}.yaml",
    output:
        ensure(expand(f"{RESULTS}/ridges/{{{{case}}}}_{{mesh}}/history.nc", mesh=["thesis", "coarse"]), non_empty=True),
    wildcard_constraints:
        case="[0-9.]+_[0-9.]+",
    log:
        f"{RESULTS}/logs/ridge_case/{{case}}.log",
    # The longest first, so that no core waits for it at the end.
    priority: 1
    threads: 1
    resources:
        mem_mb=2000,
        runtime=10,
    shell:
        "python workflow/scripts/ridge_case.py {input.scene} {output} > {log} 2>&1"


use rule ridge_case as ridge_case_fine with:
    output:
        ensure(f"{RESULTS}/ridges/{{case}}_fine/history.nc", non_empty=True),
    log:
        f"{RESULTS}/logs/ridge_case/{{case}}_fine.log",


use rule ridge_case as ridge_case_drawn with:
    output:
        ensure(expand(f"{RESULTS}/ridges/{{{{case}}}}_{{mesh}}/history.nc", mesh=["curved", "straight", "shifted"]), non_empty=True),
    log:
        f"{RESULTS}/logs/ridge_case/{{case}}_drawn.log",


rule ridge_data:
    """Cases and whole strokes -> the directional index against place, height, friction and mesh, and contact in islands."""
    input:
        sources("ridge_data"),
        ENVIRONMENT,
        cases=ridge_cases(),
        histories=histories(OUTER_STROKES),
        coarse=companions(OUTER_STROKES[:1]),
    output:
        expand(f"{RESULTS}/ridges/{{name}}.csv", name=ridge_studies()),
    log:
        f"{RESULTS}/logs/ridge_data.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/ridge_data.py {output[0]} {input.cases} {input.histories} {input.coarse} > {log} 2>&1"


rule ridge_figures:
    """Data of the study -> its pictures, and the plotted data beside each."""
    input:
        sources("ridge_figures"),
        ENVIRONMENT,
        data=rules.ridge_data.output,
    output:
        png=report(
            expand(f"{config['studies']}/ridges_{{name}}.png", name=ridge_studies()),
            caption="../report/ridges.rst",
            category="Ridges",
        ),
        csv=expand(f"{config['studies']}/ridges_{{name}}.csv", name=ridge_studies()),
    log:
        f"{RESULTS}/logs/ridge_figures.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/ridge_figures.py {output.png[0]} {input.data} > {log} 2>&1"
