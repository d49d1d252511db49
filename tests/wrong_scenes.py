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
OUTLINE = {
    "apex_height": "6 mm",
    "apex_radius": "7.9 mm",
    "half_width": "8.5 mm",
    "depth_below": "6.2 mm",
    "epidermis_thickness": "0.85 mm",
    "dermis_thickness": "0.85 mm",
    "stratum_corneum_thickness": "0.35 mm",
    "bone_centre_height": "-1.5 mm",
    "bone_half_width": "4 mm",
    "bone_half_height": "2.5 mm",
    "nail_half_width": "5 mm",
}


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


def motion(*legs):
    return changed(motion=list(legs))


def wavy(legs=(), **keys):
    return changed(stimulus={"shape": "wavy", **keys}, **({"motion": list(legs)} if legs else {}))


def receptors(**keys):
    return changed(outputs={"receptors": keys})


FORCE = {"press_to_force": "20 gf", "rate": "40 gf/s"}
DEPTH = {"press_to_depth": "1 mm", "speed": "2 mm/s"}

# name: document, key the message names, words it contains
BAD = {
    "lift before a press": (
        motion({"lift": "steady"}, FORCE),
        "motion[0].lift",
        "before anything is pressed",
    ),
    "lift twice": (
        motion(FORCE, {"lift": "steady"}, {"lift": "1 mm/s"}),
        "motion[2].lift",
        "nothing is pressed any more",
    ),
    "slide after a lift": (
        motion(FORCE, {"lift": "1 mm/s"}, {"hold": "1 s"}, {"slide": "1 mm"}),
        "motion[3].slide",
        "nothing is pressed any more",
    ),
    "lift without a unit": (motion(FORCE, {"lift": "slow"}), "motion[1].lift", "steady"),
    "unknown kind of receptor": (
        changed(outputs={"responses": ["rapid_adapting"]}),
        "outputs.responses[0]",
        "rapidly_adapting",
    ),
    "no outputs": (
        changed(outputs={"per_leg": 0}),
        "outputs.per_leg",
        "a whole number from 1 to 1000",
    ),
    "responses of a steady scene": (
        changed(motion=[{"press_to_force": "20 gf"}], outputs={"responses": True}),
        "outputs.responses",
        "takes time",
    ),
    "unknown key": (changed(moton=[]), "moton", "the nearest is 'motion'"),
    "unknown key in a leg": (
        motion({**FORCE, "rat": "1 N/s"}),
        "motion[0].rat",
        "the nearest is 'rate'",
    ),
    "unknown key in specimen": (
        specimen(outlin="thesis"),
        "specimen.outlin",
        "the nearest is 'outline'",
    ),
    "unknown key in a layer": (
        specimen(layers={"fat": {"youngs_moduls": "1 MPa"}}),
        "specimen.layers.fat.youngs_moduls",
        "the nearest is 'youngs_modulus'",
    ),
    "thickness of a layer": (
        specimen(layers={"fat": {"thickness": "1 mm"}}),
        "specimen.layers.fat.thickness",
        "epidermis_thickness",
    ),
    "unknown law": (
        specimen(layers={"fat": {"law": "neohooke"}}),
        "specimen.layers.fat.law",
        "neo_hooke, yeoh",
    ),
    "unknown law in a mapping": (
        specimen(layers={"fat": {"law": {"name": "ogden"}}}),
        "specimen.layers.fat.law.name",
        "neo_hooke, yeoh",
    ),
    "constant of another law": (
        specimen(layers={"fat": {"law": {"name": "neo_hooke", "second": 1}}}),
        "specimen.layers.fat.law.second",
        "none",
    ),
    "constant of a law outside its range": (
        specimen(layers={"fat": {"law": {"name": "yeoh", "second": -1}}}),
        "specimen.layers.fat.law.second",
        "-1 is outside the range",
    ),
    "unknown key in a stimulus": (
        changed(stimulus={"shape": "flat", "curvature": "1 1/m"}),
        "stimulus.curvature",
        "is not a known key; allowed: the key shape",
    ),
    "radius and curvature": (
        changed(stimulus={"shape": "cylinder", "curvature": "210 1/m", "radius": "2 mm"}),
        "stimulus.radius",
        "is given beside curvature; allowed: one of curvature, radius and diameter",
    ),
    "radius of nothing": (
        changed(stimulus={"shape": "cylinder", "radius": "0 mm"}),
        "stimulus.radius",
        "'0 mm' is zero",
    ),
    "diameter without a unit": (
        changed(stimulus={"shape": "cylinder", "diameter": 2}),
        "stimulus.diameter",
        "has no unit",
    ),
    "bar without a width": (
        changed(stimulus={"shape": "bar"}),
        "stimulus.width",
        "allowed: Width of the face, such as '",
    ),
    "depth that is no list": (
        changed(outputs={"receptors": {"depths": "600 um"}}),
        "outputs.receptors.depths",
        'is not a list; allowed: a list, in square brackets: ["600 um"]',
    ),
    "name is the file's": (changed(name="x"), "name", "is not a known key"),
    "steps that are a switch": (
        changed(accuracy={"steps": True}),
        "accuracy.steps",
        "a whole number",
    ),
    "key that is not text": (changed(**{"accuracy": {5: 1}}), "accuracy.5", "is not a known key"),
    "no stimulus": ({"motion": [FORCE]}, "stimulus", "is missing"),
    "no motion": ({"stimulus": {"shape": "flat"}}, "motion", "is missing"),
    "empty key": (changed(specimen=None), "specimen", "is empty"),
    "empty file": ("", "", "is not a mapping"),
    "a list": ("- 1", "", "is not a mapping"),
    "missing unit": (
        motion({"press_to_force": "20 gf", "rate": "40"}),
        "motion[0].rate",
        "'40' has no unit",
    ),
    "bare number": (motion({"press_to_force": 20}), "motion[0].press_to_force", "20 has no unit"),
    "wrong dimension": (
        motion({"press_to_force": "20 gf", "rate": "40 gf"}),
        "motion[0].rate",
        "'40 gf' has the wrong dimension: it is a force; "
        "allowed: a force rate with its unit such as",
    ),
    "mass for force": (
        motion({"press_to_force": "20 g"}),
        "motion[0].press_to_force",
        "wrong dimension",
    ),
    "unknown unit": (motion({"hold": "2 sex"}), "motion[0].hold", "unknown unit 'sex'"),
    "not finite": (motion({"press_to_force": "nan gf"}), "motion[0].press_to_force", "finite"),
    "negative thickness": (
        specimen(outline={"dermis_thickness": "-0.85 mm"}),
        "specimen.outline.dermis_thickness",
        "is negative",
    ),
    "layers thicker than the pad": (
        specimen(outline={"epidermis_thickness": "4.5 mm"}),
        "specimen.outline.epidermis_thickness",
        "'4.5 mm' makes the layers thicker than the pad",
    ),
    "no fat beside the bone": (
        specimen(outline={"bone_half_width": "7 mm"}),
        "specimen.outline.bone_half_width",
        "less than 6.8 mm",
    ),
    "bone above the skin": (
        specimen(outline={"bone_centre_height": "5 mm"}),
        "specimen.outline.bone_centre_height",
        "outside the skin",
    ),
    "bone below the pad": (
        specimen(outline={"bone_half_height": "4.8 mm", "bone_centre_height": "-2 mm"}),
        "specimen.outline.bone_half_height",
        "outside the section",
    ),
    "stratum corneum too thick": (
        specimen(outline={"stratum_corneum_thickness": "1 mm"}, layers={"stratum_corneum": {}}),
        "specimen.outline.stratum_corneum_thickness",
        "up to 0.85 mm",
    ),
    "nail too wide": (
        specimen(outline={"nail_half_width": "9 mm"}),
        "specimen.outline.nail_half_width",
        "8.5 mm",
    ),
    "Poisson's ratio of a half": (
        specimen(layers={"fat": {"poisson_ratio": 0.5}}),
        "specimen.layers.fat.poisson_ratio",
        "0.5 is outside the range; allowed: a number above -1 and below 0.5",
    ),
    "Poisson's ratio of minus one": (
        specimen(layers={"fat": {"poisson_ratio": -1}}),
        "specimen.layers.fat.poisson_ratio",
        "above -1",
    ),
    "negative modulus": (
        specimen(layers={"dermis": {"youngs_modulus": "-1 kPa"}}),
        "specimen.layers.dermis.youngs_modulus",
        "is negative",
    ),
    "Prony sum of one": (
        specimen(prony=[{"g": 0.5, "tau": "1 s"}, {"g": 0.5, "tau": "2 s"}]),
        "specimen.prony",
        "sum to 1; allowed: a sum of g below 1",
    ),
    "Prony term of one": (
        specimen(prony=[{"g": 1, "tau": "1 s"}]),
        "specimen.prony[0].g",
        "below 1",
    ),
    "negative g": (specimen(prony=[{"g": -0.1, "tau": "1 s"}]), "specimen.prony[0].g", "above 0"),
    "negative tau": (
        specimen(prony=[{"g": 0.1, "tau": "-1 s"}]),
        "specimen.prony[0].tau",
        "is negative",
    ),
    "zero tau": (specimen(prony=[{"g": 0.1, "tau": "0 s"}]), "specimen.prony[0].tau", "is zero"),
    "no tau": (specimen(prony=[{"g": 0.1}]), "specimen.prony[0].tau", "is missing"),
    "no list of Prony terms": (specimen(prony={}), "specimen.prony", "is not a list"),
    "specimen of no file": (
        specimen(layers="thesi"),
        "specimen.layers",
        "homogeneous, long_term, thesis",
    ),
    "path for a name": (
        specimen(outline="../thesis"),
        "specimen.outline",
        "is not the name of a specimen",
    ),
    "file without the part": (
        specimen(outline="homogeneous"),
        "specimen.outline",
        "without outline",
    ),
    "moduli in no known state": (
        specimen(moduli="short"),
        "specimen.moduli",
        "'long_term' or 'instantaneous'",
    ),
    "ridges": (
        specimen(ridges="outer"),
        "specimen.ridges",
        "is not the kind of ridges; allowed: none, inner, inner_and_outer",
    ),
    "ridges that are valleys": (
        specimen(ridges={"inner": {"height": "-0.1 mm"}}),
        "specimen.ridges.inner.height",
        "is negative, which would turn ridges into valleys",
    ),
    "ridges through the dermis": (
        specimen(ridges={"inner": {"height": "0.6 mm"}}),
        "specimen.ridges.inner.height",
        "is too high for the layers; allowed: less than 0.595 mm",
    ),
    "ridges through the epidermis below the stratum corneum": (
        specimen(ridges={"inner": {"height": "0.4 mm"}}, layers={"stratum_corneum": {}}),
        "specimen.ridges.inner.height",
        "allowed: less than 0.35 mm",
    ),
    "ridge tip beyond the nearest": (
        specimen(ridges={"inner": {"phase": "0.3 mm"}}),
        "specimen.ridges.inner.phase",
        "up to half a pitch, 0.24 mm",
    ),
    "unknown place of a ridge": (
        specimen(ridges={"inner": {"phase": "crest"}}),
        "specimen.ridges.inner.phase",
        "allowed: tip or valley or a length",
    ),
    "limiting ridges as high as the primary ones": (
        specimen(ridges={"inner": {"limiting": 1}}),
        "specimen.ridges.inner.limiting",
        "from 0 to below 1",
    ),
    "ridges wider than the pad": (
        specimen(ridges={"half_width": "9 mm"}),
        "specimen.ridges.half_width",
        "half of the section",
    ),
    "negative contact length": (
        specimen(contact_length="-10 mm"),
        "specimen.contact_length",
        "is negative",
    ),
    "mesh file missing": (
        specimen(mesh="no.msh"),
        "specimen.mesh",
        "'no.msh' is not an existing file",
    ),
    "mesh that is no path": (specimen(mesh=3), "specimen.mesh", "is not a path"),
    "mesh beside an outline": (
        specimen(mesh="no.msh", outline="thesis"),
        "specimen.mesh",
        "one of outline and mesh",
    ),
    "cylinder with zero curvature": (
        changed(stimulus={"shape": "cylinder", "curvature": "0 1/m"}),
        "stimulus.curvature",
        "is zero: for a curvature of zero use shape: flat",
    ),
    "negative curvature": (
        changed(stimulus={"shape": "cylinder", "curvature": "-1 1/m"}),
        "stimulus.curvature",
        "is negative",
    ),
    "no curvature": (changed(stimulus={"shape": "cylinder"}), "stimulus.curvature", "is missing"),
    "unknown shape": (
        changed(stimulus={"shape": "cilinder"}),
        "stimulus.shape",
        "the nearest is 'cylinder'",
    ),
    "shape that is no text": (
        changed(stimulus={"shape": [1]}),
        "stimulus.shape",
        "is not a known shape",
    ),
    "no shape": (changed(stimulus={"curvature": "1 1/m"}), "stimulus.shape", "is missing"),
    "no curvatures": (wavy(curvatures=[]), "stimulus.curvatures", "is empty"),
    "one curvature for many": (wavy(curvatures="26 1/m"), "stimulus.curvatures", "is not a list"),
    "flat convexity": (wavy(curvatures=["26 1/m", "0 1/m"]), "stimulus.curvatures[1]", "is zero"),
    "arcs of a right angle": (
        wavy(half_angle="45 deg"),
        "stimulus.half_angle",
        "'45 deg' is outside the range",
    ),
    "arcs of no angle": (wavy(half_angle="0 rad"), "stimulus.half_angle", "is zero"),
    "arcs that turn back": (wavy(half_angle="-9 deg"), "stimulus.half_angle", "is negative"),
    "angle without a unit": (wavy(half_angle="9"), "stimulus.half_angle", "has no unit"),
    "per cent for an angle": (
        wavy(half_angle="9 %"),
        "stimulus.half_angle",
        "it is a number; allowed: an angle with",
    ),
    "fillet longer than the lead-in": (
        wavy(fillet="40 mm", lead_in="2 mm"),
        "stimulus.fillet",
        "does not fit the flat beside it; allowed: 0 mm to below 29.6761 mm",
    ),
    "fillet longer than the run-out": (
        wavy(fillet="100 mm", run_out="2 mm"),
        "stimulus.fillet",
        "does not fit the flat",
    ),
    "no lead-in": (wavy(lead_in="0 mm"), "stimulus.lead_in", "is zero"),
    "stimulus that is a word": (changed(stimulus="flat"), "stimulus", "is not a mapping"),
    "fillet wider than the bar": (
        changed(stimulus={"shape": "bar", "width": "1 mm", "fillet": "0.6 mm"}),
        "stimulus.fillet",
        "0 mm to 0.5 mm",
    ),
    "negative fillet": (
        changed(stimulus={"shape": "bar", "width": "1 mm", "fillet": "-1 um"}),
        "stimulus.fillet",
        "is negative",
    ),
    "profile missing": (
        changed(stimulus={"shape": "sampled", "csv": "no.csv"}),
        "stimulus.csv",
        "not an existing",
    ),
    "negative friction": (changed(friction=-0.1), "friction", "zero or more"),
    "friction with a unit": (changed(friction="1 N"), "friction", "wrong dimension"),
    "friction not finite": (changed(friction=float("nan")), "friction", "is not finite"),
    "empty motion": (motion(), "motion", "is empty; allowed: legs such as"),
    "motion that is no list": (changed(motion=FORCE), "motion", "is not a list"),
    "negative force": (
        motion({"press_to_force": "-20 gf"}),
        "motion[0].press_to_force",
        "must press into the skin",
    ),
    "zero force": (motion({"press_to_force": "0 gf"}), "motion[0].press_to_force", "is zero"),
    "negative rate": (
        motion({**FORCE, "rate": "-40 gf/s"}),
        "motion[0].rate",
        "must press into the skin",
    ),
    "negative depth": (
        motion({"press_to_depth": "-1 mm"}),
        "motion[0].press_to_depth",
        "must press into",
    ),
    "negative speed": (
        motion({**DEPTH, "speed": "-1 mm/s"}),
        "motion[0].speed",
        "must press into the skin",
    ),
    "speed for rate": (
        motion({"press_to_force": "1 N", "speed": "1 mm/s"}),
        "motion[0].speed",
        "not a known key",
    ),
    "depth to the bone": (
        motion({"press_to_depth": "5 mm"}),
        "motion[0].press_to_depth",
        "below the 5 mm",
    ),
    "hold first": (motion({"hold": "1 s"}, FORCE), "motion[0].hold", "before anything is pressed"),
    "negative hold": (motion(FORCE, {"hold": "-1 s"}), "motion[1].hold", "is negative"),
    "leg that goes nowhere": (
        motion(FORCE, {"hold": "1 s"}, FORCE),
        "motion[2].press_to_force",
        "where the leg",
    ),
    "slide first": (
        motion({"slide": "80 mm"}, FORCE),
        "motion[0].slide",
        "before anything is pressed",
    ),
    "slide to nowhere": (
        motion(FORCE, {"slide": "0 mm"}),
        "motion[1].slide",
        "is zero; allowed: a length other than zero",
    ),
    "slide without a unit": (motion(FORCE, {"slide": 80}), "motion[1].slide", "has no unit"),
    "slide at no speed": (
        motion(FORCE, {"slide": "1 mm", "speed": "0 mm/s"}),
        "motion[1].speed",
        "is zero",
    ),
    "slide back by its speed": (
        motion(FORCE, {"slide": "1 mm", "speed": "-1 mm/s"}),
        "motion[1].speed",
        "is negative: the sign of slide is its direction",
    ),
    "slide that keeps nothing known": (
        motion(FORCE, {"slide": "1 mm", "keep": "pressure"}),
        "motion[1].keep",
        "'pressure' is not one of the choices; allowed: 'force' or 'depth'",
    ),
    "slide beyond the surface": (
        wavy([FORCE, {"slide": "70 mm"}, {"slide": "10.6 mm"}]),
        "motion[2].slide",
        "'10.6 mm' leads off the surface; allowed: to stay from 0 mm to 80.5816 mm along it",
    ),
    "slide before the surface": (
        wavy([FORCE, {"slide": "-1 mm"}]),
        "motion[1].slide",
        "leads off the surface",
    ),
    "slide round the world": (
        motion(FORCE, {"slide": "40000 km"}),
        "motion[1].slide",
        "is too long a way; allowed: up to 10 m",
    ),
    "step first": (
        motion({"step": "8 mm", "every": "1 mm"}),
        "motion[0].step",
        "before anything is pressed",
    ),
    "step to nowhere": (
        motion(FORCE, {"step": "0 mm", "every": "1 mm"}),
        "motion[1].step",
        "is zero",
    ),
    "step without every": (motion(FORCE, {"step": "8 mm"}), "motion[1].every", "is missing"),
    "step at a speed": (
        motion(FORCE, {"step": "8 mm", "every": "1 mm", "speed": "1 mm/s"}),
        "motion[1].speed",
        "not a known key",
    ),
    "step backwards by every": (
        motion(FORCE, {"step": "8 mm", "every": "-1 mm"}),
        "motion[1].every",
        "is negative",
    ),
    "step smaller than every": (
        motion(FORCE, {"step": "1 mm", "every": "2 mm"}),
        "motion[1].every",
        "'2 mm' is more than the whole distance; allowed: up to 1 mm",
    ),
    "step of no whole number": (
        motion(FORCE, {"step": "-5 mm", "every": "2 mm"}),
        "motion[1].every",
        "'2 mm' does not divide the whole distance; allowed: a whole fraction of 5 mm",
    ),
    "step of too many": (
        motion(FORCE, {"step": "1 m", "every": "1 um"}),
        "motion[1].every",
        "more than 100000 indentations",
    ),
    "step beyond the surface": (
        wavy([FORCE, {"step": "90 mm", "every": "1 mm"}]),
        "motion[1].step",
        "leads off the surface",
    ),
    "unknown leg": (
        motion({"pres_to_force": "1 N"}),
        "motion[0]",
        "the nearest is 'press_to_force'",
    ),
    "leg of two kinds": (motion({**FORCE, "hold": "1 s"}), "motion[0]", "two legs in one"),
    "leg that is a word": (motion("hold"), "motion[0]", "is not a leg"),
    "receptor below the bone": (
        receptors(depths=["1 mm", "5 mm"]),
        "outputs.receptors.depths[1]",
        "outside the skin",
    ),
    "receptor above the skin": (
        receptors(depths=["-1 um"]),
        "outputs.receptors.depths[0]",
        "is negative",
    ),
    "receptor on the skin": (receptors(depths=["0 um"]), "outputs.receptors.depths[0]", "is zero"),
    "receptor beside the pad": (
        receptors(offsets=["9 mm"]),
        "outputs.receptors.offsets[0]",
        "within 8.5 mm",
    ),
    "depths that are no list": (
        receptors(depths="1 mm"),
        "outputs.receptors.depths",
        "is not a list",
    ),
    "snapshot after the end": (
        changed(outputs={"snapshots": ["2.6 s"]}),
        "outputs.snapshots[0]",
        "up to 2.5 s",
    ),
    "snapshots after the end": (
        changed(outputs={"snapshots": {"every": "3 s"}}),
        "outputs.snapshots.every",
        "up to 2.5 s",
    ),
    "snapshots of no interval": (
        changed(outputs={"snapshots": {"every": "0 s"}}),
        "outputs.snapshots.every",
        "is zero",
    ),
    "snapshots without number": (
        changed(outputs={"snapshots": {"every": "1 ms"}}),
        "outputs.snapshots.every",
        "makes more than 1000 snapshots; allowed: 0.0025 s or more",
    ),
    "snapshots of a motion with an open end": (
        {**motion(FORCE, DEPTH), "outputs": {"snapshots": {"every": "1 s"}}},
        "outputs.snapshots.every",
        "needs a motion whose end is known",
    ),
    "snapshots that are a word": (
        changed(outputs={"snapshots": "all"}),
        "outputs.snapshots",
        "is not a list",
    ),
    "snapshots from somewhere": (
        changed(outputs={"snapshots": {"every": "1 s", "from": "1 s"}}),
        "outputs.snapshots.from",
        "is not a known key",
    ),
    "negative snapshot": (
        changed(outputs={"snapshots": ["-1 s"]}),
        "outputs.snapshots[0]",
        "is negative",
    ),
    "tolerance of zero": (
        changed(accuracy=0),
        "accuracy",
        "0 is outside the range; allowed: a tolerance above 0",
    ),
    "negative tolerance": (
        changed(accuracy="-0.02"),
        "accuracy",
        "a tolerance above 0 and below 1",
    ),
    "tolerance of one": (changed(accuracy=1.0), "accuracy", "below 1"),
    "unknown accuracy": (changed(accuracy="best"), "accuracy", "draft, thesis, fine"),
    "switch for accuracy": (changed(accuracy=True), "accuracy", "draft, thesis, fine"),
    "unknown element": (
        changed(accuracy={"element": "Q3"}),
        "accuracy.element",
        "'Q1P0', 'Q2P1' or 'P2B'",
    ),
    "no steps": (
        changed(accuracy={"steps": 0}),
        "accuracy.steps",
        "a whole number from 1 to 100000",
    ),
    "edge larger than the pad": (
        changed(accuracy={"skin_edge": "9 mm"}),
        "accuracy.skin_edge",
        "below 8.5 mm",
    ),
    "unknown effect": (
        changed(effects={"fricton": True}),
        "effects.fricton",
        "the nearest is 'friction'",
    ),
    "effect that is no switch": (changed(effects={"friction": 1}), "effects.friction", "on or off"),
    "effects that are a switch": (changed(effects=True), "effects", "auto, or on or off"),
    "no YAML": ("stimulus: {", "", "is not valid YAML at line"),
    "no text": ("stimulus: \x00", "", "is not valid YAML"),
    "duplicate key": ("friction: 0\nfriction: 1", "", "'friction' is given twice"),
    "object in YAML": ("!!python/object/apply:os.getcwd []", "", "is not valid YAML"),
    "nested without end": ("[" * 5000, "", "is not valid YAML"),
    "endless integer": (f"friction: {'9' * 5000}", "", "is not valid YAML"),
    "huge integer": (
        f"stimulus: {{shape: flat}}\nmotion: [{{hold: 1 s}}]\nfriction: 0x{'f' * 5000}",
        "friction",
        "is not finite",
    ),
    "text of many lines": (changed(accuracy="a\nb\u2028c"), "accuracy", "is not a known accuracy"),
}
