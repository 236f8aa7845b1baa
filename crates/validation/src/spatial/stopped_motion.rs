//! A free motion of a case with end stops: the forces on its coordinates and its impacts against the dense equations, and its energy.
//! What a stop does follows from the state alone: a rigid one pushes a coordinate that rests on it, one that yields pushes as far as it
//! is pressed in.

use super::claims::SpaceClaims;
use super::motion::{self, Dense, EQUATIONS, MAX_STEPS, TOLERANCE, energies, start};
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use dwell_dynamics::{
    ContactEvent, Machine, Method, OdeState, Options, Solution, StopChange, solve,
};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::space::Model;
use dwell_scene::NamedStop;
use dwell_study::machines::MachineScene;
use dwell_verify::FindingSpec;

const FORCES: FindingSpec<'_> = FindingSpec {
    key: "stop-forces",
    comparison: "what the dense equations require along each coordinate of a motion with the force of its end stop",
    scale: "the largest action of a coordinate, of inertia or loads",
    // The largest seen in a case is 1.2e-13.
    tolerance: 1e-11,
    ..EQUATIONS
};
const IMPACTS: FindingSpec<'_> = FindingSpec {
    key: "stop-impacts",
    check: Check::Momentum,
    comparison: "the impulses that the dense inertias give of each impact's change of speeds with one along its coordinate alone, and the \
                 speed after it with the restitution",
    scale: "the impulse, and the speed before",
    // The largest seen in a case is 9.4e-15.
    tolerance: 9e-13,
    tolerance_reason: "rounding, amplified by the condition of the inertias",
};
const ENERGY: FindingSpec<'_> = FindingSpec {
    key: "stop-energy",
    comparison: "kinetic and potential energy, of placements and dense velocities, with the start's and the work of stops and other loads",
    // The largest seen in a case is 2.2e-13.
    tolerance: 2e-11,
    tolerance_reason: "the tolerance of the integration, 1e-12 for each step, and of the times of events",
    ..motion::ENERGY
};

/// The findings of the motion of a scene with end stops whose coordinates are all free; none where something drives them.
pub(super) fn stopped_findings(claims: &SpaceClaims<'_>) -> Result<Vec<Finding>, ValidationError> {
    let scene = claims.scene();
    let is_free = scene
        .motion
        .as_ref()
        .is_some_and(|motion| motion.laws.iter().all(Option::is_none));
    if !is_free || !scene.drives.is_empty() {
        return Ok(Vec::new());
    }
    let machine = scene.machine(&[])?;
    let ([q, q_dot], duration) = start(scene, claims.model());
    let y = machine.initial_state(&q, &q_dot);
    let options = Options {
        max_steps: MAX_STEPS,
        ..Options::new(Method::Dop853, TOLERANCE)
    };
    let begin = OdeState { t: 0.0, y };
    let solution = solve(&machine, machine.model(), &begin, duration, &options, &[]);
    let solution = solution.map_err(|error| scene.explain(machine.model(), &error))?;
    let motion = StoppedMotion {
        claims,
        machine: &machine,
        stops: &scene.stops,
    };
    let steps = format!("{} steps", solution.steps.len());
    let impacts = format!("{} events", solution.contact_events.len());
    let found = [
        motion.forces(&solution).finding(&FORCES, &steps),
        motion.impacts(&solution).finding(&IMPACTS, &impacts),
        energies(claims, &machine, &solution.steps).finding(&ENERGY, &steps),
    ];
    let mut findings: Vec<Finding> = found.into_iter().flatten().collect();
    // A motion that stops early shows less than it should.
    for finding in &mut findings {
        finding.pass &= solution.error.is_none();
    }
    Ok(findings)
}

struct StoppedMotion<'a> {
    claims: &'a SpaceClaims<'a>,
    machine: &'a Machine<Model>,
    stops: &'a [NamedStop],
}

