"""Made-up histories with the shapes of real ones: for testing figures and tables only, never a
result. ``synthetic.yaml`` says what they are of.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr
import yaml

from cysyk1999.measures.errors import Companion
from fingerpad.results import FRICTION_VARIABLES, VARIABLES, add_snapshots, history_of, skin_arc
from fingerpad.scenes.scene import Outline
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.pad import MeshSize, PadMesh
from fingerpad.stimuli.shapes import shape_from

DATA = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
OUTLINE, RIDGES, STROKES, PRESSED = (
    DATA[key] for key in ("outline", "ridges", "strokes", "pressed")
)
CURVATURE, KNOWN = DATA["surfaces"], {k: np.array(v) for k, v in DATA["known"].items()}
SURFACES = tuple(CURVATURE)
LABELS = {k: k if k == "flat" else f"k{k}" for k in SURFACES}
"""Surface -> the end of a scene's name."""
MM, INCH, GF = 1e-3, 25.4e-3, 9.80665e-3
DEPTHS = np.array([560, 600, 640, 765, 800, 845, 870, 915, 960]) * 1e-6
LOAD = 19.6133  # N/m
RIDGED = [f"ridged_40_{label}" for label in LABELS.values()]
"""Ramps and holds on a pad with ridges."""
PLATES = {
    f"{pad}_stroke_{way}": (pad, sign)
    for pad in ("plate", "ridged", "ridged_outer")
    for way, sign in (("right", 1), ("left", -1))
}
"""Strokes of a plate: the pad, and 1 to the right."""


@cache
def mesh(edge: float = 0.5e-3) -> PadMesh:
    """A coarse mesh of the thesis's section."""
    return build_pad_mesh(
        Outline(**OUTLINE), MeshSize(skin_edge=edge, fine_half_width=2e-3, layer_edge=edge)
    )


def meshes(names) -> dict[str, PadMesh]:
    """The same coarse mesh under every scene's name."""
    return dict.fromkeys(names, mesh())


def all_scenes() -> list[str]:
    """Names of the scenes of ramps and holds."""
    names = [f"{programme}_{k}" for programme in ("ramp40", "ramp150") for k in LABELS.values()]
    lower = [f"press{f}_{LABELS[k]}" for f in (10, 15) for k in ("flat", "79", "158", "315", "630")]
    return [*names, *lower, "homogeneous_flat"]


def histories(scale: float = 1.0, edge: float = 67e-6) -> dict[str, xr.Dataset]:
    """Every scene's made-up history; `scale` multiplies every result (a stand-in for a
    companion).
    """
    kinds = (history, all_scenes()), (pressed, PRESSED), (ridged, RIDGED), (plate_stroke, PLATES)
    return {
        name: make(name, scale, edge)
        for make, names in (*kinds, (stroke, STROKES))
        for name in names
    }


def companions(mesh: float = 1.01, both: float = 1.0125) -> dict[str, Companion]:
    """Companions of every scene that are so many times away."""
    first, second = histories(mesh), histories(both)
    return {name: Companion(first[name], second[name]) for name in first}


def _of(variables: dict[str, np.ndarray]) -> dict:
    """Variables of a history by their values alone: dimensions and units are those of simulated
    ones.
    """
    said = {
        name: dict(zip(("units", "long_name"), VARIABLES[name][1:], strict=True))
        for name in variables
    }
    return {name: (VARIABLES[name][0], values, said[name]) for name, values in variables.items()}


def _filled(data: xr.Dataset) -> xr.Dataset:
    """The history with every variable that simulated ones have: what is not made up is zero."""
    rubbed = bool(json.loads(data.attrs["scene"])["friction"])
    wanted = [name for name in VARIABLES if rubbed or name not in FRICTION_VARIABLES]
    sizes = {name: [data.sizes[dim] for dim in VARIABLES[name][0]] for name in wanted}
    missing = [name for name in wanted if name not in data]
    return data.assign(
        _of({name: np.full(sizes[name], float(name == "min_detF")) for name in missing})
    )


