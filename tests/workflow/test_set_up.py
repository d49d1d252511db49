"""The set-up refuses what it cannot do before it makes or downloads anything."""

import os
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.workflow
ROOT = Path(__file__).resolve().parents[2]
PYTHON = """#!/bin/sh
echo "$*" >> calls
case "$*" in
*version_info*) exit {old} ;;
-) cat > /dev/null; echo {missing} ;;
*-m*venv*) exit 7 ;;
esac
"""


@pytest.fixture
def set_up(tmp_path):
    """Run the set-up as an ordinary user, with a Python that only notes how it is called."""

    def run(old=0, missing=""):
        programs = {"python": PYTHON.format(old=old, missing=missing), "id": "#!/bin/sh\necho 1000"}
        for name, text in programs.items():
            (tmp_path / name).write_text(text)
            (tmp_path / name).chmod(0o755)
        (tmp_path / "workflow").symlink_to(ROOT / "workflow")
        done = subprocess.run(
            ["sh", "workflow/scripts/setup.sh", "./python", ".venv"],
            cwd=tmp_path,
            env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
            capture_output=True,
            text=True,
        )
        return done, (tmp_path / "calls").read_text()

    return run


def test_an_old_python_is_refused_in_one_line(set_up):
    done, calls = set_up(old=1)
    assert done.returncode == 1 and "-m venv" not in calls
    assert done.stderr.count("\n") == 1 and "PYTHON=python3.12" in done.stderr


def test_a_missing_library_is_named_with_the_line_to_copy(set_up):
    done, calls = set_up(missing="libGLU.so.1")
    assert done.returncode == 1 and "-m venv" not in calls
    assert "libGLU.so.1" in done.stderr and "sudo apt-get" in done.stderr


def test_the_environment_is_made_where_nothing_is_missing(set_up):
    done, calls = set_up()
    assert done.returncode == 7 and calls.splitlines()[-1] == "-m venv .venv"
