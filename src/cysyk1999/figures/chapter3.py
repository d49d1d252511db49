"""Chapter 3: the model's section and its mesh, its surface profiles, forces and layer boundaries,
beside what was measured.

The thesis compares with recordings of single subjects and with MRI sections. Those are not
available and nothing is drawn in their place: Figs 3-6 and 3-7 carry published measurements of
other or partly the same subjects, the others the model alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures.geometry import (
    LAYERS,
    NOTE,
    boundaries,
    densify,
    draw_mesh,
    inward,
    layer_patches,
    mesh_rows,
    quality_of,
    section,
    section_errors,
    stratum_corneum,
    surface_deflection,
)
from cysyk1999.figures.grammar import Data, Figure, Page, Panels, stacked
from cysyk1999.measures.errors import PARTS, Curve, curve_errors, number_errors, over_time
from cysyk1999.measures.quantities import DEFLECTION, DEPTH, NEWTON, TIME, X, Y
from cysyk1999.measures.runs import NINE, Runs
from cysyk1999.measures.steady import (
    BAR,
    DEPTH_SCENES,
    PLATE,
    PROFILES,
    SPEED_SCENES,
    contact_length,
    force_N,
    leg_end,
    pressed_depths,
    steady_force,
)
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED

FLAT = NINE.only(("flat",))
STEADY_PLATE = Runs("series", {"model": PLATE})
SECTIONS = {
    "no load": (BAR, 0.0),
    "1/8 inch cylinder, 1 mm": ("steady_cylinder_1_8_inch", 1e-3),
    "1/4 inch cylinder, 1 mm": ("steady_cylinder_1_4_inch", 1e-3),
    "1 inch cylinder, 1 mm": ("steady_cylinder_1_inch", 1e-3),
    "1/16 inch bar, 1 mm": (BAR, 1e-3),
    "1/16 inch bar, 2 mm": (BAR, 2e-3),
}
"""Panels of Fig 3-11: scene and depth (m)."""
BAR_SECTIONS = {"undeformed": (BAR, 0.0), "1/16 inch bar, 2 mm": (BAR, 2e-3)}
"""Those of Fig 3-10."""
# mm, half of the surface shown: beyond it the flanks are too steep for a deflection at a distance
SHOWN = 7.5
STATE_LINES = {"undeformed": {"ls": "-", "lw": 0.6, "color": style.GREY}, "deformed": {"lw": 1.2}}
SMALL = {"ha": "center", "va": "center", "fontsize": 6.5}
LONG = "contact length "


def noted(words: str) -> Callable[[DataFrame], list[str]]:
    """A note in words about a frame's error and contact length."""

    def note(frame: DataFrame) -> list[str]:
        error = axs.error_text(frame) or "Errors not computed"
        return [words.format(error=error, length=length_in(frame))]

    return note


def with_length(history: Dataset) -> str:
    """Source of simulated rows that tells the contact length."""
    return f"{SIMULATED}: {LONG}{1e3 * contact_length(history):g} mm"


def length_in(frame: DataFrame) -> float:
    """The contact length (mm) that a frame's sources tell; not a number if none does."""
    return frame["source"].str.extract(rf"{LONG}([\d.]+) mm")[0].astype(float).max()


# --- 3-4, 3-5: the section and its mesh -----------------------------------------------------------


@stacked
def section_lines(data: Data) -> Iterator[Mapping]:
    """Closed boundaries of the section, outside to inside, named by the layer they enclose."""
    mesh = data.meshes[FLAT["flat"]]
    lines = {name: mesh.points[nodes] for name, nodes in boundaries(mesh).items()}
    lines["stratum corneum"] = lines["skin"]
    lines["epidermis"] = inward(lines["skin"], stratum_corneum(data.histories[FLAT["flat"]]))
    for layer in LAYERS:
        x, y = 1e3 * lines[layer].T
        yield {"layer": layer, X: x, Y: y} | dict.fromkeys(PARTS, np.nan)


