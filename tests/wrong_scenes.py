"""Scenes that must be refused, for the tests of the scene and of the command line."""

import copy
from pathlib import Path

import yaml

CONFIG = Path(__file__).parents[1] / "config"

RAMP_AND_HOLD = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}],
}


# a pad of known sizes, so that these tests do not hang on what the thesis's specimen is found to be
OUTLINE = yaml.safe_load("""
    apex_height: 6 mm
    apex_radius: 7.9 mm
    half_width: 8.5 mm
    depth_below: 6.2 mm
    epidermis_thickness: 0.85 mm
    dermis_thickness: 0.85 mm
    stratum_corneum_thickness: 0.35 mm
    bone_centre_height: -1.5 mm
    bone_half_width: 4 mm
    bone_half_height: 2.5 mm
    nail_half_width: 5 mm
""")


def write(folder, document, name="my_scene.yaml"):
    path = folder / name
    path.write_text(
        document if isinstance(document, str) else yaml.safe_dump(document), encoding="utf-8"
    )
    return path


def pad_folder(folder):
    """Give `folder` specimens of its own: the thesis's on a pad of known sizes, and the homogeneous
    one.
    """
    specimens = folder / "config" / "specimens"
    specimens.mkdir(parents=True)
    thesis = yaml.safe_load((CONFIG / "specimens/thesis.yaml").read_text())
    write(specimens, {**thesis, "outline": OUTLINE}, "thesis.yaml")
    write(specimens, (CONFIG / "specimens/homogeneous.yaml").read_text(), "homogeneous.yaml")
    return folder


def changed(**changes):
    return {**copy.deepcopy(RAMP_AND_HOLD), **changes}


def specimen(**parts):
    return changed(specimen=parts)


def wavy(legs=(), **keys):
    return changed(stimulus={"shape": "wavy", **keys}, **({"motion": list(legs)} if legs else {}))


FORCE = {"press_to_force": "20 gf", "rate": "40 gf/s"}

BAD = {
    name: (change["whole"] if "whole" in change else changed(**change), key, words)
    for name, (change, key, words) in yaml.safe_load(
        Path(__file__).with_suffix(".yaml").read_text()
    ).items()
} | {
    "nested without end": ("[" * 5000, "", "is not valid YAML"),
    "endless integer": (f"friction: {'9' * 5000}", "", "is not valid YAML"),
    "huge integer": (
        f"stimulus: {{shape: flat}}\nmotion: [{{hold: 1 s}}]\nfriction: 0x{'f' * 5000}",
        "friction",
        "is not finite",
    ),
}
"""Name -> document, key that the message names, words that it contains."""
