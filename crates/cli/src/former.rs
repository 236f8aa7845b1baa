//! Options and commands by their former names: still accepted, with a note on standard error.

use std::ffi::OsString;

/// Of which command, the former option, the current one.
const OPTIONS: [(&str, &str, &str); 8] = [
    ("reduce", "--table", "--table-accuracy"),
    ("reduce", "--to", "--table-to"),
    ("simulate", "--every", "--sample-interval"),
    ("linearise", "--at", "--about"),
    ("symbolic", "--to", "--format"),
    ("calibrate", "--set", "--parameter"),
    ("sweep", "--want", "--result"),
    ("validate", "--long", "--slow"),
];
/// The former command, the current one.
const COMMANDS: [(&str, &str); 1] = [("tradeoff", "work-precision")];

/// The arguments with current names in place of former ones, and a note for each replaced name. clap then knows
/// current names only, so that its messages and its help show no others.
pub(crate) fn with_current_names(
    arguments: impl Iterator<Item = OsString>,
) -> (Vec<OsString>, Vec<String>) {
    let mut arguments: Vec<OsString> = arguments.collect();
    let mut notes = Vec::new();
    let Some(at) = command_index(&arguments) else {
        return (arguments, notes);
    };
    let mut replace = |argument: &mut OsString, former: &str, current: &str, rest: &str| {
        *argument = format!("{current}{rest}").into();
        notes.push(format!("note: {former} is now {current}"));
    };
    if let Some((former, current)) = COMMANDS.iter().find(|(former, _)| arguments[at] == *former) {
        replace(&mut arguments[at], former, current, "");
    }
    let command = arguments[at].clone();
    let options: Vec<_> = OPTIONS.iter().filter(|(of, ..)| command == *of).collect();
    // `--from` of `reduce` was the lower end of a table, a number; now two files follow it.
    let is_end = |k: usize| {
        let next = arguments.get(k + 1).and_then(|next| next.to_str());
        let given = arguments[k]
            .to_str()
            .and_then(|given| given.strip_prefix("--from"));
        let value =
            given.and_then(|rest| rest.strip_prefix('=').or(next.filter(|_| rest.is_empty())));
        command == *"reduce" && value.is_some_and(|value| value.parse::<f64>().is_ok())
    };
    let ends: Vec<usize> = (at + 1..arguments.len()).filter(|&k| is_end(k)).collect();
    for k in ends {
        let rest = arguments[k].to_string_lossy().replacen("--from", "", 1);
        replace(&mut arguments[k], "--from", "--table-from", &rest);
    }
    for argument in arguments.iter_mut().skip(at + 1).take_while(|a| *a != "--") {
        let given = argument.to_string_lossy().into_owned();
        for (_, former, current) in &options {
            if let Some(rest) = given.strip_prefix(former)
                && (rest.is_empty() || rest.starts_with('='))
            {
                replace(argument, former, current, rest);
            }
        }
    }
    (arguments, notes)
}

/// Where the command stands: the first argument that is no option. Before it, only `--out` takes a value.
fn command_index(arguments: &[OsString]) -> Option<usize> {
    let mut k = 1;
    while let Some(argument) = arguments.get(k) {
        match argument.to_str() {
            Some("--out") => k += 2,
            Some(option) if option.starts_with('-') => k += 1,
            _ => return Some(k),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn replaced(line: &str) -> (String, usize) {
        let (arguments, notes) = with_current_names(line.split(' ').map(OsString::from));
        let arguments: Vec<_> = arguments.iter().map(|a| a.to_string_lossy()).collect();
        (arguments.join(" "), notes.len())
    }

    #[test]
    fn former_names_are_replaced_where_they_belong() {
        for (given, expected, notes) in [
            (
                "dwell sweep a --want m,period",
                "dwell sweep a --result m,period",
                1,
            ),
            (
                "dwell --out o reduce a --table=1e-9 --to 3",
                "dwell --out o reduce a --table-accuracy=1e-9 --table-to 3",
                2,
            ),
            ("dwell symbolic a --to c", "dwell symbolic a --format c", 1),
            (
                "dwell --out tradeoff tradeoff a",
                "dwell --out tradeoff work-precision a",
                1,
            ),
            ("dwell validate -- --long", "dwell validate -- --long", 0),
            ("dwell simulate a --to 3", "dwell simulate a --to 3", 0),
        ] {
            assert_eq!(replaced(given), (expected.to_owned(), notes));
        }
    }
}
