//! The single-dwell mechanism in closed form, written by hand, as the reference for the times of the general evaluator.
//!
//! The mechanism is the reconstruction of `docs/theory.md`: A = (0, 0), O = (g, 0), Q = (x_Q, y_Q),
//! crank AB = r, and three equal bars BC = CP = OC = l. Angles in rad, lengths in m, masses in kg.
//! A prime is d/dφ; × is the out-of-plane component of the vector product.
//!
//! **Position.** Because BC = CP = OC, B and P lie on a circle about C through O with BP a
//! diameter: the angle BOP is right (Thales), and P follows from one square root:
//!
//! ```text
//! e = (r sin φ, g − r cos φ)               the vector B→O turned by +90°, e·e = D
//! D = g² + r² − 2 g r cos φ,  F = 4l² − D  squares of the legs OB and OP
//! P = O + κ e,                κ = √(F/D)   C = (B + P)/2, above AO
//! ```
//!
//! **Derivatives.** With z = 1/(D F), κ = F √z, and the logarithmic derivatives of κ
//!
//! ```text
//! κ′/κ = λ = −2 l² z D′
//! κ″/κ = μ = −2 l² z (D″ − (F − D) z D′²) + λ²
//! P′ = κ (λ e + e′),  P″ = κ (μ e + 2 λ e′ + e″),  e′ = −B″,  e″ = B′
//! ```
//!
//! **Guide.** The slot passes through Q and P: with w = P − Q and s = |w|,
//!
//! ```text
//! θ′ = (w × P′)/s²,  θ″ = (w × P″ − 2 θ′ w·P′)/s²
//! ```
//!
//! **Inertia.** The crank is balanced; C is the coupler's centre of mass, so its velocity is
//! (B′ + P′)/2, and its rotation gives |P′ − B′|²/(4l²); the rocker OC turns with |C′|/l; the
//! slider is a point mass at P. Everything but the guide is then quadratic in P′ and B′:
//!
//! ```text
//! m   = M₀ + M₁ P′·P′ + 2 M₂ P′·B′ + I_Q θ′²
//! ½m′ = M₁ P′·P″ + M₂ (P″·B′ + P′·B″) + I_Q θ′θ″
//! M₁ = α + β + m_s,  M₂ = α − β,  M₀ = I_A + (α + β) r²
//! α = (m_c + I_O/l²)/4,  β = I_C/(4 l²)
//! ```
//!
//! **Reaction.** The guide on the slider, along the slot's axis turned by +90°; the moment of the
//! guide about Q leaves −s N = I_Q θ̈, hence N = a φ̈ + b φ̇² with
//!
//! ```text
//! a = −I_Q θ′/s,  b = −I_Q θ″/s
//! ```

/// The constants of the mechanism, prepared once.
pub(crate) struct ClosedForm {
    /// Crank length r, m.
    r: f64,
    /// Distance g of O from A, m.
    g: f64,
    /// g² + r², m².
    d_mean: f64,
    /// 2 g r, m².
    d_swing: f64,
    /// 4 l², m².
    four_l2: f64,
    /// O − Q, m.
    from_q: [f64; 2],
    /// M₀, the part of m that does not change, kg·m².
    m0: f64,
    /// M₁, the coefficient of P′·P′, kg.
    m1: f64,
    /// M₂, half the coefficient of P′·B′, kg.
    m2: f64,
    /// I_Q, the guide's moment of inertia about Q, kg·m².
    i_q: f64,
}

impl ClosedForm {
    /// The single-dwell mechanism with its reconstructed dimensions and masses.
    pub(crate) fn new() -> Self {
        let (r, g, l) = (0.1, 0.2, 0.25);
        let (x_q, y_q) = (-0.2, 0.4);
        let (coupler, rocker, guide, slider) = (1.5, 0.75, 2.1, 0.5);
        let i_crank = 0.626;
        let i_coupler = coupler * (2.0 * l) * (2.0 * l) / 12.0;
        let i_rocker = rocker * l * l / 3.0;
        let alpha = (coupler + i_rocker / (l * l)) / 4.0;
        let beta = i_coupler / (4.0 * l * l);
        Self {
            r,
            g,
            d_mean: g * g + r * r,
            d_swing: 2.0 * g * r,
            four_l2: 4.0 * l * l,
            from_q: [g - x_q, -y_q],
            m0: i_crank + (alpha + beta) * r * r,
            m1: alpha + beta + slider,
            m2: alpha - beta,
            i_q: guide * 0.7 * 0.7 / 3.0,
        }
    }

    /// m, ½m′ (kg·m²), and a (kg·m), b (kg·m) of the guide's normal force on the slider,
    /// at the crank angle `phi` (rad).
    #[inline]
    pub(crate) fn at(&self, phi: f64) -> [f64; 4] {
        let (sin, cos) = phi.sin_cos();
        let (rs, rc) = (self.r * sin, self.r * cos);
        let (ex, ey) = (rs, self.g - rc);

        // κ and its logarithmic derivatives.
        let d1 = self.d_swing * sin;
        let d2 = self.d_swing * cos;
        let d = self.d_mean - d2;
        let f = self.four_l2 - d;
        let z = 1.0 / (d * f);
        let k = f * z.sqrt();
        let lz = -0.5 * self.four_l2 * z;
        let lambda = lz * d1;
        let mu = lz * (d2 - (f - d) * z * d1 * d1) + lambda * lambda;

        // P − Q, P′ and P″; e′ = (rc, rs), e″ = B′ = (−rs, rc), B″ = −e′.
        let (wx, wy) = (self.from_q[0] + k * ex, self.from_q[1] + k * ey);
        let (px1, py1) = (k * (lambda * ex + rc), k * (lambda * ey + rs));
        let lambda2 = lambda + lambda;
        let px2 = k * (mu * ex + lambda2 * rc - rs);
        let py2 = k * (mu * ey + lambda2 * rs + rc);

        // The guide.
        let s2 = wx * wx + wy * wy;
        let inv = 1.0 / s2;
        let t1 = (wx * py1 - wy * px1) * inv;
        let t2 = (wx * py2 - wy * px2 - 2.0 * t1 * (wx * px1 + wy * py1)) * inv;

        // M₁ P′ + M₂ B′ serves both inertias.
        let (hx, hy) = (self.m2 * rs, self.m2 * rc);
        let (gx, gy) = (self.m1 * px1 - hx, self.m1 * py1 + hy);
        let i1 = self.i_q * t1;
        let m = self.m0 + px1 * (gx - hx) + py1 * (gy + hy) + i1 * t1;
        let half = gx * px2 + gy * py2 - hy * px1 - hx * py1 + i1 * t2;

        let per_s = -inv * s2.sqrt();
        [m, half, i1 * per_s, self.i_q * t2 * per_s]
    }
}
