"""The press in NGSolve, as its user would write it: energies, pressure condensed, a penalty at the
nodes, its Cholesky.
"""

import json
import sys
import time

import numpy as np

STIFFNESS = 1e11  # Pa/m of the contact: the force is then right to 1e-4


def press(problem, increments):
    """Force (N/m, or N), iterations and process time (s) of the loop; RuntimeError where it
    does not converge.
    """
    import ngsolve as ngs
    from netgen.meshing import Element1D, Element2D, Mesh, MeshPoint, Pnt
    from ngsolve.solvers import Newton

    ngs.SetNumThreads(1)
    plane = Mesh(dim=2)
    number = [plane.Add(MeshPoint(Pnt(x, y, 0))) for x, y in problem["points"].tolist()]
    pad = plane.AddRegion("pad", dim=2)
    for cell in problem["cells"].tolist():
        plane.Add(Element2D(pad, [number[k] for k in cell]))
    for name in ("skin", "held", "axis"):
        line = plane.AddRegion(name, dim=1)
        for a, b in problem[f"{name}_edges"].tolist():
            plane.Add(Element1D([number[a], number[b]], index=line))
    mesh = ngs.Mesh(plane)
    held = {"dirichlet": "held", "dirichletx": "held|axis"}
    space = ngs.VectorH1(mesh, order=1, **held) * ngs.L2(mesh, order=0)
    u, p = space.TrialFunction()
    mu, bulk, down = float(problem["mu"]), float(problem["bulk"]), ngs.Parameter(0.0)
    top, radius = float(problem["points"][:, 1].max()), 1 / float(problem["curvature"] or np.inf)
    f = ngs.Id(2) + ngs.Grad(u)
    across, hoop = (2 * np.pi * ngs.x, 1 + u[0] / ngs.x) if problem["turned"] else (1.0, 1.0)
    j = ngs.Det(f) * hoop
    solid = across * (
        mu / 2 * (j ** (-2 / 3) * (ngs.InnerProduct(f, f) + hoop**2) - 3)
        + p * (j - 1)
        - p**2 / (2 * bulk)
    )

    def gap(u):
        if not radius:
            return top - down - ngs.y - u[1]
        return ngs.sqrt((ngs.x + u[0]) ** 2 + (ngs.y + u[1] - top - radius + down) ** 2) - radius

    nodes = {ngs.SEGM: ngs.IntegrationRule([(0,), (1,)], [0.5, 0.5])}
    energy = ngs.BilinearForm(space, symmetric=True, condense=True)
    energy += ngs.Variation(solid.Compile() * ngs.dx)
    energy += ngs.Variation(
        (across * ngs.IfPos(-gap(u), STIFFNESS / 2 * gap(u) ** 2, 0)).Compile()
        * ngs.ds("skin", intrules=nodes)
    )
    now, iterations = ngs.GridFunction(space), 0
    start = time.process_time()
    for k in range(1, increments + 1):
        down.Set(float(problem["depth"]) * k / increments)
        failed, used = Newton(
            energy, now, inverse="sparsecholesky", maxerr=1e-6, maxit=40, printing=False
        )
        if failed:
            raise RuntimeError("Newton's method did not converge")
        iterations += used
    loop = time.process_time() - start
    found = gap(now.components[0])
    upright = (
        (top + radius - down - ngs.y - now.components[0][1]) / (found + radius) if radius else 1.0
    )
    push = across * ngs.IfPos(-found, -STIFFNESS * found * upright, 0)
    return ngs.Integrate(push * ngs.ds("skin", intrules=nodes), mesh), iterations, loop


if __name__ == "__main__":
    force, iterations, loop = press(dict(np.load(sys.argv[1])), int(sys.argv[2]))
    print(json.dumps({"force": float(force), "iterations": iterations, "loop": loop}))
