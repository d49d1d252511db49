"""What is made again after a change, by content, no more and no less; after an interruption; and
what is adopted.

Which jobs an edit reruns in the full configuration is asked of the package in test_products, and of
Snakemake here.
"""

import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile

import numpy as np
import pandas as pd
import pytest
import yaml

from cysyk1999.config import read_config
from cysyk1999.project import Project
from fingerpad.results import read_history

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SMOKE = ("--configfile", "config/smoke.yaml")
HISTORY = "results/smoke/simulations/homogeneous_flat/history.nc"


def jobs_of(tree, name):
    """All jobs of a configuration in a tree."""
    document = yaml.safe_load((tree.root / "config" / f"{name}.yaml").read_text())
    return Project(read_config(document, f"{name}.yaml"), f"{name}.yaml", tree.root).jobs()


COMPANIONS = {
    f"results/smoke/{kind}/homogeneous_flat/history.nc" for kind in ("coarse_mesh", "coarse")
}


TOUCHED = (
    "src/fingerpad/mechanics/stepping.py",
    "src/cysyk1999/publishing/style.py",
    "src/cysyk1999/workflow/simulate.py",
    "config/scenes/ramp40.yaml",
    "config/specimens/thesis.yaml",
    "config/reference/thesis_numbers.csv",
    "requirements.lock",
    HISTORY,
)


def test_nothing_is_left_to_do_and_touched_files_and_remarks_rerun_nothing(finished):
    for path in TOUCHED:
        os.utime(finished.root / path)
    with finished.edited("config/scenes/homogeneous_flat.yaml"):
        assert finished.planned(*SMOKE) == {}


def test_a_changed_scene_reruns_that_scene(finished):
    with finished.edited("config/scenes/homogeneous_flat.yaml", "friction: 0.1\n"):
        jobs = finished.planned(*SMOKE)
    assert {HISTORY, *COMPANIONS} <= jobs["simulate_homogeneous_flat"]
    assert {name for name in jobs if name.startswith("simulate_")} == {"simulate_homogeneous_flat"}
    assert not {"calibrate", "calibration_pictures"} & set(jobs)


def test_a_changed_specimen_reruns_its_scenes_and_a_further_file_of_forces_the_calibration(
    finished,
):
    path = finished.root / "config/reference/force_depth/mine.csv"
    path.write_text((path.parent / "dandekar_2003.csv").read_text())
    try:
        with finished.edited("config/specimens/homogeneous.yaml"):
            jobs = finished.planned(*SMOKE)
    finally:
        path.unlink()
    assert {name for name in jobs if name.startswith("simulate_")} == {"simulate_homogeneous_flat"}
    assert {"calibrate", "calibration_pictures", "calibration_table"} <= set(jobs)


def test_changed_environment_reruns_simulations_and_what_reads_them(finished):
    with finished.edited("requirements.lock"):
        assert {"simulate_ramp40", "figures_4_12", "tables", "calibrate"} <= set(
            finished.planned(*SMOKE)
        )


def test_snakemake_looks_for_jobs_when_one_has_ended_and_not_by_the_clock(finished):
    """Each look by the clock sets another: in ninety jobs they came to an eighth of the time of
    all.
    """
    traced = [json.loads(path.read_text()) for path in finished.traces.iterdir()]
    workflows = [process for process in traced if process["argv"][:2] == ["-m", "snakemake"]]
    assert len(workflows) == 1 and workflows[0]["timers"] == 0


def test_every_file_a_job_opens_is_an_input_of_its_rule(finished):
    """What is not declared cannot trigger a rerun: the rules' inputs against what processes really
    opened.
    """
    with contextlib.chdir(finished.root):
        jobs = jobs_of(finished, "smoke")
        inputs = {job.name: {os.path.relpath(p) for p in (*job.sources, *job.read)} for job in jobs}
    declared = {f"results/smoke/logs/{job.name}.log": job for job in jobs}
    src = os.path.join(os.path.dirname(__file__), "..", "..", "src")
    here = os.path.relpath(src, finished.root)
    results = {path for job in jobs for path in job.made}
    traced = [json.loads(path.read_text()) for path in finished.traces.iterdir()]
    runs = set()
    for process in (t for t in traced if t["argv"][:2] == ["-m", "cysyk1999.workflow"]):
        log = process["argv"][process["argv"].index("--log") + 1]
        job = declared[log]
        allowed = {path.replace(here, "src") for path in inputs[job.name]} | {*job.made}
        read = {
            path for path in process["files"] if path in results or not path.startswith("results/")
        }
        undeclared = {path for path in read - allowed if "__pycache__" not in path}
        assert not undeclared, f"{job.name} opens what it does not declare"
        runs.add(job.kind)
    assert runs >= {
        "simulate",
        "draw_figures",
        "measure",
        "tables",
        "calibrate_forces",
        "draw_study",
        "join_tables",
        "receptor_tables",
    }


