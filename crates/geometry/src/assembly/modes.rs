//! The assembly modes of a group without a closed form: Newton's method from the initial guess and from scattered
//! starts.

use crate::assembly::initial_guess::InitialGuess;
use crate::error::{AssemblyError, PositionError};
use crate::plan::{GroupKind, Plan, Pose};
use crate::plane::Vec2;
use crate::structure::groups::Unknown;
use dwell_numerics::qr;
use std::f64::consts::TAU;

/// One assembly mode of a group: the value of each unknown — (cos, sin) with the counted angle (rad), or zero with the
/// travel (m) — and the data that identify the mode.
pub(crate) struct AssemblyMode {
    pub(crate) values: Vec<(Vec2, f64)>,
    /// By pair: the travel of each slide, m.
    pub(crate) travels: Vec<(usize, f64)>,
    /// Sign of the determinant.
    pub(crate) branch: f64,
    /// Sign of the root in a closed form.
    pub(crate) root_sign: f64,
    /// Whether a length is negative: the same points on the line from the other end.
    pub(crate) has_negative_length: bool,
}

/// Angles tried for each class, besides the approximate ones, when Newton's method searches all assembly modes.
const TRIALS: usize = 4;
/// Bound on the starts of one group, from the hints and from anywhere.
const MAX_HINTED_STARTS: usize = 256;
const MAX_STARTS: usize = 1024;
/// Two assembly modes closer than this (rad, or relative to the group's size) are one.
pub(crate) const SAME_MODE: f64 = 1e-6;
/// Largest number of least-squares steps for the unknowns without a hint, and the step (rad) at which they stop:
/// Newton's method continues from there.
const MAX_SETTLING_STEPS: usize = 12;
const SETTLED: f64 = 1e-3;

/// The trial angles of one start, in their order.
struct Trial {
    remainder: u64,
    scattered: bool,
}

impl Trial {
    /// Starts of some unknowns: all combinations of the angles, or as many scattered ones as are allowed.
    fn starts(unknowns: usize, max: usize) -> impl Iterator<Item = Self> {
        let count = u32::try_from(unknowns).ok();
        let all = count.and_then(|n| TRIALS.checked_pow(n));
        let scattered = all.is_none_or(|all| all > max);
        (0..all.map_or(max, |all| all.min(max))).map(move |start| Self {
            remainder: start as u64,
            scattered,
        })
    }

    fn next_angle(&mut self) -> f64 {
        let trials = TRIALS as u64;
        let k = if self.scattered {
            // Counting up would leave all but the first unknowns where they are. The top bits of a
            // linear congruence (Knuth's multiplier) scatter.
            self.remainder = self
                .remainder
                .wrapping_add(1)
                .wrapping_mul(6_364_136_223_846_793_005);
            (self.remainder >> 32) % trials
        } else {
            let k = self.remainder % trials;
            self.remainder /= trials;
            k
        };
        // Off the axes, where many mechanisms are singular.
        0.3 + TAU * k as f64 / trials as f64
    }
}

impl Plan {
    /// All assembly modes that Newton's method finds.
    ///
    /// It starts from the hints first, with trial angles where there is no hint; then, whether or not that converged, from
    /// scattered angles, so that the mode nearest to the hints is selected among all that are found.
    pub(crate) fn modes_by_newton(
        &mut self,
        g: usize,
        initial_guess: &InitialGuess,
        pose: &mut Pose<f64>,
    ) -> Result<Vec<AssemblyMode>, AssemblyError> {
        let unknowns = self.groups[g].group.unknowns.clone();
        let hints = unknowns.iter().map(|&u| self.hint(u, initial_guess));
        let hints: Vec<Option<f64>> = hints.collect();
        let unhinted = unknowns
            .iter()
            .zip(&hints)
            .filter(|(u, hint)| matches!(u, Unknown::ClassAngle(_)) && hint.is_none());
        let hinted_trials = Trial::starts(unhinted.count(), MAX_HINTED_STARTS);
        let unhinted_trials = Trial::starts(unknowns.len(), MAX_STARTS);
        let hinted_trials = hinted_trials.map(|trial| (true, trial));
        let unhinted_trials = unhinted_trials.map(|trial| (false, trial));
        let mut modes: Vec<AssemblyMode> = Vec::new();
        let mut refused = None;
        for (hinted, trial) in hinted_trials.chain(unhinted_trials) {
            self.set_trial(g, hinted.then_some(hints.as_slice()), trial, pose);
            if hinted {
                self.fit_unhinted(g, &hints, pose);
            }
            match self.group_positions(g, pose) {
                Ok(()) => {
                    self.count_revolutions_near(g, &hints, pose);
                    let mode = self.found_mode(g, 1.0, pose);
                    // Of one pose with different revolution counts, the first comes from the hints.
                    if modes.iter().all(|other| self.modes_differ(g, other, &mode)) {
                        modes.push(mode);
                    }
                }
                Err(e) if e.group() == Some(g) => {
                    // Of all failures the one with the smallest residual is the most informative.
                    let residual_of = |e: &PositionError| match *e {
                        PositionError::NotConverged { residual, .. } => residual,
                        _ => f64::INFINITY,
                    };
                    let kept = refused.as_ref().map(residual_of);
                    if kept.is_none_or(|kept| residual_of(&e) < kept) {
                        refused = Some(e);
                    }
                }
                Err(e) => return Err(self.assembly_error(g, e)),
            }
        }
        match (modes.is_empty(), refused) {
            (true, Some(e)) => Err(self.assembly_error(g, e)),
            _ => Ok(modes),
        }
    }

