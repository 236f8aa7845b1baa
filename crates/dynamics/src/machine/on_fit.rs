//! A machine within the window of a change-point fit, by eq. (1) of [`crate::change_point_fit`].

use super::{Machine, MachineWorkspace};
use crate::change_point_fit::{ChangePointFit, FitWorkspace, set_motion};
use crate::error::DynamicsError;
use dwell_kinetostatics::{InverseDynamics, Magnitude, Model, Workspace};
use dwell_numerics::Scalar;
use dwell_numerics::polynomial_fit::{PolynomialFit, chebyshev_nodes};

/// Nodes on each side of the window, and highest degree, of the fit of the reactions.
const REACTION_NODES: usize = 8;
const REACTION_DEGREE: usize = 8;

impl Machine {
    /// The change-point fit within whose window a coordinate is, and its distance from the change point.
    #[inline]
    pub(crate) fn fit_at<T: Scalar>(&self, q: Option<&T>) -> Option<(&ChangePointFit, f64)> {
        if self.fit_windows.is_empty() {
            return None;
        }
        let q = q?.value();
        let mut windows = self.fit_windows.iter();
        windows.find_map(|window| Some((window.fit.as_ref(), window.offset_within(q)?)))
    }

    /// Whether a state is within the window of a change-point fit. There [`Machine::evaluate`] yields the states of
    /// bodies and loads, but no reactions; [`Machine::evaluate_outputs`] does.
    pub fn is_in_fit_window(&self, y: &[f64]) -> bool {
        self.fit_at(y.first()).is_some()
    }

    /// As [`Machine::evaluate`] within the window of a fit.
    pub(crate) fn evaluate_on_fit<T: Scalar>(
        &self,
        (fit, x): (&ChangePointFit, f64),
        t: f64,
        drive_states: &[T],
        workspace: &mut MachineWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        let new = || Box::new(FitWorkspace::new(&self.model));
        let mut fit_workspace = workspace.fit_workspace.take().unwrap_or_else(new);
        let result =
            self.evaluate_on_fit_with((fit, x), t, drive_states, workspace, &mut fit_workspace);
        workspace.fit_workspace = Some(fit_workspace);
        result
    }

    fn evaluate_on_fit_with<T: Scalar>(
        &self,
        (fit, x): (&ChangePointFit, f64),
        t: f64,
        drive_states: &[T],
        workspace: &mut MachineWorkspace<T>,
        fit_workspace: &mut FitWorkspace<T>,
    ) -> Result<(), DynamicsError> {
        let plan = self.model.plan();
        let (q, q_dot) = (workspace.q[0], workspace.q_dot[0]);
        let x = q - T::from_f64(q.value() - x);
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        fit.polynomials.eval(
            x,
            &mut fit_workspace.basis_values,
            &mut fit_workspace.values,
        );
        fit_workspace.set_pose(plan, &workspace.q, &mut workspace.inner.pose);
        set_motion(
            &fit_workspace.values,
            [one, zero],
            &mut fit_workspace.unit_motion,
        );
        fit_workspace
            .unit_states
            .fill(plan, &workspace.inner.pose, &fit_workspace.unit_motion);
        set_motion(
            &fit_workspace.values,
            [q_dot, zero],
            &mut workspace.inner.motion,
        );
        self.model
            .set_state_from_pose(t, &workspace.q_dot, &mut workspace.inner)?;
        self.evaluate_drives(t, drive_states, workspace)?;
        self.model.update_load_wrenches(&mut workspace.inner)?;
        let [mut m, mut half_dm] = self.model.inertia_sums(&fit_workspace.unit_states);
        for drive in &self.drives {
            let [_, first, second] = fit_workspace.unit_states.coordinate(drive.measured);
            m += T::from_f64(drive.reflected_inertia) * first * first;
            half_dm += T::from_f64(drive.reflected_inertia) * first * second;
        }
        let inertia = m.value();
        if !(inertia > 0.0 && inertia.is_finite()) {
            return Err(DynamicsError::NoInertia {
                q: q.value(),
                m: inertia,
            });
        }
        let mut force = zero;
        for wrench in &workspace.inner.loads().wrenches {
            force += wrench.power(&fit_workspace.unit_states);
        }
        let q_ddot = (force - half_dm * q_dot * q_dot) / m;
        workspace.q_ddot[0] = q_ddot;
        set_motion(
            &fit_workspace.values,
            [q_dot, q_ddot],
            &mut workspace.inner.motion,
        );
        workspace.inner.update_body_accelerations(&self.model);
        self.set_net_drive_forces(workspace)
    }
}

/// As [`Machine::evaluate_outputs`] within the window. A reaction that is not determined at the change point is
/// not a number.
pub(super) fn evaluate_outputs(
    (fit, x): (&ChangePointFit, f64),
    output_model: &Model,
    t: f64,
    workspace: &MachineWorkspace<f64>,
    output_workspace: &mut Workspace<f64>,
    result: &mut InverseDynamics<f64>,
) -> Result<(), DynamicsError> {
    // The bodies and loads are as the machine has them.
    output_workspace.pose.clone_from(&workspace.inner.pose);
    output_workspace.motion.clone_from(&workspace.inner.motion);
    output_model.set_state_from_pose(t, &workspace.q_dot, output_workspace)?;
    for (load, &magnitude) in workspace.inner.loads().magnitude.iter().enumerate() {
        output_workspace.set_magnitude(load, magnitude);
    }
    output_model.update_load_wrenches(output_workspace)?;
    result.tau.fill(0.0);
    let q = workspace.q.first().copied().unwrap_or(fit.center);
    let center = q - x;
    // Reactions are known worse than poses, and needed in the window alone.
    let fit_radius = fit.fit_radius.min(3.0 * fit.half_width);
    let (mut at, mut samples) = (Vec::new(), Vec::new());
    for (model, direction) in fit.branches.iter().zip([-1.0, 1.0]) {
        let mut branch_workspace = model.workspace();
        let mut branch_result = model.result_buffer();
        for d in chebyshev_nodes(fit.half_width, fit_radius, REACTION_NODES) {
            for (load, one) in model.loads().iter().enumerate() {
                if matches!(one.magnitude, Magnitude::External(_)) {
                    branch_workspace.set_magnitude(load, workspace.inner.loads().magnitude[load]);
                }
            }
            let q = [center + direction * d];
            let rates = (&workspace.q_dot, &workspace.q_ddot);
            model.kinetostatics(
                t,
                &q,
                rates.0,
                rates.1,
                &mut branch_workspace,
                &mut branch_result,
            )?;
            at.push(direction * d);
            samples.push(branch_result.reactions.clone());
        }
    }
    let reactions = PolynomialFit::new(&at, &samples, fit_radius, REACTION_DEGREE);
    let mut values = reactions.workspace();
    reactions.eval(x, &mut Vec::new(), &mut values);
    for (value, reaction) in result.reactions.iter_mut().zip(output_model.reactions()) {
        let index = fit.branches[0]
            .reactions()
            .iter()
            .position(|r| r == reaction);
        let determined = !fit.indeterminate.contains(reaction);
        *value = match index.filter(|_| determined) {
            Some(k) => values[k][0],
            None => f64::NAN,
        };
    }
    Ok(())
}
