//! Machines of several degrees of freedom: M q̈ + Σ h_ij q̇ᵢ q̇ⱼ = Σ w F and R = Σ a q̈ᵢ + Σ b_ij q̇ᵢ q̇ⱼ + Σ c F, with the model's own
//! [recorded](crate::record_at) operations.
//!
//! Products of velocities are taken in pairs i ≤ j, in the order (0, 0), (0, 1), …, (1, 1), …; a pair has the terms of both orders.

mod c;
mod evaluator;
mod measure;

pub use c::c_files_of_several_freedoms;
pub use evaluator::SeveralFreedomsEvaluator;
pub use measure::{SampledState, SeveralFreedomsErrors};

use crate::machine::LoadDescription;
use crate::part::Precision;
use crate::straight_line::{Operand, StraightLine};

/// A machine of several degrees of freedom, as plain data.
#[derive(Debug, Clone, PartialEq)]
pub struct SeveralFreedomsDescription {
    /// The name that the names of files and functions begin with.
    pub name: String,
    /// The title of its scene. It may hold any character.
    pub title: String,
    /// The hash of its scene.
    pub scene_hash: String,
    /// The version of the program that exports it.
    pub version: String,
    /// The coordinates.
    pub coordinates: Vec<FreeCoordinate>,
    /// The loads and drives.
    pub loads: Vec<LoadDescription>,
    /// The reactions: name and unit, `N` or `N m`.
    pub reactions: Vec<(String, &'static str)>,
    /// The points whose positions are exported.
    pub points: Vec<String>,
    /// Sentences about what the scene has and the export has not.
    pub left_out: Vec<String>,
}

/// A coordinate of a machine of several degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeCoordinate {
    /// Its name.
    pub name: String,
    /// Whether it is an angle (rad), else a length (m).
    pub is_angle: bool,
    /// q and q̇ at the start, rad and rad/s, or m and m/s.
    pub initial: [f64; 2],
}

impl SeveralFreedomsDescription {
    /// The number of coordinates.
    pub fn freedoms(&self) -> usize {
        self.coordinates.len()
    }

    /// The pairs of coordinates, i ≤ j.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        let n = self.freedoms();
        let from = |i: usize| (i..n).map(move |j| [i, j]);
        (0..n).flat_map(from).collect()
    }
}

/// An export of several degrees of freedom, ready to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct SeveralFreedomsExport {
    /// The machine.
    pub machine: SeveralFreedomsDescription,
    /// The numbers.
    pub precision: Precision,
    /// The operations, whose outputs are, in this order:
    /// of the motion M by pair; h by pair, then coordinate; w by load, then coordinate; the potential of each load (zero if it has none);
    /// of the reactions a by coordinate, b by pair and c by load, each then by reaction; of the positions x and y by point.
    pub code: [StraightLine; 3],
    /// The largest differences from the model.
    pub errors: SeveralFreedomsErrors,
    /// States of the self-test.
    pub states: Vec<SampledState>,
}

impl SeveralFreedomsExport {
    /// Measures the operations of a machine against its exact functions at positions: `exact` gives the outputs of each code.
    ///
    /// # Errors
    /// That of `exact`.
    pub fn new<E>(
        machine: SeveralFreedomsDescription,
        precision: Precision,
        code: [StraightLine; 3],
        positions: &[Vec<f64>],
        mut exact: impl FnMut(&[f64]) -> Result<[Vec<f64>; 3], E>,
    ) -> Result<Self, E> {
        let (errors, states) = match precision {
            Precision::Double => {
                measure::measure::<f64, E>(&machine, &code, positions, &mut exact)?
            }
            Precision::Float => measure::measure::<f32, E>(&machine, &code, positions, &mut exact)?,
        };
        Ok(Self {
            machine,
            precision,
            code,
            errors,
            states,
        })
    }

    /// The first drive with a rotor whose line depends on the position: its inertia would need the line's derivative.
    pub fn unsupported_rotor(
        machine: &SeveralFreedomsDescription,
        motion: &StraightLine,
    ) -> Option<usize> {
        let (n, pairs) = (machine.freedoms(), machine.pairs().len());
        let first = pairs + pairs * n;
        (0..machine.loads.len()).find(|&k| {
            let of_load = &motion.outputs[first + k * n..][..n];
            let varies = |o: &Operand| !matches!(o, Operand::Constant(_));
            crate::evaluator::has_rotor(&machine.loads[k].effect) && of_load.iter().any(varies)
        })
    }
}
