//! The dense equations of a mechanism in space, in other coordinates than a plan's: velocity and angular velocity of each body,
//!
//! ```text
//! J ẋ = D q̇,     J ẍ = D q̈ − J̇ẋ,     Jᵀ [λ; τ] = M ẍ + h − f,     x = [r; θ] of each body              (1)
//! ```
//!
//! by singular values of the whole, so that redundant constraints and idle rotations are seen as what they are. The rows are
//! products of directions and distances, for directions u, w fixed in the first and second body and d from its point to that of
//! the second,
//!
//! ```text
//! e·d = 0,    u·d = 0,    u·w = 0,    (d·d − L²)/2L = 0,    u·d − h θ = 0                                   (2)
//! ```
//!
//! and, of gear pairs, velocities of the wheels at the pitch point.

mod balances;
mod branch;
mod closing;
mod differences;
mod energy;
mod forces;
mod friction;
mod rows;
mod state;

pub use balances::joint_actions;
pub use branch::check_branch_in_space;
pub use energy::{kinetic_energy, potential_energy};
pub use friction::{sliding_in_space, with_friction_in_space};
pub use rows::{closure_error, mesh_error};
pub use state::{SpaceCase, SpaceState, SpaceSubject, check_states_in_space};

use crate::error::{DenseError, Result};
use dwell_geometry::JointId;
use dwell_geometry::space::{
    ActuatorKind, BodyMotion, Joint, Mechanism, Placement, Vec3, Wrench, vec3,
};
use dwell_kinetostatics::space::{LoadKind, Mass};
use faer::Mat;
use faer::linalg::solvers::Svd;
use rows::{Bodies, Gradient, Row, couple};
use std::borrow::Cow;

/// Singular values this small against the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;

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
    /// What of J ẋ = D q̇, of J ẍ and of the balance is not met, relative to the largest part.
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
        [q_dot, q_ddot]: [&[f64]; 2],
        loads: &[(LoadKind, f64)],
    ) -> Result<Self> {
        let pose = DensePose::new(mechanism, placements)?;
        Ok(pose.solve(masses, [q_dot, q_ddot], loads))
    }
}

/// The equations (1) of a pose with their singular values: for any motion there, and any loads.
pub struct DensePose<'a> {
    mechanism: &'a Mechanism,
    placements: Cow<'a, [Placement]>,
    system: System,
}

impl<'a> DensePose<'a> {
    /// The equations at placements of all bodies.
    ///
    /// # Errors
    /// [`DenseError`] where they have no singular values.
    pub fn new(mechanism: &'a Mechanism, placements: &'a [Placement]) -> Result<Self> {
        Self::at(mechanism, Cow::Borrowed(placements))
    }

    fn at(mechanism: &'a Mechanism, placements: Cow<'a, [Placement]>) -> Result<Self> {
        Ok(Self {
            system: System::new(&Bodies::at_rest(mechanism, &placements))?,
            mechanism,
            placements,
        })
    }

    /// The velocities of all bodies at speeds of the actuators.
    pub fn velocities(&self, q_dot: &[f64]) -> Vec<BodyMotion> {
        self.moving(q_dot).0.motions
    }

    /// The bodies with their velocities, and what is not met.
    fn moving(&self, q_dot: &[f64]) -> (Bodies<'_>, f64) {
        let mut bodies = Bodies::at_rest(self.mechanism, &self.placements);
        let (velocity, residual) = self.system.solve(q_dot, &vec![0.0; self.system.rows]);
        bodies.set(&velocity, |motion| {
            (&mut motion.velocity, &mut motion.angular_velocity)
        });
        (bodies, residual)
    }

    /// Motion and forces at speeds and accelerations of the actuators, under loads with their magnitudes.
    pub fn solve(
        &self,
        masses: &[Mass],
        [q_dot, q_ddot]: [&[f64]; 2],
        loads: &[(LoadKind, f64)],
    ) -> DenseSpace {
        let (mechanism, system) = (self.mechanism, &self.system);
        let (mut bodies, first) = self.moving(q_dot);
        let (acceleration, second) = system.solve(q_ddot, &bodies.biases());
        bodies.set(&acceleration, |motion| {
            (&mut motion.acceleration, &mut motion.angular_acceleration)
        });
        let required = bodies.required(masses, loads);
        let (multipliers, third) = system.multipliers(&required);
        let (reactions, determined) = bodies.reactions(system, &multipliers);
        DenseSpace {
            actuator_actions: multipliers[system.constraints..][..mechanism.actuators.len()]
                .to_vec(),
            idle_freedoms: system.idle,
            redundant_count: system.redundant_count(),
            residuals: [first, second, third],
            motions: bodies.motions,
            reactions,
            determined,
        }
    }
}

