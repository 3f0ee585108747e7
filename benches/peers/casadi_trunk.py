"""The optimal control problem of the elephant trunk, written for CasADi, beside proboscis.

Reads the scene as `proboscis expand` prints it and the problem file, and writes the same nonlinear program: midpoint rule on
the vectors x = F(theta) of bodies and spans, DMOCC in joint angles, the same objective, boundary conditions, bounds and guess.
It is solved by the Ipopt with MUMPS that CasADi brings, with exact derivatives. Nothing but the two files is shared with
proboscis: forward kinematics, energies and rows are written out here, and the objectives have to agree.

Variants: `sx` writes the whole program as one expression of scalars and leaves the derivatives to CasADi; `map` differentiates
one interval, maps that over all of them and puts the blocks into Jacobian and Hessian; `map_jit` compiles the interval.

    python casadi_trunk.py scene.json problem.json --intervals 40 --variant map
"""

import argparse
import json
import sys
import time

import casadi as ca
import numpy as np

# Units: g, mm, ms, N, MPa, V.
UNITS = {
    "kg": 1e3, "g": 1.0, "m": 1e3, "cm": 10.0, "mm": 1.0, "um": 1e-3, "s": 1e3, "ms": 1.0,
    "Pa": 1e-6, "kPa": 1e-3, "MPa": 1.0, "V": 1.0, "kV": 1e3, "Pa s": 1e-3, "kg/m^3": 1e-6, "g/cm^3": 1e-3,
}
VACUUM_PERMITTIVITY = 8.854187817e-12
# Volts by which the guess lies above the voltages at rest.
LIFT = 100.0
KILOVOLT = 1e3
SECOND = 1e3
VARIANTS = ("sx", "map", "map_jit")


def quantity(value):
    """A number with a unit, in the units above; a number alone is zero or in SI."""
    if isinstance(value, (int, float)):
        if value:
            raise SystemExit(f"{value}: a number without a unit is not read here")
        return 0.0
    number, unit = value.split(" ", 1)
    return float(number) * UNITS[unit]


def place(values):
    return np.array([quantity(value) for value in values])


def refuse(condition, what):
    """What this script does not know is not passed over."""
    if condition:
        raise SystemExit(f"{what} is not part of this comparison")


