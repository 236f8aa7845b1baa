//! A scene in space, for all analyses.

use super::check;
use super::export::{fit_in_space, several_freedoms_error};
use super::motion::{SimulatedMotion, SpaceMotionProblem};
use super::prepared::PreparedSpaceScene;
use super::trajectory::{JointReactions, computed_rows, space_page};
use super::views::page_drawing;
use crate::explain::StudyError;
use crate::export::ExportRequest;
use crate::free_motion::compute::{FreeMotion, MotionProblem as _, MotionSolver, named_events};
use crate::progress::Progress;
use crate::study_scene::{PageAndStop, StudyScene};
use crate::trajectory::compute::{Analysis, ComputedTrajectory};
use dwell_dynamics::Orbit;
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record};
use dwell_page::Drawing;
use dwell_scene::SpaceScene;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    super::trajectory::{drawn_positions, figures},
    super::views::SpacePositions,
    crate::assembled::BodyStates,
    crate::explain::NamedScene as _,
    crate::output::Picture,
    crate::trajectory::document::Document,
    crate::trajectory::figures::PictureSpan,
    crate::trajectory::output::{TrajectoryOutcome, outcome_of},
    dwell_geometry::space::{Placement, Rotation, vec3},
    dwell_report::TableExport as _,
};

impl StudyScene for SpaceScene {
    fn description(&self, record: &mut Record) -> Result<String, StudyError> {
        check::description(self, record)
    }

