//! The whole study: machines, faults, and what became of each.

use super::detection::{Detection, REQUIRED_CHECKS};
use super::operations::{self, MutationOutcome, MutationResult};
use super::tested_mechanism::{CheckMode, TestedMechanism};
use super::{claimed_states, motions, published, reduced_model};
use crate::fixtures::repository_root;
use dwell_scene::PlaneScene;
use rayon::prelude::*;
use std::path::PathBuf;

/// A named fault, on the mechanism that shows it least, and what the checks detect there.
#[derive(Debug, Clone)]
pub struct NamedMutation {
    pub description: &'static str,
    /// Machines on which it is a fault.
    pub mechanisms: usize,
    pub mechanism: String,
    pub detection: Detection,
}

/// Named faults of one kind.
pub struct MutationGroup {
    pub title: &'static str,
    pub rows: Vec<NamedMutation>,
}

/// A check that cannot be applied to a mechanism.
pub type IgnoredFindings = (String, CheckMode, Vec<String>);

/// The study.
pub struct Study {
    /// Its files, and its title.
    pub name: &'static str,
    pub title: &'static str,
    /// Without a fault: the union over all machines.
    pub without_mutation: Detection,
    pub groups: Vec<MutationGroup>,
    pub operation_results: Vec<MutationResult>,
    pub mechanisms: usize,
    pub ignored: Vec<IgnoredFindings>,
    /// Files in which a fault needs to be detected by one check only, and why.
    pub exceptions: &'static [(&'static str, &'static str)],
}

/// The scenes of the cases, then those of the study itself, by name.
fn scenes() -> Vec<PlaneScene> {
    let names = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        paths.sort();
        paths
    };
    let cases = names(repository_root().join("validation"))
        .into_iter()
        .map(|p| p.join("scene.toml"))
        .filter(|p| p.is_file());
    let paths: Vec<PathBuf> = cases
        .chain(names(repository_root().join("tests/mutations/scenes")))
        .collect();
    let read = |path: &PathBuf| {
        PlaneScene::read(path).unwrap_or_else(|e| panic!("{}: {e:?}", path.display()))
    };
    paths.iter().map(read).collect()
}

