"""The picture of energy of shape and of volume in two pads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.publishing.style import (
    CATEGORIES,
    NOTE_SIZE,
    header_legend,
    in_kilo,
    study_figure,
    styled,
)
from cysyk1999.studies.reconstruction import pads


def told_of_shares(frame: pd.DataFrame) -> str:
    """A sentence of the data: the share of volume in the dermis, lowest and highest."""
    deep, words = frame[frame["depth (um)"] > 1e6 * pads.EPIDERMIS_THICKNESS], []
    for pad, rows in deep.groupby("pad", sort=False):
        share = rows["volume (Pa)"] / (rows["volume (Pa)"] + rows["shape (Pa)"])
        words.append(f"{share.min():.0%} to {share.max():.0%} ({pad})")
    return f"In the dermis volume has {' and '.join(words)} of the energy."


@styled
def shares_picture(frame: pd.DataFrame) -> Figure:
    """Bars by depth, of two pads beside each other: energy of shape, and of volume on top."""
    note = [
        "Simulated: strain energy density (total stress on instantaneous moduli) when it is "
        f"highest, 20 gf at 40 gf/s. {told_of_shares(frame)} Numbers: share of volume, %. Dotted: "
        "where the dermis begins. Measured skin is nearly incompressible."
    ]
    names, surfaces = (list(frame[column].unique()) for column in ("pad", "surface"))
    fig = study_figure("Strain energy of shape and of volume under three surfaces", note, 3.6)
    axes, entries = fig.subplots(1, len(surfaces)), []
    for ax, surface in zip(axes, surfaces, strict=True):
        for k, name in enumerate(names):
            rows = frame[(frame["surface"] == surface) & (frame["pad"] == name)]
            at = np.arange(len(rows)) + 0.42 * (k - 0.5)
            shape, volume = rows["shape (Pa)"].to_numpy(), rows["volume (Pa)"].to_numpy()
            colour = {"color": CATEGORIES[k], "width": 0.38}
            low = ax.bar(at, shape, alpha=0.4, **colour)
            high = ax.bar(at, volume, bottom=shape, **colour)
            for bars, part in ((low, "shape"), (high, "volume")):
                bars[0].set_label(f"{name}: {part}")
                entries.append(bars[0])
            for place, a, b in zip(at, shape, volume, strict=True):
                text = {"size": NOTE_SIZE, "ha": "center", "va": "bottom"}
                ax.text(place, a + b, f"{100 * b / (a + b):.0f}", rotation=90, **text)
        ax.axvline(5.5, color="0.42", ls=":", lw=0.8)
        ax.set_xticks(range(len(pads.DEPTHS)), pads.DEPTHS)
        ax.set(xlabel="depth (µm)", title="flat" if surface == "flat" else f"{surface} 1/m")
        ax.margins(y=0.12)
        in_kilo(ax.yaxis)
    axes[0].set_ylabel("strain energy density (kPa)")
    header_legend(fig, entries[: 2 * len(names)], handlelength=1.2)
    return fig


STUDIES: dict[str, Callable[[pd.DataFrame], Figure]] = {"shares": shares_picture}
"""Picture -> how it is drawn."""
