//! The common basis of all checks: the mechanism closed densely at every position, its unit velocities there, and the
//! scales of differences.

use crate::case::Case;
use crate::comparison::{Comparison, LargestDifference};
use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use crate::error::{DenseError, Result};
use crate::pose::Pose;
use crate::subject::{Subject, SubjectError};
use dwell_kinetostatics::Coefficients;
use rayon::iter::Either;
use rayon::prelude::*;

/// The dense mechanism at one sampled position.
#[derive(Debug, Clone)]
pub struct CheckedPosition {
    /// The coordinate, rad.
    pub q: f64,
    /// The configuration, closed from the subject's pose.
    pub configuration: Configuration,
    /// How far closing moved the subject's pose, relative to the largest coordinate in it.
    pub closing_correction: f64,
    /// Unit velocities of every row, the actuator's last.
    pub unit_velocities: Vec<Vec<f64>>,
    /// The coefficients by dense velocities and accelerations, without any step.
    pub reference: Coefficients,
    /// How much rounding may have moved each of them.
    pub rounding_bound: Coefficients,
    /// How much rounding may have moved the pose, relative to the mechanism's size.
    pub pose_rounding_bound: f64,
    /// Condition number of the dense scaled rows.
    pub condition_number: f64,
}

/// The largest coefficients of each unit over all positions, by the dense side.
///
/// A coefficient may be zero throughout: the moment of a guide on a slider without inertia is. It is therefore compared
/// with the largest of its unit in the whole mechanism, including the actuator's coefficients m and ½m′, because τ is a
/// moment too. If a whole unit is zero (every force of a balanced flywheel), a small fraction of its size according to
/// the other coefficients is used, so that rounding is not divided by rounding.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scales {
    /// Largest m, kg m².
    pub m: f64,
    /// Largest part of m that bodies of varying inertia have; zero if none varies.
    pub m_varying: f64,
    /// Largest ½m′, kg m²/rad.
    pub half_dm: f64,
    /// Largest a of a force and of a moment.
    pub a: [f64; 2],
    /// Largest b of a force and of a moment.
    pub b: [f64; 2],
}

/// A case and its subject, ready to be checked.
pub struct CheckContext<'a> {
    /// The case.
    pub case: &'a Case<'a>,
    /// The checked subject.
    pub subject: &'a dyn Subject,
    /// The dense mechanism.
    pub dense: DenseMechanism,
    /// The positions that could be closed.
    pub positions: Vec<CheckedPosition>,
    /// Why the others could not.
    pub not_closed: Vec<(f64, String)>,
    /// The scales.
    pub scales: Scales,
    /// Bodies whose share in m changes over the positions.
    pub varying_bodies: Vec<usize>,
}

/// Where a whole unit is zero: b against a (both are per 1/s²), forces against moments per size.
const B_MIN_SHARE: f64 = 1e-4;
pub(crate) const FORCE_MIN_SHARE: f64 = 1e-6;
/// A share in m that changes by less than this of itself is constant.
const CONSTANT_SHARE_TOLERANCE: f64 = 1e-12;

impl<'a> CheckContext<'a> {
    /// Closes the mechanism at every position and measures the scales. A position that does not
    /// close is noted, not an error: the others are still checked.
    pub fn new(case: &'a Case<'a>, subject: &'a dyn Subject) -> Result<Self> {
        let dense = case.mechanism.dense()?;
        if dense.actuators.len() != 1 {
            return Err(DenseError::Actuators(dense.actuators.len()));
        }
        let dense = match case.positions.first().map(|&q| subject.poses(q)) {
            // Gears mesh as in the subject's first poses: from there on they must keep step.
            Some(Ok(poses)) => {
                let start = dense.moved_frames(&poses)?;
                dense.assembled(&start)?
            }
            _ => dense.squared()?,
        };
        let close = |&q: &f64| {
            let poses = subject.poses(q).map_err(|e| (q, e.to_string()))?;
            CheckedPosition::new(&dense, &poses, q).map_err(|e| (q, e.to_string()))
        };
        let closed = case.positions.par_iter().map(close);
        let (positions, not_closed): (Vec<_>, Vec<_>) = closed.partition_map(either);
        let varying_bodies = varying_bodies(&dense, &positions);
        let scales = scales(&dense, &positions, &varying_bodies);
        Ok(Self {
            case,
            subject,
            dense,
            positions,
            not_closed,
            scales,
            varying_bodies,
        })
    }

