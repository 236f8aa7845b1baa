//! Claimed states of a mechanism in space, with any number of actuators, under loads.
//!
//! ```text
//! J ẋ = D q̇,  J ẍ = D q̈ − J̇ẋ                                  check 0   its velocities and accelerations
//! M_ij = ⟨uᵢ, uⱼ⟩,  ½ q̇ᵀ M q̇ = ½ ⟨ẋ, ẋ⟩                         check 1   its inertias, u the velocities at unit speeds
//! τ + Q = M q̈ + Ṁ q̇ − ½ ∂(q̇ᵀ M q̇)/∂q                           check 2   its actions, by differences of M
//! Jᵀ [λ; τ] = M ẍ + h − f                                       check 3   its reactions
//! Σ τ q̇ + P = ⟨ẋ, ẍ⟩                                           check 4   the power of its actuators and loads
//! Σ F of the ground + Σ f = d/dt Σ m v, and its moments         check 7
//! Σ F = d(m v)/dt,  Σ M = d(I ω)/dt     for every body          check 8
//! ```
//!
//! The claimed placements are closed densely first. Checks 0, 1, 3, 4 and 7 take the [dense](super) motion there; 8 takes the claimed
//! accelerations, and then those that positions show, differenced twice along q(t) = q + q̇ t + ½ q̈ t².

use super::closing::coordinate_error;
use super::rows::{closure_error, mesh_error};
use super::{DensePose, DenseSpace, parts};
use crate::comparison::{Comparison, ComparisonSet, FindingSpec, LargestDifference};
use crate::subject::SubjectError;
use dwell_findings::{Check, Finding};
use dwell_geometry::JointId;
use dwell_geometry::space::{
    Actuator, ActuatorKind, BodyMotion, IdleBody, JointKind, Mechanism, Placement, Vec3, Wrench,
};
use dwell_kinetostatics::space::{LoadKind, Mass};
use std::rc::Rc;

/// A claimed state. What is given by body is in the order of [`Mechanism::bodies`], the ground included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SpaceState {
    /// The coordinates of the actuators, rad or m.
    pub q: Vec<f64>,
    /// Their speeds.
    pub q_dot: Vec<f64>,
    /// Their accelerations.
    pub q_ddot: Vec<f64>,
    /// Where the bodies are.
    pub placements: Vec<Placement>,
    /// How they move.
    pub motions: Vec<BodyMotion>,
    /// By joint: the action of the first body on the second, about the joint's point on the second, in the axes of the ground.
    pub reactions: Vec<Wrench>,
    /// The actuators' actions, N·m or N.
    pub tau: Vec<f64>,
    /// The generalised inertias M_ij, row by row.
    pub inertias: Vec<f64>,
    /// The loads with their magnitudes.
    pub loads: Vec<(LoadKind, f64)>,
    /// The power of all loads, W.
    pub load_power: f64,
}

/// The mechanism whose states are claimed.
#[derive(Debug, Clone, Copy)]
pub struct SpaceCase<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// By body.
    pub masses: &'a [Mass],
    /// A length of its order, m.
    pub size: f64,
    /// Bodies that can turn about the line of their two balls: their orientation about it is nobody's.
    pub idle: &'a [IdleBody],
    /// The coordinates at the assembly, and where its bodies are there.
    pub start: (&'a [f64], &'a [Placement]),
}

impl SpaceCase<'_> {
    /// The unit of a coordinate: one radian, or the size.
    pub(super) fn unit(&self, actuator: usize) -> f64 {
        match self.mechanism.actuators[actuator].kind {
            ActuatorKind::Angle(_) => 1.0,
            ActuatorKind::Travel(_) | ActuatorKind::Length(_) => self.size,
        }
    }

    /// What makes an action of a force: the size of an angle's, one of a length's.
    pub(super) fn lever(&self, actuator: usize) -> f64 {
        match self.mechanism.actuators[actuator].kind {
            ActuatorKind::Angle(_) => self.size,
            ActuatorKind::Travel(_) | ActuatorKind::Length(_) => 1.0,
        }
    }

    /// The coordinates on a straight line from those at the assembly to others, in steps no longer than `longest`, rad or parts of the
    /// size; with the part of the way.
    pub(super) fn positions_towards(
        &self,
        q: &[f64],
        longest: f64,
    ) -> impl Iterator<Item = (f64, Vec<f64>)> {
        let both = move || self.start.0.iter().zip(q);
        let distances = both().enumerate();
        let distances = distances.map(|(k, (from, to))| (to - from).abs() / self.unit(k));
        let count = (distances.fold(0.0, f64::max) / longest).ceil().max(1.0);
        (1..=count as usize).map(move |k| {
            let part = k as f64 / count;
            let at = both().map(|(from, to)| from + part * (to - from));
            (part, at.collect())
        })
    }
}

