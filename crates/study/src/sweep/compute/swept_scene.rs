//! A scene whose numbers are varied, for sweeps that know it by what it computes.

use crate::explain::{NamedScene, StudyError};
use crate::sweep::compute::available::Available;
use crate::sweep::compute::point::Results;
use crate::sweep::compute::{Design, RequestedQuantities, VariantFamily};
use dwell_scene::SceneError;

/// A scene in the plane or in space whose numbers are varied.
pub trait SweptScene: NamedScene + Sync + Sized {
    /// Every quantity that its sections allow.
    ///
    /// # Errors
    /// [`StudyError`] where it cannot be assembled.
    fn available_quantities(&self) -> Result<Available, StudyError>;

    /// Computes the requested quantities.
    ///
    /// # Errors
    /// [`StudyError`] where nothing can be computed; what fails by itself is recorded in the results.
    fn compute_results(
        &self,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    ) -> Result<(), StudyError>;

    /// The same scene with some numbers replaced, in its own units.
    ///
    /// # Errors
    /// [`SceneError`] where a number is not there, or the scene makes no sense with it.
    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError>;

    /// The structure that all variants share; none where each is compiled by itself.
    fn family(&self, design: &Design, requested: &RequestedQuantities) -> Option<VariantFamily>;
}
