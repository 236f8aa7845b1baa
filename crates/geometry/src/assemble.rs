//! Putting the mechanism together at the start, on the branch that the rough angles pick.

use crate::error::{AssemblyError, PlaceError};
use crate::frames::{Attitude, Turning};
use crate::groups::Unknown;
use crate::lower::{Measure, Tie};
use crate::place::{Guess, turn};
use crate::plan::{Branches, How, Kind, Plan, Pose};
use crate::plane::Vec2;
use crate::tall;
use std::f64::consts::TAU;

/// One way a group closes: the value of each unknown — (cos, sin), and its counted angle, or its
/// travel — and what says which way it is.
struct Way {
    values: Vec<(Vec2, f64)>,
    /// Sign of the determinant.
    branch: f64,
    /// Sign of the root in a closed form.
    side: f64,
    /// Whether a length is negative: the same points on the line from the other end.
    backward: bool,
}

/// Angles tried for each class, besides the rough ones, when Newton's method looks for
/// all the ways in which a group closes.
const TRIALS: usize = 4;
/// Bound on the starts of one group, from the hints and from anywhere.
const MOST_NEAR_STARTS: usize = 256;
const MOST_STARTS: usize = 1024;
/// Two ways closer than this (rad) are one.
const SAME: f64 = 1e-6;

impl Plan {
    /// Finds the branch of every group at the start.
    pub(crate) fn assemble(&mut self, rough: &[Option<f64>]) -> Result<Pose<f64>, AssemblyError> {
        let mut pose = self.pose();
        let q = self.start.clone();
        pose.q.clone_from(&q);
        self.count_bodies(rough);
        for g in 0..self.groups.len() {
            self.begin(g, rough, &mut pose);
            let ways = match &self.groups[g].kind {
                Kind::Solved(solved) if solved.how == How::Newton => {
                    self.ways_by_newton(g, rough, &mut pose)?
                }
                Kind::Solved(solved) if matches!(solved.how, How::Linear | How::Geared) => {
                    vec![self.way(g, 1.0, &mut pose)?]
                }
                _ => vec![self.way(g, 1.0, &mut pose)?, self.way(g, -1.0, &mut pose)?],
            };
            let way = self.pick(g, ways, rough)?;
            match &mut self.groups[g].kind {
                Kind::Pin(pin) => pin.branch = way.side,
                Kind::Aim(aim) => aim.branch = way.side,
                Kind::Solved(solved) => (solved.branch, solved.side) = (way.branch, way.side),
            }
            self.set(g, &way.values, &mut pose);
            self.place_group(g, &mut pose)
                .map_err(|e| self.refusal(g, e))?;
        }
        self.place_from(&q, &mut pose, Guess::Pose)
            .map_err(|e| self.refusal(self.groups.len(), e))?;
        Ok(pose)
    }

    /// Bodies that turn together may be whole turns apart: each is counted from its own rough angle.
    fn count_bodies(&mut self, rough: &[Option<f64>]) {
        let mut turns = vec![0.0; self.lowered.bodies];
        for class in 0..self.frames.classes {
            if !self.counted[self.class_roots[class]] {
                continue;
            }
            let apart = |b: usize| {
                let attitude = self.frames.attitudes[b];
                let angle = rough.get(b).copied().flatten()?;
                Some(angle - attitude.offset.angle() - self.driven_angle(attitude.frame))
            };
            let members = &self.frames.members[class];
            let first = match class {
                0 => Some(0.0),
                _ => members.iter().find_map(|&b| apart(b)),
            };
            for &b in members {
                if let (Some(first), Some(own)) = (first, apart(b)) {
                    turns[b] = TAU * ((own - first) / TAU).round();
                }
            }
        }
        for (row, ratio) in self.relations.iter_mut().zip(&self.lowered.ratios) {
            let whole = |sum: &[(Measure, f64)]| -> f64 {
                let each = sum.iter().map(|&(measure, factor)| match measure {
                    Measure::Angle(b) => factor * turns[b],
                    Measure::Travel(_) => 0.0,
                });
                each.sum()
            };
            row.of.constant += whole(&ratio.of);
            if let (Some((_, by)), Some((_, sum))) = (&mut row.law, &ratio.law) {
                by.constant += whole(sum);
            }
        }
        self.turns = turns;
    }

    /// Before a group is placed for the first time: turns are counted from the rough angles, and
    /// gears mesh as they are given.
    fn begin(&mut self, g: usize, rough: &[Option<f64>], pose: &mut Pose<f64>) {
        for unknown in self.groups[g].group.unknowns.clone() {
            if let Unknown::Class(class) = unknown
                && self.counted[self.root_of(class)]
            {
                let hint = self.hints(unknown, rough).first().copied();
                self.set_angle(class, hint.unwrap_or(0.0), pose);
            }
        }
        for driven in &self.groups[g].driven {
            turn(driven, pose);
        }
        for r in self.groups[g].group.relations.clone() {
            if self.relations[r].as_assembled {
                let open = self.relations[r].value(&pose.angle, &pose.slide);
                self.relations[r].of.constant -= open;
                self.relations[r].as_assembled = false;
            }
        }
    }

