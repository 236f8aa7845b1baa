//! The coefficients of a reduced model, and the trait of the mechanisms that yield them.

use crate::error::PositionResult;
use crate::pass::InverseDynamics;
use dwell_geometry::Range;
use dwell_numerics::Scalar;
use std::fmt::Debug;

/// The coefficients of the reduced model at one coordinate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coefficients<T = f64> {
    /// Generalised inertia m, kg m².
    pub m: T,
    /// Half its derivative, ½m′, kg m².
    pub half_dm: T,
    /// By requested reaction: the coefficient of q̈, kg m or kg m².
    pub a: Vec<T>,
    /// By requested reaction: the coefficient of q̇², kg m or kg m².
    pub b: Vec<T>,
}

impl<T: Scalar> Coefficients<T> {
    /// A buffer for the given number of reactions.
    pub fn buffer(reactions: usize) -> Self {
        let zeros = vec![T::from_f64(0.0); reactions];
        Self {
            a: zeros.clone(),
            b: zeros,
            ..Self::default()
        }
    }
}

/// A mechanism whose two unit passes give the reduced coefficients, in the plane or in space.
pub trait ReducibleModel: Sync + Sized {
    /// Working memory of one thread for passes in a kind of number.
    type Workspace<T: Scalar>: Debug + Clone + Send + Sync;

    /// Such memory.
    fn pass_workspace<T: Scalar>(&self) -> Self::Workspace<T>;

    /// A buffer for the results of this model.
    fn result_buffer<T: Scalar>(&self) -> InverseDynamics<T> {
        InverseDynamics::buffer(self.actuators(), self.reaction_count())
    }

    /// Number of actuators.
    fn actuators(&self) -> usize;

    /// Number of reactions.
    fn reaction_count(&self) -> usize;

    /// The range of the coordinate.
    fn range(&self) -> Range;

    /// This model, prepared for its reduced coefficients, so that their evaluation is cheap.
    #[must_use]
    fn for_coefficients(self) -> Self;

    /// This model without reactions and other parts that m and ½m′ do not need.
    #[must_use]
    fn for_inertia(&self) -> Self;

    /// The reduced coefficients at `q` (rad or m), for one actuator.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn reduce_at<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Self::Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> PositionResult;

    /// m and ½m′ of the only coordinate at `q` (rad or m), of a model without reactions.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    fn reduced_inertia<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Self::Workspace<T>,
    ) -> PositionResult<[T; 2]> {
        let mut out = Coefficients::default();
        self.reduce_at(q, workspace, &mut out)?;
        Ok([out.m, out.half_dm])
    }

    /// After [`ReducibleModel::reduced_inertia`], for each frame or hinge: its angle (rad, whole revolutions left out) and the derivative
    /// of this angle with respect to the coordinate.
    fn unit_turns(&self, workspace: &Self::Workspace<f64>) -> Vec<[f64; 2]>;
}
