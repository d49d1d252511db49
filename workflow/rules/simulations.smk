"""Scene -> plan -> mesh -> simulation.

Inputs:  config/scenes/<scene>.yaml and the files it names.
Outputs: <results>/<fidelity>/<scene>/{plan.json,mesh.msh,history.nc}, where fidelity is "simulations" for the
         scene as configured and "coarse" for its companion, from which discretisation errors are estimated.
"""


rule mesh:
    """A scene -> its plan (effects, discretisation, cost, and why) and the mesh of the pad that the plan asks for."""
    input:
        sources("mesh"),
        ENVIRONMENT,
        scene=scene_file,
        named=files_named_by_scene,
    output:
        plan=f"{RESULTS}/{{fidelity}}/{{scene}}/plan.json",
        mesh=f"{RESULTS}/{{fidelity}}/{{scene}}/mesh.msh",
    params:
        accuracy=accuracy,
    log:
        f"{RESULTS}/logs/mesh/{{fidelity}}/{{scene}}.log",
    threads: 1
    resources:
        mem_mb=1000,
        runtime=5,
    shell:
        "python workflow/scripts/mesh.py {input.scene} {params.accuracy} {output.plan} {output.mesh} > {log} 2>&1"


rule simulate:
    """A scene and its mesh -> the history of the whole motion, one cached NetCDF file."""
    input:
        sources("simulate"),
        ENVIRONMENT,
        scene=scene_file,
        named=files_named_by_scene,
        mesh=rules.mesh.output.mesh,
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
