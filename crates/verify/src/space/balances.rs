//! Newton's and Euler's equations of each body of a claimed state, and the balances of the whole.

use super::rows::Bodies;
use super::state::{DenseState, SpaceCase, SpaceState, finding};
use crate::comparison::{ComparisonSet, FindingSpec};
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{ActuatorKind, BodyMotion, Mechanism, Placement, Vec3, Wrench};
use dwell_kinetostatics::space::Mass;

const NEWTON_EULER: FindingSpec<'_> = FindingSpec {
    key: "state-newton-euler",
    check: Check::NewtonEuler,
    comparison: "forces and moments on each body with the rates of its momenta, of the claimed velocities and accelerations",
    scale: "the largest sum of absolute terms on a body, moments over the size, or a thousandth of what the motion makes of the whole mass",
    // The largest seen in a case is 7.8e-16.
    tolerance: 7e-14,
    tolerance_reason: "a sum of rounded terms",
};
const POWER: FindingSpec<'_> = FindingSpec {
    key: "state-power",
    check: Check::Power,
    comparison: "the power of actuators and loads with the rate of the kinetic energy, and that of the loads with their forces' work",
    scale: "the sum of absolute terms of the state, or the largest force at the largest speed of a body",
    // The largest seen in a case is 1.5e-13.
    tolerance: 1e-11,
    tolerance_reason: "a sum of rounded terms, of motions that the condition of the equations amplifies",
};
const IDEAL_JOINTS: FindingSpec<'_> = FindingSpec {
    key: "state-joint-power",
    comparison: "the power of each joint's reaction at unit speed of each actuator, of the dense velocities, with none",
    scale: "the largest force at the largest speed of a body",
    // The largest seen in a case is 2.7e-15.
    tolerance: 2e-13,
    ..POWER
};
const MOMENTUM: FindingSpec<'_> = FindingSpec {
    key: "state-momentum",
    check: Check::Momentum,
    comparison: "what the ground and the loads do with the rates of the momenta of all bodies",
    // The largest seen in a case is 2.8e-13.
    tolerance: 1e-11,
    ..NEWTON_EULER
};

/// What acts on a body about a point, with the sums of the absolute values of forces and moments.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Acting {
    pub(super) force: Vec3,
    pub(super) moment: Vec3,
    pub(super) sizes: [f64; 2],
}

impl Acting {
    fn add(&mut self, arm: Vec3, force: Vec3, moment: Vec3) {
        let lever = arm.cross(force);
        self.force += force;
        self.moment += moment + lever;
        self.sizes[0] += force.norm();
        self.sizes[1] += moment.norm() + lever.norm();
    }
}

/// By joint: what its first body does to the second, the actuators' actions included, as a point of the ground with force and couple there.
/// It acts in the opposite sense on the first.
pub fn joint_actions(
    mechanism: &Mechanism,
    placements: &[Placement],
    reactions: &[Wrench],
    tau: &[f64],
) -> Vec<(Vec3, Wrench)> {
    let of_joint = |(j, reaction): (usize, &Wrench)| {
        let joint = &mechanism.joints[j];
        let side = |k: usize, v: Vec3| placements[joint.side_body(k).0].rotation.apply(v);
        let point =
            |k: usize| placements[joint.side_body(k).0].position + side(k, joint.sides[k].point);
        let (at, mut wrench) = (point(1), *reaction);
        let actuators = mechanism.actuators.iter().zip(tau);
        for (actuator, tau) in actuators.filter(|(a, _)| a.kind.joint().0 == j) {
            let axis = side(0, joint.sides[0].axis);
            match actuator.kind {
                ActuatorKind::Angle(_) => wrench.moment += axis.scaled(*tau),
                ActuatorKind::Travel(_) => wrench.force += axis.scaled(*tau),
                ActuatorKind::Length(_) => {
                    let along = at - point(0);
                    wrench.force += along.scaled(tau / along.norm());
                }
            }
        }
        (at, wrench)
    };
    reactions.iter().enumerate().map(of_joint).collect()
}

fn centre(placements: &[Placement], masses: &[Mass], body: usize) -> Vec3 {
    placements[body].position + placements[body].rotation.apply(masses[body].center)
}

/// By body: what joints, actuators and loads do to it about its centre.
fn acting(case: &SpaceCase<'_>, state: &DenseState<'_>) -> Vec<Acting> {
    let SpaceState {
        reactions,
        tau,
        motions,
        loads,
        ..
    } = state.claimed;
    let placements = state.placements();
    let mut all = vec![Acting::default(); placements.len()];
    let about = |body: usize, at: Vec3| at - centre(placements, case.masses, body);
    let actions = joint_actions(case.mechanism, placements, reactions, tau);
    for (joint, (at, wrench)) in case.mechanism.joints.iter().zip(actions) {
        let [first, second] = joint.bodies.map(|b| b.0);
        all[second].add(about(second, at), wrench.force, wrench.moment);
        all[first].add(about(first, at), -wrench.force, -wrench.moment);
    }
    let bodies = Bodies {
        mechanism: case.mechanism,
        placements,
        motions: motions.clone(),
    };
    for load in loads {
        for (body, wrench) in bodies.load_wrenches(load, case.masses).iter().enumerate() {
            let arm = about(body, placements[body].position);
            all[body].add(arm, wrench.force, wrench.moment);
        }
    }
    all
}

