"""A ball that bounces and one that rolls: MuJoCo and Exudyn beside proboscis, one core each, against closed forms.

    python contact.py PROGRAM

PROGRAM is proboscis. The bouncing ball falls on a spring without damping from five heights, so that a touch begins
anywhere within a step: errors are the greatest ones of three apexes and of the third impact. The rolling ball goes down
a slope below the limit of slip, tan a = 7/2 of the coefficient of friction, and one above it: errors are those of the
distance. All programs have the same steps. Damping is not compared, as its laws differ. Seconds are processor times of
the steps for one second of motion, least of three alternating runs; start, files and what is observed do not count. The
run ends with an error where an answer with the shortest steps is off.

* proboscis: the midpoint rule, its default.
* MuJoCo, by its `rollout`: the semi-implicit Euler rule, its default, and RK4; `implicit` and `implicitfast` give the
  same as Euler here and take longer. `solimp` d takes the part d of gravity from a ball that touches. The spring is the
  limit d = 0, and the bouncing ball has the least d that MuJoCo accepts, 0.0001, with `solref` for the stiffness over
  the mass. The rolling ball has d = 0.9999, the default time constant of 20 ms and the elliptic cone: with a short time
  constant a ball that slips hops, up to 2 mm.
* Exudyn: a sphere on a triangle, the implicit trapezoidal rule, three angles as rotations, of which rolling turns one
  alone. Its iteration over states of contact stops at 0.1 mN in place of 1 N. Its contacts recommend shorter steps at
  impacts (`useRecommendedStepSize`, the default); the bouncing ball is shown without and with them.

Needs `mujoco`, `exudyn`, `numpy` and gcc.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for name in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"]:
    os.environ[name] = "1"
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

sys.exudynFast = True  # Exudyn without checks of ranges

import exudyn as exu
import mujoco
import mujoco.rollout
import numpy as np
from exudyn.utilities import (
    InertiaSphere, MarkerBodyRigid, MarkerNodeRigid, NodeGenericData, ObjectContactSphereTriangle, ObjectGround, SensorNode, VObjectGround,
)

# Units: g, mm, ms, N; those of MuJoCo are SI.
MASS, RADIUS, GRAVITY = 20.0, 10.0, 9.81e-3
STEPS = [1.0, 0.5, 0.25, 0.125]
REPEATS = 3
#: Stiffness, heights above the floor at the start, and duration of the bouncing ball.
SPRING, DROPS, BOUNCING = 10.0, [70.0, 70.3, 70.6, 70.9, 71.2], 800.0
#: Stiffness, coefficient of friction, speed up to which it grows, slopes in degrees and duration of the rolling ball.
FIRM, FRICTION, SLIP, SLOPES, ROLLING = 1000.0, 0.4, 1e-4, [20.0, 65.0], 500.0
#: d of `solimp` of MuJoCo's rolling ball, and its time constant.
IMPEDANCE, RECOVERY = 0.9999, 20.0
#: Half of the side of Exudyn's triangle.
FLOOR = 3000.0
#: Largest errors with the shortest steps: apexes in mm, the third impact in ms, distances in mm.
APART = {"apexes, mm": 0.5, "third impact, ms": 1.0, "rolling, mm": 0.5, "slipping, mm": 0.5}

CLOCK = Path(__file__).resolve().parent / "processor_clock.c"


def third_impact(drop):
    """Time of the third impact: a flight is a parabola, a touch a part of an oscillation about rest on the spring."""
    fall = np.sqrt(2 * drop / GRAVITY)
    frequency = np.sqrt(SPRING / MASS)
    touch = 2 / frequency * (np.pi - np.arctan(frequency * fall))
    return 5 * fall + 2 * touch


def distance(slope):
    """Distance down the slope, without slip below its limit and with slip above."""
    if np.tan(slope) <= 3.5 * FRICTION:
        acceleration = 5 / 7 * GRAVITY * np.sin(slope)
    else:
        acceleration = GRAVITY * (np.sin(slope) - FRICTION * np.cos(slope))
    return acceleration * ROLLING**2 / 2


def errors_of_bounces(times, heights, drop):
    """Greatest error of three apexes, and that of the third impact, by parabolas through three places in flight."""
    impacts = [i for i in range(3, len(heights)) if heights[i - 1] > 0 >= heights[i]]
    if len(impacts) < 3:
        return np.inf, np.inf
    apexes = []
    for start, end in zip(impacts, (impacts + [len(heights)])[1:4]):
        top = start + np.argmax(heights[start:end])
        if top + 1 < len(heights):
            a, b, c = np.polyfit(times[top - 1 : top + 2] - times[top], heights[top - 1 : top + 2], 2)
            apexes.append(c - b * b / (4 * a))
    before = slice(impacts[2] - 3, impacts[2])
    a, b, c = np.polyfit(times[before] - times[impacts[2] - 1], heights[before], 2)
    moment = times[impacts[2] - 1] + (-b - np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return np.abs(np.array(apexes) - drop).max(), abs(moment - third_impact(drop))


class Proboscis:
    """proboscis, whose clock shows the processor time of its thread."""

    def __init__(self, program, folder):
        self.program, self.folder, self.clock = program, folder, f"{folder}/processor_clock.so"
        subprocess.run(["gcc", "-O1", "-fPIC", "-shared", CLOCK, "-o", self.clock], check=True)

    def motion(self, step, duration, height, contact, gravity):
        """Times, places of the centre, and seconds of the steps."""
        at = [0, f"{height!r} mm", 0]
        plane = {"at": [0, 0, 0], "normal": [0, 1, 0]}
        scene = {
            "name": "ball",
            "bodies": [{"name": "ball", "mass": f"{MASS} g", "sphere": {"radius": f"{RADIUS} mm"}, "position": at, "free": True}],
            "contacts": [{"name": "floor", "sphere": {"body": "ball", "at": at, "radius": f"{RADIUS} mm"}, "plane": plane, **contact}],
            "markers": [{"name": "centre", "body": "ball", "at": at}],
            "gravity": [f"{1e3 * part!r} m/s^2" for part in gravity],
        }
        task = {
            "scene": scene, "simulate": {"duration": f"{duration} ms", "step": f"{step} ms"},
            "output": {"every": f"{step} ms", "quantities": ["centre"]},
        }
        with open(f"{self.folder}/problem.json", "w") as file:
            json.dump(task, file)
        subprocess.run(
            [self.program, "simulate", "problem.json", "-o", "out", "--quiet"], cwd=self.folder, check=True, capture_output=True,
            env=os.environ | {"LD_PRELOAD": self.clock},
        )
        with open(f"{self.folder}/out/summary.json") as file:
            summary = json.load(file)
        with open(f"{self.folder}/out/trajectory.csv") as file:
            rows = [line.rstrip("\n").split(",") for line in file if not line.startswith("#")]
        names = [name.split(" ")[0] for name in rows[0]]
        columns = [names.index(name) for name in ["time", "centre_x", "centre_y"]]
        table = np.array([[float(row[column]) for column in columns] for row in rows[1:]])
        return table[:, 0], table[:, 1:], summary["seconds"]["solver"]

    def bounce(self, step, drop):
        times, places, seconds = self.motion(
            step, BOUNCING, RADIUS + drop, {"stiffness": f"{SPRING} N/mm"}, [0.0, -GRAVITY, 0.0],
        )
        return times, places[:, 1] - RADIUS, seconds

    def roll(self, step, slope):
        along, across = float(GRAVITY * np.sin(slope)), float(GRAVITY * np.cos(slope))
        contact = {"stiffness": f"{FIRM} N/mm", "friction": FRICTION, "slip_speed": f"{1e3 * SLIP} mm/s"}
        _, places, seconds = self.motion(step, ROLLING, RADIUS - MASS * across / FIRM, contact, [along, -across, 0.0])
        return places[-1, 0], seconds


class MuJoCo:
    """MuJoCo with one of its integrators."""

    def __init__(self, integrator):
        self.integrator = integrator

    def motion(self, step, duration, height, contact, gravity):
        """Times, places of the centre, and seconds of the steps."""
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <option timestep="{1e-3 * step!r}" integrator="{self.integrator}" cone="elliptic"
                gravity="{' '.join(repr(1e3 * part) for part in gravity)}"/>
              <worldbody>
                <geom name="floor" type="plane" size="1 1 1" zaxis="0 1 0"/>
                <body pos="0 {1e-3 * height!r} 0">
                  <freejoint/><geom name="ball" type="sphere" size="{1e-3 * RADIUS!r}" mass="{1e-3 * MASS!r}"/>
                </body>
              </worldbody>
              <contact><pair geom1="floor" geom2="ball" {contact}/></contact>
            </mujoco>""")
        data = mujoco.MjData(model)
        start = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        began = time.process_time()
        states, _ = mujoco.rollout.rollout(model, data, start, nstep=round(duration / step))
        seconds = time.process_time() - began
        states = np.vstack([start, states[0]])
        return 1e3 * states[:, 0], 1e3 * states[:, 1:3], seconds

    def bounce(self, step, drop):
        # Stiffness over mass in 1/s^2.
        contact = f'condim="1" solref="{-1e6 * SPRING / MASS!r} 0" solimp="0.0001 0.0001 0.001 0.5 2"'
        times, places, seconds = self.motion(step, BOUNCING, RADIUS + drop, contact, [0.0, -GRAVITY, 0.0])
        return times, places[:, 1] - RADIUS, seconds

    def roll(self, step, slope):
        along, across = float(GRAVITY * np.sin(slope)), float(GRAVITY * np.cos(slope))
        contact = (
            f'condim="3" friction="{FRICTION} {FRICTION} 0 0 0" solref="{1e-3 * RECOVERY!r} 1" '
            f'solimp="{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2"'
        )
        overlap = (1 - IMPEDANCE) * across * RECOVERY**2
        _, places, seconds = self.motion(step, ROLLING, RADIUS - overlap, contact, [along, -across, 0.0])
        return places[-1, 0], seconds


