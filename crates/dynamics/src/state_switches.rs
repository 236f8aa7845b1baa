//! Which pieces of loads and drives are held while a motion is integrated, and the functions that separate them.
//!
//! A magnitude that switches as coordinates and speeds move, such as `if(x > 0.1, 100, 0)`, is smooth on each of its
//! pieces ([`Switches`]). So are the limits of a speed controller.

use crate::drive::{CompiledDrive, HeldDrive};
use dwell_kinetostatics::{MachineModel, Magnitude, Model, Signal};
use dwell_laws::{Course, HeldPieces, Pulse, SwitchKind, Switches};

/// The switches of all loads and drives of a machine.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct StateSwitches {
    sources: Vec<SwitchSource>,
    kinds: Vec<SwitchKind>,
    /// By function: those on whose pieces its value depends.
    operands: Vec<Vec<usize>>,
}

/// A load or drive that switches.
#[derive(Debug, Clone, PartialEq)]
struct SwitchSource {
    /// Its index among the loads.
    index: usize,
    magnitude: Switches,
    /// Number of switching functions of its drive.
    drive_count: usize,
    /// Number of its variables.
    signals: usize,
}

/// A feature between the points of a step, at fractions of its duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hidden {
    /// A switch is passed: at least up to there and not long before.
    Passage { switch: usize, at: f64 },
    /// A load varies.
    Pulse(Pulse),
}

/// The pieces on which a load or drive is held.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct HeldSource {
    pub(crate) magnitude: HeldPieces,
    pub(crate) drive: HeldDrive,
}

/// A load or drive at one state of motion.
pub(crate) struct SourceState<'a, M: MachineModel = Model> {
    pub(crate) magnitude: &'a Magnitude<M::Coordinate>,
    /// A drive with its speed and its state.
    pub(crate) drive: Option<(&'a CompiledDrive<M>, f64, Option<f64>)>,
}

/// The index of a load, its magnitude, and the drive whose input that is.
pub(crate) type SwitchingSource<'a, M> = (
    usize,
    &'a Magnitude<<M as MachineModel>::Coordinate>,
    Option<&'a CompiledDrive<M>>,
);

