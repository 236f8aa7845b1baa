//! Reactions within mechanisms that bodies of varying inertia stand for.

use crate::models::PreparedScene;
use crate::reduce::compute::coefficient_units;
use dwell_findings::Column;

impl PreparedScene<'_> {
    /// a and b of the reactions within mechanisms that bodies of varying inertia stand for: at unit acceleration and at unit
    /// speed of the coordinate.
    pub(crate) fn reactions_of_varying_inertias(&self, q: &[f64]) -> Vec<(Column, Vec<f64>)> {
        let scene = self.scene;
        let mut columns = Vec::new();
        for varying in &scene.varying_inertias {
            for reaction in &varying.reactions {
                let unit = if reaction.is_moment { "N m" } else { "N" };
                let units = coefficient_units(unit, self.is_angle());
                let [a, b] = [("a", units[0]), ("b", units[1])]
                    .map(|(of, unit)| Column::new(format!("{}.{of}", reaction.name), unit));
                columns.extend([(a, Vec::new()), (b, Vec::new())]);
            }
        }
        let model = self.model.model();
        let mut workspace = model.workspace();
        let positions: &[f64] = if columns.is_empty() { &[] } else { q };
        for &q in positions {
            // The batch has found a pose at every coordinate.
            let Ok(mut state) = model.kinematic_state(&[q], &[1.0], &mut workspace) else {
                continue;
            };
            let states = state.bodies_at(&[0.0]);
            let mut values = columns.iter_mut().map(|(_, values)| values);
            for varying in &scene.varying_inertias {
                let body = states.body(varying.body);
                let (angle, ratio) = (body.rotation.angle(), body.angular_velocity);
                for reaction in &varying.reactions {
                    let a = reaction.value(angle, 0.0, ratio);
                    let b = reaction.value(angle, ratio, body.angular_acceleration);
                    for value in [a, b] {
                        if let Some(values) = values.next() {
                            values.push(value);
                        }
                    }
                }
            }
        }
        columns
    }
}
