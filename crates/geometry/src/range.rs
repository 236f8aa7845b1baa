//! How far a single actuator can turn on the branch of the assembly, and the poses stored along
//! the way for the groups that Newton's method places.

use crate::error::{AssemblyError, PlaceError};
use crate::groups::Unknown;
use crate::place::Guess;
use crate::plan::{Assur, Kind, Plan, Pose};
use crate::plane::Vec2;
use crate::scalar::{Dual, Scalar};
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
        if (from..=to).contains(&q) {
            return Ok(q);
        }
        let folded = q - TAU * ((q - from) / TAU).floor();
        if (from..=to).contains(&folded) {
            Ok(folded)
        } else {
            Err(PlaceError::OutOfRange { q, from, to })
        }
    }
}

/// A stored pose of a Newton group.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seed {
    /// By unknown of the group: (cos, sin) of a class, or (travel, 0) of a slide.
    pub(crate) values: Vec<Vec2>,
    /// By unknown: its derivative with respect to the coordinate.
    pub(crate) slopes: Vec<f64>,
}

/// Poses at equal distances, from the start to both ends.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Seeds {
    pub(crate) step: f64,
    /// Index of the seed at the start.
    pub(crate) origin: usize,
    pub(crate) seeds: Vec<Seed>,
}

/// Seeds to a turn. A group's pose changes little over 3°, so that Newton's method needs two or
/// three steps from the prediction; a position that changes faster is followed in finer steps.
const PER_TURN: usize = 120;
/// Where the branch cannot be followed any further, the step is halved until it is this small, rad.
const SMALLEST_STEP: f64 = 1e-13;

impl Seeds {
    /// The seed nearest to `q`, and how far `q` is from it.
    pub(crate) fn nearest(
        &self,
        q: f64,
        range: Range,
        start: f64,
    ) -> Result<(&Seed, f64), PlaceError> {
        if range == Range::Full {
            return Ok(self.around(q - start));
        }
        let q = range.fold(q)?;
        let place = self.origin as f64 + ((q - start) / self.step).round();
        let index = place.clamp(0.0, self.seeds.len() as f64 - 1.0);
        let away = q - start - (index - self.origin as f64) * self.step;
        Ok((&self.seeds[index as usize], away))
    }

    fn around(&self, from_start: f64) -> (&Seed, f64) {
        let steps = (from_start / self.step).round();
        let index = steps.rem_euclid(self.seeds.len() as f64);
        // Taken over whole turns, the seeds repeat: only the distance to the node matters.
        (&self.seeds[index as usize], from_start - steps * self.step)
    }
}

impl Plan {
    /// Follows the branch from the start over the range of a single actuator, both ways, and
    /// stores the seeds. With several actuators there is no range to follow.
    pub(crate) fn follow(&mut self, start: &Pose<f64>) -> Result<(), AssemblyError> {
        if self.actuators != 1 {
            return Ok(());
        }
        let step = TAU / PER_TURN as f64;
        let mut ahead = Vec::new();
        let up = self.walk(start.clone(), step, PER_TURN, &mut ahead);
        if up.is_none() {
            self.check_period(start, &ahead)?;
            ahead.pop();
            self.store(&ahead, 0, step);
            self.range = Range::Full;
            return Ok(());
        }
        let mut back = Vec::new();
        let down = self.walk(start.clone(), -step, PER_TURN, &mut back);
        let q0 = self.start[0];
        // A limit on one side only cannot be: what turns fully one way turns back the same way.
        let from = down.unwrap_or(q0 - TAU);
        let to = up.unwrap_or(q0 + TAU);
        back.reverse();
        back.pop();
        let origin = back.len();
        back.extend(ahead);
        self.store(&back, origin, step);
        self.range = Range::Between(from, to);
        Ok(())
    }

    /// Walks `count` steps away from a pose, noting each; where the branch ends, if it does. It ends
    /// at a limit position, and at a change point, where two branches meet.
    fn walk(
        &self,
        mut pose: Pose<f64>,
        step: f64,
        count: usize,
        noted: &mut Vec<Pose<f64>>,
    ) -> Option<f64> {
        let q0 = pose.q[0];
        let Some(mut margins) = self.margins(&pose) else {
            return Some(q0);
        };
        noted.push(pose.clone());
        for k in 1..=count {
            let target = q0 + step * k as f64;
            let mut fine = step;
            while pose.q[0] != target {
                let left = target - pose.q[0];
                let next = if fine.abs() >= left.abs() {
                    target
                } else {
                    pose.q[0] + fine
                };
                match self.advance(&pose, &margins, next) {
                    Some((reached, left)) => {
                        pose = reached;
                        margins = left;
                        fine = (2.0 * fine.abs()).min(step.abs()).copysign(step);
                    }
                    None => {
                        fine = (next - pose.q[0]) * 0.5;
                        if fine.abs() < SMALLEST_STEP * (1.0 + pose.q[0].abs()) {
                            return Some(pose.q[0]);
                        }
                    }
                }
            }
            noted.push(pose.clone());
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
        let step = q - from.q[0];
        let left = self.margins(&pose)?;
        let clear = |(a, b): (&Dual, &Dual)| a.v + a.d * step > 0.0 && b.v - b.d * step > 0.0;
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

    /// After a whole turn every frame must be back where it was.
    fn check_period(&self, start: &Pose<f64>, ahead: &[Pose<f64>]) -> Result<(), AssemblyError> {
        let Some(end) = ahead.last() else {
            return Ok(());
        };
        for assur in &self.groups {
            let elsewhere = assur.group.unknowns.iter().any(|&u| match u {
                Unknown::Class(c) => {
                    let f = self.root_of(c);
                    (start.turn[f] - end.turn[f]).norm() > 1e-6
                }
                Unknown::Slide(s) => (start.slide[s] - end.slide[s]).abs() > 1e-6 * assur.size,
            });
            if elsewhere {
                return Err(AssemblyError::NotPeriodic {
                    bodies: self.bodies_of(&assur.group),
                });
            }
        }
        Ok(())
    }

    fn store(&mut self, poses: &[Pose<f64>], origin: usize, step: f64) {
        let mut motion = self.motion();
        let mut all: Vec<Vec<Seed>> = vec![Vec::new(); self.groups.len()];
        for pose in poses {
            self.speeds(pose, &[1.0], &mut motion);
            for (assur, seeds) in self.groups.iter().zip(&mut all) {
                if !matches!(assur.kind, Kind::Newton(_)) {
                    continue;
                }
                let mut seed = Seed::default();
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
                newton.seeds = Seeds {
                    step,
                    origin,
                    seeds,
                };
            }
        }
    }
}
