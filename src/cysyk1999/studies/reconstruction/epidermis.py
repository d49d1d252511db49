"""Energies inside the epidermis: what 1999 could have done to read them so low, each tried on the
most probable pad.

The thesis's Fig 4-24 shows under its sharpest surface up to 800 Pa at 560 um and to 3000 Pa at 845
um (ticks before: 600, 2000). A reading that were the cause would bring all six depths in the
epidermis inside, and leave the dermis where it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.studies.accuracy.meshes import quarters
from cysyk1999.studies.effects.run import with_effects
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.evidence import Evidence
from cysyk1999.studies.reconstruction.inference import EPIDERMIS, SOFT
from cysyk1999.studies.reconstruction.unknowns import LOAD, SCALED, STIFFNESS
from cysyk1999.studies.stability.run import Teaching
from fingerpad.measures import features
from fingerpad.planning.plan import plan
from fingerpad.scenes.scene import Scene
from fingerpad.simulation import Simulation, simulate
from fingerpad.specimen import mesh_for

SHARPEST = "1260"
WITHIN = (560, 600, 640, 765, 800, 845)
"""um; depths of Fig 4-24 in the epidermis."""
DERMIS = 915
COLUMN = 134.4e-6
"""m; width of the thesis's elements along the skin (two node spacings)."""
GAUSS = np.sqrt(0.6) / 2
"""Place of the outer ones of three Gauss points, in lengths of an element from its centre."""
ROW = 40e-6 / GAUSS
"""m; height of an element whose Gauss points are 40 um apart."""
KINDS = {
    "hybrid eight-node quads, as here": "Q2P1",
    "full eight-node quads": "Q2",
    "reduced eight-node quads": "Q2R",
    "full four-node quads, half the edge": "Q1",
}


def best_pad(posterior: pd.DataFrame) -> dict[str, float]:
    """The best pad of the freest reading of a table of posteriors, on the axes of the design, with
    its factors.
    """
    rows = posterior[posterior["reading"] == "both_free"].set_index("quantity")["best pad"]
    pad = {name: float(value) for name, value in rows.items()}
    return pad | {LOAD: pad[SCALED] / pad[SOFT], STIFFNESS: pad[EPIDERMIS] / pad[SOFT]}


def _energies(
    history, offset: float = 0.0, name: str = "strain_energy_density"
) -> dict[int, np.ndarray]:
    return {z: features.energy(history, z * 1e-6, offset, name) for z in (*WITHIN, DERMIS)}


def _row(
    what: str, found: Mapping[int, float], soft: float, peak: float = np.nan
) -> dict[str, object]:
    return {
        "tried": what,
        **{f"{z} um (Pa)": soft * float(found[z]) for z in (*WITHIN, DERMIS)},
        "peak pressure (Pa)": soft * peak,
    }


def _scene(pad: Mapping[str, float], **changes) -> Scene:
    """The sharpest surface on a pad, receptors under the centre and beside it by Gauss points of
    elements that meet there.
    """
    offsets = [
        0.0,
        46e-6,
        COLUMN / 2 - GAUSS * COLUMN,
        COLUMN / 2,
        COLUMN / 2 + GAUSS * COLUMN,
        COLUMN,
    ]
    depths = sorted({z * 1e-6 for z in (*WITHIN, DERMIS)} | {z * 1e-6 - 100e-6 for z in WITHIN})
    given = {
        "outputs.receptors.offsets": offsets,
        "outputs.receptors.depths": depths,
        "accuracy": "thesis",
    }
    return pads.scene(pad, SHARPEST).varied(given | changes)


