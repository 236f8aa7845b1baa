//! A machine's table as a system to be integrated, with its exact Jacobian: dual numbers through the pieces.

use super::{LoadEffect, TabulatedCoordinate, TabulatedMachine, TabulatedSignal};
use crate::contact::ContactEvent;
use crate::error::{DynamicsError, Result, positive_inertia};
use crate::machine_ode::with_later_works;
use crate::modes::SharedModes;
use crate::ode::{DualWorkspace, OdeState, OdeSystem};
use crate::sliding::Sliding;
use crate::state_switches::{HeldSource, Hidden, SourceState};
use dwell_kinetostatics::{KinetostaticsError, Magnitude};
use dwell_laws::{Features, SwitchKind};
use dwell_numerics::{Dual, Scalar};
use std::sync::Arc;

/// A table with the working memory to integrate it, for one thread. Its states are those of
/// [`MachineOde`](crate::MachineOde).
#[derive(Debug, Clone)]
pub struct TabulatedMachineOde<'t> {
    machine: &'t TabulatedMachine,
    workspace: TableWorkspace<f64>,
    dual_workspace: DualWorkspace<TableWorkspace<Dual>>,
    /// The scale of works, J.
    energy_scale: f64,
    /// By switching load: its held pieces.
    held: Vec<HeldSource>,
    /// The variables of the loads that switch, at the last check.
    seen: Vec<f64>,
    contact_events: Vec<ContactEvent>,
    modes: SharedModes,
}

impl TabulatedMachineOde<'_> {
    /// Removes and returns the events so far: where the motion began to slide along a switch of a load, and where it
    /// left it.
    pub fn take_contact_events(&mut self) -> Vec<ContactEvent> {
        std::mem::take(&mut self.contact_events)
    }

    /// The modes of the motion so far.
    pub fn modes(&self) -> &SharedModes {
        &self.modes
    }
}

/// Working memory in one kind of number.
#[derive(Debug, Clone)]
struct TableWorkspace<T> {
    columns: Vec<T>,
    arguments: Vec<T>,
    values: Vec<f64>,
    /// By load: the pieces on which it is held.
    held: Vec<HeldSource>,
}

impl<T: Scalar> TableWorkspace<T> {
    fn new(machine: &TabulatedMachine) -> Self {
        let loads = machine.tabulated_loads.iter();
        let counts = loads.map(|load| load.signals.len());
        let max = counts.max().unwrap_or(0);
        Self {
            columns: vec![T::from_f64(0.0); machine.column_count],
            arguments: vec![T::from_f64(0.0); max],
            values: vec![0.0; max],
            held: vec![HeldSource::default(); machine.tabulated_loads.len()],
        }
    }
}

/// The contribution of a load or drive at one state.
struct LoadContribution<T> {
    /// F of a load, or the force of a drive.
    force: T,
    /// The generalised force.
    generalised_force: T,
    /// For a drive with a state: the index of the state, and its rate.
    drive_state_rate: Option<(usize, T)>,
}

impl TabulatedMachine {
    /// Number of states: q, q̇, those of the drives, the works.
    pub fn state_count(&self) -> usize {
        2 + self.drive_state_count + self.work_count
    }

