//! The motion of a single rotor from the numbers of its scene, by an independent reader and integrator.
//!
//! A body `rotor` on a pin, or on a guide, with drives, brakes and stops: (I + Σ N² J) θ̈ = Σ M(t, θ, ω), or with mass and forces on a guide. It shares nothing with the readers, drives,
//! stops, events and integrators that are checked.

mod forces;

pub(super) use forces::RotorState;
use forces::{RotorForces, as_number};
use std::f64::consts::TAU;
use toml::{Table, Value};

/// Steps of the integration.
const STEPS: usize = 20_000;
/// Step to a reversal, s.
const PERIOD_STEP: f64 = 2e-4;
/// Number of bisections of a step to an event, down to rounding.
const HALVINGS: usize = 50;

/// An event: a function of time and state that changes its sign.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RotorEvent {
    kind: RotorEventKind,
    ends: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum RotorEventKind {
    Reaches(f64),
    Reverses,
    /// The pin's force along x, N.
    Reaction(f64),
    Revolution,
}

/// A rotor with its motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rotor {
    pub(super) forces: RotorForces,
    /// Mass times the distance of its centre of mass from the pin, kg m.
    unbalance: f64,
    start: [f64; 2],
    /// The end of the motion, s, unless an event ends it.
    pub(super) duration: f64,
    /// The events, in the order of the scene.
    events: Vec<RotorEvent>,
    /// Lower and upper limit of a stop; infinite without a stop.
    limits: [f64; 2],
    /// Restitution of a rigid stop.
    rigid: Option<f64>,
}

/// A computed motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RotorMotion {
    /// Its end: time, s, and state.
    pub(super) end: (f64, RotorState),
    /// By event: its first occurrence, s.
    pub(super) events: Vec<Option<f64>>,
}

