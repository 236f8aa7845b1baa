//! Ctrl-C of a search, which keeps the best design so far.

use crate::print_note;
use dwell_dynamics::interruption;
use std::process::exit;

/// The exit status of a program that Ctrl-C ended, by convention of shells.
const ENDED_BY_INTERRUPT: i32 = 130;

/// From now on, the first Ctrl-C ends the search, whose best design so far is written, and the second ends the command.
pub(crate) fn keep_best_so_far() {
    let handler = || {
        if interruption::is_requested() {
            exit(ENDED_BY_INTERRUPT);
        }
        interruption::request();
        print_note("interrupted: the best design so far follows (Ctrl-C again: without results)");
    };
    // Without a handler, Ctrl-C ends the command at once.
    let _ = ctrlc::set_handler(handler);
}
