//! A mechanism in space with its masses and requested reactions, and the passes over it.

use super::compiled_loads::CompiledLoads;
use super::friction::JointFriction;
use super::in_plane::{InPlane, InPlaneWorkspace};
use super::mass::Mass;
use super::on_fit::FitWorkspace;
use super::pass::{self, CompiledReaction, PassModel};
use super::surface_friction::SurfaceFriction;
use crate::error::PositionResult;
use crate::friction::FrictionWorkspace;
use crate::load::SignalWorkspace;
use crate::pass::InverseDynamics;
use dwell_geometry::space::{Assembly, Forces, Joint, Mechanism, Plan, Pose, PoseMotion, Wrench};
use dwell_geometry::{AssemblyError, BodyId, JointId};
use dwell_numerics::Scalar;
use std::sync::Arc;
use thiserror::Error;

/// Axes in which a component is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axes {
    /// The axes of the ground.
    Ground,
    /// The axes of the joint on its first body: normal, axis × normal, axis.
    Joint,
    /// The line from the joint's first point to its second, of a distance or a coupling of one: the component number 0 is along it.
    Line,
}

/// A component of a reaction, by its number: 0, 1, 2 for x, y, z. The moment is about the joint's point on the second body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Component {
    /// A component of the force, N.
    Force(Axes, usize),
    /// A component of the moment, N·m.
    Moment(Axes, usize),
}

/// A component of the action of a joint's first body on the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Reaction {
    /// The joint.
    pub joint: JointId,
    /// The component.
    pub component: Component,
}

/// Why a model in space cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The mechanism cannot be assembled.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// The number of masses differs from that of the bodies, or a mass is invalid.
    #[error("the masses do not fit the bodies")]
    Masses,
    /// A reaction of a joint or component that does not exist.
    #[error("the mechanism has no such reaction: {0:?}")]
    Reaction(Reaction),
    /// A body that can turn between its two balls, and whose inertia couples that with the motion.
    #[error(
        "body {} rotates freely about the line through its spherical joints, and its mass couples this rotation with the motion: replace one \
         spherical joint by a universal joint, or give the body a centre of mass on that line and equal moments of inertia about the axes normal to it", body.0
    )]
    UnbalancedRod {
        /// The body.
        body: BodyId,
    },
}

/// A mechanism in space with its masses: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    mechanism: Arc<Mechanism>,
    pub(super) pass_model: PassModel,
    /// How many reactions are requested.
    requested: usize,
    pub(super) loads: CompiledLoads,
    pub(super) frictions: Vec<JointFriction>,
    /// The frictions of cylindrical joints that hold at rest.
    pub(super) surface_frictions: Vec<SurfaceFriction>,
    /// By actuator: its coordinate at assembly, rad or m.
    pub(super) start: Vec<f64>,
    /// The planar model for its reduced coefficients, if one was searched for and exists.
    pub(super) in_plane: Option<Arc<InPlane>>,
}

/// The memory of one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace<T = f64> {
    pub(super) pose: Pose<T>,
    pub(super) forces: Forces<T>,
    /// The forces of both unit passes.
    pub(super) unit_forces: Forces<T, 2>,
    /// Speeds or accelerations of the actuators.
    pub(super) rates: Vec<T>,
    /// A motion at unit velocity of one coordinate.
    pub(super) virtual_motion: PoseMotion<T>,
    /// By load: its magnitude.
    pub(super) magnitudes: Vec<T>,
    /// By body: the wrenches of all loads, about the origin of its evaluation frame.
    pub(super) load_wrenches: Vec<Wrench<T>>,
    pub(super) signals: SignalWorkspace<T>,
    pub(super) friction_workspace: FrictionWorkspace<T>,
    /// By friction: the response to one unit of it.
    pub(super) friction_responses: Vec<InverseDynamics<T>>,
    pub(super) on_fit: FitWorkspace<T>,
    /// By friction of a surface that holds at rest: in which direction it slides, along the axis and around it.
    pub(super) surface_directions: Vec<[T; 2]>,
    pub(super) in_plane: Option<InPlaneWorkspace<T>>,
}

impl Model {
    /// Compiles a mechanism with one mass for each body, for the requested reactions.
    ///
    /// # Errors
    /// [`ModelError`] when the mechanism cannot be assembled, or masses or reactions do not fit it.
    pub fn new(
        mechanism: &Mechanism,
        masses: &[Mass],
        assembly: &Assembly,
        reactions: &[Reaction],
    ) -> Result<Self, ModelError> {
        Self::with_plan(mechanism, masses, assembly, reactions, Plan::compile)
    }