    /// The way in which a closed form closes its group with one of the signs of its root.
    fn way(&mut self, g: usize, side: f64, pose: &mut Pose<f64>) -> Result<Way, AssemblyError> {
        match &mut self.groups[g].kind {
            Kind::Pin(pin) => pin.branch = side,
            Kind::Aim(aim) => aim.branch = side,
            Kind::Solved(solved) => solved.side = side,
        }
        self.place_group(g, pose).map_err(|e| self.refusal(g, e))?;
        let branch = match &self.groups[g].kind {
            Kind::Solved(solved) => self.sign(solved, pose),
            _ => side,
        };
        Ok(Way {
            values: self.values(g, pose),
            branch,
            side,
            backward: self.backward(g, pose),
        })
    }

    /// Whether a line of a group is measured from its far end.
    fn backward(&self, g: usize, pose: &Pose<f64>) -> bool {
        let is_length = |bond: usize| {
            matches!(
                self.lowered.bonds[bond].tie,
                Tie::Slide { length: true, .. }
            )
        };
        let group = &self.groups[g].group;
        let travels = group.loops.iter().any(|&l| {
            let closure = &self.closures[l];
            closure.axis.is_some() && is_length(closure.bond) && pose.travel[l] < 0.0
        });
        let slides = group.unknowns.iter().any(|u| match *u {
            Unknown::Slide(s) => is_length(self.tree.slides[s]) && pose.slide[s] < 0.0,
            Unknown::Class(_) => false,
        });
        travels || slides
    }

    /// All the ways that Newton's method finds from the rough angles and a grid of others.
    fn ways_by_newton(
        &mut self,
        g: usize,
        rough: &[Option<f64>],
        pose: &mut Pose<f64>,
    ) -> Result<Vec<Way>, AssemblyError> {
        let unknowns = self.groups[g].group.unknowns.clone();
        let hints: Vec<Option<f64>> = unknowns
            .iter()
            .map(|&u| self.hints(u, rough).first().copied())
            .collect();
        // The hints first, with every other angle where they say nothing; then, whether or not
        // they lead anywhere, a grid of others, so that the way nearest to the hints is picked among
        // all that are found.
        let grid = |unknowns: usize, most: usize| {
            let count = u32::try_from(unknowns).ok();
            let starts = count.and_then(|n| TRIALS.checked_pow(n));
            starts.map_or(most, |s| s.min(most))
        };
        let untold =
            |(u, hint): (&Unknown, &Option<f64>)| matches!(u, Unknown::Class(_)) && hint.is_none();
        let hintless = unknowns.iter().zip(&hints).filter(|&u| untold(u)).count();
        let near = grid(hintless, MOST_NEAR_STARTS);
        let starts = near + grid(unknowns.len(), MOST_STARTS);
        let mut ways: Vec<Way> = Vec::new();
        let mut refused = None;
        for start in 0..starts {
            let by_hints = start < near;
            let mut left = if by_hints { start } else { start - near };
            let size = self.groups[g].size;
            let guess: Vec<(Vec2, f64)> = unknowns
                .iter()
                .zip(&hints)
                .map(|(&unknown, hint)| {
                    if let (true, Some(hint)) = (by_hints, *hint) {
                        return (Vec2::from_angle(hint), hint);
                    }
                    if let (true, Unknown::Slide(_)) = (by_hints, unknown) {
                        return (Vec2::ZERO, 0.0);
                    }
                    let k = left % TRIALS;
                    left /= TRIALS;
                    // Off the axes, where many mechanisms are singular.
                    let trial = 0.3 + TAU * k as f64 / TRIALS as f64;
                    match unknown {
                        Unknown::Class(_) => (Vec2::from_angle(trial), trial),
                        Unknown::Slide(_) => (Vec2::ZERO, (trial - 3.0) * size / 6.0),
                    }
                })
                .collect();
            self.set(g, &guess, pose);
            if by_hints {
                self.settle_slides(g, pose);
            }
            match self.place_group(g, pose) {
                Ok(()) => {
                    self.count_near(g, &hints, pose);
                    let values = self.values(g, pose);
                    let Kind::Solved(solved) = &self.groups[g].kind else {
                        break;
                    };
                    let branch = if solved.tall() {
                        1.0
                    } else {
                        self.sign(solved, pose)
                    };
                    let far = |way: &Way| {
                        let both = way.values.iter().zip(&values);
                        both.zip(&unknowns).any(|(((a, x), (b, y)), u)| match u {
                            Unknown::Class(_) => (*a - *b).norm() > SAME,
                            Unknown::Slide(_) => (x - y).abs() > SAME * (size + x.abs()),
                        })
                    };
                    // Of one pose with other counts of turns, the first comes from the hints.
                    if ways.iter().all(far) {
                        ways.push(Way {
                            values,
                            branch,
                            side: 1.0,
                            backward: self.backward(g, pose),
                        });
                    }
                }
                Err(e) if e.group() == Some(g) => {
                    // Of all refusals the one that came nearest tells most.
                    let open = |e: &PlaceError| match *e {
                        PlaceError::NotClosed { residual, .. } => residual,
                        _ => f64::INFINITY,
                    };
                    if refused.as_ref().is_none_or(|kept| open(&e) < open(kept)) {
                        refused = Some(e);
                    }
                }
                Err(e) => return Err(self.refusal(g, e)),
            }
        }
        match (ways.is_empty(), refused) {
            (true, Some(e)) => Err(self.refusal(g, e)),
            _ => Ok(ways),
        }
    }

