//! Closed forms in double-double numbers: the references of the grid. They share no code with the computations that they check.

use super::mechanisms::{FourBar, SliderCrank};
use dwell_geometry::{Vec2, vec2};
use dwell_kinetostatics::Mass;
use dwell_numerics::{DoubleDouble, Scalar};

pub(crate) fn dd(value: f64) -> DoubleDouble {
    DoubleDouble::from_f64(value)
}

pub(crate) type Point = Vec2<DoubleDouble>;

pub(crate) fn at_rest(point: Point) -> [Point; 3] {
    [point, Vec2::zero(), Vec2::zero()]
}

/// The motion of a body at unit velocity of the coordinate (or other rates), for its contributions to m and ½m′.
#[derive(Debug, Clone, Copy)]
pub(crate) struct UnitSpeedBody {
    /// Position, velocity and acceleration (at zero q̈) of its origin.
    origin_motion: [Point; 3],
    /// Direction of its x axis, angular velocity and acceleration.
    axis: Point,
    angular_rates: [DoubleDouble; 2],
    mass: Mass,
}

impl UnitSpeedBody {
    pub(crate) fn new(
        origin_motion: [Point; 3],
        axis: Point,
        rates: [DoubleDouble; 2],
        mass: Mass,
    ) -> Self {
        Self {
            origin_motion,
            axis,
            angular_rates: rates,
            mass,
        }
    }

    /// A crank on a fixed pivot, at the coordinate.
    fn crank(pivot: Point, q: DoubleDouble, mass: Mass) -> Self {
        let (sin, cos) = q.sin_cos();
        Self::new(at_rest(pivot), vec2(cos, sin), [dd(1.0), dd(0.0)], mass)
    }

    /// Position, velocity and acceleration of a point, given by its coordinates along and perpendicular to the axis.
    pub(crate) fn point_motion(&self, local: Point) -> [Point; 3] {
        let offset = self.axis * local.x + self.axis.perp() * local.y;
        let [position, velocity, acceleration] = self.origin_motion;
        let [angular_velocity, angular_acceleration] = self.angular_rates;
        [
            position + offset,
            velocity + offset.perp() * angular_velocity,
            acceleration + offset.perp() * angular_acceleration
                - offset * (angular_velocity * angular_velocity),
        ]
    }

    fn center_motion(&self) -> [Point; 3] {
        self.point_motion(self.mass.center.cast())
    }

    /// m = Σ m v² + I ω² and ½m′ = Σ m v·a + I ω α.
    pub(crate) fn inertia_terms(&self) -> [DoubleDouble; 2] {
        let [_, v, a] = self.center_motion();
        let (mass, inertia) = (dd(self.mass.mass), dd(self.mass.inertia));
        let [w, e] = self.angular_rates;
        let half_dm = mass * v.dot(a) + inertia * w * e;
        [mass * v.dot(v) + inertia * w * w, half_dm]
    }

    /// Rate of the angular momentum about a point: at unit q̈ (with velocities in place of accelerations), and at
    /// unit q̇.
    pub(crate) fn moment_terms(&self, about: Point) -> [DoubleDouble; 2] {
        let [position, v, a] = self.center_motion();
        let (mass, inertia) = (dd(self.mass.mass), dd(self.mass.inertia));
        let [w, e] = self.angular_rates;
        let moment_arm = position - about;
        let moment = |rate, angular| mass * moment_arm.cross(rate) + inertia * angular;
        [moment(v, w), moment(a, e)]
    }
}

/// x and y of x·u + y·v = w.
fn solve_2x2(u: Point, v: Point, w: Point) -> [DoubleDouble; 2] {
    let det = u.cross(v);
    [w.cross(v) / det, u.cross(w) / det]
}

/// The reduced parameters of a four-bar.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FourBarCoefficients {
    pub(crate) m: DoubleDouble,
    pub(crate) half_dm: DoubleDouble,
    /// Coefficients of q̈ in the reaction of joint C.
    pub(crate) a: Point,
    pub(crate) b: Point,
}

