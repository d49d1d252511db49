"""Results of a simulation: the labelled history, its summary, and its files.

A history is an :class:`xarray.Dataset` of the whole pad, also where half of it was solved. Every
variable has its unit and long name. Plan, scene, cost and provenance are in the attributes, and
the accessor ``history.fingerpad`` reads them.
"""

from __future__ import annotations

import json
import platform
import resource
import sys
import warnings
from collections.abc import Mapping
from functools import lru_cache, partial
from importlib.metadata import PackageNotFoundError, version
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import meshio
import numpy as np
import xarray as xr
from scipy.spatial import KDTree

from fingerpad.files import disk_is_full, write_atomically, write_text
from fingerpad.planning.plan_data import Plan
from fingerpad.processes import threads
from fingerpad.provenance import BESIDE_A_RUN, code_digest
from fingerpad.revolved import revolved
from fingerpad.scenes.scene import Scene, recorded_scene
from fingerpad.specimen.element_kinds import kind_of
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.motion import NO_TIME

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_OF_TIME = {
    "force": ("N/m", "normal force per contact length, compression positive"),
    "tangential_force": ("N/m", "lateral force on the indenter per contact length"),
    "stroke_distance": ("m", "way of the pad's centre along the stimulus"),
    "indentation_depth": ("m", "indentation depth since first touch"),
    "contact_width": ("m", "contact width"),
    "touching_width": ("m", "touching width, the contact's without its gaps"),
    "centre_pressure": ("Pa", "contact pressure at the skin node at x = 0"),
    "peak_pressure": ("Pa", "largest nodal contact pressure"),
    "centre_lateral_displacement": ("m", "lateral displacement of the skin node at x = 0"),
    "leg": ("1", "leg of the motion programme"),
    "interpolated": ("1", "1 between two states that were found, 0 where one was"),
    "newton_iterations": ("1", "Newton iterations of the step"),
    "cutbacks": ("1", "halvings of the step"),
    "residual": ("1", "out-of-balance force over contact force"),
    "complementarity_error": ("1", "sum of force times gap over total force times node spacing"),
    "energy_balance_error": ("1", "work less stored and dissipated energy, over work"),
    "min_detF": ("1", "smallest det F of the body"),
    "external_work": ("J/m", "work of the indenter per contact length"),
    "stored_energy": ("J/m", "network and Maxwell-spring energy per contact length"),
    "dissipated_energy": ("J/m", "viscous dissipation per contact length"),
    "frictional_dissipation": ("J/m", "frictional dissipation per contact length"),
}
_OF_SKIN = {
    "contact_pressure": ("Pa", "contact pressure, nodal"),
    "contact_pressure_smoothed": ("Pa", "contact pressure, 5-point average of force over length"),
    "skin_displacement_x": ("m", "lateral displacement of the skin"),
    "skin_displacement_y": ("m", "vertical displacement of the skin"),
    "tangential_traction": ("Pa", "frictional traction on the skin along the contact's tangent"),
    "slip": ("m", "way of the skin node over the stimulus in the step"),
    "contact_state": ("1", "0 no contact, 1 sticks, 2 slips"),
}
_OF_RECEPTORS = {
    "strain_energy_density": ("Pa", "strain energy density, total stress on instantaneous moduli"),
    "strain_energy_long_term_moduli": (
        "Pa",
        "strain energy density, total stress on long-term moduli",
    ),
    "strain_energy_half_stress_strain": (
        "Pa",
        "strain energy density, half of total stress times strain",
    ),
    "strain_energy_recoverable": ("Pa", "strain energy density of network and Maxwell springs"),
    "strain_energy_network": ("Pa", "strain energy density of the long-term network"),
    "compressive_strain": ("1", "largest compressive principal strain, 1 - stretch"),
    "tensile_strain": ("1", "largest tensile principal strain, stretch - 1"),
    "von_mises_stress": ("Pa", "von Mises stress, Cauchy"),
    "hydrostatic_pressure": ("Pa", "mean compressive stress, volumetric part"),
    "dilatation": ("1", "relative change of volume, det F - 1"),
}
OF_REVOLUTION = {
    "contact_radius": ("time", "m", "contact radius"),
    "contact_area": ("time", "m^2", "contact area, of the circle less its gaps"),
}
"""Name -> (dimension, unit, long name) of what only a history of a body of revolution has."""
VARIABLES: dict[str, tuple[Any, str, str]] = {
    name: (dims, *about)
    for dims, group in (
        (("time",), _OF_TIME),
        (("time", "skin_node"), _OF_SKIN),
        (("time", "receptor"), _OF_RECEPTORS),
    )
    for name, about in group.items()
}
"""Name -> (dimensions, unit, long name) of every variable of a history."""
FRICTION_VARIABLES = ("tangential_traction", "slip", "contact_state")
"""Those that only a history with friction has."""
COORDINATES: dict[str, tuple[Any, str, str]] = {
    "time": ("time", "s", "time"),
    "receptor_depth": ("receptor", "m", "receptor depth below the undeformed skin"),
    "receptor_offset": ("receptor", "m", "lateral receptor position, undeformed"),
    "skin_x": ("skin_node", "m", "lateral position of the skin node, undeformed"),
    "skin_y": ("skin_node", "m", "height of the skin node, undeformed"),
    "skin_arc": (
        "skin_node",
        "m",
        "way along the undeformed skin from the apex, positive to the right",
    ),
}
ENERGIES = [name for name in VARIABLES if name.startswith("strain_energy")]
FIELDS = {
    **{name: ("Pa", "Pa", 1.0, VARIABLES[name][2]) for name in ENERGIES},
    "principal_strains": ("1", "1", 1.0, "principal stretches in the plane less one, rising"),
    "cauchy_stress": ("Pa", "kPa", 1e-3, "Cauchy stress xx, yy, xy, zz"),
    "von_mises_stress": ("Pa", "kPa", 1e-3, VARIABLES["von_mises_stress"][2]),
}
"""What a full field has beside displacement and mean stress: name -> (unit in histories, unit in
vtu files, factor, long name).
"""
MOST_RECEPTORS = 100
"""A summary with more receptors has no strain energies of them."""
_PACKAGES = (
    "fingerpad",
    "numpy",
    "scipy",
    "numba",
    "scikit-fem",
    "gmsh",
    "meshio",
    "mkl",
    "xarray",
)


