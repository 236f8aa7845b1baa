//! The separating forces of teeth with a pressure angle, held against checks that know no plan: the validation's gears
//! and racks with such teeth, and deliberate faults that must be found.

use dwell_findings::Finding;
use dwell_geometry::Component;
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::repository_root;
use dwell_validation::{CheckedStates, check_case};
use dwell_verify::{ClaimedState, check_states};

/// The cases, and where their teeth are described.
const TOOTHED: [(&str, &[&str]); 2] = [
    ("planetary", &["radii = [30, 20]", "internal = true"]),
    ("rack-pinion", &["radius = 20"]),
];

/// A case whose teeth have a pressure angle of 0.35 rad, and the case itself.
fn with_and_without(case: &str, teeth: &[&str]) -> [PlaneScene; 2] {
    let path = repository_root().join("validation").join(case);
    let text = std::fs::read_to_string(path.join("scene.toml"));
    let plain = text.unwrap_or_else(|e| panic!("{case}: {e}"));
    let mut text = plain.clone();
    for teeth in teeth {
        assert_eq!(text.matches(teeth).count(), 1, "{case}: {teeth}");
        text = text.replace(teeth, &format!("{teeth}, pressure-angle = 0.35"));
    }
    [text, plain].map(|text| {
        PlaneScene::parse("scene.toml", &text).unwrap_or_else(|e| panic!("{case}: {e}"))
    })
}

/// Without the references of a case, whose bearings carry no separating force.
fn checked(scene: &PlaneScene) -> CheckedStates {
    let folder = repository_root().join("tests");
    check_case(scene, &folder).unwrap_or_else(|e| panic!("{}: {e}", scene.title))
}

fn failed(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

#[test]
fn val_teeth_with_a_pressure_angle() {
    for (case, teeth) in TOOTHED {
        let [with, without] = with_and_without(case, teeth).map(|scene| (checked(&scene), scene));
        assert_eq!(failed(&with.0.findings), [""; 0], "{case}");
        let reactions = with.1.mechanism.reactions();
        let (mut changed, mut largest) = (0.0_f64, 0.0_f64);
        for (a, b) in with.0.states.iter().zip(&without.0.states) {
            for (k, reaction) in reactions.iter().enumerate() {
                let difference = (a.reactions[k] - b.reactions[k]).abs();
                largest = largest.max(b.reactions[k].abs());
                if reaction.component == Component::Tooth {
                    assert!(difference <= 1e-12 * largest, "{case}: {difference:e}");
                } else {
                    changed = changed.max(difference);
                }
            }
        }
        assert!(changed > 0.1 * largest, "{case}: {changed} of {largest}");
    }
}

/// What a faulty program would claim of the separating forces: none, twice as much, the other direction.
#[test]
fn a_wrong_separating_force_is_found() {
    for (case, teeth) in TOOTHED {
        let [scene, _] = with_and_without(case, teeth);
        let checked = checked(&scene);
        let count = scene
            .loads
            .iter()
            .filter(|l| l.pressure_angle().is_some())
            .count();
        let find = |fault: fn(&mut dwell_verify::BodyWrench)| {
            let mut states: Vec<ClaimedState> = checked.states.clone();
            for state in &mut states {
                // They are the last loads, and each acts on two bodies.
                let first = state.load_wrenches.len() - 2 * count;
                state.load_wrenches[first..].iter_mut().for_each(fault);
            }
            let findings = check_states(&checked.assembled(&scene), &states, 0);
            failed(&findings).join(" ")
        };
        for fault in [
            |w: &mut dwell_verify::BodyWrench| w.force = w.force.scaled(0.0),
            |w: &mut dwell_verify::BodyWrench| w.force = w.force.scaled(2.0),
            |w: &mut dwell_verify::BodyWrench| w.force = -w.force,
        ] {
            let found = find(fault);
            let expected = "state-reactions state-newton-euler state-newton-euler-differences";
            assert!(found.starts_with(expected), "{case}: {found}");
        }
    }
}