/// J with the rows of the actuators and of idle rotations, and its singular values.
struct System {
    matrix: Mat<f64>,
    svd: Svd<f64>,
    rank: usize,
    /// Rows of the joints, and of everything.
    constraints: usize,
    rows: usize,
    idle: usize,
    /// By joint: its rows.
    of_joint: Vec<std::ops::Range<usize>>,
    /// By row of a joint: its gradient by the second body.
    on_second: Vec<Gradient>,
}

impl System {
    fn new(bodies: &Bodies<'_>) -> Result<Self> {
        let (rows, of_joint) = bodies.all_rows();
        let constraints = of_joint.last().map_or(0, |r| r.end);
        let columns = 6 * bodies.placements.len();
        let mut matrix = Mat::zeros(rows.len() + 6, columns);
        for (i, row) in rows.iter().enumerate() {
            for (body, gradient) in row.bodies.into_iter().zip(row.gradients) {
                add(&mut matrix, i, body, gradient);
            }
        }
        // The ground does not move.
        for k in 0..6 {
            matrix[(rows.len() + k, 6 * bodies.mechanism.ground + k)] = 1.0;
        }
        let svd = singular_values(&matrix)?;
        let idle = columns - rank(&svd);
        // An idle rotation stands still: the body that turns in it does not turn about its line.
        let (fixed, first) = (matrix.nrows(), matrix);
        let mut matrix = Mat::zeros(fixed + idle, columns);
        matrix.as_mut().subrows_mut(0, fixed).copy_from(&first);
        for k in 0..idle {
            let null = svd.V().col(columns - 1 - k);
            let turning = |b: usize| vec3(null[6 * b + 3], null[6 * b + 4], null[6 * b + 5]);
            let size = |b: &usize| turning(*b).norm();
            let all = 0..bodies.placements.len();
            if let Some(body) = all.max_by(|a, b| size(a).total_cmp(&size(b))) {
                add(&mut matrix, fixed + k, body, couple(turning(body)));
            }
        }
        let svd = singular_values(&matrix)?;
        let on_second = rows[..constraints].iter().map(|row| row.gradients[1]);
        Ok(Self {
            rank: rank(&svd),
            rows: matrix.nrows(),
            matrix,
            svd,
            constraints,
            idle,
            of_joint,
            on_second: on_second.collect(),
        })
    }

    /// The constraints that are too many.
    fn redundant_count(&self) -> usize {
        self.rows - self.rank
    }

    /// Right-hand sides of the rows, less those.
    fn opposite(&self, of_rows: &[f64]) -> Mat<f64> {
        Mat::from_fn(self.rows, 1, |i, _| of_rows.get(i).map_or(0.0, |row| -row))
    }

    /// ẋ or ẍ from the rates of the actuators and J̇ẋ, and what is not met.
    fn solve(&self, rates: &[f64], biases: &[f64]) -> (Vec<f64>, f64) {
        let mut right = self.opposite(biases);
        for (k, rate) in rates.iter().enumerate() {
            right[(self.constraints + k, 0)] += rate;
        }
        let x = self.pseudo_inverse(&right, false);
        let residual = &self.matrix * &x - &right;
        (column(&x), relative(&residual, &right))
    }

    /// The smallest motion of all bodies that makes up for residuals of the joints and actuators.
    fn step(&self, residuals: &[f64]) -> Vec<f64> {
        column(&self.pseudo_inverse(&self.opposite(residuals), false))
    }

    /// The multipliers of what the bodies require, and what is not balanced.
    fn multipliers(&self, required: &[Wrench]) -> (Vec<f64>, f64) {
        let parts: Vec<[f64; 6]> = required.iter().map(parts).collect();
        let right = Mat::from_fn(self.matrix.ncols(), 1, |i, _| parts[i / 6][i % 6]);
        let multipliers = self.pseudo_inverse(&right, true);
        let residual = self.matrix.transpose() * &multipliers - &right;
        (column(&multipliers), relative(&residual, &right))
    }