def test_copied_results_are_adopted_by_one_command(finished, tmp_path):
    copy = type(finished).copy(tmp_path)
    subprocess.run(["cp", "-r", finished.root / "results", copy.root], check=True)
    hour_ago = time.time() - 3600
    for path in copy.root.rglob("results/**/*"):
        os.utime(
            path, (hour_ago, hour_ago)
        )  # not by the order in which two clocks of a machine tick
    for path in (copy.root / "src").rglob("*.py"):
        os.utime(path)  # a clone's files are as new as the clone
    assert copy.planned(*SMOKE)
    copy.run(*SMOKE, "--touch")
    assert copy.planned(*SMOKE) == {}


# -- interrupted -----------------------------------------------------------------------------------

SCENE = (
    "stimulus: {shape: flat}\nmotion: [{press_to_force: 5 gf, rate: 5 gf/s}]\naccuracy: "
    "{skin_edge: 0.3 mm, steps: 60}\n"
)


def start(project, *arguments):
    """Snakemake in a project, all its processes in a group of their own."""
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *arguments],
        cwd=project.root,
        env=os.environ | {"PYTHONPATH": str(project.root / "src")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(
            signal.SIGINT, signal.SIG_DFL
        ),  # also where the tests run in the background
    )


@pytest.mark.parametrize("how", ["SIGINT to all", "SIGKILL of snakemake"])
def test_an_interrupted_run_goes_on_by_the_same_command(clone, how):
    (clone.root / "scenes").mkdir()
    for name in ("one", "two"):
        (clone.root / "scenes" / f"{name}.yaml").write_text(SCENE)
    (clone.root / "mine.yaml").write_text("{name: mine, scenes: [one, two], scenes_folder: scenes}")
    started = start(clone, "--configfile", "mine.yaml", "--cores", "1")
    try:
        for _ in range(3000):
            if list(clone.root.glob("results/mine/simulations/*/mesh.msh")):
                break
            time.sleep(0.1)
        if how.startswith("SIGINT"):
            os.killpg(started.pid, signal.SIGINT)
        else:
            started.kill()
        started.wait()
    finally:
        if started.poll() is None:
            os.killpg(started.pid, signal.SIGKILL)
    histories = [
        clone.root / f"results/mine/simulations/{name}/history.nc" for name in ("one", "two")
    ]
    assert not all(path.exists() for path in histories), "not interrupted"
    text = clone.run("--configfile", "mine.yaml")
    assert (
        all(path.exists() for path in histories)
        and (clone.root / "results/mine/tables/summary.csv").exists()
    )
    assert ("took over" in text) == how.startswith("SIGKILL")


KILLS = int(os.environ.get("FINGERPAD_KILLS", "2"))
"""Of the coarse workflow, all its processes at once; FINGERPAD_KILLS=50 for more."""
LATEST = 25.0
"""s after its start at which a run is killed, at most: Snakemake itself needs a few, a whole run
twice that.
"""
EXACT = {".csv", ".png", ".msh"}
"""Bytes that are the same whatever happens; a PDF has coordinates to the last digit, which
round-off may change.
"""


def products(root):
    """What the coarse workflow makes under final names, but logs and what tells of costs and
    times.
    """
    paths = (path for path in (root / "results/smoke").rglob("*") if path.is_file())
    found = {path.relative_to(root).as_posix(): path for path in paths}
    return {
        name: path
        for name, path in found.items()
        if "/logs/" not in name and not path.name.startswith(".snakemake")
    }


def same(path, other):
    """Are two results equal: bytes of pictures, tables and meshes, numbers of histories?"""
    if path.suffix in EXACT:
        return path.read_bytes() == other.read_bytes()
    if path.suffix == ".nc":
        one, two = read_history(path), read_history(other)
        names = {*one.variables, *two.variables}
        return all(
            np.array_equal(one[name].values, two[name].values, equal_nan=True) for name in names
        )
    return path.stat().st_size > 0


def test_a_workflow_killed_at_random_instants_ends_with_the_same_results(clone, finished):
    rng, expected, whole = random.Random(19), products(finished.root), 0
    for _ in range(KILLS):
        run = start(clone, *SMOKE)
        time.sleep(rng.uniform(0.2, LATEST))
        os.killpg(run.pid, signal.SIGKILL)
        run.wait()
        left = products(clone.root)
        half = [
            name
            for name, path in left.items()
            if name in expected and not same(path, expected[name])
        ]
        assert not half, f"under final names: {half}"
        if set(expected) <= set(left):  # it was through before: from nothing again
            whole += 1
            shutil.rmtree(clone.root / "results")
    clone.run(*SMOKE)
    made = products(clone.root)
    assert set(made) == set(expected), set(made) ^ set(expected)
    assert all(same(path, expected[name]) for name, path in made.items())
    assert clone.planned(*SMOKE) == {} and whole < KILLS


