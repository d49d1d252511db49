"""Fit of the Prony series to ramp-and-hold force, through separability.

Under a prescribed depth d(t) the force is nearly the hereditary integral of the elastic curve
(quasi-linear viscoelasticity: Fung 1993), ``F(t) = s l [f(d(t)) + sum_j b_j int exp(-(t -
t')/theta_j) df(d(t'))]``, so a fit needs no simulation. The terms (b, theta) of the force are those
of the shear modulus (beta, tau) in series with a volume change that does not relax; how much of it
there is, the two elastic curves of the long-term and the instantaneous reading of the moduli tell.
What separability leaves out is corrected with one full simulation at the fitted series: its ratio
to the hereditary force multiplies the hereditary force of a second fit.

No measured time courses are at hand: the force fitted to is simulated, with the thesis's series,
and noise of a known size is added. Of measured relaxation there are time constants only (Pawluk and
Howe 1999, no amplitudes); for them the study says how well amplitudes could be told from such a
force, and invents none.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr
from scipy.optimize import nnls

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.reference_data import read_relaxation
from cysyk1999.studies.calibration.force import ESTIMATE_COLUMNS, ElasticCurve
from cysyk1999.studies.calibration.least_squares import Fit, fit
from fingerpad import load_scene, plan, simulate
from fingerpad.scenes.scene import PronyTerm, Scene
from fingerpad.specimen import read_pad_mesh
from fingerpad.specimen.materials import Prony
from fingerpad.stimuli.motion import geometric

NOISE = 0.005
"""Standard deviation of the noise added to the simulated force, over the largest force."""
SEED = 1999
WRONG_START = {"s": 0.5, "beta_1": 0.3, "tau_1": 10.0, "beta_2": 0.3, "tau_2": 0.05}
"""Where fits of two terms start: far from the thesis's series."""
SPEEDS = (2.0, 8.0, 32.0)
"""Speeds of the ramps, mm/s, for which the amplitudes' errors are foretold (thesis Fig 3-9)."""

FullForce = Callable[[Prony], np.ndarray]


def relaxing_part(
    time: np.ndarray, elastic: np.ndarray, tau: float
) -> tuple[np.ndarray, np.ndarray]:
    """Hereditary integral int exp(-(t - t')/tau) dF(t') of a force that is linear between samples,
    and its derivative by tau.

    Args:
        time: (n,) s, increasing, from the unloaded state. elastic: (n,) elastic force at these
        times. tau: s.
    """
    step, rise = np.diff(time), np.diff(elastic)
    x = step / tau
    decay = np.exp(-x)
    gamma = -np.expm1(-x) / x
    slope = (decay * x + np.expm1(-x)) / x**2 * (-x / tau)  # of gamma by tau
    value, change = np.zeros(len(time)), np.zeros(len(time))
    for k in range(len(step)):
        value[k + 1] = decay[k] * value[k] + gamma[k] * rise[k]
        change[k + 1] = decay[k] * (change[k] + x[k] / tau * value[k]) + slope[k] * rise[k]
    return value, change


def volume_share(curve: ElasticCurve, other: ElasticCurve, depth: float, ratio: float) -> float:
    """Share k of volume change in the pad's yielding to a plate: force is ``~ G / (1 + k
    G/G_inf)``, bulk modulus fixed.

    Args:
        curve: elastic curve at the shear modulus G_inf. other: at `ratio` * G_inf and the same bulk
        modulus, which is what the other reading of the moduli, long-term or instantaneous, leaves
        in the steady state. depth: m.
    """
    rise = float(other.force_at(depth) / (ratio * curve.force_at(depth)))
    return (rise - 1) / (1 - rise * ratio)


