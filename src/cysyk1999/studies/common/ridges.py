"""Where the layers of a pad with ridges lie."""

from fingerpad.scenes.specimen import Outline, Ridges
from fingerpad.specimen import RidgedPad


def boundary(outline: Outline, ridges: Ridges | None, x: float) -> float:
    """Depth (m) at which the epidermis ends at the lateral position `x` (m, near the apex, of the
    boundary itself).
    """
    depth = outline.epidermis_thickness
    if ridges is None:
        return depth
    pad = RidgedPad(outline, ridges)
    for _ in range(8):
        depth = pad.interface + float(pad.interface_shift(x / (1 - depth / outline.apex_radius)))
    return depth