def history_of(
    variables: Mapping[str, np.ndarray],
    coordinates: Mapping[str, np.ndarray],
    attributes: Mapping[str, Any],
) -> xr.Dataset:
    """A history from its arrays.

    Parameters
    ----------
    variables, coordinates
        Arrays by name, of the dimensions in :data:`VARIABLES` and :data:`COORDINATES`.
    attributes
        Of the history; dictionaries and lists are kept as JSON.
    """
    known = VARIABLES
    if "contact_radius" in variables:
        known = {name: _whole(*about) for name, about in (VARIABLES | OF_REVOLUTION).items()}
    data, places = (
        {name: _labelled(*known[name], values) for name, values in arrays.items()}
        for known, arrays in ((known, variables), (COORDINATES, coordinates))
    )
    texts = {
        name: json.dumps(value, sort_keys=True) if isinstance(value, (dict, list)) else value
        for name, value in attributes.items()
    }
    return _indexed(xr.Dataset(data, places, texts))


def _whole(dims: Any, unit: str, long_name: str) -> tuple[Any, str, str]:
    """What is said of a variable of a body of revolution: forces and energies are of all of it."""
    unit = {"N/m": "N", "J/m": "J"}.get(unit, unit)
    return (
        dims,
        unit,
        long_name.replace(" per contact length", "").replace("over length", "over area"),
    )


def _labelled(dims: Any, unit: str, long_name: str, values: Any) -> tuple:
    """What xarray makes a variable of."""
    return dims, values, {"units": unit, "long_name": long_name}


def _indexed(history: xr.Dataset) -> xr.Dataset:
    """The history with its skin indexed by arc length; x turns back under the pad."""
    return history.set_xindex("skin_arc") if "skin_arc" in history.coords else history


def skin_arc(x: np.ndarray, y: np.ndarray, apex: int) -> np.ndarray:
    """Way (ns,) m along the chain of skin nodes at x, y (ns,) m, zero at the node ``apex`` and
    growing from left to right.
    """
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    return way - way[apex]


