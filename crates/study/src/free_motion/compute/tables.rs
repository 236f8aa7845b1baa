//! The samples and the events of a motion as tables.

use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem, SegmentedMotion};
use crate::models::{drive_states, source_name};
use crate::number_format::coordinate_unit;
use crate::trajectory::compute::{
    self, BALANCE, FreeTrajectory, KINETIC, POTENTIAL, Quantity, Trajectory, TrajectorySample,
};
use dwell_dynamics::{DynamicsError, EventOccurrence};
use dwell_findings::{Column, Table};
use dwell_geometry::body_states::CoordinateFunction;

impl FreeMotionProblem<'_> {
    /// A computed motion as a trajectory.
    pub(crate) fn trajectory(
        &self,
        computed: &ComputedMotion,
    ) -> Result<Trajectory<'static>, DynamicsError> {
        let charts = computed.motion.charts.iter();
        let motion = FreeTrajectory {
            samples: self.samples(&computed.motion)?,
            extra_columns: self.extra_columns(),
            prescribed: self.spec.laws.iter().map(Option::is_some).collect(),
            charts: charts.map(|c| c.output_model.clone()).collect(),
        };
        let mut trajectory = Trajectory::of_free_motion(self.output_model.plan(), motion);
        trajectory.method_text.clone_from(&computed.method_text);
        Ok(trajectory)
    }

    /// Every sample with its accelerations, drive magnitudes and energies. Within the window of a change
    /// point's fit there are no reactions, and no row.
    pub(crate) fn samples(
        &self,
        motion: &SegmentedMotion,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut initial_balance: Option<f64> = None;
        let loads = self.loaded_scene.loads.len();
        let mut samples = Vec::new();
        for (segment, (chart, solution)) in motion.segments.iter().enumerate() {
            let machine = self.machine(motion, *chart);
            let first_work = machine.work_offset();
            let mut workspace = machine.workspace();
            for (k, point) in solution.samples.iter().enumerate() {
                if machine.is_in_fit_window(&point.y) {
                    continue;
                }
                let state = machine.evaluate(point.t, &point.y, &mut workspace)?;
                let [kinetic, potential] = state.energy();
                let works = &point.y[first_work..];
                let sum = kinetic + potential - works.iter().sum::<f64>();
                let initial = *initial_balance.get_or_insert(sum);
                let mut extra_values = vec![kinetic, potential];
                extra_values.extend(works);
                extra_values.push(sum - initial);
                extra_values.extend(&point.y[2 * machine.free().len()..first_work]);
                let (drives, magnitudes) = (loads - machine.drives()..loads, state.magnitudes());
                let actuator_coordinates = motion.actuator_coordinates.get(segment);
                samples.push(TrajectorySample {
                    t: point.t,
                    q: state.q().to_vec(),
                    q_dot: state.q_dot().to_vec(),
                    q_ddot: state.q_ddot().to_vec(),
                    chart: *chart,
                    actuator_coordinate: actuator_coordinates.and_then(|s| s.get(k)).copied(),
                    drive_magnitudes: drives.map(|load| (load, magnitudes[load])).collect(),
                    extra_values,
                });
            }
        }
        if let [only] = samples.as_slice() {
            // A trajectory needs two samples, even if the motion ends at its start.
            samples.push(only.clone());
        }
        Ok(samples)
    }

    /// The error of the energy balance at a sample, J.
    pub(crate) fn energy_balance(&self, sample: &TrajectorySample) -> f64 {
        sample.extra_values[2 + self.machine.nonconservative_sources().len()]
    }

    /// The columns of [`TrajectorySample::extra_values`].
    fn extra_columns(&self) -> Vec<compute::Column> {
        let kinetic = "kinetic energy of all bodies and rotors";
        let potential = "potential energy of gravity, springs and constant forces";
        let balance =
            "drift of kinetic + potential energy − work since t = 0: error of the integration";
        let mut all = vec![
            (KINETIC.to_owned(), "J", kinetic),
            (POTENTIAL.to_owned(), "J", potential),
        ];
        let sources = self.machine.nonconservative_sources().iter();
        all.extend(sources.map(|&source| {
            let name = source_name(self.loaded_scene, source);
            (format!("{name}.work"), "J", "work since t = 0")
        }));
        all.push((BALANCE.to_owned(), "J", balance));
        all.extend(drive_states(self.loaded_scene));
        let column = |(k, (name, unit, meaning)): (usize, (String, _, &str))| compute::Column {
            name,
            former: None,
            unit,
            quantity: Quantity::Extra(k),
            meaning: meaning.to_owned(),
        };
        all.into_iter().enumerate().map(column).collect()
    }

    /// The time of each event, and the actuator coordinates and speeds then.
    pub(crate) fn event_table(&self, motion: &SegmentedMotion) -> Table {
        let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
        let mechanism = &self.loaded_scene.mechanism;
        for actuator in &mechanism.actuators {
            let name = &actuator.name;
            let unit = coordinate_unit(actuator.coordinate().is_angle());
            columns.push(Column::new(name, unit));
            columns.push(Column::new(format!("{name}.velocity"), format!("{unit}/s")));
        }
        let row = |(chart, o): (usize, &EventOccurrence)| {
            let machine = self.machine(motion, chart);
            let mut workspace = machine.workspace();
            let mut row = vec![o.state.t, (o.event + 1) as f64];
            if let Ok(state) = machine.evaluate(o.state.t, &o.state.y, &mut workspace) {
                for actuator in &mechanism.actuators {
                    let measured = CoordinateFunction::find(mechanism, actuator.coordinate());
                    let values = measured.map(|measured| state.coordinate(measured));
                    row.extend(values.unwrap_or([f64::NAN; 2]));
                }
            }
            row.resize(columns.len(), f64::NAN);
            row
        };
        let rows = motion.occurrences().map(row).collect();
        Table { columns, rows }
    }
}
