"""What follows from a configuration: which jobs a target needs, what they make, and what an edit
makes again.

Asked of the package, without Snakemake: a job's inputs, its sources included, are what its rule
has.
"""

from collections.abc import Iterable
from pathlib import Path

import pytest
import yaml

from cysyk1999.config import read_config
from cysyk1999.figures.registry import CHAPTERS
from cysyk1999.job import Job
from cysyk1999.project import Project
from fingerpad import load_scene, plan
from fingerpad.documents import SceneError
from fingerpad.planning.plan import companion

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).resolve().parents[2]


class Plan:
    """The jobs of a configuration, and what depends on what."""

    def __init__(self, document: dict | str) -> None:
        if isinstance(document, str):
            document = yaml.safe_load((ROOT / "config" / f"{document}.yaml").read_text())
        self.project = Project(read_config(document, "config.yaml"), "config.yaml", ROOT)
        self.config = self.project.config
        self.jobs = {job.name: job for job in self.project.jobs()}
        self.maker = {path: job for job in self.jobs.values() for path in job.made}

    def needed(self, targets: Iterable[str]) -> set[str]:
        """Names of the jobs that make some files from nothing."""
        todo, names = list(targets), set()
        while todo:
            job = self.maker.get(todo.pop())
            if job and job.name not in names:
                names.add(job.name)
                todo += [path for paths in job.inputs.values() for path in paths]
        return names

    def default(self) -> set[str]:
        return self.needed(self.project.default())

    def rerun(self, edited: str) -> set[str]:
        """Names of jobs of the default target that rest on a file of the project themselves."""

        def rests(job: Job) -> bool:
            read = [path for k, paths in job.inputs.items() if k != "scene_files" for path in paths]
            return any(Path(path).resolve() == ROOT / edited for path in (*job.sources, *read))

        return {name for name in self.default() if rests(self.jobs[name])}

    def kinds(self, names: Iterable[str]) -> set[str]:
        return {self.jobs[name].kind for name in names}

    def outputs(self, names: Iterable[str]) -> set[str]:
        return {path for name in names for path in self.jobs[name].made}

    def scenes(self, names: Iterable[str], kind: str = "simulations") -> set[str]:
        """Scenes whose histories some jobs make."""
        paths = map(Path, self.outputs(names))
        return {p.parent.name for p in paths if p.name == "history.nc" and p.parts[2] == kind}


@pytest.fixture(scope="module")
def thesis():
    return Plan("thesis")


@pytest.fixture(scope="module")
def smoke():
    return Plan("smoke")


def test_every_file_has_one_maker_and_every_job_a_name(thesis):
    outputs = [path for job in thesis.jobs.values() for path in job.made]
    assert len(outputs) == len(set(outputs)) and len(thesis.jobs) == len(thesis.project.jobs())
    assert all(name.isidentifier() for name in thesis.jobs)


def test_all_that_is_published_is_made_by_a_job(thesis):
    """But what is measured by hand, and each picture and table has its data and its Markdown."""
    made = {path for path in thesis.outputs(thesis.jobs) if path.startswith("figures/")}
    found = (path for path in (ROOT / "figures").rglob("*.*") if path.is_file())
    there = {path.relative_to(ROOT).as_posix() for path in found}
    assert made <= there, made - there
    by_hand = {Path(path).stem for path in there - made}
    assert by_hand <= BY_HAND, by_hand - BY_HAND


BY_HAND = {"speed", "sweeps", "soak", "profile_convention"}
"""What commands beside the workflow make."""


def test_default_is_at_most_ninety_jobs_and_makes_all_the_figures_tables_and_histories(thesis):
    names, config = thesis.default(), thesis.config
    assert len(names) <= 90
    outputs = thesis.outputs(names)
    assert {thesis.project.picture_of(number) for number in thesis.project.specs} <= outputs
    assert {*thesis.project.tables(config.table_names), "figures/README.md"} <= outputs
    assert {
        "figures/studies/animation_stroke_10.gif",
        "figures/studies/calibration_fit.png",
        "figures/studies/ridges_offset.png",
        "figures/studies/scorecard.csv",
        "results/thesis/specimens",
        "results/thesis/pdf/fig_4-10.pdf",
    } <= outputs
    assert thesis.scenes(names, "fields") == {*config.field_scenes, *config.animations}
    assert thesis.scenes(names) == set(config.every_scene)
    coarse = thesis.scenes(names, "coarse")
    compared = {scene for figure in thesis.project.drawn for scene in figure.read_companions}
    calibrated = {"calibration_plate", "calibration_ramp_hold", "stroke_sub_10"}
    assert coarse == {*config.scenes, *compared, *calibrated}
    assert {"ramp150_flat", "press10_flat"} <= coarse < set(config.every_scene)
    assert thesis.scenes(names, "coarse_mesh") == coarse


