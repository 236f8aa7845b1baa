//! A claimed free motion and its checks: the multibody equations, and for a single rotor its own equation and its
//! energy.

use super::rotor::{Rotor, RotorState};
use crate::checked::multibody::{FreeMotionRun, free_motion_run};
use dwell_findings::{Check, Finding};
use dwell_scene::PlaneScene;

/// Tolerance relative to the rotor's own integration, whose fixed steps pass kinks: the largest measured difference is 1.2e-6, for a
/// controller that leaves its limit within a step.
const ROTOR_TOLERANCE: f64 = 1e-5;
/// Tolerance of the energy from the claimed steps by Gauss's rule with cubic positions between them.
const ENERGY_TOLERANCE: f64 = 1e-5;
/// Nodes of Gauss's rule of two points.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Number of parts of a claimed step over which power is summed.
const PARTS: usize = 32;

/// A result that changes by less, relative to the largest of its kind, counts as unchanged: three digits above what the checks distinguish
/// from rounding.
const UNCHANGED: f64 = 1e-9;

/// A claimed free motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MotionClaims {
    run: FreeMotionRun,
    /// For a single rotor: its own equation.
    rotor: Option<Rotor>,
}

impl MotionClaims {
    /// The motion of a scene; `None` if it has none, or none can be computed.
    pub(super) fn new(scene: &PlaneScene) -> Option<Self> {
        let run = free_motion_run(scene).ok().flatten()?;
        let rotor = Rotor::read(scene.source.inner());
        (run.steps.len() > 1).then_some(Self { run, rotor })
    }

    fn end(&self) -> f64 {
        self.run.steps.last().map_or(0.0, |step| step.t)
    }

    /// Whether the motion, its end or its events differ from those of another.
    pub(super) fn differ_from(&self, own: &Self) -> bool {
        let values = |claims: &Self| {
            let last = claims.run.coordinates.last().cloned().unwrap_or_default();
            let times: Vec<f64> = claims
                .run
                .events
                .iter()
                .map(|(_, at)| at.t)
                .chain([claims.end()])
                .collect();
            let reactions = claims.run.steps.last().map(|step| step.reactions.clone());
            [last.concat(), times, reactions.unwrap_or_default()]
        };
        let (mine, others) = (values(self), values(own));
        (0..mine.len()).any(|k| differ(&mine[k], &others[k]))
    }

    /// The findings of this motion, claimed for the scene whose own motion is `own`.
    pub(super) fn check(&self, scene: &PlaneScene, own: &Self) -> Vec<Finding> {
        let counts = |claims: &Self| {
            let first = claims.run.steps.first();
            first.map(|s| [s.poses.len(), s.drive_forces.len(), s.reactions.len()])
        };
        if counts(self) != counts(own) {
            return Vec::new();
        }
        let mut findings = vec![self.start(scene)];
        let along_rotor = own.rotor.as_ref().map(|rotor| self.along_rotor(rotor));
        findings.extend(along_rotor.into_iter().flatten());
        // The multibody equations have neither stops nor sticking friction.
        let mut loads = scene.loads.iter();
        let is_known = scene.stops.is_empty() && loads.all(|load| !load.name.contains('.'));
        if own.rotor.is_none() || is_known {
            findings.extend(self.run.check(scene));
        }
        findings
    }

    /// The coordinates and speeds at the start with those of the scene.
    fn start(&self, scene: &PlaneScene) -> Finding {
        let claimed = self.run.coordinates.first().cloned().unwrap_or_default();
        let given = scene.motion.iter().flat_map(|motion| {
            let q = motion.initial_coordinates.iter();
            let free = motion.laws.iter().map(Option::is_none);
            q.zip(&motion.initial_velocities).zip(free)
        });
        let both = claimed.iter().zip(given).filter(|(_, (_, free))| *free);
        let apart = both.map(|([q, speed], ((q0, speed0), _))| {
            (q - q0).abs().max((speed - speed0).abs()) / q0.abs().max(speed0.abs()).max(1.0)
        });
        let worst = apart.fold(0.0, f64::max);
        Finding::new("motion-start", Check::ConstraintClosure, [worst; 2], 1e-9)
    }

    /// The findings of a rotor: end, events, and energy.
    fn along_rotor(&self, rotor: &Rotor) -> Vec<Finding> {
        let motion = rotor.motion();
        let relative = |a: f64, b: f64, scale: f64| (a - b).abs() / scale;
        let last = self.run.coordinates.last().and_then(|c| c.first());
        let (Some(step), Some([q, speed])) = (self.run.steps.last(), last) else {
            return Vec::new();
        };
        let (_, [q_end, speed_end, _]) = motion.end;
        let apart = [
            relative(*q, q_end, q_end.abs().max(1.0)),
            relative(*speed, speed_end, speed_end.abs().max(1.0)),
        ];
        let worst = apart.into_iter().fold(0.0, f64::max);
        let mut findings = vec![finding("rotor-end", Check::ClosedForms, worst)];
        findings.extend(self.rotor_events(rotor, &motion.events));
        if !rotor.is_ended(&motion) {
            let apart = relative(step.t, rotor.duration, rotor.duration);
            findings.push(finding("rotor-time", Check::Period, apart));
        }
        let over = self.overloaded_rest(rotor);
        findings.push(finding("rotor-rest", Check::NewtonEuler, over));
        let apart = [self.energy_error(rotor); 2];
        let energy = Finding::new("rotor-energy", Check::Power, apart, ENERGY_TOLERANCE);
        findings.push(energy);
        findings
    }

