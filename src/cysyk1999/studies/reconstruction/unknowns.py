"""What the thesis does not say, with priors, and the readings of its moduli:
``config/reconstruction/unknowns.yaml``.

Inside this study numbers stay in the units of the file, which are part of their names' meaning:
N/m, mm, 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator
from scipy.special import ndtr, ndtri

from fingerpad.documents import Problem, Strict, explain, read_yaml

SCALED = "line_load"
"""The unknown that a pad is simulated with over the state of dermis and fat."""
LOAD, STIFFNESS = "load_over_state", "stiffness_over_state"
UNITS = ("N/m", "mm", "1")


def _read(value: Any) -> tuple[float, str]:
    """``"17 N/m"`` -> 17.0, "N/m"."""
    number, _, unit = str(value).strip().partition(" ")
    unit = unit.strip() or "1"
    try:
        found = float(number)
    except ValueError:
        raise Problem(
            "is not a number with a unit", "a number, then one of " + ", ".join(UNITS)
        ) from None
    if unit not in UNITS or not np.isfinite(found):
        raise Problem(
            "is not a number with a known unit", "a number, then one of " + ", ".join(UNITS)
        )
    return found, unit


def _pair(value: Any) -> tuple[tuple[float, str], tuple[float, str]]:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise Problem(
            "is not two values", 'two values, the lower one first, such as ["3 mm", "7 mm"]'
        )
    low, high = (_read(each) for each in value)
    if low[1] != high[1] or not low[0] < high[0]:
        raise Problem("is not rising", "two values of one unit, the lower one first")
    return low, high


Pair = Annotated[Any, BeforeValidator(_pair, json_schema_input_type=tuple[str, str])]
Number = Annotated[Any, BeforeValidator(_read, json_schema_input_type=str)]


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
            raise Problem(
                "says not one prior",
                "prior: uniform or logarithmic, or normal: {mean: ..., sd: ...}",
                ("prior",),
            )
        return self

    @property
    def low(self) -> float:
        """Least value."""
        return self.range[0][0]

    @property
    def high(self) -> float:
        """Largest value."""
        return self.range[1][0]

    @property
    def unit(self) -> str:
        """Unit of its values."""
        return self.range[0][1]

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values at shares from 0 to 1 of the prior."""
        if self.prior == "uniform":
            return self.low + (self.high - self.low) * share
        if self.prior == "logarithmic":
            return self.low * (self.high / self.low) ** share
        mean, sd = self.normal.mean[0], self.normal.sd[0]
        low, high = ndtr((self.low - mean) / sd), ndtr((self.high - mean) / sd)
        return mean + sd * ndtri(low + (high - low) * share)


def _factors(value: Any) -> tuple[float, ...]:
    found = tuple(float(v) for v in value) if isinstance(value, (list, tuple)) else (float(value),)
    if (
        not 1 <= len(found) <= 2
        or not all(0 < v < 10 for v in found)
        or sorted(set(found)) != list(found)
    ):
        raise Problem("is not a factor or two", "[1], or two rising factors such as [0.5, 1.1]")
    return found


Factors = Annotated[
    tuple[float, ...], BeforeValidator(_factors, json_schema_input_type=list[float])
]


class Reading(Strict):
    """What the printed moduli may have been, as factors on the long-term moduli of the model."""

    soft: Factors
    """Of dermis and fat."""
    epidermis: Factors | None = None
    """Of the epidermis; that of dermis and fat unless given."""
    bulk_modulus: float | None = None
    """The bulk modulus's factor, where the reading says it."""
    says: str
    """The reading in words."""


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
        d = self.design
        own = {
            LOAD: (*(v for v, _ in d.load_over_state), True),
            STIFFNESS: (*(v for v, _ in d.stiffness_over_state), True),
        }
        rest = {
            k: (u.low, u.high, u.prior == "logarithmic")
            for k, u in self.unknowns.items()
            if k not in (SCALED, "plate_length")
        }
        return own | rest

    def to_unit(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        """Shares (n, axes) of the design's ranges at values of its axes; outside 0 to 1 where the
        design does not reach.
        """
        out = []
        for name, (low, high, logarithmic) in self.axes.items():
            v = np.asarray(values[name], float)
            out.append(
                np.log(v / low) / np.log(high / low) if logarithmic else (v - low) / (high - low)
            )
        return np.stack(np.broadcast_arrays(*out), axis=-1)

    def from_unit(self, shares: np.ndarray) -> dict[str, np.ndarray]:
        """Values of the axes at shares (..., axes)."""
        found = {}
        for k, (name, (low, high, logarithmic)) in enumerate(self.axes.items()):
            s = shares[..., k]
            found[name] = low * (high / low) ** s if logarithmic else low + (high - low) * s
        return found

    def draw(self) -> dict[str, np.ndarray]:
        """The design: values (pads,) of its axes, of a scrambled Sobol sequence, so that any number
        of the first ones is even.
        """
        from scipy.stats import qmc

        sobol = qmc.Sobol(len(self.axes), rng=np.random.default_rng(self.design.seed))
        shares = sobol.random(2 ** int(np.ceil(np.log2(self.design.pads))))[: self.design.pads]
        return self.from_unit(shares)


def unknowns_json_schema() -> dict[str, Any]:
    """JSON schema of the file as people write it."""
    return Unknowns.model_json_schema() | {"title": "What the thesis does not say of its pad"}


def read_unknowns(path: str | Path) -> Unknowns:
    """Read and check the file. Raises SceneError, one line."""
    document = read_yaml(Path(path))
    try:
        return Unknowns.model_validate(document, context=Path(path))
    except ValidationError as error:
        raise explain(error, path, document) from None
