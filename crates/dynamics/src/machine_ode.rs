//! A machine as an ODE system, with its exact Jacobian by dual numbers.

use crate::contact::{ContactEvent, ContactMode, ContactStep};
use crate::contact_events::pass;
use crate::error::{DynamicsError, MAX_OCCURRENCES, Result, too_many_events};
use crate::interruption;
use crate::machine::{Machine, MachineState, MachineWorkspace, MovingModel};
use crate::modes::SharedModes;
use crate::ode::{DualWorkspace, OdeState, OdeSystem};
use crate::sliding::Sliding;
use crate::state_switches::{HeldSource, Hidden};
use dwell_kinetostatics::{Magnitude, Model};
use dwell_laws::{Features, SwitchKind};
use dwell_numerics::Dual;
use std::sync::Arc;

/// A machine with the working memory to integrate it, for one thread.
#[derive(Debug)]
pub struct MachineOde<'m, M: MovingModel = Model> {
    machine: &'m Machine<M>,
    workspace: MachineWorkspace<f64, M>,
    dual_workspace: DualWorkspace<MachineWorkspace<Dual, M>>,
    error_weights: Vec<f64>,
    held: Vec<HeldSource>,
    /// The variables of the loads that switch, at the last check.
    seen: Vec<f64>,
    contact_events: Vec<ContactEvent>,
    modes: SharedModes,
}

impl<'m, M: MovingModel> MachineOde<'m, M> {
    /// A machine at its initial state, whose energies are the scale of the works.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the start cannot be evaluated.
    pub fn new(machine: &'m Machine<M>, t: f64, y: &[f64]) -> Result<Self> {
        let mut ode = Self::unscaled(machine);
        let scale = machine.evaluate(t, y, &mut ode.workspace)?.energy_scale();
        ode.error_weights[machine.work_offset()..].fill(scale);
        Ok(ode)
    }

    /// As [`MachineOde::new`], but the works that loads can do until `end` (s) are also a scale of the works. At an
    /// equilibrium, the energies are no measure of the motion that follows.
    ///
    /// # Errors
    /// As [`MachineOde::new`].
    pub fn until(machine: &'m Machine<M>, t: f64, y: &[f64], end: Option<f64>) -> Result<Self> {
        let mut ode = Self::new(machine, t, y)?;
        let work = machine.largest_work(t, end.unwrap_or(t));
        for weight in &mut ode.error_weights[machine.work_offset()..] {
            *weight = with_later_works(*weight, work);
        }
        let span = end.unwrap_or(t) - t;
        if SLOW * span > 1.0 {
            ode.scale_speeds(t, y, span)?;
        }
        Ok(ode)
    }

    /// The speeds of a motion that is slow are accurate by its own measure: one unit of its coordinates over its span, s. It is slow by
    /// its speeds, and by what its accelerations become over the span.
    fn scale_speeds(&mut self, t: f64, y: &[f64], span: f64) -> Result<()> {
        let machine = self.machine;
        let state = machine.evaluate(t, y, &mut self.workspace)?;
        let free = || machine.free().iter();
        let largest = |of: &[f64]| free().map(|&i| of[i].abs()).fold(0.0, f64::max);
        let accelerated = largest(state.q_ddot()) * span;
        if largest(state.q_dot()).max(accelerated) < SLOW {
            let n = free().count();
            self.error_weights[n..2 * n].fill(1.0 / span);
        }
        Ok(())
    }

    /// A machine whose works have no scale, because no works are integrated.
    pub(crate) fn unscaled(machine: &'m Machine<M>) -> Self {
        Self {
            machine,
            workspace: machine.workspace(),
            dual_workspace: DualWorkspace::new(machine.workspace(), machine.state_count()),
            error_weights: vec![1.0; machine.state_count()],
            held: Vec::new(),
            seen: Vec::new(),
            contact_events: Vec::new(),
            modes: SharedModes::default(),
        }
    }

