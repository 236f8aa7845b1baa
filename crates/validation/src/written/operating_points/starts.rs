//! A motion that is started in neighbouring states and with changed inputs of its drives, in the plain text of its scene.

use crate::written::poses::scene_text::{Scene, entries, number, text_of, value_of};
use toml::{Table, Value};

/// How far a coordinate is changed, rad or parts of the size of the mechanism; and its velocity, per s.
const STEP: f64 = 5e-4;
/// How far a force, a voltage or a reference speed is changed, in its own unit: friction makes the answer no linear one.
const INPUT_STEP: f64 = 1e-2;
/// How long the motion is, s: only its first row is used.
pub(super) const DURATION: f64 = 1e-6;

/// The changed quantity of a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Changed {
    /// By its number among the free coordinates.
    Coordinate(usize),
    Velocity(usize),
    /// The input of a drive.
    Input(usize),
    /// A contribution to the force of a drive: its state, or the share of its full voltage.
    Force(usize),
}

/// A free coordinate at the start, in SI units.
#[derive(Debug, Clone)]
pub(super) struct FreeCoordinate {
    pub(super) name: String,
    /// The unit of the scene's text, in SI units.
    pub(super) unit: f64,
    pub(super) is_angle: bool,
    /// Size of its changes.
    pub(super) size: f64,
    value: f64,
    velocity: f64,
}

