"""The press in FElupe, as its user would write it: a nearly incompressible solid, its own rigid
contact, PARDISO.
"""

import json
import sys
import time

import numpy as np

# of the contact, in those of the nodes: the force is then right to 1e-4 (30 under a cylinder, or it
# diverges)
STIFFNESS = 300.0


def press(problem, increments):
    """Force (N/m, or N), iterations and process time (s) of the loop; FElupe's error where it does
    not converge.
    """
    import felupe as fem
    from pypardiso import spsolve

    radius = 1 / problem["curvature"] if problem["curvature"] else 0.0
    above = [0.0, problem["points"][:, 1].max() + radius]
    points, kind = np.vstack([problem["points"], above]), fem.FieldPlaneStrain
    down, upright, sideways = np.array([0, -1]), (1, 0), (0, 1)
    if problem["turned"]:  # about its x, so that the section lies on its side
        points, kind = points[:, ::-1] * [-1, 1], fem.FieldAxisymmetric
        down, upright, sideways = np.array([1, 0]), sideways, upright
    mesh = fem.Mesh(points, problem["cells"], "quad")
    field = fem.FieldContainer([kind(fem.RegionQuad(mesh), dim=2)])
    solid = fem.SolidBodyNearlyIncompressible(
        fem.NeoHooke(mu=float(problem["mu"])), field, bulk=float(problem["bulk"])
    )
    how = {"points": problem["skin"], "centerpoint": -1, "items": [solid]}
    if radius:
        contact = fem.ContactRigidCylinder(field, radius=radius, multiplier=STIFFNESS / 10, **how)
    else:
        contact = fem.ContactRigidPlane(field, normal=down, multiplier=STIFFNESS, **how)
    number = np.arange(mesh.npoints)
    move = fem.Boundary(field[0], mask=number == number[-1], skip=upright)
    boundaries = {
        "fixed": fem.Boundary(field[0], mask=np.isin(number, problem["held"])),
        "aside": fem.Boundary(field[0], mask=number == number[-1], skip=sideways),
        "axis": fem.Boundary(field[0], mask=np.isin(number, problem["axis"]), skip=sideways),
        "move": move,
    }
    depth = problem["depth"] * np.linspace(0, 1, increments + 1)[1:]
    ramp = {move: down.sum() * depth}
    step = fem.Step([solid, contact], ramp=ramp, boundaries=boundaries)
    start = time.process_time()
    iterations = sum(
        done.iterations for done in step.generate(x0=field, solver=spsolve, tol=1e-6, verbose=0)
    )
    loop = time.process_time() - start
    force = contact.results.force.toarray().reshape(-1, 2)[-1] @ down
    return force, iterations, loop


if __name__ == "__main__":
    force, iterations, loop = press(dict(np.load(sys.argv[1])), int(sys.argv[2]))
    print(json.dumps({"force": float(force), "iterations": iterations, "loop": loop}))