def _variants(pad: Mapping[str, float]) -> Iterator[tuple[str, Scene]]:
    """What the pad or the program could have been, as scenes."""
    stiff = pads.changes(pad)["specimen.layers.epidermis.youngs_modulus"]
    yield "geometrically linear", _scene(pad, effects={"finite_strain": "off"})
    for thickness in (0.75, 1.0):
        yield f"epidermis of {thickness} mm", _scene(pad | {"epidermis_thickness": thickness})
    for factor in (0.5, 2.0):
        yield (
            f"epidermis {factor:g} times as stiff",
            _scene(pad | {STIFFNESS: factor * pad[STIFFNESS]}),
        )
    for factor in (0.25, 4.0, 10.0):
        layer = {
            "youngs_modulus": factor * stiff,
            "poisson_ratio": pads.poisson_for(pad["bulk_modulus"]),
        }
        yield (
            f"stratum corneum a layer, {factor:g} times as stiff",
            _scene(pad, **{"specimen.layers.stratum_corneum": layer}),
        )
    yield "bone 2 mm nearer", _scene(pad | {"fat_thickness": pad["fat_thickness"] - 2})
    yield "friction 0.5", _scene(pad, friction=0.5)
    for load in (0.8, 0.6):
        yield f"{load:g} of the load", _scene(pad | {LOAD: load * pad[LOAD]})
    for nu in (0.45, 0.499):
        yield (
            f"Poisson's ratio {nu}",
            _scene(
                pad,
                **{
                    f"specimen.layers.{k}.poisson_ratio": nu for k in ("epidermis", "dermis", "fat")
                },
            ),
        )


def study(pad: Mapping[str, float], evidence: Evidence) -> pd.DataFrame:
    """A row a reading: energies of the sharpest surface by depth, peak pressure, distance from the
    axes, and what it means.
    """
    soft, rows = pad[SOFT], []
    history = simulate(_scene(pad))
    found = _energies(history)
    top, peak = features.ramp_end(history), float(features.peak_pressure(history).max())
    rows.append(
        _row(
            "as elsewhere here: highest, instantaneous elastic energy, at the point",
            {z: e.max() for z, e in found.items()},
            soft,
            peak,
        )
    )
    half = len(found[DERMIS][: top + 1]) // 2
    for what, at in (
        ("half way up the ramp", half),
        ("end of the ramp", top),
        ("end of the hold", -1),
    ):
        rows.append(_row(what, {z: e[at] for z, e in found.items()}, soft, peak))
    for name, variable in ENERGIES.items():
        rows.append(
            _row(
                f"energy: {name}",
                {z: e.max() for z, e in _energies(history, name=variable).items()},
                soft,
                peak,
            )
        )
    rows.append(
        _row(
            "46 um beside the centre",
            {z: e.max() for z, e in _energies(history, 46e-6).items()},
            soft,
            peak,
        )
    )
    rows.append(_row("element average", _averaged(history), soft, peak))
    rows.append(
        _row("extrapolated to the corner from reduced points", _extrapolated(history), soft, peak)
    )
    shallow = {z: features.energy(history, (z - 100) * 1e-6).max() for z in WITHIN} | {
        DERMIS: found[DERMIS].max()
    }
    rows.append(_row("0.1 mm less deep than told", shallow, soft, peak))
    kinds = {what: of_element(pad, kind) for what, kind in KINDS.items()}
    reference = kinds["hybrid eight-node quads, as here"]
    for what, each in kinds.items():
        if what.startswith(("full", "reduced")):
            rows.append(
                _row(what, {z: found[z].max() * each[z] / reference[z] for z in found}, soft)
            )
    for what, scene in _variants(pad):
        try:
            other = simulate(scene)
        except Exception as error:  # noqa: BLE001 - what cannot be is said, and the rest goes on
            rows.append({"tried": f"{what}: {type(error).__name__}"})
            continue
        rows.append(
            _row(
                what,
                {z: e.max() for z, e in _energies(other).items()},
                soft,
                float(features.peak_pressure(other).max()),
            )
        )
    return judged(pd.DataFrame(rows), evidence)