/// What is asked beside the states. A question must have the same answer whatever was asked before.
pub trait SpaceSubject {
    /// Where the bodies are at coordinates, rad or m.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    fn placements(&self, q: &[f64]) -> Result<Vec<Placement>, SubjectError>;

    /// The generalised inertias at coordinates, row by row.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    fn inertias(&self, q: &[f64]) -> Result<Vec<f64>, SubjectError>;
}

const ROUNDING: &str = "rounding, amplified by the condition of the equations";

const CLOSURE: FindingSpec<'_> = FindingSpec {
    key: "state-closure",
    check: Check::ConstraintClosure,
    comparison: "points and axes of both bodies of each joint, the teeth of gears since the assembly, the ground's frame, and the actuators' coordinates",
    scale: "the size of the mechanism, or one radian",
    // The largest seen in a case is 1.6e-15.
    tolerance: 1e-13,
    tolerance_reason: ROUNDING,
};
const VELOCITIES: FindingSpec<'_> = FindingSpec {
    key: "state-velocities",
    check: Check::ConstraintClosure,
    comparison: "the velocities of all bodies with the solution of J x_dot = q_dot",
    scale: "the largest velocity, angular ones times the size",
    // The largest seen in a case is 2.9e-14, of accelerations.
    tolerance: 2e-12,
    tolerance_reason: ROUNDING,
};
const ACCELERATIONS: FindingSpec<'_> = FindingSpec {
    key: "state-accelerations",
    comparison: "the accelerations of all bodies with the solution of J x_ddot = q_ddot - velocity product",
    scale: "the largest acceleration or squared velocity over the size",
    ..VELOCITIES
};
const INERTIAS: FindingSpec<'_> = FindingSpec {
    key: "state-mass-matrix",
    check: Check::KineticEnergy,
    comparison: "every M_ij with the product of the dense velocities at unit speeds of i and j",
    scale: "the root of M_ii M_jj",
    // The largest seen in a case is 9.1e-14.
    tolerance: 5e-12,
    tolerance_reason: ROUNDING,
};
const KINETIC: FindingSpec<'_> = FindingSpec {
    key: "state-kinetic-energy",
    comparison: "half q_dot M q_dot with the energy of the claimed velocities of all bodies",
    scale: "the kinetic energy",
    // The largest seen in a case is 1.3e-15.
    tolerance: 1e-13,
    ..INERTIAS
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "state-reactions",
    check: Check::ReleasedConstraint,
    comparison: "determined reactions and actuators' actions with the dense solution of J^T lambda = M x_ddot + h - f",
    scale: "the largest of them or of the forces they balance, moments over the size",
    // The largest seen in a case is 3.4e-13.
    tolerance: 2e-11,
    tolerance_reason: ROUNDING,
};

/// Checks claimed states of one mechanism, each by itself. The claims are compared
/// with the solution at the nearest pose that meets all rows; a state without one fails all findings.
///
/// Reactions that redundant constraints leave open must balance, whatever they are. The findings come in a fixed order.
pub fn check_states_in_space(
    case: &SpaceCase<'_>,
    subject: &dyn SpaceSubject,
    states: &[SpaceState],
) -> Vec<Finding> {
    let checker = SpaceChecker {
        case,
        subject,
        states: solve_all(case, states),
    };
    let mut findings = vec![checker.closure()];
    findings.extend(checker.motions());
    findings.extend(checker.inertias());
    findings.extend(checker.by_inertias());
    findings.push(checker.reactions());
    findings.extend(checker.of_whole());
    findings.push(checker.newton_euler());
    findings.push(checker.newton_euler_by_differences());
    findings
}

