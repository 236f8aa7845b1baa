//! Every picture of every case, as a reader gets it: no words lie on others, nothing is cut, and no legend names a curve that
//! is not there to see.

use dwell_dynamics::Method;
use dwell_scene::PlaneScene;
use dwell_study::output::Picture;
use dwell_study::{
    Analysis, Outcome, ParameterSweep, SolverSettings, StudyError, SweepRequest, TrajectoryOutcome,
    analyse_trajectory, cycle, equilibria, no_progress, reduce, simulate, sweep,
};
use dwell_tests::fixtures::{case_names, repository_root, scene};
use dwell_trials::{machines, pulses};
use dwell_validation::{
    ValidatedCase, ValidationRun, export_study, extremes, index, validate, work_precision,
};
use rayon::prelude::*;
use std::fmt::Write as _;

/// Height of two pages of paper, A4, over the width of one.
const TWO_PAGES: f64 = 2.0 * std::f64::consts::SQRT_2;

/// How many pictures there are of a study, and what is wrong with them.
#[derive(Debug, Default)]
struct Checked {
    pictures: usize,
    defects: String,
}

fn checked(study: &str, pictures: &[Picture]) -> Checked {
    let mut all = Checked {
        pictures: pictures.len(),
        ..Checked::default()
    };
    for picture in pictures {
        let layouts = picture.layouts().expect("a layout");
        let mut defects: Vec<String> = layouts.iter().flat_map(|layout| layout.defects()).collect();
        let long = layouts.iter().map(|layout| layout.page);
        let long = long.filter(|[width, height]| *height > TWO_PAGES * width);
        defects.extend(long.map(|[w, h]| format!("{w} × {h} pixels are more than two pages")));
        // The frames of a film are much alike.
        defects.sort();
        defects.dedup();
        for defect in defects {
            let _ = writeln!(all.defects, "{study}: {}: {defect}", picture.path);
        }
    }
    all
}

fn sum(all: impl Iterator<Item = Checked>) -> Checked {
    all.fold(Checked::default(), |sum, one| Checked {
        pictures: sum.pictures + one.pictures,
        defects: sum.defects + &one.defects,
    })
}

fn of_outcome(study: &str, outcome: Result<Outcome, StudyError>) -> Checked {
    // Not every study is one of every mechanism.
    outcome.map_or_else(|_| Checked::default(), |o| checked(study, &o.pictures))
}

fn of_trajectory(study: &str, done: Result<TrajectoryOutcome, StudyError>) -> Checked {
    of_outcome(study, done.map(|done| done.outcome))
}

fn all_studies(scene: &PlaneScene) -> Checked {
    let settings = SolverSettings {
        method: Method::Bdf,
        ..SolverSettings::default()
    };
    let trajectory = |analysis| analyse_trajectory(scene, analysis, None, &no_progress);
    let kinds = [
        of_trajectory("kinematics", trajectory(Analysis::Kinematics)),
        of_trajectory("statics", trajectory(Analysis::Statics)),
        of_trajectory("kinetostatics", trajectory(Analysis::Kinetostatics)),
        of_trajectory("simulate", simulate(scene, &settings, &no_progress)),
        of_trajectory("cycle", cycle(scene, &settings, Some(0.02))),
        of_outcome("reduce", reduce(scene, None, None)),
        of_outcome("equilibria", equilibria(scene)),
    ];
    sum(kinds.into_iter())
}

#[test]
fn the_pictures_of_every_case_are_legible() {
    let of_case = |case: &String| all_studies(&scene(case));
    let all: Vec<Checked> = case_names().par_iter().map(of_case).collect();
    let all = sum(all.into_iter());
    assert!(all.defects.is_empty(), "{}", all.defects);
    assert!(all.pictures > 700, "{} pictures", all.pictures);
}

#[test]
fn the_pictures_of_the_validation_are_legible() {
    let cases = case_names();
    let of_case = |case: &String| {
        let folder = repository_root().join("validation").join(case);
        validate(&scene(case).into(), &folder, None, &no_progress).expect("a validation")
    };
    let done: Vec<_> = cases.par_iter().map(of_case).collect();
    let scenes: Vec<PlaneScene> = cases.iter().map(|case| scene(case)).collect();
    let judged = scenes.iter().zip(&done).map(|(scene, done)| ValidatedCase {
        name: &scene.name,
        title: &scene.title,
        in_space: false,
        result: Ok(done),
    });
    let judged = ValidationRun {
        cases: judged.collect(),
        studies: Vec::new(),
        no_reader: None,
        manual: Some([1, 1]),
    };
    let mut all = vec![checked("index", &index(&judged).pictures)];
    all.extend(
        done.iter()
            .map(|d| checked("validate", &d.outcome.pictures)),
    );
    all.push(of_outcome("extremes", extremes::study(false)));
    all.push(of_outcome("trials", trials()));
    let scenes: Vec<&PlaneScene> = scenes.iter().collect();
    let exported = scenes.iter().find(|s| s.name == export_study::CASE);
    let exported = export_study::study(exported.expect("the case"));
    all.push(of_outcome("exported-runs", exported));
    let costs = work_precision::selected_case_reports(&scenes);
    all.push(of_outcome("work-precision", costs));
    let all = sum(all.into_iter());
    assert!(all.defects.is_empty(), "{}", all.defects);
    assert!(all.pictures > 160, "{} pictures", all.pictures);
}

