//! Pages of results that are a table over a coordinate or time, and the mechanism at coordinates.

use super::columns::RowChoice;
use super::plane::plane_drawing;
use crate::bodies::{BodyPose, body_poses};
use crate::models::loaded_model;
use dwell_findings::Table;
use dwell_geometry::body_states::BodyStates;
use dwell_page::{Drawing, Page, PageColumn, Peak};
use dwell_scene::PlaneScene;

/// A page with the rows of a table whose first column is the axis. `group` returns the chart group of a column, and its
/// description.
pub fn table_page(
    page: Page,
    table: &Table,
    group: impl Fn(&str, &str) -> (String, String),
) -> Page {
    let choice = RowChoice::of(table.rows.len(), table.columns.len());
    let column = |(k, of): (usize, &dwell_findings::Column)| {
        let (group, description) = group(&of.name, &of.unit);
        PageColumn {
            group,
            description,
            ..PageColumn::new(
                &of.name,
                &of.unit,
                choice.map(&table.rows, |row: &Vec<f64>| row[k]),
            )
        }
    };
    let columns: Vec<PageColumn> = table.columns.iter().enumerate().map(column).collect();
    Page {
        axis: (!table.rows.is_empty()).then_some(0),
        peaks: (1..columns.len())
            .filter_map(|k| row_peak(table, k))
            .collect(),
        peaks_note: Some("These are the largest values of the rows.".to_owned()),
        rows_note: choice.note(table.rows.len()),
        columns,
        ..page
    }
}

/// The smallest and the largest value of a column in its rows; of equal ones the first.
fn row_peak(table: &Table, column: usize) -> Option<Peak> {
    let all = table.rows.iter().map(|row| [row[column], row[0]]);
    let all = all.filter(|[value, _]| !value.is_nan());
    let least = |a: [f64; 2], b: [f64; 2]| if b[0] < a[0] { b } else { a };
    let most = |a: [f64; 2], b: [f64; 2]| if b[0] > a[0] { b } else { a };
    let ends = [all.clone().reduce(least)?, all.reduce(most)?];
    Some(Peak {
        column,
        ends,
        error: None,
    })
}

/// A chart group by the unit alone.
pub fn unit_group(_: &str, unit: &str) -> (String, String) {
    let group = match unit {
        "rad" | "m" => "Coordinates",
        "rad/s" | "m/s" => "Speeds",
        "rad/s2" | "m/s2" => "Accelerations",
        "N" | "N m" => "Forces",
        "J" => "Energies and works",
        "s" => "Time",
        _ => "Results",
    };
    (group.to_owned(), String::new())
}

/// The mechanism at values of the only actuator's coordinate, rad or m, one for each row of a page; `None` if a position cannot
/// be reached.
pub fn drawing_along(scene: &PlaneScene, coordinate: &[f64]) -> Option<Drawing> {
    let model = loaded_model(scene).ok()?;
    let plan = model.plan();
    let mut pose = plan.pose();
    let mut motion = plan.motion();
    let mut states = BodyStates::new(plan);
    let rest = [0.0];
    if plan.actuators() != rest.len() {
        return None;
    }
    let mut poses: Vec<Vec<BodyPose>> = Vec::with_capacity(coordinate.len());
    for &q in coordinate {
        plan.positions(&[q], &mut pose).ok()?;
        plan.velocities(&pose, &rest, &mut motion);
        states.fill_velocities(plan, &pose, &motion);
        poses.push(body_poses(&states, &scene.mechanism));
    }
    let modelled = plan.placed_bodies();
    let choice = RowChoice::all(poses.len());
    let drawing = plane_drawing(scene, &poses, &modelled, &choice, Vec::new());
    Some(drawing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_findings::Column;

    #[test]
    fn peaks_of_a_table_are_its_rows_and_skip_what_is_absent() {
        let table = Table {
            columns: vec![Column::new("q", "rad"), Column::new("m", "kg m2")],
            rows: vec![
                vec![0.0, f64::NAN],
                vec![1.0, 3.0],
                vec![2.0, -1.0],
                vec![3.0, 3.0],
            ],
        };
        let peak = row_peak(&table, 1).expect("a peak");
        assert_eq!(peak.ends, [[-1.0, 2.0], [3.0, 1.0]]);
        let empty = Table {
            rows: vec![vec![0.0, f64::NAN]],
            ..table
        };
        assert!(row_peak(&empty, 1).is_none());
    }
}
