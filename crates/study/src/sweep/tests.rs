//! Points compared with other analyses, references and theory.

use crate::explain::SweepError;
use crate::find_value;
use crate::models::PreparedScene;
use crate::sweep::compute::{Design, RequestedQuantities, VariantFamily};
use crate::sweep::spread::Spread;
use dwell_scene::PlaneScene;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

fn case(name: &str) -> PlaneScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(folder.join(name).join("scene.toml")).expect("a scene")
}

fn words(texts: &[&str]) -> Vec<String> {
    texts.iter().map(|&word| word.to_owned()).collect()
}

fn names(requested: &RequestedQuantities) -> Vec<&str> {
    requested
        .quantities
        .iter()
        .map(|q| q.name.as_str())
        .collect()
}

/// The results of one point, by name.
fn at(scene: &PlaneScene, requests: &[&str], values: &[(&str, f64)]) -> Vec<f64> {
    let requested = RequestedQuantities::new(scene, &words(requests)).expect("results");
    let result = requested.evaluate(scene, values);
    assert_eq!(result.message, None);
    result.values
}

#[test]
fn the_period_is_that_of_the_reference_and_of_calibrate() {
    let scene = case("single-dwell");
    let period = |inertia: f64| at(&scene, &["period"], &[("crank.inertia", inertia)])[0];
    // 50 digits of an independent program; the sum of some tens of square roots errs by a few roundings.
    let reference = 5.419_662_677_064_27;
    assert!((period(0.626) - reference).abs() < 1e-14 * reference);
    let result = find_value(&scene, "crank.inertia", 5.42).expect("a value");
    assert!((period(result.value) - 5.42).abs() < 1e-14 * 5.42);
}

#[test]
fn inertia_is_that_of_reduce_and_linear_in_the_cranks() {
    let scene = case("single-dwell");
    let prepared = PreparedScene::new(&scene).expect("a model");
    let extent_at = |points: usize| {
        let found = crate::reduce::compute::ReducedCurves::new(&prepared, Some(points));
        crate::ranges::extent(found.expect("a table").coefficients.iter().map(|at| at.m))
    };
    let ([min, max], dense) = (extent_at(721), extent_at(46_081));
    let result = at(&scene, &["m"], &[("crank.inertia", 0.626)]);
    // The extrema lie between the positions: beyond those of the positions, and as positions 64 times as dense show them.
    assert!(result[0] < min && result[1] > max, "{result:?} {min} {max}");
    for (found, dense) in result.iter().zip(dense) {
        assert!((found / dense - 1.0).abs() < 1e-7, "{found} {dense}");
    }
    // Of a crank on the ground its inertia is added to m: a rounding or two of m.
    let heavier = at(&scene, &["m"], &[("crank.inertia", 1.626)]);
    for (now, then) in heavier.iter().zip(result) {
        assert!((now - then - 1.0).abs() < 4.0 * f64::EPSILON * now);
    }
}

#[test]
fn peaks_are_those_of_kinetostatics() {
    let scene = case("slider-crank");
    let peaks = at(
        &scene,
        &["phi.actuator_force", "guide.normal"],
        &[("crank.mass", 2.0)],
    );
    let run = crate::analyse_trajectory(
        &scene,
        crate::Analysis::Kinetostatics,
        None,
        &crate::no_progress,
    );
    let outcome = run.expect("a trajectory").outcome;
    let files = outcome.files.iter();
    let table = files
        .filter(|(name, _)| {
            name.to_string_lossy()
                .ends_with("kinetostatics-extrema.csv")
        })
        .map(|(_, bytes)| String::from_utf8_lossy(bytes).into_owned())
        .next()
        .expect("a table");
    // Quantity, unit, smallest value and its place, largest value and its place; both look between the positions.
    let largest = |name: &str| {
        let line = table
            .lines()
            .find(|line| line.starts_with(&format!("{name},")));
        let cells: Vec<&str> = line.expect("a row").split(',').collect();
        let [min, max] = [2, 4].map(|k| cells[k].parse::<f64>().expect("a number").abs());
        min.max(max)
    };
    for (peak, name) in peaks.iter().zip(["phi.actuator_force", "guide.normal"]) {
        assert!(
            (peak / largest(name) - 1.0).abs() < 1e-12,
            "{name}: {peak} {}",
            largest(name)
        );
    }
}

