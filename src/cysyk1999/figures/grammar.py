"""A figure of the thesis, said once: which runs, which quantities, which layout; its data frame and
its picture follow.

::

    Figure("4-23", "Strain energy density 915 µm under the centre", NINE, TIME, (sed(915e-6),),
           thesis={TIME: "T189", SED: "T188"}, layout=Panels(4.6, lines=Lines(ends=2.62)))

A picture is a function of its frame alone, which is published beside it. The frame of most figures
is read by the quantities themselves (`Data.traces`); `rows` says another way, with the other
methods of `Data`, and `after` adds what only one figure has. What a layout does not say is done by
`extra` once its panels are drawn. Matplotlib is imported when something is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures import axes as axs
from cysyk1999.measures.errors import (
    LEFT,
    PARTS,
    Companion,
    Companions,
    at_output,
    curve_errors,
    instead,
    over_stroke,
    over_time,
    thinned,
)
from cysyk1999.measures.quantities import (
    CURVATURE,
    DISTANCE,
    DOWN,
    HEIGHT,
    P_CENTRE,
    P_PEAK,
    TIME,
    P,
    Q,
    X,
)
from cysyk1999.measures.responses import curvature_of
from cysyk1999.measures.runs import Runs
from cysyk1999.measures.table import MEASURES
from cysyk1999.publishing import style
from cysyk1999.publishing.write import without_round_off
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import read_bands, read_force_depth, read_surface_profiles
from fingerpad.measures.features import (
    PHASES,
    SIMULATED,
    Feature,
    Histories,
    centre_node,
    in_contact,
    is_simulated,
    phase_indices,
    profile,
    width,
)
from fingerpad.measures.strokes import arcs, convexities, loaded, profile_and_height
from fingerpad.planning.errors import PROFILE_ORDER

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

    from fingerpad.specimen.pad import PadMesh

Ids = str | Mapping[object, str]
"""Id of an axis's range in the table of the thesis's numbers, or an id for each panel, surface or
pad.
"""
Look = Mapping[str, object]
"""What a line looks like, in matplotlib's words."""
HOW = "r.m.s. over the stroke"
IN_KILO = (P, P_CENTRE, P_PEAK)
"""Quantities in Pa whose axes say kPa."""
MEASURED: Mapping[str, tuple[str, Callable[..., pd.DataFrame]]] = {
    "force_depth": ("force_depth/*.csv", read_force_depth),
    "surface_profiles": ("surface_profiles.csv", lambda paths: read_surface_profiles(*paths)),
    "impulse_rates": ("impulse_rates/*.csv recordings/*.csv", lambda paths: read_rates(*paths)),
    "pads": ("reconstruction_bands.csv", lambda paths: read_bands(*paths)),
}
"""Data shown beside simulated ones, measured or of other pads, by name: their files in the folder
of reference data (one pattern or more), and their reader.
"""


