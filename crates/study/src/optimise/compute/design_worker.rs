//! The results of one design after another: several positions are evaluated side by side, forward, and then in reverse for the derivatives.

use super::curves::{Samples, unwrap};
use super::measured::{Measured, Peak};
use super::recorded_designs::{Channel, RecordedDesigns, Wanted};
use crate::trajectory::compute::{Statistic, TrajectorySample};
use dwell_kinetostatics::RecordedState;
use dwell_numerics::{Lanes, ReverseSweep};
use std::array;
use std::f64::consts::TAU;

/// Positions side by side.
const LANES: usize = 8;
pub(super) type Lane = Lanes<LANES>;

/// Curves of a turn are resolved where the last Fourier coefficients are below this part of the largest value: a mean of a square then has all
/// digits, and no extremum is taken for another.
const RESOLVED: f64 = 1e-8;
const RESOLVED_PEAKS: f64 = 1e-3;
/// Half the distances, in those of the samples, of three positions about an extremum, round by round.
const ROUNDS: [f64; 3] = [0.3, 0.04, 5e-3];

/// Memory for the designs of one thread.
pub(super) struct DesignWorker<'d, 'a> {
    pub(super) of: &'d RecordedDesigns<'a>,
    /// The numbers of the machine of the present design.
    numbers: Vec<f64>,
    /// By block of positions: the operations' results.
    blocks: Vec<Block>,
    /// By channel: its values at the samples.
    pub(super) curves: Vec<Vec<f64>>,
    /// The level of the samples with which the next design begins.
    level: usize,
    /// Whether a few digits are enough.
    pub(super) is_rough: bool,
    single: Block,
    /// By axis: the derivatives of the assigned numbers.
    pub(super) effects: Vec<Vec<f64>>,
}

/// Places of extrema that are not exact yet, except those that are fixed.
pub(super) struct Open {
    pub(super) places: Vec<f64>,
    pub(super) fixed: Vec<bool>,
    /// The distance of the samples.
    pub(super) spacing: f64,
}

/// Channels with the recording of them alone, for the present design.
#[derive(Clone, Copy)]
pub(super) struct Recorded<'c> {
    pub(super) channels: &'c [usize],
    pub(super) code: &'c RecordedState,
    pub(super) template: &'c [Lane],
}

/// Positions that are evaluated side by side.
#[derive(Default)]
struct Block {
    inputs: Vec<Lane>,
    outputs: Vec<Lane>,
    sweep: ReverseSweep<Lane>,
}

impl Block {
    /// Evaluates some code at samples, of which the last is repeated; `None` where there is no position.
    fn evaluate(
        &mut self,
        code: &RecordedState,
        template: &[Lane],
        samples: &[TrajectorySample],
    ) -> bool {
        self.inputs.clear();
        self.inputs.extend_from_slice(template);
        let count = code.layout.actuators;
        let at = |lane: usize| &samples[lane.min(samples.len() - 1)];
        for i in 0..count {
            self.inputs[i] = Lanes(array::from_fn(|lane| at(lane).q[i]));
            self.inputs[count + i] = Lanes(array::from_fn(|lane| at(lane).q_dot[i]));
            self.inputs[2 * count + i] = Lanes(array::from_fn(|lane| at(lane).q_ddot[i]));
        }
        self.outputs.clear();
        let outputs = self.sweep.evaluate(&code.code, &self.inputs);
        self.outputs.extend_from_slice(outputs);
        self.outputs
            .iter()
            .all(|o| o.0.iter().all(|v| v.is_finite()))
    }
}

impl<'d, 'a> DesignWorker<'d, 'a> {
    pub(super) fn new(of: &'d RecordedDesigns<'a>) -> Self {
        Self {
            numbers: vec![0.0; of.number_count],
            blocks: Vec::new(),
            curves: vec![Vec::new(); of.channels.len()],
            level: 0,
            is_rough: false,
            single: Block::default(),
            effects: Vec::new(),
            of,
        }
    }

    /// The results of a design, with derivatives by its numbers if they are wanted; `None` if it has no position somewhere.
    pub(super) fn evaluate(&mut self, values: &[f64], has_slopes: bool) -> Option<Vec<Measured>> {
        let of = self.of;
        let numbers = of.design.numbers(values);
        of.numbers.fill(&numbers, &mut self.numbers);
        self.effects.clear();
        if has_slopes {
            let axes = 0..values.len();
            self.effects
                .extend(axes.map(|k| of.design.slopes(&numbers, k)));
        }
        let template = self.template();
        self.sample(&template)?;
        let wanted = of.wanted.iter();
        let found = wanted.map(|wanted| match wanted {
            Wanted::Statistic(channel, statistic) => {
                self.statistic(*channel, *statistic, &template)
            }
            Wanted::Distance { .. } => self.distance(wanted, &template),
        });
        let found = found.collect();
        let is_higher = of.is_turn && !self.is_rough && self.level > of.least_level;
        if is_higher && self.is_resolved(self.level - 1) {
            self.level -= 1;
        }
        found
    }

