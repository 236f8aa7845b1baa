//! One state closed densely, with all that it is compared with.

use super::{State, StateError};
use crate::acts::Act;
use crate::closing::Closed;
use crate::dense::{Dense, DenseError};
use crate::differences::{Estimate, Order, derivatives};
use dwell_geometry::{Vec2, vec2};

/// The longest step of a difference in time turns no body by more than this (rad), nor moves one
/// by more than this many sizes, to first order: as for the truths of the reduced model.
pub(super) const FIRST_TURN: f64 = 0.3;

/// A state with its dense solution.
pub(super) struct Measured<'a> {
    pub(super) dense: &'a Dense,
    pub(super) state: &'a State,
    pub(super) closed: Closed,
    /// How far closing moved the claimed poses, relative to the largest coordinate in them.
    pub(super) moved: f64,
    /// Dense speeds and accelerations of the moved frames, and the claimed ones.
    pub(super) x_dot: Vec<f64>,
    pub(super) x_ddot: Vec<f64>,
    pub(super) claimed_dot: Vec<f64>,
    pub(super) claimed_ddot: Vec<f64>,
    /// Dense reactions, followed by the actuators' actions.
    pub(super) multipliers: Vec<f64>,
    /// How much rounding may have moved the dense numbers.
    pub(super) pose_noise: f64,
    pub(super) noise_dot: Vec<f64>,
    pub(super) noise_ddot: Vec<f64>,
    pub(super) noise_multipliers: Vec<f64>,
    pub(super) condition: f64,
    pub(super) loads: Vec<Act>,
    acts: Vec<Act>,
}

/// What acts on a body: x, y and the moment about its centre of mass.
pub(super) struct Acting {
    pub(super) sum: [f64; 3],
    /// Sums of absolute forces and of absolute moments.
    pub(super) terms: [f64; 2],
}

/// Speeds, accelerations and multipliers at a configuration.
struct Solution {
    x_dot: Vec<f64>,
    x_ddot: Vec<f64>,
    multipliers: Vec<f64>,
}

impl Solution {
    fn new(
        dense: &Dense,
        state: &State,
        at: &Closed,
        unit_speeds: &[Vec<f64>],
        loads: &[Act],
    ) -> Result<Self, DenseError> {
        let driven = dense.actuator_row();
        let mut x_dot = vec![0.0; dense.rows.columns()];
        for (u, rate) in unit_speeds[driven..].iter().zip(&state.q_dot) {
            for (v, u) in x_dot.iter_mut().zip(u) {
                *v += u * rate;
            }
        }
        let mut rates = vec![0.0; dense.rows.len()];
        rates[driven..].copy_from_slice(&state.q_ddot);
        let x_ddot = dense.acceleration(at, &x_dot, &rates);
        let forces = needed_forces(dense, at, &x_dot, &x_ddot, loads);
        Ok(Self {
            multipliers: dense.multipliers(at, &forces)?,
            x_dot,
            x_ddot,
        })
    }

    fn flat(&self) -> Vec<f64> {
        [&self.x_dot[..], &self.x_ddot, &self.multipliers].concat()
    }
}

/// M ẍ + h − f in dense coordinates: what the joints and actuators have to bring.
fn needed_forces(
    dense: &Dense,
    at: &Closed,
    x_dot: &[f64],
    x_ddot: &[f64],
    loads: &[Act],
) -> Vec<f64> {
    let mut forces = vec![0.0; dense.rows.columns()];
    let origin = |c: usize| vec2(at.x[c], at.x[c + 1]);
    let mut add = |c: usize, force: Vec2, moment: f64| {
        forces[c] += force.x;
        forces[c + 1] += force.y;
        forces[c + 2] += moment;
    };
    for body in &dense.bodies {
        if let Some(c) = body.column {
            let force = dense.center_acceleration(body, at, x_dot, x_ddot) * body.mass.mass;
            let arm = dense.center(body, at) - origin(c);
            add(
                c,
                force,
                arm.cross(force) + body.mass.inertia * x_ddot[c + 2],
            );
        }
    }
    for load in loads {
        if let Some(c) = dense.bodies[load.body].column {
            add(c, -load.force, -load.moment(origin(c)));
        }
    }
    forces
}

