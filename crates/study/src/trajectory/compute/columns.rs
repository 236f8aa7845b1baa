//! The columns of a trajectory table, each with its unit and meaning.

use crate::trajectory::compute::{Column, ColumnList, Quantity, RowScene, units};
use dwell_geometry::BodyId;

/// Every column of a scene, whatever the analysis; with the time if `timed`.
pub(crate) fn all_columns<S: RowScene>(scene: &S, rows: &S::Rows, timed: bool) -> Vec<Column> {
    let (layout, model) = (S::LAYOUT, S::model_of(rows));
    let mut list = ColumnList::new(timed);
    for i in 0..scene.assembly_coordinates().len() {
        let [meaning, force] = scene.actuator_meanings(i);
        let (name, is_angle) = scene.actuator(i).unwrap_or_default();
        list.add_actuator(i, name, is_angle, [&meaning, &force]);
    }
    for (k, measured) in scene.measured(model).into_iter().enumerate() {
        if measured.function.is_some() {
            let (name, quantity) = (&measured.name, |order| Quantity::Measured(k, order));
            list.add_with_derivatives(name, measured.is_angle, quantity, &measured.meaning);
        }
    }
    let bodies = scene.named_points();
    let moving = scene.moving_bodies();
    for &id in &moving {
        let (name, points) = &bodies[id.0];
        for (order, (word, meaning)) in layout.rotation.into_iter().enumerate() {
            for &(axis, ending) in layout.turns {
                let quantity = Quantity::Rotation(id, order, axis);
                let name = format!("{name}.{word}{ending}");
                list.add(name, units(true)[order], quantity, meaning);
            }
        }
        scene.add_body_columns(model, id, &mut list);
        for (point, at) in points {
            for (order, letter) in ["", "v", "a"].into_iter().enumerate() {
                for (axis, of) in layout.axes.iter().enumerate() {
                    let quantity = Quantity::Point(id, *at, order, axis);
                    let name = format!("{name}.{point}.{letter}{of}");
                    list.add(name, units(false)[order], quantity, "");
                }
            }
        }
    }
    scene.add_joint_columns(rows, &mut list);
    scene.add_load_columns(model, &mut list);
    let ground = (0..bodies.len()).find(|&b| !moving.contains(&BodyId(b)));
    list.add_totals(ground.map_or("", |b| bodies[b].0), layout.shaking);
    for column in &mut list.0 {
        let is_angle = column.unit == "rad"
            && matches!(
                column.quantity,
                Quantity::Rotation(_, 0, _) | Quantity::Measured(_, 0)
            );
        column.unwraps = layout.unwraps_angles && is_angle;
    }
    list.0
}
