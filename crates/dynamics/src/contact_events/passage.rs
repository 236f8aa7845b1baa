//! Changes of modes at an event: which surfaces are at rest there, what they do next, and that they are exactly at rest.

use crate::contact::{Contact, ContactEvent, ContactMode, ContactStep, independent};
use crate::error::Result;
use crate::machine::{Machine, MachineWorkspace, MovingModel};
use dwell_numerics::lu;

/// Surfaces are at rest below this part of the largest speed that they had in the last step.
const REST: f64 = 1e-9;
/// A force within this part of its limit is at it.
const AT_LIMIT: f64 = 1e-9;

/// Finds the modes anew at time `t` (s), writes them and the speeds that go with them into the state `y`, and yields what
/// changed.
///
/// # Errors
/// [`DynamicsError`](crate::DynamicsError) where no mode is found, or the state cannot be evaluated.
// Long because it is one event: what is at rest, the modes, the speeds and the report follow from each other.
pub(crate) fn pass<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    (t, y): (f64, &mut [f64]),
    step: &ContactStep<'_>,
) -> Result<Vec<ContactEvent>> {
    let mut events = Vec::new();
    let entry: Vec<f64> = y[machine.contact_states()].to_vec();
    let is_struck = super::impacts::pass_stops(machine, workspace, (t, y), step, &mut events)?;
    if machine.contacts.is_empty() {
        return Ok(events);
    }
    if is_struck {
        // The speeds behind the impact say what the surfaces do.
        decide_by_speeds(machine, workspace, (t, y))?;
    }
    machine.evaluate(t, y, workspace)?;
    let modes = machine.contact_states();
    let before = workspace.contacts().modes.clone();
    for (i, &mode) in before.iter().enumerate() {
        let contacts = workspace.contacts();
        let (speed, share) = (contacts.speeds[i], contacts.shares[i]);
        let next = match mode {
            ContactMode::Slides { .. } => {
                let stands = step.touched[i] || speed.abs() <= REST * step.largest_speeds[i];
                match stands {
                    true => ContactMode::AtRest { at_limit: false },
                    false => mode,
                }
            }
            ContactMode::Holds => ContactMode::AtRest {
                at_limit: (share - 1.0).abs() < AT_LIMIT,
            },
            ContactMode::AtLimit { .. } | ContactMode::AtRest { .. } | ContactMode::Undecided => {
                ContactMode::AtRest { at_limit: false }
            }
        };
        y[modes.start + i] = next.code();
    }
    machine.evaluate(t, y, workspace)?;
    let after = &workspace.contacts().modes;
    // Those that only pass through a speed of zero are not stopped.
    let holds = |i: &usize| after[*i] == ContactMode::Holds;
    let held: Vec<usize> = (0..after.len()).filter(holds).collect();
    stop_surfaces(machine, workspace, y, &held);
    for (code, mode) in y[modes].iter_mut().zip(after) {
        *code = mode.code();
    }
    // At the start of a motion nothing changes.
    let entry: Vec<ContactMode> = entry.into_iter().map(ContactMode::of_code).collect();
    let each = machine.contacts.iter().zip(entry.iter().zip(after));
    let changed = each.filter(|(_, (from, to))| !from.is_open() && from != to);
    let event = |(contact, (from, to)): (&Contact<_>, (&ContactMode, &ContactMode))| {
        ContactEvent::Friction {
            t,
            y: y.to_vec(),
            load: contact.load,
            from: *from,
            to: *to,
        }
    };
    events.extend(changed.map(event));
    Ok(events)
}

/// Leaves the modes open of surfaces that an impact has given a speed, or taken one from.
fn decide_by_speeds<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    (t, y): (f64, &mut [f64]),
) -> Result<()> {
    /// Speeds below this part of the largest are rounding.
    const ROUNDING: f64 = 1e-12;
    machine.evaluate(t, y, workspace)?;
    let speeds = &workspace.contacts().speeds;
    let largest = speeds.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    let modes = machine.contact_states();
    for (code, speed) in y[modes].iter_mut().zip(speeds) {
        let next = match speed.abs() <= ROUNDING * largest {
            true => ContactMode::AtRest { at_limit: false },
            false => ContactMode::Slides {
                forward: *speed > 0.0,
            },
        };
        *code = next.code();
    }
    Ok(())
}

/// Takes off the speeds that surfaces that hold have within rounding, with the least change of momentum.
fn stop_surfaces<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &MachineWorkspace<f64, M>,
    y: &mut [f64],
    held: &[usize],
) {
    let contacts = workspace.contacts();
    let dependent = |i: usize| machine.contacts[i].dependent;
    let basis = independent(held, |i, j| contacts.compliance[i][dependent(j)]);
    let n = machine.free().len();
    let speeds = &mut y[n..2 * n];
    if basis.len() == n - workspace.locked() && !machine.has_prescribed() {
        return speeds.fill(0.0);
    }
    let r = basis.len();
    let mut matrix = Vec::with_capacity(r * r);
    for &i in &basis {
        matrix.extend(basis.iter().map(|&j| contacts.compliance[i][dependent(j)]));
    }
    let mut pivots = vec![0; r];
    lu::factor(&mut matrix, &mut pivots);
    let mut impulses: Vec<f64> = basis.iter().map(|&i| contacts.speeds[i]).collect();
    lu::solve(&matrix, &pivots, &mut impulses);
    for (&i, impulse) in basis.iter().zip(impulses) {
        let change = workspace.friction_accelerations(dependent(i));
        for (speed, change) in speeds.iter_mut().zip(change) {
            *speed -= change * impulse;
        }
    }
}
