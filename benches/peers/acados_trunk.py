"""A figure of eight of the elephant trunk under random pushes, by proboscis and by acados: the same reference, costs, pushes and robot.

    python acados_trunk.py target/release/proboscis target/release/libproboscis_c.so

proboscis solves the figure of eight, which begins and ends at rest, and writes its reference motion with inputs (`feedback.json`). Both controllers
plan 20 intervals of 2.5 ms anew in each of them, with costs of joints and of squared voltages, bounds of the voltages, and the cost of a
linear-quadratic regulator at the end. acados has equations of its own, in rates in place of momenta, by the implicit midpoint rule; a step of SQP_RTI
with HPIPM solves its quadratic program to the end. proboscis takes one iteration of its interior-point method. The robot is a third program: the same
equations in steps of a quarter of an interval. The run ends with an error if the tips of the reference or its intervals differ.
"""

import ctypes
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import acados
import casadi as ca
import numpy as np


def installed():
    """The folders of the wheel as those of acados built from source."""
    place = pathlib.Path(tempfile.mkdtemp(prefix="acados-"))
    (place / "interfaces" / "acados_template").mkdir(parents=True)
    (place / "interfaces" / "acados_template" / "acados_template").symlink_to(acados.TEMPLATE_DIR)
    for folder in ("bin", "include", "lib"):
        (place / folder).symlink_to(pathlib.Path(acados.DIR) / folder)
    return str(place)


sys.path.insert(0, str(pathlib.Path(acados.TEMPLATE_DIR).parent))
os.environ["ACADOS_SOURCE_DIR"] = installed()
os.environ["TERA_PATH"] = acados.TERA_PATH
for library in ("blasfeo", "hpipm", "qpOASES_e"):
    ctypes.CDLL(f"{acados.LIB_DIR}/lib{library}.so", mode=ctypes.RTLD_GLOBAL)
from acados_template import AcadosModel, AcadosOcp, AcadosOcpSolver  # noqa: E402
from casadi_trunk import Trunk  # noqa: E402

PROBLEMS = pathlib.Path(__file__).parents[2] / "problems"
SCENE = PROBLEMS / "scenes" / "elephant_trunk.json"
INTERVAL, INTERVALS, AHEAD, LATER = 2.5, 800, 20, 80
BETWEEN, SEED, WEIGHT, MOST = 60, 35, 0.01, 9.0
# Processor time of all threads, so that a busy machine matters less.
clock = time.process_time
DEGREE = np.pi / 180
KILOVOLT = 1e3

PROBLEM = {
    "scene": str(SCENE),
    "control": {
        "duration": f"{1e-3 * INTERVAL * INTERVALS} s", "intervals": INTERVALS,
        "start": {"rest_at_voltages": {}}, "goal": {"rest_at_voltages": {}}, "voltage_bounds": ["0 V", "3 kV"],
        "objective": {"rate": 1e-4, "track": [{"marker": {"marker": "tip", "along": {
            "x": {"sine": {"amplitude": "40 mm", "period": "2 s"}}, "z": {"sine": {"amplitude": "20 mm", "period": "1 s"}}}}}]},
    },
    "feedback": {"step": f"{INTERVAL} ms", "weights": {"voltages": WEIGHT}},
}


