//! Kinetostatic states: where the bodies are, how they move and accelerate, and what the joints
//! and actuators do then, under loads, with any number of actuators.
//!
//! A [`State`] is a claim. It is closed densely from the claimed poses, and then
//!
//! ```text
//! J ẋ = [0; q̇]                                               (1)  its velocities
//! J ẍ = [0; q̈] − Φ̇ₓ ẋ                                        (2)  its accelerations
//! Jᵀ [λ; τ] = M ẍ + h − f                                    (3)  its reactions and actions
//! Σ F = m a_G,  Σ M = I α            for every body          (4)  truth 8
//! Σ τ q̇ + Σ P = Σ m v·a_G + I ω α                            (5)  truth 4
//! Σ F of the ground + Σ f = Σ m a_G, and its moments         (6)  truth 7
//! ```
//!
//! In (4) the reactions are forces at points, told from the words of their components, and the
//! accelerations once the claimed ones, once second differences of positions along
//! q(t) = q + q̇ t + ½ q̈ t², closed without any velocity. (5) and (6) take the dense motion. (3)
//! and the acts of (4) to (6) share nothing but the poses.

mod energies;
mod measured;

pub use energies::judge_energies;

use crate::dense::{Dense, DenseError};
use crate::judge::{Check, Reading, Worst};
use dwell_findings::Finding;
use dwell_geometry::{BodyId, Component, Mechanism, Vec2};
use dwell_kinetostatics::Mass;
use measured::Measured;
use rayon::prelude::*;

/// A load's action on one body. A load between two bodies is two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyAct {
    /// The body.
    pub body: BodyId,
    /// The force, N, in the plane's directions.
    pub force: Vec2,
    /// The point of the plane where it acts, m.
    pub at: Vec2,
    /// The couple, N·m.
    pub couple: f64,
}

/// A claimed state. What is given by body is in the order of [`Mechanism::bodies`], the ground
/// included.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// Time, s: only said in messages.
    pub t: f64,
    /// The coordinates of the actuators, rad or m.
    pub q: Vec<f64>,
    /// Their speeds, rad/s or m/s.
    pub q_dot: Vec<f64>,
    /// Their accelerations, rad/s² or m/s².
    pub q_ddot: Vec<f64>,
    /// The frame [x, y, θ] of every body, m and rad; θ counted where turns are felt.
    pub bodies: Vec<[f64; 3]>,
    /// Its rates, m/s and rad/s.
    pub velocity: Vec<[f64; 3]>,
    /// Its second derivatives, m/s² and rad/s².
    pub acceleration: Vec<[f64; 3]>,
    /// The reactions in the order of [`Mechanism::reactions`], N or N·m.
    pub reactions: Vec<f64>,
    /// What the actuators do, N·m or N.
    pub tau: Vec<f64>,
    /// What the loads do.
    pub loads: Vec<BodyAct>,
}

/// Judges claimed states of one mechanism, each by itself, with scales from all of them. Gears
/// mesh as they stand in `start`, the frames of all bodies in the assembled configuration.
///
/// Where joints repeat each other, all rows must close, and reactions that are not determined must
/// balance, whatever they are. The findings come in a fixed order. If the mechanism is not determinate there is one failed finding that says why; a state that cannot be closed fails all of them.
pub fn judge_states(
    mechanism: &Mechanism,
    masses: &[Mass],
    start: &[[f64; 3]],
    states: &[State],
) -> Vec<Finding> {
    match Dense::meshed(mechanism, masses, start) {
        Ok(dense) => Judge::new(&dense, mechanism, states).findings(),
        Err(error) => vec![not_dense(&POSES, error.to_string())],
    }
}

fn not_dense(words: &Words, message: String) -> Finding {
    let mut worst = Worst::default();
    worst.refuse(message);
    words.check(0).judge(worst)
}

/// The fixed words of one finding.
struct Words {
    key: &'static str,
    truth: &'static str,
    compared: &'static str,
    scale: &'static str,
    tolerance: f64,
    why: &'static str,
}

