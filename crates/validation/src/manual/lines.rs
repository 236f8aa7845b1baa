//! The lines of the manual, one for each capability.

use super::REQUIRED;
use super::capabilities::{CAPABILITIES, CommandRequirement, Interface};
use super::committed_mutations::CommittedMutation;
use super::key_faults::PlantedFault;
use crate::report_parts::nearest;
use dwell_findings::{Check, Finding};
use dwell_scene::SceneKey;
use std::collections::BTreeSet;

/// Maximum number of faults listed with a command.
const MAX_LISTED: usize = 4;

/// The verdict on a capability.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) enum LineState {
    #[default]
    Pass,
    /// It fails, with the reason.
    Fail(String),
    /// Nothing is required, with the reason.
    Exempt(&'static str),
}

/// A capability.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Line {
    pub(super) section: String,
    pub(super) item: String,
    pub(super) meaning: String,
    /// Names of cases.
    pub(super) cases: Vec<String>,
    /// The finding of its checks that is nearest to its tolerance.
    pub(super) nearest: Option<Finding>,
    pub(super) checks: BTreeSet<Check>,
    pub(super) mutations: Vec<String>,
    pub(super) state: LineState,
}

impl Line {
    /// The reason if it fails.
    pub(super) fn failure(&self) -> Option<&str> {
        match &self.state {
            LineState::Fail(why) => Some(why),
            LineState::Pass | LineState::Exempt(_) => None,
        }
    }
}

/// A case with its findings.
pub(super) struct CaseFindings<'a> {
    pub(super) name: &'a str,
    pub(super) findings: &'a [Finding],
}

/// A key with a value, its scenes and its fault.
pub(super) struct StudiedKey {
    pub(super) key: SceneKey,
    /// Indices of the scenes that use it.
    pub(super) scenes: Vec<usize>,
    /// Whether the committed faults are available; otherwise none is required, as for the other studies.
    pub(super) are_faults_at_hand: bool,
    /// The result of a fault in it, if one was planted.
    pub(super) fault: Option<PlantedFault>,
}

/// The line of a key.
pub(super) fn key_line(studied: &StudiedKey, cases: &[CaseFindings<'_>]) -> Line {
    let StudiedKey {
        key, scenes, fault, ..
    } = studied;
    let users = scenes.iter().map(|&k| &cases[k]);
    let checks = fault
        .as_ref()
        .map(PlantedFault::detected_by)
        .unwrap_or_default();
    let findings = users.clone().flat_map(|case| case.findings);
    let judging = findings.filter(|f| checks.contains(&f.check));
    let failed = judging.clone().find(|f| !f.pass).map(|f| f.key.clone());
    let exception = CAPABILITIES.exceptions.get(&key.id);
    let state = match (exception, scenes.len(), fault, failed) {
        (_, _, _, Some(key)) => LineState::Fail(format!("{key} fails")),
        (Some(reason), ..) => LineState::Exempt(reason),
        (None, 0, ..) => LineState::Fail("no case uses it".to_owned()),
        (None, _, None, _) if !studied.are_faults_at_hand => LineState::Pass,
        (None, _, None, _) => LineState::Fail("no fault was planted in it".to_owned()),
        (None, _, Some(PlantedFault::Refused), _) => {
            LineState::Exempt("every other value of it is refused with an error")
        }
        (None, _, Some(PlantedFault::Unchanged), _) => {
            LineState::Fail("a fault in it is not detected".to_owned())
        }
        (None, _, Some(PlantedFault::Detected { by, .. }), _) if by.len() < REQUIRED => {
            LineState::Fail("a fault in it is detected by fewer than two checks".to_owned())
        }
        _ => LineState::Pass,
    };
    let fault = match fault {
        Some(PlantedFault::Detected { scene, what, by }) => {
            Some(format!("{what}, on {scene}: {}", numbers(by)))
        }
        _ => None,
    };
    Line {
        section: key.table.to_owned(),
        item: key.name.to_owned(),
        meaning: key.doc.to_owned(),
        cases: users.map(|case| case.name.to_owned()).collect(),
        nearest: nearest(judging).cloned(),
        checks,
        mutations: fault.into_iter().collect(),
        state,
    }
}

/// The lines of commands and options.
pub(super) fn command_lines(
    interface: &Interface,
    cases: &[CaseFindings<'_>],
    others: &[Finding],
    faults: &[CommittedMutation],
) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut add =
        |section: &str, item: &str, required: Option<&'static CommandRequirement>, name: &str| {
            let exception = CAPABILITIES.exceptions.get(name).map(String::as_str);
            let line = Line {
                section: section.to_owned(),
                item: item.to_owned(),
                state: LineState::Exempt(exception.unwrap_or("not described")),
                ..Line::default()
            };
            lines.push(match required {
                Some(required) => checked_line(line, required, cases, others, faults),
                None => line,
            });
        };
    for (command, options) in &interface.commands {
        let section = format!("dwell {command}");
        add(
            &section,
            "the command",
            CAPABILITIES.commands.get(command),
            command,
        );
        for option in options {
            let name = format!("{command} {option}");
            add(&section, option, CAPABILITIES.options.get(&name), &name);
        }
    }
    for option in &interface.common_options {
        add("options of every command", option, None, option);
    }
    lines
}

