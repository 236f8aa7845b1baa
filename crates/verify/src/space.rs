//! A mechanism in space: its states, solved by the dense equations in body coordinates,
//!
//! ```text
//! J ẋ = D q̇,     J ẍ = D q̈ − J̇ẋ,     Jᵀ [λ; τ] = M ẍ + h − f,     x = [r; θ] of each body              (1)
//! ```
//!
//! by singular values of all rows, which show redundant constraints and idle rotations.

mod energy;
mod forces;
mod friction;
mod joints;

pub use forces::load_wrenches;
pub use joints::{closure_error, mesh_error};

use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::pose::{Columns, Pose, centripetal};
use dwell_geometry::space::{BodyMotion, Mechanism, Placement, Vec3, Wrench};
use dwell_kinetostatics::space::{LoadKind, Mass};
use faer::Mat;
use faer::linalg::solvers::Svd;

/// Singular values this small against the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;
/// A part of a self-stress of length one from which on a component is not determined.
const STRESS: f64 = 1e-7;

/// Motion, forces and ranks at a pose.
#[derive(Debug, Clone)]
pub struct DenseSpace {
    /// By body.
    pub motions: Vec<BodyMotion>,
    /// By actuator, N·m or N.
    pub actuator_actions: Vec<f64>,
    /// By joint: the action of the first body on the second, about the joint's point on the second.
    pub reactions: Vec<Wrench>,
    /// By joint: for force and moment in the axes of the ground, whether the loads determine them.
    pub determined: Vec<[bool; 6]>,
    /// Freedoms that are left with all actuators held: idle rotations.
    pub idle_freedoms: usize,
    /// Constraints that are too many.
    pub redundant_count: usize,
    /// The residuals of J ẋ = D q̇, of the equation for J ẍ and of the balance, relative to the largest term.
    pub residuals: [f64; 3],
}

impl DenseSpace {
    /// Solves (1) at given placements of all bodies, for speeds and accelerations of the actuators (rad or m, per s and s²), under
    /// loads with their magnitudes. Idle rotations stand still.
    ///
    /// # Errors
    /// [`DenseError`] where the equations have no singular values.
    pub fn new(
        mechanism: &Mechanism,
        masses: &[Mass],
        placements: &[Placement],
        rates: [&[f64]; 2],
        loads: &[(LoadKind, f64)],
    ) -> Result<Self> {
        Ok(DensePose::new(mechanism, masses, placements)?.solve(rates, loads))
    }
}

/// The equations (1) of a pose with their singular values: for any motion there, and any loads.
pub struct DensePose<'a> {
    mechanism: &'a Mechanism,
    masses: &'a [Mass],
    placements: &'a [Placement],
    dense: DenseMechanism,
    poses: Vec<Pose>,
    system: System,
}

impl<'a> DensePose<'a> {
    /// The equations at placements of all bodies.
    ///
    /// # Errors
    /// [`DenseError`] if they have no singular values.
    pub fn new(
        mechanism: &'a Mechanism,
        masses: &'a [Mass],
        placements: &'a [Placement],
    ) -> Result<Self> {
        let dense = DenseMechanism::in_space(mechanism, masses, &[])?;
        let poses = dense.moved_frames(&Pose::all_in_space(placements))?;
        Ok(Self {
            system: System::new(&dense, &poses)?,
            mechanism,
            masses,
            placements,
            dense,
            poses,
        })
    }

    /// The velocities of all bodies at speeds of the actuators.
    pub fn velocities(&self, q_dot: &[f64]) -> Vec<BodyMotion> {
        let x_dot = self.rates(q_dot, &vec![0.0; self.dense.rows.len()]).0;
        self.motions([&x_dot, &vec![0.0; x_dot.len()]])
    }

    /// ẋ or ẍ from the rates of the actuators and J̇ẋ, and the residual.
    fn rates(&self, of_actuators: &[f64], biases: &[f64]) -> (Vec<f64>, f64) {
        let mut right: Vec<f64> = biases.iter().map(|bias| -bias).collect();
        let actuators = &mut right[self.dense.actuator_row()..];
        actuators
            .iter_mut()
            .zip(of_actuators)
            .for_each(|(row, rate)| *row += rate);
        let (scaled, residual) = self.system.solve(&self.dense, &right);
        let x = scaled.iter().enumerate();
        (
            x.map(|(c, x)| x * self.dense.column_scale(c)).collect(),
            residual,
        )
    }

