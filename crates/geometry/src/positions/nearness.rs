//! How near a pose is to a singular position.

use crate::plan::{GroupKind, Plan, Pose};
use dwell_numerics::qr::relative_volume;

impl Plan {
    /// The least determinant of a group's Jacobian over the lengths of its columns: 1 where all columns are perpendicular, 0 in a singular
    /// position; for a dyad with revolute joints the sine of its transmission angle. It is 1 without groups.
    pub fn least_relative_determinant(&self, pose: &Pose<f64>) -> f64 {
        let mut memory = pose.clone();
        let groups = self.groups.iter().enumerate();
        let groups = groups.filter(|(_, assur)| !assur.pruned);
        let each = groups.map(|(g, assur)| match &assur.kind {
            GroupKind::RrrDyad(dyad) => {
                let [one, two] = dyad.vectors.map(|vector| pose.vector[vector]);
                one.cross(two).abs() / (one.norm() * two.norm())
            }
            GroupKind::GuidedPoint(guided) if guided.line_rotates => {
                let line = pose.vector[guided.found_vector].perp();
                let known = guided.known.iter().map(|(vector, _)| pose.vector[*vector]);
                let known = known.fold(guided.fixed, |sum, vector| sum + vector);
                known.cross(line).abs() / (known.norm() * line.norm())
            }
            GroupKind::GuidedPoint(guided) => {
                let vector = pose.vector[guided.found_vector];
                let along = pose.vector[guided.axis.0];
                vector.dot(along).abs() / (vector.norm() * along.norm())
            }
            GroupKind::Factored(factored) => {
                self.assemble_jacobian(g, factored, &mut memory);
                let jacobian = &mut memory.lu[factored.lu_range()];
                relative_volume(jacobian, factored.rows, factored.columns)
            }
        });
        each.fold(1.0, f64::min)
    }
}
