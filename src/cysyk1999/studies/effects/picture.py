"""Figure of the study of effects: what each changes and costs, and the planner's choices against
that.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cysyk1999.publishing.style import (
    GREY,
    INK,
    NOTE_WIDTH,
    look_of,
    sheet,
    spread,
    styled,
    wrapped,
)
from cysyk1999.publishing.tables import publish_table, write_frame
from cysyk1999.publishing.write import publish
from cysyk1999.studies.effects.run import FIELDS, REFINED, WRONG, evidence, rules_table
from fingerpad.planning.effects import EFFECTS

LEAST = 1e-6
"""Smaller changes are drawn here."""
DRAFT = 0.06
"""What a draft, as in the left panel, lets effects that are left out change."""
WARNING = look_of("verdict", "fails", "color")["color"]


def looks() -> dict[str, tuple[str, str]]:
    """Title and marker of every effect that is registered now, and of what else is switched."""
    own = {
        name: (effect.title or name.replace("_", " "), effect.marker)
        for name, effect in EFFECTS.items()
    }
    return own | {REFINED: (REFINED, "P"), FIELDS: (FIELDS, "X")}


def assemble(pairs: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Plotted rows: panel changes (of :func:`cysyk1999.studies.effects.run.study`) and panel
    planner (of ``verdicts``).
    """
    return pd.concat(
        [pairs.assign(panel="changes"), found.assign(panel="planner")], ignore_index=True
    )


@styled
def effects(frame: pd.DataFrame) -> Figure:
    """Left, change over cost ratio of each effect; right, what each choice of the planner is worth
    over the accuracy.
    """
    height = 5.0
    scenes = len(frame.loc[frame["panel"] == "planner", ["seed", "scene"]].drop_duplicates())
    note = (
        "Simulated. Change of any headline quantity over its largest value, and process time, with "
        "and without the effect on one "
        f"draft mesh. b: {scenes} random scenes; what is left out may be worth the accuracy asked "
        "for (line), what is carried at "
        "least a tenth of it (dashed)."
    )
    verdicts = frame.loc[frame["panel"] == "planner"].dropna(subset="share")["verdict"]
    wrong = int(verdicts.isin(WRONG).sum())
    title = f"{wrong} of {len(verdicts)} choices of the planner are wrong"
    fig = sheet(title, wrapped([note], NOTE_WIDTH), height, laid_out=False)
    grid = fig.add_gridspec(
        1,
        2,
        left=0.1,
        right=0.985,
        top=1 - 0.72 / height,
        bottom=0.85 / height,
        wspace=0.42,
        width_ratios=(1.5, 1),
    )
    _changes(fig.add_subplot(grid[0, 0]), frame[frame["panel"] == "changes"])
    _planner(fig.add_subplot(grid[0, 1]), frame[frame["panel"] == "planner"], scenes)
    return fig


def _dot(label: str, **style) -> Line2D:
    return Line2D([], [], ls="", marker="o", label=label, **{"color": GREY, "ms": 4} | style)


def _legend(ax, handles: list[Line2D]) -> None:
    ax.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(-0.02, 0.985),
        ncols=3,
        fontsize=6.5,
        handletextpad=0.1,
        columnspacing=0.8,
    )


def _changes(ax, rows: pd.DataFrame) -> None:
    known = looks()
    change = rows["change"].clip(lower=LEAST)
    for row, y in zip(rows.to_dict("records"), change, strict=True):
        face = INK if str(row["planned"]) == "True" else "white"
        ax.plot(row["cost ratio"], y, known[row["effect"]][1], color=INK, mfc=face, ms=5, mew=0.9)
    ax.axvline(1, color=GREY, lw=0.7)
    ax.axhline(DRAFT, color=GREY, lw=0.7, ls=(0, (4, 1.8)))
    ax.text(0.11, DRAFT * 1.15, "a draft's accuracy", fontsize=6, color=GREY)
    ax.set(
        xscale="log",
        yscale="log",
        xlim=(0.1, 700),
        ylim=(LEAST / 2, 5),
        xlabel="cost with over cost without (1)",
        ylabel="largest change of a headline quantity (1)",
    )
    ax.set_title("on scenes where it matters, and where it does not", pad=18)
    _legend(ax, [_dot("planned"), _dot("not planned", mfc="white")])
    ax.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    ax.set_xticks([0.2, 0.5, 1, 2, 5])
    ax.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    ax.xaxis.set_label_coords(0.23, -0.075)
    _floor(ax.yaxis)
    logs = np.log10(change.to_numpy())
    places = 10 ** spread(logs, 0.33, np.log10(LEAST / 2) + 0.1, 0.62)
    for row, y, place in zip(rows.to_dict("records"), change, places, strict=True):
        ax.plot([row["cost ratio"], 7.5], [y, place], color=GREY, lw=0.4, zorder=0)
        name = known[row["effect"]][0].split(" (")[0]
        ax.text(
            8,
            place,
            f"{name}: {row['scene']}",
            fontsize=6,
            va="center",
            color=INK,
            clip_on=False,
        )


def _floor(axis) -> None:
    """Powers of ten from LEAST, which stands for all below it, too."""
    ticks = np.arange(round(np.log10(LEAST)), 1, 2 if axis.axis_name == "x" else 1)
    axis.set_ticks(
        10.0**ticks,
        labels=[("$\\leq$" if k == 0 else "") + f"$10^{{{tick}}}$" for k, tick in enumerate(ticks)],
    )


def _planner(ax, rows: pd.DataFrame, scenes: int) -> None:
    known = {name: look for name, look in looks().items() if name in set(rows["effect"])}
    shift = np.random.default_rng(0)
    for k, (name, (_, marker)) in enumerate(known.items()):
        for row in rows[rows["effect"] == name].dropna(subset="share").to_dict("records"):
            wrong = row["verdict"] in WRONG
            carried = "carried" in row["verdict"]
            ax.plot(
                max(row["share"], LEAST),
                k + (0.2 if carried else -0.2) + shift.uniform(-0.13, 0.13),
                marker,
                ms=4,
                mew=0.7,
                color=WARNING if wrong else INK,
                mfc=INK if carried and not wrong else "white",
                alpha=0.8,
            )
    ax.axvline(1, color=INK, lw=0.9)
    ax.axvline(0.1, color=GREY, lw=0.9, ls=(0, (4, 1.8)))
    ax.set(
        xscale="log",
        xlim=(LEAST / 2, 200),
        ylim=(-0.6, len(known) - 0.4),
        xlabel="worth over accuracy (1)",
    )
    _floor(ax.xaxis)
    ax.set_yticks(
        range(len(known)), [title.replace(" (", "\n(") for title, _ in known.values()], fontsize=7
    )
    ax.set_title(f"the planner's choices in {scenes} scenes", pad=18)
    wrong = int(rows["verdict"].isin(WRONG).sum())
    _legend(
        ax,
        [
            _dot("carried"),
            _dot("left out", mfc="white"),
            _dot(f"wrong ({wrong})", color=WARNING, mfc="white"),
        ],
    )


def effects_picture(job: SimpleNamespace) -> None:
    """Job: `parts`: changes, choices -> `picture`, `tables`: effects, planner_rules, `data`: the
    planner's choices.
    """
    changes, choices = map(pd.read_csv, job.parts)
    frame = assemble(changes, choices)
    publish(effects(frame), frame, job.picture[0])
    for table, path in zip((evidence, rules_table), job.tables, strict=True):
        publish_table(table(changes, choices), path)
    write_frame(choices, Path(job.data[0]))