def three_sections(fig, frame, spec):
    """Boundaries of the section: layers, symmetry, stratum corneum."""
    axes = fig.subplots(1, 3, sharey=True)
    titles = ("layers and bone", "layers offset from the skin", "with stratum corneum")
    for ax, title in zip(axes, titles, strict=True):
        ax.set(title=title, aspect="equal", xlabel=X.label)
        ax.set(xlim=(-10, 10), ylim=(-8.2, 9.6), yticks=[-6, -3, 0, 3, 6])
        ax.tick_params(labelleft=True)
    axes[0].set_ylabel(Y.label)
    layered = layer_loops(frame)
    without = layered | {"epidermis": layered["stratum corneum"]}  # all of it as epidermis
    skin = without.pop("stratum corneum")
    paint(axes[0], without)
    point_at_layer(axes[0], without, "epidermis", -7.0, -7.0)
    point_at_layer(axes[0], without, "dermis", -1.0, -1.0)
    name_fat_and_bone(axes[0], without)
    wide, high = np.ptp(skin, axis=0)
    axes[0].text(0, -7.3, f"{wide:.1f} × {high:.1f} mm", **SMALL)

    top = {layer: line[:, 1].max() for layer, line in layered.items()}
    thick = top["stratum corneum"] - top["dermis"], top["dermis"] - top["fat"]
    offset_construction(axes[1], without, thick)
    text = f"epidermis {thick[0]:.2f} mm, dermis {thick[1]:.2f} mm\n"
    text += "dots: so far along the normals of the skin"
    axes[1].text(0, 9.3, text, **SMALL | {"va": "top"})

    paint(axes[2], layered)
    text = f"stratum corneum, {top['stratum corneum'] - top['epidermis']:.2f} mm"
    point_out(axes[2], text, (0, 5.85), (0, 8.3))


def offset_construction(ax: Axes, loops: dict[str, np.ndarray], thick: tuple[float, float]) -> None:
    """The boundaries, and points on the normals of the skin at the layers' thicknesses (mm), which
    lie on them.
    """
    for loop in loops.values():
        ax.plot(*loop.T, color=style.INK, lw=0.8)
    skin = densify(loops["epidermis"], 0.2)
    moved = [inward(skin, depth) for depth in (thick[0], sum(thick))]
    for k in range(0, len(skin) - 1, 16):
        feet = [line[k] for line in moved]
        if skin[k, 1] > -1.0:
            ax.plot(*np.transpose([skin[k], feet[-1]]), color=style.HIGHLIGHT, lw=0.6)
            ax.plot(*np.transpose(feet), "o", color=style.HIGHLIGHT, ms=1.8)


def upper(loop: np.ndarray, x: float) -> float:
    """Height at which a closed line passes `x` on its upper side."""
    near = loop[np.argsort(abs(loop[:, 0] - x))]
    return float(near[near[:, 1] > loop[:, 1].mean()][0, 1])


def point_out(ax: Axes, text: str, at: tuple[float, float], label: tuple[float, float]) -> None:
    """Name a place with a hairline."""
    line = {"arrowstyle": "-", "lw": 0.6, "color": style.INK, "shrinkA": 0, "shrinkB": 0}
    ax.annotate(text, at, label, arrowprops=line, **SMALL)


def layer_loops(rows: DataFrame, names: Sequence[str] = LAYERS) -> dict[str, np.ndarray]:
    """Layer -> its outer boundary (n, 2) in mm, outside to inside, of rows that call them so."""
    lines = {name: line[[X, Y]].to_numpy() for name, line in rows.groupby("layer")}
    return {layer: lines[name] for layer, name in zip(LAYERS, names, strict=True)}


