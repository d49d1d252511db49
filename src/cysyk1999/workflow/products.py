"""From a configuration to the workflow's jobs: what each reads, what it writes, and which of the
package's files it rests on.

Every file is named here, there are no wildcards: what is not named cannot be asked for, and what is
asked for has one job.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path

from cysyk1999.config import WorkflowConfig
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import ReferenceDataError, read_force_depth
from cysyk1999.workflow.chapters import Figure, offered
from cysyk1999.workflow.sources import imported_sources
from fingerpad.documents import HIDE, Problem, SceneError, error_line, nearest
from fingerpad.scenes.families import Written, moves_along, read_scene, rests_on

RAMP, PLATE, STROKE = "calibration_ramp_hold", "calibration_plate", "stroke_sub_10"
RIDGED, OUTER = "ridged_stroke_right", ("ridged_outer_stroke_right", "ridged_outer_stroke_left")
HEIGHT, FRICTION = 150, 0.35
"""Height (um) of ridges and coefficient of friction of RIDGED; the study of ridges varies one at a
time.
"""
RIDGE_MESHES = (("fine",), ("curved", "straight", "shifted"))
"""Further meshes for that case, by process."""
COMPANIONS = {"coarse_mesh": 1, "coarse": 2}
"""Companions of a scene, on a coarser mesh: the folder of their results, and how many of its steps
are one.
"""
RECEPTOR_TABLES = ("receptor_fits", "candidate_stimuli", "sensor_accuracy", "rapidly_adapting")
TABLES = ("thesis_comparison", "sensitivity")
PARTS = ("animations", "views", "all_tables", "calibration", "ridges", "meanings")
"""What is part of the default target beside figures and simulations."""
SHOWN = ("picture", "pictures", "table", "tables", "gifs")
"""Outputs that are for people."""
UNTOLD = ("files", "scene_files", "measured", "written")
"""Inputs that a job finds by itself, beside others or named in them, and what only says when to run
it again.
"""


ALL_CORES = 1000
"""Threads of a job that fills the machine; Snakemake gives it as many as there are."""
READ_BACK = {"history", "histories", "cases", "sweep"}
"""Inputs that are histories."""


@dataclass(frozen=True)
class Job:
    """One process of the workflow.

    Attributes:
        run: module of `cysyk1999.workflow.jobs`. inputs, outputs: files by what they are to the
        job. values: parameters likewise. called: the rule's name, if it is not the module's.
        modules: further modules that the job imports by name. also: outputs beside the others.
        category, labels: of the outputs called pages, which the report shows. vectors: folder of
        the pictures as PDF. priority: the higher the earlier, of what takes long or is waited for.
    """

    run: str
    inputs: Mapping[str, list[str]]
    outputs: Mapping[str, list[str]]
    values: Mapping[str, list[str]] = field(default_factory=dict)
    called: str = ""
    modules: tuple[str, ...] = ()
    category: str = ""
    labels: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    also: list[str] = field(default_factory=list)
    vectors: str = ""
    mem_mb: int = 1000
    runtime: int = 10
    priority: int = 0
    threads: int = 1

    @property
    def name(self) -> str:
        """The rule's."""
        return self.called or self.run

    @property
    def sources(self) -> list[str]:
        """The package's files that the job imports, directly or not."""
        return _sources(
            os.getcwd(),
            "cysyk1999.workflow.__main__",
            f"cysyk1999.workflow.jobs.{self.run}",
            *self.modules,
        )

    @property
    def code(self) -> str:
        """`sources` with their digests, a line a file."""
        return "".join(f"{_digest(os.path.abspath(path))}  {path}\n" for path in self.sources)

    @property
    def beside(self) -> list[str]:
        """What is written beside the outputs: Markdown to tables, their data and PDF to pictures,
        and `also`.
        """
        pictures = [Path(p) for key in ("picture", "pictures") for p in self.outputs.get(key, [])]
        tables = [Path(p) for key in ("table", "tables") for p in self.outputs.get(key, [])]
        data = [
            *(str(p.with_suffix(".csv")) for p in pictures),
            *(str(p.with_suffix(".md")) for p in tables),
        ]
        return [
            *data,
            *(f"{self.vectors}/{p.stem}.pdf" for p in pictures if self.vectors),
            *self.also,
        ]

    @property
    def words(self) -> list[tuple[str, str]]:
        """What the job is told on its command line: where in the rule it stands (input, output,
        params), and its key.
        """
        told = [("input", key) for key in self.inputs if key not in UNTOLD]
        values = [("params", key) for key in self.values if key not in UNTOLD]
        return [*told, *(("output", key) for key in self.outputs), *values]

    def reported(self, key: str, path: str) -> dict[str, object] | None:
        """How the report shows an output, if it does: category and labels."""
        return (
            {"category": self.category, "labels": dict(self.labels[path])}
            if key == "pages"
            else None
        )


@cache
def _digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


@cache
def _sources(where: str, *modules: str) -> list[str]:
    return [os.path.relpath(path, where) for path in imported_sources(*modules)]


