//! The free motion of scenes in space: in which coordinates it goes on, and across which change points.

mod change_points;
mod charts;
mod continued;
mod problem;

pub(super) use self::problem::SpaceMotionProblem;
use crate::explain::StudyError;
use crate::free_motion::compute::{DescribedMotion, MotionSolver, SimulatedScene, simulated};
use crate::progress::Progress;
use crate::trajectory::compute::{RowSource, check_variables};
use dwell_scene::SpaceScene;

impl SimulatedScene for SpaceScene {
    fn simulate_then<R>(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
        then: impl FnOnce(&RowSource<'_, '_, Self>, DescribedMotion<'_>) -> R,
    ) -> Result<R, StudyError> {
        let problem = SpaceMotionProblem::new(self)?.for_solver(solver);
        check_variables(self, &problem.rows)?;
        simulated(&problem, solver, (times, progress), then)
    }
}
