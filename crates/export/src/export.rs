//! A machine with its fitted parts and their measured errors: all data that a target needs.

mod measure;

pub use measure::{Errors, Measured, STATED_STEP, SelfTestMotion, SelfTestRow};

use crate::error::FitError;
use crate::evaluator::Evaluator;
use crate::fit::fit;
use crate::machine::{FunctionSampler, LoadDescription, MachineDescription, Motor, PartKind};
use crate::part::{Column, Part, Precision};
use crate::slopes::with_slopes;
use dwell_numerics::Real;
use dwell_numerics::StraightLine;
use measure::{measure, row};

/// The requested export.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// The accuracy of every function, relative to its largest value. The error of operations is their rounding.
    pub accuracy: f64,
    /// The numbers.
    pub precision: Precision,
}

/// An export, ready to be written for any target.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// The machine.
    pub machine: MachineDescription,
    /// The request.
    pub request: Request,
    /// By part, in the order of [`PartKind::ALL`].
    pub parts: [Part; 3],
    /// For an exact export: the operations of each part; no part then has cells.
    pub code: Option<[StraightLine; 3]>,
    /// The measured errors and counts, which the export states.
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
        let (accuracy, precision) = (Some(request.accuracy), request.precision);
        let export = Self::measured(machine, accuracy, precision, None, sampler)?;
        match export.error_beyond(10.0 * request.accuracy) {
            Some(error) => Err(FitError::NarrowPeak { error }),
            None => export.within_precision(),
        }
    }

    /// The largest error, if it exceeds this accuracy and possible rounding. Then the fitted or recorded functions are wrong.
    fn error_beyond(&self, accuracy: f64) -> Option<f64> {
        let rounding: f64 = match self.request.precision {
            Precision::Double => 1e-7,
            Precision::Float => 1e-3,
        };
        let error = self.measured.errors.max();
        (error.is_nan() || error > rounding.max(accuracy)).then_some(error)
    }

    /// Records the operations of all functions of a machine, and measures them. By part in the order of [`PartKind::ALL`],
    /// the outputs are value and half the slope of each [curve](MachineDescription::curves), then the
    /// [columns](MachineDescription::columns).
    ///
    /// # Errors
    /// [`FitError`] if a function has no value or is not periodic, or if the operations are not those of the function.
    pub fn exact<S: FunctionSampler>(
        machine: MachineDescription,
        precision: Precision,
        code: [StraightLine; 3],
        sampler: &mut S,
    ) -> Result<Self, FitError<S::Error>> {
        let [motion, reactions, positions] = code;
        let first = 2 * machine.curves(PartKind::Motion).len();
        let motion = with_slopes(&motion, first, &machine.rotor_columns());
        let code = Some([motion, reactions, positions]);
        let mut export = Self::measured(machine, None, precision, code, sampler)?;
        if let Some(error) = export.error_beyond(0.0) {
            return Err(FitError::OtherOperations { error });
        }
        export.request.accuracy = export.measured.errors.max();
        export.within_precision()
    }

    /// The export of a machine in cells of an accuracy, or as operations, with its measured errors.
    fn measured<S: FunctionSampler>(
        machine: MachineDescription,
        accuracy: Option<f64>,
        precision: Precision,
        code: Option<[StraightLine; 3]>,
        sampler: &mut S,
    ) -> Result<Self, FitError<S::Error>> {
        let mut one = |kind| fit(&machine, kind, accuracy, precision, sampler);
        let fitted = [
            one(PartKind::Motion)?,
            one(PartKind::Reactions)?,
            one(PartKind::Positions)?,
        ];
        let scales = row(
            &machine,
            fitted.each_ref().map(|part| &part.scales[..]),
            2.0,
        );
        let mut export = Self {
            machine,
            request: Request {
                accuracy: accuracy.unwrap_or_default(),
                precision,
            },
            parts: fitted.map(|fitted| fitted.part),
            code,
            measured: Measured::default(),
        };
        export.measured = measure(&export, &scales, sampler).map_err(FitError::Sampler)?;
        Ok(export)
    }

    /// Its code in Rust, in one number type.
    pub fn evaluator<R: Real>(&self) -> Evaluator<R> {
        let precision = self.request.precision;
        match &self.code {
            Some(code) => Evaluator::exact(&self.machine, code, precision),
            None => Evaluator::new(&self.machine, &self.parts, precision),
        }
    }

    /// Itself, if all its numbers are within the precision.
    fn within_precision<E>(self) -> Result<Self, FitError<E>> {
        match self.too_large() {
            Some(name) => Err(FitError::TooLarge { name }),
            None => Ok(self),
        }
    }

    /// The name of a quantity whose numbers exceed the range of the precision, if there is any.
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
        let mut constants = self.code.iter().flatten().flat_map(StraightLine::constants);
        if !constants.all(fits) {
            return Some("a constant of the code".to_owned());
        }
        for LoadDescription { name, effect, .. } in &self.machine.loads {
            let motor = effect.motor().map_or([0.0; 5], Motor::constants);
            if !fits(effect.scene_value()) || !motor.into_iter().all(fits) {
                return Some(name.clone());
            }
        }
        let starts = self.machine.initial.into_iter().all(fits);
        (!starts).then(|| "the initial state".to_owned())
    }

    /// Square roots, sines, cosines and angles of the terms of motion, and of those of motion and reactions; zero for
    /// cells.
    pub fn functions(&self) -> [usize; 2] {
        let count = |part: usize| self.code.as_ref().map_or(0, |code| code[part].functions());
        [count(0), count(0) + count(1)]
    }

    /// Bytes of the constants in cells.
    pub fn constant_bytes(&self) -> usize {
        let bytes = |part: &Part| part.bytes(self.request.precision);
        self.parts.iter().map(bytes).sum()
    }
}
