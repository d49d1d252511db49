"""A figure of the thesis, said once: which runs, which quantities, which layout; its data frame and
its picture follow.

::

    Figure("4-23", "Strain energy density 915 µm under the centre", NINE, TIME, (sed(915e-6),),
           thesis={TIME: "T189", SED: "T188"}, layout=Panels(3.0, fill=Lines(ends=2.62)))

A picture is a function of its frame alone, which is published beside it. The frame of most figures
is read by the quantities themselves (`Data.traces`); `rows` says another way, with the other
methods of `Data`, and `after` adds what only one figure has. What a layout does not say a plain
function does: `fill` in each panel, `extra` once they are drawn, or the whole `Page`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import wraps
from os import PathLike
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from pandas import DataFrame, Series
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures.findings import FINDINGS
from cysyk1999.measures.errors import (
    LEFT,
    PARTS,
    Companion,
    Companions,
    Curve,
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
from cysyk1999.publishing import style
from cysyk1999.publishing.tables import TEXT_COLUMNS, without_round_off
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import read_bands, read_force_depth, read_surface_profiles
from fingerpad.measures.features import (
    PHASES,
    SIMULATED,
    Feature,
    Histories,
    centre_node,
    in_contact,
    phase_indices,
    profile,
    width,
)
from fingerpad.measures.strokes import arcs, convexities, loaded, profile_and_height
from fingerpad.planning.errors import PROFILE_ORDER
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
MEASURED: Mapping[str, tuple[str, Callable[..., DataFrame]]] = {
    "force_depth": ("force_depth/*.csv", read_force_depth),
    "surface_profiles": ("surface_profiles.csv", lambda paths: read_surface_profiles(*paths)),
    "impulse_rates": ("impulse_rates/*.csv recordings/*.csv", lambda paths: read_rates(*paths)),
    "pads": ("reconstruction_bands.csv", lambda paths: read_bands(*paths)),
}
"""Data shown beside simulated ones, measured or of other pads, by name: their files in the folder
of reference data (one pattern or more), and their reader.
"""


# --- data -----------------------------------------------------------------------------------------


def stacked(parts: Callable[..., Iterable[DataFrame | Mapping]]) -> Callable[..., DataFrame]:
    """A generator of frames, or of their columns, as a function that returns them below each
    other; empty ones are left out.
    """

    @wraps(parts)
    def whole(*arguments, **options) -> DataFrame:
        frames = [DataFrame(part) for part in parts(*arguments, **options)]
        return pd.concat([part for part in frames if len(part)] or frames, ignore_index=True)

    return whole


@dataclass(frozen=True)
class Data:
    """What a figure's rows are made from: results by scene, the thesis's numbers, and measured data
    if it shows any.
    """

    histories: Histories
    meshes: Mapping[str, PadMesh]
    coarse: Companions
    reference: DataFrame
    measured: DataFrame | None = None

    def runs(self, runs: Runs) -> Iterator[tuple[str, Dataset, Companion | None]]:
        """Name, history, and companions if there are any, of every run."""
        for name, scene in runs.scenes.items():
            yield name, self.histories[scene], self.coarse.get(scene)

    @stacked
    def table(
        self, runs: Runs, read: Callable[[Dataset], Mapping], *curves: Curve
    ) -> Iterator[Mapping]:
        """Rows of every run: its name, the columns that ``read(history)`` gives, and the errors of
        the one of some curves that is furthest off.
        """
        for name, history, coarse in self.runs(runs):
            errors = curve_errors(history, coarse, *curves).columns
            yield {"source": SIMULATED, runs.column: name} | dict(read(history)) | errors

    def traces(self, runs: Runs, columns: Sequence[Q], checked: Sequence[Q] = ()) -> DataFrame:
        """One row an output: the run's name, the columns, and the errors of what is `checked` (of
        all that count).
        """
        over = over_stroke if runs.stroke else over_time

        def read(history: Dataset) -> dict[str, np.ndarray]:
            shown = loaded(history) if runs.stroke else history
            return {q: q.read(shown) for q in columns}

        return self.table(runs, read, *(over(q.read) for q in checked or columns if q.checked))

    def strokes(
        self, runs: Iterable[Runs], columns: Sequence[Q], ends: tuple[float, float]
    ) -> DataFrame:
        """The surface between two ends (mm), and the traces of strokes from the first on."""
        scenes = {name: scene for each in runs for name, scene in each.scenes.items()}
        scene = scenes.get("10 mm/s") or next(iter(scenes.values()))
        rows = pd.concat([self.traces(each, columns) for each in runs])
        rows = rows[rows[DISTANCE] >= ends[0] - 1e-9]
        return pd.concat([self.surface(scene, *ends), rows], ignore_index=True)

    @stacked
    def profiles(self, runs: Runs, over: Q = X, half: bool = False) -> Iterator[DataFrame]:
        """Pressure over the contact at the shown outputs, against place or displacement: at nodes,
        where they are by then, and between the last and the edge.
        """
        for name, history, coarse in self.runs(runs):
            for index, phase in phase_indices(history):
                time = float(history["time"][index])
                curve = at_output(time, edged_profile, PROFILE_ORDER)
                errors = curve_errors(history, coarse, curve)
                near = in_contact(history, index)
                if not near.any():
                    continue
                x, p = edged_profile(history, index)
                places = 1e3 * x
                if over == DOWN:
                    sunk = -1e3 * history["skin_displacement_y"].values[index]
                    places = np.interp(x, profile(history, index)[0][near], sunk[near])
                rows = {"phase": phase, TIME: time, over: places, P: p}
                rows = DataFrame(rows | errors.columns | {runs.column: name})
                yield rows[x >= 0] if half else rows

    def numbers(self, runs: Runs, columns: Mapping[Q, Feature], own: bool = False) -> DataFrame:
        """One row a run, of strokes one a convexity: `source`, curvature, numbers, the largest of
        their errors, relative to the largest of all or to its `own`.
        """

        def read(history: Dataset) -> DataFrame:
            return DataFrame({q: Series(each(history), dtype=float) for q, each in columns.items()})

        parts = []
        for _, history, coarse in self.runs(runs):
            fine = read(history)
            others = (read(thinned(history)), *instead(history, coarse, read))
            arcs_at = {label: arc.curvature for label, arc in convexities(history).items()}
            at = Series(arcs_at if runs.stroke else curvature_of(history), name=CURVATURE)
            parts.append([fine, *(each.reindex(fine.index) for each in (at, *others))])
        named = {"keys": list(runs), "names": [runs.column, "convexity"]}
        fine, at, sparse, mesh, left, both = (
            pd.concat(each, **named) for each in zip(*parts, strict=True)
        )
        sizes = fine.abs() if own else fine.abs().max()
        errors = largest_of([(fine, mesh), (left, both), (fine, sparse)], sizes)
        rows = pd.concat([at, fine, errors], axis=1).reset_index().assign(source=SIMULATED)
        return rows if runs.stroke else rows.drop(columns="convexity")

    def surface(self, scene: str, low: float, high: float) -> DataFrame:
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
        return DataFrame(part | {HEIGHT: heights, CURVATURE: curvature})

    def bands(
        self,
        column: str,
        measures: Mapping[str, Mapping[str, object]],
        read: Callable[[float], float] = float,
    ) -> DataFrame:
        """How far other pads differ that the thesis's figures do not rule out: two rows (its ends)
        a surface and measure.

        `measures`: name of a measure of `cysyk1999.reference_data.read_bands` -> further cells of
        its rows; `read` makes of an end that of the column.
        """
        if self.measured is None:
            return DataFrame()
        rows = []
        for band in self.measured[self.measured["measure"].isin(measures)].itertuples():
            words = f"that the thesis's figures do not tell apart: {band.pads:.0f})"
            of = {"surface": band.surface, "source": f"{axs.OTHER_PADS} {words}"}
            ends = sorted((read(band.low), read(band.high)))
            rows += [of | measures[band.measure] | {column: end} for end in ends]
        return DataFrame(rows)

    def axis(self, column: str, ids: Ids, key: str = "surface") -> DataFrame:
        """Rows that mark a thesis axis range: two (its ends) for each id that the reference has,
        `source` saying so; with ids by panels, `key` holds the panel.
        """
        rows = []
        for panel, id_ in (ids if isinstance(ids, Mapping) else {None: ids}).items():
            if id_ in self.reference.index:
                entry = self.reference.loc[id_]
                doubt = ", reading uncertain" if entry["kind"] == "garbled" else ""
                of = {"source": f"thesis axis range ({id_}{doubt})"}
                of |= {} if panel is None else {key: panel}
                rows += [of | {column: entry[end]} for end in ("low", "high")]
        return DataFrame(rows)


def edged_profile(history: Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
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


def upper_profile(history: Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Deformed lateral position (m) and pressure (Pa) of the skin nodes of the upper side at one
    output.
    """
    upper = history["skin_y"].values > 0
    return tuple(part[upper] for part in profile(history, index))


