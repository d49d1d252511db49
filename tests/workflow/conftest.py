"""A copy of the project's tree in which the workflow is run, and what a dry run would do in it."""

import os
import re
import shutil
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TREE = (
    ".test",
    "CITATION.cff",
    "Snakefile",
    "config",
    "profiles",
    "pyproject.toml",
    "requirements.lock",
    "src",
    "workflow",
)
COMPILED_TOO = shutil.ignore_patterns(
    "*.egg-info", "*.tmp.*", "*.pyc.*"
)  # all but what is being written
OF_A_NOTEBOOK = {"MPLBACKEND": "module://a_backend_that_is_not_here"}
"""What a workflow that is started from a notebook finds in its environment."""
QUIET = ("--quiet", "host")
SMOKE = ("--configfile", "config/smoke.yaml")


@dataclass
class Project:
    """A copy of the tree. `smoke` runs and dry runs use the coarse configuration unless told
    otherwise.
    """

    root: Path
    environment: dict[str, str] = field(default_factory=dict)

    @classmethod
    def copy(cls, root: Path) -> "Project":
        for name in TREE:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, root / name, ignore=COMPILED_TOO)
            else:
                shutil.copy(source, root / name)
        return cls(root)

    def snakemake(
        self, *arguments: str, folder: Path | None = None, **environment: str
    ) -> subprocess.CompletedProcess:
        """Run Snakemake in the tree, or in another folder."""
        path = os.pathsep.join([str(self.root / "src"), str(Path(__file__).parent / "trace")])
        return subprocess.run(
            [sys.executable, "-m", "snakemake", *QUIET, *arguments],
            cwd=folder or self.root,
            env=os.environ | OF_A_NOTEBOOK | {"PYTHONPATH": path} | self.environment | environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )

    def python(self, module: str, *arguments: str) -> subprocess.CompletedProcess:
        """Run a module of the tree's package in it."""
        environment = os.environ | {"PYTHONPATH": str(self.root / "src")} | self.environment
        words = [sys.executable, "-m", module, *arguments]
        return subprocess.run(words, cwd=self.root, env=environment, capture_output=True, text=True)

    def run(self, *arguments: str, folder: Path | None = None, **environment: str) -> str:
        """Run the workflow; its whole output."""
        done = self.snakemake(*arguments, folder=folder, **environment)
        logs = "\n".join(
            f"{log}:\n{log.read_text()}" for log in self.root.glob("results/*/logs/**/*.log")
        )
        assert done.returncode == 0, f"{done.stdout}\n{done.stderr}\n{logs}"
        return done.stdout + done.stderr

    def planned(self, *arguments: str, folder: Path | None = None) -> dict[str, set[str]]:
        """What a dry run would make: rule -> output files; targets without files are left out."""
        return self.jobs_in(self.run("--dry-run", *arguments, folder=folder))

    @staticmethod
    def jobs_in(text: str) -> dict[str, set[str]]:
        """Jobs that a dry run has listed: rule -> output files."""
        jobs: dict[str, set[str]] = {}
        rule = ""
        for line in text.splitlines():
            if start := re.match(r"(?:local)?rule (\w+):", line):
                rule = start[1]
            elif outputs := re.match(r"    output: (.*)", line):
                names = (re.sub(r" \(.*?\)$", "", name) for name in outputs[1].split(", "))
                jobs.setdefault(rule, set()).update(names)
        return jobs

    @contextmanager
    def edited(self, path: str, addition: str = "\n# edited\n"):
        """Append to a file, and put it back as it was in the end, its date too: what was touched
        only is known by its date.
        """
        file = self.root / path
        before, age = file.read_bytes(), file.stat()
        file.write_bytes(before + addition.encode())
        try:
            yield
        finally:
            file.write_bytes(before)
            os.utime(file, ns=(age.st_atime_ns, age.st_mtime_ns))


@pytest.fixture
def clone(tmp_path) -> Project:
    """A tree in which nothing has run."""
    return Project.copy(tmp_path)


@pytest.fixture(scope="session")
def fresh(tmp_path_factory) -> Project:
    """The same for all tests that only look."""
    return Project.copy(tmp_path_factory.mktemp("fresh"))


@pytest.fixture(scope="session")
def finished(tmp_path_factory) -> Project:
    """A tree in which the coarse configuration has run once, with every opened file recorded."""
    project = Project.copy(tmp_path_factory.mktemp("finished"))
    project.traces = tmp_path_factory.mktemp("traces")
    project.run(*SMOKE, TRACE_DIRECTORY=str(project.traces), TRACE_ROOT=str(project.root))
    return project
