//! A machine in space across the change points in its range: within a window about each, its branch is a fit, and (1) of
//! [`crate::change_point_fit`] is its equation of motion. Beyond a change point the branch is that of the same plan.

use super::workspace::EquationWorkspace;
use super::{Machine, MachineState, MovingModel};
use crate::change_point_fit::{ChangePointFitError, farthest_good_fit, half_width_of_groups};
use crate::error::Result;
use dwell_geometry::PositionError;
use dwell_geometry::space::{BranchFit, BranchFitWorkspace, ChangePoint};
use dwell_kinetostatics::space::{Model, Workspace};
use dwell_kinetostatics::{EvaluatedState, ForceState, InverseDynamics, MachineModel as _};
use dwell_numerics::Scalar;
use std::sync::Arc;

/// Largest half-width as a fraction of the distance to the next change point, or to the end of the range.
const FREE_PART: f64 = 0.45;

/// The interval of the coordinate about a change point in which a fit replaces the model.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceFitWindow {
    /// The change point.
    pub at: ChangePoint,
    /// Half the window, rad or m.
    pub half_width: f64,
    /// The period after which the branch repeats itself, rad.
    period: Option<f64>,
    /// The fit, or why there is none: then no motion passes.
    pub fit: Result<Arc<BranchFit>, ChangePointFitError>,
}

impl SpaceFitWindow {
    /// The period after which the branch repeats itself, rad.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// Whether a coordinate is within it.
    pub fn contains(&self, q: f64) -> bool {
        self.offset(q).abs() <= self.half_width
    }

    fn offset(&self, q: f64) -> f64 {
        let x = q - self.at.q;
        x - self
            .period
            .map_or(0.0, |period| period * (x / period).round())
    }

    /// The fit; an error where there is none.
    fn fit(&self) -> Result<&BranchFit> {
        match &self.fit {
            Ok(fit) => Ok(fit),
            Err(_) => Err(PositionError::Singular {
                group: self.at.group,
                q: self.at.q,
                relative_determinant: 0.0,
            }
            .into()),
        }
    }
}

impl Machine<Model> {
    /// This machine with fits across the change points of its only coordinate, for integrations to a tolerance.
    #[must_use]
    pub fn with_change_points(mut self, tolerance: f64) -> Self {
        self.fit_windows.clear();
        if self.modes.len() != 1 || self.free.len() != 1 {
            return self;
        }
        let plan = self.model.plan();
        let unit = if plan.is_angle(0) { 1.0 } else { plan.size() };
        let groups = plan.described_groups().len();
        let half_width = unit * half_width_of_groups(groups, tolerance);
        let all = plan.change_points().to_vec();
        let window = |&at: &ChangePoint| SpaceFitWindow {
            at,
            half_width,
            period: plan.range().period(),
            fit: match self.model.frictions().len() {
                0 => fit_across(&self.model, at.q, [half_width, unit]).map(Arc::new),
                _ => Err(ChangePointFitError::Friction),
            },
        };
        self.fit_windows = all.iter().map(window).collect();
        self
    }

    /// The windows of its change points.
    pub fn change_point_windows(&self) -> &[SpaceFitWindow] {
        &self.fit_windows
    }
}

/// The branch across a change point: the farthest of the good fits.
fn fit_across(
    model: &Model,
    q: f64,
    [half_width, unit]: [f64; 2],
) -> Result<BranchFit, ChangePointFitError> {
    let plan = model.plan();
    let others = plan.change_points().iter().map(|other| other.q);
    let ends = plan
        .range()
        .limits()
        .into_iter()
        .flat_map(|(from, to)| [from, to]);
    let period = plan.range().period();
    let distance = |other: f64| {
        let x = (other - q).abs();
        period.map_or(x, |period| x.min(period - x))
    };
    let free = others.filter(|other| *other != q).chain(ends).map(distance);
    let largest = FREE_PART * free.fold(period.unwrap_or(f64::INFINITY), f64::min);
    let scales = [half_width, unit];
    let (.., fit) = farthest_good_fit(scales, largest, |radius| {
        let fit = plan.fit_branch(q, [half_width, radius])?;
        Ok((gap(model, &fit, q, scales)?, fit))
    })?;
    Ok(fit)
}

