//! Claimed states of a mechanism in space, with any number of actuators, under loads.

use super::branch::check_mesh;
use super::forces::load_wrenches;
use crate::dense::DenseMechanism;
use crate::error::Result;
use crate::pose::{Pose, Twist};
use crate::state::{Claim, POSES, StateChecker, not_dense};
use dwell_findings::Finding;
use dwell_geometry::space::{BodyMotion, IdleBody, Mechanism, Placement, Wrench};
use dwell_kinetostatics::space::{LoadKind, Mass};

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
    /// The mechanism in dense rows, as it is assembled.
    ///
    /// # Errors
    /// [`DenseError`](crate::DenseError) where the rows do not determine the pose.
    pub(super) fn dense(&self) -> Result<DenseMechanism> {
        let dense = DenseMechanism::in_space(self.mechanism, self.masses, self.idle)?;
        let start = dense.moved_frames(&poses(self.start.1))?;
        dense.assembled(&start)
    }

    fn claim(&self, state: &SpaceState) -> Claim {
        let numbers =
            |of: &[f64]| -> Vec<String> { of.iter().map(|q| format!("{q:.4}")).collect() };
        let rates = |of: fn(&BodyMotion) -> Twist| state.motions.iter().map(of).collect();
        let bodies = (self.mechanism, self.masses, &state.placements[..]);
        let wrenches = load_wrenches(bodies, &state.motions, &state.loads);
        Claim {
            name: format!("q = {}", numbers(&state.q).join(" ")),
            q: state.q.clone(),
            q_dot: state.q_dot.clone(),
            q_ddot: state.q_ddot.clone(),
            poses: poses(&state.placements),
            velocities: rates(|m| Twist {
                linear: m.velocity,
                angular: m.angular_velocity,
            }),
            accelerations: rates(|m| Twist {
                linear: m.acceleration,
                angular: m.angular_acceleration,
            }),
            reactions: state.reactions.iter().flat_map(super::parts).collect(),
            tau: state.tau.clone(),
            load_wrenches: wrenches,
            load_power: Some(state.load_power),
        }
    }
}

/// The tolerance of forces on each body with the claimed accelerations: the largest seen in a case is 7.8e-16.
const NEWTON_EULER: f64 = 7e-14;

/// Poses of bodies in space.
pub(super) fn poses(placements: &[Placement]) -> Vec<Pose> {
    placements
        .iter()
        .map(|placement| (*placement).into())
        .collect()
}

/// Checks claimed states of one mechanism, each by itself, as [`check_states`](crate::check_states) and
/// [`check_energies`](crate::check_energies) do in the plane; at most so many of them by kinetic energy.
///
/// Reactions that redundant constraints leave open must balance, whatever they are. The findings come in a fixed order.
pub fn check_states_in_space(
    case: &SpaceCase<'_>,
    states: &[SpaceState],
    by_energies: usize,
) -> Vec<Finding> {
    let dense = match case.dense() {
        Ok(dense) => dense,
        Err(error) => return vec![not_dense(&POSES, &error)],
    };
    let claims: Vec<Claim> = states.iter().map(|state| case.claim(state)).collect();
    let checker = StateChecker::new(&dense, &claims);
    let mut findings = checker.findings();
    let matrices: Vec<_> = states.iter().map(|state| state.inertias.clone()).collect();
    findings.push(checker.energy_rates(&matrices));
    if dense.rows.has_teeth_in_space() {
        findings.push(check_mesh(case, states));
    }
    for finding in &mut findings {
        if finding.key == "state-newton-euler" && finding.tolerance > NEWTON_EULER {
            finding.set_tolerance(NEWTON_EULER, "a sum of rounded terms");
        }
    }
    let some = by_energies.min(states.len());
    let sampled = (0..some).map(|k| (2 * k + 1) * states.len() / (2 * some));
    let sampled = sampled.map(|k| (claims[k].clone(), matrices[k].clone()));
    let (sampled, matrices): (Vec<_>, Vec<_>) = sampled.unzip();
    findings.extend(StateChecker::new(&dense, &sampled).by_energies(&matrices));
    findings
}
