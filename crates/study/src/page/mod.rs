//! The contents of the page of a run, as plain data: rows, peaks and the moving mechanism. The module compiles without
//! pictures, for programs that show a page in their own document.

mod arrows;
mod columns;
mod plane;
mod tables;

pub(crate) use columns::{RowChoice, page_columns};
pub use tables::{drawing_along, table_page, unit_group};

use crate::number_format::count;
use crate::trajectory::column_extrema::{ColumnExtrema, searched_in_rows, sorted_extrema};
use crate::trajectory::compute::ComputedTrajectory;
pub(crate) use arrows::force_arrow;
use arrows::plane_arrows;
use dwell_page::{DisplayUnit, Page, PageMessage, PageScene, Peak};
use dwell_scene::{PlaneScene, SceneError, SceneFile};
pub(crate) use plane::paint;
use plane::plane_drawing;

/// The page of any command with its scene and without results.
///
/// ```
/// let text = r#"
/// bodies.ground.points = { O = [0, 0] }
/// bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
/// joints.O = { revolute = ["ground.O", "bob.O"] }
/// actuators.phi = { angle = ["ground", "bob"] }
/// "#;
/// let scene = dwell_scene::PlaneScene::parse("pendulum.toml", text)?;
/// let page = dwell_study::page::scene_page(&scene, "check");
/// assert_eq!(page.scene.map(|scene| scene.text), Some(text.to_owned()));
/// # Ok::<(), dwell_scene::SceneError>(())
/// ```
pub fn scene_page(scene: &SceneFile, command: &str) -> Page {
    let unit = |(si, is_angle): (&str, bool)| {
        let (factor, unit) = scene.to_scene_unit(1.0, is_angle);
        DisplayUnit {
            si: si.to_owned(),
            unit: unit.to_owned(),
            factor,
        }
    };
    Page {
        title: scene.title.clone(),
        command: command.to_owned(),
        note: scene.note.clone(),
        scene: Some(PageScene {
            name: scene.name.clone(),
            text: scene.source.inner().clone(),
            sha256: scene.hash(),
        }),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        units: [("rad", true), ("m", false)].map(unit).into(),
        messages: warnings(scene),
        ..Page::default()
    }
}

/// The warnings of a scene's file, with their places.
fn warnings(scene: &SceneFile) -> Vec<PageMessage> {
    let message = |warning: &dwell_scene::SceneWarning| PageMessage {
        severity: "warning".to_owned(),
        text: warning.message.clone(),
        help: None,
        span: None,
    };
    scene.warnings.iter().map(message).collect()
}

/// Errors as messages of a page.
pub fn error_messages<'a>(errors: impl IntoIterator<Item = &'a SceneError>) -> Vec<PageMessage> {
    let message = |error: &SceneError| PageMessage {
        severity: "error".to_owned(),
        text: error.message.clone(),
        help: error.help.clone(),
        span: None,
    };
    let all = errors.into_iter().flat_map(SceneError::errors);
    all.map(message).collect()
}

/// The page of a trajectory in the plane, without the printed text.
pub(crate) fn plane_page(scene: &PlaneScene, computed: &ComputedTrajectory<'_>) -> Page {
    let results = &computed.results;
    let mut page = run_page(&scene.file, scene.mechanism.size(), computed);
    let choice = RowChoice::new(results);
    let (poses, modelled) = (&results.body_poses, &results.modelled);
    let arrows = plane_arrows(scene, results);
    page.drawing = Some(plane_drawing(scene, poses, modelled, &choice, arrows));
    page
}

