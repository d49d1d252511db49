"""What of a measured profile a mesh can feel, and what its smoothing may change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import erf

import numpy as np

from fingerpad.planning.bounds import percent
from fingerpad.planning.effect import Case
from fingerpad.planning.estimates import ContactEstimate
from fingerpad.stimuli.smoothing import WAVE, finer_than

_FELT_BY_NOBODY = 0.05e-6  # m
_ROUGH = 0.3
_LESS_ROUGH = ": average several scans, or give a longer stimulus.smooth"


@dataclass(frozen=True)
class Surface:
    """What a mesh makes of a measured profile.

    Attributes
    ----------
    smoothing
        m, cut-off wavelength of the filter it goes through; 0 where nothing is finer than the mesh.
    moved
        m, largest change of its heights within reach of the pad.
    error
        Relative, what the waves near the cut-off may change of depth and pressure.
    end
        m, x of the last point, where contact is expected to reach it.
    """

    smoothing: float = 0.0
    moved: float = 0.0
    error: float = 0.0
    end: float | None = None

    @property
    def notes(self) -> list[str]:
        """What a person should know of it."""
        out = []
        if self.smoothing:
            moved = (
                f"up to {self.moved * 1e6:.2g} um"
                if self.moved > _FELT_BY_NOBODY
                else "less than 0.05 um"
            )
            said = (
                f"the profile was smoothed at {self.smoothing * 1e6:.3g} um, which moved it by "
                f"{moved}; "
                f"what is left of its roughness may change the pressure by {percent(self.error)}"
            )
            out.append(said + (_LESS_ROUGH if self.error > _ROUGH else ""))
        if self.end is not None:
            out.append(
                "contact is expected to reach the end of the profile's points at x = "
                f"{self.end * 1e3:.3g} mm"
            )
        return out


def touching_share(pressure: float, modulus: float, slope: float) -> float:
    """Share of a rough contact that touches, of a nominal pressure (Pa), a plane modulus (Pa) and
    the r.m.s. slope of its surface (Persson 2001, J. Chem. Phys. 115, eq. 61).
    """
    return erf(np.sqrt(2) * pressure / (modulus * slope)) if slope else 1.0


def surface_of(case: Case, edge: float, pressed: Callable[[float], ContactEstimate]) -> Surface:
    """How the profile comes to skin with nodes ``edge`` m apart.

    A wave of slope s in a stiff skin takes a pressure of E* s / 2 to flatten it (Johnson 1985,
    section 13.2): the slopes of the octave above the cut-off, against the pressure where it
    touches, and the heights of that octave, against the depth, are what noise may still change. Of
    the cut-offs that come into question the shortest with an error that is allowed is taken, or
    else the one with the least: a finer mesh feels finer shapes, but where they are noise it would
    only find more of it.

    Parameters
    ----------
    pressed
        The deepest contact with a surface of a curvature (1/m).
    """
    profile, stiff, way = case.scene.stimulus, case.pad.stiff, case.way
    if not np.isfinite(profile.known).all():
        return Surface()
    felt, curvature = profile.felt(edge), 0.0
    for _ in range(3):
        contact = pressed(curvature)
        curvature = max(felt.bulge(way[0], contact.half_width), 0.0)
    half = contact.half_width
    first, last = way[0] - 1.2 * half, way[1] + 1.2 * half
    low, high = profile.known
    ends = [end for end, reached in ((low, low > first), (high, high < last)) if reached]
    end = min(ends, key=abs, default=None)
    cutoffs = profile.cutoffs(edge)
    if cutoffs == [0.0]:
        return Surface(end=end)
    nominal = case.force / (2 * half)

    def smoothed(cutoff):
        felt, longer = profile.at(cutoff, edge), max(2 * cutoff, WAVE * edge)
        places = int((last - first) / (longer / 2) * 16) + 33
        x = np.linspace(*np.clip([first, last], low, high), places)
        fine = finer_than(x, felt.outline(x), longer)
        slope, steep = np.abs(np.gradient(fine, x)).max(), np.std(np.gradient(felt.outline(x), x))
        pressure = nominal / touching_share(nominal, stiff, float(steep))
        error = slope * stiff / 2 / pressure + np.ptp(fine) / 2 / max(contact.depth, 1e-9)
        return Surface(cutoff, felt.moved(first, last), float(error), end)

    found = []
    for cutoff in cutoffs:
        found.append(smoothed(cutoff))
        if found[-1].error <= case.rules.profile_share * case.tolerance:
            return found[-1]
    return min(found, key=lambda surface: surface.error)
