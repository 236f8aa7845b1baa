//! Gradients of results by the numbers of a scene, against differences of results of scenes that are compiled for other numbers, and
//! against Euler's theorem of homogeneous functions. In the plane and in space.

use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::gradient::{
    Gradient, GradientScene, ResultGradient, SlopeMethod, compute_gradient,
};
use dwell_study::no_progress;
use dwell_tests::fixtures;

/// Cases with results that are stationary or summed over a turn: dyads, guided points, constructions, groups solved by iterations.
const PLANE: [(&str, &str); 9] = [
    ("crank-rocker", "m.max,m.min,half_dm.max,period,energy"),
    ("single-dwell", "m.max,half_dm.min,period"),
    ("slider-crank", "m.min,half_dm.max"),
    ("whitworth", "m.max,half_dm.max"),
    ("slotted-rocker", "m.max,half_dm.min"),
    ("jansen", "m.max,half_dm.max"),
    ("stephenson-six-bar", "m.min,half_dm.max"),
    ("andrews", "m.max"),
    // A point that depends on its own place, too.
    ("four-bar", "coupler.P.x.rms"),
];
/// Rods, groups solved by iterations, planar loops in space, under their weight.
const SPACE: [(&str, &str); 4] = [
    (
        "rssr",
        "m.max,q.actuator_force.rms,q.actuator_force.max_abs",
    ),
    ("rsur-haug", "half_dm.max,q.actuator_force.rms"),
    ("slider-crank-haug", "half_dm.max,q.actuator_force.rms"),
    ("oblique-slider", "m.max,q.actuator_force.rms"),
];

fn gradient<S: GradientScene>(scene: &S, results: &str, has_check: bool) -> Gradient {
    let names: Vec<String> = results.split(',').map(str::to_owned).collect();
    let found = compute_gradient(scene, &names, has_check, &no_progress);
    found.unwrap_or_else(|error| panic!("{}: {error}", scene.name))
}

/// The largest difference of a derivative from that by differences, times the size of the number, over the largest change.
fn largest_difference(of: &ResultGradient) -> f64 {
    let effect = |slope: f64, scale: f64| (slope * scale).abs();
    let sizes = of.numbers.iter().map(|n| effect(n.slope, n.scale));
    let largest = sizes.fold(0.0, f64::max);
    let differences = of.numbers.iter().filter_map(|n| {
        let [slope, _] = n.check?;
        Some(effect(n.slope - slope, n.scale))
    });
    differences.fold(0.0, f64::max) / largest
}

fn assert_differences_agree<S: GradientScene>(scene: &S, results: &str) {
    for result in gradient(scene, results, true).results {
        let (name, of) = (&scene.name, &result.name);
        assert_eq!(
            result.differenced, None,
            "{name}: {of} has no exact gradient"
        );
        let exact = result
            .numbers
            .iter()
            .filter(|n| n.method == SlopeMethod::Exact)
            .count();
        assert!(
            exact >= 10,
            "{name}: only {exact} derivatives of {of} are exact"
        );
        let difference = largest_difference(&result);
        // Seen: 3.8e-11 (slider-crank), the rounding of differences.
        assert!(
            difference < 1e-9,
            "{name}: derivatives of {of} differ by {difference:e}"
        );
    }
}

#[test]
fn derivatives_are_differences_of_compiled_scenes() {
    for (case, results) in PLANE {
        assert_differences_agree(&fixtures::scene(case), results);
    }
    for (case, results) in SPACE {
        assert_differences_agree(&fixtures::space_scene(case), results);
    }
}

/// Σ (degree of a number in mass or length) × number × derivative: by Euler's theorem the degree of the result times the result.
fn euler_sum(of: &ResultGradient, degree: impl Fn(&str) -> f64) -> f64 {
    let terms = of
        .numbers
        .iter()
        .map(|n| degree(&n.path) * n.value * n.slope);
    terms.sum()
}

/// The degrees of a number of a body in mass and in length; others have none.
fn degrees(path: &str) -> [f64; 2] {
    let is = |word: &str| path.contains(word);
    match () {
        () if is(".mass") => [1.0, 0.0],
        () if is(".inertia") => [1.0, 2.0],
        () if is(".points.") || is(".center") => [0.0, 1.0],
        () => [0.0, 0.0],
    }
}

