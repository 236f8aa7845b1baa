//! Inverse dynamics with loads: Jᵀ[λ; τ] = M ẍ + h − f, for a prescribed motion at a given time.

use crate::acts::{LoadError, LoadState, Loads};
use crate::load::Load;
use crate::model::{Actions, Model, Workspace};
use crate::runs::Prescribed;
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
}

impl KinetostaticsError {
    /// The load the error speaks of, by its index in [`Model::loads`].
    pub fn load(&self) -> Option<usize> {
        match *self {
            Self::Place(_) => None,
            Self::NoDirection { load } | Self::MagnitudeNotFinite { load } => Some(load),
        }
    }
}

/// What a loaded evaluation holds beside a run: the state of every body, and the loads'.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Loaded<T> {
    pub(crate) states: BodyStates<T>,
    pub(crate) loads: LoadState<T>,
    pub(crate) q_dot: Vec<T>,
    /// A motion at unit speed of one coordinate, with its states: a virtual displacement.
    trial: Motion<T>,
    moves: BodyStates<T>,
    unit: Vec<T>,
}

impl<T: Scalar> Loaded<T> {
    pub(crate) fn new(model: &Model) -> Self {
        let plan = &model.plan;
        let rest = vec![T::lift(0.0); plan.actuators()];
        Self {
            states: BodyStates::new(plan),
            loads: model.loads.state(plan),
            q_dot: rest.clone(),
            trial: plan.motion(),
            moves: BodyStates::new(plan),
            unit: rest,
        }
    }
}

impl<T> Workspace<T> {
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
    /// magnitude there.
    pub fn kinetostatics(
        &self,
        t: f64,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
        work: &mut Workspace<f64>,
        actions: &mut Actions<f64>,
    ) -> Result<(), KinetostaticsError> {
        let Workspace {
            pose,
            motion,
            run,
            loaded,
            ..
        } = work;
        self.plan.place(q, pose)?;
        self.plan.speeds(pose, q_dot, motion);
        self.plan.accelerations(pose, q_ddot, motion);
        loaded.q_dot.copy_from_slice(q_dot);
        loaded.states.fill(&self.plan, pose, motion);
        self.loads
            .magnitudes(t, &loaded.states, &mut loaded.loads)?;
        self.loads.act(&loaded.states, &mut loaded.loads)?;
        run.evaluate_loaded(self, pose, Prescribed(motion), &mut loaded.loads);
        actions.take(self, pose, run);
        Ok(())
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

    /// The potential energy of a load at the state last evaluated, J; none if it has none. Gravity,
    /// springs and forces that keep their direction have one where their magnitude is constant.
    /// That of gravity and of forces is zero at the ground's origin.
    pub fn potential(&self, load: usize, work: &Workspace<f64>) -> Option<f64> {
        self.loads.potential(load, work.states())
    }
}
