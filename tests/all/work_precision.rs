//! The cost of accuracy: the study's reference, its errors and its fronts.

use dwell_dynamics::Method;
use dwell_geometry::{PositionError, Range};
use dwell_kinetostatics::{Coefficients, ExactModel, ExactWorkspace, Inertia, ReducedModel};
use dwell_scene::{MotionDuration, PlaneScene, SpaceScene};
use dwell_study::no_progress;
use dwell_tests::fixtures::{repository_root, scene};
use dwell_validation::work_precision::{
    CombinationResult, CostMeasure, Effort, ErrorQuantity, Evaluation, Evaluator, Integrator,
    ModelEvaluator, WorkPrecision, measure, measure_with,
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
        exported_code: false,
        tolerance_exponents: tolerances.to_vec(),
        table_accuracies: tables.to_vec(),
        max_steps: 5_000,
        repetitions: 1,
    }
}

fn run_study(name: &str, effort: &Effort) -> WorkPrecision {
    measure(&scene(name), effort, &no_progress).expect("a study")
}

/// The exact runs of a method, from the coarsest tolerance on.
fn exact(found: &WorkPrecision, method: Method) -> Vec<&CombinationResult> {
    let is_exact = |p: &&CombinationResult| {
        p.combination.evaluation == Evaluation::Exact
            && matches!(p.combination.integrator, Integrator::Steps(m, _) if m == method)
    };
    found.points.iter().filter(is_exact).collect()
}

fn result_of(found: &WorkPrecision, integrator: Integrator, name: &str) -> CombinationResult {
    let matches = |p: &&CombinationResult| {
        p.combination.integrator == integrator && p.combination.evaluation.name() == name
    };
    let all = || found.points.iter().map(|p| p.combination.name());
    *(found.points.iter().find(matches))
        .unwrap_or_else(|| panic!("{name}: {:?}", all().collect::<Vec<_>>()))
}

