//! Random crank-rockers and slider-cranks, with their m in closed form.

use dwell_geometry::Vec2;
use dwell_kinetostatics::Mass;
use dwell_tests::changes::Setup;
use dwell_tests::sketch::Sketch;
use proptest::prelude::*;
use std::f64::consts::PI;

/// A crank of length r at the origin, a coupler l from the crank's end, and either a rocker or a
/// slider; side = ±1 is the assembly branch.
#[derive(Debug, Clone)]
pub(crate) struct RandomMechanism {
    crank: f64,
    coupler: f64,
    follower: Follower,
    side: f64,
    masses: [Mass; 3],
    start: f64,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Follower {
    /// A rocker of this length, pinned to the ground at (base, 0).
    Rocker { length: f64, base: f64 },
    /// A slider whose pin moves along the x direction at this height.
    Slider { height: f64 },
}

impl RandomMechanism {
    /// The angles of coupler and follower. Rocker (cosines in the triangle of coupler, rocker and
    /// the line from the crank's end to the rocker's base); slider: l sin θ = height − r sin φ.
    fn angles(&self, phi: f64) -> [f64; 2] {
        let (sin, cos) = phi.sin_cos();
        let (x, y) = (self.crank * cos, self.crank * sin);
        match self.follower {
            Follower::Rocker { length, base } => {
                let (dx, dy) = (base - x, -y);
                let distance = dx.hypot(dy);
                let l = self.coupler;
                let angle =
                    ((l * l + distance * distance - length * length) / (2.0 * l * distance)).acos();
                let theta = dy.atan2(dx) + self.side * angle;
                let (cx, cy) = (x + l * theta.cos(), y + l * theta.sin());
                [theta, cy.atan2(cx - base)]
            }
            Follower::Slider { height } => {
                let theta = ((height - y) / self.coupler).asin();
                [if self.side > 0.0 { theta } else { PI - theta }, 0.0]
            }
        }
    }

    pub(crate) fn setup(&self) -> Setup {
        let mut sketch = Sketch::new();
        let ground = Sketch::GROUND;
        let [theta, psi] = self.angles(self.start);
        let [crank, coupler, follower] = self.masses;
        let crank = sketch.mass("crank", crank, None);
        let coupler = sketch.mass("coupler", coupler, Some(theta));
        let follower = sketch.mass("follower", follower, Some(psi));
        sketch.revolute("A", (ground, [0.0, 0.0]), (crank, [0.0, 0.0]));
        sketch.revolute("B", (crank, [self.crank, 0.0]), (coupler, [0.0, 0.0]));
        let end = (coupler, [self.coupler, 0.0]);
        match self.follower {
            Follower::Rocker { length, base } => {
                sketch.revolute("C", end, (follower, [length, 0.0]));
                sketch.revolute("D", (ground, [base, 0.0]), (follower, [0.0, 0.0]));
            }
            Follower::Slider { height } => {
                sketch.revolute("C", end, (follower, [0.0, 0.0]));
                let axis = Vec2::IDENTITY;
                sketch.prismatic(
                    "guide",
                    (ground, [0.0, height]),
                    (follower, [0.0, 0.0]),
                    axis,
                );
            }
        }
        sketch.actuate("phi", [ground, crank]);
        sketch.setup(&[self.start])
    }

    /// m in closed form. With the coupler at θ, the rocker at ψ and primes for d/dφ, the loop
    /// r e(φ) + l e(θ) = base + c e(ψ) along and across each bar gives (Norton, Design of
    /// Machinery, velocity of a four-bar)
    ///
    /// ```text
    /// θ′ = (r/l) sin(ψ − φ)/sin(θ − ψ),  ψ′ = (r/c) sin(φ − θ)/sin(ψ − θ)
    /// ```
    ///
    /// and for the slider, from l sin θ = height − r sin φ and x = r cos φ + l cos θ,
    ///
    /// ```text
    /// θ′ = −r cos φ/(l cos θ),  x′ = −r sin φ − l sin θ θ′
    /// ```
    ///
    /// The coupler's centre (u, v) in its frame moves with r e′(φ) + θ′ (u e′(θ) − v e(θ)), and
    /// m = Σ m v² + I ω² at φ̇ = 1.
    pub(crate) fn closed_form(&self, phi: f64) -> f64 {
        let [theta, psi] = self.angles(phi);
        let (r, l) = (self.crank, self.coupler);
        let [crank, coupler, follower] = self.masses;
        let about = |body: &Mass| body.inertia + body.mass * body.center.dot(body.center);
        let (rotation, last) = match self.follower {
            Follower::Rocker { length, .. } => {
                let rotation = r / l * (psi - phi).sin() / (theta - psi).sin();
                let swing = r / length * (phi - theta).sin() / (psi - theta).sin();
                (rotation, about(&follower) * swing * swing)
            }
            Follower::Slider { .. } => {
                let rotation = -r * phi.cos() / (l * theta.cos());
                let slide = -r * phi.sin() - l * theta.sin() * rotation;
                (rotation, follower.mass * slide * slide)
            }
        };
        let (u, v) = (coupler.center.x, coupler.center.y);
        let vx = -r * phi.sin() - rotation * (u * theta.sin() + v * theta.cos());
        let vy = r * phi.cos() + rotation * (u * theta.cos() - v * theta.sin());
        let coupler = coupler.mass * (vx * vx + vy * vy) + coupler.inertia * rotation * rotation;
        about(&crank) + coupler + last
    }
}

/// A body with its centre up to the given length away and its radius of gyration below it.
fn body(length: f64) -> impl Strategy<Value = Mass> {
    (0.1..5.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.0..1.0_f64).prop_map(move |(mass, x, y, rho)| {
        Mass {
            mass,
            center: Vec2 { x, y } * length,
            inertia: mass * (rho * length).powi(2),
        }
    })
}

/// Crank-rockers in which the dyad is never nearer to being stretched or folded than 20 % of what
/// is left (Grashof), and slider-cranks whose coupler is at least 20 % longer than it must be.
pub(crate) fn random_mechanism() -> impl Strategy<Value = RandomMechanism> {
    let rocker = (0.1..0.4_f64, 1.0..2.0_f64, -0.8..0.8_f64, 1.2..2.5_f64);
    let rocker = rocker.prop_map(|(r, base, difference, sum)| {
        let (difference, sum) = (difference * (base - r), sum * (base + r));
        let length = 0.5 * (sum - difference);
        (
            r,
            0.5 * (sum + difference),
            Follower::Rocker { length, base },
        )
    });
    let slider = (0.1..1.0_f64, -1.0..1.0_f64, 1.2..4.0_f64);
    let slider = slider.prop_map(|(r, height, longer)| {
        (r, longer * (r + height.abs()), Follower::Slider { height })
    });
    let side = prop_oneof![Just(1.0), Just(-1.0)];
    let bodies = (body(0.5), body(1.0), body(1.0));
    (prop_oneof![rocker, slider], side, bodies, -PI..PI).prop_map(
        |((crank, coupler, follower), side, (one, two, three), start)| RandomMechanism {
            crank,
            coupler,
            follower,
            side,
            masses: [one, two, three],
            start,
        },
    )
}
