"""The tables that rest on all results, by name: what is made of the measures table, and what of the
meshes.
"""

from __future__ import annotations

from collections.abc import Callable

import pandas as pd

from cysyk1999.claims.comparison import thesis_comparison
from cysyk1999.claims.sensitivity import sensitivity

TABLES: dict[str, Callable[..., pd.DataFrame]] = {
    "thesis_comparison": thesis_comparison,
    "sensitivity": sensitivity,
}
"""Table name -> function(measures, what tells their errors, reference_csv)."""