fn assert_homogeneous<S: GradientScene>(scene: &S, result: &str, degrees_of_result: [f64; 2]) {
    let found = gradient(scene, result, false);
    let result = &found.results[0];
    for (k, degree) in degrees_of_result.into_iter().enumerate() {
        let sum = euler_sum(result, |path| degrees(path)[k]);
        let error = (sum - degree * result.value).abs() / result.value;
        // Seen: 1.1e-12 (jansen).
        assert!(
            error < 1e-10,
            "{}: {} by degree {k}: {error:e}",
            scene.name,
            result.name
        );
    }
}

/// m is proportional to the masses, and to the square of the lengths; the period of a turn from a given velocity depends on neither.
#[test]
fn gradients_obey_eulers_theorem() {
    for case in [
        "crank-rocker",
        "single-dwell",
        "whitworth",
        "jansen",
        "andrews",
    ] {
        assert_homogeneous(&fixtures::scene(case), "m.max", [1.0, 2.0]);
        assert_homogeneous(&fixtures::scene(case), "m.min", [1.0, 2.0]);
    }
    for case in ["crank-rocker", "single-dwell"] {
        assert_homogeneous(&fixtures::scene(case), "period", [0.0, 0.0]);
        assert_homogeneous(&fixtures::scene(case), "energy", [1.0, 2.0]);
    }
    for case in ["rsur-haug", "slider-crank-haug", "oblique-slider"] {
        assert_homogeneous(&fixtures::space_scene(case), "m.max", [1.0, 2.0]);
    }
}

/// A scene with its text changed.
fn changed(case: &str, from: &str, to: &str) -> PlaneScene {
    let text = fixtures::scene(case).source.inner().replace(from, to);
    PlaneScene::parse(case, &text).expect("a scene")
}

/// Weight alone makes the force of a balanced wheel and a bar on it equal and opposite half a turn apart: the largest magnitude has a kink.
#[test]
fn extremes_that_tie_are_named() {
    let scene: SpaceScene = fixtures::space_scene("wobble-plate");
    let found = gradient(&scene, "q.actuator_force.max_abs", false);
    let [tie] = found.results[0].ties[..] else {
        panic!("one tie");
    };
    // Seen: 0.
    assert!((tie - std::f64::consts::PI).abs() < 1e-12, "{tie}");
}

/// Redundant constraints, negative moments of inertia and whole numbers do not allow every change: these numbers are named with the reason.
#[test]
fn numbers_that_cannot_change_are_named() {
    let found = gradient(
        &fixtures::scene("parallelogram-three-cranks"),
        "m.max",
        false,
    );
    let fixed = |path: &str| found.fixed.iter().find(|(p, _)| p == path);
    let (_, reason) = fixed("ground.points.A[0]").expect("a reason");
    assert!(reason.contains("overconstrained"), "{reason}");
    assert!(
        found.results[0]
            .numbers
            .iter()
            .any(|n| n.path == "crank.mass")
    );
}

/// A number on which the result depends through more than dimensions, masses and loads has a derivative by differences, with its error.
#[test]
fn other_numbers_are_differenced() {
    let found = gradient(&fixtures::scene("crank-rocker"), "period", false);
    let of = |path: &str| found.results[0].numbers.iter().find(|n| n.path == path);
    let velocity = of("motion.initial-velocity.phi").expect("a derivative");
    assert!(matches!(velocity.method, SlopeMethod::Differences(_)));
    // The period is inversely proportional to the velocity at the start.
    let period = found.results[0].value;
    // Seen: 5.6e-13 s, of differences.
    assert!((velocity.slope * velocity.value + period).abs() < 5e-11);
    let mass = of("coupler.mass").expect("a derivative");
    assert_eq!(mass.method, SlopeMethod::Exact);
}

/// A centre of mass at a joint has derivatives, although the structure of the mechanism has no lever there.
#[test]
fn a_number_that_is_zero_has_its_place() {
    let scene = changed("crank-rocker", "center = [1.75, 0]", "center = [0, 0]");
    let found = gradient(&scene, "m.max", true);
    let centre = found.results[0]
        .numbers
        .iter()
        .find(|n| n.path == "coupler.center[0]");
    assert!(centre.is_some_and(|n| n.slope != 0.0 && n.method == SlopeMethod::Exact));
    let difference = largest_difference(&found.results[0]);
    // Seen: 3.3e-13.
    assert!(difference < 3e-11, "{difference:e}");
}
