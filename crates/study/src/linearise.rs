//! `dwell linearise`: small motions about an equilibrium or the start, as A, B, C and D.

use crate::driven::Driven;
use crate::equilibria::{eigenvalues, find, told};
use crate::error::StudyError;
use crate::outcome::Outcome;
use crate::prepare::{not_in_a_table, shared};
use crate::provenance::origin;
use crate::words::number;
use dwell_dynamics::{DriveKind, DynamicsError, Equilibrium, Linear, Machine, linearise as about};
use dwell_geometry::Reaction;
use dwell_report::{Array, Block, Column, Document, npz};
use dwell_scene::Scene;
use std::fmt::Write as _;

/// About what a motion is linearised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// The equilibrium next to the start.
    Equilibrium,
    /// The state in which the motion starts.
    Start,
}

/// The motion of a scene linearised about a state.
///
/// # Errors
/// [`StudyError`] when no equilibrium is found, or the start cannot be evaluated.
pub fn linearise(scene: &Scene, at: About) -> Result<Outcome, StudyError> {
    let driven = Driven::new(scene)?;
    let shared = shared(scene, driven.machine.model().plan());
    let asked = scene.requests.reactions.iter().copied();
    let (left_out, reactions): (Vec<Reaction>, Vec<Reaction>) =
        asked.partition(|reaction| shared.contains(reaction));
    let machine = driven.with_reactions(&reactions)?;
    let (state, words) = match at {
        About::Start => (driven.start(), "about the start".to_owned()),
        About::Equilibrium => {
            let next = next_to_start(&driven)?;
            let words = format!("about its equilibrium\n{}", told(&driven, &next));
            (next.y, words.trim_end().to_owned())
        }
    };
    let explain = |e: DynamicsError| driven.explain(&e);
    let linear = about(&machine, 0.0, &state).map_err(explain)?;
    let values = linear.eigenvalues().map_err(explain)?;
    let named = Named::new(&driven, &machine);
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-linear.{rest}", scene.name);
    let mut state_space = npz(&named.arrays(&linear, &state))?;
    outcome
        .files
        .add(name("npz"), std::mem::take(&mut state_space));
    outcome.files.add(name("csv"), named.csv(&linear));
    outcome
        .files
        .add(name("md"), named.document(scene, &linear, &state));
    let mut summary = format!("{}: linearised {words}\n", scene.title);
    if at == About::Start {
        let rates = linear.rates.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        if rates > 0.0 {
            summary += "  not an equilibrium: the states change there by themselves as well\n";
        }
        summary += &eigenvalues(&values);
    }
    let _ = writeln!(
        summary,
        "  states: {}\n  inputs: {}\n  outputs: {}",
        list(&named.states),
        list(&named.inputs),
        list(&named.outputs)
    );
    let left_out = left_out.iter().map(|&r| scene.mechanism.reaction_name(r));
    summary += &not_in_a_table(left_out);
    outcome.summary = summary;
    Ok(outcome)
}

/// The equilibrium next to the start.
fn next_to_start(driven: &Driven<'_>) -> Result<Equilibrium, StudyError> {
    let (found, _) = find(driven)?;
    let start = driven.start()[0];
    let away = |e: &Equilibrium| (e.y[0] - start).abs();
    let next = found.into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    next.ok_or_else(|| {
        driven.explain(&DynamicsError::NoEquilibrium {
            what: "the force at rest is nowhere zero over the range",
        })
    })
}

