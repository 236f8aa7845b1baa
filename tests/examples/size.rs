//! What a pose of IFToMM's A02 costs against its size, and what its answers are worth towards the
//! flat position: `cargo run --release --example size` writes `reports/size.png`.
#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a study, run by hand"
)]

use dwell_kinetostatics::Model;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series, Stroke, png};
use dwell_tests::chain::{counting_scalar, links};
use std::path::Path;
use std::time::Instant;

/// Numbers of four-bars.
const SIZES: [usize; 9] = [1, 3, 10, 30, 100, 300, 1000, 3000, 10000];
/// A time is the least of this many runs.
const TIMED_RUNS: usize = 7;
/// Four-bars of the definition, whose errors are drawn.
const CHAIN_LENGTH: usize = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut operations, mut times) = (Vec::new(), Vec::new());
    for n in SIZES {
        let start = Instant::now();
        let model = links::model(n);
        let built = start.elapsed().as_secs_f64();
        operations.push([n as f64, counting_scalar::operations(&model) as f64]);
        times.push([n as f64, time(&model, n) * 1e6]);
        let [poses, spent] = [&operations, &times].map(|all| all.last().map_or(0.0, |[_, y]| *y));
        println!(
            "{n:>6} four-bars: built in {built:.3} s, {poses} operations and {spent:.2} µs a pose"
        );
    }
    let figure = Figure {
        name: "size".into(),
        title: "A chain of N four-bars (IFToMM A02)".into(),
        caption: "Cost: one pose with its motion, its torque and all 6 N + 2 reactions; the operations are counted \
                  exactly, the time is the least of several runs on this machine. Accuracy: 40 four-bars with gravity, \
                  ω = 1 rad/s and α = 0.5 rad/s², against statics by hand from the free end; relative to the largest force, \
                  which itself grows as 1/|sin θ|. A pose rounded to ε is known to ε/|sin θ|, and so are then the forces \
                  that are found from it by another division."
            .into(),
        columns: 2,
        panels: vec![
            cost_panel("Operations", "operations per pose", "", operations),
            cost_panel("Time", "time per pose", "µs", times),
            accuracy_panel(),
        ],
..Figure::default()
};
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("size.png"), png(&figure)?)?;
    Ok(())
}

/// Seconds of one pose.
fn time(model: &Model, n: usize) -> f64 {
    let mut workspace = model.workspace::<f64>();
    let mut result = model.result_buffer();
    // All of them at θ between 1 and 2.4.
    let poses = (20_000 / n).max(3);
    let mut min = f64::INFINITY;
    for run in 0..TIMED_RUNS {
        let start = Instant::now();
        for pose in 0..poses {
            let q = 1.0 + 1e-5 * (run * poses + pose) as f64;
            let done = model.inverse_dynamics(&[q], &[0.9], &[-0.6], &mut workspace, &mut result);
            done.expect("a pose");
        }
        min = min.min(start.elapsed().as_secs_f64() / poses as f64);
    }
    min
}

fn cost_panel(title: &str, label: &str, unit: &str, points: Vec<[f64; 2]>) -> Panel {
    let slope = points.get(points.len() / 2).map(|&through| Mark::Slope {
        order: 1.0,
        through,
        label: "slope 1".into(),
    });
    Panel::from(Chart {
        title: title.into(),
        x: Axis::log("four-bars N", ""),
        y: Axis::log(label, unit),
        series: vec![Series::line("", points).stroke(Stroke::LineAndPoints)],
        marks: slope.into_iter().collect(),
        ..Chart::default()
    })
}

/// Errors from |sin θ| = 0.5 to 0.001.
fn accuracy_panel() -> Panel {
    let model = links::model(CHAIN_LENGTH);
    let sines = (0..=40).map(|k| 0.5 * 10.0_f64.powf(-2.7 * f64::from(k) / 40.0));
    let (mut torque, mut force) = (Vec::new(), Vec::new());
    for sine in sines {
        let errors = links::errors(&model, CHAIN_LENGTH, [sine.asin(), 1.0, 0.5]);
        torque.push([sine, errors[0].max(f64::EPSILON / 8.0)]);
        force.push([sine, errors[1]]);
    }
    println!("flat: torque {:?}, force {:?}", torque.last(), force.last());
    Panel::from(Chart {
        title: "Towards the flat position, where every loop is singular".into(),
        x: Axis::log("|sin θ|", ""),
        y: Axis::log("relative error", ""),
        marks: force
            .last()
            .map(|&through| Mark::Slope {
                order: -2.0,
                through,
                label: "1/sin²θ".into(),
            })
            .into_iter()
            .collect(),
        series: vec![
            Series::line("torque", torque).stroke(Stroke::LineAndPoints),
            Series::line("worst reaction", force).stroke(Stroke::LineAndPoints),
        ],
        ..Chart::default()
    })
}
