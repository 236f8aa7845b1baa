//! Kinetostatic states: where the bodies are, how they move and accelerate, and what the joints
//! and actuators do then, under loads, with any number of actuators.
//!
//! A [`State`] is a claim. It is closed densely from the claimed poses, and then
//!
//! ```text
//! J ẋ = [0; q̇]                                               (1)  its velocities
//! J ẍ = [0; q̈] − Φ̇ₓ ẋ                                        (2)  its accelerations
//! Jᵀ [λ; τ] = M ẍ + h − f                                    (3)  its reactions and actions
//! Σ F = m a_G,  Σ M = I α            for every body          (4)  check 8
//! Σ τ q̇ + Σ P = Σ m v·a_G + I ω α                            (5)  check 4
//! Σ F of the ground + Σ f = Σ m a_G, and its moments         (6)  check 7
//! ```
//!
//! In (4) the reactions are forces at points, by the definitions of their components, and the
//! accelerations once the claimed ones, once second differences of positions along
//! q(t) = q + q̇ t + ½ q̈ t², closed without any velocity. (5) and (6) take the dense motion. (3)
//! and the acts of (4) to (6) share nothing but the poses.

mod dense_state;
mod energies;

pub use energies::check_energies;

use crate::comparison::{ComparisonSet, FindingSpec, LargestDifference};
use crate::context::either;
use crate::dense::DenseMechanism;
use crate::differences::NO_ESTIMATE;
use crate::error::DenseError;
use crate::inertias::Inertias;
use crate::wrenches::BodyWrench;
use dense_state::{DenseState, check_counts};
use dwell_findings::{Check, Finding};
use dwell_geometry::{Component, Mechanism};
use dwell_kinetostatics::Mass;
use rayon::prelude::*;
use std::fmt::Display;

/// A claimed state. What is given by body is in the order of [`Mechanism::bodies`], the ground
/// included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ClaimedState {
    /// Time, s: only said in messages.
    pub t: f64,
    /// The coordinates of the actuators, rad or m.
    pub q: Vec<f64>,
    /// Their speeds, rad/s or m/s.
    pub q_dot: Vec<f64>,
    /// Their accelerations, rad/s² or m/s².
    pub q_ddot: Vec<f64>,
    /// The frame [x, y, θ] of every body, m and rad; θ counted over whole revolutions where joints depend on them.
    pub poses: Vec<[f64; 3]>,
    /// Its rates, m/s and rad/s.
    pub velocities: Vec<[f64; 3]>,
    /// Its second derivatives, m/s² and rad/s².
    pub accelerations: Vec<[f64; 3]>,
    /// The reactions in the order of [`Mechanism::reactions`], N or N·m.
    pub reactions: Vec<f64>,
    /// The actuator forces, N·m or N.
    pub tau: Vec<f64>,
    /// The forces and couples of the loads.
    pub load_wrenches: Vec<BodyWrench>,
}

/// Checks claimed states of one mechanism, each by itself, with scales from all of them. Gears
/// mesh as they stand in `assembly_poses`, the frames of all bodies in the assembled configuration.
///
/// Where joints repeat each other, all rows must close, and reactions that are not determined must
/// balance, whatever they are. The findings come in a fixed order. If the mechanism is not determinate there is one failed finding that says why; a state that cannot be closed fails all of them.
pub fn check_states<'m>(
    mechanism: &Mechanism,
    inertias: impl Into<Inertias<'m>>,
    assembly_poses: &[[f64; 3]],
    states: &[ClaimedState],
) -> Vec<Finding> {
    match DenseMechanism::with_meshed_gears(mechanism, inertias, assembly_poses) {
        Ok(dense) => StateChecker::new(&dense, states).findings(),
        Err(error) => vec![not_dense(&POSES, &error)],
    }
}

fn not_dense(spec: &FindingSpec<'_>, error: &DenseError) -> Finding {
    let failed = LargestDifference::failed(error.to_string());
    spec.finding("0 states".to_owned(), failed)
}

