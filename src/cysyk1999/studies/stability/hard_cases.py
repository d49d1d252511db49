"""Hard cases picked by hand: what makes each hard, and what counts as stable.

A case is a scene in the words of a scene document, solved on a draft mesh. The same limits hold for
all (:class:`Limits`); a case that needs another one says so where it stands.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cysyk1999.studies.accuracy.meshes import corners_only, distorted, triangles
from fingerpad.scenes.scene import Scene
from fingerpad.scenes.specimen import Source
from fingerpad.specimen.pad import PadMesh

if TYPE_CHECKING:
    from fingerpad.planning.plan import Plan

Points = tuple[Sequence[float], Sequence[float]]
"""x and y of a sampled stimulus, mm."""
SCENES = Path(__file__).resolve().parents[4] / "config" / "scenes"


def limit(value: float, text: str) -> Any:
    return field(default=value, metadata={"text": text})


@dataclass(frozen=True)
class Limits:
    """The worst that a stable run may measure (see :mod:`cysyk1999.studies.stability.invariants`).

    The other solver's is that of a run that is factored in single precision: it ends where less
    than its tolerance is left.
    """

    cuts: float = limit(0, "at most {:g} cuts")
    factorisations: float = limit(4, "at most {:g} factorisations a step")
    energy: float = limit(0.03, "energy balanced within {:.0%}")
    complementarity: float = limit(1e-3, "complementarity within {:g}")
    det_f: float = limit(0.1, "det F above {:g}")
    checkerboard: float = limit(0.05, "checkerboard index up to {:g}")
    halving: float = limit(0.05, "half the step changes it by up to {:.0%}")
    balance: float = limit(1e-3, "forces balanced within {:g}")
    symmetry: float = limit(1e-3, "its own mirror image within {:g}")
    effort: float = limit(4, "up to {:g} times its easy neighbour's iterations")
    solver: float = limit(1e-3, "the other solver within {:g}")
    reference: float = limit(
        1, "off a converged reference by up to {:g} times what it believes, or a draft may be"
    )

    def described(self) -> str:
        """Where these limits differ from those of all cases; "as all" where they do not."""
        own = [
            f.metadata["text"].format(getattr(self, f.name))
            for f in fields(self)
            if getattr(self, f.name) != f.default
        ]
        return (
            "; ".join(text.replace("inf", "any").replace("nan", "any") for text in own) or "as all"
        )


@dataclass(frozen=True)
class Case:
    """One hard case.

    Attributes:
        name, group: of the case, and of cases alike. hard: what makes it hard. scene: keys of a
        scene document. limits: what
            counts as stable. steps: a leg, at first (10, or four if all is steady); half the step
            is tried too. mesh: makes an external mesh, whose file the scene then names, of the
            scene without one and its plan. may_fail: it is beyond the method; a clean failure or an
            estimated error of at least a half is all that is asked for. points: of a sampled
            stimulus, mm, whose file the scene then names.
    """

    name: str
    group: str
    hard: str
    scene: dict[str, Any]
    limits: Limits = Limits()
    steps: int | None = None
    mesh: Callable[[Scene, Plan], PadMesh] | None = None
    may_fail: bool = False
    points: Points | None = None

    @property
    def stable(self) -> str:
        """What counts as stable, in words."""
        return (
            "a clean failure, or an estimated error of a half"
            if self.may_fail
            else self.limits.described()
        )

    @property
    def steps_per_leg(self) -> int:
        """Steps of a leg, at first."""
        timed = any({"rate", "speed", "hold"} & set(leg) for leg in self.scene["motion"])
        return self.steps or (10 if timed else 4)

    @property
    def strokes(self) -> bool:
        """Whether the skin is stroked."""
        return any("slide" in leg for leg in self.scene["motion"])

    @property
    def document(self) -> dict[str, Any]:
        """The scene document: on a draft mesh and with finite strain unless it says otherwise."""
        return {"accuracy": "draft", "effects": {"finite_strain": "on"}} | self.scene

    @property
    def neighbour(self) -> Case:
        """Its easy neighbour: the same motion of a plate (a cylinder, if nothing slides) without
        friction, on the usual pad.
        """
        easy = {
            "specimen": {},
            "stimulus": FLAT if self.strokes else cylinder(209.97),
            "friction": 0.0,
        }
        return replace(self, scene=self.scene | easy, mesh=None, points=None)

    def written(self, folder: Path) -> dict[str, Any]:
        """The scene document, with the files that it names written into ``folder``: external mesh,
        points of the stimulus.
        """
        document, folder = self.document, Path(folder).absolute()
        if self.points is not None:
            np.savetxt(
                folder / "points.csv",
                np.transpose(self.points),
                "%.9g",
                ",",
                header="x (mm),y (mm)",
                comments="",
            )
            document["stimulus"] = document["stimulus"] | {"csv": str(folder / "points.csv")}
        if self.mesh is not None:
            from fingerpad.planning.plan import plan
            from fingerpad.specimen import write_pad

            built = scene_of(document, self.name)
            write_pad(self.mesh(built, plan(built)), folder / "external.msh")
            document["specimen"] = document.get("specimen", {}) | {
                "mesh": str(folder / "external.msh")
            }
        return document

    def read(self, folder: Path) -> Scene:
        """The scene; the files that it names are written into ``folder``."""
        return scene_of(self.written(folder), self.name)


def of_built(change: Callable[[PadMesh], PadMesh]) -> Callable[[Scene, Plan], PadMesh]:
    """What makes an external mesh of the one that the plan would have built."""
    from fingerpad.specimen import mesh_for

    return lambda scene, plan: change(mesh_for(scene, plan))


def scene_of(document: dict[str, Any], name: str) -> Scene:
    """The scene of a document written here; names and paths in it are as in config/scenes."""
    scene = Scene.model_validate(document, context=Source(SCENES / "case.yaml"))
    return scene.varied({"name": name})


# -- words of the scenes ------------------------------------------------------------------------------------------------------

FLAT, LINE = {"shape": "flat"}, {"shape": "line"}
SHARP_BAR = {"shape": "bar", "width": "1/16 inch"}
ROUNDED_BAR = SHARP_BAR | {"fillet": "0.03 mm"}
TWO_WAVES = {
    "shape": "wavy",
    "curvatures": ["104.99 1/m", "209.97 1/m"],
    "lead_in": "4 mm",
    "run_out": "5 mm",
}
WIDE_HOLLOW = TWO_WAVES | {
    "curvatures": ["104.99 1/m", "78.74 1/m"]
}  # its hollow is wider than the pad's apex
LAYERS = ("epidermis", "dermis", "fat")


def cylinder(curvature: float) -> dict[str, str]:
    return {"shape": "cylinder", "curvature": f"{curvature:g} 1/m"}


def poisson(ratio: float) -> dict[str, Any]:
    return {"layers": {layer: {"poisson_ratio": ratio} for layer in LAYERS}}


def stiff_skin(modulus: str) -> dict[str, Any]:
    return {"layers": {"epidermis": {"youngs_modulus": modulus}}}


def force(gram_weight: float, rate: float | None = None) -> dict[str, str]:
    leg = {"press_to_force": f"{gram_weight:g} gf"}
    return leg if rate is None else leg | {"rate": f"{rate:g} gf/s"}


def depth(millimetres: float, speed: float | None = None) -> dict[str, str]:
    leg = {"press_to_depth": f"{millimetres:g} mm"}
    return leg if speed is None else leg | {"speed": f"{speed:g} mm/s"}


def slide(millimetres: float, speed: float | None = 10, keep: str = "force") -> dict[str, str]:
    leg = {"slide": f"{millimetres:g} mm", "keep": keep}
    return leg if speed is None else leg | {"speed": f"{speed:g} mm/s"}


def hold(seconds: float) -> dict[str, str]:
    return {"hold": f"{seconds:g} s"}


PRESS = force(20, 40)
RAMP = [PRESS, hold(2)]
#: Pressure at an edge is singular: it has no smooth course to stay near.
EDGE = {"checkerboard": np.inf}
#: Four load increments of a steady press: of the work between them the trapezoidal rule knows the
#: ends only.
STEADY = {"energy": 0.05}
#: A few nodes in contact, which come and go one by one.
NARROW = {"checkerboard": 0.15}


# -- the cases ----------------------------------------------------------------------------------------------------------------


def _picked():
    group = "incompressible"
    for ratio in (0.48, 0.499, 0.4999, 0.49999):
        for name, stimulus in (("flat", FLAT), ("1260 1/m", cylinder(1259.84))):
            hard = f"bulk modulus {2 * (1 + ratio) / (3 * (1 - 2 * ratio)):.3g} times shear"
            scene = {"specimen": poisson(ratio), "stimulus": stimulus, "motion": RAMP}
            yield Case(
                f"nu {ratio:g}, {name}",
                group,
                hard,
                scene,
                Limits(**NARROW) if name != "flat" else Limits(),
            )

    group = "sharp"
    for curvature in (2.5e3, 5e3, 1e4):
        hard = (
            f"radius {1e3 / curvature:g} mm, of the order of a draft node spacing (0.13 mm) or "
            "below it"
        )
        yield Case(
            f"needle {curvature:g} 1/m",
            group,
            hard,
            {"stimulus": cylinder(curvature), "motion": RAMP},
            Limits(checkerboard=0.3),
        )
    by_hand = {"skin_edge": "268.8 um", "steps": 8}
    yield Case(
        "needle on a mesh too coarse",
        group,
        "radius 0.1 mm between nodes 0.13 mm apart, on the user's insistence",
        {"stimulus": cylinder(1e4), "motion": [force(20)], "accuracy": by_hand},
        steps=8,
        may_fail=True,
    )
    yield Case(
        "needle through the pad",
        group,
        "radius 0.017 mm driven 4 mm deep: nodes pop round it and elements fold",
        {
            "stimulus": cylinder(6e4),
            "motion": [depth(0.2, 1), depth(4, 1)],
            "specimen": poisson(0.4999),
        },
        may_fail=True,
    )
    for name, stimulus in (
        ("sharp bar", SHARP_BAR),
        ("bar, fillet 0.03 mm", ROUNDED_BAR),
        ("line load", LINE),
    ):
        for target in (1, 2):
            hard = "det F varies wildly within the element under an edge; nodes pop round it"
            limits = Limits(**STEADY, **EDGE, factorisations=8, cuts=2)
            yield Case(
                f"{name}, {target} mm",
                group,
                hard,
                {"stimulus": stimulus, "motion": [depth(target)]},
                limits,
            )

    group = "deep"
    for name, stimulus in (("flat", FLAT), ("210 1/m", cylinder(209.97))):
        for ratio in (0.48, 0.4999):
            hard = "3 mm into 5.5 mm of soft tissue: large strains, a contact as wide as the pad"
            scene = {"stimulus": stimulus, "motion": [depth(3)], "specimen": poisson(ratio)}
            yield Case(
                f"3 mm, {name}, nu {ratio:g}",
                group,
                hard,
                scene,
                Limits(**STEADY, factorisations=6),
            )

    group = "layers"
    for name, modulus in (("soft skin, 1:10", "1.5 kPa"), ("stiff skin, 1e4:1", "150 MPa")):
        scene = {
            "stimulus": FLAT,
            "motion": [force(2, 40), hold(2)],
            "specimen": stiff_skin(modulus),
        }
        yield Case(
            name,
            group,
            "stiffnesses far apart in one matrix, and a skin that wrinkles or cannot be stretched",
            scene,
        )
    for kind in ("inner", "inner_and_outer"):
        scene = {"stimulus": FLAT, "motion": RAMP, "specimen": {"ridges": kind}}
        hard = "a folded interface between stiff and soft" + (
            "; the contact is broken up" if kind != "inner" else ""
        )
        yield Case(
            f"ridges, {kind.replace('_', ' ')}",
            group,
            hard,
            scene,
            Limits(checkerboard=np.inf if "outer" in kind else 0.05),
        )
    scene = {
        "stimulus": FLAT,
        "friction": 1,
        "motion": [PRESS, slide(2), slide(-1)],
        "specimen": {"ridges": {"inner": {"height": "0.3 mm", "shape": "sharp"}}},
    }
    yield Case(
        "ridges, sharp, stroked",
        group,
        "tips bent to and fro under full friction",
        scene,
        Limits(**NARROW),
    )

    group = "friction"
    for name, stimulus, legs in (
        ("1.5 on a plate, there and back", FLAT, [slide(4), slide(-8)]),
        ("1.5 over two waves", TWO_WAVES, [slide(14)]),
        ("1.5 over two waves, reversals", TWO_WAVES, [slide(6.5), slide(-4), slide(4)]),
    ):
        scene = {"stimulus": stimulus, "friction": 1.5, "motion": [PRESS, *legs]}
        hard = "unsymmetric law: stick and slip may cycle, nodes enter and leave, slip turns round"
        yield Case(f"friction {name}", group, hard, scene, Limits(**NARROW))
    yield Case(
        "friction 0.33 pressed on a whole pad",
        group,
        "the load on a sharp curve outweighs the skin's stiffness along it; three or four nodes "
        "stick or slip",
        {
            "stimulus": cylinder(1333),
            "friction": 0.33,
            "motion": [force(28, 1)],
            "effects": {"finite_strain": "on", "symmetry": "off", "viscoelasticity": "off"},
        },
        Limits(**NARROW),
    )
    for name, stimulus in (("plate", FLAT), ("cylinder", cylinder(104.99))):
        scene = {"stimulus": stimulus, "friction": 0, "motion": [PRESS, slide(6)]}
        hard = "no tangential stiffness holds the contact; the cylinder is pushed off by its slope"
        yield Case(f"frictionless {name} pulled sideways", group, hard, scene, Limits(**NARROW))

    group = "loss of contact"
    for speed in (40, 400):
        scene = {
            "stimulus": WIDE_HOLLOW,
            "friction": 0.7,
            "motion": [depth(0.03, 1), slide(14, speed, "depth"), slide(-14, speed, "depth")],
        }
        hard = (
            "a hollow leaves the lightly pressed pad: forces vanish, their scale too, and "
            "contact returns"
        )
        yield Case(
            f"stroke at {speed} mm/s loses contact",
            group,
            hard,
            scene,
            Limits(energy=0.05, **NARROW),
        )
        motion = [depth(1, 2), hold(3), depth(0.05, speed), hold(0.2), depth(1, speed)]
        scene = {"stimulus": cylinder(209.97), "motion": motion}
        hard = "drawn back faster than the skin can follow, and pressed on again"
        yield Case(
            f"unloaded to separation at {speed} mm/s",
            group,
            hard,
            scene,
            Limits(energy=0.05, **NARROW),
        )
    motion = [force(20), {"step": "6 mm", "every": "2 mm"}]
    yield Case(
        "start with no contact, whole load at once",
        group,
        "nothing touches, no force gives a scale, the surface is not over it",
        {"stimulus": TWO_WAVES, "motion": motion},
        Limits(energy=0.35, factorisations=7, checkerboard=0.15),
        4,
    )
    for name, stimulus in (("flat", FLAT), ("210 1/m", cylinder(209.97))):
        motion = [PRESS, force(0.01, 400), hold(0.5), PRESS]
        hard = "unloaded to 1/2000 of the force, a node or two in contact, and on again"
        yield Case(
            f"almost to separation, {name}",
            group,
            hard,
            {"stimulus": stimulus, "motion": motion},
            Limits(**NARROW),
        )
    # by hand, for a mesh that is made for so narrow a contact has many nodes in it
    scene = {
        "stimulus": cylinder(209.97),
        "motion": [force(1e-4)],
        "accuracy": by_hand | {"steps": 4},
    }
    yield Case(
        "one node in contact",
        group,
        "a ten-thousandth of a gram-weight; no active set yet",
        scene,
        Limits(**STEADY),
    )

    group = "steps"
    for share in (1e-4, 1, 1e3):
        scene = {"stimulus": cylinder(209.97), "motion": [PRESS, hold(10 * share * 3.25)]}
        hard = f"holds of 10 steps of about {share:g} of the longest time constant"
        yield Case(f"steps of {share:g} tau", group, hard, scene, Limits(energy=0.05, **NARROW))
    for name, stimulus in (("flat", FLAT), ("1260 1/m", cylinder(1259.84))):
        scene = {"stimulus": stimulus, "motion": [force(20)], "specimen": poisson(0.4999)}
        limits = Limits(energy=0.35, factorisations=6, **NARROW)
        yield Case(
            f"one load step, {name}, nu 0.4999",
            group,
            "the whole load from nothing in one step",
            scene,
            limits,
            1,
        )
    for rate in (1e-3, 1e4):
        scene = {
            "stimulus": cylinder(209.97),
            "motion": [force(20, rate), hold(1)],
            "effects": {"finite_strain": "on", "viscoelasticity": "on"},
        }
        hard = "a ramp of 2 ms" if rate > 1 else "a ramp of five hours"
        yield Case(
            f"{rate:g} gf/s",
            group,
            f"{hard} against time constants of 0.34 and 3.25 s",
            scene,
            Limits(**NARROW),
        )

    group = "meshes"
    hand = {"stimulus": cylinder(209.97), "motion": RAMP}
    coarse = hand | {"accuracy": {"skin_edge": "1 mm", "steps": 20}}
    yield Case(
        "coarse",
        group,
        "nodes 0.5 mm apart: three in contact",
        coarse,
        Limits(checkerboard=np.inf),
        mesh=of_built(lambda mesh: mesh),
    )
    yield Case(
        "distorted",
        group,
        "inner nodes moved by up to 0.3 of an edge",
        hand,
        Limits(**NARROW),
        mesh=of_built(distorted),
    )
    yield Case(
        "triangles",
        group,
        "6-node triangles with a bubble",
        hand,
        Limits(**NARROW),
        mesh=of_built(triangles),
    )
    yield Case(
        "distorted linear triangles",
        group,
        "3-node triangles, moved, raised to 6 nodes",
        hand,
        Limits(**NARROW),
        mesh=of_built(lambda mesh: corners_only(triangles(distorted(mesh)))),
    )


PICKED: dict[str, Case] = {case.name: case for case in _picked()}
