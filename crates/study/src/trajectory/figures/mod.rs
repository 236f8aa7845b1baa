//! Figures of a trajectory: mechanism, motion, forces, power, internal forces; and the animation.

mod charts;
mod forces;
mod free;
mod last_revolution;
mod motion;
mod span;

pub(crate) use charts::{ChartContext, describe_abscissa};
pub use span::PictureSpan;

use crate::bodies::{BodyPose, point_position};
use crate::explain::{NamedScene as _, StudyError};
use crate::output::{MechanismDrawing, figure};
use crate::trajectory::compute::{ComputedTrajectory, Quantity, TrajectoryResults};
use dwell_report::{Animation, Axis, Drawing, Figure, Paint, Pen, Shape};
use dwell_scene::PlaneScene;
use std::ops::Deref;

/// Maximum number of curves in a chart.
pub(crate) const MAX_CURVES: usize = 8;
/// Maximum number of bodies whose angles are drawn if none is requested.
pub(crate) const MAX_BODIES: usize = 6;
/// Number of positions in which the mechanism is drawn.
const DRAWN_POSITIONS: usize = 6;
/// Maximum number of frames of the animation, and the duration of each.
const MAX_FRAMES: usize = 60;
const DELAY_MS: u32 = 60;
const WIDTH_PX: u32 = 640;

/// The common data of the figures of a trajectory of a scene in the plane.
pub(crate) struct FigureContext<'a> {
    scene: &'a PlaneScene,
    charts: ChartContext<'a>,
}

impl<'a> Deref for FigureContext<'a> {
    type Target = ChartContext<'a>;

    fn deref(&self) -> &ChartContext<'a> {
        &self.charts
    }
}

/// The figures of a trajectory without the animation, and a note if some are left out.
///
/// # Errors
/// [`StudyError::Scene`] where the span of the curves is not within the trajectory.
pub(crate) fn trajectory_figures(
    scene: &PlaneScene,
    computed: &ComputedTrajectory<'_>,
    span: PictureSpan,
) -> Result<(Vec<Figure>, Option<String>), StudyError> {
    let context = FigureContext::new(scene, computed, span)?;
    let mut figures = vec![context.mechanism(last_drawn(computed))];
    figures.extend(context.angles());
    figures.extend(context.paths());
    figures.extend(context.lengths());
    figures.extend(context.transmission());
    figures.extend(context.coordinates());
    figures.extend(context.actuator_forces());
    let (reactions, note) = context.reactions();
    figures.extend(reactions);
    figures.extend(context.shaking_force());
    figures.extend(context.power());
    figures.extend(context.drives(&scene.drives));
    figures.extend(context.energies());
    figures.extend(context.phase_portraits());
    let links = context.results.sectioned_links.iter();
    figures.extend(links.filter_map(|link| context.internal_forces(link)));
    Ok((figures, note))
}

/// The animation of the mechanism, with the requested paths.
///
/// # Errors
/// None: it shows the whole trajectory.
pub(crate) fn animation(
    scene: &PlaneScene,
    computed: &ComputedTrajectory<'_>,
) -> Result<Animation, StudyError> {
    let context = FigureContext::new(scene, computed, PictureSpan::default())?;
    let results = context.results;
    let drawing = MechanismDrawing::new(scene, &results.body_poses)
        .with_visible(&results.modelled)
        .with_paths(context.path_lines());
    let drawn = &results.body_poses[..=last_drawn(computed)];
    let frame = |k: usize| {
        let mut shapes = Vec::new();
        drawing.draw(&results.body_poses[k], 0.0, &mut shapes);
        // Moving labels would distract.
        shapes.retain(|s| !matches!(s, Shape::Text { .. }));
        plane(context.describe_position(k), shapes)
    };
    let provenance = &context.method_text;
    Ok(animated(drawn.len(), is_closed(drawn), frame, provenance))
}

/// The animation of a mechanism in `count` positions, of which the last equals the first if `is_closed`, that is, over a
/// whole period.
pub(crate) fn animated(
    positions: usize,
    is_closed: bool,
    frame: impl Fn(usize) -> Drawing,
    provenance: &str,
) -> Animation {
    let last = positions.saturating_sub(1);
    let count = MAX_FRAMES.min(positions);
    let steps = count.saturating_sub(usize::from(!is_closed));
    let frames = (0..count).map(|i| frame((i * last) / steps.max(1)));
    Animation {
        name: "mechanism".to_owned(),
        frames: frames.collect(),
        delay_ms: DELAY_MS,
        width_px: WIDTH_PX,
        provenance: provenance.to_owned(),
    }
}

