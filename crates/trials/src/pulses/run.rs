//! The runs of a pulse: every method at a tolerance, and every required accuracy, each as a user starts it.

use super::by_hand::{reference, restarted};
use super::pulse::PulseShape;
use super::subject::{INERTIA, PulseSubject, PulsedMotion};
use crate::draws::Draws;
use dwell_dynamics::Method;
use dwell_scene::PlaneScene;
use dwell_study::{MotionSolver, SolverSettings, compute_free_motion, no_progress};
use dwell_validation::extremes::column;
use rayon::prelude::*;

/// The accuracies that are required: the presets, but for the last, which few machines reach.
pub(super) const ACCURACIES: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Rows of a motion.
const ROWS: f64 = 40.0;

/// A pulse with all its runs.
#[derive(Debug, Clone, PartialEq)]
pub struct PulseResult {
    /// Its number among those of the seed.
    pub number: usize,
    /// What it acts on.
    pub subject: PulseSubject,
    /// Its shape.
    pub shape: PulseShape,
    /// Its width over the duration of the motion.
    pub relative_width: f64,
    /// The duration of the motion, s.
    pub span: f64,
    /// The speed at the start, rad/s or m/s.
    pub speed: f64,
    /// The runs, by method and by accuracy.
    pub runs: Vec<PulseRun>,
}

/// How a run is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RunKind {
    /// By a method at a tolerance.
    Fixed(Method, f64),
    /// To a required accuracy.
    Accuracy(f64),
}

/// A run of a pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct PulseRun {
    /// How it is integrated.
    pub kind: RunKind,
    /// Why it was refused or ended early, if it was.
    pub refused: Option<String>,
    /// The error of the coordinate at the end: rad, or relative to the largest change of a length.
    pub error: f64,
    /// The error of the speed over what the pulse changes it by: 1 where the pulse is missed.
    pub missed: f64,
    /// Of a fixed method, where the pulse has switches: the same error where it is restarted there by hand.
    pub error_by_hand: Option<f64>,
    /// Of a required accuracy: the estimated error.
    pub estimate: f64,
    /// The error that the reference and the rounding of time allow.
    pub rounding: f64,
    /// What an error of 1 in the speed comes to in `error` by the end.
    pub speed_effect: f64,
}

/// The runs of some pulses of a seed.
pub fn evaluate(count: usize, seed: u64) -> Vec<PulseResult> {
    (0..count)
        .into_par_iter()
        .map(|number| pulse_result(seed, number))
        .collect()
}

/// What a run must come to.
struct Expected {
    end: [f64; 2],
    end_error: [f64; 2],
    /// The change of the speed by the pulse.
    gained: f64,
    /// What an error of the coordinate is relative to.
    scale: f64,
    rounding: f64,
}

fn pulse_result(seed: u64, number: usize) -> PulseResult {
    let mut draws = Draws::new(seed, number);
    let motion = PulsedMotion::draw(&mut draws);
    let tolerance = 10_f64.powi(-4 - draws.below(6) as i32);
    // Of low order: with a finer tolerance they take a million steps.
    let kinds = Method::ALL.map(|method| match method {
        Method::TrBdf2 => RunKind::Fixed(method, tolerance.max(1e-6)),
        Method::Esdirk34 => RunKind::Fixed(method, tolerance.max(1e-8)),
        Method::Bdf | Method::Tsit45 | Method::Dop853 => RunKind::Fixed(method, tolerance),
    });
    let accuracies = ACCURACIES.map(RunKind::Accuracy);
    let kinds = kinds.into_iter().chain(accuracies);
    let expected = expected(&motion);
    let runs = kinds.map(|kind| match &expected {
        Ok(expected) => pulse_run(&motion, kind, expected),
        Err(error) => failed_run(kind, format!("no reference: {error}")),
    });
    let pulse = motion.pulse;
    PulseResult {
        number,
        subject: motion.subject,
        shape: pulse.shape,
        relative_width: pulse.width / pulse.span,
        span: pulse.span,
        speed: motion.speed,
        runs: runs.collect(),
    }
}

