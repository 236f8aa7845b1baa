//! Runs of the single-dwell mechanism, printed as programs print them, against its exact reduced model.

use super::{
    ColumnNames, ExportedRuns, ExportedTable, SampleErrors, SampleInterpolation, SampledModel,
    combine_runs,
};
use crate::progress::no_progress;
use crate::unit_runs::compute::compute_unit_runs;
use dwell_dynamics::{Orbit, ReducedState};
use dwell_findings::Table;
use dwell_kinetostatics::{Coefficients, ReducedModel};
use dwell_scene::PlaneScene;
use std::path::Path;

/// Period of the single-dwell mechanism from 1 rad/s, s, of its reference values.
const PERIOD: f64 = 5.419_662_677_064_272;

fn scene(case: &str) -> PlaneScene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(folder.join(case).join("scene.toml")).expect("a scene")
}

/// How a program prints a table.
#[derive(Clone, Copy)]
struct Print {
    separator: &'static str,
    decimal: &'static str,
    digits: usize,
    degrees: bool,
}

const PLAIN: Print = Print {
    separator: ",",
    decimal: ".",
    digits: 16,
    degrees: false,
};

fn text(table: &Table, print: Print) -> String {
    let wanted = [
        "t",
        "phi",
        "phi.velocity",
        "phi.acceleration",
        "phi.actuator_force",
        "slide.normal",
    ];
    let columns: Vec<usize> = wanted
        .iter()
        .map(|name| {
            table
                .columns
                .iter()
                .position(|c| c.name == *name)
                .expect("a column")
        })
        .collect();
    let in_degrees = |k: usize| print.degrees && (1..=3).contains(&k);
    let head = columns.iter().enumerate().map(|(k, &c)| {
        let column = &table.columns[c];
        let unit = column.unit.clone();
        let unit = if in_degrees(k) {
            unit.replace("rad", "deg")
        } else {
            unit
        };
        format!("{} [{unit}]", column.name)
    });
    let mut text = head.collect::<Vec<_>>().join(print.separator) + "\r\n";
    for row in &table.rows {
        let fields = columns.iter().enumerate().map(|(k, &c)| {
            let value = if in_degrees(k) {
                row[c].to_degrees()
            } else {
                row[c]
            };
            format!("{value:.*e}", print.digits - 1).replace('.', print.decimal)
        });
        text += &(fields.collect::<Vec<_>>().join(print.separator) + "\r\n");
    }
    text
}

fn runs(points: usize, print: Print) -> ExportedRuns {
    let scene = scene("single-dwell");
    let runs = compute_unit_runs(&scene, Some(points), &no_progress).expect("runs");
    let [one, two] = [0, 1]
        .map(|k| ExportedTable::read("run.csv", &text(&runs.runs[k], print)).expect("a table"));
    combine_runs([&one, &two], &ColumnNames::default()).expect("reduced parameters")
}

/// Largest differences of m and of a and b of the reaction from the exact model between the positions, relative to the
/// largest value, and that of the period, s.
fn errors(model: &SampledModel) -> [f64; 4] {
    let scene = scene("single-dwell");
    let prepared = crate::PreparedScene::without_loads(&scene).expect("a model");
    let exact = &prepared.model;
    let mut workspace = exact.workspace();
    let mut largest = [0.0_f64; 3];
    let mut differences = [0.0_f64; 3];
    for k in 0..1000 {
        let q = 0.006_283 * f64::from(k) + 0.001;
        let mut at = Coefficients {
            a: vec![0.0; exact.reactions()],
            b: vec![0.0; exact.reactions()],
            ..Coefficients::default()
        };
        exact
            .coefficients(q, &mut workspace, &mut at)
            .expect("coefficients");
        let found = model.values(q).expect("values");
        let slide = prepared
            .reaction_units()
            .iter()
            .position(|(name, _)| name == "slide.normal")
            .expect("the reaction");
        for (i, exact) in [at.m, at.a[slide], at.b[slide]].into_iter().enumerate() {
            largest[i] = largest[i].max(exact.abs());
            differences[i] = differences[i].max((exact - found[[0, 2, 3][i]]).abs());
        }
    }
    let start = ReducedState {
        t: 0.0,
        q: 0.0,
        q_dot: 1.0,
    };
    let period = match Orbit::to_accuracy(model, start, 1e-7) {
        Ok(orbit) => (orbit.period - PERIOD).abs(),
        Err(_) => f64::NAN,
    };
    [0, 1, 2]
        .map(|i| differences[i] / largest[i])
        .into_iter()
        .chain([period])
        .collect::<Vec<_>>()
        .try_into()
        .expect("four")
}

