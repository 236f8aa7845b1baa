//! The states in which a case is judged: along its prescribed motion and its sweep, and those of its
//! reference.

use crate::claims::{Ask, Claims};
use crate::error::StudyError;
use crate::prepare::shared;
use crate::reference::Reference;
use dwell_findings::Finding;
use dwell_geometry::Reaction;
use dwell_scene::{Prescribed, Scene};
use dwell_verify::{State, judge_energies, judge_states};
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// States along each motion, and positions in which it is drawn.
const STATES: usize = 121;
const FINE: usize = 721;
/// States that are judged by kinetic energy, where each reaction costs some twenty closings.
const OPENED: usize = 16;
/// What is left out at a limit position, where everything grows, as a part of the range.
const MARGIN: f64 = 0.02;

/// The states of a case, and what was found about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The frames of all bodies as assembled: x, y (m) and angle (rad).
    pub start: Vec<[f64; 3]>,
    /// Along the prescribed motion, over the sweep, and those of the reference.
    pub states: Vec<State>,
    /// How many of them, from the first, are of the motion that is drawn.
    pub drawn: usize,
    /// What that motion is, in words.
    pub motion: &'static str,
    /// The frames of all bodies along it, close to each other.
    pub frames: Vec<Vec<[f64; 3]>>,
    /// The requested reactions that the loads do not determine: claimed, but no result.
    pub shared: HashSet<Reaction>,
    /// The truths of states, then the reference.
    pub findings: Vec<Finding>,
}

/// Judges the case whose scene is `scene` and whose reference, if any, is in `folder`, in states
/// of motion alone.
///
/// # Errors
/// [`StudyError`] when the scene or the reference cannot be used, or a state cannot be reached.
pub fn judge_case(scene: &Scene, folder: &Path) -> Result<Judged, StudyError> {
    judge(scene, &Reference::read(folder, scene)?)
}

/// Judges the states of a case, then its reference.
///
/// # Errors
/// [`StudyError::Scene`] when a state cannot be reached.
pub(crate) fn judge(scene: &Scene, reference: &Reference) -> Result<Judged, StudyError> {
    let mut claims = Claims::new(scene)?;
    let motions = |claims: &Claims<'_>, count: usize| {
        let along = scene.prescribed.as_ref().map(|p| prescribed(p, count));
        let across = match (&along, &scene.sweep) {
            (Some(_), None) => None,
            _ => swing(scene, claims, reference, count),
        };
        along.into_iter().chain(across)
    };
    let motion = match (&scene.prescribed, &scene.sweep) {
        (Some(_), _) => "the prescribed motion",
        (None, Some(_)) => "a swing over the sweep",
        (None, None) => "a swing over the range",
    };
    let asked: Vec<Vec<Ask>> = motions(&claims, STATES).collect();
    let drawn = asked.first().map_or(0, Vec::len);
    let (mut states, mut inertias) = (Vec::new(), Vec::new());
    for ask in asked.into_iter().flatten().chain(reference.asks()) {
        states.push(claims.state(&ask)?);
        inertias.push(claims.inertias());
    }
    let fine = motions(&claims, FINE).next();
    let mut frames = Vec::with_capacity(FINE);
    for ask in fine.into_iter().flatten() {
        frames.push(claims.frames_at(&ask.q)?);
    }
    let start = claims.start().to_vec();
    let (mechanism, masses) = (&scene.mechanism, &scene.masses);
    let (some, of_some): (Vec<_>, Vec<_>) = opened(states.len())
        .map(|k| (states[k].clone(), inertias[k].clone()))
        .unzip();
    let (mut findings, of_energy) = rayon::join(
        || judge_states(mechanism, masses, &start, &states),
        || judge_energies(mechanism, masses, &start, &some, &of_some),
    );
    findings.extend(of_energy);
    findings.extend(reference.findings(scene, &mut claims)?);
    Ok(Judged {
        start,
        states,
        drawn,
        motion,
        frames,
        shared: shared(scene, claims.model().plan()),
        findings,
    })
}

/// Which of so many states are opened: spread evenly, between round places.
fn opened(count: usize) -> impl Iterator<Item = usize> {
    let some = count.min(OPENED);
    (0..some).map(move |k| (2 * k + 1) * count / (2 * some))
}

/// The prescribed motion.
fn prescribed(motion: &Prescribed, count: usize) -> Vec<Ask> {
    let at = |k: usize| {
        let t = motion.duration * k as f64 / (count - 1) as f64;
        let of = |derivative: usize| motion.laws.iter().map(|l| l.at(t)[derivative]).collect();
        Ask {
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
fn swing(
    scene: &Scene,
    claims: &Claims<'_>,
    reference: &Reference,
    count: usize,
) -> Option<Vec<Ask>> {
    let plan = claims.model().plan();
    let (actuator, given, held) = match &scene.sweep {
        Some(sweep) => (sweep.actuator.0, sweep.range, sweep.held.clone()),
        None if plan.actuators() == 1 => (0, None, scene.assembly.start.clone()),
        None => return None,
    };
    let [from, to] = given.unwrap_or_else(|| match plan.range().limits() {
        Some((from, to)) => {
            let margin = MARGIN * (to - from);
            [from + margin, to - margin]
        }
        None => [held[actuator], held[actuator] + TAU],
    });
    let speed = match (&scene.sweep, &scene.motion) {
        (Some(sweep), _) => sweep.speed,
        (None, Some(motion)) if motion.speed[actuator] != 0.0 => motion.speed[actuator].abs(),
        _ => reference.fastest().unwrap_or(1.0),
    };
    let half = 0.5 * (to - from);
    let rate = speed / half;
    let at = |k: usize| {
        let phase = PI * k as f64 / (count - 1) as f64;
        let (y, x) = phase.sin_cos();
        let of = |value: f64| {
            let mut all = vec![0.0; held.len()];
            all[actuator] = value;
            all
        };
        let mut q = held.clone();
        q[actuator] = from + half * (1.0 - x);
        Ask {
            t: phase / rate,
            q,
            q_dot: of(half * rate * y),
            q_ddot: Some(of(half * rate * rate * x)),
        }
    };
    Some((0..count).map(at).collect())
}