    /// `phi = 1.3 rad`.
    pub(crate) fn location(&self, q: f64) -> String {
        let name = &self.dense.actuator_names()[0];
        format!("{name} = {q:.6} {}", self.unit())
    }

    /// Unit of the coordinate.
    pub(crate) fn unit(&self) -> &'static str {
        if self.dense.is_angle_driven() {
            "rad"
        } else {
            "m"
        }
    }

    /// `phi = 1.3 rad, slide.normal`.
    pub(crate) fn reaction_location(&self, q: f64, reaction: usize) -> String {
        let name = &self.dense.row_names[reaction];
        format!("{}, {name}", self.location(q))
    }

    /// The checked positions in words.
    pub(crate) fn domain(&self) -> String {
        let range = match self.case.range.limits() {
            None => "over a full revolution".to_owned(),
            Some((low, high)) => format!("between {low:.6} and {high:.6} {}", self.unit()),
        };
        format!("{} positions {range}", self.positions.len())
    }

    /// By row of the joints: its multiplier from the values of all reactions. For a joint whose reactions are components of force and
    /// moment, their power if the row opens at unit speed.
    pub(crate) fn by_row(&self, at: &CheckedPosition, reactions: &[f64]) -> Vec<f64> {
        let (dense, poses) = (&self.dense, &at.configuration.poses);
        let mut rows = vec![0.0; dense.actuator_row()];
        for joint in &dense.joints {
            let given = &reactions[joint.reactions.clone()];
            for (k, row) in joint.rows.clone().enumerate() {
                rows[row] = if joint.is_wrench {
                    dense.power_of(joint, poses, given, &at.unit_velocities[row])
                } else {
                    given[k]
                };
            }
        }
        rows
    }

    /// Scales of the a and the b of a row.
    pub(crate) fn coefficient_scales(&self, reaction: usize) -> [f64; 2] {
        let unit = usize::from(self.dense.angular[reaction]);
        [self.scales.a[unit], self.scales.b[unit]]
    }

    /// The mechanism at the coordinate `h` beyond a position, on the same branch.
    pub(crate) fn stepped(&self, at: &CheckedPosition, h: f64) -> Option<Configuration> {
        let (dense, u) = (&self.dense, at.unit_velocity());
        let stepped = dense.step_row(&at.configuration, dense.actuator_row(), u, at.q + h);
        stepped.ok()
    }

    /// E_c there at q̇ = 1, J.
    pub(crate) fn energy_at(&self, at: &CheckedPosition, h: f64) -> Option<f64> {
        let unit_rate = [(self.dense.actuator_row(), 1.0)];
        Some(self.dense.kinetic_energy(&self.stepped(at, h)?, &unit_rate))
    }

    /// m at a position with the row of a reaction opened by `h`.
    pub(crate) fn opened_m(&self, at: &CheckedPosition, reaction: usize, h: f64) -> Option<f64> {
        let (dense, w) = (&self.dense, at.unit_velocities.get(reaction)?);
        let opened = dense.step_row(&at.configuration, reaction, w, h).ok()?;
        let u = dense.unit_velocity(&opened, dense.actuator_row());
        Some(dense.inertia(&opened, &u, &u))
    }

    /// Compares several quantities at every position, in parallel. Where the subject fails to answer, all of them
    /// fail.
    pub(crate) fn for_each_position<const N: usize>(
        &self,
        compare: impl Fn(&CheckedPosition, &mut [LargestDifference; N]) -> Result<(), SubjectError>
        + Sync,
    ) -> [LargestDifference; N] {
        let empty = || std::array::from_fn(|_| LargestDifference::default());
        let at = |position| {
            let mut worst = empty();
            if let Err(error) = compare(position, &mut worst) {
                worst.iter_mut().for_each(|w| w.record_error(&error));
            }
            worst
        };
        let all: Vec<[LargestDifference; N]> = self.positions.par_iter().map(at).collect();
        all.into_iter().fold(empty(), LargestDifference::merge_each)
    }
}

/// Successes to the left, errors to the right.
pub(crate) fn either<T, E>(result: Result<T, E>) -> Either<T, E> {
    match result {
        Ok(done) => Either::Left(done),
        Err(reason) => Either::Right(reason),
    }
}

