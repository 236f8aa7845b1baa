//! A mechanism with masses, ready to be evaluated: inertia forces, the actuators' actions, and
//! the reactions that were asked for.

use crate::mass::Mass;
use crate::reactions::Sources;
use crate::runs::Runs;
use dwell_geometry::{
    AssemblyError, Mechanism, Motion, PlaceError, Plan, Pose, Reaction, Scalar, Start, Vec2,
};
use thiserror::Error;

/// The model of a mechanism: constant, shared between threads.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    pub(crate) plan: Plan,
    pub(crate) massive: Vec<Massive>,
    pub(crate) sources: Sources,
    reactions: Vec<Reaction>,
}

/// A carried body that has inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Massive {
    pub(crate) carried: usize,
    pub(crate) frame: usize,
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    /// From the body's root to its centre of mass, in its frame; none where they coincide.
    pub(crate) arm: Option<Vec2>,
}

/// Why a model cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The mechanism cannot be put together.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
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
}

/// The actuators' actions and the requested reactions in one state of motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Actions<T> {
    /// By actuator: its action on its second body, N·m.
    pub tau: Vec<T>,
    /// By requested reaction: N or N·m.
    pub reactions: Vec<T>,
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
        let plan = Plan::compile(mechanism, start)?;
        let massive = plan
            .carried()
            .iter()
            .enumerate()
            .filter_map(|(i, carried)| {
                let mass = masses[carried.body.0];
                let frame = carried.frame;
                let arm = plan
                    .tree()
                    .arm(plan.frames(), carried.body.0, mass.center)
                    .local;
                (mass.mass > 0.0 || mass.inertia > 0.0).then(|| Massive {
                    carried: i,
                    frame,
                    mass: mass.mass,
                    inertia: mass.inertia,
                    arm: (arm != Vec2::ZERO && mass.mass > 0.0).then_some(arm),
                })
            })
            .collect();
        let sources = Sources::find(mechanism, &plan, reactions);
        Ok(Self {
            plan,
            massive,
            sources,
            reactions: reactions.to_vec(),
        })
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
            unit: Runs::new(&self.plan),
            run: Runs::new(&self.plan),
        }
    }

    /// Room for the actions of this model.
    pub fn actions<T: Scalar>(&self) -> Actions<T> {
        Actions {
            tau: vec![T::lift(0.0); self.plan.actuators()],
            reactions: vec![T::lift(0.0); self.reactions.len()],
        }
    }

    /// Kinetostatics: the actuators' actions and the reactions for prescribed coordinates `q`
    /// (rad), speeds (rad/s) and accelerations (rad/s²): Jᵀ[λ; τ] = M ẍ + h.
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
        run.set_rates(|f| {
            let w = motion.turn[f];
            [[w * w, motion.turn_rate[f]]]
        });
        run.set_slide_rates(|s, f| {
            let coriolis = T::lift(2.0) * motion.turn[f] * motion.slide[s];
            [[coriolis, motion.slide_rate[s]]]
        });
        run.evaluate(self, pose);
        for (i, tau) in actions.tau.iter_mut().enumerate() {
            *tau = run.tau(self, i)[0];
        }
        for (k, value) in actions.reactions.iter_mut().enumerate() {
            *value = run.reaction(self, pose, k)[0];
        }
        Ok(())
    }

    /// Twice the kinetic energy at unit speed, Σ m v² + I ω², and half its derivative by power,
    /// Σ m v·a + I ω α, both at the pose, speeds and accelerations in `work`: another way to m
    /// and ½m′, with no reaction in it.
    pub fn energy_and_power(&self, work: &Workspace<f64>) -> (f64, f64) {
        let Workspace { pose, motion, .. } = work;
        let carried = self.plan.carried();
        let mut rates = vec![(Vec2::ZERO, Vec2::ZERO); carried.len()];
        for (i, c) in carried.iter().enumerate() {
            let mut rate = c.parent.map_or((Vec2::ZERO, Vec2::ZERO), |p| rates[p]);
            if let Some(arm) = c.arm {
                add(&mut rate, pose.arm[arm], c.parent_frame, motion);
            }
            if let Some((slide, direction)) = c.slide {
                let along = pose.arm[direction];
                add(&mut rate, along * pose.slide[slide], c.frame, motion);
                rate.0 += along * motion.slide[slide];
                rate.1 += along * motion.slide_rate[slide]
                    + along.perp() * (2.0 * motion.turn[c.frame] * motion.slide[slide]);
            }
            rates[i] = rate;
        }
        let (mut energy, mut power) = (0.0, 0.0);
        for body in &self.massive {
            let mut rate = rates[body.carried];
            if let Some(arm) = body.arm {
                add(
                    &mut rate,
                    arm.turn(pose.turn[body.frame]),
                    body.frame,
                    motion,
                );
            }
            let (w, a) = (motion.turn[body.frame], motion.turn_rate[body.frame]);
            energy += body.mass * rate.0.dot(rate.0) + body.inertia * w * w;
            power += body.mass * rate.0.dot(rate.1) + body.inertia * w * a;
        }
        (energy, power)
    }
}

/// Adds what an arm adds to a point's velocity and acceleration.
fn add(rate: &mut (Vec2, Vec2), arm: Vec2, frame: usize, motion: &Motion<f64>) {
    let (w, a) = (motion.turn[frame], motion.turn_rate[frame]);
    rate.0 += arm.perp() * w;
    rate.1 += arm.perp() * a - arm * (w * w);
}
