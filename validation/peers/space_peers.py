"""The motion of a mechanism in space by Exudyn, Pinocchio and MuJoCo: wall time of the integration alone, and the crank's angle
after each unit of time. Each has as many steps as asked for in every unit."""

import math
import sys

sys.exudynFast = True  # its build without range checks
import exudyn  # noqa: E402
import exudyn.itemInterface as items  # noqa: E402
import exudyn.utilities as parts  # noqa: E402
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
import pinocchio  # noqa: E402

from space_mechanism import GROUND, Mechanism  # noqa: E402
from timing import clock, since  # noqa: E402

# Axes that a joint of Exudyn holds: of travel, then of turning; the frames of `joint_frames`.
HELD = {
    "revolute": [1, 1, 1, 1, 1, 0],
    "prismatic": [1, 1, 0, 1, 1, 1],
    "universal": [1, 1, 1, 0, 0, 1],  # x of the first at right angles to y of the second
    "spherical": [1, 1, 1, 0, 0, 0],
}
# Of MuJoCo's constraints: the time constant that was the best of 2 to 6 steps.
CONSTANTS = {"slider-crank-haug": 2, "rsur-haug": 2, "bricard-a04": 6}


def frame_about(axis):
    """A frame with this axis as its z axis."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    x = np.cross(axis, other) / np.linalg.norm(np.cross(axis, other))
    return np.column_stack([x, np.cross(axis, x), axis])


def joint_frames(joint):
    """The frames of a joint on both bodies, in the ground's."""
    if joint.kind == "universal":
        x, y = joint.axes
        return [np.column_stack([x, y, np.cross(x, y)])] * 2
    axis = joint.axes[0] if joint.axes else np.array([0.0, 0.0, 1.0])
    return [frame_about(axis)] * 2


def exudyn_(m: Mechanism, steps: int):
    """Rigid bodies with Euler parameters, generalised-α in C++, the dense solver of Eigen, modified Newton iteration."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    objects = {"ground": system.AddObject(items.ObjectGround())}
    for name, body in m.bodies.items():
        if name != "ground":
            center, velocity = body.at(body.center)
            inertia = parts.RigidBodyInertia(mass=body.mass, inertiaTensor=body.inertia)
            objects[name] = system.CreateRigidBody(
                referencePosition=center, referenceRotationMatrix=body.rotation, initialVelocity=velocity,
                initialAngularVelocity=body.spin, inertia=inertia, gravity=m.gravity)
    for joint in m.joints:
        markers, rotations = [], []
        for name, point, frame in zip(joint.bodies, joint.points, joint_frames(joint)):
            body = m.bodies[name]
            markers.append(system.AddMarker(items.MarkerBodyRigid(bodyNumber=objects[name], localPosition=point - body.center)))
            rotations.append(body.rotation.T @ frame)
        if joint.kind == "spherical":
            system.AddObject(items.ObjectJointSpherical(markerNumbers=markers))
        else:
            system.AddObject(items.ObjectJointGeneric(
                markerNumbers=markers, constrainedAxes=HELD[joint.kind],
                rotationMarker0=rotations[0], rotationMarker1=rotations[1]))
    sensor = system.AddSensor(items.SensorBody(
        bodyNumber=objects[m.crank], outputVariableType=exudyn.OutputVariableType.RotationMatrix, storeInternal=True, writeToFile=False))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration, units = settings.timeIntegration, m.instants[-1][0]
    integration.endTime, integration.numberOfSteps = m.duration, steps * units
    integration.adaptiveStep = False
    integration.stepInformation = 0
    integration.newton.useModifiedNewton = True
    settings.linearSolverType = exudyn.LinearSolverType.EigenDense
    settings.linearSolverSettings.ignoreSingularJacobian = m.name == "bricard-a04"  # its rows are redundant
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = m.unit
    settings.solution.solverInformationFileName = ""
    start = clock()
    system.SolveDynamic(settings)
    wall = since(start)
    axis, zero, own = m.driver
    rows = system.GetSensorStoredData(sensor)[1:]
    turned = [row[1:].reshape(3, 3) @ own for row in rows]
    return wall, [math.atan2(axis @ np.cross(zero, v), zero @ v) for v in turned]


def closing_points(m: Mechanism, joint):
    """Points of both bodies that coincide where a joint closes a loop: of a hinge two on its axis."""
    away = [np.zeros(3)] if joint.kind == "spherical" else [-0.5 * joint.axes[0], 0.5 * joint.axes[0]]
    return [[p + m.bodies[name].rotation.T @ by for name, p in zip(joint.bodies, joint.points)] for by in away]


def pinocchio_(m: Mechanism, steps: int):
    """Joint coordinates, loops closed by points in `constraintDynamics`, held by Baumgarte's terms; RK4 in a Python loop."""
    model = pinocchio.Model()
    model.gravity.linear = m.gravity
    carried, closing = m.tree()
    ids, origin, rates = {"ground": 0}, {"ground": np.zeros(3)}, []
    for by in carried:
        parent, child = m.bodies[by.parent], m.bodies[by.child]
        own = by.joint.points[by.joint.bodies.index(by.child)]
        at = parent.rotation.T @ (by.joint.at - parent.origin) - origin[by.parent]
        place, last = pinocchio.SE3(parent.rotation.T @ child.rotation, at), ids[by.parent]
        for k, axis in enumerate(by.axes):
            kinds = pinocchio.JointModelPrismaticUnaligned if by.joint.kind == "prismatic" else pinocchio.JointModelRevoluteUnaligned
            last = model.addJoint(last, kinds(child.rotation.T @ axis), place, f"{by.child}{k}")
            place = pinocchio.SE3.Identity()
        ids[by.child], origin[by.child] = last, own
        inertia = pinocchio.Inertia(child.mass, child.center - own, child.inertia)
        model.appendBodyToJoint(last, inertia, pinocchio.SE3.Identity())
        rates.extend(by.rates)
    rate = math.tau / m.period
    models, datas = pinocchio.StdVec_RigidConstraintModel(), pinocchio.StdVec_RigidConstraintData()
    for joint in closing:
        for points in closing_points(m, joint):
            ends = [x for name, p in zip(joint.bodies, points)
                    for x in (ids[name], pinocchio.SE3(np.eye(3), p - origin[name]))]
            closed = pinocchio.RigidConstraintModel(pinocchio.ContactType.CONTACT_3D, model, *ends, pinocchio.ReferenceFrame.LOCAL)
            closed.setBaumgarteCorrectorParameters(pinocchio.BaumgarteCorrectorParameters(rate**2, 2 * rate))
            models.append(closed)
            datas.append(closed.createData())
    data = model.createData()
    pinocchio.initConstraintDynamics(model, data, models, datas)
    # The rows of the Bricard linkage are redundant: the proximal term makes them solvable, and as small as that of others it is
    # inaccurate.
    proximal, most = (0.1, 20) if m.name == "bricard-a04" else (1e-10, 10)
    settings, none = pinocchio.ProximalSettings(1e-14, proximal, most), np.zeros(model.nv)
    dynamics = pinocchio.constraintDynamics
    f = lambda q, v: dynamics(model, data, q, v, none, models, datas, settings)  # noqa: E731
    q, v = np.zeros(model.nv), np.array(rates)
    crank = model.joints[ids[m.crank]].idx_q
    h, angles = m.unit / steps, []
    start = clock()
    for _ in range(m.instants[-1][0]):
        for _ in range(steps):
            q, v = runge_kutta(f, q, v, h)
        angles.append(q[crank])
    wall = since(start)
    return wall, angles


