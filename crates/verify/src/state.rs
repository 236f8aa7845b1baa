//! Kinetostatic states: positions, velocities and accelerations of the bodies, and the forces of joints and actuators
//! under loads, with any number of actuators.
//!
//! A [`ClaimedState`] is a claim. It is closed densely from the claimed poses, and then
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
//! and the actions in (4) to (6) share nothing but the poses.

mod branch;
mod dense_state;
mod energies;

pub use branch::check_branch;
pub use energies::check_energies;

use crate::case::CheckedMechanism;

use crate::comparison::{ComparisonSet, FindingSpec, LargestDifference};
use crate::context::either;
use crate::dense::DenseMechanism;
use crate::description::DescribedJoint;
use crate::error::{DenseError, Result};
use crate::pose::{Pose, Twist};
use crate::wrenches::BodyWrench;
use dense_state::{DenseState, check_counts};
use dwell_findings::{Check, Finding};
use dwell_geometry::space::Wrench;
use rayon::prelude::*;
use std::fmt::Display;

/// The assembled mechanism whose states are claimed.
#[derive(Debug, Clone, Copy)]
pub struct AssembledMechanism<'a> {
    /// The mechanism.
    pub mechanism: CheckedMechanism<'a>,
    /// The coordinates of its actuators there, rad or m: only the [branch](check_branch) and teeth in space are continued from them.
    pub q: &'a [f64],
    /// The poses of its bodies at assembly.
    pub poses: &'a [Pose],
}

impl AssembledMechanism<'_> {
    /// In dense rows, its gears meshed as they stand there.
    ///
    /// # Errors
    /// [`DenseError`] where the rows do not determine the pose.
    pub(crate) fn dense(&self) -> Result<DenseMechanism> {
        let dense = self.mechanism.dense()?;
        let start = dense.moved_frames(self.poses)?;
        dense.assembled(&start)
    }
}

/// A claimed state. Values by body are in the order of the mechanism's bodies, including the ground.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ClaimedState {
    /// Which state it is, for messages.
    pub name: String,
    /// Time, s.
    pub t: f64,
    /// The coordinates of the actuators, rad or m.
    pub q: Vec<f64>,
    /// Their speeds, rad/s or m/s.
    pub q_dot: Vec<f64>,
    /// Their accelerations, rad/s² or m/s².
    pub q_ddot: Vec<f64>,
    /// The poses of the bodies. In the plane, their angles count whole revolutions if joints depend on them.
    pub poses: Vec<Pose>,
    /// Their rates, m/s and rad/s.
    pub velocities: Vec<Twist>,
    /// The rates of these, m/s² and rad/s².
    pub accelerations: Vec<Twist>,
    /// The reactions, N or N·m: in the plane in the order of [`dwell_geometry::Mechanism::reactions`]; in space by joint the components of
    /// force and moment of the first body on the second about the joint's point on it, in the axes of the ground.
    pub reactions: Vec<f64>,
    /// The actuator forces, N·m or N.
    pub tau: Vec<f64>,
    /// The generalised inertias M_ij, row by row: only the checks by [energies](check_energies) need them.
    pub inertias: Vec<f64>,
    /// The forces and couples of the loads.
    pub load_wrenches: Vec<BodyWrench>,
    /// The power of all loads, W, if it is claimed.
    pub load_power: Option<f64>,
}

