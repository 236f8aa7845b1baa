//! The samples and the events of a motion as tables.

use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::{BALANCE, ExtraColumn, KINETIC, POTENTIAL, TrajectorySample};
use dwell_dynamics::{
    DynamicsError, EventOccurrence, Machine, MachineState, NonconservativeSource, OdeState,
};
use dwell_findings::{Column, Table};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::DriveKind;

impl FreeMotionProblem<'_> {
    /// Every sample with its accelerations, drive magnitudes and energies. Within the window of a change
    /// point's fit there are no reactions, and no row.
    pub(crate) fn samples(
        &self,
        motion: &SegmentedMotion,
    ) -> Result<Vec<TrajectorySample>, DynamicsError> {
        let mut initial_balance: Option<f64> = None;
        let mut samples = Vec::new();
        for (segment, (chart, solution)) in motion.segments.iter().enumerate() {
            let machine = self.machine(motion, *chart);
            let mut workspace = machine.workspace();
            for (k, point) in solution.samples.iter().enumerate() {
                if machine.is_in_fit_window(&point.y) {
                    continue;
                }
                let state = machine.evaluate(point.t, &point.y, &mut workspace)?;
                let actuator_coordinate = motion
                    .actuator_coordinates
                    .get(segment)
                    .and_then(|segment| segment.get(k))
                    .copied();
                samples.push(self.sample(
                    machine,
                    *chart,
                    actuator_coordinate,
                    point,
                    &state,
                    &mut initial_balance,
                ));
            }
        }
        if let [only] = samples.as_slice() {
            // A trajectory needs two samples, even if the motion ends at its start.
            samples.push(only.clone());
        }
        Ok(samples)
    }

    fn sample(
        &self,
        machine: &Machine,
        chart: usize,
        actuator_coordinate: Option<[f64; 3]>,
        point: &OdeState,
        state: &MachineState<'_>,
        initial_balance: &mut Option<f64>,
    ) -> TrajectorySample {
        let first = machine.work_offset();
        let [kinetic, potential] = state.energy();
        let works = &point.y[first..];
        let sum = kinetic + potential - works.iter().sum::<f64>();
        let initial = *initial_balance.get_or_insert(sum);
        let mut extra_values = vec![kinetic, potential];
        extra_values.extend(works);
        extra_values.push(sum - initial);
        extra_values.extend(&point.y[2 * machine.free().len()..first]);
        let count = self.loaded_scene.loads.len();
        let drives = count - machine.drives()..count;
        TrajectorySample {
            t: point.t,
            q: state.q().to_vec(),
            q_dot: state.q_dot().to_vec(),
            q_ddot: state.q_ddot().to_vec(),
            chart,
            actuator_coordinate,
            drive_magnitudes: drives
                .map(|load| (load, state.magnitudes()[load]))
                .collect(),
            extra_values,
        }
    }

    /// The columns of [`TrajectorySample::extra_values`].
    pub(crate) fn extra_columns(&self) -> Vec<ExtraColumn> {
        let column = |name: String, unit, meaning: &str| ExtraColumn {
            name,
            unit,
            meaning: meaning.to_owned(),
        };
        let mut all = vec![
            column(
                KINETIC.into(),
                "J",
                "kinetic energy of all bodies and rotors",
            ),
            column(
                POTENTIAL.into(),
                "J",
                "potential energy of gravity, springs and constant forces",
            ),
        ];
        for source in self.machine.nonconservative_sources() {
            let name = self.source_name(*source);
            all.push(column(format!("{name}.work"), "J", "work since t = 0"));
        }
        let meaning =
            "drift of kinetic + potential energy − work since t = 0: error of the integration";
        all.push(column(BALANCE.into(), "J", meaning));
        for drive in &self.loaded_scene.drives {
            match &drive.kind {
                DriveKind::Motor(motor) if motor.inductance > 0.0 => {
                    all.push(column(format!("{}.current", drive.name), "A", ""));
                }
                DriveKind::SpeedController(regulator) if regulator.integral_gain > 0.0 => {
                    let unit = if drive.coordinate.is_angle() {
                        "rad"
                    } else {
                        "m"
                    };
                    let meaning = "integral of the controller error";
                    all.push(column(format!("{}.integral", drive.name), unit, meaning));
                }
                _ => {}
            }
        }
        all
    }

    fn source_name(&self, source: NonconservativeSource) -> String {
        match source {
            NonconservativeSource::Load(load) => self.loaded_scene.loads[load].name.clone(),
            NonconservativeSource::Drive(drive) => self.loaded_scene.drives[drive].name.clone(),
            NonconservativeSource::Prescribed(actuator) => {
                self.loaded_scene.mechanism.actuators[actuator].name.clone()
            }
        }
    }

    /// The time of each event, and the actuator coordinates and speeds then.
    pub(crate) fn event_table(&self, motion: &SegmentedMotion) -> Table {
        let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
        let actuators = &self.loaded_scene.mechanism.actuators;
        for actuator in actuators {
            let unit = if actuator.coordinate().is_angle() {
                "rad"
            } else {
                "m"
            };
            columns.push(Column::new(actuator.name.clone(), unit));
            columns.push(Column::new(
                format!("{}.velocity", actuator.name),
                format!("{unit}/s"),
            ));
        }
        let row = |(chart, o): (usize, &EventOccurrence)| {
            let machine = self.machine(motion, chart);
            let mut workspace = machine.workspace();
            let mut row = vec![o.state.t, (o.event + 1) as f64];
            if let Ok(state) = machine.evaluate(o.state.t, &o.state.y, &mut workspace) {
                for actuator in actuators {
                    let measured = CoordinateFunction::find(
                        &self.loaded_scene.mechanism,
                        actuator.coordinate(),
                    );
                    let [q, q_dot] =
                        measured.map_or([f64::NAN; 2], |measured| state.coordinate(measured));
                    row.extend([q, q_dot]);
                }
            }
            row.resize(2 + 2 * actuators.len(), f64::NAN);
            row
        };
        Table {
            columns,
            rows: motion.occurrences().map(row).collect(),
        }
    }
}
