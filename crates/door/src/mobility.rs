//! The degrees of freedom of a model as drawn, by the rank of its constraints.

use crate::model::{GROUND, Joint, Kind, Model};
use crate::pose::{Vector, cross, perpendicular, scaled, sub, unit};

/// Pivots below this are zero; lengths are relative to the size of the model.
const ZERO: f64 = 1e-7;

/// The degrees of freedom, without those of bodies between two balls about their line.
pub(crate) fn freedoms(model: &Model) -> usize {
    let mut number = vec![None; model.bodies.len()];
    let mut bodies = 0;
    for joint in &model.joints {
        for body in [joint.first.body, joint.second.body] {
            if body != GROUND && number[body].is_none() {
                number[body] = Some(bodies);
                bodies += 1;
            }
        }
    }
    let rows = Rows {
        model,
        number: &number,
        columns: 6 * bodies,
    };
    let mut all: Vec<Vec<f64>> = model
        .joints
        .iter()
        .flat_map(|joint| rows.of_joint(joint))
        .collect();
    for coupling in &model.couplings {
        let [dependent, independent] =
            [coupling.dependent, coupling.independent].map(|k| &model.joints[k]);
        let [_, slope] = coupling.at(independent.drawn);
        let other = rows.rate(independent);
        all.push(
            rows.rate(dependent)
                .iter()
                .zip(other)
                .map(|(a, b)| a - slope * b)
                .collect(),
        );
    }
    let idle = (1..model.bodies.len()).filter(|body| {
        let of = |joint: &&Joint| joint.first.body == *body || joint.second.body == *body;
        let joints: Vec<_> = model.joints.iter().filter(of).collect();
        joints.len() == 2 && joints.iter().all(|joint| joint.kind == Kind::Ball)
    });
    (6 * bodies).saturating_sub(rank(all) + idle.count())
}

struct Rows<'m> {
    model: &'m Model,
    number: &'m [Option<usize>],
    columns: usize,
}

impl Rows<'_> {
    /// The row u·v of the relative velocity at a point, plus w·ω of the relative angular velocity.
    fn row(&self, joint: &Joint, point: Vector, u: Vector, w: Vector) -> Vec<f64> {
        let mut row = vec![0.0; self.columns];
        for (body, sign) in [(joint.first.body, -1.0), (joint.second.body, 1.0)] {
            let Some(at) = self.number[body] else {
                continue;
            };
            let moment = cross(point, u);
            for k in 0..3 {
                row[6 * at + k] += sign * u[k];
                row[6 * at + 3 + k] += sign * (moment[k] + w[k]);
            }
        }
        row
    }

    fn of_joint(&self, joint: &Joint) -> Vec<Vec<f64>> {
        let [first, second] = [&joint.first, &joint.second].map(|end| self.model.drawn(end));
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
            Kind::OnLine => (&all[..2], &[]),
            Kind::InPlane => (&all[2..], &[]),
            Kind::Distance(_) => (&[], &[]),
        };
        let mut rows: Vec<_> = points
            .iter()
            .map(|u| self.row(joint, point, *u, [0.0; 3]))
            .collect();
        rows.extend(turns.iter().map(|w| self.row(joint, point, [0.0; 3], *w)));
        match joint.kind {
            Kind::Screw(pitch) => {
                let turn = scaled(axis, -pitch / std::f64::consts::TAU);
                rows.push(self.row(joint, point, axis, turn));
            }
            Kind::Universal => {
                rows.push(self.row(joint, point, [0.0; 3], cross(first.turn.column(2), axis)))
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
    while rank < rows.len() {
        let largest = |row: &Vec<f64>| {
            let entries = row.iter().enumerate().map(|(k, x)| (k, x.abs()));
            entries.fold(
                (0, 0.0),
                |most: (usize, f64), one| if one.1 > most.1 { one } else { most },
            )
        };
        let pivots = rows[rank..].iter().map(largest).enumerate();
        let (row, (column, size)) =
            pivots.fold(
                (0, (0, 0.0)),
                |most, one| if one.1.1 > most.1.1 { one } else { most },
            );
        if size < ZERO {
            break;
        }
        rows.swap(rank, rank + row);
        let (above, below) = rows.split_at_mut(rank + 1);
        let pivot = &above[rank];
        for other in below.iter_mut().filter(|other| other[column] != 0.0) {
            let factor = other[column] / pivot[column];
            for (a, b) in other.iter_mut().zip(pivot) {
                *a -= factor * b;
            }
        }
        rank += 1;
    }
    rank
}
