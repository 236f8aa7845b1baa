//! Forces under loads of variants that are filled into one structure, compared with models that are compiled for each of
//! them.

use super::{
    DEVIATIONS, POSITIONS, TOLERANCE, VARIANTS, compile, golden_maximum, random, variant_of_paths,
};
use dwell_geometry::{Range, Reaction};
use dwell_kinetostatics::Model;
use dwell_kinetostatics::variants::{TurningVariant, VariantModel};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// A coordinate, rad, at which the filled model itself is compared, too.
const ELSEWHERE: f64 = 2.345;

/// A mechanism under loads, with the paths of all numbers that vary.
struct Subject {
    scene: PlaneScene,
    reaction: Reaction,
    paths: Vec<String>,
    /// Constant velocity, rad/s.
    velocity: f64,
}

impl Subject {
    /// A case, with more loads.
    fn new(
        case: &str,
        loads: &str,
        (reaction, velocity): (&str, f64),
        load_paths: &[&str],
    ) -> Self {
        let scene = fixtures::scene(case);
        let text = scene.source.inner();
        let text = match text.split_once("[loads]") {
            Some((before, after)) => format!("{before}[loads]\n{loads}{after}"),
            None => format!("{text}\n[loads]\n{loads}\n"),
        };
        let scene = PlaneScene::parse(case, &text).expect("a scene");
        let all = scene.mechanism.reactions();
        let named = |r: &&Reaction| scene.mechanism.reaction_name(**r) == reaction;
        let reaction = *all.iter().find(named).expect("a reaction");
        let mut paths = scene.number_paths();
        paths.extend(load_paths.iter().map(|&path| path.to_owned()));
        Self {
            scene,
            reaction,
            paths,
            velocity,
        }
    }

    fn variant(&self, deviation: f64, number: u64) -> PlaneScene {
        variant_of_paths(&self.scene, &self.paths, deviation, number)
    }
}

/// The actuator force and the reaction of a model at a coordinate.
fn forces(model: &Model, q: f64, velocity: f64) -> [f64; 2] {
    let (mut workspace, mut out) = (model.workspace(), model.result_buffer());
    let state = model.kinetostatics(0.0, &[q], &[velocity], &[0.0], &mut workspace, &mut out);
    state.expect("a pose");
    [out.tau[0], out.reactions[0]]
}

/// The largest magnitude of each force of a compiled model, by dense positions and golden sections.
fn largest(model: &Model, velocity: f64) -> [f64; 2] {
    let step = TAU / POSITIONS as f64;
    let at: Vec<[f64; 2]> = (0..POSITIONS)
        .map(|i| forces(model, step * i as f64, velocity))
        .collect();
    [0, 1].map(|k| {
        let values: Vec<f64> = at.iter().map(|forces| forces[k].abs()).collect();
        let highest = values.iter().copied().fold(0.0, f64::max);
        let near = |i: &usize| {
            let sides = [POSITIONS - 1, 1].map(|side| values[(i + side) % POSITIONS]);
            values[*i] >= sides[0].max(sides[1]) && values[*i] > 0.99 * highest
        };
        let value = |q: f64| forces(model, q, velocity)[k].abs();
        let peaks = (0..POSITIONS).filter(near);
        let refined = peaks.map(|i| golden_maximum(&value, step * i as f64, step));
        refined.fold(highest, f64::max)
    })
}

/// What a variant has of its own: the largest forces over the turn, and those at one coordinate.
type Found = ([f64; 2], [f64; 2]);

