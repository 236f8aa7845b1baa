//! Common parts of the benchmarks: subjects that take turns, and the cases of validation/.
#![allow(dead_code, reason = "no benchmark needs all of it")]

use dwell_geometry::Reaction;
use dwell_kinetostatics::{ExactModel, Model};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Evaluations in one turn of a subject: some tenths of a millisecond, so that a turn is often
/// left alone by the rest of the machine.
pub(crate) const EVALUATIONS: usize = 2000;
/// Turns of each subject.
pub(crate) const ROUNDS: usize = 400;
/// Golden angle, rad: an irrational part of a turn.
pub(crate) const GOLDEN_ANGLE: f64 = TAU * 0.618_033_988_749_894_9;

/// One row of the table.
pub(crate) struct Subject<'a> {
    pub(crate) name: String,
    evaluate: Box<dyn FnMut() + 'a>,
    /// Time of each turn, ns per evaluation.
    pub(crate) times: Vec<f64>,
}

impl<'a> Subject<'a> {
    /// Evaluates at `q` over the turn, or from the start a little to both sides of it where a
    /// mechanism does not turn fully.
    pub(crate) fn new(
        name: impl Into<String>,
        (from, width): (f64, f64),
        mut at: impl FnMut(f64) + 'a,
    ) -> Self {
        let mut phase = 0.1;
        let evaluate = Box::new(move || {
            for _ in 0..EVALUATIONS {
                at(black_box(from + width * phase));
                phase += GOLDEN_ANGLE / TAU;
                if phase >= 1.0 {
                    phase -= 1.0;
                }
            }
        });
        Self {
            name: name.into(),
            evaluate,
            times: Vec::with_capacity(ROUNDS),
        }
    }

    pub(crate) fn run_round(&mut self) {
        let start = Instant::now();
        (self.evaluate)();
        let ns = start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64;
        self.times.push(ns);
    }
}

/// A whole turn from zero: where it begins, and its width, rad.
pub(crate) const FULL_REVOLUTION: (f64, f64) = (0.0, TAU);

/// A validation case.
pub(crate) struct Case {
    pub(crate) scene: PlaneScene,
}

impl Case {
    pub(crate) fn read(name: &str) -> Self {
        let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
        let path = home.join(name).join("scene.toml");
        match PlaneScene::read(path) {
            Ok(scene) => Self { scene },
            Err(error) => stop(name, &error.to_string()),
        }
    }

    pub(crate) fn model(&self, reactions: &[Reaction]) -> ExactModel {
        let PlaneScene {
            mechanism, masses, ..
        } = &self.scene;
        let assembly = self.scene.assembly.to_configuration();
        let model = Model::new(mechanism, masses, &assembly, reactions);
        let exact = model.map(ExactModel::new).map_err(|e| e.to_string());
        match exact {
            Ok(Some(exact)) => exact,
            Ok(None) => stop(&self.scene.name, "it has several actuators"),
            Err(error) => stop(&self.scene.name, &error),
        }
    }
}

pub(crate) fn stop(case: &str, why: &str) -> ! {
    eprintln!("{case}: {why}");
    std::process::exit(1)
}

pub(crate) fn reactions(scene: &PlaneScene, name: &str) -> Vec<Reaction> {
    let mechanism = &scene.mechanism;
    let all = mechanism.reactions().into_iter();
    let found: Vec<_> = all
        .filter(|&r| mechanism.reaction_name(r) == name)
        .collect();
    assert_eq!(found.len(), 1, "{name}");
    found
}