@pytest.mark.parametrize("configuration", ["thesis", "smoke"])
def test_companions_have_fewer_nodes_than_what_they_accompany(configuration, request):
    """Half as many, but for what a coarser mesh has as well: the bone, ridges, a sharp edge."""
    project = request.getfixturevalue(configuration).project
    for name in sorted(project.coarse & {*project.config.scenes, "calibration_plate"}):
        scene, own = load_scene(project.scene(name)), project.config.accuracy
        how = plan(scene if own is None else scene.with_accuracy(own))
        assert 0.3 * how.nodes < companion(scene, how).nodes < 0.75 * how.nodes, name


def test_companions_are_solved_beside_their_scenes_with_all_steps_and_with_every_two_made_one(
    thesis,
):
    job = thesis.jobs["simulate_stroke_10"]
    folder = "results/thesis/{}/stroke_10/history.nc"
    assert job.outputs["histories"] == [
        folder.format(kind) for kind in ("simulations", "coarse_mesh", "coarse")
    ]
    assert job.values["strides"] == ["0", "1", "2"]
    assert set(job.values["accuracies"]) == {"as_stated"}


def test_the_table_of_measures_has_every_companion_there_is(thesis):
    """Also of variants that only a figure compares: without it their rows in the comparison state
    no error.
    """
    coarse = {Path(p).parent.name for p in thesis.jobs["measures"].inputs["coarse"]}
    assert coarse == thesis.project.coarse and "ramp150_k315" in coarse


def test_studies_are_not_part_of_the_default(thesis):
    studies = {"accuracy_sweep", "accuracy_belief", "stability_method", "effects_study"}
    assert not thesis.kinds(thesis.default()) & {*studies, "peers_table"}


@pytest.mark.parametrize("chapter", ["3", "4", "5"])
def test_a_chapter_makes_its_figures_only(thesis, chapter):
    targets = thesis.project.targets(figures=f"{chapter}-")
    names = thesis.needed(targets)
    assert thesis.kinds(names) == {"simulate", "draw_figures"}
    drawn = {Path(p).stem for p in thesis.outputs(names) if p.startswith("figures/")}
    assert drawn == {f"fig_{n}" for n in thesis.project.specs if n.startswith(f"{chapter}-")}


def test_a_figure_simulates_the_families_it_needs_only(thesis):
    assert thesis.scenes(thesis.needed(["figures/thesis/fig_4-10.png"])) == {
        f"ramp40_{k}"
        for k in ("flat", "k79", "k105", "k158", "k210", "k315", "k420", "k630", "k1260")
    }
    assert thesis.scenes(thesis.needed(["figures/thesis/fig_5-11.png"])) == {"stroke_10"}


def test_ridges_and_calibration_simulate_their_own_scenes_only(thesis):
    names = thesis.needed(thesis.project.targets("ridges"))
    assert not thesis.scenes(names)
    names = thesis.needed(thesis.project.targets("calibration"))
    steady = {*thesis.config.calibration_scenes} - {"calibration_ramp_hold"}
    assert thesis.scenes(names) == {*steady, *thesis.config.friction_scenes}
    assert not {"draw_figures", "tables"} & thesis.kinds(names)


def test_errors_that_figures_state_are_judged_by_runs_of_theirs(thesis):
    names = thesis.needed(thesis.project.targets("accuracy"))
    jobs = [thesis.jobs[name] for name in names]
    assert [job.kind for job in jobs].count("accuracy_sweep") == 24
    (shown,) = (job for job in jobs if job.kind == "accuracy_shown")
    read = {*shown.inputs["histories"], *shown.inputs["coarse"]}
    assert all(read & {*job.outputs["histories"]} for job in jobs if job.kind == "simulate")


def test_smoke_writes_under_its_results_only_and_skips_what_it_lacks(smoke):
    names = smoke.default()
    assert all(Path(path).is_relative_to("results/smoke") for path in smoke.outputs(names))
    assert smoke.scenes(names) == {*smoke.config.scenes, *smoke.config.calibration_scenes}
    assert not {"calibrate_friction", "ridge_cases", "catalogue"} & smoke.kinds(names)


# -- the report ------------------------------------------------------------------------------------


