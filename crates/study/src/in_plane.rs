//! A scene in the plane, for all analyses.

use crate::check;
use crate::explain::StudyError;
use crate::export::{ExportRequest, fit_in_plane, only_as_c, several_freedoms_in_plane};
use crate::free_motion::compute::{
    FreeMotion, MotionSolver, compute_free_motion_at, orbit_in_plane,
};
use crate::models::PreparedScene;
use crate::page::{drawing_along, plane_page};
use crate::progress::Progress;
use crate::study_scene::{PageAndStop, StudyScene};
use crate::symbolic::compute::closed_form_in_plane;
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, RowStorage, compute_trajectory_in, reject_unknown_variables,
};
use crate::unit_runs::compute::UnitRunScene as _;
use dwell_dynamics::Orbit;
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record, RecordedEvent};
use dwell_page::Drawing;
use dwell_scene::PlaneScene;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    crate::assembled::BodyStates,
    crate::bodies::BodyPose,
    crate::output::{MechanismDrawing, separating_note},
    crate::trajectory::figures::{PictureSpan, plane},
    crate::trajectory::output::{TrajectoryOutcome, report},
    dwell_geometry::vec2,
    dwell_report::TableExport as _,
};

impl StudyScene for PlaneScene {
    fn description(&self, record: &mut Record) -> Result<String, StudyError> {
        check::description(self, record)
    }

    fn prepared(&self) -> Result<PreparedScene<'_>, StudyError> {
        reject_unknown_variables(self)?;
        self.prepared_without_loads()
    }

    fn drawing_of(prepared: &PreparedScene<'_>, q: &[f64]) -> Result<Option<Drawing>, StudyError> {
        Ok(drawing_along(prepared.scene, q))
    }

    #[cfg(feature = "output")]
    fn drawn(&self, at: &dyn BodyStates, others: &[Box<dyn BodyStates>]) -> dwell_report::Drawing {
        let pose = |states: &dyn BodyStates, body| {
            let [[x, y, _], ..] = states.point(body, [0.0; 3]);
            let [[cos, sin, _], ..] = states.axes(body);
            (vec2(x, y), vec2(cos, sin))
        };
        let bodies = 0..self.mechanism.bodies.len();
        let poses = |states| bodies.clone().map(|b| pose(states, b)).collect();
        let others: Vec<Vec<BodyPose>> = others.iter().map(|states| poses(&**states)).collect();
        let mut shapes = Vec::new();
        MechanismDrawing::new(self, &others).draw(&poses(at), 0.0, &mut shapes);
        plane(String::new(), shapes)
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
        compute_trajectory_in(RowStorage::Whole, self, analysis, points, progress)
    }

    fn trajectory_page(
        &self,
        analysis: Analysis,
        points: Option<usize>,
        progress: Progress<'_>,
    ) -> Result<PageAndStop, StudyError> {
        let computed = self.trajectory(analysis, points, progress)?;
        let mut page = plane_page(self, &computed);
        page.printed = computed.notes;
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
        let computed =
            compute_trajectory_in(RowStorage::Bounded, self, analysis, points, progress)?;
        let mut outcome = report(self, &computed, span)?;
        outcome.summary += &computed.notes;
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
        Ok(compute_free_motion_at(self, solver, None, progress)?.motion)
    }

    fn free_motion_page(
        &self,
        solver: &MotionSolver,
        progress: Progress<'_>,
    ) -> Result<PageAndStop, StudyError> {
        let described = compute_free_motion_at(self, solver, None, progress)?;
        let mut page = plane_page(&described.loaded_scene, &described.motion.computed);
        page.printed = described.summary;
        page.numbers = described.record.numbers;
        page.events = recorded(described.motion.events);
        Ok((page, described.motion.computed.early_stop))
    }

    #[cfg(feature = "output")]
    fn free_motion_outcome(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        span: PictureSpan,
        progress: Progress<'_>,
    ) -> Result<TrajectoryOutcome, StudyError> {
        let described = compute_free_motion_at(self, solver, times, progress)?;
        let FreeMotion {
            computed, events, ..
        } = described.motion;
        let mut outcome = report(&described.loaded_scene, &computed, span)?;
        if !events.is_empty() {
            let name = format!("{}-motion-events.csv", self.name);
            outcome.files.add(name, described.event_table.csv()?);
        }
        outcome.summary += &described.summary;
        outcome.record.extend(described.record);
        outcome.record.events = recorded(events);
        Ok(TrajectoryOutcome {
            outcome,
            early_stop: computed.early_stop,
        })
    }

    fn orbit(&self) -> Result<Orbit, StudyError> {
        orbit_in_plane(self)
    }

    fn closed_form(
        &self,
        reaction: Option<&str>,
    ) -> Result<(ClosedForm, Vec<Finding>), StudyError> {
        closed_form_in_plane(self, reaction)
    }

    #[cfg(feature = "output")]
    fn closed_form_notes(&self, form: &ClosedForm) -> String {
        let mut notes = match form.reaction {
            Some(_) => separating_note(self),
            None => String::new(),
        };
        let loads = self.loads.iter().filter(|load| load.does_work());
        let loads: Vec<&str> = loads.map(|load| load.name.as_str()).collect();
        if !loads.is_empty() {
            notes += &format!(
                "  without the loads {}: `dwell reduce` computes w and c, their parts of the motion and of the reaction\n",
                loads.join(", ")
            );
        }
        notes
    }

    fn fitted_export(&self, asked: &ExportRequest) -> Result<Export, StudyError> {
        fit_in_plane(self, asked)
    }

    fn several_freedoms(&self, asked: &ExportRequest) -> Result<SeveralFreedomsExport, StudyError> {
        several_freedoms_in_plane(self, asked)
    }

    fn several_freedoms_error(&self) -> StudyError {
        only_as_c(self)
    }
}

/// The events that happened, with their times.
fn recorded(events: Vec<(f64, String)>) -> Vec<RecordedEvent> {
    let event = |(t, name)| RecordedEvent { name, t };
    events.into_iter().map(event).collect()
}
