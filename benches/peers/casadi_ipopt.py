"""The optimal control problem of the trunk as a nonlinear program for the Ipopt with MUMPS that CasADi brings.

The same program as proboscis writes: DMOCC in joint angles, squares of voltages as unknowns, the same objective, boundary conditions, bounds, guess
and scale of the rows, with exact derivatives. `map` maps the functions of one interval over all of them and puts the blocks into Jacobian
and Hessian; `sx` writes the whole program as one expression of scalars and leaves the derivatives to CasADi.
"""

import casadi as ca
import numpy as np

from casadi_trunk import KILOVOLT, quantity, refuse, rest

# Volts by which the guess lies above the voltages at rest.
LIFT = 100.0
SECOND = 1e3


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


def unit(control):
    """The greatest voltage in kV, by which squares of voltages are divided."""
    return quantity(control["voltage_bounds"][1]) / KILOVOLT


class Program:
    """Variables instant by instant, V²/unit in kV between the angles, or V in kV without a unit; rows of all instants."""

    def __init__(self, trunk, control, intervals, unit):
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
        self.unit = unit
        unknown = lambda volts: (volts / KILOVOLT) ** 2 / unit if unit else volts / KILOVOLT
        held = unknown(hold + LIFT)
        guess, low, high = [held], [], []
        for k in range(1, intervals):
            s = k / intervals
            guess += [self.start + s * s * (3 - 2 * s) * (self.goal - self.start), held]
        self.guess = np.concatenate(guess)
        bounds = [unknown(quantity(value)) for value in control["voltage_bounds"]]
        free, each = np.full(n, np.inf), np.ones(m)
        self.low = np.concatenate([bounds[0] * each] + (intervals - 1) * [-free, bounds[0] * each])
        self.high = np.concatenate([bounds[1] * each] + (intervals - 1) * [free, bounds[1] * each])

    def angles(self, k):
        """Indices of the variables of instant k; −1 where they are given."""
        if k in (0, self.intervals):
            return np.full(self.n, -1)
        return self.m + (k - 1) * (self.n + self.m) + np.arange(self.n)

    def inputs(self, k):
        return k * (self.n + self.m) + np.arange(self.m)

    def parts(self, x):
        """Angles of both ends, and squares of voltages or voltages, of every interval as columns."""
        n, m, count = self.n, self.m, self.intervals
        inner = ca.reshape(x[m:], n + m, count - 1)
        ends = ca.horzcat(self.start, inner[:n, :], self.goal)
        return ends[:, :-1], ends[:, 1:], ca.horzcat(x[:m], inner[n:, :])

    def objective(self, x):
        return self.weight * self.unit * ca.sum1(ca.vec(self.parts(x)[2]))

    def rows(self, early, late):
        zero = ca.DM.zeros(self.n, 1)
        return ca.vec(ca.horzcat(early, zero) + ca.horzcat(zero, late))


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
    of_z = [np.concatenate([program.angles(k), program.angles(k + 1), program.inputs(k)]) for k in range(count)]

    early, late, blocks = jacobian.map(count)(*parts, program.h)
    pattern, sums = placed(jacobian.sparsity_out(2), of_rows, of_z, (row_count, size))
    values = ca.mtimes(sums, blocks.nz[:]) * ca.DM(scale[np.array(pattern.row())])
    p = ca.MX.sym("p", 0)
    again = program.rows(early, late) * s
    jac_g = ca.Function("nlp_jac_g", [x, p], [again, ca.MX(pattern, values)], ["x", "p"], ["g", "jac_g_x"])

    sigma, costates = ca.MX.sym("sigma"), ca.MX.sym("costates", row_count)
    along = ca.reshape(costates * s, n, count + 1)
    blocks, _ = hessian.map(count)(*parts, program.h, along[:, :-1], along[:, 1:])
    pattern, sums = placed(hessian.sparsity_out(0), of_z, of_z, (size, size), upper=True)
    # The objective is linear in squares of voltages.
    matrix = ca.MX(pattern, ca.mtimes(sums, blocks.nz[:]))
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
    for k, (a, b, w) in enumerate(zip(*(ca.horzsplit(part) for part in program.parts(x)))):
        block = np.abs(np.array(jacobian(a, b, w, program.h)[2]))
        # proboscis takes derivatives by voltages there: ∂w/∂V = 2 V/unit.
        if program.unit:
            block[:, 2 * n :] *= 2 * np.sqrt(np.array(w).ravel() / program.unit)
        for end, columns in ((k, slice(0, n)), (k + 1, slice(n, 2 * n))):
            if end in (0, count):
                block[:, columns] = 0
        largest = np.maximum(largest, np.maximum(block[:n], block[n:]).max(axis=1))
    return np.tile(1 / largest, count + 1)


def build(program, functions, variant, tolerance, iterations):
    """The solver and its arguments."""
    scale = row_scales(program, functions[1])
    if variant == "sx":
        expressions, derivatives = as_one(program, functions[0], scale)
    else:
        expressions, derivatives = by_blocks(program, functions, scale)
    options = derivatives | {
        "print_time": False,
        "no_nlp_grad": True,
        "ipopt": {
            "print_level": 0,
            "sb": "yes",
            "linear_solver": "mumps",
            "tol": tolerance,
            "max_iter": iterations,
            "nlp_scaling_method": "none",
            # Without it the two report objectives on either side of the relaxed bounds.
            "bound_relax_factor": 0.0,
            "mumps_pivot_order": 0,
        },
    }
    solver = ca.nlpsol("solver", "ipopt", expressions, options)
    return solver, {"x0": program.guess, "lbx": program.low, "ubx": program.high, "lbg": 0, "ubg": 0}
