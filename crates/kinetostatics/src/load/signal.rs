//! The signals that magnitudes depend on, and magnitudes as laws and expressions of them.

use super::function::{MagnitudeFunction, first_order};
use super::{CompiledLoads, CompiledSignal, MAX_FUNCTION_SIGNALS, Magnitude, Signal};
use crate::error::{KinetostaticsError, Result};
use dwell_geometry::Mechanism;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_laws::{HeldPieces, SwitchKind, Switches};
use dwell_numerics::{Dual, Scalar};

impl CompiledLoads {
    /// A magnitude of the signals of a load at time `t` (s) and these states of the bodies.
    #[inline]
    pub(crate) fn eval_magnitude<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude,
        t: f64,
        states: &BodyStates<T>,
        workspace: &mut SignalWorkspace<T>,
    ) -> Result<T> {
        let signals = &self.compiled_signals[load];
        workspace.eval(load, magnitude, signals, t, |measured| {
            let [value, rate, _] = states.coordinate(measured);
            [value, rate]
        })
    }
}

impl<T: Scalar> SignalWorkspace<T> {
    /// A magnitude of the signals of a load at time `t` (s); `coordinate` gives value and rate of a coordinate.
    #[inline]
    pub(crate) fn eval<C, F: Copy>(
        &mut self,
        load: usize,
        magnitude: &Magnitude<C>,
        signals: &[Signal<F>],
        t: f64,
        coordinate: impl Fn(F) -> [T; 2],
    ) -> Result<T> {
        let Self {
            numbers,
            values,
            held,
        } = self;
        let slots = numbers.iter_mut().zip(values.iter_mut()).zip(signals);
        for ((number, value), signal) in slots {
            *number = match *signal {
                Signal::Time => T::from_f64(t),
                Signal::Value(measured) => coordinate(measured)[0],
                Signal::Velocity(measured) => coordinate(measured)[1],
            };
            *value = number.value();
        }
        let (numbers, values) = (&numbers[..signals.len()], &values[..signals.len()]);
        let found = match held.get(load) {
            Some(held) => magnitude.eval(numbers, values, held),
            None => magnitude.eval_free(numbers, values),
        };
        let not_finite = KinetostaticsError::MagnitudeNotFinite { load };
        found.value().is_finite().then_some(found).ok_or(not_finite)
    }
}

impl<C> Magnitude<C> {
    /// The magnitude where its [signals](Self::signals) are `numbers`, with plain `values`, on the pieces that are
    /// held. Friction, separating forces and external magnitudes are zero.
    #[inline]
    pub fn eval<T: Scalar>(&self, numbers: &[T], values: &[f64], held: &HeldPieces) -> T {
        if !held.is_empty() {
            let found = self.eval_held(numbers, values, held);
            // A piece need not be defined beyond its bounds: the root of a distance.
            if found.value().is_finite() {
                return found;
            }
        }
        self.eval_free(numbers, values)
    }

    /// The magnitude without held pieces.
    #[inline]
    fn eval_free<T: Scalar>(&self, numbers: &[T], values: &[f64]) -> T {
        match (self, numbers) {
            (Self::Constant(value), _) => T::from_f64(*value),
            (Self::Law(_, law), &[x, ..]) => x.compose(&law.eval(x.value())),
            (Self::Law(..), []) => T::from_f64(f64::NAN),
            (Self::Expression(expression, signals), numbers) => {
                let slope = |i: usize| match signals.get(i) {
                    // Nothing varies with time but time, and an exponential of it that overflows has no slope.
                    Some(Signal::Time) => 0.0,
                    Some(Signal::Value(_) | Signal::Velocity(_)) | None => {
                        expression.derivatives_wrt(values, i)[1]
                    }
                };
                first_order(expression.eval(values), slope, numbers, values)
            }
            (Self::Function(function, _), numbers) => function.eval(numbers, values),
            (Self::Friction(_) | Self::Separating(_) | Self::External(_), _) => T::from_f64(0.0),
        }
    }

    /// The magnitude on held pieces. This is a function of its own, so that the usual evaluation stays small enough to
    /// be inlined.
    #[cold]
    #[inline(never)]
    fn eval_held<T: Scalar>(&self, numbers: &[T], values: &[f64], held: &HeldPieces) -> T {
        match (self, numbers) {
            (Self::Law(_, law), &[x, ..]) => x.compose(&law.eval_held(x.value(), held)),
            (Self::Expression(expression, signals), numbers) => {
                let slope = |i: usize| match signals.get(i) {
                    Some(Signal::Time) => 0.0,
                    _ => expression.derivatives_held(values, i, held)[1],
                };
                first_order(expression.eval_held(values, held), slope, numbers, values)
            }
            (Self::Function(function, signals), numbers) => {
                function.eval_held(numbers, values, &bounds_held(function, signals, held))
            }
            (
                Self::Constant(_)
                | Self::Law(..)
                | Self::Friction(_)
                | Self::Separating(_)
                | Self::External(_),
                _,
            ) => T::from_f64(f64::NAN),
        }
    }