class Products:
    """The jobs of a configuration.

    Args:
        config: the configuration. file: where it was read. root: folder of the Snakefile. Files
        that a configuration names are looked for in the working directory first and then in `root`.
    """

    def __init__(self, config: WorkflowConfig, file: str | Path, root: str | Path) -> None:
        self.config, self.file, self.root = config, file, Path(root)
        self._found: dict[str, str] = {}
        self._scenes: dict[str, Written] = {}
        self._check()

    # -- what there is -----------------------------------------------------------------------------------------------------

    def at(self, path: str) -> str:
        """A file or folder of the project: in the working directory if it is there, else beside the
        Snakefile.
        """
        return path if Path(path).exists() else os.path.relpath(self.root / path)

    def _check(self) -> None:
        """SceneError, one line, for a scene, a figure or a table that there is not."""
        c = self.config
        for key in ("scenes", "variants", "calibration_scenes", "friction_scenes", "field_scenes"):
            for i, name in enumerate(getattr(c, key)):
                self._check_scene((key, i), name)
        for i, number in enumerate(c.figure_numbers or ()):
            if number not in self.specs:
                self._wrong(
                    ("figure_numbers", i), number, f"is not drawn{nearest(number, self.specs)}", ""
                )
            if lacking := [
                scene for scene in self.specs[number].needs if scene not in c.every_scene
            ]:
                said = f"shows scenes that the configuration has not: {', '.join(lacking)}"
                self._wrong(
                    ("figure_numbers", i),
                    number,
                    said,
                    "figures of its scenes, or leave figure_numbers out",
                )
        known = (*TABLES, *RECEPTOR_TABLES, "mesh_quality", "summary")
        for i, name in enumerate(c.table_names):
            if name not in known:
                self._wrong(("table_names", i), name, "is not a table", ", ".join(known))
        for key, needed in (("calibration_scenes", PLATE), ("friction_scenes", STROKE)):
            if getattr(c, key) and needed not in getattr(c, key):
                self._wrong((key,), getattr(c, key), f"lacks {needed}", "")
        if c.friction_coefficients and not c.friction_scenes:
            self._wrong(
                ("friction_coefficients",), HIDE, "lacks friction_scenes", "both or neither"
            )
        if not self.forces and c.calibration_scenes:
            self._wrong(("subjects",), c.subjects, "holds no CSV file", "a folder of at least one")
        try:  # what somebody has measured is read before anything is simulated
            if c.calibration_scenes:
                read_force_depth(self.forces)
            read_rates(*self.rates)
        except ReferenceDataError as error:
            raise SceneError(str(error)) from None

    def _check_scene(self, key: tuple, name: str) -> None:
        try:
            read_scene(self.scene(name))
        except SceneError as error:
            if "there is no such file" in str(error):
                folders = " and ".join(self.scene_folders)
                self._wrong(
                    key, name, "is not the name of a scene", f"names of scenes in {folders}"
                )
            raise

    def _wrong(self, key: tuple, value: object, problem: str, allowed: str) -> None:
        shown = "" if value is HIDE else f"{value!r} "
        raise SceneError(
            error_line(self.file, key, Problem(f"{shown}{problem}", allowed, (), HIDE))
        )

    @cached_property
    def specs(self) -> dict[str, Figure]:
        """The thesis's figures that can be drawn, by number."""
        return offered()["figures"]

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
        if name not in self._found:
            self._found[name] = self._find(name)
        return self._found[name]

    def _find(self, name: str) -> str:
        for folder in self.scene_folders:
            path = Path(folder, f"{name}.yaml")
            try:
                read_scene(path)
            except SceneError as error:
                if "there is no such file" in str(error) and folder != self.scene_folders[-1]:
                    continue
            return str(path)
        raise AssertionError("a folder at least")

    def thesis_specimen(self) -> str:
        return self.at("config/specimens/thesis.yaml")

    # -- names of results --------------------------------------------------------------------------------------------------

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
        names = list(scenes)
        return (
            [path for fidelity in COMPANIONS for path in self.histories(names, fidelity)]
            if self.companions(names)
            else []
        )

    def meshes(self, scenes: Iterable[str]) -> list[str]:
        """Meshes the scenes are simulated on."""
        return [self.result(f"simulations/{scene}/mesh.msh") for scene in scenes]

    def pictures(self, names: Iterable[str], prefix: str = "") -> list[str]:
        """Pictures of studies."""
        return [f"{self.config.studies}/{prefix}{name}.png" for name in names]

    def tables(self, names: Iterable[str]) -> list[str]:
        """Tables."""
        return [f"{self.config.tables}/{name}.csv" for name in names]

    # -- simulations -------------------------------------------------------------------------------------------------------

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
        c = self.config
        compared = {*c.scenes, *(scene for figure in self.drawn for scene in figure.companions)}
        return compared | {scene for scene in c.every_scene if scene in (PLATE, RAMP, STROKE)}

    def batches(self) -> dict[str, list[str]]:
        """Scenes that share a process: a family's, but each stroke has one of its own."""
        batches: dict[str, list[str]] = {}
        for name in self.config.every_scene:
            batches.setdefault(
                name if moves_along(self.scene(name)) else self._family(name), []
            ).append(name)
        return batches

    def simulations(self) -> Iterator[Job]:
        """Scenes -> plans, meshes, histories, summaries."""
        for batch, names in self.batches().items():
            own = self.config.accuracy
            cases = [(name, "simulations", 0) for name in names]
            if self.config.companions:
                compared = [name for name in names if name in self.coarse]
                cases += [
                    (name, fidelity, n) for name in compared for fidelity, n in COMPANIONS.items()
                ]
            places = [self.result(f"{fidelity}/{name}") for name, fidelity, _ in cases]
            values = {
                "scenes": [self.scene(name) for name, *_ in cases],
                "accuracies": ["as_stated" if own is None else str(own)] * len(cases),
                "strides": [str(stride) for *_, stride in cases],
                "written": self._written(*names),
            }
            also = [
                f"{place}/{name}"
                for place in places
                for name in ("mesh.msh", "plan.json", "summary.json")
            ]
            called = f"simulate_{batch}".replace(".", "_").replace("-", "_")
            # the longest first, so that no core waits for them in the end
            first = 2 if moves_along(self.scene(names[0])) else 1
            made = {"histories": [f"{place}/history.nc" for place in places]}
            yield Job(
                "simulate",
                self._read(*names),
                made,
                values,
                called,
                also=also,
                mem_mb=2000,
                runtime=60,
                priority=first,
            )

    def _read(self, *names: str) -> dict[str, list[str]]:
        """What jobs read of scenes: their files, and the specimens, profiles and meshes that these
        name.

        The scenes' own files only have to be there: what counts is what is written of a scene
        (`_written`), so that an edit reruns the scenes whose meaning it changes, not all that share
        the file.
        """
        files = dict.fromkeys(
            os.path.relpath(path) for name in names for path in rests_on(self.scene(name))
        )
        own = {os.path.relpath(path) for name in names for path in self._scene(name).files}
        return {
            "scene_files": [path for path in files if path in own],
            "files": [path for path in files if path not in own],
        }

    def _written(self, *names: str) -> list[str]:
        """Digests of what is written of scenes."""
        texts = (
            json.dumps(self._scene(name).document, sort_keys=True, default=str) for name in names
        )
        return [hashlib.sha256(text.encode()).hexdigest()[:16] for text in texts]

    def _told(self, name: str) -> dict[str, list[str]]:
        """What jobs are told of a scene: where it is, and what is written of it."""
        return {"scene": [self.scene(name)], "written": self._written(name)}

    def _family(self, name: str) -> str:
        """Name of the file that a scene is in."""
        return self._scene(name).files[0].stem

    def _scene(self, name: str) -> Written:
        """What is written of a scene, read once."""
        if name not in self._scenes:
            self._scenes[name] = read_scene(self.scene(name))
        return self._scenes[name]

    # -- figures and tables ------------------------------------------------------------------------------------------------

    def picture_of(self, number: str) -> str:
        return f"{self.config.figures}/fig_{number}.png"

    def figures(self) -> Iterator[Job]:
        """Histories and meshes -> figures: those of a chapter that rest on the same simulations
        share a process.
        """
        batch_of = {name: batch for batch, names in self.batches().items() for name in names}
        groups: dict[tuple, list[Figure]] = {}
        for figure in self.drawn:
            batches = frozenset(batch_of[scene] for scene in figure.needs)
            groups.setdefault((figure.number.partition("-")[0], batches), []).append(figure)
        reference = self.at("config/reference/thesis_numbers.csv")
        for group in groups.values():
            needs = list(dict.fromkeys(scene for figure in group for scene in figure.needs))
            patterns = {pattern for figure in group for pattern in figure.measured}
            read = {
                "reference": [reference],
                "histories": self.histories(needs),
                "meshes": self.meshes(needs),
                "coarse": self.both_companions(
                    dict.fromkeys(scene for figure in group for scene in figure.companions)
                ),
                "measured": sorted(
                    str(path)
                    for pattern in patterns
                    for path in Path(reference).parent.glob(pattern)
                ),
            }
            called = f"figures_{group[0].number.replace('-', '_')}"
            made = {"pictures": [self.picture_of(f.number) for f in group]}
            modules = tuple(dict.fromkeys(figure.module for figure in group))
            # the longest first
            yield Job(
                "figures",
                read,
                made,
                {"modules": list(modules)},
                called,
                modules,
                priority=int(len(group) > 4),
            )

    def catalogue(self) -> Iterator[Job]:
        """figures/README.md, of the configuration that draws them all."""
        if self.config.name == "thesis":
            titles = json.dumps(
                {figure.number: figure.title for figure in self.drawn}, ensure_ascii=False
            )
            read = {
                "catalogue": [self.at("config/reference/figures.csv")],
                "judged": self.tables(TABLES[:1]),
            }
            yield Job("catalogue", read, {"readme": ["figures/README.md"]}, {"titles": [titles]})

    def animations(self) -> Iterator[Job]:
        """Moving pictures."""
        if scenes := self.config.animations:
            gifs = [f"{self.config.studies}/animation_{scene}.gif" for scene in scenes]
            yield Job(
                "animations",
                {"histories": [self._anywhere(scene) for scene in scenes]},
                {"gifs": gifs},
                priority=1,
            )

    def fields(self) -> Iterator[Job]:
        """Scenes -> histories with whole fields: presses in one process, what moves along in
        another.
        """
        for called, strokes in (("fields_of_presses", False), ("fields_of_strokes", True)):
            if names := [
                name
                for name in self.config.field_scenes
                if moves_along(self.scene(name)) == strokes
            ]:
                values = {
                    "scenes": [self.scene(name) for name in names],
                    "written": self._written(*names),
                }
                made = {"histories": [self._anywhere(name) for name in names]}
                yield Job(
                    "fields",
                    self._read(*names),
                    made,
                    values,
                    called,
                    mem_mb=2000,
                    runtime=30,
                    priority=1,
                )

    def _anywhere(self, scene: str) -> str:
        """Result of a scene: with whole fields, if it is of those."""
        return (
            self.result(f"fields/{scene}/history.nc")
            if scene in self.config.field_scenes
            else self.histories([scene])[0]
        )

    def views(self) -> Iterator[Job]:
        """Pictures of what happens inside, those whose scenes the configuration has, and of the
        tables that compare.
        """
        known, views = {*self.config.every_scene, *self.config.field_scenes}, offered()["VIEWS"]
        there = [name for name, scenes in views.items() if known.issuperset(scenes)]
        for called, strokes in (("views_of_presses", False), ("views_of_strokes", True)):
            if names := [
                name
                for name in there
                if any(moves_along(self.scene(s)) for s in views[name]) == strokes
            ]:
                read = [
                    self._anywhere(scene)
                    for scene in dict.fromkeys(scene for name in names for scene in views[name])
                ]
                made = {"pictures": self.pictures(names)}
                yield Job("views", {"histories": read}, made, called=called)
        tables = {"scorecard": "thesis_comparison", "candidate_stimuli": "candidate_stimuli"}
        if names := [name for name, table in tables.items() if table in self.config.table_names]:
            read = {
                "tables": self.tables([tables[name] for name in names]),
                "reference": [self.at("config/reference/thesis_numbers.csv")],
            }
            yield Job("table_pictures", read, {"pictures": self.pictures(names)})

    @property
    def measured(self) -> list[str]:
        """Scenes that numbers are read of."""
        c = self.config
        return [*dict.fromkeys([*c.scenes, *c.variants, *c.calibration_scenes])]

    def all_tables(self) -> Iterator[Job]:
        """Tables of all the results, of the receptors, and of the scenes' summaries."""
        c, scenes = self.config, self.measured
        if names := [name for name in TABLES if name in c.table_names]:
            every = {
                "histories": self.histories(scenes),
                "meshes": self.meshes(c.scenes),
                "coarse": self.both_companions(scene for scene in scenes if scene in self.coarse),
            }
            measures = {"measures": [self.result("measures.csv")]}
            yield Job("measures", every, measures, mem_mb=2000, priority=1)
            read = measures | {"reference": [self.at("config/reference/thesis_numbers.csv")]}
            yield Job("tables", read, {"tables": self.tables(names)}, also=self._comparison_pages())
        if "mesh_quality" in c.table_names:
            made = {"table": self.tables(["mesh_quality"])}
            yield Job("mesh_quality", {"meshes": self.meshes(c.scenes)}, made)
        if "summary" in c.table_names:
            read = [
                self.result(f"simulations/{scene}/summary.json")
                for scene in dict.fromkeys([*c.scenes, *c.variants])
            ]
            yield Job("summary", {"summaries": read}, {"table": self.tables(["summary"])})
        if names := [name for name in RECEPTOR_TABLES if name in c.table_names]:
            felt = self._of(
                [*c.scenes, *c.variants],
                "ramp40",
                "ramp150",
                "press10",
                "press15",
                "stroke",
                "stroke_sub",
            )
            read = {
                "rates": self.rates,
                "histories": self.histories(felt),
                "coarse": self.companions(
                    s
                    for s in self._of(c.scenes, "ramp40", "stroke")
                    if s.startswith("ramp40_") or s == "stroke_10"
                ),
            }
            yield Job("receptor_tables", read, {"tables": self.tables(names)}, priority=1)

    def _of(self, names: Iterable[str], *families: str) -> list[str]:
        """Those of `names` that belong to some families."""
        return [name for name in names if self._family(name) in families]

    def meanings(self) -> Iterator[Job]:
        """The study of the definitions of strain energy, if the configuration has the nine
        surfaces.
        """
        name, nine = "strain_energy_meanings", self._of(self.config.scenes, "ramp40")
        if len(nine) >= 9:
            read = {"histories": self.histories(nine), "coarse": self.both_companions(nine)}
            yield Job(name, read, {"picture": self.pictures([name])})

    # -- studies -----------------------------------------------------------------------------------------------------------

    def calibration(self) -> Iterator[Job]:
        """The pad calibrated to measured forces; the Prony series and friction, if the
        configuration has their scenes.
        """
        c = self.config
        if not c.calibration_scenes:
            return
        names, estimates = ["fit", "identifiability", "residuals"], ["estimates"]

        def data(*names: str) -> list[str]:
            return [self.result(f"calibration/{name}.csv") for name in names]

        steady = [scene for scene in c.calibration_scenes if scene != RAMP]
        read = {
            "forces": self.forces,
            "histories": self.histories(steady),
            "coarse": self.companions([PLATE]),
        }
        yield Job(
            "calibrate",
            read,
            {"data": data(*names, *estimates), "specimens": [self.result("specimens")]},
            priority=1,
        )
        if RAMP in c.calibration_scenes:
            read = {
                "relaxation": [self.at("config/reference/relaxation.csv")],
                "mesh": self.meshes([RAMP]),
                "histories": self.histories([PLATE, "calibration_long_term", RAMP]),
                **self._read(RAMP),
            }
            values = self._told(RAMP) | {"accuracy": [str(c.accuracy or "as_stated")]}
            yield Job("calibrate_prony", read, {"data": data("prony", "prony_estimates")}, values)
            names, estimates = [*names, "prony"], [*estimates, "prony_estimates"]
        if c.friction_coefficients:
            sweep = [self.result(f"friction/{mu:g}/history.nc") for mu in c.friction_coefficients]
            read, told = self._read(STROKE), self._told(STROKE)
            for k in (0, 1):  # in two processes, for two cores
                values, made = (
                    told | {"coefficients": [f"{mu:g}" for mu in c.friction_coefficients[k::2]]},
                    sweep[k::2],
                )
                long = {"mem_mb": 2000, "priority": 1}
                yield Job(
                    run := "strokes_with_friction",
                    read,
                    {"histories": made},
                    values,
                    f"{run}_{k + 1}",
                    **long,
                )
            read = {
                "thesis": [self.at("config/reference/thesis_numbers.csv")],
                "published": [self.at("config/reference/friction.csv")],
                "sweep": sweep,
                "histories": self.histories(c.friction_scenes),
            }
            yield Job(
                "calibrate_friction",
                read,
                {"data": data("friction", "friction_estimates")},
                priority=1,
            )
            names, estimates = [*names, "friction"], [*estimates, "friction_estimates"]
        yield self._study_pictures(
            "calibration", names, data(*names), "cysyk1999.studies.calibration.picture"
        )
        yield self._joined("calibration_table", data(*estimates), "calibration")

    def _joined(self, called: str, parts: list[str], table: str) -> Job:
        return Job("joined", {"parts": parts}, {"table": self.tables([table])}, called=called)

    def _study_pictures(self, name: str, names: list[str], data: list[str], module: str) -> Job:
        made = {"pictures": self.pictures(names, f"{name}_")}
        told = {"study": [module]}
        # several pictures by one job, which had better not be the last
        return Job(
            "pictures", {"data": data}, made, told, f"{name}_pictures", (module,), priority=1
        )

    def ridges(self) -> Iterator[Job]:
        """The study of ridges, if the configuration varies their height."""
        c = self.config
        if not c.ridge_heights:
            return
        pairs = list(
            dict.fromkeys(
                [(h, FRICTION) for h in c.ridge_heights]
                + [(HEIGHT, mu) for mu in c.ridge_frictions]
            )
        )
        both = [
            [self.result(f"ridges/{h:g}_{mu:g}_{mesh}/history.nc") for mesh in ("thesis", "coarse")]
            for h, mu in pairs
        ]
        groups = [sum(both[k : k + 2], []) for k in range(0, len(both), 2)]
        if (HEIGHT, FRICTION) in pairs:
            base = f"ridges/{HEIGHT:g}_{FRICTION:g}"
            groups += [
                [self.result(f"{base}_{mesh}/history.nc") for mesh in meshes]
                for meshes in RIDGE_MESHES
            ]
        read, told = self._read(RIDGED), self._told(RIDGED)
        for k, group in enumerate(groups, start=1):
            yield Job(
                run := "ridge_cases",
                read,
                {"histories": group},
                told,
                f"{run}_{k}",
                mem_mb=2000,
                runtime=30,
                priority=1,
            )
        cases = [history for group in groups for history in group]
        names = ["offset", "height", "friction", "mesh", "outer"]
        read = {
            "cases": cases,
            "histories": self.histories(OUTER),
            "coarse": self.companions(OUTER[:1]),
        }
        data = [self.result(f"ridges/{name}.csv") for name in names]
        yield Job("ridge_data", read, {"data": data}, priority=1)
        yield self._study_pictures("ridges", names, data, "cysyk1999.studies.ridges.picture")

    def accuracy(self) -> Iterator[Job]:
        """What accuracy costs in time, and whether runs know their error."""
        family, sweeps, outside = (offered()[key] for key in ("FAMILY", "SWEEPS", "OUTSIDE"))
        base, long = family["210"], {"mem_mb": 3000, "runtime": 60}
        for sweep in sweeps:
            scene, made = (
                family[sweep.split("_")[0]],
                {"records": [self.result(f"accuracy/{sweep}.json")]},
            )
            told = {"sweep": [sweep], **self._told(scene)}
            yield Job("accuracy_sweep", self._read(scene), made, told, f"accuracy_{sweep}", **long)
        read = self._read(*family.values()) | {
            "records": [self.result(f"accuracy/{sweep}.json") for sweep in sweeps]
        }
        tables = self.tables(["accuracy", "accuracy_orders", "accuracy_planner", "presets"])
        told = {
            "scenes": [self.scene(scene) for scene in family.values()],
            "written": self._written(*family.values()),
        }
        yield Job("accuracy_tables", read, {"tables": tables}, told)
        edged = offered()["EDGED"].values()
        told = {"scenes": [self.scene(scene) for scene in edged], "written": self._written(*edged)}
        yield Job(
            "accuracy_edges",
            self._read(*edged),
            {"table": self.tables(["accuracy_edges"])},
            told,
            **long,
        )
        made = {"rows": [self.result("accuracy/own.csv")], "table": self.tables(["accuracy_own"])}
        yield Job("accuracy_own", self._read(base), made, self._told(base), mem_mb=3000, runtime=60)
        pressed = [family[surface] for surface in offered()["RIDGED"]]
        told = {
            "scenes": [self.scene(scene) for scene in pressed],
            "written": self._written(*pressed),
        }
        yield Job(
            "accuracy_ridges",
            self._read(*pressed),
            {"table": self.tables(["accuracy_ridges"])},
            told,
            **long,
        )
        rows = [self.result(f"accuracy/strokes/{over}.csv") for over in offered()["STROKED_OVER"]]
        for over, part in zip(offered()["STROKED_OVER"], rows, strict=True):
            yield Job(
                run := "accuracy_strokes",
                self._read(base),
                {"rows": [part]},
                {"over": [over]},
                f"{run}_{over}",
                **long,
            )
        yield Job(
            "accuracy_strokes_table", {"parts": rows}, {"table": self.tables(["accuracy_strokes"])}
        )
        rows = [self.result(f"accuracy/belief/{name}.csv") for name in outside]
        for k in range(0, len(outside), 7):
            told, made = (
                {"names": list(outside[k : k + 7]), **self._told(base)},
                {"rows": rows[k : k + 7]},
            )
            yield Job(
                run := "accuracy_belief",
                self._read(base),
                made,
                told,
                f"{run}_{k // 7 + 1}",
                mem_mb=2000,
                runtime=60,
            )
        yield self._joined("accuracy_beliefs", rows, "accuracy_belief")
        parts = [self.result(f"accuracy/drawn/{kind}.csv") for kind in offered()["CLASSES"]]
        for kind, part in zip(offered()["CLASSES"], parts, strict=True):
            told = {"kind": [kind], **self._told(base)}
            yield Job(
                run := "accuracy_drawn",
                self._read(base),
                {"rows": [part]},
                told,
                f"{run}_{kind}",
                **long,
            )
        yield self._joined("accuracy_drawn", parts, "accuracy_drawn")
        yield from self._accuracy_shown()
        for called, table, pictures in (
            ("accuracy_pictures", "accuracy", ("error", "error_stroke", "growth")),
            ("accuracy_belief_picture", "accuracy_belief", ("belief",)),
            ("accuracy_drawn_picture", "accuracy_drawn", ("drawn",)),
            ("accuracy_ridges_picture", "accuracy_ridges", ("ridges",)),
            ("accuracy_shown_picture", "accuracy_shown", ("shown",)),
        ):
            read, made = (
                {"table": self.tables([table])},
                {"pictures": self.pictures(pictures, "accuracy_")},
            )
            yield Job("accuracy_pictures", read, made, {}, called)

    def _accuracy_shown(self) -> Iterator[Job]:
        """Whether the errors that figures state are those of their curves."""
        finer = {name for name in self.coarse if name.startswith(tuple(offered()["MADE_FINER"]))}
        figures = [f for f in self.drawn if f.companions and finer.issuperset(f.companions)]
        needs = list(dict.fromkeys(scene for figure in figures for scene in figure.needs))
        for batch, names in self.batches().items():
            if made := [name for name in names if name in finer]:
                told = {
                    "scenes": [self.scene(name) for name in made],
                    "written": self._written(*made),
                }
                histories = [self.result(f"accuracy/finer/{name}/history.nc") for name in made]
                yield Job(
                    run := "accuracy_finer",
                    self._read(*made),
                    {"histories": histories},
                    told,
                    f"{run}_{batch}",
                    mem_mb=3000,
                )
        read = {
            "reference": [self.at("config/reference/thesis_numbers.csv")],
            "histories": self.histories(needs),
            "meshes": self.meshes(needs),
            "coarse": self.both_companions(scene for scene in needs if scene in self.coarse),
            "finer": [self.result(f"accuracy/finer/{name}/history.nc") for name in sorted(finer)],
        }
        told = {"numbers": [figure.number for figure in figures]}
        yield Job(
            "accuracy_shown", read, {"table": self.tables(["accuracy_shown"])}, told, mem_mb=4000
        )

    def stability(self) -> Iterator[Job]:
        """Hard cases -> how stable the default method is in them, beside simpler methods."""
        read, data = {"files": [self.thesis_specimen()]}, []
        for method, parts in offered()["METHODS"].items():
            for part in range(1, parts + 1):
                told = {"method": [m := method.replace(" ", "_")], "part": [f"{part}/{parts}"]}
                data.append(d := self.result(f"stability/{m}_{part}.csv"))
                yield Job(
                    "stability_method",
                    read,
                    {"data": [d]},
                    told,
                    f"stability_{m}_{part}",
                    runtime=30,
                )
        made = {"picture": self.pictures(["stability"]), "table": self.tables(["stability"])}
        yield Job("stability_picture", {"methods": data}, made)

    def effects(self) -> Iterator[Job]:
        """What each effect changes and costs, and the planner's choices and rules against that."""
        parts, read = ("changes", "choices"), {"files": [self.thesis_specimen()]}
        data = [self.result(f"effects/{part}.csv") for part in parts]
        for p, d in zip(parts, data, strict=True):
            yield Job(
                "effects_study", read, {"data": [d]}, {"part": [p]}, f"effects_{p}", runtime=30
            )
        made = {
            "picture": self.pictures(["effects"]),
            "tables": self.tables(["effects", "planner_choices", "planner_rules"]),
        }
        yield Job("effects_picture", {"parts": data}, made)

    def peers(self) -> Iterator[Job]:
        """The same press through a public finite element package."""
        files = [self.thesis_specimen(), self.at("config/specimens/homogeneous.yaml")]
        made = {"table": self.tables(["peers"])}
        yield Job("peers", {"files": files}, made, called="peers_table", mem_mb=2000)

    def reconstruction(self) -> Iterator[Job]:
        """The pad that made the thesis's figures: evidence, pads simulated, what is inferred, and
        what that predicts.
        """
        evidence = {"evidence": [self.at("config/reference/reconstruction_evidence.csv")]}
        start = self.at("config/specimens/long_term.yaml")
        unknowns, named = (
            {"unknowns": [self.at("config/reconstruction/unknowns.yaml")]},
            {"files": [start]},
        )
        records, design = (
            [self.result("reconstruction/design.jsonl")],
            [f"{self.config.studies}/reconstruction_design.csv"],
        )
        long = {"runtime": 180, "mem_mb": 2000}
        yield Job(
            "reconstruction_design",
            unknowns | named,
            {"design": design},
            {"records": records},
            **long,
        )
        tables = self.tables(
            f"reconstruction_{name}"
            for name in ("posterior", "readings", "emulator", "recovery", "families")
        )
        parts = [
            self.result(f"reconstruction/{name}.csv") for name in ("samples", "predicted", "bands")
        ]
        found = {
            "tables": tables,
            "parts": parts,
            "specimen": [self.result("reconstruction/thesis.yaml")],
        }
        read = unknowns | named | evidence
        yield Job("reconstruction_inference", read | {"design": design}, found, **long)
        made = {"table": self.tables(["reconstruction_epidermis"])}
        yield Job(
            "reconstruction_epidermis", evidence | named | {"posterior": tables[:1]}, made, **long
        )
        made = {"pictures": self.pictures(["posterior", "evidence"], "reconstruction_")}
        yield Job(
            "reconstruction_pictures",
            unknowns | evidence | {"parts": parts[:2], "readings": tables[1:2]},
            made,
        )

    def explanations(self) -> Iterator[Job]:
        """Readings of what the thesis leaves open -> which of them bring about what does not
        hold.
        """
        scenes, offers = offered()["READ"], offered()
        names = [*offers["READ_ONLY"], *offers["READINGS"]]
        words = {name: re.sub("[^a-z]+", "_", name) for name in names}
        data = {name: self.result(f"explanations/{word}.csv") for name, word in words.items()}
        reference = {"reference": [self.at("config/reference/thesis_numbers.csv")]}
        read = reference | {"histories": self.histories(self.measured)}
        made = {"data": [data[name] for name in offers["READ_ONLY"]]}
        yield Job("explanations_read", read, made, {"names": offers["READ_ONLY"]}, mem_mb=2000)
        read = reference | self._read(*scenes)
        for name in offers["READINGS"]:
            told = {
                "name": [name],
                "scenes": [os.path.dirname(self.scene(scenes[0]))],
                "written": self._written(*scenes),
            }
            made = {"data": [data[name]]}
            yield Job(
                "explanation",
                read,
                made,
                told,
                f"explanation_{words[name]}",
                mem_mb=2000,
                runtime=60,
            )
        read = reference | {"comparison": self.tables(TABLES[:1]), "readings": [*data.values()]}
        made = {"tables": self.tables(["explanations", "explanations_readings"])}
        yield Job("explanations_table", read, made, {"names": names})

    def map_of_touch(self) -> Iterator[Job]:
        """A sweep over curvature, force and rate."""
        yield from self._published_sweep("map_of_touch", {})

    def five_hundred_fingers(self) -> Iterator[Job]:
        """A sweep over what is not known of a finger."""
        yield from self._published_sweep(
            "five_hundred_fingers", {"table": self.tables(["five_hundred_fingers"])}
        )

    def _published_sweep(self, name: str, more: dict[str, list[str]]) -> Iterator[Job]:
        folder = f"results/sweeps/{name}"
        read = {"sweep": [self.at(f"config/sweeps/{name}.yaml")], "files": [self.thesis_specimen()]}
        made, table = {"dataset": [f"{folder}/sweep.nc"]}, f"{folder}/sweep.csv"
        run = ("fingerpad.sweeps.batch", "fingerpad.sweeps.__main__")
        many = {"mem_mb": 2000, "runtime": 120, "threads": ALL_CORES}
        yield Job("sweep", read, made, called=f"sweep_{name}", modules=run, also=[table], **many)
        yield Job(name, {"scenes": [table]}, {"picture": self.pictures([name])} | more)

    # -- for people and archives -------------------------------------------------------------------------------------------

    def report(self) -> Iterator[Job]:
        """A page a figure, study and table, by category: of what the configuration makes, and of
        studies published beside it.
        """
        c = self.config
        jobs = [job for part in PARTS for job in getattr(self, part)()]
        made = [path for job in jobs for key in SHOWN for path in job.outputs.get(key, [])]
        titles = {self.picture_of(f.number): f"{f.number}: {f.title}" for f in self.drawn}
        for chapter in dict.fromkeys(f.number.split("-")[0] for f in self.drawn):
            shown = [
                self.picture_of(f.number) for f in self.drawn if f.number.startswith(f"{chapter}-")
            ]
            yield self._pages(f"Chapter {chapter}", shown, titles=titles)
        others = (
            ("Studies", c.studies, (".png", ".gif")),
            ("Tables", c.tables, (".csv",)),
        )
        for category, folder, endings in others:
            shown = [
                path
                for path in made
                if Path(path).parent == Path(folder) and path.endswith(endings)
            ]
            there = sorted(
                p.as_posix()
                for p in Path(folder).glob("*")
                if p.suffix in endings and p.as_posix() not in shown
            )
            if shown or there:
                yield self._pages(category, shown, there)

    def _pages(
        self,
        category: str,
        shown: list[str],
        published: Iterable[str] = (),
        titles: Mapping[str, str] = {},
    ) -> Job:
        """Pages of pictures or tables, some of which are made here (`shown`); of the others the
        content counts.
        """
        name, published = category.lower().replace(" ", "_"), list(published)
        sources = [*shown, *published]
        said = [
            titles.get(path) or Path(path).stem.replace("_", " ").capitalize() for path in sources
        ]
        pages = [self.result(f"report/{name}/{Path(path).stem}.html") for path in sources]
        labels = {}
        for page, title in zip(pages, said, strict=True):
            number, _, shows = title.partition(": ")
            place = number.split("-")[-1].zfill(2)  # labels are sorted as text
            labels[page] = (
                {"no.": place, "figure": number, "shows": shows}
                if shows
                else {category.lower()[:-1]: title}
            )
        judged = [
            path
            for path in self._comparison_pages()
            if titles and path.endswith(f"chapter{category[-1]}.md")
        ]
        read = {"shown": shown, "judged": judged}
        told = {
            "published": published,
            "titles": said,
            "written": [_digest(path) for path in published],
        }
        return Job(
            "report_pages",
            {k: v for k, v in read.items() if v},
            {"pages": pages},
            {k: v for k, v in told.items() if v},
            f"report_{name}",
            category=category,
            labels=labels,
        )

    def _comparison_pages(self) -> list[str]:
        """The comparison with the thesis, a page a chapter."""
        there = TABLES[0] in self.config.table_names
        return (
            [f"{self.config.tables}/{TABLES[0]}_chapter{chapter}.md" for chapter in (3, 4, 5)]
            if there
            else []
        )

    def jobs(self) -> list[Job]:
        """All of them."""
        parts = (
            self.simulations,
            self.figures,
            self.catalogue,
            self.animations,
            self.fields,
            self.views,
            self.all_tables,
            self.meanings,
            self.calibration,
            self.ridges,
            self.accuracy,
            self.stability,
            self.effects,
            self.peers,
            self.reconstruction,
            self.explanations,
            self.map_of_touch,
            self.five_hundred_fingers,
            self.report,
        )
        jobs = [job for part in parts for job in part()]
        # a scene read back from a history is filled up with the thesis's specimen, though it lacks
        # nothing
        named = {"files": [self.thesis_specimen()]}
        jobs = [
            replace(job, inputs=named | dict(job.inputs)) if READ_BACK & job.inputs.keys() else job
            for job in jobs
        ]
        return [
            replace(job, vectors=self.result("pdf"))
            if {"picture", "pictures"} & job.outputs.keys()
            else job
            for job in jobs
        ]

    def targets(self, *parts: str, figures: str = "none") -> list[str]:
        """Final outputs of some parts (names of the methods above), and the figures whose number
        starts so.
        """
        wanted = [f for f in self.drawn if f.number.startswith(figures)]
        jobs = [job for part in parts for job in getattr(self, part)()]
        read = {path for job in jobs for paths in job.inputs.values() for path in paths}
        made = [
            path
            for job in jobs
            for paths in job.outputs.values()
            for path in paths
            if path not in read
        ]
        return [*(self.picture_of(f.number) for f in wanted), *made]
