//! Mechanics of the dense mechanism: velocities and accelerations of the centres of mass, kinetic
//! energy and momentum.
//!
//! With u and w two sets of velocities of all coordinates at one configuration,
//!
//! ```text
//! ⟨u, w⟩ = Σ m v_G(u)·v_G(w) + ω(u)·I ω(w)                   (1)
//! 2 E_c  = ⟨ẋ, ẋ⟩,   ẋ = u₁ q̇₁ + u₂ q̇₂                       (2)
//! 2 E_c  = m₁ q̇₁² + m₂ q̇₂² + 2 m₁₂ q̇₁ q̇₂                    (3)  (Jordi, Zayas & Cardona 2008, eq. 2)
//! ```
//!
//! so m₁ = ⟨u₁, u₁⟩, m₁₂ = ⟨u₁, u₂⟩, with u₁ and u₂ the unit velocities of the two coordinates.

use crate::constraint_closing::Configuration;
use crate::dense::{DenseBody, DenseMechanism, add_scaled};
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives};
use crate::pose::{Pose, Twist, centripetal};
use crate::wrenches::BodyWrench;
use dwell_geometry::BodyId;
use dwell_geometry::space::{Vec3, Wrench, vec3};
use dwell_kinetostatics::Coefficients;

impl DenseBody {
    /// The vector from the moved origin to the centre of mass, m.
    fn arm(&self, pose: &Pose) -> Vec3 {
        pose.rotation.apply(self.mass.center)
    }

    /// The position of its centre of mass, from the ground's moved origin, m.
    pub(crate) fn center(&self, pose: &Pose) -> Vec3 {
        pose.point(self.mass.center)
    }

    /// The velocity of the centre of mass at speeds of all coordinates, and the angular velocity.
    pub(crate) fn center_velocity(&self, pose: &Pose, u: &[f64]) -> Twist {
        let twist = self.columns.twist(u);
        Twist {
            linear: twist.at(self.arm(pose)),
            ..twist
        }
    }

    /// The acceleration of the centre of mass at speeds and accelerations of all coordinates, and the angular acceleration.
    pub(crate) fn center_acceleration(&self, pose: &Pose, [u, a]: [&[f64]; 2]) -> Twist {
        let (arm, omega) = (self.arm(pose), self.columns.twist(u).angular);
        let twist = self.columns.twist(a);
        Twist {
            linear: twist.at(arm) + centripetal(omega, arm),
            ..twist
        }
    }

    /// m a_G, and the rate of the angular momentum about the centre of mass.
    pub(crate) fn momentum_rate(&self, pose: &Pose, [u, a]: [&[f64]; 2]) -> Wrench {
        let acceleration = self.center_acceleration(pose, [u, a]);
        let omega = self.columns.twist(u).angular;
        Wrench {
            force: acceleration.linear.scaled(self.mass.mass),
            moment: self.inertia_moment(pose, omega, acceleration.angular),
        }
    }
}

impl DenseMechanism {
    /// ⟨u, w⟩ of the whole mechanism, eq. (1), kg m² for two speeds per rad/s.
    pub fn inertia(&self, at: &Configuration, u: &[f64], w: &[f64]) -> f64 {
        let bodies = 0..self.bodies.len();
        bodies.map(|b| self.body_inertia(b, at, u, w)).sum()
    }

    /// The share of one body in ⟨u, w⟩.
    pub fn body_inertia(&self, body: usize, at: &Configuration, u: &[f64], w: &[f64]) -> f64 {
        let (of, pose) = (&self.bodies[body], &at.poses[body]);
        if of.columns.is_fixed() {
            return 0.0;
        }
        let [u, w] = [u, w].map(|speeds| of.center_velocity(pose, speeds));
        let turning = u.angular.dot(of.angular_momentum(pose, w.angular));
        of.mass.mass * u.linear.dot(w.linear) + turning
    }

    /// Kinetic energy, J, when each listed row moves at its rate and the others are held: eq. (2).
    pub fn kinetic_energy(&self, at: &Configuration, rates: &[(usize, f64)]) -> f64 {
        let mut x_dot = vec![0.0; self.rows.columns()];
        for &(row, rate) in rates {
            add_scaled(&mut x_dot, rate, &self.unit_velocity(at, row));
        }
        0.5 * self.inertia(at, &x_dot, &x_dot)
    }

    /// Linear momentum, kg m/s, and angular momentum about the ground's moved origin,
    /// kg m²/s; without that of varying moments of inertia, which belongs to the represented mechanism.
    pub fn momentum(&self, at: &Configuration, x_dot: &[f64]) -> [f64; 6] {
        let mut sum = Wrench::default();
        for (b, body) in self.moving_bodies() {
            let pose = &at.poses[b];
            let velocity = body.center_velocity(pose, x_dot);
            let own = body.constant_momentum(pose, velocity.angular);
            sum.add_at(
                body.center(pose),
                velocity.linear.scaled(body.mass.mass),
                own,
            );
        }
        let Wrench { force, moment } = sum;
        [force.x, force.y, force.z, moment.x, moment.y, moment.z]
    }

