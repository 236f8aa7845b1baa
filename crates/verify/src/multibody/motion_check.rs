//! A claimed motion against the multibody equations.

use super::{MotionSample, MultibodyError, MultibodySystem, Result};
use crate::comparison::{Comparison, ComparisonSet, FindingSpec, LargestDifference};
use dwell_findings::{Check, Finding};
use dwell_geometry::Component;
use std::f64::consts::TAU;

/// Checks a claimed motion: the multibody equations start in its first sample, and are followed
/// to the times of all others. Reactions that the rows do not determine are left out.
///
/// The findings are motion-poses, -velocities, -reactions (where any is determined), -actuator-forces and -energy, in this
/// order.
///
/// # Errors
/// [`MultibodyError`] where the multibody equations cannot be solved.
pub fn check_motion(
    system: &MultibodySystem,
    claimed_motion: &[MotionSample],
) -> Result<Vec<Finding>> {
    let first = claimed_motion.first().ok_or(MultibodyError::InvalidStart)?;
    let times: Vec<f64> = claimed_motion.iter().skip(1).map(|claim| claim.t).collect();
    let reference_motion = system.integrate(first, &times)?;
    system.check(claimed_motion, &reference_motion)
}

/// Claimed samples with those of the multibody equations.
type Pairs<'a> = [(&'a MotionSample, &'a MotionSample)];

/// Adds a value of a sample; the scale of the set is at least the reference.
fn record(
    to: &mut ComparisonSet,
    [claimed, reference]: [f64; 2],
    unit: &'static str,
    t: f64,
    name: &str,
) {
    let numbers = [claimed - reference, reference.abs(), 0.0];
    let comparison = Comparison::new(numbers, unit, 1.0);
    to.add(comparison, format!("t = {t} s, {name}"));
}

/// Adds a force to the first set, or a moment to the second.
fn record_force(
    sets: &mut [ComparisonSet; 2],
    is_moment: bool,
    both: [f64; 2],
    t: f64,
    name: &str,
) {
    let (kind, unit) = if is_moment { (1, "N m") } else { (0, "N") };
    record(&mut sets[kind], both, unit, t, name);
}

const POSES: FindingSpec<'_> = FindingSpec {
    key: "motion-poses",
    check: Check::MultibodyMotion,
    comparison: "the frames of all bodies with those of the multibody equations",
    scale: "the largest distance from the initial position, for angles the largest rotation or 1 rad; each at least the other times or over the size",
    tolerance: 1e-8,
    tolerance_reason: "two integrations at a relative tolerance of 1e-12 or finer, grown over the run",
};
const VELOCITIES: FindingSpec<'_> = FindingSpec {
    key: "motion-velocities",
    comparison: "the velocities of all bodies with those of the multibody equations",
    scale: "the largest of the kind in the run, at least that of the other by the size",
    ..POSES
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "motion-reactions",
    comparison: "the reactions with the multipliers of the multibody equations",
    scale: "the largest of the unit in the run; of moments at least the largest force at an arm of the size",
    ..POSES
};
const ACTUATOR_FORCES: FindingSpec<'_> = FindingSpec {
    key: "motion-actuator-forces",
    comparison: "the forces of prescribed motions and drives and the nonconservative work with those of the multibody equations",
    scale: "the largest of the unit in the run; of work at least the kinetic energy",
    ..POSES
};
const ENERGY: FindingSpec<'_> = FindingSpec {
    key: "motion-energy",
    comparison: "kinetic + potential - work of the claim with its start, and the energies with those of its poses",
    scale: "the largest energy or work in the run",
    tolerance: 1e-9,
    ..POSES
};

fn finding<const N: usize>(
    spec: &FindingSpec<'_>,
    pairs: &Pairs<'_>,
    all: [ComparisonSet; N],
) -> Finding {
    let all = all.into_iter().map(ComparisonSet::largest);
    let worst = all.fold(LargestDifference::default(), LargestDifference::merge);
    Finding {
        integrated: true,
        ..spec.finding(format!("{} instants of a motion", pairs.len()), worst)
    }
}

