//! A scene in space, for all analyses.

use super::check;
use super::export::{fit_in_space, several_freedoms_error};
use super::prepared::PreparedSpaceScene;
use super::trajectory::space_page;
use super::views::page_drawing;
use crate::explain::StudyError;
use crate::export::ExportRequest;
use crate::study_scene::StudyScene;
use crate::trajectory::compute::{ComputedTrajectory, RowSource};
use dwell_export::{Export, SeveralFreedomsExport};
use dwell_findings::{Finding, Record};
use dwell_page::{Drawing, Page};
use dwell_scene::SpaceScene;
use dwell_symbolic::ClosedForm;
#[cfg(feature = "output")]
use {
    super::trajectory::{drawn_positions, figures},
    super::views::SpacePositions,
    crate::assembled::BodyStates,
    crate::explain::NamedScene as _,
    crate::output::{Outcome, Picture},
    crate::trajectory::document::{Document, contacts},
    crate::trajectory::figures::PictureSpan,
    crate::trajectory::output::outcome_of,
    dwell_geometry::space::{Placement, Rotation, vec3},
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

    fn page(source: &RowSource<'_, '_, Self>, computed: &ComputedTrajectory<'_>) -> Page {
        space_page(source, computed)
    }

    #[cfg(feature = "output")]
    fn report(
        source: &RowSource<'_, '_, Self>,
        computed: &ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Outcome, StudyError> {
        let (scene, size) = (source.scene, source.rows.model.plan().size());
        let swept = computed.trajectory.swept_actuator();
        let swept = swept.and_then(|k| scene.actuator(k));
        let positions = drawn_positions(source, computed, swept);
        let mut all_figures = vec![positions.figure()];
        all_figures.extend(figures(scene, swept, computed, span)?);
        let mut document = Document::of_file(&scene.file, size, computed);
        document.contacts = contacts(&scene.mechanism);
        let animation = positions.animation();
        let mut outcome = outcome_of(&scene.file, computed, &document, all_figures, animation)?;
        outcome.run = Some(Box::new(space_page(source, computed)));
        Ok(outcome)
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