    /// The motions of the given frames, from those of the moved frames.
    fn motions(&self, [x_dot, x_ddot]: [&[f64]; 2]) -> Vec<BodyMotion> {
        let bodies = self.dense.bodies.iter().zip(&self.poses);
        let motion = bodies.map(|(body, pose)| {
            let [first, second] = [x_dot, x_ddot].map(|x| body.columns.twist(x));
            let (arm, w) = (-pose.rotation.apply(body.shift), first.angular);
            match body.columns {
                Columns::Fixed => BodyMotion::default(),
                _ => BodyMotion {
                    velocity: first.at(arm),
                    angular_velocity: w,
                    acceleration: second.at(arm) + centripetal(w, arm),
                    angular_acceleration: second.angular,
                },
            }
        });
        motion.collect()
    }

    /// Motion and forces at speeds and accelerations of the actuators, under loads with their magnitudes.
    pub fn solve(&self, [q_dot, q_ddot]: [&[f64]; 2], loads: &[(LoadKind, f64)]) -> DenseSpace {
        let (dense, system) = (&self.dense, &self.system);
        let (x_dot, first) = self.rates(q_dot, &vec![0.0; dense.rows.len()]);
        let biases = dense.rows.velocity_products(&self.poses, &x_dot);
        let (x_ddot, second) = self.rates(q_ddot, &biases);
        let motions = self.motions([&x_dot, &x_ddot]);
        let inertia = dense.inertia_wrenches(&self.poses, [&x_dot, &x_ddot]);
        let bodies = (self.mechanism, self.masses, self.placements);
        let wrenches = load_wrenches(bodies, &motions, loads);
        let loads = dense.shifted_wrenches(&wrenches);
        let mut required = vec![0.0; dense.rows.columns()];
        dense.add_wrenches(
            &self.poses,
            inertia.iter().chain(&loads),
            -1.0,
            &mut required,
        );
        let (multipliers, third) = system.multipliers(dense, &required);
        let stresses: Vec<Vec<f64>> = system.stresses(dense).collect();
        let of_joints = |multipliers: &[f64]| -> Vec<[f64; 6]> {
            let joints = dense.joints.iter();
            let wrench = joints.map(|joint| dense.joint_wrench(joint, &self.poses, multipliers));
            wrench.collect()
        };
        let stresses: Vec<Vec<[f64; 6]>> =
            stresses.iter().map(|stress| of_joints(stress)).collect();
        let is_determined = |j: usize, k: usize| {
            let arm = if k < 3 { 1.0 } else { 1.0 / dense.size() };
            stresses
                .iter()
                .all(|stress| (stress[j][k] * arm).abs() < STRESS)
        };
        let determined = |j: usize| std::array::from_fn(|k| is_determined(j, k));
        DenseSpace {
            actuator_actions: multipliers[dense.actuator_row()..][..dense.actuators.len()].to_vec(),
            idle_freedoms: system.idle,
            redundant_count: system.matrix.nrows() - system.rank,
            residuals: [first, second, third],
            motions,
            reactions: of_joints(&multipliers).into_iter().map(wrench).collect(),
            determined: (0..dense.joints.len()).map(determined).collect(),
        }
    }
}

fn wrench([x, y, z, a, b, c]: [f64; 6]) -> Wrench {
    use dwell_geometry::space::vec3;
    Wrench {
        force: vec3(x, y, z),
        moment: vec3(a, b, c),
    }
}

/// By joint: the action of its first body on the second, including that of actuators, as a point of the ground with the force and the
/// couple there. The opposite acts on the first.
pub fn joint_actions(
    mechanism: &Mechanism,
    placements: &[Placement],
    reactions: &[Wrench],
    tau: &[f64],
) -> Vec<(Vec3, Wrench)> {
    use dwell_geometry::space::ActuatorKind;
    let of_joint = |(j, reaction): (usize, &Wrench)| {
        let joint = &mechanism.joints[j];
        let side = |k: usize, v: Vec3| placements[joint.side_body(k).0].rotation.apply(v);
        let point =
            |k: usize| placements[joint.side_body(k).0].position + side(k, joint.sides[k].point);
        let (at, mut wrench) = (point(1), *reaction);
        let actuators = mechanism.actuators.iter().zip(tau);
        for (actuator, tau) in actuators.filter(|(a, _)| a.kind.joint().0 == j) {
            let axis = side(0, joint.sides[0].axis);
            match actuator.kind {
                ActuatorKind::Angle(_) => wrench.moment += axis.scaled(*tau),
                ActuatorKind::Travel(_) => wrench.force += axis.scaled(*tau),
                ActuatorKind::Length(_) => {
                    let along = at - point(0);
                    wrench.force += along.scaled(tau / along.norm());
                }
            }
        }
        (at, wrench)
    };
    reactions.iter().enumerate().map(of_joint).collect()
}

