//! A motion that is started in neighbouring states and with changed inputs of its drives, in the plain text of its scene.

use crate::written::motions::{Drive, DriveKind, MotionReading};
use crate::written::poses::scene_text::{text_of, value_of};
use toml::{Table, Value};

/// How far a coordinate is changed, rad or parts of the size of the mechanism; and its velocity, per s.
const STEP: f64 = 5e-4;
/// How far a force, a voltage or a reference speed is changed, in its own unit: friction makes the answer no linear one.
const INPUT_STEP: f64 = 1e-2;
/// How long the motion is, s: only its first row is used.
pub(super) const DURATION: f64 = 1e-6;

/// What is changed of a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Changed {
    /// By its number among the free coordinates.
    Coordinate(usize),
    Velocity(usize),
    /// The input of a drive.
    Input(usize),
    /// What adds to the force of a drive: its state, or the share of its full voltage.
    Force(usize),
}

/// A free coordinate at the start, in SI units.
#[derive(Debug, Clone)]
pub(super) struct FreeCoordinate {
    pub(super) name: String,
    /// The unit of the scene's text, in SI units.
    pub(super) unit: f64,
    /// Of its changes.
    pub(super) size: f64,
    value: f64,
    velocity: f64,
}

/// The scene of a motion, and where it starts.
#[derive(Debug)]
pub(super) struct Start<'a> {
    pub(super) scene: Table,
    pub(super) motion: &'a MotionReading,
    pub(super) free: Vec<FreeCoordinate>,
}

