//! The verification manual: every key has a case, and a fault in it is detected by two checks of different number.

use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{case_names, repository_root, scene};
use dwell_validation::manual::Manual;

#[test]
fn every_key_has_a_case_and_a_fault_in_it_is_detected_by_two_checks() {
    let scenes: Vec<PlaneScene> = case_names().iter().map(|name| scene(name)).collect();
    let scenes: Vec<&PlaneScene> = scenes.iter().collect();
    let manual = Manual::new(&scenes, &repository_root().join("validation"));
    let gaps = manual.gaps();
    assert!(gaps.is_empty(), "{}", gaps.join("\n"));
}

#[test]
fn without_the_committed_faults_none_is_required() {
    // Beside this copy of a case there are no reports.
    let folder = std::env::temp_dir().join(format!("dwell-manual-{}/cases", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let scenes = [scene("pendulum-a01")];
    let scenes: Vec<&PlaneScene> = scenes.iter().collect();
    let gaps = Manual::new(&scenes, &folder).gaps();
    let others: Vec<&String> = gaps
        .iter()
        .filter(|gap| !gap.ends_with("no case uses it"))
        .collect();
    assert!(others.is_empty() && !gaps.is_empty(), "{others:?}");
    std::fs::remove_dir_all(folder.parent().expect("its folder")).expect("removed");
}

#[test]
fn a_key_that_no_scene_uses_is_a_gap() {
    let scenes = [scene("pendulum-a01")];
    let scenes: Vec<&PlaneScene> = scenes.iter().collect();
    // Without the small scenes nothing uses a spring.
    let manual = Manual::new(&scenes, &repository_root().join("docs"));
    let gaps = manual.gaps();
    assert!(
        gaps.contains(&"spring stiffness: no case uses it".to_owned()),
        "{gaps:?}"
    );
}
