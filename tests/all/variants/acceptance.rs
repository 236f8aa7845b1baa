//! Variants about the borders of what is accepted: cranks that just turn or just do not, loops that open somewhere on
//! the turn, poses at which a compilation takes the other branch, lengths next to those of a change point, numbers that
//! do not fit the structure. Each is left to compilation, or equals the model that is compiled for it.

use super::{compile, difference, expected, random};
use dwell_geometry::{Range, vec2};
use dwell_kinetostatics::Mass;
use dwell_kinetostatics::variants::{Turn, TurningVariant, VariantModel};
use dwell_scene::PlaneScene;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Variants of each family.
const VARIANTS: usize = 160;
/// Largest differences, as a part of the curve's largest magnitude. Next to a change point, where a curve has no more digits,
/// 3.5e-12 are seen; where the mass has no share in it 1.2e-14, of folded dyads and the other branch 9.1e-14; of numbers 6.5e-15.
const NEAR_CHANGE_POINT: f64 = 1e-10;
const CLEAR: f64 = 1e-12;
const OF_NUMBERS: f64 = 5e-13;
/// Distance of E from A on the crank, m.
const CRANK_POINT: f64 = 0.6;
/// The approximate angle of the bar EF in the assembly, rad.
const ARM_GUESS: f64 = 2.7;
/// Crank, coupler, rocker and ground of a four-bar whose crank turns, m.
const BARS: [f64; 4] = [1.0, 3.2, 2.7, 4.5];
/// Ground of the second dyad (length and direction), and its two bars, m.
const DYAD: [f64; 4] = [3.0, 2.0, 2.2, 1.5];

/// A four-bar A B C D with a second dyad E F G from its crank to the ground. Its assembly is the same in all variants.
#[derive(Clone, Copy)]
struct Linkage {
    /// Crank, coupler, rocker and ground, m.
    bars: [f64; 4],
    /// AE, m.
    crank_point: f64,
    /// Direction of the ground AD, rad.
    direction: f64,
    /// AG and its direction, then EF and GF.
    dyad: [f64; 4],
    /// Mass and inertia of all bodies but the crank, as a part of those of bars of 1 kg; none without.
    mass: f64,
    /// The coupler's approximate angle, rad.
    coupler_guess: f64,
}

impl Linkage {
    fn new(mass: f64) -> Self {
        Self {
            bars: BARS,
            crank_point: CRANK_POINT,
            direction: 0.0,
            dyad: DYAD,
            mass,
            coupler_guess: 0.5,
        }
    }

    fn scene(&self) -> PlaneScene {
        let [crank, coupler, rocker, ground] = self.bars;
        let [reach, angle, arm, tip] = self.dyad;
        let crank_point = self.crank_point;
        let turned = |length: f64, (sin, cos): (f64, f64)| [length * cos, length * sin];
        let d = turned(ground, self.direction.sin_cos());
        let g = turned(reach, angle.sin_cos());
        let inertia = |length: f64| match self.mass {
            0.0 => String::new(),
            mass => {
                let (center, inertia) = ([0.4 * length, 0.1], 0.1 * mass * length);
                format!("mass = {mass:?}\ncenter = {center:?}\ninertia = {inertia:?}\n")
            }
        };
        let body = |name: &str, points: &str, length: f64| {
            let points = points.replace("end", &format!("[{length:?}, 0]"));
            format!(
                "[bodies.{name}]\npoints = {{ {points} }}\n{}",
                inertia(length)
            )
        };
        let bodies = [
            body("coupler", "B = [0, 0], C = end", coupler),
            body("rocker", "D = [0, 0], C = end", rocker),
            body("arm", "E = [0, 0], F = end", arm),
            body("tip", "G = [0, 0], F = end", tip),
        ];
        let text = format!(
            r#"
[bodies.ground]
points = {{ A = [0, 0], D = {d:?}, G = {g:?} }}
[bodies.crank]
points = {{ A = [0, 0], B = [{crank:?}, 0], E = [{crank_point:?}, 0] }}
mass = 1.0
center = [0.3, 0.05]
inertia = 0.4
{}
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "coupler.B"] }}
C = {{ revolute = ["coupler.C", "rocker.C"] }}
D = {{ revolute = ["ground.D", "rocker.D"] }}
E = {{ revolute = ["crank.E", "arm.E"] }}
F = {{ revolute = ["arm.F", "tip.F"] }}
G = {{ revolute = ["ground.G", "tip.G"] }}
[actuators]
phi = {{ angle = ["ground", "crank"] }}
[assembly]
phi = 1.0
coupler = {:?}
arm = {ARM_GUESS:?}
"#,
            bodies.concat(),
            self.coupler_guess
        );
        PlaneScene::parse("linkage", &text).expect("a scene")
    }
}

/// A distance from a border, of either sign and of any size down to rounding.
fn offset(number: u64) -> f64 {
    let size = 10.0_f64.powf(-0.4 - 15.0 * random(3 * number).abs());
    size.copysign(random(3 * number + 1))
}

