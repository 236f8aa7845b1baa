//! The degrees of freedom of a model as drawn, by the rank of its constraints.

use crate::model::{GROUND, Joint, Kind, Model};
use crate::pose::{Vector, add, cross, perpendicular, scaled, sub, unit};
use std::f64::consts::TAU;

/// Pivots below this are zero.
const ZERO: f64 = 1e-7;
const NONE: Vector = [0.0; 3];

/// The degrees of freedom, without those of bodies between two balls about their line.
pub(crate) fn freedoms(model: &Model) -> usize {
    let count = 6 * model.bodies.len();
    let of_joint = |joint| move |[u, w]: [Vector; 2]| row(count, joint, u, w);
    let joints = model.joints.iter();
    let mut rows: Vec<Vec<f64>> = joints
        .flat_map(|joint| constraints(joint).into_iter().map(of_joint(joint)))
        .collect();
    for coupling in &model.couplings {
        let joints = [coupling.dependent, coupling.independent].map(|k| &model.joints[k]);
        let [_, slope] = coupling.at(joints[1].drawn);
        let rates = joints.map(|joint| match joint.is_angle() {
            true => row(count, joint, NONE, joint.axis()),
            false => row(count, joint, joint.axis(), NONE),
        });
        let both = rates[0].iter().zip(&rates[1]);
        rows.push(both.map(|(a, b)| a - slope * b).collect());
    }
    let bodies = (1..model.bodies.len()).filter(|body| model.has(*body));
    let is_idle = |body: &usize| {
        let touching = |joint: &&Joint| joint.bodies().contains(body);
        let mut joints = model.joints.iter().filter(touching);
        joints.clone().count() == 2 && joints.all(|joint| joint.kind == Kind::Ball)
    };
    let idle = bodies.clone().filter(is_idle).count();
    (6 * bodies.count()).saturating_sub(rank(rows) + idle)
}

/// The row u·v of the relative velocity at the joint's point, plus w·ω of the relative angular velocity.
fn row(count: usize, joint: &Joint, u: Vector, w: Vector) -> Vec<f64> {
    let mut row = vec![0.0; count];
    let moment = add(cross(joint.origin(), u), w);
    for (body, sign) in joint.bodies().into_iter().zip([-1.0, 1.0]) {
        for k in (0..3).filter(|_| body != GROUND) {
            row[6 * body + k] += sign * u[k];
            row[6 * body + 3 + k] += sign * moment[k];
        }
    }
    row
}

/// The directions u and w of the rows of a joint.
fn constraints(joint: &Joint) -> Vec<[Vector; 2]> {
    let axis = joint.axis();
    let x = perpendicular(axis);
    let all = [x, cross(axis, x), axis];
    let (points, turns): (&[Vector], &[Vector]) = match joint.kind {
        Kind::Fixed => (&all, &all),
        Kind::Hinge => (&all, &all[..2]),
        Kind::Slide => (&all[..2], &all),
        Kind::Cylinder | Kind::Screw(_) => (&all[..2], &all[..2]),
        Kind::Ball | Kind::Universal => (&all, &[]),
        Kind::Planar => (&all[2..], &all[..2]),
        Kind::Distance(_) => (&[], &[]),
    };
    let mut rows: Vec<[Vector; 2]> = points.iter().map(|u| [*u, NONE]).collect();
    rows.extend(turns.iter().map(|w| [NONE, *w]));
    let first = joint.ends[0].frame;
    match joint.kind {
        Kind::Screw(pitch) => rows.push([axis, scaled(axis, -pitch / TAU)]),
        Kind::Universal => rows.push([NONE, cross(first.turn.column(2), axis)]),
        Kind::Distance(_) => {
            let along = sub(joint.origin(), first.origin);
            rows.push([unit(along).unwrap_or(axis), NONE]);
        }
        _ => {}
    }
    rows
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
        let pivot = &above[rank][column..];
        for other in below.iter_mut().filter(|other| other[column] != 0.0) {
            let factor = other[column] / pivot[0];
            let rest = other[column..].iter_mut().zip(pivot);
            rest.for_each(|(a, b)| *a -= factor * b);
        }
        rank += 1;
    }
    rank
}
