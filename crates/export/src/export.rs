//! A machine with its fitted parts and what was measured of them: all that a target needs.

use crate::fit::{FitError, FittedPart, fit};
use crate::machine::{FunctionSampler, MachineDescription, PartKind};
use crate::measure::{Measured, measure};
use crate::part::{Part, Precision};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// The accuracy of every function, relative to its largest value.
    pub accuracy: f64,
    /// The numbers.
    pub precision: Precision,
}

/// An export, ready to be written for any target.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The machine.
    pub machine: MachineDescription,
    /// What was asked for.
    pub request: Request,
    /// By part, in the order of [`PartKind::ALL`].
    pub parts: [Part; 3],
    /// What it states about itself.
    pub measured: Measured,
}

impl Export {
    /// Fits and measures all functions of a machine.
    ///
    /// # Errors
    /// [`FitError`] where a function has no value, is not periodic, or bends too much for the accuracy.
    pub fn new<S: FunctionSampler>(
        machine: MachineDescription,
        request: Request,
        sampler: &mut S,
    ) -> Result<Self, FitError<S::Error>> {
        let Request {
            accuracy,
            precision,
        } = request;
        let mut one = |kind| fit(&machine, kind, accuracy, precision, sampler);
        let fitted: [FittedPart; 3] = [
            one(PartKind::Motion)?,
            one(PartKind::Reactions)?,
            one(PartKind::Positions)?,
        ];
        let measured = measure(&machine, &fitted, precision, sampler).map_err(FitError::Sampler)?;
        let parts = fitted.map(|fitted| fitted.part);
        Ok(Self {
            machine,
            request,
            parts,
            measured,
        })
    }

    /// Bytes of the constants.
    pub fn constant_bytes(&self) -> usize {
        let bytes = |part: &Part| part.bytes(self.request.precision);
        self.parts.iter().map(bytes).sum()
    }
}
