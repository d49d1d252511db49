"""Random scenes, sweeps and meshes through the command line: planned always, run coarsely where
that is cheap, and judged.

``make soak N=2000 SEED=1 MINUTES=10``. Whatever is drawn, the exit code is 0, 2 or 3, an error is
one line, and a result balances: forces, energy, gaps and pressures. What does not is shrunk to its
smallest and printed as YAML, ready for the catalogue of hard cases.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import os
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis.errors import Flaky

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.common.plans import OutOfTime, time_limit
from fingerpad.cli import main
from random_scenes import Drawn, anything, write_files

CHEAP = 2.0
"""s, of a run as its plan predicts it: what costs more is planned only."""
SLOWEST = 60.0
"""s of process time after which a drawn scene is let go: counted, not judged."""
SHRINKING = 60.0
"""s of process time spent on making a failure smaller."""
LATE = "not done in a minute"
PADDED = ("snapshot_indenter", "impulse_time")
"""Variables that are NaN by design: where there is no stimulus, and after the last impulse."""
RUN = ["completed", "stopped with its diagnosis", LATE]
"""What becomes of a document that is run."""
COLUMNS = ["drawn", "refused in one line", "planned", "run", *RUN, "failed"]


class Failed(AssertionError):
    """What is wrong, of which document."""


def require(so: bool, what: str) -> None:
    if not so:
        raise Failed(what)


# --- commands -------------------------------------------------------------------------------------


def command(*words: str | Path) -> tuple[int, str, str]:
    """Exit code and what is said by `fingerpad`, in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(word) for word in words])
    return code, out.getvalue(), err.getvalue()


def said(words: tuple, code: int, err: str) -> None:
    """Is what a command said of a failure one line, with an exit code of the interface? A run that
    completes in doubt says that too.
    """
    require(code in (0, 2, 3), f"{words[0]}: exit code {code}: {err.strip()}")
    lines = sum(not line.startswith("fingerpad: doubt: ") for line in err.splitlines())
    require(lines == (code != 0), f"{words[0]}: exit code {code} with {lines} lines: {err[:300]}")


def tried(drawn: Drawn, folder: Path) -> str:
    """What became of a document, a name of COLUMNS; raises `Failed`."""
    file, out = folder / "drawn.yaml", folder / "out"
    file.write_text(drawn.text, encoding="utf-8")
    before = sorted(path.name for path in folder.iterdir())
    words = ("plan", file, "--json", "--accuracy", "draft")
    code, text, err = command(*words)
    said(words, code, err)
    require(sorted(path.name for path in folder.iterdir()) == before, "a plan writes something")
    if code:
        return "refused in one line"
    plan = json.loads(text)
    cost = plan["predicted_cost_s"]
    require(np.isfinite(cost) and cost > 0, f"predicted cost {cost}")
    if "sweep" in plan or cost > CHEAP:
        return "planned"
    words = ("run", file, "--out", out, "--quiet", "--force", "--accuracy", "draft")
    code, _, err = command(*words)
    said(words, code, err)
    require(not list(out.glob(".fingerpad-*")), "a scratch folder is left")
    if code == 3:
        require("allowed" in err or "try" in err, f"no advice: {err}")
        return "stopped with its diagnosis"
    if code == 2:  # of what turns out to be wrong only when it is meshed or set up
        return "refused in one line"
    judged(out)
    return "completed"


def judged(out: Path) -> None:
    """Does a result balance?"""
    from fingerpad.planning.plan_data import read_plan
    from fingerpad.results import read_history

    summary = json.loads((out / "summary.json").read_text())
    run, beyond = summary["run"], {}
    with read_history(out / "history.nc") as history:
        for name, each in history.variables.items():
            if each.dtype.kind == "f" and name not in PADDED:
                require(bool(np.isfinite(each.values).all()), f"{name} is not finite")
        scene = json.loads(history.attrs["scene"])
        work = np.abs(history.external_work.values).max()
        kept = history.stored_energy + history.dissipated_energy + history.frictional_dissipation
        pressure, force = history.contact_pressure.values, history.force.values
        beyond["det F, negative"] = -run["min_detF"], -1e-12
        beyond["estimated error, negative"] = -run["estimated_error"], 0
        beyond["complementarity"] = run["complementarity_error"], 1e-3
        beyond["the contact pulls, Pa"] = -pressure.min(), 1e-9 * max(pressure.max(), 1)
        fewest = min(
            np.count_nonzero(history.leg.values[1:] == k)
            for k, leg in enumerate(scene["motion"])
            if {"press_to_force", "press_to_depth", "table"} & leg.keys()
        )
        # work is summed by trapezoids, which are wrong by less than 1/n^2 of it in n increments of
        # a stiffening pad
        allowed = max(0.03, run["estimated_error"]) + 1 / fewest**2
        lost = float(np.abs(history.external_work - kept).max()) / max(work, 1e-300)
        beyond[f"energy out of balance in {fewest} steps"] = lost, allowed
        if scene["stimulus"]["shape"] == "flat":
            rubbed = np.abs(history.tangential_force.values) - scene["friction"] * force
            beyond["more friction than there is, N/m"] = rubbed.max(), 1e-6 * max(force.max(), 1e-9)
    within = read_plan(out).newton_tolerance or 1e-4
    length = scene["specimen"]["contact_length"]
    force = "force_N" if scene.get("kinematics") == "axisymmetric" else "force_N_per_m"
    for leg, end in zip(scene["motion"], summary["legs"], strict=True):
        for key, reached, scale, most in (
            ("press_to_force", force, 1 / length, within),
            ("press_to_depth", "depth_mm", 1e3, 1e-4),
        ):
            if leg.get(key):
                off = abs(end[reached] / (scale * leg[key]) - 1)
                beyond[f"{reached} {end[reached]:.6g}, off by"] = off, most
    for what, (value, most) in beyond.items():
        require(value <= most, f"{what}: {value:.3g} of at most {most:.3g}")


