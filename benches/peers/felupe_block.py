"""An elastic block that hangs from one end: FElupe with PyPardiso beside proboscis, one core each.

    python felupe_block.py PROGRAM [N ...] [--matrix FILE]

PROGRAM is proboscis, N the elements across the block of 4 N x N x N hexahedra (8 and 16 where none is given). Both find the equilibrium under
gravity by Newton's method; the run ends with an error where a corner is displaced differently. Seconds are means of Newton iterations:
`assembly` is residual and tangent, `linear system` its factorisation and solution. Those of proboscis are from full Newton steps of the
same block in motion, which has the mass in its tangent besides. PyPardiso does its analysis anew each time, as its `spsolve` does; the
tangent goes to it as an unsymmetric one. The whole equilibrium is that of all Newton iterations; proboscis finds it by multigrid above
20 000 unknowns, and examines its stability. `--matrix` keeps the last tangent for `petsc_block.py`. Needs `felupe` and `pypardiso`.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

for name in ["OMP_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"]:
    os.environ[name] = "1"
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import felupe
import numpy
import pypardiso

MU, LAMBDA, DENSITY, GRAVITY = 0.1, 0.4, 1e-3, 9.81e-3  # MPa, MPa, g/mm^3, mm/ms^2
SIZE = (40.0, 10.0, 10.0)  # mm
CORNER = (40.0, 5.0, 10.0)  # mm


def of_felupe(n, kept):
    """Displacement of the corner in mm, seconds of assembly and of the linear system in an iteration, of all iterations, unknowns."""
    mesh = felupe.Cube(b=SIZE, n=(4 * n + 1, n + 1, n + 1))
    field = felupe.FieldContainer([felupe.Field(felupe.RegionHexahedron(mesh), dim=3)])
    block = felupe.SolidBody(felupe.NeoHookeCompressible(mu=MU, lmbda=LAMBDA), field)
    weight = felupe.SolidBodyForce(field, values=[0, 0, DENSITY * GRAVITY])
    clamped = {"left": felupe.Boundary(field[0], fx=0)}
    _, free = felupe.dof.partition(field, clamped)
    assembly = linear = 0.0
    for iteration in range(1, 30):
        began = time.perf_counter()
        tangent = block.assemble.matrix(field)
        rows = block.assemble.vector(field) + weight.assemble.vector()
        assembly += time.perf_counter() - began
        began = time.perf_counter()
        matrix = tangent.tocsr()[free][:, free]
        rhs = -rows.toarray()[free, 0]
        step = pypardiso.spsolve(matrix, rhs)
        linear += time.perf_counter() - began
        change = numpy.zeros(field[0].values.size)
        change[free] = step
        field[0].values += change.reshape(-1, 3)
        if abs(step).max() < 1e-10:
            if kept:
                places = numpy.repeat(mesh.points, 3, axis=0)[free]
                weight_alone = weight.assemble.vector().toarray()[free, 0]
                numpy.savez(kept, data=matrix.data, indices=matrix.indices, indptr=matrix.indptr, rhs=weight_alone, places=places, axes=free % 3)
            node = numpy.argmin(((mesh.points - CORNER) ** 2).sum(axis=1))
            means = assembly / iteration, linear / iteration
            return field[0].values[node], *means, assembly + linear, len(free)
    sys.exit("FElupe: no convergence")


def of_proboscis(program, n):
    """The same of proboscis."""
    material = {"density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "400 kPa"}
    block = {
        "name": "block", "material": "silicone", "fixed": ["x_min"],
        "box": {"size": [f"{side} mm" for side in SIZE], "elements": [4 * n, n, n]},
    }
    corner = {"name": "corner", "solid": "block", "at": [f"{x} mm" for x in CORNER]}
    scene = {
        "name": "hanging block", "gravity": [0, 0, "-9.81 m/s^2"], "materials": {"silicone": material},
        "solids": [block], "markers": [corner],
    }
    quiet = subprocess.DEVNULL
    motion = {"duration": "2 ms", "step": "1 ms", "newton": "full", "linear_solver": "faer"}
    with tempfile.TemporaryDirectory() as folder:
        def run(command, task):
            with open(f"{folder}/problem.json", "w") as file:
                json.dump({"scene": scene, **task}, file)
            subprocess.run([program, command, "problem.json", "-o", command, "--quiet"], cwd=folder, check=True, stdout=quiet, stderr=quiet)
            with open(f"{folder}/{command}/summary.json") as file:
                return json.load(file)

        rest = run("equilibrium", {"equilibrium": {}})
        steps = run("simulate", {"simulate": motion})
    displacement = numpy.array(rest["markers"]["corner"]) * 1e3 - CORNER
    assembly = steps["assembly_seconds"] / steps["newton_iterations"]
    linear = steps["factorisation_seconds"] / steps["factorisations"]
    linear += steps["solution_seconds"] / steps["newton_iterations"]
    return displacement, assembly, linear, rest["seconds"]["total"] - rest["seconds"]["writing"], rest["is_stable"]


def main():
    words = sys.argv[1:]
    kept = None
    if "--matrix" in words:
        at = words.index("--matrix")
        kept = words[at + 1]
        del words[at : at + 2]
    program = os.path.abspath(words[0])
    print("| elements | unknowns | assembly, s: FElupe, proboscis, ratio | linear system, s: PyPardiso, proboscis, ratio | whole equilibrium, s: FElupe, proboscis, ratio |")
    print("|:--|--:|--:|--:|--:|")
    for n in [int(n) for n in words[1:]] or [8, 16]:
        there, assembly, linear, whole, unknowns = of_felupe(n, kept)
        here, own_assembly, own_linear, own_whole, is_stable = of_proboscis(program, n)
        if is_stable is not True:
            sys.exit("the equilibrium is not stable")
        apart = abs(there - here).max()
        if not apart < 1e-8 * abs(there).max():
            sys.exit(f"the corner is displaced by {there} mm and by {here} mm")
        print(
            f"| {4 * n} × {n} × {n} | {unknowns} | {assembly:.3f}, {own_assembly:.3f}, {assembly / own_assembly:.1f}"
            f" | {linear:.3f}, {own_linear:.3f}, {linear / own_linear:.1f} | {whole:.2f}, {own_whole:.2f}, {whole / own_whole:.1f} |",
            flush=True,
        )


main()
