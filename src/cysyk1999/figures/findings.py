"""What each picture shows, in a sentence with its numbers: a function of the figure's frame, which
is published beside it. Words that could be wrong on another pad (rises, falls) are chosen by the
numbers.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pandas import DataFrame, Series

from cysyk1999.measures.quantities import (
    CURVATURE,
    DEPTH,
    DISTANCE,
    IMPULSE_RATE,
    LATERAL,
    P_CENTRE,
    P_PEAK,
    P_SCALED,
    RATE,
    RECEPTOR,
    SCALED_CURVATURE,
    SED,
    SKIN_CURVATURE,
    TIME,
    WIDTH,
    P,
    X,
    Y,
)
from fingerpad.measures.features import SIMULATED, STEADY, TOP, is_simulated

# --- numbers --------------------------------------------------------------------------------------


def own(frame: DataFrame, **where: object) -> DataFrame:
    """Simulated rows, but for the stroked surface's shape, whose columns have some values."""
    shape = frame["source"].str.endswith("shape of the stimulus")
    rows = frame[is_simulated(frame) & ~shape]
    for column, value in where.items():
        rows = rows[rows[column] == value]
    return rows


def n(value: float, digits: int = 2) -> str:
    """A number in words: significant digits, no power of ten, a minus."""
    if value != value:
        return "an unknown number of"
    shown = float(f"{value:.{digits}g}")
    return f"{shown:{',' if abs(shown) >= 1e4 else ''}.10g}".replace("-", "−")


def span(values: Series, unit: str = "") -> str:
    """``2.1 to 2.9 mm``: the least and the greatest of some numbers."""
    low, high = n(values.min()), n(values.max())
    return (low if low == high else f"{low} to {high}") + f" {unit}" * bool(unit)


def ends(values: Series, unit: str, scale: float = 1.0, digits: int = 2) -> str:
    """``from 5.4 (plate) to 0.88 mm (1260 1/m)``: the first and the last of some numbers of
    surfaces, in the order of their curvature.
    """
    at = {name: float(str(name).replace("flat", "0")) for name in values.index}
    first, last = min(at, key=at.get), max(at, key=at.get)
    low, high = (n(scale * values[name], digits) for name in (first, last))
    plate, sharp = (f"({n(at[k], 4)} 1/m)" if at[k] else "(plate)" for k in (first, last))
    return f"from {low} {plate} to {high} {unit} {sharp}"


def of_surfaces(rows: DataFrame, y: str, how: str = "max") -> Series:
    """A number (a method of pandas's groups) of each surface."""
    return rows.groupby("surface", sort=False)[y].agg(how)


def change(rows: DataFrame, y: str, by: str = "surface") -> tuple[str, Series]:
    """``falls by 3.1 to 6.2 %``, or rises, or changes where they differ: from the highest in the
    first half second, the ramp, to the last; and the changes.
    """
    groups = rows.dropna(subset=[y]).groupby(by, sort=False)
    top = groups.apply(lambda g: g.loc[g[TIME] <= 0.5 + 1e-6, y].max(), include_groups=False)
    share = 100 * (groups[y].last() / top - 1)
    if (share > 0).all() or (share < 0).all():
        verb = "rises" if share.min() > 0 else "falls"
        return f"{verb} by {span(share.abs())} %", share
    return f"changes by {span(share)} %", share


def alike(one: Series, other: Series) -> float:
    """The correlation of two columns."""
    return one.astype(float).corr(other.astype(float))


def r_squared(rows: DataFrame, x: str, y: str) -> str:
    """``R² 0.96`` of a straight line through points."""
    return f"R² {alike(rows[x], rows[y]) ** 2:.2f}"


def misfit(found: Series, true: Series) -> float:
    """r.m.s. of what one column is off from another, % of the r.m.s. of that."""
    return 100 * np.linalg.norm(found - true) / np.linalg.norm(true)


