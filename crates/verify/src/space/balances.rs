//! Newton's and Euler's equations of each body of a claimed state, and the balances of the whole.

use super::rows::Bodies;
use super::state::{DenseState, SpaceChecker};
use crate::comparison::{ComparisonSet, FindingSpec};
use dwell_findings::{Check, Finding};
use dwell_geometry::Body;
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

impl DenseState<'_> {
    fn centre(&self, body: usize) -> Vec3 {
        let Placement { position, rotation } = &self.placements()[body];
        *position + rotation.apply(self.case.masses[body].center)
    }

    /// By joint: what its first body does to the second, at a point.
    fn joint_actions(&self, tau: &[f64]) -> Vec<(Vec3, Wrench)> {
        let (mechanism, placements) = (self.case.mechanism, self.placements());
        joint_actions(mechanism, placements, &self.claimed.reactions, tau)
    }

    /// By load and body: what the load does about the body's origin, where the bodies have these motions.
    pub(super) fn load_wrenches(&self, motions: &[BodyMotion]) -> Vec<Vec<Wrench>> {
        let bodies = Bodies {
            mechanism: self.case.mechanism,
            placements: self.placements(),
            motions: motions.to_vec(),
        };
        let loads = self.claimed.loads.iter();
        let wrenches = loads.map(|load| bodies.load_wrenches(load, self.case.masses));
        wrenches.collect()
    }

    /// By body: what joints, actuators and loads do to it about its centre.
    fn acting(&self) -> Vec<Acting> {
        let placements = self.placements();
        let mut all = vec![Acting::default(); placements.len()];
        let about = |body: usize, at: Vec3| at - self.centre(body);
        let actions = self.joint_actions(&self.claimed.tau);
        for (joint, (at, wrench)) in self.case.mechanism.joints.iter().zip(actions) {
            let [first, second] = joint.bodies.map(|b| b.0);
            all[second].add(about(second, at), wrench.force, wrench.moment);
            all[first].add(about(first, at), -wrench.force, -wrench.moment);
        }
        for wrenches in self.load_wrenches(&self.claimed.motions) {
            for (body, wrench) in wrenches.into_iter().enumerate() {
                let arm = about(body, placements[body].position);
                all[body].add(arm, wrench.force, wrench.moment);
            }
        }
        all
    }

    /// Adds what does not balance on each body, given the rates of its momenta.
    pub(super) fn add_balances(&self, rates: impl Fn(usize) -> [Vec3; 2], set: &mut ComparisonSet) {
        let (mechanism, size) = (self.case.mechanism, self.case.size);
        let acting = self.acting();
        let scale = self.largest(&acting).max(self.floor());
        let bodies = acting.iter().zip(&mechanism.bodies).enumerate();
        for (body, (acting, Body { name, .. })) in bodies.filter(|(b, _)| *b != mechanism.ground) {
            let [force, moment] = rates(body);
            let errors = [
                (acting.force - force).norm(),
                (acting.moment - moment).norm() / size,
            ];
            for error in errors {
                self.compare(set, [error, scale], "N", name);
            }
        }
    }

    /// The largest sum of absolute terms on a body that moves, moments over the size, N.
    fn largest(&self, acting: &[Acting]) -> f64 {
        let bodies = acting.iter().enumerate();
        let moving = bodies.filter(|(b, _)| *b != self.case.mechanism.ground);
        moving.fold(0.0_f64, |max, (_, acting)| {
            let [force, moment] = acting.sizes;
            max.max(force).max(moment / self.case.size)
        })
    }

    /// The largest speed of a body, that of its rotation at the size, m/s, and a thousandth of what the motion makes of the whole mass, N.
    fn pace(&self) -> [f64; 2] {
        let size = self.case.size;
        let of = |[linear, angular]: [Vec3; 2]| linear.norm().max(angular.norm() * size);
        let motions = self.claimed.motions.iter();
        let [speed, acceleration] = motions.fold([0.0_f64; 2], |[speed, acceleration], m| {
            let rates = [m.acceleration, m.angular_acceleration];
            [
                speed.max(of([m.velocity, m.angular_velocity])),
                acceleration.max(of(rates)),
            ]
        });
        let mass: f64 = self.case.masses.iter().map(|mass| mass.mass).sum();
        [speed, 1e-3 * mass * acceleration.max(speed * speed / size)]
    }

    /// What nothing makes is zero to the rounding of what may be.
    fn floor(&self) -> f64 {
        self.pace()[1]
    }

    /// The largest sum of absolute terms on a body, or a thousandth of what the motion makes of the whole mass, N.
    pub(super) fn largest_force(&self) -> f64 {
        self.largest(&self.acting()).max(self.floor())
    }

    /// That force at the largest speed of a body, W.
    pub(super) fn largest_power(&self) -> f64 {
        self.largest_force() * self.pace()[0]
    }

    fn add_power(&self, motions: &[BodyMotion], set: &mut ComparisonSet) {
        let (claimed, placements) = (self.claimed, self.placements());
        let (mut rate, mut scale) = (0.0, claimed.load_power.abs());
        for (body, mass) in self.case.masses.iter().enumerate() {
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
        let mut work = 0.0;
        for wrenches in self.load_wrenches(motions) {
            for (wrench, motion) in wrenches.iter().zip(motions) {
                let part = power(wrench, motion);
                work += part;
                scale += part.abs();
            }
        }
        let scale = scale.max(self.largest_power());
        let unbalanced = actuators + claimed.load_power - rate;
        self.compare(set, [unbalanced, scale], "W", "all bodies");
        self.compare(set, [claimed.load_power - work, scale], "W", "loads");
    }

    /// A reaction does no work: what a joint leaves free it does not hold.
    fn add_joint_powers(&self, motions: &[BodyMotion], set: &mut ComparisonSet) {
        let placements = self.placements();
        let speed = motions.iter().fold(0.0_f64, |max, m| {
            max.max(m.velocity.norm())
                .max(m.angular_velocity.norm() * self.case.size)
        });
        let scale = self.largest_force() * speed;
        let actions = self.joint_actions(&vec![0.0; self.claimed.tau.len()]);
        for (joint, (at, wrench)) in self.case.mechanism.joints.iter().zip(actions) {
            let [first, second] = joint.bodies.map(|body| {
                let motion = &motions[body.0];
                let velocity = motion.point_velocity(at - placements[body.0].position);
                (velocity, motion.angular_velocity)
            });
            let power =
                wrench.force.dot(second.0 - first.0) + wrench.moment.dot(second.1 - first.1);
            self.compare(set, [power, scale], "W", &joint.name);
        }
    }

    fn add_momentum(&self, motions: &[BodyMotion], set: &mut ComparisonSet) {
        let (case, placements) = (self.case, self.placements());
        let (ground, size) = (case.mechanism.ground, case.size);
        // About where the ground is, which is nowhere in particular.
        let origin = placements[ground].position;
        let mut sum = Acting::default();
        let actions = self.joint_actions(&self.claimed.tau);
        for (joint, (at, wrench)) in case.mechanism.joints.iter().zip(actions) {
            let [first, second] = joint.bodies.map(|b| b.0 == ground);
            let sign = f64::from(u8::from(first)) - f64::from(u8::from(second));
            let (force, moment) = (wrench.force.scaled(sign), wrench.moment.scaled(sign));
            sum.add(at - origin, force, moment);
        }
        for wrenches in self.load_wrenches(motions) {
            let wrenches = wrenches.into_iter().enumerate();
            for (body, wrench) in wrenches.filter(|(body, _)| *body != ground) {
                let arm = placements[body].position - origin;
                sum.add(arm, wrench.force, wrench.moment);
            }
        }
        for (body, mass) in case.masses.iter().enumerate() {
            let [force, moment] = momentum_rates(mass, &placements[body], &motions[body]);
            sum.add(self.centre(body) - origin, -force, -moment);
        }
        let [force, moment] = sum.sizes;
        let scale = force.max(moment / size).max(self.floor());
        for error in [sum.force.norm(), sum.moment.norm() / size] {
            self.compare(set, [error, scale], "N", "all bodies");
        }
    }
}

