"""Back-of-the-envelope contact mechanics: what the planner knows before anything is solved.

A line contact on a stiff layer over a soft half-plane: Hertz's half-width with a modulus that falls from the epidermis' to the
fat's as the contact outgrows the epidermis, through the kernel of a layered incompressible half-plane. Within about a tenth of
the simulated widths and a fifth of the depths of the thesis's nine shapes; good enough to place a fine mesh and to say how
large strains will be.
"""

from dataclasses import dataclass

import numpy as np


def layer_kernel(stiffness_ratio: float, wavenumber: float) -> float:
    """Surface compliance of a layer (modulus 1) on a half-plane (modulus ``stiffness_ratio``) over that of the layer alone.

    Both incompressible, bonded, loaded by a cosine pressure of ``wavenumber`` k times the layer's thickness h.
    """
    alpha = (1 - stiffness_ratio) / (1 + stiffness_ratio)
    e2, e4 = np.exp(-2 * wavenumber), np.exp(-4 * wavenumber)
    upper = 1 + 4 * alpha * wavenumber * e2 - alpha**2 * e4
    return float(upper / (1 - 2 * alpha * (1 + 2 * wavenumber**2) * e2 + alpha**2 * e4))


@dataclass(frozen=True)
class ContactEstimate:
    """Half-width m, depth m, mean pressure Pa and representative strain of a pressed line contact."""

    half_width: float
    depth: float
    strain: float


@dataclass(frozen=True)
class PadEstimate:
    """What the estimate needs to know of a pad, SI: apex radius, epidermis and soft thickness, plane moduli E/(1 - nu^2)."""

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
            # the shift stands for the bone: contacts much wider than the epidermis feel a finite thickness
            wavenumber = self.epidermis_thickness / half_width + 0.65
            modulus = self.stiff / layer_kernel(ratio, wavenumber)
            half_width = 0.5 * (half_width + np.sqrt(4 * force * radius / (np.pi * modulus)))
        depth = force / (2 * np.pi * self.soft) * (max(np.log(self.soft_thickness / half_width), 0.0) + 2.5)
        return ContactEstimate(
            float(half_width), float(depth), float(max(0.65 * half_width / radius, depth / self.soft_thickness))
        )

    def pressed_to(self, depth: float, curvature: float) -> ContactEstimate:
        """Contact at ``depth`` m: the force is sought first."""
        low, high = 1e-6, 1e6
        for _ in range(80):
            middle = np.sqrt(low * high)
            low, high = (middle, high) if self.pressed(middle, curvature).depth < depth else (low, middle)
        return self.pressed(np.sqrt(low * high), curvature)
