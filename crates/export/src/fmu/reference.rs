//! Results that an importer can compare its own with, and the scene, as the layered standard "references" places them in an FMU
//! (fmi-ls-ref 1.0.0-alpha.1 of the Modelica Association).

use super::variables::{Role, Variable};
use crate::evaluator::{Evaluator, State, Status};
use crate::export::Export;
use std::fmt::Write as _;

const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// Rows of the results, s, and the steps between two of them.
const ROW_INTERVAL: f64 = 0.01;
const ROWS: usize = 100;
const STEPS: usize = 160;

/// The manifest, the results, and the scene: paths and texts.
pub(super) fn reference_files(
    export: &Export,
    variables: &[Variable],
    scene: &str,
) -> Vec<(String, String)> {
    let related = [
        ("scene.toml", "application/toml", "model", "Scene of dwell"),
        (
            "results.csv",
            "text/csv",
            "result",
            "Motion from the start values, with steps far below those of co-simulation",
        ),
    ];
    let mut manifest = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiReferences xmlns:fmi-ls=\"http://fmi-standard.org/fmi-ls-manifest\" fmi-ls:fmi-ls-name=\"org.fmi-standard.fmi-ls-ref\" fmi-ls:fmi-ls-version=\"1.0.0-alpha.1\" fmi-ls:fmi-ls-description=\"Layered Standard providing information on related files included in an FMU.\">\n".to_owned();
    for (source, kind, role, description) in related {
        _ = writeln!(
            manifest,
            "  <Related source=\"{source}\" type=\"{kind}\" role=\"{role}\" description=\"{description}\"/>"
        );
    }
    manifest += "</fmiReferences>\n";
    let files = [
        ("fmi-ls-manifest.xml", manifest),
        ("results.csv", results(export, variables)),
        ("scene.toml", scene.to_owned()),
    ];
    files
        .map(|(name, text)| (format!("{FOLDER}/{name}"), text))
        .into()
}

/// Time, states and outputs in rows, until a second is over or the motion leaves the domain.
fn results(export: &Export, variables: &[Variable]) -> String {
    let names = variables.iter().filter(|variable| match variable.role {
        Role::Time | Role::State(_) | Role::Output => true,
        Role::Rate(_) | Role::Parameter | Role::Input | Role::Indicator | Role::Periods => false,
    });
    let names: Vec<String> = names.map(|v| format!("\"{}\"", v.name)).collect();
    let mut text = names.join(",") + "\n";
    let evaluator = export.evaluator::<f64>();
    let mut state = evaluator.state(export.machine.initial);
    let period = export.machine.domain.length();
    for k in 0..=ROWS {
        let Ok(values) = row(&evaluator, &state) else {
            break;
        };
        let time = ROW_INTERVAL * k as f64;
        _ = write!(text, "{time:e}");
        for (i, value) in values.iter().enumerate() {
            // A state keeps its coordinate in one period.
            let whole = if i == 0 {
                f64::from(state.periods) * period
            } else {
                0.0
            };
            _ = write!(text, ",{:e}", value + whole);
        }
        text.push('\n');
        let step = ROW_INTERVAL / STEPS as f64;
        if (0..STEPS).any(|_| evaluator.step(step, &mut state).is_err()) {
            break;
        }
    }
    text
}

/// States and outputs, in the order of the variables.
fn row(evaluator: &Evaluator<f64>, state: &State<f64>) -> Result<Vec<f64>, Status> {
    let y = &state.y;
    let rates = evaluator.rates(y)?;
    let mut values = y.clone();
    values.extend(evaluator.energies(y)?);
    values.extend(evaluator.reactions(y, rates[1])?);
    values.extend(evaluator.positions(y[0])?);
    Ok(values)
}
