//! Machines of several degrees of freedom: M q̈ + Σ h_ij q̇ᵢ q̇ⱼ = Σ w F and R = Σ a q̈ᵢ + Σ b_ij q̇ᵢ q̇ⱼ + Σ c F, with the model's own
//! [recorded](dwell_numerics::record_at) operations.
//!
//! Products of velocities are taken in pairs i ≤ j, in the order (0, 0), (0, 1), …, (1, 1), …; a pair has the terms of both orders.

mod c;
mod description;
mod evaluator;
mod export;
mod measure;

pub use c::c_files_of_several_freedoms;
pub use description::{FreeCoordinate, SeveralFreedomsDescription};
pub use evaluator::SeveralFreedomsEvaluator;
pub use export::SeveralFreedomsExport;
pub use measure::{SampledState, SeveralFreedomsErrors};