impl<'a> Start<'a> {
    /// The coordinates at the start, in SI units.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.free.iter().map(|free| free.value)
    }

    pub(super) fn is_angle(&self, name: &str) -> bool {
        let coordinate = self.motion.reading.coordinate(name);
        coordinate.is_some_and(|c| c.measure.is_angle())
    }

    /// How many drives there are, if the force of each at rest is the same at every coordinate.
    pub(super) fn drives_at_rest(&self) -> Option<usize> {
        let drives = &self.motion.drives;
        let is_given = |drive: &Drive| matches!(drive.kind, DriveKind::AppliedForce(_));
        (!drives.iter().any(is_given)).then_some(drives.len())
    }

    /// The start of a scene whose free coordinates have these names and values, then velocities.
    pub(super) fn new(
        mut scene: Table,
        motion: &'a MotionReading,
        names: &[String],
        state: &[f64],
    ) -> Option<Self> {
        let table = scene.get_mut("motion")?.as_table_mut()?;
        table.remove("events");
        table.remove("periods");
        table.insert("duration".to_owned(), Value::Float(DURATION));
        let coordinate = |(k, name): (usize, &String)| {
            let measure = motion.reading.coordinate(name)?.measure;
            let unit = motion.reading.unit_of(measure);
            Some(FreeCoordinate {
                name: name.clone(),
                unit,
                size: if measure.is_angle() {
                    1.0
                } else {
                    motion.reading.size()
                },
                value: *state.get(k)?,
                velocity: *state.get(names.len() + k)?,
            })
        };
        let free = names.iter().enumerate().map(coordinate);
        let free = free.collect::<Option<Vec<_>>>()?;
        Some(Self {
            scene,
            motion,
            free,
        })
    }

    /// The same at rest in another place, by free coordinate in SI units.
    pub(super) fn at_rest_in(&self, values: &[f64]) -> Self {
        let free = self
            .free
            .iter()
            .zip(values)
            .map(|(free, &value)| FreeCoordinate {
                value,
                velocity: 0.0,
                ..free.clone()
            });
        Self {
            scene: self.scene.clone(),
            motion: self.motion,
            free: free.collect(),
        }
    }

    /// Everything that can be changed, with the column of the matrices that it belongs to.
    pub(super) fn changes(&self) -> Vec<(Changed, String)> {
        let coordinates = self.free.iter().enumerate();
        let coordinates = coordinates.map(|(k, c)| (Changed::Coordinate(k), c.name.clone()));
        let velocities = self.free.iter().enumerate();
        let velocities =
            velocities.map(|(k, c)| (Changed::Velocity(k), format!("{}.velocity", c.name)));
        let mut all: Vec<_> = coordinates.chain(velocities).collect();
        for (k, drive) in self.motion.drives.iter().enumerate() {
            let name = &drive.name;
            let (input, state) = match drive.kind {
                DriveKind::AppliedForce(_) => (Changed::Input(k), ["applied_force", ""]),
                DriveKind::Circuit { .. } => (Changed::Input(k), ["voltage", "current"]),
                DriveKind::Line { .. } => (Changed::Force(k), ["voltage", ""]),
                DriveKind::SpeedController { .. } => (Changed::Input(k), ["set_speed", "integral"]),
            };
            all.push((input, format!("{name}.{}", state[0])));
            if !state[1].is_empty() {
                all.push((Changed::Force(k), format!("{name}.{}", state[1])));
            }
        }
        all
    }

    /// How much of something is changed, in SI units.
    pub(super) fn step(&self, changed: Changed) -> f64 {
        match changed {
            Changed::Coordinate(k) => STEP * self.free[k].size,
            Changed::Velocity(k) => STEP * self.free[k].velocity.abs().max(self.free[k].size),
            Changed::Input(_) | Changed::Force(_) => INPUT_STEP,
        }
    }

    pub(super) fn drive(&self, k: usize) -> &Drive {
        &self.motion.drives[k]
    }

    /// The text of the scene with something changed by so much.
    pub(super) fn text(&self, changed: Changed, by: f64) -> Result<String, String> {
        let mut scene = self.scene.clone();
        if let (Changed::Input(k) | Changed::Force(k), true) = (changed, by != 0.0) {
            let change = match changed {
                Changed::Input(_) => self.change_input(&mut scene, k, by),
                _ => self.add_force(&mut scene, k, by),
            };
            change.ok_or_else(|| format!("drive `{}` cannot be changed", self.drive(k).name))?;
        }
        let add = |wanted: Changed| if wanted == changed { by } else { 0.0 };
        self.started(scene, &add)
    }

    /// The text of a changed scene, started here.
    pub(super) fn text_of_scene(&self, scene: Table) -> Result<String, String> {
        self.started(scene, &|_| 0.0)
    }

    fn started(&self, mut scene: Table, add: &dyn Fn(Changed) -> f64) -> Result<String, String> {
        let by_name = |value: &dyn Fn(usize, &FreeCoordinate) -> f64| {
            let free = self.free.iter().enumerate();
            value_of(free.map(|(k, c)| (c.name.as_str(), (value(k, c) / c.unit).into())))
        };
        let coordinates = by_name(&|k, c| c.value + add(Changed::Coordinate(k)));
        let velocities = by_name(&|k, c| c.velocity + add(Changed::Velocity(k)));
        if let Some(Value::Table(motion)) = scene.get_mut("motion") {
            motion.insert("initial-coordinate".to_owned(), coordinates);
            motion.insert("initial-velocity".to_owned(), velocities);
        }
        text_of(&scene)
    }

    /// Adds a number to the input of a drive.
    fn change_input(&self, scene: &mut Table, k: usize, by: f64) -> Option<()> {
        let drive = self.drive(k);
        let drives = scene.get_mut("drives")?.as_table_mut()?;
        let (key, unit) = match drive.kind {
            DriveKind::AppliedForce(_) => ("magnitude", 1.0),
            DriveKind::SpeedController { .. } => {
                ("speed", self.motion.reading.unit_of(drive.measure))
            }
            DriveKind::Circuit { .. } | DriveKind::Line { .. } => ("voltage", 1.0),
        };
        let input = drives.get_mut(&drive.name)?.get_mut(key)?;
        *input = match input {
            Value::String(text) => Value::String(format!("({text}) + {by}")),
            Value::Integer(number) => Value::Float(*number as f64 + by / unit),
            Value::Float(number) => Value::Float(*number + by / unit),
            _ => return None,
        };
        Some(())
    }

    /// Adds what a changed state of a drive exerts, as a force of its own.
    fn add_force(&self, scene: &mut Table, k: usize, by: f64) -> Option<()> {
        let drive = self.drive(k);
        let drives = scene.get_mut("drives")?.as_table_mut()?;
        let of = drives.get(&drive.name)?.as_table()?;
        let kinds = ["motor", "speed-controller"];
        let coordinate = kinds.into_iter().find_map(|kind| of.get(kind))?.clone();
        let force = drive.state_slopes()[0] * by;
        let added = value_of([("applied-force", coordinate), ("magnitude", force.into())]);
        drives.insert("added-force".to_owned(), added);
        Some(())
    }
}
