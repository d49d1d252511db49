"""What of a measured profile a mesh can feel, and what its smoothing may change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.planning.estimates import ContactEstimate, PadEstimate, layer_kernel
from fingerpad.stimuli.smoothing import WAVE

if TYPE_CHECKING:
    from fingerpad.stimuli.profile import Profile


#: Share of the steepest slope near the cut-off that comes to bear on the pressure at a node.
FELT = 0.5


@dataclass(frozen=True)
class Surface:
    """What a mesh makes of a measured profile.

    Attributes:
        smoothing: m, cut-off wavelength of the filter it goes through; 0 where nothing is finer than the mesh. moved: m, largest
        change of its heights within reach of the pad. error: relative, what the waves near the cut-off may change of depth and
        pressure. end: m, x of the last point, where contact is expected to reach it.
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
            out.append(
                f"the profile was smoothed at {self.smoothing * 1e6:.3g} um, which moved it by up to {self.moved * 1e6:.2g} um; "
                f"that may change depth and pressure by {self.error:.1%}"
            )
        if self.end is not None:
            out.append(f"contact is expected to reach the end of the profile's points at x = {self.end * 1e3:.3g} mm")
        return out


def surface_of(
    profile: Profile,
    edge: float,
    way: tuple[float, float],
    pad: PadEstimate,
    pressed: Callable[[float], ContactEstimate],
    allowed: float = 0.0,
) -> Surface:
    """How ``profile`` comes to skin with nodes ``edge`` m apart.

    A wave of slope s in a stiff skin takes a pressure of E* s / 2 to flatten it (Johnson 1985, section 13.2): the slopes that one
    more octave of smoothing would take away, against the mean pressure of the contact, are what noise may still change. Of the
    cut-offs that come into question the shortest with an error that is allowed is taken, or else the one with the least: a finer
    mesh feels finer shapes, but where they are noise it would only find more of it.

    Args:
        way: m, least and largest x of the profile that comes over the pad's apex. pressed: the deepest contact with a surface of
            a curvature (1/m). allowed: relative error that may be left to the profile.
    """
    if not np.isfinite(profile.known).all():
        return Surface()
    felt, curvature = profile.felt(edge), 0.0
    for _ in range(3):
        contact = pressed(curvature)
        curvature = max(felt.bulge(way[0], contact.half_width), 0.0)
    half, radius = contact.half_width, 1 / (1 / pad.apex_radius + curvature)
    first, last = way[0] - 1.2 * half, way[1] + 1.2 * half
    ends = [end for end, over in zip(profile.known, (profile.known[0] - first, last - profile.known[1]), strict=True) if over > 0]
    end = min(ends, key=abs, default=None)
    cutoffs = profile.cutoffs(edge)
    if cutoffs == [0.0]:
        return Surface(end=end)
    modulus = pad.stiff / layer_kernel(min(pad.soft / pad.stiff, 0.999), pad.epidermis_thickness / half + 0.65)
    pressure = np.pi / 8 * modulus * half / radius

    def smoothed(cutoff):
        felt, longer = profile.at(cutoff, edge), max(2 * cutoff, WAVE * edge)
        x = np.linspace(first, last, int((last - first) / (longer / 2) * 16) + 33)
        slope = np.gradient(felt.outline(x) - profile.at(longer, edge).outline(x), x)
        slope = np.nanmax(np.abs(slope)) if np.isfinite(slope).any() else 0.0
        moved = felt.moved(first, last)
        error = FELT * slope * pad.stiff / 2 / pressure + moved / max(contact.depth, 1e-9)
        return Surface(cutoff, moved, float(error), end)

    found = []
    for cutoff in cutoffs:
        found.append(smoothed(cutoff))
        if found[-1].error <= allowed:
            return found[-1]
    return min(found, key=lambda surface: surface.error)
