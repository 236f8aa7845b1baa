//! A scene in the plane, for all analyses.

use crate::check;
use crate::explain::StudyError;
use crate::export::{ExportRequest, fit_in_plane, only_as_c, several_freedoms_in_plane};
use crate::models::PreparedScene;
use crate::page::{drawing_along, plane_page};
use crate::study_scene::StudyScene;
use crate::symbolic::compute::closed_form_in_plane;
use crate::trajectory::compute::{ComputedTrajectory, RowSource, reject_unknown_variables};
use crate::unit_runs::compute::UnitRunScene as _;
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record};
use dwell_page::{Drawing, Page};
use dwell_scene::PlaneScene;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    crate::assembled::BodyStates,
    crate::bodies::BodyPose,
    crate::output::{MechanismDrawing, Outcome, separating_note},
    crate::trajectory::figures::{PictureSpan, plane},
    crate::trajectory::output::report,
    dwell_geometry::vec2,
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

    fn page(source: &RowSource<'_, '_, Self>, computed: &ComputedTrajectory<'_>) -> Page {
        plane_page(source.scene, computed)
    }

    #[cfg(feature = "output")]
    fn report(
        source: &RowSource<'_, '_, Self>,
        computed: &ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Outcome, StudyError> {
        report(source.scene, computed, span)
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
