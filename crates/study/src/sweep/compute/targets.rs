//! Tables of values that quantities should have, from the files that a scene names in `[sweep.targets]`.

use crate::explain::StudyError;
use crate::exported_runs::{ExportedTable, unit_factor};
use crate::sweep::compute::signals::NamedSignal;
use crate::trajectory::compute::{Distance, Quantity, Signal};
use dwell_scene::{SceneFile, SceneLocation, choices};
use std::path::Path;
use std::sync::Arc;

/// Names of distances by the unit of their columns.
const DISTANCES: [(&str, &str); 2] = [("m", "distance"), ("rad", "angle")];
const OTHER_DISTANCE: &str = "difference";

/// A column of a table in SI.
type Values = (String, Arc<[f64]>);

/// A table of values that quantities should have.
#[derive(Debug)]
pub(crate) struct Target {
    name: String,
    /// The column at whose values the others should have theirs.
    at: Option<Values>,
    columns: Vec<Values>,
}

impl Target {
    /// The targets of a scene, from their files.
    ///
    /// # Errors
    /// [`StudyError`] where a file cannot be read, or has no such column.
    pub(super) fn all(scene: &SceneFile) -> Result<Vec<Self>, StudyError> {
        let targets = 0..scene.sweep_section.targets.len();
        targets.map(|k| Self::read(scene, k)).collect()
    }

    fn read(scene: &SceneFile, k: usize) -> Result<Self, StudyError> {
        let given = &scene.sweep_section.targets[k];
        let folder = Path::new(scene.source.name()).parent();
        let path = folder.unwrap_or(Path::new("")).join(&given.table);
        let text = std::fs::read_to_string(&path).map_err(|e| {
            let message = format!("the table `{}` cannot be read: {e}", path.display());
            fault(scene, k, message, String::new())
        })?;
        let table = ExportedTable::read(&path.display().to_string(), &text)?;
        let columns = table.columns.iter().map(|column| {
            let unit = column.unit.as_deref();
            let (factor, _) = unit.and_then(unit_factor).unwrap_or((1.0, false));
            let values = column.values.iter().map(|value| factor * value);
            (column.name.clone(), values.collect())
        });
        let mut columns: Vec<Values> = columns.collect();
        let at = given.at.as_ref().map(|name| {
            let found = columns.iter().position(|column| column.0 == *name);
            found.map(|k| columns.remove(k)).ok_or_else(|| {
                let names = columns.iter().map(|column| column.0.as_str());
                let help = choices(name, "columns of the table", names);
                let message = format!("the table `{}` has no column `{name}`", given.table);
                fault(scene, k, message, help)
            })
        });
        Ok(Self {
            name: given.name.clone(),
            at: at.transpose()?,
            columns,
        })
    }

    /// The first column that is none of these signals: an error.
    pub(super) fn check(
        &self,
        scene: &SceneFile,
        k: usize,
        signals: &[NamedSignal],
    ) -> Result<(), StudyError> {
        let mut columns = self.at.iter().chain(&self.columns);
        let Some((name, _)) = columns.find(|(name, _)| find(signals, name).is_none()) else {
            return Ok(());
        };
        let message = format!("the column `{name}` of the table is none of the analysis");
        let names = signals.iter().map(|of| of.name.as_str());
        Err(fault(scene, k, message, choices(name, "columns", names)))
    }

    /// Its distances, one for each unit; none if a variant lacks a column.
    pub(super) fn distances(&self, signals: &[NamedSignal]) -> Vec<NamedSignal> {
        let signal = |of: &Values| Some((find(signals, &of.0)?.0, Arc::clone(&of.1)));
        let at = match self.at.as_ref().map(signal) {
            Some(None) => return Vec::new(),
            at => at.flatten(),
        };
        let mut all: Vec<(&'static str, Distance)> = Vec::new();
        for column in &self.columns {
            let Some((found, unit)) = find(signals, &column.0) else {
                return Vec::new();
            };
            let part = (found, Arc::clone(&column.1));
            match all.iter_mut().find(|(other, _)| *other == unit) {
                Some((_, distance)) => distance.of.push(part),
                None => all.push((
                    unit,
                    Distance {
                        at: at.clone(),
                        of: vec![part],
                        are_angles: unit == "rad",
                    },
                )),
            }
        }
        let named = all.into_iter().map(|(unit, distance)| {
            let kind = DISTANCES.iter().find(|(of, _)| *of == unit);
            let kind = kind.map_or(OTHER_DISTANCE, |(_, kind)| kind);
            NamedSignal {
                name: format!("{}.{kind}", self.name),
                unit,
                signal: Signal::Distance(Box::new(distance)),
            }
        });
        named.collect()
    }
}

/// The signal of a column, with its unit.
fn find(signals: &[NamedSignal], name: &str) -> Option<(Signal, &'static str)> {
    if name == "t" {
        return Some((Signal::of(Quantity::Time), "s"));
    }
    let found = signals.iter().find(|of| of.name == name)?;
    Some((found.signal.clone(), found.unit))
}

fn fault(scene: &SceneFile, k: usize, message: String, help: String) -> StudyError {
    let place = (SceneLocation::Target(k), "this target".to_owned());
    let help = Some(help).filter(|help| !help.is_empty());
    scene.error(message, help, &[place]).into()
}
