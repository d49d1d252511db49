"""Chapter 3: the model's section and its mesh, its surface profiles, forces and layer boundaries,
beside what was measured.

The thesis compares with recordings of single subjects and with MRI sections. Those are not
available and nothing is drawn in their place: Figs 3-6 and 3-7 carry published measurements of
other or partly the same subjects, the others the model alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures import axes as axs
from cysyk1999.figures.geometry import (
    LAYERS,
    NOTE,
    boundaries,
    densify,
    draw_indenter,
    draw_mesh,
    inward,
    layer_patches,
    mesh_rows,
    quality_of,
    section,
    section_errors,
    section_rows,
    stratum_corneum,
    surface_deflection,
)
from cysyk1999.figures.grammar import Data, Figure, Own, Panels, below
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
from fingerpad.measures.features import SIMULATED, is_simulated

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

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
# mm, half of the surface shown: beyond it the flanks are too steep for a deflection at a distance
SHOWN = 7.5
STATE_LINES = {"undeformed": {"ls": "-", "lw": 0.6, "color": style.GREY}, "deformed": {"lw": 1.2}}
MODEL = "Lines: simulated, not measured."


def note_of(words: Callable[[str], list[str]]) -> Callable[[pd.DataFrame], list[str]]:
    """A note in words about the error of a frame."""

    def note(frame: pd.DataFrame) -> list[str]:
        return words(axs.error_text(frame) or "Errors not computed")

    return note


# --- 3-4, 3-5: the section and its mesh ------------------------------------------------------------------


def section_lines(data: Data) -> pd.DataFrame:
    """Closed boundaries of the section, outside to inside, named by the layer they enclose."""
    lines = boundaries(data.meshes[FLAT["flat"]])
    lines["stratum corneum"] = lines["skin"]
    lines["epidermis"] = inward(lines["skin"], stratum_corneum(data.histories[FLAT["flat"]]))
    parts = [
        pd.DataFrame({"layer": k, X: lines[k][:, 0] * 1e3, Y: lines[k][:, 1] * 1e3}) for k in LAYERS
    ]
    return pd.concat(parts, ignore_index=True).assign(**dict.fromkeys(PARTS, np.nan))


def three_sections(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Boundaries of the section: layers, symmetry, stratum corneum."""
    axes = fig.subplots(1, 3, sharey=True)
    titles = ("layers and bone", "layers offset from the skin", "with stratum corneum")
    lines = {layer: rows[[X, Y]].to_numpy() for layer, rows in frame.groupby("layer")}
    skin, apex = (
        lines["stratum corneum"],
        {layer: line[:, 1].max() for layer, line in lines.items()},
    )
    for ax, title in zip(axes, titles, strict=True):
        ax.set(
            title=title,
            aspect="equal",
            xlim=(-10, 10),
            ylim=(-8.2, 9.6),
            xlabel=X.label,
            yticks=[-6, -3, 0, 3, 6],
        )
        ax.tick_params(labelleft=True)
    axes[0].set_ylabel(Y.label)
    small = {"ha": "center", "fontsize": 6.5}

    fill(axes[0], {k: v for k, v in lines.items() if k != "epidermis"}, merged=True)
    bands = {"epidermis": ("stratum corneum", "dermis", -7.0), "dermis": ("dermis", "fat", -1.0)}
    for name, (outer, inner, x) in bands.items():
        point_out(
            axes[0], name, (x, (upper(lines[outer], x) + upper(lines[inner], x)) / 2), (x, 8.3)
        )
    axes[0].text(0, (apex["fat"] + apex["bone"]) / 2, "fat", va="center", **small)
    axes[0].text(0, (lines["bone"][:, 1].min() + apex["bone"]) / 2, "bone", va="center", **small)
    axes[0].text(
        0, -7.3, f"{np.ptp(skin[:, 0]):.1f} × {np.ptp(skin[:, 1]):.1f} mm", va="center", **small
    )

    thick = apex["stratum corneum"] - apex["dermis"], apex["dermis"] - apex["fat"]
    offset_construction(axes[1], lines, thick)
    text = (
        f"epidermis {thick[0]:.2f} mm, dermis {thick[1]:.2f} mm\ndots: so far along the "
        "normals of the skin"
    )
    axes[1].text(0, 9.3, text, va="top", **small)

    fill(axes[2], lines, merged=False)
    point_out(
        axes[2],
        f"stratum corneum, {apex['stratum corneum'] - apex['epidermis']:.2f} mm",
        (0, 5.85),
        (0, 8.3),
    )


