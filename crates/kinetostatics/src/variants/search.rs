//! The mean and the extremes of periodic curves over a turn: from equally spaced positions, as many as the decay of the
//! last Fourier coefficients asks for, and from positions about the extremes.

mod local;

use crate::reduced::LANES;
use local::{Interpolant, Peak};
use std::f64::consts::TAU;

/// Positions of the first rule, and of the last: next to a change point where more were needed, a curve has no more than
/// twelve digits.
const FIRST_POSITIONS: usize = 64;
const LAST_POSITIONS: usize = 1024;
/// The trapezoidal rule by N points errs by the coefficient of order N, about the square of that of order N/2 beside the
/// mean: it has all digits where the last coefficients of √m are below this part of it.
const RESOLVED_MEAN: f64 = 1e-8;
/// An extreme is evaluated at its place: its curve needs to be known only so well that no other is taken for it.
const RESOLVED_CURVE: f64 = 1e-4;
/// The tangents of all determinants stay clear of zero over so many steps, both ways: the follower's own test of a branch.
const TANGENT_CLEARANCE: f64 = 4.0;

/// The largest or smallest value of a curve, and where it is.
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
    /// By reaction: its value of largest magnitude in the free rotation, over 2E, 1/m or 1.
    pub free_reactions: Vec<Extremum>,
    /// The actuator force (N m), then each reaction (N or N m), of largest magnitude under the loads of the variants, where
    /// they are wanted.
    pub loaded_forces: Vec<Extremum>,
    /// Positions of the rule that resolved it.
    pub positions: usize,
}

/// Positions with the values of all curves: m, ½m′, the reactions of the free rotation, then the forces under loads.
#[derive(Debug, Clone, Default)]
pub(super) struct Samples {
    pub(super) q: Vec<f64>,
    curves: Vec<Vec<f64>>,
    clearance: Vec<f64>,
}

impl Samples {
    /// The positions side by side from the `first` on; the last one stands for those beyond it.
    #[inline(always)]
    pub(super) fn lanes_at(&self, first: usize) -> [f64; LANES] {
        let last = self.q.len() - 1;
        std::array::from_fn(|lane| self.q[last.min(first + lane)])
    }

    /// Some values of a curve from the `first` position on; those beyond the last one are dropped.
    #[inline(always)]
    pub(super) fn set(&mut self, curve: usize, first: usize, values: [f64; LANES]) {
        fill(&mut self.curves[curve][first..], values);
    }

    /// The same of the determinants' squares over those of their slopes, rad².
    #[inline(always)]
    pub(super) fn set_clearance(&mut self, first: usize, values: [f64; LANES]) {
        fill(&mut self.clearance[first..], values);
    }

    /// Room for the values at the positions.
    fn resize(&mut self) {
        let count = self.q.len();
        for values in self.curves.iter_mut().chain([&mut self.clearance]) {
            values.resize(count, f64::NAN);
        }
    }
}

#[inline(always)]
fn fill(places: &mut [f64], values: [f64; LANES]) {
    if let Some(places) = places.first_chunk_mut() {
        *places = values;
    } else {
        places.copy_from_slice(&values[..places.len()]);
    }
}

/// What the samples are for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    /// The positions of the first rule, or those between the positions of the rule before.
    Rule,
    /// Three positions about each peak; the first position is the wanted one.
    Triples,
}

/// The search over one turn, stage by stage.
#[derive(Debug, Clone)]
pub(super) struct TurnSearch {
    pub(super) samples: Samples,
    stage: Stage,
    rule: Samples,
    interpolants: Vec<Interpolant>,
    root_m: Vec<f64>,
    /// By rule: the alternating signs, and their products with cosine and sine of the positions.
    alternating: Vec<Vec<[f64; 3]>>,
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
        let samples = Samples {
            curves: vec![Vec::new(); curves],
            ..Samples::default()
        };
        Self {
            rule: samples.clone(),
            samples,
            stage: Stage::Rule,
            interpolants: vec![Interpolant::default(); curves],
            root_m: Vec::new(),
            alternating: Vec::new(),
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
        self.rule.q.clear();
        self.ask_for((0..FIRST_POSITIONS).map(|i| TAU * i as f64 / FIRST_POSITIONS as f64));
    }

    /// The results, if the search is complete.
    pub(super) fn turn(&self) -> Option<&Turn> {
        self.is_complete.then_some(&self.turn)
    }

    fn ask_for(&mut self, positions: impl Iterator<Item = f64>) {
        self.samples.q.clear();
        self.samples.q.extend(positions);
        self.samples.resize();
    }

    /// Takes the values of the samples; false where the search has ended.
    pub(super) fn advance(&mut self) -> bool {
        match self.stage {
            Stage::Rule => self.take_rule(),
            Stage::Triples => self.take_triples(),
        }
    }

    /// Adds the positions of a rule, and doubles it unless it resolves the curves.
    fn take_rule(&mut self) -> bool {
        self.merge_rule();
        let count = self.rule.q.len();
        let step = TAU / count as f64;
        let bound = TANGENT_CLEARANCE * TANGENT_CLEARANCE * step * step;
        let is_clear = self.rule.clearance.iter().all(|&square| square > bound);
        let positive = self.rule.curves[0].iter().all(|&m| m > 0.0);
        if !positive {
            return false;
        }
        if is_clear && self.is_resolved() {
            self.find_peaks();
            return true;
        }
        if count >= LAST_POSITIONS {
            return false;
        }
        self.ask_for((0..count).map(|i| step * (i as f64 + 0.5)));
        true
    }