class Equations:
    """Equations of motion in angles and rates: residual of q, q', q'' and squares of voltages in kV²."""

    def __init__(self, scene):
        trunk = Trunk(scene)
        n, m = len(trunk.joints), len(trunk.muscles)
        q, v, a, w = ca.SX.sym("q", n), ca.SX.sym("v", n), ca.SX.sym("a", n), ca.SX.sym("w", m)
        # All that inertia and muscles read, with its acceleration, and the forces on it: one product with the Jacobian of the places.
        vectors = trunk.vectors(q)
        places = ca.vertcat(*vectors[0], *(ca.vec(axes) for axes in vectors[1]), *vectors[2], *vectors[3])
        (places,) = ca.cse([places])
        rate = ca.jtimes(places, q, v)
        masses = [[mass] * 3 for mass, _, _ in trunk.bodies] + [np.repeat(euler, 3) for _, euler, _ in trunk.bodies]
        masses += [[muscle["mass"]] * 3 for muscle in trunk.muscles] + [[muscle["mass"] / 12] * 3 for muscle in trunk.muscles]
        masses = ca.DM(np.concatenate(masses))
        forces = masses * (ca.jtimes(rate, q, v) + ca.jtimes(places, q, a))
        spans = [ca.SX.sym(f"span{i}", 3) for i in range(m)]
        energy = ca.Function("energy", [*spans, w], [ca.gradient(trunk.energy(spans, w * KILOVOLT**2), ca.vertcat(*spans))])
        first = places.numel() - 3 * m
        of_muscles = energy(*vectors[3], w)
        for i, (muscle, r) in enumerate(zip(trunk.muscles, vectors[3])):
            part = slice(first + 3 * i, first + 3 * i + 3)
            viscous = 1.5 * muscle["viscosity"] * muscle["volume"] * ca.dot(r, rate[part]) / ca.dot(r, r) ** 2 * r
            forces[part] += of_muscles[3 * i:3 * i + 3] + viscous
        rows = ca.jtimes(places, q, forces, True)
        (rows,) = ca.cse([rows])
        by_places = ca.jacobian(places, q)
        self.n, self.m, self.variables, self.rows = n, m, (q, v, a, w), rows
        self.names = [muscle["name"] for muscle in trunk.muscles]
        self.mass = ca.Function("mass", [q], [by_places.T @ (ca.diag(masses) @ by_places)])
        tip = trunk.vectors(q)
        last = len(trunk.bodies) - 1
        # The marker is half a segment above the centre of the last body, along its axis.
        self.tip = ca.Function("tip", [q], [tip[0][last] + 25.0 * tip[1][last][:, 1]])
        # A step of the implicit midpoint rule: the middle is unknown.
        x, y, h = ca.SX.sym("x", 2 * n), ca.SX.sym("y", 2 * n), ca.SX.sym("h")
        middle, change = (x + y) / 2, (y - x) / h
        of = ca.Function("of", [q, v, a, w], [rows])
        step = ca.vertcat(change[:n] - middle[n:], of(middle[:n], middle[n:], change[n:], w))
        self.step = ca.Function("step", [x, y, w, h], ca.cse([step, ca.jacobian(step, y)]))
        self.linear = ca.Function("linear", [x, y, w, h], ca.cse([ca.jacobian(step, s) for s in (x, y, w)]))

    def after(self, x, w, h):
        """The state after a step, by Newton's method."""
        y = np.array(x)
        for _ in range(30):
            residual, jacobian = (np.array(one) for one in self.step(x, y, w, h))
            change = np.linalg.solve(jacobian, residual).ravel()
            y = y - change
            if np.abs(change).max() < 1e-12:
                return y
        raise SystemExit("a step of the robot does not converge")

    def go(self, x, w, parts=4):
        """The robot after an interval."""
        for _ in range(parts):
            x = self.after(x, w, INTERVAL / parts)
        return x

    def linearised(self, x, w):
        """A and B of an interval."""
        by_x, by_y, by_w = (np.array(one) for one in self.linear(x, self.after(x, w, INTERVAL), w, INTERVAL))
        return -np.linalg.solve(by_y, by_x), -np.linalg.solve(by_y, by_w)


def solved(program, folder):
    """The problem file, and states in rad and rad/ms and squares of inputs in kV² of its reference, the last for the time after its end."""
    file = folder / "eight.json"
    file.write_text(json.dumps(PROBLEM))
    subprocess.run([program, "solve", file, "-o", folder / "eight", "--no-report", "--quiet"], check=True)
    law = json.loads((folder / "eight" / "feedback.json").read_text())
    points = law["intervals"] + [law["held"]]
    states = np.array([point["state"] for point in points])
    states[:, 6:] *= 1e-3
    gains = np.array([point["gain"] for point in points]) / KILOVOLT**2
    gains[:, :, 6:] *= 1e3
    return file, law, states, (np.array([point["inputs"] for point in points]) / KILOVOLT) ** 2, gains


def costs(n, m):
    """Q and R over states in rad and rad/ms and squares in kV²."""
    return np.diag([DEGREE**-2] * n + [0.0] * n), WEIGHT / MOST**2 * np.eye(m)


def ends(equations, states, squares):
    """Costs of all that follows an instant, backward from the goal that is held."""
    q, r = costs(equations.n, equations.m)

    def step(s, x, w):
        a, b = equations.linearised(x, w)
        gain = np.linalg.solve(r + b.T @ s @ b, b.T @ s @ a)
        s = q + a.T @ s @ (a - b @ gain)
        return (s + s.T) / 2

    s = np.array(q)
    a, b = equations.linearised(states[-1], squares[-1])
    for _ in range(20000):
        gain = np.linalg.solve(r + b.T @ s @ b, b.T @ s @ a)
        after = q + a.T @ s @ (a - b @ gain)
        change, s = np.abs(after - s).max() / np.abs(after).max(), (after + after.T) / 2
        if change < 1e-13:
            break
    out = [s]
    for x, w in zip(states[-2::-1], squares[-2::-1]):
        out.append(step(out[-1], x, w))
    return out[::-1]


