//! The scene of two exported runs: one body on a pivot, whose moment of inertia varies with its angle as the runs say. Every
//! command takes it as it takes any other.

use super::combine::ExportedRuns;
use super::sampled_model::SampleInterpolation;
use super::text_table::ExportedTable;
use std::fmt::Write as _;

/// Numbers in a line of a list.
const NUMBERS_IN_A_LINE: usize = 6;

/// The text of the scene; none of a length, and none of straight lines, between which m and its slope contradict each other.
pub(super) fn scene_text(
    name: &str,
    runs: &ExportedRuns,
    interpolation: SampleInterpolation,
    [one, two]: [&ExportedTable; 2],
) -> Option<String> {
    if !runs.is_angle || interpolation == SampleInterpolation::Linear {
        return None;
    }
    let mut text = mechanism_text(name, runs, [&one.file, &two.file]);
    _ = writeln!(text, "interpolation = \"{}\"", interpolation.name());
    let at = || runs.coefficients.iter();
    add_list(&mut text, "angle", runs.q.iter().copied());
    add_list(&mut text, "inertia", at().map(|c| c.m));
    add_list(&mut text, "half-slope", at().map(|c| c.half_dm));
    for (r, (reaction, unit)) in runs.reactions.iter().enumerate() {
        let table = "bodies.driven.varying-inertia.reactions";
        let unit = unit.as_deref().unwrap_or("N");
        _ = write!(
            text,
            "\n[{table}.{}]\nunit = {}\n",
            quoted(reaction),
            quoted(unit)
        );
        add_list(&mut text, "a", at().map(|c| c.a[r]));
        add_list(&mut text, "b", at().map(|c| c.b[r]));
    }
    Some(text)
}

/// The driven body on its pivot, with the motion of the paper where all angles are known: unit speed, one period.
fn mechanism_text(name: &str, runs: &ExportedRuns, files: [&str; 2]) -> String {
    let [one, two] = files.map(|file| file.chars().filter(|c| !c.is_control()).collect::<String>());
    let (coordinate, pivot) = (entry_name(&runs.coordinate), pivot_name(runs));
    let (start, motion) = if runs.is_whole_revolution {
        (
            runs.q[0],
            format!("[motion]\ninitial-velocity = {{ {coordinate} = 1.0 }}\nperiods = 1\n\n"),
        )
    } else {
        (runs.q[runs.q.len() / 2], String::new())
    };
    format!(
        "# The reduced parameters of {one} and {two},\n\
         # as `dwell reduce --from` combined them: the body `driven` stands for the whole mechanism. Add what acts on it, in\n\
         # [loads] and [drives], and the [motion] that you want. What loads elsewhere in the mechanism do is not in the runs.\n\
         title = {}\n\n\
         [bodies]\nground = {{ points = {{ O = [0, 0] }} }}\n\n\
         [joints]\n{pivot} = {{ revolute = [\"ground.O\", \"driven.O\"] }}\n\n\
         [actuators]\n{coordinate} = {{ angle = [\"ground\", \"driven\"] }}\n\n\
         [assembly]\n{coordinate} = {start:?}\n\n\
         {motion}\
         [bodies.driven]\npoints = {{ O = [0, 0], P = [1, 0] }}\n\n\
         [bodies.driven.varying-inertia]\n",
        quoted(&format!("Reduced parameters of {name}")),
    )
}

/// A list of numbers with all their digits.
fn add_list(text: &mut String, key: &str, values: impl Iterator<Item = f64>) {
    _ = writeln!(text, "{key} = [");
    let numbers: Vec<String> = values.map(|value| format!("{value:?}")).collect();
    for line in numbers.chunks(NUMBERS_IN_A_LINE) {
        _ = writeln!(text, "  {},", line.join(", "));
    }
    text.push_str("]\n");
}

/// The name of the driven joint: none that begins the name of a reaction.
fn pivot_name(runs: &ExportedRuns) -> &'static str {
    let is_free = |name: &&str| {
        let mut reactions = runs.reactions.iter();
        reactions.all(|(reaction, _)| reaction.split('.').next() != Some(name))
    };
    ["pivot", "driven-pivot", "crankshaft"]
        .into_iter()
        .find(is_free)
        .unwrap_or("driven-crankshaft")
}

/// A column's name as the name of an entry of a scene, quoted if necessary; `phi` if it cannot be one.
fn entry_name(column: &str) -> String {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
    match (
        column.is_ascii(),
        !column.is_empty() && column.chars().all(allowed),
    ) {
        (true, true) => column.to_owned(),
        (false, true) => quoted(column),
        (_, false) => "phi".to_owned(),
    }
}

/// A TOML string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars().filter(|c| !c.is_control()) {
        if matches!(c, '"' | '\\') {
            quoted.push('\\');
        }
        quoted.push(c);
    }
    quoted + "\""
}
