//! The picture: cost over true error, with the front.

use super::combination::{
    Combination, CostMeasure, ErrorQuantity, Evaluation, Integrator, WorkPrecision, digits_or_dash,
};
use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_scene::Scene;
use dwell_study::number_format::{count, digits};
use dwell_study::output::scene_caption;

/// Room beside the outermost errors, as a factor.
const AXIS_MARGIN: f64 = 4.0;
/// An error larger than this is none: the motion is another one.
const MAX_ERROR: f64 = 10.0;
/// How far apart in powers of ten the points of a front are whose names are written, and of one among many marks.
const MIN_LABEL_GAP: f64 = 1.6;
const MIN_LABEL_GAP_CROWDED: f64 = 3.0;

/// The picture of a study.
pub(super) fn figure(scene: &Scene, found: &WorkPrecision, name: &str) -> Figure {
    let coordinate = format!("largest error of the free coordinates, {}", found.unit);
    let energy = "largest energy drift / largest kinetic energy";
    let reaction = "largest error of a reaction / largest of its unit";
    let tables =
        |p: &super::CombinationResult| matches!(p.combination.evaluation, Evaluation::Table { .. });
    let hollow = match found.points.iter().any(tables) {
        true => "; hollow: tables, once they are made; dashed: making the finest",
        false => "",
    };
    let reference_error = found.reference.error;
    Figure {
        name: name.to_owned(),
        title: "What accuracy costs".to_owned(),
        caption: scene_caption(
            scene,
            &format!(
                "Each mark is one combination over t = 0 to {} s. Full marks: the mechanism itself, one tolerance after \
                 the other; where time is measured, crosses: single precision{hollow}. Grey line: the Pareto front, \
                 with names. Truth: {}; shaded: below what is known ({}, {} and {} of the three errors). An evaluation \
                 is one of the equation of motion; a Jacobian counts as its dual numbers. Time is in units of one \
                 exact evaluation in the same process, the least of {}.",
                digits(found.duration, 5),
                found.reference.method,
                digits(reference_error.coordinate, 1),
                digits(reference_error.energy, 1),
                digits_or_dash(reference_error.reaction, 1),
                count(found.repetitions, "run"),
            ),
        ),
        columns: 2,
        panels: vec![
            panel(
                found,
                ErrorQuantity::Coordinate,
                CostMeasure::Evaluations,
                &coordinate,
            ),
            panel(
                found,
                ErrorQuantity::Coordinate,
                CostMeasure::Time,
                &coordinate,
            ),
            panel(
                found,
                ErrorQuantity::Energy,
                CostMeasure::Evaluations,
                energy,
            ),
            panel(
                found,
                ErrorQuantity::Reaction,
                CostMeasure::Evaluations,
                reaction,
            ),
        ],
        provenance: "all combinations of evaluation, integrator and tolerance".to_owned(),
    }
}

fn panel(
    found: &WorkPrecision,
    quantity: ErrorQuantity,
    measure: CostMeasure,
    label: &str,
) -> Panel {
    let at = |k: usize| -> [f64; 2] {
        let point = &found.points[k];
        [found.error_bound(point, quantity), point.cost.of(measure)]
    };
    let front = found.pareto_front(quantity, measure);
    let line = front.iter().map(|&k| at(k)).collect();
    let mut series = vec![Series::line("", line).color(Paint::Grey)];
    for (i, method) in Method::ALL.into_iter().enumerate() {
        let of = |selects: &dyn Fn(Evaluation) -> bool| -> Vec<[f64; 2]> {
            let selected = |k: &usize| {
                let Combination {
                    evaluation,
                    integrator,
                } = found.points[*k].combination;
                matches!(integrator, Integrator::Steps(own, _) if own == method)
                    && selects(evaluation)
            };
            (0..found.points.len()).filter(selected).map(at).collect()
        };
        let paint = Paint::Palette(i);
        let exact = of(&|e| e == Evaluation::Exact);
        series.push(
            Series::line(method.name(), exact)
                .stroke(Stroke::LineAndPoints)
                .color(paint),
        );
        let kinds: [(Stroke, &dyn Fn(Evaluation) -> bool); 2] = [
            (Stroke::Hollow, &|e| matches!(e, Evaluation::Table { .. })),
            (Stroke::Crosses, &|e| e == Evaluation::SinglePrecision),
        ];
        // Counted, they are what the mechanism itself is.
        for (stroke, selects) in kinds
            .into_iter()
            .filter(|_| measure != CostMeasure::Evaluations)
        {
            series.push(Series::line("", of(selects)).stroke(stroke).color(paint));
        }
    }
    let reference_error = found.reference.error.of(quantity);
    let mut marks = vec![Mark::Band {
        from: reference_error / AXIS_MARGIN.powi(3),
        to: reference_error,
        label: String::new(),
    }];
    if let Some(point) = found.quadrature() {
        marks.push(Mark::Point {
            at: [found.error_bound(point, quantity), point.cost.of(measure)],
            label: "quadrature".to_owned(),
        });
    }
    let build_time = found.points.iter().map(|p| p.cost.build_time);
    let build_time = build_time.fold(0.0, f64::max);
    if measure == CostMeasure::Time && build_time > 0.0 {
        marks.push(Mark::Horizontal {
            at: build_time,
            label: "making the finest table".to_owned(),
        });
    }
    let label_gap = match measure {
        CostMeasure::Evaluations => MIN_LABEL_GAP,
        CostMeasure::Time | CostMeasure::TimeWithBuild => MIN_LABEL_GAP_CROWDED,
    };
    marks.extend(named_points(found, &front, label_gap, &at));
    let title = match (quantity, measure) {
        (ErrorQuantity::Coordinate, CostMeasure::Evaluations) => "Coordinate, counted",
        (ErrorQuantity::Coordinate, _) => "Coordinate, timed",
        (ErrorQuantity::Energy, _) => "Energy",
        (ErrorQuantity::Reaction, _) => "Worst reaction",
    };
    let cost = match measure {
        CostMeasure::Evaluations => "evaluations",
        CostMeasure::Time | CostMeasure::TimeWithBuild => "time / one exact evaluation",
    };
    Chart {
        title: title.to_owned(),
        x: error_axis(found, quantity, label),
        y: Axis::log(cost, ""),
        series,
        marks,
        ..Chart::default()
    }
    .into()
}

/// The axis of the errors, from below the floor to the largest that is one.
fn error_axis(found: &WorkPrecision, quantity: ErrorQuantity, label: &str) -> Axis {
    let all = || found.points.iter().map(|p| found.error_bound(p, quantity));
    let finite = || all().filter(|e| e.is_finite() && *e > 0.0);
    let max = finite().fold(0.0, f64::max).min(MAX_ERROR);
    let min = finite().fold(f64::INFINITY, f64::min);
    match min < max {
        true => Axis::log(label, "").with_range(min / AXIS_MARGIN, max * AXIS_MARGIN),
        false => Axis::log(label, ""),
    }
}

/// The names of some points of a front, well apart.
fn named_points(
    found: &WorkPrecision,
    front: &[usize],
    label_gap: f64,
    at: &dyn Fn(usize) -> [f64; 2],
) -> Vec<Mark> {
    let mut last = f64::INFINITY;
    let mut marks = Vec::new();
    for &k in front {
        let position = at(k);
        if last - position[0].log10() < label_gap {
            continue;
        }
        last = position[0].log10();
        marks.push(Mark::Text {
            at: position,
            label: found.points[k].combination.name(),
        });
    }
    marks
}