/// A line with the findings and faults that its description selects.
fn checked_line(
    line: Line,
    (requirement, _, keys, words): &'static CommandRequirement,
    cases: &[CaseFindings<'_>],
    others: &[Finding],
    faults: &[CommittedMutation],
) -> Line {
    let judges = |f: &&Finding| keys.iter().any(|key| f.key.starts_with(key.as_str()));
    let users = cases
        .iter()
        .filter(|case| case.findings.iter().any(|f| judges(&f)));
    let all = cases.iter().flat_map(|case| case.findings).chain(others);
    let judging = all.filter(judges);
    let checks: BTreeSet<Check> = judging.clone().map(|f| f.check).collect();
    let failed = judging.clone().find(|f| !f.pass).map(|f| f.key.clone());
    let of_words = |fault: &&CommittedMutation| {
        let mut words = words.iter();
        words.any(|w| fault.description.contains(w.as_str()) || fault.group.contains(w.as_str()))
    };
    let caught: Vec<&CommittedMutation> = faults.iter().filter(of_words).collect();
    let enough = caught
        .iter()
        .filter(|fault| fault.detected_by.len() >= REQUIRED);
    let state = match (failed, checks.len(), enough.count()) {
        (Some(key), ..) => LineState::Fail(format!("{key} fails")),
        (None, 0, _) => LineState::Fail("nothing judges it".to_owned()),
        (None, n, _) if n < REQUIRED => LineState::Fail("one check judges it".to_owned()),
        (None, _, 0) if !faults.is_empty() => LineState::Fail("no fault is caught".to_owned()),
        _ => LineState::Pass,
    };
    let listed = caught.iter().take(MAX_LISTED).map(|fault| {
        let by: Vec<String> = fault.detected_by.iter().map(usize::to_string).collect();
        format!("{}: {}", fault.description, by.join(" "))
    });
    let more = caught.len().saturating_sub(MAX_LISTED);
    let more = (more > 0).then(|| format!("and {more} more"));
    Line {
        meaning: requirement.clone(),
        cases: users.map(|case| case.name.to_owned()).collect(),
        nearest: nearest(judging).cloned(),
        checks,
        mutations: listed.chain(more).collect(),
        state,
        ..line
    }
}

/// The number of agreeing digits of a finding, limited by double precision.
pub(super) fn digits(finding: &Finding) -> f64 {
    -finding.relative_difference.max(f64::EPSILON).log10()
}

/// Numbers of checks as text.
pub(super) fn numbers(checks: &BTreeSet<Check>) -> String {
    let all = checks.iter().map(|check| check.number().to_string());
    all.collect::<Vec<String>>().join(" ")
}