/// All claimed states of a case.
pub(super) struct SpaceChecker<'a> {
    pub(super) case: &'a SpaceCase<'a>,
    pub(super) subject: &'a dyn SpaceSubject,
    pub(super) states: Vec<DenseState<'a>>,
}

/// A claimed state with the solution of the dense equations at the nearest closed pose.
pub(super) struct DenseState<'a> {
    pub(super) case: &'a SpaceCase<'a>,
    pub(super) claimed: &'a SpaceState,
    /// The pose, and the solution there; or why there is none.
    pub(super) solved: Result<(Rc<ClosedPose>, DenseSpace), String>,
}

/// The pose nearest to claimed placements that meets all rows.
pub(super) struct ClosedPose {
    pub(super) placements: Vec<Placement>,
    /// By actuator: the velocities of all bodies at its unit speed.
    pub(super) unit: Vec<Vec<BodyMotion>>,
}

/// Solves all states; those that follow each other at the same placements share the factors.
fn solve_all<'a>(case: &'a SpaceCase<'a>, states: &'a [SpaceState]) -> Vec<DenseState<'a>> {
    let mut last: Option<(&SpaceState, DensePose<'_>, Rc<ClosedPose>)> = None;
    let mut all = Vec::with_capacity(states.len());
    for claimed in states {
        let is_same = |(of, ..): &(&SpaceState, DensePose<'_>, Rc<ClosedPose>)| {
            of.placements == claimed.placements && of.q == claimed.q
        };
        let known = last.take().filter(is_same);
        let pose = known.map(|(_, pose, closed)| Ok((pose, closed)));
        let pose = pose.unwrap_or_else(|| {
            let at = &claimed.placements;
            let pose = DensePose::nearest(case.mechanism, at, (&claimed.q, None), case.size);
            let pose = pose.map_err(|e| e.to_string())?;
            let unit = |i: usize| {
                let mut rates = vec![0.0; claimed.q.len()];
                rates[i] = 1.0;
                pose.velocities(&rates)
            };
            let closed = ClosedPose {
                unit: (0..claimed.q.len()).map(unit).collect(),
                placements: pose.placements.to_vec(),
            };
            Ok((pose, Rc::new(closed)))
        });
        let solved = pose.map(|(pose, closed)| {
            let rates = [&claimed.q_dot[..], &claimed.q_ddot];
            let dense = pose.solve(case.masses, rates, &claimed.loads);
            last = Some((claimed, pose, Rc::clone(&closed)));
            (closed, dense)
        });
        all.push(DenseState {
            case,
            claimed,
            solved,
        });
    }
    all
}

impl DenseState<'_> {
    /// Where the bodies are in the closed pose; as claimed where there is none.
    pub(super) fn placements(&self) -> &[Placement] {
        match &self.solved {
            Ok((closed, _)) => &closed.placements,
            Err(_) => &self.claimed.placements,
        }
    }

    /// Adds a difference with its scale.
    pub(super) fn compare(
        &self,
        to: &mut ComparisonSet,
        [difference, scale]: [f64; 2],
        unit: &'static str,
        what: &str,
    ) {
        let q: Vec<String> = self.claimed.q.iter().map(|q| format!("{q:.4}")).collect();
        let comparison = Comparison::new([difference, scale, 0.0], unit, 1.0);
        to.add(comparison, format!("q = {}, {what}", q.join(" ")));
    }

    /// ⟨u, v⟩ of two motions of all bodies.
    fn product(&self, motions: [&[BodyMotion]; 2]) -> f64 {
        product(self.case, self.placements(), motions)
    }
}

