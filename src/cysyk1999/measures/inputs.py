"""The results that figures and tables are made from, opened when first looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from cysyk1999.measures.errors import Companion
from fingerpad.measures.kept import Each
from fingerpad.results import read_dataset


class _Opened(Each):
    """Scene name -> what `opener` makes of its file; each file is opened once, and only if asked
    for.
    """

    def __init__(self, opener: Callable[[Path], Any], paths: Iterable[Path]) -> None:
        files = {path.parent.name: path for path in paths}
        super().__init__(lambda scene: opener(files[scene]), files)


def read_results(paths: Iterable[str | Path]) -> tuple[Mapping, Mapping, Mapping]:
    """Sort result files of the workflow, ``.../<simulations, coarse or
    coarse_mesh>/<scene>/<history.nc or mesh.msh>``.

    Returns
    -------
    tuple[Mapping, Mapping, Mapping]
        Mappings scene name -> result: the histories (`xarray.Dataset`), the meshes (`PadMesh`), and
        the companions on coarser meshes (:class:`cysyk1999.measures.errors.Companion`), whose files
        are both needed when one is looked at.
    """
    files = [Path(path) for path in paths]
    kinds: dict[str, list[Path]] = {"coarse": [], "coarse_mesh": [], "simulations": []}
    for path in files:
        if path.suffix == ".nc":
            kinds.get(path.parent.parent.name, kinds["simulations"]).append(path)
    mesh, both = (_Opened(read_dataset, kinds[kind]) for kind in ("coarse_mesh", "coarse"))
    return (
        _Opened(read_dataset, kinds["simulations"]),
        _Opened(_read_mesh, (path for path in files if path.suffix == ".msh")),
        Each(lambda scene: Companion(mesh[scene], both[scene]), both),
    )


def read_coarse(paths: Iterable[str | Path]) -> Mapping[str, xr.Dataset]:
    """Histories of the companions with coarser meshes and steps, by scene, of those among some
    files of the workflow.
    """
    return _Opened(
        read_dataset, (path for path in map(Path, paths) if path.parent.parent.name == "coarse")
    )


def _read_mesh(path: Path) -> Any:
    from fingerpad.specimen.files import read_pad_mesh

    return read_pad_mesh(path)
