//! Writes a linearised motion: matrices, document and summary.

use crate::equilibria::output::{describe_eigenvalues, describe_equilibrium};
use crate::explain::StudyError;
use crate::linearise::compute::{
    LinearisedMotion, OperatingPoint, StateSpaceNames, compute_linearisation,
};
use crate::machines::MachineScene;
use crate::number_format::number;
use crate::output::{Outcome, indeterminate_note, provenance_line};
use dwell_findings::Record;
use dwell_report::{Array, Block, Column, Document, npz};

/// The motion of a scene linearised about a state.
///
/// # Errors
/// [`StudyError`] when no equilibrium is found, or the initial state cannot be evaluated.
pub fn linearise<S: MachineScene>(scene: &S, point: OperatingPoint) -> Result<Outcome, StudyError> {
    let motion = compute_linearisation(scene, point)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-linear.{rest}", scene.name);
    outcome.files.add(name("npz"), npz(&arrays(&motion))?);
    outcome.files.add(name("csv"), csv(&motion));
    outcome.files.add(name("md"), document(&motion));
    (outcome.summary, outcome.record) = summary(&motion);
    Ok(outcome)
}

/// A matrix: its name, the quantities of its rows and columns, and its rows.
type NamedMatrix<'a> = (&'static str, &'a [Column], &'a [Column], &'a [Vec<f64>]);

/// The four matrices with the names of their rows and columns.
fn matrices<'a>(motion: &'a LinearisedMotion<'_, impl MachineScene>) -> [NamedMatrix<'a>; 4] {
    let (names, linear) = (&motion.names, &motion.linear);
    [
        ("A", &names.states, &names.states, &linear.a),
        ("B", &names.states, &names.inputs, &linear.b),
        ("C", &names.outputs, &names.states, &linear.c),
        ("D", &names.outputs, &names.inputs, &linear.d),
    ]
}

/// States, inputs and outputs.
fn signals(names: &StateSpaceNames) -> [(&'static str, &[Column]); 3] {
    [
        ("state", &names.states),
        ("input", &names.inputs),
        ("output", &names.outputs),
    ]
}

fn column_list(columns: &[Column]) -> String {
    let one = |c: &Column| format!("{} ({})", c.name, c.unit);
    match columns {
        [] => "none".to_owned(),
        some => some.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

/// The label of a matrix row: in A and B the time derivative of a state.
fn row_name(matrix: &str, column: &Column) -> String {
    if matrix == "A" || matrix == "B" {
        format!("d({})/dt [{}/s]", column.name, column.unit)
    } else {
        format!("{} [{}]", column.name, column.unit)
    }
}

/// The printed summary, and the numbers in it and the state.
fn summary(motion: &LinearisedMotion<'_, impl MachineScene>) -> (String, Record) {
    let (scene, names) = (motion.prepared.scene, &motion.names);
    let mut record = Record::default();
    let mut summary = format!("{}: linearised about ", scene.title);
    match &motion.equilibrium {
        Some(found) => {
            summary += "its equilibrium\n";
            summary += &describe_equilibrium(&motion.prepared, found, "equilibrium", &mut record);
        }
        None => {
            summary += "the initial state\n";
            summary += if motion.is_equilibrium {
                "  an equilibrium: the state derivative is zero there within rounding\n"
            } else {
                "  not an equilibrium: the state derivative is not zero there\n"
            };
            let (values, errors) = (&motion.eigenvalues, &motion.eigenvalue_errors);
            let (lines, error) = describe_eigenvalues(values, errors, "initial", &mut record);
            summary += &format!("{lines}    estimated error: {error}");
        }
    }
    for (column, value) in names.states.iter().zip(&motion.state) {
        record.add(format!("state.{}", column.name), &column.unit, *value);
    }
    for (what, columns) in signals(names) {
        summary += &format!("  {what}s: {}\n", column_list(columns));
    }
    let omitted = motion.omitted.iter();
    summary += &motion.prepared.branch_note();
    summary += &indeterminate_note(omitted.map(|&r| scene.name_of_reaction(r)));
    (summary, record)
}

fn arrays(motion: &LinearisedMotion<'_, impl MachineScene>) -> Vec<(&'static str, Array)> {
    let (names, linear) = (&motion.names, &motion.linear);
    let matrix = |columns: usize, rows: Vec<Vec<f64>>| Array::Matrix { columns, rows };
    let matrices =
        matrices(motion).map(|(name, _, of, rows)| (name, matrix(of.len(), rows.to_vec())));
    let row = |values: &[f64]| matrix(values.len(), vec![values.to_vec()]);
    let mut arrays = Vec::from(matrices);
    arrays.push(("state", row(&motion.state[..names.states.len()])));
    arrays.push(("rates", row(&linear.state_derivative)));
    arrays.push(("output", row(&linear.outputs)));
    let text_array = |of: fn(&Column) -> &String, columns: &[Column]| {
        Array::Strings(columns.iter().map(|c| of(c).clone()).collect())
    };
    for (name, units, columns) in [
        ("states", "state_units", &names.states),
        ("inputs", "input_units", &names.inputs),
        ("outputs", "output_units", &names.outputs),
    ] {
        arrays.push((name, text_array(|c| &c.name, columns)));
        arrays.push((units, text_array(|c| &c.unit, columns)));
    }
    arrays
}

/// CSV with one line per row of each matrix.
fn csv(motion: &LinearisedMotion<'_, impl MachineScene>) -> String {
    let mut text = String::new();
    for (name, rows, columns, matrix) in matrices(motion) {
        // Names of a scene hold neither commas nor quotes.
        text += "matrix,row";
        text.extend(columns.iter().map(|c| format!(",{} [{}]", c.name, c.unit)));
        text.push('\n');
        for (row, values) in rows.iter().zip(matrix) {
            text += &format!("{name},{}", row_name(name, row));
            text.extend(values.iter().map(|value| format!(",{value:?}")));
            text.push('\n');
        }
    }
    text
}

fn document(motion: &LinearisedMotion<'_, impl MachineScene>) -> String {
    let (scene, linear) = (motion.prepared.scene, &motion.linear);
    let mut blocks = vec![Block::Text(
        "δẋ = A δx + B δu and δz = C δx + D δu, of the states x, the inputs u and the outputs z, \
         about the state below."
            .to_owned(),
    )];
    let states = motion.names.states.iter().zip(&motion.state);
    let states = states.zip(&linear.state_derivative);
    blocks.push(Block::Table {
        header: ["state", "unit", "x", "ẋ"].map(str::to_owned).into(),
        rows: states
            .map(|((c, x), rate)| vec![c.name.clone(), c.unit.clone(), number(*x), number(*rate)])
            .collect(),
    });
    for (name, rows, columns, matrix) in matrices(motion) {
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
    blocks.push(Block::Text(provenance_line(scene)));
    let title = format!("{}: linearised motion", scene.title);
    Document { title, blocks }.markdown()
}