#[test]
fn the_reference_is_known_better_than_anything_on_the_front() {
    let effort = effort(&[-3, -5, -7, -9, -11], &[1e-6]);
    for name in ["crank-rocker", "single-dwell", "double-pendulum", "boom"] {
        let found = run_study(name, &effort);
        for quantity in ErrorQuantity::ALL {
            let front = found.pareto_front(quantity, CostMeasure::Evaluations);
            assert!(front.len() > 3, "{name}: {front:?}");
            for k in front {
                let point = &found.points[k];
                assert!(
                    !found.is_below_reference(point, quantity),
                    "{name}: {quantity:?} of {} is below {:?}",
                    point.combination.name(),
                    found.reference.error
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
        let found = run_study(name, &effort);
        for method in Method::ALL {
            for pair in exact(&found, method).windows(2) {
                for quantity in ErrorQuantity::ALL {
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
    let found = run_study(
        "single-dwell",
        &effort(&[-3, -5, -7, -9, -11], &[1e-4, 1e-8]),
    );
    for quantity in ErrorQuantity::ALL {
        for price in [
            CostMeasure::Evaluations,
            CostMeasure::Time,
            CostMeasure::TimeWithBuild,
        ] {
            let front = found.pareto_front(quantity, price);
            assert!(!front.is_empty());
            for &k in &front {
                let on_front = &found.points[k];
                let beats = |other: &&CombinationResult| {
                    let alike = price != CostMeasure::Evaluations
                        || other.combination.evaluation == Evaluation::Exact;
                    let steps = other.combination.integrator != Integrator::Quadrature;
                    let [cheap, dear] = [other, on_front].map(|p| p.cost.of(price));
                    let [good, bad] = [other, on_front].map(|p| found.error_bound(p, quantity));
                    alike && steps && cheap <= dear && good <= bad && (cheap < dear || good < bad)
                };
                assert_eq!(
                    found.points.iter().find(beats),
                    None,
                    "against {on_front:?}"
                );
            }
            let errors: Vec<f64> = front
                .iter()
                .map(|&k| found.error_bound(&found.points[k], quantity))
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
    let found = run_study("single-dwell", &effort(&[-5, -7, -9, -10], &[]));
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
struct PerturbedModel(ExactModel, f64);

impl ReducedModel for PerturbedModel {
    type Workspace = ExactWorkspace;

    fn workspace(&self) -> ExactWorkspace {
        self.0.workspace()
    }

    fn reactions(&self) -> usize {
        self.0.reactions()
    }

    fn range(&self) -> Range {
        self.0.range()
    }

    fn inertia(&self, q: f64, workspace: &mut ExactWorkspace) -> Result<(f64, f64), PositionError> {
        let (m, half_dm) = self.0.inertia(q, workspace)?;
        Ok((m * (1.0 + self.1), half_dm))
    }

    fn inertia_derivatives(
        &self,
        q: f64,
        workspace: &mut ExactWorkspace,
    ) -> Result<Inertia, PositionError> {
        self.0.inertia_derivatives(q, workspace)
    }

    fn coefficients(
        &self,
        q: f64,
        workspace: &mut ExactWorkspace,
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        self.0.coefficients(q, workspace, out)
    }
}

/// An inertia off by 1e-6 makes a motion that is off by about that: between a hundredth and ten times of it, by
/// how much the inertia varies and how long the motion lasts; without the fault it errs a thousand times less.
#[test]
fn a_fault_in_an_evaluation_is_seen() {
    const PERTURBATION: f64 = 1e-6;
    let more = |exact: &ExactModel| -> Vec<Box<dyn Evaluator>> {
        vec![Box::new(ModelEvaluator {
            model: PerturbedModel(exact.clone(), PERTURBATION),
            evaluation: Evaluation::Other("off"),
            build_time: 0.0,
        })]
    };
    let effort = effort(&[-9, -10, -11], &[]);
    let found =
        measure_with(&scene("crank-rocker"), &effort, &more, &no_progress).expect("a study");
    let integrator = Integrator::Steps(Method::Dop853, 1e-11);
    let (perturbed, sound) = (
        result_of(&found, integrator, "off").errors,
        result_of(&found, integrator, "exact f64").errors,
    );
    for quantity in ErrorQuantity::ALL {
        let [perturbed, sound] = [perturbed, sound].map(|errors| errors.of(quantity));
        assert!(
            (1e-2 * PERTURBATION..1e1 * PERTURBATION).contains(&perturbed),
            "{quantity:?} {perturbed:e}"
        );
        assert!(sound < 1e-3 * perturbed, "{quantity:?} {sound:e}");
    }
}

/// A table errs by its accuracy, single precision by its rounding: no tolerance helps them beyond that. (The factor is
/// how errors of m grow over three turns.)
#[test]
fn an_evaluation_keeps_what_it_promises() {
    let found = run_study("crank-rocker", &effort(&[-7, -9, -11], &[1e-4, 1e-6, 1e-8]));
    let at = |name: &str, tolerance: f64| {
        result_of(&found, Integrator::Steps(Method::Tsit45, tolerance), name)
            .errors
            .coordinate
    };
    for accuracy in [1e-6, 1e-8] {
        let error = at(&format!("table {accuracy:.0e}"), accuracy / 10.0);
        assert!(error < 300.0 * accuracy, "{accuracy:e}: {error:e}");
    }
    let [coarse, exact] = [at("table 1e-6", 1e-7), at("exact f64", 1e-11)];
    assert!(exact < 1e-3 * coarse, "{exact:e} {coarse:e}");
    // A table is of one degree of freedom without loads; elsewhere its absence is noted.
    let loaded = run_study("double-pendulum", &effort(&[-5, -7], &[1e-6]));
    assert!(loaded.omitted.iter().any(|why| why.starts_with("tables")));
}

/// Quadrature of the exact model is the reference itself, at less than any integrator takes for twelve digits.
#[test]
fn quadrature_is_shown_where_the_motion_follows_from_its_energy() {
    let found = run_study("crank-rocker", &effort(&[-9, -11, -13], &[]));
    let point = found.quadrature().expect("a conservative motion");
    assert!(found.is_below_reference(point, ErrorQuantity::Coordinate));
    assert!(
        found
            .points
            .iter()
            .filter(|p| matches!(p.combination.integrator, Integrator::Steps(..)))
            .all(|p| p.cost.weighted_evaluations > point.cost.weighted_evaluations)
    );
    assert!(
        run_study("slider-crank-friction", &effort(&[-3, -5], &[]))
            .quadrature()
            .is_none()
    );
}

/// The errors need the speeds, which the cam does not request; and what is to be typed needs a motion, which it does not have.
#[test]
fn lines_to_type_keep_their_accuracy_once_the_scene_has_the_motion_of_the_study() {
    let found = run_study("cam", &effort(&[-4, -6], &[]));
    for run in &found.commands {
        assert!(run.keeps_accuracy(&found.reference.error), "{run:?}");
    }
    let mut notes = found.motion_notes.iter();
    let line = notes.find_map(|note| note.split_once("first line: "));
    let (_, line) = line.expect("a motion to write");
    let text = format!("{line}\n{}", scene("cam").source.inner());
    let written = PlaneScene::parse("cam.toml", &text).expect("a scene");
    let motion = written.motion.expect("its motion");
    assert_eq!(motion.duration, MotionDuration::Seconds(found.duration));
    assert_eq!(motion.initial_coordinates, [0.4]);
    assert_eq!(motion.initial_velocities.len(), 1);
}

/// Two rods without mass hang from a crank: an evaluation of the motion can do without them.
#[test]
fn what_nothing_needs_is_counted() {
    let text = "[bodies.ground]\npoints = { A = [0, 0], D = [3, 0] }\n[bodies.crank]\npoints = { A = [0, 0], B = [1, 0] }\nmass = 1\n\
                center = [0.5, 0]\ninertia = 0.1\n[bodies.p]\npoints = { B = [0, 0], C = [2.5, 0] }\n[bodies.r]\n\
                points = { D = [0, 0], C = [2.5, 0] }\n[joints]\nA = { revolute = [\"ground.A\", \"crank.A\"] }\n\
                B = { revolute = [\"crank.B\", \"p.B\"] }\nC = { revolute = [\"p.C\", \"r.C\"] }\nD = { revolute = [\"ground.D\", \"r.D\"] }\n\
                [actuators]\nphi = { angle = [\"ground\", \"crank\"] }\n[assembly]\nphi = 0.4\np = 0.95\nr = 1.82\n\
                [motion]\ninitial-velocity = 1\nduration = 1";
    let idle = PlaneScene::parse("idle.toml", text).expect("a scene");
    let moving = text.replace(
        "C = [2.5, 0] }\n[joints]",
        "C = [2.5, 0] }\nmass = 1\ncenter = [1, 0]\n[joints]",
    );
    let moving = PlaneScene::parse("moving.toml", &moving).expect("a scene");
    for (scene, count) in [(idle, 1), (moving, 0)] {
        let found = measure(&scene, &effort(&[-4, -6], &[]), &no_progress).expect("a study");
        assert_eq!(found.requested.without_idle.0, count);
    }
}

#[test]
fn careless_scenes_are_cut_short_or_refused() {
    let effort = effort(&[-4, -6, -8], &[1e-6]);
    // The crank is longer than the rest allows to turn, and has no [motion].
    let shortened = |more: &str| {
        let text = format!(
            "[bodies.ground]\npoints = {{ A = [0, 0], D = [4, 0] }}\n[bodies.crank]\n\
             points = {{ A = [0, 0], B = [3, 0] }}\nmass = 1\ncenter = [1.5, 0]\ninertia = 0.1\n[bodies.coupler]\n\
             points = {{ B = [0, 0], C = [1.5, 0] }}\n[bodies.rocker]\npoints = {{ D = [0, 0], C = [2, 0] }}\n[joints]\n\
             A = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"coupler.B\"] }}\n\
             C = {{ revolute = [\"coupler.C\", \"rocker.C\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nphi = 0.4\ncoupler = 0.6\nrocker = 1.8\n{more}"
        );
        PlaneScene::parse("short.toml", &text).expect("a scene")
    };
    for more in ["", "[motion]\ninitial-velocity = 1\nduration = 50"] {
        let found = measure(&shortened(more), &effort, &no_progress).expect("a study");
        assert!(found.duration < 2.0, "{}", found.duration);
        let notes = found.motion_notes.join("; ");
        assert!(notes.contains("before its coordinate reaches"), "{notes}");
        assert_eq!(
            notes.contains("motion = { duration = "),
            more.is_empty(),
            "{notes}"
        );
        assert!(found.points.len() > 20);
    }
    let still = "[bodies.ground]\npoints = { A = [0, 0], D = [4, 0] }\n[bodies.one]\npoints = { A = [0, 0], B = [3, 0] }\n\
                 [bodies.two]\npoints = { D = [0, 0], B = [2, 0] }\n[joints]\nA = { revolute = [\"ground.A\", \"one.A\"] }\n\
                 B = { revolute = [\"one.B\", \"two.B\"] }\nD = { revolute = [\"ground.D\", \"two.D\"] }\n[assembly]\n\
                 one = 0.4\ntwo = 1.8";
    let still = PlaneScene::parse("still.toml", still).expect("a scene");
    let refused = measure(&still, &effort, &no_progress).expect_err("nothing moves");
    assert!(
        refused.to_string().starts_with("nothing can move"),
        "{refused}"
    );
    // Friction that fades over 1e-4 of a unit speed: some methods may give up, none panics.
    let path = repository_root().join("validation/slider-crank-friction/scene.toml");
    let text = std::fs::read_to_string(path).expect("a file");
    let stiff = text
        .replace("regularization-speed = 0.5", "regularization-speed = 1e-4")
        .replace("regularization-speed = 5,", "regularization-speed = 1e-4,");
    let stiff = PlaneScene::parse("stiff.toml", &stiff).expect("a scene");
    let found = measure(&stiff, &effort, &no_progress).expect("a study");
    assert!(
        !found
            .pareto_front(ErrorQuantity::Energy, CostMeasure::Evaluations)
            .is_empty()
    );
}

/// The exported C through the free motion of the single-dwell, against its quadrature. Without a C compiler the study says so.
#[test]
fn exported_code_is_as_accurate_as_its_cells_and_its_numbers() {
    let effort = Effort {
        exported_code: true,
        ..effort(&[-7, -9], &[])
    };
    let found = run_study("single-dwell", &effort);
    if found.exported_code.is_empty() {
        let reason = |text: &String| text.starts_with("exported code: there is no C compiler");
        assert!(found.omitted.iter().any(reason), "{:?}", found.omitted);
        return;
    }
    // Measured: 1.4e-12, 9.7e-7, 1.5e-13 and 9.7e-7 rad, after 16 000 steps.
    let allowed = [1e-10, 2e-5, 1e-11, 2e-5];
    for (code, allowed) in found.exported_code.iter().zip(allowed) {
        let error = code.errors.coordinate;
        assert!(error < allowed, "{}: {error:e}", code.name);
        // A worst call takes no less than the mean.
        assert!(
            code.times.iter().all(|[mean, worst]| mean <= worst),
            "{:?}",
            code.times
        );
    }
    // Single precision errs more than double.
    let of = |k: usize| found.exported_code[k].errors.coordinate;
    assert!(found.exported_code.len() == 4 && of(1) > of(0) && of(3) > of(2));
    // Loads that vary are inputs of the code.
    let found = run_study("press", &effort);
    assert!(found.exported_code.is_empty());
}

/// A scene of `validation/spatial` with a motion.
fn scene_in_space(name: &str, motion: &str) -> SpaceScene {
    let path = repository_root().join(format!("validation/spatial/{name}.toml"));
    let text = std::fs::read_to_string(path).expect("a scene") + motion;
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// In space the study is that of the plane: with one coordinate, conservative or not, and with several. Each method errs less at a finer
/// tolerance, quadrature is the reference where there is an orbit, and what there is not is named.
#[test]
fn motions_in_space_are_studied_as_those_in_the_plane() {
    let damped = "drag = { rotational-damper = \"A\", damping = 0.02 }\n";
    let motion = "\n[motion]\nduration = 2\ninitial-velocity = 3\n";
    let effort = effort(&[-5, -7, -9], &[1e-6]);
    let cases = [
        ("slider-crank-haug", motion.to_owned(), true),
        ("slider-crank-haug", format!("{damped}{motion}"), false),
        ("gyroscope", String::new(), false),
    ];
    for (name, more, has_orbit) in cases {
        let mut scene = scene_in_space(name, &more);
        if let Some(motion) = scene.motion.as_mut().filter(|_| name == "gyroscope") {
            // In steady precession nothing but rounding would oscillate.
            motion.initial_velocities[2] = 25.0;
        }
        let found = measure(&scene, &effort, &no_progress).expect("a study");
        assert_eq!(found.quadrature().is_some(), has_orbit, "{name}");
        assert_eq!(found.reference.method.contains("quadrature"), has_orbit);
        // Measured: 1e-13 rad and less by quadrature, 8e-11 by integration at 1e-10.
        let error = found.reference.error.coordinate;
        assert!(
            error < if has_orbit { 1e-11 } else { 5e-9 },
            "{name}: {error:.1e} by {}",
            found.reference.method
        );
        let tables = found.omitted.iter().filter(|why| why.starts_with("tables"));
        assert_eq!(tables.count(), 1, "{name}: {:?}", found.omitted);
        for method in Method::ALL {
            let runs = exact(&found, method);
            // The method of order two takes too many steps at the finest tolerance.
            assert!(runs.len() >= 2, "{name}, {}", method.name());
            for pair in runs.windows(2) {
                for quantity in ErrorQuantity::ALL {
                    let [before, after] = [0, 1].map(|k| pair[k].errors.of(quantity));
                    let at = pair[1].combination.name();
                    let floor = 100.0 * found.reference.error.of(quantity);
                    assert!(
                        after < before / 3.0 || after < floor,
                        "{name}, {at}: {quantity:?} {before:e} {after:e}"
                    );
                }
            }
        }
    }
}

/// Without loads the tables of the reduced model are studied in space, too, and their errors are those that they were built for.
#[test]
fn tables_of_a_reduced_model_in_space_are_studied() {
    let path = repository_root().join("validation/spatial/rssr.toml");
    let text = std::fs::read_to_string(path).expect("a scene");
    let (before, _) = text.split_once("[loads]").expect("loads");
    let motion = "[motion]\nduration = 5\ninitial-velocity = 2\n";
    let scene = SpaceScene::parse("rssr", &format!("{before}{motion}")).expect("a scene");
    let found = measure(&scene, &effort(&[-5, -6, -7], &[1e-4]), &no_progress).expect("a study");
    let integrator = Integrator::Steps(Method::Dop853, 1e-5);
    let [table, sound] =
        ["table 1e-4", "exact f64"].map(|name| result_of(&found, integrator, name));
    let [table, sound] = [table, sound].map(|result| result.errors.coordinate);
    // Seen: 2.8e-5 and 7.0e-6 rad.
    assert!(table > 2.0 * sound && table < 1e-3, "{table:e} {sound:e}");
}

/// A linkage in an oblique plane is reduced by its planar equivalent, in single precision, too, whose working memory is its own: with
/// that of the model of the coefficients this panicked.
#[test]
fn a_linkage_in_an_oblique_plane_is_studied() {
    let scene = scene_in_space(
        "planar-oblique-rcsr",
        "\n[motion]\nduration = 2\ninitial-velocity = 3\n",
    );
    let found = measure(&scene, &effort(&[-3, -4], &[]), &no_progress).expect("a study");
    let of = |name: &str| {
        let result = result_of(&found, Integrator::Steps(Method::Dop853, 1e-4), name);
        result.errors.coordinate
    };
    // Seen: 3.0e-4 and 2.5e-5 rad.
    let [double, single] = ["exact f64", "exact f32"].map(of);
    assert!(double < 1e-2 && single < 1e-3, "{double:e} {single:e}");
}