    /// The values of the results to a few digits.
    pub(super) fn evaluate_roughly(&mut self, values: &[f64]) -> Option<Vec<Measured>> {
        self.is_rough = true;
        let found = self.evaluate(values, false);
        self.is_rough = false;
        found
    }

    /// The inputs of this design, without those of a position.
    fn template(&self) -> Vec<Lane> {
        let layout = self.of.code.layout;
        let loads = layout.magnitudes;
        let (of_machine, of_loads) = self.numbers.split_at(self.numbers.len() - loads);
        let mut all: Vec<Lane> = self.of.inputs.iter().map(|v| Lanes([*v; LANES])).collect();
        for (to, value) in all[layout.first_magnitude()..].iter_mut().zip(of_loads) {
            *to = Lanes([*value; LANES]);
        }
        for (to, value) in all[layout.first_number()..].iter_mut().zip(of_machine) {
            *to = Lanes([*value; LANES]);
        }
        all
    }

    /// Evaluates all curves at as many positions as they need.
    fn sample(&mut self, template: &[Lane]) -> Option<()> {
        let of = self.of;
        self.level = match self.is_rough {
            true => of.least_level.min(1),
            false => self.level.max(of.least_level),
        };
        loop {
            let level = &of.levels[self.level];
            let count = level.samples.len().div_ceil(LANES);
            self.blocks
                .resize_with(count.max(self.blocks.len()), Block::default);
            self.curves.iter_mut().for_each(Vec::clear);
            for (block, samples) in self.blocks.iter_mut().zip(level.samples.chunks(LANES)) {
                if !block.evaluate(&of.code, template, samples) {
                    return None;
                }
                for (curve, channel) in self.curves.iter_mut().zip(&of.channels) {
                    for (lane, sample) in samples.iter().enumerate() {
                        let output = |k: usize| block.outputs[k].0[lane];
                        curve.push(of.outputs.value(&channel.signal, &output, sample));
                    }
                }
            }
            for (curve, channel) in self.curves.iter_mut().zip(&of.channels) {
                if channel.unwraps {
                    unwrap(curve);
                }
            }
            if !of.is_turn || self.level + 1 == of.levels.len() || self.is_resolved(self.level) {
                return Some(());
            }
            self.level += 1;
        }
    }

    /// Whether the samples of a turn resolve all curves, or those of a lower level would.
    fn is_resolved(&self, level: usize) -> bool {
        let (step, level) = (1 << (self.level - level), &self.of.levels[level]);
        let is_summed = |channel: usize| {
            let mut wanted = self.of.wanted.iter();
            wanted.any(|wanted| {
                use Statistic::{Mean, Rms, Work};
                matches!(wanted, Wanted::Statistic(of, Mean | Rms | Work) if *of == channel)
            })
        };
        self.curves.iter().enumerate().all(|(k, curve)| {
            let enough = match is_summed(k) && !self.is_rough {
                true => RESOLVED,
                false => RESOLVED_PEAKS,
            };
            let lower: Vec<f64> = curve.iter().copied().step_by(step).collect();
            let samples = Samples {
                values: &lower,
                is_turn: true,
            };
            samples.roughness(&level.alternating) <= enough
        })
    }

    fn statistic(
        &mut self,
        channel: usize,
        statistic: Statistic,
        template: &[Lane],
    ) -> Option<Measured> {
        let sums = |worker: &mut Self, of: &dyn Fn(f64) -> f64, slope: &dyn Fn(f64) -> f64| {
            worker.mean(channel, of, slope)
        };
        match statistic {
            Statistic::Mean => Some(sums(self, &|v| v, &|_| 1.0)),
            Statistic::Work => {
                let duration = self.of.duration;
                Some(sums(self, &|v| duration * v, &|_| duration))
            }
            Statistic::Rms => {
                let mean = sums(self, &|v| v * v, &|v| 2.0 * v);
                Some(Measured::root(mean.value, mean.slope))
            }
            Statistic::Max => {
                let peaks = self.peaks(channel, &[1.0], template)?;
                Some(Measured::of_peaks(peaks, false))
            }
            Statistic::Min => {
                let peaks = self.peaks(channel, &[-1.0], template)?;
                Some(Measured::of_peaks(peaks, true))
            }
            Statistic::MaxAbs | Statistic::PeakPower => {
                let mut peaks = self.peaks(channel, &[1.0, -1.0], template)?;
                for peak in peaks.iter_mut().filter(|peak| peak.value < 0.0) {
                    peak.value = -peak.value;
                    peak.slope.iter_mut().for_each(|slope| *slope = -*slope);
                }
                Some(Measured::of_peaks(peaks, false))
            }
            Statistic::Stroke => {
                let most = Measured::of_peaks(self.peaks(channel, &[1.0], template)?, false);
                let least = Measured::of_peaks(self.peaks(channel, &[-1.0], template)?, true);
                let slopes = most.slope.iter().zip(&least.slope);
                Some(Measured {
                    value: most.value - least.value,
                    slope: slopes.map(|(a, b)| a - b).collect(),
                    ..Measured::default()
                })
            }
        }
    }

