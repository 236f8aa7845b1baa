//! The samples and the events of a motion as tables.

use crate::free_motion::compute::contacts::{ContactOccurrence, first_impulses};
use crate::free_motion::compute::motors::motor_values;
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::number_format::coordinate_unit;
use crate::trajectory::compute::{FreeTrajectory, Trajectory, TrajectorySample, extra_columns};
use dwell_dynamics::{
    ContactEvent, DynamicsError, EventOccurrence, Machine, MachineWorkspace, OdeState, Sliding,
    Solution,
};
use dwell_findings::{Column, Table};
use dwell_geometry::body_states::CoordinateFunction;

impl FreeMotionProblem<'_> {
    /// A computed motion as a trajectory, with its samples, which may have been `evaluated` already, or else with wanted times
    /// (s) as rows.
    pub(crate) fn trajectory(
        &self,
        motion: &SegmentedMotion,
        evaluated: Option<Vec<TrajectorySample>>,
        method_text: &str,
        times: Option<&[f64]>,
    ) -> Result<Trajectory<'static>, DynamicsError> {
        let end = motion.end_time();
        let charts = motion.charts.iter();
        let motion = FreeTrajectory {
            samples: match (times, evaluated) {
                (None, Some(samples)) => samples,
                (None, None) => self.samples(motion)?,
                (Some(times), _) => self.samples_at(motion, times)?,
            },
            extra_columns: extra_columns(self.loaded_scene, &self.machine),
            prescribed: self.spec.laws.iter().map(Option::is_some).collect(),
            charts: charts.map(|c| c.output_model.clone()).collect(),
        };
        let mut trajectory =
            Trajectory::of_free_motion(self.output_model.plan().range().period(), motion, end);
        method_text.clone_into(&mut trajectory.method_text);
        Ok(trajectory)
    }

    /// Every sample with its accelerations, drive magnitudes and energies. Within the window of a change
    /// point's fit there are no reactions, and no row.
    pub(crate) fn samples(
        &self,
        motion: &SegmentedMotion,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let coordinates = &motion.actuator_coordinates.samples;
        let evaluated = self.evaluated(
            motion,
            |solution| &solution.samples,
            &mut |_, _| true,
            coordinates,
        )?;
        let mut samples: Vec<_> = evaluated.into_iter().map(|(_, sample)| sample).collect();
        let mut initial_balance: Option<f64> = None;
        for sample in &mut samples {
            let balance = &mut sample.extra_values[self.balance_index()];
            *balance -= *initial_balance.get_or_insert(*balance);
        }
        if let [only] = samples.as_slice() {
            // A trajectory needs two samples, even if the motion ends at its start.
            samples.push(only.clone());
        }
        Ok(samples)
    }

    /// Those of a motion's picked states that are kept, each with its time, s, evaluated: without those within the window of a
    /// change point's fit. `coordinates` are those of the actuator, by segment.
    pub(super) fn evaluated(
        &self,
        motion: &SegmentedMotion,
        picked: fn(&Solution) -> &[OdeState],
        is_kept: &mut dyn FnMut(&[OdeState], usize) -> bool,
        coordinates: &[Vec<[f64; 3]>],
    ) -> Result<Vec<(f64, TrajectorySample)>, DynamicsError> {
        let mut all = Vec::new();
        for (segment, (chart, solution)) in motion.segments.iter().enumerate() {
            let machine = self.machine(motion, *chart);
            let mut workspace = machine.workspace();
            let points = picked(solution);
            for (k, point) in points.iter().enumerate() {
                if !is_kept(points, k) || machine.is_in_fit_window(&point.y) {
                    continue;
                }
                let sliding = sliding_at(solution, point.t);
                let place = (*chart, machine, &mut workspace);
                let mut sample = self.sample(place, point, sliding)?;
                let coordinates = coordinates.get(segment);
                sample.actuator_coordinate = coordinates.and_then(|s| s.get(k)).copied();
                all.push((point.t, sample));
            }
        }
        Ok(all)
    }

    /// The motion at wanted times (s) up to its end, and at its end.
    fn samples_at(
        &self,
        motion: &SegmentedMotion,
        times: &[f64],
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let end = motion.end_time();
        // Where no wanted time is before the end, the start comes first: a trajectory needs two samples.
        let start = times.first().filter(|&&t| t >= end && end > 0.0);
        let reached = times.iter().copied().filter(|&t| t < end);
        let wanted = start.map(|_| 0.0).into_iter().chain(reached).chain([end]);
        let index = self.balance_index();
        let mut sampler = self.sampler(motion);
        let initial = sampler
            .sample_at(0.0)
            .map_or(0.0, |s| s.extra_values[index]);
        let mut samples = Vec::new();
        for t in wanted {
            let Some(mut sample) = sampler.sample_at(t) else {
                if self.is_in_fit_window(motion, t) {
                    continue;
                }
                return Err(DynamicsError::StepTooSmall { t });
            };
            sample.extra_values[index] -= initial;
            samples.push(sample);
        }
        if let [only] = samples.as_slice() {
            // The end has no row within the window of a change point's fit.
            let start = Some(0.0).filter(|&start| start < only.t);
            match start.and_then(|start| sampler.sample_at(start)) {
                Some(mut start) => {
                    start.extra_values[index] = 0.0;
                    samples.insert(0, start);
                }
                None => samples.push(only.clone()),
            }
        }
        Ok(samples)
    }

    /// A state of a machine with its accelerations, drive magnitudes and energies; without the actuator's coordinate,
    /// and with the balance of energies and works in place of its error.
    pub(crate) fn sample(
        &self,
        (chart, machine, workspace): (usize, &Machine, &mut MachineWorkspace),
        point: &OdeState,
        sliding: Option<&Sliding>,
    ) -> Result<TrajectorySample, DynamicsError> {
        let loads = self.loaded_scene.loads.len();
        let first_work = machine.work_offset();
        let state = machine.evaluate(point.t, &point.y, workspace)?;
        let [kinetic, potential] = state.energy();
        let works = &point.y[first_work..];
        let mut extra_values = vec![kinetic, potential];
        extra_values.extend(works);
        extra_values.push(kinetic + potential - works.iter().sum::<f64>());
        extra_values.extend(&point.y[machine.drive_states()]);
        let motors = (machine, &self.loaded_scene.drives[..]);
        extra_values.extend(motor_values(motors, &state, &point.y));
        let (drives, magnitudes) = (loads - machine.drives()..loads, state.magnitudes());
        let given = drives.chain(machine.contact_loads());
        let mut sample = TrajectorySample {
            t: point.t,
            q: state.q().to_vec(),
            q_dot: state.q_dot().to_vec(),
            q_ddot: state.q_ddot().to_vec(),
            chart,
            actuator_coordinate: None,
            drive_magnitudes: given.map(|load| (load, magnitudes[load])).collect(),
            extra_values,
        };
        if let Some(sliding) = sliding {
            let forces = machine.sliding_forces(sliding, point, workspace)?;
            let drives = loads - machine.drives()..loads;
            let given = drives
                .chain(machine.contact_loads())
                .chain(machine.switching_loads());
            sample.drive_magnitudes = given.map(|load| (load, forces.magnitudes[load])).collect();
            sample.q_ddot = forces.q_ddot;
        }
        Ok(sample)
    }

    /// Where the error of the energy balance is among [`TrajectorySample::extra_values`].
    pub(crate) fn balance_index(&self) -> usize {
        2 + self.machine.nonconservative_sources().len()
    }

    /// The error of the energy balance at a sample, J.
    pub(crate) fn energy_balance(&self, sample: &TrajectorySample) -> f64 {
        sample.extra_values[self.balance_index()]
    }

    /// The time of each event, of the scene and of contacts, and the actuator coordinates and speeds then.
    pub(crate) fn event_table(&self, motion: &SegmentedMotion) -> Table {
        let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
        let mechanism = &self.loaded_scene.mechanism;
        for actuator in &mechanism.actuators {
            let name = &actuator.name;
            let unit = coordinate_unit(actuator.coordinate().is_angle());
            columns.push(Column::new(name, unit));
            columns.push(Column::new(format!("{name}.velocity"), format!("{unit}/s")));
        }
        let impulses = self
            .impact_machine
            .as_ref()
            .map_or(&[][..], |_| &self.loaded_scene.requests.reactions[..]);
        columns.extend(impulses.iter().map(|reaction| {
            let name = mechanism.reaction_name(*reaction);
            let unit = reaction.component.unit();
            Column::new(format!("{name}.impulse"), format!("{unit} s"))
        }));
        let row = |(chart, number, at): (usize, usize, &OdeState), changes: &[f64]| {
            let machine = self.machine(motion, chart);
            let mut workspace = machine.workspace();
            let mut row = vec![at.t, number as f64];
            if let Ok(state) = machine.evaluate(at.t, &at.y, &mut workspace) {
                for actuator in &mechanism.actuators {
                    let measured = CoordinateFunction::find(mechanism, actuator.coordinate());
                    let values = measured.map(|measured| state.coordinate(measured));
                    row.extend(values.unwrap_or([f64::NAN; 2]));
                }
            }
            row.resize(columns.len() - impulses.len(), f64::NAN);
            row.extend(self.reaction_impulses(at, changes));
            row.resize(columns.len(), f64::NAN);
            row
        };
        let event =
            |(chart, o): (usize, &EventOccurrence)| row((chart, o.event + 1, &o.state), &[]);
        let mut rows: Vec<Vec<f64>> = motion.occurrences().map(event).collect();
        let contacts = self.contact_occurrences(motion);
        let contact = |o: &ContactOccurrence| row((o.chart, o.number, &o.state), &o.speed_changes);
        rows.extend(contacts.iter().map(contact));
        rows.sort_by(|one, other| one[0].total_cmp(&other[0]));
        Table { columns, rows }
    }

    /// The impulses of the requested reactions at an impact that changes the free speeds; zero where none is.
    fn reaction_impulses(&self, at: &OdeState, changes: &[f64]) -> Vec<f64> {
        let Some(machine) = &self.impact_machine else {
            return Vec::new();
        };
        let count = self.loaded_scene.requests.reactions.len();
        first_impulses(machine, at, (changes, count))
    }
}

/// The switch along which a motion slides at a time, s.
pub(crate) fn sliding_at(solution: &Solution, t: f64) -> Option<&Sliding> {
    let switches = solution.contact_events.iter().rev();
    let last = switches.filter(|event| event.t() <= t);
    last.filter_map(|event| match event {
        ContactEvent::Switch { sliding, .. } => Some(sliding.as_ref()),
        ContactEvent::Friction { .. } | ContactEvent::Stop { .. } => None,
    })
    .next()?
}