impl CheckedPosition {
    fn new(dense: &DenseMechanism, poses: &[Pose], q: f64) -> Result<Self> {
        let (configuration, closing_correction) = dense.close_at(poses, &[q])?;
        let unit_velocities = dense.unit_velocities(&configuration);
        let reference = dense.coefficients(&configuration, &unit_velocities);
        let flat = |c: &Coefficients| [&[c.m, c.half_dm][..], &c.a, &c.b].concat();
        let coefficients =
            |at: &Configuration| Ok(flat(&dense.coefficients(at, &dense.unit_velocities(at))));
        let exact = flat(&reference);
        let (bounds, pose_rounding_bound) =
            dense.rounding_bounds(&configuration, &unit_velocities, &exact, coefficients)?;
        let (a, b) = bounds[2..].split_at(reference.a.len());
        Ok(Self {
            q,
            closing_correction,
            condition_number: dense.condition_number(&configuration.poses),
            configuration,
            unit_velocities,
            reference,
            rounding_bound: Coefficients {
                m: bounds[0],
                half_dm: bounds[1],
                a: a.to_vec(),
                b: b.to_vec(),
            },
            pose_rounding_bound,
        })
    }

    /// Records a comparison at this position: a difference, its scale and the error of the reference, all in `unit`.
    pub(crate) fn record(
        &self,
        worst: &mut LargestDifference,
        numbers: [f64; 3],
        unit: &'static str,
        location: impl FnOnce() -> String,
    ) {
        worst.record(&self.comparison(numbers, unit), location);
    }

    /// A comparison at this position.
    pub(crate) fn comparison(&self, numbers: [f64; 3], unit: &'static str) -> Comparison {
        Comparison::new(numbers, unit, self.condition_number)
    }

    /// Rounding of an energy relative to itself, which next to a dead point is not the last place.
    pub(crate) fn energy_rounding(&self) -> f64 {
        // Where nothing has a mass the quotient is not a number, and `max` drops it.
        (self.rounding_bound.m / self.reference.m).max(f64::EPSILON)
    }

    /// Rounding of a position relative to the mechanism's size.
    pub(crate) fn pose_rounding(&self) -> f64 {
        self.pose_rounding_bound.max(f64::EPSILON)
    }

    /// The velocities at q̇ = 1.
    pub fn unit_velocity(&self) -> &[f64] {
        self.unit_velocities.last().map_or(&[], Vec::as_slice)
    }

    /// The share of some bodies in m.
    pub(crate) fn inertia_share(&self, dense: &DenseMechanism, bodies: &[usize]) -> f64 {
        let (at, u) = (&self.configuration, self.unit_velocity());
        let share = |&b: &usize| dense.body_inertia(b, at, u, u);
        bodies.iter().map(share).sum()
    }
}

/// Bodies whose share in m is not the same at all positions.
fn varying_bodies(dense: &DenseMechanism, positions: &[CheckedPosition]) -> Vec<usize> {
    let varies = |&body: &usize| {
        let shares = positions.iter().map(|s| s.inertia_share(dense, &[body]));
        let (low, high) = shares.fold((f64::INFINITY, 0.0_f64), |(a, b), m| (a.min(m), b.max(m)));
        high - low > CONSTANT_SHARE_TOLERANCE * high
    };
    (0..dense.bodies.len()).filter(varies).collect()
}

fn scales(dense: &DenseMechanism, positions: &[CheckedPosition], varying: &[usize]) -> Scales {
    let mut s = Scales::default();
    for position in positions {
        s.m = s.m.max(position.reference.m);
        s.m_varying = s.m_varying.max(position.inertia_share(dense, varying));
        s.half_dm = s.half_dm.max(position.reference.half_dm.abs());
        for (k, &is_moment) in dense.angular[..dense.actuator_row()].iter().enumerate() {
            let kind = usize::from(is_moment);
            s.a[kind] = s.a[kind].max(position.reference.a[k].abs());
            s.b[kind] = s.b[kind].max(position.reference.b[k].abs());
        }
    }
    let varying_or_all = if s.m_varying > 0.0 { s.m_varying } else { s.m };
    s.half_dm = s.half_dm.max(B_MIN_SHARE * varying_or_all);
    // τ is a moment, or a force if the coordinate is a length; the other unit has a floor.
    let (tau, other, arm) = if dense.is_angle_driven() {
        (1, 0, dense.size())
    } else {
        (0, 1, 1.0 / dense.size())
    };
    s.a[tau] = s.a[tau].max(s.m);
    s.b[tau] = s.b[tau].max(s.half_dm);
    s.a[other] = s.a[other].max(FORCE_MIN_SHARE * varying_or_all / arm);
    s.b[other] = s.b[other].max(B_MIN_SHARE * s.a[other]);
    s
}
