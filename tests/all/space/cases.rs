//! The cases in space of `dwell validate` fail where their scene is another.

use dwell_scene::SpaceScene;
use dwell_study::no_progress;
use dwell_tests::fixtures::repository_root;
use dwell_validation::validate;

/// The keys of the findings that fail where a text of the scene of a case is another.
fn failed(case: &str, written: &str, other: &str) -> Vec<String> {
    let folder = repository_root().join("validation/spatial");
    let text = std::fs::read_to_string(folder.join(format!("{case}.toml"))).expect("a scene");
    let changed = text.replace(written, other);
    assert_ne!(text, changed);
    let scene = SpaceScene::parse(case, &changed).expect("a scene");
    let done = validate(&scene.into(), &folder, None, &no_progress);
    let findings = done
        .unwrap_or_else(|e| panic!("{case}: {e}"))
        .outcome
        .findings;
    let failed = findings.into_iter().filter(|f| !f.pass);
    failed.map(|f| f.key).collect()
}

/// A rotor that is a thousandth heavier precesses otherwise: its motion is no longer that of the closed form, while everything that needs no
/// reference agrees.
#[test]
fn another_mass_is_seen_by_the_closed_form_of_the_gyroscope() {
    let failed = failed("gyroscope", "mass = 0.3", "mass = 0.3003");
    assert_eq!(failed, ["reference-motion"]);
}

/// One body a thousandth heavier: m, w, reactions and periods are no longer those of the reference, while everything that needs no reference agrees.
#[test]
fn another_mass_is_seen_by_the_reference() {
    assert_eq!(
        failed("rssr", "mass = 0.9", "mass = 0.9009"),
        [
            "reference-period",
            "reference-inertia",
            "reference-reactions"
        ]
    );
}
