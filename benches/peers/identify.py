"""Identification beside `mujoco.sysid`, SciPy, `pounce-solver` and CasADi: the same recordings, constants, standard errors and seconds.

    python identify.py target/release/proboscis

A mass on a spring that starts from twice its mass (a test of `mujoco.sysid`), a cart that coasts alone and with a payload, and 32 recordings
of a muscle-driven pair. Every program reads the same noisy readings; the run ends with an error where values differ by more than a standard
error of the recordings, or a covariance by more than 1e-4 of itself.
"""

import json
import logging
import pathlib
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np

logging.disable(logging.WARNING)
warnings.simplefilter("ignore")
PROBLEMS = pathlib.Path(__file__).parents[2] / "problems"


def proboscis(program, problem, folder):
    """Values, standard errors, covariance and the seconds of the program with those of its identification."""
    path = pathlib.Path(folder)
    path.mkdir(parents=True, exist_ok=True)
    (path / "problem.json").write_text(json.dumps(problem))
    began = time.perf_counter()
    done = subprocess.run([program, "solve", path / "problem.json", "-o", path / "found", "--no-report"], capture_output=True, text=True)
    seconds = time.perf_counter() - began
    if done.returncode not in (0, 1):
        raise SystemExit(done.stderr)
    summary = json.loads((path / "found" / "summary.json").read_text())
    errors = np.array([one.get("standard_error", np.nan) for one in summary["constants"]])
    correlation = np.array([[np.nan if c is None else c for c in row] for row in summary["correlation"]], dtype=float)
    return {
        "values": np.array([one.get("value", np.nan) for one in summary["constants"]]),
        "errors": errors,
        "covariance": correlation * np.outer(errors, errors),
        "seconds": seconds,
        "summary": summary,
    }


def same(title, own, other, covariance=None, limit=1.0):
    """Ends the run where values differ by more than some standard errors."""
    off = np.max(np.abs(own["values"] - other) / own["errors"])
    print(f"  {title}: {', '.join(f'{v:.7g}' for v in other)}; off by {off:.2g} standard errors", end="")
    if off > limit:
        raise SystemExit(f"\n{title}: values differ")
    if covariance is not None:
        off = np.max(np.abs(own["covariance"] / covariance - 1.0))
        print(f"; covariance by {off:.1e}", end="")
        if off > 1e-4:
            raise SystemExit(f"\n{title}: covariances differ")
    print()


# --- A mass on a spring, and a cart with a payload.


def cart(mass, damping, stiffness, payload="1 ug"):
    """A scene: a cart on a damped slide with a payload."""
    cube = {"size": ["0.1 m", "0.1 m", "0.1 m"]}
    scene = {
        "name": "cart",
        "bodies": [
            {"name": "cart", "mass": mass, "position": [0, 0, 0], "box": cube},
            {"name": "payload", "mass": payload, "position": [0, 0, 0], "box": cube},
        ],
        "joints": [
            {"name": "slide", "prismatic": {"axis": [1, 0, 0]}, "parent": "ground", "child": "cart", "at": [0, 0, 0], "damping": damping},
            {"name": "tray", "fixed": {}, "parent": "cart", "child": "payload", "at": [0, 0, 0]},
        ],
        "loads": [{"name": "push", "joint": "slide"}],
    }
    if stiffness:
        scene["joints"][0]["stiffness"] = stiffness
    return scene


XML = """<mujoco><option timestep="{step}" integrator="{integrator}"><flag contact="disable" gravity="disable"/></option>
<worldbody><body name="cart"><inertial pos="0 0 0" mass="{mass}" diaginertia="0.001 0.001 0.001"/>
<joint name="slide" type="slide" axis="1 0 0" stiffness="{stiffness}" damping="{damping}"/><geom type="sphere" size="0.05"/></body></worldbody>
<actuator><motor name="push" joint="slide"/></actuator><sensor><jointpos name="place" joint="slide"/></sensor></mujoco>"""


