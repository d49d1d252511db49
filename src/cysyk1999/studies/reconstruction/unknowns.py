"""What the thesis does not say, with priors, and the readings of its moduli:
``config/reconstruction/unknowns.yaml``.

Inside this study numbers stay in the units of the file, which are part of their names' meaning:
N/m, mm, gf, 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator
from scipy.special import ndtr, ndtri
from scipy.stats import qmc

from fingerpad.documents import Problem, Strict, explain, read_yaml

SCALED = "line_load"
"""The unknown that a pad is simulated with over the state of dermis and fat."""
LOAD, STIFFNESS = "load_over_state", "stiffness_over_state"
SOFT, EPIDERMIS = "soft_factor", "epidermis_factor"
ENERGY, STROKE_ENERGY = "energy_factor", "stroke_energy_factor"
BULK, EPIDERMIS_BULK = "bulk_modulus", "epidermis_bulk"
"""Bulk modulus over that of nu = 0.48, at the same shear modulus."""
UNITS = ("N/m", "mm", "gf", "1")


def _number(value: Any) -> tuple[float, str]:
    """``"17 N/m"`` -> 17.0, "N/m"."""
    number, _, unit = str(value).strip().partition(" ")
    unit = unit.strip() or "1"
    try:
        size = float(number)
    except ValueError:
        size = np.nan
    if unit not in UNITS or not np.isfinite(size):
        allowed = "a number, then one of " + ", ".join(UNITS)
        raise Problem("is not a number with a known unit", allowed)
    return size, unit


def _pair(value: Any) -> tuple[tuple[float, str], ...]:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        allowed = 'two values, the lower one first, such as ["3 mm", "7 mm"]'
        raise Problem("is not two values", allowed)
    low, high = map(_number, value)
    if low[1] != high[1] or not low[0] < high[0]:
        raise Problem("is not rising", "two values of one unit, the lower one first")
    return low, high


def _factors(value: Any) -> tuple[float, ...]:
    factors = tuple(map(float, value if isinstance(value, (list, tuple)) else [value]))
    rising = list(factors) == sorted(set(factors))
    if not rising or len(factors) not in (1, 2) or not all(0 < v < 10 for v in factors):
        raise Problem("is not a factor or two", "[1], or two rising factors such as [0.5, 1.1]")
    return factors


Pair = Annotated[Any, BeforeValidator(_pair, json_schema_input_type=tuple[str, str])]
Number = Annotated[Any, BeforeValidator(_number, json_schema_input_type=str)]
Factors = Annotated[
    tuple[float, ...], BeforeValidator(_factors, json_schema_input_type=list[float])
]


class Normal(Strict):
    """A normal prior, cut off at the range."""

    mean: Number
    """Its mean."""
    sd: Number
    """Its standard deviation."""


class Unknown(Strict):
    """Something that the thesis does not state, and what is believed of it before."""

    range: Pair
    """Least and largest value."""
    prior: Literal["uniform", "logarithmic"] | None = None
    """Even in the value, or in its logarithm."""
    normal: Normal | None = None
    """A normal prior instead."""
    source: str
    """Where the range and the prior are from."""

    @model_validator(mode="after")
    def _one(self) -> Unknown:
        if (self.prior is None) == (self.normal is None):
            allowed = "prior: uniform or logarithmic, or normal: {mean: ..., sd: ...}"
            raise Problem("must have one prior", allowed, ("prior",))
        return self

    @property
    def axis(self) -> tuple[float, float, bool]:
        """Least and largest value, and whether the prior is logarithmic."""
        return self.range[0][0], self.range[1][0], self.prior == "logarithmic"

    @property
    def unit(self) -> str:
        """Unit of its values."""
        return self.range[0][1]

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values at shares from 0 to 1 of the prior."""
        if self.normal is None:
            return _between(share, *self.axis)
        mean, sd = self.normal.mean[0], self.normal.sd[0]
        low, high = (ndtr((end - mean) / sd) for end, _ in self.range)
        return mean + sd * ndtri(low + share * (high - low))


