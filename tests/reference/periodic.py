"""A rod on a hinge that a motor swings periodically, by CasADi: the discrete equations of docs/theory.md written again.

The start is sought, and the end has its angle and momentum. The angle is 0.8 rad at half the period and -0.3 rad at its start. Least
effort, and changes of the torque from interval to interval, from the last to the first too. Prints the numbers of `periodic.json`: the
objective, and the torque in N m of the first interval. Needs the package casadi.
"""
import casadi as ca

N, T, EFFORT, RATE = 40, 0.9, 1.0, 0.001
m, L, r, g = 0.2, 0.3, 0.005, 9.81
h = T / N
# Body: a cylinder of mass m, length L, radius r, hanging from a hinge about z; y up. E = ½(tr J) I − J.
across_inertia, axis_inertia = m * (3 * r * r + L * L) / 12, m * r * r / 2
E_along, E_across = across_inertia - axis_inertia / 2, axis_inertia / 2


def rod(q):
    across = ca.vertcat(ca.cos(q), ca.sin(q))
    along = ca.vertcat(-ca.sin(q), ca.cos(q))
    return -L / 2 * along, across, along


def action(a, b, u):
    (c0, x0, y0), (c1, x1, y1) = rod(a), rod(b)
    total = 0.5 * m * ca.sumsqr((c1 - c0) / h)
    total += 0.5 * E_across * ca.sumsqr((x1 - x0) / h) + 0.5 * E_along * ca.sumsqr((y1 - y0) / h)
    return h * (total - m * g * (c0[1] + c1[1]) / 2 + u * (a + b) / 2)


a, b, u = ca.SX.sym("a"), ca.SX.sym("b"), ca.SX.sym("u")
D1 = ca.Function("D1", [a, b, u], [ca.gradient(action(a, b, u), a)])
D2 = ca.Function("D2", [a, b, u], [ca.gradient(action(a, b, u), b)])
q, us = ca.SX.sym("q", N), ca.SX.sym("u", N)
rows = [
    D2(q[k - 1], q[k], us[k - 1]) + D1(q[k], q[(k + 1) % N], us[k])
    if k > 0
    else D2(q[N - 1], q[0], us[N - 1]) + D1(q[0], q[1], us[0])
    for k in range(N)
]
rows += [q[N // 2] - 0.8, q[0] + 0.3]
jumps = [us[k] - us[(k - 1) % N] for k in range(N)]
f = EFFORT * h * ca.sumsqr(us) + RATE / h * sum(j * j for j in jumps)
nlp = {"x": ca.vertcat(q, us), "f": f, "g": ca.vertcat(*rows)}
options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-12}
solver = ca.nlpsol("solver", "ipopt", nlp, options)
found = solver(x0=0, lbg=0, ubg=0)
print(solver.stats()["return_status"])
print({"objective": float(found["f"]), "torque": float(found["x"][N])})
