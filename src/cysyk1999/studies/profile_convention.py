"""Picture of how the points of a sampled profile are meant: the lower surface of the solid, y up, x
= 0 over the apex.

python -m cysyk1999.studies.profile_convention figures/studies/profile_convention.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.publishing import style
from cysyk1999.publishing.write import publish
from fingerpad.stimuli.shapes import Sampled

RADIUS = 8.0  # mm, of the pad drawn


def frame_convention() -> pd.DataFrame:
    """Points of a profile and of a pad below it (mm), in the profile's frame, a little before they
    touch.
    """
    x = np.linspace(-3.5, 4.5, 33)
    y = 0.25 + 0.06 * x**2 + 0.25 * np.cos(2 * x) - 0.04 * x
    skin = np.linspace(-6, 6, 121)
    pad = np.sqrt(RADIUS**2 - skin**2) - RADIUS - 0.35
    parts = [
        pd.DataFrame({"series": "profile", "x (mm)": x, "y (mm)": y}),
        pd.DataFrame({"series": "pad", "x (mm)": skin, "y (mm)": pad}),
    ]
    return pd.concat(parts, ignore_index=True)


@style.styled
def fig_convention(frame: pd.DataFrame) -> Figure:
    """The solid above its points, the pad below, axes, and what lies beyond the ends by each
    rule.
    """
    (x, y), (skin, pad) = (
        frame[frame.series == name][["x (mm)", "y (mm)"]].values.T for name in ("profile", "pad")
    )
    fig = style.study_figure(
        "How the points of a sampled profile are read",
        [
            "x = 0 comes down on the apex of the pad; of y only differences matter, for "
            "the profile moves down until it touches."
        ],
        height=3.1,
    )
    ax = fig.subplots()
    ax.fill_between(x, y, 2.3, color=style.PALE, lw=0)
    ax.plot(
        x,
        y,
        ".-",
        color=style.INK,
        ms=4,
        lw=1,
        label="points of the file: lower surface of the solid",
    )
    ax.fill_between(skin, pad, -3.2, color=style.LAYER_COLOURS["epidermis"], lw=0)
    ax.plot(skin, pad, color=style.INK, lw=1)
    for ends, line in (("level", style.DASHED), ("slope", style.DOTTED)):
        profile = Sampled(x=1e-3 * x, y=1e-3 * y, ends=ends)
        height = y.min()
        for far in (np.array([x[0] - 1.3, x[0]]), np.array([x[-1], x[-1] + 1.3])):
            look = {
                "color": style.INK,
                "ls": line,
                "lw": 1.0,
                "label": f"ends: {ends}" if far[0] < 0 else None,
            }
            ax.plot(far, 1e3 * profile.outline(1e-3 * far) + height, **look)
    ax.axvline(0, color=style.GREY, lw=0.8, ls=style.DASH_DOT)
    ax.annotate("solid", (1.2, 1.7), ha="center")
    ax.annotate("pad", (0.3, -2.2))
    ax.annotate("ends: open (the default):\nnothing beyond the points", (3.7, 0.65), va="top")
    ax.annotate("", (-5.2, 1.9), (-5.2, 0.6), arrowprops={"arrowstyle": "->"})
    ax.annotate("y", (-5.1, 1.8))
    ax.set(xlim=(-6.2, 7.2), ylim=(-2.6, 2.3), xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    style.header_legend(fig, ax.get_legend_handles_labels()[0])
    return fig


if __name__ == "__main__":
    drawn = frame_convention()
    publish(fig_convention(drawn), drawn, Path(sys.argv[1]))
