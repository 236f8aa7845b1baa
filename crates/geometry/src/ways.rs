//! The ways in which a group closes that has no closed form: Newton's method from what is known roughly,
//! and from anywhere.

use crate::error::{AssemblyError, PlaceError};
use crate::groups::Unknown;
use crate::plan::{Kind, Plan, Pose};
use crate::plane::Vec2;
use crate::rough::Rough;
use crate::tall;
use std::f64::consts::TAU;

/// One way a group closes: the value of each unknown — (cos, sin), and its counted angle, or its
/// travel — and what says which way it is.
pub(crate) struct Way {
    pub(crate) values: Vec<(Vec2, f64)>,
    /// By bond: the travel of each slide, m.
    pub(crate) travels: Vec<(usize, f64)>,
    /// Sign of the determinant.
    pub(crate) branch: f64,
    /// Sign of the root in a closed form.
    pub(crate) side: f64,
    /// Whether a length is negative: the same points on the line from the other end.
    pub(crate) backward: bool,
}

/// Angles tried for each class, besides the rough ones, when Newton's method looks for
/// all the ways in which a group closes.
const TRIALS: usize = 4;
/// Bound on the starts of one group, from the hints and from anywhere.
const MOST_NEAR_STARTS: usize = 256;
const MOST_STARTS: usize = 1024;
/// Two ways closer than this (rad) are one.
pub(crate) const SAME: f64 = 1e-6;
/// Steps in which lines settle, and the last of them (rad): Newton's method goes on from there.
const MOST_SETTLING: usize = 12;
const SETTLED: f64 = 1e-3;

/// Starts of some unknowns: all combinations of the trials, or as many scattered ones as are allowed.
#[derive(Clone, Copy)]
struct Trials {
    starts: usize,
    scattered: bool,
}

impl Trials {
    fn new(unknowns: usize, most: usize) -> Self {
        let count = u32::try_from(unknowns).ok();
        let all = count.and_then(|n| TRIALS.checked_pow(n));
        let scattered = all.is_none_or(|all| all > most);
        Self {
            starts: all.map_or(most, |all| all.min(most)),
            scattered,
        }
    }

    fn of(self, start: usize) -> Trial {
        Trial {
            left: start as u64,
            scattered: self.scattered,
        }
    }
}

/// The angles of one start, one after the other.
struct Trial {
    left: u64,
    scattered: bool,
}

impl Trial {
    fn angle(&mut self) -> f64 {
        let trials = TRIALS as u64;
        let k = if self.scattered {
            // Counting up would leave all but the first unknowns where they are. The top bits of a
            // linear congruence (Knuth's multiplier) scatter.
            self.left = self
                .left
                .wrapping_add(1)
                .wrapping_mul(6_364_136_223_846_793_005);
            (self.left >> 32) % trials
        } else {
            let k = self.left % trials;
            self.left /= trials;
            k
        };
        // Off the axes, where many mechanisms are singular.
        0.3 + TAU * k as f64 / trials as f64
    }
}

