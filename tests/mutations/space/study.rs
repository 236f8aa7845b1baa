//! The whole study in space: mechanisms, faults, and what became of each.

use super::named::Mutation;
use super::tested::TestedSpace;
use crate::fixtures::repository_root;
use crate::mutations::detection::Detection;
use crate::mutations::operations::{MutatedSubject as _, mutate_operations};
use crate::mutations::source::SourceFiles;
use crate::mutations::study::{MutationGroup, NamedMutation, Study};
use crate::mutations::tested_mechanism::CheckMode;
use dwell_scene::SpaceScene;
use rayon::prelude::*;

/// The cases whose faults are studied: together they have every joint, as a part of the tree and closing a loop.
const CASES: [&str; 7] = [
    "rssr-haug",
    "slider-crank-haug",
    "double-hooke",
    "bennett",
    "bevel-differential",
    "planar-oblique-rcsr",
    "governor",
];

/// Where Newton's method begins decides nothing but the branch of the assembly.
const BRANCH: &str = "another guess of Newton's method may lead to another assembly branch, which moves as a mechanism does: only the branch of the assembly \
                      (check 0) tells it, and where there are any, values of other programs (check 9)";
const EXCEPTIONS: [(&str, &str); 3] = [
    ("space/prediction.rs", BRANCH),
    ("space/follow.rs", BRANCH),
    ("space/stations.rs", BRANCH),
];

/// A scene of a case, or of the study itself.
pub fn scene(name: &str) -> SpaceScene {
    let file = format!("{name}.toml");
    let own = repository_root()
        .join("tests/mutations/scenes-in-space")
        .join(&file);
    let case = repository_root().join("validation/spatial").join(&file);
    let path = if own.exists() { own } else { case };
    SpaceScene::read(&path).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

/// The scenes of the cases, then those of the study itself, by name.
pub fn scenes() -> Vec<SpaceScene> {
    let folder = repository_root().join("tests/mutations/scenes-in-space");
    let entries = std::fs::read_dir(folder).expect("the folder");
    let stem =
        |path: std::path::PathBuf| path.file_stem().map(|s| s.to_string_lossy().into_owned());
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut own: Vec<String> = paths.filter_map(stem).collect();
    own.sort();
    let names = CASES.into_iter().map(str::to_owned).chain(own);
    names.map(|name| scene(&name)).collect()
}

/// All faults on some mechanisms.
pub fn run(scenes: &[SpaceScene]) -> Study {
    let tested = all_tested(scenes);
    let mut study = operations(&tested);
    let source = SourceFiles::read(
        &repository_root(),
        study
            .operation_results
            .iter()
            .map(|result| result.operation),
    );
    let group = |title, mutations: &[Mutation]| MutationGroup {
        title,
        rows: mutations
            .iter()
            .map(|m| row(*m, &tested, &source))
            .collect(),
    };
    study.groups = vec![
        group("Terms, in space", &Mutation::TERMS),
        group(
            "In the description of a mechanism in space",
            &Mutation::DESCRIPTIONS,
        ),
        group("In the results of states in space", &Mutation::RESULTS),
    ];
    study
}

/// The faults of single operations on some mechanisms.
pub fn run_operations(scenes: &[SpaceScene]) -> Study {
    operations(&all_tested(scenes))
}

/// The mechanisms, the quickest to check first.
fn all_tested(scenes: &[SpaceScene]) -> Vec<TestedSpace<'_>> {
    let mut tested: Vec<TestedSpace<'_>> = scenes.par_iter().map(TestedSpace::new).collect();
    tested.sort_by_key(TestedSpace::size);
    tested
}

fn operations(tested: &[TestedSpace<'_>]) -> Study {
    let unmutated = tested.iter().map(|one| one.check(None));
    let unmutated = unmutated.fold(Detection::default(), |sum, one| sum.merge(&one));
    Study {
        name: "mutations-space",
        title: "Deliberate faults in space and the independent checks that detect them",
        without_mutation: unmutated,
        groups: Vec::new(),
        operation_results: mutate_operations(tested),
        ignored: tested
            .iter()
            .filter(|one| !one.ignored_findings.is_empty())
            .map(|one| {
                (
                    one.name().to_owned(),
                    CheckMode::States,
                    one.ignored_findings.clone(),
                )
            })
            .collect(),
        mechanisms: tested.len(),
        exceptions: &EXCEPTIONS,
    }
}

/// A fault on every mechanism where it is one; the row is that of the mechanism where the fewest checks detect it.
fn row(mutation: Mutation, tested: &[TestedSpace<'_>], source: &SourceFiles) -> NamedMutation {
    let all: Vec<(&str, Detection)> = tested
        .par_iter()
        .filter_map(|one| Some((one.name(), mutation.check(one, source)?)))
        .collect();
    let least = all
        .iter()
        .min_by_key(|(_, detection)| detection.check_count());
    let (on, detection) = least.copied().unwrap_or_default();
    NamedMutation {
        description: mutation.description(),
        mechanisms: all.len(),
        mechanism: on.to_owned(),
        detection,
    }
}