    /// As [`Model::new`], but solves planar loops as loops in space, too. Tests compare with it.
    ///
    /// # Errors
    /// As [`Model::new`].
    pub fn without_planes(
        mechanism: &Mechanism,
        masses: &[Mass],
        assembly: &Assembly,
        reactions: &[Reaction],
    ) -> Result<Self, ModelError> {
        let compile = Plan::compile_without_planes;
        Self::with_plan(mechanism, masses, assembly, reactions, compile)
    }

    fn with_plan(
        mechanism: &Mechanism,
        masses: &[Mass],
        assembly: &Assembly,
        reactions: &[Reaction],
        compile: fn(&Mechanism, &Assembly) -> Result<Plan, AssemblyError>,
    ) -> Result<Self, ModelError> {
        if masses.len() != mechanism.bodies.len() || !masses.iter().all(Mass::is_valid) {
            return Err(ModelError::Masses);
        }
        let plan = compile(mechanism, assembly)?;
        let coupled = plan
            .mobility()
            .idle
            .iter()
            .find(|idle| masses[idle.body.0].is_unbalanced_about(idle.point, idle.axis));
        if let Some(idle) = coupled {
            return Err(ModelError::UnbalancedRod { body: idle.body });
        }
        let mut pass_model = PassModel::new(mechanism, plan, masses);
        let compiled = |reaction| compile_reaction(mechanism, &pass_model.plan, reaction);
        let reactions = reactions.iter().map(compiled);
        let reactions = reactions.collect::<Result<Vec<_>, _>>()?;
        let requested = reactions.len();
        pass_model.reactions = reactions;
        Ok(Self {
            mechanism: Arc::new(mechanism.clone()),
            pass_model,
            requested,
            loads: CompiledLoads::default(),
            frictions: Vec::new(),
            surface_frictions: Vec::new(),
            start: assembly.q.clone(),
            in_plane: None,
        })
    }

    /// The mechanism it was compiled from.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// By body: its mass in the evaluation frame.
    pub(super) fn inner_masses(&self) -> &[Mass] {
        &self.pass_model.masses
    }

    /// The bodies that have mass or inertia.
    pub(super) fn inertial(&self) -> &[usize] {
        &self.pass_model.inertial
    }

    /// The compiled mechanism.
    pub fn plan(&self) -> &Plan {
        &self.pass_model.plan
    }

