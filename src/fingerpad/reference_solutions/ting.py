"""Contact of any linear viscoelastic body with one relaxation function, from its elastic
force-depth curve.

When every layer relaxes with the same function of time (one Prony series, Poisson's ratio constant
in time), the strains are small, there is no friction and the contact does not shrink, time and
space separate: pressures in the viscoelastic body are those of an elastic one under the force
F_e(delta), and F = int g(t - s) dF_e(delta(s)). Sources: T. C. T. Ting (1966, 1968); G. A. C.
Graham (1967); J. M. Golden & G. A. C. Graham (1988). ``elastic`` forces here are those of the body
with its *instantaneous* moduli.
"""

import numpy as np

from . import prony_point


def force_under_depth_control(times, elastic_forces, g, tau):
    """Force at ``times``, N/m, shape ``(n,)``, from the elastic forces F_e at the depths of those
    times.

    The elastic force is taken as linear in time between the samples: sample finely where the depth
    ramps.
    Raises ``ValueError`` when the elastic force decreases (the contact would shrink), or for bad
    series.
    """
    elastic_forces = np.asarray(elastic_forces, dtype=float)
    if np.any(np.diff(elastic_forces) < 0):
        raise ValueError("the elastic force must not decrease: the contact must not shrink")
    return prony_point.stress_from_strain(times, elastic_forces, g, tau)


def elastic_force_under_force_control(times, forces, g, tau):
    """Elastic force F_e(delta(t)) = int J(t - s) dF(s) at ``times``, N/m, (n,), for applied
    ``forces``.

    Exact for a force linear between the samples. The depth at t is where the elastic curve reaches
    this force; contact width and the shape of the pressure are those of the elastic contact there.
    Raises ``ValueError`` when the elastic force decreases by more than round-off.
    """
    elastic = prony_point.strain_from_stress(times, forces, g, tau)
    if np.any(np.diff(elastic) < -1e-12 * np.max(np.abs(elastic))):
        raise ValueError("the elastic force must not decrease: the contact must not shrink")
    return elastic
