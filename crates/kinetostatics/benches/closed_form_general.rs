//! The single-dwell mechanism written by hand for bars of any length: the textbook chain of a
//! driven crank, a pinned dyad and a guided slider, with none of the shortcuts that the equal bars
//! of [`hand_written`](crate::hand_written) allow. The like-for-like of the general evaluator.
//!
//! With u = C − B and v = C − O, the dyad's position is the intersection of two circles; its rates
//! follow from B′ + β′ ẑ×u = γ′ ẑ×v by scalar products with v and u, and so do its accelerations.
//! A prime is d/dφ; × is the out-of-plane component of the vector product; SI units.

/// The constants of the mechanism, prepared once.
pub(crate) struct General {
    /// Crank AB and the dyad's bars BC and OC, m.
    crank: f64,
    bars: [f64; 2],
    /// O − A, m.
    base: [f64; 2],
    /// Q − A, m.
    pivot: [f64; 2],
    /// BP/BC, with P on the line BC.
    ratio: f64,
    /// About A, about the coupler's centre C, about O and about Q, kg m².
    inertias: [f64; 4],
    /// Coupler and slider, kg.
    masses: [f64; 2],
}

impl General {
    /// The single-dwell mechanism with its reconstructed dimensions and masses.
    pub(crate) fn new() -> Self {
        let (coupler, rocker, guide, slider) = (1.5, 0.75, 2.1, 0.5);
        Self {
            crank: 0.1,
            bars: [0.25, 0.25],
            base: [0.2, 0.0],
            pivot: [-0.2, 0.4],
            ratio: 2.0,
            inertias: [
                0.626,
                coupler * 0.5 * 0.5 / 12.0,
                rocker * 0.25 * 0.25 / 3.0,
                guide * 0.7 * 0.7 / 3.0,
            ],
            masses: [coupler, slider],
        }
    }

    /// m, ½m′ (kg·m²), and a (kg·m), b (kg·m) of the guide's normal force on the slider,
    /// at the crank angle `phi` (rad).
    #[inline(always)]
    pub(crate) fn at(&self, phi: f64) -> [f64; 4] {
        let (sin, cos) = phi.sin_cos();
        let (bx, by) = (self.crank * cos, self.crank * sin);
        let [i_crank, i_coupler, i_rocker, i_guide] = self.inertias;
        let [coupler, slider] = self.masses;

        // The triangle: u = t D + k ẑ×D with D = O − B, and v = u − D.
        let [bc, oc] = self.bars.map(|bar| bar * bar);
        let (dx, dy) = (self.base[0] - bx, self.base[1] - by);
        let inv = 1.0 / (dx * dx + dy * dy);
        let t = 0.5 + 0.5 * (bc - oc) * inv;
        let k = (bc * inv - t * t).sqrt();
        let (ux, uy) = (t * dx - k * dy, t * dy + k * dx);
        let (vx, vy) = (ux - dx, uy - dy);

        // Rates; B′ = (−by, bx).
        let inv = 1.0 / (ux * vy - uy * vx);
        let beta1 = (by * vx - bx * vy) * inv;
        let gamma1 = (by * ux - bx * uy) * inv;
        let (beta1_2, gamma1_2) = (beta1 * beta1, gamma1 * gamma1);
        let (cx1, cy1) = (-gamma1 * vy, gamma1 * vx);
        let px1 = -by - self.ratio * beta1 * uy;
        let py1 = bx + self.ratio * beta1 * ux;

        // Accelerations; B″ = −B.
        let hx = bx + beta1_2 * ux - gamma1_2 * vx;
        let hy = by + beta1_2 * uy - gamma1_2 * vy;
        let beta2 = (hx * vx + hy * vy) * inv;
        let gamma2 = (hx * ux + hy * uy) * inv;
        let (cx2, cy2) = (-gamma2 * vy - gamma1_2 * vx, gamma2 * vx - gamma1_2 * vy);
        let px2 = -bx - self.ratio * (beta2 * uy + beta1_2 * ux);
        let py2 = -by + self.ratio * (beta2 * ux - beta1_2 * uy);

        // The guide, along w = P − Q.
        let wx = bx + self.ratio * ux - self.pivot[0];
        let wy = by + self.ratio * uy - self.pivot[1];
        let s2 = wx * wx + wy * wy;
        let inv = 1.0 / s2;
        let theta1 = (wx * py1 - wy * px1) * inv;
        let theta2 = (wx * py2 - wy * px2 - 2.0 * theta1 * (wx * px1 + wy * py1)) * inv;

        let m = i_crank
            + coupler * (cx1 * cx1 + cy1 * cy1)
            + i_coupler * beta1_2
            + i_rocker * gamma1_2
            + slider * (px1 * px1 + py1 * py1)
            + i_guide * theta1 * theta1;
        let half = coupler * (cx1 * cx2 + cy1 * cy2)
            + i_coupler * beta1 * beta2
            + i_rocker * gamma1 * gamma2
            + slider * (px1 * px2 + py1 * py2)
            + i_guide * theta1 * theta2;
        let normal = -i_guide * inv * s2.sqrt();
        [m, half, normal * theta1, normal * theta2]
    }
}
