"""What the planner knows of the contact with any stack of bonded layers on a rigid base before
anything is solved.

The pressure is taken to be Hertz's, or uniform where the profile or the surface ends before the
contact would; the stack sinks under it as its Fourier compliance says
(:func:`fingerpad.reference_solutions.layered.stack_compliance`), as if it went on for ever to both
sides. Half widths of flat stacks come out within about a tenth, depths within a few per cent.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import j0, j1

from fingerpad.planning.estimates import ContactEstimate, PadEstimate
from fingerpad.reference_solutions.layered import Layer, stack_compliance
from fingerpad.specimen import measures
from fingerpad.specimen.judge import meeting_place
from fingerpad.specimen.pad import REGIONS, SKIN, UNNAMED, PadMesh

_NARROWEST = 1e-4  # half width of a contact, in thicknesses
_WIDTHS = 60  # of contacts that are tried
_FLAT = 5.0  # apex radius, in half widths, beyond which a pad is a flat one


def specimen_said(specimen, external: PadMesh | None, turned: bool = False) -> tuple[str, ...]:
    """What a specimen is made of, held by and free at, and what its scene left out, in words;
    nothing of a thesis's outline. ``turned``: it is a body of revolution.
    """
    lines, stack = [_TURNED] if turned else [], specimen.stack
    if external is not None:
        wide, high = (np.ptp(external.points, axis=0) * 1e3).tolist()
        free = [name for name in external.curves if name not in (SKIN, UNNAMED, *external.fixed)]
        if UNNAMED in external.curves:
            free.append(f"{len(external.curves[UNNAMED])} boundary edges in none of these curves")
        lines.append(
            f"a mesh of {external.element}, {wide:.3g} mm wide and {high:.3g} mm high: "
            f"{', '.join(external.regions)}; "
            f"held: {', '.join(external.fixed)}; free: {', '.join([SKIN, *free])}"
        )
        lines.append(_where_met(external))
    elif stack is not None:
        kind, held, free = f"slab {2e3 * stack.half_width:.3g} mm wide", "base", f"{SKIN}, sides"
        if stack.radius is not None:
            kind, free = f"half-round of radius {stack.radius * 1e3:.3g} mm", SKIN
            if not stack.solid:
                core = (stack.radius - stack.soft_thickness) * 1e3
                held = f"base and the core of radius {core:.3g} mm"
        named = zip(stack.names, stack.thicknesses, strict=True)
        layers = ", ".join(f"{name} {thick * 1e3:.3g} mm" for name, thick in named)
        lines.append(f"a {kind}: {layers}; held: {held}; free: {free}")
    return (*lines, *(f"not given: {left_out}" for left_out in specimen.assumed))


_TURNED = (
    "a body of revolution: the right half of the section, turned about x = 0 (a pad is a dome, a "
    "slab a disc, ridges are rings); forces are in N; errors are those measured under spheres, a "
    "cone and plates, on a mesh of your own those measured in plane strain"
)


def _where_met(external: PadMesh) -> str:
    """Where the indenter comes down on a mesh, in words."""
    skin = external.points[external.curves[SKIN][:, :2], 0] * 1e3
    low, high = skin.min() + 0.0, skin.max() + 0.0
    height, _ = meeting_place(external)
    said = (
        f"the indenter meets the skin at x = 0, y = {height * 1e3:.4g} mm; the skin goes from "
        f"x = {low:.4g} to {high:.4g} mm"
    )
    if min(-low, high) < 0.05 * (high - low):
        said += (
            ", so this is the end of the skin: where friction acts or the body goes on beside "
            "it, peak pressure is unbounded"
        )
    return said


def pad_estimate(
    specimen, external: PadMesh | None, reach: float = np.inf, turned: bool = False
) -> PadEstimate:
    """What is known of a scene's specimen; ``external`` is its own mesh, the stimulus ends
    ``reach`` m beside its middle, and it is ``turned`` about that.

    A finger is judged by the thesis's measures, any other stack of layers by the layers below its
    middle.

    Raises
    ------
    MeshError
        The skin of the mesh does not cross x = 0.
    """
    relax = 1.0
    if specimen.moduli == "instantaneous" and specimen.prony:
        relax = 1 - sum(term.g for term in specimen.prony)
    outline, stack = specimen.outline, specimen.stack
    if outline is not None and turned:
        finger, radius, half_width = None, outline.apex_radius, outline.half_width
        below = _layers_of(specimen)
    elif outline is not None:
        finger = outline.apex_radius, outline.epidermis_thickness, outline.soft_thickness
    elif stack is not None:
        finger, radius, half_width = None, stack.radius or 1e3, stack.half_width
        below = zip(stack.names, stack.thicknesses, strict=True)
    else:
        radius, below = measures.apex_radius(external), measures.layers_below(external)
        half_width = float(np.ptp(external.points[external.curves["skin"], 0]))
        half_width *= 1.0 if external.half else 0.5
        has_bone = {*REGIONS} <= {*external.regions} and "bone" in external.curves
        curved = radius < _FLAT * half_width
        finger = measures.apex_measures(external) if has_bone and curved and not turned else None
    if finger is not None:
        stiff, *soft = (_plane(specimen.materials[name]) for name in REGIONS)
        return PadEstimate(*finger, relax * stiff, relax * min(soft))
    layers = [(thickness, specimen.material(name)) for name, thickness in below]
    thickness, outermost = layers[0]
    return (RoundEstimate if turned else StackEstimate)(
        radius,
        thickness,
        sum(thickness for thickness, _ in layers),
        relax * _plane(outermost),
        relax * min(_plane(layer) for _, layer in layers),
        min(half_width, reach),
        tuple(
            (thickness, relax * layer.youngs_modulus, layer.poisson_ratio)
            for thickness, layer in layers
        ),
    )


def _layers_of(specimen) -> list[tuple[str, float]]:
    """Names and thicknesses (m) of a finger's layers below its apex."""
    outline, names = specimen.outline, list(specimen.materials)
    corneum = outline.stratum_corneum_thickness if names[0] == "stratum_corneum" else 0.0
    thick = [
        *filter(None, [corneum]),
        outline.epidermis_thickness - corneum,
        outline.dermis_thickness,
    ]
    thick.append(outline.soft_thickness - sum(thick))
    return list(zip(names, thick, strict=True))


