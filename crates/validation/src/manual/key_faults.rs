//! The results of the faults that the trials plant in keys: writing and reading of `reports/key-faults.txt`.

use super::lines::numbers;
use dwell_findings::Check;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

/// The committed text, in the folder of reports.
const FILE: &str = "key-faults.txt";
const TITLE: &str = "Faults planted in every key of a scene, and the checks that detect them";
const REFUSED: &str = "every other value is refused";
const UNCHANGED: &str = "no result changes";

/// A key, and the result of a fault in its value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyFault {
    /// The [id](dwell_scene::SceneKey::id) of the key.
    pub key: String,
    /// Its result.
    pub fault: PlantedFault,
}

/// The result of faults in the value of a key.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum PlantedFault {
    /// No result changes, or no scene uses the key.
    #[default]
    Unchanged,
    /// Every other value that was tried is rejected with an error.
    Refused,
    /// The fault that most checks detect.
    Detected {
        /// The name of the scene.
        scene: String,
        /// The change, in a few words.
        what: String,
        /// The checks that detect it.
        by: BTreeSet<Check>,
    },
}

impl PlantedFault {
    /// The checks that detect it.
    pub fn detected_by(&self) -> BTreeSet<Check> {
        match self {
            Self::Detected { by, .. } => by.clone(),
            Self::Unchanged | Self::Refused => BTreeSet::new(),
        }
    }
}

/// The faults in all keys, with the commit and its date.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyFaults {
    /// The commit and its date.
    pub made: String,
    /// The faults, by key with a value.
    pub faults: Vec<KeyFault>,
}

impl KeyFaults {
    /// The committed faults in a folder of reports, if they exist.
    pub fn read(folder: &Path) -> Option<Self> {
        let text = std::fs::read_to_string(folder.join(FILE)).ok()?;
        let mut lines = text.lines();
        let made = lines.find_map(|line| line.strip_prefix("at "))?.to_owned();
        let faults = lines.filter_map(read_line).collect();
        Some(Self { made, faults })
    }

    /// Writes them into a folder of reports. If the file has the same faults, its commit and date are kept.
    ///
    /// # Errors
    /// [`std::io::Error`] if the file cannot be written.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        let is_known = Self::read(folder).is_some_and(|known| known.faults == self.faults);
        if is_known {
            Ok(())
        } else {
            std::fs::write(folder.join(FILE), self.text())
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{TITLE}\nat {}\n\n", self.made);
        for KeyFault { key, fault } in &self.faults {
            let (what, by) = match fault {
                PlantedFault::Unchanged => (UNCHANGED.to_owned(), "-".to_owned()),
                PlantedFault::Refused => (REFUSED.to_owned(), "-".to_owned()),
                PlantedFault::Detected { scene, what, by } => {
                    (format!("{what}, on {scene}"), numbers(by))
                }
            };
            let _ = writeln!(text, "  {key:<44}  {what:<56}  {by}");
        }
        text
    }
}

/// A line of the text: key, change, and numbers of checks, separated by two blanks.
fn read_line(line: &str) -> Option<KeyFault> {
    let parts: Vec<&str> = line
        .strip_prefix("  ")?
        .split("  ")
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .collect();
    let [key, what, by] = parts[..] else {
        return None;
    };
    let number = |number: &str| Check::ALL.get(number.parse::<usize>().ok()?).copied();
    let fault = match what {
        UNCHANGED => PlantedFault::Unchanged,
        REFUSED => PlantedFault::Refused,
        what => {
            let (what, scene) = what.rsplit_once(", on ")?;
            PlantedFault::Detected {
                scene: scene.to_owned(),
                what: what.to_owned(),
                by: by.split(' ').filter_map(number).collect(),
            }
        }
    };
    Some(KeyFault {
        key: key.to_owned(),
        fault,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let detected = PlantedFault::Detected {
            scene: "four-bar".to_owned(),
            what: "read as `a, on b`".to_owned(),
            by: [Check::ConstraintClosure, Check::Power].into(),
        };
        let faults = [detected, PlantedFault::Refused, PlantedFault::Unchanged];
        let named = faults
            .into_iter()
            .zip(["[units] length", "<point>", "gear internal"]);
        for (fault, key) in named {
            let key = key.to_owned();
            let made = String::new();
            let one = KeyFault { key, fault };
            let text = KeyFaults {
                made,
                faults: vec![one.clone()],
            }
            .text();
            assert_eq!(
                text.lines().filter_map(read_line).collect::<Vec<_>>(),
                [one],
                "{text}"
            );
        }
    }
}
