"""A crooked block under a pressure that follows, a dead pressure and a traction, by FElupe, which shares no code with proboscis.

    pip install felupe==11.3.0 && python pressure.py > pressure.json

Neo-Hooke mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J in MPa and mm, trilinear hexahedra with 2 x 2 x 2 Gauss points, faces with 2 x 2.
The block is clamped at x = 0; the loads act on the faces that lie at z = 6 before it is bent.
"""

import json

import felupe as fem
import numpy as np
from scipy.sparse import csr_matrix

MU, LAMBDA = 0.1, 0.4
PRESSURE = 0.002
TRACTION = 0.001 * np.array([0.6, 0.0, 0.8])
STEPS = 8

mesh = fem.Cube(a=(0, 0, 0), b=(12, 5, 6), n=(5, 3, 3))
flat = mesh.points.copy()
x, y, z = flat.T
bend = [x * np.sin(y), 0.4 * x * np.cos(z), 0.6 * x * np.sin(0.5 * x) + 0.3 * y * z]
mesh.points[:] = flat + 0.05 * np.stack(bend, axis=1)
clamped, upper = np.isclose(flat[:, 0], 0), np.isclose(flat[:, 2], 6)

region = fem.RegionHexahedron(mesh)
boundary = fem.RegionHexahedronBoundary(mesh, only_surface=True, mask=upper)


def solved(load):
    """Displacements under a load that grows: `load` adds its forces and its tangent to those of the block."""
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    solid = fem.SolidBody(fem.NeoHookeCompressible(mu=MU, lmbda=LAMBDA), field)
    bounds = {"clamp": fem.Boundary(field[0], mask=clamped)}
    fixed, free = fem.dof.partition(field, bounds)
    for part in np.arange(1, STEPS + 1) / STEPS:
        for _ in range(30):
            forces, tangent = load(field, part)
            residual = (solid.assemble.vector(field) + forces).toarray().ravel()
            matrix = (solid.assemble.matrix(field) + tangent).tocsr()
            change = np.zeros_like(residual)
            change[free] = np.linalg.solve(matrix[free][:, free].toarray(), -residual[free])
            field[0].values += change.reshape(-1, 3)
            if np.abs(change).max() < 1e-13:
                break
        else:
            raise SystemExit("no convergence")
    return field[0].values.copy()


def following(field, part):
    body = fem.SolidBodyPressure(fem.FieldContainer([fem.Field(boundary, dim=3)]))
    body.update(part * PRESSURE)
    sign = body.assemble.multiplier
    return sign * body.assemble.vector(field), sign * body.assemble.matrix(field)


def dead(vectors):
    """The integral of the shape functions times vectors at the points of quadrature of the faces, as a load."""
    shape = boundary.h[:, :, 0]
    forces = np.zeros_like(mesh.points)
    parts = np.einsum("aq,iqc,qc->aci", shape, vectors, boundary.dV)
    np.add.at(forces, boundary.mesh.cells.T, parts)
    column, none = csr_matrix(-forces.reshape(-1, 1)), csr_matrix((forces.size, forces.size))
    return lambda _, part: (column * part, none)


cases = {
    "following": solved(following),
    "dead": solved(dead(-PRESSURE * boundary.normals)),
    "traction": solved(dead(TRACTION[:, None, None] * np.ones_like(boundary.normals))),
}
out = {"felupe": fem.__version__, "mu": MU, "lambda": LAMBDA, "pressure": PRESSURE, "traction": TRACTION.tolist()}
out["nodes"] = mesh.points.tolist()
out["displacements"] = {name: values.tolist() for name, values in cases.items()}
print(json.dumps(out))
