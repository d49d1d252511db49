"""Numbers of the thesis, read from simulated histories and meshes: one function an id of the reference."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from fingerpad.claims.response_numbers import RESPONSE_GIVEN, RESPONSE_NUMBERS
from fingerpad.claims.ridge_rows import RIDGE_GIVEN, RIDGE_NUMBERS
from fingerpad.claims.stroke_numbers import STROKE_GIVEN, STROKE_NUMBERS
from fingerpad.claims.stroke_rates import RATE_GIVEN, RATE_NUMBERS
from fingerpad.measures.features import (
    PRESSURE,
    PRESSURE_SCALE,
    SURFACES,
    Histories,
    Meshes,
    centre_node,
    centre_pressure,
    energy,
    energy_rate,
    force_gf,
    peak_pressure,
    ramp_end,
    scene_name,
    scene_of,
    surface_nodes,
)
from fingerpad.measures.responses import stroke_law
from fingerpad.measures.steady import (
    BAR,
    DEPTH_SCENES,
    LINE,
    PLATE,
    RAMP_HOLD,
    SPEED_SCENES,
    force_N,
    pressed_depths,
    steady_force,
)
from fingerpad.receptors.laws import SpatialSum
from fingerpad.specimen.mesh import corner_count

Number = Callable[["Results"], float]
CYLINDERS = SURFACES[1:]


@dataclass(frozen=True)
class Results:
    """Simulated histories and meshes, by scene name."""

    histories: Histories
    meshes: Meshes

    def __call__(self, label: str, programme: str = "ramp40") -> xr.Dataset:
        """History of one surface in one force programme. Raises KeyError if it was not simulated."""
        return self.histories[scene_name(programme, label)]

    @property
    def specimen(self) -> dict:
        """The specimen (SI) of the flat plate's scene."""
        return scene_of(self("flat"))["specimen"]

    @cached_property
    def stroke_law(self) -> tuple[SpatialSum, float]:
        """Eq 4-4 of the pressed surfaces at 915 um, and its constant shift (m) in the stroke at 10 mm/s."""
        return stroke_law(self.histories)

    def quality(self) -> dict:
        """Quality of the flat plate's mesh."""
        return self.meshes["ramp40_flat"].quality()


def top_of(history: xr.Dataset, name: str) -> float:
    return float(history[name].values[ramp_end(history)])


def end_of(history: xr.Dataset, name: str) -> float:
    return float(history[name].values[-1])


def highest_pressure(history: xr.Dataset) -> float:
    """Largest pressure (Pa) of the whole history, at any node."""
    return float(peak_pressure(history).max())


def _energy_peak(results: Results, depth: float, label: str = "1260", programme: str = "ramp40") -> float:
    return float(energy(results(label, programme), depth).max())


def _rate_gf(history: xr.Dataset) -> float:
    """Mean force rate of the ramp, gf/s."""
    top = ramp_end(history)
    return float(force_gf(history)[top] / history["time"].values[top])


def ramp_time(history: xr.Dataset) -> float:
    return float(history["time"].values[ramp_end(history)])


def hold_time(history: xr.Dataset) -> float:
    return float(history["time"].values[-1]) - ramp_time(history)


def _curvature_departure(results: Results) -> float:
    exact = [scene_of(results(k))["stimulus"]["curvature"] for k in CYLINDERS]
    return max(100 * abs(k - float(label)) / k for k, label in zip(exact, CYLINDERS, strict=True))


def _relaxed(results: Results) -> float:
    return 1 - sum(term["g"] for term in results.specimen["prony"])


def _instantaneous(results: Results, layer: str) -> float:
    """Instantaneous Young's modulus (MPa): the long-term one over the long-time relaxation."""
    modulus = results.specimen["layers"][layer]["youngs_modulus"] * 1e-6
    return modulus if results.specimen["moduli"] == "instantaneous" else modulus / _relaxed(results)


def _modulus(layer: str) -> Number:
    return lambda r: r.specimen["layers"][layer]["youngs_modulus"] * 1e-6


def _outline(key: str, scale: float) -> Number:
    return lambda r: r.specimen["outline"][key] * scale


def _extent(axis: int) -> Number:
    return lambda r: float(np.ptp(r.meshes["ramp40_flat"].points[:, axis])) * 1e3