impl Words {
    fn check(&self, states: usize) -> Check {
        Check {
            key: self.key,
            truth: self.truth,
            compared: self.compared,
            over: format!("{states} states"),
            scale: self.scale,
            tolerance: self.tolerance,
            why: self.why,
        }
    }
}

const POSES: Words = Words {
    key: "state-poses",
    truth: "0 closure",
    compared: "the poses with the nearest ones that meet every dense row at the coordinates",
    scale: "the largest coordinate of a pose",
    tolerance: 1e-13,
    why: "a pose is given in rounded coordinates, and closed from rounded attachments",
};
const BRANCH: Words = Words {
    key: "state-branch",
    truth: "0 closure",
    compared: "the sign of det J with that of the first state",
    scale: "one is another branch",
    tolerance: 0.0,
    why: "a sign; it cannot change along a branch",
};
const VELOCITIES: Words = Words {
    key: "state-velocities",
    truth: "0 closure",
    compared: "the velocities of all bodies with the solution of J x_dot = q_dot",
    scale: "the largest velocity, angular ones times the size",
    tolerance: 1e-12,
    why: "two solutions of one system, each rounded as often as it has rows",
};
const ACCELERATIONS: Words = Words {
    key: "state-accelerations",
    truth: "0 closure",
    compared: "the accelerations of all bodies with the solution of J x_ddot = q_ddot - curvature",
    scale: "the largest acceleration or squared velocity over the size",
    tolerance: 1e-12,
    why: VELOCITIES.why,
};
const REACTIONS: Words = Words {
    key: "state-reactions",
    truth: "3 multipliers",
    compared: "reactions and actuator actions with the dense solution of J^T lambda = M x_ddot + h - f",
    scale: "the largest of them or of the forces they balance, moments over the size",
    tolerance: 1e-12,
    why: VELOCITIES.why,
};
const NEWTON: Words = Words {
    key: "state-newton",
    truth: "8 Newton and Euler, body by body",
    compared: "forces and moments on each body with m a_G and I alpha of the claimed accelerations",
    scale: "the largest sum of absolute terms on a body, moments over the size",
    tolerance: 1e-12,
    why: "a sum of rounded terms",
};
const DIFFERENCED: Words = Words {
    key: "state-differenced",
    truth: "8 Newton and Euler, body by body",
    compared: "forces and moments on each body with m a_G and I alpha, positions differenced twice",
    scale: NEWTON.scale,
    tolerance: 2e-11,
    why: "rounding of the positions over the square of the shortest time step used",
};
const POWER: Words = Words {
    key: "state-power",
    truth: "4 power",
    compared: "the power of actuators and loads with the rate of the kinetic energy",
    scale: "the sum of |force| |velocity| of the state",
    tolerance: 1e-12,
    why: NEWTON.why,
};
const BALANCE: Words = Words {
    key: "state-balance",
    truth: "7 balance of the whole mechanism",
    compared: "what the ground and the loads do with the rate of the momentum",
    scale: "the sum of absolute terms of the state",
    tolerance: 1e-12,
    why: NEWTON.why,
};

/// One comparison.
struct Read {
    difference: f64,
    /// The truth's own error.
    own: f64,
    /// The scale of this one.
    scale: f64,
    place: String,
    condition: f64,
}

/// Comparisons, most of whose scales are only known when all are there.
struct Tally {
    unit: &'static str,
    scale: f64,
    read: Vec<Read>,
    /// Whether each is judged by its own scale.
    each: bool,
}

impl Tally {
    fn new(unit: &'static str) -> Self {
        Self {
            unit,
            scale: 0.0,
            read: Vec::new(),
            each: false,
        }
    }

    /// A balance must hold in every state, however small its terms are there.
    fn of_each(unit: &'static str) -> Self {
        Self {
            each: true,
            ..Self::new(unit)
        }
    }

