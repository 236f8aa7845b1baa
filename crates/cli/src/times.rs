//! The times of the stages of a command.

use std::time::{Duration, Instant};

/// The stages of a command with their durations.
pub(crate) struct Times {
    since: Instant,
    stages: Vec<(&'static str, Duration)>,
}

impl Times {
    /// Starts the first stage.
    pub(crate) fn new() -> Self {
        Self {
            since: Instant::now(),
            stages: Vec::new(),
        }
    }

    /// Ends a stage and starts the next.
    pub(crate) fn add(&mut self, stage: &'static str) {
        let now = Instant::now();
        self.stages.push((stage, now - self.since));
        self.since = now;
    }

    /// The stages as a line.
    pub(crate) fn text(&self) -> String {
        let whole: Duration = self.stages.iter().map(|(_, time)| *time).sum();
        let stages: Vec<String> = self
            .stages
            .iter()
            .map(|(stage, time)| format!("{stage} {}", seconds(*time)))
            .collect();
        format!("time: {} ({})", seconds(whole), stages.join(", "))
    }
}

/// A duration with two or three digits.
fn seconds(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        _ if seconds < 0.001 => "below 1 ms".to_owned(),
        _ if seconds < 1.0 => format!("{:.0} ms", seconds * 1e3),
        _ if seconds < 100.0 => format!("{seconds:.1} s"),
        _ => format!("{seconds:.0} s"),
    }
}