fn list(columns: &[Column]) -> String {
    let one = |c: &Column| format!("{} ({})", c.name, c.unit);
    match columns {
        [] => "none".to_owned(),
        some => some.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// A matrix: its name, what its rows and columns are, its rows.
type Part<'a> = (&'static str, &'a [Column], &'a [Column], &'a [Vec<f64>]);

/// Names and units of what the matrices relate.
struct Named {
    states: Vec<Column>,
    inputs: Vec<Column>,
    outputs: Vec<Column>,
}

impl Named {
    fn new(driven: &Driven<'_>, machine: &Machine) -> Self {
        let scene = driven.scene;
        let states = driven.states();
        let force = |angle: bool| if angle { "N m" } else { "N" };
        let input = |drive: &dwell_dynamics::Drive| {
            let angle = drive.coordinate.is_angle();
            let (what, unit) = match drive.kind {
                DriveKind::Action(_) => ("action", force(angle)),
                DriveKind::Motor(_) => ("voltage", "V"),
                DriveKind::Regulator(_) => ("speed", if angle { "rad/s" } else { "m/s" }),
            };
            Column::new(format!("{}.{what}", drive.name), unit)
        };
        let mut outputs = states[..2 * machine.free().len()].to_vec();
        let reaction =
            |&r: &Reaction| Column::new(scene.mechanism.reaction_name(r), r.component.unit());
        outputs.extend(machine.model().reactions().iter().map(reaction));
        let action = |drive: &dwell_dynamics::Drive| {
            let unit = force(drive.coordinate.is_angle());
            Column::new(format!("{}.action", drive.name), unit)
        };
        outputs.extend(scene.drives.iter().map(action));
        Self {
            inputs: scene.drives.iter().map(input).collect(),
            states,
            outputs,
        }
    }

    /// The four matrices with the names of their rows and columns.
    fn parts<'a>(&'a self, linear: &'a Linear) -> [Part<'a>; 4] {
        [
            ("A", &self.states, &self.states, &linear.a),
            ("B", &self.states, &self.inputs, &linear.b),
            ("C", &self.outputs, &self.states, &linear.c),
            ("D", &self.outputs, &self.inputs, &linear.d),
        ]
    }

    fn arrays(&self, linear: &Linear, state: &[f64]) -> Vec<(&'static str, Array)> {
        let matrix = |(name, _, columns, rows): (&'static str, _, &[Column], &[Vec<f64>])| {
            let rows = rows.to_vec();
            let columns = columns.len();
            (name, Array::Matrix { columns, rows })
        };
        let mut arrays: Vec<_> = self.parts(linear).map(matrix).into();
        let mut row = |name, values: &[f64]| {
            let array = Array::Matrix {
                columns: values.len(),
                rows: vec![values.to_vec()],
            };
            arrays.push((name, array));
        };
        row("state", &state[..self.states.len()]);
        row("rates", &linear.rates);
        row("output", &linear.outputs);
        let words = |of: fn(&Column) -> &String, columns: &[Column]| {
            Array::Words(columns.iter().map(|c| of(c).clone()).collect())
        };
        for (name, units, columns) in [
            ("states", "state_units", &self.states),
            ("inputs", "input_units", &self.inputs),
            ("outputs", "output_units", &self.outputs),
        ] {
            arrays.push((name, words(|c| &c.name, columns)));
            arrays.push((units, words(|c| &c.unit, columns)));
        }
        arrays
    }

    /// One line for each row of a matrix, with its matrix and its name.
    fn csv(&self, linear: &Linear) -> String {
        let mut text = String::new();
        for (name, rows, columns, matrix) in self.parts(linear) {
            // Names of a scene hold neither commas nor quotes.
            let _ = write!(text, "matrix,row");
            for column in columns {
                let _ = write!(text, ",{} [{}]", column.name, column.unit);
            }
            text.push('\n');
            for (row, values) in rows.iter().zip(matrix) {
                let _ = write!(text, "{name},{}", row_name(name, row));
                for value in values {
                    let _ = write!(text, ",{value:?}");
                }
                text.push('\n');
            }
        }
        text
    }

    fn document(&self, scene: &Scene, linear: &Linear, state: &[f64]) -> String {
        let mut blocks = vec![Block::Text(
            "δẋ = A δx + B δu and δz = C δx + D δu, of the states x, the inputs u and the outputs z, \
             about the state below."
                .to_owned(),
        )];
        let states = self.states.iter().zip(state).zip(&linear.rates);
        blocks.push(Block::Table {
            header: ["state", "unit", "x", "ẋ"].map(str::to_owned).into(),
            rows: states
                .map(|((c, x), rate)| {
                    vec![c.name.clone(), c.unit.clone(), number(*x), number(*rate)]
                })
                .collect(),
        });
        for (name, rows, columns, matrix) in self.parts(linear) {
            blocks.push(Block::Heading(name.to_owned()));
            if columns.is_empty() {
                blocks.push(Block::Text("No inputs.".to_owned()));
                continue;
            }
            let label = |c: &Column| format!("{} [{}]", c.name, c.unit);
            let header = std::iter::once(String::new()).chain(columns.iter().map(label));
            let row = |(c, values): (&Column, &Vec<f64>)| {
                let cells = values.iter().map(|v| number(*v));
                std::iter::once(row_name(name, c)).chain(cells).collect()
            };
            blocks.push(Block::Table {
                header: header.collect(),
                rows: rows.iter().zip(matrix).map(row).collect(),
            });
        }
        blocks.push(Block::Text(origin(scene)));
        let title = format!("{}: linearised motion", scene.title);
        Document { title, blocks }.markdown()
    }
}

/// What a row of a matrix is: in A and B the rate of a state.
fn row_name(matrix: &str, column: &Column) -> String {
    if matrix == "A" || matrix == "B" {
        format!("d({})/dt [{}/s]", column.name, column.unit)
    } else {
        format!("{} [{}]", column.name, column.unit)
    }
}
