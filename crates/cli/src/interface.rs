//! The commands and their options for the verification manual, from the definition that parses the arguments.

use crate::options::Options;
use clap::CommandFactory as _;
use dwell_validation::manual::Interface;

/// All commands with their long options.
pub(crate) fn interface() -> Interface {
    let program = Options::command();
    let options = |command: &clap::Command| -> Vec<String> {
        let long = command
            .get_arguments()
            .filter_map(|option| option.get_long());
        long.map(|long| format!("--{long}")).collect()
    };
    let commands = program.get_subcommands();
    Interface {
        common_options: options(&program),
        commands: commands
            .map(|command| (command.get_name().to_owned(), options(command)))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_validation::manual::undescribed;

    #[test]
    fn every_command_and_option_is_described_for_the_manual_or_an_exception_with_a_reason() {
        let mut interface = interface();
        assert_eq!(undescribed(&interface), Vec::<String>::new());
        // An option without an entry is reported.
        interface.commands[0].1.push("--added".to_owned());
        assert_eq!(undescribed(&interface).len(), 1);
        // An entry without a command is reported.
        interface.commands.retain(|(name, _)| name != "runs");
        assert!(
            undescribed(&interface)
                .iter()
                .any(|why| why.contains("`runs`"))
        );
    }
}
