"""Compile the element loops into the package's cache: once at set-up instead of in the first simulations."""

from pathlib import Path

from fingerpad import load_scene, simulate
from fingerpad.scenes.scene import Bar, Discretisation, Flat, PressToForce, Slide, Wavy

scene = load_scene(Path("config/scenes/ramp40_k210.yaml"))
scene = scene.model_copy(update={"accuracy": Discretisation(element=None, skin_edge=1e-3, steps=2)})
light = (PressToForce(press_to_force=1e-6, rate=None),)
simulate(scene)
simulate(scene.model_copy(update={"motion": light, "effects": {"finite_strain": True}}))
simulate(scene.model_copy(update={"motion": light, "effects": {"finite_strain": False}, "stimulus": Wavy()}))
simulate(scene.model_copy(update={"motion": light, "effects": {"finite_strain": True}, "stimulus": Bar(width=1e-3)}))
stroke = (*light, Slide(slide=1e-4, speed=1e-3))
simulate(scene.model_copy(update={"motion": stroke, "friction": 0.3, "stimulus": Flat()}))