    /// One comparison: the difference, the truth's own error, what the scale must hold.
    fn read(&mut self, m: &Measured<'_>, difference: f64, own: f64, scale: f64, place: String) {
        // A maximum drops what is not a number, but then the difference is not one either.
        self.scale = self.scale.max(scale);
        self.read.push(Read {
            difference,
            own,
            scale,
            place,
            condition: m.condition,
        });
    }

    fn judge(self, words: &Words, judge: &Judge<'_>) -> Finding {
        let mut worst = Worst::default();
        for read in self.read {
            let reading = Reading {
                difference: read.difference,
                scale: if self.each { read.scale } else { self.scale },
                own: read.own,
                unit: self.unit,
                condition: read.condition,
            };
            worst.meet(&reading, || read.place);
        }
        for reason in &judge.refused {
            worst.refuse(reason.clone());
        }
        words.check(judge.count).judge(worst)
    }
}

struct Judge<'a> {
    dense: &'a Dense,
    mechanism: &'a Mechanism,
    measured: Vec<Measured<'a>>,
    refused: Vec<String>,
    count: usize,
}

impl<'a> Judge<'a> {
    fn new(dense: &'a Dense, mechanism: &'a Mechanism, states: &'a [State]) -> Self {
        let all: Vec<Result<Measured<'a>, String>> = states
            .par_iter()
            .map(|state| {
                Measured::new(dense, state).map_err(|error| format!("t = {} s: {error}", state.t))
            })
            .collect();
        let (mut measured, mut refused) = (Vec::new(), Vec::new());
        for one in all {
            match one {
                Ok(one) => measured.push(one),
                Err(reason) => refused.push(reason),
            }
        }
        Self {
            dense,
            mechanism,
            measured,
            refused,
            count: states.len(),
        }
    }

    fn findings(&self) -> Vec<Finding> {
        let mut findings = vec![self.poses(), self.branch()];
        findings.extend(self.motions());
        findings.push(self.reactions());
        findings.extend(self.bodies());
        findings.push(self.power());
        findings.push(self.balance());
        findings
    }

    fn poses(&self) -> Finding {
        let mut tally = Tally::new("");
        for m in &self.measured {
            tally.read(m, m.moved, m.pose_noise, 1.0, place(m));
        }
        tally.judge(&POSES, self)
    }

    fn branch(&self) -> Finding {
        let mut tally = Tally::new("");
        let positive = |m: &Measured<'_>| m.closed.lu.positive();
        for m in &self.measured {
            let other = self.measured.first().map(positive) != Some(positive(m));
            tally.read(m, f64::from(u8::from(other)), 0.0, 1.0, place(m));
        }
        tally.judge(&BRANCH, self)
    }

    /// Velocities and accelerations of the moved frames, (1) and (2).
    fn motions(&self) -> [Finding; 2] {
        let size = self.dense.size();
        let (mut first, mut second) = (Tally::new("m/s"), Tally::new("m/s2"));
        for m in &self.measured {
            let (speed, bend) = (m.reach_of(&m.x_dot) * size, m.reach_of(&m.x_ddot) * size);
            for (body, column) in m.moving() {
                let at = || format!("{}, {}", place(m), self.mechanism.bodies[body].name);
                let of = |tally: &mut Tally, claimed: &[f64], dense: &[f64], own: &[f64], scale| {
                    for c in column..column + 3 {
                        let arm = if c == column + 2 { size } else { 1.0 };
                        tally.read(m, (claimed[c] - dense[c]) * arm, own[c] * arm, scale, at());
                    }
                };
                of(&mut first, &m.claimed_dot, &m.x_dot, &m.noise_dot, speed);
                let scale = bend.max(speed * speed / size);
                of(
                    &mut second,
                    &m.claimed_ddot,
                    &m.x_ddot,
                    &m.noise_ddot,
                    scale,
                );
            }
        }
        [
            first.judge(&VELOCITIES, self),
            second.judge(&ACCELERATIONS, self),
        ]
    }