    /// Puts a group's slides where its angles want them, by least squares: its equations are linear
    /// in the slides.
    fn settle_slides(&self, g: usize, pose: &mut Pose<f64>) {
        let Kind::Solved(solved) = &self.groups[g].kind else {
            return;
        };
        let unknowns = &self.groups[g].group.unknowns;
        let slides: Vec<usize> = (0..unknowns.len())
            .filter(|&i| matches!(unknowns[i], Unknown::Slide(_)))
            .collect();
        let (m, n) = (solved.rows, slides.len());
        if n == 0 || n >= m {
            return;
        }
        self.turn_group(g, pose);
        self.residual(g, pose);
        self.assemble_jacobian(g, solved, pose);
        let entry = |i: usize, j: usize| pose.lu[solved.lu + i * solved.columns + slides[j]];
        let mut matrix: Vec<f64> = (0..m * n).map(|k| entry(k / n, k % n)).collect();
        let (mut beside, mut open) = (vec![0.0; n], pose.work[..m].to_vec());
        if tall::factor(&mut matrix, &mut beside, m).measure < SAME {
            return;
        }
        tall::solve(&matrix, &beside, m, &mut open);
        for (&i, step) in slides.iter().zip(&open) {
            if let Unknown::Slide(slide) = unknowns[i] {
                pose.slide[slide] -= step * self.groups[g].scale;
            }
        }
    }

    /// Newton's method may have gone round: where the group closes with the turns that the hints
    /// mean, it is left with those.
    fn count_near(&self, g: usize, hints: &[Option<f64>], pose: &mut Pose<f64>) {
        let found = self.values(g, pose);
        let unknowns = &self.groups[g].group.unknowns;
        let mut nearer = found.clone();
        for ((value, &unknown), hint) in nearer.iter_mut().zip(unknowns).zip(hints) {
            if let (Unknown::Class(c), Some(hint)) = (unknown, hint)
                && self.counted[self.root_of(c)]
            {
                value.1 += TAU * ((hint - value.1) / TAU).round();
            }
        }
        if nearer == found {
            return;
        }
        self.set(g, &nearer, pose);
        let closed = self.place_group(g, pose).is_ok();
        let there = self.values(g, pose);
        let same = there
            .iter()
            .zip(&nearer)
            .zip(unknowns)
            .all(|((a, b), u)| match u {
                Unknown::Class(_) => (a.0 - b.0).norm() < SAME && (a.1 - b.1).abs() < SAME,
                Unknown::Slide(_) => true,
            });
        if !(closed && same) {
            self.set(g, &found, pose);
            // It closed there a moment ago.
            let _ = self.place_group(g, pose);
        }
    }

    /// The rough angles of an unknown, from all the bodies that turn with it.
    fn hints(&self, unknown: Unknown, rough: &[Option<f64>]) -> Vec<f64> {
        let Unknown::Class(class) = unknown else {
            return Vec::new();
        };
        let of_body = |(b, (attitude, angle)): (usize, (&Attitude, &Option<f64>))| {
            let frame = &self.frames.frames[attitude.frame];
            let angle = (*angle)? - self.turns.get(b).copied().unwrap_or(0.0);
            (frame.class == class)
                .then(|| angle - attitude.offset.angle() - self.driven_angle(attitude.frame))
        };
        let bodies = self.frames.attitudes.iter().zip(rough);
        bodies.enumerate().filter_map(of_body).collect()
    }

    /// The angle of a frame from the first frame of its class, at the start.
    fn driven_angle(&self, mut frame: usize) -> f64 {
        let mut angle = 0.0;
        while let Turning::Driven {
            parent,
            actuator,
            sign,
        } = self.frames.frames[frame].turning
        {
            angle += sign * self.start[actuator];
            frame = parent;
        }
        angle
    }

