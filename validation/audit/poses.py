"""Forces of rows: loads, friction and equilibrium, sums over the mechanism, and columns that repeat others."""

import numpy as np

from balance import Balance, actuator_forces, add_reactions, reaction, written
from forces import FrictionForces, load_magnitude, load_terms, unit_load
from jets import jet, without_turns
from joints import SPACE_COMPONENTS
from judge import largest
from kinematics import zero_if_none
from scene import Z


def loads(judge, motion, time):
    """The wrenches of all loads from the scene, compared with their columns; by load."""
    names, found = motion.names(time), {}
    for load in motion.scene.loads:
        magnitude = load_magnitude(load, motion, names)
        if np.isnan(magnitude).any():
            judge.require("loads", False, f"load {load.name} has no value in a row: its table does not reach there")
        found[load.name] = [w.times(magnitude) for w in unit_load(load, motion)]
        column = written(motion.rows, load.name)
        if column is not None and load.kind != "gravity":
            judge.compare("loads", column - magnitude, largest(column, load_terms(load, motion, names)), "SI", f"load {load.name}")
        power = motion.rows.get(f"{load.name}.power")
        if power is not None:
            powers = [w.power(motion) for w in found[load.name]]
            scale = largest(sum((w.power_terms(motion) for w in found[load.name]), np.zeros(motion.count)))
            judge.compare("powers", power - sum(powers), max(scale, largest(power)), "W", f"{load.name}.power")
    return found


def frictions(judge, motion, is_free):
    """The friction wrenches of all joints from the written reactions, by joint; None if a reaction has no column."""
    found = {}
    for friction in motion.scene.frictions:
        joint = motion.scene.joints[friction.joint]
        of = reaction(motion, joint)
        if of is None:
            judge.skip(f"friction of {joint.name}", "a component of the joint's reaction has no column")
            found[joint.name] = None
            continue
        forces = FrictionForces(friction, motion, *of)
        found[joint.name] = judge_friction(judge, motion, forces, is_free)
    return found


def judge_friction(judge, motion, forces, is_free):
    """Judges dry friction: by its law if the surfaces slide, and by its limit if they stick. Judges viscous friction."""
    rows, name, friction = motion.rows, forces.joint.name, forces.friction
    axial, about = forces.dry()
    kind = "moment" if forces.is_pin else "force"
    column = rows.get(f"{name}.friction.load_{kind}")
    rest = forces.limit * friction.static / friction.coefficient if friction.coefficient else forces.limit
    if is_free and friction.regularization is None and friction.coefficient and column is not None and forces.joint.kind != "cylindrical":
        law = about if forces.is_pin else axial
        moves = np.abs(forces.speed) > 1e-6 * largest(forces.speed)
        scale = largest(forces.limit, column)
        judge.compare("friction", np.where(moves, column - law, 0.0), scale, "SI", f"{name}, sliding")
        judge.compare("friction", np.where(moves, 0.0, np.maximum(np.abs(column) - rest, 0.0)), scale, "SI", f"{name}, at rest")
        axial, about = (0.0 * column, column) if forces.is_pin else (column, 0.0 * column)
    elif column is not None and forces.joint.kind != "cylindrical":
        law = about if forces.is_pin else axial
        judge.compare("friction", column - law, largest(law, column), "SI", f"{name}, friction")
    viscous = forces.viscous()
    column = rows.get(f"{name}.viscous.load_{kind}")
    if column is not None:
        judge.compare("friction", column - viscous, largest(viscous, column), "SI", f"{name}, viscous")
    wrenches = forces.wrenches(axial, about)
    wrenches += forces.wrenches(*((0.0 * viscous, viscous) if forces.is_pin else (viscous, 0.0 * viscous)))
    return wrenches


def equilibrium(judge, motion, at_rest=False, is_loaded=True):
    """Judges the forces in a file of `statics` or `kinetostatics`, or in a file of `runs`, which has no loads and no friction."""
    motion = motion.at_rest() if at_rest else motion
    of_loads = loads(judge, motion, motion.time()) if is_loaded else {}
    balance = Balance(motion)
    for wrenches in of_loads.values():
        balance.add(wrenches)
    add_reactions(judge, balance, parts_teeth=is_loaded)
    of_friction = {} if at_rest or not is_loaded else frictions(judge, motion, False)
    if at_rest:
        no_friction(judge, motion)
    powers = actuator_forces(balance, False, ())
    if not at_rest:
        balance.add_inertia()
    if any(w is None for w in of_friction.values()):
        judge.skip("equilibrium", "friction by reactions without columns")
    else:
        for wrenches in of_friction.values():
            balance.add(wrenches)
        if varying_is_known(judge, motion):
            balance.judge(judge, "equilibrium", "")
    known_reactions(judge, motion)
    totals(judge, motion, of_loads, of_friction, powers)
    repeated(judge, motion)


