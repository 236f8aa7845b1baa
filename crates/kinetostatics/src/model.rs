//! A mechanism with masses and loads, ready to be evaluated.

mod evaluated_state;
mod in_plane;
mod kinematic_state;
mod kinetostatics;
mod loaded_state;
mod machine_model;
mod revolutions;
pub mod stages;
mod varying_bodies;
mod workspace;

pub use evaluated_state::EvaluatedState;
pub use kinematic_state::KinematicState;
pub use loaded_state::{ForceState, LoadedState, StateWithLoads};
pub use machine_model::{MachineModel, ModelLoad};
pub use workspace::Workspace;

use crate::error::ModelError;
use crate::friction::{DependentLoad, required_reactions};
use crate::load::CompiledLoads;
use crate::mass::Mass;
use crate::pass::{GivenMotion, InverseDynamics, PassModel, ReactionSources};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{AssemblyConfiguration, BodyId, Mechanism, Plan, PositionError, Reaction};
use dwell_numerics::Scalar;
use std::sync::Arc;

/// The model of a mechanism with its masses and loads: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub(crate) mechanism: Arc<Mechanism>,
    pub(crate) pass_model: PassModel,
    /// The requested reactions, then the others on which friction and separating forces depend.
    reactions: Vec<Reaction>,
    /// How many reactions are requested.
    requested: usize,
    /// By body; the ground has none.
    pub(crate) masses: Vec<Mass>,
    pub(crate) loads: CompiledLoads,
    dependent_loads: Vec<DependentLoad>,
    /// By actuator: zero, the velocity and acceleration of statics.
    rest: Vec<f64>,
    /// The configuration in which it was assembled.
    assembly: AssemblyConfiguration,
}

impl Model {
    /// Compiles a mechanism with one mass for each body, for the requested reactions.
    ///
    /// # Errors
    /// [`ModelError`] when the mechanism cannot be assembled, the masses do not fit it, or it has no such reaction.
    pub fn new(
        mechanism: &Mechanism,
        masses: &[Mass],
        assembly: &AssemblyConfiguration,
        reactions: &[Reaction],
    ) -> Result<Self, ModelError> {
        if masses.len() != mechanism.bodies.len() || !masses.iter().all(Mass::is_valid) {
            return Err(ModelError::Masses);
        }
        require_reactions(mechanism, reactions)?;
        let plan = Plan::compile(mechanism, assembly)?;
        let pass_model = PassModel::new(mechanism, plan, masses);
        let mut masses = masses.to_vec();
        masses[mechanism.ground] = Mass::default();
        let mut model = Self {
            mechanism: Arc::new(mechanism.clone()),
            pass_model,
            reactions: Vec::new(),
            requested: 0,
            masses,
            loads: CompiledLoads::default(),
            dependent_loads: Vec::new(),
            rest: vec![0.0; mechanism.actuators.len()],
            assembly: assembly.clone(),
        };
        model.compile_reactions(reactions);
        Ok(model)
    }

    /// Compiles the requested reactions and those on which the magnitudes of the loads depend. A separating force
    /// does no work, so that only reactions depend on it. If none is computed, it stays zero.
    fn compile_reactions(&mut self, requested: &[Reaction]) {
        let depends_on_reactions =
            !requested.is_empty() || self.loads().iter().any(|load| load.friction().is_some());
        let required = self.loads().iter().filter(|_| depends_on_reactions);
        let required = required.flat_map(|load| required_reactions(&self.mechanism, load));
        let mut reactions = requested.to_vec();
        for reaction in required {
            if !reactions.contains(&reaction) {
                reactions.push(reaction);
            }
        }
        self.requested = requested.len();
        self.dependent_loads = DependentLoad::compile(&self.mechanism, self.loads(), &reactions);
        self.pass_model.reaction_sources =
            ReactionSources::compile(&self.mechanism, &self.pass_model.plan, &reactions);
        self.reactions = reactions;
    }

    /// This model without the groups on which no inertia, no load and none of the bodies `wanted`
    /// depends; they are [`Plan::pruned_groups`]. The results of the others are the same to the last bit. Nothing acts
    /// on the pruned groups, so their reactions are zero. The range is still that of the whole mechanism.
    #[must_use]
    pub fn pruned_for(self, wanted: &[BodyId]) -> Self {
        let loads = self.loads().iter();
        let loaded = loads.flat_map(|load| load.bodies(&self.mechanism));
        let needed: Vec<BodyId> = loaded.chain(wanted.iter().copied()).collect();
        self.retain_bodies(&needed)
    }

    /// The model of the inertia alone: no reaction, no load, and only the groups on which a body with inertia depends.
    pub(crate) fn inertia_only(&self) -> Self {
        let mut model = self.clone();
        model.loads = CompiledLoads::default();
        model.compile_reactions(&[]);
        model.retain_bodies(&[])
    }