impl<'a> Measured<'a> {
    pub(super) fn new(dense: &'a Dense, state: &'a State) -> Result<Self, StateError> {
        check(dense, state)?;
        let start = dense.start(&state.bodies)?;
        let mut imposed = vec![0.0; dense.rows.len()];
        imposed[dense.actuator_row()..].copy_from_slice(&state.q);
        let closed = dense.close(&start, &imposed)?;
        dense.check_repeated(&closed)?;
        let moved: Vec<_> = start.iter().zip(&closed.x).map(|(s, x)| s - x).collect();
        let reached = state.bodies.iter().map(|p| p[0].hypot(p[1]));
        let largest = reached.fold(dense.size(), f64::max);
        let loads = moved_loads(dense, state);
        let unit_speeds = dense.unit_speeds(&closed);
        let exact = Solution::new(dense, state, &closed, &unit_speeds, &loads)?;
        let (noise, pose_noise) =
            dense.rounding(&closed, &unit_speeds, &exact.flat(), |there| {
                let speeds = dense.unit_speeds(there);
                Ok(Solution::new(dense, state, there, &speeds, &loads)?.flat())
            })?;
        let n = dense.rows.columns();
        let (claimed_dot, claimed_ddot) = moved_motion(dense, state);
        Ok(Self {
            moved: dense.reach(&moved) * dense.size() / largest,
            acts: dense.acts(&closed, &state.reactions, &state.tau),
            dense,
            state,
            condition: dense.condition(&closed.x),
            closed,
            x_dot: exact.x_dot,
            x_ddot: exact.x_ddot,
            multipliers: exact.multipliers,
            claimed_dot,
            claimed_ddot,
            pose_noise,
            noise_dot: noise[..n].to_vec(),
            noise_ddot: noise[n..2 * n].to_vec(),
            noise_multipliers: noise[2 * n..].to_vec(),
            loads,
        })
    }

    /// The moving bodies with their columns.
    pub(super) fn moving(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let bodies = self.dense.bodies.iter().enumerate();
        bodies.filter_map(|(b, body)| Some((b, body.column?)))
    }

    /// The largest |ω|, or |v| per size.
    pub(super) fn reach_of(&self, speeds: &[f64]) -> f64 {
        self.dense.reach(speeds)
    }

    /// How much rounding may have moved the dense motion, relative to it.
    pub(super) fn relative_noise(&self) -> f64 {
        let of = |noise: &[f64], value: &[f64]| {
            let (noise, value) = (self.reach_of(noise), self.reach_of(value));
            if noise == 0.0 { 0.0 } else { noise / value }
        };
        self.pose_noise
            .max(of(&self.noise_dot, &self.x_dot))
            .max(of(&self.noise_ddot, &self.x_ddot))
    }

    /// The largest force of inertia or of a load, moments over the size: what reactions are
    /// relative to where they all vanish.
    pub(super) fn largest_force(&self) -> f64 {
        let size = self.dense.size();
        let loads = self.loads.iter();
        let loads = loads.map(|l| l.force.norm().max(l.couple.abs() / size));
        let inertia = self.moving().map(|(body, _)| {
            let [x, y, moment] = self.inertia_forces(body);
            x.hypot(y).max(moment.abs() / size)
        });
        loads.chain(inertia).fold(0.0, f64::max)
    }

    /// Everything that acts on a body.
    pub(super) fn acting(&self, body: usize) -> Acting {
        let center = self.dense.center(&self.dense.bodies[body], &self.closed);
        let all = self.acts.iter().chain(&self.loads);
        sum_acts(all.filter(|a| a.body == body), center)
    }

    /// m a_G and I α with the claimed motion.
    pub(super) fn inertia_forces(&self, body: usize) -> [f64; 3] {
        let of = &self.dense.bodies[body];
        let (u, a) = (&self.claimed_dot, &self.claimed_ddot);
        let force = self.dense.center_acceleration(of, &self.closed, u, a) * of.mass.mass;
        let alpha = of.column.map_or(0.0, |c| a[c + 2]);
        [force.x, force.y, of.mass.inertia * alpha]
    }

