"""The jobs of simulations, of the thesis's figures and tables, and of the report."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cysyk1999.figures.animation import animations
from cysyk1999.figures.registry import CHAPTERS
from cysyk1999.job import Job, digest, part, parts
from cysyk1999.measures.table import measure
from cysyk1999.project import COMPANIONS, TABLES, Project
from cysyk1999.publishing.html import report_pages
from cysyk1999.workflow.draw import draw_figures
from cysyk1999.workflow.simulate import simulate, simulate_fields
from cysyk1999.workflow.summarise import mesh_quality, summarise
from cysyk1999.workflow.tabulate import catalogue, tables
from fingerpad.scenes.families import moves_along

if TYPE_CHECKING:
    from cysyk1999.figures.grammar import Figure

FOR_PEOPLE = ("picture", "pictures", "table", "tables", "gifs")
"""Keys of outputs that the report shows."""
MODULES = {spec.number: module for module, specs in CHAPTERS.items() for spec in specs}
"""Number of a figure -> its module."""


@part("simulations")
def simulations(project: Project) -> Iterator[Job]:
    """Scenes -> plans, meshes, histories, summaries."""
    accuracy = project.config.accuracy
    for batch, names in project.batches().items():
        cases = [(name, "simulations", 0) for name in names]
        if project.config.companions:
            compared = [name for name in names if name in project.coarse]
            cases += [(name, kind, n) for name in compared for kind, n in COMPANIONS.items()]
        places = [project.result(f"{kind}/{name}") for name, kind, _ in cases]
        yield Job(
            simulate,
            project.reads(*names),
            {"histories": [f"{place}/history.nc" for place in places]},
            {
                "scenes": [project.scene(name) for name, *_ in cases],
                "accuracies": ["as_stated" if accuracy is None else str(accuracy)] * len(cases),
                "strides": [str(stride) for *_, stride in cases],
                "written": project.written(*names),
            },
            f"simulate_{batch}".replace(".", "_").replace("-", "_"),
            also=[f"{p}/{f}" for p in places for f in ("mesh.msh", "plan.json", "summary.json")],
            mem_mb=2000,
            runtime=60,
            priority=2 if moves_along(project.scene(names[0])) else 1,
        )


@part("figures")
def figures(project: Project) -> Iterator[Job]:
    """The thesis's figures; those of a chapter that need the same simulations share a process."""
    batch_of = {name: batch for batch, names in project.batches().items() for name in names}
    groups: dict[tuple, list[Figure]] = {}
    for figure in project.drawn:
        batches = frozenset(batch_of[s] for s in figure.judged_by if s in batch_of)
        groups.setdefault((figure.number.partition("-")[0], batches), []).append(figure)
    for group in groups.values():
        needs = dict.fromkeys(s for figure in group for s in figure.judged_by if s in batch_of)
        compared = dict.fromkeys(scene for figure in group for scene in figure.read_companions)
        shown = {scene for figure in group for scene in figure.needs}
        compared |= dict.fromkeys(s for s in needs if s in project.coarse and s not in shown)
        folder = Path(project.reference[0]).parent
        measured = {str(path) for figure in group for path in figure.measured_files(folder)}
        modules = tuple(dict.fromkeys(MODULES[figure.number] for figure in group))
        yield Job(
            draw_figures,
            {
                "reference": project.reference,
                "histories": project.histories(needs),
                "meshes": project.meshes(needs),
                "coarse": project.both_companions(compared),
                "measured": sorted(measured),
            },
            {"pictures": [project.picture_of(figure.number) for figure in group]},
            {"modules": list(modules)},
            f"figures_{group[0].number.replace('-', '_')}",
            modules,
            priority=int(len(group) > 4),
        )


@part("catalogue", in_default=True)
def figure_catalogue(project: Project) -> Iterator[Job]:
    """figures/README.md, by the configuration that draws all figures."""
    if project.config.name == "thesis":
        titles = {figure.number: figure.title for figure in project.drawn}
        read = {
            "catalogue": [project.at("config/reference/figures.csv")],
            "judged": project.tables(TABLES[:1]),
            "reference": project.reference,
        }
        values = {"titles": [json.dumps(titles, ensure_ascii=False)]}
        yield Job(catalogue, read, {"readme": ["figures/README.md"]}, values)


@part("animations", in_default=True)
def moving_pictures(project: Project) -> Iterator[Job]:
    """Strokes as moving pictures."""
    if scenes := project.config.animations:
        gifs = [f"{project.config.studies}/animation_{scene}.gif" for scene in scenes]
        read = {"histories": [project.full_history(scene) for scene in scenes]}
        yield Job(animations, read, {"gifs": gifs}, priority=1)


