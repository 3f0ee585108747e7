"""The elephant trunk written for CasADi, beside proboscis: what one interval adds to the equations of motion.

Reads the scene as `proboscis expand` prints it. Midpoint rule on the vectors x = F(theta) of bodies and spans, DMOCC in joint
angles. Nothing but the files is shared with proboscis: forward kinematics, energies and rows are written out here.
"""

import subprocess
from pathlib import Path

import casadi as ca
import numpy as np

# Units: g, mm, ms, N, MPa, V.
UNITS = {
    "kg": 1e3, "g": 1.0, "m": 1e3, "cm": 10.0, "mm": 1.0, "um": 1e-3, "s": 1e3, "ms": 1.0,
    "Pa": 1e-6, "kPa": 1e-3, "MPa": 1.0, "V": 1.0, "kV": 1e3, "Pa s": 1e-3, "kg/m^3": 1e-6, "g/cm^3": 1e-3,
}
VACUUM_PERMITTIVITY = 8.854187817e-12
KILOVOLT = 1e3


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

    def energy(self, spans, squares):
        """Electro-elastic energy of all muscles, by squares of their voltages in V²."""
        total = 0
        for muscle, r, square in zip(self.muscles, spans, ca.vertsplit(squares)):
            i = ca.dot(r, r) / muscle["length"] ** 2
            elastic = muscle["mu"] / 2 * (2 / ca.sqrt(i) + i - 3)
            electric = muscle["c1"] + muscle["c2"] * i - VACUUM_PERMITTIVITY / (2 * i)
            total += muscle["volume"] * (elastic + electric * square / muscle["layer"] ** 2)
        return total

    def interval(self, constants=()):
        """Rows that an interval adds to its two instants, as functions of both angles, of squares of its voltages in V² and of sought constants."""
        n, m = len(self.joints), len(self.muscles)
        a, b, squares, h = ca.SX.sym("a", n), ca.SX.sym("b", n), ca.SX.sym("squares", m), ca.SX.sym("h")
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
        action = h * (kinetic - self.energy(means, squares))
        rows = [ca.gradient(action, a), ca.gradient(action, b)]
        for muscle, r, rate, ra, rb in zip(self.muscles, means, rates[3], xa[3], xb[3]):
            force = -1.5 * muscle["viscosity"] * muscle["volume"] * ca.dot(r, rate) / ca.dot(r, r) ** 2 * r
            rows[0] += ca.jtimes(ra, a, h / 2 * force, True)
            rows[1] += ca.jtimes(rb, b, h / 2 * force, True)
        return ca.Function("interval", [a, b, squares, h, *constants], rows)

    def equilibrium(self, voltages):
        """Joint angles at rest under voltages in V, by Newton from the straight trunk."""
        n, m = len(self.joints), len(self.muscles)
        theta, v = ca.SX.sym("theta", n), ca.SX.sym("v", m)
        energy = self.energy(self.vectors(theta)[3], v**2)
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


INTERVAL = ("rows", "rows_jacobian", "rows_hessian")


def interval_functions(trunk, unit):
    """Rows of an interval, their Jacobian, and Hessian and gradient along costates, of both ends and of V²/unit in kV, or V in kV without a unit."""
    n, m = len(trunk.joints), len(trunk.muscles)
    a, b, w, h = ca.SX.sym("a", n), ca.SX.sym("b", n), ca.SX.sym("w", m), ca.SX.sym("h")
    la, lb = ca.SX.sym("la", n), ca.SX.sym("lb", n)
    squares = w * unit if unit else w**2
    early, late = ca.cse(list(trunk.interval()(a, b, squares * KILOVOLT**2, h)))
    z, rows = ca.vertcat(a, b, w), ca.vertcat(early, late)
    hessian, gradient = ca.hessian(ca.dot(ca.vertcat(la, lb), rows), z)
    jacobian, hessian, gradient = ca.cse([ca.jacobian(rows, z), hessian, ca.densify(gradient)])
    given = [a, b, w, h]
    outputs = [early, late], [early, late, jacobian], [hessian, gradient]
    inputs = given, given, given + [la, lb]
    return tuple(ca.Function(*each) for each in zip(INTERVAL, inputs, outputs))


def compile_interval(trunk, unit, library):
    """Hands the functions of one interval to the C compiler; they hold for any number of intervals."""
    library = Path(library)
    generator = ca.CodeGenerator(library.stem + ".c")
    for function in interval_functions(trunk, unit):
        generator.add(function)
    generator.generate(f"{library.parent}/")
    subprocess.run(["gcc", "-O1", "-fPIC", "-shared", library.with_suffix(".c"), "-o", library], check=True)


def compiled_interval(library):
    return tuple(ca.external(name, str(library)) for name in INTERVAL)
