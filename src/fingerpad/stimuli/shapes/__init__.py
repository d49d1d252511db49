"""The shapes that can touch the pad, one file each: what a scene says of it, and its geometry.

A new one is a file with a subclass of :class:`Shape`, and its line here.
"""

from fingerpad.stimuli.shapes.bar import Bar
from fingerpad.stimuli.shapes.cone import Cone
from fingerpad.stimuli.shapes.cylinder import Cylinder
from fingerpad.stimuli.shapes.flat import Flat
from fingerpad.stimuli.shapes.line import Line
from fingerpad.stimuli.shapes.punch import Punch
from fingerpad.stimuli.shapes.sampled import Sampled
from fingerpad.stimuli.shapes.shape import SHAPES, CurvedShape, Shape, Stimulus, shape_from
from fingerpad.stimuli.shapes.sphere import Sphere
from fingerpad.stimuli.shapes.wavy import Wavy

__all__ = [
    "SHAPES",
    "Bar",
    "Cone",
    "CurvedShape",
    "Cylinder",
    "Flat",
    "Line",
    "Punch",
    "Sampled",
    "Shape",
    "Sphere",
    "Stimulus",
    "Wavy",
    "shape_from",
]