def mujoco_fit(groups, parameters):
    """Values and seconds of `mujoco.sysid`; a group has a payload in kg, and recordings of times, start and places."""
    import mujoco
    from mujoco import sysid

    params = sysid.ParameterDict()
    for name, nominal, low, high in parameters:
        params.add(sysid.Parameter(name, nominal=nominal, min_value=low, max_value=high))
    parts = []
    for index, (xml, payload, recordings) in enumerate(groups):
        spec = mujoco.MjSpec.from_string(xml)
        model = spec.compile()
        starts, controls, sensors = [], [], []
        for times, (place, rate), places in recordings:
            starts.append(sysid.create_initial_state(model, np.array([place]), np.array([rate]), np.zeros(0)))
            # Sensors of a step tell the state before it, under the time after it.
            later = np.append(times, times[-1] + times[1] - times[0])
            controls.append(sysid.TimeSeries(later, np.zeros((len(later), 1))))
            sensors.append(sysid.TimeSeries.from_names(later[1:], places.reshape(-1, 1), model))
        names = [f"recording{number}" for number in range(len(recordings))]
        group = sysid.ModelSequences(f"group{index}", spec, names, starts, controls, sensors)

        def build(values, spec, payload=payload):
            spec.body("cart").mass = values["mass"].value[0] + payload
            if "damping" in values:
                joint = spec.joint("slide")
                joint.damping = np.array([values["damping"].value[0], *np.ravel(joint.damping)[1:]])
            return spec.compile()

        parts.append(sysid.build_residual_fn(models_sequences=[group], build_model=build))

    def residual(x, p, **others):
        found = [part(x, p, **others) for part in parts]
        return tuple([one for part in found for one in (part[i] or [])] for i in range(3))

    began = time.perf_counter()
    found, _ = sysid.optimize(initial_params=params, residual_fn=residual, optimizer="mujoco", verbose=False)
    return np.array([found[name].value[0] for name, *_ in parameters]), time.perf_counter() - began


def closed_form(times, mass, damping, stiffness, place, rate):
    """Place of a mass on a spring with a damper, below critical damping, or of one that coasts."""
    decay = damping / (2 * mass)
    if not stiffness:
        return place + rate * (1 - np.exp(-2 * decay * times)) / (2 * decay)
    omega = np.sqrt(stiffness / mass - decay**2)
    return np.exp(-decay * times) * (place * np.cos(omega * times) + (rate + decay * place) / omega * np.sin(omega * times))


def references(model, places, deviation, guess):
    """Values and covariances of SciPy and of pounce-solver by a model in closed form, and the seconds of pounce-solver."""
    import pounce
    from scipy.optimize import least_squares

    guess = np.array(guess, dtype=float)
    found = least_squares(lambda p: (model(p) - places) / deviation, guess, jac="3-point", x_scale=np.maximum(np.abs(guess), 0.01), xtol=1e-15, ftol=1e-15)
    step = 1e-5 * np.maximum(np.abs(found.x), 0.1)
    jacobian = np.column_stack([(model(found.x + s) - model(found.x - s)) / (2 * d * deviation) for s, d in zip(np.diag(step), step)])
    began = time.perf_counter()
    fitted = pounce.curve_fit(lambda _, *p: model(np.array(p)), np.arange(len(places), dtype=float), places, p0=found.x * 1.02,
                              sigma=np.full(len(places), deviation), absolute_sigma=True)
    seconds = time.perf_counter() - began
    return found.x, np.linalg.inv(jacobian.T @ jacobian), np.array(fitted.popt), np.array(fitted.pcov), seconds


def spring_mass(program, folder):
    print("a mass on a spring, from twice its mass (1 kg)")
    random, deviation = np.random.default_rng(3), 1e-3
    times = 0.01 * np.arange(301)
    truth = closed_form(times, 1.0, 5.0, 100.0, 0.1, 0.0)
    places = truth + deviation * random.standard_normal(len(times))
    places[0] = truth[0]
    scene = cart("2 kg", "5 N s/m", "100 N/m")
    problem = {"scene": scene, "identify": {"free": {"bodies.cart.mass": {"min": "0.3 kg", "max": "3 kg"}}, "recordings": [{
        "name": "free", "columns": {"time [s]": list(times[1:]), "x [m]": list(places[1:])},
        "measured": [{"joint": "slide", "column": "x", "standard_deviation": deviation}],
        "experiment": {"start": {"joint_angles": {"slide": "0.1 m"}}}}]}}
    own = proboscis(program, problem, folder)
    report(own)
    model = lambda p: closed_form(times[1:], p[0], 5.0, 100.0, 0.1, 0.0)
    values, covariance, of_pounce, by_pounce, seconds = references(model, places[1:], deviation, [1.2])
    same("SciPy, closed form", own, values, covariance)
    same(f"pounce-solver, closed form ({seconds:.2f} s)", own, of_pounce, by_pounce)
    xml = XML.format(step=0.01, integrator="RK4", mass=2.0, stiffness=100, damping=5)
    values, seconds = mujoco_fit([(xml, 0.0, [(times, (0.1, 0.0), places)])], [("mass", 2.0, 0.3, 3.0)])
    same(f"mujoco.sysid ({seconds:.2f} s, {seconds / own['seconds']:.2f} of proboscis)", own, values)


