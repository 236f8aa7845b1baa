"""Motions of each mechanism by Exudyn, Pinocchio and MuJoCo: wall time of the integration alone, and the error of the crank. Those in
the plane are ten periods; those in space are in space_mechanism.py and space_peers.py.

Each is used as its own documentation says it is accurate and fast; what was tried is in docs/performance.md. Writes CSV.
"""

import csv
import math
import sys
from pathlib import Path

sys.exudynFast = True  # its build without range checks
import exudyn  # noqa: E402
import exudyn.itemInterface as items  # noqa: E402
import mujoco  # noqa: E402
import numpy as np  # noqa: E402
import pinocchio  # noqa: E402

import space_mechanism  # noqa: E402
import space_peers  # noqa: E402
from mechanism import Body, Mechanism, read, turned  # noqa: E402
from timing import clock, since  # noqa: E402

PERIODS = 10
# Steps in ten periods: of the crank-rocker from 10 ms to 10 µs each.
STEPS = [731, 2313, 7315, 23132, 73149, 231317, 731488]
GROUND = Body(0.0, np.zeros(2), 0.0, np.zeros(3), np.zeros(3))


def exudyn_(m: Mechanism, steps: int):
    """Planar bodies, generalised-α in C++, dense. A slider without inertia is a mass at a point of the body that carries its pin,
    and that point is held on the line: the same motion by fewer equations."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    bodies = dict(m.bodies)
    joints = [(joint.bodies, joint.points, joint.axis) for joint in m.joints]
    for joint in m.joints:
        if joint.axis is not None:
            guide, slider = joint.bodies
            pin = next(j for j in m.joints if j.axis is None and slider in j.bodies)
            carrier, at = pin.bodies[0], pin.points[0]
            bodies[carrier] = loaded(bodies[carrier], bodies.pop(slider).mass, at)
            joints = [j for j in joints if slider not in j[0]]
            joints.append(((guide, carrier), (joint.points[0], at), joint.axis))
    objects, nodes = {"ground": system.AddObject(items.ObjectGround())}, {}
    for name, body in bodies.items():
        center, velocity = body.at(body.center)
        nodes[name] = system.AddNode(items.NodeRigidBody2D(
            referenceCoordinates=[*center, body.pose[2]], initialVelocities=[*velocity, body.rates[2]]))
        objects[name] = system.AddObject(items.ObjectRigidBody2D(
            physicsMass=body.mass, physicsInertia=body.inertia, nodeNumber=nodes[name]))

    def markers(kind, ends, points):
        centers = [bodies.get(name, GROUND).center for name in ends]
        return [system.AddMarker(kind(bodyNumber=objects[name], localPosition=[*(point - center), 0]))
                for name, point, center in zip(ends, points, centers)]

    for ends, points, axis in joints:
        if axis is None:
            system.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers(items.MarkerBodyPosition, ends, points)))
        else:  # the normal belongs to the second marker
            system.AddObject(items.ObjectJointPrismatic2D(
                markerNumbers=markers(items.MarkerBodyRigid, ends, points)[::-1],
                normalMarker1=[-axis[1], axis[0], 0], constrainRotation=False))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = PERIODS * m.period, steps
    integration.adaptiveStep = False
    integration.stepInformation = 0
    integration.newton.useModifiedNewton = False
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    settings.solution.solverInformationFileName = ""
    start = clock()
    system.SolveDynamic(settings)
    wall = since(start)
    return wall, system.GetNodeOutput(nodes[m.crank], exudyn.OutputVariableType.Coordinates)[2]


def loaded(body: Body, mass: float, at):
    """A body with a point mass."""
    total = body.mass + mass
    center = (body.mass * body.center + mass * at) / total
    inertia = body.inertia + sum(w * np.sum((p - center) ** 2) for w, p in ((body.mass, body.center), (mass, at)))
    return Body(total, center, inertia, body.pose, body.rates)


def coordinates(m: Mechanism, carried):
    """Coordinates and speeds of the tree's joints at the start."""
    bodies = m.bodies | {"ground": GROUND}
    q, v = [], []
    for joint, parent, child, at, own in carried:
        a, b = bodies[parent], bodies[child]
        if joint.axis is None:
            q.append(b.pose[2] - a.pose[2])
            v.append(b.rates[2] - a.rates[2])
        else:
            (x, dx), (y, dy) = a.at(at), b.at(own)
            along = turned(a.pose[2], joint.axis)
            q.append(along @ (y - x))
            v.append(along @ (dy - dx) + a.rates[2] * (along[0] * (y - x)[1] - along[1] * (y - x)[0]))
    return np.array(q), np.array(v)


