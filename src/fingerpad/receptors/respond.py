"""From a simulated history to what its receptors would send: impulse rates and impulses, by one
call.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate, rate_by_leg
from fingerpad.receptors.rapidly_adapting import ASSUMED_RATE, RapidlyAdapting
from fingerpad.receptors.spikes import impulses
from fingerpad.stimuli.motion import NO_TIME, apart

AFFERENTS: dict[str, ImpulseRate | RapidlyAdapting] = {
    "slowly_adapting": THESIS_RATE,
    "rapidly_adapting": ASSUMED_RATE,
}
"""Kinds of receptor and their laws: Eq 5-1 with the thesis's own constants; saturating in the rate,
with assumed constants.
"""
NAMES = {
    "SA-I": "slowly_adapting",
    "SA1": "slowly_adapting",
    "RA": "rapidly_adapting",
    "FA-I": "rapidly_adapting",
}
"""Other names of these kinds, as physiologists and files of recordings have them."""
_SENT = {
    "impulse_rate": ("1/s", "predicted impulse rate"),
    "impulses": ("1", "predicted number of impulses"),
    "impulse_time": ("s", "times of the predicted impulses"),
    "response_time": ("s", "time"),
}
"""Variable -> unit, long name."""


def respond(
    history: xr.Dataset,
    afferents: str | Iterable[str] | Mapping[str, ImpulseRate | RapidlyAdapting] = (
        "slowly_adapting",
    ),
    variation: float = 0.0,
    seed: int | None = None,
) -> xr.Dataset:
    """Impulse rates and impulses of all receptors of a history.

    They are predicted from the strain energy density and its rate.

    Parameters
    ----------
    history
        As `fingerpad.simulate` or `fingerpad.read_history` returns it.
    afferents
        One or more of :data:`AFFERENTS` or :data:`NAMES`, or laws by a name of your own.
    variation
        Coefficient of variation of the intervals; 0: none.
    seed
        Of that variability.

    Returns
    -------
    xarray.Dataset
        ``impulse_rate`` (afferent, response_time, receptor), impulses/s; ``impulses`` (afferent,
        receptor), how many; ``impulse_time`` (afferent, receptor, impulse), s, NaN after the last.
        Rates are differences within a leg, so the time of a kink between legs is there twice, 1e-12
        s apart (see :func:`fingerpad.receptors.laws.rate_by_leg`).

    Raises
    ------
    TypeError
        This is no history.
    ValueError
        Nothing in the history takes time, there is no such afferent, or there is variability
        without a seed.

    Examples
    --------
    >>> from fingerpad import simulate
    >>> history = simulate({
    ...     "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...     "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "0.5 s"}],
    ...     "accuracy": "draft",
    ... })
    >>> respond(history).impulses.values.tolist()
    [[37, 9]]
    """
    if not isinstance(history, xr.Dataset):
        raise TypeError(
            "a history is what simulate or read_history returns, "
            f"not {type(history).__name__} {str(history)[:60]!r}"
        )
    afferents = [afferents] if isinstance(afferents, str) else afferents
    if isinstance(afferents, Mapping):
        laws = dict(afferents)
    else:
        laws = {name: _law(name) for name in (NAMES.get(n, n) for n in afferents)}
    time, leg = history["time"].values, history["leg"].values
    if not time[-1] - time[0] > NO_TIME:
        raise ValueError(
            "nothing in this history takes time, so it has no rates: "
            "give a leg a rate, a speed or a hold"
        )
    at, energy, change = rate_by_leg(time, history["strain_energy_density"].values, leg)
    rates = np.array(
        [
            law(energy, change) if isinstance(law, ImpulseRate) else law(change)
            for law in laws.values()
        ]
    )
    places = list(np.ndindex(rates.shape[0], rates.shape[2]))
    seeds = np.random.SeedSequence(seed).spawn(len(places))
    trains = [
        impulses(at, rates[kind, :, receptor], variation, None if seed is None else own)
        for (kind, receptor), own in zip(places, seeds, strict=True)
    ]
    times = np.full((*rates.shape[::2], max(map(len, trains), default=0)), np.nan)
    for place, train in zip(places, trains, strict=True):
        times[place][: len(train)] = train
    counts, of_all = np.isfinite(times).sum(2), ("afferent", "receptor")
    sent = xr.Dataset(
        {
            "impulse_rate": (("afferent", "response_time", "receptor"), rates),
            "impulses": (of_all, counts),
            "impulse_time": ((*of_all, "impulse"), times),
        },
        {
            "afferent": list(laws),
            "response_time": apart(at),
            "receptor_depth": history.receptor_depth,
            "receptor_offset": history.receptor_offset,
        },
        {"laws": "; ".join(f"{name}: {law}" for name, law in laws.items())},
    )
    for name, (unit, long_name) in _SENT.items():
        sent[name].attrs = {"units": unit, "long_name": long_name}
    return sent


def _law(name: str) -> ImpulseRate | RapidlyAdapting:
    if name not in AFFERENTS:
        raise ValueError(f"no afferent called {name!r}; known: {', '.join([*AFFERENTS, *NAMES])}")
    return AFFERENTS[name]
