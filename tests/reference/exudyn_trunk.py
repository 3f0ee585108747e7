"""The elephant trunk under a force that keeps its direction and one that turns with its segment, by Exudyn (https://github.com/jgerstmayr/EXUDYN).

    pip install exudyn==1.13.6 numpy && python exudyn_trunk.py > exudyn_trunk.json

Six links of a kinematic tree; each of the twelve muscles, without mass and voltage, is a connector with a law of its own,
f = A mu (L - L^-2) + 3/2 eta A dL/dt / L^2 of the stretch L. Units are m, kg, s, N. Explicit Runge-Kutta of order 5, tolerance 1e-11.
"""

import json
import math

import exudyn as exu
import numpy as np
from exudyn.utilities import (
    MarkerBodyPosition,
    MarkerKinematicTreeRigid,
    LoadForceVector,
    NodeGenericODE2,
    ObjectConnectorSpringDamper,
    ObjectGround,
    ObjectKinematicTree,
    SensorMarker,
)

SEGMENTS, LENGTH, RADIUS, MASS = 6, 0.05, 0.02, 0.03
ARM, REST, AREA = 0.015, 0.04, 1e-4
MU, ETA = 1e5, 1e3
TIMES = [0.1, 0.2, 0.3]
# At the tip, along a direction of the ground, and at the upper end of the third segment, along a direction that turns with it.
DEAD = np.array([0.6, -0.2, 0.5])
FOLLOWING = np.array([-1.0, 0.5, 0.8])
FREQUENCIES = [5.0, 8.0]


def law(mbs, t, item, elongation, rate, stiffness, damping, force):
    stretch = 1 + elongation / REST
    return AREA * (MU * (stretch - stretch**-2) + 1.5 * ETA * rate / REST / stretch**2)


def sine(frequency):
    return lambda mbs, t, load: list(np.array(load) * math.sin(2 * math.pi * frequency * t))


def tip_after(duration):
    """Place of the tip after a motion from rest."""
    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * SEGMENTS,
            initialCoordinates=[0.0] * SEGMENTS,
            initialCoordinates_t=[0.0] * SEGMENTS,
            numberOfODE2Coordinates=SEGMENTS,
        )
    )
    kinds = [exu.JointType.RevoluteZ, exu.JointType.RevoluteX] * (SEGMENTS // 2)
    across, along = MASS * (3 * RADIUS**2 + LENGTH**2) / 12, MASS * RADIUS**2 / 2
    tree = mbs.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=kinds,
            linkParents=list(range(-1, SEGMENTS - 1)),
            jointTransformations=exu.Matrix3DList([np.eye(3)] * SEGMENTS),
            jointOffsets=exu.Vector3DList([[0, 0 if i == 0 else LENGTH, 0] for i in range(SEGMENTS)]),
            linkInertiasCOM=exu.Matrix3DList([np.diag([across, along, across])] * SEGMENTS),
            linkCOMs=exu.Vector3DList([[0, LENGTH / 2, 0]] * SEGMENTS),
            linkMasses=[MASS] * SEGMENTS,
            gravity=[0, 0, 0],
        )
    )
    ground = mbs.AddObject(ObjectGround())

    def on(link, place):
        """A marker on a link, at a place from its joint; link -1 is the ground."""
        if link < 0:
            return mbs.AddMarker(MarkerBodyPosition(bodyNumber=ground, localPosition=place))
        return mbs.AddMarker(MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=link, localPosition=place))

    for i in range(SEGMENTS):
        for side in (1, -1):
            arm = np.array([ARM, 0, 0] if i % 2 == 0 else [0, 0, ARM]) * side
            low = arm + [0, (0 if i == 0 else LENGTH) - REST / 2, 0]
            mbs.AddObject(
                ObjectConnectorSpringDamper(
                    markerNumbers=[on(i - 1, list(low)), on(i, list(arm + [0, REST / 2, 0]))],
                    referenceLength=REST,
                    stiffness=1,
                    damping=0,
                    force=0,
                    springForceUserFunction=law,
                )
            )
    tip, third = on(SEGMENTS - 1, [0, LENGTH, 0]), on(2, [0, LENGTH, 0])
    dead, following = sine(FREQUENCIES[0]), sine(FREQUENCIES[1])
    mbs.AddLoad(LoadForceVector(markerNumber=tip, loadVector=DEAD, loadVectorUserFunction=dead))
    mbs.AddLoad(
        LoadForceVector(markerNumber=third, loadVector=FOLLOWING, bodyFixed=True, loadVectorUserFunction=following)
    )
    position = exu.OutputVariableType.Position
    sensor = mbs.AddSensor(SensorMarker(markerNumber=tip, outputVariableType=position, storeInternal=True))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.numberOfSteps = 10
    settings.timeIntegration.automaticStepSize = True
    settings.timeIntegration.initialStepSize = 1e-5
    settings.timeIntegration.absoluteTolerance = 1e-11
    settings.timeIntegration.relativeTolerance = 1e-11
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
    time, *place = mbs.GetSensorStoredData(sensor)[-1].tolist()
    assert abs(time - duration) < 1e-12
    return place[:3]


out = {
    "exudyn": exu.__version__,
    "dead_N": DEAD.tolist(),
    "following_N": FOLLOWING.tolist(),
    "frequencies_Hz": FREQUENCIES,
    "time_s": TIMES,
    "tip_m": [tip_after(time) for time in TIMES],
}
print(json.dumps(out, indent=1))
