"""A page on which a person turns the knobs of an emulator: one file, without a server or a network.

`page.html`, `page.css` and `page.js` are its parts, plain and readable; the emulator is put between
them as JSON.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.benchmark.rows import datasets
from fingerpad.documents import SceneError
from fingerpad.emulator.basis import BENT, FROM_ALL, NEARBY, SOONEST
from fingerpad.emulator.model import ON_BORDER, PLACES, STRESSES, Emulator, in_logarithm
from fingerpad.emulator.question import FLAT, borders, looked_up
from fingerpad.receptors.laws import THESIS_RATE

DIGITS = 9
"""Of the numbers on the page."""
SURFACES = {
    "flat": 0.0,
    "79": 78.74,
    "105": 104.99,
    "158": 157.48,
    "210": 209.97,
    "315": 314.96,
    "420": 419.95,
    "630": 629.92,
    "1260": 1259.84,
}
"""The nine surfaces of Cysyk (1999): name -> curvature, 1/m."""
NEEDED = ("stimulus.curvature", "motion[0].press_to_force", "motion[0].rate")
SHOWN = {
    "stimulus.curvature": "Curvature",
    "motion[0].press_to_force": "Force",
    "motion[0].rate": "Rate of force",
    "specimen.outline.epidermis_thickness": "Epidermis thickness",
}
"""What the page calls a knob; others have their key."""
MODULUS = (0.5, 2.0)
"""Least and largest factor of all moduli on the page."""
_HERE = Path(__file__).parent


def page(emulator: Emulator) -> str:
    """The page of an emulator, HTML.

    Parameters
    ----------
    emulator
        Of cylinders or spheres that are pressed at a rate and held; curvature, force and rate are
        knobs.

    Raises
    ------
    SceneError
        It is an emulator of other scenes; one line.
    """
    keys = [knob.key for knob in emulator.knobs]
    missing = [key for key in NEEDED if key not in keys]
    if missing or emulator.moments.slid or not len(emulator.moments.later):
        raise SceneError(
            f"the emulator: {missing[0] if missing else 'motion[1].hold'} is no knob of it; "
            "allowed: of a cylinder or sphere that is pressed at a rate and held, with curvature, "
            "force and rate as knobs"
        )
    parts = {name: (_HERE / f"page.{name}").read_text(encoding="utf-8") for name in ("css", "js")}
    parts["model"] = json.dumps(_model(emulator), separators=(",", ":")).replace("</", "<\\/")
    text = (_HERE / "page.html").read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"@{name}@", part)
    return text


def _model(emulator: Emulator) -> dict[str, Any]:
    """All that the page needs, as plain data."""
    groups = {
        name: {
            "shape": list(group.shape),
            "logarithmic": in_logarithm(name, emulator.turned),
            "stress": name in STRESSES,
            "mean": _packed(group.mean),
            "rows": _packed(group.rows),
            "coefficients": _packed(group.coefficients),
            "band": _packed(group.band),
            "scales": _numbers(group.scales),
            "missed": _packed(group.missed),
        }
        for name, group in emulator.groups.items()
    }
    law, base = THESIS_RATE, emulator.base
    keys = {key for sums in borders(base) for key in sums}
    return {
        "knobs": [
            knob.record() | {"label": SHOWN.get(knob.key, knob.key)} for knob in emulator.knobs
        ],
        "modulus": {"low": MODULUS[0], "high": MODULUS[1]},
        "press": _numbers(emulator.moments.press),
        "hold": _numbers(emulator.moments.later),
        "soonest": SOONEST,
        "powers": emulator.powers.tolist(),
        "centres": _packed(emulator.centres),
        "bent": BENT,
        "nearby": NEARBY,
        "from_all": FROM_ALL,
        "on_border": ON_BORDER,
        "places": _numbers(PLACES),
        "grids": {name: _numbers(grid) for name, grid in emulator.grids.items()},
        "turned": emulator.turned,
        "contact_length": base["specimen"]["contact_length"],
        "base": base,
        "groups": groups,
        "pieces": emulator.pieces,
        "borders": borders(base),
        "thicknesses": {key: looked_up(base, key) for key in keys},
        "surfaces": list(SURFACES.items()),
        "flat": FLAT,
        "subjects": measured_subjects(emulator),
        "scenes": emulator.about["scenes"],
        "law": {
            "per_energy": law.per_energy,
            "per_rate": law.per_rate,
            "threshold": law.threshold,
            "rate_threshold": law.rate_threshold,
            "spontaneous": law.spontaneous,
        },
    }


def measured_subjects(emulator: Emulator) -> list[dict[str, Any]]:
    """Measured fingers under a flat plate, and the factor of all moduli that is nearest to each.

    Parameters
    ----------
    emulator
        Of cylinders, down to a flat plate; of others there are none.

    Returns
    -------
    list of dict
        ``subject``; ``points``, measured (force, depth) in N and m, at rest; ``modulus``, with
        which the emulator's depths at the end of its longest hold are off by least (r.m.s. of
        those that it answers); and ``source``.

    Notes
    -----
    The force of the press is that of a pad of the sweep's moduli: m times as stiff a pad needs m
    times the force for the same depth.
    """
    knobs = {knob.key: knob for knob in emulator.knobs}
    curvature, force = (knobs[key] for key in NEEDED[:2])
    if emulator.turned or curvature.low > FLAT:
        return []
    base = {key: looked_up(emulator.base, key) for key in knobs}
    factors, found = np.geomspace(*MODULUS, 61), []
    rows = datasets(["force_plate"])["force_plate"]
    for subject in dict.fromkeys(row.subject for row in rows):
        own = [row for row in rows if row.subject == subject]
        points = np.array([(row.value, row.place("depth", "length")) for row in own])
        forces = points[:, 0] / factors[:, None]
        asked = np.array([[base[knob.key] for knob in emulator.knobs]] * forces.size)
        keys = list(knobs)
        asked[:, keys.index(curvature.key)] = curvature.low
        asked[:, keys.index(force.key)] = forces.ravel()
        depths = emulator.values(asked, ("indentation_depth",))["indentation_depth"][:, -1]
        off = (depths.reshape(forces.shape) - points[:, 1]) ** 2
        off[(forces < force.low) | (forces > force.high)] = np.nan
        answered = np.isfinite(off).sum(axis=1)
        if answered.max() < 2:
            continue
        misfit = np.where(answered == answered.max(), np.nansum(off, axis=1), np.inf)
        found.append(
            {
                "subject": subject,
                "points": points.tolist(),
                "modulus": float(factors[np.argmin(misfit)]),
                "source": own[0].source,
            }
        )
    return found


def _packed(array: np.ndarray) -> dict[str, Any]:
    """An array as bytes: large coefficients of either sign nearly cancel, so they need all their
    digits.
    """
    text = base64.b64encode(np.ascontiguousarray(array, "<f8").tobytes()).decode("ascii")
    return {"float64": text, "columns": array.shape[1] if array.ndim > 1 else 0}


def _numbers(array: np.ndarray) -> list[float]:
    """A list of numbers, to `DIGITS` digits."""
    return [float(f"{value:.{DIGITS}g}") for value in array.tolist()]
