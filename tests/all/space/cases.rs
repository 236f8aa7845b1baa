//! The cases in space of `dwell validate`: each passes, has the values that are committed, and fails where its scene is another.

use dwell_findings::all_pass;
use dwell_scene::SpaceScene;
use dwell_tests::fixtures::repository_root;
use dwell_validation::{Validation, validate_in_space};
use std::path::PathBuf;

/// The scenes.
fn cases() -> Vec<PathBuf> {
    let folder = repository_root().join("validation/spatial");
    let entries = std::fs::read_dir(folder).expect("the folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let is_case = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let mut all: Vec<PathBuf> = paths.filter(is_case).collect();
    all.sort();
    all
}

fn validated(scene: &SpaceScene, path: &std::path::Path) -> Validation {
    let reference = path.with_extension("json");
    let reference = reference.is_file().then_some(reference);
    let done = validate_in_space(scene, reference.as_deref(), None);
    done.unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

#[test]
fn every_case_in_space_passes_with_the_values_it_had() {
    let cases = cases();
    assert!(cases.len() >= 18, "{cases:?}");
    let mut wrong = Vec::new();
    for path in &cases {
        let scene = SpaceScene::read(path).expect("a scene");
        let done = validated(&scene, path);
        if !all_pass(&done.outcome.findings) {
            wrong.push(done.outcome.summary.clone());
        }
        for f in &done.outcome.findings {
            println!(
                "{} {}: {:.1e} of {:.1e} at {}",
                scene.name, f.key, f.relative_difference, f.tolerance, f.worst_at
            );
        }
        let report = repository_root().join(format!("reports/{}.txt", scene.name));
        let committed = std::fs::read_to_string(&report).unwrap_or_default();
        if !committed.lines().eq(done.snapshot.lines()) {
            wrong.push(format!(
                "{} is another: `dwell validate {}` writes it anew",
                report.display(),
                scene.name
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A rotor that is a thousandth heavier precesses otherwise: its motion is no longer that of the closed form, while everything that needs no
/// reference agrees.
#[test]
fn another_mass_is_seen_by_the_closed_form_of_the_gyroscope() {
    let path = repository_root().join("validation/spatial/gyroscope.toml");
    let text = std::fs::read_to_string(&path).expect("a scene");
    let heavier = text.replace("mass = 0.3", "mass = 0.3003");
    assert_ne!(text, heavier);
    let scene = SpaceScene::parse("gyroscope", &heavier).expect("a scene");
    let done = validated(&scene, &path);
    let failed = done.outcome.findings.iter().filter(|f| !f.pass);
    let failed: Vec<&str> = failed.map(|f| f.key.as_str()).collect();
    assert_eq!(failed, ["reference-motion"]);
}

/// One body a thousandth heavier: m, w, reactions and periods are no longer those of the reference, while everything that needs no reference agrees.
#[test]
fn another_mass_is_seen_by_the_reference() {
    let path = repository_root().join("validation/spatial/rssr.toml");
    let text = std::fs::read_to_string(&path).expect("a scene");
    let heavier = text.replace("mass = 0.9", "mass = 0.9009");
    assert_ne!(text, heavier);
    let scene = SpaceScene::parse("rssr", &heavier).expect("a scene");
    let done = validated(&scene, &path);
    let failed: Vec<&str> = done
        .outcome
        .findings
        .iter()
        .filter(|f| !f.pass)
        .map(|f| f.key.as_str())
        .collect();
    assert_eq!(
        failed,
        [
            "reference-period",
            "reference-inertia",
            "reference-reactions"
        ]
    );
}