/// Checks claimed states of one mechanism one by one, with scales from all of them; a number of them, spread evenly, also by
/// [kinetic energy](check_energies).
///
/// If joints are redundant, all rows must close, and reactions that are not determined must balance. The findings come in a fixed order. If
/// the mechanism is not determinate there is one failed finding with the reason; a state that cannot be closed fails all of them.
pub fn check_states(
    assembled: &AssembledMechanism<'_>,
    states: &[ClaimedState],
    by_energies: usize,
) -> Vec<Finding> {
    let dense = match assembled.dense() {
        Ok(dense) => dense,
        Err(error) => return vec![not_dense(&POSES, &error)],
    };
    let some = by_energies.min(states.len());
    let sampled = (0..some).map(|k| states[(2 * k + 1) * states.len() / (2 * some)].clone());
    let sampled: Vec<ClaimedState> = sampled.collect();
    let by_motion = || {
        let checker = StateChecker::new(&dense, states);
        let mut findings = checker.findings();
        if states.iter().any(|state| state.load_power.is_some()) {
            findings.push(checker.energy_rates());
        }
        if dense.rows.has_teeth_in_space() {
            findings.push(branch::check_mesh(assembled, states));
        }
        findings
    };
    let of_sampled =
        || (by_energies > 0).then(|| StateChecker::new(&dense, &sampled).by_energies());
    let (mut findings, more) = rayon::join(by_motion, of_sampled);
    findings.extend(more.into_iter().flatten());
    findings
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
/// The tolerance of this check with wrenches in the joints; the largest difference in a case is 7.8e-16.
const NEWTON_EULER_OF_WRENCHES: f64 = 7e-14;
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
            let described = |why: &dyn Display| format!("{}: {why}", state.name);
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
        findings.push(self.power());
        findings.extend(self.ideal_joints());
        findings.push(self.momentum());
        findings
    }

    fn finding(&self, spec: &FindingSpec<'_>, comparisons: ComparisonSet) -> Finding {
        let mut worst = comparisons.largest();
        for reason in &self.failures {
            worst.record_failure(reason.clone());
        }
        spec.finding(format!("{} states", self.state_count), worst)
    }

    /// By row, those of the actuators after those of the joints: the factor from its multiplier to a force, and its
    /// name.
    fn rows(&self) -> Vec<(f64, &str)> {
        let (angular, names) = (self.dense.angular.iter(), self.dense.row_names.iter());
        let arm = |is_angle: bool| {
            if is_angle {
                1.0 / self.dense.size()
            } else {
                1.0
            }
        };
        let rows = angular.zip(names);
        rows.map(|(is_angle, name)| (arm(*is_angle), name.as_str()))
            .collect()
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
        // By the same rows in all states; where these are dependent, or rows in space repeat each other, the sign decides nothing: such a
        // branch is continued instead.
        let positive = |m: &DenseState<'_>| self.dense.orientation(&m.configuration.poses);
        let first = self.dense_states.iter().find_map(positive);
        let is_other = |m: &DenseState<'_>| positive(m).is_some_and(|sign| first != Some(sign));
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
            for (_, body) in self.dense.moving_bodies() {
                for c in body.columns.range() {
                    let arm = 1.0 / m.dense.column_scale(c);
                    let difference = (m.claimed_dot[c] - m.solution.x_dot[c]) * arm;
                    let numbers = [difference, speed, m.bounds.x_dot[c] * arm];
                    m.compare(&mut first, numbers, "m/s", &body.name);
                    let difference = (m.claimed_ddot[c] - m.solution.x_ddot[c]) * arm;
                    let error = m.bounds.x_ddot[c] * arm;
                    let numbers = [difference, acceleration, error];
                    m.compare(&mut second, numbers, "m/s2", &body.name);
                }
            }
        }
        [
            self.finding(&VELOCITIES, first),
            self.finding(&ACCELERATIONS, second),
        ]
    }

    fn reactions(&self) -> Finding {
        let mut comparisons = ComparisonSet::default();
        for m in &self.dense_states {
            let largest_force = m.largest_force();
            // Of a reaction that is not determined, (4) checks what it does with the others.
            for reaction in m.dense_reactions().into_iter().filter(|r| r.is_determined) {
                let arm = if reaction.is_moment {
                    1.0 / self.dense.size()
                } else {
                    1.0
                };
                let dense = reaction.value * arm;
                let numbers = [
                    reaction.claimed * arm - dense,
                    largest_force.max(dense.abs()),
                    reaction.error * arm,
                ];
                m.compare(&mut comparisons, numbers, "N", &reaction.name);
            }
        }
        self.finding(&REACTIONS, comparisons)
    }

    /// Check 8, by claimed accelerations and by positions alone.
    fn newton_euler(&self) -> [Finding; 2] {
        let [mut claimed, mut differenced] = [(); 2].map(|()| ComparisonSet::default());
        let states = self.dense_states.par_iter();
        let from_positions: Vec<_> = states.map(DenseState::second_differences).collect();
        for (m, second) in self.dense_states.iter().zip(from_positions) {
            for (b, body) in self.dense.moving_bodies() {
                let exact = m.momentum_rate(b);
                let rate = m.rate_by_differences(b, second.of(b));
                let errors = m.error_by_differences(b, second.errors(b));
                let of_motion = m.balance(b, exact, exact, Wrench::default());
                let of_positions = m.balance(b, rate, exact, errors);
                for numbers in of_motion {
                    m.compare(&mut claimed, numbers, "N", &body.name);
                }
                for numbers in of_positions {
                    m.compare(&mut differenced, numbers, "N", &body.name);
                }
            }
        }
        let mut claimed = self.finding(&NEWTON_EULER, claimed);
        if self.has_wrenches() {
            claimed.set_tolerance(NEWTON_EULER_OF_WRENCHES, NEWTON_EULER.tolerance_reason);
        }
        [
            claimed,
            self.finding(&NEWTON_EULER_DIFFERENCES, differenced),
        ]
    }

    fn power(&self) -> Finding {
        let mut comparisons = ComparisonSet::with_individual_scales();
        for m in &self.dense_states {
            let [difference, of_loads, terms] = m.power_balance();
            let error = m.relative_rounding_bound() * terms;
            m.compare(&mut comparisons, [difference, terms, error], "W", "");
            if let Some(claimed) = m.state.load_power {
                let numbers = [claimed - of_loads, terms, error];
                m.compare(&mut comparisons, numbers, "W", "loads");
            }
        }
        self.finding(&POWER, comparisons)
    }

    /// A joint transmits nothing along its freedoms; `None` if all reactions are multipliers of rows.
    fn ideal_joints(&self) -> Option<Finding> {
        let mut comparisons = ComparisonSet::with_individual_scales();
        let is_wrench = |joint: &&DescribedJoint| joint.is_wrench;
        for joint in self.dense.joints.iter().filter(is_wrench) {
            for m in &self.dense_states {
                for numbers in m.joint_powers(joint) {
                    m.compare(&mut comparisons, numbers, "W", &joint.name);
                }
            }
        }
        self.has_wrenches()
            .then(|| self.finding(&IDEAL_JOINTS, comparisons))
    }

    /// Whether reactions are components of force and moment.
    fn has_wrenches(&self) -> bool {
        self.dense.joints.iter().any(|joint| joint.is_wrench)
    }

    fn momentum(&self) -> Finding {
        let mut comparisons = ComparisonSet::with_individual_scales();
        for m in &self.dense_states {
            for [difference, terms] in m.momentum_balance() {
                let numbers = [difference, terms, m.relative_rounding_bound() * terms];
                m.compare(&mut comparisons, numbers, "N", "");
            }
        }
        self.finding(&MOMENTUM, comparisons)
    }
}