class Exudyn:
    """Exudyn, with equal steps or with those that its contact recommends."""

    def __init__(self, shortens):
        self.shortens = shortens

    def motion(self, step, duration, height, stiffness, friction, gravity):
        """Times, places of the centre, and seconds of the steps."""
        container = exu.SystemContainer()
        mbs = container.AddSystem()
        ball = mbs.CreateRigidBody(
            inertia=InertiaSphere(MASS, RADIUS), nodeType=exu.NodeType.RotationRxyz, referencePosition=[0, height, 0], gravity=gravity,
            returnDict=True,
        )
        ground = mbs.AddObject(ObjectGround(visualization=VObjectGround(show=False)))
        markers = [
            mbs.AddMarker(MarkerNodeRigid(nodeNumber=ball["nodeNumber"])), mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground)),
        ]
        corners = [[-FLOOR, 0, -FLOOR], [0, 0, FLOOR], [FLOOR, 0, -FLOOR]]
        mbs.AddObject(ObjectContactSphereTriangle(
            markerNumbers=markers, nodeNumber=mbs.AddNode(NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=[0.0] * 4)),
            sphereRadius=RADIUS, trianglePoints=exu.Vector3DList(corners), includeEdges=0, contactStiffness=stiffness,
            dynamicFriction=friction, frictionProportionalZone=SLIP,
        ))
        sensor = mbs.AddSensor(SensorNode(
            nodeNumber=ball["nodeNumber"], storeInternal=True, outputVariableType=exu.OutputVariableType.Position,
        ))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(duration / step)
        settings.timeIntegration.endTime = duration
        settings.timeIntegration.verboseMode = 0
        settings.timeIntegration.newton.relativeTolerance = 1e-8
        settings.timeIntegration.newton.absoluteTolerance = 1e-10
        settings.timeIntegration.discontinuous.iterationTolerance = 1e-4
        settings.timeIntegration.discontinuous.useRecommendedStepSize = self.shortens
        settings.linearSolver.solverType = exu.LinearSolverType.EigenDense
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = step
        began = time.process_time()
        mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
        seconds = time.process_time() - began
        table = mbs.GetSensorStoredData(sensor)
        return table[:, 0], table[:, 1:3], seconds

    def bounce(self, step, drop):
        times, places, seconds = self.motion(step, BOUNCING, RADIUS + drop, SPRING, 0.0, [0.0, -GRAVITY, 0.0])
        return times, places[:, 1] - RADIUS, seconds

    def roll(self, step, slope):
        along, across = float(GRAVITY * np.sin(slope)), float(GRAVITY * np.cos(slope))
        _, places, seconds = self.motion(step, ROLLING, RADIUS - MASS * across / FIRM, FIRM, FRICTION, [along, -across, 0.0])
        return places[-1, 0], seconds