fn expected(motion: &PulsedMotion) -> Result<Expected, String> {
    let (end, end_error) = reference(motion)?;
    let pulse = motion.pulse;
    let [area, _] = pulse.impulse();
    let scale = match motion.subject {
        PulseSubject::Slider => end[0].abs(),
        PulseSubject::Wheel | PulseSubject::Pendulum => 1.0,
    };
    // The ends of a pulse are rounded as the time is, and so is its area; the phase of a periodic one by its argument.
    let narrow = 16.0 * f64::EPSILON * pulse.span / pulse.width;
    let rounding = (narrow + 64.0 * f64::EPSILON) * end[0].abs().max(area / INERTIA * pulse.span);
    Ok(Expected {
        end,
        end_error,
        gained: area / INERTIA,
        scale,
        rounding: rounding + end_error[0],
    })
}

fn failed_run(kind: RunKind, reason: String) -> PulseRun {
    let nan = f64::NAN;
    let (refused, rounding) = (Some(reason), nan);
    PulseRun {
        kind,
        refused,
        error: nan,
        missed: nan,
        error_by_hand: Some(nan),
        estimate: nan,
        rounding,
        speed_effect: nan,
    }
}

fn pulse_run(motion: &PulsedMotion, kind: RunKind, expected: &Expected) -> PulseRun {
    let (end, estimate, refused) = match run(motion, kind) {
        Ok(found) => found,
        Err(reason) => return failed_run(kind, reason),
    };
    let difference = |end: [f64; 2]| (end[0] - expected.end[0]).abs() / expected.scale;
    let error_by_hand = match kind {
        RunKind::Fixed(method, tolerance) if motion.pulse.shape.has_switches() => {
            Some(restarted(motion, method, tolerance).map_or(f64::NAN, difference))
        }
        RunKind::Fixed(..) | RunKind::Accuracy(_) => None,
    };
    PulseRun {
        kind,
        refused,
        error: difference(end),
        missed: ((end[1] - expected.end[1]).abs() - expected.end_error[1]) / expected.gained,
        error_by_hand,
        estimate,
        rounding: expected.rounding / expected.scale,
        speed_effect: match motion.subject {
            PulseSubject::Wheel | PulseSubject::Slider => motion.pulse.span / expected.scale,
            // It swings back.
            PulseSubject::Pendulum => 1.0,
        },
    }
}

/// Coordinate and speed at the end as a user gets them, the estimated error, and why they are no result.
type UserResult = ([f64; 2], f64, Option<String>);

fn run(motion: &PulsedMotion, kind: RunKind) -> Result<UserResult, String> {
    let sample_interval = Some(motion.pulse.span / ROWS);
    let solver = match kind {
        RunKind::Accuracy(accuracy) => MotionSolver::Accuracy {
            accuracy,
            sample_interval,
        },
        RunKind::Fixed(method, tolerance) => MotionSolver::Settings(SolverSettings {
            method,
            rtol: tolerance,
            atol: tolerance,
            max_step: None,
            sample_interval,
        }),
    };
    let text = motion.scene(&motion.pulse.expression());
    let scene = PlaneScene::parse("pulse.toml", &text).map_err(|e| e.to_string())?;
    let found = compute_free_motion(&scene, &solver, &no_progress).map_err(|e| e.to_string())?;
    let last = |name: &str| {
        let all = column(&found.computed.table, name)?;
        all.last().copied().ok_or("no rows".to_owned())
    };
    let end = [last("q")?, last("q.velocity")?];
    let refused = found.computed.early_stop.map(|reason| reason.to_string());
    let estimate = found.estimated_error.unwrap_or(f64::NAN);
    Ok((end, estimate, refused))
}