def force_terms(
    beta: Sequence[float], tau: Sequence[float], share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Terms (b, theta) of the relaxation of force under a held depth, fastest last, from those of
    the shear modulus.

    The force's modulus over its steady value is ``(1 + k) G / (1 + k G)``, G(p) = 1 + sum beta p/(p
    + 1/tau) the shear modulus over its long-term value at the Laplace variable p and k the share: a
    rational function, split into partial fractions.
    """
    rate = 1 / np.asarray(tau, float)
    below = np.poly(-rate)
    above = below.copy()
    for k, b in enumerate(beta):
        above = np.polyadd(above, b * np.polymul([1.0, 0.0], np.poly(-np.delete(rate, k))))
    whole = np.polyadd(below, share * above)
    poles = -np.sort(-np.roots(whole).real)
    strength = (
        (1 + share) * np.polyval(above, poles) / (poles * np.polyval(np.polyder(whole), poles))
    )
    return strength, -1 / poles


class RampForce:
    """Hereditary force of a programme of depths, for any series, with sensitivities.

    Args:
        curve: the elastic curve. time: (n,) s, from 0. depth: (n,) m. length: contact length, m.
        share: of volume change, see :func:`volume_share`. ratio: (n,) full over hereditary force,
        the correction (default: none). Between samples the depth is taken as linear.
    """

    refinement = 4

    def __init__(
        self,
        curve: ElasticCurve,
        time,
        depth,
        length: float,
        share: float = 0.0,
        ratio: np.ndarray | float = 1.0,
    ):
        self.curve, self.time, self.depth, self.length = (
            curve,
            np.asarray(time),
            np.asarray(depth),
            length,
        )
        self.share, self.ratio = share, ratio
        place = np.arange(len(self.time) * self.refinement - self.refinement + 1) / self.refinement
        self.fine = np.interp(place, np.arange(len(self.time)), self.time)
        self.elastic = length * curve.force_at(np.interp(self.fine, self.time, self.depth))

    def corrected(self, ratio: np.ndarray) -> RampForce:
        """The same with a correction."""
        return RampForce(self.curve, self.time, self.depth, self.length, self.share, ratio)

    def branch(self, tau: float) -> tuple[np.ndarray, np.ndarray]:
        """What a branch of unit strength adds to the force (N), and its derivative by tau, at the
        samples.
        """
        value, change = relaxing_part(self.fine, self.elastic, tau)
        return self.ratio * value[:: self.refinement], self.ratio * change[:: self.refinement]

    def base(self) -> np.ndarray:
        """Force of the long-term network, N."""
        return self.ratio * self.elastic[:: self.refinement]

    def force(self, prony: Prony) -> np.ndarray:
        """Force of a series on the long-term moduli of the elastic curve, N."""
        terms = zip(*force_terms(prony.beta, prony.tau, self.share), strict=True)
        return self.base() + sum(
            (b * self.branch(theta)[0] for b, theta in terms), start=np.zeros(len(self.time))
        )

    def model(self, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Force and sensitivities to (s, beta_1, tau_1, beta_2, tau_2, ...) in one pass."""
        s, count = parameters[0], (len(parameters) - 1) // 2

        def terms(p):
            return np.concatenate(force_terms(p[::2], p[1::2], self.share))

        now = terms(parameters[1:])
        total, by_term = self.base().copy(), np.empty((len(self.time), 2 * count))
        for j in range(count):
            value, change = self.branch(now[count + j])
            total += now[j] * value
            by_term[:, j], by_term[:, count + j] = value, now[j] * change
        shift = 1e-6 * np.diag(
            parameters[1:]
        )  # a few roots of a small polynomial, no evaluation of the integral
        chain = np.array(
            [(terms(parameters[1:] + h) - terms(parameters[1:] - h)) / (2 * h.sum()) for h in shift]
        )
        return s * total, np.column_stack([total, s * by_term @ chain.T])


def series_of(found: Fit) -> Prony:
    """The Prony series of a fit (s, beta, tau, ...), slowest term first: g_i = beta_i / (1 + sum
    beta).
    """
    pairs = sorted(found.values[1:].reshape(-1, 2).tolist(), key=lambda pair: -pair[1])
    whole = 1 + sum(beta for beta, _ in pairs)
    return Prony(tuple(beta / whole for beta, _ in pairs), tuple(tau for _, tau in pairs))


