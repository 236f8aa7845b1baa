//! A machine with its fitted parts and what was measured of them: all that a target needs.

use crate::fit::{FitError, FittedPart, fit};
use crate::machine::{FunctionSampler, MachineDescription, PartKind};
use crate::measure::{Measured, measure};
use crate::part::{Column, Part, Precision};
use crate::writer::Writer;

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
        let export = Self {
            machine,
            request,
            parts,
            measured,
        };
        match export.too_large() {
            Some(name) => Err(FitError::TooLarge { name }),
            None => Ok(export),
        }
    }

    /// What has a number beyond the precision, if there is any.
    fn too_large(&self) -> Option<String> {
        let fits = |value: f64| self.request.precision.round(value).is_finite();
        for part in &self.parts {
            let constants = part.columns.iter().filter_map(|(_, column)| match column {
                Column::Constant(value) => Some(*value),
                Column::Tabulated(_) => None,
            });
            if !part.cells.iter().copied().chain(constants).all(fits) {
                let first = part
                    .curves
                    .iter()
                    .chain(part.columns.iter().map(|(of, _)| of));
                let names = first.map(|&function| self.machine.function_name(function));
                return Some(names.collect::<Vec<_>>().join(", "));
            }
        }
        let writer = Writer::new(self);
        let constants = writer.parameters().into_iter();
        let inputs = writer
            .inputs()
            .into_iter()
            .map(|(_, name, value, _)| (name, value));
        let all = constants
            .map(|(name, value, _)| (name, value))
            .chain(inputs);
        let state = self
            .machine
            .initial
            .map(|value| ("the initial state".to_owned(), value));
        let mut large = all.chain(state).filter(|(_, value)| !fits(*value));
        large.next().map(|(name, _)| name)
    }

    /// Bytes of the constants.
    pub fn constant_bytes(&self) -> usize {
        let bytes = |part: &Part| part.bytes(self.request.precision);
        self.parts.iter().map(bytes).sum()
    }
}
