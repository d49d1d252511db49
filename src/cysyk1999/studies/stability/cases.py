"""The catalogue of hard cases: scenes on a draft mesh, what makes each hard, and what is stable.

Cases are data: ``config/stability/picked.yaml`` has those picked by hand,
``config/stability/combinations.yaml`` those in which every two hard levels of the factors meet
(:mod:`cysyk1999.studies.stability.combining`), ``config/stability/turned.yaml`` those of
revolution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import yaml

from cysyk1999.studies.common.documents import CONFIG, FLAT, cylinder, scene_of
from cysyk1999.studies.common.meshes import corners_only, distorted, split
from cysyk1999.studies.stability.combining import drawn, listed
from fingerpad.healing import MOST_CHANGE, MOST_CUTS, MOST_FACTORISATIONS
from fingerpad.planning.plan import plan
from fingerpad.scenes.scene import Scene
from fingerpad.specimen import mesh_for, write_pad
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.pad import MeshError, PadMesh
from fingerpad.specimen.quality import check_orientation

FOLDER = CONFIG / "stability"
FILES = sorted(path.name for path in FOLDER.iterdir())
METHODS = {
    "default": "this package",
    "full Q1": "full Q1 elements (lock)",
    "plain P2": "plain P2 elements (oscillate)",
    "plain Newton": "plain Newton (not lagged)",
}
"""Method -> its title in the picture; the first is the one that is offered."""
DEFAULT, *TEACHING = METHODS
PARTS = {method: 4 if method == DEFAULT else 1 for method in METHODS}
"""In how many processes a method's runs are made: the default one is run several times a case."""


def limit(value: float, text: str) -> Any:
    """A limit's default, and how a limit that differs from it is written."""
    return field(default=value, metadata={"text": text})


@dataclass(frozen=True)
class Limits:
    """The worst that a stable run may measure (:mod:`cysyk1999.studies.stability.invariants`).

    Above the first two a user's run says that it labours. The limit of the other solver is that of
    a run that is factored in single precision, which ends where less than its tolerance is left.
    """

    cuts: float = limit(MOST_CUTS, "at most {:g} cuts")
    factorisations: float = limit(MOST_FACTORISATIONS, "at most {:g} factorisations a step")
    energy: float = limit(0.03, "energy balanced within {:.0%}")
    complementarity: float = limit(1e-3, "complementarity within {:g}")
    det_f: float = limit(0.1, "det F above {:g}")
    checkerboard: float = limit(0.05, "checkerboard index up to {:g}")
    halving: float = limit(MOST_CHANGE, "half the step changes it by up to {:.0%}")
    balance: float = limit(1e-3, "forces balanced within {:g}")
    symmetry: float = limit(1e-3, "its own mirror image within {:g}")
    effort: float = limit(4, "up to {:g} times its easy neighbour's iterations")
    solver: float = limit(1e-3, "the other solver within {:g}")
    reference: float = limit(
        1, "off a converged reference by up to {:g} times what it believes, or a draft may be"
    )

    def described(self) -> str:
        """Where these limits differ from those of all cases; "as all" where they do not."""
        texts = [
            known.metadata["text"].format(value)
            for known in fields(self)
            if (value := getattr(self, known.name)) != known.default
        ]
        return "; ".join(texts).replace("inf", "any").replace("nan", "any") or "as all"


