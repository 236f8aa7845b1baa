//! A state of prescribed motion as straight-line code of the motion, the magnitudes of the loads and all numbers of a mechanism: what
//! gradients by these numbers are computed from.
//!
//! ```text
//! inputs    q, q̇, q̈, magnitudes of the loads, numbers p, solution u of the closures
//! outputs   actuator forces τ, reactions, wanted coordinates s, ṡ, s̈, wanted points with velocity and acceleration,
//!           in the plane force and moment on the ground
//! magnitude of a load    F + Σ F′ (s − s₀)    of its signals s, with its value F, its slopes F′ and the values s₀ as inputs
//! ```
//!
//! A law is therefore evaluated outside: its first order is what a derivative needs.
//!
//! Everything about a mechanism of prescribed motion follows from it: at q̇ = 0, q̈ = 1 and F = 0 the outputs are m and all a, at q̇ = 1, q̈ = 0
//! they are ½m′ and all b. The code holds at other poses on the same branch; by its solution u it has no iterations, and its derivatives by
//! u are zero.

mod numbered;
mod plane;

pub(crate) use numbered::Numbered;

use crate::error::PositionResult;
use crate::load::{Magnitude, Signal};
use crate::model::{MachineModel, ModelLoad};
use dwell_geometry::{BodyId, PositionError};
use dwell_numerics::{Operand, RecordedNumber, RecordingError, Scalar, StraightLine, record_at};
use thiserror::Error;

/// Why a state cannot be recorded.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StateRecordingError {
    /// The numbers do not fit the structure of the model.
    #[error("the numbers do not fit the structure of the model")]
    Structure,
    /// A wanted coordinate does not exist.
    #[error("{0}")]
    Coordinate(&'static str),
    /// A load that has no direction at the pose.
    #[error("load {0} has no direction at the pose")]
    NoDirection(usize),
    /// There is no pose.
    #[error(transparent)]
    Position(#[from] PositionError),
}

/// What is wanted of a state beside the forces of the actuators and the reactions of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct WantedMotion<K, V> {
    /// Coordinates.
    pub coordinates: Vec<K>,
    /// Points, m in the frames of their bodies.
    pub points: Vec<(BodyId, V)>,
}

impl<K, V> Default for WantedMotion<K, V> {
    fn default() -> Self {
        Self {
            coordinates: Vec::new(),
            points: Vec::new(),
        }
    }
}

/// The description of a machine by its numbers.
#[derive(Debug)]
pub struct Described<'a, M: RecordableModel> {
    /// The mechanism.
    pub mechanism: &'a M::Mechanism,
    /// By body: its mass.
    pub masses: &'a [M::Mass],
    /// The loads.
    pub loads: &'a [ModelLoad<M>],
    /// What is wanted.
    pub wanted: &'a WantedMotion<M::Coordinate, M::Point>,
}

impl<M: RecordableModel> Clone for Described<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M: RecordableModel> Copy for Described<'_, M> {}

/// A model whose states of motion can be recorded.
pub trait RecordableModel: MachineModel {
    /// The description of a mechanism.
    type Mechanism;
    /// The description of a mass.
    type Mass;
    /// A point of a body, m.
    type Point: Copy;

