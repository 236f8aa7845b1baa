//! Scenes that the checks write: the scene of a case, changed in its plain TOML.

use super::units::Units;
use toml::{Table, Value};

/// A coordinate that the scene names.
#[derive(Debug, Clone)]
pub(crate) struct Coordinate {
    pub(crate) name: String,
    pub(crate) is_angle: bool,
    /// The unit of its numbers in the scene, in SI units.
    pub(crate) unit: f64,
}

/// A scene of a case, in the plane or in space.
#[derive(Debug)]
pub(crate) struct Scene {
    /// The table as written.
    pub(crate) table: Table,
    pub(crate) units: Units,
    pub(crate) actuators: Vec<Coordinate>,
    /// The other named coordinates.
    named: Vec<Coordinate>,
}

impl Scene {
    /// Reads the text of a scene; why it cannot, in words.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let table = table_of(text)?;
        let units = Units::read(&table).ok_or("unknown units")?;
        let in_section = |section: &str| -> Vec<Coordinate> {
            let of_entry = |(name, keys): (&String, &Table)| {
                let is_angle = keys.contains_key("angle");
                let unit = if is_angle { units.angle } else { units.length };
                let name = name.clone();
                Coordinate {
                    name,
                    is_angle,
                    unit,
                }
            };
            entries(&table, section).map(of_entry).collect()
        };
        Ok(Self {
            actuators: in_section("actuators"),
            named: in_section("coordinates"),
            units,
            table,
        })
    }

    /// A scene with a changed table.
    pub(crate) fn with_table(&self, table: Table) -> Self {
        Self {
            table,
            units: self.units,
            actuators: self.actuators.clone(),
            named: self.named.clone(),
        }
    }

    pub(crate) fn coordinate(&self, name: &str) -> Option<&Coordinate> {
        let mut all = self.actuators.iter().chain(&self.named);
        all.find(|coordinate| coordinate.name == name)
    }

    /// The bodies that move.
    pub(crate) fn moving_bodies(&self) -> impl Iterator<Item = (&String, &Table)> {
        entries(&self.table, "bodies").filter(|(name, body)| {
            let fixed = body.get("fixed").and_then(Value::as_bool);
            !fixed.unwrap_or(*name == "ground")
        })
    }

    /// Whether it is in space: its points have three numbers.
    pub(crate) fn is_in_space(&self) -> bool {
        let points = entries(&self.table, "bodies").filter_map(|(_, body)| body.get("points"));
        let mut places = points.filter_map(Value::as_table).flatten();
        places.any(|(_, at)| at.as_array().is_some_and(|at| at.len() == 3))
    }

    /// The largest distance of a point from the origin of its body, m.
    pub(crate) fn size(&self) -> f64 {
        let points = entries(&self.table, "bodies").flat_map(|(_, body)| {
            let points = body.get("points").and_then(Value::as_table);
            points.into_iter().flatten().filter_map(|(_, at)| {
                let squares = at.as_array()?.iter().filter_map(|x| number(Some(x)));
                Some(squares.map(|x| x * x).sum::<f64>().sqrt())
            })
        });
        self.units.length * points.fold(0.0, f64::max)
    }

    /// The scene without its requests: everything is written.
    pub(crate) fn everything(&self) -> Table {
        let mut scene = self.table.clone();
        scene.remove("requests");
        scene
    }

    pub(crate) fn has(&self, section: &str) -> bool {
        self.table.contains_key(section)
    }
}

/// A number of a scene.
pub(crate) fn number(value: Option<&Value>) -> Option<f64> {
    let value = value?;
    value
        .as_float()
        .or_else(|| value.as_integer().map(|n| n as f64))
}

/// The tables of a section, by name.
pub(crate) fn entries<'a>(
    scene: &'a Table,
    section: &str,
) -> impl Iterator<Item = (&'a String, &'a Table)> {
    let section = scene.get(section).and_then(Value::as_table);
    let entries = section.into_iter().flatten();
    entries.filter_map(|(name, value)| Some((name, value.as_table()?)))
}

/// The table of a scene's text.
pub(crate) fn table_of(text: &str) -> Result<Table, String> {
    text.parse()
        .map_err(|e| format!("the scene is no TOML: {e}"))
}

/// A value that is a table of some entries.
pub(crate) fn value_of<'a>(entries: impl IntoIterator<Item = (&'a str, Value)>) -> Value {
    let named = entries
        .into_iter()
        .map(|(key, value)| (key.to_owned(), value));
    Value::Table(named.collect())
}

/// Whether a scene has a motion along which forces of inertia are known.
pub(crate) fn has_motion(scene: &Table) -> bool {
    scene.contains_key("prescribed") || scene.contains_key("coordinate-sweep")
}

/// The text of a changed scene.
pub(crate) fn text_of(scene: &Table) -> Result<String, String> {
    toml::to_string(scene).map_err(|e| e.to_string())
}

/// The scene with another number; in an array, by its place.
pub(crate) fn with_number(scene: &Table, path: &[&str], number: f64) -> Option<Table> {
    let mut changed = scene.clone();
    let (first, keys) = path.split_first()?;
    let mut value = changed.get_mut(*first)?;
    for key in keys {
        value = match value {
            Value::Array(values) => values.get_mut(key.parse::<usize>().ok()?)?,
            other => other.get_mut(*key)?,
        };
    }
    *value = Value::Float(number);
    Some(changed)
}