    /// The mean of a function of a curve, with its derivatives.
    fn mean(
        &mut self,
        channel: usize,
        of: &dyn Fn(f64) -> f64,
        slope: &dyn Fn(f64) -> f64,
    ) -> Measured {
        let count = self.curves[channel].len();
        let is_turn = self.of.is_turn;
        // Trapezoids; the ends of a turn are one position.
        let weight = move |k: usize| match is_turn {
            true => 1.0 / count as f64,
            false if k == 0 || k + 1 == count => 0.5 / (count - 1) as f64,
            false => 1.0 / (count - 1) as f64,
        };
        let curve = self.curves[channel].iter().enumerate();
        let value = curve.map(|(k, v)| weight(k) * of(*v)).sum();
        if self.effects.is_empty() {
            return Measured {
                value,
                ..Measured::default()
            };
        }
        let (designs, level) = (self.of, &self.of.levels[self.level]);
        let signal = &designs.channels[channel].signal;
        let mut sums = vec![Lanes([0.0; LANES]); designs.code.layout.inputs];
        let mut weights = Vec::new();
        let blocks = self.blocks.iter_mut().zip(level.samples.chunks(LANES));
        for (b, (block, samples)) in blocks.enumerate() {
            weights.clear();
            weights.resize(block.outputs.len(), Lanes([0.0; LANES]));
            for (lane, sample) in samples.iter().enumerate() {
                let k = b * LANES + lane;
                let factor = weight(k) * slope(self.curves[channel][k]);
                let output = |k: usize| block.outputs[k].0[lane];
                for (k, part) in designs.outputs.slopes(signal, &output, &sample.q_dot) {
                    weights[k].0[lane] += factor * part;
                }
            }
            let gradient = block
                .sweep
                .gradient(&designs.code.code, &block.inputs, &weights);
            for (sum, part) in sums.iter_mut().zip(gradient) {
                for lane in 0..LANES {
                    sum.0[lane] += part.0[lane];
                }
            }
        }
        let sums: Vec<f64> = sums.iter().map(|sum| sum.0.iter().sum()).collect();
        Measured {
            value,
            slope: self.chain(&|k| sums[k]),
            ..Measured::default()
        }
    }

    /// The derivatives by the numbers that vary, of something with these derivatives by the inputs of a recording.
    fn chain(&self, by_input: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let layout = self.of.code.layout;
        let of_machine = self.numbers.len() - layout.magnitudes;
        let input = |number: usize| match number.checked_sub(of_machine) {
            None => layout.first_number() + number,
            Some(load) => layout.first_magnitude() + load,
        };
        let by_number = self.of.numbers.slopes.iter().map(|slopes| {
            let each = slopes.iter().map(|(k, slope)| by_input(input(*k)) * slope);
            each.sum::<f64>()
        });
        let by_number: Vec<f64> = by_number.collect();
        let by_axis = |effects: &Vec<f64>| {
            let terms = effects.iter().zip(&by_number);
            terms.map(|(effect, slope)| effect * slope).sum()
        };
        self.effects.iter().map(by_axis).collect()
    }

    /// The values of channels at some places, by channel, with their derivatives by the numbers if they are wanted.
    pub(super) fn at_places(
        &mut self,
        of: Recorded<'_>,
        places: &[f64],
        has_slopes: bool,
    ) -> Option<Vec<Vec<Peak>>> {
        let designs = self.of;
        let mut found = vec![Vec::with_capacity(places.len()); of.channels.len()];
        let mut block = std::mem::take(&mut self.single);
        let mut weights = Vec::new();
        for places in places.chunks(LANES) {
            let samples: Vec<TrajectorySample> =
                places.iter().map(|u| designs.sample(*u)).collect();
            if !block.evaluate(of.code, of.template, &samples) {
                return None;
            }
            for (column, channel) in found.iter_mut().zip(of.channels) {
                let Channel {
                    signal, unwraps, ..
                } = &designs.channels[*channel];
                weights.clear();
                weights.resize(block.outputs.len(), Lanes([0.0; LANES]));
                let first = column.len();
                for (lane, sample) in samples.iter().enumerate() {
                    let output = |k: usize| block.outputs[k].0[lane];
                    let mut value = designs.outputs.value(signal, &output, sample);
                    if *unwraps {
                        let near = self.near(*channel, places[lane]);
                        value += TAU * ((near - value) / TAU).round();
                    }
                    if has_slopes {
                        for (k, part) in designs.outputs.slopes(signal, &output, &sample.q_dot) {
                            weights[k].0[lane] += part;
                        }
                    }
                    column.push(Peak {
                        place: places[lane],
                        value,
                        slope: Vec::new(),
                    });
                }
                if has_slopes {
                    let gradient = block.sweep.gradient(&of.code.code, &block.inputs, &weights);
                    for (lane, peak) in column[first..].iter_mut().enumerate() {
                        peak.slope = self.chain(&|k| gradient[k].0[lane]);
                    }
                }
            }
        }
        self.single = block;
        Some(found)
    }

