//! A mechanism with masses, ready to be evaluated: inertia forces, the actuators' actions, and
//! the reactions that were asked for.

use crate::acts::Loads;
use crate::friction::Rub;
use crate::kinetostatics::Loaded;
use crate::mass::Mass;
use crate::reactions::Sources;
use crate::runs::{Prescribed, Runs};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{
    AssemblyError, BodyId, Mechanism, Motion, PlaceError, Plan, Pose, Reaction, Scalar, Start, Vec2,
};
use thiserror::Error;

/// The model of a mechanism: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub(crate) plan: Plan,
    pub(crate) massive: Vec<Massive>,
    /// The bodies whose roots move and that carry mass, each after the one that carries it.
    pub(crate) links: Vec<Link>,
    /// By frame: moment of inertia of its bodies about their roots, kg m².
    pub(crate) inertia: Vec<f64>,
    pub(crate) sources: Sources,
    reactions: Vec<Reaction>,
    /// By body; the ground has none.
    pub(crate) masses: Vec<Mass>,
    pub(crate) loads: Loads,
    pub(crate) rubs: Vec<Rub>,
    /// Where it was put together.
    pub(crate) start: Start,
}

/// A carried body that has inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Massive {
    pub(crate) carried: usize,
    pub(crate) body: usize,
    pub(crate) frame: usize,
    pub(crate) mass: f64,
    /// About the centre of mass, and about the body's root, kg m².
    pub(crate) inertia: f64,
    pub(crate) about_root: f64,
    /// From the body's root to its centre of mass, in its frame, and its first moment, kg m; none
    /// where root and centre coincide.
    pub(crate) arm: Option<Vec2>,
    pub(crate) first: Option<Vec2>,
    /// Whether its root is fixed to the ground.
    pub(crate) at_rest: bool,
}

/// A body whose root moves, with what inertia forces need of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub(crate) carried: usize,
    pub(crate) frame: usize,
    /// The link that carries it; none where that root is fixed to the ground.
    pub(crate) parent: Option<usize>,
    /// The arm that carries it, with its frame.
    pub(crate) arm: Option<(usize, usize)>,
    /// The slide that carries it, and the direction of its travel.
    pub(crate) slide: Option<(usize, usize)>,
    /// Of the body alone, kg.
    pub(crate) mass: f64,
    /// First moment of the body about its root, in its frame, kg m; none if zero.
    pub(crate) first: Option<Vec2>,
}

/// Why a model cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The mechanism cannot be put together.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// A reaction that no joint of the mechanism has.
    #[error("the mechanism has no such reaction: {0:?}")]
    Reaction(Reaction),
    /// Not one mass for each body, or one that is negative or not finite.
    #[error("the masses do not fit the bodies")]
    Masses,
}

/// Working memory for evaluations of a model in one thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Workspace<T> {
    /// The last pose.
    pub pose: Pose<T>,
    /// The last motion.
    pub motion: Motion<T>,
    pub(crate) unit: Runs<T, 2>,
    pub(crate) run: Runs<T, 1>,
    pub(crate) loaded: Loaded<T>,
}

/// The actuators' actions and the requested reactions in one state of motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Actions<T> {
    /// By actuator: its action on its second body, N·m.
    pub tau: Vec<T>,
    /// By requested reaction: N or N·m.
    pub reactions: Vec<T>,
}

impl<T: Scalar> Actions<T> {
    /// Reads them off a run.
    pub(crate) fn take(&mut self, model: &Model, pose: &Pose<T>, run: &Runs<T, 1>) {
        for (i, tau) in self.tau.iter_mut().enumerate() {
            *tau = run.tau(model, i)[0];
        }
        for (k, value) in self.reactions.iter_mut().enumerate() {
            *value = run.reaction(model, pose, k)[0];
        }
    }
}

