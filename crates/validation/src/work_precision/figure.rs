//! The figure: cost over true error, with the Pareto front.

use super::combination::{
    CombinationResult, CostMeasure, ErrorQuantity, Evaluation, Integrator, WorkPrecision,
    digits_or_dash,
};
use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_scene::SceneFile;
use dwell_study::number_format::{count, digits};
use dwell_study::output::{chart, figure as scene_figure};
use dwell_study::ranges::extent;

/// Margin at the outermost errors, as a factor.
const AXIS_MARGIN: f64 = 4.0;
/// Larger errors are not drawn: the motion is a different one.
const MAX_ERROR: f64 = 10.0;
/// Smallest distance, in powers of ten, of the labelled points of a front.
const MIN_LABEL_GAP: f64 = 1.6;
const MIN_LABEL_GAP_CROWDED: f64 = 3.0;

/// The figure of a study.
pub(super) fn figure(scene: &SceneFile, found: &WorkPrecision, name: &str) -> Figure {
    let tables =
        |p: &CombinationResult| matches!(p.combination.evaluation, Evaluation::Table { .. });
    let hollow = if found.points.iter().any(tables) {
        "; hollow: tables, without their build time; dashed: build time of the finest table"
    } else {
        ""
    };
    let reference_error = found.reference.error;
    let text = format!(
        "Each mark is one combination over t = 0 to {} s. Full marks: the mechanism itself, one tolerance after \
         the other; where time is measured, crosses: single precision{hollow}. Grey line: the Pareto front, \
         with names. Reference: {}; shaded: below its error ({}, {} and {} of the three errors). An evaluation \
         is one of the equation of motion; a Jacobian counts as its dual numbers. Time is in units of one \
         exact evaluation in the same process, the least of {}. {}",
        digits(found.duration, 5),
        found.reference.method,
        digits(reference_error.coordinate, 1),
        digits(reference_error.energy, 1),
        digits_or_dash(reference_error.reaction, 1),
        count(found.repetitions, "run"),
        found.requested.idle_text(),
    );
    let panels = [
        (ErrorQuantity::Coordinate, CostMeasure::Evaluations),
        (ErrorQuantity::Coordinate, CostMeasure::Time),
        (ErrorQuantity::Energy, CostMeasure::Evaluations),
        (ErrorQuantity::Reaction, CostMeasure::Evaluations),
    ]
    .map(|(quantity, measure)| panel(found, quantity, measure));
    let panels = panels.into_iter().chain([requested(found)]);
    let (title, provenance) = (
        "Work–precision diagram",
        "all combinations of evaluation, integrator and tolerance",
    );
    Figure {
        columns: 2,
        ..scene_figure(scene, name, title, &text, panels.collect(), provenance)
    }
}

fn panel(found: &WorkPrecision, quantity: ErrorQuantity, measure: CostMeasure) -> Panel {
    let at = |point: &CombinationResult| -> [f64; 2] {
        [found.error_bound(point, quantity), point.cost.of(measure)]
    };
    let front: Vec<&CombinationResult> = found
        .pareto_front(quantity, measure)
        .into_iter()
        .map(|k| &found.points[k])
        .collect();
    let line = front.iter().map(|point| at(point)).collect();
    let mut series = vec![Series::line("", line).color(Paint::Grey)];
    series.extend(method_series(found, measure, &at));
    if measure == CostMeasure::Time {
        let all = commands(found).into_iter();
        series.extend(all.filter(|series| !series.points.is_empty()));
    }
    let reference_error = found.reference.error.of(quantity);
    let mut marks = vec![Mark::Band {
        from: reference_error / AXIS_MARGIN.powi(3),
        to: reference_error,
        label: String::new(),
    }];
    if let Some(point) = found.quadrature() {
        marks.push(Mark::Point {
            at: at(point),
            label: "quadrature".to_owned(),
        });
    }
    let build_times = found.points.iter().map(|p| p.cost.build_time);
    let build_time = build_times.fold(0.0, f64::max);
    if measure == CostMeasure::Time && build_time > 0.0 {
        marks.push(Mark::horizontal(
            build_time,
            "build time of the finest table",
        ));
    }
    let (label_gap, cost) = if measure == CostMeasure::Evaluations {
        (MIN_LABEL_GAP, "evaluations")
    } else {
        (MIN_LABEL_GAP_CROWDED, "time / one exact evaluation")
    };
    marks.extend(named_points(&front, label_gap, &at));
    let coordinate = "largest error of the free coordinates";
    let (title, label) = match (quantity, measure) {
        (ErrorQuantity::Coordinate, CostMeasure::Evaluations) => {
            ("Coordinate, counted", coordinate)
        }
        (ErrorQuantity::Coordinate, _) => ("Coordinate, timed", coordinate),
        (ErrorQuantity::Energy, _) => ("Energy", "largest energy drift / largest kinetic energy"),
        (ErrorQuantity::Reaction, _) => (
            "Worst reaction",
            "largest error of a reaction / largest of its unit",
        ),
    };
    let (x, y) = (error_axis(found, quantity, label), Axis::log(cost, ""));
    Panel::from(Chart {
        marks,
        ..chart(title, x, y, series)
    })
}