# --- data ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Data:
    """What a figure's rows are made from: results by scene, the thesis's numbers, and measured data
    if it shows any.
    """

    histories: Histories
    meshes: Mapping[str, PadMesh]
    coarse: Companions
    reference: pd.DataFrame
    measured: pd.DataFrame | None = None

    def runs(self, runs: Runs) -> Iterator[tuple[str, xr.Dataset, Companion | None]]:
        """Name, history, and companions if there are any, of every run."""
        for name, scene in runs.scenes.items():
            yield name, self.histories[scene], self.coarse.get(scene)

    def traces(self, runs: Runs, columns: Sequence[Q], checked: Sequence[Q] = ()) -> pd.DataFrame:
        """One row an output: the run's name, the columns, and the errors of what is `checked` (of
        all that count).
        """
        reads = [q.read for q in checked or columns if q.checked]
        parts = []
        for name, history, coarse in self.runs(runs):
            shown, over = (loaded(history), over_stroke) if runs.stroke else (history, over_time)
            errors = curve_errors(history, coarse, *map(over, reads))
            part = {"source": SIMULATED, runs.column: name} | {q: q.read(shown) for q in columns}
            parts.append(pd.DataFrame(part | errors.columns))
        return pd.concat(parts, ignore_index=True)

    def profiles(self, runs: Runs, half: bool = False) -> pd.DataFrame:
        """Pressure over the contact at the shown outputs: at nodes, where they are by then, and
        between the last and the edge.
        """
        parts = []
        for name, history, coarse in self.runs(runs):
            sunk = -history["skin_displacement_y"].values
            for index, phase in phase_indices(history):
                x, p = edged_profile(history, index)
                errors = curve_errors(
                    history,
                    coarse,
                    at_output(float(history["time"][index]), edged_profile, PROFILE_ORDER),
                )
                near = in_contact(history, index)
                down = (
                    np.interp(x, profile(history, index)[0][near], sunk[index][near])
                    if near.any()
                    else 0 * x
                )
                keep = (x >= 0) & near.any() if half else np.full(len(x), near.any())
                part = {
                    "phase": phase,
                    TIME: history["time"].values[index],
                    X: x[keep] * 1e3,
                    DOWN: down[keep] * 1e3,
                }
                parts.append(pd.DataFrame(part | {P: p[keep], **errors.columns, runs.column: name}))
        return pd.concat(parts, ignore_index=True)

    def numbers(self, runs: Runs, columns: Mapping[Q, Feature], own: bool = False) -> pd.DataFrame:
        """One row a surface: curvature, numbers, the largest of their errors, relative to the
        largest of all or to its `own`.
        """
        histories = [history for _, history, _ in self.runs(runs)]

        def read(history: xr.Dataset) -> pd.Series:
            return pd.Series({q: each(history) for q, each in columns.items()}, dtype=float)

        rows, sparse = (
            pd.DataFrame(map(read, histories)),
            pd.DataFrame([read(thinned(history)) for history in histories]),
        )
        others = [instead(history, companion, read) for _, history, companion in self.runs(runs)]
        mesh, left, both = map(pd.DataFrame, zip(*others, strict=True))
        sizes = rows.abs() if own else rows.abs().max()
        errors = largest_of([(rows, mesh), (left, both), (rows, sparse)], sizes)
        rows.insert(0, CURVATURE, [curvature_of(history) for history in histories])
        rows.insert(0, runs.column, list(runs))
        return pd.concat([rows, errors], axis=1)

    def convexities(self, runs: Runs, columns: Mapping[Q, str]) -> pd.DataFrame:
        """One row a run and convexity: its name and curvature, measures by their names, and the
        largest of their errors.
        """

        def read(history: xr.Dataset) -> pd.DataFrame:
            return pd.DataFrame({q: MEASURES[m](history) for q, m in columns.items()}, dtype=float)

        parts = []
        for name, history, coarse in self.runs(runs):
            fine, others = read(history), (read(thinned(history)), *instead(history, coarse, read))
            sparse, mesh, left, both = (each.reindex(fine.index) for each in others)
            errors = largest_of([(fine, mesh), (left, both), (fine, sparse)], fine.abs())
            exact = [convexities(history)[label].curvature for label in fine.index]
            rows = pd.concat([fine, errors], axis=1).rename_axis("convexity").reset_index()
            rows.insert(1, CURVATURE, exact)
            rows.insert(0, runs.column, name)
            parts.append(rows)
        return pd.concat(parts, ignore_index=True)

    def surface(self, scene: str, low: float, high: float) -> pd.DataFrame:
        """Rows of a stroked surface's shape from `low` to `high` (mm along it): height, and
        curvature (0 on the flats).
        """
        history = self.histories[scene]
        pieces = arcs(history)
        ends = [1e3 * a.start for a in pieces] + [1e3 * pieces[-1].end]
        x = np.union1d(np.arange(low, high + 1e-9, 0.1), [end for end in ends if low < end < high])
        curvature = np.zeros(len(x))
        for arc in pieces:
            curvature[(x >= arc.start * 1e3) & (x < arc.end * 1e3)] = arc.curvature
        heights = profile_and_height(history)[0].outline(x * 1e-3) * 1e3
        part = {"source": f"{SIMULATED}: shape of the stimulus", "panel": axs.SURFACE, DISTANCE: x}
        return pd.DataFrame(part | {HEIGHT: heights, CURVATURE: curvature})

    def bands(
        self,
        column: str,
        measures: Mapping[str, Mapping[str, object]],
        read: Callable[[float], float] = float,
    ) -> pd.DataFrame:
        """How far other pads differ that the thesis's figures do not rule out: two rows (its ends)
        a surface and measure.

        `measures`: name of a measure of `cysyk1999.reference_data.read_bands` -> further cells of
        its rows; `read` makes of an end that of the column.
        """
        rows = []
        for band in () if self.measured is None else self.measured.itertuples():
            if band.measure in measures:
                of = {
                    "surface": band.surface,
                    "source": f"{axs.OTHER_PADS} that the thesis's figures do not tell apart: {band.pads:.0f})",
                    **measures[band.measure],
                }
                rows += [of | {column: end} for end in sorted((read(band.low), read(band.high)))]
        return pd.DataFrame(rows)

    def axis(self, column: str, ids: Ids, key: str) -> pd.DataFrame:
        """Rows that mark a thesis axis range: two (its ends) for each id that the reference has,
        `source` saying so.
        """
        rows = []
        for panel, id_ in (ids if isinstance(ids, Mapping) else {None: ids}).items():
            if id_ not in self.reference.index:
                continue
            entry = self.reference.loc[id_]
            source = (
                "thesis axis range "
                f"({id_}{', reading uncertain' if entry['kind'] == 'garbled' else ''})"
            )
            of = {} if panel is None else {key: panel}
            rows += [{**of, "source": source, column: entry[end]} for end in ("low", "high")]
        return pd.DataFrame(rows)


