//! All checks of a case: of its reduced model, its states, its free motion, its period and its rounding errors.

use crate::cases::reference::Reference;
use crate::cases::subject::PlanSubject;
use crate::checked::history::History;
use crate::checked::known_reactions::known_reaction_findings;
use crate::checked::multibody::{self, FreeMotionRun};
use crate::checked::period_check;
use crate::checked::rounding_check::{self, StateRounding};
use crate::checked::states::{self, CheckedStates};
use crate::error::ValidationError;
use crate::written;
use dwell_dynamics::DynamicsError;
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::ReducedModel;
use dwell_scene::{MotionDuration, PlaneScene};
use dwell_study::explain::explain_motion;
use dwell_study::reduce::compute::ReducedCurves;
use dwell_study::{CalibrationResult, PreparedScene, find_value, symbolic_findings};
use dwell_verify::{
    Case, CheckContext, CheckedFreeMotion, CheckedMechanism, CheckedPosition, ErrorCurve,
    FreeMotionCase, Range, check_free_motion, half_dm_curve, reaction_curve, spread,
};
use std::path::Path;

/// Positions at which the reduced model is checked.
const CHECKED_POSITIONS: usize = 24;
/// The most revolutions of a free motion that are checked: it is integrated with twenty tolerances, so a longer motion
/// would take minutes and show no more.
const MAX_REVOLUTIONS: usize = 20;

/// The results of the checks of a case.
pub(crate) struct CaseAnalysis<'a> {
    pub(crate) findings: Vec<Finding>,
    /// The checks without findings, and in a few words why.
    pub(crate) not_applicable: Vec<(Check, &'static str)>,
    pub(crate) states: CheckedStates,
    /// The effect of rounding, by state.
    pub(crate) rounding: Vec<StateRounding>,
    /// The free motion that was compared with the multibody equations.
    pub(crate) free_motion: Option<FreeMotionRun>,
    /// The reduced model, where it describes the whole case.
    pub(crate) reduced: Option<ReducedAnalysis<'a>>,
}

/// The reduced model of a case with one actuator and without loads, drives and prescribed coordinates.
pub(crate) struct ReducedAnalysis<'a> {
    pub(crate) prepared: PreparedScene<'a>,
    pub(crate) curves: ReducedCurves,
    pub(crate) error_curves: Vec<ErrorCurve>,
    pub(crate) motion: Option<CheckedFreeMotion>,
    pub(crate) calibration: Option<CalibrationResult>,
    pub(crate) history: Option<History>,
}

/// Applies every check that applies to a case; `done` is called after each of three steps.
///
/// # Errors
/// [`ValidationError`] when the scene or the reference cannot be used. A failed check is no error.
pub(crate) fn analyse<'a>(
    scene: &'a PlaneScene,
    reference: &Reference,
    program: Option<&Path>,
    done: &(dyn Fn(&str) + Sync),
) -> Result<CaseAnalysis<'a>, ValidationError> {
    let prepared = is_reduced(scene).then(|| PreparedScene::new(scene));
    let prepared = prepared.transpose()?;
    let (findings, reduced) = rayon::join(
        || check_reduced_model(scene, reference).inspect(|_| done("reduced model")),
        || prepared.map(|prepared| ReducedAnalysis::new(prepared, reference)),
    );
    let ((reduced_findings, error_curves), mut reduced) = (findings?, reduced.transpose()?);
    if let Some(reduced) = &mut reduced {
        reduced.error_curves = error_curves;
    }
    let motion = reduced.as_ref().and_then(|reduced| reduced.motion.as_ref());
    done("free motion");
    // The checks of a free motion without loads include its period.
    let (states, (multibody, period)) = rayon::join(
        || states::check(scene, reference),
        || {
            rayon::join(
                || multibody::check_free_motion(scene, reference),
                || match motion {
                    Some(_) => Ok(Ok(Vec::new())),
                    None => period_check::check_case(scene, reference),
                },
            )
        },
    );
    let (states, (free_motion, multibody_findings), period) = (states?, multibody?, period?);
    let rounding = rounding_check::rounding_errors(scene, &states.states)?;
    let mut findings = in_order(
        reduced.is_some(),
        [
            reduced_findings,
            motion.map_or_else(Vec::new, |m| m.findings.clone()),
            rounding_check::finding(&rounding).into_iter().collect(),
            states.findings.clone(),
            multibody_findings,
            period.iter().flatten().cloned().collect(),
        ],
    );
    let written = |path| written::findings(path, &scene.name, scene.source.inner());
    findings.extend(program.into_iter().flat_map(written));
    reference.apply_tolerances(&mut findings)?;
    done("states");
    Ok(CaseAnalysis {
        not_applicable: not_applicable(scene, &findings, period.err()),
        findings,
        states,
        rounding,
        free_motion,
        reduced,
    })
}

/// The findings of the reduced model, the free motion, rounding, states, multibody equations and period in the order of
/// the snapshots.
fn in_order(reduced: bool, mut findings: [Vec<Finding>; 6]) -> Vec<Finding> {
    let order = if reduced {
        [0, 1, 2, 3, 4, 5]
    } else {
        [3, 0, 5, 4, 1, 2]
    };
    order.map(|k| std::mem::take(&mut findings[k])).concat()
}