def _smallest_edge(results: Results) -> float:
    """Smallest element edge (um) in epidermis and dermis within 2 mm of the middle, on the upper side."""
    mesh = results.meshes["ramp40_flat"]
    corners = mesh.points[mesh.cells[:, : corner_count(mesh.element)]]
    middle = corners.mean(axis=1)
    near = (mesh.region < mesh.regions.index("fat")) & (abs(middle[:, 0]) < 2e-3) & (middle[:, 1] > 0)
    edges = corners[near] - np.roll(corners[near], 1, axis=1)
    return float(np.hypot(edges[..., 0], edges[..., 1]).min()) * 1e6


def _node_spacing(results: Results) -> float:
    """Spacing (um) of the skin nodes next to the centre."""
    history = results("flat")
    centre = centre_node(history)
    return float(np.hypot(np.diff(history["skin_x"])[centre], np.diff(history["skin_y"])[centre])) * 1e6


def _depths_present(results: Results, depths: tuple[int, ...]) -> float:
    have = set(np.round(results("flat")["receptor_depth"].values * 1e6).astype(int))
    return len(have & set(depths))


def _critical_distance(results: Results, label: str = "210") -> float:
    """Mean distance (mm) from a node to the contact edge when its pressure peaks, on the deformed skin.

    Over the nodes that reach their largest pressure before the ramp ends.
    """
    history = results(label)
    distances = []
    for node in surface_nodes(history):
        pressure = history[PRESSURE].values[:, node]
        index = int(pressure.argmax())
        if 0 < index < ramp_end(history):
            x = float(history["skin_x"].values[node] + history["skin_displacement_x"].values[index, node])
            distances.append(float(history["contact_width"].values[index]) / 2 - x)
    return float(np.mean(distances)) * 1e3 if distances else float("nan")


def _larger_of_scaled(results: Results, label: str) -> float:
    history = results(label)
    return max(PRESSURE_SCALE * float(centre_pressure(history).max()), _energy_peak(results, 915e-6, label))


def width_mm(results: Results, label: str) -> float:
    return end_of(results(label), "contact_width") * 1e3


def _sunk(results: Results, label: str) -> float:
    """Largest downward displacement (mm) of any skin node."""
    return float(-results(label)["skin_displacement_y"].values.min()) * 1e3


def _skin_height(results: Results, label: str) -> float:
    history = results(label)
    node = centre_node(history)
    return float(history["skin_y"].values[node] + history["skin_displacement_y"].values[-1, node]) * 1e3


INVERSE_WIDTHS = dict(zip(SURFACES, ("T106", "T108", "T110", "T112", "T114", "T115", "T116", "T118", "T120"), strict=True))
"""Ids of the inverse contact widths of Fig 4-9, by surface."""

# --- chapter 3's checks: steady presses, ramps and holds of a flat plate ---------------------------------


def _stimulus(scene: str, of: Callable[[dict], float]) -> Number:
    """A length (mm) of a scene's stimulus."""
    return lambda r: of(scene_of(r.histories[scene])["stimulus"]) * 1e3


def _diameter(stimulus: dict) -> float:
    return 2 / stimulus["curvature"]


def _depths_of(*scenes: str) -> Callable[[Results], list[float]]:
    """Depths (mm) that are pressed to, in the order of scenes and legs."""
    return lambda r: [round(z * 1e3, 9) for name in scenes for z in pressed_depths(r.histories[name])]


def _depths_among(scenes: tuple[str, ...]) -> Number:
    """How many of the thesis's four depths (mm) the scenes press to."""
    return lambda r: len({0.5, 1.0, 1.5, 2.0} & set(_depths_of(*scenes)(r)))


def _speed(scene: str) -> Number:
    """Mean speed (mm/s) of a scene's first leg."""

    def number(results: Results) -> float:
        history = results.histories[scene]
        return top_of(history, "indentation_depth") * 1e3 / ramp_time(history)

    return number


def _largest_force(scenes: Iterable[str]) -> Number:
    """Largest force (N) of several scenes."""
    return lambda r: max(float(force_N(r.histories[name]).max()) for name in scenes)


def _peak_over_steady(scene: str) -> Number:
    """Largest force of a ramp and hold over the steady force of the plate at its depth."""

    def number(results: Results) -> float:
        history = results.histories[scene]
        level = steady_force(results.histories[PLATE], max(pressed_depths(history)))
        return float(force_N(history).max()) / level

    return number


def _not_at_hand(results: Results) -> float:
    raise KeyError("one of the five subjects; the data of four are at hand (Dandekar, Raju and Srinivasan 2003)")