/// By how much a variant is turned, rad: not at all in one of eight, whose crank is along the ground at a position of the
/// rules.
fn shift(number: u64) -> f64 {
    let shift = 0.1 * random(3 * number + 2);
    if number.is_multiple_of(8) { 0.0 } else { shift }
}

/// What becomes of the variants of a family.
#[derive(Debug, Default, PartialEq)]
struct Outcome {
    accepted: usize,
    /// Left to compilation, which finds that they turn fully, or that they do not.
    left_turning: usize,
    left_other: usize,
    /// Accepted, but compilation fails or finds that they do not turn fully.
    wrong: usize,
    /// The largest difference of the accepted ones from those compiled.
    difference: f64,
}

/// Compares the variants of a structure with models compiled for each.
fn compare(structure: &VariantModel, variants: &[PlaneScene], reaction: &str) -> Outcome {
    let mechanism = &variants[0].mechanism;
    let mut reactions = mechanism.reactions().into_iter();
    let reaction = reactions.find(|&r| mechanism.reaction_name(r) == reaction);
    let reaction = reaction.expect("a reaction");
    let starts: Vec<f64> = (0..variants.len()).map(|k| PI * random(k as u64)).collect();
    let numbers = |scene: &PlaneScene| structure.numbers(&scene.mechanism, &scene.masses, &[]);
    let numbers: Vec<_> = variants.iter().map(numbers).collect();
    let fitting: Vec<usize> = (0..variants.len())
        .filter(|&k| numbers[k].is_some())
        .collect();
    let mut turns: Vec<Option<Turn>> = vec![None; variants.len()];
    let mut fill = |i: usize, to: &mut [f64]| {
        to.copy_from_slice(numbers[fitting[i]].as_ref().expect("the structure"));
        starts[fitting[i]]
    };
    let mut done = |i: usize, variant: Option<TurningVariant<'_>>| {
        turns[fitting[i]] = variant.map(|variant| variant.turn.clone());
    };
    structure.turns(0..fitting.len(), &mut fill, &mut done);
    let each = variants.par_iter().zip(&turns).zip(&starts);
    let each = each.map(|((scene, turn), &start)| {
        let model = compile(scene, reaction);
        let turning = model.filter(|model| model.plan().range() == Range::Full);
        let mut outcome = Outcome::default();
        match (turn, turning) {
            (Some(turn), Some(model)) => {
                let compiled = expected(model.clone(), start, Some(turn)).expect("one actuator");
                outcome.accepted = 1;
                outcome.difference = difference(turn, &compiled, &model);
            }
            (Some(_), None) => outcome.wrong = 1,
            (None, Some(_)) => outcome.left_turning = 1,
            (None, None) => outcome.left_other = 1,
        }
        outcome
    });
    each.reduce(Outcome::default, |a, b| Outcome {
        accepted: a.accepted + b.accepted,
        left_turning: a.left_turning + b.left_turning,
        left_other: a.left_other + b.left_other,
        wrong: a.wrong + b.wrong,
        difference: a.difference.max(b.difference),
    })
}

/// The structure of a scene's model with one reaction.
fn structure(scene: &PlaneScene, reaction: &str) -> VariantModel {
    let mechanism = &scene.mechanism;
    let mut reactions = mechanism.reactions().into_iter();
    let reaction = reactions.find(|&r| mechanism.reaction_name(r) == reaction);
    let model = compile(scene, reaction.expect("a reaction")).expect("a model");
    VariantModel::new(model).expect("a structure")
}

/// Compares a family, and asserts that none is accepted wrongly and that there are variants on both sides of the border.
fn check_family(name: &str, tolerance: f64, typical: &Linkage, vary: impl Fn(u64) -> Linkage) {
    let structure = structure(&typical.scene(), "A.x");
    let variants: Vec<PlaneScene> = (0..VARIANTS as u64).map(|k| vary(k).scene()).collect();
    let outcome = compare(&structure, &variants, "A.x");
    println!("{name}: {outcome:?}");
    assert_eq!(outcome.wrong, 0, "{name}");
    assert!(outcome.difference < tolerance, "{name}: {outcome:?}");
    assert!(
        outcome.accepted > 0 && outcome.left_other > 0,
        "{name}: {outcome:?}"
    );
}

