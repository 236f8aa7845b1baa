//! What of a motion goes into its tables.

use super::{Free, Moved};
use crate::run::{Sample, Told};
use dwell_dynamics::{DriveKind, DynamicsError, Machine, MachineWork, Occurrence, Point, Worker};
use dwell_geometry::measure::Measured;
use dwell_report::{Column, Table};

/// Names of the energies' columns.
pub(crate) const KINETIC: &str = "energy.kinetic";
pub(crate) const POTENTIAL: &str = "energy.potential";
pub(crate) const BALANCE: &str = "energy.balance";

impl Free<'_> {
    /// Every sample with its accelerations, the drives' actions and the energies. Within the window of a
    /// bridge there are no reactions to be told, and no row.
    pub(super) fn samples(&self, moved: &Moved) -> Result<Vec<Sample>, DynamicsError> {
        let mut ledger: Option<f64> = None;
        let mut samples = Vec::new();
        for (leg, (chart, trace)) in moved.legs.iter().enumerate() {
            let machine = self.machine(moved, *chart);
            let mut work = machine.work();
            for (k, point) in trace.samples.iter().enumerate() {
                if machine.on_bridge(&point.y) {
                    continue;
                }
                machine.evaluate(point.t, &point.y, &mut work)?;
                let own = moved.own.get(leg).and_then(|leg| leg.get(k)).copied();
                samples.push(self.sample(machine, *chart, own, point, &work, &mut ledger));
            }
        }
        if let [only] = samples.as_slice() {
            // A motion that ends where it starts is still shown.
            samples.push(only.clone());
        }
        Ok(samples)
    }

    fn sample(
        &self,
        machine: &Machine,
        chart: usize,
        own: Option<[f64; 3]>,
        point: &Point,
        work: &MachineWork,
        ledger: &mut Option<f64>,
    ) -> Sample {
        let first = machine.first_work();
        let [kinetic, potential] = machine.energy(work);
        let works = &point.y[first..];
        let sum = kinetic + potential - works.iter().sum::<f64>();
        let began = *ledger.get_or_insert(sum);
        let mut told = vec![kinetic, potential];
        told.extend(works);
        told.push(sum - began);
        told.extend(&point.y[2 * machine.free().len()..first]);
        let count = self.scene.loads.len();
        let drives = count - machine.drives()..count;
        Sample {
            t: point.t,
            q: work.q.clone(),
            q_dot: work.q_dot.clone(),
            q_ddot: work.q_ddot.clone(),
            chart,
            own,
            given: drives
                .map(|load| (load, work.inner.loads().magnitude[load]))
                .collect(),
            told,
        }
    }

    /// The names of what [`Free::sample`] tells.
    pub(super) fn told(&self) -> Vec<Told> {
        let told = |name: String, unit, meaning: &str| Told {
            name,
            unit,
            meaning: meaning.to_owned(),
        };
        let mut all = vec![
            told(KINETIC.into(), "J", "of all bodies and rotors"),
            told(
                POTENTIAL.into(),
                "J",
                "of gravity, springs and constant forces",
            ),
        ];
        for worker in self.machine.workers() {
            let name = self.worker(*worker);
            all.push(told(format!("{name}.work"), "J", "done since the start"));
        }
        let meaning =
            "kinetic + potential − work, less its value at the start: the integration's error";
        all.push(told(BALANCE.into(), "J", meaning));
        for drive in &self.scene.drives {
            match &drive.kind {
                DriveKind::Motor(motor) if motor.inductance > 0.0 => {
                    all.push(told(format!("{}.current", drive.name), "A", ""));
                }
                DriveKind::Regulator(regulator) if regulator.integral > 0.0 => {
                    let unit = if drive.coordinate.is_angle() {
                        "rad"
                    } else {
                        "m"
                    };
                    let meaning = "of the regulator's error";
                    all.push(told(format!("{}.integral", drive.name), unit, meaning));
                }
                _ => {}
            }
        }
        all
    }

    fn worker(&self, worker: Worker) -> String {
        match worker {
            Worker::Load(load) => self.scene.loads[load].name.clone(),
            Worker::Drive(drive) => self.scene.drives[drive].name.clone(),
            Worker::Prescribed(actuator) => self.scene.mechanism.actuators[actuator].name.clone(),
        }
    }

    /// When each event happened, and the coordinates then.
    pub(super) fn event_table(&self, moved: &Moved) -> Table {
        let mut columns = vec![Column::new("t", "s"), Column::new("event", "")];
        let actuators = &self.scene.mechanism.actuators;
        for actuator in actuators {
            let unit = if actuator.coordinate().is_angle() {
                "rad"
            } else {
                "m"
            };
            columns.push(Column::new(actuator.name.clone(), unit));
            columns.push(Column::new(
                format!("{}.speed", actuator.name),
                format!("{unit}/s"),
            ));
        }
        let row = |(chart, o): (usize, &Occurrence)| {
            let machine = self.machine(moved, chart);
            let mut work = machine.work();
            let mut row = vec![o.at.t, (o.event + 1) as f64];
            if machine.evaluate(o.at.t, &o.at.y, &mut work).is_ok() {
                for actuator in actuators {
                    let measured = Measured::find(&self.scene.mechanism, actuator.coordinate());
                    let [q, q_dot, _] = measured.map_or([f64::NAN; 3], |measured| {
                        work.inner.states().measure(measured)
                    });
                    row.extend([q, q_dot]);
                }
            }
            row.resize(2 + 2 * actuators.len(), f64::NAN);
            row
        };
        Table {
            columns,
            rows: moved.occurrences().map(row).collect(),
        }
    }
}
