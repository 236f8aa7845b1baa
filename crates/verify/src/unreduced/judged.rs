//! A claimed motion against the multibody equations.

use super::{MotionSample, Unreduced, UnreducedError};
use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;
use dwell_geometry::Component;
use std::f64::consts::TAU;

const TRUTH: &str = "6 full multibody equations";
const CLOSE: f64 = 1e-8;
const WHY: &str = "two integrations at a relative tolerance of 1e-12 or finer, grown over the run";

/// Judges a claimed motion: the multibody equations start as its first sample says, and are followed
/// to the times of all others. Reactions that the rows do not determine are left out.
///
/// The findings are motion-poses, -velocities, -reactions, -actions and -energy, in this order.
///
/// # Errors
/// [`UnreducedError`] where the truth itself cannot be had.
pub fn judge_motion(
    truth: &Unreduced,
    claims: &[MotionSample],
) -> Result<Vec<Finding>, UnreducedError> {
    let first = claims.first().ok_or(UnreducedError::Start)?;
    let times: Vec<f64> = claims.iter().skip(1).map(|claim| claim.t).collect();
    let samples = truth.run(first, &times)?;
    truth.judge(claims, &samples)
}

/// Values of one kind of all samples, claimed and true.
struct Kind<'a> {
    unit: &'static str,
    /// The scale is no larger and no smaller than these.
    most: f64,
    least: f64,
    claimed: Vec<f64>,
    truth: Vec<f64>,
    /// By value: where it is.
    places: Vec<(f64, &'a str)>,
}

impl<'a> Kind<'a> {
    fn new(unit: &'static str) -> Self {
        Self {
            unit,
            most: f64::INFINITY,
            least: 0.0,
            claimed: vec![],
            truth: vec![],
            places: vec![],
        }
    }

    fn read(&mut self, claimed: f64, truth: f64, t: f64, name: &'a str) {
        self.claimed.push(claimed);
        self.truth.push(truth);
        self.places.push((t, name));
    }

    fn largest(&self) -> f64 {
        self.truth.iter().fold(0.0_f64, |most, v| most.max(v.abs()))
    }

    fn judge(&self, worst: &mut Worst) {
        let scale = self.largest();
        for ((claimed, truth), (t, name)) in self.claimed.iter().zip(&self.truth).zip(&self.places)
        {
            let reading = Reading {
                difference: claimed - truth,
                scale: scale.max(self.least).min(self.most),
                own: 0.0,
                unit: self.unit,
                condition: 1.0,
            };
            worst.meet(&reading, || format!("t = {t} s, {name}"));
        }
    }
}

