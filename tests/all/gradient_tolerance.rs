//! The spread of results whose numbers vary at random: by derivatives against samples, and against what is known of linear and quadratic
//! results. In the plane and in space.

use dwell_scene::{PlaneScene, SceneFile};
use dwell_study::gradient::{
    GradientScene, ResultTolerance, Tolerance, compute_gradient, compute_tolerance,
};
use dwell_study::{StudyError, SweepRequest, no_progress};
use dwell_tests::fixtures;

/// RMS torque with the weights at the places where it is least.
const OPTIMUM: &str = include_str!("balanced-by-two-weights.toml");

/// Options of a study of tolerances, a line each: `of RESULT`, `tolerance …`, `tied …`, `limit …`.
fn study<S: GradientScene>(
    scene: &S,
    samples: u64,
    options: &[&str],
) -> Result<Tolerance, StudyError> {
    let of = |word: &str| -> Vec<String> {
        let given = options.iter().filter_map(|o| o.strip_prefix(word));
        given.map(|rest| rest.trim().to_owned()).collect()
    };
    let request = SweepRequest {
        vary: &of("tolerance "),
        tied: &of("tied "),
        samples: Some(samples),
        seed: 1,
        requests: &of("of "),
        limits: &of("limit "),
    };
    compute_tolerance(scene, &request, &no_progress)
}

fn tolerance<S: GradientScene>(scene: &S, samples: u64, options: &[&str]) -> Tolerance {
    study(scene, samples, options).expect("a study")
}

/// Asserts that mean and deviation by second order are within three standard errors of those of the samples.
fn assert_samples_agree(of: &ResultTolerance) {
    let second = of.second.as_ref().expect("second derivatives");
    let ([mean_error, deviation_error], sampled) = (of.sampling_errors, &of.sampled);
    let shift = (second.shift - sampled.shift) / mean_error;
    let deviation = (second.deviation - sampled.deviation) / deviation_error;
    let name = &of.nominal.name;
    assert!(
        shift.abs() < 3.0,
        "{name}: mean {shift} standard errors apart"
    );
    assert!(
        deviation.abs() < 3.0,
        "{name}: deviation {deviation} standard errors apart"
    );
}

fn value(scene: &SceneFile, path: &str) -> f64 {
    scene.value(path).expect("a number")
}

/// At an optimum the gradient vanishes: the mean rises and the result spreads by the second derivatives alone. The published place is
/// known to 1e-8 m; Monte Carlo of an independent program: mean +1.59e-4, deviation 1.48e-4, by its Hessian +1.61e-4 and 1.47e-4.
#[test]
fn at_an_optimum_second_order_agrees_with_samples() {
    let scene = PlaneScene::parse("optimum", OPTIMUM).expect("a scene");
    let places = [
        "crank-weight.center[0]",
        "crank-weight.center[1]",
        "rocker-weight.center[0]",
        "rocker-weight.center[1]",
    ];
    let given =
        places.map(|path| format!("tolerance {path}~normal({:?},1e-3)", value(&scene, path)));
    let mut options = vec!["of phi.actuator_force.rms"];
    options.extend(given.iter().map(String::as_str));
    let found = tolerance(&scene, 20_000, &options);
    let of = &found.results[0];
    // Seen: 1.1e-13.
    assert!((of.nominal.value - 0.481_737_672_884).abs() < 1e-11);
    assert_samples_agree(of);
    let second = of.second.as_ref().expect("second derivatives");
    // Three digits are known. Seen: 1.1e-7 and 1.0e-7.
    assert!((second.shift - 1.61e-4).abs() < 1e-6, "{second:?}");
    assert!((second.deviation - 1.47e-4).abs() < 1e-6, "{second:?}");
    assert!(
        of.is_first_order_negligible() && of.first.deviation < 1e-8,
        "{:?}",
        of.first
    );
}

