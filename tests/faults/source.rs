//! Where a place is, in words that stay when lines move.

use super::watched::Place;
use std::collections::HashMap;
use std::path::Path;

/// The lines of the product's files.
pub(crate) struct Source {
    files: HashMap<&'static str, Vec<String>>,
}

impl Source {
    /// Reads the files of some places.
    pub(crate) fn read(home: &Path, places: impl Iterator<Item = Place>) -> Self {
        let mut files: HashMap<&'static str, Vec<String>> = HashMap::new();
        for place in places {
            files.entry(place.file).or_insert_with(|| {
                let text = std::fs::read_to_string(home.join(place.file)).unwrap_or_default();
                text.lines().map(str::to_owned).collect()
            });
        }
        Self { files }
    }

    /// The line itself.
    pub(crate) fn line(&self, place: Place) -> &str {
        let lines = self.files.get(place.file);
        let line = lines.and_then(|lines| lines.get(place.line as usize - 1));
        line.map_or("", |line| line.trim())
    }

    /// The function it is in.
    pub(crate) fn function(&self, place: Place) -> &str {
        let lines = self.files.get(place.file).map_or(&[][..], Vec::as_slice);
        let above = lines.iter().take(place.line as usize).rev();
        let name = |line: &'_ String| -> Option<(usize, usize)> {
            let at = line.find("fn ").filter(|&at| {
                let before = line[..at].trim();
                before
                    .split(' ')
                    .all(|w| w.is_empty() || w.starts_with("pub"))
            })?;
            let rest = &line[at + 3..];
            let end = rest.find(['<', '('])?;
            Some((at + 3, at + 3 + end))
        };
        for line in above {
            if let Some((from, to)) = name(line) {
                return &line[from..to];
            }
        }
        ""
    }

    /// `motion.rs speeds`.
    pub(crate) fn function_of(&self, place: Place) -> String {
        let file = place.file.rsplit('/').next().unwrap_or(place.file);
        format!("{file} {}", self.function(place))
    }
}
