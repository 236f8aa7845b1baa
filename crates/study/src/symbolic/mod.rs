//! `dwell symbolic`: closed forms of a mechanism made of dyads, compared with its numerical model.

mod closed_form_check;
mod compute;
#[cfg(feature = "output")]
mod output;

pub use compute::{compute_closed_form, symbolic_findings};
#[cfg(feature = "output")]
pub use output::{FormulaFormat, symbolic};