CHAPTER3_GIVEN: dict[str, Number] = {
    "T026": _stimulus("steady_cylinder_1_8_inch", _diameter),
    "T027": _stimulus("steady_cylinder_1_4_inch", _diameter),
    "T028": _stimulus("steady_cylinder_1_inch", _diameter),
    "T029": _stimulus(BAR, lambda s: s["width"]),
    "T030": lambda r: _depths_of("steady_cylinder_1_4_inch", "steady_cylinder_1_inch")(r)[0],
    "T030a": lambda r: _depths_of(BAR)(r)[0],
    "T057": lambda r: float(np.diff([0.0, *_depths_of(LINE)(r)]).max()),
    "T060": _depths_among((PLATE,)),
    "T061": _not_at_hand,
    "T064": _speed(RAMP_HOLD),
    "T065": _depths_among(tuple(DEPTH_SCENES.values())),
    **{f"T068{tag}": _speed(scene) for tag, scene in zip("abc", SPEED_SCENES.values(), strict=True)},
    "T069": lambda r: _depths_of(*SPEED_SCENES.values())(r)[0],
    "T072": lambda r: _depths_of(BAR)(r)[-1],
}

CHAPTER3: dict[str, Number] = {
    "T058": lambda r: round(float(-r.histories[LINE]["skin_displacement_y"].values.min()) * 1e3, 4),
    "T062": _largest_force((PLATE,)),
    "T066": _largest_force(DEPTH_SCENES.values()),
    "T070": _largest_force(SPEED_SCENES.values()),
    **{f"E047{tag}": _peak_over_steady(scene) for tag, scene in zip("abcd", DEPTH_SCENES.values(), strict=True)},
    **{f"E048{tag}": _peak_over_steady(scene) for tag, scene in zip("abc", SPEED_SCENES.values(), strict=True)},
}

GIVEN: dict[str, Number] = {
    **CHAPTER3_GIVEN,
    **RESPONSE_GIVEN,
    **STROKE_GIVEN,
    **RATE_GIVEN,
    **RIDGE_GIVEN,
    "T031": _outline("stratum_corneum_thickness", 1e6),
    "T033": _outline("epidermis_thickness", 1e6),
    "T034": _outline("epidermis_thickness", 1e6),
    "T035": _outline("epidermis_thickness", 1e6),
    "T036": _outline("dermis_thickness", 1e6),
    "T037": lambda r: r.quality()["nodes"],
    "T037a": lambda r: r.quality()["elements"],
    "T038": _smallest_edge,
    "T039": _extent(0),
    "T040": _extent(1),
    "T041": lambda r: len(r.meshes["ramp40_flat"].regions) + 2,
    "T042": lambda r: r.specimen["layers"]["dermis"]["poisson_ratio"],
    "T044": lambda r: _modulus("epidermis")(r) / _modulus("dermis")(r),
    "T044a": lambda r: _modulus("dermis")(r) / _modulus("fat")(r),
    "T045": _modulus("epidermis"),
    "T046": _modulus("dermis"),
    "T047": _modulus("fat"),
    "T049": lambda r: r.specimen["prony"][0]["g"],
    "T050": lambda r: r.specimen["prony"][1]["g"],
    "T051": lambda r: r.specimen["prony"][0]["tau"],
    "T052": lambda r: r.specimen["prony"][1]["tau"],
    "T053": lambda r: _relaxed(r) + sum(term["g"] for term in r.specimen["prony"]),
    "T054": _relaxed,
    "T055": lambda r: _instantaneous(r, "epidermis"),
    "T056": lambda r: _instantaneous(r, "dermis"),
    "T073": lambda r: float(force_gf(r("flat"))[-1]),
    "T074": lambda r: ramp_time(r("flat")),
    "T075": lambda r: hold_time(r("flat")),
    "T076": lambda r: sum(scene_name("ramp40", k) in r.histories for k in SURFACES),
    "T077": lambda r: _rate_gf(r("flat", "ramp150")),
    "T078": lambda r: hold_time(r("flat", "ramp150")),
    "T097": lambda r: _rate_gf(r("flat")),
    "T098": _curvature_departure,
    "T122": lambda r: float(force_gf(r("flat")).max()),
    "T153": _node_spacing,
    "T163": lambda r: _depths_present(r, (800, 915)),
    "T164": lambda r: _rate_gf(r("flat", "ramp150")),
    "T190": lambda r: _depths_present(r, (560, 600, 640, 765, 800, 845)),
    "T191": lambda r: _depths_present(r, (870, 915, 960)),
    "T323": _outline("apex_radius", 1e3),
    "T324": lambda r: end_of(r("flat"), "force"),
}
"""What goes into the simulations: inputs, counts and geometry. They have no discretisation error."""

