//! The runs that the equation of motion and every reaction are put together from, at one state (t, q, q̇):
//!
//! ```text
//! run       what acts                        τ                 reaction k
//! loaded    q̇, known q̈, all loads           c − Q             R⁰
//! inertial  q̈ᵢ = 1 alone                     column i of M     a_k,i
//! channel   magnitude 1 of a load alone      −w_ℓ              c_k,ℓ
//! speeds    q̇ᵢ q̇ⱼ alone                     Cᵢⱼ               b_k,ij
//! ```
//!
//! C are the Christoffel terms: c(q, q̇) = Σ Cᵢⱼ q̇ᵢ q̇ⱼ over i ≤ j.
//!
//! All of them share the pose, its factors and the measured states. With one coordinate, the first run at
//! unit speed without loads is ½m′ and b_k.

use crate::kinetostatics::KinetostaticsError;
use crate::model::{Actions, Model, Workspace};
use crate::runs::{Prescribed, Pushed, Still};
use dwell_geometry::{PlaceError, Scalar};

impl Model {
    /// Enters a state: coordinates `q` (rad or m) and speeds `q_dot` at time `t` (s). The states of the
    /// bodies (but for accelerations) and the magnitudes of the loads are then those in `work`; friction
    /// is zero until [`Model::rub`].
    ///
    /// # Errors
    /// [`KinetostaticsError`] when there is no pose at `q`, or a load has no finite magnitude there.
    pub fn enter<T: Scalar>(
        &self,
        t: f64,
        q: &[T],
        q_dot: &[T],
        work: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        self.enter_shape(q, q_dot, work)?;
        let loaded = &mut work.loaded;
        self.loads.magnitudes(t, &loaded.states, &mut loaded.loads)
    }

    /// Enters coordinates (rad or m) and speeds as [`Model::enter`] does, without the magnitudes: what a
    /// channel or a measure needs.
    ///
    /// # Errors
    /// [`PlaceError`] when there is no pose at `q`.
    pub fn enter_shape<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        work: &mut Workspace<T>,
    ) -> Result<(), PlaceError> {
        let Workspace {
            pose,
            motion,
            loaded,
            ..
        } = work;
        self.plan.place(q, pose)?;
        self.plan.speeds(pose, q_dot, motion);
        loaded.q_dot.copy_from_slice(q_dot);
        loaded.states.fill(&self.plan, pose, motion);
        Ok(())
    }

    /// Enters a state whose pose and motion (with accelerations) the caller has put into `work`.
    ///
    /// # Errors
    /// [`KinetostaticsError`] when a load has no finite magnitude there.
    pub fn enter_placed<T: Scalar>(
        &self,
        t: f64,
        q_dot: &[T],
        work: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        work.refill(self);
        let loaded = &mut work.loaded;
        loaded.q_dot.copy_from_slice(q_dot);
        self.loads.magnitudes(t, &loaded.states, &mut loaded.loads)
    }

    /// The loaded run at the state entered, with these accelerations (rad/s² or m/s²): the actions and
    /// reactions of inertia and all loads.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where the two points of a load coincide.
    pub fn loaded<T: Scalar>(
        &self,
        q_ddot: &[T],
        work: &mut Workspace<T>,
        actions: &mut Actions<T>,
    ) -> Result<(), KinetostaticsError> {
        let Workspace {
            pose,
            motion,
            run,
            loaded,
            ..
        } = work;
        self.loads.act(&loaded.states, &mut loaded.loads)?;
        self.plan.accelerations(pose, q_ddot, motion);
        run.evaluate_loaded(self, pose, Prescribed(motion), &mut loaded.loads);
        actions.take(self, pose, run);
        Ok(())
    }

    /// Takes accelerations (rad/s² or m/s²) into the states of the bodies at the state entered.
    pub fn accelerate<T: Scalar>(&self, q_ddot: &[T], work: &mut Workspace<T>) {
        self.plan
            .accelerations(&work.pose, q_ddot, &mut work.motion);
        work.refill(self);
    }

    /// Brings what the loads do to the bodies up to date with their magnitudes.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where the two points of a load coincide.
    pub fn push<T: Scalar>(&self, work: &mut Workspace<T>) -> Result<(), KinetostaticsError> {
        let loaded = &mut work.loaded;
        self.loads.act(&loaded.states, &mut loaded.loads)
    }

    /// The inertial run of one coordinate at the state entered: q̈ᵢ = 1 (per s²) and nothing else.
    pub fn inertial<T: Scalar>(&self, i: usize, work: &mut Workspace<T>, actions: &mut Actions<T>) {
        let Workspace {
            pose, run, loaded, ..
        } = work;
        loaded.unit.fill(T::lift(0.0));
        loaded.unit[i] = T::lift(1.0);
        self.plan.speeds(pose, &loaded.unit, &mut loaded.trial);
        run.evaluate(self, pose, Pushed(&loaded.trial));
        actions.take(self, pose, run);
    }

    /// The channel of one load at the state entered: magnitude 1 of it alone, and rest. Of a damper, one
    /// unit of what it resists with (N or N·m).
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where its two points coincide.
    pub fn channel<T: Scalar>(
        &self,
        load: usize,
        work: &mut Workspace<T>,
        actions: &mut Actions<T>,
    ) -> Result<(), KinetostaticsError> {
        let Workspace {
            pose, run, loaded, ..
        } = work;
        self.loads.unit(load, &loaded.states, &mut loaded.alone)?;
        run.evaluate_loaded(self, pose, Still, &mut loaded.alone);
        actions.take(self, pose, run);
        Ok(())
    }

    /// What the product of two speeds alone makes at the pose entered, q̇ᵢ q̇ⱼ = 1 per s²: of one speed by
    /// itself the run at unit speed, of two what is more than both of them make alone.
    pub fn speeds<T: Scalar>(
        &self,
        [i, j]: [usize; 2],
        work: &mut Workspace<T>,
        actions: &mut Actions<T>,
    ) {
        let Workspace {
            pose, run, loaded, ..
        } = work;
        let rest = vec![T::lift(0.0); self.plan.actuators()];
        let mut at = |which: &[usize], actions: &mut Actions<T>| {
            loaded.unit.fill(T::lift(0.0));
            for &k in which {
                loaded.unit[k] = T::lift(1.0);
            }
            self.plan.speeds(pose, &loaded.unit, &mut loaded.trial);
            self.plan.accelerations(pose, &rest, &mut loaded.trial);
            run.evaluate(self, pose, Prescribed(&loaded.trial));
            actions.take(self, pose, run);
        };
        if i == j {
            return at(&[i], actions);
        }
        let mut alone = self.actions();
        at(&[i, j], actions);
        for k in [i, j] {
            at(&[k], &mut alone);
            for (sum, one) in actions.tau.iter_mut().zip(&alone.tau) {
                *sum -= *one;
            }
            for (sum, one) in actions.reactions.iter_mut().zip(&alone.reactions) {
                *sum -= *one;
            }
        }
    }
}
