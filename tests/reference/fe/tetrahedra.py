"""A crooked block of curved quadratic tetrahedra under loads, by FElupe, which shares no code with proboscis.

    pip install felupe==11.3.0 && python tetrahedra.py > tetrahedra.json

Neo-Hooke mu/2 (tr C - 3) - mu ln J + lambda/2 ln^2 J in MPa and mm; in "mean" V lambda/2 ln^2 of the mean dilatation of each element takes the
place of the last term, with its forces and tangent written here. Eight Gauss points, in two orbits of barycentric coordinates (a, a, a, 1 - 3a),
found here from their four moments. Elements and faces are in the order of VTK. The block is clamped at x = 0; loads act on the faces that lie at
z = 6 before it is bent, the pressure along their deformed normals.
"""

import json

import felupe as fem
import numpy as np
from scipy.optimize import fsolve
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import spsolve

MU, LAMBDA, STIFF = 0.1, 0.4, 50.0
PRESSURE = 0.002
TRACTION = 0.001 * np.array([0.6, 0.0, 0.8])
STEPS = 8


def moments(unknown):
    a, w, b, v = unknown
    power = lambda a, n: 3 * a**n + (1 - 3 * a) ** n
    exact = [(2, 2 / 5), (3, 1 / 5), (4, 4 * 144 / 5040)]
    return [4 * (w + v) - 1] + [4 * (w * power(a, n) + v * power(b, n)) - m for n, m in exact]


a, w, b, v = fsolve(moments, [0.107, 0.111, 0.328, 0.139], xtol=1e-15)
orbit = lambda a: [[a, a, a], [1 - 3 * a, a, a], [a, 1 - 3 * a, a], [a, a, 1 - 3 * a]]
scheme = fem.quadrature.Scheme(np.array(orbit(a) + orbit(b)), np.array([w] * 4 + [v] * 4) / 6)

mesh = fem.mesh.triangulate(fem.Cube(a=(0, 0, 0), b=(12, 5, 6), n=(4, 2, 3))).add_midpoints_edges(cell_type="tetra10")
flat = mesh.points.copy()
x, y, z = flat.T
bend = [x * np.sin(y), 0.4 * x * np.cos(z), 0.6 * x * np.sin(0.5 * x) + 0.3 * y * z]
mesh.points[:] = flat + 0.05 * np.stack(bend, axis=1)
clamped = np.isclose(flat[:, 0], 0)
region = fem.Region(mesh, fem.QuadraticTetra(), scheme)
assert region.dV.min() > 0

# Faces of the boundary at z = 6: corners counter-clockwise seen from outside, then the middles of the edges from the first corner on.
FACES = [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]]
faces = np.array([cell[f] for cell in mesh.cells for f in FACES if np.isclose(flat[cell[f], 2], 6).all()])

# Products of Gauss points in a collapsed square.
s, t = np.polynomial.legendre.leggauss(7)
s, t = (s + 1) / 2, t / 2
points = [(p, q * (1 - p), wp * wq * (1 - p)) for p, wp in zip(s, t) for q, wq in zip(s, t)]


def shape(p, q):
    """Shape functions of a face and their slopes."""
    l, dl = np.array([1 - p - q, p, q]), np.array([[-1, -1], [1, 0], [0, 1]])
    pairs = [(0, 1), (1, 2), (0, 2)]
    values = [*(l * (2 * l - 1)), *(4 * l[i] * l[j] for i, j in pairs)]
    slopes = [*((4 * l - 1)[:, None] * dl), *(4 * (l[i] * dl[j] + l[j] * dl[i]) for i, j in pairs)]
    return np.array(values), np.array(slopes)


