//! The differences between scenes in the plane and in space, for all analyses. Everything above uses a scene only through this
//! trait.

use crate::calibrate::CalibratedScene;
use crate::explain::StudyError;
use crate::export::ExportRequest;
use crate::free_motion::compute::SimulatedScene;
use crate::gradient::GradientScene;
use crate::trajectory::compute::{ComputedTrajectory, RowSource};
use crate::unit_runs::compute::UnitRunScene;
use dwell_dynamics::{Orbit, ReducedState};
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record};
use dwell_page::{Drawing, Page};
use dwell_scene::Scene;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    crate::assembled::BodyStates,
    crate::output::{Outcome, Picture},
    crate::trajectory::figures::PictureSpan,
};

/// A page, and why its motion ended early, if it did.
pub type PageAndStop = (Page, Option<StudyError>);

/// A scene in the plane or in space.
pub trait StudyScene: SimulatedScene + UnitRunScene + CalibratedScene + GradientScene {
    /// The text that [`check`](crate::check()) prints; its numbers are recorded.
    ///
    /// # Errors
    /// As of [`describe_scene`](crate::describe_scene).
    fn description(&self, record: &mut Record) -> Result<String, StudyError>;

    /// The scene with the reduced model of its requests.
    ///
    /// # Errors
    /// As of [`compute_reduction`](crate::compute_reduction).
    fn prepared(&self) -> Result<Self::Prepared<'_>, StudyError>;

    /// The mechanism at values of its coordinate, rad or m.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if a position cannot be reached.
    fn drawing_of(prepared: &Self::Prepared<'_>, q: &[f64]) -> Result<Option<Drawing>, StudyError>;

    /// Pictures of the mechanism over its range, placed before and after those of the reduced parameters.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if a position cannot be reached.
    #[cfg(feature = "output")]
    fn range_pictures(_: &Self::Prepared<'_>) -> Result<Option<[Picture; 2]>, StudyError> {
        Ok(None)
    }

    /// The mechanism drawn in a position; the other positions give the travel of its slides, the curves of its cams and the paths of points.
    #[cfg(feature = "output")]
    fn drawn(&self, at: &dyn BodyStates, others: &[Box<dyn BodyStates>]) -> dwell_report::Drawing;

    /// This drawing as an SVG document with the title of the scene.
    ///
    /// # Errors
    /// [`StudyError::Report`] where the picture is too large.
    #[cfg(feature = "output")]
    fn svg(
        &self,
        at: &dyn BodyStates,
        others: &[Box<dyn BodyStates>],
    ) -> Result<String, StudyError> {
        let figure = dwell_report::Figure {
            title: self.title.clone(),
            columns: 1,
            panels: vec![self.drawn(at, others).into()],
            ..Default::default()
        };
        Ok(dwell_report::svg(&figure)?)
    }

    /// Whether it prescribes a motion or a sweep of its coordinates.
    fn prescribes_positions(&self) -> bool {
        let (motion, sweep) = self.prescribed();
        motion.is_some() || sweep.is_some()
    }

    /// The page of rows.
    fn page(source: &RowSource<'_, '_, Self>, computed: &ComputedTrajectory<'_>) -> Page;

    /// Tables, figures and text of rows.
    ///
    /// # Errors
    /// [`StudyError::Scene`] where the span of the curves is not within the trajectory.
    #[cfg(feature = "output")]
    fn report(
        source: &RowSource<'_, '_, Self>,
        computed: &ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Outcome, StudyError>;

    /// The results of [`compute_period`](crate::compute_period).
    ///
    /// # Errors
    /// As of that.
    fn orbit(&self) -> Result<Orbit, StudyError> {
        let (machine, start) = self.motion_machine()?;
        let state = |k: usize| start.get(k).copied().unwrap_or_default();
        let from = ReducedState {
            t: 0.0,
            q: state(0),
            q_dot: state(machine.free().len()),
        };
        Orbit::loaded(&machine, from).map_err(|error| self.explain(machine.model(), &error))
    }

    /// The results of [`compute_closed_form`](crate::compute_closed_form).
    ///
    /// # Errors
    /// As of that.
    fn closed_form(&self, reaction: Option<&str>)
    -> Result<(ClosedForm, Vec<Finding>), StudyError>;

    /// Why several actuators are not exported to another target than C.
    fn several_freedoms_error(&self) -> StudyError;

    /// Notes on the parts of the scene that closed forms omit.
    #[cfg(feature = "output")]
    fn closed_form_notes(&self, _: &ClosedForm) -> String {
        String::new()
    }

    /// The results of [`compute_export`](crate::compute_export).
    ///
    /// # Errors
    /// As of that.
    fn fitted_export(&self, asked: &ExportRequest) -> Result<Export, StudyError>;

    /// The results of [`compute_export_of_several_freedoms`](crate::compute_export_of_several_freedoms).
    ///
    /// # Errors
    /// As of that.
    fn several_freedoms(&self, asked: &ExportRequest) -> Result<SeveralFreedomsExport, StudyError>;
}

/// A task on a scene, in the plane or in space.
pub trait SceneTask {
    /// The result of the task.
    type Output;

    /// Does it.
    fn run<S: StudyScene>(self, scene: &S) -> Self::Output;
}

/// Does a task with a scene: here alone it matters whether that is in the plane or in space.
pub fn with_dimension<T: SceneTask>(scene: &Scene, task: T) -> T::Output {
    match scene {
        Scene::Plane(scene) => task.run(&**scene),
        Scene::Space(scene) => task.run(&**scene),
    }
}
