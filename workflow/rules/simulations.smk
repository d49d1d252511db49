"""Scene -> plan -> mesh -> simulation.

Inputs:  config/scenes/<scene>.yaml and the files it names.
Outputs: <results>/<fidelity>/<scene>/{plan.json,mesh.msh,history.nc}, where fidelity is "simulations" for the
         scene as configured and "coarse" for its companion, from which discretisation errors are estimated.
"""


rule plan:
    """A scene file -> which effects are on and why, on what discretisation, at what predicted cost."""
    input:
        sources("plan"),
        scene=scene_file,
        named=files_named_by_scene,
    output:
        f"{RESULTS}/{{fidelity}}/{{scene}}/plan.json",
    params:
        accuracy=accuracy,
    log:
        f"{RESULTS}/logs/plan/{{fidelity}}/{{scene}}.log",
    threads: 1
    resources:
        mem_mb=500,
        runtime=2,
    shell:
        "python workflow/scripts/plan.py {input.scene} {params.accuracy} {output} > {log} 2>&1"


rule mesh:
    """A scene -> the mesh of the pad that its plan asks for, with named layers and boundaries.

    The plan is made anew from the scene, in milliseconds; the file is an input so that it is there to be read.
    """
    input:
        sources("mesh"),
        ENVIRONMENT,
        scene=scene_file,
        named=files_named_by_scene,
        plan=rules.plan.output,
    output:
        f"{RESULTS}/{{fidelity}}/{{scene}}/mesh.msh",
    params:
        accuracy=accuracy,
    log:
        f"{RESULTS}/logs/mesh/{{fidelity}}/{{scene}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/mesh.py {input.scene} {params.accuracy} {output} > {log} 2>&1"


rule simulate:
    """A scene and its mesh -> the history of the whole motion, one cached NetCDF file."""
    input:
        sources("simulate"),
        ENVIRONMENT,
        scene=scene_file,
        named=files_named_by_scene,
        mesh=rules.mesh.output,
    output:
        ensure(f"{RESULTS}/{{fidelity}}/{{scene}}/history.nc", non_empty=True),
    params:
        accuracy=accuracy,
        # Part of the cache's key, so that two scenes with equal contents keep their own names.
        name=lambda wildcards: wildcards.scene,
    log:
        f"{RESULTS}/logs/simulate/{{fidelity}}/{{scene}}.log",
    cache: "omit-software"
    threads: 1
    resources:
        mem_mb=2000,
        runtime=30,
    shell:
        "python workflow/scripts/simulate.py {input.scene} {params.accuracy} {input.mesh} {output} > {log} 2>&1"