    /// The changes of contacts in the motion so far, in order of time; they are taken.
    pub fn take_contact_events(&mut self) -> Vec<ContactEvent> {
        std::mem::take(&mut self.contact_events)
    }

    /// The modes of the motion so far.
    pub fn modes(&self) -> &SharedModes {
        &self.modes
    }

    /// This system, which records its modes in `modes`.
    pub(crate) fn in_modes(mut self, modes: &SharedModes) -> Self {
        self.modes = modes.clone();
        self
    }
}

/// Below this speed, rad/s or m/s, a motion is not one of seconds.
const SLOW: f64 = 1e-3;
/// The part of the largest work below which a work does not count.
const SMALL_WORK: f64 = 1e-6;

/// The scale of works at the start, J, or that of the largest later work, if it is larger.
pub(crate) fn with_later_works(scale: f64, largest_work: f64) -> f64 {
    let later = SMALL_WORK * largest_work;
    if later.is_finite() {
        scale.max(later)
    } else {
        scale
    }
}

impl<M: MovingModel> MachineState<'_, f64, M> {
    /// The scale of works, J: the kinetic energy and the work of actuators and drives over one unit of their
    /// coordinates.
    fn energy_scale(&self) -> f64 {
        let [kinetic, _] = self.energy();
        let forces = self.inverse_dynamics().tau.iter();
        let forces = forces.chain(self.drive_forces());
        let scale = kinetic + forces.map(|f| f.abs()).sum::<f64>();
        if scale.is_normal() { scale } else { 1.0 }
    }
}