fn finding(
    key: &'static str,
    compared: &'static str,
    scale: &'static str,
    tolerance: f64,
    count: usize,
    kinds: &[Kind<'_>],
) -> Finding {
    let mut worst = Worst::default();
    kinds.iter().for_each(|kind| kind.judge(&mut worst));
    let check = Check {
        key,
        truth: TRUTH,
        compared,
        over: format!("{count} instants of a motion"),
        scale,
        tolerance,
        why: WHY,
    };
    Finding {
        integrated: true,
        ..check.judge(worst)
    }
}

impl Unreduced {
    /// Judges claims by samples of [`Unreduced::run`] at the same times.
    ///
    /// # Errors
    /// [`UnreducedError::Start`] where there are not as many of each, or of what they hold.
    pub fn judge(
        &self,
        claims: &[MotionSample],
        samples: &[MotionSample],
    ) -> Result<Vec<Finding>, UnreducedError> {
        let first = samples.first().ok_or(UnreducedError::Start)?;
        let like = |claim: &MotionSample, sample: &MotionSample| {
            claim.t == sample.t
                && claim.bodies.len() == sample.bodies.len()
                && claim.velocity.len() == sample.velocity.len()
                && claim.reactions.len() == sample.reactions.len()
                && claim.tau.len() == sample.tau.len()
                && claim.drives.len() == sample.drives.len()
        };
        let pairs: Vec<_> = claims.iter().zip(samples).collect();
        if claims.len() != samples.len() || !pairs.iter().all(|(c, s)| like(c, s)) {
            return Err(UnreducedError::Start);
        }
        let unique = self.unique(&first.bodies)?;
        Ok(vec![
            self.poses(&pairs),
            self.velocities(&pairs),
            self.reactions(&pairs, &unique),
            self.actions(&pairs),
            self.energy(&pairs),
        ])
    }

    fn body(&self, body: usize) -> &str {
        self.mechanism.bodies.get(body).map_or("", |b| &b.name)
    }

    /// The claimed frames. Where no row feels turns, a claim may leave them out.
    fn counted(&self, claim: &MotionSample, sample: &MotionSample) -> Vec<[f64; 3]> {
        let felt = self.frames.rows.counted();
        let both = claim.bodies.iter().zip(&sample.bodies);
        both.map(|(&[x, y, angle], other)| {
            let turns = ((angle - other[2]) / TAU).round();
            let less = if felt { 0.0 } else { TAU * turns };
            [x, y, angle - less]
        })
        .collect()
    }

    fn poses(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut lengths, mut angles) = (Kind::new("m"), Kind::new("rad"));
        angles.most = 1.0;
        for (claim, sample) in pairs {
            let claimed = self.counted(claim, sample);
            for (b, (one, other)) in claimed.iter().zip(&sample.bodies).enumerate() {
                let from = pairs[0].1.bodies[b];
                let (name, t) = (self.body(b), sample.t);
                for i in 0..2 {
                    lengths.read(one[i] - from[i], other[i] - from[i], t, name);
                }
                angles.read(one[2] - from[2], other[2] - from[2], t, name);
            }
        }
        // Frames that all turn about their origins go nowhere, and those of slides do not turn.
        let size = self.frames.size;
        (lengths.least, angles.least) =
            (angles.largest().min(1.0) * size, lengths.largest() / size);
        finding(
            "motion-poses",
            "the frames of all bodies with those of the multibody equations",
            "the longest way from the start, angles the largest turn or 1 rad; each at least the other by the size",
            CLOSE,
            pairs.len(),
            &[lengths, angles],
        )
    }

    fn velocities(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut lengths, mut angles) = (Kind::new("m/s"), Kind::new("rad/s"));
        for (claim, sample) in pairs {
            for (b, (one, other)) in claim.velocity.iter().zip(&sample.velocity).enumerate() {
                let (name, t) = (self.body(b), sample.t);
                for i in 0..2 {
                    lengths.read(one[i], other[i], t, name);
                }
                angles.read(one[2], other[2], t, name);
            }
        }
        let size = self.frames.size;
        (lengths.least, angles.least) = (angles.largest() * size, lengths.largest() / size);
        finding(
            "motion-velocities",
            "the velocities of all bodies with those of the multibody equations",
            "the largest of the kind in the run, at least that of the other by the size",
            CLOSE,
            pairs.len(),
            &[lengths, angles],
        )
    }

    fn reactions(&self, pairs: &[(&MotionSample, &MotionSample)], unique: &[bool]) -> Finding {
        let reactions = self.mechanism.reactions();
        let named: Vec<(bool, String)> = reactions
            .iter()
            .map(|r| {
                let moment = r.component == Component::Moment;
                (moment, self.mechanism.reaction_name(*r))
            })
            .collect();
        let (mut forces, mut moments) = (Kind::new("N"), Kind::new("N m"));
        for (claim, sample) in pairs {
            let both = claim.reactions.iter().zip(&sample.reactions);
            for (k, (one, other)) in both.enumerate() {
                let (moment, name) = &named[k];
                if unique[k] {
                    let kind = if *moment { &mut moments } else { &mut forces };
                    kind.read(*one, *other, sample.t, name);
                }
            }
        }
        // Moments that all vanish are small beside what the forces do at an arm of the size.
        moments.least = forces.largest() * self.frames.size;
        finding(
            "motion-reactions",
            "the reactions with the multipliers of the multibody equations",
            "the largest of the unit in the run; of moments at least the largest force at an arm of the size",
            CLOSE,
            pairs.len(),
            &[forces, moments],
        )
    }

    fn actions(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let (mut forces, mut moments) = (Kind::new("N"), Kind::new("N m"));
        let mut work = Kind::new("J");
        let actuators = self.mechanism.actuators.iter();
        let names = actuators.map(|a| (a.coordinate().is_angle(), a.name.as_str()));
        let drives = self.drives.iter();
        let names = names.chain(drives.map(|d| (d.coordinate.is_angle(), d.name.as_str())));
        let names: Vec<_> = names.collect();
        for (claim, sample) in pairs {
            work.read(claim.work, sample.work, sample.t, "work");
            for energy in [sample.kinetic, sample.work] {
                work.least = work.least.max(energy.abs());
            }
            let claimed = claim.tau.iter().chain(&claim.drives);
            let truth = sample.tau.iter().chain(&sample.drives);
            for (&(angle, name), (one, other)) in names.iter().zip(claimed.zip(truth)) {
                let kind = if angle { &mut moments } else { &mut forces };
                kind.read(*one, *other, sample.t, name);
            }
        }
        finding(
            "motion-actions",
            "what prescribed motions take, drives do and all that has no potential works with the multibody equations",
            "the largest of the unit in the run; of work at least the kinetic energy",
            CLOSE,
            pairs.len(),
            &[forces, moments, work],
        )
    }

    /// The claim's own poses and velocities tell its energies; with its work they must balance.
    fn energy(&self, pairs: &[(&MotionSample, &MotionSample)]) -> Finding {
        let mut kind = Kind::new("J");
        let mut start = None;
        let mut floor = 0.0_f64;
        for (claim, sample) in pairs {
            let [kinetic, potential] = self.energies(&super::instant::Instant {
                t: claim.t,
                bodies: self.counted(claim, sample),
                velocity: claim.velocity.clone(),
            });
            let sum = kinetic + potential - claim.work;
            let from = *start.get_or_insert([sum, potential, claim.potential]);
            kind.read(sum - from[0], 0.0, sample.t, "kinetic + potential - work");
            kind.read(claim.kinetic - kinetic, 0.0, sample.t, "kinetic");
            let rise = (claim.potential - from[2]) - (potential - from[1]);
            kind.read(rise, 0.0, sample.t, "potential");
            for energy in [kinetic, potential - from[1], claim.work] {
                floor = floor.max(energy.abs());
            }
        }
        kind.least = floor;
        finding(
            "motion-energy",
            "kinetic + potential - work of the claim with its start, and the energies with those of its poses",
            "the largest energy or work in the run",
            1e-9,
            pairs.len(),
            &[kind],
        )
    }
}
