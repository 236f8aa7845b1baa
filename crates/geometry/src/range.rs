//! How far a single actuator can go on the branch of the assembly, and the poses stored along
//! the way for the groups that need them.

use crate::error::{AssemblyError, PlaceError};
use crate::groups::Unknown;
use crate::place::{Guess, PER_TURN};
use crate::plan::{Assur, How, Kind, Plan, Pose};
use crate::plane::{Vec2, vec2};
use crate::scalar::{Dual, Scalar};
use crate::seeds::Seed;
use std::f64::consts::TAU;

/// The range of a single actuator's coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// It turns fully: every coordinate can be reached, with period 2π.
    Full,
    /// It turns fully, and the mechanism comes back after so many turns.
    Turns(u32),
    /// It turns between two limit positions or change points, rad.
    Between(f64, f64),
    /// A driven length goes from one limit position or change point to another, m.
    Stroke(f64, f64),
    /// No end was found, and the mechanism does not come back: a length, or gears; or there are
    /// several actuators.
    Endless,
    /// No end was found as far as it was followed, and no position is known beyond: rad or m.
    Followed(f64, f64),
}

/// Where a branch ends, and why.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// The coordinate, rad or m. A range that ends at a change point stops a millionth of a turn or so
    /// short of it, where digits begin to fail.
    pub q: f64,
    /// The group that cannot be followed any further.
    pub group: usize,
    /// Whether another branch meets this one there and could be followed: a change point; else it is
    /// a limit position, where the coordinate turns back.
    pub change_point: bool,
}

impl Range {
    /// The ends, where there are any.
    pub fn limits(self) -> Option<(f64, f64)> {
        match self {
            Self::Between(from, to) | Self::Stroke(from, to) | Self::Followed(from, to) => {
                Some((from, to))
            }
            Self::Full | Self::Turns(_) | Self::Endless => None,
        }
    }

    /// What can be added to the coordinate without a change of the pose, rad.
    pub fn period(self) -> Option<f64> {
        match self {
            Self::Full => Some(TAU),
            Self::Turns(turns) => Some(TAU * f64::from(turns)),
            _ => None,
        }
    }

    /// The coordinate within the range that is whole turns away from `q`: the same pose.
    ///
    /// # Errors
    /// [`PlaceError::OutOfRange`] where there is none.
    pub fn fold(self, q: f64) -> Result<f64, PlaceError> {
        let Some((from, to)) = self.limits() else {
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
        let turns = matches!(self, Self::Between(..));
        if turns && (from..=to).contains(&folded) && to - from < TAU {
            Ok(folded)
        } else {
            Err(PlaceError::OutOfRange { q, from, to })
        }
    }
}

/// Turns after which a branch that neither ends nor closes is given up.
const MOST_TURNS: u32 = 8;
/// A branch ends at a change point where a determinant has fallen to this part of its largest value
/// so far: its rounding is eps over that part, so any closer noise would decide which branch follows.
const ENDED: f64 = 1e-6;
/// A change point is told from a limit position by the product of the determinant and its slope: to
/// the former it falls as the determinant itself, to the latter (a square root) it stays as it is.
const FALLEN: f64 = 1e-3;
/// A step is taken if the tangents of all determinants stay clear of zero over so many times its
/// length: towards a limit position, where they fall as a square root, the distance left is halved.
const CLEAR: f64 = 4.0;
/// Two poses are one if they differ by less: rad, or of the lengths of a group.
const SAME: f64 = 1e-6;
/// Where the branch cannot be followed any further, the step is halved until it is this small, rad.
const SMALLEST_STEP: f64 = 2e-14;

impl Plan {
    /// Follows the branch from the start over the range of a single actuator, both ways, and
    /// stores the seeds. With several actuators there is no range to follow.
    pub(crate) fn follow(&mut self, start: &Pose<f64>) -> Result<(), AssemblyError> {
        if self.actuators() != 1 {
            self.range = Range::Endless;
            return Ok(());
        }
        let mut ahead = vec![start.clone()];
        let mut up = None;
        for turns in 1..=MOST_TURNS {
            up = self.walk(&mut ahead, 1.0, 1);
            if up.is_some() {
                break;
            }
            if self.angular[0] && self.same(start, ahead.last()) {
                self.store(&ahead);
                self.range = match turns {
                    1 => Range::Full,
                    turns => Range::Turns(turns),
                };
                return Ok(());
            }
        }
        let mut back = vec![start.clone()];
        let down = self.walk(&mut back, -1.0, MOST_TURNS);
        back.reverse();
        back.pop();
        back.extend(ahead);
        self.store(&back);
        self.ends = [down, up];
        let far = |pose: Option<&Pose<f64>>| pose.map_or(start.q[0], |p| p.q[0]);
        let (first, last) = (far(back.first()), far(back.last()));
        let [down, up] = [down.map(|_| first), up.map(|_| last)];
        self.range = match (down, up) {
            (Some(from), Some(to)) if self.angular[0] => Range::Between(from, to),
            (Some(from), Some(to)) => Range::Stroke(from, to),
            (None, None) if !self.groups.iter().any(|g| g.remembers) => Range::Endless,
            (None, None) => Range::Followed(first, last),
            // An end on one side only: the other is as far as it was followed.
            (from, to) => Range::Stroke(from.unwrap_or(first), to.unwrap_or(last)),
        };
        Ok(())
    }

