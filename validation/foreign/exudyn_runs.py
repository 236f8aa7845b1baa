"""The two kinetostatic runs of the paper by Exudyn, exported as a user of Exudyn would: `python3 exudyn_runs.py` (pip install
exudyn==1.13.6 numpy). It reads the scene of a case as validation/peers does, prescribes the angle of the crank by a constraint of its
coordinate, and writes the constraint's moment and one reaction beside angle, speed and acceleration.

Run i turns with 1 rad/s and passes 361 positions of a revolution; run ii begins at rest, accelerates with 1 rad/s² and is written at
equal intervals of time: its positions are others.
"""

import math
import sys
from pathlib import Path

import exudyn
import exudyn.itemInterface as items
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "peers"))
from mechanism import Body, read  # noqa: E402

GROUND = Body(0.0, np.zeros(2), 0.0, np.zeros(3), np.zeros(3))
STEPS_PER_ROW = 40  # Exudyn's error falls with the square of the step; more steps lose as much by rounding


def build(m, law):
    """Bodies and joints, with the crank's angle prescribed; the sensors of the moment and of the reaction."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    objects, nodes = {"ground": system.AddObject(items.ObjectGround())}, {}
    for name, body in m.bodies.items():
        center, velocity = body.at(body.center)
        nodes[name] = system.AddNode(items.NodeRigidBody2D(
            referenceCoordinates=[*center, body.pose[2]], initialVelocities=[*velocity, body.rates[2]]))
        objects[name] = system.AddObject(items.ObjectRigidBody2D(
            mass=body.mass, inertia=body.inertia, nodeNumber=nodes[name]))
    made = []
    for joint in m.joints:
        kind = items.MarkerBodyPosition if joint.axis is None else items.MarkerBodyRigid
        centers = [m.bodies.get(name, GROUND).center for name in joint.bodies]
        markers = [system.AddMarker(kind(bodyNumber=objects[name], localPosition=[*(point - center), 0]))
                   for name, point, center in zip(joint.bodies, joint.points, centers)]
        if joint.axis is None:
            made.append(system.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers)))
        else:
            made.append(system.AddObject(items.ObjectJointPrismatic2D(
                markerNumbers=markers[::-1], normalMarker1=[-joint.axis[1], joint.axis[0], 0], constrainRotation=True)))
    angle = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[m.crank], coordinate=2))
    fixed = system.AddNode(items.NodePointGround())
    zero = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    drive = system.AddObject(items.ObjectConnectorCoordinate(
        markerNumbers=[zero, angle], offsetUserFunction=lambda mbs, t, number, offset: law(t)))
    return container, system, nodes[m.crank], drive, made


def run(m, reaction, law, duration, rows):
    """Rows of time, angle, speed, acceleration, moment and reaction."""
    container, system, crank, drive, joints = build(m, law)
    joint = joints[reaction]
    table = []

    def write(mbs, t):
        out = mbs.GetNodeOutput(crank, exudyn.OutputVariableType.Coordinates_t)
        acceleration = mbs.GetNodeOutput(crank, exudyn.OutputVariableType.Coordinates_tt)
        moment = np.atleast_1d(mbs.GetObjectOutput(drive, exudyn.OutputVariableType.Force))[0]
        force = np.atleast_1d(mbs.GetObjectOutput(joint, exudyn.OutputVariableType.Force))
        angle = mbs.GetNodeOutput(crank, exudyn.OutputVariableType.Coordinates)[2]
        # The constraint's force is that on its first marker; the joint's on its second body.
        table.append([t, angle, out[2], acceleration[2], -moment, force[0], force[1]])
        return True

    system.SetPostStepUserFunction(write)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = duration, (rows - 1) * STEPS_PER_ROW
    integration.generalizedAlpha.spectralRadius = 0.6
    integration.generalizedAlpha.computeInitialAccelerations = True
    integration.newton.useModifiedNewton = False
    integration.newton.relativeTolerance = 1e-12
    integration.newton.absoluteTolerance = 1e-13
    integration.adaptiveStep = False
    integration.stepInformation = 0
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    settings.solution.solverInformationFileName = ""
    system.SolveDynamic(settings)
    return table


def export(name, reaction):
    m = read(HERE.parent / name)
    start = m.bodies[m.crank].pose[2]
    # Exudyn calls back after its steps, so the first row is one degree after the start, and the last a whole revolution later.
    end = 2 * math.pi * 361 / 360
    for label, law, duration, rows in [
        ("i", lambda t: t, end, 362),
        ("ii", lambda t: 0.5 * t * t, math.sqrt(2 * end) + 1e-3, 362),
    ]:
        for body in m.bodies.values():
            body.rates = body.rates * (1.0 if label == "i" else 0.0)
        if label == "i":
            speed = m.bodies[m.crank].rates[2]
            for body in m.bodies.values():
                body.rates = body.rates / speed
        table = run(m, reaction, law, duration, rows)
        wanted = table[STEPS_PER_ROW - 1::STEPS_PER_ROW]
        with open(HERE / f"{name}-run-{label}.csv", "w", encoding="utf-8") as out:
            out.write(f"# Exudyn {exudyn.__version__}, {name}, run {label}\n")
            out.write("# time [s],angle [rad],speed [rad/s],acceleration [rad/s2],moment [N m],force x [N],force y [N]\n")
            for row in wanted:
                out.write(",".join(f"{x:.12g}" for x in [row[0], start + row[1], *row[2:]]) + "\n")
        print(name, label, len(wanted), wanted[0], wanted[len(wanted) // 2])


if __name__ == "__main__":
    export("crank-rocker", 2)
    export("single-dwell", 3)
