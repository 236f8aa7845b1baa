//! A scene as the machine that `cycle`, `equilibria` and `linearise` ask about.

use crate::error::{StudyError, explain_machine};
use crate::motion_error::explain_motion;
use crate::simulate::machine;
use crate::words::digits;
use dwell_dynamics::{DriveKind, DynamicsError, Machine, Worker, all_loads};
use dwell_geometry::{ActuatorId, Reaction};
use dwell_kinetostatics::Signal;
use dwell_report::Column;
use dwell_scene::{Length, Motion, Place, Scene};

/// A scene, its machine and its start.
pub(crate) struct Driven<'a> {
    pub(crate) scene: &'a Scene,
    /// The scene with the loads through which its drives act.
    loaded: Scene,
    motion: Motion,
    pub(crate) machine: Machine,
}

impl<'a> Driven<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Result<Self, StudyError> {
        let loads = all_loads(&scene.mechanism, &scene.loads, &scene.drives);
        let mut loaded = scene.clone();
        loaded.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
        let motion = scene.motion.clone().unwrap_or_else(|| all_free(scene));
        let machine = machine(scene, &motion, &[])?;
        let driven = Self {
            scene,
            loaded,
            motion,
            machine,
        };
        if driven.machine.free().is_empty() {
            let help = "declare the coordinate that moves, as in `[actuators.phi]`";
            let message = "the scene has no free coordinate".to_owned();
            return Err(driven.refused(message, help, &[(Place::Whole, "none".to_owned())]));
        }
        Ok(driven)
    }

    /// The machine that computes some reactions too.
    pub(crate) fn with_reactions(&self, reactions: &[Reaction]) -> Result<Machine, StudyError> {
        machine(self.scene, &self.motion, reactions)
    }

    /// The state in which `[motion]` starts, or else in which the mechanism is put together, at rest.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.machine.start(&self.motion.start, &self.motion.speed)
    }

    pub(crate) fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(&self.loaded, self.machine.model().plan(), error)
    }

    pub(crate) fn refused(
        &self,
        message: String,
        help: &str,
        labels: &[(Place, String)],
    ) -> StudyError {
        let error = self.scene.error(message, Some(help.to_owned()), labels);
        error.into()
    }

    /// Where the scene says how it starts.
    pub(crate) fn began(&self, words: &str) -> (Place, String) {
        (began(self.scene), words.to_owned())
    }

    /// Refuses what changes with time itself.
    pub(crate) fn timeless(&self, wanted: &str) -> Result<(), StudyError> {
        if !self.machine.follows_time() {
            return Ok(());
        }
        let loads = self.loaded.loads.iter().enumerate();
        let loads = loads.filter(|(_, load)| load.magnitude.signals().contains(&Signal::Time));
        let mut labels: Vec<(Place, String)> = loads
            .map(|(k, _)| (Place::Magnitude(k), "changes with time".to_owned()))
            .collect();
        let laws = self.motion.laws.iter().enumerate();
        let led = laws.filter(|(_, law)| law.is_some());
        labels.extend(led.map(|(k, _)| (Place::Led(ActuatorId(k)), "leads it in time".to_owned())));
        Err(self.refused(
            format!("{wanted} cannot be found where something changes with time itself"),
            "leave `t` out of expressions and tables, and give led actuators a constant place; \
             `dwell simulate` follows the motion in time",
            &labels,
        ))
    }

    pub(crate) fn name(&self, actuator: usize) -> &str {
        &self.scene.mechanism.actuators[actuator].name
    }

    pub(crate) fn is_angle(&self, actuator: usize) -> bool {
        self.machine.model().plan().is_angle(actuator)
    }

    /// The first free coordinate: (actuator, whether it is an angle).
    pub(crate) fn only(&self) -> (usize, bool) {
        let actuator = self.machine.free().first().copied().unwrap_or(0);
        (actuator, self.is_angle(actuator))
    }

    /// A coordinate in words.
    pub(crate) fn place(&self, actuator: usize, value: f64) -> String {
        let name = self.name(actuator);
        if self.is_angle(actuator) {
            let degrees = digits(value.to_degrees(), 9);
            format!("{name} = {} rad ({degrees}°)", digits(value, 9))
        } else {
            format!("{name} = {} m", digits(value, 9))
        }
    }

    /// Names and units of the states: coordinates, speeds, the drives' own.
    pub(crate) fn states(&self) -> Vec<Column> {
        let unit = |i: usize| if self.is_angle(i) { "rad" } else { "m" };
        let free = self.machine.free();
        let coordinates = free.iter().map(|&i| Column::new(self.name(i), unit(i)));
        let speed = |&i: &usize| {
            let name = format!("{}.speed", self.name(i));
            Column::new(name, format!("{}/s", unit(i)))
        };
        let mut states: Vec<Column> = coordinates.chain(free.iter().map(speed)).collect();
        for drive in &self.scene.drives {
            match &drive.kind {
                DriveKind::Motor(motor) if motor.inductance > 0.0 => {
                    states.push(Column::new(format!("{}.current", drive.name), "A"));
                }
                DriveKind::Regulator(regulator) if regulator.integral > 0.0 => {
                    let unit = if drive.coordinate.is_angle() {
                        "rad"
                    } else {
                        "m"
                    };
                    states.push(Column::new(format!("{}.integral", drive.name), unit));
                }
                _ => {}
            }
        }
        states
    }

    pub(crate) fn worker(&self, worker: Worker) -> String {
        match worker {
            Worker::Load(load) => self.scene.loads[load].name.clone(),
            Worker::Drive(drive) => self.scene.drives[drive].name.clone(),
            Worker::Prescribed(actuator) => self.name(actuator).to_owned(),
        }
    }
}

/// Where a scene says how it starts to move: without `[motion]`, where it is put together.
pub(crate) fn began(scene: &Scene) -> Place {
    match scene.motion {
        Some(_) => Place::Motion,
        None => Place::Start(ActuatorId(0)),
    }
}

/// What a scene without `[motion]` does: every actuator free, at rest where it is put together.
fn all_free(scene: &Scene) -> Motion {
    let start = scene.assembly.start.clone();
    Motion {
        speed: vec![0.0; start.len()],
        laws: vec![None; start.len()],
        start,
        length: Length::Duration(1.0),
        events: Vec::new(),
    }
}
