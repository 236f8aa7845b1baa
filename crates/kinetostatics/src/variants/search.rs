//! The mean and the extremes of periodic curves over a turn: from equally spaced positions, as many as the decay of the
//! last Fourier coefficients asks for, and from positions about the extremes.

mod local;

use crate::reduced::{LaneScalar, MAX_LANES};
use local::{Candidate, Interpolant, Peak};
use std::f64::consts::TAU;

/// Positions of the first rule, and of the last: next to a change point where more were needed, a curve has no more than
/// twelve digits.
const FIRST_POSITIONS: usize = 64;
const LAST_POSITIONS: usize = 1024;
/// The trapezoidal rule by N points errs by the coefficient of order N, about the square of that of order N/2 relative
/// to the mean. It has all digits if the last coefficients of √m are below this fraction of the mean.
const RESOLVED_MEAN: f64 = 1e-8;
/// An extreme is evaluated at its place: its curve needs to be known only so well that no other is taken for it.
const RESOLVED_CURVE: f64 = 1e-4;
/// The tangents of all determinants stay clear of zero over this number of steps in both directions: the follower's own
/// test of a branch.
const TANGENT_CLEARANCE: f64 = 4.0;

/// The largest or smallest value of a curve, and its coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extremum {
    /// The coordinate, rad, from 0 to 2π.
    pub q: f64,
    /// The value there, in the unit of the curve.
    pub value: f64,
}

/// The results of a turn of one variant.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Turn {
    /// Mean of √m over the turn, (kg m²)^½: 2π times it over √(2E) is the period of the free rotation.
    pub mean_root_m: f64,
    /// m at the wanted coordinate, kg m².
    pub m_at_start: f64,
    /// Smallest and largest m, kg m².
    pub m: [Extremum; 2],
    /// Smallest and largest ½m′, kg m².
    pub half_dm: [Extremum; 2],
    /// Mean of ½m′, and of its square, if [means](super::VariantModel::with_means) are wanted.
    pub half_dm_means: [f64; 2],
    /// By reaction: its value of largest magnitude in the free rotation, over 2E, 1/m or 1.
    pub free_reactions: Vec<Extremum>,
    /// The actuator force (N m), then each reaction (N or N m), of largest magnitude under the loads of the variants, if
    /// they are requested.
    pub loaded_forces: Vec<Extremum>,
    /// By these forces, if means are wanted: the smallest and the largest value.
    pub force_ends: Vec<[Extremum; 2]>,
    /// As these: the mean, and the mean of the square.
    pub force_means: Vec<[f64; 2]>,
    /// Positions of the rule that resolved it.
    pub positions: usize,
}

/// Positions with the values of all curves: m, ½m′, the reactions of the free rotation, then the forces under loads.
#[derive(Debug, Clone, Default)]
pub(super) struct Samples {
    /// The positions; the last one is repeated to fill the last lanes.
    q: Vec<f64>,
    count: usize,
    curves: Vec<Vec<f64>>,
    /// The largest square of a determinant's slope over that of the determinant, 1/rad².
    pub(super) steepness: f64,
}

impl Samples {
    /// The positions.
    #[inline(always)]
    pub(super) fn positions(&self) -> &[f64] {
        &self.q
    }

    /// The places of a curve's values from a position on.
    #[inline(always)]
    pub(super) fn values_from(&mut self, curve: usize, position: usize) -> &mut [f64] {
        &mut self.curves[curve][position..]
    }

    /// The values of a curve.
    fn values(&self, curve: usize) -> &[f64] {
        &self.curves[curve][..self.count]
    }

    /// Starts with the positions in `q`.
    fn take_positions(&mut self) {
        self.count = self.q.len();
        let last = self.q.last().copied().unwrap_or(0.0);
        let padded = self.count.next_multiple_of(MAX_LANES);
        self.q.resize(padded, last);
        for values in &mut self.curves {
            if values.len() < padded {
                values.resize(padded, f64::NAN);
            }
        }
    }
}

/// The stage of the search to which the samples belong.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// The positions of the first rule, or those between the positions of the rule before.
    Rule,
    /// The wanted position, then one or three about each peak.
    Peaks,
}

