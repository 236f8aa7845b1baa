//! Where a result comes from, without dates and machines.

use dwell_report::{Animation, Figure, ReportError, png};
use dwell_scene::Scene;

/// Digits of a hash in pictures; documents have all of them.
const SHORT: usize = 12;

/// Version, scene and the hash of its text.
pub(crate) fn origin(scene: &Scene) -> String {
    line(scene, &scene.hash())
}

fn line(scene: &Scene, hash: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("Dwell {version} · scene {} (sha256 {hash})", scene.name)
}

/// The same in short, and how the result was come by.
fn signature(scene: &Scene, how: &str) -> String {
    let line = line(scene, &scene.hash()[..SHORT]);
    if how.is_empty() {
        line
    } else {
        format!("{line} · {how}")
    }
}

/// Draws a figure of a scene. No other way leads from a study to a picture, so that each says where it comes from; what makes a
/// figure leaves in its `provenance` how it was come by: method and tolerance.
pub(crate) fn picture(scene: &Scene, figure: &Figure) -> Result<Vec<u8>, ReportError> {
    png(&Figure {
        provenance: signature(scene, &figure.provenance),
        ..figure.clone()
    })
}

/// The same for a film.
pub(crate) fn film(scene: &Scene, film: Animation) -> Result<Vec<u8>, ReportError> {
    Animation {
        provenance: signature(scene, &film.provenance),
        ..film
    }
    .gif()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signature_names_version_scene_hash_and_method_and_nothing_that_changes() {
        let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.crank]\npoints = { A = [0, 0] }\n\
                    [joints]\nA = { revolute = [\"ground.A\", \"crank.A\"] }\n[actuators]\n\
                    phi = { angle = [\"ground\", \"crank\"] }\n";
        let scene = Scene::parse("folder/crank.toml", text).expect("a scene");
        let hash = scene.hash();
        let version = env!("CARGO_PKG_VERSION");
        assert_eq!(
            signature(&scene, "BDF, tolerance 1e-10"),
            format!(
                "Dwell {version} · scene crank (sha256 {}) · BDF, tolerance 1e-10",
                &hash[..12]
            )
        );
        assert!(origin(&scene).ends_with(&format!("(sha256 {hash})")));
        let elsewhere = Scene::parse("/another/place/crank.toml", text).expect("a scene");
        assert_eq!(signature(&elsewhere, ""), signature(&scene, ""));
    }
}
