"""The results that figures and tables are made from, opened when first looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import xarray as xr


class _Opened(Mapping):
    """Scene name -> what `opener` makes of its file; each file is opened once, and only if asked for."""

    def __init__(self, opener: Callable[[Path], Any], paths: Iterable[Path]) -> None:
        self._opener = opener
        self._paths = {path.parent.name: path for path in paths}
        self._opened: dict[str, Any] = {}

    def __getitem__(self, scene: str) -> Any:
        if scene not in self._opened:
            self._opened[scene] = self._opener(self._paths[scene])
        return self._opened[scene]

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)


def read_results(paths: Iterable[str | Path]) -> tuple[Mapping, Mapping, Mapping]:
    """Sort result files of the workflow, ``.../<simulations or coarse>/<scene>/<history.nc or mesh.msh>``.

    Returns:
        Mappings scene name -> result: the histories (`xarray.Dataset`), the meshes (`PadMesh`), and the
        histories of the coarser companions.
    """
    files = [Path(path) for path in paths]
    histories = [path for path in files if path.suffix == ".nc"]
    coarse = [path for path in histories if path.parent.parent.name == "coarse"]
    return (
        _Opened(xr.load_dataset, (path for path in histories if path not in coarse)),
        _Opened(_read_mesh, (path for path in files if path.suffix == ".msh")),
        _Opened(xr.load_dataset, coarse),
    )


def _read_mesh(path: Path) -> Any:
    from fingerpad.specimen.files import read_pad_mesh

    return read_pad_mesh(path)