def no_friction(judge, motion):
    """Files of a mechanism at rest contain no friction."""
    for friction in motion.scene.frictions:
        name = motion.scene.joints[friction.joint].name
        for what in ("friction", "viscous"):
            column = written(motion.rows, f"{name}.{what}")
            if column is not None:
                judge.compare("friction", column, 1.0, "SI", f"{name}.{what} at rest")


def varying_is_known(judge, motion):
    unknown = [b.name for b in motion.scene.bodies if b.varying and not b.varying.is_known]
    if unknown:
        judge.skip("equilibrium", f"the inertia of {unknown[0]} varies, and the scene gives no half slope")
    return not unknown


def known_reactions(judge, motion):
    """The reactions that the scene states as functions of the angle of a body."""
    for body, frame in zip(motion.scene.bodies, motion.frames):
        if body.varying:
            for name, values in body.varying.reactions_at(frame.angle, frame.omega[:, 2], frame.alpha[:, 2]).items():
                column = motion.rows.get(name)
                if column is not None:
                    judge.compare("known-reactions", column - values, largest(values), "N", name)


def kinetic(motion):
    """The kinetic energy, its rate, and the size of the rate's terms."""
    energy, rate, terms = np.zeros(motion.count), np.zeros(motion.count), np.zeros(motion.count)
    for k, body in enumerate(motion.scene.bodies):
        frame, center, tensor = motion.frames[k], motion.center(k), motion.inertia(k)
        turned = lambda v: np.einsum("nij,nj->ni", tensor, v)
        spin = (frame.omega * turned(frame.alpha)).sum(-1)  # ω·(ω × Iω) is zero
        energy += 0.5 * (body.mass * (center.first**2).sum(-1) + (frame.omega * turned(frame.omega)).sum(-1))
        if body.varying:
            inertia, half_slope = body.varying.at(frame.angle)
            omega, alpha = frame.omega[:, 2], frame.alpha[:, 2]
            energy += 0.5 * inertia * omega**2
            spin = spin + omega * (inertia * alpha + half_slope * omega**2)
        parts = body.mass * (center.first * center.second).sum(-1), spin
        rate += sum(parts)
        terms += body.mass * np.linalg.norm(center.first, axis=1) * np.linalg.norm(center.second, axis=1) + np.abs(spin)
    return energy, rate, terms


def shaking(motion, of_loads):
    """The wrench on the ground: external loads minus the rate of momentum, with the size of the terms."""
    force, moment = np.zeros((motion.count, 3)), np.zeros((motion.count, 3))
    sizes = [np.zeros(motion.count), np.zeros(motion.count)]

    def add(f, at, couple):
        nonlocal force, moment
        force, moment = force + f, moment + np.cross(at, f) + couple
        size = np.linalg.norm(f, axis=-1)
        sizes[0] += size
        sizes[1] += size * np.linalg.norm(at, axis=-1) + np.linalg.norm(couple, axis=-1)

    for load in motion.scene.loads:
        if load.kind in ("gravity", "force", "drag") and load.name in of_loads:
            for w in of_loads[load.name]:
                add(w.force, w.point, w.couple)
    for k, body in enumerate(motion.scene.bodies):
        frame, center, tensor = motion.frames[k], motion.center(k), motion.inertia(k)
        turned = lambda v: np.einsum("nij,nj->ni", tensor, v)
        couple = turned(frame.alpha) + np.cross(frame.omega, turned(frame.omega))
        if body.varying:
            inertia, half_slope = body.varying.at(frame.angle)
            parts = inertia * frame.alpha[:, 2], half_slope * frame.omega[:, 2] ** 2
            couple = couple + np.outer(sum(parts), Z)
            sizes[1] += np.abs(parts[0]) + np.abs(parts[1])
        add(-body.mass * center.second, center.value, -couple)
    return force, moment, sizes


def totals(judge, motion, of_loads, of_friction, actuator_powers, drives=()):
    """Compares shaking force and moment, powers and energies with sums over bodies and loads."""
    rows, scene = motion.rows, motion.scene
    joint_force = largest(*(v for j in scene.joints for v in [rows.get(f"{j.name}.magnitude")] if v is not None))
    force, moment, sizes = shaking(motion, of_loads)
    f_scale = max(largest(sizes[0]), joint_force)
    m_scale = max(largest(sizes[1]), joint_force * scene.size)
    axes = {"x": 0, "y": 1} if scene.is_plane else {"x": 0, "y": 1, "z": 2}
    columns = [(f"shaking.f{a}", force[:, k], f_scale, "N") for a, k in axes.items()]
    columns += [("shaking.moment", moment[:, 2], m_scale, "N m")] if scene.is_plane else \
        [(f"shaking.m{a}", moment[:, k], m_scale, "N m") for a, k in axes.items()]
    energy, rate, terms = kinetic(motion)
    load_powers = [w.power(motion) for wrenches in of_loads.values() for w in wrenches]
    is_known = all(w is not None for w in of_friction.values())
    load_powers += [w.power(motion) for wrenches in of_friction.values() if wrenches for w in wrenches]
    load_powers += [drives[name].net() * drives[name].coordinate.first for name in drives]
    driven = [p for p in actuator_powers if p is not None]
    speed = max((largest(f.omega) for f in motion.frames), default=0.0)
    p_scale = max(largest(terms), largest(*load_powers), largest(*driven), largest(energy) * speed)
    sum_of = lambda powers: sum(powers, np.zeros(motion.count))
    columns += [("energy.kinetic_bodies", energy, largest(energy), "J"), ("power.kinetic", rate, p_scale, "W"),
                ("power.residual", 0.0 * rate, p_scale, "W")]
    if is_known:
        columns.append(("power.loads", sum_of(load_powers), p_scale, "W"))
    if all(p is not None for p in actuator_powers):
        columns.append(("power.actuators", sum_of(driven), p_scale, "W"))
    for name, value, scale, unit in columns:
        if name in rows:
            judge.compare("totals", rows.get(name) - value, scale or 1.0, unit, name)