/// The data of a rule that all variants share.
#[derive(Debug, Clone, Default)]
struct RuleTable {
    /// The positions that the rule before has not.
    new: Vec<f64>,
    /// (−1)^i, and its products with the cosine and the sine of position i.
    alternating: [Vec<f64>; 3],
}

impl RuleTable {
    fn new(level: usize) -> Self {
        let count = FIRST_POSITIONS << level;
        let step = TAU / count as f64;
        let first = usize::from(level > 0);
        let mut table = Self {
            new: (first..count)
                .step_by(1 + first)
                .map(|i| step * i as f64)
                .collect(),
            ..Self::default()
        };
        for i in 0..count {
            let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
            let (sin, cos) = (step * i as f64).sin_cos();
            for (terms, term) in table.alternating.iter_mut().zip([1.0, cos, sin]) {
                terms.push(sign * term);
            }
        }
        table
    }
}

/// The search over one turn, stage by stage.
#[derive(Debug, Clone)]
pub(super) struct TurnSearch {
    pub(super) samples: Samples,
    stage: Stage,
    /// How often the first rule was doubled.
    level: usize,
    tables: Vec<RuleTable>,
    curves: Vec<Interpolant>,
    /// The largest steepness of the samples so far.
    steepness: f64,
    /// Whether the means of curves, and both ends of forces under loads, are wanted.
    pub(super) has_means: bool,
    candidates: Vec<Candidate>,
    peaks: Vec<Peak>,
    start: f64,
    turn: Turn,
    is_complete: bool,
}

impl TurnSearch {
    /// The first curve of a force under loads, after this many reactions of the free rotation.
    pub(super) fn first_force(reactions: usize) -> usize {
        2 + reactions
    }

    pub(super) fn new(reactions: usize, forces: usize) -> Self {
        let curves = Self::first_force(reactions) + forces;
        Self {
            samples: Samples {
                curves: vec![Vec::new(); curves],
                ..Samples::default()
            },
            stage: Stage::Rule,
            level: 0,
            tables: Vec::new(),
            curves: vec![Interpolant::default(); curves],
            steepness: 0.0,
            has_means: false,
            candidates: Vec::new(),
            peaks: Vec::new(),
            start: 0.0,
            turn: Turn {
                free_reactions: vec![Extremum::default(); reactions],
                loaded_forces: vec![Extremum::default(); forces],
                ..Turn::default()
            },
            is_complete: false,
        }
    }

    /// The next variant, whose m at a coordinate (rad) is wanted.
    pub(super) fn restart(&mut self, start: f64) {
        (self.start, self.stage, self.is_complete) = (start, Stage::Rule, false);
        (self.level, self.steepness) = (0, 0.0);
        self.curves.iter_mut().for_each(Interpolant::clear);
        self.ask_for_rule();
    }

    /// The results, if the search is complete.
    pub(super) fn turn(&self) -> Option<&Turn> {
        self.is_complete.then_some(&self.turn)
    }

    /// Asks for the positions of a rule that the one before has not.
    fn ask_for_rule(&mut self) {
        if self.tables.len() <= self.level {
            self.tables.push(RuleTable::new(self.level));
        }
        self.samples.q.clear();
        self.samples
            .q
            .extend_from_slice(&self.tables[self.level].new);
        self.samples.take_positions();
    }

    /// Takes the values of the samples; false where the search has ended.
    // What is generic is inlined, and compiled for the registers in which the samples were evaluated.
    #[inline(always)]
    pub(super) fn advance<S: LaneScalar>(&mut self) -> bool {
        match self.stage {
            Stage::Rule => self.take_rule::<S>(),
            Stage::Peaks => self.take_peaks(),
        }
    }