/// The cost of the requested results.
fn requested(found: &WorkPrecision) -> Panel {
    let of = &found.requested;
    let line = Series::line("", of.by_reactions.clone()).stroke(Stroke::LineAndPoints);
    let (idle, time) = of.without_idle;
    let without_idle = (idle > 0).then(|| {
        let point = Series::line("without idle groups", vec![[0.0, time]]);
        point.stroke(Stroke::Points)
    });
    let x = Axis::new("requested reactions", "");
    let y = Axis::new("time / one evaluation without reactions", "");
    let title = "What is requested";
    let curves = [Some(line), without_idle].into_iter().flatten();
    Panel::from(chart(title, x, y, curves.collect()))
}

/// The command at its accuracies and the exported code with steps of 1 ms, over the error of the coordinate.
fn commands(found: &WorkPrecision) -> [Series; 2] {
    let (unit, floor) = (found.evaluation_time, found.reference.error.coordinate);
    let commands = found
        .commands
        .iter()
        .map(|of| [of.errors.coordinate.max(floor), of.computing / unit]);
    let steps = found
        .fixed_step
        .map_or(f64::NAN, |fixed| fixed.steps as f64);
    let codes = found
        .exported_code
        .iter()
        .map(|code| [code.errors.coordinate.max(floor), steps * code.times[1][0]]);
    [
        Series::line("simulate --accuracy", commands.collect())
            .stroke(Stroke::LineAndPoints)
            .color(Paint::Ink),
        Series::line("exported C, 1 ms", codes.collect())
            .stroke(Stroke::Points)
            .color(Paint::Grey),
    ]
}

/// The runs of every method: those of the mechanism itself and, in time, on tables and in single precision.
fn method_series(
    found: &WorkPrecision,
    measure: CostMeasure,
    at: &dyn Fn(&CombinationResult) -> [f64; 2],
) -> Vec<Series> {
    let mut series = Vec::new();
    for (i, method) in Method::ALL.into_iter().enumerate() {
        let of = |selects: &dyn Fn(Evaluation) -> bool| -> Vec<[f64; 2]> {
            let selected = |point: &&CombinationResult| {
                let of = point.combination;
                let own = matches!(of.integrator, Integrator::Steps(own, _) if own == method);
                own && selects(of.evaluation)
            };
            found.points.iter().filter(selected).map(at).collect()
        };
        let paint = Paint::Palette(i);
        let exact = Series::line(method.name(), of(&|e| e == Evaluation::Exact));
        series.push(exact.stroke(Stroke::LineAndPoints).color(paint));
        // The numbers of evaluations of the others equal those of the mechanism itself.
        if measure != CostMeasure::Evaluations {
            let tables = Series::line("", of(&|e| matches!(e, Evaluation::Table { .. })));
            let single = Series::line("", of(&|e| e == Evaluation::SinglePrecision));
            series.push(tables.stroke(Stroke::Hollow).color(paint));
            series.push(single.stroke(Stroke::Crosses).color(paint));
        }
    }
    series
}

/// The axis of the errors, from below the error of the reference to the largest error drawn.
fn error_axis(found: &WorkPrecision, quantity: ErrorQuantity, label: &str) -> Axis {
    let all = found.points.iter().map(|p| found.error_bound(p, quantity));
    let [min, max] = extent(all.filter(|e| e.is_finite() && *e > 0.0));
    let max = max.min(MAX_ERROR);
    let unit = match quantity {
        ErrorQuantity::Coordinate => found.unit,
        ErrorQuantity::Energy | ErrorQuantity::Reaction => "",
    };
    if min < max {
        Axis::log(label, unit).with_range(min / AXIS_MARGIN, max * AXIS_MARGIN)
    } else {
        Axis::log(label, unit)
    }
}

/// The names of some points of a front, well apart.
fn named_points(
    front: &[&CombinationResult],
    label_gap: f64,
    at: &dyn Fn(&CombinationResult) -> [f64; 2],
) -> Vec<Mark> {
    let mut last = f64::INFINITY;
    let mut marks = Vec::new();
    for point in front {
        let position = at(point);
        if last - position[0].log10() < label_gap {
            continue;
        }
        last = position[0].log10();
        marks.push(Mark::Text {
            at: position,
            label: point.combination.name(),
        });
    }
    marks
}
