//! The command as it is run: exit status, files, and every word of its messages.
#![allow(clippy::unwrap_used, reason = "a test")]

mod assembly;
mod designs;
mod endings;
mod exported_runs;
mod friction;
mod html;
mod imported;
mod lengths;
mod long_motions;
mod many_rows;
mod messages;
mod modes;
mod narrow_loads;
mod near_branches;
mod output;
mod pictures;
mod real_time;
mod results;
mod rows;
mod silent_values;
mod space;
mod studies;
mod summaries;
mod sweep;
mod sweep_parts;
mod test_dir;
mod trajectories;
mod written_files;