    /// Adds the positions of a rule, and doubles it unless it resolves the curves.
    #[inline(always)]
    fn take_rule<S: LaneScalar>(&mut self) -> bool {
        for (curve, values) in self.curves.iter_mut().enumerate() {
            values.add(self.samples.values(curve));
        }
        // What is no number stays.
        let steepness = self.samples.steepness;
        if steepness > self.steepness || steepness.is_nan() {
            self.steepness = steepness;
        }
        let count = FIRST_POSITIONS << self.level;
        let step = TAU / count as f64;
        let is_clear = self.steepness * (TANGENT_CLEARANCE * step).powi(2) < 1.0;
        let Some(is_resolved) = self.is_resolved::<S>() else {
            return false;
        };
        if is_clear && is_resolved {
            self.find_peaks::<S>();
            self.ask_for_peaks();
            return true;
        }
        if count >= LAST_POSITIONS {
            return false;
        }
        self.level += 1;
        self.ask_for_rule();
        true
    }

    /// Whether the last coefficients of √m and of all curves are small; `None` if m is not positive.
    #[inline(always)]
    fn is_resolved<S: LaneScalar>(&mut self) -> Option<bool> {
        let table = &self.tables[self.level];
        let count = FIRST_POSITIONS << self.level;
        let (mut sum, mut last) = (S::from_f64(0.0), [S::from_f64(0.0); 3]);
        let m = self.curves[0].values();
        for first in (0..count).step_by(S::LANES) {
            let m = S::load(&m[first..]);
            if !m.exceeds(S::from_f64(0.0)) {
                return None;
            }
            let root = m.sqrt();
            sum += root;
            for (last, terms) in last.iter_mut().zip(&table.alternating) {
                *last += root * S::load(&terms[first..]);
            }
        }
        self.turn.mean_root_m = sum_of_lanes(sum) / count as f64;
        self.turn.positions = count;
        let mut resolved = last_coefficient(last, count) <= RESOLVED_MEAN * self.turn.mean_root_m;
        let first_force = self.first_loaded();
        for (k, curve) in self.curves.iter_mut().enumerate() {
            let (mut size, mut last) = (S::from_f64(0.0), [S::from_f64(0.0); 3]);
            for first in (0..count).step_by(S::LANES) {
                let value = S::load(&curve.values()[first..]);
                size = size.maximum(value).maximum(-value);
                for (last, terms) in last.iter_mut().zip(&table.alternating) {
                    *last += value * S::load(&terms[first..]);
                }
            }
            curve.size = largest_lane(size);
            // A mean of a square has all digits if the last coefficients have half of them.
            let part = if self.has_means && (k == 1 || k >= first_force) {
                RESOLVED_MEAN
            } else {
                RESOLVED_CURVE
            };
            resolved &= last_coefficient(last, count) <= part * curve.size;
        }
        Some(resolved)
    }

    /// Finds the peaks of all curves.
    #[inline(always)]
    fn find_peaks<S: LaneScalar>(&mut self) {
        self.candidates.clear();
        let words = (FIRST_POSITIONS << self.level) / 64;
        for (curve, of) in self.curves.iter().enumerate() {
            // By position, whether the value falls or rises to the next one.
            let mut slopes = [[0_u64; 2]; LAST_POSITIONS / 64];
            for (word, slopes) in slopes[..words].iter_mut().enumerate() {
                for bit in (0..64).step_by(S::LANES) {
                    let here = S::load(&of.values()[64 * word + bit..]);
                    let next = S::load(&of.values()[64 * word + bit + 1..]);
                    slopes[0] |= here.lanes_above(next) << bit;
                    slopes[1] |= next.lanes_above(here) << bit;
                }
            }
            for (kind, sign) in [1.0, -1.0].into_iter().enumerate() {
                let mut at = [0; LAST_POSITIONS / 64];
                let mut before = slopes[words - 1][kind] >> 63;
                for (at, slopes) in at[..words].iter_mut().zip(&slopes) {
                    *at = slopes[kind] & !(slopes[kind] << 1 | before);
                    before = slopes[kind] >> 63;
                }
                Candidate::find(curve, sign, of, &at[..words], &mut self.candidates);
            }
        }
        self.peaks.clear();
        Peak::interpolate::<S>(&self.candidates, &self.curves, &mut self.peaks);
        let first_force = self.first_loaded();
        for curve in 0..self.curves.len() {
            let has_both_ends = self.has_means && curve >= first_force;
            Peak::keep_highest(curve, curve > 1 && !has_both_ends, &mut self.peaks);
        }
    }

