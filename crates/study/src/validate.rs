//! `dwell validate`: a case from its folder to its report: everything computed, everything checked.

use crate::calibrate::{Calibrated, find_value};
use crate::dossier::{document, numbers, snapshot, summary, tables};
use crate::error::StudyError;
use crate::figures::{self, Dwell};
use crate::history::History;
use crate::motion_error::explain_motion;
use crate::multibody;
use crate::outcome::{Outcome, Progress, Step};
use crate::page;
use crate::period;
use crate::prepare::Prepared;
use crate::provenance::picture;
use crate::reduce::Sweep;
use crate::reference::Reference;
use crate::rounding::{self, Rounding};
use crate::simulate::Accuracy;
use crate::states;
use crate::subject::PlanSubject;
use crate::symbolic::symbolic_findings;
use dwell_findings::Finding;
use dwell_kinetostatics::Reduced;
use dwell_report::{Figure, Files};
use dwell_scene::{Length, Scene};
use dwell_verify::{
    Bench, Case, ErrorCurve, FreeMotion, FreeMotionCase, Range, free_motion, half_dm_curve,
    reaction_curve, spread,
};
use rayon::prelude::*;
use std::path::Path;

/// Positions at which every truth is held against the model.
const POSITIONS: usize = 24;
/// Most turns that are judged: twenty tolerances are followed over all of them, so a long motion would
/// take minutes and show no more.
const MOST_TURNS: usize = 20;
/// Steps of the progress bar for one case.
pub(crate) const STEPS: usize = 5;

/// A validated case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Validation {
    /// Words, files and findings.
    pub outcome: Outcome,
    /// The rounded text that every machine reproduces.
    pub snapshot: String,
    /// Truths by number that say nothing of the case, and in a few words why.
    pub silent: Vec<(usize, &'static str)>,
}

/// Why some truths have no findings, where it is not said elsewhere.
pub(crate) fn silent(
    scene: &Scene,
    findings: &[Finding],
    period: Option<&'static str>,
) -> Vec<(usize, &'static str)> {
    let closed = match scene.mechanism.actuators.len() {
        1 => "no dyads",
        _ => "several freedoms",
    };
    let known = [
        (3, "reactions shared"),
        (5, period.unwrap_or("no period")),
        (9, "no values"),
        (11, closed),
    ];
    let spoken = |number: usize| findings.iter().any(|f| f.number() == Some(number));
    known
        .into_iter()
        .filter(|&(number, _)| !spoken(number))
        .collect()
}

/// What the checks of a case yield.
pub(crate) struct Evidence {
    pub(crate) findings: Vec<Finding>,
    pub(crate) curves: Vec<ErrorCurve>,
    pub(crate) motion: Option<FreeMotion>,
    pub(crate) calibrated: Option<Calibrated>,
    pub(crate) history: Option<History>,
    pub(crate) dwell: Option<Dwell>,
    pub(crate) sweep: Sweep,
}

/// Validates the case whose scene is `scene` and whose reference, if any, is in `folder`. The
/// files are `NAME.md`, `NAME.json`, `NAME.txt` and the folder `NAME/` with pictures and tables.
///
/// # Errors
/// [`StudyError`] when the scene or the reference cannot be used. A failed check is no error.
pub fn validate(
    scene: &Scene,
    folder: &Path,
    progress: Progress<'_>,
) -> Result<Validation, StudyError> {
    let reference = Reference::read(folder, scene)?;
    // The reduced model knows nothing of loads, drives and laws.
    let led = |motion: &dwell_scene::Motion| motion.laws.iter().any(Option::is_some);
    let moved = !scene.loads.is_empty() || !scene.drives.is_empty();
    if scene.mechanism.actuators.len() != 1 || moved || scene.motion.as_ref().is_some_and(led) {
        return page::of_states(scene, &reference, progress);
    }
    let prepared = Prepared::new(scene)?;
    let done = |what: &str| {
        progress(Step {
            total: STEPS,
            done: what,
        });
    };
    let (judged, rest) = rayon::join(
        || reduced(scene, &reference).inspect(|_| done("truths")),
        || rest(&prepared, &reference).inspect(|_| done("free motion")),
    );
    let ((mut findings, curves), (motion, calibrated, history)) = (judged?, rest?);
    if let Some(motion) = &motion {
        findings.extend(motion.findings.clone());
    }
    let (judged, (followed, timed)) = rayon::join(
        || states::judge(scene, &reference),
        || {
            rayon::join(
                || multibody::judged(scene, &reference),
                // A motion of the scene's own without loads has been timed already.
                || match &motion {
                    Some(_) => Ok(Ok(Vec::new())),
                    None => period::of_case(scene, &reference),
                },
            )
        },
    );
    let judged = judged?;
    let rounding = Rounding::new(scene, &judged.states)?;
    findings.extend(rounding::finding(&rounding));
    findings.extend(judged.findings.iter().cloned());
    done("states");
    findings.extend(followed?.1);
    let timed = timed?;
    findings.extend(timed.iter().flatten().cloned());
    reference.judge(&mut findings)?;
    let (drawing, dwell) = figures::mechanism(&prepared)?;
    let evidence = Evidence {
        findings,
        curves,
        motion,
        calibrated,
        history,
        dwell,
        sweep: Sweep::new(&prepared)?,
    };
    let mut pages = pages(&prepared, drawing, &evidence);
    pages.push(figures::rounding(scene, &judged, &rounding));
    let draw = |page| picture(scene, page);
    let pictures: Vec<Vec<u8>> = pages.par_iter().map(draw).collect::<Result<_, _>>()?;
    done("pictures");
    let mut files = Files::new();
    let name = &scene.name;
    for (page, picture) in pages.iter().zip(pictures) {
        files.add(format!("{name}/{}.png", page.name), picture);
    }
    for (file, table) in tables(&prepared, &evidence) {
        files.add(format!("{name}/{file}.csv"), table.csv()?);
    }
    let snapshot = snapshot(&prepared, &evidence);
    let silent = silent(scene, &evidence.findings, timed.err());
    files.add(format!("{name}.txt"), snapshot.clone());
    files.add(format!("{name}.json"), numbers(scene, &evidence)?);
    let document = document(&prepared, &reference, &pages, &evidence);
    files.add(format!("{name}.md"), document.markdown());
    done("report");
    Ok(Validation {
        outcome: Outcome {
            summary: summary(scene, &evidence),
            files,
            findings: evidence.findings,
        },
        snapshot,
        silent,
    })
}

