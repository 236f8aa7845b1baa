//! The reduced model of a four-bar and of a slider-crank written by hand, with one reaction each: positions,
//! speeds and accelerations in closed form, m and ½m′ as sums over the bodies, the reaction by the moments
//! about a pin. A prime is d/dφ; × is the out-of-plane component of the vector product; SI units.

/// A body: mass (kg), its centre in the body's frame (m), inertia about it (kg m²).
#[derive(Clone, Copy)]
pub(crate) struct Body {
    pub(crate) mass: f64,
    pub(crate) center: [f64; 2],
    pub(crate) inertia: f64,
}

/// A four-bar with D to the right of A.
///
/// With **u** from B to C and **v** from D to C, γ the rocker's angle and K its moment of m a and I α about D,
/// the coupler's about B: v×C = K_r, u×C = −K_c for the force C of the coupler on the rocker. In the two unit
/// runs K is that of φ″ = 1 (K = first-order sums) and of φ′ = 1 (second-order sums).
pub(crate) struct FourBar {
    /// Lengths of crank, coupler, rocker and base, m.
    pub(crate) bars: [f64; 4],
    /// Crank, coupler, rocker.
    pub(crate) bodies: [Body; 3],
}

/// An offset slider-crank whose piston slides along x.
pub(crate) struct SliderCrank {
    /// Crank and rod, m.
    pub(crate) bars: [f64; 2],
    /// Height of the guide above the crank's pivot, m.
    pub(crate) offset: f64,
    /// Crank, rod.
    pub(crate) bodies: [Body; 2],
    /// Mass of the piston, kg.
    pub(crate) piston: f64,
}

/// First and second derivative of a point that turns with a body about `at`'s.
#[inline(always)]
fn rates(at: [[f64; 2]; 2], [rx, ry]: [f64; 2], w: f64, alpha: f64) -> [[f64; 2]; 2] {
    let [one, two] = at;
    [
        [one[0] - w * ry, one[1] + w * rx],
        [
            two[0] - alpha * ry - w * w * rx,
            two[1] + alpha * rx - w * w * ry,
        ],
    ]
}

#[inline(always)]
fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
fn rotated([x, y]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

impl FourBar {
    /// m, ½m′ (kg m²), and a, b (kg m) of the force of the coupler on the rocker along x, with C above the
    /// line from B to D.
    #[inline(always)]
    pub(crate) fn at(&self, phi: f64) -> [f64; 4] {
        let (sin, cos) = phi.sin_cos();
        let [crank, coupler, rocker, base] = self.bars;
        let (bx, by) = (crank * cos, crank * sin);
        let [bc, dc] = [coupler * coupler, rocker * rocker];
        let (dx, dy) = (base - bx, -by);
        let inv = 1.0 / (dx * dx + dy * dy);
        let t = 0.5 + 0.5 * (bc - dc) * inv;
        let k = (bc * inv - t * t).sqrt();
        let u = [t * dx - k * dy, t * dy + k * dx];
        let v = [u[0] - dx, u[1] - dy];

        // B′ = ẑ×B, B″ = −B.
        let inv = 1.0 / cross(u, v);
        let beta = (by * v[0] - bx * v[1]) * inv;
        let gamma = (by * u[0] - bx * u[1]) * inv;
        let h = [
            bx + beta * beta * u[0] - gamma * gamma * v[0],
            by + beta * beta * u[1] - gamma * gamma * v[1],
        ];
        let beta2 = dot(h, v) * inv;
        let gamma2 = dot(h, u) * inv;

        let [one, two, three] = &self.bodies;
        let fixed = one.inertia + one.mass * dot(one.center, one.center);
        let about_d = three.inertia + three.mass * dot(three.center, three.center);
        let r = rotated(two.center, [u[0] / coupler, u[1] / coupler]);
        let [v2, a2] = rates([[-by, bx], [-bx, -by]], r, beta, beta2);
        let m =
            fixed + two.mass * dot(v2, v2) + two.inertia * beta * beta + about_d * gamma * gamma;
        let half = two.mass * dot(v2, a2) + two.inertia * beta * beta2 + about_d * gamma * gamma2;

        let force = |v2: [f64; 2], beta: f64, gamma: f64| {
            let k_c = two.inertia * beta + two.mass * cross(r, v2);
            let k_r = about_d * gamma;
            -(k_r * u[0] + k_c * v[0]) * inv
        };
        [m, half, force(v2, beta, gamma), force(a2, beta2, gamma2)]
    }
}

impl SliderCrank {
    /// m, ½m′ (kg m²), and a, b (kg m) of the normal force of the guide on the piston, with the piston to the
    /// right. The moments of the rod about B leave u×P = K for the force P of the piston on the rod, whose part
    /// along the guide is −m_p ẍ.
    #[inline(always)]
    pub(crate) fn at(&self, phi: f64) -> [f64; 4] {
        let (sin, cos) = phi.sin_cos();
        let [crank, rod] = self.bars;
        let (bx, by) = (crank * cos, crank * sin);
        let uy = self.offset - by;
        let ux = (rod * rod - uy * uy).sqrt();

        // The height of C stays: bx + β′ ux = 0 and its derivative.
        let inv = 1.0 / ux;
        let beta = -bx * inv;
        let beta2 = (by + beta * beta * uy) * inv;
        let x1 = -by - beta * uy;
        let x2 = -bx - beta2 * uy - beta * beta * ux;

        let [one, two] = &self.bodies;
        let r = rotated(two.center, [ux / rod, uy / rod]);
        let [v2, a2] = rates([[-by, bx], [-bx, -by]], r, beta, beta2);
        let fixed = one.inertia + one.mass * dot(one.center, one.center);
        let m = fixed + two.mass * dot(v2, v2) + two.inertia * beta * beta + self.piston * x1 * x1;
        let half = two.mass * dot(v2, a2) + two.inertia * beta * beta2 + self.piston * x1 * x2;

        // ux P_y − uy P_x = K with P_x = −m_p ẍ; the guide's force is what balances −P_y.
        let normal = |v2: [f64; 2], beta: f64, x: f64| {
            let k = two.inertia * beta + two.mass * cross(r, v2);
            (k - uy * self.piston * x) * inv
        };
        [m, half, normal(v2, beta, x1), normal(a2, beta2, x2)]
    }
}
