//! The trait of a scene with its model for tables, figures and texts of reduced parameters, in the plane or in space.

use super::UnitLoadCurves;
use crate::explain::{StudyError, explain_motion, explain_position};
use crate::models::{PreparedScene, exact_model, lists_reactions, loaded_determinate_model};
use crate::ranges::equally_spaced;
use crate::trajectory::compute::default_limits;
#[cfg(feature = "output")]
use crate::{
    branch_note::branch_note,
    models::requested_reactions,
    output::{coordinate_label, indeterminate_note, separating_note},
};
use dwell_findings::Column;
use dwell_geometry::Range;
use dwell_kinetostatics::{
    Batch, Coefficients, KinetostaticsError, ReducedModel as _, TableDomain, TableError,
    TabulatedModel,
};
use dwell_scene::SceneFile;

/// m and ½m′ at a coordinate (rad or m); `None` if there is no pose.
pub type InertiaAt<'a> = Box<dyn FnMut(f64) -> Option<(f64, f64)> + 'a>;

/// A scene with a reduced model, in the plane or in space.
pub trait ReducedScene: Sync {
    /// The file of the scene.
    fn file(&self) -> &SceneFile;

    /// The name of the coordinate.
    fn coordinate_name(&self) -> &str;

    /// Whether the coordinate is an angle; otherwise it is a length.
    fn is_angle(&self) -> bool;

    /// Names and units (of a force or a moment) of the reactions of the model.
    fn reaction_units(&self) -> Vec<(String, &'static str)>;

    /// Whether the scene lists the reactions that it requests.
    fn lists_reactions(&self) -> bool;

    /// The range of the coordinate.
    fn range(&self) -> Range;

    /// Whether the range has a limit at its lower and at its upper end.
    fn has_limits(&self) -> [bool; 2];

    /// `intervals` + 1 equally spaced coordinates over the range, rad or m.
    fn positions(&self, intervals: usize) -> Vec<f64>;

    /// A length of the order of the mechanism, m.
    fn size(&self) -> f64;

    /// The coefficients at coordinates.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if one of them cannot be reached.
    fn coefficients(&self, q: &[f64]) -> Result<Vec<Coefficients>, StudyError>;

    /// The rounding errors of coefficients at a coordinate.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if it cannot be reached in 32 digits.
    fn rounding_errors(&self, q: f64, at: &Coefficients) -> Result<Coefficients, StudyError>;

    /// The function of m and ½m′, with its memory.
    fn inertia(&self) -> InertiaAt<'_>;

    /// The response to a unit of each load at coordinates; `None` without loads.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if one of them cannot be reached.
    fn unit_loads(&self, q: &[f64]) -> Result<Option<UnitLoadCurves>, StudyError>;

    /// The names of the loads.
    fn load_names(&self) -> Vec<String>;

    /// Explains that the model cannot be evaluated at a state.
    fn explain_evaluation(&self, error: &KinetostaticsError) -> StudyError;

    /// Columns of other reactions at coordinates, and their values.
    fn known_reactions(&self, _q: &[f64]) -> Vec<(Column, Vec<f64>)> {
        Vec::new()
    }

    /// Intervals between two rows in which a body turns so fast that m may be largest there, each from a rise to a fall
    /// of m.
    fn fast_turns(&self, _rows: &[f64]) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// The label of an axis of the coordinate.
    #[cfg(feature = "output")]
    fn coordinate_label(&self) -> String;

    /// The last lines of a summary: quantities that are not in the tables, with the reasons.
    #[cfg(feature = "output")]
    fn notes(&self) -> String;
}

/// A scene whose reduced model can become a table. It is a separate trait, so that a program without tables does not
/// contain their code.
pub trait TabulatedScene: ReducedScene {
    /// The reduced model as a table, with w and c of the loads; or the reason why there is none.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if a load does not fit the mechanism.
    fn tabulated(
        &self,
        accuracy: f64,
        domain: TableDomain,
    ) -> Result<Result<TabulatedModel, TableError>, StudyError>;
}

impl TabulatedScene for PreparedScene<'_> {
    fn tabulated(
        &self,
        accuracy: f64,
        domain: TableDomain,
    ) -> Result<Result<TabulatedModel, TableError>, StudyError> {
        let model = loaded_determinate_model(self.scene)?.for_unit_loads();
        let exact = exact_model(self.scene, model)?;
        Ok(TabulatedModel::new(&exact, accuracy, domain))
    }
}

