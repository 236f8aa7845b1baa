//! How far a single actuator can turn on the branch of the assembly, and the poses stored along
//! the way for the groups that Newton's method places.

use crate::error::{AssemblyError, PlaceError};
use crate::groups::Unknown;
use crate::mechanism::BodyId;
use crate::place::Guess;
use crate::plan::{Assur, Kind, Plan, Pose};
use crate::plane::Vec2;
use crate::scalar::{Dual, Scalar};
use crate::seeds::{Seed, Seeds};
use std::f64::consts::TAU;

/// The range of a single actuator's coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// It turns fully: every coordinate can be reached, with period 2π.
    Full,
    /// It turns between two limit positions or change points, rad.
    Between(f64, f64),
}

impl Range {
    /// The coordinate within the range that is whole turns away from `q`: the same pose.
    ///
    /// # Errors
    /// [`PlaceError::OutOfRange`] where there is none.
    pub fn fold(self, q: f64) -> Result<f64, PlaceError> {
        let Self::Between(from, to) = self else {
            return Ok(q);
        };
        if !q.is_finite() {
            return Err(PlaceError::NotFinite { q });
        }
        if (from..=to).contains(&q) {
            return Ok(q);
        }
        let folded = q - TAU * ((q - from) / TAU).floor();
        // A range of more than a turn holds two poses at such a coordinate: neither is "the" pose.
        if (from..=to).contains(&folded) && to - from < TAU {
            Ok(folded)
        } else {
            Err(PlaceError::OutOfRange { q, from, to })
        }
    }
}

/// Steps to a turn. A group's pose changes little over 3°, so that Newton's method needs two or
/// three steps from the prediction; a position that changes faster is followed in finer steps.
const PER_TURN: usize = 120;
/// Turns after which a branch that neither ends nor closes is given up.
const MOST_TURNS: usize = 8;
/// A branch ends at a change point where a determinant has fallen to this part of its largest value
/// so far: its rounding is eps over that part, so any closer noise would decide which branch follows.
const ENDED: f64 = 1e-6;
/// A change point is told from a limit position by the product of the determinant and its slope: to
/// the former it falls as the determinant itself, to the latter (a square root) it stays as it is.
const FALLEN: f64 = 1e-3;
/// A step is taken if the tangents of all determinants stay clear of zero over so many times its
/// length: towards a limit position, where they fall as a square root, the distance left is halved.
const CLEAR: f64 = 4.0;
/// Where the branch cannot be followed any further, the step is halved until it is this small, rad.
const SMALLEST_STEP: f64 = 1e-13;

impl Plan {
    /// Follows the branch from the start over the range of a single actuator, both ways, and
    /// stores the seeds. With several actuators there is no range to follow.
    pub(crate) fn follow(&mut self, start: &Pose<f64>) -> Result<(), AssemblyError> {
        if self.actuators != 1 {
            return Ok(());
        }
        let mut ahead = vec![start.clone()];
        let mut up = self.walk(&mut ahead, 1.0, 1);
        if up.is_none() {
            if self.elsewhere(start, &ahead).is_none() {
                // The end of the turn is the start again.
                ahead.pop();
                self.store(&ahead);
                self.range = Range::Full;
                return Ok(());
            }
            up = self.walk(&mut ahead, 1.0, MOST_TURNS - 1);
        }
        let mut back = vec![start.clone()];
        let down = self.walk(&mut back, -1.0, MOST_TURNS);
        let (Some(from), Some(to)) = (down, up) else {
            let elsewhere = self.elsewhere(start, if up.is_none() { &ahead } else { &back });
            return Err(AssemblyError::NotPeriodic {
                bodies: elsewhere.unwrap_or_default(),
            });
        };
        back.reverse();
        back.pop();
        back.extend(ahead);
        self.store(&back);
        self.range = Range::Between(from, to);
        Ok(())
    }