#[test]
fn sections_decide_what_there_is() {
    let known = |name: &str| {
        let scene = case(name);
        let requested = RequestedQuantities::new(&scene, &[]).expect("results");
        names(&requested).join(" ")
    };
    let reduced = "m.min m.max half_dm.min half_dm.max range.lower range.upper";
    assert_eq!(
        known("single-dwell"),
        format!("{reduced} period energy slide.normal.max_abs")
    );
    // A weight, and a motion that keeps its energy; no prescribed motion, so that peaks are those at rest.
    assert!(known("pendulum-a01").starts_with(&format!(
        "{reduced} period energy phi.actuator_force.max_abs"
    )));
    assert!(!known("slider-crank").contains("period"));
    let requested = RequestedQuantities::new(&case("single-dwell"), &words(&["perod"]));
    let message = requested.expect_err("no such result");
    assert_eq!(message.to_string(), "this scene has no result `perod`");
}

#[test]
fn a_pendulums_energy_is_its_height() {
    // Level at rest: E = m g y with y = 0, where the potential of a weight is zero at the origin. T of a release at a quarter of a
    // revolution is 4 √(l/g) K(sin 45°), with K(½) = 1.85407467730137 (the parameter is m = k²).
    let result = at(
        &case("pendulum-a01"),
        &["period", "energy"],
        &[("bar.mass", 3.0)],
    );
    let exact = 4.0 * (1.0 / 9.81_f64).sqrt() * 1.854_074_677_301_372;
    // A few roundings of the quadrature, and those of the position at π.
    assert!((result[0] - exact).abs() < 1e-13 * exact);
    assert!(result[1].abs() < 1e-13);
}

#[test]
fn a_linear_result_is_spread_as_what_it_follows_from() {
    let scene = case("single-dwell");
    let vary = words(&["crank.inertia~normal(0.626,0.002)", "coupler.mass±1%"]);
    let samples = 4000;
    let design = Design::new(&scene, &vary, Some(samples), 5).expect("a design");
    let requested = RequestedQuantities::new(&scene, &words(&["m.max"])).expect("results");
    // m is linear in both: m = I + c₁ M + …; c₁ from two points.
    let m = |inertia: f64, mass: f64| {
        at(
            &scene,
            &["m.max"],
            &[("crank.inertia", inertia), ("coupler.mass", mass)],
        )[0]
    };
    let slope = m(0.626, 2.5) - m(0.626, 1.5);
    let mean = m(0.626, 1.5);
    let variance = 0.002_f64.powi(2) + (slope * 0.015).powi(2) / 3.0;
    let values: Vec<f64> = (0..samples)
        .into_par_iter()
        .map(|k| {
            let values = design.values(k);
            let values = [("crank.inertia", values[0]), ("coupler.mass", values[1])];
            requested.evaluate(&scene, &values).values[0]
        })
        .collect();
    let spread = Spread::of(values.into_iter()).expect("values");
    let deviation = variance.sqrt();
    // Two standard errors: σ/√n of the mean, and no more than σ/√2n of the deviation of what is not peaked.
    let error = deviation / (samples as f64).sqrt();
    assert!((spread.mean - mean).abs() < 2.0 * error, "{spread:?}");
    let found = spread.deviation.expect("samples");
    assert!(
        (found - deviation).abs() < 2.0 * error / 2_f64.sqrt(),
        "{found} {deviation}"
    );
}

