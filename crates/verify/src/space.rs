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

mod rows;

pub use rows::{closure_error, mesh_error};

use crate::error::{DenseError, Result};
use dwell_geometry::space::{ActuatorKind, BodyMotion, Joint, Mechanism, Placement, Vec3, Wrench};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Direction, LoadKind, Mass};
use faer::Mat;
use faer::linalg::solvers::Svd;
use rows::{Bodies, Gradient, Row};

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
        let mut bodies = Bodies {
            mechanism,
            placements,
            motions: vec![BodyMotion::default(); placements.len()],
        };
        let system = System::new(&bodies)?;
        let (velocity, first) = system.solve(q_dot, &vec![0.0; system.rows])?;
        bodies.set(&velocity, |motion| {
            (&mut motion.velocity, &mut motion.angular_velocity)
        });
        let (acceleration, second) = system.solve(q_ddot, &bodies.biases())?;
        bodies.set(&acceleration, |motion| {
            (&mut motion.acceleration, &mut motion.angular_acceleration)
        });
        let required = bodies.required(masses, loads);
        let (multipliers, third) = system.multipliers(&required);
        let (reactions, determined) = bodies.reactions(&system, &multipliers);
        Ok(Self {
            actuator_actions: multipliers[system.constraints..][..mechanism.actuators.len()]
                .to_vec(),
            idle_freedoms: system.idle,
            redundant_count: system.redundant_count(),
            residuals: [first, second, third],
            motions: bodies.motions,
            reactions,
            determined,
        })
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
        let mut with_idle = Mat::zeros(rows.len() + 6 + idle, columns);
        with_idle
            .as_mut()
            .subrows_mut(0, rows.len() + 6)
            .copy_from(&matrix);
        for k in 0..idle {
            let null = svd.V().col(columns - 1 - k);
            let turning = |b: usize| Vec3 {
                x: null[6 * b + 3],
                y: null[6 * b + 4],
                z: null[6 * b + 5],
            };
            let most = (0..bodies.placements.len())
                .max_by(|&a, &b| turning(a).norm().total_cmp(&turning(b).norm()));
            if let Some(body) = most {
                let moment = turning(body);
                add(
                    &mut with_idle,
                    rows.len() + 6 + k,
                    body,
                    Gradient {
                        force: Vec3::ZERO,
                        moment,
                    },
                );
            }
        }
        let svd = singular_values(&with_idle)?;
        Ok(Self {
            rank: rank(&svd),
            rows: with_idle.nrows(),
            matrix: with_idle,
            svd,
            constraints,
            idle,
            of_joint,
            on_second: rows[..constraints]
                .iter()
                .map(|row| row.gradients[1])
                .collect(),
        })
    }

    /// The constraints that are too many.
    fn redundant_count(&self) -> usize {
        self.rows - self.rank
    }

    /// ẋ or ẍ from the rates of the actuators and J̇ẋ, and what is not met.
    fn solve(&self, rates: &[f64], biases: &[f64]) -> Result<(Vec<f64>, f64)> {
        let mut right = Mat::zeros(self.rows, 1);
        for (i, bias) in biases.iter().enumerate() {
            right[(i, 0)] = -bias;
        }
        for (k, rate) in rates.iter().enumerate() {
            right[(self.constraints + k, 0)] += rate;
        }
        let x = self.pseudo_inverse(&right, false);
        let residual = &self.matrix * &x - &right;
        Ok((column(&x), relative(&residual, &right)))
    }

    /// The multipliers of what the bodies require, and what is not balanced.
    fn multipliers(&self, required: &[Wrench]) -> (Vec<f64>, f64) {
        let mut right = Mat::zeros(self.matrix.ncols(), 1);
        for (body, wrench) in required.iter().enumerate() {
            for (k, value) in parts(wrench).into_iter().enumerate() {
                right[(6 * body + k, 0)] = value;
            }
        }
        let multipliers = self.pseudo_inverse(&right, true);
        let residual = self.matrix.transpose() * &multipliers - &right;
        (column(&multipliers), relative(&residual, &right))
    }

    /// The smallest solution of least squares, of J or of its transpose.
    fn pseudo_inverse(&self, right: &Mat<f64>, transposed: bool) -> Mat<f64> {
        let (u, v) = (self.svd.U(), self.svd.V());
        let (from, to) = if transposed { (v, u) } else { (u, v) };
        let mut part = from.transpose() * right;
        let mut scaled = Mat::zeros(to.ncols(), 1);
        for k in 0..self.rank {
            scaled[(k, 0)] = part[(k, 0)] / self.svd.S().column_vector()[k];
        }
        part = to * &scaled;
        part
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
            *linear = Vec3 {
                x: x[0],
                y: x[1],
                z: x[2],
            };
            *angular = Vec3 {
                x: x[3],
                y: x[4],
                z: x[5],
            };
        }
    }

    /// M ẍ + h less the loads, about the origins of the frames.
    fn required(&self, masses: &[Mass], loads: &[(LoadKind, f64)]) -> Vec<Wrench> {
        let mut required = vec![Wrench::default(); self.placements.len()];
        for (body, mass) in masses.iter().enumerate() {
            let motion = &self.motions[body];
            let c = self.arm(body, mass.center);
            let w = motion.angular_velocity;
            let force =
                (motion.acceleration + motion.angular_acceleration.cross(c) + w.cross(w.cross(c)))
                    .scaled(mass.mass);
            let tensor = |v: Vec3| {
                let rotation = &self.placements[body].rotation;
                rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)))
            };
            let couple = tensor(motion.angular_acceleration) + w.cross(tensor(w));
            required[body].add_at(c, force, couple);
        }
        for (kind, magnitude) in loads {
            self.subtract_load(kind, *magnitude, masses, &mut required);
        }
        required
    }

    // Long because it has one arm for each kind of load.
    fn subtract_load(&self, kind: &LoadKind, f: f64, masses: &[Mass], required: &mut [Wrench]) {
        let turned = |body: usize, direction: Direction| match direction {
            Direction::Ground(u) => u,
            Direction::Body(u) => self.arm(body, u),
        };
        match *kind {
            LoadKind::Gravity(u) => {
                for (body, mass) in masses.iter().enumerate() {
                    let weight = u.scaled(-f * mass.mass);
                    required[body].add_at(self.arm(body, mass.center), weight, Vec3::ZERO);
                }
            }
            LoadKind::Force {
                body,
                point,
                direction,
            } => {
                let force = turned(body.0, direction).scaled(-f);
                required[body.0].add_at(self.arm(body.0, point), force, Vec3::ZERO);
            }
            LoadKind::Torque {
                bodies: [a, b],
                direction,
            } => {
                let couple = turned(a.0, direction).scaled(f);
                required[a.0].moment += couple;
                required[b.0].moment -= couple;
            }
            LoadKind::PointToPointForce {
                bodies: [a, b],
                points,
            } => {
                let d = self.point(b.0, points[1]) - self.point(a.0, points[0]);
                let push = d.scaled(f / d.norm());
                required[a.0].add_at(self.arm(a.0, points[0]), push, Vec3::ZERO);
                required[b.0].add_at(self.arm(b.0, points[1]), -push, Vec3::ZERO);
            }
            LoadKind::Spring {
                bodies,
                points,
                free_length,
            } => {
                let d = self.point(bodies[1].0, points[1]) - self.point(bodies[0].0, points[0]);
                let tension = f * (d.norm() - free_length);
                self.pull_together(bodies, points, d.scaled(tension / d.norm()), required);
            }
            LoadKind::Damper { bodies, points } => {
                let d = self.point(bodies[1].0, points[1]) - self.point(bodies[0].0, points[0]);
                let [from, to] = [0, 1].map(|k| self.point_velocity(bodies[k].0, points[k]));
                let tension = f * d.dot(to - from) / d.norm();
                self.pull_together(bodies, points, d.scaled(tension / d.norm()), required);
            }
            LoadKind::JointTorque(joint) => self.turn(joint, f, required),
            LoadKind::TorsionSpring { joint, free_angle } => {
                let of = &self.mechanism.joints[joint.0];
                let side = |k: usize, v: Vec3| self.arm(of.bodies[k].0, v);
                let [n, m] = [0, 1].map(|k| side(k, of.sides[k].normal));
                let sin = side(0, of.sides[0].axis).dot(n.cross(m));
                // Without whole revolutions.
                self.turn(joint, -f * (sin.atan2(n.dot(m)) - free_angle), required);
            }
            LoadKind::RotationalDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [w, v] = of.bodies.map(|b| self.motions[b.0].angular_velocity);
                let rate = self.arm(of.bodies[0].0, of.sides[0].axis).dot(v - w);
                self.turn(joint, -f * rate, required);
            }
            LoadKind::SlideForce(joint) => self.slide(joint, f, required),
            LoadKind::SlideDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [a, b] = of.bodies;
                let u = self.arm(a.0, of.sides[0].axis);
                let q = self.point(b.0, of.sides[1].point);
                // The rate along the axis, seen from the first body.
                let of_first = self.motions[a.0].velocity
                    + (self.motions[a.0].angular_velocity).cross(q - self.point(a.0, Vec3::ZERO));
                let seen = self.point_velocity(b.0, of.sides[1].point) - of_first;
                self.slide(joint, -f * u.dot(seen), required);
            }
        }
    }

    /// The velocity of a point of a body.
    fn point_velocity(&self, body: usize, point: Vec3) -> Vec3 {
        let motion = &self.motions[body];
        motion.velocity + motion.angular_velocity.cross(self.arm(body, point))
    }

    /// Takes off a tension, along the vector from the first point to the second.
    fn pull_together(
        &self,
        bodies: [BodyId; 2],
        points: [Vec3; 2],
        tension: Vec3,
        required: &mut [Wrench],
    ) {
        for (k, force) in [-tension, tension].into_iter().enumerate() {
            let body = bodies[k].0;
            required[body].add_at(self.arm(body, points[k]), force, Vec3::ZERO);
        }
    }

    /// Takes off a couple on a joint's second body about the axis, and its reaction on the first.
    fn turn(&self, joint: JointId, couple: f64, required: &mut [Wrench]) {
        let joint = &self.mechanism.joints[joint.0];
        let [a, b] = joint.bodies;
        let couple = self.arm(a.0, joint.sides[0].axis).scaled(couple);
        required[a.0].moment += couple;
        required[b.0].moment -= couple;
    }

    /// Takes off a force on a joint's second body along the axis at that body's point, and its reaction on the first there.
    fn slide(&self, joint: JointId, force: f64, required: &mut [Wrench]) {
        let joint = &self.mechanism.joints[joint.0];
        let [a, b] = joint.bodies;
        let force = self.arm(a.0, joint.sides[0].axis).scaled(force);
        let at = self.point(b.0, joint.sides[1].point);
        let from = |body: usize| at - self.point(body, Vec3::ZERO);
        required[a.0].add_at(from(a.0), force, Vec3::ZERO);
        required[b.0].add_at(from(b.0), -force, Vec3::ZERO);
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