/// A scene of a case, or of the study itself.
pub fn scene(name: &str) -> PlaneScene {
    let all = ["validation", "tests/mutations/scenes"];
    let [case, extra] = all.map(|folder| repository_root().join(folder).join(name));
    let extra = extra.with_extension("toml");
    let path = if extra.exists() {
        extra
    } else {
        case.join("scene.toml")
    };
    PlaneScene::read(path).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

/// The mechanisms, the quickest to check first.
pub fn tested_mechanisms(scenes: Vec<PlaneScene>) -> Vec<TestedMechanism> {
    let all = scenes.into_par_iter().flat_map_iter(|scene| {
        let single = scene.mechanism.actuators.len() == 1;
        let reduced = single.then(|| TestedMechanism::new(scene.clone(), CheckMode::Reduced));
        let states = !single || !scene.loads.is_empty();
        let states = states.then(|| TestedMechanism::new(scene, CheckMode::States));
        reduced.into_iter().chain(states)
    });
    let mut all: Vec<TestedMechanism> = all.collect();
    all.sort_by_key(|machine| (machine.mode == CheckMode::Reduced, machine.size()));
    all
}

/// The machines of the named faults of the reduced model, that with two branches first.
pub fn tested_models() -> Vec<reduced_model::TestedModel> {
    let single_dwell = scene("single-dwell");
    // The dyad of coupler and rocker the other way round, and what hangs on it.
    let mut other_branch = single_dwell.clone();
    other_branch
        .assembly
        .initial_guess
        .iter_mut()
        .flatten()
        .for_each(|guess| *guess = -*guess);
    let samples = published::samples(
        &repository_root().join("validation/single-dwell"),
        &single_dwell,
    );
    let plain = [
        "crank-rocker",
        "slotted-rocker",
        "cross-slide",
        "turning-rail",
    ];
    let plain = plain.map(|name| reduced_model::TestedModel::new(scene(name), None, Vec::new()));
    let mut models = vec![reduced_model::TestedModel::new(
        single_dwell,
        Some(&other_branch),
        samples,
    )];
    models.extend(plain);
    models
}

impl Default for Study {
    fn default() -> Self {
        Self::new()
    }
}

impl Study {
    /// All faults on all machines.
    pub fn new() -> Self {
        Self::run(scenes(), &tested_models())
    }

    /// All faults on some machines.
    // Long: the three groups of mutations.
    pub fn run(scenes: Vec<PlaneScene>, models: &[reduced_model::TestedModel]) -> Self {
        let mechanisms = tested_mechanisms(scenes);
        let states: Vec<&TestedMechanism> = mechanisms
            .iter()
            .filter(|m| m.mode == CheckMode::States)
            .collect();
        let moving_scenes = ["single-dwell", "double-pendulum"].map(scene);
        let check_motion = |scene: &PlaneScene, mutation: Option<motions::Mutation>| match scene
            .loads
            .is_empty()
        {
            true => motions::reduced(scene, mutation),
            false => motions::under_gravity(scene, mutation),
        };
        let by_mechanism = mechanisms.iter().map(|machine| machine.check(None));
        let by_model = models.iter().filter_map(|model| model.check(None));
        let by_motion = moving_scenes
            .iter()
            .filter_map(|scene| check_motion(scene, None));
        let unmutated = by_mechanism.chain(by_model).chain(by_motion);
        let unmutated = unmutated.fold(Detection::default(), |sum, one| sum.merge(&one));
        let groups = vec![
            MutationGroup {
                title: "In the reduced model",
                rows: named_rows(
                    &reduced_model::Mutation::ALL,
                    reduced_model::Mutation::description,
                    models,
                    |model, mutation| {
                        Some((model.scene.name.clone(), model.check(Some(mutation))?))
                    },
                ),
            },
            MutationGroup {
                title: "In states under loads, with any number of actuators",
                rows: named_rows(
                    &claimed_states::Mutation::ALL,
                    claimed_states::Mutation::description,
                    &states,
                    |machine, mutation| Some((machine.name.clone(), mutation.check(machine)?)),
                ),
            },
            MutationGroup {
                title: "In the equation of motion",
                rows: named_rows(
                    &motions::Mutation::ALL,
                    motions::Mutation::description,
                    &moving_scenes,
                    |scene, mutation| {
                        Some((scene.name.clone(), check_motion(scene, Some(mutation))?))
                    },
                ),
            },
        ];
        let ignoring = mechanisms.iter().filter(|m| !m.ignored_findings.is_empty());
        Self {
            name: "mutations",
            title: "Deliberate faults and the independent checks that detect them",
            without_mutation: unmutated,
            groups,
            operation_results: operations::mutate_operations(&mechanisms),
            ignored: ignoring
                .map(|m| (m.name.clone(), m.mode, m.ignored_findings.clone()))
                .collect(),
            mechanisms: mechanisms.len() + models.len() + moving_scenes.len(),
            exceptions: &[],
        }
    }

    /// Whether a fault is detected by one check, where that is enough.
    pub fn is_exception(&self, result: &MutationResult) -> bool {
        let mut files = self.exceptions.iter();
        let is_excepted = files.any(|(file, _)| result.operation.file.ends_with(file));
        let MutationOutcome::Checked(detection, _) = &result.outcome else {
            return false;
        };
        is_excepted && detection.check_count() > 0
    }

    /// What the study lacks; empty if nothing.
    pub fn gaps(&self) -> Vec<String> {
        let mut gaps = Vec::new();
        if self.without_mutation.check_count() > 0 {
            gaps.push(format!(
                "checks {} fail without a fault",
                self.without_mutation.check_numbers()
            ));
        }
        for row in self.groups.iter().flat_map(|c| &c.rows) {
            if row.mechanisms == 0 {
                gaps.push(format!("{}: a fault on no machine", row.description));
            } else if row.detection.check_count() < REQUIRED_CHECKS {
                gaps.push(format!(
                    "{} on {}: detected by [{}] only",
                    row.description,
                    row.mechanism,
                    row.detection.check_numbers()
                ));
            }
        }
        let missed = self
            .operation_results
            .iter()
            .filter(|result| result.undetected() && !self.is_exception(result));
        gaps.extend(missed.map(|s| {
            format!(
                "{}:{} {} of a {}: missed",
                s.operation.file,
                s.operation.line,
                s.kind.description(),
                s.operation.operation.description()
            )
        }));
        gaps
    }
}

/// Each fault on every mechanism where it is one; the row is that of the mechanism where the fewest checks detect it.
fn named_rows<F: Copy + Sync, M: Sync>(
    mutations: &[F],
    describe: fn(F) -> &'static str,
    mechanisms: &[M],
    check: impl Fn(&M, F) -> Option<(String, Detection)> + Sync,
) -> Vec<NamedMutation> {
    let row = |&mutation: &F| {
        let results: Vec<(String, Detection)> = mechanisms
            .par_iter()
            .filter_map(|m| check(m, mutation))
            .collect();
        let least_detected = results
            .iter()
            .min_by_key(|(_, detection)| detection.check_count())
            .cloned();
        let (on, detection) = least_detected.unwrap_or_default();
        NamedMutation {
            description: describe(mutation),
            mechanisms: results.len(),
            mechanism: on,
            detection,
        }
    };
    mutations.par_iter().map(row).collect()
}
