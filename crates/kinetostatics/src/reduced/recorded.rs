//! The reduced coefficients as straight-line code of the coordinate, the dimensions and the mass properties: what a gradient by
//! all numbers of a mechanism is computed from.

use super::Coefficients;
use crate::mass::Mass;
use crate::model::Model;
use crate::pass::RecursivePass;
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
    /// A group is solved by iterations, whose number and start belong to one position.
    #[error("group {group} is solved by iterations")]
    Iterations {
        /// Its index in the plan.
        group: usize,
    },
    /// An evaluation failed or has no straight-line code.
    #[error(transparent)]
    Recording(#[from] RecordingError<PositionError>),
}

/// The reduced coefficients of a mechanism as operations.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedCoefficients {
    /// The operations. Inputs are the coordinate (rad or m), then [`numbers`](Self::numbers); outputs are m, ½m′, all a, all b.
    pub code: StraightLine,
    /// The dimensions, m, and by body the mass (kg), the centre of mass (m, m) and the moment of inertia about it (kg m²), in the
    /// order of [`VariantModel::numbers`](crate::variants::VariantModel::numbers).
    pub numbers: Vec<f64>,
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
        if let Some(group) = self.plan().first_iterated_group() {
            return Err(CoefficientsRecordingError::Iterations { group });
        }
        let dimensions = self.plan().dimensions(mechanism);
        let mut numbers = dimensions.ok_or(CoefficientsRecordingError::Structure)?;
        numbers.extend((masses.iter()).flat_map(|m| [m.mass, m.center.x, m.center.y, m.inertia]));
        let mut fits = true;
        let with_numbers = |&q: &f64| std::iter::once(q).chain(numbers.iter().copied()).collect();
        let positions: Vec<Vec<f64>> = coordinates.iter().map(with_numbers).collect();
        let code = record_at(&positions, |inputs| {
            let (q, numbers) = inputs.split_at(1);
            let mut model = self.pass_model.lifted::<RecordedNumber>();
            let (dimensions, masses) = numbers.split_at(self.plan().dimension_count());
            let masses: Vec<_> = masses.chunks_exact(PER_BODY).map(mass_of).collect();
            fits &= model.set_numbers(dimensions, &masses);
            let (mut pose, mut motion) = (model.plan.pose(), model.plan.motion());
            let mut passes = RecursivePass::new(&model);
            let mut out = Coefficients::buffer(self.reactions().len());
            model.reduce(q[0], &mut pose, &mut motion, &mut passes, &mut out)?;
            Ok([vec![out.m, out.half_dm], out.a, out.b].concat())
        })?;
        if fits {
            Ok(RecordedCoefficients { code, numbers })
        } else {
            Err(CoefficientsRecordingError::Structure)
        }
    }
}