    /// All numbers on which a state depends, of a machine of this structure: of its joints, masses and loads, and of what is wanted. `None`
    /// if it has another structure.
    fn numbers(&self, of: Described<'_, Self>) -> Option<Vec<f64>>;

    /// This model with the numbers of another machine of its structure: of one whose numbers coincide by chance, say, where its own do
    /// not. `None` if that machine has another structure. In space a structure has its own numbers only.
    fn at_numbers(&self, of: Described<'_, Self>) -> Option<Self>;

    /// The solution of the closures at coordinates, rad or m.
    ///
    /// # Errors
    /// [`PositionError`] when there is no pose.
    fn solution(&self, q: &[f64], workspace: &mut Self::Workspace<f64>)
    -> PositionResult<Vec<f64>>;

    /// The outputs of a state of the machine `of`, whose structure is that of this model, at these inputs.
    ///
    /// # Errors
    /// [`StateRecordingError`].
    fn outputs(
        &self,
        of: Described<'_, Self>,
        at: &StateInputs<'_>,
    ) -> Result<Vec<RecordedNumber>, StateRecordingError>;
}

/// The magnitude of a load from the next inputs, F and by signal F′ and s₀, and from its signals.
pub(crate) fn first_order<T: Scalar>(
    inputs: &mut impl Iterator<Item = T>,
    signals: impl Iterator<Item = Result<T, StateRecordingError>>,
) -> Result<T, StateRecordingError> {
    let mut next = || inputs.next().unwrap_or_default();
    let mut magnitude = next();
    for signal in signals {
        let (slope, value) = (next(), next());
        magnitude += slope * (signal? - value);
    }
    Ok(magnitude)
}

/// The coordinates on which a magnitude depends, each with whether its velocity is meant.
pub fn signal_coordinates<C: Copy>(magnitude: &Magnitude<C>) -> impl Iterator<Item = (C, bool)> {
    let signals = magnitude.signals().iter();
    signals.filter_map(|signal| match *signal {
        Signal::Time => None,
        Signal::Value(coordinate) => Some((coordinate, false)),
        Signal::Velocity(coordinate) => Some((coordinate, true)),
    })
}

/// The inputs of a state, in parts.
#[derive(Debug, Clone, Copy)]
pub struct StateInputs<'a> {
    pub(crate) q: &'a [RecordedNumber],
    pub(crate) q_dot: &'a [RecordedNumber],
    pub(crate) q_ddot: &'a [RecordedNumber],
    pub(crate) magnitudes: &'a [RecordedNumber],
    pub(crate) numbers: &'a [RecordedNumber],
    pub(crate) solution: &'a [RecordedNumber],
}

/// Where the inputs and outputs of a recorded state are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StateLayout {
    /// Number of coordinates.
    pub actuators: usize,
    /// Number of inputs of the magnitudes of the loads: for each load F, then by signal F′ and s₀.
    pub magnitudes: usize,
    /// Number of the machine's numbers.
    pub numbers: usize,
    /// Number of all inputs.
    pub inputs: usize,
}

impl StateLayout {
    /// Where the magnitudes of the loads begin.
    pub fn first_magnitude(&self) -> usize {
        3 * self.actuators
    }

    /// Where the machine's numbers begin.
    pub fn first_number(&self) -> usize {
        self.first_magnitude() + self.magnitudes
    }

    /// Where the solution begins.
    pub fn solution(&self) -> usize {
        self.first_number() + self.numbers
    }

    fn parts<'a>(&self, inputs: &'a [RecordedNumber]) -> StateInputs<'a> {
        let (q, rest) = inputs.split_at(self.actuators);
        let (q_dot, rest) = rest.split_at(self.actuators);
        let (q_ddot, rest) = rest.split_at(self.actuators);
        let (magnitudes, rest) = rest.split_at(self.magnitudes);
        let (numbers, solution) = rest.split_at(self.numbers);
        StateInputs {
            q,
            q_dot,
            q_ddot,
            magnitudes,
            numbers,
            solution,
        }
    }
}

/// A state of motion as operations.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordedState {
    /// The operations.
    pub code: StraightLine,
    /// Where its inputs are.
    pub layout: StateLayout,
}

impl RecordedState {
    /// The same without the operations that only other outputs need; these are zero.
    #[must_use]
    pub fn limited_to(&self, is_wanted: impl Fn(usize) -> bool) -> Self {
        let outputs = self.code.outputs.iter().enumerate();
        let outputs = outputs.map(|(k, output)| match is_wanted(k) {
            true => *output,
            false => Operand::Constant(0.0),
        });
        let code = StraightLine {
            operations: self.code.operations.clone(),
            outputs: outputs.collect(),
        };
        Self {
            code: code.without_unused(),
            layout: self.layout,
        }
    }

    /// Records the states of a machine of the structure of a model at some inputs, where the operations must be the same. Each list of
    /// inputs has q, q̇, q̈, the magnitudes, [numbers](RecordableModel::numbers), [solution](RecordableModel::solution).
    ///
    /// # Errors
    /// [`RecordingError`].
    pub fn record<M: RecordableModel>(
        model: &M,
        of: Described<'_, M>,
        inputs: &[Vec<f64>],
    ) -> Result<Self, RecordingError<StateRecordingError>> {
        let numbers = model.numbers(of).ok_or(StateRecordingError::Structure);
        let layout = StateLayout {
            actuators: model.actuators(),
            magnitudes: (of.loads.iter())
                .map(|load| 1 + 2 * signal_coordinates(&load.magnitude).count())
                .sum(),
            numbers: numbers.map_err(RecordingError::Evaluation)?.len(),
            inputs: inputs.first().map_or(0, Vec::len),
        };
        let code = record_at(inputs, |inputs| model.outputs(of, &layout.parts(inputs)))?;
        Ok(Self { code, layout })
    }
}