def runge_kutta(f, q, v, h):
    """A step of the classical method."""
    a1 = f(q, v).copy()
    v2 = v + h / 2 * a1
    a2 = f(q + h / 2 * v, v2).copy()
    v3 = v + h / 2 * a2
    a3 = f(q + h / 2 * v2, v3).copy()
    v4 = v + h * a3
    a4 = f(q + h * v3, v4)
    return q + h / 6 * (v + 2 * (v2 + v3) + v4), v + h / 6 * (a1 + 2 * (a2 + a3) + a4)


def text(*values):
    return " ".join(repr(float(x)) for x in values)


def mujoco_(m: Mechanism, steps: int):
    """Joint coordinates, loops closed by `connect` as hard as it allows: impedance 0.9999; RK4, all steps of a unit in one call."""
    h = m.unit / steps
    carried, closing = m.tree()
    origin = {"ground": np.zeros(3)} | {by.child: by.joint.points[by.joint.bodies.index(by.child)] for by in carried}
    closures = [(joint.bodies, points) for joint in closing for points in closing_points(m, joint)]

    def branches(parent):
        return "".join(branch(by) for by in carried if by.parent == parent)

    def sites(body):
        return "".join(f'<site name="{body}{k}" pos="{text(*(p - origin[body]))}"/>'
                       for k, (ends, points) in enumerate(closures) for name, p in zip(ends, points) if name == body)

    def branch(by):
        parent, child = m.bodies[by.parent], m.bodies[by.child]
        at = parent.rotation.T @ (by.joint.at - parent.origin) - origin[by.parent]
        turn = pinocchio.Quaternion(parent.rotation.T @ child.rotation)
        kind = "slide" if by.joint.kind == "prismatic" else "hinge"
        joints = "".join(f'<joint name="{by.child}{k}" type="{kind}" axis="{text(*(child.rotation.T @ axis))}"/>'
                         for k, axis in enumerate(by.axes))
        return (f'<body pos="{text(*at)}" quat="{text(turn.w, turn.x, turn.y, turn.z)}">{joints}'
                f'<inertial mass="{child.mass!r}" pos="{text(*(child.center - origin[by.child]))}" '
                f'diaginertia="{text(*np.diag(child.inertia))}"/>{sites(by.child)}{branches(by.child)}</body>')

    loops = "".join(f'<connect site1="{ends[0]}{k}" site2="{ends[1]}{k}" solref="{text(CONSTANTS[m.name] * h, 1)}" '
                    'solimp="0.9999 0.9999 0.001 0.5 2"/>' for k, (ends, _) in enumerate(closures))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option integrator="RK4" timestep="{h!r}" gravity="{text(*m.gravity)}" solver="Newton" tolerance="1e-15" '
        'jacobian="dense"><flag contact="disable"/></option>'
        f'<worldbody>{sites("ground")}{branches("ground")}</worldbody><equality>{loops}</equality></mujoco>')
    data = mujoco.MjData(model)
    for by in carried:
        for k, rate in enumerate(by.rates):
            data.joint(f"{by.child}{k}").qvel = rate
    crank, angles = data.joint(f"{m.crank}0"), []
    start = clock()
    for _ in range(m.instants[-1][0]):
        mujoco.mj_step(model, data, nstep=steps)
        angles.append(float(crank.qpos[0]))
    wall = since(start)
    return wall, angles


# Name, version, function, the last of the numbers of steps.
TOOLS = [
    ("Exudyn", exudyn.__version__, exudyn_, 100000),
    ("Pinocchio", pinocchio.__version__, pinocchio_, 31623),
    ("MuJoCo", mujoco.__version__, mujoco_, 100000),
]
# Steps of a whole motion, about.
STEPS = [1000, 3162, 10000, 31623, 100000]