impl Model {
    /// Compiles a mechanism with one mass for each body, for the reactions asked for.
    ///
    /// # Errors
    /// [`ModelError`] when the mechanism cannot be put together or the masses do not fit.
    pub fn new(
        mechanism: &Mechanism,
        masses: &[Mass],
        start: &Start,
        reactions: &[Reaction],
    ) -> Result<Self, ModelError> {
        let sound = |m: &Mass| {
            m.mass >= 0.0
                && m.inertia >= 0.0
                && m.mass.is_finite()
                && m.inertia.is_finite()
                && m.center.is_finite()
        };
        if masses.len() != mechanism.bodies.len() || !masses.iter().all(sound) {
            return Err(ModelError::Masses);
        }
        known(mechanism, reactions)?;
        let plan = Plan::compile(mechanism, start)?;
        let moves = moving(&plan);
        let massive: Vec<Massive> = plan
            .carried()
            .iter()
            .enumerate()
            .filter_map(|(i, carried)| {
                let Mass {
                    mass,
                    inertia,
                    center,
                } = masses.get(carried.body).copied().unwrap_or_default();
                let arm = plan.tree().arm(plan.frames(), carried.body, center).local;
                let arm = (arm != Vec2::ZERO && mass > 0.0).then_some(arm);
                (mass > 0.0 || inertia > 0.0).then(|| Massive {
                    carried: i,
                    body: carried.body,
                    frame: carried.frame,
                    mass,
                    inertia,
                    about_root: inertia + arm.map_or(0.0, |arm| mass * arm.dot(arm)),
                    arm,
                    first: arm.map(|arm| arm * mass),
                    at_rest: !moves[i],
                })
            })
            .collect();
        let mut inertia = vec![0.0; plan.frames().frames.len()];
        for body in &massive {
            inertia[body.frame] += body.about_root;
        }
        let links = links(&plan, &moves, &massive);
        let sources = Sources::find(mechanism, &plan, reactions);
        let mut masses = masses.to_vec();
        masses[mechanism.ground] = Mass::default();
        Ok(Self {
            plan,
            massive,
            links,
            inertia,
            sources,
            reactions: reactions.to_vec(),
            masses,
            loads: Loads::default(),
            rubs: Vec::new(),
            start: start.clone(),
        })
    }

    /// The same model without the groups that no inertia, no load and none of the bodies `wanted`
    /// needs; [`Plan::skipped`] tells them. What remains is the same to the last bit: nothing acts on
    /// the groups left out, so their reactions are zero. The range stays that of the whole mechanism.
    #[must_use]
    pub fn only_for(self, mechanism: &Mechanism, wanted: &[BodyId]) -> Self {
        let loads = self.loads().iter().flat_map(|load| load.bodies(mechanism));
        let asked: Vec<BodyId> = loads.chain(wanted.iter().copied()).collect();
        self.keep(&asked)
    }

    /// The same mechanism for its inertia alone: no reaction, no load, and only the groups that
    /// place something with inertia.
    pub(crate) fn inertia_alone(&self) -> Self {
        let mut bare = self.without_reactions();
        bare.loads = Loads::default();
        bare.rubs.clear();
        bare.keep(&[])
    }

    /// Leaves out the groups that neither inertia nor these bodies need.
    fn keep(mut self, bodies: &[BodyId]) -> Self {
        let massive = self.massive.iter().map(|m| m.body);
        let needed = self
            .plan
            .needed_for(massive.chain(bodies.iter().map(|b| b.0)));
        self.plan = self.plan.only(&needed);
        self
    }

    /// The same mechanism for these reactions instead of those it was made for.
    ///
    /// # Errors
    /// [`ModelError::Reaction`] for a reaction that no joint of the mechanism has.
    pub fn for_reactions(
        mut self,
        mechanism: &Mechanism,
        reactions: &[Reaction],
    ) -> Result<Self, ModelError> {
        known(mechanism, reactions)?;
        self.sources = Sources::find(mechanism, &self.plan, reactions);
        self.reactions = reactions.to_vec();
        Ok(self)
    }

    /// The same mechanism with no reaction asked for.
    pub fn without_reactions(&self) -> Self {
        let mut bare = self.clone();
        bare.sources.clear();
        bare.reactions.clear();
        bare
    }

    /// The compiled mechanism.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The reactions that are computed, in their order.
    pub fn reactions(&self) -> &[Reaction] {
        &self.reactions
    }

    /// Working memory for one thread.
    pub fn workspace<T: Scalar>(&self) -> Workspace<T> {
        Workspace {
            pose: self.plan.pose(),
            motion: self.plan.motion(),
            unit: Runs::new(&self.plan, self.links.len()),
            run: Runs::new(&self.plan, self.links.len()),
            loaded: Loaded::new(self),
        }
    }

