//! What one evaluation of the reduced model costs, against the same mechanism written by hand.
//!
//! The machine's speed wanders, so the subjects take turns within one process, each at a new
//! coordinate every time (steps of the golden angle); the ratios are those of the fastest turns.
//! The hand-written evaluators are first held against Dwell's values.

mod bench;
mod hand_written;
mod hand_written_four_bar;
mod hand_written_general;

use bench::{Case, STEP, Subject, TURN, TURNS, reactions, stop};
use dwell_geometry::Reaction;
use dwell_kinetostatics::{Exact, Model, Reduced};
use dwell_scene::Scene;
use hand_written::HandWritten;
use hand_written_four_bar::{FourBar, SCENE, with_a_dyad};
use hand_written_general::General;
use std::f64::consts::TAU;
use std::hint::black_box;

fn main() {
    let dwell = Case::read("single-dwell");
    let normal: Vec<Reaction> = reactions(&dwell.scene, "slide.normal");
    let every = dwell.scene.mechanism.reactions();
    let (one, all) = (dwell.model(&normal), dwell.model(&every));
    let (hand, general) = (HandWritten::new(), General::new());
    agree(&hand, &general, &one, &all);

    let four_bar = Case::read("crank-rocker");
    let four_bar = four_bar.model(&four_bar.scene.requests.reactions);
    let six_bar = Case::read("class-three-six-bar");
    let near = (six_bar.scene.assembly.start[0] - 0.1, 0.2);
    let six_bar = six_bar.model(&six_bar.scene.requests.reactions);

    let by_hand = FourBar::new();
    let (bars, dyad) = (loaded(SCENE), loaded(&with_a_dyad()));
    let lean = dyad.0.clone().only_for(&dyad.1.mechanism, &[]);
    assert_eq!(lean.plan().skipped(), [false, true]);
    agree_in_force(&by_hand, &[&bars.0, &dyad.0, &lean]);
    let bare = dyad.0.without_reactions();
    let exact = Exact::new(dyad.0.clone());
    let exact = exact.unwrap_or_else(|| stop("four-bar", "it has several actuators"));

    let mut subjects = vec![
        Subject::new("single-dwell by hand, its own proportions", TURN, |q| {
            black_box(hand.at(q));
        }),
        Subject::new("single-dwell by hand, any lengths", TURN, |q| {
            black_box(general.at(q));
        }),
        coefficients("single-dwell, slide.normal", TURN, &one),
        coefficients("single-dwell, all 14 reactions", TURN, &all),
        inertia("single-dwell, m and m'/2", TURN, &one),
        curvature("single-dwell, m, m'/2 and m''/2 (dual)", TURN, &one),
    ];
    subjects.extend(stages(&one));
    subjects.extend([
        coefficients("crank-rocker, all reactions", TURN, &four_bar),
        inertia("crank-rocker, m and m'/2", TURN, &four_bar),
        coefficients("class-three six-bar, all reactions", near, &six_bar),
        inertia("class-three six-bar, m and m'/2", near, &six_bar),
    ]);

    let mut forces = vec![
        Subject::new("four-bar by hand: motion, action, reactions", TURN, |q| {
            black_box(by_hand.at(q, 8.0, 3.0));
        }),
        kinetostatics("four-bar: motion, action, all reactions", &bars.0),
        kinetostatics("… with a massless dyad that is modelled", &dyad.0),
        kinetostatics("… with a massless dyad that is skipped", &lean),
        reduced("m and m'/2 with the dyad modelled", &bare),
        inertia("m and m'/2 with the dyad skipped", TURN, &exact),
    ];

    for _ in 0..TURNS {
        for subject in subjects.iter_mut().chain(&mut forces) {
            subject.take_turn();
        }
    }
    print(&mut subjects);
    print_forces(&mut forces);
}

