//! One function per command: from a scene to results, findings and figures.
//!
//! ```text
//! Scene ── Subject (the exact model, for the checks: every reaction) ─┐
//!       └─ Prepared (the model of what the scene requests) ───────────┼─ check, reduce, simulate,
//!                                                                     │  calibrate, validate
//!                                                                     └→ Outcome: words, files, findings
//! Scene + values ── Design, Wanted ── points, each compiled once ── Store (SQLite) ── sweep
//! Scene ── Driven (the machine: loads, drives, what is free) ── cycle, equilibria, linearise
//! Scene ── Model under its loads ── Way (prescribed, swept or the range) ── Record ── run
//! ```
//!
//! [`run()`] is all of `kinematics`, `statics` and `kinetostatics`: they follow the same way through a scene
//! and differ in the columns that they compute.

mod ambiguous;
mod calibrate;
mod channels;
mod check;
mod claims;
mod cycle;
mod dossier;
mod driven;
mod equilibria;
mod error;
pub mod estimate;
pub mod extremes;
mod figures;
mod freed;

mod history;
mod index;
mod linearise;
mod motion_error;
mod multibody;
mod outcome;
mod page;
mod period;
mod prepare;
mod provenance;
mod quantity;
mod reduce;
mod reference;
mod rounding;
mod run;
mod simulate;
mod states;
mod subject;
mod sweep;
mod symbolic;
mod tabulate;
pub mod tradeoff;
mod validate;
mod words;

pub use calibrate::{Calibrated, calibrate, find_value};
pub use check::check;
pub use cycle::cycle;
pub use dwell_symbolic::Language;
pub use equilibria::equilibria;
pub use error::StudyError;
pub use index::{Verdict, index};
pub use linearise::{About, linearise};
pub use multibody::{FreeRun, free_run};
pub use outcome::{Outcome, Progress, Step, silent};
pub use prepare::Prepared;
pub use reduce::reduce;
pub use run::{Command, Followed, run};
pub use simulate::{Accuracy, PRESETS, simulate, simulate_within};
pub use states::{Judged, judge_case};
pub use subject::PlanSubject;
pub use sweep::{Exported, Shard, Sweep, SweepError, sweep};
pub use symbolic::{Printed, symbolic, symbolic_findings};
pub use tabulate::Tabulation;
pub use tradeoff::tradeoff;
pub use validate::{Validation, validate};
