//! Former names of options and commands: an error suggests the current name.

use clap::error::{ContextKind, ContextValue};

/// The command, its former option, and the current option.
const OPTIONS: [(&str, &str, &str); 9] = [
    ("calibrate", "--set", "--parameter"),
    ("linearise", "--at", "--about"),
    ("reduce", "--table", "--table-accuracy"),
    ("reduce", "--to", "--table-to"),
    ("simulate", "--every", "--sample-interval"),
    // Rows are Parquet files; a table is written on request.
    ("sweep", "--store", "--export"),
    ("sweep", "--want", "--result"),
    ("symbolic", "--to", "--format"),
    ("validate", "--long", "--slow"),
];
/// The former name of a command, and the current one.
const COMMAND: (&str, &str) = ("tradeoff", "work-precision");

/// An error of the arguments, with the current name if it concerns a former name of this command.
pub(crate) fn with_current_name(mut error: clap::Error) -> clap::Error {
    let given = |error: &clap::Error, kind| match error.get(kind) {
        Some(ContextValue::String(given)) => given.split(['=', ' ']).next().map(str::to_owned),
        _ => None,
    };
    let called: Vec<String> = std::env::args().collect();
    let option = given(&error, ContextKind::InvalidArg).and_then(|given| {
        let is_meant = |of: &str, former: &str| former == given && called.iter().any(|a| a == of);
        OPTIONS.iter().find(|(of, former, _)| is_meant(of, former))
    });
    if let Some((.., current)) = option {
        let value = ContextValue::String((*current).to_owned());
        error.insert(ContextKind::SuggestedArg, value);
    }
    if given(&error, ContextKind::InvalidSubcommand).is_some_and(|given| given == COMMAND.0) {
        let value = ContextValue::Strings(vec![COMMAND.1.to_owned()]);
        error.insert(ContextKind::SuggestedSubcommand, value);
    }
    error
}