def pinocchio_(m: Mechanism, steps: int):
    """Joint coordinates, loops closed by points in `constraintDynamics`, held by Baumgarte's terms; RK4 in a Python loop."""
    model = pinocchio.Model()
    model.gravity.setZero()
    carried, closing = m.tree()
    place = lambda p: pinocchio.SE3(np.eye(3), np.array([*p, 0.0]))  # noqa: E731
    ids, origin = {"ground": 0}, {"ground": np.zeros(2)}
    for joint, parent, child, at, own in carried:
        body = m.bodies[child]
        kind = pinocchio.JointModelRZ() if joint.axis is None else pinocchio.JointModelPrismaticUnaligned(np.array([*joint.axis, 0]))
        ids[child], origin[child] = model.addJoint(ids[parent], kind, place(at - origin[parent]), child), own
        inertia = pinocchio.Inertia(body.mass, np.array([*(body.center - own), 0]), body.inertia * np.eye(3))
        model.appendBodyToJoint(ids[child], inertia, pinocchio.SE3.Identity())
    rate = 2 * math.pi / m.period
    models, datas = pinocchio.StdVec_RigidConstraintModel(), pinocchio.StdVec_RigidConstraintData()
    for joint in closing:
        ends = [x for name, p in zip(joint.bodies, joint.points) for x in (ids[name], place(p - origin[name]))]
        closed = pinocchio.RigidConstraintModel(
            pinocchio.ContactType.CONTACT_3D, model, *ends, pinocchio.ReferenceFrame.LOCAL)
        closed.setBaumgarteCorrectorParameters(pinocchio.BaumgarteCorrectorParameters(rate**2, 2 * rate))
        models.append(closed)
        datas.append(closed.createData())
    data = model.createData()
    pinocchio.initConstraintDynamics(model, data, models, datas)
    # Out of the plane a point's row is empty: the proximal term makes it solvable.
    settings, none = pinocchio.ProximalSettings(1e-14, 1e-10, 10), np.zeros(model.nv)
    dynamics = pinocchio.constraintDynamics
    f = lambda q, v: dynamics(model, data, q, v, none, models, datas, settings)  # noqa: E731
    q, v = coordinates(m, carried)
    crank = [child for _, _, child, _, _ in carried].index(m.crank)
    h = PERIODS * m.period / steps
    start = clock()
    for _ in range(steps):
        a1 = f(q, v).copy()
        v2 = v + h / 2 * a1
        a2 = f(q + h / 2 * v, v2).copy()
        v3 = v + h / 2 * a2
        a3 = f(q + h / 2 * v2, v3).copy()
        v4 = v + h * a3
        a4 = f(q + h * v3, v4)
        q = q + h / 6 * (v + 2 * (v2 + v3) + v4)
        v = v + h / 6 * (a1 + 2 * (a2 + a3) + a4)
    wall = since(start)
    return wall, q[crank] - coordinates(m, carried)[0][crank]


