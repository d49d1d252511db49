"""A sweep through sbatch on a real slurmctld, slurmd and munge, with a power cut in the middle: the
numbers of the local run.
"""

import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import pandas as pd
import pytest
import yaml
from slurm import Cluster, missing

from fingerpad.sweeps.engine import read_layout

ROOT = Path(__file__).resolve().parents[2]
LACKING = missing() or (
    "" if find_spec("snakemake_executor_plugin_slurm") else "no snakemake-executor-plugin-slurm"
)
pytestmark = [
    pytest.mark.cluster,
    pytest.mark.slow,
    pytest.mark.skipif(bool(LACKING), reason=LACKING),
]

SWEEP = """
scene: {stimulus: {shape: cylinder, curvature: 210 1/m}, motion: [{press_to_force: 20 gf}]}
over:
  stimulus.curvature: {range: ["50 1/m", "800 1/m"], count: 10, spacing: logarithmic}
  motion[0].press_to_force: {range: ["2 gf", "40 gf"], count: 6, spacing: logarithmic}
accuracy: draft
"""


def profile(folder: Path) -> Path:
    """The committed profile, filled in for this cluster, which keeps no accounts."""
    text = (ROOT / "workflow" / "profiles" / "slurm" / "config.yaml").read_text()
    filled = yaml.safe_load(
        text.replace("YOUR_ACCOUNT", "nobody").replace("YOUR_PARTITION", "touch")
    )
    more = {
        "slurm-status-command": "squeue",
        "slurm-init-seconds-before-status-checks": 5,
        "seconds-between-status-checks": 5,
    }
    folder.mkdir()
    (folder / "config.yaml").write_text(yaml.safe_dump(filled | more))
    return folder


def start(file: Path, out: Path, *more: str) -> subprocess.Popen:
    words = [sys.executable, "-m", "fingerpad", "sweep", str(file), "--out", str(out), *more]
    return subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL
    )


def finished(process: subprocess.Popen) -> str:
    said, _ = process.communicate(timeout=1500)
    assert process.returncode == 0, said
    return said


def test_sixty_scenes_through_sbatch_with_a_power_cut_are_those_of_the_local_run(tmp_path):
    (tmp_path / "sixty.yaml").write_text(SWEEP)
    out = tmp_path / "cluster"
    with Cluster(tmp_path / "slurm") as cluster:
        run = start(
            tmp_path / "sixty.yaml",
            out,
            "--cores",
            "2",
            "--profile",
            str(profile(tmp_path / "profile")),
        )
        done = 0
        until = time.monotonic() + 900
        while done < 5 and run.poll() is None and time.monotonic() < until:
            time.sleep(0.2)
            if (out / "sweep.json").exists():
                done = read_layout(out).done()[0]
        assert 5 <= done < 55 and run.poll() is None, (
            run.communicate()[0] if run.poll() is not None else done
        )
        cluster.kill_node()
        time.sleep(2)
        cluster.start_node()
        said = finished(run)
        log = (out / "logs" / "snakemake.log").read_text()
    assert "60 scenes (all run)" in said and "SLURM jobid" in log
    finished(start(tmp_path / "sixty.yaml", tmp_path / "local", "--cores", "2"))
    there, here = (
        pd.read_csv(folder / "sweep.csv").drop(columns="cpu_s (s)")
        for folder in (out, tmp_path / "local")
    )
    assert len(there) == 60 and not there.failed.any()
    pd.testing.assert_frame_equal(there, here, check_exact=True)
