//! Time of one evaluation of the reduced model, compared with the same mechanism written by hand.
//!
//! The machine's speed wanders, so the subjects take turns within one process, each at a new
//! coordinate every time (steps of the golden angle); the ratios are those of the fastest turns.
//! The hand-written evaluators are first held against Dwell's values.

mod bench;
mod closed_form;
mod closed_form_four_bar;
mod closed_form_general;

use bench::{Case, FULL_REVOLUTION, GOLDEN_ANGLE, ROUNDS, Subject, reactions, stop};
use closed_form::ClosedForm;
use closed_form_four_bar::{FourBar, SCENE, with_a_dyad};
use closed_form_general::General;
use dwell_geometry::Reaction;
use dwell_kinetostatics::{Coefficients, ExactModel, Model, ReducedModel, space};
use dwell_scene::{PlaneScene, SpaceScene};
use std::f64::consts::TAU;
use std::hint::black_box;

// Long because it lists what is measured.
fn main() {
    let dwell = Case::read("single-dwell");
    let normal: Vec<Reaction> = reactions(&dwell.scene, "slide.normal");
    let all_reactions = dwell.scene.mechanism.reactions();
    let (one, all) = (dwell.model(&normal), dwell.model(&all_reactions));
    let (closed_form, general) = (ClosedForm::new(), General::new());
    agree(&closed_form, &general, &one, &all);

    let four_bar = Case::read("crank-rocker");
    let four_bar = four_bar.model(&four_bar.scene.requests.reactions);
    let six_bar = Case::read("class-three-six-bar");
    let near = (six_bar.scene.assembly.coordinates[0] - 0.1, 0.2);
    let six_bar = six_bar.model(&six_bar.scene.requests.reactions);

    let one_force = Case::read("crank-rocker");
    let one_force = one_force.model(&one_force.scene.requests.reactions[..1]);
    let rssr = in_space("rssr", "B.x");
    // The crank-rocker once more, in an oblique plane.
    let oblique = in_space("planar-oblique-4r", "A.x");
    let bricard = in_space("bricard-a04", "P2.moment-x");

    let closed_form_four_bar = FourBar::new();
    let (bars, dyad) = (loaded_model(SCENE), loaded_model(&with_a_dyad()));
    let pruned = dyad.0.clone().pruned_for(&[]);
    assert_eq!(pruned.plan().pruned_groups(), [false, true]);
    agree_in_force(&closed_form_four_bar, &[&bars.0, &dyad.0, &pruned]);
    let without_reactions = dyad.0.without_reactions();
    let exact = ExactModel::new(dyad.0.clone())
        .unwrap_or_else(|| stop("four-bar", "it has several actuators"));

    let mut subjects = vec![
        Subject::new(
            "single-dwell by hand, its own proportions",
            FULL_REVOLUTION,
            |q| {
                black_box(closed_form.at(q));
            },
        ),
        Subject::new("single-dwell by hand, any lengths", FULL_REVOLUTION, |q| {
            black_box(general.at(q));
        }),
        coefficients("single-dwell, slide.normal", FULL_REVOLUTION, &one),
        coefficients("single-dwell, all 14 reactions", FULL_REVOLUTION, &all),
        inertia("single-dwell, m and m'/2", FULL_REVOLUTION, &one),
        inertia_derivatives(
            "single-dwell, m, m'/2 and m''/2 (dual)",
            FULL_REVOLUTION,
            &one,
        ),
    ];
    subjects.extend(stages(&one));
    subjects.extend([
        coefficients("crank-rocker, all reactions", FULL_REVOLUTION, &four_bar),
        inertia("crank-rocker, m and m'/2", FULL_REVOLUTION, &four_bar),
        coefficients("class-three six-bar, all reactions", near, &six_bar),
        inertia("class-three six-bar, m and m'/2", near, &six_bar),
        coefficients(
            "four-bar linkage in space (RSSR), a force",
            FULL_REVOLUTION,
            &rssr,
        ),
        coefficients("Bricard linkage, a moment", (0.3, 2.5), &bricard),
        coefficients("crank-rocker, a force", FULL_REVOLUTION, &one_force),
        coefficients("… in an oblique plane, a force", FULL_REVOLUTION, &oblique),
        inertia("… and m and m'/2", FULL_REVOLUTION, &oblique),
    ]);
    subjects.extend(stages_in_space(&rssr));

    let mut forces = vec![
        Subject::new(
            "four-bar by hand: motion, actuator force, reactions",
            FULL_REVOLUTION,
            |q| {
                black_box(closed_form_four_bar.at(q, 8.0, 3.0));
            },
        ),
        kinetostatics("four-bar: motion, actuator force, all reactions", &bars.0),
        kinetostatics("… with a massless dyad that is modelled", &dyad.0),
        kinetostatics("… with a massless dyad that is skipped", &pruned),
        reduced("m and m'/2 with the dyad modelled", &without_reactions),
        inertia("m and m'/2 with the dyad skipped", FULL_REVOLUTION, &exact),
    ];

    for _ in 0..ROUNDS {
        for subject in subjects.iter_mut().chain(&mut forces) {
            subject.run_round();
        }
    }
    print(&mut subjects);
    print_forces(&mut forces);
}

