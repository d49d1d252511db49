"""What the pages say of the published tables and of the pad: every such number is read here, and none is typed into a page.

``<!-- name -->text<!-- / -->`` in a page holds ``numbers()["name"]``, and reads as the text alone wherever Markdown is shown.
``python docs/_ext/published.py`` writes the present numbers into the pages; so does each build of the documentation.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pandas as pd

from cysyk1999.claims.comparison import AGREES, holding

ROOT = Path(__file__).parents[2]
MARKED = re.compile(r"<!-- (\w+) -->(.*?)<!-- / -->", re.S)
_NUMBERS: dict[str, Callable[[], object]] = {}


@cache
def table(path: str) -> pd.DataFrame:
    """A published CSV file, by its path in the repository without the ending."""
    return pd.read_csv(ROOT / f"{path}.csv")


def numbers() -> dict[str, str]:
    """All of them, as text."""
    return {name: str(read()) for name, read in _NUMBERS.items()}


def pages() -> list[Path]:
    """The pages that are written by hand."""
    ours = (
        path
        for path in (ROOT / "docs").rglob("*.md")
        if not {"_build", "generated"} & set(path.parts)
    )
    return [ROOT / "README.md", ROOT / "workflow/profiles/slurm/README.md", *sorted(ours)]


def filled(text: str, known: dict[str, str]) -> str:
    """A page with the present numbers. Raises KeyError for a name that is not known."""

    def fill(mark: re.Match) -> str:
        name = mark[1]
        lines = "\n" * ("\n" in known[name])  # a table has lines of its own
        return f"<!-- {name} -->{lines}{known[name]}{lines}<!-- / -->"

    return MARKED.sub(fill, text)


def fill_pages() -> None:
    """Write the present numbers into the pages that say others."""
    known = numbers()
    for page in pages():
        text = page.read_text(encoding="utf-8")
        if (new := filled(text, known)) != text:
            page.write_text(new, encoding="utf-8")


def number(read: Callable[[], object]) -> Callable[[], object]:
    """Enter a number under the name of the function that reads it."""
    _NUMBERS[read.__name__] = read
    return read


def digits(value: float, count: int = 2) -> str:
    """A number to so many significant digits, without an exponent where that reads better."""
    text = f"{value:.{count}g}"
    return f"{float(text):,.0f}" if "e+" in text else re.sub(r"e-0?(\d+)", r" x 10^-\1", text)


def several(values, count: int = 2, joint: str = " to ") -> str:
    """The least and the most of some numbers; one of them if they read the same."""
    ends = dict.fromkeys((digits(min(values), count), digits(max(values), count)))
    return joint.join(ends)


# --- the thesis -----------------------------------------------------------------------------------


def compared() -> pd.DataFrame:
    """Rows of the comparison that have been judged, with the form of their statement in the thesis."""
    rows = table("figures/tables/thesis_comparison")
    rows = rows.join(table("config/reference/thesis_numbers").set_index("id")["form"], on="id")
    return rows[rows["verdict"] != "not_comparable"]


def verdict(figure: str) -> str:
    """How many of the thesis's statements on a figure hold here, in a sentence; empty where none can be answered."""
    good, count = holding(table("figures/tables/thesis_comparison")).get(figure, (0, 0))
    if not count:
        return ""
    what = "statement of the thesis holds" if count == 1 else "statements of the thesis hold"
    return f"{good} of {count} {what} here"


def _share(kind: str, score: str) -> str:
    """Rows that agree: of a kind (range, axis or trend), held out or fitted; repeated and unscored ones left out."""
    rows = compared()
    rows = rows[rows["score"] == score]
    kinds = rows["form"].map({"axis": "axis", "trend": "trend"}).fillna("range")
    rows = rows[kinds == kind]
    return f"{rows['verdict'].isin(AGREES).sum()} of {len(rows)}"


@number
def ranges_held_out():
    return _share("range", "held out")


@number
def axes_held_out():
    return _share("axis", "held out")


