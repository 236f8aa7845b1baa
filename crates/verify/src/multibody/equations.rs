//! Equation (1) at one instant.

use super::drives::rotor_inertia;
use super::friction::depends_on_reactions;
use super::state::MultibodyState;
use super::{MotionSample, MultibodyError, MultibodySystem, Result};
use crate::dense::{DenseMechanism, add_scaled};
use crate::pose::Pose;
use crate::wrenches::BodyWrench;
use faer::Mat;

/// The equations from a start on: gears meshed, rows chosen.
pub(super) struct MultibodyOde<'a> {
    pub(super) system: &'a MultibodySystem,
    pub(super) frames: DenseMechanism,
    /// The rows that are solved.
    pub(super) active_rows: Vec<usize>,
    /// The rows that must close.
    pub(super) candidate_rows: Vec<usize>,
}

/// The equations solved.
pub(super) struct MultibodySolution {
    /// ẏ of the state [x, v, states of the drives, work].
    pub(super) derivative: Vec<f64>,
    /// By row, actuators after reactions, the drives' (zero) after these.
    multipliers: Vec<f64>,
    drive_forces: Vec<f64>,
    state: MultibodyState,
}

/// All forces except those that depend on reactions, and the inertia.
struct AppliedForces {
    mass: Mat<f64>,
    force: Vec<f64>,
    /// Power of forces without a potential, W.
    power: f64,
    /// By drive: its action, and the rate of its state.
    drive_forces: Vec<f64>,
    drive_state_rates: Vec<f64>,
}

/// A state with the rows there.
struct EvaluationPoint<'a> {
    at: MultibodyState,
    poses: Vec<Pose>,
    v: &'a [f64],
    drive_states: &'a [f64],
    jacobian: Vec<f64>,
    velocity_products: Vec<f64>,
}

/// Accelerations, and multipliers by row.
type AugmentedSolution = (Vec<f64>, Vec<f64>);

