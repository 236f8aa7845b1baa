//! Long computations: other Python threads continue, Ctrl-C ends the computation, and its progress is shown.

use crate::errors::Raise as _;
use dwell_dynamics::interruption;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

/// Interval at which signals are checked while a computation runs.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// The completed steps of a computation, and all; empty while unknown.
#[derive(Default)]
pub(crate) struct Steps {
    done: AtomicUsize,
    all: AtomicUsize,
}

impl Steps {
    /// Reports the number of completed steps, and of all steps.
    pub(crate) fn show(&self, done: usize, all: usize) {
        self.all.store(all, Ordering::Relaxed);
        self.done.fetch_max(done, Ordering::Relaxed);
    }

    fn get(&self) -> (usize, usize) {
        let [done, all] = [&self.done, &self.all].map(|n| n.load(Ordering::Relaxed));
        (done, all)
    }
}

/// Runs a computation in a separate thread. On Ctrl-C all running computations of this process end, and KeyboardInterrupt is
/// raised. `progress` is a Python function of the completed and of all steps, called while the computation runs.
pub(crate) fn run<T: Send>(
    progress: &Bound<'_, PyAny>,
    compute: impl FnOnce(&Steps) -> Result<T, dwell::Error> + Send,
) -> PyResult<T> {
    let py = progress.py();
    let (sender, mut receiver) = sync_channel(1);
    let steps = &Steps::default();
    thread::scope(|scope| {
        let worker = scope.spawn(move || {
            // The receiver lives until this thread has ended.
            let _ = sender.send(compute(steps));
        });
        loop {
            let looked_at = &mut receiver;
            match py.detach(move || looked_at.recv_timeout(BETWEEN_LOOKS)) {
                Ok(found) => return found.or_raise(py),
                // The thread panicked; joining it reports that.
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            let shown = progress.call1(steps.get()).map(drop);
            if let Err(signal) = py.check_signals().and(shown) {
                interruption::request();
                let ended = py.detach(|| worker.join());
                interruption::clear();
                return ended.map_or_else(|_| Err(panicked()), |()| Err(signal));
            }
        }
        Err(panicked())
    })
}

fn panicked() -> PyErr {
    pyo3::exceptions::PyRuntimeError::new_err("the computation failed: this is a fault of dwell")
}
