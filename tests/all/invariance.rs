//! One mechanism, described in many ways, has one set of coefficients: see [`dwell_tests::changes`] for
//! the ways and for what each makes of them.

use dwell_geometry::{Range, Vec2, vec2};
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel};
use dwell_scene::PlaneScene;
use dwell_tests::cases::{CASES, Case};
use dwell_tests::changes::{Rng, Sample, Setup, positions, travels};
use toml::{Table, Value};

const SEEDS: [u64; 6] = [1, 2, 3, 4, 5, 6];
const SAMPLES: u32 = 12;
/// What two ways of computing the same may differ by.
const ROUNDING: f64 = 1e-12;
/// 1e6 m away a coordinate is rounded by up to 6e-11 m, which is 6e-10 of the shortest link; the
/// reactions, which hold second derivatives, feel two to three times that.
const FAR_AWAY: f64 = 5e-9;

/// Largest differences of m and ½m′, of forces and of couples, each relative to the largest
/// coefficient of its unit (kg m for a force; kg m² for a couple and for m) over the samples.
#[derive(Debug, Clone, Copy, Default)]
struct LargestDifference {
    inertia: f64,
    force: f64,
    couple: f64,
}

impl LargestDifference {
    fn max(self, other: Self) -> Self {
        Self {
            inertia: self.inertia.max(other.inertia),
            force: self.force.max(other.force),
            couple: self.couple.max(other.couple),
        }
    }
}

/// The coefficients of a setup at positions of its own.
fn samples(setup: &Setup, model: &ExactModel, at: &[f64]) -> Vec<Sample> {
    let plan = model.model().plan();
    let mut workspace = model.workspace();
    let mut pose = plan.pose();
    let one = |&q: &f64| {
        let mut coefficients = model.model().coefficient_buffer();
        model
            .coefficients(q, &mut workspace, &mut coefficients)
            .expect("a pose");
        plan.positions(&[q], &mut pose).expect("a pose");
        Sample {
            coefficients,
            travel: travels(&setup.mechanism, plan, &pose),
        }
    };
    at.iter().map(one).collect()
}

/// How far `got` is from `want`, over all positions.
fn compare(setup: &Setup, got: &[Sample], want: &[Coefficients]) -> LargestDifference {
    let (mut in_kg_m, mut in_kg_m2) = (0.0_f64, 0.0_f64);
    let mut worst = LargestDifference::default();
    for (got, want) in got.iter().zip(want) {
        let got = &got.coefficients;
        for (got, want) in [(got.m, want.m), (got.half_dm, want.half_dm)] {
            assert!(got.is_finite());
            in_kg_m2 = in_kg_m2.max(want.abs());
            worst.inertia = worst.inertia.max((got - want).abs());
        }
        for (k, reaction) in setup.mechanism.reactions().iter().enumerate() {
            let (size, worst) = match reaction.component.unit() {
                "N" => (&mut in_kg_m, &mut worst.force),
                _ => (&mut in_kg_m2, &mut worst.couple),
            };
            for (got, want) in [(got.a[k], want.a[k]), (got.b[k], want.b[k])] {
                assert!(got.is_finite());
                *size = size.max(want.abs());
                *worst = worst.max((got - want).abs());
            }
        }
    }
    LargestDifference {
        inertia: worst.inertia / in_kg_m2,
        force: worst.force / in_kg_m,
        couple: worst.couple / in_kg_m2,
    }
}