    /// The rate of the magnitude where its signals have these values and rates, on the pieces that are held.
    pub fn rate(&self, signals: &[[f64; 2]], held: &HeldPieces) -> f64 {
        let values: Vec<f64> = signals.iter().map(|[value, _]| *value).collect();
        match self {
            Self::Law(_, law) => match signals.first() {
                Some([value, rate]) => law.eval_held(*value, held)[1] * rate,
                None => 0.0,
            },
            Self::Expression(expression, _) => {
                let moving = signals
                    .iter()
                    .enumerate()
                    .filter(|(_, [_, rate])| *rate != 0.0);
                let slope = |i: usize| expression.derivatives_held(&values, i, held)[1];
                moving.map(|(i, [_, rate])| slope(i) * rate).sum()
            }
            Self::Function(..) => {
                let numbers: Vec<Dual> = signals.iter().map(|&[v, d]| Dual { v, d }).collect();
                self.eval(&numbers, &values, held).d
            }
            Self::Constant(_) | Self::Friction(_) | Self::Separating(_) | Self::External(_) => 0.0,
        }
    }

    /// Its switches in coordinates and speeds.
    pub fn switches(&self) -> Switches {
        match self {
            Self::Law(Signal::Value(_) | Signal::Velocity(_), law) => Switches::of_law(law),
            Self::Expression(expression, signals) => {
                let time = signals.iter().position(|s| matches!(s, Signal::Time));
                Switches::of_expression(expression, time)
            }
            Self::Function(function, signals) => {
                Switches::at_values(state_breakpoints(function, signals))
            }
            Self::Constant(_)
            | Self::Law(Signal::Time, _)
            | Self::Friction(_)
            | Self::Separating(_)
            | Self::External(_) => Switches::default(),
        }
    }
}

/// The breakpoints of a function in its signals other than time.
fn state_breakpoints<'f, C>(
    function: &'f MagnitudeFunction,
    signals: &'f [Signal<C>],
) -> impl Iterator<Item = (usize, &'f [f64])> {
    let all = function.breakpoints();
    all.filter(|(i, _)| !matches!(signals.get(*i), Some(Signal::Time) | None))
}

/// By signal of a function that is held: its index and the bounds of its piece.
fn bounds_held<C>(
    function: &MagnitudeFunction,
    signals: &[Signal<C>],
    held: &HeldPieces,
) -> Vec<(usize, [f64; 2])> {
    let all = state_breakpoints(function, signals).zip(held.pieces());
    let bounds = |((i, values), piece): ((usize, &[f64]), Option<f64>)| {
        Some((i, SwitchKind::Knots(values.to_vec()).bounds(piece?)))
    };
    all.filter_map(bounds).collect()
}

/// Working memory for the signals of one magnitude.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct SignalWorkspace<T> {
    numbers: Vec<T>,
    values: Vec<f64>,
    /// By load: the pieces of its magnitude that are held; without an entry, none.
    pub(crate) held: Vec<HeldPieces>,
}

impl<T: Scalar> SignalWorkspace<T> {
    pub(crate) fn new(max_signals: usize) -> Self {
        Self {
            numbers: vec![T::from_f64(0.0); max_signals],
            values: vec![0.0; max_signals],
            held: Vec::new(),
        }
    }

    /// The pieces on which the magnitude of a load is held.
    pub(crate) fn held_pieces(&mut self, load: usize) -> &mut HeldPieces {
        if self.held.len() <= load {
            self.held.resize(load + 1, HeldPieces::NONE);
        }
        &mut self.held[load]
    }
}

/// The signals of a magnitude of a mechanism in the plane.
pub(crate) fn compile_signals(
    mechanism: &Mechanism,
    magnitude: &Magnitude,
) -> Result<Vec<CompiledSignal>, &'static str> {
    let unknown = "its magnitude depends on a coordinate that the mechanism does not have";
    let find = |coordinate| CoordinateFunction::find(mechanism, coordinate).ok_or(unknown);
    compile_signals_by(magnitude, find)
}

/// The signals of a magnitude, whose coordinates `find` compiles.
pub(crate) fn compile_signals_by<C: Copy, F>(
    magnitude: &Magnitude<C>,
    find: impl Fn(C) -> Result<F, &'static str>,
) -> Result<Vec<Signal<F>>, &'static str> {
    let signals = magnitude.signals();
    if let Magnitude::Expression(expression, _) = magnitude
        && expression.variables().len() > signals.len()
    {
        return Err("its expression has more variables than signals");
    }
    if matches!(magnitude, Magnitude::Function(..)) && signals.len() > MAX_FUNCTION_SIGNALS {
        return Err("its function depends on more than 16 signals");
    }
    let compile = |signal: &Signal<C>| match *signal {
        Signal::Time => Ok(Signal::Time),
        Signal::Value(coordinate) => find(coordinate).map(Signal::Value),
        Signal::Velocity(coordinate) => find(coordinate).map(Signal::Velocity),
    };
    signals.iter().map(compile).collect()
}