    /// The smallest solution of least squares, of J or of its transpose.
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

impl Bodies<'_> {
    /// The rows of all joints and then of the actuators, and by joint its rows.
    fn all_rows(&self) -> (Vec<Row>, Vec<std::ops::Range<usize>>) {
        let mut rows = Vec::new();
        let mut of_joint = Vec::new();
        for (j, joint) in self.mechanism.joints.iter().enumerate() {
            let start = rows.len();
            // A driven distance holds nothing by itself.
            let driven = ActuatorKind::Length(JointId(j));
            if self.mechanism.actuators.iter().all(|a| a.kind != driven) {
                rows.extend(self.rows(joint));
            }
            of_joint.push(start..rows.len());
        }
        for actuator in &self.mechanism.actuators {
            let joint = &self.mechanism.joints[actuator.kind.joint().0];
            let u = self.arm(joint.side_body(0).0, joint.sides[0].axis);
            rows.push(match actuator.kind {
                ActuatorKind::Angle(_) => self.angle(joint, u),
                ActuatorKind::Travel(_) => self.in_plane(joint, u),
                ActuatorKind::Length(_) => self.distance(joint),
            });
        }
        (rows, of_joint)
    }

    /// J̇ẋ of all rows.
    fn biases(&self) -> Vec<f64> {
        let (rows, _) = self.all_rows();
        rows.iter().map(|row| row.bias).collect()
    }

    /// Sets velocities or accelerations.
    fn set(&mut self, x: &[f64], of: impl Fn(&mut BodyMotion) -> (&mut Vec3, &mut Vec3)) {
        for (motion, x) in self.motions.iter_mut().zip(x.chunks(6)) {
            let (linear, angular) = of(motion);
            (*linear, *angular) = (vec3(x[0], x[1], x[2]), vec3(x[3], x[4], x[5]));
        }
    }

    /// The reactions of multipliers, and which components no self-stress changes.
    fn reactions(&self, system: &System, multipliers: &[f64]) -> (Vec<Wrench>, Vec<[bool; 6]>) {
        let mut reactions = self.wrenches(system, multipliers);
        let mut determined = vec![[true; 6]; reactions.len()];
        for k in system.rank..system.rows {
            let stress: Vec<f64> = system.svd.U().col(k).iter().copied().collect();
            for (determined, wrench) in determined.iter_mut().zip(self.wrenches(system, &stress)) {
                for (determined, part) in determined.iter_mut().zip(parts(&wrench)) {
                    *determined &= part.abs() < 1e-7;
                }
            }
        }
        // The ground's own rows hold nothing: its joints' reactions are those of the other bodies.
        reactions.truncate(self.mechanism.joints.len());
        (reactions, determined)
    }

    /// By joint: force and moment of multipliers on the second body, about its point there.
    fn wrenches(&self, system: &System, multipliers: &[f64]) -> Vec<Wrench> {
        let joints = self.mechanism.joints.iter().zip(&system.of_joint);
        let of_joint = |(joint, rows): (&Joint, &std::ops::Range<usize>)| {
            let mut wrench = Wrench::default();
            for i in rows.clone() {
                wrench.force += system.on_second[i].force.scaled(multipliers[i]);
                wrench.moment += system.on_second[i].moment.scaled(multipliers[i]);
            }
            let at = self.point(joint.side_body(1).0, joint.sides[1].point);
            let arm = at - self.placements[joint.bodies[1].0].position;
            wrench.moment -= arm.cross(wrench.force);
            wrench
        };
        joints.map(of_joint).collect()
    }
}

fn parts(wrench: &Wrench) -> [f64; 6] {
    let Wrench {
        force: f,
        moment: m,
    } = wrench;
    [f.x, f.y, f.z, m.x, m.y, m.z]
}

fn add(matrix: &mut Mat<f64>, row: usize, body: usize, gradient: Gradient) {
    for (k, value) in parts(&gradient).into_iter().enumerate() {
        matrix[(row, 6 * body + k)] += value;
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