    /// The ODE system of the table, from a state whose energies are the scale of the works; so is the `largest_work`, J,
    /// that loads can do during the motion ([`Machine::largest_work`](crate::Machine::largest_work), else 0).
    ///
    /// # Errors
    /// [`DynamicsError`] where the start cannot be evaluated.
    pub fn ode(&self, t: f64, y: &[f64], largest_work: f64) -> Result<TabulatedMachineOde<'_>> {
        let mut workspace = TableWorkspace::new(self);
        let [q, q_dot] = [y[0], y[1]];
        let [kinetic, _] = self.energy(q, q_dot)?;
        self.columns.eval(q, &mut workspace.columns, &mut [])?;
        let mut energy_scale = kinetic;
        for (k, load) in self.tabulated_loads.iter().enumerate() {
            let contribution = self.load_contribution(k, t, y, &mut workspace)?;
            if matches!(load.effect, LoadEffect::Drive(_)) {
                energy_scale += contribution.force.abs();
            }
        }
        let energy_scale = Some(energy_scale).filter(|e| e.is_normal()).unwrap_or(1.0);
        Ok(TabulatedMachineOde {
            machine: self,
            workspace,
            dual_workspace: DualWorkspace::new(TableWorkspace::new(self), self.state_count()),
            energy_scale: with_later_works(energy_scale, largest_work),
            held: Vec::new(),
            seen: Vec::new(),
            contact_events: Vec::new(),
            modes: SharedModes::default(),
        })
    }

    /// ẏ at time `t` and state `y`.
    fn rhs<T: Scalar>(
        &self,
        t: f64,
        y: &[T],
        workspace: &mut TableWorkspace<T>,
        out: &mut [T],
    ) -> Result<()> {
        let (q, q_dot) = (y[0], y[1]);
        let [m, half_dm] = self.inertia.eval(q)?;
        let mut force = -(half_dm * q_dot * q_dot);
        if let Some(potential) = &self.potential {
            let [_, half_dv] = potential.eval(q)?;
            force += half_dv * T::from_f64(-2.0);
        }
        self.columns.eval(q, &mut workspace.columns, &mut [])?;
        out[2 + self.drive_state_count..].fill(T::from_f64(0.0));
        for (k, place) in self.work_places.iter().enumerate() {
            let contribution = self.load_contribution(k, t, y, workspace)?;
            force += contribution.generalised_force;
            out[2 + self.drive_state_count + place] += contribution.generalised_force * q_dot;
            if let Some((place, rate)) = contribution.drive_state_rate {
                out[2 + place] = rate;
            }
        }
        positive_inertia(m.value(), q.value())?;
        out[0] = q_dot;
        out[1] = force / m;
        Ok(())
    }

    /// The contribution of a load or drive at a state with known columns.
    fn load_contribution<T: Scalar>(
        &self,
        k: usize,
        t: f64,
        y: &[T],
        workspace: &mut TableWorkspace<T>,
    ) -> Result<LoadContribution<T>> {
        let load = &self.tabulated_loads[k];
        let (q_dot, w, count) = (y[1], workspace.columns[k], load.signals.len());
        let (arguments, values) = (
            &mut workspace.arguments[..count],
            &mut workspace.values[..count],
        );
        for ((argument, value), signal) in arguments.iter_mut().zip(&mut *values).zip(&load.signals)
        {
            *argument = signal.eval(t, y, &workspace.columns);
            *value = argument.value();
        }
        let held = &workspace.held[k];
        let magnitude = load.magnitude.eval(arguments, values, &held.magnitude);
        if !magnitude.value().is_finite() {
            let error = KinetostaticsError::MagnitudeNotFinite { load: load.load };
            return Err(DynamicsError::Load(error));
        }
        let stateless = |force: T| LoadContribution {
            force,
            generalised_force: force * w,
            drive_state_rate: None,
        };
        Ok(match &load.effect {
            LoadEffect::Load(law) => stateless(law.on_response(magnitude, w, q_dot)),
            LoadEffect::Drive(drive) => {
                let state = drive.state.map(|place| y[2 + place]);
                let (drive_force, rate) = drive.eval(magnitude, w * q_dot, state, held.drive);
                LoadContribution {
                    drive_state_rate: drive.state.map(|place| (place, rate)),
                    ..stateless(drive_force)
                }
            }
        })
    }
}

impl TabulatedSignal {
    fn eval<T: Scalar>(self, t: f64, y: &[T], columns: &[T]) -> T {
        match self {
            Self::Time => T::from_f64(t),
            Self::Value(coordinate) => coordinate.eval(y[0], columns),
            Self::Speed(coordinate) => coordinate.eval(y[0], columns) * y[1],
        }
    }
}

