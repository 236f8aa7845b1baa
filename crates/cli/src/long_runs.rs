//! Progress lines on standard error for runs without a progress bar, whose output is a file or a pipe.

use crate::print_note;
use indicatif::ProgressBar;
use std::io::{IsTerminal as _, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Times of the first lines, s; then one line follows each minute. A shorter run prints none.
const FIRST_LINES: [u64; 4] = [2, 10, 30, 60];

/// Prints the lines of a run until it is dropped.
pub(crate) struct LongRunLines {
    /// Ends the lines when it is dropped.
    running: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl LongRunLines {
    /// The lines of a `command` with the progress of a bar; none on a terminal, which shows the bar.
    pub(crate) fn new(command: &str, bar: &ProgressBar) -> Self {
        if stderr().is_terminal() {
            return Self {
                running: None,
                thread: None,
            };
        }
        let (begin, command, bar) = (Instant::now(), command.to_owned(), bar.clone());
        let (running, ended) = channel::<()>();
        let print_lines = move || {
            for seconds in line_times() {
                let wait = Duration::from_secs(seconds).saturating_sub(begin.elapsed());
                match ended.recv_timeout(wait) {
                    Err(RecvTimeoutError::Timeout) => {}
                    Ok(()) | Err(RecvTimeoutError::Disconnected) => return,
                }
                let progress = (bar.position(), bar.length(), bar.message());
                print_note(&line(&command, seconds, &progress));
            }
        };
        Self {
            running: Some(running),
            // If no thread can be started, the run continues without lines.
            thread: std::thread::Builder::new().spawn(print_lines).ok(),
        }
    }
}

impl Drop for LongRunLines {
    fn drop(&mut self) {
        self.running = None;
        if let Some(thread) = self.thread.take() {
            // The thread only prints; it has no result.
            let _ = thread.join();
        }
    }
}

/// The times of the lines, s.
fn line_times() -> impl Iterator<Item = u64> {
    FIRST_LINES
        .into_iter()
        .chain((2..).map(|minutes| 60 * minutes))
}

/// A line after `seconds`: number of completed steps, of all steps, and the last step.
fn line(command: &str, seconds: u64, progress: &(u64, Option<u64>, String)) -> String {
    let time = match seconds % 60 {
        0 => format!("{} min", seconds / 60),
        _ => format!("{seconds} s"),
    };
    let text = format!("dwell {command}: running for {time}");
    match progress {
        (done, Some(total), last) if *total > 0 => {
            format!("{text}, {done} of {total} steps done (last: {last})")
        }
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_after_2_10_30_and_60_seconds_and_then_each_minute() {
        let times: Vec<u64> = line_times().take(7).collect();
        assert_eq!(times, [2, 10, 30, 60, 120, 180, 240]);
    }

    #[test]
    fn a_line_says_what_runs_and_how_far() {
        let early = line("simulate", 30, &(0, Some(0), String::new()));
        assert_eq!(early, "dwell simulate: running for 30 s");
        let later = line("sweep", 120, &(7, Some(90), "points".into()));
        assert_eq!(
            later,
            "dwell sweep: running for 2 min, 7 of 90 steps done (last: points)"
        );
    }
}