def spread_of(rows: DataFrame, y: str, by: str) -> float:
    """How far curves are apart, %: the r.m.s. over the stroke of the range between them, over that
    of their mean.
    """
    at = rows[DISTANCE].round(2)
    table = rows.assign(at=at).pivot_table(index="at", columns=by, values=y).dropna()
    apart = table.max(axis=1) - table.min(axis=1)
    return 100 * np.linalg.norm(apart) / np.linalg.norm(table.mean(axis=1))


def half_width(rows: DataFrame, y: str) -> float:
    """How wide (mm) a profile is at half its height."""
    rows = rows.dropna(subset=[y]).sort_values(X)
    if rows.empty:
        return np.nan
    fine = np.linspace(rows[X].min(), rows[X].max(), 2001)
    height = np.interp(fine, rows[X], rows[y])
    inside = fine[height >= height.max() / 2]
    return float(np.ptp(inside))


def at_centre(rows: DataFrame, y: str) -> float:
    """The value nearest to x = 0."""
    return float(rows.loc[rows[X].abs().idxmin(), y])


# --- sentences ------------------------------------------------------------------------------------

Finding = Callable[[DataFrame], str]
FINDINGS: dict[str, Finding] = {}
"""Number of a figure -> its sentence."""


def finding(*numbers: str) -> Callable[[Finding], Finding]:
    """Enter a sentence for some figures."""

    def enter(say: Finding) -> Finding:
        FINDINGS.update(dict.fromkeys(numbers, say))
        return say

    return enter


@finding("3-4")
def _section(f: DataFrame) -> str:
    def across(layer: str, axis: str) -> float:
        return float(np.ptp(own(f, layer=layer)[axis]))

    skin, bone = "stratum corneum", "bone"
    return (
        f"The section is {n(across(skin, X), 3)} mm wide and {n(across(skin, Y), 3)} mm high, round"
        f" a bone of {n(across(bone, X), 3)} by {n(across(bone, Y), 3)} mm"
    )


@finding("3-5", "5-25")
def _mesh(f: DataFrame) -> str:
    value = f.dropna(subset=["value"]).set_index("quantity")["value"]
    edge = value["smallest_edge (um)"]
    return (
        f"{value['nodes (1)']:,.0f} nodes, dense under the skin: the shortest edge is {n(edge)} µm"
    )


@finding("3-6")
def _rim(f: DataFrame) -> str:
    rows = f[f["panel"].eq([p for p in f["panel"].dropna().unique() if "cylinder" in p][-1])]
    deepest = own(rows)["series"].iloc[-1]
    curve = own(rows, series=deepest).sort_values(X)
    seen = rows[rows["source"].str.startswith("measured") & rows["series"].eq(deepest)]
    if seen.empty:
        return f"Pressed {deepest}, the skin sinks by {n(curve.iloc[:, 4].min())} mm"
    y = next(c for c in f if c.startswith("deflection"))
    x, at = seen.sort_values(X)[[X, y]].iloc[-1]
    here = np.interp(x, curve[X], curve[y])
    signs = "the model has the other sign" if here * at < 0 else "the model has the same sign"
    return (
        f"Far from the indenter {signs}: {n(x)} mm away the skin is {n(at)} mm from rest "
        f"measured, {n(here)} mm in the model"
    )


@finding("3-7")
def _plate_force(f: DataFrame) -> str:
    force = next(c for c in f if c.startswith("force"))
    model = own(f, series="model").sort_values(DEPTH)
    seen = f[f["source"].str.startswith("measured")].groupby(DEPTH)[force].mean()
    if seen.empty:
        return f"A plate {n(model[DEPTH].max())} mm deep takes {n(model[force].max())} N"
    over = np.interp(seen.index, model[DEPTH], model[force]) / seen
    (a, x), (b, y) = ((over.iloc[k], over.index[k]) for k in (0, -1))
    return (
        f"A plate takes {n(a)} times the measured force at {n(x)} mm and {n(b)} times at {n(y)} mm"
    )