def payload(program, folder):
    print("a cart that coasts (2 kg, 3 N s/m), alone and with a payload of 1 kg")
    random, deviation = np.random.default_rng(5), 1e-3
    times = 0.02 * np.arange(101)
    free = {"bodies.cart.mass": {"min": "0.5 kg", "max": "10 kg", "guess": "1.5 kg"},
            "joints.slide.damping": {"min": "0.5 N s/m", "max": "20 N s/m", "guess": "2 N s/m"}}
    recordings, all_places = [], []
    for name, load in (("alone", 0.0), ("loaded", 1.0)):
        places = closed_form(times, 2.0 + load, 3.0, 0.0, 0.0, 1.0) + deviation * random.standard_normal(len(times))
        all_places.append(places)
        recording = {"name": name, "columns": {"time [s]": list(times[1:]), "x [m]": list(places[1:])},
                     "measured": [{"joint": "slide", "column": "x", "standard_deviation": deviation}],
                     "experiment": {"sought_start": "state"}}
        if load:
            recording["set"] = {"scene.bodies.payload.mass": "1 kg"}
        recordings.append(recording)
    scene = cart("1.5 kg", "2 N s/m", None)
    problem = lambda recordings: {"scene": scene, "identify": {"free": free, "recordings": recordings}}
    alone = proboscis(program, problem(recordings[:1]), f"{folder}/alone")["summary"]
    print(f"  alone: {alone['status']}, {alone['undetermined'][0]['determined']}")
    own = proboscis(program, problem(recordings), f"{folder}/both")
    report(own)

    def model(p):
        parts = [closed_form(times[1:], p[0] + load, p[1], 0.0, p[2 + 2 * i], p[3 + 2 * i]) for i, load in enumerate((0.0, 1.0))]
        return np.concatenate(parts)

    data = np.concatenate([places[1:] for places in all_places])
    values, covariance, of_pounce, by_pounce, seconds = references(model, data, deviation, [2.1, 2.9, 0.0, 1.0, 0.0, 1.0])
    same("SciPy, closed form, starts sought", own, values[:2], covariance[:2, :2])
    same(f"pounce-solver, closed form ({seconds:.2f} s)", own, of_pounce[:2], by_pounce[:2, :2])
    xml = XML.format(step=0.02, integrator="RK4", mass=1.5, stiffness=0, damping=2)
    groups = [(xml, load, [(times, (0.0, 1.0), places)]) for load, places in zip((0.0, 1.0), all_places)]
    values, seconds = mujoco_fit(groups, [("mass", 1.5, 0.5, 10.0), ("damping", 2.0, 0.5, 20.0)])
    # It knows the starts, which are sought here: more data.
    same(f"mujoco.sysid, starts known ({seconds:.2f} s, {seconds / own['seconds']:.2f} of proboscis)", own, values, limit=3.0)


def report(own):
    grid = own["summary"]["grid"]
    values = zip(own["values"], own["errors"])
    print(f"  proboscis: {', '.join(f'{v:.7g} +- {e:.2g}' for v, e in values)}; {own['seconds']:.2f} s, {grid['halvings']} halvings")