class Trunk:
    """Bodies on revolute joints, each on the one before, and lumped muscles."""

    def __init__(self, scene):
        self.names = [body["name"] for body in scene["bodies"]]
        self.joints = scene["joints"]
        refuse(len(self.joints) != len(self.names), "a scene that is no chain")
        refuse("gravity" in scene or "solids" in scene, "gravity or an elastic block")
        self.bodies = [self.body(body) for body in scene["bodies"]]
        self.muscles = [self.muscle(m, scene["materials"]) for m in scene["muscles"]]

    @staticmethod
    def body(body):
        mass, cylinder = quantity(body["mass"]), body["cylinder"]
        length, radius = quantity(cylinder["length"]), quantity(cylinder["radius"])
        axis = np.array(cylinder["axis"])
        axial = mass * radius**2 / 2
        transverse = mass * (3 * radius**2 + length**2) / 12
        about = transverse + (axial - transverse) * np.abs(axis)
        refuse(sorted(np.abs(axis)) != [0, 0, 1], "an oblique cylinder")
        # Euler inertia of the three directions x, y, z fixed to the body.
        euler = about.sum() / 2 - about
        return mass, euler, place(body["position"])

    def muscle(self, muscle, materials):
        refuse(muscle["model"] != "lumped" or muscle.get("section_inertia"), "another kind of muscle")
        material = materials[muscle["material"]]
        ratio = material["relative_permittivity"]
        refuse(material.get("dielectric", "first_order") != "first_order", "another dielectric")
        a, b = (self.attachment(muscle[end]) for end in ("from", "to"))
        length = np.linalg.norm(b[1] - a[1])
        sides = [quantity(side) for side in muscle["cross_section"]]
        volume = sides[0] * sides[1] * length
        return {
            "ends": (a, b),
            "length": length,
            "volume": volume,
            "mass": volume * quantity(material["density"]),
            "mu": quantity(material["shear_modulus"]),
            "c1": -(ratio - 1) * VACUUM_PERMITTIVITY,
            "c2": (ratio - 1) * VACUUM_PERMITTIVITY / 2,
            "layer": quantity(muscle["layer_thickness"]),
            "viscosity": quantity(material["viscosity"]),
            "name": muscle["name"],
        }

    def attachment(self, end):
        body = None if end["body"] == "ground" else self.names.index(end["body"])
        return body, place(end["at"])

    def vectors(self, theta):
        """What inertia and muscles read: centres, turned axes, middles and spans of the muscles, all linear in directors."""
        turn, foot, before = ca.SX.eye(3), ca.SX.zeros(3), np.zeros(3)
        poses = []
        for i, joint in enumerate(self.joints):
            refuse(self.names.index(joint["child"]) != i, "a scene that is no chain")
            parent = "ground" if i == 0 else self.names[i - 1]
            refuse(joint["parent"] != parent or "revolute" not in joint, "a scene that is no chain")
            at = place(joint["at"])
            foot = foot + turn @ (at - before)
            n = np.array(joint["revolute"]["axis"])
            cross = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
            turn = turn @ (ca.SX.eye(3) + ca.sin(theta[i]) * cross + (1 - ca.cos(theta[i])) * (cross @ cross))
            poses.append((turn, foot, at))
            before = at
        point = lambda body, x: x if body is None else poses[body][1] + poses[body][0] @ (x - poses[body][2])
        centres = [point(i, position) for i, (_, _, position) in enumerate(self.bodies)]
        axes = [poses[i][0] for i in range(len(self.bodies))]
        ends = [[point(*end) for end in muscle["ends"]] for muscle in self.muscles]
        middles = [(a + b) / 2 for a, b in ends]
        spans = [b - a for a, b in ends]
        return centres, axes, middles, spans

    def energy(self, spans, voltages):
        """Electro-elastic energy of all muscles."""
        total = 0
        for muscle, r, v in zip(self.muscles, spans, ca.vertsplit(voltages)):
            i = ca.dot(r, r) / muscle["length"] ** 2
            elastic = muscle["mu"] / 2 * (2 / ca.sqrt(i) + i - 3)
            electric = muscle["c1"] + muscle["c2"] * i - VACUUM_PERMITTIVITY / (2 * i)
            total += muscle["volume"] * (elastic + electric * (v / muscle["layer"]) ** 2)
        return total

    def interval(self):
        """Rows that an interval adds to its two instants, as functions of both angles and of its voltages in V."""
        n, m = len(self.joints), len(self.muscles)
        a, b, v, h = ca.SX.sym("a", n), ca.SX.sym("b", n), ca.SX.sym("v", m), ca.SX.sym("h")
        xa, xb = self.vectors(a), self.vectors(b)
        rates = [[(q - p) / h for p, q in zip(*lists)] for lists in zip(xa, xb)]
        means = [(p + q) / 2 for p, q in zip(xa[3], xb[3])]
        kinetic = 0
        for (mass, euler, _), centre, axes in zip(self.bodies, rates[0], rates[1]):
            kinetic += mass * ca.dot(centre, centre) / 2
            for i in range(3):
                kinetic += euler[i] * ca.dot(axes[:, i], axes[:, i]) / 2
        for muscle, middle, span in zip(self.muscles, rates[2], rates[3]):
            kinetic += muscle["mass"] / 2 * (ca.dot(middle, middle) + ca.dot(span, span) / 12)
        action = h * (kinetic - self.energy(means, v))
        rows = [ca.gradient(action, a), ca.gradient(action, b)]
        for muscle, r, rate, ra, rb in zip(self.muscles, means, rates[3], xa[3], xb[3]):
            force = -1.5 * muscle["viscosity"] * muscle["volume"] * ca.dot(r, rate) / ca.dot(r, r) ** 2 * r
            rows[0] += ca.jtimes(ra, a, h / 2 * force, True)
            rows[1] += ca.jtimes(rb, b, h / 2 * force, True)
        return ca.Function("interval", [a, b, v, h], rows)

    def equilibrium(self, voltages):
        """Joint angles at rest under voltages in V, by Newton from the straight trunk."""
        n, m = len(self.joints), len(self.muscles)
        theta, v = ca.SX.sym("theta", n), ca.SX.sym("v", m)
        energy = self.energy(self.vectors(theta)[3], v)
        hessian, gradient = ca.hessian(energy, theta)
        step = ca.Function("step", [theta, v], [gradient, hessian])
        at = np.zeros(n)
        # Voltages in ten parts, so that Newton stays near its solution.
        for part in np.linspace(0.1, 1, 10):
            for _ in range(50):
                g, k = (np.array(x) for x in step(at, part * np.asarray(voltages)))
                move = np.linalg.solve(k, g).ravel()
                at = at - move
                if np.abs(move).max() < 1e-13:
                    break
        return at


