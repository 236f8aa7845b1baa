//! Events at end stops. A coordinate that meets its stop rebounds at once,
//!
//! ```text
//! M Δq̇ = eᵢ P,    q̇ᵢ⁺ = −e q̇ᵢ⁻                                  (1)
//! ```
//!
//! and the other coordinates jump with it; friction during the impact is left out. Where what remains of the rebounds is
//! shorter than [`LAST_REBOUNDS`] of the motion the coordinate rests at their limit: it is fixed there, by a force that can only push.

use crate::contact::{ContactEvent, ContactMode, ContactStep, Stop, StopChange};
use crate::error::{DynamicsError, Result};
use crate::machine::{Machine, MachineWorkspace, MovingModel};

/// Rebounds that last less in sum than this part of the motion are the last: the force changes in them by no more than
/// such a part of itself, so that their sum is that of a geometric series to its square.
const LAST_REBOUNDS: f64 = 1e-7;
/// Impacts at one instant, where some coordinates strike others, after which none is the last.
const MAX_IMPACTS: usize = 1000;

/// The modes of stops after an event at time `t` (s), with the speeds behind the impacts, written into the state `y`; what
/// happened is added to `events`.
///
/// # Errors
/// [`DynamicsError`] where the state cannot be evaluated, or impacts follow each other without end.
// Long because it is one event: what is touched decides what is struck.
pub(super) fn pass_stops<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    (t, y): (f64, &mut [f64]),
    step: &ContactStep<'_>,
    events: &mut Vec<ContactEvent>,
) -> Result<bool> {
    let n = machine.free().len();
    let first = machine.stop_states().start;
    let frictions = machine.contact_count() - machine.stops.len();
    let mut is_struck = false;
    let mut touched = vec![false; machine.stops.len()];
    for (k, stop) in machine.stops.iter().enumerate() {
        touched[k] = step.touched[frictions + k];
        if !touched[k] {
            continue;
        }
        let is_touched = ContactMode::of_code(y[first + k]) == ContactMode::Holds;
        if stop.yielding.is_some() {
            let (mode, change) = match is_touched {
                true => (ContactMode::Undecided, StopChange::Leaves),
                false => (ContactMode::Holds, StopChange::Touches),
            };
            y[first + k] = mode.code();
            touched[k] = false;
            events.push(stop_event(stop.stop, (t, y), change));
        } else if is_touched {
            // The force would pull.
            y[first + k] = ContactMode::Undecided.code();
            touched[k] = false;
            events.push(stop_event(stop.stop, (t, y), StopChange::Leaves));
        } else {
            y[stop.free] = stop.at;
        }
    }
    for _ in 0..MAX_IMPACTS {
        let approaches =
            |&(k, stop): &(usize, &Stop)| touched[k] && stop.side * y[n + stop.free] < 0.0;
        let Some((k, stop)) = machine.stops.iter().enumerate().find(approaches) else {
            break;
        };
        is_struck = true;
        let change = strike(machine, workspace, (t, y), stop, stop.restitution)?;
        events.push(stop_event(stop.stop, (t, y), change));
        let resting = machine.stops.iter().enumerate();
        let rigid = |(other, stop): &(usize, &Stop)| *other != k && stop.yielding.is_none();
        for (other, resting) in resting.filter(rigid) {
            // One that rests and is struck away leaves its stop.
            let speed = resting.side * y[n + resting.free];
            if ContactMode::of_code(y[first + other]) == ContactMode::Holds && speed != 0.0 {
                y[first + other] = ContactMode::Undecided.code();
                touched[other] = true;
            }
        }
        if events.len() > 64 * MAX_IMPACTS {
            return Err(DynamicsError::StopsWithoutEnd { stop: stop.stop });
        }
    }
    rest(machine, workspace, (t, y), (step, &touched), events)?;
    Ok(is_struck)
}

/// What comes to rest on its stop stays there while the force pushes.
fn rest<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    (t, y): (f64, &mut [f64]),
    (step, touched): (&ContactStep<'_>, &[bool]),
    events: &mut Vec<ContactEvent>,
) -> Result<()> {
    let n = machine.free().len();
    let first = machine.stop_states().start;
    for (k, stop) in machine
        .stops
        .iter()
        .enumerate()
        .filter(|(k, _)| touched[*k])
    {
        machine.evaluate(t, y, workspace)?;
        let speed = stop.side * y[n + stop.free];
        let inward = -stop.side * workspace.acceleration(stop.actuator);
        let rebounds = 2.0 * speed / (inward * (1.0 - stop.restitution));
        // A rebound that an integration cannot resolve ends where it begins.
        let is_last = rebounds < LAST_REBOUNDS * step.span || step.repeated;
        if inward > 0.0 && (speed == 0.0 || is_last) {
            strike(machine, workspace, (t, y), stop, 0.0)?;
            y[n + stop.free] = 0.0;
            y[first + k] = ContactMode::Holds.code();
            let rests = if rebounds.is_finite() {
                t + rebounds
            } else {
                t
            };
            events.push(stop_event(stop.stop, (rests, y), StopChange::Rests));
        }
    }
    Ok(())
}

fn stop_event(stop: usize, (t, y): (f64, &[f64]), change: StopChange) -> ContactEvent {
    ContactEvent::Stop {
        t,
        y: y.to_vec(),
        stop,
        change,
    }
}

/// One impact, by (1), with its works.
fn strike<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    (t, y): (f64, &mut [f64]),
    stop: &Stop,
    restitution: f64,
) -> Result<StopChange> {
    let n = machine.free().len();
    machine.evaluate(t, y, workspace)?;
    let mut changes = workspace.unit_impulse(stop.free);
    let own = changes[stop.free];
    let before = y[n + stop.free];
    let impulse = -(1.0 + restitution) * before / own;
    for change in &mut changes {
        *change *= impulse;
    }
    machine.add_impact_works(workspace, (y, &changes), (stop, impulse));
    for (speed, change) in y[n..2 * n].iter_mut().zip(&changes) {
        *speed += change;
    }
    y[n + stop.free] = -restitution * before;
    Ok(StopChange::Impact { impulse, changes })
}