def series_estimates(found: Fit) -> dict[str, tuple[float, float, float]]:
    """g and tau of each term with 95 % intervals, slowest first, and s."""
    order = np.argsort(-found.values[2::2])
    out = {"modulus constant": (found.values[0], *found.intervals()[0])}
    for rank, k in enumerate(order, start=1):
        out[f"g_{rank}"] = found.derived(lambda p, k=k: p[1 + 2 * k] / (1 + p[1::2].sum()))
        out[f"tau_{rank}"] = (found.values[2 + 2 * k], *found.intervals()[2 + 2 * k])
    return out


@dataclass(frozen=True)
class PronyFit:
    """Fit by the hereditary integral alone, fit after the correction, the corrected model, and how
    often each was evaluated.
    """

    hereditary: Fit
    corrected: Fit
    model: RampForce
    simulations: int


def fit_series(
    model: RampForce,
    force: np.ndarray,
    full: FullForce,
    *,
    start: Mapping[str, float] = WRONG_START,
    sigma: float | None = None,
) -> PronyFit:
    """Fit s and a Prony series to a force (N) at the samples of `model` (the first, unloaded, is
    left out).

    Args:
        full: simulates the whole force, N, of a series on the moduli of the elastic curve; called
        once. start: s, then beta and tau of each term. sigma: N, of the noise; None takes it from
        the scatter.
    """

    def fitted(which: RampForce, begin) -> Fit:
        def loaded(p):
            value, slope = which.model(p)
            return value[1:], slope[1:]

        return fit(loaded, np.asarray(force)[1:], begin, sigma=sigma)

    first = fitted(model, dict(start))
    series = series_of(first)
    ratio = np.ones(len(model.time))
    ratio[1:] = full(series)[1:] / model.force(series)[1:]
    better = model.corrected(ratio)
    second = fitted(better, dict(zip(first.names, first.values, strict=True)))
    return PronyFit(first, second, better, 1)


def with_series(scene: Scene, prony: Prony) -> Scene:
    """The scene with another Prony series, its long-term moduli kept."""
    terms = tuple(PronyTerm(g=g, tau=tau) for g, tau in zip(prony.g, prony.tau, strict=True))
    return scene.varied({"specimen.prony": terms})


def amplitude_design(
    curve: ElasticCurve,
    depth: float,
    speed: float,
    taus: Sequence[float],
    end: float = 10.0,
    samples: int = 30,
):
    """Sensitivities (2 samples, 1 + terms) of a ramp-and-hold force over the held elastic force, to
    log s and to each beta.

    The force is linear in the amplitudes beta, so these do not depend on them at beta = 0, and nor
    does what the force tells.

    Args:
        depth: m. speed: m/s. taus: s. end: s, of the hold. samples: in the ramp, and as many in the
        hold, as in the scene.
    """
    ramp = depth / speed
    time = np.concatenate([[0.0], ramp * np.arange(1, samples + 1) / samples])
    time = np.concatenate([time, ramp + np.cumsum(geometric(end - ramp, samples, ramp / samples))])
    model = RampForce(curve, time, np.minimum(speed * time, depth), 1.0)
    columns = [model.base(), *(model.branch(tau)[0] for tau in taus)]
    return np.column_stack(columns)[1:] / model.base()[-1]


# -- data frames -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Relaxation:
    """What the study makes: the plotted data and the estimates."""

    prony: pd.DataFrame
    estimates: pd.DataFrame


