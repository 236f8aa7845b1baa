//! `dwell symbolic`: closed forms of a mechanism made of dyads, compared with its numerical model.

mod closed_form_check;
pub(crate) mod compute;
#[cfg(feature = "output")]
pub(crate) mod output;
