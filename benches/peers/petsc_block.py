"""PETSc on the tangent of an elastic block that `felupe_block.py --matrix FILE` has kept: CG with GAMG and rigid-body modes, one process.

    python3 petsc_block.py FILE

Solves for the weight to a relative residual of 1e-8, and tells iterations, seconds of the set-up and of the solution. Needs `petsc4py`.
"""

import sys
import time

import numpy
import petsc4py

petsc4py.init(sys.argv[:1])
from petsc4py import PETSc

kept = numpy.load(sys.argv[1])
size = len(kept["rhs"])
index = numpy.int32
csr = kept["indptr"].astype(index), kept["indices"].astype(index), kept["data"]
places, axes = kept["places"], kept["axes"]


def modes():
    """Translations and rotations of the free unknowns, orthonormal."""
    columns = [(axes == axis).astype(float) for axis in range(3)]
    for a, b in [(0, 1), (1, 2), (2, 0)]:
        columns.append(numpy.where(axes == a, -places[:, b], numpy.where(axes == b, places[:, a], 0.0)))
    return numpy.linalg.qr(numpy.array(columns).T)[0].T


for smoother in ["jacobi", "sor"]:  # with rigid-body modes, version 3.18 fails with the second one (reason -11)
    matrix = PETSc.Mat().createAIJ((size, size), csr=csr)
    matrix.setBlockSize(3)
    vectors = []
    for mode in modes():
        vector = matrix.createVecRight()
        vector.setArray(mode)
        vectors.append(vector)
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=vectors))
    matrix.setOption(PETSc.Mat.Option.SPD, True)
    options = PETSc.Options()
    options["mg_levels_ksp_type"] = "chebyshev"
    options["mg_levels_pc_type"] = smoother
    solver = PETSc.KSP().create()
    solver.setOperators(matrix)
    solver.setType("cg")
    solver.getPC().setType("gamg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.setTolerances(rtol=1e-8, max_it=500)
    solver.setFromOptions()
    rhs, solution = matrix.createVecs()
    rhs.setArray(kept["rhs"])
    began = time.perf_counter()
    solver.setUp()
    setup = time.perf_counter() - began
    began = time.perf_counter()
    solver.solve(rhs, solution)
    seconds = time.perf_counter() - began
    print(f"PETSc {PETSc.Sys.getVersion()}, {size} unknowns, {smoother}: {solver.getIterationNumber()} iterations, set-up {setup:.2f} s, solution {seconds:.2f} s, reason {solver.getConvergedReason()}")