def largest_of(
    pairs: Sequence[tuple[DataFrame, DataFrame]], sizes: DataFrame | Series
) -> DataFrame:
    """The errors (columns `PARTS`, %) of each row's number that is furthest off, relative to sizes;
    none of what is zero.

    pairs: numbers that differ by the mesh, by the steps, and by how many outputs are read.
    """
    parts = np.array(
        [
            100 * left * (a - b).abs() / sizes.replace(0, np.nan)
            for left, (a, b) in zip(LEFT, pairs, strict=True)
        ]
    )
    worst = np.nansum(parts, axis=0).argmax(axis=1)
    largest = parts[:, np.arange(len(worst)), worst]
    return DataFrame(largest.T, pairs[0][0].index, list(PARTS))


# --- figures --------------------------------------------------------------------------------------


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
        Column -> id of the thesis's axis range, or ids by panels.
    layout
        Its picture: :class:`Panels`, or a :class:`Page` that a function draws.
    rows
        ``rows(data)``: the rows before those of the axis ranges, where they are not the traces of
        `y` over `x`.
    after
        ``after(data)``: rows after them.
    surface
        Ends (mm) of the stroked surface that is drawn above.
    judged_with
        Further runs, which its verdict needs, where there are any.
    measured
        Name of the measured data (a key of `MEASURED`) shown beside; empty: none.
    joined
        Column that names the lines which points are joined to, if they are: the error stated is the
        largest of a line.
    how, note
        How the error is taken; or ``note(frame)``, the line under the picture but for the thesis's
        statement.
    at_rest
        Whether the specimen is shown before anything touches it.
    width
        Inch: of a page, or of a column for a single curve.
    """

    number: str
    title: str
    runs: Runs | tuple[Runs, ...]
    x: Q
    y: tuple[Q, ...]
    thesis: Mapping[str, Ids]
    layout: Panels | Page
    rows: Callable[[Data], DataFrame] | None = None
    after: Callable[[Data], DataFrame] = lambda data: DataFrame()
    surface: tuple[float, float] | None = None
    judged_with: tuple[Runs, ...] = ()
    measured: str = ""
    joined: str = ""
    how: str = ""
    note: Callable[[DataFrame], Sequence[str]] | None = None
    at_rest: bool = False
    width: float = style.PAGE_WIDTH

    @property
    def all_runs(self) -> tuple[Runs, ...]:
        """Its sets of runs that are shown."""
        return (self.runs,) if isinstance(self.runs, Runs) else self.runs

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the scenes whose histories the frame is made from."""
        return tuple(dict.fromkeys(s for runs in self.all_runs for s in runs.scenes.values()))

    @property
    def judged_by(self) -> tuple[str, ...]:
        """Names of the scenes that the verdict is made from: what is shown, and `judged_with`."""
        further = (scene for runs in self.judged_with for scene in runs.scenes.values())
        return tuple(dict.fromkeys((*self.needs, *further)))

    @property
    def read_companions(self) -> tuple[str, ...]:
        """Names of the scenes whose coarse companions the frame reads."""
        return tuple(dict.fromkeys(s for runs in self.all_runs for s in runs.companion_scenes))

    def measurements(self, folder: str | PathLike) -> tuple[DataFrame, ...]:
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
        reference: DataFrame,
        measured: DataFrame | None = None,
    ) -> DataFrame:
        """The tidy data frame, units in the column names; simulated rows first, a `source` in every
        row; words in the first columns, errors in the last.

        `coarse` holds the companions on coarser meshes (may be empty: errors of mesh and steps are
        then NaN), `reference` is the table of `read_reference` (may be empty: thesis ranges are
        then left out), `measured` a table of `measurements`.
        """
        data = Data(histories, meshes, coarse, reference, measured)
        rows = self.rows(data) if self.rows else self.traces(data)
        if "source" not in rows:
            rows = rows.assign(source=SIMULATED)
        by = self.layout.by or "surface"
        marks = [data.axis(column, ids, by) for column, ids in self.thesis.items()]
        marks = [part for part in (*marks, self.after(data)) if len(part)]
        frame = without_round_off(pd.concat([rows, *marks], ignore_index=True))
        words = [column for column in TEXT_COLUMNS if column in frame]
        numbers = [column for column in frame if column not in (*words, *PARTS)]
        return frame[[*words, *numbers, *PARTS]]

    def traces(self, data: Data) -> DataFrame:
        """The traces of `y` over `x`, below the surface if that is drawn."""
        columns = (self.x, *self.y)
        if self.surface:
            return data.strokes(self.all_runs, columns, self.surface)
        parts = [data.traces(runs, columns) for runs in self.all_runs]
        return pd.concat(parts, ignore_index=True)

    def finding(self, frame: DataFrame) -> str:
        """What the picture shows in a sentence, with its numbers (`findings`)."""
        return FINDINGS[self.number](frame) if self.number in FINDINGS else ""

    @property
    def icon(self) -> str:
        """What is done to the finger (`style.draw_icon`); nothing where it is at rest."""
        if self.at_rest:
            return ""
        words = "stroke" if any(runs.stroke for runs in self.all_runs) else "press"
        inside = ("strain_energy", "impulse", "burst")
        return words + " receptor" * any(q.startswith(inside) for q in self.y)

    def draw(self, frame: DataFrame) -> Picture:
        """The picture, a function of the frame alone."""
        page, wide = self.layout, style.note_width(self.width)
        if self.note:
            lines = style.wrapped(self.note(frame), wide)
        else:
            through = [(self.joined, q) for q in self.y if self.joined]
            how = self.how or (HOW if self.surface else "")
            lines = axs.footnote(frame, how, wide, through)
        shows = f"after Cysyk 1999, Fig. {self.number}: {self.title}"
        with style.theme():
            fig = style.sheet(
                self.finding(frame) or self.title,
                lines,
                page.height,
                width=self.width,
                shows=shows,
                mark=axs.verdict(frame),
                icon=self.icon,
            )
            page.draw(fig, frame, self)
            axs.declare_range(fig, wide)
            return style.finished(fig)


