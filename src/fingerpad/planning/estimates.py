"""Back-of-the-envelope contact mechanics: what the planner knows before anything is solved.

A line contact on a stiff layer over a soft half-plane: Hertz's half-width with a modulus that falls
from the epidermis' to the fat's as the contact outgrows the epidermis, through the kernel of a
layered incompressible half-plane. Within about a tenth of the simulated widths and a fifth of the
depths of the thesis's nine shapes; good enough to place a fine mesh and to say how large strains
will be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

_CLOSE = 1e-12
"""Of a half-width or a force, near enough to that sought."""


def layer_kernel(stiffness_ratio: float, wavenumber: float) -> float:
    """Surface compliance of a layer (modulus 1) on a half-plane (modulus ``stiffness_ratio``) over
    that of the layer alone.

    Both incompressible, bonded, loaded by a cosine pressure of ``wavenumber`` k times the layer's
    thickness h.
    """
    alpha = (1 - stiffness_ratio) / (1 + stiffness_ratio)
    e2, e4 = np.exp(-2 * wavenumber), np.exp(-4 * wavenumber)
    upper = 1 + 4 * alpha * wavenumber * e2 - alpha**2 * e4
    return float(upper / (1 - 2 * alpha * (1 + 2 * wavenumber**2) * e2 + alpha**2 * e4))


@dataclass(frozen=True)
class ContactEstimate:
    """Half-width m, depth m and representative strain of a pressed line contact.

    ``narrowest`` is the half-width m of the least piece of it that has to be resolved: of a face, a
    tip or a bump (None: the whole contact).
    """

    half_width: float = 0.0
    depth: float = 0.0
    strain: float = 0.0
    narrowest: float | None = None


@dataclass(frozen=True)
class PadEstimate:
    """What the estimate needs to know of a pad, SI: apex radius, epidermis and soft thickness,
    plane moduli E/(1 - nu^2).
    """

    apex_radius: float
    epidermis_thickness: float
    soft_thickness: float
    stiff: float
    soft: float

    def pressed(self, force: float, curvature: float) -> ContactEstimate:
        """Contact under ``force`` N/m by a profile of ``curvature`` 1/m at its lowest point."""
        radius = 1 / (1 / self.apex_radius + max(curvature, 0.0))
        ratio = min(self.soft / self.stiff, 0.999)
        half_width = np.sqrt(4 * force * radius / (np.pi * self.stiff))
        for _ in range(60):
            # the shift stands for the bone: contacts much wider than the epidermis feel a finite
            # thickness
            wavenumber = self.epidermis_thickness / half_width + 0.65
            modulus = self.stiff / layer_kernel(ratio, wavenumber)
            wider = np.sqrt(4 * force * radius / (np.pi * modulus))
            before, half_width = half_width, 0.5 * (half_width + wider)
            if abs(half_width - before) <= _CLOSE * half_width:
                break
        thick = max(np.log(self.soft_thickness / half_width), 0.0) + 2.5
        depth = force / (2 * np.pi * self.soft) * thick
        strain = max(0.65 * half_width / radius, depth / self.soft_thickness)
        return ContactEstimate(float(half_width), float(depth), float(strain))

    def pressed_to(self, depth: float, curvature: float) -> ContactEstimate:
        """Contact at ``depth`` m: the force is sought first."""
        return self.pressed(self.force_of(depth, curvature), curvature)

    def force_of(self, depth: float, curvature: float = 0.0) -> float:
        """Force (N/m) that presses to ``depth`` m."""

        def depth_of(log_force):
            return self.pressed(np.exp(log_force), curvature).depth

        least, most = np.log(1e-30), np.log(1e6)
        depth = np.clip(depth, depth_of(least), depth_of(most))
        return float(np.exp(brentq(lambda x: depth_of(x) - depth, least, most, xtol=_CLOSE)))

    def on_rounding(self, force: float, flat: float, radius: float) -> float:
        """How far (m) the contact of a face reaches into the rounding of its edge.

        Ciavarella, Hills and Monno 1998, J. Mech. Eng. Sci. 212, eq. 11, on a half-plane as stiff
        as the epidermis.

        Parameters
        ----------
        force
            N/m.
        flat
            m, half-width of the face between the roundings.
        radius
            m, of these.
        """
        load = 2 * force * radius / self.stiff
        if flat < 1e-3 * radius:
            return float(min(np.sqrt(2 * load / np.pi), radius))

        # between the edge of the face and that of the contact, seen on the circle over it
        def excess(angle):
            return flat**2 * (angle / np.cos(angle) ** 2 - np.tan(angle)) - load

        top = np.arccos(flat / (flat + radius))
        if excess(top) <= 0:
            return radius
        angle = brentq(excess, 0.0, top)
        return float(flat * (1 / np.cos(angle) - 1))

    def least_piece(
        self, force: float, outline: Callable[[np.ndarray], np.ndarray], low: float, high: float
    ) -> float:
        """Half-width (m) of the narrowest piece of a contact somewhere in ``low`` to ``high`` m
        along a surface.

        A surface bulges the more the smaller the length over which that is asked. A bump that is
        wider than the contact it would make alone stands out; what is narrower is flattened, and
        counts as part of what is wider.

        Parameters
        ----------
        force
            N/m.
        outline
            Height of the surface (n,) m at (n,) m; NaN where there is none.
        """
        widest = self.pressed(force, 0.0).half_width
        least = widest
        for scale in widest * 0.5 ** np.arange(0.0, 12.0, 0.5):
            middles = np.linspace(low, high, int(np.clip(4 * (high - low) / scale, 3, 4000)) | 1)
            sides = np.stack([outline(middles + shift) for shift in (-scale, 0.0, scale)])
            # a steep flank is no sharper for being steep
            slope = (sides[2] - sides[0]) / (2 * scale)
            bends = (sides[0] + sides[2] - 2 * sides[1]) / (scale**2 * (1 + slope**2) ** 1.5)
            bend = np.nanmax(np.where(np.isnan(bends), -np.inf, bends))
            alone = self.pressed(force, float(max(bend, 0.0))).half_width
            least = min(least, alone if alone <= scale else np.inf)
        return float(least)
