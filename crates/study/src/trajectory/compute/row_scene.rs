//! The trait of a scene for the analyses along a trajectory, in the plane or in space: its columns, and the evaluation of a row.

use crate::assembled::AskedScene;
use crate::explain::StudyError;
use crate::machines::{CoordinateOf, MachineScene};
use crate::trajectory::compute::{
    Analysis, Column, ColumnList, EarlyStop, FollowedScene, Quantity, RowEvaluator, SectionedLink,
    SweepLimits, TrajectorySample,
};
use dwell_geometry::{BodyId, JointId, PositionError};
use dwell_kinetostatics::{MachineModel, ReducibleModel as _};
use dwell_scene::{CoordinateSweep, NamedCoordinate, PrescribedMotion};
use std::borrow::Cow;

/// The components of vectors, and their names.
#[derive(Clone, Copy)]
pub struct Layout {
    /// The axes of points.
    pub(crate) axes: &'static [&'static str],
    /// The axes about which bodies turn, each with the end of its columns' names.
    pub(crate) turns: &'static [(usize, &'static str)],
    /// The rotation of a body and its derivatives: names and meanings.
    pub(crate) rotation: [(&'static str, &'static str); 3],
    /// Whether angles are unwrapped along a trajectory; otherwise the evaluator follows them.
    pub(crate) unwraps_angles: bool,
    /// The components of the force and the moment on the ground, with their units.
    pub(crate) shaking: &'static [(&'static str, &'static str)],
    /// Whether pictures show requested paths whose columns are not requested.
    pub(crate) draws_paths: bool,
}

/// The requests of a scene that determine its columns.
pub struct ColumnRequests<'a> {
    /// The requested names; `None` for all.
    pub(crate) variables: Option<&'a [String]>,
    pub(crate) lists_reactions: bool,
    /// The points whose paths are drawn.
    pub(crate) paths: Vec<(BodyId, [f64; 3])>,
    /// The body whose dwell is requested.
    pub(crate) dwell: Option<BodyId>,
}

/// A coordinate that is measured.
pub struct Measured<M: MachineModel> {
    pub(crate) name: String,
    pub(crate) is_angle: bool,
    pub(crate) meaning: String,
    /// `None` if the mechanism does not have it.
    pub(crate) function: Option<M::CoordinateFunction>,
}

/// A scene whose rows can be evaluated.
pub trait RowScene: AskedScene {
    /// The components of its vectors.
    const LAYOUT: Layout;

    /// Its model under all loads, with the determinacy of its reactions.
    type Rows: Clone + Sync;

    /// The evaluator of its rows.
    type Evaluator<'a>: RowEvaluator<Model = Self::Model>;

    /// The model of all rows.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled or a load does not fit it.
    fn rows(&self) -> Result<Self::Rows, StudyError>;

    /// The rows without loads, which may not fit.
    ///
    /// # Errors
    /// As of [`rows`](Self::rows).
    fn unloaded_rows(&self) -> Result<Self::Rows, StudyError> {
        self.rows()
    }

    /// The model among that.
    fn model_of(rows: &Self::Rows) -> &Self::Model;