impl<M: MovingModel> OdeSystem for MachineOde<'_, M> {
    fn size(&self) -> usize {
        self.machine.state_count()
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        interruption::check()?;
        let (machine, workspace) = (self.machine, &mut self.workspace);
        if machine.unloaded_derivative(y, workspace, out)? {
            return Ok(());
        }
        let state = self.machine.evaluate(t, y, &mut self.workspace)?;
        state.derivative(out);
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let machine = self.machine;
        let columns = machine.drive_states().end;
        // Nothing depends on the works, and nothing smoothly on the modes of contacts.
        let rhs = |y: &[Dual], workspace: &mut MachineWorkspace<Dual, M>, out: &mut [Dual]| {
            if !machine.unloaded_derivative(y, workspace, out)? {
                machine.evaluate(t, y, workspace)?.derivative(out);
            }
            Ok(())
        };
        self.dual_workspace.jacobian(columns, y, out, rhs)
    }

    fn time_features(&self) -> Option<Arc<Features>> {
        Some(Arc::clone(&self.machine.time_features))
    }

    fn own_function(&self) -> Option<usize> {
        let mut loads = self.machine.model.loads().iter();
        loads.position(|load| matches!(load.magnitude, Magnitude::Function(..)))
    }

    fn switch_kinds(&self) -> &[SwitchKind] {
        self.machine.state_switches.kinds()
    }

    fn switch_source(&self, switch: usize) -> usize {
        self.machine.state_switches.source_index(switch)
    }

    fn may_hide(&self) -> bool {
        self.machine.state_switches.may_hide()
    }

    fn followed_signals(&self) -> Option<Vec<usize>> {
        self.machine.state_switches.followed()
    }

    fn read_signals(&self, out: &mut Vec<f64>) {
        out.clone_from(&self.seen);
    }

    fn hidden_in(&self, samples: &[Vec<f64>; 5], pieces: &[Option<f64>]) -> Option<Hidden> {
        let switches = &self.machine.state_switches;
        switches.hidden_in(&self.held, samples, pieces)
    }

    fn switch_operands(&self, switch: usize) -> Vec<usize> {
        self.machine.state_switches.operands(switch).to_vec()
    }

    fn switch_values(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let (held, seen) = (&self.held, &mut self.seen);
        self.machine
            .switch_values(t, y, &mut self.workspace, held, seen, out)
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        self.machine
            .switch_rates(t, y, rates, &mut self.workspace, &self.held, out)?;
        Ok(true)
    }

    fn record_sliding(&mut self, at: &OdeState, switch: usize, sliding: Option<&Sliding>) {
        self.contact_events.push(ContactEvent::Switch {
            t: at.t,
            y: at.y.clone(),
            load: self.switch_source(switch),
            sliding: sliding.cloned(),
        });
    }

    fn record_mode(&mut self, at: &OdeState, pieces: &[Option<f64>], sliding: Option<&Sliding>) {
        self.modes.get().add(at, pieces, sliding);
    }

    fn hold_pieces(&mut self, pieces: &[Option<f64>]) {
        let (machine, workspace) = (self.machine, &mut self.workspace);
        let dual = self.dual_workspace.inner();
        let set = |load: usize, held: &HeldSource| {
            machine.hold_source(load, held, workspace);
            machine.hold_source(load, held, dual);
        };
        machine.state_switches.hold(pieces, &mut self.held, set);
    }

    fn contact_count(&self) -> usize {
        self.machine.contact_count()
    }

    fn contact_without_mode(&self, contact: usize) -> DynamicsError {
        let (frictions, stops) = (&self.machine.contacts, &self.machine.stops);
        match frictions.get(contact) {
            Some(friction) => DynamicsError::NoContactMode {
                source_index: friction.load,
            },
            // The stops are behind them.
            None => DynamicsError::StopsWithoutEnd {
                stop: stops[contact - frictions.len()].stop,
            },
        }
    }

    fn speed_at_stop(&self, contact: usize, y: &[f64]) -> Option<(usize, f64)> {
        let k = contact.checked_sub(self.machine.contacts.len())?;
        let stop = &self.machine.stops[k];
        let speed = self.machine.free().len() + stop.free;
        let code = y[self.machine.stop_states().start + k];
        let is_free = stop.yielding.is_none() && ContactMode::of_code(code) != ContactMode::Holds;
        let is_there = y[stop.free] == stop.at && y[speed] == 0.0;
        (is_free && is_there).then_some((speed, stop.side))
    }

    fn contact_margins(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<bool> {
        self.machine.evaluate(t, y, &mut self.workspace)?;
        let contacts = self.workspace.contacts();
        let (frictions, stops) = out.split_at_mut(self.machine.contacts.len());
        for (i, out) in frictions.iter_mut().enumerate() {
            *out = contacts.margin(i);
        }
        let n = self.machine.free().len();
        let modes = &y[self.machine.stop_states()];
        for ((stop, code), out) in self.machine.stops.iter().zip(modes).zip(stops) {
            let is_touched = ContactMode::of_code(*code) == ContactMode::Holds;
            let speed = y[n + stop.free];
            if let Some(margin) = stop.yielding_margin(is_touched, y[stop.free], speed) {
                *out = margin;
                continue;
            }
            *out = stop.side
                * match ContactMode::of_code(*code) {
                    ContactMode::Holds => self.workspace.actuator_force(stop.actuator),
                    _ => y[stop.free] - stop.at,
                };
        }
        let codes = y[self.machine.contact_states()].iter();
        let mut modes = codes.map(|&code| ContactMode::of_code(code));
        Ok(modes.any(ContactMode::is_open))
    }

    fn pass_contacts(&mut self, t: f64, y: &mut [f64], step: &ContactStep<'_>) -> Result<()> {
        let changes = pass(self.machine, &mut self.workspace, t, y, step)?;
        self.contact_events.extend(changes);
        if self.contact_events.len() > MAX_OCCURRENCES {
            return Err(too_many_events(t));
        }
        Ok(())
    }

    fn balance(&mut self, at: &OdeState) -> Option<[f64; 2]> {
        if self.machine.has_contacts() {
            // Impacts lose energy that is no work.
            return None;
        }
        let energy = self.machine.energy(at.t, &at.y, &mut self.workspace);
        let [kinetic, potential] = energy.ok()?;
        let works: f64 = at.y[self.machine.work_offset()..].iter().sum();
        Some([kinetic, kinetic + potential - works])
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.error_weights[state]
    }
}
