//! Coulomb friction: how much of each there is, when each answers to reactions that all of them make.
//!
//! ```text
//! F_j = −µ g(R_j) tanh(v/v₀),    R = R⁰ + Σ F_k R^k
//! g = r √(X² + Y²)  in a pin,    |N/2 + M/l| + |N/2 − M/l|  in a guide of length l
//! ```

use super::equations::Meshed;
use super::instant::Instant;
use super::{Unreduced, UnreducedError};
use crate::solve::Lu;
use dwell_geometry::{Component, JointKind, Reaction};
use dwell_kinetostatics::{Friction, LoadKind, Magnitude};
use faer::Mat;

const STEPS: usize = 100;
/// Newton's change of a friction, relative to the largest, that is none.
const SETTLED: f64 = 1e-15;

/// Reactions by row: without friction, and what a unit of each friction adds.
pub(super) struct Response {
    pub(super) without: Vec<f64>,
    pub(super) units: Vec<Vec<f64>>,
}

impl Unreduced {
    pub(super) fn check_friction(&self, kind: &LoadKind, friction: &Friction) -> bool {
        let joint = self.mechanism.joints.get(friction.joint.0);
        joint.is_some_and(|joint| match (joint.kind, kind) {
            (JointKind::Revolute, LoadKind::Torque { bodies }) => *bodies == joint.bodies,
            (JointKind::Prismatic { .. } | JointKind::Slot { .. }, LoadKind::Slide(guide)) => {
                guide.bodies == joint.bodies
            }
            _ => false,
        })
    }

    /// The loads that are frictions.
    pub(super) fn frictions(&self) -> Vec<(usize, Friction)> {
        let loads = self.loads.iter().enumerate();
        loads
            .filter_map(|(i, load)| match load.magnitude {
                Magnitude::Friction(friction) => Some((i, friction)),
                _ => None,
            })
            .collect()
    }

    /// The row of a joint's reaction.
    fn row(&self, friction: &Friction, component: Component) -> Option<usize> {
        let wanted = Reaction {
            joint: friction.joint,
            component,
        };
        self.mechanism.reactions().iter().position(|r| *r == wanted)
    }

    /// µ tanh(v/v₀).
    fn grip(&self, load: usize, friction: &Friction, at: &Instant) -> Option<f64> {
        let [_, speed] = match self.loads.get(load)?.kind {
            LoadKind::Slide(guide) => at.travel(guide.bodies, guide.points, guide.axis)?,
            LoadKind::Torque { bodies } => at.angle(bodies)?,
            _ => return None,
        };
        Some(friction.coefficient * (speed / friction.fade).tanh())
    }

    /// g, with its derivative by every row that it depends on.
    fn pressure(&self, friction: &Friction, reactions: &[f64]) -> (f64, Vec<(usize, f64)>) {
        let row = |component| {
            let row = self.row(friction, component)?;
            Some((row, reactions[row]))
        };
        if let (Some((i, x)), Some((j, y))) = (row(Component::X), row(Component::Y)) {
            let force = x.hypot(y);
            if force == 0.0 {
                return (0.0, vec![]);
            }
            let slope = friction.size / force;
            return (friction.size * force, vec![(i, slope * x), (j, slope * y)]);
        }
        let Some((i, n)) = row(Component::Normal) else {
            return (0.0, vec![]);
        };
        match row(Component::Moment) {
            Some((j, m)) if friction.size > 0.0 => {
                let [near, far] = [1.0, -1.0].map(|side| 0.5 * n + side * m / friction.size);
                let (s, t) = (near.signum(), far.signum());
                let slopes = vec![(i, 0.5 * (s + t)), (j, (s - t) / friction.size)];
                (near.abs() + far.abs(), slopes)
            }
            _ => (n.abs(), vec![(i, n.signum())]),
        }
    }
}

impl Meshed<'_> {
    /// The frictions that fit the reactions which they make.
    pub(super) fn rub(
        &self,
        frictions: &[(usize, Friction)],
        response: &Response,
        at: &Instant,
    ) -> Result<Vec<f64>, UnreducedError> {
        let n = frictions.len();
        if n == 0 {
            return Ok(vec![]);
        }
        let jams = UnreducedError::Jams { t: at.t };
        let grips: Option<Vec<f64>> = frictions
            .iter()
            .map(|(load, friction)| self.of.grip(*load, friction, at))
            .collect();
        let grips = grips.ok_or(UnreducedError::NotFinite { t: at.t })?;
        let mut force = vec![0.0_f64; n];
        for _ in 0..STEPS {
            let mut reactions = response.without.clone();
            for (force, unit) in force.iter().zip(&response.units) {
                reactions
                    .iter_mut()
                    .zip(unit)
                    .for_each(|(r, u)| *r += force * u);
            }
            let mut matrix = Mat::<f64>::identity(n, n);
            let mut step = Mat::zeros(n, 1);
            for (j, ((_, friction), grip)) in frictions.iter().zip(&grips).enumerate() {
                let (pressure, slopes) = self.of.pressure(friction, &reactions);
                step[(j, 0)] = -(force[j] + grip * pressure);
                for (k, unit) in response.units.iter().enumerate() {
                    let along: f64 = slopes.iter().map(|&(row, s)| s * unit[row]).sum();
                    matrix[(j, k)] += grip * along;
                }
            }
            let lu = Lu::new(matrix).map_err(|_| jams)?;
            lu.solve(&mut step);
            let (mut change, mut most) = (0.0_f64, 0.0_f64);
            for (j, force) in force.iter_mut().enumerate() {
                *force += step[(j, 0)];
                if !force.is_finite() {
                    return Err(jams);
                }
                change = change.max(step[(j, 0)].abs());
                most = most.max(force.abs());
            }
            if change <= SETTLED * most {
                return Ok(force);
            }
        }
        Err(jams)
    }
}