def _plane(layer) -> float:
    """Plane modulus E / (1 - nu^2), Pa."""
    return layer.youngs_modulus / (1 - layer.poisson_ratio**2)


@dataclass(frozen=True)
class StackEstimate(PadEstimate):
    """A stack of layers, SI; ``apex_radius`` is 1000 m for a flat one, ``epidermis_thickness`` that
    of the outermost layer.

    Parameters
    ----------
    half_width
        m, of the surface, or of the face that is pressed on it.
    layers
        (thickness m, Young's modulus Pa, Poisson's ratio) of each, outside to inside.
    """

    half_width: float = np.inf
    layers: tuple[tuple[float, float, float], ...] = ()

    @cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        """Wavenumbers (n,) 1/m, and the sinking under a cosine pressure of each of them, m/Pa,
        times its step of ln k over pi.
        """
        layers = [Layer(thickness, e / (2 * (1 + nu)), nu) for thickness, e, nu in self.layers]
        scaled = np.geomspace(1e-3, 30 / _NARROWEST, 160)
        k = scaled / self.soft_thickness
        top = layers[0]
        half_plane = (1 - top.poisson_ratio) / (top.shear_modulus * k)
        compliance = [
            stack_compliance(each, layers) if each * top.thickness < 30 else limit
            for each, limit in zip(k, half_plane, strict=True)
        ]
        return k, k * np.array(compliance) * np.log(scaled[1] / scaled[0]) / np.pi

    def _under_hertz(self, half_width: float) -> tuple[float, float]:
        """Sinking (m) in the middle of a Hertzian pressure of 1 N/m, and how much less its edge
        sinks.
        """
        k, sinking = self._spectrum
        load = 2 * j1(k * half_width) / (k * half_width) * sinking
        return float(load.sum()), float((load * (1 - np.cos(k * half_width))).sum())

    def _under_plate(self, half_width: float) -> float:
        """Mean sinking (m) under a uniform pressure of 1 N/m."""
        k, sinking = self._spectrum
        return float((np.sinc(k * half_width / np.pi) ** 2 * sinking).sum())

    def _curved(self, half_width: float, curvature: float) -> tuple[float, float]:
        """Force (N/m) and depth (m) of a contact of a half width."""
        middle, less = self._under_hertz(half_width)
        force = half_width**2 * (1 / self.apex_radius + max(curvature, 0.0)) / 2 / less
        return force, force * middle

    def _widest(self, narrowest: float, curvature: float) -> float:
        """Half width (m) of the widest contact there is."""
        return self.half_width

    def _found(self, wanted: float, which: int, curvature: float) -> ContactEstimate:
        """The contact whose force (``which`` 0) or depth (1) is the ``wanted`` one."""
        thick = self.soft_thickness
        narrowest = min(_NARROWEST * thick, 0.1 * self.half_width)
        limit = self._widest(narrowest, curvature)
        bend = 1 / self.apex_radius + max(curvature, 0.0)

        def excess(log_half_width):
            return self._curved(np.exp(log_half_width), curvature)[which] - wanted

        if self._curved(limit, curvature)[which] <= wanted:
            if limit < self.half_width:  # as wide as what is pressed through the layers
                limit = float(np.clip(np.sqrt(2 * thick / bend), limit, self.half_width))
            half_width, depth = limit, wanted * self._under_plate(limit)
        elif self._curved(narrowest, curvature)[which] >= wanted:
            half_width, depth = narrowest, self._curved(narrowest, curvature)[1]
        else:
            half_width = np.exp(brentq(excess, np.log(narrowest), np.log(limit)))
            depth = self._curved(half_width, curvature)[1]
        depth = wanted if which else depth
        strain = max(0.65 * half_width * bend, depth / thick)
        return ContactEstimate(float(half_width), float(depth), float(strain))

    def pressed(self, force: float, curvature: float) -> ContactEstimate:
        """Contact under ``force`` N/m by a profile of ``curvature`` 1/m at its lowest point."""
        return self._found(force, 0, curvature)

    def pressed_to(self, depth: float, curvature: float) -> ContactEstimate:
        """Contact at ``depth`` m."""
        return self._found(depth, 1, curvature)