    /// The values of channels at some places: by place, then by channel.
    pub(super) fn values_at(&mut self, of: Recorded<'_>, places: &[f64]) -> Option<Vec<Vec<f64>>> {
        let columns = self.at_places(of, places, false)?;
        let row = |k: usize| columns.iter().map(|column| column[k].value).collect();
        Some((0..places.len()).map(row).collect())
    }

    /// The value of a curve at the sample nearest to a place.
    fn near(&self, channel: usize, u: f64) -> f64 {
        let curve = &self.curves[channel];
        let intervals = curve.len() - usize::from(!self.of.is_turn);
        let k = (u * intervals as f64).round() as isize;
        let last = curve.len() as isize;
        let wrapped = if self.of.is_turn {
            k.rem_euclid(last)
        } else {
            k.clamp(0, last - 1)
        };
        curve[wrapped as usize]
    }

    /// A place within the trajectory.
    pub(super) fn wrapped(&self, u: f64) -> f64 {
        if self.of.is_turn {
            u.rem_euclid(1.0)
        } else {
            u.clamp(0.0, 1.0)
        }
    }

    /// The local maxima of a curve (sign 1), its minima (sign −1), or both.
    fn peaks(&mut self, channel: usize, signs: &[f64], template: &[Lane]) -> Option<Vec<Peak>> {
        let mut open: Vec<(f64, f64, bool)> = Vec::new();
        let samples = Samples {
            values: &self.curves[channel],
            is_turn: self.of.is_turn,
        };
        let spacing = samples.spacing();
        for sign in signs {
            let maxima = samples.maxima(*sign).into_iter();
            open.extend(maxima.map(|(u, is_end)| (u, *sign, is_end)));
        }
        let of = Recorded {
            channels: &[channel],
            code: &self.of.channels[channel].code,
            template,
        };
        let places: Vec<f64> = open.iter().map(|(u, ..)| *u).collect();
        let signs: Vec<f64> = open.iter().map(|(_, sign, _)| *sign).collect();
        let fixed: Vec<bool> = open.iter().map(|(.., is_end)| *is_end).collect();
        let height = |k: usize, values: &[f64]| signs[k] * values[0];
        let open = Open {
            places,
            fixed,
            spacing,
        };
        let places = self.refined(of, open, &height)?;
        let has_slopes = !self.effects.is_empty();
        self.at_places(of, &places, has_slopes)?.pop()
    }

    /// Places moved to where a function of channels is highest near them, by parabolas through three positions.
    pub(super) fn refined(
        &mut self,
        of: Recorded<'_>,
        mut open: Open,
        height: &dyn Fn(usize, &[f64]) -> f64,
    ) -> Option<Vec<f64>> {
        let free: Vec<usize> = (0..open.places.len()).filter(|k| !open.fixed[*k]).collect();
        let rounds = if self.is_rough {
            &ROUNDS[..1]
        } else {
            &ROUNDS[..]
        };
        for half in rounds {
            let step = half * open.spacing;
            let triple = |k: &usize| {
                let at = match self.of.is_turn {
                    true => open.places[*k],
                    false => open.places[*k].clamp(step, 1.0 - step),
                };
                [-step, 0.0, step].map(|off| self.wrapped(at + off))
            };
            let triples: Vec<f64> = free.iter().flat_map(triple).collect();
            let values = self.values_at(of, &triples)?;
            for (i, k) in free.iter().enumerate() {
                let [a, b, c] = array::from_fn(|j| height(*k, &values[3 * i + j]));
                let bend = a - 2.0 * b + c;
                let off = match bend < 0.0 {
                    true => 0.5 * (a - c) / bend,
                    false => 2.0 * (c - a).signum(),
                };
                let middle = triples[3 * i + 1];
                open.places[*k] = self.wrapped(middle + step * off.clamp(-4.0, 4.0));
            }
        }
        Some(open.places)
    }
}