@finding("3-8", "3-9")
def _peak_and_steady(f: DataFrame) -> str:
    force, rows = next(c for c in f if c.startswith("force")), own(f)
    ratio = Series(
        {
            name: part.loc[part["phase"] == "ramp and hold", force].max()
            / part.loc[part["phase"] == "steady state", force].iloc[0]
            for name, part in rows.groupby("series", sort=False)
        }
    )
    first, last = ratio.index[0], ratio.index[-1]
    return (
        f"Force peaks at {n(ratio.iloc[0])} times its steady level ({first}) to "
        f"{n(ratio.iloc[-1])} times ({last})"
    )


@finding("3-10")
def _bar(f: DataFrame) -> str:
    def height(phase: str, layer: str) -> float:
        return at_centre(own(f, phase=phase, layer=layer), Y)

    down = {k: height("undeformed", k) - height("deformed", k) for k in ("skin", "fat")}
    return (
        f"Under the bar the skin sinks by {n(down['skin'])} mm, the top of the fat still by "
        f"{n(down['fat'])} mm"
    )


@finding("3-11")
def _boundaries(f: DataFrame) -> str:
    rows, down = own(f, layer="fat"), {}
    for panel, part in rows.groupby("panel", sort=False):
        states = {phase: at_centre(line, Y) for phase, line in part.groupby("phase")}
        if "deformed" in states:
            down[panel] = states["undeformed"] - states["deformed"]
    return f"The boundary to the fat sinks by {span(Series(down), 'mm')} under five indentations"


@finding("4-2", "4-25")
def _hold_rates(f: DataFrame) -> str:
    rows = own(f)
    if "panel" in rows:
        rows = rows[rows["panel"] == "mean rate of the hold"]
    rate = of_surfaces(rows, "impulse_rate (impulses/s)")
    return f"Predicted mean rate of the hold: {ends(rate, 'impulses/s')}"


@finding("4-3")
def _adapting_rates(f: DataFrame) -> str:
    rows = own(f, series="rate").dropna(subset=[IMPULSE_RATE])
    top, last = of_surfaces(rows, IMPULSE_RATE), of_surfaces(rows, IMPULSE_RATE, "last")
    share = (last / top).replace(np.inf, np.nan).dropna()
    return (
        f"The predicted rate peaks {ends(top, 'impulses/s')}; at the end of the hold "
        f"{span(100 * share)} % of it are left"
    )


@finding("4-4")
def _steady_from_peak(f: DataFrame) -> str:
    rows = own(f).dropna(subset=["surface"])  # without the line through them
    slope = np.polyfit(rows["impulse_rate (impulses/s)"], rows["steady_rate (impulses/s)"], 1)[0]
    shared = r_squared(rows, "impulse_rate (impulses/s)", "steady_rate (impulses/s)")
    return f"The predicted steady rate grows by {n(slope)} for each 1 of the peak rate ({shared})"


@finding("4-5")
def _peak_and_steady_rates(f: DataFrame) -> str:
    peak = of_surfaces(own(f), "impulse_rate (impulses/s)")
    steady = of_surfaces(own(f), "steady_rate (impulses/s)")
    return (
        f"Predicted peak rate {ends(peak, 'impulses/s')}; steady rate {span(steady, 'impulses/s')}"
    )


@finding("4-6")
def _indented_skin(f: DataFrame) -> str:
    rows = own(f)
    down = Series(
        {
            name: at_centre(part[part["phase"] == "before contact"], Y)
            - at_centre(part[part["phase"] == STEADY], Y)
            for name, part in rows.groupby("surface", sort=False)
        }
    )
    return f"In steady state the skin has sunk {ends(down, 'mm')}"


@finding("4-7")
def _sunk(f: DataFrame) -> str:
    last = of_surfaces(own(f), DEPTH, "last")
    return f"At the same force the finger is pressed in {ends(last, 'mm')}"


@finding("4-8")
def _widths(f: DataFrame) -> str:
    last = of_surfaces(own(f), WIDTH, "last")
    return f"The contact's width goes {ends(last, 'mm')}; in the hold it {change(own(f), WIDTH)[0]}"