    /// Of several ways, the one nearest to the rough angles.
    fn pick(
        &mut self,
        g: usize,
        mut ways: Vec<Way>,
        rough: &[Option<f64>],
    ) -> Result<Way, AssemblyError> {
        // A line is measured from its first point, unless nothing else is possible.
        if ways.iter().any(|way| !way.backward) {
            ways.retain(|way| !way.backward);
        }
        let unknowns = &self.groups[g].group.unknowns;
        let distance = |way: &Way| -> f64 {
            unknowns
                .iter()
                .zip(&way.values)
                .flat_map(|(&u, &(value, angle))| {
                    let counted = matches!(u, Unknown::Class(c) if self.counted[self.root_of(c)]);
                    let hints = self.hints(u, rough).into_iter();
                    hints.map(move |hint| {
                        // Where turns count, the rough angle says which one is meant.
                        let apart = value - Vec2::from_angle(hint);
                        let turned = angle - hint;
                        if counted {
                            turned * turned
                        } else {
                            apart.dot(apart)
                        }
                    })
                })
                .sum()
        };
        ways.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let ambiguous = ways.len() > 1 && distance(&ways[1]) - distance(&ways[0]) < SAME;
        let branches = self.told_apart(g, &ways);
        if ambiguous {
            return Err(AssemblyError::Ambiguous {
                bodies: branches.bodies,
                choices: branches.ways,
            });
        }
        self.branches.push(branches);
        ways.into_iter()
            .next()
            .ok_or_else(|| AssemblyError::CannotClose {
                bodies: self.group_bodies(g),
                joints: self.group_joints(g),
                gap: f64::NAN,
            })
    }

    /// The bodies whose angles tell some ways apart, and those angles.
    fn told_apart(&self, g: usize, ways: &[Way]) -> Branches {
        let unknowns = &self.groups[g].group.unknowns;
        let bodies: Vec<_> = self
            .group_bodies(g)
            .into_iter()
            .filter(|b| {
                let frame = self.frames.attitudes[b.0].frame;
                unknowns
                    .iter()
                    .any(|&u| matches!(u, Unknown::Class(c) if self.root_of(c) == frame))
            })
            .collect();
        let angle = |way: &Way, body: usize| {
            let attitude = self.frames.attitudes[body];
            unknowns
                .iter()
                .zip(&way.values)
                .find_map(|(&u, (value, _))| match u {
                    Unknown::Class(c) if self.root_of(c) == attitude.frame => {
                        Some(value.turn(attitude.offset).angle())
                    }
                    _ => None,
                })
                .unwrap_or(f64::NAN)
        };
        let ways = ways
            .iter()
            .map(|way| bodies.iter().map(|b| angle(way, b.0)).collect())
            .collect();
        Branches { bodies, ways }
    }

    fn refusal(&self, g: usize, error: PlaceError) -> AssemblyError {
        let g = error.group().unwrap_or(g);
        let (bodies, joints) = if g < self.groups.len() {
            (self.group_bodies(g), self.group_joints(g))
        } else {
            (Vec::new(), Vec::new())
        };
        match error {
            PlaceError::Singular { .. } => AssemblyError::SingularStart { bodies, joints },
            PlaceError::Unreachable { gap, .. } | PlaceError::NotClosed { residual: gap, .. } => {
                AssemblyError::CannotClose {
                    bodies,
                    joints,
                    gap,
                }
            }
            PlaceError::OtherBranch { .. }
            | PlaceError::OutOfRange { .. }
            | PlaceError::NotFinite { .. } => AssemblyError::CannotClose {
                bodies,
                joints,
                gap: f64::NAN,
            },
        }
    }

    fn values(&self, g: usize, pose: &Pose<f64>) -> Vec<(Vec2, f64)> {
        let value = |&unknown: &Unknown| match unknown {
            Unknown::Class(c) => {
                let root = self.root_of(c);
                // An angle that is not counted tells nothing that its direction does not.
                let angle = if self.counted[root] {
                    pose.angle[root]
                } else {
                    0.0
                };
                (pose.turn[root], angle)
            }
            Unknown::Slide(s) => (Vec2::ZERO, pose.slide[s]),
        };
        self.groups[g].group.unknowns.iter().map(value).collect()
    }

    fn set(&self, g: usize, values: &[(Vec2, f64)], pose: &mut Pose<f64>) {
        for (&unknown, &(turn, value)) in self.groups[g].group.unknowns.iter().zip(values) {
            match unknown {
                Unknown::Class(c) => {
                    pose.turn[self.root_of(c)] = turn;
                    if self.counted[self.root_of(c)] {
                        pose.angle[self.root_of(c)] = value;
                    }
                }
                Unknown::Slide(s) => pose.slide[s] = value,
            }
        }
    }
}
