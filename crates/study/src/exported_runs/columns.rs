//! Which columns of the exported tables are the coordinate, its speed and acceleration, the drive's moment and reactions.

use super::text_table::{ExportedColumn, ExportedTable, by_name};
use dwell_scene::SceneError;
use std::f64::consts::PI;
use toml::{Table, Value};

/// The names of the columns in both tables, as a small TOML file gives them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ColumnNames {
    /// The coordinate; `None` for the only column that also has `.velocity`, `.acceleration` and `.actuator_force`.
    pub coordinate: Option<String>,
    /// Its speed.
    pub speed: Option<String>,
    /// Its acceleration.
    pub acceleration: Option<String>,
    /// The moment or force of the drive.
    pub force: Option<String>,
    /// The unit of the coordinate, its speed and its acceleration where the header does not say it: `rad`, `deg`, `m`, `mm`.
    pub unit: Option<String>,
    /// Reactions by the names that they shall have; none: all columns in N or N m that are reactions.
    pub reactions: Vec<(String, String)>,
}

/// The columns of a run, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Run {
    pub(super) file: String,
    pub(super) name: String,
    pub(super) is_angle: bool,
    pub(super) q: ExportedColumn,
    /// `None` if the file has none; the speed of the paper's runs is then assumed.
    pub(super) speed: Option<ExportedColumn>,
    pub(super) acceleration: Option<ExportedColumn>,
    pub(super) force: ExportedColumn,
    pub(super) reactions: Vec<ExportedColumn>,
}

const KEYS: [&str; 6] = [
    "coordinate",
    "speed",
    "acceleration",
    "force",
    "unit",
    "reactions",
];

impl ColumnNames {
    /// Reads the names from the text of a TOML file.
    ///
    /// # Errors
    /// [`SceneError`]: no TOML, an unknown key, a value that is no text.
    pub fn read(file: &str, text: &str) -> Result<Self, SceneError> {
        let wrong = |message: String| {
            let help = "the keys are coordinate, speed, acceleration, force, unit (texts), and reactions (a table: name = \"column\")";
            SceneError::without_labels(format!("`{file}`: {message}"), Some(help.to_owned()))
        };
        let table: Table = text
            .parse()
            .map_err(|e: toml::de::Error| wrong(e.message().to_owned()))?;
        if let Some(key) = table.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(wrong(format!("unknown key `{key}`")));
        }
        let of = |key: &str| match table.get(key) {
            None => Ok(None),
            Some(Value::String(name)) => Ok(Some(name.clone())),
            Some(_) => Err(wrong(format!("`{key}` is no text"))),
        };
        let reactions = table.get("reactions").and_then(Value::as_table);
        let reactions = reactions.into_iter().flatten().map(|(name, column)| {
            let text = column.as_str();
            let text = text.ok_or_else(|| wrong(format!("`reactions.{name}` is no text")))?;
            Ok((name.clone(), text.to_owned()))
        });
        let reactions = reactions.collect::<Result<_, SceneError>>()?;
        Ok(Self {
            coordinate: of("coordinate")?,
            speed: of("speed")?,
            acceleration: of("acceleration")?,
            force: of("force")?,
            unit: of("unit")?,
            reactions,
        })
    }

    /// The columns of a table.
    ///
    /// # Errors
    /// [`SceneError`] that names the column that is missing, with the ones there are.
    pub(super) fn select(&self, table: &ExportedTable) -> Result<Run, SceneError> {
        let name = match &self.coordinate {
            Some(name) => name.clone(),
            None => recognised(table)?,
        };
        let q = find(table, &name)?;
        let optional = |given: &Option<String>, rest: &str| match given {
            Some(given) => find(table, given).map(Some),
            None => Ok(table.column(&format!("{name}{rest}")).cloned()),
        };
        let given = self.force.clone();
        let force_name = given.unwrap_or_else(|| format!("{name}.actuator_force"));
        let force = find(table, &force_name)?;
        let speed = optional(&self.speed, ".velocity")?;
        let acceleration = optional(&self.acceleration, ".acceleration")?;
        let unit = q.unit.clone().or_else(|| self.unit.clone());
        let (factor, is_angle) = factor_of(table, &name, unit.as_deref())?;
        // A speed has the coordinate's unit, unless its own head says another.
        let scaled = |column: ExportedColumn| {
            let own = column
                .unit
                .as_deref()
                .and_then(|unit| unit.split(['/', ' ']).next());
            let factor = own.and_then(unit_factor).map_or(factor, |(own, _)| own);
            times(column, factor)
        };
        Ok(Run {
            file: table.file.clone(),
            is_angle,
            q: times(q, factor),
            speed: speed.map(scaled),
            acceleration: acceleration.map(scaled),
            force,
            reactions: self.reactions(table, &name)?,
            name,
        })
    }

    fn reactions(
        &self,
        table: &ExportedTable,
        coordinate: &str,
    ) -> Result<Vec<ExportedColumn>, SceneError> {
        if self.reactions.is_empty() {
            let own = |column: &&ExportedColumn| is_reaction(column, coordinate);
            return Ok(table.columns.iter().filter(own).cloned().collect());
        }
        let columns = by_name(&table.columns);
        let of = |(name, column): &(String, String)| {
            let known = columns.get(&column[..]).map(|&column| column.clone());
            Ok(ExportedColumn {
                name: name.clone(),
                ..known.map_or_else(|| find(table, column), Ok)?
            })
        };
        self.reactions.iter().map(of).collect()
    }
}