/// A mechanism under its loads with every reaction, and its scene.
fn loaded(text: &str) -> (Model, Scene) {
    let scene = Scene::parse("four-bar.toml", text);
    let scene = scene.unwrap_or_else(|e| stop("four-bar", &e.to_string()));
    let case = Case { scene };
    let model = case.model(&case.scene.mechanism.reactions());
    let loads = case.scene.loads.clone();
    let model = model.model().clone();
    let model = model.with_loads(&case.scene.mechanism, loads);
    let model = model.unwrap_or_else(|e| stop("four-bar", &e.to_string()));
    (model, case.scene)
}

fn kinetostatics<'a>(name: &'static str, model: &'a Model) -> Subject<'a> {
    let (mut work, mut actions) = (model.workspace(), model.actions());
    Subject::new(name, TURN, move |q| {
        let done = model.kinetostatics(0.0, &[q], &[8.0], &[3.0], &mut work, &mut actions);
        black_box(done.is_ok());
        black_box(&actions);
    })
}

fn reduced<'a>(name: &'static str, model: &'a Model) -> Subject<'a> {
    let (mut work, mut out) = (model.workspace(), model.coefficients());
    Subject::new(name, TURN, move |q| {
        black_box(model.reduce(q, &mut work, &mut out).is_ok());
        black_box(&out);
    })
}

/// Holds the four-bar's forces against those by hand, and the models with and without what is skipped
/// against each other to the last bit.
fn agree_in_force(hand: &FourBar, models: &[&Model; 3]) {
    let (mut largest, mut apart) = (0.0_f64, 0.0_f64);
    for step in 0..1000 {
        let q = (f64::from(step) * STEP).rem_euclid(TAU);
        let truth = hand.at(q, 8.0, 3.0);
        let found = models.map(|model| {
            let (mut work, mut actions) = (model.workspace(), model.actions());
            let done = model.kinetostatics(0.0, &[q], &[8.0], &[3.0], &mut work, &mut actions);
            done.unwrap_or_else(|e| stop("four-bar", &e.to_string()));
            let all = actions.tau.into_iter().chain(actions.reactions);
            // A zero may have either sign.
            all.take(9).map(|v| v + 0.0).collect::<Vec<f64>>()
        });
        assert_eq!(found[1], found[2], "skipping changes a bit");
        for (truth, found) in truth.iter().zip(&found[0]) {
            largest = largest.max(truth.abs());
            apart = apart.max((truth - found).abs());
        }
    }
    let scaled = apart / largest;
    assert!(scaled < 1e-12, "forces differ by {scaled:e} of the largest");
}

