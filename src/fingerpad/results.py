"""Results of a simulation: the labelled history, its summary, and its files.

A history is an :class:`xarray.Dataset` of the whole pad (a half model is unfolded before it gets here) with units and long
names on every variable and plan, scene, cost and provenance in its attributes, so it plots itself in a notebook:
``simulate(scene).contact_width.plot()``.
"""

from __future__ import annotations

import json
import os
import platform
import sys
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.files import write_atomically, write_text
from fingerpad.provenance import digest, imported_sources
from fingerpad.scenes.scene import Scene, recorded_scene

#: name -> (dimensions, unit, long name)
VARIABLES = {
    "force": (("time",), "N/m", "normal force per contact length, compression positive"),
    "tangential_force": (("time",), "N/m", "lateral force on the indenter per contact length"),
    "stroke_distance": (("time",), "m", "way of the pad's centre along the stimulus"),
    "indentation_depth": (("time",), "m", "indentation depth since first touch"),
    "contact_width": (("time",), "m", "contact width"),
    "centre_pressure": (("time",), "Pa", "contact pressure at the skin node at x = 0"),
    "peak_pressure": (("time",), "Pa", "largest nodal contact pressure"),
    "centre_lateral_displacement": (("time",), "m", "lateral displacement of the skin node at x = 0"),
    "contact_pressure": (("time", "skin_node"), "Pa", "contact pressure, nodal"),
    "contact_pressure_smoothed": (("time", "skin_node"), "Pa", "contact pressure, 5-point average of force over length"),
    "skin_displacement_x": (("time", "skin_node"), "m", "lateral displacement of the skin"),
    "skin_displacement_y": (("time", "skin_node"), "m", "vertical displacement of the skin"),
    "strain_energy_density": (("time", "receptor"), "Pa", "strain energy density, total stress on instantaneous moduli"),
    "strain_energy_long_term_moduli": (("time", "receptor"), "Pa", "strain energy density, total stress on long-term moduli"),
    "strain_energy_half_stress_strain": (("time", "receptor"), "Pa", "strain energy density, half of total stress times strain"),
    "strain_energy_recoverable": (("time", "receptor"), "Pa", "strain energy density of network and Maxwell springs"),
    "strain_energy_network": (("time", "receptor"), "Pa", "strain energy density of the long-term network"),
    "compressive_strain": (("time", "receptor"), "1", "largest compressive principal strain, 1 - stretch"),
    "tensile_strain": (("time", "receptor"), "1", "largest tensile principal strain, stretch - 1"),
    "von_mises_stress": (("time", "receptor"), "Pa", "von Mises stress, Cauchy"),
    "hydrostatic_pressure": (("time", "receptor"), "Pa", "mean compressive stress, volumetric part"),
    "dilatation": (("time", "receptor"), "1", "relative change of volume, det F - 1"),
    "leg": (("time",), "1", "leg of the motion programme"),
    "newton_iterations": (("time",), "1", "Newton iterations of the step"),
    "cutbacks": (("time",), "1", "halvings of the step"),
    "residual": (("time",), "1", "out-of-balance force over contact force"),
    "complementarity_error": (("time",), "1", "sum of force times gap over total force times node spacing"),
    "energy_balance_error": (("time",), "1", "work less stored and dissipated energy, over work (trapezoidal in time)"),
    "min_detF": (("time",), "1", "smallest det F of the body"),
    "external_work": (("time",), "J/m", "work of the indenter per contact length"),
    "stored_energy": (("time",), "J/m", "network and Maxwell-spring energy per contact length"),
    "dissipated_energy": (("time",), "J/m", "viscous dissipation per contact length"),
    "frictional_dissipation": (("time",), "J/m", "frictional dissipation per contact length"),
    "tangential_traction": (("time", "skin_node"), "Pa", "frictional traction on the skin along the contact's tangent"),
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
}


def dataset(variables: dict[str, np.ndarray], coordinates: dict[str, np.ndarray], attributes: dict[str, Any]) -> xr.Dataset:
    """A history from arrays named as in :data:`VARIABLES` and :data:`COORDINATES`; dict attributes become JSON."""
    data = {
        name: (VARIABLES[name][0], values, {"units": VARIABLES[name][1], "long_name": VARIABLES[name][2]})
        for name, values in variables.items()
    }
    coords = {
        name: (COORDINATES[name][0], values, {"units": COORDINATES[name][1], "long_name": COORDINATES[name][2]})
        for name, values in coordinates.items()
    }
    attrs = {k: json.dumps(v, sort_keys=True) if isinstance(v, (dict, list)) else v for k, v in attributes.items()}
    return xr.Dataset(data, coords, attrs)


def add_snapshots(history: xr.Dataset, times, points, cells, region, displacement, pressure, regions) -> xr.Dataset:
    """Add full fields: ``snapshot_displacement`` (snapshot, node, 2) m and ``snapshot_pressure`` (snapshot, element) Pa.

    Of the layers ``regions`` the numbers ``region`` (element,) are indices.
    """
    layers = ", ".join(f"{number} {name}" for number, name in enumerate(regions))
    return history.assign(
        snapshot_time=("snapshot", np.asarray(times, float), {"units": "s", "long_name": "time of the full field"}),
        node_position=(("node", "axis"), points, {"units": "m", "long_name": "undeformed node position"}),
        element_nodes=(("element", "element_node"), cells, {"units": "1", "long_name": "nodes of each element"}),
        element_region=(("element",), region, {"units": "1", "long_name": layers}),
        snapshot_displacement=(("snapshot", "node", "axis"), displacement, {"units": "m", "long_name": "displacement"}),
        snapshot_pressure=(
            ("snapshot", "element"), pressure, {"units": "Pa", "long_name": "mean stress kappa (J - 1), element mean"},
        ),
    )  # fmt: skip