@part("fields")
def fields(project: Project) -> Iterator[Job]:
    """Histories with whole fields; presses in one process, strokes in another."""
    for name, strokes in (("fields_of_presses", False), ("fields_of_strokes", True)):
        wanted = project.with_fields
        if scenes := [s for s in wanted if moves_along(project.scene(s)) == strokes]:
            values = {
                "scenes": [project.scene(scene) for scene in scenes],
                "written": project.written(*scenes),
            }
            made = {"histories": [project.full_history(scene) for scene in scenes]}
            more = {"mem_mb": 2000, "runtime": 30, "priority": 1}
            yield Job(simulate_fields, project.reads(*scenes), made, values, name, **more)


@part("all_tables", in_default=True)
def all_tables(project: Project) -> Iterator[Job]:
    """Tables of the comparison with the thesis, of sensitivities, and of the scenes' summaries."""
    c, scenes = project.config, project.measured
    if names := [name for name in TABLES if name in c.table_names]:
        read = {
            "histories": project.histories(scenes),
            "meshes": project.meshes(c.scenes),
            "coarse": project.both_companions(s for s in scenes if s in project.coarse),
        }
        measures = {"measures": [project.result("measures.csv")]}
        yield Job(measure, read, measures, name="measures", mem_mb=2000, priority=1)
        read = measures | {"reference": project.reference}
        yield Job(tables, read, {"tables": project.tables(names)}, also=chapter_pages(project))
    if "mesh_quality" in c.table_names:
        made = {"table": project.tables(["mesh_quality"])}
        yield Job(mesh_quality, {"meshes": project.meshes(c.scenes)}, made)
    if "summary" in c.table_names:
        own = dict.fromkeys([*c.scenes, *c.variants])
        read = {"summaries": [project.result(f"simulations/{s}/summary.json") for s in own]}
        yield Job(summarise, read, {"table": project.tables(["summary"])}, name="summary")


def chapter_pages(project: Project) -> list[str]:
    """The comparison with the thesis, a page a chapter."""
    if TABLES[0] not in project.config.table_names:
        return []
    return [f"{project.config.tables}/{TABLES[0]}_chapter{chapter}.md" for chapter in (3, 4, 5)]


# -- the report ------------------------------------------------------------------------------------


@part("report_pages")
def report(project: Project) -> Iterator[Job]:
    """A page for each figure, study and table, made or published before."""
    c = project.config
    jobs = [job for name, p in parts().items() if p.in_default for job in project.part(name)]
    made = [path for job in jobs for key in FOR_PEOPLE for path in job.outputs.get(key, [])]
    titles = {project.picture_of(f.number): f"{f.number}: {f.title}" for f in project.drawn}
    for chapter in dict.fromkeys(f.number.split("-")[0] for f in project.drawn):
        shown = [path for path in titles if titles[path].startswith(f"{chapter}-")]
        yield pages_of(project, f"Chapter {chapter}", shown, titles=titles)
    for category, folder, endings in (
        ("Studies", c.studies, (".png", ".gif", ".html")),
        ("Tables", c.tables, (".csv",)),
    ):
        shown = [p for p in made if Path(p).parent == Path(folder) and p.endswith(endings)]
        published = [p.as_posix() for p in Path(folder).glob("*") if p.suffix in endings]
        if category == "Tables":  # a table without Markdown is data of a figure
            published = [p for p in published if Path(p).with_suffix(".md").exists()]
        before = sorted(path for path in published if path not in shown)
        if shown or before:
            yield pages_of(project, category, shown, before)


def pages_of(
    project: Project,
    category: str,
    shown: list[str],
    published: Iterable[str] = (),
    titles: Mapping[str, str] = {},
) -> Job:
    """The job of a category's pages; of files that were `published` before, the content counts."""
    name, published = category.lower().replace(" ", "_"), list(published)
    sources = [*shown, *published]
    headings = [titles.get(p) or Path(p).stem.replace("_", " ").capitalize() for p in sources]
    pages = [project.result(f"report/{name}/{Path(path).stem}.html") for path in sources]
    labels = {}
    for page, title in zip(pages, headings, strict=True):
        number, _, shows = title.partition(": ")
        place = number.split("-")[-1].zfill(2)  # labels are sorted as text
        labels[page] = {category.lower()[:-1]: title}
        if shows:
            labels[page] = {"no.": place, "figure": number, "shows": shows}
    chapter = [
        p for p in chapter_pages(project) if titles and p.endswith(f"chapter{category[-1]}.md")
    ]
    read = {"shown": shown, "judged": chapter}
    values = {
        "published": published,
        "titles": headings,
        "written": [digest(path) for path in published],
    }
    return Job(
        report_pages,
        {key: paths for key, paths in read.items() if paths},
        {"pages": pages},
        {key: words for key, words in values.items() if words},
        f"report_{name}",
        category=category,
        labels=labels,
    )