impl Rotor {
    /// Reads the scene of a rotor; `None` if it is not one.
    pub(super) fn read(text: &str) -> Option<Self> {
        let root: Table = toml::from_str(text).ok()?;
        let body = root.get("bodies")?.get("rotor")?;
        let motion = root.get("motion")?;
        let number = |table: &Value, key: &str| table.get(key).and_then(as_number);
        let mass = number(body, "mass").unwrap_or(0.0);
        let center = body.get("center").and_then(|center| center.get(0));
        let arm = center.and_then(as_number).unwrap_or(0.0);
        let joints = root.get("joints").and_then(Value::as_table)?;
        let slides = joints.values().any(|j| j.get("prismatic").is_some());
        let of_rotor = if slides {
            mass
        } else {
            number(body, "inertia")? + mass * arm * arm
        };
        // A number, or a table with one number.
        let only = |key: &str| {
            let value = motion.get(key)?;
            let inner = value.as_table().and_then(|all| all.values().next());
            as_number(inner.unwrap_or(value))
        };
        let assembly = root.get("assembly");
        let assembled = assembly.and_then(|assembly| number(assembly, "phi"));
        let events = motion
            .get("events")
            .and_then(Value::as_table)
            .into_iter()
            .flat_map(|all| all.values());
        let stops = root.get("stops").and_then(Value::as_table);
        let stop = stops.and_then(|all| all.values().next());
        let limits = stop.map(|stop| {
            let limit = |key: &str, default: f64| number(stop, key).unwrap_or(default);
            [limit("min", f64::NEG_INFINITY), limit("max", f64::INFINITY)]
        });
        let rigid = stop.filter(|stop| stop.get("stiffness").is_none());
        let restitution = rigid.map(|stop| number(stop, "restitution").unwrap_or(0.0));
        let rotor = Self {
            forces: RotorForces::read(&root, of_rotor, [mass, arm], stop.zip(limits))?,
            unbalance: mass * arm,
            start: [
                only("initial-coordinate").or(assembled).unwrap_or(0.0),
                only("initial-velocity").unwrap_or(0.0),
            ],
            duration: number(motion, "duration").unwrap_or(0.0),
            events: events.filter_map(RotorEvent::read).collect(),
            limits: limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]),
            rigid: restitution,
        };
        match number(motion, "periods") {
            Some(periods) => {
                let duration = periods * rotor.period()?;
                Some(Self { duration, ..rotor })
            }
            None => (rotor.duration > 0.0).then_some(rotor),
        }
    }

    /// The period of an oscillation from rest: twice the time to its first reversal.
    fn period(&self) -> Option<f64> {
        let (mut t, mut y) = (0.0, [self.start[0], self.start[1], 0.0]);
        for _ in 0..STEPS {
            let next = self.forces.step(t, y, PERIOD_STEP);
            if y[1] * next[1] < 0.0 {
                let at = zero_of(&|h: f64| self.forces.step(t, y, h)[1], PERIOD_STEP);
                return Some(2.0 * (t + at));
            }
            (t, y) = (t + PERIOD_STEP, next);
        }
        None
    }

    /// The value of an event's function.
    fn event_value(&self, event: &RotorEvent, t: f64, y: RotorState) -> f64 {
        match event.kind {
            RotorEventKind::Reaches(value) => y[0] - value,
            RotorEventKind::Reverses => y[1],
            RotorEventKind::Reaction(value) => self.pin_force(t, y) - value,
            RotorEventKind::Revolution => (y[0] - self.start[0]).abs() - TAU,
        }
    }

    /// The value of an event's function at a claimed event, relative to its typical size.
    pub(super) fn residual(&self, event: usize, t: f64, y: RotorState) -> f64 {
        let event = &self.events[event];
        let scale = match event.kind {
            RotorEventKind::Reaction(value) => value.abs().max(1.0),
            RotorEventKind::Reaches(_) | RotorEventKind::Reverses | RotorEventKind::Revolution => {
                1.0
            }
        };
        self.event_value(event, t, y).abs() / scale
    }

    /// The speed before an impact at a rigid stop that leads to this state.
    pub(super) fn speed_before_impact(&self, q: f64, speed: f64, previous: f64) -> Option<f64> {
        let restitution = self.rigid?;
        (self.is_at_limit(q) && speed * previous < 0.0).then(|| -speed / restitution)
    }

    /// The speed after an impact, if the rotor strikes a rigid stop in this state.
    pub(super) fn speed_after_impact(&self, q: f64, speed: f64) -> Option<f64> {
        let restitution = self.rigid?;
        let middle = 0.5 * (self.limits[0] + self.limits[1]);
        let is_outward = (q - middle) * speed > 0.0;
        (self.is_at_limit(q) && is_outward).then(|| -restitution * speed)
    }

    fn is_at_limit(&self, q: f64) -> bool {
        self.limits.iter().any(|limit| (q - limit).abs() < 1e-9)
    }

    /// Whether an event has ended a motion.
    pub(super) fn is_ended(&self, motion: &RotorMotion) -> bool {
        let mut events = self.events.iter().zip(&motion.events);
        events.any(|(event, t)| event.ends && t.is_some())
    }

    /// Whether an event ends the motion.
    pub(super) fn ends_with(&self, event: usize) -> bool {
        self.events.get(event).is_some_and(|event| event.ends)
    }

    /// Whether an event is that of a reaction.
    pub(super) fn is_reaction(&self, event: usize) -> bool {
        let kind = self.events.get(event).map(|event| event.kind);
        matches!(kind, Some(RotorEventKind::Reaction(_)))
    }

    /// Force of the ground on the rotor along x, N: mass times the acceleration of its centre of mass.
    fn pin_force(&self, t: f64, y: RotorState) -> f64 {
        let [_, alpha, _] = self.forces.rates(t, y);
        let (sin, cos) = y[0].sin_cos();
        -self.unbalance * (y[1] * y[1] * cos + alpha * sin)
    }

    /// The motion.
    pub(super) fn motion(&self) -> RotorMotion {
        let (mut t, mut y) = (0.0, [self.start[0], self.start[1], 0.0]);
        let mut found = RotorMotion {
            events: vec![None; self.events.len()],
            ..RotorMotion::default()
        };
        let step = self.duration / STEPS as f64;
        while t < self.duration * (1.0 - 1e-12) {
            let h = step.min(self.duration - t);
            if self.forces.holds(t, y) && !self.forces.holds(t + h, y) {
                // It breaks away within the step.
                t += zero_of(&|h: f64| self.forces.rest_margin(t + h, y), h) + 1e-9 * step;
                continue;
            }
            let next = self.forces.step(t, y, h);
            for (k, event) in self.events.iter().enumerate() {
                let value = |h: f64| self.event_value(event, t + h, self.forces.step(t, y, h));
                let (before, after) = (value(0.0), value(h));
                if found.events[k].is_none() && before * after < 0.0 {
                    let at = zero_of(&value, h);
                    found.events[k] = Some(t + at);
                    if event.ends {
                        found.end = (t + at, self.forces.step(t, y, at));
                        return found;
                    }
                }
            }
            let crossed =
                |limit: &f64| limit.is_finite() && (y[0] - limit) * (next[0] - limit) < 0.0;
            let Some(limit) = self.limits.into_iter().find(crossed) else {
                (t, y) = (t + h, next);
                continue;
            };
            // To the limit of the stop, and slightly beyond: the force of a compliant stop jumps there.
            let at = zero_of(&|h: f64| self.forces.step(t, y, h)[0] - limit, h);
            let there = self.forces.step(t, y, at);
            let speed = self
                .rigid
                .map_or(there[1], |restitution| -restitution * there[1]);
            let beyond = 1e-9 * step;
            y = [limit + speed * beyond, speed, there[2]];
            t += at + beyond;
        }
        found.end = (t, y);
        found
    }
}

/// The zero of a function that changes its sign over a step.
fn zero_of(value: &dyn Fn(f64) -> f64, step: f64) -> f64 {
    let (mut low, mut high) = (0.0, step);
    let sign = value(low);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if value(middle) * sign > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl RotorEvent {
    fn read(event: &Value) -> Option<Self> {
        let value = event.get("value").and_then(as_number);
        // The other coordinate of these scenes is the angle measured from the rotor.
        let sign = |key: &str| match event.get(key)?.as_str()? {
            "phi" => Some(1.0),
            _ => Some(-1.0),
        };
        let kind = if let Some(sign) = sign("reaches") {
            RotorEventKind::Reaches(sign * value?)
        } else if event.get("reverses").is_some() {
            RotorEventKind::Reverses
        } else if event.get("reaction").is_some() {
            RotorEventKind::Reaction(value.unwrap_or(0.0))
        } else {
            RotorEventKind::Revolution
        };
        let ends = event.get("stop").and_then(Value::as_bool).unwrap_or(false);
        Some(Self { kind, ends })
    }
}
