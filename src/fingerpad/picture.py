"""The picture of a history: the pad and what touches it, pressure on the skin, strain energy at the
receptors and the impulses they would send.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.receptors.respond import respond
from fingerpad.stimuli.profile import Profile

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 4
"""Legs whose last state is shown, and receptors: the last legs, the first receptors."""
INK, SKIN, SOLID = "0.15", "#e3b7a8", "0.8"
COLOURS = ("#01287b", "#8d306d", "#d06731", "#ca8605")
LINES = ("-", "--", "-.", ":")
STYLE = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 8,
    "legend.frameon": False,
    "legend.fontsize": 7,
    "lines.linewidth": 1.3,
}


def draw_history(history: xr.Dataset, stimulus: Profile) -> Figure:
    """A figure of 183 by 115 mm, in mm, kPa, s: the section at the last output; pressure at the end
    of each leg; strain energy density of each receptor over time; impulses by the law of slowly
    adapting receptors, if anything takes time.

    Raises
    ------
    ImportError
        matplotlib is not installed.
    """
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        message = "history.fingerpad.plot() needs matplotlib: pip install matplotlib"
        raise ImportError(message) from error
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(2, 2, figsize=(7.2, 4.5), layout="constrained")
        _section(axes[0, 0], history, stimulus)
        _pressure(axes[0, 1], history)
        _energy(axes[1, 0], history)
        _impulses(axes[1, 1], history)
        last, error = history.isel(time=-1), 100 * float(history.attrs["estimated_error"])
        figure.suptitle(
            f"At the end: depth {1e3 * float(last.indentation_depth):.3g} mm, contact "
            f"{1e3 * float(last.contact_width):.3g} mm wide, highest pressure "
            f"{1e-3 * float(last.peak_pressure):.3g} kPa (simulated, error about {error:.1f} %)",
            fontsize=8,
            fontweight="bold",
            x=0.01,
            ha="left",
        )
    return figure


def _skin(history: xr.Dataset, index: int) -> np.ndarray:
    """Place (skin_node, 2) mm of the skin at an output."""
    now = history.isel(time=index)
    moved = now.skin_x + now.skin_displacement_x, now.skin_y + now.skin_displacement_y
    return 1e3 * np.column_stack([each.values for each in moved])


def _receptors(history: xr.Dataset) -> list[tuple[int, str]]:
    """Index and name of the receptors that are shown."""
    places = zip(history.receptor_depth.values, history.receptor_offset.values, strict=True)
    named = [
        f"{1e6 * depth:.0f} µm deep" + (f", {1e3 * offset:+.2g} mm" if abs(offset) > 1e-9 else "")
        for depth, offset in places
    ]
    return list(enumerate(named))[:MOST]


def _section(ax: Axes, history: xr.Dataset, stimulus: Profile) -> None:
    skin, now = _skin(history, -1), history.isel(time=-1)
    ax.fill(*skin.T, facecolor=SKIN, lw=0)
    ax.plot(*skin.T, color=INK, lw=0.8)
    middle = int(np.abs(history.skin_arc.values).argmin())
    height = history.skin_y.values[middle] - float(now.indentation_depth)
    x = np.linspace(skin[:, 0].min(), skin[:, 0].max(), 2001)
    side = 1e3 * (height + stimulus.outline(1e-3 * x + float(now.stroke_distance)))
    top = skin[:, 1].max() + 2.5
    ax.fill_between(x, np.minimum(side, top), top, facecolor=SOLID, edgecolor=INK, lw=0.8)
    for receptor, _ in _receptors(history):
        offset, depth = (1e3 * float(now[f"receptor_{k}"][receptor]) for k in ("offset", "depth"))
        above = np.abs(1e3 * history.skin_arc.values - offset).argmin()
        at = skin[above, 0], skin[above, 1] - depth
        ax.plot(*at, "o", ms=4, color=COLOURS[receptor], mec="white", mew=0.5)
    ax.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)", ylim=(None, top))
    ax.set_title("a  at the end (dots: receptors)")


def _pressure(ax: Axes, history: xr.Dataset) -> None:
    leg = history.leg.values
    ends = np.flatnonzero(np.append(leg[1:] != leg[:-1], True))[-MOST:]
    for k, index in enumerate(ends):
        words = f"end of leg {leg[index] + 1:.0f}, {float(history.time[index]):.3g} s"
        pressure = 1e-3 * history.contact_pressure.values[index]
        place = _skin(history, index)[:, 0]
        upper = history.skin_y.values > 0
        ax.plot(place[upper], pressure[upper], LINES[k], color=INK, label=words)
    reach = 0.75e3 * float(history.contact_width.max()) or 1.0
    ax.set(xlabel="x (mm)", ylabel="contact pressure (kPa)", xlim=(-reach, reach), ylim=(0, None))
    ax.set_title("b  on the skin")
    ax.legend(loc="lower center", handlelength=2.2)


def _energy(ax: Axes, history: xr.Dataset) -> None:
    for receptor, name in _receptors(history):
        energy = 1e-3 * history.strain_energy_density.values[:, receptor]
        ax.plot(history.time, energy, color=COLOURS[receptor], ls=LINES[receptor], label=name)
    ax.set(xlabel="time (s)", ylabel="strain energy density (kPa)", ylim=(0, None))
    ax.set_title("c  at the receptors")
    ax.legend(loc="lower right", handlelength=2.2)


def _impulses(ax: Axes, history: xr.Dataset) -> None:
    ax.set_title("d  impulses of slowly adapting receptors, predicted")
    names = [name for _, name in _receptors(history)]
    ax.set(xlabel="time (s)", yticks=range(len(names)), ylim=(len(names) - 0.4, -0.6))
    ax.set_yticklabels([name.replace(" deep", "") for name in names])
    try:
        answer = respond(history)
    except ValueError as error:  # nothing takes time
        ax.text(0.5, 0.5, str(error), transform=ax.transAxes, ha="center", va="center", wrap=True)
        return
    for receptor in range(len(names)):
        times = answer.impulse_time.values[0, receptor]
        ax.eventplot(
            times[~np.isnan(times)],
            lineoffsets=receptor,
            linelengths=0.7,
            linewidths=0.7,
            colors=COLOURS[receptor],
        )
        count = int(answer.impulses.values[0, receptor])
        ax.annotate(f"{count}", (1, receptor), (4, 0), ("axes fraction", "data"), "offset points")
    ax.set_xlim(0, float(history.time[-1]))
