//! Inverse dynamics with loads: Jᵀ[λ; τ] = M ẍ + h − f, for a prescribed motion at a given time.

use crate::acts::{LoadError, LoadState, Loads};
use crate::friction::{Rub, Rubbing};
use crate::load::Load;
use crate::model::{Actions, Model, Workspace};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{Mechanism, Motion, PlaceError, Scalar};
use thiserror::Error;

/// No actions at a state of motion. Small and `Copy`: it is made in the inner loop; whoever holds
/// the loads adds their names.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum KinetostaticsError {
    /// There is no pose.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// A spring with a free length, or a damper, whose two points coincide.
    #[error("load {load} has no direction: its two points coincide")]
    NoDirection {
        /// Index of the load in [`Model::loads`].
        load: usize,
    },
    /// A magnitude that is infinite or not a number.
    #[error("the magnitude of load {load} is not a finite number")]
    MagnitudeNotFinite {
        /// Index of the load in [`Model::loads`].
        load: usize,
    },
    /// Friction for which no single motion balances.
    #[error(
        "the friction of load {load} jams the mechanism: its effective inertia is not positive"
    )]
    Jams {
        /// Index of the first friction in [`Model::loads`].
        load: usize,
    },
}

impl KinetostaticsError {
    /// The load the error speaks of, by its index in [`Model::loads`].
    pub fn load(&self) -> Option<usize> {
        match *self {
            Self::Place(_) => None,
            Self::NoDirection { load }
            | Self::MagnitudeNotFinite { load }
            | Self::Jams { load } => Some(load),
        }
    }
}

/// What a loaded evaluation holds beside a run: the state of every body, and the loads'.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loaded<T> {
    pub(crate) states: BodyStates<T>,
    pub(crate) loads: LoadState<T>,
    pub(crate) q_dot: Vec<T>,
    /// One load alone.
    pub(crate) alone: LoadState<T>,
    pub(crate) rubbing: Rubbing<T>,
    /// By friction: the actions of its channel.
    units: Vec<Actions<T>>,
    /// A motion at unit speed of one coordinate, with its states: a virtual displacement.
    pub(crate) trial: Motion<T>,
    moves: BodyStates<T>,
    pub(crate) unit: Vec<T>,
}

impl<T: Scalar> Loaded<T> {
    pub(crate) fn new(model: &Model) -> Self {
        let plan = &model.plan;
        let rest = vec![T::lift(0.0); plan.actuators()];
        Self {
            states: BodyStates::new(plan),
            loads: model.loads.state(plan),
            alone: model.loads.state(plan),
            rubbing: Rubbing::new(model.rubs.len()),
            units: vec![model.actions(); model.rubs.len()],
            q_dot: rest.clone(),
            trial: plan.motion(),
            moves: BodyStates::new(plan),
            unit: rest,
        }
    }
}

impl<T: Scalar> Workspace<T> {
    /// Takes the accelerations of the last run into the states of the bodies.
    pub fn refill(&mut self, model: &Model) {
        let Self {
            pose,
            motion,
            loaded,
            ..
        } = self;
        loaded.states.fill(&model.plan, pose, motion);
    }

    /// Gives a load of [`Magnitude::Given`](crate::Magnitude::Given) its magnitude, until it is given
    /// another.
    pub fn give(&mut self, load: usize, magnitude: T) {
        self.loaded.loads.magnitude[load] = magnitude;
    }

    /// The bodies at the last state of motion that [`Model::kinetostatics`] evaluated.
    pub fn states(&self) -> &BodyStates<T> {
        &self.loaded.states
    }

    /// The loads at the last state of motion that [`Model::kinetostatics`] evaluated.
    pub fn loads(&self) -> &LoadState<T> {
        &self.loaded.loads
    }
}

impl Model {
    /// The same mechanism under these loads, in place of any it had. They act in
    /// [`Model::kinetostatics`] and [`Model::statics`] alone: reduced inertia knows nothing of them.
    ///
    /// Where they feel an angle (a torsional spring, a magnitude), whole turns are counted from the
    /// rough angles of the start, or else from within half a turn of the other body. Groups that
    /// [`Model::only_for`] left out may come back for that.
    ///
    /// # Errors
    /// [`LoadError`] when a load does not fit the mechanism, or feels an angle whose turns cannot be
    /// counted over the range.
    pub fn with_loads(
        mut self,
        mechanism: &Mechanism,
        loads: Vec<Load>,
    ) -> Result<Self, LoadError> {
        self.loads = Loads::find(mechanism, &self.plan, &self.masses, loads)?;
        self.count_felt(mechanism)?;
        let missing = |load| LoadError {
            load,
            what: "the reactions that its friction depends on are not computed",
        };
        self.rubs = Rub::find(mechanism, &self).map_err(missing)?;
        Ok(self)
    }

