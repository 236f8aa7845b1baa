//! A machine within the window of a change-point fit, by eq. (1) of [`crate::change_point_fit`].

use super::workspace::EquationWorkspace;
use super::{EvaluatedIn, Machine, MachineState};
use crate::change_point_fit::{FitWindow, FitWorkspace, set_motion};
use crate::error::{Result, positive_inertia};
use dwell_geometry::{JointKind, Motion, Pose};
use dwell_kinetostatics::{
    EvaluatedState, ForceState, InverseDynamics, MachineModel, Magnitude, Model, Workspace,
};
use dwell_numerics::polynomial_fit::{PolynomialFit, chebyshev_nodes};
use dwell_numerics::{DoubleDouble, Dual, Scalar, lu};
use std::fmt::Debug;

/// Nodes on each side of the window, and highest degree, of the fit of the reactions.
const REACTION_NODES: usize = 8;
const REACTION_DEGREE: usize = 8;

/// A model for motions, with the fit that replaces it where a motion crosses a change point, if it has one.
///
/// A machine in space is built as one in the plane:
///
/// ```
/// use dwell_dynamics::{CoordinateMode, Machine, Orbit, ReducedState};
/// use dwell_geometry::Body;
/// use dwell_geometry::space::{Actuator, Assembly, Joint, JointKind, Mechanism, Side, vec3};
/// use dwell_kinetostatics::Magnitude;
/// use dwell_kinetostatics::space::{Load, LoadKind, Mass, Model};
/// use std::f64::consts::{PI, TAU};
///
/// // Mach's pendulum: 1 kg at 1 m from an axis that is inclined by 60°, so that it swings as under g cos 60°.
/// let (sin, cos) = (PI / 3.0).sin_cos();
/// let lowest = vec3(sin, 0.0, -cos);
/// let side = Side { axis: vec3(cos, 0.0, sin), normal: lowest, ..Side::default() };
/// let mechanism = Mechanism {
///     bodies: ["ground", "pendulum"].map(Body::named).into(),
///     ground: 0,
///     joints: vec![Joint::new("A", [0, 1], JointKind::Revolute, [side; 2])],
///     actuators: vec![Actuator::angle("q", 0)],
///     couplings: Vec::new(),
/// };
/// let masses = [Mass::default(), Mass { mass: 1.0, center: lowest, inertia: [0.0; 6] }];
/// let model = Model::new(&mechanism, &masses, &Assembly::at(&[0.0]), &[])?;
/// let weight = Load {
///     name: "weight".into(),
///     kind: LoadKind::Gravity { direction: vec3(0.0, 0.0, -1.0) },
///     magnitude: Magnitude::Constant(9.81),
/// };
/// let machine = Machine::new(model, &[weight], vec![CoordinateMode::Free], &[])?;
///
/// let orbit = Orbit::loaded(&machine, ReducedState { t: 0.0, q: 0.01, q_dot: 0.0 })?;
/// // T = 2π √(l / g cos α) (1 + q₀²/16 + …)
/// let period = TAU / (9.81 * cos).sqrt() * (1.0 + 0.01 * 0.01 / 16.0);
/// assert!((orbit.period / period - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait MovingModel:
    MachineModel + EvaluatedIn<f64> + EvaluatedIn<Dual> + EvaluatedIn<DoubleDouble> + EvaluatedIn<f32>
{
    /// The interval of the coordinate in which a fit replaces the model.
    type FitWindow: Debug + Clone + PartialEq + Send + Sync;

    /// Whether a position follows a function of the scene, such as that of a cam.
    fn follows_functions(&self) -> bool {
        false
    }

    /// The distance of a coordinate from the change point of a window, if it is within.
    fn offset_within(window: &Self::FitWindow, q: f64) -> Option<f64>;

    /// As [`Machine::evaluate`] within the window of a fit, at a distance from the change point; the memory is that of
    /// [`MachineWorkspace`](super::MachineWorkspace).
    ///
    /// # Errors
    /// As of [`Machine::evaluate`].
    #[doc(hidden)]
    fn evaluate_on_fit<'a, T: Scalar>(
        machine: &'a Machine<Self>,
        fit: (&Self::FitWindow, f64),
        at: (f64, &[T]),
        memory: (&[T], &'a mut Self::Workspace<T>),
        equation: &mut EquationWorkspace<T>,
    ) -> Result<ForceState<'a, T, Self>>;

    /// As [`MachineState::outputs`] within the window.
    ///
    /// # Errors
    /// As of [`MachineState::outputs`].
    #[doc(hidden)]
    fn outputs_on_fit<'o>(
        state: &MachineState<'_, f64, Self>,
        fit: (&Self::FitWindow, f64),
        output_model: &'o Self,
        workspace: &'o mut Self::Workspace<f64>,
        result: &'o mut InverseDynamics<f64>,
    ) -> Result<EvaluatedState<'o, f64, Self>>;
}