/// Crank, coupler and rocker by circle and circle, with the rocker's end C on the left of the line from B to D; and the
/// vectors from B and from D to C.
pub(crate) fn four_bar_bodies(
    mechanism: &FourBar,
    q: DoubleDouble,
) -> ([UnitSpeedBody; 3], [Point; 2]) {
    let [a, d] = mechanism.base.map(Vec2::cast::<DoubleDouble>);
    let [crank, coupler, rocker] = mechanism.lengths.map(dd);
    let [mass_1, mass_2, mass_3] = mechanism.masses;
    let one = UnitSpeedBody::crank(a, q, mass_1);
    let [b, vb, ab] = one.point_motion(vec2(crank, dd(0.0)));
    let line = d - b;
    let square = line.dot(line);
    let along = (square + coupler * coupler - rocker * rocker) / (dd(2.0) * square);
    // Heron's product: a difference of squares would lose digits near a limit position.
    let (sum, gap) = (coupler + rocker, coupler - rocker);
    let rest = (sum * sum - square) * (square - gap * gap);
    let across = rest.sqrt() / (dd(2.0) * square);
    let bc = line * along + line.perp() * across;
    let c = b + bc;
    let dc = c - d;
    let [w2, w3] = solve_2x2(-bc.perp(), dc.perp(), vb);
    let right = ab - bc * (w2 * w2) + dc * (w3 * w3);
    let [e2, e3] = solve_2x2(-bc.perp(), dc.perp(), right);
    let inverse = |l: DoubleDouble| dd(1.0) / l;
    let two = UnitSpeedBody::new([b, vb, ab], bc * inverse(coupler), [w2, e2], mass_2);
    let three = UnitSpeedBody::new(at_rest(d), dc * inverse(rocker), [w3, e3], mass_3);
    ([one, two, three], [bc, dc])
}

/// The reduced parameters of a four-bar.
pub(crate) fn four_bar(mechanism: &FourBar, q: DoubleDouble) -> FourBarCoefficients {
    let ([one, two, three], [bc, dc]) = four_bar_bodies(mechanism, q);
    let [b, d] = [two, three].map(|body| body.origin_motion[0]);
    let [m1, n1] = one.inertia_terms();
    let [m2, n2] = two.inertia_terms();
    let [m3, n3] = three.inertia_terms();
    // The force F of the rocker on the coupler at C: BC × F = moment of the coupler about B, and
    // DC × −F = moment of the rocker about D. The reaction is that of the coupler on the rocker, −F.
    let (two, three) = (two.moment_terms(b), three.moment_terms(d));
    let [a, b] = [0, 1].map(|run| {
        // BC × F = M₂ and DC × F = −M₃, for F = x DC + y BC.
        let cross = bc.cross(dc);
        let x = two[run] / cross;
        let y = three[run] / cross;
        -(dc * x + bc * y)
    });
    FourBarCoefficients {
        m: m1 + m2 + m3,
        half_dm: n1 + n2 + n3,
        a,
        b,
    }
}

/// m and ½m′ of a slider-crank, its rod to the right.
pub(crate) fn slider_crank(parts: &SliderCrank, q: DoubleDouble) -> [DoubleDouble; 2] {
    let [crank, rod] = parts.lengths.map(dd);
    let one = UnitSpeedBody::crank(Vec2::zero(), q, parts.masses[0]);
    let [b, vb, ab] = one.point_motion(vec2(crank, dd(0.0)));
    let rise = dd(parts.height) - b.y;
    let run = ((rod + rise) * (rod - rise)).sqrt();
    // The end of the rod keeps its height: v_y + run ω = 0, a_y + run α − rise ω² = 0.
    let w = -vb.y / run;
    let e = (rise * w * w - ab.y) / run;
    let axis = vec2(run, rise) * (dd(1.0) / rod);
    let two = UnitSpeedBody::new([b, vb, ab], axis, [w, e], parts.masses[1]);
    let end = two
        .point_motion(vec2(rod, dd(0.0)))
        .map(|p| vec2(p.x, dd(0.0)));
    let axis = Vec2::IDENTITY.cast();
    let three = UnitSpeedBody::new(end, axis, [dd(0.0); 2], parts.masses[2]);
    let sums = [one, two, three].map(|body| body.inertia_terms());
    [0, 1].map(|k| sums[0][k] + sums[1][k] + sums[2][k])
}

/// m and ½m′ of a parallelogram whose crank and rocker are 1 m long: the coupler does not rotate.
pub(crate) fn parallelogram(mechanism: &FourBar) -> [DoubleDouble; 2] {
    let [one, two, three] = mechanism.masses;
    let mut m = dd(two.mass);
    for body in [one, three] {
        let center = body.center.cast::<DoubleDouble>();
        m += dd(body.inertia) + dd(body.mass) * center.dot(center);
    }
    [m, dd(0.0)]
}

