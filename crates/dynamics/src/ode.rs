//! Systems of ordinary differential equations, and the data that their integration passes to an observer.

use crate::contact::ContactStep;
use crate::error::{DynamicsError, Result};
use crate::options::Statistics;
use crate::sliding::Sliding;
use crate::state_switches::Hidden;
use dwell_laws::{Features, SwitchKind};
use dwell_numerics::{Dual, Scalar};
use std::sync::Arc;

/// A time and a state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct OdeState {
    /// Time, s.
    pub t: f64,
    /// The state.
    pub y: Vec<f64>,
}

/// Time, coordinate and speed of a motion of one freedom without drive states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReducedState {
    /// Time, s.
    pub t: f64,
    /// Coordinate, rad or m.
    pub q: f64,
    /// Speed, rad/s or m/s.
    pub q_dot: f64,
}

impl From<&OdeState> for ReducedState {
    /// The first two states are the coordinate and its speed.
    fn from(state: &OdeState) -> Self {
        Self {
            t: state.t,
            q: state.y[0],
            q_dot: state.y[1],
        }
    }
}

impl From<ReducedState> for OdeState {
    fn from(ReducedState { t, q, q_dot }: ReducedState) -> Self {
        Self {
            t,
            y: vec![q, q_dot],
        }
    }
}

/// A system of first order, ẏ = f(t, y).
pub trait OdeSystem {
    /// Number of states.
    fn size(&self) -> usize;

    /// f(t, y) into `out`.
    ///
    /// # Errors
    /// [`DynamicsError`] where it cannot be evaluated.
    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()>;

    /// ∂fᵢ/∂yⱼ into `out`, row by row.
    ///
    /// # Errors
    /// As [`OdeSystem::rhs`].
    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()>;

    /// The times at which the right-hand side switches, and its time scales.
    fn time_features(&self) -> Option<Arc<Features>> {
        None
    }

    /// The index of the first load given as a function of a program, of which only breakpoints are known.
    fn own_function(&self) -> Option<usize> {
        None
    }

    /// The values at which the switching functions switch, on which pieces of the right-hand side depend.
    fn switch_kinds(&self) -> &[SwitchKind] {
        &[]
    }

    /// The index of the load (those of the drives last) to which one of these functions belongs.
    fn switch_source(&self, _switch: usize) -> usize {
        0
    }

    /// Whether loads may vary, or their conditions change, between the points of a step at which they are seen.
    fn may_hide(&self) -> bool {
        false
    }

    /// The variables among [`OdeSystem::read_signals`] that must reverse for a load to vary between the points of a step, if nothing
    /// switches; `None` if other causes exist.
    fn followed_signals(&self) -> Option<Vec<usize>> {
        None
    }

    /// The variables of the loads where [`OdeSystem::switch_values`] were evaluated last.
    fn read_signals(&self, _out: &mut Vec<f64>) {}

    /// The first hidden feature of the loads between five equally spaced points of a step, with these variables, on
    /// these pieces.
    fn hidden_in(&self, _samples: &[Vec<f64>; 5], _pieces: &[Option<f64>]) -> Option<Hidden> {
        None
    }

    /// The functions, before one of them, on whose pieces its value depends.
    fn switch_operands(&self, _switch: usize) -> Vec<usize> {
        Vec::new()
    }

    /// The values of these functions, on the pieces that are held.
    ///
    /// # Errors
    /// As [`OdeSystem::rhs`].
    fn switch_values(&mut self, _t: f64, _y: &[f64], _out: &mut [f64]) -> Result<()> {
        Ok(())
    }

    /// The values of these functions and their rates along `rates` of the state, on the pieces that are held; whether they
    /// are known.
    ///
    /// # Errors
    /// As [`OdeSystem::rhs`].
    fn switch_rates(
        &mut self,
        _t: f64,
        _y: &[f64],
        _rates: &[f64],
        _out: &mut [[f64; 2]],
    ) -> Result<bool> {
        Ok(false)
    }

    /// Called when the motion begins to slide along one of these switches, and when it leaves it.
    fn record_sliding(&mut self, _at: &OdeState, _switch: usize, _sliding: Option<&Sliding>) {}

    /// Called where a mode of the motion begins: with the piece of each function, and along which switch it slides.
    fn record_mode(&mut self, _at: &OdeState, _pieces: &[Option<f64>], _sliding: Option<&Sliding>) {
    }

    /// Holds one piece of each function, independent of the state, until others are set. `None`: the state decides.
    fn hold_pieces(&mut self, _pieces: &[Option<f64>]) {}

    /// Number of contacts whose surfaces hold or slide.
    fn contact_count(&self) -> usize {
        0
    }

    /// The error for modes of a contact that change without end at one instant.
    fn contact_without_mode(&self, _contact: usize) -> DynamicsError {
        DynamicsError::NoContactMode { source_index: 0 }
    }

    /// The state that is the speed of a coordinate which lies at its rigid end stop without speed and does not rest on it,
    /// and the sign of the direction away from the stop; none of any other contact.
    fn speed_at_stop(&self, _contact: usize, _y: &[f64]) -> Option<(usize, f64)> {
        None
    }

    /// By contact: its margin to a change of its mode, negative beyond it; NaN if no change is near. Returns whether a
    /// mode is still undecided.
    ///
    /// # Errors
    /// As [`OdeSystem::rhs`].
    fn contact_margins(&mut self, _t: f64, _y: &[f64], _out: &mut [f64]) -> Result<bool> {
        Ok(false)
    }

