"""A Slurm cluster of this one machine: munged, slurmctld and slurmd, started for a test and gone
after it.

Needs root and Debian's packages slurm-wlm and munge. Its configuration has to be
/etc/slurm/slurm.conf: Snakemake's executor clears the variable that could name another. What was
there is put back.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import psutil

CONFIGURATION = Path("/etc/slurm/slurm.conf")
DAEMONS = ("munged", "slurmctld", "slurmd")

TEXT = """\
ClusterName=fingerpad
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=15
KillWait=5
SchedulerParameters=sched_interval=5
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=4000 State=UNKNOWN
PartitionName=touch Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def missing() -> str:
    """What there is not, of what this needs; "" if all is there."""
    lacking = [
        name
        for name in (*DAEMONS, "sbatch", "squeue")
        if not shutil.which(name, path="/usr/sbin:/usr/bin:/sbin:/bin")
    ]
    if lacking:
        return f"no {', '.join(lacking)}: apt-get install slurm-wlm munge"
    return "" if os.geteuid() == 0 else "only root can start a cluster"


class Cluster:
    """The daemons, as a context."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._daemons: dict[str, subprocess.Popen] = {}

    def __enter__(self) -> Cluster:
        for name in ("state", "spool"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        self._before = CONFIGURATION.read_bytes() if CONFIGURATION.exists() else None
        CONFIGURATION.parent.mkdir(exist_ok=True)
        CONFIGURATION.write_text(
            TEXT.format(host=os.uname().nodename.partition(".")[0], folder=self.folder)
        )
        try:
            for place in ("/run/munge", "/var/lib/munge", "/var/log/munge", "/etc/munge"):
                Path(place).mkdir(exist_ok=True)
                shutil.chown(place, "munge", "munge")
            self._start(
                "munged", "runuser", "-u", "munge", "--", "munged", "--foreground", "--force"
            )
            self._start("slurmctld", "slurmctld", "-D", "-c")
            self.start_node()
            self._wait("idle")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(OSError, subprocess.SubprocessError):
            jobs = subprocess.run(
                ["squeue", "-h", "-o", "%i"], capture_output=True, text=True, timeout=20
            ).stdout.split()
            subprocess.run(["scancel", "--full", *jobs], timeout=20, check=False) if jobs else None
        self.kill_node()
        for process in reversed(list(self._daemons.values())):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        if self._before is None:
            CONFIGURATION.unlink(missing_ok=True)
        else:
            CONFIGURATION.write_bytes(self._before)

    def _start(self, name: str, *words: str) -> None:
        with (self.folder / f"{name}.out").open("ab") as out:
            self._daemons[name] = subprocess.Popen(
                words,
                stdout=out,
                stderr=out,
                stdin=subprocess.DEVNULL,
                start_new_session=True,
                env=os.environ | {"PATH": f"{os.environ['PATH']}:/usr/sbin:/sbin"},
            )

    def _wait(self, state: str, seconds: float = 90) -> None:
        until = time.monotonic() + seconds
        while (
            said := subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True)
        ).stdout.strip() != state:
            if time.monotonic() > until:
                logs = "\n".join(
                    log.read_text(errors="replace")[-2000:]
                    for log in self.folder.glob("*.[lo][ou][gt]")
                )
                raise TimeoutError(
                    f"the node is {said.stdout.strip() or said.stderr.strip()}, not {state}\n{logs}"
                )
            time.sleep(1)

    def start_node(self) -> None:
        """Start the node's slurmd."""
        self._start("slurmd", "slurmd", "-D")

    def kill_node(self) -> None:
        """Kill the node as a power cut would: slurmd, and whatever runs under it."""
        if daemon := self._daemons.pop("slurmd", None):
            steps = [step for step in psutil.process_iter() if _is_step(step)]
            for process in (psutil.Process(daemon.pid), *steps):
                with contextlib.suppress(psutil.NoSuchProcess):
                    for each in [*process.children(recursive=True), process]:
                        each.kill()
            daemon.wait()


def _is_step(process: psutil.Process) -> bool:
    """Whether a process holds a step of a job of this cluster's."""
    try:
        return " ".join(process.cmdline()).startswith("slurmstepd: [")
    except psutil.Error:
        return False
