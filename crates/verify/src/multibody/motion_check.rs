//! A claimed motion against the multibody equations.

use super::{MotionSample, MultibodyError, MultibodySystem};
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use dwell_findings::{Check, Finding};
use dwell_geometry::Component;
use std::f64::consts::TAU;

const TOLERANCE: f64 = 1e-8;
const TOLERANCE_REASON: &str =
    "two integrations at a relative tolerance of 1e-12 or finer, grown over the run";

/// Judges a claimed motion: the multibody equations start as its first sample says, and are followed
/// to the times of all others. Reactions that the rows do not determine are left out.
///
/// The findings are motion-poses, -velocities, -reactions (where any is determined), -actions and -energy, in this
/// order.
///
/// # Errors
/// [`MultibodyError`] where the truth itself cannot be had.
pub fn check_motion(
    system: &MultibodySystem,
    claimed_motion: &[MotionSample],
) -> Result<Vec<Finding>, MultibodyError> {
    let first = claimed_motion.first().ok_or(MultibodyError::InvalidStart)?;
    let times: Vec<f64> = claimed_motion.iter().skip(1).map(|claim| claim.t).collect();
    let reference_motion = system.integrate(first, &times)?;
    system.check(claimed_motion, &reference_motion)
}

/// Values of one kind of all samples, claimed and true.
struct ComparedSeries<'a> {
    unit: &'static str,
    /// The scale is no larger and no smaller than these.
    max_scale: f64,
    min_scale: f64,
    claimed: Vec<f64>,
    reference: Vec<f64>,
    /// By value: where it is.
    locations: Vec<(f64, &'a str)>,
}

impl<'a> ComparedSeries<'a> {
    fn new(unit: &'static str) -> Self {
        Self {
            unit,
            max_scale: f64::INFINITY,
            min_scale: 0.0,
            claimed: vec![],
            reference: vec![],
            locations: vec![],
        }
    }

    fn record(&mut self, claimed: f64, reference: f64, t: f64, name: &'a str) {
        self.claimed.push(claimed);
        self.reference.push(reference);
        self.locations.push((t, name));
    }

    fn largest(&self) -> f64 {
        self.reference
            .iter()
            .fold(0.0_f64, |max, v| max.max(v.abs()))
    }

    fn compare_into(&self, worst: &mut LargestDifference) {
        let scale = self.largest();
        for ((claimed, reference), (t, name)) in self
            .claimed
            .iter()
            .zip(&self.reference)
            .zip(&self.locations)
        {
            let comparison = Comparison {
                difference: claimed - reference,
                scale: scale.max(self.min_scale).min(self.max_scale),
                reference_error: 0.0,
                unit: self.unit,
                condition_number: 1.0,
            };
            worst.record(&comparison, || format!("t = {t} s, {name}"));
        }
    }
}