/// A mechanism in space with one of its reactions.
fn in_space(name: &str, reaction: &str) -> ExactModel<space::Model> {
    let path = format!(
        "{}/../../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let scene = SpaceScene::read(path).unwrap_or_else(|e| stop(name, &e.to_string()));
    let all = scene.requests.reactions.iter().copied();
    let wanted: Vec<_> = all
        .filter(|&r| scene.reaction_name(r) == reaction)
        .collect();
    assert_eq!(wanted.len(), 1, "{reaction}");
    let model = space::Model::new(&scene.mechanism, &scene.masses, &scene.assembly, &wanted)
        .unwrap_or_else(|e| stop(name, &e.to_string()));
    ExactModel::new(model).unwrap_or_else(|| stop(name, "it has several actuators"))
}

/// A mechanism under its loads with every reaction, and its scene.
fn loaded_model(text: &str) -> (Model, PlaneScene) {
    let scene = PlaneScene::parse("four-bar.toml", text)
        .unwrap_or_else(|e| stop("four-bar", &e.to_string()));
    let case = Case { scene };
    let model = case.model(&case.scene.mechanism.reactions());
    let loads = case.scene.loads.clone();
    let model = model.model().clone().with_loads(loads);
    let model = model.unwrap_or_else(|e| stop("four-bar", &e.to_string()));
    (model, case.scene)
}

fn kinetostatics<'a>(name: &'static str, model: &'a Model) -> Subject<'a> {
    let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
    Subject::new(name, FULL_REVOLUTION, move |q| {
        let done = model.kinetostatics(0.0, &[q], &[8.0], &[3.0], &mut workspace, &mut result);
        black_box(done.is_ok());
        black_box(&result);
    })
}

fn reduced<'a>(name: &'static str, model: &'a Model) -> Subject<'a> {
    let (mut workspace, mut out) = (model.workspace(), model.coefficient_buffer());
    Subject::new(name, FULL_REVOLUTION, move |q| {
        black_box(model.reduce(q, &mut workspace, &mut out).is_ok());
        black_box(&out);
    })
}

/// Compares the four-bar's forces with those by hand, and the models with and without skipped parts to the last bit.
fn agree_in_force(closed_form: &FourBar, models: &[&Model; 3]) {
    let (mut largest, mut difference) = (0.0_f64, 0.0_f64);
    for step in 0..1000 {
        let q = (f64::from(step) * GOLDEN_ANGLE).rem_euclid(TAU);
        let reference = closed_form.at(q, 8.0, 3.0);
        let found = models.map(|model| {
            let (mut workspace, mut result) = (model.workspace(), model.result_buffer());
            let done = model.kinetostatics(0.0, &[q], &[8.0], &[3.0], &mut workspace, &mut result);
            done.unwrap_or_else(|e| stop("four-bar", &e.to_string()));
            let all = result.tau.into_iter().chain(result.reactions);
            // A zero may have either sign.
            all.take(9).map(|v| v + 0.0).collect::<Vec<f64>>()
        });
        assert_eq!(found[1], found[2], "skipping changes a bit");
        for (reference, found) in reference.iter().zip(&found[0]) {
            largest = largest.max(reference.abs());
            difference = difference.max((reference - found).abs());
        }
    }
    let scaled = difference / largest;
    assert!(scaled < 1e-12, "forces differ by {scaled:e} of the largest");
}

/// The four-bar's costs, to that by hand and of each pair to the one before.
fn print_forces(subjects: &mut [Subject<'_>]) {
    for subject in subjects.iter_mut() {
        subject.times.sort_by(f64::total_cmp);
    }
    let closed_form = subjects[0].times[0];
    println!("\nfour-bar under weight and a couple, ns          median    least / hand");
    for Subject { name, times, .. } in subjects.iter() {
        let (median, min_ns) = (times[times.len() / 2], times[0]);
        println!(
            "{name:45}{median:9.1}{min_ns:9.1}{:7.2}",
            min_ns / closed_form
        );
    }
    let saved = |with: usize| 1.0 - subjects[with + 1].times[0] / subjects[with].times[0];
    println!(
        "skipping a dyad of two saves {:.0} % of a kinetostatic pose, {:.0} % of m and m'/2",
        100.0 * saved(2),
        100.0 * saved(4)
    );
}

fn print(subjects: &mut [Subject<'_>]) {
    for subject in subjects.iter_mut() {
        subject.times.sort_by(f64::total_cmp);
    }
    let [closed_form, general] = [0, 1].map(|i: usize| subjects[i].times[0]);
    println!("ns per evaluation                          median    least  / own   / any");
    for Subject { name, times, .. } in subjects {
        let (median, min_ns) = (times[times.len() / 2], times[0]);
        let (own, any) = (min_ns / closed_form, min_ns / general);
        println!("{name:42}{median:7.1}  {min_ns:7.1}{own:7.2}{any:8.2}");
    }
}

fn coefficients<'a, R: ReducedModel>(
    name: &'static str,
    range: (f64, f64),
    model: &'a R,
) -> Subject<'a> {
    let mut workspace = model.workspace();
    let zeros = vec![0.0; model.reactions()];
    let mut out = Coefficients {
        a: zeros.clone(),
        b: zeros,
        ..Coefficients::default()
    };
    Subject::new(name, range, move |q| {
        black_box(model.coefficients(q, &mut workspace, &mut out).is_ok());
        black_box(&out);
    })
}

fn inertia<'a, R: ReducedModel>(
    name: &'static str,
    range: (f64, f64),
    model: &'a R,
) -> Subject<'a> {
    let mut workspace = model.workspace();
    Subject::new(name, range, move |q| {
        black_box(model.inertia(q, &mut workspace).ok());
    })
}

