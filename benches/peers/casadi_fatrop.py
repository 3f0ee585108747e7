"""The optimal control problem of the trunk in stages, for the Fatrop that CasADi brings.

Fatrop asks for x_{k+1} = F(x_k, u_k) and for rows of one stage alone, but a voltage enters the discrete Euler-Lagrange equations
of two instants. So the same equations stand in position-momentum form. The state is (q_k, p_k), the inputs are (V_k, w_k):

    x_{k+1} = (w_k, D2 L(q_k, w_k, V_k)),    p_k + D1 L(q_k, w_k, V_k) = 0,

where L holds the virtual work of the viscosity as well. Given angles and the momentum at rest are constants: the first stage has
no state, the last one no w, and its momentum at the end is zero. Eliminating p and w gives the program of casadi_ipopt.py, with
voltages as unknowns in place of their squares: with squares Fatrop 1.1.8 finds no first search direction and goes on for ever.
"""

import casadi as ca
import numpy as np

from casadi_ipopt import placed, row_scales


# Fatrop relaxes a bound by this part of it, or of 1 where that is more, and has no option not to.
RELAXED = 1e-8


class Stages:
    """Indices of variables and rows, stage by stage; −1 where there is none."""

    def __init__(self, program):
        n, m, count = program.n, program.m, program.intervals
        last = count - 1
        self.nx = [0] + last * [2 * n]
        self.nu = last * [n + m] + [m]
        self.ng = last * [n] + [2 * n]
        none, of_angles = np.full(n, -1), np.arange(n)
        starts = np.concatenate([[0], np.cumsum(np.add(self.nx, self.nu))])
        self.size, self.row_count = int(starts[-1]), 2 * n * last + sum(self.ng)
        self.q = [none if k == 0 else starts[k] + of_angles for k in range(count)]
        self.p = [none if k == 0 else starts[k] + n + of_angles for k in range(count)]
        self.v = [starts[k] + self.nx[k] + np.arange(m) for k in range(count)]
        self.w = [none if k == last else starts[k] + self.nx[k] + m + of_angles for k in range(count)]
        # Rows of stage k: angles and momenta handed to the next one, then the momentum balance. The last ends at rest instead.
        first = [3 * n * k for k in range(count)]
        self.handed = [row + of_angles for row in first[:-1]]
        self.early = [row + 2 * n + of_angles for row in first[:-1]] + [first[-1] + of_angles]
        self.late = [row + n + of_angles for row in first]


