//! The row of a pair of gears, whose angles have to be counted.

use super::terms::{BodyCoordinates, BodyPoint, Column, ConstraintTerm, angle_of};
use crate::mechanism::{Joint, Mechanism};
use crate::plane::Vec2;
use std::f64::consts::TAU;

/// r2 (θ2 − ψ) ± r1 (θ1 − ψ) − c, with ψ the direction from the first centre to the second.
///
/// A whole revolution of ψ changes this by 2π (r2 ± r1), which is not a whole revolution of anything. So ψ has
/// to be counted as the angles of x are. Where one body holds both centres (the carrier, often the
/// ground), ψ turns with it, and its counted angle gives the revolution. Where no body does, it is the
/// turn that leaves the row least open: right near a closed pose, and blind to whole revolutions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gear {
    points: [BodyPoint; 2],
    /// The factors of θ1 and θ2: ±r1 and r2.
    factors: [f64; 2],
    /// The body that holds both centres.
    carrier: Option<Column>,
    /// ψ less the carrier's angle at the start, to any turn.
    phase_offset: f64,
    /// c.
    mesh_constant: f64,
}

/// Two points of one body are one centre when they are this close, in pitch radii: it decides only the number of
/// revolutions of ψ.
const SAME_CENTRE: f64 = 1e-6;

impl Gear {
    pub(super) fn new(
        mechanism: &Mechanism,
        joint: &Joint,
        points: [BodyPoint; 2],
        radii: [f64; 2],
        internal: bool,
        columns: &[Column],
    ) -> Self {
        let sense = if internal { -1.0 } else { 1.0 };
        let tolerance = SAME_CENTRE * (radii[0] + radii[1]);
        let holders = [0, 1].map(|i| at_centre(mechanism, joint, i, tolerance));
        let carrier = holders[0].iter().find(|b| holders[1].contains(b));
        Self {
            points,
            factors: [sense * radii[0], radii[1]],
            carrier: carrier.map(|&b| columns[b]),
            phase_offset: 0.0,
            mesh_constant: 0.0,
        }
    }

    /// The terms of the row that have derivatives, with their factors.
    pub(super) fn terms(&self) -> [(f64, ConstraintTerm); 3] {
        let [first, second] = self.factors;
        let angle = |i: usize| ConstraintTerm::RelativeAngle([None, self.points[i].column]);
        [
            (first, angle(0)),
            (second, angle(1)),
            (
                -(first + second),
                ConstraintTerm::LineDirection(self.points),
            ),
        ]
    }

    /// Sets the constant so that the row is zero at `x`.
    pub(super) fn mesh(&mut self, at: &BodyCoordinates<'_>, x: &[f64]) {
        let psi = ConstraintTerm::LineDirection(self.points).value(at);
        self.phase_offset = psi - self.carrier.map_or(0.0, |c| angle_of(c, x));
        self.mesh_constant = self.sum(x, psi);
    }

    /// The residual with the value `imposed`.
    pub(super) fn residual(&self, at: &BodyCoordinates<'_>, x: &[f64], prescribed: f64) -> f64 {
        let psi = ConstraintTerm::LineDirection(self.points).value(at);
        let residual = |psi: f64| self.sum(x, psi) - self.mesh_constant - prescribed;
        match self.carrier {
            Some(carrier) => {
                let about = self.phase_offset + angle_of(carrier, x);
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

    fn sum(&self, x: &[f64], psi: f64) -> f64 {
        let relative = |i: usize| self.factors[i] * (angle_of(self.points[i].column, x) - psi);
        relative(0) + relative(1)
    }
}

/// The bodies that have a point fixed in them at the centre of one gear, in which revolutes and
/// welds keep it.
fn at_centre(mechanism: &Mechanism, gear: &Joint, i: usize, tolerance: f64) -> Vec<usize> {
    let mut found: Vec<(usize, Vec2)> = vec![(gear.bodies[i].0, gear.points[i])];
    let mut next = 0;
    while let Some(&(body, point)) = found.get(next) {
        next += 1;
        for joint in &mechanism.joints {
            if !joint.kind.holds_points_together() {
                continue;
            }
            for (one, other) in [(0, 1), (1, 0)] {
                let at_point =
                    joint.bodies[one].0 == body && (joint.points[one] - point).norm() <= tolerance;
                let across = (joint.bodies[other].0, joint.points[other]);
                if at_point && !found.iter().any(|&(b, _)| b == across.0) {
                    found.push(across);
                }
            }
        }
    }
    found.into_iter().map(|(body, _)| body).collect()
}
