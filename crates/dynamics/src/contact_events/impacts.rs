//! Events at end stops. A coordinate that meets its stop rebounds at once,
//!
//! ```text
//! M Δq̇ = eᵢ P,    q̇ᵢ⁺ = −e q̇ᵢ⁻                                  (1)
//! ```
//!
//! and the other coordinates jump with it; friction during the impact is neglected. If the remaining rebounds are shorter than
//! [`LAST_REBOUNDS`] of the motion, the coordinate comes to rest at the limit, where a force that can only push holds it.

use super::Passage;
use crate::contact::{ContactEvent, ContactMode, Stop, StopChange};
use crate::error::{DynamicsError, Result};
use crate::machine::MovingModel;

/// Rebounds whose total duration is below this fraction of the motion are the last. The force changes during them by at
/// most such a fraction, so that their duration is the sum of a geometric series with an error of its square.
const LAST_REBOUNDS: f64 = 1e-7;
/// Impacts at one instant, where some coordinates strike others, after which none is the last.
const MAX_IMPACTS: usize = 1000;

impl<M: MovingModel> Passage<'_, M> {
    /// Sets the modes of stops after the event, and the speeds after the impacts; returns whether a stop is struck.
    ///
    /// # Errors
    /// [`DynamicsError`] where the state cannot be evaluated, or impacts follow each other without end.
    // Long because it is one event: what is touched decides what is struck.
    pub(super) fn pass_stops(&mut self) -> Result<bool> {
        let (machine, n) = (self.machine, self.machine.free().len());
        let frictions = machine.contacts.len();
        let mut is_struck = false;
        let mut touched = vec![false; machine.stops.len()];
        for (k, stop) in machine.stops.iter().enumerate() {
            touched[k] = self.step.touched[frictions + k];
            if !touched[k] {
                continue;
            }
            let is_touched = self.rests(k);
            if is_touched || stop.yielding.is_some() {
                // The force of one that does not yield would pull.
                let (mode, change) = if is_touched {
                    (ContactMode::Undecided, StopChange::Leaves)
                } else {
                    (ContactMode::Holds, StopChange::Touches)
                };
                self.set_stop_mode(k, mode);
                touched[k] = false;
                self.record(stop, self.t, change);
            } else {
                self.y[stop.free] = stop.at;
            }
        }
        for _ in 0..MAX_IMPACTS {
            let approaches =
                |&(k, stop): &(usize, &Stop)| touched[k] && stop.side * self.y[n + stop.free] < 0.0;
            let Some((k, stop)) = machine.stops.iter().enumerate().find(approaches) else {
                break;
            };
            is_struck = true;
            let change = self.strike(stop, stop.restitution)?;
            self.record(stop, self.t, change);
            let resting = machine.stops.iter().enumerate();
            let rigid = |(other, stop): &(usize, &Stop)| *other != k && stop.yielding.is_none();
            for (other, resting) in resting.filter(rigid) {
                // One that rests and is struck away leaves its stop.
                let speed = resting.side * self.y[n + resting.free];
                if self.rests(other) && speed != 0.0 {
                    self.set_stop_mode(other, ContactMode::Undecided);
                    touched[other] = true;
                }
            }
            if self.events.len() > 64 * MAX_IMPACTS {
                return Err(DynamicsError::StopsWithoutEnd { stop: stop.stop });
            }
        }
        let stops = machine.stops.iter().enumerate();
        for (k, stop) in stops.filter(|(k, _)| touched[*k]) {
            self.rest(k, stop)?;
        }
        Ok(is_struck)
    }

    /// A coordinate that comes to rest on its stop stays there while the force pushes.
    fn rest(&mut self, k: usize, stop: &Stop) -> Result<()> {
        let speed_index = self.machine.free().len() + stop.free;
        self.evaluate()?;
        let speed = stop.side * self.y[speed_index];
        let inward = -stop.side * self.workspace.acceleration(stop.actuator);
        let rebounds = 2.0 * speed / (inward * (1.0 - stop.restitution));
        // A rebound that an integration cannot resolve ends where it begins.
        let is_last = rebounds < LAST_REBOUNDS * self.step.span || self.step.repeated;
        if inward > 0.0 && (speed == 0.0 || is_last) {
            self.strike(stop, 0.0)?;
            self.y[speed_index] = 0.0;
            self.set_stop_mode(k, ContactMode::Holds);
            let duration = if rebounds.is_finite() { rebounds } else { 0.0 };
            self.record(stop, self.t + duration, StopChange::Rests);
        }
        Ok(())
    }

    /// Whether a coordinate rests on the side of a stop, or touches one that yields.
    fn rests(&self, k: usize) -> bool {
        let code = self.y[self.machine.stop_states().start + k];
        ContactMode::of_code(code) == ContactMode::Holds
    }

    fn set_stop_mode(&mut self, k: usize, mode: ContactMode) {
        self.y[self.machine.stop_states().start + k] = mode.code();
    }

    fn record(&mut self, stop: &Stop, t: f64, change: StopChange) {
        let (y, stop) = (self.y.to_vec(), stop.stop);
        self.events.push(ContactEvent::Stop { t, y, stop, change });
    }

    /// One impact, by (1), with its works.
    fn strike(&mut self, stop: &Stop, restitution: f64) -> Result<StopChange> {
        let n = self.machine.free().len();
        self.evaluate()?;
        let mut changes = self.workspace.unit_impulse(stop.free);
        let own = changes[stop.free];
        let before = self.y[n + stop.free];
        let impulse = -(1.0 + restitution) * before / own;
        for change in &mut changes {
            *change *= impulse;
        }
        self.machine
            .add_impact_works(self.workspace, self.y, stop, impulse, &changes);
        for (speed, change) in self.y[n..2 * n].iter_mut().zip(&changes) {
            *speed += change;
        }
        self.y[n + stop.free] = -restitution * before;
        Ok(StopChange::Impact { impulse, changes })
    }
}
