//! The passes from which the equation of motion and every reaction are composed, at one state (t, q, q̇):
//!
//! ```text
//! method                    what is nonzero                  τ                 reaction k
//! loaded_inverse_dynamics   q̇, known q̈, all loads           c − Q             R⁰
//! mass_matrix_column        q̈ᵢ = 1                           column i of M     a_k,i
//! unit_load_response        magnitude 1 of one load          −w_ℓ              c_k,ℓ
//! christoffel_terms         q̇ᵢ q̇ⱼ                           Cᵢⱼ               b_k,ij
//! ```
//!
//! C are the Christoffel terms: c(q, q̇) = Σ Cᵢⱼ q̇ᵢ q̇ⱼ over i ≤ j.
//!
//! All of them share the pose, its factors and the states of the bodies. With one coordinate, the first at
//! unit speed without loads gives ½m′ and b_k.

use super::{Model, Workspace};
use crate::error::KinetostaticsError;
use crate::pass::{AtRest, GivenMotion, InverseDynamics, UnitAcceleration};
use dwell_geometry::PositionError;
use dwell_numerics::Scalar;

impl Model {
    /// Sets the state: coordinates `q` (rad or m) and velocities `q_dot` at time `t` (s). The workspace then holds the
    /// states of the bodies (except accelerations) and the magnitudes of the loads; friction is zero until
    /// [`Model::solve_friction`].
    ///
    /// # Errors
    /// [`KinetostaticsError`] when there is no pose at `q`, or a load has no finite magnitude there.
    pub fn set_state<T: Scalar>(
        &self,
        t: f64,
        q: &[T],
        q_dot: &[T],
        workspace: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        self.set_kinematic_state(q, q_dot, workspace)?;
        let load_workspace = &mut workspace.load_workspace;
        self.loads
            .update_magnitudes(t, &load_workspace.states, &mut load_workspace.loads)
    }

    /// Sets coordinates (rad or m) and velocities as [`Model::set_state`] does, without the magnitudes of the loads:
    /// enough for [`Model::unit_load_response`] and for coordinates of bodies.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose at `q`.
    pub fn set_kinematic_state<T: Scalar>(
        &self,
        q: &[T],
        q_dot: &[T],
        workspace: &mut Workspace<T>,
    ) -> Result<(), PositionError> {
        let Workspace {
            pose,
            motion,
            load_workspace: loaded,
            ..
        } = workspace;
        self.pass_model.plan.positions(q, pose)?;
        self.pass_model.plan.velocities(pose, q_dot, motion);
        loaded.q_dot.copy_from_slice(q_dot);
        loaded.states.fill(&self.pass_model.plan, pose, motion);
        Ok(())
    }

    /// Sets the state whose pose and motion (with accelerations) the caller has stored in the workspace.
    ///
    /// # Errors
    /// [`KinetostaticsError`] when a load has no finite magnitude there.
    pub fn set_state_from_pose<T: Scalar>(
        &self,
        t: f64,
        q_dot: &[T],
        workspace: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        workspace.update_body_accelerations(self);
        let load_workspace = &mut workspace.load_workspace;
        load_workspace.q_dot.copy_from_slice(q_dot);
        self.loads
            .update_magnitudes(t, &load_workspace.states, &mut load_workspace.loads)
    }