    /// The loads, in their order.
    pub fn loads(&self) -> &[Load] {
        &self.loads.loads
    }

    /// Kinetostatics under the loads: the actuators' actions and the reactions at time `t` (s) for
    /// prescribed coordinates `q`, speeds and accelerations (rad or m, per s, per s²):
    /// Jᵀ[λ; τ] = M ẍ + h − f. The states of the bodies and of the loads remain in `work`.
    ///
    /// # Errors
    /// [`KinetostaticsError`] when there is no pose at `q`, or a load has no direction or no finite
    /// magnitude there, or friction jams it.
    pub fn kinetostatics<T: Scalar>(
        &self,
        t: f64,
        q: &[T],
        q_dot: &[T],
        q_ddot: &[T],
        work: &mut Workspace<T>,
        actions: &mut Actions<T>,
    ) -> Result<(), KinetostaticsError> {
        self.enter(t, q, q_dot, work)?;
        self.loaded(q_ddot, work, actions)?;
        work.refill(self);
        if self.rubs.is_empty() {
            return Ok(());
        }
        let mut units = std::mem::take(&mut work.loaded.units);
        let rubbed = self.rub_prescribed(&mut units, &actions.reactions, work);
        work.loaded.units = units;
        rubbed?;
        self.loaded(q_ddot, work, actions)
    }

    /// The frictions of a prescribed motion, from the reactions without them.
    fn rub_prescribed<T: Scalar>(
        &self,
        units: &mut [Actions<T>],
        without: &[T],
        work: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        for (unit, rub) in units.iter_mut().zip(&self.rubs) {
            self.channel(rub.load, work, unit)?;
        }
        self.rub(without, units, work)
    }

    /// Statics under the loads: [`Model::kinetostatics`] at rest.
    ///
    /// # Errors
    /// As [`Model::kinetostatics`].
    pub fn statics(
        &self,
        t: f64,
        q: &[f64],
        work: &mut Workspace<f64>,
        actions: &mut Actions<f64>,
    ) -> Result<(), KinetostaticsError> {
        let mut rest = std::mem::take(&mut work.loaded.unit);
        rest.fill(0.0);
        let done = self.kinetostatics(t, q, &rest, &rest, work, actions);
        work.loaded.unit = rest;
        done
    }

    /// Each load's generalised force by virtual work, at the state last evaluated: into
    /// `forces[load × actuators + i]` the sum of F·∂v/∂q̇ᵢ + M ∂ω/∂q̇ᵢ over what it does to the
    /// bodies, N·m (or N if the coordinate is a length).
    pub fn generalised_forces(&self, work: &mut Workspace<f64>, forces: &mut [f64]) {
        let Workspace { pose, loaded, .. } = work;
        let Loaded {
            loads,
            trial,
            moves,
            unit,
            ..
        } = loaded;
        forces.fill(0.0);
        let n = self.plan.actuators();
        for i in 0..n {
            unit.fill(0.0);
            unit[i] = 1.0;
            self.plan.speeds(pose, unit, trial);
            moves.fill(&self.plan, pose, trial);
            for act in &loads.acts {
                if let crate::acts::By::Load(load) = act.by {
                    forces[load * n + i] += act.power(moves);
                }
            }
        }
    }

    /// Whether a load has a potential energy.
    pub fn conservative(&self, load: usize) -> bool {
        self.loads.loads.get(load).is_some_and(Load::conservative)
    }

    /// The potential energy of a load at the state last evaluated, J; none if it has none. Gravity,
    /// springs and forces that keep their direction have one where their magnitude is constant.
    /// That of gravity and of forces is zero at the ground's origin.
    pub fn potential(&self, load: usize, work: &Workspace<f64>) -> Option<f64> {
        self.loads.potential(load, work.states())
    }
}