@dataclass(frozen=True)
class Case:
    """One hard case.

    Attributes
    ----------
    name, group : str
        Name of the case, and of the cases that it is shown with.
    hard : str
        What makes it hard.
    scene : dict
        Keys of a scene document.
    limits : Limits
        What counts as stable.
    steps : int or None
        Steps of a leg; None: 10, or 4 if all is steady.
    mesh : str or None
        Key of :data:`MESHES`: the case has an external mesh, made of the built one.
    may_fail : bool
        The case is beyond the method: a clean failure or an estimated error of a half is enough.
    compare : tuple of str
        Dear comparisons that are made: "halving", "solver", "reference".
    levels : dict of str
        Of a combination: factor -> its hard level.
    """

    name: str
    group: str
    hard: str
    scene: dict[str, Any]
    limits: Limits = Limits()
    steps: int | None = None
    mesh: str | None = None
    may_fail: bool = False
    compare: tuple[str, ...] = ()
    levels: Mapping[str, str] = field(default_factory=dict)

    @property
    def stable(self) -> str:
        """What counts as stable, in words."""
        if self.may_fail:
            return "a clean failure, or an estimated error of a half"
        return self.limits.described()

    @property
    def steps_per_leg(self) -> int:
        """Steps of a leg, before any is cut."""
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
        """The same motion of a plate, cylinder or sphere without friction, on the usual pad."""
        stimulus = FLAT if self.strokes else cylinder(209.97)
        if "kinematics" in self.scene:
            stimulus = {"shape": "sphere", "radius": "5 mm"}
        easy = {"specimen": {}, "stimulus": stimulus, "friction": 0.0}
        return replace(self, scene=self.scene | easy, mesh=None)

    def read(self, folder: Path) -> Scene:
        """The scene; its external mesh, if it has one, is written into ``folder``."""
        document = self.document
        scene = scene_of(document, self.name, FOLDER)
        if self.mesh is None:
            return scene
        path = Path(folder).absolute() / "external.msh"
        write_pad(_mesh(self.mesh, scene), path)
        specimen = document.get("specimen", {}) | {"mesh": str(path)}
        return scene_of(document | {"specimen": specimen}, self.name, FOLDER)


def _mesh(name: str, scene: Scene) -> PadMesh:
    """The mesh that a scene's plan would have built, changed; "graded" has edges of 15 um under the
    apex that grow to about a hundred times as much.
    """
    chosen = plan(scene)
    if name == "graded":
        finest = {"focus": ((0.0, 15e-6),), "skin_radial_edge": 15e-6}
        size = replace(chosen.mesh_size, growth=2.0, coarse_edge=1.8e-3, **finest)
        return build_pad_mesh(scene.specimen.outline, size)
    mesh = mesh_for(scene, chosen)
    if scene.axisymmetric:
        mesh = mesh.right_half()
    for change in MESHES[name]:
        mesh = change(mesh)
    return mesh


def _distorted(mesh: PadMesh) -> PadMesh:
    """Inner nodes moved by 0.3 of an edge, or by less where long elements would fold."""
    for share in (0.3, 0.15, 0.08, 0.04):
        with suppress(MeshError):
            moved = distorted(mesh, share)
            check_orientation(moved, "mesh")
            return moved
    return mesh


def _off_centre(mesh: PadMesh) -> PadMesh:
    return replace(mesh, points=mesh.points + [0.7e-3, 0.0], symmetric=False)


_triangles = partial(split, kind="tri6")
MESHES: dict[str, list[Callable[[PadMesh], PadMesh]]] = {
    "as_built": [],
    "graded": [],
    "off_centre": [_off_centre],
    "distorted": [distorted],
    "distorted_quads": [_distorted],
    "linear_quads": [corners_only],
    "triangles": [_triangles],
    "linear_triangles": [_triangles, corners_only],
    "distorted_triangles": [_distorted, _triangles],
    "distorted_linear_triangles": [distorted, _triangles, corners_only],
}
"""Name of an external mesh in the catalogue -> what is done to the one that would be built."""


def _case(entry: Mapping[str, Any]) -> Case:
    levels = entry.get("levels", {})
    others = (f"{name} {level}" for name, level in levels.items() if name != "stimulus")
    limits = Limits(**entry.get("limits", {}))
    return Case(**{"hard": "; ".join(others)} | dict(entry) | {"limits": limits})


def _picked(file: str) -> dict[str, Case]:
    entries = yaml.safe_load((FOLDER / file).read_text(encoding="utf-8"))
    return {name: _case({"name": name} | entry) for name, entry in entries.items()}


PICKED, COMBINED = _picked("picked.yaml"), {entry["name"]: _case(entry) for entry in listed()}
TURNED = _picked("turned.yaml")
CATALOGUE: dict[str, Case] = PICKED | COMBINED | TURNED


def unseen(seed: int, count: int = 100) -> dict[str, Case]:
    """Cases that the catalogue does not have, drawn by a seed."""
    return {entry["name"]: _case(entry) for entry in drawn(seed, count)}