@number
def trends_held_out():
    return _share("trend", "held out")


@number
def fitted_inside():
    return "{}, {} and {}".format(*(_share(kind, "fitted") for kind in ("range", "axis", "trend")))


@number
def inputs_as_stated():
    rows = compared()
    rows = rows[rows["role"].isin(["input", "count"])]
    return f"{rows['verdict'].isin(AGREES).sum()} of {len(rows)}"


@number
def pressure_change():
    return digits(abs(_row("TR29")))


@number
def energy_change():
    return digits(abs(_row("TR30")))


def _row(key: str, column: str = "simulated"):
    return table("figures/tables/thesis_comparison").set_index("id").loc[key, column]


def _noted(key: str, pattern: str) -> str:
    found = re.search(pattern, _row(key, "note"))
    if not found:
        raise ValueError(f"thesis_comparison: the note of {key} says nothing like {pattern}")
    return found[1]


@number
def stroke_correlation():
    return digits(_row("TR26"))


@number
def pressure_spread():
    return digits(float(_noted("TR29", r"spread by ([\d.]+) % on average")))


@number
def energy_spread():
    return digits(float(_noted("TR30", r"spread by ([\d.]+) % on average")))


@number
def double_peaks():
    return f"{_row('TR41'):.0f} of {_row('TR41', 'thesis_low'):.0f}"


@number
def eq_4_4_worst():
    return digits(table("figures/tables/receptor_fits").query("law == '4-4'")["r_squared"].min())


# --- what is read otherwise -----------------------------------------------------------------------


@number
def explained_share():
    told = (ROOT / "figures/tables/explanations.md").read_text(encoding="utf-8")
    return re.search(r"right or explained: (\d+) ?%", told)[1] + " %"


@number
def mending_readings():
    rows = table("figures/tables/explanations_readings").query("makes_hold > makes_fail")
    return "; ".join(
        f"{row.words} ({row.makes_hold} and {row.makes_fail})" for row in rows.itertuples()
    )


# --- the pad of 1999 ------------------------------------------------------------------------------


def _reading(name: str, column: str) -> float:
    rows = table("figures/tables/reconstruction_readings").query(
        "`strain energy` == 'instantaneous elastic'"
    )
    return float(rows.set_index("reading").loc[name, column])


@number
def decades_for_instantaneous():
    ahead = _reading("instantaneous", "log evidence (1)") - _reading(
        "long_term", "log evidence (1)"
    )
    return f"{ahead / 2.302585:.0f}"


def _inferred(quantity: str) -> str:
    rows = table("figures/tables/reconstruction_posterior").query(
        "reading == 'instantaneous' and quantity == @quantity"
    )
    row = rows.iloc[0]
    return f"{row['median']:.2g} {row['unit']} ({row['low 5 %']:.2g} to {row['high 95 %']:.2g})"


@number
def inferred_radius():
    return _inferred("apex_radius")


@number
def inferred_fat():
    return _inferred("fat_thickness")


@number
def inferred_load():
    return _inferred("line_load")


def _distance(pad: str) -> float:
    return float(
        table("figures/tables/reconstruction_families")
        .set_index("pad")
        .loc[pad, "distance, fitted (1)"]
    )


@number
def distance_chosen():
    return digits(_distance("chosen one at a time"))


@number
def distance_inferred():
    return digits(_distance("best of instantaneous"))


@number
def held_out_inferred():
    rows = table("figures/tables/reconstruction_families").set_index("pad")["inside, held out"]
    return f"{rows['best of instantaneous']} ({rows.iloc[0]} by this pad)"


# --- friction, force ------------------------------------------------------------------------------


def _calibrated(study: str, quantity: str, subject: str | None = None) -> pd.Series:
    rows = table("figures/tables/calibration").query("study == @study and quantity == @quantity")
    return (rows if subject is None else rows[rows["subject"] == subject]).iloc[0]


@number
def friction():
    return digits(_calibrated("friction", "coefficient, rounded")["estimate"])