def pair(program, folder, count=32, duration=1.0):
    print(f"{count} recordings of {duration} s of a pair of muscles (123 kPa, 640 Pa s)")
    random, deviation = np.random.default_rng(7), 5e-4
    scene = str(PROBLEMS / "scenes" / "pair.json")
    times = 0.01 * np.arange(int(round(duration / 0.01)) + 1)
    recordings = []
    for index in range(count):
        level = 1200.0 + 1200.0 * index / count
        voltages = {f"muscle{1 + index % 2}": {"ramp": {"to": level, "duration": "0.05 s"}}}
        path = pathlib.Path(folder) / f"twin{index}"
        path.mkdir(parents=True)
        (path / "p.json").write_text(json.dumps({"scene": scene, "simulate": {"duration": duration, "step": "0.5 ms", "voltages": voltages}}))
        subprocess.run([program, "simulate", path / "p.json", "-o", path / "out", "--no-report", "--set", "scene.materials.silicone.shear_modulus=123 kPa",
                        "--set", "scene.materials.silicone.viscosity=640 Pa s"], check=True, capture_output=True)
        lines = [line.split(",") for line in (path / "out" / "trajectory.csv").read_text().splitlines() if not line.startswith("#")]
        column = [header.split(" [")[0] for header in lines[0]].index("joint1")
        angles = np.array([float(line[column]) for line in lines[1:]])[::20] + deviation * random.standard_normal(len(times))
        recordings.append({"name": f"ramp{index}", "columns": {"time [s]": list(times), "angle [rad]": list(angles)},
                           "measured": [{"joint": "joint1", "column": "angle", "standard_deviation": deviation}],
                           "experiment": {"voltages": voltages}})
    free = {"materials.silicone.shear_modulus": {"min": "50 kPa", "max": "500 kPa"}, "materials.silicone.viscosity": {"min": "100 Pa s", "max": "5000 Pa s"}}
    own = proboscis(program, {"scene": scene, "identify": {"free": free, "recordings": recordings, "step": "10 ms"}}, f"{folder}/own")
    report(own)
    expanded = json.loads(subprocess.run([program, "expand", scene], check=True, capture_output=True, text=True).stdout)
    found = []
    for intervals in (100, 200, 400):
        values, built, seconds, iterations = casadi_pair(expanded, recordings, intervals, duration, deviation)
        found.append(values)
        off = np.abs(own["values"] - values) / own["errors"]
        print(f"  CasADi, {intervals} midpoint steps (build {built:.1f} s, solve {seconds:.1f} s, {iterations} iterations, {seconds / own['seconds']:.2f} "
              f"of proboscis): {values[0]:.7g}, {values[1]:.7g}; off by {off.max():.2g} standard errors")
    same("both last ones extrapolated", own, (4 * found[2] - found[1]) / 3, limit=5.0)


def casadi_pair(scene, recordings, intervals, duration, deviation):
    """Modulus in Pa and viscosity in Pa s with all motions as unknowns, by Ipopt with exact derivatives: the midpoint rule, without extrapolation."""
    import casadi as ca
    from casadi_trunk import Trunk

    began = time.perf_counter()
    trunk = Trunk(scene)
    constants = ca.SX.sym("mu"), ca.SX.sym("viscosity")
    for muscle in trunk.muscles:
        muscle["mu"], muscle["viscosity"] = 0.1 * constants[0], constants[1]
    h = 1e3 * duration / intervals
    each = trunk.interval(constants).map(intervals)
    p = ca.MX.sym("p", 2)
    unknowns, rows, cost, guess = [p], [], 0, [1.0, 1.0]
    middles = (np.arange(intervals) + 0.5) * h
    stride = intervals // (len(recordings[0]["columns"]["time [s]"]) - 1)
    for recording in recordings:
        (name, ramp), = recording["experiment"]["voltages"].items()
        volts = np.zeros((len(trunk.muscles), intervals))
        volts[[muscle["name"] for muscle in trunk.muscles].index(name)] = ramp["ramp"]["to"] * np.minimum(middles / 50.0, 1.0)
        angles = ca.MX.sym(recording["name"], 1, intervals)
        path = ca.horzcat(0, angles)
        early, late = each(path[:, :-1], path[:, 1:], volts**2, h, ca.repmat(p[0], 1, intervals), ca.repmat(p[1], 1, intervals))
        rows.append(ca.vec(early + ca.horzcat(0, late[:, :-1])))
        data = np.array(recording["columns"]["angle [rad]"])
        cost += ca.sumsqr((path[:, ::stride].T - data) / deviation) / 2
        unknowns.append(ca.vec(angles))
        guess += list(np.interp(np.arange(1, intervals + 1), stride * np.arange(len(data)), data))
    program = {"x": ca.vertcat(*unknowns), "f": cost, "g": ca.vertcat(*rows)}
    solver = ca.nlpsol("solver", "ipopt", program, {"ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-8}, "print_time": False})
    built = time.perf_counter() - began
    began = time.perf_counter()
    found = solver(x0=guess, lbg=0, ubg=0)
    if not solver.stats()["success"]:
        raise SystemExit(f"CasADi: {solver.stats()['return_status']}")
    values = np.array(found["x"]).ravel()[:2] * [1e5, 1e3]
    return values, built, time.perf_counter() - began, solver.stats()["iter_count"]


def main():
    # Ahead of what mujoco.sysid prints by itself.
    sys.stdout.reconfigure(line_buffering=True)
    with tempfile.TemporaryDirectory() as folder:
        spring_mass(sys.argv[1], f"{folder}/spring")
        payload(sys.argv[1], f"{folder}/payload")
        pair(sys.argv[1], f"{folder}/pair")
    return 0


if __name__ == "__main__":
    sys.exit(main())
