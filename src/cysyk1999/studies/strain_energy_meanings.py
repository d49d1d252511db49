"""Which strain energy? The definitions that a history records, and which of them fall in the hold
as neurons' rates do.

In a viscoelastic solid under a constant force the word has several meanings, and their trends
disagree while the skin creeps:

instantaneous elastic
    that of the whole stress on the instantaneous moduli, as if nothing had relaxed; the headline
    `strain_energy_density`.
long-term moduli
    the same on the long-term moduli, as if all had relaxed.
half stress × strain
    half of the whole Kirchhoff stress contracted with the logarithmic strain.
recoverable
    of the long-term network and of the springs of the Maxwell branches.
long-term network
    of the deformation alone, on the long-term moduli.
"""

from __future__ import annotations

import textwrap
from functools import partial
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.figures import axes as axs
from cysyk1999.measures.errors import Companions, curve_errors, over_time
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import SED, TIME
from cysyk1999.measures.runs import NINE
from cysyk1999.publishing import style
from cysyk1999.publishing.tables import without_round_off
from cysyk1999.publishing.write import publish
from fingerpad.measures.features import SIMULATED, SURFACES, Histories, energy, ramp_end, scene_name

MEANINGS = {
    "instantaneous elastic": "strain_energy_density",
    "long-term moduli": "strain_energy_long_term_moduli",
    "half stress × strain": "strain_energy_half_stress_strain",
    "recoverable": "strain_energy_recoverable",
    "long-term network": "strain_energy_network",
}
"""Definition -> variable of a history."""
DEPTHS = {"600 um": (600e-6, "--"), "915 um": (915e-6, "-")}
"""Depths of receptors, m, and their lines."""
SHOWN = "915 um"
CHANGE = "change_in_hold (%)"
MARKS = {
    panel: style.look_of("energy", panel, "color", "marker")
    | {"ms": 3.5, "lw": 1.0, "zorder": 9 - k}
    for k, panel in enumerate(MEANINGS)
}
MARKS["long-term moduli"] |= {"ms": 7, "mfc": "none"}
"""Looks; one is round others, for at 600 um it changes as the first does."""
FALLS = {"fc": "white", "ec": "0.88", "hatch": "\\\\\\", "lw": 0, "zorder": 0}


def frame_meanings(histories: Histories, coarse: Companions) -> pd.DataFrame:
    """Strain energy density over time by definition, depth and surface (40 gf/s), with its change
    from the top of the ramp on.
    """
    parts = []
    for label, history in NINE.histories(histories).items():
        companion, top = coarse.get(scene_name("ramp40", label)), ramp_end(history)
        for panel, variable in MEANINGS.items():
            for series, (depth, _) in DEPTHS.items():
                read = partial(energy, depth=depth, name=variable)
                values = read(history)
                rows = {
                    "source": SIMULATED,
                    "panel": panel,
                    "series": series,
                    "surface": label,
                    TIME: history["time"].values,
                    SED: values,
                    CHANGE: 100 * (values / values[top] - 1),
                }
                errors = curve_errors(history, companion, over_time(read))
                parts.append(pd.DataFrame(rows | errors.columns))
    return pd.concat(parts, ignore_index=True)


def titled(panel: str) -> str:
    """A definition's name in the lines of a narrow panel's title."""
    return textwrap.fill(panel, 12, break_long_words=False)


@style.styled
def fig_meanings(frame: pd.DataFrame) -> Figure:
    """Above: each definition over time, relative to the top of the ramp; below: its change over the
    hold for every surface.
    """
    errors = axs.footnote(frame)[0].replace(f"; strain energy{axs.FORMULA}", "")
    note = (
        f"{errors} Recorded rates fall in the hold under every surface (Cysyk 1999, section 4.2). "
        "Hatched: where a definition does so. Without viscosity the five are one."
    )
    title = (
        "Which strain energy falls in the hold as neurons' rates do? 40 gf/s to 20 gf, "
        "under the centre"
    )
    fig = style.study_figure(title, [note], 5.4)
    grid = fig.add_gridspec(2, len(MEANINGS), height_ratios=[1, 1.1])
    axes = [fig.add_subplot(grid[0, k]) for k in range(len(MEANINGS))]
    shown = frame[frame["series"] == SHOWN]
    curves = dict(list(shown.groupby(["panel", "surface"])))
    ends = {}
    for ax, panel in zip(axes, MEANINGS, strict=True):
        for label in SURFACES:
            rows = curves[panel, label]
            time, share = rows[TIME].to_numpy(), 1 + rows[CHANGE].to_numpy() / 100
            ax.plot(time, share, **axs.look(label))
            ends[label] = time[-1], share[-1]
        ax.axhspan(0, 1, **FALLS)
        ax.set(title=titled(panel), xlabel="time (s)", xlim=(0, 2.5))
        ax.set_ylim(0, 1.08 * (1 + shown[CHANGE].max() / 100))
        ax.tick_params(labelleft=ax is axes[0])
    axes[0].set_ylabel(f"energy over that at the top\nof the ramp, {SHOWN.replace('um', 'µm')}")
    style.label_ends(axes[-1], ends, 2.62, "curvature (1/m)")
    ax = fig.add_subplot(grid[1, :])
    last = frame.groupby(["panel", "series", "surface"])[CHANGE].last()
    handles = [style.handle(panel, **MARKS[panel]) for panel in MEANINGS]
    for series, (_, line) in DEPTHS.items():
        for panel in MEANINGS:
            ax.plot(last[panel][series].reindex(SURFACES).to_numpy(), line, **MARKS[panel])
        handles.append(style.handle(series.replace("um", "µm"), color=style.INK, ls=line))
    ax.axhline(0, color=style.INK, lw=0.7)
    ax.axhspan(min(0.0, 1.2 * last.min()), 0, **FALLS)
    ax.set(ylabel="change over the hold (%)", xlabel="curvature (1/m)")
    ax.set_xlim(-0.3, len(SURFACES) - 0.7)
    ax.set_xticks(range(len(SURFACES)), ["flat plate", *SURFACES[1:]])
    ax.set_ylim(top=ax.get_ylim()[0] + 1.3 * np.ptp(ax.get_ylim()))
    ax.legend(handles=handles, loc="upper left", ncols=3)
    return fig


def strain_energy_meanings(job: SimpleNamespace) -> None:
    """Job: `histories`, `coarse` -> `picture`."""
    histories, _, coarse = read_results([*job.histories, *job.coarse])
    frame = without_round_off(frame_meanings(histories, coarse))
    publish(fig_meanings(frame), frame, job.picture[0])