/// The four-bar's costs, to that by hand and of each pair to the one before.
fn print_forces(subjects: &mut [Subject<'_>]) {
    for subject in subjects.iter_mut() {
        subject.turns.sort_by(f64::total_cmp);
    }
    let hand = subjects[0].turns[0];
    println!("\nfour-bar under weight and a couple, ns          median    least / hand");
    for Subject { name, turns, .. } in subjects.iter() {
        let (median, least) = (turns[turns.len() / 2], turns[0]);
        println!("{name:45}{median:9.1}{least:9.1}{:7.2}", least / hand);
    }
    let saved = |with: usize| 1.0 - subjects[with + 1].turns[0] / subjects[with].turns[0];
    println!(
        "skipping a dyad of two saves {:.0} % of a kinetostatic pose, {:.0} % of m and m'/2",
        100.0 * saved(2),
        100.0 * saved(4)
    );
}

fn print(subjects: &mut [Subject<'_>]) {
    for subject in subjects.iter_mut() {
        subject.turns.sort_by(f64::total_cmp);
    }
    let [hand, general] = [0, 1].map(|i: usize| subjects[i].turns[0]);
    println!("ns per evaluation                          median    least  / own   / any");
    for Subject { name, turns, .. } in subjects {
        let (median, least) = (turns[turns.len() / 2], turns[0]);
        let (own, any) = (least / hand, least / general);
        println!("{name:42}{median:7.1}  {least:7.1}{own:7.2}{any:8.2}");
    }
}

fn coefficients<'a>(name: &'static str, range: (f64, f64), model: &'a Exact) -> Subject<'a> {
    let mut work = model.work();
    let mut out = model.model().coefficients();
    Subject::new(name, range, move |q| {
        black_box(model.coefficients(q, &mut work, &mut out).is_ok());
        black_box(&out);
    })
}

fn inertia<'a>(name: &'static str, range: (f64, f64), model: &'a Exact) -> Subject<'a> {
    let mut work = model.work();
    Subject::new(name, range, move |q| {
        black_box(model.inertia(q, &mut work).ok());
    })
}

fn curvature<'a>(name: &'static str, range: (f64, f64), model: &'a Exact) -> Subject<'a> {
    let mut work = model.work();
    Subject::new(name, range, move |q| {
        black_box(model.curvature(q, &mut work).ok());
    })
}

/// The stages of geometry, each with those before it.
fn stages(model: &Exact) -> [Subject<'_>; 4] {
    let plan = model.model().plan();
    let subject = |name, count: usize| {
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        let mut balance = plan.balance::<f64, 2>();
        Subject::new(name, TURN, move |q| {
            black_box(plan.place(&[q], &mut pose).is_ok());
            if count > 1 {
                plan.speeds(&pose, &[1.0], &mut motion);
            }
            if count > 2 {
                plan.accelerations(&pose, &[0.0], &mut motion);
            }
            if count > 3 {
                plan.multipliers(&pose, &mut balance);
                // It leaves sums in what it was given.
                balance.moment.fill([1.0; 2]);
                black_box(&balance);
            }
            black_box((&pose, &motion));
        })
    };
    [
        subject("  of which place", 1),
        subject("  … and speeds", 2),
        subject("  … and accelerations", 3),
        subject("  … and multipliers, two runs", 4),
    ]
}

/// Holds every evaluator's values against the others', scaled by the largest of each kind.
fn agree(hand: &HandWritten, general: &General, one: &Exact, all: &Exact) {
    let (mut work, mut out) = (one.work(), one.model().coefficients());
    let (mut work_all, mut out_all) = (all.work(), all.model().coefficients());
    let mechanism_order = all.model().reactions();
    let normal = one.model().reactions()[0];
    let place = mechanism_order.iter().position(|&r| r == normal);
    let place = place.unwrap_or_else(|| stop("single-dwell", "slide.normal is missing"));
    let (mut largest, mut apart) = ([0.0_f64; 4], [0.0_f64; 4]);
    for step in 0..10_000 {
        let q = (f64::from(step) * STEP).rem_euclid(TAU);
        let truth = hand.at(q);
        let done = one
            .coefficients(q, &mut work, &mut out)
            .and_then(|()| all.coefficients(q, &mut work_all, &mut out_all))
            .and_then(|()| Ok((one.inertia(q, &mut work)?, one.curvature(q, &mut work)?)));
        let (pair, curved) = done.unwrap_or_else(|e| stop("single-dwell", &e.to_string()));
        let [a, b] = [truth[2], truth[3]];
        for other in [
            general.at(q),
            [out.m, out.half_dm, out.a[0], out.b[0]],
            [
                out_all.m,
                out_all.half_dm,
                out_all.a[place],
                out_all.b[place],
            ],
            [pair.0, pair.1, a, b],
            [curved.m, curved.half_dm, a, b],
        ] {
            for i in 0..4 {
                largest[i] = largest[i].max(truth[i].abs());
                apart[i] = apart[i].max((other[i] - truth[i]).abs());
            }
        }
    }
    for (name, i) in [("m", 0), ("m'/2", 1), ("a", 2), ("b", 3)] {
        let scaled = apart[i] / largest[i];
        assert!(
            scaled < 1e-12,
            "{name} differs by {scaled:e} of its largest"
        );
    }
}