@number
def friction_range():
    ends = (
        _calibrated("friction", f"{end} coefficient for about 1 mm")["estimate"]
        for end in ("least", "most")
    )
    return several(list(ends))


@number
def friction_on_fitted_pad():
    return digits(
        _calibrated("friction: moduli fitted to measured forces", "coefficient for 1 mm")[
            "estimate"
        ]
    )


@number
def modulus_constant():
    row = _calibrated("constant", "modulus constant", "mean")
    return f"{row['estimate']:.2f} ({row['low_95']:.2f} to {row['high_95']:.2f})"


@number
def modulus_times_length():
    row = _calibrated("identifiability", "modulus constant x contact length")
    return f"{row['estimate']:.1f} mm ({row['low_95']:.1f} to {row['high_95']:.1f})"


# --- ridges ---------------------------------------------------------------------------------------


def _ridge_meshes(panel: str) -> pd.DataFrame:
    return table("figures/studies/ridges_mesh").query("panel == @panel")


@number
def ridge_ratio():
    row = _ridge_meshes("resolved").set_index("series").loc["thesis"]
    return digits(row["right (Pa)"] / row["left (Pa)"])


@number
def ridge_index():
    return digits(
        _ridge_meshes("resolved").set_index("series").loc["thesis", "directional_index (1)"]
    )


@number
def ridge_index_meshes():
    return several(_ridge_meshes("resolved")["directional_index (1)"])


@number
def ridge_index_drawn():
    return several(_ridge_meshes("drawn")["directional_index (1)"])


@number
def ridge_index_none():
    rows = table("figures/studies/ridges_height")
    flat = rows[rows["series"].str.startswith("thesis") & (rows["ridge_height (um)"] == 0)]
    return digits(flat["directional_index (1)"].iloc[0], 1)


# --- receptors ------------------------------------------------------------------------------------


@number
def rate_misfit():
    rows = table("figures/tables/receptor_fits").query(
        "law == \"5-1, thesis's constants\" and residual_units == 'impulses/s'"
    )
    return digits(rows[rows["scenes"].str.startswith("Cysyk")]["residual_rms"].iloc[0])


@number
def best_candidate():
    rows = table("figures/tables/candidate_stimuli")
    row = rows[rows["rates"].str.startswith("Cysyk") & (rows["rank"] == 1)].iloc[0]
    return f"{row['candidate']} {row['depth']}"


# --- accuracy -------------------------------------------------------------------------------------

_FAMILY = ("flat", "210", "1260", "stroke")


@number
def presets():
    """The table of presets, as Markdown."""
    rows = table("figures/tables/presets")
    lines = [
        "| preset | nodes | flat | 210 1/m | 1260 1/m | stroke | a press takes | the stroke |",
        "|" + "---|" * 8,
    ]
    for name in ("draft", "thesis", "fine"):
        of = rows[rows["preset"] == name].set_index("scene")
        errors = [f"{digits(of.loc[scene, 'error (%)'])} %" for scene in _FAMILY]
        times = of["process time (s)"]
        took = [f"{digits(times.drop('stroke').mean())} s", f"{digits(times['stroke'])} s"]
        lines.append("| " + " | ".join([name, f"{of['nodes'].max():,}", *errors, *took]) + " |")
    return "\n".join(lines)


def _profiles(mesh: str) -> pd.Series:
    """Largest error (%) of the pressure across the contact, by surface."""
    rows = table("figures/tables/accuracy_edges").query(
        "mesh == @mesh and `smoothing (of the method's)` == 1"
    )
    return rows.set_index("surface")["pressure profile off (%)"]


@number
def profiles_refined():
    return several(_profiles("own"))


@number
def profiles_not_refined():
    return digits(_profiles("not refined").max())


@number
def profiles_refined_into_the_skin():
    return several(_profiles("refined into the skin too"))


@number
def growth_exponent():
    return digits(
        table("figures/studies/accuracy_growth").query("element == 'Q2P1'")["exponent"].iloc[0], 3
    )