    /// Interleaves the samples with the rule so far.
    fn merge_rule(&mut self) {
        let is_first = self.rule.q.is_empty();
        if is_first {
            self.rule.clone_from(&self.samples);
            return;
        }
        let interleave = |old: &mut Vec<f64>, new: &[f64]| {
            let count = old.len();
            old.resize(2 * count, 0.0);
            for i in (0..count).rev() {
                (old[2 * i], old[2 * i + 1]) = (old[i], new[i]);
            }
        };
        interleave(&mut self.rule.q, &self.samples.q);
        interleave(&mut self.rule.clearance, &self.samples.clearance);
        let curves = self.rule.curves.iter_mut().zip(&self.samples.curves);
        curves.for_each(|(old, new)| interleave(old, new));
    }

    /// Whether the last coefficients of √m and of all curves are small.
    fn is_resolved(&mut self) -> bool {
        self.root_m.clear();
        let m = self.rule.curves[0].iter();
        self.root_m.extend(m.map(|m| m.sqrt()));
        let count = self.root_m.len();
        self.turn.mean_root_m = self.root_m.iter().sum::<f64>() / count as f64;
        self.turn.positions = count;
        let level = (count / FIRST_POSITIONS).ilog2() as usize;
        while self.alternating.len() <= level {
            self.alternating
                .push(alternating(FIRST_POSITIONS << self.alternating.len()));
        }
        let terms = &self.alternating[level];
        if last_coefficients(&self.root_m, terms) > RESOLVED_MEAN * self.turn.mean_root_m {
            return false;
        }
        for (of, values) in self.interpolants.iter_mut().zip(&self.rule.curves) {
            of.set(values);
        }
        let mut curves = self.rule.curves.iter().zip(&self.interpolants);
        curves.all(|(values, of)| last_coefficients(values, terms) <= RESOLVED_CURVE * of.size)
    }

    /// Finds the peaks of all curves and asks for three positions about each.
    fn find_peaks(&mut self) {
        self.peaks.clear();
        for (curve, of) in self.interpolants.iter().enumerate() {
            Peak::find(curve, of, &mut self.peaks);
        }
        self.ask_for_triples();
    }

    fn ask_for_triples(&mut self) {
        self.stage = Stage::Triples;
        let peaks = std::mem::take(&mut self.peaks);
        let wanted = std::iter::once(self.start);
        let open = peaks.iter().filter(|peak| !peak.is_found);
        self.ask_for(wanted.chain(open.flat_map(Peak::triple)));
        self.peaks = peaks;
    }

    /// Moves each peak by its three values, and asks for three anew where it was not in their middle.
    fn take_triples(&mut self) -> bool {
        self.turn.m_at_start = self.samples.curves[0][0];
        let mut recentred = false;
        let open = self.peaks.iter_mut().filter(|peak| !peak.is_found);
        for (k, peak) in open.enumerate() {
            let three = |curve: usize| {
                let at = 1 + 3 * k;
                std::array::from_fn(|i| self.samples.curves[curve][at + i])
            };
            // m′ is twice ½m′.
            let slopes = (peak.curve == 0).then(|| three(1).map(|half| 2.0 * half));
            recentred |= peak.take_triple(three(peak.curve), slopes);
        }
        if recentred {
            self.ask_for_triples();
            return true;
        }
        self.finish();
        false
    }

    /// Of the peaks of each curve, the highest and the lowest.
    fn finish(&mut self) {
        if self.peaks.iter().any(|peak| peak.has_failed) {
            return;
        }
        for (curve, values) in self.rule.curves.iter().enumerate() {
            let mut ends = [Extremum::default(); 2];
            for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
                let peaks = self
                    .peaks
                    .iter()
                    .filter(|p| (p.curve, p.sign) == (curve, sign));
                let best = peaks.max_by(|a, b| (sign * a.value).total_cmp(&(sign * b.value)));
                // A constant curve has no peak.
                let (q, value) = best.map_or((0.0, values[0]), |peak| (peak.q, peak.value));
                *end = Extremum {
                    q: q.rem_euclid(TAU),
                    value,
                };
            }
            match curve {
                0 => self.turn.m = ends,
                1 => self.turn.half_dm = ends,
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
                }
            }
        }
        self.is_complete = true;
    }
}

/// (−1)^i, and its products with the cosine and the sine of position i.
fn alternating(count: usize) -> Vec<[f64; 3]> {
    let of_position = |i: usize| {
        let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let (sin, cos) = (TAU * i as f64 / count as f64).sin_cos();
        [sign, sign * cos, sign * sin]
    };
    (0..count).map(of_position).collect()
}

/// The largest of the last Fourier coefficients of equally spaced values: of orders N/2 and N/2 − 1.
fn last_coefficients(values: &[f64], alternating: &[[f64; 3]]) -> f64 {
    let mut sums = [0.0_f64; 3];
    for (value, terms) in values.iter().zip(alternating) {
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term * value;
        }
    }
    let largest = sums.iter().fold(0.0_f64, |max, sum| max.max(sum.abs()));
    2.0 * largest / values.len() as f64
}