    /// The actions and reactions of inertia and all loads at the state set, with these accelerations (rad/s² or m/s²).
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where the two points of a load coincide.
    pub fn loaded_inverse_dynamics<T: Scalar>(
        &self,
        q_ddot: &[T],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<(), KinetostaticsError> {
        let Workspace {
            pose,
            motion,
            pass,
            load_workspace: loaded,
            ..
        } = workspace;
        self.loads
            .update_wrenches(&loaded.states, &mut loaded.loads)?;
        self.pass_model.plan.accelerations(pose, q_ddot, motion);
        pass.evaluate_loaded(
            &self.pass_model,
            pose,
            GivenMotion(motion),
            &mut loaded.loads,
        );
        result.read_from(&self.pass_model, pose, pass);
        Ok(())
    }

    /// Sets accelerations (rad/s² or m/s²) and updates those of the bodies, at the state set.
    pub fn set_accelerations<T: Scalar>(&self, q_ddot: &[T], workspace: &mut Workspace<T>) {
        self.pass_model
            .plan
            .accelerations(&workspace.pose, q_ddot, &mut workspace.motion);
        workspace.update_body_accelerations(self);
    }

    /// Updates the wrenches of the loads from their magnitudes.
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where the two points of a load coincide.
    pub fn update_load_wrenches<T: Scalar>(
        &self,
        workspace: &mut Workspace<T>,
    ) -> Result<(), KinetostaticsError> {
        let load_workspace = &mut workspace.load_workspace;
        self.loads
            .update_wrenches(&load_workspace.states, &mut load_workspace.loads)
    }

    /// Column i of the mass matrix, and a_k,i, at the state set: q̈ᵢ = 1 (per s²) and nothing else.
    pub fn mass_matrix_column<T: Scalar>(
        &self,
        i: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        let Workspace {
            pose,
            pass,
            load_workspace: loaded,
            ..
        } = workspace;
        loaded.unit_velocity.fill(T::from_f64(0.0));
        loaded.unit_velocity[i] = T::from_f64(1.0);
        self.pass_model
            .plan
            .velocities(pose, &loaded.unit_velocity, &mut loaded.virtual_motion);
        pass.evaluate(
            &self.pass_model,
            pose,
            UnitAcceleration(&loaded.virtual_motion),
        );
        result.read_from(&self.pass_model, pose, pass);
    }

    /// The response to one load alone of magnitude 1, at rest in the pose set: τ = −w and the reactions c. Of a damper,
    /// to one unit of its resistance (N or N·m).
    ///
    /// # Errors
    /// [`KinetostaticsError::NoDirection`] where its two points coincide.
    pub fn unit_load_response<T: Scalar>(
        &self,
        load: usize,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Result<(), KinetostaticsError> {
        let Workspace {
            pose,
            pass,
            load_workspace: loaded,
            ..
        } = workspace;
        self.loads
            .unit_wrenches(load, &loaded.states, &mut loaded.single_load)?;
        pass.evaluate_loaded(&self.pass_model, pose, AtRest, &mut loaded.single_load);
        result.read_from(&self.pass_model, pose, pass);
        Ok(())
    }

    /// The Christoffel terms of the velocities i and j at the pose set, for q̇ᵢ q̇ⱼ = 1 per s²: with i = j, the pass at
    /// unit velocity; else the pass at both unit velocities less those at each of them.
    pub fn christoffel_terms<T: Scalar>(
        &self,
        [i, j]: [usize; 2],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) {
        let Workspace {
            pose,
            pass,
            load_workspace: loaded,
            ..
        } = workspace;
        let rest = vec![T::from_f64(0.0); self.pass_model.plan.actuators()];
        let mut at = |coordinates: &[usize], result: &mut InverseDynamics<T>| {
            loaded.unit_velocity.fill(T::from_f64(0.0));
            for &k in coordinates {
                loaded.unit_velocity[k] = T::from_f64(1.0);
            }
            self.pass_model.plan.velocities(
                pose,
                &loaded.unit_velocity,
                &mut loaded.virtual_motion,
            );
            self.pass_model
                .plan
                .accelerations(pose, &rest, &mut loaded.virtual_motion);
            pass.evaluate(&self.pass_model, pose, GivenMotion(&loaded.virtual_motion));
            result.read_from(&self.pass_model, pose, pass);
        };
        if i == j {
            return at(&[i], result);
        }
        let mut single = self.result_buffer();
        at(&[i, j], result);
        for k in [i, j] {
            at(&[k], &mut single);
            for (sum, one) in result.tau.iter_mut().zip(&single.tau) {
                *sum -= *one;
            }
            for (sum, one) in result.reactions.iter_mut().zip(&single.reactions) {
                *sum -= *one;
            }
        }
    }
}