def _without(model: str = "finite elements", strain: str | None = None) -> pd.Series:
    rows = table("figures/tables/accuracy").query("model == @model")
    return (rows if strain is None else rows[rows["strain"] == strain])["error (%)"]


@number
def small_strain_errors():
    return several(_without(strain="small"))


@number
def small_strain_costs():
    return several(
        table("figures/tables/accuracy").query("strain == 'small'")["cost (1 = default)"]
    )


@number
def half_plane_worst():
    return digits(_without("elastic half-plane").max())


@number
def water_bed_worst():
    return digits(_without("water bed").max())


def _covered(name: str) -> tuple[int, int]:
    rows = table(f"figures/tables/{name}").dropna(subset=["true error (%)"])
    return (rows["true error (%)"] <= rows["believed error (%)"]).sum(), len(rows)


@number
def beliefs_covered():
    return "{} of {}".format(*_covered("accuracy_belief"))


@number
def beliefs_missed():
    """The runs that are wronger than they believe, in words."""
    rows = table("figures/tables/accuracy_belief")
    rows = rows[rows["believed error (%)"] < rows["true error (%)"]]
    said = [
        f"{row['scene']} ({row['accuracy']}) believes {row['believed error (%)']:.1f} and is off by {row['true error (%)']:.1f} %"
        for _, row in rows.iterrows()
    ]
    return "; ".join(said).replace("_", " ") or "none"


@number
def belief_scenes():
    return table("figures/tables/accuracy_belief")["scene"].nunique()


@number
def drawn_covered():
    return "{} of {}".format(*_covered("accuracy_drawn"))


def _shown() -> pd.DataFrame:
    return table("figures/studies/accuracy_shown")


@number
def shown_figures():
    return table("figures/tables/accuracy_shown")["figure"].nunique()


@number
def shown_curves():
    return len(_shown())


@number
def shown_median():
    return f"{_shown()['true error (%)'].median():.2g}"


@number
def stated_median():
    return f"{_shown()['stated error (%)'].median():.2g}"


@number
def shown_covered():
    rows = _shown()
    return f"{(rows['true error (%)'] <= rows['stated error (%)']).sum()} of {len(rows)}"


@number
def shown_within_twice():
    rows = _shown()
    return (rows["true error (%)"] <= 2 * rows["stated error (%)"]).sum()


# --- stability, effects, peers --------------------------------------------------------------------


def _outcomes(method: str) -> pd.Series:
    rows = table("figures/studies/stability").drop_duplicates(["case", "method"])
    return rows[rows["method"] == method]["outcome"].str.split(":").str[0].value_counts()


@number
def hard_cases():
    return table("figures/tables/stability")["case"].nunique()


def _cases() -> pd.DataFrame:
    rows = table("figures/tables/stability")
    return rows.assign(drawn=rows["case"].str.match(r"\d+: "), stable=rows["outcome"] == "stable")


@number
def hard_cases_picked():
    return (~_cases()["drawn"]).sum()


@number
def hard_cases_referred():
    return _cases()["true error"].notna().sum()


@number
def hard_cases_stable():
    return _cases()["stable"].sum()


@number
def hard_cases_picked_stable():
    rows = _cases()
    return rows.loc[~rows["drawn"], "stable"].sum()


@number
def hard_cases_drawn_stable():
    rows = _cases()
    return rows.loc[rows["drawn"], "stable"].sum()


def _silent() -> pd.DataFrame:
    """Cases that end outside their limits and do not say so."""
    return _cases()[_cases()["outcome"] == "unsound"]


@number
def hard_cases_silent():
    return len(_silent())


@number
def hard_cases_silent_ones():
    return ", ".join(map(str, _silent()["no."])) or "none"