# --- layouts --------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Lines:
    """Curves of a panel: one a name in the column `by` (left out, that of the runs) and quantity.
    Those of a figure whose points are `joined` are points, whose errors are drawn as bars, not as
    bands. What was recorded is drawn as crosses.

    Attributes
    ----------
    looks
        Of names (in their order) and quantities: over those of `axes.look`.
    names
        What a legend says; also of what was ``recorded``.
    ends
        Place (x) where surfaces are named directly.
    hidden
        Quantity -> that which must be above 0 where it is shown.
    """

    by: str = ""
    looks: Mapping[str, Look] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    ends: float | None = None
    hidden: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, ax: Axes, rows: DataFrame, spec: Figure) -> None:
        """Draw the curves of some rows of a figure's frame."""
        ends, order = {}, list(self.looks)
        curves = axs.simulated(rows).groupby(self.by or spec.all_runs[0].column, sort=False)
        for name, curve in sorted(curves, key=lambda item: [*order, item[0]].index(item[0])):
            usual = self.names.get(name, name)
            for q in spec.y:
                label = self.names.get(q, usual if len(spec.y) == 1 else q)
                look = axs.look(name) | self.looks.get(name, {}) | self.looks.get(q, {})
                shown = curve if q.checked else curve.assign(**dict.fromkeys(PARTS, np.nan))
                if q in self.hidden:
                    shown = shown.assign(**{q: shown[q].where(shown[self.hidden[q]] > 0)})
                axs.curve(ax, shown, spec.x, q, label=label, points=bool(spec.joined), **look)
            ends[name] = tuple(curve[[spec.x, spec.y[-1]]].iloc[-1])
        points = axs.from_source(rows, "measured")
        if len(points):
            look = {"color": style.MEASURED, "label": self.names.get("recorded", "recorded")}
            ax.plot(points[spec.x], points[spec.y[0]], "x", **look)
        if self.ends is not None:
            style.label_ends(ax, ends, self.ends, "curvature (1/m)")