def offset_construction(ax: Axes, lines: dict[str, np.ndarray], thick: tuple[float, float]) -> None:
    """The boundaries, and points on the normals of the skin at the layers' thicknesses (mm), which
    lie on them.
    """
    for layer in ("stratum corneum", "dermis", "fat", "bone"):
        ax.plot(*lines[layer].T, color=style.INK, lw=0.8)
    skin = densify(lines["stratum corneum"], 0.2)
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
    ax.annotate(text, at, label, ha="center", va="center", fontsize=6.5, arrowprops=line)


def fill(ax: Axes, lines: dict[str, np.ndarray], merged: bool) -> None:
    """Paint the layers outside to inside; `merged` gives the outermost band the epidermis's
    colour.
    """
    for layer in LAYERS:
        if layer in lines:
            colour = style.LAYER_COLOURS[
                "epidermis" if merged and layer == "stratum corneum" else layer
            ]
            ax.fill(*lines[layer].T, facecolor=colour, edgecolor=style.INK, lw=0.6)


def shaded_mesh(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """The mesh, layers shaded."""
    draw_mesh(ax, frame)
    held = style.handle("held, as is the bone", color=style.INK, lw=2.4)
    ax.legend(
        handles=[*layer_patches(), held],
        loc="upper left",
        handlelength=1.2,
        bbox_to_anchor=(0.0, 1.02),
    )
    value = quality_of(frame)
    text = (
        f"{value['nodes (1)']:,.0f} nodes\n{value['elements (1)']:,.0f} elements\n"
        f"nodes under the contact {value['node_spacing_under_contact (um)']:.0f} µm apart\n"
        f"smallest edge, behind the bone {value['smallest_edge (um)']:.0f} µm\n"
        f"worst scaled Jacobian {value['worst_scaled_jacobian (1)']:.2f}"
    )
    ax.text(9.9, 6.75, text, ha="right", va="top", fontsize=6.5, linespacing=1.4)


# --- 3-6, 3-7: beside what was measured ------------------------------------------------------------------


def measured_source(rows: pd.DataFrame) -> str:
    """One word for all: where measured rows come from."""
    return (
        "measured (" + "; ".join(rows["source"].drop_duplicates()) + "; digitised by a third party)"
    )


def shown_deflection(history: xr.Dataset, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Lateral distance and deflection (m) of the surface that is shown, pressed to a depth (m)."""
    x, deflection = surface_deflection(history, leg_end(history, depth))
    near = abs(x) <= SHOWN * 1e-3
    return x[near], deflection[near]


def deflections(data: Data) -> pd.DataFrame:
    """Deflection of the skin in the steady state at several depths of three indenters, and measured
    ones.
    """
    parts, points = [], []
    for panel, history, coarse in data.runs(Runs("panel", PROFILES)):
        depths = pressed_depths(history)
        for depth in depths:
            x, deflection = (
                1e3 * each for each in surface_deflection(history, leg_end(history, depth))
            )
            near = abs(x) <= SHOWN
            errors = curve_errors(
                history, coarse, Curve(partial(shown_deflection, depth=depth), outputs=False)
            )
            part = {
                "panel": panel,
                "series": f"{depth * 1e3:g} mm",
                X: x[near],
                DEFLECTION: deflection[near],
            }
            parts.append(pd.DataFrame(part | errors.columns))
        if data.measured is None or "cylinder" not in panel:
            continue
        rows = data.measured[np.isclose(data.measured["diameter_mm"], float(panel.split()[1]))]
        rows = rows[[bool(np.isclose(d, np.array(depths) * 1e3).any()) for d in rows["depth_mm"]]]
        part = {
            "source": measured_source(rows),
            "panel": panel,
            "series": [f"{d:g} mm" for d in rows["depth_mm"]],
        }
        points.append(
            pd.DataFrame(
                part | {X: rows["lateral_distance_mm"], DEFLECTION: -rows["deflection_mm"]}
            )
        )
    return below(pd.concat(parts, ignore_index=True), *points)


def at_depths(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    """Simulated (lines) and measured (points), a colour a depth."""
    simulated = rows[is_simulated(rows)]
    looks = style.ordered("depth", simulated["series"])
    for name, curve in simulated.groupby("series", sort=False):
        look = looks[name]
        axs.curve(ax, curve, X, DEFLECTION, color=look["color"], ls=look["ls"], lw=1.2)
        points = rows[~is_simulated(rows) & (rows["series"] == name)]
        ax.plot(points[X], points[DEFLECTION], look["marker"], color=look["color"], ms=3)
    axs.limit_axis(ax, rows, X, "x")
    bare = {} if "cylinder" in rows["panel"].iloc[0] else {"marker": ""}
    handles = [style.handle(name, **look | bare, ms=3) for name, look in looks.items()]
    ax.legend(handles=handles, title="depth", loc="lower left", handlelength=2.4, borderaxespad=0.1)
    if "cylinder" not in rows["panel"].iloc[0]:
        words = "steep walls:\nthe blade is\n0.1 mm wide"
    else:
        words = misfit_at_the_rim(rows)
    ax.text(0.99, 0.03, words, transform=ax.transAxes, ha="right", fontsize=6)
    ax.set_title(rows["panel"].iloc[0])


def misfit_at_the_rim(rows: pd.DataFrame) -> str:
    """In words, how far the deepest measured profile and the model are apart at its outermost
    point.
    """
    points = rows[~is_simulated(rows) & rows[DEFLECTION].notna() & rows["series"].notna()]
    points = points[
        points["series"] == rows.loc[is_simulated(rows), "series"].iloc[-1]
    ].sort_values(X)
    if points.empty:
        return ""
    last = points.iloc[-1]
    curve = rows[is_simulated(rows) & (rows["series"] == last["series"])].sort_values(X)
    here = float(np.interp(last[X], curve[X], curve[DEFLECTION]))
    return (
        f"at {last[X]:g} mm,\n{last['series']} deep:\n{last[DEFLECTION]:+.2f} "
        f"measured\n{here:+.2f} model"
    ).replace("-", "−")


def one_bracket(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """Beside the last panel, for all."""
    for ax in list(panels.values())[:-1]:
        for artist in [
            t for t in ax.texts if t.get_text() == "" or t.get_text().startswith("thesis axis")
        ]:
            artist.remove()


def deflection_words(error: str) -> list[str]:
    return [f"{MODEL} {error}. Points: measured (MIT Touch Lab; digitised by a third party)."]


LONG = "contact length "


def length_in(frame: pd.DataFrame) -> float:
    """The contact length (mm) that a frame's sources tell; not a number if none does."""
    told = frame["source"].str.extract(rf"{LONG}([\d.]+) mm")[0].dropna()
    return float(told.iloc[0]) if len(told) else np.nan


def forces_over_depth(data: Data) -> pd.DataFrame:
    """Steady force against the depth of a flat plate, and the measured forces of each subject."""
    ((_, plate, coarse),) = data.runs(STEADY_PLATE)
    long = 1e3 * contact_length(plate)
    model = pd.DataFrame({"series": "model", DEPTH: DEPTH.read(plate), NEWTON: NEWTON.read(plate)})
    errors = curve_errors(
        plate,
        coarse,
        Curve(lambda history: (DEPTH.read(history), NEWTON.read(history)), outputs=False),
    )
    model = model.assign(**errors.columns)
    points, fitted = [], []
    if data.measured is not None:
        rows = data.measured[
            (data.measured["indenter"] == "flat plate") & (data.measured["speed_mm_per_s"] == 0)
        ]
        for subject, part in rows.groupby("subject", sort=False):
            values = {
                "series": f"subject {subject}",
                DEPTH: part["depth_mm"],
                NEWTON: part["force_N"],
            }
            points.append(pd.DataFrame({"source": measured_source(part), **values}))
        here = np.interp(rows["depth_mm"], model[DEPTH], model[NEWTON])
        factor = float(here @ rows["force_N"] / (here @ here))
        source = f"{SIMULATED}: times {factor:.3g}, closest to the measured forces"
        fitted = [
            model.assign(source=source, series="model, fitted", **{NEWTON: factor * model[NEWTON]})
        ]
    model.insert(0, "source", f"{SIMULATED}: {LONG}{long:g} mm")
    return below(pd.concat([model, *fitted], ignore_index=True), *points)


def model_and_subjects(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    model, fitted = (frame[frame["series"] == name] for name in ("model", "model, fitted"))
    long = length_in(frame)
    ax.plot(model[DEPTH], model[NEWTON], color=style.INK, label=f"model, {LONG}{long:g} mm")
    others = frame[~is_simulated(frame) & frame["series"].notna()]
    if len(fitted):
        factor = float((fitted[NEWTON] / model[NEWTON].to_numpy()).max())
        length = f"model times {factor:.2f}: a length of {long * factor:.1f} mm, or softer"
        ax.plot(fitted[DEPTH], fitted[NEWTON], color=style.HIGHLIGHT, ls=style.DASHED, label=length)
        ends = [others[DEPTH].min(), others[DEPTH].max()]
        mean = [others.loc[np.isclose(others[DEPTH], at), NEWTON].mean() for at in ends]
        over = np.interp(ends, model[DEPTH], model[NEWTON]) / mean
        words = (
            f"model over the mean of the subjects: {over[0]:.1f} at {ends[0]:g} mm, {over[1]:.1f} "
            f"at {ends[1]:g} mm.\n"
            "A plane section touches as long a stretch of the finger\nat every depth; a finger "
            "touches more of it the deeper."
        )
        ax.text(0.03, 0.55, words, transform=ax.transAxes, va="top", fontsize=6.5)
    looks = style.ordered("subject", others["series"])
    for name, rows in others.groupby("series", sort=False):
        look = {"color": looks[name]["color"], "marker": looks[name]["marker"], "ls": "none"}
        ax.plot(rows[DEPTH], rows[NEWTON], **look, ms=4.5, label=name)


def force_words(error: str) -> list[str]:
    return [f"{MODEL} {error}. Points: measured (Dandekar et al. 2003, digitised by others)."]


# --- 3-8, 3-9: ramp and hold -----------------------------------------------------------------------------


def ramp_and_hold(data: Data, runs: Runs, until: float) -> pd.DataFrame:
    """Force over time of each scene up to a time, and its steady level, as two rows to the same
    time.
    """
    ((_, plate, companion),) = data.runs(STEADY_PLATE)
    parts = []
    for series, history, coarse in data.runs(runs):
        time = np.append(history["time"].values[history["time"].values < until * (1 - 1e-9)], until)
        errors = curve_errors(history, coarse, over_time(force_N))
        values = np.interp(time, history["time"].values, force_N(history))
        source = f"{SIMULATED}: {LONG}{1e3 * contact_length(history):g} mm"
        part = {
            "source": source,
            "series": series,
            "phase": "ramp and hold",
            TIME: time,
            NEWTON: values,
        } | errors.columns
        parts.append(pd.DataFrame(part))
        level = partial(steady_force, depth=max(pressed_depths(history)))
        part = {
            "source": source,
            "series": series,
            "phase": "steady state",
            TIME: [0.0, until],
            NEWTON: level(plate),
        }
        parts.append(pd.DataFrame(part | number_errors(plate, companion, level).columns))
    return pd.concat(parts, ignore_index=True)


def forces_over_time(ax: Axes, frame: pd.DataFrame, spec: Figure, at_curves: bool) -> None:
    """Curves and steady levels, each with its name and peak over steady force: at the curve's end
    or in a legend.
    """
    simulated, dashes = (
        frame[is_simulated(frame)],
        {"lw": 0.7, "ls": (0, (2, 2)), "color": style.GREY},
    )
    looks = style.ordered("depth", simulated["series"])
    for name, rows in simulated.groupby("series", sort=False):
        look = {part: looks[name][part] for part in ("color", "ls")}
        curve, steady = (
            rows[rows["phase"] == phase] for phase in ("ramp and hold", "steady state")
        )
        ax.plot(steady[TIME], steady[NEWTON], **dashes)
        label = f"{name}: peak / steady {curve[NEWTON].max() / steady[NEWTON].iloc[0]:.2f}"
        axs.curve(ax, curve, TIME, NEWTON, **look, label="_" * at_curves + label)
        if at_curves:
            end, away = (
                curve.iloc[-1],
                {"xytext": (-2, 5), "textcoords": "offset points", "ha": "right"},
            )
            ax.annotate(label, (end[TIME], end[NEWTON]), fontsize=6.5, **away)
    ax.plot([], [], label="steady state, solved as such", **dashes)


def model_alone(frame: pd.DataFrame) -> list[str]:
    words = f"{LONG.capitalize()}{length_in(frame):g} mm; the recordings are not public."
    return note_of(lambda error: [f"{MODEL} {error}. {words}"])(frame)


def held(
    number: str,
    title: str,
    scenes: Mapping[str, str],
    unit: str,
    until: float,
    thesis: tuple[str, str],
    at_curves: bool,
):
    """Figs 3-8 and 3-9."""
    runs = Runs("series", {f"{label} {unit}": scene for label, scene in scenes.items()})
    return Figure(
        number,
        title,
        (STEADY_PLATE, runs),
        TIME,
        (NEWTON,),
        dict(zip((TIME, NEWTON), thesis, strict=True)),
        Panels(
            height=3.0,
            fill=partial(forces_over_time, at_curves=at_curves),
            legend={"loc": "upper right"},
        ),
        rows=partial(ramp_and_hold, runs=runs, until=until),
        note=model_alone,
    )


# --- 3-10, 3-11: sections under indenters ----------------------------------------------------------------


def under_the_bar(data: Data) -> pd.DataFrame:
    """The section, undeformed and under the 1/16 inch bar at 2 mm: closed layer boundaries, the
    bar's lower side.
    """
    history, layers = data.histories[BAR], ("skin", "corneum", "dermis", "fat", "bone")
    errors = section_errors(history, data.coarse.get(BAR))
    pressed = section_rows(
        "1/16 inch bar, 2 mm",
        "deformed",
        section(history, 2e-3, corneum=True),
        (*layers, "indenter"),
        errors,
    )
    before = section_rows(
        "undeformed", "undeformed", section(history, 0.0, corneum=True), layers, errors
    )
    return pd.concat([before, pressed], ignore_index=True)


def shaded_section(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    named = {"skin": "stratum corneum", "corneum": "epidermis"}
    for layer in ("skin", "corneum", "dermis", "fat", "bone"):
        loop = rows[rows["layer"] == layer]
        colour = style.LAYER_COLOURS[named.get(layer, layer)]
        ax.fill(loop[X], loop[Y], facecolor=colour, edgecolor=style.INK, lw=0.7)
    draw_indenter(ax, rows)


def name_layers(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    first, names = panels["undeformed"], ("stratum corneum", "epidermis", "dermis", "fat", "bone")
    rows = frame[frame["panel"] == "undeformed"]
    loops = [
        rows.loc[rows["layer"] == layer, [X, Y]].to_numpy()
        for layer in ("skin", "corneum", "dermis", "fat", "bone")
    ]
    for name, outer, inner, x in zip(names, loops, loops[1:], (-5.0, 2.6, 5.0, 0.0), strict=False):
        at = (x, (upper(outer, x) + upper(inner, x)) / 2)
        if name == "fat":
            first.text(*at, name, ha="center", va="center", fontsize=6.5)
        else:
            point_out(first, name, at, (1.1 * x, 7.0))
    first.text(
        0,
        (loops[-1][:, 1].min() + loops[-1][:, 1].max()) / 2,
        "bone",
        ha="center",
        va="center",
        fontsize=6.5,
    )
    for ax in panels.values():
        ax.plot([7.4, 9.4], [-6.2, -6.2], color=style.INK, lw=1.6, solid_capstyle="butt")
        ax.text(8.4, -6.0, "2 mm", ha="center", va="bottom", fontsize=6.5)


def six_indentations(data: Data) -> pd.DataFrame:
    """Layer boundaries without load and under five indentations; the stratum corneum is left
    out.
    """
    parts, layers = [], ("corneum", "dermis", "fat")
    for panel, (scene, depth) in SECTIONS.items():
        history = data.histories[scene]
        errors = section_errors(history, data.coarse.get(scene))
        before = section(history, 0.0, corneum=True)
        parts.append(section_rows(panel, "undeformed", before, (*layers, "bone"), errors))
        if depth:
            after = section(history, depth, corneum=True)
            parts.append(section_rows(panel, "deformed", after, (*layers, "indenter"), errors))
    return pd.concat(parts, ignore_index=True)


LINES = {name: style.look_of("boundary", name) for name in ("corneum", "dermis", "fat")}


def boundaries_of_layers(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    """Boundaries undeformed (dashed) and deformed."""
    bone, alone = rows[rows["layer"] == "bone"], (rows["panel"] == "no load").all()
    ax.fill(bone[X], bone[Y], facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
    draw_indenter(ax, rows)
    for (state, layer), line in rows[rows["layer"].isin(LINES)].groupby(
        ["phase", "layer"], sort=False
    ):
        above = line[Y] > -1.2  # the ends of a line at the picture's rim are crumbs
        ax.plot(
            line[X].where(above),
            line[Y],
            **LINES[layer] | STATE_LINES["deformed" if alone else state],
        )


def name_boundaries(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    names = ("stratum corneum to epidermis", "epidermis to dermis", "dermis to fat")
    handles = [style.handle(name, **look) for name, look in zip(names, LINES.values(), strict=True)]
    fig = panels["no load"].figure
    style.header_legend(
        fig, [*handles, style.handle("undeformed", **STATE_LINES["undeformed"])], columnspacing=1.4
    )
    panels["no load"].set_ylabel(Y.label)


def section_words(extra: str) -> Callable[[str], list[str]]:
    return lambda error: [f"Simulated, not measured. {error} (of the layers). {extra}"]


FIGURES = (
    Figure(
        "3-4",
        "Boundaries of the finite element model",
        FLAT,
        X,
        (Y,),
        {},
        Own(height=2.9, paint=three_sections),
        rows=section_lines,
        meshes=True,
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
            height=5.0,
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
        meshes=True,
        note=lambda frame: [NOTE],
        rows=lambda data: mesh_rows(
            data.meshes[FLAT["flat"]], stratum_corneum(data.histories[FLAT["flat"]])
        ),
    ),
    Figure(
        "3-6",
        "Surface deflection in the steady state",
        Runs("panel", PROFILES),
        X,
        (DEFLECTION,),
        {X: "T059", DEFLECTION: "T058a"},
        Panels(
            height=2.9,
            by="panel",
            names=tuple(PROFILES),
            shape=(1, 3),
            fill=at_depths,
            limit="y",
            alike=True,
            xlabel="distance from the axis (mm)",
            each=True,
            set={"xticks": [-10, -5, 0, 5, 10]},
            share={"sharey": True},
        ),
        rows=deflections,
        extra=one_bracket,
        measured="surface_profiles",
        note=note_of(deflection_words),
    ),
    Figure(
        "3-7",
        "Steady force under a flat plate",
        STEADY_PLATE,
        DEPTH,
        (NEWTON,),
        {DEPTH: "T063", NEWTON: "T062a"},
        Panels(height=3.2, fill=model_and_subjects, legend={"loc": "upper left"}),
        rows=forces_over_depth,
        measured="force_depth",
        note=note_of(force_words),
    ),
    held(
        "3-8",
        "Force in ramp and hold, 2 mm/s to four depths",
        DEPTH_SCENES,
        "mm",
        10.0,
        ("T067", "T066a"),
        True,
    ),
    held(
        "3-9",
        "Force in ramp and hold to 1 mm, three speeds",
        SPEED_SCENES,
        "mm/s",
        1.5,
        ("T071", "T070a"),
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
            height=3.5,
            by="panel",
            names=("undeformed", "1/16 inch bar, 2 mm"),
            shape=(1, 2),
            fill=shaded_section,
            limit="",
            titles=str,
            each=True,
            share={"sharey": True},
            set={
                "aspect": "equal",
                "xlim": (-10, 10),
                "ylim": (-6.8, 7.4),
                "xticks": range(-10, 11, 5),
                "yticks": (-6, -3, 0, 3, 6),
            },
        ),
        rows=under_the_bar,
        extra=name_layers,
        note=note_of(section_words("The thesis's MRI sections are not public.")),
    ),
    Figure(
        "3-11",
        "Layer boundaries under five indentations, steady state",
        Runs("panel", {panel: scene for panel, (scene, _) in SECTIONS.items()}),
        X,
        (Y,),
        {},
        Panels(
            height=3.3,
            header=0.16,
            by="panel",
            names=tuple(SECTIONS),
            shape=(2, 3),
            fill=boundaries_of_layers,
            limit="",
            titles=str,
            share={"sharex": True, "sharey": True},
            set={
                "aspect": "equal",
                "xlim": (-9.8, 9.8),
                "ylim": (-1.5, 6.5),
                "xticks": (-9, -6, -3, 0, 3, 6, 9),
                "yticks": (0, 3, 6),
            },
        ),
        rows=six_indentations,
        extra=name_boundaries,
        note=note_of(section_words("As in the thesis, without the stratum corneum.")),
    ),
)
