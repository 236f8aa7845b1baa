//! The contacts of a machine: frictions that hold at rest, and end stops, with their place among the states.

use super::workspace::EquationWorkspace;
use super::{Machine, MachineError, MovingModel, NonconservativeSource};
use crate::contact::{ContactMode, EndStop, one_sided};
use crate::error::{DynamicsError, Result};
use dwell_numerics::Scalar;
use std::ops::Range;

impl<M: MovingModel> Machine<M> {
    /// This machine with end stops.
    ///
    /// # Errors
    /// [`MachineError::Stop`] for one that cannot be used.
    pub fn with_stops(mut self, stops: &[EndStop]) -> Result<Self, MachineError> {
        for (k, stop) in stops.iter().enumerate() {
            let low = stop.min.unwrap_or(f64::NEG_INFINITY);
            let high = stop.max.unwrap_or(f64::INFINITY);
            let yields = stop.yielding.is_none_or(|of| {
                of.stiffness > 0.0
                    && of.stiffness.is_finite()
                    && (0.0..f64::MAX).contains(&of.damping)
            });
            let fits = low < high && (0.0..=1.0).contains(&stop.restitution) && yields;
            if !fits || !self.free.contains(&stop.actuator) {
                return Err(MachineError::Stop(k));
            }
        }
        self.stops = one_sided(stops, &self.free).unwrap_or_default();
        let sources = (0..stops.len()).map(NonconservativeSource::Stop);
        self.nonconservative_sources.extend(sources);
        Ok(self)
    }

    /// The states of the drives.
    pub fn drive_states(&self) -> Range<usize> {
        let first = 2 * self.free.len();
        first..first + self.drive_state_count
    }

    /// The states that are the [modes](crate::ContactMode) of frictions that hold at rest.
    pub fn contact_states(&self) -> Range<usize> {
        let first = self.drive_states().end;
        first..first + self.contacts.len()
    }

    /// The states that say of each side of an end stop whether its coordinate rests on it.
    pub fn stop_states(&self) -> Range<usize> {
        let first = self.contact_states().end;
        first..first + self.stops.len()
    }

    /// Number of frictions that hold at rest, and of sides of end stops.
    pub(crate) fn contact_count(&self) -> usize {
        self.contacts.len() + self.stops.len()
    }

    /// Whether it has frictions that hold at rest, or end stops: then its motion has events of their own.
    pub fn has_contacts(&self) -> bool {
        self.contact_count() > 0
    }

    /// The frictions that hold at rest, by their loads.
    pub fn contact_loads(&self) -> impl Iterator<Item = usize> + '_ {
        self.contacts.iter().map(|contact| contact.load)
    }

    /// Sets the coordinates that rest on their stops, and the forces of compliant stops.
    // Most machines have no stops: out of the path of every evaluation.
    #[cold]
    #[inline(never)]
    pub(super) fn set_stops<T: Scalar>(&self, y: &[T], equation: &mut EquationWorkspace<T>) {
        let n = self.free.len();
        equation.locked.fill(false);
        equation.stop_forces.fill(T::from_f64(0.0));
        for (k, (stop, code)) in self.stops.iter().zip(&y[self.stop_states()]).enumerate() {
            let is_touched = ContactMode::of_code(code.value()) == ContactMode::Holds;
            match stop.push(y[stop.free], y[n + stop.free]) {
                Some(push) if is_touched => {
                    equation.stop_forces[k] = push * T::from_f64(stop.side);
                }
                Some(_) => {}
                None => equation.locked[stop.free] |= is_touched,
            }
        }
    }

    /// The loads, those of the drives last, that switch with coordinates and speeds.
    pub fn switching_loads(&self) -> Vec<usize> {
        self.state_switches.loads().collect()
    }

    /// The loads whose magnitudes must be taken from the motion: those of drives and contacts, and those that switch, which may have either
    /// value at a switch.
    pub fn given_loads(&self) -> impl Iterator<Item = usize> + '_ {
        let drives = self.drives.iter().map(|drive| drive.load);
        let all = drives.chain(self.contact_loads());
        all.chain(self.state_switches.loads())
    }

    /// Rejects an analysis of smooth motions if friction sticks; `what` states the reason.
    pub(crate) fn require_smooth(&self, what: &'static str) -> Result<()> {
        if let Some(stop) = self.stops.first() {
            return Err(DynamicsError::Stops {
                stop: stop.stop,
                what: "this analysis is of motions that meet no end stop",
            });
        }
        let first = self.contacts.first();
        first.map_or(Ok(()), |contact| {
            let source_index = contact.load;
            Err(DynamicsError::Sticks { source_index, what })
        })
    }

    /// Rejects a search for equilibria that are not points or intervals, as with sticking friction and several free
    /// coordinates.
    pub(crate) fn require_intervals(&self) -> Result<()> {
        if self.free.len() == 1 && self.stops.is_empty() {
            return Ok(());
        }
        self.require_smooth("its equilibria are no points but whole regions")
    }

    /// Whether a coordinate is prescribed.
    pub(crate) fn has_prescribed(&self) -> bool {
        self.free.len() < self.modes.len()
    }
}

/// Fixes coordinates: their accelerations are zero, whatever the forces.
pub(super) fn lock<T: Scalar>(locked: &[bool], mass_matrix: &mut [T], forces: &mut [T]) {
    let n = locked.len();
    for k in (0..n).filter(|&k| locked[k]) {
        for i in 0..n {
            mass_matrix[k * n + i] = T::from_f64(0.0);
            mass_matrix[i * n + k] = T::from_f64(0.0);
        }
        mass_matrix[k * n + k] = T::from_f64(1.0);
        forces[k] = T::from_f64(0.0);
    }
}
