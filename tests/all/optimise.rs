//! Jobs with known optima: closed forms, and optima that SciPy found with a model of its own. The conditions of an optimum are
//! confirmed by differences of results of the sweep.

use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::optimise::{Optimised, job_number, optimise, optimise_front};
use dwell_study::{SweepRequest, compute_request, no_progress};
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("all/optimise")
        .join(name)
}

fn scene(name: &str) -> PlaneScene {
    PlaneScene::read(file(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn job(scene: &PlaneScene, name: &str) -> Optimised {
    let number = job_number(scene, Some(name)).expect("a job");
    let found = optimise(scene, number, 1, &no_progress);
    found.unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn solved(file: &str, name: &str) -> Optimised {
    job(&scene(file), name)
}

fn assert_certified(found: &Optimised) {
    assert_eq!(found.certificate.doubt, None, "{}", found.job);
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} instead of {expected}"
    );
}

fn assert_places(found: &Optimised, expected: &[f64], tolerance: f64) {
    for (number, expected) in found.numbers.iter().zip(expected) {
        assert_near(number.after, *expected, tolerance);
    }
}

/// The largest part of the derivative of the Lagrangian by a number, in parts of the goal's first value and over the range of the number,
/// by central differences of results of the sweep: ∇F = Σ price ∇R + prices of bounds.
fn residual_by_differences(scene: &PlaneScene, found: &Optimised) -> f64 {
    let assigned: Vec<(&str, f64)> = found
        .assigned
        .iter()
        .map(|(p, v)| (p.as_str(), *v))
        .collect();
    let best = scene.with_values(&assigned).expect("the better scene");
    let mut results = vec![found.goal.clone()];
    let active: Vec<_> = found
        .conditions
        .iter()
        .filter(|of| of.price.is_some())
        .collect();
    results.extend(active.iter().map(|of| of.text.clone()));
    let size = found.before.unwrap_or(found.after).abs();
    let mut largest = 0.0_f64;
    for number in &found.numbers {
        let range = number.bounds[1] - number.bounds[0];
        let step = 1e-5 * range;
        let [low, high] = [number.after - step, number.after + step];
        let vary = [format!("{}={low:?},{high:?}", number.path)];
        let request = SweepRequest {
            vary: &vary,
            requests: &results,
            ..SweepRequest::default()
        };
        let swept = compute_request(&best, &request, &no_progress).expect("a sweep");
        let column = |name: &str| {
            let mut columns = swept.table.columns.iter();
            columns
                .position(|column| column.name == name)
                .expect("a column")
        };
        let slope = |name: &str| {
            let k = column(name);
            (swept.table.rows[1][k] - swept.table.rows[0][k]) / (2.0 * step)
        };
        let mut rest = slope(&found.goal) - number.bound_price.unwrap_or(0.0);
        for of in &active {
            rest -= of.price.unwrap_or(0.0) * slope(&of.text);
        }
        largest = largest.max((rest * range / size).abs());
    }
    largest
}

#[test]
fn two_counterweights_balance_the_shaking_force_of_a_four_bar() {
    // R. S. Berkof and G. G. Lowen (1969): exactly zero at (−1/10, 3/875, −21/160, −3/700).
    let found = solved("shaking.toml", "force");
    assert_certified(&found);
    assert_near(
        found.before.expect("a goal"),
        0.167_464_134_765_092_56,
        1e-15,
    );
    // Seen: 2e-15 N and 9.4e-16 m, from 10 of 10 starts.
    assert!(found.after < 1e-13);
    assert_places(
        &found,
        &[-0.1, 3.0 / 875.0, -21.0 / 160.0, -3.0 / 700.0],
        9e-14,
    );
    assert_eq!((found.starts, found.optima[0].count), ([10, 0], 10));
}

#[test]
fn least_torques_are_those_of_scipy() {
    let found = solved("four-bar.toml", "torque");
    assert_certified(&found);
    // Seen: 3.2e-15.
    assert_near(found.after, 0.481_737_672_884_11, 3e-13);
    assert_places(
        &found,
        &[-0.154_803_15, -0.067_710_95, -0.021_301_46, 0.047_305_38],
        1e-8,
    );
    assert_eq!(found.optima.len(), 1);
    let found = solved("shaking.toml", "sum");
    assert_certified(&found);
    // Seen: 8.9e-16.
    assert_near(found.after, 1.246_644_981_858_27, 8e-14);
    let found = solved("four-bar.toml", "constrained");
    assert_certified(&found);
    // Of 1e4 times the mean square at unit speed.
    assert_near(found.after.sqrt() / 100.0, 0.033_358_726_1, 1e-9);
    assert!(found.conditions[0].price.expect("active") < 0.0);
}

#[test]
fn three_peaks_tie_where_the_largest_is_least() {
    let found = solved("four-bar.toml", "peak");
    assert_certified(&found);
    // Seen: 5e-13.
    assert_near(found.after, 0.785_117_118_851, 2e-11);
    let mut multipliers: Vec<f64> = found.peaks.iter().map(|peak| peak.multiplier).collect();
    multipliers.sort_by(f64::total_cmp);
    assert_eq!(multipliers.len(), 3);
    for (found, expected) in multipliers.iter().zip([0.113_285, 0.421_887, 0.464_828]) {
        assert_near(*found, expected, 1e-6);
    }
}

#[test]
fn springs_that_carry_a_weight_leave_directions_open() {
    let found = solved("lamp.toml", "stiffness");
    assert_certified(&found);
    // m g r / (h 0.2). Seen: 2.8e-14, and 7.1e-15 and 6.6e-16 below.
    assert_near(found.numbers[0].after, 220.725, 2e-12);
    assert!(found.certificate.flat.is_empty());
    let found = solved("lamp.toml", "both");
    assert_certified(&found);
    let [stiffness, height] = [&found.numbers[0], &found.numbers[1]];
    assert_near(stiffness.after * height.after, 22.0725, 7e-13);
    // d ln k = −d ln h.
    let flat = &found.certificate.flat[0];
    assert_near(
        flat[0] / stiffness.after + flat[1] / height.after,
        0.0,
        6e-14,
    );
    let found = solved("spring.toml", "spring");
    assert_certified(&found);
    assert_near(found.after, 0.563_859_684_598_42, 3e-14);
    assert_eq!(found.certificate.flat.len(), 1);
}

#[test]
fn lengths_and_ten_numbers_have_the_optimum_and_the_prices_of_scipy() {
    let lengths = scene("lengths.toml");
    let found = job(&lengths, "lengths");
    assert_certified(&found);
    // Seen: 2.7e-11, and 8e-9 of places, where conditions hold within 1e-9.
    assert_near(found.after, 1.219_892_222_49, 2e-9);
    assert_places(
        &found,
        &[0.123_236_750_0, 0.315_386_948_3, 0.408_523_662_9],
        1e-8,
    );
    assert_near(found.conditions[0].price.expect("active"), 2.398_846, 1e-5);
    // Per radian of the largest angle; the source has it per unit of its cosine.
    let by_cosine = -found.conditions[1].price.expect("active") / 140_f64.to_radians().sin();
    assert_near(by_cosine, 0.373_384, 1e-5);
    assert!(found.conditions[2].price.is_none());
    // Seen: 2.8e-7, by differences.
    let residual = residual_by_differences(&lengths, &found);
    assert!(residual < 1e-5, "{residual:e}");
    let ten = scene("lengths-ten.toml");
    let found = job(&ten, "ten");
    assert_certified(&found);
    assert_near(found.after, 0.187_842_164_565, 1e-9);
    assert_near(found.conditions[0].price.expect("active"), 0.748_651, 2e-5);
    assert_near(
        -found.numbers[3].bound_price.expect("at a bound") * -0.3,
        0.141_22,
        // Seen: 1.8e-7, and 2.7e-7 above.
        1e-5,
    );
    // Seen: 200 of 200 starts.
    assert!(found.optima[0].count >= 160, "{:?}", found.optima);
    let residual = residual_by_differences(&ten, &found);
    assert!(residual < 1e-5, "{residual:e}");
}

#[test]
fn tables_of_functions_and_paths_are_fitted() {
    let found = solved("function.toml", "function");
    assert_certified(&found);
    assert_near(found.after.to_degrees(), 0.012_874_755_496, 3e-11);
    let found = solved("timed.toml", "path");
    assert_certified(&found);
    // The rounding of the points: 3.356e-7 by the source's own fit.
    assert_near(found.after, 3.356_33e-7, 1e-11);
}

#[test]
fn the_curve_of_mcgarva_is_met_as_closely_as_is_known() {
    let found = solved("mcgarva.toml", "path");
    assert_certified(&found);
    // An orthogonal distance regression by SciPy has 0.415820.
    assert_near(found.after, 0.415_820_1, 5e-7);
}

#[test]
fn a_front_goes_from_one_least_to_the_other_and_its_slope_is_its_derivative() {
    let scene = scene("shaking.toml");
    let number = job_number(&scene, Some("front")).expect("a job");
    let front = optimise_front(&scene, number, 1, &no_progress).expect("a front");
    let (first, last) = (&front.points[0], &front.points[front.points.len() - 1]);
    // Both ends: (0, 0.030196) and (0.052585, 0.007665).
    // Seen: 1.2e-14; the others are as good as the digits of the source.
    assert_near(first.goals[0], 0.0, 1e-12);
    assert_near(first.goals[1], 0.030_196, 1e-6);
    // The end may exceed the least second goal by 1e-6 of its extent, which changes the first by the root of that.
    assert_near(last.goals[0], 0.052_585, 2e-4);
    assert_near(last.goals[1], 0.007_665, 1e-6);
    for pair in front.points.windows(2) {
        assert!(pair[0].goals[0] < pair[1].goals[0] && pair[0].goals[1] > pair[1].goals[1]);
    }
    for three in front.points[1..].windows(3) {
        let [a, b, c] = [&three[0], &three[1], &three[2]].map(|point| point.goals);
        let (low, high) = ((b[0] - a[0]) / (b[1] - a[1]), (c[0] - b[0]) / (c[1] - b[1]));
        let slope = three[1].slope.expect("a slope");
        assert!(
            (low.min(high)..=low.max(high)).contains(&slope),
            "{low} {slope} {high}"
        );
    }
}

/// The path of a coupler point by complex numbers: of a crank, a coupler, a rocker and a ground of these lengths.
fn coupler_points(count: usize) -> Vec<[f64; 2]> {
    let ([a, b, c, d], [u, v]) = ([0.3, 0.7, 0.6, 0.8], [0.35, 0.4]);
    let point = |k: usize| {
        let q = std::f64::consts::TAU * (k as f64 + 0.3) / count as f64;
        let (x, y) = (a * q.cos(), a * q.sin());
        let gap = (d - x).hypot(y);
        let along = (b * b - c * c + gap * gap) / (2.0 * gap);
        let across = (b * b - along * along).sqrt();
        let (e, f) = ((d - x) / gap, -y / gap);
        let (e, f) = ((along * e - across * f) / b, (along * f + across * e) / b);
        [x + u * e - v * f, y + u * f + v * e]
    };
    (0..count).map(point).collect()
}

#[test]
fn nine_points_of_a_known_four_bar_are_found_exactly() {
    let folder = std::env::temp_dir().join(format!("dwell-nine-points-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let points = coupler_points(9);
    let rows: String = points
        .iter()
        .map(|[x, y]| format!("{x:?},{y:?}\n"))
        .collect();
    std::fs::write(
        folder.join("nine.csv"),
        format!("coupler.P.x,coupler.P.y\n{rows}"),
    )
    .expect("a file");
    let text = std::fs::read_to_string(file("timed.toml")).expect("a scene");
    let text = text.replace(
        "table = \"timed.csv\", at = \"phi\"",
        "table = \"nine.csv\"",
    );
    let path = folder.join("nine.toml");
    std::fs::write(&path, text).expect("a file");
    let scene = PlaneScene::read(&path).expect("a scene");
    let found = job(&scene, "path");
    std::fs::remove_dir_all(&folder).expect("the folder");
    assert_certified(&found);
    // Seen: 8e-17.
    assert!(found.after < 8e-15, "{}", found.after);
}

#[test]
fn what_no_design_satisfies_is_not_certified() {
    let text = std::fs::read_to_string(file("four-bar.toml")).expect("a scene");
    let text = text.replace(
        "phi.actuator_force.rms <= 0.55",
        "phi.actuator_force.rms <= 0.1",
    );
    let scene = PlaneScene::parse("impossible", &text).expect("a scene");
    let found = job(&scene, "constrained");
    assert!(found.certificate.doubt.is_some() && !found.is_admissible());
    assert_eq!(found.starts[0], found.starts[1]);
}

#[test]
fn a_scene_that_cannot_be_assembled_still_has_a_best_design() {
    let text = std::fs::read_to_string(file("lengths.toml")).expect("a scene");
    // The crank is longer than the others can follow.
    let text = text
        .replace("B = [0.1, 0] }", "B = [2.0, 0] }")
        .replace("starts = 200", "starts = 20");
    let scene = PlaneScene::parse("torn", &text).expect("a scene");
    let found = job(&scene, "lengths");
    assert_certified(&found);
    assert_eq!(found.before, None);
    assert_near(found.after, 1.219_892_222_49, 1e-9);
}

/// A counterweight on the driven hinge of a mechanism in space: the mean square of a torque is a polynomial of degree four in its place,
/// through five results of the sweep.
#[test]
fn a_counterweight_in_space_is_where_a_polynomial_of_results_is_least() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../validation/spatial/rssr-haug.toml");
    let text = std::fs::read_to_string(path).expect("a scene");
    let job = "[optimise.balance]\nvary = { \"rotor.center[1]\" = [-1, 1] }\nminimise = \"q.actuator_force.rms\"\nstarts = 3\npool = 6\n";
    let scene = SpaceScene::parse("balance", &format!("{text}\n{job}")).expect("a scene");
    let found = optimise(&scene, 0, 1, &no_progress).expect("a design");
    assert_eq!(found.certificate.doubt, None);
    let square = |places: &[f64]| -> Vec<f64> {
        let list: Vec<String> = places.iter().map(|x| format!("{x:?}")).collect();
        let vary = [format!("rotor.center[1]={}", list.join(","))];
        let results = [found.goal.clone()];
        let request = SweepRequest {
            vary: &vary,
            requests: &results,
            ..SweepRequest::default()
        };
        let swept = compute_request(&scene, &request, &no_progress).expect("a sweep");
        let mut columns = swept.table.columns.iter();
        let k = columns
            .position(|column| column.name == found.goal)
            .expect("a column");
        swept.table.rows.iter().map(|row| row[k] * row[k]).collect()
    };
    let at = found.numbers[0].after;
    let h = 0.05;
    let [a, b, c, d] = square(&[at - 2.0 * h, at - h, at + h, at + 2.0 * h])[..] else {
        panic!("four results");
    };
    // The derivative of a polynomial of degree four from four values.
    let slope = (8.0 * (c - b) - (d - a)) / (12.0 * h);
    let curvature = (b + c - 2.0 * found.after * found.after) / (h * h);
    let off = slope / curvature;
    // Seen: 3.2e-15.
    assert!(curvature > 0.0 && off.abs() < 3e-13, "{off:e}");
}
