"""The job that simulates scenes: what is beside a history is what was solved."""

from types import SimpleNamespace

import numpy as np
import pytest

from cysyk1999.workflow.simulate import simulate as run
from fingerpad.results import read_history
from fingerpad.specimen import read_pad_mesh

pytestmark = pytest.mark.workflow


def test_companions_share_a_mesh_that_is_beside_each(tmp_path):
    scene = tmp_path / "press.yaml"
    scene.write_text(
        "stimulus: {shape: cylinder, curvature: 210 1/m}\n"
        "motion: [{press_to_force: 20 gf, rate: 40 gf/s}, {hold: 0.5 s}]\naccuracy: draft\n"
    )
    histories = [tmp_path / name / "history.nc" for name in ("own", "coarse_mesh", "coarse")]
    for path in histories:
        path.parent.mkdir()
    three = {
        "scenes": [scene] * 3,
        "accuracies": ["as_stated"] * 3,
        "strides": ["0", "1", "2"],
        "histories": histories,
    }
    run(SimpleNamespace(**three))
    own, mesh, both = (path.with_name("mesh.msh") for path in histories)
    assert mesh.read_bytes() == both.read_bytes() != own.read_bytes()
    for file, path in zip((own, both), (histories[0], histories[2]), strict=True):
        skin = np.unique(read_pad_mesh(file).curves["skin"])
        assert read_history(path).sizes["skin_node"] == len(skin)