/// The changed setups have the coefficients of the original by equation (1) of the changes, the
/// largest structural group of the case, and the range.
fn assert_invariant(case: Case, original: &Setup, what: &str, bound: f64, changed: &[Setup]) {
    let what = format!("{}, {what}", case.name);
    let model = original.model().expect("a model");
    let range = model.range();
    let at = positions(range, SAMPLES);
    let reference = samples(original, &model, &at);
    let mut worst = LargestDifference::default();
    for setup in changed {
        let model = setup.model().unwrap_or_else(|e| panic!("{what}: {e}"));
        let groups = model.model().plan().group_methods();
        let largest = groups.iter().map(|(n, _)| *n).max();
        assert_eq!(largest, Some(case.largest), "{what}: {groups:?}");
        match (model.range(), setup.range(range)) {
            (Range::Limited(from, to), Range::Limited(low, high)) => {
                let difference = (from - low).abs().max((to - high).abs());
                assert!(
                    difference <= 10.0 * bound,
                    "{what}: ends {difference:e} apart"
                );
            }
            (got, want) => assert_eq!(got, want, "{what}"),
        }
        let there: Vec<f64> = at.iter().map(|&q| setup.q(q)).collect();
        let want: Vec<_> = reference.iter().map(|s| setup.coefficients(s)).collect();
        worst = worst.max(compare(setup, &samples(setup, &model, &there), &want));
    }
    let LargestDifference {
        inertia,
        force,
        couple,
    } = worst;
    println!("{what:40} {inertia:8.1e} {force:8.1e} {couple:8.1e}");
    assert!(inertia.max(force).max(couple) <= bound, "{what}: {worst:?}");
}

/// The same for all cases and seeds.
fn assert_invariant_for_all(what: &str, bound: f64, change: impl Fn(Setup, &mut Rng) -> Setup) {
    for case in CASES {
        let original = Setup::of(&case.scene());
        let one = |&seed: &u64| change(original.clone(), &mut Rng(seed));
        let changed: Vec<Setup> = SEEDS.iter().map(one).collect();
        assert_invariant(case, &original, what, bound, &changed);
    }
}

#[test]
fn order_does_not_matter() {
    assert_invariant_for_all("shuffled", ROUNDING, Setup::shuffled);
}

#[test]
fn names_do_not_matter() {
    assert_invariant_for_all("renamed", 0.0, Setup::renamed);
}

#[test]
fn body_frames_do_not_matter() {
    assert_invariant_for_all("reframed", ROUNDING, Setup::reframed);
}

#[test]
fn orientation_does_not_matter() {
    let rotate = |s: Setup, rng: &mut Rng| s.rotated(rng.between(-3.0, 3.0));
    assert_invariant_for_all("rotated", ROUNDING, rotate);
}

#[test]
fn a_mirror_image_turns_the_other_way() {
    assert_invariant_for_all("mirrored", ROUNDING, |s, _| s.mirrored());
}

#[test]
fn swapped_bodies_act_the_other_way() {
    assert_invariant_for_all("swapped", ROUNDING, |s, _| s.swapped());
}

#[test]
fn swapping_or_mirroring_twice_changes_nothing() {
    assert_invariant_for_all("swapped twice", 0.0, |s, _| s.swapped().swapped());
    assert_invariant_for_all("mirrored twice", 0.0, |s, _| s.mirrored().mirrored());
}

#[test]
fn position_does_not_matter() {
    let near = |rng: &mut Rng| vec2(rng.between(-2.0, 2.0), rng.between(-2.0, 2.0));
    assert_invariant_for_all("moved", ROUNDING, |s, rng| s.translated(near(rng)));
    assert_invariant_for_all("far away", FAR_AWAY, |s, rng| {
        s.translated(distant_offset(rng))
    });
}

/// The rounding of the ground's points is all that is lost far away: brought back from there, with
/// the points so rounded, the mechanism is the same to the last bit.
#[test]
fn only_the_rounding_of_the_points_is_lost_far_away() {
    for case in CASES {
        for seed in SEEDS {
            let offset = distant_offset(&mut Rng(seed));
            let away = Setup::of(&case.scene()).translated(offset);
            let back = away.clone().translated(-offset);
            assert_invariant(case, &back, "there and back", 0.0, &[away]);
        }
    }
}

#[test]
fn everything_at_once_does_not_matter() {
    let all = |s: Setup, rng: &mut Rng| {
        s.reframed(rng)
            .mirrored()
            .shuffled(rng)
            .rotated(rng.between(-3.0, 3.0))
            .swapped()
            .renamed(rng)
            .translated(vec2(rng.between(-2.0, 2.0), rng.between(-2.0, 2.0)))
    };
    assert_invariant_for_all("all at once", ROUNDING, all);
    assert_invariant_for_all("all, far away", FAR_AWAY, |s, rng| {
        let offset = distant_offset(rng);
        all(s, rng).translated(offset)
    });
}

