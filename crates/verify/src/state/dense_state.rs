//! One state closed densely, with all that it is compared with.

use super::ClaimedState;
use crate::checks::MAX_DIFFERENCE_STEP;
use crate::comparison::{Comparison, ComparisonSet};
use crate::constraint_closing::Configuration;
use crate::dense::{DenseMechanism, add_scaled};
use crate::description::DescribedJoint;
use crate::error::Result;
use crate::motion::SecondDifferences;
use crate::pose::Twist;
use crate::wrenches::{BodyWrench, NetWrench};
use dwell_geometry::space::{Vec3, Wrench};

/// A part of a self-stress of length one from which on a reaction is not determined.
const STRESS: f64 = 1e-7;

/// A state with its dense solution.
pub(super) struct DenseState<'a> {
    pub(super) dense: &'a DenseMechanism,
    pub(super) state: &'a ClaimedState,
    pub(super) configuration: Configuration,
    /// How far closing moved the claimed poses, relative to the largest coordinate in them.
    pub(super) closing_correction: f64,
    /// The dense solution, and how much rounding may have moved it.
    pub(super) solution: DenseSolution,
    pub(super) bounds: DenseSolution,
    /// The claimed velocities and accelerations of the moved frames.
    pub(super) claimed_dot: Vec<f64>,
    pub(super) claimed_ddot: Vec<f64>,
    pub(super) pose_rounding_bound: f64,
    pub(super) condition_number: f64,
    pub(super) load_wrenches: Vec<BodyWrench>,
    joint_wrenches: Vec<BodyWrench>,
    /// The velocities at unit speed of each row.
    pub(super) unit_velocities: Vec<Vec<f64>>,
    /// Self-stresses, if reactions are components of forces and rows are redundant.
    stresses: Vec<Vec<f64>>,
}

/// A reaction or an actuator's force, claimed and dense.
pub(super) struct ComparedReaction {
    pub(super) name: String,
    pub(super) is_moment: bool,
    pub(super) claimed: f64,
    pub(super) value: f64,
    pub(super) error: f64,
    /// Whether only one value balances the forces.
    pub(super) is_determined: bool,
}

/// Velocities and accelerations of the moved frames, and the multipliers: reactions, then actuator forces.
pub(super) struct DenseSolution {
    pub(super) x_dot: Vec<f64>,
    pub(super) x_ddot: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
}

impl DenseSolution {
    fn new(
        dense: &DenseMechanism,
        state: &ClaimedState,
        at: &Configuration,
        unit_velocities: &[Vec<f64>],
        loads: &[BodyWrench],
    ) -> Result<Self> {
        let actuator_row = dense.actuator_row();
        let mut x_dot = vec![0.0; dense.rows.columns()];
        for (u, rate) in unit_velocities[actuator_row..].iter().zip(&state.q_dot) {
            add_scaled(&mut x_dot, *rate, u);
        }
        let mut rates = vec![0.0; dense.rows.len()];
        rates[actuator_row..].copy_from_slice(&state.q_ddot);
        let x_ddot = dense.acceleration(at, &x_dot, &rates);
        // M ẍ + h − f: what the joints and actuators have to exert.
        let inertia = dense.inertia_wrenches(&at.poses, [&x_dot, &x_ddot]);
        let mut forces = vec![0.0; dense.rows.columns()];
        dense.add_wrenches(&at.poses, inertia.iter().chain(loads), -1.0, &mut forces);
        Ok(Self {
            multipliers: dense.multipliers(at, &forces)?,
            x_dot,
            x_ddot,
        })
    }

    fn flat(&self) -> Vec<f64> {
        [&self.x_dot[..], &self.x_ddot, &self.multipliers].concat()
    }
}

impl<'a> DenseState<'a> {
    /// A state that has passed [`check_counts`].
    pub(super) fn new(dense: &'a DenseMechanism, state: &'a ClaimedState) -> Result<Self> {
        let poses = &state.poses;
        let (configuration, closing_correction) = dense.close_at(poses, &state.q)?;
        dense.check_redundant_rows(&configuration)?;
        let loads = dense.shifted_wrenches(&state.load_wrenches);
        let velocities = dense.unit_velocities(&configuration);
        let solution = DenseSolution::new(dense, state, &configuration, &velocities, &loads)?;
        let exact = solution.flat();
        let bounds = dense.rounding_bounds(&configuration, &velocities, &exact, |perturbed| {
            let velocities = dense.unit_velocities(perturbed);
            Ok(DenseSolution::new(dense, state, perturbed, &velocities, &loads)?.flat())
        });
        let (bounds, pose_rounding_bound) = bounds?;
        let n = dense.rows.columns();
        let rates = [&state.velocities[..], &state.accelerations];
        Ok(Self {
            closing_correction,
            joint_wrenches: dense.joint_wrenches(
                &configuration.poses,
                &state.reactions,
                &state.tau,
            ),
            state,
            condition_number: dense.condition_number(&configuration.poses),
            stresses: dense.self_stresses(&configuration.poses),
            configuration,
            solution,
            claimed_dot: dense.velocities(poses, &state.velocities),
            claimed_ddot: dense.accelerations(poses, rates),
            unit_velocities: velocities,
            pose_rounding_bound,
            bounds: DenseSolution {
                x_dot: bounds[..n].to_vec(),
                x_ddot: bounds[n..2 * n].to_vec(),
                multipliers: bounds[2 * n..].to_vec(),
            },
            load_wrenches: loads,
            dense,
        })
    }