/// Whether the reduced model describes the whole case: it has no loads, drives and laws.
fn is_reduced(scene: &PlaneScene) -> bool {
    let motion = scene.motion.as_ref();
    scene.mechanism.actuators.len() == 1
        && scene.loads.is_empty()
        && scene.drives.is_empty()
        && motion.is_none_or(|motion| motion.laws.iter().all(Option::is_none))
}

/// The checks without findings, and in a few words why.
fn not_applicable(
    scene: &PlaneScene,
    findings: &[Finding],
    period: Option<&'static str>,
) -> Vec<(Check, &'static str)> {
    let no_closed_form = match scene.mechanism.actuators.len() {
        1 => "no dyads",
        _ => "several degrees of freedom",
    };
    let reasons = [
        (Check::ReleasedConstraint, "indeterminate reactions"),
        (Check::Period, period.unwrap_or("no period")),
        (Check::ReferenceValues, "no values"),
        (Check::ClosedForms, no_closed_form),
    ];
    let has_findings = |check: Check| findings.iter().any(|f| f.check == check);
    let missing = |&(check, _): &(Check, _)| !has_findings(check);
    reasons.into_iter().filter(missing).collect()
}

/// The checks of the reduced model at single positions, on every reaction of every joint. The reduced model does not
/// depend on loads.
fn check_reduced_model(
    scene: &PlaneScene,
    reference: &Reference,
) -> Result<(Vec<Finding>, Vec<ErrorCurve>), ValidationError> {
    if scene.mechanism.actuators.len() != 1 {
        return Ok((Vec::new(), Vec::new()));
    }
    let subject = PlanSubject::new(scene)?;
    // Outside the range that the scene uses, a change point may be near.
    let used = scene.sweep.as_ref().and_then(|sweep| sweep.range);
    let range = match used {
        Some([from, to]) => Range::Limited(from.min(to), from.max(to)),
        None => subject.exact().range(),
    };
    let case = Case {
        mechanism: CheckedMechanism::Plane(&scene.mechanism, states::inertias(scene)),
        range,
        positions: spread(range, CHECKED_POSITIONS),
    };
    let mut findings = dwell_verify::verify_all(&case, &subject, &reference.samples);
    findings.extend(symbolic_findings(scene)?);
    findings.extend(known_reaction_findings(scene, scene, reference));
    let mut curves = Vec::new();
    if let Ok(context) = CheckContext::new(&case, &subject) {
        // Where ½m′ is largest, differences have most to get right.
        let slope = |s: &CheckedPosition| s.reference.half_dm.abs();
        let positions = context.positions.iter();
        if let Some(position) = positions.max_by(|a, b| slope(a).total_cmp(&slope(b))) {
            let requested = scene.requests.reactions.first();
            let reactions = scene.mechanism.reactions();
            let k = requested.and_then(|w| reactions.iter().position(|r| r == w));
            curves.extend(half_dm_curve(&context, position));
            curves.extend(k.and_then(|k| reaction_curve(&context, position, k)));
        }
    }
    Ok((findings, curves))
}

impl<'a> ReducedAnalysis<'a> {
    /// The curves, and the checked free motion, the fitted value and the time history, where the scene has them.
    fn new(prepared: PreparedScene<'a>, reference: &Reference) -> Result<Self, ValidationError> {
        let scene = prepared.scene;
        let mut analysis = Self {
            curves: ReducedCurves::new(&prepared, None)?,
            prepared,
            error_curves: Vec::new(),
            motion: None,
            calibration: None,
            history: None,
        };
        let prepared = &analysis.prepared;
        let (Some(start), Some(motion)) = (prepared.initial_state(), &scene.motion) else {
            return Ok(analysis);
        };
        let plan = prepared.model.model().plan();
        let explain = |e: DynamicsError| explain_motion(scene, plan, &e);
        // At most two periods, or the whole motion where it is given in seconds.
        let duration = match motion.duration {
            MotionDuration::Periods(n) => MotionDuration::Periods(n.min(2.0)),
            duration @ MotionDuration::Seconds(_) => duration,
        };
        let history = History::new(prepared, start, duration).map_err(explain)?;
        let check = |period: f64| {
            let revolutions = match motion.duration {
                MotionDuration::Periods(n) => n,
                MotionDuration::Seconds(d) => d / period,
            };
            let case = FreeMotionCase {
                initial_state: start,
                revolutions: (revolutions.floor() as usize).clamp(1, MAX_REVOLUTIONS),
                reactions: prepared.reaction_units(),
                period: reference.period.map(|p| (p, reference.source.clone())),
            };
            check_free_motion(&prepared.model, &case).map_err(explain)
        };
        analysis.motion = history.period.map(check).transpose()?;
        let calibration = scene.calibration.as_ref();
        let calibrated = calibration.map(|c| find_value(scene, &c.path, c.period));
        analysis.calibration = calibrated.transpose()?;
        analysis.history = Some(history);
        Ok(analysis)
    }
}