/// The truths of the reduced model, which need no motion, on every reaction of every joint.
pub(crate) fn reduced(
    scene: &Scene,
    reference: &Reference,
) -> Result<(Vec<Finding>, Vec<ErrorCurve>), StudyError> {
    let subject = PlanSubject::new(scene)?;
    // The scene says where the mechanism is used; outside, a change point may be near.
    let used = scene.sweep.as_ref().and_then(|sweep| sweep.range);
    let range = match used {
        Some([from, to]) => Range::Between(from.min(to), from.max(to)),
        None => subject.exact().range(),
    };
    let case = Case {
        mechanism: &scene.mechanism,
        masses: &scene.masses,
        range,
        positions: spread(range, POSITIONS),
    };
    let mut findings = dwell_verify::verify_all(&case, &subject, &reference.samples);
    findings.extend(symbolic_findings(scene)?);
    let mut curves = Vec::new();
    if let Ok(bench) = Bench::new(&case, &subject) {
        // Where ½m′ is largest, differences have most to get right.
        let steepest = |s: &&dwell_verify::Site| s.exact.half_dm.abs();
        let site = bench
            .sites
            .iter()
            .max_by(|a, b| steepest(a).total_cmp(&steepest(b)));
        if let Some(site) = site {
            let wanted = scene.requests.reactions.first();
            let k = wanted.and_then(|w| bench.reactions.iter().position(|r| r == w));
            curves.extend(half_dm_curve(&bench, site));
            curves.extend(k.and_then(|k| reaction_curve(&bench, site, k)));
        }
    }
    Ok((findings, curves))
}

type Rest = (Option<FreeMotion>, Option<Calibrated>, Option<History>);

/// The motion, the fitted number and the time history, where the scene has them.
fn rest(prepared: &Prepared<'_>, reference: &Reference) -> Result<Rest, StudyError> {
    let scene = prepared.scene;
    let (Some(start), Some(motion)) = (prepared.start(), &scene.motion) else {
        return Ok((None, None, None));
    };
    let plan = prepared.model.model().plan();
    let history = History::new(
        prepared,
        start,
        two_turns(motion.length),
        &Accuracy::default(),
    )?;
    let judged = match (history.period, motion.length) {
        (None, _) => None,
        (Some(period), length) => {
            let turns = match length {
                Length::Periods(n) => n,
                Length::Duration(d) => d / period,
            };
            let case = FreeMotionCase {
                start,
                turns: (turns.floor() as usize).clamp(1, MOST_TURNS),
                reactions: prepared.reactions(),
                period: reference.period.map(|p| (p, reference.source.clone())),
            };
            let judged = free_motion(&prepared.model, &case);
            Some(judged.map_err(|e| explain_motion(scene, plan, &e))?)
        }
    };
    let wanted = scene.calibration.as_ref();
    let calibrated = wanted
        .map(|c| find_value(scene, &c.path, c.period))
        .transpose()?;
    Ok((judged, calibrated, Some(history)))
}

/// What the time history shows: two turns of a periodic motion, all of another.
fn two_turns(length: Length) -> Length {
    match length {
        Length::Periods(n) => Length::Periods(n.min(2.0)),
        duration @ Length::Duration(_) => duration,
    }
}

fn pages(prepared: &Prepared<'_>, drawing: Figure, evidence: &Evidence) -> Vec<Figure> {
    let mut pages = vec![drawing, figures::reduced(prepared, &evidence.sweep)];
    // What is left out, the caption of the last one says.
    pages.extend(figures::coefficients(prepared, &evidence.sweep).0);
    if let Some(history) = &evidence.history {
        pages.push(figures::history(prepared, history, &Accuracy::default()));
    }
    if let Some(motion) = &evidence.motion {
        pages.push(figures::drift(prepared, motion));
    }
    if !evidence.curves.is_empty() {
        pages.push(figures::steps(prepared, &evidence.curves));
    }
    if let Some(motion) = &evidence.motion {
        pages.push(figures::cost(prepared, motion));
    }
    pages.push(figures::digits(prepared.scene, &evidence.findings));
    pages
}
