//! A command on a scene: what the page shows of it.

use crate::diagnostics::scene_error;
use crate::pages;
use crate::request::Command;
use dwell_page::Page;
use dwell_scene::{AnyScene, CoordinateSweep, PrescribedMotion, Scene, SceneError, SpaceScene};
use dwell_study::machines::MachineScene;
use dwell_study::page::trajectory_page;
use dwell_study::reduce::reduction_page;
use dwell_study::{
    Analysis, CycleSearch, MotionSolver, SolverSettings, StudyError, compute_cycle,
    compute_equilibria, compute_free_motion, compute_reduction, compute_reduction_in_space,
    compute_trajectory, free_motion_page_in_space, no_progress, reduction_page_in_space,
    trajectory_page_in_space,
};

/// What a command came to.
pub(crate) struct Run {
    /// What the page shows.
    pub(crate) page: Page,
    /// Why a motion ended early, or no cycle was found.
    pub(crate) early_stop: Option<SceneError>,
}

impl From<Page> for Run {
    fn from(page: Page) -> Self {
        Self {
            page,
            early_stop: None,
        }
    }
}

/// Runs a command, with the options that the command line takes where none is given.
pub(crate) fn run(command: Command, scene: &AnyScene) -> Result<Run, SceneError> {
    match scene {
        AnyScene::Plane(scene) => in_plane(command, scene).map_err(scene_error),
        AnyScene::Space(scene) => in_space(command, scene).map_err(scene_error),
    }
}

fn in_space(command: Command, scene: &SpaceScene) -> Result<Run, StudyError> {
    let analysis = match command {
        Command::Motion => follows(&scene.prescribed, &scene.sweep),
        Command::Kinematics => Analysis::Kinematics,
        Command::Statics => Analysis::Statics,
        Command::Kinetostatics => Analysis::Kinetostatics,
        Command::Reduce => {
            let reduction = compute_reduction_in_space(scene, None)?;
            return Ok(reduction_page_in_space(&reduction)?.into());
        }
        Command::Simulate => {
            let solver = MotionSolver::Settings(SolverSettings::default());
            let (page, early_stop) = free_motion_page_in_space(scene, &solver, &no_progress)?;
            return Ok(Run {
                page,
                early_stop: early_stop.map(scene_error),
            });
        }
        Command::Cycle => return cycle(scene),
        Command::Equilibria => return equilibria(scene),
    };
    let (page, early_stop) = trajectory_page_in_space(scene, analysis, &no_progress)?;
    Ok(Run {
        page,
        early_stop: early_stop.map(scene_error),
    })
}

fn in_plane(command: Command, scene: &Scene) -> Result<Run, StudyError> {
    match command {
        Command::Motion => along_motion(scene, follows(&scene.prescribed, &scene.sweep)),
        Command::Kinematics => along_motion(scene, Analysis::Kinematics),
        Command::Statics => along_motion(scene, Analysis::Statics),
        Command::Kinetostatics => along_motion(scene, Analysis::Kinetostatics),
        Command::Reduce => {
            let reduction = compute_reduction(scene, None)?;
            Ok(reduction_page(&reduction).into())
        }
        Command::Simulate => {
            let solver = MotionSolver::Settings(SolverSettings::default());
            let motion = compute_free_motion(scene, &solver, &no_progress)?;
            let mut page = trajectory_page(&motion.loaded_scene, &motion.computed);
            page.printed = motion.summary;
            page.numbers = motion.record.numbers;
            page.events = pages::events(motion.events);
            Ok(Run {
                page,
                early_stop: motion.computed.early_stop.map(scene_error),
            })
        }
        Command::Cycle => cycle(scene),
        Command::Equilibria => equilibria(scene),
    }
}

fn cycle(scene: &impl MachineScene) -> Result<Run, StudyError> {
    match compute_cycle(scene, &SolverSettings::default(), None)? {
        CycleSearch::Steady(found) => Ok(pages::cycle(scene, &found).into()),
        CycleSearch::NoCycle { reason, .. } => Err(reason),
    }
}

fn equilibria(scene: &impl MachineScene) -> Result<Run, StudyError> {
    Ok(pages::equilibria(scene, &compute_equilibria(scene)?).into())
}

/// What is computed along the motion of a scene: its forces, where it has one.
fn follows(prescribed: &Option<PrescribedMotion>, sweep: &Option<CoordinateSweep>) -> Analysis {
    match prescribed.is_some() || sweep.is_some() {
        true => Analysis::Kinetostatics,
        false => Analysis::Kinematics,
    }
}

/// An analysis along the motion, with m and ½m′ of each row where there is a reduced model, and the period where there is one.
fn along_motion(scene: &Scene, analysis: Analysis) -> Result<Run, StudyError> {
    let computed = compute_trajectory(scene, analysis, None, &no_progress)?;
    let mut page = trajectory_page(scene, &computed);
    page.printed = dwell_study::describe_scene(scene)? + &computed.notes;
    pages::add_reduced_inertia(scene, &mut page);
    pages::add_period(scene, &mut page);
    Ok(Run {
        page,
        early_stop: computed.early_stop.map(scene_error),
    })
}