    /// Sets a group's unknowns to their hints, and its classes to trial angles where there is none.
    /// Slides get trial values too, unless the hints determine them.
    fn set_trial(
        &self,
        g: usize,
        hints: Option<&[Option<f64>]>,
        mut trials: Trial,
        pose: &mut Pose<f64>,
    ) {
        let size = self.groups[g].size;
        let guess = |(i, &unknown): (usize, &Unknown)| match unknown {
            Unknown::ClassAngle(_) => {
                let hint = hints.and_then(|hints| hints[i]);
                let angle = hint.unwrap_or_else(|| trials.next_angle());
                (Vec2::from_angle(angle), angle)
            }
            Unknown::SlideTravel(_) if hints.is_some() => {
                let hint = hints.and_then(|hints| hints[i]);
                (Vec2::ZERO, hint.unwrap_or(0.0))
            }
            Unknown::SlideTravel(_) => (Vec2::ZERO, (trials.next_angle() - 3.0) * size / 6.0),
        };
        let unknowns = self.groups[g].group.unknowns.iter().enumerate();
        let guess: Vec<(Vec2, f64)> = unknowns.map(guess).collect();
        self.set_unknowns(g, &guess, pose);
    }

    /// The assembly mode in which a group has just been solved.
    pub(crate) fn found_mode(&self, g: usize, root_sign: f64, pose: &Pose<f64>) -> AssemblyMode {
        let branch = match &self.groups[g].kind {
            GroupKind::Factored(factored_group) if !factored_group.is_overdetermined() => {
                self.determinant_sign(factored_group, pose)
            }
            _ => root_sign,
        };
        let travels = self.slide_travels(g, pose);
        let is_length = |pair: usize| self.lowered.pairs[pair].kind.is_length();
        let mut lengths = travels.iter().filter(|(pair, _)| is_length(*pair));
        AssemblyMode {
            values: self.unknown_values(g, pose),
            branch,
            root_sign,
            has_negative_length: lengths.any(|(_, length)| *length < 0.0),
            travels,
        }
    }

    fn modes_differ(&self, g: usize, one: &AssemblyMode, other: &AssemblyMode) -> bool {
        let size = self.groups[g].size;
        let unknowns = &self.groups[g].group.unknowns;
        let both = one.values.iter().zip(&other.values);
        both.zip(unknowns).any(|(((a, x), (b, y)), u)| match u {
            Unknown::ClassAngle(_) => (*a - *b).norm() > SAME_MODE,
            Unknown::SlideTravel(_) => (x - y).abs() > SAME_MODE * (size + x.abs()),
        })
    }

