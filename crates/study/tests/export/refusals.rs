//! Scenes that cannot be exported: the message names the part, points to it and suggests a change.

use super::toolchain::{case, request};
use dwell_export::Precision;
use dwell_study::{ExportRequest, compute_export, compute_export_of_several_freedoms};

fn message(name: &str, asked: &ExportRequest) -> String {
    let error = compute_export(&case(name), asked).unwrap_err();
    error.to_string()
}

#[test]
fn several_freedoms_and_dry_friction_are_refused_by_name() {
    let asked = request(1e-6, Precision::Double);
    let found = message("double-pendulum", &asked);
    assert!(found.contains("one"), "{found}");
    let found = message("slider-crank-friction", &asked);
    assert!(found.contains("dry friction"), "{found}");
}

#[test]
fn drags_of_several_freedoms_are_refused_by_name() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/five-bar/scene.toml"
    );
    let text = std::fs::read_to_string(path).expect("the file").replace(
        "[loads]",
        "[loads]\nwind = { drag = \"left.B\", coefficient = 1 }",
    );
    let scene = dwell_scene::PlaneScene::parse("five-bar.toml", &text).expect("a scene");
    let asked = request(1e-6, Precision::Double);
    let error = compute_export_of_several_freedoms(&scene, &asked).expect_err("a refusal");
    assert!(error.to_string().contains("the drag wind"), "{error}");
}

#[test]
fn dry_friction_in_space_is_refused_by_name() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/spatial/rssr.toml"
    );
    let text = std::fs::read_to_string(path).expect("the file")
        + "\n[friction]\nD = { coefficient = 0.1, radius = 0.01, regularization-speed = 0.1 }\n";
    let scene = dwell_scene::SpaceScene::parse("rssr.toml", &text).expect("a scene");
    let asked = request(1e-6, Precision::Double);
    let error = dwell_study::compute_export(&scene, &asked).expect_err("a refusal");
    let found = error.to_string();
    assert!(found.contains("D.friction is dry friction"), "{found}");
}

#[test]
fn end_stops_in_space_are_refused() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/spatial/rssr.toml"
    );
    let text = std::fs::read_to_string(path).expect("the file");
    let scene = dwell_scene::SpaceScene::parse("rssr.toml", &text).expect("a scene");
    let name = &scene.mechanism.actuators[0].name;
    let text = format!("{text}\n[stops]\nend = {{ coordinate = \"{name}\", max = 9 }}\n");
    let scene = dwell_scene::SpaceScene::parse("rssr.toml", &text).expect("a scene");
    let asked = request(1e-6, Precision::Double);
    let error = dwell_study::compute_export(&scene, &asked).expect_err("a refusal");
    let found = error.to_string();
    assert!(found.contains("the scene has end stops"), "{found}");
}

#[test]
fn laws_known_by_values_have_no_operations() {
    let asked = ExportRequest {
        exact: true,
        ..request(1e-6, Precision::Double)
    };
    let found = message("cam", &asked);
    assert!(found.contains("no exact export: a law"), "{found}");
}

#[test]
fn an_interval_outside_the_range_is_refused() {
    let mut asked = request(1e-6, Precision::Double);
    asked.interval = Some((1.0, 0.5));
    let found = message("single-dwell", &asked);
    assert!(found.contains("greater than its beginning"), "{found}");
}

/// A rise of 3 mm within a millionth of a radian, between all points at which functions are sampled.
#[test]
fn a_cam_that_rises_between_the_points_of_a_fit_is_refused() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../validation/cam/scene.toml"
    );
    let text = std::fs::read_to_string(path).expect("the file");
    let law = "0.04 + 0.012*(1 - cos(x)) + 0.003*(1 - cos(2*x))";
    assert!(text.contains(law));
    for width in [1e-5, 1e-6, 1e-8] {
        let steep = text.replace(law, &format!("0.04 + 0.0015*tanh((x - 1.2345678)/{width})"));
        let scene = dwell_scene::PlaneScene::parse("cam.toml", &steep).expect("a scene");
        let error = compute_export(&scene, &request(1e-6, Precision::Double));
        let found = error.map(drop).expect_err("a refusal").to_string();
        assert!(found.contains("no export"), "{found}");
    }
}