impl ReducedScene for PreparedScene<'_> {
    fn file(&self) -> &SceneFile {
        &self.scene.file
    }

    fn coordinate_name(&self) -> &str {
        self.coordinate_name()
    }

    fn is_angle(&self) -> bool {
        self.is_angle()
    }

    fn reaction_units(&self) -> Vec<(String, &'static str)> {
        self.reaction_units()
    }

    fn lists_reactions(&self) -> bool {
        lists_reactions(self.scene)
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn has_limits(&self) -> [bool; 2] {
        let limits = self.model.model().plan().range_limits();
        limits.map(|limit| limit.is_some())
    }

    fn positions(&self, intervals: usize) -> Vec<f64> {
        if self.is_angle() {
            return self.range_positions(intervals);
        }
        // As `dwell kinematics` follows a length.
        let (limits, ..) = default_limits(self.scene, self.model.model().plan());
        equally_spaced(limits, intervals)
    }

    fn size(&self) -> f64 {
        self.scene.mechanism.size()
    }

    fn coefficients(&self, q: &[f64]) -> Result<Vec<Coefficients>, StudyError> {
        let mut batch = Batch::default();
        self.model.reduce_batch(q, &mut batch);
        if let Some((_, error)) = batch.errors.first() {
            let plan = self.model.model().plan();
            return Err(explain_position(self.scene, plan, error));
        }
        Ok((0..q.len()).map(|i| batch.coefficients(i)).collect())
    }

    fn rounding_errors(&self, q: f64, at: &Coefficients) -> Result<Coefficients, StudyError> {
        let model = self.model.model();
        let (mut workspace, mut errors) = (model.workspace(), model.coefficient_buffer());
        model
            .reduction_rounding_errors(q, at, &mut workspace, &mut errors)
            .map_err(|e| explain_position(self.scene, model.plan(), &e))?;
        Ok(errors)
    }

    fn inertia(&self) -> InertiaAt<'_> {
        let mut workspace = self.model.workspace();
        Box::new(move |q| self.model.inertia(q, &mut workspace).ok())
    }

    fn unit_loads(&self, q: &[f64]) -> Result<Option<UnitLoadCurves>, StudyError> {
        UnitLoadCurves::new(self, q)
    }

    fn load_names(&self) -> Vec<String> {
        let loads = self.scene.loads.iter();
        loads.map(|load| load.name.clone()).collect()
    }

    fn explain_evaluation(&self, error: &KinetostaticsError) -> StudyError {
        explain_motion(self.scene, self.model.model().plan(), &(*error).into())
    }

    fn known_reactions(&self, q: &[f64]) -> Vec<(Column, Vec<f64>)> {
        self.reactions_of_varying_inertias(q)
    }

    fn fast_turns(&self, rows: &[f64]) -> Vec<[f64; 2]> {
        super::fast_turns(self, rows)
    }

    #[cfg(feature = "output")]
    fn coordinate_label(&self) -> String {
        coordinate_label(self)
    }

    #[cfg(feature = "output")]
    fn notes(&self) -> String {
        let (scene, plan) = (self.scene, self.model.model().plan());
        let [_, indeterminate] = requested_reactions(scene, plan);
        let names = indeterminate.iter();
        let names = names.map(|&r| scene.mechanism.reaction_name(r));
        separating_note(scene) + &branch_note(scene, plan) + &indeterminate_note(names)
    }
}