def repeated(judge, motion):
    """Compares magnitudes, directions and other components of joint forces, and powers of friction."""
    rows, scene = motion.rows, motion.scene
    vectors = {}
    for joint in scene.joints:
        of = reaction(motion, joint)
        if of is None and not scene.is_plane:
            of = determined_parts(rows, joint.name)
        if of is not None:
            vectors[joint.name] = of
    f_scale = largest(*(v[0] for v in vectors.values()))
    m_scale = max(largest(*(v[1] for v in vectors.values())), f_scale * scene.size)
    for joint in scene.joints:
        slope, tooth, parted = np.tan(joint.sizes.get("pressure", 0.0)), rows.get(f"{joint.name}.tooth"), rows.get(f"{joint.name}.separating")
        if tooth is not None and parted is not None:
            judge.compare("joint-forces", parted - slope * np.abs(tooth), largest(tooth) or 1.0, "N", f"{joint.name}.separating")
        if joint.name not in vectors:
            continue
        force, moment = vectors[joint.name]
        found = {"magnitude": (np.linalg.norm(force, axis=1), f_scale), "moment-magnitude": (np.linalg.norm(moment, axis=1), m_scale)}
        for place in joint.places:
            name, rotation = scene.bodies[place.body].name, motion.frames[place.body].rotation
            local = np.einsum("nij,ni->nj", rotation, force)
            found |= {f"{axis}@{name}": (local[:, k], f_scale) for k, axis in enumerate("xyz")}
        if not scene.is_plane and joint.kind != "gear in space":
            found |= joint_axes(joint, motion, force, moment, f_scale, m_scale)
        for name, (values, scale) in found.items():
            column = rows.get(f"{joint.name}.{name}")
            if column is not None and not np.isnan(values).any():
                judge.compare("joint-forces", column - values, scale or 1.0, "SI", f"{joint.name}.{name}")
        direction = rows.get(f"{joint.name}.direction")
        if direction is not None and scene.is_plane:
            turned = without_turns(jet(direction - np.arctan2(force[:, 1], force[:, 0]))).value
            judge.compare("joint-forces", turned * np.linalg.norm(force, axis=1), f_scale or 1.0, "N", f"{joint.name}.direction")
    friction_powers(judge, motion)


def determined_parts(rows, name):
    """Force and moment in space whose magnitudes have columns; components without a column are then zero."""
    count, found = rows.count, []
    for end, components in (("magnitude", SPACE_COMPONENTS[:3]), ("moment-magnitude", SPACE_COMPONENTS[3:])):
        columns = [rows.get(f"{name}.{c}") for c in components]
        is_known = f"{name}.{end}" in rows
        found.append(np.stack([zero_if_none(c, count) for c in columns], -1) if is_known else np.full((count, 3), np.nan))
    return found


def joint_axes(joint, motion, force, moment, f_scale, m_scale):
    """Components along the axes of a joint in space."""
    axis = motion.direction(joint.places[0].body, joint.axes[0]).value
    found = {"axial": ((force * axis).sum(-1), f_scale), "moment-axial": ((moment * axis).sum(-1), m_scale)}
    if joint.normals:
        normal = motion.direction(joint.places[0].body, joint.normals[0]).value
        for name, direction in (("normal", normal), ("across", np.cross(axis, normal))):
            found[name] = (force * direction).sum(-1), f_scale
            found[f"moment-{name}"] = (moment * direction).sum(-1), m_scale
    return found


def friction_powers(judge, motion):
    """The power of a joint's friction with its force along the written motion."""
    rows = motion.rows
    for friction in motion.scene.frictions:
        joint = motion.scene.joints[friction.joint]
        kind = "angle" if joint.kind == "revolute" else "travel"
        if joint.kind == "cylindrical":
            continue
        speed = motion.measure(motion.scene.measure_of(joint, kind)).first
        for what in ("friction", "viscous"):
            force, power = written(rows, f"{joint.name}.{what}"), rows.get(f"{joint.name}.{what}.power")
            if force is not None and power is not None:
                judge.compare("powers", power - force * speed, largest(power, force * speed), "W", f"{joint.name}.{what}.power")