const POSES: FindingSpec<'_> = FindingSpec {
    key: "state-poses",
    check: Check::ConstraintClosure,
    comparison: "the poses with the nearest ones that meet every dense row at the coordinates",
    scale: "the largest coordinate of a pose",
    tolerance: 1e-13,
    tolerance_reason: "a pose is given in rounded coordinates, and closed from rounded attachments",
};
const BRANCH: FindingSpec<'_> = FindingSpec {
    key: "state-branch",
    check: Check::ConstraintClosure,
    comparison: "the sign of det J with that of the first state",
    scale: "one is another branch",
    tolerance: 0.0,
    tolerance_reason: "a sign; it cannot change along a branch",
};
const VELOCITIES: FindingSpec<'_> = FindingSpec {
    key: "state-velocities",
    check: Check::ConstraintClosure,
    comparison: "the velocities of all bodies with the solution of J x_dot = q_dot",
    scale: "the largest velocity, angular ones times the size",
    tolerance: 1e-12,
    tolerance_reason: "two solutions of one system, each rounded as often as it has rows",
};
const ACCELERATIONS: FindingSpec<'_> = FindingSpec {
    key: "state-accelerations",
    comparison: "the accelerations of all bodies with the solution of J x_ddot = q_ddot - velocity product",
    scale: "the largest acceleration or squared velocity over the size",
    ..VELOCITIES
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "state-reactions",
    check: Check::ReleasedConstraint,
    comparison: "reactions and actuator forces with the dense solution of J^T lambda = M x_ddot + h - f",
    scale: "the largest of them or of the forces they balance, moments over the size",
    ..VELOCITIES
};
const NEWTON_EULER: FindingSpec<'_> = FindingSpec {
    key: "state-newton-euler",
    check: Check::NewtonEuler,
    comparison: "forces and moments on each body with m a_G and I alpha of the claimed accelerations",
    scale: "the largest sum of absolute terms on a body, moments over the size",
    tolerance: 1e-12,
    tolerance_reason: "a sum of rounded terms",
};
const NEWTON_EULER_DIFFERENCES: FindingSpec<'_> = FindingSpec {
    key: "state-newton-euler-differences",
    comparison: "forces and moments on each body with m a_G and I alpha, positions differenced twice",
    tolerance: 2e-11,
    tolerance_reason: "rounding of the positions over the square of the shortest time step used",
    ..NEWTON_EULER
};
const POWER: FindingSpec<'_> = FindingSpec {
    key: "state-power",
    check: Check::Power,
    comparison: "the power of actuators and loads with the rate of the kinetic energy",
    scale: "the sum of |force| |velocity| of the state",
    ..NEWTON_EULER
};
const MOMENTUM: FindingSpec<'_> = FindingSpec {
    key: "state-momentum",
    check: Check::Momentum,
    comparison: "what the ground and the loads do with the rate of the momentum",
    scale: "the sum of absolute terms of the state",
    ..NEWTON_EULER
};

struct StateChecker<'a> {
    dense: &'a DenseMechanism,
    dense_states: Vec<DenseState<'a>>,
    failures: Vec<String>,
    state_count: usize,
}