def test_a_failed_job_says_why_where_it_failed(clone):
    (clone.root / "forces").mkdir()
    header = "subject,indenter,depth_mm,speed_mm_per_s,force_N,source,how_obtained"
    (clone.root / "forces" / "mine.csv").write_text(f"{header}\nme,flat plate,1,0,0.2,me,scale\n")
    (clone.root / "mine.yaml").write_text(
        "{name: mine, scenes: [calibration_plate], calibration_scenes: [calibration_plate], "
        "subjects: forces, accuracy: draft}"
    )
    done = clone.snakemake("--configfile", "mine.yaml", "--", "calibration")
    assert done.returncode != 0
    said = [line for line in done.stderr.splitlines() if line.startswith("calibrate: ")]
    assert len(said) == 1 and "subject 'me' has one steady force" in said[0]


def test_measured_files_are_checked_before_anything_is_simulated(clone):
    (clone.root / "forces").mkdir()
    (clone.root / "forces" / "mine.csv").write_text("subject,depth\nme,1\n")
    (clone.root / "mine.yaml").write_text(
        "{name: mine, scenes: [calibration_plate], subjects: forces, accuracy: draft}"
    )
    done = clone.snakemake("--configfile", "mine.yaml", "--", "calibration")
    assert (
        done.returncode == 2
        and "forces/mine.csv: has no column indenter, but subject, depth" in done.stderr
    )
    assert "Traceback" not in done.stderr and not (clone.root / "results").exists()


# -- the report and the archive of a run -----------------------------------------------------------

LISTEN = """<script>
window.problems = [];
const note = (event) => problems.push(String(event.message || event.target.src));
window.addEventListener("error", note, true);
console.error = (...words) => problems.push(words.join(" "));
</script>"""
LOOK = """<script>
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const framed = (uri) => new Promise((done) => {
  const frame = document.createElement("iframe");
  frame.style = "width: 900px; height: 700px; position: fixed; top: 0";
  frame.onload = () => done(frame);
  frame.src = uri;
  document.body.append(frame);
});
window.addEventListener("load", async () => {
  await wait(500);
  const graph = !!document.querySelector("div#rulegraph");
  const seen = {first: document.querySelector("#app").innerText, graph, rows: {}, pages: []};
  for (const category of Object.keys(categories)) {
    app.setView({navbarMode: "menu"});
    await wait(100);
    app.showCategory(category);
    await wait(100);
    const rows = [...document.querySelectorAll("tbody tr")];
    seen.rows[category] = rows.map((row) => row.innerText.trim());
  }
  for (const entry of Object.values(results)) {
    const frame = await framed(entry.data_uri), inside = frame.contentDocument;
    await wait(50);
    seen.pages.push({
      name: entry.name, title: inside.querySelector("h1").innerText,
      cells: inside.querySelectorAll("td").length,
      pictures: [...inside.images].map(
        (image) => [image.naturalWidth, image.getBoundingClientRect().right]),
      wide: inside.documentElement.scrollWidth, words: inside.body.innerText.length});
    frame.remove();
  }
  const told = document.createElement("pre");
  told.id = "seen";
  told.textContent = JSON.stringify({...seen, problems});
  document.body.append(told);
});
</script>"""


@pytest.fixture(scope="module")
def report(finished):
    """The folder of the report, unpacked."""
    finished.run(*SMOKE, "--", "report_pages")
    how = (
        "--report-stylesheet",
        "workflow/report/report.css",
        "--report-metadata",
        "workflow/report/metadata.yaml",
    )
    finished.run(*SMOKE, "--report", "results/report.zip", *how, "--", "all", "report_pages")
    with zipfile.ZipFile(finished.root / "results/report.zip") as packed:
        packed.extractall(finished.root / "results/unpacked")
    return finished.root / "results/unpacked/report"