fn times(column: ExportedColumn, factor: f64) -> ExportedColumn {
    ExportedColumn {
        values: column.values.iter().map(|value| value * factor).collect(),
        rounding: column.rounding * factor,
        ..column
    }
}

/// A column that is a reaction in the files of `dwell runs`: a component of a joint in ground axes.
fn is_reaction(column: &ExportedColumn, coordinate: &str) -> bool {
    let is_force = matches!(column.unit.as_deref(), Some("N" | "N m"));
    let others = [
        ".actuator_force",
        ".load_force",
        ".load_moment",
        ".magnitude",
        ".axial",
        ".shear",
        ".bending",
    ];
    let name = &column.name;
    is_force
        && name != &format!("{coordinate}.actuator_force")
        && !name.contains('@')
        && !name.starts_with("shaking.")
        && name.contains('.')
        && !others.iter().any(|end| name.ends_with(end))
}

/// The coordinate of a file that `dwell` wrote.
fn recognised(table: &ExportedTable) -> Result<String, SceneError> {
    let names = table
        .columns
        .iter()
        .filter_map(|c| c.name.strip_suffix(".actuator_force"));
    let all: Vec<&str> = names.filter(|name| table.column(name).is_some()).collect();
    match all.as_slice() {
        [name] => Ok((*name).to_owned()),
        _ => {
            let message = format!(
                "`{}` does not say which column is the coordinate",
                table.file
            );
            let help = format!(
                "name the columns in a file for --columns: coordinate = \"…\", speed = \"…\", acceleration = \"…\", force = \"…\"; the file has {}",
                names_of(table)
            );
            Err(SceneError::without_labels(message, Some(help)))
        }
    }
}

fn names_of(table: &ExportedTable) -> String {
    const LISTED: usize = 12;
    let names: Vec<String> = table
        .columns
        .iter()
        .take(LISTED)
        .map(|c| format!("`{}`", c.name))
        .collect();
    match table.columns.len() {
        count if count > LISTED => format!("{} and {} more", names.join(", "), count - LISTED),
        _ => names.join(", "),
    }
}

fn find(table: &ExportedTable, name: &str) -> Result<ExportedColumn, SceneError> {
    if let Some(column) = table.column(name) {
        return Ok(column.clone());
    }
    let alike = |column: &&ExportedColumn| column.name.eq_ignore_ascii_case(name);
    let near = table
        .columns
        .iter()
        .find(alike)
        .map(|column| format!("did you mean `{}`? ", column.name));
    let help = format!(
        "{}the file has {}",
        near.unwrap_or_default(),
        names_of(table)
    );
    let message = format!("`{}` has no column `{name}`", table.file);
    Err(SceneError::without_labels(message, Some(help)))
}

/// A unit in SI, and whether it is one of angles.
pub(crate) fn unit_factor(unit: &str) -> Option<(f64, bool)> {
    Some(match unit {
        "rad" => (1.0, true),
        "deg" | "°" | "degree" | "degrees" => (PI / 180.0, true),
        "m" => (1.0, false),
        "mm" => (1e-3, false),
        _ => return None,
    })
}

fn factor_of(
    table: &ExportedTable,
    name: &str,
    unit: Option<&str>,
) -> Result<(f64, bool), SceneError> {
    let known = unit.and_then(unit_factor);
    known.ok_or_else(|| {
        let message = match unit {
            Some(unit) => format!("`{unit}` of column `{name}` in `{}` is no unit of a coordinate", table.file),
            None => format!("`{}` does not say whether `{name}` is in rad or deg", table.file),
        };
        let help = "write the unit into the header, `phi [deg]`, or into the file for --columns: unit = \"deg\" (rad, deg, m or mm)";
        SceneError::without_labels(message, Some(help.to_owned()))
    })
}