# --- many of them ---------------------------------------------------------------------------------


@dataclass
class Soak:
    """What became of all that was drawn: counts by kind and outcome; the smallest document that
    failed, and why.
    """

    counts: dict[str, Counter] = field(default_factory=dict)
    failure: tuple[Drawn, str] | None = None
    seconds: float = 0.0

    def count(self, kind: str, outcome: str) -> None:
        run = int(outcome in RUN)
        known = {"drawn": 1, outcome: 1, "run": run}
        known["planned"] = run or int(outcome == "planned")
        self.counts.setdefault(kind, Counter()).update(known)

    def table(self) -> pd.DataFrame:
        """A row a kind, and their sum."""
        rows = pd.DataFrame(self.counts, COLUMNS).T.fillna(0).astype(int).sort_index()
        rows.loc["all"] = rows.sum()
        return rows.rename_axis("what").reset_index()


def soak(count: int, start: int, seconds: float) -> Soak:
    """Draw and try up to `count` documents for up to some process time; stops at the first failure,
    made smaller.
    """
    found, begun = Soak(), time.process_time()
    ends = begun + seconds

    @seed(start)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
        report_multiple_bugs=False,
        print_blob=False,
    )
    @given(drawn=anything())
    def each(drawn: Drawn) -> None:
        nonlocal ends
        if time.process_time() > ends:
            return
        try:
            with time_limit(SLOWEST):
                outcome = tried(drawn, folder)
        except OutOfTime:
            outcome = LATE
        except Exception as error:
            if found.failure is None:
                ends = time.process_time() + SHRINKING
                found.count(drawn.kind, "failed")
            if found.failure is None or len(drawn.text) < len(found.failure[0].text):
                found.failure = drawn, f"{type(error).__name__}: {error}"
            raise
        if found.failure is None:
            found.count(drawn.kind, outcome)

    with tempfile.TemporaryDirectory(prefix="soak-") as name:
        folder = Path(name)
        write_files(folder)
        with contextlib.suppress(Exception, Flaky), contextlib.redirect_stdout(io.StringIO()):
            each()
    found.seconds = time.process_time() - begun
    return found


def soaked(words: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=1000, help="at most so many")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, default=10.0, help="of process time, at most")
    parser.add_argument(
        "--files",
        action="store_true",
        help="damaged files in place of random scenes (tests/soak_files.py)",
    )
    parser.add_argument(
        "--table", type=Path, help="where the counts are published, as CSV and Markdown"
    )
    options = parser.parse_args(words)
    if options.files:
        from soak_files import soak_files

        outcomes, failure = soak_files(options.scenes, options.seed, 60 * options.minutes)
        print(
            f"{sum(outcomes.values())} damaged files:",
            *(f"{n:6d} {what}" for what, n in sorted(outcomes.items())),
            sep="\n",
        )
        print(f"failed: {failure}" if failure else "none failed")
        return int(bool(failure))
    found = soak(options.scenes, options.seed, 60 * options.minutes)
    table = found.table()
    table.attrs["summary"] = (
        f"{table['drawn'].iloc[-1]} scenes, sweeps and broken documents drawn at random "
        f"(seed {options.seed}) "
        f"in {found.seconds / 60:.1f} minutes of process time: all planned, and run coarsely where "
        "a run is predicted to take two seconds at most."
    )
    print(table.attrs["summary"], table.to_string(index=False), sep="\n")
    if found.failure:
        drawn, why = found.failure
        print(f"\nfailed: {why}\n\n{drawn.text}")
        return 1
    if options.table:
        publish_table(table, options.table)
    return 0


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.exit(soaked())
