//! The words and tables of a study.

use super::combination::{Evaluation, Integrator, Measured, Price, Quantity, Tradeoff, part, told};
use crate::error::StudyError;
use crate::provenance::origin;
use crate::words::{count, digits};
use dwell_dynamics::Method;
use dwell_report::{Block, Column, Document, Table};
use dwell_scene::Scene;
use std::fmt::Write as _;

/// Accuracies for which the cheapest combination is told.
const ACCURACIES: [f64; 4] = [1e-3, 1e-6, 1e-9, 1e-12];

/// All numbers. The integrators are numbered as `Method::ALL`, quadrature is −1; evaluations are 0 exact, 1 single
/// precision, 2 table, 3 other.
pub(super) fn table(found: &Tradeoff) -> Table {
    let mut table = numbers(found);
    let coded = ["evaluation", "integrator"].map(|name| Column::new(name, ""));
    table.columns.splice(0..0, coded);
    for (row, point) in table.rows.iter_mut().zip(&found.points) {
        let evaluation = match point.combination.evaluation {
            Evaluation::Exact => 0.0,
            Evaluation::Short => 1.0,
            Evaluation::Table { .. } => 2.0,
            Evaluation::Other(_) => 3.0,
        };
        let integrator = match point.combination.integrator {
            Integrator::Steps(own, _) => {
                let place = Method::ALL.iter().position(|&method| method == own);
                place.map_or(f64::NAN, |place| place as f64)
            }
            Integrator::Quadrature => -1.0,
        };
        row.splice(0..0, [evaluation, integrator]);
    }
    table
}

/// All numbers, with names before them.
pub(super) fn csv(found: &Tradeoff) -> Result<String, StudyError> {
    let text = numbers(found).csv()?;
    let mut lines = text.lines();
    let mut csv = format!(
        "evaluation,integrator,{}\n",
        lines.next().unwrap_or_default()
    );
    for (line, point) in lines.zip(&found.points) {
        let combination = point.combination;
        let [evaluation, integrator] = [
            combination.evaluation.name(),
            combination.integrator.name().to_owned(),
        ];
        // Writing to a string cannot fail.
        let _ = writeln!(csv, "{evaluation},{integrator},{line}");
    }
    Ok(csv)
}

fn numbers(found: &Tradeoff) -> Table {
    let unit = found.unit.replace(' ', "_");
    let columns = [
        ("tolerance", ""),
        ("table_accuracy", ""),
        ("table_cells", ""),
        ("table_bytes", ""),
        ("steps", ""),
        ("rejected", ""),
        ("evaluations", ""),
        ("jacobians", ""),
        ("weighed_evaluations", ""),
        ("time", "evaluations"),
        ("time_with_making", "evaluations"),
        ("coordinate_error", unit.as_str()),
        ("energy_error", ""),
        ("reaction_error", ""),
        ("coordinate_below_known", ""),
        ("energy_below_known", ""),
        ("reaction_below_known", ""),
    ];
    let row = |point: &Measured| {
        let [accuracy, cells, bytes] = match point.combination.evaluation {
            Evaluation::Table {
                accuracy,
                cells,
                bytes,
            } => [accuracy, cells as f64, bytes as f64],
            _ => [f64::NAN; 3],
        };
        let cost = point.cost;
        let mut row = vec![
            point.combination.integrator.tolerance().unwrap_or(f64::NAN),
            accuracy,
            cells,
            bytes,
        ];
        let counts = [
            cost.steps,
            cost.rejected,
            cost.evaluations,
            cost.jacobians,
            cost.weighed,
        ];
        row.extend(counts.map(|count| count as f64));
        row.extend([cost.time, cost.of(Price::TimeWithMaking)]);
        row.extend(Quantity::ALL.map(|quantity| point.errors.of(quantity)));
        row.extend(Quantity::ALL.map(|quantity| f64::from(u8::from(found.below(point, quantity)))));
        row
    };
    Table {
        columns: columns.map(|(n, u)| Column::new(n, u)).to_vec(),
        rows: found.points.iter().map(row).collect(),
    }
}

