//! Putting the mechanism together at the start, on the branch that is picked by what is known roughly.

use crate::error::{AssemblyError, PlaceError};
use crate::groups::Unknown;
use crate::lower::{Measure, Tie};
use crate::place::{Guess, turn};
use crate::plan::{How, Kind, Plan, Pose};
use crate::rough::Rough;
use crate::ways::{SAME, Way};
use std::f64::consts::TAU;

impl Plan {
    /// Finds the branch of every group at the start.
    pub(crate) fn assemble(&mut self, rough: &Rough) -> Result<Pose<f64>, AssemblyError> {
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
    fn count_bodies(&mut self, rough: &Rough) {
        let mut turns = vec![0.0; self.lowered.bodies];
        for class in 0..self.frames.classes {
            if !self.counted[self.class_roots[class]] {
                continue;
            }
            let apart = |b: usize| {
                let attitude = self.frames.attitudes[b];
                let angle = rough.angles[b]?;
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
    fn begin(&mut self, g: usize, rough: &Rough, pose: &mut Pose<f64>) {
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
            travels: self.travels(g, pose),
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

    /// Of several ways, the one nearest to what is known roughly.
    fn pick(&mut self, g: usize, mut ways: Vec<Way>, rough: &Rough) -> Result<Way, AssemblyError> {
        // A line is measured from its first point, unless nothing else is possible.
        if ways.iter().any(|way| !way.backward) {
            ways.retain(|way| !way.backward);
        }
        let apart: Vec<f64> = ways.iter().map(|way| self.astray(g, way, rough)).collect();
        let least = apart.iter().copied().fold(f64::INFINITY, f64::min);
        let mut order: Vec<usize> = (0..ways.len()).collect();
        order.sort_by(|&a, &b| apart[a].total_cmp(&apart[b]));
        let in_order =
            |picked: &[usize]| -> Vec<&Way> { picked.iter().map(|&k| &ways[k]).collect() };
        let nearest = order.partition_point(|&k| apart[k] - least < SAME);
        if nearest > 1 {
            let open = self.told_apart(g, &in_order(&order[..nearest]), rough);
            return Err(AssemblyError::Ambiguous {
                bodies: open.bodies,
                joints: open.joints,
                choices: open.ways,
            });
        }
        let branches = self.told_apart(g, &in_order(&order), rough);
        self.branches.push(branches);
        let first = order.first().copied();
        first
            .map(|first| ways.swap_remove(first))
            .ok_or_else(|| AssemblyError::CannotClose {
                bodies: self.group_bodies(g),
                joints: self.group_joints(g),
                gap: f64::NAN,
            })
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
            | PlaceError::NotFinite { .. }
            | PlaceError::Apart { .. } => AssemblyError::CannotClose {
                bodies,
                joints,
                gap: f64::NAN,
            },
        }
    }
}
