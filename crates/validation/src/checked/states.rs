//! The states in which a case is checked: along its prescribed motion and its sweep, and those of its
//! reference.

use crate::cases::model_states::{ModelStates, StateRequest};
use crate::cases::reference::Reference;
use crate::error::ValidationError;
use dwell_findings::Finding;
use dwell_geometry::Reaction;
use dwell_scene::{PlaneScene, PrescribedMotion};
use dwell_study::models::indeterminate_reactions;
use dwell_verify::{
    AssembledMechanism, CheckedMechanism, ClaimedState, Inertias, Pose, check_states,
};
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// States along each motion, and positions in which it is drawn.
const STATES_PER_MOTION: usize = 121;
const DRAWN_POSES: usize = 721;
/// States that are checked by kinetic energy: each reaction costs some twenty assemblies there.
const ENERGY_CHECKED_STATES: usize = 16;
/// Part of the range that is left out at a limit position, where forces grow without bound.
const MARGIN: f64 = 0.02;

/// The states of a case and their findings.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedStates {
    /// Where all bodies are as assembled.
    pub assembly_poses: Vec<Pose>,
    /// Along the prescribed motion, over the sweep, and those of the reference.
    pub states: Vec<ClaimedState>,
    /// How many of them, from the first, are of the motion that is drawn.
    pub drawn_count: usize,
    /// That motion in words.
    pub motion_text: &'static str,
    /// The frames of all bodies along it, close to each other.
    pub body_poses: Vec<Vec<[f64; 3]>>,
    /// At the same positions: the time (s), and the force of each actuator (N or N m).
    pub actuator_forces: Vec<(f64, Vec<f64>)>,
    /// The requested reactions that are statically indeterminate: claimed, but not a result.
    pub indeterminate: HashSet<Reaction>,
    /// The checks of the states, then of the reference.
    pub findings: Vec<Finding>,
}

impl CheckedStates {
    /// The mechanism of the scene that was checked, as it is assembled.
    pub fn assembled<'a>(&'a self, scene: &'a PlaneScene) -> AssembledMechanism<'a> {
        assembled(scene, &self.assembly_poses)
    }
}

/// Checks the case whose scene is `scene` and whose reference, if any, is in `folder`, in states
/// of motion alone.
///
/// # Errors
/// [`ValidationError`] when the scene or the reference cannot be used, or a state cannot be reached.
pub fn check_case(scene: &PlaneScene, folder: &Path) -> Result<CheckedStates, ValidationError> {
    check(scene, &Reference::read(folder, scene)?)
}

/// Checks the states of a case, then compares them with its reference.
///
/// # Errors
/// [`ValidationError::Study`] when a state cannot be reached.
pub(crate) fn check(
    scene: &PlaneScene,
    reference: &Reference,
) -> Result<CheckedStates, ValidationError> {
    let mut model = ModelStates::new(scene)?;
    let motions = |model: &ModelStates<'_>, count| motions(scene, model, reference, count);
    let motion = match (&scene.prescribed, &scene.sweep) {
        (Some(_), _) => "the prescribed motion",
        (None, Some(_)) => "a cosine motion over the sweep",
        (None, None) => "a cosine motion over the range",
    };
    let requests: Vec<Vec<StateRequest>> = motions(&model, STATES_PER_MOTION).collect();
    let drawn = requests.first().map_or(0, Vec::len);
    let mut states = Vec::new();
    let requests = requests.into_iter().flatten();
    for request in requests.chain(reference.state_requests()) {
        let state = model.state(&request)?;
        let inertias = model.mass_matrix();
        states.push(ClaimedState { inertias, ..state });
    }
    let fine = motions(&model, DRAWN_POSES).next();
    let (mut body_poses, mut actuator_forces) = (Vec::new(), Vec::new());
    for request in fine.into_iter().flatten() {
        let state = model.state(&request)?;
        body_poses.push(model.body_poses());
        actuator_forces.push((state.t, state.tau));
    }
    let start = model.assembly_poses.clone();
    let mut findings = check_states(&assembled(scene, &start), &states, ENERGY_CHECKED_STATES);
    findings.extend(reference.findings(scene, &mut model)?);
    Ok(CheckedStates {
        assembly_poses: start,
        states,
        drawn_count: drawn,
        motion_text: motion,
        body_poses,
        actuator_forces,
        indeterminate: indeterminate_reactions(scene, model.model.plan()),
        findings,
    })
}