@dataclass(frozen=True)
class RoundEstimate(StackEstimate):
    """The same under bodies of revolution, forces in N: a pressure J0(kr) sinks as much as cos(kx)
    does, so that only the transforms of the pressures are others.
    """

    def _under_hertz(self, half_width):
        k, sinking = self._spectrum
        s = k * half_width
        # of 1 N, and from a step of ln k over pi to k dk
        load = 1.5 * (np.sin(s) - s * np.cos(s)) / s**3 * k * sinking
        return float(load.sum()), float((load * (1 - j0(s))).sum())

    def _under_plate(self, half_width):
        k, sinking = self._spectrum
        s = k * half_width
        return float((2 * j1(s) ** 2 / s**2 * k * sinking).sum())

    def _widest(self, narrowest, curvature):
        """On a layer far thinner than the contact that keeps its volume pressure is not Hertz's:
        where the force would no longer grow with the contact.
        """
        widths = np.geomspace(narrowest, self.half_width, _WIDTHS)
        forces = np.array([self._curved(width, curvature)[0] for width in widths])
        falls = np.flatnonzero(~(np.diff(forces) > 0))
        return float(widths[falls[0]]) if len(falls) else self.half_width

    def on_rounding(self, force, flat, radius):
        # pressure grows towards an edge at which F/(2 a) N/m would press a bar
        return super().on_rounding(force / (2 * (flat + radius)), flat, radius)