fn inertia_derivatives<'a>(
    name: &'static str,
    range: (f64, f64),
    model: &'a ExactModel,
) -> Subject<'a> {
    let mut workspace = model.workspace();
    Subject::new(name, range, move |q| {
        black_box(model.inertia_derivatives(q, &mut workspace).ok());
    })
}

/// The stages of geometry, each with those before it.
fn stages(model: &ExactModel) -> [Subject<'_>; 4] {
    let plan = model.model().plan();
    let subject = |name, count: usize| {
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        let mut balance = plan.force_balance::<f64, 2>();
        Subject::new(name, FULL_REVOLUTION, move |q| {
            black_box(plan.positions(&[q], &mut pose).is_ok());
            if count > 1 {
                plan.velocities(&pose, &[1.0], &mut motion);
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

/// The stages of an evaluation in space.
fn stages_in_space(model: &ExactModel<space::Model>) -> [Subject<'_>; 4] {
    let plan = model.model().plan();
    let subject = |name, count: usize| {
        let (mut pose, mut forces) = (plan.pose(), plan.forces::<f64, 2>());
        Subject::new(name, FULL_REVOLUTION, move |q| {
            black_box(plan.positions(&[q], &mut pose).is_ok());
            if count > 1 {
                plan.velocities(&[1.0], &mut pose);
            }
            if count > 2 {
                plan.accelerations(&[0.0], &mut pose);
            }
            if count > 3 {
                plan.balance(&pose, &mut forces);
                black_box(&forces);
            }
            black_box(&pose);
        })
    };
    [
        subject("  RSSR: of which positions", 1),
        subject("  … and velocities", 2),
        subject("  … and accelerations", 3),
        subject("  … and forces, two passes", 4),
    ]
}

/// Holds every evaluator's values against the others', scaled by the largest of each kind.
fn agree(closed_form: &ClosedForm, general: &General, one: &ExactModel, all: &ExactModel) {
    let (mut workspace, mut out) = (one.workspace(), one.model().coefficient_buffer());
    let (mut workspace_all, mut out_all) = (all.workspace(), all.model().coefficient_buffer());
    let mechanism_order = all.model().reactions();
    let normal = one.model().reactions()[0];
    let index = mechanism_order.iter().position(|&r| r == normal);
    let index = index.unwrap_or_else(|| stop("single-dwell", "slide.normal is missing"));
    let (mut largest, mut difference) = ([0.0_f64; 4], [0.0_f64; 4]);
    for step in 0..10_000 {
        let q = (f64::from(step) * GOLDEN_ANGLE).rem_euclid(TAU);
        let reference = closed_form.at(q);
        let done = one
            .coefficients(q, &mut workspace, &mut out)
            .and_then(|()| all.coefficients(q, &mut workspace_all, &mut out_all))
            .and_then(|()| {
                Ok((
                    one.inertia(q, &mut workspace)?,
                    one.inertia_derivatives(q, &mut workspace)?,
                ))
            });
        let (pair, curved) = done.unwrap_or_else(|e| stop("single-dwell", &e.to_string()));
        let [a, b] = [reference[2], reference[3]];
        for other in [
            general.at(q),
            [out.m, out.half_dm, out.a[0], out.b[0]],
            [
                out_all.m,
                out_all.half_dm,
                out_all.a[index],
                out_all.b[index],
            ],
            [pair.0, pair.1, a, b],
            [curved.m, curved.half_dm, a, b],
        ] {
            for i in 0..4 {
                largest[i] = largest[i].max(reference[i].abs());
                difference[i] = difference[i].max((other[i] - reference[i]).abs());
            }
        }
    }
    for (name, i) in [("m", 0), ("m'/2", 1), ("a", 2), ("b", 3)] {
        let scaled = difference[i] / largest[i];
        assert!(
            scaled < 1e-12,
            "{name} differs by {scaled:e} of its largest"
        );
    }
}