@finding("4-9")
def _inverse_widths(f: DataFrame) -> str:
    one = next(c for c in f if c.startswith("inverse"))
    return (
        "One over the contact's width in the hold goes "
        f"{ends(of_surfaces(own(f), one, 'last'), '1/mm')}"
    )


@finding("4-10")
def _centre_pressures(f: DataFrame) -> str:
    rows = own(f)
    top = ends(of_surfaces(rows, P_CENTRE), "kPa", 1e-3)
    return f"Centre pressure peaks {top} and {change(rows, P_CENTRE)[0]} in the hold"


@finding("4-11")
def _profiles(f: DataFrame) -> str:
    rows = own(f, phase=TOP)
    over = [part[P].max() / at_centre(part, P) for _, part in rows.groupby("surface", sort=False)]
    beside = sum(ratio > 1.01 for ratio in over)
    return (
        f"Pressure peaks {ends(of_surfaces(rows, P), 'kPa', 1e-3)}; at the top of the ramp the "
        f"peak is beside the centre under {beside} of {len(over)} surfaces"
    )


@finding("4-12")
def _two_pads(f: DataFrame) -> str:
    rows = own(f, phase=STEADY)
    over = {pad: part[P].max() / at_centre(part, P) for pad, part in rows.groupby("pad")}
    return (
        f"Under a plate the highest pressure is {n(over['layered'], 3)} times that at the "
        "centre in the "
        f"layered pad, {n(over['homogeneous'], 3)} times in one of a single material"
    )


@finding("4-13")
def _pressure_over_displacement(f: DataFrame) -> str:
    down = next(c for c in f if c.startswith("vertical"))
    rows = own(f, phase=STEADY)
    share = Series(
        {
            name: part.loc[part[down].idxmax(), P] / part[P].max()
            for name, part in rows.groupby("surface", sort=False)
        }
    )
    return f"Where the skin has sunk deepest, pressure is {span(100 * share)} % of its highest"


@finding("4-14")
def _one_cylinder(f: DataFrame) -> str:
    wide, high = (
        {p: how(part) for p, part in own(f).groupby("phase")}
        for how in (lambda g: 2 * g[X].max(), lambda g: g[P].max() / 1e3)
    )
    return (
        f"From the top of the ramp on the contact goes from {n(wide[TOP])} to "
        f"{n(wide[STEADY])} mm and "
        f"the highest pressure from {n(high[TOP])} to {n(high[STEADY])} kPa"
    )


@finding("4-15")
def _centre_is_highest(f: DataFrame) -> str:
    rows = own(f)
    rows = rows[rows[P_CENTRE] > 0.05 * rows[P_CENTRE].max()]
    apart = 100 * (rows[P_PEAK] / rows[P_CENTRE] - 1).max()
    return f"The highest pressure is at most {n(apart)} % above that at the centre"


@finding("4-16")
def _times_of_peaks(f: DataFrame) -> str:
    rows = own(f)
    rows = rows[rows[P] > 0]
    top = rows.loc[rows.groupby("node_x (mm)")[P].idxmax()]
    return f"Points of the skin have their highest pressure {span(top[TIME])} s after the start"


@finding("4-17")
def _decay(f: DataFrame) -> str:
    law, rows = "pressure_by_law (Pa)", own(f)
    true = rows[rows["series"] == SIMULATED].set_index([TIME, "node_x (mm)"])[P]
    off = {}
    for series, part in rows.dropna(subset=[law]).groupby("series", sort=False):
        fit = part.set_index([TIME, "node_x (mm)"])[law]
        fit = fit[~fit.index.duplicated()]
        same = true[~true.index.duplicated()].reindex(fit.index)
        off[series] = misfit(fit[same.notna()], same.dropna())
    one, each = (off.get(f"Eq 4-1, {words}", np.nan) for words in ("one set", "a set for each"))
    return (
        f"One set of constants is {n(one)} % off the decay of pressure, a set for each node "
        f"{n(each)} %"
    )


@finding("4-18")
def _rate_and_pressure(f: DataFrame) -> str:
    points = own(f).dropna(subset=["surface"])  # without the line through them
    shared = r_squared(points, P_PEAK, "impulse_rate (impulses/s)")
    return f"Predicted peak rates follow the peak pressure with {shared}"


