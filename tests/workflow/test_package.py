"""The package as `pip install` makes it from its source distribution, away from the source tree."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).resolve().parents[2]
PARTS = ("config", "src", "workflow", "LICENSE", "README.md", "pyproject.toml", "setup.py")
PARTS += ("MANIFEST.in",)


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """The folder that a wheel was installed into, built from the source distribution of a copy of
    the tree.
    """
    tree, target = tmp_path_factory.mktemp("tree"), tmp_path_factory.mktemp("installed")
    for name in PARTS:
        if (ROOT / name).is_dir():
            shutil.copytree(
                ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
            )
        else:
            shutil.copy(ROOT / name, tree / name)
    code = "import sys; from setuptools.build_meta import build_sdist; build_sdist(sys.argv[1])"
    made = tmp_path_factory.mktemp("made")
    subprocess.run([sys.executable, "-c", code, made], cwd=tree, check=True, capture_output=True)
    shutil.rmtree(tree)
    (archive,) = made.iterdir()
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-index",
    ]
    subprocess.run(
        [*pip, "--no-build-isolation", "--no-deps", "--target", target, archive],
        check=True,
        capture_output=True,
    )
    return target


@pytest.fixture
def elsewhere(installed, tmp_path):
    """Run Python in a folder of its own, where nothing of the source tree can be imported or
    found.
    """

    def run(*arguments: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, *arguments],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(installed)},
            capture_output=True,
            text=True,
        )

    return run


def test_the_package_is_the_installed_one_with_the_specimens_of_config(installed, elsewhere):
    found = elsewhere(
        "-c", "import fingerpad.files; print(fingerpad.__file__); print(fingerpad.files.BUILT_IN)"
    )
    module, built_in = map(Path, found.stdout.split())
    assert module.is_relative_to(installed) and built_in.is_relative_to(installed)
    committed = {
        path.name: path.read_bytes() for path in (ROOT / "config" / "specimens").glob("*.yaml")
    }
    assert {
        path.name: path.read_bytes() for path in (built_in / "specimens").iterdir()
    } == committed
    rules = Path("rules", "sweeps.smk")
    assert (built_in / rules.name).read_bytes() == (ROOT / "workflow" / rules).read_bytes()


@pytest.mark.slow
def test_a_scene_runs_with_the_built_in_specimens_from_any_folder(elsewhere, tmp_path):
    lines = (
        "specimen: {layers: calibrated_mean, ridges: inner}",
        "stimulus: {shape: flat}",
        "motion: [{press_to_force: 5 gf}]",
        "accuracy: {skin_edge: 1 mm, steps: 2}",
    )
    (tmp_path / "mine.yaml").write_text("\n".join(lines))
    done = elsewhere("-m", "fingerpad", "run", "mine.yaml", "--out", "results")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "results").iterdir()} == {
        "history.nc",
        "plan.json",
        "summary.json",
    }


def test_a_specimen_of_ones_own_is_found_beside_the_built_in_ones(elsewhere, tmp_path):
    (tmp_path / "config" / "specimens").mkdir(parents=True)
    own = tmp_path / "config" / "specimens" / "soft.yaml"
    own.write_text(
        "layers:\n"
        + "".join(f"  {name}: {{youngs_modulus: 10 kPa, poisson_ratio: 0.4}}\n" for name in LAYERS)
    )
    (tmp_path / "mine.yaml").write_text(
        "specimen: {layers: soft}\nstimulus: {shape: flat}\nmotion: [{press_to_force: 5 gf}]\n"
    )
    code = (
        "import fingerpad; "
        "print(fingerpad.load_scene('mine.yaml').specimen.layers.fat.youngs_modulus)"
    )
    assert float(elsewhere("-c", code).stdout) == pytest.approx(1e4)
    own.unlink()
    assert "calibrated_mean" in elsewhere("-c", code).stderr.splitlines()[-1]


LAYERS = ("epidermis", "dermis", "fat")


def test_the_conda_recipe_names_the_package_s_own_version_and_libraries():
    recipe = yaml.safe_load((ROOT / "conda" / "recipe.yaml").read_text())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert recipe["context"]["version"] == project["version"]
    needed = {
        line.replace(" ", "").removeprefix("python-") for line in recipe["requirements"]["run"]
    }
    python = "python" + project["requires-python"]
    assert needed == {python, *project["dependencies"]}