    fn reactions(&self) -> Finding {
        let size = self.dense.size();
        let reactions = self.mechanism.reactions();
        let joints = reactions.iter().map(|&r| {
            (
                r.component == Component::Moment,
                self.mechanism.reaction_name(r),
            )
        });
        let drives = self.mechanism.actuators.iter();
        let rows: Vec<(bool, String)> = joints
            .chain(drives.map(|a| (a.coordinate().is_angle(), a.name.clone())))
            .collect();
        let mut tally = Tally::new("N");
        for m in &self.measured {
            let claimed = m.state.reactions.iter().chain(&m.state.tau);
            let brought = m.largest_force();
            for (k, (claimed, (moment, name))) in claimed.zip(&rows).enumerate() {
                // Of a reaction that is not determined, (4) judges what it does with the others.
                if !self.dense.unique[k] {
                    continue;
                }
                let arm = if *moment { 1.0 / size } else { 1.0 };
                let (dense, own) = (m.multipliers[k] * arm, m.noise_multipliers[k] * arm);
                let at = format!("{}, {name}", place(m));
                tally.read(m, claimed * arm - dense, own, brought.max(dense.abs()), at);
            }
        }
        tally.judge(&REACTIONS, self)
    }

    /// Truth 8, by claimed accelerations and by positions alone.
    fn bodies(&self) -> [Finding; 2] {
        let (mut claimed, mut differenced) = (Tally::new("N"), Tally::new("N"));
        let size = self.dense.size();
        let by_position: Vec<_> = self
            .measured
            .par_iter()
            .map(Measured::differenced)
            .collect();
        for (m, second) in self.measured.iter().zip(by_position) {
            for (i, (body, _)) in m.moving().enumerate() {
                let name = &self.mechanism.bodies[body].name;
                let acting = m.acting(body);
                let exact = m.inertia_forces(body);
                let inertia = self.dense.bodies[body].mass;
                for (c, exact) in exact.into_iter().enumerate() {
                    let arm = if c == 2 { 1.0 / size } else { 1.0 };
                    let terms = acting.terms[usize::from(c == 2)] * arm;
                    let own = m.pose_noise * terms;
                    let scale = terms + exact.abs() * arm;
                    let at = || format!("{}, {name}", place(m));
                    claimed.read(m, (acting.sum[c] - exact) * arm, own, scale, at());
                    let factor = if c == 2 {
                        inertia.inertia
                    } else {
                        inertia.mass
                    } * arm;
                    let (value, error) = second
                        .get(3 * i + c)
                        .map_or((f64::NAN, f64::NAN), |s| (s.value, s.error));
                    let difference = acting.sum[c] * arm - factor * value;
                    differenced.read(m, difference, own + factor * error, scale, at());
                }
            }
        }
        [
            claimed.judge(&NEWTON, self),
            differenced.judge(&DIFFERENCED, self),
        ]
    }

    fn power(&self) -> Finding {
        let mut tally = Tally::of_each("W");
        for m in &self.measured {
            let (difference, terms) = m.power();
            tally.read(m, difference, m.relative_noise() * terms, terms, place(m));
        }
        tally.judge(&POWER, self)
    }

    fn balance(&self) -> Finding {
        let mut tally = Tally::of_each("N");
        for m in &self.measured {
            for (difference, terms, what) in m.balance() {
                let own = m.relative_noise() * terms;
                tally.read(m, difference, own, terms, format!("{}, {what}", place(m)));
            }
        }
        tally.judge(&BALANCE, self)
    }
}

fn place(m: &Measured<'_>) -> String {
    format!("t = {} s", m.state.t)
}

/// Why a state cannot be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
enum StateError {
    #[error("{found} {what} where there are {expected}")]
    Count {
        what: &'static str,
        found: usize,
        expected: usize,
    },
    #[error("a load acts on body {body}, but there are {bodies} bodies")]
    Load { body: usize, bodies: usize },
    #[error(transparent)]
    Dense(#[from] DenseError),
}
