"""The results that figures and tables are made from, opened when first looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from cysyk1999.measures.energy_of_1999 import as_of_1999
from cysyk1999.measures.errors import Companion
from fingerpad.measures.kept import LazyMapping
from fingerpad.results import read_dataset
from fingerpad.specimen.files import read_pad_mesh


def _opened(read: Callable[[Path], Any], paths: Iterable[Path]) -> LazyMapping:
    """Scene name -> what its file holds; each file is opened once, and only if asked for."""
    files = {path.parent.name: path for path in paths}
    return LazyMapping(lambda scene: read(files[scene]), files)


def read_results(
    paths: Iterable[str | Path], of_1999: bool = False
) -> tuple[Mapping, Mapping, Mapping]:
    """Sort result files of the workflow, ``.../<simulations, coarse or
    coarse_mesh>/<scene>/<history.nc or mesh.msh>``.

    Parameters
    ----------
    paths
        The files.
    of_1999
        Whether histories have the strain energy density of 1999 (:mod:`energy_of_1999`).

    Returns
    -------
    tuple[Mapping, Mapping, Mapping]
        Mappings scene name -> result: the histories (`xarray.Dataset`), the meshes (`PadMesh`), and
        the companions on coarser meshes (:class:`cysyk1999.measures.errors.Companion`), whose files
        are both needed when one is looked at.
    """
    kinds: dict[str, list[Path]] = {"coarse": [], "coarse_mesh": [], "own": [], "mesh": []}
    for path in map(Path, paths):
        kind = "mesh" if path.suffix == ".msh" else path.parent.parent.name
        kinds[kind if kind in kinds else "own"].append(path)
    read = _read_as_of_1999 if of_1999 else read_dataset
    mesh, both = (_opened(read, kinds[kind]) for kind in ("coarse_mesh", "coarse"))
    return (
        _opened(read, kinds["own"]),
        _opened(read_pad_mesh, kinds["mesh"]),
        LazyMapping(lambda scene: Companion(mesh[scene], both[scene]), both),
    )


def _read_as_of_1999(path: Path) -> xr.Dataset:
    return as_of_1999(read_dataset(path))


def read_coarse(paths: Iterable[str | Path], of_1999: bool = False) -> Mapping[str, xr.Dataset]:
    """Histories of the companions with coarser meshes and steps, by scene, of those among some
    files of the workflow.
    """
    of_coarse = (path for path in map(Path, paths) if path.parent.parent.name == "coarse")
    return _opened(_read_as_of_1999 if of_1999 else read_dataset, of_coarse)
