//! Closed forms in numbers of two words: the truths of the grid. They share no line with what they judge.

use super::shapes::{FourBar, SliderCrank};
use dwell_geometry::{Scalar, Vec2, Wide, vec2};
use dwell_kinetostatics::Mass;

pub(crate) fn wide(value: f64) -> Wide {
    Wide::lift(value)
}

type Point = Vec2<Wide>;

/// A body at unit speed of the coordinate: its motion, and what it adds to m and ½m′.
#[derive(Debug, Clone, Copy)]
struct Moving {
    /// A point of it, where that is, its velocity and its acceleration at zero q̈.
    at: [Point; 3],
    /// Direction of its x axis, spin and spin's rate.
    axis: Point,
    spin: [Wide; 2],
    mass: Mass,
}

impl Moving {
    /// Place, velocity and acceleration of a point by its distances along the axis and across it.
    fn point(&self, local: Point) -> [Point; 3] {
        let arm = self.axis * local.x + self.axis.perp() * local.y;
        let [place, velocity, acceleration] = self.at;
        let [spin, rate] = self.spin;
        [
            place + arm,
            velocity + arm.perp() * spin,
            acceleration + arm.perp() * rate - arm * (spin * spin),
        ]
    }

    fn center(&self) -> [Point; 3] {
        self.point(self.mass.center.lift())
    }

    /// m = Σ m v² + I ω² and ½m′ = Σ m v·a + I ω α.
    fn adds(&self) -> [Wide; 2] {
        let [_, v, a] = self.center();
        let (mass, inertia) = (wide(self.mass.mass), wide(self.mass.inertia));
        let [w, e] = self.spin;
        [
            mass * v.dot(v) + inertia * w * w,
            mass * v.dot(a) + inertia * w * e,
        ]
    }

    /// Rate of the angular momentum about a point that neither velocity nor acceleration of the body
    /// makes: at unit q̈ (the velocities stand for accelerations) and at unit q̇.
    fn moments(&self, about: Point) -> [Wide; 2] {
        let [place, v, a] = self.center();
        let (mass, inertia) = (wide(self.mass.mass), wide(self.mass.inertia));
        let [w, e] = self.spin;
        let arm = place - about;
        [
            mass * arm.cross(v) + inertia * w,
            mass * arm.cross(a) + inertia * e,
        ]
    }
}

/// x and y of x·u + y·v = w.
fn solve(u: Point, v: Point, w: Point) -> [Wide; 2] {
    let det = u.cross(v);
    [w.cross(v) / det, u.cross(w) / det]
}

/// The reduced parameters of a four-bar.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reduced {
    pub(crate) m: Wide,
    pub(crate) half_dm: Wide,
    /// Of joint C: what multiplies q̈ and q̇².
    pub(crate) a: Point,
    pub(crate) b: Point,
}

/// By circle and circle, with the rocker's end C on the left (+1) or right (−1) of the line from B to D.
pub(crate) fn four_bar(bars: &FourBar, side: f64, q: Wide) -> Reduced {
    let [a, d] = bars.base.map(Vec2::lift::<Wide>);
    let [crank, coupler, rocker] = bars.lengths.map(wide);
    let (sin, cos) = q.sin_cos();
    let one = Moving {
        at: [a, Vec2::zero(), Vec2::zero()],
        axis: vec2(cos, sin),
        spin: [wide(1.0), wide(0.0)],
        mass: bars.masses[0],
    };
    let [b, vb, ab] = one.point(vec2(crank, wide(0.0)));
    let line = d - b;
    let square = line.dot(line);
    let along = (square + coupler * coupler - rocker * rocker) / (wide(2.0) * square);
    // Heron's product: the difference of squares would lose what is left near a limit position.
    let (sum, gap) = (coupler + rocker, coupler - rocker);
    let rest = (sum * sum - square) * (square - gap * gap);
    let across = wide(side) * rest.sqrt() / (wide(2.0) * square);
    let bc = line * along + line.perp() * across;
    let c = b + bc;
    let dc = c - d;
    let [w2, w3] = solve(-bc.perp(), dc.perp(), vb);
    let right = ab - bc * (w2 * w2) + dc * (w3 * w3);
    let [e2, e3] = solve(-bc.perp(), dc.perp(), right);
    let inverse = |l: Wide| wide(1.0) / l;
    let two = Moving {
        at: [b, vb, ab],
        axis: bc * inverse(coupler),
        spin: [w2, e2],
        mass: bars.masses[1],
    };
    let three = Moving {
        at: [d, Vec2::zero(), Vec2::zero()],
        axis: dc * inverse(rocker),
        spin: [w3, e3],
        mass: bars.masses[2],
    };
    let [m1, n1] = one.adds();
    let [m2, n2] = two.adds();
    let [m3, n3] = three.adds();
    // The force F of the rocker on the coupler at C: BC × F = moment of the coupler about B, and
    // DC × −F = moment of the rocker about D. The reaction is that of the coupler on the rocker, −F.
    let (two, three) = (two.moments(b), three.moments(d));
    let [a, b] = [0, 1].map(|run| {
        // BC × F = M₂ and DC × F = −M₃, for F = x DC + y BC.
        let cross = bc.cross(dc);
        let x = two[run] / cross;
        let y = three[run] / cross;
        -(dc * x + bc * y)
    });
    Reduced {
        m: m1 + m2 + m3,
        half_dm: n1 + n2 + n3,
        a,
        b,
    }
}