    /// One comparison in the state: the difference, a lower bound of the scale, and the error of the reference. `what`
    /// names the quantity after the state; it is empty if there is only one.
    pub(super) fn compare(
        &self,
        set: &mut ComparisonSet,
        numbers: [f64; 3],
        unit: &'static str,
        what: &str,
    ) {
        let separator = if what.is_empty() { "" } else { ", " };
        let location = format!("{}{separator}{what}", self.state.name);
        let comparison = Comparison::new(numbers, unit, self.condition_number);
        set.add(comparison, location);
    }

    /// How much rounding may have moved the dense motion, relative to it.
    pub(super) fn relative_rounding_bound(&self) -> f64 {
        let of = |bound: &[f64], value: &[f64]| {
            let [bound, value] = [bound, value].map(|v| self.dense.scaled_norm(v));
            if bound == 0.0 { 0.0 } else { bound / value }
        };
        self.pose_rounding_bound
            .max(of(&self.bounds.x_dot, &self.solution.x_dot))
            .max(of(&self.bounds.x_ddot, &self.solution.x_ddot))
    }

    /// The largest force of inertia or of a load, moments over the size: the scale of reactions if they all vanish.
    pub(super) fn largest_force(&self) -> f64 {
        let size = self.dense.size();
        let loads = self.load_wrenches.iter();
        let loads = loads.map(|l| l.force.norm().max(l.couple.norm() / size));
        let inertia = self.dense.moving_bodies().map(|(body, _)| {
            let rate = self.momentum_rate(body);
            rate.force.norm().max(rate.moment.norm() / size)
        });
        loads.chain(inertia).fold(0.0, f64::max)
    }

    /// Everything that acts on a body, about its centre of mass.
    pub(super) fn net_wrench(&self, body: usize) -> NetWrench {
        let center = self.dense.bodies[body].center(&self.configuration.poses[body]);
        let all = self.joint_wrenches.iter().chain(&self.load_wrenches);
        NetWrench::of(all.filter(|a| a.body.0 == body), center)
    }

    /// m a_G and the rate of the angular momentum about the centre of mass, with the claimed motion.
    pub(super) fn momentum_rate(&self, body: usize) -> Wrench {
        let pose = &self.configuration.poses[body];
        self.dense.bodies[body].momentum_rate(pose, [&self.claimed_dot, &self.claimed_ddot])
    }

    /// The rate with the accelerations from differences of positions.
    pub(super) fn rate_by_differences(&self, body: usize, second: Twist) -> Wrench {
        let (of, pose) = (&self.dense.bodies[body], &self.configuration.poses[body]);
        let omega = of.columns.twist(&self.claimed_dot).angular;
        Wrench {
            force: second.linear.scaled(of.mass.mass),
            moment: of.inertia_moment(pose, omega, second.angular),
        }
    }

    /// How much the errors of these accelerations may move that, component by component.
    pub(super) fn error_by_differences(&self, body: usize, errors: Twist) -> Wrench {
        let (of, pose) = (&self.dense.bodies[body], &self.configuration.poses[body]);
        Wrench {
            force: errors.linear.scaled(of.mass.mass),
            moment: of.angular_momentum(pose, errors.angular),
        }
    }

    /// The wrench on a body minus the rate of its momenta, by component: the difference, the sum of absolute terms with those of the
    /// claimed motion, and the error. Moments are divided by the size, N.
    pub(super) fn balance(
        &self,
        body: usize,
        rate: Wrench,
        claimed: Wrench,
        errors: Wrench,
    ) -> Vec<[f64; 3]> {
        let (net, columns) = (self.net_wrench(body), self.dense.bodies[body].columns);
        let parts = |of: &Wrench| columns.components(of.force, of.moment);
        let all = parts(&net.sum)
            .zip(parts(&rate))
            .zip(parts(&claimed))
            .zip(parts(&errors));
        let numbers = all.map(
            |((((sum, is_moment), (rate, _)), (claimed, _)), (error, _))| {
                let arm = if is_moment {
                    1.0 / self.dense.size()
                } else {
                    1.0
                };
                let terms = net.terms[usize::from(is_moment)] * arm;
                let rounding = self.pose_rounding_bound * terms;
                [
                    (sum - rate) * arm,
                    terms + claimed.abs() * arm,
                    rounding + error.abs() * arm,
                ]
            },
        );
        numbers.collect()
    }

