"""A clamped block of rubber that creeps under a traction, by FElupe, which shares no code with proboscis.

    pip install felupe==11.3.0 && python creep.py > creep.json

Neo-Hooke mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J beside FElupe's finite_strain_viscoelastic in MPa, mm and ms: a Maxwell branch
mu1/2 (J^(-2/3) tr(C inv(Ci)) - 3), whose Ci is unimodular(Ci + dt/tau J^(-2/3) C) after a step: an implicit method of order 1.
The block is clamped at x = 0; the traction on x = 10 grows over RAMP ms and stays for as long. Displacements are extrapolated to dt = 0 by
Romberg's scheme from a list of steps; the last column of the table is the error estimate.
"""

import json
import sys

import felupe as fem
import numpy as np

MU, LAMBDA = 0.1, 0.4
BRANCHES = [(0.05, 20.0), (0.03, 120.0)]
TRACTION = np.array([0.004, 0.0, 0.006])
RAMP = 40.0

mesh = fem.Cube(a=(0, 0, 0), b=(10, 4, 4), n=(3, 2, 2))
region = fem.RegionHexahedron(mesh)
clamped, end = (np.isclose(mesh.points[:, 0], x) for x in (0, 10))
# Four nodes of one face of 4 x 4 mm.
LOAD = np.where(end[:, None], 16 / 4 * TRACTION, 0).ravel()


def creep(steps):
    """Displacements at the end of the ramp and at the end."""
    dt = RAMP / steps
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    items = [fem.SolidBody(fem.NeoHookeCompressible(mu=MU, lmbda=LAMBDA), field)]
    for mu, tau in BRANCHES:
        law = fem.Hyperelastic(
            fem.finite_strain_viscoelastic, nstatevars=6, mu=mu, eta=mu * tau, dtime=dt
        )
        items.append(fem.SolidBody(law, field))
        # Both the state and its start are Ci = 1.
        items[-1].results.statevars[:] = np.array([1, 0, 0, 1, 0, 1.0])[:, None, None]
    bounds = {"clamp": fem.Boundary(field[0], mask=clamped)}
    _, free = fem.dof.partition(field, bounds)
    out = []
    for n in range(1, 2 * steps + 1):
        part = min(n / steps, 1.0)
        for _ in range(30):
            residual = sum(i.assemble.vector(field).toarray().ravel() for i in items) - part * LOAD
            matrix = sum(i.assemble.matrix(field) for i in items).tocsr()
            change = np.zeros_like(residual)
            change[free] = np.linalg.solve(matrix[free][:, free].toarray(), -residual[free])
            field[0].values += change.reshape(-1, 3)
            if np.abs(change).max() < 1e-12:
                break
        else:
            raise SystemExit("no convergence")
        for item in items:
            item.assemble.vector(field)
            if item.results.statevars.size:
                item.results.statevars[:] = item.results._statevars
        if n in (steps, 2 * steps):
            out.append(field[0].values.copy())
    return np.array(out)


table = [[creep(20 * 2**k)] for k in range(4)]
for k in range(1, 4):
    for m in range(1, k + 1):
        fine, coarse = table[k][m - 1], table[k - 1][m - 1]
        table[k].append(fine + (fine - coarse) / (2**m - 1))
best = table[3][3]
print("estimated error", np.abs(best - table[3][2]).max(), "of", np.abs(best).max(), file=sys.stderr)
out = {"felupe": fem.__version__, "mu": MU, "lambda": LAMBDA, "branches": BRANCHES, "traction": TRACTION.tolist()}
out |= {"ramp": RAMP, "nodes": mesh.points.tolist(), "displacements": best.tolist()}
print(json.dumps(out))
