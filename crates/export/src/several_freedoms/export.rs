//! A machine with its operations and their measured errors.

use super::description::SeveralFreedomsDescription;
use super::measure::{SampledState, SeveralFreedomsErrors, measure};
use crate::part::Precision;
use dwell_numerics::{Operand, StraightLine};

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
    /// Measures the operations of a machine against its exact functions at positions: `exact` returns the outputs of each
    /// code.
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
            Precision::Double => measure::<f64, E>(&machine, &code, positions, &mut exact)?,
            Precision::Float => measure::<f32, E>(&machine, &code, positions, &mut exact)?,
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
            machine.loads[k].effect.has_rotor() && of_load.iter().any(varies)
        })
    }
}
