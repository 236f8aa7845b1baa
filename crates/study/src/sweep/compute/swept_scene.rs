//! The trait of a scene for sweeps, which vary its numbers.

use crate::explain::StudyError;
use crate::free_motion::compute::SimulatedScene;
use crate::sweep::compute::available::IndexedReaction;
use crate::sweep::compute::extremes::ExtremeValues;
use crate::sweep::compute::point::Results;
use crate::sweep::compute::{Design, NamedUnit, RequestedQuantities, VariantFamily};
use crate::trajectory::compute::Analysis;
use dwell_dynamics::Machine;
use dwell_scene::SceneError;

/// A scene in the plane or in space whose numbers are varied.
pub trait SweptScene: SimulatedScene {
    /// Notes on its assembly.
    ///
    /// # Errors
    /// [`StudyError`] if it requests something that does not exist.
    fn notes(&self, _: &Self::Rows) -> Result<String, StudyError> {
        Ok(String::new())
    }

    /// The requested reactions that are results.
    fn swept_reactions(&self, compiled: &Self::Rows) -> Vec<IndexedReaction>;

    /// Columns of a free motion whose results can be swept, in addition to coordinates, their speeds, and reactions.
    fn further_motion_columns(&self) -> Vec<NamedUnit> {
        Vec::new()
    }

    /// Its machine with all coordinates free.
    ///
    /// # Errors
    /// [`StudyError`] if a load or a drive does not fit it.
    fn free_machine(&self, _: &Self::Rows) -> Result<Machine<Self::Model>, StudyError> {
        self.machine(&[])
    }

    /// The extremes of m and ½m′ over the range.
    ///
    /// # Errors
    /// [`StudyError`] where a position cannot be reached, or there are several actuators.
    fn inertia_extremes(&self, compiled: &Self::Rows) -> Result<ExtremeValues, StudyError>;

    /// Refuses a variant that leaves open a requested reaction.
    ///
    /// # Errors
    /// [`StudyError`] that names the reaction.
    fn reject_open(&self, _: &Self::Rows, _: &RequestedQuantities) -> Result<(), StudyError> {
        Ok(())
    }

    /// Computes the requested reactions in the free rotation of an energy, J.
    fn compute_free_reactions(
        &self,
        compiled: &Self::Rows,
        energy: f64,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    );

    /// The rows with the loads of the scene, of [unloaded](crate::trajectory::compute::RowScene::unloaded_rows) ones.
    ///
    /// # Errors
    /// [`StudyError`] if a load does not fit.
    fn with_all_loads(&self, rows: Self::Rows) -> Result<Self::Rows, StudyError> {
        Ok(rows)
    }

    /// The largest forces by the names of their results, of scenes where they are searched in another way than other statistics.
    ///
    /// # Errors
    /// [`StudyError`] where the trajectory ends early.
    fn largest_forces(
        &self,
        _: &Self::Rows,
        _: Analysis,
    ) -> Result<Vec<(String, f64)>, StudyError> {
        Ok(Vec::new())
    }

    /// The scene with some numbers replaced, in its own units.
    ///
    /// # Errors
    /// [`SceneError`] if a number does not exist, or the scene is invalid with it.
    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError>;

    /// The structure that all variants share; `None` if each is compiled separately.
    fn family(&self, design: &Design, requested: &RequestedQuantities) -> Option<VariantFamily>;
}
