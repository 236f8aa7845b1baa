//! Ends the integrations of this process on request, for programs whose user has had enough.
//!
//! ```
//! use dwell_dynamics::interruption;
//! interruption::request();
//! assert!(interruption::is_requested());
//! interruption::clear();
//! ```

use crate::error::{DynamicsError, Result};
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Every integration that runs ends with [`DynamicsError::Interrupted`] at its next evaluation, until [`clear`].
pub fn request() {
    REQUESTED.store(true, Ordering::Relaxed);
}

/// Integrations go on again.
pub fn clear() {
    REQUESTED.store(false, Ordering::Relaxed);
}

/// Whether they are to end.
pub fn is_requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}

/// The error, if they are to end. It costs a load from memory.
#[inline]
pub(crate) fn check() -> Result<()> {
    if is_requested() {
        return Err(DynamicsError::Interrupted);
    }
    Ok(())
}