class Reading(Strict):
    """What the printed moduli may have been, as factors on the long-term moduli of the model."""

    soft: Factors
    """Of dermis and fat."""
    epidermis: Factors | None = None
    """Of the epidermis; that of dermis and fat unless given."""
    bulk_modulus: Factors | None = None
    """The bulk modulus's factor or its range, where the reading says it."""
    epidermis_bulk: Factors | None = None
    """The epidermis's; that of dermis and fat unless given."""
    energy: Literal["", "_plane_stress"] = ""
    """What the strain energy is: the headline's, or a formula's."""
    energy_factor: Factors | None = None
    """On all strain energies."""
    stroke_energy_factor: Factors | None = None
    """On those of chapter 5 beside."""
    says: str
    """The reading in words."""

    @property
    def _factors(self) -> dict[str, tuple[float, ...]]:
        given = {
            SOFT: self.soft,
            EPIDERMIS: self.epidermis,
            BULK: self.bulk_modulus,
            EPIDERMIS_BULK: self.epidermis_bulk,
            ENERGY: self.energy_factor,
            STROKE_ENERGY: self.stroke_energy_factor,
        }
        return {name: factors for name, factors in given.items() if factors}

    @property
    def fixed(self) -> dict[str, float]:
        """Values that the reading says, by name."""
        return {k: v[0] for k, v in self._factors.items() if len(v) == 1}

    @property
    def free(self) -> dict[str, Unknown]:
        """Factors that the reading leaves free, by name."""
        return {
            name: Unknown(range=[f"{end:g}" for end in ends], prior="logarithmic", source=self.says)
            for name, ends in self._factors.items()
            if len(ends) == 2
        }


class Design(Strict):
    """The pads that are simulated."""

    load_over_state: Pair
    """Line load over the soft layers' factor."""
    stiffness_over_state: Pair
    """The epidermis's factor over that of the soft layers."""
    pads: Annotated[int, Field(ge=16, le=65536)]
    """How many are drawn, best a power of two; fewer may be simulated."""
    seed: int = 0
    """Of the draw."""


class Unknowns(Strict):
    """All that is not known."""

    unknowns: Mapping[str, Unknown]
    """By name."""
    readings: Mapping[str, Reading]
    """Of the moduli, by name."""
    design: Design
    """Pads that are simulated."""

    @cached_property
    def axes(self) -> dict[str, tuple[float, float, bool]]:
        """Axes of the design: low, high, whether even in the logarithm. All that changes a
        simulation, not what scales it.
        """
        scaled = {
            name: (*(value for value, _ in getattr(self.design, name)), True)
            for name in (LOAD, STIFFNESS)
        }
        skipped = (SCALED, "plate_length")
        return scaled | {k: u.axis for k, u in self.unknowns.items() if k not in skipped}

    def to_unit(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        """Shares (n, axes) of the design's ranges at values of its axes; outside 0 to 1 where the
        design does not reach.
        """
        shares = []
        for name, (low, high, logarithmic) in self.axes.items():
            value = np.asarray(values[name], float)
            far, whole = (
                (np.log(value / low), np.log(high / low))
                if logarithmic
                else (
                    value - low,
                    high - low,
                )
            )
            shares.append(far / whole)
        return np.stack(np.broadcast_arrays(*shares), axis=-1)

    def from_unit(self, shares: np.ndarray) -> dict[str, np.ndarray]:
        """Values of the axes at shares (..., axes)."""
        return {
            name: _between(shares[..., k], *ax) for k, (name, ax) in enumerate(self.axes.items())
        }

    def draw(self) -> dict[str, np.ndarray]:
        """The design: values (pads,) of its axes, of a scrambled Sobol sequence, so that any number
        of the first ones is even.
        """
        pads = self.design.pads
        sobol = qmc.Sobol(len(self.axes), rng=np.random.default_rng(self.design.seed))
        return self.from_unit(sobol.random(2 ** int(np.ceil(np.log2(pads))))[:pads])


def _between(share: np.ndarray, low: float, high: float, logarithmic: bool) -> np.ndarray:
    """Values at shares of a range."""
    return low * (high / low) ** share if logarithmic else low + (high - low) * share


def unknowns_json_schema() -> dict[str, Any]:
    """JSON schema of the file as people write it."""
    return Unknowns.model_json_schema() | {"title": "What the thesis does not say of its pad"}


def read_unknowns(path: str | Path) -> Unknowns:
    """Read and check the file; SceneError, one line, if it is wrong."""
    document = read_yaml(Path(path))
    try:
        return Unknowns.model_validate(document, context=Path(path))
    except ValidationError as error:
        raise explain(error, path, document) from None