/// The page without the mechanism, for any scene with a mechanism of this size, m.
pub(crate) fn run_page(scene: &SceneFile, size: f64, computed: &ComputedTrajectory<'_>) -> Page {
    let (trajectory, results) = (&computed.trajectory, &computed.results);
    let choice = RowChoice::new(results);
    let abscissa = results.abscissa(trajectory);
    let extrema = sorted_extrema(results, &results.written, abscissa, size);
    let peak = |of: ColumnExtrema| {
        let column = results.written.iter();
        let mut column = column.map(|&k| &results.columns[k].name);
        Some(Peak {
            column: column.position(|name| *name == of.name)?,
            ends: of.ends.map(|end| [end.value, end.at]),
            error: (of.error > 0.0).then_some(of.error),
        })
    };
    let of_rows = "These are the largest values of the rows: the motion has too many steps to look between them.";
    let (reached, points) = (results.len(), trajectory.points);
    let mut positions = count(points, "position");
    if reached != points {
        positions = format!("{reached} of {positions}");
    }
    Page {
        subtitle: format!("{positions} over {}", trajectory.description),
        method: trajectory.method_text.clone(),
        axis: results.written.iter().position(|&k| k == abscissa),
        columns: page_columns(results, &choice),
        rows_note: choice.note(reached),
        peaks: extrema.into_iter().filter_map(peak).collect(),
        peaks_note: if results.extrema.are_between_rows() {
            searched_in_rows(results)
        } else {
            Some(of_rows.to_owned())
        },
        ..scene_page(scene, trajectory.analysis.command())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute_trajectory;
    use crate::progress::no_progress;
    use crate::trajectory::compute::Analysis;
    use dwell_page::{Anchor, Direction, Drawing, Part};

    fn page_of(name: &str) -> Page {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        let scene = PlaneScene::read(format!("{folder}/{name}/scene.toml")).expect("a scene");
        let analysis = Analysis::Kinetostatics;
        let computed =
            compute_trajectory(&scene, analysis, Some(25), &no_progress).expect("a trajectory");
        plane_page(&scene, &computed)
    }

    fn column<'p>(page: &'p Page, key: &str) -> &'p [f64] {
        let mut columns = page.columns.iter();
        &columns.find(|c| c.key == key).expect("a column").values
    }

    /// Where a point is, by the placements of the drawing.
    fn place(drawing: &Drawing, at: &Anchor, row: usize) -> [f64; 2] {
        let [x, y] = [at.point[0], at.point[1]];
        let [ox, oy, angle] = match &drawing.bodies[at.body].placements[..] {
            [] => [0.0; 3],
            all => [0, 1, 2].map(|k| all[k][row]),
        };
        let (sin, cos) = angle.sin_cos();
        [ox + cos * x - sin * y, oy + sin * x + cos * y]
    }

    #[test]
    fn points_of_the_drawing_are_where_the_columns_say() {
        let page = page_of("slider-crank");
        let drawing = page.drawing.as_ref().expect("a drawing");
        let path = drawing.paths.iter().find(|p| p.name == "crank.B");
        let path = path.expect("a path");
        let columns = ["crank.B.x", "crank.B.y"].map(|key| column(&page, key));
        for (row, (x, y)) in columns[0].iter().zip(columns[1]).enumerate() {
            let at = place(drawing, &path.at, row);
            assert!((at[0] - x).hypot(at[1] - y) < 1e-12, "row {row}");
        }
    }

    #[test]
    fn the_two_bodies_of_every_pin_meet_there_in_every_row() {
        for name in ["slider-crank", "press"] {
            let page = page_of(name);
            let drawing = page.drawing.as_ref().expect("a drawing");
            let arrows = drawing.arrows.iter();
            let pins = arrows.filter(|a| matches!(a.direction, Direction::Components { .. }));
            let mut count = 0;
            for arrow in pins {
                // The arrow is on the second body, the pin on the first.
                let pin = drawing.parts.iter().find_map(|part| match part {
                    Part::Mark(mark) if mark.title.starts_with(&format!("{} (", arrow.name)) => {
                        Some(mark)
                    }
                    _ => None,
                });
                let pin = pin.expect("a pin");
                count += 1;
                for row in 0..25 {
                    let [a, b] = [&pin.at, &arrow.at].map(|at| place(drawing, at, row));
                    assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{name} {row}");
                }
            }
            assert!(count >= 3, "{name} has {count} pins");
        }
    }

    #[test]
    fn an_arrow_refers_to_the_columns_of_its_joint_and_peaks_to_their_own() {
        let page = page_of("slider-crank");
        let arrows = &page.drawing.as_ref().expect("a drawing").arrows;
        let arrow = arrows.iter().find(|a| a.name == "A").expect("an arrow");
        let Direction::Components { columns } = &arrow.direction else {
            panic!("a pin has two components");
        };
        let keys: Vec<&str> = columns
            .iter()
            .map(|&k| page.columns[k].key.as_str())
            .collect();
        assert_eq!(keys, ["A.x", "A.y"]);
        for peak in &page.peaks {
            let values = &page.columns[peak.column].values;
            let [low, high] = peak.ends.map(|[value, _]| value);
            // What is zero but for rounding is said to be zero.
            if low == 0.0 && high == 0.0 {
                assert!(values.iter().all(|v| v.abs() < 1e-9));
                continue;
            }
            let slack = 1e-9 * low.abs().max(high.abs());
            // A value between the rows is no less extreme than those of the rows.
            assert!(
                values
                    .iter()
                    .all(|v| v.is_nan() || (*v >= low - slack && *v <= high + slack))
            );
        }
        assert_eq!(page.columns[page.axis.expect("an axis")].key, "t");
    }
}
