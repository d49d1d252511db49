"""What the rules share: names of results, and the files a rule's code rests on."""

import os
import shlex
import sys
from pathlib import Path

import yaml

from fingerpad.provenance import imported_sources

RESULTS = config["results"]
ROOT = Path(workflow.basedir)
SCRIPTS = "workflow/scripts"

# Rules call the interpreter that runs Snakemake, whether or not its environment is activated.
shell.prefix(f"export PATH={shlex.quote(os.path.dirname(sys.executable))}:$PATH; ")

# The environment as it was installed by the Makefile, else as it is locked: a changed package reruns what uses it.
ENVIRONMENT = ".venv/installed.lock" if Path(".venv/installed.lock").exists() else "requirements.lock"


wildcard_constraints:
    fidelity="simulations|coarse",
    scene="[a-z0-9_]+",
    number="[0-9]+-[0-9]+",
    table="[a-z0-9_]+",


def sources(script):
    """The script, and every file of the package that it imports directly or not."""
    return [os.path.relpath(path, ROOT) for path in imported_sources(ROOT / SCRIPTS / f"{script}.py")]


def figures(chapter=""):
    """The pictures of the configuration whose number starts with `chapter`."""
    return [f"{config['figures']}/fig_{n}.png" for n in config["figure_numbers"] if n.startswith(chapter)]


def catalogue():
    """The list of the thesis's figures, of the configuration that draws them all."""
    return ["figures/README.md"] if config["name"] == "thesis" else []


def animations():
    """The moving pictures of the configuration."""
    return [f"{config['studies']}/animation_{scene}.gif" for scene in config.get("animations", [])]


def tables():
    """The tables of the configuration."""
    return [f"{config['tables']}/{name}.csv" for name in config["table_names"]]


def meanings():
    """The study of the definitions of strain energy, if the configuration has the nine surfaces."""
    nine = sum(scene.startswith("ramp40_") for scene in config["scenes"]) == 9
    return [f"{config['studies']}/strain_energy_meanings.png"] if nine else []


def calibration():
    """Figures, table and specimens of the calibration, if the configuration has its scenes; further parts if it has theirs."""
    scenes = config.get("calibration_scenes", [])
    names = ["fit", "identifiability", "residuals"] + (["prony"] if "calibration_ramp_hold" in scenes else [])
    names += ["friction"] if config.get("friction_coefficients") else []
    pictures = [f"{config['studies']}/calibration_{name}.png" for name in names]
    return [*pictures, f"{config['tables']}/calibration.csv", f"{RESULTS}/specimens"] if scenes else []


def ridge_studies():
    """Names of the figures of the study of ridges, if the configuration varies their height."""
    return ["offset", "height", "friction", "mesh", "outer"] if config.get("ridge_heights") else []


def ridges():
    """The figures of the study of ridges."""
    return [f"{config['studies']}/ridges_{name}.png" for name in ridge_studies()]


def histories(scenes, fidelity="simulations"):
    """The simulation results of some scenes."""
    return [f"{RESULTS}/{fidelity}/{scene}/history.nc" for scene in scenes]


def companions(scenes):
    """The results of the scenes' coarser companions, if the configuration has any."""
    return histories(scenes, "coarse") if config.get("companion_accuracy") else []


def meshes(scenes):
    """The meshes the scenes are simulated on."""
    return [f"{RESULTS}/simulations/{scene}/mesh.msh" for scene in scenes]


def accuracy(wildcards):
    """The accuracy that replaces what the scene states, or "as_stated"."""
    if wildcards.fidelity == "coarse":
        return config["companion_accuracy"]
    return config.get("accuracy") or "as_stated"


def scene_file(wildcards):
    return f"config/scenes/{wildcards.scene}.yaml"


def files_named_by_scene(wildcards):
    """Specimens, profile and external mesh that the scene refers to; a part left out is the thesis specimen's."""
    path = Path(scene_file(wildcards))
    if not path.exists():
        return []
    scene = yaml.safe_load(path.read_text(encoding="utf-8"))
    specimen, stimulus = scene.get("specimen") or {}, scene.get("stimulus") or {}
    parts = [specimen.get(part) for part in ("outline", "layers", "prony")]
    names = {"thesis"} | {name for name in parts if isinstance(name, str) and name != "none"}
    paths = [path.parent / name for name in (specimen.get("mesh"), stimulus.get("csv")) if name]
    return [*(f"config/specimens/{name}.yaml" for name in sorted(names)), *map(os.path.relpath, paths)]