    /// Walks some turns on from the last pose, noting each pose on the way; where the branch ends, if
    /// it does. It ends at a limit position, and at a change point, where two branches meet.
    fn walk(&self, noted: &mut Vec<Pose<f64>>, direction: f64, turns: usize) -> Option<f64> {
        let mut pose = noted.last()?.clone();
        let q0 = pose.q[0];
        let Some(mut margins) = self.margins(&pose) else {
            return Some(q0);
        };
        let size = |m: &Dual| [m.v, (m.v * m.d).abs()];
        let mut largest: Vec<[f64; 2]> = margins.iter().map(size).collect();
        for k in 1..=turns * PER_TURN {
            let target = q0 + direction * TAU * k as f64 / PER_TURN as f64;
            let mut fine = target - pose.q[0];
            while pose.q[0] != target {
                let left = target - pose.q[0];
                let next = if fine.abs() >= left.abs() {
                    target
                } else {
                    pose.q[0] + fine
                };
                let ended = |left: &[Dual]| {
                    let mut both = left.iter().zip(&largest);
                    both.any(|(margin, most)| {
                        let [value, product] = size(margin);
                        value < ENDED * most[0] && product < FALLEN * most[1]
                    })
                };
                let advanced = self.advance(&pose, &margins, next);
                match advanced.filter(|(_, left)| !ended(left)) {
                    Some((reached, left)) => {
                        for (most, margin) in largest.iter_mut().zip(&left) {
                            let [value, product] = size(margin);
                            *most = [most[0].max(value), most[1].max(product)];
                        }
                        noted.push(reached.clone());
                        pose = reached;
                        margins = left;
                        fine *= 2.0;
                    }
                    None => {
                        fine = (next - pose.q[0]) * 0.5;
                        if fine.abs() < SMALLEST_STEP * (1.0 + pose.q[0].abs()) {
                            return Some(pose.q[0]);
                        }
                    }
                }
            }
        }
        None
    }

    /// By group, the size of its determinant, with its derivative by the coordinate: how far the
    /// group is from where its branch ends. None where it has ended.
    fn margins(&self, at: &Pose<f64>) -> Option<Vec<Dual>> {
        let mut pose: Pose<Dual> = self.pose();
        for (own, turn) in pose.turn.iter_mut().zip(&at.turn) {
            *own = turn.lift();
        }
        for (own, travel) in pose.slide.iter_mut().zip(&at.slide) {
            *own = Dual::lift(*travel);
        }
        let q = [Dual::variable(at.q[0])];
        self.place_from(&q, &mut pose, Guess::Pose).ok()?;
        let margin = |(g, assur): (usize, &Assur)| {
            let determinant = match &assur.kind {
                Kind::Pin(_) | Kind::Aim(_) => Dual::lift(1.0) / pose.inverse[g],
                Kind::Newton(newton) => {
                    let n = assur.group.unknowns.len();
                    let (lu, _) = newton.factors(&pose, n);
                    (0..n).fold(Dual::lift(1.0), |product, i| product * lu[i * n + i])
                }
            };
            if determinant.v < 0.0 {
                -determinant
            } else {
                determinant
            }
        };
        Some(self.groups.iter().enumerate().map(margin).collect())
    }

    /// The pose at `q` on the same branch as a nearby pose, with its margins, if it can be told to
    /// be the same. Where the tangent of a margin, from either end, reaches zero within the step,
    /// two branches may meet in between: a parallelogram's margin falls to zero and rises again on
    /// the other branch, with the same sign at both ends.
    fn advance(
        &self,
        from: &Pose<f64>,
        margins: &[Dual],
        q: f64,
    ) -> Option<(Pose<f64>, Vec<Dual>)> {
        let pose = self.reach(from, q)?;
        let reach = CLEAR * (q - from.q[0]);
        let left = self.margins(&pose)?;
        let clear = |(a, b): (&Dual, &Dual)| a.v + a.d * reach > 0.0 && b.v - b.d * reach > 0.0;
        margins.iter().zip(&left).all(clear).then_some((pose, left))
    }