def _made(
    scene: dict, variables: dict[str, np.ndarray], time, skin, receptors=((), ())
) -> xr.Dataset:
    """A history of its values: times (nt,), skin nodes and receptors (depths, offsets) where they
    are.
    """
    x, y = skin
    places = {"skin_x": x, "skin_y": y, "skin_arc": skin_arc(x, y, _apex(x, y))}
    for name, where in zip(("receptor_depth", "receptor_offset"), receptors, strict=True):
        places[name] = np.array(where, float)
    attributes = {"title": f"made up: {scene['name']}", "scene": scene}
    return _filled(history_of(variables, {"time": time, **places}, attributes))


def _apex(x: np.ndarray, y: np.ndarray) -> int:
    return int(np.argmin(np.where(y > 0, abs(x), np.inf)))


def history(name: str, scale: float = 1.0, edge: float = 67e-6) -> xr.Dataset:
    """One made-up history that follows the dataset's contract."""
    programme, surface = name.split("_")
    label = surface.removeprefix("k")
    rate = 150 if programme == "ramp150" else 40
    ramp = 20 / rate
    time = np.concatenate((np.linspace(0, ramp, 21), ramp + np.geomspace(0.01, 2.0, 16)))
    leg = np.where(time <= ramp, 0, 1)
    load = np.minimum(time / ramp, 1.0)
    crept = 1 - np.exp(-np.maximum(time - ramp, 0) / 0.4)

    def at(what):
        return np.interp(np.sqrt(CURVATURE[label]), np.sqrt(KNOWN["curvature"]), KNOWN[what])

    depth = at("depth") * load**0.7 * (0.86 + 0.14 * crept)
    width = at("width") * load**0.55 * (0.9 + 0.1 * crept)
    skin_x, skin_y = _skin(edge)
    layered = programme != "homogeneous"
    pressure = np.array(
        [_pressure(skin_x, skin_y, LOAD * f, w, layered) for f, w in zip(load, width, strict=True)]
    )
    points = [(z, 0.0) for z in DEPTHS]
    if programme == "ramp150":
        offsets = np.round(np.arange(-5e-3, 5.01e-3, 0.25e-3), 9)
        points += [(z, o) for z in (800e-6, 915e-6) for o in offsets if o != 0]
    receptor_depth, receptor_offset = np.array(points).T
    surface_energy = np.interp(
        receptor_depth, (560e-6, 600e-6, 849e-6, 851e-6, 960e-6), (0.8, 1.0, 3.0, 1.1, 0.95)
    )
    shallow = receptor_depth < 850e-6
    peak = np.where(shallow, at("energy_600") * 0.5, at("energy_915")) * surface_energy
    peak = peak * np.exp(-((receptor_offset / (0.5 * at("width") + 0.8e-3)) ** 2))
    energy = np.outer(load**1.2 * (1 - 0.18 * crept), peak)
    network = np.outer(load**1.2 * (1 + 0.15 * crept), peak)

    bump = np.exp(-((skin_x / (0.6 * at("width") + 1e-3)) ** 2)) * (skin_y > 0)
    scaled = {
        "indentation_depth": depth,
        "contact_width": width,
        "centre_pressure": pressure[:, _apex(skin_x, skin_y)],
        "peak_pressure": pressure.max(axis=1),
        "contact_pressure": pressure,
        "contact_pressure_smoothed": pressure,
        "skin_displacement_x": np.outer(depth, 0.02 * np.sin(skin_x / 2e-3) * bump),
        "skin_displacement_y": -np.outer(depth, bump),
        "strain_energy_density": energy,
        "strain_energy_network": network,
        "strain_energy_recoverable": network * 1.05,
        "strain_energy_long_term_moduli": energy * 1.5,
        "strain_energy_half_stress_strain": (energy + network) / 2,
    }
    data = {"force": LOAD * load, "leg": leg}
    data |= {variable: scale * values for variable, values in scaled.items()}
    scene = _scene(name, label, rate)
    return _made(scene, data, time, (skin_x, skin_y), (receptor_depth, receptor_offset))