def rest(trunk, state):
    given = state["rest_at_voltages"]
    return np.array([quantity(given.get(muscle["name"], 0.0)) for muscle in trunk.muscles])


def placed(blocks, rows, cols, shape, upper=False):
    """Sparsity of a matrix made of equal blocks, and the matrix that takes the blocks' nonzeros to its own.

    `rows` and `cols` hold one list of indices a block, negative where a row or column is given and dropped.
    """
    of_rows, of_cols = (np.array(x) for x in blocks.get_triplet())
    at = [(r[of_rows], c[of_cols]) for r, c in zip(rows, cols)]
    r, c = (np.concatenate(x) for x in zip(*at))
    kept = (r >= 0) & (c >= 0)
    if upper:
        kept &= r <= c
    places, which = np.unique(c[kept] * shape[0] + r[kept], return_inverse=True)
    pattern = ca.Sparsity.triplet(*shape, (places % shape[0]).tolist(), (places // shape[0]).tolist())
    source = np.flatnonzero(kept)
    sums = ca.Sparsity.triplet(len(places), len(r), which.tolist(), source.tolist())
    return pattern, ca.DM(sums, 1.0)


class Program:
    """Variables instant by instant, voltages in kV between the angles; rows of all instants."""

    def __init__(self, trunk, control, intervals):
        for key in ("limits",):
            refuse(key in control, f"control.{key}")
        refuse(control["objective"].keys() != {"effort"}, "an objective other than effort")
        refuse(control.get("guess", "interpolate") != "interpolate", "another guess")
        self.n, self.m, self.intervals = len(trunk.joints), len(trunk.muscles), intervals
        self.h = quantity(control["duration"]) / intervals
        self.weight = control["objective"]["effort"] * self.h / SECOND
        hold = rest(trunk, control["goal"])
        self.start = trunk.equilibrium(rest(trunk, control["start"]))
        self.goal = trunk.equilibrium(hold)
        n, m = self.n, self.m
        held = (hold + LIFT) / KILOVOLT
        guess, low, high = [held], [], []
        for k in range(1, intervals):
            s = k / intervals
            guess += [self.start + s * s * (3 - 2 * s) * (self.goal - self.start), held]
        self.guess = np.concatenate(guess)
        bounds = [quantity(value) / KILOVOLT for value in control["voltage_bounds"]]
        free, volts = np.full(n, np.inf), np.ones(m)
        self.low = np.concatenate([bounds[0] * volts] + (intervals - 1) * [-free, bounds[0] * volts])
        self.high = np.concatenate([bounds[1] * volts] + (intervals - 1) * [free, bounds[1] * volts])

    def angles(self, k):
        """Indices of the variables of instant k; −1 where they are given."""
        if k in (0, self.intervals):
            return np.full(self.n, -1)
        return self.m + (k - 1) * (self.n + self.m) + np.arange(self.n)

    def volts(self, k):
        return k * (self.n + self.m) + np.arange(self.m)

    def parts(self, x):
        """Angles of both ends and voltages of every interval as columns."""
        n, m, count = self.n, self.m, self.intervals
        inner = ca.reshape(x[m:], n + m, count - 1)
        ends = ca.horzcat(self.start, inner[:n, :], self.goal)
        return ends[:, :-1], ends[:, 1:], ca.horzcat(x[:m], inner[n:, :])

    def objective(self, x):
        volts = ca.vec(self.parts(x)[2])
        return self.weight * ca.dot(volts, volts)

    def rows(self, early, late):
        zero = ca.DM.zeros(self.n, 1)
        return ca.vec(ca.horzcat(early, zero) + ca.horzcat(zero, late))


def interval_functions(trunk, options):
    """Rows of an interval, their Jacobian, and the Hessian along costates, of both ends and voltages in kV."""
    n, m = len(trunk.joints), len(trunk.muscles)
    a, b, v, h = ca.SX.sym("a", n), ca.SX.sym("b", n), ca.SX.sym("v", m), ca.SX.sym("h")
    la, lb = ca.SX.sym("la", n), ca.SX.sym("lb", n)
    early, late = ca.cse(list(trunk.interval()(a, b, v * KILOVOLT, h)))
    z, rows = ca.vertcat(a, b, v), ca.vertcat(early, late)
    hessian, _ = ca.hessian(ca.dot(ca.vertcat(la, lb), rows), z)
    jacobian, hessian = ca.cse([ca.jacobian(rows, z), hessian])
    given = [a, b, v, h]
    return (
        ca.Function("rows", given, [early, late], options),
        ca.Function("rows_jacobian", given, [early, late, jacobian], options),
        ca.Function("rows_hessian", given + [la, lb], [hessian], options),
    )


def by_blocks(program, functions, scale):
    """Objective, rows and their derivatives, each from the map of one interval's."""
    count, n, m = program.intervals, program.n, program.m
    size, row_count = len(program.guess), n * (count + 1)
    rows, jacobian, hessian = functions
    x, s = ca.MX.sym("x", size), ca.DM(scale)
    parts = program.parts(x)
    early, late = rows.map(count)(*parts, program.h)
    f, g = program.objective(x), program.rows(early, late) * s
    of_rows = [np.arange(k * n, (k + 2) * n) for k in range(count)]
    of_z = [np.concatenate([program.angles(k), program.angles(k + 1), program.volts(k)]) for k in range(count)]

    early, late, blocks = jacobian.map(count)(*parts, program.h)
    pattern, sums = placed(jacobian.sparsity_out(2), of_rows, of_z, (row_count, size))
    values = ca.mtimes(sums, blocks.nz[:]) * ca.DM(scale[np.array(pattern.row())])
    p = ca.MX.sym("p", 0)
    again = program.rows(early, late) * s
    jac_g = ca.Function("nlp_jac_g", [x, p], [again, ca.MX(pattern, values)], ["x", "p"], ["g", "jac_g_x"])

    sigma, costates = ca.MX.sym("sigma"), ca.MX.sym("costates", row_count)
    along = ca.reshape(costates * s, n, count + 1)
    blocks = hessian.map(count)(*parts, program.h, along[:, :-1], along[:, 1:])
    pattern, sums = placed(hessian.sparsity_out(0), of_z, of_z, (size, size), upper=True)
    values = ca.mtimes(sums, blocks.nz[:])
    is_voltage = np.zeros(size)
    is_voltage[np.concatenate([program.volts(k) for k in range(count)])] = 2 * program.weight
    of_voltages = ca.diag(ca.DM(is_voltage))
    matrix = ca.MX(pattern, values) + sigma * ca.sparsify(of_voltages)
    hess = ca.Function(
        "nlp_hess_l", [x, p, sigma, costates], [matrix], ["x", "p", "lam_f", "lam_g"], ["hess_gamma_x_x"]
    )
    return {"x": x, "f": f, "g": g}, {"jac_g": jac_g, "hess_lag": hess}


def as_one(program, rows, scale):
    """Objective and rows as expressions of scalars."""
    x = ca.SX.sym("x", len(program.guess))
    parts = zip(*(ca.horzsplit(part) for part in program.parts(x)))
    early, late = zip(*(rows(a, b, v, program.h) for a, b, v in parts))
    g = program.rows(ca.horzcat(*early), ca.horzcat(*late))
    return {"x": x, "f": program.objective(x), "g": g * scale}, {}


def row_scales(program, jacobian):
    """One over the largest derivative at the guess by joint, as proboscis scales its rows."""
    count, n = program.intervals, program.n
    x = ca.DM(program.guess)
    largest = np.zeros(n)
    for k, (a, b, v) in enumerate(zip(*(ca.horzsplit(part) for part in program.parts(x)))):
        block = np.abs(np.array(jacobian(a, b, v, program.h)[2]))
        for end, columns in ((k, slice(0, n)), (k + 1, slice(n, 2 * n))):
            if end in (0, count):
                block[:, columns] = 0
        largest = np.maximum(largest, np.maximum(block[:n], block[n:]).max(axis=1))
    return np.tile(1 / largest, count + 1)


def build(trunk, control, intervals, variant, tolerance):
    """The solver and its arguments."""
    program = Program(trunk, control, intervals)
    jit = {"jit": True, "compiler": "shell", "jit_options": {"flags": ["-O1"], "compiler": "gcc"}}
    functions = interval_functions(trunk, jit if variant == "map_jit" else {})
    scale = row_scales(program, functions[1])
    if variant == "sx":
        expressions, derivatives = as_one(program, functions[0], scale)
    else:
        expressions, derivatives = by_blocks(program, functions, scale)
    options = derivatives | {
        "print_time": False,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "linear_solver": "mumps",
            "tol": tolerance,
            "max_iter": control["solver"]["max_iterations"],
            "nlp_scaling_method": "none",
            # Without it the two report objectives on either side of the relaxed bounds.
            "bound_relax_factor": 0.0,
            "mumps_pivot_order": 0,
        },
    }
    solver = ca.nlpsol("solver", "ipopt", expressions, options)
    arguments = {"x0": program.guess, "lbx": program.low, "ubx": program.high, "lbg": 0, "ubg": 0}
    return solver, arguments


CALLBACKS = {"objective": "f", "gradient": "grad_f", "constraints": "g", "jacobian": "jac_g", "hessian": "hess_l"}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene")
    parser.add_argument("problem")
    parser.add_argument("--intervals", type=int, required=True)
    parser.add_argument("--variant", choices=VARIANTS, default="map")
    parser.add_argument("--tolerance", type=float, default=1e-8)
    arguments = parser.parse_args()
    began = time.perf_counter()
    with open(arguments.scene) as scene, open(arguments.problem) as problem:
        trunk, control = Trunk(json.load(scene)), json.load(problem)["control"]
    solver, given = build(trunk, control, arguments.intervals, arguments.variant, arguments.tolerance)
    ready = time.perf_counter()
    solution = solver(**given)
    done = time.perf_counter()
    stats = solver.stats()
    called = lambda key: stats.get(f"n_call_nlp_{key}", 0)
    spent = lambda key: stats.get(f"t_wall_nlp_{key}", 0.0)
    json.dump(
        {
            "objective": float(solution["f"]),
            "status": stats["return_status"],
            "iterations": stats["iter_count"],
            "setup": ready - began,
            "solve": done - ready,
            "calls": {name: called(key) for name, key in CALLBACKS.items()},
            "microseconds": {
                name: 1e6 * spent(key) / called(key) for name, key in CALLBACKS.items() if called(key)
            },
            "violation": float(np.abs(np.array(solution["g"])).max()),
            "version": ca.__version__,
        },
        sys.stdout,
    )
    return 0 if stats["success"] else 1


if __name__ == "__main__":
    sys.exit(main())