def bounces(program, step):
    """Errors of the bouncing ball, and seconds for one second of motion."""
    errors, total = [], 0.0
    for drop in DROPS:
        times, heights, seconds = program.bounce(step, drop)
        errors.append(errors_of_bounces(times, heights, drop))
        total += seconds
    return [*np.max(errors, axis=0), total / (1e-3 * BOUNCING * len(DROPS))]


def rolls(program, step):
    """Errors of the rolling and of the slipping ball, and seconds for one second of motion."""
    errors, total = [], 0.0
    for slope in np.radians(SLOPES):
        place, seconds = program.roll(step, slope)
        errors.append(abs(place - distance(slope)))
        total += seconds
    return [*errors, total / (1e-3 * ROLLING * len(SLOPES))]


def compare(title, measure, names, programs):
    """Prints a table; returns what is off."""
    off = []
    print(f"\n{title}\n\n| step, ms | program | {' | '.join(names)} | ms a second |\n|--:|:--|" + "--:|" * (len(names) + 1))
    for step in STEPS:
        runs = np.array([[measure(program, step) for program in programs.values()] for _ in range(REPEATS)])
        for name, errors, seconds in zip(programs, runs[0, :, :-1], runs[:, :, -1].min(axis=0)):
            print(f"| {step:g} | {name} | {' | '.join(f'{error:.2g}' for error in errors)} | {1e3 * seconds:.1f} |", flush=True)
            if step == STEPS[-1]:
                off += [f"{name}: {what} {error:.2g}" for what, error in zip(names, errors) if not error < APART[what]]
    return off


def main():
    with tempfile.TemporaryDirectory() as folder:
        own = {"proboscis": Proboscis(os.path.abspath(sys.argv[1]), folder)}
        mujocos = {f"MuJoCo {mujoco.__version__}, {name}": MuJoCo(name) for name in ["Euler", "RK4"]}
        equal, shortened = f"Exudyn {exu.__version__}, equal steps", f"Exudyn {exu.__version__}, steps to impacts"
        off = compare(
            f"A ball bounces ({np.pi * np.sqrt(MASS / SPRING):.1f} ms a touch)", bounces, list(APART)[:2],
            own | mujocos | {equal: Exudyn(False), shortened: Exudyn(True)},
        )
        off += compare(
            f"A ball rolls {distance(np.radians(SLOPES[0])):.0f} mm and slips {distance(np.radians(SLOPES[1])):.0f} mm", rolls,
            list(APART)[2:], own | mujocos | {equal: Exudyn(False)},
        )
    if off:
        sys.exit("answers are off: " + "; ".join(off))


main()
