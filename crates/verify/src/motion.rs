//! Mechanics of the dense mechanism: velocities and accelerations of the centres of mass, kinetic
//! energy and momentum.
//!
//! With u and w two sets of velocities of all coordinates at one configuration,
//!
//! ```text
//! ⟨u, w⟩ = Σ m v_G(u)·v_G(w) + I ω(u) ω(w)                   (1)
//! 2 E_c  = ⟨ẋ, ẋ⟩,   ẋ = u₁ q̇₁ + u₂ q̇₂                       (2)
//! 2 E_c  = m₁ q̇₁² + m₂ q̇₂² + 2 m₁₂ q̇₁ q̇₂                    (3)  (Jordi, Zayas & Cardona 2008, eq. 2)
//! ```
//!
//! so m₁ = ⟨u₁, u₁⟩, m₁₂ = ⟨u₁, u₂⟩, with u₁ and u₂ the unit velocities of the two coordinates.

use crate::constraint_closing::Configuration;
use crate::dense::{DenseBody, DenseMechanism, add_scaled};
use crate::differences::{DerivativeOrder, Extrapolated, derivatives};
use dwell_geometry::{Vec2, vec2};
use dwell_kinetostatics::Coefficients;

impl DenseMechanism {
    /// ⟨u, w⟩ of the whole mechanism, eq. (1), kg m² for two speeds per rad/s.
    pub fn inertia(&self, at: &Configuration, u: &[f64], w: &[f64]) -> f64 {
        let bodies = 0..self.bodies.len();
        bodies.map(|b| self.body_inertia(b, at, u, w)).sum()
    }

    /// The share of one body in ⟨u, w⟩.
    pub fn body_inertia(&self, body: usize, at: &Configuration, u: &[f64], w: &[f64]) -> f64 {
        let of = &self.bodies[body];
        of.column.map_or(0.0, |c| {
            let [u_g, w_g] = [u, w].map(|speeds| self.center_velocity(of, at, speeds));
            of.mass.mass * u_g.dot(w_g) + of.angular_inertia(at.x[c + 2]) * (u[c + 2] * w[c + 2])
        })
    }

    /// Kinetic energy, J, when each listed row moves at its rate and the others are held: eq. (2).
    pub fn kinetic_energy(&self, at: &Configuration, rates: &[(usize, f64)]) -> f64 {
        let mut x_dot = vec![0.0; self.rows.columns()];
        for &(row, rate) in rates {
            add_scaled(&mut x_dot, rate, &self.unit_velocity(at, row));
        }
        0.5 * self.inertia(at, &x_dot, &x_dot)
    }

    /// Linear momentum in x and y, kg m/s, and angular momentum about the ground's moved origin,
    /// kg m²/s; without that of varying moments of inertia, which is not theirs alone.
    pub fn momentum(&self, at: &Configuration, x_dot: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (_, body, c) in self.moving_bodies() {
            let p = self.center_velocity(body, at, x_dot) * body.mass.mass;
            sum[0] += p.x;
            sum[1] += p.y;
            sum[2] += self.center(body, at).cross(p) + body.mass.inertia * x_dot[c + 2];
        }
        sum
    }

    /// Σ m v_G(w)·a_G + I ω(w) α: the power of the inertia forces with the speeds `w`, when the
    /// mechanism moves at `v` with accelerations `a`.
    pub fn inertia_power(&self, at: &Configuration, w: &[f64], v: &[f64], a: &[f64]) -> f64 {
        let power = |body: &DenseBody| {
            body.column.map_or(0.0, |c| {
                let a_g = self.center_acceleration(body, at, v, a);
                body.mass.mass * self.center_velocity(body, at, w).dot(a_g)
                    + w[c + 2] * body.inertia_moment(at.x[c + 2], v[c + 2], a[c + 2])
            })
        };
        self.bodies.iter().map(power).sum()
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

    /// Second derivatives in time of the centre of mass and the angle of every moving body, three a body,
    /// m/s² and rad/s², by differences of positions alone. `actuator_values` writes the coordinates of the
    /// actuators at a time from the configuration `at`; Newton's method starts from `at` itself, since an
    /// extrapolation would need velocities.
    pub(crate) fn second_differences(
        &self,
        at: &Configuration,
        first_step: f64,
        rounding: f64,
        actuator_values: impl Fn(f64, &mut [f64]),
    ) -> Vec<Extrapolated> {
        let positions = |configuration: &Configuration| -> Vec<f64> {
            let position = |(_, body, c): (usize, &DenseBody, usize)| {
                let center = self.center(body, configuration);
                [center.x, center.y, configuration.x[c + 2]]
            };
            self.moving_bodies().flat_map(position).collect()
        };
        let middle = positions(at);
        let actuator_row = self.actuator_row();
        let mut row_values = at.row_values.clone();
        let order = DerivativeOrder::Second(&middle);
        derivatives(order, first_step, rounding, |t| {
            actuator_values(t, &mut row_values[actuator_row..]);
            let configuration = self.close_on_branch(at, &at.x, &row_values).ok()?;
            Some(positions(&configuration))
        })
    }

    /// Where a body's centre of mass is, from the ground's moved origin.
    pub(crate) fn center(&self, body: &DenseBody, at: &Configuration) -> Vec2 {
        self.frame_point(body, &at.x, body.mass.center)
    }

    pub(crate) fn center_velocity(&self, body: &DenseBody, at: &Configuration, u: &[f64]) -> Vec2 {
        body.column.map_or(Vec2::ZERO, |c| {
            let arm = body.mass.center.rotate(Vec2::from_angle(at.x[c + 2]));
            vec2(u[c], u[c + 1]) + arm.perp() * u[c + 2]
        })
    }

    pub(crate) fn center_acceleration(
        &self,
        body: &DenseBody,
        at: &Configuration,
        u: &[f64],
        a: &[f64],
    ) -> Vec2 {
        body.column.map_or(Vec2::ZERO, |c| {
            let arm = body.mass.center.rotate(Vec2::from_angle(at.x[c + 2]));
            vec2(a[c], a[c + 1]) + arm.perp() * a[c + 2] - arm * (u[c + 2] * u[c + 2])
        })
    }
}
