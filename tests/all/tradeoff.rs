//! What accuracy costs: the study's truth, its errors and its fronts.

use crate::world::{home, scene};
use dwell_dynamics::Method;
use dwell_geometry::{PlaceError, Range};
use dwell_kinetostatics::{Coefficients, Exact, ExactWork, Inertia, Reduced};
use dwell_scene::Scene;
use dwell_study::silent;
use dwell_study::tradeoff::{
    ByModel, Effort, Evaluation, Evaluator, Integrator, Measured, Price, Quantity, Tradeoff,
    measure, measure_with,
};

/// By method, the order in which its error falls with the number of its steps; a variable one has none.
fn order(method: Method) -> Option<f64> {
    match method {
        Method::Bdf => None,
        Method::Esdirk34 => Some(4.0),
        Method::TrBdf2 => Some(2.0),
        Method::Tsit45 => Some(5.0),
        Method::Dop853 => Some(8.0),
    }
}

fn effort(tolerances: &[i32], tables: &[f64]) -> Effort {
    Effort {
        tolerances: tolerances.to_vec(),
        tables: tables.to_vec(),
        budget: 5_000,
        repetitions: 1,
    }
}

fn study(name: &str, effort: &Effort) -> Tradeoff {
    measure(&scene(name), effort, &silent).expect("a study")
}

/// The exact runs of a method, from the coarsest tolerance on.
fn exact(found: &Tradeoff, method: Method) -> Vec<&Measured> {
    let own = |p: &&Measured| {
        p.combination.evaluation == Evaluation::Exact
            && matches!(p.combination.integrator, Integrator::Steps(m, _) if m == method)
    };
    found.points.iter().filter(own).collect()
}

fn with(found: &Tradeoff, integrator: Integrator, name: &str) -> Measured {
    let own = |p: &&Measured| {
        p.combination.integrator == integrator && p.combination.evaluation.name() == name
    };
    *found.points.iter().find(own).expect("such a combination")
}

#[test]
fn the_truth_is_known_better_than_anything_on_the_front() {
    let effort = effort(&[-3, -5, -7, -9, -11], &[1e-6]);
    for name in ["crank-rocker", "single-dwell", "double-pendulum", "boom"] {
        let found = study(name, &effort);
        for quantity in Quantity::ALL {
            let front = found.front(quantity, Price::Evaluations);
            assert!(front.len() > 3, "{name}: {front:?}");
            for k in front {
                let point = &found.points[k];
                assert!(
                    !found.below(point, quantity),
                    "{name}: {quantity:?} of {} is below {:?}",
                    point.combination.name(),
                    found.truth.floor
                );
            }
        }
    }
}

