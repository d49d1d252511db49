"""Compile the element loops into the cache: once at set-up, instead of in the first simulations."""

from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from fingerpad import load_scene, simulate
from fingerpad.processes import progress_bar
from fingerpad.scenes.scene import Bar, Discretisation, Flat, PressToForce, Slide, Wavy

SCENE = load_scene(Path("config/scenes/ramp40_k210.yaml"))
SCENE = SCENE.model_copy(update={"accuracy": Discretisation(element=None, skin_edge=1e-3, steps=2)})
LIGHT = (PressToForce(press_to_force=1e-6, rate=None),)
STROKE = (*LIGHT, Slide(slide=1e-4, speed=1e-3))
CHANGES = (
    ({},),  # with viscosity takes as long as all without
    (
        {"motion": LIGHT, "effects": {"finite_strain": True}},
        {"motion": LIGHT, "effects": {"finite_strain": False}, "stimulus": Wavy()},
        {"motion": LIGHT, "effects": {"finite_strain": True}, "stimulus": Bar(width=1e-3)},
        {"motion": STROKE, "friction": 0.3, "stimulus": Flat()},
    ),
    ({"kinematics": "axisymmetric", "motion": LIGHT, "stimulus": Flat()},),
)


def compiled(changes):
    """Simulate the scene with each of some changes."""
    for update in changes:
        simulate(SCENE.model_copy(update=update))


def main():
    """Compile, with a bar on a terminal."""
    with progress_bar("compiling", False, total=len(CHANGES)) as show:
        try:
            with ProcessPoolExecutor(len(CHANGES)) as pool:
                tasks = [pool.submit(compiled, changes) for changes in CHANGES]
                for done, task in enumerate(as_completed(tasks), 1):
                    task.result()
                    if show:
                        show(completed=done)
        except OSError:  # a machine without shared memory, as some containers: one after the other
            list(map(compiled, CHANGES))


if __name__ == "__main__":
    main()