    /// Second derivatives in time of every moving body's centre of mass and angle, from positions
    /// alone. Newton's method starts from the state itself, not where its speeds would lead.
    pub(super) fn second_differences(&self) -> SecondDifferences {
        self.dense.second_differences(
            &self.configuration,
            self.time_step(),
            self.pose_rounding_bound.max(f64::EPSILON),
            |t, q| self.coordinates_at(t, q),
        )
    }

    /// q + q̇ t + ½ q̈ t² of every actuator.
    pub(super) fn coordinates_at(&self, t: f64, q: &mut [f64]) {
        let s = self.state;
        for (i, q) in q.iter_mut().enumerate() {
            *q = s.q[i] + t * (s.q_dot[i] + 0.5 * t * s.q_ddot[i]);
        }
    }

    /// t with v t + ½ a t² = the longest step, s; 1 s at rest.
    pub(super) fn time_step(&self) -> f64 {
        let DenseSolution { x_dot, x_ddot, .. } = &self.solution;
        let [v, a] = [x_dot, x_ddot].map(|x| self.dense.scaled_norm(x));
        let step = 2.0 * MAX_DIFFERENCE_STEP / (v + (v * v + 2.0 * a * MAX_DIFFERENCE_STEP).sqrt());
        if step.is_finite() { step } else { 1.0 }
    }

    /// All reactions, then the actuators' forces.
    pub(super) fn dense_reactions(&self) -> Vec<ComparedReaction> {
        let (dense, state) = (self.dense, self.state);
        let mut all = Vec::new();
        let of_row = |row: usize, claimed: f64| ComparedReaction {
            name: dense.row_names[row].clone(),
            is_moment: dense.angular[row],
            claimed,
            value: self.solution.multipliers[row],
            error: self.bounds.multipliers[row],
            is_determined: dense.determinate[row],
        };
        for joint in &dense.joints {
            let claimed = &state.reactions[joint.reactions.clone()];
            if joint.is_wrench {
                all.extend(self.components(joint, claimed));
            } else {
                let rows = joint.rows.clone().zip(claimed);
                all.extend(rows.map(|(row, claimed)| of_row(row, *claimed)));
            }
        }
        let actuators = (dense.actuator_row()..).zip(&state.tau);
        all.extend(actuators.map(|(row, tau)| of_row(row, *tau)));
        all
    }

    /// Force and moment of a joint by components.
    fn components(&self, joint: &DescribedJoint, claimed: &[f64]) -> Vec<ComparedReaction> {
        let (dense, poses) = (self.dense, &self.configuration.poses);
        let of = |multipliers: &[f64]| dense.joint_wrench(joint, poses, multipliers);
        let (value, error) = (
            of(&self.solution.multipliers),
            dense.joint_wrench_bound(joint, poses, &self.bounds.multipliers),
        );
        let stresses: Vec<[f64; 6]> = self.stresses.iter().map(|stress| of(stress)).collect();
        let reaction = |k: usize| {
            let described = &dense.reactions[joint.reactions.start + k];
            let arm = if described.is_moment {
                1.0 / dense.size()
            } else {
                1.0
            };
            ComparedReaction {
                name: described.name.clone(),
                is_moment: described.is_moment,
                claimed: claimed[k],
                value: value[k],
                error: error[k],
                is_determined: stresses.iter().all(|s| s[k].abs() * arm < STRESS),
            }
        };
        (0..6).map(reaction).collect()
    }

    /// The power of the claimed reactions of a joint at speeds of all coordinates, W.
    pub(super) fn power_of(&self, joint: &DescribedJoint, u: &[f64]) -> f64 {
        let claimed = &self.state.reactions[joint.reactions.clone()];
        self.dense
            .power_of(joint, &self.configuration.poses, claimed, u)
    }

    /// The largest force at the largest speed of a body that the motion has within a step of the differences, W.
    pub(super) fn largest_power(&self) -> f64 {
        let DenseSolution { x_dot, x_ddot, .. } = &self.solution;
        let [v, a] = [x_dot, x_ddot].map(|x| self.dense.scaled_norm(x) * self.dense.size());
        self.largest_force() * (v + a * self.time_step())
    }