/// The last position that is drawn: the end of the trajectory, or of the first period of the only actuator.
fn last_drawn(computed: &ComputedTrajectory<'_>) -> usize {
    let results = &computed.results;
    let end_of_period = || {
        let k = results.column_index(Quantity::ActuatorCoordinate(0, 0))?;
        let rows = results.rows.iter();
        let mut rotated = rows.map(|row| (row[k] - results.rows[0][k]).abs());
        // Up to rounding.
        let full = computed.trajectory.period? * (1.0 - 1e-9);
        rotated.position(|q| q >= full)
    };
    end_of_period().unwrap_or(results.body_poses.len().saturating_sub(1))
}

/// Whether the last position equals the first.
fn is_closed(body_poses: &[Vec<BodyPose>]) -> bool {
    let [first, _, .., last] = body_poses else {
        return false;
    };
    let size = first.iter().map(|(p, _)| p.norm()).fold(0.0, f64::max);
    let same = |(a, b): (&BodyPose, &BodyPose)| {
        (a.0 - b.0).norm() <= 1e-6 * size && (a.1 - b.1).norm() <= 1e-6
    };
    first.iter().zip(last).all(same)
}

impl<'a> FigureContext<'a> {
    fn new(
        scene: &'a PlaneScene,
        computed: &'a ComputedTrajectory<'_>,
        span: PictureSpan,
    ) -> Result<Self, StudyError> {
        let swept = computed.trajectory.swept_actuator();
        let swept = swept.and_then(|k| scene.actuator(k));
        let charts = ChartContext::new(&scene.file, swept, computed, span)?;
        Ok(Self { scene, charts })
    }

    /// The requested paths.
    fn path_lines(&self) -> Vec<Shape> {
        let path = |path: &dwell_scene::PathPoint| {
            let poses = self.results.body_poses.iter();
            let points = poses.map(|pose| point_position(pose, path.body.0, path.at));
            let pen = Pen::new(Paint::Ink, 2.0).lightness(0.55);
            Shape::line(points.collect(), pen).named("paths")
        };
        self.scene.requests.paths.iter().map(path).collect()
    }

    /// The mechanism in several positions up to the `last`th.
    fn mechanism(&self, last: usize) -> Figure {
        let drawing = MechanismDrawing::new(self.scene, &self.results.body_poses)
            .with_visible(&self.results.modelled)
            .with_paths(self.path_lines());
        let body_poses = &self.results.body_poses[..=last];
        let mut shapes = Vec::new();
        let drawn = DRAWN_POSITIONS - usize::from(!is_closed(body_poses));
        for k in (1..DRAWN_POSITIONS.min(body_poses.len())).rev() {
            let lightness = 0.62 + 0.04 * k as f64;
            drawing.draw(&body_poses[k * last / drawn], lightness, &mut shapes);
        }
        if let Some(first) = body_poses.first() {
            drawing.draw(first, 0.0, &mut shapes);
        }
        let unmodelled = match self.results.unmodelled_bodies(self.scene) {
            none if none.is_empty() => String::new(),
            bodies => {
                let bodies = bodies.join(", ");
                format!(" Not modelled, as no result depends on them: {bodies}.")
            }
        };
        let text = format!(
            "Drawn in full at {}, lighter further on.{unmodelled}",
            self.describe_position(0)
        );
        let panels = vec![plane(String::new(), shapes).into()];
        let (scene, title) = (self.scene, &self.scene.title);
        figure(scene, "mechanism", title, &text, panels, &self.method_text)
    }
}

/// A drawing in the plane of the mechanism.
pub(crate) fn plane(title: String, shapes: Vec<Shape>) -> Drawing {
    Drawing {
        title,
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes,
        ..Drawing::default()
    }
}

impl TrajectoryResults {
    /// The bodies that are not modelled, because nothing needs them.
    pub(crate) fn unmodelled_bodies(&self, scene: &PlaneScene) -> Vec<String> {
        let bodies = scene.mechanism.bodies.iter().zip(&self.modelled);
        let unmodelled = bodies.filter(|(_, modelled)| !**modelled);
        unmodelled.map(|(body, _)| body.name.clone()).collect()
    }
}
