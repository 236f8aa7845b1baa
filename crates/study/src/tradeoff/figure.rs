//! The picture: cost over true error, with the front.

use super::combination::{Combination, Evaluation, Integrator, Price, Quantity, Tradeoff, part};
use crate::figures::foot;
use crate::words::{count, digits};
use dwell_dynamics::Method;
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};
use dwell_scene::Scene;

/// Room beside the outermost errors, as a factor.
const ROOM: f64 = 4.0;
/// An error larger than this is none: the motion is another one.
const MOST: f64 = 10.0;
/// How far apart in powers of ten the points of a front are whose names are written, and of one among many marks.
const APART: f64 = 1.6;
const CROWDED: f64 = 3.0;

/// The picture of a study.
pub(super) fn figure(scene: &Scene, found: &Tradeoff, name: &str) -> Figure {
    let coordinate = format!("largest error of the free coordinates, {}", found.unit);
    let energy = "largest energy drift / largest kinetic energy";
    let reaction = "largest error of a reaction / largest of its unit";
    let tables = |p: &super::Measured| matches!(p.combination.evaluation, Evaluation::Table { .. });
    let hollow = match found.points.iter().any(tables) {
        true => "; hollow: tables, once they are made; dashed: making the finest",
        false => "",
    };
    let floor = found.truth.floor;
    Figure {
        name: name.to_owned(),
        title: "What accuracy costs".to_owned(),
        caption: foot(
            scene,
            &format!(
                "Each mark is one combination over t = 0 to {} s. Full marks: the mechanism itself, one tolerance after \
                 the other; where time is measured, crosses: single precision{hollow}. Grey line: the Pareto front, \
                 with names. Truth: {}; shaded: below what is known ({}, {} and {} of the three errors). An evaluation \
                 is one of the equation of motion; a Jacobian counts as its dual numbers. Time is in units of one \
                 exact evaluation in the same process, the least of {}.",
                digits(found.duration, 5),
                found.truth.by,
                digits(floor.coordinate, 1),
                digits(floor.energy, 1),
                part(floor.reaction, 1),
                count(found.repetitions, "run"),
            ),
        ),
        columns: 2,
        panels: vec![
            panel(found, Quantity::Coordinate, Price::Evaluations, &coordinate),
            panel(found, Quantity::Coordinate, Price::Time, &coordinate),
            panel(found, Quantity::Energy, Price::Evaluations, energy),
            panel(found, Quantity::Reaction, Price::Evaluations, reaction),
        ],
        provenance: "all combinations of evaluation, integrator and tolerance".to_owned(),
    }
}

fn panel(found: &Tradeoff, quantity: Quantity, price: Price, label: &str) -> Panel {
    let at = |k: usize| -> [f64; 2] {
        let point = &found.points[k];
        [found.known(point, quantity), point.cost.of(price)]
    };
    let front = found.front(quantity, price);
    let line = front.iter().map(|&k| at(k)).collect();
    let mut series = vec![Series::line("", line).color(Paint::Grey)];
    for (i, method) in Method::ALL.into_iter().enumerate() {
        let of = |wanted: &dyn Fn(Evaluation) -> bool| -> Vec<[f64; 2]> {
            let mine = |k: &usize| {
                let Combination {
                    evaluation,
                    integrator,
                } = found.points[*k].combination;
                matches!(integrator, Integrator::Steps(own, _) if own == method)
                    && wanted(evaluation)
            };
            (0..found.points.len()).filter(mine).map(at).collect()
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
            (Stroke::Crosses, &|e| e == Evaluation::Short),
        ];
        // Counted, they are what the mechanism itself is.
        for (stroke, wanted) in kinds.into_iter().filter(|_| price != Price::Evaluations) {
            series.push(Series::line("", of(wanted)).stroke(stroke).color(paint));
        }
    }
    let floor = found.truth.floor.of(quantity);
    let mut marks = vec![Mark::Band {
        from: floor / ROOM.powi(3),
        to: floor,
        label: String::new(),
    }];
    if let Some(point) = found.quadrature() {
        marks.push(Mark::Point {
            at: [found.known(point, quantity), point.cost.of(price)],
            label: "quadrature".to_owned(),
        });
    }
    let making = found.points.iter().map(|p| p.cost.making);
    let making = making.fold(0.0, f64::max);
    if price == Price::Time && making > 0.0 {
        marks.push(Mark::Horizontal {
            at: making,
            label: "making the finest table".to_owned(),
        });
    }
    let apart = match price {
        Price::Evaluations => APART,
        Price::Time | Price::TimeWithMaking => CROWDED,
    };
    marks.extend(named(found, &front, apart, &at));
    let title = match (quantity, price) {
        (Quantity::Coordinate, Price::Evaluations) => "Coordinate, counted",
        (Quantity::Coordinate, _) => "Coordinate, timed",
        (Quantity::Energy, _) => "Energy",
        (Quantity::Reaction, _) => "Worst reaction",
    };
    let cost = match price {
        Price::Evaluations => "evaluations",
        Price::Time | Price::TimeWithMaking => "time / one exact evaluation",
    };
    Chart {
        title: title.to_owned(),
        x: errors(found, quantity, label),
        y: Axis::log(cost, ""),
        series,
        marks,
        ..Chart::default()
    }
    .into()
}

/// The axis of the errors, from below the floor to the largest that is one.
fn errors(found: &Tradeoff, quantity: Quantity, label: &str) -> Axis {
    let all = || found.points.iter().map(|p| found.known(p, quantity));
    let finite = || all().filter(|e| e.is_finite() && *e > 0.0);
    let most = finite().fold(0.0, f64::max).min(MOST);
    let least = finite().fold(f64::INFINITY, f64::min);
    match least < most {
        true => Axis::log(label, "").within(least / ROOM, most * ROOM),
        false => Axis::log(label, ""),
    }
}

/// The names of some points of a front, well apart.
fn named(
    found: &Tradeoff,
    front: &[usize],
    apart: f64,
    at: &dyn Fn(usize) -> [f64; 2],
) -> Vec<Mark> {
    let mut last = f64::INFINITY;
    let mut marks = Vec::new();
    for &k in front {
        let place = at(k);
        if last - place[0].log10() < apart {
            continue;
        }
        last = place[0].log10();
        marks.push(Mark::Words {
            at: place,
            label: found.points[k].combination.name(),
        });
    }
    marks
}
