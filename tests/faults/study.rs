//! The whole study: machines, faults, and what became of each.

use super::machine::{By, Machine};
use super::operations::{self, Slipped};
use super::verdict::{ENOUGH, Verdict};
use super::{claims, motions, published, reduced};
use dwell_scene::Scene;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// A named fault, on the machine that shows it least, and what the truths say there.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    pub(crate) fault: &'static str,
    /// Machines on which it is a fault.
    pub(crate) machines: usize,
    pub(crate) on: String,
    pub(crate) verdict: Verdict,
}

/// Named faults of one kind.
pub(crate) struct Chapter {
    pub(crate) title: &'static str,
    pub(crate) rows: Vec<Named>,
}

/// A truth that cannot judge a machine.
pub(crate) type Blind = (String, By, Vec<String>);

/// The study.
pub(crate) struct Study {
    /// Without a fault: the union over all machines.
    pub(crate) clean: Verdict,
    pub(crate) chapters: Vec<Chapter>,
    pub(crate) slips: Vec<Slipped>,
    pub(crate) machines: usize,
    pub(crate) blind: Vec<Blind>,
}

/// The repository's folder.
pub(crate) fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The scenes of the cases, then those of the study itself, by name.
fn scenes() -> Vec<Scene> {
    let names = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let mut paths: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
        paths.sort();
        paths
    };
    let cases = names(home().join("validation"))
        .into_iter()
        .map(|p| p.join("scene.toml"))
        .filter(|p| p.is_file());
    let paths: Vec<PathBuf> = cases
        .chain(names(home().join("tests/faults/scenes")))
        .collect();
    let read =
        |path: &PathBuf| Scene::read(path).unwrap_or_else(|e| panic!("{}: {e:?}", path.display()));
    paths.iter().map(read).collect()
}

/// A scene of a case, or of the study itself.
pub(crate) fn scene(name: &str) -> Scene {
    let all = ["validation", "tests/faults/scenes"];
    let [case, own] = all.map(|folder| home().join(folder).join(name));
    let own = own.with_extension("toml");
    let path = if own.exists() {
        own
    } else {
        case.join("scene.toml")
    };
    Scene::read(path).unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

/// The machines, the quickest to judge first.
pub(crate) fn machines(scenes: Vec<Scene>) -> Vec<Machine> {
    let all = scenes.into_par_iter().flat_map_iter(|scene| {
        let single = scene.mechanism.actuators.len() == 1;
        let reduced = single.then(|| Machine::new(scene.clone(), By::Reduced));
        let states = !single || !scene.loads.is_empty();
        let states = states.then(|| Machine::new(scene, By::States));
        reduced.into_iter().chain(states)
    });
    let mut all: Vec<Machine> = all.collect();
    all.sort_by_key(|machine| (machine.by == By::Reduced, machine.size()));
    all
}

/// The machines of the named faults of the reduced model, that with two branches first.
pub(crate) fn models() -> Vec<reduced::Model> {
    let single = scene("single-dwell");
    // The dyad of coupler and rocker the other way round, and what hangs on it.
    let mut other = single.clone();
    other
        .assembly
        .rough
        .iter_mut()
        .flatten()
        .for_each(|rough| *rough = -*rough);
    let samples = published::samples(&home().join("validation/single-dwell"), &single);
    let plain = [
        "crank-rocker",
        "slotted-rocker",
        "cross-slide",
        "turning-rail",
    ];
    let plain = plain.map(|name| reduced::Model::new(scene(name), None, Vec::new()));
    let mut models = vec![reduced::Model::new(single, Some(&other), samples)];
    models.extend(plain);
    models
}

impl Study {
    /// All faults on all machines.
    pub(crate) fn new() -> Self {
        Self::of(scenes(), &models())
    }

    /// All faults on some machines.
    pub(crate) fn of(scenes: Vec<Scene>, models: &[reduced::Model]) -> Self {
        let machines = machines(scenes);
        let states: Vec<&Machine> = machines.iter().filter(|m| m.by == By::States).collect();
        let moving = ["single-dwell", "double-pendulum"].map(scene);
        let judge_motion =
            |scene: &Scene, fault: Option<motions::Fault>| match scene.loads.is_empty() {
                true => motions::reduced(scene, fault),
                false => motions::under_weight(scene, fault),
            };
        let own = machines.iter().map(|machine| machine.judge(None));
        let of_models = models.iter().filter_map(|model| model.judge(None));
        let of_motions = moving.iter().filter_map(|scene| judge_motion(scene, None));
        let clean = own.chain(of_models).chain(of_motions);
        let clean = clean.fold(Verdict::default(), |sum, one| sum.and(&one));
        let chapters = vec![
            Chapter {
                title: "In the reduced model",
                rows: rows(
                    &reduced::Fault::ALL,
                    reduced::Fault::words,
                    models,
                    |model, fault| Some((model.scene.name.clone(), model.judge(Some(fault))?)),
                ),
            },
            Chapter {
                title: "In states under loads, with any number of actuators",
                rows: rows(
                    &claims::Fault::ALL,
                    claims::Fault::words,
                    &states,
                    |machine, fault| Some((machine.name.clone(), fault.judge(machine)?)),
                ),
            },
            Chapter {
                title: "In the equation of motion",
                rows: rows(
                    &motions::Fault::ALL,
                    motions::Fault::words,
                    &moving,
                    |scene, fault| Some((scene.name.clone(), judge_motion(scene, Some(fault))?)),
                ),
            },
        ];
        let blind = machines.iter().filter(|m| !m.blind.is_empty());
        Self {
            clean,
            chapters,
            slips: operations::study(&machines),
            blind: blind
                .map(|m| (m.name.clone(), m.by, m.blind.clone()))
                .collect(),
            machines: machines.len() + models.len() + moving.len(),
        }
    }

    /// What is wrong with the evidence, in words; empty if nothing is.
    pub(crate) fn holes(&self) -> Vec<String> {
        let mut holes = Vec::new();
        if self.clean.count() > 0 {
            holes.push(format!(
                "truths {} fail without a fault",
                self.clean.words()
            ));
        }
        for row in self.chapters.iter().flat_map(|c| &c.rows) {
            if row.machines == 0 {
                holes.push(format!("{}: a fault on no machine", row.fault));
            } else if row.verdict.count() < ENOUGH {
                holes.push(format!(
                    "{} on {}: caught by [{}] only",
                    row.fault,
                    row.on,
                    row.verdict.words()
                ));
            }
        }
        let missed = self.slips.iter().filter(|slipped| slipped.missed());
        holes.extend(missed.map(|s| {
            format!(
                "{}:{} {} of a {}: missed",
                s.place.file,
                s.place.line,
                s.slip.words(),
                s.place.operation.words()
            )
        }));
        holes
    }
}

/// Each fault on every machine where it is one; the machine that shows it to the fewest truths is told.
fn rows<F: Copy + Sync, M: Sync>(
    faults: &[F],
    words: fn(F) -> &'static str,
    machines: &[M],
    judge: impl Fn(&M, F) -> Option<(String, Verdict)> + Sync,
) -> Vec<Named> {
    let row = |&fault: &F| {
        let judged: Vec<(String, Verdict)> = machines
            .par_iter()
            .filter_map(|m| judge(m, fault))
            .collect();
        let least = judged
            .iter()
            .min_by_key(|(_, verdict)| verdict.count())
            .cloned();
        let (on, verdict) = least.unwrap_or_default();
        Named {
            fault: words(fault),
            machines: judged.len(),
            on,
            verdict,
        }
    };
    faults.par_iter().map(row).collect()
}