    /// The events of a rotor: their times, and the states there.
    fn rotor_events(&self, rotor: &Rotor, times: &[Option<f64>]) -> Vec<Finding> {
        let mut findings = Vec::new();
        for (k, expected) in times.iter().enumerate() {
            let claimed = self.run.events.iter().find(|(event, _)| *event == k);
            let apart = match (claimed, expected) {
                (Some((_, at)), Some(t)) => (at.t - t).abs() / t,
                (None, None) => continue,
                // A missing or superfluous event.
                _ => f64::INFINITY,
            };
            findings.push(finding("rotor-event", Check::ClosedForms, apart));
            let ended = self.end();
            let residual = claimed.map_or(f64::INFINITY, |(_, at)| {
                let count = self.run.coordinates.first().map_or(1, Vec::len);
                let drive = at.y.get(2 * count).copied().unwrap_or(0.0);
                let state: RotorState = [at.y[0], at.y[count], drive];
                let ends = rotor.ends_with(k) == ((at.t - ended).abs() < 1e-9 * ended);
                if ends {
                    rotor.residual(k, at.t, state)
                } else {
                    f64::INFINITY
                }
            });
            let check = if rotor.is_reaction(k) {
                Check::NewtonEuler
            } else {
                Check::ConstraintClosure
            };
            findings.push(finding("rotor-event-state", check, residual));
        }
        findings
    }

    /// The required friction beyond the static limit where the rotor rests, relative to that limit.
    fn overloaded_rest(&self, rotor: &Rotor) -> f64 {
        let states = self.run.steps.iter().zip(&self.run.coordinates);
        let resting = states.filter(|(_, c)| c[0][1] == 0.0);
        let margin = resting.map(|(s, c)| rotor.forces.rest_margin(s.t, [c[0][0], 0.0, 0.0]));
        // Without friction nothing sticks.
        let margin = margin.filter(|margin| margin.is_finite());
        margin.fold(0.0, |worst, margin| worst.max(-margin))
    }

    /// Error of the kinetic energy along the claimed steps, from the power of the scene's own torques, relative to the largest energy. The power
    /// is evaluated inside the steps, because torques may jump at their ends.
    fn energy_error(&self, rotor: &Rotor) -> f64 {
        let states: Vec<(f64, f64, f64)> = self
            .run
            .steps
            .iter()
            .zip(&self.run.coordinates)
            .map(|(s, c)| (s.t, c[0][0], c[0][1]))
            .collect();
        let kinetic = |v: f64| 0.5 * rotor.forces.inertia * v * v;
        let mut energy = states.first().map_or(0.0, |first| kinetic(first.2));
        let (mut state, mut largest, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        for pair in states.windows(2) {
            let [(t0, q0, v0), (t1, q1, v1)] = [pair[0], pair[1]];
            let struck = rotor.speed_before_impact(q1, v1, v0);
            let end = struck.unwrap_or(v1);
            // The claimed state may be that before or after an impact.
            let v0 = match rotor.speed_after_impact(q0, v0) {
                Some(after) => {
                    energy += kinetic(after) - kinetic(v0);
                    after
                }
                None => v0,
            };
            let dt = (t1 - t0) / PARTS as f64;
            for part in 0..if dt > 0.0 { PARTS } else { 0 } {
                let at = |node: f64, state: f64| {
                    let s = (part as f64 + node) / PARTS as f64;
                    let [q, v] = hermite([q0, v0, q1, end], s, t1 - t0);
                    rotor.forces.power(t0 + s * (t1 - t0), [q, v, state])
                };
                let [_, first] = at(0.5, state);
                let [_, rate] = at(0.5, state + 0.5 * dt * first);
                let power = GAUSS.map(|node| at(node, state + node * dt * rate)[0]);
                energy += 0.5 * dt * (power[0] + power[1]);
                state += dt * rate;
            }
            worst = worst.max((energy - kinetic(end)).abs());
            largest = largest.max(kinetic(end));
            if struck.is_some() {
                // The energy lost at the impact follows from the restitution.
                energy += kinetic(v1) - kinetic(end);
            }
        }
        worst / largest
    }
}

/// A finding of a rotor by a relative difference.
fn finding(key: &str, check: Check, apart: f64) -> Finding {
    Finding::new(key, check, [apart; 2], ROTOR_TOLERANCE)
}

/// Position and speed between two states, at the fraction `s` of the time `h` between them.
fn hermite([q0, v0, q1, v1]: [f64; 4], s: f64, h: f64) -> [f64; 2] {
    let (d, c) = (q1 - q0, 1.0 - s);
    let q = q0 + s * s * (3.0 - 2.0 * s) * d + h * s * c * (c * v0 - s * v1);
    let v = 6.0 * s * c * d / h + (1.0 - 4.0 * s + 3.0 * s * s) * v0 + (3.0 * s * s - 2.0 * s) * v1;
    [q, v]
}

/// Whether values differ by more than rounding.
pub(super) fn differ(values: &[f64], own: &[f64]) -> bool {
    let largest = own.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
    let mut both = values.iter().zip(own);
    values.len() != own.len()
        || both.any(|(a, b)| (a - b).is_nan() || (a - b).abs() > UNCHANGED * largest)
}