    /// Second derivatives in time of every moving body's centre of mass and angle, from positions
    /// alone. Newton's method starts from the state itself, not where its speeds would lead.
    pub(super) fn differenced(&self) -> Vec<Estimate> {
        let dense = self.dense;
        let places = |closed: &Closed| -> Vec<f64> {
            let center = |(b, c): (usize, usize)| {
                let center = dense.center(&dense.bodies[b], closed);
                [center.x, center.y, closed.x[c + 2]]
            };
            self.moving().flat_map(center).collect()
        };
        let middle = places(&self.closed);
        let driven = dense.actuator_row();
        let mut imposed = self.closed.imposed.clone();
        derivatives(
            Order::Second(&middle),
            self.time_step(),
            self.pose_noise.max(f64::EPSILON),
            |t| {
                for (i, imposed) in imposed[driven..].iter_mut().enumerate() {
                    let s = self.state;
                    *imposed = s.q[i] + t * (s.q_dot[i] + 0.5 * t * s.q_ddot[i]);
                }
                let start = &self.closed.x;
                let closed = dense.close_beside(&self.closed, start, &imposed).ok()?;
                Some(places(&closed))
            },
        )
    }

    /// t with v t + ½ a t² = the longest step; a second where nothing moves.
    pub(super) fn time_step(&self) -> f64 {
        let (v, a) = (self.reach_of(&self.x_dot), self.reach_of(&self.x_ddot));
        let step = 2.0 * FIRST_TURN / (v + (v * v + 2.0 * a * FIRST_TURN).sqrt());
        if step.is_finite() { step } else { 1.0 }
    }

    /// Power of actuators and loads less the rate of the kinetic energy, and the sum of what its
    /// terms could be, |F| |v|, W: a force across its velocity is rounded as if it were along it.
    pub(super) fn power(&self) -> (f64, f64) {
        let (mut sum, mut terms) = (0.0, 0.0);
        let mut add = |power: f64, most: f64| {
            sum += power;
            terms += most;
        };
        for (tau, rate) in self.state.tau.iter().zip(&self.state.q_dot) {
            add(tau * rate, (tau * rate).abs());
        }
        let (at, u, a) = (&self.closed, &self.x_dot, &self.x_ddot);
        for load in &self.loads {
            if let Some(c) = self.dense.bodies[load.body].column {
                let arm = load.at - vec2(at.x[c], at.x[c + 1]);
                let v = vec2(u[c], u[c + 1]);
                add(load.force.dot(v), load.force.norm() * v.norm());
                let turning = u[c + 2] * arm.cross(load.force);
                add(turning, (u[c + 2] * arm.norm() * load.force.norm()).abs());
                add(u[c + 2] * load.couple, (u[c + 2] * load.couple).abs());
            }
        }
        for body in &self.dense.bodies {
            if let Some(c) = body.column {
                let v = self.dense.center_velocity(body, at, u);
                let force = self.dense.center_acceleration(body, at, u, a) * body.mass.mass;
                let turning = body.mass.inertia * u[c + 2] * a[c + 2];
                add(-v.dot(force), v.norm() * force.norm());
                add(-turning, turning.abs());
            }
        }
        (sum, terms)
    }