    /// The reactions that are computed: the requested ones in their order, then the others on which friction depends.
    pub fn reactions(&self) -> impl ExactSizeIterator<Item = Reaction> + '_ {
        self.pass_model
            .reactions
            .iter()
            .map(|(reaction, _)| *reaction)
    }

    /// The compiled reactions, with the axes of those that are in the axes of their joints.
    pub(super) fn compiled_reactions(&self) -> &[CompiledReaction] {
        &self.pass_model.reactions
    }

    /// The requested reactions.
    pub(super) fn requested_reactions(&self) -> impl ExactSizeIterator<Item = Reaction> + '_ {
        self.reactions().take(self.requested)
    }

    /// Computes these reactions, the requested ones first, on which these frictions depend.
    pub(super) fn set_reactions(&mut self, all: &[Reaction], frictions: Vec<JointFriction>) {
        let (mechanism, plan) = (&self.mechanism, &self.pass_model.plan);
        let compile = |reaction| compile_reaction(mechanism, plan, reaction).ok();
        self.pass_model.reactions = all.iter().filter_map(compile).collect();
        self.frictions = frictions;
        self.in_plane = None;
    }

    /// This model without requested reactions.
    #[must_use]
    pub fn without_reactions(&self) -> Self {
        let mut model = Self {
            requested: 0,
            ..self.clone()
        };
        // They fitted the joints, and depended on reactions that are determined.
        let _ = model.compile_frictions();
        model
    }

    /// This model prepared only for the responses to a unit of each load: friction is not solved, and no reactions are computed
    /// besides the requested ones.
    #[must_use]
    pub fn for_unit_loads(mut self) -> Self {
        self.pass_model.reactions.truncate(self.requested);
        self.frictions.clear();
        self.in_plane = None;
        self
    }

    /// The model of the inertia alone, without reactions and loads.
    pub(super) fn inertia_only(&self) -> Self {
        let mut model = Self {
            requested: 0,
            loads: CompiledLoads::default(),
            frictions: Vec::new(),
            surface_frictions: Vec::new(),
            ..self.clone()
        };
        model.pass_model.reactions.clear();
        model.reduced_in_plane()
    }

    /// This model, reduced by its planar equivalent if it has one.
    pub(super) fn reduced_in_plane(mut self) -> Self {
        self.in_plane = None;
        self.in_plane = InPlane::new(&self).map(Arc::new);
        self
    }

    /// Memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> Workspace<T> {
        Workspace {
            pose: self.pass_model.plan.pose(),
            forces: self.pass_model.plan.forces(),
            unit_forces: self.pass_model.plan.forces(),
            rates: vec![T::from_f64(0.0); self.pass_model.plan.actuators()],
            virtual_motion: self.pass_model.plan.pose_motion(),
            magnitudes: vec![T::from_f64(0.0); self.loads.kinds.len()],
            load_wrenches: vec![Wrench::default(); self.pass_model.masses.len()],
            signals: SignalWorkspace::new(self.loads.max_signals()),
            friction_workspace: FrictionWorkspace::new(self.frictions.len()),
            friction_responses: vec![self.result_buffer(); self.frictions.len()],
            on_fit: FitWorkspace::default(),
            surface_directions: vec![[T::from_f64(0.0); 2]; self.surface_frictions.len()],
            in_plane: self.in_plane.as_ref().map(|model| model.workspace()),
        }
    }

    /// By reaction: whether the loads determine it at `q` (rad or m). Redundant constraints leave others undetermined;
    /// their values are those of the least multipliers and have no meaning.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    pub fn determined(&self, q: &[f64], workspace: &mut Workspace) -> PositionResult<Vec<bool>> {
        let Workspace { pose, forces, .. } = workspace;
        self.pass_model.plan.positions(q, pose)?;
        let mut determined = vec![true; self.pass_model.reactions.len()];
        for stress in self.pass_model.plan.self_stresses(pose) {
            let largest = stress.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            self.pass_model.plan.stress(&stress, pose, forces);
            self.pass_model.read_all(pose, forces, |k, [part]| {
                determined[k] &= part.abs() < 1e-7 * largest;
            });
        }
        Ok(determined)
    }

    /// By reaction: whether the loads determine it at assembly and, with one actuator, elsewhere in its range. A symmetric assembly
    /// may hide an undetermined reaction.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at the start.
    pub fn determined_throughout(&self) -> PositionResult<Vec<bool>> {
        let mut workspace = self.workspace();
        let mut determined = self.determined(&self.start, &mut workspace)?;
        for q in self.elsewhere() {
            if let Ok(there) = self.determined(&[q], &mut workspace) {
                (determined.iter_mut().zip(there)).for_each(|(all, here)| *all &= here);
            }
        }
        Ok(determined)
    }

    /// Other coordinates of a mechanism with one actuator, within its range.
    fn elsewhere(&self) -> Vec<f64> {
        let [start] = self.start[..] else {
            return Vec::new();
        };
        let step = match self.pass_model.plan.range().limits() {
            None => 1.0,
            Some((from, to)) => 0.2 * (to - from),
        };
        [-1.13, -0.41, 0.37, 1.21]
            .map(|parts| start + parts * step)
            .to_vec()
    }

    /// A buffer for the results of this model.
    pub fn result_buffer<T: Scalar>(&self) -> InverseDynamics<T> {
        InverseDynamics::buffer(
            self.pass_model.plan.actuators(),
            self.pass_model.reactions.len(),
        )
    }

    /// The actuator forces and reactions that inertia alone requires at coordinates (rad or m), velocities and
    /// accelerations.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose.
    pub fn inverse_dynamics<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> PositionResult {
        self.pass_model.plan.positions(q, &mut workspace.pose)?;
        self.pass_model.plan.velocities(q_dot, &mut workspace.pose);
        self.pass_model
            .plan
            .accelerations(q_ddot, &mut workspace.pose);
        self.pass_model
            .require_inertia(&workspace.pose, &mut workspace.forces);
        self.balance(workspace, result);
        Ok(())
    }

    /// The actuator forces and reactions from the required wrenches.
    pub(super) fn balance<T: Scalar>(
        &self,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        let Workspace { pose, forces, .. } = workspace;
        self.pass_model.balance(pose, forces, result);
    }
}

/// A reaction in the frames of a plan.
fn compile_reaction(
    mechanism: &Mechanism,
    plan: &Plan,
    reaction: &Reaction,
) -> Result<CompiledReaction, ModelError> {
    let (Component::Force(_, k) | Component::Moment(_, k)) = reaction.component;
    let is_on_line = reaction.component == Component::Force(Axes::Line, 0);
    let is_line = |joint: &&Joint| {
        !matches!(
            reaction.component,
            Component::Force(Axes::Line, _) | Component::Moment(Axes::Line, _)
        ) || is_on_line && joint.kind.acts_along_line()
    };
    let joint = mechanism.joints.get(reaction.joint.0).filter(|_| k < 3);
    let joint = joint.filter(is_line);
    let joint = joint.ok_or(ModelError::Reaction(*reaction))?;
    Ok(pass::compile_reaction(
        *reaction,
        mechanism,
        &joint.numbers(),
        plan,
    ))
}