/// Of the variants of a mechanism at one deviation: how many rotate, how many of them are left to compilation, and the
/// largest difference of the others, as a part of each largest force. None is accepted that does not rotate.
fn compare(subject: &Subject, deviation: f64) -> (usize, usize, f64) {
    let &Subject {
        reaction, velocity, ..
    } = subject;
    let typical = subject.variant(0.01, u64::MAX / 4096);
    let structure = VariantModel::new(compile(&typical, reaction).expect("a model"));
    let structure = structure.expect("a structure");
    let structure = structure.with_loads(typical.loads, &[reaction], Some(velocity));
    let structure = structure.expect("a structure with loads");
    let seed = (1e4 * deviation) as u64 * VARIANTS as u64;
    let variants: Vec<PlaneScene> = (0..VARIANTS as u64)
        .into_par_iter()
        .map(|k| subject.variant(deviation, seed + k))
        .collect();
    let numbers: Vec<Vec<f64>> = variants
        .iter()
        .map(|scene| structure.numbers(&scene.mechanism, &scene.masses, &scene.loads))
        .map(|numbers| numbers.expect("the structure"))
        .collect();
    let elsewhere = |k: usize| ELSEWHERE + random(k as u64);
    let mut found: Vec<Option<Found>> = vec![None; VARIANTS];
    let mut fill = |k: usize, to: &mut [f64]| {
        to.copy_from_slice(&numbers[k]);
        0.0
    };
    let mut done = |k: usize, variant: Option<TurningVariant<'_>>| {
        found[k] = variant.map(|variant| {
            let peaks = &variant.turn.loaded_forces;
            let filled = variant.loaded.expect("a model under loads");
            let peaks = [0, 1].map(|i| peaks[i].value.abs());
            (peaks, forces(filled, elsewhere(k), velocity))
        });
    };
    structure.turns(0..VARIANTS, &mut fill, &mut done);
    let each = variants.par_iter().zip(found).enumerate();
    let each = each.map(|(k, (scene, found))| {
        let model = compile(scene, reaction).filter(|m| m.plan().range() == Range::Full);
        let model = model.map(|m| m.with_loads(scene.loads.clone()).expect("loads"));
        match (found, model) {
            (Some((peaks, there)), Some(model)) => {
                let expected = largest(&model, velocity);
                let compiled = forces(&model, elsewhere(k), velocity);
                let differences = [0, 1].map(|i| {
                    let peak = (peaks[i] - expected[i]).abs();
                    peak.max((there[i] - compiled[i]).abs()) / expected[i]
                });
                (1, 0, differences[0].max(differences[1]))
            }
            (None, Some(_)) => (1, 1, 0.0),
            (None, None) => (0, 0, 0.0),
            (Some(_), None) => (0, 0, f64::INFINITY),
        }
    });
    each.reduce(|| (0, 0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1, a.2.max(b.2)))
}

#[test]
fn val_forces_of_variants_are_those_of_models_compiled_for_each() {
    let subjects = [
        // Weight, damper; a spring and a force of constant size between two points besides.
        Subject::new(
            "watt-six-bar",
            "hold = { spring = [\"ground.S\", \"link5.G\"], stiffness = 150, free-length = 0.05 }",
            ("G.x", 10.0),
            &[
                "loads.dashpot.damping",
                "loads.hold.stiffness",
                "loads.hold.free-length",
            ],
        ),
        // A force on the coupler and a couple on the rocker.
        Subject::new(
            "four-bar",
            "",
            ("D.y", 25.0),
            &["loads.push.magnitude", "loads.resistance.magnitude"],
        ),
        // At rest: weight, a spring, and a force in the direction of a body.
        Subject::new(
            "single-dwell",
            "weight = { gravity = [0, -9.81] }\n\
             pull = { spring = [\"ground.O\", \"coupler.P\"], stiffness = 300, free-length = 100 }\n\
             push = { force = \"rocker.C\", direction = [0.6, 0.8], magnitude = 20 }",
            ("slide.normal", 0.0),
            &[
                "loads.pull.stiffness",
                "loads.pull.free-length",
                "loads.push.magnitude",
            ],
        ),
    ];
    for subject in &subjects {
        let case = &subject.scene.name;
        for deviation in DEVIATIONS {
            let (rotating, left, difference) = compare(subject, deviation);
            println!(
                "{case} ±{deviation}: {rotating} rotate, {left} of them to compile, {difference:.1e}"
            );
            // At most 5.7e-13, of the four-bar.
            assert!(
                difference < TOLERANCE,
                "{case} ±{deviation}: {difference:.1e}"
            );
            assert!(
                10 * left <= rotating,
                "{case} ±{deviation}: {left} of {rotating}"
            );
        }
    }
}