def judged(table: pd.DataFrame, evidence: Evidence) -> pd.DataFrame:
    """With the distance of the six depths from their axes, how many are inside, and the dermis's
    energy over the first row's.
    """
    rows = evidence.rows[
        (evidence.rows["role"] == "apart") & (evidence.rows["surface"] == SHARPEST)
    ].reset_index(drop=True)
    within = Evidence(rows)
    shown = table[[f"{m.removeprefix('energy_')} um (Pa)" for m in rows["measure"]]].to_numpy(float)
    departure = within.departure(shown)
    deep = f"{DERMIS} um (Pa)"
    return table.assign(
        **{
            "depths inside": [f"{int((d == 0).sum())} of {len(d)}" for d in departure],
            "distance (1)": (departure**2).sum(axis=1),
            "dermis over the first row's (1)": table[deep] / table[deep].iloc[0],
        }
    )


def _averaged(history) -> dict[int, float]:
    """Mean over an element beside the centre: Gauss points over its width, and over the three
    depths of a row.
    """
    beside, weights = (
        [COLUMN / 2 - GAUSS * COLUMN, COLUMN / 2, COLUMN / 2 + GAUSS * COLUMN],
        np.array([5, 8, 5]) / 18,
    )
    wide = {
        z: sum(
            w * features.energy(history, z * 1e-6, x) for w, x in zip(weights, beside, strict=True)
        ).max()
        for z in (*WITHIN, DERMIS)
    }
    rows = [WITHIN[:3], WITHIN[3:]]
    out = {
        z: sum(w * wide[d] for w, d in zip(weights, row, strict=True)) for row in rows for z in row
    }
    return out | {DERMIS: wide[DERMIS]}


def _extrapolated(history) -> dict[int, float]:
    """Linear through the two reduced Gauss points of each row of elements, to the depth that is
    told.
    """
    out = {DERMIS: features.energy(history, DERMIS * 1e-6).max()}
    for row in (WITHIN[:3], WITHIN[3:]):
        depths, found = (
            np.array(row),
            np.array([features.energy(history, z * 1e-6).max() for z in row]),
        )
        points = depths[1] + np.array([-1, 1]) * 1e6 * ROW / (2 * np.sqrt(3))
        curve = np.polyfit(depths, found, 2)
        line = np.polyfit(points, np.polyval(curve, points), 1)
        out |= {z: float(np.polyval(line, z)) for z in row}
    return out


def of_element(pad: Mapping[str, float], kind: str) -> dict[int, float]:
    """Elastic energy (Pa) of the instantaneous pad under the load at the depths, at Gauss points
    next to the centre.
    """
    scene = pads.scene(pad, SHARPEST).varied(
        {"motion": [{"press_to_force": "20 gf"}], "accuracy": {"skin_edge": COLUMN, "steps": 6}}
    )
    chosen = with_effects(plan(scene), "instantaneous", viscoelasticity=False)
    mesh = mesh_for(scene, chosen)
    if kind == "Q1":
        mesh = quarters(mesh)
    run = (
        Simulation(scene, chosen, None)
        if kind == "Q2P1"
        else Teaching(scene, replace(chosen, element=kind), mesh, True)
    )
    run.run(None)
    space, u = run.body.space, run.body.u
    gradient = np.eye(2) + np.einsum("eqai,eaj->eqji", space.grad, u[space.cells])
    jacobian = np.linalg.det(gradient)
    first = (gradient**2).sum((-2, -1)) + 1
    shear, bulk = run.body.shear[:, None], run.body.bulk[:, None]
    energy = shear / 2 * (jacobian ** (-2 / 3) * first - 3) + bulk / 2 * (jacobian - 1) ** 2
    place = np.einsum("qa,eai->eqi", space.element.values, space.points[space.cells])
    x, depth = np.abs(place[..., 0]).ravel(), (pads.APEX - place[..., 1]).ravel()
    inner = 1e-3 * pad["epidermis_thickness"]
    near = (x < x[depth < inner].min() + 5e-6) & (depth < 1.2e-3)
    out = {}
    for z in (*WITHIN, DERMIS):
        same = near & ((depth < inner) == (z * 1e-6 < inner))
        order = np.argsort(depth[same])
        out[z] = float(np.interp(z * 1e-6, depth[same][order], energy.ravel()[same][order]))
    return out
