"""A configuration's project: where its scenes, results, figures and tables are."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path
from typing import ClassVar

from cysyk1999.config import WorkflowConfig
from cysyk1999.figures.grammar import Figure
from cysyk1999.figures.registry import FIGURES
from cysyk1999.job import Job, Part, parts
from cysyk1999.publishing.tables import join_tables
from cysyk1999.publishing.write import draw_study
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import EVIDENCE, ReferenceDataError, read_force_depth
from fingerpad.documents import HIDE, Problem, SceneError, error_line, nearest
from fingerpad.scenes.families import Written, moves_along, read_scene, rests_on

RAMP, PLATE, STROKE = "calibration_ramp_hold", "calibration_plate", "stroke_sub_10"
COMPANIONS = {"coarse_mesh": 1, "coarse": 2}
"""Companions of a scene on a coarser mesh: folder of their results -> time steps merged into
one.
"""
RECEPTOR_TABLES = ("receptor_fits", "candidate_stimuli", "sensor_accuracy")
TABLES = ("thesis_comparison", "sensitivity")
NO_FILE = "there is no such file"
"""In the error of a scene that is not there."""
HISTORIES = {"history", "histories", "cases", "sweep"}
"""Keys of inputs that are histories."""


class Project:
    """Scenes, results and jobs of a configuration.

    Parameters
    ----------
    config : WorkflowConfig
        The configuration.
    file : path
        Where it was read, for messages.
    root : path
        Folder of the Snakefile. Files are looked for in the working directory first, then there.

    Raises
    ------
    SceneError
        A scene, a figure or a table does not exist, or a measured file is wrong.
    """

    def __init__(self, config: WorkflowConfig, file: str | Path, root: str | Path) -> None:
        self.config, self.file, self.root = config, file, Path(root)
        self._written = cache(self._find)
        self._check()

    # -- what there is -----------------------------------------------------------------------------

    def at(self, path: str) -> str:
        """A file or folder of the project: in the working directory if it is there, else beside the
        Snakefile.
        """
        return path if Path(path).exists() else os.path.relpath(self.root / path)

    @property
    def reference(self) -> list[str]:
        """The table of the thesis's numbers, and the evidence that says which of them the pad was
        fitted to.
        """
        return [self.at(f"config/reference/{name}") for name in ("thesis_numbers.csv", EVIDENCE)]

    def _check(self) -> None:
        """SceneError, one line, for a scene, a figure or a table that there is not."""
        c = self.config
        for key in ("scenes", "variants", "calibration_scenes", "friction_scenes", "field_scenes"):
            for i, name in enumerate(getattr(c, key)):
                try:
                    self._written(name)
                except SceneError as error:
                    if NO_FILE not in str(error):
                        raise
                    allowed = f"names of scenes in {' and '.join(self.scene_folders)}"
                    self._wrong((key, i), f"{name!r} is not the name of a scene", allowed)
        for i, number in enumerate(c.figure_numbers or ()):
            key = ("figure_numbers", i)
            if number not in self.specs:
                self._wrong(key, f"{number!r} is not drawn{nearest(number, self.specs)}")
            if lacking := [s for s in self.specs[number].needs if s not in c.every_scene]:
                shown = f"shows scenes that the configuration has not: {', '.join(lacking)}"
                allowed = "figures of its scenes, or leave figure_numbers out"
                self._wrong(key, f"{number!r} {shown}", allowed)
        known = (*TABLES, *RECEPTOR_TABLES, "benchmark", "mesh_quality", "summary")
        for i, name in enumerate(c.table_names):
            if name not in known:
                self._wrong(("table_names", i), f"{name!r} is not a table", ", ".join(known))
        for key, needed in (("calibration_scenes", PLATE), ("friction_scenes", STROKE)):
            if (names := getattr(c, key)) and needed not in names:
                self._wrong((key,), f"{names!r} lacks {needed}")
        if c.friction_coefficients and not c.friction_scenes:
            self._wrong(("friction_coefficients",), "lacks friction_scenes", "both or neither")
        if not self.forces and c.calibration_scenes:
            problem, allowed = "holds no CSV file", "a folder of at least one"
            self._wrong(("subjects",), f"{c.subjects!r} {problem}", allowed)
        try:  # what somebody has measured is read before anything is simulated
            if c.calibration_scenes:
                read_force_depth(self.forces)
            read_rates(*self.rates)
        except ReferenceDataError as error:
            raise SceneError(str(error)) from None

    def _wrong(self, key: tuple, problem: str, allowed: str = "") -> None:
        raise SceneError(error_line(self.file, key, Problem(problem, allowed, (), HIDE)))

    specs: ClassVar[Mapping[str, Figure]] = FIGURES
    """The thesis's figures that can be drawn, by number."""

    @cached_property
    def scene_folders(self) -> list[str]:
        """Where scenes are looked for."""
        return list(dict.fromkeys([self.at(self.config.scenes_folder), self.at("config/scenes")]))

    @cached_property
    def forces(self) -> list[str]:
        """Files of measured forces."""
        return self._csv(self.config.subjects)

    @cached_property
    def rates(self) -> list[str]:
        """Files of impulse rates, published and recorded."""
        return self._csv("config/reference/impulse_rates", "config/reference/recordings")

    def _csv(self, *folders: str) -> list[str]:
        return [
            str(path) for folder in folders for path in sorted(Path(self.at(folder)).glob("*.csv"))
        ]

    def scene(self, name: str) -> str:
        """Path of a scene: in the first folder that has a file, or a family, which can be so
        called.
        """
        return self._written(name)[0]

    def _find(self, name: str) -> tuple[str, Written]:
        """Path of a scene, and what is written of it."""
        *first, last = self.scene_folders
        for folder in first:
            path = f"{folder}/{name}.yaml"
            try:
                return path, read_scene(path)
            except SceneError as error:
                if NO_FILE not in str(error):
                    raise
        path = f"{last}/{name}.yaml"
        return path, read_scene(path)

    def thesis_specimen(self) -> str:
        return self.at("config/specimens/thesis.yaml")

    # -- names of results --------------------------------------------------------------------------

    def result(self, path: str) -> str:
        return f"{self.config.results}/{path}"

    def histories(self, scenes: Iterable[str], fidelity: str = "simulations") -> list[str]:
        """Simulation results of some scenes."""
        return [self.result(f"{fidelity}/{scene}/history.nc") for scene in scenes]

    def companions(self, scenes: Iterable[str]) -> list[str]:
        """Results of the scenes' companions on coarser meshes with coarser steps, if the
        configuration has any.
        """
        return self.histories(scenes, "coarse") if self.config.companions else []

    def both_companions(self, scenes: Iterable[str]) -> list[str]:
        """The same, and those of the companions on coarser meshes with the scenes' own steps."""
        names = list(scenes) if self.config.companions else []
        return [path for fidelity in COMPANIONS for path in self.histories(names, fidelity)]

    def meshes(self, scenes: Iterable[str]) -> list[str]:
        """Meshes the scenes are simulated on."""
        return [self.result(f"simulations/{scene}/mesh.msh") for scene in scenes]

    def pictures(self, names: Iterable[str], prefix: str = "") -> list[str]:
        """Pictures of studies."""
        return [f"{self.config.studies}/{prefix}{name}.png" for name in names]

    def tables(self, names: Iterable[str]) -> list[str]:
        """Tables."""
        return [f"{self.config.tables}/{name}.csv" for name in names]

    # -- simulations -------------------------------------------------------------------------------

    @cached_property
    def drawn(self) -> list[Figure]:
        """The figures of the configuration: those it names, else all whose scenes it has."""
        numbers, scenes = self.config.figure_numbers, set(self.config.every_scene)
        return [
            f
            for f in self.specs.values()
            if (f.number in numbers if numbers is not None else scenes.issuperset(f.needs))
        ]

    @cached_property
    def coarse(self) -> set[str]:
        """Scenes that have a companion: those of the configuration, and the variants that a figure
        or a calibration compares.
        """
        c, compared = self.config, {scene for f in self.drawn for scene in f.read_companions}
        return compared.union(c.scenes, {PLATE, RAMP, STROKE}.intersection(c.every_scene))

    def batches(self) -> dict[str, list[str]]:
        """Scenes that share a process: a family's, but each stroke has one of its own."""
        batches: dict[str, list[str]] = {}
        for name in self.config.every_scene:
            batch = name if moves_along(self.scene(name)) else self.family(name)
            batches.setdefault(batch, []).append(name)
        return batches

    def reads(self, *names: str) -> dict[str, list[str]]:
        """What jobs read of scenes: their files, and the specimens, profiles and meshes that these
        name.

        The scenes' own files only have to be there: what counts is what is written of a scene
        (`written`), so that an edit reruns the scenes whose meaning it changes, not all that share
        the file.
        """
        rested = {os.path.relpath(path): None for n in names for path in rests_on(self.scene(n))}
        own = {os.path.relpath(path) for n in names for path in self._written(n)[1].files}
        return {
            "scene_files": [path for path in rested if path in own],
            "files": [path for path in rested if path not in own],
        }

    def written(self, *names: str) -> list[str]:
        """Digests of what is written of scenes."""
        written = (self._written(name)[1].document for name in names)
        texts = (json.dumps(document, sort_keys=True, default=str) for document in written)
        return [hashlib.sha256(text.encode()).hexdigest()[:16] for text in texts]

    def values_of(self, *names: str) -> dict[str, list[str]]:
        """Parameters of jobs that load scenes: where these are, and digests of their content."""
        key = "scene" if len(names) == 1 else "scenes"
        return {key: [self.scene(name) for name in names], "written": self.written(*names)}

    def family(self, name: str) -> str:
        """Name of the file that a scene is in."""
        return self._written(name)[1].files[0].stem

    def picture_of(self, number: str) -> str:
        return f"{self.config.figures}/fig_{number}.png"

    def full_history(self, scene: str) -> str:
        """History of a scene: with whole fields, if a picture needs them of it."""
        if scene in self.with_fields:
            return self.result(f"fields/{scene}/history.nc")
        return self.histories([scene])[0]

    @property
    def with_fields(self) -> list[str]:
        """Scenes that are simulated with whole fields."""
        return [*dict.fromkeys([*self.config.field_scenes, *self.config.animations])]

    @property
    def measured(self) -> list[str]:
        """Scenes that numbers are read of."""
        c = self.config
        return [*dict.fromkeys([*c.scenes, *c.variants, *c.calibration_scenes])]

    def of_families(self, names: Iterable[str], *families: str) -> list[str]:
        """Those of some scenes that belong to some families."""
        return [name for name in names if self.family(name) in families]

    # -- jobs ----------------------------------------------------------------------------------

    def part(self, name: str) -> list[Job]:
        """The jobs of a part."""
        return [self._completed(job) for job in parts()[name].jobs(self)]

    def _completed(self, job: Job) -> Job:
        """A job with the folder of its PDFs, and the specimen that fills up scenes of histories."""
        if HISTORIES & job.inputs.keys():
            job = replace(job, inputs={"files": [self.thesis_specimen()]} | dict(job.inputs))
        if {"picture", "pictures"} & job.outputs.keys():
            job = replace(job, pdf=self.result("pdf"))
        return job

    def jobs(self) -> list[Job]:
        """All jobs."""
        return [job for name in parts() for job in self.part(name)]

    def targets(self, *names: str, figures: str = "none") -> list[str]:
        """Final outputs of some parts, and the figures whose number starts with `figures`."""
        wanted = [f.number for f in self.drawn if f.number.startswith(figures)]
        jobs = [job for name in names for job in self.part(name)]
        read = {path for job in jobs for path in job.read}
        made = [path for job in jobs for paths in job.outputs.values() for path in paths]
        return [*map(self.picture_of, wanted), *(path for path in made if path not in read)]

    def part_targets(self) -> list[Part]:
        """Parts that are targets of their own: those without a job of the same name."""
        names = {job.name for job in self.jobs()}
        return [part for name, part in parts().items() if name not in names]

    def default(self) -> list[str]:
        """Final outputs of the default target."""
        names = [name for name, part in parts().items() if part.in_default]
        return [*self.targets(*names, figures=""), *self.histories(self.config.scenes)]

    def joined(self, name: str, table: str, rows: list[str]) -> Job:
        """The job that puts parts of a table together."""
        return Job(join_tables, {"parts": rows}, {"table": self.tables([table])}, name=name)

    def study_pictures(self, study: str, names: list[str], data: list[str], module: str) -> Job:
        """The job that draws the pictures of a study from its data."""
        made, values = {"pictures": self.pictures(names, f"{study}_")}, {"study": [module]}
        name = f"{study}_pictures"
        return Job(draw_study, {"data": data}, made, values, name, (module,), priority=1)
