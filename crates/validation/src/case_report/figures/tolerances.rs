//! The cost of accuracy: energy drift in time, and error against work.

use dwell_dynamics::Method;
use dwell_report::{Axis, Figure, Paint, Panel, Series, Stroke};
use dwell_study::PreparedScene;
use dwell_study::output::{chart, figure};
use dwell_study::ranges::extent;
use dwell_verify::{CheckedFreeMotion, ToleranceRun};

/// Tolerances whose drift is drawn, as powers of ten.
const DRAWN_EXPONENTS: [i32; 4] = [-6, -8, -10, -12];
/// Times a drift is drawn at, each the largest drift of its interval.
const INTERVALS: usize = 300;

/// Energy drift against time at several tolerances.
pub(crate) fn drift(prepared: &PreparedScene<'_>, motion: &CheckedFreeMotion) -> Figure {
    let panel = |method: Method| {
        let at = |&power: &i32| {
            let is_run = |r: &&ToleranceRun| {
                r.method == method && (r.tolerance.log10() - f64::from(power)).abs() < 0.1
            };
            motion.tolerance_runs.iter().find(is_run)
        };
        let series = DRAWN_EXPONENTS
            .iter()
            .filter_map(at)
            .map(|r| Series::line(format!("tolerance {:.0e}", r.tolerance), envelope(r)))
            .collect();
        let y = Axis::log("largest |E / E₀ − 1| so far", "");
        chart(method.name(), Axis::new("time", "s"), y, series).into()
    };
    figure(
        prepared.scene,
        "energy-drift",
        "Energy drift",
        "The energy of the free motion is constant; what is drawn is the error of the integrators at their steps, the \
         largest so far. It is far above the tolerance, which bounds the error of one step.",
        vec![panel(Method::Bdf), panel(Method::Tsit45)],
        tolerances_text(motion),
    )
}

/// The integrators and tolerances that are compared.
fn tolerances_text(motion: &CheckedFreeMotion) -> String {
    let tolerances = motion.tolerance_runs.iter().map(|r| r.tolerance);
    let [min, max] = extent(tolerances);
    let [bdf, other] = [Method::Bdf, Method::Tsit45].map(Method::name);
    format!("reduced model, {bdf} and {other}, tolerances {max:.0e} to {min:.0e}")
}

/// The largest drift so far, at equal distances of time.
fn envelope(run: &ToleranceRun) -> Vec<[f64; 2]> {
    let end = run.drift_over_time.last().map_or(1.0, |d| d[0]);
    let (mut max_drift, mut next) = (0.0_f64, 0);
    let mut points = Vec::new();
    for [t, drift] in &run.drift_over_time {
        max_drift = max_drift.max(*drift);
        // The first hundredth, where the drift grows from zero, would only stretch the axis.
        if *t >= 0.01 * end && *t >= end * f64::from(next) / INTERVALS as f64 {
            points.push([*t, max_drift]);
            next = (*t / end * INTERVALS as f64) as u32 + 1;
        }
    }
    points
}

/// Error against evaluations and time over all tolerances.
pub(crate) fn work_precision(prepared: &PreparedScene<'_>, motion: &CheckedFreeMotion) -> Figure {
    type Value = fn(&ToleranceRun) -> f64;
    let of = |method: Method, x: Value, y: Value| {
        let runs = motion.tolerance_runs.iter();
        let runs = runs.filter(|r| r.method == method).map(|r| [x(r), y(r)]);
        Series::line(method.name(), runs.collect()).stroke(Stroke::LineAndPoints)
    };
    let panel = |title: &str, (axis, x): &(Axis, Value), (label, y): (&str, Value)| -> Panel {
        let mut series = vec![of(Method::Bdf, *x, y), of(Method::Tsit45, *x, y)];
        if axis.label == "tolerance" {
            let diagonal = vec![[1e-13, 1e-13], [1e-4, 1e-4]];
            let equal = Series::line("error = tolerance", diagonal).stroke(Stroke::Dashed);
            series.push(equal.color(Paint::Grey));
        }
        chart(title, axis.clone(), Axis::log(label, ""), series).into()
    };
    let count: Value = |r| (r.statistics.evaluations + r.statistics.jacobians) as f64;
    let evaluations = (Axis::log("evaluations of the equation", ""), count);
    let tolerance: (Axis, Value) = (Axis::log("tolerance", ""), |r| r.tolerance);
    let time: (Axis, Value) = (Axis::log("wall time", "ms"), |r| r.wall_time * 1e3);
    let drift: (&str, Value) = ("largest |E / E₀ − 1|", |r| r.drift);
    let period: (&str, Value) = ("relative error of the period", |r| r.period_error);
    let reaction: (&str, Value) = ("largest relative error", |r| r.reaction_error);
    let of_reaction = ("largest relative error of a reaction", reaction.1);
    let mut text =
        "Each point is one tolerance from 1e-4 to 1e-13, relative and absolute alike, over all revolutions of the motion. \
         Period: the first revolution against the quadrature. Energy: its largest drift. "
            .to_owned();
    let mut panels = vec![
        panel("Energy drift", &evaluations, drift),
        panel("Period", &evaluations, period),
        panel("Time", &time, drift),
        panel("Error over tolerance", &tolerance, drift),
    ];
    // Reactions that are zero have no relative error.
    let runs = motion.tolerance_runs.iter();
    if runs.map(reaction.1).any(|error| error > 0.0) {
        panels.insert(2, panel("Reactions", &evaluations, reaction));
        panels.push(panel("Error over tolerance", &tolerance, of_reaction));
        text += "Reaction: the largest error at the steps against the exact state at the same time, relative to the \
                 largest reaction. ";
    }
    text +=
        "Wall times are minima of three runs on this machine, while other threads were running.";
    let (name, title, provenance) = (
        "work-precision",
        "Cost against error",
        tolerances_text(motion),
    );
    Figure {
        columns: 2,
        ..figure(prepared.scene, name, title, &text, panels, provenance)
    }
}
