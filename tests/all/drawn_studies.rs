//! The studies of pulses and of random machines see what they are there to see.

use dwell_findings::Finding;
use dwell_validation::extremes::{machines, pulses};

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

/// Each finding fails for what it is there to find, and for nothing else.
#[test]
fn val_pulses_that_are_missed_promised_in_vain_or_refused_are_seen() {
    let results = pulses::evaluate(12, 1);
    assert_eq!(failed(&pulses::check(&results)), Vec::<&str>::new());
    let with = |change: &dyn Fn(&mut pulses::PulseRun)| {
        let mut changed = results.clone();
        changed
            .iter_mut()
            .flat_map(|p| &mut p.runs)
            .for_each(change);
        pulses::check(&changed)
    };
    assert_eq!(failed(&with(&|run| run.missed = 1.0)), ["pulses-seen"]);
    assert_eq!(failed(&with(&|run| run.missed = f64::NAN)), ["pulses-seen"]);
    let worse = with(&|run| run.error = 1e6 * (run.error + 1e-3));
    assert_eq!(failed(&worse), ["pulses-accuracy", "pulses-restarts"]);
    let refused = with(&|run| run.refused = Some("too hard".to_owned()));
    assert_eq!(failed(&refused), ["pulses-refused"]);
    assert!(!failed(&pulses::check(&[])).is_empty());
}

#[test]
fn val_machines_with_wrong_estimates_are_seen() {
    let results = machines::evaluate(4, 1);
    let sound = machines::check(&results);
    let with = |change: &dyn Fn(&mut machines::MachineRun)| {
        let mut changed = results.clone();
        changed
            .iter_mut()
            .flat_map(|m| &mut m.runs)
            .for_each(change);
        let findings = machines::check(&changed);
        let newly = failed(&findings)
            .into_iter()
            .filter(|key| !failed(&sound).contains(key));
        newly.map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(with(&|run| run.estimate *= 1e-6).contains(&"machines-error-estimate".to_owned()));
    assert!(with(&|run| run.estimate *= 1e6).contains(&"machines-error-estimates".to_owned()));
    assert!(with(&|run| run.error = 1.0).contains(&"machines-accuracy".to_owned()));
    assert!(
        with(&|run| run.refused = Some(String::new())).contains(&"machines-refused".to_owned())
    );
}
