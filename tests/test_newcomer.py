"""What newcomers try first, and what they are told."""

import numpy as np
import pytest

import fingerpad
from fingerpad.cli import main
from fingerpad.results import ResultError, read_history, summary, write_history

pytestmark = pytest.mark.unit

SCENE = """stimulus: {shape: cylinder, curvature: "400 1/m"}
motion: [{press_to_force: "20 gf", rate: "40 gf/s"}, {hold: "0.2 s"}]
accuracy: {skin_edge: "0.8 mm", steps: 4}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


def test_a_history_is_read_by_its_folder_and_has_one_number_for_the_error(folder, capsys):
    assert main(["run", "scene.yaml", "--out", "out"]) == 0
    history = read_history("out")
    error = history.attrs["estimated_error"]
    assert history.equals(read_history("out/history.nc"))
    assert f"error about {100 * error:.2g} %" in capsys.readouterr().out
    assert summary(history)["run"]["estimated_error"] == error
    (folder / "empty").mkdir()
    with pytest.raises(FileNotFoundError):
        read_history("empty")
    with pytest.raises(ResultError, match="no NetCDF file"):
        read_history("scene.yaml")


def test_kinds_of_receptor_by_any_of_their_names(folder):
    history = fingerpad.simulate("scene.yaml")
    one = fingerpad.respond(history, "SA-I")
    assert one.equals(fingerpad.respond(history)) and one.afferent.values.tolist() == [
        "slowly_adapting"
    ]
    assert fingerpad.respond(history, ["RA"]).equals(fingerpad.respond(history, "rapidly_adapting"))
    with pytest.raises(ValueError, match="no afferent called 'PC'; known: slowly_adapting"):
        fingerpad.respond(history, "PC")
    with pytest.raises(
        TypeError, match="a history is what simulate or read_history returns, not str 'scene.yaml'"
    ):
        fingerpad.respond("scene.yaml")


def test_width_of_the_contact_and_of_what_touches(tmp_path):
    """Over a texture the contact has gaps: its width is from outermost to outermost, what touches
    is a share of it.
    """
    x = np.arange(-12, 12.001, 0.01)
    profile = np.column_stack([x, 0.075 * (1 - np.cos(2 * np.pi * x / 1.6))])
    np.savetxt(tmp_path / "p.csv", profile, delimiter=",", header="x (mm),y (mm)", comments="")
    scene = {
        "stimulus": {"shape": "sampled", "csv": str(tmp_path / "p.csv")},
        "motion": [{"press_to_force": "10 gf"}],
    }
    for symmetry in ("on", "off"):
        history = fingerpad.simulate(scene | {"effects": {"symmetry": symmetry}})
        end = summary(history)["legs"][-1]
        assert end["contact_width_mm"] == pytest.approx(3.41, abs=0.05)
        assert end["touching_width_mm"] == pytest.approx(1.12, abs=0.05)
    smooth = fingerpad.simulate(
        {"stimulus": {"shape": "cylinder", "curvature": "100 1/m"}, "motion": scene["motion"]}
    )
    np.testing.assert_allclose(smooth.touching_width, smooth.contact_width)
    write_history(history, tmp_path / "h.nc")
    assert "touching_width" in read_history(tmp_path / "h.nc")
