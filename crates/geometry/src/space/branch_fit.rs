//! A part of a branch as polynomials of its coordinate: across a change point, where the equations of the loops do not determine how the
//! mechanism moves, but the branch is smooth. Fitted are the freedoms that no actuator drives and of each ball its rotation matrix B, from
//! which by the derivatives by the coordinate
//!
//! ```text
//! ω = ½ Σ b_c × b_c′,    ω′ = ½ Σ b_c × b_c″         b_c the columns of B                              (1)
//! ```
//!
//! in the axes of the ball on its first body.

use super::plan::{Plan, Pose};
use super::tree::{FreedomKind, Step};
use super::vector::{Rotation, Vec3, vec3};
use crate::error::PositionError;
use dwell_numerics::Scalar;
use dwell_numerics::polynomial_fit::{PolynomialFit, chebyshev_nodes};

/// Poses on each side, and the highest degree.
const NODES: usize = 24;
const MAX_DEGREE: usize = 20;
/// Numbers of a ball.
const BALL: usize = 9;

/// A part of a branch as polynomials.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchFit {
    center: f64,
    radius: f64,
    polynomials: PolynomialFit,
    /// The freedoms that are fitted as numbers.
    scalars: Vec<usize>,
    links: Vec<usize>,
}

/// Memory for the evaluation of a fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BranchFitWorkspace<T> {
    basis: Vec<[T; 3]>,
    values: Vec<[T; 3]>,
}