/// ∮ √m dq over a revolution of a four-bar's crank, by the trapezoidal rule, which has spectral accuracy.
pub(crate) fn root_inertia_integral(mechanism: &FourBar, points: usize) -> DoubleDouble {
    let step = DoubleDouble::PI * dd(2.0) / dd(points as f64);
    let mut sum = dd(0.0);
    for k in 0..points {
        let q = step * dd(k as f64);
        sum += four_bar(mechanism, q).m.sqrt();
    }
    sum * step
}

/// The angle whose cosine is x.
pub(crate) fn arc_cosine(x: DoubleDouble) -> DoubleDouble {
    let one = dd(1.0);
    ((one + x) * (one - x)).sqrt().atan2(x)
}

/// ∫₀^{π/2} dθ / √(1 − k² sin² θ) by the arithmetic-geometric mean, from k′ = √(1 − k²)
/// (Abramowitz and Stegun 1964, 17.6.3).
pub(crate) fn elliptic_k(complement: DoubleDouble) -> DoubleDouble {
    let (mut a, mut g) = (dd(1.0), complement);
    for _ in 0..12 {
        (a, g) = ((a + g) * dd(0.5), (a * g).sqrt());
    }
    DoubleDouble::PI / (a + g)
}

/// ∫₀^{π/2} √(1 − k² sin² θ) dθ by the same (17.6.4).
pub(crate) fn elliptic_e(k_square: DoubleDouble, complement: DoubleDouble) -> DoubleDouble {
    let (mut a, mut g) = (dd(1.0), complement);
    let (mut sum, mut power) = (k_square * dd(0.5), 0.5);
    for _ in 0..12 {
        let c = (a - g) * dd(0.5);
        (a, g) = ((a + g) * dd(0.5), (a * g).sqrt());
        power *= 2.0;
        sum += c * c * dd(power);
    }
    DoubleDouble::PI / (a + g) * (dd(1.0) - sum)
}

/// e^x, by its series at x/2ᵏ, squared k times.
pub(crate) fn exponential(x: DoubleDouble) -> DoubleDouble {
    // Below this, the result underflows.
    if x.hi < -700.0 {
        return dd(0.0);
    }
    if x.hi < 0.0 {
        return dd(1.0) / exponential(-x);
    }
    let halvings = (x.hi.abs().log2().ceil() + 8.0).clamp(0.0, 60.0) as i32;
    let small = x * dd(0.5_f64.powi(halvings));
    let (mut term, mut sum) = (small, small);
    for n in 2..16 {
        term = term * small / dd(f64::from(n));
        sum += term;
    }
    // e^2x − 1 = (e^x − 1)(e^x + 1) keeps the digits of small values.
    for _ in 0..halvings {
        sum = sum * (sum + dd(2.0));
    }
    sum + dd(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::mechanisms::CRANK_ROCKER;
    use super::*;

    /// The rule has converged to the digits of the numbers.
    #[test]
    fn val_the_rule_of_a_turn() {
        let by = |points| root_inertia_integral(&CRANK_ROCKER, points);
        assert!((by(256) - by(512)).hi.abs() < 1e-28);
    }

    /// Values by an arbitrary-precision program, 50 digits, split into two words.
    #[test]
    fn val_functions() {
        let near = |got: DoubleDouble, hi: f64, lo: f64| {
            let difference = (got - DoubleDouble { hi, lo }).hi;
            assert!((difference / hi).abs() < 1e-29, "{got:?}: {difference:e}");
        };
        let complement = dd(0.75).sqrt();
        near(
            elliptic_k(complement),
            1.685750354812596,
            -9.540573578758024e-18,
        );
        near(
            elliptic_e(dd(0.25), complement),
            1.4674622093394272,
            -1.5002704549503613e-17,
        );
        near(
            exponential(dd(1.0)),
            std::f64::consts::E,
            1.4456468917292502e-16,
        );
        near(
            exponential(dd(-20.0)),
            2.061153622438558e-9,
            -4.19755767595054e-26,
        );
        near(
            arc_cosine(dd(0.5)) * dd(3.0),
            DoubleDouble::PI.hi,
            DoubleDouble::PI.lo,
        );
    }
}