def pressed(name: str, scale: float = 1.0, edge: float = 67e-6) -> xr.Dataset:
    """A made-up press to depths: force as the square of depth, half of it relaxing, a smooth dent
    of the skin.
    """
    asked = PRESSED[name]
    targets, timed = asked["depths"], asked.get("timed")
    if "inch" in asked:
        stimulus = {"shape": "cylinder", "curvature": 2 / asked["inch"] / INCH}
    else:
        stimulus = {"shape": asked.get("shape", "flat")}
    if stimulus["shape"] == "bar":
        stimulus |= {"width": INCH / 16, "fillet": 0.1 * MM}
    if timed is None:
        ends = zip((0, *targets), targets, strict=False)
        depth = np.concatenate([[0.0], *(np.linspace(a, b, 5)[1:] for a, b in ends)])
        time = overstress = np.zeros(len(depth))
        leg = np.concatenate(([0], np.repeat(np.arange(len(targets)), 4)))
        motion = [{"press_to_depth": d * MM, "speed": None} for d in targets]
    else:
        speed, end = timed
        ramp = targets[0] / speed
        time = np.concatenate((np.linspace(0, ramp, 11), ramp + np.geomspace(0.01, end - ramp, 16)))
        depth, leg = np.minimum(time * speed, targets[0]), np.where(time <= ramp, 0, 1)
        overstress = 0.5 * np.exp(-np.maximum(time - ramp, 0) / 0.4)
        motion = [{"press_to_depth": targets[0] * MM, "speed": speed * MM}, {"hold": end - ramp}]
    depth = depth * MM
    skin_x, skin_y = _skin(edge)
    points = mesh().points

    def dent(x, y):
        return np.exp(-((x / 2e-3) ** 2)) * np.clip((y - 1e-3) / 5e-3, 0, 1)

    last = [np.flatnonzero(leg == k)[-1] for k in range(len(targets))]
    fields = np.zeros((len(last), *points.shape))
    fields[..., 1] = -scale * np.outer(depth[last], dent(*points.T))
    data = {
        "force": scale * 20 * (depth / MM) ** 2 * (1 + overstress),
        "indentation_depth": depth,
        "skin_displacement_y": -scale * np.outer(depth, dent(skin_x, skin_y)),
        "leg": leg,
    }
    scene = _scene(name, "flat", 40) | {"stimulus": stimulus, "motion": motion}
    made = _made(scene, data, time, (skin_x, skin_y))
    return _with_fields(made, time[last], fields, np.zeros((len(last), len(mesh().cells))))


def stroke(name: str, scale: float = 1.0, edge: float = 67e-6) -> xr.Dataset:
    """A made-up stroke: skin that lies on the surface, dragged along, pressed harder where it is
    more curved.
    """
    way, step, speed = STROKES[name]
    radii = np.array(DATA["radii"])[: 2 if "sub" in name else None] * MM
    wavy = {"half_angle": np.radians(9.0), **DATA["wavy"]}
    stimulus = {"shape": "wavy", "curvatures": (1 / radii).tolist(), **wavy}
    slid = np.arange(0, way + step / 2, step) * MM
    start = 4  # increments of every press
    if speed is None:
        d = np.repeat(slid, start)
        load = np.tile(np.linspace(0.25, 1, start), len(slid))
        time, drag = np.zeros(len(d)), np.zeros(len(d))
    else:
        d = np.concatenate([np.zeros(start), slid])
        load = np.minimum(np.arange(len(d)) / start, 1.0)
        time = np.concatenate([np.arange(start) / start * 0.5, 0.5 + slid / (speed * MM)])
        drag = MM * (1 - 0.04 * np.log(speed)) * (1 - np.exp(-d / (2 * MM)))
    shape = shape_from(stimulus)
    skin_x, skin_y = _skin(edge)
    upper = skin_y > 0
    centre = _apex(skin_x, skin_y)
    depth = 1.1 * MM * load + shape.outline(d)
    x = skin_x - np.outer(drag, upper)
    under = x + d[:, None]
    surface = (6 * MM - depth)[:, None] + np.array([shape.outline(row) for row in under])
    lost = abs(under - wavy["lead_in"]) < 0.4 * MM  # the sharp corner
    touches = upper & (skin_y > surface) & ~lost
    y = np.where(touches, surface, skin_y)
    bend = sum(
        np.where((under >= p.start) & (under < p.end), p.curvature, 0.0) for p in shape.segments
    )
    pressed = scale * touches * load[:, None] * np.maximum(3000 + 30 * bend, 300)
    pressure = pressed * np.sqrt(np.clip(1 - (x / (4 * MM)) ** 2, 0.01, 1))
    felt = np.convolve(np.pad(pressure[:, centre], 8, mode="edge"), np.ones(17) / 17, "valid")
    data = {
        "force": LOAD * load,
        "stroke_distance": d,
        "indentation_depth": depth,
        "centre_pressure": pressure[:, centre],
        "peak_pressure": pressure.max(axis=1),
        "contact_pressure": pressure,
        "centre_lateral_displacement": -scale * drag,
        "skin_displacement_x": x - skin_x,
        "skin_displacement_y": y - skin_y,
        "strain_energy_density": np.outer(felt, (0.02, 0.04)),
        "leg": (d > 0).astype(int),
    }
    scene = _scene(name, "flat", 40)
    press = {"press_to_force": scene["motion"][0]["press_to_force"], "rate": None}
    if speed is None:
        on, friction = {"step": way * MM, "every": MM}, 0.0
    else:
        on, friction = {"slide": way * MM, "speed": speed * MM, "keep": "force"}, 0.7
    scene |= {"stimulus": stimulus, "motion": [press, on], "friction": friction}
    made = _made(scene, data, time, (skin_x, skin_y), ((560e-6, 915e-6), (0.0, 0.0)))
    return _dragged(made, time[start::40]) if name == "stroke_10" else made


