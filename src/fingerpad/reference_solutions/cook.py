"""Cook's membrane: a tapered panel, clamped left, uniform shear on its right edge. Small strain.

Corners (0, 0), (48, 44), (48, 60), (0, 44); ``total_load`` is the resultant over the right edge of
length 16. Plane strain. Sources: R. D. Cook (1974) for the problem; the value for nu = 1/3 is that
of CalculiX and Elmer (CoFEA initiative); the nearly incompressible ones were recomputed with
Taylor-Hood elements on graded and uniform 128 x 128 meshes (literature: Kasper & Taylor 2000, 7.769
for E = 250).
"""

from dataclasses import dataclass

MID_EDGE = (48.0, 52.0)
CORNER = (48.0, 60.0)


@dataclass(frozen=True)
class CookCase:
    """One row: moduli, load and the vertical displacement at (48, 52) and (48, 60); None where not
    known.
    """

    youngs_modulus: float
    poisson_ratio: float
    total_load: float
    mid_edge: float | None
    corner: float | None


CASES = {
    "plane_strain_compressible": CookCase(70.0, 1 / 3, 100.0, None, 32.28),
    "nearly_incompressible": CookCase(240.565, 0.4999, 100.0, 7.695, 8.073),
    "kasper_taylor": CookCase(250.0, 0.4999, 100.0, 7.405, 7.768),
}

#: Mid-edge displacement of n x n plain four-node quads for ``nearly_incompressible``: how locking
#: looks.
LOCKED_Q1 = {8: 2.22, 16: 2.41, 32: 2.96, 64: 4.17, 128: 5.80}
