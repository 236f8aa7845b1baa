//! An assembled mechanism that a program asks at single positions, in the plane or in space.

use crate::explain::StudyError;
use crate::machines::MachineScene;
use dwell_dynamics::{DynamicsError, Machine};
use dwell_geometry::PositionError;
use dwell_kinetostatics::table::TableModel;
use dwell_kinetostatics::{Batch, ExactModel, InverseDynamics, ReducedModel as _};
use rayon::prelude::*;
use std::fmt::Debug;

/// Positions, velocities and accelerations of all bodies, in the axes of the ground. In the plane the third number of a vector is zero, and
/// bodies turn about the third axis.
pub trait BodyStates: Debug + Send + Sync {
    /// Position (m), velocity (m/s) and acceleration (m/s²) of a point `at`, m in the frame of its body.
    fn point(&self, body: usize, at: [f64; 3]) -> [[f64; 3]; 3];

    /// The axes of a body's frame.
    fn axes(&self, body: usize) -> [[f64; 3]; 3];

    /// Angular velocity (rad/s) and acceleration (rad/s²) of a body.
    fn turning(&self, body: usize) -> [[f64; 3]; 2];

    /// The angle of a body in the plane, rad: within half a revolution, or with whole revolutions where actuators turn it. None in space.
    fn angle(&self, body: usize) -> Option<f64>;
}

/// A coordinate with its rate and acceleration (rad or m, per s, per s²), or why it cannot be evaluated.
pub type CoordinateValue = Result<[f64; 3], &'static str>;

/// The states of all bodies, and the coordinates in the order of their names.
pub type FoundStates = (Box<dyn BodyStates>, Vec<CoordinateValue>);

/// Points of a body with their names, m in its frame.
pub type NamedPoints<'a> = Vec<(&'a str, [f64; 3])>;

/// The model of a mechanism under its loads.
#[derive(Debug)]
pub struct AssembledModel<S: MachineScene> {
    /// The model.
    pub model: S::Model,
    /// All reactions that can be requested, each with its index among those of the model; `None` if redundant constraints leave it
    /// undetermined.
    pub reactions: Vec<(S::Reaction, Option<usize>)>,
}

/// The reduced model of a mechanism with some reactions.
#[derive(Debug)]
pub struct UnitModels<M> {
    /// For m, ½m′, a and b.
    pub exact: ExactModel<M>,
    /// For w and c: none without loads.
    pub loaded: Option<M>,
}

/// A scene whose assembled mechanism answers single queries.
pub trait AskedScene: MachineScene<Model: TableModel> + Clone + Send + Sync + 'static {
    /// 2 in the plane, 3 in space.
    const DIMENSION: usize;

    /// Assembles it.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be assembled, or a load does not fit it.
    fn assembled(&self) -> Result<AssembledModel<Self>, StudyError>;

    /// Its reduced model.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be assembled, has not exactly one actuator, or a load does not fit it.
    fn unit_models(
        &self,
        reactions: &[Self::Reaction],
    ) -> Result<UnitModels<Self::Model>, StudyError>;

    /// m, ½m′, a and b at many coordinates, rad or m, on all threads.
    fn inertial_batch(exact: &ExactModel<Self::Model>, q: &[f64], batch: &mut Batch) {
        let evaluate = |workspace: &mut _, (index, &q): (usize, &f64)| {
            let mut at = exact.coefficient_buffer();
            let found = exact.coefficients(q, workspace, &mut at);
            (at, found.err().map(|error| (index, error)))
        };
        let all = q.par_iter().enumerate();
        let all: Vec<_> = all.map_init(|| exact.workspace(), evaluate).collect();
        for (at, error) in all {
            batch.m.push(at.m);
            batch.half_dm.push(at.half_dm);
            batch.a.extend(at.a);
            batch.b.extend(at.b);
            batch.errors.extend(error);
        }
    }

    /// The machine of its free motion, and the initial state of that.
    ///
    /// # Errors
    /// [`StudyError`] where the scene has no motion, or its machine cannot be built.
    fn motion_machine(&self) -> Result<(Machine<Self::Model>, Vec<f64>), StudyError>;

    /// Bodies with their points, m in the frame of the body.
    fn named_points(&self) -> Vec<(&str, NamedPoints<'_>)>;

    /// The names of the coordinates in their order: those of the actuators first.
    fn coordinate_names(&self) -> Vec<&str>;

    /// The names of the loads, without the drives.
    fn load_names(&self) -> Vec<&str>;

    /// By actuator: its coordinate at assembly, rad or m.
    fn assembly_coordinates(&self) -> &[f64];

    /// Positions of points of bodies at many coordinates, m: by position, then by point. `q` has the coordinates of all actuators (rad or
    /// m) of one position after another.
    ///
    /// # Errors
    /// [`PositionError`] for the first position that the mechanism cannot reach.
    fn paths(
        &self,
        model: &Self::Model,
        points: &[(usize, [f64; 3])],
        q: &[f64],
    ) -> Result<Vec<[f64; 3]>, PositionError>;

    /// The joint of a reaction.
    fn joint_of(&self, reaction: Self::Reaction) -> &str;

    /// The states of all bodies at coordinates, their velocities and accelerations (rad or m, per s, per s²).
    ///
    /// # Errors
    /// [`DynamicsError`] if there is no position.
    fn body_states(
        &self,
        model: &Self::Model,
        motion: [&[f64]; 3],
    ) -> Result<FoundStates, DynamicsError>;

    /// The states with the forces under all loads at time `t` (s).
    ///
    /// # Errors
    /// [`DynamicsError`] if there is no position, a load has no value, or friction locks the mechanism.
    fn loaded_states(
        &self,
        model: &Self::Model,
        t: f64,
        motion: [&[f64]; 3],
        forces: &mut InverseDynamics<f64>,
    ) -> Result<FoundStates, DynamicsError>;
}