@number
def hard_cases_rest():
    """The others in words, by how they ended."""
    said = {
        "labours": "are right but took more cuts, factorisations or iterations than stable ones may",
        "admits its error": "say that they are wrong",
        "fails cleanly": "stop (exit code 3) with the last state saved, the cause named and what to relax",
        "not done": "not done in two minutes",
        "unsound": "end outside their limits and do not say so",
        "breaks off": "break off",
    }
    counts = _cases()["outcome"].value_counts()
    ends = [f"{counts[outcome]} {words}" for outcome, words in said.items() if outcome in counts]
    return f"Of the others {'; '.join(ends)}" if ends else "There are no others"


@number
def hard_cases_cured():
    rows = _cases()
    rest = rows[~rows["stable"]]
    return f"{rest['stable when relaxed'].notna().sum()} of the {len(rest)}"


@number
def hard_cases_cured_at_once():
    return int((_cases()["stable when relaxed"] == "all that is hard").sum())


@number
def linear_quads_wrong():
    return _outcomes("full Q1").get("wrong", 0)


@number
def triangles_wrong():
    return _outcomes("plain P2").get("wrong", 0)


@number
def triangles_unsound():
    return _outcomes("plain P2").get("unsound", 0)


@number
def newton_labours():
    return _outcomes("plain Newton").get("labours", 0)


@number
def newton_gives_up():
    return _outcomes("plain Newton").get("fails cleanly", 0)


def _effects(effect: str) -> pd.DataFrame:
    rows = table("figures/tables/effects")
    return rows[(rows["effect"] == effect) & rows["cost ratio"].notna()].set_index("scene")


@number
def finite_strain_costs():
    return several(_effects("finite_strain")["cost ratio"])


@number
def finite_strain_plate():
    return digits(100 * _effects("finite_strain").loc["20 gf, flat", "change"])


@number
def finite_strain_light():
    return digits(100 * _effects("finite_strain").loc["0.02 gf, 210 1/m", "change"])


@number
def half_pad_costs():
    return several(_effects("symmetry")["cost ratio"])


@number
def ridges_cost():
    return digits(_effects("ridges").loc["inner, 0.15 mm high", "cost ratio"])


@number
def high_ridges_change():
    return digits(100 * _effects("ridges").loc["inner, 0.15 mm high", "change"])


@number
def low_ridges_change():
    return digits(100 * _effects("ridges").loc["inner, 3 um high", "change"])


@number
def choices():
    return len(table("figures/tables/planner_choices"))


@number
def choice_scenes():
    return len(table("figures/tables/planner_choices")[["seed", "scene"]].drop_duplicates())


@number
def worst_left_out():
    rows = table("figures/tables/planner_choices")
    return digits(
        rows[rows["verdict"].str.endswith("left out")].query("planned == 'off'")["share"].max()
    )


@number
def wrong_choices():
    return (table("figures/tables/planner_choices")["verdict"] == "carried for nothing").sum()


def _peers() -> pd.DataFrame:
    rows = table("figures/tables/peers")
    return rows[~rows["package"].str.startswith("fingerpad")]


@number
def peer_packages():
    return " and ".join(_peers()["package"].unique())


@number
def peer_force():
    return digits(100 * _peers()["force off (1)"].max(), 1)


@number
def peer_process():
    return several(_peers()["process ratio (1)"])


@number
def peer_loop():
    return several(_peers()["loop ratio (1)"])


def _swept(what: str, scenes: int, quantity: str) -> float:
    rows = table("figures/tables/sweeps").query(
        "what == @what and scenes == @scenes and quantity == @quantity"
    )
    return rows["value"].iloc[0]


@number
def thousand_presses():
    return digits(
        _swept(
            "steady press, finite strain, the command on 2 cores", 1000, "wall time, median of 3"
        )
    )


@number
def two_cores():
    return digits(
        _swept(
            "steady press, finite strain, the command",
            1000,
            "scenes on two cores over scenes on one",
        )
    )


@number
def thousand_cheap_presses():
    return digits(
        _swept("steady press, small strain", 1000, "process time a scene, all included") * 1000
    )


