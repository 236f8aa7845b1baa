//! A four-bar under weight and a couple, written by hand: positions, speeds, accelerations, the
//! couple of the actuator and the forces of all four pins in closed form.
//!
//! With **u** from B to C and **v** from D to C, the position is the intersection of two circles; rates
//! follow from φ̇ ẑ×B + β̇ ẑ×u = γ̇ ẑ×v and its derivative by products with v and u. With F = m(a − g)
//! of each body and K = I α + r×F about B (coupler) and D (rocker), the force C on the rocker is given by
//!
//! ```text
//! v×C = K_r − T,  u×C = −K_c      hence  C = ((K_r − T) u + K_c v)/(v×u)
//! D = F_r − C,    B = F_c + C,    A = F + B,    τ = K + r_B×B
//! ```

/// The scene of the benchmark.
pub(crate) const SCENE: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], D = [0.4, 0], G = [0.5, 0.3] }
    crank = { points = { A = [0, 0], B = [0.1, 0] }, mass = 1.0, center = [0.04, 0.01], inertia = 1e-3 }
    coupler = { points = { B = [0, 0], C = [0.35, 0], E = [0.15, 0.07] }, mass = 2.0, center = [0.2, 0.05], inertia = 0.02 }
    rocker = { points = { D = [0, 0], C = [0.3, 0] }, mass = 1.5, center = [0.1, -0.02], inertia = 0.015 }
    [joints]
    A = { revolute = ["ground.A", "crank.A"] }
    B = { revolute = ["crank.B", "coupler.B"] }
    C = { revolute = ["coupler.C", "rocker.C"] }
    D = { revolute = ["ground.D", "rocker.D"] }
    [actuators]
    phi = { angle = ["ground", "crank"] }
    [assembly]
    phi = 1.0
    coupler = 0.6
    [loads]
    weight = { gravity = [0, -9.81] }
    resist = { torque = ["ground", "rocker"], magnitude = -3.0 }
"#;

/// The four-bar with a massless dyad on its coupler.
pub(crate) fn with_a_dyad() -> String {
    let dyad = r#"
    arm.points = { E = [0, 0], F = [0.4, 0] }
    tip.points = { G = [0, 0], F = [0.35, 0] }
    [joints]
    E = { revolute = ["coupler.E", "arm.E"] }
    F = { revolute = ["arm.F", "tip.F"] }
    G = { revolute = ["ground.G", "tip.G"] }"#;
    SCENE
        .replace("[joints]", dyad)
        .replace("coupler = 0.6", "coupler = 0.6\n    arm = 0.5")
}

/// A body: mass (kg), its centre in the body's frame (m), inertia about it (kg m²).
struct Body {
    mass: f64,
    center: [f64; 2],
    inertia: f64,
}

/// The constants of the mechanism; bars and base in m.
pub(crate) struct FourBar {
    crank: f64,
    coupler: f64,
    rocker: f64,
    base: f64,
    bodies: [Body; 3],
    couple: f64,
    gravity: f64,
}

impl FourBar {
    pub(crate) fn new() -> Self {
        let body = |mass, center, inertia| Body {
            mass,
            center,
            inertia,
        };
        Self {
            crank: 0.1,
            coupler: 0.35,
            rocker: 0.3,
            base: 0.4,
            bodies: [
                body(1.0, [0.04, 0.01], 1e-3),
                body(2.0, [0.2, 0.05], 0.02),
                body(1.5, [0.1, -0.02], 0.015),
            ],
            couple: -3.0,
            gravity: 9.81,
        }
    }

    /// τ, then A, B, C, D (x and y each), N m and N, at the angle, speed and acceleration of the crank.
    #[inline]
    pub(crate) fn at(&self, phi: f64, omega: f64, alpha: f64) -> [f64; 9] {
        let (sin, cos) = phi.sin_cos();
        let (bx, by) = (self.crank * cos, self.crank * sin);
        let [bc, dc] = [self.coupler * self.coupler, self.rocker * self.rocker];
        let (dx, dy) = (self.base - bx, -by);
        let inv = 1.0 / (dx * dx + dy * dy);
        let t = 0.5 + 0.5 * (bc - dc) * inv;
        let k = (bc * inv - t * t).sqrt();
        let (ux, uy) = (t * dx - k * dy, t * dy + k * dx);
        let (vx, vy) = (ux - dx, uy - dy);

        // Speeds of B, coupler and rocker; then what of the accelerations is known.
        let inv = 1.0 / (ux * vy - uy * vx);
        let beta = omega * (by * vx - bx * vy) * inv;
        let gamma = omega * (by * ux - bx * uy) * inv;
        let (ax, ay) = (
            -alpha * by - omega * omega * bx,
            alpha * bx - omega * omega * by,
        );
        let hx = -ax + beta * beta * ux - gamma * gamma * vx;
        let hy = -ay + beta * beta * uy - gamma * gamma * vy;
        let beta_rate = (hx * vx + hy * vy) * inv;
        let gamma_rate = (hx * ux + hy * uy) * inv;

        let [one, two, three] = &self.bodies;
        let (f1, k1) = self.inertia(one, [0.0; 2], [cos, sin], omega, alpha);
        let coupler = [ux / self.coupler, uy / self.coupler];
        let (f2, k2) = self.inertia(two, [ax, ay], coupler, beta, beta_rate);
        let rocker = [vx / self.rocker, vy / self.rocker];
        let (f3, k3) = self.inertia(three, [0.0; 2], rocker, gamma, gamma_rate);

        let p = k3 - self.couple;
        let c = [-(p * ux + k2 * vx) * inv, -(p * uy + k2 * vy) * inv];
        let b = [f2[0] + c[0], f2[1] + c[1]];
        [
            k1 + bx * b[1] - by * b[0],
            f1[0] + b[0],
            f1[1] + b[1],
            b[0],
            b[1],
            c[0],
            c[1],
            f3[0] - c[0],
            f3[1] - c[1],
        ]
    }

    /// m (a − g) of a body in a unit direction, with angular speed w and acceleration alpha; and the moment of it and of I α about the
    /// point that accelerates with `at`.
    #[inline]
    fn inertia(
        &self,
        body: &Body,
        at: [f64; 2],
        [cos, sin]: [f64; 2],
        w: f64,
        alpha: f64,
    ) -> ([f64; 2], f64) {
        let [x, y] = body.center;
        let (rx, ry) = (cos * x - sin * y, sin * x + cos * y);
        let fx = body.mass * (at[0] - alpha * ry - w * w * rx);
        let fy = body.mass * (at[1] + alpha * rx - w * w * ry + self.gravity);
        ([fx, fy], body.inertia * alpha + rx * fy - ry * fx)
    }
}