    /// The first curve of a force under loads.
    fn first_loaded(&self) -> usize {
        Self::first_force(self.turn.free_reactions.len())
    }

    fn ask_for_peaks(&mut self) {
        self.stage = Stage::Peaks;
        let q = &mut self.samples.q;
        q.clear();
        q.push(self.start);
        for peak in self.peaks.iter().filter(|peak| !peak.is_found) {
            match peak.curve {
                0 => q.push(peak.q),
                _ => q.extend(peak.triple()),
            }
        }
        self.samples.take_positions();
    }

    /// Moves each peak by its values, and requests further values for peaks that have not converged.
    fn take_peaks(&mut self) -> bool {
        let samples = &self.samples;
        self.turn.m_at_start = samples.values(0)[0];
        let mut is_open = false;
        let mut at = 1;
        for peak in self.peaks.iter_mut().filter(|peak| !peak.is_found) {
            let values = &samples.values(peak.curve)[at..];
            is_open |= if peak.curve == 0 {
                at += 1;
                // m′ is twice ½m′.
                let slope = 2.0 * samples.values(1)[at - 1] * peak.step;
                peak.take_slope(values[0], slope)
            } else {
                at += 3;
                peak.take_triple([values[0], values[1], values[2]])
            };
        }
        if is_open {
            self.ask_for_peaks();
            return true;
        }
        self.finish();
        false
    }

    /// Selects the highest and the lowest peak of each curve.
    fn finish(&mut self) {
        if self.peaks.iter().any(|peak| peak.has_failed) {
            return;
        }
        self.turn.force_ends.clear();
        self.turn.force_means.clear();
        let first_force = self.first_loaded();
        for (curve, values) in self.curves.iter().enumerate() {
            let mut ends = [Extremum::default(); 2];
            for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
                let peaks = self
                    .peaks
                    .iter()
                    .filter(|p| (p.curve, p.sign) == (curve, sign));
                let best = peaks.max_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)));
                // A constant curve has no peak.
                let constant = values.values()[0];
                let (q, value) = best.map_or((0.0, constant), |peak| (peak.q, peak.value));
                *end = Extremum {
                    q: q.rem_euclid(TAU),
                    value,
                };
            }
            match curve {
                0 => self.turn.m = ends,
                1 => {
                    self.turn.half_dm = ends;
                    if self.has_means {
                        self.turn.half_dm_means = values.means();
                    }
                }
                of => {
                    let [low, high] = ends;
                    let larger = low.value.abs() > high.value.abs();
                    let Turn {
                        free_reactions,
                        loaded_forces,
                        ..
                    } = &mut self.turn;
                    let mut forces = free_reactions.iter_mut().chain(loaded_forces);
                    if let Some(force) = forces.nth(of - 2) {
                        *force = if larger { low } else { high };
                    }
                    if self.has_means && of >= first_force {
                        self.turn.force_ends.push(ends);
                        self.turn.force_means.push(values.means());
                    }
                }
            }
        }
        self.is_complete = true;
    }
}

/// Sum of all lanes.
#[inline(always)]
pub(super) fn sum_of_lanes<S: LaneScalar>(of: S) -> f64 {
    let mut lanes = [0.0; MAX_LANES];
    of.store(&mut lanes);
    lanes[..S::LANES].iter().sum()
}

/// The largest of all lanes, or zero.
#[inline(always)]
pub(super) fn largest_lane<S: LaneScalar>(of: S) -> f64 {
    let mut lanes = [0.0; MAX_LANES];
    of.store(&mut lanes);
    lanes.into_iter().fold(0.0, f64::max)
}

/// The largest of the last Fourier coefficients, of orders N/2 and N/2 − 1, from the sums of values with alternating signs
/// and with cosine and sine.
#[inline(always)]
fn last_coefficient<S: LaneScalar>(sums: [S; 3], count: usize) -> f64 {
    let mut largest = 0.0_f64;
    for sum in sums {
        largest = largest.max(sum_of_lanes(sum).abs());
    }
    2.0 * largest / count as f64
}