impl<M: MovingModel> Machine<M> {
    /// The change-point fit within whose window a coordinate is, and its distance from the change point.
    #[inline]
    pub(crate) fn fit_at<T: Scalar>(&self, q: Option<&T>) -> Option<(&M::FitWindow, f64)> {
        if self.fit_windows.is_empty() {
            return None;
        }
        let q = q?.value();
        let mut windows = self.fit_windows.iter();
        windows.find_map(|window| Some((window, M::offset_within(window, q)?)))
    }

    /// Whether a state is within the window of a change-point fit. There [`Machine::evaluate`] yields the states of
    /// bodies and loads, but no reactions; [`MachineState::outputs`] does.
    pub fn is_in_fit_window(&self, y: &[f64]) -> bool {
        self.fit_at(y.first()).is_some()
    }
}

/// The equation of motion (1) within a window, in the plane and in space.
impl<M: MovingModel> Machine<M> {
    /// m and ½m′ of the bodies, rotors and flywheels, with the given rates of the drives' coordinates at unit speed.
    ///
    /// # Errors
    /// [`DynamicsError::NoInertia`](crate::DynamicsError::NoInertia).
    pub(super) fn inertia_on_fit<T: Scalar>(
        &self,
        [mut m, mut half_dm]: [T; 2],
        q: T,
        unit_motion: impl Fn(M::CoordinateFunction) -> [T; 3],
    ) -> Result<[T; 2]> {
        for drive in &self.drives {
            let [_, first, second] = unit_motion(drive.measured);
            m += T::from_f64(drive.reflected_inertia) * first * first;
            half_dm += T::from_f64(drive.reflected_inertia) * first * second;
        }
        m += T::from_f64(self.flywheels[0]);
        positive_inertia(m.value(), q.value())?;
        Ok([m, half_dm])
    }

    /// Solves (1) for the acceleration of the only coordinate, along which loads and drives exert this force.
    pub(super) fn accelerate_on_fit<T: Scalar>(
        &self,
        [m, half_dm]: [T; 2],
        force: T,
        equation: &mut EquationWorkspace<T>,
    ) -> T {
        let pushed = equation.stop_forces.iter();
        let pushed = pushed.fold(T::from_f64(0.0), |sum, force| sum + *force);
        let q_dot = equation.q_dot[0];
        let total = force + pushed - half_dm * q_dot * q_dot;
        let q_ddot = match equation.locked[0] {
            true => T::from_f64(0.0),
            false => total / m,
        };
        equation.q_ddot[0] = q_ddot;
        // What the actuator's coordinate takes, for a stop on which it rests and for impacts.
        equation.inverse_dynamics.tau[0] = m * q_ddot - total + pushed;
        equation.mass_matrix[0] = m;
        lu::factor(&mut equation.mass_matrix, &mut equation.pivots);
        let response = &mut equation.acceleration_responses[0];
        response.tau[0] = m;
        response.reactions.fill(T::from_f64(f64::NAN));
        q_ddot
    }
}

impl MovingModel for Model {
    type FitWindow = FitWindow;

    fn follows_functions(&self) -> bool {
        let mut joints = self.mechanism().joints.iter();
        joints.any(|joint| matches!(joint.kind, JointKind::Coupling(_)))
    }

    #[inline]
    fn offset_within(window: &FitWindow, q: f64) -> Option<f64> {
        window.offset_within(q)
    }