    /// Room for the actions of this model.
    pub fn actions<T: Scalar>(&self) -> Actions<T> {
        Actions {
            tau: vec![T::lift(0.0); self.plan.actuators()],
            reactions: vec![T::lift(0.0); self.reactions.len()],
        }
    }

    /// Kinetostatics of inertia alone, without the loads: the actuators' actions and the reactions for
    /// prescribed coordinates `q` (rad), speeds (rad/s) and accelerations (rad/s²): Jᵀ[λ; τ] = M ẍ + h.
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    pub fn act<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        work: &mut Workspace<T>,
        actions: &mut Actions<T>,
    ) -> Result<(), PlaceError> {
        let Workspace {
            pose, motion, run, ..
        } = work;
        self.plan.place(q, pose)?;
        self.plan.speeds(pose, q_dot, motion);
        self.plan.accelerations(pose, q_ddot, motion);
        run.evaluate(self, pose, Prescribed(motion));
        actions.take(self, pose, run);
        Ok(())
    }

    /// Kinetic energy ½ Σ m v² + I ω² at the state last entered, J.
    pub fn kinetic(&self, work: &Workspace<f64>) -> f64 {
        let states = work.states();
        let energy = |body: &Massive| {
            let id = BodyId(body.body);
            let velocity = states.point(id, self.masses[id.0].center).velocity;
            let spin = states.body(id).spin;
            0.5 * (body.mass * velocity.dot(velocity) + body.inertia * spin * spin)
        };
        self.massive.iter().map(energy).sum()
    }

    /// Twice the kinetic energy at unit speed, Σ m v² + I ω², and half its derivative by power,
    /// Σ m v·a + I ω α, both at the pose, speeds and accelerations in `work`: another way to m
    /// and ½m′, with no reaction in it.
    pub fn energy_and_power(&self, work: &Workspace<f64>) -> (f64, f64) {
        let mut states = BodyStates::new(&self.plan);
        states.fill(&self.plan, &work.pose, &work.motion);
        let (mut energy, mut power) = (0.0, 0.0);
        for body in &self.massive {
            let id = BodyId(body.body);
            let center = states.point(id, self.masses[id.0].center);
            let (w, a) = (states.body(id).spin, states.body(id).spin_rate);
            energy += body.mass * center.velocity.dot(center.velocity) + body.inertia * w * w;
            power += body.mass * center.velocity.dot(center.acceleration) + body.inertia * w * a;
        }
        (energy, power)
    }
}

/// Refuses a reaction that no joint of the mechanism has.
fn known(mechanism: &Mechanism, reactions: &[Reaction]) -> Result<(), ModelError> {
    let unknown = |r: &&Reaction| !mechanism.components(r.joint).contains(&r.component);
    match reactions.iter().find(unknown) {
        Some(reaction) => Err(ModelError::Reaction(*reaction)),
        None => Ok(()),
    }
}

/// By carried body: whether its root moves.
fn moving(plan: &Plan) -> Vec<bool> {
    let mut moves: Vec<bool> = Vec::with_capacity(plan.carried().len());
    for body in plan.carried() {
        let carried = body.parent.is_some_and(|parent| moves[parent]);
        moves.push(carried || body.arm.is_some() || body.slide.is_some());
    }
    moves
}

/// The bodies whose inertia forces must be carried: those whose roots move, if they or what they
/// carry have mass.
fn links(plan: &Plan, moves: &[bool], massive: &[Massive]) -> Vec<Link> {
    let carried = plan.carried();
    let mut mass = vec![0.0; carried.len()];
    let mut first = vec![None; carried.len()];
    for body in massive {
        mass[body.carried] = body.mass;
        first[body.carried] = body.first;
    }
    let mut bears: Vec<bool> = mass.iter().map(|&m| m > 0.0).collect();
    for (i, body) in carried.iter().enumerate().rev() {
        if let (true, Some(parent)) = (bears[i], body.parent) {
            bears[parent] = true;
        }
    }
    let mut links: Vec<Link> = Vec::new();
    let mut place = vec![None; carried.len()];
    for (i, body) in carried.iter().enumerate() {
        if moves[i] && bears[i] {
            place[i] = Some(links.len());
            links.push(Link {
                carried: i,
                frame: body.frame,
                parent: body.parent.and_then(|parent| place[parent]),
                arm: body.arm.map(|arm| (arm, body.parent_frame)),
                slide: body.slide,
                mass: mass[i],
                first: first[i],
            });
        }
    }
    links
}