    /// Changes the modes of contacts, and the speeds that go with them, where an event has ended an integration.
    ///
    /// # Errors
    /// As [`OdeSystem::rhs`], and where no mode is found.
    fn pass_contacts(&mut self, _t: f64, _y: &mut [f64], _step: &ContactStep<'_>) -> Result<()> {
        Ok(())
    }

    /// The kinetic energy, and the energies minus the works, J; `None` if they are unknown, or if causes other than the
    /// works change them.
    fn balance(&mut self, _at: &OdeState) -> Option<[f64; 2]> {
        None
    }

    /// The factor of a state in the absolute tolerance.
    fn error_weight(&self, _state: usize) -> f64 {
        1.0
    }
}

/// Working memory for a Jacobian by dual numbers.
#[derive(Debug, Clone)]
pub(crate) struct DualWorkspace<W> {
    inner: W,
    y: Vec<Dual>,
    rates: Vec<Dual>,
}

impl<W> DualWorkspace<W> {
    /// Working memory for a number of states; `inner` is the memory of the right-hand side.
    pub(crate) fn new(inner: W, states: usize) -> Self {
        let y = vec![Dual::from_f64(0.0); states];
        let rates = y.clone();
        Self { inner, y, rates }
    }

    /// The memory of the right-hand side.
    pub(crate) fn inner(&mut self) -> &mut W {
        &mut self.inner
    }

    /// A state as dual numbers whose derivatives are its rates, and the memory of the right-hand side.
    pub(crate) fn along(&mut self, y: &[f64], rates: &[f64]) -> (&[Dual], &mut W) {
        for (dual, (&v, &d)) in self.y.iter_mut().zip(y.iter().zip(rates)) {
            *dual = Dual { v, d };
        }
        (&self.y, &mut self.inner)
    }

    /// The first columns of a Jacobian, row by row into `out`.
    pub(crate) fn jacobian(
        &mut self,
        columns: usize,
        y: &[f64],
        out: &mut [f64],
        mut rhs: impl FnMut(&[Dual], &mut W, &mut [Dual]) -> Result<()>,
    ) -> Result<()> {
        out.fill(0.0);
        for j in 0..columns {
            for (i, (dual, &value)) in self.y.iter_mut().zip(y).enumerate() {
                *dual = if i == j {
                    Dual::variable(value)
                } else {
                    Dual::from_f64(value)
                };
            }
            rhs(&self.y, &mut self.inner, &mut self.rates)?;
            for (i, rate) in self.rates.iter().enumerate() {
                out[i * y.len() + j] = rate.d;
            }
        }
        Ok(())
    }
}

/// The answer of an observer after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepControl {
    /// Take another step.
    Continue,
    /// End the integration with this step.
    Stop,
}

/// The state at any time within the last step, by the method's interpolant.
pub type DenseOutput<'d> = &'d mut dyn FnMut(f64, &mut [f64]) -> Result<()>;

/// A function called after each step with the state before it, the state after it, and the dense output
/// between the two.
pub type StepObserver<'w> =
    &'w mut dyn FnMut(&OdeState, &OdeState, DenseOutput<'_>) -> Result<StepControl>;

/// How an integration ended, and the work it took.
#[derive(Debug, Clone, PartialEq)]
pub struct Termination {
    /// The state at the end of the last good step.
    pub state: OdeState,
    /// The error that ended it early, if one did.
    pub error: Option<DynamicsError>,
    /// The work done.
    pub statistics: Statistics,
}

impl Termination {
    /// The last state, if no error ended the integration early.
    pub(crate) fn completed(self) -> Result<OdeState> {
        self.error.map_or(Ok(self.state), Err)
    }
}

/// The number of subintervals of a step in which a change of sign is searched for.
const ROOT_SUBINTERVALS: usize = 4;

/// The last step, with its dense output.
pub(crate) struct Step<'s> {
    pub(crate) before: &'s OdeState,
    pub(crate) now: &'s OdeState,
    pub(crate) dense: DenseOutput<'s>,
}

impl Step<'_> {
    /// The part of it up to a state.
    pub(crate) fn until<'a>(&'a mut self, now: &'a OdeState) -> Step<'a> {
        let (before, dense) = (self.before, &mut *self.dense);
        Step { before, now, dense }
    }

    /// Its duration, s.
    pub(crate) fn duration(&self) -> f64 {
        self.now.t - self.before.t
    }

    /// The ends of the subintervals in which roots are searched for; the last is the end of the step.
    pub(crate) fn root_subintervals(&self) -> impl Iterator<Item = f64> + use<> {
        self.subinterval_ends(ROOT_SUBINTERVALS)
    }

    /// The ends of equal parts of it; the last is the step's own.
    pub(crate) fn subinterval_ends(&self, parts: usize) -> impl Iterator<Item = f64> + use<> {
        let (from, to) = (self.before.t, self.now.t);
        (1..=parts).map(move |k| {
            if k == parts {
                to
            } else {
                from + (to - from) * k as f64 / parts as f64
            }
        })
    }

    /// The state at a time within it.
    pub(crate) fn state_at(&mut self, t: f64) -> Result<OdeState> {
        let mut state = self.now.clone();
        if t < self.now.t {
            (self.dense)(t, &mut state.y)?;
            state.t = t;
        }
        Ok(state)
    }

    /// The state at a time within the step; at its start, exactly the state before the step.
    pub(crate) fn state_from_start(&mut self, t: f64) -> Result<OdeState> {
        if t > self.before.t {
            self.state_at(t)
        } else {
            Ok(self.before.clone())
        }
    }
}