    /// What the ground and the loads do less the rate of the momentum, with the sum of absolute
    /// terms: x, y, and the moment about the ground's moved origin over the size, N.
    pub(super) fn balance(&self) -> [(f64, f64, &'static str); 3] {
        let ground = self.dense.mechanism.ground;
        let on_ground = self.acts.iter().filter(|a| a.body == ground);
        let on_bodies = self.loads.iter().filter(|a| a.body != ground);
        let mut total = sum_acts(on_bodies, Vec2::ZERO);
        // What acts on the ground is the opposite of what the ground does.
        let by_ground = sum_acts(on_ground, Vec2::ZERO);
        for (total, by_ground) in total.sum.iter_mut().zip(by_ground.sum) {
            *total -= by_ground;
        }
        for (total, by_ground) in total.terms.iter_mut().zip(by_ground.terms) {
            *total += by_ground;
        }
        let (at, u, a) = (&self.closed, &self.x_dot, &self.x_ddot);
        for body in &self.dense.bodies {
            if let Some(c) = body.column {
                let force = self.dense.center_acceleration(body, at, u, a) * body.mass.mass;
                let center = self.dense.center(body, at);
                let couple = body.mass.inertia * a[c + 2];
                total.sum[0] -= force.x;
                total.sum[1] -= force.y;
                total.sum[2] -= center.cross(force) + couple;
                total.terms[0] += force.norm();
                total.terms[1] += center.norm() * force.norm() + couple.abs();
            }
        }
        let size = self.dense.size();
        [
            (total.sum[0], total.terms[0], "x"),
            (total.sum[1], total.terms[0], "y"),
            (total.sum[2] / size, total.terms[1] / size, "moment"),
        ]
    }
}

fn sum_acts<'a>(acts: impl Iterator<Item = &'a Act>, about: Vec2) -> Acting {
    let mut acting = Acting {
        sum: [0.0; 3],
        terms: [0.0; 2],
    };
    for act in acts {
        acting.sum[0] += act.force.x;
        acting.sum[1] += act.force.y;
        acting.sum[2] += act.moment(about);
        acting.terms[0] += act.force.norm();
        acting.terms[1] += act.moment_terms(about);
    }
    acting
}

/// Everything must be there, and as many as there should be.
fn check(dense: &Dense, state: &State) -> Result<(), StateError> {
    let (bodies, drives) = (dense.bodies.len(), dense.mechanism.actuators.len());
    let counts = [
        ("coordinates", state.q.len(), drives),
        ("speeds", state.q_dot.len(), drives),
        ("accelerations of coordinates", state.q_ddot.len(), drives),
        ("poses", state.bodies.len(), bodies),
        ("velocities", state.velocity.len(), bodies),
        ("accelerations", state.acceleration.len(), bodies),
        ("reactions", state.reactions.len(), dense.actuator_row()),
        ("actuator actions", state.tau.len(), drives),
    ];
    for (what, found, expected) in counts {
        if found != expected {
            return Err(StateError::Count {
                what,
                found,
                expected,
            });
        }
    }
    let mut loaded = state.loads.iter().map(|l| l.body.0);
    match loaded.find(|&b| b >= bodies) {
        Some(body) => Err(StateError::Load { body, bodies }),
        None => Ok(()),
    }
}

/// The loads with their points from the ground's moved origin.
fn moved_loads(dense: &Dense, state: &State) -> Vec<Act> {
    let ground = dense.bodies[dense.mechanism.ground].shift;
    let moved = state.loads.iter().map(|load| Act {
        body: load.body.0,
        force: load.force,
        // A pure couple acts nowhere, and its point, wherever it was put, must not cost digits.
        at: if load.force == Vec2::ZERO {
            Vec2::ZERO
        } else {
            load.at - ground
        },
        couple: load.couple,
    });
    moved.collect()
}

/// The claimed velocities and accelerations of the moved frames, in dense order.
fn moved_motion(dense: &Dense, state: &State) -> (Vec<f64>, Vec<f64>) {
    let columns = dense.rows.columns();
    let (mut x_dot, mut x_ddot) = (vec![0.0; columns], vec![0.0; columns]);
    for (b, body) in dense.bodies.iter().enumerate() {
        if let Some(c) = body.column {
            let arm = body.shift.turn(Vec2::from_angle(state.bodies[b][2]));
            let ([vx, vy, omega], [ax, ay, alpha]) = (state.velocity[b], state.acceleration[b]);
            let v = vec2(vx, vy) + arm.perp() * omega;
            let a = vec2(ax, ay) + arm.perp() * alpha - arm * (omega * omega);
            x_dot[c..c + 3].copy_from_slice(&[v.x, v.y, omega]);
            x_ddot[c..c + 3].copy_from_slice(&[a.x, a.y, alpha]);
        }
    }
    (x_dot, x_ddot)
}
