//! The reduced coefficients as straight-line code of the coordinate, the dimensions and the mass properties: what a gradient by
//! all numbers of a mechanism is computed from.

use crate::error::PositionResult;
use crate::mass::Mass;
use crate::model::Model;
use crate::pass::{PassModel, RecursivePass};
use crate::reduced::Coefficients;
use crate::variants::{PER_BODY, mass_of};
use dwell_geometry::{Mechanism, PositionError};
use dwell_numerics::{RecordedNumber, RecordingError, StraightLine, record_at};
use thiserror::Error;

/// Why the coefficients of a mechanism cannot be recorded.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CoefficientsRecordingError {
    /// It has another structure than the model, or a vector, a mass or an inertia that is zero in the model.
    #[error(
        "the mechanism has another structure than the model, or a number where the model has none"
    )]
    Structure,
    /// It has not one actuator.
    #[error("it has {0} actuators, not one")]
    Actuators(usize),
    /// An evaluation failed or has no straight-line code.
    #[error(transparent)]
    Recording(#[from] RecordingError<PositionError>),
}

/// The reduced coefficients of a mechanism as operations.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedCoefficients {
    /// The operations. [`inputs`](Self::inputs) are the coordinate (rad or m), the numbers, and the unknowns of groups that are solved by
    /// iterations; outputs are m, ½m′, all a, all b.
    pub code: StraightLine,
    /// The dimensions, m, and by body the mass (kg), the centre of mass (m, m) and the moment of inertia about it (kg m²), in the
    /// order of [`VariantModel::numbers`](crate::variants::VariantModel::numbers).
    pub numbers: Vec<f64>,
    model: PassModel,
}

impl RecordedCoefficients {
    /// The inputs of the operations at a coordinate, rad or m: the coordinate, [`numbers`](Self::numbers), the unknowns there.
    ///
    /// # Errors
    /// [`PositionError`] if there is no pose.
    pub fn inputs(&self, q: f64) -> PositionResult<Vec<f64>> {
        inputs(&self.model, &self.numbers, q)
    }
}

fn inputs(model: &PassModel, numbers: &[f64], q: f64) -> PositionResult<Vec<f64>> {
    let mut pose = model.plan.pose();
    model.plan.positions(&[q], &mut pose)?;
    Ok([&[q], numbers, &model.plan.iterated_values(&pose)].concat())
}

impl Model {
    /// Records the reduced coefficients of a mechanism of the structure of this model, of one actuator, with these masses: at each of
    /// the coordinates, rad or m, where the operations must be the same.
    ///
    /// # Errors
    /// [`CoefficientsRecordingError`].
    pub fn record_coefficients(
        &self,
        mechanism: &Mechanism,
        masses: &[Mass],
        coordinates: &[f64],
    ) -> Result<RecordedCoefficients, CoefficientsRecordingError> {
        if self.plan().actuators() != 1 {
            return Err(CoefficientsRecordingError::Actuators(
                self.plan().actuators(),
            ));
        }
        let dimensions = self.plan().dimensions(mechanism);
        let dimensions = dimensions.ok_or(CoefficientsRecordingError::Structure)?;
        let mut model = self.pass_model.clone();
        if !model.set_numbers(&dimensions, masses) {
            return Err(CoefficientsRecordingError::Structure);
        }
        let count = dimensions.len();
        let mut numbers = dimensions;
        numbers.extend((masses.iter()).flat_map(|m| [m.mass, m.center.x, m.center.y, m.inertia]));
        let positions = coordinates.iter().map(|&q| inputs(&model, &numbers, q));
        let positions: Vec<Vec<f64>> = positions
            .collect::<PositionResult<_>>()
            .map_err(RecordingError::Evaluation)?;
        let code = record_at(&positions, |inputs| {
            let (q, rest) = inputs.split_at(1);
            let (dimensions, rest) = rest.split_at(count);
            let (masses, unknowns) = rest.split_at(numbers.len() - count);
            let masses: Vec<_> = masses.chunks_exact(PER_BODY).map(mass_of).collect();
            let mut lifted = self.pass_model.lifted::<RecordedNumber>();
            lifted.set_numbers(dimensions, &masses);
            let (mut pose, mut motion) = (lifted.plan.pose(), lifted.plan.motion());
            let mut passes = RecursivePass::new(&lifted);
            let mut out = Coefficients::buffer(self.reactions().len());
            lifted.plan.positions_at_solution(q, unknowns, &mut pose)?;
            lifted.reduce_at_pose(&pose, &mut motion, &mut passes, &mut out);
            Ok([vec![out.m, out.half_dm], out.a, out.b].concat())
        })?;
        Ok(RecordedCoefficients {
            code,
            numbers,
            model,
        })
    }
}