#[test]
fn points_are_all_combinations_with_the_same_samples() {
    let scene = case("single-dwell");
    let vary = words(&[
        "crank.inertia=0.5:0.7:3",
        "coupler.mass~uniform(1,2)",
        "rocker.mass=0.7,0.8",
    ]);
    let design = Design::new(&scene, &vary, Some(4), 9).expect("a design");
    assert_eq!(design.points, 24);
    let all: Vec<Vec<f64>> = (0..24).map(|k| design.values(k)).collect();
    let grid: Vec<[f64; 2]> = all.iter().step_by(4).map(|v| [v[0], v[2]]).collect();
    let expected = [0.5, 0.6, 0.7].map(|a| [[a, 0.7], [a, 0.8]]).concat();
    assert_eq!(grid, expected);
    for four in all.chunks(4) {
        let samples = |rows: &[Vec<f64>]| rows.iter().map(|v| v[1]).collect::<Vec<f64>>();
        assert_eq!(samples(four), samples(&all[..4]));
        assert!(four.iter().all(|v| (1.0..2.0).contains(&v[1])));
    }
    let different: BTreeSet<u64> = all[..4].iter().map(|v| v[1].to_bits()).collect();
    assert_eq!(different.len(), 4);
    // Another seed is another sample.
    let other = Design::new(&scene, &vary, Some(4), 10).expect("a design");
    assert_ne!(other.values(0)[1], all[0][1]);
}

#[test]
fn the_page_has_every_statistic() {
    let page = include_str!("../../../../docs/sweep.md");
    for (_, name, meaning) in crate::trajectory::compute::STATISTICS {
        assert!(
            page.contains(&format!("| `.{name}` | {meaning} |")),
            "{name}"
        );
    }
}

#[test]
fn nonsense_is_refused() {
    let scene = case("single-dwell");
    let refused = |vary: &str, samples: Option<u64>| {
        let error = Design::new(&scene, &words(&[vary]), samples, 0).expect_err("nonsense");
        assert!(matches!(
            error,
            SweepError::Axis { .. } | SweepError::Design(_)
        ));
    };
    for vary in [
        "crank.inertia",
        "crank.inertia=",
        "crank.inertia=1:2",
        "crank.inertia=1:2:0",
        "crank.inertia=1:2:1",
        "crank.inertia=1:1:5",
        "crank.inertia=1:2:-3",
        "crank.inertia=1:2:99999999",
        "crank.inertia=NaN:2:3",
        "crank.inertia=1,inf",
        "crank.inertia=1,,2",
        "crank.innertia=1,2",
        "=1,2",
    ] {
        refused(vary, None);
    }
    for vary in [
        "crank.inertia~normal(1)",
        "crank.inertia~normal(1,0)",
        "crank.inertia~normal(1,NaN)",
        "crank.inertia~uniform(2,1)",
        "crank.inertia~gauss(2,1)",
        "crank.inertia±0",
        "crank.inertia±-1%",
    ] {
        refused(vary, Some(10));
    }
    refused("crank.inertia±1%", None);
    refused("crank.inertia±1%", Some(0));
    refused("crank.inertia=1,2", Some(3));
    refused("crank.inertia±1%", Some(u64::MAX));
}

/// Results of `simulate` and `cycle`, at the scene's own numbers, are those of these analyses; the mean speed times the
/// period is a revolution, and the mean of a speed over time the change of its coordinate.
#[test]
fn results_of_motions_and_cycles_are_those_of_the_analyses() {
    let scene = case("slider-crank-friction");
    let requests = words(&["motion", "cycle"]);
    let requested = RequestedQuantities::new(&scene, &requests).expect("results");
    let result = requested.evaluate(&scene, &[("crank.inertia", 0.004)]);
    assert_eq!(result.message, None);
    let value = |name: &str| {
        let found = requested.quantities.iter().position(|q| q.name == name);
        result.values[found.unwrap_or_else(|| panic!("no {name}"))]
    };
    assert!(result.values.iter().all(|value| value.is_finite()));
    assert_eq!(value("motion.end"), 0.25);
    let turned = value("motion.phi.end") - 0.5;
    // The trapezoids of 1000 intervals, against the exact mean.
    let mean = value("motion.phi.velocity.mean");
    assert!(
        (mean - turned / 0.25).abs() < 1e-4 * mean,
        "{mean} {turned}"
    );
    assert!(value("motion.phi.velocity.rms") >= mean);
    assert!(value("motion.phi.velocity.max_abs") >= value("motion.phi.velocity.rms"));
    let revolution = value("cycle.mean_speed") * value("cycle.period");
    assert!((revolution - std::f64::consts::TAU).abs() < 1e-9);
    let (slow, fast) = (value("cycle.slowest_speed"), value("cycle.fastest_speed"));
    let fluctuation = (fast - slow) / value("cycle.mean_speed");
    assert!((fluctuation - value("cycle.coefficient_of_fluctuation")).abs() < 1e-9);
    assert!(value("cycle.motor.work") > 0.0 && value("cycle.motor.max_abs") > 0.0);
    // They take an integration each: none is computed unless it is requested.
    let all = RequestedQuantities::new(&scene, &[]).expect("results");
    assert!(
        names(&all)
            .iter()
            .all(|name| !name.starts_with("motion") && !name.starts_with("cycle"))
    );
}

