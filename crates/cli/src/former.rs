//! Options and commands by their names before the first release: an error suggests how they are called now.

use clap::error::{ContextKind, ContextValue};

/// The former name, the current one.
const NAMES: [(&str, &str); 9] = [
    ("--at", "--about"),
    ("--every", "--sample-interval"),
    ("--long", "--slow"),
    ("--set", "--parameter"),
    ("--table", "--table-accuracy"),
    ("--to", "--format"),
    ("--to", "--table-to"),
    ("--want", "--result"),
    ("tradeoff", "work-precision"),
];

/// An error of the arguments, with a current name where it is about a former one that the command knows under that.
pub(crate) fn with_current_name(mut error: clap::Error) -> clap::Error {
    let arguments: Vec<String> = std::env::args().collect();
    for (wrong, suggestion) in [
        (ContextKind::InvalidArg, ContextKind::SuggestedArg),
        (
            ContextKind::InvalidSubcommand,
            ContextKind::SuggestedSubcommand,
        ),
    ] {
        let Some(ContextValue::String(given)) = error.get(wrong) else {
            continue;
        };
        let given = given.split(['=', ' ']).next().unwrap_or_default();
        let named = NAMES.iter().filter(|(former, _)| *former == given);
        let is_known =
            |current: &str| current != "--table-to" || arguments.iter().any(|a| a == "reduce");
        let current = named
            .map(|(_, current)| *current)
            .rfind(|current| is_known(current));
        if let Some(current) = current {
            let value = match suggestion {
                ContextKind::SuggestedSubcommand => ContextValue::Strings(vec![current.to_owned()]),
                _ => ContextValue::String(current.to_owned()),
            };
            error.insert(suggestion, value);
        }
    }
    error
}