    fn prepared(&self) -> Result<PreparedSpaceScene<'_>, StudyError> {
        PreparedSpaceScene::new(self)
    }

    fn drawing_of(
        prepared: &PreparedSpaceScene<'_>,
        q: &[f64],
    ) -> Result<Option<Drawing>, StudyError> {
        let rows = prepared.placements(q)?;
        Ok(Some(page_drawing(prepared.scene, rows, Vec::new())))
    }

    #[cfg(feature = "output")]
    fn range_pictures(
        prepared: &PreparedSpaceScene<'_>,
    ) -> Result<Option<[Picture; 2]>, StudyError> {
        let scene = prepared.scene;
        let positions = prepared.drawn_positions()?;
        let name = |rest: &str| format!("{}-mechanism.{rest}", scene.name);
        let figure = Picture::figure(scene, name("png"), true, positions.figure());
        let animation = Picture::animation(scene, name("gif"), positions.animation());
        Ok(Some([figure, animation]))
    }

    #[cfg(feature = "output")]
    fn drawn(&self, at: &dyn BodyStates, others: &[Box<dyn BodyStates>]) -> dwell_report::Drawing {
        let vector = |[x, y, z]: [f64; 3]| vec3(x, y, z);
        let placement = |states: &dyn BodyStates, body| Placement {
            position: vector(states.point(body, [0.0; 3])[0]),
            rotation: Rotation {
                columns: states.axes(body).map(vector),
            },
        };
        let bodies = 0..self.mechanism.bodies.len();
        let placements = |states| bodies.clone().map(|b| placement(states, b)).collect();
        let all = others
            .iter()
            .map(|states| (placements(&**states), String::new()));
        let positions = SpacePositions {
            scene: self,
            drawn: placements(at),
            drawn_at: String::new(),
            all: all.collect(),
            provenance: String::new(),
        };
        positions.axonometric()
    }

    fn prescribes_positions(&self) -> bool {
        self.prescribed.is_some() || self.sweep.is_some()
    }

    fn trajectory(
        &self,
        analysis: Analysis,
        points: Option<usize>,
        progress: Progress<'_>,
    ) -> Result<ComputedTrajectory<'_>, StudyError> {
        let (reactions, model) = JointReactions::new(self)?;
        let of_model = (&reactions, &model);
        let (computed, _) = computed_rows(self, of_model, (analysis, points), &|_| true, progress)?;
        Ok(computed)
    }

    fn trajectory_page(
        &self,
        analysis: Analysis,
        points: Option<usize>,
        progress: Progress<'_>,
    ) -> Result<PageAndStop, StudyError> {
        let (reactions, model) = JointReactions::new(self)?;
        let of_model = (&reactions, &model);
        let (computed, evaluator) =
            computed_rows(self, of_model, (analysis, points), &|_| true, progress)?;
        let size = model.plan().size();
        let page = space_page(self, size, &computed, (&reactions, vec![evaluator]));
        Ok((page, computed.early_stop))
    }

    #[cfg(feature = "output")]
    fn trajectory_outcome(
        &self,
        analysis: Analysis,
        points: Option<usize>,
        span: PictureSpan,
        progress: Progress<'_>,
    ) -> Result<TrajectoryOutcome, StudyError> {
        let (reactions, model) = JointReactions::new(self)?;
        let (of_model, of) = ((&reactions, &model), (analysis, points));
        let (computed, evaluator) = computed_rows(self, of_model, of, &|_| true, progress)?;
        let size = model.plan().size();
        let swept = computed.trajectory.swept_actuator();
        let swept = swept.and_then(|k| self.actuator(k));
        let of = (&reactions, vec![evaluator.clone()]);
        let run = space_page(self, size, &computed, of);
        let positions = drawn_positions(self, &computed, vec![evaluator], swept);
        let mut all_figures = vec![positions.figure()];
        all_figures.extend(figures(self, swept, &computed, span)?);
        let document = Document::of_file(&self.file, size, &computed);
        let pictures = (all_figures, positions.animation());
        let mut outcome = outcome_of(&self.file, &computed, &document, pictures)?;
        outcome.run = Some(Box::new(run));
        Ok(TrajectoryOutcome {
            outcome,
            early_stop: computed.early_stop,
        })
    }

    fn simulated(
        &self,
        solver: &MotionSolver,
        progress: Progress<'_>,
    ) -> Result<FreeMotion, StudyError> {
        let problem = SpaceMotionProblem::new(self)?.for_solver(solver);
        let SimulatedMotion { run, computed } = problem.simulate(solver, None, progress)?;
        let estimated_error = run.accuracy.and_then(|_| problem.largest_error(&run));
        Ok(FreeMotion {
            computed,
            events: named_events(&problem, &run.motion.parts),
            estimated_error,
        })
    }

    fn free_motion_page(
        &self,
        solver: &MotionSolver,
        progress: Progress<'_>,
    ) -> Result<PageAndStop, StudyError> {
        let problem = SpaceMotionProblem::new(self)?.for_solver(solver);
        let simulated = problem.simulate(solver, None, progress)?;
        let mut page = problem.page(&simulated);
        let (summary, record) = problem.summary(&simulated.run, problem.duration()?);
        page.printed = summary;
        page.numbers = record.numbers;
        page.events = problem.recorded_events(&simulated.run);
        Ok((page, simulated.computed.early_stop))
    }

    #[cfg(feature = "output")]
    fn free_motion_outcome(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        span: PictureSpan,
        progress: Progress<'_>,
    ) -> Result<TrajectoryOutcome, StudyError> {
        let problem = SpaceMotionProblem::new(self)?.for_solver(solver);
        let simulated = problem.simulate(solver, times, progress)?;
        let page = problem.page(&simulated);
        let SimulatedMotion { run, computed } = simulated;
        let evaluators = problem.evaluators(&run.motion);
        let positions = drawn_positions(self, &computed, evaluators, None);
        let mut all_figures = vec![positions.figure()];
        all_figures.extend(figures(self, None, &computed, span)?);
        let size = problem.output_model.plan().size();
        let document = Document::of_file(&self.file, size, &computed);
        let pictures = (all_figures, positions.animation());
        let mut outcome = outcome_of(&self.file, &computed, &document, pictures)?;
        outcome.run = Some(Box::new(page));
        let table = problem.event_table(&run.motion);
        if !table.rows.is_empty() {
            let name = format!("{}-motion-events.csv", self.name);
            outcome.files.add(name, table.csv()?);
        }
        let (summary, record) = problem.summary(&run, problem.duration()?);
        outcome.summary += &summary;
        outcome.record.extend(record);
        outcome.record.events = problem.recorded_events(&run);
        Ok(TrajectoryOutcome {
            outcome,
            early_stop: computed.early_stop,
        })
    }

    fn orbit(&self) -> Result<Orbit, StudyError> {
        let problem = SpaceMotionProblem::new(self)?;
        problem.orbit(1.0).map_err(|error| problem.explain(&error))
    }

    fn closed_form(&self, _: Option<&str>) -> Result<(ClosedForm, Vec<Finding>), StudyError> {
        Err(self.planar_only().into())
    }

    fn fitted_export(&self, asked: &ExportRequest) -> Result<Export, StudyError> {
        fit_in_space(self, asked)
    }

    fn several_freedoms(&self, _: &ExportRequest) -> Result<SeveralFreedomsExport, StudyError> {
        Err(several_freedoms_error(self))
    }

    fn several_freedoms_error(&self) -> StudyError {
        several_freedoms_error(self)
    }
}
