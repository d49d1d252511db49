"""Recorded, published and other models' impulse rates: files that this model is compared with.

All have the columns of :data:`RATES`. ``config/reference/impulse_rates`` holds published ones; what
a user puts into ``config/reference/recordings`` joins them everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from cysyk1999.reference_data import (
    NOT_NEGATIVE,
    POSITIVE,
    TEXT,
    ReferenceDataError,
    one_of,
    read_table,
)

STIMULI = ("flat plate", "cylinder", "sphere", "wavy surface")
WINDOWS = ("peak", "hold", "steady", "first second", "first 200 ms", "burst")
"""Part of the response a rate is of: the largest instantaneous one; means from the top of the ramp
to the end of the hold, late in the hold, over the first second and the first 200 ms from the onset;
mean while a convexity of a stroked surface passes.
"""

RATES = {
    "recording": TEXT,
    "receptor": one_of("SA-I", "RA"),
    "species": one_of("human", "monkey", "model"),
    "stimulus": one_of(*STIMULI),
    "curvature_per_m": NOT_NEGATIVE,
    "or_curvature_per_m": NOT_NEGATIVE.or_nothing,
    "force_gf": POSITIVE,
    "ramp_gf_per_s": POSITIVE.or_nothing,
    "speed_mm_per_s": NOT_NEGATIVE,
    "window": one_of(*WINDOWS),
    "rate_per_s": NOT_NEGATIVE,
    "sd_per_s": NOT_NEGATIVE.or_nothing,
    "burst_width_mm": POSITIVE.or_nothing,
    "source": TEXT,
    "how_obtained": TEXT,
}
"""Columns of a file of impulse rates, units in the names. A recording is one receptor, or the mean
of some, under one protocol. ``or_curvature_per_m`` is for a rate whose surface is one of two;
``speed_mm_per_s`` is 0 for a pressed surface.
"""


def read_rates(*paths: str | Path | Iterable[str | Path]) -> pd.DataFrame:
    """Impulse rates of CSV files, one after the other in the order of their names, each once.

    Parameters
    ----------
    paths : files, or folders, all of whose CSV files are read; a folder may have none.

    Returns
    -------
    Columns of :data:`RATES` and ``file``; no rows if there is no file.

    Raises
    ------
    ReferenceDataError
        A file is wrong; a recording has the same rate twice; a burst is of a pressed surface or
        another of a stroked one.
    """
    files = [
        file
        for path in map(Path, paths)
        for file in (sorted(path.glob("*.csv")) if path.is_dir() else [path])
    ]
    frames = []
    for file in dict.fromkeys(files):
        frame = read_table(file, RATES)
        stroked = frame["speed_mm_per_s"] > 0
        for row in frame.index[stroked != (frame["window"] == "burst")]:
            allowed = "burst" if stroked[row] else ", ".join(w for w in WINDOWS if w != "burst")
            raise ReferenceDataError(
                f"{file}: row {row}, column window: '{frame.loc[row, 'window']}'; allowed: "
                f"{allowed}"
            )
        frames.append(frame.assign(file=file.name))
    if not frames:
        return pd.DataFrame(columns=[*RATES, "file"])
    together = pd.concat(frames, ignore_index=True)
    key = [
        "recording",
        "receptor",
        "stimulus",
        "curvature_per_m",
        "force_gf",
        "ramp_gf_per_s",
        "speed_mm_per_s",
        "window",
    ]
    for row in together.index[together.duplicated(key)]:
        entry = together.loc[row]
        what = (
            f"{entry['window']} of {entry['recording']} at {entry['curvature_per_m']:g} "
            f"1/m, {entry['force_gf']:g} gf"
        )
        raise ReferenceDataError(f"{entry['file']}: the {what} is given twice; allowed: each once")
    return together