/// A variant without a steady cycle, or whose motion ends early, has a message and no value.
#[test]
fn a_variant_without_a_cycle_is_named() {
    let scene = case("slider-crank-friction");
    let requested = RequestedQuantities::new(&scene, &words(&["cycle"])).expect("results");
    let weak = requested.evaluate(&scene, &[("drives.motor.voltage", 0.5)]);
    assert!(weak.message.is_some());
    assert!(weak.values.iter().all(|value| value.is_nan()));
}

/// A sweep point by point: in the structure of its family, and each by a compilation of its own.
fn both_ways(
    scene: &PlaneScene,
    vary: &[&str],
    requests: &[&str],
) -> [Vec<(Vec<f64>, Option<String>)>; 2] {
    let design = Design::new(scene, &words(vary), None, 0).expect("a design");
    let requested = RequestedQuantities::new(scene, &words(requests)).expect("results");
    let family = VariantFamily::new(scene, &design, &requested);
    let indices: Vec<u64> = (0..design.points).collect();
    let numbers = indices.iter().map(|&k| design.numbers(&design.values(k)));
    let (numbers, mut filled): (Vec<Vec<f64>>, usize) = (numbers.collect(), 0);
    let of_family = family.as_ref().expect("a family");
    of_family.evaluate(&numbers, &requested.quantities, &mut |_, found| {
        filled += usize::from(found.is_some());
    });
    assert!(filled > 0, "{vary:?}");
    [family.as_ref(), None].map(|family| {
        let mut rows = Vec::new();
        requested.points(scene, &design, family, &indices, &mut |row| {
            rows.push((row.result.values, row.result.message));
        });
        rows
    })
}

#[test]
fn points_of_a_family_have_the_results_of_points_compiled_one_by_one() {
    let requests = ["m", "half_dm", "range", "period", "energy"];
    let with_reaction = [&requests[..], &["slide"]].concat();
    for (case_name, vary, requests) in [
        (
            "single-dwell",
            // From cranks that rotate to some that do not, and to masses that are none.
            &[
                "crank.points.B[0]=60:280:12",
                "coupler.mass=-1,0,1.5",
                "motion.initial-velocity.phi=0,1,-2",
            ][..],
            &with_reaction[..],
        ),
        (
            "crank-rocker",
            &[
                "ground.points.D[0]=3:6:13",
                "ground.points.D[1]=-1:1:3",
                "crank.center[0]=0,0.5",
            ][..],
            &requests[..],
        ),
    ] {
        let scene = case(case_name);
        let [family, compiled] = both_ways(&scene, vary, requests);
        // Extremes as a part of the curve's largest magnitude; about sharp ones the search between 721 positions stops 1e-11
        // short of them.
        let size = |row: &[f64], k: usize| match k {
            0..4 => row[k & 2].abs().max(row[k | 1].abs()),
            _ => row[k].abs(),
        };
        for (one, other) in family.iter().zip(&compiled) {
            assert_eq!(one.1, other.1, "{case_name}");
            for (k, (a, b)) in one.0.iter().zip(&other.0).enumerate() {
                let difference = (a - b).abs();
                let same = a.is_nan() && b.is_nan() || difference <= 1e-10 * size(&other.0, k);
                assert!(same, "{case_name}, result {k}: {one:?} {other:?}");
            }
        }
        let failed = compiled.iter().filter(|row| row.1.is_some()).count();
        assert!(failed > 0 && failed < compiled.len(), "{failed}");
    }
}

