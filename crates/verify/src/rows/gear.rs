//! The row of a pair of gears in the plane, whose angles have to be counted.

use super::terms::{Ends, Term};
use crate::pose::Pose;
use std::f64::consts::TAU;

/// r2 (θ2 − ψ) ± r1 (θ1 − ψ) − c, with ψ the direction from the first centre to the second.
///
/// A whole revolution of ψ changes this by 2π (r2 ± r1), which is not a whole revolution of anything. So ψ has
/// to be counted as the angles are. Where one body holds both centres (the carrier, often the
/// ground), ψ turns with it, and its counted angle gives the revolution. Where no body does, it is the
/// turn that leaves the row least open: right near a closed pose, and blind to whole revolutions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gear {
    pub(crate) ends: Ends,
    /// The factors of θ1 and θ2: ±r1 and r2.
    factors: [f64; 2],
    /// The body that holds both centres.
    carrier: Option<usize>,
    ground: usize,
    /// ψ less the carrier's angle at the start, to any turn.
    phase_offset: f64,
    /// c.
    mesh_constant: f64,
}

impl Gear {
    /// A gear pair with pitch radii (m), and the body that holds both centres, if any.
    pub(crate) fn new(
        ends: Ends,
        radii: [f64; 2],
        internal: bool,
        carrier: Option<usize>,
        ground: usize,
    ) -> Self {
        let sense = if internal { -1.0 } else { 1.0 };
        Self {
            ends,
            factors: [sense * radii[0], radii[1]],
            carrier,
            ground,
            phase_offset: 0.0,
            mesh_constant: 0.0,
        }
    }

    /// The terms of the row that have derivatives, with their factors.
    pub(crate) fn terms(&self) -> [(f64, Term); 3] {
        let [first, second] = self.factors;
        let angle = |k: usize| Term::CountedAngle([self.ground, self.ends.bodies[k]]);
        [
            (first, angle(0)),
            (second, angle(1)),
            (-(first + second), Term::LineDirection(self.ends)),
        ]
    }

    /// Sets the constant so that the row is zero at these poses.
    pub(crate) fn mesh(&mut self, poses: &[Pose]) {
        let psi = Term::LineDirection(self.ends).value(poses);
        self.phase_offset = psi - self.carrier.map_or(0.0, |c| poses[c].angle);
        self.mesh_constant = self.sum(poses, psi);
    }

    pub(crate) fn residual(&self, poses: &[Pose], imposed: f64) -> f64 {
        let psi = Term::LineDirection(self.ends).value(poses);
        let residual = |psi: f64| self.sum(poses, psi) - self.mesh_constant - imposed;
        match self.carrier {
            Some(carrier) => {
                let about = self.phase_offset + poses[carrier].angle;
                residual(psi + TAU * ((about - psi) / TAU).round())
            }
            None => {
                let period = TAU * (self.factors[0] + self.factors[1]);
                let residual = residual(psi);
                // Equal radii of an internal pair: ψ does not matter at all.
                if period == 0.0 {
                    residual
                } else {
                    residual - period * (residual / period).round()
                }
            }
        }
    }

    fn sum(&self, poses: &[Pose], psi: f64) -> f64 {
        let relative = |k: usize| self.factors[k] * (poses[self.ends.bodies[k]].angle - psi);
        relative(0) + relative(1)
    }
}