def build(program, functions, tolerance, iterations):
    """The solver and its arguments."""
    rows, jacobian, hessian = functions
    stages = Stages(program)
    count, n, size = program.intervals, program.n, stages.size
    joined = lambda lists: np.concatenate(lists).astype(int).tolist()
    joint_scale = row_scales(program, jacobian)[:n]
    # Momenta are variables in the scale of their rows, and x_{k+1} − F is the sign that Fatrop's interface asks for.
    scale = np.ones(stages.row_count)
    scale[joined(stages.early)] = np.tile(joint_scale, count)
    scale[joined(stages.late[:-1])] = -np.tile(joint_scale, count - 1)
    scale[stages.late[-1]] = joint_scale

    x = ca.MX.sym("x", size)
    inner = lambda lists: ca.reshape(x[joined(lists)], n, count - 1)
    volts = x[joined(stages.v)]
    parts = (ca.horzcat(program.start, inner(stages.q[1:])), ca.horzcat(inner(stages.w[:-1]), program.goal),
             ca.reshape(volts, program.m, count), program.h)
    f = program.weight * ca.dot(volts, volts)

    # The linear rest of the rows: q_{k+1} − w_k, p_{k+1}, and p_k of the balance.
    entries = [(stages.handed, stages.q[1:], 1.0), (stages.handed, stages.w[:-1], -1.0),
               (stages.late[:-1], stages.p[1:], 1.0), (stages.early[1:], stages.p[1:], 1.0)]
    linear = ca.DM(stages.row_count, size)
    for of_rows, of_columns, value in entries:
        linear += ca.DM.triplet(joined(of_rows), joined(of_columns), ca.DM.ones(n * (count - 1)) * value, stages.row_count, size)
    of_rows = [np.concatenate(pair) for pair in zip(stages.early, stages.late)]
    of_z = [np.concatenate(three) for three in zip(stages.q, stages.w, stages.v)]
    places = np.concatenate(of_rows)
    spread = ca.DM.triplet(places.tolist(), list(range(len(places))), scale[places], stages.row_count, len(places))

    def values(early, late):
        return ca.mtimes(spread, ca.vec(ca.vertcat(early, late))) + ca.mtimes(linear, x)

    g = values(*rows.map(count)(*parts))
    early, late, blocks = jacobian.map(count)(*parts)
    pattern, sums = placed(jacobian.sparsity_out(2), of_rows, of_z, (stages.row_count, size))
    # In one product: the blocks scaled and put among the constants.
    whole = pattern + linear.sparsity()
    places = np.flatnonzero(ca.project(ca.DM(pattern, 1.0), whole).nonzeros()).tolist()
    scales = scale[np.array(pattern.row())]
    weights = ca.DM.triplet(places, list(range(len(places))), scales, whole.nnz(), len(places))
    matrix = ca.MX(whole, ca.mtimes(ca.mtimes(weights, sums), blocks.nz[:]) + ca.DM(ca.project(linear, whole).nonzeros()))
    p = ca.MX.sym("p", 0)
    jac_g = ca.Function("nlp_jac_g", [x, p], [values(early, late), matrix], ["x", "p"], ["g", "jac_g_x"])

    sigma, costates = ca.MX.sym("sigma"), ca.MX.sym("costates", stages.row_count)
    scaled = costates * ca.DM(scale)
    along = [ca.reshape(scaled[joined(lists)], n, count) for lists in (stages.early, stages.late)]
    blocks, gradients = hessian.map(count)(*parts, *along)
    pattern, sums = placed(hessian.sparsity_out(0), of_z, of_z, (size, size))
    is_voltage = np.zeros(size)
    is_voltage[joined(stages.v)] = 2 * program.weight
    of_voltages = ca.sparsify(ca.diag(ca.DM(is_voltage)))
    matrix = ca.MX(pattern, ca.mtimes(sums, blocks.nz[:])) + sigma * of_voltages
    pattern, sums = placed(hessian.sparsity_out(1), of_z, count * [np.zeros(1, int)], (size, 1))
    gradient = (ca.densify(ca.MX(pattern, ca.mtimes(sums, ca.vec(gradients)))) + ca.mtimes(linear.T, costates)
                + sigma * ca.mtimes(of_voltages, x))
    hess = ca.Function("nlp_hess_l", [x, p, sigma, costates], [gradient, matrix],
                       ["x", "p", "lam_f", "lam_g"], ["grad_gamma_x", "hess_gamma_x_x"])

    # Called once, at the solution.
    last = ca.Function("nlp_grad", [x, p, sigma, costates], [f, g, gradient, ca.MX(0, 1)],
                       ["x", "p", "lam_f", "lam_g"], ["f", "g", "grad_gamma_x", "grad_gamma_p"])

    options = {
        "print_time": False,
        "structure_detection": "manual",
        "N": count - 1, "nx": stages.nx, "nu": stages.nu, "ng": stages.ng,
        # The interface takes derivatives of one's own from the cache of functions alone.
        "cache": {"nlp_jac_g": jac_g, "nlp_hess_l": hess, "nlp_grad": last},
        "fatrop": {"print_level": 0, "tolerance": tolerance, "max_iter": iterations},
    }
    solver = ca.nlpsol("solver", "fatrop", {"x": x, "f": f, "g": g}, options)
    return solver, arguments(program, stages, rows, joint_scale)


def arguments(program, stages, rows, joint_scale):
    """Guess and bounds of the program, and the momenta that its guess has."""
    a, b, v = (np.array(ca.DM(part)) for part in program.parts(program.guess))
    guess, low, high = np.empty(stages.size), np.full(stages.size, -np.inf), np.full(stages.size, np.inf)
    # Narrowed by what Fatrop will relax, so that the same program is solved.
    least, most = program.low[:program.m], program.high[:program.m]
    least, most = least + RELAXED * np.maximum(1, np.abs(least)), most - RELAXED * np.maximum(1, np.abs(most))
    for k in range(program.intervals):
        guess[stages.v[k]], low[stages.v[k]], high[stages.v[k]] = v[:, k], least, most
        if k:
            momentum = np.array(rows(a[:, k - 1], b[:, k - 1], v[:, k - 1], program.h)[1]).ravel()
            guess[stages.q[k]], guess[stages.p[k]] = a[:, k], joint_scale * momentum
        if k < program.intervals - 1:
            guess[stages.w[k]] = b[:, k]
    return {"x0": guess, "lbx": low, "ubx": high, "lbg": 0, "ubg": 0}
