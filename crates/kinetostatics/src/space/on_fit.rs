//! A model in space on a fit of its branch across a change point: from velocities alone, because the loops determine no
//! multipliers there.
//!
//! ```text
//! m = Σ F₁·v,   ½m′ = Σ F₂·v,   Q = Σ F·v     at q̇ = 1, q̈ = 0                                          (1)
//! ```
//!
//! with the required wrenches F₁ and F₂ of the bodies in the two unit passes, and the wrenches F of the loads.

use super::model::{Model, Workspace};
use crate::error::Result;
use crate::model::{EvaluatedState, ForceState, KinematicState, MachineModel as _};
use crate::pass::InverseDynamics;
use dwell_geometry::space::{BodyMotion, BranchFit, BranchFitWorkspace, Wrench};
use dwell_numerics::Scalar;

/// Memory for a model on a fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FitWorkspace<T> {
    branch: BranchFitWorkspace<T>,
    /// By body: its motion at unit speed.
    unit_states: Vec<BodyMotion<T>>,
}

/// The power of a wrench in a motion of the point about which it is.
fn power<T: Scalar>(wrench: &Wrench<T>, motion: &BodyMotion<T>) -> T {
    wrench.force.dot(motion.velocity) + wrench.moment.dot(motion.angular_velocity)
}

impl Model {
    /// Sets pose and motion to those of a fit: at a coordinate and its distance from the centre, with speed and acceleration.
    fn set_on_fit<T: Scalar>(
        &self,
        fit: &BranchFit,
        at: [T; 2],
        rates: [T; 2],
        workspace: &mut Workspace<T>,
    ) {
        let Workspace { pose, on_fit, .. } = workspace;
        (self.plan()).set_on_fit(fit, at, rates, &mut on_fit.branch, pose);
    }

    /// m and ½m′ of (1) on a fit, at a coordinate and its distance from the centre; the motion at unit speed is kept for
    /// [`ForceState::unit_power`], and is that of the workspace.
    pub fn inertia_on_fit<T: Scalar>(
        &self,
        fit: &BranchFit,
        at: [T; 2],
        workspace: &mut Workspace<T>,
    ) -> [T; 2] {
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        self.set_on_fit(fit, at, [one, zero], workspace);
        let Workspace { pose, on_fit, .. } = workspace;
        let bodies = 0..self.inner_masses().len();
        on_fit.unit_states.clear();
        (on_fit.unit_states).extend(bodies.map(|b| *self.plan().state(pose, b)));
        let mut sums = [zero; 2];
        for &b in self.inertial() {
            let (frame, motion) = (self.plan().frame(pose, b), self.plan().state(pose, b));
            let required = self.inner_masses()[b].required_in_unit_passes(frame, motion);
            for (sum, wrench) in sums.iter_mut().zip(&required) {
                *sum += power(wrench, motion);
            }
        }
        sums
    }

    /// The state on a fit at a speed.
    pub fn state_on_fit<'a, T: Scalar>(
        &'a self,
        fit: &BranchFit,
        at: [T; 2],
        q_dot: T,
        workspace: &'a mut Workspace<T>,
    ) -> KinematicState<'a, T, Self> {
        self.set_on_fit(fit, at, [q_dot, T::from_f64(0.0)], workspace);
        let model = self;
        KinematicState { model, workspace }
    }

    /// The whole state on a fit with magnitudes of loads, and actions and reactions that are given.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`](crate::KinetostaticsError::NoDirection) where the two points of a load coincide.
    pub fn given_on_fit<'a, T: Scalar>(
        &'a self,
        (fit, at): (&BranchFit, [T; 2]),
        rates: [T; 2],
        magnitudes: &[T],
        workspace: &'a mut Workspace<T>,
        result: &'a InverseDynamics<T>,
    ) -> Result<EvaluatedState<'a, T, Self>> {
        self.set_on_fit(fit, at, rates, workspace);
        workspace.magnitudes.copy_from_slice(magnitudes);
        self.update_wrenches(workspace)?;
        let model = self;
        let state = KinematicState { model, workspace };
        Ok(EvaluatedState { state, result })
    }
}

impl<T: Scalar> ForceState<'_, T, Model> {
    /// The power of all loads in the motion that [`Model::inertia_on_fit`] kept: Q of (1).
    pub fn unit_power(&self) -> T {
        let wrenches = self.workspace.load_wrenches.iter();
        let pairs = wrenches.zip(&self.workspace.on_fit.unit_states);
        pairs.fold(T::from_f64(0.0), |sum, (wrench, motion)| {
            sum + power(wrench, motion)
        })
    }

    /// The motion becomes that with this acceleration on a fit.
    pub fn accelerate_on_fit(&mut self, fit: &BranchFit, at: [T; 2], rates: [T; 2]) {
        let KinematicState { model, workspace } = &mut **self;
        model.set_on_fit(fit, at, rates, workspace);
    }
}
