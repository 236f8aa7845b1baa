//! The findings on pulses and on random machines see what they are there to see: of sound results none fails, and each
//! fails for what it is there to find.

use dwell_dynamics::Method;
use dwell_findings::Finding;
use dwell_trials::machines::{self, MachineResult, MachineRun};
use dwell_trials::pulses::{self, PulseResult, PulseRun, PulseShape, PulseSubject, RunKind};

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

fn pulse_run(kind: RunKind) -> PulseRun {
    PulseRun {
        kind,
        refused: None,
        error: 1e-8,
        missed: 1e-7,
        error_by_hand: Some(1e-8),
        estimate: 1e-7,
        rounding: 1e-12,
        speed_effect: 1.0,
    }
}

#[test]
fn pulses_that_are_missed_promised_in_vain_or_refused_are_seen() {
    let runs = [RunKind::Fixed(Method::Bdf, 1e-8), RunKind::Accuracy(1e-6)];
    let sound = PulseResult {
        number: 0,
        subject: PulseSubject::Wheel,
        shape: PulseShape::Bell,
        relative_width: 1e-3,
        span: 1.0,
        speed: 0.0,
        runs: runs.map(pulse_run).into(),
    };
    let with = |change: &dyn Fn(&mut PulseRun)| {
        let mut changed = vec![sound.clone()];
        changed[0].runs.iter_mut().for_each(change);
        let findings = pulses::check(&changed);
        failed(&findings).join(" ")
    };
    assert_eq!(with(&|_| ()), "");
    assert_eq!(with(&|run| run.missed = 1.0), "pulses-missed");
    assert_eq!(with(&|run| run.missed = f64::NAN), "pulses-missed");
    let worse = with(&|run| (run.error, run.estimate) = (2e-6, 3e-6));
    assert_eq!(worse, "pulses-accuracy pulses-restarts");
    assert_eq!(with(&|run| run.estimate = 9e-9), "pulses-error-estimate");
    let refused = with(&|run| run.refused = Some("too hard".to_owned()));
    assert_eq!(refused, "pulses-refused");
    assert_eq!(failed(&pulses::check(&[])).len(), 5);
}

#[test]
fn machines_with_wrong_estimates_are_seen() {
    let sound = MachineResult {
        number: 0,
        kind: "pendulum",
        text: String::new(),
        without_reference: None,
        runs: vec![MachineRun {
            accuracy: 1e-6,
            refused: None,
            error: 1e-8,
            reference_error: 1e-12,
            estimate: 1e-7,
        }],
    };
    let with = |change: &dyn Fn(&mut MachineResult)| {
        let mut changed = vec![sound.clone()];
        changed.iter_mut().for_each(change);
        let findings = machines::check(&changed);
        failed(&findings).join(" ")
    };
    assert_eq!(with(&|_| ()), "");
    let small = with(&|m| m.runs[0].estimate = 1e-9);
    assert_eq!(small, "machines-error-estimate");
    let large = with(&|m| m.runs[0].estimate = 1e-5);
    assert_eq!(large, "machines-error-estimates");
    let broken = with(&|m| (m.runs[0].error, m.runs[0].estimate) = (2e-6, 3e-6));
    assert_eq!(broken, "machines-accuracy");
    let refused = with(&|m| m.runs[0].refused = Some(String::new()));
    assert_eq!(refused, "machines-refused");
    let unknown = with(&|m| {
        m.without_reference = Some(String::new());
        m.runs.clear();
    });
    assert_eq!(unknown, "machines-without-reference");
}