def test_the_report_has_a_page_a_figure_study_and_table_in_the_order_of_numbers(thesis):
    jobs = {job.category: job for job in thesis.jobs.values() if job.kind == "report_pages"}
    assert set(jobs) == {"Chapter 3", "Chapter 4", "Chapter 5", "Studies", "Tables"}
    assert "report_pages" not in thesis.kinds(thesis.default())
    four = jobs["Chapter 4"]
    order = sorted((four.labels[page] for page in four.outputs["pages"]), key=lambda of: of["no."])
    assert [labels["figure"] for labels in order[:2]] == ["4-2", "4-3"]
    assert order[-1]["figure"] == "4-29"
    assert four.inputs["judged"] == ["figures/tables/thesis_comparison_chapter4.md"]
    pages = {Path(page).stem for job in jobs.values() for page in job.outputs["pages"]}
    assert {"animation_stroke_10", "ridges_offset", "accuracy_error", "stability"} <= pages
    assert {"thesis_comparison", "accuracy", "peers"} <= pages


def test_published_studies_are_shown_and_not_made_for_the_report(thesis):
    needed = thesis.kinds(thesis.needed(thesis.project.targets("report_pages")))
    studies = {"accuracy_sweep", "stability_method", "effects_study", "peers_table", "run_sweep"}
    assert not needed & studies
    assert "figures/studies/stability.png" in thesis.jobs["report_studies"].values["published"]


# -- what an edit makes again ----------------------------------------------------------------------


def test_an_edited_chapter_redraws_that_chapter_and_nothing_else(thesis):
    for module in CHAPTERS:
        names = thesis.rerun("src/" + module.replace(".", "/") + ".py")
        assert thesis.kinds(names) == {"draw_figures"}
        own = {
            name
            for name in thesis.default()
            if module in thesis.jobs[name].values.get("modules", [])
        }
        assert own <= names
        chapters = [{name.split("_")[1] for name in part} for part in (names, own)]
        assert chapters[0] == chapters[1], f"drawn again by an edit in {module}"


PICTURES, TABLES = {"draw_figures"}, {"tables", "catalogue"}  # which give verdicts
SCORED = PICTURES | TABLES | {"table_pictures"}


@pytest.mark.parametrize(
    "edited, kinds",
    [
        ("cysyk1999/figures/grammar", PICTURES),
        ("cysyk1999/claims/comparison", SCORED),
        ("cysyk1999/claims/reasons", SCORED),
        ("cysyk1999/claims/trends_pressing", SCORED),
        ("cysyk1999/claims/said", PICTURES | TABLES),
        ("cysyk1999/studies/ridges/frames", {"ridge_data"}),
        ("cysyk1999/project", set()),
        ("cysyk1999/config", set()),
    ],
)
def test_an_edit_reruns_what_rests_on_it(thesis, edited, kinds):
    names = thesis.rerun(f"src/{edited}.py")
    assert thesis.kinds(names) == kinds
    drawn = {name for name in thesis.default() if thesis.jobs[name].kind == "draw_figures"}
    assert not kinds & PICTURES or drawn <= names


def test_an_edited_kernel_reruns_simulations(thesis):
    names = thesis.rerun("src/fingerpad/mechanics/kernels.py")
    kinds = thesis.kinds(names)
    assert {"simulate", "strokes_with_friction", "ridge_cases"} <= kinds
    assert not {"draw_figures", "tables", "measure"} & kinds
    assert all(name in names for name in thesis.default() if thesis.jobs[name].kind == "simulate")


def test_an_edit_of_how_things_look_reruns_nothing_that_is_simulated(thesis):
    """Of all jobs, studies included: what draws, and what reads which curves a figure has."""
    drawing = ("cysyk1999/publishing/style", "cysyk1999/publishing/write", "fingerpad/picture")
    edited = [ROOT / "src" / f"{name}.py" for name in drawing]
    rests = {
        name: [path for path in map(Path.resolve, map(Path, job.sources)) if path in edited]
        for name, job in thesis.jobs.items()
    }
    redrawn = {name for name, files in rests.items() if files}
    shown = {"picture", "pictures", "gifs"}
    assert {"figures_4_2", "animations", "reconstruction_shares"} <= redrawn
    bare = {name for name in redrawn if not shown & thesis.jobs[name].outputs.keys()}
    assert bare == {"accuracy_shown", "ridge_data"}


def test_pictures_of_the_demands_are_drawn_of_tables_that_are_there(thesis, tmp_path, monkeypatch):
    demands = thesis.project.targets("demands")
    assert len(demands) == 3 and thesis.kinds(thesis.needed(demands)) == {"draw_demand"}
    assert all(thesis.maker[path].values["written"] for path in demands)
    monkeypatch.chdir(tmp_path)
    bare = Plan({"name": "mine", "scenes": ["ramp40_flat"]})
    needed = bare.kinds(bare.needed(bare.project.targets("demands")))
    assert {"draw_demand", "accuracy_tables", "stability_picture", "effects_picture"} <= needed


