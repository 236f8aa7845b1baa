//! Long computations: other Python threads go on meanwhile, and Ctrl-C ends them.

use dwell_dynamics::interruption;
use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

/// How often signals are looked at while a computation runs.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Runs a computation in a thread of its own. On Ctrl-C all running computations of this process end, and KeyboardInterrupt is
/// raised.
pub(crate) fn run<T: Send>(py: Python<'_>, compute: impl FnOnce() -> T + Send) -> PyResult<T> {
    let (sender, mut receiver) = sync_channel(1);
    thread::scope(|scope| {
        let worker = scope.spawn(move || {
            // The receiver lives until this thread has ended.
            let _ = sender.send(compute());
        });
        loop {
            let looked_at = &mut receiver;
            match py.detach(move || looked_at.recv_timeout(BETWEEN_LOOKS)) {
                Ok(found) => return Ok(found),
                // It panicked: joining it says so.
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Err(signal) = py.check_signals() {
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