#[test]
fn forces_of_a_family_under_loads_are_those_of_points_compiled_one_by_one() {
    for (case_name, vary, requests, tolerance) in [
        // Over a turn at constant velocity, by constant loads; to cranks that do not rotate, and to dampers that are none.
        (
            "watt-six-bar",
            &[
                "crank.points.B[0]=0.09:0.4:6",
                "link5.mass=0.5,2",
                "loads.dashpot.damping=-1,0,60",
            ][..],
            &[
                "m",
                "phi.actuator_force",
                "G",
                "phi.actuator_force.rms",
                "G.x.min",
            ][..],
            // The search between 361 positions of two turns stops at most 1.3e-12 short of the peak.
            1e-10,
        ),
        // By a law of the coordinate, along the scene's own positions.
        (
            "slider-crank",
            &["crank.points.B[0]=60:100:5", "piston.mass=0.5,2"],
            &["phi.actuator_force", "guide.normal", "B", "B.x.rms"],
            // At most 6e-16.
            5e-14,
        ),
        // By a law of a travel whose points vary.
        (
            "whitworth",
            &[
                "arm.points.E[0]=-90:-70:3",
                "ram.mass=10,14",
                "ram.points.tool[1]=-80,-40",
            ],
            &["phi.actuator_force", "guide", "phi.actuator_force.mean"],
            5e-14,
        ),
    ] {
        let scene = case(case_name);
        let [family, compiled] = both_ways(&scene, vary, requests);
        for (one, other) in family.iter().zip(&compiled) {
            assert_eq!(one.1, other.1, "{case_name}");
            for (k, (a, b)) in one.0.iter().zip(&other.0).enumerate() {
                let difference = (a - b).abs();
                let same = a.is_nan() && b.is_nan() || difference <= tolerance * b.abs();
                assert!(same, "{case_name}, result {k}: {one:?} {other:?}");
            }
        }
    }
}

#[test]
fn directions_have_no_family() {
    let scene = case("single-dwell");
    for vary in ["joints.slide.axis[1]=0:0.1:3", "assembly.coupler=1.3,1.4"] {
        let design = Design::new(&scene, &words(&[vary]), None, 0).expect("a design");
        let requested = RequestedQuantities::new(&scene, &words(&["m"])).expect("results");
        assert!(
            VariantFamily::new(&scene, &design, &requested).is_none(),
            "{vary}"
        );
    }
}

#[test]
fn the_reaction_of_the_free_rotation_is_that_of_the_integrated_motion() {
    let scene = case("single-dwell");
    let requests = [
        "slide.normal.max_abs",
        "motion.slide.normal.max_abs",
        "place",
    ];
    let requested = RequestedQuantities::new(&scene, &words(&requests)).expect("results");
    let result = at(&scene, &requests, &[("coupler.mass", 1.6)]);
    let value = |name: &str| {
        result[names(&requested)
            .iter()
            .position(|n| *n == name)
            .expect(name)]
    };
    let (free, integrated) = (
        value("slide.normal.max_abs"),
        value("motion.slide.normal.max_abs"),
    );
    // Integrated over ten periods to 1e-10.
    assert!(
        (free / integrated - 1.0).abs() < 1e-8,
        "{free} {integrated}"
    );
    let place = value("place.m.max");
    let m_there = |q: f64| {
        let scene = scene.with_value("coupler.mass", 1.6).expect("a scene");
        let model = crate::models::reduced_model(&scene, &[]).expect("a model");
        let mut workspace = dwell_kinetostatics::ReducedModel::workspace(&model);
        dwell_kinetostatics::ReducedModel::inertia(&model, q, &mut workspace)
            .expect("a pose")
            .0
    };
    let m_max = at(&scene, &["m.max"], &[("coupler.mass", 1.6)])[0];
    assert!((m_there(place) - m_max).abs() < 1e-14 * m_max);
}
