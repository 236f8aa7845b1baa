//! The requirements of the manual: `capabilities.toml`, compared with the existing keys, commands and options.

use dwell_scene::scene_keys;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The commands of the program with their options.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Interface {
    /// The options of all commands, such as `--out`.
    pub common_options: Vec<String>,
    /// By command: its name and its long options, such as `--points`.
    pub commands: Vec<(String, Vec<String>)>,
}

/// Requirement and theory of a table.
type TableRequirement = (String, String);

/// Requirement and theory of a command or an option, prefixes of the keys of the findings that judge it, and words in the
/// descriptions of its faults.
pub(super) type CommandRequirement = (String, String, Vec<String>, Vec<String>);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Capabilities {
    pub(super) tables: BTreeMap<String, TableRequirement>,
    pub(super) commands: BTreeMap<String, CommandRequirement>,
    pub(super) options: BTreeMap<String, CommandRequirement>,
    pub(super) exceptions: BTreeMap<String, String>,
}

pub(super) static CAPABILITIES: LazyLock<Capabilities> = LazyLock::new(|| {
    // The file is part of the program; tests would detect a mistake in it.
    #[allow(clippy::expect_used, reason = "no user can influence it")]
    toml::from_str(include_str!("capabilities.toml")).expect("capabilities.toml is of this form")
});

/// Sentences on missing and superfluous entries of `capabilities.toml`: tables, commands or options without description, and
/// descriptions of things that do not exist.
pub fn undescribed(interface: &Interface) -> Vec<String> {
    let described = &*CAPABILITIES;
    let mut found = Vec::new();
    let mut exists = std::collections::BTreeSet::new();
    let mut need = |name: String, is_described: bool| {
        if !is_described {
            found.push(format!("`{name}` is not described in capabilities.toml"));
        }
        exists.insert(name);
    };
    for key in scene_keys() {
        need(
            key.table.to_owned(),
            described.tables.contains_key(key.table),
        );
        // A key needs no description of its own; an exception has to name one that exists.
        need(key.id, true);
    }
    let is_exception = |name: &str| described.exceptions.contains_key(name);
    for option in &interface.common_options {
        need(option.clone(), is_exception(option));
    }
    for (command, options) in &interface.commands {
        let is_described = described.commands.contains_key(command) || is_exception(command);
        need(command.clone(), is_described);
        for option in options {
            let name = format!("{command} {option}");
            let is_described = described.options.contains_key(&name) || is_exception(&name);
            need(name, is_described);
        }
    }
    let names = (described.tables.keys())
        .chain(described.commands.keys())
        .chain(described.options.keys())
        .chain(described.exceptions.keys());
    let gone = names.filter(|name| {
        !exists.contains(*name) && !["--help", "--version"].contains(&name.as_str())
    });
    found.extend(
        gone.map(|name| format!("capabilities.toml describes `{name}`, which does not exist")),
    );
    found
}
