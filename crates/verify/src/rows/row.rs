//! One scalar equation: a sum of terms, a pair of gears, or a coupling by a law.

use super::coupling::Coupling;
use super::gear::Gear;
use super::mesh::Mesh;
use super::terms::{Ends, Gradient, Term, couple};
use crate::pose::{Pose, Twist};
use dwell_geometry::space::Vec3;

/// One row. An imposed value is subtracted from each.
#[derive(Debug, Clone)]
pub(crate) enum Row {
    /// Σ factor × term − constant; with a period, to its nearest multiple.
    Sum {
        terms: Vec<(f64, Term)>,
        constant: f64,
        period: Option<f64>,
    },
    /// The teeth of gears in the plane.
    Gear(Gear),
    /// The teeth of gears in space.
    Mesh(Mesh),
    /// dependent − law(independent).
    Coupling(Box<Coupling>),
    /// ω·u = 0 of a body with an idle rotation about u, fixed in it: it is held from turning about u.
    Idle(usize, Vec3),
}

/// The configuration from which the rows of velocities are counted: gears of space stood right there, no wheel or idle body has turned by
/// half a revolution since, and the rows had these values.
#[derive(Clone, Copy)]
pub(crate) struct Since<'a> {
    pub(crate) poses: &'a [Pose],
    pub(crate) row_values: &'a [f64],
}

impl Row {
    /// term − constant.
    pub(crate) fn single(term: Term, constant: f64) -> Self {
        Self::Sum {
            terms: vec![(1.0, term)],
            constant,
            period: None,
        }
    }

    /// term − constant, to the nearest multiple of a period.
    pub(crate) fn periodic(term: Term, constant: f64, period: f64) -> Self {
        Self::Sum {
            terms: vec![(1.0, term)],
            constant,
            period: Some(period),
        }
    }

    /// Calls `term` for every term of the row, with the row's derivative by it.
    fn each_term(&self, poses: &[Pose], mut term: impl FnMut(f64, &Term)) {
        match self {
            Self::Sum { terms, .. } => terms.iter().for_each(|(f, m)| term(*f, m)),
            Self::Gear(gear) => gear.terms().iter().for_each(|(f, m)| term(*f, m)),
            Self::Mesh(_) | Self::Idle(..) => {}
            Self::Coupling(coupling) => {
                let [dependent, independent] = &coupling.both;
                term(1.0, dependent);
                term(-coupling.slopes(poses)[0], independent);
            }
        }
    }

    /// The points of the row, to be given in other frames.
    pub(crate) fn each_ends(&mut self, mut change: impl FnMut(&mut Ends)) {
        let mut of_term = |term: &mut Term| {
            if let Some(ends) = term.ends_mut() {
                change(ends);
            }
        };
        match self {
            Self::Sum { terms, .. } => terms.iter_mut().for_each(|(_, term)| of_term(term)),
            Self::Gear(gear) => change(&mut gear.ends),
            Self::Mesh(mesh) => change(&mut mesh.pitch),
            Self::Idle(..) => {}
            Self::Coupling(coupling) => coupling.both.iter_mut().for_each(of_term),
        }
    }

    /// Calls `add` with the gradient by each of the bodies.
    pub(crate) fn each_gradient(&self, poses: &[Pose], mut add: impl FnMut(usize, f64, Gradient)) {
        match self {
            Self::Mesh(mesh) => {
                let gradients = mesh.gradients(poses);
                for (body, gradient) in mesh.wheels.into_iter().zip(gradients) {
                    add(body, 1.0, gradient);
                }
            }
            Self::Idle(body, u) => add(*body, 1.0, couple(poses[*body].rotation.apply(*u))),
            Self::Sum { .. } | Self::Gear(_) | Self::Coupling(..) => {}
        }
        self.each_term(poses, |factor, term| {
            let gradients = term.gradients(poses);
            for (body, gradient) in term.bodies().into_iter().zip(gradients) {
                add(body, factor, gradient);
            }
        });
    }

    /// Calls `add` with the gradient of what acts in its own joint: of a coupling, its dependent coordinate alone.
    pub(crate) fn each_own_gradient(
        &self,
        poses: &[Pose],
        mut add: impl FnMut(usize, f64, Gradient),
    ) {
        let Self::Coupling(coupling) = self else {
            return self.each_gradient(poses, add);
        };
        let dependent = &coupling.both[0];
        let gradients = dependent.gradients(poses);
        for (body, gradient) in dependent.bodies().into_iter().zip(gradients) {
            add(body, 1.0, gradient);
        }
    }

    /// How far row k is from its imposed value.
    pub(crate) fn residual(&self, poses: &[Pose], since: Since<'_>, k: usize, imposed: f64) -> f64 {
        let moved = imposed - since.row_values[k];
        match self {
            Self::Sum {
                terms,
                constant,
                period,
            } => {
                let sum: f64 = terms.iter().map(|(f, m)| f * m.value(poses)).sum();
                let residual = sum - constant - imposed;
                match period {
                    Some(period) => residual - period * (residual / period).round(),
                    None => residual,
                }
            }
            Self::Gear(gear) => gear.residual(poses, imposed),
            Self::Mesh(mesh) => mesh.travel(since.poses, poses) - moved,
            Self::Idle(body, u) => {
                let (before, now) = (since.poses[*body].rotation, poses[*body].rotation);
                let turn = now.after(&before.inverse()).vector();
                turn.dot(now.apply(*u)) - moved
            }
            Self::Coupling(coupling) => coupling.residual(poses, imposed),
        }
    }

    /// J̇ẋ.
    pub(crate) fn velocity_product(&self, poses: &[Pose], twists: &[Twist]) -> f64 {
        if let Self::Mesh(mesh) = self {
            return mesh.velocity_product(poses, twists);
        }
        let mut sum = 0.0;
        self.each_term(poses, |factor, term| {
            sum += factor * term.second_rate(poses, twists);
        });
        if let Self::Coupling(coupling) = self {
            let rate = coupling.both[1].rate(poses, twists);
            sum -= coupling.slopes(poses)[1] * rate * rate;
        }
        sum
    }
}