    /// The power of the reactions of a joint at unit speed of each actuator, that of the largest force, and its rounding,
    /// W.
    pub(super) fn joint_powers(&self, joint: &DescribedJoint) -> Vec<[f64; 3]> {
        let largest = self.largest_force() * self.dense.size();
        let units = self.unit_velocities[self.dense.actuator_row()..].iter();
        let powers = units.map(|u| {
            let scale = largest * self.dense.scaled_norm(u);
            [
                self.power_of(joint, u),
                scale,
                self.relative_rounding_bound() * scale,
            ]
        });
        powers.collect()
    }

    /// Power of actuators and loads minus the rate of the kinetic energy, the power of the loads, and the sum of the
    /// bounds of the terms, |F| |v|, W: the rounding of a force across its velocity is that of a force along it.
    pub(super) fn power_balance(&self) -> [f64; 3] {
        let (mut sum, mut terms) = (0.0, 0.0);
        let mut add = |power: f64, max: f64| {
            sum += power;
            terms += max;
        };
        for (tau, rate) in self.state.tau.iter().zip(&self.state.q_dot) {
            add(tau * rate, (tau * rate).abs());
        }
        let (poses, solution) = (&self.configuration.poses, &self.solution);
        let rates = [&solution.x_dot[..], &solution.x_ddot];
        let inertia = self.dense.inertia_wrenches(poses, rates);
        let mut of_loads = 0.0;
        for (k, wrench) in self.load_wrenches.iter().chain(&inertia).enumerate() {
            let (body, pose) = (&self.dense.bodies[wrench.body.0], &poses[wrench.body.0]);
            let twist = body.columns.twist(&solution.x_dot);
            let (arm, omega) = (wrench.point - pose.position, twist.angular.norm());
            let power = wrench.force.dot(twist.at(arm)) + wrench.couple.dot(twist.angular);
            let reach = twist.linear.norm() + omega * arm.norm();
            add(
                power,
                wrench.force.norm() * reach + omega * wrench.couple.norm(),
            );
            if k < self.load_wrenches.len() {
                of_loads += power;
            }
        }
        [sum, of_loads, terms]
    }

    /// The wrench of the ground and the loads minus the rate of the momentum, with the sum of absolute terms: forces,
    /// and moments about the ground's moved origin over the size, N.
    pub(super) fn momentum_balance(&self) -> Vec<[f64; 2]> {
        let (dense, ground) = (self.dense, self.dense.ground);
        let mut total = NetWrench::default();
        for wrench in &self.joint_wrenches {
            // The ground's action is the opposite of what acts on it.
            if wrench.body.0 == ground {
                total.add(wrench, -1.0, Vec3::ZERO);
            }
        }
        let DenseSolution { x_dot, x_ddot, .. } = &self.solution;
        let inertia = dense.inertia_wrenches(&self.configuration.poses, [x_dot, x_ddot]);
        let on_bodies = self.load_wrenches.iter().filter(|a| a.body.0 != ground);
        for wrench in on_bodies.chain(&inertia) {
            total.add(wrench, 1.0, Vec3::ZERO);
        }
        let components = dense.whole().components(total.sum.force, total.sum.moment);
        let with_terms = components.map(|(sum, is_moment)| {
            if is_moment {
                [sum / dense.size(), total.terms[1] / dense.size()]
            } else {
                [sum, total.terms[0]]
            }
        });
        with_terms.collect()
    }
}

/// Everything must be there, and as many as there should be.
pub(super) fn check_counts(dense: &DenseMechanism, state: &ClaimedState) -> Result<(), String> {
    let (bodies, actuators) = (dense.bodies.len(), dense.actuators.len());
    let counts = [
        ("coordinates", state.q.len(), actuators),
        ("actuator velocities", state.q_dot.len(), actuators),
        ("actuator accelerations", state.q_ddot.len(), actuators),
        ("poses", state.poses.len(), bodies),
        ("velocities", state.velocities.len(), bodies),
        ("accelerations", state.accelerations.len(), bodies),
        ("reactions", state.reactions.len(), dense.reactions.len()),
        ("actuator forces", state.tau.len(), actuators),
    ];
    if let Some((what, found, expected)) = counts.into_iter().find(|c| c.1 != c.2) {
        return Err(format!("{found} {what} where there are {expected}"));
    }
    let mut loaded = state.load_wrenches.iter().map(|l| l.body.0);
    match loaded.find(|&b| b >= bodies) {
        Some(body) => Err(format!(
            "a load acts on body {body}, but there are {bodies} bodies"
        )),
        None => Ok(()),
    }
}