@dataclass(frozen=True, kw_only=True)
class Phases:
    """Curves of a panel: one a time, with the line of its phase, earlier ones below. `colour`: of a
    surface, in every panel.
    """

    colour: str = ""
    order: Sequence[str] = PHASES

    def __call__(self, ax: Axes, rows: DataFrame, spec: Figure) -> None:
        """Draw the curves of some rows of a figure's frame."""
        own = axs.simulated(rows)
        curves = own.groupby(["phase", *own.columns.intersection([TIME])])
        for (phase, *_), curve in sorted(curves, key=lambda item: self.order.index(item[0][0])):
            colour = axs.look(self.colour or curve["surface"].iloc[0])
            axs.curve(ax, curve, spec.x, spec.y[0], **colour | axs.PHASE_LINES[phase])


def above(ax: Axes, name: object) -> None:
    """A panel's name, where it is one, above it."""
    ax.set_title(axs.surface_name(name) if name in style.COLOURS else str(name))


def inside(ax: Axes, name: object) -> None:
    """A velocity in the upper left of its panel."""
    axs.remark(ax, 0.008, 0.97, f"v = {name}", va="top")


@dataclass(frozen=True)
class Panels:
    """Panels in a grid, or below the stroked surface: one a value of the column `by`, or one of all
    rows. Of an odd number of rows or columns only the middle one has words on its axes.

    Attributes
    ----------
    height
        Of the page (inch).
    by, names, across
        Column, its values in order, and how many panels stand side by side. Without `by` the names
        may be quantities across and up, a panel each, of all rows.
    title
        ``title(ax, name)``: names a panel of those `by` a column.
    fill
        What is drawn in each: `Lines`, `Phases` or another ``fill(ax, rows, spec)``.
    limit
        Axes that end where the thesis's do: of the panel's rows, or of the whole frame if `alike`.
    marked
        Name of the one panel whose bracket says what it is; None: all.
    set, legend
        Arguments of ``Axes.set`` for every panel; of ``Axes.legend`` for the last one.
    share
        Whether panels in a grid share their axes, in matplotlib's words: ``sharex``, ``sharey``.
    extra
        ``extra(panels, frame)``: what the rest does not say, on the panels by their names.
    """

    height: float
    by: str = ""
    names: Collection = ("",)
    across: int = 1
    title: Callable[[Axes, object], None] = above
    fill: Callable[[Axes, DataFrame, Figure], None] = Lines()
    limit: str = "xy"
    alike: bool = False
    marked: object = None
    set: Mapping[str, object] = field(default_factory=dict)
    legend: Mapping[str, object] | None = None
    share: Mapping[str, object] = field(default_factory=dict)
    extra: Callable[[Mapping[object, Axes], DataFrame], None] | None = None

    def draw(self, fig: Picture, frame: DataFrame, spec: Figure) -> None:
        """Draw the panels on a page."""
        high, wide = len(self.names) // self.across, self.across
        if spec.surface:
            axes = axs.below_surface(fig, frame, high, along=spec.x == DISTANCE)
        else:
            axes = fig.subplots(high, wide, squeeze=False, **self.share).ravel()
        panels, tops = dict(zip(self.names, axes, strict=True)), []
        for k, (name, ax) in enumerate(panels.items()):
            pair, (row, column) = isinstance(name, tuple), divmod(k, wide)
            of = replace(spec, x=name[0], y=name[1:]) if pair else spec
            rows = axs.rows_of(frame, self.by, name) if self.by else frame
            if pair or (row == high - 1 and (high == 1 or column in middle(wide))):
                ax.set_xlabel(of.x.label)
            if pair or (column == 0 and row in middle(high)):
                ax.set_ylabel(of.y[0].label)
            limited = {"x": of.x, "y": of.y[0]}
            within = axs.together(frame if self.alike else rows, of.y)
            text = self.marked is None or self.marked in (name, of.y[0])
            axs.limit_axes(ax, within, text=text, **{k: limited[k] for k in self.limit})
            self.fill(ax, rows, of)
            ax.set(**self.set)
            tops.append(ax.get_ylim()[1])
            if self.by:
                self.title(ax, name)
            for axis, q in ((ax.xaxis, of.x), (ax.yaxis, of.y[0])):
                if q in IN_KILO:
                    style.in_kilo(axis)
            if pair and self.share:
                ax.label_outer()
        if self.share.get("sharey"):  # the last limits that were set are those of all
            axes[0].set_ylim(top=max(tops))
        if self.legend is not None:
            axes[-1].legend(**self.legend)
        if self.extra:
            self.extra(panels, frame)


def middle(count: int) -> Sequence[int]:
    """Which of some rows or columns have words on their axes: of an odd number the middle one, of
    an even one all.
    """
    return [count // 2] if count % 2 else range(count)


@dataclass(frozen=True)
class Page:
    """A picture of its own: ``draw(fig, frame, spec)`` draws it on the empty page; `by` names the
    column of the panels, if the thesis's axes differ between them.
    """

    height: float
    draw: Callable[[Picture, DataFrame, Figure], None]
    by: str = ""


def nine(names: Collection, height: float, **options) -> Panels:
    """Nine panels in the thesis's order, the flat plate top left and the sharpest surface bottom
    right.
    """
    return Panels(height, names=names, across=3, **{"by": "surface"} | options)


def stack(height: float, **options) -> Panels:
    """A panel a velocity below the surface."""
    names = tuple(f"{v} mm/s" for v in style.MEANINGS["speed (mm/s)"])
    solid = Lines(looks=dict.fromkeys(names, {"ls": "-"}))
    alike = {"by": "series", "fill": solid, "title": inside, "alike": True, "marked": "10 mm/s"}
    return Panels(height, names=names, **alike | options)