impl MultibodyOde<'_> {
    /// Number of states.
    pub(super) fn dimension(&self) -> usize {
        2 * self.frames.rows.columns() + self.system.drives.len() + 1
    }

    fn state_of(&self, t: f64, poses: &[Pose], v: &[f64]) -> MultibodyState {
        let [poses, velocities] = self.frames.to_frames(poses, v);
        MultibodyState {
            t,
            poses,
            velocities,
        }
    }

    /// Adds forces on bodies to those on the coordinates.
    fn add_wrenches(&self, wrenches: &[BodyWrench], poses: &[Pose], force: &mut [f64]) {
        let wrenches = self.frames.shifted_wrenches(wrenches);
        self.frames.add_wrenches(poses, &wrenches, 1.0, force);
    }

    /// The masses without any force but −½ I′ ω² of varying moments of inertia, at coordinates and speeds.
    fn assemble_masses(&self, poses: &[Pose], v: &[f64]) -> AppliedForces {
        let n = self.frames.rows.columns();
        let (mut mass, mut force) = (Mat::zeros(n, n), vec![0.0; n]);
        for (b, body) in self.frames.moving_bodies() {
            let (of, angle) = (&self.system.masses[b], poses[b].angle);
            let c = body.columns.range().start;
            mass[(c, c)] = of.mass;
            mass[(c + 1, c + 1)] = of.mass;
            mass[(c + 2, c + 2)] = of.inertia + body.varying_inertia(angle);
            force[c + 2] = -body.varying_moment(angle, v[c + 2], 0.0).z;
        }
        AppliedForces {
            mass,
            force,
            power: 0.0,
            drive_forces: vec![],
            drive_state_rates: vec![],
        }
    }

    /// Adds all loads except those that depend on reactions; `None` if a magnitude cannot be evaluated.
    fn add_loads(&self, point: &EvaluationPoint<'_>, to: &mut AppliedForces) -> Option<()> {
        let at = &point.at;
        for (i, load) in self.system.loads.iter().enumerate() {
            if depends_on_reactions(&load.magnitude) {
                continue;
            }
            let magnitude = self.system.magnitude(&load.magnitude, at)?;
            let wrenches = self.system.wrenches(i, magnitude, at);
            self.add_wrenches(&wrenches, &point.poses, &mut to.force);
            if !load.is_conservative() {
                to.power += at.power(&wrenches);
            }
        }
        Some(())
    }

    /// All drives: the rotors' inertia I on s̈ = J ẍ + Φ̇ₓ ẋ joins the masses as Jᵀ I J.
    fn add_drives(&self, point: &EvaluationPoint<'_>, to: &mut AppliedForces) -> Option<()> {
        let at = &point.at;
        let n = self.frames.rows.columns();
        for (d, drive) in self.system.drives.iter().enumerate() {
            let row = self.frames.actuator_row() + self.system.modes.len() + d;
            let velocity = self.frames.row_velocity(&point.jacobian, row, point.v);
            let state = point.drive_states[d];
            let [force, state_rate] = self.system.drive_output(&drive.kind, velocity, state, at)?;
            let inertia = rotor_inertia(&drive.kind);
            let jacobian_row = &point.jacobian[row * n..][..n];
            let net_force = force - inertia * point.velocity_products[row];
            add_scaled(&mut to.force, net_force, jacobian_row);
            for (i, a) in jacobian_row.iter().enumerate() {
                for (j, b) in jacobian_row.iter().enumerate() {
                    to.mass[(i, j)] += inertia * a * b;
                }
            }
            to.power += force * velocity;
            to.drive_forces.push(force);
            to.drive_state_rates.push(state_rate);
        }
        Some(())
    }

    /// Solves (1) at a state [x, v, states of the drives, work].
    pub(super) fn solve(&self, t: f64, y: &[f64]) -> Result<MultibodySolution> {
        let frames = &self.frames;
        let n = frames.rows.columns();
        let not_finite = MultibodyError::NotFinite(t);
        if y.iter().any(|y| !y.is_finite()) {
            return Err(not_finite);
        }
        let (x, v) = (&y[..n], &y[n..2 * n]);
        let poses = frames.poses_of(x);
        let mut applied = self.assemble_masses(&poses, v);
        let point = EvaluationPoint {
            at: self.state_of(t, &poses, v),
            v,
            drive_states: &y[2 * n..],
            jacobian: frames.rows.jacobian(&poses),
            velocity_products: frames.rows.velocity_products(&poses, v),
            poses,
        };
        self.add_loads(&point, &mut applied).ok_or(not_finite)?;
        self.add_drives(&point, &mut applied).ok_or(not_finite)?;
        let (a, multipliers) = self.solve_with_friction(&point, &mut applied)?;
        let velocities = &self.prescribed_values(t)[1];
        let rates = multipliers.iter().zip(velocities);
        for (tau, velocity) in rates.skip(frames.actuator_row()) {
            applied.power += tau * velocity;
        }
        let derivative = [v, &a, &applied.drive_state_rates, &[applied.power]].concat();
        if derivative.iter().any(|r| !r.is_finite()) {
            return Err(not_finite);
        }
        Ok(MultibodySolution {
            derivative,
            multipliers,
            drive_forces: applied.drive_forces,
            state: point.at,
        })
    }

    /// Accelerations and multipliers under all forces, with the frictions.
    fn solve_with_friction(
        &self,
        point: &EvaluationPoint<'_>,
        applied: &mut AppliedForces,
    ) -> Result<AugmentedSolution> {
        let at = &point.at;
        let not_finite = MultibodyError::NotFinite(at.t);
        let frictions = self.system.frictions();
        let mut forces = vec![std::mem::take(&mut applied.force)];
        for &load in &frictions {
            let mut unit = vec![0.0; self.frames.rows.columns()];
            self.add_wrenches(
                &self.system.wrenches(load, 1.0, at),
                &point.poses,
                &mut unit,
            );
            forces.push(unit);
        }
        let found = self.solve_augmented(&applied.mass, point, &forces)?;
        let mut found = found.into_iter();
        let (mut a, mut multipliers) = found.next().ok_or(not_finite)?;
        let (unit_accelerations, unit_reactions): (Vec<_>, Vec<_>) = found.unzip();
        let friction_forces = self.solve_friction(&frictions, &multipliers, &unit_reactions, at)?;
        for (k, force) in friction_forces.into_iter().enumerate() {
            add_scaled(&mut a, force, &unit_accelerations[k]);
            add_scaled(&mut multipliers, force, &unit_reactions[k]);
            applied.power += at.power(&self.system.wrenches(frictions[k], force, at));
        }
        Ok((a, multipliers))
    }

    /// Accelerations and multipliers for several forces, the first with the prescribed accelerations of the
    /// rows, the others with none.
    fn solve_augmented(
        &self,
        mass: &Mat<f64>,
        point: &EvaluationPoint<'_>,
        forces: &[Vec<f64>],
    ) -> Result<Vec<AugmentedSolution>> {
        let (frames, t) = (&self.frames, point.at.t);
        let (n, m) = (frames.rows.columns(), self.active_rows.len());
        let scale = |c| frames.column_scale(c);
        let scaled = |i: usize, j: usize| mass[(i, j)] * scale(i) * scale(j);
        // Kilograms of the size of one, as the rows are.
        let largest = (0..n).map(|i| scaled(i, i)).fold(0.0, f64::max);
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let mut right = Mat::zeros(n + m, forces.len());
        for (k, force) in forces.iter().enumerate() {
            for (c, force) in force.iter().enumerate() {
                right[(c, k)] = force * scale(c) / unit;
            }
        }
        let prescribed_accelerations = &self.prescribed_values(t)[2];
        for (k, &row) in self.active_rows.iter().enumerate() {
            let acceleration = prescribed_accelerations[row] - point.velocity_products[row];
            right[(n + k, 0)] = acceleration * frames.row_scale[row];
        }
        let matrix = |i, j| scaled(i, j) / unit;
        self.solve_bordered(matrix, &point.jacobian, &mut right, t)?;
        let solution = |k: usize| {
            let a = (0..n).map(|c| right[(c, k)] * scale(c)).collect();
            let mut multipliers = vec![0.0; frames.rows.len()];
            for (i, &row) in self.active_rows.iter().enumerate() {
                multipliers[row] = -right[(n + i, k)] * frames.row_scale[row] * unit;
            }
            (a, multipliers)
        };
        Ok((0..forces.len()).map(solution).collect())
    }

    /// The sample of a state.
    pub(super) fn sample(&self, t: f64, y: &[f64]) -> Result<MotionSample> {
        let mut solution = self.solve(t, y)?;
        let [kinetic, potential] = self.system.energies(&solution.state);
        let mut tau = solution.multipliers.split_off(self.frames.actuator_row());
        tau.truncate(self.system.modes.len());
        Ok(MotionSample {
            t,
            poses: solution.state.poses,
            velocities: solution.state.velocities,
            reactions: solution.multipliers,
            tau,
            drive_forces: solution.drive_forces,
            kinetic,
            potential,
            work: y.last().copied().unwrap_or(0.0),
        })
    }
}
