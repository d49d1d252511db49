"""What a program of 1998 could have done: parts of energy, formulas, and how ways are judged."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cysyk1999.studies.reconstruction import pads, shares, ways
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence
from fingerpad.healing import simulate
from fingerpad.planning.plan import plan
from fingerpad.reference_solutions import phillips_johnson as half_plane

ROOT = Path(__file__).parents[1]
COARSE = {"accuracy": {"skin_edge": 0.4e-3, "steps": 8}}


@pytest.fixture(scope="module")
def evidence():
    return Evidence(read_evidence(ROOT / "config/reference/reconstruction_evidence.csv"))


@pytest.fixture(scope="module")
def pressed():
    return {
        nu: simulate(ways.scene("158", COARSE | ways.bulk(ways.factor_for(nu))))
        for nu in (0.48, 0.3)
    }


@pytest.mark.parametrize("poisson", [0.3, 0.48])
def test_formulas_of_other_states_are_those_of_their_stresses(poisson):
    """A half-plane under a strip: plane strain, so that all three stresses are known."""
    young, (x, z) = 15e3, np.meshgrid([0.0, 0.4e-3, 2e-3], [0.3e-3, 0.9e-3])
    xx, zz, xz = half_plane.strip_stresses(x, z, [-0.5e-3, 0.5e-3], [1e4])
    shear, bulk = young / (2 * (1 + poisson)), young / (3 * (1 - 2 * poisson))
    out = poisson * (xx + zz)
    pressure = -(xx + zz + out) / 3
    mises = np.sqrt(((xx - zz) ** 2 + (zz - out) ** 2 + (out - xx) ** 2) / 2 + 3 * xz**2)
    found = ways.plane_energies(pressure, mises, young, poisson)
    both = (xx**2 + zz**2) / (2 * young)
    assert found[0] == pytest.approx(both - poisson * xx * zz / young + xz**2 / (2 * shear))
    assert found[1] == pytest.approx(both + xz**2 / young)
    right = half_plane.strain_energy_density(xx, zz, xz, shear, bulk, poisson)
    assert (found[0] > right).all()


def test_a_poisson_s_ratio_is_that_of_its_bulk_modulus():
    for nu in (0.0, 0.3, 0.48, 0.499):
        assert pads.poisson_for(ways.factor_for(nu)) == pytest.approx(nu, abs=1e-12)
    young, nu = (
        ways.bulk(0.2)[f"specimen.layers.fat.{k}"] for k in ("youngs_modulus", "poisson_ratio")
    )
    printed = pads.YOUNG_SOFT / (1 + pads.POISSON), pads.YOUNG_SOFT / (1 - 2 * pads.POISSON)
    assert (young / (1 + nu), young / (1 - 2 * nu)) == pytest.approx((printed[0], 0.2 * printed[1]))


def test_the_pad_of_tissue_has_the_printed_poisson_s_ratio_and_moduli():
    specimen = ways.scene("flat", {}).specimen
    found = [(layer.youngs_modulus, layer.poisson_ratio) for layer in specimen.materials.values()]
    assert (
        found == [(15e4, 0.48), (15e3, 0.48), (15e3, 0.48)] and specimen.moduli == "instantaneous"
    )
    assert specimen.outline.apex_radius == 8.1e-3 and specimen.contact_length == ways.LENGTH


def test_all_ways_can_be_planned_and_differ():
    scenes = {name: ways.scene("1260", changes) for name, (_, changes) in ways.ways().items()}
    scenes.pop(ways.LINEAR)  # on a mesh of its own
    assert len({str(scene.canonical()) for scene in scenes.values()}) == len(scenes) > 25
    for name in (ways.PRINTED, "geometrically linear"):
        chosen = plan(scenes[name])
        assert chosen.effects["finite_strain"].on is not (name == "geometrically linear")


def test_energy_is_of_shape_and_of_volume(pressed):
    for history in pressed.values():
        whole = dict(ways.readings(history))
        for z in pads.DEPTHS:
            volume, energy = ways.volume_part(history, z), ways._at(history, z)
            assert (volume >= -1e-9).all() and (volume <= energy * 1.001 + 1e-9).all()
            pressure, dilatation = (
                ways._at(history, z, name) for name in ("hydrostatic_pressure", "dilatation")
            )
            slope = np.polyfit(dilatation, pressure, 1)[0]
            assert volume == pytest.approx(-(pressure**2) / (2 * slope), rel=2e-3, abs=1e-6)
        assert whole["volume twice"][915] > whole[ways.AS_HERE][915] > whole["volume left out"][915]


def test_shares_of_volume_grow_with_compressibility(pressed):
    frames = [
        ways.shares(dict.fromkeys(ways.SHOWN, history), f"nu {nu}")
        for nu, history in pressed.items()
    ]
    share = [f["volume (Pa)"] / (f["volume (Pa)"] + f["shape (Pa)"]) for f in frames]
    deep = frames[0]["depth (um)"] > 1e6 * pads.EPIDERMIS_THICKNESS
    assert (share[1][deep] > 1.5 * share[0][deep]).all() and share[1].max() < 1
    assert share[0][deep].min() > 5 * share[0][~deep].max()
    frame = pd.concat(frames, ignore_index=True)
    fig = shares.shares_picture(frame)
    assert [len(ax.patches) for ax in fig.axes] == [4 * len(pads.DEPTHS)] * 3
    named = [text.get_text() for text in fig.legends[0].get_texts()]
    assert named == [f"nu {nu}: {part}" for nu in (0.48, 0.3) for part in ("shape", "volume")]
    told = share[0][deep]
    assert f"{told.min():.0%} to {told.max():.0%} (nu 0.48)" in shares.told_of_shares(frame)


@pytest.mark.slow
def test_a_lower_poisson_s_ratio_or_the_formula_of_plane_stress_bring_the_energies(evidence):
    """What the page of findings says; a pad as printed, read as everywhere, is far from them."""
    judge, found = ways.Judge(evidence), {}
    for nu in (pads.POISSON, 0.42):
        name = ways.PRINTED if nu == pads.POISSON else ways.ALL_FREE.format(nu)
        read = ways.judged(ways.run(name), judge)
        found[nu] = {name: row["distance (1)"] for name, row in read.items()}
    usual, formula = ways.AS_HERE, ways.FORMULA
    assert (
        found[0.48][usual] > 20 * found[0.42][usual]
        and found[0.48][usual] > 20 * found[0.48][formula]
    )
    others = [v for name, v in found[0.48].items() if name != formula]
    assert min(others) > 5 * found[0.48][formula]


def test_a_way_inside_all_energies_but_for_a_factor_is_at_no_distance(evidence):
    judge = ways.Judge(evidence)
    rows = judge.energy.rows
    assert set(rows["measure"].str.removeprefix("energy_").astype(int)) <= set(pads.DEPTHS)
    middle = (rows["low"] + rows["high"]) / 2
    measured = dict.fromkeys(judge.other.keys, 0.0)
    measured |= {"1260: peak": 2e4, "flat: depth_end": 0.9, "1260: depth_end": 1.2}
    told = judge(measured, dict(zip(judge.energy.keys, 2 * middle, strict=True)))
    assert told["distance (1)"] == 0 and 0.35 < told["factor on energies (1)"] < 0.6
    deep = rows["family"] == "dermal energy"
    bent = np.where(deep, 0.3, 1.0) * middle
    found = judge(measured, dict(zip(judge.energy.keys, bent, strict=True)))
    assert found["distance (1)"] > 5
    assert np.isnan(judge(measured, {})["distance (1)"])


def test_the_table_has_the_closest_reading_of_each_way_and_the_readings_of_the_printed_pad():
    near, far = ({"distance (1)": d} for d in (1.0, 9.0))
    found = {
        ways.PRINTED: {ways.AS_HERE: far, "other": near},
        "geometrically linear": {ways.AS_HERE: near},
    }
    rows = ways.table(found).set_index("tried")
    assert rows.loc[ways.PRINTED, ["closest reading", "its distance (1)"]].tolist() == [
        "other",
        1.0,
    ]
    assert rows["kind"].tolist() == ["material", "program", "reading"]
