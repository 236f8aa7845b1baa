//! Provenance of results: version, scene and method, without dates and host names.

use dwell_scene::SceneFile;

/// Digits of a hash in figures; documents have all of them.
const SHORT_HASH: usize = 12;

/// Version, scene and the hash of its text.
pub fn provenance_line(scene: &SceneFile) -> String {
    line(scene, &scene.hash())
}

fn line(scene: &SceneFile, hash: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!("Dwell {version} · scene {} (sha256 {hash})", scene.name)
}

/// The signature with a short hash, and the method.
pub(super) fn signature(scene: &SceneFile, method_text: &str) -> String {
    let line = line(scene, &scene.hash()[..SHORT_HASH]);
    match method_text {
        "" => line,
        method_text => format!("{line} · {method_text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_scene::PlaneScene;

    #[test]
    fn a_signature_names_version_scene_hash_and_method_and_nothing_that_changes() {
        let text = "[bodies.ground]\npoints = { A = [0, 0] }\n[bodies.crank]\npoints = { A = [0, 0] }\n\
                    [joints]\nA = { revolute = [\"ground.A\", \"crank.A\"] }\n[actuators]\n\
                    phi = { angle = [\"ground\", \"crank\"] }\n";
        let scene = PlaneScene::parse("folder/crank.toml", text).expect("a scene");
        let hash = scene.hash();
        let version = env!("CARGO_PKG_VERSION");
        assert_eq!(
            signature(&scene, "BDF, tolerance 1e-10"),
            format!(
                "Dwell {version} · scene crank (sha256 {}) · BDF, tolerance 1e-10",
                &hash[..12]
            )
        );
        assert!(provenance_line(&scene).ends_with(&format!("(sha256 {hash})")));
        let elsewhere = PlaneScene::parse("/another/place/crank.toml", text).expect("a scene");
        assert_eq!(signature(&elsewhere, ""), signature(&scene, ""));
    }
}