impl StateSwitches {
    /// The switches of magnitudes, given with the index of each load, and of the drives whose inputs they are.
    pub(crate) fn of<'a, M: MachineModel>(
        sources: impl IntoIterator<Item = SwitchingSource<'a, M>>,
    ) -> Self {
        let mut all = Self::default();
        for (index, magnitude, drive) in sources {
            let signals = magnitude.signals().len();
            let magnitude = magnitude.switches();
            let drive_kinds = drive.map_or_else(Vec::new, CompiledDrive::switch_kinds);
            if magnitude.kinds().is_empty() && drive_kinds.is_empty() && !magnitude.may_hide() {
                continue;
            }
            let (first, own) = (all.kinds.len(), magnitude.kinds().len());
            for k in 0..own + drive_kinds.len() {
                // Those of a drive depend on its input.
                let depends = |j: &usize| k >= own || magnitude.depends(k, *j);
                let operands = (0..k.min(own)).filter(depends).map(|j| first + j);
                all.operands.push(operands.collect());
            }
            all.kinds.extend_from_slice(magnitude.kinds());
            let drive_count = drive_kinds.len();
            all.kinds.extend(drive_kinds);
            all.sources.push(SwitchSource {
                index,
                magnitude,
                drive_count,
                signals,
            });
        }
        all
    }

    /// The values at which each function switches.
    pub(crate) fn kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }

    /// The indices of the loads that switch.
    pub(crate) fn loads(&self) -> impl Iterator<Item = usize> + '_ {
        let switches =
            |source: &&SwitchSource| !source.magnitude.kinds().is_empty() || source.drive_count > 0;
        let all = self.sources.iter().filter(switches);
        all.map(|source| source.index)
    }

    /// The load's index of a function.
    pub(crate) fn source_index(&self, mut function: usize) -> usize {
        for source in &self.sources {
            let count = source.magnitude.kinds().len() + source.drive_count;
            if function < count {
                return source.index;
            }
            function -= count;
        }
        0
    }

    /// The functions, before this one, on whose pieces its value depends.
    pub(crate) fn operands(&self, function: usize) -> &[usize] {
        &self.operands[function]
    }

    /// Whether a load may vary, or a condition change, between points at which they are seen.
    pub(crate) fn may_hide(&self) -> bool {
        self.sources
            .iter()
            .any(|source| source.magnitude.may_hide())
    }

    /// The variables among those of [`StateSwitches::values`] that must reverse for a load to vary between the points of a step, if
    /// nothing switches; `None` if other causes exist.
    pub(crate) fn followed(&self) -> Option<Vec<usize>> {
        let (mut all, mut first) = (Vec::new(), 0);
        for source in &self.sources {
            let own = source.magnitude.followed()?.into_iter();
            all.extend(own.map(|variable| first + variable));
            first += source.signals;
        }
        self.kinds.is_empty().then_some(all)
    }

    /// The first hidden feature of the loads between five equally spaced points with the variables `samples`
    /// ([`StateSwitches::values`]), on these pieces. Pulses come before all passages, because a step across a pulse does not
    /// show when a switch is passed.
    pub(crate) fn hidden_in(
        &self,
        held: &[HeldSource],
        samples: &[Vec<f64>; 5],
        pieces: &[Option<f64>],
    ) -> Option<Hidden> {
        let all = Course::through(&samples.each_ref().map(Vec::as_slice));
        let (mut first, mut function, mut variable) = (None, 0, 0);
        let mut add = |at: f64, hidden: Hidden| {
            let order = (matches!(hidden, Hidden::Passage { .. }), at);
            if first.is_none_or(|(earlier, _)| order < earlier) {
                first = Some((order, hidden));
            }
        };
        let free = HeldSource::default();
        for (k, source) in self.sources.iter().enumerate() {
            let (own, signals) = (source.magnitude.kinds().len(), source.signals);
            let held = &held.get(k).unwrap_or(&free).magnitude;
            if source.magnitude.may_hide() {
                let course = all.of(variable..variable + signals);
                let own = &pieces[function..function + own];
                if let Some((k, at)) = source.magnitude.hidden_passage(&course, held, own) {
                    let switch = function + k;
                    add(at, Hidden::Passage { switch, at });
                }
                if let Some(pulse) = source.magnitude.hidden_pulse(&course, held) {
                    add(pulse.at - pulse.width, Hidden::Pulse(pulse));
                }
            }
            function += own + source.drive_count;
            variable += signals;
        }
        first.map(|(_, hidden)| hidden)
    }

    /// Holds one piece for each function, or `None`: `set` gets the load's index and its pieces.
    pub(crate) fn hold(
        &self,
        mut pieces: &[Option<f64>],
        held: &mut Vec<HeldSource>,
        mut set: impl FnMut(usize, &HeldSource),
    ) {
        held.resize(self.sources.len(), HeldSource::default());
        for (source, held) in self.sources.iter().zip(held) {
            let (own, rest) = pieces.split_at(source.magnitude.kinds().len());
            let (drive, rest) = rest.split_at(source.drive_count);
            pieces = rest;
            source.magnitude.hold(own, &mut held.magnitude);
            held.drive[..drive.len()].copy_from_slice(drive);
            set(source.index, held);
        }
    }

    /// The value of each function on the pieces that are held; `state_of` gives a load or drive by its index, with the
    /// values of its signals, which are all kept in `seen`.
    pub(crate) fn values<'a, M: MachineModel + 'a>(
        &self,
        held: &[HeldSource],
        seen: &mut Vec<f64>,
        mut state_of: impl FnMut(usize, &mut Vec<f64>) -> SourceState<'a, M>,
        mut out: &mut [f64],
    ) {
        let free = HeldSource::default();
        let mut signals = Vec::new();
        seen.clear();
        for (k, source) in self.sources.iter().enumerate() {
            signals.clear();
            let state = state_of(source.index, &mut signals);
            seen.extend_from_slice(&signals);
            let held = held.get(k).unwrap_or(&free);
            let (own, rest) = out.split_at_mut(source.magnitude.kinds().len());
            let (of_drive, rest) = rest.split_at_mut(source.drive_count);
            out = rest;
            source.magnitude.values(&signals, &held.magnitude, own);
            if let (false, Some((drive, speed, drive_state))) = (of_drive.is_empty(), state.drive) {
                let input = state.magnitude.eval(&signals, &signals, &held.magnitude);
                let values = drive.switch_values(input, speed, drive_state);
                of_drive.copy_from_slice(&values[..of_drive.len()]);
            }
        }
    }
}

impl StateSwitches {
    /// The value and the rate of each function on the pieces that are held; `state_of` gives a load or drive by its index,
    /// with the values and rates of its signals, and of its drive the rates of its speed and its state.
    pub(crate) fn rates<'a, M: MachineModel + 'a>(
        &self,
        held: &[HeldSource],
        mut state_of: impl FnMut(usize, &mut Vec<[f64; 2]>) -> (SourceState<'a, M>, [f64; 2]),
        mut out: &mut [[f64; 2]],
    ) {
        let free = HeldSource::default();
        let mut signals = Vec::new();
        for (k, source) in self.sources.iter().enumerate() {
            signals.clear();
            let (state, [acceleration, state_rate]) = state_of(source.index, &mut signals);
            let held = held.get(k).unwrap_or(&free);
            let (own, rest) = out.split_at_mut(source.magnitude.kinds().len());
            let (of_drive, rest) = rest.split_at_mut(source.drive_count);
            out = rest;
            source.magnitude.rates(&signals, &held.magnitude, own);
            if let (false, Some((drive, speed, drive_state))) = (of_drive.is_empty(), state.drive) {
                let plain: Vec<f64> = signals.iter().map(|[value, _]| *value).collect();
                let input = state.magnitude.eval(&plain, &plain, &held.magnitude);
                let input_rate = state.magnitude.rate(&signals, &held.magnitude);
                let values = drive.switch_values(input, speed, drive_state);
                let rates = drive.switch_values(input_rate, acceleration, Some(state_rate));
                let both = values.into_iter().zip(rates);
                for (out, (value, rate)) in of_drive.iter_mut().zip(both) {
                    *out = [value, rate];
                }
            }
        }
    }
}

/// The value of a signal at time `t` (s); `coordinate` gives value and speed.
pub(crate) fn signal_value<C: Copy>(
    signal: Signal<C>,
    t: f64,
    coordinate: impl Fn(C) -> [f64; 2],
) -> f64 {
    match signal {
        Signal::Time => t,
        Signal::Value(of) => coordinate(of)[0],
        Signal::Velocity(of) => coordinate(of)[1],
    }
}
