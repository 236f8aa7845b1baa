//! The command as it is run: exit status, files, and every word of its messages.
#![allow(clippy::unwrap_used, reason = "a test")]

mod along;
mod bench;
mod messages;
mod results;
mod sweep;
