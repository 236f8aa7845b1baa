//! Changes of modes at an event: finds the surfaces at rest there and their next modes, and sets their speeds exactly to
//! zero.

use crate::contact::{Contact, ContactEvent, ContactMode, ContactStep, independent};
use crate::error::Result;
use crate::machine::{Machine, MachineWorkspace, MovingModel};
use dwell_numerics::lu;

/// Surfaces are at rest below this part of the largest speed that they had in the last step.
const REST: f64 = 1e-9;
/// A force within this part of its limit is at it.
const AT_LIMIT: f64 = 1e-9;

/// A machine at an event of its contacts.
pub(super) struct Passage<'a, M: MovingModel> {
    pub(super) machine: &'a Machine<M>,
    pub(super) workspace: &'a mut MachineWorkspace<f64, M>,
    /// Time, s, and the state there.
    pub(super) t: f64,
    pub(super) y: &'a mut [f64],
    /// The state of the contacts in the previous step.
    pub(super) step: &'a ContactStep<'a>,
    /// The changes.
    pub(super) events: Vec<ContactEvent>,
}

/// Finds the modes at time `t` (s), writes them and the corresponding speeds into the state `y`, and returns the changes.
///
/// # Errors
/// [`DynamicsError`](crate::DynamicsError) where no mode is found, or the state cannot be evaluated.
pub(crate) fn pass<M: MovingModel>(
    machine: &Machine<M>,
    workspace: &mut MachineWorkspace<f64, M>,
    t: f64,
    y: &mut [f64],
    step: &ContactStep<'_>,
) -> Result<Vec<ContactEvent>> {
    let mut passage = Passage {
        machine,
        workspace,
        t,
        y,
        step,
        events: Vec::new(),
    };
    passage.pass()?;
    Ok(passage.events)
}

impl<M: MovingModel> Passage<'_, M> {
    // Long because it is one event: what is at rest, the modes, the speeds and the report follow from each other.
    fn pass(&mut self) -> Result<()> {
        let (machine, modes) = (self.machine, self.machine.contact_states());
        // At the start of a motion nothing changes.
        let entry = self.y[modes.clone()].iter();
        let entry: Vec<ContactMode> = entry.map(|&code| ContactMode::of_code(code)).collect();
        let is_struck = self.pass_stops()?;
        if machine.contacts.is_empty() {
            return Ok(());
        }
        if is_struck {
            // The speeds behind the impact say what the surfaces do.
            self.decide_by_speeds()?;
        }
        self.evaluate()?;
        let contacts = self.workspace.contacts();
        for (i, &mode) in contacts.modes.iter().enumerate() {
            let (speed, share) = (contacts.speeds[i], contacts.shares[i]);
            let stands =
                || self.step.touched[i] || speed.abs() <= REST * self.step.largest_speeds[i];
            let at_limit = mode == ContactMode::Holds && (share - 1.0).abs() < AT_LIMIT;
            let next = match mode {
                ContactMode::Slides { .. } if !stands() => mode,
                _ => ContactMode::AtRest { at_limit },
            };
            self.y[modes.start + i] = next.code();
        }
        self.evaluate()?;
        self.stop_surfaces();
        let after = &self.workspace.contacts().modes;
        for (code, mode) in self.y[modes].iter_mut().zip(after) {
            *code = mode.code();
        }
        let each = machine.contacts.iter().zip(entry.iter().zip(after));
        let changed = each.filter(|(_, (from, to))| !from.is_open() && from != to);
        let event = |(contact, (from, to)): (&Contact<_>, (&ContactMode, &ContactMode))| {
            ContactEvent::Friction {
                t: self.t,
                y: self.y.to_vec(),
                load: contact.load,
                from: *from,
                to: *to,
            }
        };
        self.events.extend(changed.map(event));
        Ok(())
    }

    pub(super) fn evaluate(&mut self) -> Result<()> {
        self.machine.evaluate(self.t, self.y, self.workspace)?;
        Ok(())
    }

    /// Leaves the modes open of surfaces that an impact has given a speed, or taken one from.
    fn decide_by_speeds(&mut self) -> Result<()> {
        /// Speeds below this part of the largest are rounding.
        const ROUNDING: f64 = 1e-12;
        self.evaluate()?;
        let speeds = &self.workspace.contacts().speeds;
        let largest = speeds.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        let modes = self.machine.contact_states();
        for (code, speed) in self.y[modes].iter_mut().zip(speeds) {
            let next = if speed.abs() <= ROUNDING * largest {
                ContactMode::AtRest { at_limit: false }
            } else {
                ContactMode::Slides {
                    forward: *speed > 0.0,
                }
            };
            *code = next.code();
        }
        Ok(())
    }

    /// Removes the speeds that sticking surfaces have within rounding, with the least change of momentum. Surfaces that only pass
    /// through a speed of zero are not stopped.
    fn stop_surfaces(&mut self) {
        let (machine, workspace) = (self.machine, &*self.workspace);
        let contacts = workspace.contacts();
        let holds = |i: &usize| contacts.modes[*i] == ContactMode::Holds;
        let held: Vec<usize> = (0..contacts.modes.len()).filter(holds).collect();
        let basis = independent(&held, |i, j| contacts.of_two(i, j));
        let n = machine.free().len();
        let speeds = &mut self.y[n..2 * n];
        if basis.len() == n - workspace.locked() && !machine.has_prescribed() {
            return speeds.fill(0.0);
        }
        let r = basis.len();
        let mut matrix = Vec::with_capacity(r * r);
        for &i in &basis {
            matrix.extend(basis.iter().map(|&j| contacts.of_two(i, j)));
        }
        let mut pivots = vec![0; r];
        lu::factor(&mut matrix, &mut pivots);
        let mut impulses: Vec<f64> = basis.iter().map(|&i| contacts.speeds[i]).collect();
        lu::solve(&matrix, &pivots, &mut impulses);
        for (&i, impulse) in basis.iter().zip(impulses) {
            let change = workspace.friction_accelerations(machine.contacts[i].dependent);
            for (speed, change) in speeds.iter_mut().zip(change) {
                *speed -= change * impulse;
            }
        }
    }
}
