"""A material point of a linear viscoelastic solid whose relaxation modulus is a Prony series.

G(t) = G_0 [1 - sum g_i (1 - exp(-t/tau_i))]: ``g`` are shares of the *instantaneous* modulus G_0,
``tau`` in s. All results are exact, so a time integrator can be asked for round-off at any step
size. Sources: R. M. Christensen, *Theory of Viscoelasticity* (1982), chapters 1-3; J. C. Simo & T.
J. R. Hughes,
*Computational Inelasticity* (1998), section 10.3.
"""

import numpy as np


def _series(g, tau):
    g, tau = np.atleast_1d(np.asarray(g, dtype=float)), np.atleast_1d(np.asarray(tau, dtype=float))
    if g.shape != tau.shape or g.ndim != 1:
        raise ValueError("g and tau must be sequences of the same length")
    if np.any(g < 0) or g.sum() >= 1:
        raise ValueError("g must not be negative and must sum to less than one")
    return g, tau


def relaxation(t, g, tau):
    """Relaxation function G(t)/G_0, of the shape of ``t`` (s, >= 0): 1 at once, 1 - sum g in the
    long term.

    Raises ``ValueError`` for a negative g, sum g >= 1 or unequal lengths (all functions
    here do).
    """
    g, tau = _series(g, tau)
    t = np.asarray(t, dtype=float)[..., None]
    return 1 + (g * np.expm1(-t / tau)).sum(-1)


def creep_terms(g, tau):
    """Shares ``j`` and retardation times ``theta`` (s) of the creep function.

    G_0 J(t) = 1 + sum j_k (1 - exp(-t/theta_k)). The generalised Maxwell solid under constant
    stress is a linear system with a symmetric matrix; its eigenvalues are -1/theta_k. Arrays of the
    length of ``g``. One term: theta = tau/(1 - g), j = g/(1 - g).
    """
    g, tau = _series(g, tau)
    drive = np.sqrt(g / tau)
    rates, modes = np.linalg.eigh(np.diag(1 / tau) - np.outer(drive, drive))
    return (modes.T @ drive) ** 2 / rates, 1 / rates


def creep(t, g, tau):
    """Creep function G_0 J(t), of the shape of ``t`` (s, >= 0): 1 at once, 1/(1 - sum g) in the
    long term.
    """
    j, theta = creep_terms(g, tau)
    t = np.asarray(t, dtype=float)[..., None]
    return 1 - (j * np.expm1(-t / theta)).sum(-1)


def _hereditary(times, values, final, shares, decay_times):
    """Integral of [final + sum shares exp(-(t - s)/decay_times)] dv(s), exact for piecewise linear
    v.
    """
    times, values = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    if times.ndim != 1 or times.shape != values.shape or np.any(np.diff(times) < 0):
        raise ValueError("times must be one-dimensional and not decrease, values of the same shape")
    memory = shares * values[0]
    result = [final * values[0] + memory.sum()]
    for step, increment, value in zip(np.diff(times), np.diff(values), values[1:], strict=True):
        x = step / decay_times
        memory = np.exp(-x) * memory + shares * increment * (-np.expm1(-x) / x if step > 0 else 1.0)
        result.append(final * value + memory.sum())
    return np.array(result)


def stress_from_strain(times, strains, g, tau, modulus=1.0):
    """Stress at ``times`` for the strain history that is linear between the samples, Pa, shape
    ``(n,)``.

    The strain jumps from zero to ``strains[0]`` at ``times[0]``; a repeated time is a jump.
    ``modulus`` is the instantaneous one of the stress-strain pair (G_0 for tensor strain gives half
    the shear stress: use 2 G_0).
    Raises ``ValueError`` for times that decrease or unequal shapes.
    """
    g, tau = _series(g, tau)
    return modulus * _hereditary(times, strains, 1 - g.sum(), g, tau)


def strain_from_stress(times, stresses, g, tau, modulus=1.0):
    """Strain at ``times`` for the stress history that is linear between the samples, shape
    ``(n,)``.

    Counterpart of :func:`stress_from_strain`; exact likewise.
    """
    j, theta = creep_terms(g, tau)
    return _hereditary(times, stresses, 1 + j.sum(), -j, theta) / modulus


def storage_and_loss(frequency, g, tau):
    """Storage and loss moduli over G_0 at the angular ``frequency`` (rad/s), each of its shape."""
    g, tau = _series(g, tau)
    x = np.asarray(frequency, dtype=float)[..., None] * tau
    return 1 - g.sum() + (g * x**2 / (1 + x**2)).sum(-1), (g * x / (1 + x**2)).sum(-1)


def dissipation_per_cycle(amplitude, frequency, g, tau, modulus=1.0):
    """Energy lost in one steady cycle of strain ``amplitude``, pi amplitude^2 G''(frequency),
    J/m^3.
    """
    return np.pi * amplitude**2 * modulus * storage_and_loss(frequency, g, tau)[1]