impl Plan {
    /// All the ways that Newton's method finds from the rough angles and from anywhere.
    ///
    /// From the hints first, with every other angle where they say nothing; then, whether or not
    /// they lead anywhere, from others, so that the way nearest to the hints is picked among all
    /// that are found.
    pub(crate) fn ways_by_newton(
        &mut self,
        g: usize,
        rough: &Rough,
        pose: &mut Pose<f64>,
    ) -> Result<Vec<Way>, AssemblyError> {
        let unknowns = self.groups[g].group.unknowns.clone();
        let hints: Vec<Option<f64>> = unknowns.iter().map(|&u| self.hint(u, rough)).collect();
        let untold =
            |(u, hint): (&Unknown, &Option<f64>)| matches!(u, Unknown::Class(_)) && hint.is_none();
        let hintless = unknowns.iter().zip(&hints).filter(|&u| untold(u)).count();
        let near = Trials::new(hintless, MOST_NEAR_STARTS);
        let anywhere = Trials::new(unknowns.len(), MOST_STARTS);
        let mut ways: Vec<Way> = Vec::new();
        let mut refused = None;
        for start in 0..near.starts + anywhere.starts {
            if start < near.starts {
                self.guess(g, Some(&hints), near.of(start), pose);
                self.settle(g, &hints, pose);
            } else {
                self.guess(g, None, anywhere.of(start - near.starts), pose);
            }
            match self.place_group(g, pose) {
                Ok(()) => {
                    self.count_near(g, &hints, pose);
                    let way = self.way_found(g, pose);
                    // Of one pose with other counts of turns, the first comes from the hints.
                    if ways.iter().all(|other| self.differ(g, other, &way)) {
                        ways.push(way);
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

    /// Puts a group's unknowns to their hints, and its classes to trial angles where there is none.
    /// Slides are at trials too, unless hints will settle them.
    fn guess(
        &self,
        g: usize,
        hints: Option<&[Option<f64>]>,
        mut trials: Trial,
        pose: &mut Pose<f64>,
    ) {
        let size = self.groups[g].size;
        let guess = |(i, &unknown): (usize, &Unknown)| match unknown {
            Unknown::Class(_) => {
                let hint = hints.and_then(|hints| hints[i]);
                let angle = hint.unwrap_or_else(|| trials.angle());
                (Vec2::from_angle(angle), angle)
            }
            Unknown::Slide(_) if hints.is_some() => {
                let hint = hints.and_then(|hints| hints[i]);
                (Vec2::ZERO, hint.unwrap_or(0.0))
            }
            Unknown::Slide(_) => (Vec2::ZERO, (trials.angle() - 3.0) * size / 6.0),
        };
        let unknowns = self.groups[g].group.unknowns.iter().enumerate();
        let guess: Vec<(Vec2, f64)> = unknowns.map(guess).collect();
        self.set(g, &guess, pose);
    }

    /// The way in which a group has just been placed.
    fn way_found(&self, g: usize, pose: &Pose<f64>) -> Way {
        let branch = match &self.groups[g].kind {
            Kind::Solved(solved) if !solved.tall() => self.sign(solved, pose),
            _ => 1.0,
        };
        Way {
            values: self.values(g, pose),
            travels: self.travels(g, pose),
            branch,
            side: 1.0,
            backward: self.backward(g, pose),
        }
    }

    fn differ(&self, g: usize, one: &Way, other: &Way) -> bool {
        let size = self.groups[g].size;
        let unknowns = &self.groups[g].group.unknowns;
        let both = one.values.iter().zip(&other.values);
        both.zip(unknowns).any(|(((a, x), (b, y)), u)| match u {
            Unknown::Class(_) => (*a - *b).norm() > SAME,
            Unknown::Slide(_) => (x - y).abs() > SAME * (size + x.abs()),
        })
    }

    /// Puts what hints leave open — slides, and lines that are no bodies — where the hints
    /// want it, by least squares (Gauss and Newton): started with it anywhere, the whole group would
    /// run away from the hints. The equations are linear in slides: without lines, one step does.
    fn settle(&self, g: usize, hints: &[Option<f64>], pose: &mut Pose<f64>) {
        let Kind::Solved(solved) = &self.groups[g].kind else {
            return;
        };
        let unknowns = &self.groups[g].group.unknowns;
        let told = hints.iter().any(Option::is_some);
        let slides = |i: usize| matches!(unknowns[i], Unknown::Slide(_));
        let open: Vec<usize> = (0..unknowns.len())
            .filter(|&i| hints[i].is_none() && (told || slides(i)))
            .collect();
        let (m, n) = (solved.rows, open.len());
        if n == 0 || n >= m {
            return;
        }
        let linear = open.iter().all(|&i| slides(i));
        let most = if linear { 1 } else { MOST_SETTLING };
        for _ in 0..most {
            self.turn_group(g, pose);
            self.residual(g, pose);
            self.assemble_jacobian(g, solved, pose);
            let entry = |i: usize, j: usize| pose.lu[solved.lu + i * solved.columns + open[j]];
            let mut matrix: Vec<f64> = (0..m * n).map(|k| entry(k / n, k % n)).collect();
            let (mut beside, mut steps) = (vec![0.0; n], pose.work[..m].to_vec());
            if tall::factor(&mut matrix, &mut beside, m).measure < SAME {
                return;
            }
            tall::solve(&matrix, &beside, m, &mut steps);
            let largest = steps[..n].iter().fold(0.0_f64, |s, step| s.max(step.abs()));
            // A line does not go round in one step.
            let part = if most > 1 {
                1.0 / largest.max(1.0)
            } else {
                1.0
            };
            for (&i, step) in open.iter().zip(&steps) {
                self.step_back(g, unknowns[i], step * part, pose);
            }
            if largest < SETTLED {
                return;
            }
        }
    }

    /// Takes a step, rad or relative to the group's size, from an unknown.
    fn step_back(&self, g: usize, unknown: Unknown, step: f64, pose: &mut Pose<f64>) {
        match unknown {
            Unknown::Slide(slide) => pose.slide[slide] -= step * self.groups[g].scale,
            Unknown::Class(class) => {
                let root = self.root_of(class);
                pose.turn[root] = pose.turn[root].turn(Vec2::from_angle(-step));
                if self.counted[root] {
                    pose.angle[root] -= step;
                }
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

    /// The value of each unknown of a group.
    pub(crate) fn values(&self, g: usize, pose: &Pose<f64>) -> Vec<(Vec2, f64)> {
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

    /// Puts a group's unknowns to what [`values`](Self::values) has said.
    pub(crate) fn set(&self, g: usize, values: &[(Vec2, f64)], pose: &mut Pose<f64>) {
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