@finding("4-19")
def _mean_rate_and_pressure(f: DataFrame) -> str:
    rows = own(f)
    rows = rows[rows["source"].str.contains("Eq 5-1")].dropna(subset=["surface"])
    shared = r_squared(rows, "mean_centre_pressure (Pa)", "impulse_rate (impulses/s)")
    return f"Predicted mean rates follow the mean pressure with {shared}"


@finding("4-20")
def _broader_below(f: DataFrame) -> str:
    rows, over = own(f, phase=TOP), {}
    for name, part in rows.groupby("surface", sort=False):
        above = half_width(part[part["panel"] == "pressure"], P)
        over[name] = half_width(part[part["panel"] == "915 um"], SED) / above
    return (
        f"Strain energy 915 µm deep is, at half its height, {ends(Series(over), 'times')} as wide "
        "as the pressure above it"
    )


@finding("4-21")
def _energy_and_pressure(f: DataFrame) -> str:
    rows = own(f)
    return (
        f"In the hold strain energy {change(rows, SED)[0]}, the pressure above it "
        f"{change(rows, P_SCALED)[0]}"
    )


@finding("4-22")
def _law_of_energy(f: DataFrame) -> str:
    law, rows = "strain_energy_by_eq_4_4 (Pa)", own(f)
    off = Series(
        {k: misfit(part[law], part[SED]) for k, part in rows.groupby("surface", sort=False)}
    )
    return (
        f"Eq 4-4 is {span(off)} % off; in the hold it {change(rows, law)[0]} where strain energy "
        f"{change(rows, SED)[0]}"
    )


@finding("4-23")
def _energies(f: DataFrame) -> str:
    rows = own(f)
    return (
        f"Strain energy peaks {ends(of_surfaces(rows, SED), 'Pa')} and {change(rows, SED)[0]} in "
        "the hold"
    )


@finding("4-24")
def _energies_of_depths(f: DataFrame) -> str:
    top = own(f).groupby([RECEPTOR, "surface"])[SED].max().unstack()
    over = top.iloc[0] / top.iloc[-1]
    first, last = top.index[0], top.index[-1]
    return f"Strain energy {first:.0f} µm deep peaks at {span(over)} times that {last:.0f} µm deep"


@finding("4-26", "4-27")
def _other_recordings(f: DataFrame) -> str:
    rows = own(f)
    rows = rows[rows["series"].isna() & rows["source"].str.contains("Eq 5-1")]
    return (
        "Predicted mean rates go "
        f"{ends(of_surfaces(rows, 'impulse_rate (impulses/s)'), 'impulses/s')}"
    )


@finding("4-28")
def _energy_rates(f: DataFrame) -> str:
    rows = own(f)
    at = rows.loc[rows.groupby("surface", sort=False)[RATE].idxmax()].set_index("surface")[TIME]
    return (
        f"The rate of strain energy peaks {ends(of_surfaces(rows, RATE), 'Pa/s')}, {span(at)} s "
        "after the start"
    )


@finding("4-29")
def _rates_and_energy_rates(f: DataFrame) -> str:
    rows = own(f)
    rows = rows[rows["source"].str.contains("Eq 5-1") & rows["series"].isna()]
    shared = [
        f"{r_squared(part, RATE, 'impulse_rate (impulses/s)')} at {panel.replace('um', 'µm')}"
        for panel, part in rows.groupby("panel", sort=False)
    ]
    return f"Predicted peak rates follow the peak rate of strain energy: {', '.join(shared)}"


@finding("5-5", "5-6")
def _at_places(f: DataFrame) -> str:
    skin = own(f, series="skin")
    top = skin.groupby("panel", sort=False)[P].max() / 1e3
    words = ", ".join(f"{n(p)} kPa at {place}" for place, p in top.items())
    return f"The highest pressure is {words} of the stroke"