/// The largest gap between a fit and the plan at the window's ends, in the velocities and accelerations of all bodies at unit speed, of
/// points over the size.
fn gap(
    model: &Model,
    fit: &BranchFit,
    center: f64,
    [half_width, unit]: [f64; 2],
) -> Result<f64, PositionError> {
    let plan = model.plan();
    let (mut memory, mut largest) = (BranchFitWorkspace::default(), 0.0_f64);
    let [mut pose, mut fitted] = [plan.pose::<f64>(), plan.pose::<f64>()];
    for x in [-half_width, half_width] {
        let q = center + x;
        plan.positions(&[q], &mut pose)?;
        plan.velocities(&[1.0], &mut pose);
        plan.accelerations(&[0.0], &mut pose);
        plan.set_on_fit(fit, [q, x], [1.0, 0.0], &mut memory, &mut fitted);
        for b in 0..model.mechanism().bodies.len() {
            let [one, other] = [&pose, &fitted].map(|pose| plan.state(pose, b));
            let by_size = unit / plan.size();
            let differences = [
                (one.velocity - other.velocity).norm() * by_size,
                (one.angular_velocity - other.angular_velocity).norm() * unit,
                (one.acceleration - other.acceleration).norm() * by_size * unit,
                (one.angular_acceleration - other.angular_acceleration).norm() * unit * unit,
            ];
            largest = differences.iter().fold(largest, |max, d| max.max(*d));
        }
    }
    Ok(largest)
}

impl MovingModel for Model {
    type FitWindow = SpaceFitWindow;

    #[inline]
    fn offset_within(window: &SpaceFitWindow, q: f64) -> Option<f64> {
        let x = window.offset(q);
        (x.abs() <= window.half_width).then_some(x)
    }

    fn evaluate_on_fit<'a, T: Scalar>(
        machine: &'a Machine<Self>,
        (window, x): (&SpaceFitWindow, f64),
        (t, drive_states): (f64, &[T]),
        (input_offsets, inner): (&[T], &'a mut Workspace<T>),
        equation: &mut EquationWorkspace<T>,
    ) -> Result<ForceState<'a, T, Self>> {
        let (fit, model) = (window.fit()?, &machine.model);
        let (q, q_dot) = (equation.q[0], equation.q_dot[0]);
        let at = [q, q - T::from_f64(q.value() - x)];
        let bodies = model.inertia_on_fit(fit, at, inner);
        let unit_motion = |of| model.coordinate_motion(of, inner);
        let inertia = machine.inertia_on_fit(bodies, q, unit_motion)?;
        let state = model.state_on_fit(fit, at, q_dot, inner);
        let mut state = state.apply_loads(t)?;
        machine.evaluate_drives(t, drive_states, input_offsets, &mut state, equation)?;
        let mut state = state.wrenches()?;
        let q_ddot = machine.accelerate_on_fit(inertia, state.unit_power(), equation);
        state.accelerate_on_fit(fit, at, [q_dot, q_ddot]);
        machine.read_drive_accelerations(&state, equation);
        machine.set_net_drive_forces(&mut state, equation)?;
        Ok(state)
    }

    /// No reaction has a value there.
    fn outputs_on_fit<'o>(
        state: &MachineState<'_, f64, Self>,
        (window, x): (&SpaceFitWindow, f64),
        output_model: &'o Self,
        workspace: &'o mut Workspace<f64>,
        result: &'o mut InverseDynamics<f64>,
    ) -> Result<EvaluatedState<'o, f64, Self>> {
        let equation = &*state.equation;
        result.tau.fill(0.0);
        result.reactions.fill(f64::NAN);
        let at = (window.fit()?, [equation.q[0], x]);
        let rates = [equation.q_dot[0], equation.q_ddot[0]];
        let magnitudes = state.magnitudes();
        Ok(output_model.given_on_fit(at, rates, magnitudes, workspace, result)?)
    }
}