fn name(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Coordinate => "coordinate",
        Quantity::Energy => "energy",
        Quantity::Reaction => "worst reaction",
    }
}

/// A point in the cells of a front's table.
fn cells(found: &Tradeoff, point: &Measured) -> Vec<String> {
    let mut cells = vec![
        point.combination.name(),
        point.cost.steps.to_string(),
        point.cost.weighed.to_string(),
        digits(point.cost.time, 3),
        digits(point.cost.of(Price::TimeWithMaking), 3),
    ];
    cells.extend(Quantity::ALL.map(|q| told(point.errors.of(q), found.truth.floor.of(q))));
    cells
}

fn front(found: &Tradeoff, quantity: Quantity, price: Price) -> Block {
    let coordinate = format!("error of the coordinate, {}", found.unit);
    let header = [
        "combination",
        "steps",
        "evaluations",
        "time",
        "time with making",
        coordinate.as_str(),
        "energy drift",
        "worst reaction",
    ];
    let front = found.front(quantity, price);
    Block::Table {
        header: header.map(str::to_owned).to_vec(),
        rows: front
            .iter()
            .map(|&k| cells(found, &found.points[k]))
            .collect(),
    }
}

/// The cheapest combination in words: what it is, and what it costs.
fn cheapest(found: &Tradeoff, quantity: Quantity, price: Price, accuracy: f64) -> String {
    let Some(k) = found.cheapest(quantity, price, accuracy) else {
        let none = match found.truth.floor.of(quantity) > accuracy {
            true => "not known",
            false => "none",
        };
        return none.to_owned();
    };
    let point = &found.points[k];
    format!(
        "{} ({})",
        point.combination.name(),
        digits(point.cost.of(price), 3)
    )
}

/// The page of a study.
pub(super) fn document(scene: &Scene, found: &Tradeoff, file: &str) -> Document {
    let mut blocks = vec![
        Block::Text(intro(scene, found)),
        Block::Figure {
            file: format!("{file}.png"),
            alt: "Cost over true error of every combination".to_owned(),
            caption: String::new(),
        },
        Block::Heading("The cheapest for an accuracy".to_owned()),
        Block::Table {
            header: [
                "error of",
                "at most",
                "by evaluations",
                "by time, all made",
                "by time with making",
            ]
            .map(str::to_owned)
            .to_vec(),
            rows: Quantity::ALL
                .into_iter()
                .flat_map(|quantity| ACCURACIES.map(|accuracy| row(found, quantity, accuracy)))
                .collect(),
        },
        Block::Text(quadrature(found)),
    ];
    for (heading, quantity, price) in [
        (
            "Front: coordinate over evaluations",
            Quantity::Coordinate,
            Price::Evaluations,
        ),
        (
            "Front: coordinate over time with making",
            Quantity::Coordinate,
            Price::TimeWithMaking,
        ),
        (
            "Front: coordinate over time, all made",
            Quantity::Coordinate,
            Price::Time,
        ),
        (
            "Front: energy over evaluations",
            Quantity::Energy,
            Price::Evaluations,
        ),
        (
            "Front: worst reaction over evaluations",
            Quantity::Reaction,
            Price::Evaluations,
        ),
    ] {
        blocks.push(Block::Heading(heading.to_owned()));
        blocks.push(front(found, quantity, price));
    }
    if !found.left_out.is_empty() {
        blocks.push(Block::Heading("Left out".to_owned()));
        let lines: Vec<String> = found
            .left_out
            .iter()
            .map(|why| format!("- {why}"))
            .collect();
        blocks.push(Block::Text(lines.join("\n")));
    }
    Document {
        title: format!("What accuracy costs: {}", scene.title),
        blocks,
    }
}