    /// The pose at `q` near another one, if every correction is small beside its prediction.
    fn reach(&self, from: &Pose<f64>, q: f64) -> Option<Pose<f64>> {
        let mut pose = from.clone();
        self.predict(from, q - from.q[0], &mut pose);
        let predicted = pose.clone();
        self.place_from(&[q], &mut pose, Guess::Pose).ok()?;
        for (g, assur) in self.groups.iter().enumerate() {
            let Kind::Newton(newton) = &assur.kind else {
                continue;
            };
            if self.factor(g, newton, &mut pose).ok()?.sign * newton.branch <= 0.0 {
                return None;
            }
            for &unknown in &assur.group.unknowns {
                // A correction as large as the step itself may have led to another branch.
                let (moved, corrected) = match unknown {
                    Unknown::Class(c) => {
                        let f = self.root_of(c);
                        let turned = |a: Vec2, b: Vec2| a.cross(b).atan2(a.dot(b)).abs();
                        (
                            turned(from.turn[f], predicted.turn[f]),
                            turned(predicted.turn[f], pose.turn[f]),
                        )
                    }
                    Unknown::Slide(s) => (
                        (predicted.slide[s] - from.slide[s]).abs() / assur.size,
                        (pose.slide[s] - predicted.slide[s]).abs() / assur.size,
                    ),
                };
                if corrected > 0.25 * moved.max(0.02) {
                    return None;
                }
            }
        }
        Some(pose)
    }

    /// First-order prediction of the Newton groups' unknowns.
    fn predict(&self, from: &Pose<f64>, away: f64, pose: &mut Pose<f64>) {
        let mut motion = self.motion();
        self.speeds(from, &[1.0], &mut motion);
        for assur in &self.groups {
            if !matches!(assur.kind, Kind::Newton(_)) {
                continue;
            }
            for &unknown in &assur.group.unknowns {
                match unknown {
                    Unknown::Class(c) => {
                        let f = self.root_of(c);
                        let by = Vec2::from_angle(motion.turn[f] * away);
                        pose.turn[f] = from.turn[f].turn(by);
                    }
                    Unknown::Slide(s) => pose.slide[s] = from.slide[s] + motion.slide[s] * away,
                }
            }
        }
    }

    /// The bodies that the last pose has elsewhere than the start; none if it is the same pose.
    fn elsewhere(&self, start: &Pose<f64>, poses: &[Pose<f64>]) -> Option<Vec<BodyId>> {
        let end = poses.last()?;
        let moved = |assur: &&Assur| {
            assur.group.unknowns.iter().any(|&u| match u {
                Unknown::Class(c) => {
                    let f = self.root_of(c);
                    (start.turn[f] - end.turn[f]).norm() > 1e-6
                }
                Unknown::Slide(s) => (start.slide[s] - end.slide[s]).abs() > 1e-6 * assur.size,
            })
        };
        let group = self.groups.iter().find(moved)?;
        Some(self.bodies_of(&group.group))
    }

    fn store(&mut self, poses: &[Pose<f64>]) {
        let mut motion = self.motion();
        let mut all: Vec<Vec<Seed>> = vec![Vec::new(); self.groups.len()];
        for pose in poses {
            self.speeds(pose, &[1.0], &mut motion);
            for (assur, seeds) in self.groups.iter().zip(&mut all) {
                if !matches!(assur.kind, Kind::Newton(_)) {
                    continue;
                }
                let mut seed = Seed {
                    q: pose.q[0],
                    ..Seed::default()
                };
                for &unknown in &assur.group.unknowns {
                    let (value, slope) = match unknown {
                        Unknown::Class(c) => {
                            let f = self.root_of(c);
                            (pose.turn[f], motion.turn[f])
                        }
                        Unknown::Slide(s) => (
                            Vec2 {
                                x: pose.slide[s],
                                y: 0.0,
                            },
                            motion.slide[s],
                        ),
                    };
                    seed.values.push(value);
                    seed.slopes.push(slope);
                }
                seeds.push(seed);
            }
        }
        for (assur, seeds) in self.groups.iter_mut().zip(all) {
            if let Kind::Newton(newton) = &mut assur.kind {
                newton.seeds = Seeds(seeds);
            }
        }
    }
}
