//! Checks of what leaves the program: it runs as a process, and its files are read back and compared with a second reading of
//! the scene.

mod cycles;
pub(crate) mod motions;
mod operating_points;
pub(crate) mod poses;
mod sweeps;

use dwell_findings::Finding;
use poses::compared::Compared;
use poses::program::Program;
use std::path::Path;

/// Compares the files of some commands on a scene; why they cannot be compared, in words.
type Compare = fn(&mut Compared, &Program, &str) -> Result<(), String>;

/// What the name of the folder ends with, the key of the finding that fails where nothing can be compared, and the comparison.
const COMPARISONS: [(&str, &str, Compare); 5] = [
    ("", "written-closure", poses::compare),
    ("-motion", "written-motion-closure", motions::compare),
    ("-points", "written-linear", operating_points::compare),
    ("-cycle", "written-cycle", cycles::compare),
    ("-sweep", "written-sweep-draws", sweeps::compare),
];

/// Runs the program at `path` on a case and judges what it writes. A run that fails is a failed finding.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let all = COMPARISONS.iter().flat_map(|(end, key, compare)| {
        let program = Program::new(path, &format!("{name}{end}"));
        let mut compared = Compared::default();
        if let Err(reason) = compare(&mut compared, &program, scene) {
            compared.fail(key, reason);
        }
        compared.findings()
    });
    all.collect()
}