def study(
    plate: xr.Dataset, other: xr.Dataset, ramp: xr.Dataset, constants: pd.DataFrame, full: FullForce
) -> Relaxation:
    """Fit the series to the simulated force of `ramp`, and say what it tells of the measured time
    constants.

    Args:
        plate, other, ramp: histories of the scenes ``calibration_{plate,long_term,ramp_hold}``.
        constants: of
        :func:`cysyk1999.reference_data.read_relaxation`. full: see :func:`fit_series`.
    """
    specimen = json.loads(ramp.attrs["scene"])["specimen"]
    truth = Prony(
        tuple(t["g"] for t in specimen["prony"]), tuple(t["tau"] for t in specimen["prony"])
    )
    length, curve = specimen["contact_length"], ElasticCurve.from_history(plate)
    time, depth, clean = ramp.time.values, ramp.indentation_depth.values, ramp.force.values * length
    states = [json.loads(h.attrs["scene"])["specimen"]["moduli"] for h in (plate, other)]
    ratio = {"long_term": 1.0, "instantaneous": truth.g_infinity}  # what is left of the moduli
    share = volume_share(
        curve,
        ElasticCurve.from_history(other),
        float(depth.max()),
        ratio[states[1]] / ratio[states[0]],
    )
    model = RampForce(curve, time, depth, length, share)
    sigma = NOISE * clean.max()
    noisy = clean + np.concatenate(
        [[0.0], np.random.default_rng(SEED).normal(0.0, sigma, len(clean) - 1)]
    )
    found = fit_series(model, noisy, full, sigma=sigma)
    taus = constants.loc[constants["series"] == "pawluk_howe", "tau_s"].tolist()
    fixed = np.column_stack([model.base(), *(model.branch(tau)[0] for tau in taus)])[1:]
    amplitudes, _ = nnls(fixed, noisy[1:])
    curves = {
        "thesis's series, simulated": clean,
        "thesis's series, hereditary": model.force(truth),
        "fitted, hereditary": model.model(found.hereditary.values)[0],
        "fitted, corrected": found.model.model(found.corrected.values)[0],
        "Pawluk and Howe's constants": np.concatenate([[0.0], fixed @ amplitudes]),
    }
    rows = [
        pd.DataFrame(
            {
                "panel": "force",
                "series": "with noise",
                "source": "simulated, noise added",
                "time (s)": time,
                "force (N)": noisy,
            }
        )
    ]
    for name, force in curves.items():
        off = 100 * (force - clean) / clean.max()
        rows.append(
            pd.DataFrame(
                {
                    "panel": "force",
                    "series": name,
                    "source": "simulated",
                    "time (s)": time,
                    "force (N)": force,
                    "difference (% of the peak)": off,
                }
            )
        )
    told = _told(curve, float(depth.max()), taus, curve_peak=clean.max() / clean[-1])
    return Relaxation(
        pd.concat([*rows, told], ignore_index=True),
        _estimates(model, clean, truth, found, told, amplitudes, fixed, noisy, sigma, taus),
    )


def _told(curve, depth, taus, curve_peak) -> pd.DataFrame:
    """95 % half-width of each amplitude over the long-term modulus, for the noise of this study, by
    speed of the ramp.
    """
    rows = []
    for speed in SPEEDS:
        design = amplitude_design(curve, depth, speed * 1e-3, taus)
        covariance = np.linalg.inv(design.T @ design) * (NOISE * curve_peak) ** 2
        for k, tau in enumerate(taus, start=1):
            rows.append(
                {
                    "panel": "amplitudes",
                    "series": f"{speed:g} mm/s",
                    "source": "simulated",
                    "tau (s)": tau,
                    "half_width (1)": 1.96 * np.sqrt(covariance[k, k]),
                    "largest share of force (1)": design[:, k].max(),
                }
            )
    return pd.DataFrame(rows)