#[test]
fn val_variants_about_the_grashof_border_are_left_or_equal() {
    for (mass, tolerance) in [(1.0, NEAR_CHANGE_POINT), (0.0, CLEAR)] {
        let typical = Linkage::new(mass);
        // The crank opposite to the ground, where the dyad is stretched.
        check_family("stretched", tolerance, &typical, |k| {
            let mut linkage = typical;
            linkage.direction = shift(k);
            let [crank, coupler, rocker, ground] = &mut linkage.bars;
            *ground = *coupler + *rocker - *crank - offset(k);
            linkage
        });
        // The crank along the ground, where the dyad is folded.
        let mut typical = typical;
        (typical.bars, typical.coupler_guess) = ([1.0, 3.2, 1.9, 2.7], 0.4);
        check_family("folded", CLEAR, &typical, |k| {
            let mut linkage = typical;
            linkage.direction = shift(k);
            let [crank, coupler, rocker, ground] = &mut linkage.bars;
            *ground = *crank + *coupler - *rocker + offset(k);
            linkage
        });
    }
}

#[test]
fn val_variants_whose_second_loop_opens_are_left_or_equal() {
    for (mass, tolerance) in [(1.0, NEAR_CHANGE_POINT), (0.0, CLEAR)] {
        let typical = Linkage::new(mass);
        check_family("second loop", tolerance, &typical, |k| {
            let mut linkage = typical;
            let [ground, direction, arm, tip] = &mut linkage.dyad;
            *direction += shift(k);
            *tip = *ground + CRANK_POINT - *arm + 0.5 * offset(k);
            linkage
        });
    }
}

#[test]
fn val_variants_that_assemble_on_the_other_branch_are_left() {
    // With the approximate angle of the coupler along the diagonal BD, both branches are equally near.
    let (sin, cos) = 1.0_f64.sin_cos();
    let mut typical = Linkage::new(1.0);
    typical.coupler_guess = (-sin).atan2(BARS[3] - cos);
    typical.direction = 0.25;
    check_family("other branch", CLEAR, &typical, |k| {
        let mut linkage = typical;
        linkage.direction = offset(k);
        linkage
    });
    // The same of the second loop: by the sines of the triangle A E G, its arm's approximate angle is along EG.
    let mut typical = Linkage::new(1.0);
    let ambiguous = ARM_GUESS - (CRANK_POINT * (ARM_GUESS - 1.0).sin() / DYAD[0]).asin();
    typical.dyad[1] = ambiguous - 0.25;
    check_family("other branch of the second loop", CLEAR, &typical, |k| {
        let mut linkage = typical;
        linkage.dyad[1] = ambiguous + offset(k);
        linkage
    });
}

/// The mass properties of a body of a scene, by its name.
fn mass_of<'a>(scene: &'a mut PlaneScene, body: &str) -> &'a mut Mass {
    let mut bodies = scene.mechanism.bodies.iter();
    let index = bodies.position(|b| b.name == body).expect("a body");
    &mut scene.masses[index]
}

#[test]
fn val_numbers_that_do_not_fit_the_structure_are_left_or_equal() {
    let mut full = Linkage::new(1.0);
    // The crank turns with E anywhere between A and B.
    full.dyad[3] = 2.3;
    let with = |change: &dyn Fn(&mut Mass)| {
        let mut scene = full.scene();
        change(mass_of(&mut scene, "coupler"));
        scene
    };
    let at = |crank_point: f64| {
        let linkage = Linkage {
            crank_point,
            ..full
        };
        linkage.scene()
    };
    let cases = [
        // Mass where the structure has inertia alone, and the other way.
        (
            "mass",
            with(&|m| m.mass = 0.0),
            with(&|m| m.center = vec2(0.0, 0.0)),
        ),
        ("no mass", full.scene(), with(&|m| m.mass = 0.0)),
        ("massless", full.scene(), with(&|m| *m = Mass::default())),
        ("body", with(&|m| *m = Mass::default()), full.scene()),
        // A centre beside the origin that it is in.
        ("centre", with(&|m| m.center = vec2(0.0, 0.0)), full.scene()),
        // Points that are one in the structure, and points that are one in the variant.
        ("one point", at(1.0), full.scene()),
        ("two points", full.scene(), at(1.0)),
        // A vector that vanishes in the structure, or in the variant.
        ("vanished", at(0.0), full.scene()),
        ("vanishes", full.scene(), at(0.0)),
        // What is no mass.
        ("negative", full.scene(), with(&|m| m.mass = -0.1)),
        (
            "negative inertia",
            full.scene(),
            with(&|m| m.inertia = -0.1),
        ),
        ("no number", full.scene(), with(&|m| m.inertia = f64::NAN)),
        ("infinite", full.scene(), with(&|m| m.mass = f64::INFINITY)),
        ("no centre", full.scene(), with(&|m| m.center.x = f64::NAN)),
    ];
    for (name, typical, variant) in cases {
        // Twice: what a variant leaves in the structure is not to matter to the next one.
        let variants = [variant.clone(), typical.clone(), variant];
        let outcome = compare(&structure(&typical, "A.x"), &variants, "A.x");
        println!("{name}: {outcome:?}");
        assert_eq!(outcome.wrong, 0, "{name}");
        assert!(outcome.difference < OF_NUMBERS, "{name}: {outcome:?}");
        assert!(outcome.accepted > 0, "{name}: {outcome:?}");
    }
}
