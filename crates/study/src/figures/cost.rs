//! What accuracy costs: energy drift in time, and error against work.

use super::caption;
use crate::prepare::Prepared;
use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_verify::{FreeMotion, Rung};

/// Tolerances whose drift is drawn, as powers of ten.
const DRAWN: [i32; 4] = [-6, -8, -10, -12];
/// Times a drift is drawn at, each the largest drift of its interval.
const INTERVALS: usize = 300;

/// Energy drift against time at several tolerances.
pub(crate) fn drift(prepared: &Prepared<'_>, motion: &FreeMotion) -> Figure {
    let panel = |method: Method| {
        let at = |&power: &i32| {
            let same = |r: &&Rung| {
                r.method == method && (r.tolerance.log10() - f64::from(power)).abs() < 0.1
            };
            motion.rungs.iter().find(same)
        };
        let series = DRAWN
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
        name: "e-drift".to_owned(),
        title: "Energy drift".to_owned(),
        caption: caption(
            prepared,
            "The energy of the free motion is constant; what is drawn is the integrators' own error at their steps, the \
             largest so far. It is far above the tolerance, which bounds the error of one step.",
        ),
        columns: 1,
        panels: vec![panel(Method::Bdf), panel(Method::Tsit45)],
        provenance: ladder(motion),
    }
}

/// The integrators and tolerances that are compared.
fn ladder(motion: &FreeMotion) -> String {
    let tolerances = motion.rungs.iter().map(|r| r.tolerance);
    let largest = tolerances.clone().fold(0.0, f64::max);
    let least = tolerances.fold(f64::INFINITY, f64::min);
    let [bdf, other] = [Method::Bdf, Method::Tsit45].map(Method::name);
    format!("reduced model, {bdf} and {other}, tolerances {largest:.0e} to {least:.0e}")
}

/// The largest drift so far, at equal distances of time.
fn envelope(rung: &Rung) -> Vec<[f64; 2]> {
    let end = rung.drift_in_time.last().map_or(1.0, |d| d[0]);
    let (mut largest, mut next) = (0.0_f64, 0);
    let mut points = Vec::new();
    for [t, drift] in &rung.drift_in_time {
        largest = largest.max(*drift);
        // The first hundredth, where the drift comes up from nothing, would only stretch the axis.
        if *t >= 0.01 * end && *t >= end * f64::from(next) / INTERVALS as f64 {
            points.push([*t, largest]);
            next = (*t / end * INTERVALS as f64) as u32 + 1;
        }
    }
    points
}

/// Error against evaluations and time over the ladder of tolerances.
pub(crate) fn cost(prepared: &Prepared<'_>, motion: &FreeMotion) -> Figure {
    let of = |method: Method, x: fn(&Rung) -> f64, y: fn(&Rung) -> f64| {
        let rungs = motion.rungs.iter().filter(move |r| r.method == method);
        Series::line(method.name(), rungs.map(|r| [x(r), y(r)]).collect())
            .stroke(Stroke::LineAndPoints)
    };
    let both = |x: fn(&Rung) -> f64, y: fn(&Rung) -> f64| {
        vec![of(Method::Bdf, x, y), of(Method::Tsit45, x, y)]
    };
    let tolerances = |y: fn(&Rung) -> f64| {
        let mut series = both(|r| r.tolerance, y);
        series.push(
            Series::line("error = tolerance", vec![[1e-13, 1e-13], [1e-4, 1e-4]])
                .stroke(Stroke::Dashed)
                .color(Paint::Grey),
        );
        series
    };
    let evaluations: fn(&Rung) -> f64 = |r| (r.work.evaluations + r.work.jacobians) as f64;
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
    let work = || Axis::log("evaluations of the equation of motion", "");
    Figure {
        name: "g-cost".to_owned(),
        title: "Cost against error".to_owned(),
        caption: caption(
            prepared,
            "Each point is one tolerance from 1e-4 to 1e-13, relative and absolute alike, over all turns of the motion. \
             Period: the first whole turn against the quadrature. Energy: its largest drift. Reaction: the largest error \
             at the steps against the exact state at the same time, relative to the largest reaction. Wall times \
             are the least of three runs on this machine, with other threads beside them.",
        ),
        columns: 2,
        panels: vec![
            chart(
                "Energy drift",
                work(),
                "largest |E / E₀ − 1|",
                both(evaluations, |r| r.drift),
                vec![],
            ),
            chart(
                "Period",
                work(),
                "relative error of the period",
                both(evaluations, |r| r.period_error),
                vec![],
            ),
            chart(
                "Reactions",
                work(),
                "largest relative error",
                both(evaluations, |r| r.reaction_error),
                vec![],
            ),
            chart(
                "Time",
                Axis::log("wall time", "ms"),
                "largest |E / E₀ − 1|",
                both(|r| r.seconds * 1e3, |r| r.drift),
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
        provenance: ladder(motion),
    }
}