def edged_profile(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions (m) of the nodes of a contact that is its own mirror image, and of its edges, and
    the pressures (Pa) there.

    It ends beside the nodes, with the root of the distance, like any smooth contact. A node within
    half a spacing of its edge is left out, for it may have skin on one side that does not touch.
    """
    (x, p), end = profile(history, index), width(history)[index] / 2
    touch = np.flatnonzero((np.arange(len(x)) >= centre_node(history)) & (p > 0))
    if not len(touch):
        return np.zeros(1), np.zeros(1)
    spacing = x[touch[0] + 1] - x[touch[0]]
    inside = touch[(x[touch] < end - spacing / 2) | (touch == touch[0])]
    to_edge = np.linspace(0, 1, 9)[1:]
    right = np.append(
        x[inside], x[inside[-1]] + (1 - (1 - to_edge) ** 2) * max(end - x[inside[-1]], 0.0)
    )
    pressure = np.append(p[inside], p[inside[-1]] * (1 - to_edge))
    return np.append(-right[:0:-1], right), np.append(pressure[:0:-1], pressure)


def upper_profile(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Deformed lateral position (m) and pressure (Pa) of the skin nodes of the upper side at one
    output.
    """
    upper = history["skin_y"].values > 0
    return tuple(part[upper] for part in profile(history, index))


def largest_of(
    pairs: Sequence[tuple[pd.DataFrame, pd.DataFrame]], sizes: pd.DataFrame | pd.Series
) -> pd.DataFrame:
    """The errors (columns `PARTS`, %) of each row's number that is furthest off, relative to sizes;
    none of what is zero.

    pairs: numbers that differ by the mesh, by the steps, and by how many outputs are read.
    """
    parts = [
        100 * left * (a - b).abs() / sizes.replace(0, np.nan)
        for left, (a, b) in zip(LEFT, pairs, strict=True)
    ]
    worst = sum(part.fillna(0) for part in parts).to_numpy().argmax(axis=1)
    rows = np.arange(len(worst))
    return pd.DataFrame(
        {name: part.to_numpy()[rows, worst] for name, part in zip(PARTS, parts, strict=True)},
        parts[0].index,
    )


def below(rows: pd.DataFrame, *others: pd.DataFrame) -> pd.DataFrame:
    """Frames below each other, the first simulated where it says nothing else; empty ones are left
    out.
    """
    if "source" not in rows:
        rows.insert(0, "source", SIMULATED)
    return pd.concat([rows, *(part for part in others if len(part))], ignore_index=True)


def stacked(parts: Mapping[object, pd.DataFrame], column: str = "panel") -> pd.DataFrame:
    """Frames below each other, each with its name in a first column."""
    return pd.concat(dict(parts), names=[column]).reset_index(0).reset_index(drop=True)


# --- figures ---------------------------------------------------------------------------------------------


class Layout(Protocol):
    """How panels are placed and filled. Heights in inch; `header` leaves room under the title."""

    height: float
    header: float

    def draw(self, fig: Picture, frame: pd.DataFrame, spec: Figure) -> None: ...


@dataclass(frozen=True)
class Figure:
    """One figure of the thesis.

    Attributes
    ----------
    number, title
        The thesis's number (``4-10``) and a title of our own.
    runs
        What is shown, one set of runs or more.
    x, y
        Quantities across and up; the frame's columns unless `rows` says otherwise.
    thesis
        Column -> id of the thesis's axis range, or ids by the values of the column `key`.
    layout
        Its picture.
    rows
        ``rows(data)``: the rows before those of the axis ranges, where they are not the traces of
        `y` over `x`.
    after
        ``after(data)``: rows after them.
    keep, checked, constants
        Of the traces: columns before `x`; quantities whose error counts in place of those of `y`;
        columns with one value.
    surface
        Ends (mm) of the stroked surface that is drawn above.
    measured
        Name of the measured data (a key of `MEASURED`) shown beside; empty: none.
    meshes
        Whether it is made from the meshes of its runs too.
    joined
        Column that names the lines which points are joined to, if they are: the error stated is the
        largest of a line.
    how, note
        How the error is taken; or ``note(frame)``, the line under the picture but for the thesis's
        statement.
    remarks
        What a caption says beyond the picture.
    width
        Inch: of a page, or of a column for a single curve.
    extra
        ``extra(panels, frame)``: what the layout does not say, on the panels by their names.
    """

    number: str
    title: str
    runs: Runs | tuple[Runs, ...]
    x: Q | None = None
    y: tuple[Q, ...] = ()
    thesis: Mapping[str, Ids] = field(default_factory=dict)
    layout: Layout = None
    key: str = "surface"
    rows: Callable[[Data], pd.DataFrame] | None = None
    after: Callable[[Data], pd.DataFrame] | None = None
    keep: tuple[Q, ...] = ()
    checked: tuple[Q, ...] = ()
    constants: Mapping[str, float] = field(default_factory=dict)
    surface: tuple[float, float] | None = None
    measured: str = ""
    meshes: bool = False
    joined: str = ""
    how: str | None = None
    remarks: tuple[str, ...] = ()
    note: Callable[[pd.DataFrame], Sequence[str]] | None = None
    width: float = style.PAGE_WIDTH
    extra: Callable[[Mapping[object, Axes], pd.DataFrame], None] | None = None

    @property
    def all_runs(self) -> tuple[Runs, ...]:
        """Its sets of runs."""
        return (self.runs,) if isinstance(self.runs, Runs) else self.runs

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the scenes whose histories the frame is made from."""
        return tuple(
            dict.fromkeys(scene for runs in self.all_runs for scene in runs.scenes.values())
        )

    @property
    def read_companions(self) -> tuple[str, ...]:
        """Names of the scenes whose coarse companions the frame reads."""
        return tuple(
            dict.fromkeys(scene for runs in self.all_runs for scene in runs.companion_scenes)
        )

    def measurements(self, folder: str | PathLike) -> tuple[pd.DataFrame, ...]:
        """The measured data in `folder` that `frame` takes after its four arguments: one table or
        none.
        """
        return (MEASURED[self.measured][1](self.measured_files(folder)),) if self.measured else ()

    def measured_files(self, folder: str | PathLike) -> list[Path]:
        """The files in `folder` that the measured data are read from."""
        patterns = MEASURED[self.measured][0].split() if self.measured else []
        return [path for pattern in patterns for path in sorted(Path(folder).glob(pattern))]

    def frame(
        self,
        histories: Histories,
        meshes: Mapping[str, PadMesh],
        coarse: Companions,
        reference: pd.DataFrame,
        measured: pd.DataFrame | None = None,
    ) -> pd.DataFrame:
        """The tidy data frame, units in the column names; simulated rows first, a `source` in every
        row.

        `coarse` holds the companions on coarser meshes (may be empty: errors of mesh and steps are
        then NaN), `reference` is the table of `read_reference` (may be empty: thesis ranges are
        then left out), `measured` a table of `measurements`.
        """
        data = Data(histories, meshes, coarse, reference, measured)
        rows = self.rows(data) if self.rows else self._traces(data)
        if "source" not in rows:
            rows.insert(0, "source", SIMULATED)
        marks = [data.axis(column, ids, self.key) for column, ids in self.thesis.items()]
        if self.after:
            marks.append(self.after(data))
        return without_round_off(
            pd.concat([rows, *(part for part in marks if len(part))], ignore_index=True)
        )

    def _traces(self, data: Data) -> pd.DataFrame:
        columns = (*self.keep, self.x, *self.y)
        rows = pd.concat(
            [data.traces(runs, columns, self.checked) for runs in self.all_runs], ignore_index=True
        )
        rows = rows.assign(**self.constants)
        if self.surface is None:
            return rows
        scenes = {name: scene for runs in self.all_runs for name, scene in runs.scenes.items()}
        above = data.surface(scenes.get("10 mm/s") or next(iter(scenes.values())), *self.surface)
        return pd.concat([above, rows[rows[DISTANCE] >= self.surface[0] - 1e-9]], ignore_index=True)

    def draw(self, frame: pd.DataFrame) -> Picture:
        """The picture, a function of the frame alone."""
        with style.theme():
            how = self.how if self.how is not None else HOW if self.surface else ""
            wide = style.note_width(self.width)
            through = [(self.joined, q) for q in self.y if self.joined]
            lines = (
                style.wrapped(self.note(frame), wide)
                if self.note
                else axs.footnote(frame, how, wide, through)
            )
            lines += axs.statement(frame, wide)
            fig = style.sheet(
                self.title,
                lines,
                self.layout.height,
                self.number,
                self.layout.header,
                width=self.width,
            )
            panels = self.layout.draw(fig, frame, self)
            if self.extra:
                self.extra(panels, frame)
            return style.finished(fig)


# --- layouts ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Curves of a panel: one a name in the column `by` (left out, that of the runs) and quantity.

    `looks` of names (in their order) and quantities go over those of `axes.look`; `names` are what
    a legend says; `ends`: where (x) surfaces are named directly, under `heading`; `recorded`: what
    points look like that were measured; `bars`: they are points, whose errors are drawn as bars,
    not as bands; `hidden`: quantity -> that which must be above 0 where it is shown.
    """

    by: str = ""
    looks: Mapping[str, Look] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    ends: float | None = None
    heading: str = "curvature (1/m)"
    recorded: Look = field(default_factory=dict)
    bars: bool = False
    hidden: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
        own, ends = rows[is_simulated(rows)], {}
        curves = own.groupby(self.by or spec.all_runs[0].column, sort=False)
        for name, curve in sorted(curves, key=lambda item: [*self.looks, item[0]].index(item[0])):
            for q in spec.y:
                label = self.names.get(q) or self.names.get(
                    name, str(name) if len(spec.y) == 1 else q
                )
                look = axs.look(name) | self.looks.get(name, {}) | self.looks.get(q, {})
                y = curve[q].where(curve[self.hidden[q]] > 0) if q in self.hidden else curve[q]
                shown = curve.assign(**{q: y} | ({} if q.checked else dict.fromkeys(PARTS, np.nan)))
                axs.curve(ax, shown, spec.x, q, label=label, points=self.bars, **look)
            ends[name] = (curve[spec.x].iloc[-1], curve[spec.y[-1]].iloc[-1])
        if self.recorded and len(points := rows[rows["source"].str.startswith("measured")]):
            ax.plot(
                points[spec.x],
                points[spec.y[0]],
                **{"ls": "none", "marker": "x", "label": "recorded"} | self.recorded,
            )
        if self.ends is not None:
            style.label_ends(ax, ends, self.ends, self.heading)


@dataclass(frozen=True, kw_only=True)
class Phases:
    """Curves of a panel: one a time, with the line of its phase, earlier ones below. `colour`: of a
    surface, in every panel.
    """

    colour: str = ""
    order: Sequence[str] = PHASES

    def __call__(self, ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
        own = rows[is_simulated(rows)]
        times = [TIME] if TIME in own else []
        for (phase, *_), curve in sorted(
            own.groupby(["phase", *times]), key=lambda item: self.order.index(item[0][0])
        ):
            colour = axs.look(self.colour or curve["surface"].iloc[0])
            axs.curve(ax, curve, spec.x, spec.y[0], **colour | axs.PHASE_LINES[phase])


@dataclass(frozen=True, kw_only=True)
class Panels:
    """Panels in a grid, or below the stroked surface: one a value of the column `by`, or one of all
    rows.

    Attributes
    ----------
    by, names, shape
        Column, its values in order, rows and columns of the grid.
    pairs
        In place of values: quantities across and up, a panel each, of all rows.
    titles, corner
        ``titles(name)`` above a panel, ``corner(name)`` in its upper left.
    fill
        What is drawn in each: `Lines`, `Phases` or another ``fill(panel, rows, spec)``.
    limit
        Axes that end where the thesis's do: of the panel's rows, or of the whole frame if `alike`;
        "wide": or where the data do.
    marked
        Name of the one panel whose bracket says what it is; None: all.
    set, legend
        Arguments of ``Axes.set`` for every panel; of ``Axes.legend`` for the last one.
    xlabel, ylabel, each
        Words on the axes in place of those of x and y; on the middle panels of the edges, or on all
        panels there if `each`.
    share
        Whether panels in a grid share their axes, in matplotlib's words: ``sharex``, ``sharey``.
    """

    height: float
    header: float = 0.0
    by: str = ""
    names: Sequence[object] = ("",)
    pairs: Sequence[tuple[Q, Q]] = ()
    shape: tuple[int, int] = (1, 1)
    titles: Callable[[object], str] | None = None
    corner: Callable[[object], str] | None = None
    fill: Callable[[Axes, pd.DataFrame, Figure], None] = Lines()
    limit: str = "xy"
    alike: bool = False
    marked: object = None
    set: Mapping[str, object] = field(default_factory=dict)
    legend: Mapping[str, object] | None = None
    xlabel: str = ""
    ylabel: str = ""
    each: bool = False
    share: Mapping[str, object] = field(default_factory=dict)

    def draw(self, fig: Picture, frame: pd.DataFrame, spec: Figure) -> dict[object, Axes]:
        """Draw the panels; returned by name, the surface above under ``surface``."""
        if self.pairs:
            return self._draw_pairs(fig, frame, spec)
        (panels, grid), tops = self._place(fig, frame, spec), []
        for name, ax in panels.items():
            rows = axs.rows_of(frame, self.by, name) if self.by else frame
            within = axs.together(frame if self.alike else rows, spec.y)
            text = self.marked is None or name == self.marked
            if self.limit == "wide":
                axs.wide_limits(ax, within, spec.x, spec.y[0])
            elif self.limit == "xy":
                axs.limit_axes(ax, within, spec.x, spec.y[0], text)
            elif self.limit:
                axs.limit_axis(
                    ax, within, spec.x if self.limit == "x" else spec.y[0], self.limit, text
                )
            self.fill(ax, rows, spec)
            ax.set(**self.set)
            tops.append(ax.get_ylim()[1])
            if self.titles:
                ax.set_title(self.titles(name))
            if self.corner:
                ax.text(0.008, 0.97, self.corner(name), transform=ax.transAxes, va="top")
            for axis, q in ((ax.xaxis, spec.x), (ax.yaxis, spec.y[0])):
                if q in IN_KILO:
                    style.in_kilo(axis)
        if self.share.get("sharey"):  # the last limits that were set are those of all
            grid[0, 0].set_ylim(top=max(tops))
        high, wide = grid.shape
        for ax in grid[-1] if self.each else grid[-1, wide // 2 : wide // 2 + 1]:
            ax.set_xlabel(_in_kilo(self.xlabel or spec.x.label, spec.x))
        for ax in grid[:, 0] if self.each else grid[high // 2 : high // 2 + 1, 0]:
            ax.set_ylabel(_in_kilo(self.ylabel or spec.y[0].label, spec.y[0]))
        if self.legend is not None:
            grid[-1, -1].legend(**self.legend)
        return panels

    def _draw_pairs(self, fig: Picture, frame: pd.DataFrame, spec: Figure) -> dict[object, Axes]:
        grid = fig.subplots(*self.shape, **self.share).ravel()
        for ax, (x, y) in zip(grid, self.pairs, strict=False):
            axs.limit_axes(ax, frame, x, y, self.marked in (None, y))
            ax.set(xlabel=x.label, ylabel=y.label, **self.set)
            self.fill(ax, frame, replace(spec, x=x, y=(y,)))
            if y in IN_KILO:
                style.in_kilo(ax.yaxis)
            if self.share:
                ax.label_outer()
        if self.legend is not None:
            grid[-1].legend(**self.legend)
        return dict(zip(self.pairs, grid, strict=True))

    def _place(
        self, fig: Picture, frame: pd.DataFrame, spec: Figure
    ) -> tuple[dict[object, Axes], np.ndarray]:
        if spec.surface is None:
            grid = fig.subplots(*self.shape, squeeze=False, **self.share)
            return dict(zip(self.names, grid.ravel(), strict=False)), grid
        below = axs.below_surface(fig, frame, len(self.names), along=spec.x == DISTANCE)
        return dict(zip(self.names, below, strict=True)), np.array(below)[:, None]


def _in_kilo(words: str, q: Q) -> str:
    return words.replace("(Pa)", "(kPa)") if q in IN_KILO else words


@dataclass(frozen=True, kw_only=True)
class Own:
    """A picture of its own: ``paint(fig, frame, spec)`` draws it on the empty page."""

    height: float
    header: float = 0.0
    paint: Callable[[Picture, pd.DataFrame, Figure], None]

    def draw(self, fig: Picture, frame: pd.DataFrame, spec: Figure) -> dict[object, Axes]:
        self.paint(fig, frame, spec)
        return {}


def nine(names: Sequence[object], height: float, **options) -> Panels:
    """Nine panels in the thesis's order, the flat plate top left and the sharpest surface bottom
    right.
    """
    options = {"by": "surface", "titles": axs.surface_name} | options
    return Panels(height=height, names=names, shape=(3, 3), **options)


def stack(height: float, **options) -> Panels:
    """A panel a velocity below the surface."""
    options = {
        "by": "series",
        "corner": lambda series: f"v = {series}",
        "alike": True,
        "marked": "10 mm/s",
    } | options
    names = tuple(f"{v} mm/s" for v in style.SPEED_COLOURS)
    return Panels(
        height=height,
        names=names,
        **{"fill": Lines(looks=dict.fromkeys(names, {"ls": "-"}))} | options,
    )