impl BranchFit {
    /// How far it is good to either side, rad or m.
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Plan {
    /// The branch about a coordinate by its poses between two distances from it, rad or m.
    ///
    /// # Errors
    /// [`PositionError`] where one of them cannot be reached.
    pub fn fit_branch(
        &self,
        center: f64,
        [half_width, radius]: [f64; 2],
    ) -> Result<BranchFit, PositionError> {
        let mut scalars = self.unknowns();
        scalars.retain(|f| self.tree.freedoms[*f] != FreedomKind::BallTurn);
        let above: Vec<f64> = chebyshev_nodes(half_width, radius, NODES).collect();
        let nodes: Vec<f64> = above
            .iter()
            .rev()
            .map(|d| -d)
            .chain(above.clone())
            .collect();
        let mut pose = self.pose::<f64>();
        let sample = |x: &f64| {
            let q = center + x;
            self.positions(&[q], &mut pose)?;
            // As they are counted over whole periods.
            let counted = |f: &usize| pose.coordinates[*f] + self.gain(*f) * self.periods(q);
            let mut values: Vec<f64> = scalars.iter().map(counted).collect();
            for column in pose.balls.iter().flat_map(|ball| ball.columns) {
                values.extend([column.x, column.y, column.z]);
            }
            Ok(values)
        };
        let samples: Result<Vec<Vec<f64>>, PositionError> = nodes.iter().map(sample).collect();
        Ok(BranchFit {
            center,
            radius,
            polynomials: PolynomialFit::new(&nodes, &samples?, radius, MAX_DEGREE),
            scalars,
            links: (0..self.tree.links.len()).collect(),
        })
    }

    /// The whole periods between a fit and a coordinate at a distance from its centre, less those by which a freedom is counted there.
    fn counted_periods(&self, fit: &BranchFit, [q, x]: [f64; 2]) -> f64 {
        let periods = match self.period() {
            Some(period) => ((q - x - fit.center) / period).round(),
            None => 0.0,
        };
        periods - self.periods(q)
    }

    /// The change of a freedom in a period of the only coordinate.
    fn gain(&self, freedom: usize) -> f64 {
        self.freedom_gains.get(freedom).copied().unwrap_or(0.0)
    }

    /// Sets a pose and its motion to those of a fit, at a coordinate, its distance from the centre, and its speed and acceleration.
    pub fn set_on_fit<T: Scalar>(
        &self,
        fit: &BranchFit,
        [q, x]: [T; 2],
        [q_dot, q_ddot]: [T; 2],
        memory: &mut BranchFitWorkspace<T>,
        pose: &mut Pose<T>,
    ) {
        let zero = T::from_f64(0.0);
        let count = fit.scalars.len() + BALL * pose.balls.len();
        memory.values.resize(count, [zero; 3]);
        let BranchFitWorkspace { basis, values } = memory;
        fit.polynomials.eval(x, basis, values);
        for driver in &self.drivers {
            let factor = T::from_f64(driver.factor);
            pose.coordinates[driver.freedom] = q * factor;
            pose.motion.rates[driver.freedom] = q_dot * factor;
            pose.motion.accelerations[driver.freedom] = q_ddot * factor;
        }
        let (scalars, balls) = values.split_at(fit.scalars.len());
        let shift = self.counted_periods(fit, [q, x].map(|v| v.value()));
        for (&freedom, [value, first, second]) in fit.scalars.iter().zip(scalars) {
            pose.coordinates[freedom] = *value + T::from_f64(shift * self.gain(freedom));
            pose.motion.rates[freedom] = *first * q_dot;
            pose.motion.accelerations[freedom] = *first * q_ddot + *second * q_dot * q_dot;
        }
        let column = |columns: &[[T; 3]], c: usize, d: usize| {
            let at = |k: usize| columns[3 * c + k][d];
            vec3(at(0), at(1), at(2))
        };
        for (ball, columns) in pose.balls.iter_mut().zip(balls.chunks_exact(BALL)) {
            *ball = Rotation {
                columns: [0, 1, 2].map(|c| column(columns, c, 0)),
            };
        }
        self.place(&fit.links, pose);
        let turning = |ball: usize, d: usize| {
            let columns = &balls[BALL * ball..][..BALL];
            let each = [0, 1, 2].map(|c| column(columns, c, 0).cross(column(columns, c, d)));
            (each[0] + each[1] + each[2]).scaled(T::from_f64(0.5))
        };
        for (body, ball, first) in self.balls() {
            let rate = self.to_ground(pose, body, ball, turning(ball, 1).scaled(q_dot));
            set_three(&mut pose.motion.rates, first, rate);
        }
        self.fill_states(pose);
        for (body, ball, first) in self.balls() {
            let of_joint = turning(ball, 1).scaled(q_ddot) + turning(ball, 2).scaled(q_dot * q_dot);
            let rates = &pose.motion.rates[first..first + 3];
            let rate = vec3(rates[0], rates[1], rates[2]);
            let carried = pose.motion.states[body].angular_velocity - rate;
            let turned = self.to_ground(pose, body, ball, of_joint) + carried.cross(rate);
            set_three(&mut pose.motion.accelerations, first, turned);
        }
        self.add_accelerations(pose);
        pose.motion.has_no_acceleration = false;
    }

    /// By ball: its body, its number, and its first freedom.
    fn balls(&self) -> impl Iterator<Item = (usize, usize, usize)> + '_ {
        let steps = self
            .tree
            .links
            .iter()
            .flat_map(|link| link.steps.iter().map(|s| (link.body, s)));
        steps.filter_map(|(body, step)| match *step {
            Step::Ball(ball, first) => Some((body, ball, first)),
            _ => None,
        })
    }

    /// Transforms a vector from the axes of a spherical joint on its first body to those of the ground.
    fn to_ground<T: Scalar>(
        &self,
        pose: &Pose<T>,
        body: usize,
        ball: usize,
        v: Vec3<T>,
    ) -> Vec3<T> {
        let inner = pose.balls[ball].apply_inverse(v);
        pose.frames[body].rotation.apply(inner)
    }
}

fn set_three<T>(to: &mut [T], first: usize, v: Vec3<T>) {
    for (to, value) in to[first..].iter_mut().zip([v.x, v.y, v.z]) {
        *to = value;
    }
}