def _receptors(data: xr.Dataset, depths, offsets, values) -> xr.Dataset:
    """The dataset with other receptors; values (time, receptor)."""
    grid = [each.ravel() for each in np.meshgrid(depths, offsets, indexing="ij")]
    old = {name: data[name].attrs for name in ("receptor_depth", "receptor_offset")}
    data = data.drop_dims("receptor")
    places = {name: ("receptor", where, old[name]) for name, where in zip(old, grid, strict=True)}
    return _filled(data.assign_coords(places).assign(_of({"strain_energy_density": values(*grid)})))


def _with_ridges(data: xr.Dataset, name: str, ridges, **keys) -> xr.Dataset:
    scene = json.loads(data.attrs["scene"])
    scene |= {"name": name, "specimen": scene["specimen"] | {"ridges": ridges}} | keys
    return _filled(data.assign_attrs(scene=json.dumps(scene)))


def ridged(name: str, scale: float = 1.0, edge: float = 67e-6) -> xr.Dataset:
    """A made-up press of a pad with ridges: that of the plain pad, twice the energy at the centre
    and 1.3 times beside it.
    """
    plain = history("ramp40_" + name.rsplit("_", 1)[1], scale, edge)
    trace = plain.strain_energy_density.values[:, [int(abs(DEPTHS - 915e-6).argmin())]]
    sharp = 1.5 if name.endswith("1260") else 1.0

    def values(z, x):
        return sharp * trace * np.where(x == 0, 2.0, 1.3)

    return _with_ridges(_receptors(plain, [915e-6], [-46e-6, 0.0, 46e-6], values), name, RIDGES)


def plate_stroke(name: str, scale: float = 1.0, edge: float = 67e-6) -> xr.Dataset:
    """A made-up stroke of a plate: 200 Pa, with ridges three times as much on the side that the
    plate leaves.
    """
    pad, sign = PLATES[name]
    way = np.concatenate([np.zeros(5), np.arange(0.25, 50.1, 0.25)]) * MM
    number = np.arange(len(way))
    base = history("ramp40_flat", scale, edge).isel(time=np.minimum(number, 20))
    time = np.minimum(number * 0.125, 0.5) + way / (10 * MM)
    base = base.assign_coords(time=("time", time, base.time.attrs))
    load = np.minimum(number / 4, 1.0)
    own = {
        "stroke_distance": -sign * way,
        "leg": (way > 0).astype(int),
        "min_detF": np.full(len(way), 0.95),
        "force": load * LOAD,
    }
    base = base.assign(_of(own))
    slid = np.minimum(way / MM, 1.0)[:, None]

    def values(z, x):
        felt = -0.5 * sign * np.clip(x / 46e-6, -1, 1) * (pad != "plate")
        return scale * 200 * (1 + felt * slid) * load[:, None]

    offsets = np.round(np.array(sorted({*range(-240, 241, 20), -46, 46})) * 1e-6, 9)
    made = _receptors(base, [915e-6, 935e-6], offsets, values)
    if pad == "ridged_outer":
        bands = np.cos(2 * np.pi * made.skin_x.values / 0.48e-3) > 0
        made["contact_pressure"] = made.contact_pressure * bands
    ridges = {"plate": "none", "ridged": RIDGES, "ridged_outer": RIDGES | {"outer": DATA["outer"]}}
    slide = {"slide": -sign * 50 * MM, "speed": 10 * MM, "keep": "force"}
    motion = [json.loads(made.attrs["scene"])["motion"][0], slide]
    return _with_ridges(made, name, ridges[pad], motion=motion, friction=0.65)


