//! How strong the loads are: laws and expressions of what is measured.

use crate::acts::{LoadState, Loads};
use crate::kinetostatics::{KinetostaticsError, Loaded};
use crate::load::{Magnitude, Signal};
use crate::model::{Model, Workspace};
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{Mechanism, PlaceError, Scalar};
use dwell_laws::Expression;

/// What a magnitude depends on, ready to be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sense {
    /// Time, s.
    Time,
    /// A coordinate, rad or m.
    Value(Measured),
    /// Its speed, rad/s or m/s.
    Speed(Measured),
}

impl Sense {
    fn of<T: Scalar>(self, t: f64, states: &BodyStates<T>) -> T {
        match self {
            Self::Time => T::lift(t),
            Self::Value(measured) => states.measure(measured)[0],
            Self::Speed(measured) => states.measure(measured)[1],
        }
    }
}

impl Loads {
    /// The magnitudes at time `t` (s). Friction is zero until its reactions are known; what is given
    /// stays.
    pub(crate) fn magnitudes<T: Scalar>(
        &self,
        t: f64,
        states: &BodyStates<T>,
        out: &mut LoadState<T>,
    ) -> Result<(), KinetostaticsError> {
        if T::LANES > 1 && !self.loads.is_empty() {
            // Laws, dry friction and slack springs decide by one value.
            return Err(PlaceError::Apart { q: f64::NAN }.into());
        }
        for (i, load) in self.loads.iter().enumerate() {
            if matches!(load.magnitude, Magnitude::Given(_)) {
                continue;
            }
            let magnitude = load
                .magnitude
                .at(t, &self.senses[i], states, &mut out.scratch);
            if !magnitude.value().is_finite() {
                return Err(KinetostaticsError::MagnitudeNotFinite { load: i });
            }
            out.magnitude[i] = magnitude;
        }
        Ok(())
    }
}

impl Magnitude {
    /// The magnitude where its senses have these states.
    pub(crate) fn at<T: Scalar>(
        &self,
        t: f64,
        senses: &[Sense],
        states: &BodyStates<T>,
        scratch: &mut Scratch<T>,
    ) -> T {
        let Scratch { numbers, values } = scratch;
        let sensed = numbers.iter_mut().zip(values.iter_mut()).zip(senses);
        for ((number, value), sense) in sensed {
            *number = sense.of(t, states);
            *value = number.value();
        }
        self.of(&numbers[..senses.len()], &values[..senses.len()])
    }

    /// The magnitude where its [signals](Self::signals) have these numbers, and the numbers these values.
    /// Friction, and what is given, is zero.
    pub fn of<T: Scalar>(&self, numbers: &[T], values: &[f64]) -> T {
        match (self, numbers) {
            (Self::Constant(value), _) => T::lift(*value),
            (Self::Law(_, law), &[x, ..]) => x.through(&law.at(x.value())),
            (Self::Law(..), []) => T::lift(f64::NAN),
            (Self::Expression(expression, _), numbers) => of_several(expression, numbers, values),
            (Self::Friction(_) | Self::Given(_), _) => T::lift(0.0),
        }
    }
}

impl Model {
    /// What a load's magnitude depends on, in the order of its [signals](Magnitude::signals).
    pub fn senses(&self, load: usize) -> &[Sense] {
        self.loads.senses.get(load).map_or(&[], Vec::as_slice)
    }

    /// What a load of [`Magnitude::Given`] is given from, at time `t` (s) and the state entered: a
    /// magnitude of the same signals, such as the voltage of a motor.
    ///
    /// # Errors
    /// [`KinetostaticsError::MagnitudeNotFinite`] where it has no finite value.
    pub fn sense<T: Scalar>(
        &self,
        load: usize,
        magnitude: &Magnitude,
        t: f64,
        work: &mut Workspace<T>,
    ) -> Result<T, KinetostaticsError> {
        let Loaded { states, loads, .. } = &mut work.loaded;
        let value = magnitude.at(t, &self.loads.senses[load], states, &mut loads.scratch);
        if value.value().is_finite() {
            Ok(value)
        } else {
            Err(KinetostaticsError::MagnitudeNotFinite { load })
        }
    }
}

/// Room for what a magnitude senses.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Scratch<T> {
    numbers: Vec<T>,
    values: Vec<f64>,
}

impl<T: Scalar> Scratch<T> {
    pub(crate) fn new(most: usize) -> Self {
        Self {
            numbers: vec![T::lift(0.0); most],
            values: vec![0.0; most],
        }
    }
}

/// An expression in any kind of number: its value, and what its gradient makes of the rest of each
/// variable. That is exact to first order, which is what a dual number holds.
fn of_several<T: Scalar>(expression: &Expression, numbers: &[T], values: &[f64]) -> T {
    let mut sum = T::lift(expression.at(values));
    if T::DERIVES {
        for (i, &number) in numbers.iter().enumerate() {
            let rest = number - T::lift(values[i]);
            sum += rest * T::lift(expression.along(values, i)[1]);
        }
    }
    sum
}

/// What a load's magnitude depends on.
pub(crate) fn senses(
    mechanism: &Mechanism,
    magnitude: &Magnitude,
) -> Result<Vec<Sense>, &'static str> {
    let signals = magnitude.signals();
    if let Magnitude::Expression(expression, _) = magnitude
        && expression.variables().len() > signals.len()
    {
        return Err("its expression has more variables than signals");
    }
    let unknown = "its magnitude depends on a coordinate that the mechanism does not have";
    let find = |coordinate| Measured::find(mechanism, coordinate).ok_or(unknown);
    let sense = |signal: &Signal| match *signal {
        Signal::Time => Ok(Sense::Time),
        Signal::Value(coordinate) => find(coordinate).map(Sense::Value),
        Signal::Speed(coordinate) => find(coordinate).map(Sense::Speed),
    };
    signals.iter().map(sense).collect()
}