/// R J C with rows that hold idle rotations, and its singular values.
struct System {
    matrix: Mat<f64>,
    svd: Svd<f64>,
    rank: usize,
    idle: usize,
}

impl System {
    fn new(dense: &DenseMechanism, poses: &[Pose]) -> Result<Self> {
        let first = dense.scaled_jacobian(poses);
        let (rows, columns) = first.shape();
        let svd = singular_values(&first)?;
        let idle = columns - rank(&svd).min(columns);
        // An idle rotation stands still: the body that turns in it does not turn about its line.
        let mut matrix = Mat::zeros(rows + idle, columns);
        matrix.as_mut().subrows_mut(0, rows).copy_from(&first);
        for k in 0..idle {
            let null: Vec<f64> = svd.V().col(columns - 1 - k).iter().copied().collect();
            let turning = |body: &Columns| body.twist(&null).angular.norm();
            let bodies = dense.bodies.iter().map(|body| body.columns);
            if let Some(body) = bodies.max_by(|a, b| turning(a).total_cmp(&turning(b))) {
                let moment = body.twist(&null).angular;
                let row = crate::rows::terms::couple(moment);
                let mut line = vec![0.0; columns];
                body.add(&row, 1.0, &mut line);
                (0..columns).for_each(|c| matrix[(rows + k, c)] = line[c]);
            }
        }
        let svd = singular_values(&matrix)?;
        Ok(Self {
            rank: rank(&svd),
            matrix,
            svd,
            idle,
        })
    }

    /// The solution of least norm of the scaled rows, and the residual relative to the largest term.
    fn solve(&self, dense: &DenseMechanism, right: &[f64]) -> (Vec<f64>, f64) {
        let scaled = |i: usize| right.get(i).map_or(0.0, |r| r * dense.row_scale[i]);
        let right = Mat::from_fn(self.matrix.nrows(), 1, |i, _| scaled(i));
        let x = self.pseudo_inverse(&right, false);
        let residual = &self.matrix * &x - &right;
        (column(&x), relative(&residual, &right))
    }

    /// The multipliers for the required forces of the bodies, and the unbalanced remainder.
    fn multipliers(&self, dense: &DenseMechanism, required: &[f64]) -> (Vec<f64>, f64) {
        let scaled = |c: usize| required[c] * dense.column_scale(c);
        let right = Mat::from_fn(required.len(), 1, |c, _| scaled(c));
        let multipliers = self.pseudo_inverse(&right, true);
        let residual = self.matrix.transpose() * &multipliers - &right;
        let of_rows = column(&multipliers).into_iter().zip(&dense.row_scale);
        let unscaled = of_rows
            .map(|(multiplier, scale)| multiplier * scale)
            .collect();
        (unscaled, relative(&residual, &right))
    }

    /// Self-stresses: multipliers that balance without loads.
    fn stresses(&self, dense: &DenseMechanism) -> impl Iterator<Item = Vec<f64>> {
        (self.rank..self.matrix.nrows()).map(move |k| {
            let stress = self.svd.U().col(k).iter().zip(&dense.row_scale);
            stress.map(|(part, scale)| part * scale).collect()
        })
    }

    /// The smallest solution of least squares, of the matrix or of its transpose.
    fn pseudo_inverse(&self, right: &Mat<f64>, transposed: bool) -> Mat<f64> {
        let (u, v) = (self.svd.U(), self.svd.V());
        let (from, to) = if transposed { (v, u) } else { (u, v) };
        let (part, values) = (from.transpose() * right, self.svd.S().column_vector());
        let mut scaled = Mat::zeros(to.ncols(), 1);
        for k in 0..self.rank {
            scaled[(k, 0)] = part[(k, 0)] / values[k];
        }
        to * &scaled
    }
}

fn column(matrix: &Mat<f64>) -> Vec<f64> {
    (0..matrix.nrows()).map(|i| matrix[(i, 0)]).collect()
}

/// The largest number against the largest of another.
fn relative(residual: &Mat<f64>, right: &Mat<f64>) -> f64 {
    let largest = |m: &Mat<f64>| column(m).into_iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    match largest(right) {
        0.0 => largest(residual),
        scale => largest(residual) / scale,
    }
}

fn singular_values(matrix: &Mat<f64>) -> Result<Svd<f64>> {
    matrix.svd().map_err(|_| DenseError::Singular(f64::NAN))
}

fn rank(svd: &Svd<f64>) -> usize {
    let values = svd.S().column_vector();
    let largest = values.iter().fold(0.0_f64, |a, b| a.max(*b));
    values
        .iter()
        .filter(|v| **v > RANK_TOLERANCE * largest)
        .count()
}
