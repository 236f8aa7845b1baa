//! Where a place is, in words that stay when lines move.

use super::mutating_scalar::SourceOperation;
use std::collections::HashMap;
use std::path::Path;

/// The lines of the product's files.
pub struct SourceFiles {
    files: HashMap<&'static str, Vec<String>>,
}

impl SourceFiles {
    /// Reads the files of some places.
    pub fn read(root: &Path, operations: impl Iterator<Item = SourceOperation>) -> Self {
        let mut files: HashMap<&'static str, Vec<String>> = HashMap::new();
        for operation in operations {
            files.entry(operation.file).or_insert_with(|| {
                let text = std::fs::read_to_string(root.join(operation.file)).unwrap_or_default();
                text.lines().map(str::to_owned).collect()
            });
        }
        Self { files }
    }

    /// The line itself.
    pub fn line(&self, operation: SourceOperation) -> &str {
        let lines = self.files.get(operation.file);
        let line = lines.and_then(|lines| lines.get(operation.line as usize - 1));
        line.map_or("", |line| line.trim())
    }

    /// The function it is in.
    pub fn function(&self, operation: SourceOperation) -> &str {
        let lines = self
            .files
            .get(operation.file)
            .map_or(&[][..], Vec::as_slice);
        let above = lines.iter().take(operation.line as usize).rev();
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
    pub fn function_label(&self, operation: SourceOperation) -> String {
        let file = operation.file.rsplit('/').next().unwrap_or(operation.file);
        format!("{file} {}", self.function(operation))
    }
}