#[test]
fn twelve_digits_at_361_positions_give_the_period_to_a_nanosecond() {
    let print = Print {
        digits: 12,
        ..PLAIN
    };
    let runs = runs(361, print);
    assert!(runs.is_whole_revolution && runs.q.len() == 360);
    let model = SampledModel::new(&runs, SampleInterpolation::Trigonometric, 1);
    let start = ReducedState {
        t: 0.0,
        q: 0.0,
        q_dot: 1.0,
    };
    let orbit = Orbit::new(&model, start).expect("an orbit");
    let [m, a, b, _] = errors(&model);
    println!(
        "m {m:e}, a {a:e}, b {b:e}, period {:e}",
        orbit.period - PERIOD
    );
    assert!(
        (orbit.period - PERIOD).abs() < 1e-9,
        "{:e}",
        orbit.period - PERIOD
    );
    assert!(m < 1e-9 && a < 1e-9 && b < 1e-8, "{m:e} {a:e} {b:e}");
}

#[test]
fn estimates_hold_for_every_number_of_positions_and_digits() {
    use SampleInterpolation::{Cubic, Linear, Trigonometric};
    for points in [37, 73, 181, 361, 721] {
        for digits in [4, 6, 9, 12, 16] {
            let runs = runs(points, Print { digits, ..PLAIN });
            assert!(runs.is_whole_revolution, "{points} {digits}");
            for interpolation in [Linear, Cubic, Trigonometric] {
                let estimate = SampleErrors::of(&runs, interpolation);
                let model = SampledModel::new(&runs, interpolation, 1);
                let [m, a, b, _] = errors(&model);
                println!(
                    "{points} {digits} {interpolation:?}: m {m:.1e} of {:.1e}, a {a:.1e} of {:.1e}, b {b:.1e} of {:.1e}",
                    estimate.sum(0),
                    estimate.sum(2),
                    estimate.sum(3)
                );
                for (k, error) in [(0, m), (2, a), (3, b)] {
                    assert!(
                        error <= estimate.sum(k) + 1e-13,
                        "{points} {digits} {interpolation:?} {k}"
                    );
                }
            }
        }
    }
}

#[test]
fn tables_of_other_programs_are_read() {
    let exact = runs(73, PLAIN);
    let other = Print {
        separator: ";",
        decimal: ",",
        degrees: true,
        ..PLAIN
    };
    for print in [
        other,
        Print {
            separator: "\t",
            ..other
        },
        Print {
            separator: "  ",
            decimal: ".",
            ..PLAIN
        },
    ] {
        let read = runs(73, print);
        for (one, two) in exact.coefficients.iter().zip(&read.coefficients) {
            assert!((one.m - two.m).abs() < 1e-13 && (one.a[0] - two.a[0]).abs() < 1e-13);
        }
    }
    // Comments before the header, a name in quotes, a separator at the end of each row.
    let text = "\u{feff}# made by a program\n# at noon\n\"phi, crank\" [deg];T [N m];\n0;1,5;\n10;1,25D0;\n";
    let table = ExportedTable::read("x.csv", text).expect("a table");
    assert_eq!(table.columns.len(), 2);
    assert_eq!(table.columns[0].name, "phi, crank");
    assert_eq!(table.columns[0].unit.as_deref(), Some("deg"));
    assert_eq!(table.columns[1].values, [1.5, 1.25]);
}