/// The states along the prescribed motion and over the sweep, so many of each.
pub(crate) fn motions(
    scene: &PlaneScene,
    model: &ModelStates<'_>,
    reference: &Reference,
    count: usize,
) -> impl Iterator<Item = Vec<StateRequest>> + use<> {
    let prescribed = scene.prescribed.as_ref();
    let along = prescribed.map(|motion| prescribed_states(motion, count));
    let across = match (&along, &scene.sweep) {
        (Some(_), None) => None,
        _ => cosine_sweep(scene, model, reference, count),
    };
    along.into_iter().chain(across)
}

/// Masses and moments of inertia as the independent checks need them.
pub(crate) fn inertias(scene: &PlaneScene) -> Inertias<'_> {
    Inertias {
        masses: &scene.masses,
        varying: &scene.varying_inertias,
    }
}

/// A mechanism as it is assembled, with its bodies in these poses.
pub(crate) fn assembled<'a>(scene: &'a PlaneScene, poses: &'a [Pose]) -> AssembledMechanism<'a> {
    AssembledMechanism {
        mechanism: CheckedMechanism::Plane(&scene.mechanism, inertias(scene)),
        q: &scene.assembly.coordinates,
        poses,
    }
}

/// The prescribed motion.
fn prescribed_states(motion: &PrescribedMotion, count: usize) -> Vec<StateRequest> {
    let at = |k: usize| {
        let t = motion.duration * k as f64 / (count - 1) as f64;
        let of = |derivative: usize| motion.laws.iter().map(|l| l.eval(t)[derivative]).collect();
        StateRequest {
            t,
            q: of(0),
            q_dot: of(1),
            q_ddot: Some(of(2)),
        }
    };
    (0..count).map(at).collect()
}

/// One actuator from end to end of the sweep, or else of the range, as a cosine: rest, speed and
/// acceleration all occur. None where several actuators have no sweep.
fn cosine_sweep(
    scene: &PlaneScene,
    model: &ModelStates<'_>,
    reference: &Reference,
    count: usize,
) -> Option<Vec<StateRequest>> {
    let plan = model.model.plan();
    let (actuator, given, fixed) = match &scene.sweep {
        Some(sweep) => (sweep.actuator.0, sweep.range, &sweep.fixed_coordinates),
        None if plan.actuators() == 1 => (0, None, &scene.assembly.coordinates),
        None => return None,
    };
    let [from, to] = given.unwrap_or_else(|| match plan.range().limits() {
        Some((from, to)) => {
            let margin = MARGIN * (to - from);
            [from + margin, to - margin]
        }
        None => [fixed[actuator], fixed[actuator] + TAU],
    });
    let speed = match (&scene.sweep, &scene.motion) {
        (Some(sweep), _) => sweep.speed,
        (None, Some(motion)) if motion.initial_velocities[actuator] != 0.0 => {
            motion.initial_velocities[actuator].abs()
        }
        _ => reference.max_velocity().unwrap_or(1.0),
    };
    let half = 0.5 * (to - from);
    let rate = speed / half;
    let at = |k: usize| {
        let phase = PI * k as f64 / (count - 1) as f64;
        let (y, x) = phase.sin_cos();
        let of = |value: f64| {
            let mut all = vec![0.0; fixed.len()];
            all[actuator] = value;
            all
        };
        let mut q = fixed.clone();
        q[actuator] = from + half * (1.0 - x);
        StateRequest {
            t: phase / rate,
            q,
            q_dot: of(half * rate * y),
            q_ddot: Some(of(half * rate * rate * x)),
        }
    };
    Some((0..count).map(at).collect())
}