def _estimates(
    model, clean, truth, found, told, amplitudes, fixed, noisy, sigma, taus
) -> pd.DataFrame:
    rows = []

    def add(study, quantity, values, units, used=None, note="", subject="simulated force"):
        value, low, high = values if isinstance(values, tuple) else (values, np.nan, np.nan)
        row = {
            "study": study,
            "subject": subject,
            "quantity": quantity,
            "estimate": value,
            "low_95": low,
            "high_95": high,
        }
        row |= {"units": units, "note": note}
        if used is not None:
            row |= {"data": used.count, "rss (N2)": used.rss}
        rows.append(row)

    for k, (g, tau) in enumerate(zip(truth.g, truth.tau, strict=True), start=1):
        add(
            "Prony series: stated in the thesis",
            f"g_{k}",
            g,
            "1",
            note="the series behind the force fitted to",
            subject="thesis",
        )
        add("Prony series: stated in the thesis", f"tau_{k}", tau, "s", subject="thesis")
    note = (
        f"force simulated with the thesis's series, noise {NOISE:.1%} of the peak (seed "
        f"{SEED}); no measured time courses at hand"
    )
    for title, used in (
        ("Prony series: hereditary integral alone", found.hereditary),
        ("Prony series: corrected by one simulation", found.corrected),
    ):
        for quantity, values in series_estimates(used).items():
            add(title, quantity, values, "s" if quantity.startswith("tau") else "1", used, note)
            note = ""
        order = np.argsort(-used.values[2::2])
        slow = [1 + 2 * order[0], 2 + 2 * order[0]]
        add(
            title,
            "correlation of log beta_1 and log tau_1",
            float(used.correlation[slow[0], slow[1]]),
            "1",
        )
    add(
        "Prony series: separability",
        "share of volume change",
        model.share,
        "1",
        note="from the elastic curves of both readings of the moduli",
    )
    worst = 100 * np.abs(model.force(truth) - clean).max() / clean.max()
    add(
        "Prony series: separability",
        "largest error of the hereditary integral",
        worst,
        "% of the peak",
        note="against the full simulation with the same series",
    )
    misfit = float(np.sqrt(np.mean((noisy[1:] - fixed @ amplitudes) ** 2)) / sigma)
    for k, tau in enumerate(taus, start=1):
        add(
            "time constants of Pawluk and Howe",
            f"amplitude at {tau:g} s over the steady force",
            amplitudes[k] / amplitudes[0],
            "1",
            note="fitted to the thesis's force, at least 0; not an amplitude of Pawluk and Howe, who state none"
            if k == 1
            else "",
        )
    add("time constants of Pawluk and Howe", "rms misfit over noise", misfit, "1")
    for record in told.to_dict("records"):
        study = f"amplitudes told by a ramp at {record['series']}"
        quantity = f"95 % half-width of the amplitude at {record['tau (s)']:g} s"
        share = record["largest share of force (1)"]
        note = (
            f"for noise of {NOISE:.1%}; a branch of unit strength adds at most {share:.3g} of "
            "the held force"
        )
        add(study, quantity, record["half_width (1)"], "1", note=note)
    add(
        "cost",
        "finite element simulations for the series",
        float(found.simulations),
        "1",
        note="beside the elastic curve",
        subject="",
    )
    return pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)


def calibrate_prony(job: SimpleNamespace) -> None:
    """Job: `relaxation`, `histories` of plate, long_term and `scene`, its `mesh`, `accuracy` -> `data`:
    prony, estimates.
    """
    scene, mesh = load_scene(job.scene[0]), read_pad_mesh(job.mesh[0])
    if job.accuracy != ["as_stated"]:
        scene = scene.with_accuracy(job.accuracy[0])
    how = plan(scene)

    def full(prony):
        return (
            simulate(with_series(scene, prony), how, mesh=mesh).force.values
            * scene.specimen.contact_length
        )

    histories, _, _ = read_results(job.histories)
    plate, other, held = (histories[Path(path).parent.name] for path in job.histories)
    result = study(plate, other, held, read_relaxation(job.relaxation[0]), full)
    for path, frame in zip(job.data, (result.prony, result.estimates), strict=True):
        write_frame(frame, Path(path))
