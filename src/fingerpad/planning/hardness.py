"""What makes a scene hard to solve: said where a run breaks off or doubts itself, as what to ask
less of.
"""

from __future__ import annotations

from collections.abc import Iterator

from fingerpad.scenes.scene import Scene
from fingerpad.units import format_quantity

_UNLIKE = 100.0
_ALIKE = 2.0
_INCOMPRESSIBLE = 0.499
_FORCE = 0.5
_DEPTH = 2e-3
_CURVATURE = 1000.0
"""Ratio of layers' moduli, that of the skin's to the next one's, Poisson's ratio, N, m and 1/m
beyond which it is said: chosen between the usual and the hard levels of the catalogue of hard cases
(figures/tables/stability.csv).
"""


def hard_in(scene: Scene) -> tuple[str, ...]:
    """What is hard in a scene, in words, in the order in which the catalogue of hard cases tries
    less of it.
    """
    return tuple(_hard(scene))


def _hard(scene: Scene) -> Iterator[str]:
    layers = list(scene.specimen.materials.values())
    moduli = [layer.youngs_modulus for layer in layers]
    if max(moduli) > _UNLIKE * min(moduli):
        yield f"layers up to {max(moduli) / min(moduli):.0e} times as stiff as others".replace(
            "e+0", "e"
        )
    elif len(moduli) > 1 and moduli[0] < _ALIKE * min(moduli[1:]):
        yield "a skin hardly stiffer than what is below it"
    ratio = max(layer.poisson_ratio for layer in layers)
    if ratio > _INCOMPRESSIBLE:
        yield f"a Poisson's ratio of {ratio:g}"
    force, depth = (
        max(getattr(leg, name) or 0.0 for leg in scene.motion) for name in ("force", "depth")
    )
    if force > _FORCE:
        yield f"a force of {format_quantity(force, 'force')}"
    if depth > _DEPTH:
        yield f"a depth of {format_quantity(depth, 'length')}"
    if scene.stimulus.unbounded:
        yield "a true edge"
    elif scene.stimulus.convexity > _CURVATURE:
        yield f"a surface as sharp as {scene.stimulus.convexity:.4g} 1/m"
    elif scene.stimulus.irregular or scene.stimulus.valleys:
        yield "a surface with corners or bumps"
    if scene.friction:
        yield f"friction of {scene.friction:g}"
    stiffening = sorted({layer.law.name for layer in layers} - {"neo_hooke"})
    if stiffening:
        yield f"the law {stiffening[0]}"
    if scene.effects.get("finite_strain") is False:
        yield "small strain"
    if any(leg.strokes for leg in scene.motion):
        yield "a stroke"
    if scene.specimen.mesh is not None:
        yield "a mesh that is not refined"