def point_at_layer(
    ax: Axes, loops: dict[str, np.ndarray], layer: str, x: float, at: float, y: float = 8.3
) -> None:
    """Name a layer, halfway to the next one at `x`, at a place above."""
    names = list(loops)
    outer, inner = loops[layer], loops[names[names.index(layer) + 1]]
    point_out(ax, layer, (x, (upper(outer, x) + upper(inner, x)) / 2), (at, y))


def name_fat_and_bone(ax: Axes, loops: dict[str, np.ndarray]) -> None:
    """Their names in the middle of each."""
    fat, bone = loops["fat"], loops["bone"]
    ax.text(0, (upper(fat, 0.0) + upper(bone, 0.0)) / 2, "fat", **SMALL)
    ax.text(0, (bone[:, 1].min() + bone[:, 1].max()) / 2, "bone", **SMALL)


def paint(ax: Axes, loops: dict[str, np.ndarray], line: float = 0.6) -> None:
    """Paint the layers in their colours, outside to inside."""
    for layer, loop in loops.items():
        colour = style.LAYER_COLOURS[layer]
        ax.fill(*loop.T, facecolor=colour, edgecolor=style.INK, lw=line)


def shaded_mesh(ax, frame, spec):
    """The mesh, layers shaded."""
    draw_mesh(ax, frame)
    held = style.handle("held, as is the bone", color=style.INK, lw=2.4)
    place = {"loc": "upper left", "bbox_to_anchor": (0.0, 1.02)}
    ax.legend(handles=[*layer_patches(), held], handlelength=1.2, **place)
    value = quality_of(frame)
    text = (
        f"{value['nodes (1)']:,.0f} nodes\n{value['elements (1)']:,.0f} elements\n"
        f"nodes under the contact {value['node_spacing_under_contact (um)']:.0f} µm apart\n"
        f"smallest edge, behind the bone {value['smallest_edge (um)']:.0f} µm\n"
        f"worst scaled Jacobian {value['worst_scaled_jacobian (1)']:.2f}"
    )
    ax.text(9.9, 6.75, text, ha="right", va="top", fontsize=6.5, linespacing=1.4)


# --- 3-6, 3-7: beside what was measured -----------------------------------------------------------


def measured_source(rows: DataFrame) -> str:
    """One word for all: where measured rows come from."""
    return f"measured ({'; '.join(rows['source'].unique())}; digitised by a third party)"


