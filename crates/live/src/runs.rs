//! Runs a command on a scene, for the page.

use crate::pages;
use crate::request::Command;
use dwell_scene::Scene;
use dwell_study::{
    Analysis, CycleSearch, MotionSolver, PageAndStop, SceneTask, SolverSettings, StudyError,
    StudyScene, compute_cycle, compute_equilibria, compute_reduction, describe_scene,
    free_motion_page, no_progress, reduction_page, trajectory_page, with_dimension,
};

/// Runs a command with the default options of the command line.
pub(crate) fn run(command: Command, scene: &Scene) -> Result<PageAndStop, StudyError> {
    with_dimension(scene, command)
}

impl SceneTask for Command {
    type Output = Result<PageAndStop, StudyError>;

    fn run<S: StudyScene>(self, scene: &S) -> Self::Output {
        match self {
            Self::Motion => {
                if scene.prescribes_positions() {
                    along_motion(scene, Analysis::Kinetostatics)
                } else {
                    along_motion(scene, Analysis::Kinematics)
                }
            }
            Self::Kinematics => along_motion(scene, Analysis::Kinematics),
            Self::Statics => along_motion(scene, Analysis::Statics),
            Self::Kinetostatics => along_motion(scene, Analysis::Kinetostatics),
            Self::Reduce => {
                let reduction = compute_reduction(scene, None)?;
                Ok((reduction_page::<S>(&reduction)?, None))
            }
            Self::Simulate => {
                let solver = MotionSolver::Settings(SolverSettings::default());
                free_motion_page(scene, &solver, &no_progress)
            }
            Self::Cycle => match compute_cycle(scene, &SolverSettings::default(), None)? {
                CycleSearch::Steady(found) => Ok((pages::cycle(scene, &found), None)),
                CycleSearch::NoCycle { reason, .. } => Err(reason),
            },
            Self::Equilibria => {
                let page = pages::equilibria(scene, &compute_equilibria(scene)?);
                Ok((page, None))
            }
        }
    }
}

/// An analysis along the motion, with m and ½m′ of each row if there is a reduced model, and the period if there is one.
fn along_motion<S: StudyScene>(scene: &S, analysis: Analysis) -> Result<PageAndStop, StudyError> {
    let (mut page, early_stop) = trajectory_page(scene, analysis, None, &no_progress)?;
    page.printed = describe_scene(scene)? + &page.printed;
    pages::add_reduced_inertia(scene, &mut page);
    pages::add_period(scene, &mut page);
    Ok((page, early_stop))
}