def _curved(f: DataFrame) -> float:
    rows = own(f).dropna(subset=[P_CENTRE, SCALED_CURVATURE])
    rows = rows[rows[P_CENTRE] > 0]
    return alike(rows[P_CENTRE], rows[SCALED_CURVATURE])


@finding("5-7", "5-11")
def _pressure_and_curvature(f: DataFrame) -> str:
    return f"In contact, pressure and the curvature of the skin correlate by {_curved(f):.2f}"


@finding("5-8")
def _stepped_and_stroked(f: DataFrame) -> str:
    peaks = own(f).groupby("series")[P_CENTRE].max() / 1e3
    return (
        "Stepped or stroked, the centre pressure is "
        f"{n(spread_of(own(f), P_CENTRE, 'series'))} % apart; it peaks at "
        f"{n(peaks['stepped'])} and {n(peaks.drop('stepped').iloc[0])} kPa"
    )


@finding("5-9", "5-12")
def _velocities(f: DataFrame) -> str:
    rows = own(f)
    top = rows.groupby("series")[P_CENTRE].max() / 1e3
    off = spread_of(rows, P_CENTRE, "series")
    return (
        f"Between velocities the centre pressure differs by {n(off)} %; it peaks at "
        f"{span(top, 'kPa')}"
    )


@finding("5-10")
def _nodes(f: DataFrame) -> str:
    rows = own(f)
    shared = Series(
        {
            panel: alike(part[P], part[SKIN_CURVATURE])
            for panel, part in rows[rows[P] > 0].groupby("panel", sort=False)
        }
    )
    return (
        f"At nine points of the skin, pressure and curvature correlate by {span(shared)} while in "
        "contact"
    )


@finding("5-13", "5-24")
def _energies_of_velocities(f: DataFrame) -> str:
    rows = own(f)
    top, off = rows.groupby("series")[SED].max(), spread_of(rows, SED, "series")
    return f"Between velocities strain energy differs by {n(off)} %; it peaks at {span(top, 'Pa')}"


@finding("5-14")
def _laws_of_energy(f: DataFrame) -> str:
    rows, off = own(f), {}
    keys = ["series", DISTANCE]
    true = rows[rows["source"] == SIMULATED].groupby(keys)[SED].mean()
    for source, part in rows[rows["source"] != SIMULATED].groupby("source", sort=False):
        law = part.groupby(keys)[SED].mean()
        words = source.removeprefix(f"{SIMULATED}: ")
        off[words] = misfit(law, true.reindex(law.index))
    return "Off the simulated strain energy: " + ", ".join(
        f"{words} {n(value)} %" for words, value in off.items()
    )


@finding("5-15")
def _dragged(f: DataFrame) -> str:
    far = own(f).groupby("series", sort=False)[LATERAL].apply(lambda d: d.abs().max())
    return (
        f"Friction drags the skin by up to {span(far, 'mm')}, at {far.index[0]} to {far.index[-1]}"
    )


@finding("5-18")
def _stroked_over_pressed(f: DataFrame) -> str:
    rows = own(f)
    pressed = rows[rows["series"] == "ramp and hold"].sort_values(CURVATURE)
    stroked = rows[rows["series"] != "ramp and hold"]
    stroked = stroked[stroked[CURVATURE] >= pressed[CURVATURE].min() - 1]
    over = stroked[SED] / np.interp(stroked[CURVATURE], pressed[CURVATURE], pressed[SED])
    return f"Stroked, strain energy peaks at {span(over)} times that of a cylinder pressed"


@finding("5-26")
def _ridged(f: DataFrame) -> str:
    top = own(f).groupby(["panel", "surface"])[SED].max().unstack(0)
    over = top.iloc[:, 0] / top.iloc[:, 1]
    return (
        f"In the stiff tip of a ridge strain energy peaks at {span(over)} times that 46 µm beside "
        "it"
    )


@finding("5-27")
def _impulses_of_ways(f: DataFrame) -> str:
    rows = own(f, panel="raster")
    count = {way: int((rows["series"] == way).sum()) for way in ("right", "left")}
    return f"A plate stroked right gives {count['right']} impulses, stroked left {count['left']}"