def provenance() -> dict[str, Any]:
    """What produced a result: code digest, package versions, machine and threads."""
    packages = {}
    for name in ("fingerpad", "numpy", "scipy", "numba", "scikit-fem", "gmsh", "meshio", "mkl", "pypardiso", "xarray"):
        try:
            packages[name] = version(name)
        except PackageNotFoundError:
            packages[name] = "absent"
    return {
        "code_sha256": digest(imported_sources("fingerpad.simulation"))[:16],
        "python": platform.python_version(),
        "packages": packages,
        "machine": f"{platform.system()} {platform.machine()}",
        "processor": _processor(),
        "threads": int(os.environ.get("OMP_NUM_THREADS", "1")),
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
    """The scene a history was simulated from: its models know the profile, the outline and the schedule.

    An external mesh is known by its name only. Asked for again, the same scene is not read again.
    """
    return _scene(history.attrs["scene"])


@lru_cache(maxsize=256)
def _scene(text: str) -> Scene:
    return recorded_scene(json.loads(text))


def summary(history: xr.Dataset) -> dict[str, Any]:
    """The summary of a history: the state at the end of each leg, and what the run took."""
    cost = json.loads(history.attrs["cost"])
    legs = []
    for leg in np.unique(history.leg.values[1:]):
        end = history.isel(time=int(np.flatnonzero(history.leg.values == leg)[-1]))
        legs.append(
            {
                "time_s": float(end.time),
                "depth_mm": float(end.indentation_depth) * 1e3,
                "force_N_per_m": float(end.force),
                "tangential_force_N_per_m": float(end.tangential_force),
                "contact_width_mm": float(end.contact_width) * 1e3,
                "peak_pressure_Pa": float(end.peak_pressure),
                "centre_pressure_Pa": float(end.centre_pressure),
                "centre_lateral_displacement_mm": float(end.centre_lateral_displacement) * 1e3,
                "stroke_distance_mm": float(end.stroke_distance) * 1e3,
                "strain_energy_Pa": end.strain_energy_density.values.tolist(),
                "strain_energy_network_Pa": end.strain_energy_network.values.tolist(),
                "strain_energy_recoverable_Pa": end.strain_energy_recoverable.values.tolist(),
                "strain_energy_long_term_moduli_Pa": end.strain_energy_long_term_moduli.values.tolist(),
                "strain_energy_half_stress_strain_Pa": end.strain_energy_half_stress_strain.values.tolist(),
            }
        )
    run = {
        "steps": int(history.sizes["time"] - 1),
        "newton_iterations": int(history.newton_iterations.sum()),
        "cutbacks": int(history.cutbacks.sum()),
        "energy_balance_error": float(history.energy_balance_error[-1]),
        "complementarity_error": float(history.complementarity_error.max()),
        "min_detF": float(history.min_detF.min()),
        "estimated_error": float(history.attrs["estimated_error"]),
    } | cost
    if history.attrs.get("singular"):
        run["peak_pressure_singular"] = True
    return {"legs": legs, "run": run}


def write_history(history: xr.Dataset, path: str | Path) -> None:
    """Write a history as NetCDF 4, whole or not at all."""
    encoding = {name: {"zlib": True, "complevel": 4} for name, values in history.data_vars.items() if values.ndim > 1}
    write_atomically(path, lambda partial: history.to_netcdf(partial, engine="netcdf4", encoding=encoding))


def read_history(path: str | Path) -> xr.Dataset:
    """Read a history written by :func:`write_history`, into memory."""
    return xr.load_dataset(path, engine="netcdf4")


def write_vtu(history: xr.Dataset, mesh, directory: str | Path) -> list[Path]:
    """Write each snapshot as ``snapshot_<k>.vtu`` (mm, mm, kPa) for ParaView; returns the paths, none without snapshots.

    Beside them ``snapshots.vtu.series``, which ParaView opens as one film with its times.
    """
    if "snapshot_time" not in history:
        return []
    import meshio

    kind = {4: "quad", 9: "quad9", 6: "triangle6", 7: "triangle7", 3: "triangle"}[history.sizes["element_node"]]
    points = np.column_stack([history.node_position.values * 1e3, np.zeros(history.sizes["node"])])
    paths = []
    for k in range(history.sizes["snapshot"]):
        moved = np.column_stack([history.snapshot_displacement.values[k] * 1e3, np.zeros(history.sizes["node"])])
        field = meshio.Mesh(
            points,
            [(kind, history.element_nodes.values)],
            point_data={"displacement (mm)": moved},
            cell_data={
                "mean stress (kPa)": [history.snapshot_pressure.values[k] * 1e-3],
                "layer": [history.element_region.values.astype(np.int32)],
            },
        )
        path = Path(directory) / f"snapshot_{k}.vtu"
        write_atomically(path, lambda partial, field=field: field.write(partial, file_format="vtu"))
        paths.append(path)
    frames = [{"name": path.name, "time": float(t)} for path, t in zip(paths, history.snapshot_time.values, strict=True)]
    series = {"file-series-version": "1.0", "files": frames}
    write_text(Path(directory) / "snapshots.vtu.series", json.dumps(series, indent=1) + "\n")
    return paths