#[test]
fn what_cannot_be_combined_is_named() {
    let scene = scene("single-dwell");
    let both = compute_unit_runs(&scene, Some(73), &no_progress).expect("runs");
    let [one, two] = [0, 1].map(|k| text(&both.runs[k], PLAIN));
    let combined = |one: &str, two: &str, names: &ColumnNames| -> String {
        let tables = [one, two].map(|text| ExportedTable::read("run.csv", text));
        match tables {
            [Ok(one), Ok(two)] => {
                combine_runs([&one, &two], names).map_or_else(|e| e.to_string(), |_| String::new())
            }
            [one, two] => one
                .err()
                .or(two.err())
                .map_or_else(String::new, |e| e.to_string()),
        }
    };
    let names = ColumnNames::default();
    assert_eq!(combined(&one, &two, &names), "");
    let damage = |(k, line): (usize, &str)| match (k, line.split_once(',')) {
        (3, Some((_, rest))) => format!("nan,{rest}\n"),
        _ => format!("{line}\n"),
    };
    let damaged: String = one.lines().enumerate().map(damage).collect();
    for (message, one, two, names) in [
        ("exchanged", two.clone(), one.clone(), names.clone()),
        (
            "no row of numbers",
            "a,b\n".to_owned(),
            two.clone(),
            names.clone(),
        ),
        (
            "no header",
            one.lines().skip(1).collect::<Vec<_>>().join("\n"),
            two.clone(),
            names.clone(),
        ),
        (
            "square of the speed",
            one.clone(),
            two.replacen("phi [rad]", "phi [deg]", 1),
            names.clone(),
        ),
        (
            "rad or deg",
            one.replace(" [rad]", ""),
            two.clone(),
            names.clone(),
        ),
        ("is no finite number", damaged, two.clone(), names.clone()),
        (
            "does not grow in row",
            one.lines()
                .chain(one.lines().skip(1))
                .collect::<Vec<_>>()
                .join("\n"),
            two.clone(),
            names.clone(),
        ),
        (
            "only 0.000000 to",
            one.clone(),
            two.lines().take(20).collect::<Vec<_>>().join("\n"),
            names.clone(),
        ),
        (
            "no column `torque`",
            one.clone(),
            two.clone(),
            ColumnNames {
                force: Some("torque".to_owned()),
                ..names.clone()
            },
        ),
        (
            "an inertia is above zero",
            one.clone(),
            two.replace("phi.actuator_force", "@")
                .replace("slide.normal", "phi.actuator_force")
                .replace('@', "slide.normal"),
            names,
        ),
    ] {
        let found = combined(&one, &two, &names);
        assert!(found.contains(message), "{message}: {found}");
    }
}

/// Run ii at fewer and fewer other positions: the stated error covers that of its interpolation.
#[test]
fn runs_at_other_positions_are_interpolated() {
    let scene = scene("single-dwell");
    let fine = compute_unit_runs(&scene, Some(721), &no_progress).expect("runs");
    let one = ExportedTable::read("i.csv", &text(&fine.runs[0], PLAIN)).expect("a table");
    for stride in [1, 2, 5, 10] {
        let mut uneven = fine.runs[1].clone();
        let last = uneven.rows.len() - 1;
        let rows = uneven.rows.into_iter().enumerate();
        // Of the rows that remain some are left out, so that distances differ.
        let is_kept = |k: usize| k == last || (k.is_multiple_of(stride) && k / stride % 7 != 3);
        uneven.rows = rows
            .filter(|(k, _)| is_kept(*k))
            .map(|(_, row)| row)
            .collect();
        let two = ExportedTable::read("ii.csv", &text(&uneven, PLAIN)).expect("a table");
        let runs = combine_runs([&one, &two], &ColumnNames::default()).expect("reduced parameters");
        let model = SampledModel::new(&runs, SampleInterpolation::Trigonometric, 1);
        let stated = SampleErrors::of(&runs, SampleInterpolation::Trigonometric);
        let [m, a, b, _] = errors(&model);
        for (k, error) in [(0, m), (2, a), (3, b)] {
            println!("every {stride}: {k} {error:.1e} of {:.1e}", stated.sum(k));
            assert!(error <= stated.sum(k) + 1e-13, "every {stride}: {k}");
        }
        assert!(stride > 1 || (m < 1e-9 && a < 1e-8), "{m:e} {a:e}");
    }
}