    /// Walks some turns on from the last pose, noting each pose on the way; where the branch ends, if
    /// it does. It ends at a limit position, and at a change point, where two branches meet.
    fn walk(&self, noted: &mut Vec<Pose<f64>>, direction: f64, turns: u32) -> Option<End> {
        let remembers = self.groups.iter().any(|g| g.remembers);
        let mut pose = noted.last()?.clone();
        let q0 = pose.q[0];
        let Some(mut margins) = self.margins(&pose) else {
            return Some(End {
                q: q0,
                group: 0,
                change_point: false,
            });
        };
        let size = |m: &Dual| [m.v, (m.v * m.d).abs()];
        let mut largest: Vec<[f64; 2]> = margins.iter().map(size).collect();
        for k in 1..=turns as usize * PER_TURN {
            let target = if self.angular[0] {
                q0 + direction * TAU * k as f64 / PER_TURN as f64
            } else {
                q0 + direction * self.step(0) * k as f64
            };
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
                let met = advanced.as_ref().is_some_and(|(_, left)| ended(left));
                match advanced.filter(|_| !met) {
                    Some((reached, left)) => {
                        for (most, margin) in largest.iter_mut().zip(&left) {
                            let [value, product] = size(margin);
                            *most = [most[0].max(value), most[1].max(product)];
                        }
                        if !remembers && noted.len() > 1 {
                            // Only the ends are wanted.
                            noted.pop();
                        }
                        noted.push(reached.clone());
                        pose = reached;
                        margins = left;
                        fine *= 2.0;
                    }
                    None => {
                        fine = (next - pose.q[0]) * 0.5;
                        let unit = if self.angular[0] { 1.0 } else { self.reach };
                        if fine.abs() < SMALLEST_STEP * (unit + pose.q[0].abs()) {
                            let part = |g: &usize| margins[*g].v / largest[*g][0];
                            let group = (0..margins.len())
                                .min_by(|a, b| part(a).total_cmp(&part(b)))
                                .unwrap_or(0);
                            let margin = &margins[group];
                            let change_point = met || size(margin)[1] < FALLEN * largest[group][1];
                            // Where the determinant crosses zero, the last step is Newton's.
                            let left = if change_point {
                                -margin.v / margin.d
                            } else {
                                0.0
                            };
                            let near = left * direction > 0.0 && left.abs() < self.step(0);
                            return Some(End {
                                q: pose.q[0] + if near { left } else { 0.0 },
                                group,
                                change_point,
                            });
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
        for (own, &angle) in pose.angle.iter_mut().zip(&at.angle) {
            *own = Dual::lift(angle);
        }
        for (own, travel) in pose.slide.iter_mut().zip(&at.slide) {
            *own = Dual::lift(*travel);
        }
        let q = [Dual::variable(at.q[0])];
        self.place_from(&q, &mut pose, Guess::Pose).ok()?;
        let margin = |(g, assur): (usize, &Assur)| {
            let determinant = match &assur.kind {
                Kind::Pin(_) | Kind::Aim(_) => Dual::lift(1.0) / pose.inverse[g],
                Kind::Solved(solved) => solved.determinant(&pose),
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
            let Kind::Solved(solved) = &assur.kind else {
                continue;
            };
            if self.factor(g, solved, &mut pose).ok()?.sign * solved.branch <= 0.0 {
                return None;
            }
            if solved.how != How::Newton {
                continue;
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
            if !matches!(&assur.kind, Kind::Solved(s) if s.how == How::Newton) {
                continue;
            }
            for &unknown in &assur.group.unknowns {
                match unknown {
                    Unknown::Class(c) if self.counted[self.root_of(c)] => {
                        let f = self.root_of(c);
                        self.set_angle(c, from.angle[f] + motion.turn[f] * away, pose);
                    }
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

    /// Whether a pose is the start again.
    fn same(&self, start: &Pose<f64>, end: Option<&Pose<f64>>) -> bool {
        let Some(end) = end else {
            return false;
        };
        let there = |assur: &Assur| {
            assur.group.unknowns.iter().all(|&u| match u {
                Unknown::Class(c) => {
                    let f = self.root_of(c);
                    (start.turn[f] - end.turn[f]).norm() < SAME
                }
                Unknown::Slide(s) => (start.slide[s] - end.slide[s]).abs() < SAME * assur.size,
            })
        };
        self.groups.iter().all(there)
    }

    fn store(&mut self, poses: &[Pose<f64>]) {
        let mut motion = self.motion();
        let mut all: Vec<Vec<Seed>> = vec![Vec::new(); self.groups.len()];
        let mut gains: Vec<Vec<f64>> = vec![Vec::new(); self.groups.len()];
        if !self.groups.iter().any(|g| g.remembers) {
            return;
        }
        for pose in poses {
            self.speeds(pose, &[1.0], &mut motion);
            for (assur, seeds) in self.groups.iter().zip(&mut all) {
                if !assur.remembers {
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
                            let counted = self.counted[f];
                            let angle = vec2(pose.angle[f], 0.0);
                            let value = if counted { angle } else { pose.turn[f] };
                            (value, motion.turn[f])
                        }
                        Unknown::Slide(s) => (vec2(pose.slide[s], 0.0), motion.slide[s]),
                    };
                    seed.values.push(value);
                    seed.slopes.push(slope);
                }
                seeds.push(seed);
            }
        }
        for ((seeds, gains), assur) in all.iter_mut().zip(&mut gains).zip(&self.groups) {
            if let (Some(first), Some(last)) = (seeds.first(), seeds.last()) {
                let ends = first.values.iter().zip(&last.values);
                let counted = |u: &Unknown| match *u {
                    Unknown::Class(c) => self.counted[self.root_of(c)],
                    Unknown::Slide(_) => false,
                };
                *gains = ends
                    .zip(&assur.group.unknowns)
                    .map(|((a, b), u)| if counted(u) { b.x - a.x } else { 0.0 })
                    .collect();
            }
        }
        for ((assur, list), gains) in self.groups.iter_mut().zip(all).zip(gains) {
            assur.seeds = crate::seeds::Seeds { list, gains };
        }
    }
}