    /// Prunes the groups on which neither inertia nor these bodies depend.
    fn retain_bodies(mut self, bodies: &[BodyId]) -> Self {
        let bodies = bodies.iter().map(|b| b.0);
        let inertial = self.pass_model.inertial_bodies.iter().map(|b| b.body);
        let inertial = inertial.chain(self.pass_model.varying_inertias.iter().map(|b| b.body));
        let needed = self.plan().groups_needed_by(inertial.chain(bodies));
        self.pass_model.plan = self.pass_model.plan.retain_groups(&needed);
        self
    }

    /// This model with these requested reactions instead of its own.
    ///
    /// # Errors
    /// [`ModelError::Reaction`] for a reaction that no joint of the mechanism has.
    pub fn with_reactions(mut self, reactions: &[Reaction]) -> Result<Self, ModelError> {
        require_reactions(&self.mechanism, reactions)?;
        self.compile_reactions(reactions);
        Ok(self)
    }

    /// This model without requested reactions.
    pub fn without_reactions(&self) -> Self {
        let mut model = self.clone();
        model.compile_reactions(&[]);
        model
    }

    /// This model prepared only for the responses to a unit of each load: friction is not solved, and no reactions are computed besides
    /// the requested ones.
    #[must_use]
    pub fn for_unit_loads(mut self) -> Self {
        self.reactions.truncate(self.requested);
        self.dependent_loads.clear();
        self.pass_model.reaction_sources =
            ReactionSources::compile(&self.mechanism, &self.pass_model.plan, &self.reactions);
        self
    }

    /// The mechanism it was compiled from.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The configuration in which it was assembled.
    pub(crate) fn assembly(&self) -> &AssemblyConfiguration {
        &self.assembly
    }

    /// The masses, by body.
    pub fn masses(&self) -> &[Mass] {
        &self.masses
    }

    /// The compiled plan of the mechanism.
    #[inline]
    pub fn plan(&self) -> &Plan {
        &self.pass_model.plan
    }

    /// The reactions that are computed: the requested ones in their order, then the others on which the magnitudes of
    /// the loads depend (friction, separating forces).
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// A buffer for the results of this model.
    pub fn result_buffer<T: Scalar>(&self) -> InverseDynamics<T> {
        InverseDynamics::buffer(self.plan().actuators(), self.reactions.len())
    }

    /// Inverse dynamics of inertia alone, without loads: the actuators' actions and the reactions for
    /// prescribed coordinates `q` (rad), speeds (rad/s) and accelerations (rad/s²): Jᵀ[λ; τ] = M ẍ + h.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    pub fn inverse_dynamics<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<(), PositionError> {
        let Workspace {
            pose, motion, pass, ..
        } = workspace;
        self.pass_model.plan.positions(q, pose)?;
        self.pass_model.plan.velocities(pose, q_dot, motion);
        self.pass_model.plan.accelerations(pose, q_ddot, motion);
        pass.evaluate(&self.pass_model, pose, GivenMotion(motion), None);
        result.read_from(&self.pass_model, pose, pass);
        Ok(())
    }

    /// Σ m v² + I ω² and Σ m v·a + I ω α of the given states of the bodies. At unit speed and zero acceleration of one
    /// coordinate these are m and ½m′.
    pub fn inertia_sums<T: Scalar>(&self, states: &BodyStates<T>) -> [T; 2] {
        let (mut energy, mut power) = (T::from_f64(0.0), T::from_f64(0.0));
        for [of_mass, of_inertia, power_of_mass, power_of_inertia] in self.inertia_terms(states) {
            energy += of_mass + of_inertia;
            power += power_of_mass + power_of_inertia;
        }
        [energy, power]
    }

    /// By body with inertia: m v², I ω², m v·a and I ω α; by body whose inertia varies: I ω² and I ω α + ½ I′ ω³.
    pub(crate) fn inertia_terms<T: Scalar>(
        &self,
        states: &BodyStates<T>,
    ) -> impl Iterator<Item = [T; 4]> {
        let varying = self.pass_model.varying_inertias.iter().map(|varying| {
            let state = states.body(BodyId(varying.body));
            let [inertia, half_slope] = varying.at(state.rotation);
            let (w, zero) = (state.angular_velocity, T::from_f64(0.0));
            let moment = inertia * state.angular_acceleration + half_slope * w * w;
            [zero, inertia * w * w, zero, moment * w]
        });
        let constant = self.pass_model.inertial_bodies.iter().map(|body| {
            let id = BodyId(body.body);
            let center = states.point(id, self.masses[id.0].center);
            let state = states.body(id);
            let (v, w) = (center.velocity, state.angular_velocity);
            let (mass, inertia) = (T::from_f64(body.mass), T::from_f64(body.inertia));
            [
                mass * v.dot(v),
                inertia * w * w,
                mass * v.dot(center.acceleration),
                inertia * w * state.angular_acceleration,
            ]
        });
        constant.chain(varying)
    }
}

/// Refuses a reaction that no joint of the mechanism has.
fn require_reactions(mechanism: &Mechanism, reactions: &[Reaction]) -> Result<(), ModelError> {
    let unknown = |r: &&Reaction| !mechanism.components(r.joint).contains(&r.component);
    let found = reactions.iter().find(unknown);
    found.map_or(Ok(()), |reaction| Err(ModelError::Reaction(*reaction)))
}
