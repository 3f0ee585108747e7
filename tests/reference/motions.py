"""One shear modulus and one viscosity from three recorded motions of a pair of muscles, by CasADi: the discrete equations of docs/theory.md
written again.

Reads the recordings of `problems/pair_motions.json` and prints the numbers of `motions.json`: the objective in rad² s, the modulus in Pa and
the viscosity in Pa s, of the three motions together and of the first by itself. Needs the package casadi.
"""
import csv
import math
from pathlib import Path

import casadi as ca

N, T = 60, 0.3
h = T / N
m, radius, length = 0.03, 0.02, 0.05
area, rest, layer, density = 1e-4, 0.04, 50e-6, 1000.0
vacuum = 8.854187817e-12
volume = area * rest
# A cylinder about its axis y, hinged at the origin about z; E = ½(tr J) I − J, directors across and along in the plane.
J_axis, J_across = m * radius**2 / 2, m * (3 * radius**2 + length**2) / 12
E_across, E_along = J_axis / 2, J_across - J_axis / 2


def vectors(q):
    """Centre, director across, director along, and the upper ends of both muscles."""
    across, along = ca.vertcat(ca.cos(q), ca.sin(q)), ca.vertcat(-ca.sin(q), ca.cos(q))
    return length / 2 * along, across, along, [s * across + rest / 2 * along for s in (0.015, -0.015)]


LOWER = [ca.DM([s, -rest / 2]) for s in (0.015, -0.015)]


def electric(I):
    """Factor of V₀ (V/t)²: c₁ + c₂ I − ε/(2 I) of a relative permittivity of three, in which c₁ = −2 ε₀, c₂ = ε₀ and ε = ε₀."""
    return vacuum * (-2 + I - 1 / (2 * I))


def action(a, b, voltages, mu):
    (c0, x0, y0, e0), (c1, x1, y1, e1) = vectors(a), vectors(b)
    total = 0.5 * m * ca.sumsqr((c1 - c0) / h)
    total += 0.5 * E_across * ca.sumsqr((x1 - x0) / h) + 0.5 * E_along * ca.sumsqr((y1 - y0) / h)
    for low, p0, p1, V in zip(LOWER, e0, e1, voltages):
        # A rod whose lower end rests: m/6 |v|² of the upper one.
        total += density * volume / 6 * ca.sumsqr((p1 - p0) / h)
        I = ca.sumsqr((p0 + p1) / 2 - low) / rest**2
        total -= volume * (mu / 2 * (2 / ca.sqrt(I) + I - 3) + electric(I) * (V / layer) ** 2)
    return h * total


def viscous(a, b, eta):
    """Generalised forces at both ends of an interval times its length: half of −(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴ each."""
    out = [0, 0]
    for low, p0, p1 in zip(LOWER, vectors(a)[3], vectors(b)[3]):
        r, rate = (p0 + p1) / 2 - low, (p1 - p0) / h
        force = -1.5 * eta * volume * ca.dot(r, rate) / ca.sumsqr(r) ** 2 * r
        for end, (p, q) in enumerate([(p0, a), (p1, b)]):
            out[end] += h / 2 * ca.dot(force, ca.jacobian(p, q))
    return out


a, b, mu, eta, v1, v2 = (ca.SX.sym(n) for n in ("a", "b", "mu", "eta", "v1", "v2"))
L = action(a, b, [v1, v2], mu)
f0, f1 = viscous(a, b, eta)
D1 = ca.Function("D1", [a, b, v1, v2, mu, eta], [ca.gradient(L, a) + f0])
D2 = ca.Function("D2", [a, b, v1, v2, mu, eta], [ca.gradient(L, b) + f1])

sine = lambda mean, amplitude, period: lambda t: mean + amplitude * math.sin(2 * math.pi * t / period)
ramp = lambda start, end, begin, duration: lambda t: start + (end - start) * min(max((t - begin) / duration, 0), 1)
INPUTS = {
    "sine": (sine(800, 800, 0.15), lambda t: 0.0),
    "ramp": (lambda t: 0.0, ramp(0, 2000, 0.02, 0.05)),
    "both": (sine(1000, 500, 0.06), ramp(1500, 0, 0, 0.3)),
}


def recorded(name):
    lines = (Path(__file__).parents[2] / f"problems/measured/pair_{name}.csv").read_text().splitlines()
    return [float(row[1]) for row in list(csv.reader(line for line in lines if not line.startswith("#")))[1:]]


def solve(names):
    M, E = ca.SX.sym("M"), ca.SX.sym("E")
    unknowns, rows, f, guess = [], [], 0, []
    for name in names:
        q = [ca.SX(0)] + [ca.SX.sym(f"{name}{k}") for k in range(1, N + 1)]
        data, (first, second) = recorded(name), INPUTS[name]
        at = lambda k: (first((k + 0.5) * h), second((k + 0.5) * h), 1e5 * M, 1e3 * E)
        rows.append(D1(q[0], q[1], *at(0)))
        rows += [D2(q[k - 1], q[k], *at(k - 1)) + D1(q[k], q[k + 1], *at(k)) for k in range(1, N)]
        f += sum((0.5 if k in (0, N) else 1.0) * h * (q[k] - data[k]) ** 2 for k in range(N + 1))
        unknowns += q[1:]
        guess += data[1:]
    x, g = ca.vertcat(*unknowns, M, E), 1e3 * ca.vertcat(*rows)
    options = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-12, "ipopt.obj_scaling_factor": 1e6}
    solver = ca.nlpsol("S", "ipopt", {"x": x, "f": f, "g": g}, options)
    found = solver(x0=guess + [1.0, 1.0], lbg=0, ubg=0)
    status = solver.stats()["return_status"]
    print(names, status, "%.14e %.14e %.14e" % (float(found["f"]), 1e5 * float(found["x"][-2]), 1e3 * float(found["x"][-1])))


solve(["sine", "ramp", "both"])
solve(["sine"])