def cross(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def pressed(x, pressure):
    """Forces of a pressure on the faces with nodes at x, and their derivatives."""
    forces, tangent = np.zeros(x.size), np.zeros((x.size, x.size))
    for face in faces:
        at = x[face]
        for p, q, weight in points:
            n, dn = shape(p, q)
            one, two = at.T @ dn[:, 0], at.T @ dn[:, 1]
            for i, node in enumerate(face):
                forces[3 * node : 3 * node + 3] -= pressure * weight * n[i] * np.cross(one, two)
                for j, other in enumerate(face):
                    block = cross(one) * dn[j, 1] - cross(two) * dn[j, 0]
                    rows, columns = np.ix_(range(3 * node, 3 * node + 3), range(3 * other, 3 * other + 3))
                    tangent[rows, columns] -= pressure * weight * n[i] * block
    return forces, tangent


def dead(vector):
    """Forces of a vector for an area of the faces as they are."""
    forces = np.zeros(mesh.points.shape)
    for face in faces:
        for p, q, weight in points:
            n, dn = shape(p, q)
            one, two = mesh.points[face].T @ dn[:, 0], mesh.points[face].T @ dn[:, 1]
            forces[face] += weight * np.linalg.norm(np.cross(one, two)) * n[:, None] * vector
    return forces.ravel()


def mean_dilatation(u):
    """Forces and tangent of V lambda/2 ln^2 of the mean dilatation."""
    forces, tangent = np.zeros(u.size), np.zeros((u.size, u.size))
    for e, cell in enumerate(mesh.cells):
        gradients, weights = region.dhdX[:, :, :, e], region.dV[:, e]
        slope, second, volume = np.zeros(30), np.zeros((30, 30)), 0.0
        for q, weight in enumerate(weights):
            F = np.eye(3) + np.einsum("ia,im->am", u[cell], gradients[:, :, q])
            J, g = np.linalg.det(F), gradients[:, :, q] @ np.linalg.inv(F)
            volume += weight * J
            slope += weight * J * g.ravel()
            outer = np.einsum("ia,jb->iajb", g, g) - np.einsum("ib,ja->iajb", g, g)
            second += weight * J * outer.reshape(30, 30)
        whole = weights.sum()
        mean = volume / whole
        dofs = (3 * cell[:, None] + np.arange(3)).ravel()
        forces[dofs] += STIFF * np.log(mean) / mean * slope
        stiffness = STIFF * (1 - np.log(mean)) / (mean**2 * whole)
        tangent[np.ix_(dofs, dofs)] += stiffness * np.outer(slope, slope) + STIFF * np.log(mean) / mean * second
    return forces, tangent


def solved(load, is_mean=False):
    """Displacements under a load that grows."""
    field = fem.FieldContainer([fem.Field(region, dim=3)])
    solid = fem.SolidBody(fem.NeoHookeCompressible(mu=MU, lmbda=0.0 if is_mean else LAMBDA), field)
    free = np.repeat(~clamped, 3)
    for part in np.arange(1, STEPS + 1) / STEPS:
        for _ in range(40):
            u = field[0].values
            forces, tangent = load(mesh.points + u, part)
            residual = solid.assemble.vector(field).toarray().ravel() - forces
            matrix = solid.assemble.matrix(field).toarray() - tangent
            if is_mean:
                more = mean_dilatation(u)
                residual, matrix = residual + more[0], matrix + more[1]
            change = np.zeros(u.size)
            change[free] = spsolve(csr_matrix(matrix[free][:, free]), -residual[free])
            u += change.reshape(-1, 3)
            if np.abs(change).max() < 1e-12:
                break
        else:
            raise SystemExit("no convergence")
    return field[0].values.copy()


push = dead(TRACTION)
cases = {
    "following": solved(lambda x, part: pressed(x, part * PRESSURE)),
    "traction": solved(lambda x, part: (part * push, 0.0)),
    "mean": solved(lambda x, part: (part * push, 0.0), is_mean=True),
}
out = {"felupe": fem.__version__, "mu": MU, "lambda": LAMBDA, "stiff": STIFF, "pressure": PRESSURE}
out |= {"traction": TRACTION.tolist(), "nodes": mesh.points.tolist(), "tetrahedra": mesh.cells.tolist()}
out["clamped"] = np.flatnonzero(clamped).tolist()
out["upper"] = np.flatnonzero(np.isclose(flat[:, 2], 6)).tolist()
out["displacements"] = {name: values.tolist() for name, values in cases.items()}
print(json.dumps(out))