/// A drive by the text of its scene.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub(super) name: String,
    pub(super) coordinate: String,
    /// The key of its input, with the unit in SI units, and the ends of the columns of its input and state; none of a voltage share.
    input: Option<(&'static str, f64)>,
    columns: [&'static str; 2],
    /// The slopes of the force, and of the state's own rate, with respect to its state or to the share of the full voltage.
    pub(super) state_slopes: [f64; 2],
    /// The rotor's inertia on the coordinate, kg m² or kg.
    pub(super) rotor_inertia: f64,
}

impl Drive {
    fn read(name: &str, keys: &Table, scene: &Scene) -> Option<Self> {
        let kinds = ["applied-force", "motor", "speed-controller"];
        let kind = kinds.into_iter().find(|kind| keys.contains_key(*kind))?;
        let coordinate = keys.get(kind)?.as_str()?;
        let of = |key: &str| number(keys.get(key));
        let gear_ratio = of("gear-ratio").unwrap_or(1.0);
        let [resistance, inductance] =
            ["resistance", "inductance"].map(|key| of(key).unwrap_or(0.0));
        let (input, columns, state_slopes) = match kind {
            "applied-force" => (Some(("magnitude", 1.0)), ["applied_force", ""], [0.0; 2]),
            "speed-controller" => {
                let unit = scene.coordinate(coordinate)?.unit;
                let slopes = [of("integral").unwrap_or(0.0), 0.0];
                (Some(("speed", unit)), ["set_speed", "integral"], slopes)
            }
            _ => match of("stall-torque") {
                Some(torque) => (None, ["", "voltage"], [gear_ratio * torque, 0.0]),
                None => {
                    let slopes = [
                        gear_ratio * of("torque-constant")?,
                        -resistance / inductance,
                    ];
                    (Some(("voltage", 1.0)), ["voltage", "current"], slopes)
                }
            },
        };
        Some(Self {
            name: name.to_owned(),
            coordinate: coordinate.to_owned(),
            input,
            columns,
            state_slopes,
            rotor_inertia: gear_ratio.powi(2) * of("inertia").unwrap_or(0.0) * scene.units.inertia,
        })
    }
}

/// The scene of a motion, and its start.
#[derive(Debug, Clone)]
pub(super) struct Start {
    pub(super) scene: Table,
    pub(super) drives: Vec<Drive>,
    pub(super) free: Vec<FreeCoordinate>,
}

impl Start {
    /// The coordinates at the start, in SI units.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.free.iter().map(|free| free.value)
    }

    /// How many drives there are, if the force of each at rest is the same at every coordinate.
    pub(super) fn drives_at_rest(&self) -> Option<usize> {
        let is_given = |drive: &Drive| drive.columns[0] == "applied_force";
        (!self.drives.iter().any(is_given)).then_some(self.drives.len())
    }

    /// The start of a scene whose free coordinates have these names and values, then velocities.
    pub(super) fn new(of: &Scene, names: &[String], state: &[f64]) -> Option<Self> {
        let mut scene = of.everything();
        let drives = entries(&scene, "drives").map(|(name, keys)| Drive::read(name, keys, of));
        let drives = drives.collect::<Option<_>>()?;
        let table = scene.get_mut("motion")?.as_table_mut()?;
        table.remove("events");
        table.remove("periods");
        table.insert("duration".to_owned(), Value::Float(DURATION));
        let coordinate = |(k, name): (usize, &String)| {
            let coordinate = of.coordinate(name)?;
            Some(FreeCoordinate {
                name: name.clone(),
                unit: coordinate.unit,
                is_angle: coordinate.is_angle,
                size: if coordinate.is_angle { 1.0 } else { of.size() },
                value: *state.get(k)?,
                velocity: *state.get(names.len() + k)?,
            })
        };
        let free = names.iter().enumerate().map(coordinate);
        let free = free.collect::<Option<Vec<_>>>()?;
        Some(Self {
            scene,
            drives,
            free,
        })
    }

    /// The start at rest at other free coordinates, in SI units.
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
            free: free.collect(),
            ..self.clone()
        }
    }

    /// All changeable quantities, each with its column of the matrices.
    pub(super) fn changes(&self) -> Vec<(Changed, String)> {
        let coordinates = self.free.iter().enumerate();
        let coordinates = coordinates.map(|(k, c)| (Changed::Coordinate(k), c.name.clone()));
        let velocities = self.free.iter().enumerate();
        let velocities =
            velocities.map(|(k, c)| (Changed::Velocity(k), format!("{}.velocity", c.name)));
        let mut all: Vec<_> = coordinates.chain(velocities).collect();
        for (k, drive) in self.drives.iter().enumerate() {
            let changed = [Changed::Input(k), Changed::Force(k)];
            let columns = drive.columns.into_iter().zip(changed);
            let columns = columns.filter(|(column, _)| !column.is_empty());
            all.extend(
                columns.map(|(column, changed)| (changed, format!("{}.{column}", drive.name))),
            );
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

    /// The text of the scene with something changed by so much.
    pub(super) fn text(&self, changed: Changed, by: f64) -> Result<String, String> {
        let mut scene = self.scene.clone();
        if let (Changed::Input(k) | Changed::Force(k), true) = (changed, by != 0.0) {
            let change = match changed {
                Changed::Input(_) => self.change_input(&mut scene, k, by),
                _ => self.add_force(&mut scene, k, by),
            };
            change.ok_or_else(|| format!("drive `{}` cannot be changed", self.drives[k].name))?;
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
        let drive = &self.drives[k];
        let drives = scene.get_mut("drives")?.as_table_mut()?;
        let (key, unit) = drive.input?;
        let input = drives.get_mut(&drive.name)?.get_mut(key)?;
        *input = match input {
            Value::String(text) => Value::String(format!("({text}) + {by}")),
            Value::Integer(number) => Value::Float(*number as f64 + by / unit),
            Value::Float(number) => Value::Float(*number + by / unit),
            _ => return None,
        };
        Some(())
    }

    /// Adds the force of a changed state of a drive as a separate force.
    fn add_force(&self, scene: &mut Table, k: usize, by: f64) -> Option<()> {
        let drive = &self.drives[k];
        let drives = scene.get_mut("drives")?.as_table_mut()?;
        let coordinate = drive.coordinate.as_str().into();
        let force = drive.state_slopes[0] * by;
        let added = value_of([("applied-force", coordinate), ("magnitude", force.into())]);
        drives.insert("added-force".to_owned(), added);
        Some(())
    }
}
