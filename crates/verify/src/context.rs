//! What every check starts from: the mechanism closed densely at every position, its unit velocities
//! there, and the scales that differences are relative to.

use crate::case::Case;
use crate::comparison::{Comparison, LargestDifference};
use crate::constraint_closing::ClosedConfiguration;
use crate::dense::DenseMechanism;
use crate::error::DenseError;
use crate::subject::{Coefficients, Subject, SubjectError};
use dwell_geometry::{Component, Reaction};
use rayon::prelude::*;

/// The dense mechanism at one sampled position.
#[derive(Debug, Clone)]
pub struct CheckedPosition {
    /// The coordinate, rad.
    pub q: f64,
    /// The configuration, closed from the subject's pose.
    pub configuration: ClosedConfiguration,
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
/// A coefficient may be zero throughout: the moment of a guide on a slider without inertia is. It
/// is therefore held against the largest of its unit in the whole mechanism, the actuator's own
/// coefficients m and ½m′ included, since τ is a moment too. Where a whole unit is zero (every
/// force of a balanced flywheel) a small part of what the other coefficients would make of it
/// stands in, so that rounding is not divided by rounding.
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
    /// What is checked.
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
    /// All reactions, in order.
    pub reactions: Vec<Reaction>,
}

/// Where a whole unit is zero: b against a (both are per 1/s²), forces against moments per size.
const B_MIN_SHARE: f64 = 1e-4;
pub(crate) const FORCE_MIN_SHARE: f64 = 1e-6;
/// A share in m that changes by less than this of itself is constant.
const CONSTANT_SHARE_TOLERANCE: f64 = 1e-12;

impl<'a> CheckContext<'a> {
    /// Closes the mechanism at every position and measures the scales. A position that does not
    /// close is noted, not an error: the others are still judged.
    pub fn new(case: &'a Case<'a>, subject: &'a dyn Subject) -> Result<Self, DenseError> {
        let actuators = case.mechanism.actuators.len();
        if actuators != 1 {
            return Err(DenseError::Actuators { actuators });
        }
        let first_poses = case.positions.first().and_then(|&q| subject.poses(q).ok());
        let dense = match first_poses {
            None => DenseMechanism::new(case.mechanism, case.masses)?,
            // Gears mesh as the subject first shows them: from there on they must keep step.
            Some(poses) => DenseMechanism::with_meshed_gears(case.mechanism, case.masses, &poses)?,
        };
        let results: Vec<_> = case
            .positions
            .par_iter()
            .map(|&q| CheckedPosition::new(&dense, subject, q).map_err(|message| (q, message)))
            .collect();
        let (mut positions, mut not_closed) = (Vec::new(), Vec::new());
        for position in results {
            match position {
                Ok(position) => positions.push(position),
                Err(reason) => not_closed.push(reason),
            }
        }
        let reactions = case.mechanism.reactions();
        let varying = varying_bodies(&dense, &positions);
        let scales = scales(&dense, &positions, &varying, &reactions);
        Ok(Self {
            case,
            subject,
            dense,
            positions,
            not_closed,
            scales,
            varying_bodies: varying,
            reactions,
        })
    }

    /// `phi = 1.3 rad`.
    pub(crate) fn location(&self, q: f64) -> String {
        let actuator = self.case.mechanism.actuators.first();
        let name = actuator.map_or("q", |a| a.name.as_str());
        format!("{name} = {q:.6} {}", self.unit())
    }

    /// Unit of the coordinate.
    pub(crate) fn unit(&self) -> &'static str {
        if self.dense.coordinate_is_angle() {
            "rad"
        } else {
            "m"
        }
    }

    /// `phi = 1.3 rad, slide.normal`.
    pub(crate) fn reaction_location(&self, q: f64, reaction: usize) -> String {
        let name = self.case.mechanism.reaction_name(self.reactions[reaction]);
        format!("{}, {name}", self.location(q))
    }

    /// The words for the positions judged.
    pub(crate) fn domain(&self) -> String {
        let range = match self.case.range.limits() {
            None => "over a full turn".to_owned(),
            Some((low, high)) => format!("between {low:.6} and {high:.6} {}", self.unit()),
        };
        format!("{} positions {range}", self.positions.len())
    }

    /// Scale of the a of a reaction.
    pub(crate) fn a_scale(&self, reaction: usize) -> f64 {
        self.scales.a[unit_index(self.reactions[reaction])]
    }

    /// Scale of the b of a reaction.
    pub(crate) fn b_scale(&self, reaction: usize) -> f64 {
        self.scales.b[unit_index(self.reactions[reaction])]
    }

    /// Checks every position, in parallel, with one verdict. What the subject cannot answer is
    /// noted in it.
    pub(crate) fn for_each_position<F>(&self, compare: F) -> LargestDifference
    where
        F: Fn(&CheckedPosition, &mut LargestDifference) -> Result<(), SubjectError> + Sync,
    {
        let [worst] = self.for_each_position_into(|position, [worst]| compare(position, worst));
        worst
    }

    /// The same with several verdicts at once.
    pub(crate) fn for_each_position_into<const N: usize, F>(
        &self,
        compare: F,
    ) -> [LargestDifference; N]
    where
        F: Fn(&CheckedPosition, &mut [LargestDifference; N]) -> Result<(), SubjectError> + Sync,
    {
        let empty = || std::array::from_fn(|_| LargestDifference::default());
        let all: Vec<[LargestDifference; N]> = self
            .positions
            .par_iter()
            .map(|position| {
                let mut worst = empty();
                if let Err(error) = compare(position, &mut worst) {
                    worst.iter_mut().for_each(|w| w.record_error(&error));
                }
                worst
            })
            .collect();
        all.into_iter().fold(empty(), |sum, next| {
            let mut next = next.into_iter();
            sum.map(|w| w.merge(next.next().unwrap_or_default()))
        })
    }
}