def mujoco_(m: Mechanism, steps: int):
    """Joint coordinates, loops closed by `connect`, as hard as it allows: impedance 0.9999, and the time constant that was the best of
    2 to 6 steps. RK4, all steps in one call. A slider needs some inertia: 1e-12 kg m²."""
    h = PERIODS * m.period / steps
    constant = {"crank-rocker": 3, "single-dwell": 2}[m.name] * h
    carried, closing = m.tree()
    text = lambda *values: " ".join(repr(float(x)) for x in values)  # noqa: E731
    origin = {"ground": np.zeros(2)} | {child: own for _, _, child, _, own in carried}

    def branches(parent):
        return "".join(branch(*by) for by in carried if by[1] == parent)

    def branch(joint, parent, child, at, own):
        body = m.bodies[child]
        kind = 'type="hinge" axis="0 0 1"' if joint.axis is None else f'type="slide" axis="{text(*joint.axis, 0)}"'
        sites = "".join(f'<site name="{child}{k}" pos="{text(*(p - own), 0)}"/>'
                        for k, c in enumerate(closing) for name, p in zip(c.bodies, c.points) if name == child)
        inertia = text(*[max(body.inertia, 1e-12)] * 3)
        return (f'<body pos="{text(*(at - origin[parent]), 0)}"><joint name="{child}" {kind}/>'
                f'<inertial mass="{body.mass!r}" pos="{text(*(body.center - own), 0)}" diaginertia="{inertia}"/>'
                f"{sites}{branches(child)}</body>")

    loops = "".join(
        f'<connect site1="{joint.bodies[0]}{k}" site2="{joint.bodies[1]}{k}" '
        f'solref="{text(constant, 1)}" solimp="0.9999 0.9999 0.001 0.5 2"/>' for k, joint in enumerate(closing))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option integrator="RK4" timestep="{h!r}" gravity="0 0 0" solver="Newton" tolerance="1e-15" jacobian="dense">'
        f'<flag contact="disable"/></option><worldbody>{branches("ground")}</worldbody><equality>{loops}</equality></mujoco>')
    data = mujoco.MjData(model)
    for (_, _, child, _, _), q, v in zip(carried, *coordinates(m, carried)):
        data.joint(child).qpos, data.joint(child).qvel = q, v
    crank = data.joint(m.crank)
    first = crank.qpos[0]
    start = clock()
    mujoco.mj_step(model, data, nstep=steps)
    wall = since(start)
    return wall, crank.qpos[0] - first


# Name, version, function, the last of the numbers of steps.
TOOLS = [
    ("Exudyn", exudyn.__version__, exudyn_, 731488),
    ("Pinocchio", pinocchio.__version__, pinocchio_, 73149),
    ("MuJoCo", mujoco.__version__, mujoco_, 231317),
]


def least(run):
    """The least time of several runs, and what the last gave; the first is the warm-up: a run of ten seconds needs none."""
    best, value, spent, times = math.inf, None, 0.0, 0
    while times < 2 or (spent < 1.0 and times < 6):
        try:
            wall, value = run()
        except exudyn.SolverError as refused:  # its Newton method may not converge at the longest step
            print(refused, flush=True)
            break
        best, spent, times = min(best, wall), spent + wall, times + 1
    return best, value


def in_plane(case):
    """Its name, tools, numbers of steps; by tool and steps the length of a step, and a run with its error."""
    m = read(case)
    return m.name, TOOLS, STEPS, lambda steps: PERIODS * m.period / steps, \
        lambda run, steps: lambda: run(m, steps), lambda turned_by: abs(turned_by - 2 * math.pi * PERIODS)


def in_space(case):
    """The same of a motion that is compared after each unit of time."""
    m = space_mechanism.read(case)
    units = m.instants[-1][0]
    in_unit = lambda steps: max(1, round(steps / units))  # noqa: E731
    return m.name, space_peers.TOOLS, space_peers.STEPS, lambda steps: m.unit / in_unit(steps), \
        lambda run, steps: lambda: run(m, in_unit(steps)), m.error


def main(cases: Path, out: Path):
    rows = []
    motions = [in_plane(cases / name) for name in ("crank-rocker", "single-dwell")]
    motions += [in_space(cases / "spatial" / f"{name}.json") for name in space_mechanism.MOTIONS]
    for case, tools, all_steps, step, prepared, error_of in motions:
        for tool, version, run, most in tools:
            for steps in (n for n in all_steps if n <= most):
                best, value = least(prepared(run, steps))
                error = error_of(value) if math.isfinite(best) else math.inf
                if error < 0.1:
                    h = step(steps)
                    rows.append([case, f"{tool} {version}", f"h = {h:.3g} s", repr(best), repr(float(error))])
                    print(f"{case}  {tool}  h = {h:.3g} s: {best:.3g} s, {error:.1e} rad", flush=True)
    with out.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["mechanism", "tool", "setting", "wall_s", "error_rad"], *rows])


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