def shown_deflection(history: Dataset, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Lateral distance and deflection (m) of the surface that is shown, pressed to a depth (m)."""
    x, deflection = surface_deflection(history, leg_end(history, depth))
    near = abs(x) <= SHOWN * 1e-3
    return x[near], deflection[near]


@stacked
def deflections(data: Data) -> Iterator[Mapping]:
    """Deflection of the skin in the steady state at several depths of three indenters, and measured
    ones.
    """
    runs, rows = Runs("panel", PROFILES), data.measured
    for panel, history, coarse in data.runs(runs):
        for depth in pressed_depths(history):
            read = partial(shown_deflection, depth=depth)
            errors = curve_errors(history, coarse, Curve(read, outputs=False)).columns
            x, y = (1e3 * each for each in read(history))
            part = {"source": SIMULATED, "panel": panel, "series": f"{depth * 1e3:g} mm"}
            yield part | {X: x, DEFLECTION: y} | errors
    for panel, history, _ in data.runs(runs):
        if rows is None or "cylinder" not in panel:
            continue
        depths = [f"{depth * 1e3:g} mm" for depth in pressed_depths(history)]
        same = rows[np.isclose(rows["diameter_mm"], float(panel.split()[1]))]
        series = same["depth_mm"].map("{:g} mm".format)
        same = same.assign(series=series)[series.isin(depths)]
        part = {"source": measured_source(same), "panel": panel, "series": same["series"]}
        yield part | {X: same["lateral_distance_mm"], DEFLECTION: -same["deflection_mm"]}


def at_depths(ax, rows, spec):
    """Simulated (lines) and measured (points), a colour a depth."""
    simulated, handles = axs.simulated(rows), []
    panel = simulated["panel"].iloc[0]
    round_one = "cylinder" in panel
    looks = style.ordered("depth", simulated["series"])
    for name, curve in simulated.groupby("series", sort=False):
        look = looks[name]
        axs.curve(ax, curve, X, DEFLECTION, color=look["color"], ls=look["ls"], lw=1.2)
        points = axs.from_source(rows, "measured")
        points = points[points["series"] == name]
        ax.plot(points[X], points[DEFLECTION], look["marker"], color=style.MEASURED, ms=3)
        marker = look["marker"] if round_one else ""
        green = {"mfc": style.MEASURED, "mec": style.MEASURED}
        handles.append(style.handle(name, **look | green | {"marker": marker}, ms=3))
    axs.limit_axes(ax, rows, X)
    ax.legend(handles=handles, title="depth", loc="lower left", handlelength=2.4, borderaxespad=0.1)
    words = misfit_at_the_rim(rows) if round_one else "steep walls:\nthe blade is\n0.1 mm wide"
    axs.remark(ax, 0.99, 0.03, words, ha="right", fontsize=6)


def misfit_at_the_rim(rows: DataFrame) -> str:
    """In words, how far the deepest measured profile and the model are apart at its outermost
    point.
    """
    deepest = axs.simulated(rows)["series"].iloc[-1]
    shown = rows[rows["series"] == deepest].sort_values(X)
    curve, points = axs.simulated(shown), axs.from_source(shown, "measured")
    if points.empty:
        return ""
    x, y = points[[X, DEFLECTION]].iloc[-1]
    here = np.interp(x, curve[X], curve[DEFLECTION])
    return f"at {x:g} mm,\n{deepest} deep:\n{y:+.2f} measured\n{here:+.2f} model"


def one_bracket(panels, frame):
    """Beside the last panel, for all."""
    for ax in list(panels.values())[:-1]:
        for text in list(ax.texts):
            if text.get_text() in ("", "thesis axis\nrange"):
                text.remove()


@stacked
def forces_over_depth(data: Data) -> Iterator[DataFrame]:
    """Steady force against the depth of a flat plate, and the measured forces of each subject."""

    def read(history: Dataset) -> dict[str, np.ndarray]:
        return {DEPTH: DEPTH.read(history), NEWTON: NEWTON.read(history)}

    curve = Curve(lambda history: tuple(read(history).values()), outputs=False)
    model = data.table(STEADY_PLATE, read, curve)
    yield model.assign(source=with_length(data.histories[PLATE]))
    if (rows := data.measured) is None:
        return
    rows = rows[(rows["indenter"] == "flat plate") & (rows["speed_mm_per_s"] == 0)]
    here = np.interp(rows["depth_mm"], model[DEPTH], model[NEWTON])
    factor = here @ rows["force_N"] / (here @ here)
    source = f"{SIMULATED}: times {factor:.3g}, closest to the measured forces"
    fitted = {"series": "model, fitted", NEWTON: factor * model[NEWTON]}
    yield model.assign(source=source, **fitted)
    for subject, part in rows.groupby("subject", sort=False):
        of = {"source": measured_source(part), "series": f"subject {subject}"}
        yield DataFrame(of | {DEPTH: part["depth_mm"], NEWTON: part["force_N"]})


def model_and_subjects(ax, frame, spec):
    """The model's force, the same times a factor, and what was measured."""
    model, fitted = (frame[frame["series"] == name] for name in ("model", "model, fitted"))
    long = length_in(frame)
    ax.plot(model[DEPTH], model[NEWTON], color=style.INK, label=f"model, {LONG}{long:g} mm")
    others = axs.from_source(frame, "measured")
    if len(fitted):
        factor = float((fitted[NEWTON] / model[NEWTON].to_numpy()).max())
        length = f"model times {factor:.2f}: a length of {long * factor:.1f} mm, or softer"
        ax.plot(fitted[DEPTH], fitted[NEWTON], color=style.HIGHLIGHT, ls=style.DASHED, label=length)
        mean = others.groupby(DEPTH)[NEWTON].mean().iloc[[0, -1]]
        over = np.interp(mean.index, model[DEPTH], model[NEWTON]) / mean
        first, last = (f"{times:.1f} at {depth:g} mm" for depth, times in over.items())
        words = (
            f"model over the mean of the subjects: {first}, {last}.\n"
            "A plane section touches as long a stretch of the finger\n"
            "at every depth; a finger touches more of it the deeper."
        )
        axs.remark(ax, 0.03, 0.55, words, va="top", fontsize=6.5)
    for name, look in style.ordered("subject", others["series"]).items():
        rows = others[others["series"] == name]
        ax.plot(rows[DEPTH], rows[NEWTON], **look | {"ls": "none"}, ms=4.5, label=name)


# --- 3-8, 3-9: ramp and hold ----------------------------------------------------------------------


@stacked
def ramp_and_hold(data: Data, runs: Runs, until: float) -> Iterator[Mapping]:
    """Force over time of each scene up to a time, and its steady level, as two rows to the same
    time.
    """
    ((_, plate, companion),) = data.runs(STEADY_PLATE)
    for series, history, coarse in data.runs(runs):
        time = history["time"].values
        shown = np.append(time[time < until * (1 - 1e-9)], until)
        of = {"source": with_length(history), "series": series}
        force = {TIME: shown, NEWTON: np.interp(shown, time, force_N(history))}
        errors = curve_errors(history, coarse, over_time(force_N)).columns
        yield of | {"phase": "ramp and hold"} | force | errors
        level = partial(steady_force, depth=max(pressed_depths(history)))
        force = {TIME: [0.0, until], NEWTON: level(plate)}
        errors = number_errors(plate, companion, level).columns
        yield of | {"phase": "steady state"} | force | errors


def forces_over_time(ax, frame, spec, at_curves):
    """Curves and steady levels, each with its name and peak over steady force: at the curve's end
    or in a legend.
    """
    simulated = axs.simulated(frame)
    dashes = {"lw": 0.7, "ls": (0, (2, 2)), "color": style.GREY}
    looks = style.ordered("depth", simulated["series"])
    for name, rows in simulated.groupby("series", sort=False):
        curve, steady = (part for _, part in rows.groupby("phase"))
        ax.plot(steady[TIME], steady[NEWTON], **dashes)
        label = f"{name}: peak / steady {curve[NEWTON].max() / steady[NEWTON].iloc[0]:.2f}"
        look = looks[name] | {"marker": "", "label": "_" * at_curves + label}
        axs.curve(ax, curve, TIME, NEWTON, **look)
        if at_curves:
            away = {"xytext": (-2, 5), "textcoords": "offset points", "ha": "right"}
            ax.annotate(label, curve[[TIME, NEWTON]].iloc[-1], fontsize=6.5, **away)
    ax.plot([], [], label="steady state, solved as such", **dashes)


def held(
    number: str,
    title: str,
    scenes: Mapping[str, str],
    unit: str,
    until: float,
    thesis: Mapping[str, str],
    at_curves: bool,
) -> Figure:
    """Figs 3-8 and 3-9."""
    runs = Runs("series", {f"{label} {unit}": scene for label, scene in scenes.items()})
    fill = partial(forces_over_time, at_curves=at_curves)
    return Figure(
        number,
        title,
        (STEADY_PLATE, runs),
        TIME,
        (NEWTON,),
        thesis,
        Panels(2.6, fill=fill, legend={"loc": "upper right"}),
        width=style.COLUMN_WIDTH,
        rows=partial(ramp_and_hold, runs=runs, until=until),
        note=noted(
            "Lines: simulated, not measured. {error}. Contact length {length:g} mm; the recordings "
            "are not public."
        ),
    )


# --- 3-10, 3-11: sections under indenters ---------------------------------------------------------


def draw_indenter(ax: Axes, rows: DataFrame) -> None:
    """The indenter from its lower side up to where the picture ends."""
    side = rows[rows["layer"] == "indenter"]
    axs.solid(ax, side[X], side[Y], 7.4, color=style.GREY, lw=0.7)


LINED = ("skin", "corneum", "dermis", "fat", "bone")
"""Boundaries that are drawn, from the outside in."""


@stacked
def sections(
    data: Data, panels: Mapping[str, tuple[str, float]], layers: tuple[str, ...], before: bool
) -> Iterator[Mapping]:
    """Layer boundaries at some indentations (panel -> scene, depth in m), with the indenter's
    lower side; `before`: and without load, in every panel.
    """
    for panel, (scene, depth) in panels.items():
        history = data.histories[scene]
        errors = section_errors(history, data.coarse.get(scene)).columns
        states = {"undeformed": (0.0, layers)} if before or not depth else {}
        if depth:
            deformed = [layer for layer in layers if not (before and layer == "bone")]
            states["deformed"] = depth, (*deformed, "indenter")
        for state, (pressed, shown) in states.items():
            lines = section(history, pressed)
            for layer in shown:
                x, y = 1e3 * lines[layer].T
                yield {"panel": panel, "phase": state, "layer": layer, X: x, Y: y} | errors


def shaded_section(ax, rows, spec):
    """Layers in their colours."""
    paint(ax, layer_loops(rows, LINED), 0.7)
    draw_indenter(ax, rows)


def name_layers(panels, frame):
    """Names of the layers, and a scale."""
    first, loops = panels["undeformed"], layer_loops(frame[frame["panel"] == "undeformed"], LINED)
    point_at_layer(first, loops, "stratum corneum", -5.0, -5.5, 7.0)
    point_at_layer(first, loops, "epidermis", 2.6, 2.86, 7.0)
    point_at_layer(first, loops, "dermis", 5.0, 5.5, 7.0)
    name_fat_and_bone(first, loops)
    for ax in panels.values():
        ax.plot([7.4, 9.4], [-6.2, -6.2], color=style.INK, lw=1.6, solid_capstyle="butt")
        ax.text(8.4, -6.0, "2 mm", ha="center", va="bottom", fontsize=6.5)


LINES = {name: style.look_of("boundary", name) for name in ("corneum", "dermis", "fat")}


def boundaries_of_layers(ax, rows, spec):
    """Boundaries undeformed (dashed) and deformed."""
    bone, alone = rows[rows["layer"] == "bone"], (rows["panel"] == "no load").all()
    ax.fill(bone[X], bone[Y], facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
    draw_indenter(ax, rows)
    lines = rows[rows["layer"].isin(LINES)].groupby(["phase", "layer"], sort=False)
    for (state, layer), line in lines:
        x = line[X].where(line[Y] > -1.2)  # the ends of a line at the picture's rim are crumbs
        ax.plot(x, line[Y], **LINES[layer] | STATE_LINES["deformed" if alone else state])


def name_boundaries(panels, frame):
    """Legend of the boundaries."""
    names = ("stratum corneum to epidermis", "epidermis to dermis", "dermis to fat", "undeformed")
    looks = dict(zip(names, (*LINES.values(), STATE_LINES["undeformed"]), strict=True))
    style.header_legend(panels["no load"].figure, style.handles(looks), columnspacing=1.4)


FIGURES = (
    Figure(
        "3-4",
        "Boundaries of the finite element model",
        FLAT,
        X,
        (Y,),
        {},
        Page(2.9, three_sections),
        at_rest=True,
        rows=section_lines,
        note=lambda frame: [NOTE],
    ),
    Figure(
        "3-5",
        "Finite element mesh of the fingerpad",
        FLAT,
        X,
        (Y,),
        {X: "T039a", Y: "T040a"},
        Panels(
            5.0,
            fill=shaded_mesh,
            limit="",
            set={
                "aspect": "equal",
                "xlim": (-10, 10),
                "ylim": (-6.6, 6.6),
                "xticks": range(-10, 11, 2),
                "yticks": range(-6, 7, 2),
            },
        ),
        note=lambda frame: [NOTE],
        at_rest=True,
        rows=lambda data: mesh_rows(
            data.meshes[FLAT["flat"]], stratum_corneum(data.histories[FLAT["flat"]])
        ),
    ),
    Figure(
        "3-6",
        "Surface deflection in the steady state",
        Runs("panel", PROFILES),
        X.reading(None, "distance from the axis (mm)"),
        (DEFLECTION,),
        {X: "T059", DEFLECTION: "T058a"},
        Panels(
            2.9,
            by="panel",
            names=PROFILES,
            across=3,
            fill=at_depths,
            limit="y",
            alike=True,
            set={"xticks": [-10, -5, 0, 5, 10]},
            share={"sharey": True},
            extra=one_bracket,
        ),
        rows=deflections,
        measured="surface_profiles",
        note=noted(
            "Lines: simulated, not measured. {error}. Points: measured (MIT Touch Lab; digitised "
            "by a third party)."
        ),
    ),
    Figure(
        "3-7",
        "Steady force under a flat plate",
        STEADY_PLATE,
        DEPTH,
        (NEWTON,),
        {DEPTH: "T063", NEWTON: "T062a"},
        Panels(3.2, fill=model_and_subjects, legend={"loc": "upper left"}),
        rows=forces_over_depth,
        measured="force_depth",
        note=noted(
            "Lines: simulated, not measured. {error}. Points: measured (Dandekar et al. 2003, "
            "digitised by others)."
        ),
    ),
    held(
        "3-8",
        "Force in ramp and hold, 2 mm/s to four depths",
        DEPTH_SCENES,
        "mm",
        10.0,
        {TIME: "T067", NEWTON: "T066a"},
        True,
    ),
    held(
        "3-9",
        "Force in ramp and hold to 1 mm, three speeds",
        SPEED_SCENES,
        "mm/s",
        1.5,
        {TIME: "T071", NEWTON: "T070a"},
        False,
    ),
    Figure(
        "3-10",
        "Section under a 1/16 inch rectangular bar, steady state",
        Runs("panel", {"bar": BAR}),
        X,
        (Y,),
        {},
        Panels(
            3.5,
            by="panel",
            names=BAR_SECTIONS,
            extra=name_layers,
            across=2,
            fill=shaded_section,
            share={"sharey": True},
            set={
                "aspect": "equal",
                "xlim": (-10, 10),
                "ylim": (-6.8, 7.4),
                "xticks": range(-10, 11, 5),
                "yticks": (-6, -3, 0, 3, 6),
            },
        ),
        rows=partial(sections, panels=BAR_SECTIONS, layers=LINED, before=False),
        note=noted(
            "Simulated, not measured. {error} (of the layers). The thesis's MRI sections are not "
            "public."
        ),
    ),
    Figure(
        "3-11",
        "Layer boundaries under five indentations, steady state",
        Runs("panel", {panel: scene for panel, (scene, _) in SECTIONS.items()}),
        X,
        (Y,),
        {},
        Panels(
            3.3,
            by="panel",
            names=SECTIONS,
            across=3,
            fill=boundaries_of_layers,
            extra=name_boundaries,
            share={"sharex": True, "sharey": True},
            set={
                "aspect": "equal",
                "xlim": (-9.8, 9.8),
                "ylim": (-1.5, 6.5),
                "xticks": (-9, -6, -3, 0, 3, 6, 9),
                "yticks": (0, 3, 6),
            },
        ),
        rows=partial(sections, panels=SECTIONS, layers=LINED[1:], before=True),
        note=noted(
            "Simulated, not measured. {error} (of the layers). As in the thesis, without the "
            "stratum corneum."
        ),
    ),
)