/// Bodies that turn together need one rough angle, no matter of which of them.
#[test]
fn the_rough_angle_of_any_body_of_a_class_is_enough() {
    let pairs = [
        ("single-dwell", ["guide", "slider"]),
        ("slotted-rocker", ["block", "rocker"]),
    ];
    for (name, pair) in pairs {
        let case = CASES.into_iter().find(|c| c.name == name).expect("a case");
        let original = Setup::of(&case.scene());
        for forgotten in pair {
            let mut setup = original.clone();
            let bodies = &setup.mechanism.bodies;
            let at = bodies.iter().position(|b| b.name == forgotten);
            setup.assembly.initial_guess[at.expect("a body")] = None;
            let changed = SEEDS.map(|seed| setup.clone().reframed(&mut Rng(seed)));
            assert_invariant(case, &original, forgotten, ROUNDING, &changed);
        }
    }
}

/// The same scene written in other units.
#[test]
fn units_do_not_matter() {
    const UNITS: [[(&str, f64); 4]; 3] = [
        [("m", 1.0), ("kg", 1.0), ("kg m2", 1.0), ("rad", 1.0)],
        [("mm", 1e-3), ("g", 1e-3), ("g mm2", 1e-9), ("deg", DEGREE)],
        [
            ("in", 0.0254),
            ("lb", 0.453_592_37),
            ("kg mm2", 1e-6),
            ("deg", DEGREE),
        ],
    ];
    for case in CASES {
        let table: Table = case.text().parse().expect("TOML");
        let original = Setup::of(&case.scene());
        for units in UNITS {
            let text = rewritten(&table, units).to_string();
            let scene =
                PlaneScene::parse("rewritten.toml", &text).unwrap_or_else(|e| panic!("{e:?}"));
            let setup = Setup::of(&scene).matched_by_name(&original.mechanism);
            assert_invariant(case, &original, units[0].0, ROUNDING, &[setup]);
        }
    }
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Some place 1e6 m away.
fn distant_offset(rng: &mut Rng) -> Vec2 {
    Vec2::from_angle(rng.between(-3.0, 3.0)) * 1e6
}

/// A scene with its numbers in other units of length, mass, inertia and angle.
fn rewritten(scene: &Table, to: [(&str, f64); 4]) -> Table {
    let mut scene = scene.clone();
    let worth = |key: &str| {
        let name = scene.get("units").and_then(|u| u.get(key));
        match name.and_then(Value::as_str) {
            None | Some("m" | "kg" | "kg m2" | "rad") => 1.0,
            Some("mm" | "g") => 1e-3,
            Some("g mm2") => 1e-9,
            Some("deg") => DEGREE,
            Some(other) => panic!("unit {other}"),
        }
    };
    let keys = ["length", "mass", "inertia", "angle"];
    let [length, mass, inertia, angle] = std::array::from_fn(|i| worth(keys[i]) / to[i].1);
    let bodies = scene["bodies"].as_table_mut().expect("bodies");
    for (_, body) in bodies {
        for (key, value) in body.as_table_mut().expect("a body") {
            match key.as_str() {
                "points" | "center" => scale(value, length),
                "mass" => scale(value, mass),
                "inertia" => scale(value, inertia),
                other => panic!("{other} of a body"),
            }
        }
    }
    if let Some(value) = scene.get_mut("assembly") {
        scale(value, angle);
    }
    for key in ["start", "speed"] {
        if let Some(value) = scene.get_mut("motion").and_then(|m| m.get_mut(key)) {
            scale(value, angle);
        }
    }
    let units = keys.into_iter().zip(to);
    let units: Table = units
        .map(|(key, (unit, _))| (key.into(), unit.into()))
        .collect();
    scene.insert("units".into(), Value::Table(units));
    scene
}

/// Every number of a value times a factor; the name of a point stays as it is.
fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Integer(number) => *value = Value::Float(*number as f64 * factor),
        Value::Float(number) => *number *= factor,
        Value::Array(items) => items.iter_mut().for_each(|item| scale(item, factor)),
        Value::Table(table) => table.iter_mut().for_each(|(_, item)| scale(item, factor)),
        _ => {}
    }
}