/// The rates of a body's momentum, and of its angular momentum about its centre.
fn momentum_rates(mass: &Mass, placement: &Placement, motion: &BodyMotion) -> [Vec3; 2] {
    let rotation = &placement.rotation;
    let tensor = |v: Vec3| rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)));
    let w = motion.angular_velocity;
    let acceleration = motion.point_acceleration(rotation.apply(mass.center));
    [
        acceleration.scaled(mass.mass),
        tensor(motion.angular_acceleration) + w.cross(tensor(w)),
    ]
}

/// Adds what does not balance on each body, given the rates of its momenta.
pub(super) fn add_balances(
    case: &SpaceCase<'_>,
    state: &DenseState<'_>,
    rates: impl Fn(usize) -> [Vec3; 2],
    set: &mut ComparisonSet,
) {
    let size = case.size;
    let acting = acting(case, state);
    let scale = largest(case, &acting).max(floor(case, state));
    for (body, acting) in acting.iter().enumerate() {
        if body == case.mechanism.ground {
            continue;
        }
        let name = &case.mechanism.bodies[body].name;
        let [force, moment] = rates(body);
        let errors = [
            (acting.force - force).norm(),
            (acting.moment - moment).norm() / size,
        ];
        for error in errors {
            state.compare(set, [error, scale], "N", name);
        }
    }
}

/// The largest sum of absolute terms on a body that moves, moments over the size, N.
fn largest(case: &SpaceCase<'_>, acting: &[Acting]) -> f64 {
    let moving = acting
        .iter()
        .enumerate()
        .filter(|(b, _)| *b != case.mechanism.ground);
    moving.fold(
        0.0_f64,
        |max,
         (
            _,
            Acting {
                sizes: [force, moment],
                ..
            },
        )| { max.max(*force).max(moment / case.size) },
    )
}

/// The largest speed of a body, that of its rotation at the size, m/s, and a thousandth of what the motion makes of the whole mass, N.
fn pace(case: &SpaceCase<'_>, state: &DenseState<'_>) -> [f64; 2] {
    let size = case.size;
    let of = |[linear, angular]: [Vec3; 2]| linear.norm().max(angular.norm() * size);
    let motions = state.claimed.motions.iter();
    let [speed, acceleration] = motions.fold([0.0_f64; 2], |[speed, acceleration], m| {
        let rates = [m.acceleration, m.angular_acceleration];
        [
            speed.max(of([m.velocity, m.angular_velocity])),
            acceleration.max(of(rates)),
        ]
    });
    let mass: f64 = case.masses.iter().map(|mass| mass.mass).sum();
    [speed, 1e-3 * mass * acceleration.max(speed * speed / size)]
}

/// What nothing makes is zero to the rounding of what may be.
fn floor(case: &SpaceCase<'_>, state: &DenseState<'_>) -> f64 {
    pace(case, state)[1]
}

/// The largest sum of absolute terms on a body, or a thousandth of what the motion makes of the whole mass, N.
pub(super) fn largest_force(case: &SpaceCase<'_>, state: &DenseState<'_>) -> f64 {
    largest(case, &acting(case, state)).max(floor(case, state))
}

/// That force at the largest speed of a body, W.
pub(super) fn largest_power(case: &SpaceCase<'_>, state: &DenseState<'_>) -> f64 {
    largest_force(case, state) * pace(case, state)[0]
}

/// Newton's and Euler's equations with the claimed motions.
pub(super) fn newton_euler(case: &SpaceCase<'_>, states: &[DenseState<'_>]) -> Finding {
    let mut set = ComparisonSet::with_individual_scales();
    for state in states {
        let (motions, placements) = (&state.claimed.motions, state.placements());
        let rates =
            |body: usize| momentum_rates(&case.masses[body], &placements[body], &motions[body]);
        add_balances(case, state, rates, &mut set);
    }
    finding(&NEWTON_EULER, states, set, None)
}

/// Power, that of the joints' reactions, and momentum, of the dense motions.
pub(super) fn of_whole(case: &SpaceCase<'_>, states: &[DenseState<'_>]) -> [Finding; 3] {
    let [mut power, mut ideal, mut momentum] =
        [(); 3].map(|()| ComparisonSet::with_individual_scales());
    for state in states {
        let Ok((closed, dense)) = &state.solved else {
            continue;
        };
        for unit in &closed.unit {
            add_joint_powers(case, state, unit, &mut ideal);
        }
        add_power(case, state, &dense.motions, &mut power);
        add_momentum(case, state, &dense.motions, &mut momentum);
    }
    [
        finding(&POWER, states, power, None),
        finding(&IDEAL_JOINTS, states, ideal, None),
        finding(&MOMENTUM, states, momentum, None),
    ]
}