/// Runs of another program: its moments are within 1.2e-6 of the exact ones, and with them m and the period.
#[test]
fn runs_of_exudyn_give_the_reduced_model() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/foreign");
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).expect("a file");
    let names = ColumnNames::read("columns.toml", &read("columns.toml")).expect("names");
    for case in ["single-dwell", "crank-rocker"] {
        let [one, two] = ["i", "ii"].map(|run| {
            let file = format!("{case}-run-{run}.csv");
            ExportedTable::read(&file, &read(&file)).expect("a table")
        });
        let runs = combine_runs([&one, &two], &names).expect("reduced parameters");
        let scene = scene(case);
        let prepared = crate::PreparedScene::without_loads(&scene).expect("a model");
        let mut workspace = prepared.model.workspace();
        let stated = SampleErrors::of(&runs, SampleInterpolation::Trigonometric);
        let (mut differences, mut largest) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (q, found) in runs.q.iter().zip(&runs.coefficients) {
            let exact = prepared
                .model
                .inertia(*q, &mut workspace)
                .expect("an inertia");
            for (i, (found, exact)) in [(found.m, exact.0), (found.half_dm, exact.1)]
                .into_iter()
                .enumerate()
            {
                differences[i] = differences[i].max((found - exact).abs());
                largest[i] = largest[i].max(exact.abs());
            }
        }
        for i in [0, 1] {
            let error = differences[i] / largest[i];
            println!("{case} {i}: {error:.1e} of {:.1e}", stated.sum(i));
            // Its own error, of its step, is in no table: 1.2e-6 at most by its script.
            assert!(error <= stated.sum(i) + 5e-6, "{case} {i}: {error:e}");
        }
    }
}

/// The time per column does not grow with the number of columns: positions between the rows are evaluated for drawn
/// columns only.
#[test]
fn thousands_of_columns_take_seconds() {
    let rows = 37;
    let table = |accelerates: bool| {
        let q: Vec<f64> = (0..rows)
            .map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(rows - 1))
            .collect();
        let a = f64::from(u8::from(accelerates));
        let v = |q: f64| if accelerates { (2.0 * q).sqrt() } else { 1.0 };
        let of = |f: &dyn Fn(f64) -> f64| q.iter().map(|q| f(*q)).collect::<Vec<f64>>();
        let force = |q: f64| (2.0 + q.cos()) * a - 0.5 * q.sin() * v(q).powi(2);
        let mut columns = vec![
            ("phi [rad]".to_owned(), q.clone()),
            ("phi.velocity [rad/s]".to_owned(), of(&v)),
            ("phi.acceleration [rad/s2]".to_owned(), of(&|_| a)),
            ("phi.actuator_force [N m]".to_owned(), of(&force)),
        ];
        columns.extend((0..10_000).map(|k| (format!("joint{k}.x [N]"), of(&force))));
        ExportedTable::of_columns("run.npz", columns)
    };
    let tables = [table(false), table(true)];
    let begun = std::time::Instant::now();
    let found = super::reduce_runs(
        "run",
        [&tables[0], &tables[1]],
        &ColumnNames::default(),
        None,
    );
    assert!(found.is_ok());
    let took = begun.elapsed().as_secs_f64();
    assert!(took < 10.0, "{took} s");
}