impl StoppedMotion<'_> {
    /// Coordinates and speeds of a state.
    fn parts<'y>(&self, y: &'y [f64]) -> [&'y [f64]; 2] {
        let n = self.machine.free().len();
        [&y[..n], &y[n..2 * n]]
    }

    /// The force of the end stops of a coordinate in a state; none at rest on a rigid one, which pushes as hard as it must.
    fn force(&self, i: usize, [q, speed]: [f64; 2]) -> Option<f64> {
        let mut force = 0.0;
        for stop in self.stops.iter().filter(|stop| stop.actuator.0 == i) {
            for (limit, side) in [(stop.min, 1.0), (stop.max, -1.0)] {
                let Some(limit) = limit else { continue };
                let depth = side * (limit - q);
                match stop.yielding {
                    Some([stiffness, damping]) if depth > 0.0 => {
                        let push = stiffness * depth - damping * side * speed;
                        force += side * push.max(0.0);
                    }
                    None if depth == 0.0 && speed == 0.0 => return None,
                    _ => {}
                }
            }
        }
        Some(force)
    }

    /// Which way the rigid stop on which a coordinate rests pushes it.
    fn side(&self, i: usize, q: f64) -> f64 {
        let of_coordinate = |stop: &&NamedStop| stop.actuator.0 == i && stop.yielding.is_none();
        let is_low = |stop: &NamedStop| stop.min == Some(q);
        match self.stops.iter().filter(of_coordinate).any(is_low) {
            true => 1.0,
            false => -1.0,
        }
    }

    fn forces(&self, solution: &Solution) -> Differences {
        let mut worst = Differences::default();
        let mut workspace = self.machine.workspace();
        let is_event = |t: f64| solution.contact_events.iter().any(|event| event.t() == t);
        for OdeState { t, y } in solution.steps.iter().filter(|step| !is_event(step.t)) {
            let [q, q_dot] = self.parts(y);
            let state = self.machine.evaluate(*t, y, &mut workspace).ok();
            let q_ddot = state.map(|state| state.q_ddot().to_vec());
            let (Some(q_ddot), Some(dense)) = (q_ddot, Dense::new(self.claims, *t, [q, q_dot]))
            else {
                worst.compare([f64::NAN, 0.0, 1.0], "", || format!("t = {t} s"));
                continue;
            };
            let required = |i: usize| {
                let columns = dense.columns.iter().zip(&q_ddot);
                let inertial: f64 = columns.map(|(column, a)| column[i] * a).sum();
                [
                    inertial + dense.rest[i],
                    inertial.abs().max(dense.rest[i].abs()),
                ]
            };
            let all: Vec<[f64; 2]> = (0..q.len()).map(required).collect();
            let scale = all.iter().fold(0.0_f64, |max, [_, size]| max.max(*size));
            for (i, [found, _]) in all.iter().enumerate() {
                let at = || format!("t = {t:.4} s, coordinate {}", i + 1);
                match self.force(i, [q[i], q_dot[i]]) {
                    Some(wanted) => worst.compare([*found, wanted, scale], "N m", at),
                    // It stands, and is pushed inwards.
                    None => {
                        let push = (self.side(i, q[i]) * found).max(0.0) * self.side(i, q[i]);
                        worst.compare([*found, push, scale], "N m", at);
                        worst.compare([q_ddot[i], 0.0, 1.0], "rad/s2", at);
                    }
                }
            }
        }
        worst
    }

    fn impacts(&self, solution: &Solution) -> Differences {
        let mut worst = Differences::default();
        for event in &solution.contact_events {
            let ContactEvent::Stop {
                t,
                y,
                stop,
                change: StopChange::Impact { changes, impulse },
            } = event
            else {
                continue;
            };
            let [q, after] = self.parts(y);
            let at = |what: &str| format!("t = {t:.4} s, {what}");
            let Some(dense) = Dense::new(self.claims, *t, [q, after]) else {
                worst.compare([f64::NAN, 0.0, 1.0], "", || at("no pose"));
                continue;
            };
            let i = self.stops[*stop].actuator.0;
            for k in 0..q.len() {
                let columns = dense.columns.iter().zip(changes);
                let found: f64 = columns.map(|(column, change)| column[k] * change).sum();
                let wanted = if k == i { *impulse } else { 0.0 };
                worst.compare([found, wanted, impulse.abs()], "N m s", || at("impulse"));
            }
            let before = after[i] - changes[i];
            let restitution = self.stops[*stop].restitution;
            worst.compare(
                [after[i], -restitution * before, before.abs()],
                "rad/s",
                || at("speed"),
            );
        }
        worst
    }
}