impl CheckedPosition {
    fn new(dense: &DenseMechanism, subject: &dyn Subject, q: f64) -> Result<Self, String> {
        let failed = |e: DenseError| e.to_string();
        let poses = subject.poses(q).map_err(|e| e.to_string())?;
        let coordinates = dense.coordinates(&poses).map_err(failed)?;
        let row = dense.actuator_row();
        let mut row_values = vec![0.0; row + 1];
        row_values[row] = q;
        let configuration = dense.close(&coordinates, &row_values).map_err(failed)?;
        let unit_velocities = dense.unit_velocities(&configuration);
        let reference = dense.coefficients(&configuration, &unit_velocities);
        let (rounding_bound, pose_rounding_bound) =
            rounding_bounds(dense, &configuration, &reference, &unit_velocities).map_err(failed)?;
        let condition_number = dense.condition_number(&configuration.x);
        let correction: Vec<_> = coordinates
            .iter()
            .zip(&configuration.x)
            .map(|(s, x)| s - x)
            .collect();
        let largest = poses
            .iter()
            .map(|p| p[0].hypot(p[1]))
            .fold(dense.size(), f64::max);
        Ok(Self {
            q,
            closing_correction: dense.scaled_norm(&correction) * dense.size() / largest,
            configuration,
            unit_velocities,
            reference,
            rounding_bound,
            pose_rounding_bound,
            condition_number,
        })
    }

    /// A comparison at this position; `reference_error` in the unit of the difference.
    pub(crate) fn comparison(
        &self,
        difference: f64,
        scale: f64,
        reference_error: f64,
        unit: &'static str,
    ) -> Comparison {
        Comparison {
            difference,
            scale,
            reference_error,
            unit,
            condition_number: self.condition_number,
        }
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

    /// The speeds at q̇ = 1.
    pub fn unit_velocity(&self) -> &[f64] {
        self.unit_velocities.last().map_or(&[], Vec::as_slice)
    }
}

/// What rounding does to the coefficients and to the pose.
fn rounding_bounds(
    dense: &DenseMechanism,
    configuration: &ClosedConfiguration,
    reference: &Coefficients,
    unit_velocities: &[Vec<f64>],
) -> Result<(Coefficients, f64), DenseError> {
    let flat = |c: &Coefficients| [&[c.m, c.half_dm][..], &c.a, &c.b].concat();
    let (rounding_bound, pose_bound) = dense.rounding_bounds(
        configuration,
        unit_velocities,
        &flat(reference),
        |perturbed| {
            Ok(flat(&dense.coefficients(
                perturbed,
                &dense.unit_velocities(perturbed),
            )))
        },
    )?;
    let (a, b) = rounding_bound[2..].split_at(reference.a.len());
    let rounding_bound = Coefficients {
        m: rounding_bound[0],
        half_dm: rounding_bound[1],
        a: a.to_vec(),
        b: b.to_vec(),
    };
    Ok((rounding_bound, pose_bound))
}

/// 0 for a force, 1 for a moment.
pub(crate) fn unit_index(reaction: Reaction) -> usize {
    usize::from(reaction.component == Component::Moment)
}

/// Bodies whose share in m is not the same at all positions.
fn varying_bodies(dense: &DenseMechanism, positions: &[CheckedPosition]) -> Vec<usize> {
    let varies = |&body: &usize| {
        let shares = positions.iter().map(|s| {
            dense.body_inertia(body, &s.configuration, s.unit_velocity(), s.unit_velocity())
        });
        let (low, high) = shares.fold((f64::INFINITY, 0.0_f64), |(low, high), share| {
            (low.min(share), high.max(share))
        });
        high - low > CONSTANT_SHARE_TOLERANCE * high
    };
    (0..dense.bodies.len()).filter(varies).collect()
}

fn scales(
    dense: &DenseMechanism,
    positions: &[CheckedPosition],
    varying: &[usize],
    reactions: &[Reaction],
) -> Scales {
    let mut s = Scales::default();
    for position in positions {
        let (at, u) = (&position.configuration, position.unit_velocity());
        s.m = s.m.max(position.reference.m);
        let part: f64 = varying
            .iter()
            .map(|&b| dense.body_inertia(b, at, u, u))
            .sum();
        s.m_varying = s.m_varying.max(part);
        s.half_dm = s.half_dm.max(position.reference.half_dm.abs());
        for (k, &reaction) in reactions.iter().enumerate() {
            let kind = unit_index(reaction);
            s.a[kind] = s.a[kind].max(position.reference.a[k].abs());
            s.b[kind] = s.b[kind].max(position.reference.b[k].abs());
        }
    }
    let varying_or_all = if s.m_varying > 0.0 { s.m_varying } else { s.m };
    s.half_dm = s.half_dm.max(B_MIN_SHARE * varying_or_all);
    // τ is a moment, or a force if the coordinate is a length; the other unit has a floor.
    let (tau, other, arm) = match dense.coordinate_is_angle() {
        true => (1, 0, dense.size()),
        false => (0, 1, 1.0 / dense.size()),
    };
    s.a[tau] = s.a[tau].max(s.m);
    s.b[tau] = s.b[tau].max(s.half_dm);
    s.a[other] = s.a[other].max(FORCE_MIN_SHARE * varying_or_all / arm);
    s.b[other] = s.b[other].max(B_MIN_SHARE * s.a[other]);
    s
}