def _with_fields(data: xr.Dataset, times, displacement, pressure) -> xr.Dataset:
    """The history with full fields: displacements (n, nodes, 2) m and mean stresses (n, elements)
    Pa at n times.
    """
    whole, body, indenter = data.copy(), mesh(), np.zeros((len(times), 2, 2))
    fields = {"displacement": displacement, "pressure": pressure, "indenter": indenter}
    add_snapshots(whole, times, body, fields)
    return whole


def _dragged(data: xr.Dataset, times: np.ndarray) -> xr.Dataset:
    """Full fields at some times: a pad dragged along, and pressed under the middle."""
    points, cells = mesh().points, mesh().cells
    moved = np.zeros((len(times), *points.shape))
    moved[..., 0] = -MM * np.clip(points[:, 1] / 6e-3, 0, 1)
    middle = points[cells].mean(axis=1)
    stress = -3000 * np.exp(-((middle[:, 0] / 3e-3) ** 2) - ((middle[:, 1] - 5e-3) / 3e-3) ** 2)
    return _with_fields(data, times, moved, np.tile(stress, (len(times), 1)))


def _skin(edge: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes along an ellipse-like section, left to right, one at the apex."""
    count = int(2.6 * 7.5e-3 / edge)
    angle = np.linspace(-2.6, 2.6, 2 * count + 1)
    x, y = 8.5e-3 * np.sin(angle), np.where(np.cos(angle) > 0, 6e-3, 6.2e-3) * np.cos(angle)
    x[count] = 0.0
    return x, y


def _pressure(x: np.ndarray, y: np.ndarray, load: float, width: float, layered: bool) -> np.ndarray:
    """A symmetric pressure (Pa) of resultant `load` over `width`, with twin peaks when it is
    wide.
    """
    if width <= 0:
        return np.zeros_like(x)
    half = width / 2
    inside = np.clip(1 - (x / half) ** 2, 0, None) ** 0.5 * (y > 0)
    excess = max(half - 0.5e-3, 0.0)
    if layered:
        twins = np.exp(-(((abs(x) - excess) / 0.35e-3) ** 2))
        inside = inside * (1 + 0.5 * min(1.0, excess / 1e-3) * twins)
    total = np.trapezoid(inside, x)
    if total > 0:
        return load * inside / total
    return np.where(abs(x) == 0, load / 67e-6, 0.0) * (y > 0)


def _scene(name: str, label: str, rate: float) -> dict:
    moduli = (0.15e6, 0.015e6, 0.015e6) if name != "homogeneous_flat" else (0.03e6,) * 3
    layers = {
        layer: {"youngs_modulus": e, "poisson_ratio": 0.48}
        for layer, e in zip(("epidermis", "dermis", "fat"), moduli, strict=True)
    }
    curved = {"shape": "cylinder", "curvature": CURVATURE[label]}
    return {
        "name": name,
        "specimen": {"outline": OUTLINE, "layers": layers, **DATA["specimen"]},
        "stimulus": {"shape": "flat"} if label == "flat" else curved,
        "friction": 0.0,
        "motion": [{"press_to_force": 20 * GF, "rate": rate * GF}, {"hold": 2.0}],
        "accuracy": "thesis",
    }