impl SpaceChecker<'_> {
    /// The states that have a dense solution, with it.
    pub(super) fn solved(
        &self,
    ) -> impl Iterator<Item = (&DenseState<'_>, &ClosedPose, &DenseSpace)> {
        let solved = self.states.iter();
        solved.filter_map(|state| match &state.solved {
            Ok((closed, dense)) => Some((state, &**closed, dense)),
            Err(_) => None,
        })
    }

    /// The finding of comparisons in all states; it fails where a state has no dense solution, or for another reason.
    pub(super) fn finding(
        &self,
        spec: &FindingSpec<'_>,
        comparisons: ComparisonSet,
        failure: Option<String>,
    ) -> Finding {
        let mut worst: LargestDifference = comparisons.largest();
        let of_states = self.states.iter();
        let of_states = of_states.filter_map(|s| s.solved.as_ref().err().cloned());
        for reason in of_states.chain(failure) {
            worst.record_failure(reason);
        }
        spec.finding(format!("{} states", self.states.len()), worst)
    }

    fn closure(&self) -> Finding {
        let (mechanism, scale) = (self.case.mechanism, self.case.size.max(1.0));
        let mut open = ComparisonSet::with_individual_scales();
        let mut failure = None;
        for state in &self.states {
            let at = &state.claimed.placements;
            let mut add = |error: f64, what: &str| {
                state.compare(&mut open, [error, scale], "m or rad", what);
            };
            for (j, joint) in mechanism.joints.iter().enumerate() {
                // A driven distance holds nothing.
                let drives = |a: &Actuator| a.kind == ActuatorKind::Length(JointId(j));
                if !mechanism.actuators.iter().any(drives) {
                    add(closure_error(joint, at), &joint.name);
                }
            }
            let ground = &at[mechanism.ground];
            for error in [ground.position.norm(), ground.rotation.vector().norm()] {
                add(error, "the ground");
            }
            for (actuator, q) in mechanism.actuators.iter().zip(&state.claimed.q) {
                let error = coordinate_error(mechanism, actuator.kind, at, *q);
                add(error, &actuator.name);
            }
            match self.mesh_errors(state.claimed) {
                Ok(errors) => errors
                    .into_iter()
                    .for_each(|(name, error)| add(error, name)),
                Err(error) => failure = Some(error.to_string()),
            }
        }
        self.finding(&CLOSURE, open, failure)
    }

    /// By gear pair: how far its teeth are off since the assembly, m.
    fn mesh_errors(&self, state: &SpaceState) -> Result<Vec<(&str, f64)>, SubjectError> {
        /// Steps from the assembly to a state within which no wheel turns by half a revolution: rad, or parts of the size.
        const MESH_STEP: f64 = 0.4;
        let is_gear = |kind: JointKind| matches!(kind, JointKind::Gear { .. });
        let joints = self.case.mechanism.joints.iter();
        let gears = joints.filter(|j| is_gear(j.kind));
        let mut errors: Vec<(&str, f64)> = gears.clone().map(|j| (j.name.as_str(), 0.0)).collect();
        if errors.is_empty() {
            return Ok(errors);
        }
        let mut before = self.case.start.1.to_vec();
        for (part, q) in self.case.positions_towards(&state.q, MESH_STEP) {
            // The last is the state itself, which may have been claimed otherwise.
            let after = match part < 1.0 {
                true => self.subject.placements(&q)?,
                false => state.placements.clone(),
            };
            for ((_, sum), joint) in errors.iter_mut().zip(gears.clone()) {
                *sum += mesh_error(joint, [&before, &after]).unwrap_or(0.0);
            }
            before = after;
        }
        Ok(errors)
    }

    /// Velocities and accelerations of all bodies.
    fn motions(&self) -> [Finding; 2] {
        let size = self.case.size;
        let [mut first, mut second] = [(); 2].map(|()| ComparisonSet::with_individual_scales());
        for (state, _, dense) in self.solved() {
            let largest = |of: fn(&BodyMotion) -> [Vec3; 2]| {
                let all = dense.motions.iter().map(|m| of(m).map(Vec3::norm));
                all.fold(0.0_f64, |max, [v, w]| max.max(v).max(w * size))
            };
            let velocity = |m: &BodyMotion| [m.velocity, m.angular_velocity];
            let acceleration = |m: &BodyMotion| [m.acceleration, m.angular_acceleration];
            let speed = largest(velocity);
            let scale = largest(acceleration).max(speed * speed / size);
            let both = state.claimed.motions.iter().zip(&dense.motions);
            for (body, (claimed, dense)) in both.enumerate() {
                let name = &self.case.mechanism.bodies[body].name;
                let add = |set: &mut ComparisonSet, of: fn(&BodyMotion) -> [Vec3; 2], scale| {
                    let ([v, w], [v0, w0]) = (of(claimed), of(dense));
                    for error in [(v - v0).norm(), (w - w0).norm() * size] {
                        state.compare(set, [error, scale], "m/s", name);
                    }
                };
                add(&mut first, velocity, speed);
                add(&mut second, acceleration, scale);
            }
        }
        [
            self.finding(&VELOCITIES, first, None),
            self.finding(&ACCELERATIONS, second, None),
        ]
    }

    fn inertias(&self) -> [Finding; 2] {
        let [mut matrix, mut kinetic] = [(); 2].map(|()| ComparisonSet::with_individual_scales());
        for (state, ClosedPose { unit, .. }, _) in self.solved() {
            let claimed = state.claimed;
            let n = claimed.q_dot.len();
            let dense = |i: usize, j: usize| state.product([&unit[i], &unit[j]]);
            let mut doubled = 0.0;
            for (k, found) in claimed.inertias.iter().enumerate() {
                let (i, j) = (k / n, k % n);
                let scale = (dense(i, i) * dense(j, j)).sqrt();
                let [one, two] = [i, j].map(|k| &self.case.mechanism.actuators[k].name);
                let what = format!("{one} {two}");
                state.compare(&mut matrix, [found - dense(i, j), scale], "kg m2", &what);
                doubled += claimed.q_dot[i] * found * claimed.q_dot[j];
            }
            let energy = state.product([&claimed.motions; 2]);
            let numbers = [0.5 * (doubled - energy), 0.5 * energy.abs()];
            state.compare(&mut kinetic, numbers, "J", "all bodies");
        }
        [
            self.finding(&INERTIAS, matrix, None),
            self.finding(&KINETIC, kinetic, None),
        ]
    }

    fn reactions(&self) -> Finding {
        let mut set = ComparisonSet::with_individual_scales();
        let mechanism = self.case.mechanism;
        for (state, _, dense) in self.solved() {
            let claimed = state.claimed;
            let scale = state.largest_force();
            for (j, (found, wanted)) in claimed.reactions.iter().zip(&dense.reactions).enumerate() {
                let difference = Wrench {
                    force: found.force - wanted.force,
                    moment: (found.moment - wanted.moment).scaled(1.0 / self.case.size),
                };
                let parts = parts(&difference).into_iter().zip(dense.determined[j]);
                for (part, _) in parts.filter(|(_, is)| *is) {
                    state.compare(&mut set, [part, scale], "N", &mechanism.joints[j].name);
                }
            }
            for (k, actuator) in mechanism.actuators.iter().enumerate() {
                let arm = 1.0 / self.case.lever(k);
                let error = (claimed.tau[k] - dense.actuator_actions[k]) * arm;
                state.compare(&mut set, [error, scale], "N", &actuator.name);
            }
        }
        self.finding(&REACTIONS, set, None)
    }
}

/// ⟨u, v⟩ of two motions of all bodies: Σ m u·v + ω_u·I ω_v at the centres.
pub(super) fn product(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    [one, other]: [&[BodyMotion]; 2],
) -> f64 {
    let bodies = case.masses.iter().enumerate();
    let of_body = |(b, mass): (usize, &Mass)| {
        let rotation = &placements[b].rotation;
        let arm = rotation.apply(mass.center);
        let [v, u] = [one, other].map(|motions| motions[b].point_velocity(arm));
        let [w, s] = [one, other].map(|motions| motions[b].angular_velocity);
        let momentum = rotation.apply(mass.angular_momentum(rotation.apply_inverse(s)));
        mass.mass * v.dot(u) + w.dot(momentum)
    };
    bodies.map(of_body).sum()
}