NUMBERS: dict[str, Number] = {
    **GIVEN,
    **CHAPTER3,
    **STROKE_NUMBERS,
    **RATE_NUMBERS,
    **RESPONSE_NUMBERS,
    **RIDGE_NUMBERS,
    "T101": lambda r: _skin_height(r, "1260"),
    "T102": lambda r: max(end_of(r(k), "indentation_depth") for k in SURFACES) * 1e3,
    "T102a": lambda r: end_of(r("1260"), "indentation_depth") * 1e3,
    "T104": lambda r: max(width_mm(r, k) for k in SURFACES),
    **{id_: (lambda r, k=label: 1 / width_mm(r, k)) for label, id_ in INVERSE_WIDTHS.items()},
    "T123": lambda r: max(float(centre_pressure(r(k)).max()) for k in SURFACES),
    **{f"T{125 + i}": (lambda r, k=label: highest_pressure(r(k))) for i, label in enumerate(SURFACES)},
    "T134a": lambda r: max(width_mm(r, k) for k in CYLINDERS) / 2,
    "T135": lambda r: highest_pressure(r.histories["homogeneous_flat"]),
    "T136": lambda r: highest_pressure(r("flat")),
    "T137a": lambda r: width_mm(r, "flat") / 2,
    "T138": lambda r: highest_pressure(r("flat")),
    "T139": lambda r: max(highest_pressure(r(k)) for k in ("79", "105")),
    "T140": lambda r: max(highest_pressure(r(k)) for k in ("158", "210", "315")),
    "T141": lambda r: max(highest_pressure(r(k)) for k in ("420", "630")),
    "T142": lambda r: highest_pressure(r("1260")),
    "T143": lambda r: _sunk(r, "flat"),
    "T144": lambda r: _sunk(r, "1260"),
    "T145": lambda r: highest_pressure(r("210")),
    "T146": lambda r: width_mm(r, "210") / 2,
    "T147": _critical_distance,
    "T148": lambda r: highest_pressure(r("210")),
    "T150": lambda r: highest_pressure(r("210")),
    "T154": lambda r: highest_pressure(r("210")),
    "T159": lambda r: max(highest_pressure(r(k)) for k in SURFACES),
    **{
        f"T165{tag}": (lambda r, k=label: highest_pressure(r(k, "ramp150")))
        for tag, label in zip("abc", ("flat", "158", "1260"), strict=True)
    },
    **{
        id_: (lambda r, z=depth, k=label: _energy_peak(r, z, k, "ramp150"))
        for id_, depth, label in (
            ("T166", 800e-6, "flat"),
            ("T167", 800e-6, "158"),
            ("T168", 800e-6, "1260"),
            ("T169", 915e-6, "flat"),
            ("T170", 915e-6, "158"),
            ("T171", 915e-6, "1260"),
        )
    },
    **{
        id_: (lambda r, k=label: _larger_of_scaled(r, k))
        for id_, label in (
            ("T173", "flat"),
            ("T174", "79"),
            ("T175", "105"),
            ("T176", "210"),
            ("T177a", "315"),
            ("T177b", "420"),
            ("T178", "630"),
            ("T179", "1260"),
        )
    },
    **{
        id_: (lambda r, k=label: _energy_peak(r, 915e-6, k))
        for id_, label in zip(("T181", "T182", "T183", "T184", "T185", "T186", "T187a", "T187b", "T187c"), SURFACES, strict=True)
    },
    "T188": lambda r: max(_energy_peak(r, 915e-6, k) for k in SURFACES),
    **{
        id_: (lambda r, z=depth: max(_energy_peak(r, z, k) for k in SURFACES))
        for id_, depth in (
            ("T192", 560e-6),
            ("T193", 600e-6),
            ("T194", 640e-6),
            ("T195", 765e-6),
            ("T196", 800e-6),
            ("T197", 845e-6),
            ("T198a", 870e-6),
            ("T198b", 915e-6),
            ("T198c", 960e-6),
        )
    },
    "T205": lambda r: max(float(energy_rate(r(k), 915e-6)["strain_energy_rate (Pa/s)"].max()) for k in SURFACES),
}
"""Every number that has a row, by id."""