/// m is that of the rest plus the inertia of the crank: linear, and as a number of a normal distribution its yield is known.
#[test]
fn of_a_linear_result_first_order_is_exact() {
    let scene = fixtures::scene("crank-rocker");
    let (inertia, deviation) = (value(&scene, "crank.inertia"), 0.003);
    let given = format!("tolerance crank.inertia~normal({inertia},{deviation})");
    let nominal = tolerance(&scene, 2, &["of m.max", &given]).results[0]
        .nominal
        .value;
    let limits = [1.0, -0.5].map(|z| nominal + z * deviation);
    let [upper, lower] = [
        format!("limit m.max <= {}", limits[0]),
        format!("limit m.max >= {}", limits[1]),
    ];
    let count = 20_000;
    let found = tolerance(&scene, count, &["of m.max", &given, &upper, &lower]);
    let of = &found.results[0];
    // Seen: 1.7e-16.
    assert!((of.first.deviation - deviation).abs() < 1e-14);
    assert_samples_agree(of);
    let second = of.second.as_ref().expect("second derivatives");
    assert!((second.deviation - deviation).abs() < 1e-14);
    // Seen: 7.0e-17.
    assert!(second.shift.abs() < 5e-15);
    assert!(!of.is_first_order_negligible());
    // Φ(1) and Φ(½), from tables.
    let known = [0.841_344_746_068_542_9, 0.691_462_461_274_013_1];
    for (of, known) in found.yields.iter().zip(known) {
        let first = of.first.expect("a yield by first order");
        // Seen: 4.3e-15.
        assert!((first - known).abs() < 1e-13, "{first}");
        let error = (known * (1.0 - known) / count as f64).sqrt();
        let share = of.share;
        assert!((share - known).abs() < 3.0 * error, "{share}");
        // The ends of the interval are the shares from which the one seen is 1.96 standard errors away.
        for end in of.interval {
            let errors = (share - end).abs() / (end * (1.0 - end) / count as f64).sqrt();
            // Seen: 1.5e-8, the digits that are not written.
            assert!((errors - 1.959_964).abs() < 1e-6, "{errors}");
        }
    }
    let inside = known[0] + known[1] - 1.0;
    assert!((found.yields[2].share - inside).abs() < 0.011);
}

/// The energy ½ m v² of a start at velocity v is quadratic in it: shift ½ m σ², variance (m v σ)² + ¼ m² (μ₄ − σ⁴).
#[test]
fn of_a_quadratic_result_second_order_is_exact() {
    let scene = fixtures::scene("crank-rocker");
    let v = value(&scene, "motion.initial-velocity.phi");
    for (form, deviation, kurtosis) in [
        (format!("~normal({v},0.5)"), 0.5, 3.0),
        ("±0.9".to_owned(), 0.9 / 3.0_f64.sqrt(), 1.8),
    ] {
        let given = format!("tolerance motion.initial-velocity.phi{form}");
        let found = tolerance(&scene, 20_000, &["of energy", &given]);
        let of = &found.results[0];
        let m = 2.0 * of.nominal.value / (v * v);
        let variance =
            (m * v * deviation).powi(2) + 0.25 * m * m * (kurtosis - 1.0) * deviation.powi(4);
        let second = of.second.as_ref().expect("second derivatives");
        let size = 0.5 * m * deviation * deviation;
        let error = second.shift / size - 1.0;
        // Seen: 2.2e-12.
        assert!(error.abs() < 1e-10, "{form}: {error:e}");
        let error = second.deviation / variance.sqrt() - 1.0;
        // Seen: 1.1e-14.
        assert!(error.abs() < 1e-12, "{form}: {error:e}");
        assert_samples_agree(of);
    }
}