class ByAcados:
    name = "acados, SQP_RTI, HPIPM"

    def __init__(self, equations, states, squares, folder):
        self.states, self.squares = states, squares
        self.ends = ends(equations, states, squares)
        n, m = equations.n, equations.m
        q, v, a, w = equations.variables
        rate = ca.SX.sym("rate", n)
        model = AcadosModel()
        model.name = "trunk"
        model.x, model.xdot, model.u = ca.vertcat(q, v), ca.vertcat(rate, a), w
        model.f_impl_expr = ca.vertcat(rate - v, equations.rows)
        ocp = AcadosOcp()
        ocp.model = model
        ocp.dims.N = AHEAD
        ocp.solver_options.tf = AHEAD * INTERVAL
        weights = costs(n, m)
        ocp.cost.cost_type = ocp.cost.cost_type_e = "LINEAR_LS"
        ocp.cost.Vx = np.vstack([np.eye(2 * n), np.zeros((m, 2 * n))])
        ocp.cost.Vu = np.vstack([np.zeros((2 * n, m)), np.eye(m)])
        ocp.cost.Vx_e = np.eye(2 * n)
        # Costs of stages are multiplied by their length.
        ocp.cost.W = np.block([[weights[0], np.zeros((2 * n, m))], [np.zeros((m, 2 * n)), weights[1]]]) / INTERVAL
        ocp.cost.W_e = self.ends[AHEAD]
        ocp.cost.yref, ocp.cost.yref_e = np.zeros(2 * n + m), np.zeros(2 * n)
        ocp.constraints.lbu, ocp.constraints.ubu = np.zeros(m), MOST * np.ones(m)
        ocp.constraints.idxbu = np.arange(m)
        ocp.constraints.x0 = states[0]
        options = ocp.solver_options
        options.qp_solver, options.hessian_approx, options.nlp_solver_type = "PARTIAL_CONDENSING_HPIPM", "GAUSS_NEWTON", "SQP_RTI"
        options.integrator_type, options.sim_method_num_stages, options.sim_method_num_steps, options.sim_method_newton_iter = "IRK", 1, 1, 3
        options.ext_fun_compile_flags = "-O2"
        here = os.getcwd()
        os.chdir(folder)
        began = time.perf_counter()
        self.solver = AcadosOcpSolver(ocp, json_file="trunk.json")
        print(f"acados: code made and compiled in {time.perf_counter() - began:.0f} s", flush=True)
        os.chdir(here)

    def begin(self):
        self.solver.reset()
        for j in range(AHEAD + 1):
            self.solver.set(j, "x", self.at(self.states, j))
            if j < AHEAD:
                self.solver.set(j, "u", self.at(self.squares, j))
        self.prepare(0)
        self.times, self.others = [], 0

    @staticmethod
    def at(rows, k):
        return rows[min(k, len(rows) - 1)]

    def prepare(self, k):
        solver = self.solver
        for j in range(AHEAD):
            solver.set(j, "yref", np.concatenate([self.at(self.states, k + j), self.at(self.squares, k + j)]))
        solver.set(AHEAD, "yref", self.at(self.states, k + AHEAD))
        solver.cost_set(AHEAD, "W", self.at(self.ends, k + AHEAD))
        solver.options_set("rti_phase", 1)
        began = clock()
        solver.solve()
        self.preparation = clock() - began

    def inputs(self, k, state):
        solver = self.solver
        solver.set(0, "lbx", state)
        solver.set(0, "ubx", state)
        solver.options_set("rti_phase", 2)
        began = clock()
        self.others += solver.solve() != 0
        self.times.append((clock() - began, self.preparation))
        w = np.array(solver.get(0, "u"))
        # The plan, an interval later.
        xs, us = [solver.get(j, "x") for j in range(AHEAD + 1)], [solver.get(j, "u") for j in range(AHEAD)]
        for j in range(AHEAD):
            solver.set(j, "x", xs[j + 1])
            solver.set(j, "u", us[min(j + 1, AHEAD - 1)])
        solver.set(AHEAD, "x", self.at(self.states, k + 1 + AHEAD) + xs[AHEAD] - self.at(self.states, k + AHEAD))
        self.prepare(k + 1)
        return np.clip(w, 0.0, MOST)