fn finding(
    key: &'static str,
    compared: &'static str,
    scale: &'static str,
    tolerance: f64,
    count: usize,
    all_series: &[ComparedSeries<'_>],
) -> Finding {
    let mut worst = LargestDifference::default();
    all_series
        .iter()
        .for_each(|series| series.compare_into(&mut worst));
    let check = FindingSpec {
        key,
        check: Check::MultibodyMotion,
        comparison: compared,
        scale,
        tolerance,
        tolerance_reason: TOLERANCE_REASON,
    };
    Finding {
        integrated: true,
        ..check.finding(format!("{count} instants of a motion"), worst)
    }
}

impl MultibodySystem {
    /// Compares claims by samples of [`MultibodySystem::integrate`] at the same times.
    ///
    /// # Errors
    /// [`MultibodyError::InvalidStart`] where there are not as many of each, or of what they hold.
    pub fn check(
        &self,
        claimed_motion: &[MotionSample],
        reference_motion: &[MotionSample],
    ) -> Result<Vec<Finding>, MultibodyError> {
        let first = reference_motion
            .first()
            .ok_or(MultibodyError::InvalidStart)?;
        let same_layout = |claim: &MotionSample, sample: &MotionSample| {
            claim.t == sample.t
                && claim.poses.len() == sample.poses.len()
                && claim.velocities.len() == sample.velocities.len()
                && claim.reactions.len() == sample.reactions.len()
                && claim.tau.len() == sample.tau.len()
                && claim.drive_forces.len() == sample.drive_forces.len()
        };
        let pairs: Vec<_> = claimed_motion.iter().zip(reference_motion).collect();
        if claimed_motion.len() != reference_motion.len()
            || !pairs.iter().all(|(c, s)| same_layout(c, s))
        {
            return Err(MultibodyError::InvalidStart);
        }
        let determinate = self.determinate(&first.poses)?;
        let mut findings = vec![self.poses(&pairs), self.velocities(&pairs)];
        if determinate.contains(&true) {
            findings.push(self.reactions(&pairs, &determinate));
        }
        findings.extend([self.actuator_forces(&pairs), self.energy(&pairs)]);
        Ok(findings)
    }

    fn body_name(&self, body: usize) -> &str {
        self.mechanism.bodies.get(body).map_or("", |b| &b.name)
    }

    /// The claimed frames. Where no row feels turns, a claim may leave them out.
    fn comparable_poses(&self, claim: &MotionSample, sample: &MotionSample) -> Vec<[f64; 3]> {
        let counts_revolutions = self.frames.rows.counts_revolutions();
        let both = claim.poses.iter().zip(&sample.poses);
        both.map(|(&[x, y, angle], other)| {
            let revolutions = ((angle - other[2]) / TAU).round();
            let excess_angle = if counts_revolutions {
                0.0
            } else {
                TAU * revolutions
            };
            [x, y, angle - excess_angle]
        })
        .collect()
    }

    fn poses(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut lengths, mut angles) = (ComparedSeries::new("m"), ComparedSeries::new("rad"));
        angles.max_scale = 1.0;
        for (claim, sample) in pairs {
            let claimed = self.comparable_poses(claim, sample);
            for (b, (one, other)) in claimed.iter().zip(&sample.poses).enumerate() {
                let from = pairs[0].1.poses[b];
                let (name, t) = (self.body_name(b), sample.t);
                for i in 0..2 {
                    lengths.record(one[i] - from[i], other[i] - from[i], t, name);
                }
                angles.record(one[2] - from[2], other[2] - from[2], t, name);
            }
        }
        // Frames that all turn about their origins go nowhere, and those of slides do not turn.
        let size = self.frames.size;
        (lengths.min_scale, angles.min_scale) =
            (angles.largest().min(1.0) * size, lengths.largest() / size);
        finding(
            "motion-poses",
            "the frames of all bodies with those of the multibody equations",
            "the largest distance from the initial position, for angles the largest rotation or 1 rad; each at least the other times or over the size",
            TOLERANCE,
            pairs.len(),
            &[lengths, angles],
        )
    }

    fn velocities(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut lengths, mut angles) = (ComparedSeries::new("m/s"), ComparedSeries::new("rad/s"));
        for (claim, sample) in pairs {
            for (b, (one, other)) in claim.velocities.iter().zip(&sample.velocities).enumerate() {
                let (name, t) = (self.body_name(b), sample.t);
                for i in 0..2 {
                    lengths.record(one[i], other[i], t, name);
                }
                angles.record(one[2], other[2], t, name);
            }
        }
        let size = self.frames.size;
        (lengths.min_scale, angles.min_scale) = (angles.largest() * size, lengths.largest() / size);
        finding(
            "motion-velocities",
            "the velocities of all bodies with those of the multibody equations",
            "the largest of the kind in the run, at least that of the other by the size",
            TOLERANCE,
            pairs.len(),
            &[lengths, angles],
        )
    }

    fn reactions(&self, pairs: &[(&MotionSample, &MotionSample)], determinate: &[bool]) -> Finding {
        let reactions = self.mechanism.reactions();
        let named: Vec<(bool, String)> = reactions
            .iter()
            .map(|r| {
                let moment = r.component == Component::Moment;
                (moment, self.mechanism.reaction_name(*r))
            })
            .collect();
        let (mut forces, mut moments) = (ComparedSeries::new("N"), ComparedSeries::new("N m"));
        for (claim, sample) in pairs {
            let both = claim.reactions.iter().zip(&sample.reactions);
            for (k, (one, other)) in both.enumerate() {
                let (moment, name) = &named[k];
                if determinate[k] {
                    let series = if *moment { &mut moments } else { &mut forces };
                    series.record(*one, *other, sample.t, name);
                }
            }
        }
        // Moments that all vanish are small beside what the forces do at an arm of the size.
        moments.min_scale = forces.largest() * self.frames.size;
        finding(
            "motion-reactions",
            "the reactions with the multipliers of the multibody equations",
            "the largest of the unit in the run; of moments at least the largest force at an arm of the size",
            TOLERANCE,
            pairs.len(),
            &[forces, moments],
        )
    }

    fn actuator_forces(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut forces, mut moments) = (ComparedSeries::new("N"), ComparedSeries::new("N m"));
        let mut work = ComparedSeries::new("J");
        let actuators = self.mechanism.actuators.iter();
        let names = actuators.map(|a| (a.coordinate().is_angle(), a.name.as_str()));
        let drives = self.drives.iter();
        let names = names.chain(drives.map(|d| (d.coordinate.is_angle(), d.name.as_str())));
        let names: Vec<_> = names.collect();
        for (claim, sample) in pairs {
            work.record(claim.work, sample.work, sample.t, "work");
            for energy in [sample.kinetic, sample.work] {
                work.min_scale = work.min_scale.max(energy.abs());
            }
            let claimed = claim.tau.iter().chain(&claim.drive_forces);
            let reference = sample.tau.iter().chain(&sample.drive_forces);
            for (&(angle, name), (one, other)) in names.iter().zip(claimed.zip(reference)) {
                let series = if angle { &mut moments } else { &mut forces };
                series.record(*one, *other, sample.t, name);
            }
        }
        finding(
            "motion-actuator-forces",
            "what prescribed motions take, drives do and all that has no potential works with the multibody equations",
            "the largest of the unit in the run; of work at least the kinetic energy",
            TOLERANCE,
            pairs.len(),
            &[forces, moments, work],
        )
    }

    /// The claim's own poses and velocities tell its energies; with its work they must balance.
    fn energy(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let mut series = ComparedSeries::new("J");
        let mut initial = None;
        let mut energy_scale = 0.0_f64;
        for (claim, sample) in pairs {
            let [kinetic, potential] = self.energies(&super::state::MultibodyState {
                t: claim.t,
                poses: self.comparable_poses(claim, sample),
                velocities: claim.velocities.clone(),
            });
            let sum = kinetic + potential - claim.work;
            let from = *initial.get_or_insert([sum, potential, claim.potential]);
            series.record(sum - from[0], 0.0, sample.t, "kinetic + potential - work");
            series.record(claim.kinetic - kinetic, 0.0, sample.t, "kinetic");
            let rise = (claim.potential - from[2]) - (potential - from[1]);
            series.record(rise, 0.0, sample.t, "potential");
            for energy in [kinetic, potential - from[1], claim.work] {
                energy_scale = energy_scale.max(energy.abs());
            }
        }
        series.min_scale = energy_scale;
        finding(
            "motion-energy",
            "kinetic + potential - work of the claim with its start, and the energies with those of its poses",
            "the largest energy or work in the run",
            1e-9,
            pairs.len(),
            &[series],
        )
    }
}
