//! Putting the mechanism together at the start, on the branch that the rough angles pick.

use crate::error::{AssemblyError, PlaceError};
use crate::frames::{Attitude, Turning};
use crate::groups::Unknown;
use crate::lower::{Measure, Tie};
use crate::place::{Guess, turn};
use crate::plan::{Branches, How, Kind, Plan, Pose};
use crate::plane::Vec2;
use crate::ways::{SAME, Way};
use std::f64::consts::TAU;

impl Plan {
    /// Finds the branch of every group at the start.
    pub(crate) fn assemble(&mut self, rough: &[Option<f64>]) -> Result<Pose<f64>, AssemblyError> {
        let mut pose = self.pose();
        let q = self.start.clone();
        pose.q.clone_from(&q);
        self.count_bodies(rough);
        for g in 0..self.groups.len() {
            // A relation may count from a frame that is driven from what is placed already.
            self.place_before(g, &mut pose)
                .map_err(|e| self.refusal(g, e))?;
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
                let hint = self.hint(unknown, rough);
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
    pub(crate) fn backward(&self, g: usize, pose: &Pose<f64>) -> bool {
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

    /// The rough angles of an unknown, from all the bodies that turn with it.
    pub(crate) fn hints(&self, unknown: Unknown, rough: &[Option<f64>]) -> Vec<f64> {
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

    /// The rough angle of an unknown: a body's, or for a line of centres its carrier's and the lead.
    pub(crate) fn hint(&self, unknown: Unknown, rough: &[Option<f64>]) -> Option<f64> {
        if let Some(&hint) = self.hints(unknown, rough).first() {
            return Some(hint);
        }
        let Unknown::Class(class) = unknown else {
            return None;
        };
        let &(carrier, lead) = self.beside.get(&self.root_of(class))?;
        let beside = match self.frames.frames[carrier].class {
            0 => 0.0,
            of => *self.hints(Unknown::Class(of), rough).first()?,
        };
        Some(beside + self.driven_angle(carrier) + lead)
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
        let away = |way: usize| distance(&ways[way]).sqrt();
        let ambiguous = ways.len() > 1 && away(1) - away(0) < SAME;
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

    pub(crate) fn refusal(&self, g: usize, error: PlaceError) -> AssemblyError {
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
}