fn add_power(
    case: &SpaceCase<'_>,
    state: &DenseState<'_>,
    motions: &[BodyMotion],
    set: &mut ComparisonSet,
) {
    let (claimed, placements) = (state.claimed, state.placements());
    let (mut rate, mut scale) = (0.0, claimed.load_power.abs());
    for (body, mass) in case.masses.iter().enumerate() {
        let [force, moment] = momentum_rates(mass, &placements[body], &motions[body]);
        let arm = placements[body].rotation.apply(mass.center);
        let parts = [
            force.dot(motions[body].point_velocity(arm)),
            moment.dot(motions[body].angular_velocity),
        ];
        rate += parts[0] + parts[1];
        scale += parts[0].abs() + parts[1].abs();
    }
    let mut actuators = 0.0;
    for (tau, q_dot) in claimed.tau.iter().zip(&claimed.q_dot) {
        actuators += tau * q_dot;
        scale += (tau * q_dot).abs();
    }
    let bodies = Bodies {
        mechanism: case.mechanism,
        placements,
        motions: motions.to_vec(),
    };
    let mut work = 0.0;
    for load in &claimed.loads {
        let wrenches = bodies.load_wrenches(load, case.masses);
        for (wrench, motion) in wrenches.iter().zip(motions) {
            let part =
                wrench.force.dot(motion.velocity) + wrench.moment.dot(motion.angular_velocity);
            work += part;
            scale += part.abs();
        }
    }
    let scale = scale.max(largest_power(case, state));
    let unbalanced = actuators + claimed.load_power - rate;
    state.compare(set, [unbalanced, scale], "W", "all bodies");
    state.compare(set, [claimed.load_power - work, scale], "W", "loads");
}

/// A reaction does no work: what a joint leaves free it does not hold.
fn add_joint_powers(
    case: &SpaceCase<'_>,
    state: &DenseState<'_>,
    motions: &[BodyMotion],
    set: &mut ComparisonSet,
) {
    let placements = state.placements();
    let speed = motions.iter().fold(0.0_f64, |max, m| {
        max.max(m.velocity.norm())
            .max(m.angular_velocity.norm() * case.size)
    });
    let scale = largest_force(case, state) * speed;
    let idle = vec![0.0; state.claimed.tau.len()];
    let actions = joint_actions(case.mechanism, placements, &state.claimed.reactions, &idle);
    for (joint, (at, wrench)) in case.mechanism.joints.iter().zip(actions) {
        let [first, second] = joint.bodies.map(|body| {
            let motion = &motions[body.0];
            let velocity = motion.point_velocity(at - placements[body.0].position);
            (velocity, motion.angular_velocity)
        });
        let power = wrench.force.dot(second.0 - first.0) + wrench.moment.dot(second.1 - first.1);
        state.compare(set, [power, scale], "W", &joint.name);
    }
}

fn add_momentum(
    case: &SpaceCase<'_>,
    state: &DenseState<'_>,
    motions: &[BodyMotion],
    set: &mut ComparisonSet,
) {
    let (claimed, placements) = (state.claimed, state.placements());
    let (ground, size) = (case.mechanism.ground, case.size);
    // About where the ground is, which is nowhere in particular.
    let origin = placements[ground].position;
    let mut sum = Acting::default();
    let actions = joint_actions(case.mechanism, placements, &claimed.reactions, &claimed.tau);
    for (joint, (at, wrench)) in case.mechanism.joints.iter().zip(actions) {
        let [first, second] = joint.bodies.map(|b| b.0 == ground);
        let sign = f64::from(u8::from(first)) - f64::from(u8::from(second));
        let (force, moment) = (wrench.force.scaled(sign), wrench.moment.scaled(sign));
        sum.add(at - origin, force, moment);
    }
    let bodies = Bodies {
        mechanism: case.mechanism,
        placements,
        motions: motions.to_vec(),
    };
    for load in &claimed.loads {
        let wrenches = bodies.load_wrenches(load, case.masses).into_iter();
        for (body, wrench) in wrenches.enumerate().filter(|(body, _)| *body != ground) {
            let arm = placements[body].position - origin;
            sum.add(arm, wrench.force, wrench.moment);
        }
    }
    for (body, mass) in case.masses.iter().enumerate() {
        let [force, moment] = momentum_rates(mass, &placements[body], &motions[body]);
        let arm = centre(placements, case.masses, body) - origin;
        sum.add(arm, -force, -moment);
    }
    let scale = sum.sizes[0]
        .max(sum.sizes[1] / size)
        .max(floor(case, state));
    for error in [sum.force.norm(), sum.moment.norm() / size] {
        state.compare(set, [error, scale], "N", "all bodies");
    }
}
