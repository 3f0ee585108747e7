"""Two rods that a motor lifts to where it holds them, by CasADi: the discrete equations of docs/theory.md written again.

The end is an equilibrium of weight and motor, whose torque is sought with the motion and counted as that of one more interval; the
place of the tip along x is given. Prints the numbers of `held.json`: the objective, the torque in N m that holds the end, and the angles
there in rad. Needs the package casadi.
"""
import casadi as ca

N, T, EFFORT, RATE, TIP_X = 40, 1.2, 1.0, 0.002, 0.15
m, L, r, g = 0.2, 0.3, 0.005, 9.81
h = T / N
# Bodies: cylinders of mass m, length L, radius r, hanging from hinges about z; y up. E = ½(tr J) I − J.
across_inertia, axis_inertia = m * (3 * r * r + L * L) / 12, m * r * r / 2
E_along, E_across = across_inertia - axis_inertia / 2, axis_inertia / 2


def rods(q):
    """Centre, director across and director along of each rod, and the tip."""
    out, joint, angle = [], ca.DM.zeros(2), 0
    for i in range(2):
        angle = angle + q[i]
        across = ca.vertcat(ca.cos(angle), ca.sin(angle))
        along = ca.vertcat(-ca.sin(angle), ca.cos(angle))
        out.append((joint - L / 2 * along, across, along))
        joint = joint - L * along
    return out, joint


def potential(q, u):
    return sum(m * g * centre[1] for centre, _, _ in rods(q)[0]) - u * q[0]


def action(a, b, u):
    total = 0
    for (c0, x0, y0), (c1, x1, y1) in zip(rods(a)[0], rods(b)[0]):
        total += 0.5 * m * ca.sumsqr((c1 - c0) / h)
        total += 0.5 * E_across * ca.sumsqr((x1 - x0) / h) + 0.5 * E_along * ca.sumsqr((y1 - y0) / h)
        total -= m * g * (c0[1] + c1[1]) / 2
    return h * (total + u * (a[0] + b[0]) / 2)


a, b, u = ca.SX.sym("a", 2), ca.SX.sym("b", 2), ca.SX.sym("u")
D1 = ca.Function("D1", [a, b, u], [ca.gradient(action(a, b, u), a)])
D2 = ca.Function("D2", [a, b, u], [ca.gradient(action(a, b, u), b)])
force = ca.Function("force", [a, u], [ca.gradient(potential(a, u), a)])

q = [ca.SX.sym(f"q{k}", 2) for k in range(1, N + 1)]
us, hold = ca.SX.sym("u", N), ca.SX.sym("hold")
path = [ca.DM.zeros(2)] + q
rows = [D1(path[0], path[1], us[0])]
for k in range(1, N):
    rows.append(D2(path[k - 1], path[k], us[k - 1]) + D1(path[k], path[k + 1], us[k]))
# Rest, equilibrium, and the place.
rows += [D2(path[N - 1], path[N], us[N - 1]), force(path[N], hold), rods(path[N])[1][0] - TIP_X]
inputs = ca.vertcat(us, hold)
jumps = inputs[1:] - inputs[:-1]
f = EFFORT * h * ca.sumsqr(inputs) + RATE / h * ca.sumsqr(jumps)
x = ca.vertcat(*q, inputs)
nlp = {"x": x, "f": f, "g": ca.vertcat(*rows)}
options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-12}
solver = ca.nlpsol("solver", "ipopt", nlp, options)
found = solver(x0=0, lbg=0, ubg=0)
end = found["x"][2 * (N - 1) : 2 * N]
print(solver.stats()["return_status"])
print({"objective": float(found["f"]), "hold": float(found["x"][-1]), "angles": [float(v) for v in end.full().ravel()]})
