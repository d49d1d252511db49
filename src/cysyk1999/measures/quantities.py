"""Every quantity of figures, tables and baselines, said once: its name and unit, its axis label,
how it is read of a history.

A quantity *is* the header of its column, ``"name (unit)"``, and can stand wherever such a text
can::

    frame[P_CENTRE]                         # the column "centre_pressure (Pa)"
    P_CENTRE.read(history)                  # its values over time, in the unit of the header
    ax.set_ylabel(P_CENTRE.label)
    SED.reading(energy_at(915e-6))          # the same column, read at a depth

A quantity that is added here has a header, an axis label and a tolerance of its baseline
everywhere.
"""

from __future__ import annotations

from cysyk1999.measures import steady
from fingerpad.measures import features, strokes
from fingerpad.measures.features import Trace


class Q(str):
    """A quantity; as a text, the header of its column.

    Parameters
    ----------
    name, unit
        As in the header ``"name (unit)"``; the unit is the one of every value.
    label
        What an axis says, with the unit; left out, the header.
    read
        ``read(history)``: values (time) in `unit`. None where a figure says how.
    checked
        Whether the errors of a figure count it.
    tolerance
        Largest difference of a column from its baseline, relative to the largest value of a curve;
        None: it has no baseline. Pressure and width carry the jumps of single nodes entering
        contact; everything else is smooth.
    """

    name: str
    unit: str
    label: str
    read: Trace | None
    checked: bool
    tolerance: float | None

    def __new__(
        cls,
        name: str,
        unit: str,
        label: str = "",
        read: Trace | None = None,
        checked: bool = True,
        tolerance: float | None = None,
    ) -> Q:
        self = super().__new__(cls, f"{name} ({unit})")
        self.name, self.unit, self.label, self.read = name, unit, label or str(self), read
        self.checked, self.tolerance = checked, tolerance
        return self

    def __reduce__(self) -> tuple:
        return str, (str(self),)  # saved with a frame, it is the header

    def reading(self, read: Trace, label: str = "") -> Q:
        """The same column, read in another way (at a depth, of a law), if need be with another word
        on the axis.
        """
        return Q(self.name, self.unit, label or self.label, read, self.checked, self.tolerance)


# --- where and when -------------------------------------------------------------------------------

TIME = Q("time", "s", "time (s)", lambda h: h["time"].values, False, 1e-5)
STROKE_TIME = TIME.reading(strokes.time_of)
DISTANCE = Q(
    "stroke_distance", "mm", "distance (mm)", lambda h: strokes.distance(h) * 1e3, False, 1e-4
)
SPEED = Q("velocity", "mm/s", "velocity (mm/s)", tolerance=1e-6)
X = Q("x", "mm", "x (mm)", tolerance=1e-3)
Y = Q("y", "mm", "y (mm)", tolerance=1e-3)
NODE = Q("node_x", "mm", tolerance=1e-6)
RECEPTOR = Q("receptor_depth", "um", tolerance=1e-6)
TRIAL = Q("trial", "1", tolerance=1e-6)

# --- surfaces -------------------------------------------------------------------------------------

HEIGHT = Q("height", "mm", "height (mm)", tolerance=1e-4)
CURVATURE = Q("curvature", "1/m", "curvature (1/m)", tolerance=1e-4)
RADIUS = Q("radius", "mm", "radius (mm)", tolerance=1e-4)
DOUBT = Q("surface_may_be", "1/m", tolerance=1e-4)

# --- contact and skin -----------------------------------------------------------------------------

