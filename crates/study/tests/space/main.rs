//! `kinematics`, `statics` and `kinetostatics` of scenes in space, and the pictures of these scenes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests"
)]

mod accuracy;
mod as_in_the_plane;
mod carried_loops;
mod motors;
mod pictures;
mod revolutions;
mod trajectories;

use dwell_scene::SpaceScene;

/// The scenes of `validation/spatial`.
const SCENES: [&str; 13] = [
    "bennett",
    "bricard-a04",
    "double-hooke",
    "governor",
    "planar-oblique-4r",
    "planar-oblique-rcsr",
    "rssr-haug",
    "rssr",
    "rsur-haug",
    "rsur",
    "schatz",
    "slider-crank-haug",
    "wobble-plate",
];

/// A scene of `validation/spatial` with a section for its motion.
fn scene(name: &str, motion: &str) -> SpaceScene {
    let path = format!(
        "{}/../../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("a scene") + motion;
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}
