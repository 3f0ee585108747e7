"""A step of the trunk without muscle mass and viscosity: Exudyn beside proboscis, one core each.

    python exudyn_trunk.py PROGRAM

PROGRAM is proboscis. Exudyn moves a kinematic tree of six revolute joints by its implicit trapezoidal rule with the fastest of six
settings (full and modified Newton, dense and sparse, tolerances, numerical and analytic derivatives); the force of a muscle is a function
of its length that Exudyn compiles ("symbolic user function"). Muscle mass and viscosity, which such a
connector does not have, are taken out of the scene for both. With short steps the tips have to agree; the time is that of a step of 5 ms
over ten seconds, start and files not counted. Needs `exudyn` and `numpy`.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

sys.exudynFast = True  # Exudyn without checks of ranges

import exudyn as exu
import numpy as np
from exudyn.utilities import (
    CreateSymbolicUserFunction, MarkerBodyRigid, MarkerKinematicTreeRigid, NodeGenericODE2, ObjectConnectorSpringDamper, ObjectGround,
    ObjectKinematicTree, SensorKinematicTree, VObjectGround,
)

# Units: g, mm, ms, N, MPa, V.
SEGMENTS, LENGTH, RADIUS, MASS = 6, 50.0, 20.0, 30.0
ARM, SPAN, SIDE, LAYER = 15.0, 40.0, 10.0, 0.05
MU, RATIO, VACUUM = 0.1, 3.0, 8.854187817e-12
VOLTAGES = {1: 1700.0, 5: 1700.0, 9: 1700.0, 3: 1600.0, 7: 1600.0, 11: 1600.0}
SHORT, SHORT_END = 0.05, 200.0  # ms
LONG, LONG_END = 5.0, 1e4
#: Largest difference of the tips in mm with short steps.
APART = 1e-3


def force(voltage):
    """Force of a muscle at deflection u, in the form that Exudyn expects."""
    volume, field = SIDE**2 * SPAN, (voltage / LAYER) ** 2
    c2 = (RATIO - 1) * VACUUM / 2

    def law(mbs, t, number, u, v, k, d, f):
        length = u + SPAN
        elastic = MU * (length / SPAN**2 - SPAN / (length * length))
        electric = field * (2 * c2 * length / SPAN**2 + VACUUM * SPAN**2 / (length * length * length))
        return volume * (elastic + electric)

    return law


def tip(step, end):
    """Place of the tip in mm at the end, and seconds of the integration."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    axial = MASS * RADIUS**2 / 2
    transverse = MASS * (3 * RADIUS**2 + LENGTH**2) / 12
    zeros = [0.0] * SEGMENTS
    node = mbs.AddNode(NodeGenericODE2(
        referenceCoordinates=zeros, initialCoordinates=zeros, initialCoordinates_t=zeros, numberOfODE2Coordinates=SEGMENTS,
    ))
    offsets = [[0, 0, 0]] + [[0, LENGTH, 0]] * (SEGMENTS - 1)
    axes = [exu.JointType.RevoluteZ, exu.JointType.RevoluteX]
    tree = mbs.AddObject(ObjectKinematicTree(
        nodeNumber=node, jointTypes=[axes[i % 2] for i in range(SEGMENTS)], linkParents=list(range(-1, SEGMENTS - 1)),
        jointTransformations=exu.Matrix3DList([np.eye(3)] * SEGMENTS), jointOffsets=exu.Vector3DList(offsets),
        linkInertiasCOM=exu.Matrix3DList([np.diag([transverse, axial, transverse])] * SEGMENTS),
        linkCOMs=exu.Vector3DList([[0, LENGTH / 2, 0]] * SEGMENTS), linkMasses=[MASS] * SEGMENTS,
    ))
    ground = mbs.AddObject(ObjectGround(visualization=VObjectGround(show=False)))
    laws = []  # Exudyn does not keep them.
    for i in range(SEGMENTS):
        for side, sign in enumerate([1, -1]):
            across = [sign * ARM, 0, 0] if i % 2 == 0 else [0, 0, sign * ARM]
            foot, head = np.array(across) + [0, -SPAN / 2, 0], np.array(across) + [0, SPAN / 2, 0]
            if i == 0:
                below = mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=foot))
            else:
                at = foot + [0, LENGTH, 0]
                below = mbs.AddMarker(MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=i - 1, localPosition=at))
            above = mbs.AddMarker(MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=i, localPosition=head))
            laws.append(CreateSymbolicUserFunction(
                mbs, function=force(VOLTAGES.get(2 * i + side + 1, 0.0)), userFunctionName="springForceUserFunction",
                itemTypeName="ObjectConnectorSpringDamper",
            ))
            mbs.AddObject(ObjectConnectorSpringDamper(
                markerNumbers=[below, above], referenceLength=SPAN, springForceUserFunction=laws[-1],
            ))
    sensor = mbs.AddSensor(SensorKinematicTree(
        objectNumber=tree, linkNumber=SEGMENTS - 1, localPosition=[0, LENGTH, 0], storeInternal=True,
        outputVariableType=exu.OutputVariableType.Position,
    ))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.linearSolverType = exu.LinearSolverType.EigenDense
    settings.timeIntegration.newton.relativeTolerance = 1e-8
    settings.timeIntegration.newton.absoluteTolerance = 1e-10
    settings.timeIntegration.newton.numericalDifferentiation.forODE2 = False
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = end
    began = time.perf_counter()
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
    return mbs.GetSensorValues(sensor), time.perf_counter() - began


def of_proboscis(program, step, end):
    """The same of proboscis; seconds are those of the steps."""
    scene = json.loads(subprocess.check_output([program, "expand", "problems/scenes/elephant_trunk.json"]))
    scene.pop("$schema", None)
    for key in ["density", "viscosity"]:
        del scene["materials"]["silicone"][key]
    voltages = {f"muscle{number}": f"{voltage} V" for number, voltage in VOLTAGES.items()}
    task = {"scene": scene, "simulate": {"duration": f"{end} ms", "step": f"{step} ms", "voltages": voltages}}
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/problem.json", "w") as file:
            json.dump(task, file)
        subprocess.run([program, "simulate", "problem.json", "-o", "out", "--quiet"], cwd=folder, check=True, capture_output=True)
        with open(f"{folder}/out/summary.json") as file:
            summary = json.load(file)
        with open(f"{folder}/out/trajectory.csv") as file:
            rows = [line.rstrip("\n").split(",") for line in file if not line.startswith("#")]
    names = [name.split(" ")[0] for name in rows[0]]
    at = [float(rows[-1][names.index(f"tip_{axis}")]) for axis in "xyz"]
    return np.array(at), summary["seconds"]["solver"]


def main():
    program = os.path.abspath(sys.argv[1])
    there, here = tip(SHORT, SHORT_END)[0], of_proboscis(program, SHORT, SHORT_END)[0]
    print("tips with short steps, mm:", there, here, file=sys.stderr)
    if not np.abs(there - here).max() < APART or np.hypot(here[0], here[2]) < 10.0:
        sys.exit("the tips do not agree, or do not move")
    times = np.array([[tip(LONG, LONG_END)[1], of_proboscis(program, LONG, LONG_END)[1]] for _ in range(5)])
    exudyn, own = 1e6 * times.min(axis=0) / (LONG_END / LONG)
    print(f"microseconds a step of {LONG:g} ms: Exudyn {exu.__version__} {exudyn:.0f}, proboscis {own:.1f}, ratio {exudyn / own:.1f}")


main()
