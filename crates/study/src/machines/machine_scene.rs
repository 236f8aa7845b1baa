//! The trait of a scene for the analyses of its machine, in the plane or in space.

use crate::explain::{NamedScene, StudyError};
use dwell_dynamics::{DynamicsError, Machine, MovingModel, NonconservativeSource};
use dwell_findings::Column;
use dwell_kinetostatics::{Drive, MachineModel};
use dwell_laws::Law;
use dwell_page::Drawing;
use dwell_scene::FreeMotionSpec;

/// The description of a coordinate of a scene's machine.
pub type CoordinateOf<S> = <<S as MachineScene>::Model as MachineModel>::Coordinate;

/// Where a motion starts, by actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionStart {
    /// Coordinates, rad or m.
    pub coordinates: Vec<f64>,
    /// Speeds, rad/s or m/s.
    pub velocities: Vec<f64>,
    /// The laws of prescribed coordinates; `None` if it is free.
    pub laws: Vec<Option<Law>>,
}

impl MotionStart {
    /// The start of the motion, if there is one. Otherwise every actuator is free, at rest in the assembly
    /// configuration.
    pub(crate) fn new<C, R>(motion: Option<&FreeMotionSpec<C, R>>, assembly: &[f64]) -> Self {
        match motion {
            Some(spec) => Self {
                coordinates: spec.initial_coordinates.clone(),
                velocities: spec.initial_velocities.clone(),
                laws: spec.laws.clone(),
            },
            None => Self {
                coordinates: assembly.to_vec(),
                velocities: vec![0.0; assembly.len()],
                laws: vec![None; assembly.len()],
            },
        }
    }
}

/// A scene with a machine.
pub trait MachineScene: NamedScene {
    /// The model that moves.
    type Model: MovingModel;
    /// A component of a reaction.
    type Reaction: std::fmt::Debug + Copy + PartialEq + Send + Sync + 'static;

    /// The start of its motion.
    fn motion_start(&self) -> MotionStart;

    /// Its machine, with some reactions and those that friction needs.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be assembled, or a load or a drive does not fit it.
    fn machine(&self, reactions: &[Self::Reaction]) -> Result<Machine<Self::Model>, StudyError>;

    /// The requested reactions: those that the loads determine, and the others.
    ///
    /// # Errors
    /// [`StudyError`] if the mechanism has no pose.
    fn sorted_reactions(&self, model: &Self::Model)
    -> Result<[Vec<Self::Reaction>; 2], StudyError>;

    /// Names and units (of a force or a moment) of the reactions of a model.
    fn reaction_units(&self, model: &Self::Model) -> Vec<(String, &'static str)>;

    /// The determinate requested reactions as columns.
    fn reaction_columns(&self, model: &Self::Model) -> Vec<Column> {
        let all = self.reaction_units(model).into_iter();
        all.map(|(name, unit)| Column::new(name, unit)).collect()
    }

    /// The name of a coordinate; empty if it has none.
    fn name_of_coordinate(&self, coordinate: CoordinateOf<Self>) -> String;

    /// The name of a reaction.
    fn name_of_reaction(&self, reaction: Self::Reaction) -> String;

    /// Its drives.
    fn drives(&self) -> &[Drive<CoordinateOf<Self>>];

    /// Whether a coordinate is an angle; otherwise it is a length.
    fn is_angle(coordinate: CoordinateOf<Self>) -> bool;

    /// The name of a source of work.
    fn name_of_source(&self, source: NonconservativeSource) -> &str {
        match source {
            NonconservativeSource::Load(load) => self.load_name(load).unwrap_or_default(),
            NonconservativeSource::Loads => "loads",
            NonconservativeSource::Drive(drive) => &self.drives()[drive].name,
            NonconservativeSource::Stop(stop) => &self.stops()[stop].name,
            NonconservativeSource::Prescribed(i) => self.actuator(i).unwrap_or_default().0,
        }
    }

    /// Rejects requested columns that no analysis has.
    ///
    /// # Errors
    /// [`StudyError::Scene`] at the first of them.
    fn reject_unknown_columns(&self) -> Result<(), StudyError>;

    /// The mechanism at values of its only coordinate, rad or m, one for each row of a page; `None` if it has several, or a
    /// position cannot be reached.
    fn drawing_along(&self, coordinate: &[f64]) -> Option<Drawing>;

    /// Lines about the assembly configuration; mostly none.
    fn assembly_note(&self, model: &Self::Model) -> String;

    /// An error of its motion in the names of the scene.
    fn explain(&self, model: &Self::Model, error: &DynamicsError) -> StudyError;
}
