"""The recipe for a figure, followed: one that is defined here only, from runs that are simulated to
the picture and its data.
"""

from pathlib import Path

import pytest

from cysyk1999.figures.grammar import Figure, Lines, Panels
from cysyk1999.measures.errors import PARTS
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import FORCE, TIME, Q
from cysyk1999.measures.runs import Runs
from cysyk1999.publishing.tables import read_frame
from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference
from drawn import REFERENCE
from fingerpad import load_scene, simulate

pytestmark = pytest.mark.slow

SUNK = Q(
    "sunk",
    "mm",
    "skin sunk by (mm)",
    lambda h: -1e3 * h["skin_displacement_y"].values.min(axis=1),
    tolerance=1e-3,
)
TWO = Runs("series", {"flat plate": "flat", "2.5 mm cylinder": "round"})
NEW = Figure(
    "6-1",
    "How far two surfaces sink into the skin",
    TWO,
    TIME,
    (SUNK, FORCE),
    {TIME: "T103"},
    Panels(
        3.6,
        fill=Lines(looks={FORCE: {"ls": ":"}}),
        set={"ylabel": "sunk (mm), force (gf)"},
        legend={"loc": "upper left"},
    ),
)


def _simulated(folder: Path, name: str, stimulus: dict, edge: str, steps: int) -> Path:
    scene = {"stimulus": stimulus, "motion": [{"press_to_force": "5 gf", "rate": "40 gf/s"}]}
    history = simulate(load_scene(scene | {"accuracy": {"skin_edge": edge, "steps": steps}}, name))
    path = folder / name / "history.nc"
    path.parent.mkdir(parents=True)
    history.to_netcdf(path)
    return path


def test_a_figure_is_one_spec_from_runs_to_picture(tmp_path):
    stimuli = {"flat": {"shape": "flat"}, "round": {"shape": "cylinder", "curvature": "400 1/m"}}
    kinds = {"simulations": ("0.5 mm", 8), "coarse_mesh": ("1 mm", 8), "coarse": ("1 mm", 4)}
    paths = [
        _simulated(tmp_path / kind, name, stimulus, edge, steps)
        for kind, (edge, steps) in kinds.items()
        for name, stimulus in stimuli.items()
    ]
    assert NEW.needs == NEW.read_companions == ("flat", "round")

    frame = NEW.frame(*read_results(paths), read_reference(REFERENCE))
    publish(NEW.draw(frame), frame, tmp_path / "fig_6-1.png")

    saved = read_frame(tmp_path / "fig_6-1.csv")
    assert list(saved) == ["source", "series", "time (s)", "sunk (mm)", "force (gf)", *PARTS]
    ends = saved.dropna(subset="sunk (mm)").groupby("series", sort=False).last()
    assert ends["force (gf)"].tolist() == pytest.approx([5, 5], rel=1e-3)
    assert 0 < ends.loc["flat plate", "sunk (mm)"] < ends.loc["2.5 mm cylinder", "sunk (mm)"] < 2
    assert (ends[list(PARTS)] > 0).all(axis=None)
    assert (ends[list(PARTS)].max() < [30, 3, 3]).all()  # of SUNK: FORCE is prescribed
    assert saved["source"].tolist()[-2:] == ["thesis axis range (T103)"] * 2

    (ax,) = NEW.draw(saved).axes
    assert [line.get_label() for line in ax.lines] == [SUNK, FORCE] * 2 and ax.get_xlim() == (0, 3)
    assert {text.get_text() for text in ax.get_legend().get_texts()} == {SUNK, FORCE}
    assert (tmp_path / "fig_6-1.png").read_bytes()[:4] == b"\x89PNG"