/// A method that obeys its tolerance errs less at a hundredth of it: five times less at least, for the
/// global error falls unevenly (the worst pair here is 13).
#[test]
fn errors_fall_with_the_tolerance() {
    let effort = effort(&[-5, -7, -9], &[]);
    for name in ["crank-rocker", "single-dwell", "double-pendulum"] {
        let found = study(name, &effort);
        for method in Method::ALL {
            for pair in exact(&found, method).windows(2) {
                for quantity in Quantity::ALL {
                    let [before, after] = [0, 1].map(|k| pair[k].errors.of(quantity));
                    let at = pair[1].combination.name();
                    assert!(
                        after < before / 5.0,
                        "{name}, {at}: {quantity:?} {before:e} {after:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn no_point_is_cheaper_and_better_than_one_of_the_front() {
    let found = study(
        "single-dwell",
        &effort(&[-3, -5, -7, -9, -11], &[1e-4, 1e-8]),
    );
    for quantity in Quantity::ALL {
        for price in [Price::Evaluations, Price::Time, Price::TimeWithMaking] {
            let front = found.front(quantity, price);
            assert!(!front.is_empty());
            for &k in &front {
                let own = &found.points[k];
                let beats = |other: &&Measured| {
                    let alike = price != Price::Evaluations
                        || other.combination.evaluation == Evaluation::Exact;
                    let steps = other.combination.integrator != Integrator::Quadrature;
                    let [cheap, dear] = [other, own].map(|p| p.cost.of(price));
                    let [good, bad] = [other, own].map(|p| found.known(p, quantity));
                    alike && steps && cheap <= dear && good <= bad && (cheap < dear || good < bad)
                };
                assert_eq!(found.points.iter().find(beats), None, "against {own:?}");
            }
            let errors: Vec<f64> = front
                .iter()
                .map(|&k| found.known(&found.points[k], quantity))
                .collect();
            assert!(
                errors.windows(2).all(|pair| pair[1] < pair[0]),
                "{errors:?}"
            );
            let reached = found.cheapest(quantity, price, errors[1]);
            assert_eq!(reached, Some(front[1]));
            assert_eq!(found.cheapest(quantity, price, 1e-20), None);
        }
    }
}

/// log error over log steps has the slope of the order, or falls faster while the steps are still few: less one,
/// for the largest error over a motion is not that of one step, and more two.
#[test]
fn the_orders_of_the_methods_are_seen() {
    let found = study("single-dwell", &effort(&[-5, -7, -9, -10], &[]));
    for method in Method::ALL {
        let Some(order) = order(method) else { continue };
        let runs = exact(&found, method);
        let (first, last) = (runs[0], runs[runs.len() - 1]);
        let fall = (first.errors.energy / last.errors.energy).ln();
        let slope = fall / (last.cost.steps as f64 / first.cost.steps as f64).ln();
        assert!(
            (order - 1.0..order + 2.0).contains(&slope),
            "{}: {slope}",
            method.name()
        );
    }
}

/// The exact model with an inertia that is off by a part.
struct Off(Exact, f64);

impl Reduced for Off {
    type Work = ExactWork;

    fn work(&self) -> ExactWork {
        self.0.work()
    }

    fn reactions(&self) -> usize {
        self.0.reactions()
    }

    fn range(&self) -> Range {
        self.0.range()
    }

    fn inertia(&self, q: f64, work: &mut ExactWork) -> Result<(f64, f64), PlaceError> {
        let (m, half_dm) = self.0.inertia(q, work)?;
        Ok((m * (1.0 + self.1), half_dm))
    }

    fn curvature(&self, q: f64, work: &mut ExactWork) -> Result<Inertia, PlaceError> {
        self.0.curvature(q, work)
    }

    fn coefficients(
        &self,
        q: f64,
        work: &mut ExactWork,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        self.0.coefficients(q, work, out)
    }
}

/// An inertia off by 1e-6 makes a motion that is off by about that: between a hundredth and ten times of it, by
/// how much the inertia varies and how long the motion lasts; without the fault it errs a thousand times less.
#[test]
fn a_fault_in_an_evaluation_is_seen() {
    const FAULT: f64 = 1e-6;
    let more = |exact: &Exact| -> Vec<Box<dyn Evaluator>> {
        vec![Box::new(ByModel {
            model: Off(exact.clone(), FAULT),
            evaluation: Evaluation::Other("off"),
            making: 0.0,
        })]
    };
    let effort = effort(&[-9, -10, -11], &[]);
    let found = measure_with(&scene("crank-rocker"), &effort, &more, &silent).expect("a study");
    let integrator = Integrator::Steps(Method::Dop853, 1e-11);
    let (off, sound) = (
        with(&found, integrator, "off").errors,
        with(&found, integrator, "exact f64").errors,
    );
    for quantity in Quantity::ALL {
        let [off, sound] = [off, sound].map(|errors| errors.of(quantity));
        assert!(
            (1e-2 * FAULT..1e1 * FAULT).contains(&off),
            "{quantity:?} {off:e}"
        );
        assert!(sound < 1e-3 * off, "{quantity:?} {sound:e}");
    }
}

/// A table errs by its accuracy, single precision by its rounding: no tolerance helps them beyond that. (The factor is
/// how errors of m grow over three turns.)
#[test]
fn an_evaluation_keeps_what_it_promises() {
    let found = study("crank-rocker", &effort(&[-7, -9, -11], &[1e-4, 1e-6, 1e-8]));
    let at = |name: &str, tolerance: f64| {
        with(&found, Integrator::Steps(Method::Tsit45, tolerance), name)
            .errors
            .coordinate
    };
    for accuracy in [1e-6, 1e-8] {
        let error = at(&format!("table {accuracy:.0e}"), accuracy / 10.0);
        assert!(error < 300.0 * accuracy, "{accuracy:e}: {error:e}");
    }
    let [coarse, exact] = [at("table 1e-6", 1e-7), at("exact f64", 1e-11)];
    assert!(exact < 1e-3 * coarse, "{exact:e} {coarse:e}");
    // A table is of one freedom without loads, and is told to be missing elsewhere.
    let loaded = study("double-pendulum", &effort(&[-5, -7], &[1e-6]));
    assert!(loaded.left_out.iter().any(|why| why.starts_with("tables")));
}

/// Quadrature of the exact model is the truth itself, at less than any integrator takes for twelve digits.
#[test]
fn quadrature_is_told_where_the_motion_is_known_by_its_energy() {
    let found = study("crank-rocker", &effort(&[-9, -11, -13], &[]));
    let point = found.quadrature().expect("a conservative motion");
    assert!(found.below(point, Quantity::Coordinate));
    assert!(
        found
            .points
            .iter()
            .filter(|p| matches!(p.combination.integrator, Integrator::Steps(..)))
            .all(|p| p.cost.weighed > point.cost.weighed)
    );
    assert!(
        study("slider-crank-friction", &effort(&[-3, -5], &[]))
            .quadrature()
            .is_none()
    );
}

#[test]
fn careless_scenes_are_cut_short_or_refused() {
    let effort = effort(&[-4, -6, -8], &[1e-6]);
    // The crank is longer than the rest allows to turn, and has no [motion].
    let short = |more: &str| {
        let text = format!(
            "[bodies.ground]\npoints = {{ A = [0, 0], D = [4, 0] }}\n[bodies.crank]\n\
             points = {{ A = [0, 0], B = [3, 0] }}\nmass = 1\ncenter = [1.5, 0]\ninertia = 0.1\n[bodies.coupler]\n\
             points = {{ B = [0, 0], C = [1.5, 0] }}\n[bodies.rocker]\npoints = {{ D = [0, 0], C = [2, 0] }}\n[joints]\n\
             A = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"coupler.B\"] }}\n\
             C = {{ revolute = [\"coupler.C\", \"rocker.C\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nphi = 0.4\ncoupler = 0.6\nrocker = 1.8\n{more}"
        );
        Scene::parse("short.toml", &text).expect("a scene")
    };
    for more in ["", "[motion]\nspeed = 1\nduration = 50"] {
        let found = measure(&short(more), &effort, &silent).expect("a study");
        assert!(found.duration < 2.0, "{}", found.duration);
        let told = found.motion.join("; ");
        assert!(told.contains("short of where"), "{told}");
        assert_eq!(told.contains("set free"), more.is_empty(), "{told}");
        assert!(found.points.len() > 20);
    }
    let still = "[bodies.ground]\npoints = { A = [0, 0], D = [4, 0] }\n[bodies.one]\npoints = { A = [0, 0], B = [3, 0] }\n\
                 [bodies.two]\npoints = { D = [0, 0], B = [2, 0] }\n[joints]\nA = { revolute = [\"ground.A\", \"one.A\"] }\n\
                 B = { revolute = [\"one.B\", \"two.B\"] }\nD = { revolute = [\"ground.D\", \"two.D\"] }\n[assembly]\n\
                 one = 0.4\ntwo = 1.8";
    let still = Scene::parse("still.toml", still).expect("a scene");
    let refused = measure(&still, &effort, &silent).expect_err("nothing moves");
    assert!(
        refused.to_string().starts_with("nothing can move"),
        "{refused}"
    );
    // Friction that fades over 1e-4 of a unit speed: some methods may give up, none panics.
    let path = home().join("validation/slider-crank-friction/scene.toml");
    let text = std::fs::read_to_string(path).expect("a file");
    let stiff = text
        .replace("fade = 0.5", "fade = 1e-4")
        .replace("fade = 5,", "fade = 1e-4,");
    let stiff = Scene::parse("stiff.toml", &stiff).expect("a scene");
    let found = measure(&stiff, &effort, &silent).expect("a study");
    assert!(!found.front(Quantity::Energy, Price::Evaluations).is_empty());
}
