"""Tables made of all the results."""

from __future__ import annotations

import os
from collections.abc import Callable

import pandas as pd

from fingerpad.claims.comparison import thesis_comparison
from fingerpad.claims.sensitivity import sensitivity
from fingerpad.measures.features import Histories, Meshes
from fingerpad.specimen.quality import quality_table


def mesh_quality(histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | os.PathLike) -> pd.DataFrame:
    """Quality of every scene's mesh: nodes, elements, smallest edge, worst scaled Jacobian."""
    return quality_table(meshes)


TABLES: dict[str, Callable[..., pd.DataFrame]] = {
    "thesis_comparison": thesis_comparison,
    "sensitivity": sensitivity,
    "mesh_quality": mesh_quality,
}
"""Table name -> function(histories, coarse, meshes, reference_csv)."""