    /// The rows without the parts that no requested column needs.
    fn pruned<'r>(&self, rows: &'r Self::Rows) -> Cow<'r, Self::Rows> {
        Cow::Borrowed(rows)
    }

    /// Which bodies are modelled; empty where all are.
    fn modelled(_: &Self::Rows) -> Vec<bool> {
        Vec::new()
    }

    /// The bodies that a quantity depends on: if they are not modelled, it has no value.
    fn bodies_of(&self, _: &Self::Rows, _: Quantity) -> Vec<BodyId> {
        Vec::new()
    }

    /// The evaluator of some columns, or without any of actuator forces and reactions, by the model of a chart; the trajectory ends where the `whole` mechanism does.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a body has no determined forces.
    fn evaluator<'a>(
        &'a self,
        whole: &'a Self::Rows,
        rows: &'a Self::Rows,
        analysis: Analysis,
        columns: &[Column],
    ) -> Result<Self::Evaluator<'a>, StudyError>;

    /// Why the position of a sample cannot be reached from that before, although the mechanism closes in both.
    fn unreachable(_: &Self::Model, _: [&TrajectorySample; 2]) -> Option<PositionError> {
        None
    }

    /// The error of a trajectory that ends early.
    fn explain_stop(&self, model: &Self::Model, stop: EarlyStop<'_>) -> StudyError;

    /// The prescribed motion and the sweep.
    fn prescribed(&self) -> (Option<&PrescribedMotion>, Option<&CoordinateSweep>);

    /// The followed range of the only actuator.
    fn default_limits(&self, model: &Self::Model) -> SweepLimits;

    /// The source of the coordinates along which an analysis is evaluated.
    fn followed(&self, model: &Self::Model) -> FollowedScene<'_> {
        let start = self.assembly_coordinates();
        let (prescribed, sweep) = self.prescribed();
        FollowedScene {
            file: self,
            prescribed,
            sweep,
            coordinates: (0..start.len()).filter_map(|i| self.actuator(i)).collect(),
            period: model.range().period(),
            default_limits: (start.len() == 1).then(|| self.default_limits(model)),
            start: start.to_vec(),
        }
    }

    /// The requests that determine the columns.
    fn requests(&self) -> ColumnRequests<'_>;

    /// The scene with its drives among the loads, if these have columns there.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where a drive does not fit.
    fn with_drive_loads(&self) -> Result<Cow<'_, Self>, StudyError> {
        Ok(Cow::Borrowed(self))
    }

    /// Advice on how to make an undetermined reaction determinate.
    const TO_DETERMINE: &'static str;

    /// The names of the reactions that redundant constraints leave open.
    fn open_reactions(&self, rows: &Self::Rows) -> Vec<String>;

    /// Whether it is a listed reaction, or a force or moment of a joint all of whose components are listed.
    fn is_of_listed_reaction(&self, rows: &Self::Rows, quantity: Quantity) -> bool;

    /// The links whose internal forces are requested.
    fn sectioned_links(&self) -> Vec<SectionedLink> {
        Vec::new()
    }

    /// By joint: its name, and those of its bodies.
    fn joint_names(&self) -> Vec<(&str, [&str; 2])>;

    /// The named coordinates.
    fn named_coordinates(&self) -> &[NamedCoordinate<CoordinateOf<Self>>];

    /// The travel of a joint.
    fn travel(joint: JointId) -> CoordinateOf<Self>;

    /// The coordinates that have columns: the named ones, and the travels of joints.
    fn measured(&self, model: &Self::Model) -> Vec<Measured<Self::Model>> {
        let named = self.named_coordinates().iter();
        let named = named.map(|named| (named.name.clone(), named.coordinate, String::new()));
        let joints = self.joint_names().into_iter().enumerate();
        let travels = joints.map(|(j, (joint, [one, two]))| {
            let meaning = format!(
                "position of the point of {two} from that of {one}, along the axis in {one}"
            );
            (format!("{joint}.travel"), Self::travel(JointId(j)), meaning)
        });
        let measured = named
            .chain(travels)
            .map(|(name, coordinate, meaning)| Measured {
                name,
                is_angle: <Self as MachineScene>::is_angle(coordinate),
                meaning,
                function: model.coordinate_function(coordinate).ok(),
            });
        measured.collect()
    }

    /// The meanings of an actuator's coordinate and of its force.
    fn actuator_meanings(&self, actuator: usize) -> [String; 2];

    /// Adds the columns of a body that only the plane has.
    fn add_body_columns(&self, _: &Self::Model, _: BodyId, _: &mut ColumnList) {}

    /// Adds the columns of joints and their reactions.
    fn add_joint_columns(&self, rows: &Self::Rows, list: &mut ColumnList);

    /// Adds the columns of loads and drives.
    fn add_load_columns(&self, model: &Self::Model, list: &mut ColumnList);
}
