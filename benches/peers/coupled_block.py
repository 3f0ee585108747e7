"""PETSc and PyPardiso on the linear system of a block under a voltage, beside proboscis, one core each.

    python3 coupled_block.py FOLDER [PROGRAM N]

FOLDER has the arrays that `cargo bench --bench coupled` writes; where its PROGRAM and N are given, it is run first on the same core.
PETSc solves to a relative residual of 1e-8 by GMRES with one GAMG for displacements, with rigid-body modes, and one for potentials, each
applied once an iteration: after one another, or both to the same residual. Rows of potentials change their sign for it, which makes both
fields positive definite. PyPardiso factorises. Solutions have to agree to 1e-5 of their size. Needs `petsc4py` and `pypardiso`.
"""

import os
import subprocess
import sys
import time

for name in ["OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]:
    os.environ[name] = "1"
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import numpy
import petsc4py
import pypardiso
import scipy.sparse

petsc4py.init(sys.argv[:1])
from petsc4py import PETSc

FOLDER = sys.argv[1]
POTENTIAL = 3
NAMES = {"multiplicative": "a GAMG for each field, in turn", "additive": "a GAMG for each field, at once"}


def load(name):
    return numpy.load(f"{FOLDER}/{name}.npy")


def told(name, iterations, setup, seconds, x):
    """A row of the table; the run ends where the solution is another one."""
    residual = numpy.linalg.norm(rhs - matrix @ x) / numpy.linalg.norm(rhs)
    apart = abs(x - known).max() / abs(known).max()
    print(f"| {name} | {len(rhs)} | {iterations} | {setup:.2f} | {seconds:.2f} | {residual:.1e} |", flush=True)
    if not apart < 1e-5:
        sys.exit(f"solutions differ by {apart:.1e} of their size")


def modes(places, axes):
    """Translations and rotations of displacements, orthonormal."""
    columns = [(axes == axis).astype(float) for axis in range(3)]
    for a, b in [(0, 1), (1, 2), (2, 0)]:
        columns.append(numpy.where(axes == a, -places[:, b], numpy.where(axes == b, places[:, a], 0.0)))
    return numpy.linalg.qr(numpy.array(columns).T)[0].T


def null_space(vectors, size):
    """Vectors of PETSc that span the near null space."""
    found = []
    for one in vectors:
        vector = PETSc.Vec().createSeq(size)
        vector.setArray(one)
        found.append(vector)
    return PETSc.NullSpace().create(vectors=found)


def by_petsc(kind):
    """GMRES with a GAMG for each field."""
    index = numpy.int32
    moving = components != POTENTIAL
    signs = numpy.where(moving, 1.0, -1.0)
    signed = scipy.sparse.diags(signs) @ matrix
    a = PETSc.Mat().createAIJ(signed.shape, csr=(signed.indptr.astype(index), signed.indices.astype(index), signed.data))
    solver = PETSc.KSP().create()
    solver.setOptionsPrefix(f"{kind}_")
    options = PETSc.Options()
    options.prefixPush(solver.getOptionsPrefix())
    options["pc_type"] = "fieldsplit"
    options["pc_fieldsplit_type"] = kind
    for field in "uv":
        options[f"fieldsplit_{field}_ksp_type"] = "preonly"
        options[f"fieldsplit_{field}_pc_type"] = "gamg"
        # With rigid-body modes, version 3.18 fails with `sor` (reason -11).
        options[f"fieldsplit_{field}_mg_levels_pc_type"] = "jacobi"
    options.prefixPop()
    solver.setOperators(a)
    solver.setType("gmres")
    solver.setPCSide(PETSc.PC.Side.RIGHT)
    solver.setGMRESRestart(200)
    solver.setTolerances(rtol=1e-8, max_it=200)
    solver.setFromOptions()
    began = time.perf_counter()
    fields = [PETSc.IS().createGeneral(numpy.flatnonzero(of).astype(index)) for of in (moving, ~moving)]
    fields[0].compose("nearnullspace", null_space(modes(places[moving], components[moving]), int(moving.sum())))
    solver.getPC().setFieldSplitIS(("u", fields[0]), ("v", fields[1]))
    solver.setUp()
    for part in solver.getPC().getFieldSplitSubKSP():
        part.setUp()
    setup = time.perf_counter() - began
    b, x = a.createVecs()
    b.setArray(signs * rhs)
    began = time.perf_counter()
    solver.solve(b, x)
    seconds = time.perf_counter() - began
    name = f"PETSc {'.'.join(map(str, PETSc.Sys.getVersion()))}, {NAMES[kind]}"
    if solver.getConvergedReason() < 0:
        print(f"| {name} | {len(rhs)} | {solver.getIterationNumber()}, reason {solver.getConvergedReason()} | {setup:.2f} | {seconds:.2f} | |", flush=True)
        return
    told(name, solver.getIterationNumber(), setup, seconds, x.getArray().copy())


def by_pardiso():
    solver = pypardiso.PyPardisoSolver(mtype=11)
    began = time.perf_counter()
    solver.factorize(matrix)
    setup = time.perf_counter() - began
    began = time.perf_counter()
    x = solver.solve(matrix, rhs)
    told("PyPardiso, factors", "", setup, time.perf_counter() - began, x)


print("| solver | unknowns | iterations | set-up, s | solution, s | residual |\n|:--|--:|--:|--:|--:|--:|")
if len(sys.argv) > 2:
    sys.stdout.flush()
    subprocess.run([sys.argv[2], FOLDER, sys.argv[3]], check=True)
rhs, known, components = load("rhs"), load("solution"), load("components")
places = load("places").reshape(-1, 3)
entries = load("values"), (load("rows").astype(numpy.int64), load("columns").astype(numpy.int64))
matrix = scipy.sparse.csr_matrix(entries, shape=(len(rhs), len(rhs)))
matrix.sum_duplicates()
for kind in NAMES:
    by_petsc(kind)
by_pardiso()