def add_snapshots(
    history: xr.Dataset,
    times: list[float] | np.ndarray,
    mesh: PadMesh,
    fields: Mapping[str, np.ndarray],
) -> None:
    """Add full fields to a history, in place.

    Parameters
    ----------
    times : (snapshot,) s
    mesh
        The whole pad.
    fields
        ``displacement`` (snapshot, node, 2) m, ``pressure`` (snapshot, element) Pa, ``indenter``
        (snapshot, n, 2) m, the outline of the stimulus, and any of :data:`FIELDS` (snapshot,
        element[, components]).
    """
    of_elements, position = ("snapshot", "element"), "undeformed node position"
    layers = ", ".join(f"{number} {name}" for number, name in enumerate(mesh.regions))
    known: dict[str, tuple[tuple[str, ...], str, str]] = {
        "displacement": (("snapshot", "node", "axis"), "m", "displacement"),
        "pressure": (of_elements, "Pa", "mean stress kappa (J - 1), element mean"),
        "indenter": (("snapshot", "outline_point", "axis"), "m", "outline of the stimulus"),
    }
    for name, (unit, _, _, long_name) in FIELDS.items():
        of_field = (*of_elements, f"component_of_{name}")
        known[name] = of_field, unit, f"{long_name}, middle of the element"
    new: dict[str, tuple] = {
        "snapshot_time": ("snapshot", "s", "time of the full field", np.asarray(times, float)),
        "node_position": (("node", "axis"), "m", position, mesh.points),
        "element_nodes": (("element", "element_node"), "1", "nodes of each element", mesh.cells),
        "element_region": ("element", "1", layers, mesh.region),
    }
    for name, values in fields.items():
        dims, *about = known[name]
        new[f"snapshot_{name}"] = (dims[: values.ndim], *about, values)
    history.update({name: _labelled(*about) for name, about in new.items()})


@lru_cache(maxsize=1)
def provenance() -> dict[str, Any]:
    """What produced a result: code digest, package versions, machine and threads."""
    return {
        "code_sha256": code_digest(without=BESIDE_A_RUN)[:16],
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in _PACKAGES},
        "machine": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "threads": threads(),
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"