impl TabulatedCoordinate {
    fn eval<T: Scalar>(self, q: T, columns: &[T]) -> T {
        let line = T::from_f64(self.slope) * q + T::from_f64(self.offset);
        self.column.map_or(line, |column| line + columns[column])
    }
}

impl OdeSystem for TabulatedMachineOde<'_> {
    fn size(&self) -> usize {
        self.machine.state_count()
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.machine.rhs(t, y, &mut self.workspace, out)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let machine = self.machine;
        // No rate depends on the works.
        let columns = 2 + machine.drive_state_count;
        let rhs =
            |y: &[Dual], workspace: &mut _, out: &mut [Dual]| machine.rhs(t, y, workspace, out);
        self.dual_workspace.jacobian(columns, y, out, rhs)
    }

    fn time_features(&self) -> Option<Arc<Features>> {
        Some(Arc::clone(&self.machine.time_features))
    }

    fn own_function(&self) -> Option<usize> {
        let mut loads = self.machine.tabulated_loads.iter();
        let found = loads.find(|load| matches!(load.magnitude, Magnitude::Function(..)));
        found.map(|load| load.load)
    }

    fn switch_kinds(&self) -> &[SwitchKind] {
        self.machine.state_switches.kinds()
    }

    fn switch_source(&self, switch: usize) -> usize {
        let k = self.machine.state_switches.source_index(switch);
        self.machine.tabulated_loads[k].load
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
        let Self {
            machine, workspace, ..
        } = self;
        let columns = &mut workspace.columns;
        machine.columns.eval(y[0], columns, &mut [])?;
        let source_state = |k: usize, signals: &mut Vec<f64>| {
            let load = &machine.tabulated_loads[k];
            signals.extend(load.signals.iter().map(|signal| signal.eval(t, y, columns)));
            let drive = load.drive();
            SourceState {
                magnitude: &load.magnitude,
                drive: drive.map(|d| (d, columns[k] * y[1], d.state.map(|place| y[2 + place]))),
            }
        };
        let (held, seen) = (&self.held, &mut self.seen);
        machine.state_switches.values(held, seen, source_state, out);
        Ok(())
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        let Self {
            machine,
            dual_workspace,
            ..
        } = self;
        // Along the rates every signal is a dual number, whose derivative is its rate.
        let (along, workspace) = dual_workspace.along(y, rates);
        let columns = &mut workspace.columns;
        machine.columns.eval(along[0], columns, &mut [])?;
        let source_state = |k: usize, signals: &mut Vec<[f64; 2]>| {
            let load = &machine.tabulated_loads[k];
            signals.extend(load.signals.iter().map(|signal| match signal {
                TabulatedSignal::Time => [t, 1.0],
                TabulatedSignal::Value(_) | TabulatedSignal::Speed(_) => {
                    let Dual { v, d } = signal.eval(t, along, columns);
                    [v, d]
                }
            }));
            let (drive, speed) = (load.drive(), columns[k] * along[1]);
            let state = drive
                .and_then(|drive| drive.state)
                .map(|place| along[2 + place]);
            let source = SourceState {
                magnitude: &load.magnitude,
                drive: drive.map(|drive| (drive, speed.v, state.map(|state| state.v))),
            };
            (source, [speed.d, state.map_or(0.0, |state| state.d)])
        };
        machine.state_switches.rates(&self.held, source_state, out);
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
        let (own, dual) = (&mut self.workspace, self.dual_workspace.inner());
        let set = |k: usize, held: &HeldSource| {
            own.held[k].clone_from(held);
            dual.held[k].clone_from(held);
        };
        self.machine
            .state_switches
            .hold(pieces, &mut self.held, set);
    }

    fn error_weight(&self, state: usize) -> f64 {
        if state < 2 + self.machine.drive_state_count {
            1.0
        } else {
            self.energy_scale
        }
    }
}