FORCE = Q("force", "gf", "force (gf)", features.force_gf, False, 1e-5)
NEWTON = Q("force", "N", "force (N)", steady.force_N, tolerance=2e-3)
DEPTH = Q(
    "indentation_depth",
    "mm",
    "indentation depth (mm)",
    lambda h: features.depth(h) * 1e3,
    tolerance=1e-3,
)
WIDTH = Q(
    "contact_width", "mm", "contact width (mm)", lambda h: features.width(h) * 1e3, tolerance=3e-3
)
INVERSE_WIDTH = Q(
    "inverse_contact_width",
    "1/mm",
    "1 / contact width (1/mm)",
    lambda h: 1e-3 / features.width(h),
    tolerance=3e-3,
)
LENGTH = Q("contact_length", "mm", "contact length (mm)", tolerance=1e-2)
P = Q("contact_pressure", "Pa", "contact pressure (Pa)", tolerance=5e-3)
P_CENTRE = Q(
    "centre_pressure",
    "Pa",
    "contact pressure at the centre (Pa)",
    features.centre_pressure,
    tolerance=3e-3,
)
P_PEAK = Q(
    "peak_pressure", "Pa", "peak contact pressure (Pa)", features.peak_pressure, tolerance=3e-3
)
MEAN_P = Q("mean_centre_pressure", "Pa", tolerance=3e-3)
P_SCALED = Q(
    "scaled_centre_pressure",
    "Pa",
    read=lambda h: features.PRESSURE_SCALE * features.centre_pressure(h),
    tolerance=3e-3,
)
P_LAW = Q("pressure_by_law", "Pa", tolerance=5e-3)
EDGE_DISTANCE, BELOW_EDGE, NODE_SPEED = (
    Q("edge_distance", "mm"),
    Q("displacement_below_edge", "mm"),
    Q("speed", "mm/s"),
)
DOWN = Q("vertical_displacement", "mm", "vertical displacement (mm)", tolerance=1e-3)
DEFLECTION = Q("deflection", "mm", "surface deflection (mm)", tolerance=1e-3)
LATERAL = Q(
    "lateral_displacement",
    "mm",
    "lateral displacement (mm)",
    lambda h: strokes.lateral(h) * 1e3,
    tolerance=2e-3,
)
SKIN_CURVATURE = Q("skin_curvature", "1/mm", "skin curvature (1/mm)", tolerance=2e-2)
SCALED_CURVATURE = Q(
    "scaled_skin_curvature", "Pa", read=strokes.scaled_curvature, checked=False, tolerance=1e-2
)

# --- receptors ------------------------------------------------------------------------------------

SED = Q("strain_energy_density", "Pa", "strain energy density (Pa)", tolerance=2e-3)
SED_LAW = Q("strain_energy_by_eq_4_4", "Pa", tolerance=5e-3)
SED_SQUARE = Q("strain_energy_by_square_of_weighted_pressure", "Pa", tolerance=5e-3)
RATE = Q("strain_energy_rate", "Pa/s", "strain energy rate (Pa/s)", tolerance=5e-3)
IMPULSE_RATE = Q("predicted_rate", "impulses/s", "predicted rate (impulses/s)", tolerance=1e-2)
STATIC = Q("rate_from_energy", "impulses/s", tolerance=1e-2)
DYNAMIC = Q("rate_from_energy_rate", "impulses/s")
FREQUENCY = Q(
    "predicted_frequency", "impulses/s", "instantaneous frequency (impulses/s)", tolerance=1e-2
)
IMPULSE = Q("impulse_time", "s", tolerance=1e-3)
GIVEN_RATE = Q("impulse_rate", "impulses/s", "mean rate of the hold (impulses/s)", tolerance=1e-2)
STEADY_RATE = Q("steady_rate", "impulses/s", "steady rate (impulses/s)", tolerance=1e-2)
BURST_WIDTH = Q("burst_width", "mm", "predicted burst width (mm)", tolerance=1e-2)
BURST_TIME = Q("burst_duration", "s", "predicted duration (s)", tolerance=1e-2)
COUNT = Q("impulses", "1", tolerance=1e-2)
BURST_IMPULSES = Q("burst_impulses", "1", tolerance=1e-2)
BURST_STROKES = Q("strokes_with_a_burst", "1", tolerance=1e-2)
DOUBLE = Q("strokes_with_two_bursts", "1", tolerance=1e-2)
TIME_ABOVE = Q("time_above_threshold", "s", "duration (s)", tolerance=1e-2)
ENERGY_FACTOR = Q("energy_factor", "1", tolerance=2e-3)
BURST_RATE = Q("burst_rate", "impulses/s", "predicted burst rate (impulses/s)", tolerance=1e-2)

QUANTITIES: dict[str, Q] = {str(q): q for q in list(globals().values()) if isinstance(q, Q)}
"""Every quantity by the header of its column."""


def sed(depth: float, offset: float = 0.0) -> Q:
    """Strain energy density at a depth (m) under the centre, or at an offset (m) beside it."""
    return SED.reading(lambda h: features.energy(h, depth, offset))