/// A chain of pinned links from one bearing, folded so that its joints lie close together.
fn folded_chain(links: usize) -> PlaneScene {
    let mut text =
        "title = \"Folded chain\"\n[bodies.ground]\npoints = { P = [0, 0] }\n".to_owned();
    let [mut joints, mut actuators, mut angles, mut speeds] = [const { String::new() }; 4];
    for k in 0..links {
        let before = if k == 0 {
            "ground.P".to_owned()
        } else {
            format!("link{}.Q", k - 1)
        };
        let _ = write!(
            text,
            "[bodies.link{k}]\npoints = {{ P = [0, 0], Q = [0.3, 0] }}\nmass = 1.0\ncenter = [0.15, 0]\ninertia = 0.01\n"
        );
        let _ = writeln!(
            joints,
            "joint-{k} = {{ revolute = [\"{before}\", \"link{k}.P\"] }}"
        );
        let _ = writeln!(actuators, "q{k} = {{ angle = [\"ground\", \"link{k}\"] }}");
        let angle = if k % 2 == 0 { 1.3 } else { -1.2 };
        let _ = writeln!(angles, "q{k} = {angle}");
        let _ = writeln!(speeds, "[prescribed.q{k}]\nspeed = 0.2");
    }
    text += &format!(
        "[joints]\n{joints}[actuators]\n{actuators}[assembly]\n{angles}[loads]\nweight = {{ gravity = [0, -9.81] }}\n\
         [prescribed]\nduration = 1.0\n{speeds}"
    );
    PlaneScene::parse("folded-chain.toml", &text).expect("a scene")
}

#[test]
fn the_pictures_of_crowded_scenes_are_legible() {
    let chain = folded_chain(14);
    let done = analyse_trajectory(&chain, Analysis::Kinematics, Some(61), &no_progress);
    let all = of_trajectory("chain", done);
    assert!(all.defects.is_empty(), "{}", all.defects);
    assert!(all.pictures > 2, "{} pictures", all.pictures);
}

/// The pictures of a few pulses and machines.
fn trials() -> Result<Outcome, StudyError> {
    let mut outcome = Outcome::default();
    pulses::add_to(&mut outcome, &pulses::evaluate(12, 1), 1, "pulses")?;
    machines::add_to(&mut outcome, &machines::evaluate(4, 1), 1, "machines")?;
    Ok(outcome)
}

#[test]
fn the_pictures_of_sweeps_are_legible() {
    let folder = std::env::temp_dir().join(format!("dwell-pictures-{}", std::process::id()));
    let run = |case: &str, vary: &[&str], samples: Option<u64>| {
        let vary: Vec<String> = vary.iter().map(|&text| text.to_owned()).collect();
        let name = vary.join(" ").replace(['/', '.', '=', '~', ':', ' '], "-");
        let folder = folder.join(name);
        let wanted = ParameterSweep {
            request: SweepRequest {
                vary: &vary,
                samples,
                seed: 1,
                ..SweepRequest::default()
            },
            shard: None,
            export: None,
            folder: &folder,
        };
        let done = sweep(&scene(case), &wanted, &no_progress).expect("a sweep");
        checked("sweep", &done.pictures)
    };
    let kinds = [
        run("single-dwell", &["crank.inertia=0.001:0.01:9"], None),
        run(
            "single-dwell",
            &["crank.inertia=0.001:0.01:9", "coupler.mass=1:3:7"],
            None,
        ),
        run(
            "single-dwell",
            &["crank.inertia~normal(0.005,0.0003)"],
            Some(60),
        ),
        run(
            "slider-crank",
            &["rod.mass=0.5:0.9:5", "piston.mass~uniform(0.6,0.8)"],
            Some(20),
        ),
    ];
    let all = sum(kinds.into_iter());
    std::fs::remove_dir_all(folder).expect("a folder of ours");
    assert!(all.defects.is_empty(), "{}", all.defects);
    assert_eq!(all.pictures, 4);
}