/// m and ½m′ of a slider-crank, its rod to the right.
pub(crate) fn slider_crank(parts: &SliderCrank, q: Wide) -> [Wide; 2] {
    let [crank, rod] = parts.lengths.map(wide);
    let (sin, cos) = q.sin_cos();
    let one = Moving {
        at: [Vec2::zero(); 3],
        axis: vec2(cos, sin),
        spin: [wide(1.0), wide(0.0)],
        mass: parts.masses[0],
    };
    let [b, vb, ab] = one.point(vec2(crank, wide(0.0)));
    let rise = wide(parts.height) - b.y;
    let run = ((rod + rise) * (rod - rise)).sqrt();
    // The end of the rod keeps its height: v_y + run ω = 0, a_y + run α − rise ω² = 0.
    let w = -vb.y / run;
    let e = (rise * w * w - ab.y) / run;
    let inverse = wide(1.0) / rod;
    let two = Moving {
        at: [b, vb, ab],
        axis: vec2(run * inverse, rise * inverse),
        spin: [w, e],
        mass: parts.masses[1],
    };
    let end = two.point(vec2(rod, wide(0.0)));
    let three = Moving {
        at: end.map(|p| vec2(p.x, wide(0.0))),
        axis: Vec2::IDENTITY.lift(),
        spin: [wide(0.0); 2],
        mass: parts.masses[2],
    };
    let sums = [one, two, three].map(|body| body.adds());
    [0, 1].map(|k| sums[0][k] + sums[1][k] + sums[2][k])
}

/// m and ½m′ of a parallelogram whose crank and rocker are 1 m long: the coupler does not turn.
pub(crate) fn parallelogram(bars: &FourBar) -> [Wide; 2] {
    let [one, two, three] = bars.masses;
    let mut m = wide(two.mass);
    for body in [one, three] {
        let center = body.center.lift::<Wide>();
        m += wide(body.inertia) + wide(body.mass) * center.dot(center);
    }
    [m, wide(0.0)]
}

/// ∮ √m dq over a turn of a four-bar's crank, by the trapezoid rule: spectral.
pub(crate) fn root_of_inertia(bars: &FourBar, side: f64, points: usize) -> Wide {
    let step = Wide::PI * wide(2.0) / wide(points as f64);
    let mut sum = wide(0.0);
    for k in 0..points {
        sum += four_bar(bars, side, step * wide(k as f64)).m.sqrt();
    }
    sum * step
}

/// The angle whose cosine is x.
pub(crate) fn arc_cosine(x: Wide) -> Wide {
    let one = wide(1.0);
    ((one + x) * (one - x)).sqrt().atan2(x)
}

/// ∫₀^{π/2} dθ / √(1 − k² sin² θ) by the arithmetic-geometric mean, from k′ = √(1 − k²)
/// (Abramowitz and Stegun 1964, 17.6.3).
pub(crate) fn elliptic_k(complement: Wide) -> Wide {
    let (mut a, mut g) = (wide(1.0), complement);
    for _ in 0..12 {
        (a, g) = ((a + g) * wide(0.5), (a * g).sqrt());
    }
    Wide::PI / (a + g)
}

/// ∫₀^{π/2} √(1 − k² sin² θ) dθ by the same (17.6.4).
pub(crate) fn elliptic_e(k_square: Wide, complement: Wide) -> Wide {
    let (mut a, mut g) = (wide(1.0), complement);
    let (mut sum, mut power) = (k_square * wide(0.5), 0.5);
    for _ in 0..12 {
        let c = (a - g) * wide(0.5);
        (a, g) = ((a + g) * wide(0.5), (a * g).sqrt());
        power *= 2.0;
        sum += c * c * wide(power);
    }
    Wide::PI / (a + g) * (wide(1.0) - sum)
}

/// e^x, by its series at x/2ᵏ, squared k times.
pub(crate) fn exponential(x: Wide) -> Wide {
    // Of −1 and nearly 1 few digits would be left; beyond, a number has none at all.
    if x.hi < -700.0 {
        return wide(0.0);
    }
    if x.hi < 0.0 {
        return wide(1.0) / exponential(-x);
    }
    let halvings = (x.hi.abs().log2().ceil() + 8.0).clamp(0.0, 60.0) as i32;
    let small = x * wide(0.5_f64.powi(halvings));
    let (mut term, mut sum) = (small, small);
    for n in 2..16 {
        term = term * small / wide(f64::from(n));
        sum += term;
    }
    // e^2x − 1 = (e^x − 1)(e^x + 1) keeps the digits of what is small.
    for _ in 0..halvings {
        sum = sum * (sum + wide(2.0));
    }
    sum + wide(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::shapes::CRANK_ROCKER;
    use super::*;

    /// The rule has converged to the digits of the numbers.
    #[test]
    fn val_the_rule_of_a_turn() {
        let by = |points| root_of_inertia(&CRANK_ROCKER, 1.0, points);
        assert!((by(256) - by(512)).hi.abs() < 1e-28);
    }

    /// Values by an arbitrary-precision program, 50 digits, split into two words.
    #[test]
    fn val_functions() {
        let near = |got: Wide, hi: f64, lo: f64| {
            let off = (got - Wide { hi, lo }).hi;
            assert!((off / hi).abs() < 1e-29, "{got:?}: {off:e}");
        };
        let complement = wide(0.75).sqrt();
        near(
            elliptic_k(complement),
            1.685750354812596,
            -9.540573578758024e-18,
        );
        near(
            elliptic_e(wide(0.25), complement),
            1.4674622093394272,
            -1.5002704549503613e-17,
        );
        near(
            exponential(wide(1.0)),
            std::f64::consts::E,
            1.4456468917292502e-16,
        );
        near(
            exponential(wide(-20.0)),
            2.061153622438558e-9,
            -4.19755767595054e-26,
        );
        near(arc_cosine(wide(0.5)) * wide(3.0), Wide::PI.hi, Wide::PI.lo);
    }
}
