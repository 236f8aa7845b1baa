//! `dwell kinematics`, `dwell statics`, `dwell kinetostatics`: a mechanism along a prescribed motion or a
//! coordinate sweep.

#[cfg_attr(
    not(feature = "output"),
    allow(dead_code, reason = "what is printed belongs to `output`")
)]
pub(crate) mod column_extrema;
pub mod compute;
#[cfg(feature = "output")]
pub(crate) mod document;
#[cfg(feature = "output")]
pub(crate) mod figures;
#[cfg(feature = "output")]
mod highlights;
#[cfg(feature = "output")]
pub(crate) mod output;