fn row(found: &Tradeoff, quantity: Quantity, accuracy: f64) -> Vec<String> {
    let prices = [Price::Evaluations, Price::Time, Price::TimeWithMaking];
    let mut row = vec![name(quantity).to_owned(), format!("{accuracy:.0e}")];
    row.extend(prices.map(|price| cheapest(found, quantity, price, accuracy)));
    row
}

fn intro(scene: &Scene, found: &Tradeoff) -> String {
    let floor = found.truth.floor;
    let mut text = format!(
        "{}.\n\nFollowed from t = 0 to {} s; errors are the largest at 50 times spread over it, by dense output.\n",
        origin(scene),
        digits(found.duration, 7)
    );
    for line in &found.motion {
        let _ = write!(text, "\n- {line}");
    }
    let _ = write!(
        text,
        "\n\nTruth: {}. Known to {} {} in the coordinate, {} of the largest kinetic energy and {} of the largest \
         reaction: a smaller error is told as below that.\n\nAn *evaluation* is one of the equation of motion, and a \
         Jacobian counts as the dual numbers it takes. *Time* is in units of one exact evaluation in double precision, \
         measured between the runs ({} ns here; a Jacobian takes {} of them): the least of {}. *With making* adds the \
         making of the table, once.",
        found.truth.by,
        digits(floor.coordinate, 2),
        found.unit,
        digits(floor.energy, 2),
        part(floor.reaction, 2),
        digits(found.second * 1e9, 2),
        digits(found.jacobian, 2),
        count(found.repetitions, "run"),
    );
    text
}

fn quadrature(found: &Tradeoff) -> String {
    match found.quadrature() {
        Some(point) => format!(
            "The energy alone tells this motion: by quadrature all of it takes {} evaluations and the time of {}, with \
             errors that are {}, {} and {}. Nothing that is stepped in time comes near, so the fronts are those of the \
             integrators.",
            point.cost.weighed,
            digits(point.cost.time, 3),
            told(point.errors.coordinate, found.truth.floor.coordinate),
            told(point.errors.energy, found.truth.floor.energy),
            told(point.errors.reaction, found.truth.floor.reaction),
        ),
        None => "No quadrature tells this motion: it is not conservative, does not repeat itself, or has more than one \
                 freedom."
            .to_owned(),
    }
}

/// What the terminal shows.
pub(super) fn summary(scene: &Scene, found: &Tradeoff) -> String {
    let floor = found.truth.floor;
    let mut text = format!(
        "{}: {} combinations over {} s\n",
        scene.title.trim_end_matches('.'),
        found.points.len(),
        digits(found.duration, 6)
    );
    for line in &found.motion {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(
        text,
        "  truth: {}\n  it is known to {} {}, {} of the energy, {} of the reactions",
        found.truth.by,
        digits(floor.coordinate, 1),
        found.unit,
        digits(floor.energy, 1),
        part(floor.reaction, 1)
    );
    for accuracy in ACCURACIES {
        let prices = [Price::Evaluations, Price::Time, Price::TimeWithMaking];
        let [counted, made, timed] =
            prices.map(|price| cheapest(found, Quantity::Coordinate, price, accuracy));
        let _ = write!(
            text,
            "  {accuracy:.0e} {}: evaluations {counted}; time {timed}",
            found.unit
        );
        let once = if made == timed {
            String::new()
        } else {
            format!("; once tables are made {made}")
        };
        let _ = writeln!(text, "{once}");
    }
    if let Some(point) = found.quadrature() {
        let _ = writeln!(
            text,
            "  quadrature, which the energy of this motion allows: {} evaluations, in time {}",
            point.cost.weighed,
            digits(point.cost.time, 3)
        );
    }
    for why in found.left_out.iter().take(8) {
        let _ = writeln!(text, "  left out: {why}");
    }
    if found.left_out.len() > 8 {
        let _ = writeln!(text, "  and {} more, in the page", found.left_out.len() - 8);
    }
    text
}