impl<'a> StateChecker<'a> {
    fn new(dense: &'a DenseMechanism, states: &'a [ClaimedState]) -> Self {
        let of = |state: &'a ClaimedState| {
            let described = |why: &dyn Display| format!("t = {} s: {why}", state.t);
            check_counts(dense, state).map_err(|why| described(&why))?;
            DenseState::new(dense, state).map_err(|error| described(&error))
        };
        let (dense_states, failures) = states.par_iter().map(of).partition_map(either);
        Self {
            dense,
            dense_states,
            failures,
            state_count: states.len(),
        }
    }

    fn findings(&self) -> Vec<Finding> {
        let mut findings = vec![self.poses(), self.branch()];
        findings.extend(self.motions());
        findings.push(self.reactions());
        findings.extend(self.newton_euler());
        findings.extend([self.power(), self.momentum()]);
        findings
    }

    fn finding(&self, spec: &FindingSpec<'_>, comparisons: ComparisonSet) -> Finding {
        let mut worst = comparisons.largest();
        for reason in &self.failures {
            worst.record_failure(reason.clone());
        }
        spec.finding(format!("{} states", self.state_count), worst)
    }

    /// By row, the actuators' after the reactions': what makes a force of its multiplier, and its name.
    fn rows(&self) -> Vec<(f64, String)> {
        let mechanism = &self.dense.mechanism;
        let arm = |moment: bool| if moment { 1.0 / self.dense.size() } else { 1.0 };
        let reactions = mechanism.reactions().into_iter();
        let reactions = reactions.map(|r| {
            (
                arm(r.component == Component::Moment),
                mechanism.reaction_name(r),
            )
        });
        let actuators = mechanism.actuators.iter();
        let actuators = actuators.map(|a| (arm(a.coordinate().is_angle()), a.name.clone()));
        reactions.chain(actuators).collect()
    }

    /// One comparison in each state, by its own scale.
    fn one_each(
        &self,
        spec: &FindingSpec<'_>,
        unit: &'static str,
        numbers: impl Fn(&DenseState<'_>) -> [f64; 3],
    ) -> Finding {
        let mut comparisons = ComparisonSet::with_individual_scales();
        for m in &self.dense_states {
            m.compare(&mut comparisons, numbers(m), unit, "");
        }
        self.finding(spec, comparisons)
    }

    fn poses(&self) -> Finding {
        self.one_each(&POSES, "", |m| {
            [m.closing_correction, 1.0, m.pose_rounding_bound]
        })
    }

    fn branch(&self) -> Finding {
        let positive = |m: &DenseState<'_>| m.configuration.lu.positive();
        let first = self.dense_states.first().map(positive);
        let is_other = |m: &DenseState<'_>| first != Some(positive(m));
        self.one_each(&BRANCH, "", |m| [f64::from(is_other(m)), 1.0, 0.0])
    }

    /// Velocities and accelerations of the moved frames, (1) and (2).
    fn motions(&self) -> [Finding; 2] {
        let size = self.dense.size();
        let [mut first, mut second] = [(); 2].map(|()| ComparisonSet::default());
        for m in &self.dense_states {
            let [speed, acceleration] =
                [&m.solution.x_dot, &m.solution.x_ddot].map(|x| m.dense.scaled_norm(x) * size);
            let acceleration = acceleration.max(speed * speed / size);
            for (body, _, column) in self.dense.moving_bodies() {
                let name = &self.dense.mechanism.bodies[body].name;
                for c in column..column + 3 {
                    let arm = if c == column + 2 { size } else { 1.0 };
                    let difference = (m.claimed_dot[c] - m.solution.x_dot[c]) * arm;
                    let numbers = [difference, speed, m.bounds.x_dot[c] * arm];
                    m.compare(&mut first, numbers, "m/s", name);
                    let difference = (m.claimed_ddot[c] - m.solution.x_ddot[c]) * arm;
                    let error = m.bounds.x_ddot[c] * arm;
                    let numbers = [difference, acceleration, error];
                    m.compare(&mut second, numbers, "m/s2", name);
                }
            }
        }
        [
            self.finding(&VELOCITIES, first),
            self.finding(&ACCELERATIONS, second),
        ]
    }

    fn reactions(&self) -> Finding {
        let rows = self.rows();
        let mut comparisons = ComparisonSet::default();
        for m in &self.dense_states {
            let claimed = m.state.reactions.iter().chain(&m.state.tau);
            let largest_force = m.largest_force();
            for (k, (claimed, (arm, name))) in claimed.zip(&rows).enumerate() {
                // Of a reaction that is not determined, (4) checks what it does with the others.
                if !self.dense.determinate[k] {
                    continue;
                }
                let dense = m.solution.multipliers[k] * arm;
                let error = m.bounds.multipliers[k] * arm;
                let scale = largest_force.max(dense.abs());
                let numbers = [claimed * arm - dense, scale, error];
                m.compare(&mut comparisons, numbers, "N", name);
            }
        }
        self.finding(&REACTIONS, comparisons)
    }

    /// Check 8, by claimed accelerations and by positions alone.
    fn newton_euler(&self) -> [Finding; 2] {
        let [mut claimed, mut differenced] = [(); 2].map(|()| ComparisonSet::default());
        let size = self.dense.size();
        let states = self.dense_states.par_iter();
        let from_positions: Vec<_> = states.map(DenseState::second_differences).collect();
        for (m, second) in self.dense_states.iter().zip(from_positions) {
            for (i, (body, ..)) in self.dense.moving_bodies().enumerate() {
                let name = &self.dense.mechanism.bodies[body].name;
                let net = m.net_wrench(body);
                let Mass { mass, inertia, .. } = self.dense.bodies[body].mass;
                for (c, exact) in m.inertia_forces(body).into_iter().enumerate() {
                    let (arm, inertia) = match c {
                        2 => (1.0 / size, inertia),
                        _ => (1.0, mass),
                    };
                    let terms = net.terms[c] * arm;
                    let error = m.pose_rounding_bound * terms;
                    let scale = terms + exact.abs() * arm;
                    let numbers = [(net.sum[c] - exact) * arm, scale, error];
                    m.compare(&mut claimed, numbers, "N", name);
                    let varying = if c == 2 {
                        m.varying_inertia(body)
                    } else {
                        [0.0; 2]
                    };
                    let factor = (inertia + varying[0]) * arm;
                    let second = second.get(3 * i + c).copied().unwrap_or(NO_ESTIMATE);
                    let difference = (net.sum[c] - varying[1]) * arm - factor * second.value;
                    let numbers = [difference, scale, error + factor * second.error];
                    m.compare(&mut differenced, numbers, "N", name);
                }
            }
        }
        [
            self.finding(&NEWTON_EULER, claimed),
            self.finding(&NEWTON_EULER_DIFFERENCES, differenced),
        ]
    }

    fn power(&self) -> Finding {
        self.one_each(&POWER, "W", |m| {
            let (difference, terms) = m.power_balance();
            [difference, terms, m.relative_rounding_bound() * terms]
        })
    }

    fn momentum(&self) -> Finding {
        let mut comparisons = ComparisonSet::with_individual_scales();
        for m in &self.dense_states {
            for (difference, terms, what) in m.momentum_balance() {
                let numbers = [difference, terms, m.relative_rounding_bound() * terms];
                m.compare(&mut comparisons, numbers, "N", what);
            }
        }
        self.finding(&MOMENTUM, comparisons)
    }
}