def test_the_report_opens_in_a_browser_and_shows_everything_whole(report):
    """Driven in headless Chromium: words first, categories, every picture loaded and within its
    page, no error on the console.
    """
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no Chromium here (apt-get install chromium)")
    text = (report / "report.html").read_text(encoding="utf-8")
    probe = report / "probe.html"
    before, _, after = text.replace("<head>", f"<head>{LISTEN}", 1).rpartition("</body>")
    probe.write_text(f"{before}{LOOK}</body>{after}", encoding="utf-8")
    flags = (
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--allow-file-access-from-files",
        "--window-size=1280,900",
    )
    words = [browser, *flags, "--virtual-time-budget=60000", "--dump-dom", probe.as_uri()]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    (found,) = re.findall(r'<pre id="seen">(.*?)</pre>', done.stdout, re.S)
    seen = json.loads(found.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
    assert seen["problems"] == []
    assert (
        "What happens in the skin" in seen["first"]
        and "How to cite" in seen["first"]
        and not seen["graph"]
    )
    assert set(seen["rows"]) == {"Chapter 3", "Chapter 4", "Chapter 5", "Studies", "Tables"}
    assert [row.split()[1] for row in seen["rows"]["Chapter 4"]] == [
        "4-12",
        "4-14",
        "4-15",
        "4-16",
        "4-17",
    ]
    pages = {page["name"]: page for page in seen["pages"]}
    assert (
        pages["fig_4-12.html"]["title"].startswith("4-12: ") and pages["fig_4-12.html"]["cells"] > 0
    )
    assert (
        pages["thesis_comparison.html"]["cells"] > 1000
        and not pages["thesis_comparison.html"]["pictures"]
    )
    pictures = [picture for page in seen["pages"] for picture in page["pictures"]]
    assert len(pictures) >= 12 and all(width > 300 and right <= 900 for width, right in pictures)
    assert all(page["wide"] <= 900 and page["words"] > 100 for page in seen["pages"])


def test_the_archive_is_a_crate_in_which_everything_leads_somewhere(finished):
    """Every entity once, every reference to one, every file there, what each job and scene took."""
    made = finished.python("cysyk1999.workflow.archive", "config/smoke.yaml", "results/archive")
    assert made.returncode == 0, made.stderr
    crate = finished.root / "results/archive"
    graph = json.loads((crate / "ro-crate-metadata.json").read_text(encoding="utf-8"))["@graph"]
    known = {entity["@id"]: entity for entity in graph}
    assert len(known) == len(graph)
    named = {name for entity in graph for value in entity.values() for name in _references(value)}
    assert {name for name in named if "://" not in name} <= set(known)
    for name, entity in known.items():
        if {"File", "Dataset"} & set(np.atleast_1d(entity["@type"])) and name != "./":
            assert (crate / name).exists(), name
    parts = {*_references(known["./"]["hasPart"])}
    assert {"Snakefile", "config/smoke.yaml", "costs.csv"} < parts
    assert "results/smoke/figures/fig_4-12.png" in parts
    run = known["#run"]
    assert run["instrument"] == {"@id": "Snakefile"} and run["startTime"] < run["endTime"]
    drawn = known["#job-figures_4_12"]
    assert {"@id": "results/smoke/simulations/homogeneous_flat/"} in drawn["object"]
    assert {"@id": "results/smoke/figures/fig_4-12.csv"} in drawn["result"]
    costs = pd.read_csv(crate / "costs.csv")
    actions = {*_references(known["./"]["mentions"])}
    assert {f"#job-{job}" for job in costs["job"]} == actions - {"#run"}
    assert costs.set_index("scene").loc["simulations/homogeneous_flat", "process time (s)"] > 0


def _references(value):
    for each in value if isinstance(value, list) else [value]:
        if isinstance(each, dict) and set(each) == {"@id"}:
            yield each["@id"]


def test_there_is_nothing_to_archive_where_nothing_has_run(fresh):
    done = fresh.python("cysyk1999.workflow.archive", "config/smoke.yaml", "results/archive")
    assert (
        done.returncode == 2
        and len(done.stderr.splitlines()) == 1
        and "run the workflow first" in done.stderr
    )
    assert not (fresh.root / "results/archive").exists()


# -- the full configuration ------------------------------------------------------------------------


def test_snakemake_reruns_in_the_full_configuration_what_an_edit_can_change(clone):
    """Files of no content stand for all the results; what edits rerun is planned, not run."""
    for job in jobs_of(clone, "thesis"):
        for path in job.made:
            file = clone.root / path
            if file.name == "specimens":
                file.mkdir(parents=True, exist_ok=True)
            else:
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text("x")
    clone.run("--touch")
    assert clone.planned() == {}
    for paths, kinds in (
        (
            ("figures/chapter4.py", "claims/tables.py"),
            {"figures_4", "table_pictures", "tables", "catalogue"},
        ),
        (("figures/grammar.py",), {"figures_3", "figures_4", "figures_5"}),
        (  # which makes the verdicts of figures and of tables alike
            ("claims/comparison.py",),
            {"figures_3", "figures_4", "figures_5", "table_pictures", "tables", "catalogue"},
        ),
    ):
        with contextlib.ExitStack() as edits:
            for path in paths:
                edits.enter_context(clone.edited(f"src/cysyk1999/{path}"))
            jobs = clone.planned()
        assert {
            name if name == "tables" else "_".join(name.split("_")[:2]) for name in jobs
        } == kinds, paths
    with clone.edited("src/fingerpad/mechanics/kernels.py"):
        jobs = clone.planned()
    assert {name for name in jobs if name.startswith("simulate_")} > {
        "simulate_ramp40",
        "simulate_stroke_1",
    }
