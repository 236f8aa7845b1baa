//! The samples and the events of a motion as tables.

use super::between_rows::MotionSampler;
use super::charts::Motion;
use super::problem::SpaceMotionProblem;
use super::run::Run;
#[cfg(feature = "output")]
use crate::free_motion::compute::first_impulses;
use crate::free_motion::compute::{motor_values, sliding_at};
#[cfg(feature = "output")]
use crate::machines::MachineScene as _;
#[cfg(feature = "output")]
use crate::number_format::coordinate_unit;
use crate::trajectory::compute::{Column, SamplePrecision, TrajectorySample, extra_columns};
use dwell_dynamics::{
    DenseOutput, DynamicsError, MachineOde, MachineWorkspace, OdeState, Options, Sliding,
    StepControl, integrate,
};
#[cfg(feature = "output")]
use dwell_findings::{Column as TableColumn, Table};
use dwell_kinetostatics::space::Model;

impl SpaceMotionProblem<'_> {
    /// Every sample with its accelerations, drive magnitudes and energies.
    pub(super) fn samples(&self, motion: &Motion) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut all = Vec::new();
        for (problem, solution) in motion.parts(self) {
            let mut workspace = problem.machine.workspace();
            let states = solution.samples.iter();
            // Within the window of a change point no reaction has a value.
            let states = states.filter(|state| !problem.machine.is_in_fit_window(&state.y));
            for state in states {
                let sliding = sliding_at(solution, state.t);
                all.push(problem.sample(state, sliding, &mut workspace)?);
            }
        }
        self.count_balance_from_start(&mut all);
        if let [only] = all.as_slice() {
            // A trajectory needs two samples, even if the motion ends at its start.
            all.push(only.clone());
        }
        Ok(all)
    }

    /// The samples of a motion at wanted times (s, ascending) up to its end, and at its end.
    pub(super) fn samples_at(
        &self,
        run: &Run,
        times: &[f64],
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = run.motion.end();
        let [(_, solution)] = &run.motion.parts[..] else {
            return self.samples_within_steps(run, times, end);
        };
        if self.machine.has_contacts() {
            return self.samples_within_steps(run, times, end);
        }
        let wanted: Vec<f64> = times
            .iter()
            .copied()
            .filter(|&t| t < end)
            .chain([end])
            .collect();
        let mut states = Vec::with_capacity(wanted.len());
        let mut state = self.initial_state();
        let options = Options {
            sample_interval: None,
            ..run.options
        };
        for &t in &wanted {
            if let Some((orbit, _)) = &run.orbit {
                states.push(OdeState::from(orbit.state_at(t)));
                continue;
            }
            if t > state.t {
                let mut ode = MachineOde::until(&self.machine, state.t, &state.y, Some(end))?;
                let mut every =
                    |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
                let until = integrate(&mut ode, &state, Some(t), &options, &mut every)?;
                if let Some(error) = until.error {
                    return Err(error);
                }
                state = until.state;
            }
            states.push(state.clone());
        }
        let mut workspace = self.machine.workspace();
        states.retain(|state| !self.machine.is_in_fit_window(&state.y));
        let all = states.iter().map(|state| {
            let sliding = sliding_at(solution, state.t);
            self.sample(state, sliding, &mut workspace)
        });
        let mut all = all.collect::<Result<Vec<_>, _>>()?;
        let initial = self.sample(&self.initial_state(), None, &mut workspace)?;
        let index = self.balance_index();
        for sample in &mut all {
            sample.extra_values[index] -= initial.extra_values[index];
        }
        if let [only] = all.as_slice() {
            all.push(only.clone());
        }
        Ok(all)
    }

    /// The same of a motion with surfaces that come to rest, end stops or several coordinates: from the step before each time.
    fn samples_within_steps(
        &self,
        run: &Run,
        times: &[f64],
        end: f64,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut sampler = MotionSampler::new(self, run);
        let wanted = times.iter().copied().filter(|&t| t < end).chain([end]);
        let sample = |t: f64| match sampler.sample_at(t, SamplePrecision::Exact) {
            None if self.crosses_at(run, t) => None,
            found => Some(found.ok_or(DynamicsError::StepTooSmall { t })),
        };
        let mut all = wanted.filter_map(sample).collect::<Result<Vec<_>, _>>()?;
        let initial = self.sample(&self.initial_state(), None, &mut self.machine.workspace())?;
        let index = self.balance_index();
        for sample in &mut all {
            sample.extra_values[index] -= initial.extra_values[index];
        }
        if let [only] = all.as_slice() {
            all.push(only.clone());
        }
        Ok(all)
    }

    /// A state of the machine with its accelerations, drive magnitudes and energies; with the balance of energies and works in
    /// place of its error.
    pub(super) fn sample(
        &self,
        point: &OdeState,
        sliding: Option<&Sliding>,
        workspace: &mut MachineWorkspace<f64, Model>,
    ) -> Result<TrajectorySample, DynamicsError> {
        let machine = &self.machine;
        let loads = self.scene().loads.len();
        let state = machine.evaluate(point.t, &point.y, workspace)?;
        let [kinetic, potential] = state.energy();
        let works = point.y.get(machine.work_offset()..).unwrap_or_default();
        let mut extra_values = vec![kinetic, potential];
        extra_values.extend(works);
        extra_values.push(kinetic + potential - works.iter().sum::<f64>());
        extra_values.extend(&point.y[machine.drive_states()]);
        let motors = (machine, &self.scene().drives[..]);
        extra_values.extend(motor_values(motors, &state, &point.y));
        let drives = || loads..loads + machine.drives();
        let magnitudes = state.magnitudes();
        let mut sample = TrajectorySample {
            t: point.t,
            q: state.q().to_vec(),
            q_dot: state.q_dot().to_vec(),
            q_ddot: state.q_ddot().to_vec(),
            drive_magnitudes: drives()
                .chain(machine.contact_loads())
                .map(|load| (load, magnitudes[load]))
                .collect(),
            extra_values,
            ..TrajectorySample::default()
        };
        if let Some(sliding) = sliding {
            let forces = machine.sliding_forces(sliding, point, workspace)?;
            let given = machine.switching_loads().into_iter();
            let given = given.filter(|load| *load >= loads);
            let given = drives().chain(machine.contact_loads()).chain(given);
            sample.drive_magnitudes = given.map(|load| (load, forces.magnitudes[load])).collect();
            sample.q_ddot = forces.q_ddot;
        }
        if let Some(chart) = self.chart {
            sample.chart = chart.number;
            let at = [&sample.q[..], &sample.q_dot, &sample.q_ddot];
            sample.actuator_coordinate = self.own_coordinate(chart, at);
        }
        Ok(sample)
    }

    /// Makes the balance of energies and works that since the start.
    fn count_balance_from_start(&self, samples: &mut [TrajectorySample]) {
        let index = self.balance_index();
        let initial = samples.first().map_or(0.0, |s| s.extra_values[index]);
        for sample in samples {
            sample.extra_values[index] -= initial;
        }
    }

    /// Where the error of the energy balance is among the extra values of a sample.
    pub(super) fn balance_index(&self) -> usize {
        2 + self.machine.nonconservative_sources().len()
    }

    /// The columns of the extra values, in their order.
    pub(super) fn extra_columns(&self) -> Vec<Column> {
        extra_columns(self.scene(), &self.machine)
    }

    /// The time of each event, the actuator coordinates and speeds then, and where there are end stops the impulses of the
    /// requested reactions.
    #[cfg(feature = "output")]
    pub(super) fn event_table(&self, motion: &Motion) -> Table {
        let mut columns = vec![TableColumn::new("t", "s"), TableColumn::new("event", "")];
        for (i, actuator) in self.scene().mechanism.actuators.iter().enumerate() {
            let (name, unit) = (&actuator.name, coordinate_unit(self.is_angle(i)));
            columns.push(TableColumn::new(name, unit));
            columns.push(TableColumn::new(
                format!("{name}.velocity"),
                format!("{unit}/s"),
            ));
        }
        let impulses = match &self.impact_machine {
            Some(machine) => self.scene().reaction_columns(machine.model()),
            None => Vec::new(),
        };
        // Behind the requested ones are those that friction needs.
        let impulses = &impulses[..impulses.len().min(self.reactions.requested.len())];
        columns.extend(impulses.iter().map(|reaction| {
            let (name, unit) = (&reaction.name, &reaction.unit);
            TableColumn::new(format!("{name}.impulse"), format!("{unit} s"))
        }));
        let mut events = Vec::new();
        for (chart, solution) in &motion.parts {
            let own = solution.event_occurrences.iter();
            let own = own.map(|o| (o.event + 1, (*chart, o.state.clone()), Vec::new()));
            let contacts = self.contacts().occurrences(*chart, solution).into_iter();
            let contacts = contacts.map(|o| (o.number, (o.chart, o.state), o.speed_changes));
            events.extend(own.chain(contacts));
        }
        events.sort_by(|(_, (_, one), _), (_, (_, other), _)| one.t.total_cmp(&other.t));
        let rows = events.iter().map(|(number, (chart, at), changes)| {
            let mut row = vec![at.t, *number as f64];
            let problem = motion.problem(self, *chart);
            let mut workspace = problem.machine.workspace();
            if let Ok(sample) = problem.sample(at, None, &mut workspace) {
                match sample.actuator_coordinate {
                    Some([q, speed, _]) => row.extend([q, speed]),
                    None => {
                        let both = sample.q.iter().zip(&sample.q_dot);
                        row.extend(both.flat_map(|(q, speed)| [*q, *speed]));
                    }
                }
            }
            row.resize(columns.len() - impulses.len(), f64::NAN);
            if let Some(machine) = &self.impact_machine {
                row.extend(first_impulses(machine, at, (changes, impulses.len())));
            }
            row
        });
        let rows = rows.collect();
        Table { columns, rows }
    }
}