def duration(seconds: float) -> str:
    """To two digits, in the unit that suits."""
    unit, size = next(
        (u, s) for u, s in (("h", 3600.0), ("min", 60.0), ("s", 0.0)) if seconds >= 1.5 * s
    )
    return f"{digits(seconds / (size or 1.0))} {unit}"


def _pressing(scenes: int) -> str:
    return duration(
        scenes * _swept("steady press, finite strain", 200, "process time a scene, all included")
    )


def _laying_out(scenes: int, measured: int) -> str:
    return duration(scenes * _swept("laying out", measured, "process time a scene"))


@number
def sweep_costs():
    """The table of what sweeps take, as Markdown."""
    lines = [
        "| scenes | batches | laying out | steady presses | dataset and table of 30 measures |",
        "|" + "---|" * 5,
    ]
    for scenes in (100, 1000, 10_000):
        collected = [
            _swept("collecting 30 measures", scenes, what)
            for what in ("process time", "largest memory")
        ]
        cells = [
            f"{scenes:,}",
            f"{_swept('laying out', scenes, 'batches'):.0f}",
            _laying_out(scenes, scenes),
            _pressing(scenes),
        ]
        lines.append(
            "| "
            + " | ".join([*cells, f"{duration(collected[0])}, {digits(collected[1])} MB"])
            + " |"
        )
    return "\n".join(lines)


@number
def million_laid_out():
    return _laying_out(1_000_000, 10_000)


@number
def million_presses():
    return _pressing(1_000_000)


@number
def memory_growth():
    return digits(
        100
        * (
            _swept(
                "steady press, small strain",
                1000,
                "largest memory after scene 100 over memory then",
            )
            - 1
        )
    )


@number
def largest_memory():
    rows = table("figures/tables/sweeps")
    return digits(
        rows[rows["quantity"].str.startswith("largest memory") & rows["unit"].eq("MB")][
            "value"
        ].max()
    )


def _soaked(what: str) -> str:
    return f"{table('figures/tables/soak').set_index('what').loc['all', what]:,}"


@number
def soak_drawn():
    return _soaked("drawn")


@number
def soak_refused():
    return _soaked("refused in one line")


@number
def soak_completed():
    return _soaked("completed")


@number
def soak_stopped():
    return _soaked("stopped with its diagnosis")


@number
def soak_late():
    return _soaked("not done in a minute")


# --- the pad --------------------------------------------------------------------------------------


@cache
def pad():
    """The specimen that scenes have by default, with its inner ridges."""
    from fingerpad import load_scene

    scene = {
        "specimen": {"ridges": "inner"},
        "stimulus": {"shape": "flat"},
        "motion": [{"press_to_force": "20 gf"}],
    }
    return load_scene(scene).specimen


def mm(length: float) -> str:
    return f"{1e3 * length:.3g} mm"


@number
def pad_radius():
    return mm(pad().outline.apex_radius)


@number
def pad_fat():
    o = pad().outline
    layers = o.epidermis_thickness + o.dermis_thickness
    return mm(o.apex_height - layers - o.bone_centre_height - o.bone_half_height)


@number
def pad_length():
    return mm(pad().contact_length)


@number
def ridge_sizes():
    inner = pad().ridges.inner
    return f"{mm(inner.pitch)} apart, {mm(inner.height)} high"


@number
def section_size():
    o = pad().outline
    return f"{mm(2 * o.half_width)} x {mm(o.apex_height + o.depth_below)}"


@number
def layer_thicknesses():
    o = pad().outline
    return f"epidermis {mm(o.epidermis_thickness)}, dermis {mm(o.dermis_thickness)}"


@number
def layer_moduli():
    layers = [getattr(pad().layers, name) for name in ("epidermis", "dermis", "fat")]
    state = pad().moduli.replace("long_term", "long-term")
    ratios = several([layer.poisson_ratio for layer in layers])
    return f"E = {' / '.join(f'{layer.youngs_modulus / 1e6:g}' for layer in layers)} MPa ({state}), nu = {ratios}"


if __name__ == "__main__":
    fill_pages()
