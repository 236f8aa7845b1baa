//! What accuracy costs: energy drift in time, and error against work.

use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_study::PreparedScene;
use dwell_study::output::caption;
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
        Panel::from(Chart {
            title: method.name().to_owned(),
            x: Axis::new("time", "s"),
            y: Axis::log("largest |E / E₀ − 1| so far", ""),
            series,
            ..Chart::default()
        })
    };
    Figure {
        name: "energy-drift".to_owned(),
        title: "Energy drift".to_owned(),
        caption: caption(
            prepared,
            "The energy of the free motion is constant; what is drawn is the integrators' own error at their steps, the \
             largest so far. It is far above the tolerance, which bounds the error of one step.",
        ),
        columns: 1,
        panels: vec![panel(Method::Bdf), panel(Method::Tsit45)],
        provenance: tolerances_text(motion),
    }
}

/// The integrators and tolerances that are compared.
fn tolerances_text(motion: &CheckedFreeMotion) -> String {
    let tolerances = motion.tolerance_runs.iter().map(|r| r.tolerance);
    let max = tolerances.clone().fold(0.0, f64::max);
    let min = tolerances.fold(f64::INFINITY, f64::min);
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
        // The first hundredth, where the drift comes up from nothing, would only stretch the axis.
        if *t >= 0.01 * end && *t >= end * f64::from(next) / INTERVALS as f64 {
            points.push([*t, max_drift]);
            next = (*t / end * INTERVALS as f64) as u32 + 1;
        }
    }
    points
}

/// Error against evaluations and time over the ladder of tolerances.
pub(crate) fn work_precision(prepared: &PreparedScene<'_>, motion: &CheckedFreeMotion) -> Figure {
    let of = |method: Method, x: fn(&ToleranceRun) -> f64, y: fn(&ToleranceRun) -> f64| {
        let runs = motion
            .tolerance_runs
            .iter()
            .filter(move |r| r.method == method);
        Series::line(method.name(), runs.map(|r| [x(r), y(r)]).collect())
            .stroke(Stroke::LineAndPoints)
    };
    let both = |x: fn(&ToleranceRun) -> f64, y: fn(&ToleranceRun) -> f64| {
        vec![of(Method::Bdf, x, y), of(Method::Tsit45, x, y)]
    };
    let tolerances = |y: fn(&ToleranceRun) -> f64| {
        let mut series = both(|r| r.tolerance, y);
        series.push(
            Series::line("error = tolerance", vec![[1e-13, 1e-13], [1e-4, 1e-4]])
                .stroke(Stroke::Dashed)
                .color(Paint::Grey),
        );
        series
    };
    let evaluations: fn(&ToleranceRun) -> f64 =
        |r| (r.statistics.evaluations + r.statistics.jacobians) as f64;
    let chart = |title: &str, x: Axis, y: &str, series: Vec<Series>, marks: Vec<Mark>| {
        Panel::from(Chart {
            title: title.to_owned(),
            x,
            y: Axis::log(y, ""),
            series,
            marks,
            ..Chart::default()
        })
    };
    let evaluations_axis = || Axis::log("evaluations of the equation of motion", "");
    Figure {
        name: "work-precision".to_owned(),
        title: "Cost against error".to_owned(),
        caption: caption(
            prepared,
            "Each point is one tolerance from 1e-4 to 1e-13, relative and absolute alike, over all revolutions of the motion. \
             Period: the first revolution against the quadrature. Energy: its largest drift. Reaction: the largest error \
             at the steps against the exact state at the same time, relative to the largest reaction. Wall times are minima of three runs on this machine, while other threads were running.",
        ),
        columns: 2,
        panels: vec![
            chart(
                "Energy drift",
                evaluations_axis(),
                "largest |E / E₀ − 1|",
                both(evaluations, |r| r.drift),
                vec![],
            ),
            chart(
                "Period",
                evaluations_axis(),
                "relative error of the period",
                both(evaluations, |r| r.period_error),
                vec![],
            ),
            chart(
                "Reactions",
                evaluations_axis(),
                "largest relative error",
                both(evaluations, |r| r.reaction_error),
                vec![],
            ),
            chart(
                "Time",
                Axis::log("wall time", "ms"),
                "largest |E / E₀ − 1|",
                both(|r| r.wall_time * 1e3, |r| r.drift),
                vec![],
            ),
            chart(
                "What a tolerance is worth",
                Axis::log("tolerance", ""),
                "largest |E / E₀ − 1|",
                tolerances(|r| r.drift),
                vec![],
            ),
            chart(
                "What a tolerance is worth",
                Axis::log("tolerance", ""),
                "largest relative error of a reaction",
                tolerances(|r| r.reaction_error),
                vec![],
            ),
        ],
        provenance: tolerances_text(motion),
    }
}