@finding("5-28", "5-29")
def _directions(f: DataFrame) -> str:
    mean = own(f).groupby(["series", "panel"])[SED].mean().unstack()
    over = mean["right"] / mean["left"]
    words = ", ".join(f"{n(over[k], 3)} at {k}" for k in over.index if k.startswith("x = "))
    return f"Strain energy of a stroke to the right over one to the left: {words}"


def slowest_and_fastest(rows: DataFrame, **units: str) -> str:
    """``at 1 and 40 mm/s: 1.7 to 18 and 0.42 to 9.7 mm``: of all convexities, each quantity that
    is named by what its column begins with.
    """
    speed = rows["series"].str.removesuffix(" mm/s").astype(float)
    ends = speed.min(), speed.max()
    spans = []
    for name, unit in units.items():
        column = f"{name} ({unit})"
        low, high = (span(rows.loc[speed == v, column].dropna()) for v in ends)
        spans.append(f"{low} and {high} {unit}")
    return f"at {n(ends[0])} and {n(ends[1])} mm/s: {'; '.join(spans)}"


@finding("5-1", "5-22")
def _strokes(f: DataFrame) -> str:
    ticks = own(f, panel="raster")
    strokes = int(ticks["trial (1)"].max()) if len(ticks) else 0
    top = own(f)[IMPULSE_RATE].max()
    return (
        f"{strokes} strokes give {len(ticks)} impulses; in bins of half a millimetre they come at "
        f"up to {n(top)} impulses/s"
    )


@finding("5-2")
def _bursts(f: DataFrame) -> str:
    rows = own(f)
    width, rate = (rows[y].dropna() for y in ("burst_width (mm)", "burst_rate (impulses/s)"))
    return f"Predicted bursts are {span(width, 'mm')} wide, at {span(rate, 'impulses/s')}"


@finding("5-3")
def _bursts_at_velocities(f: DataFrame) -> str:
    rows = own(f)
    found = slowest_and_fastest(rows, burst_width="mm", burst_rate="impulses/s")
    return f"Predicted bursts {found}"


@finding("5-4")
def _in_contact(f: DataFrame) -> str:
    touched = own(f)["contact_length (mm)"].dropna()
    return f"A convexity touches the middle of the skin over {span(touched, 'mm')} of the stroke"


@finding("5-16")
def _durations(f: DataFrame) -> str:
    return f"Predicted bursts last, {slowest_and_fastest(own(f), burst_duration='s')}"


@finding("5-17")
def _rates_stroked_and_pressed(f: DataFrame) -> str:
    top = own(f).groupby("series", sort=False)[IMPULSE_RATE].max()
    stroked, pressed = top[top.index.str.contains("peak")]
    return (
        f"The predicted rate peaks at up to {n(stroked)} impulses/s when stroked, {n(pressed)} "
        "when pressed"
    )


@finding("5-19")
def _energy_and_impulses(f: DataFrame) -> str:
    top = own(f)[[SED, RATE, IMPULSE_RATE]].max()
    return (
        f"While it slides strain energy reaches {n(top[SED])} Pa, its rate {n(top[RATE])} Pa/s, "
        f"and the impulses {n(top[IMPULSE_RATE])} a second"
    )


@finding("5-20", "5-21")
def _parts_of_the_rate(f: DataFrame) -> str:
    rows, static = own(f), "rate_from_energy (impulses/s)"
    whole, part = rows[IMPULSE_RATE].max(), rows[static].max()
    return (
        f"The predicted rate peaks at {n(whole)} impulses/s; strain energy alone gives at most "
        f"{n(part)}, its rate the rest"
    )


@finding("5-23")
def _shallow(f: DataFrame) -> str:
    rate = next(c for c in f if c.startswith("predicted_") and "impulses/s" in c)
    top = own(f).groupby("series", sort=False)[rate].max()
    words = ", ".join(f"{n(value)} at {series}" for series, value in top.items())
    return f"The predicted rate 560 µm deep peaks (impulses/s) at {words}"