/// The power of what acts at a body's origin, W.
pub(super) fn power(wrench: &Wrench, motion: &BodyMotion) -> f64 {
    wrench.force.dot(motion.velocity) + wrench.moment.dot(motion.angular_velocity)
}

impl SpaceChecker<'_> {
    /// Newton's and Euler's equations with the claimed motions.
    pub(super) fn newton_euler(&self) -> Finding {
        let mut set = ComparisonSet::with_individual_scales();
        for state in &self.states {
            let (motions, placements) = (&state.claimed.motions, state.placements());
            let masses = self.case.masses;
            let rates = |b: usize| momentum_rates(&masses[b], &placements[b], &motions[b]);
            state.add_balances(rates, &mut set);
        }
        self.finding(&NEWTON_EULER, set, None)
    }

    /// Power, that of the joints' reactions, and momentum, of the dense motions.
    pub(super) fn of_whole(&self) -> [Finding; 3] {
        let [mut power, mut ideal, mut momentum] =
            [(); 3].map(|()| ComparisonSet::with_individual_scales());
        for (state, closed, dense) in self.solved() {
            for unit in &closed.unit {
                state.add_joint_powers(unit, &mut ideal);
            }
            state.add_power(&dense.motions, &mut power);
            state.add_momentum(&dense.motions, &mut momentum);
        }
        [
            self.finding(&POWER, power, None),
            self.finding(&IDEAL_JOINTS, ideal, None),
            self.finding(&MOMENTUM, momentum, None),
        ]
    }
}