def test_sources_are_found_from_wherever_they_are_asked_for(thesis, tmp_path, monkeypatch):
    """Paths are those of the working directory, and stay so when it changes."""
    job = thesis.jobs["calibrate"]
    here, code = job.sources, job.code
    monkeypatch.chdir(tmp_path)
    assert all(Path(path).exists() for path in job.sources) and job.sources != here
    assert [line.split()[0] for line in job.code.splitlines()] == [
        line.split()[0] for line in code.splitlines()
    ]


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A study of its own in a folder of its own: two families and a configuration of name and
    scenes.
    """
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").mkdir()
    family = (
        "motion: [{press_to_force: 5 gf}]\nover: {surface: {flat: {stimulus: {shape: flat}}, "
        "line: {stimulus: {shape: line}}}}\n"
    )
    (tmp_path / "scenes" / "press.yaml").write_text(family)
    (tmp_path / "scenes" / "soft.yaml").write_text(
        "extends: press.yaml\nspecimen: {layers: calibrated_mean}\n"
    )
    return {
        "name": "mine",
        "scenes": ["press_flat", "press_line", "soft_flat", "ramp40_flat"],
        "scenes_folder": "scenes",
    }


def written(document: dict) -> dict[str, list[str]]:
    jobs = Plan(document).jobs
    return {
        name: [*job.values["written"], *job.inputs["files"]]
        for name, job in jobs.items()
        if job.kind == "simulate"
    }


def test_an_edited_scene_reruns_its_family_and_what_extends_it_only_if_that_changes_it(own):
    before, path = written(own), Path("scenes/press.yaml")
    assert set(before) == {"simulate_press", "simulate_soft", "simulate_ramp40"}

    def changed(text: str) -> set[str]:
        path.write_text(text)
        return {name for name, now in written(own).items() if now != before[name]}

    text = path.read_text()
    assert changed(text + "# a remark\n") == set()
    assert changed(text.replace("shape: line", "shape: bar, width: 1 mm")) == {"simulate_press"}
    assert changed(text.replace("shape: flat", "shape: bar, width: 1 mm")) == {
        "simulate_press",
        "simulate_soft",
    }


def test_a_study_of_ones_own_needs_name_and_scenes_and_writes_under_its_name(own):
    plan = Plan(own)
    outputs = plan.outputs(plan.default())
    assert all(Path(path).is_relative_to("results/mine") for path in outputs)
    assert "results/mine/tables/summary.csv" in outputs
    assert plan.scenes(plan.default()) == set(own["scenes"])
    assert any(
        path.endswith("config/specimens/calibrated_mean.yaml")
        for path in plan.jobs["simulate_soft"].inputs["files"]
    )


def test_subjects_of_ones_own_are_calibrated_to_in_ones_own_results(own):
    Path("forces").mkdir()
    rows = (ROOT / "config/reference/force_depth/dandekar_2003.csv").read_text()
    Path("forces/anna.csv").write_text(rows)
    plan = Plan(own | {"subjects": "forces"})
    assert plan.jobs["calibrate"].inputs["forces"] == ["forces/anna.csv"]
    outputs = plan.outputs(plan.default())
    assert {"results/mine/specimens", "results/mine/tables/calibration.csv"} <= outputs
    assert all(Path(path).is_relative_to("results/mine") for path in outputs)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"scenes": ["press_flat", "pres"]},
            "config.yaml: scenes[1]: 'pres' is not the name of a scene; allowed: names of scenes "
            "in",
        ),
        (
            {"scenes": ["press_round"]},
            "press_round.yaml: is not a scene of press.yaml; allowed: one of press_flat, "
            "press_line",
        ),
        (
            {"figure_numbers": ["9-99"]},
            "config.yaml: figure_numbers[0]: '9-99' is not drawn, the nearest is",
        ),
        (
            {"figure_numbers": ["5-6"]},
            "config.yaml: figure_numbers[0]: '5-6' shows scenes that the configuration has not: "
            "stroke_sub_10; allowed",
        ),
        (
            {"table_names": ["sumary"]},
            "config.yaml: table_names[0]: 'sumary' is not a table; allowed: ",
        ),
        (
            {"subjects": "nowhere"},
            "config.yaml: subjects: 'nowhere' holds no CSV file; allowed: a folder of at least one",
        ),
        (
            {"friction_coefficients": [0.3]},
            "config.yaml: friction_coefficients: lacks friction_scenes; allowed",
        ),
        (
            {"calibration_scenes": ["ramp40_flat"]},
            "config.yaml: calibration_scenes: ('ramp40_flat',) lacks calibration_plate",
        ),
    ],
)
def test_what_is_not_there_is_said_in_one_line(own, change, message):
    with pytest.raises(SceneError) as caught:
        Plan(own | change)
    assert message in str(caught.value) and "\n" not in str(caught.value)