    /// As [`Machine::evaluate`] within the window of a fit.
    fn evaluate_on_fit<'a, T: Scalar>(
        machine: &'a Machine,
        (window, x): (&FitWindow, f64),
        (t, drive_states): (f64, &[T]),
        (input_offsets, inner): (&[T], &'a mut Workspace<T>),
        equation: &mut EquationWorkspace<T>,
    ) -> Result<ForceState<'a, T>> {
        let (fit, model) = (window.fit.as_ref(), &machine.model);
        let plan = model.plan();
        let new = || Box::new(FitWorkspace::new(model));
        let mut workspace = equation.fit_workspace.take().unwrap_or_else(new);
        let (q, q_dot) = (equation.q[0], equation.q_dot[0]);
        let x = q - T::from_f64(q.value() - x);
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        let polynomials = &fit.polynomials;
        polynomials.eval(x, &mut workspace.basis_values, &mut workspace.values);
        let set = |pose: &mut Pose<T>, motion: &mut Motion<T>| {
            workspace.set_pose(plan, &equation.q, pose);
            let FitWorkspace {
                values,
                unit_motion,
                unit_states,
                ..
            } = &mut *workspace;
            set_motion(values, [one, zero], unit_motion);
            unit_states.fill(plan, pose, unit_motion);
            set_motion(values, [q_dot, zero], motion);
        };
        let state = model.given_kinematic_state(&equation.q_dot, inner, set);
        let mut state = state.apply_loads(t)?;
        machine.evaluate_drives(t, drive_states, input_offsets, &mut state, equation)?;
        let mut state = state.wrenches()?;
        let unit_states = &workspace.unit_states;
        let unit_motion = |of| unit_states.coordinate(of);
        let inertia = machine.inertia_on_fit(model.inertia_sums(unit_states), q, unit_motion)?;
        let mut force = zero;
        for wrench in state.wrenches() {
            force += wrench.power(unit_states);
        }
        let q_ddot = machine.accelerate_on_fit(inertia, force, equation);
        let set = |motion: &mut Motion<T>| set_motion(&workspace.values, [q_dot, q_ddot], motion);
        state.bodies_with(set);
        machine.read_drive_accelerations(&state, equation);
        machine.set_net_drive_forces(&mut state, equation)?;
        equation.fit_workspace = Some(workspace);
        Ok(state)
    }

    /// A reaction that is not determined at the change point is NaN.
    fn outputs_on_fit<'o>(
        machine_state: &MachineState<'_>,
        (window, x): (&FitWindow, f64),
        output_model: &'o Model,
        workspace: &'o mut Workspace<f64>,
        result: &'o mut InverseDynamics<f64>,
    ) -> Result<EvaluatedState<'o>> {
        let fit = window.fit.as_ref();
        let (q_dot, q_ddot) = (
            &machine_state.equation.q_dot,
            &machine_state.equation.q_ddot,
        );
        result.tau.fill(0.0);
        let q = machine_state
            .equation
            .q
            .first()
            .copied()
            .unwrap_or(fit.center);
        let center = q - x;
        // Reactions are known worse than poses, and needed in the window alone.
        let fit_radius = fit.fit_radius.min(3.0 * fit.half_width);
        let (mut at, mut samples) = (Vec::new(), Vec::new());
        for (model, direction) in fit.branches.iter().zip([-1.0, 1.0]) {
            let (mut inner, mut branch_result) = (model.workspace(), model.result_buffer());
            for d in chebyshev_nodes(fit.half_width, fit_radius, REACTION_NODES) {
                let state = model.kinematic_state(&[center + direction * d], q_dot, &mut inner)?;
                let mut state = state.apply_loads(machine_state.t)?;
                for (load, one) in model.loads().iter().enumerate() {
                    if matches!(one.magnitude, Magnitude::External(_)) {
                        state.set_magnitude(load, machine_state.magnitudes()[load]);
                    }
                }
                state.evaluate(q_ddot, &mut branch_result)?;
                at.push(direction * d);
                samples.push(branch_result.reactions.clone());
            }
        }
        let reactions = PolynomialFit::new(&at, &samples, fit_radius, REACTION_DEGREE);
        let mut values = reactions.workspace();
        reactions.eval(x, &mut Vec::new(), &mut values);
        let branch_reactions = fit.branches[0].reactions();
        for (value, reaction) in result.reactions.iter_mut().zip(output_model.reactions()) {
            let index = branch_reactions.iter().position(|r| r == reaction);
            let determined = !fit.indeterminate.contains(reaction);
            *value = match index.filter(|_| determined) {
                Some(k) => values[k][0],
                None => f64::NAN,
            };
        }
        // The bodies and loads are as the machine has them.
        let set = |pose: &mut Pose<f64>, motion: &mut Motion<f64>| {
            pose.clone_from(machine_state.pose());
            motion.clone_from(machine_state.forces.motion());
        };
        Ok(output_model.given_state(q_dot, machine_state.magnitudes(), workspace, result, set)?)
    }
}
