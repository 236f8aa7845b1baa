//! The degrees of freedom of a model as drawn, by the rank of its constraints.

use crate::model::{Joint, Kind, Model};
use crate::pose::{Vector, add, cross, perpendicular, scaled, sub, unit};

/// Pivots below this are zero; lengths are relative to the size of the model.
const ZERO: f64 = 1e-7;

/// The degrees of freedom, without those of bodies between two balls about their line.
pub(crate) fn freedoms(model: &Model) -> usize {
    let used = |body: &usize| model.joints.iter().any(|joint| joint.touches(*body));
    let bodies: Vec<usize> = (1..model.bodies.len()).filter(used).collect();
    let rows = Rows {
        model,
        bodies: &bodies,
    };
    let mut all: Vec<Vec<f64>> = model
        .joints
        .iter()
        .flat_map(|joint| rows.of_joint(joint))
        .collect();
    for coupling in &model.couplings {
        let joints = [coupling.dependent, coupling.independent].map(|k| &model.joints[k]);
        let [_, slope] = coupling.at(joints[1].drawn);
        let [one, other] = joints.map(|joint| rows.rate(joint));
        all.push(one.iter().zip(other).map(|(a, b)| a - slope * b).collect());
    }
    let idle = bodies.iter().filter(|body| {
        let mut joints = model.joints.iter().filter(|joint| joint.touches(**body));
        joints.clone().count() == 2 && joints.all(|joint| joint.kind == Kind::Ball)
    });
    (6 * bodies.len()).saturating_sub(rank(all) + idle.count())
}

struct Rows<'m> {
    model: &'m Model,
    bodies: &'m [usize],
}

impl Rows<'_> {
    /// The row u·v of the relative velocity at a point, plus w·ω of the relative angular velocity.
    fn row(&self, joint: &Joint, point: Vector, u: Vector, w: Vector) -> Vec<f64> {
        let mut row = vec![0.0; 6 * self.bodies.len()];
        for (end, sign) in joint.ends().into_iter().zip([-1.0, 1.0]) {
            if let Some(at) = self.bodies.iter().position(|body| *body == end.body) {
                let moment = add(cross(point, u), w);
                for k in 0..3 {
                    row[6 * at + k] += sign * u[k];
                    row[6 * at + 3 + k] += sign * moment[k];
                }
            }
        }
        row
    }

    fn of_joint(&self, joint: &Joint) -> Vec<Vec<f64>> {
        let [first, second] = joint.ends().map(|end| self.model.drawn(end));
        let (point, axis) = (second.origin, second.turn.column(2));
        let x = perpendicular(axis);
        let y = cross(axis, x);
        let all = [x, y, axis];
        let (points, turns): (&[Vector], &[Vector]) = match joint.kind {
            Kind::Fixed => (&all, &all),
            Kind::Hinge => (&all, &all[..2]),
            Kind::Slide => (&all[..2], &all),
            Kind::Cylinder | Kind::Screw(_) => (&all[..2], &all[..2]),
            Kind::Ball | Kind::Universal => (&all, &[]),
            Kind::Planar => (&all[2..], &all[..2]),
            Kind::Distance(_) => (&[], &[]),
        };
        let still = [0.0; 3];
        let mut rows: Vec<_> = points
            .iter()
            .map(|u| self.row(joint, point, *u, still))
            .collect();
        rows.extend(turns.iter().map(|w| self.row(joint, point, still, *w)));
        match joint.kind {
            Kind::Screw(pitch) => {
                let turn = scaled(axis, -pitch / std::f64::consts::TAU);
                rows.push(self.row(joint, point, axis, turn));
            }
            Kind::Universal => {
                rows.push(self.row(joint, point, [0.0; 3], cross(first.turn.column(2), axis)));
            }
            Kind::Distance(_) => {
                let along = unit(sub(second.origin, first.origin)).unwrap_or(axis);
                rows.push(self.row(joint, point, along, [0.0; 3]));
            }
            _ => {}
        }
        rows
    }

    /// The rate of a joint's coordinate.
    fn rate(&self, joint: &Joint) -> Vec<f64> {
        let second = self.model.drawn(&joint.second);
        let axis = second.turn.column(2);
        match joint.is_angle() {
            true => self.row(joint, second.origin, [0.0; 3], axis),
            false => self.row(joint, second.origin, axis, [0.0; 3]),
        }
    }
}

fn rank(mut rows: Vec<Vec<f64>>) -> usize {
    let mut rank = 0;
    for column in 0..rows.first().map_or(0, Vec::len) {
        let size = |row: &usize| rows[*row][column].abs();
        let pivot = (rank..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(row) = pivot.filter(|row| size(row) > ZERO) else {
            continue;
        };
        rows.swap(rank, row);
        let (above, below) = rows.split_at_mut(rank + 1);
        let pivot = &above[rank];
        for other in below.iter_mut().filter(|other| other[column] != 0.0) {
            let factor = other[column] / pivot[column];
            other
                .iter_mut()
                .zip(pivot)
                .skip(column)
                .for_each(|(a, b)| *a -= factor * b);
        }
        rank += 1;
    }
    rank
}
