//! Checks of written files that need the program itself. It runs as a process; its printed text is compared with its files, and these with
//! the files of other runs, for scenes in the plane and in space. `validation/audit` judges the numbers of the files.

mod cycles;
mod motions;
mod operating_points;
pub(crate) mod poses;
mod sweeps;

use dwell_findings::Finding;
use poses::compared::Compared;
use poses::program::Program;
use poses::scene_text::Scene;
use std::path::Path;

/// How the keys of these findings begin: they need the program, which the library has not.
pub(crate) const WRITTEN_PREFIX: &str = "written-";

/// Compares the files of some commands on a scene; why they cannot be compared, in words.
type Compare = fn(&mut Compared, &Program, &Scene) -> Result<(), String>;

/// The ending of the name of the folder, the key of the finding that fails if nothing can be compared, and the comparison.
const COMPARISONS: [(&str, &str, Compare); 5] = [
    ("", "written-sentences", poses::compare),
    ("-motion", "written-motion-again", motions::compare),
    ("-points", "written-linear", operating_points::compare),
    ("-cycle", "written-cycle-period", cycles::compare),
    ("-sweep", "written-sweep", sweeps::compare),
];

/// Runs the program at `path` on a case and judges its files. A run that fails is a failed finding.
pub(crate) fn findings(path: &Path, name: &str, scene: &str) -> Vec<Finding> {
    let all = COMPARISONS.iter().flat_map(|(end, key, compare)| {
        let program = Program::new(path, &format!("{name}{end}"));
        let mut compared = Compared::default();
        let scene = Scene::read(scene);
        if let Err(reason) = scene.and_then(|scene| compare(&mut compared, &program, &scene)) {
            compared.fail(key, reason);
        }
        compared.findings()
    });
    all.collect()
}