def peak_memory_MB() -> float:
    """Largest resident memory of this process so far, MB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1024


def scene_of(history: xr.Dataset) -> Scene:
    """The scene that a history was simulated from, with its profile, outline and schedule.

    Of an external mesh only the name is known. The scene of a text is read once.
    """
    return _scene(of_a_run(history, "scene"))


@lru_cache(maxsize=256)
def _scene(text: str) -> Scene:
    return recorded_scene(json.loads(text))


def leg_ends(history: xr.Dataset) -> xr.Dataset:
    """The history at the last output of each leg."""
    leg = history.leg.values[1:]
    return history.isel(time=1 + np.flatnonzero(np.append(leg[1:] != leg[:-1], True)))


def of_a_run(history: xr.Dataset, name: str) -> str:
    """An attribute that only a run knows. Raises AttributeError if an emulator made the history."""
    try:
        return history.attrs[name]
    except KeyError:
        title = history.attrs.get("title", "this dataset")
        raise AttributeError(
            f"{title}: has no {name.replace('_', ' ')}; allowed: a history of fingerpad.simulate"
        ) from None


def states_found(history: xr.Dataset) -> int:
    """How many states of a history were found by steps; its other outputs lie between them."""
    return int(np.sum(history["interpolated"].values == 0)) - 1


def summary(history: xr.Dataset) -> dict[str, Any]:
    """The summary of a history: the state at the end of each leg, and what the run took.

    Parameters
    ----------
    history
        As :func:`fingerpad.simulate` returns it.

    Returns
    -------
    dict
        ``legs``: one entry a leg. Strain energies are lists over the receptors, and once more in
        ``receptors`` with the place of each; of more than :data:`MOST_RECEPTORS` receptors they are
        in the history only. ``run``: iterations, errors, notes and cost. ``responses``: impulses of
        each receptor, where the history has them.
    """
    places = [
        {"depth_mm": round(1e3 * depth, 9), "offset_mm": round(1e3 * offset, 9)}
        for depth, offset in zip(
            history["receptor_depth"].values.tolist(),
            history["receptor_offset"].values.tolist(),
            strict=True,
        )
    ]
    ends = leg_ends(history)
    errors, unbounded = (
        json.loads(of_a_run(history, f"{name}_of_legs"))
        for name in ("estimated_error", "unbounded_at")
    )
    totals = {
        "legs": [
            _leg(ends.isel(time=k), error, where, places)
            for k, (error, where) in enumerate(zip(errors, unbounded, strict=True))
        ],
        "run": _run(history),
    }
    if "impulse_rate" in history:
        totals["responses"] = _responses(history, places)
    return totals


def _leg(
    end: xr.Dataset, error: float, unbounded: str, places: list[dict[str, float]]
) -> dict[str, Any]:
    """The entry of a leg in the summary, from the history at its end."""

    def at_end(name: str, factor: float = 1.0) -> float:
        return float(end[name]) * factor

    force_N = at_end("force", scene_of(end).specimen.contact_length)
    entry = {
        "time_s": round(at_end("time"), 9),
        "estimated_error": error,
        "depth_mm": at_end("indentation_depth", 1e3),
        "force_N_per_m": at_end("force"),
        "force_N": force_N,
        "force_gf": force_N / 9.80665e-3,
        "tangential_force_N_per_m": at_end("tangential_force"),
        "contact_width_mm": at_end("contact_width", 1e3),
        "touching_width_mm": at_end("touching_width", 1e3),
        "peak_pressure_Pa": at_end("peak_pressure"),
        "peak_pressure_unbounded_at": unbounded,
        "centre_pressure_Pa": at_end("centre_pressure"),
        "centre_lateral_displacement_mm": at_end("centre_lateral_displacement", 1e3),
        "stroke_distance_mm": at_end("stroke_distance", 1e3),
    }
    if "contact_radius" in end:
        entry = {name: value for name, value in entry.items() if not name.endswith("N_per_m")}
        entry |= {
            "contact_radius_mm": at_end("contact_radius", 1e3),
            "contact_area_mm2": at_end("contact_area", 1e6),
        }
    if len(places) > MOST_RECEPTORS:
        said = f"{len(places)} receptor points: their strain energies are in the history"
        return entry | {"receptors": said}
    energies = {_energy_key(name): end[name].values.tolist() for name in ENERGIES}
    of_receptors = [
        place | dict(zip(energies, values, strict=True))
        for place, values in zip(places, zip(*energies.values(), strict=True), strict=True)
    ]
    return entry | energies | {"receptors": of_receptors}


def _run(history: xr.Dataset) -> dict[str, Any]:
    """The entry of the whole run in the summary."""
    attributes = history.attrs
    cost, plan, notes = (json.loads(attributes[name]) for name in ("cost", "plan", "notes"))
    out = {
        "steps": states_found(history),
        "newton_iterations": int(history["newton_iterations"].sum()),
        "cutbacks": int(history["cutbacks"].sum()),
        "energy_balance_error": float(history["energy_balance_error"][-1]),
        "complementarity_error": float(history["complementarity_error"].max()),
        "min_detF": float(history["min_detF"].min()),
        "estimated_error": float(attributes["estimated_error"]),
        "largest_error": float(attributes["largest_error"]),
        "error_covers": attributes["error_covers"],
        "peak_pressure_singular": bool(attributes["singular"]),
        "peak_pressure_unbounded_at": attributes["unbounded_at"],
    } | cost
    if np.isfinite(attributes.get("asked_error", np.nan)):
        out |= {
            "asked_error": float(attributes["asked_error"]),
            "tolerance_met": not attributes["tolerance"],
            "tolerance_missed": attributes["tolerance"],
            "runs": json.loads(attributes["runs"]),
        }
    if "relaxed" in attributes:
        out["relaxed"] = json.loads(attributes["relaxed"])
    discretisation = plan["discretisation"].items()
    out |= {name: value for name, value in discretisation if name.startswith("profile_")}
    if any("reached the end" in note for note in notes):
        out["contact_reached_profile_end"] = True
    if "doubts" in attributes:
        out["doubts"] = json.loads(attributes["doubts"])
    return out | {"notes": notes}


def _responses(history: xr.Dataset, places: list[dict[str, float]]) -> list[dict[str, Any]] | str:
    """Of each receptor: how many impulses, the highest rate, and when the first impulse comes
    (None: never).
    """
    if len(places) > MOST_RECEPTORS:
        return f"{len(places)} receptor points: their impulses are in the history"
    rates, counts, times = (
        history[name].values for name in ("impulse_rate", "impulses", "impulse_time")
    )
    out = []
    for kind, afferent in enumerate(history["afferent"].values.tolist()):
        for number, place in enumerate(places):
            count = int(counts[kind, number])
            sent = {"impulses": count, "peak_rate_per_s": float(rates[kind, :, number].max())}
            first = float(times[kind, number, 0]) if count else None
            out.append({"afferent": afferent} | place | sent | {"first_impulse_s": first})
    return out


def _energy_key(name: str) -> str:
    return "strain_energy_Pa" if name == "strain_energy_density" else f"{name}_Pa"


def write_history(history: xr.Dataset, path: str | Path) -> None:
    """Write a history as NetCDF 4, whole or not at all.

    Raises
    ------
    OSError
        It cannot be written, for example on a full disk.
    """
    packed = {
        str(name): {"zlib": True, "complevel": 4}
        for name, variable in history.data_vars.items()
        if variable.ndim > 1 and variable.dtype.kind not in "UO" and _mostly_zero(variable.values)
    }
    write_atomically(path, partial(write_dataset, history.drop_encoding(), packed))


def write_dataset(data: xr.Dataset, encoding: Mapping[str, Any], path: Path) -> None:
    """Write a NetCDF 4 file; what the library makes of an error of the disk is an OSError."""
    try:
        data.to_netcdf(path, engine="netcdf4", encoding=encoding)
    except RuntimeError as error:
        raise disk_is_full(path.parent) or OSError(f"{error}") from error


def _mostly_zero(values: np.ndarray) -> bool:
    """Whether packing is worth its time: solved values have digits to the last, and packed they
    take a fifth less room and four times the time.
    """
    return bool(np.count_nonzero(values) < values.size / 2)


class ResultError(ValueError):
    """A file is no result of this package, or only a part of one; the message names it."""


def read_dataset(path: str | Path, holds: tuple[str, ...] = ()) -> xr.Dataset:
    """Read a result into memory.

    Parameters
    ----------
    path
        A NetCDF file.
    holds
        Variables that it must have.

    Raises
    ------
    ResultError
        The file is cut off, of another kind, or lacks a variable.
    FileNotFoundError
        There is none.
    """
    try:
        data = xr.load_dataset(path, engine="netcdf4")
    except (FileNotFoundError, PermissionError):
        raise
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        why = " ".join(str(error).split())
        raise ResultError(
            f"{path}: cut off, or no NetCDF file; remove it and run again ({why})"
        ) from None
    for name in holds:
        if name not in data.variables:
            raise ResultError(
                f"{path}: holds no {name}, so is no result of this kind; remove it and run again"
            )
    return data


def read_history(path: str | Path) -> xr.Dataset:
    """Read a history into memory.

    Parameters
    ----------
    path
        A file written by :func:`write_history`, or the folder of a run.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    ResultError
        The file is cut off, or is no history.
    FileNotFoundError
        There is none.
    """
    path = Path(path) / "history.nc" if Path(path).is_dir() else path
    return _indexed(read_dataset(path, ("time", "leg", "force", "indentation_depth")))


def write_vtu(history: xr.Dataset, directory: str | Path, slices: int = 0) -> list[Path]:
    """Write each full field of a history for ParaView.

    ``snapshot_<k>.vtu`` is the pad (undeformed, mm) with displacement (mm), contact pressure and
    traction on its skin (kPa) at nodes; layer, mean stress and what else the history holds of
    :data:`FIELDS` in elements. ``indenter_<k>.vtu`` is the outline of the stimulus.
    ``snapshots.pvd`` opens all of them as one film, ``snapshots.vtu.series`` the pad alone.

    Parameters
    ----------
    slices
        Of a body of revolution: turned by half a turn in so many cells; 0 is its section.

    Returns
    -------
    list of Path
        The files of the pad; none where the history has no full fields.
    """
    if "snapshot_time" not in history:
        return []
    directory = Path(directory)
    times = history.snapshot_time.values.tolist()
    paths, parts = [], []
    for k, time in enumerate(times):
        meshes = {f"snapshot_{k}.vtu": _pad_mesh(history, k, time)}
        paths.append(directory / f"snapshot_{k}.vtu")
        if "snapshot_indenter" in history:
            outline = history.snapshot_indenter.values[k]
            outline = outline[np.isfinite(outline).all(1)] * 1e3
            line = np.column_stack([np.arange(len(outline) - 1), np.arange(1, len(outline))])
            meshes[f"indenter_{k}.vtu"] = meshio.Mesh(_in_space(outline), [("line", line)])
        for part, (name, mesh) in enumerate(meshes.items()):
            mesh = revolved(mesh, slices) if slices else mesh
            write_atomically(directory / name, partial(mesh.write, file_format="vtu"))
            parts.append(f'<DataSet timestep="{time!r}" part="{part}" file="{name}"/>')
    opening = '<VTKFile type="Collection" version="0.1"><Collection>'
    film = "\n".join([opening, *parts, "</Collection></VTKFile>\n"])
    write_text(directory / "snapshots.pvd", film)
    frames = [{"name": path.name, "time": time} for path, time in zip(paths, times, strict=True)]
    series = {"file-series-version": "1.0", "files": frames}
    write_text(directory / "snapshots.vtu.series", json.dumps(series, indent=1) + "\n")
    return paths


def _pad_mesh(history: xr.Dataset, k: int, time: float) -> meshio.Mesh:
    """The pad of a snapshot (``k``, at ``time`` s) with what is known at its nodes and in its
    elements.
    """
    now, position = history.isel(snapshot=k), history.node_position.values
    outputs = np.isclose(history.time.values, time, rtol=1e-9, atol=NO_TIME / 2)
    state = history.isel(time=int(np.flatnonzero(outputs)[-1]))
    skin = KDTree(position).query(np.column_stack([history.skin_x, history.skin_y]))[1]
    point_data = {"displacement (mm)": _in_space(now.snapshot_displacement.values * 1e3)}
    on_skin = {"contact pressure": "contact_pressure", "frictional traction": "tangential_traction"}
    for label, name in on_skin.items():
        if name in state:
            values = np.zeros(len(position))
            values[skin] = state[name].values * 1e-3
            point_data[f"{label} (kPa)"] = values
    region = history.element_region
    layer = region.values.astype(np.int32)
    cell_data = {
        "mean stress (kPa)": now.snapshot_pressure.values * 1e-3,
        "layer": layer,
        f"layer ({region.attrs['long_name']})": layer,
    }
    for name, (_, unit, factor, _) in FIELDS.items():
        if f"snapshot_{name}" in now:
            cell_data |= _field_arrays(name, unit, factor * now[f"snapshot_{name}"].values)
    cells = [(kind_of(history.sizes["element_node"]).meshio, history.element_nodes.values)]
    of_blocks = {name: [values] for name, values in cell_data.items()}
    return meshio.Mesh(_in_space(position * 1e3), cells, point_data, of_blocks)


def _in_space(plane: np.ndarray) -> np.ndarray:
    return np.column_stack([plane, np.zeros(len(plane))])


def _field_arrays(name: str, unit: str, values: np.ndarray) -> dict[str, np.ndarray]:
    """The arrays of a field as ParaView shows them: scalars by their name, a tensor with its nine
    components.
    """
    label = name.replace("_", " ")
    if name == "cauchy_stress":
        xx, yy, xy, zz = values.T
        zero = np.zeros_like(xx)
        return {f"{label} ({unit})": np.column_stack([xx, xy, zero, xy, yy, zero, zero, zero, zz])}
    if name == "principal_strains":
        return {
            f"smallest principal strain ({unit})": values[:, 0],
            f"largest principal strain ({unit})": values[:, 1],
        }
    return {f"{label} ({unit})": values}


@xr.register_dataset_accessor("fingerpad")
class HistoryAccessor:
    """``history.fingerpad``: what a history knows of its plan, scene, force, errors and
    receptors.
    """

    def __init__(self, history: xr.Dataset) -> None:
        self._history = history

    @property
    def plan(self) -> Plan:
        """The plan of the run; of its last run, where a tolerance took several."""
        return Plan.from_dict(json.loads(of_a_run(self._history, "plan")))

    @property
    def scene(self) -> Scene:
        """The scene; see :func:`scene_of`."""
        return scene_of(self._history)

    @property
    def force_N(self) -> xr.DataArray:
        """Normal force (time) in N, of the scene's contact length."""
        force = self._history["force"] * self.scene.specimen.contact_length
        return force.assign_attrs(units="N", long_name="normal force, compression positive")

    @property
    def errors(self) -> dict[str, Any]:
        """Relative errors that the run estimates of itself.

        Returns
        -------
        dict
            ``legs``: at the end of each leg; ``largest``: of any step; ``covers``: the quantities;
            ``asked``: the tolerance, None where there is none.
        """
        attributes = self._history.attrs
        asked = float(attributes.get("asked_error", np.nan))
        return {
            "legs": json.loads(of_a_run(self._history, "estimated_error_of_legs")),
            "largest": float(attributes["largest_error"]),
            "covers": attributes["error_covers"],
            "asked": asked if np.isfinite(asked) else None,
        }

    def __repr__(self) -> str:
        sizes = ", ".join(f"{size} {name}" for name, size in self._history.sizes.items())
        has = "plan, scene, force_N, errors, sel(depth, offset), plot()"
        return f"<fingerpad accessor ({sizes}): {has}>"

    def plot(self) -> Figure:
        """The picture of the history, in mm, kPa and s: the section with the indenter, pressure on
        the skin at the end of each leg, strain energy density at the receptors, their impulses.

        Returns
        -------
        matplotlib.figure.Figure
            183 mm wide; ``figure.savefig("touch.pdf")`` writes it. Of many legs or receptors four
            are shown.

        Raises
        ------
        ImportError
            matplotlib is not installed.

        Examples
        --------
        >>> from fingerpad import simulate
        >>> history = simulate({
        ...     "stimulus": {"shape": "cylinder", "curvature": "400 1/m"},
        ...     "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "1 s"}],
        ...     "accuracy": "draft",
        ... })
        >>> figure = history.fingerpad.plot()
        >>> [ax.get_ylabel() for ax in figure.axes[:3]]
        ['y (mm)', 'contact pressure (kPa)', 'strain energy density (kPa)']
        """
        from fingerpad.picture import draw_history  # only who looks at it rests on how it looks

        return draw_history(self._history, self.scene.stimulus)

    def receptor(self, depth: float, offset: float = 0.0) -> xr.Dataset:
        """The old name of :meth:`sel`; it goes with the next version."""
        warnings.warn("history.fingerpad.receptor is now sel", DeprecationWarning, stacklevel=2)
        return self.sel(depth, offset)

    def sel(self, depth: float, offset: float = 0.0) -> xr.Dataset:
        """The history at one receptor; for several: ``history.sel(receptor=[0, 1])``.

        Parameters
        ----------
        depth, offset
            One number each, in m: below the undeformed skin and to the right of its middle.

        Raises
        ------
        KeyError
            There is no receptor within 1 um of that place.
        TypeError
            One of them is not a number.
        """
        for name, value in {"depth": depth, "offset": offset}.items():
            if not isinstance(value, Real):
                raise TypeError(f"{name}: {value!r} is not a number; allowed: one number, in m")
        return self._history.isel(receptor=receptor_index(self._history, depth, offset))


def receptor_index(history: xr.Dataset, depth: float, offset: float = 0.0) -> int:
    """Index of the receptor at a depth and offset (m). Raises KeyError if there is none."""
    depths, offsets = (history.variables[f"receptor_{name}"].values for name in ("depth", "offset"))
    miss = np.hypot(depths - depth, offsets - offset)
    if not len(miss) or miss.min() > 1e-6:
        known = ", ".join(f"{d * 1e6:g} um" for d in np.unique(depths))
        place = f"depth {depth * 1e6:g} um, offset {offset * 1e3:g} mm"
        raise KeyError(f"no receptor at {place}; there are depths of {known or 'none'}")
    return int(miss.argmin())