    /// Σ m v_G(w)·a_G + ω(w)·(I α + ω × I ω): the power of the inertia forces with the speeds `w`, when the
    /// mechanism moves at `v` with accelerations `a`.
    pub fn inertia_power(&self, at: &Configuration, w: &[f64], v: &[f64], a: &[f64]) -> f64 {
        let power = |(b, body): (usize, &DenseBody)| {
            let pose = &at.poses[b];
            let (w, omega) = (body.center_velocity(pose, w), body.columns.twist(v).angular);
            let acceleration = body.center_acceleration(pose, [v, a]);
            // The mass last: what is at right angles has no power to the last digit.
            body.mass.mass * w.linear.dot(acceleration.linear)
                + w.angular
                    .dot(body.inertia_moment(pose, omega, acceleration.angular))
        };
        self.moving_bodies().map(power).sum()
    }

    /// The inertia forces −m a_G at the centres of mass and their couples, of all moving bodies.
    pub(crate) fn inertia_wrenches(&self, poses: &[Pose], rates: [&[f64]; 2]) -> Vec<BodyWrench> {
        let wrench = |(b, body): (usize, &DenseBody)| {
            let rate = body.momentum_rate(&poses[b], rates);
            BodyWrench {
                body: BodyId(b),
                force: -rate.force,
                point: body.center(&poses[b]),
                couple: -rate.moment,
            }
        };
        self.moving_bodies().map(wrench).collect()
    }

    /// The reduced coefficients without any step, from the unit velocities of every row: m and a by
    /// eq. (1), and ½m′ and b as the power of the inertia forces at q̇ = 1, q̈ = 0 with the speeds
    /// of the actuator and of each released row (principle of virtual power).
    pub fn coefficients(&self, at: &Configuration, unit_velocities: &[Vec<f64>]) -> Coefficients {
        let (released, driven) = unit_velocities.split_at(self.actuator_row());
        let u = driven.first().map_or(&[][..], Vec::as_slice);
        let x_ddot = self.acceleration(at, u, &vec![0.0; self.rows.len()]);
        let power = |w: &[f64]| self.inertia_power(at, w, u, &x_ddot);
        Coefficients {
            m: self.inertia(at, u, u),
            half_dm: power(u),
            a: released.iter().map(|w| self.inertia(at, u, w)).collect(),
            b: released.iter().map(|w| power(w)).collect(),
        }
    }

    /// Second derivatives in time of the centre of mass and the rotation of every moving body (m/s² and rad/s²), by differences of
    /// positions alone. `actuator_values` writes the coordinates of the actuators at a time from the configuration `at`; Newton's
    /// method starts from `at` itself, since an extrapolation would need velocities.
    pub(crate) fn second_differences(
        &self,
        at: &Configuration,
        first_step: f64,
        rounding: f64,
        actuator_values: impl Fn(f64, &mut [f64]),
    ) -> SecondDifferences {
        let positions = |configuration: &Configuration| -> Vec<f64> {
            let of_body = |(b, body): (usize, &DenseBody)| {
                let pose = &configuration.poses[b];
                let (center, turn) = (body.center(pose), body.columns.turn(&at.poses[b], pose));
                [center.x, center.y, center.z, turn.x, turn.y, turn.z]
            };
            self.moving_bodies().flat_map(of_body).collect()
        };
        let middle = positions(at);
        let actuator_row = self.actuator_row();
        let mut row_values = at.row_values.clone();
        let order = DerivativeOrder::Second(&middle);
        let all = derivatives(order, first_step, rounding, |t| {
            actuator_values(t, &mut row_values[actuator_row..]);
            let configuration = self.close_on_branch(at, &at.poses, &row_values).ok()?;
            Some(positions(&configuration))
        });
        let mut of_bodies = all.chunks_exact(6);
        let of_body = |body: &DenseBody| {
            let estimates = if body.columns.is_fixed() {
                None
            } else {
                of_bodies.next()
            };
            estimates.map_or([NO_ESTIMATE; 6], |six| std::array::from_fn(|k| six[k]))
        };
        SecondDifferences(self.bodies.iter().map(of_body).collect())
    }
}

/// By body: second derivatives of the centre of mass and of the rotation, with their errors.
pub(crate) struct SecondDifferences(Vec<[Extrapolated; 6]>);

impl SecondDifferences {
    /// The acceleration of the centre of mass and the angular acceleration of a body.
    pub(crate) fn of(&self, body: usize) -> Twist {
        self.vectors(body, |estimate| estimate.value)
    }

    /// The errors of their components.
    pub(crate) fn errors(&self, body: usize) -> Twist {
        self.vectors(body, |estimate| estimate.error)
    }

    fn vectors(&self, body: usize, part: impl Fn(Extrapolated) -> f64) -> Twist {
        let [x, y, z, a, b, c] = self.0[body].map(part);
        Twist {
            linear: vec3(x, y, z),
            angular: vec3(a, b, c),
        }
    }
}
