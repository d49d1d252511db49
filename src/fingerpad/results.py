"""Results of a simulation: the labelled history, its summary, and its files.

A history is an :class:`xarray.Dataset` of the whole pad (a half model is unfolded before it gets
here) with units and long names on every variable and plan, scene, cost and provenance in its
attributes, so it plots itself in a notebook: ``simulate(scene).contact_width.plot()``.
"""

from __future__ import annotations

import json
import platform
import sys
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import KDTree

from fingerpad.files import disk_is_full, write_atomically, write_text
from fingerpad.processes import threads
from fingerpad.provenance import code_digest
from fingerpad.scenes.scene import Scene, recorded_scene
from fingerpad.specimen.element_kinds import kind_of
from fingerpad.stimuli.motion import NO_TIME

if TYPE_CHECKING:
    import xarray as xr

#: name -> (dimensions, unit, long name)
VARIABLES = {
    "force": (("time",), "N/m", "normal force per contact length, compression positive"),
    "tangential_force": (("time",), "N/m", "lateral force on the indenter per contact length"),
    "stroke_distance": (("time",), "m", "way of the pad's centre along the stimulus"),
    "indentation_depth": (("time",), "m", "indentation depth since first touch"),
    "contact_width": (("time",), "m", "contact width"),
    "touching_width": (("time",), "m", "touching width, the contact's without its gaps"),
    "centre_pressure": (("time",), "Pa", "contact pressure at the skin node at x = 0"),
    "peak_pressure": (("time",), "Pa", "largest nodal contact pressure"),
    "centre_lateral_displacement": (
        ("time",),
        "m",
        "lateral displacement of the skin node at x = 0",
    ),
    "contact_pressure": (("time", "skin_node"), "Pa", "contact pressure, nodal"),
    "contact_pressure_smoothed": (
        ("time", "skin_node"),
        "Pa",
        "contact pressure, 5-point average of force over length",
    ),
    "skin_displacement_x": (("time", "skin_node"), "m", "lateral displacement of the skin"),
    "skin_displacement_y": (("time", "skin_node"), "m", "vertical displacement of the skin"),
    "strain_energy_density": (
        ("time", "receptor"),
        "Pa",
        "strain energy density, total stress on instantaneous moduli",
    ),
    "strain_energy_long_term_moduli": (
        ("time", "receptor"),
        "Pa",
        "strain energy density, total stress on long-term moduli",
    ),
    "strain_energy_half_stress_strain": (
        ("time", "receptor"),
        "Pa",
        "strain energy density, half of total stress times strain",
    ),
    "strain_energy_recoverable": (
        ("time", "receptor"),
        "Pa",
        "strain energy density of network and Maxwell springs",
    ),
    "strain_energy_network": (
        ("time", "receptor"),
        "Pa",
        "strain energy density of the long-term network",
    ),
    "compressive_strain": (
        ("time", "receptor"),
        "1",
        "largest compressive principal strain, 1 - stretch",
    ),
    "tensile_strain": (("time", "receptor"), "1", "largest tensile principal strain, stretch - 1"),
    "von_mises_stress": (("time", "receptor"), "Pa", "von Mises stress, Cauchy"),
    "hydrostatic_pressure": (
        ("time", "receptor"),
        "Pa",
        "mean compressive stress, volumetric part",
    ),
    "dilatation": (("time", "receptor"), "1", "relative change of volume, det F - 1"),
    "leg": (("time",), "1", "leg of the motion programme"),
    "interpolated": (("time",), "1", "1 between two states that were found, 0 where one was"),
    "newton_iterations": (("time",), "1", "Newton iterations of the step"),
    "cutbacks": (("time",), "1", "halvings of the step"),
    "residual": (("time",), "1", "out-of-balance force over contact force"),
    "complementarity_error": (
        ("time",),
        "1",
        "sum of force times gap over total force times node spacing",
    ),
    "energy_balance_error": (("time",), "1", "work less stored and dissipated energy, over work"),
    "min_detF": (("time",), "1", "smallest det F of the body"),
    "external_work": (("time",), "J/m", "work of the indenter per contact length"),
    "stored_energy": (("time",), "J/m", "network and Maxwell-spring energy per contact length"),
    "dissipated_energy": (("time",), "J/m", "viscous dissipation per contact length"),
    "frictional_dissipation": (("time",), "J/m", "frictional dissipation per contact length"),
    "tangential_traction": (
        ("time", "skin_node"),
        "Pa",
        "frictional traction on the skin along the contact's tangent",
    ),
    "slip": (("time", "skin_node"), "m", "way of the skin node over the stimulus in the step"),
    "contact_state": (("time", "skin_node"), "1", "0 no contact, 1 sticks, 2 slips"),
}
#: those that exist only in a history with friction
FRICTION_VARIABLES = ("tangential_traction", "slip", "contact_state")
COORDINATES = {
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
#: what a full field holds beside displacement and mean stress: name -> (unit in files, in vtu
#: files, factor, long name)
ENERGIES = [name for name in VARIABLES if name.startswith("strain_energy")]
FIELDS = {
    **{name: ("Pa", "Pa", 1.0, VARIABLES[name][2]) for name in ENERGIES},
    "principal_strains": ("1", "1", 1.0, "principal stretches in the plane less one, rising"),
    "cauchy_stress": ("Pa", "kPa", 1e-3, "Cauchy stress xx, yy, xy, zz"),
    "von_mises_stress": ("Pa", "kPa", 1e-3, VARIABLES["von_mises_stress"][2]),
}
#: of a leg's entry in a summary with more receptors than this, the energies are in the history only
MOST_RECEPTORS = 100


@dataclass
class Variable:
    """One array of a history, the names of its dimensions, and what is said of it."""

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.dims = (self.dims,) if isinstance(self.dims, str) else tuple(self.dims)
        self.values = np.asarray(self.values)


@dataclass
class Arrays:
    """A history as a run makes it, and as it is written: importing xarray takes as long as half of
    a small run.

    Attributes:
        variables, coordinates: by name. attrs: plan, scene, cost and provenance.
    """

    variables: dict[str, Variable]
    coordinates: dict[str, Variable]
    attrs: dict[str, Any]

    @classmethod
    def of(cls, history: xr.Dataset | Arrays) -> Arrays:
        """The arrays of a labelled history."""
        if isinstance(history, cls):
            return history
        parts = (
            {str(k): Variable(v.dims, v.values, v.attrs) for k, v in part.items()}
            for part in (history.data_vars, history.coords)
        )
        return cls(*parts, history.attrs)

    def __getitem__(self, name: str) -> Variable:
        return self.variables[name] if name in self.variables else self.coordinates[name]

    def __contains__(self, name: str) -> bool:
        return name in self.variables or name in self.coordinates

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension."""
        parts = (*self.variables.values(), *self.coordinates.values())
        return {
            name: size
            for part in parts
            for name, size in zip(part.dims, part.values.shape, strict=True)
        }

    def labelled(self) -> xr.Dataset:
        """The history as what everybody else works with."""
        import xarray as xr

        parts = (
            {k: (v.dims, v.values, v.attrs) for k, v in part.items()}
            for part in (self.variables, self.coordinates)
        )
        return _indexed(xr.Dataset(*parts, self.attrs))


def arrays(
    variables: dict[str, np.ndarray], coordinates: dict[str, np.ndarray], attributes: dict[str, Any]
) -> Arrays:
    """A history from arrays named as in :data:`VARIABLES` and :data:`COORDINATES`; dict attributes
    become JSON.
    """
    made = (
        {
            name: Variable(
                known[name][0], values, {"units": known[name][1], "long_name": known[name][2]}
            )
            for name, values in given.items()
        }
        for known, given in ((VARIABLES, variables), (COORDINATES, coordinates))
    )
    return Arrays(
        *made,
        {
            k: json.dumps(v, sort_keys=True) if isinstance(v, (dict, list)) else v
            for k, v in attributes.items()
        },
    )


def _indexed(history: xr.Dataset) -> xr.Dataset:
    """The history with its skin indexed by the way along it, which grows where x turns back under
    the pad.
    """
    return history.set_xindex("skin_arc") if "skin_arc" in history.coords else history


def skin_arc(x: np.ndarray, y: np.ndarray, apex: int) -> np.ndarray:
    """Way (ns,) m along the chain of skin nodes at x, y (ns,) m, zero at the node ``apex`` and
    growing from left to right.
    """
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    return way - way[apex]


def add_snapshots(
    history: Arrays,
    times,
    points,
    cells,
    region,
    displacement,
    pressure,
    regions,
    indenter=None,
    fields=None,
) -> None:
    """Add full fields: ``snapshot_displacement`` (snapshot, node, 2) m and ``snapshot_pressure``
    (snapshot, element) Pa.

    Of the layers ``regions`` the numbers ``region`` (element,) are indices. ``indenter`` (snapshot,
    n, 2) m, outlines of the stimulus. ``fields``: more of the elements (snapshot, element[,
    components]), named as in :data:`FIELDS`.
    """
    layers = ", ".join(f"{number} {name}" for number, name in enumerate(regions))
    found = {
        "snapshot_time": ("snapshot", np.asarray(times, float), "s", "time of the full field"),
        "node_position": (("node", "axis"), points, "m", "undeformed node position"),
        "element_nodes": (("element", "element_node"), cells, "1", "nodes of each element"),
        "element_region": ("element", region, "1", layers),
        "snapshot_displacement": (("snapshot", "node", "axis"), displacement, "m", "displacement"),
        "snapshot_pressure": (
            ("snapshot", "element"),
            pressure,
            "Pa",
            "mean stress kappa (J - 1), element mean",
        ),
    }
    if indenter is not None:
        found["snapshot_indenter"] = (
            ("snapshot", "outline_point", "axis"),
            indenter,
            "m",
            "outline of the stimulus",
        )
    for name, values in (fields or {}).items():
        dims = ("snapshot", "element", *((f"component_of_{name}",) if values.ndim == 3 else ()))
        found[f"snapshot_{name}"] = (
            dims,
            values,
            FIELDS[name][0],
            f"{FIELDS[name][3]}, middle of the element",
        )
    for name, (dims, values, units, what) in found.items():
        history.variables[name] = Variable(dims, values, {"units": units, "long_name": what})


@lru_cache(maxsize=1)
def provenance() -> dict[str, Any]:
    """What produced a result: code digest, package versions, machine and threads."""
    from importlib.metadata import PackageNotFoundError, version

    packages = {}
    for name in (
        "fingerpad",
        "numpy",
        "scipy",
        "numba",
        "scikit-fem",
        "gmsh",
        "meshio",
        "mkl",
        "xarray",
    ):
        try:
            packages[name] = version(name)
        except PackageNotFoundError:
            packages[name] = "absent"
    return {
        "code_sha256": code_digest()[:16],
        "python": platform.python_version(),
        "packages": packages,
        "machine": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "threads": threads(),
    }


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
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1024


def scene_of(history: xr.Dataset) -> Scene:
    """The scene a history was simulated from: its models know the profile, the outline and the
    schedule.

    An external mesh is known by its name only. Asked for again, the same scene is not read again.
    """
    return _scene(history.attrs["scene"])


@lru_cache(maxsize=256)
def _scene(text: str) -> Scene:
    return recorded_scene(json.loads(text))


def leg_ends(history: xr.Dataset) -> xr.Dataset:
    """The history at the last output of each leg."""
    leg = history.leg.values[1:]
    return history.isel(time=1 + np.flatnonzero(np.append(leg[1:] != leg[:-1], True)))


def states_found(history: xr.Dataset | Arrays) -> int:
    """How many states of a history were found by steps; its other outputs lie between them."""
    return int(np.sum(history["interpolated"].values == 0)) - 1


def summary(history: xr.Dataset | Arrays) -> dict[str, Any]:
    """The summary of a history: the state at the end of each leg, and what the run took.

    Energies are lists, one entry a receptor point, and once more in ``receptors`` with the place of
    each; of more than
    :data:`MOST_RECEPTORS` points ``receptors`` says that they are in the history.
    """
    history = Arrays.of(history)
    attributes, leg_of = history.attrs, history["leg"].values
    numbers = np.unique(leg_of[1:])
    errors = json.loads(attributes.get("estimated_error_of_legs", "[]")) or [
        float(attributes["estimated_error"])
    ] * len(numbers)
    cost, length = (
        json.loads(history.attrs["cost"]),
        json.loads(history.attrs["scene"])["specimen"]["contact_length"],
    )
    places = [
        {"depth_mm": round(depth * 1e3, 9), "offset_mm": round(offset * 1e3, 9)}
        for depth, offset in zip(
            history["receptor_depth"].values.tolist(),
            history["receptor_offset"].values.tolist(),
            strict=True,
        )
    ]
    legs = []
    places_of = json.loads(attributes.get("unbounded_at_of_legs", "[]")) or [""] * len(numbers)
    for leg, error, unbounded in zip(numbers, errors, places_of, strict=True):
        end = int(np.flatnonzero(leg_of == leg)[-1])

        def at_end(name: str, end: int = end) -> float:
            return float(history[name].values[end])

        force = at_end("force")
        entry = {
            "time_s": round(at_end("time"), 9),
            "estimated_error": error,
            "depth_mm": at_end("indentation_depth") * 1e3,
            "force_N_per_m": force,
            "force_N": force * length,
            "force_gf": force * length / 9.80665e-3,
            "tangential_force_N_per_m": at_end("tangential_force"),
            "contact_width_mm": at_end("contact_width") * 1e3,
            "touching_width_mm": at_end(
                "touching_width" if "touching_width" in history else "contact_width"
            )
            * 1e3,
            "peak_pressure_Pa": at_end("peak_pressure"),
            "peak_pressure_unbounded_at": unbounded,
            "centre_pressure_Pa": at_end("centre_pressure"),
            "centre_lateral_displacement_mm": at_end("centre_lateral_displacement") * 1e3,
            "stroke_distance_mm": at_end("stroke_distance") * 1e3,
        }
        if len(places) > MOST_RECEPTORS:
            entry["receptors"] = (
                f"{len(places)} receptor points: their strain energies are in the history"
            )
        else:
            energies = {_energy_key(name): history[name].values[end].tolist() for name in ENERGIES}
            each = [
                dict(zip(energies, values, strict=True))
                for values in zip(*energies.values(), strict=True)
            ]
            entry |= energies
            entry["receptors"] = [
                place | values for place, values in zip(places, each, strict=True)
            ]
        legs.append(entry)
    run = {
        "steps": states_found(history),
        "newton_iterations": int(history["newton_iterations"].values.sum()),
        "cutbacks": int(history["cutbacks"].values.sum()),
        "energy_balance_error": float(history["energy_balance_error"].values[-1]),
        "complementarity_error": float(history["complementarity_error"].values.max()),
        "min_detF": float(history["min_detF"].values.min()),
        "estimated_error": float(attributes["estimated_error"]),
        "largest_error": float(attributes.get("largest_error", attributes["estimated_error"])),
        "error_covers": attributes.get("error_covers", ""),
        "peak_pressure_singular": bool(attributes.get("singular")),
        "peak_pressure_unbounded_at": attributes.get("unbounded_at", ""),
    } | cost
    asked = float(attributes.get("asked_error", np.nan))
    if np.isfinite(asked):
        missed = attributes["tolerance"]
        run |= {"asked_error": asked, "tolerance_met": not missed, "tolerance_missed": missed}
        run["runs"] = json.loads(attributes["runs"])
    how, notes = (
        json.loads(history.attrs.get(name, empty))
        for name, empty in (("plan", "{}"), ("notes", "[]"))
    )
    run |= {
        key: value
        for key, value in how.get("discretisation", {}).items()
        if key.startswith("profile_")
    }
    if notes:
        run |= {
            "contact_reached_profile_end": any("reached the end" in note for note in notes),
            "notes": notes,
        }
    totals = {"legs": legs, "run": run}
    if "impulse_rate" in history:
        totals["responses"] = _responses(history, places)
    return totals


def _responses(history: Arrays, places: list[dict[str, float]]) -> list[dict[str, Any]] | str:
    """What each receptor sends: how many impulses, the highest rate, and when the first impulse
    comes (None: never).
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


def write_history(history: xr.Dataset | Arrays, path: str | Path) -> None:
    """Write a history as NetCDF 4, whole or not at all, as xarray would.

    Raises:
        OSError: it cannot be written, on a full disk for example.
    """
    history = Arrays.of(history)

    def write(partial: Path) -> None:
        try:
            _write_netcdf(history, partial)
        except RuntimeError as error:  # what netCDF makes of an error of the disk
            raise disk_is_full(partial.parent) or OSError(f"{error}") from error

    write_atomically(path, write)


def _write_netcdf(history: Arrays, path: Path) -> None:
    import netCDF4

    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        for name, size in history.sizes.items():
            file.createDimension(name, size)
        file.setncatts(history.attrs)
        beside = {
            name: set(each.dims)
            for name, each in history.coordinates.items()
            if each.dims != (name,)
        }
        made = {}
        for name, each in (history.variables | history.coordinates).items():
            text = each.values.dtype.kind in "UO"
            packed = (
                "zlib" if each.values.ndim > 1 and not text and _mostly_zero(each.values) else None
            )
            fill = np.nan if each.values.dtype.kind == "f" else None
            kind = str if text else each.values.dtype
            made[name] = file.createVariable(
                name, kind, each.dims, packed, complevel=4, fill_value=fill
            )
            made[name].setncatts(each.attrs)
            if (
                name in history.variables
            ):  # the convention of the CF metadata, by which xarray tells coordinates
                belong = sorted(other for other, dims in beside.items() if dims <= set(each.dims))
                if belong:
                    made[name].setncattr("coordinates", " ".join(belong))
        # all after all, as a file is laid out anew at each change from the one to the other: a
        # third of the time
        for name, each in (history.variables | history.coordinates).items():
            made[name][...] = (
                each.values.astype(object) if each.values.dtype.kind in "UO" else each.values
            )


def _mostly_zero(values: np.ndarray) -> bool:
    """Is it worth packing? What is solved for has digits to the last: packed it takes four times
    the time, a fifth less room.
    """
    return np.count_nonzero(values) < values.size / 2


class ResultError(ValueError):
    """A file is no result of this package, or but a part of one; the message names it."""


def read_dataset(path: str | Path, holds: tuple[str, ...] = ()) -> xr.Dataset:
    """Read a result into memory, which must hold some variables.

    Raises:
        ResultError: the file is cut off, of another kind, or lacks them. FileNotFoundError: there
        is none.
    """
    try:
        found = _loaded(path)
    except (FileNotFoundError, PermissionError):
        raise
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        why = " ".join(str(error).split())
        raise ResultError(
            f"{path}: cut off, or no NetCDF file; remove it and run again ({why})"
        ) from None
    for name in holds:
        if name not in found.variables:
            raise ResultError(
                f"{path}: holds no {name}, so is no result of this kind; remove it and run again"
            )
    return found


def _loaded(path: str | Path) -> xr.Dataset:
    """All of a file at once: xarray's own way opens a variable at a time, and looks for all its
    backends first.
    """
    import netCDF4
    import xarray as xr

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        found = xr.Dataset(
            {
                name: (each.dimensions, each[...], each.__dict__)
                for name, each in file.variables.items()
            },
            None,
            file.__dict__,
        )
    return xr.decode_cf(found).load()


def read_history(path: str | Path) -> xr.Dataset:
    """Read a history written by :func:`write_history`, or the one in the folder of a run, into
    memory.

    Raises as :func:`read_dataset`.
    """
    path = Path(path) / "history.nc" if Path(path).is_dir() else path
    return _indexed(read_dataset(path, ("time", "leg", "force", "indentation_depth")))


def write_vtu(history: xr.Dataset | Arrays, directory: str | Path) -> list[Path]:
    """Write each full field of a history for ParaView; returns the paths of the pad's, none without
    full fields.

    ``snapshot_<k>.vtu`` is the pad (undeformed, mm) with displacement (mm), contact pressure and
    traction on its skin (kPa) at nodes; layer, mean stress and whatever else the history holds of
    :data:`FIELDS` in elements. ``indenter_<k>.vtu`` is the outline of the stimulus.
    ``snapshots.pvd`` opens all of them as one film, ``snapshots.vtu.series`` the pad alone.
    """
    if "snapshot_time" not in history:
        return []
    import meshio

    history = history.labelled() if isinstance(history, Arrays) else history
    directory, nodes = Path(directory), history.sizes["node"]
    kind = kind_of(history.sizes["element_node"]).meshio
    position, region = history.node_position.values, history.element_region
    skin = KDTree(position).query(np.column_stack([history.skin_x, history.skin_y]))[1]
    times = history.snapshot_time.values.tolist()
    paths, parts = [], []
    for k, time in enumerate(times):
        now = history.isel(snapshot=k)
        state = history.isel(
            time=int(
                np.flatnonzero(np.isclose(history.time.values, time, rtol=1e-9, atol=NO_TIME / 2))[
                    -1
                ]
            )
        )
        on_skin = {"contact pressure (kPa)": state.contact_pressure}
        if "tangential_traction" in state:
            on_skin["frictional traction (kPa)"] = state.tangential_traction
        point_data = {"displacement (mm)": _in_space(now.snapshot_displacement.values * 1e3)}
        for name, values in on_skin.items():
            point_data[name] = np.zeros(nodes)
            point_data[name][skin] = values.values * 1e-3
        cell_data = {
            "mean stress (kPa)": now.snapshot_pressure.values * 1e-3,
            "layer": region.values.astype(np.int32),
        }
        cell_data[f"layer ({region.attrs['long_name']})"] = cell_data["layer"]
        for name, (_, unit, factor, _) in FIELDS.items():
            if f"snapshot_{name}" in now:
                cell_data |= _named(name, unit, factor * now[f"snapshot_{name}"].values)
        blocks = {name: [values] for name, values in cell_data.items()}
        field = meshio.Mesh(
            _in_space(position * 1e3), [(kind, history.element_nodes.values)], point_data, blocks
        )
        paths.append(directory / f"snapshot_{k}.vtu")
        made = {paths[-1].name: field}
        if "snapshot_indenter" in now:
            outline = now.snapshot_indenter.values
            outline = outline[np.isfinite(outline).all(1)] * 1e3
            line = np.column_stack([np.arange(len(outline) - 1), np.arange(1, len(outline))])
            made[f"indenter_{k}.vtu"] = meshio.Mesh(_in_space(outline), [("line", line)])
        for part, (name, mesh) in enumerate(made.items()):
            write_atomically(
                directory / name, lambda partial, mesh=mesh: mesh.write(partial, file_format="vtu")
            )
            parts.append(f'<DataSet timestep="{time!r}" part="{part}" file="{name}"/>')
    film = "\n".join(
        [
            '<VTKFile type="Collection" version="0.1"><Collection>',
            *parts,
            "</Collection></VTKFile>\n",
        ]
    )
    write_text(directory / "snapshots.pvd", film)
    frames = [{"name": path.name, "time": time} for path, time in zip(paths, times, strict=True)]
    series = {"file-series-version": "1.0", "files": frames}
    write_text(directory / "snapshots.vtu.series", json.dumps(series, indent=1) + "\n")
    return paths


def _in_space(plane: np.ndarray) -> np.ndarray:
    return np.column_stack([plane, np.zeros(len(plane))])


def _named(name: str, unit: str, values: np.ndarray) -> dict[str, np.ndarray]:
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
