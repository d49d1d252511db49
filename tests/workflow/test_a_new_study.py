"""The recipe of a study in CONTRIBUTING.md works as it is written there."""

import re
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr
import yaml

import cysyk1999.studies
from cysyk1999 import job
from cysyk1999.config import read_config
from cysyk1999.project import Project

pytestmark = pytest.mark.workflow

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def studies(tmp_path):
    """Studies may be in a folder of the test's, and are forgotten after it."""
    with pytest.MonkeyPatch.context() as patch:
        found = [*cysyk1999.studies.__path__, str(tmp_path)]
        patch.setattr(cysyk1999.studies, "__path__", found)
        patch.setattr(job, "_PARTS", dict(job.parts()))
        job.parts.cache_clear()
        yield tmp_path
    job.parts.cache_clear()


def test_a_study_is_one_folder_and_no_list(studies):
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    folder = studies / "deepest"
    folder.mkdir()
    (folder / "__init__.py").touch()
    for name in ("run.py", "jobs.py"):
        (code,) = re.findall(rf"```python\n# {name}\n(.*?)```", recipe, re.S)
        (folder / name).write_text(code)
    document = yaml.safe_load((ROOT / "config/thesis.yaml").read_text())
    project = Project(read_config(document, "thesis.yaml"), "thesis.yaml", ROOT)
    (task,) = project.part("deepest")
    assert "deepest" in [target.name for target in project.part_targets()]
    assert project.targets("deepest") == ["figures/tables/deepest.csv"]
    history = studies / "history.nc"
    xr.Dataset({"indentation_depth": ("time", [0.0, 2e-3, 1e-3])}).to_netcdf(history)

    class Words:
        histories, table = [str(history)], [str(studies / "deepest.csv")]

    task.do(Words)
    assert pd.read_csv(studies / "deepest.csv")["deepest (mm)"].tolist() == [2.0]