    /// Fits the unknowns without a hint — slides, and lines that are no bodies — to the hinted ones by least squares
    /// (Gauss–Newton): from arbitrary values Newton's method on the whole group would leave the hints. The equations
    /// are linear in slides: without lines, one step suffices.
    fn fit_unhinted(&self, g: usize, hints: &[Option<f64>], pose: &mut Pose<f64>) {
        let GroupKind::Factored(factored_group) = &self.groups[g].kind else {
            return;
        };
        let unknowns = &self.groups[g].group.unknowns;
        let any_hint = hints.iter().any(Option::is_some);
        let slides = |i: usize| matches!(unknowns[i], Unknown::SlideTravel(_));
        let open: Vec<usize> = (0..unknowns.len())
            .filter(|&i| hints[i].is_none() && (any_hint || slides(i)))
            .collect();
        let (m, n) = (factored_group.rows, open.len());
        if n == 0 || n >= m {
            return;
        }
        let linear = open.iter().all(|&i| slides(i));
        let max_steps = if linear { 1 } else { MAX_SETTLING_STEPS };
        for _ in 0..max_steps {
            self.rotate_group(g, pose);
            self.residual(g, pose);
            self.assemble_jacobian(g, factored_group, pose);
            let entry = |i: usize, j: usize| {
                pose.lu[factored_group.lu_offset + i * factored_group.columns + open[j]]
            };
            let mut matrix: Vec<f64> = (0..m * n).map(|k| entry(k / n, k % n)).collect();
            let (mut heads, mut steps) = (vec![0.0; n], pose.workspace[..m].to_vec());
            if qr::factor(&mut matrix, &mut heads, m).pivot_ratio < SAME_MODE {
                return;
            }
            qr::solve(&matrix, &heads, m, &mut steps);
            let largest = steps[..n].iter().fold(0.0_f64, |s, step| s.max(step.abs()));
            // No line turns by more than a radian in one step.
            let fraction = if max_steps > 1 {
                1.0 / largest.max(1.0)
            } else {
                1.0
            };
            for (&i, step) in open.iter().zip(&steps) {
                self.subtract_step(g, unknowns[i], step * fraction, pose);
            }
            if largest < SETTLED {
                return;
            }
        }
    }

    /// Subtracts a step, rad or relative to the group's scale, from an unknown.
    fn subtract_step(&self, g: usize, unknown: Unknown, step: f64, pose: &mut Pose<f64>) {
        match unknown {
            Unknown::SlideTravel(slide) => pose.slide_travel[slide] -= step * self.groups[g].scale,
            Unknown::ClassAngle(class) => {
                let class_frame = self.class_frame(class);
                pose.rotation[class_frame] =
                    pose.rotation[class_frame].rotate(Vec2::from_angle(-step));
                if self.revolution_counted[class_frame] {
                    pose.angle[class_frame] -= step;
                }
            }
        }
    }

    /// Newton's method may have added whole revolutions. If the group also closes with the revolutions of the hints,
    /// this function takes these.
    fn count_revolutions_near(&self, g: usize, hints: &[Option<f64>], pose: &mut Pose<f64>) {
        let found = self.unknown_values(g, pose);
        let unknowns = &self.groups[g].group.unknowns;
        let mut nearer = found.clone();
        for ((value, &unknown), hint) in nearer.iter_mut().zip(unknowns).zip(hints) {
            if let (Unknown::ClassAngle(c), Some(hint)) = (unknown, hint)
                && self.revolution_counted[self.class_frame(c)]
            {
                value.1 += TAU * ((hint - value.1) / TAU).round();
            }
        }
        if nearer == found {
            return;
        }
        self.set_unknowns(g, &nearer, pose);
        let closed = self.group_positions(g, pose).is_ok();
        let reached = self.unknown_values(g, pose);
        let mut both = reached.iter().zip(&nearer).zip(unknowns);
        let same = both.all(|((a, b), u)| match u {
            Unknown::ClassAngle(_) => {
                (a.0 - b.0).norm() < SAME_MODE && (a.1 - b.1).abs() < SAME_MODE
            }
            Unknown::SlideTravel(_) => true,
        });
        if !(closed && same) {
            self.set_unknowns(g, &found, pose);
            // It closed there a moment ago.
            let _ = self.group_positions(g, pose);
        }
    }

    /// The value of each unknown of a group.
    pub(crate) fn unknown_values(&self, g: usize, pose: &Pose<f64>) -> Vec<(Vec2, f64)> {
        let value = |&unknown: &Unknown| match unknown {
            Unknown::ClassAngle(c) => {
                let class_frame = self.class_frame(c);
                // An angle whose revolutions are not counted adds nothing to its direction.
                let counted = self.revolution_counted[class_frame];
                let angle = if counted {
                    pose.angle[class_frame]
                } else {
                    0.0
                };
                (pose.rotation[class_frame], angle)
            }
            Unknown::SlideTravel(s) => (Vec2::ZERO, pose.slide_travel[s]),
        };
        self.groups[g].group.unknowns.iter().map(value).collect()
    }

    /// Sets a group's unknowns to values from [`unknown_values`](Self::unknown_values).
    pub(crate) fn set_unknowns(&self, g: usize, values: &[(Vec2, f64)], pose: &mut Pose<f64>) {
        for (&unknown, &(rotation, value)) in self.groups[g].group.unknowns.iter().zip(values) {
            match unknown {
                Unknown::ClassAngle(c) => {
                    pose.rotation[self.class_frame(c)] = rotation;
                    if self.revolution_counted[self.class_frame(c)] {
                        pose.angle[self.class_frame(c)] = value;
                    }
                }
                Unknown::SlideTravel(s) => pose.slide_travel[s] = value,
            }
        }
    }
}
