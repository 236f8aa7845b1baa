//! A command on a scene: what the page shows of it.

use crate::pages;
use crate::request::Command;
use dwell_page::Page;
use dwell_scene::{AnyScene, CoordinateSweep, PrescribedMotion, Scene, SpaceScene};
use dwell_study::machines::MachineScene;
use dwell_study::page::trajectory_page;
use dwell_study::reduce::reduction_page;
use dwell_study::{
    Analysis, CycleSearch, MotionSolver, SolverSettings, StudyError, compute_cycle,
    compute_equilibria, compute_free_motion, compute_reduction, compute_reduction_in_space,
    compute_trajectory, free_motion_page_in_space, no_progress, reduction_page_in_space,
    trajectory_page_in_space,
};

/// What a page shows, and why a motion ended early.
type PageAndStop = (Page, Option<StudyError>);

/// Runs a command, with the options that the command line takes where none is given.
pub(crate) fn run(command: Command, scene: &AnyScene) -> Result<PageAndStop, StudyError> {
    match scene {
        AnyScene::Plane(scene) => in_plane(command, scene),
        AnyScene::Space(scene) => in_space(command, scene),
    }
}

fn in_space(command: Command, scene: &SpaceScene) -> Result<PageAndStop, StudyError> {
    Ok(match command {
        Command::Motion | Command::Kinematics | Command::Statics | Command::Kinetostatics => {
            let analysis = analysis(command, &scene.prescribed, &scene.sweep);
            trajectory_page_in_space(scene, analysis, &no_progress)?
        }
        Command::Reduce => {
            let reduction = compute_reduction_in_space(scene, None)?;
            (reduction_page_in_space(&reduction)?, None)
        }
        Command::Simulate => {
            let solver = MotionSolver::Settings(SolverSettings::default());
            free_motion_page_in_space(scene, &solver, &no_progress)?
        }
        Command::Cycle => (cycle(scene)?, None),
        Command::Equilibria => (equilibria(scene)?, None),
    })
}

fn in_plane(command: Command, scene: &Scene) -> Result<PageAndStop, StudyError> {
    Ok(match command {
        Command::Motion | Command::Kinematics | Command::Statics | Command::Kinetostatics => {
            along_motion(scene, analysis(command, &scene.prescribed, &scene.sweep))?
        }
        Command::Reduce => (reduction_page(&compute_reduction(scene, None)?), None),
        Command::Simulate => {
            let solver = MotionSolver::Settings(SolverSettings::default());
            let motion = compute_free_motion(scene, &solver, &no_progress)?;
            let page = Page {
                printed: motion.summary,
                numbers: motion.record.numbers,
                events: pages::events(motion.events),
                ..trajectory_page(&motion.loaded_scene, &motion.computed)
            };
            (page, motion.computed.early_stop)
        }
        Command::Cycle => (cycle(scene)?, None),
        Command::Equilibria => (equilibria(scene)?, None),
    })
}

fn cycle(scene: &impl MachineScene) -> Result<Page, StudyError> {
    match compute_cycle(scene, &SolverSettings::default(), None)? {
        CycleSearch::Steady(found) => Ok(pages::cycle(scene, &found)),
        CycleSearch::NoCycle { reason, .. } => Err(reason),
    }
}

fn equilibria(scene: &impl MachineScene) -> Result<Page, StudyError> {
    Ok(pages::equilibria(scene, &compute_equilibria(scene)?))
}

/// What a command computes along a trajectory. Along the motion of a scene these are its forces, where it has one.
fn analysis(
    command: Command,
    prescribed: &Option<PrescribedMotion>,
    sweep: &Option<CoordinateSweep>,
) -> Analysis {
    match command {
        Command::Statics => Analysis::Statics,
        Command::Kinetostatics => Analysis::Kinetostatics,
        Command::Motion if prescribed.is_some() || sweep.is_some() => Analysis::Kinetostatics,
        _ => Analysis::Kinematics,
    }
}

/// An analysis along the motion, with m and ½m′ of each row where there is a reduced model, and the period where there is one.
fn along_motion(scene: &Scene, analysis: Analysis) -> Result<PageAndStop, StudyError> {
    let computed = compute_trajectory(scene, analysis, None, &no_progress)?;
    let mut page = trajectory_page(scene, &computed);
    page.printed = dwell_study::describe_scene(scene)? + &computed.notes;
    pages::add_reduced_inertia(scene, &mut page);
    pages::add_period(scene, &mut page);
    Ok((page, computed.early_stop))
}