/// What follows from a number varies with it: the derivative is the whole one.
#[test]
fn tied_numbers_count() {
    let scene = fixtures::scene("crank-rocker");
    let gradient = compute_gradient(&scene, &["energy".to_owned()], false, &no_progress);
    let numbers = gradient.expect("a gradient").results.remove(0).numbers;
    let slope = |path: &str| numbers.iter().find(|n| n.path == path).map(|n| n.slope);
    let [inertia, mass] =
        ["crank.inertia", "coupler.mass"].map(|path| slope(path).expect("a slope"));
    let factor = value(&scene, "coupler.mass") / value(&scene, "crank.inertia");
    let tie = format!("tied coupler.mass={factor}*crank.inertia");
    let found = tolerance(
        &scene,
        2,
        &["of energy", "tolerance crank.inertia±1%", &tie],
    );
    let deviation = found.numbers[0].deviation;
    let whole = (inertia + factor * mass) * deviation;
    assert!((found.results[0].first.deviation - whole.abs()).abs() < 1e-14 * whole.abs());
}

/// Equal links of a redundant parallelogram change together only: the derivative is that along all of them. The coupler moves as a point
/// mass on the crank, and m = Σ I + mass × length².
#[test]
fn links_that_change_together_have_derivatives() {
    let scene = fixtures::scene("parallelogram-three-cranks");
    let given = "tolerance crank.points.B[0]±1%";
    let tie = |link: &str| format!("tied {link}=`crank.points.B[0]`");
    let ties = ["second.points.C[0]", "third.points.F[0]"].map(tie);
    let found = tolerance(&scene, 50, &["of m.max", given, &ties[0], &ties[1]]);
    let slope = 2.0 * value(&scene, "coupler.mass") * value(&scene, "crank.points.B[0]");
    let expected = slope * found.numbers[0].deviation;
    let first = found.results[0].first.deviation;
    // Seen: 1.3e-15.
    assert!((first - expected).abs() < 1e-13, "{first} {expected}");
    let error = study(&scene, 10, &["of m.max", given]).expect_err("no length changes alone");
    assert!(error.to_string().contains("--tied"), "{error}");
}

#[test]
fn in_space_second_order_agrees_with_samples() {
    let scene = fixtures::space_scene("rssr");
    let paths = scene.number_paths();
    let given = paths
        .iter()
        .filter(|p| p.contains(".points.") && value(&scene, p) != 0.0);
    let given: Vec<String> = given.map(|p| format!("tolerance {p}±1%")).collect();
    let mut options = vec!["of m.max", "of q.actuator_force.rms"];
    options.extend(given.iter().map(String::as_str));
    let found = tolerance(&scene, 2000, &options);
    assert_eq!(found.results.len(), 2);
    for of in &found.results {
        assert_samples_agree(of);
        let total: f64 = of.parts().iter().sum();
        let deviation = of.second.as_ref().expect("second derivatives").deviation;
        assert!((total.sqrt() - deviation).abs() < 1e-14 * deviation);
    }
}

/// Extrema that tie are carried over, and errors name the option.
#[test]
fn kinks_and_errors_are_named() {
    let scene = fixtures::space_scene("wobble-plate");
    let path = scene
        .number_paths()
        .into_iter()
        .find(|p| p.ends_with(".mass"))
        .expect("a mass");
    let given = format!("tolerance {path}±1%");
    let found = tolerance(&scene, 2, &["of q.actuator_force.max_abs", &given]);
    assert_eq!(found.results[0].nominal.ties.len(), 1);
    for given in ["tolerance crank.mass=1,2", "tolerance crank.mass±0"] {
        let error = study(&fixtures::scene("crank-rocker"), 2, &["of m.max", given]);
        let error = error.expect_err("no distribution").to_string();
        assert!(error.contains("--tolerance"), "{error}");
    }
    let given = "tolerance crank.inertia±1%";
    let error = study(&fixtures::scene("crank-rocker"), 1, &["of m.max", given]);
    assert!(
        error
            .expect_err("one sample")
            .to_string()
            .contains("2 samples")
    );
}