class ByProboscis:
    name = "proboscis, C library"

    def __init__(self, library, file):
        self.file, self.controller = file, None
        self.library = library = ctypes.CDLL(library)
        library.proboscis_create.restype = ctypes.c_void_p
        library.proboscis_create.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
        numbers = ctypes.POINTER(ctypes.c_double)
        library.proboscis_step.argtypes = [ctypes.c_void_p, ctypes.c_double, numbers, numbers]
        library.proboscis_prepare.argtypes = library.proboscis_free.argtypes = [ctypes.c_void_p]
        self.measured, self.volts = (ctypes.c_double * 12)(), (ctypes.c_double * 12)()

    def begin(self):
        self.library.proboscis_free(self.controller)
        message = ctypes.create_string_buffer(1000)
        self.controller = self.library.proboscis_create(str(self.file).encode(), AHEAD, message, len(message))
        if not self.controller:
            raise SystemExit(message.value.decode())
        self.times, self.others = [], 0

    def inputs(self, k, state):
        self.measured[:] = [*state[:6], *(1e3 * state[6:])]
        began = clock()
        source = self.library.proboscis_step(self.controller, 1e-3 * INTERVAL * k, self.measured, self.volts)
        stepped = clock()
        self.library.proboscis_prepare(self.controller)
        prepared = clock()
        self.times.append((stepped - began, prepared - stepped))
        self.others += source != 0
        return (np.array(self.volts[:]) / KILOVOLT) ** 2


class ByGains:
    name = "gains of proboscis"

    def __init__(self, states, squares, gains):
        self.law = states, squares, gains

    def begin(self):
        self.times, self.others = [], 0

    def inputs(self, k, state):
        x, w, gain = (rows[min(k, len(rows) - 1)] for rows in self.law)
        return np.clip(w - gain @ (state - x), 0.0, MOST)


class Open(ByGains):
    name = "no feedback"

    def inputs(self, k, state):
        return self.law[1][min(k, len(self.law[1]) - 1)]


def followed(equations, controller, states, pushes):
    """Distances of the tip from the reference in mm at all instants."""
    x, off = np.array(states[0]), []
    for k in range(len(pushes)):
        reference = states[min(k, len(states) - 1)]
        off.append(np.linalg.norm(np.array(equations.tip(x[:6])) - np.array(equations.tip(reference[:6]))))
        x = equations.go(x, controller.inputs(k, x))
        if pushes[k].any():
            x[6:] += np.linalg.solve(np.array(equations.mass(x[:6])), pushes[k])
    return np.array(off)


def main():
    program, library = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:3])
    scene = json.loads(subprocess.run([program, "expand", SCENE], check=True, capture_output=True, text=True).stdout)
    equations = Equations(scene)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="eight-"))
    file, law, states, squares, gains = solved(program, folder)
    if [one["name"] for one in law["inputs"]] != equations.names:
        raise SystemExit("muscles have another order")
    tip = 1e3 * np.array(law["markers"]["tip"])
    wrong = max(np.linalg.norm(np.array(equations.tip(x[:6])).ravel() - place) for x, place in zip(states, tip))
    print(f"tips of both models differ by {wrong:.1e} mm", flush=True)
    steps = zip(states[:-1], squares, states[1:])
    far = max(np.abs(equations.after(x, w, INTERVAL) - after)[:6].max() for x, w, after in steps)
    print(f"intervals of the reference differ by {far:.1e} rad, by two midpoint rules", flush=True)
    if wrong > 1e-6 or far > 1e-4:
        raise SystemExit("another reference")
    controllers = [Open(states, squares, gains), ByGains(states, squares, gains), ByProboscis(library, file)]
    controllers.append(ByAcados(equations, states, squares, folder))
    print("| pushes up to, g mm²/ms | controller | tip off: rms, mm | greatest | at the end | other answers | step, ms: median | 99 % | preparation: median | 99 % |")
    print("|--:|:--|--:|--:|--:|--:|--:|--:|--:|--:|", flush=True)
    for size in (300.0, 1000.0, 3000.0):
        random = np.random.default_rng(SEED)
        pushes = np.zeros((INTERVALS + LATER, 6))
        pushed = pushes[BETWEEN - 1:INTERVALS:BETWEEN]
        pushed[:] = random.uniform(-size, size, pushed.shape)
        for controller in controllers:
            controller.begin()
            off = followed(equations, controller, states, pushes)
            times = 1e3 * np.array(controller.times)
            cells = [f"{size:g}", controller.name, f"{np.sqrt((off**2).mean()):.3f}", f"{off.max():.2f}", f"{off[-1]:.3f}", str(controller.others)]
            for part in (times[:, 0], times[:, 1]) if len(times) else ((), ()):
                cells += [f"{np.quantile(part, p):.3f}" if len(part) else "" for p in (0.5, 0.99)]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