impl MultibodySystem {
    /// Compares claims with samples of [`MultibodySystem::integrate`] at the same times.
    ///
    /// # Errors
    /// [`MultibodyError::InvalidStart`] if the numbers of samples, or of the values in them, differ.
    pub fn check(
        &self,
        claimed_motion: &[MotionSample],
        reference_motion: &[MotionSample],
    ) -> Result<Vec<Finding>> {
        let first = reference_motion.first();
        let first = first.ok_or(MultibodyError::InvalidStart)?;
        let layout = |s: &MotionSample| {
            let bodies = [s.poses.len(), s.velocities.len()];
            let forces = [s.reactions.len(), s.tau.len(), s.drive_forces.len()];
            (bodies, forces)
        };
        let pairs: Vec<_> = claimed_motion.iter().zip(reference_motion).collect();
        let alike = |(c, s): &(&MotionSample, &MotionSample)| c.t == s.t && layout(c) == layout(s);
        if claimed_motion.len() != reference_motion.len() || !pairs.iter().all(alike) {
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

    /// The claimed frames. Where no row depends on whole revolutions, a claim may leave them out.
    fn comparable_poses(&self, claim: &MotionSample, sample: &MotionSample) -> Vec<[f64; 3]> {
        let counts_revolutions = self.frames.counts_revolutions;
        let both = claim.poses.iter().zip(&sample.poses);
        both.map(|(&[x, y, angle], other)| {
            let excess = if counts_revolutions {
                0.0
            } else {
                TAU * ((angle - other[2]) / TAU).round()
            };
            [x, y, angle - excess]
        })
        .collect()
    }

    fn poses(&self, pairs: &Pairs<'_>) -> Finding {
        let from = &pairs[0].1.poses;
        let moved = |b: usize, pose: [f64; 3]| [0, 1, 2].map(|i| pose[i] - from[b][i]);
        // Frames may all rotate about their origins without moving, and those of slides do not rotate.
        self.frames_finding(&POSES, pairs, ["m", "rad"], 1.0, |claim, sample| {
            let claimed = self.comparable_poses(claim, sample);
            let both = claimed.iter().zip(&sample.poses).enumerate();
            both.map(|(b, (one, other))| [moved(b, *one), moved(b, *other)])
                .collect()
        })
    }

    fn velocities(&self, pairs: &Pairs<'_>) -> Finding {
        let units = ["m/s", "rad/s"];
        self.frames_finding(&VELOCITIES, pairs, units, f64::INFINITY, |claim, sample| {
            let both = claim.velocities.iter().zip(&sample.velocities);
            both.map(|(one, other)| [*one, *other]).collect()
        })
    }

    /// A finding over values of all frames, claimed and reference. The scale of lengths is at least that of angles
    /// times the size, and the reverse; the scale of angles is at most `max_angle`.
    fn frames_finding(
        &self,
        spec: &FindingSpec<'_>,
        pairs: &Pairs<'_>,
        units: [&'static str; 2],
        max_angle: f64,
        values: impl Fn(&MotionSample, &MotionSample) -> Vec<[[f64; 3]; 2]>,
    ) -> Finding {
        let [mut lengths, mut angles] = [(); 2].map(|()| ComparisonSet::default());
        for (claim, sample) in pairs {
            for (body, [one, other]) in values(claim, sample).into_iter().enumerate() {
                let name = self.mechanism.bodies.get(body).map_or("", |b| &b.name);
                for i in 0..2 {
                    record(&mut lengths, [one[i], other[i]], units[0], sample.t, name);
                }
                record(&mut angles, [one[2], other[2]], units[1], sample.t, name);
            }
        }
        let (size, length, angle) = (self.frames.size, lengths.scale, angles.scale);
        lengths.scale = length.max(angle.min(max_angle) * size);
        angles.scale = angle.max(length / size).min(max_angle);
        finding(spec, pairs, [lengths, angles])
    }

    fn reactions(&self, pairs: &Pairs<'_>, determinate: &[bool]) -> Finding {
        let reactions = self.mechanism.reactions();
        let mut sets = [(); 2].map(|()| ComparisonSet::default());
        for (claim, sample) in pairs {
            let both = claim.reactions.iter().zip(&sample.reactions);
            for (k, (&one, &other)) in both.enumerate().filter(|(k, _)| determinate[*k]) {
                let name = self.mechanism.reaction_name(reactions[k]);
                let is_moment = reactions[k].component == Component::Moment;
                record_force(&mut sets, is_moment, [one, other], sample.t, &name);
            }
        }
        // Moments that all vanish are small beside what the forces do at an arm of the size.
        sets[1].scale = sets[1].scale.max(sets[0].scale * self.frames.size);
        finding(&REACTIONS, pairs, sets)
    }

    fn actuator_forces(&self, pairs: &Pairs<'_>) -> Finding {
        let mut sets = [(); 2].map(|()| ComparisonSet::default());
        let mut work = ComparisonSet::default();
        let actuators = self.mechanism.actuators.iter();
        let names = actuators.map(|a| (a.coordinate().is_angle(), a.name.as_str()));
        let drives = self.drives.iter();
        let names = names.chain(drives.map(|d| (d.coordinate.is_angle(), d.name.as_str())));
        let names: Vec<_> = names.collect();
        for (claim, sample) in pairs {
            let t = sample.t;
            record(&mut work, [claim.work, sample.work], "J", t, "work");
            work.scale = work.scale.max(sample.kinetic.abs());
            let claimed = claim.tau.iter().chain(&claim.drive_forces);
            let reference = sample.tau.iter().chain(&sample.drive_forces);
            for (&(angle, name), (&one, &other)) in names.iter().zip(claimed.zip(reference)) {
                record_force(&mut sets, angle, [one, other], t, name);
            }
        }
        let [forces, moments] = sets;
        finding(&ACTUATOR_FORCES, pairs, [forces, moments, work])
    }

    /// The energies of the claim's own poses and velocities; with its work they must balance.
    fn energy(&self, pairs: &Pairs<'_>) -> Finding {
        let mut series = ComparisonSet::default();
        let mut initial = None;
        for (claim, sample) in pairs {
            let [kinetic, potential] = self.energies(&super::state::MultibodyState {
                t: claim.t,
                poses: self.comparable_poses(claim, sample),
                velocities: claim.velocities.clone(),
            });
            let sum = kinetic + potential - claim.work;
            let from = *initial.get_or_insert([sum, potential, claim.potential]);
            let rise = (claim.potential - from[2]) - (potential - from[1]);
            for (difference, name) in [
                (sum - from[0], "kinetic + potential - work"),
                (claim.kinetic - kinetic, "kinetic"),
                (rise, "potential"),
            ] {
                record(&mut series, [difference, 0.0], "J", sample.t, name);
            }
            for energy in [kinetic, potential - from[1], claim.work] {
                series.scale = series.scale.max(energy.abs());
            }
        }
        finding(&ENERGY, pairs, [series])
    }
}
